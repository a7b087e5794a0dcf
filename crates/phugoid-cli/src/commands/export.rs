//! `phugoid estimate --export`.

use phugoid_flight_data::output_file;
use std::path::Path;

use phugoid_identification::estimation::Estimation;
use phugoid_identification::export::{ExportError, Exported, Identified, csv, daveml, gazebo, jsbsim, model_file};
use phugoid_identification::model_file::ModelFile;

use super::result::{Document, paragraph};
use crate::arguments::{Export, ExportForm};
use crate::failure::Failure;
use crate::output::{json, print};

type Writer = fn(&Identified<'_>) -> Result<Exported, ExportError>;

/// The function that writes a whole model in this form; none for the forms that contain only the estimates.
fn writer(form: ExportForm) -> Option<Writer> {
    match form {
        ExportForm::Csv | ExportForm::Json | ExportForm::Parquet | ExportForm::Xlsx => None,
        ExportForm::Jsbsim => Some(jsbsim),
        ExportForm::Gazebo => Some(gazebo),
        ExportForm::Daveml => Some(daveml),
    }
}

/// Checks before the estimation that the model can be written in the wanted forms.
///
/// # Errors
/// [`Failure::Input`] if the model does not fit a form, or this build does not write it.
pub(crate) fn check(exports: &[Export], model: &ModelFile) -> Result<(), Failure> {
    for Export { form, file } in exports {
        if *form == ExportForm::Parquet && cfg!(not(feature = "parquet")) {
            return Err(Failure::no_parquet("--export", file, "take csv= in place of parquet="));
        }
        if *form == ExportForm::Xlsx && cfg!(not(feature = "excel")) {
            return Err(no_excel(file));
        }
        if let Some(write) = writer(*form) {
            write(&Identified::start(model)).map_err(|e| Failure::input(format!("--export: {e}")))?;
        }
    }
    Ok(())
}

/// Writes the files, and prints their names and notes unless standard output is reserved for the JSON document.
pub(crate) fn write(
    exports: &[Export],
    estimation: &Estimation,
    model: &ModelFile,
    as_json: bool,
) -> Result<(), Failure> {
    let mut told = String::new();
    for Export { form, file } in exports {
        let as_text =
            |text: String| output_file::write(file, text).map_err(|e| Failure::writing_of("--export", file, e));
        let mut notes = Vec::new();
        match (form, writer(*form)) {
            (_, Some(write)) => {
                let exported =
                    write(&Identified::new(model, estimation)).map_err(|e| Failure::input(format!("--export: {e}")))?;
                as_text(exported.text)?;
                notes = exported.notes;
            }
            (ExportForm::Csv, None) => as_text(csv(estimation))?,
            (ExportForm::Parquet, None) => write_parquet(estimation, file)?,
            (ExportForm::Xlsx, None) => write_workbook(estimation, file)?,
            _ => as_text(json(&Document::new(estimation, None, Vec::new()))?)?,
        }
        told.push_str(&written(format!("Written: {}", file.display()), notes));
    }
    if as_json || told.is_empty() { Ok(()) } else { print(&told) }
}

/// A file that was written, with its notes, as text.
fn written(title: String, notes: Vec<String>) -> String {
    if notes.is_empty() {
        return format!("\n{title}\n");
    }
    let mut text = String::new();
    paragraph(&mut text, &title, notes.into_iter());
    text
}

/// A model file with identified values as its start values; `text` is that of the file.
///
/// # Errors
/// [`Failure::Input`] if the text cannot be written so.
pub(crate) fn with_values(identified: &Identified<'_>, text: &str) -> Result<Exported, Failure> {
    model_file(identified, text).map_err(|e| Failure::input(format!("--write-model: {e}")))
}

/// Writes the model file with the estimates as start values, and prints its name and notes unless standard output is
/// reserved for the JSON document.
pub(crate) fn write_model(
    file: &Path,
    text: &str,
    estimation: &Estimation,
    model: &ModelFile,
    as_json: bool,
) -> Result<(), Failure> {
    let Exported { text, notes } = with_values(&Identified::new(model, estimation), text)?;
    output_file::write(file, text).map_err(|e| Failure::writing_of("--write-model", file, e))?;
    let title = format!("Written: {} (fly it with phugoid trim --aircraft {0})", file.display());
    if as_json { Ok(()) } else { print(&written(title, notes)) }
}

#[cfg(feature = "parquet")]
fn write_parquet(estimation: &Estimation, file: &Path) -> Result<(), Failure> {
    phugoid_identification::export::parquet(estimation, file).map_err(|e| Failure::writing_of("--export", file, e))
}

/// This build does not write Parquet; [`check`] has refused it before the estimation.
#[cfg(not(feature = "parquet"))]
fn write_parquet(_: &Estimation, file: &Path) -> Result<(), Failure> {
    Err(Failure::no_parquet("--export", file, "take csv= in place of parquet="))
}

#[cfg(feature = "excel")]
fn write_workbook(estimation: &Estimation, file: &Path) -> Result<(), Failure> {
    let bytes =
        phugoid_identification::export::xlsx(estimation).map_err(|e| Failure::input(format!("--export: {e}")))?;
    output_file::write(file, bytes).map_err(|e| Failure::writing_of("--export", file, e))
}

/// This build does not write workbooks; [`check`] has refused it before the estimation.
#[cfg(not(feature = "excel"))]
fn write_workbook(_: &Estimation, file: &Path) -> Result<(), Failure> {
    Err(no_excel(file))
}

fn no_excel(file: &Path) -> Failure {
    Failure::no_excel("--export", file, "take csv= in place of xlsx=")
}
