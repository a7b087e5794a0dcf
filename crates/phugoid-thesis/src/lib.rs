#![doc = include_str!("../README.md")]
//!
//! # Entries
//!
//! An [`Entry`] is one case or one study, with an id like `second-order/3`; running it gives a [`Reproduction`]: what was
//! published, what we reconstructed of it, what we found, and what differs and why, as plain data for text, JSON,
//! figures and pages. Cases are files in `scenarios/thesis/`, embedded here; a user's own file runs in the same way.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod aircraft_case;
pub mod case_file;
pub mod comparison;
mod embedded;
mod entry;
mod expression;
mod flight_charts;
pub mod golden;
pub mod group;
pub mod laws;
pub mod model_reference;
mod outside;
pub mod plant_case;
pub mod plants;
pub mod published;
mod repeated;
pub mod result;
mod studies;
pub mod tune;
mod units;

pub use entry::{Entry, Run};
pub use published::Published;
pub use result::Reproduction;

/// All entries, in the order of the report.
pub fn entries() -> Vec<Entry> {
    [
        // trim, gust
        studies::trim::ENTRIES,
        studies::gust::ENTRIES,
        // first-order, first-order-nonlinear, second-order, second-order-nonlinear, noise
        plant_case::ENTRIES,
        studies::noise_levels::ENTRIES,
        // dcm-alpha, dcm-q, dcl-alpha, dcd-alpha, combined
        aircraft_case::ENTRIES,
        // sensors, gust, pilot
        studies::sensors::ENTRIES,
        studies::gust_flight::ENTRIES,
        studies::pilot::ENTRIES,
        // model-reference
        comparison::ENTRIES,
        // laws
        studies::law_summary::ENTRIES,
        studies::laws::ENTRIES,
        // tuning
        studies::tuning::ENTRIES,
        // health
        studies::health::ENTRIES,
    ]
    .concat()
}

/// The text of the case file behind an entry, as a start for a case of one's own; `None` for a study, which is computed by
/// the program, and for an id that no entry has.
///
/// ```
/// let text = phugoid_thesis::case_text("first-order/1").ok_or("a case")?;
/// assert!(text.contains("[published]"));
/// assert_eq!(phugoid_thesis::case_text("laws/reaching"), None);
/// # Ok::<(), &str>(())
/// ```
pub fn case_text(id: &str) -> Option<&'static str> {
    let files = [
        plant_case::FILES,
        aircraft_case::FILES,
        studies::sensors::FILES,
        studies::gust_flight::FILES,
        studies::pilot::FILES,
        &comparison::FILES,
    ];
    files.into_iter().flatten().find(|(known, _)| *known == id).map(|(_, text)| *text)
}

/// The id of the entry whose title the text of a case file bears without being its text, or else whose place in the thesis it names;
/// `None` for the text itself, and for a title and a place that no entry has. A copy with other numbers is not the case of the
/// thesis, whatever its title says.
///
/// ```
/// let text = phugoid_thesis::case_text("first-order/1").ok_or("a case")?;
/// assert_eq!(phugoid_thesis::changed_from(text), None);
/// assert_eq!(phugoid_thesis::changed_from(&text.replace("start", "#")), Some("first-order/1"));
/// let own = text.lines().skip(1).collect::<Vec<_>>().join("\n");
/// assert_eq!(phugoid_thesis::changed_from(&format!("title = \"My case\"\n{own}")), Some("first-order/1"));
/// # Ok::<(), &str>(())
/// ```
pub fn changed_from(text: &str) -> Option<&'static str> {
    let line = |text: &str, key: &str| text.lines().find(|line| line.starts_with(key)).map(str::to_owned);
    let known: Vec<_> = entries().into_iter().filter_map(|entry| Some((entry.id, case_text(entry.id)?))).collect();
    if known.iter().any(|(_, known)| known.trim_end() == text.trim_end()) {
        return None;
    }
    ["title", "place"].into_iter().find_map(|key| {
        let own = line(text, key)?;
        known.iter().find(|(_, known)| line(known, key).is_some_and(|known| known == own)).map(|(id, _)| *id)
    })
}
