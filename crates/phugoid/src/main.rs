//! The `phugoid` command.
fn main() {}
