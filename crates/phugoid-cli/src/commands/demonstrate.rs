//! `phugoid` without a command: simulates a flight of the F-16 and estimates its aerodynamic increments.

use std::process::ExitCode;

use phugoid::{estimate_with_progress, simulate};
use phugoid_evaluation::published::{CALM_MODEL, CALM_SCENARIO};
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_report::HtmlOptions;
use phugoid_simulation::scenario::Scenario;

use super::estimate::{History, Presentation};
use crate::arguments::Demonstration;
use crate::failure::{self, Failure};
use crate::progress::Progress;

pub(crate) fn run(arguments: &Demonstration) -> Result<ExitCode, Failure> {
    let mut scenario = Scenario::parse(CALM_SCENARIO, "f16-calm").map_err(Failure::input)?;
    scenario.seed = arguments.seed.unwrap_or(scenario.seed);
    let model = ModelFile::parse("f16-model", CALM_MODEL).map_err(Failure::input)?;
    let flight = simulate(&scenario)?;
    // The truth is only for the comparison that is printed: no estimator sees it.
    let options =
        EstimateOptions { method: arguments.method, truth: flight.true_parameters, ..EstimateOptions::causal() };
    let estimation = {
        let progress = Progress::new("estimating");
        estimate_with_progress(&flight.measured, &model, &options, &mut |done| progress.set(done))
            .map_err(Failure::impossible)?
    };
    let note = format!(
        "A simulated flight: {}, sensor noise of seed {}. The increments to the aerodynamic tables were unknown to the \
         estimator, which took one sample at a time; the truth is shown for comparison. Repeat it with `phugoid --seed {}`.",
        scenario.name, scenario.seed, scenario.seed
    );
    let presentation = Presentation {
        report: Some(arguments.folder()),
        page: HtmlOptions { notes: vec![note], ..HtmlOptions::default() },
        figures: arguments.figures.as_deref(),
        history: &History::None,
        json: arguments.json,
        turned: None,
    };
    presentation.present(&estimation)?;
    Ok(failure::of_result(&estimation))
}
