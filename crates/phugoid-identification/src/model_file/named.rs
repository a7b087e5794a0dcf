//! Model files by what a user calls them: the name of one that is built in, or a file.

use std::path::{Path, PathBuf};

use phugoid_flight_data::reader::{ReadError, ReadOptions, read_path};
use phugoid_flight_data::record::Record;

use super::error::ModelFileError;
use super::file::ModelFile;
use crate::core::words::nearest;

/// Why there is no model under a name or in a file.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// No model of this name is built in.
    #[error("there is no built-in model `{name}`\n{}", hint(*nearest))]
    Unknown {
        /// The name that was asked for.
        name: String,
        /// The built-in name that is most similar, if one is similar at all.
        nearest: Option<&'static str>,
    },
    /// The file cannot be read, and its name is not that of a built-in model.
    #[error("cannot read the model file `{}`: {source}\n{}", .path.display(), hint(*nearest))]
    Unreadable {
        /// The file that was asked for.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
        /// The built-in name that is most similar, if one is similar at all.
        nearest: Option<&'static str>,
    },
    /// The file is no text in UTF-8.
    #[error("{}, line {line}: {found}. Save the file as UTF-8, as the editor offers it when it saves", .path.display())]
    NotUtf8 {
        /// The file that was asked for.
        path: PathBuf,
        /// The line of the first character that cannot be read, from 1.
        line: usize,
        /// What is there instead, as a clause.
        found: String,
    },
    /// The text is not a model file.
    #[error(transparent)]
    Wrong(#[from] ModelFileError),
}

fn hint(nearest: Option<&str>) -> String {
    match nearest {
        Some(near) => format!("Did you mean the built-in model `{near}`?"),
        None => format!(
            "Built-in models: {}. Start your own from one: phugoid estimate --show-model f16 > mine.toml",
            names().collect::<Vec<_>>().join(", ")
        ),
    }
}

fn names() -> impl Iterator<Item = &'static str> {
    ModelFile::BUILT_IN.iter().map(|(name, _)| *name)
}

impl ModelFile {
    /// The model files built into the library, in the order in which they are listed: name and text (TOML). The first
    /// four are whole models to start one's own from; the others belong to the built-in scenarios of the F-16.
    pub const BUILT_IN: &[(&'static str, &'static str)] = &[
        ("f16", include_str!("../../../../data/models/f16.toml")),
        ("f16-lateral", include_str!("../../../../data/models/f16-lateral.toml")),
        ("f16-six", include_str!("../../../../data/models/f16-six.toml")),
        ("hfb320", include_str!("../../../../data/models/hfb320.toml")),
        ("f16-model", include_str!("../../../../scenarios/f16-model.toml")),
        ("f16-thesis-model", include_str!("../../../../scenarios/f16-thesis-model.toml")),
        ("f16-damage-model", include_str!("../../../../scenarios/f16-damage-model.toml")),
        ("f16-gust-model", include_str!("../../../../scenarios/f16-gust-model.toml")),
        ("f16-recovery-model", include_str!("../../../../scenarios/f16-recovery-model.toml")),
        ("f16-health-model", include_str!("../../../../scenarios/f16-health-model.toml")),
    ];

    /// The text (TOML) of the built-in model with this name, to start one's own from.
    ///
    /// ```
    /// use phugoid_identification::model_file::ModelFile;
    /// let text = ModelFile::text("hfb320")?;
    /// assert!(ModelFile::parse("mine.toml", &text.replace("CL_alpha", "CL_aplha")).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Unknown`].
    pub fn text(name: &str) -> Result<&'static str, ModelError> {
        let found = Self::BUILT_IN.iter().find(|(known, _)| *known == name);
        let unknown = || ModelError::Unknown { name: name.to_owned(), nearest: nearest(name, names()) };
        found.map(|(_, text)| *text).ok_or_else(unknown)
    }

    /// The built-in model with this name.
    ///
    /// ```
    /// use phugoid_identification::model_file::{ModelError, ModelFile};
    /// let model = ModelFile::named("hfb320")?;
    /// assert_eq!(model.estimated().count(), 11);
    /// let error = ModelFile::named("hfb230").unwrap_err();
    /// assert!(matches!(error, ModelError::Unknown { nearest: Some("hfb320"), .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Unknown`] with the nearest name.
    pub fn named(name: &str) -> Result<Self, ModelError> {
        Ok(Self::parse(name, Self::text(name)?)?)
    }

    /// Reads and checks the model file at this path.
    ///
    /// ```
    /// use phugoid_identification::model_file::ModelFile;
    /// let file = std::env::temp_dir().join(format!("phugoid-open-{}.toml", std::process::id()));
    /// std::fs::write(&file, ModelFile::text("f16")?)?;
    /// let model = ModelFile::open(&file)?;
    /// assert_eq!(model.parameters, ModelFile::named("f16")?.parameters);
    /// std::fs::remove_file(&file)?;
    /// assert!(ModelFile::open(&file).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Unreadable`], or [`ModelError::Wrong`] with file, line, column and the nearest valid word.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let path = path.as_ref();
        let text = read(path)?;
        Ok(Self::parse(&path.display().to_string(), &text)?)
    }

    /// The text at this path, unchecked, for who keeps it beside the model; [`parse`](Self::parse) checks it.
    ///
    /// # Errors
    /// [`ModelError::Unreadable`], as [`open`](Self::open).
    pub fn read_text(path: &Path) -> Result<String, ModelError> {
        read(path)
    }

    /// The model file at this path, or, where there is no such file, the built-in model of this name: what the command
    /// line takes as `--model`.
    ///
    /// ```
    /// use phugoid_identification::model_file::ModelFile;
    /// assert_eq!(ModelFile::find("f16")?, ModelFile::named("f16")?);
    /// assert_eq!(ModelFile::find("../../data/models/f16.toml")?.parameters, ModelFile::named("f16")?.parameters);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Unreadable`] with the nearest built-in name, or [`ModelError::Wrong`].
    pub fn find(wanted: &str) -> Result<Self, ModelError> {
        let (name, text) = Self::find_text(wanted)?;
        Ok(Self::parse(&name, &text)?)
    }

    /// As [`find`](Self::find), the name and the text alone.
    ///
    /// # Errors
    /// [`ModelError::Unreadable`].
    pub fn find_text(wanted: &str) -> Result<(String, String), ModelError> {
        let path = Path::new(wanted);
        match Self::text(wanted) {
            Ok(text) if !path.exists() => Ok((wanted.to_owned(), text.to_owned())),
            _ => Ok((wanted.to_owned(), read(path)?)),
        }
    }

    /// Opens a flight as [`Record::open`], with the columns that this file maps to channels by hand (its table
    /// `[channels]`).
    ///
    /// ```
    /// use phugoid_identification::model_file::ModelFile;
    /// let text = ModelFile::text("f16")?;
    /// let channels = "[channels]\nelevator = { header = \"ELEV\", unit = \"deg\", scale = -1 }\n";
    /// let model = ModelFile::parse("mine.toml", &format!("{text}\n{channels}"))?;
    /// let file = std::env::temp_dir().join(format!("phugoid-columns-{}.csv", std::process::id()));
    /// std::fs::write(&file, "time_s,ELEV\n0,1\n0.1,2\n")?;
    /// let record = model.open_record(&file)?;
    /// std::fs::remove_file(&file)?;
    /// assert!((record.require("elevator")?.values[1] + 2_f64.to_radians()).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`read_path`]; a mapped column that the file does not have is one.
    #[allow(clippy::result_large_err)] // the error of the reader as it is
    pub fn open_record(&self, path: impl AsRef<Path>) -> Result<Record, ReadError> {
        self.open_record_with(path, &ReadOptions::default())
    }

    /// As [`ModelFile::open_record`], read with these options; the columns that this file maps come before those of the
    /// options.
    ///
    /// # Errors
    /// As [`read_path`].
    #[allow(clippy::result_large_err)] // the error of the reader as it is
    pub fn open_record_with(&self, path: impl AsRef<Path>, options: &ReadOptions) -> Result<Record, ReadError> {
        let mut options = options.clone();
        options.table.columns.splice(0..0, self.columns());
        read_path(path.as_ref(), &options)
    }
}

fn read(path: &Path) -> Result<String, ModelError> {
    let bytes = std::fs::read(path).map_err(|source| ModelError::Unreadable {
        path: path.to_owned(),
        source,
        nearest: nearest(&path.display().to_string(), names()),
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let bytes = error.as_bytes();
        let (before, rest) = bytes.split_at(error.utf8_error().valid_up_to().min(bytes.len()));
        let found = match (bytes, rest) {
            ([0xFF, 0xFE, ..] | [0xFE, 0xFF, ..], _) => "the file is written in UTF-16".to_owned(),
            (_, [byte, ..]) => format!(
                "there is a character that is not written in UTF-8 (byte {byte:02X}, which is '{}' in Latin-1)",
                char::from(*byte).escape_debug()
            ),
            (_, []) => "the text is not written in UTF-8".to_owned(),
        };
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        ModelError::NotUtf8 { path: path.to_owned(), line, found }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_file_in_another_encoding_is_told_so() {
        let path = std::env::temp_dir().join(format!("phugoid-encoding-{}.toml", std::process::id()));
        let utf16: Vec<u8> = "\u{feff}name = \"x\"\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        for (bytes, told) in [
            (
                &b"# Mass\n\nname = \"M\xFCller\"\n"[..],
                "line 3: there is a character that is not written in UTF-8 (byte FC, which is 'ü' in",
            ),
            (&utf16, "line 1: the file is written in UTF-16"),
        ] {
            std::fs::write(&path, bytes).unwrap();
            let message = ModelFile::open(&path).unwrap_err().to_string();
            assert!(message.contains(told) && message.contains("Save the file as UTF-8"), "{message}");
            assert!(!message.contains("Built-in models"), "{message}");
        }
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn every_built_in_model_reads_and_wrong_names_get_a_hint() {
        for (name, _) in ModelFile::BUILT_IN {
            assert_eq!(ModelFile::named(name).unwrap_or_else(|e| panic!("{e}")).source, *name);
        }
        let message = ModelFile::find("no such thing").unwrap_err().to_string();
        assert!(message.contains("cannot read the model file `no such thing`"), "{message}");
        assert!(message.contains("Built-in models: f16, f16-lateral"), "{message}");
        assert!(ModelFile::named("hfb230").unwrap_err().to_string().contains("`hfb320`"));
    }
}
