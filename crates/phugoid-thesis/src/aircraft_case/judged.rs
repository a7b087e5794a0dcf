//! A method of an aircraft case with what it did.

use super::method::{MethodRun, NamedMethod};
use crate::result::Outcome;

/// A method with what it did.
pub(super) struct Judged {
    pub(super) settings: NamedMethod,
    pub(super) run: MethodRun,
    pub(super) outcome: Outcome,
}
