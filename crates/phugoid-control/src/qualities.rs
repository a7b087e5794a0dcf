//! Handling-quality levels of MIL-F-8785C (1980): short period (3.2.2.1, table IV and figure 1), phugoid (3.2.1.2), Dutch roll
//! (table VI), roll (table VII), spiral (table VIII) and the coupled roll-spiral oscillation (3.3.1.4), of an aircraft whose modes are near
//! the classical ones.
//!
//! The numbers are those of the standard for class IV (manoeuvrable aircraft); where a table lists several classes, that row is
//! taken. Level 1: clearly adequate for the phase of flight; 2: adequate with more work for the pilot; 3: can be controlled safely,
//! but the work is excessive; worse: less than that.

use crate::roots::{Root, eigenvalues};

/// A level of flying qualities. Smaller is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Level {
    /// Clearly adequate for the mission.
    One,
    /// Adequate, with some increase of the pilot's workload.
    Two,
    /// Safe control is possible, with excessive workload.
    Three,
    /// Not even level 3.
    Worse,
}

/// A category of flight phases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Category {
    /// Rapid manoeuvring, precise tracking.
    A,
    /// Climb, cruise, descent.
    #[default]
    B,
    /// Take-off, approach, landing.
    C,
}

/// The levels of each mode; `None` where the aircraft has no such mode, because it has merged with another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Qualities {
    /// Short period: frequency (rad/s), damping ratio, control anticipation parameter (rad^2/s^2 per g), and its level.
    pub short_period: Option<(f64, f64, f64, Level)>,
    /// Dutch roll: frequency (rad/s), damping ratio and level.
    pub dutch_roll: Option<(f64, f64, Level)>,
    /// Roll: time constant (s) and level.
    pub roll: Option<(f64, Level)>,
    /// Spiral: time to double (s, infinite where it is stable) and level.
    pub spiral: Option<(f64, Level)>,
    /// Coupled roll-spiral oscillation, of an aircraft that has it in place of both of them: frequency (rad/s), damping ratio and level.
    pub roll_spiral: Option<(f64, f64, Level)>,
}

/// Number of [`Qualities::numbers`].
pub(crate) const NUMBERS: usize = 9;

impl Qualities {
    /// The level in pitch: that of the short period; worse than level 3 where there is none.
    pub fn pitch_level(&self) -> Level {
        self.short_period.map_or(Level::Worse, |(.., level)| level)
    }

    /// The worst level of Dutch roll, roll and spiral, or of Dutch roll and the coupled roll-spiral oscillation; worse than level 3 where
    /// one is missing.
    pub fn lateral_level(&self) -> Level {
        let coupled = self.roll_spiral.map(|(.., level)| level);
        let levels = [
            self.dutch_roll.map(|(.., level)| level),
            coupled.or(self.roll.map(|(_, level)| level)),
            coupled.or(self.spiral.map(|(_, level)| level)),
        ];
        levels.into_iter().map(|level| level.unwrap_or(Level::Worse)).max().unwrap_or(Level::Worse)
    }

    /// The numbers that levels are judged by, each smooth in the derivatives; NaN where the mode is missing.
    pub(crate) fn numbers(&self) -> [f64; NUMBERS] {
        let [frequency, damping, anticipation] = self
            .short_period
            .map_or([f64::NAN; 3], |(frequency, damping, anticipation, _)| [frequency, damping, anticipation]);
        let [dutch_frequency, dutch_damping] =
            self.dutch_roll.map_or([f64::NAN; 2], |(frequency, damping, _)| [frequency, damping]);
        let roll = self.roll.map_or(f64::NAN, |(constant, _)| 1.0 / constant);
        // Zero where it is stable: the time to double is infinite.
        let spiral = self.spiral.map_or(f64::NAN, |(double, _)| 1.0 / double);
        let product = dutch_frequency * dutch_damping;
        let roll_spiral = self.roll_spiral.map_or(f64::NAN, |(frequency, damping, _)| frequency * damping);
        [frequency, damping, anticipation, dutch_frequency, dutch_damping, product, roll, spiral, roll_spiral]
    }

    /// The worst level of all modes. A mode that is missing counts as worse than level 3.
    pub fn level(&self) -> Level {
        self.pitch_level().max(self.lateral_level())
    }
}

/// The levels of an aircraft with the matrix `a` of its motion, states `[alpha, beta, phi, p, q, r]`
/// ([`LocalModel::closed_loop`](crate::local::LocalModel::closed_loop)), and `n/alpha` in g per rad. Longitudinal and lateral motion are taken apart.
pub fn qualities(a: &[[f64; 6]; 6], load_factor_per_alpha: f64, category: Category) -> Qualities {
    let pitch = [[a[0][0], a[0][4]], [a[4][0], a[4][4]]];
    const LATERAL: [usize; 4] = [1, 2, 3, 5];
    let lateral: [[f64; 4]; 4] = LATERAL.map(|i| LATERAL.map(|j| a[i][j]));
    let short_period = eigenvalues(&pitch).map(|roots| of_short_period(&roots, load_factor_per_alpha, category));
    let lateral = eigenvalues(&lateral).map(|roots| of_lateral(&roots, category));
    let Lateral { dutch_roll, roll, spiral, roll_spiral } = lateral.unwrap_or_default();
    Qualities { short_period, dutch_roll, roll, spiral, roll_spiral }
}

/// The first of three levels that holds.
fn first(holds: [bool; 3]) -> Level {
    match holds {
        [true, _, _] => Level::One,
        [_, true, _] => Level::Two,
        [_, _, true] => Level::Three,
        _ => Level::Worse,
    }
}

/// Level of a short period with this frequency (rad/s), damping ratio and `n/alpha` (g/rad); frequency and damping of two real roots
/// are those of their product and sum, as the standard has it for an overdamped motion.
pub fn short_period_level(frequency: f64, damping: f64, load_factor_per_alpha: f64, category: Category) -> Level {
    let anticipation = frequency * frequency / load_factor_per_alpha;
    let (dampings, anticipations, frequencies) = match category {
        Category::A => {
            ([[0.35, 1.30], [0.25, 2.0], [0.15, 1e9]], [[0.28, 3.6], [0.16, 10.0], [0.16, 1e9]], [1.0, 0.6, 0.0])
        }
        Category::B => ([[0.30, 2.0], [0.20, 2.0], [0.15, 1e9]], [[0.085, 3.6], [0.038, 10.0], [0.038, 1e9]], [0.0; 3]),
        Category::C => {
            ([[0.35, 1.30], [0.25, 2.0], [0.15, 1e9]], [[0.16, 3.6], [0.096, 10.0], [0.096, 1e9]], [0.87, 0.6, 0.0])
        }
    };
    let within = |value: f64, [low, high]: [f64; 2]| value >= low && value <= high;
    first(core::array::from_fn(|i| {
        within(damping, dampings[i]) && within(anticipation, anticipations[i]) && frequency >= frequencies[i]
    }))
}

fn of_short_period(roots: &[Root; 2], load_factor_per_alpha: f64, category: Category) -> (f64, f64, f64, Level) {
    let [a, b] = roots;
    let product = a.real * b.real - a.imaginary * b.imaginary;
    let sum = a.real + b.real;
    if product <= 0.0 {
        // One real root grows: no frequency to speak of.
        return (0.0, 0.0, 0.0, Level::Worse);
    }
    let frequency = libm::sqrt(product);
    let damping = -0.5 * sum / frequency;
    let level = short_period_level(frequency, damping, load_factor_per_alpha, category);
    (frequency, damping, frequency * frequency / load_factor_per_alpha, level)
}

/// The lateral modes of [`Qualities`].
#[derive(Default)]
struct Lateral {
    dutch_roll: Option<(f64, f64, Level)>,
    roll: Option<(f64, Level)>,
    spiral: Option<(f64, Level)>,
    roll_spiral: Option<(f64, f64, Level)>,
}

fn of_lateral(roots: &[Root; 4], category: Category) -> Lateral {
    // The fastest oscillation is the Dutch roll; a second one is roll and spiral together. Of the real roots the fastest is the roll and
    // the slowest the spiral.
    let oscillations = || roots.iter().filter(|root| root.imaginary > 0.0);
    let with_level = |root: &Root, level: fn(f64, f64, Category) -> Level| {
        (root.frequency(), root.damping(), level(root.frequency(), root.damping(), category))
    };
    let by_frequency = |a: &&Root, b: &&Root| a.frequency().total_cmp(&b.frequency());
    let fastest_oscillation = oscillations().max_by(by_frequency).map(|root| with_level(root, dutch_roll_level));
    let dutch_roll = fastest_oscillation.or_else(|| overdamped_dutch_roll(roots, category));
    let slower = oscillations().min_by(by_frequency).filter(|_| oscillations().count() == 2);
    let roll_spiral = slower.map(|root| with_level(root, roll_spiral_level));
    let real = roots.iter().filter(|root| root.imaginary == 0.0);
    let fastest = real.clone().min_by(|a, b| a.real.total_cmp(&b.real));
    let slowest = real.max_by(|a, b| a.real.total_cmp(&b.real));
    let roll = fastest.filter(|root| root.real < 0.0).map(|root| {
        let constant = -1.0 / root.real;
        let limits = match category {
            Category::A | Category::C => [1.0, 1.4, 10.0],
            Category::B => [1.4, 3.0, 10.0],
        };
        (constant, first(limits.map(|limit| constant <= limit)))
    });
    let spiral = slowest.map(|root| {
        let double = if root.real > 0.0 { core::f64::consts::LN_2 / root.real } else { f64::INFINITY };
        let limits = match category {
            Category::A | Category::C => [12.0, 8.0, 4.0],
            Category::B => [20.0, 8.0, 4.0],
        };
        (double, first(limits.map(|limit| double >= limit)))
    });
    Lateral { dutch_roll, roll, spiral, roll_spiral }
}

/// The Dutch roll of four real roots: the two between roll and spiral, with the frequency and damping of their product and sum, as of an
/// overdamped short period. None if one of them grows.
fn overdamped_dutch_roll(roots: &[Root; 4], category: Category) -> Option<(f64, f64, Level)> {
    let mut real = roots.map(|root| root.real);
    real.sort_unstable_by(f64::total_cmp);
    let [_, faster, slower, _] = real;
    (slower < 0.0).then(|| {
        let frequency = libm::sqrt(faster * slower);
        let damping = -0.5 * (faster + slower) / frequency;
        (frequency, damping, dutch_roll_level(frequency, damping, category))
    })
}

/// Level of a coupled roll-spiral oscillation with this frequency (rad/s) and damping ratio (3.3.1.4). Phases of category A, which ask for
/// more than gentle manoeuvres, permit none, whatever its damping.
pub fn roll_spiral_level(frequency: f64, damping: f64, category: Category) -> Level {
    match category {
        Category::A => Level::Worse,
        Category::B | Category::C => first([0.5, 0.3, 0.15].map(|product| damping * frequency >= product)),
    }
}

/// Level of a Dutch roll with this frequency (rad/s) and damping ratio.
pub fn dutch_roll_level(frequency: f64, damping: f64, category: Category) -> Level {
    let one = match category {
        Category::A => [0.19, 0.35, 1.0],
        Category::B => [0.08, 0.15, 0.4],
        Category::C => [0.08, 0.15, 1.0],
    };
    let rows = [one, [0.02, 0.05, 0.4], [0.0, f64::NEG_INFINITY, 0.4]];
    first(
        rows.map(|[ratio, product, lowest]| damping >= ratio && damping * frequency >= product && frequency >= lowest),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::Gains;
    use crate::gains::tests::fighter;
    use crate::target::Targets;

    /// Points on either side of printed limits: category B, damping .30 and .20, CAP .085 and 3.6.
    #[test]
    fn limits_of_the_standard() {
        let level = |frequency: f64, damping: f64| short_period_level(frequency, damping, 20.0, Category::B);
        assert_eq!(level(2.0, 0.31), Level::One);
        assert_eq!(level(2.0, 0.29), Level::Two);
        assert_eq!(level(2.0, 0.19), Level::Three);
        assert_eq!(level(2.0, 0.14), Level::Worse);
        assert_eq!(level((0.084_f64 * 20.0).sqrt(), 0.7), Level::Two);
        assert_eq!(level((3.7_f64 * 20.0).sqrt(), 0.7), Level::Two);
        assert_eq!(dutch_roll_level(2.0, 0.081, Category::B), Level::One);
        assert_eq!(dutch_roll_level(2.0, 0.079, Category::B), Level::Two);
        assert_eq!(dutch_roll_level(2.0, -0.01, Category::B), Level::Worse);
        assert_eq!(roll_spiral_level(1.0, 0.51, Category::B), Level::One);
        assert_eq!(roll_spiral_level(1.0, 0.49, Category::C), Level::Two);
        assert_eq!(roll_spiral_level(0.5, 0.59, Category::B), Level::Three);
        assert_eq!(roll_spiral_level(0.5, 0.29, Category::B), Level::Worse);
        assert_eq!(roll_spiral_level(1.0, 0.9, Category::A), Level::Worse);
    }

    /// Two oscillations, of 2.4 rad/s (damping ratio 0.5) and of 0.8 rad/s (0.75), in place of Dutch roll, roll and spiral.
    #[test]
    fn roll_and_spiral_may_be_one_oscillation() {
        let pair = |frequency: f64, damping: f64| {
            let real = -frequency * damping;
            let imaginary = frequency * (1.0 - damping * damping).sqrt();
            [Root { real, imaginary }, Root { real, imaginary: -imaginary }]
        };
        let roots = [pair(0.8, 0.75), pair(2.4, 0.5)];
        let [a, b, c, d] = [roots[0][0], roots[0][1], roots[1][0], roots[1][1]];
        let Lateral { dutch_roll, roll, spiral, roll_spiral } = of_lateral(&[a, b, c, d], Category::B);
        let (dutch, coupled) = (dutch_roll.unwrap(), roll_spiral.unwrap());
        assert!((dutch.0 - 2.4).abs() < 1e-12 && (coupled.0 - 0.8).abs() < 1e-12 && (coupled.1 - 0.75).abs() < 1e-12);
        assert_eq!((roll, spiral, coupled.2), (None, None, Level::One));
        let found = Qualities { short_period: None, dutch_roll, roll, spiral, roll_spiral };
        assert_eq!(found.lateral_level(), Level::One);
    }

    /// Without an oscillation the two real roots between roll and spiral are the Dutch roll, as of a yaw damper that is strong.
    #[test]
    fn a_dutch_roll_may_be_overdamped() {
        let real = |real: f64| Root { real, imaginary: 0.0 };
        let found = of_lateral(&[real(-2.0), real(-0.01), real(-5.5), real(-3.0)], Category::B);
        let (frequency, damping, level) = found.dutch_roll.unwrap();
        assert!((frequency - 6.0_f64.sqrt()).abs() < 1e-12 && (damping - 2.5 / 6.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!((level, found.roll.unwrap().1, found.spiral.unwrap().1), (Level::One, Level::One, Level::One));
        let grows = of_lateral(&[real(-2.0), real(0.5), real(-5.5), real(0.1)], Category::B);
        assert_eq!(grows.dutch_roll, None);
    }

    #[test]
    fn the_default_targets_are_level_one() {
        let model = fighter();
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let found = qualities(&model.closed_loop(&gains.feedback()), model.load_factor_per_alpha(), Category::B);
        assert_eq!(found.level(), Level::One, "{found:?}");
        // Without gains the fighter diverges in pitch.
        let found = qualities(&model.closed_loop(&[[0.0; 5]; 3]), model.load_factor_per_alpha(), Category::B);
        assert_eq!(found.short_period.unwrap().3, Level::Worse);
    }
}
