//! The study of change detection, in small: what it says can be checked, and the numbers are those of its seeds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_evaluation::detection::{Air, Stick, detection, detection_flights};

#[test]
fn damage_is_found_and_a_right_model_is_left_alone() {
    let done = AtomicUsize::new(0);
    let study = detection(4, 910_000, &|| _ = done.fetch_add(1, Ordering::Relaxed)).unwrap();
    assert_eq!(done.into_inner(), detection_flights(4));
    assert_eq!((study.damage.len(), study.model_error.len()), (8, 18));
    for line in &study.damage {
        // Nobody knows it sooner than an observer who is told what to look for, and doubt comes before belief.
        assert!(line.informed_s[0] <= line.doubt_s[0] && line.doubt_s[0] <= line.adoption_s[0], "{line:?}");
        if line.air == Air::Calm && line.stick == Stick::Pilot {
            assert_eq!((line.missed, line.false_before), (0, 0), "{line:?}");
            // 0.22 s in the median of 100 flights (docs/methods.md); these are four.
            assert!(line.adoption_s[0] <= 0.7, "{line:?}");
        }
        for at in &line.recovery {
            assert!(at.oracle_coverage > 0.7 && at.median_over_oracle > 0.0, "{line:?}");
        }
    }
    for line in &study.model_error {
        assert!(line.interval[0] <= line.per_ten_minutes && line.per_ten_minutes <= line.interval[1]);
        assert!(line.harmful_and_claimed <= line.harmful && line.harmful <= line.adoptions);
    }
    assert_eq!(study.model_error[0].adoptions, 0, "a right model in calm air");
    let squared = study.model_error.iter().filter(|line| line.term && line.error.starts_with("Cm alpha^2"));
    assert!(squared.map(|line| line.adoptions).eq([0; 4]), "with the term the model is right");
    // The same seeds, the same numbers: whatever the number of threads.
    let again = detection(1, 910_000, &|| ()).unwrap();
    assert_eq!(again, detection(1, 910_000, &|| ()).unwrap());
}
