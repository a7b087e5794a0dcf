//! Whether the estimate explains the measured lift and drag.
//!
//! Angular accelerations say whether the estimate of the moments is right; lift and drag are felt by the accelerometers:
//!
//! ```text
//! X = (m ax - T cos i)/(qbar S)     Z = (m az + T sin i)/(qbar S)     CL = X sin a - Z cos a     CD = -X cos a - Z sin a
//! ```
//!
//! with the mass, wing, thrust and inclination `i` of the thrust line of the model file. What the estimate gives for the same angles,
//! rates, speeds and positions of the surfaces is compared with that over the last seconds. A slow change (ice, a wing that comes apart, a
//! mass that falls) is no jump that an estimator looks for, and moves this difference long before anything else.

use phugoid_identification::model_file::{AircraftData, Source, Thrust};
use serde::Serialize;

use crate::known::Declared;
use crate::polar::{Condition, Instant, Polar};

/// Parts of the last seconds whose means count as independent, as in `phugoid_control::prediction`.
const BLOCKS: usize = 6;
/// 95 % of a mean of six lie within 2.571 standard errors (Student, five degrees of freedom), and within 1.960 of one that is known.
const STUDENT: f64 = 2.571 / 1.960;
/// Standard errors of the difference beyond which the estimate does not explain a force: chance alone does it once in 370.
pub(crate) const SIGMAS: f64 = 3.0;
/// One standard deviation of the constant error of an accelerometer, g, which nothing tells from a force: that of the built-in model files.
pub(crate) const ACCELEROMETER: f64 = 0.005;
/// The same of the thrust, a part: that of the class `unstated` (docs/model-file.md). Without acceleration thrust is the drag.
pub(crate) const THRUST: f64 = 0.05;
/// A step of the angle of attack for slopes, rad: a hundredth of a radian is small against the bends of any polar, and large against
/// rounding.
const STEP: f64 = 0.01;

/// What is felt at an instant: acceleration along body x and z, m/s^2, thrust, N, and altitude, m.
pub(crate) const FELT: [&str; 4] = ["ax", "az", "thrust", "altitude"];
/// The values of [`FELT`].
pub(crate) type Felt = [f64; FELT.len()];
/// An instant with what was felt at it.
type Row<'a> = (&'a Instant, &'a Felt);

/// What the accelerometers measure and what the estimate gives for it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Force {
    /// Measured coefficient, mean of the last seconds, with the mass of the model file. Finite.
    pub measured: f64,
    /// One standard error of it: scatter, accelerometer, vane and thrust; what the model file declares of mass and airspeed is in the bound of the
    /// estimate and not here.
    pub std_error: f64,
    /// What the estimate gives for the same seconds.
    pub predicted: f64,
    /// One standard error of the difference: that of the measured one, of the estimate, and what the vane's errors make of the estimate.
    pub difference_error: f64,
    /// Whether the difference is within three of these.
    pub explained: bool,
}

impl Force {
    fn new(measured: f64, std_error: f64, predicted: f64, predicted_error: f64) -> Self {
        let difference_error = std_error.hypot(predicted_error);
        let explained = (measured - predicted).abs() <= SIGMAS * difference_error;
        Self { measured, std_error, predicted, difference_error, explained }
    }

    /// By how much the estimate is off, where it does not explain the force; zero where it does.
    pub(crate) fn disagreement(&self) -> f64 {
        if self.explained { 0.0 } else { self.measured - self.predicted }
    }
}

/// Lift and drag over the last seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Forces {
    /// Of the lift coefficient.
    pub lift: Force,
    /// Of the drag coefficient.
    pub drag: Force,
}

/// Where the thrust comes from.
#[derive(Clone, Copy, Debug)]
enum Pull {
    /// It is measured.
    Measured,
    /// It is as at the first sample, where the flight begins in its trim.
    First,
    /// It is this, N.
    Constant(f64),
}

/// What a model file says of mass and thrust.
#[derive(Clone, Debug)]
pub(crate) struct Rigid {
    /// kg; NaN where it comes from a channel that is not measured in these flights.
    mass: f64,
    wing_area: f64,
    thrust: Pull,
    inclination: f64,
}

impl Rigid {
    /// From the model file.
    pub(crate) fn of(aircraft: &AircraftData) -> Self {
        Self {
            mass: match &aircraft.mass {
                Source::Constant(mass) => *mass,
                Source::Channel(_) => f64::NAN,
            },
            wing_area: aircraft.wing_area,
            thrust: match &aircraft.thrust {
                Thrust::Known(Source::Constant(thrust)) => Pull::Constant(*thrust),
                Thrust::Known(Source::Channel(_)) => Pull::Measured,
                Thrust::Trim => Pull::First,
            },
            inclination: aircraft.thrust_inclination,
        }
    }

    /// Takes the thrust (N) of the first sample, where the model file says that it stays as in the trim.
    pub(crate) fn begin(&mut self, thrust: f64) {
        if matches!(self.thrust, Pull::First) && thrust.is_finite() {
            self.thrust = Pull::Constant(thrust);
        }
    }

    /// Thrust at an instant, N; NaN where it was not measured and has to be.
    pub(crate) fn thrust(&self, felt: &Felt) -> f64 {
        match self.thrust {
            Pull::Constant(thrust) => thrust,
            Pull::Measured | Pull::First => felt[2],
        }
    }

    /// Lift and drag coefficient that were felt at an instant, at an air density in kg/m^3; NaN where something was not measured.
    fn coefficients(&self, instant: &Instant, felt: &Felt, density: f64) -> [f64; 2] {
        let [ax, az, ..] = *felt;
        let thrust = self.thrust(felt);
        let force = 0.5 * density * instant[5] * instant[5] * self.wing_area;
        let x = (self.mass * ax - thrust * self.inclination.cos()) / force;
        let z = (self.mass * az + thrust * self.inclination.sin()) / force;
        let (sine, cosine) = instant[0].sin_cos();
        [x * sine - z * cosine, -x * cosine - z * sine]
    }
}

/// The forces of these instants (`flown` and what was `felt`, as long as each other), against what the estimate gives (`predicted`) with its
/// covariance; none where too little was measured. `density` gives the air density in kg/m^3 at an altitude in m, `vane` is one standard
/// deviation of the constant error of the angle of attack, rad.
pub(crate) fn forces(
    rigid: &Rigid,
    flown: &[Instant],
    felt: &[Felt],
    predicted: &dyn Fn(&Condition) -> Polar,
    covariance: &[Vec<f64>],
    density: &dyn Fn(f64) -> f64,
    vane: f64,
) -> Option<Forces> {
    let rows: Vec<Row<'_>> = flown
        .iter()
        .zip(felt)
        .filter(|(instant, felt)| instant.iter().all(|value| value.is_finite()) && felt[3].is_finite())
        .collect();
    let of_block = rows.len() / BLOCKS;
    if of_block == 0 {
        return None;
    }
    let mean = |rows: &[Row<'_>]| {
        let count = rows.len() as f64;
        let of = |pick: &dyn Fn(&Row<'_>) -> f64| rows.iter().map(pick).sum::<f64>() / count;
        let at = |j: usize| of(&|row| row.0[j]);
        let condition = Condition {
            flown: [at(5), of(&|row| row.1[3])],
            angles: [at(0), at(1)],
            rates: [at(2), at(3), at(4)],
            positions: [at(6), at(7), at(8)],
        };
        let felt = |k: usize| of(&|(instant, felt)| rigid.coefficients(instant, felt, density(felt[3]))[k]);
        (condition, [felt(0), felt(1)])
    };
    let (condition, measured) = mean(&rows[rows.len() - BLOCKS * of_block..]);
    // What an estimate leaves of gusts is of one sign for some tenths of a second: means of blocks are independent, samples are not.
    let left = rows[rows.len() - BLOCKS * of_block..].chunks(of_block).map(|block| {
        let (condition, measured) = mean(block);
        let predicted = predicted(&condition).value;
        [measured[0] - predicted[0], measured[1] - predicted[1]]
    });
    let left: Vec<[f64; 2]> = left.collect();
    let now = predicted(&condition);
    let [higher, lower] = [STEP, -STEP].map(|step| {
        let mut there = condition;
        there.angles[0] += step;
        predicted(&there).value
    });
    // The scale of a vane shows a steady angle of attack at another place, as its constant error does.
    let vane = vane.hypot(Declared::UNSTATED.flow_angle_scale * condition.angles[0]);
    let [lift, drag] = measured;
    let along = [ACCELEROMETER * lift, (ACCELEROMETER * lift).hypot(THRUST * drag)];
    // A vane that is off turns the measured force: what is lift with it is drag without.
    let turned = [drag * vane, lift * vane];
    let one = |k: usize| {
        let middle = left.iter().map(|row| row[k]).sum::<f64>() / BLOCKS as f64;
        let square: f64 = left.iter().map(|row| (row[k] - middle) * (row[k] - middle)).sum();
        let scatter = STUDENT * (square / ((BLOCKS - 1) * BLOCKS) as f64).sqrt();
        let std_error = scatter.hypot(along[k]).hypot(turned[k]);
        let weights = if k == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
        let slope = (higher[k] - lower[k]) / (2.0 * STEP);
        let predicted_error = now.variance(weights, None, covariance).sqrt().hypot(slope * vane);
        let force = Force::new(measured[k], std_error, measured[k] - middle, predicted_error);
        (force.measured.is_finite() && force.difference_error.is_finite()).then_some(force)
    };
    Some(Forces { lift: one(0)?, drag: one(1)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGID: Rigid = Rigid { mass: 1000.0, wing_area: 10.0, thrust: Pull::Measured, inclination: 0.0 };

    /// CL = 0.3 + 5 a and CD = 0.03 by a parameter each.
    fn predicted(at: &Condition) -> Polar {
        Polar { value: [0.3 + 5.0 * at.angles[0], 0.03], by_parameter: vec![[1.0, 0.0], [0.0, 1.0]] }
    }

    /// Three seconds at 0.02 rad and 100 m/s in air of 1 kg/m^3, so that a coefficient of one is 50 kN, with a lift that differs from the
    /// estimate's by this.
    fn found(lift_off: f64, drag_off: f64) -> Option<Forces> {
        let instant: Instant = [0.02, 0.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0];
        let (lift, drag) = (0.4 + lift_off, 0.03 + drag_off);
        let (sine, cosine) = 0.02_f64.sin_cos();
        let (x, z) = (lift * sine - drag * cosine, -lift * cosine - drag * sine);
        // The thrust of 1 kN stands in the acceleration.
        let felt = [(x * 50e3 + 1000.0) / 1000.0, z * 50e3 / 1000.0, 1000.0, 0.0];
        let covariance = [vec![1e-6, 0.0], vec![0.0, 1e-6]];
        forces(&RIGID, &[instant; 300], &[felt; 300], &predicted, &covariance, &|_| 1.0, 0.00175)
    }

    #[test]
    fn a_lift_that_the_estimate_does_not_give_is_seen() {
        let right = found(0.0, 0.0).unwrap();
        assert!((right.lift.measured - 0.4).abs() < 1e-9 && (right.drag.measured - 0.03).abs() < 1e-9, "{right:?}");
        assert!(right.lift.explained && right.drag.explained, "{right:?}");
        // Vane: 5 per rad times 0.00175 rad and 3 % of 0.02 rad; accelerometer 0.002; estimate 0.001.
        let error = (5.0 * 0.00175_f64.hypot(0.0006)).hypot(0.002).hypot(0.001);
        assert!((right.lift.difference_error - error).abs() < 2e-5, "{right:?} {error}");
        // What the vane may be off by is no disagreement, and four times as much is one.
        let within = found(2.0 * error, 0.0).unwrap();
        assert!(within.lift.explained && within.lift.disagreement() == 0.0);
        let beyond = found(-4.0 * error, 0.0).unwrap();
        assert!(!beyond.lift.explained && beyond.drag.explained, "{beyond:?}");
        assert!((beyond.lift.disagreement() + 4.0 * error).abs() < 1e-9);
        assert!(!found(0.0, 0.02).unwrap().drag.explained);
    }

    #[test]
    fn without_accelerometers_or_mass_there_is_nothing_to_compare() {
        assert!(found(f64::NAN, 0.0).is_none());
        let none = forces(&RIGID, &[], &[], &predicted, &[], &|_| 1.0, 0.00175);
        assert!(none.is_none());
    }
}
