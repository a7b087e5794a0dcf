//! The course of one parameter of one airframe over its flights: the mean, a drift, a step, and what fits best.

use serde::Serialize;

use super::distribution::student_two_sided;
use super::sharing::{Owner, part_of};
use crate::row::QUANTITIES;

/// An estimate of the parameter from one segment of one flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Number of the flight, or hours flown.
    pub at: f64,
    /// The estimate, in the unit of the parameter.
    pub value: f64,
    /// The part of its standard error that noise and turbulence make; positive.
    pub random_std: f64,
    /// What a positive error of each declared quantity of one sigma does to it, in the order of
    /// [`UncertainQuantity::ALL`](phugoid_identification::estimation::UncertainQuantity::ALL).
    pub budget: [f64; QUANTITIES],
}

impl Observation {
    /// Variance by which it may differ from another flight of the same airframe.
    fn variance(&self) -> f64 {
        self.random_std.powi(2) + part_of(&self.budget, &[Owner::Loading]).powi(2)
    }
}

/// The weighted mean of the flights of one airframe, and its standard error by parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Combined {
    /// The mean, in the unit of the parameter.
    pub value: f64,
    /// One sigma of it: all parts.
    pub std_error: f64,
    /// The part that further flights make smaller.
    pub random_std: f64,
    /// The part that all flights of this airframe share, and no other airframe.
    pub airframe_std: f64,
    /// The part that all airframes of the type share.
    pub fleet_std: f64,
    /// Scatter of the flights over what they claim for it: one where the claims are right.
    pub dispersion: f64,
}

/// Something that the course does from flight to flight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// A drift: change per unit of [`Observation::at`]; a step: change at once. In the unit of the parameter.
    pub size: f64,
    /// One sigma of it, from the scatter of the flights about what was fitted.
    pub std_error: f64,
    /// A step: the first observation after it lies here; a drift: NaN, written as null.
    pub at: f64,
    /// Probability of as large a change where there is none.
    pub p_value: f64,
    /// Squared weighted residuals that it leaves.
    pub chi_squared: f64,
}

/// A weighted fit to the course, for asking each observation what it does in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The fitted course at each observation.
    pub fitted: Vec<f64>,
    /// Weight of each observation in its own fitted value, 0 to 1.
    pub leverage: Vec<f64>,
    /// Squared weighted residuals.
    pub chi_squared: f64,
    /// Number of what was fitted.
    pub unknowns: usize,
}

/// Fewest observations for a question about drifts and steps, and fewest on each side of a step.
const FEWEST: usize = 6;
const FEWEST_ASIDE: usize = 3;

/// The mean of the flights of one airframe; `None` without an observation.
///
/// The flights are weighted by their random parts. What they share is not averaged away: a quantity moves the mean by
/// [what it does](effects) in each flight.
pub fn combine(observations: &[Observation]) -> Option<Combined> {
    if observations.is_empty() {
        return None;
    }
    let value = mean(observations, |o| o.value);
    let whole: f64 = observations.iter().map(|o| o.random_std.powi(-2)).sum();
    let shared = effects(observations);
    let dispersion = dispersion(constant(observations).chi_squared, observations.len(), 1);
    // Flights that scatter more than they claim are known less well than they claim.
    let random_std = whole.powf(-0.5) * dispersion.max(1.0);
    let airframe_std = part_of(&shared, &[Owner::Airframe, Owner::Loading]);
    let fleet_std = part_of(&shared, &[Owner::Fleet]);
    let std_error = random_std.hypot(airframe_std).hypot(fleet_std);
    Some(Combined { value, std_error, random_std, airframe_std, fleet_std, dispersion })
}

/// The mean of something over the flights, weighted by their random parts.
fn mean(observations: &[Observation], of: impl Fn(&Observation) -> f64) -> f64 {
    let weight = |o: &Observation| o.random_std.powi(-2);
    observations.iter().map(|o| weight(o) * of(o)).sum::<f64>() / observations.iter().map(weight).sum::<f64>()
}

/// What a positive error of each declared quantity of one sigma does to the mean of the flights, in the order of
/// [`UncertainQuantity::ALL`](phugoid_identification::estimation::UncertainQuantity::ALL); NaN without observations.
pub fn effects(observations: &[Observation]) -> [f64; QUANTITIES] {
    std::array::from_fn(|place| mean(observations, |o| o.budget[place]))
}

/// Root of the mean squared weighted residual; one where nothing is left to tell.
fn dispersion(chi_squared: f64, observations: usize, unknowns: usize) -> f64 {
    match observations.saturating_sub(unknowns) {
        0 => 1.0,
        freedom => (chi_squared / freedom as f64).sqrt(),
    }
}

/// The fit of a constant.
pub fn constant(observations: &[Observation]) -> Fit {
    groups(observations, |_| 0)
}

/// The fit of one constant before an observation and another one from there on.
pub fn two_levels(observations: &[Observation], first_after: f64) -> Fit {
    groups(observations, |o| usize::from(o.at >= first_after))
}

fn groups(observations: &[Observation], of: impl Fn(&Observation) -> usize) -> Fit {
    let (mut weight, mut sum) = ([0.0; 2], [0.0; 2]);
    for o in observations {
        weight[of(o)] += 1.0 / o.variance();
        sum[of(o)] += o.value / o.variance();
    }
    let fitted: Vec<f64> = observations.iter().map(|o| sum[of(o)] / weight[of(o)]).collect();
    let leverage = observations.iter().map(|o| 1.0 / (o.variance() * weight[of(o)])).collect();
    let unknowns = weight.iter().filter(|weight| **weight > 0.0).count();
    let chi_squared = chi_squared(observations, &fitted);
    Fit { fitted, leverage, chi_squared, unknowns }
}

fn chi_squared(observations: &[Observation], fitted: &[f64]) -> f64 {
    observations.iter().zip(fitted).map(|(o, f)| (o.value - f).powi(2) / o.variance()).sum()
}

/// The fit of a straight line and its slope with its variance; `None` where all observations lie at one place.
pub fn line(observations: &[Observation]) -> Option<(Fit, f64, f64)> {
    let weights: Vec<f64> = observations.iter().map(|o| 1.0 / o.variance()).collect();
    let whole: f64 = weights.iter().sum();
    let mean = |of: &dyn Fn(&Observation) -> f64| -> f64 {
        observations.iter().zip(&weights).map(|(o, w)| w * of(o)).sum::<f64>() / whole
    };
    let (middle, value) = (mean(&|o| o.at), mean(&|o| o.value));
    let spread = whole * mean(&|o| (o.at - middle).powi(2));
    let slope = whole * mean(&|o| (o.at - middle) * (o.value - value)) / spread;
    if !slope.is_finite() {
        return None;
    }
    let fitted: Vec<f64> = observations.iter().map(|o| value + slope * (o.at - middle)).collect();
    let leverage =
        observations.iter().zip(&weights).map(|(o, w)| w * (1.0 / whole + (o.at - middle).powi(2) / spread)).collect();
    let chi_squared = chi_squared(observations, &fitted);
    Some((Fit { fitted, leverage, chi_squared, unknowns: 2 }, slope, 1.0 / spread))
}

/// The drift of a course; `None` with too few observations.
///
/// The claims of the flights are their weights alone. How much they scatter is taken from the flights themselves, so that the
/// slope over its standard error has Student's t distribution whether the claims are right, too small or too large. They are
/// often too large here: a claim holds what may be wrong with a flight, such as its centre of gravity, and flights that follow
/// one another closely show that it was not.
pub fn drift(observations: &[Observation]) -> Option<Change> {
    let count = observations.len();
    let (fit, slope, variance) = line(observations).filter(|_| count >= FEWEST)?;
    let std_error = variance.sqrt() * dispersion(fit.chi_squared, count, 2);
    let p_value = student_two_sided(over(slope, std_error), (count - 2) as f64);
    Some(Change { size: slope, std_error, at: f64::NAN, p_value, chi_squared: fit.chi_squared })
}

/// A change over its standard error; no change is none, however small its error.
fn over(size: f64, std_error: f64) -> f64 {
    if size == 0.0 { 0.0 } else { size / std_error }
}

/// The most certain step of a course; `None` with too few observations.
///
/// Every place with three observations on both sides is tried, and the p-value is multiplied by the number of places
/// (Bonferroni), so that trying makes no findings.
pub fn step(observations: &[Observation]) -> Option<Change> {
    let count = observations.len();
    if count < FEWEST {
        return None;
    }
    let mut places: Vec<f64> = observations.iter().map(|o| o.at).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let before = |at: f64| observations.iter().filter(|o| o.at < at).count();
    places.retain(|at| (FEWEST_ASIDE..=count - FEWEST_ASIDE).contains(&before(*at)));
    let tried = places.len() as f64;
    let candidates = places.into_iter().filter_map(|at| {
        let change = level_change(observations, at)?;
        Some(Change { p_value: (tried * change.p_value).min(1.0), ..change })
    });
    candidates.min_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared))
}

/// The step of a course at a place that is given: `at` is the first observation after it. `None` with fewer than six observations, or
/// fewer than three on one side.
pub fn level_change(observations: &[Observation], at: f64) -> Option<Change> {
    let count = observations.len();
    let before = observations.iter().filter(|o| o.at < at).count();
    if count < FEWEST || !(FEWEST_ASIDE..=count - FEWEST_ASIDE).contains(&before) {
        return None;
    }
    let weight =
        |side: bool| -> f64 { observations.iter().filter(|o| (o.at >= at) == side).map(|o| 1.0 / o.variance()).sum() };
    let fit = two_levels(observations, at);
    let level = |side: bool| observations.iter().position(|o| (o.at >= at) == side).map(|k| fit.fitted[k]);
    let size = level(true).zip(level(false)).map_or(f64::NAN, |(after, before)| after - before);
    let claimed = (1.0 / weight(true) + 1.0 / weight(false)).sqrt();
    let std_error = claimed * dispersion(fit.chi_squared, count, 2);
    let p_value = student_two_sided(over(size, std_error), (count - 2) as f64);
    Some(Change { size, std_error, at, p_value, chi_squared: fit.chi_squared })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    /// Flights with an error of 0.05 that belongs to the airframe, and one of 0.01 in each flight.
    fn flights(generator: &mut Pcg64Mcg, count: usize, of: impl Fn(f64) -> f64) -> Vec<Observation> {
        let shared = 0.05 * normal(generator);
        let mut budget = [0.0; QUANTITIES];
        budget[0] = 0.05;
        let one = |k: usize, generator: &mut Pcg64Mcg| {
            let at = k as f64;
            Observation { at, value: of(at) + shared + 0.01 * normal(generator), random_std: 0.01, budget }
        };
        (0..count).map(|k| one(k, generator)).collect()
    }

    #[test]
    fn a_mean_is_not_better_than_what_its_flights_share() {
        let mut generator = Pcg64Mcg::seed_from_u64(1);
        let (mut covered, mut by_random) = (0, 0);
        for _ in 0..400 {
            let mean = combine(&flights(&mut generator, 50, |_| -0.5)).unwrap();
            let error = (mean.value + 0.5).abs();
            assert!(mean.airframe_std > 0.049 && mean.random_std < 0.0025);
            covered += usize::from(error <= 2.0 * mean.std_error);
            by_random += usize::from(error <= 2.0 * mean.random_std);
        }
        assert!((370..=392).contains(&covered), "{covered} of 400 within two sigma");
        assert!(by_random < 80, "averaged away they would cover {by_random} of 400");
    }

    #[test]
    fn steady_courses_are_seldom_called_otherwise() {
        let mut generator = Pcg64Mcg::seed_from_u64(2);
        let (mut drifts, mut steps) = (0, 0);
        for _ in 0..1000 {
            let course = flights(&mut generator, 30, |_| 1.0);
            drifts += usize::from(drift(&course).unwrap().p_value < 0.05);
            steps += usize::from(step(&course).unwrap().p_value < 0.05);
        }
        assert!((15..=70).contains(&drifts), "{drifts} drifts in 1000 steady courses at 5 %");
        assert!(steps <= 60, "{steps} steps in 1000 steady courses at 5 %");
    }

    #[test]
    fn drifts_and_steps_are_found_and_told_apart() {
        let mut generator = Pcg64Mcg::seed_from_u64(3);
        // A drift of three standard errors of one flight over all, and a step of two.
        let drifting = flights(&mut generator, 40, |at| -0.5 - 0.03 * at / 40.0);
        let (line, level) = (drift(&drifting).unwrap(), step(&drifting).unwrap());
        assert!(line.p_value < 1e-6 && line.p_value < level.p_value);
        assert!((line.size + 0.03 / 40.0).abs() < 3.0 * line.std_error);
        let stepping = flights(&mut generator, 40, |at| if at < 25.0 { -0.5 } else { -0.52 });
        let (line, level) = (drift(&stepping).unwrap(), step(&stepping).unwrap());
        assert!(level.p_value < 1e-4 && level.p_value < line.p_value);
        assert!((level.at - 25.0).abs() <= 3.0 && (level.size + 0.02).abs() < 3.0 * level.std_error);
    }

    /// Flights that claim a third or three times their scatter must not find more or less than others.
    #[test]
    fn wrong_claims_make_and_hide_no_findings() {
        let mut generator = Pcg64Mcg::seed_from_u64(4);
        for claim in [1.0 / 3.0, 3.0] {
            let (mut falsely, mut found) = (0, 0);
            for _ in 0..500 {
                let mut course = flights(&mut generator, 30, |_| 1.0);
                course.iter_mut().for_each(|o| o.random_std *= claim);
                let mean = combine(&course).unwrap();
                assert!((mean.dispersion * claim - 1.0).abs() < 0.5);
                // What flights claim too much is not taken from the mean's bound.
                assert!(mean.random_std > 0.9 * 0.01 / 30.0_f64.sqrt() * claim.max(0.5));
                falsely += usize::from(drift(&course).unwrap().p_value < 0.05);
                course.iter_mut().for_each(|o| o.value += 0.001 * o.at);
                // 4.7 standard errors: by Student's t with 28 degrees of freedom, 97 of 100 are found at 1 %.
                found += usize::from(drift(&course).unwrap().p_value < 0.01);
            }
            assert!((8..=45).contains(&falsely), "{falsely} of 500 at 5 %, claim {claim}");
            assert!(found > 450, "{found} of 500, claim {claim}");
        }
        let still: Vec<Observation> =
            flights(&mut generator, 9, |_| 0.0).into_iter().map(|o| Observation { value: 1.0, ..o }).collect();
        assert_eq!(drift(&still).unwrap().p_value, 1.0);
    }

    #[test]
    fn few_flights_and_flights_at_one_place_are_not_asked() {
        let mut generator = Pcg64Mcg::seed_from_u64(5);
        assert!(combine(&[]).is_none() && drift(&flights(&mut generator, 5, |_| 0.0)).is_none());
        let mut course = flights(&mut generator, 9, |_| 0.0);
        assert_eq!(combine(&course[..1]).unwrap().dispersion, 1.0);
        course.iter_mut().for_each(|o| o.at = 2.0);
        assert!(drift(&course).is_none() && step(&course).is_none());
    }
}
