//! Lyapunov functions over time.

use crate::laws::{Evaluation, LawSign, ThesisForm};
use crate::plants::{FirstOrder, SecondOrder, SecondOrderNonlinear};
use nalgebra::{SMatrix, SVector};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{Estimator, Model};

use super::draw::{Record, curves, note};
use crate::plant_case::{Method, PlantCase, PlantRun, ROOM, flagship_settings, published_case, run_method, simulate};
use crate::result::Reproduction;
use crate::result::Requirement;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Meaning};
use phugoid_evaluation::table::{Column, Table};

/// Values below this part of the start are drawn there.
const FLOOR: f64 = 1e-12;

/// `laws/lyapunov`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let mut result = Reproduction {
        id: id.to_owned(),
        title: "Lyapunov functions over time".to_owned(),
        place: "the derivations of the laws".to_owned(),
        published: "V = s^2/2 falls, because s s' <= -eta |s|.".to_owned(),
        reconstruction: "Cases 1 of the first-order plant and of both second-order ones, without noise.".to_owned(),
        difference: "The printed V = s^2/2 starts at zero, because the estimated model starts on the measurement, and grows. What \
                     falls is the flagship's V = 1/2 e^T C^-1 e (e: error of the estimates, C: their covariance) and the extended \
                     law's V = 1/2 |e/R|^2 (R: half width of the bounds): for both it is proved that V cannot rise where the \
                     equations are exact. The flagship linearises, the extended law integrates by the trapezoidal rule; the \
                     largest rise from one sample to the next is what that costs."
            .to_owned(),
        ..Reproduction::default()
    };
    let mut table = Table {
        title: "How the functions move".to_owned(),
        columns: vec![
            Column::new("case", ""),
            Column::new("function", ""),
            Column::new("at the end, part of the start", ""),
            Column::new("largest rise in one sample, part of the start", ""),
        ],
        rows: Vec::new(),
    };
    for (k, case_id) in ["first-order/1", "second-order/1", "second-order-nonlinear/1"].into_iter().enumerate() {
        let case = published_case(case_id)?;
        let motion = simulate(&case)?;
        let flagship = match k {
            0 => flagship::<_, 1, 2>(FirstOrder, &case, &motion)?,
            1 => flagship::<_, 2, 3>(SecondOrder, &case, &motion)?,
            _ => flagship::<_, 2, 3>(SecondOrderNonlinear, &case, &motion)?,
        };
        let extended = extended(&case, &motion)?;
        for (name, v) in [("flagship", &flagship), ("extended law", &extended)] {
            let rise = v.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
            let end = v.last().copied().unwrap_or(f64::NAN);
            table.rows.push(vec![case_id.into(), name.into(), end.into(), rise.into()]);
            result.requirements.push(Requirement {
                what: format!("{case_id}, {name}: V falls, but for the error of its linearisation or quadrature"),
                limit: "largest rise 1e-5, end 1e-6 of the start".to_owned(),
                found: format!("rise {rise:.1e}, end {end:.1e}"),
                met: rise <= 1e-5 && end <= 1e-6,
            });
            let at = |fraction: f64| v[((v.len() - 1) as f64 * fraction) as usize];
            for fraction in [0.01, 0.03, 0.1] {
                note(&mut result.golden, format!("{case_id}, {name}: V after {fraction} of the record"), at(fraction));
            }
        }
        result.charts.push(chart(case_id, &case, &motion, &flagship, &extended)?);
        progress((k + 1) as f64 / 3.0);
    }
    result.tables.push(table);
    Ok(result)
}

/// `1/2 e^T C^-1 e` of the flagship after every sample, as a part of its value before the first.
fn flagship<M, const N: usize, const R: usize>(
    model: M,
    case: &PlantCase,
    motion: &PlantRun,
) -> Result<Vec<f64>, StudyError>
where
    M: Model<N, R, ROOM, Input = [f64; 1]>,
{
    let Method::Flagship { noise_std } = case.flagship(motion) else {
        return Err(StudyError::Unsuitable(format!("{}: no settings of the flagship", case.title)));
    };
    let refused = |error: &dyn std::fmt::Display| StudyError::Unsuitable(format!("{}: {error}", case.title));
    let settings = flagship_settings::<N, R>(case, &noise_std)?;
    let mut smpe = Smpe::new(model, settings).map_err(|error| refused(&error))?;
    let truth: Vec<f64> = case.unknowns().map(|(_, p)| p.truth).collect();
    let lyapunov = |parameters: &[f64; ROOM], covariance: &[[f64; ROOM]; ROOM]| -> Option<f64> {
        // A place without a parameter: no error, and a variance of one, so that the matrix can be inverted.
        let error = SVector::<f64, ROOM>::from_fn(|j, _| truth.get(j).map_or(0.0, |truth| parameters[j] - truth));
        let covariance = SMatrix::<f64, ROOM, ROOM>::from_fn(|i, j| {
            if i.max(j) < truth.len() { covariance[i][j] } else { f64::from(i == j) }
        });
        covariance.cholesky().map(|factor| 0.5 * error.dot(&factor.solve(&error)))
    };
    let mut covariance = [[0.0; ROOM]; ROOM];
    let mut start = f64::NAN;
    let mut values = Vec::with_capacity(motion.time_s.len());
    for (k, mut sample) in motion.samples::<1, R>().enumerate() {
        if k == 0 {
            smpe.covariance(&mut covariance);
            start = lyapunov(&smpe.estimate().parameters, &covariance).unwrap_or(f64::NAN);
        }
        sample.outputs[N] = f64::NAN;
        let estimate = smpe.update(&sample);
        smpe.covariance(&mut covariance);
        let v = lyapunov(&estimate.parameters, &covariance);
        values.push(v.ok_or_else(|| refused(&"the flagship's covariance is not positive definite"))? / start);
    }
    Ok(values)
}

/// `1/2 |e/R|^2` of the extended law after every sample, as a part of its value at the start.
fn extended(case: &PlantCase, motion: &PlantRun) -> Result<Vec<f64>, StudyError> {
    let run = run_method(case, motion, &case.extended(motion))?;
    let sum = |value: &dyn Fn(usize, f64, f64) -> f64| -> f64 {
        case.unknowns().enumerate().map(|(j, (_, p))| value(j, p.truth, 0.5 * (p.upper - p.lower)).powi(2)).sum()
    };
    let starts: Vec<f64> = case.unknowns().map(|(_, p)| p.start).collect();
    let start = sum(&|j, truth, range| (starts[j] - truth) / range);
    let after = |k: usize| sum(&|j, truth, range| (run.estimates[j][k] - truth) / range) / start;
    Ok((0..motion.time_s.len()).map(after).collect())
}

fn chart(
    id: &str,
    case: &PlantCase,
    motion: &PlantRun,
    flagship: &[f64],
    extended: &[f64],
) -> Result<Chart, StudyError> {
    let unknowns: Vec<_> = case.unknowns().map(|(_, p)| p).collect();
    let (form, evaluation, sign, eta) =
        (ThesisForm::Printed, Evaluation::Implicit, LawSign::AsPrinted, case.estimator.eta);
    let settings = match unknowns[..] {
        [p] => Method::OneParameter { form, evaluation, sign, lambda: p.lambda, eta },
        [p, q, ..] => Method::TwoParameter { form, evaluation, sign, lambda: [p.lambda, q.lambda], eta },
        [] => return Err(StudyError::Unsuitable(format!("{}: no unknown parameter", case.title))),
    };
    let printed = run_method(case, motion, &settings)?;
    let record = Record::new(&motion.time_s);
    let log = |values: &[f64]| values.iter().map(|v| v.max(FLOOR).log10()).collect::<Vec<_>>();
    let surfaces = printed.surfaces.iter().enumerate().map(|(i, surface)| {
        let v: Vec<f64> = surface.surface.iter().map(|s| 0.5 * s * s).collect();
        record.line(format!("printed law: s{}^2/2", i + 1), Meaning::Method(i), &log(&v))
    });
    Ok(Chart {
        name: format!("lyapunov-{}", id.replace('/', "-")),
        title: format!("{}: Lyapunov functions", case.title),
        caption:
            "Above: flagship and extended law, as a part of the start; V falls (drawn down to 1e-12, where rounding is \
                  reached). Below: the printed law, solved at every sample; V starts at zero and grows."
                .to_owned(),
        x: Axis::new("Time", "s"),
        columns: 1,
        panels: vec![
            curves(
                Axis::new("log10 V / V at start", "–"),
                vec![
                    record.line("flagship", Meaning::Flagship, &log(flagship)),
                    record.line("extended law", Meaning::Method(2), &log(extended)),
                ],
                Vec::new(),
            ),
            curves(Axis::new("log10 s^2/2", "–"), surfaces.collect(), Vec::new()),
        ],
    })
}
