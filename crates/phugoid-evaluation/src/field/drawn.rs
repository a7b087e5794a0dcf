//! Errors drawn from what the model files declare, put into healthy flights: whether the bounds hold them, with what is
//! declared and without it, and whether the largest contributor is named.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{EstimationStatus, UncertainQuantity};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{AirDensity, DatabasePart, ModelFile, Thrust};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::corruption::{constant, delay, draw_below, each, reread};
use super::trial::Flight;
use super::truth::TrueParameter;

/// One error of its own: a quantity, and of which sensor, surface or axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Site {
    /// The quantity, whose declared uncertainty is that of each of its sites.
    pub quantity: UncertainQuantity,
    /// The channel or constant; empty where there is one alone.
    pub of: &'static str,
}

const fn site(quantity: UncertainQuantity, of: &'static str) -> Site {
    Site { quantity, of }
}

/// All sites.
pub const SITES: [Site; 30] = [
    site(UncertainQuantity::AirspeedScale, "true_airspeed"),
    site(UncertainQuantity::AirspeedPerAlpha, "true_airspeed"),
    site(UncertainQuantity::AirDensity, ""),
    site(UncertainQuantity::FlowAngleScale, "alpha"),
    site(UncertainQuantity::FlowAngleScale, "beta"),
    site(UncertainQuantity::FlowAngleZero, "alpha"),
    site(UncertainQuantity::FlowAngleZero, "beta"),
    site(UncertainQuantity::FlowAngleLag, "alpha"),
    site(UncertainQuantity::FlowAngleLag, "beta"),
    site(UncertainQuantity::FlowAnglePosition, "alpha"),
    site(UncertainQuantity::FlowAnglePosition, "beta"),
    site(UncertainQuantity::SurfaceScale, "elevator"),
    site(UncertainQuantity::SurfaceScale, "aileron"),
    site(UncertainQuantity::SurfaceScale, "rudder"),
    site(UncertainQuantity::SurfaceSkew, ""),
    site(UncertainQuantity::SurfacePlay, "elevator"),
    site(UncertainQuantity::SurfacePlay, "aileron"),
    site(UncertainQuantity::SurfacePlay, "rudder"),
    site(UncertainQuantity::AccelerationScale, "ax"),
    site(UncertainQuantity::AccelerationScale, "ay"),
    site(UncertainQuantity::AccelerationScale, "az"),
    site(UncertainQuantity::AccelerationPosition, "ahead"),
    site(UncertainQuantity::AccelerationPosition, "below"),
    site(UncertainQuantity::Mass, ""),
    site(UncertainQuantity::Inertia, "ixx"),
    site(UncertainQuantity::Inertia, "iyy"),
    site(UncertainQuantity::Inertia, "izz"),
    site(UncertainQuantity::CentreOfGravity, ""),
    site(UncertainQuantity::Geometry, ""),
    site(UncertainQuantity::Thrust, ""),
];

impl Site {
    /// Puts an error of size `c` (in the unit of the quantity) into a flight, its model file and what is true about the
    /// centre of gravity that the model file means: a sensor shows `(1 + c)` times what is true, `c` radians more, or what was true `c`
    /// seconds before, or stands `c` metres ahead or below; the aircraft has `(1 + c)` times what the model file says, its centre of
    /// gravity `c` chords behind, or as much play between what is recorded and a surface as `c` has, whatever its sign.
    fn apply(self, c: f64, record: &mut Record, model: &mut ModelFile, truth: &mut BTreeMap<String, TrueParameter>) {
        match self.quantity {
            UncertainQuantity::AirspeedScale
            | UncertainQuantity::FlowAngleScale
            | UncertainQuantity::SurfaceScale
            | UncertainQuantity::AccelerationScale => each(record, self.of, |v| v * (1.0 + c)),
            UncertainQuantity::AirspeedPerAlpha => {
                let mut alpha = values(record, "alpha").into_iter();
                each(record, self.of, |v| {
                    let here = alpha.next().filter(|a| a.is_finite()).unwrap_or(0.0);
                    v * (1.0 + c * here)
                });
            }
            UncertainQuantity::AirDensity => {
                each(record, "air_density", |v| v * (1.0 + c));
                match &mut model.aircraft.air_density {
                    AirDensity::Known(source) => constant(source, 1.0 + c),
                    // As much denser as the air is so far below.
                    AirDensity::StandardAtmosphere | AirDensity::BookAtmosphere => {
                        each(record, "altitude", |v| v - c * DENSITY_HEIGHT_M);
                    }
                }
            }
            UncertainQuantity::FlowAngleZero => each(record, self.of, |v| v + c),
            UncertainQuantity::FlowAngleLag => delay(record, self.of, c),
            UncertainQuantity::FlowAnglePosition => {
                let (rate, sign) = if self.of == "alpha" { ("q", -1.0) } else { ("r", 1.0) };
                let speeds = values(record, "true_airspeed");
                let moved: Vec<f64> =
                    values(record, rate).iter().zip(speeds).map(|(rate, v)| sign * c * rate / v).collect();
                add(record, self.of, &moved);
            }
            UncertainQuantity::AccelerationPosition => {
                let arm = if self.of == "ahead" { [c, 0.0, 0.0] } else { [0.0, 0.0, c] };
                for (name, moved) in ["ax", "ay", "az"].into_iter().zip(felt_at(record, arm)) {
                    add(record, name, &moved);
                }
            }
            UncertainQuantity::SurfacePlay => {
                // What is recorded lies ahead of the surface by half the play, after it has moved that far in one direction.
                let half = 0.5 * c.abs();
                let (mut ahead, mut before) = (0.0_f64, None);
                each(record, self.of, |v| {
                    if v.is_finite() {
                        ahead = (ahead + v - before.replace(v).unwrap_or(v)).clamp(-half, half);
                    }
                    v + ahead
                });
            }
            UncertainQuantity::SurfaceSkew => {
                ["elevator", "aileron", "rudder"].into_iter().for_each(|name| delay(record, name, c));
            }
            UncertainQuantity::Mass => constant(&mut model.aircraft.mass, 1.0 / (1.0 + c)),
            UncertainQuantity::Inertia => {
                let aircraft = &mut model.aircraft;
                let place = match self.of {
                    "ixx" => aircraft.ixx.as_mut(),
                    "izz" => aircraft.izz.as_mut(),
                    _ => Some(&mut aircraft.iyy),
                };
                place.into_iter().for_each(|source| constant(source, 1.0 / (1.0 + c)));
            }
            UncertainQuantity::CentreOfGravity => {
                // The derivatives about the centre of gravity that the model file means: `Cm - c CN`, `Cn + c CY cbar/b`.
                let before = truth.clone();
                let arm = model.aircraft.wing_span.map_or(0.0, |span| model.aircraft.mean_chord / span);
                for (name, value) in truth.iter_mut() {
                    let from =
                        |force: &str, rest: &str| before.get(&format!("{force}_{rest}")).map_or(0.0, |p| p.value);
                    if let Some(rest) = name.strip_prefix("Cm_") {
                        value.value -= c * from("CL", rest);
                    } else if let Some(rest) = name.strip_prefix("Cn_") {
                        value.value -= c * arm * from("CY", rest);
                    }
                }
            }
            UncertainQuantity::Geometry => {
                let aircraft = &mut model.aircraft;
                aircraft.wing_area /= (1.0 + c).powi(2);
                aircraft.mean_chord /= 1.0 + c;
                aircraft.wing_span = aircraft.wing_span.map(|span| span / (1.0 + c));
            }
            UncertainQuantity::Thrust => {
                each(record, "thrust", |v| v / (1.0 + c));
                if let Thrust::Known(source) = &mut model.aircraft.thrust {
                    constant(source, 1.0 / (1.0 + c));
                }
            }
            // No site is of them.
            UncertainQuantity::BaseTables => {}
        }
    }
}

/// Height over which the density of the troposphere falls by one part in `e`, m: `1/(g/(R T) - L/T)` at 273 K.
const DENSITY_HEIGHT_M: f64 = 9874.0;

/// The values of a channel; of one that the record lacks, and for each sample that has none, NaN.
fn values(record: &Record, name: &str) -> Vec<f64> {
    record.channel(name).map_or_else(|| vec![f64::NAN; record.time.len()], |channel| channel.values.clone())
}

/// Adds to the values of a channel what is a number.
fn add(record: &mut Record, name: &str, moved: &[f64]) {
    let mut moved = moved.iter();
    each(record, name, |v| v + moved.next().copied().filter(|m| m.is_finite()).unwrap_or(0.0));
}

/// What accelerometers at `arm` (m, body axes) feel more than at the centre of gravity, by axis: `w' x r + w x (w x r)`, m/s^2. A rate that is
/// not recorded is zero; their derivatives are central differences.
fn felt_at(record: &Record, arm: [f64; 3]) -> [Vec<f64>; 3] {
    let time = &record.time;
    let or_zero = |name: &str| -> Vec<f64> {
        values(record, name).into_iter().map(|v| if v.is_finite() { v } else { 0.0 }).collect()
    };
    let rates = ["p", "q", "r"].map(or_zero);
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let felt: Vec<[f64; 3]> = (0..time.len())
        .map(|k| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(time.len() - 1));
            let step_s = time[after] - time[before];
            let accelerations = rates.each_ref().map(|rate| (rate[after] - rate[before]) / step_s);
            let rates = rates.each_ref().map(|rate| rate[k]);
            let (turned, swung) = (cross(accelerations, arm), cross(rates, cross(rates, arm)));
            std::array::from_fn(|i| turned[i] + swung[i])
        })
        .collect();
    std::array::from_fn(|axis| felt.iter().map(|felt| felt[axis]).collect())
}

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

/// Sizes of the errors, in the order of [`SITES`].
fn draw_sizes(draw: Draw, model: &ModelFile, number: usize) -> [f64; SITES.len()] {
    // Numbers of their own, apart from those of other studies.
    let mut random = Pcg64Mcg::seed_from_u64(0x6472_6177_6e00 + number as u64);
    let mut normal = || {
        let (a, b): (f64, f64) = (random.random::<f64>().max(1e-300), random.random());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    };
    SITES.map(|site| {
        let size = normal() * model.uncertainty.of_quantity(site.quantity);
        match draw {
            Draw::All => size,
            Draw::One(quantity) if quantity == site.quantity => size,
            _ => 0.0,
        }
    })
}

/// The quantity that is named first, if any is.
type Named = Option<UncertainQuantity>;
/// Of a parameter: what is named first, the variance that each quantity makes by re-runs, and the claimed standard error.
type Ranked = (Named, [f64; UncertainQuantity::ALL.len()], f64);

/// The flight with errors of these sizes in it: its parameters, and what is named first for each. None where it gives no
/// numbers that may be used.
fn run(flight: &Flight, method: Method, sizes: &[f64; SITES.len()]) -> Option<(Vec<DrawnParameter>, Vec<Named>)> {
    let record = flight.record.as_ref().ok()?;
    let (mut record, mut model, mut truth) = (record.clone(), flight.model.clone(), flight.truth.at_end().clone());
    for (site, size) in SITES.iter().zip(sizes).filter(|(_, size)| **size != 0.0) {
        site.apply(*size, &mut record, &mut model, &mut truth);
    }
    let record = reread(record).ok()?;
    let structure = StructureSearch::Never;
    let options = EstimateOptions { method: Some(method), structure, ..EstimateOptions::default() };
    let estimation = estimate(&record, &model, &options, &mut |_| {}).ok()?;
    if estimation.status == EstimationStatus::Refused {
        return None;
    }
    let mut named = Vec::new();
    let mut parameters = Vec::new();
    for (name, p) in
        truth.iter().filter(|(name, _)| flight.truth.at_end().get(*name).is_some_and(TrueParameter::counts))
    {
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
    let sizes = draw_sizes(draw, &flight.model, number);
    let parameters = run(flight, method, &sizes).map_or_else(Vec::new, |(parameters, _)| parameters);
    DrawnTrial { flight: format!("{}/{}", flight.truth.aircraft, flight.truth.flight), draw, parameters }
}

/// Of each parameter of a flight: what is named first, the variance that each quantity makes by re-runs with one sigma of
/// each, and the claimed one.
pub(super) fn rank(flight: &Flight, method: Method) -> Vec<Ranked> {
    let Some((clean, named)) = run(flight, method, &[0.0; SITES.len()]) else { return Vec::new() };
    let mut variances = vec![[0.0; UncertainQuantity::ALL.len()]; clean.len()];
    for (i, site) in SITES.iter().enumerate() {
        let sigma = flight.model.uncertainty.of_quantity(site.quantity);
        let mut sizes = [0.0; SITES.len()];
        sizes[i] = sigma;
        let Some((wrong, _)) = run(flight, method, &sizes).filter(|_| sigma > 0.0) else { continue };
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
