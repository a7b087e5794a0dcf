//! Values and tables out of JSON files, each checked; errors name the file and the key.

use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::axis::Axis;
use super::error::TransportError;

/// Largest file that is read, bytes: five times the largest table.
const MOST_BYTES: u64 = 4 << 20;
/// Longest excerpt of a file in a message, characters.
const EXCERPT: usize = 60;

/// A JSON file.
pub(crate) struct Document {
    file: PathBuf,
    root: Value,
}

impl Document {
    /// Reads and parses a file.
    pub(crate) fn open(file: PathBuf) -> Result<Self, TransportError> {
        let read_error = |source| TransportError::Read { file: file.clone(), source };
        let mut bytes = Vec::new();
        let opened = std::fs::File::open(&file).map_err(read_error)?;
        opened.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(read_error)?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(TransportError::TooLarge { file, most: MOST_BYTES });
        }
        match serde_json::from_slice(&bytes) {
            Ok(root) => Ok(Self { file, root }),
            Err(source) => Err(TransportError::Json { file, source }),
        }
    }

    /// The outermost value.
    pub(crate) fn root(&self) -> Node<'_> {
        Node { file: &self.file, key: String::new(), value: &self.root }
    }
}

/// A value of a file and where it is.
#[derive(Clone)]
pub(crate) struct Node<'a> {
    file: &'a Path,
    key: String,
    value: &'a Value,
}

impl<'a> Node<'a> {
    /// An error about this value.
    pub(crate) fn error(&self, problem: impl Into<String>) -> TransportError {
        let key = if self.key.is_empty() { "the whole file".to_owned() } else { self.key.clone() };
        TransportError::Content { file: self.file.into(), key, problem: problem.into() }
    }

    /// The value of a key of this object.
    pub(crate) fn get(&self, key: &str) -> Result<Node<'a>, TransportError> {
        let here = if self.key.is_empty() { key.to_owned() } else { format!("{}.{key}", self.key) };
        match self.value.get(key) {
            Some(value) => Ok(Node { file: self.file, key: here, value }),
            None => Err(Node { file: self.file, key: here, value: self.value }.error("missing")),
        }
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Result<f64, TransportError> {
        self.value.as_f64().filter(|x| x.is_finite()).ok_or_else(|| self.error("expected a finite number"))
    }

    /// A positive number.
    pub(crate) fn positive(&self) -> Result<f64, TransportError> {
        let x = self.number()?;
        if x > 0.0 { Ok(x) } else { Err(self.error(format!("is {x}, expected a positive number"))) }
    }

    /// A string.
    pub(crate) fn text(&self) -> Result<&'a str, TransportError> {
        self.value.as_str().ok_or_else(|| self.error("expected a string"))
    }

    /// The items of an array.
    pub(crate) fn items(&self) -> Result<Vec<Node<'a>>, TransportError> {
        let items = self.value.as_array().ok_or_else(|| self.error("expected an array"))?;
        let node = |(i, value)| Node { file: self.file, key: format!("{}[{i}]", self.key), value };
        Ok(items.iter().enumerate().map(node).collect())
    }

    /// An array of finite numbers, without a place of its own for each until one is wrong.
    pub(crate) fn numbers(&self) -> Result<Vec<f64>, TransportError> {
        let items = self.value.as_array().ok_or_else(|| self.error("expected an array of numbers"))?;
        let number = |(i, value): (usize, &'a Value)| {
            Node { file: self.file, key: format!("{}[{i}]", self.key), value }.number()
        };
        let plain = |(i, value): (usize, &'a Value)| match value.as_f64() {
            Some(x) if x.is_finite() => Ok(x),
            _ => number((i, value)),
        };
        items.iter().enumerate().map(plain).collect()
    }

    /// An array of exactly `N` finite numbers.
    pub(crate) fn vector<const N: usize>(&self) -> Result<[f64; N], TransportError> {
        let numbers = self.numbers()?;
        let found = numbers.len();
        numbers.try_into().map_err(|_| self.error(format!("has {found} numbers, expected {N}")))
    }

    /// Checks that an array holds these strings in this order.
    pub(crate) fn expect_texts(&self, expected: &[&str]) -> Result<(), TransportError> {
        let items = self.items()?;
        if items.len() != expected.len() {
            return Err(self.error(format!("has {} entries, expected {}", items.len(), expected.len())));
        }
        items.iter().zip(expected).try_for_each(|(item, expected)| item.expect_text(expected))
    }

    fn expect_text(&self, expected: &str) -> Result<(), TransportError> {
        let found = self.text()?;
        if found == expected {
            return Ok(());
        }
        let found: String = found.chars().take(EXCERPT).collect();
        Err(self.error(format!("is \"{found}\", expected \"{expected}\"")))
    }
}

/// What an axis of a table has to be.
pub(crate) enum Expected<'a> {
    /// Increasing numbers, in the unit of the file times a factor.
    Numbers(f64),
    /// These words.
    Words(&'a [&'a str]),
}

/// A table with `K` components: its numeric axes in order and its data, the last axis fastest.
pub(crate) struct Table<const K: usize> {
    /// Axes of numbers; those of words have a fixed length.
    pub(crate) axes: Vec<Axis>,
    pub(crate) data: Vec<[f64; K]>,
}

impl<const K: usize> Table<K> {
    /// Reads `folder/tables/name.json`, which has to have these axes and components.
    pub(crate) fn read(
        folder: &Path,
        name: &str,
        axes: &[(&str, Expected<'_>)],
        components: [&str; K],
    ) -> Result<Self, TransportError> {
        let document = Document::open(folder.join("tables").join(format!("{name}.json")))?;
        let root = document.root();
        root.get("components")?.expect_texts(&components)?;
        let listed = root.get("axes")?;
        let nodes = listed.items()?;
        if nodes.len() != axes.len() {
            return Err(listed.error(format!("{} axes, expected {}", nodes.len(), axes.len())));
        }
        let mut numeric = Vec::new();
        let mut lengths = Vec::new();
        for (node, (name, expected)) in nodes.iter().zip(axes) {
            node.get("name")?.expect_text(name)?;
            let values = node.get("values")?;
            match expected {
                Expected::Numbers(factor) => {
                    let points: Vec<f64> = values.numbers()?.iter().map(|x| x * factor).collect();
                    lengths.push(points.len());
                    let problem = "expected at least two numbers, each larger than the one before it";
                    numeric.push(Axis::new(points).ok_or_else(|| values.error(problem))?);
                }
                Expected::Words(words) => {
                    values.expect_texts(words)?;
                    lengths.push(words.len());
                }
            }
        }
        lengths.push(K);
        let shape = root.get("shape")?;
        let stated = shape.numbers()?;
        if stated.len() != lengths.len() || stated.iter().zip(&lengths).any(|(stated, found)| *stated != *found as f64)
        {
            return Err(shape.error(format!("is {stated:?}, but axes and components have {lengths:?} entries")));
        }
        let data = root.get("data")?;
        let numbers = data.numbers()?;
        let expected = lengths.iter().try_fold(1_usize, |product, length| product.checked_mul(*length));
        if expected != Some(numbers.len()) {
            let expected = expected.map_or("more than can be".to_owned(), |n| n.to_string());
            return Err(data.error(format!("has {} numbers, the axes need {expected}", numbers.len())));
        }
        let (rows, _) = numbers.as_chunks::<K>();
        Ok(Self { axes: numeric, data: rows.to_vec() })
    }
}
