//! What an error of a constant does to rates and outputs of the lateral-directional motion.

use phugoid_estimators::{ConstantEffects, RegressorShift};
use phugoid_flight_dynamics::scalar::Dual;

use super::{LATERAL_OUTPUTS, LATERAL_STATES, LateralInput, LateralModel, Measured};
use crate::core::shifts::Moved;
use crate::core::systematic::UncertainQuantity;
use crate::core::term::{Coefficient, Term, Variable};
use crate::models::rigid::AircraftConstants;
use crate::models::surface_motion::SurfaceMotion;

/// The constants in the order of the columns of [`LateralModel::effects_of_constants`]: flow angles are the sideslip, then
/// the angle of attack; surfaces aileron, then rudder; moments of inertia about body x, then z; zeros of sideslip, then of the angle of attack; play of aileron, then of the rudder; the accelerometer
/// ahead, then below.
pub(crate) const CONSTANTS: [UncertainQuantity; 21] = [
    UncertainQuantity::AirspeedScale,
    UncertainQuantity::FlowAngleScale,
    UncertainQuantity::FlowAngleScale,
    UncertainQuantity::FlowAngleLag,
    UncertainQuantity::SurfaceScale,
    UncertainQuantity::SurfaceScale,
    UncertainQuantity::SurfaceSkew,
    UncertainQuantity::AccelerationScale,
    UncertainQuantity::Mass,
    UncertainQuantity::Inertia,
    UncertainQuantity::Inertia,
    UncertainQuantity::CentreOfGravity,
    UncertainQuantity::FlowAngleZero,
    UncertainQuantity::FlowAngleZero,
    UncertainQuantity::AirDensity,
    UncertainQuantity::Geometry,
    UncertainQuantity::SurfacePlay,
    UncertainQuantity::SurfacePlay,
    UncertainQuantity::FlowAnglePosition,
    UncertainQuantity::AccelerationPosition,
    UncertainQuantity::AccelerationPosition,
];

/// Those that leave a trace in residuals: lag of the vane, time of the surfaces, play of aileron and rudder.
pub(crate) const LEARNABLE: [usize; 4] = [3, 6, 16, 17];
/// What they are about.
pub(crate) const LEARNABLE_OF: [&str; 4] = ["beta", "aileron and rudder", "aileron", "rudder"];

/// Place of the constant that is the bias of the sideslip.
pub(crate) const BIAS_OF_BETA: usize = 12;

/// Place of the specific force along body y among the outputs, and of the roll and the yaw acceleration.
const AY: usize = 4;
const ROLL_ACCELERATION: usize = 5;
const YAW_ACCELERATION: usize = 6;

/// What the constants add to the regressors of the columns of those of other columns. A scale moves what is measured from a
/// reference point by its part of the reference.
pub(super) fn shifts(columns: &[(Coefficient, Term)], c: &AircraftConstants) -> Vec<Vec<RegressorShift>> {
    let moved = [
        Moved { constant: BIAS_OF_BETA, variable: Variable::Beta, per_unit: 1.0 },
        Moved { constant: 13, variable: Variable::Alpha, per_unit: 1.0 },
        Moved { constant: 2, variable: Variable::Alpha, per_unit: c.alpha_reference },
        Moved { constant: 4, variable: Variable::Aileron, per_unit: c.aileron_reference },
        Moved { constant: 5, variable: Variable::Rudder, per_unit: c.rudder_reference },
    ];
    crate::core::shifts::shifts(columns, &moved, &[])
}

impl LateralModel {
    /// Derivatives of rates and outputs by the constants, as those of the longitudinal motion.
    pub(crate) fn effects_of_constants<const K: usize>(
        &self,
        x: &[f64; LATERAL_STATES],
        theta: &[f64],
        u: &LateralInput,
        surfaces: &SurfaceMotion,
        out: &mut ConstantEffects<LATERAL_STATES, LATERAL_OUTPUTS, K>,
    ) {
        let c = &self.aerodynamics.constants;
        let Some(properties) = u.mass.properties(c.rotor_momentum).filter(|_| K >= CONSTANTS.len()) else { return };
        let ConstantEffects { rates, outputs } = out;
        // By airspeed, angle of attack, aileron, rudder, a part of the density and a part of the lengths.
        type D = Dual<6>;
        let measured = Measured {
            speed: D::variable(u.speed, 0),
            alpha: D::variable(u.alpha, 1),
            density: D { value: u.air_density, derivatives: [0.0, 0.0, 0.0, 0.0, u.air_density, 0.0] },
            length: Some(D::variable(1.0, 5)),
        };
        let deflections =
            [D::from(u.surfaces.elevator), D::variable(u.surfaces.aileron, 2), D::variable(u.surfaces.rudder, 3)];
        let motion = self.motion_with(&x.map(D::from), theta, u, &measured, &deflections);
        let [beta, _, p, r] = *x;
        let q = u.q;
        let rate = motion.rates.map(|rate| rate.value);
        let ay = motion.side_force.value;

        // What is missing in the record of the inputs, per unit of the constant.
        let [_, aileron_rate, rudder_rate] = surfaces.rates;
        let [_, aileron_play, rudder_play] = surfaces.play;
        let missing = [
            (0, [-u.speed, 0.0, 0.0, 0.0, 0.0, 0.0]),
            (2, [0.0, -u.alpha, 0.0, 0.0, 0.0, 0.0]),
            (13, [0.0, -1.0, 0.0, 0.0, 0.0, 0.0]),
            (4, [0.0, 0.0, -u.surfaces.aileron, 0.0, 0.0, 0.0]),
            (5, [0.0, 0.0, 0.0, -u.surfaces.rudder, 0.0, 0.0]),
            (6, [0.0, 0.0, aileron_rate, rudder_rate, 0.0, 0.0]),
            (14, [0.0, 0.0, 0.0, 0.0, -1.0, 0.0]),
            (15, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            (16, [0.0, 0.0, aileron_play, 0.0, 0.0, 0.0]),
            (17, [0.0, 0.0, 0.0, rudder_play, 0.0, 0.0]),
        ];
        for (column, missing) in missing {
            let along = |value: &D| value.derivatives.iter().zip(missing).map(|(d, m)| d * m).sum::<f64>();
            for (to, from) in rates.iter_mut().zip(&motion.rates) {
                to[column] = along(from);
            }
            outputs[AY][column] = along(&motion.side_force);
            outputs[ROLL_ACCELERATION][column] = along(&motion.rates[2]);
            outputs[YAW_ACCELERATION][column] = along(&motion.rates[3]);
        }
        outputs[0][1] = beta;
        outputs[0][BIAS_OF_BETA] = 1.0;
        outputs[0][3] = -rate[0];
        outputs[AY][7] = ay;

        // Mass: of the side force alone; the other specific forces are measured.
        rates[0][8] = -ay * beta.cos() / u.speed;
        outputs[AY][8] = -ay;

        // I w' + w x I w = M with a part dI of the inertia more: I dw' = -(dI w' + w x dI w).
        let inverse = properties.inverse_inertia();
        let turn = |moment: [f64; 3]| {
            [0, 2].map(|row| inverse[row].iter().zip(moment).map(|(inverse, m)| inverse * m).sum::<f64>())
        };
        let (ixx, izz) = (u.mass.ixx, u.mass.izz);
        let side_moment = u.mass.mass * ay * c.mean_chord;
        let turned = [
            (9, turn([-ixx * rate[2], -ixx * r * p, ixx * q * p])),
            (10, turn([-izz * q * r, izz * p * r, -izz * rate[3]])),
            // Centre of gravity: the side force acts ahead of it.
            (11, turn([0.0, 0.0, side_moment])),
        ];
        for (column, [roll, yaw]) in turned {
            rates[2][column] = roll;
            rates[3][column] = yaw;
            outputs[ROLL_ACCELERATION][column] = roll;
            outputs[YAW_ACCELERATION][column] = yaw;
        }
        // And the acceleration is that of a point ahead of it.
        outputs[AY][11] = (rate[3] + p * q) * c.mean_chord;
        // A vane ahead moves sideways with the nose, and an accelerometer shows w' x r + w x (w x r) more.
        outputs[0][18] = r / u.speed;
        outputs[AY][19] = rate[3] + p * q;
        outputs[AY][20] = q * r - rate[2];
    }

    /// What the constants add to the regressor of a column of those of other columns.
    pub(crate) fn shifts_of_constants(&self, column: usize) -> &[RegressorShift] {
        self.shifts.get(column).map_or(&[], Vec::as_slice)
    }

    /// By which part the regressor of a column is larger than the true one, per unit of each constant. The product of
    /// inertia is left out.
    pub(crate) fn powers_of_constants<const K: usize>(&self, column: usize) -> [f64; K] {
        let mut out = [0.0; K];
        let of = self.columns().iter().zip(&self.scaling).nth(column);
        let (Some(((coefficient, _), powers)), true) = (of, K >= CONSTANTS.len()) else { return out };
        let about = |which: Coefficient| if *coefficient == which { powers.inertia } else { 0.0 };
        let places = [
            (0, powers.airspeed),
            (1, powers.beta),
            (2, powers.alpha),
            (4, powers.surfaces[1]),
            (5, powers.surfaces[2]),
            (8, powers.mass),
            (9, about(Coefficient::RollingMoment)),
            (10, about(Coefficient::YawingMoment)),
            (14, powers.density),
            (15, powers.length),
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

    use super::{AY, CONSTANTS, LATERAL_OUTPUTS, LATERAL_STATES, ROLL_ACCELERATION, YAW_ACCELERATION};
    use crate::core::term::{Coefficient, Term};
    use crate::models::lateral::{LateralInput, LateralModel};
    use crate::models::longitudinal::Database;
    use crate::models::rigid::{AircraftConstants, MassInput, Surfaces};
    use crate::models::small_errors::assert_effects;
    use crate::models::surface_motion::SurfaceMotion;

    const TERMS: [(Coefficient, &str); 8] = [
        (Coefficient::SideForce, "beta"),
        (Coefficient::SideForce, "rudder"),
        (Coefficient::RollingMoment, "beta"),
        (Coefficient::RollingMoment, "p_hat"),
        (Coefficient::RollingMoment, "aileron"),
        (Coefficient::YawingMoment, "beta"),
        (Coefficient::YawingMoment, "r_hat"),
        (Coefficient::YawingMoment, "rudder"),
    ];
    const THETA: [f64; 8] = [-0.8, 0.2, -0.1, -0.4, -0.1, 0.2, -0.3, -0.1];
    const X: [f64; LATERAL_STATES] = [0.04, 0.2, 0.3, -0.1];
    const SURFACES: SurfaceMotion = SurfaceMotion { rates: [0.1, 0.5, -0.3], play: [0.2, -0.4, 0.3] };
    const CHORD: f64 = 3.45;

    fn input() -> LateralInput {
        LateralInput {
            surfaces: Surfaces { elevator: -0.03, aileron: 0.07, rudder: -0.05, extra: [0.0; 3], held: false },
            air_density: 0.9,
            mass: MassInput { mass: 9300.0, ixx: 12_900.0, iyy: 75_700.0, izz: 85_600.0, ixz: 1300.0 },
            speed: 150.0,
            alpha: 0.07,
            theta: 0.1,
            q: 0.05,
            ax: 0.4,
            az: -9.6,
        }
    }

    fn model(database: Database) -> LateralModel {
        let constants = AircraftConstants {
            wing_area: 27.87,
            mean_chord: CHORD,
            span: 9.144,
            gravity: 9.80665,
            thrust_inclination: 0.0,
            thrust_arm: 0.0,
            rotor_momentum: 216.9,
            reference_speed: 150.0,
            rate_speed: None,
            alpha_reference: 0.0,
            elevator_reference: 0.0,
            aileron_reference: 0.0,
            rudder_reference: 0.0,
        };
        let terms = TERMS.map(|(coefficient, text)| (coefficient, Term::parse(text, &[]).unwrap()));
        LateralModel::new(constants, database, terms.to_vec(), Vec::new())
    }

    /// Rates, then outputs.
    fn at(model: &LateralModel, u: &LateralInput) -> [f64; LATERAL_STATES + LATERAL_OUTPUTS] {
        let rates = Model::<LATERAL_STATES, LATERAL_OUTPUTS, 8>::rates(model, &X, &THETA, u);
        let mut lin = LinearizedOutputs::<LATERAL_STATES, LATERAL_OUTPUTS, 8>::ZERO;
        model.linearized_outputs(&X, &THETA, u, &mut lin);
        std::array::from_fn(|i| if i < LATERAL_STATES { rates[i] } else { lin.outputs[i - LATERAL_STATES] })
    }

    /// What is shown and flown with a constant of `c`, worked out by making it so.
    fn with(model: &LateralModel, column: usize, c: f64) -> [f64; LATERAL_STATES + LATERAL_OUTPUTS] {
        let mut u = input();
        let healthy = at(model, &u);
        match column {
            0 => u.speed *= 1.0 - c,
            2 => u.alpha *= 1.0 - c,
            13 => u.alpha -= c,
            4 => u.surfaces.aileron *= 1.0 - c,
            5 => u.surfaces.rudder *= 1.0 - c,
            6 => {
                u.surfaces.aileron += c * SURFACES.rates[1];
                u.surfaces.rudder += c * SURFACES.rates[2];
            }
            8 => u.mass.mass *= 1.0 + c,
            9 => u.mass.ixx *= 1.0 + c,
            10 => u.mass.izz *= 1.0 + c,
            14 => u.air_density *= 1.0 - c,
            16 => u.surfaces.aileron += c * SURFACES.play[1],
            17 => u.surfaces.rudder += c * SURFACES.play[2],
            _ => {}
        }
        let mut larger = model.clone();
        if column == 15 {
            let constants = &mut larger.aerodynamics.constants;
            constants.wing_area *= (1.0 + c).powi(2);
            constants.mean_chord *= 1.0 + c;
            constants.span *= 1.0 + c;
        }
        let mut shown = at(&larger, &u);
        let output = |row: usize| LATERAL_STATES + row;
        let ay = healthy[output(AY)];
        match column {
            1 => shown[output(0)] *= 1.0 + c,
            12 => shown[output(0)] += c,
            18 => shown[output(0)] += c * X[3] / input().speed,
            // w' x r + w x (w x r), ahead and below.
            19 => shown[output(AY)] += (healthy[3] + X[2] * input().q) * c,
            20 => shown[output(AY)] += (input().q * X[3] - healthy[2]) * c,
            3 => shown[output(0)] -= c * healthy[0],
            7 => shown[output(AY)] *= 1.0 + c,
            11 => {
                // The side force turns the aircraft about a point c chords behind: a yawing moment more.
                let u = input();
                let inverse = u.mass.properties(216.9).unwrap();
                let inverse = inverse.inverse_inertia();
                let moment = c * CHORD * u.mass.mass * ay;
                shown[2] += inverse[0][2] * moment;
                shown[3] += inverse[2][2] * moment;
                shown[output(ROLL_ACCELERATION)] = shown[2];
                shown[output(YAW_ACCELERATION)] = shown[3];
                // w' x r + w x (w x r) of a point ahead.
                shown[output(AY)] += (healthy[3] + X[2] * u.q) * c * CHORD;
            }
            _ => {}
        }
        shown
    }

    /// Against small differences, in parts of the largest entry of the column.
    #[test]
    fn the_effects_are_those_of_small_errors() {
        let aircraft = F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap();
        for model in [model(Database::None), model(Database::F16(Box::new(aircraft)))] {
            let mut effects = ConstantEffects::<LATERAL_STATES, LATERAL_OUTPUTS, 21>::ZERO;
            model.effects_of_constants(&X, &THETA, &input(), &SURFACES, &mut effects);
            assert_effects(&CONSTANTS, &effects, |column, c| with(&model, column, c).to_vec());
        }
    }
}
