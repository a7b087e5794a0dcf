//! The Python exception for the errors of the library.

use std::fmt::Display;

use pyo3::exceptions::PyValueError;
use pyo3::{PyErr, create_exception};

create_exception!(
    phugoid,
    PhugoidError,
    PyValueError,
    "What was found, what was expected, where, and what to do: the texts of the command line."
);

/// Makes a `PhugoidError` with the text of an error.
pub(crate) fn raise(error: impl Display) -> PyErr {
    PhugoidError::new_err(error.to_string())
}
