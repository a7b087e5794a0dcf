//! The structure of a coefficient from flight: which polynomial of many candidates the measured motion asks for.
//!
//! The coefficient follows from the equations of motion, with measured rates and accelerations, mass, inertia and thrust of
//! the model file, as in equation error (Klein & Morelli, *Aircraft System Identification*, chapter 5). Candidates are then
//! taken in one after the other by multivariate orthogonal functions, or by modified stepwise regression. What is found
//! is the text of a model file, to be estimated by a method that knows the noise of the sensors.

mod columns;
mod criterion;
mod selection;

use phugoid_flight_data::printable::toml_string;
use phugoid_flight_data::record::Record;
use serde::{Deserialize, Serialize};

use crate::core::axes::{Axes, Group};
use crate::core::error::EstimateError;
use crate::core::estimation::{ModelLine, VerdictReason};
use crate::core::number::significant;
use crate::core::stack::on_a_large_stack;
use crate::core::term::{Coefficient, EXTRA_INPUTS, Term, Variable};
use crate::judge::offer::round_up;
use crate::judge::reasons::channel as of_channel;
use crate::model_file::{Base, ModelFile};
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::preparation::checks::doubts;
use columns::{MOST_CANDIDATES, columns};
pub use criterion::Criterion;
use selection::{Problem, Rule, Selection};

/// Chance of a term that is not there, over all candidates of a flight, that the F to enter is made for.
const FALSE_TERMS: f64 = 0.01;
/// Prior one sigma of a parameter in the lines for a model file, in values that the regression finds.
const PRIOR: f64 = 2.0;
/// Significant digits of a start value there.
const DIGITS: i32 = 5;

/// What [`regress`] looks for.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressOptions {
    /// The coefficient that is modelled.
    pub coefficient: Coefficient,
    /// Candidate terms as a model file writes them; `None` takes the first-order terms of the coefficient's axes.
    pub candidates: Option<Vec<String>>,
    /// All products of the plain candidates up to this total power are candidates too; at least 1. `None`: 2 with the
    /// candidates of the axes, 1 with given ones.
    pub up_to: Option<u32>,
    /// What ends the selection.
    pub criterion: Criterion,
    /// Partial F, corrected for colour, that a term needs to be taken in by [`Criterion::F`]. `None`: the value that needless
    /// terms reach in one flight of a hundred, `2 ln(100 candidates)`.
    pub f_to_enter: Option<f64>,
    /// Partial F that a term needs to stay, with every criterion; `None`: the F to enter.
    pub f_to_remove: Option<f64>,
}

impl RegressOptions {
    /// All candidates of the axes up to second order, ended by the predicted square error.
    pub fn new(coefficient: Coefficient) -> Self {
        Self {
            coefficient,
            candidates: None,
            up_to: None,
            criterion: Criterion::Pse,
            f_to_enter: None,
            f_to_remove: None,
        }
    }
}

/// The polynomial that a coefficient of a flight asks for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepwiseRegression {
    /// Source of the record.
    pub source: String,
    /// Name of the model file.
    pub model: String,
    /// Symbol of the coefficient; with `d` in front where it is an increment to the base of the model file.
    pub coefficient: String,
    /// Rows of the regression: samples, thinned to 0.05 s.
    pub rows: usize,
    /// The candidates, as a model file writes them.
    pub candidates: Vec<String>,
    /// What ended the selection.
    pub criterion: Criterion,
    /// Partial F that a term needed to be taken in.
    pub f_to_enter: f64,
    /// Partial F that a term needed to stay.
    pub f_to_remove: f64,
    /// The steps, the first with the constant alone.
    pub steps: Vec<RegressionStep>,
    /// The terms of the final polynomial, the constant first.
    pub terms: Vec<RegressionTerm>,
    /// Share of the coefficient's squares about its mean that the polynomial explains.
    pub r_squared: f64,
    /// Standard deviation of the coefficient that is left.
    pub residual_std: f64,
    /// What became of candidates that are not in the polynomial for another reason than that they explain too little, in
    /// sentences.
    pub remarks: Vec<String>,
    /// Lines for a model file.
    pub lines: Vec<ModelLine>,
    /// What speaks against the values: units, signs and sensors of the channels that are used. Empty where an older version
    /// wrote the result.
    #[serde(default)]
    pub reasons: Vec<VerdictReason>,
}

/// One step of the selection, with the model of all terms up to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegressionStep {
    /// The term that is taken in; `1` for the constant.
    pub term: String,
    /// Share of the coefficient's squares about its mean that is explained.
    pub r_squared: f64,
    /// By how much the term raises that.
    pub gain: f64,
    /// Predicted square error, in squares of the coefficient.
    pub pse: f64,
    /// Mean square of residuals predicted without their own rows, in squares of the coefficient.
    pub press: f64,
    /// Partial F of the term when it was taken in, corrected for residuals that last; `None` for the constant.
    pub partial_f: Option<f64>,
    /// Whether the term is in the final polynomial.
    pub taken: bool,
    /// Candidates that would have explained at least 0.8 of what the term does at this step.
    pub alike: Vec<String>,
}

/// One term of the polynomial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegressionTerm {
    /// The term as a model file writes it.
    pub term: String,
    /// Name of its parameter.
    pub parameter: String,
    /// Its value, per radian where an angle is involved.
    pub value: f64,
    /// One standard error, corrected for residuals that last. What noise in the regressors does is not in it.
    pub std_error: f64,
    /// Partial F beside all other terms, corrected likewise.
    pub partial_f: f64,
}

/// Selects the terms of a coefficient from a record, with the masses, sizes and channels of a model file; the terms of the
/// file are not used.
///
/// Rows without a value of anything that the equation needs (NaN, gaps) are left out. Both sides go through the same
/// smoothing. Noise in the regressors draws the values towards zero: final values belong to a method that knows it.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::model_file::ModelFile;
/// use phugoid_identification::regress::{RegressOptions, regress};
/// use phugoid_identification::term::Coefficient;
/// let flight = Record::open("examples/flight.csv")?;
/// let found = regress(&flight, &ModelFile::named("f16-model")?, &RegressOptions::new(Coefficient::PitchingMoment))?;
/// // The flight has dCm_alpha = -0.2 beside the tables of the model file.
/// assert!(found.terms.iter().any(|term| term.parameter == "dCm_alpha"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EstimateError`]: a missing channel; [`EstimateError::Units`] for a unit or sign that is certainly wrong; [`EstimateError::Model`] for a coefficient that the axes of the model do not have,
/// a candidate that cannot be read, too many candidates, or a coefficient that does not move.
pub fn regress(
    record: &Record,
    model: &ModelFile,
    options: &RegressOptions,
) -> Result<StepwiseRegression, EstimateError> {
    let wrong = |why: String| EstimateError::Model(format!("regression of {}: {why}", options.coefficient.symbol()));
    if !model.axes.coefficients().contains(&options.coefficient) {
        let there: Vec<&str> = model.axes.coefficients().iter().map(|c| c.symbol()).collect();
        return Err(wrong(format!("the {} motion of the model has {}", model.axes.name(), there.join(", "))));
    }
    for limit in [options.f_to_enter, options.f_to_remove].into_iter().flatten() {
        if !(limit.is_finite() && limit >= 0.0) {
            return Err(wrong(format!("an F of {limit}: it has to be a number from 0")));
        }
    }
    let mut extra_inputs = model.extra_inputs.clone();
    let terms = candidates(record, model, options, &mut extra_inputs).map_err(wrong)?;
    // The terms of the file are not used, but what the new ones need.
    let used = ModelFile { extra_inputs: extra_inputs.clone(), ..model.clone() };
    let doubts = doubts(record, &used)?;
    let automatic = 2.0 * (terms.len().max(1) as f64 / FALSE_TERMS).ln();
    let f_to_enter = options.f_to_enter.unwrap_or(automatic);
    let f_to_remove = options.f_to_remove.unwrap_or(f_to_enter);
    if f_to_remove > f_to_enter {
        return Err(wrong(format!("the F to remove, {f_to_remove}, is larger than the F to enter, {f_to_enter}")));
    }
    let work = |_: &mut dyn FnMut(f64)| match model.axes {
        Axes::Longitudinal => {
            columns::<LongitudinalModel, _, _>(record, model, options.coefficient, &terms, &extra_inputs)
        }
        Axes::LateralDirectional => {
            columns::<LateralModel, _, _>(record, model, options.coefficient, &terms, &extra_inputs)
        }
        Axes::All => columns::<SixModel, _, _>(record, model, options.coefficient, &terms, &extra_inputs),
    };
    let problem: Problem = on_a_large_stack(&work, &mut |_| {})?;
    let rule = Rule { criterion: options.criterion, f_to_enter, f_to_remove };
    let found = problem.select(&rule).ok_or_else(|| {
        let rows = problem.used.iter().filter(|used| **used).count();
        wrong(match long_gap(record) {
            Some(gap) => gap,
            None => {
                format!("{rows} rows in which everything was measured do not allow a regression, or it does not move")
            }
        })
    })?;
    let reasons = doubts.iter().map(of_channel).collect();
    Ok(StepwiseRegression {
        reasons,
        ..result(record, model, options.coefficient, &terms, &extra_inputs, rule, &found)
    })
}

/// What to do with a record of which most is a gap: its rows are spread over the whole time, so that few of them meet samples.
fn long_gap(record: &Record) -> Option<String> {
    let (first, last) = record.time.first().zip(record.time.last())?;
    let gap = record.time.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    (gap[1] - gap[0] > 0.5 * (last - first)).then(|| {
        format!(
            "there is no sample between {:.2} s and {:.2} s, which is the larger part of the record. Use one of its parts: \
             --to {:.2}s, or --from {:.2}s",
            gap[0], gap[1], gap[0], gap[1]
        )
    })
}

/// The candidate terms, each once, the constant apart. Channels that they need beside those of the model become further
/// inputs.
fn candidates(
    record: &Record,
    model: &ModelFile,
    options: &RegressOptions,
    extra_inputs: &mut Vec<String>,
) -> Result<Vec<Term>, String> {
    let given: Vec<String> = match &options.candidates {
        Some(given) => given.clone(),
        None => standard(model, options.coefficient),
    };
    let up_to = options.up_to.unwrap_or(if options.candidates.is_some() { 1 } else { 2 });
    if !(1..=9).contains(&up_to) {
        return Err(format!("products up to the power {up_to}: it has to be 1 to 9"));
    }
    let mut terms: Vec<Term> = Vec::new();
    for text in &given {
        let term = parsed(record, model, text.trim(), extra_inputs)?;
        if !term.is_constant() && !terms.contains(&term) {
            terms.push(term);
        }
    }
    let plain: Vec<String> =
        terms.iter().filter(|term| term.single().is_some()).map(|term| term.text(extra_inputs)).collect();
    let mut products: Vec<String> = plain.clone();
    for _ in 1..up_to {
        // Each product once: its factors in the order of the list.
        let last = |product: &str| product.rsplit('*').next().map(str::to_owned).unwrap_or_default();
        products = products
            .iter()
            .flat_map(|product| {
                let from = plain.iter().position(|name| *name == last(product)).unwrap_or(0);
                plain.iter().skip(from).map(move |name| format!("{product}*{name}"))
            })
            .collect();
        for product in &products {
            let term = Term::parse(product, extra_inputs)?;
            if !terms.contains(&term) {
                terms.push(term);
            }
        }
    }
    if terms.is_empty() {
        return Err("there is no candidate beside the constant".to_owned());
    }
    if terms.len() > MOST_CANDIDATES {
        return Err(format!(
            "{} candidates, and there is room for {MOST_CANDIDATES}: name fewer variables, or products up to a lower power",
            terms.len()
        ));
    }
    Ok(terms)
}

/// First-order terms of the axes of a coefficient that the model knows.
fn standard(model: &ModelFile, coefficient: Coefficient) -> Vec<String> {
    let names: &[&str] = match coefficient.group() {
        Group::Longitudinal => &["alpha", "q_hat", "elevator"],
        Group::Lateral => &["beta", "p_hat", "r_hat", "aileron", "rudder"],
    };
    names.iter().map(|name| (*name).to_owned()).chain(model.extra_inputs.iter().cloned()).collect()
}

/// Reads a candidate. A name that is no flight variable of the motion, but a channel of the record, becomes a further input.
fn parsed(record: &Record, model: &ModelFile, text: &str, extra_inputs: &mut Vec<String>) -> Result<Term, String> {
    let unknown = |inputs: &[String]| {
        let known =
            |index: usize| Variable::ALL.get(index).is_none_or(|variable| model.axes.variables().contains(variable));
        match Term::parse(text, inputs) {
            Ok(term) => {
                let foreign = term.powers().map(|(index, _)| index).find(|index| !known(*index));
                match foreign.and_then(|index| Variable::ALL.get(index)) {
                    Some(variable) => {
                        let why = format!("the {} motion does not know `{}`", model.axes.name(), variable.name());
                        Err((variable.name().to_owned(), why))
                    }
                    None => Ok(term),
                }
            }
            Err(why) => {
                // The name stands between the first two back quotes.
                let name = why.split('`').nth(1).unwrap_or_default().to_owned();
                Err((name, why))
            }
        }
    };
    loop {
        match unknown(extra_inputs) {
            Ok(term) => return Ok(term),
            Err((name, why)) => {
                let has = record.channel(&name).is_some_and(|channel| channel.values.iter().any(|v| v.is_finite()));
                if !has || extra_inputs.contains(&name) {
                    return Err(why);
                }
                if extra_inputs.len() >= EXTRA_INPUTS {
                    return Err(format!(
                        "`{name}` would be a further input, and there is room for {EXTRA_INPUTS}: {}",
                        extra_inputs.join(", ")
                    ));
                }
                extra_inputs.push(name);
            }
        }
    }
}

fn result(
    record: &Record,
    model: &ModelFile,
    coefficient: Coefficient,
    terms: &[Term],
    extra_inputs: &[String],
    rule: Rule,
    found: &Selection,
) -> StepwiseRegression {
    let increment = model.base != Base::None;
    let text = |column: Option<usize>| {
        column.and_then(|j| terms.get(j)).map_or_else(|| "1".to_owned(), |term| term.text(extra_inputs))
    };
    let parameter = |column: Option<usize>| {
        let term = column.and_then(|j| terms.get(j)).cloned().unwrap_or_default();
        term.parameter_name(coefficient, increment, extra_inputs)
    };
    let is_taken = |column: Option<usize>| found.fitted.iter().any(|term| term.column == column);
    let mut before = 0.0;
    let steps = found.steps.iter().map(|step| {
        let gain = step.r_squared - before;
        before = step.r_squared;
        RegressionStep {
            term: text(step.column),
            r_squared: step.r_squared,
            gain,
            pse: step.pse,
            press: step.press,
            partial_f: step.column.map(|_| step.partial_f),
            taken: is_taken(step.column),
            alike: step.alike.iter().map(|j| text(Some(*j))).collect(),
        }
    });
    let steps: Vec<RegressionStep> = steps.collect();
    let fitted = found.fitted.iter().map(|term| RegressionTerm {
        term: text(term.column),
        parameter: parameter(term.column),
        value: term.value,
        std_error: term.std_error,
        partial_f: term.partial_f,
    });
    let fitted: Vec<RegressionTerm> = fitted.collect();
    let removed = found.removed.iter().map(|(column, f)| {
        format!(
            "{}: its partial F beside the others is {f:.1}, and {:.1} is needed",
            text(Some(*column)),
            rule.f_to_remove
        )
    });
    let not_told = found.not_told.iter().map(|(column, like)| match like {
        Some(other) => format!("{}: the flight does not tell it from {}", text(Some(*column)), text(Some(*other))),
        None => format!("{}: it does not move, or not apart from the constant", text(Some(*column))),
    });
    StepwiseRegression {
        source: record.source.clone(),
        model: model.source.clone(),
        coefficient: format!("{}{}", if increment { "d" } else { "" }, coefficient.symbol()),
        rows: found.rows,
        candidates: terms.iter().map(|term| term.text(extra_inputs)).collect(),
        criterion: rule.criterion,
        f_to_enter: rule.f_to_enter,
        f_to_remove: rule.f_to_remove,
        r_squared: found.r_squared,
        residual_std: found.residual_std,
        remarks: removed.chain(not_told).collect(),
        lines: lines(model, coefficient, extra_inputs, &fitted),
        reasons: Vec::new(),
        steps,
        terms: fitted,
    }
}

/// The polynomial as a model file writes it.
fn lines(
    model: &ModelFile,
    coefficient: Coefficient,
    extra_inputs: &[String],
    terms: &[RegressionTerm],
) -> Vec<ModelLine> {
    let line = |section: &str, line: String| ModelLine { section: section.to_owned(), line };
    let mut lines = Vec::new();
    let is_used =
        |name: &str| terms.iter().any(|term| term.term.split(['*', '^', '|', '(', ' ']).any(|word| word == name));
    let inputs: Vec<&String> =
        extra_inputs.iter().filter(|name| model.extra_inputs.contains(name) || is_used(name)).collect();
    if inputs.len() > model.extra_inputs.len() {
        let names: Vec<String> = inputs.iter().map(|name| toml_string(name)).collect();
        lines.push(line("", format!("inputs = [{}]", names.join(", "))));
    }
    let words: Vec<String> = terms.iter().map(|term| toml_string(&term.term)).collect();
    lines.push(line("coefficients", format!("{} = [{}]", coefficient.symbol(), words.join(", "))));
    for term in terms {
        let name = &term.parameter;
        let is_bare = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
        let key = if is_bare { name.clone() } else { toml_string(name) };
        let prior_std = round_up(PRIOR * term.value.abs()).unwrap_or(1.0);
        lines.push(line(
            "parameters",
            format!("{key} = {{ start = {}, prior_std = {prior_std} }}", significant(term.value, DIGITS)),
        ));
    }
    lines
}
