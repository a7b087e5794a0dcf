//! `phugoid fly`: what it prints and writes, and mistakes.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};

#[test]
fn a_damaged_aircraft_is_flown_and_its_story_told() {
    let folder = Folder::new("fly");
    let run = phugoid(&folder.0, &["fly", "f16-recovery"]);
    assert_eq!(run.code, Some(0), "{}{}", run.out, run.err);
    for word in ["damage", "new gains", "Ended in level flight", "level 1", "elevator", "at least"] {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
    let page = folder.read("phugoid-fly/flight.html");
    assert!(page.contains("What happened") && page.contains("Control margins") && page.contains("Angle of attack"));
    let run = phugoid(&folder.0, &["fly", "f16-recovery", "--control", "fixed", "--json", "--history"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!((json["control"].as_str(), json["outcome"]["departed"].as_bool()), (Some("fixed"), Some(true)));
    assert!(json["left"].is_null() && json["history"]["time_s"].as_array().unwrap().len() > 1000);
}

#[test]
fn mistakes_are_told() {
    let folder = Folder::new("fly-mistakes");
    let run = phugoid(&folder.0, &["fly", "f16-calm"]);
    assert_eq!(run.code, Some(3), "{}", run.err);
    assert!(run.err.contains("thrust = \"engine\""), "{}", run.err);
    let run = phugoid(&folder.0, &["fly", "f16-recovry"]);
    assert!(run.code == Some(3) && run.err.contains("f16-recovery"), "{}", run.err);
    std::fs::create_dir(folder.0.join("elsewhere")).unwrap();
    folder.file("elsewhere/flight.html", "<html>mine</html>");
    let run = phugoid(&folder.0, &["fly", "f16-recovery", "--out", "elsewhere"]);
    assert!(run.code == Some(4) && run.err.contains("no page of phugoid"), "{}", run.err);
}
