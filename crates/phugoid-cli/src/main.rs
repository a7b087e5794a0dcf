//! The `phugoid` command.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod arguments;
mod commands;
mod destination;
mod failure;
mod output;
mod progress;

use std::process::ExitCode;

use clap::Parser;

use crate::arguments::{Arguments, Command};

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return failure::of_command_line(&error),
    };
    if let Err(failure) = destination::check(&arguments) {
        return failure.report();
    }
    let estimated = |result: Result<ExitCode, failure::Failure>| result.unwrap_or_else(|failure| failure.report());
    let result = match &arguments.command {
        None => return estimated(commands::demonstrate::run(&arguments.demonstration)),
        Some(Command::Trim(arguments)) => commands::trim::run(arguments),
        Some(Command::Linearize(arguments)) => commands::linearize::run(arguments),
        Some(Command::ExportFmu(arguments)) => commands::export_fmu::run(arguments),
        Some(Command::Check(arguments)) => match commands::check::run(arguments) {
            Ok(false) => return ExitCode::from(failure::REFUSED),
            other => other.map(|_| ()),
        },
        Some(Command::Simulate(arguments)) => commands::simulate::run(arguments),
        Some(Command::Inspect(arguments)) => commands::inspect::run(arguments),
        Some(Command::Init(arguments)) => commands::init::run(arguments),
        Some(Command::Estimate(arguments)) => return estimated(commands::estimate::run(arguments)),
        Some(Command::Monitor(arguments)) => match commands::monitor::run(arguments) {
            Ok(true) => return ExitCode::from(failure::DIVERGED),
            other => other.map(|_| ()),
        },
        Some(Command::Regress(arguments)) => commands::regress::run(arguments),
        Some(Command::Fly(arguments)) => commands::fly::run(arguments),
        Some(Command::Study(arguments)) => commands::study::run(arguments),
        Some(Command::Field(arguments)) => commands::field::run(arguments),
        #[cfg(feature = "fleet")]
        Some(Command::Fleet(arguments)) => commands::fleet::run(arguments),
        #[cfg(feature = "fleet")]
        Some(Command::Campaign(arguments)) => commands::campaign::run(arguments),
        Some(Command::Compare(arguments)) => commands::compare::run(arguments),
        Some(Command::Reproduce(arguments)) => commands::reproduce::run(arguments),
        Some(Command::Tune(arguments)) => commands::tune::run(arguments),
        Some(Command::Design(arguments)) => commands::design::run(arguments),
        Some(Command::Compatibility(arguments)) => commands::compatibility::run(arguments),
        Some(Command::View(arguments)) => commands::view::run(arguments),
        Some(Command::Live(arguments)) => commands::live::run(arguments),
        Some(Command::Completions(arguments)) => commands::completions::completions(arguments),
        Some(Command::Man(arguments)) => commands::completions::man(arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
