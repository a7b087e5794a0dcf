//! Errors drawn from what the model files declare, put into healthy flights: whether the bounds hold them, with what is
//! declared and without it, and whether the largest contributor is named.

use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{EstimationStatus, UncertainQuantity};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::DatabasePart;
use serde::Serialize;

use super::trial::Flight;
use super::truth::TrueParameter;
use crate::put_in::declared::{SITES, Sizes};
use crate::put_in::fault::draw_below;

/// How the errors are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Draw {
    /// None at all.
    None,
    /// All at once.
    All,
    /// Those of one quantity.
    One(UncertainQuantity),
}

/// One parameter of one flight with drawn errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnParameter {
    /// Its name.
    pub name: String,
    /// What is true about the centre of gravity that the model file means.
    pub truth: f64,
    /// The estimate.
    pub value: f64,
    /// One sigma without what is declared.
    pub random_std: f64,
    /// One sigma of the declared part, followed through the estimation.
    pub followed_std: f64,
    /// The same by the powers of the scales.
    pub powers_std: f64,
}

/// A flight with drawn errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnTrial {
    /// Aircraft and flight.
    pub flight: String,
    /// Which errors.
    pub draw: Draw,
    /// The parameters that count; none where the flight is refused.
    pub parameters: Vec<DrawnParameter>,
}

/// Where the declared part of a bound comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Budget {
    /// None: noise and colour alone.
    None,
    /// The powers of the scales.
    Powers,
    /// Followed through the estimation.
    Followed,
    /// The same of a model file that declares half of what the errors are drawn from.
    Half,
    /// The same of a model file that declares twice as much.
    Twice,
}

/// The numbers of some trials with one kind of bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnSummary {
    /// Which errors the flights have.
    pub draw: Draw,
    /// Which bounds.
    pub budget: Budget,
    /// Flights that gave numbers, and their parameters.
    pub flights: usize,
    /// Parameters that count.
    pub parameters: usize,
    /// Part of them whose truth lies within two standard errors.
    pub covered: f64,
    /// Root mean square of the claimed standard errors over that of the errors, each as a part of the truth.
    pub claimed_over_actual: f64,
    /// Median of the claimed two standard errors, as a part of the truth.
    pub width: f64,
}

/// What was named as the largest contributor, against flights in which each really was wrong by one sigma.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ranking {
    /// Parameters that were looked at.
    pub parameters: usize,
    /// Those of which the quantity that is named first moves the estimate most.
    pub named_rightly: usize,
    /// Those of which the quantity that moves it most, or one that moves it by at least four fifths of that, is named first.
    pub named_nearly: usize,
    /// Of each parameter, what the re-runs give for its systematic standard error over what is claimed: quartiles.
    pub rerun_over_claimed: [f64; 3],
}

/// The study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnStudy {
    /// The method.
    pub method: Method,
    /// By draw and budget.
    pub summaries: Vec<DrawnSummary>,
    /// The largest contributors; none without re-runs.
    pub ranking: Option<Ranking>,
    /// Every trial.
    pub trials: Vec<DrawnTrial>,
}

/// The quantity that is named first, if any is.
type Named = Option<UncertainQuantity>;
/// Of a parameter: what is named first, the variance that each quantity makes by re-runs, and the claimed standard error.
type Ranked = (Named, [f64; UncertainQuantity::ALL.len()], f64);

/// The flight with errors of these sizes in it: its parameters, and what is named first for each. None where it gives no
/// numbers that may be used.
fn run(flight: &Flight, method: Method, sizes: &Sizes) -> Option<(Vec<DrawnParameter>, Vec<Named>)> {
    let wrong = flight.with(sizes);
    let (record, model) = (wrong.record.as_ref().ok()?, &wrong.model);
    let structure = StructureSearch::Never;
    let options = EstimateOptions { method: Some(method), structure, ..EstimateOptions::default() };
    let estimation = estimate(record, model, &options, &mut |_| {}).ok()?;
    if estimation.status == EstimationStatus::Refused {
        return None;
    }
    let mut named = Vec::new();
    let mut parameters = Vec::new();
    let counts = |name: &String| flight.truth.at_end().get(name).is_some_and(TrueParameter::counts);
    for (name, p) in wrong.truth.at_end().iter().filter(|(name, _)| counts(name)) {
        let Some(found) = estimation.parameter(name) else { continue };
        let Some(declared) = model.parameters.iter().find(|declared| declared.name == *name) else { continue };
        named.push(found.systematic_parts.first().map(|part| part.quantity));
        parameters.push(DrawnParameter {
            name: name.clone(),
            truth: p.value,
            value: found.value,
            random_std: found.random_std(),
            followed_std: found.systematic_std,
            powers_std: model.by_powers(declared, &DatabasePart::default()).std(found.value),
        });
    }
    Some((parameters, named))
}

/// Quantities of which an error can be drawn: all but the tables of a base, which stand last and which no flight of the field has.
const DRAWN: usize = UncertainQuantity::ALL.len() - 1;
const _: () = assert!(matches!(UncertainQuantity::ALL[DRAWN], UncertainQuantity::BaseTables));

/// The draw of number `k`: none, all and one at a time in turn, so that every row has as many flights.
fn draw_of(k: usize) -> Draw {
    let rows = DRAWN + 2;
    match k % rows {
        0 => Draw::None,
        1 => Draw::All,
        row => Draw::One(UncertainQuantity::ALL[row - 2]),
    }
}

/// A task of the study: how errors are drawn, and the flight.
pub(super) fn tasks(per_row: usize, flights: usize) -> Vec<(Draw, usize, usize)> {
    let rows = DRAWN + 2;
    (0..per_row * rows).map(|k| (draw_of(k), draw_below(k / rows, flights), k)).collect()
}

/// One flight with drawn errors.
pub(super) fn trial(flight: &Flight, method: Method, draw: Draw, number: usize) -> DrawnTrial {
    let wanted = |quantity| match draw {
        Draw::None => false,
        Draw::All => true,
        Draw::One(one) => one == quantity,
    };
    let sizes = Sizes::drawn(&flight.model.uncertainty, number as u64, wanted);
    let parameters = run(flight, method, &sizes).map_or_else(Vec::new, |(parameters, _)| parameters);
    DrawnTrial { flight: format!("{}/{}", flight.truth.aircraft, flight.truth.flight), draw, parameters }
}

/// Of each parameter of a flight: what is named first, the variance that each quantity makes by re-runs with one sigma of
/// each, and the claimed one.
pub(super) fn rank(flight: &Flight, method: Method) -> Vec<Ranked> {
    let Some((clean, named)) = run(flight, method, &Sizes::NONE) else { return Vec::new() };
    let mut variances = vec![[0.0; UncertainQuantity::ALL.len()]; clean.len()];
    for (i, site) in SITES.iter().enumerate() {
        let sigma = flight.model.uncertainty.of_quantity(site.quantity);
        let Some((wrong, _)) = run(flight, method, &Sizes::of_one(i, sigma)).filter(|_| sigma > 0.0) else { continue };
        for (variances, clean) in variances.iter_mut().zip(&clean) {
            if let Some(wrong) = wrong.iter().find(|wrong| wrong.name == clean.name) {
                // What is true may have moved as well: the centre of gravity.
                let moved = (wrong.value - wrong.truth) - (clean.value - clean.truth);
                variances[site.quantity as usize] += moved * moved;
            }
        }
    }
    named.into_iter().zip(variances).zip(clean).map(|((n, v), c)| (n, v, c.followed_std)).collect()
}

/// The ranking of all flights that were re-run.
pub(super) fn ranking(found: Vec<Ranked>) -> Ranking {
    let mut ranking = Ranking::default();
    let mut ratios = Vec::new();
    for (named, variances, claimed) in found {
        let largest = variances.iter().copied().fold(0.0, f64::max);
        let Some(named) = named.filter(|_| largest > 0.0) else { continue };
        ranking.parameters += 1;
        let own = variances[named as usize];
        ranking.named_rightly += usize::from(own == largest);
        ranking.named_nearly += usize::from(own >= 0.64 * largest);
        ratios.push(variances.iter().sum::<f64>().sqrt() / claimed);
    }
    ratios.sort_by(f64::total_cmp);
    if !ratios.is_empty() {
        ranking.rerun_over_claimed =
            [0.25, 0.5, 0.75].map(|q| ratios[(q * (ratios.len() - 1) as f64).round() as usize]);
    }
    ranking
}

/// The study of its trials.
///
/// Of a method that learns what a flight says of declared errors the estimate depends on what is declared: half and twice as much, and the powers
/// of the scales, are told only without it.
pub(super) fn study(method: Method, learns: bool, trials: Vec<DrawnTrial>, ranking: Option<Ranking>) -> DrawnStudy {
    let mut draws: Vec<Draw> = trials.iter().map(|t| t.draw).collect();
    draws.sort_unstable();
    draws.dedup();
    let mut summaries = Vec::new();
    for draw in draws {
        let of: Vec<&DrawnTrial> = trials.iter().filter(|t| t.draw == draw && !t.parameters.is_empty()).collect();
        let of_learning: &[Budget] = &[Budget::None, Budget::Followed];
        let of_others: &[Budget] = &[Budget::None, Budget::Powers, Budget::Followed, Budget::Half, Budget::Twice];
        for &budget in if learns { of_learning } else { of_others } {
            summaries.push(summary(draw, budget, &of));
        }
    }
    DrawnStudy { method, summaries, ranking, trials }
}

fn summary(draw: Draw, budget: Budget, trials: &[&DrawnTrial]) -> DrawnSummary {
    // Error and claim, as parts of the truth.
    let mut pairs: Vec<[f64; 2]> = Vec::new();
    for p in trials.iter().flat_map(|t| &t.parameters) {
        let systematic = match budget {
            Budget::None => 0.0,
            Budget::Powers => p.powers_std,
            Budget::Followed => p.followed_std,
            // What is followed is in proportion to what is declared, and the estimate does not depend on it.
            Budget::Half => 0.5 * p.followed_std,
            Budget::Twice => 2.0 * p.followed_std,
        };
        pairs.push([(p.value - p.truth) / p.truth, p.random_std.hypot(systematic) / p.truth].map(f64::abs));
    }
    let count = pairs.len() as f64;
    let rms = |i: usize| (pairs.iter().map(|pair| pair[i] * pair[i]).sum::<f64>() / count).sqrt();
    DrawnSummary {
        draw,
        budget,
        flights: trials.len(),
        parameters: pairs.len(),
        covered: pairs.iter().filter(|[error, claim]| *error <= 2.0 * claim).count() as f64 / count,
        claimed_over_actual: rms(1) / rms(0),
        width: 2.0 * crate::statistics::median(pairs.iter().map(|pair| pair[1]).collect()),
    }
}
