//! Flights in which the aircraft becomes another one: damage, a store that is dropped.

use super::{Simulation, SimulationError, Trajectory, grid_time};
use crate::aircraft::{Aircraft, Controls, State};
use crate::gust::AirMotion;
use crate::increments::{IncrementChange, IncrementSchedule};

impl<A: Aircraft> Simulation<'_, A> {
    /// As [`run`](Self::run), with the aircraft `after` from the time `at` (s) on. `moved` gives the state of the new aircraft
    /// from that of the old one in the same motion: they differ where the centre of gravity has moved in the body.
    ///
    /// The commands and the motion of the air are functions of the time since the start. The time is rounded to the grid of the
    /// samples. The sample at that time is the first of the new aircraft; a time beyond the end (or none, NaN) leaves the
    /// aircraft as it is, one before the start gives the new one from the beginning. Engine state and surface positions are
    /// those of the instant before.
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
        let Simulation { duration, sample_time, .. } = *self;
        let sample = (at / sample_time).round().max(0.0);
        let begin = sample * sample_time;
        if at.is_nan() || begin > duration || !(sample.is_finite() && sample_time > 0.0) {
            return self.run(commands, gust);
        }
        let mut flight = self.part(self.aircraft, self.increments.clone(), begin).run(&mut commands, &mut gust)?;
        let Some(last) = flight.samples.pop() else { return Ok(flight) };
        // The grid of the whole flight has the same times as that of a flight without the change.
        let grid = |k: f64| grid_time(k.max(0.0) as usize, sample_time);
        let on_sample = |time: f64| {
            let k = (time / sample_time).round();
            ((k * sample_time - time).abs() < 1e-6 * sample_time).then_some(k)
        };
        let since_start = |time: f64| on_sample(time).map_or(grid(sample) + time, |k| grid(sample + k));
        let increments = from_then_on(&self.increments, grid(sample), |time| on_sample(time).map_or(time, grid));
        let rest = Simulation {
            initial: moved(&last.state),
            initial_surfaces: last.surfaces,
            ..self.part(after, increments, duration - begin)
        };
        let rest =
            rest.run(|time| commands(since_start(time)), |time| gust(since_start(time))).map_err(
                |error| match error {
                    SimulationError::NotFinite { state, time, last_speed } => {
                        SimulationError::NotFinite { state, time: since_start(time), last_speed }
                    }
                    other => other,
                },
            )?;
        flight.samples.extend(rest.samples.into_iter().map(|mut sample| {
            sample.time = since_start(sample.time);
            sample
        }));
        Ok(flight)
    }

    /// The same flight with another aircraft, other increments and another duration (s).
    fn part<'b, B>(&self, aircraft: &'b B, increments: IncrementSchedule, duration: f64) -> Simulation<'b, B> {
        let Self { initial, initial_surfaces, use_actuators, sample_time, substeps, hold, .. } = *self;
        Simulation {
            aircraft,
            initial,
            initial_surfaces,
            use_actuators,
            increments,
            duration,
            sample_time,
            substeps,
            hold,
        }
    }
}

/// Increments with times that count from another instant. A change on a sample stays on it whatever the rounding.
fn from_then_on(increments: &IncrementSchedule, begin: f64, grid: impl Fn(f64) -> f64) -> IncrementSchedule {
    let mut changes: Vec<IncrementChange> = Vec::new();
    for change in increments.changes() {
        let moved = IncrementChange { time: grid(change.time - begin), ..*change };
        // Two that rounding puts on one instant are the later one.
        changes.pop_if(|last| last.time >= moved.time);
        changes.push(moved);
    }
    IncrementSchedule::new(changes).unwrap_or_else(|_| IncrementSchedule::constant(increments.at(begin)))
}
