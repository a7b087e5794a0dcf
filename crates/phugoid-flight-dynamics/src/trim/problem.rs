//! The equations of steady flight as a root-finding problem, and its solver.

use nalgebra::{SMatrix, SVector};

use super::condition::{Trim, TrimCondition};
use super::error::TrimError;
use crate::aircraft::{Aircraft, Controls, State};
use crate::motion::{Disturbance, Motion, motion};
use crate::scalar::{Dual, Scalar};

pub(super) const UNKNOWNS: usize = 8;
/// Starts in angle of attack, deg: the attached-flow equilibrium is found before those beyond the stall.
pub(super) const STARTS_DEG: [f64; 8] = [3.0, 8.0, 14.0, 20.0, 27.0, 34.0, 40.0, 45.0];
/// Residual of an equilibrium. The equations are of order one and exact to some 1e-15.
pub(super) const TOLERANCE: f64 = 1e-11;

pub(super) struct Problem<'a, A> {
    aircraft: &'a A,
    condition: &'a TrimCondition,
    disturbance: Disturbance,
    /// Specific force per unit of throttle beyond its ends, along the full thrust.
    excess: [f64; 3],
    /// Whether the rudder moves anything: without it, nothing could make the side force vanish.
    has_rudder: bool,
    /// Whether sideslip, aileron or rudder makes a side force, a rolling or a yawing moment: without one, no turn is steered.
    moves_sideways: bool,
}

/// Where the solver has come to.
pub(super) struct Solution {
    /// alpha, beta, phi, theta, throttle (beyond its ends too), elevator, aileron, rudder.
    pub(super) unknowns: [f64; UNKNOWNS],
    pub(super) residuals: [f64; UNKNOWNS],
    iterations: usize,
}

impl Solution {
    pub(super) fn largest(&self) -> f64 {
        self.residuals.iter().fold(0.0, |m: f64, r| if r.is_nan() { f64::INFINITY } else { m.max(r.abs()) })
    }
}

impl<'a, A: Aircraft> Problem<'a, A> {
    pub(super) fn new(aircraft: &'a A, condition: &'a TrimCondition) -> Self {
        let mach = condition.speed / aircraft.atmosphere().at(condition.altitude).speed_of_sound;
        let force =
            |throttle: f64| aircraft.propulsion(aircraft.steady_power(throttle), condition.altitude, mach).force;
        let (full, idle) = (force(1.0), force(0.0));
        let inverse_mass = aircraft.mass_properties().inverse_mass();
        let excess = core::array::from_fn(|i| (full[i] - idle[i]) * inverse_mass);
        let disturbance = Disturbance { increments: condition.increments, ..Disturbance::default() };
        let mut problem = Self { aircraft, condition, disturbance, excess, has_rudder: true, moves_sideways: true };
        let start = problem.start(STARTS_DEG[0].to_radians());
        let moved = problem.residuals::<Dual<UNKNOWNS>>(&core::array::from_fn(|i| Dual::variable(start[i], i)));
        problem.has_rudder = moved.iter().any(|residual| residual.derivatives[UNKNOWNS - 1] != 0.0);
        // Roll and yaw acceleration, and the side force that is felt, by sideslip, aileron and rudder.
        let sideways = [3, 5, 7].into_iter().flat_map(|equation| [1, 6, 7].map(|by| moved[equation].derivatives[by]));
        problem.moves_sideways = sideways.into_iter().any(|slope| slope != 0.0);
        problem
    }

    /// A turn that is asked for of an aircraft that only flies straight ahead. The equations have a solution all the same: with
    /// no force across it, it would fall around the bend with sideslip.
    pub(super) fn no_turn(&self) -> Option<TrimError> {
        let turn_rate_rad_s = self.condition.turn_rate;
        (turn_rate_rad_s != 0.0 && !self.moves_sideways).then_some(TrimError::NoTurn { turn_rate_rad_s })
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
            if self.has_rudder { (specific_force[1] + ay) / gravity } else { controls.rudder },
        ]
    }

    /// Unknowns to start from with an angle of attack, rad: the bank of a coordinated turn, a little throttle.
    pub(super) fn start(&self, alpha: f64) -> [f64; UNKNOWNS] {
        let condition = self.condition;
        let path = condition.flight_path_angle;
        let bank = (condition.turn_rate * condition.speed * path.cos() / self.aircraft.gravity()).atan();
        [alpha, 0.0, bank, path + alpha * bank.cos(), 0.3, 0.0, 0.0, 0.0]
    }

    /// Levenberg-Marquardt (D. W. Marquardt, J. SIAM 11 (1963) 431), each step a least-squares problem solved by QR.
    /// `visit` is told the unknowns and their residuals at the start and after each iteration.
    pub(super) fn solve(
        &self,
        start: [f64; UNKNOWNS],
        visit: &mut dyn FnMut(&[f64; UNKNOWNS], &[f64; UNKNOWNS]),
    ) -> Solution {
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
    pub(super) fn refusal(&self, solution: &Solution) -> Option<(f64, TrimError)> {
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
        let [of_elevator, of_aileron, of_rudder] = self.aircraft.surface_stops();
        for (surface, needed_rad, [low, high]) in
            [("elevator", elevator, of_elevator), ("aileron", aileron, of_aileron), ("rudder", rudder, of_rudder)]
        {
            let (beyond, limit_rad) =
                if needed_rad < 0.0 { (needed_rad < low, -low) } else { (needed_rad > high, high) };
            if beyond {
                let excess = if limit_rad > 0.0 { needed_rad.abs() / limit_rad - 1.0 } else { f64::INFINITY };
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
    pub(super) fn not_enough_lift(&self) -> Option<TrimError> {
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
        self.aircraft.propulsion(state.power, state.altitude, mach).thrust()
    }

    pub(super) fn report(&self, solution: &Solution) -> Trim {
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
