//! The terminal view of `phugoid live --tui`.

use phugoid_live::run::{Audience, LiveError, Summary};
use phugoid_live::stop::Stop;

use crate::failure::Failure;

/// Runs an estimation with the terminal view as one of its listeners.
#[cfg(feature = "tui")]
pub(crate) fn run(
    estimate: impl FnOnce(Box<dyn Audience>) -> Result<Summary, LiveError> + Send,
    stop: &Stop,
) -> Result<Result<Summary, LiveError>, Failure> {
    let (listener, documents) = phugoid_live::tui::channel();
    std::thread::scope(|scope| {
        let flight = scope.spawn(move || estimate(Box::new(listener)));
        // The screen is given back before anything else is said.
        let shown = phugoid_live::tui::run(&documents, stop);
        let summary = flight.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        shown.map_err(|error| Failure::input(format!("--tui needs a terminal: {error}")))?;
        Ok(summary)
    })
}

/// An input error that says how to build the program with the terminal view.
#[cfg(not(feature = "tui"))]
pub(crate) fn run(
    _: impl FnOnce(Box<dyn Audience>) -> Result<Summary, LiveError> + Send,
    _: &Stop,
) -> Result<Result<Summary, LiveError>, Failure> {
    Err(Failure::input(
        "this program was built without the terminal view: build it with `--features tui`, or open the page of the dashboard",
    ))
}
