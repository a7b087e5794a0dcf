//! A part of the work for one of several machines, as arrays of SLURM and jobs of CI take it.

use std::fmt;
use std::str::FromStr;

/// The `i`-th of `n` parts, written `i/n` with `i` from 1.
///
/// A unit of work belongs to a shard by its content alone. Shards therefore need not know of one another, a log that
/// stands in two folders is in one of them, and a log that is added moves no other.
///
/// ```
/// use phugoid_fleet::shard::Shard;
/// let shard: Shard = "2/3".parse()?;
/// assert_eq!(shard.to_string(), "2/3");
/// assert!("0/3".parse::<Shard>().is_err() && "4/3".parse::<Shard>().is_err());
/// let hash = phugoid_fleet::key::hash(b"a log");
/// let owners = (1..=3).filter(|i| format!("{i}/3").parse::<Shard>().is_ok_and(|shard| shard.has(&hash)));
/// assert_eq!(owners.count(), 1);
/// # Ok::<(), phugoid_fleet::shard::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    count: u64,
}

/// What is wrong with a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShardError {
    /// Not two whole numbers with a slash between them.
    #[error("`{word}` is no shard: expected i/n, such as 1/8")]
    NotAShard {
        /// What was given.
        word: String,
    },
    /// The first number is not one of 1 to n.
    #[error("shard {index}/{count}: the first number runs from 1 to the second")]
    Range {
        /// The first number.
        index: u64,
        /// The second number.
        count: u64,
    },
}

impl Shard {
    /// All of the work.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether the unit with this hash (hexadecimal digits) belongs to this shard.
    pub fn has(self, hash: &str) -> bool {
        let number = hash.get(..15).and_then(|digits| u64::from_str_radix(digits, 16).ok()).unwrap_or(0);
        number % self.count == self.index - 1
    }
}

impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(word: &str) -> Result<Self, ShardError> {
        let number = |text: &str| text.trim().parse::<u64>().ok();
        let pair = word.split_once('/').and_then(|(index, count)| Some((number(index)?, number(count)?)));
        let (index, count) = pair.ok_or_else(|| ShardError::NotAShard { word: word.to_owned() })?;
        if (1..=count).contains(&index) { Ok(Self { index, count }) } else { Err(ShardError::Range { index, count }) }
    }
}
