//! How well the parameters of one model could be estimated from a record: the Cramer-Rao bound, manoeuvre by manoeuvre.

use phugoid_flight_data::record::Record;
use serde::{Deserialize, Serialize};

use crate::core::axes::Group;
use crate::core::systematic::in_words;
use crate::manoeuvres::{Found, Manoeuvre, Support};
use crate::methods::{Predicted, PredictedParameter, predict};
use crate::model_file::{Base, ModelFile};

/// Manoeuvres that are looked at, the useful ones from the first on.
const MOST_MANOEUVRES: usize = 20;
/// Largest two standard errors, relative to the value, of a parameter that counts as well known, and of one that counts
/// as roughly known.
const WELL_KNOWN: f64 = 0.25;
const ROUGHLY_KNOWN: f64 = 1.0;
/// A standard error above this part of the prior's means that the data add nothing.
const NOTHING_NEW: f64 = 0.95;
/// Declared quantities that are named where they make most of a bound.
const MOST_CONTRIBUTORS: usize = 3;
/// Correlation of errors from which on two parameters are only known together.
const TOGETHER: f64 = 0.9;

/// How well the parameters of one model could be estimated from the manoeuvres of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelSupport {
    /// File or built-in name of the model.
    pub model: String,
    /// One entry per useful manoeuvre, and one for all of them together where there are several.
    pub segments: Vec<SegmentSupport>,
    /// Why manoeuvres were not looked at, one sentence each.
    pub reasons: Vec<String>,
}

/// How well the parameters could be estimated from one manoeuvre, or from several that are fitted together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SegmentSupport {
    /// Numbers of the manoeuvres, as for `--segment`.
    pub manoeuvres: Vec<usize>,
    /// Parameters in the order of the model file, offsets and sensor biases left out.
    pub parameters: Vec<ParameterSupport>,
    /// How the bounds were computed, or why there are none, one sentence each.
    pub notes: Vec<String>,
}

/// How well one parameter could be estimated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterSupport {
    /// The class of [`expected`](Self::expected).
    pub support: Support,
    /// Two expected standard errors over the size of the value; for an increment to a database, over one prior standard
    /// deviation.
    pub expected: f64,
    /// The part of it that the declared uncertainties of the model file make, over the same: a better calibration makes it
    /// smaller, another manoeuvre hardly.
    #[serde(default)]
    pub declared: f64,
    /// Two sigma of the Cramer-Rao bound with the noise of the sensors alone, over the same.
    pub at_best: f64,
    /// Why the parameter cannot be estimated better, in words; empty where nothing is to be said.
    pub reason: String,
    /// The Cramer-Rao bound of the parameter on these manoeuvres.
    #[serde(flatten)]
    pub bound: PredictedParameter,
}

impl ModelSupport {
    /// The entry with the smallest expected error of this parameter; `None` if no entry has a bound of it.
    pub fn best(&self, parameter: &str) -> Option<(&SegmentSupport, &ParameterSupport)> {
        let of = |segment: &'_ SegmentSupport| segment.parameters.iter().position(|p| p.bound.name == parameter);
        let all = self.segments.iter().filter_map(|segment| Some((segment, segment.parameters.get(of(segment)?)?)));
        all.min_by(|a, b| a.1.expected.total_cmp(&b.1.expected))
    }
}

/// Bounds of the parameters of a model on the useful manoeuvres of a record.
pub fn model_support(record: &Record, found: &Found, model: &ModelFile) -> ModelSupport {
    let axes = model.axes;
    let of_model = |m: &Manoeuvre| {
        (axes.has_longitudinal() && m.moves(Group::Longitudinal)) || (axes.has_lateral() && m.moves(Group::Lateral))
    };
    let suits = |m: &&Manoeuvre| m.useful && of_model(m);
    let useful: Vec<&Manoeuvre> = found.manoeuvres.iter().filter(suits).collect();
    let mut support = ModelSupport { model: model.source.clone(), segments: Vec::new(), reasons: Vec::new() };
    if useful.is_empty() {
        support.reasons.push(format!("no useful manoeuvre moves what {} is about", model.name));
    }
    if useful.len() > MOST_MANOEUVRES {
        support.reasons.push(format!("looked at are the first {MOST_MANOEUVRES} of {} manoeuvres", useful.len()));
    }
    let cut = |m: &&Manoeuvre| {
        let part = record.between(m.from_s, m.to_s)?;
        Some((m.number, Record { source: format!("manoeuvre {}", m.number), ..part }))
    };
    let parts: Vec<(usize, Record)> = useful.iter().take(MOST_MANOEUVRES).filter_map(cut).collect();
    let (numbers, records): (Vec<usize>, Vec<Record>) = parts.into_iter().unzip();
    for (number, record) in numbers.iter().zip(&records) {
        support.segments.push(segment(vec![*number], std::slice::from_ref(record), model));
    }
    if records.len() > 1 {
        support.segments.push(segment(numbers, &records, model));
    }
    support
}

fn segment(manoeuvres: Vec<usize>, records: &[Record], model: &ModelFile) -> SegmentSupport {
    match predict(records, model) {
        Ok(Predicted { parameters, notes }) => {
            let parameters = parameters.into_iter().filter(|p| !p.nuisance).map(|p| judge(p, model.base)).collect();
            SegmentSupport { manoeuvres, parameters, notes }
        }
        Err(why) => SegmentSupport { manoeuvres, parameters: Vec::new(), notes: vec![why.to_string()] },
    }
}

fn judge(bound: PredictedParameter, base: Base) -> ParameterSupport {
    let scale = match base {
        Base::None => bound.value.abs(),
        Base::F16 | Base::Aircraft => bound.prior_std,
    };
    let [expected, declared, at_best] =
        [bound.expected_std_error, bound.systematic_std, bound.std_error].map(|std_error| 2.0 * std_error / scale);
    let together = bound.closest.as_ref().filter(|(_, correlation)| correlation.abs() > TOGETHER);
    let with = together.map(|(name, correlation)| format!("goes with {name} (correlation {correlation:+.2})"));
    // Where they are more than half of the variance.
    let of_declared = (bound.systematic_std > bound.expected_std_error * std::f64::consts::FRAC_1_SQRT_2)
        .then(|| format!("mostly declared: {}", in_words(&bound.systematic_parts, MOST_CONTRIBUTORS)));
    let both = with.into_iter().chain(of_declared.clone()).collect::<Vec<String>>().join("; ");
    let (support, reason) = if bound.expected_std_error > NOTHING_NEW * bound.prior_std {
        (Support::No, "the data add nothing to what was known beforehand".to_owned())
    } else if expected <= WELL_KNOWN {
        (Support::Told, of_declared.unwrap_or_default())
    } else if expected <= ROUGHLY_KNOWN {
        (Support::Roughly, both)
    } else {
        (Support::No, if both.is_empty() { "not distinguished from zero".to_owned() } else { both })
    };
    ParameterSupport { support, expected, declared, at_best, reason, bound }
}
