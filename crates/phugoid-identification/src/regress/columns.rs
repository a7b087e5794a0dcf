//! A coefficient and its candidates, row by row, from the equations of motion of a record.

use nalgebra::{DMatrix, DVector};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;

use super::selection::Problem;
use crate::batch::TableEquation;
use crate::core::error::EstimateError;
use crate::core::options::CAPACITY;
use crate::core::term::{Coefficient, Term, Variable};
use crate::judge::offer::batch;
use crate::methods::EveryRoom;
use crate::model_file::{Base, ModelFile, Parameter, Role};

/// Most candidates: with a constant of each coefficient they fill one model.
pub(super) const MOST_CANDIDATES: usize = CAPACITY - Coefficient::ALL.len();
/// Smallest pivot of the equations of one row, in units of their own size: below, they do not tell the coefficients apart.
const PIVOT: f64 = 1e-6;

/// The equations of motion with a constant for each coefficient and the candidates of one. Of each row the coefficients
/// follow from the left sides; a candidate is its column over that of its coefficient's constant.
pub(super) fn columns<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    model: &ModelFile,
    coefficient: Coefficient,
    terms: &[Term],
    extra_inputs: &[String],
) -> Result<Problem, EstimateError> {
    let all = model.axes.coefficients();
    let mut with = model.clone();
    with.extra_inputs = extra_inputs.to_vec();
    let constants = all.iter().map(|c| (*c, Term::default()));
    let of_candidates = terms.iter().map(|term| (coefficient, term.clone()));
    with.parameters =
        constants.chain(of_candidates).map(|(c, term)| parameter(c, term, model.base, extra_inputs)).collect();
    if terms.iter().flat_map(Term::powers).any(|(index, _)| index == Variable::Airspeed.index()) {
        let speeds = record.channel("true_airspeed").map(|channel| channel.values.as_slice()).unwrap_or_default();
        let mut speeds: Vec<f64> = speeds.iter().copied().filter(|v| v.is_finite()).collect();
        if let Some(speed) = median(&mut speeds) {
            with.aircraft.reference_speed.get_or_insert(speed.round().max(1.0));
        }
    }
    let order: Vec<String> = with.parameters.iter().map(|p| p.name.clone()).collect();
    let wrong = |why: &str| EstimateError::Model(format!("regression of {}: {why}", coefficient.symbol()));
    let found = batch::<M, N, R>(&[record], &with, &order)?;
    let Some(equations) = found.and_then(|(tables, _)| tables.into_iter().next()) else {
        return Err(wrong("a state of the motion is nowhere measured, so that there are no equations of motion"));
    };
    let place = all.iter().position(|c| *c == coefficient).unwrap_or(0);
    solved(&equations, all.len(), place).ok_or_else(|| {
        let names: Vec<&str> = equations.iter().map(|e| e.name.as_str()).collect();
        wrong(&format!(
            "the equations that were measured ({}) do not give it: lift and drag need ax and az, or the rates of airspeed \
             and angle of attack",
            names.join(", ")
        ))
    })
}

fn parameter(coefficient: Coefficient, term: Term, base: Base, extra_inputs: &[String]) -> Parameter {
    Parameter {
        name: term.parameter_name(coefficient, base != Base::None, extra_inputs),
        role: Role::Term(coefficient, term),
        start: 0.0,
        prior_std: 1.0,
        bounds: None,
        change_std: None,
        fixed: false,
    }
}

/// The coefficient at `place` among the first `constants` columns of the equations, and the columns behind them. `None` if no
/// equation has it, or if there are too few to tell it from the other coefficients in them.
fn solved(equations: &[TableEquation], constants: usize, place: usize) -> Option<Problem> {
    let has = |e: &TableEquation, c: usize| e.regressors.get(c).is_some_and(|column| column.iter().any(|v| *v != 0.0));
    let of = |measured: bool| equations.iter().filter(move |e| e.measured || !measured).collect::<Vec<_>>();
    // Measured accelerations where they are enough, else the rates of the states with them.
    let (used, unknowns) = [true, false].into_iter().find_map(|measured| {
        let used: Vec<&TableEquation> = connected(&of(measured), constants, place, &has);
        let unknowns: Vec<usize> = (0..constants).filter(|c| used.iter().any(|e| has(e, *c))).collect();
        (!used.is_empty() && used.len() >= unknowns.len()).then_some((used, unknowns))
    })?;
    let at = unknowns.iter().position(|c| *c == place)?;
    let rows = used.first()?.left.len();
    let candidates = used.first()?.regressors.len().saturating_sub(constants);
    let mut problem =
        Problem { left: vec![0.0; rows], columns: vec![vec![0.0; rows]; candidates], used: vec![false; rows] };
    let value = |column: &[f64], row: usize| column.get(row).copied().unwrap_or(0.0);
    for row in 0..rows {
        // Each equation in units of what one unit of all its coefficients makes.
        let mut matrix =
            DMatrix::from_fn(used.len(), unknowns.len(), |e, c| value(&used[e].regressors[unknowns[c]], row));
        let mut left = DVector::from_fn(used.len(), |e, _| used[e].left[row]);
        for e in 0..used.len() {
            let size = matrix.row(e).norm();
            if size > 0.0 {
                matrix.row_mut(e).iter_mut().for_each(|v| *v /= size);
                left[e] /= size;
            }
        }
        if left.iter().chain(matrix.iter()).any(|v| !v.is_finite()) {
            continue;
        }
        let Some(factor) = (matrix.transpose() * &matrix).cholesky() else { continue };
        if factor.l().diagonal().iter().any(|pivot| *pivot < PIVOT) {
            continue;
        }
        let coefficients = factor.solve(&(matrix.transpose() * left));
        let constant = |e: &&&TableEquation| value(&e.regressors[place], row);
        let Some(largest) = used.iter().max_by(|a, b| constant(a).abs().total_cmp(&constant(b).abs())) else {
            continue;
        };
        let by = constant(&largest);
        if by == 0.0 || !coefficients[at].is_finite() {
            continue;
        }
        problem.used[row] = true;
        problem.left[row] = coefficients[at];
        for (column, regressor) in problem.columns.iter_mut().zip(largest.regressors.iter().skip(constants)) {
            column[row] = value(regressor, row) / by;
        }
    }
    Some(problem)
}

/// The equations that have a coefficient, and those that share others with them.
fn connected<'a>(
    equations: &[&'a TableEquation],
    constants: usize,
    place: usize,
    has: &impl Fn(&TableEquation, usize) -> bool,
) -> Vec<&'a TableEquation> {
    let mut wanted = vec![place];
    loop {
        let used: Vec<&TableEquation> =
            equations.iter().copied().filter(|e| wanted.iter().any(|c| has(e, *c))).collect();
        let more: Vec<usize> =
            (0..constants).filter(|c| !wanted.contains(c) && used.iter().any(|e| has(e, *c))).collect();
        if more.is_empty() {
            return used;
        }
        wanted.extend(more);
    }
}

#[cfg(test)]
mod tests {
    use phugoid_flight_data::record::Record;

    use super::super::{RegressOptions, regress};
    use super::*;
    use crate::models::longitudinal::LongitudinalModel;

    const MODEL: &str = r#"
name = "test aircraft"
axes = ["longitudinal"]
[aircraft]
mass = 800
iyy = 1500
wing_area = 16
mean_chord = 1.5
thrust = 0
air_density = 1.2
[coefficients]
CL = ["1", "alpha"]
CD = ["1"]
Cm = ["1", "alpha"]
[parameters]
CL_0 = { start = 0, prior_std = 1 }
CL_alpha = { start = 0, prior_std = 10 }
CD_0 = { start = 0, prior_std = 1 }
Cm_0 = { start = 0, prior_std = 1 }
Cm_alpha = { start = 0, prior_std = 10 }
"#;

    /// A motion with chosen coefficients: the pitch rate turns as the moment says, and the accelerometers show the forces.
    /// It is no flight (angle of attack and pitch follow from nothing), but the equations of moment and force hold.
    fn record() -> (Record, [Vec<f64>; 3]) {
        let time: Vec<f64> = (0..1200).map(|k| 0.025 * f64::from(k)).collect();
        let speed = 50.0;
        let (mass, inertia, area, chord) = (800.0, 1500.0, 16.0, 1.5);
        let pressure = 0.5 * 1.2 * speed * speed * area;
        let alpha: Vec<f64> = time.iter().map(|t| 0.08 + 0.04 * (0.8 * t).sin() + 0.02 * (0.31 * t).cos()).collect();
        let q: Vec<f64> = time.iter().map(|t| 0.06 * (0.7 * t).sin() + 0.03 * (1.1 * t + 1.0).cos()).collect();
        let rate = time.iter().map(|t| 0.06 * 0.7 * (0.7 * t).cos() - 0.03 * 1.1 * (1.1 * t + 1.0).sin());
        let moment: Vec<f64> = rate.map(|qdot| inertia * qdot / (pressure * chord)).collect();
        let lift: Vec<f64> = alpha.iter().map(|a| 0.3 + 4.5 * a).collect();
        let drag: Vec<f64> = alpha.iter().map(|a| 0.03 + 0.8 * a * a).collect();
        let body = |k: usize| {
            let (sin, cos) = alpha[k].sin_cos();
            [lift[k] * sin - drag[k] * cos, -lift[k] * cos - drag[k] * sin].map(|c| pressure * c / mass)
        };
        let columns = [
            ("time_s", time.clone()),
            ("true_airspeed_m_s", vec![speed; time.len()]),
            ("alpha_rad", alpha.clone()),
            ("theta_rad", alpha.clone()),
            ("q_rad_s", q),
            ("elevator_rad", time.iter().map(|t| 0.05 * (1.3 * t).sin()).collect()),
            ("ax_m_s2", (0..time.len()).map(|k| body(k)[0]).collect()),
            ("az_m_s2", (0..time.len()).map(|k| body(k)[1]).collect()),
        ];
        (Record::from_columns("chosen", columns).unwrap(), [lift, drag, moment])
    }

    #[test]
    fn a_coefficient_is_that_of_the_equations_of_motion() {
        let (record, truth) = record();
        let model = ModelFile::parse("test.toml", MODEL).unwrap();
        let alpha = Term::parse("alpha", &[]).unwrap();
        for (coefficient, truth) in
            [Coefficient::Lift, Coefficient::Drag, Coefficient::PitchingMoment].into_iter().zip(&truth)
        {
            let terms = [alpha.clone()];
            let found = columns::<LongitudinalModel, _, _>(&record, &model, coefficient, &terms, &[]).unwrap();
            // Rows every 0.05 s, two samples.
            let used: Vec<usize> = (0..found.used.len()).filter(|row| found.used[*row]).collect();
            assert!(used.len() > 550, "{coefficient:?}: {}", used.len());
            let largest = truth.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            for row in used.into_iter().filter(|row| (20..570).contains(row)) {
                let wanted = truth[2 * row];
                // A window of 0.4 s takes (1.1 rad/s 0.2 s)^2/10, half a per cent, of the fastest motion at the most.
                assert!(
                    (found.left[row] - wanted).abs() < 0.005 * largest,
                    "{coefficient:?} {row}: {} {wanted}",
                    found.left[row]
                );
                let a = record.channel("alpha").unwrap().values[2 * row];
                assert!((found.columns[0][row] - a).abs() < 0.001, "{} {a}", found.columns[0][row]);
            }
        }
    }

    #[test]
    fn the_polynomial_of_lift_and_drag_is_found_with_the_lines_of_a_model_file() {
        let (mut record, _) = record();
        // A little noise on the accelerometers: without any, rounding is explained.
        let mut seed = 5_u64;
        for channel in record.channels.iter_mut().filter(|c| c.name == "ax" || c.name == "az") {
            for value in &mut channel.values {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                *value += 0.05 * ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
            }
        }
        let model = ModelFile::parse("test.toml", MODEL).unwrap();
        let options = RegressOptions { up_to: Some(2), ..RegressOptions::new(Coefficient::Lift) };
        let lift = regress(&record, &model, &options).unwrap();
        assert_eq!(lift.candidates.len(), 9);
        let found: Vec<&str> = lift.terms.iter().map(|t| t.term.as_str()).collect();
        assert_eq!(found, ["1", "alpha"], "{lift:?}");
        assert!((lift.terms[1].value - 4.5).abs() < 4.0 * lift.terms[1].std_error, "{:?}", lift.terms);
        let options = RegressOptions {
            candidates: Some(vec![
                "alpha^2".to_owned(),
                "q_hat".to_owned(),
                "elevator".to_owned(),
                "|elevator|".to_owned(),
            ]),
            ..RegressOptions::new(Coefficient::Drag)
        };
        let drag = regress(&record, &model, &options).unwrap();
        assert_eq!(drag.terms.len(), 2, "{drag:?}");
        assert!((drag.terms[1].value - 0.8).abs() < 4.0 * drag.terms[1].std_error, "{:?}", drag.terms);
        let lines: Vec<String> = drag.lines.iter().map(|line| format!("[{}] {}", line.section, line.line)).collect();
        assert_eq!(lines[0], "[coefficients] CD = [\"1\", \"alpha^2\"]");
        assert!(lines[2].starts_with("[parameters] CD_alpha2 = { start = 0."), "{lines:?}");
        // The lines are those of a model file.
        let text = MODEL
            .replace("CD = [\"1\"]", &drag.lines[0].line)
            .replace("CD_0 = { start = 0, prior_std = 1 }", &format!("{}\n{}", drag.lines[1].line, drag.lines[2].line));
        assert_eq!(ModelFile::parse("with.toml", &text).unwrap().terms(Coefficient::Drag).count(), 2);
    }

    #[test]
    fn what_is_wrong_is_named_with_what_would_be_right() {
        let (record, _) = record();
        let model = ModelFile::parse("test.toml", MODEL).unwrap();
        let with = |candidates: &[&str]| RegressOptions {
            candidates: Some(candidates.iter().map(|c| (*c).to_owned()).collect()),
            ..RegressOptions::new(Coefficient::PitchingMoment)
        };
        let cases = [
            (RegressOptions::new(Coefficient::RollingMoment), "the longitudinal motion of the model has CL, CD, Cm"),
            (with(&["alhpa"]), "did you mean `alpha`?"),
            (with(&["p_hat"]), "the longitudinal motion does not know `p_hat`"),
            (with(&["1"]), "no candidate beside the constant"),
            (
                RegressOptions { up_to: Some(6), ..RegressOptions::new(Coefficient::Lift) },
                "83 candidates, and there is room for",
            ),
            (
                RegressOptions {
                    f_to_enter: Some(4.0),
                    f_to_remove: Some(5.0),
                    ..RegressOptions::new(Coefficient::Lift)
                },
                "is larger than the F to enter",
            ),
            (RegressOptions { f_to_enter: Some(f64::NAN), ..RegressOptions::new(Coefficient::Lift) }, "an F of NaN"),
        ];
        for (options, words) in cases {
            let error = regress(&record, &model, &options).expect_err(words).to_string();
            assert!(error.contains(words), "{words}: {error}");
        }
        // Without accelerometers lift and drag come from the rates of airspeed and angle of attack, and without a single
        // one of those there is nothing.
        let mut without = record.clone();
        without.channels.retain(|channel| channel.name != "ax" && channel.name != "az");
        let error = regress(&without, &model, &RegressOptions::new(Coefficient::Lift)).unwrap_err().to_string();
        assert!(error.contains("`ax`"), "{error}");
    }
}
