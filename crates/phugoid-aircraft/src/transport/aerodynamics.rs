//! The coefficients of one configuration about the moment reference point.

use std::sync::Arc;

use phugoid_flight_dynamics::aircraft::Controls;
use phugoid_flight_dynamics::scalar::Scalar;

use super::RateModel;
use super::axis::{Place, blend_1, blend_2, blend_3};
use super::damage::Damage;
use super::options::TransportOptions;
use super::tables::{CASES, Tables};
use super::vehicle::Gone;

/// Places of the coefficients in an array.
const CX: usize = 0;
const CY: usize = 1;
const CZ: usize = 2;
const CL: usize = 3;
const CM: usize = 4;
const CN: usize = 5;
/// Where the components of tables with three of them belong.
const LONGITUDINAL: [usize; 3] = [CX, CZ, CM];
const LATERAL: [usize; 3] = [CY, CL, CN];
const BY_RATE: [[usize; 3]; 3] = [LATERAL, LONGITUDINAL, LATERAL];
/// Rates p, q, r.
const RATES: usize = 3;

/// What one configuration needs of the tables. What does not change in flight is added up beforehand.
#[derive(Clone, Debug)]
pub(super) struct Aerodynamics {
    tables: Arc<Tables>,
    /// (alpha, beta): the airframe with stabiliser, flaps, spoilers and gear.
    airframe: Vec<[f64; 6]>,
    /// (alpha, beta, elevator): CX, CZ, Cm of the segments that are there.
    elevator: Vec<[f64; 3]>,
    /// Mean distance of those segments to the right of the plane of symmetry, spans.
    elevator_arm: f64,
    left_aileron: bool,
    /// Share of the rudder that is there.
    rudder: f64,
    rates: RateModel,
    damage: Option<DamageCase>,
}

/// The tables of one damage case.
#[derive(Clone, Debug)]
struct DamageCase {
    increment: Vec<[f64; 6]>,
    /// Six factors for each rate.
    scale: Vec<[f64; 6 * RATES]>,
    /// Six derivatives for each rate.
    rate: Vec<[f64; 6 * RATES]>,
}

impl Aerodynamics {
    pub(super) fn new(tables: Arc<Tables>, options: &TransportOptions, gone: &Gone) -> Self {
        let stabiliser = if gone.stabiliser_setting { 0.0 } else { options.stabiliser };
        let [inboard, outboard] = options.elevator_arms;
        let segments = [
            (gone.left_outboard_elevator, -outboard),
            (gone.left_inboard_elevator, -inboard),
            (false, inboard),
            (false, outboard),
        ];
        let there = segments.iter().filter(|(gone, _)| !gone);
        let count = there.clone().count() as f64;
        let elevators = count / segments.len() as f64;
        let halves = [gone.upper_rudder, gone.lower_rudder];
        let set = tables.stabiliser.place(stabiliser);
        let neutral = tables.elevator.place(0.0);
        let mut airframe = tables.basic.clone();
        let mut elevator = Vec::with_capacity(airframe.len() * tables.elevator.len());
        let layers = tables.elevator.len();
        for (cell, coefficients) in airframe.iter_mut().enumerate() {
            let settings = &tables.stabiliser_elevator[cell * tables.stabiliser.len() * layers..];
            let without = blend_2(settings, layers, &set, &neutral);
            add_some(coefficients, LONGITUDINAL, &without);
            for k in 0..layers {
                let deflected = blend_2(settings, layers, &set, &tables.elevator.place(tables.elevator.point(k)));
                elevator.push(std::array::from_fn(|c| elevators * (deflected[c] - without[c])));
            }
            add_some(coefficients, LATERAL, &tables.symmetric_correction[cell]);
            let (row, column) = (cell / tables.beta.len(), cell % tables.beta.len());
            if options.gear_down {
                add_some(coefficients, LONGITUDINAL, &tables.landing_gear[2 * row + 1]);
            }
            let [left, right] = options.spoilers;
            let alpha = tables.alpha.place(tables.alpha.point(row));
            let beta = tables.beta.point(column);
            let spoiler = |beta: f64, angle: f64| {
                let sizes = [tables.beta.len(), tables.spoiler.len()];
                let (beta, angle) = (tables.beta.place(beta), tables.spoiler.place(angle));
                blend_3(&tables.spoiler_right, sizes, &alpha, &beta, &angle)
            };
            add_all(coefficients, &spoiler(beta, right), 1.0);
            add_all(coefficients, &mirrored(spoiler(-beta, left)), 1.0);
            let flaps = options.flaps.to_degrees();
            for (segment, per_degree) in tables.flaps.iter().enumerate() {
                if !(segment == 0 && gone.left_outboard_flap) {
                    add_all(coefficients, per_degree, flaps);
                }
            }
        }
        Self {
            airframe,
            elevator,
            elevator_arm: there.map(|(_, arm)| arm).sum::<f64>() / count.max(1.0),
            left_aileron: !gone.left_aileron,
            rudder: halves.iter().filter(|gone| !**gone).count() as f64 / halves.len() as f64,
            rates: options.rates,
            damage: DamageCase::new(&tables, options),
            tables,
        }
    }

    /// CX, CY, CZ, Cl, Cm, Cn about the moment reference point: angles in rad, rates p b/2V, q c/2V, r b/2V.
    pub(super) fn coefficients<T: Scalar>(&self, alpha: T, beta: T, rates: [T; 3], controls: &Controls<T>) -> [T; 6] {
        let mut sum = self.without_rates(alpha, beta, controls);
        match &self.damage {
            None => self.undamaged_rates(&mut sum, alpha, beta, rates),
            Some(case) => self.damaged_rates(case, &mut sum, alpha, rates),
        }
        sum
    }

    /// The same without what the rates add, which is not all zero at rates of zero.
    pub(super) fn without_rates<T: Scalar>(&self, alpha: T, beta: T, controls: &Controls<T>) -> [T; 6] {
        let tables = &*self.tables;
        let columns = tables.beta.len();
        let (a, b, opposite) = (tables.alpha.place(alpha), tables.beta.place(beta), tables.beta.place(-beta));
        let mut sum = blend_2(&self.airframe, columns, &a, &b);

        let (place, layers) = (tables.elevator.place(controls.elevator), tables.elevator.len());
        let elevator = blend_3(&self.elevator, [columns, layers], &a, &b, &place);
        add_some(&mut sum, LONGITUDINAL, &elevator);
        if self.elevator_arm != 0.0 {
            let [cx, cz, _] = elevator;
            sum[CL] = sum[CL] + cz * self.elevator_arm;
            sum[CN] = sum[CN] - cx * self.elevator_arm;
        }

        let sizes = [columns, tables.aileron.len()];
        let aileron =
            |beta: &Place<T>, angle: T| blend_3(&tables.aileron_right, sizes, &a, beta, &tables.aileron.place(angle));
        // Positive rolls to the left: the trailing edge goes down on the right and up on the left.
        add_all(&mut sum, &aileron(&b, controls.aileron), 1.0);
        if self.left_aileron {
            add_all(&mut sum, &mirrored(aileron(&opposite, -controls.aileron)), 1.0);
        }

        if self.rudder > 0.0 {
            let sizes = [columns, tables.rudder.len()];
            let rudder = |beta: &Place<T>, angle: T| {
                blend_3(&tables.rudder_negative, sizes, &a, beta, &tables.rudder.place(angle))
            };
            let angle = controls.rudder;
            if angle.real() == 0.0 && !T::IS_REAL {
                // Both sides meet here; the derivative is the mean of both.
                add_all(&mut sum, &rudder(&b, angle), 0.5 * self.rudder);
                add_all(&mut sum, &mirrored(rudder(&opposite, -angle)), 0.5 * self.rudder);
            } else if angle.real() > 0.0 {
                add_all(&mut sum, &mirrored(rudder(&opposite, -angle)), self.rudder);
            } else {
                add_all(&mut sum, &rudder(&b, angle), self.rudder);
            }
        }

        if let Some(case) = &self.damage {
            let tables = &tables.damage;
            let (a, b) = (tables.alpha.place_within(alpha), tables.beta.place_within(beta));
            add_all(&mut sum, &blend_2(&case.increment, tables.beta.len(), &a, &b), 1.0);
        }
        sum
    }

    fn undamaged_rates<T: Scalar>(&self, sum: &mut [T; 6], alpha: T, beta: T, rates: [T; 3]) {
        let mut rests = rates;
        if self.rates == RateModel::Hybrid {
            let (sin_alpha, cos_alpha) = alpha.sin_cos();
            let (sin_beta, cos_beta) = beta.sin_cos();
            if let Some(omega) = steady_rotation(rates, [cos_alpha * cos_beta, sin_alpha * cos_beta]) {
                let rotary = &self.tables.rotary;
                let (a, o) = (rotary.alpha.place(alpha), rotary.omega.place_within(omega));
                let (b, sizes) = (rotary.beta.place(beta), [rotary.omega.len(), rotary.beta.len()]);
                add_all(sum, &blend_3(&rotary.data, sizes, &a, &o, &b), 1.0);
                // The pitch rate is made dimensionless with the chord, the steady rotation with the span.
                let [p, q, r] = rates;
                let chord_by_span = self.tables.chord_by_span;
                rests = [
                    p - omega * cos_alpha * cos_beta,
                    q - omega * sin_beta * chord_by_span,
                    r - omega * sin_alpha * cos_beta,
                ];
            }
        }
        for (axis, rest) in rests.into_iter().enumerate() {
            add_some(sum, BY_RATE[axis], &self.oscillation(axis, alpha, rest));
        }
    }

    fn damaged_rates<T: Scalar>(&self, case: &DamageCase, sum: &mut [T; 6], alpha: T, rates: [T; 3]) {
        let tables = &self.tables.damage;
        let scale = blend_1(&case.scale, &tables.scale_alpha.place_within(alpha));
        let rate = blend_1(&case.rate, &tables.rate_alpha.place_within(alpha));
        for (axis, hat) in rates.into_iter().enumerate() {
            let increment = self.oscillation(axis, alpha, hat);
            for (value, component) in increment.into_iter().zip(BY_RATE[axis]) {
                sum[component] = sum[component] + value * scale[6 * axis + component];
            }
            for component in 0..6 {
                sum[component] = sum[component] + rate[6 * axis + component] * hat;
            }
        }
    }

    fn oscillation<T: Scalar>(&self, axis: usize, alpha: T, hat: T) -> [T; 3] {
        let table = &self.tables.oscillation[axis];
        let (a, rate) = (table.alpha.place(alpha), table.rate.place(hat));
        blend_2(&table.data, table.rate.len(), &a, &rate)
    }
}

impl DamageCase {
    fn new(tables: &Tables, options: &TransportOptions) -> Option<Self> {
        if options.damage == Damage::None {
            return None;
        }
        let case = options.damage.case() - 1;
        let of_case = |data: &[[f64; 6]], only_side_force: bool| {
            let rows = data.chunks(CASES * RATES);
            let row = |row: &[[f64; 6]]| {
                std::array::from_fn(|i| {
                    let (rate, component) = (i / 6, i % 6);
                    if only_side_force && component != CY { 0.0 } else { row[case * RATES + rate][component] }
                })
            };
            rows.map(row).collect()
        };
        Some(Self {
            increment: tables.damage.increment.iter().skip(case).step_by(CASES).copied().collect(),
            scale: of_case(&tables.damage.scale, false),
            rate: of_case(&tables.damage.rate, !options.all_rate_increments),
        })
    }
}

/// The steady rotation about the velocity, omega b/2V, that a roll and a yaw rate contain: from the rate that leaves a rest
/// of the other which is no larger than that and of the same sign. `along` are the components of the direction of the velocity
/// along body x and z. `None` if there is no such rotation, and without a roll or yaw rate.
fn steady_rotation<T: Scalar>([p, _, r]: [T; 3], along: [T; 2]) -> Option<T> {
    if p.real() == 0.0 || r.real() == 0.0 {
        return None;
    }
    let [along_x, along_z] = along;
    let kept = |rest: T, rate: T| rest.real() * rate.real() >= 0.0 && rest.real().abs() <= rate.real().abs();
    let by_roll = p / along_x;
    if kept(r - by_roll * along_z, r) {
        return Some(by_roll);
    }
    let by_yaw = r / along_z;
    kept(p - by_yaw * along_x, p).then_some(by_yaw)
}

/// A coefficient of the other side from one of this side: side force, roll and yaw change their sign.
#[inline(always)]
fn mirrored<T: Scalar>([cx, cy, cz, cl, cm, cn]: [T; 6]) -> [T; 6] {
    [cx, -cy, cz, -cl, cm, -cn]
}

#[inline(always)]
fn add_all<T: Scalar>(sum: &mut [T; 6], added: &[T; 6], factor: f64) {
    for k in 0..6 {
        sum[k] = sum[k] + added[k] * factor;
    }
}

#[inline(always)]
fn add_some<T: Scalar>(sum: &mut [T; 6], places: [usize; 3], added: &[T; 3]) {
    for (place, value) in places.into_iter().zip(added) {
        sum[place] = sum[place] + *value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples are worked by hand: body x and z components of the velocity 0.9 and 0.3.
    #[test]
    fn the_steady_rotation_takes_the_rate_that_it_explains() {
        let omega = |p: f64, r: f64| steady_rotation([p, 0.0, r], [0.9, 0.3]);
        // A pure rotation about the velocity: both agree.
        assert!((omega(0.09, 0.03).unwrap() - 0.1).abs() < 1e-15);
        // More yaw than the roll goes with: the rest is yaw.
        assert!((omega(0.09, 0.05).unwrap() - 0.1).abs() < 1e-15);
        // Less: the rest is roll.
        assert!((omega(0.09, 0.01).unwrap() - 1.0 / 30.0).abs() < 1e-15);
        // Against each other there is no rotation, nor with only one of them.
        assert_eq!(omega(0.09, -0.05), None);
        assert_eq!(omega(0.09, 0.0), None);
        assert_eq!(omega(0.0, 0.05), None);
        assert_eq!(omega(f64::NAN, 0.05), None);
    }
}
