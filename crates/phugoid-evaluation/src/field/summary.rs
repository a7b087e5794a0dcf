//! Many trials in a few numbers.

use std::collections::BTreeMap;

use phugoid_identification::estimation::EstimationStatus;
use phugoid_identification::method::Method;
use serde::Serialize;

use super::trial::{Adoption, Compared, RealChange, Trial, is_constant};
use super::truth::Kind;
use super::watch::Alarm;
use crate::statistics::{poisson, quantile};

/// The estimates of a group of flights by one method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupSummary {
    /// What the flights have in common: an aircraft, a group, or a kind of error.
    pub name: String,
    /// Sound flights, or flights with systematic errors.
    pub kind: Kind,
    /// The method.
    pub method: Method,
    /// Number of flights.
    pub flights: usize,
    /// Flights without numbers, or with the word not to use them.
    pub refused: usize,
    /// Flights with the word to look first.
    pub doubtful: usize,
    /// How often each reason was given for not being sound.
    pub reasons: BTreeMap<String, usize>,
    /// Derivatives that count, in flights that were not refused, without those that a missing term takes back.
    pub derivatives: usize,
    /// Median of their relative error; NaN without any.
    pub error_median: f64,
    /// 90 % of them have a smaller relative error.
    pub error_90_percent: f64,
    /// Part of them with the truth within two claimed standard errors.
    pub coverage: f64,
    /// Part of them with the truth within two standard errors of the random part of the claim alone, without what is declared, the
    /// truth's own uncertainty included. Flights without an error put in have no systematic errors, so that it has to be
    /// about 95 %.
    pub coverage_random: f64,
    /// Part of them that is called converged: in flights without a warning, and what a missing term leaves standing.
    pub claimed: f64,
    /// Part of them that is called converged and more than four standard errors wrong.
    pub silently_wrong: f64,
    /// Flights with at least one of those.
    pub flights_silently_wrong: usize,
    /// Flights among them with a remark that leaves the numbers standing.
    pub of_those_remarked: usize,
}

impl GroupSummary {
    /// The numbers of these trials, which have method and kind in common. NaN where there is nothing to count.
    pub fn of(name: &str, kind: Kind, method: Method, trials: &[&Trial]) -> Self {
        let given: Vec<&Compared> = trials.iter().flat_map(|t| t.given()).collect();
        let part = |count: usize| count as f64 / given.len() as f64;
        let errors: Vec<f64> = given
            .iter()
            // A value that is not finite is further away than any other.
            .map(|p| p.relative_error())
            .map(|error| if error.is_nan() { f64::INFINITY } else { error })
            .collect();
        let standing = |wanted: EstimationStatus| trials.iter().filter(|t| t.word.standing == wanted).count();
        let mut reasons = BTreeMap::new();
        for reason in trials.iter().flat_map(|t| &t.word.reasons) {
            *reasons.entry(reason.clone()).or_insert(0) += 1;
        }
        let wrong: Vec<&&Trial> = trials.iter().filter(|t| t.silently_wrong() > 0).collect();
        let claimed = trials.iter().flat_map(|t| t.claimed()).count();
        Self {
            name: name.to_owned(),
            kind,
            method,
            flights: trials.len(),
            refused: standing(EstimationStatus::Refused),
            doubtful: standing(EstimationStatus::Doubtful),
            reasons,
            derivatives: given.len(),
            error_median: quantile(errors.clone(), 0.5),
            error_90_percent: quantile(errors, 0.9),
            coverage: part(given.iter().filter(|p| p.is_covered()).count()),
            coverage_random: part(given.iter().filter(|p| p.is_covered_by_random()).count()),
            claimed: part(claimed),
            silently_wrong: part(trials.iter().map(|t| t.silently_wrong()).sum()),
            flights_silently_wrong: wrong.len(),
            of_those_remarked: wrong.iter().filter(|t| !t.word.remarks.is_empty()).count(),
        }
    }
}

/// Whether the claims of a method are of the size of its errors, and whether its gate locked an output out: sound flights
/// of an aircraft that does not change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConsistencySummary {
    /// The method.
    pub method: Method,
    /// Flights with an estimate, refused ones included.
    pub flights: usize,
    /// Median over the flights of the mean square of the normalised innovations; one where the covariance is right.
    pub innovation_squared: f64,
    /// Median square of the errors of the derivatives that count over their claimed standard errors without the declared
    /// part, flights not refused, over the median of chi-square with one degree of freedom; one where the claims are
    /// right.
    pub error_squared: f64,
    /// Longest time in any flight in which more than four of five rows of one output were rejected, s.
    pub longest_rejected_s: f64,
    /// Flights in which that was longer than a second.
    pub locked_out: usize,
}

/// Median of chi-square with one degree of freedom.
const MEDIAN_SQUARE: f64 = 0.454_936;
/// An output that was rejected for longer than this, s, counts as locked out.
const LOCKED_OUT_S: f64 = 1.0;

impl ConsistencySummary {
    /// The numbers of the trials of one method. NaN where there is nothing to count.
    pub fn of(method: Method, trials: &[&Trial]) -> Self {
        let healthy = || trials.iter().filter(|t| t.kind == Kind::Sound && t.change.is_none());
        let found: Vec<_> = healthy().filter_map(|t| t.consistency.as_ref()).collect();
        let errors = healthy().flat_map(|t| t.given()).map(Compared::error_squared);
        Self {
            method,
            flights: found.len(),
            innovation_squared: quantile(found.iter().map(|c| c.innovation_squared).collect(), 0.5),
            error_squared: quantile(errors.filter(|e| !e.is_nan()).collect(), 0.5) / MEDIAN_SQUARE,
            longest_rejected_s: found.iter().map(|c| c.longest_rejected_s).fold(0.0, f64::max),
            locked_out: found.iter().filter(|c| c.longest_rejected_s > LOCKED_OUT_S).count(),
        }
    }
}

/// Sudden changes as the estimators see them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeSummary {
    /// The method.
    pub method: Method,
    /// Flights of an aircraft that does not change, without systematic errors.
    pub healthy_flights: usize,
    /// Their length together, h.
    pub healthy_hours: f64,
    /// Changes that were adopted in them.
    pub false_adoptions: usize,
    /// Changes among those that were not taken back.
    pub kept: usize,
    /// Flights with one that was not taken back.
    pub flights_with_kept: usize,
    /// Flights with an adoption whose estimate was worse at the end than before the change was suspected.
    pub harmed: usize,
    /// What came of flights in which derivatives change.
    pub damages: FoundChanges,
    /// What came of flights in which constants change.
    pub trim_shifts: FoundChanges,
}

/// What came of flights with a real change. Changes that were taken back do not count as found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundChanges {
    /// Number of flights.
    pub flights: usize,
    /// Flights with an adoption after the change.
    pub found: usize,
    /// Flights in which a derivative lost half of its value or more, and those of them that were found.
    pub of_half: usize,
    /// See `of_half`.
    pub of_half_found: usize,
    /// Flights whose change was not found, and what it changed stands without a warning.
    pub missed_unwarned: usize,
    /// Flights with an adoption before it.
    pub early: usize,
    /// Median time from the change to its first adoption, s, over those that were found.
    pub latency_median_s: f64,
    /// Flights whose first change that cannot be before the real one was found afterwards, so that it lies between two times.
    pub dated: usize,
    /// Those in which the real change lies between them.
    pub dated_rightly: usize,
    /// Median length of these intervals, s.
    pub interval_median_s: f64,
    /// Flights whose first adoption after the change calls a parameter changed that really did, more certainly than any
    /// other of its sort: derivatives of a damage; of a trim shift constants, with the words for it.
    pub named_rightly: usize,
    /// Flights in which another one is called changed the most certainly.
    pub named_wrongly: usize,
}

impl FoundChanges {
    /// The numbers of these trials; those without a real change do not count.
    fn of(trials: &[&Trial]) -> Self {
        let changed = || trials.iter().filter_map(|t| Some((*t, t.change.as_ref()?)));
        let first: Vec<(&Trial, &RealChange, &Adoption)> = changed()
            .filter_map(|(t, change)| Some((t, change, t.adoptions.kept().find(|a| !a.is_before(change))?)))
            .collect();
        let rightly = |(trial, change, adoption): &(&Trial, &RealChange, &Adoption)| -> Option<bool> {
            if change.is_trim_shift() {
                // A derivative is called changed, or it is said that none is.
                return (trial.word.says_trim_shift || !adoption.changed.is_empty())
                    .then_some(trial.word.says_trim_shift);
            }
            adoption.changed.iter().find(|name| !is_constant(name)).map(|name| change.parameters.contains(name))
        };
        let dated = || first.iter().filter_map(|(_, change, adoption)| adoption.is_dated_rightly(change));
        let intervals = first.iter().filter_map(|(_, _, adoption)| adoption.interval_s);
        let count = |wanted: bool| first.iter().filter(|f| rightly(f) == Some(wanted)).count();
        let missed = || changed().filter(|(t, c)| t.adoptions.kept().all(|a| a.is_before(c)));
        Self {
            flights: changed().count(),
            found: first.len(),
            of_half: changed().filter(|(_, c)| c.is_of_half()).count(),
            of_half_found: first.iter().filter(|(_, c, _)| c.is_of_half()).count(),
            missed_unwarned: missed().filter(|(t, change)| t.is_silent_of(change)).count(),
            early: changed().filter(|(t, c)| t.adoptions.kept().any(|a| a.is_before(c))).count(),
            latency_median_s: quantile(first.iter().map(|(_, c, a)| a.time_s - c.time_s).collect(), 0.5),
            dated: dated().count(),
            dated_rightly: dated().filter(|rightly| *rightly).count(),
            interval_median_s: quantile(intervals.map(|[from_s, to_s]| to_s - from_s).collect(), 0.5),
            named_rightly: count(true),
            named_wrongly: count(false),
        }
    }
}

impl ChangeSummary {
    /// The numbers of the trials of one method, whatever their group. Flights with systematic errors do not count.
    pub fn of(method: Method, trials: &[&Trial]) -> Self {
        // A refused result has a history too, with the changes in it.
        let sound = || trials.iter().copied().filter(|t| t.kind == Kind::Sound);
        let healthy: Vec<&Trial> = sound().filter(|t| t.change.is_none()).collect();
        let with = |trim_shift: bool| -> Vec<&Trial> {
            sound().filter(|t| t.change.as_ref().is_some_and(|c| c.is_trim_shift() == trim_shift)).collect()
        };
        Self {
            method,
            healthy_flights: healthy.len(),
            healthy_hours: healthy.iter().map(|t| t.hours).sum(),
            false_adoptions: healthy.iter().map(|t| t.adoptions.adopted.len()).sum(),
            kept: healthy.iter().map(|t| t.adoptions.kept().count()).sum(),
            flights_with_kept: healthy.iter().filter(|t| t.adoptions.kept().count() > 0).count(),
            harmed: healthy.iter().filter(|t| t.adoptions.harmed()).count(),
            damages: FoundChanges::of(&with(false)),
            trim_shifts: FoundChanges::of(&with(true)),
        }
    }
}

/// What the health monitor said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WatchSummary {
    /// What the flights are: healthy, damaged, or shifted in trim.
    pub name: String,
    /// Flights that were watched.
    pub flights: usize,
    /// Their length together, h. An alarm ends the watch of a flight.
    pub hours: f64,
    /// False alarms: on healthy flights, or before the change.
    pub false_alarms: usize,
    /// False alarms per hour of flight, and the exact 95 % interval for a Poisson count.
    pub per_hour: f64,
    /// See `per_hour`.
    pub per_hour_interval: [f64; 2],
    /// Healthy flights that were called so at the end.
    pub called_healthy: usize,
    /// Flights whose change was not found.
    pub missed: usize,
    /// Found, with right names only.
    pub named_rightly: usize,
    /// Found, with a name of what did not change.
    pub named_wrongly: usize,
    /// Found, without a name.
    pub not_named: usize,
}

impl WatchSummary {
    /// The numbers of the trials that were watched.
    pub fn of(name: &str, trials: &[&Trial]) -> Self {
        let watched: Vec<_> = trials.iter().filter_map(|t| Some((*t, t.watched.as_ref()?))).collect();
        let count = |wanted: Alarm| watched.iter().filter(|(_, w)| w.alarm() == wanted).count();
        // Hours in which a false alarm could have come.
        let hours: f64 = watched
            .iter()
            .map(|(trial, w)| match (w.flagged_at_s, w.change_s) {
                (Some(a), Some(b)) => a.min(b) / 3600.0,
                (Some(a), None) | (None, Some(a)) => a / 3600.0,
                (None, None) => trial.hours,
            })
            .sum();
        let false_alarms = count(Alarm::False);
        Self {
            name: name.to_owned(),
            flights: watched.len(),
            hours,
            false_alarms,
            per_hour: false_alarms as f64 / hours,
            per_hour_interval: poisson(false_alarms).map(|n| n / hours),
            called_healthy: watched.iter().filter(|(_, w)| w.change_s.is_none() && w.called_healthy).count(),
            missed: count(Alarm::Missed),
            named_rightly: count(Alarm::NamedRightly),
            named_wrongly: count(Alarm::NamedWrongly),
            not_named: count(Alarm::NotNamed),
        }
    }
}

#[cfg(test)]
mod tests {
    use phugoid_identification::estimation::{ChangeOutcome, FinalStatus};

    use super::super::standing::Word;
    use super::super::trial::{Adoptions, Consistency};
    use super::super::watch::Watched;
    use super::*;

    fn trial(standing: EstimationStatus, parameters: Vec<Compared>) -> Trial {
        Trial {
            aircraft: "c182".to_owned(),
            flight: "one".to_owned(),
            group: "calm".to_owned(),
            axes: "longitudinal".to_owned(),
            kind: Kind::Sound,
            hours: 0.5,
            method: Method::Smpe,
            corruption: None,
            word: Word { standing, reasons: Vec::new(), remarks: Vec::new(), says_trim_shift: false },
            parameters,
            consistency: None,
            adoptions: Adoptions::default(),
            change: None,
            watched: None,
        }
    }

    /// An estimate of -1.0 that is off by so much, with one claimed sigma of 0.01.
    fn off_by(error: f64) -> Compared {
        Compared {
            name: "Cm_alpha".to_owned(),
            truth: -1.0,
            structure_std: 0.0,
            value: -1.0 + error,
            std_error: 0.01,
            systematic_std: 0.0,
            status: FinalStatus::Converged,
            is_taken_back: false,
        }
    }

    /// What an estimation makes of a derivative that its doubts concern.
    fn in_doubt(error: f64) -> Compared {
        Compared { status: FinalStatus::InDoubt, ..off_by(error) }
    }

    #[test]
    fn errors_are_counted_where_numbers_are_given_and_silence_where_no_warning_is() {
        let mut remarked = trial(EstimationStatus::Sound, vec![off_by(0.1), off_by(0.0)]);
        remarked.word.remarks.push("coloured".to_owned());
        let mut refused = trial(EstimationStatus::Refused, vec![in_doubt(5.0)]);
        refused.word.reasons.push("contradiction".to_owned());
        // A term is missing: one derivative is taken back for it, and the other stands.
        let bent = Compared { is_taken_back: true, ..in_doubt(7.0) };
        let trials = [
            trial(EstimationStatus::Sound, vec![off_by(0.015), off_by(0.03), off_by(f64::NAN)]),
            remarked,
            trial(EstimationStatus::Doubtful, vec![in_doubt(0.5)]),
            trial(EstimationStatus::Doubtful, vec![bent, off_by(0.01)]),
            refused,
        ];
        let all: Vec<&Trial> = trials.iter().collect();
        let s = GroupSummary::of("all", Kind::Sound, Method::Smpe, &all);
        assert_eq!((s.flights, s.refused, s.doubtful, s.derivatives), (5, 1, 2, 7));
        assert_eq!(s.reasons["contradiction"], 1);
        // Errors of what is given: 0, 0.01, 0.015, 0.03, 0.1, 0.5 and not finite.
        assert!((s.error_median - 0.03).abs() < 1e-12 && s.error_90_percent.is_infinite(), "{s:?}");
        assert!((s.coverage - 3.0 / 7.0).abs() < 1e-12, "{s:?}");
        // The doubtful flight has said so.
        assert!((s.claimed - 6.0 / 7.0).abs() < 1e-12, "{s:?}");
        assert!((s.silently_wrong - 2.0 / 7.0).abs() < 1e-12, "{s:?}");
        assert_eq!((s.flights_silently_wrong, s.of_those_remarked), (2, 1));
    }

    /// Claims of 0.01 with errors of half and twice that; an output that was locked out in one of three flights; a refused
    /// flight tells of its innovations and not of its errors.
    #[test]
    fn consistency_is_of_healthy_flights() {
        let with = |standing, innovation_squared, longest_rejected_s| {
            let most_rejected = "p".to_owned();
            let consistency = Some(Consistency { innovation_squared, longest_rejected_s, most_rejected });
            Trial { consistency, ..trial(standing, vec![off_by(0.005), off_by(0.01), off_by(0.02)]) }
        };
        let trials = [
            with(EstimationStatus::Sound, 1.0, 0.0),
            with(EstimationStatus::Sound, 1.2, 0.9),
            with(EstimationStatus::Refused, 3.0, 4.0),
            Trial { change: real(20.0, "Cm_q"), ..with(EstimationStatus::Sound, 9.0, 9.0) },
        ];
        let all: Vec<&Trial> = trials.iter().collect();
        let s = ConsistencySummary::of(Method::Smpe, &all);
        assert_eq!((s.flights, s.locked_out), (3, 1));
        assert!((s.innovation_squared - 1.2).abs() < 1e-12 && (s.longest_rejected_s - 4.0).abs() < 1e-12, "{s:?}");
        assert!((s.error_squared - 1.0 / 0.454_936).abs() < 1e-9, "{s:?}");
    }

    /// One sigma of 0.05, of which 0.03 are random and 0.04 declared: an error of 0.05 is within two of all, and within two of the random
    /// part; one of 0.08 is not within two of that; one of 0.11 within neither. What is uncertain of the truth counts.
    #[test]
    fn the_random_part_is_counted_by_itself() {
        let declared = |error: f64| Compared { std_error: 0.05, systematic_std: 0.04, ..off_by(error) };
        let loose = Compared { structure_std: 0.05, ..declared(0.08) };
        let given = vec![declared(0.05), declared(0.08), declared(0.11), loose];
        let trial = trial(EstimationStatus::Sound, given);
        let s = GroupSummary::of("all", Kind::Sound, Method::Smpe, &[&trial]);
        assert_eq!((s.coverage, s.coverage_random), (0.75, 0.5));
    }

    #[test]
    fn nothing_to_count_is_not_a_number() {
        let s = GroupSummary::of("all", Kind::Sound, Method::Smpe, &[]);
        assert!(
            s.error_median.is_nan() && s.coverage.is_nan() && s.coverage_random.is_nan() && s.silently_wrong.is_nan()
        );
    }

    fn real(time_s: f64, name: &str) -> Option<RealChange> {
        Some(RealChange {
            time_s,
            parameters: vec![name.to_owned()],
            size: if name.ends_with("_0") { 0.0 } else { 0.5 },
        })
    }

    /// A flight with adoptions at these times that call `changed` changed, the last of which becomes `outcome`.
    fn adopting(times: &[f64], changed: &[&str], outcome: ChangeOutcome, errors: Option<[f64; 2]>) -> Trial {
        let adopt = |(k, time_s): (usize, &f64)| Adoption {
            time_s: *time_s,
            // Dated to within two seconds, where it was looked for in the record.
            interval_s: (outcome == ChangeOutcome::FoundAfterwards).then_some([time_s - 2.0, time_s + 2.0]),
            outcome: if k + 1 == times.len() { outcome } else { ChangeOutcome::Confirmed },
            changed: changed.iter().map(|name| (*name).to_owned()).collect(),
        };
        let adopted = times.iter().enumerate().map(adopt).collect();
        let adoptions = Adoptions { adopted, error_before_and_after: errors };
        Trial { adoptions, ..trial(EstimationStatus::Sound, Vec::new()) }
    }

    #[test]
    fn adoptions_of_healthy_flights_are_false_and_harm_where_the_estimate_gets_worse() {
        use ChangeOutcome::{Confirmed, RolledBack};
        let trials = [
            adopting(&[], &[], Confirmed, None),
            adopting(&[3.0, 9.0], &["Cm_q"], RolledBack, Some([0.02, 0.4])),
            adopting(&[3.0], &["Cm_q"], RolledBack, Some([0.4, 0.02])),
            // Its systematic errors may well look like a change.
            Trial { kind: Kind::Faulty, ..adopting(&[4.0], &[], Confirmed, None) },
        ];
        let all: Vec<&Trial> = trials.iter().collect();
        let s = ChangeSummary::of(Method::Smpe, &all);
        assert_eq!((s.healthy_flights, s.healthy_hours), (3, 1.5));
        assert_eq!((s.false_adoptions, s.kept, s.flights_with_kept, s.harmed), (3, 1, 1, 1));
        assert_eq!((s.damages.flights, s.trim_shifts.flights), (0, 0));
    }

    #[test]
    fn changes_are_found_after_they_set_in_and_named_by_what_is_most_certain() {
        use ChangeOutcome::{Confirmed, RolledBack};
        let damaged = |times: &[f64], changed: &[&str], outcome| Trial {
            change: real(20.0, "Cm_q"),
            ..adopting(times, changed, outcome, None)
        };
        let small = real(20.0, "Cm_q").map(|change| RealChange { size: 0.25, ..change });
        let mut shifted = Trial { change: real(20.0, "Cm_0"), ..adopting(&[20.5], &["Cm_0"], Confirmed, None) };
        shifted.word.says_trim_shift = true;
        let trials = [
            // A constant moves with the derivative that it is correlated with.
            damaged(&[21.5], &["Cm_0", "Cm_q", "CL_alpha"], Confirmed),
            damaged(&[23.5], &["CL_alpha", "Cm_q"], Confirmed),
            damaged(&[22.5], &[], Confirmed),
            damaged(&[22.5], &["Cm_q"], RolledBack),
            Trial { change: small, ..damaged(&[5.0], &["Cm_q"], Confirmed) },
            shifted,
            Trial { change: real(20.0, "Cm_0"), ..adopting(&[20.5], &["Cm_q"], Confirmed, None) },
        ];
        let all: Vec<&Trial> = trials.iter().collect();
        let s = ChangeSummary::of(Method::Smpe, &all);
        let d = &s.damages;
        assert_eq!((d.flights, d.found, d.early), (5, 3, 1));
        assert_eq!((d.of_half, d.of_half_found, d.missed_unwarned), (4, 3, 2));
        assert_eq!((d.named_rightly, d.named_wrongly), (1, 1));
        assert!((d.latency_median_s - 2.5).abs() < 1e-12);
        let t = &s.trim_shifts;
        assert_eq!((t.flights, t.found, t.named_rightly, t.named_wrongly), (2, 2, 1, 1));
    }

    #[test]
    fn an_alarm_ends_the_hours_in_which_a_false_one_could_come() {
        let with = |flagged_at_s: Option<f64>, change_s: Option<f64>| {
            let changed = vec!["Cm_q".to_owned()];
            let named = flagged_at_s.map(|_| "Cm_q".to_owned()).into_iter().collect();
            let [promised, called_healthy] = [false; 2];
            let scatter = None;
            let watched =
                Watched { expected: 4, flagged_at_s, named, promised, scatter, called_healthy, changed, change_s };
            Trial { watched: Some(watched), ..trial(EstimationStatus::Sound, Vec::new()) }
        };
        let trials = [
            with(None, None),
            with(Some(900.0), None),
            with(Some(1800.0), Some(720.0)),
            with(None, Some(720.0)),
            // Not watched.
            trial(EstimationStatus::Sound, Vec::new()),
        ];
        let all: Vec<&Trial> = trials.iter().collect();
        let s = WatchSummary::of("all", &all);
        assert_eq!((s.flights, s.false_alarms, s.missed, s.named_rightly), (4, 1, 1, 1));
        // 0.5 h, 900 s, and twice 720 s.
        assert!((s.hours - (0.5 + 0.25 + 0.4)).abs() < 1e-12 && (s.per_hour - 1.0 / 1.15).abs() < 1e-12, "{s:?}");
        assert!((s.per_hour_interval[1] * 1.15 - 5.571_643).abs() < 1e-5);
    }
}
