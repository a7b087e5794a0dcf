//! The valid word that a misspelt one was meant to be.

use strsim::jaro_winkler;

/// `: did you mean ...?` with the nearest of the words, or the whole list if nothing is near.
pub(crate) fn did_you_mean<'a>(word: &str, words: impl Iterator<Item = &'a str> + Clone) -> String {
    match nearest(word, words.clone()) {
        Some(near) => format!(": did you mean `{near}`?"),
        None => {
            let list: Vec<String> = words.map(|w| format!("`{w}`")).collect();
            if list.is_empty() { String::new() } else { format!(": expected one of {}", list.join(", ")) }
        }
    }
}

/// The valid word nearest to a misspelt one, if any is near.
pub(crate) fn nearest<'a>(word: &str, words: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    words
        .map(|w| (jaro_winkler(&lower, &w.to_lowercase()), w))
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, w)| w)
}
