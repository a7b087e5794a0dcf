//! Parts that overview and cases share: groups, links, coloured words.

use phugoid_thesis::group::{Group, group_of};
use phugoid_thesis::result::{Reproduction, Requirement};

use crate::escape::escape;

/// The cases by group, in the order given.
pub(super) fn grouped(reproductions: &[Reproduction]) -> Vec<(&'static Group, Vec<&Reproduction>)> {
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

/// A link to a case in the page.
pub(super) fn link(id: &str) -> String {
    format!("<a href=\"#{id}\">{id}</a>", id = escape(id))
}

/// The number of requirements that are met, such as `3 of 4`, in colour.
pub(super) fn met_of(requirements: &[Requirement]) -> String {
    let met = requirements.iter().filter(|r| r.met).count();
    match requirements.len() {
        0 => "–".to_owned(),
        all if met == all => status("good", &format!("{met} of {all}")),
        all => status("bad", &format!("{met} of {all}")),
    }
}

/// Words in the colour of a class (`good`, `waiting`, `bad`).
pub(super) fn status(class: &str, words: &str) -> String {
    format!("<span class=\"status {class}\">{}</span>", escape(words))
}
