//! The rows of a store: what one parameter of one segment of one flight is, or why a flight or a segment has none.

use phugoid_identification::estimation::{Estimation, ParameterResult, UncertainQuantity};
use serde::{Deserialize, Serialize};

/// Version of the schema of [`Row`] and [`LogRow`](crate::logs::LogRow). It is part of every key, so that rows of two
/// schemas never stand under one key, and it changes whenever a column changes its name, type or meaning.
pub const SCHEMA: u32 = 2;

/// The file by which the folder of a store is known; it holds the number of the schema.
pub(crate) const STORE_MARK: &str = "phugoid-fleet-store.txt";

/// The `parameter_status` of a row that is no estimate but the bound of any.
pub const BOUND: &str = "bound";

/// Number of quantities that a budget of systematic errors can have parts of.
pub const QUANTITIES: usize = UncertainQuantity::ALL.len();

/// One row of the store. `None` becomes null in Parquet; numbers that are not finite are `None`.
///
/// A row depends on nothing but the content of the flight, the text of the model, the options and the version of this
/// program. It holds neither times nor names of machines, so that two runs give the same rows bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Key of the unit of work that the row belongs to, 64 hexadecimal digits.
    pub key: String,
    /// Where the flight comes from: `log`, or `campaign` for a simulated one.
    pub kind: String,
    /// SHA-256 of the log, or of the scenario as it was flown; `None` where a file could not be read at all.
    pub source_sha256: Option<String>,
    /// SHA-256 of the text of the model file; of one with a `base` in files the hash of that and of the hashes of these.
    pub model_sha256: String,
    /// The name that the model file gives the aircraft.
    pub model: String,
    /// Version of this program.
    pub version: String,
    /// The method that estimated; of a refusal the one that was asked for.
    pub method: String,
    /// Number of the segment: the manoeuvre from 1, or 0 for the whole flight. `None` where the flight was refused.
    pub segment: Option<i64>,
    /// First time of the segment, s.
    pub from_s: Option<f64>,
    /// Last time of the segment, s.
    pub to_s: Option<f64>,
    /// What moved in the segment, in words: `elevator 3-2-1-1`. `None` for a whole flight.
    pub input: Option<String>,
    /// Length of the whole flight, s.
    pub duration_s: Option<f64>,
    /// What the clock of the autopilot says at time zero of `from_s` and `to_s`, microseconds since it was switched on. `None` where
    /// the log has no such clock.
    pub clock_at_zero_us: Option<i64>,
    /// Median true airspeed over the segment, m/s.
    pub airspeed_m_s: Option<f64>,
    /// Median angle of attack over the segment, rad.
    pub alpha_rad: Option<f64>,
    /// Median altitude over the segment, m.
    pub altitude_m: Option<f64>,
    /// What the result is worth: `sound`, `provisional`, `doubtful` or `refused`.
    pub status: String,
    /// Where there are no numbers, why, as a word: see [`Refusal`].
    pub refusal: Option<String>,
    /// Words of the reasons against the result, separated by commas.
    pub reasons: Option<String>,
    /// The reasons, or the error, in sentences.
    pub message: Option<String>,
    /// Name of the parameter; `None` where there are no numbers.
    pub parameter: Option<String>,
    /// Unit of the parameter as it is printed.
    pub unit: Option<String>,
    /// The estimate, in `unit`.
    pub value: Option<f64>,
    /// One standard error: random and systematic.
    pub std_error: Option<f64>,
    /// The part of it that noise and turbulence make, one sigma.
    pub random_std: Option<f64>,
    /// The part of it that the declared uncertainties make, one sigma.
    pub systematic_std: Option<f64>,
    /// Lower bound, `value - 2 std_error`.
    pub lower: Option<f64>,
    /// Upper bound, `value + 2 std_error`.
    pub upper: Option<f64>,
    /// How well the parameter is known: `converged`, `improving`, ...; [`BOUND`] where nothing was estimated.
    pub parameter_status: Option<String>,
    /// Whether the parameter is an offset or a bias that only keeps the others right.
    pub nuisance: Option<bool>,
    /// First time from which on the estimate stays near its end, s.
    pub converged_at_s: Option<f64>,
    /// What a positive error of each declared quantity of one sigma does to the estimate, in `unit`, in the order of
    /// [`UncertainQuantity::ALL`]: the parts of `systematic_std`, with their signs.
    pub budget: [Option<f64>; QUANTITIES],
    /// Of a campaign: name of the scenario.
    pub scenario: Option<String>,
    /// Of a campaign: the seed that was flown.
    pub seed: Option<i64>,
    /// Of a campaign: what was varied, as a JSON object from path to value.
    pub factors: Option<String>,
    /// The true value, where it is known.
    pub truth: Option<f64>,
    /// Estimate less truth over `std_error`.
    pub error_over_sigma: Option<f64>,
    /// Whether the truth lies within two standard errors.
    pub covered: Option<bool>,
}

/// What one run of a study has measured. A row depends on nothing but what the study asks and the version of this program;
/// computing times, which `compare` measures, are those of whoever made the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunRow {
    /// Key of the run, 64 hexadecimal digits: of all columns but the last, and of the content of the files that the study names.
    pub key: String,
    /// The study: `accuracy`, `damage`, `recovery`, ...; `compare`; `tune`.
    pub study: String,
    /// Version of this program.
    pub version: String,
    /// What all runs of one kind have in common: the question, methods, options, times.
    pub inputs: String,
    /// Which of them: its seed or its number, and what it was made with.
    pub run: String,
    /// What was measured, as JSON. Numbers that are not finite are the words `NaN`, `inf` and `-inf`.
    pub result: String,
}

/// Why there are no numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Refusal {
    /// The operating system does not give the file.
    Unreadable,
    /// This build does not read the format. It is tried again in the next run, which may be another build.
    FormatNotInBuild,
    /// The file is not a flight, or lacks what every flight has.
    NotAFlight,
    /// No surface moved visibly, so that there is no segment.
    NoManoeuvre,
    /// A segment from which no derivative can be estimated.
    NotUseful,
    /// The estimation gave an error: a missing channel, too few samples, no solution.
    NotEstimated,
    /// A scenario of a campaign cannot be flown.
    NotFlown,
}

impl Refusal {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Unreadable,
        Self::FormatNotInBuild,
        Self::NotAFlight,
        Self::NoManoeuvre,
        Self::NotUseful,
        Self::NotEstimated,
        Self::NotFlown,
    ];

    /// The word in the column `refusal`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Unreadable => "unreadable",
            Self::FormatNotInBuild => "format-not-in-build",
            Self::NotAFlight => "not-a-flight",
            Self::NoManoeuvre => "no-manoeuvre",
            Self::NotUseful => "not-useful",
            Self::NotEstimated => "not-estimated",
            Self::NotFlown => "not-flown",
        }
    }

    /// Whether the reason may be gone in the next run with the same log, model and version.
    pub const fn is_tried_again(self) -> bool {
        matches!(self, Self::Unreadable | Self::FormatNotInBuild)
    }
}

/// The number if it is finite.
pub(crate) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl Row {
    /// This row as a refusal, with its reason in a sentence.
    pub fn refused(&self, refusal: Refusal, message: impl Into<String>) -> Self {
        Self {
            status: "refused".to_owned(),
            refusal: Some(refusal.word().to_owned()),
            message: Some(message.into()),
            ..self.clone()
        }
    }

    /// One row for each parameter of an estimation; this row gives what they have in common.
    pub fn of_estimation(&self, estimation: &Estimation) -> Vec<Self> {
        let codes: Vec<&str> = estimation.reasons.iter().map(|reason| reason.code.word()).collect();
        let sentences: Vec<&str> = estimation.reasons.iter().map(|reason| reason.sentence.as_str()).collect();
        let text = |words: Vec<&str>, with: &str| (!words.is_empty()).then(|| words.join(with));
        let common = Self {
            method: estimation.method.name().to_owned(),
            status: estimation.status.word().to_owned(),
            reasons: text(codes, ","),
            message: text(sentences, " "),
            ..self.clone()
        };
        estimation.parameters.iter().map(|parameter| common.with_parameter(parameter)).collect()
    }

    fn with_parameter(&self, p: &ParameterResult) -> Self {
        let mut budget = [None; QUANTITIES];
        for part in &p.systematic_parts {
            if let Some(place) = UncertainQuantity::ALL.iter().position(|quantity| *quantity == part.quantity) {
                budget[place] = finite(part.effect);
            }
        }
        let over_sigma = p.truth.map(|truth| (p.value - truth) / p.corrected_std_error).and_then(finite);
        Self {
            parameter: Some(p.name.clone()),
            unit: Some(p.unit.clone()),
            value: finite(p.value),
            std_error: finite(p.corrected_std_error),
            random_std: finite(p.random_std()),
            systematic_std: finite(p.systematic_std),
            lower: finite(p.lower),
            upper: finite(p.upper),
            parameter_status: Some(p.status.word().to_owned()),
            nuisance: Some(p.nuisance),
            converged_at_s: p.converged_at_s.and_then(finite),
            budget,
            truth: p.truth.and_then(finite),
            error_over_sigma: over_sigma,
            covered: over_sigma.map(|sigmas| sigmas.abs() <= 2.0),
            ..self.clone()
        }
    }
}
