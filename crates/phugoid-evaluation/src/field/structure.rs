//! Whether the terms that a model lacks are found, and only those.
//!
//! The record of what happened without instruments (`make.py --exact`) says of any term how much of a coefficient it
//! really makes: the least squares of the simulator's own coefficient on the exact regressors of the model's terms and
//! this one. So every offer is judged by the aircraft itself, whose tables are no sum of terms.

use nalgebra::{DMatrix, DVector};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{Estimation, EstimationStatus, FinalStatus};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{ModelFile, Role};
use phugoid_identification::term::{Coefficient, FACTORS, Term, Variable};
use serde::Serialize;

use super::FieldError;
use super::trial::Flight;
use super::truth::Truth;

/// Least share of the coefficient's motion that only this term makes from which a missing term counts as findable.
pub const FINDABLE: f64 = 0.05;
/// Share below which a term that is offered counts as not there.
pub const NOT_THERE: f64 = 0.01;
/// Least correlation of what two terms add to the model from which one stands for the other.
const SAME: f64 = 0.9;

/// Terms that the simulator's aircraft have and the field's model files have not, where they make enough of their
/// coefficient.
const NATURAL: [(Coefficient, &str); 7] = [
    (Coefficient::Drag, "|elevator|"),
    (Coefficient::Lift, "alpha^2"),
    (Coefficient::PitchingMoment, "alpha^2"),
    (Coefficient::PitchingMoment, "v_hat"),
    (Coefficient::SideForce, "beta*|beta|"),
    (Coefficient::RollingMoment, "alpha*beta"),
    (Coefficient::YawingMoment, "alpha*beta"),
];

/// A term that the aircraft has by nature.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Natural {
    /// Symbol of the coefficient.
    pub coefficient: String,
    /// The term.
    pub term: String,
    /// Share of the coefficient's motion that only this term makes, in truth.
    pub share: f64,
    /// Whether it is offered.
    pub found: bool,
    /// Whether it is, or one that adds the same.
    pub found_alike: bool,
}

/// A term that was offered, beside the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judged {
    /// Symbol of the coefficient.
    pub coefficient: String,
    /// The term as a model file writes it.
    pub term: String,
    /// Share of the coefficient's motion that only this term makes, in truth.
    pub share: f64,
    /// The same as the regression found it.
    pub found_share: f64,
    /// Its partial F.
    pub partial_f: f64,
    /// Part of what the noise of the sensors leaves that it explains.
    pub excess: f64,
    /// True if it counts as missing in the model.
    pub missing: bool,
    /// Correlation of what it and the term that is really missing add to the model.
    pub like_missing: f64,
}

/// An estimate of a derivative beside the truth, without and with the offered terms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeforeAfter {
    /// Name of the parameter.
    pub name: String,
    /// True value.
    pub truth: f64,
    /// Estimate and claimed standard error without the terms.
    pub before: [f64; 2],
    /// The same with them; as before where none was offered.
    pub after: [f64; 2],
}

impl BeforeAfter {
    fn covered(&self, of: [f64; 2]) -> bool {
        (of[0] - self.truth).abs() <= 2.0 * of[1]
    }
}

/// One flight with one model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StructureTrial {
    /// Name of the aircraft.
    pub aircraft: String,
    /// Name of the flight.
    pub flight: String,
    /// Group of the flight.
    pub group: String,
    /// The method.
    pub method: Method,
    /// The term that is missing: coefficient and term; none where the model is the field's.
    pub removed: Option<(String, String)>,
    /// Its share in truth; NaN where none is missing.
    pub removed_share: f64,
    /// Smallest part of a coefficient's motion that the terms of the model explain in truth.
    pub explained: f64,
    /// What the result is worth; none where there is none.
    pub status: Option<EstimationStatus>,
    /// Terms that the aircraft has by nature, from [`FINDABLE`] on; of the field's own models.
    pub natural: Vec<Natural>,
    /// The terms that were offered, and the best of the others.
    pub offers: Vec<Judged>,
    /// Levels of the residuals over those of the noise of the sensors, by equation.
    pub levels: Vec<(String, f64)>,
    /// Derivatives that count.
    pub parameters: Vec<BeforeAfter>,
}

impl StructureTrial {
    fn offered(&self) -> impl Iterator<Item = &Judged> {
        self.offers.iter().filter(|o| o.missing)
    }

    /// Whether the missing term itself is among the offered ones.
    pub fn is_found(&self) -> bool {
        self.removed.as_ref().is_some_and(|(c, t)| self.offered().any(|o| o.coefficient == *c && o.term == *t))
    }

    /// Whether it or one that adds the same is.
    pub fn is_found_alike(&self) -> bool {
        self.is_found() || self.offered().any(|o| o.like_missing.abs() >= SAME)
    }

    /// Whether a term that is not there is offered.
    pub fn is_false(&self) -> bool {
        self.offered().any(|o| o.share.is_nan() || o.share < NOT_THERE)
    }
}

/// Counts of trials of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StructureSummary {
    /// What is missing, or `nothing`.
    pub name: String,
    /// The method.
    pub method: Method,
    /// Trials.
    pub trials: usize,
    /// Trials in which the missing term makes at least [`FINDABLE`] of its coefficient.
    pub findable: usize,
    /// Of the findable ones: the term itself offered.
    pub found: usize,
    /// Of the findable ones: it, or one that adds the same.
    pub found_alike: usize,
    /// Trials in which anything is offered.
    pub any: usize,
    /// Trials in which a term is offered that makes less than [`NOT_THERE`] of its coefficient.
    pub false_offers: usize,
    /// Derivatives compared, and the part of them covered without and with the offered terms, of trials with an offer.
    pub numbers: usize,
    /// Part covered by two claimed standard errors before.
    pub covered_before: f64,
    /// The same after.
    pub covered_after: f64,
}

impl StructureSummary {
    fn of(name: &str, method: Method, trials: &[&StructureTrial]) -> Self {
        let findable: Vec<_> = trials.iter().filter(|t| t.removed_share >= FINDABLE).collect();
        let with_offer = || trials.iter().filter(|t| t.offered().next().is_some()).flat_map(|t| &t.parameters);
        let part = |covered: &dyn Fn(&BeforeAfter) -> bool| {
            with_offer().filter(|p| covered(p)).count() as f64 / with_offer().count() as f64
        };
        Self {
            name: name.to_owned(),
            method,
            trials: trials.len(),
            findable: findable.len(),
            found: findable.iter().filter(|t| t.is_found()).count(),
            found_alike: findable.iter().filter(|t| t.is_found_alike()).count(),
            any: trials.iter().filter(|t| t.offered().next().is_some()).count(),
            false_offers: trials.iter().filter(|t| t.is_false()).count(),
            numbers: with_offer().count(),
            covered_before: part(&|p| p.covered(p.before)),
            covered_after: part(&|p| p.covered(p.after)),
        }
    }
}

/// The study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StructureStudy {
    /// By what is missing and method.
    pub summaries: Vec<StructureSummary>,
    /// Every trial.
    pub trials: Vec<StructureTrial>,
}

impl StructureStudy {
    pub(super) fn new(trials: Vec<StructureTrial>, methods: &[Method]) -> Self {
        let mut summaries = Vec::new();
        for method in methods {
            let of_method: Vec<&StructureTrial> = trials.iter().filter(|t| t.method == *method).collect();
            let key = |t: &StructureTrial| {
                t.removed.as_ref().map_or_else(|| "nothing".to_owned(), |(c, term)| format!("{term} in {c}"))
            };
            let mut names: Vec<String> = of_method.iter().map(|t| key(t)).collect();
            names.sort();
            names.dedup();
            for name in &names {
                let own: Vec<&StructureTrial> = of_method.iter().copied().filter(|t| key(t) == *name).collect();
                summaries.push(StructureSummary::of(name, *method, &own));
            }
            summaries.extend(natural_summaries(*method, &of_method));
            let removed: Vec<&StructureTrial> = of_method.into_iter().filter(|t| t.removed.is_some()).collect();
            summaries.push(StructureSummary::of("any of these", *method, &removed));
        }
        Self { summaries, trials }
    }
}

/// Of the terms that the aircraft have by nature.
fn natural_summaries(method: Method, trials: &[&StructureTrial]) -> Vec<StructureSummary> {
    let of = |(coefficient, text): &(Coefficient, &str)| {
        let all = || trials.iter().flat_map(|t| &t.natural);
        let own: Vec<&Natural> = all().filter(|n| n.coefficient == coefficient.symbol() && n.term == *text).collect();
        (!own.is_empty()).then(|| StructureSummary {
            name: format!("{text} in {} by nature", coefficient.symbol()),
            method,
            trials: own.len(),
            findable: own.len(),
            found: own.iter().filter(|n| n.found).count(),
            found_alike: own.iter().filter(|n| n.found_alike).count(),
            any: 0,
            false_offers: 0,
            numbers: 0,
            covered_before: f64::NAN,
            covered_after: f64::NAN,
        })
    };
    NATURAL.iter().filter_map(of).collect()
}

/// What happened without instruments.
struct Exact {
    /// Variables of the terms, by sample.
    factors: Vec<[f64; FACTORS]>,
    /// Coefficients, by [`Coefficient`] and sample.
    coefficients: [Vec<f64>; 6],
}

impl Exact {
    fn read(truth: &Truth, model: &ModelFile) -> Result<Self, FieldError> {
        let name = truth.record.replace(".csv", ".exact.csv");
        let path = truth.folder.join(&name);
        let record =
            Record::open(&path).map_err(|error| FieldError::NoExact(format!("{}: {error}", path.display())))?;
        let of = |name: &str| -> Result<&[f64], FieldError> {
            let values = record.channel(name).map(|c| c.values.as_slice());
            values.ok_or_else(|| FieldError::NoExact(format!("{}: there is no channel {name}", path.display())))
        };
        let speed = of("true_airspeed")?;
        let reference = median(&mut speed.to_vec()).unwrap_or(1.0);
        let half_chord = 0.5 * model.aircraft.mean_chord;
        let half_span = 0.5 * model.aircraft.wing_span.unwrap_or(0.0);
        let mut factors = vec![[0.0; FACTORS]; speed.len()];
        for (variable, channel, length) in [
            (Variable::Alpha, "alpha", None),
            (Variable::Beta, "beta", None),
            (Variable::RollRate, "p", Some(half_span)),
            (Variable::PitchRate, "q", Some(half_chord)),
            (Variable::YawRate, "r", Some(half_span)),
            (Variable::Elevator, "elevator", None),
            (Variable::Aileron, "aileron", None),
            (Variable::Rudder, "rudder", None),
        ] {
            for ((at, value), v) in factors.iter_mut().zip(of(channel)?).zip(speed) {
                at[variable.index()] = value * length.map_or(1.0, |length| length / v);
            }
        }
        for (at, v) in factors.iter_mut().zip(speed) {
            at[Variable::Airspeed.index()] = v / reference;
        }
        let mut coefficients: [Vec<f64>; 6] = Default::default();
        for coefficient in Coefficient::ALL {
            coefficients[coefficient as usize] = of(match coefficient {
                Coefficient::Lift => "c_lift",
                Coefficient::Drag => "c_drag",
                Coefficient::PitchingMoment => "c_pitch",
                Coefficient::SideForce => "c_side",
                Coefficient::RollingMoment => "c_roll",
                Coefficient::YawingMoment => "c_yaw",
            })?
            .to_vec();
        }
        Ok(Self { factors, coefficients })
    }

    fn column(&self, term: &Term) -> DVector<f64> {
        DVector::from_iterator(self.factors.len(), self.factors.iter().map(|at| term.value(at)))
    }

    /// What a further term adds to a coefficient beside those of the model: its value times the part of its regressor
    /// that they leave, by sample.
    fn added(&self, model: &ModelFile, coefficient: Coefficient, term: &Term) -> Option<DVector<f64>> {
        let terms: Vec<DVector<f64>> = model.terms(coefficient).map(|t| self.column(t)).collect();
        let own = self.column(term);
        let left = &own - self.explained(&terms, &own)?;
        let y = DVector::from_column_slice(&self.coefficients[coefficient as usize]);
        let squares = left.norm_squared();
        // A term that the others make up adds nothing.
        let value = if squares > 1e-12 * own.norm_squared() { left.dot(&y) / squares } else { 0.0 };
        Some(left * value)
    }

    /// The least squares of values on columns.
    fn explained(&self, columns: &[DVector<f64>], values: &DVector<f64>) -> Option<DVector<f64>> {
        let columns: Vec<DVector<f64>> = columns.iter().map(|c| c / c.norm().max(f64::MIN_POSITIVE)).collect();
        let n = columns.len();
        if n == 0 {
            return Some(DVector::zeros(values.len()));
        }
        let normal = DMatrix::from_fn(n, n, |a, b| columns[a].dot(&columns[b]));
        let right = DVector::from_fn(n, |a, _| columns[a].dot(values));
        let solution = normal.try_svd(true, true, f64::EPSILON, 500)?.solve(&right, 1e-12).ok()?;
        let zero = DVector::zeros(values.len());
        Some(columns.iter().zip(solution.iter()).fold(zero, |sum, (c, s)| sum + c * *s))
    }

    fn share(&self, model: &ModelFile, coefficient: Coefficient, term: &Term) -> f64 {
        let whole = std(&DVector::from_column_slice(&self.coefficients[coefficient as usize]));
        self.added(model, coefficient, term).map_or(f64::NAN, |added| std(&added) / whole)
    }

    /// Share of the motion of each coefficient of the model that its terms explain, the smallest.
    fn least_explained(&self, model: &ModelFile) -> f64 {
        let of = |coefficient: Coefficient| {
            let terms: Vec<DVector<f64>> = model.terms(coefficient).map(|t| self.column(t)).collect();
            let y = DVector::from_column_slice(&self.coefficients[coefficient as usize]);
            let rest = std(&(&y - self.explained(&terms, &y)?));
            (!terms.is_empty()).then(|| 1.0 - (rest / std(&y)).powi(2))
        };
        Coefficient::ALL.into_iter().filter_map(of).fold(1.0, f64::min)
    }
}

fn std(values: &DVector<f64>) -> f64 {
    let mean = values.mean();
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// The term with extra inputs of other axes read as the variables that they are.
fn parse(text: &str) -> Option<Term> {
    // A rate that is recorded as a channel differs from its normalised form by the airspeed alone.
    let words = match text {
        "p" | "q" | "r" => format!("{text}_hat"),
        other => other.to_owned(),
    };
    Term::parse(&words, &[]).ok()
}

/// The terms of the model that may be taken out: those of which the flight has a true value that counts.
pub(super) fn removable(flight: &Flight) -> Vec<String> {
    let truth = &flight.truth;
    let counts = |name: &String| truth.at_end().get(name).is_some_and(|p| p.counts());
    flight.model.parameters.iter().map(|p| p.name.clone()).filter(counts).collect()
}

/// Runs a method with the field's model, or with one of its terms taken out.
pub(super) fn trial(flight: &Flight, method: Method, removed: Option<&str>) -> Result<StructureTrial, FieldError> {
    let truth = &flight.truth;
    let exact = Exact::read(truth, &flight.model)?;
    let mut model = flight.model.clone();
    let mut missing: Option<(String, String)> = truth.missing.first().cloned();
    if let Some(removed) = removed {
        missing = model.parameters.iter().find(|p| p.name == removed).and_then(|p| match &p.role {
            Role::Term(c, term) => Some((c.symbol().to_owned(), term.text(&[]))),
            _ => None,
        });
        model.parameters.retain(|p| p.name != removed);
    }
    let missing_term = missing.as_ref().and_then(|(c, t)| Some((Coefficient::from_symbol(c)?, parse(t)?)));
    let missing_added = missing_term.as_ref().and_then(|(c, t)| exact.added(&model, *c, t));
    let mut trial = StructureTrial {
        aircraft: truth.aircraft.clone(),
        flight: truth.flight.clone(),
        group: truth.group.clone(),
        method,
        removed_share: missing_term.as_ref().map_or(f64::NAN, |(c, t)| exact.share(&model, *c, t)),
        removed: missing,
        explained: exact.least_explained(&model),
        status: None,
        natural: Vec::new(),
        offers: Vec::new(),
        levels: Vec::new(),
        parameters: Vec::new(),
    };
    let Ok(record) = &flight.record else { return Ok(trial) };
    let options =
        EstimateOptions { method: Some(method), structure: StructureSearch::Offer, ..EstimateOptions::default() };
    let Ok(estimation) = estimate(record, &model, &options, &mut |_| {}) else { return Ok(trial) };
    trial.status = Some(estimation.status);
    if let Some(offer) = &estimation.offer {
        trial.levels = offer.levels.iter().map(|l| (l.equation.clone(), l.residual_std / l.noise_std)).collect();
        for term in &offer.terms {
            let Some((c, t)) = Coefficient::from_symbol(&term.coefficient).zip(parse(&term.term)) else { continue };
            let like_missing = match (&missing_term, &missing_added, exact.added(&model, c, &t)) {
                (Some((own, _)), Some(a), Some(b)) if *own == c => a.dot(&b) / (a.norm() * b.norm()),
                _ => 0.0,
            };
            trial.offers.push(Judged {
                coefficient: term.coefficient.clone(),
                term: term.term.clone(),
                share: exact.share(&model, c, &t),
                found_share: term.share.unwrap_or(f64::NAN),
                partial_f: term.partial_f,
                excess: term.excess.unwrap_or(f64::INFINITY),
                missing: term.asked_for,
                like_missing,
            });
        }
    }
    trial.parameters = compared(&estimation, truth);
    if trial.removed.is_none() {
        trial.natural = natural(&exact, &model, &trial.offers);
    }
    Ok(trial)
}

/// The terms that the aircraft has by nature and the model lacks, and whether they are offered.
fn natural(exact: &Exact, model: &ModelFile, offers: &[Judged]) -> Vec<Natural> {
    let mut found = Vec::new();
    for (coefficient, text) in NATURAL {
        let Some(term) = parse(text) else { continue };
        if model.terms(coefficient).next().is_none() || model.terms(coefficient).any(|t| *t == term) {
            continue;
        }
        let share = exact.share(model, coefficient, &term);
        let Some(added) = exact.added(model, coefficient, &term).filter(|_| share >= FINDABLE) else { continue };
        let of_same = || offers.iter().filter(|o| o.missing && o.coefficient == coefficient.symbol());
        let alike = |o: &Judged| {
            let other = parse(&o.term).and_then(|t| exact.added(model, coefficient, &t));
            other.is_some_and(|other| other.dot(&added).abs() >= SAME * other.norm() * added.norm())
        };
        found.push(Natural {
            coefficient: coefficient.symbol().to_owned(),
            term: text.to_owned(),
            share,
            found: of_same().any(|o| o.term == text),
            found_alike: of_same().any(alike),
        });
    }
    found
}

/// The derivatives that count and are in the model, without and with the offered terms.
fn compared(estimation: &Estimation, truth: &Truth) -> Vec<BeforeAfter> {
    let counting = truth.at_end().iter().filter(|(_, p)| p.counts());
    counting
        .filter_map(|(name, p)| {
            let found = estimation.parameter(name).filter(|p| p.status != FinalStatus::Fixed)?;
            let before = [found.value, found.corrected_std_error];
            let effects = estimation.offer.iter().flat_map(|o| &o.effects);
            let after = effects.filter(|e| e.parameter == *name).map(|e| [e.after, e.after_std]).next();
            Some(BeforeAfter { name: name.clone(), truth: p.value, before, after: after.unwrap_or(before) })
        })
        .collect()
}
