//! What has to be known of a surface of which an autopilot has logged the command and not the position, and the positions that follow.

use std::borrow::Cow;

use phugoid_flight_data::record::{Channel, Quantity, Record};

use super::answers::{Answers, DraftError, DraftedAxes, Question};
use crate::preparation::commanded::{COMMANDED, Commanded, no_command};

/// A surface whose command may stand for its position.
pub(super) struct Surface {
    /// Its channels.
    pub(super) channels: Commanded,
    /// Key of the question.
    key: &'static str,
    text: &'static str,
    lateral: bool,
}

pub(super) const SURFACES: [Surface; 3] = [
    Surface {
        channels: COMMANDED[0],
        key: "elevator_travel",
        text: "degrees of the elevator at full command (command 1), negative where that moves the trailing edge up",
        lateral: false,
    },
    Surface {
        channels: COMMANDED[1],
        key: "aileron_travel",
        text: "degrees of the ailerons at full command (command 1), negative where that moves the right trailing edge up",
        lateral: true,
    },
    Surface {
        channels: COMMANDED[2],
        key: "rudder_travel",
        text: "degrees of the rudder at full command (command 1), negative where that moves the trailing edge right",
        lateral: true,
    },
];

/// No surface of an aeroplane turns further, rad.
const FURTHEST: f64 = std::f64::consts::FRAC_PI_2;

impl Surface {
    /// What was answered for it: rad at full command.
    pub(super) fn travel(&self, answers: &Answers) -> Option<f64> {
        match self.channels.name {
            "elevator" => answers.elevator_travel_rad,
            "aileron" => answers.aileron_travel_rad,
            _ => answers.rudder_travel_rad,
        }
    }
}

/// The axes that are asked for; by themselves the longitudinal ones, unless the record knows of other surfaces and of no elevator.
pub(super) fn presumed_axes(record: &Record, answers: &Answers) -> DraftedAxes {
    answers.axes.unwrap_or_else(|| {
        let [elevator, others @ ..] = &SURFACES;
        let no_elevator = record.channel(elevator.channels.name).is_none() && elevator.channels.alone(record).is_none();
        match no_elevator && others.iter().any(|other| other.channels.alone(record).is_some()) {
            true => DraftedAxes::Lateral,
            false => DraftedAxes::Longitudinal,
        }
    })
}

fn is_wanted(surface: &Surface, record: &Record, answers: &Answers) -> bool {
    let axes = presumed_axes(record, answers);
    if surface.lateral { axes.has_lateral() } else { axes.has_longitudinal() }
}

/// What has to be known of the surfaces of which only the commands were recorded.
pub(super) fn questions(record: &Record, answers: &Answers) -> Vec<Question> {
    let asked = SURFACES.iter().filter(|surface| {
        surface.travel(answers).is_none()
            && is_wanted(surface, record, answers)
            && surface.channels.alone(record).is_some_and(|command| no_command(command).is_none())
    });
    asked
        .map(|surface| Question {
            key: surface.key,
            text: surface.text,
            why: "the record has its command and not its position, and the angle at full command is in no log",
        })
        .collect()
}

/// The record with the positions that the commands stand for, and the surfaces of which that is so.
pub(super) fn with_positions<'a>(
    record: &'a Record,
    answers: &Answers,
) -> Result<(Cow<'a, Record>, Vec<&'static Surface>), DraftError> {
    let mut completed = Cow::Borrowed(record);
    let mut commanded = Vec::new();
    for surface in &SURFACES {
        let name = surface.channels.name;
        let Some(command) = surface.channels.alone(record) else { continue };
        let matters = surface.travel(answers).is_some() || is_wanted(surface, record, answers);
        if let Some([low, high]) = no_command(command).filter(|_| matters) {
            return Err(DraftError::NoCommand { surface: name, command: surface.channels.command, low, high });
        }
        let Some(travel) = surface.travel(answers) else { continue };
        if !(travel.abs() > 0.0 && travel.abs() <= FURTHEST) {
            return Err(DraftError::Travel { surface: name, degrees: travel.to_degrees() });
        }
        completed.to_mut().channels.push(Channel {
            name: name.to_owned(),
            quantity: Quantity::Angle,
            values: command.values.iter().map(|value| travel * value).collect(),
        });
        commanded.push(surface);
    }
    Ok((completed, commanded))
}
