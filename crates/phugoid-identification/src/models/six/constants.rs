//! What an error of a constant does to rates and outputs of the whole motion.

use phugoid_estimators::{ConstantEffects, RegressorShift};
use phugoid_flight_dynamics::scalar::Dual;

use super::{Factors, SIX_OUTPUTS, SIX_STATES, SixInput, SixModel};
use crate::core::shifts::{Moved, Turned};
use crate::core::systematic::UncertainQuantity;
use crate::core::term::{Coefficient, Term, Variable};
use crate::models::rigid::AircraftConstants;
use crate::models::surface_motion::SurfaceMotion;

/// The constants in the order of the columns of [`SixModel::effects_of_constants`]: of the angle of attack, then of the sideslip; of
/// elevator, aileron and rudder; of the accelerometers along x, y and z; of the moments of inertia about x, y and z; the accelerometers
/// ahead, then below. Both vanes stand in one place.
pub(crate) const CONSTANTS: [UncertainQuantity; 29] = [
    UncertainQuantity::AirspeedScale,
    UncertainQuantity::AirspeedPerAlpha,
    UncertainQuantity::FlowAngleScale,
    UncertainQuantity::FlowAngleScale,
    UncertainQuantity::FlowAngleLag,
    UncertainQuantity::FlowAngleLag,
    UncertainQuantity::SurfaceScale,
    UncertainQuantity::SurfaceScale,
    UncertainQuantity::SurfaceScale,
    UncertainQuantity::SurfaceSkew,
    UncertainQuantity::AccelerationScale,
    UncertainQuantity::AccelerationScale,
    UncertainQuantity::AccelerationScale,
    UncertainQuantity::Mass,
    UncertainQuantity::Inertia,
    UncertainQuantity::Inertia,
    UncertainQuantity::Inertia,
    UncertainQuantity::CentreOfGravity,
    UncertainQuantity::Thrust,
    UncertainQuantity::FlowAngleZero,
    UncertainQuantity::FlowAngleZero,
    UncertainQuantity::AirDensity,
    UncertainQuantity::Geometry,
    UncertainQuantity::SurfacePlay,
    UncertainQuantity::SurfacePlay,
    UncertainQuantity::SurfacePlay,
    UncertainQuantity::FlowAnglePosition,
    UncertainQuantity::AccelerationPosition,
    UncertainQuantity::AccelerationPosition,
];

/// Place of the constant that is the bias of the angle of attack.
pub(crate) const BIAS_OF_ALPHA: usize = 19;
/// Place of the constant that is the bias of the sideslip.
pub(crate) const BIAS_OF_BETA: usize = 20;

/// Places of the airspeed, the angle of attack and the sideslip among the outputs, of the specific force along body x, before those along
/// y and z, and of the angular acceleration about body x, before those about y and z.
const SPEED: usize = 0;
const ALPHA: usize = 1;
const BETA: usize = 2;
const FORCE: usize = 8;
const TURN: usize = 11;

/// What the constants add to the regressors of the columns of those of other columns. A scale moves what is measured from a
/// reference point by its part of the reference.
pub(super) fn shifts(columns: &[(Coefficient, Term)], c: &AircraftConstants) -> Vec<Vec<RegressorShift>> {
    let moved = [
        Moved { constant: BIAS_OF_ALPHA, variable: Variable::Alpha, per_unit: 1.0 },
        Moved { constant: BIAS_OF_BETA, variable: Variable::Beta, per_unit: 1.0 },
        Moved { constant: 2, variable: Variable::Alpha, per_unit: c.alpha_reference },
        Moved { constant: 6, variable: Variable::Elevator, per_unit: c.elevator_reference },
        Moved { constant: 7, variable: Variable::Aileron, per_unit: c.aileron_reference },
        Moved { constant: 8, variable: Variable::Rudder, per_unit: c.rudder_reference },
    ];
    let turned =
        [Turned { constant: BIAS_OF_ALPHA, per_unit: 1.0 }, Turned { constant: 2, per_unit: c.alpha_reference }];
    crate::core::shifts::shifts(columns, &moved, &turned)
}

impl SixModel {
    /// Derivatives of rates and outputs by the constants, as those of the longitudinal and the lateral-directional motion. Nothing is
    /// written where `out` has no room for all constants, and where the inertia is impossible.
    pub(crate) fn effects_of_constants<const K: usize>(
        &self,
        x: &[f64; SIX_STATES],
        theta: &[f64],
        u: &SixInput,
        surfaces: &SurfaceMotion,
        out: &mut ConstantEffects<SIX_STATES, SIX_OUTPUTS, K>,
    ) {
        let c = &self.aerodynamics.constants;
        let Some(properties) = u.mass.properties(c.rotor_momentum).filter(|_| K >= CONSTANTS.len()) else { return };
        let ConstantEffects { rates, outputs } = out;
        // By elevator, aileron, rudder, and a part of the density, the lengths, the mass and the thrust.
        type D = Dual<7>;
        let factors = Factors {
            density: D::variable(1.0, 3),
            length: D::variable(1.0, 4),
            mass: D::variable(1.0, 5),
            thrust: D::variable(1.0, 6),
        };
        let recorded = [u.surfaces.elevator, u.surfaces.aileron, u.surfaces.rudder];
        let deflections: [D; 3] = std::array::from_fn(|i| D::variable(recorded[i], i));
        let motion = self.motion_with(&x.map(D::from), theta, u, &deflections, Some(factors));
        let rate = motion.rates.map(|rate| rate.value);
        let specific_force = motion.specific_force.map(|force| force.value);
        let [speed, alpha, beta, _, _, p, q, r] = *x;
        let [p_rate, q_rate, r_rate] = [rate[5], rate[6], rate[7]];

        // What is missing in the record of the inputs, or more of the aircraft than the model has, per unit of the constant.
        let of_surface = |i: usize, missing: f64| std::array::from_fn(|k| if k == i { missing } else { 0.0 });
        let [of_elevator, of_aileron, of_rudder] = surfaces.rates;
        let missing: [(usize, [f64; 7]); 11] = [
            (6, of_surface(0, -recorded[0])),
            (7, of_surface(1, -recorded[1])),
            (8, of_surface(2, -recorded[2])),
            (9, [of_elevator, of_aileron, of_rudder, 0.0, 0.0, 0.0, 0.0]),
            (23, of_surface(0, surfaces.play[0])),
            (24, of_surface(1, surfaces.play[1])),
            (25, of_surface(2, surfaces.play[2])),
            (21, [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0]),
            (22, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
            (13, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
            (18, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        ];
        for (column, missing) in missing {
            let along = |value: &D| value.derivatives.iter().zip(missing).map(|(d, m)| d * m).sum::<f64>();
            for (to, from) in rates.iter_mut().zip(&motion.rates) {
                to[column] = along(from);
            }
            for axis in 0..3 {
                outputs[FORCE + axis][column] = along(&motion.specific_force[axis]);
                outputs[TURN + axis][column] = along(&motion.rates[5 + axis]);
            }
        }

        outputs[SPEED][0] = speed;
        outputs[SPEED][1] = speed * alpha;
        outputs[ALPHA][2] = alpha;
        outputs[BETA][3] = beta;
        outputs[ALPHA][4] = -rate[1];
        outputs[BETA][5] = -rate[2];
        outputs[ALPHA][BIAS_OF_ALPHA] = 1.0;
        outputs[BETA][BIAS_OF_BETA] = 1.0;
        for (axis, force) in specific_force.into_iter().enumerate() {
            outputs[FORCE + axis][10 + axis] = force;
        }

        // I w' + w x I w = M with a part dI of the inertia more: I dw' = -(dI w' + w x dI w).
        let inverse = properties.inverse_inertia();
        let turn =
            |moment: [f64; 3]| inverse.map(|row| row.iter().zip(moment).map(|(inverse, m)| inverse * m).sum::<f64>());
        let (ixx, iyy, izz) = (u.mass.ixx, u.mass.iyy, u.mass.izz);
        // Centre of gravity: what the air does to the aircraft acts ahead of it.
        let [_, thrust_z] = self.thrust_direction.map(|d| d * u.thrust);
        let [_, ay, az] = specific_force;
        let turned = [
            (14, turn([-ixx * p_rate, -ixx * r * p, ixx * q * p])),
            (15, turn([iyy * q * r, -iyy * q_rate, -iyy * p * q])),
            (16, turn([-izz * q * r, izz * p * r, -izz * r_rate])),
            (17, turn([0.0, (thrust_z - u.mass.mass * az) * c.mean_chord, u.mass.mass * ay * c.mean_chord])),
        ];
        for (column, accelerations) in turned {
            for (axis, acceleration) in accelerations.into_iter().enumerate() {
                rates[5 + axis][column] = acceleration;
                outputs[TURN + axis][column] = acceleration;
            }
        }
        // Accelerometers a metre ahead, and below, show w' x r + w x (w x r) more; vanes ahead move with the nose.
        let ahead = [-(q * q + r * r), r_rate + p * q, p * r - q_rate];
        let below = [q_rate + p * r, q * r - p_rate, -(p * p + q * q)];
        for axis in 0..3 {
            outputs[FORCE + axis][17] = ahead[axis] * c.mean_chord;
            outputs[FORCE + axis][27] = ahead[axis];
            outputs[FORCE + axis][28] = below[axis];
        }
        outputs[ALPHA][26] = -q / speed;
        outputs[BETA][26] = r / speed;
    }

    /// What the constants add to the regressor of a column of those of other columns.
    pub(crate) fn shifts_of_constants(&self, column: usize) -> &[RegressorShift] {
        self.shifts.get(column).map_or(&[], Vec::as_slice)
    }

    /// By which part the regressor of a column is larger than the true one, per unit of each constant. The product of inertia is left
    /// out, and `1 + c alpha` is that of the present angle of attack.
    pub(crate) fn powers_of_constants<const K: usize>(&self, x: &[f64; SIX_STATES], column: usize) -> [f64; K] {
        let mut out = [0.0; K];
        let of = self.columns().iter().zip(&self.scaling).nth(column);
        let (Some(((coefficient, _), powers)), true) = (of, K >= CONSTANTS.len()) else { return out };
        let about = |which: Coefficient| if *coefficient == which { powers.inertia } else { 0.0 };
        let places = [
            (0, powers.airspeed),
            (1, powers.airspeed * x[1]),
            (2, powers.alpha),
            (3, powers.beta),
            (6, powers.surfaces[0]),
            (7, powers.surfaces[1]),
            (8, powers.surfaces[2]),
            (13, powers.mass),
            (14, about(Coefficient::RollingMoment)),
            (15, about(Coefficient::PitchingMoment)),
            (16, about(Coefficient::YawingMoment)),
            (21, powers.density),
            (22, powers.length),
        ];
        for (place, power) in places {
            out[place] = power;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use phugoid_estimators::{ConstantEffects, LinearizedOutputs, Model};
    use phugoid_flight_dynamics::f16::{F16, F16Options};

    use super::{ALPHA, BETA, BIAS_OF_ALPHA, BIAS_OF_BETA, CONSTANTS, FORCE, SPEED, TURN};
    use crate::core::term::{Coefficient, Term};
    use crate::models::longitudinal::Database;
    use crate::models::rigid::{AircraftConstants, MassInput, Surfaces};
    use crate::models::six::{SIX_OUTPUTS, SIX_STATES, SixInput, SixModel};
    use crate::models::small_errors::assert_effects;
    use crate::models::surface_motion::SurfaceMotion;

    const TERMS: [(Coefficient, &str); 8] = [
        (Coefficient::Lift, "alpha"),
        (Coefficient::Drag, "alpha^2"),
        (Coefficient::PitchingMoment, "q_hat"),
        (Coefficient::PitchingMoment, "elevator"),
        (Coefficient::SideForce, "beta"),
        (Coefficient::RollingMoment, "p_hat"),
        (Coefficient::RollingMoment, "aileron"),
        (Coefficient::YawingMoment, "rudder"),
    ];
    const THETA: [f64; 8] = [4.0, 1.2, -8.0, -0.9, -0.8, -0.4, -0.1, -0.1];
    const X: [f64; SIX_STATES] = [150.0, 0.07, 0.04, 0.2, 0.1, 0.3, 0.05, -0.1];
    const SURFACES: SurfaceMotion = SurfaceMotion { rates: [0.1, 0.5, -0.3], play: [0.2, -0.4, 0.3] };
    const CHORD: f64 = 3.45;
    const ROTOR: f64 = 216.9;

    fn input() -> SixInput {
        SixInput {
            surfaces: Surfaces { elevator: -0.03, aileron: 0.07, rudder: -0.05, extra: [0.0; 3], held: false },
            air_density: 0.9,
            thrust: 12_000.0,
            mass: MassInput { mass: 9300.0, ixx: 12_900.0, iyy: 75_700.0, izz: 85_600.0, ixz: 1300.0 },
        }
    }

    fn model(database: Database) -> SixModel {
        let constants = AircraftConstants {
            wing_area: 27.87,
            mean_chord: CHORD,
            span: 9.144,
            gravity: 9.80665,
            thrust_inclination: 0.05,
            thrust_arm: 0.1,
            rotor_momentum: ROTOR,
            reference_speed: 150.0,
            rate_speed: None,
            alpha_reference: 0.0,
            elevator_reference: 0.0,
            aileron_reference: 0.0,
            rudder_reference: 0.0,
        };
        let terms = TERMS.map(|(coefficient, text)| (coefficient, Term::parse(text, &[]).unwrap()));
        SixModel::new(constants, database, terms.to_vec(), Vec::new())
    }

    /// Rates, then outputs.
    fn at(model: &SixModel, u: &SixInput) -> [f64; SIX_STATES + SIX_OUTPUTS] {
        let rates = Model::<SIX_STATES, SIX_OUTPUTS, 8>::rates(model, &X, &THETA, u);
        let mut lin = LinearizedOutputs::<SIX_STATES, SIX_OUTPUTS, 8>::ZERO;
        model.linearized_outputs(&X, &THETA, u, &mut lin);
        std::array::from_fn(|i| if i < SIX_STATES { rates[i] } else { lin.outputs[i - SIX_STATES] })
    }

    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    /// What is shown and flown with a constant of `c`, worked out by making it so.
    fn with(model: &SixModel, column: usize, c: f64) -> [f64; SIX_STATES + SIX_OUTPUTS] {
        let mut u = input();
        let healthy = at(model, &u);
        let surface = |u: &mut SixInput, i: usize, change: &dyn Fn(f64) -> f64| {
            let place = [&mut u.surfaces.elevator, &mut u.surfaces.aileron, &mut u.surfaces.rudder];
            for (k, value) in place.into_iter().enumerate() {
                if k == i {
                    *value = change(*value);
                }
            }
        };
        match column {
            6..=8 => surface(&mut u, column - 6, &|value| value * (1.0 - c)),
            9 => (0..3).for_each(|i| surface(&mut u, i, &|value| value + c * SURFACES.rates[i])),
            13 => u.mass.mass *= 1.0 + c,
            14 => u.mass.ixx *= 1.0 + c,
            15 => u.mass.iyy *= 1.0 + c,
            16 => u.mass.izz *= 1.0 + c,
            18 => u.thrust *= 1.0 + c,
            21 => u.air_density *= 1.0 - c,
            23..=25 => surface(&mut u, column - 23, &|value| value + c * SURFACES.play[column - 23]),
            _ => {}
        }
        let mut larger = model.clone();
        if column == 22 {
            let constants = &mut larger.aerodynamics.constants;
            constants.wing_area *= (1.0 + c).powi(2);
            constants.mean_chord *= 1.0 + c;
            constants.span *= 1.0 + c;
        }
        let mut shown = at(&larger, &u);
        let output = |row: usize| SIX_STATES + row;
        let of = |first: usize| [healthy[output(first)], healthy[output(first + 1)], healthy[output(first + 2)]];
        let (force, turn) = (of(FORCE), of(TURN));
        let rates = [X[5], X[6], X[7]];
        // w' x r + w x (w x r) of a point.
        let of_point = |point: [f64; 3]| {
            let (by_turn, by_rates) = (cross(turn, point), cross(rates, cross(rates, point)));
            [0, 1, 2].map(|i| by_turn[i] + by_rates[i])
        };
        let add = |shown: &mut [f64; SIX_STATES + SIX_OUTPUTS], first: usize, more: [f64; 3]| {
            (0..3).for_each(|i| shown[first + i] += more[i]);
        };
        match column {
            0 => shown[output(SPEED)] *= 1.0 + c,
            1 => shown[output(SPEED)] *= 1.0 + c * X[1],
            2 => shown[output(ALPHA)] *= 1.0 + c,
            3 => shown[output(BETA)] *= 1.0 + c,
            4 => shown[output(ALPHA)] -= c * healthy[1],
            5 => shown[output(BETA)] -= c * healthy[2],
            BIAS_OF_ALPHA => shown[output(ALPHA)] += c,
            BIAS_OF_BETA => shown[output(BETA)] += c,
            10..=12 => shown[output(FORCE + column - 10)] *= 1.0 + c,
            17 => {
                // What the air does turns the aircraft about a point c chords behind where it acts.
                let u = input();
                let [sin, cos] = [0.05_f64.sin(), 0.05_f64.cos()];
                let by_air = [
                    u.mass.mass * force[0] - u.thrust * cos,
                    u.mass.mass * force[1],
                    u.mass.mass * force[2] + u.thrust * sin,
                ];
                let moment = cross([c * CHORD, 0.0, 0.0], by_air);
                let properties = u.mass.properties(ROTOR).unwrap();
                let more = properties
                    .inverse_inertia()
                    .map(|row| row.iter().zip(moment).map(|(inverse, m)| inverse * m).sum::<f64>());
                add(&mut shown, 5, more);
                add(&mut shown, output(TURN), more);
                add(&mut shown, output(FORCE), of_point([c * CHORD, 0.0, 0.0]));
            }
            26 => {
                shown[output(ALPHA)] -= c * X[6] / X[0];
                shown[output(BETA)] += c * X[7] / X[0];
            }
            27 => add(&mut shown, output(FORCE), of_point([c, 0.0, 0.0])),
            28 => add(&mut shown, output(FORCE), of_point([0.0, 0.0, c])),
            _ => {}
        }
        shown
    }

    /// Against small differences, in parts of the largest entry of the column.
    #[test]
    fn the_effects_are_those_of_small_errors() {
        let aircraft = F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap();
        for model in [model(Database::None), model(Database::F16(Box::new(aircraft)))] {
            let mut effects = ConstantEffects::<SIX_STATES, SIX_OUTPUTS, 29>::ZERO;
            model.effects_of_constants(&X, &THETA, &input(), &SURFACES, &mut effects);
            assert_effects(&CONSTANTS, &effects, |column, c| with(&model, column, c).to_vec());
        }
    }
}
