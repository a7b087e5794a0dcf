//! Flight control that has taken over an aircraft.

use super::description::Control;
use super::rest::{Restless, come_to_rest};
use super::sensed::Sensed;
use crate::flown::error::FlownError;
use crate::flown::surface::NAMES;
use crate::jsbsim::Evaluator;

/// Longest time that channels are given to come to rest in the trim, s, and at one position of the stick.
const LONGEST_S: f64 = 120.0;
const LONGEST_AT_A_POSITION_S: f64 = 20.0;
/// Intervals of the stick from -1 to 1 in which the surfaces are looked at.
const INTERVALS: usize = 8;
/// How far the middle of an interval may be off a straight line, as a share of the travel over it and in rad; else it is halved, so
/// often at most.
const OFF_SHARE: f64 = 1e-3;
const OFF_LEAST: f64 = 1e-6;
const MOST_HALVINGS: u32 = 5;
/// Least travel of a surface with the stick from end to end, rad.
const LEAST_TRAVEL: f64 = 1e-4;

/// The flight control system of an aircraft's files in flight: systems, autopilots and flight control, run in steps.
///
/// It is asked in the manner of an open loop: for the angles where the surfaces would be. Of them it makes positions of the stick
/// and the pedals (`fcs/elevator-cmd-norm`, `fcs/aileron-cmd-norm`, `fcs/rudder-cmd-norm`, from -1 to 1), runs the channels with what
/// they sense, and says where they put the surfaces.
///
/// Which position of the stick an angle asks for is measured when flight control takes over: the channels, with the flight held
/// in its trim, are let come to rest at positions from -1 to 1 that are close enough for straight lines in between. So
/// without feedback the surface moves by the angle that is asked for, whatever scales, gains and schedules lie between; feedback
/// adds to it. In the trim the stick is where it puts the surface at its angle of trim. Where no position does that, the stick is in
/// the middle. Where the surface of a stick away from the middle does not come to rest (the stick asks for a rate, which
/// an integrator keeps), or does not move, the position is the share of the surface's travel: the angle from trim over that of the
/// stop on its side. Beyond its ends the stick does not go.
///
/// All that the channels give later is shifted by the difference between the angle of trim and what they give at rest there, so that a
/// flight in trim begins at rest. Properties of the options that channels alone read are set after that, with the time of the
/// channels at 0: an autopilot is switched on when the flight begins.
///
/// A surface that no channel writes is where it is asked to be. Of what else channels write, the aerodynamics feel nothing. It is `Send`.
#[derive(Clone, Debug)]
pub struct FlightControl<'a> {
    control: &'a Control,
    evaluator: Evaluator<'a>,
    step_s: f64,
    levers: [Option<Lever>; 3],
    /// What is added to what channels give, rad.
    offsets: [f64; 3],
    trim: [f64; 3],
    notes: Vec<String>,
}

/// How the stick makes an angle of a surface.
#[derive(Clone, Debug)]
struct Lever {
    /// Positions from -1 to 1 with the angles at rest, rad; none for the share of the travel.
    rests: Option<Vec<[f64; 2]>>,
    /// The position in the trim.
    trim: f64,
}

impl<'a> FlightControl<'a> {
    /// Takes over in a trim: with what is sensed there, from surfaces at these angles (elevator, aileron, rudder, rad), to run every
    /// `step_s` seconds.
    ///
    /// # Errors
    /// [`FlownError::Restless`] where the channels do not come to rest in the trim, and [`FlownError::Number`] for a step that is
    /// not positive.
    pub(crate) fn new(control: &'a Control, sensed: &Sensed, trim: [f64; 3], step_s: f64) -> Result<Self, FlownError> {
        if !(step_s > 0.0 && step_s.is_finite()) {
            return Err(FlownError::Number {
                what: "the step of flight control, s,",
                value: step_s,
                expected: "positive",
            });
        }
        let restless = |restless: Restless| FlownError::Restless {
            file: control.aircraft.own_file(),
            surface: restless.surface,
            after_s: LONGEST_S,
            rate_deg_s: restless.rate_rad_s.to_degrees(),
        };
        let mut evaluator = Evaluator::new(&control.aircraft);
        for &(index, value) in &control.begun {
            evaluator.set_index(index, value);
        }
        control.written.write(&mut evaluator, sensed);
        control.put_sticks(&mut evaluator, [0.0; 3]);
        // As JSBSim does at an initial condition.
        evaluator.start_channels(step_s);
        evaluator.start_channels(step_s);
        let neutral = come_to_rest(control, &mut evaluator, step_s, LONGEST_S, true).map_err(restless)?;
        let mut notes = Vec::new();
        let levers: [Option<Lever>; 3] = std::array::from_fn(|k| {
            if neutral[k].is_nan() {
                return None;
            }
            let rests = sweep(control, &evaluator, k, step_s);
            let trim = rests.as_ref().map_or(Some(0.0), |rests| position_of(rests, trim[k]));
            if rests.is_none() {
                notes.push(format!(
                    "The {} has no angle of rest for each position of the stick: a command is the share of its travel.",
                    NAMES[k]
                ));
            } else if trim.is_none() {
                notes.push(format!(
                    "No position of the stick holds the {} of the trim: the stick is in the middle.",
                    NAMES[k]
                ));
            }
            Some(Lever { rests, trim: trim.unwrap_or(0.0) })
        });
        control
            .put_sticks(&mut evaluator, levers.each_ref().map(|lever| lever.as_ref().map_or(0.0, |lever| lever.trim)));
        let at_rest = come_to_rest(control, &mut evaluator, step_s, LONGEST_S, true).map_err(restless)?;
        control.note_apart(&mut evaluator, &mut notes);
        for &(index, value) in &control.engaged {
            evaluator.set_index(index, value);
        }
        evaluator.set("simulation/sim-time-sec", 0.0);
        let offsets = std::array::from_fn(|k| trim[k] - at_rest[k]);
        Ok(Self { control, evaluator, step_s, levers, offsets, trim, notes })
    }

    /// Time between two steps, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// What was found when flight control took over, in sentences; empty where the stick holds the trim and every angle has its position.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The value of a property that channels read or write, in the units of JSBSim that its name tells; `None` where no file
    /// mentions it.
    pub fn property(&mut self, name: &str) -> Option<f64> {
        self.evaluator.get(name)
    }

    /// Runs the channels once, with what they sense now, where the elevator, aileron and rudder are asked to be at these angles (rad, in
    /// the signs of the equations of motion); gives the angles where the channels put them. What is not finite in gives what is not
    /// finite out, and may stay in the memory of the channels.
    pub fn step(&mut self, sensed: &Sensed, asked_rad: [f64; 3]) -> [f64; 3] {
        self.control.written.write(&mut self.evaluator, sensed);
        let sticks = std::array::from_fn(|k| self.stick(k, asked_rad[k]));
        self.control.put_sticks(&mut self.evaluator, sticks);
        self.evaluator.step_channels(self.step_s);
        let given = self.control.positions(&mut self.evaluator);
        std::array::from_fn(|k| if self.levers[k].is_some() { given[k] + self.offsets[k] } else { asked_rad[k] })
    }

    /// The position of the stick for an angle of a surface.
    fn stick(&self, surface: usize, asked: f64) -> f64 {
        let (trim, offset) = (self.trim[surface], self.offsets[surface]);
        let Some(lever) = &self.levers[surface] else { return 0.0 };
        let moved = match &lever.rests {
            // The difference is nothing in the trim, to the last digit.
            Some(rests) => nearest(rests, asked - offset) - nearest(rests, trim - offset),
            None => self.control.share(surface, asked - trim),
        };
        (lever.trim + moved).clamp(-1.0, 1.0)
    }
}

/// Positions of the stick from -1 to 1 with the angles of a surface, rad, at rest, the others where they are: as close as they need
/// to be for straight lines between them. None where it does not come to rest, or does not move one way all along.
fn sweep(control: &Control, evaluator: &Evaluator<'_>, surface: usize, step_s: f64) -> Option<Vec<[f64; 2]>> {
    let mut evaluator = evaluator.clone();
    let mut rest = |position: f64| {
        let mut at = [0.0; 3];
        at[surface] = position;
        control.put_sticks(&mut evaluator, at);
        let angles = come_to_rest(control, &mut evaluator, step_s, LONGEST_AT_A_POSITION_S, false).ok()?;
        Some([position, angles[surface]])
    };
    let mut found = vec![rest(-1.0)?];
    for k in 1..=INTERVALS {
        let to = rest(2.0 * k as f64 / INTERVALS as f64 - 1.0)?;
        // The ends of intervals that are still to be looked into, the nearest last.
        let mut open = vec![(to, 0)];
        while let Some((to, halvings)) = open.pop() {
            let from = found[found.len() - 1];
            let middle = rest(0.5 * (from[0] + to[0]))?;
            let off = (middle[1] - 0.5 * (from[1] + to[1])).abs();
            if off > OFF_SHARE * (to[1] - from[1]).abs() + OFF_LEAST && halvings < MOST_HALVINGS {
                open.push((to, halvings + 1));
                open.push((middle, halvings + 1));
            } else {
                found.push(to);
            }
        }
    }
    let travel = found[found.len() - 1][1] - found[0][1];
    let one_way = found.windows(2).all(|pair| (pair[1][1] - pair[0][1]) * travel.signum() >= -LEAST_TRAVEL);
    (one_way && travel.abs() > LEAST_TRAVEL).then_some(found)
}

/// The position of the stick that holds a surface at an angle, if one does; of several the one nearest the middle.
fn position_of(rests: &[[f64; 2]], angle: f64) -> Option<f64> {
    let between = rests.windows(2).filter_map(|pair| {
        let [[low, from], [high, to]] = [pair[0], pair[1]];
        let share = if from == to { 0.0 } else { (angle - from) / (to - from) };
        let within = if from == to { angle == from } else { (0.0..=1.0).contains(&share) };
        within.then_some(low + share * (high - low))
    });
    between.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The same, or the end of the stick that is nearer; NaN for an angle that is not a number.
fn nearest(rests: &[[f64; 2]], angle: f64) -> f64 {
    if angle.is_nan() {
        return angle;
    }
    let (first, last) = (rests[0][1], rests[rests.len() - 1][1]);
    let beyond = if (angle > last) == (last > first) { 1.0 } else { -1.0 };
    position_of(rests, angle).unwrap_or(beyond)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_from_thread_to_thread() {
        fn goes<T: Send>() {}
        goes::<FlightControl<'_>>();
    }

    #[test]
    fn an_angle_has_the_position_that_holds_it_or_the_nearer_end() {
        // A surface that goes the other way, and does not move at its ends.
        let rests = [[-1.0, 0.3], [-0.5, 0.3], [0.0, 0.1], [1.0, -0.2]];
        assert_eq!(position_of(&rests, 0.2), Some(-0.25));
        assert_eq!(position_of(&rests, 0.3), Some(-0.5));
        assert_eq!(position_of(&rests, 0.31), None);
        assert_eq!((nearest(&rests, 0.4), nearest(&rests, -0.4)), (-1.0, 1.0));
        assert!((nearest(&rests, -0.05) - 0.5).abs() < 1e-15 && nearest(&rests, f64::NAN).is_nan());
    }
}
