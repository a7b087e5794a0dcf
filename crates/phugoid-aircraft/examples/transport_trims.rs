//! Trims, derivatives and modes of the Generic Transport Model, undamaged and with its six cases of damage, as the tables of
//! `docs/transport.md`:
//!
//! `cargo run -p phugoid-aircraft --example transport_trims -- FOLDER [SPEED] [ALTITUDE]`
//!
//! with the folder of `vehicle.json` and `tables`, true airspeed in m/s (40 by default) and altitude in m (300 by default).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a program to be read

use std::time::Instant;

use phugoid_aircraft::transport::{Damage, RateModel, Transport, TransportOptions};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Controls, State};
use phugoid_flight_dynamics::linearize::{SubModel, linearize};
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::trim::{TrimCondition, trim};

/// Steady straight flight: with wings level if a rudder can make the side force vanish, else banked.
fn steady(aircraft: &Transport, speed: f64, altitude: f64) -> Result<(State, Controls, &'static str), String> {
    let found =
        trim(aircraft, &TrimCondition::steady(aircraft, speed, altitude, 0.0, 0.0)).map_err(|e| e.to_string())?;
    let words = if found.phi_rad.abs() < 1e-6 { "wings level" } else { "banked" };
    Ok((found.state(), found.controls(), words))
}

/// Derivatives of the six coefficients by alpha, beta, the three dimensionless rates, elevator, aileron and rudder, per rad.
fn derivatives(aircraft: &Transport, state: &State, controls: &Controls) -> [[f64; 8]; 6] {
    let variable = |value: f64, index: usize| Dual::<8>::variable(value, index);
    let constant = Dual::<8>::from;
    let air = motion(aircraft, state, controls, &Disturbance::default()).air;
    let dual_air = AirData {
        speed: constant(air.speed),
        alpha: variable(air.alpha, 0),
        beta: variable(air.beta, 1),
        density: constant(air.density),
        dynamic_pressure: constant(air.dynamic_pressure),
        mach: constant(air.mach),
    };
    let (span, chord) = (aircraft.geometry().span, aircraft.geometry().mean_chord);
    let rates = [(state.p, span), (state.q, chord), (state.r, span)];
    let rates = std::array::from_fn(|i| {
        let (rate, length) = rates[i];
        let scale = 2.0 * air.speed / length;
        variable(rate / scale, 2 + i) * scale
    });
    let controls = Controls {
        throttle: constant(controls.throttle),
        elevator: variable(controls.elevator, 5),
        aileron: variable(controls.aileron, 6),
        rudder: variable(controls.rudder, 7),
    };
    let c = aircraft.coefficients(&dual_air, rates, &controls);
    [c.cx, c.cy, c.cz, c.cl, c.cm, c.cn].map(|c| c.derivatives)
}

fn modes(model: &SubModel) -> String {
    let mode = |mode: &phugoid_flight_dynamics::modes::Mode| match mode.period_s {
        Some(_) => format!(
            "{} {:.2} rad/s ({:.2})",
            mode.name,
            mode.natural_frequency_rad_s,
            mode.damping_ratio.unwrap_or(f64::NAN)
        ),
        None => format!("{} {:.3} 1/s", mode.name, mode.eigenvalue_real),
    };
    model.modes.iter().map(mode).collect::<Vec<_>>().join(", ")
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().expect("the folder of `vehicle.json`");
    let mut number = |default: f64| arguments.next().map_or(default, |text| text.parse().expect("a number"));
    let (speed, altitude) = (number(40.0), number(300.0));
    let begun = Instant::now();
    // Without the rotary balance the undamaged aircraft differs from the damaged ones by the damage alone.
    let options = TransportOptions { rates: RateModel::ForcedOscillation, ..TransportOptions::default() };
    let whole = Transport::open_with(&folder, &options).expect("the data of the aircraft");
    println!("Read in {:.0} ms. {speed} m/s at {altitude} m.\n", 1e3 * begun.elapsed().as_secs_f64());

    let fleet: Vec<Transport> = Damage::ALL.iter().map(|damage| whole.damaged(*damage).expect("a case")).collect();
    println!(
        "| damage | mass, kg | cg, chords | flight | alpha | beta | phi | elevator | aileron | rudder | throttle |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let mut found = Vec::new();
    for aircraft in &fleet {
        let (mass, cg) = (aircraft.mass_properties().mass(), aircraft.geometry().cg);
        print!("| {} | {mass:.3} | {cg:.4} |", aircraft.damage());
        match steady(aircraft, speed, altitude) {
            Ok((state, controls, how)) => {
                let degrees =
                    [state.alpha, state.beta, state.phi, controls.elevator, controls.aileron, controls.rudder];
                print!(" {how} |");
                degrees.iter().for_each(|angle| print!(" {:.2} |", angle.to_degrees()));
                println!(" {:.3} |", controls.throttle);
                found.push((aircraft, state, controls));
            }
            Err(why) => println!(" none: {why} |"),
        }
    }

    const NAMES: [(&str, usize, usize); 21] = [
        ("CZ_alpha", 2, 0),
        ("Cm_alpha", 4, 0),
        ("CZ_q", 2, 3),
        ("Cm_q", 4, 3),
        ("CZ_de", 2, 5),
        ("Cm_de", 4, 5),
        ("CY_beta", 1, 1),
        ("Cl_beta", 3, 1),
        ("Cn_beta", 5, 1),
        ("Cl_p", 3, 2),
        ("Cn_p", 5, 2),
        ("CY_r", 1, 4),
        ("Cl_r", 3, 4),
        ("Cn_r", 5, 4),
        ("Cl_da", 3, 6),
        ("Cn_da", 5, 6),
        ("CY_dr", 1, 7),
        ("Cn_dr", 5, 7),
        ("Cl_alpha", 3, 0),
        ("Cl_q", 3, 3),
        ("Cm_beta", 4, 1),
    ];
    println!("\nDerivatives per rad about the centre of gravity, body axes.\n");
    print!("| damage |");
    NAMES.iter().for_each(|(name, ..)| print!(" {name} |"));
    println!("\n|---|{}", "---|".repeat(NAMES.len()));
    for (aircraft, state, controls) in &found {
        let slopes = derivatives(aircraft, state, controls);
        print!("| {} |", aircraft.damage());
        NAMES.iter().for_each(|(_, row, column)| print!(" {:.3} |", slopes[*row][*column]));
        println!();
    }

    println!("\n| damage | longitudinal modes | lateral modes |\n|---|---|---|");
    for (aircraft, state, controls) in &found {
        let model = linearize(*aircraft, state, controls, &Disturbance::default());
        let (longitudinal, lateral) = (model.longitudinal().expect("modes"), model.lateral().expect("modes"));
        println!("| {} | {} | {} |", aircraft.damage(), modes(&longitudinal), modes(&lateral));
    }

    println!("\n| aircraft | coefficients per second | with 17 derivatives |\n|---|---|---|");
    let hybrid = whole.with(&TransportOptions::default()).expect("defaults");
    for (name, aircraft) in [("undamaged, hybrid", &hybrid), ("left-wing-tip-off", &fleet[4])] {
        println!(
            "| {name} | {:.0} | {:.0} |",
            per_second::<f64>(aircraft, 1_000_000),
            per_second::<Dual<17>>(aircraft, 100_000)
        );
    }
}

/// Evaluations of all coefficients per second on one core.
fn per_second<T: Scalar>(aircraft: &Transport, count: usize) -> f64 {
    let begun = Instant::now();
    let mut sum = 0.0;
    for i in 0..count {
        let x = i as f64 / count as f64;
        let air = AirData {
            speed: T::from(40.0),
            alpha: T::from(0.3 * x),
            beta: T::from(0.1 - 0.2 * x),
            density: T::from(1.2),
            dynamic_pressure: T::from(960.0),
            mach: T::from(0.12),
        };
        let controls = Controls {
            throttle: T::from(0.5),
            elevator: T::from(-0.1 * x),
            aileron: T::from(0.05),
            rudder: T::from(0.02),
        };
        sum += aircraft.coefficients(&air, [T::from(0.3), T::from(0.1), T::from(0.1)], &controls).cm.real();
    }
    assert!(sum.is_finite());
    count as f64 / begun.elapsed().as_secs_f64()
}
