//! A method of a plant case with what it did.

use super::method::{Method, MethodRun};
use crate::laws::Evaluation;
use crate::result::{Outcome, Role};

/// A method as the report shows it.
pub(super) struct NamedMethod {
    pub(super) name: &'static str,
    pub(super) role: Role,
    pub(super) settings: Method,
}

/// A method with what it did.
pub(super) struct Judged {
    pub(super) method: NamedMethod,
    pub(super) result: MethodRun,
    pub(super) outcome: Outcome,
}

impl Judged {
    /// Whether its loop is solved at every sample.
    pub(super) fn implicit(&self) -> bool {
        matches!(
            self.method.settings,
            Method::OneParameter { evaluation: Evaluation::Implicit, .. }
                | Method::TwoParameter { evaluation: Evaluation::Implicit, .. }
        )
    }
}
