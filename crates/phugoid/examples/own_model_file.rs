//! A model file of one's own: `cargo run -p phugoid --example own_model_file`.
//!
//! A user's aircraft begins as the text of a built-in model. Here the damping derivative is known from a wind tunnel and fixed,
//! and one term is added: the lift of the elevator. Then a word is misspelt, to show what is said about it.

#![allow(clippy::expect_used, clippy::panic)] // an example may stop

use phugoid::{Error, EstimateOptions, Model, ModelError, Record, estimate};

fn main() -> Result<(), Error> {
    let record = Record::open(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/flight.csv"))?;
    let text = Model::text("f16-model")?.replace("CL = [\"alpha\"]", "CL = [\"alpha\", \"elevator\"]").replace(
        "dCm_q = { bounds = [-6, 6] }",
        "dCm_q = { start = -2.0, fixed = true }\ndCL_elevator = { bounds = [-1, 1] }",
    );

    let folder = std::env::temp_dir().join(format!("phugoid-own-model-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
    let file = folder.join("mine.toml");
    std::fs::write(&file, &text).expect("a temporary file can be written");
    let model = Model::open(&file);
    std::fs::remove_dir_all(&folder).expect("the folder is there");
    let model = model?;

    let result = estimate(&record, &model, &EstimateOptions::default())?;
    println!("{:<14} {:>10} {:>10}  unit", "parameter", "estimate", "bound");
    for p in &result.parameters {
        println!("{:<14} {:>10.5} {:>10.5}  {}", p.name, p.value, p.bound(), p.unit);
    }

    let names: Vec<&str> = model.estimated().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names, ["dCm_alpha", "dCL_alpha", "dCL_elevator", "dCD_alpha"], "dCm_q is fixed");
    let cm_alpha = result.parameter("dCm_alpha").expect("it is estimated");
    assert!((cm_alpha.value + 0.2).abs() < 2.0 * cm_alpha.bound(), "{cm_alpha:?}");
    // The simulated aircraft has the lift of the elevator that the tables have: the increment is zero.
    let elevator = result.parameter("dCL_elevator").expect("it is estimated");
    assert!(elevator.value.abs() < 2.0 * elevator.bound(), "{elevator:?}");

    let misspelt = text.replace("mean_chord", "mean_cord");
    let error = Model::parse("mine.toml", &misspelt).expect_err("there is no such word");
    println!("\n{error}");
    assert_eq!(error.nearest.as_deref(), Some("mean_chord"));
    assert!(matches!(Model::named("hfb230"), Err(ModelError::Unknown { nearest: Some("hfb320"), .. })));
    Ok(())
}
