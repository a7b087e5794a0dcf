//! The flights of the detection study: every one has its own aircraft, damage, stick, air and sensors, all from its seed.

use phugoid_flight_dynamics::increments::Increments;
use phugoid_identification::model_file::{ModelFile, Role};
use phugoid_identification::output::Output;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::conditions::{Air, Stick};
use crate::accuracy::StudyError;
use phugoid_simulation::flight::{Flight, FlightError, fly};
use phugoid_simulation::manoeuvre::{Manoeuvre, Surface};
use phugoid_simulation::quantity::{Acceleration, Angle, AngularRate, Frequency, Quantity, Speed, Time};
use phugoid_simulation::scenario::{Damage, Scenario, Sensor, Sensors, Spectrum, Turbulence};

/// Parameters before and after the damage lie within this part of the half width of their bounds.
const SHARE_OF_BOUNDS: f64 = 0.6;
/// Outliers per channel, their size in standard deviations, and dropped frames where everything comes together.
const OUTLIERS: f64 = 0.03;
const OUTLIER_SIZE: f64 = 20.0;
const DROPS: f64 = 0.02;
/// Largest gust intensity there, m/s (4 ft/s: light turbulence).
const LARGEST_GUST: f64 = 4.0 * 0.3048;
/// Aircraft drawn at most for one flight; many fall out of the sky without a control system.
const DRAWS: u64 = 200;
/// A flight is used if it is held throughout and stays this close to its trim: angle of attack (rad), airspeed (fraction).
const ALPHA: f64 = 10.0 * std::f64::consts::PI / 180.0;
const AIRSPEED: f64 = 0.25;

/// What is to be flown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Order {
    pub(super) stick: Stick,
    pub(super) air: Air,
    /// Constant errors of the sensors, of the sizes that the model file expects.
    pub(super) biases: bool,
    pub(super) duration_s: f64,
    pub(super) damage_at_s: Option<f64>,
}

/// A flight with what the study has to know of it.
pub(super) struct Drawn {
    pub(super) flight: Flight,
    pub(super) scenario: Scenario,
    /// By estimated term, in the model's order: before and after the damage.
    pub(super) before: Vec<f64>,
    pub(super) after: Vec<f64>,
}

impl Drawn {
    /// True values of the estimated terms at a time (s): the increments with what the error of the model amounts to at the trim.
    pub(super) fn truth(&self, model: &ModelFile, time_s: f64) -> Vec<f64> {
        let truth = self.flight.true_parameters_at(time_s);
        let terms = model.estimated().filter(|p| !p.is_nuisance());
        terms.map(|p| truth.get(&p.name).copied().unwrap_or(f64::NAN)).collect()
    }
}

/// Flies an order. Aircraft that leave the neighbourhood of their trim are drawn again. `alter` adds errors of the model.
pub(super) fn flown(
    base: &Scenario,
    model: &ModelFile,
    order: &Order,
    seed: u64,
    alter: &dyn Fn(&mut Scenario),
) -> Result<Drawn, StudyError> {
    for attempt in 0..DRAWS {
        let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_mul(DRAWS).wrapping_add(attempt));
        let mut scenario = Scenario { seed, ..base.clone() };
        scenario.duration = Time::from_si(order.duration_s);
        let (before, after) = (increments(model, &mut random), increments(model, &mut random));
        scenario.increments = before.0;
        scenario.damage = match order.damage_at_s {
            Some(at) => vec![Damage::sudden(Time::from_si(at), after.0)],
            None => Vec::new(),
        };
        scenario.manoeuvre = stick(order, &mut random);
        sensors(&mut scenario.sensors, model, order, &mut random);
        air(&mut scenario, order, &mut random);
        alter(&mut scenario);
        match fly(&scenario) {
            Ok(flight) if stays(&flight) => {
                let after = if order.damage_at_s.is_some() { after.1 } else { before.1.clone() };
                return Ok(Drawn { flight, scenario, before: before.1, after });
            }
            Ok(_) | Err(FlightError::Simulation(_)) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Err(StudyError::Unsuitable(format!("seed {seed}: none of {DRAWS} aircraft stays near its trim")))
}

/// Uniform within the middle part of the declared bounds, in the order of the model.
fn increments(model: &ModelFile, random: &mut Pcg64Mcg) -> (Increments, Vec<f64>) {
    let mut increments = Increments::NONE;
    let mut values = Vec::new();
    for parameter in model.estimated().filter(|p| !p.is_nuisance()) {
        let [low, high] = parameter.bounds.unwrap_or([0.0; 2]);
        let uniform = 2.0 * random.random::<f64>() - 1.0;
        let value = 0.5 * (low + high) + SHARE_OF_BOUNDS * 0.5 * (high - low) * uniform;
        if let Some(increment) = increments.longitudinal_mut(&parameter.name) {
            *increment = value;
        }
        values.push(value);
    }
    (increments, values)
}

/// A pilot's random stick, or a 3-2-1-1 every ten seconds from half a second on.
fn stick(order: &Order, random: &mut Pcg64Mcg) -> Vec<Manoeuvre> {
    let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let surface = Surface::Elevator;
    match order.stick {
        Stick::Pilot => vec![Manoeuvre::Pilot {
            surface,
            start: Time::from_si(0.0),
            rms: Angle::from_si(between(0.5, 1.1).to_radians()),
            bandwidth: Frequency::from_si(between(0.35, 0.7)),
            seed: 0,
        }],
        Stick::ThreeTwoOneOne => {
            let (unit, size) = (between(0.45, 0.75), between(1.0, 2.0).to_radians());
            let sign = if between(-1.0, 1.0) < 0.0 { -1.0 } else { 1.0 };
            (0..)
                .map(|k| 0.5 + 10.0 * f64::from(k))
                .take_while(|start| *start < order.duration_s)
                .map(|start| Manoeuvre::ThreeTwoOneOne {
                    surface,
                    start: Time::from_si(start),
                    unit: Time::from_si(unit),
                    amplitude: Angle::from_si(sign * size),
                })
                .collect()
        }
    }
}

fn sensors(sensors: &mut Sensors, model: &ModelFile, order: &Order, random: &mut Pcg64Mcg) {
    let disturbed = order.air == Air::Everything;
    let mut biases = [0.0; 6];
    for (bias, output) in biases.iter_mut().zip(Output::ALL) {
        let one_sigma =
            model.estimated().find(|p| matches!(p.role, Role::Bias(o) if o == output)).map_or(0.0, |p| p.prior_std);
        let normal: f64 = StandardNormal.sample(random);
        *bias = if order.biases { one_sigma * normal } else { 0.0 };
    }
    let [speed, alpha, theta, q, ax, az] = biases;
    set(&mut sensors.true_airspeed, Speed::from_si(speed), disturbed);
    set(&mut sensors.alpha, Angle::from_si(alpha), disturbed);
    set(&mut sensors.theta, Angle::from_si(theta), disturbed);
    set(&mut sensors.q, AngularRate::from_si(q), disturbed);
    set(&mut sensors.ax, Acceleration::from_si(ax), disturbed);
    set(&mut sensors.az, Acceleration::from_si(az), disturbed);
    sensors.drops = if disturbed { DROPS } else { 0.0 };
}

fn set<Q: Quantity>(sensor: &mut Sensor<Q>, bias: Q, disturbed: bool) {
    sensor.bias = bias;
    (sensor.outliers, sensor.outlier_size) = if disturbed { (OUTLIERS, OUTLIER_SIZE) } else { (0.0, 0.0) };
}

fn air(scenario: &mut Scenario, order: &Order, random: &mut Pcg64Mcg) {
    let sigma = LARGEST_GUST * random.random::<f64>();
    scenario.turbulence = (order.air == Air::Everything).then(|| Turbulence {
        intensity: None,
        spectrum: Spectrum::Dryden,
        sigma: Some(Speed::from_si(sigma)),
        rates: false,
    });
}

fn stays(flight: &Flight) -> bool {
    let trim = &flight.trim;
    let within = |name: &str, middle: f64, most: f64| {
        flight.truth.channel(name).is_some_and(|c| c.values.iter().all(|v| (v - middle).abs() <= most))
    };
    flight.held_until_s().is_infinite()
        && within("alpha", trim.alpha_rad, ALPHA)
        && within("true_airspeed", trim.state().speed, AIRSPEED * trim.state().speed)
}
