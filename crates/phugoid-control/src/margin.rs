//! How much of each surface is left beside what steady flight takes.

use crate::gains::Gains;
use crate::interval::Estimate;
use crate::local::{AXES, SURFACES};

/// What is left of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Margin {
    /// Position that steady flight at the reference takes, rad.
    pub trim: f64,
    /// One standard error of it, rad: from the bounds of the constant moments.
    pub std_error: f64,
    /// The smaller of the ways to the two limits, as a part of half the range: 1 in the middle, 0 at a limit, negative beyond it,
    /// where steady flight at the reference is not possible.
    pub left: f64,
    /// The same with two standard errors taken off.
    pub at_least: f64,
}

/// What is left of elevator, aileron and rudder, with the surfaces at `surfaces` (rad) in the reference and limits in rad. Deflections
/// of a surface that does nothing are those of the reference. `scale` is one standard deviation of the scale of recorded positions, a
/// part: it moves the true position with the position itself.
pub fn margins(
    estimate: &Estimate,
    gains: &Gains,
    surfaces: &[f64; SURFACES],
    limits: &[[f64; 2]; SURFACES],
    scale: f64,
) -> [Margin; SURFACES] {
    core::array::from_fn(|j| {
        let trim = surfaces[j] - (0..AXES).map(|i| gains.inverse[j][i] * estimate.model.constant[i]).sum::<f64>();
        let variance: f64 = (0..AXES)
            .map(|i| {
                let part = gains.inverse[j][i] * estimate.std_error.constant[i];
                part * part
            })
            .sum::<f64>()
            + (scale * trim) * (scale * trim);
        let std_error = libm::sqrt(variance);
        let [lowest, highest] = limits[j];
        let half = 0.5 * (highest - lowest);
        let way = |trim: f64| (highest - trim).min(trim - lowest) / half;
        let left = way(trim);
        Margin { trim, std_error, left, at_least: left - 2.0 * std_error / half }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::tests::fighter;
    use crate::local::LocalModel;
    use crate::target::Targets;

    /// A nose-down moment of 2.2 rad/s^2 on an elevator that gives -11 per rad takes 0.2 rad up.
    #[test]
    fn a_constant_moment_takes_its_share() {
        let model = LocalModel { constant: [0.0, -2.2, 0.0], ..fighter() };
        let std_error = LocalModel { constant: [0.0, 0.22, 0.0], ..LocalModel::default() };
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let limits = [[-0.4, 0.4]; 3];
        let found = margins(&Estimate { model, std_error }, &gains, &[0.0; 3], &limits, 0.0)[0];
        // The price of deflection takes half a thousandth.
        assert!((found.trim + 0.2).abs() < 2e-4 && (found.std_error - 0.02).abs() < 2e-5, "{found:?}");
        assert!((found.left - 0.5).abs() < 1e-3 && (found.at_least - 0.4).abs() < 1e-3, "{found:?}");
    }
}
