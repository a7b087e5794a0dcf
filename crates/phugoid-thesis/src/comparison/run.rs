//! One comparison with all its methods, as a result.

use std::sync::Arc;

use rayon::prelude::*;

use super::case::{ComparisonCase, UNKNOWN};
use super::method::{Flown, Method, Normalised, Score, Setting, Track};
use super::tuning::{Tuned, training_flights, tune};
use crate::golden::instants;
use crate::outside::truth_outside;
use crate::result::Reproduction;
use crate::result::{Outcome, ParameterOutcome, Requirement, in_seconds};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};

/// What one method did, and with which gain.
struct Run {
    method: Method,
    tuned: Tuned,
    track: Track,
    score: Score,
    /// The same law with the best gain that there is for this very flight.
    at_best: Score,
}

impl ComparisonCase {
    /// Tunes the laws on the training flights and runs all methods on the flight; `id` is the name the result bears,
    /// `progress` is told the fraction done.
    ///
    /// # Errors
    /// [`StudyError`]: the scenario cannot be flown, or a method refuses the settings.
    pub fn run(&self, id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
        let setting = Setting::new(self)?;
        let tuned = tune(&setting, &training_flights(&setting)?)?;
        progress(0.5);
        let flown = setting.fly(self.truth(), self.scenario.seed)?;
        let best = tune(&setting, std::slice::from_ref(&flown))?;
        progress(0.95);
        let runs: Vec<Run> = Method::ALL
            .par_iter()
            .zip(tuned.par_iter().zip(&best))
            .map(|(method, (tuned, best))| {
                let score = |track: &Track| track.score(self.truth(), self.comparison.bounds);
                let track = setting.run(&flown, *method, tuned.gain)?;
                let at_best = score(&setting.run(&flown, *method, best.gain)?);
                Ok(Run { method: *method, tuned: *tuned, score: score(&track), track, at_best })
            })
            .collect::<Result<_, StudyError>>()?;
        progress(1.0);
        Ok(Reproduction {
            difference: truth_outside(UNKNOWN, self.truth(), self.comparison.bounds).unwrap_or_default()
                + &self.published.difference,
            outcomes: runs.iter().map(|run| self.outcome(run)).collect(),
            requirements: self.requirements(&runs),
            tables: vec![self.table(&runs, flown.input_starts_s())],
            charts: vec![self.estimates(&runs, flown.input_starts_s()), motion(&flown)],
            golden: golden(&runs),
            ..self.published.reproduction(id, &self.title)
        })
    }

    fn outcome(&self, run: &Run) -> Outcome {
        let condition = match run.method {
            Method::Flagship => "nothing tuned; the bounds decide the gain".to_owned(),
            Method::Sliding => {
                format!("lambda {}/s, eta {:.2e} (tuned)", self.comparison.lambda, run.tuned.gain.gain.recip())
            }
            Method::ModelReference(_, Normalised::No) => format!("gain {:.3} (tuned)", run.tuned.gain.gain),
            Method::ModelReference(_, Normalised::Yes) => {
                format!("gain {:.3}, c {} (tuned)", run.tuned.gain.gain, run.tuned.gain.normalisation)
            }
        };
        Outcome {
            method: run.method.name().to_owned(),
            role: run.method.role(),
            behaviour: run.score.behaviour,
            condition,
            parameters: vec![ParameterOutcome {
                name: UNKNOWN.to_owned(),
                truth: self.truth(),
                start: self.comparison.start,
                end: run.track.values.last().copied().unwrap_or(f64::NAN),
                std_error: run.track.std_errors.as_ref().and_then(|errors| errors.last().copied()),
                published_s: None,
                converged_s: run.score.converged_s,
            }],
        }
    }

    fn requirements(&self, runs: &[Run]) -> Vec<Requirement> {
        let ours = runs.iter().find(|run| run.method == Method::Flagship).and_then(|run| run.score.converged_s);
        let soonest = |of: &dyn Fn(Method) -> bool| {
            let found = runs.iter().filter(|run| of(run.method)).filter_map(|run| run.score.converged_s);
            found.fold(None, |least: Option<f64>, t| Some(least.map_or(t, |l| l.min(t))))
        };
        let laws = soonest(&Method::is_model_reference);
        let mut requirements = vec![Requirement {
            what: "flagship within 5 % before every model-reference law".to_owned(),
            limit: in_seconds(laws),
            found: in_seconds(ours),
            met: ours.is_some_and(|ours| laws.is_none_or(|laws| ours < laws)),
        }];
        let of_thesis = || runs.iter().filter(|run| run.method.is_of_thesis());
        match self.comparison.model_reference_finds_it {
            Some(true) => {
                let thesis = soonest(&Method::is_of_thesis);
                requirements.push(Requirement {
                    what: "equations 3.1 to 3.3 find it too (as printed, or as the gradient they announce), later than the \
                           flagship"
                        .to_owned(),
                    limit: format!("later than {}", in_seconds(ours)),
                    found: in_seconds(thesis),
                    met: thesis.is_some_and(|t| ours.is_some_and(|ours| t > ours)),
                });
            }
            Some(false) => requirements.push(Requirement {
                what: "equations 3.1 to 3.3 do not find it (neither as printed nor as the gradient they announce), not even \
                       with the best gain for this very flight"
                    .to_owned(),
                limit: "never".to_owned(),
                found: of_thesis().map(|run| in_seconds(run.score.converged_s.or(run.at_best.converged_s))).collect::<Vec<_>>().join(", "),
                met: of_thesis().all(|run| run.score.converged_s.or(run.at_best.converged_s).is_none()),
            }),
            None => {}
        }
        requirements
    }

    fn table(&self, runs: &[Run], starts_s: f64) -> Table {
        let percent = |error: f64| Cell::Number(100.0 * error / self.truth().abs());
        Table {
            title: "Same flight, same samples. Gains tuned on other truths; the last column with the best gain for this very \
                    flight"
                .to_owned(),
            columns: vec![
                Column::new("method", ""),
                Column::new("gain", ""),
                Column::new("c", ""),
                Column::new("within 5 % after the input starts", "s"),
                Column::new("mean error, last fifth", "% of the truth"),
                Column::new("error at the end", "% of the truth"),
                Column::new("verdict", ""),
                Column::new("within 5 % with the best gain", "s"),
            ],
            rows: runs
                .iter()
                .map(|run| {
                    let gain = match run.method {
                        Method::Flagship => f64::NAN,
                        _ => run.tuned.gain.gain,
                    };
                    let normalisation = match run.method {
                        Method::ModelReference(_, Normalised::Yes) => run.tuned.gain.normalisation,
                        _ => f64::NAN,
                    };
                    vec![
                        Cell::from(run.method.name()),
                        gain.into(),
                        normalisation.into(),
                        run.score.converged_s.map(|t| t - starts_s).into(),
                        percent(run.score.late_error),
                        percent(run.score.end_error),
                        run.score.behaviour.word().into(),
                        run.at_best.converged_s.map(|t| t - starts_s).into(),
                    ]
                })
                .collect(),
        }
    }

    fn estimates(&self, runs: &[Run], starts_s: f64) -> Chart {
        let [lower, upper] = self.comparison.bounds;
        let margin = 0.1 * (upper - lower);
        let panel = |of: &dyn Fn(Method) -> bool| {
            let mut curves = Vec::new();
            for run in runs.iter().filter(|run| of(run.method)) {
                let x: Arc<[f64]> = run.track.time.as_slice().into();
                let (label, meaning) = (run.method.name().to_owned(), run.method.meaning());
                if let Some(errors) = &run.track.std_errors {
                    let edge =
                        |sign: f64| run.track.values.iter().zip(errors).map(|(v, e)| v + sign * 2.0 * e).collect();
                    let shape = Shape::Band { lower: edge(-1.0), upper: edge(1.0) };
                    curves.push(Curve { label: format!("{label}, ±2 sigma"), meaning, x: x.clone(), shape });
                }
                curves.push(Curve { label, meaning, x, shape: Shape::Step(run.track.values.clone()) });
            }
            Panel {
                y: Axis::new(UNKNOWN, "1/rad").with_range(lower - margin, upper + margin),
                content: Content::Curves {
                    curves,
                    levels: vec![
                        Level::new("truth", self.truth(), Meaning::Truth),
                        Level::new("bounds", lower, Meaning::Bound),
                        Level::new("", upper, Meaning::Bound),
                    ],
                    instants: vec![Level::new("input starts", starts_s, Meaning::Command)],
                },
            }
        };
        Chart {
            name: "estimates".to_owned(),
            title: format!("{UNKNOWN} by all methods"),
            caption:
                "Above the sliding-mode estimators, below the forms of the model-reference estimator; what leaves the \
                      panel is cut off."
                    .to_owned(),
            x: Axis::new("Time", "s"),
            panels: vec![panel(&|method| !method.is_model_reference()), panel(&Method::is_model_reference)],
            columns: 1,
        }
    }
}

/// Elevator and pitch rate of the reference aircraft.
fn motion(flown: &Flown) -> Chart {
    let (time, elevator, q) = flown.signals();
    let x: Arc<[f64]> = time.into();
    let panel = |label: &str, unit: &str, meaning, values: Vec<f64>, held: bool| Panel {
        y: Axis::new(label, unit),
        content: Content::Curves {
            curves: vec![Curve {
                label: String::new(),
                meaning,
                x: x.clone(),
                shape: if held { Shape::Step(values) } else { Shape::Line(values) },
            }],
            levels: Vec::new(),
            instants: Vec::new(),
        },
    };
    let degrees = |values: Vec<f64>| values.into_iter().map(f64::to_degrees).collect();
    Chart {
        name: "motion".to_owned(),
        title: "What all methods are given".to_owned(),
        caption: "At the zeros of the pitch rate the printed law is thrown back to its start.".to_owned(),
        x: Axis::new("Time", "s"),
        panels: vec![
            panel("Elevator", "deg", Meaning::Command, degrees(elevator), true),
            panel("Pitch rate", "deg/s", Meaning::Measured, degrees(q), false),
        ],
        columns: 1,
    }
}

/// Forty instants of the methods whose estimates depend smoothly on everything.
fn golden(runs: &[Run]) -> Table {
    use crate::model_reference::ModelReferenceForm::StateError;
    let smooth = [
        Method::Flagship,
        Method::ModelReference(StateError, Normalised::No),
        Method::ModelReference(StateError, Normalised::Yes),
    ];
    let chosen: Vec<&Run> = runs.iter().filter(|run| smooth.contains(&run.method)).collect();
    let time = chosen.first().map(|run| run.track.time.as_slice()).unwrap_or_default();
    let columns = chosen.iter().map(|run| Column::new(run.method.name(), "1/rad")).collect();
    instants(time, columns, |k| {
        chosen.iter().map(|run| run.track.values.get(k).copied().unwrap_or(f64::NAN).into()).collect()
    })
}
