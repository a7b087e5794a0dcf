//! Random damages of a fighter in cruise: what the study of recoveries flies.

use std::collections::BTreeMap;

use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_simulation::equivalent::derivatives;
use phugoid_simulation::manoeuvre::Surface;
use phugoid_simulation::quantity::{Angle, AngularRate, Frequency, Length, Speed, Time};
use phugoid_simulation::scenario::{Damage, Failure, FailureKind, Scenario, Spectrum, Turbulence};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// When everything happens, s: before it the estimator has learnt the healthy aircraft.
pub const DAMAGE_AT_S: f64 = 10.0;

/// What is damaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Static stability and damping in pitch.
    Stability,
    /// A part of the elevator.
    Elevator,
    /// A part of the ailerons.
    Ailerons,
    /// A part or all of the rudder.
    Rudder,
    /// A part of the vertical tail.
    VerticalTail,
    /// A part of one wing.
    Wing,
    /// A surface that stays where it is.
    Jam,
    /// A surface that trails in the air.
    Float,
    /// A surface that has become slow.
    Slow,
    /// A surface that oscillates.
    Oscillation,
    /// Mass, inertia and centre of gravity.
    Mass,
    /// Thrust, on one side.
    Thrust,
    /// Ice that grows.
    Ice,
    /// Constant moments.
    Moments,
}

impl Class {
    /// All, in the order of tables.
    pub const ALL: [Self; 14] = [
        Self::Stability,
        Self::Elevator,
        Self::Ailerons,
        Self::Rudder,
        Self::VerticalTail,
        Self::Wing,
        Self::Jam,
        Self::Float,
        Self::Slow,
        Self::Oscillation,
        Self::Mass,
        Self::Thrust,
        Self::Ice,
        Self::Moments,
    ];

    /// In words.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Stability => "stability and damping in pitch",
            Self::Elevator => "part of the elevator",
            Self::Ailerons => "part of the ailerons",
            Self::Rudder => "part of the rudder",
            Self::VerticalTail => "part of the vertical tail",
            Self::Wing => "part of one wing",
            Self::Jam => "jammed surface",
            Self::Float => "floating surface",
            Self::Slow => "slow surface",
            Self::Oscillation => "oscillating surface",
            Self::Mass => "mass and centre of gravity",
            Self::Thrust => "thrust, on one side",
            Self::Ice => "ice that grows",
            Self::Moments => "constant moments",
        }
    }
}

/// The classes of damage number `index`: the first goes through all, every second one comes with another, every eighth with two.
pub fn classes(index: usize, seed: u64) -> Vec<Class> {
    let mut draw = Draw { random: Pcg64::seed_from_u64(seed ^ 0x0063_6c61_7373_6573) };
    let mut classes = vec![Class::ALL[index % Class::ALL.len()]];
    let more = match index / Class::ALL.len() % 8 {
        7 => 2,
        k if k % 2 == 1 => 1,
        _ => 0,
    };
    while classes.len() < 1 + more {
        let next = Class::ALL[draw.random.random_range(0..Class::ALL.len())];
        if !classes.contains(&next) {
            classes.push(next);
        }
    }
    classes
}

struct Draw {
    random: Pcg64,
}

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random.random::<f64>()
    }

    fn sign(&mut self) -> f64 {
        if self.random.random::<bool>() { 1.0 } else { -1.0 }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }

    fn surface(&mut self) -> Surface {
        [Surface::Elevator, Surface::Aileron, Surface::Rudder][self.random.random_range(0..3)]
    }
}

/// The base scenario with random damages of these classes, random air and random systematic errors of sensors and mass, all from the
/// seed. Errors are those of the class `unstated` of the declared uncertainties: scales of airspeed 1.5 %, flow angles 3 %, surfaces
/// 3 %, mass 3 %, inertia 6 %.
pub fn damaged<A: Aircraft>(base: &Scenario, aircraft: &A, trim: &Trim, classes: &[Class], seed: u64) -> Scenario {
    let mut draw = Draw { random: Pcg64::seed_from_u64(seed ^ 0x7265_636f_7665_7279) };
    let mut scenario = Scenario { seed, ..base.clone() };
    let words: Vec<&str> = classes.iter().map(|class| class.word()).collect();
    scenario.name = format!("{} (seed {seed})", words.join(" and "));
    let healthy = derivatives(aircraft, trim);
    scenario.turbulence = Some(Turbulence {
        intensity: None,
        spectrum: Spectrum::Dryden,
        sigma: Some(Speed::from_si(draw.between(0.0, 2.2))),
        rates: false,
    });
    let sensors = &mut scenario.sensors;
    sensors.true_airspeed.scale_error_spread = 0.015;
    sensors.alpha.scale_error_spread = 0.03;
    sensors.beta.scale_error_spread = 0.03;
    sensors.elevator.scale_error_spread = 0.03;
    sensors.aileron.scale_error_spread = 0.03;
    sensors.rudder.scale_error_spread = 0.03;
    let (mass, inertia) = (1.0 + 0.03 * draw.normal(), [0.0; 3].map(|_: f64| 1.0 + 0.06 * draw.normal()));
    let before = Damage { mass: Some(mass), inertia: Some(inertia), ..Damage::default() };
    let mut damage = Damage { at: Time::from_si(DAMAGE_AT_S), ..before.clone() };
    scenario.failure.clear();
    for class in classes {
        put_in(&mut scenario, &mut damage, *class, &mut draw, &healthy);
    }
    scenario.damage = vec![before, damage];
    scenario
}

/// Adds one damage to what is there.
fn put_in(
    scenario: &mut Scenario,
    damage: &mut Damage,
    class: Class,
    draw: &mut Draw,
    healthy: &BTreeMap<String, f64>,
) {
    let known = |name: &str| healthy.get(name).copied().unwrap_or(0.0);
    let i = &mut damage.increments;
    match class {
        Class::Stability => {
            i.dCm_alpha += draw.between(0.1, 0.5);
            i.dCm_q += -draw.between(0.0, 0.7) * known("Cm_q");
        }
        Class::Elevator => {
            weaken(&mut damage.effectiveness, &[("elevator", draw.between(0.3, 0.8))]);
            increase(&mut damage.constants, &[("Cm", draw.between(-0.01, 0.01))]);
        }
        Class::Ailerons => {
            weaken(&mut damage.effectiveness, &[("aileron", draw.between(0.2, 0.7))]);
            increase(&mut damage.constants, &[("Cl", draw.between(-0.004, 0.004))]);
        }
        Class::Rudder => weaken(&mut damage.effectiveness, &[("rudder", draw.between(0.0, 0.6))]),
        Class::VerticalTail => {
            let lost = draw.between(0.3, 0.9);
            i.dCn_beta += -lost * known("Cn_beta");
            i.dCn_r += -lost * known("Cn_r");
            i.dCY_beta += -0.6 * lost * known("CY_beta");
            i.dCl_beta += -0.2 * lost * known("Cl_beta");
            weaken(&mut damage.effectiveness, &[("rudder", 1.0 - lost)]);
        }
        Class::Wing => {
            let (lost, side) = (draw.between(0.05, 0.25), draw.sign());
            let lift = known("CL_0");
            i.dCL_alpha += -lost * known("CL_alpha");
            i.dCl_p += -1.5 * lost * known("Cl_p");
            weaken(&mut damage.effectiveness, &[("aileron", 1.0 - 1.5 * lost)]);
            // The lift that is lost acts at a third of the span.
            increase(
                &mut damage.constants,
                &[
                    ("CL", -lost * lift),
                    ("CD", 0.01 * lost),
                    ("Cl", side * 0.12 * lost * lift),
                    ("Cn", -side * 0.01 * lost),
                ],
            );
            increase(
                &mut damage.coupling,
                &[
                    ("Cl_alpha", side * 0.12 * lost * known("CL_alpha")),
                    ("Cn_alpha", -side * 0.02 * lost * known("CL_alpha")),
                    ("Cm_beta", side * 0.1 * lost),
                ],
            );
            damage.mass = damage.mass.map(|mass| mass * (1.0 - 0.1 * lost));
        }
        Class::Jam => {
            let surface = draw.surface();
            let off = match surface {
                // Where it happens to be: the pilot has no second elevator.
                Surface::Elevator => None,
                _ => Some(Angle::from_si(draw.between(-3.0, 3.0).to_radians())),
            };
            scenario.failure.push(Failure { position: off, ..failure(surface, FailureKind::Jam) });
        }
        Class::Float => {
            let surface = draw.surface();
            scenario.failure.push(failure(surface, FailureKind::Float));
        }
        Class::Slow => {
            let rate_limit = Some(AngularRate::from_si(draw.between(4.0, 15.0).to_radians()));
            let surface = draw.surface();
            scenario.failure.push(Failure { rate_limit, ..failure(surface, FailureKind::RateLimit) });
        }
        Class::Oscillation => {
            let amplitude = Some(Angle::from_si(draw.between(1.0, 3.0).to_radians()));
            let frequency = Some(Frequency::from_si(draw.between(0.5, 2.0)));
            let surface = draw.surface();
            scenario.failure.push(Failure { amplitude, frequency, ..failure(surface, FailureKind::Oscillation) });
        }
        Class::Mass => {
            damage.mass = damage.mass.map(|mass| mass * draw.between(0.85, 1.0));
            damage.inertia = damage.inertia.map(|inertia| inertia.map(|factor| factor * draw.between(0.8, 1.1)));
            damage.cg_shift = draw.between(0.02, 0.06);
        }
        Class::Thrust => {
            damage.thrust = Some(draw.between(0.3, 0.9));
            damage.thrust_arm = Length::from_si(draw.sign() * draw.between(0.3, 1.5));
        }
        Class::Ice => {
            damage.over = Time::from_si(20.0);
            i.dCL_alpha += -draw.between(0.1, 0.3) * known("CL_alpha");
            i.dCm_alpha += draw.between(0.0, 0.2);
            i.dCm_q += -draw.between(0.0, 0.4) * known("Cm_q");
            weaken(
                &mut damage.effectiveness,
                &[("elevator", draw.between(0.6, 1.0)), ("aileron", draw.between(0.6, 1.0))],
            );
            increase(&mut damage.constants, &[("CD", draw.between(0.002, 0.01))]);
        }
        Class::Moments => {
            increase(
                &mut damage.constants,
                &[
                    ("Cm", draw.between(-0.02, 0.02)),
                    ("Cl", draw.between(-0.006, 0.006)),
                    ("Cn", draw.between(-0.004, 0.004)),
                ],
            );
        }
    }
}

fn increase(table: &mut BTreeMap<String, f64>, entries: &[(&str, f64)]) {
    for (name, value) in entries {
        *table.entry((*name).to_owned()).or_insert(0.0) += value;
    }
}

fn weaken(table: &mut BTreeMap<String, f64>, entries: &[(&str, f64)]) {
    for (name, left) in entries {
        *table.entry((*name).to_owned()).or_insert(1.0) *= left;
    }
}

fn failure(surface: Surface, kind: FailureKind) -> Failure {
    Failure {
        surface,
        at: Time::from_si(DAMAGE_AT_S),
        kind,
        position: None,
        rate_limit: None,
        delay: None,
        play: None,
        amplitude: None,
        frequency: None,
    }
}
