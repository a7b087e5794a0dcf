//! The model of the whole motion against the simulation's equations of motion, and the lateral and the longitudinal model
//! against it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use num_dual::{Dual64, DualNum};
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, Geometry, Propulsion, State};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::Scalar;
use phugoid_identification::lateral::{LATERAL_OUTPUTS, LATERAL_STATES, LateralInput, LateralModel};
use phugoid_identification::longitudinal::{Database, LongitudinalConstants, LongitudinalInput, LongitudinalModel};
use phugoid_identification::rigid::{AircraftConstants, MassInput, Surfaces};
use phugoid_identification::six::{SIX_OUTPUTS, SIX_STATES, SixInput, SixModel};
use phugoid_identification::term::{Coefficient, Term};
use proptest::prelude::*;

/// Room for the 24 increments of the simulation.
const P: usize = 24;
const THRUST: f64 = 9000.0;
const ALTITUDE: f64 = 6096.0;
const REFERENCE: [f64; 2] = [0.0417, -0.0343];

/// The F-16 with thrust that does not change: what the estimators' models assume.
struct Frozen(F16);

impl Aircraft for Frozen {
    fn geometry(&self) -> &Geometry {
        self.0.geometry()
    }
    fn mass_properties(&self) -> &MassProperties {
        self.0.mass_properties()
    }
    fn gravity(&self) -> f64 {
        self.0.gravity()
    }
    fn atmosphere(&self) -> Atmosphere {
        self.0.atmosphere()
    }
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        self.0.coefficients(air, rates, controls)
    }
    fn propulsion<T: Scalar>(&self, _: T, _: T, _: T) -> Propulsion<T> {
        let zero = T::from(0.0);
        Propulsion { force: [T::from(THRUST), zero, zero], moment: [zero; 3] }
    }
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        self.0.power_rate(throttle, power)
    }
    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        self.0.steady_power(throttle)
    }
    fn actuators(&self) -> &Actuators {
        self.0.actuators()
    }
}

/// The dual numbers of the num-dual crate as a scalar of the equations of motion.
#[derive(Clone, Copy)]
struct Foreign(Dual64);

macro_rules! operators {
    ($($operator:ident $method:ident),*) => { $(
        impl std::ops::$operator for Foreign {
            type Output = Self;
            fn $method(self, o: Self) -> Self {
                Self(std::ops::$operator::$method(self.0, o.0))
            }
        }
        impl std::ops::$operator<f64> for Foreign {
            type Output = Self;
            fn $method(self, o: f64) -> Self {
                Self(std::ops::$operator::$method(self.0, o))
            }
        }
    )* };
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl std::ops::Neg for Foreign {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
impl From<f64> for Foreign {
    fn from(value: f64) -> Self {
        Self(Dual64::from(value))
    }
}
impl Scalar for Foreign {
    fn real(self) -> f64 {
        self.0.re
    }
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    fn sin_cos(self) -> (Self, Self) {
        (Self(self.0.sin()), Self(self.0.cos()))
    }
    fn atan2(self, x: Self) -> Self {
        Self(self.0.atan2(x.0))
    }
    fn asin(self) -> Self {
        Self(self.0.asin())
    }
    fn powf(self, exponent: f64) -> Self {
        Self(self.0.powf(exponent))
    }
    fn exp(self) -> Self {
        Self(self.0.exp())
    }
}

fn f16() -> F16 {
    F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap()
}

/// The inertia of the F-16 (Stevens & Lewis, appendix A), kg m^2.
fn mass_input(aircraft: &F16) -> MassInput {
    let slug_ft2 = 1.355_817_948_331_400_4;
    MassInput {
        mass: aircraft.mass_properties.mass(),
        ixx: 9496.0 * slug_ft2,
        iyy: 55814.0 * slug_ft2,
        izz: 63100.0 * slug_ft2,
        ixz: 982.0 * slug_ft2,
    }
}

fn constants(aircraft: &F16) -> AircraftConstants {
    AircraftConstants {
        wing_area: aircraft.geometry.wing_area,
        mean_chord: aircraft.geometry.mean_chord,
        span: aircraft.geometry.span,
        gravity: aircraft.gravity,
        thrust_inclination: 0.0,
        thrust_arm: 0.0,
        rotor_momentum: aircraft.mass_properties.rotor_momentum(),
        reference_speed: 200.0,
        rate_speed: None,
        alpha_reference: REFERENCE[0],
        elevator_reference: REFERENCE[1],
        aileron_reference: 0.0,
        rudder_reference: 0.0,
    }
}

/// All derivatives of [`Increments`], in the order of `increments`.
fn all_terms() -> Vec<(Coefficient, Term)> {
    let [symmetric, lateral] = [&Coefficient::ALL[..3], &Coefficient::ALL[3..]];
    let of = |coefficients: &[Coefficient], words: &[&str]| -> Vec<(Coefficient, Term)> {
        let terms = coefficients.iter().flat_map(|c| words.iter().map(|w| (*c, Term::parse(w, &[]).unwrap())));
        terms.collect()
    };
    let mut all = of(symmetric, &["alpha", "q_hat", "elevator"]);
    all.extend(of(lateral, &["beta", "p_hat", "r_hat", "aileron", "rudder"]));
    all
}

fn increments(t: &[f64; P]) -> Increments {
    Increments {
        alpha_reference: REFERENCE[0],
        q_reference: 0.0,
        elevator_reference: REFERENCE[1],
        dCL_alpha: t[0],
        dCL_q: t[1],
        dCL_elevator: t[2],
        dCD_alpha: t[3],
        dCD_q: t[4],
        dCD_elevator: t[5],
        dCm_alpha: t[6],
        dCm_q: t[7],
        dCm_elevator: t[8],
        dCY_beta: t[9],
        dCY_p: t[10],
        dCY_r: t[11],
        dCY_aileron: t[12],
        dCY_rudder: t[13],
        dCl_beta: t[14],
        dCl_p: t[15],
        dCl_r: t[16],
        dCl_aileron: t[17],
        dCl_rudder: t[18],
        dCn_beta: t[19],
        dCn_p: t[20],
        dCn_r: t[21],
        dCn_aileron: t[22],
        dCn_rudder: t[23],
    }
}

/// The simulation's rates of the eight states, and the specific force.
fn simulated<T: Scalar>(x: &[T; 8], theta: &[f64; P], surfaces: &Surfaces) -> ([T; 8], [T; 3]) {
    let zero = T::from(0.0);
    let mut state = State::from_array([zero; 13]);
    [state.speed, state.alpha, state.beta, state.phi, state.theta, state.p, state.q, state.r] = *x;
    state.altitude = T::from(ALTITUDE);
    let controls = Controls {
        throttle: zero,
        elevator: T::from(surfaces.elevator),
        aileron: T::from(surfaces.aileron),
        rudder: T::from(surfaces.rudder),
    };
    let disturbance = Disturbance { increments: increments(theta), ..Disturbance::default() };
    let m = motion(&Frozen(f16()), &state, &controls, &disturbance);
    let r = m.rates;
    ([r.speed, r.alpha, r.beta, r.phi, r.theta, r.p, r.q, r.r], m.specific_force)
}

struct Case {
    model: SixModel,
    x: [f64; 8],
    theta: [f64; P],
    input: SixInput,
}

fn case(x: [f64; 8], theta: [f64; P], surfaces: [f64; 3]) -> Case {
    let aircraft = f16();
    let [elevator, aileron, rudder] = surfaces;
    let input = SixInput {
        surfaces: Surfaces { elevator, aileron, rudder, ..Surfaces::default() },
        air_density: aircraft.atmosphere.at(ALTITUDE).density,
        thrust: THRUST,
        mass: mass_input(&aircraft),
    };
    let model = SixModel::new(constants(&aircraft), Database::F16(Box::new(aircraft)), all_terms(), Vec::new());
    Case { model, x, theta, input }
}

fn rates_of(c: &Case) -> LinearizedRates<SIX_STATES, P> {
    let mut out = LinearizedRates::ZERO;
    c.model.linearized_rates(&c.x, &c.theta, &c.input, &mut out);
    out
}

fn outputs_of(c: &Case) -> LinearizedOutputs<SIX_STATES, SIX_OUTPUTS, P> {
    let mut out = LinearizedOutputs::ZERO;
    c.model.linearized_outputs(&c.x, &c.theta, &c.input, &mut out);
    out
}

fn near(a: f64, b: f64, tolerance: f64, what: &str) -> Result<(), TestCaseError> {
    prop_assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{}: {} against {}", what, a, b);
    Ok(())
}

prop_compose! {
    fn any_case()(
        speed in 80.0..300.0, alpha in -0.1..0.5, beta in -0.4..0.4, phi in -3.0..3.0, theta in -1.3..1.3,
        p in -2.0..2.0, q in -1.0..1.0, r in -1.0..1.0,
        surfaces in [-0.4..0.4, -0.37..0.37, -0.5..0.5], parameters in proptest::array::uniform24(-1.0..1.0_f64),
    ) -> Case {
        case([speed, alpha, beta, phi, theta, p, q, r], parameters, surfaces)
    }
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "x {:?}, theta {:?}, input {:?}", self.x, self.theta, self.input)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: proptest::test_runner::RngSeed::Fixed(4), failure_persistence: None, ..ProptestConfig::default() })]

    /// The same rates and specific forces as the simulation flies, with every increment at work: to rounding.
    #[test]
    fn rates_are_those_of_the_simulation(c in any_case()) {
        let (rates, force) = simulated(&c.x, &c.theta, &c.input.surfaces);
        let found = <SixModel as Model<SIX_STATES, SIX_OUTPUTS, P>>::rates(&c.model, &c.x, &c.theta, &c.input);
        let (linearized, outputs) = (rates_of(&c), outputs_of(&c));
        for i in 0..8 {
            near(found[i], rates[i], 1e-12, &format!("rate {i}"))?;
            near(linearized.rates[i], rates[i], 1e-12, &format!("linearised rate {i}"))?;
            prop_assert_eq!(outputs.outputs[i], c.x[i]);
        }
        for i in 0..3 {
            near(outputs.outputs[8 + i], force[i], 1e-12, &format!("specific force {i}"))?;
            near(outputs.outputs[11 + i], rates[5 + i], 1e-12, &format!("angular acceleration {i}"))?;
        }
    }

    /// The derivatives against those of the simulation's equations by the num-dual crate.
    #[test]
    fn jacobians_are_those_of_num_dual(c in any_case()) {
        let (linearized, outputs) = (rates_of(&c), outputs_of(&c));
        for j in 0..8 {
            let x = std::array::from_fn(|i| Foreign(Dual64::new(c.x[i], f64::from(i == j))));
            let (rates, force) = simulated(&x, &c.theta, &c.input.surfaces);
            for i in 0..8 {
                near(linearized.state_jacobian[i][j], rates[i].0.eps, 1e-11, &format!("df{i}/dx{j}"))?;
                prop_assert_eq!(outputs.state_jacobian[i][j], f64::from(i == j));
            }
            for i in 0..3 {
                near(outputs.state_jacobian[8 + i][j], force[i].0.eps, 1e-11, &format!("df{i}/dx{j}"))?;
                near(outputs.state_jacobian[11 + i][j], rates[5 + i].0.eps, 1e-11, &format!("dw{i}/dx{j}"))?;
            }
        }
        // Linear in the parameters: a step of one gives the exact derivative.
        for j in 0..P {
            let mut theta = c.theta;
            theta[j] += 1.0;
            let other = Case { theta, model: c.model.clone(), ..c };
            let (r, y) = (rates_of(&other), outputs_of(&other));
            for i in 0..8 {
                near(r.rates[i] - linearized.rates[i], linearized.regressors[i][j], 1e-10, &format!("df{i}/dtheta{j}"))?;
            }
            for i in 0..SIX_OUTPUTS {
                let difference = y.outputs[i] - outputs.outputs[i];
                near(difference, outputs.parameter_jacobian[i][j], 1e-10, &format!("dy{i}/dtheta{j}"))?;
            }
        }
    }

    /// The lateral model is the whole motion with the motion in the plane of symmetry given.
    #[test]
    fn the_lateral_model_is_the_whole_motion_with_the_rest_given(c in any_case()) {
        let [speed, alpha, beta, phi, theta, p, q, r] = c.x;
        let (six, outputs) = (rates_of(&c), outputs_of(&c));
        let lateral = LateralModel::new(*c.model.constants(), Database::F16(Box::new(f16())), all_terms(), Vec::new());
        let u = LateralInput {
            surfaces: c.input.surfaces,
            air_density: c.input.air_density,
            mass: c.input.mass,
            speed,
            alpha,
            theta,
            q,
            ax: outputs.outputs[8],
            az: outputs.outputs[10],
        };
        let x = [beta, phi, p, r];
        let mut found = LinearizedRates::<LATERAL_STATES, P>::ZERO;
        lateral.linearized_rates(&x, &c.theta, &u, &mut found);
        let plain = <LateralModel as Model<LATERAL_STATES, LATERAL_OUTPUTS, P>>::rates(&lateral, &x, &c.theta, &u);
        let mut y = LinearizedOutputs::<LATERAL_STATES, LATERAL_OUTPUTS, P>::ZERO;
        lateral.linearized_outputs(&x, &c.theta, &u, &mut y);
        for (i, six_row) in [2, 3, 5, 7].into_iter().enumerate() {
            near(found.rates[i], six.rates[six_row], 1e-12, &format!("rate {i}"))?;
            near(plain[i], six.rates[six_row], 1e-12, &format!("plain rate {i}"))?;
            // The columns of lift and drag reach the sideslip through the measured ax and az.
            for j in 9..P {
                near(found.regressors[i][j], six.regressors[six_row][j], 1e-10, &format!("{i} {j}"))?;
            }
        }
        for (i, six_row) in [(4, 9), (5, 11), (6, 13)] {
            near(y.outputs[i], outputs.outputs[six_row], 1e-12, &format!("output {i}"))?;
            for (k, six_state) in [2, 3, 5, 7].into_iter().enumerate() {
                let exact = outputs.state_jacobian[six_row][six_state];
                near(y.state_jacobian[i][k], exact, 1e-11, &format!("dy{i}/dx{k}"))?;
            }
            for j in 9..P {
                near(y.parameter_jacobian[i][j], outputs.parameter_jacobian[six_row][j], 1e-11, &format!("dy{i}/dt{j}"))?;
            }
        }
        // Roll and turn do not know ax and az: their state derivatives are the same. Sideslip: by differences.
        for (i, six_row) in [(1, 3), (2, 5), (3, 7)] {
            for (k, six_state) in [2, 3, 5, 7].into_iter().enumerate() {
                near(found.state_jacobian[i][k], six.state_jacobian[six_row][six_state], 1e-11, &format!("{i} {k}"))?;
            }
        }
        for k in 0..LATERAL_STATES {
            let at = |step: f64| {
                let mut shifted = x;
                shifted[k] += step;
                <LateralModel as Model<LATERAL_STATES, LATERAL_OUTPUTS, P>>::rates(&lateral, &shifted, &c.theta, &u)[0]
            };
            // Central differences of 1e-6 are good to about 1e-9 of rates of the order of one.
            near(found.state_jacobian[0][k], (at(1e-6) - at(-1e-6)) / 2e-6, 1e-7, &format!("dbeta'/dx{k}"))?;
        }
    }

    /// Without sideslip, bank, roll and yaw the longitudinal model is the same motion.
    #[test]
    fn in_the_plane_of_symmetry_it_is_the_longitudinal_model(
        speed in 80.0..300.0, alpha in -0.1..0.5, theta in -1.3..1.3, q in -1.0..1.0, elevator in -0.4..0.4,
        parameters in proptest::array::uniform24(-1.0..1.0_f64),
    ) {
        let c = case([speed, alpha, 0.0, 0.0, theta, 0.0, q, 0.0], parameters, [elevator, 0.0, 0.0]);
        let k = c.model.constants();
        let constants = LongitudinalConstants {
            wing_area: k.wing_area,
            mean_chord: k.mean_chord,
            gravity: k.gravity,
            thrust_inclination: 0.0,
            thrust_arm: 0.0,
            reference_speed: k.reference_speed,
            rate_speed: None,
            alpha_reference: k.alpha_reference,
            elevator_reference: k.elevator_reference,
        };
        let plane = LongitudinalModel::new(constants, Database::F16(Box::new(f16())), all_terms()[..9].to_vec(), Vec::new());
        let u = LongitudinalInput {
            elevator,
            air_density: c.input.air_density,
            thrust: THRUST,
            mass: c.input.mass.mass,
            iyy: c.input.mass.iyy,
            ..LongitudinalInput::default()
        };
        let mut expected = LinearizedRates::<4, P>::ZERO;
        plane.linearized_rates(&[speed, alpha, theta, q], &c.theta, &u, &mut expected);
        let found = rates_of(&c);
        for (i, row) in [0, 1, 4, 6].into_iter().enumerate() {
            near(found.rates[row], expected.rates[i], 1e-12, &format!("rate {i}"))?;
            for (j, column) in [0, 1, 4, 6].into_iter().enumerate() {
                near(found.state_jacobian[row][column], expected.state_jacobian[i][j], 1e-11, &format!("{i} {j}"))?;
            }
            for j in 0..9 {
                near(found.regressors[row][j], expected.regressors[i][j], 1e-11, &format!("{i} theta{j}"))?;
            }
        }
    }
}
