//! Definitions of messages: which field is at which place.

use std::collections::HashMap;
use std::rc::Rc;

use crate::log::decode::{Kind, Place, Scale};
use crate::memory::{Account, Excess, many};

/// Largest size of a message, bytes.
const LARGEST: usize = u16::MAX as usize;
/// Largest depth of nested types.
const MAX_DEPTH: usize = 16;
/// Largest number of fields and elements that are laid out in one log. Without it a definition of a few bytes could
/// need gigabytes.
const MAX_LAID_OUT: usize = 500_000;

/// What a field takes besides its texts, bytes, with what the allocator adds to short ones.
const BYTES_PER_FIELD: usize = 128;

/// One field of a definition, such as `float[4] q`.
#[derive(Clone, Debug, PartialEq)]
struct Declared {
    type_name: String,
    /// Number of elements; `None` if it is no array.
    elements: Option<usize>,
    name: String,
}

/// A definition with nested types resolved: the place of every number.
#[derive(Debug, Default)]
pub(super) struct Layout {
    /// Names of the numeric fields, without the time stamp and padding.
    pub(super) names: Vec<String>,
    pub(super) places: Vec<Place>,
    /// The time stamp, microseconds; without it the samples have no time.
    pub(super) timestamp: Option<Place>,
    /// Size of a message without the padding at its end, which a writer may omit, bytes.
    pub(super) least: usize,
    /// Size of a message with the padding at its end, bytes.
    pub(super) most: usize,
}

impl Layout {
    /// The place of the numeric field with this name.
    pub(super) fn place(&self, name: &str) -> Option<Place> {
        let index = self.names.iter().position(|other| other == name)?;
        self.places.get(index).copied()
    }
}

/// The definitions of a log.
#[derive(Debug, Default)]
pub(super) struct Formats {
    declared: HashMap<String, Vec<Declared>>,
    laid_out: HashMap<String, Rc<Layout>>,
    work: usize,
}

impl Formats {
    /// Adds the text of a definition, `name:type field;type[4] field;`. `None` if the text is no definition.
    pub(super) fn add(&mut self, text: &str, account: &Account) -> Result<Option<()>, Excess> {
        // Counted before the text is taken apart: each of its fields becomes an entry with two texts of its own.
        let needs = |fields: usize, texts: usize| many(fields + 1, BYTES_PER_FIELD).saturating_add(many(1, texts));
        let held = needs(text.matches(';').count(), text.len());
        account.take(held)?;
        let Some((name, fields)) = parse(text).filter(|(name, fields)| self.declared.get(name) != Some(fields)) else {
            account.give_back(held);
            return Ok(parse(text).map(|_| ()));
        };
        self.laid_out.clear();
        if let Some(old) = self.declared.insert(name, fields) {
            let texts = old.iter().map(|field| field.name.len() + field.type_name.len()).sum();
            account.give_back(needs(old.len(), texts));
        }
        Ok(Some(()))
    }

    pub(super) fn knows(&self, name: &str) -> bool {
        self.declared.contains_key(name)
    }

    /// The layout of a message, computed once; the inner error says what is wrong with its definition.
    pub(super) fn layout(&mut self, name: &str, account: &Account) -> Result<Result<Rc<Layout>, String>, Excess> {
        if let Some(layout) = self.laid_out.get(name) {
            return Ok(Ok(Rc::clone(layout)));
        }
        let mut layout = Layout::default();
        let mut walk = Walk { declared: &self.declared, work: self.work, layout: &mut layout, end: 0, account };
        let done = walk.message(name, "", 0);
        let (work, end) = (walk.work, walk.end);
        self.work = work;
        match done {
            Err(Wrong::Definition(problem)) => {
                account.give_back(layout.names.iter().map(|name| many(1, name.len() + BYTES_PER_FIELD)).sum());
                return Ok(Err(problem));
            }
            Err(Wrong::Memory(excess)) => return Err(excess),
            Ok(()) => {}
        }
        layout.most = end;
        let layout = Rc::new(layout);
        self.laid_out.insert(name.to_owned(), Rc::clone(&layout));
        Ok(Ok(layout))
    }
}

/// The name and the fields of a definition.
fn parse(text: &str) -> Option<(String, Vec<Declared>)> {
    let (name, fields) = text.split_once(':')?;
    let fields = fields.split(';').map(str::trim).filter(|field| !field.is_empty());
    let declared = fields.map(|field| {
        let (type_name, name) = field.split_once(' ')?;
        let (type_name, elements) = match type_name.split_once('[') {
            Some((type_name, rest)) => (type_name, Some(rest.strip_suffix(']')?.parse().ok()?)),
            None => (type_name, None),
        };
        Some(Declared { type_name: type_name.to_owned(), elements, name: name.trim().to_owned() })
    });
    let declared: Option<Vec<Declared>> = declared.collect();
    Some((name.to_owned(), declared?)).filter(|(name, _)| is_name(name))
}

pub(super) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(is_name_byte)
}

pub(super) fn is_name_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'/')
}

/// Why a message cannot be laid out.
enum Wrong {
    Definition(String),
    Memory(Excess),
}

impl From<String> for Wrong {
    fn from(problem: String) -> Self {
        Wrong::Definition(problem)
    }
}

struct Walk<'a> {
    declared: &'a HashMap<String, Vec<Declared>>,
    work: usize,
    layout: &'a mut Layout,
    end: usize,
    account: &'a Account,
}

impl Walk<'_> {
    fn message(&mut self, name: &str, prefix: &str, depth: usize) -> Result<(), Wrong> {
        let declared = self.declared.get(name).ok_or_else(|| format!("the type '{name}' is not defined"))?;
        if depth > MAX_DEPTH {
            return Err(format!("its types are nested more than {MAX_DEPTH} deep").into());
        }
        for field in declared {
            for element in 0..field.elements.unwrap_or(1) {
                let name = match field.elements {
                    Some(_) => format!("{prefix}{}[{element}]", field.name),
                    None => format!("{prefix}{}", field.name),
                };
                self.work += 1;
                if self.work > MAX_LAID_OUT {
                    return Err(format!("the log defines more than {MAX_LAID_OUT} fields").into());
                }
                match kind(&field.type_name) {
                    None => self.message(&field.type_name, &format!("{name}."), depth + 1)?,
                    Some((kind, size)) => self.number(name, &field.name, kind, size)?,
                }
            }
        }
        Ok(())
    }

    fn number(&mut self, name: String, last_name: &str, kind: Option<Kind>, size: usize) -> Result<(), Wrong> {
        let offset = self.end;
        self.end += size;
        if self.end > LARGEST {
            return Err(format!("it is longer than {LARGEST} bytes").into());
        }
        let is_padding = last_name.starts_with("_padding");
        // Only the padding of the message itself may be omitted at its end, not that of a nested type.
        if !is_padding || name.contains('.') {
            self.layout.least = self.end;
        }
        if is_padding {
            return Ok(());
        }
        let Some(kind) = kind else { return Ok(()) };
        let place = Place { offset, kind, scale: Scale::ONE };
        if name == "timestamp" {
            if kind == Kind::U64 {
                self.layout.timestamp = Some(place);
            }
        } else {
            self.account.take(many(1, name.len() + BYTES_PER_FIELD)).map_err(Wrong::Memory)?;
            self.layout.names.push(name);
            self.layout.places.push(place);
        }
        Ok(())
    }
}

/// Kind and size of a basic type; a character has a size but no kind of number. `None` if it is no basic type.
pub(super) fn kind(type_name: &str) -> Option<(Option<Kind>, usize)> {
    let kind = match type_name {
        "int8_t" => Kind::I8,
        "uint8_t" | "bool" => Kind::U8,
        "int16_t" => Kind::I16,
        "uint16_t" => Kind::U16,
        "int32_t" => Kind::I32,
        "uint32_t" => Kind::U32,
        "int64_t" => Kind::I64,
        "uint64_t" => Kind::U64,
        "float" => Kind::F32,
        "double" => Kind::F64,
        "char" => return Some((None, 1)),
        _ => return None,
    };
    Some((Some(kind), kind.size()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Memory;

    fn add(formats: &mut Formats, text: &str) -> Option<()> {
        formats.add(text, &Account::new(Memory::default())).unwrap()
    }

    fn layout(formats: &mut Formats, name: &str) -> Result<Rc<Layout>, String> {
        formats.layout(name, &Account::new(Memory::default())).unwrap()
    }

    #[test]
    fn nested_arrays_padding_and_text() {
        let mut formats = Formats::default();
        add(&mut formats, "point:uint64_t timestamp;double lat;uint8_t[2] _padding0;").unwrap();
        add(&mut formats, "route:uint64_t timestamp;point[2] at;float[2] q;char[3] name;uint8_t[5] _padding0;")
            .unwrap();
        let layout = layout(&mut formats, "route").unwrap();
        let names = ["at[0].timestamp", "at[0].lat", "at[1].timestamp", "at[1].lat", "q[0]", "q[1]"];
        assert_eq!(layout.names, names);
        let offsets: Vec<usize> = layout.places.iter().map(|place| place.offset).collect();
        assert_eq!(offsets, [8, 16, 26, 34, 44, 48]);
        assert_eq!(layout.timestamp.map(|place| place.offset), Some(0));
        assert_eq!((layout.least, layout.most), (55, 60));
    }

    #[test]
    fn definitions_that_bite_their_tail_or_explode_are_refused() {
        let mut formats = Formats::default();
        add(&mut formats, "a:b x;").unwrap();
        add(&mut formats, "b:a x;").unwrap();
        assert!(layout(&mut formats, "a").unwrap_err().contains("deep"));
        add(&mut formats, "e:").unwrap();
        add(&mut formats, "d:e[65535] x;").unwrap();
        add(&mut formats, "c:d[65535] x;").unwrap();
        assert!(layout(&mut formats, "c").unwrap_err().contains("more than"));
        assert!(layout(&mut Formats::default(), "c").unwrap_err().contains("'c' is not defined"));
        let mut formats = Formats::default();
        add(&mut formats, "big:uint64_t timestamp;uint8_t[65530] x;").unwrap();
        assert!(layout(&mut formats, "big").unwrap_err().contains("longer than"));
        for text in [
            "",
            "x",
            ":",
            "a b:float x;",
            "a:float;",
            "a:float[ x;",
            "a:float[-1] x;",
            "a:float[9999999999999999999999] x;",
        ] {
            assert!(add(&mut formats, text).is_none(), "{text}");
        }
    }
}
