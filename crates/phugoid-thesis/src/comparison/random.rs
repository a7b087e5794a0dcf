//! The comparison over random truths of both signs, without noise and with realistic sensors.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::model_reference::ModelReferenceForm;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::case::{Comparison, ComparisonCase, UNKNOWN};
use super::method::{Method, Normalised, Score, Setting};
use super::published_comparison;
use super::tuning::{training_flights, tune};
use crate::published::Published;
use crate::result::Reproduction;
use crate::result::Requirement;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Panel, Shape};
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::published::CALM_SCENARIO;
use phugoid_evaluation::statistics::quantile;
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_simulation::scenario::Scenario;

/// Number of true values that are drawn, one flight for each.
pub const TRUTHS: usize = 100;
/// Smallest magnitude of a truth as a part of the bounds' half width: 5 % of a truth near zero is nothing to ask for.
pub const SMALLEST: f64 = 0.05;

/// Truth number `run` between the bounds: seeded by its number, magnitudes evenly spread, either sign equally likely.
pub fn truth(run: usize, bounds: [f64; 2]) -> f64 {
    let mut random = Pcg64Mcg::seed_from_u64(0x6d72_6163_0000 + run as u64);
    let positive = random.random::<f64>() < 0.5;
    let part = SMALLEST + (1.0 - SMALLEST) * random.random::<f64>();
    let middle = 0.5 * (bounds[0] + bounds[1]);
    let half = 0.5 * (bounds[1] - bounds[0]);
    middle + if positive { part * half } else { -part * half }
}

/// What all methods made of all truths under one condition.
pub struct Sweep {
    /// `no noise` or `realistic sensors`.
    pub condition: &'static str,
    /// When the elevator starts to move, s.
    pub starts_s: f64,
    /// Half the distance of the bounds, per radian.
    pub half_width: f64,
    /// Truth, and the score of each method in the order of [`Method::ALL`].
    pub runs: Vec<(f64, Vec<Score>)>,
}

/// Runs a condition: tunes the laws on its training flights, then flies and estimates every truth.
///
/// # Errors
/// [`StudyError`]: the scenario cannot be flown.
pub fn sweep(
    condition: &'static str,
    case: &ComparisonCase,
    truths: usize,
    done: impl Fn() + Sync,
) -> Result<Sweep, StudyError> {
    let setting = Setting::new(case)?;
    let flights = training_flights(&setting)?;
    let tuned = tune(&setting, &flights)?;
    let starts_s = flights.first().map_or(f64::NAN, |flown| flown.input_starts_s());
    let one = |run: usize| -> Result<(f64, Vec<Score>), StudyError> {
        let truth = truth(run, case.comparison.bounds);
        let flown = setting.fly(truth, case.scenario.seed.wrapping_add(run as u64))?;
        let scores = Method::ALL
            .iter()
            .zip(&tuned)
            .map(|(method, tuned)| Ok(setting.run(&flown, *method, tuned.gain)?.score(truth, case.comparison.bounds)))
            .collect::<Result<Vec<Score>, StudyError>>()?;
        Ok((truth, scores))
    };
    let runs = monte_carlo(truths, one, done)?;
    Ok(Sweep { condition, starts_s, half_width: case.half_width(), runs })
}

/// The flight of scenario 1 and the one with realistic sensors and an input sized for them.
///
/// # Errors
/// [`StudyError::Unsuitable`]: an embedded file cannot be read.
pub fn conditions() -> Result<[(&'static str, ComparisonCase); 2], StudyError> {
    let calm = published_comparison("model-reference/1")?;
    let mut scenario = Scenario::parse(CALM_SCENARIO, "f16-calm").map_err(StudyError::unsuitable)?;
    scenario.increments = calm.scenario.increments;
    let noisy = ComparisonCase {
        title: scenario.name.clone(),
        published: Published::default(),
        scenario,
        comparison: Comparison { model_reference_finds_it: None, ..calm.comparison.clone() },
    };
    Ok([("no noise", calm), ("realistic sensors", noisy)])
}

/// The entry `model-reference/random`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let conditions = conditions()?;
    let count = AtomicUsize::new(0);
    let total = (conditions.len() * TRUTHS) as f64;
    let done = || progress((count.fetch_add(1, Ordering::Relaxed) + 1) as f64 / total);
    let sweeps: Vec<Sweep> =
        conditions.iter().map(|(condition, case)| sweep(condition, case, TRUTHS, done)).collect::<Result<_, _>>()?;
    let bounds = conditions[0].1.comparison.bounds;
    let mut tables: Vec<Table> = sweeps.iter().map(Sweep::table).collect();
    tables.push(losses(&sweeps));
    Ok(Reproduction {
        id: id.to_owned(),
        title: format!("Model reference, {TRUTHS} random truths of both signs"),
        place: "comparison with MRAC; not in the thesis".to_owned(),
        published: "Nothing: the thesis shows two scenarios.".to_owned(),
        reconstruction: format!(
            "{TRUTHS} values of {UNKNOWN} from {} to {} per radian, seeded, none nearer to 0 than {} of the bounds. Without noise: \
             the flight of scenario 1. Realistic sensors: the scenario f16-calm (3-2-1-1 of 1.5 deg twice, from 0.5 s on, no \
             pitch acceleration measured, so that the energy laws are integrated over the sampling interval). The gains of \
             all laws are searched for on flights with the truths -3 and +3, once per condition.",
            bounds[0], bounds[1], SMALLEST
        ),
        difference: sweeps.iter().map(Sweep::said).collect::<Vec<_>>().join(" "),
        outcomes: Vec::new(),
        requirements: sweeps.iter().flat_map(Sweep::requirements).collect(),
        tables,
        charts: vec![over_time(&sweeps), over_truth(&sweeps, &TIME), over_truth(&sweeps, &ERROR)],
        golden: golden(&sweeps),
    })
}

impl Sweep {
    /// Times from the start of the input to 5 %, s, of one method by run; infinite where it never arrives.
    fn times(&self, method: usize) -> Vec<f64> {
        let time = |scores: &[Score]| scores.get(method).and_then(|score| score.converged_s);
        self.runs.iter().map(|(_, scores)| time(scores).map_or(f64::INFINITY, |t| t - self.starts_s)).collect()
    }

    /// Magnitude of the mean error over the last fifth as a part of the half width, by run.
    fn errors(&self, method: usize) -> Vec<f64> {
        let error = |scores: &[Score]| scores.get(method).map_or(f64::NAN, |score| score.late_error / self.half_width);
        self.runs.iter().map(|(_, scores)| error(scores)).collect()
    }

    fn found(&self, method: usize, of: impl Fn(f64) -> bool) -> usize {
        let times = self.times(method);
        self.runs.iter().zip(times).filter(|((truth, _), time)| of(*truth) && time.is_finite()).count()
    }

    /// Runs in which a method was within 5 % sooner than the flagship, which is the first.
    fn sooner(&self, method: usize) -> usize {
        self.times(method).iter().zip(self.times(0)).filter(|(theirs, ours)| *theirs < ours).count()
    }

    fn table(&self) -> Table {
        let positive = self.runs.iter().filter(|(truth, _)| *truth > 0.0).count();
        let negative = self.runs.len() - positive;
        Table {
            title: format!(
                "{}: {} truths, {negative} negative and {positive} positive",
                self.condition,
                self.runs.len()
            ),
            columns: vec![
                Column::new("method", ""),
                Column::new("found", ""),
                Column::new("found of the negative", ""),
                Column::new("found of the positive", ""),
                Column::new("median time to 5 %", "s"),
                Column::new("90 % of the truths within", "s"),
                Column::new("median late error", "% of the bound"),
                Column::new("largest late error", "% of the bound"),
                Column::new("sooner than the flagship", ""),
            ],
            rows: Method::ALL
                .iter()
                .enumerate()
                .map(|(m, method)| {
                    let (times, errors) = (self.times(m), self.errors(m));
                    vec![
                        method.name().into(),
                        Cell::Number(self.found(m, |_| true) as f64),
                        Cell::Number(self.found(m, |truth| truth < 0.0) as f64),
                        Cell::Number(self.found(m, |truth| truth > 0.0) as f64),
                        Cell::Number(finite(quantile(times.clone(), 0.5))),
                        Cell::Number(finite(quantile(times, 0.9))),
                        percent(quantile(errors.clone(), 0.5)),
                        percent(quantile(errors, 1.0)),
                        Cell::Number(self.sooner(m) as f64),
                    ]
                })
                .collect(),
        }
    }

    /// The result in a sentence.
    fn said(&self) -> String {
        let of = |m: usize| self.found(m, |_| true);
        let laws = Method::ALL.iter().enumerate().filter(|(_, method)| method.is_model_reference());
        let best = laws.map(|(m, method)| (of(m), method.name())).max_by_key(|(found, _)| *found);
        let best = best
            .map_or_else(String::new, |(found, name)| format!("the best of the model-reference laws ({name}) {found}"));
        let lost = self.lost().count();
        format!(
            "With {}: the flagship finds {} of {}, {best}; a model-reference law was sooner in {lost} of them.",
            self.condition,
            of(0),
            self.runs.len()
        )
    }

    /// Runs in which a model-reference law was within 5 % sooner than the flagship: truth, its time, which law, its time (s
    /// after the start of the input).
    fn lost(&self) -> impl Iterator<Item = (f64, f64, &'static str, f64)> + '_ {
        let times: Vec<Vec<f64>> = (0..Method::ALL.len()).map(|m| self.times(m)).collect();
        self.runs.iter().enumerate().filter_map(move |(run, (truth, _))| {
            let ours = times.first()?.get(run).copied()?;
            let laws = Method::ALL.iter().zip(&times).filter(|(method, _)| method.is_model_reference());
            let (name, theirs) = laws
                .filter_map(|(method, times)| Some((method.name(), times.get(run).copied()?)))
                .min_by(|a, b| a.1.total_cmp(&b.1))?;
            (theirs < ours).then_some((*truth, ours, name, theirs))
        })
    }

    fn requirements(&self) -> Vec<Requirement> {
        let best = Method::ALL.iter().enumerate().filter(|(_, method)| method.is_model_reference());
        let (most, soonest) = best.fold((0, f64::INFINITY), |(most, soonest), (m, _)| {
            (most.max(self.found(m, |_| true)), soonest.min(quantile(self.times(m), 0.5)))
        });
        let (ours, median) = (self.found(0, |_| true), quantile(self.times(0), 0.5));
        vec![
            Requirement {
                what: format!(
                    "{}: the flagship finds at least as many truths as any model-reference law",
                    self.condition
                ),
                limit: format!("{most} of {}", self.runs.len()),
                found: format!("{ours} of {}", self.runs.len()),
                met: ours >= most,
            },
            Requirement {
                what: format!("{}: median time to 5 % below that of any model-reference law", self.condition),
                limit: format!("{soonest:.2} s"),
                found: format!("{median:.2} s"),
                met: median < soonest,
            },
        ]
    }
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// An error in per cent; of one that left every bound only that.
fn percent(part: f64) -> Cell {
    if part.is_finite() && part <= 10.0 { Cell::Number(100.0 * part) } else { Cell::from("> 1000") }
}

/// Where the flagship lost.
fn losses(sweeps: &[Sweep]) -> Table {
    let rows = sweeps.iter().flat_map(|sweep| {
        sweep.lost().map(|(truth, ours, name, theirs)| {
            vec![sweep.condition.into(), truth.into(), finite(ours).into(), name.into(), theirs.into()]
        })
    });
    Table {
        title: "Where the flagship loses: a model-reference law was within 5 % sooner".to_owned(),
        columns: vec![
            Column::new("condition", ""),
            Column::new(UNKNOWN, "1/rad"),
            Column::new("flagship", "s"),
            Column::new("law", ""),
            Column::new("law", "s"),
        ],
        rows: rows.collect(),
    }
}

/// How many truths each method has found by a time.
fn over_time(sweeps: &[Sweep]) -> Chart {
    let panels = sweeps.iter().map(|sweep| {
        let curves = Method::ALL.iter().enumerate().map(|(m, method)| {
            let mut times: Vec<f64> = sweep.times(m).into_iter().filter(|t| t.is_finite()).collect();
            times.sort_by(f64::total_cmp);
            let x: Arc<[f64]> = std::iter::once(0.0).chain(times.iter().copied()).collect();
            let values = (0..x.len()).map(|n| n as f64).collect();
            Curve { label: method.name().to_owned(), meaning: method.meaning(), x, shape: Shape::Step(values) }
        });
        Panel {
            y: Axis::new(format!("Found, {}", sweep.condition), "–").with_range(0.0, sweep.runs.len() as f64 * 1.05),
            content: Content::Curves { curves: curves.collect(), levels: Vec::new(), instants: Vec::new() },
        }
    });
    Chart {
        name: "found".to_owned(),
        title: "Truths found (within 5 % to stay) by a time".to_owned(),
        caption: "A curve that ends below the top never finds the others.".to_owned(),
        x: Axis::new("Time after the input starts", "s"),
        panels: panels.collect(),
        columns: 1,
    }
}

/// A quantity of one run against its truth.
struct OverTruth {
    name: &'static str,
    title: &'static str,
    caption: &'static str,
    label: &'static str,
    unit: &'static str,
    range: [f64; 2],
    of: fn(&Sweep, usize) -> Vec<f64>,
}

const TIME: OverTruth = OverTruth {
    name: "time",
    title: "Time to 5 % over the truth",
    caption: "Flagship and model-reference laws. No dot: never within 5 % to stay, as the printed law (3.3) at every truth.",
    label: "Time after the input starts",
    unit: "s",
    range: [0.0, 20.0],
    of: |sweep, method| sweep.times(method).into_iter().map(finite).collect(),
};

const ERROR: OverTruth = OverTruth {
    name: "error",
    title: "Mean error over the last fifth of the flight, over the truth",
    caption: "Flagship and model-reference laws without the printed one, in per cent of the bound; larger ones are cut off.",
    label: "Error",
    unit: "%",
    range: [0.0, 20.0],
    of: |sweep, method| sweep.errors(method).into_iter().map(|error| 100.0 * error).collect(),
};

fn over_truth(sweeps: &[Sweep], quantity: &OverTruth) -> Chart {
    let panels = sweeps.iter().map(|sweep| {
        let x: Arc<[f64]> = sweep.runs.iter().map(|(truth, _)| *truth).collect();
        // Dots have no dashes: only as many methods as there are colours. The printed law has nothing to show (see the table).
        let printed = Method::ModelReference(ModelReferenceForm::Printed, Normalised::No);
        let shown = |method: Method| method == Method::Flagship || method.is_model_reference() && method != printed;
        let methods = Method::ALL.iter().enumerate().filter(|(_, method)| shown(**method));
        let curves = methods.map(|(m, method)| Curve {
            label: method.name().to_owned(),
            meaning: method.meaning(),
            x: x.clone(),
            shape: Shape::Points((quantity.of)(sweep, m)),
        });
        Panel {
            y: Axis::new(format!("{}, {}", quantity.label, sweep.condition), quantity.unit)
                .with_range(quantity.range[0], quantity.range[1]),
            content: Content::Curves { curves: curves.collect(), levels: Vec::new(), instants: Vec::new() },
        }
    });
    Chart {
        name: quantity.name.to_owned(),
        title: quantity.title.to_owned(),
        caption: quantity.caption.to_owned(),
        x: Axis::new(format!("True {UNKNOWN}"), "1/rad"),
        panels: panels.collect(),
        columns: 1,
    }
}

/// The methods whose estimates depend smoothly on everything.
fn golden(sweeps: &[Sweep]) -> Table {
    use ModelReferenceForm::StateError;
    let rows = sweeps.iter().flat_map(|sweep| {
        let smooth = Method::ALL
            .iter()
            .enumerate()
            .filter(|(_, method)| matches!(method, Method::Flagship | Method::ModelReference(StateError, _)));
        smooth.map(|(m, method)| {
            vec![
                sweep.condition.into(),
                method.name().into(),
                Cell::Number(sweep.found(m, |_| true) as f64),
                Cell::Number(finite(quantile(sweep.times(m), 0.5))),
                Cell::Number(100.0 * quantile(sweep.errors(m), 0.5)),
            ]
        })
    });
    Table {
        title: "result".to_owned(),
        columns: vec![
            Column::new("condition", ""),
            Column::new("method", ""),
            Column::new("found", ""),
            Column::new("median time to 5 %", "s"),
            Column::new("median late error", "% of the bound"),
        ],
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truths_are_of_both_signs_within_the_bounds_and_always_the_same() {
        let truths: Vec<f64> = (0..TRUTHS).map(|run| truth(run, [-12.0, 12.0])).collect();
        assert!(truths.iter().all(|t| (0.6..=12.0).contains(&t.abs())));
        let positive = truths.iter().filter(|t| **t > 0.0).count();
        // Five standard deviations of a fair coin.
        assert!((25..=75).contains(&positive), "{positive}");
        assert_eq!(truths[17], truth(17, [-12.0, 12.0]));
        assert_eq!(truth(3, [-1.0, 1.0]) * 12.0, truths[3]);
    }
}
