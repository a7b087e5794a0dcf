//! `phugoid estimate --export`.

use phugoid_identification::estimation::Estimation;
use phugoid_identification::export::{ExportError, Exported, Identified, csv, gazebo, jsbsim};
use phugoid_identification::model_file::ModelFile;

use super::result::{Document, paragraph};
use crate::arguments::{Export, ExportForm};
use crate::failure::Failure;
use crate::output::{json, print};

type Writer = fn(&Identified<'_>) -> Result<Exported, ExportError>;

/// The forms that a model is written in, not the estimates alone.
fn writer(form: ExportForm) -> Option<Writer> {
    match form {
        ExportForm::Csv | ExportForm::Json => None,
        ExportForm::Jsbsim => Some(jsbsim),
        ExportForm::Gazebo => Some(gazebo),
    }
}

/// # Errors
/// A model that does not fit a form, told before it is estimated.
pub(crate) fn check(exports: &[Export], model: &ModelFile) -> Result<(), Failure> {
    for write in exports.iter().filter_map(|export| writer(export.form)) {
        write(&Identified::start(model)).map_err(|e| Failure::input(format!("--export: {e}")))?;
    }
    Ok(())
}

/// Writes the files and, unless the JSON document is alone on standard output, says what has to be known of them.
pub(crate) fn write(
    exports: &[Export],
    estimation: &Estimation,
    model: &ModelFile,
    as_json: bool,
) -> Result<(), Failure> {
    let mut told = String::new();
    for Export { form, file } in exports {
        let (text, notes) = match writer(*form) {
            Some(write) => {
                let exported =
                    write(&Identified::new(model, estimation)).map_err(|e| Failure::input(format!("--export: {e}")))?;
                (exported.text, exported.notes)
            }
            None if *form == ExportForm::Csv => (csv(estimation), Vec::new()),
            None => (json(&Document::new(estimation, None, Vec::new()))?, Vec::new()),
        };
        std::fs::write(file, text).map_err(|e| Failure::writing_of("--export", file, e))?;
        let title = format!("Written: {}", file.display());
        if notes.is_empty() {
            told.push_str(&format!("\n{title}\n"));
        } else {
            paragraph(&mut told, &title, notes.into_iter());
        }
    }
    if as_json || told.is_empty() { Ok(()) } else { print(&told) }
}
