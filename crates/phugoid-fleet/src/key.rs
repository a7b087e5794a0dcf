//! What makes a unit of work the same as an earlier one: the content of the flight, the text of the model, the options
//! that change a result, the schema of the rows and the version of the program.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::row::SCHEMA;

/// Version of this program, part of every key.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// SHA-256 as 64 hexadecimal digits.
///
/// ```
/// let hash = phugoid_fleet::key::hash(b"abc");
/// assert!(hash.starts_with("ba7816bf8f01cfea") && hash.len() == 64);
/// ```
pub fn hash(bytes: &[u8]) -> String {
    digits(&Sha256::digest(bytes))
}

/// SHA-256 of a file, and its length in bytes. The file is read piece by piece, so that its size does not matter.
///
/// # Errors
/// What the operating system says.
pub fn hash_file(path: &Path) -> io::Result<(String, u64)> {
    let mut file = File::open(path)?;
    let (mut hasher, mut piece, mut length) = (Sha256::new(), vec![0_u8; 1 << 18], 0);
    loop {
        let read = match file.read(&mut piece) {
            Ok(0) => return Ok((digits(&hasher.finalize()), length)),
            Ok(read) => read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        hasher.update(piece.get(..read).unwrap_or_default());
        length += read as u64;
    }
}

/// The key of a unit of work: the hash of named parts, with the schema and the version of this program. The names keep
/// two parts from running into one another.
pub fn key(parts: &[(&str, &str)]) -> String {
    let mut text = format!("schema {SCHEMA}\nversion {VERSION}\n");
    for (name, value) in parts {
        // Writing to a string cannot fail. The length keeps a value with line feeds from looking like two parts.
        let _ = writeln!(text, "{name} {} {value}", value.len());
    }
    hash(text.as_bytes())
}

fn digits(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_hash_of_its_content() {
        let path = std::env::temp_dir().join(format!("phugoid-fleet-hash-{}", std::process::id()));
        let content: Vec<u8> = (0..1_000_000_u32).map(|k| k as u8).collect();
        std::fs::write(&path, &content).unwrap();
        assert_eq!(hash_file(&path).unwrap(), (hash(&content), 1_000_000));
        std::fs::remove_file(&path).unwrap();
        assert!(hash_file(&path).is_err());
    }

    #[test]
    fn keys_differ_with_every_part_and_where_a_part_ends() {
        let one = key(&[("log", "a"), ("model", "b")]);
        assert_eq!(one, key(&[("log", "a"), ("model", "b")]));
        for other in [key(&[("log", "a"), ("model", "c")]), key(&[("log", "a")]), key(&[("log", "a\nmodel 1 b")])] {
            assert_ne!(one, other);
        }
    }
}
