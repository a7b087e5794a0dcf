//! Where output error has airspeed, flow angles and attitude from: a simulation, or the measurement.

use super::task::Task;
use crate::batch::{BatchError, BatchFit, Bias, InitialState, Manoeuvre, Structure, with_outputs};
use crate::core::axes::Axes;
use crate::core::options::{CAPACITY, FlowAngles};
use crate::core::output::Output;
use crate::motion::MotionModel;
use crate::preparation::air_data::{AirData, smoothed};
use crate::preparation::prepared::Prepared;

/// A fit with the air data that were chosen.
pub(super) struct WithAirData<const N: usize, const R: usize> {
    pub(super) fit: BatchFit,
    /// What was unknown with them.
    pub(super) structure: Structure<N, R>,
    /// The outputs by manoeuvre and sample, if flow angles were taken from them: without the noise of their vanes where that could be
    /// told from gusts, and then airspeed and attitude were taken from them too.
    pub(super) flown: Option<Vec<Vec<[f64; R]>>>,
}

/// Output error with airspeed and flow angles from where the options ask for; `searched` finds its minimum from all starts.
/// `further`: the records of all manoeuvres but the first, which is that of the task. Costs with simulated and with measured air
/// data are of different outputs and are not compared.
pub(super) fn with_air_data<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    (manoeuvres, further): (&[Manoeuvre<'_, N, R>], &[Prepared<M, N, R>]),
    structure: Structure<N, R>,
    searched: impl Fn(&[Manoeuvre<'_, N, R>], &Structure<N, R>) -> Result<BatchFit, BatchError>,
) -> Result<WithAirData<N, R>, BatchError> {
    let outputs = M::AXES.outputs();
    let known = |row: &usize| manoeuvres.iter().all(|m| m.outputs.iter().any(|y| y[*row].is_finite()));
    let rows = |wanted: &[Output]| -> Vec<usize> {
        (0..N).filter(|row| wanted.contains(&outputs[*row])).filter(known).collect()
    };
    let names = |rows: &[usize]| match rows.iter().map(|&row| outputs[row].name()).collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    };
    let angles = rows(&[Output::Alpha, Output::Beta]);
    let simulated =
        || Ok(WithAirData { fit: searched(manoeuvres, &structure)?, structure: structure.clone(), flown: None });
    let clean: Option<Vec<AirData<R>>> = match task.options.flow_angles {
        FlowAngles::Simulated => None,
        FlowAngles::Auto | FlowAngles::Measured => {
            let of = |prepared| smoothed(prepared, task.file.aircraft.gravity, structure.maximum_gap_s);
            std::iter::once(task.prepared).chain(further).map(of).collect()
        }
    };
    let gusts = clean.iter().flatten().filter_map(|one| one.gusts).reduce(f64::max);
    let measured = |why: &str| {
        // The attitude makes nothing but rates of airspeed and flow angles, which are not integrated then, and is itself the
        // integral of the rates with all that gusts do to them.
        let (rows, how) = match clean {
            Some(_) => (
                rows(&[Output::TrueAirspeed, Output::Alpha, Output::Beta, Output::Phi, Output::Theta]),
                ", airspeed and flow angles without the noise that accelerations, rates and attitude tell from gusts",
            ),
            None => (angles.clone(), ""),
        };
        let flown: Vec<Vec<[f64; R]>> = match &clean {
            Some(clean) => clean.iter().map(|one| one.outputs.clone()).collect(),
            None => manoeuvres.iter().map(|m| m.outputs.to_vec()).collect(),
        };
        let mut following = structure.clone();
        for &row in &rows {
            following.states[row] = InitialState::measured(outputs[row].name());
            following.outputs[row].bias = Bias::None;
        }
        let mut fit = searched(&with_outputs(manoeuvres, &flown), &following)?;
        for &row in &rows {
            fit.noise_std[row] = task.noise[row].std;
        }
        fit.notes.push(format!("{} taken as measured and not fitted{how}{why}", names(&rows)));
        Ok(WithAirData { fit, structure: following, flown: Some(flown) })
    };
    // The residuals of the simulated angles over the noise of their vanes, the largest of them.
    let above = |fit: &BatchFit| {
        let ratio = |row: &usize| fit.noise_std[*row] / task.noise[*row].std;
        angles.iter().map(ratio).fold(0.0, f64::max)
    };
    let by_residuals = |above: f64| {
        format!(
            "the residuals of a simulation are {above:.1} times their noise, as gusts or an error of the model make them"
        )
    };
    let warned = |mut found: WithAirData<N, R>| {
        let above = above(&found.fit);
        if above > CALM_RESIDUALS {
            found.fit.notes.push(format!(
                "{} simulated: {}. Output error has no gusts in it, so that its errors and bounds are often several times \
                 those of a method that has: compare with --method filter-error",
                names(&angles),
                by_residuals(above)
            ));
        }
        found
    };
    match (task.options.flow_angles, gusts) {
        _ if angles.is_empty() => simulated(),
        (FlowAngles::Simulated, _) => simulated().map(warned),
        (FlowAngles::Measured, _) => measured(""),
        (FlowAngles::Auto, Some(gusts)) => {
            let sigmas = if gusts < SMALL_NOISE { format!("{gusts:.1}") } else { format!("more than {SMALL_NOISE}") };
            let why = format!(
                ": gusts, or a sensor that is late, change the angles by {sigmas} sigmas of the noise of their vanes in a second"
            );
            measured(&why).or_else(|failure| {
                let mut found = simulated().map(warned)?;
                found.fit.notes.push(format!(
                    "{} simulated though the air is not calm: with their measured values there is no fit ({failure})",
                    names(&angles)
                ));
                Ok(found)
            })
        }
        (FlowAngles::Auto, None) => {
            let found = simulated();
            let why = match found.as_ref().ok().map(|found| above(&found.fit)) {
                None => "a simulation of them found no minimum".to_owned(),
                // With the noise of its vane a measured angle of attack bends Cm_q more than gusts do, the sideslip nothing as much.
                Some(above) if above > CALM_RESIDUALS && clean.is_none() && M::AXES == Axes::LateralDirectional => {
                    by_residuals(above)
                }
                Some(_) => return found.map(warned),
            };
            measured(&format!(": {why}")).or(found.map(warned))
        }
    }
}

/// From there on next to no noise was found.
const SMALL_NOISE: f64 = 100.0;

/// Residuals of a simulated flow angle over the noise of its vane from which on something is missing in the simulation. They are at
/// most 1.25 on the calm lateral flights of the field's develop part, and at least 1.5 in light turbulence.
const CALM_RESIDUALS: f64 = 1.3;
