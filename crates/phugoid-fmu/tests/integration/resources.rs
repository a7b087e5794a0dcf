//! Resources that are broken: each is refused with a message that names the file.

use phugoid_fmu::Resources;
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::Scenario;

use crate::{Folder, description};

fn whole() -> String {
    let scenario = Scenario::named("f16-calm").unwrap();
    let (_, trim) = trimmed_aircraft(&scenario).unwrap();
    description(&trim, 0.3)
}

fn message(text: &str) -> String {
    let folder = Folder::with(text);
    Resources::open(folder.path()).expect_err("it was taken").to_string()
}

#[test]
fn what_is_whole_is_read() {
    let folder = Folder::with(&whole());
    let resources = Resources::open(folder.path()).unwrap();
    assert!((resources.start.state.speed - 205.74).abs() < 0.01 && resources.aircraft.name() == "f16");
}

#[test]
fn what_is_broken_names_its_file_and_what_is_wrong() {
    let whole = whole();
    let broken = [
        (whole[..whole.len() / 2].to_owned(), "no description"),
        (String::new(), "format"),
        (whole.replace("format = 1", "format = 7"), "format 7"),
        (whole.replace("type = \"f16\"\n", ""), "`type` or `file`"),
        (whole.replace("type =", "file = \"x\"\ntype ="), "`type` or `file`"),
        (whole.replace("[state]\nspeed = ", "[state]\nspeed = nan # "), "not finite"),
        (whole.replace("[controls]\n", "[controls]\nflaps = 1\n"), "flaps"),
        (format!("format = 1\nx = {}", "[".repeat(100_000)), "no description"),
        (format!("{whole}\n# {}", "x".repeat(2 << 20)), "larger than"),
    ];
    for (text, expected) in broken {
        let message = message(&text);
        assert!(message.contains(phugoid_fmu::FILE) && message.contains(expected), "{expected}: {message}");
    }
    let absent = whole.replace("type = \"f16\"\ncg = 0.3\n", "file = \"aircraft/none.xml\"\n");
    assert!(message(&absent).contains("none.xml"));
    let folder = Folder::new();
    let message = Resources::open(folder.path()).expect_err("nothing was taken").to_string();
    assert!(message.contains(phugoid_fmu::FILE) && message.contains("export it again"), "{message}");
}

/// A file that is missing is left out by some readers, so that another aircraft would fly.
#[test]
fn a_file_that_was_changed_is_refused() {
    let folder = Folder::with(&whole().replace("[aircraft]", "[files]\n\"aircraft/a.xml\" = \"00\"\n[aircraft]"));
    let open = || Resources::open(folder.path()).expect_err("it was taken").to_string();
    assert!(open().contains("a.xml cannot be read"), "{}", open());
    std::fs::create_dir(folder.path().join("aircraft")).unwrap();
    std::fs::write(folder.path().join("aircraft/a.xml"), "<a/>").unwrap();
    assert!(open().contains("a.xml was changed"), "{}", open());
    let outside = whole().replace("[aircraft]", "[files]\n\"../a\" = \"00\"\n[aircraft]");
    assert!(message(&outside).contains("was changed"));
}
