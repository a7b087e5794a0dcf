//! The error of reading a model file.

/// An error in a model file, with its place. Displayed, it shows `file:line:column`, the message and the line itself.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {message}\n    {line} | {}", excerpt.trim_end())]
pub struct ModelFileError {
    /// Path of the file as it was given, or the name of the built-in model.
    pub file: Box<str>,
    /// Number of the line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Dotted path of the key, e.g. `parameters.CL_alpha.start`.
    pub key: Box<str>,
    /// A sentence that says what was found, what was expected and what to do.
    pub message: Box<str>,
    /// The valid word nearest to a misspelt one.
    pub nearest: Option<Box<str>>,
    /// The text of the line in which the error is.
    pub excerpt: Box<str>,
}
