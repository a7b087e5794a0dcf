//! Writes the start values of a model file in the form of another program: `export_model MODEL.toml jsbsim|gazebo`. For
//! the checks of the exports against the programs that they are for.

use phugoid_identification::export::{Identified, gazebo, jsbsim};
use phugoid_identification::model_file::ModelFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, form] = arguments.as_slice() else { return Err("usage: export_model MODEL.toml jsbsim|gazebo".into()) };
    let model = ModelFile::parse(file, &std::fs::read_to_string(file)?)?;
    let identified = Identified::start(&model);
    let exported = match form.as_str() {
        "jsbsim" => jsbsim(&identified)?,
        "gazebo" => gazebo(&identified)?,
        other => return Err(format!("`{other}` is neither jsbsim nor gazebo").into()),
    };
    print!("{}", exported.text);
    Ok(())
}
