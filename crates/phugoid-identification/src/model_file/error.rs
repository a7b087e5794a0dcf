//! The error of reading a model file.

/// What is wrong with a model file, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {message}\n    {line} | {}", excerpt.trim_end())]
pub struct ModelFileError {
    /// File or built-in name.
    pub file: Box<str>,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Dotted path of the key, e.g. `parameters.CL_alpha.start`.
    pub key: Box<str>,
    /// What was found, what was expected, what to do.
    pub message: Box<str>,
    /// The valid word nearest to a misspelt one.
    pub nearest: Option<Box<str>>,
    /// The line of the file.
    pub excerpt: Box<str>,
}
