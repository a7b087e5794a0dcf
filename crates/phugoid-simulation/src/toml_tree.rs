//! A parsed TOML document for serde, in little machine code.
//!
//! The deserializer of the crate `toml` is compiled for every type with all that TOML can hold (dates, spans of values,
//! owned and borrowed text), several times over: for scenarios and cases that was more than a megabyte of the program.
//! Files of this project hold tables, lists, text, numbers and truth values, and this reads each of them where serde asks
//! for it. Messages and places are those of `toml`, but a list is no longer taken for a table whose keys are left out.

use std::fmt::Display;
use std::ops::Range;

use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Error as _, Expected, IntoDeserializer, MapAccess,
    SeqAccess, Unexpected, VariantAccess, Visitor, value::StrDeserializer,
};
use serde::forward_to_deserialize_any;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// Reads a value of any type from TOML.
pub(crate) fn read<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    let document = parse(text)?;
    T::deserialize(Node::of(&document))
}

fn parse(text: &str) -> Result<Spanned<DeValue<'_>>, TomlError> {
    let document = DeTable::parse(text).map_err(|error| TomlError::new(error.message().to_owned(), error.span()))?;
    let span = document.span();
    Ok(Spanned::new(span, DeValue::Table(document.into_inner())))
}

/// What is wrong with a document, and where: behind a pointer, since every value that is read may give one.
#[derive(Debug)]
pub(crate) struct TomlError(Box<Problem>);

#[derive(Debug)]
struct Problem {
    message: String,
    /// Bytes of the text; none until the value is known.
    span: Option<Range<usize>>,
}

impl TomlError {
    fn new(message: String, span: Option<Range<usize>>) -> Self {
        Self(Box::new(Problem { message, span }))
    }

    pub(crate) fn message(&self) -> &str {
        &self.0.message
    }

    pub(crate) fn span(&self) -> Option<Range<usize>> {
        self.0.span.clone()
    }

    /// The same at this place, if none within it is known.
    fn at(mut self, span: &Range<usize>) -> Self {
        self.0.span.get_or_insert_with(|| span.clone());
        self
    }
}

impl Display for TomlError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.message())
    }
}

impl std::error::Error for TomlError {}

impl serde::de::Error for TomlError {
    fn custom<T: Display>(message: T) -> Self {
        Self::new(message.to_string(), None)
    }
}

/// A value and where it stands.
#[derive(Clone)]
struct Node<'de> {
    value: &'de DeValue<'de>,
    span: Range<usize>,
}

/// A number of TOML in the type that holds it exactly.
enum Number {
    Signed(i64),
    Unsigned(u64),
    Float(f64),
}

impl<'de> Node<'de> {
    fn of(value: &'de Spanned<DeValue<'de>>) -> Self {
        Self { value: value.get_ref(), span: value.span() }
    }

    /// The value as a number; `None` if it is something else.
    fn number(&self) -> Option<Result<Number, TomlError>> {
        let number = match self.value {
            DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix())
                .map(Number::Signed)
                .or_else(|_| u64::from_str_radix(digits.as_str(), digits.radix()).map(Number::Unsigned))
                .map_err(|_| "integer number overflowed"),
            DeValue::Float(digits) => match digits.as_str().parse::<f64>() {
                Ok(value) if !value.is_infinite() || digits.as_str().contains("inf") => Ok(Number::Float(value)),
                _ => Err("floating-point number overflowed"),
            },
            _ => return None,
        };
        Some(number.map_err(|message| TomlError::new(message.to_owned(), Some(self.span.clone()))))
    }

    /// Another kind of value is here than the one that is wanted.
    fn mismatch(&self, wanted: &dyn Expected) -> TomlError {
        let found = match self.value {
            DeValue::String(text) => Unexpected::Str(text),
            DeValue::Boolean(value) => Unexpected::Bool(*value),
            DeValue::Array(_) => Unexpected::Seq,
            DeValue::Table(_) => Unexpected::Map,
            DeValue::Datetime(_) => Unexpected::Other("date or time"),
            DeValue::Integer(_) | DeValue::Float(_) => match self.number() {
                Some(Ok(Number::Signed(value))) => Unexpected::Signed(value),
                Some(Ok(Number::Unsigned(value))) => Unexpected::Unsigned(value),
                Some(Ok(Number::Float(value))) => Unexpected::Float(value),
                Some(Err(error)) => return error,
                None => Unexpected::Other("number"),
            },
        };
        TomlError::invalid_type(found, wanted).at(&self.span)
    }

    fn give_number<V: Visitor<'de>>(&self, visitor: V) -> Result<V::Value, TomlError> {
        match self.number() {
            Some(Ok(Number::Signed(value))) => visitor.visit_i64(value),
            Some(Ok(Number::Unsigned(value))) => visitor.visit_u64(value),
            Some(Ok(Number::Float(value))) => visitor.visit_f64(value),
            Some(Err(error)) => Err(error),
            None => Err(self.mismatch(&visitor)),
        }
        .map_err(|error| error.at(&self.span))
    }

    fn give_text<V: Visitor<'de>>(&self, visitor: V) -> Result<V::Value, TomlError> {
        match self.value {
            DeValue::String(text) => visitor.visit_str(text).map_err(|error: TomlError| error.at(&self.span)),
            _ => Err(self.mismatch(&visitor)),
        }
    }

    fn give_list<V: Visitor<'de>>(&self, visitor: V) -> Result<V::Value, TomlError> {
        match self.value {
            DeValue::Array(values) => {
                visitor.visit_seq(Items(values.iter())).map_err(|error: TomlError| error.at(&self.span))
            }
            _ => Err(self.mismatch(&visitor)),
        }
    }

    fn give_table<V: Visitor<'de>>(&self, visitor: V) -> Result<V::Value, TomlError> {
        match self.value {
            DeValue::Table(table) => {
                let entries = Entries { rest: Box::new(table.iter()), value: None };
                visitor.visit_map(entries).map_err(|error: TomlError| error.at(&self.span))
            }
            _ => Err(self.mismatch(&visitor)),
        }
    }
}

impl<'de> Deserializer<'de> for Node<'de> {
    type Error = TomlError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        match self.value {
            DeValue::String(_) => self.give_text(visitor),
            DeValue::Integer(_) | DeValue::Float(_) => self.give_number(visitor),
            DeValue::Boolean(value) => visitor.visit_bool(*value).map_err(|error: TomlError| error.at(&self.span)),
            DeValue::Array(_) => self.give_list(visitor),
            DeValue::Table(_) => self.give_table(visitor),
            DeValue::Datetime(_) => Err(self.mismatch(&visitor)),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        match self.value {
            DeValue::Boolean(value) => visitor.visit_bool(*value).map_err(|error: TomlError| error.at(&self.span)),
            _ => Err(self.mismatch(&visitor)),
        }
    }

    fn deserialize_i64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_number(visitor)
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_number(visitor)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_number(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_number(visitor)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_text(visitor)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_text(visitor)
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_text(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, TomlError> {
        let span = self.span.clone();
        visitor.visit_newtype_struct(self).map_err(|error: TomlError| error.at(&span))
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_list(visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, TomlError> {
        self.give_list(visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TomlError> {
        self.give_table(visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TomlError> {
        self.give_table(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TomlError> {
        let chosen = match self.value {
            DeValue::String(name) => Chosen { name, name_at: self.span.clone(), content: None },
            DeValue::Table(table) if table.len() == 1 => match table.iter().next() {
                Some((name, content)) => {
                    Chosen { name: name.get_ref(), name_at: name.span(), content: Some(Node::of(content)) }
                }
                None => return Err(self.mismatch(&visitor)),
            },
            DeValue::Table(table) => {
                let message = format!("wanted a table with one key, found {}", table.len());
                return Err(TomlError::new(message, Some(self.span)));
            }
            _ => return Err(TomlError::new("wanted string or table".to_owned(), Some(self.span))),
        };
        visitor.visit_enum(chosen).map_err(|error: TomlError| error.at(&self.span))
    }

    forward_to_deserialize_any! {
        u8 u16 u128 i8 i16 i32 i128 f32 char bytes byte_buf unit unit_struct tuple_struct ignored_any
    }
}

/// The values of a list.
struct Items<'de>(std::slice::Iter<'de, Spanned<DeValue<'de>>>);

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = TomlError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, TomlError> {
        self.0.next().map(|value| seed.deserialize(Node::of(value))).transpose()
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.0.len())
    }
}

type Entry<'de> = (&'de Spanned<DeString<'de>>, &'de Spanned<DeValue<'de>>);

/// The keys of a table with their values.
struct Entries<'de> {
    rest: Box<dyn Iterator<Item = Entry<'de>> + 'de>,
    value: Option<Node<'de>>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = TomlError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, TomlError> {
        let Some((key, value)) = self.rest.next() else { return Ok(None) };
        self.value = Some(Node::of(value));
        seed.deserialize(text_of(key.get_ref())).map(Some).map_err(|error| error.at(&key.span()))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, TomlError> {
        let Some(value) = self.value.take() else {
            return Err(TomlError::custom("a value was asked for before its key"));
        };
        let span = value.span.clone();
        seed.deserialize(value).map_err(|error| error.at(&span))
    }
}

fn text_of(text: &str) -> StrDeserializer<'_, TomlError> {
    text.into_deserializer()
}

/// One of several forms: its name, and what stands under it unless the name says all.
struct Chosen<'de> {
    name: &'de str,
    name_at: Range<usize>,
    content: Option<Node<'de>>,
}

impl<'de> EnumAccess<'de> for Chosen<'de> {
    type Error = TomlError;
    type Variant = Content<'de>;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Content<'de>), TomlError> {
        let name = seed.deserialize(text_of(self.name)).map_err(|error| error.at(&self.name_at))?;
        Ok((name, Content(self.content)))
    }
}

struct Content<'de>(Option<Node<'de>>);

impl<'de> Content<'de> {
    fn node(self, wanted: &dyn Expected) -> Result<Node<'de>, TomlError> {
        self.0.ok_or_else(|| TomlError::invalid_type(Unexpected::UnitVariant, wanted))
    }
}

impl<'de> VariantAccess<'de> for Content<'de> {
    type Error = TomlError;

    fn unit_variant(self) -> Result<(), TomlError> {
        let Some(Node { value, span }) = self.0 else { return Ok(()) };
        let message = match value {
            DeValue::Table(table) if table.is_empty() => return Ok(()),
            DeValue::Table(_) => "expected empty table".to_owned(),
            other => format!("expected table, found {}", other.type_str()),
        };
        Err(TomlError::new(message, Some(span)))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, TomlError> {
        seed.deserialize(self.node(&"newtype variant")?)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, TomlError> {
        let node = self.node(&"tuple variant")?;
        match node.value {
            DeValue::Array(values) if values.len() != length => {
                Err(TomlError::new(format!("expected tuple with length {length}"), Some(node.span)))
            }
            _ => node.give_list(visitor),
        }
    }

    /// Refuses what the form does not know: serde itself does so for a structure of its own alone.
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TomlError> {
        let node = self.node(&"struct variant")?;
        if let DeValue::Table(table) = node.value {
            only_known_keys(table, fields)?;
        }
        node.give_table(visitor)
    }
}

fn only_known_keys(table: &DeTable<'_>, fields: &[&str]) -> Result<(), TomlError> {
    let unknown: Vec<_> = table.keys().filter(|key| !fields.contains(&key.get_ref().as_ref())).collect();
    let Some(first) = unknown.first() else { return Ok(()) };
    let names: Vec<&str> = unknown.iter().map(|key| key.get_ref().as_ref()).collect();
    let message = format!("unexpected keys in table: {}, available keys: {}", names.join(", "), fields.join(", "));
    Err(TomlError::new(message, Some(first.span())))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::fmt::Debug;

    use serde::Deserialize;

    use super::*;

    /// Everything that scenarios and cases ask serde for.
    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Everything {
        name: String,
        #[serde(default)]
        maybe: Option<f64>,
        #[serde(default)]
        count: u32,
        #[serde(default)]
        seed: u64,
        #[serde(default)]
        signed: i64,
        #[serde(default)]
        on: bool,
        #[serde(default)]
        list: Vec<f64>,
        #[serde(default)]
        pair: Option<(f64, String)>,
        #[serde(default)]
        by_name: BTreeMap<String, Inner>,
        #[serde(default)]
        form: Option<Form>,
        #[serde(default)]
        either: Option<Either>,
        #[serde(default)]
        tagged: Option<Tagged>,
        #[serde(default)]
        wrapped: Option<Wrapped>,
        #[serde(default)]
        open: Option<Open>,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        value: f64,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Form {
        Plain,
        Number(f64),
        Table { value: f64 },
        Pair(f64, f64),
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(untagged)]
    enum Either {
        Number(f64),
        Text(String),
        Table(Inner),
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(tag = "kind", rename_all = "kebab-case")]
    enum Tagged {
        First { value: f64 },
        Second,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    struct Wrapped(f64);

    #[derive(Debug, PartialEq, Deserialize)]
    struct Open {
        #[serde(flatten)]
        rest: BTreeMap<String, f64>,
    }

    /// What is read, or the message and its place.
    type Read<T> = Result<T, (String, Option<Range<usize>>)>;

    fn both<T: DeserializeOwned + Debug + PartialEq>(text: &str) -> (Read<T>, Read<T>) {
        let ours = read(text).map_err(|error| (error.message().to_owned(), error.span()));
        (ours, toml::from_str(text).map_err(|error| (error.message().to_owned(), error.span())))
    }

    #[test]
    fn values_messages_and_places_are_those_of_toml() {
        let good = [
            "",
            "maybe = 2",
            "maybe = -1.5e-3",
            "maybe = inf",
            "count = 0x1F",
            "seed = 18446744073709551615",
            "signed = -1_000",
            "on = true",
            "list = [1, 2.5, -0.0, 1e300]",
            "pair = [1, 'two']",
            "by_name = { b = { value = 1 }, a = { value = 2.5 } }",
            "form = 'plain'",
            "form = { plain = {} }",
            "form = { number = 2 }",
            "form = { table = { value = 3 } }",
            "form = { pair = [1, 2] }",
            "either = 1.5",
            "either = 2",
            "either = 'a \"quoted\" word'",
            "either = { value = 3 }",
            "tagged = { kind = 'first', value = 1 }",
            "tagged = { kind = 'second' }",
            "wrapped = 2",
            "open = { x = 1, y = 2.5 }",
            "[by_name.c]\nvalue = 4",
        ];
        for more in good {
            let (ours, theirs) = both::<Everything>(&format!("name = 'n'\n{more}"));
            assert!(ours.is_ok(), "{more}: {ours:?}");
            assert_eq!(ours, theirs, "{more}");
        }
        let bad = [
            "maybe = 'text'",
            "maybe = [1]",
            "count = -1",
            "count = 4294967296",
            "count = 1.5",
            "seed = 340282366920938463463374607431768211456",
            "maybe = 1e999",
            "on = 1",
            "on = 'true'",
            "list = 1",
            "list = [1, 'two']",
            "pair = [1]",
            "by_name = { a = 1 }",
            "by_name = { a = {} }",
            "by_name = { a = { value = 1, other = 2 } }",
            "[by_name.a]\nvalue = true",
            "form = 'none'",
            "form = 'number'",
            "form = 3",
            "form = { number = 'x' }",
            "form = { none = 1 }",
            "form = { table = { } }",
            "form = { plain = 2 }",
            "form = { plain = { x = 1 } }",
            "form = { table = { value = 1, other = 2, more = 3 } }",
            "form = { pair = [1, 2, 3] }",
            "either = true",
            "tagged = { kind = 'third' }",
            "tagged = { value = 1 }",
            "wrapped = 'x'",
            "open = { x = 'y' }",
            "unknown = 1",
            "name = 'twice'",
            "list = [1, 2",
            "count = ",
        ];
        for more in bad {
            let (ours, theirs) = both::<Everything>(&format!("name = 'n'\n{more}"));
            assert!(ours.is_err(), "{more}: {ours:?}");
            assert_eq!(ours, theirs, "{more}");
        }
        assert_eq!(both::<Everything>("maybe = 1").0, both::<Everything>("maybe = 1").1, "a key is missing at the top");
    }

    #[test]
    fn a_list_is_no_table_and_a_date_no_text() {
        let error = read::<Everything>("name = 'n'\nby_name = { a = [1] }").unwrap_err();
        assert!(error.message().starts_with("invalid type: sequence, expected struct Inner"), "{error}");
        let error = read::<Everything>("name = 2026-01-01").unwrap_err();
        assert!(error.message().contains("date or time") && error.span() == Some(7..17), "{error:?}");
        let error = read::<Everything>("name = 'n'\nform = { plain = {}, number = 1 }").unwrap_err();
        assert!(error.message().contains("one key, found 2"), "{error}");
    }
}
