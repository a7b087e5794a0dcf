//! Any bytes as an MCAP file: a log whose topics are tables, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_flight_data::log::{Selection, mcap};

fuzz_target!(|bytes: &[u8]| {
    let selection = Selection { max_values: 1 << 16, ..Selection::default() };
    match mcap::read(bytes, "fuzz", &selection) {
        Ok(log) => {
            for topic in &log.topics {
                assert!(!topic.time_s.is_empty());
                assert!(topic.fields.iter().all(|field| field.values.len() == topic.time_s.len()), "{}", topic.name);
            }
            let _ = log.quality.to_string();
        }
        Err(error) => assert!(error.to_string().len() < 8000, "an error fits on a screen"),
    }
    if let Ok(survey) = mcap::survey(bytes, "fuzz") {
        assert!(survey.topics.iter().all(|topic| topic.samples > 0));
    }
});
