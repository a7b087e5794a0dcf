//! What a parameter was and is: before and after each adopted change, and by another method.

use std::fmt::Write as _;

use phugoid_identification::estimate::Opens;
use phugoid_identification::estimation::{AdoptedChange, ChangeOutcome, Estimation, SecondAnswer};

use super::page::{END_OF_TABLE, table};
use super::tables::number_cells;
use crate::escape::escape;
use crate::figures::unit_of;
use crate::ticks::{fixed, significant};

/// A value and its error of one sigma, in the unit that is shown.
#[derive(Clone, Copy)]
struct Known {
    value: f64,
    sigma: f64,
}

impl Known {
    fn ends(self) -> [f64; 2] {
        [self.value - 2.0 * self.sigma, self.value + 2.0 * self.sigma]
    }

    fn cells(self) -> [String; 2] {
        [significant(self.value, 4), significant(2.0 * self.sigma, 3)]
    }
}

/// The adopted changes with the parameters before and after; empty where nothing was adopted.
pub(super) fn changes(estimation: &Estimation) -> String {
    estimation.changes.iter().filter(|change| !change.parameters.is_empty()).map(|c| one(estimation, c)).collect()
}

fn one(estimation: &Estimation, change: &AdoptedChange) -> String {
    let outcome = match change.outcome {
        ChangeOutcome::OnProbation => "Not yet confirmed: the estimate from before it still runs as a rival",
        ChangeOutcome::Confirmed => "Confirmed: the estimate after it has predicted better",
        ChangeOutcome::FoundAfterwards => "Found when the whole record was looked at again, not in flight",
        ChangeOutcome::RolledBack => "Taken back: the estimate from before it has predicted better",
        ChangeOutcome::WithdrawnAfterwards => {
            "Taken back when the whole record was looked at again: the record is not predicted better with it"
        }
        ChangeOutcome::ExplainedByTerm => {
            "No change of the aircraft: with the term that the model lacks there is none, and the record is predicted better"
        }
    };
    // What is none did not happen at any time.
    let when = change.interval_s.filter(|_| change.outcome.stands()).map_or_else(String::new, |[from_s, to_s]| {
        format!(" It happened between {} and {} s.", fixed(from_s, 1), fixed(to_s, 1))
    });
    let what = match change.opens {
        Opens::Constants if change.outcome.stands() => {
            " The constants alone explain it: a constant force or moment (a trim shift) set in, the derivatives stay. The errors \
             of a constant before and after are mostly those of the derivatives, which both share."
        }
        Opens::Everything | Opens::Constants => "",
    };
    let mut rows: Vec<_> = change.parameters.iter().collect();
    rows.sort_by(|a, b| b.sigmas().abs().total_cmp(&a.sigmas().abs()));
    let mut out = format!(
        "<h3>At {} s</h3>\n<p>{outcome}.{when}{what}</p>\n{}",
        significant(change.time_s, 4),
        table(&[
            ("", "Parameter"),
            ("", "Unit"),
            ("n", "Before"),
            ("n", "± 2σ"),
            ("n", "After"),
            ("n", "± 2σ"),
            ("n", "Change"),
            ("n", "± 2σ"),
            ("n", "Moved by<br>(σ)"),
            ("", "Before (grey), after (blue)"),
        ])
    );
    for p in rows {
        let unit = unit_of(estimation, &p.name);
        let known = |value: f64, sigma: f64| Known { value: value * unit.factor, sigma: sigma * unit.factor };
        let (before, after) = (known(p.before, p.before_std), known(p.after, p.after_std));
        let [[a, b], [c, d], [e, f]] =
            [before, after, known(p.after - p.before, p.difference_std)].map(|known| known.cells());
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td>{}<td>{}</td></tr>",
            escape(&p.name),
            escape(&unit.text),
            number_cells(&[a, b, c, d, e, f, signed(p.sigmas())]),
            intervals(&[("muted", before), ("blue", after)])
        );
    }
    out.push_str(END_OF_TABLE);
    out
}

/// The parameters by this method and by those that stand beside it; empty where there is none.
pub(super) fn methods(estimation: &Estimation) -> String {
    let mut out: String = estimation
        .second_answer
        .iter()
        .chain(&estimation.third_answer)
        .map(|other| beside(estimation, other))
        .collect();
    if !out.is_empty() {
        out.push_str(
            "<p class=\"note\">Methods with different assumptions on the same record. Bounds without what the model file \
             declares, which all share. Answers that are many σ apart say that an assumption of one of them does not hold: \
             noise in the measurements of the flow angles, turbulence, a term that the model lacks, a change in flight.</p>\n",
        );
    }
    out
}

/// The parameters by this method and by another one; empty where they have none in common.
fn beside(estimation: &Estimation, other: &SecondAnswer) -> String {
    let pairs: Vec<_> = estimation
        .parameters
        .iter()
        .filter_map(|p| Some((p, other.values.iter().find(|value| value.name == p.name)?)))
        .collect();
    if pairs.is_empty() {
        return String::new();
    }
    let (this, that) = (estimation.method.name(), other.method.name());
    let both = format!("{this} (blue), {that} (orange)");
    let mut out = table(&[
        ("", "Parameter"),
        ("", "Unit"),
        ("n", this),
        ("n", "± 2σ"),
        ("n", that),
        ("n", "± 2σ"),
        ("n", "Apart by<br>(σ)"),
        ("", both.as_str()),
    ]);
    for (p, value) in pairs {
        let unit = unit_of(estimation, &p.name);
        let own = Known { value: p.value * unit.factor, sigma: p.random_std() * unit.factor };
        let second = Known { value: value.value * unit.factor, sigma: value.std_error * unit.factor };
        let sigma = own.sigma.hypot(second.sigma);
        let apart = if sigma > 0.0 { (own.value - second.value) / sigma } else { f64::NAN };
        let [[a, b], [c, d]] = [own.cells(), second.cells()];
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td>{}<td>{}</td></tr>",
            escape(&p.name),
            escape(&unit.text),
            number_cells(&[a, b, c, d, signed(apart)]),
            intervals(&[("blue", own), ("orange", second)])
        );
    }
    out.push_str(END_OF_TABLE);
    out
}

/// A number of sigmas with its sign; a dash where there is none.
fn signed(sigmas: f64) -> String {
    if !sigmas.is_finite() {
        return "–".to_owned();
    }
    format!("{}{}", if sigmas >= 0.0 { "+" } else { "" }, fixed(sigmas, 1))
}

/// Intervals of two sigmas on one scale, a dot at each value: a picture beside the numbers, which say the same. Empty where a
/// number is not finite.
fn intervals(all: &[(&str, Known)]) -> String {
    const WIDTH: f64 = 1600.0;
    const MARGIN: f64 = 60.0;
    let ends = || all.iter().flat_map(|(_, known)| known.ends());
    let (low, high) = (ends().fold(f64::INFINITY, f64::min), ends().fold(f64::NEG_INFINITY, f64::max));
    if !ends().all(f64::is_finite) || high <= low {
        return String::new();
    }
    let at = |value: f64| MARGIN + (WIDTH - 2.0 * MARGIN) * (value - low) / (high - low);
    let mut out =
        "<svg class=\"intervals\" viewBox=\"0 0 1600 220\" aria-hidden=\"true\" stroke-linecap=\"round\">".to_owned();
    for (row, (colour, known)) in all.iter().enumerate() {
        let y = 65 + 90 * row;
        let [from, to] = known.ends().map(at);
        let _ = write!(
            out,
            "<path stroke=\"var(--{colour})\" stroke-width=\"26\" stroke-opacity=\"0.55\" d=\"M{from:.0} {y}H{to:.0}\"/>\
             <path stroke=\"var(--{colour})\" stroke-width=\"70\" d=\"M{:.0} {y}h0\"/>",
            at(known.value)
        );
    }
    out.push_str("</svg>");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_stand_on_one_scale() {
        let known = |value, sigma| Known { value, sigma };
        let drawn = intervals(&[("muted", known(0.0, 0.5)), ("blue", known(3.0, 0.5))]);
        // From -1 to 4: the first from the left margin to two fifths, the second from three fifths to the right margin.
        assert!(drawn.contains("d=\"M60 65H652\"") && drawn.contains("d=\"M948 155H1540\""), "{drawn}");
        assert_eq!(intervals(&[("blue", known(f64::NAN, 1.0))]), "");
        assert_eq!(intervals(&[("blue", known(1.0, 0.0))]), "");
        assert_eq!(signed(f64::NAN), "–");
        assert_eq!(signed(-1.26), "−1.3");
    }
}
