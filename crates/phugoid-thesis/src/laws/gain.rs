//! The gain that the thesis takes from the bounds.

/// `|1/alpha - 1|` with `alpha = sqrt(upper/lower)`, taken with the larger magnitude on top; zero for bounds of both signs,
/// for which the thesis has no `alpha`.
pub(super) fn spread(lower: f64, upper: f64) -> f64 {
    let ratio = lower / upper;
    if ratio > 0.0 { (libm::sqrt(ratio.min(1.0 / ratio)) - 1.0).abs() } else { 0.0 }
}

/// `K = |theta (1/alpha - 1) z| - eta` and its derivative by `theta`.
pub(super) fn gain(theta: f64, spread: f64, z: f64, eta: f64) -> (f64, f64) {
    let size = (spread * z).abs();
    (theta.abs() * size - eta, if theta < 0.0 { -size } else { size })
}
