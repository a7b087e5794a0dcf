//! Finds how large an input may be: the input is flown in the simulation and scaled until the strictest limit is met.

use phugoid_flight_data::record::Record;
use serde::Serialize;

use super::{Design, DesignError, Kind, Shape, relative_peak_factor};
use phugoid_simulation::flight::{Flight, FlightError, fly};
use phugoid_simulation::manoeuvre::Manoeuvre;
use phugoid_simulation::quantity::{Frequency, Time};
use phugoid_simulation::scenario::Scenario;

/// How far the aircraft may be moved from its trim. Infinite: no limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Largest deflection of each surface from trim, rad.
    pub deflection: f64,
    /// Largest rate of each surface, rad/s.
    pub surface_rate: f64,
    /// Largest change of the angle of attack from trim, either sign, rad.
    pub alpha: f64,
    /// Largest change of the load factor from trim, either sign, g.
    pub load_factor: f64,
    /// Largest sideslip angle to either side, rad.
    pub beta: f64,
    /// Largest change of the bank angle from the trim, rad.
    pub bank: f64,
}

impl Limits {
    /// # Errors
    /// [`DesignError::Unsuitable`] for a limit that is not positive.
    fn check(&self) -> Result<(), DesignError> {
        let limits = [
            (self.deflection, "deflection"),
            (self.surface_rate, "surface rate"),
            (self.alpha, "angle of attack"),
            (self.load_factor, "load factor"),
            (self.beta, "sideslip"),
            (self.bank, "bank"),
        ];
        match limits.iter().find(|(limit, _)| limit.is_nan() || *limit <= 0.0) {
            Some((limit, what)) => Err(DesignError::Unsuitable(format!(
                "the limit on the {what} is {limit} in SI units: nothing can be flown within it; give a positive one"
            ))),
            None => Ok(()),
        }
    }
}

impl Default for Limits {
    /// Mild manoeuvres that stay in the linear part of most aerodynamics: this project's choice, not a rule of the literature.
    fn default() -> Self {
        Self {
            deflection: 5_f64.to_radians(),
            surface_rate: 60_f64.to_radians(),
            alpha: 3_f64.to_radians(),
            load_factor: 0.5,
            beta: 3_f64.to_radians(),
            bank: 30_f64.to_radians(),
        }
    }
}

/// Largest excursions of a flight from its beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Excursions {
    /// Largest change of the angle of attack, either sign, rad.
    pub alpha: f64,
    /// Largest change of the load factor, either sign, g.
    pub load_factor: f64,
    /// Largest sideslip angle to either side, rad.
    pub beta: f64,
    /// Largest change of the bank angle, either sign, rad.
    pub bank: f64,
}

/// A fitted input and the flight that it makes.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The input with its final size: deflections from trim, rad.
    pub design: Design,
    /// The scenario with this input in place of its manoeuvres.
    pub scenario: Scenario,
    /// The flight that this scenario makes, simulated.
    pub flight: Flight,
    /// Largest excursions of the aircraft in this flight.
    pub excursions: Excursions,
    /// Name of the limit that keeps each surface from moving more, in the order of the inputs.
    pub limited_by: Vec<&'static str>,
}

/// Scales a shape to the largest amplitudes, one per surface, with which the flight of `scenario` stays within `limits`, each
/// surface alone and then all together.
///
/// # Errors
/// [`DesignError`] if a limit is not positive, the scenario cannot be flown, or no amplitude is small enough.
pub fn fitted(shape: &Shape, scenario: &Scenario, limits: &Limits) -> Result<Fitted, DesignError> {
    limits.check()?;
    let h = 1.0 / shape.sample_rate_hz;
    let mut amplitudes = Vec::new();
    let mut limited_by = Vec::new();
    for (k, input) in shape.inputs.iter().enumerate() {
        let mut largest = (limits.deflection, "deflection");
        // Steps are slowed down to the rate; smooth inputs have to be smaller.
        let rate = limits.surface_rate / input.peak_rate(h);
        if !stepped(shape.kind) && rate < largest.0 {
            largest = (rate, "surface rate");
        }
        if !largest.0.is_finite() {
            return Err(DesignError::Unsuitable(
                "an input needs a limit on the deflection of the surface: it cannot be infinite".to_owned(),
            ));
        }
        let alone = |amplitude: f64| {
            let mut amplitudes = vec![0.0; shape.inputs.len()];
            amplitudes[k] = amplitude;
            excess(shape, scenario, limits, &amplitudes)
        };
        let (amplitude, why) = largest_within(largest, &alone)?;
        amplitudes.push(amplitude);
        limited_by.push(why);
    }
    if amplitudes.len() > 1 {
        let together = |part: f64| {
            let scaled: Vec<f64> = amplitudes.iter().map(|a| part * a).collect();
            excess(shape, scenario, limits, &scaled)
        };
        let (part, why) = largest_within((1.0, ""), &together)?;
        if part < 1.0 {
            amplitudes.iter_mut().for_each(|a| *a *= part);
            limited_by.iter_mut().for_each(|word| *word = why);
        }
    }
    at_amplitudes(shape, scenario, limits, &amplitudes, limited_by)
}

/// The input with given amplitudes (rad, one per surface), flown; only the surface rate is kept to.
///
/// # Errors
/// [`DesignError`] if an amplitude is zero or no number, the scenario cannot be flown, or the motion diverges.
pub fn with_amplitudes(
    shape: &Shape,
    scenario: &Scenario,
    limits: &Limits,
    amplitudes: &[f64],
) -> Result<Fitted, DesignError> {
    if amplitudes.len() != shape.inputs.len() {
        let message = format!("{} amplitudes for {} surfaces: give one each", amplitudes.len(), shape.inputs.len());
        return Err(DesignError::Unsuitable(message));
    }
    limits.check()?;
    if let Some(zero) = amplitudes.iter().find(|a| !a.is_finite() || **a == 0.0) {
        let message = format!("an amplitude of {zero} rad moves nothing: give another, or leave that surface out");
        return Err(DesignError::Unsuitable(message));
    }
    let given = vec!["given"; amplitudes.len()];
    at_amplitudes(shape, scenario, limits, amplitudes, given).map_err(|error| match error {
        DesignError::Flight(FlightError::Simulation(error)) => DesignError::Unsuitable(format!(
            "the flight with these amplitudes cannot be simulated: {error}. Give smaller ones"
        )),
        other => other,
    })
}

fn at_amplitudes(
    shape: &Shape,
    scenario: &Scenario,
    limits: &Limits,
    amplitudes: &[f64],
    limited_by: Vec<&'static str>,
) -> Result<Fitted, DesignError> {
    let design = scaled(shape, amplitudes, limits.surface_rate);
    let scenario = playing(scenario, &design);
    let flight = fly(&scenario)?;
    let excursions = excursions(&flight.truth);
    Ok(Fitted { design, scenario, flight, excursions, limited_by })
}

/// The scenario with this input in place of its manoeuvres, as long as the input lasts.
pub fn playing(scenario: &Scenario, design: &Design) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.manoeuvre = design
        .inputs
        .iter()
        .map(|input| Manoeuvre::Samples {
            surface: input.surface,
            rate: Frequency::from_si(design.sample_rate_hz),
            deflection: input.deflection.clone(),
        })
        .collect();
    scenario.duration = Time::from_si(design.time_s.last().copied().unwrap_or(0.0));
    scenario.sample_rate = Frequency::from_si(design.sample_rate_hz);
    scenario
}

fn stepped(kind: Kind) -> bool {
    matches!(kind, Kind::Doublet | Kind::ThreeTwoOneOne)
}

fn scaled(shape: &Shape, amplitudes: &[f64], surface_rate: f64) -> Design {
    let mut design = shape.clone();
    let most = surface_rate / shape.sample_rate_hz;
    for (input, amplitude) in design.inputs.iter_mut().zip(amplitudes) {
        let mut now = 0.0;
        for d in &mut input.deflection {
            let wanted = amplitude * *d;
            now = if stepped(shape.kind) { now + (wanted - now).clamp(-most, most) } else { wanted };
            *d = now;
        }
        if stepped(shape.kind) && *amplitude != 0.0 {
            input.relative_peak_factor = relative_peak_factor(&input.deflection);
        }
    }
    design
}

/// The limit that is exceeded most and by what factor (below one: none).
fn excess(
    shape: &Shape,
    scenario: &Scenario,
    limits: &Limits,
    amplitudes: &[f64],
) -> Result<(f64, &'static str), DesignError> {
    let design = scaled(shape, amplitudes, limits.surface_rate);
    let e = match fly(&playing(scenario, &design)) {
        Ok(flight) => excursions(&flight.truth),
        // Far too much: the motion diverges.
        Err(FlightError::Simulation(_)) => return Ok((f64::INFINITY, "divergence")),
        Err(error) => return Err(error.into()),
    };
    let ratios = [
        (e.alpha / limits.alpha, "angle of attack"),
        (e.load_factor / limits.load_factor, "load factor"),
        (e.beta / limits.beta, "sideslip"),
        (e.bank / limits.bank, "bank"),
    ];
    let worst = ratios.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(worst.unwrap_or((0.0, "")))
}

/// The largest amplitude up to `most` within the limits, to one part in a thousand: regula falsi on a response that is nearly
/// proportional, inside a shrinking bracket.
fn largest_within(
    (most, word): (f64, &'static str),
    excess: &dyn Fn(f64) -> Result<(f64, &'static str), DesignError>,
) -> Result<(f64, &'static str), DesignError> {
    let (mut ratio, mut why) = excess(most)?;
    if ratio <= 1.0 {
        return Ok((most, word));
    }
    let (mut low, mut high, mut trial) = (0.0, most, most);
    for _ in 0..40 {
        if ratio > 1.0 {
            high = trial
        } else {
            low = trial
        }
        if low > 0.0 && (high - low < 1e-3 * high || ratio <= 1.0 && ratio > 0.999) {
            return Ok((low, why));
        }
        let proportional = 0.9995 * trial / ratio;
        trial = if proportional > low && proportional < high { proportional } else { 0.5 * (low + high) };
        let (next, limit) = excess(trial)?;
        ratio = next;
        if next > 0.9 {
            why = limit;
        }
    }
    if low > 0.0 {
        return Ok((low, why));
    }
    Err(DesignError::Unsuitable(format!(
        "no amplitude keeps the flight within the limit on the {why}: the aircraft leaves it without an input, or the limit is zero"
    )))
}

fn excursions(truth: &Record) -> Excursions {
    let most = |name: &str, scale: f64| {
        let values = truth.channel(name).map(|c| c.values.as_slice()).unwrap_or_default();
        let first = values.first().copied().unwrap_or(0.0);
        values.iter().fold(0.0_f64, |most, v| most.max((v - first).abs())) * scale
    };
    Excursions {
        alpha: most("alpha", 1.0),
        load_factor: most("az", 1.0 / 9.80665),
        beta: most("beta", 1.0),
        bank: most("phi", 1.0),
    }
}
