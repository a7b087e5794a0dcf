//! The rank of the two-parameter law, and its repair.

use crate::laws::{Evaluation, LawSign, ThesisForm, TwoParameterDiagnostics, TwoParameterLaw, TwoParameterSettings};
use crate::plants::SecondOrder;
use phugoid_estimators::Estimator;

use super::draw::{Record, curves, note};
use crate::plant_case::{
    Method, MethodRun, Parameter, PlantCase, PlantRun, published_case, run_method, simulate, verdict,
};
use crate::result::Reproduction;
use crate::result::{Outcome, ParameterOutcome, Requirement, Role};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Curve, Level, Meaning, Shape};
use phugoid_evaluation::settling::settled_at;

/// Instants at which the lines of both surfaces are drawn, s.
const INSTANTS: [f64; 3] = [0.1, 0.3, 1.0];

/// `laws/rank`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let case = published_case("second-order/1")?;
    let motion = simulate(&case)?;
    let unknowns: Vec<(&str, Parameter)> = case.unknowns().collect();
    let [(_, first), (_, second)] = unknowns[..] else {
        return Err(StudyError::Unsuitable(format!("{}: needs two unknown parameters", case.title)));
    };
    let lambda = [first.lambda, second.lambda];
    let two = |form, sign| Method::TwoParameter {
        form,
        evaluation: Evaluation::Implicit,
        sign,
        lambda,
        eta: case.estimator.eta,
    };
    let methods = [
        ("flagship", Role::Flagship, Meaning::Flagship, case.flagship(&motion)),
        ("extended law", Role::Mended, Meaning::Method(2), case.extended(&motion)),
        ("printed law, solved", Role::Published, Meaning::Method(0), two(ThesisForm::Printed, LawSign::AsPrinted)),
        ("damped law, solved", Role::Mended, Meaning::Method(1), two(ThesisForm::Damped, LawSign::FromSlope)),
    ];
    let mut result = Reproduction {
        id: id.to_owned(),
        title: "Why the two-parameter law cannot find two parameters, and what can".to_owned(),
        place: "the law of tables 4.3 and 4.4".to_owned(),
        published: "Two surfaces, one per parameter, with a lambda each; both estimates converge.".to_owned(),
        reconstruction: "Case 1 of the linear second-order plant: unit step, a1 = 8, a2 = 6; lambda, bounds and start as in its \
                         file. The gains k_i follow the one-parameter law."
            .to_owned(),
        difference: "Both surfaces contain the same D = x' x'' - xm' xm''. Their difference, (lambda_1 - lambda_2)(x x' - xm xm'), \
                     contains no parameter, so at every instant they ask for a point on one of two parallel lines: the smaller \
                     singular value is zero. That the law gives two numbers comes from eta and the gains in its \
                     denominators, and the numbers are wrong. The extended law keeps the equations of many instants, which do \
                     differ, and finds both; so does the flagship, which carries them in its sensitivity."
            .to_owned(),
        ..Reproduction::default()
    };
    let mut runs = Vec::new();
    for (k, (name, role, meaning, settings)) in methods.into_iter().enumerate() {
        let done = run_method(&case, &motion, &settings)?;
        result.outcomes.push(outcome(&case, &motion, name, role, &done));
        runs.push((name, meaning, done));
        progress((k + 1) as f64 / 5.0);
    }
    let smallest = |run: &MethodRun| run.information.iter().map(|[l, s]| if *l > 0.0 { s / l } else { 0.0 }).collect();
    let (printed, extended): (Vec<f64>, Vec<f64>) = (smallest(&runs[2].2), smallest(&runs[1].2));
    let largest_printed = printed.iter().copied().fold(0.0, f64::max);
    let at_end = extended.last().copied().unwrap_or(0.0);
    result.requirements.push(Requirement {
        what: "printed surfaces: smaller over larger singular value, at every instant".to_owned(),
        limit: "0 (rounding: 1e-12)".to_owned(),
        found: format!("{largest_printed:.1e}"),
        met: largest_printed < 1e-12,
    });
    result.requirements.push(Requirement {
        what: "extended law: smaller over larger eigenvalue at the end".to_owned(),
        limit: "above 1e-3".to_owned(),
        found: format!("{at_end:.1e}"),
        met: at_end > 1e-3,
    });
    for (wanted, outcome) in ["converges", "converges", "does not converge"].into_iter().zip(&result.outcomes) {
        let word = outcome.behaviour.word();
        result.requirements.push(Requirement {
            what: format!("{}: {wanted}", outcome.method),
            limit: wanted.to_owned(),
            found: word.to_owned(),
            met: (word == "converges") == (wanted == "converges"),
        });
    }
    note(&mut result.golden, "printed law: largest ratio of singular values", largest_printed);
    note(&mut result.golden, "extended law: ratio of eigenvalues at the end", at_end);
    for outcome in &result.outcomes {
        for p in &outcome.parameters {
            note(&mut result.golden, format!("{}: {} at the end", outcome.method, p.name), p.end);
        }
    }
    result.charts.push(information(&motion, &printed, &extended));
    result.charts.push(estimates(&case, &motion, &runs));
    result.charts.push(lines(&case, &motion, first, second)?);
    progress(1.0);
    Ok(result)
}

fn outcome(case: &PlantCase, motion: &PlantRun, name: &str, role: Role, run: &MethodRun) -> Outcome {
    let judged = case.unknowns().zip(&run.estimates);
    let behaviours =
        judged.map(|((_, p), values)| verdict::behaviour(&motion.time_s, values, p.truth, [p.lower, p.upper]));
    let condition = match role {
        Role::Flagship => "equations of all instants, carried by the sensitivity of its model",
        Role::Published => "rank one at every instant; eta and k decide which point of the line is given",
        _ if name.starts_with("extended") => "full rank over time",
        _ => "rank one at every instant; moves along the normal of the line only",
    };
    Outcome {
        method: name.to_owned(),
        role,
        behaviour: verdict::worst(behaviours),
        condition: condition.to_owned(),
        parameters: case
            .unknowns()
            .zip(&run.estimates)
            .map(|((name, p), values)| ParameterOutcome {
                name: name.to_owned(),
                truth: p.truth,
                start: p.start,
                end: values.last().copied().unwrap_or(f64::NAN),
                std_error: None,
                published_s: case.published.converged_after.get(name).map(|t| t.si()),
                converged_s: settled_at(&motion.time_s, values, p.truth, verdict::TOLERANCE),
            })
            .collect(),
    }
}

fn information(motion: &PlantRun, printed: &[f64], extended: &[f64]) -> Chart {
    let record = Record::new(&motion.time_s);
    let log = |ratios: &[f64]| ratios.iter().map(|r| r.max(1e-18).log10()).collect::<Vec<_>>();
    Chart {
        name: "rank".to_owned(),
        title: "What the surfaces say of the second parameter".to_owned(),
        caption: "Smaller over larger singular value of the surfaces' dependence on the two parameters. The two printed \
                  surfaces are of rank one at every instant (zero is drawn at 1e-18); those of the extended law are of full \
                  rank as soon as there is a motion to learn from."
            .to_owned(),
        x: Axis::new("Time", "s"),
        columns: 1,
        panels: vec![curves(
            Axis::new("log10 of smaller over larger", "–"),
            vec![
                record.line("printed surfaces", Meaning::Method(0), &log(printed)),
                record.line("extended law", Meaning::Method(2), &log(extended)),
            ],
            Vec::new(),
        )],
    }
}

fn estimates(case: &PlantCase, motion: &PlantRun, runs: &[(&str, Meaning, MethodRun)]) -> Chart {
    let record = Record::new(&motion.time_s);
    let panel = |(j, (name, p)): (usize, (&str, Parameter))| {
        let drawn = runs.iter().map(|(label, meaning, run)| record.line(*label, *meaning, &run.estimates[j])).collect();
        let margin = p.upper - p.lower;
        let axis = Axis::new(name, "–").with_range((p.lower - margin).min(0.0), p.upper + margin);
        curves(axis, drawn, vec![Level::new("truth", p.truth, Meaning::Truth)])
    };
    Chart {
        name: "estimates".to_owned(),
        title: format!("{}: the same data, four ways", case.title),
        caption:
            "Flagship and extended law find both parameters from the same step response; the printed law, solved to \
                  rounding at every sample, finds neither."
                .to_owned(),
        x: Axis::new("Time", "s"),
        columns: 1,
        panels: case.unknowns().enumerate().map(panel).collect(),
    }
}

/// The lines of parameter pairs on which each surface is at rest.
fn lines(case: &PlantCase, motion: &PlantRun, first: Parameter, second: Parameter) -> Result<Chart, StudyError> {
    let bounds = [[first.lower, first.upper], [second.lower, second.upper]];
    let settings = TwoParameterSettings::as_printed(
        [first.start, second.start],
        bounds,
        [first.lambda, second.lambda],
        case.estimator.eta,
        Evaluation::Implicit,
    );
    let mut law = TwoParameterLaw::<_, 2>::new(SecondOrder, settings)
        .map_err(|error| StudyError::Unsuitable(format!("{}: {error}", case.title)))?;
    let inside: Vec<(TwoParameterDiagnostics, [f64; 2])> = motion
        .samples::<1, 3>()
        .map(|sample| {
            let estimate = law.update(&sample);
            (*law.diagnostics(), estimate.parameters)
        })
        .collect();
    let (low, high) = (0.0, 1.5 * first.upper);
    let mut drawn = Vec::new();
    for (k, at) in INSTANTS.into_iter().enumerate() {
        let index = motion.time_s.partition_point(|t| *t < at).min(inside.len() - 1);
        let (d, [a1, a2]) = inside[index];
        for (i, target) in d.level.into_iter().enumerate() {
            let on_line = |a: f64| (target - d.slope[0] * a) / d.slope[1];
            drawn.push(Curve {
                label: format!("s{} at rest, {at} s", i + 1),
                meaning: Meaning::Method(k),
                x: vec![low, high].into(),
                shape: Shape::Line(vec![on_line(low), on_line(high)]),
            });
        }
        drawn.push(Curve {
            label: format!("estimate, {at} s"),
            meaning: Meaning::Method(k),
            x: vec![a1].into(),
            shape: Shape::Points(vec![a2]),
        });
    }
    drawn.push(Curve {
        label: "truth".to_owned(),
        meaning: Meaning::Truth,
        x: vec![first.truth].into(),
        shape: Shape::Points(vec![second.truth]),
    });
    Ok(Chart {
        name: "lines".to_owned(),
        title: "Pairs of parameters that put the printed surfaces at rest".to_owned(),
        caption: "At every instant both surfaces ask for a point on a line, and the two lines are parallel: no pair puts both \
                  at rest unless the lines coincide, and then every pair on them does. The lines turn with the motion: that is \
                  what the extended law uses. (They pass the truth only while the estimated model is on its plant.)"
            .to_owned(),
        x: Axis::new("a1", "–").with_range(low, high),
        columns: 1,
        panels: vec![curves(Axis::new("a2", "–").with_range(-second.upper, 2.0 * second.upper), drawn, Vec::new())],
    })
}
