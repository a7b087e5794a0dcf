//! Model files by what a user calls them: a file, or the name of one that is built in.

use std::path::Path;

use phugoid_identification::model_file::{ModelFile, ModelFileError};

use crate::published;
use phugoid_simulation::scenario::nearest;

/// Why there is nothing under this name.
#[derive(Debug, thiserror::Error)]
pub enum NamedError {
    /// Neither a file that can be read nor a built-in model.
    #[error("cannot read the model file `{wanted}`: {error}\n{hint}")]
    NoModel {
        /// What was asked for.
        wanted: String,
        /// What the system says.
        error: std::io::Error,
        /// The nearest name, or all of them.
        hint: String,
    },
    /// A model file that is wrong.
    #[error(transparent)]
    Model(#[from] ModelFileError),
}

/// The model files that are built in: name and text.
pub fn models() -> impl Iterator<Item = (&'static str, &'static str)> + Clone {
    ModelFile::BUILT_IN.into_iter().chain(published::MODELS.iter().copied())
}

/// A model file, or a built-in one by name.
///
/// # Errors
/// [`NamedError`] with the nearest name.
pub fn model(wanted: &str) -> Result<ModelFile, NamedError> {
    let (name, text) = model_text(wanted)?;
    Ok(ModelFile::parse(&name, &text)?)
}

/// Name and text of a model file, or of a built-in one by name.
///
/// # Errors
/// [`NamedError::NoModel`].
pub fn model_text(wanted: &str) -> Result<(String, String), NamedError> {
    let path = Path::new(wanted);
    if !path.exists()
        && let Some((name, text)) = models().find(|(name, _)| *name == wanted)
    {
        return Ok((name.to_owned(), text.to_owned()));
    }
    let text = std::fs::read_to_string(path).map_err(|error| no_model(wanted, error))?;
    Ok((wanted.to_owned(), text))
}

/// What is said where there is no model of this name.
pub fn no_model(wanted: &str, error: std::io::Error) -> NamedError {
    let names = || models().map(|(name, _)| name);
    let hint = match nearest(wanted, names()) {
        Some(near) => format!("Did you mean the built-in model `{near}`?"),
        None => format!(
            "Built-in models: {}. Start your own from one: phugoid estimate --show-model f16 > mine.toml",
            names().collect::<Vec<_>>().join(", ")
        ),
    };
    NamedError::NoModel { wanted: wanted.to_owned(), error, hint }
}
