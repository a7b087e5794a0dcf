//! One flight, one method: the path of `phugoid estimate`, and what came of it.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{
    ChangeOutcome, Estimation, EstimationStatus, EventKind, FinalStatus, is_in_part,
};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use serde::Serialize;

use super::standing::{Word, refusal, standing};
use super::truth::{Kind, TrueParameter, Truth};
use super::watch::{Watched, watch};
use crate::put_in::declared::Sizes;
use crate::put_in::fault::Corruption;
use crate::put_in::reread;
use crate::statistics::median;

/// Errors beyond this many claimed standard errors are counted as wrong.
const WRONG: f64 = 4.0;

/// The estimate of one derivative that the flight shows, beside the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Name of the parameter.
    pub name: String,
    /// True value of this flight.
    pub truth: f64,
    /// Standard error of `truth` that what the terms do not explain would make.
    pub structure_std: f64,
    /// Estimate at the end.
    pub value: f64,
    /// Claimed standard error, corrected for the colour of the residuals.
    pub std_error: f64,
    /// The part of it that the model file declares: errors that leave no trace, of which these flights have none.
    pub systematic_std: f64,
    /// What the estimation says of the parameter.
    pub status: FinalStatus,
    /// Whether the estimation takes this value back and leaves others standing, because the model lacks a term.
    pub is_taken_back: bool,
}

impl Compared {
    /// Error as a part of the truth.
    pub fn relative_error(&self) -> f64 {
        (self.value - self.truth).abs() / self.truth.abs()
    }

    /// Square of the error over the claimed standard error without its declared part, the truth's own uncertainty
    /// included: one on average where the claims are right. NaN for a method without bounds.
    pub fn error_squared(&self) -> f64 {
        let claimed = self.std_error * self.std_error - self.systematic_std * self.systematic_std;
        let error = self.value - self.truth;
        error * error / (claimed.max(0.0) + self.structure_std * self.structure_std)
    }

    /// Whether the truth lies within two claimed standard errors; a method without bounds claims none.
    pub fn is_covered(&self) -> bool {
        (self.value - self.truth).abs() <= 2.0 * self.std_error
    }

    /// Whether the truth lies within two claimed standard errors without their declared part, the truth's own uncertainty
    /// included ([`error_squared`](Self::error_squared) of at most two squared). False for a method without bounds and for a value
    /// that is not finite.
    pub fn is_covered_by_random(&self) -> bool {
        self.error_squared() <= 4.0
    }

    /// Whether the estimate is called converged and lies more than four standard errors from the truth, the truth's own
    /// uncertainty included. A value that is not finite is wrong.
    pub fn is_wrong(&self) -> bool {
        let claimed = self.std_error.hypot(self.structure_std);
        // Not `>`: NaN counts as wrong.
        let within = (self.value - self.truth).abs() <= WRONG * claimed;
        self.status == FinalStatus::Converged && !within
    }
}

/// How the predictions of one estimation agreed with its flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Consistency {
    /// Mean square of the normalised innovations since the first motion, by output, averaged over the outputs; one where
    /// the covariance is right.
    pub innovation_squared: f64,
    /// Longest time in which more than four of five rows of one output were rejected, s.
    pub longest_rejected_s: f64,
    /// The output that this is of.
    pub most_rejected: String,
}

/// A sudden change that an estimation adopted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Adoption {
    /// When, s.
    pub time_s: f64,
    /// The times between which it is said to have happened, s; `None` of what is found in flight.
    pub interval_s: Option<[f64; 2]>,
    /// What became of it.
    pub outcome: ChangeOutcome,
    /// The parameters that it calls changed, constants included, the most certain first.
    pub changed: Vec<String>,
}

impl Adoption {
    /// Whether it cannot be the real change, because it came before that: what is found afterwards lies between two times, what
    /// is found in flight is found after it.
    pub fn is_before(&self, change: &RealChange) -> bool {
        self.interval_s.map_or(self.time_s, |[_, to_s]| to_s) < change.time_s
    }

    /// Whether the real change happened between the times that are given; `None` where none are.
    pub fn is_dated_rightly(&self, change: &RealChange) -> Option<bool> {
        self.interval_s.map(|[from_s, to_s]| (from_s..=to_s).contains(&change.time_s))
    }
}

/// Standard errors from which a parameter is called changed, as the verdict does.
const CHANGED: f64 = 3.0;

/// Sudden changes that an estimation adopted, and what they did to it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Adoptions {
    /// The adopted changes in the order of time, those that were taken back included.
    pub adopted: Vec<Adoption>,
    /// Median relative error of the derivatives that count, just before the first adopted change was suspected, and at the
    /// end of the flight; none where nothing was adopted.
    pub error_before_and_after: Option<[f64; 2]>,
}

impl Adoptions {
    /// The changes that were not taken back.
    pub fn kept(&self) -> impl Iterator<Item = &Adoption> {
        self.adopted.iter().filter(|a| a.outcome.stands())
    }

    /// Whether the estimate after the adoptions is worse than the one before them.
    pub fn harmed(&self) -> bool {
        self.error_before_and_after.is_some_and(|[before, after]| after.is_nan() || after > before)
    }
}

/// A real change of the aircraft in flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealChange {
    /// When, s.
    pub time_s: f64,
    /// Names of the parameters that changed.
    pub parameters: Vec<String>,
    /// Largest change of a true derivative among them, as a part of its value before; zero where constants changed only.
    pub size: f64,
}

/// Part of a derivative from which a change counts as one of half of it. True values are least squares over the flight before and
/// after, so that a derivative that was halved in the simulator's tables differs by 0.45 to 0.55.
const HALF: f64 = 0.45;

impl RealChange {
    fn of(truth: &Truth) -> Option<Self> {
        let change = truth.change.as_ref()?;
        let relative = |name: &String| {
            let (before, after) = (truth.truth.parameters.get(name)?.value, change.after.get(name)?.value);
            (!is_constant(name)).then_some(((after - before) / before).abs())
        };
        let parameters: Vec<String> = change.changes.keys().cloned().collect();
        let size = parameters.iter().filter_map(relative).fold(0.0, f64::max);
        Some(Self { time_s: change.time_s, parameters, size })
    }

    /// Whether a derivative lost (or gained) half of its value or more.
    pub fn is_of_half(&self) -> bool {
        self.size >= HALF
    }

    /// Whether constants changed only: no damage, but load, a tab, an asymmetry.
    pub fn is_trim_shift(&self) -> bool {
        self.parameters.iter().all(|name| is_constant(name))
    }
}

/// Whether a parameter is a constant of a coefficient, by its name.
pub(super) fn is_constant(name: &str) -> bool {
    name.ends_with("_0") || name.starts_with("offset")
}

/// What one method made of one flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// Name of the aircraft.
    pub aircraft: String,
    /// Name of the flight.
    pub flight: String,
    /// Group of the flight.
    pub group: String,
    /// `longitudinal` or `lateral`.
    pub axes: String,
    /// Sound, or with systematic errors.
    pub kind: Kind,
    /// Length of the record, h.
    pub hours: f64,
    /// The method.
    pub method: Method,
    /// The error that was put into the flight, if one was.
    pub corruption: Option<Corruption>,
    /// What the estimation says of itself.
    pub word: Word,
    /// The derivatives that count; empty where there is no estimate.
    pub parameters: Vec<Compared>,
    /// How the predictions agreed with the flight; none where there is no estimate, or by a batch method.
    pub consistency: Option<Consistency>,
    /// Changes that were adopted.
    pub adoptions: Adoptions,
    /// What really changed in flight.
    pub change: Option<RealChange>,
    /// The health monitor on this flight, for the flights that it watches.
    pub watched: Option<Watched>,
}

impl Trial {
    /// The numbers that the user may take, after a look at the doubts if there are any.
    pub fn given(&self) -> impl Iterator<Item = &Compared> {
        let is_given = self.word.standing != EstimationStatus::Refused;
        self.parameters.iter().filter(move |p| is_given && !p.is_taken_back)
    }

    /// The derivatives that are called converged: none where a doubt concerns them.
    pub fn claimed(&self) -> impl Iterator<Item = &Compared> {
        self.parameters.iter().filter(|p| p.status == FinalStatus::Converged)
    }

    /// The derivatives that are wrong, called converged, and without a warning.
    pub fn silently_wrong(&self) -> usize {
        self.claimed().filter(|p| p.is_wrong()).count()
    }

    /// Whether nothing is said against what a change has left of the parameters that it changed.
    pub fn is_silent_of(&self, change: &RealChange) -> bool {
        let is_changed = |p: &Compared| change.parameters.contains(&p.name);
        self.word.standing == EstimationStatus::Sound || self.claimed().any(is_changed)
    }
}

/// One flight of the field in memory.
pub(super) struct Flight {
    pub(super) truth: Truth,
    pub(super) model: ModelFile,
    /// The record, or why it could not be read.
    pub(super) record: Result<Record, String>,
}

impl Flight {
    /// The flight with errors of these sizes in it: record, model file, and what is then true. Where the reader does not take the record
    /// any more, that is why there is none.
    pub(super) fn with(&self, sizes: &Sizes) -> Self {
        let (mut truth, mut model) = (self.truth.clone(), self.model.clone());
        let shift = |parameters: &mut BTreeMap<String, TrueParameter>| {
            let before = parameters.clone();
            let of = |name: &str| before.get(name).map(|p| p.value);
            parameters.iter_mut().for_each(|(name, p)| p.value += sizes.shift_of_truth(&self.model, name, of));
        };
        shift(&mut truth.truth.parameters);
        truth.change.iter_mut().for_each(|change| shift(&mut change.after));
        let record = self.record.clone().and_then(|mut record| {
            sizes.put_in(&mut record, &mut model);
            reread(record)
        });
        Self { truth, model, record }
    }

    /// Runs the method of the options on the flight, with an error if one is given, and the health monitor beside it if `watched`.
    pub(super) fn trial(&self, options: &EstimateOptions, corruption: Option<Corruption>, watched: bool) -> Trial {
        let truth = &self.truth;
        let mut trial = Trial {
            aircraft: truth.aircraft.clone(),
            flight: truth.flight.clone(),
            group: truth.group.clone(),
            axes: truth.axes.clone(),
            kind: if corruption.is_some() { Kind::Faulty } else { truth.kind },
            hours: 0.0,
            method: options.method.unwrap_or_default(),
            corruption,
            word: Word::refused("unreadable"),
            parameters: Vec::new(),
            consistency: None,
            adoptions: Adoptions::default(),
            change: RealChange::of(truth),
            watched: None,
        };
        let Ok(record) = &self.record else { return trial };
        let mut model = self.model.clone();
        let corrupted;
        let record = match corruption {
            None => record,
            Some(corruption) => match corrupt(record, &mut model, corruption) {
                Ok(record) => {
                    corrupted = record;
                    &corrupted
                }
                // The reader does not take it any more, and says so.
                Err(_) => return trial,
            },
        };
        trial.hours = record.time.first().zip(record.time.last()).map_or(0.0, |(a, b)| (b - a) / 3600.0);
        // As `phugoid estimate` does by default.
        let options = EstimateOptions { structure: StructureSearch::Offer, ..options.clone() };
        match estimate(record, &model, &options, &mut |_| {}) {
            Err(error) => trial.word = refusal(&error),
            Ok(estimation) => {
                trial.word = standing(&estimation);
                trial.parameters = compared(&estimation, truth);
                trial.consistency = consistency(&estimation);
                trial.adoptions = adoptions(&estimation, truth);
            }
        }
        if watched {
            trial.watched = watch(record, &model, truth);
        }
        trial
    }
}

/// The record with the error in it, read again as a file would be, so that the reader sees it too.
fn corrupt(record: &Record, model: &mut ModelFile, corruption: Corruption) -> Result<Record, String> {
    let mut changed = record.clone();
    corruption.apply(&mut changed, model);
    reread(changed)
}

fn consistency(estimation: &Estimation) -> Option<Consistency> {
    let outputs = &estimation.consistency;
    let squares: Vec<f64> = outputs.iter().filter_map(|o| o.mean_square).collect();
    let most = outputs.iter().max_by(|a, b| a.longest_rejected_s.total_cmp(&b.longest_rejected_s))?;
    Some(Consistency {
        innovation_squared: squares.iter().sum::<f64>() / squares.len() as f64,
        longest_rejected_s: most.longest_rejected_s,
        most_rejected: most.name.clone(),
    })
}

/// The derivatives that count, at the end of the flight.
fn compared(estimation: &Estimation, truth: &Truth) -> Vec<Compared> {
    let counting = truth.at_end().iter().filter(|(_, p)| p.counts());
    let in_part = is_in_part(&estimation.reasons);
    counting
        .filter_map(|(name, p)| {
            let found = estimation.parameter(name)?;
            Some(Compared {
                name: name.clone(),
                truth: p.value,
                structure_std: p.structure_std,
                value: found.value,
                std_error: found.corrected_std_error,
                systematic_std: found.systematic_std,
                status: found.status,
                is_taken_back: in_part && estimation.reasons.iter().any(|reason| reason.puts_in_doubt(name)),
            })
        })
        .collect()
}

/// The adopted changes, and the errors before and after.
fn adoptions(estimation: &Estimation, truth: &Truth) -> Adoptions {
    let adopted: Vec<Adoption> = estimation
        .changes
        .iter()
        .map(|change| {
            let mut changed: Vec<_> = change.parameters.iter().filter(|p| p.sigmas().abs() > CHANGED).collect();
            changed.sort_by(|a, b| b.sigmas().abs().total_cmp(&a.sigmas().abs()));
            let changed = changed.iter().map(|p| p.name.clone()).collect();
            Adoption { time_s: change.time_s, interval_s: change.interval_s, outcome: change.outcome, changed }
        })
        .collect();
    let Some(first) = adopted.first().map(|a| a.time_s) else { return Adoptions::default() };
    let of = |kind: EventKind| estimation.events.iter().filter(move |e| e.kind == kind).map(|e| e.time_s);
    // Bounds are widened from the suspicion on.
    let suspected = of(EventKind::InDoubt).rfind(|t| *t <= first).unwrap_or(first);
    let counting: Vec<(&String, &TrueParameter)> = truth.at_end().iter().filter(|(_, p)| p.counts()).collect();
    let before = estimation.history.time_s.partition_point(|t| *t < suspected).checked_sub(1);
    let errors = |index: usize| {
        let error = |(name, p): &(&String, &TrueParameter)| {
            let course = estimation.history.parameters.iter().find(|h| h.name == **name)?;
            Some((course.value.get(index)? - p.value).abs() / p.value.abs())
        };
        median(counting.iter().filter_map(error).collect())
    };
    let last = estimation.history.time_s.len().checked_sub(1);
    let error_before_and_after = before.zip(last).filter(|_| !counting.is_empty()).map(|(b, l)| [errors(b), errors(l)]);
    Adoptions { adopted, error_before_and_after }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(value: f64, std_error: f64, status: FinalStatus) -> Compared {
        Compared {
            name: "Cm_q".to_owned(),
            truth: -20.0,
            structure_std: 0.3,
            value,
            std_error,
            systematic_std: 0.0,
            status,
            is_taken_back: false,
        }
    }

    #[test]
    fn wrong_is_what_is_claimed_and_beyond_four_standard_errors() {
        let claimed = FinalStatus::Converged;
        // The claim and the truth's own uncertainty together: 0.5, so that 2.0 is the limit.
        assert!(!compared(-18.1, 0.4, claimed).is_wrong());
        assert!(compared(-17.9, 0.4, claimed).is_wrong());
        assert!(!compared(-17.9, 0.4, FinalStatus::Improving).is_wrong());
        assert!(compared(f64::NAN, 0.4, claimed).is_wrong());
        assert!(!compared(-18.1, 0.4, claimed).is_covered() && compared(-19.3, 0.4, claimed).is_covered());
        assert!((compared(-18.0, 0.4, claimed).relative_error() - 0.1).abs() < 1e-12);
    }
}
