//! Which condition decides what becomes of a method, in numbers.

use crate::laws::{Evaluation, LawSign, ThesisForm};
use phugoid_estimators::{LinearizedRates, Model};

use super::format::PlantCase;
use super::method::{Method, MethodRun};
use super::plant::{ROOM, Visit};
use super::simulate::PlantRun;

/// `z = dD/dtheta = sum y Phi`, the slope of each surface by its own parameter, along the true motion: `[parameter][sample]`.
///
/// With the true parameter and a model on its plant (`D = E = 0`) the derivative of the printed law by the estimate on its
/// right hand side is `|z|/eta`: evaluated with a delay of one sample, this is the factor by which an error grows.
pub fn slopes(case: &PlantCase, run: &PlantRun) -> Vec<Vec<f64>> {
    case.plant.visit(Slopes { case, run })
}

struct Slopes<'a> {
    case: &'a PlantCase,
    run: &'a PlantRun,
}

impl Visit for Slopes<'_> {
    type Output = Vec<Vec<f64>>;

    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync,
    {
        let mut truth = [0.0; ROOM];
        for (slot, (_, parameter)) in truth.iter_mut().zip(self.case.unknowns()) {
            *slot = parameter.truth;
        }
        let mut slopes = vec![Vec::with_capacity(self.run.time_s.len()); self.case.unknowns().count()];
        let mut lin = LinearizedRates::<N, ROOM>::ZERO;
        for k in 0..self.run.time_s.len() {
            let x: [f64; N] = std::array::from_fn(|i| self.run.states[i][k]);
            let input: [f64; I] = std::array::from_fn(|i| self.run.inputs[k][i]);
            model.linearized_rates(&x, &truth, &input, &mut lin);
            for (j, series) in slopes.iter_mut().enumerate() {
                series.push((0..N).map(|i| x[i] * lin.regressors[i][j]).sum());
            }
        }
        slopes
    }
}

fn fraction(values: &[f64], holds: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|v| holds(**v)).count() as f64 / values.len().max(1) as f64
}

fn lambda_h(case: &PlantCase, lambda: f64) -> String {
    let product = lambda * case.sample_time.si();
    let verdict = match product {
        p if p < 1.0 => "< 1, no overshoot",
        p if p < 2.0 => "< 2, overshoots",
        _ => ">= 2, unstable",
    };
    format!("lambda h = {product:.3} ({verdict})")
}

/// The growth of an error per sample with a delay in the loop.
fn loop_gain(slopes: &[f64], eta: f64) -> String {
    let gains: Vec<f64> = slopes.iter().map(|z| z.abs() / eta).collect();
    format!(
        "with the delay an error grows by |z|/eta per sample: by up to {:.1e}, and by more than 1 at {:.0} % of the samples",
        gains.iter().fold(0.0, |a: f64, g| a.max(*g)),
        100.0 * fraction(&gains, |g| g > 1.0)
    )
}

/// The condition that decides what became of a method, as a sentence with its numbers.
pub(super) fn condition(case: &PlantCase, run: &PlantRun, method: &Method, result: &MethodRun) -> String {
    match method {
        Method::Flagship { noise_std } => flagship(case, run, noise_std, result),
        Method::OneParameter { form, evaluation, sign, lambda, eta } => {
            let slopes = slopes(case, run);
            let z = slopes.first().map_or(&[][..], Vec::as_slice);
            let mut parts = vec![lambda_h(case, *lambda)];
            let wrong = fraction(z, |z| z > 0.0);
            match sign {
                LawSign::AsPrinted if wrong > 0.0 => {
                    parts.push(format!("z > 0 at {:.0} % of the samples, against the printed sign", 100.0 * wrong));
                }
                LawSign::AsPrinted => parts.push("z < 0 throughout, as the printed sign needs it".to_owned()),
                LawSign::FromSlope => {}
            }
            match evaluation {
                Evaluation::Delayed => parts.push(loop_gain(z, *eta)),
                Evaluation::Implicit => {
                    if result.unsolved > 0 {
                        let part = 100.0 * result.unsolved as f64 / run.time_s.len() as f64;
                        parts.push(format!(
                            "no solution of the loop at {part:.1} % of the samples: the last estimate stands"
                        ));
                    }
                    parts.push(rest(*form, *lambda, *eta, result));
                }
            }
            parts.join("; ")
        }
        Method::TwoParameter { form, evaluation, lambda, eta, .. } => {
            let mut parts = vec![rank(run, result)];
            match evaluation {
                Evaluation::Delayed => {
                    // The derivative of both laws by both estimates is (z1 z2; z1 z2)/eta: eigenvalues 0 and (z1 + z2)/eta.
                    let z = slopes(case, run);
                    let sum: Vec<f64> = (0..run.time_s.len()).map(|k| z.iter().map(|z| z[k]).sum()).collect();
                    parts.push(loop_gain(&sum, *eta));
                }
                Evaluation::Implicit => {
                    parts.extend(unsolved(run, result));
                    parts.push(lambda_h(case, lambda[0].max(lambda[1])));
                    if *form == ThesisForm::Printed {
                        parts.push(ratio(case, *lambda, result));
                    }
                }
            }
            parts.join("; ")
        }
        Method::Extended { reaching_time_s, .. } => {
            let [largest, smallest] = result.information.last().copied().unwrap_or([f64::NAN; 2]);
            let unknowns = case.unknowns().count();
            format!(
                "rank {} of {unknowns} at the end: the accumulated equations have eigenvalues of {largest:.1e} and {smallest:.1e}; from \
                 bound to bound in {reaching_time_s} s",
                if smallest > 1e-12 * largest { unknowns } else { 1 }
            )
        }
    }
}

/// Where `D` vanishes and `k_i F` is small beside `eta`, the printed law reads `a_i eta = lambda_i F`.
fn ratio(case: &PlantCase, lambda: [f64; 2], result: &MethodRun) -> String {
    let end = |j: usize| result.estimates.get(j).and_then(|e| e.last()).copied().unwrap_or(f64::NAN);
    let truth: Vec<f64> = case.unknowns().map(|(_, p)| p.truth).collect();
    let truth = truth.first().zip(truth.get(1)).map_or(f64::NAN, |(first, second)| first / second);
    format!(
        "where D = 0 the law reads a_i eta = lambda_i F and rests with a1/a2 = lambda1/lambda2 = {:.2}, whatever the plant: \
         {:.2} at the end, truth {truth:.2}",
        lambda[0] / lambda[1],
        end(0) / end(1)
    )
}

fn unsolved(run: &PlantRun, result: &MethodRun) -> Option<String> {
    let part = 100.0 * result.unsolved as f64 / run.time_s.len() as f64;
    (result.unsolved > 0)
        .then(|| format!("no solution of the loop at {part:.1} % of the samples: the last estimate stands"))
}

/// Rank of what both surfaces say of both parameters, at the same instant.
fn rank(run: &PlantRun, result: &MethodRun) -> String {
    let deficient =
        result.information.iter().filter(|[larger, smaller]| !(larger.is_finite() && *smaller > 1e-9 * larger)).count();
    let part = 100.0 * deficient as f64 / run.time_s.len() as f64;
    format!("rank 1 of 2 at {part:.0} % of the samples: s1' - s2' = (lambda1 - lambda2) F contains no parameter")
}

/// Where an implicit law rests at the end of the record, against what its equation says.
fn rest(form: ThesisForm, lambda: f64, eta: f64, result: &MethodRun) -> String {
    let found = result.surfaces.first().and_then(|s| s.energy.last()).copied().unwrap_or(f64::NAN);
    let theta = result.estimates.first().and_then(|e| e.last()).copied().unwrap_or(f64::NAN);
    match form {
        ThesisForm::Damped => format!("at rest where E = 0, without bias: E = {found:.2e} at the end"),
        ThesisForm::Printed | ThesisForm::Reduced => format!(
            "eta moves the rest from E = 0 to |E| = |theta| eta/lambda = {:.2e}: |E| = {:.2e} at the end",
            theta.abs() * eta / lambda,
            found.abs()
        ),
    }
}

fn flagship(case: &PlantCase, run: &PlantRun, noise_std: &[f64], result: &MethodRun) -> String {
    let told: Vec<String> = noise_std.iter().map(|std| format!("{std:.1e}")).collect();
    let origin = if run.noise_std > 0.0 { "the true noise" } else { "noise (there is none, it needs some)" };
    let claims: Vec<String> = case
        .unknowns()
        .enumerate()
        .filter_map(|(j, (name, p))| {
            let published = case.published.converged_after.get(name)?.si();
            let k = run.time_s.partition_point(|&t| t <= published).saturating_sub(1);
            let error = result.std_error.as_ref()?.get(j)?.get(k)?;
            Some(format!("{name} {:.1e}", error / p.truth.abs()))
        })
        .collect();
    let told = format!("the information in the record decides: told {origin} of {}", told.join(" and "));
    if claims.is_empty() {
        return told;
    }
    format!("{told}; it claims as one-sigma error at the published time, as a part of the truth: {}", claims.join(", "))
}
