//! At what time each control surface was recorded, by when the aircraft reacts to it.
//!
//! A surface makes a moment at once. So the equation of the angular rate about its axis has the time of the surface as
//! one of its parameters, beside derivatives that need not be known ([`equation`]). What is found is the time that makes
//! the record most likely, and its standard error.

pub(crate) mod delay;
mod equation;
mod samples;
mod whitening;

use crate::model_file::ModelFile;
use crate::motion::Motion;
use crate::preparation::prepared::Prepared;
use crate::preparation::windows::channels::Channels;
use crate::preparation::windows::delay::{product, scales};
use delay::SurfaceDelay;
use equation::{Equation, late};

/// Channels of the pitching moment, and the accelerometer that some aircraft have.
const PITCH: [&str; 5] = ["true_airspeed", "alpha", "q", "elevator", "az"];
/// Channels of the rolling and the yawing moment.
const ROLL_AND_YAW: [&str; 6] = ["true_airspeed", "beta", "p", "r", "aileron", "rudder"];
/// When the surfaces of a flight were recorded; those of which the flight says it.
pub(crate) fn surfaces<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
) -> Vec<SurfaceDelay> {
    let mut found = Vec::new();
    if M::AXES.has_longitudinal() {
        // The accelerometer is a help, and not needed.
        let channels = Channels::of(prepared, file, &PITCH).or_else(|| Channels::of(prepared, file, &PITCH[..4]));
        found.extend(channels.and_then(|channels| elevator(&channels)));
    }
    if M::AXES.has_lateral() {
        found.extend(Channels::of(prepared, file, &ROLL_AND_YAW).iter().filter_map(aileron_and_rudder).flatten());
    }
    found
}

/// The elevator's, by the pitching moment, from the channels of [`PITCH`] with or without the accelerometer.
///
/// The downwash of the wing reaches the tail late: the moment follows the rate of the flow angle, too, which is
/// `q + (az + g)/V` in level flight. The rate `q` is in the equation, and the accelerometer is one more cause.
pub(crate) fn elevator(channels: &Channels) -> Option<SurfaceDelay> {
    let ([speed, alpha, q, elevator], az) = match channels.values::<5>() {
        Some([speed, alpha, q, elevator, az]) => ([speed, alpha, q, elevator], Some(az)),
        None => (channels.values::<4>()?, None),
    };
    let (pressure, _) = scales(speed)?;
    let mut causes = vec![product(&pressure, &about_mean(alpha))];
    causes.extend(az.map(about_mean));
    time_of("elevator", channels, q, causes, &product(&pressure, &about_mean(elevator)))
}

/// The aileron's by the rolling moment, and the rudder's by the yawing moment.
fn aileron_and_rudder(channels: &Channels) -> Option<Vec<SurfaceDelay>> {
    let [speed, beta, p, r, aileron, rudder] = channels.values::<6>()?;
    let (pressure, relative) = scales(speed)?;
    let by_pressure = |values: &[f64]| product(&pressure, &about_mean(values));
    let (aileron, rudder) = (by_pressure(aileron), by_pressure(rudder));
    let of = |name, rate, other_rate: &[f64], surface: &[f64], other: &[f64]| {
        // The other surface may be late, too: to the first order its delay is a factor on its rate.
        let causes = vec![
            by_pressure(beta),
            product(&relative, other_rate),
            other.to_vec(),
            samples::rate(&channels.time_s, other),
        ];
        time_of(name, channels, rate, causes, surface)
    };
    Some(
        [of("aileron", p, r, &aileron, &rudder), of("rudder", r, p, &rudder, &aileron)].into_iter().flatten().collect(),
    )
}

fn time_of(
    name: &'static str,
    channels: &Channels,
    rate: &[f64],
    causes: Vec<Vec<f64>>,
    surface: &[f64],
) -> Option<SurfaceDelay> {
    let step_s = channels.step_s()?;
    let (late_s, std_s) = late(Equation { time_s: &channels.time_s, step_s, rate, causes, surface })?;
    Some(SurfaceDelay { name, late_s, std_s, step_s })
}

/// Values less their mean: noise of the dynamic pressure then multiplies what moves alone. Of a channel that stands still nothing is
/// left, where the rounding of its mean would be.
fn about_mean(values: &[f64]) -> Vec<f64> {
    if !samples::moves(values, samples::largest(values)) {
        return vec![0.0; values.len()];
    }
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| value - mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_that_stands_still_has_no_time() {
        // The pitching of a lateral flight, and an elevator at the deflection of trim: the mean of 2000 of them is not the same
        // number as each, to the last digit, and the dynamic pressure is not constant.
        let time_s: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        let of = |signal: &dyn Fn(f64) -> f64| time_s.iter().map(|t| signal(*t)).collect::<Vec<f64>>();
        let speed = of(&|t| 206.0 + (0.4 * t).sin() + 0.3 * (3.1 * t).cos());
        let (alpha, q) = (of(&|t| 0.041 + 0.004 * (1.3 * t).sin()), of(&|t| 0.006 * (1.3 * t + 0.4).cos()));
        let elevator = vec![-0.034_252_802_430_439; 2000];
        assert!(elevator.iter().sum::<f64>() / 2000.0 != elevator[0], "the mean is rounded");
        let channels = Channels::for_tests(time_s, vec![speed, alpha, q, elevator]);
        assert!(super::elevator(&channels).is_none());
    }

    /// Rolling and yawing at 50 Hz (per s: L_beta = -15, L_p = -4, L_r = 1, L_aileron = -20; N_beta = 6, N_p = -0.2, N_r = -0.8,
    /// N_aileron = -1, N_rudder = -4) under aileron and rudder doublets behind actuators of 20 rad/s, with a deterministic
    /// scatter of sensors: airspeed, beta, p, r, aileron and rudder. The aileron is recorded late by so many samples.
    fn lateral_flight(aileron_late: usize, rudder: impl Fn(f64) -> f64) -> Channels {
        const FINE: usize = 20;
        let dt = 0.02 / FINE as f64;
        let [mut beta, mut p, mut r, mut aileron, mut rudder_at] = [0.0, 0.0, 0.0, 0.0, rudder(0.0)];
        let mut rows: Vec<[f64; 5]> = Vec::new();
        for k in 0..1500 * FINE {
            let t = k as f64 * dt;
            if k % FINE == 0 {
                rows.push([beta, p, r, aileron, rudder_at]);
            }
            let command = match (t % 10.0) as i32 {
                1 | 4 => 0.05,
                2 | 3 => -0.05,
                _ => 0.0,
            };
            aileron += dt * 20.0 * (command - aileron);
            rudder_at += dt * 20.0 * (rudder(t) - rudder_at);
            let yaw = 6.0 * beta - 0.2 * p - 0.8 * r - aileron - 4.0 * rudder_at;
            let roll = -15.0 * beta - 4.0 * p + r - 20.0 * aileron;
            beta += dt * (-0.2 * beta - r);
            p += dt * roll;
            r += dt * yaw;
        }
        let scatter = |k: usize, i: usize| 5e-4 * (12.9898 * k as f64 + 78.233 * i as f64).sin();
        let of = |i: usize| (0..1500).map(|k| rows[k][i] + scatter(k, i)).collect::<Vec<f64>>();
        let surface = |i: usize, late: usize| (0..1500).map(|k: usize| rows[k.saturating_sub(late)][i]).collect();
        let time_s = (0..1500).map(|k| 0.02 * f64::from(k)).collect();
        Channels::for_tests(
            time_s,
            vec![vec![60.0; 1500], of(0), of(1), of(2), surface(3, aileron_late), surface(4, 0)],
        )
    }

    #[test]
    fn a_rudder_that_stands_still_hides_no_late_aileron() {
        // At zero, at the deflection of trim, whose mean is rounded, and moving.
        let doublet = |t: f64| if (t % 10.0) as i32 == 6 { 0.05 } else { 0.0 };
        for (rudder, count) in [(&(|_| 0.0) as &dyn Fn(f64) -> f64, 1), (&|_| 0.034_252_802_430_439, 1), (&doublet, 2)]
        {
            for late in [0, 3] {
                let found = aileron_and_rudder(&lateral_flight(late, rudder)).unwrap();
                assert_eq!(found.len(), count, "{found:?}");
                let SurfaceDelay { name, late_s, std_s, .. } = found[0];
                // A millisecond: straight lines between samples of an actuator's motion are that far off.
                assert!(name == "aileron" && (late_s - 0.02 * late as f64).abs() < 3.0 * std_s + 1.5e-3, "{found:?}");
                assert!(std_s < 4e-3, "{found:?}");
            }
        }
    }
}
