//! Any text as a model file: a model, or an error that points into the text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_identification::model_file::ModelFile;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    match ModelFile::parse("fuzz.toml", &text) {
        Ok(model) => {
            let estimated = model.estimated().count();
            assert!(estimated <= 10_000);
        }
        Err(error) => {
            assert!(
                error.line >= 1 && error.line <= text.split('\n').count() + 1,
                "line {} is in the file",
                error.line
            );
            assert!(error.column >= 1);
            let _ = error.to_string();
        }
    }
});
