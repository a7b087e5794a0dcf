//! How much of each surface is left beside what straight flight takes of it, as it is flown now.
//!
//! With the means of the last seconds (angle of attack and sideslip `x`, rates `w`, positions `u`, angular accelerations `w'`), the
//! surfaces that hold the same angle of attack and sideslip without rates are
//!
//! ```text
//! u0 = u - B+ (w' - R w),      R: angular accelerations by the rates,   B+: inverse of the gains
//! ```
//!
//! because `w' = f(x, u) + R w`. Positions are measured, and only the little that the flight is not steady by goes through the
//! estimate. Nothing is extrapolated to another angle of attack, so that a wrong slope does not make a wrong margin.
//!
//! A way that a surface still has is worth what it moves the aircraft by: the way is multiplied by the part of the surface's effect on its
//! own axis that is left, and of a surface whose effect is zero within its bound nothing is left.

use crate::gains::{Gains, weighted_inverse};
use crate::interval::Estimate;
use crate::local::{AXES, LocalModel, MAIN_AXIS, P, Q, R, SURFACES, VARIABLES};
use crate::prediction::Steady;

/// What is left of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Margin {
    /// Position that straight flight takes at the angle of attack and sideslip of the last seconds, rad; where a lost surface stands.
    pub trim: f64,
    /// One standard error of it, rad.
    pub std_error: f64,
    /// Whether the surface is used; of one that is lost nothing is left.
    pub is_used: bool,
    /// Whether its effect on its own axis (elevator pitch, aileron roll, rudder yaw) differs from zero by more than two standard errors.
    pub has_effect: bool,
    /// Part of its effect on its own axis that is left of what it was before, 0 to 1; none where nothing is known of before.
    pub effect: Option<f64>,
    /// The smaller of the ways to the two limits as a part of half the range, 1 in the middle and 0 at a limit, times the effect that is
    /// left where that is known. Negative beyond a limit, where this flight cannot be held: then without the effect. Zero for a
    /// surface that is lost or has no effect.
    pub left: f64,
    /// The same with two standard errors of position and effect taken off.
    pub at_least: f64,
}

/// What is left of elevator, aileron and rudder after the last seconds (`steady`, rad, rad/s, rad/s^2), with limits of the positions
/// in rad. `gains` are those of the estimate's own model. `scale` is one standard deviation of the scale of recorded positions, a
/// part: it moves the true position with the position itself. `before` is the aircraft before anything was damaged, at the present speed and
/// air density, where it is known. Numbers that are none make margins that are none.
pub fn margins(
    estimate: &Estimate,
    gains: &Gains,
    steady: &Steady,
    limits: &[[f64; 2]; SURFACES],
    scale: f64,
    before: Option<&LocalModel>,
) -> [Margin; SURFACES] {
    let (model, error, variables) = (&estimate.model, &estimate.std_error, &steady.variables);
    let by_rates = |row: &[f64; VARIABLES]| [row[P] * variables[P], row[Q] * variables[Q], row[R] * variables[R]];
    let beside: [f64; AXES] =
        core::array::from_fn(|i| steady.accelerations[i] - by_rates(&model.rates[i]).iter().sum::<f64>());
    let with = |inverse: &[[f64; AXES]; SURFACES]| -> [f64; SURFACES] {
        core::array::from_fn(|j| (0..AXES).map(|i| inverse[j][i] * beside[i]).sum::<f64>())
    };
    let moved = with(&gains.inverse);
    // Noise of the mean, and the damping by the rates that are left.
    let square: [f64; AXES] = core::array::from_fn(|i| {
        let damped: f64 = by_rates(&error.rates[i]).iter().map(|part| part * part).sum();
        steady.noise[i] * steady.noise[i] + damped
    });
    // What a surface hardly moves it hardly tells apart from nothing: its inverse is then far from linear in its effect, and a whole
    // standard error is tried.
    let mut by_effects = [0.0; SURFACES];
    for i in 0..AXES {
        for j in 0..SURFACES {
            let mut effects = gains.surfaces;
            effects[i][j] += error.surfaces[i][j];
            let other = weighted_inverse(&effects, gains.free, gains.weights());
            let other = other.map_or([f64::NAN; SURFACES], |inverse| with(&inverse));
            (0..SURFACES).for_each(|k| by_effects[k] += (other[k] - moved[k]) * (other[k] - moved[k]));
        }
    }
    core::array::from_fn(|j| {
        let is_used = gains.free[j];
        let trim = steady.surfaces[j] - moved[j];
        let variance: f64 = (0..AXES).map(|i| gains.inverse[j][i] * gains.inverse[j][i] * square[i]).sum::<f64>()
            + by_effects[j]
            + (scale * trim) * (scale * trim);
        let std_error = libm::sqrt(variance);
        let [lowest, highest] = limits[j];
        let half = 0.5 * (highest - lowest);
        let axis = MAIN_AXIS[j];
        let (now, doubt) = (model.surfaces[axis][j], 2.0 * error.surfaces[axis][j]);
        let has_effect = now.abs() > doubt;
        let effects = before.map(|before| before.surfaces[axis][j]).filter(|before| before.abs() > 0.0);
        // More than before is the noise of the estimate, or a limit that is as far as before.
        let [effect, surely] =
            [0.0, doubt].map(|off| effects.map(|before| (now / before - off / before.abs()).clamp(0.0, 1.0)));
        let weighed = |way: f64, effect: Option<f64>| match (is_used && has_effect, effect) {
            (false, _) => 0.0,
            (true, Some(effect)) if way > 0.0 => way * effect,
            (true, _) => way,
        };
        let way = (highest - trim).min(trim - lowest) / half;
        let (left, at_least) = (weighed(way, effect), weighed(way - 2.0 * std_error / half, surely));
        Margin { trim, std_error, is_used, has_effect, effect, left, at_least }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::tests::fighter;
    use crate::target::Targets;

    const LIMITS: [[f64; 2]; 3] = [[-0.4, 0.4]; 3];

    fn steady() -> Steady {
        Steady { surfaces: [-0.2, 0.0, 0.0], duration: 3.0, ..Steady::default() }
    }

    /// Flight that is steady takes what it takes, whatever the estimate says of stability; a nose that rises with 0.11 rad/s^2 on an
    /// elevator of -11 per rad takes 0.01 rad more trailing edge down.
    #[test]
    fn positions_of_steady_flight_are_those_that_are_flown() {
        let model = LocalModel { constant: [0.0, -9.0, 0.0], ..fighter() };
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let known = Estimate { model, std_error: LocalModel::default() };
        let found = margins(&known, &gains, &steady(), &LIMITS, 0.0, None)[0];
        assert!((found.trim + 0.2).abs() < 1e-12 && (found.left - 0.5).abs() < 1e-12, "{found:?}");
        let rising = Steady { accelerations: [0.0, 0.11, 0.0], noise: [0.0, 0.022, 0.0], ..steady() };
        let found = margins(&known, &gains, &rising, &LIMITS, 0.0, None)[0];
        // The price of deflection takes half a thousandth.
        assert!((found.trim + 0.19).abs() < 2e-4 && (found.std_error - 0.002).abs() < 2e-5, "{found:?}");
        assert!((found.left - 0.525).abs() < 1e-3 && (found.at_least - 0.515).abs() < 1e-3, "{found:?}");
        let scaled = margins(&known, &gains, &steady(), &LIMITS, 0.03, None)[0];
        assert!((scaled.std_error - 0.006).abs() < 1e-9);
    }

    /// A pitch rate is held by the elevator against the damping: without it the elevator stands elsewhere, by what damping and elevator
    /// are known to.
    #[test]
    fn rates_are_taken_out_within_the_bounds_of_the_damping() {
        let model = fighter();
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let std_error = LocalModel { rates: [[0.0; 5], [0.0, 0.0, 0.0, 0.5, 0.0], [0.0; 5]], ..LocalModel::default() };
        let turning = Steady { variables: [0.0, 0.0, 0.0, 0.1, 0.0], ..steady() };
        let found = margins(&Estimate { model, std_error }, &gains, &turning, &LIMITS, 0.0, None)[0];
        let moved = -model.rates[1][3] * 0.1 / model.surfaces[1][0];
        assert!((found.trim - (-0.2 - moved)).abs() < 2e-4, "{found:?} {moved}");
        assert!((found.std_error - 0.05 / 11.0).abs() < 2e-5, "{found:?}");
    }

    /// Of a rudder with a quarter of its effect a quarter of the way is left, and of one whose effect is zero within its bound nothing,
    /// wherever it stands.
    #[test]
    fn a_way_is_worth_what_the_surface_still_does() {
        let before = fighter();
        let mut model = before;
        model.surfaces[2][2] *= 0.25;
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let mut std_error = LocalModel::default();
        std_error.surfaces[2][2] = 0.05 * before.surfaces[2][2].abs();
        let found = margins(&Estimate { model, std_error }, &gains, &steady(), &LIMITS, 0.0, Some(&before))[2];
        assert!(found.has_effect && (found.effect.unwrap() - 0.25).abs() < 1e-12, "{found:?}");
        assert!((found.left - 0.25).abs() < 1e-9 && (found.at_least - 0.15).abs() < 1e-9, "{found:?}");
        model.surfaces[2][2] *= 0.3;
        let found = margins(&Estimate { model, std_error }, &gains, &steady(), &LIMITS, 0.0, Some(&before))[2];
        assert!(found.is_used && !found.has_effect && found.left == 0.0 && found.at_least == 0.0, "{found:?}");
    }

    #[test]
    fn of_a_lost_surface_nothing_is_left() {
        let model = fighter();
        let gains = Gains::place_with(&model, &Targets::default(), [false, true, true]).unwrap();
        let known = Estimate { model, std_error: LocalModel::default() };
        let found = margins(&known, &gains, &steady(), &LIMITS, 0.0, None)[0];
        assert!(!found.is_used && found.trim == -0.2 && found.left == 0.0 && found.at_least == 0.0, "{found:?}");
    }
}
