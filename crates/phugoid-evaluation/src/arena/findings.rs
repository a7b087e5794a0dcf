//! Says in sentences where each method is better or worse than the others, from the numbers alone.

use serde::Serialize;

use super::result::{EntryResult, MethodResult};

/// Accuracies within this part of the best one count as equal to it.
const TIE: f64 = 0.05;

/// With fewer flights of a scenario nothing is said for the bounds of a method: not even a coverage of 80 % would show.
const ENOUGH_FLIGHTS: usize = 20;

/// Coverage, in promise 95 %, below which bounds are not to be trusted.
const LEAST_COVERAGE: f64 = 0.9;

/// A method is sooner than another one if its time is shorter by this part and by this long, s.
const SOONER: (f64, f64) = (0.1, 0.1);

/// What the numbers say, in words.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Findings {
    /// The rule, in a sentence, by which a method counts as best.
    pub rule: String,
    /// One per entry: who is best.
    pub best: Vec<Best>,
    /// One sentence per method: where it is best, where it fails.
    pub methods: Vec<String>,
    /// One sentence per entry in which the first method is beaten or fails.
    pub ours_loses: Vec<String>,
}

/// Who is best in one entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Best {
    /// Name of the entry ([`EntryResult::id`]).
    pub entry: String,
    /// The most accurate method whose bounds can be trusted, and those within 5 % of it, best first; empty if there is none.
    pub methods: Vec<String>,
}

impl Findings {
    pub(super) fn of(methods: &[String], entries: &[EntryResult]) -> Self {
        let best: Vec<Best> =
            entries.iter().map(|entry| Best { entry: entry.id.clone(), methods: leaders(entry) }).collect();
        let flights = entries.iter().map(|entry| entry.flights).min().unwrap_or(0);
        let rule = format!(
            "Best is the smallest error after the last checkpoint (geometric mean over the parameters of root mean square \
             error over the bound), among methods that failed in no flight, claim bounds, and whose coverage after the first \
             cycle is not significantly below {:.0} %; errors within {:.0} % of it count as equal. A root mean square of {flights} \
             errors is itself uncertain by {:.0} %.{}",
            100.0 * LEAST_COVERAGE,
            100.0 * TIE,
            // One standard error, of Gaussian errors.
            100.0 / (2.0 * flights.max(1) as f64).sqrt(),
            if flights < ENOUGH_FLIGHTS { " With so few flights all of this is a first look." } else { "" }
        );
        Self {
            rule,
            methods: methods.iter().enumerate().map(|(m, name)| of_method(m, name, entries, &best)).collect(),
            ours_loses: entries.iter().filter_map(ours_loses).collect(),
            best,
        }
    }

    /// What is to be said where the first method is beaten in no entry: of so many flights in each.
    pub fn loses_nowhere(flights: usize) -> String {
        if flights < ENOUGH_FLIGHTS {
            format!("nothing shows in {flights} flights of each scenario, which are too few to tell")
        } else {
            format!("nowhere, as far as {flights} flights of each scenario can tell")
        }
    }
}

/// The last error of a method; none where every flight failed.
fn accuracy(result: &MethodResult) -> Option<f64> {
    result.checkpoints.last().and_then(|c| c.accuracy)
}

/// Why the bounds of a method are not to be trusted; none if they are.
pub(super) fn distrust(result: &MethodResult, flights: usize) -> Option<String> {
    if result.failed > 0 {
        return Some(format!("fails in {} of {flights} flights", result.failed));
    }
    if result.without_bounds > 0 {
        return Some("claims no bounds".to_owned());
    }
    let low = result.checkpoints.iter().filter(|c| c.cycles > 1.0).filter_map(|c| Some((c.cycles, c.coverage?)));
    let worst =
        low.filter(|(_, c)| c.interval[1] < LEAST_COVERAGE).min_by(|a, b| a.1.fraction.total_cmp(&b.1.fraction));
    worst.map(|(cycles, c)| format!("its bounds cover {:.0} % after {cycles} cycles", 100.0 * c.fraction))
}

fn leaders(entry: &EntryResult) -> Vec<String> {
    let mut able: Vec<(f64, &str)> = entry
        .methods
        .iter()
        .filter(|m| distrust(m, entry.flights).is_none())
        .filter_map(|m| Some((accuracy(m)?, m.method.as_str())))
        .collect();
    // Stable: equal errors stay in the order of the methods.
    able.sort_by(|a, b| a.0.total_cmp(&b.0));
    let limit = able.first().map_or(f64::NAN, |(best, _)| best * (1.0 + TIE));
    able.iter().filter(|(error, _)| *error <= limit).map(|(_, name)| (*name).to_owned()).collect()
}

fn of_method(m: usize, name: &str, entries: &[EntryResult], best: &[Best]) -> String {
    let among = |best: &&Best| best.methods.iter().any(|n| n == name);
    let wins: Vec<&str> = best.iter().filter(among).map(|b| b.entry.as_str()).collect();
    let alone = best.iter().filter(|b| b.methods.len() == 1).filter(among).count();
    let distrusted: Vec<String> = entries
        .iter()
        .filter_map(|entry| {
            let why = distrust(entry.methods.get(m)?, entry.flights)?;
            Some(format!("{} ({why})", entry.id))
        })
        .collect();
    let flights = entries.iter().map(|entry| entry.flights).min().unwrap_or(0);
    let mut sentence = match wins.as_slice() {
        [] => format!("`{name}`: best in none of {} scenarios ({flights} flights each)", entries.len()),
        wins => {
            let alone = if alone > 0 { format!(", alone in {alone}") } else { String::new() };
            format!(
                "`{name}`: best or equal in {} of {} scenarios ({flights} flights each){alone}: {}",
                wins.len(),
                entries.len(),
                wins.join(", ")
            )
        }
    };
    if entries.iter().any(|entry| entry.methods.get(m).is_some_and(|result| result.without_bounds > 0)) {
        // It does so everywhere but where it has not begun.
        sentence.push_str("; claims no bounds, and cannot win.");
    } else if distrusted.is_empty() {
        sentence.push_str(&if flights < ENOUGH_FLIGHTS {
            format!("; nothing speaks against its bounds in {flights} flights, which are too few to trust them on.")
        } else {
            format!("; its bounds hold in all, as far as {flights} flights of each can tell.")
        });
    } else {
        sentence.push_str(&format!("; not to be trusted in {}: {}.", distrusted.len(), distrusted.join(", ")));
    }
    sentence
}

/// What the first method does worse than another one in an entry; none if nothing.
fn ours_loses(entry: &EntryResult) -> Option<String> {
    let (ours, others) = entry.methods.split_first()?;
    let mut losses = Vec::new();
    if let Some(why) = distrust(ours, entry.flights) {
        losses.push(why);
    }
    let sound = |m: &&MethodResult| distrust(m, entry.flights).is_none();
    let smallest = |candidates: &mut dyn Iterator<Item = &MethodResult>,
                    value: &dyn Fn(&MethodResult) -> Option<f64>| {
        candidates.filter_map(|m| Some((value(m)?, m.method.clone()))).min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mine = accuracy(ours).unwrap_or(f64::INFINITY);
    let better = |rival: &(f64, String)| rival.0 * (1.0 + TIE) < mine;
    let told = |(error, name): (f64, String)| {
        format!("`{name}` is more accurate ({} against {})", number(error), number(mine))
    };
    let trusted = smallest(&mut others.iter().filter(sound), &accuracy).filter(better);
    let any = smallest(&mut others.iter(), &accuracy).filter(better);
    match (trusted, any) {
        (Some(rival), _) => losses.push(told(rival)),
        (None, Some(rival)) => losses.push(format!("{}, without bounds to be trusted", told(rival))),
        (None, None) => {}
    }
    let sooner = |rival: Option<(f64, String)>, mine: Option<f64>, what: &str| {
        let (time, name) = rival?;
        let mine = mine.unwrap_or(f64::INFINITY);
        let is = time < (1.0 - SOONER.0) * mine && time + SOONER.1 <= mine;
        let ours = if mine.is_finite() { format!("{mine:.2} s") } else { "never".to_owned() };
        is.then(|| format!("`{name}` {what} sooner ({time:.2} s against {ours})"))
    };
    let settled = smallest(&mut others.iter(), &|m| m.settled_median_s);
    losses.extend(sooner(settled, ours.settled_median_s, "is within 5 %"));
    if entry.damaged {
        let careful = |m: &&MethodResult| {
            m.detection.false_alarms.count <= ours.detection.false_alarms.count
                && m.detection.found >= ours.detection.found
        };
        let found = smallest(&mut others.iter().filter(careful), &|m| m.detection.latency_median_s);
        losses.extend(sooner(found, ours.detection.latency_median_s, "adopts the change"));
        if let Some(rival) =
            others.iter().filter(|m| m.detection.found > ours.detection.found).max_by_key(|m| m.detection.found)
        {
            let (theirs, mine) = (rival.detection.found, ours.detection.found);
            losses.push(format!("`{}` finds the change in {theirs} flights instead of {mine}", rival.method));
        }
    }
    // A method that looks for changes and cries less often; one that cannot cry is no rival.
    let looking =
        |m: &&MethodResult| m.detection.found > 0 && m.detection.false_alarms.count < ours.detection.false_alarms.count;
    if let Some(rival) = others.iter().filter(looking).min_by_key(|m| m.detection.false_alarms.count) {
        let (theirs, mine) = (rival.detection.false_alarms.count, ours.detection.false_alarms.count);
        losses.push(format!("`{}` has {theirs} false alarms instead of {mine}", rival.method));
    }
    (!losses.is_empty()).then(|| format!("{}: {}.", entry.id, losses.join("; ")))
}

/// Three digits, without an exponent where that stays readable.
fn number(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 1000.0 => format!("{v:.0}"),
        v => format!("{v:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::result::Unit;
    use super::*;

    /// Three flights in which nothing went wrong are no reason to trust a method.
    #[test]
    fn few_flights_are_said_to_be_few_and_nothing_is_trusted_on_them() {
        let of = |flights: usize| {
            let entry = EntryResult {
                id: "calm".into(),
                title: String::new(),
                shows: String::new(),
                flights,
                duration_s: 20.0,
                cycle_s: 4.0,
                counted_from_s: 0.0,
                damaged: false,
                silent: false,
                unit: Unit::CramerRao,
                methods: Vec::new(),
            };
            let findings = Findings::of(&["smpe".to_owned()], &[entry]);
            (findings.methods.concat(), findings.rule, Findings::loses_nowhere(flights))
        };
        let (sentence, rule, nowhere) = of(3);
        assert!(sentence.contains("3 flights, which are too few to trust them on"), "{sentence}");
        assert!(rule.contains("uncertain by 41 %") && rule.contains("a first look"), "{rule}");
        assert!(!nowhere.contains("nowhere") && nowhere.contains("3 flights"), "{nowhere}");
        let (sentence, rule, nowhere) = of(200);
        assert!(sentence.contains("hold in all, as far as 200 flights of each can tell"), "{sentence}");
        assert!(rule.contains("uncertain by 5 %") && !rule.contains("first look"), "{rule}");
        assert!(nowhere.contains("nowhere, as far as 200 flights"), "{nowhere}");
        for text in [of(3).0, of(200).0] {
            assert!(!text.contains("can be trusted"), "{text}");
        }
    }
}
