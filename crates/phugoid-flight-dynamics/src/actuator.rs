//! Surface actuators: first-order lag with rate and position limits, delay and play.

use crate::aircraft::Controls;

/// One actuator: `position' = clamp((clamp(command) - position) / lag, +-rate limit)`
/// (Stevens & Lewis appendix A.4: a lag of 20.2 1/s behind rate and deflection limits).
///
/// The command may come late, and the surface may hang in its linkage with play. Both are zero in [`Actuator::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator {
    /// Largest deflection to either side, rad.
    pub limit: f64,
    /// Largest rate of the surface to either side, rad/s.
    pub rate_limit: f64,
    /// Time constant of the lag, s.
    pub lag: f64,
    /// Time by which the actuator gets its command late, s: a computer or a bus.
    pub delay: f64,
    /// Play between actuator and surface, rad, from one side to the other: the surface stays where it is until the actuator has
    /// gone through it, and then trails by half of it.
    pub play: f64,
}

impl Actuator {
    /// The longest delay that files may give an actuator, s: no aircraft is flown with a longer one, and it is seconds in place of
    /// milliseconds.
    pub const LONGEST_DELAY: f64 = 1.0;

    /// An actuator without delay and play: limit (rad), rate limit (rad/s) and lag (s).
    pub const fn new(limit: f64, rate_limit: f64, lag: f64) -> Self {
        Self { limit, rate_limit, lag, delay: 0.0, play: 0.0 }
    }

    /// Where the surface is when the actuator is at `position` and the surface was at `before`, rad: as before, unless the actuator
    /// pushes it (backlash with friction, e.g. G. Tao and P. V. Kokotovic, *Adaptive Control of Systems with Actuator and Sensor
    /// Nonlinearities*, Wiley 1996, ch. 2). A play that is not a positive number is none.
    #[inline]
    pub fn surface(&self, position: f64, before: f64) -> f64 {
        if self.play > 0.0 {
            let half = 0.5 * self.play;
            if before < position - half {
                return position - half;
            }
            if before > position + half {
                return position + half;
            }
            return before;
        }
        position
    }

    /// The command that the actuator can follow: within the deflection limits, rad.
    #[inline]
    pub fn reachable(&self, command: f64) -> f64 {
        within(command, self.limit)
    }

    /// Rate of the surface, rad/s, from the commanded and the present position (rad).
    ///
    /// The position never passes its limit: the command is limited before the lag, and the lag does not overshoot.
    #[inline]
    pub fn rate(&self, command: f64, position: f64) -> f64 {
        within((self.reachable(command) - position) / self.lag, self.rate_limit)
    }
}

/// `f64::clamp` to either side without its panic: limits are public, and one that is not a number limits nothing.
#[inline]
fn within(value: f64, limit: f64) -> f64 {
    let mut value = value;
    if value < -limit {
        value = -limit;
    }
    if value > limit {
        value = limit;
    }
    value
}

/// The actuators of elevator, aileron and rudder. The throttle lever has none: the engine's own lag follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuators {
    /// The elevator's; positive deflections have the trailing edge down.
    pub elevator: Actuator,
    /// The ailerons'; positive deflections roll to the left.
    pub aileron: Actuator,
    /// The rudder's; positive deflections yaw to the left.
    pub rudder: Actuator,
}

/// Number of actuator states: elevator, aileron, rudder.
pub const ACTUATOR_STATES: usize = 3;

impl Actuators {
    /// Rates `[elevator, aileron, rudder]`, rad/s, of the surface positions in the same order (rad): three more states
    /// to integrate beside those of the aircraft.
    #[inline]
    pub fn rates(&self, commands: &Controls, positions: [f64; ACTUATOR_STATES]) -> [f64; ACTUATOR_STATES] {
        [
            self.elevator.rate(commands.elevator, positions[0]),
            self.aileron.rate(commands.aileron, positions[1]),
            self.rudder.rate(commands.rudder, positions[2]),
        ]
    }

    /// Elevator, aileron and rudder.
    pub fn each(&self) -> [&Actuator; ACTUATOR_STATES] {
        [&self.elevator, &self.aileron, &self.rudder]
    }

    /// Where the surfaces are when the actuators are at `positions` and the surfaces were at `before`, rad.
    #[inline]
    pub fn surfaces(
        &self,
        positions: [f64; ACTUATOR_STATES],
        before: [f64; ACTUATOR_STATES],
    ) -> [f64; ACTUATOR_STATES] {
        let each = self.each();
        core::array::from_fn(|i| each[i].surface(positions[i], before[i]))
    }

    /// The controls that the aircraft feels: the lever as commanded, the surfaces where they are.
    #[inline]
    pub fn controls(&self, commands: &Controls, positions: [f64; ACTUATOR_STATES]) -> Controls {
        Controls { throttle: commands.throttle, elevator: positions[0], aileron: positions[1], rudder: positions[2] }
    }

    /// Commands within the deflection limits and the lever within 0 to 1.
    #[inline]
    pub fn reachable(&self, commands: &Controls) -> Controls {
        Controls {
            throttle: commands.throttle.clamp(0.0, 1.0),
            elevator: self.elevator.reachable(commands.elevator),
            aileron: self.aileron.reachable(commands.aileron),
            rudder: self.rudder.reachable(commands.rudder),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: f64 = core::f64::consts::PI / 180.0;
    const ELEVATOR: Actuator = Actuator::new(25.0 * DEGREE, 60.0 * DEGREE, 0.0495);

    /// A step flown with small Euler steps; the time constant is long against them.
    fn follow(command: f64, seconds: f64) -> (f64, f64) {
        let (mut position, mut fastest, step) = (0.0, 0.0_f64, 1e-5);
        for _ in 0..(seconds / step) as usize {
            let rate = ELEVATOR.rate(command, position);
            fastest = fastest.max(rate.abs());
            position += step * rate;
        }
        (position, fastest)
    }

    #[test]
    fn a_small_step_is_a_first_order_lag() {
        let step = 0.02; // 1.15 deg: initial rate 0.4 rad/s, below the limit
        let (position, _) = follow(step, ELEVATOR.lag);
        assert!((position / step - (1.0 - (-1.0_f64).exp())).abs() < 2e-4, "{position}");
    }

    #[test]
    fn a_large_step_is_rate_limited_and_stops_at_the_stop() {
        let (position, fastest) = follow(1.0, 0.2);
        assert!((fastest - ELEVATOR.rate_limit).abs() < 1e-12);
        assert!((position - 0.2 * ELEVATOR.rate_limit).abs() < 1e-4, "{position}");
        let (position, _) = follow(1.0, 2.0);
        assert!(position <= ELEVATOR.limit && ELEVATOR.limit - position < 1e-6, "{position}");
    }

    /// Play of 2 deg: a surface in the middle waits for 1 deg, follows 1 deg behind, and waits for 2 deg when it goes back.
    #[test]
    fn play_holds_the_surface_until_it_is_pushed() {
        let linkage = Actuator { play: 2.0 * DEGREE, ..ELEVATOR };
        let mut at = 0.0;
        let expected = [(0.5, 0.0), (1.0, 0.0), (3.0, 2.0), (2.0, 2.0), (1.0, 2.0), (0.0, 1.0), (-4.0, -3.0)];
        for (position, surface) in expected.map(|(a, b)| (a * DEGREE, b * DEGREE)) {
            at = linkage.surface(position, at);
            assert!((at - surface).abs() < 1e-15, "{position} {at} {surface}");
        }
        for play in [0.0, -1.0, f64::NAN] {
            assert_eq!(Actuator { play, ..ELEVATOR }.surface(0.3, 0.1), 0.3);
        }
    }

    /// Limits are public: those that are in the wrong order, or no numbers, must not stop a flight computer.
    #[test]
    fn impossible_limits_give_a_number_and_no_panic() {
        let with = |limit: f64| Actuator { limit, rate_limit: limit, ..ELEVATOR };
        assert_eq!(with(-1.0).reachable(0.3), -1.0);
        assert_eq!(with(f64::NAN).reachable(0.3), 0.3);
        assert!(with(f64::NAN).rate(0.3, 0.0).is_finite());
        assert!(with(-1.0).rate(0.3, 0.0).is_finite());
    }
}
