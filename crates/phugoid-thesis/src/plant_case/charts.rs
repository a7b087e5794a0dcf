//! Figures of a plant case.

use std::sync::Arc;

use super::format::PlantCase;
use super::judged::Judged;
use super::method::Surface;
use super::simulate::PlantRun;
use crate::result::Behaviour;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};

/// Most points of a curve.
const POINTS: usize = 600;

/// Instants method: close at the beginning, where the estimates move, and ever wider apart.
struct Instants {
    index: Vec<usize>,
    time: Arc<[f64]>,
}

impl Instants {
    fn new(time_s: &[f64]) -> Self {
        let last = time_s.len().saturating_sub(1);
        let mut index: Vec<usize> = (0..POINTS)
            .map(|k| {
                let part = k as f64 / (POINTS - 1) as f64;
                (part * part * last as f64).round() as usize
            })
            .collect();
        index.dedup();
        let time = index.iter().map(|&k| time_s[k]).collect();
        Self { index, time }
    }

    fn of(&self, series: &[f64]) -> Vec<f64> {
        self.index.iter().map(|&k| series[k]).collect()
    }

    fn line(&self, label: impl Into<String>, meaning: Meaning, series: &[f64]) -> Curve {
        Curve { label: label.into(), meaning, x: self.time.clone(), shape: Shape::Line(self.of(series)) }
    }
}

/// The figures of a case: estimates, states, and what the implicit laws look like from inside.
pub(super) fn charts(case: &PlantCase, run: &PlantRun, judged: &[Judged]) -> Vec<Chart> {
    let instants = Instants::new(&run.time_s);
    let mut charts = vec![estimates(case, judged, &instants), states(case, run, judged, &instants)];
    charts.extend(surfaces(case, judged, &instants));
    charts
}

fn meaning(judged: &[Judged], index: usize) -> Meaning {
    crate::result::meaning_of_method(judged.iter().map(|one| one.outcome.role), index)
}

fn estimates(case: &PlantCase, judged: &[Judged], instants: &Instants) -> Chart {
    let panels = case
        .unknowns()
        .enumerate()
        .map(|(j, (name, p))| {
            let mut curves = Vec::new();
            for (index, t) in judged.iter().enumerate() {
                let values = &t.result.estimates[j];
                if let Some(error) = t.result.std_error.as_ref().map(|s| &s[j]) {
                    let edge = |sign: f64| {
                        instants.index.iter().map(|&k| values[k] + sign * 2.0 * error[k]).collect::<Vec<f64>>()
                    };
                    curves.push(Curve {
                        label: format!("{}, two sigma", t.method.name),
                        meaning: meaning(judged, index),
                        x: instants.time.clone(),
                        shape: Shape::Band { lower: edge(-1.0), upper: edge(1.0) },
                    });
                }
            }
            for (index, t) in judged.iter().enumerate().rev() {
                curves.push(instants.line(t.method.name, meaning(judged, index), &t.result.estimates[j]));
            }
            let margin = 0.15 * (p.upper - p.lower);
            let published = case.published.converged_s(name);
            Panel {
                y: Axis::new(name, "–").with_range(p.lower - margin, p.upper + margin),
                content: Content::Curves {
                    curves,
                    levels: vec![
                        Level::new("truth", p.truth, Meaning::Truth),
                        Level::new("bounds", p.lower, Meaning::Bound),
                        Level::new("", p.upper, Meaning::Bound),
                    ],
                    instants: published.map(|t| Level::new("published", t, Meaning::Command)).into_iter().collect(),
                },
            }
        })
        .collect();
    Chart {
        name: "estimates".into(),
        title: format!("{}: estimates", case.title),
        caption:
            "All methods from the same start value on the same samples. What leaves the figure has left the bounds. \
                  The flagship is not given the measured derivative that the laws need."
                .into(),
        x: Axis::new("Time", "s"),
        panels,
        columns: 1,
    }
}

fn states(case: &PlantCase, run: &PlantRun, judged: &[Judged], instants: &Instants) -> Chart {
    let u: Vec<f64> = run.inputs.iter().map(|input| input[0]).collect();
    let mut panels = vec![Panel {
        y: Axis::new("u", "–"),
        content: Content::Curves {
            curves: vec![Curve {
                label: "input".into(),
                meaning: Meaning::Command,
                x: instants.time.clone(),
                shape: Shape::Step(instants.of(&u)),
            }],
            levels: Vec::new(),
            instants: Vec::new(),
        },
    }];
    for (i, name) in case.plant.states().iter().enumerate() {
        let mut curves = Vec::new();
        if let Some(output) = case.plant.measured(i).filter(|_| run.noise_std > 0.0) {
            curves.push(Curve {
                label: "measured".into(),
                meaning: Meaning::Measured,
                x: instants.time.clone(),
                shape: Shape::Points(instants.of(&run.outputs[output])),
            });
        }
        let (lowest, highest) =
            run.states[i].iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        for (index, t) in judged.iter().enumerate().filter(|(_, t)| t.outcome.behaviour != Behaviour::Diverges) {
            let Some(series) = t.result.states.get(i) else { continue };
            curves.push(instants.line(format!("model of the {}", t.method.name), meaning(judged, index), series));
        }
        // Last, and dashed, so that what lies on it is seen too.
        curves.push(instants.line("plant", Meaning::Truth, &run.states[i]));
        let margin = 0.15 * (highest - lowest).max(1e-300) + 3.0 * run.noise_std;
        panels.push(Panel {
            y: Axis::new(*name, "–").with_range(lowest - margin, highest + margin),
            content: Content::Curves { curves, levels: Vec::new(), instants: Vec::new() },
        });
    }
    Chart {
        name: "states".into(),
        title: format!("{}: plant and estimated models", case.title),
        caption: format!("The plant {} and the models that run beside it with the estimates.", case.plant.equation()),
        x: Axis::new("Time", "s"),
        panels,
        columns: 1,
    }
}

/// Limits that leave out what is by powers of ten larger than the same quantity of another law and would hide it; none where
/// nothing is.
fn without_runaways(curves: &[Curve]) -> Option<[f64; 2]> {
    const FAR: f64 = 1e9;
    let extent = |curve: &Curve| -> [f64; 2] {
        let Shape::Line(y) = &curve.shape else { return [0.0; 2] };
        y.iter().filter(|v| v.is_finite()).fold([0.0_f64; 2], |[low, high], &v| [low.min(v), high.max(v)])
    };
    let extents: Vec<[f64; 2]> = curves.iter().map(extent).collect();
    let size = |[low, high]: &[f64; 2]| high - low;
    let smallest = extents.iter().map(size).filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let (kept, left): (Vec<[f64; 2]>, Vec<[f64; 2]>) = extents.iter().partition(|e| size(e) <= FAR * smallest);
    if left.is_empty() {
        return None;
    }
    let [low, high] = kept.iter().fold([0.0_f64; 2], |[l, h], e| [l.min(e[0]), h.max(e[1])]);
    let margin = 0.15 * (high - low);
    Some([low - margin, high + margin])
}

/// Surface, reaching condition and gain of the laws that are solved implicitly and say what they look like from inside.
fn surfaces(case: &PlantCase, judged: &[Judged], instants: &Instants) -> Option<Chart> {
    let inside: Vec<(usize, &Judged)> =
        judged.iter().enumerate().filter(|(_, t)| t.implicit() && !t.result.surfaces.is_empty()).collect();
    if inside.is_empty() {
        return None;
    }
    type Quantity = fn(&Surface) -> &[f64];
    let quantities: [(&str, Quantity); 3] =
        [("s", |d| &d.surface), ("s s' + eta |s|", |d| &d.reaching), ("K", |d| &d.gain)];
    let panels = quantities
        .into_iter()
        .map(|(label, quantity)| {
            let mut curves = Vec::new();
            for &(index, t) in &inside {
                for (i, surface) in t.result.surfaces.iter().enumerate() {
                    let name = if t.result.surfaces.len() > 1 {
                        format!("{}, surface {}", t.method.name, i + 1)
                    } else {
                        t.method.name.to_owned()
                    };
                    curves.push(instants.line(name, meaning(judged, index), quantity(surface)));
                }
            }
            let mut y = Axis::new(label, "–");
            y.range = without_runaways(&curves);
            Panel {
                y,
                content: Content::Curves {
                    curves,
                    levels: vec![Level::new("", 0.0, Meaning::Bound)],
                    instants: Vec::new(),
                },
            }
        })
        .collect();
    Some(Chart {
        name: "surfaces".into(),
        title: format!("{}: the laws from inside", case.title),
        caption:
            "The surface s; the reaching condition s s' <= -eta |s|, which holds where its curve is not above zero; \
                  the gain K that follows from the bounds."
                .into(),
        x: Axis::new("Time", "s"),
        panels,
        columns: 1,
    })
}
