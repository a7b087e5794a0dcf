//! Flights in which the aircraft becomes another one: damage, a store that is dropped.

use super::{Instant, Simulation, SimulationError, Trajectory};
use crate::aircraft::{Aircraft, Controls, State};
use crate::gust::AirMotion;

impl<A: Aircraft> Simulation<'_, A> {
    /// As [`run`](Self::run), with the aircraft `after` from the time `at` (s) on. `moved` gives the state of the new aircraft
    /// from that of the old one in the same motion: they differ where the centre of gravity has moved in the body.
    ///
    /// The time is rounded to the grid of the samples. The sample at that time is the first of the new aircraft; a time beyond
    /// the end (or none, NaN) leaves the aircraft as it is, one before the start gives the new one from the beginning. Engine
    /// state and surface positions are those of the instant before.
    ///
    /// # Errors
    /// [`SimulationError`] when the times make no grid or the motion diverges; its time counts from the start of the flight.
    pub fn run_changed<B: Aircraft, W: Into<AirMotion>>(
        &self,
        after: &B,
        at: f64,
        moved: impl FnOnce(&State) -> State,
        mut commands: impl FnMut(f64) -> Controls,
        mut gust: impl FnMut(f64) -> W,
    ) -> Result<Trajectory, SimulationError> {
        let (intervals, mut stepper) = self.start()?;
        // A time that is none is reached by no sample.
        let sample = (at / self.sample_time).round().max(0.0);
        let changes_at = if at.is_nan() || sample > intervals as f64 { None } else { Some(sample as usize) };
        let mut moved = Some(moved);
        let mut samples = Vec::with_capacity(intervals + 1);
        for k in 0..=intervals {
            let changed = changes_at.is_some_and(|at| k >= at);
            if changed && let Some(moved) = moved.take() {
                stepper.set_state(&moved(&stepper.state()));
            }
            let time = stepper.time();
            let command = commands(time);
            let now = Instant { commands: command, air: gust(time).into(), increments: self.increments.at(time) };
            samples.push(if changed { stepper.sample(after, &now) } else { stepper.sample(self.aircraft, &now) });
            if k < intervals {
                let air = |t: f64| gust(t).into();
                let (again, increments) = (|t: f64, _: &State| commands(t), |t: f64| self.increments.at(t));
                if changed {
                    stepper.advance(after, command, again, air, increments)?;
                } else {
                    stepper.advance(self.aircraft, command, again, air, increments)?;
                }
            }
        }
        Ok(Trajectory { samples })
    }
}
