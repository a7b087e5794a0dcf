//! `docs/units-and-signs.md` shows what the code understands.
//!
//! After a change of the tables in the code, `PHUGOID_WRITE_DOCS=1 cargo test -p phugoid-flight-data --test
//! units_document` writes them anew.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use std::fmt::Write as _;
use std::path::Path;

use phugoid_flight_data::channels::{AMBIGUOUS, CHANNELS, FOREIGN};
use phugoid_flight_data::record::Quantity;
use phugoid_flight_data::units::UNITS;

fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

fn channels() -> String {
    let mut table = String::from("| channel | SI unit | what | positive | synonyms |\n|---|---|---|---|---|\n");
    for spec in CHANNELS {
        writeln!(
            table,
            "| `{}` | {} | {} | {} | {} |",
            spec.name,
            spec.quantity.si_unit(),
            spec.description,
            spec.sign,
            quoted(spec.synonyms)
        )
        .unwrap();
    }
    table
}

fn foreign() -> String {
    FOREIGN.iter().fold(String::new(), |mut list, (name, spellings)| {
        writeln!(list, "- `{name}`: {}", quoted(spellings)).unwrap();
        list
    })
}

fn ambiguous() -> String {
    AMBIGUOUS.iter().fold(String::new(), |mut list, (name, meanings)| {
        let rule = match (*name, meanings.len()) {
            ("v", _) => " (beside `u` or `w` it is the lateral velocity)",
            ("fahrt", _) => " (`fahrt_ias`, `fahrt_tas` and `fahrtmesser` are understood)",
            (_, 1) => " or something else (with a unit of angle it is this surface)",
            _ => "",
        };
        writeln!(list, "- `{name}` could be {}{rule}", quoted(meanings)).unwrap();
        list
    })
}

fn units() -> String {
    let mut quantities: Vec<Quantity> = Vec::new();
    for unit in UNITS {
        if !quantities.contains(&unit.quantity) {
            quantities.push(unit.quantity);
        }
    }
    let mut table = String::from("| quantity | SI unit | understood |\n|---|---|---|\n");
    for quantity in quantities {
        let symbols: Vec<&str> = UNITS.iter().filter(|u| u.quantity == quantity).map(|u| u.symbol).collect();
        writeln!(table, "| {} | {} | {} |", quantity.in_words(), quantity.si_unit(), quoted(&symbols)).unwrap();
    }
    table
}

/// Puts a table between its marks.
fn with_table(text: &str, name: &str, table: &str) -> String {
    let (begin, end) = (format!("<!-- {name}: begin -->\n"), format!("<!-- {name}: end -->"));
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("no mark {begin}"));
    let (_, after) = rest.split_once(&end).unwrap_or_else(|| panic!("no mark {end}"));
    format!("{before}{begin}{table}{end}{after}")
}

#[test]
fn the_document_shows_the_tables_of_the_code() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/units-and-signs.md");
    let found = std::fs::read_to_string(&path).unwrap();
    let expected = with_table(&found, "channels", &channels());
    let expected = with_table(&expected, "foreign", &foreign());
    let expected = with_table(&expected, "ambiguous", &ambiguous());
    let expected = with_table(&expected, "units", &units());
    if std::env::var_os("PHUGOID_WRITE_DOCS").is_some() {
        std::fs::write(&path, &expected).unwrap();
        return;
    }
    let difference = expected.lines().zip(found.lines()).find(|(expected, found)| expected != found);
    assert_eq!(difference, None, "the document is not up to date; write it with PHUGOID_WRITE_DOCS=1 (see above)");
    assert_eq!(expected.lines().count(), found.lines().count());
}
