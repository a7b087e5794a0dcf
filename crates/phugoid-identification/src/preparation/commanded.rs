//! Surfaces of which a record has the command, as an autopilot logs it, and not the position.

use phugoid_flight_data::record::{Channel, Quantity, Record};

/// A surface and the channel of its command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Commanded {
    /// The channel of the position.
    pub(crate) name: &'static str,
    /// The channel of the command, 1 at full command.
    pub(crate) command: &'static str,
}

/// Elevator, aileron and rudder.
pub(crate) const COMMANDED: [Commanded; 3] = [
    Commanded { name: "elevator", command: "elevator_command" },
    Commanded { name: "aileron", command: "aileron_command" },
    Commanded { name: "rudder", command: "rudder_command" },
];

/// Commands that are called -1 to 1 exceed this nowhere; trims and filters carry some a little beyond 1.
const FULL: f64 = 1.5;

impl Commanded {
    /// The command, where the record has it with values and does not have the position.
    pub(crate) fn alone<'a>(&self, record: &'a Record) -> Option<&'a Channel> {
        let channel =
            |name: &str| record.channel(name).filter(|channel| channel.values.iter().any(|value| value.is_finite()));
        channel(self.command).filter(|found| channel(self.name).is_none() && found.quantity == Quantity::Number)
    }

    /// The header by which a mapping finds the command: of a log its name, of a table the whole header of the column.
    pub(crate) fn header<'a>(&self, record: &'a Record) -> &'a str
    where
        'static: 'a,
    {
        let quality = record.quality.channels.iter().find(|channel| channel.name == self.command);
        let header = quality.map(|channel| channel.header.trim()).filter(|header| header.starts_with(self.command));
        header.unwrap_or(self.command)
    }
}

/// The surfaces of which a record has the command from -1 to 1 and not the position, with the headers of the commands.
pub(crate) fn alone(record: &Record) -> Vec<(&'static str, &str)> {
    let is_alone = |surface: &&Commanded| surface.alone(record).is_some_and(|command| no_command(command).is_none());
    COMMANDED.iter().filter(is_alone).map(|surface| (surface.name, surface.header(record))).collect()
}

/// The smallest and the largest command, if they are none from -1 to 1.
pub(crate) fn no_command(channel: &Channel) -> Option<[f64; 2]> {
    let finite = channel.values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
    (low < -FULL || high > FULL).then_some([low, high])
}
