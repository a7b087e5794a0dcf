//! Definitions of messages (`FMT`), and the units and multipliers of their fields (`FMTU`, `UNIT`, `MULT`).

use std::collections::HashMap;

use crate::log::decode::{Kind, Place, Scale};
use crate::log::sink::{Sink, Stream};

/// Number of bytes before the payload: two marker bytes and the type.
pub(super) const HEADER: usize = 3;
/// Largest number of instances of one message that are kept.
const MAX_INSTANCES: usize = 256;

/// One field of a definition, under the label that the log gives it.
#[derive(Clone, Debug, PartialEq)]
struct Label {
    name: String,
    offset: usize,
    size: usize,
    /// Type and factor of the number; `None` for text.
    number: Option<(Kind, Scale)>,
    /// True if its type itself implies a factor: hundredths, or ten-millionths of a degree.
    own_multiplier: bool,
}

/// What a message is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Definition,
    Units,
    Unit,
    Multiplier,
    Parameter,
    Text,
    Data,
}

/// Where the time of a message comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stamp {
    /// From this field, whose factor converts it to microseconds.
    Field(Place),
    /// From the message before it: it has no time of its own.
    Before,
}

/// The definition of one type of message, and where its samples go.
#[derive(Debug)]
pub(super) struct Format {
    pub(super) name: String,
    /// Size of a message with its header, bytes.
    pub(super) length: usize,
    pub(super) purpose: Purpose,
    pub(super) stamp: Stamp,
    /// The definition as written (types, labels), to recognise a repetition.
    text: (String, String),
    labels: Vec<Label>,
    /// Names of the numeric fields without the time stamp, elements of arrays one by one, in the order of `fields`.
    names: Vec<String>,
    fields: Vec<FieldOf>,
    instance: Option<Place>,
    /// Unit and multiplier characters of `FMTU`, one per label.
    ids: Option<(Vec<u8>, Vec<u8>)>,
    streams: Vec<(u16, Option<Open>)>,
}

#[derive(Clone, Copy, Debug)]
struct FieldOf {
    label: usize,
    place: Place,
    described: bool,
}

/// Where the samples of one instance go, and the places of the values that are kept.
#[derive(Debug)]
pub(super) struct Open {
    pub(super) stream: Stream,
    pub(super) places: Vec<Place>,
}

/// The tables of units and multipliers in the log (`UNIT`, `MULT`), by their characters.
#[derive(Debug, Default)]
pub(super) struct Tables {
    pub(super) units: HashMap<u8, String>,
    pub(super) multipliers: HashMap<u8, f64>,
}

impl Format {
    /// The definition of `FMT` itself, which a log may lack.
    pub(super) fn of_formats() -> Self {
        let format = Self::new("FMT", 89, "BBnNZ", "Type,Length,Name,Format,Columns");
        format.unwrap_or_else(|_| Self::unreadable("FMT", 89))
    }

    /// Makes a definition of its parts; the error says what is wrong with it.
    pub(super) fn new(name: &str, length: usize, letters: &str, columns: &str) -> Result<Self, String> {
        let names: Vec<&str> = columns.split(',').filter(|name| !name.is_empty()).collect();
        if names.len() != letters.len() {
            return Err(format!("it has {} columns ({columns}) for {} types ({letters})", names.len(), letters.len()));
        }
        let mut labels = Vec::with_capacity(names.len());
        let mut end = 0;
        for (name, letter) in names.iter().zip(letters.chars()) {
            let Letter { size, number, own_multiplier } =
                letter_of(letter).ok_or_else(|| format!("the type '{letter}' is not known"))?;
            labels.push(Label { name: (*name).to_owned(), offset: end, size, number, own_multiplier });
            end += size;
        }
        if end + HEADER != length {
            return Err(format!(
                "its length is given as {length}, but its types ({letters}) take {} bytes",
                end + HEADER
            ));
        }
        let purpose = match name {
            "FMT" => Purpose::Definition,
            "FMTU" => Purpose::Units,
            "UNIT" => Purpose::Unit,
            "MULT" => Purpose::Multiplier,
            "PARM" => Purpose::Parameter,
            "MSG" => Purpose::Text,
            _ => Purpose::Data,
        };
        let clock = clock_of(name, &labels);
        let mut format = Self { labels, ..Self::unreadable(name, length) };
        format.purpose = purpose;
        format.text = (letters.to_owned(), columns.to_owned());
        if let Some((index, microseconds)) = clock
            && let Some(place) = format.labels.get(index).and_then(Label::place)
        {
            format.stamp = Stamp::Field(Place { scale: Scale::new(microseconds), ..place });
        }
        let stamp = clock.map(|(index, _)| index);
        for (index, label) in format.labels.iter().enumerate().filter(|(index, _)| Some(*index) != stamp) {
            let Some(place) = label.place() else { continue };
            for element in 0..label.size / place.kind.size() {
                let is_array = label.size > place.kind.size();
                format.names.push(if is_array { format!("{}[{element}]", label.name) } else { label.name.clone() });
                let place = Place { offset: place.offset + element * place.kind.size(), ..place };
                format.fields.push(FieldOf { label: index, place, described: false });
            }
        }
        Ok(format)
    }

    /// A definition that cannot be used: messages of this length are skipped.
    pub(super) fn unreadable(name: &str, length: usize) -> Self {
        Self {
            name: name.to_owned(),
            length,
            purpose: Purpose::Data,
            stamp: Stamp::Before,
            text: Default::default(),
            labels: Vec::new(),
            names: Vec::new(),
            fields: Vec::new(),
            instance: None,
            ids: None,
            streams: Vec::new(),
        }
    }

    /// True if this is the same definition.
    pub(super) fn is(&self, name: &str, length: usize, letters: &str, columns: &str) -> bool {
        self.name == name && self.length == length && self.text.0 == letters && self.text.1 == columns
    }

    pub(super) fn has_numbers(&self) -> bool {
        !self.fields.is_empty()
    }

    /// The number with this label in a message.
    pub(super) fn number(&self, label: &str, payload: &[u8]) -> Option<f64> {
        let label = self.labels.iter().find(|other| other.name == label)?;
        label.place().map(|place| place.read(payload))
    }

    /// The text with this label in a message, up to its first zero byte.
    pub(super) fn text<'a>(&self, label: &str, payload: &'a [u8]) -> Option<&'a [u8]> {
        let label = self.labels.iter().find(|other| other.name == label)?;
        let bytes = payload.get(label.offset..label.offset + label.size)?;
        Some(bytes.split(|&byte| byte == 0).next().unwrap_or_default())
    }

    /// The number of the instance that a message belongs to; 0 if there is no such field.
    #[inline]
    pub(super) fn instance(&self, payload: &[u8]) -> u16 {
        self.instance.map_or(0, |place| place.read(payload) as u16)
    }

    /// Where samples of this instance go; `None` if they are not selected.
    #[inline]
    pub(super) fn open<S: Sink>(&mut self, instance: u16, tables: &Tables, sink: &mut S) -> Option<&Open> {
        let index = match self.streams.iter().position(|(other, _)| *other == instance) {
            Some(index) => index,
            None if self.streams.len() >= MAX_INSTANCES => return None,
            None => {
                let open = sink.open(&self.name, instance, &self.names).map(|stream| {
                    let place = |&field: &usize| self.fields.get(field).map(|field| field.place);
                    let places = stream.kept.iter().filter_map(place).collect();
                    Open { stream, places }
                });
                self.streams.push((instance, open));
                if let Some((_, Some(open))) = self.streams.last() {
                    for (kept, &field) in open.stream.kept.iter().enumerate() {
                        let unit = self.fields.get(field).and_then(|field| self.unit(field.label, tables));
                        sink.describe(&open.stream, kept, unit, Scale::ONE);
                    }
                }
                self.streams.len() - 1
            }
        };
        self.streams.get(index).and_then(|(_, open)| open.as_ref())
    }

    /// Takes the characters of `FMTU`. Returns the number of samples that had to be dropped because their instance was
    /// not known.
    pub(super) fn take_ids<S: Sink>(
        &mut self,
        units: &[u8],
        multipliers: &[u8],
        tables: &Tables,
        sink: &mut S,
    ) -> usize {
        let ids = (units.to_vec(), multipliers.to_vec());
        if self.ids.as_ref() == Some(&ids) {
            return 0;
        }
        self.ids = Some(ids);
        let instance = units.iter().position(|&id| id == b'#').and_then(|index| self.labels.get(index)?.place());
        let mut forgotten = 0;
        if instance != self.instance {
            for (_, open) in self.streams.drain(..) {
                forgotten += open.map_or(0, |open| sink.forget(&open.stream));
            }
            self.instance = instance;
        }
        self.describe(tables, sink);
        forgotten
    }

    /// Applies the units and multipliers known so far to the fields that have none yet.
    pub(super) fn describe<S: Sink>(&mut self, tables: &Tables, sink: &mut S) {
        let Some((units, multipliers)) = self.ids.clone() else { return };
        for index in 0..self.fields.len() {
            let Some(field) = self.fields.get(index).copied().filter(|field| !field.described) else { continue };
            let own = self.labels.get(field.label).is_some_and(|label| label.own_multiplier);
            let factor = multipliers.get(field.label).and_then(|id| tables.multipliers.get(id)).copied();
            let unit = units.get(field.label).and_then(|id| tables.units.get(id));
            if unit.is_none() && factor.is_none() {
                continue;
            }
            // The types c, C, e, E and L imply their factor, and MULT repeats it.
            let scale = if own { Scale::ONE } else { factor.map_or(Scale::ONE, Scale::new) };
            let unit = self.unit(field.label, tables).map(str::to_owned);
            if let Some(field) = self.fields.get_mut(index) {
                field.described = true;
                if scale != Scale::ONE {
                    field.place.scale = scale;
                }
            }
            for open in self.streams.iter_mut().filter_map(|(_, open)| open.as_mut()) {
                let Some(kept) = open.stream.kept.iter().position(|&field| field == index) else { continue };
                sink.describe(&open.stream, kept, unit.as_deref(), scale);
                if let Some(place) = open.places.get_mut(kept).filter(|_| scale != Scale::ONE) {
                    place.scale = scale;
                }
            }
        }
    }

    fn unit<'a>(&self, label: usize, tables: &'a Tables) -> Option<&'a str> {
        let id = self.ids.as_ref()?.0.get(label)?;
        let unit = tables.units.get(id)?.as_str();
        (!matches!(unit, "" | "UNKNOWN") && *id != b'#').then_some(unit)
    }
}

impl Label {
    fn place(&self) -> Option<Place> {
        self.number.map(|(kind, scale)| Place { offset: self.offset, kind, scale })
    }
}

/// The index of the label that is the time stamp, and the microseconds of one of its counts.
fn clock_of(name: &str, labels: &[Label]) -> Option<(usize, f64)> {
    let position = |wanted: &str| labels.iter().position(|label| label.name == wanted);
    match labels.first().map(|label| label.name.as_str()) {
        Some("TimeUS") => return Some((0, 1.0)),
        Some("TimeMS") => return Some((0, 1000.0)),
        _ => {}
    }
    // Until 2015 GPS messages had the time of week in TimeMS, and the clock of the autopilot in T.
    if matches!(name, "GPS" | "GPS2") { position("T").map(|index| (index, 1000.0)) } else { None }
}

/// How a type, given by a letter, is stored.
#[derive(Clone, Copy, Debug)]
struct Letter {
    size: usize,
    /// Type and factor of the number; `None` for text.
    number: Option<(Kind, Scale)>,
    own_multiplier: bool,
}

fn letter_of(letter: char) -> Option<Letter> {
    let number =
        |kind: Kind| Some(Letter { size: kind.size(), number: Some((kind, Scale::ONE)), own_multiplier: false });
    let scaled = |kind: Kind, factor: f64| {
        Some(Letter { size: kind.size(), number: Some((kind, Scale::new(factor))), own_multiplier: true })
    };
    let text = |size: usize| Some(Letter { size, number: None, own_multiplier: false });
    match letter {
        'a' => Some(Letter { size: 64, number: Some((Kind::I16, Scale::ONE)), own_multiplier: false }),
        'b' => number(Kind::I8),
        'B' | 'M' => number(Kind::U8),
        'h' => number(Kind::I16),
        'H' => number(Kind::U16),
        'i' => number(Kind::I32),
        'I' => number(Kind::U32),
        'q' => number(Kind::I64),
        'Q' => number(Kind::U64),
        'g' => number(Kind::F16),
        'f' => number(Kind::F32),
        'd' => number(Kind::F64),
        'c' => scaled(Kind::I16, 0.01),
        'C' => scaled(Kind::U16, 0.01),
        'e' => scaled(Kind::I32, 0.01),
        'E' => scaled(Kind::U32, 0.01),
        'L' => scaled(Kind::I32, 1e-7),
        'n' => text(4),
        'N' => text(16),
        'Z' => text(64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_has_its_size() {
        // Sizes of AP_Logger/LogStructure.h.
        let sizes = [("a", 64), ("bBM", 1), ("hHcCg", 2), ("iIeELf", 4), ("dqQ", 8), ("n", 4), ("N", 16), ("Z", 64)];
        for (letters, size) in sizes {
            for letter in letters.chars() {
                assert_eq!(letter_of(letter).map(|letter| letter.size), Some(size), "{letter}");
            }
        }
        assert!(letter_of('x').is_none());
    }

    #[test]
    fn a_definition_has_to_add_up() {
        let format = Format::new("IMU", 35, "QffffffI", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG").unwrap_err();
        assert!(format.contains("given as 35, but its types (QffffffI) take 39 bytes"), "{format}");
        assert!(Format::new("IMU", 11, "Q", "TimeUS,GyrX").unwrap_err().contains("2 columns"));
        assert!(Format::new("IMU", 4, "x", "a").unwrap_err().contains("'x'"));
        let format = Format::new("ISBD", 3 + 8 + 64, "Qa", "TimeUS,x").unwrap();
        assert_eq!((format.names.len(), format.names[31].as_str()), (32, "x[31]"));
        assert_eq!(format.fields[31].place.offset, 8 + 62);
    }
}
