//! The page of reproduced cases and studies.

use phugoid_thesis::group::{Group, group_of};
use phugoid_thesis::result::{Reproduction, Requirement};

use super::page::{self, Section};
use crate::escape::escape;

mod case;
mod overview;

pub(super) use case::plain_table;

/// What a page of reproductions says beyond them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReproductionOptions {
    /// Heading; `The thesis, case by case` where none.
    pub title: Option<String>,
    /// Paragraphs shown under the heading, e.g. how to repeat it.
    pub notes: Vec<String>,
    /// Cases and studies that ended without a result.
    pub not_run: Vec<NotRun>,
}

/// A case or study without a result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NotRun {
    /// Id.
    pub id: String,
    /// Why.
    pub reason: String,
}

/// Reproduced cases and studies as one self-contained HTML page, in the order given, by group: no scripts, no links to
/// anywhere else, figures inline. Two calls with the same arguments give the same bytes. Ids have to be different.
pub fn reproduction_html(reproductions: &[Reproduction], options: &ReproductionOptions) -> String {
    let title = options.title.clone().unwrap_or_else(|| "The thesis, case by case".to_owned());
    let mut sections = vec![
        Section::new("summary", "Summary", overview::summary(reproductions, &options.not_run)),
        Section::new("cases", "All cases", overview::cases(reproductions)),
    ];
    for (group, members) in grouped(reproductions) {
        let mut body = read_beside(group);
        body.extend(members.iter().map(|reproduction| case::case(reproduction)));
        sections.push(Section::new(group.id, group.title, body));
    }
    page::document(&title, "Reproduced by Phugoid", &options.notes, &overview::facts(reproductions), &sections)
}

/// Neighbours of one group together, in the order given.
fn grouped(reproductions: &[Reproduction]) -> Vec<(&'static Group, Vec<&Reproduction>)> {
    let mut groups: Vec<(&Group, Vec<&Reproduction>)> = Vec::new();
    for reproduction in reproductions {
        let group = group_of(&reproduction.id);
        match groups.iter_mut().find(|(known, _)| known.id == group.id) {
            Some((_, members)) => members.push(reproduction),
            None => groups.push((group, vec![reproduction])),
        }
    }
    groups
}

/// Theory and code to read beside the cases of a group.
fn read_beside(group: &Group) -> String {
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

fn link(id: &str) -> String {
    format!("<a href=\"#{id}\">{id}</a>", id = escape(id))
}

/// How many of these requirements are met, in words and colour.
fn met_of(requirements: &[Requirement]) -> String {
    let met = requirements.iter().filter(|r| r.met).count();
    match requirements.len() {
        0 => "–".to_owned(),
        all if met == all => status("good", &format!("{met} of {all}")),
        all => status("bad", &format!("{met} of {all}")),
    }
}

fn status(class: &str, words: &str) -> String {
    format!("<span class=\"status {class}\">{}</span>", escape(words))
}
