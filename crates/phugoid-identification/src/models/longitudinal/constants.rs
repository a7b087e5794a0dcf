//! What an error of a constant does to rates and outputs of the longitudinal motion.

use phugoid_estimators::{ConstantEffects, RegressorShift};
use phugoid_flight_dynamics::scalar::Dual;

use super::{LongitudinalConstants, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES, row};
use crate::core::shifts::{Moved, Turned};
use crate::core::systematic::UncertainQuantity;
use crate::core::term::{Coefficient, Term, Variable};
use crate::models::surface_motion::SurfaceMotion;

/// The constants in the order of the columns of [`LongitudinalModel::effects_of_constants`]: accelerometers along x, then
/// along z; their position ahead, then below.
pub(crate) const CONSTANTS: [UncertainQuantity; 19] = [
    UncertainQuantity::AirspeedScale,
    UncertainQuantity::AirspeedPerAlpha,
    UncertainQuantity::FlowAngleScale,
    UncertainQuantity::FlowAngleLag,
    UncertainQuantity::SurfaceScale,
    UncertainQuantity::SurfaceSkew,
    UncertainQuantity::AccelerationScale,
    UncertainQuantity::AccelerationScale,
    UncertainQuantity::Mass,
    UncertainQuantity::Inertia,
    UncertainQuantity::CentreOfGravity,
    UncertainQuantity::Thrust,
    UncertainQuantity::FlowAngleZero,
    UncertainQuantity::AirDensity,
    UncertainQuantity::Geometry,
    UncertainQuantity::SurfacePlay,
    UncertainQuantity::FlowAnglePosition,
    UncertainQuantity::AccelerationPosition,
    UncertainQuantity::AccelerationPosition,
];

/// Those that leave a trace in residuals: lag of the vane, time and play of the elevator, and the airspeed with the angle of attack.
pub(crate) const LEARNABLE: [usize; 4] = [3, 5, 15, 1];
/// What they are about.
pub(crate) const LEARNABLE_OF: [&str; 4] = ["alpha", "elevator", "elevator", "true_airspeed"];

/// Place of the constant that is the bias of the angle of attack.
pub(crate) const BIAS_OF_ALPHA: usize = 12;

/// What the constants add to the regressors of the columns of those of other columns. A scale moves what is measured from a
/// reference point by its part of the reference.
pub(super) fn shifts(columns: &[(Coefficient, Term)], c: &LongitudinalConstants) -> Vec<Vec<RegressorShift>> {
    let moved = [
        Moved { constant: BIAS_OF_ALPHA, variable: Variable::Alpha, per_unit: 1.0 },
        Moved { constant: 2, variable: Variable::Alpha, per_unit: c.alpha_reference },
        Moved { constant: 4, variable: Variable::Elevator, per_unit: c.elevator_reference },
    ];
    let turned =
        [Turned { constant: BIAS_OF_ALPHA, per_unit: 1.0 }, Turned { constant: 2, per_unit: c.alpha_reference }];
    crate::core::shifts::shifts(columns, &moved, &turned)
}

impl LongitudinalModel {
    /// Derivatives of rates and outputs by the constants. A sensor shows `(1 + c)` times the true value, `c` radians more, or
    /// what was true `c` seconds before, or stands `c` metres ahead or below; mass, inertia and thrust are `(1 + c)` times what the input
    /// holds, chord and span those of the model, and the centre of gravity lies `c` chords behind the one that moments and
    /// accelerations refer to; the elevator has `c` radians of play. `surfaces`: how the elevator has moved.
    ///
    /// A reference point of the terms counts as exact. What `alpha'` itself loses where a term has the rate of the angle
    /// of attack is left out: a part of `rho S cbar CL_alpha_dot/4m` of it, about one in a hundred.
    pub(crate) fn effects_of_constants<const P: usize, const K: usize>(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
        surfaces: &SurfaceMotion,
        out: &mut ConstantEffects<STATES, OUTPUTS, K>,
    ) {
        if K < CONSTANTS.len() {
            return;
        }
        let c = &self.constants;
        let [speed, alpha, pitch, q] = *x;
        let motion = match &self.alpha_rate {
            Some(terms) => self.implicit(terms, x, theta, u).motion,
            None => {
                let factors = self.factors(x, u);
                self.motion(x, u, self.coefficients(x, theta, u.air_density, u.elevator, &factors))
            }
        };
        let rates = super::to_array(&motion.rates);
        let (ax, az) = (motion.specific_force_x, motion.specific_force_z);
        let (sin, cos) = alpha.sin_cos();
        let (sin_path, cos_path) = (pitch - alpha).sin_cos();
        let ConstantEffects { rates: rate, outputs } = out;

        outputs[row::TRUE_AIRSPEED][0] = speed;
        outputs[row::TRUE_AIRSPEED][1] = speed * alpha;
        outputs[row::ALPHA][2] = alpha;
        outputs[row::ALPHA][3] = -rates[1];

        // By the elevator, and by a part of the dimensionless pitch rate, which goes with the chord.
        let mut longer = x.map(Dual::<2>::from);
        longer[3] = Dual { value: q, derivatives: [0.0, q] };
        let elevator = Dual::<2>::variable(u.elevator, 0);
        let mut factors = self.factors(&longer, u);
        factors[3] = elevator - c.elevator_reference;
        let coefficients = self.coefficients(&longer, theta, u.air_density, elevator, &factors);
        // What one radian of elevator adds, times what is missing of it in the record.
        let [lift, drag, moment] = coefficients.map(|value| value.derivatives[0]);
        let force = 0.5 * u.air_density * c.wing_area * speed * speed;
        let f = force / u.mass;
        let pitch_per_moment = force * c.mean_chord / u.iyy;
        for (column, missing) in [(4, -u.elevator), (5, surfaces.rates[0]), (15, surfaces.play[0])] {
            rate[0][column] = -f * drag * missing;
            rate[1][column] = -f * lift / speed * missing;
            rate[3][column] = pitch_per_moment * moment * missing;
            outputs[row::AX][column] = f * (lift * sin - drag * cos) * missing;
            outputs[row::AZ][column] = -f * (lift * cos + drag * sin) * missing;
            outputs[row::PITCH_ACCELERATION][column] = pitch_per_moment * moment * missing;
        }
        outputs[row::AX][6] = ax;
        outputs[row::AZ][7] = az;

        // Mass: all but gravity is divided by it.
        rate[0][8] = -(rates[0] + c.gravity * sin_path);
        rate[1][8] = -(rates[1] - q - c.gravity * cos_path / speed);
        outputs[row::AX][8] = -ax;
        outputs[row::AZ][8] = -az;
        rate[3][9] = -rates[3];
        outputs[row::PITCH_ACCELERATION][9] = -rates[3];

        // Centre of gravity: the normal force acts ahead of it, and the accelerations are those of a point ahead of it.
        let thrust = self.thrust_direction.map(|d| d * u.thrust);
        let turned = (thrust[1] - u.mass * az) * c.mean_chord / u.iyy;
        rate[3][10] = turned;
        outputs[row::PITCH_ACCELERATION][10] = turned;
        outputs[row::AX][10] = -q * q * c.mean_chord;
        outputs[row::AZ][10] = -rates[3] * c.mean_chord;

        rate[0][11] = (thrust[0] * cos + thrust[1] * sin) / u.mass;
        rate[1][11] = (thrust[1] * cos - thrust[0] * sin) / (u.mass * speed);
        let turned = u.thrust * c.thrust_arm / u.iyy;
        rate[3][11] = turned;
        outputs[row::AX][11] = thrust[0] / u.mass;
        outputs[row::AZ][11] = thrust[1] / u.mass;
        outputs[row::PITCH_ACCELERATION][11] = turned;

        outputs[row::ALPHA][BIAS_OF_ALPHA] = 1.0;

        // What the air does: all but gravity, thrust and the turn of the axes.
        let aerodynamic = [
            rates[0] + c.gravity * sin_path - rate[0][11],
            rates[1] - q - c.gravity * cos_path / speed - rate[1][11],
            rates[3] - rate[3][11],
            ax - outputs[row::AX][11],
            az - outputs[row::AZ][11],
        ];
        // A density that is shown too large.
        let [along, across, turned, force_x, force_z] = aerodynamic.map(|value| -value);
        rate[0][13] = along;
        rate[1][13] = across;
        rate[3][13] = turned;
        outputs[row::AX][13] = force_x;
        outputs[row::AZ][13] = force_z;
        outputs[row::PITCH_ACCELERATION][13] = turned;

        // Twice the part of the lengths in the area, once more in the moment, and once in the dimensionless pitch rate.
        let [lift, drag, moment] = coefficients.map(|value| value.derivatives[1]);
        let [along, across, turned, force_x, force_z] = aerodynamic;
        let turned = 3.0 * turned + pitch_per_moment * moment;
        rate[0][14] = 2.0 * along - f * drag;
        rate[1][14] = 2.0 * across - f * lift / speed;
        rate[3][14] = turned;
        outputs[row::AX][14] = 2.0 * force_x + f * (lift * sin - drag * cos);
        outputs[row::AZ][14] = 2.0 * force_z - f * (lift * cos + drag * sin);
        outputs[row::PITCH_ACCELERATION][14] = turned;

        // A vane ahead moves down with the nose, and accelerometers show w' x r + w x (w x r) more.
        outputs[row::ALPHA][16] = -q / speed;
        outputs[row::AX][17] = -q * q;
        outputs[row::AZ][17] = -rates[3];
        outputs[row::AX][18] = rates[3];
        outputs[row::AZ][18] = -q * q;
    }

    /// What the constants add to the regressor of a column of those of other columns.
    pub(crate) fn shifts_of_constants(&self, column: usize) -> &[RegressorShift] {
        self.shifts.get(column).map_or(&[], Vec::as_slice)
    }

    /// By which part the regressor of a column is larger than the true one, per unit of each constant. `1 + c alpha` is
    /// that of the present angle of attack, which changes little beside one.
    pub(crate) fn powers_of_constants<const K: usize>(&self, x: &[f64; STATES], column: usize) -> [f64; K] {
        let mut out = [0.0; K];
        let (Some(powers), true) = (self.scaling.get(column), K >= CONSTANTS.len()) else { return out };
        let places = [
            (0, powers.airspeed),
            (1, powers.airspeed * x[1]),
            (2, powers.alpha),
            (4, powers.surfaces[0]),
            (8, powers.mass),
            (9, powers.inertia),
            (13, powers.density),
            (14, powers.length),
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

    use super::{BIAS_OF_ALPHA, CONSTANTS, OUTPUTS, STATES, row};
    use crate::core::term::{Coefficient, Term};
    use crate::models::longitudinal::{Database, LongitudinalConstants, LongitudinalInput, LongitudinalModel};
    use crate::models::small_errors::assert_effects;
    use crate::models::surface_motion::SurfaceMotion;

    const TERMS: [(Coefficient, &str); 7] = [
        (Coefficient::Lift, "alpha"),
        (Coefficient::Lift, "elevator"),
        (Coefficient::Drag, "alpha^2"),
        (Coefficient::PitchingMoment, "alpha"),
        (Coefficient::PitchingMoment, "q_hat"),
        (Coefficient::PitchingMoment, "elevator"),
        (Coefficient::PitchingMoment, "alpha*elevator"),
    ];
    const THETA: [f64; 7] = [4.8, 0.4, 0.9, -0.7, -9.0, -1.1, 0.3];
    const X: [f64; STATES] = [140.0, 0.06, 0.11, 0.2];
    const U: LongitudinalInput = LongitudinalInput {
        elevator: -0.05,
        air_density: 0.9,
        thrust: 14_000.0,
        mass: 9300.0,
        iyy: 75_000.0,
        extra: [0.0; 3],
        controls_held: false,
    };
    const CHORD: f64 = 3.45;
    const SURFACES: SurfaceMotion = SurfaceMotion { rates: [0.4, 0.0, 0.0], play: [-0.3, 0.0, 0.0] };

    fn model(database: Database) -> LongitudinalModel {
        let constants = LongitudinalConstants {
            wing_area: 27.87,
            mean_chord: CHORD,
            gravity: 9.80665,
            thrust_inclination: 0.03,
            thrust_arm: 0.1,
            reference_speed: 140.0,
            rate_speed: None,
            alpha_reference: 0.0,
            elevator_reference: 0.0,
        };
        let terms = TERMS.map(|(coefficient, text)| (coefficient, Term::parse(text, &[]).unwrap()));
        LongitudinalModel::new(constants, database, terms.to_vec(), Vec::new())
    }

    /// Rates, then outputs.
    fn at(model: &LongitudinalModel, u: &LongitudinalInput) -> [f64; STATES + OUTPUTS] {
        let rates = Model::<STATES, OUTPUTS, 7>::rates(model, &X, &THETA, u);
        let mut lin = LinearizedOutputs::<STATES, OUTPUTS, 7>::ZERO;
        model.linearized_outputs(&X, &THETA, u, &mut lin);
        std::array::from_fn(|i| if i < STATES { rates[i] } else { lin.outputs[i - STATES] })
    }

    /// What is shown and flown with a constant of `c`, worked out by making it so.
    fn with(model: &LongitudinalModel, column: usize, c: f64) -> [f64; STATES + OUTPUTS] {
        let mut u = U;
        let output = |row: usize| STATES + row;
        match column {
            4 => u.elevator *= 1.0 - c,
            5 => u.elevator += c * SURFACES.rates[0],
            15 => u.elevator += c * SURFACES.play[0],
            13 => u.air_density *= 1.0 - c,
            8 => u.mass *= 1.0 + c,
            9 => u.iyy *= 1.0 + c,
            11 => u.thrust *= 1.0 + c,
            _ => {}
        }
        let mut larger = model.clone();
        if column == 14 {
            larger.constants.wing_area *= (1.0 + c).powi(2);
            larger.constants.mean_chord *= 1.0 + c;
        }
        let mut shown = at(&larger, &u);
        let rates = at(model, &U);
        match column {
            0 => shown[output(row::TRUE_AIRSPEED)] *= 1.0 + c,
            1 => shown[output(row::TRUE_AIRSPEED)] *= 1.0 + c * X[1],
            2 => shown[output(row::ALPHA)] *= 1.0 + c,
            3 => shown[output(row::ALPHA)] -= c * rates[1],
            12 => shown[output(row::ALPHA)] += c,
            16 => shown[output(row::ALPHA)] -= c * X[3] / X[0],
            // w' x r + w x (w x r), ahead and below.
            17 => {
                shown[output(row::AX)] -= X[3] * X[3] * c;
                shown[output(row::AZ)] -= rates[3] * c;
            }
            18 => {
                shown[output(row::AX)] += rates[3] * c;
                shown[output(row::AZ)] -= X[3] * X[3] * c;
            }
            6 => shown[output(row::AX)] *= 1.0 + c,
            7 => shown[output(row::AZ)] *= 1.0 + c,
            9 => shown[output(row::PITCH_ACCELERATION)] = shown[3],
            10 => {
                // Aerodynamic force along body z, without thrust; it turns the aircraft about a point c chords behind.
                let z = rates[output(row::AZ)] * U.mass + U.thrust * 0.03_f64.sin();
                shown[3] -= c * CHORD * z / U.iyy;
                shown[output(row::PITCH_ACCELERATION)] = shown[3];
                // Acceleration of a point ahead of the centre of gravity: w' x r + w x (w x r).
                shown[output(row::AX)] -= X[3] * X[3] * c * CHORD;
                shown[output(row::AZ)] -= rates[3] * c * CHORD;
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
            let mut effects = ConstantEffects::<STATES, OUTPUTS, 19>::ZERO;
            model.effects_of_constants(&X, &THETA, &U, &SURFACES, &mut effects);
            assert_effects(&CONSTANTS, &effects, |column, c| with(&model, column, c).to_vec());
        }
    }

    /// The regressors of the accelerometers and of the pitch acceleration at another angle of attack, against those of other
    /// columns: what a zero of the vane adds to each column that has them.
    #[test]
    fn the_shifts_are_those_of_the_regressors() {
        const ALL: [(Coefficient, &str); 9] = [
            (Coefficient::Lift, "1"),
            (Coefficient::Lift, "alpha"),
            (Coefficient::Lift, "alpha^2"),
            (Coefficient::Drag, "alpha^2"),
            (Coefficient::Drag, "1"),
            (Coefficient::Drag, "alpha"),
            (Coefficient::PitchingMoment, "1"),
            (Coefficient::PitchingMoment, "elevator"),
            (Coefficient::PitchingMoment, "alpha*elevator"),
        ];
        let constants = LongitudinalConstants { alpha_reference: 0.02, ..*model(Database::None).constants() };
        let terms = ALL.map(|(coefficient, text)| (coefficient, Term::parse(text, &[]).unwrap()));
        let model = LongitudinalModel::new(constants, Database::None, terms.to_vec(), Vec::new());
        let regressors = |alpha: f64| {
            let x = [X[0], alpha, X[2], X[3]];
            let mut lin = LinearizedOutputs::<STATES, OUTPUTS, 9>::ZERO;
            model.linearized_outputs(&x, &[0.0; 9], &U, &mut lin);
            [row::AX, row::AZ, row::PITCH_ACCELERATION].map(|row| lin.parameter_jacobian[row])
        };
        let c = 1e-6;
        let (up, here, down) = (regressors(X[1] + c), regressors(X[1]), regressors(X[1] - c));
        for column in 0..9 {
            let shifts = model.shifts_of_constants(column);
            let of_zero = shifts.iter().filter(|shift| shift.constant == BIAS_OF_ALPHA);
            // A derivative has the constant of its coefficient, and lift and drag have each other.
            assert_eq!(of_zero.clone().count(), [1, 2, 2, 2, 1, 2, 0, 0, 1][column], "column {column}");
            for output in 0..3 {
                let expected = (up[output][column] - down[output][column]) / (2.0 * c);
                let found: f64 = of_zero.clone().map(|shift| shift.per_unit * here[output][shift.of]).sum();
                let largest = here[output].iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
                assert!((found - expected).abs() < 1e-7 * largest, "{column} {output}: {found} {expected}");
            }
            // Of a scale they are those at the reference point.
            let of_scale: f64 = shifts.iter().filter(|shift| shift.constant == 2).map(|shift| shift.per_unit).sum();
            let of_zero: f64 = of_zero.map(|shift| shift.per_unit).sum();
            assert!((of_scale - 0.02 * of_zero).abs() < 1e-15, "column {column}");
        }
    }
}
