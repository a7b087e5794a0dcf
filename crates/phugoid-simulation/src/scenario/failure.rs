//! Surfaces that no longer do what they are told.

use serde::Deserialize;

use crate::manoeuvre::Surface;
use phugoid_flight_dynamics::actuator::Actuator;

use crate::quantity::{Angle, AngularRate, Frequency, Time};

/// A surface that fails in flight and stays so; of several failures of one surface the latest holds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// The surface that fails.
    pub surface: Surface,
    /// When, from the start of the flight.
    pub at: Time,
    /// What it does from then on.
    pub kind: FailureKind,
    /// Where it jams; where it is at that moment, if not given.
    #[serde(default)]
    pub position: Option<Angle>,
    /// Largest rate that is left, with `kind = "rate-limit"`.
    #[serde(default)]
    pub rate_limit: Option<AngularRate>,
    /// How late the actuator gets its commands from then on, with `kind = "delay"`.
    #[serde(default)]
    pub delay: Option<Time>,
    /// Play of the linkage from one side to the other from then on, with `kind = "play"`.
    #[serde(default)]
    pub play: Option<Angle>,
    /// Amplitude of an oscillation about the command.
    #[serde(default)]
    pub amplitude: Option<Angle>,
    /// Frequency of an oscillation.
    #[serde(default)]
    pub frequency: Option<Frequency>,
}

/// What a failed surface does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureKind {
    /// It stays where it is, whatever is commanded.
    Jam,
    /// It trails in the air: the elevator turns against the angle of attack, the rudder with the sideslip, ailerons to zero.
    Float,
    /// It moves slowly.
    RateLimit,
    /// It follows its commands later.
    Delay,
    /// Its linkage has play.
    Play,
    /// It oscillates about what is commanded.
    Oscillation,
}

impl Failure {
    pub(super) fn check(&self, actuators: bool) -> Result<(), String> {
        let name = self.surface.name();
        let needs = |given: bool, key: &str| {
            if given { Ok(()) } else { Err(format!("the failure of the {name} needs `{key}`")) }
        };
        let has_no = |given: bool, key: &str, kind: &str| {
            if given {
                Err(format!("`{key}` of the failure of the {name} has a meaning with `kind = \"{kind}\"` alone"))
            } else {
                Ok(())
            }
        };
        if self.at.si() < 0.0 {
            return Err(format!("the failure of the {name} is at {}: a time from the start of the flight on", self.at));
        }
        let of_actuator = |what: &str| {
            if actuators {
                return Ok(());
            }
            Err(format!(
                "the {what} of the {name} has a meaning only with `actuators = true` under [aircraft]: surfaces follow their \
                 commands at once without"
            ))
        };
        match self.kind {
            FailureKind::RateLimit => {
                needs(self.rate_limit.is_some_and(|limit| limit.si() >= 0.0), "rate_limit")?;
                of_actuator("limit of the rate")?;
            }
            FailureKind::Delay => {
                needs(self.delay.is_some_and(|delay| delay.si() > 0.0), "delay")?;
                if let Some(delay) = self.delay.filter(|delay| delay.si() > Actuator::LONGEST_DELAY) {
                    let most = Actuator::LONGEST_DELAY;
                    return Err(format!(
                        "the delay of the {name} is {delay}: expected {most} s at most, e.g. \"20 ms\""
                    ));
                }
                of_actuator("delay")?;
            }
            FailureKind::Play => {
                needs(self.play.is_some_and(|play| play.si() > 0.0), "play")?;
                of_actuator("play")?;
            }
            FailureKind::Oscillation => {
                needs(self.amplitude.is_some(), "amplitude")?;
                needs(self.frequency.is_some_and(|f| f.si() > 0.0), "frequency")?;
            }
            FailureKind::Jam | FailureKind::Float => {}
        }
        has_no(self.kind != FailureKind::Jam && self.position.is_some(), "position", "jam")?;
        has_no(self.kind != FailureKind::Delay && self.delay.is_some(), "delay", "delay")?;
        has_no(self.kind != FailureKind::Play && self.play.is_some(), "play", "play")?;
        has_no(self.kind != FailureKind::RateLimit && self.rate_limit.is_some(), "rate_limit", "rate-limit")?;
        has_no(self.kind != FailureKind::Oscillation && self.amplitude.is_some(), "amplitude", "oscillation")?;
        has_no(self.kind != FailureKind::Oscillation && self.frequency.is_some(), "frequency", "oscillation")
    }

    /// The actuator that is left of `whole`.
    pub(crate) fn actuator(&self, whole: Actuator) -> Actuator {
        match self.kind {
            FailureKind::RateLimit => {
                let limit = self.rate_limit.map_or(whole.rate_limit, |limit| limit.si());
                Actuator { rate_limit: limit.min(whole.rate_limit), ..whole }
            }
            FailureKind::Delay => Actuator { delay: whole.delay + self.delay.map_or(0.0, |delay| delay.si()), ..whole },
            FailureKind::Play => Actuator { play: whole.play + self.play.map_or(0.0, |play| play.si()), ..whole },
            FailureKind::Jam | FailureKind::Float | FailureKind::Oscillation => whole,
        }
    }

    /// What the actuator is told in place of `command` (rad) at a time (s), when the surface was at `position` (rad) at the
    /// moment of the failure and would trail in the air at `trailing` (rad).
    pub(crate) fn command(&self, time: f64, command: f64, position: f64, trailing: f64) -> f64 {
        match self.kind {
            FailureKind::Jam => self.position.map_or(position, |position| position.si()),
            FailureKind::Float => trailing,
            FailureKind::RateLimit | FailureKind::Delay | FailureKind::Play => command,
            FailureKind::Oscillation => {
                let si = |angle: Option<Angle>| angle.map_or(0.0, |angle| angle.si());
                let turns = self.frequency.map_or(0.0, |f| f.si()) * (time - self.at.si());
                command + si(self.amplitude) * (std::f64::consts::TAU * turns).sin()
            }
        }
    }
}
