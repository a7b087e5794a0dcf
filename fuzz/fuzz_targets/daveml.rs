//! Any text as a model in DAVE-ML: a model that can be evaluated and compared with its check data, or an error that fits
//! on a screen.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_aircraft::daveml::Model;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    match Model::parse(&text) {
        Ok(model) => {
            let report = model.check();
            assert!(report.shots_passed() <= report.shots.len());
            let mut evaluator = model.evaluator();
            for value in [0.0, 1.0, -1e300, f64::NAN, f64::INFINITY] {
                for position in model.input_positions() {
                    assert!(evaluator.set(*position, value), "an input can be set");
                }
                evaluator.run();
                assert_eq!(evaluator.values().len(), model.variables().len());
            }
        }
        Err(error) => assert!(error.to_string().len() < 8000, "an error fits on a screen"),
    }
});
