//! Logs of an airframe of which no estimate can be used. An airframe of which all are refused has no course, and a sensor that is
//! mounted the wrong way makes exactly that.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::false_discovery::rates;
use crate::row::Row;

/// The logs of an airframe without an estimate that can be used.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Unused {
    /// Number of these logs.
    pub logs: usize,
    /// Number of all logs of the airframe.
    pub of: usize,
    /// Why, as words of the columns `reasons` and `refusal`, and in how many of these logs.
    pub reasons: BTreeMap<String, usize>,
    /// Rate of false discoveries at which it would just be a finding that this airframe has more of them than the others; none where
    /// it has not a single one, or is alone.
    pub rate: Option<f64>,
    /// Whether it is one.
    pub is_apart: bool,
}

impl Unused {
    /// Counts a log with its rows, of which an estimate is used or none.
    pub(super) fn count(&mut self, rows: &[&Row], is_used: bool) {
        self.of += 1;
        if is_used {
            return;
        }
        self.logs += 1;
        let words = rows.iter().flat_map(|row| {
            let reasons = row.reasons.as_deref().unwrap_or_default().split(',');
            reasons.chain(row.refusal.as_deref()).map(str::trim).filter(|word| !word.is_empty())
        });
        for word in words.collect::<BTreeSet<&str>>() {
            *self.reasons.entry(word.to_owned()).or_insert(0) += 1;
        }
    }

    /// The reasons with their numbers, the most frequent first: `sign 10, units 4`.
    pub fn words(&self) -> String {
        let mut reasons: Vec<(&String, &usize)> = self.reasons.iter().collect();
        reasons.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
        let words: Vec<String> = reasons.iter().map(|(word, count)| format!("{word} {count}")).collect();
        words.join(", ")
    }
}

/// Which airframes have more logs that cannot be used than the others, at a rate of false ones: if logs of that kind were spread over
/// the airframes at random, as many or more of them would belong to this one with the probability of the hypergeometric distribution
/// (Fisher's exact test, one-sided).
pub(super) fn judge_unused(of_airframes: &mut [&mut Unused], rate: f64) {
    let all: usize = of_airframes.iter().map(|own| own.of).sum();
    let unused: usize = of_airframes.iter().map(|own| own.logs).sum();
    let p_of = |own: &Unused| match own.logs > 0 && own.of < all {
        true => (own.logs..=own.of.min(unused)).map(|k| hypergeometric(k, own.of, unused, all)).sum::<f64>().min(1.0),
        false => f64::NAN,
    };
    let found = rates(&of_airframes.iter().map(|own| p_of(own)).collect::<Vec<f64>>());
    for (own, found) in of_airframes.iter_mut().zip(found) {
        own.rate = crate::row::finite(found);
        own.is_apart = found <= rate;
    }
}

/// Probability that of `drawn` out of `all`, of which `marked` are marked, exactly `k` are marked.
fn hypergeometric(k: usize, drawn: usize, marked: usize, all: usize) -> f64 {
    if k > marked || drawn - k > all - marked {
        return 0.0;
    }
    let factorial = |n: usize| libm::lgamma(n as f64 + 1.0);
    let choose = |n: usize, k: usize| factorial(n) - factorial(k) - factorial(n - k);
    (choose(marked, k) + choose(all - marked, drawn - k) - choose(all, drawn)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_those_of_drawing_without_putting_back() {
        // Of 10, of which 4 are marked, 3 are drawn: 20, 60, 36 and 4 of 120.
        for (k, ways) in [20.0, 60.0, 36.0, 4.0].into_iter().enumerate() {
            assert!((hypergeometric(k, 3, 4, 10) - ways / 120.0).abs() < 1e-12, "{k}");
        }
        assert_eq!(hypergeometric(3, 3, 2, 10), 0.0);
    }

    #[test]
    fn an_airframe_of_which_all_is_refused_is_found_and_a_log_here_and_there_is_not() {
        let apart = |logs: &[usize]| -> Vec<usize> {
            let mut all: Vec<Unused> = logs.iter().map(|k| Unused { logs: *k, of: 10, ..Unused::default() }).collect();
            judge_unused(&mut all.iter_mut().collect::<Vec<_>>(), 0.05);
            (0..logs.len()).filter(|k| all[*k].is_apart).collect()
        };
        assert_eq!(apart(&[1, 0, 0, 1, 0, 10, 0, 1]), [5]);
        // All alike, or alone: nobody is apart.
        assert!(apart(&[10; 5]).is_empty() && apart(&[10]).is_empty() && apart(&[0, 1, 0, 2]).is_empty());
    }

    #[test]
    fn the_reasons_of_a_log_count_once() {
        let row = |reasons: &str| Row { reasons: Some(reasons.to_owned()), ..Row::default() };
        let mut unused = Unused::default();
        unused.count(&[&row("sign, units"), &row("sign")], false);
        unused.count(&[&row("sign")], false);
        unused.count(&[&row("gaps")], true);
        assert_eq!((unused.logs, unused.of, unused.words().as_str()), (2, 3, "sign 2, units 1"));
    }
}
