//! Terms that the equations of motion ask for.
//!
//! A term that the aircraft has and the model lacks is taken up by the others: their values are then those of another
//! aircraft, change with the flight condition, and a change detector finds changes that never happened. Here a library
//! of candidates is tried on the equations of motion of the record, beside any method and in a fraction of a second
//! ([`selection`]); what they ask for goes through the method itself, which has to find it too. docs/methods.md has the
//! equations, and what was measured.

mod candidate;
mod missing;
mod rate_of_alpha;
mod selection;

use phugoid_flight_data::printable::toml_string;
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::{median, median_step};

use crate::batch::{
    BatchParameter, EquationErrorSettings, Grid, InitialState, Manoeuvre, Noise, OutputChannel, Structure, Table,
    tables,
};
use crate::core::error::EstimateError;
use crate::core::estimation::{
    Estimation, ModelLine, Offer, OfferCriterion, OfferedTerm, ParameterResult, ResidualLevel, TermEffect,
};
use crate::core::number::significant;
use crate::core::options::{CAPACITY, Likelihood, capacity};
use crate::core::output::Output;
use crate::core::term::{Coefficient, EXTRA_INPUTS};
use crate::methods::{EveryRoom, Task, whole_record};
use crate::model_file::{Base, ModelFile, Parameter, Role};
use crate::motion::Motion;
use crate::preparation::noise::measure_own_noise;
use crate::preparation::prepare::prepare;
use crate::preparation::prepared::Prepared;
pub(crate) use candidate::round_up;
use candidate::{Candidate, candidates, with_terms};
pub(crate) use missing::{Found, Missing, missing, place};
pub(crate) use rate_of_alpha::{found as found_rate_of_alpha, with_rate_of_alpha};
use selection::{Criterion, Regression, Trial};

/// Spacing of the rows of the equations, s: the windows of the smoothing are 0.4 s long.
const SPACING_S: f64 = 0.05;
/// Most rows of a record: a longer one is thinned further.
const MOST_ROWS: f64 = 20_000.0;
/// Chance of a term that is not there, over all candidates of a flight, that the partial F is made for.
const FALSE_OFFERS: f64 = 1e-3;
/// Factor on that partial F: the equations of no flight are exactly right.
const NOT_EXACT: f64 = 2.0;
/// Smallest share of the coefficient's motion that only the term makes.
const SHARE: f64 = 0.04;
/// Smallest part of the squares beyond the sensors' noise that the term explains.
const EXCESS: f64 = 0.1;
/// Prior one sigma of a new parameter, in values that the regression finds.
const PRIOR: f64 = 2.0;
/// Standard errors that the method's own estimate of a missing term has to lie from zero.
const CONFIRMED: f64 = 3.0;
/// Significant digits of a number in a sentence.
const DIGITS: i32 = 4;
/// Most terms that are listed.
const LISTED: usize = 10;

/// Looks for missing terms on the equations of motion. `None` where these cannot be computed. The estimation itself is
/// not changed, and the offer is not confirmed yet.
///
/// # Errors
/// [`EstimateError`] as of the estimation itself.
pub(crate) fn search<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    task: &Task<M, N, R>,
) -> Result<Option<Offer>, EstimateError> {
    let Task { file, options, prepared, .. } = *task;
    if file.estimated().count() >= capacity(file.axes) {
        return Ok(None);
    }
    let further = if task.method().is_batch() { options.further.as_slice() } else { &[] };
    let records: Vec<&Record> = std::iter::once(record).chain(further).collect();
    let speeds = channel_of(prepared, "true_airspeed");
    let Some(speed) = median(&mut speeds.iter().copied().filter(|v| v.is_finite()).collect::<Vec<_>>()) else {
        return Ok(None);
    };
    let speed = speed.round().max(1.0);
    let alpha: Vec<f64> = channel_of(prepared, "alpha").iter().map(|a| a - prepared.reference.alpha).collect();
    let mut list = candidates(file, record, &alpha);
    // A further record without the channel cannot show the term.
    list.retain(|c| {
        let has = |r: &&Record| c.input.as_deref().is_none_or(|name| r.channel(name).is_some());
        records.iter().all(has)
    });
    let Some((regression, list)) = regression::<M, N, R>(&records, file, list, speed)? else { return Ok(None) };
    let own = own_parameters(file).count();
    let criterion = Criterion {
        // The quantile of a normal number, by its upper bound: P(|z| > t) < exp(-t^2/2).
        partial_f: NOT_EXACT * 2.0 * (list.len().max(1) as f64 / FALSE_OFFERS).ln(),
        share: SHARE,
        excess: EXCESS,
    };
    let (found, first) = regression.select(&criterion);
    let levels = regression
        .levels(&(0..own).collect::<Vec<_>>())
        .into_iter()
        .map(|l| ResidualLevel { equation: l.equation, residual_std: l.residual_std, noise_std: l.noise_std })
        .collect();
    let mut terms: Vec<OfferedTerm> = Vec::new();
    for (asked_for, trials) in [(true, &found), (false, &first)] {
        for trial in trials {
            let Some(candidate) = trial.column.checked_sub(own).and_then(|k| list.get(k)) else { continue };
            let is_listed = trials.len() > LISTED && terms.len() >= LISTED && !asked_for;
            if !is_listed && !found.iter().any(|f| !asked_for && f.column == trial.column) {
                terms.extend(offered(file, candidate, trial, asked_for));
            }
        }
    }
    let criterion = OfferCriterion { partial_f: criterion.partial_f, share: criterion.share, excess: criterion.excess };
    Ok(Some(Offer {
        tried: list.len(),
        criterion,
        levels,
        terms,
        effects: Vec::new(),
        lines: Vec::new(),
        taken: false,
        reference_speed: speed,
    }))
}

fn offered(file: &ModelFile, candidate: &Candidate, trial: &Trial, asked_for: bool) -> Option<OfferedTerm> {
    let inputs = candidate::with_input(&file.extra_inputs, candidate.input.as_deref());
    let term = candidate.term(&inputs)?;
    Some(OfferedTerm {
        coefficient: candidate.coefficient.symbol().to_owned(),
        term: term.text(&inputs),
        input: candidate.input.clone(),
        parameter: term.parameter_name(candidate.coefficient, file.base != Base::None, &inputs),
        value: trial.value,
        std_error: trial.std_error,
        partial_f: trial.partial_f,
        share: Some(trial.share),
        excess: Some(trial.excess).filter(|e| e.is_finite()),
        asked_for,
        prior_std: round_up(PRIOR * trial.value.abs()).unwrap_or(1.0),
    })
}

/// The values of an output or known input by sample; empty if the motion has neither.
fn channel_of<M: Motion<N, R>, const N: usize, const R: usize>(prepared: &Prepared<M, N, R>, name: &str) -> Vec<f64> {
    let row = Output::from_name(name).and_then(|output| M::AXES.row(output));
    let known = || prepared.known.iter().find(|s| s.name == name).map_or(Vec::new(), |s| s.values.clone());
    row.map_or_else(known, |row| prepared.outputs.iter().map(|y| y[row]).collect())
}

/// The estimated parameters that are terms or offsets.
fn own_parameters(file: &ModelFile) -> impl Iterator<Item = &Parameter> {
    file.estimated().filter(|p| !matches!(p.role, Role::Bias(_)))
}

/// The equations of motion of the records, with the terms of the model and the candidates that can be worked out; and
/// these candidates.
fn regression<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    records: &[&Record],
    file: &ModelFile,
    list: Vec<Candidate>,
    speed: f64,
) -> Result<Option<(Regression, Vec<Candidate>)>, EstimateError> {
    let own: Vec<Coefficient> = own_parameters(file).filter_map(coefficient).collect();
    let room = CAPACITY.saturating_sub(own.len());
    let mut batches: Vec<Vec<Table>> = Vec::new();
    let mut tried: Vec<Candidate> = Vec::new();
    let mut window = 1;
    let mut rest = list;
    while !rest.is_empty() && room > 0 {
        let mut inputs = file.extra_inputs.clone();
        let (mut now, mut later) = (Vec::new(), Vec::new());
        for candidate in rest {
            let with = candidate::with_input(&inputs, candidate.input.as_deref());
            if now.len() < room && with.len() <= EXTRA_INPUTS {
                inputs = with;
                now.push(candidate);
            } else {
                later.push(candidate);
            }
        }
        if now.is_empty() {
            break;
        }
        rest = later;
        let Some((with, order)) = batch_model(file, &now, speed) else { continue };
        let Some((found, of)) = batch::<M, N, R>(records, &with, &order)? else { return Ok(None) };
        window = of;
        batches.push(found);
        tried.extend(now);
    }
    let columns: Vec<usize> =
        own.iter().copied().chain(tried.iter().map(|c| c.coefficient)).map(|c| c as usize).collect();
    let rank = own.iter().map(|_| 0).chain(tried.iter().map(|c| c.rank)).collect();
    let regression = Regression::new(batches, own.len(), columns, rank, window);
    Ok(regression.map(|regression| (regression, tried)))
}

fn coefficient(parameter: &Parameter) -> Option<Coefficient> {
    match parameter.role {
        Role::Term(coefficient, _) | Role::Offset(coefficient) => Some(coefficient),
        Role::Bias(_) => None,
    }
}

/// The model with candidates, without sensor biases, and the names of its parameters: those of the model, then the
/// candidates.
fn batch_model(file: &ModelFile, list: &[Candidate], speed: f64) -> Option<(ModelFile, Vec<String>)> {
    let terms: Vec<(&Candidate, f64)> = list.iter().map(|c| (c, 1.0)).collect();
    let mut with = with_terms(file, &terms, speed)?;
    with.parameters.retain(|p| !matches!(p.role, Role::Bias(_)));
    let own: Vec<String> = own_parameters(file).map(|p| p.name.clone()).collect();
    let names = list.iter().map(|c| {
        let term = c.term(&with.extra_inputs)?;
        Some(term.parameter_name(c.coefficient, file.base != Base::None, &with.extra_inputs))
    });
    let order = own.into_iter().map(Some).chain(names).collect::<Option<Vec<_>>>()?;
    Some((with, order))
}

/// The equations of the records by a model, as measured and with noise added, their columns in the order of the names
/// given; and over how many rows their noise is correlated.
pub(crate) fn batch<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    records: &[&Record],
    file: &ModelFile,
    order: &[String],
) -> Result<Option<(Vec<Table>, usize)>, EstimateError> {
    let prepared: Vec<Prepared<M, N, R>> =
        records.iter().map(|record| prepare::<M, N, R>(record, file)).collect::<Result<_, _>>()?;
    let names = M::AXES.outputs();
    let structure = Structure::<N, R> {
        parameters: file.estimated().map(|p| BatchParameter::free(p.name.as_str(), p.start)).collect(),
        states: std::array::from_fn(|i| InitialState::free(names[i].name())),
        outputs: std::array::from_fn(|i| OutputChannel::new(names[i].name(), Noise::Estimated)),
        maximum_step_s: 1.0,
        maximum_gap_s: f64::INFINITY,
        likelihood: Likelihood::Gaussian,
    };
    let Some(step) = prepared.first().and_then(|p| median_step(&p.time)) else { return Ok(None) };
    let settings = EquationErrorSettings::automatic(step);
    let duration: f64 = prepared.iter().filter_map(|p| Some(p.time.last()? - p.time.first()?)).sum();
    let spacing = SPACING_S.max(step).max(duration / MOST_ROWS);
    // The grid begins where the record does: with an input that comes later it has the same rows.
    let grids: Vec<Grid> = records.iter().map(|r| Grid::new(&r.time, spacing)).collect();
    let manoeuvres: Vec<Manoeuvre<'_, N, R>> =
        prepared.iter().map(|p| whole_record::<M, N, R>("the record", p)).collect();
    let noise: Vec<[f64; R]> = prepared
        .iter()
        .map(|p| {
            std::array::from_fn(|i| {
                let values: Vec<f64> = p.outputs.iter().map(|y| y[i]).collect();
                let given = file.noise[names[i].index()].unwrap_or(0.0);
                // The steps of a recorder are no noise of their own beside that of the sensor.
                measure_own_noise(&values).map_or(given, |n| if n.quantised { 0.0 } else { n.std })
            })
        })
        .collect();
    let starts: Vec<f64> = file.estimated().map(|p| p.start).collect();
    let Ok(mut found) = tables(&manoeuvres, &grids, &structure, &settings, &starts, &noise) else {
        // A state that is not measured: there are no equations.
        return Ok(None);
    };
    let places: Vec<Option<usize>> = order.iter().map(|name| file.estimated().position(|p| p.name == *name)).collect();
    for equation in found.iter_mut().flatten() {
        let take = |place: &Option<usize>| place.and_then(|j| equation.regressors.get(j)).cloned().unwrap_or_default();
        equation.regressors = places.iter().map(take).collect();
    }
    let window = (4.0 * settings.half_window_s / spacing).ceil() as usize;
    Ok(Some((found, window)))
}

/// The model with the terms of an offer that count as missing, and what they need; `None` where there is no place for
/// them.
pub fn with_offered(file: &ModelFile, offer: &Offer) -> Option<ModelFile> {
    let terms = offer.missing().map(|term| {
        let coefficient = Coefficient::from_symbol(&term.coefficient)?;
        let candidate = Candidate { coefficient, text: term.term.clone(), input: term.input.clone(), rank: 0 };
        Some((candidate, term.prior_std))
    });
    let terms: Vec<(Candidate, f64)> = terms.collect::<Option<_>>()?;
    let terms: Vec<(&Candidate, f64)> = terms.iter().map(|(c, prior)| (c, *prior)).collect();
    let with = with_terms(file, &terms, offer.reference_speed)?;
    (with.estimated().count() <= capacity(with.axes)).then_some(with)
}

/// Leaves only those terms of an offer that the method finds too, by its estimation with them: with the sign of the
/// regression, and three standard errors from zero (of a method that gives any). True if all were left.
pub(crate) fn confirm(offer: &mut Offer, with: &Estimation) -> bool {
    let mut all = true;
    for term in offer.terms.iter_mut().filter(|t| t.asked_for) {
        term.asked_for = with.parameter(&term.parameter).is_some_and(|found| {
            let random = found.random_std();
            let far = !random.is_finite() || found.value.abs() >= CONFIRMED * random;
            found.value * term.value > 0.0 && far
        });
        all &= term.asked_for;
    }
    all
}

/// Writes into an offer what its terms do to the estimates, and the lines for the model file. `before` is none where the
/// method found no estimate without them.
pub(crate) fn complete(
    offer: &mut Offer,
    file: &ModelFile,
    with: &ModelFile,
    before: Option<&Estimation>,
    after: &Estimation,
) {
    let is_bias = |name: &str| with.parameters.iter().any(|p| p.name == name && matches!(p.role, Role::Bias(_)));
    let effect = |found: &ParameterResult| {
        let former = before.and_then(|before| before.parameter(&found.name));
        TermEffect {
            parameter: found.name.clone(),
            before: former.map(|p| p.value),
            before_std: former.map(|p| p.corrected_std_error),
            after: found.value,
            after_std: found.corrected_std_error,
        }
    };
    offer.effects = after.parameters.iter().filter(|p| !is_bias(&p.name)).map(effect).collect();
    offer.lines = lines(offer, file, with);
}

fn lines(offer: &Offer, file: &ModelFile, with: &ModelFile) -> Vec<ModelLine> {
    let line = |section: &str, line: String| ModelLine { section: section.to_owned(), line };
    let mut lines = Vec::new();
    if with.extra_inputs != file.extra_inputs {
        let names: Vec<String> = with.extra_inputs.iter().map(|name| toml_string(name)).collect();
        lines.push(line("", format!("inputs = [{}]", names.join(", "))));
    }
    if let (Some(speed), None) = (with.aircraft.reference_speed, file.aircraft.reference_speed) {
        lines.push(line("aircraft", format!("reference_speed = \"{speed} m/s\"")));
    }
    for coefficient in Coefficient::ALL {
        if offer.missing().any(|t| t.coefficient == coefficient.symbol()) {
            let words = with.parameters.iter().filter_map(|p| match &p.role {
                Role::Term(c, term) if *c == coefficient => Some(toml_string(&term.text(&with.extra_inputs))),
                _ => None,
            });
            let words: Vec<String> = words.collect();
            lines.push(line("coefficients", format!("{} = [{}]", coefficient.symbol(), words.join(", "))));
        }
    }
    let start = if file.base == Base::None { "start = 0, " } else { "" };
    for term in offer.missing() {
        let name = &term.parameter;
        let is_bare = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
        let key = if is_bare { name.clone() } else { toml_string(name) };
        lines.push(line("parameters", format!("{key} = {{ {start}prior_std = {} }}", term.prior_std)));
    }
    lines
}

/// The missing terms and their coefficients, in words.
pub(crate) fn missing_in_words(offer: &Offer) -> String {
    let words: Vec<String> = offer.missing().map(|t| format!("{} in {}", t.term, t.coefficient)).collect();
    words.join(", and ")
}

/// What an offer has to say of a term that the method itself was tried with, beside how terms are tried on the equations of motion;
/// none without such a term.
pub fn tried_by_the_method(offer: &Offer) -> Option<String> {
    let own = offer.missing().find(|term| term.share.is_none())?;
    Some(format!(
        "{} in {} was not tried on the equations of motion, where the rate of a measured angle is too noisy: the method was run with \
         it, and it counts from {} random errors on.",
        own.term,
        own.coefficient,
        rate_of_alpha::FAR
    ))
}

/// The parameters that the missing terms move by more than two of their standard errors, each with its value without them.
fn moved_parameters(offer: &Offer) -> impl Iterator<Item = (&TermEffect, f64)> {
    offer.effects.iter().filter_map(|e| {
        let (before, std) = e.before.zip(e.before_std)?;
        ((e.after - before).abs() / std > 2.0).then_some((e, before))
    })
}

/// The sentence of the verdict about the missing terms; none if there are none.
pub(crate) fn sentence(offer: &Offer) -> Option<String> {
    let words = |t: &OfferedTerm| {
        let effect = offer.effects.iter().find(|e| e.parameter == t.parameter);
        let (value, std) = effect.map_or((t.value, t.std_error), |e| (e.after, e.after_std));
        let evidence = match t.share {
            Some(share) => format!(
                "partial F {:.0} where {:.0} are enough, {:.0} % of the coefficient's motion",
                t.partial_f,
                offer.criterion.partial_f,
                100.0 * share
            ),
            None => format!("{:.0} random errors from zero when the method is run with it", t.partial_f.sqrt()),
        };
        format!(
            "{} in {} ({} = {} +- {}, one sigma; {evidence})",
            t.term,
            t.coefficient,
            t.parameter,
            significant(value, DIGITS),
            significant(std, DIGITS),
        )
    };
    let missing: Vec<String> = offer.missing().map(words).collect();
    if missing.is_empty() {
        return None;
    }
    let moved = moved_parameters(offer)
        .map(|(e, before)| {
            format!("{} {} -> {}", e.parameter, significant(before, DIGITS), significant(e.after, DIGITS))
        })
        .collect::<Vec<_>>();
    let moves = if moved.is_empty() {
        "No other parameter moves by more than two of its standard errors.".to_owned()
    } else {
        format!("With it move {}.", moved.join(", "))
    };
    let missing = missing.join(", and for ");
    Some(if offer.taken {
        format!("The equations of motion ask for {missing}. The estimates are those of the model with that. {moves}")
    } else {
        format!(
            "The equations of motion ask for {missing}. {moves} The lines for the model file stand with the terms that were \
             tried; --structure auto takes them in."
        )
    })
}
