//! Everything that changes in a running FMU: its state, its inputs and its parameters.

use phugoid_flight_dynamics::aircraft::{Controls, STATES, State};
use phugoid_flight_dynamics::gust::AirMotion;
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::trim::Trim;

use crate::variables::{INTEGRATION_STEP_S, Role};

/// Numbers of a point: time, step, states, controls, air, and the increments with their three references.
const NUMBERS: usize = 2 + STATES + 4 + 6 + 3 + 24;
/// First bytes of a point that was written down.
const MARK: [u8; 8] = *b"phugoid1";

/// The flight of an FMU at an instant: all that its derivatives and outputs follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Time, s.
    pub time: f64,
    /// Longest integration step of co-simulation, s.
    pub step: f64,
    /// State of the aircraft.
    pub state: State,
    /// Throttle lever and surface positions.
    pub controls: Controls,
    /// Motion of the air.
    pub air: AirMotion,
    /// Increments to the derivatives, about the trim.
    pub increments: Increments,
}

/// Why bytes are no point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// Another length, or another beginning.
    #[error(
        "the bytes are no state that an FMU of Phugoid has written down: it has {} bytes and begins with `phugoid1`",
        Point::BYTES
    )]
    Foreign,
    /// A number that is none.
    #[error("the state that was written down has a number that is not finite: it is damaged")]
    NotFinite,
}

impl Point {
    /// Bytes of a point that is written down.
    pub const BYTES: usize = MARK.len() + 8 * NUMBERS;

    /// The flight at a trim, in still air, without increments.
    pub fn of_trim(trim: &Trim) -> Self {
        Self::new(trim.state(), trim.controls())
    }

    /// The flight at a state with these controls, in still air; increments count from there.
    pub fn new(state: State, controls: Controls) -> Self {
        Self {
            time: 0.0,
            step: INTEGRATION_STEP_S,
            state,
            controls,
            air: AirMotion::default(),
            increments: Increments::NONE.about(state.alpha, state.q, controls.elevator),
        }
    }

    /// The value of a variable that is set from outside; none for one that is computed.
    pub fn value(&self, role: &Role) -> Option<f64> {
        let Controls { throttle, elevator, aileron, rudder } = self.controls;
        match *role {
            Role::Time => Some(self.time),
            Role::Step => Some(self.step),
            Role::Control(i) => [throttle, elevator, aileron, rudder].get(i).copied(),
            Role::Air(i) => self.air.velocity.iter().chain(&self.air.rates).nth(i).copied(),
            Role::State(i) => self.state.to_array().get(i).copied(),
            Role::Increment(name) => {
                self.increments.named().into_iter().find(|(known, _)| *known == name).map(|(_, value)| value)
            }
            Role::Rate(_) | Role::Output(_) => None,
        }
    }

    /// Sets a variable; whether it can be set.
    pub(crate) fn set(&mut self, role: &Role, value: f64) -> bool {
        let controls = &mut self.controls;
        let place = match *role {
            Role::Step => Some(&mut self.step),
            Role::Control(i) => {
                let places =
                    [&mut controls.throttle, &mut controls.elevator, &mut controls.aileron, &mut controls.rudder];
                places.into_iter().nth(i)
            }
            Role::Air(i) => self.air.velocity.iter_mut().chain(&mut self.air.rates).nth(i),
            Role::Increment(name) => self.increments.by_name_mut(name),
            Role::State(i) => {
                let mut states = self.state.to_array();
                let place = states.get_mut(i).map(|state| *state = value);
                self.state = State::from_array(states);
                return place.is_some();
            }
            Role::Time | Role::Rate(_) | Role::Output(_) => None,
        };
        place.map(|place| *place = value).is_some()
    }

    fn numbers(&self) -> Vec<f64> {
        let Controls { throttle, elevator, aileron, rudder } = self.controls;
        let i = &self.increments;
        let mut numbers = Vec::with_capacity(NUMBERS);
        numbers.extend([self.time, self.step]);
        numbers.extend(self.state.to_array());
        numbers.extend([throttle, elevator, aileron, rudder]);
        numbers.extend(self.air.velocity.into_iter().chain(self.air.rates));
        numbers.extend([i.alpha_reference, i.q_reference, i.elevator_reference]);
        numbers.extend(i.named().map(|(_, value)| value));
        numbers
    }

    /// The point as bytes, the same on every machine.
    pub fn to_bytes(&self) -> Vec<u8> {
        MARK.into_iter().chain(self.numbers().into_iter().flat_map(f64::to_le_bytes)).collect()
    }

    /// The point of [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// [`PointError`]: bytes of something else, or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PointError> {
        let (eights, rest) = bytes.strip_prefix(&MARK).ok_or(PointError::Foreign)?.as_chunks::<8>();
        if eights.len() != NUMBERS || !rest.is_empty() {
            return Err(PointError::Foreign);
        }
        let mut numbers = eights.iter().map(|eight| f64::from_le_bytes(*eight));
        if numbers.clone().any(|number| !number.is_finite()) {
            return Err(PointError::NotFinite);
        }
        // There are as many as were counted above.
        let mut next = || numbers.next().unwrap_or_default();
        let (time, step) = (next(), next());
        let state = State::from_array(std::array::from_fn(|_| next()));
        let [throttle, elevator, aileron, rudder] = std::array::from_fn(|_| next());
        let air = AirMotion { velocity: std::array::from_fn(|_| next()), rates: std::array::from_fn(|_| next()) };
        let mut increments = Increments::NONE.about(next(), next(), next());
        for (name, _) in Increments::NONE.named() {
            let value = next();
            if let Some(place) = increments.by_name_mut(name) {
                *place = value;
            }
        }
        Ok(Self { time, step, state, controls: Controls { throttle, elevator, aileron, rudder }, air, increments })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::variables::variables;

    /// A point in which every number is another one.
    fn varied() -> Point {
        let mut point = Point::new(State::from_array([0.5; STATES]), Controls::default());
        for (i, variable) in variables().iter().enumerate() {
            let is_set = point.set(&variable.role, 1.0 + 0.1 * i as f64);
            assert_eq!(is_set, point.value(&variable.role).is_some() && !matches!(variable.role, Role::Time));
        }
        point.time = 7.0;
        point
    }

    #[test]
    fn what_is_set_is_there_and_survives_being_written_down() {
        let point = varied();
        for (i, variable) in variables().iter().enumerate() {
            if !matches!(variable.role, Role::Time | Role::Rate(_) | Role::Output(_)) {
                assert_eq!(point.value(&variable.role), Some(1.0 + 0.1 * i as f64), "{}", variable.name);
            }
        }
        assert_eq!(point.to_bytes().len(), Point::BYTES);
        assert_eq!(Point::from_bytes(&point.to_bytes()).unwrap(), point);
    }

    #[test]
    fn bytes_of_something_else_are_refused() {
        let bytes = varied().to_bytes();
        assert_eq!(Point::from_bytes(&bytes[..bytes.len() - 1]), Err(PointError::Foreign));
        assert_eq!(Point::from_bytes(&[]), Err(PointError::Foreign));
        let mut foreign = bytes.clone();
        foreign[0] = b'q';
        assert_eq!(Point::from_bytes(&foreign), Err(PointError::Foreign));
        let mut damaged = bytes;
        damaged[8..16].copy_from_slice(&f64::NAN.to_le_bytes());
        assert_eq!(Point::from_bytes(&damaged), Err(PointError::NotFinite));
    }
}
