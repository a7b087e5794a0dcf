//! The estimator of a flight in closed loop: which models fit the aircraft that flies, and what their parameters say of it.

use std::collections::VecDeque;

use phugoid_control::interval::Estimate;
use phugoid_control::local::AXES;
use phugoid_control::prediction::Steady;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Controls};
use phugoid_flight_dynamics::built_in::AircraftName;
use phugoid_flight_dynamics::f16::F16Tables;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{Base, ModelFile, ReferenceValue, Role};
use phugoid_identification::session::{LiveParameter, Session};
use phugoid_simulation::aircraft::AnyAircraft;
use phugoid_simulation::scenario::Scenario;

use crate::body::{Body, rectified, whole};
use crate::error::RecoveryError;
use crate::forces::{FELT, Forces, Rigid, forces};
use crate::known::{Declared, Increment, estimate, is_local, parts};
use crate::polar::{Condition, Instant, Polar};
use crate::scale::Scale;
use crate::sensing::Reading;

/// The channels of an [`Instant`].
const INSTANT: [&str; 9] = ["alpha", "beta", "p", "q", "r", "true_airspeed", "elevator", "aileron", "rudder"];
/// Longer than what the controller keeps, s at full size.
const KEPT_S: f64 = 8.0;

/// The estimator of a flight, and what its parameters are of.
pub(crate) struct Learning {
    pub(crate) session: Session,
    /// The aircraft where the parameters are all of its aerodynamics; none where they are increments to the one that flies.
    pub(crate) body: Option<Body>,
    /// What was measured in the last seconds, the newest last.
    flown: VecDeque<Instant>,
    /// What was felt at the same instants.
    felt: VecDeque<[f64; FELT.len()]>,
    /// Mass and thrust of the model file, and the standard deviation that it declares of the constant error of the angle of attack, rad.
    rigid: Rigid,
    vane: f64,
    /// Angles of attack that were measured since the last change, rad.
    alphas: Vec<f64>,
}

impl Learning {
    /// # Errors
    /// [`RecoveryError`]: a model that does not fit the aircraft of the scenario in its `trim`.
    pub(crate) fn new(
        scenario: &Scenario,
        method: Option<Method>,
        model: &ModelFile,
        aircraft: &AnyAircraft,
        trim: &Trim,
    ) -> Result<Self, RecoveryError> {
        let body = if model.base == Base::None {
            let body = Body::of(model).and_then(|body| body.counts_from(trim).map(|()| body));
            Some(body.map_err(|why| RecoveryError::Unsuitable(format!("the model `{}`: {why}", model.name)))?)
        } else {
            fits(scenario, model, aircraft, trim)?;
            None
        };
        let options = EstimateOptions { method, ..EstimateOptions::causal() };
        let kept = (Scale::of(scenario).model_time(KEPT_S) * scenario.sample_rate.si()).clamp(1.0, 1e5) as usize;
        Ok(Self {
            session: Session::new(model, &options)?,
            body,
            flown: VecDeque::with_capacity(kept),
            felt: VecDeque::with_capacity(kept),
            rigid: Rigid::of(&model.aircraft),
            vane: model
                .parameters
                .iter()
                .find(|parameter| parameter.name == "bias_alpha")
                .map_or(Declared::UNSTATED.flow_angle_bias, |bias| bias.prior_std),
            alphas: Vec::new(),
        })
    }

    /// Takes what was measured at a sample.
    pub(crate) fn note(&mut self, reading: &Reading) {
        if self.flown.len() == self.flown.capacity() {
            self.flown.pop_front();
            self.felt.pop_front();
        }
        let felt = FELT.map(|name| reading.channel(name));
        self.rigid.begin(felt[2]);
        self.felt.push_back(felt);
        self.flown.push_back(INSTANT.map(|name| reading.channel(name)));
        self.alphas.push(reading.channel("alpha"));
    }

    /// Forgets what was flown: the aircraft is another one from now on.
    pub(crate) fn forget(&mut self) {
        self.alphas.clear();
    }

    /// Angles of attack that were measured since the last change, rad.
    pub(crate) fn alphas(&self) -> &[f64] {
        &self.alphas
    }

    /// The parameters as estimated last, with their standard errors; none before the first estimate.
    pub(crate) fn parameters(&self) -> Vec<Increment> {
        self.session.snapshot().map_or_else(Vec::new, |snapshot| self.named(&snapshot.parameters))
    }

    /// Whether the model estimates what flying qualities depend on most, in pitch and in roll and yaw: the stability, damping and main
    /// surface of each axis. Of what it does not estimate it says what was known beforehand, whatever has happened to it.
    pub(crate) fn told(&self) -> [bool; 2] {
        const PITCH: &[&str] = &["Cm_alpha", "Cm_q", "Cm_elevator"];
        const LATERAL: &[&str] = &["Cl_p", "Cl_aileron", "Cn_beta", "Cn_r", "Cn_rudder"];
        let parameters = &self.session.layout().parameters;
        let has =
            |name: &&str| parameters.iter().any(|found| found.name.strip_prefix('d').unwrap_or(&found.name) == *name);
        [PITCH, LATERAL].map(|names| names.iter().all(&has))
    }

    fn named(&self, parameters: &[LiveParameter]) -> Vec<Increment> {
        let named = self.session.layout().parameters.iter().zip(parameters);
        let one = named.map(|(layout, parameter)| Increment {
            name: layout.name.clone(),
            value: parameter.value,
            std_error: parameter.std_error,
        });
        one.collect()
    }

    /// The means of the last seconds as if nothing had moved about them, where the model knows what terms that are not linear make of
    /// that. `sample_rate` in Hz, `density` in kg/m^3.
    pub(crate) fn settled(&self, steady: Steady, scale: Scale, sample_rate: f64, density: f64) -> Steady {
        let Some(body) = &self.body else { return steady };
        let rows = (scale.model_time(steady.duration) * sample_rate).round() as usize;
        let first = self.flown.len().saturating_sub(rows);
        let rows: Vec<Instant> = self.flown.range(first..).copied().collect();
        let [mean, error] = rectified(body, &self.parameters(), &rows, density);
        let mut settled = steady;
        for i in 0..AXES {
            settled.accelerations[i] -= scale.acceleration(mean[i]);
            settled.noise[i] = settled.noise[i].hypot(scale.acceleration(error[i]));
        }
        settled
    }

    /// Lift and drag of the last `seconds`, as they were felt and as the estimate gives them; none where too little was measured.
    pub(crate) fn forces(
        &self,
        aircraft: &AnyAircraft,
        trim: &Trim,
        parameters: &[Increment],
        covariance: &[Vec<f64>],
        seconds: f64,
        sample_rate: f64,
    ) -> Option<Forces> {
        let first = self.flown.len().saturating_sub((seconds * sample_rate).round() as usize);
        let flown: Vec<Instant> = self.flown.range(first..).copied().collect();
        let felt: Vec<[f64; FELT.len()]> = self.felt.range(first..).copied().collect();
        let predicted = |at: &Condition| self.polar(aircraft, trim, parameters, at);
        let density = |altitude: f64| aircraft.atmosphere().at(altitude).density;
        forces(&self.rigid, &flown, &felt, &predicted, covariance, &density, self.vane)
    }

    /// Covariance of the parameters: their standard errors with the correlations that the method claims.
    pub(crate) fn covariance(&self, parameters: &[Increment]) -> Option<Vec<Vec<f64>>> {
        let correlation = self.session.correlation()?;
        let line = |(row, one): (&Vec<f64>, &Increment)| {
            row.iter().zip(parameters).map(|(c, other)| c * one.std_error * other.std_error).collect()
        };
        Some(correlation.iter().zip(parameters).map(line).collect())
    }

    /// Lift and drag coefficient at a condition, by the parameters.
    pub(crate) fn polar(&self, aircraft: &AnyAircraft, trim: &Trim, parameters: &[Increment], at: &Condition) -> Polar {
        if let Some(body) = &self.body {
            return body.polar(parameters, at);
        }
        let Condition { flown: [speed, altitude], angles: [alpha, beta], rates, positions } = *at;
        let air = aircraft.atmosphere().at(altitude);
        let [elevator, aileron, rudder] = positions;
        let controls = Controls { elevator, aileron, rudder, ..trim.controls() };
        let data = AirData {
            speed,
            alpha,
            beta,
            density: air.density,
            dynamic_pressure: 0.5 * air.density * speed * speed,
            mach: speed / air.speed_of_sound,
        };
        let known = aircraft.coefficients(&data, rates, &controls);
        let (sine, cosine) = alpha.sin_cos();
        let mut value = [known.cx * sine - known.cz * cosine, -known.cx * cosine - known.cz * sine];
        let [span_time, chord_time] =
            [aircraft.geometry().span, aircraft.geometry().mean_chord].map(|length| length / (2.0 * speed));
        let by_parameter = parameters.iter().map(|increment| {
            let factor = match parts(&increment.name) {
                Some(("CL" | "CD", "0")) => 1.0,
                Some(("CL" | "CD", "beta")) => beta,
                Some(("CL" | "CD", "p")) => rates[0] * span_time,
                Some(("CL" | "CD", "q")) => rates[1] * chord_time,
                Some(("CL" | "CD", "r")) => rates[2] * span_time,
                Some(("CL" | "CD", "alpha")) => alpha - trim.alpha_rad,
                Some(("CL" | "CD", "elevator")) => elevator - trim.elevator_rad,
                Some(("CL" | "CD", "aileron")) => aileron,
                Some(("CL" | "CD", "rudder")) => rudder,
                _ => 0.0,
            };
            let is_drag = increment.name.starts_with("dCD");
            if is_drag { [0.0, factor] } else { [factor, 0.0] }
        });
        let by_parameter: Vec<[f64; 2]> = by_parameter.collect();
        for (increment, by) in parameters.iter().zip(&by_parameter) {
            (0..2).for_each(|k| value[k] += increment.value * by[k]);
        }
        Polar { value, by_parameter }
    }

    /// Mean thrust of the last seconds, N; zero where none was measured.
    fn thrust(&self) -> f64 {
        let (sum, count) = self
            .felt
            .iter()
            .map(|felt| self.rigid.thrust(felt))
            .filter(|thrust| thrust.is_finite())
            .fold((0.0, 0_usize), |(sum, count), thrust| (sum + thrust, count + 1));
        sum / count.max(1) as f64
    }

    /// The local model that parameters make at an airspeed (m/s) and altitude (m).
    pub(crate) fn local(
        &self,
        aircraft: &AnyAircraft,
        trim: &Trim,
        parameters: &[Increment],
        [speed, altitude]: [f64; 2],
    ) -> Estimate {
        let declared = Declared::UNSTATED;
        match &self.body {
            None => estimate(aircraft, trim, parameters, &declared, speed, altitude),
            Some(body) => {
                let density = aircraft.atmosphere().at(altitude).density;
                whole(body, parameters, trim, &declared, speed, density, self.thrust())
            }
        }
    }
}

/// Refuses a model whose parameters are no increments to the aircraft that flies, about the trim that it flies from: they would be
/// read as if they were, and gains and margins would be those of another aircraft.
fn fits(scenario: &Scenario, model: &ModelFile, aircraft: &AnyAircraft, trim: &Trim) -> Result<(), RecoveryError> {
    let refused = |why: String| Err(RecoveryError::Unsuitable(format!("{}: {why}", scenario.name)));
    let unknown = model.parameters.iter().find(|p| matches!(p.role, Role::Term(..)) && !is_local(&p.name));
    if let Some(parameter) = unknown {
        return refused(format!(
            "the model `{}` has the term `{}`, which the local model of a control law does not have: leave it out, or give a model without \
             `base`",
            model.name, parameter.name
        ));
    }
    match (&model.known, model.base) {
        (Some(known), _) => {
            if !is_same(known.aircraft().as_ref(), aircraft, trim) {
                return refused(format!(
                    "the model `{}` is made of increments to {}, and the scenario flies another aircraft, or the same with other options, \
                     loads or centre of gravity: give both the same file and options",
                    model.name,
                    known.file().display()
                ));
            }
        }
        (None, Base::F16) => fits_f16(scenario, model)?,
        (None, _) => return refused(format!("the base of the model `{}` was not read from a file", model.name)),
    }
    counts_from(scenario, model, trim)
}

/// Whether two aircraft have the same motion about a trim.
fn is_same<A: Aircraft, B: Aircraft>(one: &A, other: &B, trim: &Trim) -> bool {
    // Rounding, and the digits of a file.
    const ROUNDING: f64 = 1e-6;
    let of = |found: Estimate| {
        let model = found.model;
        let entries = model.rates.iter().flatten().chain(model.surfaces.iter().flatten()).chain(&model.constant);
        let scalars =
            [model.alpha_by_alpha, model.alpha_by_elevator, model.beta_by_beta, model.beta_by_rudder, model.gravity];
        entries.copied().chain(scalars).collect::<Vec<f64>>()
    };
    let at = [trim.speed_m_s, trim.altitude_m];
    let one = of(estimate(one, trim, &[], &Declared::UNSTATED, at[0], at[1]));
    let other = of(estimate(other, trim, &[], &Declared::UNSTATED, at[0], at[1]));
    one.iter().zip(&other).all(|(a, b)| (a - b).abs() <= ROUNDING * (1.0 + a.abs().max(b.abs())))
}

fn fits_f16(scenario: &Scenario, model: &ModelFile) -> Result<(), RecoveryError> {
    let refused = |why: String| Err(RecoveryError::Unsuitable(format!("{}: {why}", scenario.name)));
    if scenario.aircraft.kind != Some(AircraftName::F16) {
        return refused(format!(
            "the model `{}` is made of increments to the F-16 (`base = \"f16\"`), and the scenario flies another aircraft: give a model of \
             that aircraft, or fly with --control fixed, robust or oracle",
            model.name
        ));
    }
    let (flown, known) = (scenario.aircraft.cg.unwrap_or(0.35), model.aircraft.cg);
    if known != Some(flown) {
        return refused(format!(
            "the centre of gravity is at {flown} of the mean chord, and in the model `{}` at {}: give both the same",
            model.name,
            known.map_or("no stated place".to_owned(), |cg| cg.to_string())
        ));
    }
    if scenario.aircraft.tables.is_some_and(|tables| tables != F16Tables::default()) {
        return refused(format!(
            "the increments of the model `{}` count from the tables of the book: give `tables = \"book\"` under [aircraft]",
            model.name
        ));
    }
    Ok(())
}

/// Refuses increments that count from another trim than that of the flight.
fn counts_from(scenario: &Scenario, model: &ModelFile, trim: &Trim) -> Result<(), RecoveryError> {
    // One per cent of the speed moves the angle of attack of the trim by less than the declared constant error of a vane.
    const SPEED: f64 = 0.01;
    // So do 100 m of altitude, which are one per cent of the density.
    const ALTITUDE: f64 = 100.0;
    // That error, rad.
    const ANGLE: f64 = Declared::UNSTATED.flow_angle_bias;
    let refused = |why: String| Err(RecoveryError::Unsuitable(format!("{}: {why}", scenario.name)));
    let mut is_trim = false;
    let given =
        [("alpha", model.reference.alpha, trim.alpha_rad), ("elevator", model.reference.elevator, trim.elevator_rad)];
    for (name, reference, trim) in given {
        match reference {
            ReferenceValue::Trim => is_trim = true,
            ReferenceValue::Given(value) if (value - trim).abs() <= ANGLE => {}
            ReferenceValue::Given(value) => {
                return refused(format!(
                    "the increments of the model `{}` count {name} from {:.2} deg, and the flight begins at {:.2} deg: give \
                     `{name} = \"trim\"` under [reference] with the speed and altitude of the scenario, or this number",
                    model.name,
                    value.to_degrees(),
                    trim.to_degrees()
                ));
            }
            ReferenceValue::FirstSample => {
                return refused(format!(
                    "the increments of the model `{}` count {name} from the first sample, which noise moves: give `{name} = \"trim\"` \
                     under [reference]",
                    model.name
                ));
            }
        }
    }
    if !is_trim {
        return Ok(());
    }
    let (altitude, known) = (scenario.condition.altitude.si(), model.reference.altitude);
    if known.is_none_or(|known| (known - altitude).abs() > ALTITUDE) {
        return refused(format!(
            "the flight begins at {altitude:.0} m, and the increments of the model `{}` count from a trim at {}: give `altitude` under \
             [reference] that of the scenario",
            model.name,
            known.map_or("no stated altitude".to_owned(), |known| format!("{known:.0} m"))
        ));
    }
    let speed = scenario.condition.speed.si();
    match model.aircraft.reference_speed {
        Some(reference) if (reference / speed - 1.0).abs() <= SPEED => Ok(()),
        reference => refused(format!(
            "the flight begins at {speed:.1} m/s, and the increments of the model `{}` count from a trim at {} m/s: give \
             `reference_speed` the speed of the scenario",
            model.name,
            reference.map_or("no stated speed, in".to_owned(), |reference| format!("{reference:.1}"))
        )),
    }
}
