//! Why a file does not make an aircraft that can be flown.

use std::path::PathBuf;

use crate::jsbsim::JsbsimError;
use crate::transport::TransportError;
use crate::xml::XmlError;

/// Why a file does not make an aircraft that can be flown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FlownError {
    /// The files of an aircraft of JSBSim cannot be read.
    #[error(transparent)]
    Jsbsim(#[from] JsbsimError),
    /// A file is no XML.
    #[error("{}: {source}", file.display())]
    NoXml {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        source: XmlError,
    },
    /// The tables of the Generic Transport Model cannot be read.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// An option that the aircraft of this file does not have.
    #[error("{}: `{option}` has no meaning for {aircraft}", file.display())]
    Option {
        /// The file or folder.
        file: PathBuf,
        /// The option.
        option: &'static str,
        /// What the aircraft is.
        aircraft: &'static str,
    },
    /// The file is of no kind that is known.
    #[error("{}: the file begins with <{root}>; aircraft of JSBSim begin with <fdm_config>", file.display())]
    UnknownKind {
        /// The file.
        file: PathBuf,
        /// Name of its outermost element.
        root: String,
    },
    /// The aerodynamics move with something that cannot be made of the angle of a surface.
    #[error("the aerodynamics read {property}, which cannot be made of the angle of the {surface}")]
    Surface {
        /// `elevator`, `aileron` or `rudder`.
        surface: &'static str,
        /// The property.
        property: String,
    },
    /// A property that was to be set is not in the files.
    #[error("no file mentions the property {name}")]
    Property {
        /// Its name.
        name: String,
    },
    /// A number is out of its range.
    #[error("{what} is {value}; it has to be {expected}")]
    Number {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// Mass or inertia are not positive.
    #[error("mass or inertia are not positive")]
    Mass,
}
