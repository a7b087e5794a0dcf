//! Time to 5 % over lambda and eta.

use crate::laws::{Evaluation, ThesisForm};

use super::convergence::{all, one_parameter, time_map, time_to_tolerance, unknown};
use super::draw::{note, over_grid};
use crate::plant_case::{published_case, simulate};
use crate::result::Reproduction;
use crate::result::Requirement;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart};

/// 1/s; at 1 ms up to `lambda h` = 2.5.
const LAMBDAS: [f64; 12] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 1800.0, 2500.0];
const ETAS: [f64; 9] = [1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1];

/// The forms of the law, all solved at every sample.
const FORMS: [(ThesisForm, &str); 3] =
    [(ThesisForm::Printed, "printed law"), (ThesisForm::Reduced, "reduced law"), (ThesisForm::Damped, "damped law")];

/// `laws/lambda-eta`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let case = published_case("first-order/3")?;
    let p = unknown(&case)?;
    let motion = simulate(&case)?;
    let mut result = Reproduction {
        id: id.to_owned(),
        title: "How lambda and eta decide the one-parameter law".to_owned(),
        place: "tables 4.1 and 4.2: cases that differ in lambda and eta".to_owned(),
        published: "A larger lambda makes the estimate converge sooner; eta is small.".to_owned(),
        reconstruction: "Plant, bounds and start of case 3 of the first-order plant, unit step, 1 ms, 3 s; the marked setting \
                         is the reconstructed one."
            .to_owned(),
        difference: "A larger lambda helps until the loop becomes unstable: at lambda h = 2 (1 - K theta + eta/|z|) for the printed \
                     law (here 0.55, the gain costs it), 2 (1 + eta/|z|) for the reduced and 2 (1 + 2 eta/|z|) for the damped \
                     one. eta is a bias, not a small number: printed and reduced law rest at E = theta eta/lambda, which is \
                     within 5 % of a only for eta/lambda < 0.057/a^3 (a unit step). The damped law has no such limit; a \
                     large eta only slows it."
            .to_owned(),
        ..Reproduction::default()
    };
    let mut panels = Vec::new();
    for (k, (form, name)) in FORMS.into_iter().enumerate() {
        let done = |fraction: f64| progress((k as f64 + fraction) / FORMS.len() as f64);
        let cells = over_grid(&LAMBDAS, &ETAS, &done, |lambda, eta| {
            time_to_tolerance(&case, &motion, &one_parameter(form, Evaluation::Implicit, lambda, eta))
        });
        let times = all(cells)?;
        panels.push(time_map(name, &LAMBDAS, ("eta", "–", &ETAS), &times, [p.lambda, case.estimator.eta]));
        for (row, eta) in times.iter().zip(ETAS) {
            let converged: Vec<f64> = row.iter().copied().filter(|t| t.is_finite()).collect();
            note(&mut result.golden, format!("{name}, eta {eta}: settings that converge"), converged.len() as f64);
        }
        if form != ThesisForm::Damped {
            // At rest x = 1/a and xm = 1/theta, so (1/theta^2 - 1/a^2)/2 = theta eta/lambda, and theta = 0.95 a at the edge.
            let limit = (1.0 / 0.9025 - 1.0) / (2.0 * 0.95 * p.truth.powi(3));
            let (mut judged, mut right) = (0, 0);
            for (row, eta) in times.iter().zip(ETAS) {
                for (time, lambda) in row.iter().zip(LAMBDAS) {
                    // Slow ones have not arrived after 3 s; within 10 % of the edge is not judged.
                    let fast_and_stable = lambda >= 5.0 && lambda * case.sample_time.si() < 1.0;
                    let ratio = eta / lambda / limit;
                    if fast_and_stable && (ratio - 1.0).abs() > 0.1 {
                        judged += 1;
                        right += usize::from(time.is_finite() == (ratio < 1.0));
                    }
                }
            }
            result.requirements.push(Requirement {
                what: format!("{name}: converges where, and only where, eta/lambda < 0.057/a^3"),
                limit: format!("{judged} of {judged} settings"),
                found: format!("{right} of {judged} settings"),
                met: right == judged,
            });
        }
    }
    result.charts.push(Chart {
        name: "time-to-5-percent".to_owned(),
        title: "Time to 5 % over lambda and eta, law solved at every sample (a = 5, unit step)".to_owned(),
        caption: "The rising edge is the bias theta eta/lambda of printed and reduced law; the right edge is the \
                  stability limit of lambda h at 1 ms. Marked: the reconstructed setting."
            .to_owned(),
        x: Axis::new("lambda", "1/s"),
        columns: 3,
        panels,
    });
    Ok(result)
}
