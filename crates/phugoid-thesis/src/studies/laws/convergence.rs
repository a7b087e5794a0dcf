//! Time to 5 % of a method with given settings: what the robustness maps show.

use crate::laws::{Evaluation, LawSign, ThesisForm};

use crate::plant_case::{Method, Parameter, PlantCase, PlantRun, run_method, simulate, verdict};
use crate::result::Behaviour;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Content, Panel};
use phugoid_evaluation::settling::settled_at;

/// Lower end of the colour scale of times, s: three samples at 1 ms.
const FASTEST_S: f64 = 0.003;

/// The forms of the one-parameter law that are mapped. The printed one is as printed; the others take their sign from the
/// slope.
pub(super) fn one_parameter(form: ThesisForm, evaluation: Evaluation, lambda: f64, eta: f64) -> Method {
    let sign = if form == ThesisForm::Printed { LawSign::AsPrinted } else { LawSign::FromSlope };
    Method::OneParameter { form, evaluation, sign, lambda, eta }
}

/// The one unknown of a case of first order.
pub(super) fn unknown(case: &PlantCase) -> Result<Parameter, StudyError> {
    let first = case.unknowns().next().map(|(_, parameter)| parameter);
    first.ok_or_else(|| StudyError::Unsuitable(format!("{}: no unknown parameter", case.title)))
}

/// Time after which all estimates stay within 5 %, s; NaN if the verdict is not that the method converges, or if it stands
/// still near the truth because its loop has no solution.
pub(super) fn time_to_tolerance(case: &PlantCase, run: &PlantRun, method: &Method) -> Result<f64, StudyError> {
    let result = run_method(case, run, method)?;
    if result.unsolved > run.time_s.len() / 10 {
        return Ok(f64::NAN);
    }
    let mut latest = 0.0_f64;
    for ((_, p), values) in case.unknowns().zip(&result.estimates) {
        if verdict::behaviour(&run.time_s, values, p.truth, [p.lower, p.upper]) != Behaviour::Converges {
            return Ok(f64::NAN);
        }
        let settled = settled_at(&run.time_s, values, p.truth, verdict::TOLERANCE);
        latest = latest.max(settled.unwrap_or(f64::NAN));
    }
    Ok(latest)
}

/// The same for a changed case: simulated first.
pub(super) fn simulated_time_to_tolerance(
    case: &PlantCase,
    method: impl Fn(&PlantRun) -> Method,
) -> Result<f64, StudyError> {
    let run = simulate(case)?;
    time_to_tolerance(case, &run, &method(&run))
}

/// Rows of results as rows of values.
pub(super) fn all(rows: Vec<Vec<Result<f64, StudyError>>>) -> Result<Vec<Vec<f64>>, StudyError> {
    rows.into_iter().map(|row| row.into_iter().collect()).collect()
}

/// A panel that maps the time to 5 %. One colour scale for all panels, so that they can be compared.
pub(super) fn time_map(
    method: &str,
    x: &[f64],
    y: (&str, &str, &[f64]),
    values: &[Vec<f64>],
    marked: [f64; 2],
) -> Panel {
    let (label, unit, grid) = y;
    Panel {
        // The ordinate's label stands above the panel, where there is more room than beside the colour bar.
        y: Axis::new(format!("{method}: {label}"), unit),
        content: Content::Map {
            x: x.to_vec(),
            y: grid.to_vec(),
            value: Axis::new("Time to 5 %", "s").with_range(FASTEST_S, 3.0),
            // A time of zero (never outside) has no logarithm; NaN stays what it is.
            values: values
                .iter()
                .map(|row| row.iter().map(|&t| if t < FASTEST_S { FASTEST_S } else { t }).collect())
                .collect(),
            logarithmic: true,
            absent: "not within 5 %".to_owned(),
            marked: Some(marked),
        },
    }
}
