//! The reaching condition of the printed one-parameter law and the role of its bounds, along trajectories.

use crate::laws::{Diagnostics, Evaluation, SurfaceChannel, SurfaceDerivative, ThesisLaw, ThesisSettings};
use crate::plants::FirstOrder;
use phugoid_estimators::{Estimator, Phase};

use super::draw::{Record, curves, note, over_grid};
use crate::plant_case::{Parameter, PlantCase, PlantRun, Signal, published_case, simulate, verdict};
use crate::result::Reproduction;
use crate::result::{Outcome, ParameterOutcome, Requirement, Role};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Content, Level, Meaning, Panel};
use phugoid_evaluation::settling::settled_at;
use phugoid_evaluation::table::{Cell, Column, Table};

/// Cases that are followed: a slow and a fast stable plant, the same with a larger step, an unstable one.
const CASES: [&str; 4] = ["first-order/1", "first-order/3", "first-order/4", "first-order/5"];
/// Steps and `alpha = sqrt(upper/lower)` of the map.
const STEPS: [f64; 10] = [0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 5.0];
const ALPHAS: [f64; 8] = [1.05, 1.1, 1.2, 1.4, 1.7, 2.0, 3.0, 4.0];

/// The law along one record.
struct Followed {
    estimates: Vec<f64>,
    inside: Vec<Diagnostics>,
    /// Samples at which the loop had no solution.
    unsolved: Vec<usize>,
}

impl Followed {
    fn series(&self, value: impl Fn(&Diagnostics) -> f64) -> Vec<f64> {
        self.inside.iter().map(value).collect()
    }

    /// `K theta`, sample by sample.
    fn product(&self) -> Vec<f64> {
        self.inside.iter().zip(&self.estimates).map(|(d, theta)| d.gain * theta).collect()
    }

    /// Part of the record in which the reaching condition holds.
    fn held(&self) -> f64 {
        let counted = self.inside.iter().filter(|d| d.surface != 0.0);
        let held = counted.clone().filter(|d| d.reaching <= 0.0).count();
        held as f64 / counted.count().max(1) as f64
    }
}

fn follow(case: &PlantCase, run: &PlantRun, evaluation: Evaluation) -> Result<Followed, StudyError> {
    let p = parameter(case)?;
    let x = SurfaceChannel { state: 0, output: 0, scale: 1.0, derivative: SurfaceDerivative::Output(1) };
    let mut settings = ThesisSettings::<1, 1, 1>::new(0, [p.start], [p.lower, p.upper], [x]).as_printed(evaluation);
    settings.lambda = p.lambda;
    settings.eta = case.estimator.eta;
    let mut law = ThesisLaw::<_, 1, 2, 1, 1>::new(FirstOrder, settings)
        .map_err(|error| StudyError::Unsuitable(format!("{}: {error}", case.title)))?;
    let mut followed = Followed { estimates: Vec::new(), inside: Vec::new(), unsolved: Vec::new() };
    for (k, sample) in run.samples::<1, 2>().enumerate() {
        let estimate = law.update(&sample);
        followed.estimates.push(estimate.parameters[0]);
        followed.inside.push(*law.diagnostics());
        if estimate.status.phase == Phase::Rejected {
            followed.unsolved.push(k);
        }
    }
    Ok(followed)
}

fn parameter(case: &PlantCase) -> Result<Parameter, StudyError> {
    let first = case.unknowns().next().map(|(_, parameter)| parameter);
    first.ok_or_else(|| StudyError::Unsuitable(format!("{}: no unknown parameter", case.title)))
}

/// `laws/reaching`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let mut result = Reproduction {
        id: id.to_owned(),
        title: "Reaching condition and gain of the printed one-parameter law".to_owned(),
        place: "the law of table 4.1".to_owned(),
        published: "The gain K = |a (1/alpha - 1) x^2| - eta, alpha = sqrt(upper/lower), is taken from the bounds so that \
                    s s' <= -eta |s|: the surface is reached in finite time for any a inside the bounds."
            .to_owned(),
        reconstruction: "The minus signs. Bounds, start values and lambda are those of the reconstructed cases.".to_owned(),
        difference: "The reaching condition does not decide whether the printed law converges: it holds at no sample \
                     of the records on which the law is solved, also where it settles, because the law has no switching term, and at rest \
                     s itself goes on drifting at theta eta. Two other conditions decide. With a delayed sample in the loop \
                     the law never settles. Solved at every sample, E relaxes as E' = -(lambda E - theta eta)/(1 - K theta): \
                     it settles on E = theta eta/lambda where K theta < 1, with its sign, and has no solution beyond. For a \
                     step u at rest K theta = u^2 (1 - 1/alpha), whatever a is, so wide bounds and large steps, not narrow \
                     ones, break it; for a < 0 the product is negative and any size of it does no harm."
            .to_owned(),
        ..Reproduction::default()
    };
    let mut table = Table {
        title: "Along the records of the published cases".to_owned(),
        columns: vec![
            Column::new("case", ""),
            Column::new("loop", ""),
            Column::new("behaviour", ""),
            Column::new("reaching condition holds", "%"),
            Column::new("K theta at the end", ""),
            Column::new("samples without a solution", "%"),
            Column::new("E at the end", ""),
            Column::new("theta eta / lambda", ""),
        ],
        rows: Vec::new(),
    };
    for id in CASES {
        let case = published_case(id)?;
        let run = simulate(&case)?;
        let p = parameter(&case)?;
        for evaluation in [Evaluation::Implicit, Evaluation::Delayed] {
            let law = follow(&case, &run, evaluation)?;
            let behaviour = verdict::behaviour(&run.time_s, &law.estimates, p.truth, [p.lower, p.upper]);
            let last = law.estimates.len() - 1;
            let (end, inside) = (law.estimates[last], law.inside[last]);
            let without = law.unsolved.len() as f64 / law.estimates.len() as f64;
            let word = match evaluation {
                Evaluation::Implicit => "solved",
                Evaluation::Delayed => "delayed",
            };
            let rest = end * case.estimator.eta / p.lambda;
            let calm = evaluation == Evaluation::Implicit;
            let shown = |value: f64| Cell::Number(if calm { value } else { f64::NAN });
            table.rows.push(vec![
                id.into(),
                word.into(),
                behaviour.word().into(),
                (100.0 * law.held()).into(),
                shown(inside.gain * end),
                shown(100.0 * without),
                shown(inside.energy),
                shown(rest),
            ]);
            if calm {
                // Where the solution is lost the end is an accident.
                let end_or_nothing = (without == 0.0).then_some(("end", end));
                for (name, value) in end_or_nothing
                    .into_iter()
                    .chain([("reaching condition holds", law.held()), ("without a solution", without)])
                {
                    note(&mut result.golden, format!("{id}: {name}"), value);
                }
            }
            result.outcomes.push(outcome(&case, id, &run, &law, word, behaviour)?);
        }
        if id == CASES[0] || id == CASES[2] || id == CASES[3] {
            result.charts.push(trajectory(&case, id, &run, &follow(&case, &run, Evaluation::Implicit)?));
        }
    }
    result.tables.push(table);
    map(&mut result, progress)?;
    Ok(result)
}

fn outcome(
    case: &PlantCase,
    id: &str,
    run: &PlantRun,
    law: &Followed,
    word: &str,
    behaviour: crate::result::Behaviour,
) -> Result<Outcome, StudyError> {
    let p = parameter(case)?;
    let product = law.product();
    let largest = product.iter().copied().filter(|k| k.is_finite()).fold(0.0_f64, f64::max);
    let condition = if word == "delayed" {
        "a delayed sample in the loop multiplies each error by about |z|/|K D + eta|, far above 1".to_owned()
    } else if let Some(first) = law.unsolved.first() {
        format!("K theta passes 1: from {:.3} s on the loop has no solution", run.time_s[*first])
    } else {
        format!("K theta at most {largest:.3} < 1: rests at E = theta eta/lambda")
    };
    Ok(Outcome {
        method: format!("{id}: printed law, {word}"),
        role: Role::Published,
        behaviour,
        condition,
        parameters: vec![ParameterOutcome {
            name: "a".to_owned(),
            truth: p.truth,
            start: p.start,
            end: law.estimates.last().copied().unwrap_or(f64::NAN),
            std_error: None,
            published_s: None,
            converged_s: settled_at(&run.time_s, &law.estimates, p.truth, verdict::TOLERANCE),
        }],
    })
}

fn trajectory(case: &PlantCase, id: &str, run: &PlantRun, law: &Followed) -> Chart {
    let record = Record::new(&run.time_s);
    let method = Meaning::Method(0);
    let truth = case.unknowns().next().map_or(f64::NAN, |(_, p)| p.truth);
    let log = |values: Vec<f64>| values.into_iter().map(|v| v.max(1e-6).log10()).collect::<Vec<_>>();
    Chart {
        name: format!("reaching-{}", id.replace('/', "-")),
        title: format!("{}: the printed law from inside, solved at every sample", case.title),
        caption: "The reaching condition asks for s s' + eta |s| <= 0. At rest s drifts on at theta eta, and it does not \
                  hold. K is compared with the gain that a switching law needs under the thesis's own bound on the \
                  mismatch (2 eta above K) and with the largest mismatch that a truth inside the bounds causes. The loop \
                  has a solution while K theta < 1."
            .to_owned(),
        x: Axis::new("Time", "s"),
        columns: 1,
        panels: vec![
            curves(
                Axis::new("a", "1/s"),
                vec![record.line("printed law, implicit", method, &law.estimates)],
                vec![Level::new("truth", truth, Meaning::Truth)],
            ),
            curves(Axis::new("s", "–"), vec![record.line("s", method, &law.series(|d| d.surface))], Vec::new()),
            curves(
                Axis::new("s s' + eta |s|", "1/s"),
                vec![record.line("reaching condition: not positive", method, &law.series(|d| d.reaching))],
                vec![Level::new("", 0.0, Meaning::Bound)],
            ),
            curves(
                Axis::new("log10 of gain", "–"),
                vec![
                    record.line("K as printed", method, &log(law.series(|d| d.gain))),
                    record.line("K needed, thesis's bound", Meaning::Bound, &log(law.series(|d| d.required_gain))),
                    record.line("largest mismatch", Meaning::Method(1), &log(law.series(|d| d.mismatch))),
                ],
                Vec::new(),
            ),
            curves(
                Axis::new("K a", "–"),
                vec![record.line("K a", method, &law.product())],
                vec![Level::new("solution exists below", 1.0, Meaning::Bound)],
            ),
        ],
    }
}

/// Part of the record without a solution over step and alpha, beside `u^2 (1 - 1/alpha)`.
fn map(result: &mut Reproduction, progress: &(dyn Fn(f64) + Sync)) -> Result<(), StudyError> {
    let base = published_case("first-order/3")?;
    let p = parameter(&base)?;
    let cell = |step: f64, alpha: f64| -> Result<f64, StudyError> {
        let mut case = base.clone();
        case.input = Signal::Step { amplitude: step, at: phugoid_simulation::quantity::Time::default() };
        let told = Parameter { lower: p.truth / alpha, upper: p.truth * alpha, start: 0.97 * p.truth, ..p };
        case.parameters.insert("a".to_owned(), told);
        let run = simulate(&case)?;
        let law = follow(&case, &run, Evaluation::Implicit)?;
        Ok(100.0 * law.unsolved.len() as f64 / law.estimates.len() as f64)
    };
    let cells = over_grid(&STEPS, &ALPHAS, progress, cell);
    let cells: Vec<Vec<f64>> =
        cells.into_iter().map(|row| row.into_iter().collect()).collect::<Result<_, StudyError>>()?;
    let predicted = |step: f64, alpha: f64| step * step * (1.0 - 1.0 / alpha);
    let (mut right, mut judged) = (0, 0);
    for (row, &alpha) in cells.iter().zip(&ALPHAS) {
        for (&without, &step) in row.iter().zip(&STEPS) {
            // Within 3 % of the limit the loop is nearly singular, and either may happen.
            let product = predicted(step, alpha);
            if (product - 1.0).abs() > 0.03 {
                judged += 1;
                right += usize::from((without > 0.0) == (product > 1.0));
            }
        }
    }
    result.requirements.push(Requirement {
        what: "the loop loses its solution exactly where u^2 (1 - 1/alpha) > 1".to_owned(),
        limit: format!("{judged} of {judged} settings"),
        found: format!("{right} of {judged} settings"),
        met: right == judged,
    });
    let (x, y) = (STEPS.to_vec(), ALPHAS.to_vec());
    let panel = |value: Axis, values: Vec<Vec<f64>>, absent: &str| Panel {
        y: Axis::new("alpha = sqrt(upper/lower)", "–"),
        content: Content::Map {
            x: x.clone(),
            y: y.clone(),
            value,
            values,
            logarithmic: false,
            absent: absent.to_owned(),
            marked: Some([1.0, 4.0]),
        },
    };
    let product = ALPHAS.map(|alpha| STEPS.map(|step| predicted(step, alpha).min(2.0)).to_vec()).to_vec();
    let without = cells.iter().map(|row| row.iter().map(|&c| if c > 0.0 { c } else { f64::NAN }).collect()).collect();
    result.charts.push(Chart {
        name: "gain-and-bounds".to_owned(),
        title: "Where the printed law, solved at every sample, has a solution (a = 5)".to_owned(),
        caption: "Left: K theta at rest as the bounds fix it, u^2 (1 - 1/alpha); one is the limit (values above 2 are shown \
                  as 2). Right: part of three seconds in which the loop has no solution. The wider the bounds and the larger \
                  the step, the larger the gain, and the sooner the law is lost. Marked: the reconstructed unit step of \
                  case 3."
            .to_owned(),
        x: Axis::new("Step u", "–"),
        columns: 2,
        panels: vec![
            panel(Axis::new("K theta at rest", "–").with_range(0.0, 2.0), product, ""),
            panel(Axis::new("Samples without a solution", "%").with_range(0.0, 100.0), without, "always solved"),
        ],
    });
    for (row, alpha) in cells.iter().zip(ALPHAS) {
        let first = STEPS.iter().zip(row).find(|(_, without)| **without > 0.0).map_or(0.0, |(step, _)| *step);
        note(&mut result.golden, format!("alpha {alpha}: smallest step without a solution"), first);
    }
    Ok(())
}
