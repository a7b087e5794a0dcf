//! From flights to scores.

use super::criteria::CYCLES;
use super::entry::Entry;
use super::result::{
    Checkpoint, Counted, Coverage, Detection, EntryResult, MethodResult, ParameterScore, Settled, Unit,
};
use super::trial::{Point, Track, Trial, judged};
use crate::statistics::{clopper_pearson, quantile};

/// Two claimed standard errors: what is promised in about 95 % of the cases.
const SIGMAS: f64 = 2.0;

/// The median of the absolute value of a standard normal variable.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// What the flights of one entry say.
pub(super) fn score(entry: &Entry, methods: &[String], flights: &[Trial]) -> EntryResult {
    let bounded = flights.iter().all(|f| f.bounded);
    let gusty = entry.scenario.turbulence.is_some() || !entry.scenario.gust.is_empty();
    let unit = match (bounded, gusty) {
        (false, _) => Unit::Prior,
        (true, true) => Unit::CalmCramerRao,
        (true, false) => Unit::CramerRao,
    };
    let mut results: Vec<MethodResult> =
        methods.iter().enumerate().map(|(m, name)| of_method(entry, name, m, flights, unit)).collect();
    let ours = results.first().map_or(f64::NAN, |r| r.microseconds);
    for result in &mut results {
        result.relative_time = result.microseconds / ours;
    }
    EntryResult {
        id: entry.id.clone(),
        title: entry.title.clone(),
        shows: entry.shows.clone(),
        flights: flights.len(),
        duration_s: entry.scenario.duration.si(),
        cycle_s: entry.cycle_s,
        counted_from_s: quantile(flights.iter().map(|f| f.from_s).collect(), 0.5),
        damaged: !entry.scenario.damage.is_empty(),
        silent: entry.errors.is_some(),
        unit,
        methods: results,
    }
}

fn of_method(entry: &Entry, name: &str, method: usize, flights: &[Trial], unit: Unit) -> MethodResult {
    let results: Vec<(&Trial, &Result<Track, String>)> =
        flights.iter().filter_map(|f| Some((f, f.tracks.get(method)?))).collect();
    let tracks: Vec<(&Trial, &Track)> =
        results.iter().filter_map(|(flight, track)| Some((*flight, track.as_ref().ok()?))).collect();
    let names = judged(&entry.model);
    let prior: Vec<f64> = entry.model.estimated().filter(|p| !p.is_nuisance()).map(|p| p.prior_std).collect();
    let checkpoints = CYCLES
        .iter()
        .enumerate()
        .map(|(c, cycles)| {
            let units = |flight: &Trial| if unit == Unit::Prior { prior.clone() } else { flight.unit[c].clone() };
            let rows: Vec<(Vec<f64>, &[Point])> =
                tracks.iter().map(|(flight, track)| (units(flight), track.points[c].as_slice())).collect();
            let mut checkpoint = checkpoint(*cycles, cycles * entry.cycle_s, &names, &rows);
            if entry.errors.is_some() {
                let undeclared: Vec<&[Point]> =
                    tracks.iter().filter_map(|(_, track)| track.undeclared.get(c).map(Vec::as_slice)).collect();
                checkpoint.undeclared_coverage = together(&undeclared);
                checkpoint.undeclared_over_actual = claimed_over_actual(&undeclared);
            }
            checkpoint
        })
        .collect();
    let settled: Vec<Settled> = names
        .iter()
        .enumerate()
        .map(|(j, name)| {
            let times: Vec<f64> = tracks.iter().map(|(_, t)| t.settled_s[j]).collect();
            let never = times.iter().filter(|t| t.is_infinite()).count();
            Settled { name: (*name).to_owned(), median_s: known(quantile(times, 0.5)), never }
        })
        .collect();
    let slowest = tracks.iter().map(|(_, t)| t.settled_s.iter().copied().fold(0.0, f64::max)).collect();
    let settled_median_s =
        settled.iter().all(|s| s.median_s.is_some()).then(|| known(quantile(slowest, 0.5))).flatten();
    let unclaimed = |track: &Track| track.points.iter().flatten().any(|p| !claims(p));
    MethodResult {
        method: name.to_owned(),
        failed: results.len() - tracks.len(),
        failure: results.iter().find_map(|(_, track)| track.as_ref().err().cloned()),
        without_bounds: tracks.iter().filter(|(_, t)| unclaimed(t)).count(),
        checkpoints,
        settled,
        settled_median_s,
        detection: detection(entry, &tracks),
        microseconds: quantile(tracks.iter().map(|(_, t)| t.microseconds).collect(), 0.5),
        relative_time: f64::NAN,
    }
}

fn known(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Whether a method says how wrong it may be.
fn claims(point: &Point) -> bool {
    point.std_error.is_finite() && point.std_error > 0.0
}

fn covered(point: &Point) -> bool {
    (point.value - point.truth).abs() <= SIGMAS * point.std_error
}

/// `rows` are the flights: units and points by parameter.
fn checkpoint(cycles: f64, after_s: f64, names: &[&str], rows: &[(Vec<f64>, &[Point])]) -> Checkpoint {
    let parameters: Vec<ParameterScore> = names
        .iter()
        .enumerate()
        .map(|(j, name)| {
            let mean = |f: &dyn Fn(f64, &Point) -> f64| {
                rows.iter().map(|(units, points)| f(units[j], &points[j])).sum::<f64>() / rows.len() as f64
            };
            let relative = rows.iter().map(|(units, points)| ((points[j].value - points[j].truth) / units[j]).abs());
            let all_claim = rows.iter().all(|(_, points)| claims(&points[j]));
            let inside = rows.iter().filter(|(_, points)| covered(&points[j])).count();
            ParameterScore {
                name: (*name).to_owned(),
                bias: mean(&|_, p| p.value - p.truth),
                rmse: mean(&|_, p| (p.value - p.truth).powi(2)).sqrt(),
                rmse_over_unit: mean(&|unit, p| ((p.value - p.truth) / unit).powi(2)).sqrt(),
                median_over_unit: quantile(relative.collect(), 0.5) / NORMAL_MEDIAN,
                claimed: mean(&|_, p| p.std_error * p.std_error).sqrt(),
                coverage: (all_claim && !rows.is_empty()).then(|| Coverage {
                    fraction: inside as f64 / rows.len() as f64,
                    interval: clopper_pearson(inside, rows.len()),
                }),
            }
        })
        .collect();
    let points: Vec<&[Point]> = rows.iter().map(|(_, points)| *points).collect();
    let logarithms: f64 = parameters.iter().map(|p| p.rmse_over_unit.ln()).sum();
    Checkpoint {
        cycles,
        after_s,
        accuracy: known((logarithms / parameters.len().max(1) as f64).exp()).filter(|_| !rows.is_empty()),
        coverage: together(&points),
        claimed_over_actual: claimed_over_actual(&points),
        undeclared_coverage: None,
        undeclared_over_actual: None,
        parameters,
    }
}

/// Root mean square claim over root mean square error, geometric mean over the parameters; none where a bound is not claimed.
fn claimed_over_actual(rows: &[&[Point]]) -> Option<f64> {
    let count = rows.first().map_or(0, |points| points.len());
    if count == 0 || !rows.iter().all(|points| points.iter().all(claims)) {
        return None;
    }
    let sum = |j: usize, f: &dyn Fn(&Point) -> f64| rows.iter().map(|points| f(&points[j]).powi(2)).sum::<f64>();
    let ratio = |j: usize| sum(j, &|p| p.std_error) / sum(j, &|p| p.value - p.truth);
    known(((0..count).map(|j| ratio(j).ln()).sum::<f64>() / (2 * count) as f64).exp())
}

/// Coverage of all parameters of all flights; none where a bound is not claimed.
fn together(rows: &[&[Point]]) -> Option<Coverage> {
    let flights = rows.len();
    let per_flight = rows.first().map_or(0, |points| points.len());
    if flights == 0 || per_flight == 0 || !rows.iter().all(|points| points.iter().all(claims)) {
        return None;
    }
    let parts: Vec<f64> =
        rows.iter().map(|points| points.iter().filter(|p| covered(p)).count() as f64 / per_flight as f64).collect();
    let fraction = parts.iter().sum::<f64>() / flights as f64;
    // Errors of one flight go together. As many independent cases as give the variance that the flights show, at least one
    // per flight.
    let spread = parts.iter().map(|p| (p - fraction).powi(2)).sum::<f64>() / (flights.max(2) - 1) as f64;
    let variance_of_mean = spread / flights as f64;
    let independent = if variance_of_mean > 0.0 { fraction * (1.0 - fraction) / variance_of_mean } else { 0.0 };
    let cases = independent.clamp(flights as f64, (flights * per_flight) as f64).round();
    let inside = (fraction * cases).round() as usize;
    Some(Coverage { fraction, interval: clopper_pearson(inside, cases as usize) })
}

fn detection(entry: &Entry, tracks: &[(&Trial, &Track)]) -> Detection {
    let damage = entry.scenario.damage.last();
    let at = damage.map_or(f64::INFINITY, |d| d.at.si());
    let after = |times: &[f64]| times.iter().copied().find(|t| *t >= at).map_or(f64::INFINITY, |t| t - at);
    let latencies: Vec<f64> = tracks.iter().map(|(_, t)| after(&t.changes_s)).collect();
    let doubts: Vec<f64> = tracks.iter().map(|(_, t)| after(&t.doubts_s).min(after(&t.changes_s))).collect();
    let early = |t: &Track| t.changes_s.iter().filter(|time| **time < at).count();
    let late = |t: &Track| t.changes_s.iter().filter(|time| **time >= at).count();
    let false_alarms: usize = tracks.iter().map(|(_, t)| early(t)).sum();
    let watched_s = tracks.len() as f64 * at.min(entry.scenario.duration.si());
    Detection {
        damaged: if damage.is_some() { tracks.len() } else { 0 },
        found: if damage.is_some() { latencies.iter().filter(|l| l.is_finite()).count() } else { 0 },
        latency_median_s: known(quantile(latencies, 0.5)),
        doubt_median_s: known(quantile(doubts, 0.5)),
        false_alarms: Counted {
            count: false_alarms,
            per_ten_minutes: if watched_s > 0.0 { false_alarms as f64 * 600.0 / watched_s } else { 0.0 },
        },
        further: tracks.iter().map(|(_, t)| late(t).saturating_sub(1)).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(error: f64, std_error: f64) -> Point {
        Point { truth: 1.0, value: 1.0 + error, std_error }
    }

    #[test]
    fn errors_are_told_in_the_unit_of_their_flight() {
        let (a, b) = ([point(0.1, 0.1), point(-0.3, 0.1)], [point(-0.4, 0.1), point(0.3, 0.2)]);
        let rows = [(vec![0.1, 0.3], a.as_slice()), (vec![0.2, 0.1], b.as_slice())];
        let c = checkpoint(1.0, 4.0, &["x", "y"], &rows);
        let x = &c.parameters[0];
        assert!((x.bias + 0.15).abs() < 1e-12 && (x.rmse - (0.085_f64).sqrt()).abs() < 1e-12);
        assert!((x.rmse_over_unit - 2.5_f64.sqrt()).abs() < 1e-12, "1 and -2 units");
        assert!((c.parameters[1].rmse_over_unit - 5.0_f64.sqrt()).abs() < 1e-12, "-1 and 3 units");
        assert!((c.accuracy.unwrap() - 12.5_f64.powf(0.25)).abs() < 1e-12);
        assert_eq!((x.coverage.unwrap().fraction, c.coverage.unwrap().fraction), (0.5, 0.5));
        let silent = [point(0.1, f64::NAN), point(0.1, 0.1)];
        let c = checkpoint(1.0, 4.0, &["x", "y"], &[(vec![0.1, 0.1], silent.as_slice())]);
        assert!(c.coverage.is_none() && c.parameters[0].coverage.is_none() && c.parameters[1].coverage.is_some());
        assert!(checkpoint(1.0, 4.0, &["x"], &[]).accuracy.is_none());
        // Errors of 0.1 and 0.3, claims of 0.1 and 0.1: root mean squares of 0.1 over that of 0.05.
        let claimed = claimed_over_actual(&[&[point(0.1, 0.1)], &[point(-0.3, 0.1)]]).unwrap();
        assert!((claimed - (0.01_f64 / 0.05).sqrt()).abs() < 1e-12, "{claimed}");
        assert!(claimed_over_actual(&[&silent]).is_none() && claimed_over_actual(&[]).is_none());
    }

    /// Flights in which all parameters are covered together or none of them are worth one case each.
    #[test]
    fn parameters_that_fail_together_are_one_case() {
        let (good, bad) = (vec![point(0.0, 1.0); 4], vec![point(9.0, 1.0); 4]);
        let rows: Vec<&[Point]> = (0..40).map(|k| if k % 4 == 0 { bad.as_slice() } else { good.as_slice() }).collect();
        let together = together(&rows).unwrap();
        assert_eq!(together.fraction, 0.75);
        let [low, high] = together.interval;
        let [l, h] = clopper_pearson(30, 40);
        assert!((low - l).abs() < 0.01 && (high - h).abs() < 0.01, "{low} {high}, {l} {h}");
    }
}
