//! The model file itself with identified values in the place of its start values.

use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value, value};

use super::identified::{ExportError, Exported, Identified};
use crate::model_file::{ModelFile, Parameter, ReferenceValue, Role};

/// Writes the text of a model file again, with the identified values as `start` of its estimated parameters. Everything else
/// stays as it was written, comments too; each line that changes says how well the value is known. A reference point that came
/// from the record becomes a number. Terms that the estimate has taken in beside those of the text are written into it.
///
/// The file that comes out is a model file as any other: it flies (`phugoid trim --aircraft`), and an estimation starts from it.
/// What was known beforehand (`prior_std`, `bounds`) is left as it was: it does not become more certain by data that are then
/// used once more.
///
/// ```
/// use phugoid_identification::export::{Identified, model_file};
/// use phugoid_identification::model_file::ModelFile;
///
/// let (text, model) = (ModelFile::text("hfb320")?, ModelFile::named("hfb320")?);
/// let mut identified = Identified::start(&model);
/// identified.values.insert("Cm_alpha".to_owned(), -0.61);
/// identified.std_errors.insert("Cm_alpha".to_owned(), 0.02);
/// let written = model_file(&identified, text)?.text;
/// let line = written.lines().find(|line| line.starts_with("Cm_alpha")).unwrap_or_default();
/// assert_eq!(line, "Cm_alpha = { start = -0.61, prior_std = 4.98586 } # estimated, one sigma 0.020");
/// let read = ModelFile::parse("written", &written)?;
/// assert!(read.parameters.iter().any(|p| p.name == "Cm_alpha" && p.start == -0.61));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ExportError::NoPlace`]: the text is not the one that the model was read from, or a value is beyond what the file calls
/// possible, or a term that the text does not have finds no place in it.
pub fn model_file(identified: &Identified<'_>, text: &str) -> Result<Exported, ExportError> {
    let no_place = |message: String| ExportError::NoPlace(message);
    let mut document: DocumentMut = text.parse().map_err(|e: toml_edit::TomlError| no_place(e.to_string()))?;
    let before = ModelFile::parse("the model file", text).map_err(|e| no_place(e.to_string()))?;
    let mut notes = Vec::new();
    for parameter in identified.model.estimated() {
        if before.parameters.iter().any(|known| known.name == parameter.name) {
            continue;
        }
        // A term that the estimate has taken in: the search for terms, or whoever made the model of the text.
        let term = add_term(&mut document, identified.model, parameter).ok_or_else(|| {
            no_place(format!("`{}` is none of its parameters, and there is no place for its term", parameter.name))
        })?;
        notes.push(format!("the model file did not have {term}; it does now"));
    }
    for parameter in identified.model.estimated() {
        let Some(estimate) = identified.values.get(&parameter.name).filter(|value| value.is_finite()) else { continue };
        if parameter.name.starts_with("bias_") {
            notes.push(format!("{} belongs to the sensors of this flight and is not written", parameter.name));
            continue;
        }
        let parameters = document.entry("parameters").or_insert_with(|| Item::Table(Table::new()));
        let Some(parameters) = parameters.as_table_like_mut() else {
            return Err(no_place("`parameters` is no table".to_owned()));
        };
        let known = match identified.std_errors.get(&parameter.name).filter(|std| std.is_finite()) {
            Some(std) => format!("estimated, one sigma {}", rounded(*std)),
            None => "estimated".to_owned(),
        };
        put(parameters, &parameter.name, *estimate, &known);
    }
    if identified.model.reference.alpha == ReferenceValue::FirstSample {
        let reference = document.entry("reference").or_insert_with(|| Item::Table(Table::new()));
        if let Some(reference) = reference.as_table_like_mut() {
            reference.insert("alpha", value(identified.alpha_reference));
        }
        notes.push(format!(
            "the angle of attack that the terms count from was the first of the record: {:.6} rad",
            identified.alpha_reference
        ));
    }
    let head = format!("# Values estimated: {}.\n", identified.origin.replace(char::is_control, " "));
    let text = format!("{head}{document}");
    // What is written has to be read again by whoever gets it.
    ModelFile::parse("the written model file", &text).map_err(|e| no_place(e.to_string()))?;
    Ok(Exported { text, notes })
}

/// Writes the term of a parameter behind those of its coefficient, and what it needs: its input, the speed that terms in the airspeed
/// count from, and what was known of the parameter beforehand. The term in words; none where there is no place for it.
fn add_term(document: &mut DocumentMut, model: &ModelFile, parameter: &Parameter) -> Option<String> {
    let Role::Term(coefficient, term) = &parameter.role else { return None };
    let mut insert = |key: &str, name: &str, what: Value| -> Option<()> {
        let table = document.entry(key).or_insert_with(|| Item::Table(Table::new())).as_table_like_mut()?;
        if table.get(name).is_none() {
            table.insert(name, Item::Value(what));
        }
        Some(())
    };
    if let Some(speed) = model.aircraft.reference_speed {
        insert("aircraft", "reference_speed", Value::from(speed))?;
    }
    if parameter.prior_std.is_finite() {
        let mut line = InlineTable::new();
        line.insert("start", Value::from(parameter.start));
        line.insert("prior_std", Value::from(parameter.prior_std));
        insert("parameters", &parameter.name, Value::InlineTable(line))?;
    }
    let written = term.text(&model.extra_inputs);
    insert("coefficients", coefficient.symbol(), Value::Array(Array::new()))?;
    document.get_mut("coefficients")?.get_mut(coefficient.symbol())?.as_array_mut()?.push(written.clone());
    if !model.extra_inputs.is_empty() {
        let inputs: Array = model.extra_inputs.iter().map(String::as_str).collect();
        document.insert("inputs", value(inputs));
    }
    Some(format!("{written} in {}", coefficient.symbol()))
}

/// Sets `start` of one parameter, whether it has a table or not.
fn put(parameters: &mut dyn TableLike, name: &str, estimate: f64, known: &str) {
    if parameters.get(name).is_none() {
        parameters.insert(name, Item::Value(Value::InlineTable(InlineTable::new())));
    }
    let Some(entry) = parameters.get_mut(name) else { return };
    if let Some(table) = entry.as_table_like_mut() {
        match table.get_mut("start").and_then(Item::as_value_mut) {
            // The blanks around the value stay.
            Some(start) => {
                let decor = start.decor().clone();
                *start = Value::from(estimate);
                *start.decor_mut() = decor;
            }
            None => {
                table.insert("start", value(estimate));
            }
        }
    }
    if let Some(Value::InlineTable(line)) = entry.as_value_mut() {
        let suffix = line.decor().suffix().and_then(|s| s.as_str()).unwrap_or_default().trim_end().to_owned();
        line.decor_mut().set_suffix(if suffix.is_empty() {
            format!(" # {known}")
        } else {
            format!("{suffix}; {known}")
        });
    }
}

/// Two digits that count.
fn rounded(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (1 - value.abs().log10().floor() as i32).clamp(0, 17) as usize;
    format!("{value:.digits$}")
}
