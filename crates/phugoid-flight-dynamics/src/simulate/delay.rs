//! Commands on their way to actuators that get them late.

use std::collections::VecDeque;

use crate::actuator::{ACTUATOR_STATES, Actuators};
use crate::aircraft::Controls;

/// Commands to the surfaces, kept for as long as an actuator still has to get them.
#[derive(Clone, Debug)]
pub(super) struct Delay {
    /// Before the first command, rad.
    start: [f64; ACTUATOR_STATES],
    /// When a command begins, s, and what it is, rad; each holds until the next.
    commands: VecDeque<(f64, [f64; ACTUATOR_STATES])>,
}

impl Delay {
    /// Surfaces that were commanded to be where they are for ever.
    pub(super) fn new(start: [f64; ACTUATOR_STATES]) -> Self {
        Self { start, commands: VecDeque::new() }
    }

    /// What actuators are told over the step (s) that begins at `time` (s), when `command` holds from then on: the mean over the
    /// step of what they get, so that a delay need not be a multiple of the step. The lever has no delay.
    pub(super) fn delayed(&mut self, actuators: &Actuators, command: Controls, time: f64, step: f64) -> Controls {
        // A delay that is not a positive number is none.
        let delays = actuators.each().map(|actuator| if actuator.delay > 0.0 { actuator.delay } else { 0.0 });
        let longest = delays.into_iter().fold(0.0, f64::max);
        if longest == 0.0 {
            self.commands.clear();
            self.start = [command.elevator, command.aileron, command.rudder];
            return command;
        }
        self.commands.push_back((time, [command.elevator, command.aileron, command.rudder]));
        // All but the last that began before anything that is still to come.
        while self.commands.get(1).is_some_and(|(begins, _)| *begins <= time - longest) {
            if let Some((_, old)) = self.commands.pop_front() {
                self.start = old;
            }
        }
        let told = |i: usize| {
            if delays[i] == 0.0 {
                return [command.elevator, command.aileron, command.rudder][i];
            }
            self.mean(i, time - delays[i], step)
        };
        Controls { throttle: command.throttle, elevator: told(0), aileron: told(1), rudder: told(2) }
    }

    /// Mean of the command to a surface from a time (s) on, over a step (s).
    fn mean(&self, surface: usize, from: f64, step: f64) -> f64 {
        let (mut value, mut since, mut sum) = (self.start[surface], from, 0.0);
        for (begins, commands) in &self.commands {
            let begins = begins.clamp(from, from + step);
            sum += value * (begins - since);
            (value, since) = (commands[surface], begins);
        }
        (sum + value * (from + step - since)) / step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::Actuator;

    /// A step of the command at 0.1 s, a delay of 0.025 s and steps of 0.01 s: nothing until 0.12 s, half in the step that begins
    /// there, all from 0.13 s on.
    #[test]
    fn a_delay_between_two_steps_is_met_in_the_mean() {
        let late = Actuator { delay: 0.025, ..Actuator::new(1.0, 10.0, 0.05) };
        let actuators = Actuators { elevator: late, aileron: Actuator::new(1.0, 10.0, 0.05), rudder: late };
        let mut delay = Delay::new([0.2, 0.0, 0.0]);
        for k in 0..40 {
            let time = 0.01 * f64::from(k);
            let on = if k >= 10 { 1.0 } else { 0.0 };
            let command = Controls { throttle: 0.5, elevator: 0.2 + on, aileron: on, rudder: -on };
            let told = delay.delayed(&actuators, command, time, 0.01);
            let late = match k {
                ..12 => 0.0,
                12 => 0.5,
                _ => 1.0,
            };
            assert!((told.elevator - 0.2 - late).abs() < 1e-12, "{k} {told:?}");
            assert!((told.rudder + late).abs() < 1e-12 && told.aileron == on && told.throttle == 0.5, "{k} {told:?}");
            assert!(delay.commands.len() < 6);
        }
    }
}
