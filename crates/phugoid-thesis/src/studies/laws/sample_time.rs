//! Time to 5 % over lambda h and the sample time: delayed, solved, flagship.

use crate::laws::{Evaluation, ThesisForm};

use super::convergence::{all, one_parameter, simulated_time_to_tolerance, time_map, unknown};
use super::draw::{Record, curves, note, over_grid};
use crate::plant_case::{PlantCase, published_case, run_method, simulate};
use crate::result::Reproduction;
use crate::result::Requirement;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Level, Meaning};
use phugoid_simulation::quantity::Time;

/// `lambda h`, on both sides of 1 (overshoot) and 2 (stability).
const PRODUCTS: [f64; 11] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.9, 1.2, 1.9, 2.3, 2.5];
/// Sample times, s.
const SAMPLE_TIMES: [f64; 6] = [5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2];

/// `laws/sample-time`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let base = published_case("first-order/3")?;
    let p = unknown(&base)?;
    let mut result = Reproduction {
        id: id.to_owned(),
        title: "How the sample time decides the one-parameter law".to_owned(),
        place: "tables 4.1 and 4.2; the thesis names no sample time".to_owned(),
        published: "The laws are derived in continuous time and run in a block diagram.".to_owned(),
        reconstruction: "Plant, bounds and start of case 3 of the first-order plant, unit step, 3 s; lambda follows from \
                         lambda h. The marked setting is the reconstructed one."
            .to_owned(),
        difference: "Solved at every sample the reduced law multiplies the energy difference by 1 - lambda h/(1 + eta/|z|): it \
                     overshoots from lambda h = 1 on and does not converge from 2 on (here 2.05, as eta/|z| = 0.025), whatever \
                     the sample time. The gain makes the printed law faster and its limit lower: the factor is \
                     1 - lambda h/(1 - K theta + eta/|z|), with K theta = 0.75 the limit is 0.55. With a delayed sample the \
                     printed law converges at no setting: the factor of its loop is |z|/eta, 40 here. The flagship has no \
                     lambda; it converges at every sample time."
            .to_owned(),
        ..Reproduction::default()
    };
    let at = |h: f64| -> PlantCase { PlantCase { sample_time: Time::from_si(h), ..base.clone() } };
    // At rest x = u/a = 1/a, so |z| = x^2 = 1/a^2, and K theta = 1 - 1/alpha.
    let damping = base.estimator.eta * p.truth * p.truth;
    let product_at_rest = 1.0 - (p.lower / p.upper).sqrt();
    let laws = [
        ("printed law, delayed", ThesisForm::Printed, Evaluation::Delayed, 0.0),
        ("printed law, solved", ThesisForm::Printed, Evaluation::Implicit, 2.0 * (1.0 - product_at_rest + damping)),
        ("reduced law, solved", ThesisForm::Reduced, Evaluation::Implicit, 2.0 * (1.0 + damping)),
    ];
    let marked = [0.01, 1e-3];
    let mut panels = Vec::new();
    for (k, (name, form, evaluation, limit)) in laws.into_iter().enumerate() {
        let done = |fraction: f64| progress((k as f64 + fraction) / 4.0);
        let times = all(over_grid(&PRODUCTS, &SAMPLE_TIMES, &done, |product, h| {
            let settings = one_parameter(form, evaluation, product / h, base.estimator.eta);
            simulated_time_to_tolerance(&at(h), |_| settings.clone())
        }))?;
        for (row, h) in times.iter().zip(SAMPLE_TIMES) {
            let count = row.iter().filter(|t| t.is_finite()).count();
            note(&mut result.golden, format!("{name}, h = {h} s: settings that converge"), count as f64);
        }
        let (mut judged, mut right) = (0, 0);
        for (time, product) in times.iter().flat_map(|row| row.iter().zip(PRODUCTS)) {
            // Slower ones are judged by laws/lambda-eta: eta biases them, and they have not arrived.
            if product >= 0.1 {
                judged += 1;
                right += usize::from(time.is_finite() == (product < limit));
            }
        }
        result.requirements.push(Requirement {
            what: format!("{name}: of lambda h >= 0.1 converges what is below {limit:.2}, and nothing above"),
            limit: format!("{judged} of {judged} settings"),
            found: format!("{right} of {judged} settings"),
            met: right == judged,
        });
        panels.push(time_map(name, &PRODUCTS, ("sample time", "s", &SAMPLE_TIMES), &times, marked));
    }
    // It has no lambda: one run per sample time, the same for every column.
    let flagship = all(over_grid(&[0.0], &SAMPLE_TIMES, &|f| progress((3.0 + f) / 4.0), |_, h| {
        let case = at(h);
        simulated_time_to_tolerance(&case, |run| case.flagship(run))
    }))?;
    let rows: Vec<Vec<f64>> = flagship.iter().map(|row| PRODUCTS.map(|_| row[0]).to_vec()).collect();
    let slowest = flagship.iter().map(|row| row[0]).fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a });
    result.requirements.push(Requirement {
        what: "flagship: converges at every sample time".to_owned(),
        limit: "within 1.5 s (published for this case)".to_owned(),
        found: format!("within {slowest:.3} s"),
        met: slowest <= 1.5,
    });
    for (row, h) in flagship.iter().zip(SAMPLE_TIMES) {
        note(&mut result.golden, format!("flagship, h = {h} s: time to 5 %, s"), row[0]);
    }
    panels.push(time_map("flagship", &PRODUCTS, ("sample time", "s", &SAMPLE_TIMES), &rows, marked));
    result.charts.push(Chart {
        name: "time-to-5-percent".to_owned(),
        title: "Time to 5 % over lambda h and the sample time (a = 5, unit step)".to_owned(),
        caption: "Solved, the reduced law converges below lambda h = 2 (1 + eta/|z|), the printed one below \
                  2 (1 - K theta + eta/|z|); at small lambda h eta biases both. With a delayed sample the law converges \
                  nowhere. The flagship has no lambda: one time per row. Marked: the \
                  reconstructed setting."
            .to_owned(),
        x: Axis::new("lambda h", "–"),
        columns: 2,
        panels,
    });
    result.charts.push(overshoot(&base, p.truth)?);
    Ok(result)
}

/// The reduced law around the two limits.
fn overshoot(case: &PlantCase, truth: f64) -> Result<Chart, StudyError> {
    let case = PlantCase { duration: Time::from_si(1.0), ..case.clone() };
    let motion = simulate(&case)?;
    let record = Record::new(&motion.time_s);
    let h = case.sample_time.si();
    let mut drawn = Vec::new();
    for (k, product) in [0.1, 0.9, 1.5, 1.9, 2.5].into_iter().enumerate() {
        let settings = one_parameter(ThesisForm::Reduced, Evaluation::Implicit, product / h, case.estimator.eta);
        let estimates = run_method(&case, &motion, &settings)?.estimates.swap_remove(0);
        drawn.push(record.line(format!("lambda h = {product}"), Meaning::Method(k), &estimates));
    }
    Ok(Chart {
        name: "overshoot".to_owned(),
        title: "The reduced law around lambda h = 1 and 2 (h = 1 ms)".to_owned(),
        caption: "Below 1 the estimate approaches from one side, between 1 and 2 it swings about the truth and settles, beyond \
                  2 it swings between the limits of the solver."
            .to_owned(),
        x: Axis::new("Time", "s"),
        columns: 1,
        panels: vec![curves(Axis::new("a", "1/s"), drawn, vec![Level::new("truth", truth, Meaning::Truth)])],
    })
}
