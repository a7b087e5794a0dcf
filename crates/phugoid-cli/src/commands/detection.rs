//! `phugoid study detection`.

use std::fmt::Write as _;

use phugoid_evaluation::detection::{Air, DetectionStudy, Stick, detection, detection_flights};

use super::study::with_ledger;
use crate::arguments;
use crate::failure::Failure;
use crate::output::Table;

/// First seed. The detector was made with others (700,000, 900,000, 920,000, 5,000,000 and 7,000,000 and what follows
/// them).
const SEED: u64 = 8_000_000;

pub(super) fn detected(arguments: &arguments::Study) -> Result<DetectionStudy, Failure> {
    let runs = arguments.runs as usize;
    let flights = u32::try_from(detection_flights(runs)).unwrap_or(u32::MAX);
    with_ledger(arguments, flights, &[], |ledger| detection(runs, SEED, ledger))
}

fn seconds(s: f64) -> String {
    if s.is_finite() { format!("{s:.2}") } else { "never".to_owned() }
}

fn pair(values: [f64; 2]) -> String {
    values.map(seconds).join(" / ")
}

fn air_word(air: Air) -> &'static str {
    match air {
        Air::Calm => "calm",
        Air::Everything => "everything",
    }
}

pub(super) fn detection_text(study: &DetectionStudy) -> String {
    let mut text = format!("Damage: {} flights per line, seeds from {}\n\n", study.runs, study.seed);
    let mut table = Table::new(&[
        "air",
        "stick",
        "damage",
        "informed",
        "doubt",
        "adopted",
        "missed",
        "false before",
        "further",
        "+1 s",
        "+2 s",
        "+4.2 s",
        "+10 s",
        "coverage +2 +10 s",
    ]);
    for line in &study.damage {
        let mut row = vec![
            air_word(line.air).to_owned(),
            if line.stick == Stick::Pilot { "pilot" } else { "3-2-1-1" }.to_owned(),
            format!("{:.0} s", line.damage_at_s),
            pair(line.informed_s),
            pair(line.doubt_s),
            pair(line.adoption_s),
            line.missed.to_string(),
            line.false_before.to_string(),
            line.extra.to_string(),
        ];
        row.extend(line.recovery.iter().map(|r| format!("{:.2} / {:.2}", r.median_over_oracle, r.ninety_over_oracle)));
        let coverage = |i: usize| line.recovery.get(i).map_or(f64::NAN, |r| 100.0 * r.coverage);
        row.push(format!("{:.0} {:.0} %", coverage(1), coverage(3)));
        table.row(row);
    }
    text.push_str(&table.render());
    text.push_str(
        "\nTimes after the damage in s, median / nine of ten. Informed: an observer who knows the damage and decides only whether it has\n\
         happened. +1 s ...: error over that of the same estimator told of the damage at its instant, median / 90 %.\n",
    );
    let _ = writeln!(text, "\nNo damage: {} min per line\n", study.runs);
    let mut table = Table::new(&[
        "error of the model",
        "air",
        "adoptions",
        "per 10 min",
        "95 %",
        "harmful",
        "and claimed",
        "doubts",
        "rms error at the end, off",
        "coverage, off",
    ]);
    for line in &study.model_error {
        table.row([
            if line.term { format!("{}; with the term", line.error) } else { line.error.clone() },
            air_word(line.air).to_owned(),
            line.adoptions.to_string(),
            format!("{:.2}", line.per_ten_minutes),
            format!("{:.2} to {:.2}", line.interval[0], line.interval[1]),
            line.harmful.to_string(),
            line.harmful_and_claimed.to_string(),
            line.doubts.to_string(),
            format!("{:.3}, {:.3}", line.error_at_end[0], line.error_at_end[1]),
            format!("{:.0} %, {:.0} %", 100.0 * line.coverage_at_end[0], 100.0 * line.coverage_at_end[1]),
        ]);
    }
    text.push_str(&table.render());
    text.push_str(
        "\nHarmful: afterwards an estimate is worse than without change detection by more than 10 % of the half width of its bounds;\n\
         and claimed: and more than three claimed standard errors from the truth. With the term: with `alpha^2` in `Cm`, which\n\
         `phugoid estimate` offers for such flights.\n",
    );
    text
}
