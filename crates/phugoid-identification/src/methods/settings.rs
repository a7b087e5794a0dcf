//! The settings that all methods take from the model file and the record: priors, noise, biases, sample time, process
//! noise.

use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::levels::NoiseLearning;
use phugoid_estimators::settings::{
    ChangeDetection, ChangePrior, EstimatorSettings, NoiseAdaptation, ParameterPrior, ProcessNoise,
};
use phugoid_flight_data::statistics::median_step;

use super::task::ModelError;
use crate::core::axes::Axes;
use crate::core::error::EstimateError;
use crate::core::options::{EstimateOptions, Opens};
use crate::core::output::Output;
use crate::core::term::{Coefficient, Variable};
use crate::model_file::{Base, LIGHT_TURBULENCE, ModelFile, Parameter, Role};
use crate::motion::Motion;
use crate::preparation::noise::NoiseLevel;
use crate::preparation::prepared::Prepared;

/// The level of a residual where learning begins, over the white noise of its channel. On real flights it ended at 0.5
/// to 260 times that, at 12 in the middle, and it falls faster than it rises.
const START_OVER_WHITE: f64 = 10.0;
/// Density of the process noise of a rate where learning begins, rad^2/s^3: what the moments of a model lack. On foreign flights
/// it ended between 1e-7 and 6e-4, and it is found from above only.
const MODEL_ERROR: f64 = 1e-4;
/// Blocks of the colour correction where noise levels are learnt, s: residuals of real flights are correlated over
/// more than half a second.
const COLOUR_BLOCK_S: f64 = 2.0;

/// Nats at which a change is suspected and adopted where noise levels are learnt: levels follow model error, and with 6
/// and 10 nats, which hold for stated noise, SMPE adopted 47 changes in 214 healthy flights of other aircraft, after
/// which 14 estimates were silently wrong; with these 44 and 7, and 40 of 54 damages were found in place of 41.
const TRIGGER: f64 = 8.0;
const ADOPTION: f64 = 20.0;

/// Settings for a prepared record: the automatic rule with what the model file says. All methods take their settings
/// from here, so that comparisons are fair.
///
/// # Errors
/// [`EstimateError::Settings`] if the estimator refuses them.
pub(super) fn shared_settings<M: Motion<N, R>, const N: usize, const R: usize, const P: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
    options: &EstimateOptions,
    noise: &[NoiseLevel; R],
) -> Result<EstimatorSettings<N, R, P>, EstimateError> {
    let own = file.estimated().filter(|p| !matches!(p.role, Role::Bias(_)));
    let tuned = &file.estimator;
    let priors: Vec<ParameterPrior> = own
        .map(|p| {
            let prior = prior(p, file, options.known_changes.iter().any(|change| change.opens == Opens::Constants));
            ParameterPrior { std: prior.std * if p.is_nuisance() { 1.0 } else { tuned.prior_scale }, ..prior }
        })
        .collect();
    let mut settings = EstimatorSettings::automatic(&priors, noise.map(|n| n.std), sample_time(&prepared.time))
        .map_err(EstimateError::Settings)?;
    // The input of the model says itself whether it is held between samples (`Known::controls_held`).
    settings.input_hold = InputHold::Linear;
    let mut biases = [0.0; R];
    for parameter in file.estimated() {
        if let Role::Bias(output) = parameter.role
            && let Some(row) = M::AXES.row(output)
        {
            biases[row] = parameter.prior_std;
        }
    }
    settings = settings.with_biases(biases);
    settings.reaching_limit = tuned.reaching_limit.unwrap_or(settings.reaching_limit);
    // The limit of rejection must not be below that of reaching.
    settings.rejection_limit = (tuned.rejection_scale * settings.rejection_limit).max(settings.reaching_limit);
    settings.start_window_s = tuned.start_window_s.unwrap_or(settings.start_window_s);
    let states = M::AXES.states();
    let density = std::array::from_fn(|i| {
        states.get(i).map_or(0.0, |o| file.process_noise.density[o.index()] * tuned.process_noise_scale)
    });
    settings.process_noise =
        if file.process_noise.adaptive { ProcessNoise::adaptive(density) } else { ProcessNoise::fixed(density) };
    if let (true, Some(forgetting)) = (file.process_noise.adaptive, tuned.adaptation_gain) {
        settings.process_noise.adaptation = NoiseAdaptation::Score { forgetting };
    }
    let unmeasured = states.iter().enumerate().filter(|(_, state)| !file.outputs[state.index()]);
    for (i, state) in unmeasured.take(N) {
        [settings.initial_state[i], settings.initial_state_std[i]] = unmeasured_start(*state, prepared, file);
    }
    settings.change_detection =
        if options.change_detection.unwrap_or(file.change_detection) { Some(ChangeDetection::default()) } else { None };
    Ok(settings)
}

/// The settings of a filter that learns its noise levels, and the size of an adaptive process noise, in flight.
///
/// The size of the process noise that the file gives decides nothing: airspeed and angles begin with light turbulence, in the shape that is
/// given, and a rate with [`MODEL_ERROR`]. That a state has none, and that it does not adapt, hold as given.
pub(super) fn learning<const N: usize, const R: usize, const P: usize>(
    settings: &EstimatorSettings<N, R, P>,
    axes: Axes,
    noise: &[NoiseLevel; R],
    model_error: ModelError,
) -> EstimatorSettings<N, R, P> {
    let mut own = *settings;
    let mut learning = NoiseLearning::from_white(noise.map(|level| level.white));
    for ((i, state), given) in axes.states().iter().enumerate().zip(settings.process_noise.variance_per_s) {
        learning.slow[i] = is_rate(*state) && model_error == ModelError::Slow;
        learning.shared[i] = !is_rate(*state);
        let usual = if is_rate(*state) { MODEL_ERROR } else { LIGHT_TURBULENCE[state.index()] };
        if given > 0.0 && usual > 0.0 {
            learning.first_scale[i] = usual / given;
        }
    }
    own.noise_learning = Some(learning);
    for (std, level) in own.noise_std.iter_mut().zip(noise) {
        if level.measured {
            *std *= START_OVER_WHITE;
        }
    }
    own.colour_block_s = COLOUR_BLOCK_S;
    if let Some(detection) = &mut own.change_detection {
        detection.trigger = TRIGGER;
        detection.adoption = ADOPTION;
    }
    own
}

fn is_rate(state: Output) -> bool {
    matches!(state, Output::RollRate | Output::PitchRate | Output::YawRate)
}

/// Where a state that nothing measures starts, and one sigma of that: the reference speed, or flight nearly level and straight.
fn unmeasured_start<M: Motion<N, R>, const N: usize, const R: usize>(
    state: Output,
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
) -> [f64; 2] {
    prepared.level_start(state).unwrap_or_else(|| {
        let speed = file.aircraft.reference_speed.unwrap_or(0.0);
        [speed, 0.05 * speed]
    })
}

/// A trim shift that is known of is of the order of what this angle makes by the largest derivative of its coefficient,
/// rad: a trim shift is measured in degrees of surface or angle of attack. A part of the constant itself would say nothing,
/// because where it is zero depends on where angles are counted from.
const TRIM_SHIFT_RAD: f64 = 0.02;

/// What is known of a parameter beforehand. A change of everything, which the detector looks for, keeps the smaller changes of constants:
/// with larger ones more changes are adopted in healthy flights, most of them in the first seconds.
fn prior(parameter: &Parameter, file: &ModelFile, trim_shifts: bool) -> ParameterPrior {
    let [lower, upper] = parameter.bounds.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let quarter = 0.25 * (upper - lower);
    let change_std = match (parameter.change_std, file.base, &parameter.role) {
        _ if parameter.is_nuisance() => ChangePrior::None,
        (Some(std), ..) => ChangePrior::Fixed(std),
        (None, Base::F16 | Base::Aircraft, _) => ChangePrior::Fixed(quarter.min(parameter.prior_std)),
        (None, Base::None, Role::Term(coefficient, term)) if trim_shifts && term.is_constant() => {
            ChangePrior::Fixed(quarter.min(trim_shift(*coefficient, file).unwrap_or(parameter.prior_std)))
        }
        // In absolute form a sudden change is of the order of half the parameter, not of the start prior.
        (None, Base::None, _) => ChangePrior::Relative { fraction: 0.5, maximum: quarter },
    };
    ParameterPrior { initial: parameter.start, std: parameter.prior_std, lower, upper, change_std }
}

/// One sigma of a sudden change of the constant of a coefficient; none where no angle makes that coefficient.
fn trim_shift(coefficient: Coefficient, file: &ModelFile) -> Option<f64> {
    let of_an_angle = |parameter: &&Parameter| match &parameter.role {
        Role::Term(own, term) => *own == coefficient && term.single().is_some_and(is_angle),
        Role::Offset(_) | Role::Bias(_) => false,
    };
    let sizes = file.parameters.iter().filter(of_an_angle).map(|p| p.start.abs().max(p.prior_std));
    sizes.reduce(f64::max).filter(|size| *size > 0.0).map(|size| TRIM_SHIFT_RAD * size)
}

/// Angle of attack, sideslip, or a surface.
fn is_angle(variable: usize) -> bool {
    let angles = [Variable::Alpha, Variable::Beta, Variable::Elevator, Variable::Aileron, Variable::Rudder];
    angles.iter().any(|angle| angle.index() == variable)
}

/// Median of the first fifty intervals, s: later ones must not change what was estimated before them.
pub(super) fn sample_time(time: &[f64]) -> f64 {
    median_step(&time[..time.len().min(51)]).unwrap_or(f64::NAN)
}
