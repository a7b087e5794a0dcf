//! Equations of motion and their integration in time.

use core::fmt;

use super::attitude::Quaternion;
use super::condition::{Condition, GlobeState, World};
use super::loads::{ForcesAndMoments, Loads};
use super::vector::{Vector, add, apply_transposed, scale};

/// What the equations of motion give at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobeMotion<const X: usize = 0> {
    /// The condition, with the rates of angle of attack and sideslip that the loads cause.
    pub condition: Condition<X>,
    /// Forces and moments on the vehicle.
    pub loads: ForcesAndMoments,
    /// Force without gravity over mass, body axes, m/s^2: what accelerometers at the centre of gravity feel.
    pub specific_force: Vector,
    /// Inertial acceleration of the centre of gravity, m/s^2, inertial components.
    pub acceleration: Vector,
    /// Rates of the body rates, rad/s^2, body axes.
    pub angular_acceleration: Vector,
    /// Rates of the vehicle's own states, each in its unit per second.
    pub internal_rates: [f64; X],
}

/// Equations of motion of a rigid body (Stevens, Lewis and Johnson 1.7-18) at a time (s).
///
/// Where the vehicle [uses the rates](Loads::uses_angle_rates) of angle of attack and sideslip, these and the
/// accelerations are solved together: the loads are made linear in both rates by differences, which is exact for the
/// usual derivatives such as `C_m alphadot`, and the linear equation is solved; up to five times for loads that are not
/// linear in them.
pub fn motion<const X: usize, L: Loads<X> + ?Sized>(
    world: &World,
    vehicle: &mut L,
    time: f64,
    state: &GlobeState<X>,
) -> GlobeMotion<X> {
    let mut condition = Condition::of(world, time, state);
    let mass = vehicle.mass_properties(&condition);
    let inverse_mass = mass.inverse_mass();
    if vehicle.uses_angle_rates() {
        condition.angle_rates = solve_angle_rates(world, vehicle, &condition, inverse_mass);
    }
    let loads = vehicle.loads(&condition);
    let specific_force = scale(loads.force(), inverse_mass);
    if !vehicle.uses_angle_rates() {
        condition.angle_rates = condition.angle_rates_of(world, specific_force);
    }
    GlobeMotion {
        condition,
        loads,
        specific_force,
        acceleration: add(condition.gravitation, apply_transposed(&condition.body_from_inertial, specific_force)),
        angular_acceleration: mass.angular_acceleration(state.rates, loads.moment()),
        internal_rates: vehicle.internal_rates(&condition),
    }
}

/// Step of the differences by which loads are made linear in the rates, rad/s.
const RATE_STEP: f64 = 0.01;

fn solve_angle_rates<const X: usize, L: Loads<X> + ?Sized>(
    world: &World,
    vehicle: &mut L,
    condition: &Condition<X>,
    inverse_mass: f64,
) -> [f64; 2] {
    let mut caused = |rates: [f64; 2]| {
        let force = vehicle.loads(&Condition { angle_rates: rates, ..*condition }).force();
        condition.angle_rates_of(world, scale(force, inverse_mass))
    };
    let mut rates = [0.0; 2];
    for _ in 0..5 {
        let here = caused(rates);
        let by_alpha = caused([rates[0] + RATE_STEP, rates[1]]);
        let by_beta = caused([rates[0], rates[1] + RATE_STEP]);
        // (I - G) step = caused - rates
        let a = 1.0 - (by_alpha[0] - here[0]) / RATE_STEP;
        let b = -(by_beta[0] - here[0]) / RATE_STEP;
        let c = -(by_alpha[1] - here[1]) / RATE_STEP;
        let d = 1.0 - (by_beta[1] - here[1]) / RATE_STEP;
        let (x, y) = (here[0] - rates[0], here[1] - rates[1]);
        let determinant = a * d - b * c;
        let step = [(d * x - b * y) / determinant, (a * y - c * x) / determinant];
        rates = [rates[0] + step[0], rates[1] + step[1]];
        let size = 1.0 + rates[0].abs() + rates[1].abs();
        // What is left after a step of a linear problem is rounding; `caused` contracts it further.
        let left = caused(rates);
        if (left[0] - rates[0]).abs() + (left[1] - rates[1]).abs() <= 1e-12 * size {
            break;
        }
    }
    rates
}

/// Why a flight ended early.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FlightError {
    /// Duration or step are not finite, the duration is negative, or the step is not positive.
    Interval,
    /// The state is no longer finite at this time, s.
    NotFinite {
        /// End of the step in which it happened, s.
        time: f64,
    },
}

impl fmt::Display for FlightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interval => f.write_str("the duration must not be negative and the step must be positive"),
            Self::NotFinite { time } => write!(f, "the motion is no longer finite {time} s into the flight"),
        }
    }
}

impl core::error::Error for FlightError {}

/// How the motion is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integration {
    /// Classical Runge-Kutta of order four: the loads are asked four times in a step.
    #[default]
    RungeKutta4,
    /// Adams-Bashforth of order two, `x + h (3/2 f - 1/2 f before)`, as the simulators that fly in real time have it, JSBSim among
    /// them: the loads are asked once in a step. The first step is one of Runge-Kutta. What switches on at a step counts one
    /// and a half times in it, and so acts half a step early.
    AdamsBashforth2,
}

/// Flies a vehicle for a duration (s) from a state at a time (s) and gives the state at the end.
///
/// Classical Runge-Kutta steps of order four and equal length (s); the last one is shorter where the duration is no
/// multiple. The quaternion is brought back to length one after each step. `observe` is called at the start, after every
/// step and so at the end, each time after [`Loads::update`].
///
/// ```
/// use phugoid_flight_dynamics::globe::attitude::EulerAngles;
/// use phugoid_flight_dynamics::globe::condition::{InitialRates, Launch, World};
/// use phugoid_flight_dynamics::globe::flight::fly;
/// use phugoid_flight_dynamics::globe::loads::BluntBody;
/// use phugoid_flight_dynamics::globe::planet::{Geodetic, Planet};
/// use phugoid_flight_dynamics::mass::MassProperties;
///
/// // A sphere of a slug falls from 30,000 ft over the equator: check case 6 of NASA/TM-2015-218675.
/// let inertia = [[4.881, 0.0, 0.0], [0.0, 4.881, 0.0], [0.0, 0.0, 4.881]];
/// let mass = MassProperties::from_tensor(14.5939, inertia, 0.0).ok_or("impossible inertia")?;
/// let mut ball = BluntBody { mass, area: 0.018241, span: 1.0, chord: 1.0, drag: 0.1, damping: [0.0; 3] };
/// let world = World::new(Planet::WGS84);
/// let launch = Launch {
///     place: Geodetic { altitude: 9144.0, ..Geodetic::default() },
///     velocity: [0.0; 3],
///     euler: EulerAngles::default(),
///     rates: InitialRates::Inertial([0.0; 3]),
/// };
/// let mut altitude = 0.0;
/// fly(&world, &mut ball, launch.state(&world.planet, 0.0, []), 0.0, 30.0, 0.1, |motion| {
///     altitude = motion.condition.place.altitude;
/// })?;
/// assert!((altitude / 0.3048 - 16_284.0).abs() < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`FlightError`] if the interval is unusable, or the motion is no longer finite, as after a load that is NaN.
pub fn fly<const X: usize, L: Loads<X> + ?Sized>(
    world: &World,
    vehicle: &mut L,
    start: GlobeState<X>,
    time: f64,
    duration: f64,
    step: f64,
    observe: impl FnMut(&GlobeMotion<X>),
) -> Result<GlobeState<X>, FlightError> {
    fly_by(Integration::RungeKutta4, world, vehicle, start, [time, duration, step], observe)
}

/// As [`fly`], by another integration; time, duration and step stand together, s.
///
/// # Errors
/// As [`fly`].
pub fn fly_by<const X: usize, L: Loads<X> + ?Sized>(
    integration: Integration,
    world: &World,
    vehicle: &mut L,
    start: GlobeState<X>,
    [time, duration, step]: [f64; 3],
    mut observe: impl FnMut(&GlobeMotion<X>),
) -> Result<GlobeState<X>, FlightError> {
    let sound = time.is_finite() && duration.is_finite() && duration >= 0.0 && step.is_finite() && step > 0.0;
    let whole = duration / step;
    if !sound || whole >= 1e15 {
        return Err(FlightError::Interval);
    }
    // A duration that is a multiple but for rounding gets no step of 1e-13 s at its end.
    let mut steps = whole as u64;
    if whole - steps as f64 > 1e-6 {
        steps += 1;
    }
    let instant = |i: u64| if i == steps { time + duration } else { time + i as f64 * step };
    let mut state = start;
    let mut before: Option<Rates<X>> = None;
    for i in 0..=steps {
        let now = instant(i);
        vehicle.update(&Condition::of(world, now, &state));
        let first = motion(world, vehicle, now, &state);
        observe(&first);
        if i == steps {
            break;
        }
        let h = instant(i + 1) - now;
        let k1 = Rates::of(&first);
        let mean = match (integration, &before) {
            (Integration::AdamsBashforth2, Some(before)) => k1.extrapolated(before),
            _ => {
                let k2 = Rates::of(&motion(world, vehicle, now + 0.5 * h, &k1.after(&state, 0.5 * h)));
                let k3 = Rates::of(&motion(world, vehicle, now + 0.5 * h, &k2.after(&state, 0.5 * h)));
                let k4 = Rates::of(&motion(world, vehicle, now + h, &k3.after(&state, h)));
                k1.mean(&k2, &k3, &k4)
            }
        };
        before = Some(k1);
        state = mean.after(&state, h);
        state.attitude = state.attitude.normalised();
        if !is_finite(&state) {
            return Err(FlightError::NotFinite { time: now + h });
        }
    }
    Ok(state)
}

fn is_finite<const X: usize>(state: &GlobeState<X>) -> bool {
    let GlobeState { position, velocity, attitude, rates, internal } = state;
    let parts = position.iter().chain(velocity).chain(&attitude.parts).chain(rates).chain(internal);
    parts.into_iter().all(|x| x.is_finite())
}

/// Time derivative of a state.
struct Rates<const X: usize> {
    velocity: Vector,
    acceleration: Vector,
    attitude: [f64; 4],
    angular_acceleration: Vector,
    internal: [f64; X],
}

impl<const X: usize> Rates<X> {
    fn of(motion: &GlobeMotion<X>) -> Self {
        let state = &motion.condition.state;
        Self {
            velocity: state.velocity,
            acceleration: motion.acceleration,
            attitude: state.attitude.rate(state.rates),
            angular_acceleration: motion.angular_acceleration,
            internal: motion.internal_rates,
        }
    }

    /// The state that these rates lead to in a time `h`.
    fn after(&self, state: &GlobeState<X>, h: f64) -> GlobeState<X> {
        GlobeState {
            position: moved(state.position, self.velocity, h),
            velocity: moved(state.velocity, self.acceleration, h),
            attitude: Quaternion { parts: moved(state.attitude.parts, self.attitude, h) },
            rates: moved(state.rates, self.angular_acceleration, h),
            internal: moved(state.internal, self.internal, h),
        }
    }

    /// The rates in the middle of the next step, from those at its beginning and one step before.
    fn extrapolated(&self, before: &Self) -> Self {
        Self {
            velocity: ahead(self.velocity, before.velocity),
            acceleration: ahead(self.acceleration, before.acceleration),
            attitude: ahead(self.attitude, before.attitude),
            angular_acceleration: ahead(self.angular_acceleration, before.angular_acceleration),
            internal: ahead(self.internal, before.internal),
        }
    }

    /// Weights of the classical Runge-Kutta step, as in [`crate::integrate::rk4_step`].
    fn mean(&self, k2: &Self, k3: &Self, k4: &Self) -> Self {
        Self {
            velocity: weighted(self.velocity, k2.velocity, k3.velocity, k4.velocity),
            acceleration: weighted(self.acceleration, k2.acceleration, k3.acceleration, k4.acceleration),
            attitude: weighted(self.attitude, k2.attitude, k3.attitude, k4.attitude),
            angular_acceleration: weighted(
                self.angular_acceleration,
                k2.angular_acceleration,
                k3.angular_acceleration,
                k4.angular_acceleration,
            ),
            internal: weighted(self.internal, k2.internal, k3.internal, k4.internal),
        }
    }
}

fn moved<const N: usize>(x: [f64; N], rate: [f64; N], h: f64) -> [f64; N] {
    core::array::from_fn(|i| x[i] + h * rate[i])
}

fn ahead<const N: usize>(now: [f64; N], before: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| 1.5 * now[i] - 0.5 * before[i])
}

fn weighted<const N: usize>(a: [f64; N], b: [f64; N], c: [f64; N], d: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0)
}
