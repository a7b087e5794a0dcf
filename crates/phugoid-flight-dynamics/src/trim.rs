//! Steady flight: the angles, rates and controls that keep an aircraft straight and level, climbing, or turning.
//!
//! Eight equations, in this order,
//!
//! ```text
//! V' = 0, alpha' = 0, beta' = 0, p' = 0, q' = 0, r' = 0, h' = V sin(gamma), ay = 0
//! ```
//!
//! in the eight unknowns alpha, beta, phi, theta, throttle, elevator, aileron, rudder. The last equation says that no side
//! force is felt: in steady flight it is the turn coordination constraint of Stevens, Lewis & Johnson (3.6-7), and
//! without a turn it makes the wings level. The climb equation is their rate-of-climb constraint (3.6-1). The body rates
//! follow from the turn rate (their 3.6-6):
//!
//! ```text
//! p = -psi' sin(theta), q = psi' sin(phi) cos(theta), r = psi' cos(phi) cos(theta)
//! ```
//!
//! The equations are solved as a root-finding problem by Levenberg-Marquardt with exact derivatives, not by minimising a
//! cost, from several angles of attack in turn. Beyond the ends of the throttle the solver goes on with an extra force
//! along the thrust, and beyond the surfaces' limits with the aircraft's own data, so that it can say how much would have
//! been needed.

mod approach;

use std::ops::RangeInclusive;

use nalgebra::{SMatrix, SVector};
use serde::Serialize;

use crate::aircraft::{Aircraft, Controls, State};
use crate::increments::Increments;
use crate::motion::{Disturbance, Motion, motion};
use crate::scalar::{Dual, Scalar};

pub use approach::{TrimStart, TrimStep, approach};

/// The steady flight asked for. Still air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimCondition {
    /// True airspeed, m/s.
    pub speed: f64,
    /// Altitude above sea level, m; from -1000 to 25,000 m.
    pub altitude: f64,
    /// Flight path angle, rad, positive climbing. A climb is steady but for the change of the air with altitude.
    pub flight_path_angle: f64,
    /// Rate of the heading, rad/s, positive to the right.
    pub turn_rate: f64,
    /// Heading, rad; it does not influence the trim.
    pub heading: f64,
    /// Aerodynamic increments in force.
    pub increments: Increments,
    /// Lowest and highest angle of attack, rad, that the aircraft's data are good for. A trim outside is refused.
    pub alpha_range: [f64; 2],
}

impl TrimCondition {
    /// Straight and level at a true airspeed (m/s) and altitude (m), heading north. Angles of attack from -20 to 50 deg:
    /// databases that go further are rare, and beyond its data an aircraft has equilibria that mean nothing.
    pub fn level(speed: f64, altitude: f64) -> Self {
        Self {
            speed,
            altitude,
            flight_path_angle: 0.0,
            turn_rate: 0.0,
            heading: 0.0,
            increments: Increments::NONE,
            alpha_range: [-20.0 * DEGREE, 50.0 * DEGREE],
        }
    }
}

/// A steady flight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trim {
    /// True airspeed, m/s.
    pub speed_m_s: f64,
    /// Altitude, m.
    pub altitude_m: f64,
    /// Flight path angle, rad.
    pub flight_path_angle_rad: f64,
    /// Rate of the heading, rad/s.
    pub turn_rate_rad_s: f64,
    /// Angle of attack, rad.
    pub alpha_rad: f64,
    /// Sideslip angle, rad.
    pub beta_rad: f64,
    /// Bank angle, rad.
    pub phi_rad: f64,
    /// Pitch angle, rad.
    pub theta_rad: f64,
    /// Heading, rad.
    pub psi_rad: f64,
    /// Roll rate, rad/s.
    pub p_rad_s: f64,
    /// Pitch rate, rad/s.
    pub q_rad_s: f64,
    /// Yaw rate, rad/s.
    pub r_rad_s: f64,
    /// Throttle lever, 0 to 1.
    pub throttle: f64,
    /// Elevator, rad, positive trailing edge down.
    pub elevator_rad: f64,
    /// Aileron, rad.
    pub aileron_rad: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
    /// Engine state, percent.
    pub power_percent: f64,
    /// Thrust, N: magnitude of the propulsive force, negative when it points backwards.
    pub thrust_n: f64,
    /// Dynamic pressure, Pa.
    pub dynamic_pressure_pa: f64,
    /// Mach number.
    pub mach: f64,
    /// Normal load factor at the centre of gravity, `-az/g`, 1 in level flight at small angle of attack.
    pub load_factor: f64,
    /// Trim index of the thesis (2.31), `J = V'^2 + alpha'^2 + beta'^2 + p'^2 + q'^2 + r'^2`, here with V' in m/s^2, the
    /// others in rad/s and rad/s^2. The thesis has V' in ft/s^2, which makes that term 10.76 times as large.
    pub trim_index: f64,
    /// Largest of the eight residuals: accelerations over gravity, the others in rad/s, rad/s^2, and sine of an angle.
    pub largest_residual: f64,
    /// Iterations of the solver from the start that succeeded.
    pub iterations: usize,
}

impl Trim {
    /// The state of the aircraft, above the origin.
    pub fn state(&self) -> State {
        State {
            speed: self.speed_m_s,
            alpha: self.alpha_rad,
            beta: self.beta_rad,
            phi: self.phi_rad,
            theta: self.theta_rad,
            psi: self.psi_rad,
            p: self.p_rad_s,
            q: self.q_rad_s,
            r: self.r_rad_s,
            north: 0.0,
            east: 0.0,
            altitude: self.altitude_m,
            power: self.power_percent,
        }
    }

    /// Throttle lever and surface positions.
    pub fn controls(&self) -> Controls {
        Controls {
            throttle: self.throttle,
            elevator: self.elevator_rad,
            aileron: self.aileron_rad,
            rudder: self.rudder_rad,
        }
    }
}

/// Why there is no steady flight. Numbers are those of the equilibrium that was found without the limit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// A number of the condition makes no sense.
    #[error("trim: {field} is {value}, expected {expected}")]
    Condition {
        /// Name of the field.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// More thrust is needed than the engine has at full throttle.
    #[error(
        "trim: not enough thrust: {needed_n:.0} N needed, {available_n:.0} N available at full throttle (angle of attack \
         {:.2} deg); fly lower, less steeply, or nearer to the speed of least drag", alpha_rad.to_degrees()
    )]
    NotEnoughThrust {
        /// Thrust needed, N.
        needed_n: f64,
        /// Thrust at full throttle, N.
        available_n: f64,
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
    },
    /// Less thrust is needed than the engine gives at idle.
    #[error(
        "trim: too much thrust: {needed_n:.0} N needed, {idle_n:.0} N at idle (angle of attack {:.2} deg); descend less \
         steeply, or at a speed with more drag", alpha_rad.to_degrees()
    )]
    TooMuchThrust {
        /// Thrust needed, N.
        needed_n: f64,
        /// Thrust at idle, N.
        idle_n: f64,
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
    },
    /// A surface would have to go beyond its stop.
    #[error(
        "trim: {surface} at its limit: {:.2} deg needed, {:.2} deg available (angle of attack {:.2} deg)",
        needed_rad.to_degrees(), limit_rad.to_degrees(), alpha_rad.to_degrees()
    )]
    SurfaceLimit {
        /// Name of the surface.
        surface: &'static str,
        /// Deflection needed, rad.
        needed_rad: f64,
        /// Largest deflection to either side, rad.
        limit_rad: f64,
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
    },
    /// The equilibrium lies where the aircraft has no data.
    #[error(
        "trim: the only equilibrium found is at an angle of attack of {:.2} deg, the data are good from {:.2} to {:.2} deg",
        alpha_rad.to_degrees(), lowest_rad.to_degrees(), highest_rad.to_degrees()
    )]
    OutsideData {
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
        /// Lowest angle of attack allowed, rad.
        lowest_rad: f64,
        /// Highest angle of attack allowed, rad.
        highest_rad: f64,
    },
    /// Too slow for the flight path: not even the best angle of attack carries the aircraft.
    #[error(
        "trim: not enough lift: the flight path needs a load factor of {needed:.2}, the most there is at this speed and \
         altitude up to the highest angle of attack allowed is {available:.2} (at {:.1} deg with full thrust and neutral \
         surfaces); fly faster, lower, or turn less", alpha_rad.to_degrees()
    )]
    NotEnoughLift {
        /// Load factor across the flight path that is needed.
        needed: f64,
        /// Largest load factor across the flight path in the range of angle of attack, thrust included.
        available: f64,
        /// Angle of attack of the largest load factor, rad.
        alpha_rad: f64,
    },
    /// No equilibrium was found from any start.
    #[error(
        "trim: no equilibrium found: the best of {starts} starts leaves {equation} = {residual:.3e} at an angle of attack \
         of {:.2} deg", alpha_rad.to_degrees()
    )]
    NoConvergence {
        /// Number of starting points.
        starts: usize,
        /// The equation with the largest residual.
        equation: &'static str,
        /// Its residual: accelerations over gravity, the others in rad/s, rad/s^2, or sine of an angle.
        residual: f64,
        /// Angle of attack reached, rad.
        alpha_rad: f64,
    },
}

const DEGREE: f64 = core::f64::consts::PI / 180.0;
const UNKNOWNS: usize = 8;
const EQUATIONS: [&str; UNKNOWNS] = [
    "speed rate",
    "angle-of-attack rate",
    "sideslip rate",
    "roll acceleration",
    "pitch acceleration",
    "yaw acceleration",
    "climb",
    "side force",
];
/// Starts in angle of attack, deg: the attached-flow equilibrium is found before those beyond the stall.
const STARTS_DEG: [f64; 8] = [3.0, 8.0, 14.0, 20.0, 27.0, 34.0, 40.0, 45.0];
/// Residual of an equilibrium. The equations are of order one and exact to some 1e-15.
const TOLERANCE: f64 = 1e-11;

/// The steady flight at a condition: the first one, from starts of rising angle of attack, that lies within the aircraft's
/// limits (throttle 0 to 1, actuator limits, the condition's range of angle of attack).
///
/// # Errors
/// [`TrimError`] says which limit stands against it and by how much, or how far the solver came.
pub fn trim<A: Aircraft>(aircraft: &A, condition: &TrimCondition) -> Result<Trim, TrimError> {
    check(condition)?;
    let problem = Problem::new(aircraft, condition);
    let mut mildest: Option<(f64, TrimError)> = None;
    let mut closest: Option<Solution> = None;
    for start in STARTS_DEG {
        let solution = problem.solve(problem.start(start.to_radians()), &mut |_, _| ());
        if solution.largest() > TOLERANCE {
            if closest.as_ref().is_none_or(|c| solution.largest() < c.largest()) {
                closest = Some(solution);
            }
            continue;
        }
        match problem.refusal(&solution) {
            None => return Ok(problem.report(&solution)),
            Some(refusal) => {
                if mildest.as_ref().is_none_or(|m| refusal.0 < m.0) {
                    mildest = Some(refusal);
                }
            }
        }
    }
    if let Some(refusal) = problem.not_enough_lift() {
        return Err(refusal);
    }
    match (mildest, closest) {
        (Some((_, refusal)), _) => Err(refusal),
        (None, closest) => {
            let residuals = closest.as_ref().map_or([f64::NAN; UNKNOWNS], |s| s.residuals);
            let worst = (0..UNKNOWNS).max_by(|&a, &b| residuals[a].abs().total_cmp(&residuals[b].abs())).unwrap_or(0);
            Err(TrimError::NoConvergence {
                starts: STARTS_DEG.len(),
                equation: EQUATIONS[worst],
                residual: residuals[worst],
                alpha_rad: closest.map_or(f64::NAN, |s| s.unknowns[0]),
            })
        }
    }
}

/// Altitudes, m, in which the atmosphere models mean something; not far above, the air of Stevens & Lewis ends.
const ATMOSPHERE: RangeInclusive<f64> = -1_000.0..=25_000.0;

fn check(c: &TrimCondition) -> Result<(), TrimError> {
    let [low, high] = c.alpha_range;
    for (field, value, valid, expected) in [
        ("speed", c.speed, c.speed > 0.0, "a positive number, m/s"),
        (
            "altitude",
            c.altitude,
            ATMOSPHERE.contains(&c.altitude),
            "between -1000 and 25000 m, where the models of the air hold",
        ),
        ("flight_path_angle", c.flight_path_angle, c.flight_path_angle.abs() < 1.5, "between -1.5 and 1.5 rad"),
        ("turn_rate", c.turn_rate, true, "a number, rad/s"),
        ("heading", c.heading, true, "a number, rad"),
        ("alpha_range", low, low < high, "the lower angle of attack first, rad"),
        ("alpha_range", high, true, "a number, rad"),
    ] {
        if !valid || !value.is_finite() {
            return Err(TrimError::Condition { field, value, expected });
        }
    }
    Ok(())
}

struct Problem<'a, A> {
    aircraft: &'a A,
    condition: &'a TrimCondition,
    disturbance: Disturbance,
    /// Specific force per unit of throttle beyond its ends, along the full thrust.
    excess: [f64; 3],
}

/// Where the solver has come to.
struct Solution {
    /// alpha, beta, phi, theta, throttle (beyond its ends too), elevator, aileron, rudder.
    unknowns: [f64; UNKNOWNS],
    residuals: [f64; UNKNOWNS],
    iterations: usize,
}

impl Solution {
    fn largest(&self) -> f64 {
        self.residuals.iter().fold(0.0, |m: f64, r| if r.is_nan() { f64::INFINITY } else { m.max(r.abs()) })
    }
}

impl<'a, A: Aircraft> Problem<'a, A> {
    fn new(aircraft: &'a A, condition: &'a TrimCondition) -> Self {
        let mach = condition.speed / aircraft.atmosphere().at(condition.altitude).speed_of_sound;
        let force =
            |throttle: f64| aircraft.propulsion(aircraft.steady_power(throttle), condition.altitude, mach).force;
        let (full, idle) = (force(1.0), force(0.0));
        let inverse_mass = aircraft.mass_properties().inverse_mass();
        let excess = core::array::from_fn(|i| (full[i] - idle[i]) * inverse_mass);
        let disturbance = Disturbance { increments: condition.increments, ..Disturbance::default() };
        Self { aircraft, condition, disturbance, excess }
    }

    fn state_and_controls<T: Scalar>(&self, z: &[T; UNKNOWNS]) -> (State<T>, Controls<T>) {
        let &[alpha, beta, phi, theta, lever, elevator, aileron, rudder] = z;
        let throttle = if lever.real() > 1.0 {
            T::from(1.0)
        } else if lever.real() < 0.0 {
            T::from(0.0)
        } else {
            lever
        };
        let (sin_phi, cos_phi) = phi.sin_cos();
        let (sin_theta, cos_theta) = theta.sin_cos();
        let turn = self.condition.turn_rate;
        // Zero plus a product: without a turn the rates are 0, not -0.
        let zero = T::from(0.0);
        let state = State {
            speed: T::from(self.condition.speed),
            alpha,
            beta,
            phi,
            theta,
            psi: T::from(self.condition.heading),
            p: zero - sin_theta * turn,
            q: zero + sin_phi * cos_theta * turn,
            r: zero + cos_phi * cos_theta * turn,
            north: T::from(0.0),
            east: T::from(0.0),
            altitude: T::from(self.condition.altitude),
            power: self.aircraft.steady_power(throttle),
        };
        (state, Controls { throttle, elevator, aileron, rudder })
    }

    fn residuals<T: Scalar>(&self, z: &[T; UNKNOWNS]) -> [T; UNKNOWNS] {
        let (state, controls) = self.state_and_controls(z);
        let Motion { rates, specific_force, .. } = motion(self.aircraft, &state, &controls, &self.disturbance);
        // Specific force of the thrust that the engine does not have: zero within the throttle's range.
        let missing = z[4] - controls.throttle;
        let [ax, ay, az] = self.excess.map(|e| missing * e);
        let (sin_alpha, cos_alpha) = state.alpha.sin_cos();
        let (sin_beta, cos_beta) = state.beta.sin_cos();
        let in_plane = cos_alpha * ax + sin_alpha * az;
        let speed = self.condition.speed;
        let gravity = self.aircraft.gravity();
        [
            (rates.speed + in_plane * cos_beta + ay * sin_beta) / gravity,
            rates.alpha + (cos_alpha * az - sin_alpha * ax) / cos_beta / speed,
            rates.beta + (ay * cos_beta - in_plane * sin_beta) / speed,
            rates.p,
            rates.q,
            rates.r,
            rates.altitude / speed - Scalar::sin_cos(self.condition.flight_path_angle).0,
            (specific_force[1] + ay) / gravity,
        ]
    }

    /// Unknowns to start from with an angle of attack, rad: the bank of a coordinated turn, a little throttle.
    fn start(&self, alpha: f64) -> [f64; UNKNOWNS] {
        let condition = self.condition;
        let path = condition.flight_path_angle;
        let bank = (condition.turn_rate * condition.speed * path.cos() / self.aircraft.gravity()).atan();
        [alpha, 0.0, bank, path + alpha * bank.cos(), 0.3, 0.0, 0.0, 0.0]
    }

    /// Levenberg-Marquardt (D. W. Marquardt, J. SIAM 11 (1963) 431), each step a least-squares problem solved by QR.
    /// `visit` is told the unknowns and their residuals at the start and after each iteration.
    fn solve(&self, start: [f64; UNKNOWNS], visit: &mut dyn FnMut(&[f64; UNKNOWNS], &[f64; UNKNOWNS])) -> Solution {
        const MOST_ITERATIONS: usize = 200;
        let mut z = start;
        let mut damping = 1e-3;
        let mut solution = Solution { unknowns: z, residuals: self.residuals(&z), iterations: 0 };
        let square = |r: &[f64; UNKNOWNS]| r.iter().map(|v| v * v).sum::<f64>();
        visit(&solution.unknowns, &solution.residuals);
        while solution.iterations < MOST_ITERATIONS && damping < 1e12 && solution.largest() > 1e-15 {
            solution.iterations += 1;
            let duals = self.residuals::<Dual<UNKNOWNS>>(&core::array::from_fn(|i| Dual::variable(z[i], i)));
            let mut augmented = SMatrix::<f64, { 2 * UNKNOWNS }, UNKNOWNS>::zeros();
            let mut right = SVector::<f64, { 2 * UNKNOWNS }>::zeros();
            for i in 0..UNKNOWNS {
                for j in 0..UNKNOWNS {
                    augmented[(i, j)] = duals[i].derivatives[j];
                }
                augmented[(UNKNOWNS + i, i)] = f64::sqrt(damping);
                right[i] = -duals[i].value;
            }
            let qr = augmented.qr();
            qr.q_tr_mul(&mut right);
            let top = right.fixed_rows::<UNKNOWNS>(0).into_owned();
            let Some(step) = qr.r().solve_upper_triangular(&top) else { break };
            let trial = core::array::from_fn(|i| z[i] + step[i]);
            let residuals = self.residuals(&trial);
            if square(&residuals) < square(&solution.residuals) && trial[0].abs() < 1.5 && trial[1].abs() < 1.5 {
                z = trial;
                solution.unknowns = trial;
                solution.residuals = residuals;
                damping = (0.1 * damping).max(1e-18);
            } else if solution.largest() < TOLERANCE {
                break;
            } else {
                damping *= 10.0;
            }
            visit(&solution.unknowns, &solution.residuals);
        }
        solution
    }

    /// Which limit an equilibrium violates, and how badly: the excess over the limit in its own measure.
    fn refusal(&self, solution: &Solution) -> Option<(f64, TrimError)> {
        let [alpha_rad, _, phi, _, lever, elevator, aileron, rudder] = solution.unknowns;
        let [lowest_rad, highest_rad] = self.condition.alpha_range;
        if !(lowest_rad..=highest_rad).contains(&alpha_rad) {
            let excess = (alpha_rad - highest_rad).max(lowest_rad - alpha_rad);
            return Some((excess, TrimError::OutsideData { alpha_rad, lowest_rad, highest_rad }));
        }
        let (state, _) = self.state_and_controls(&solution.unknowns);
        let engine = self.thrust(&state);
        let beyond = lever - lever.clamp(0.0, 1.0);
        let needed_n = engine + self.aircraft.mass_properties().mass() * norm(self.excess) * beyond;
        if beyond > 0.0 {
            return Some((beyond, TrimError::NotEnoughThrust { needed_n, available_n: engine, alpha_rad }));
        }
        if beyond < 0.0 {
            return Some((-beyond, TrimError::TooMuchThrust { needed_n, idle_n: engine, alpha_rad }));
        }
        let actuators = self.aircraft.actuators();
        for (surface, needed_rad, limit_rad) in [
            ("elevator", elevator, actuators.elevator.limit),
            ("aileron", aileron, actuators.aileron.limit),
            ("rudder", rudder, actuators.rudder.limit),
        ] {
            if needed_rad.abs() > limit_rad {
                let excess = needed_rad.abs() / limit_rad - 1.0;
                return Some((excess, TrimError::SurfaceLimit { surface, needed_rad, limit_rad, alpha_rad }));
            }
        }
        // An equilibrium on its back is none of those asked for.
        let inverted = phi.abs() > core::f64::consts::FRAC_PI_2;
        let equation = "upright flight: bank angle beyond 90 deg, rad";
        let starts = STARTS_DEG.len();
        inverted.then_some((f64::INFINITY, TrimError::NoConvergence { starts, equation, residual: phi, alpha_rad }))
    }

    /// Whether the flight path is out of reach of lift and thrust together.
    fn not_enough_lift(&self) -> Option<TrimError> {
        let TrimCondition { speed, turn_rate, flight_path_angle: path, alpha_range: [low, high], .. } = *self.condition;
        let gravity = self.aircraft.gravity();
        // Across the path the aircraft is carried against gravity and turned with V cos(gamma).
        let needed = path.cos() * (turn_rate * speed / gravity).hypot(1.0);
        let load = |alpha: f64| {
            let unknowns = [alpha, 0.0, 0.0, path + alpha, 1.0, 0.0, 0.0, 0.0];
            let (state, controls) = self.state_and_controls(&unknowns);
            let [ax, _, az] = motion(self.aircraft, &state, &controls, &self.disturbance).specific_force;
            (alpha.sin() * ax - alpha.cos() * az) / gravity
        };
        let scan = (0..=100).map(|i| low + (high - low) * f64::from(i) / 100.0).map(|alpha| (load(alpha), alpha));
        let (available, alpha_rad) = scan.fold((f64::NEG_INFINITY, f64::NAN), |a, b| if b.0 > a.0 { b } else { a });
        (available < needed).then_some(TrimError::NotEnoughLift { needed, available, alpha_rad })
    }

    fn thrust(&self, state: &State) -> f64 {
        let mach = state.speed / self.aircraft.atmosphere().at(state.altitude).speed_of_sound;
        let force = self.aircraft.propulsion(state.power, state.altitude, mach).force;
        norm(force).copysign(force[0])
    }

    fn report(&self, solution: &Solution) -> Trim {
        let (state, controls) = self.state_and_controls(&solution.unknowns);
        let Motion { rates, air, specific_force, .. } = motion(self.aircraft, &state, &controls, &self.disturbance);
        Trim {
            speed_m_s: state.speed,
            altitude_m: state.altitude,
            flight_path_angle_rad: self.condition.flight_path_angle,
            turn_rate_rad_s: self.condition.turn_rate,
            alpha_rad: state.alpha,
            beta_rad: state.beta,
            phi_rad: state.phi,
            theta_rad: state.theta,
            psi_rad: state.psi,
            p_rad_s: state.p,
            q_rad_s: state.q,
            r_rad_s: state.r,
            throttle: controls.throttle,
            elevator_rad: controls.elevator,
            aileron_rad: controls.aileron,
            rudder_rad: controls.rudder,
            power_percent: state.power,
            thrust_n: self.thrust(&state),
            dynamic_pressure_pa: air.dynamic_pressure,
            mach: air.mach,
            load_factor: -specific_force[2] / self.aircraft.gravity(),
            trim_index: [rates.speed, rates.alpha, rates.beta, rates.p, rates.q, rates.r]
                .iter()
                .map(|rate| rate * rate)
                .sum(),
            largest_residual: solution.largest(),
            iterations: solution.iterations,
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
