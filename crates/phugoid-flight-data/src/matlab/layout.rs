//! Decides which variables are the columns of the table, and finds their names and units.

use std::collections::HashMap;

use super::variable::{Value, in_words};
use crate::memory::{Account, Excess, many};
use crate::printable;
use crate::quality::QualityReport;
use crate::table::header::{self, Meaning};
use crate::table::{Column, LeftOut, TableOptions};
use crate::wording::list;

/// A real matrix and its path of struct fields: `["flight", "alpha"]`.
struct Matrix {
    path: Vec<String>,
    unit: Option<String>,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

#[derive(Default)]
struct Found {
    matrices: Vec<Matrix>,
    texts: Vec<(Vec<String>, Vec<String>)>,
    left_out: Vec<LeftOut>,
}

/// What the variables make.
pub(super) struct Laid {
    /// The columns of the table.
    pub(super) columns: Vec<Column>,
    /// What is not part of it.
    pub(super) left_out: Vec<LeftOut>,
    /// The names that were given and fit no matrix: the matrices that there are.
    pub(super) unnamed: Option<String>,
}

/// The columns of the table that the variables make, and what is not part of it.
pub(super) fn columns(
    variables: Vec<(String, Value)>,
    options: &TableOptions,
    report: &mut QualityReport,
    account: &Account,
) -> Result<Laid, Excess> {
    let mut found = Found::default();
    for (name, value) in variables {
        walk(vec![name], value, &mut found);
    }
    let Found { matrices, texts, mut left_out } = found;
    let length = length_of_table(&matrices, &texts, options);
    let mut columns: Vec<(Vec<String>, Column)> = Vec::new();
    let (mut matrices_found, mut named) = (Vec::new(), options.column_names.is_empty());
    for matrix in matrices {
        let Matrix { path, unit, rows, columns: width, values } = matrix;
        let dimensions = in_words(&[rows, width]);
        let unit = unit.or_else(|| unit_for_column(&path, &texts));
        if values.len() == length && (rows == 1 || width == 1) {
            let header = path.last().cloned().unwrap_or_default();
            columns.push((path, Column { header, unit, values, is_time: false }));
        } else if (rows == length || width == length) && rows > 1 && width > 1 {
            let count = if rows == length { width } else { rows };
            let (names, units) =
                (list_for_matrix(&path, &texts, &NAMES, count), list_for_matrix(&path, &texts, &UNITS, count));
            let given = (options.column_names.len() == count).then_some(options.column_names.as_slice());
            named |= given.is_some();
            let name = printable::one_line(&path.join(".")).into_owned();
            matrices_found.push(format!("{name} has {count}"));
            let names = given.or(names);
            // The matrix is there until its columns have been copied.
            account.take(many(values.len(), 8))?;
            for index in 0..count {
                let last = path.last().map(String::as_str).unwrap_or_default();
                let header = match names.and_then(|names| names.get(index)).filter(|name| !name.is_empty()) {
                    Some(name) => name.clone(),
                    None if rows == length => format!("{last}(:,{})", index + 1),
                    None => format!("{last}({},:)", index + 1),
                };
                let unit = units.and_then(|units| units.get(index)).cloned().or_else(|| unit.clone());
                let values = match rows == length {
                    true => values.iter().skip(index * rows).take(rows).copied().collect(),
                    false => values.iter().skip(index).step_by(rows).copied().collect(),
                };
                let mut path = path.clone();
                path.push(header.clone());
                columns.push((path, Column { header, unit, values, is_time: false }));
            }
            account.give_back(many(values.len(), 8));
        } else {
            let why = format!("a matrix of {dimensions}, where the columns of the table have {length} values");
            left_out.push(LeftOut { header: path.join("."), why });
        }
    }
    let none = || "there is none with several columns".to_owned();
    let unnamed = (!named).then(|| if matrices_found.is_empty() { none() } else { list(&matrices_found) });
    Ok(Laid { columns: make_names_unique(columns, report), left_out, unnamed })
}

/// The variable of this name, or the field of a struct (`data.flight2`); else the names that there are.
pub(super) fn variable(variables: Vec<(String, Value)>, wanted: &str) -> Result<(String, Value), Vec<String>> {
    let mut level = variables;
    let mut rest = wanted;
    loop {
        let names: Vec<String> = level.iter().map(|(name, _)| printable::one_line(name).into_owned()).collect();
        let (first, further) = rest.split_once('.').map_or((rest, None), |(first, further)| (first, Some(further)));
        let Some(index) = level.iter().position(|(name, _)| name == first) else { return Err(names) };
        let (name, value) = level.swap_remove(index);
        match (further, value) {
            (None, value) => return Ok((name, value)),
            (Some(further), Value::Struct(fields)) => (level, rest) = (fields, further),
            (Some(_), _) => return Err(names),
        }
    }
}

/// The names of the structs with a vector in them, on one line each.
pub(super) fn structs(variables: &[(String, Value)]) -> Vec<String> {
    let is_vector = |(_, value): &(String, Value)| matches!(value, Value::Numbers { rows, columns, .. } if rows.saturating_mul(*columns) > 1);
    let with_vectors = variables.iter().filter(|(_, value)| match value {
        Value::Struct(fields) => fields.iter().any(is_vector),
        _ => false,
    });
    with_vectors.map(|(name, _)| printable::one_line(name).into_owned()).collect()
}

/// Names of lists that hold the names of the columns of a matrix beside them; below, those that hold their units, and
/// the names of fields that hold values.
const NAMES: [&str; 9] =
    ["varlab", "names", "headers", "header", "labels", "columns", "channels", "signals", "variables"];
const UNITS: [&str; 2] = ["units", "unit"];
const VALUES: [&str; 3] = ["values", "data", "value"];

fn is_one_of(name: &str, words: &[&str]) -> bool {
    words.iter().any(|word| name.eq_ignore_ascii_case(word))
}

fn walk(path: Vec<String>, value: Value, found: &mut Found) {
    match value {
        Value::Numbers { rows, columns, values } => {
            found.matrices.push(Matrix { path, unit: None, rows, columns, values });
        }
        Value::Texts(texts) => found.texts.push((path, texts)),
        Value::Other(why) => found.left_out.push(LeftOut { header: path.join("."), why }),
        Value::Struct(fields) => {
            let unit = fields.iter().find_map(|(name, value)| match value {
                Value::Texts(texts) if is_one_of(name, &UNITS) => texts.first().filter(|_| texts.len() == 1).cloned(),
                _ => None,
            });
            for (name, value) in fields {
                let mut inner = path.clone();
                match (value, &unit) {
                    // `alpha.values` with `alpha.unit` becomes the column `alpha`.
                    (Value::Numbers { rows, columns, values }, Some(unit)) if is_one_of(&name, &VALUES) => {
                        found.matrices.push(Matrix { path: inner, unit: Some(unit.clone()), rows, columns, values });
                    }
                    (value, _) => {
                        inner.push(name);
                        walk(inner, value, found);
                    }
                }
            }
        }
    }
}

/// The length of the time, else the length that most columns have; of equally frequent ones the longest.
fn length_of_table(matrices: &[Matrix], texts: &[(Vec<String>, Vec<String>)], options: &TableOptions) -> usize {
    let mapped =
        options.columns.iter().find(|mapping| mapping.channel == "time").map(|mapping| mapping.header.as_str());
    let is_time = |matrix: &&Matrix| {
        let Some(name) = matrix.path.last() else { return false };
        let by_name =
            || matches!(header::interpret(name, None), Ok(Meaning::Known { spec, .. }) if spec.name == "time");
        let vector = matrix.values.len() > 1 && (matrix.rows == 1 || matrix.columns == 1);
        vector && mapped.map_or_else(by_name, |mapped| mapped == name || mapped == matrix.path.join("."))
    };
    if let (Some(time), None) = (matrices.iter().find(is_time), options.sample_time_s) {
        return time.values.len();
    }
    let mut columns: HashMap<usize, usize> = HashMap::new();
    for matrix in matrices {
        // If a list has as many names as a matrix has rows, and not as many as columns, the rows are the channels.
        let named = |count: usize| list_for_matrix(&matrix.path, texts, &NAMES, count).is_some();
        let turned = matrix.rows == 1 || (named(matrix.rows) && !named(matrix.columns));
        let (rows, width) = if turned { (matrix.columns, matrix.rows) } else { (matrix.rows, matrix.columns) };
        // A single number is a setting, not a column.
        if rows > 1 {
            *columns.entry(rows).or_default() += width;
        }
    }
    columns.into_iter().max_by_key(|&(length, count)| (count, length)).map_or(0, |(length, _)| length)
}

/// The unit of a column in a struct of units (`units.alpha`) or in a text of its own (`alpha_unit`), beside it or in
/// the file.
fn unit_for_column(path: &[String], texts: &[(Vec<String>, Vec<String>)]) -> Option<String> {
    let (name, scope) = path.split_last()?;
    texts.iter().find_map(|(place, text)| {
        let [text] = text.as_slice() else { return None };
        let (last, before) = place.split_last()?;
        let in_struct = last == name && before.last().is_some_and(|above| is_one_of(above, &UNITS));
        let own = ["_unit", "_units"].iter().any(|end| last.strip_suffix(end) == Some(name)) && before == scope;
        (in_struct || own).then(|| text.clone())
    })
}

/// The list of this length, under one of these names, that belongs to a matrix.
fn list_for_matrix<'t>(
    path: &[String],
    texts: &'t [(Vec<String>, Vec<String>)],
    words: &[&str],
    count: usize,
) -> Option<&'t [String]> {
    let (name, scope) = path.split_last()?;
    let fits = |place: &[String], text: &[String]| {
        let Some((last, before)) = place.split_last() else { return false };
        let lower = last.to_lowercase();
        let own = lower.strip_prefix(&name.to_lowercase()).map(|rest| rest.trim_start_matches('_'));
        text.len() == count
            && before == scope
            && (is_one_of(last, words) || own.is_some_and(|rest| is_one_of(rest, words)))
    };
    texts.iter().find(|(place, text)| fits(place, text)).map(|(_, text)| text.as_slice())
}

/// Names columns by the last part of their path, and by the whole path where two would have the same name.
fn make_names_unique(columns: Vec<(Vec<String>, Column)>, report: &mut QualityReport) -> Vec<Column> {
    let mut count: HashMap<String, usize> = HashMap::new();
    for (_, column) in &columns {
        *count.entry(column.header.clone()).or_default() += 1;
    }
    let mut shortened = Vec::new();
    let columns = columns.into_iter().map(|(path, mut column)| {
        if count.get(&column.header).is_some_and(|&count| count > 1) {
            column.header = path.join(".");
        } else if let [first, _, ..] = path.as_slice()
            && !shortened.contains(first)
        {
            shortened.push(first.clone());
        }
        column
    });
    let columns: Vec<Column> = columns.collect();
    if !shortened.is_empty() {
        report.note("", format!("the columns in {} are called by their own names", shortened.join(", ")));
    }
    columns
}
