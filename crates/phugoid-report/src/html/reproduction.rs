//! The page of reproduced cases and studies.

use phugoid_thesis::group::Group;
use phugoid_thesis::result::Reproduction;

use super::page::{self, Section};
use crate::escape::escape;

mod case;
mod options;
mod overview;
mod parts;

pub(super) use case::plain_table;
pub use options::{NotRun, ReproductionOptions};
use parts::grouped;

/// Reproduced cases and studies as one HTML page without scripts and without links to other files, by group and in the
/// order given. Their ids have to be different. Two calls with the same arguments give the same bytes.
pub fn reproduction_html(reproductions: &[Reproduction], options: &ReproductionOptions) -> String {
    let title = options.title.clone().unwrap_or_else(|| "The thesis, case by case".to_owned());
    let mut sections = vec![
        Section::new("summary", "Summary", overview::summary(reproductions, &options.not_run)),
        Section::new("cases", "All cases", overview::cases(reproductions)),
    ];
    for (group, members) in grouped(reproductions) {
        let mut body = further_reading(group);
        body.extend(members.iter().map(|reproduction| case::case(reproduction)));
        sections.push(Section::new(group.id, group.title, body));
    }
    page::document(&title, "Reproduced by Phugoid", &options.notes, &overview::facts(reproductions), &sections)
}

/// Where theory and code of a group can be read.
fn further_reading(group: &Group) -> String {
    let mut parts = Vec::new();
    if !group.theory.is_empty() {
        let headings: Vec<String> = group.theory.iter().map(|h| format!("“{}”", escape(h))).collect();
        parts.push(format!("theory in <code>docs/theory.md</code>, {}", headings.join(", ")));
    }
    if !group.code.is_empty() {
        let files: Vec<String> = group.code.iter().map(|f| format!("<code>{}</code>", page::breakable(f))).collect();
        parts.push(format!("code in {}", files.join(", ")));
    }
    if parts.is_empty() {
        String::new()
    } else {
        format!("<p class=\"note\">Read beside it: {}.</p>\n", parts.join("; "))
    }
}
