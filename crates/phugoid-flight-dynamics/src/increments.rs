//! Aerodynamic increments: the unknown or damaged part of an aircraft, added to its database about a reference point.

use crate::scalar::Scalar;

/// Increments to the aerodynamic derivatives. Every derivative is dimensionless and per radian; each term vanishes at
/// the reference point, so that increments leave the trim there alone (thesis 2.29, 2.30; build-up of section 4):
///
/// ```text
/// C = C_database + dC_alpha (alpha - alpha_ref) + dC_q cbar (q - q_ref)/2V + dC_elevator (elevator - elevator_ref)
/// ```
///
/// and for the lateral axes the same about zero, with `b p/2V` and `b r/2V`. Lift and drag increments are along the
/// stability axes of the air-relative velocity and are rotated into body axes by its angle of attack. Moments are about
/// the centre of gravity; a lift increment does not bring a moment of its own with it.
///
/// The names are those of scenario files and model files (`dCm_alpha = -0.2`); files may also write `dCm_delta_e` for
/// `dCm_elevator` and so on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "std", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
#[allow(non_snake_case)] // the field's own spelling, which scenario files use as well
pub struct Increments {
    /// Angle of attack of the reference point, rad.
    pub alpha_reference: f64,
    /// Pitch rate of the reference point, rad/s.
    pub q_reference: f64,
    /// Elevator of the reference point, rad.
    pub elevator_reference: f64,
    /// Pitching moment due to angle of attack.
    pub dCm_alpha: f64,
    /// Pitching moment due to pitch rate `q cbar/2V`.
    pub dCm_q: f64,
    /// Pitching moment due to elevator.
    #[doc(alias = "dCm_delta_e")]
    #[cfg_attr(feature = "std", serde(alias = "dCm_delta_e"))]
    pub dCm_elevator: f64,
    /// Lift due to angle of attack.
    pub dCL_alpha: f64,
    /// Lift due to pitch rate `q cbar/2V`.
    pub dCL_q: f64,
    /// Lift coefficient by elevator deflection, per rad.
    #[doc(alias = "dCL_delta_e")]
    #[cfg_attr(feature = "std", serde(alias = "dCL_delta_e"))]
    pub dCL_elevator: f64,
    /// Drag due to angle of attack.
    pub dCD_alpha: f64,
    /// Drag due to pitch rate `q cbar/2V`.
    pub dCD_q: f64,
    /// Drag coefficient by elevator deflection, per rad.
    #[doc(alias = "dCD_delta_e")]
    #[cfg_attr(feature = "std", serde(alias = "dCD_delta_e"))]
    pub dCD_elevator: f64,
    /// Side force due to sideslip.
    pub dCY_beta: f64,
    /// Side force due to roll rate `p b/2V`.
    pub dCY_p: f64,
    /// Side force due to yaw rate `r b/2V`.
    pub dCY_r: f64,
    /// Side force due to aileron.
    #[doc(alias = "dCY_delta_a")]
    #[cfg_attr(feature = "std", serde(alias = "dCY_delta_a"))]
    pub dCY_aileron: f64,
    /// Side force due to rudder.
    #[doc(alias = "dCY_delta_r")]
    #[cfg_attr(feature = "std", serde(alias = "dCY_delta_r"))]
    pub dCY_rudder: f64,
    /// Rolling moment due to sideslip.
    pub dCl_beta: f64,
    /// Rolling moment due to roll rate `p b/2V`.
    pub dCl_p: f64,
    /// Rolling moment due to yaw rate `r b/2V`.
    pub dCl_r: f64,
    /// Rolling moment due to aileron.
    #[doc(alias = "dCl_delta_a")]
    #[cfg_attr(feature = "std", serde(alias = "dCl_delta_a"))]
    pub dCl_aileron: f64,
    /// Rolling moment due to rudder.
    #[doc(alias = "dCl_delta_r")]
    #[cfg_attr(feature = "std", serde(alias = "dCl_delta_r"))]
    pub dCl_rudder: f64,
    /// Yawing moment due to sideslip.
    pub dCn_beta: f64,
    /// Yawing moment due to roll rate `p b/2V`.
    pub dCn_p: f64,
    /// Yawing moment due to yaw rate `r b/2V`.
    pub dCn_r: f64,
    /// Yawing moment due to aileron.
    #[doc(alias = "dCn_delta_a")]
    #[cfg_attr(feature = "std", serde(alias = "dCn_delta_a"))]
    pub dCn_aileron: f64,
    /// Yawing moment due to rudder.
    #[doc(alias = "dCn_delta_r")]
    #[cfg_attr(feature = "std", serde(alias = "dCn_delta_r"))]
    pub dCn_rudder: f64,
}

impl Increments {
    /// The database as it is: all increments and references are zero.
    pub const NONE: Self = Self {
        alpha_reference: 0.0,
        q_reference: 0.0,
        elevator_reference: 0.0,
        dCm_alpha: 0.0,
        dCm_q: 0.0,
        dCm_elevator: 0.0,
        dCL_alpha: 0.0,
        dCL_q: 0.0,
        dCL_elevator: 0.0,
        dCD_alpha: 0.0,
        dCD_q: 0.0,
        dCD_elevator: 0.0,
        dCY_beta: 0.0,
        dCY_p: 0.0,
        dCY_r: 0.0,
        dCY_aileron: 0.0,
        dCY_rudder: 0.0,
        dCl_beta: 0.0,
        dCl_p: 0.0,
        dCl_r: 0.0,
        dCl_aileron: 0.0,
        dCl_rudder: 0.0,
        dCn_beta: 0.0,
        dCn_p: 0.0,
        dCn_r: 0.0,
        dCn_aileron: 0.0,
        dCn_rudder: 0.0,
    };

    /// The same derivatives about another reference point: angle of attack (rad), pitch rate (rad/s), elevator (rad).
    #[must_use]
    pub fn about(self, alpha: f64, q: f64, elevator: f64) -> Self {
        Self { alpha_reference: alpha, q_reference: q, elevator_reference: elevator, ..self }
    }

    /// All derivatives under their names.
    pub fn named(&self) -> [(&'static str, f64); 24] {
        macro_rules! named {
            ($($name:ident)*) => { [$((stringify!($name), self.$name)),*] };
        }
        named![
            dCm_alpha dCm_q dCm_elevator dCL_alpha dCL_q dCL_elevator dCD_alpha dCD_q dCD_elevator
            dCY_beta dCY_p dCY_r dCY_aileron dCY_rudder dCl_beta dCl_p dCl_r dCl_aileron dCl_rudder
            dCn_beta dCn_p dCn_r dCn_aileron dCn_rudder
        ]
    }

    /// The derivative of this name; none if there is none.
    pub fn by_name_mut(&mut self, name: &str) -> Option<&mut f64> {
        macro_rules! named {
            ($($name:ident)*) => { match name { $(stringify!($name) => Some(&mut self.$name),)* _ => None } };
        }
        named![
            dCm_alpha dCm_q dCm_elevator dCL_alpha dCL_q dCL_elevator dCD_alpha dCD_q dCD_elevator
            dCY_beta dCY_p dCY_r dCY_aileron dCY_rudder dCl_beta dCl_p dCl_r dCl_aileron dCl_rudder
            dCn_beta dCn_p dCn_r dCn_aileron dCn_rudder
        ]
    }

    /// A part of the way, 0 to 1, to other increments about the same reference point.
    #[must_use]
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let mut between = *self;
        for ((name, from), (_, to)) in self.named().into_iter().zip(other.named()) {
            if let Some(value) = between.by_name_mut(name) {
                *value = from + part * (to - from);
            }
        }
        between
    }

    /// The longitudinal derivatives under their names.
    pub fn named_longitudinal(&self) -> [(&'static str, f64); 9] {
        macro_rules! named {
            ($($name:ident)*) => { [$((stringify!($name), self.$name)),*] };
        }
        named![dCm_alpha dCm_q dCm_elevator dCL_alpha dCL_q dCL_elevator dCD_alpha dCD_q dCD_elevator]
    }

    /// The longitudinal derivative of this name; none if there is none.
    pub fn longitudinal_mut(&mut self, name: &str) -> Option<&mut f64> {
        macro_rules! named {
            ($($name:ident)*) => { match name { $(stringify!($name) => Some(&mut self.$name),)* _ => None } };
        }
        named![dCm_alpha dCm_q dCm_elevator dCL_alpha dCL_q dCL_elevator dCD_alpha dCD_q dCD_elevator]
    }

    /// Whether any longitudinal derivative is not zero.
    #[inline]
    pub fn is_longitudinal(&self) -> bool {
        let all = [
            self.dCm_alpha,
            self.dCm_q,
            self.dCm_elevator,
            self.dCL_alpha,
            self.dCL_q,
            self.dCL_elevator,
            self.dCD_alpha,
            self.dCD_q,
            self.dCD_elevator,
        ];
        any_not_zero(&all)
    }

    /// Whether any lateral derivative is not zero.
    #[inline]
    pub fn is_lateral(&self) -> bool {
        let all = [
            self.dCY_beta,
            self.dCY_p,
            self.dCY_r,
            self.dCY_aileron,
            self.dCY_rudder,
            self.dCl_beta,
            self.dCl_p,
            self.dCl_r,
            self.dCl_aileron,
            self.dCl_rudder,
            self.dCn_beta,
            self.dCn_p,
            self.dCn_r,
            self.dCn_aileron,
            self.dCn_rudder,
        ];
        any_not_zero(&all)
    }

    /// `[dCL, dCD, dCm]` from the air-relative angle of attack (rad), `cbar / 2V` (s), pitch rate (rad/s) and elevator
    /// (rad).
    #[inline]
    pub fn longitudinal<T: Scalar>(&self, alpha: T, chord_time: T, q: T, elevator: T) -> [T; 3] {
        let alpha = alpha - self.alpha_reference;
        let q_hat = chord_time * (q - self.q_reference);
        let elevator = elevator - self.elevator_reference;
        let sum = |a: f64, b: f64, c: f64| alpha * a + q_hat * b + elevator * c;
        [
            sum(self.dCL_alpha, self.dCL_q, self.dCL_elevator),
            sum(self.dCD_alpha, self.dCD_q, self.dCD_elevator),
            sum(self.dCm_alpha, self.dCm_q, self.dCm_elevator),
        ]
    }

    /// `[dCY, dCl, dCn]` from sideslip (rad), the dimensionless rates `p b/2V` and `r b/2V`, aileron and rudder (rad).
    #[inline]
    pub fn lateral<T: Scalar>(&self, beta: T, p_hat: T, r_hat: T, aileron: T, rudder: T) -> [T; 3] {
        let sum = |d: [f64; 5]| beta * d[0] + p_hat * d[1] + r_hat * d[2] + aileron * d[3] + rudder * d[4];
        [
            sum([self.dCY_beta, self.dCY_p, self.dCY_r, self.dCY_aileron, self.dCY_rudder]),
            sum([self.dCl_beta, self.dCl_p, self.dCl_r, self.dCl_aileron, self.dCl_rudder]),
            sum([self.dCn_beta, self.dCn_p, self.dCn_r, self.dCn_aileron, self.dCn_rudder]),
        ]
    }
}

/// Asked at every evaluation: without branches, and zero of either sign is zero.
#[inline(always)]
fn any_not_zero(all: &[f64]) -> bool {
    all.iter().fold(0, |bits, d| bits | d.to_bits()) << 1 != 0
}

/// Lift and drag coefficients turned into body axes: `[CX, CZ]` from `CL`, `CD` and sine and cosine of the angle of
/// attack. `CX = CL sin a - CD cos a`, `CZ = -CL cos a - CD sin a`.
#[inline]
pub fn lift_drag_to_body<T: Scalar>(lift: T, drag: T, sine: T, cosine: T) -> [T; 2] {
    [lift * sine - drag * cosine, -(lift * cosine) - drag * sine]
}

/// Increments that change in flight: damage, icing, a store released.
#[cfg(feature = "std")]
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "Vec<IncrementChange>", into = "Vec<IncrementChange>")]
pub struct IncrementSchedule {
    changes: Vec<IncrementChange>,
}

/// From `time` on, `increments` are in force.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IncrementChange {
    /// Time of the change, s. A file that names none means the whole flight.
    #[serde(default = "whole_flight", skip_serializing_if = "is_whole_flight")]
    pub time: f64,
    /// What is in force from then on; it replaces, it does not add to, what was in force before.
    pub increments: Increments,
}

#[cfg(feature = "std")]
fn whole_flight() -> f64 {
    f64::NEG_INFINITY
}

#[cfg(feature = "std")]
fn is_whole_flight(time: &f64) -> bool {
    *time == f64::NEG_INFINITY
}

/// A schedule that cannot be read.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ScheduleError {
    /// Times must be numbers and increase.
    #[error(
        "increment schedule: change {index} is at {time} s, which is not after {previous} s; list the changes in \
         order of time"
    )]
    Disorder {
        /// Index of the change, from 0.
        index: usize,
        /// Time of the change that is out of order, s.
        time: f64,
        /// Time of the change before it, s (minus infinity for the first).
        previous: f64,
    },
}

#[cfg(feature = "std")]
impl IncrementSchedule {
    /// The same increments for the whole flight.
    pub fn constant(increments: Increments) -> Self {
        Self { changes: vec![IncrementChange { time: f64::NEG_INFINITY, increments }] }
    }

    /// Changes in order of time. Before the first one the database stands alone.
    pub fn new(changes: Vec<IncrementChange>) -> Result<Self, ScheduleError> {
        let mut previous = f64::NEG_INFINITY;
        for (index, change) in changes.iter().enumerate() {
            let first = index == 0 && change.time == f64::NEG_INFINITY;
            if !(change.time > previous || first) {
                return Err(ScheduleError::Disorder { index, time: change.time, previous });
            }
            previous = change.time;
        }
        Ok(Self { changes })
    }

    /// What is in force at a time (s). A change counts from its own time on (right limit).
    pub fn at(&self, time: f64) -> Increments {
        let after = self.changes.partition_point(|change| change.time <= time);
        after
            .checked_sub(1)
            .and_then(|last| self.changes.get(last))
            .map_or(Increments::NONE, |change| change.increments)
    }

    /// The changes, in order of time.
    pub fn changes(&self) -> &[IncrementChange] {
        &self.changes
    }
}

#[cfg(feature = "std")]
impl TryFrom<Vec<IncrementChange>> for IncrementSchedule {
    type Error = ScheduleError;
    fn try_from(changes: Vec<IncrementChange>) -> Result<Self, ScheduleError> {
        Self::new(changes)
    }
}

#[cfg(feature = "std")]
impl From<IncrementSchedule> for Vec<IncrementChange> {
    fn from(schedule: IncrementSchedule) -> Self {
        schedule.changes
    }
}
