//! When the arena looks at an estimate, and when it counts as found.

/// After how many short-period cycles the estimates are looked at.
pub const CYCLES: [f64; 3] = [1.0, 2.0, 5.0];

/// Error within which a parameter counts as found, part of its true value.
pub const TOLERANCE: f64 = 0.05;
