//! What the estimators know of the aircraft of a case.

use phugoid_flight_dynamics::sensors::SensorSpecification;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::output::{CHANNELS, Output};

use super::case::AircraftCase;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::published::{CALM_MODEL, GUST_MODEL};
use phugoid_simulation::scenario::Scenario;

/// The F-16 as the estimators know it: exact tables and mass, the increments of the case with their bounds and start values,
/// and the noise of its sensors; of a sensor without noise the assumed fraction of a realistic one's.
///
/// # Errors
/// [`StudyError::Unsuitable`] where the embedded model does not know an increment of the case.
pub fn model_file(case: &AircraftCase) -> Result<ModelFile, StudyError> {
    let parse = |name: &str, text: &str| ModelFile::parse(name, text).map_err(StudyError::unsuitable);
    let mut model = parse("f16-model", CALM_MODEL)?;
    if case.estimator.gusts {
        model.process_noise = parse("f16-gust-model", GUST_MODEL)?.process_noise;
    }
    model.parameters.retain(|parameter| case.parameters.contains_key(&parameter.name));
    for parameter in &mut model.parameters {
        let Some(settings) = case.parameters.get(&parameter.name) else { continue };
        parameter.bounds = Some([settings.lower, settings.upper]);
        parameter.start = settings.start();
        // The bounds decide the gain: C0 = (R/2)^2, R their half width.
        parameter.prior_std = 0.25 * (settings.upper - settings.lower);
    }
    if let Some((name, _)) = case.unknowns().iter().find(|(name, _)| model.parameters.iter().all(|p| p.name != *name)) {
        return Err(StudyError::Unsuitable(format!("the model `{}` has no increment `{name}`", model.source)));
    }
    for (told, own) in model.noise.iter_mut().zip(sensor_noise(&case.scenario)) {
        *told = if own > 0.0 { Some(own) } else { told.map(|realistic| case.estimator.assumed_noise * realistic) };
    }
    Ok(model)
}

/// One-sigma noise of the scenario's sensors, quantisation included, SI, by [`Output::index`].
pub(crate) fn sensor_noise(scenario: &Scenario) -> [f64; CHANNELS] {
    let sensors = &scenario.sensors;
    Output::ALL.map(|output| {
        let sensor = match output {
            Output::TrueAirspeed => sensors.true_airspeed.specification(),
            Output::Alpha => sensors.alpha.specification(),
            Output::Beta => sensors.beta.specification(),
            Output::Phi => sensors.phi.specification(),
            Output::Theta => sensors.theta.specification(),
            Output::RollRate => sensors.p.specification(),
            Output::PitchRate => sensors.q.specification(),
            Output::YawRate => sensors.r.specification(),
            Output::Ax => sensors.ax.specification(),
            Output::Ay => sensors.ay.specification(),
            Output::Az => sensors.az.specification(),
            Output::PitchAcceleration => sensors.qdot.map(|sensor| sensor.specification()).unwrap_or_default(),
            // No scenario has a sensor of these.
            Output::RollAcceleration | Output::YawAcceleration => SensorSpecification::default(),
        };
        // Rounding to steps of d has a variance of d^2/12.
        sensor.noise.hypot(sensor.quantisation / 12.0_f64.sqrt())
    })
}
