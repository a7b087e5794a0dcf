//! Bounds that hold the truth and bounds that do not, starts anywhere between them, parameters of both signs.

use crate::laws::{Evaluation, ThesisForm};

use super::convergence::{all, one_parameter, simulated_time_to_tolerance, time_map, unknown};
use super::draw::{note, over_grid};
use crate::plant_case::{Parameter, PlantCase, published_case};
use crate::result::Reproduction;
use crate::result::Requirement;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart};

/// Geometric middle of the bounds, as a multiple of the truth. The bounds are a factor of two either way.
const MIDDLES: [f64; 11] = [0.25, 0.33, 0.42, 0.55, 0.7, 1.0, 1.4, 1.8, 2.5, 3.0, 4.0];
/// Start, as a part of the way from the bound nearer zero to the other.
const STARTS: [f64; 6] = [0.0, 0.1, 0.3, 0.5, 0.7, 1.0];

/// `laws/bounds-and-start`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let mut result = Reproduction {
        id: id.to_owned(),
        title: "Bounds that hold the truth or do not, and where the estimate starts".to_owned(),
        place: "tables 4.1 to 4.4: positive and negative parameters, starts above and below the truth".to_owned(),
        published: "The estimate converges from above and from below, for positive and negative parameters, as long as the \
                    truth lies between the bounds."
            .to_owned(),
        reconstruction: "Plants of cases 3 (a = 5) and 5 (a = -1) of first order, unit step, 1 ms; bounds a factor of two \
                         either side of their middle. Marked: middle on the truth, start half way."
            .to_owned(),
        difference: "Inside the bounds both methods converge from every start and for both signs. Outside, the printed law \
                     converges all the same: it uses the bounds only through their ratio alpha, and the start only in the \
                     first sample. The flagship holds its estimate within one and a half half-widths of the middle of the bounds: it \
                     converges while the truth lies in that range, and otherwise rests on a limit and says so."
            .to_owned(),
        ..Reproduction::default()
    };
    let signs = [("first-order/3", "a = 5"), ("first-order/5", "a = -1")];
    let mut panels = Vec::new();
    for (k, (case_id, sign)) in signs.into_iter().enumerate() {
        let base = published_case(case_id)?;
        let p = unknown(&base)?;
        for (m, name) in ["flagship", "printed law, solved"].into_iter().enumerate() {
            let done = |fraction: f64| progress((2.0 * k as f64 + m as f64 + fraction) / 4.0);
            let times = all(over_grid(&MIDDLES, &STARTS, &done, |middle, start| {
                let case = told(&base, p, middle, start);
                simulated_time_to_tolerance(&case, |run| match m {
                    0 => case.flagship(run),
                    _ => one_parameter(ThesisForm::Printed, Evaluation::Implicit, p.lambda, base.estimator.eta),
                })
            }))?;
            let (mut inside, mut of, mut outside, mut others) = (0, 0, 0, 0);
            for (time, middle) in times.iter().flat_map(|row| row.iter().zip(MIDDLES)) {
                if (0.5..=2.0).contains(&middle) {
                    of += 1;
                    inside += usize::from(time.is_finite());
                } else {
                    others += 1;
                    outside += usize::from(time.is_finite());
                }
            }
            result.requirements.push(Requirement {
                what: format!("{name}, {sign}: converges from every start where the bounds hold the truth"),
                limit: format!("{of} of {of} settings"),
                found: format!("{inside} of {of} settings ({outside} of {others} where they do not)"),
                met: inside == of,
            });
            note(&mut result.golden, format!("{name}, {sign}: converge, truth inside"), f64::from(inside as u32));
            note(&mut result.golden, format!("{name}, {sign}: converge, truth outside"), f64::from(outside as u32));
            let label = format!("{name}, {sign}");
            panels.push(time_map(&label, &MIDDLES, ("start between the bounds", "–", &STARTS), &times, [1.0, 0.5]));
        }
    }
    result.charts.push(Chart {
        name: "time-to-5-percent".to_owned(),
        title: "Time to 5 % over the place of the bounds and the start".to_owned(),
        caption:
            "The bounds reach from half to twice their middle, so they hold the truth from 0.5 to 2. The start lies \
                  between the bound nearer zero (0) and the other (1)."
                .to_owned(),
        x: Axis::new("Middle of the bounds over the truth", "–"),
        columns: 2,
        panels,
    });
    Ok(result)
}

/// The case with other bounds and another start.
fn told(base: &PlantCase, p: Parameter, middle: f64, start: f64) -> PlantCase {
    let (near, far) = (0.5 * middle * p.truth, 2.0 * middle * p.truth);
    let (lower, upper) = (near.min(far), near.max(far));
    let start = (near + start * (far - near)).clamp(lower, upper);
    let mut case = base.clone();
    for parameter in case.parameters.values_mut() {
        *parameter = Parameter { lower, upper, start, ..p };
    }
    case
}
