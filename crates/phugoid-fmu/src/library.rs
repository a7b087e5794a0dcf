//! The shared library that runs in an FMU: which one it is, and for which machine.

use std::path::{Path, PathBuf};

use crate::resources::FORMAT;

/// What every such library has in it, followed by format, version and platform.
const BEGINNING: &str = "phugoid-fmi;format=";
/// Longest mark that is looked for, bytes.
const LONGEST: usize = 200;
/// Largest library that is read, bytes: several times that of one without optimisation and with all that debuggers want.
const MOST_BYTES: u64 = 1 << 30;

/// A shared library with the functions of FMI 3.0, for one kind of machine.
#[derive(Clone, Debug)]
pub struct Library {
    /// The bytes of the file.
    pub bytes: Vec<u8>,
    /// The machine, as FMI 3.0 names it: `x86_64-linux`.
    pub platform: String,
    /// The version of Phugoid that it was built of.
    pub version: String,
    /// What ends the name of its file: `.so`, `.dylib` or `.dll`.
    pub ending: &'static str,
}

/// Why a file is no library that can run in an FMU.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// The file cannot be read.
    #[error("the library `{}` cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// It is something else.
    #[error(
        "`{}` is no library of Phugoid for FMI 3.0. `cargo build --release -p phugoid-fmi` builds it: \
         target/release/{}", file.display(), file_name()
    )]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// It reads another format of resources than this program writes.
    #[error(
        "the library `{}` is of Phugoid {version} and reads resources of format {format}; this program writes format {FORMAT}: build \
         both from the same sources", file.display()
    )]
    Format {
        /// The file.
        file: PathBuf,
        /// Its version.
        version: String,
        /// The format that it reads.
        format: String,
    },
}

/// Name of the file that cargo makes of the crate `phugoid-fmi` on this machine.
fn file_name() -> String {
    format!("{}phugoid_fmi{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

impl Library {
    /// The name of the library's file on this machine: `libphugoid_fmi.so`.
    pub fn file_name() -> String {
        file_name()
    }

    /// Reads a library and looks which one it is.
    ///
    /// # Errors
    /// [`LibraryError`]: a file that cannot be read, another file, one that reads other resources.
    pub fn open(file: &Path) -> Result<Self, LibraryError> {
        use std::io::Read as _;

        let unreadable = |source| LibraryError::Unreadable { file: file.into(), source };
        let mut bytes = Vec::new();
        std::fs::File::open(file).map_err(unreadable)?.take(MOST_BYTES).read_to_end(&mut bytes).map_err(unreadable)?;
        let foreign = || LibraryError::Foreign { file: file.into() };
        let mark = mark(&bytes).ok_or_else(foreign)?;
        let [format, version, platform] = mark;
        if format != FORMAT.to_string() {
            return Err(LibraryError::Format { file: file.into(), version, format });
        }
        let ending = match platform.rsplit_once('-').map(|(_, system)| system) {
            Some("windows") => ".dll",
            Some("darwin") => ".dylib",
            Some(_) => ".so",
            None => return Err(foreign()),
        };
        Ok(Self { bytes, platform, version, ending })
    }
}

/// Format, version and platform of the mark in a library.
fn mark(bytes: &[u8]) -> Option<[String; 3]> {
    // The beginning also stands in the constant of this file, where this file was linked into the library: without an end.
    let begins = bytes.windows(BEGINNING.len()).enumerate().filter(|(_, part)| *part == BEGINNING.as_bytes());
    begins.map(|(at, _)| at + BEGINNING.len()).find_map(|at| {
        let rest = &bytes[at..bytes.len().min(at + LONGEST)];
        let end = rest.windows(2).position(|part| part == b";\n")?;
        let text = std::str::from_utf8(&rest[..end]).ok()?;
        let (format, text) = text.split_once(";version=")?;
        let (version, platform) = text.split_once(";platform=")?;
        let is_word = |word: &str| {
            !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-' | '+'))
        };
        [format, version, platform]
            .iter()
            .all(|word| is_word(word))
            .then(|| [format, version, platform].map(str::to_owned))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_found_among_other_bytes() {
        let library =
            b"\x7fELF phugoid-fmi;format= \xff\0phugoid-fmi;format=1;version=0.1.0;platform=x86_64-linux;\n\0\0";
        assert_eq!(mark(library), Some(["1", "0.1.0", "x86_64-linux"].map(str::to_owned)));
        assert_eq!(mark(b"phugoid-fmi;format=1;version=0.1.0;platform=../../etc;\n"), None);
        assert_eq!(mark(b"phugoid-fmi;format=1;version=0.1.0;platform=x86_64-linux"), None);
        assert_eq!(mark(b""), None);
    }
}
