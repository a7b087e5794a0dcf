//! Natural modes of a linear model: eigenvalues, named by the states that take part in them.
//!
//! A name is not read off the order of the eigenvalues: an aircraft with relaxed stability may have neither a short
//! period nor a phugoid. The F-16 with its centre of gravity at 0.35 mean chord, for instance, has a fast real root, a
//! slow oscillation in which speed, angle of attack, pitch angle and rate all take part (the *third oscillatory mode*) and
//! a slow divergence of speed and pitch angle.
//! The participation factor of state k in mode i is `|w_ik v_ki|`, `v` and `w` being right and left eigenvectors; it has
//! no unit, so that m/s and rad may be compared.

use nalgebra::{Complex, Matrix3, Matrix4, Schur};
use serde::Serialize;

/// The motion that a mode is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ModeName {
    /// Fast longitudinal oscillation in angle of attack and pitch rate.
    ShortPeriod,
    /// Slow longitudinal oscillation in speed and pitch angle.
    Phugoid,
    /// Longitudinal oscillation in which a short-period root and a phugoid root have merged, with relaxed static stability.
    ThirdOscillatory,
    /// Stable real root, mostly of angle of attack and pitch rate.
    PitchSubsidence,
    /// Unstable real root, mostly of angle of attack and pitch rate.
    PitchDivergence,
    /// Stable real root, mostly of speed and pitch angle.
    SpeedSubsidence,
    /// Unstable real root, mostly of speed and pitch angle.
    SpeedDivergence,
    /// Lateral oscillation in sideslip and yaw rate.
    DutchRoll,
    /// Real root of the roll rate.
    Roll,
    /// Real root of the bank angle, slow.
    Spiral,
    /// Roll and spiral roots merged into a slow oscillation.
    LateralPhugoid,
    /// Stable real root, mostly of sideslip and yaw rate, where the Dutch roll has split.
    YawSubsidence,
    /// Unstable real root, mostly of sideslip and yaw rate.
    YawDivergence,
}

impl core::fmt::Display for ModeName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::ShortPeriod => "short period",
            Self::Phugoid => "phugoid",
            Self::ThirdOscillatory => "third oscillatory",
            Self::PitchSubsidence => "pitch subsidence",
            Self::PitchDivergence => "pitch divergence",
            Self::SpeedSubsidence => "speed subsidence",
            Self::SpeedDivergence => "speed divergence",
            Self::DutchRoll => "Dutch roll",
            Self::Roll => "roll",
            Self::Spiral => "spiral",
            Self::LateralPhugoid => "lateral phugoid",
            Self::YawSubsidence => "yaw subsidence",
            Self::YawDivergence => "yaw divergence",
        })
    }
}

/// One mode: a real eigenvalue, or a complex pair of which the upper one is given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// The name of the motion, after the states that take part in it.
    pub name: ModeName,
    /// Real part of the eigenvalue, 1/s.
    pub eigenvalue_real: f64,
    /// Imaginary part of the eigenvalue, rad/s, not negative; zero for a real eigenvalue.
    pub eigenvalue_imaginary: f64,
    /// Undamped natural frequency, the magnitude of the eigenvalue, rad/s.
    pub natural_frequency_rad_s: f64,
    /// `-real / magnitude`: negative when unstable, 1 or -1 for a real eigenvalue, none for an eigenvalue of zero.
    pub damping_ratio: Option<f64>,
    /// Period of the oscillation, s; none for a real eigenvalue.
    pub period_s: Option<f64>,
    /// Time in which the amplitude halves, s; none unless stable.
    pub time_to_half_s: Option<f64>,
    /// Time in which the amplitude doubles, s; none unless unstable.
    pub time_to_double_s: Option<f64>,
    /// Share of each state of the model in the mode, adding up to one.
    pub participation: [f64; 4],
}

/// Why a matrix has no modes to show.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// An entry is infinite or not a number.
    #[error("entry ({row}, {column}) of the system matrix is {value}: modes need finite numbers")]
    NotFinite {
        /// Row of the entry, counted from zero.
        row: usize,
        /// Column of the entry, counted from zero.
        column: usize,
        /// The entry that is not finite.
        value: f64,
    },
    /// The eigenvalue iteration has not settled.
    #[error("the eigenvalues were not found in {iterations} iterations")]
    NoConvergence {
        /// Number of iterations after which the search was given up.
        iterations: usize,
    },
}

/// The modes of a longitudinal model with states `[V, alpha, theta, q]` (rows of `a` in that order; any units, time in
/// seconds), fastest first.
///
/// With two oscillations the one with the larger part of alpha and q is the short period. A single oscillation is the
/// short period when alpha and q make up more than 0.75 of it, the phugoid when less than 0.25, and otherwise the
/// third oscillatory mode.
///
/// # Errors
/// [`ModesError`] when an entry is not finite or the eigenvalues are not found.
///
/// ```
/// use phugoid_flight_dynamics::modes::{ModeName, longitudinal_modes};
///
/// // A light aircraft at 54 m/s: V in m/s, alpha, theta and q in rad and rad/s.
/// let a = [
///     [-0.045, 3.5, -9.81, 0.0],
///     [-0.0069, -2.0, 0.0, 1.0],
///     [0.0, 0.0, 0.0, 1.0],
///     [0.0, -8.8, 0.0, -2.1],
/// ];
/// let modes = longitudinal_modes(&a)?;
/// assert_eq!(modes.iter().map(|mode| mode.name).collect::<Vec<_>>(), [ModeName::ShortPeriod, ModeName::Phugoid]);
/// assert!(modes[0].period_s.unwrap() < 3.0 && modes[1].period_s.unwrap() > 20.0);
/// # Ok::<(), phugoid_flight_dynamics::modes::ModesError>(())
/// ```
pub fn longitudinal_modes(a: &[[f64; 4]; 4]) -> Result<Vec<Mode>, ModesError> {
    const ALPHA: usize = 1;
    const Q: usize = 3;
    let mut roots = roots(a)?;
    let pitch_share = |root: &Root| root.participation[ALPHA] + root.participation[Q];
    let oscillations = roots.iter().filter(|r| r.oscillates()).count();
    let most_pitch = roots.iter().filter(|r| r.oscillates()).map(pitch_share).fold(0.0, f64::max);
    roots.sort_by(Root::fastest_first);
    Ok(roots
        .iter()
        .map(|root| {
            let share = pitch_share(root);
            let name = match (root.oscillates(), oscillations) {
                (true, 2) if share >= most_pitch => ModeName::ShortPeriod,
                (true, 2) => ModeName::Phugoid,
                (true, _) if share > 0.75 => ModeName::ShortPeriod,
                (true, _) if share < 0.25 => ModeName::Phugoid,
                (true, _) => ModeName::ThirdOscillatory,
                (false, _) if share >= 0.5 && root.unstable() => ModeName::PitchDivergence,
                (false, _) if share >= 0.5 => ModeName::PitchSubsidence,
                (false, _) if root.unstable() => ModeName::SpeedDivergence,
                (false, _) => ModeName::SpeedSubsidence,
            };
            root.named(name)
        })
        .collect())
}

/// The modes of a lateral model with states `[beta, phi, p, r]` (rows of `a` in that order; any units, time in seconds),
/// fastest first.
///
/// Of two oscillations the one with the larger part of beta and r is the Dutch roll, the other a lateral phugoid. A single
/// one is the Dutch roll if beta and r make up half of it. Beside a Dutch roll the faster of two real roots, if stable,
/// is the roll mode and the slower one the spiral, as is usual; the participation tells how far they deserve it. Other
/// real roots are named after the states with the largest part: roll (p), spiral (phi), yaw (beta and r).
///
/// # Errors
/// [`ModesError`] when an entry is not finite or the eigenvalues are not found.
pub fn lateral_modes(a: &[[f64; 4]; 4]) -> Result<Vec<Mode>, ModesError> {
    let mut roots = roots(a)?;
    let yaw_share = |root: &Root| root.participation[0] + root.participation[3];
    let oscillations = roots.iter().filter(|r| r.oscillates()).count();
    let least_yaw = if oscillations == 2 { 0.0 } else { 0.5 };
    let most_yaw = roots.iter().filter(|r| r.oscillates()).map(yaw_share).fold(least_yaw, f64::max);
    roots.sort_by(Root::fastest_first);
    let mut modes: Vec<Mode> = roots
        .iter()
        .map(|root| {
            let [_, phi, p, _] = root.participation;
            let yaw = yaw_share(root);
            let name = match root.oscillates() {
                true if yaw >= most_yaw => ModeName::DutchRoll,
                true => ModeName::LateralPhugoid,
                false if yaw > p.max(phi) && root.unstable() => ModeName::YawDivergence,
                false if yaw > p.max(phi) => ModeName::YawSubsidence,
                false if p >= phi => ModeName::Roll,
                false => ModeName::Spiral,
            };
            root.named(name)
        })
        .collect();
    let dutch_roll = modes.iter().any(|m| m.name == ModeName::DutchRoll);
    let mut real: Vec<&mut Mode> = modes.iter_mut().filter(|m| m.eigenvalue_imaginary == 0.0).collect();
    if let (true, [fast, slow]) = (dutch_roll, real.as_mut_slice())
        && fast.eigenvalue_real < 0.0
    {
        fast.name = ModeName::Roll;
        slow.name = ModeName::Spiral;
    }
    Ok(modes)
}

/// An eigenvalue with non-negative imaginary part, and the share of each state.
struct Root {
    eigenvalue: Complex<f64>,
    participation: [f64; 4],
}

impl Root {
    fn oscillates(&self) -> bool {
        self.eigenvalue.im > 0.0
    }

    fn unstable(&self) -> bool {
        self.eigenvalue.re > 0.0
    }

    fn fastest_first(a: &Self, b: &Self) -> core::cmp::Ordering {
        b.eigenvalue.norm().total_cmp(&a.eigenvalue.norm())
    }

    fn named(&self, name: ModeName) -> Mode {
        let Complex { re, im } = self.eigenvalue;
        let magnitude = self.eigenvalue.norm();
        let halving = core::f64::consts::LN_2 / re.abs();
        Mode {
            name,
            eigenvalue_real: re,
            eigenvalue_imaginary: im,
            natural_frequency_rad_s: magnitude,
            damping_ratio: (magnitude > 0.0).then(|| -re / magnitude),
            period_s: (im > 0.0).then(|| core::f64::consts::TAU / im),
            time_to_half_s: (re < 0.0).then_some(halving),
            time_to_double_s: (re > 0.0).then_some(halving),
            participation: self.participation,
        }
    }
}

fn roots(a: &[[f64; 4]; 4]) -> Result<Vec<Root>, ModesError> {
    for (row, entries) in a.iter().enumerate() {
        if let Some(column) = entries.iter().position(|v| !v.is_finite()) {
            return Err(ModesError::NotFinite { row, column, value: entries[column] });
        }
    }
    const ITERATIONS: usize = 1000;
    let matrix = Matrix4::from_fn(|i, j| a[i][j]);
    let schur =
        Schur::try_new(matrix, f64::EPSILON, ITERATIONS).ok_or(ModesError::NoConvergence { iterations: ITERATIONS })?;
    let eigenvalues = schur.complex_eigenvalues();
    // Below this an imaginary part is rounding: a double real root splits by the square root of the precision at most.
    let rounding = 1e-9 * matrix.norm();
    Ok(eigenvalues
        .iter()
        .filter(|e| e.im >= -rounding)
        .map(|e| if e.im.abs() <= rounding { Complex::new(e.re, 0.0) } else { *e })
        .map(|eigenvalue| Root { eigenvalue, participation: participation(&matrix, eigenvalue) })
        .collect())
}

/// Participation factors from the diagonal of `adj(A - lambda I)`, which is `v w^T` up to a factor for a simple
/// eigenvalue. All shares are equal for an eigenvalue that is repeated so often that the adjugate vanishes.
fn participation(a: &Matrix4<f64>, eigenvalue: Complex<f64>) -> [f64; 4] {
    let shifted = a.map(|v| Complex::new(v, 0.0)) - Matrix4::identity() * eigenvalue;
    let cofactors: [f64; 4] = core::array::from_fn(|k| {
        let index = |i: usize| if i < k { i } else { i + 1 };
        Matrix3::from_fn(|i, j| shifted[(index(i), index(j))]).determinant().norm()
    });
    let sum: f64 = cofactors.iter().sum();
    if sum > 0.0 { cofactors.map(|c| c / sum) } else { [0.25; 4] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(modes: &[Mode]) -> Vec<ModeName> {
        modes.iter().map(|m| m.name).collect()
    }

    /// Boeing 747 at Mach 0.8, 40,000 ft, level: A. E. Bryson, Control of Spacecraft and Aircraft, 1994, with eigenvalues
    /// -0.3750 +- 0.8818j (short period) and -0.0005 +- 0.0674j (phugoid). States u, w (ft/s), theta, q.
    #[test]
    fn classical_longitudinal_modes() {
        let a = [
            [-0.003, 0.039, -0.322, 0.0],
            [-0.065, -0.319, 0.0, 7.74],
            [0.0, 0.0, 0.0, 1.0],
            [0.0201, -0.101, 0.0, -0.429],
        ];
        let modes = longitudinal_modes(&a).unwrap();
        assert_eq!(names(&modes), [ModeName::ShortPeriod, ModeName::Phugoid]);
        let [short, phugoid] = &modes[..] else { panic!() };
        assert!((short.eigenvalue_real + 0.3750).abs() < 1e-4, "{short:?}");
        assert!((short.eigenvalue_imaginary - 0.8818).abs() < 1e-4, "{short:?}");
        assert!((phugoid.eigenvalue_real + 0.0005).abs() < 1e-4, "{phugoid:?}");
        assert!((phugoid.eigenvalue_imaginary - 0.0674).abs() < 1e-4, "{phugoid:?}");
        assert!((short.damping_ratio.unwrap() * short.natural_frequency_rad_s + short.eigenvalue_real).abs() < 1e-12);
        assert!((short.time_to_half_s.unwrap() * -short.eigenvalue_real - 2.0_f64.ln()).abs() < 1e-12);
        assert_eq!(short.time_to_double_s, None);
    }

    /// F-16, 502 ft/s, sea level, cg 0.35: the linear model of Stevens & Lewis, with the eigenvalues of the reference
    /// file (stevens_lewis_published.json, linear_longitudinal_recollected).
    #[test]
    fn third_oscillatory_mode_of_the_f16() {
        let a = [
            [-0.0193109, 8.81582, -32.17, -0.574989],
            [-0.000253893, -1.01891, 0.0, 0.905061],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, 0.822098, 0.0, -1.0772],
        ];
        let modes = longitudinal_modes(&a).unwrap();
        assert_eq!(
            names(&modes),
            [ModeName::PitchSubsidence, ModeName::ThirdOscillatory, ModeName::SpeedDivergence],
            "{modes:#?}"
        );
        assert!((modes[0].eigenvalue_real + 1.9116).abs() < 1e-4);
        assert!((modes[1].eigenvalue_real + 0.15069).abs() < 1e-4);
        assert!((modes[1].eigenvalue_imaginary - 0.11533).abs() < 1e-4);
        assert!((modes[2].eigenvalue_real - 0.09755).abs() < 1e-4);
        assert!((modes[2].time_to_double_s.unwrap() - 2.0_f64.ln() / 0.09755).abs() < 0.01);
    }

    /// The lateral model of the same condition (linear_lateral_book_ex_5_3_1). Stevens & Lewis, example 5.3-1: Dutch roll
    /// -0.4224 +- 3.0633j, roll -3.6152, spiral -0.0163.
    #[test]
    fn lateral_modes_of_the_f16() {
        let a = [
            [-0.3220, 0.0640, 0.0364, -0.9917],
            [0.0, 0.0, 1.0, 0.0037],
            [-30.6492, 0.0, -3.6784, 0.6646],
            [8.5396, 0.0, -0.0254, -0.4764],
        ];
        let modes = lateral_modes(&a).unwrap();
        assert_eq!(names(&modes), [ModeName::Roll, ModeName::DutchRoll, ModeName::Spiral], "{modes:#?}");
        assert!((modes[0].eigenvalue_real + 3.6152).abs() < 2e-3, "{}", modes[0].eigenvalue_real);
        assert!((modes[1].eigenvalue_real + 0.4224).abs() < 2e-3, "{}", modes[1].eigenvalue_real);
        assert!((modes[1].eigenvalue_imaginary - 3.0633).abs() < 2e-3, "{}", modes[1].eigenvalue_imaginary);
        assert!((modes[2].eigenvalue_real + 0.0163).abs() < 1e-3, "{}", modes[2].eigenvalue_real);
    }

    #[test]
    fn names_do_not_depend_on_the_units_of_the_states() {
        let a = [
            [-0.0193109, 8.81582, -32.17, -0.574989],
            [-0.000253893, -1.01891, 0.0, 0.905061],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, 0.822098, 0.0, -1.0772],
        ];
        let units = [0.3048, 57.3, 57.3, 57.3];
        let scaled = core::array::from_fn(|i| core::array::from_fn(|j| units[i] * a[i][j] / units[j]));
        for (x, y) in longitudinal_modes(&a).unwrap().iter().zip(&longitudinal_modes(&scaled).unwrap()) {
            assert_eq!(x.name, y.name);
            for k in 0..4 {
                assert!((x.participation[k] - y.participation[k]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_finite_is_refused_by_entry() {
        let mut a = [[0.0; 4]; 4];
        a[2][1] = f64::INFINITY;
        assert_eq!(longitudinal_modes(&a), Err(ModesError::NotFinite { row: 2, column: 1, value: f64::INFINITY }));
        assert!(lateral_modes(&[[0.0; 4]; 4]).is_ok_and(|modes| modes.len() == 4));
    }
}
