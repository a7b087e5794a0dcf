//! `phugoid fleet tell`.

use crate::arguments::fleet::Tell;
use crate::failure::Failure;

pub(super) fn run(_: &Tell) -> Result<(), Failure> {
    Ok(())
}
