//! The thesis's units, in SI.

/// International foot, m (exact, 1959).
pub(super) const FOOT: f64 = 0.3048;
/// Standard gravity, m/s^2 (exact): the unit in which specific forces are drawn.
pub(super) const STANDARD_GRAVITY: f64 = 9.80665;
