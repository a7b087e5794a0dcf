//! Many runs of one experiment, each with its own seed.

use std::sync::OnceLock;

use phugoid_identification::stack::STACK_BYTES;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Runs `experiment` for the run numbers `0..runs` on all cores and gives the results in the order of the runs.
///
/// A run must draw its random numbers from its number alone, so that the result is the same on any machine and with
/// any number of cores. `done` is called after each run, from any thread.
///
/// # Errors
/// The first error in the order of the runs; the other runs are made all the same.
///
/// ```
/// use phugoid_evaluation::monte_carlo::monte_carlo;
///
/// let squares = monte_carlo(5, |run| Ok::<_, String>(run * run), || ());
/// assert_eq!(squares, Ok(vec![0, 1, 4, 9, 16]));
/// let failed = monte_carlo(5, |run| if run < 2 { Ok(run) } else { Err(format!("run {run}")) }, || ());
/// assert_eq!(failed, Err("run 2".to_owned()));
/// ```
pub fn monte_carlo<T, E, F, D>(runs: usize, experiment: F, done: D) -> Result<Vec<T>, E>
where
    T: Send,
    E: Send,
    F: Fn(usize) -> Result<T, E> + Sync,
    D: Fn() + Sync,
{
    let all = || -> Vec<Result<T, E>> {
        (0..runs)
            .into_par_iter()
            .map(|run| {
                let result = experiment(run);
                done();
                result
            })
            .collect()
    };
    let results = match workers() {
        Some(workers) => workers.install(all),
        // A system that gives no further threads: the common ones do, but for the largest motions.
        None => all(),
    };
    results.into_iter().collect()
}

/// Threads of their own, one per core.
fn workers() -> Option<&'static ThreadPool> {
    static WORKERS: OnceLock<Option<ThreadPool>> = OnceLock::new();
    WORKERS.get_or_init(|| ThreadPoolBuilder::new().stack_size(STACK_BYTES).build().ok()).as_ref()
}

/// How the errors of one parameter over the runs compare with the bounds.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Accuracy {
    /// Name of the parameter, as in the model file.
    pub name: String,
    /// True value of the parameter, in its unit.
    pub truth: f64,
    /// Cramer-Rao bound: the smallest standard error of an unbiased estimator, in the parameter's unit.
    pub cramer_rao: f64,
    /// Root mean square error over the runs.
    pub rmse: f64,
    /// Mean error over the runs.
    pub bias: f64,
    /// Root mean square of the standard errors that the estimator claims, corrected for the colour of the residuals.
    pub claimed: f64,
    /// Root mean square error divided by the Cramer-Rao bound: 1 for an estimator that cannot be improved.
    pub rmse_over_cramer_rao: f64,
    /// Fraction of the runs in which the truth lies within two claimed standard errors of the estimate.
    pub coverage: f64,
}

/// What one run gave for one parameter.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Outcome {
    /// Estimate of the parameter, in its unit.
    #[serde(with = "crate::exact")]
    pub value: f64,
    /// Claimed standard error, corrected for the colour of the residuals.
    #[serde(with = "crate::exact")]
    pub corrected_std_error: f64,
}

impl Accuracy {
    /// Compares the outcomes of many runs with the truth and the bound. Without outcomes all means are zero; a NaN
    /// among them makes the means NaN.
    ///
    /// ```
    /// use phugoid_evaluation::monte_carlo::{Accuracy, Outcome};
    ///
    /// // Two runs that are wrong by +1 and -1, of which one claims too small an error.
    /// let runs = [(6.0, 1.0), (4.0, 0.4)];
    /// let runs = runs.map(|(value, corrected_std_error)| Outcome { value, corrected_std_error });
    /// let accuracy = Accuracy::of("Cm_alpha", 5.0, 0.5, &runs);
    /// assert_eq!((accuracy.bias, accuracy.rmse, accuracy.rmse_over_cramer_rao), (0.0, 1.0, 2.0));
    /// assert_eq!(accuracy.coverage, 0.5); // the second run's two standard errors are 0.8
    /// ```
    pub fn of(name: &str, truth: f64, cramer_rao: f64, outcomes: &[Outcome]) -> Self {
        let mean = |f: &dyn Fn(&Outcome) -> f64| outcomes.iter().map(f).sum::<f64>() / outcomes.len().max(1) as f64;
        let rmse = mean(&|o| (o.value - truth).powi(2)).sqrt();
        Self {
            name: name.to_owned(),
            truth,
            cramer_rao,
            rmse,
            bias: mean(&|o| o.value - truth),
            claimed: mean(&|o| o.corrected_std_error.powi(2)).sqrt(),
            rmse_over_cramer_rao: rmse / cramer_rao,
            coverage: mean(&|o| f64::from((o.value - truth).abs() <= 2.0 * o.corrected_std_error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn results_come_in_the_order_of_the_runs_whatever_thread_made_them() {
        let count = AtomicUsize::new(0);
        let results: Vec<usize> =
            monte_carlo(100, |run| Ok::<_, ()>(run * run), || _ = count.fetch_add(1, Ordering::Relaxed)).unwrap();
        assert_eq!(results, (0..100).map(|r| r * r).collect::<Vec<_>>());
        assert_eq!(count.into_inner(), 100);
        assert_eq!(monte_carlo(10, |run| if run > 3 { Err(run) } else { Ok(run) }, || ()), Err(4));
    }

    #[test]
    fn accuracy_of_known_errors() {
        let outcomes = [1.5, 0.5, 1.0, 1.0]
            .map(|value| Outcome { value, corrected_std_error: if value > 1.2 { 0.2 } else { 0.3 } });
        let a = Accuracy::of("a", 1.0, 0.25, &outcomes);
        assert!((a.rmse - 0.125_f64.sqrt()).abs() < 1e-15 && a.bias == 0.0);
        assert!((a.rmse_over_cramer_rao - 2.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(a.coverage, 0.75);
    }
}
