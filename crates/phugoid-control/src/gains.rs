//! The gains that give an aircraft the wanted motion, and the surfaces that make a wanted moment.
//!
//! ```text
//! u = B+ (R* x - R x - c + demand),      B+ = (B^T W B + D)^-1 B^T W
//! ```
//!
//! `R` and `B` are the aircraft's angular accelerations by the feedback variables and by the surfaces, `R*` those that are wanted.
//! `B+` is a least-squares inverse with a small price on deflection (`D`), so that a surface that has lost its effect is left
//! alone instead of being driven to its stop.
//!
//! Without ailerons the rudder rolls the aircraft, by the sideslip that it holds ([`Gains::roll_by_sideslip`]).

use crate::local::{AILERON, AXES, BETA, LocalModel, P, ROLL, RUDDER, SURFACES, VARIABLES, YAW};
use crate::target::Targets;

/// Weight of roll, pitch and yaw acceleration where the surfaces cannot give all three.
pub const WEIGHTS: [f64; AXES] = [1.0, 4.0, 1.0];
/// Angular acceleration (rad/s^2) that a full radian of any surface has to give to be worth its deflection: the square of it is
/// the price of deflection. A tenth of what the weakest surface of an ordinary aircraft gives.
const WORTH: f64 = 0.15;
/// Least damping of the roll that is asked for where the rudder rolls the aircraft, 1/s; what it has by itself is left alone if it is more.
const LEAST_ROLL_DAMPING: f64 = 0.5;

/// Gains of the law for one model of the aircraft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gains {
    /// Deflections of elevator, aileron and rudder (rows) by the wanted angular accelerations (columns), s^2.
    pub inverse: [[f64; AXES]; SURFACES],
    /// Whether elevator, aileron and rudder are used.
    pub free: [bool; SURFACES],
    /// Angular accelerations that the surfaces have to add (rows), by the feedback variables (columns): wanted less natural.
    pub added: [[f64; VARIABLES]; AXES],
    /// Wanted angular accelerations by the feedback variables: what the incremental form asks for.
    pub wanted: [[f64; VARIABLES]; AXES],
    /// Angular accelerations by the surfaces that the gains were made with, 1/s^2.
    pub surfaces: [[f64; SURFACES]; AXES],
    /// Rate of the angle of attack by itself, 1/s: how it follows a commanded pitch rate.
    pub lift: f64,
    /// Angular acceleration at the reference that the surfaces have to take away, rad/s^2.
    pub constant: [f64; AXES],
    /// Roll acceleration by a sideslip that the rudder holds, 1/s^2, where the aircraft is rolled with that: its ailerons are not used or have
    /// no effect. None where the ailerons roll it, and where the rudder cannot either.
    ///
    /// A rudder rolls an aircraft twice: at once by its own height above the roll axis, and after a second by the sideslip that it
    /// makes, which is more and goes the other way. A law that took the first for the effect of the rudder would be unstable.
    pub roll_by_sideslip: Option<f64>,
    /// Roll damping that is wanted where the ailerons roll the aircraft, 1/s.
    pub roll_damping: f64,
}

impl Gains {
    /// The gains for this aircraft; `None` if its numbers are not finite.
    ///
    /// ```
    /// use phugoid_control::gains::Gains;
    /// use phugoid_control::local::LocalModel;
    /// use phugoid_control::roots::eigenvalues;
    /// use phugoid_control::target::Targets;
    ///
    /// // A fighter that diverges in pitch.
    /// let aircraft = LocalModel {
    ///     rates: [[0.0, -30.0, -3.0, 0.0, 0.7], [1.5, 0.0, 0.0, -1.0, 0.0], [0.0, 9.0, 0.0, 0.0, -0.5]],
    ///     surfaces: [[0.0, -45.0, 8.0], [-11.0, 0.0, 0.0], [0.0, -2.0, -4.5]],
    ///     alpha_by_alpha: -0.9,
    ///     alpha_by_elevator: -0.12,
    ///     beta_by_beta: -0.25,
    ///     beta_by_rudder: 0.04,
    ///     alpha: 0.04,
    ///     speed: 205.0,
    ///     gravity: 9.81,
    ///     ..LocalModel::default()
    /// };
    /// let gains = Gains::place(&aircraft, &Targets::default()).ok_or("not finite")?;
    /// let roots = eigenvalues(&aircraft.closed_loop(&gains.feedback())).ok_or("no roots")?;
    /// // But for the spiral, everything is fast and damped.
    /// assert_eq!(roots.iter().filter(|root| root.real > -0.9).count(), 1);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn place(model: &LocalModel, targets: &Targets) -> Option<Self> {
        Self::place_with(model, targets, [true; SURFACES])
    }

    /// As [`place`](Self::place), with the surfaces that are `free` to be moved: the others are left where they are.
    pub fn place_with(model: &LocalModel, targets: &Targets, free: [bool; SURFACES]) -> Option<Self> {
        let wanted = targets.rates(model);
        let gains = Self {
            inverse: [[0.0; AXES]; SURFACES],
            free: [true; SURFACES],
            added: core::array::from_fn(|i| core::array::from_fn(|j| wanted[i][j] - model.rates[i][j])),
            wanted,
            surfaces: model.surfaces,
            lift: model.alpha_by_alpha,
            constant: model.constant,
            roll_by_sideslip: None,
            roll_damping: wanted[ROLL][P],
        }
        .with_free(free)?;
        (model.is_finite() && gains.is_finite()).then_some(gains)
    }

    /// The same wanted motion with the surfaces that are `free` to be moved; `None` if that has numbers that are not finite.
    pub fn with_free(&self, free: [bool; SURFACES]) -> Option<Self> {
        let natural = self.modelled();
        let roll_by_sideslip = roll_by_sideslip(&natural, free);
        let mut gains = Self { free, roll_by_sideslip, ..*self };
        let damping = match roll_by_sideslip {
            Some(_) => natural.rates[ROLL][P].min(-LEAST_ROLL_DAMPING),
            None => self.roll_damping,
        };
        // Where it stays as it is nothing is rounded.
        if damping != gains.wanted[ROLL][P] {
            gains.wanted[ROLL][P] = damping;
            gains.added[ROLL][P] = damping - natural.rates[ROLL][P];
        }
        gains.inverse = weighted_inverse(&self.surfaces, free, gains.weights())?;
        Some(gains)
    }

    /// Weights of roll, pitch and yaw acceleration where the surfaces cannot give all three.
    pub(crate) fn weights(&self) -> [f64; AXES] {
        match self.roll_by_sideslip {
            Some(_) => [0.0, WEIGHTS[1], WEIGHTS[YAW]],
            None => WEIGHTS,
        }
    }

    /// The angular accelerations by feedback variables and surfaces that the gains were made for; what they do not tell is zero.
    pub fn modelled(&self) -> LocalModel {
        let natural = |i: usize, j: usize| self.wanted[i][j] - self.added[i][j];
        LocalModel {
            rates: core::array::from_fn(|i| core::array::from_fn(|j| natural(i, j))),
            surfaces: self.surfaces,
            ..LocalModel::default()
        }
    }

    /// Deflections by the feedback variables: what the law is for small motions.
    pub fn feedback(&self) -> [[f64; VARIABLES]; SURFACES] {
        let mut added = self.added;
        if let Some(by_sideslip) = self.roll_by_sideslip {
            // The sideslip that makes the roll acceleration beside that of the present one, which the wanted one takes the place of.
            let yaw_by_roll = -self.wanted[YAW][BETA] / by_sideslip;
            for j in (0..VARIABLES).filter(|j| *j != BETA) {
                added[YAW][j] += yaw_by_roll * added[ROLL][j];
            }
        }
        core::array::from_fn(|i| core::array::from_fn(|j| (0..AXES).map(|k| self.inverse[i][k] * added[k][j]).sum()))
    }

    /// Whether every gain is a finite number.
    pub fn is_finite(&self) -> bool {
        let all = self.inverse.iter().flatten().chain(self.added.iter().flatten()).chain(self.wanted.iter().flatten());
        let sideslip = self.roll_by_sideslip.unwrap_or(1.0);
        all.chain(&self.constant).chain([&self.lift, &sideslip]).all(|value| value.is_finite())
    }

    /// Deflections that give the angular accelerations `demand` (rad/s^2) best within `[lowest, highest]` (rad): a surface that
    /// would go beyond its limit stays there, and the others take over what they can. A surface that is not free is at its lower
    /// limit, and the others make up for that. Limits that are no numbers limit nothing.
    pub fn allocate(&self, demand: [f64; AXES], limits: &[[f64; 2]; SURFACES]) -> [f64; SURFACES] {
        let mut free = self.free;
        let mut deflections: [f64; SURFACES] =
            core::array::from_fn(|j| if free[j] || !limits[j][0].is_finite() { 0.0 } else { limits[j][0] });
        // Each round fixes at least one surface or ends.
        for _ in 0..=SURFACES {
            let mut left = demand;
            for (i, left) in left.iter_mut().enumerate() {
                for j in 0..SURFACES {
                    if !free[j] {
                        *left -= self.surfaces[i][j] * deflections[j];
                    }
                }
            }
            let whole = free == self.free;
            let inverse =
                if whole { Some(self.inverse) } else { weighted_inverse(&self.surfaces, free, self.weights()) };
            let Some(inverse) = inverse else { return deflections };
            let mut beyond = false;
            for j in 0..SURFACES {
                if free[j] {
                    let wanted: f64 = (0..AXES).map(|i| inverse[j][i] * left[i]).sum();
                    let [lowest, highest] = limits[j];
                    let held = if wanted < lowest {
                        lowest
                    } else if wanted > highest {
                        highest
                    } else {
                        wanted
                    };
                    deflections[j] = held;
                    if held != wanted {
                        free[j] = false;
                        beyond = true;
                    }
                }
            }
            if !beyond {
                break;
            }
        }
        deflections
    }
}

/// What [`Gains::roll_by_sideslip`] is for this aircraft with these surfaces.
fn roll_by_sideslip(model: &LocalModel, free: [bool; SURFACES]) -> Option<f64> {
    let (rates, surfaces) = (&model.rates, &model.surfaces);
    let is_rolled_by_ailerons = free[AILERON] && surfaces[ROLL][AILERON].abs() > WORTH;
    if is_rolled_by_ailerons || !free[RUDDER] || surfaces[YAW][RUDDER].abs() <= WORTH {
        return None;
    }
    // The rudder that holds one radian of sideslip.
    let rudder = -rates[YAW][BETA] / surfaces[YAW][RUDDER];
    let by_sideslip = rates[ROLL][BETA] + rudder * surfaces[ROLL][RUDDER];
    (by_sideslip.abs() > WORTH).then_some(by_sideslip)
}

/// `(B^T W B + D)^-1 B^T W` of the free surfaces; rows of the others are zero. `None` if it has numbers that are not finite.
pub(crate) fn weighted_inverse(
    b: &[[f64; SURFACES]; AXES],
    free: [bool; SURFACES],
    weights: [f64; AXES],
) -> Option<[[f64; AXES]; SURFACES]> {
    let mut normal = [[0.0; SURFACES]; SURFACES];
    for i in 0..SURFACES {
        for j in 0..SURFACES {
            if free[i] && free[j] {
                normal[i][j] = (0..AXES).map(|k| b[k][i] * weights[k] * b[k][j]).sum();
            }
        }
        normal[i][i] += WORTH * WORTH;
        if !free[i] {
            normal[i][i] = 1.0;
        }
    }
    let cofactor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        normal[r1][c1] * normal[r2][c2] - normal[r1][c2] * normal[r2][c1]
    };
    let determinant = (0..SURFACES).map(|c| normal[0][c] * cofactor(0, c)).sum::<f64>();
    let inverse: [[f64; AXES]; SURFACES] = core::array::from_fn(|i| {
        core::array::from_fn(|k| {
            if !free[i] {
                return 0.0;
            }
            let sum: f64 = (0..SURFACES).filter(|j| free[*j]).map(|j| cofactor(j, i) * b[k][j]).sum();
            sum / determinant * weights[k]
        })
    });
    inverse.iter().flatten().all(|value| value.is_finite()).then_some(inverse)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::roots::eigenvalues;

    /// A fighter in cruise: signs and sizes as of the F-16 at 20,000 ft.
    pub(crate) fn fighter() -> LocalModel {
        LocalModel {
            rates: [[0.0, -30.0, -3.0, 0.0, 0.7], [1.5, 0.0, 0.0, -1.0, 0.0], [0.0, 9.0, -0.03, 0.0, -0.5]],
            surfaces: [[0.0, -45.0, 8.0], [-11.0, 0.0, 0.0], [0.0, -2.0, -4.5]],
            constant: [0.0; 3],
            alpha_by_alpha: -0.9,
            alpha_by_elevator: -0.12,
            beta_by_beta: -0.25,
            beta_by_rudder: 0.04,
            beta_by_aileron: 0.0,
            alpha: 0.04,
            speed: 205.0,
            gravity: 9.81,
        }
    }

    /// With the aircraft that the gains were made for, short period, roll and Dutch roll are what was asked for; the elevator's
    /// lift and the price of deflection move them by a few per cent.
    #[test]
    fn the_wanted_motion_comes_out() {
        let (model, targets) = (fighter(), Targets::default());
        let gains = Gains::place(&model, &targets).unwrap();
        let roots = eigenvalues(&model.closed_loop(&gains.feedback())).unwrap();
        let has = |frequency: f64, damping: f64| {
            roots
                .iter()
                .any(|root| (root.frequency() / frequency - 1.0).abs() < 0.12 && (root.damping() - damping).abs() < 0.1)
        };
        assert!(has(targets.short_period_frequency(&model), 0.8), "{roots:?}");
        assert!(has(2.5, 0.5), "{roots:?}");
        assert!(has(2.0, 1.0), "{roots:?}");
    }

    #[test]
    fn a_surface_without_effect_is_left_alone() {
        let mut model = fighter();
        for row in &mut model.surfaces {
            row[2] = 0.0;
        }
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        assert!(gains.feedback()[2].iter().all(|gain| *gain == 0.0));
        assert!(gains.feedback()[1][2].abs() > 0.001, "the aileron still rolls");
    }

    #[test]
    fn a_surface_at_its_stop_is_helped_by_the_others() {
        let gains = Gains::place(&fighter(), &Targets::default()).unwrap();
        let limits = [[-0.4, 0.4], [-0.02, 0.02], [-0.5, 0.5]];
        let moved = gains.allocate([2.0, 0.0, 0.0], &limits);
        assert_eq!(moved[1], -0.02);
        // 45 * 0.02 = 0.9 of the 2.0 come from the ailerons; the rudder gives some of the rest and yaws for it.
        assert!(moved[2] > 0.0, "{moved:?}");
        let inside = gains.allocate([0.1, 0.2, -0.1], &limits);
        for i in 0..3 {
            let got: f64 = (0..3).map(|j| gains.surfaces[i][j] * inside[j]).sum();
            assert!((got - [0.1, 0.2, -0.1][i]).abs() < 0.002, "{inside:?}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let model = LocalModel { speed: f64::NAN, ..fighter() };
        assert!(Gains::place(&model, &Targets::default()).is_none());
        let mut model = fighter();
        model.surfaces[1][0] = f64::INFINITY;
        assert!(Gains::place(&model, &Targets::default()).is_none());
    }
}
