//! Surfaces of which an autopilot has logged the command, and not the position.

use std::borrow::Cow;

use phugoid_flight_data::record::{Channel, Quantity, Record};

use super::answers::{Answers, DraftError, DraftedAxes, Question};

/// A surface whose command may stand for its position.
pub(super) struct Surface {
    /// The channel of the position.
    pub(super) name: &'static str,
    /// The channel of the command, 1 at full command.
    pub(super) command: &'static str,
    /// Key of the question.
    key: &'static str,
    text: &'static str,
    lateral: bool,
}

pub(super) const SURFACES: [Surface; 3] = [
    Surface {
        name: "elevator",
        command: "elevator_command",
        key: "elevator_travel",
        text: "degrees of the elevator at full command (command 1), negative where that moves the trailing edge up",
        lateral: false,
    },
    Surface {
        name: "aileron",
        command: "aileron_command",
        key: "aileron_travel",
        text: "degrees of the ailerons at full command (command 1), negative where that moves the right trailing edge up",
        lateral: true,
    },
    Surface {
        name: "rudder",
        command: "rudder_command",
        key: "rudder_travel",
        text: "degrees of the rudder at full command (command 1), negative where that moves the trailing edge right",
        lateral: true,
    },
];

/// Commands that are called -1 to 1 exceed this nowhere; trims and filters carry some a little beyond 1.
const FULL: f64 = 1.5;
/// No surface of an aeroplane turns further, rad.
const FURTHEST: f64 = std::f64::consts::FRAC_PI_2;

impl Surface {
    /// What was answered for it: rad at full command.
    pub(super) fn travel(&self, answers: &Answers) -> Option<f64> {
        match self.name {
            "elevator" => answers.elevator_travel_rad,
            "aileron" => answers.aileron_travel_rad,
            _ => answers.rudder_travel_rad,
        }
    }

    /// The command, where the record has it with values and does not have the position.
    fn alone<'a>(&self, record: &'a Record) -> Option<&'a Channel> {
        let channel =
            |name: &str| record.channel(name).filter(|channel| channel.values.iter().any(|value| value.is_finite()));
        channel(self.command).filter(|found| channel(self.name).is_none() && found.quantity == Quantity::Number)
    }

    /// The header by which a mapping finds the command: of a log its name, of a table the whole header of the column.
    pub(super) fn header<'a>(&'a self, record: &'a Record) -> &'a str {
        let quality = record.quality.channels.iter().find(|channel| channel.name == self.command);
        let header = quality.map(|channel| channel.header.trim()).filter(|header| header.starts_with(self.command));
        header.unwrap_or(self.command)
    }
}

/// The surfaces of which a record has the command from -1 to 1 and not the position, with the headers of the commands.
pub(crate) fn alone(record: &Record) -> Vec<(&'static str, &str)> {
    let is_alone = |surface: &&Surface| surface.alone(record).is_some_and(|command| no_command(command).is_none());
    SURFACES.iter().filter(is_alone).map(|surface| (surface.name, surface.header(record))).collect()
}

/// The smallest and the largest command, if they are none from -1 to 1.
fn no_command(channel: &Channel) -> Option<[f64; 2]> {
    let finite = channel.values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
    (low < -FULL || high > FULL).then_some([low, high])
}

/// The axes that are asked for; by themselves the longitudinal ones, unless the record knows of other surfaces and of no elevator.
pub(super) fn presumed_axes(record: &Record, answers: &Answers) -> DraftedAxes {
    answers.axes.unwrap_or_else(|| {
        let [elevator, others @ ..] = &SURFACES;
        let no_elevator = record.channel(elevator.name).is_none() && elevator.alone(record).is_none();
        match no_elevator && others.iter().any(|other| other.alone(record).is_some()) {
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
            && surface.alone(record).is_some_and(|command| no_command(command).is_none())
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
        let Some(command) = surface.alone(record) else { continue };
        let matters = surface.travel(answers).is_some() || is_wanted(surface, record, answers);
        if let Some([low, high]) = no_command(command).filter(|_| matters) {
            return Err(DraftError::NoCommand { surface: surface.name, command: surface.command, low, high });
        }
        let Some(travel) = surface.travel(answers) else { continue };
        if !(travel.abs() > 0.0 && travel.abs() <= FURTHEST) {
            return Err(DraftError::Travel { surface: surface.name, degrees: travel.to_degrees() });
        }
        completed.to_mut().channels.push(Channel {
            name: surface.name.to_owned(),
            quantity: Quantity::Angle,
            values: command.values.iter().map(|value| travel * value).collect(),
        });
        commanded.push(surface);
    }
    Ok((completed, commanded))
}
