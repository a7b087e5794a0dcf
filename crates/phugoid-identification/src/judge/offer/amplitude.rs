//! How far each term of the build-up moves during a flight.

use crate::core::output::Output;
use crate::core::term::{FACTORS, Term, Variable};
use crate::methods::{Run, Task};
use crate::model_file::ModelFile;
use crate::motion::Motion;
use crate::preparation::prepare::Prepared;

/// The flight variables that terms are made of, by sample from the first on that has all of them.
pub(super) struct Amplitudes {
    factors: Vec<[f64; FACTORS]>,
}

impl Amplitudes {
    /// From what the estimated model predicted: less noisy than the measurements, and there where nothing measures.
    pub(super) fn of<M: Motion<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>, run: &Run<R>) -> Self {
        let Task { prepared, file, .. } = *task;
        let factors = (0..prepared.time.len()).map(|k| factors(prepared, file, run, k));
        // Where the estimator starts there is no prediction.
        Self { factors: factors.filter(|at| at.iter().all(|v| v.is_finite())).collect() }
    }

    /// Standard deviation of a term over the flight; zero of one that does not move.
    pub(super) fn spread(&self, term: &Term) -> f64 {
        let count = self.factors.len().max(1) as f64;
        let mean = self.factors.iter().map(|at| term.value(at)).sum::<f64>() / count;
        let variance = self.factors.iter().map(|at| (term.value(at) - mean).powi(2)).sum::<f64>() / count;
        variance.sqrt()
    }
}

fn factors<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
    run: &Run<R>,
    k: usize,
) -> [f64; FACTORS] {
    // A state or measured output, else a known input, else nothing of these axes.
    let value = |name: &str| {
        let row = Output::from_name(name).and_then(|output| M::AXES.row(output));
        let known = || prepared.known.iter().find(|s| s.name == name).map_or(0.0, |s| s.values[k]);
        row.map_or_else(known, |row| run.predicted[k][row])
    };
    let reference = &prepared.reference;
    let speed = value("true_airspeed");
    let over_twice_speed = |length: f64| length / (2.0 * speed);
    let span = over_twice_speed(file.aircraft.wing_span.unwrap_or(0.0));
    let mut at = [0.0; FACTORS];
    for variable in Variable::ALL {
        at[variable.index()] = match variable {
            Variable::Alpha => value("alpha") - reference.alpha,
            Variable::Beta => value("beta"),
            Variable::RollRate => value("p") * span,
            Variable::PitchRate => value("q") * over_twice_speed(file.aircraft.mean_chord),
            Variable::YawRate => value("r") * span,
            Variable::Airspeed => speed / file.aircraft.reference_speed.unwrap_or(speed),
            Variable::Elevator => value("elevator") - reference.elevator,
            Variable::Aileron => value("aileron") - reference.aileron,
            Variable::Rudder => value("rudder") - reference.rudder,
            // The rate of alpha is in no candidate: the model takes it to the first power only.
            Variable::AlphaRate => 0.0,
        };
    }
    for (slot, name) in at[Variable::ALL.len()..].iter_mut().zip(&file.extra_inputs) {
        *slot = value(name);
    }
    at
}
