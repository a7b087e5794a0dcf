//! Why a batch estimation could not be made.

/// Why a batch estimation could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// The arguments contradict each other or are out of range; the sentence says which.
    #[error("{0}")]
    BadInput(String),
    /// The simulation is not finite at the start values, or one damped step away from every accepted point.
    #[error(
        "{manoeuvre}: the simulation with the start values diverges {time_s:.3} s after its first sample. Start nearer \
         (equation error gives start values), or cut the manoeuvre; for an unstable aircraft take filter error, which follows the \
         measurements; where that diverges, look for wild values in the record, or take equation error, which does not integrate"
    )]
    Diverged {
        /// Name of the manoeuvre, e.g. its file.
        manoeuvre: String,
        /// Time of the first value that is not finite, s from the start of the manoeuvre.
        time_s: f64,
    },
    /// A free simulation of an unstable model did not lead to a minimum.
    #[error(
        "{manoeuvre}: the model is unstable with the start values: an error of the initial state grows {growth:.0} times \
         during the manoeuvre. Output error integrates freely and found no minimum. Take filter error or equation error, \
         which hold on to the measurements; or start from the result of equation error; or cut the manoeuvre"
    )]
    Unstable {
        /// Name of the manoeuvre, e.g. its file.
        manoeuvre: String,
        /// By how much the error grows, each state in units of its own range during the manoeuvre.
        growth: f64,
    },
    /// The data do not determine a combination of the unknowns: changing them together moves no output.
    #[error("{}", singular(culprits))]
    Singular {
        /// The unknowns of the combination, the strongest first, with their share: a step by these amounts together,
        /// each in its own unit, does not move the outputs.
        culprits: Vec<(String, f64)>,
    },
    /// The iteration ended without reaching the minimum.
    #[error(
        "no convergence after {iterations} iterations: the next step would still be {step:.3e} standard errors long \
         (wanted: {tolerance:.1e}). Start nearer, fix what the data cannot tell, or allow more iterations"
    )]
    NotConverged {
        /// Number of accepted steps.
        iterations: usize,
        /// Length of the next Gauss-Newton step in standard errors.
        step: f64,
        /// Length that would have been accepted:
        /// [`OptimiserSettings::acceptable_step`](super::OptimiserSettings::acceptable_step).
        tolerance: f64,
    },
}

fn singular(culprits: &[(String, f64)]) -> String {
    match culprits {
        [(name, _)] => format!(
            "{name} does not move any measured output in these data: fix it, give it a prior, or fly an input that \
             excites it"
        ),
        _ => {
            let names: Vec<&str> = culprits.iter().map(|(name, _)| name.as_str()).collect();
            let amounts: Vec<String> = culprits.iter().map(|(name, by)| format!("{name} by {by:+.3e}")).collect();
            format!(
                "{} cannot be told apart in these data: changing {} together leaves every output as it is. Fix one of \
                 them, give it a prior, or fly a manoeuvre that moves them differently",
                names.join(" and "),
                amounts.join(", ")
            )
        }
    }
}
