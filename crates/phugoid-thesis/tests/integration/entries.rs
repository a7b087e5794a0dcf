//! The table of entries: each case file reads and bears the title of its entry, and each entry has a group.
//!
//! The table leads to every study, so that a program of unit tests that reads it would compile all of them once more.

use phugoid_thesis::aircraft_case::{self, AircraftCase};
use phugoid_thesis::group::group_of;
use phugoid_thesis::{case_text, entries, plant_case};

#[test]
fn every_file_reads_and_bears_the_title_of_its_entry() {
    let title = |id: &str| entries().into_iter().find(|entry| entry.id == id).unwrap().title;
    for id in plant_case::published_ids() {
        assert_eq!(plant_case::published_case(id).unwrap().title, title(id));
    }
    for id in aircraft_case::published_ids() {
        assert_eq!(aircraft_case::published_case(id).unwrap().title, title(id));
    }
    let sensors: Vec<_> = entries().into_iter().filter(|entry| entry.group() == "sensors").collect();
    assert_eq!(sensors.len(), 5);
    for entry in sensors {
        assert_eq!(AircraftCase::parse(case_text(entry.id).unwrap(), entry.id).unwrap().title, entry.title);
    }
    for error in [plant_case::published_case("no-group/9").err(), aircraft_case::published_case("no-group/9").err()] {
        assert!(error.unwrap().to_string().contains("no-group/9"));
    }
}

#[test]
fn every_entry_has_a_group_of_its_own_name() {
    for entry in entries() {
        assert_eq!(group_of(entry.id).id, entry.group(), "{} belongs to no known group", entry.id);
    }
    assert_eq!(group_of("my-case").title, "Cases of your own");
}
