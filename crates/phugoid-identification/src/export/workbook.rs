//! The tables of a result as a workbook of Excel (`.xlsx`).

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, Worksheet, XlsxError};

use crate::core::estimation::{Estimation, EstimationStatus, FinalStatus, ParameterResult, TotalDerivative};

/// What a cell holds. A number that is not finite leaves its cell empty: Excel has none.
enum Cell<'a> {
    Words(&'a str),
    Number(Option<f64>),
}

impl From<f64> for Cell<'_> {
    fn from(value: f64) -> Self {
        Self::Number(Some(value))
    }
}

impl From<Option<f64>> for Cell<'_> {
    fn from(value: Option<f64>) -> Self {
        Self::Number(value)
    }
}

impl<'a> From<&'a str> for Cell<'a> {
    fn from(words: &'a str) -> Self {
        Self::Words(words)
    }
}

/// Most characters of a cell of Excel.
const LONGEST: usize = 32_767;

/// The workbook of a result, as the bytes of an `.xlsx` file: the same bytes for the same result.
///
/// | sheet | rows |
/// |---|---|
/// | `Result` | status, source, model, method, and the reasons and sentences of the verdict |
/// | `Parameters` | value, unit, standard errors (one sigma), bounds of two of these, status, truth; one row each |
/// | `Totals` | derivatives that increments and their database make together; only where there are some |
/// | `Correlation` | correlation matrix of the errors, with the names at rows and columns |
/// | `Covariance` | the same times the corrected standard errors, in the products of the parameters' units |
/// | `Changes` | estimates before and after each adopted change; only where there is one |
/// | `Events` | time, kind and message; only where there are some |
///
/// Derivatives per radian, all else in SI units. What is no finite number is an empty cell. Text is written as text: what looks
/// like a formula is none.
///
/// ```
/// use phugoid_identification::estimation::Estimation;
/// use phugoid_identification::export::xlsx;
/// let bytes = xlsx(&Estimation::default())?;
/// assert!(bytes.starts_with(b"PK")); // a zip archive, as every workbook is
/// # Ok::<(), phugoid_identification::export::XlsxError>(())
/// ```
///
/// # Errors
/// [`XlsxError`]: more parameters or events than a sheet has rows, or no memory for the archive.
pub fn xlsx(estimation: &Estimation) -> Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    // The date of the writing would make two files of one result differ.
    let created = ExcelDateTime::from_ymd(1980, 1, 1)?;
    workbook.set_properties(&DocProperties::new().set_creation_datetime(&created));
    let head = Format::new().set_bold();
    let mut sheet = |name: &str, columns: &[&str], rows: &[Vec<Cell<'_>>]| -> Result<(), XlsxError> {
        let sheet = workbook.add_worksheet().set_name(name)?;
        for (column, words) in (0_u16..).zip(columns) {
            sheet.write_string_with_format(0, column, *words, &head)?;
        }
        for (row, cells) in (1_u32..).zip(rows) {
            for (column, cell) in (0_u16..).zip(cells) {
                write(sheet, row, column, cell)?;
            }
        }
        sheet.set_freeze_panes(1, 0)?.autofit();
        Ok(())
    };

    sheet("Result", &["what", "says"], &result(estimation))?;
    let columns = [
        "name",
        "unit",
        "value",
        "bound (2 sigma)",
        "lower",
        "upper",
        "status",
        "std_error",
        "corrected_std_error",
        "systematic_std",
        "initial",
        "prior_std",
        "truth",
        "kind",
    ];
    sheet("Parameters", &columns, &estimation.parameters.iter().map(parameter).collect::<Vec<_>>())?;
    if !estimation.totals.is_empty() {
        let columns = ["name", "unit", "value", "bound (2 sigma)", "status", "database", "increment", "std_error"];
        sheet("Totals", &columns, &estimation.totals.iter().map(total).collect::<Vec<_>>())?;
    }

    let mut names = vec![""];
    names.extend(estimation.parameters.iter().map(|p| p.name.as_str()));
    let std_error = |k: usize| estimation.parameters.get(k).map_or(f64::NAN, |p| p.corrected_std_error);
    let matrix = |scale: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<Cell<'_>>> {
        let rows = estimation.parameters.iter().zip(&estimation.correlation).enumerate();
        rows.map(|(i, (p, row))| {
            let mut cells = vec![Cell::from(p.name.as_str())];
            cells.extend(row.iter().enumerate().map(|(j, correlation)| (correlation * scale(i, j)).into()));
            cells
        })
        .collect()
    };
    sheet("Correlation", &names, &matrix(&|_, _| 1.0))?;
    sheet("Covariance", &names, &matrix(&|i, j| std_error(i) * std_error(j)))?;

    if !estimation.changes.is_empty() {
        let columns = [
            "time (s)",
            "not before (s)",
            "not after (s)",
            "name",
            "before",
            "before, std_error",
            "after",
            "after, std_error",
            "difference, std_error",
        ];
        let rows = estimation.changes.iter().flat_map(|change| {
            change.parameters.iter().map(|p| {
                vec![
                    change.time_s.into(),
                    change.interval_s.map(|[from_s, _]| from_s).into(),
                    change.interval_s.map(|[_, to_s]| to_s).into(),
                    p.name.as_str().into(),
                    p.before.into(),
                    p.before_std.into(),
                    p.after.into(),
                    p.after_std.into(),
                    p.difference_std.into(),
                ]
            })
        });
        sheet("Changes", &columns, &rows.collect::<Vec<_>>())?;
    }
    if !estimation.events.is_empty() {
        let rows = estimation
            .events
            .iter()
            .map(|event| vec![event.time_s.into(), event.kind.word().into(), event.message.as_str().into()]);
        sheet("Events", &["time (s)", "kind", "message"], &rows.collect::<Vec<_>>())?;
    }
    workbook.save_to_buffer()
}

fn write(sheet: &mut Worksheet, row: u32, column: u16, cell: &Cell<'_>) -> Result<(), XlsxError> {
    match cell {
        Cell::Words("") => {}
        Cell::Words(words) => {
            sheet.write_string(row, column, words.chars().take(LONGEST).collect::<String>())?;
        }
        Cell::Number(value) => {
            if let Some(value) = value.filter(|value| value.is_finite()) {
                sheet.write_number(row, column, value)?;
            }
        }
    }
    Ok(())
}

/// What the result is worth, first, then what it is of.
fn result(estimation: &Estimation) -> Vec<Vec<Cell<'_>>> {
    let mut rows = vec![vec!["status".into(), estimation.status.word().into()]];
    if estimation.status == EstimationStatus::Refused {
        rows.push(vec!["warning".into(), "Use neither the numbers nor their bounds.".into()]);
    }
    for (what, says) in [
        ("source", estimation.source.as_str()),
        ("model", estimation.model.as_str()),
        ("method", estimation.method.name()),
        ("units", "derivatives per radian, all else SI; a bound is two corrected standard errors"),
    ] {
        rows.push(vec![what.into(), says.into()]);
    }
    rows.extend(estimation.verdict.iter().map(|sentence| vec!["verdict".into(), sentence.as_str().into()]));
    rows
}

fn parameter(p: &ParameterResult) -> Vec<Cell<'_>> {
    let kind = match (p.status, p.nuisance) {
        (FinalStatus::Fixed, _) => "fixed",
        (_, true) => "supports the others",
        (_, false) => "estimated",
    };
    vec![
        p.name.as_str().into(),
        p.unit.as_str().into(),
        p.value.into(),
        p.bound().into(),
        p.lower.into(),
        p.upper.into(),
        p.status.word().into(),
        p.std_error.into(),
        p.corrected_std_error.into(),
        p.systematic_std.into(),
        p.initial.into(),
        p.prior_std.into(),
        Cell::Number(p.truth),
        kind.into(),
    ]
}

fn total(t: &TotalDerivative) -> Vec<Cell<'_>> {
    vec![
        t.name.as_str().into(),
        t.unit.as_str().into(),
        t.value.into(),
        (2.0 * t.std_error).into(),
        t.status.word().into(),
        t.database.into(),
        t.increment.as_str().into(),
        t.std_error.into(),
    ]
}
