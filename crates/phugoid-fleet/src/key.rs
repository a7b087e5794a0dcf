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

/// SHA-256 of a log and its length in bytes: of a file, or of all files of a folder that is one log.
///
/// # Errors
/// What the operating system says.
pub fn hash_log(path: &Path) -> io::Result<(String, u64)> {
    if path.is_dir() { hash_files_in(path) } else { hash_file(path) }
}

/// SHA-256 of the names and the contents of all files in a folder, and their length in bytes. Folders in it do not count.
///
/// # Errors
/// What the operating system says.
pub fn hash_files_in(folder: &Path) -> io::Result<(String, u64)> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        paths.extend(Some(entry?.path()).filter(|path| path.is_file()));
    }
    paths.sort();
    let (mut listed, mut length) = (String::new(), 0);
    for path in paths {
        let (hash, bytes) = hash_file(&path)?;
        let name = path.file_name().unwrap_or_default().as_encoded_bytes();
        let _ = writeln!(listed, "{hash} {}", digits(name));
        length += bytes;
    }
    Ok((hash(listed.as_bytes()), length))
}

/// The key of a unit of work: the hash of named parts, with the schema and the version of this program. The names keep
/// two parts from running into one another.
pub fn key(parts: &[(&str, &str)]) -> String {
    let mut hasher = Hasher::new();
    parts.iter().for_each(|(name, value)| hasher.part(name, value));
    hasher.digits()
}

/// A key of which the parts come one after another, as many as there are.
pub struct Hasher(Sha256);

impl Hasher {
    /// A key of no parts, with the schema and the version of this program.
    pub fn new() -> Self {
        Self(Sha256::new_with_prefix(format!("schema {SCHEMA}\nversion {VERSION}\n")))
    }

    /// Adds a part. Its length keeps a value with line feeds from looking like two parts.
    pub fn part(&mut self, name: &str, value: &str) {
        self.0.update(format!("{name} {} ", value.len()));
        self.0.update(value);
        self.0.update("\n");
    }

    /// The key, as 64 hexadecimal digits.
    pub fn digits(self) -> String {
        digits(&self.0.finalize())
    }
}

impl Default for Hasher {
    fn default() -> Self {
        Self::new()
    }
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
    fn a_folder_has_the_hash_of_the_names_and_contents_of_its_files() {
        let folder = std::env::temp_dir().join(format!("phugoid-fleet-hash-folder-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("below")).unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
        let of = || hash_files_in(&folder).unwrap();
        write("a", "1");
        write("b", "22");
        let first = of();
        assert_eq!(first.1, 3);
        write("below/c", "3");
        assert_eq!(of(), first);
        write("b", "23");
        assert_ne!(of().0, first.0);
        write("b", "22");
        std::fs::rename(folder.join("b"), folder.join("d")).unwrap();
        assert_ne!(of().0, first.0);
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(hash_files_in(&folder).is_err());
    }

    /// Stores that there are keep their keys.
    #[test]
    fn a_key_is_the_hash_of_its_parts_with_their_lengths() {
        let text = format!("schema {SCHEMA}\nversion {VERSION}\nlog 1 a\nmodel 3 b\nc\n");
        assert_eq!(key(&[("log", "a"), ("model", "b\nc")]), hash(text.as_bytes()));
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
