//! How many damages are recovered with which control.

use phugoid_control::qualities::Level;
use phugoid_evaluation::ledger::{Ledger, recorded};
use phugoid_evaluation::statistics::quantile;
use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::Scenario;
use serde::{Deserialize, Deserializer, Serialize};

use crate::draw::{Class, DAMAGE_AT_S, classes, damaged};
use crate::flight::{Control, Event, Kind, RecoveryError, RecoveryFlight, Settings, fly};

/// What one control made of the damages of one class, or of all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The class; none for all together.
    pub class: Option<Class>,
    /// The control.
    pub control: Control,
    /// Number of flights.
    pub flights: usize,
    /// Flights in which the motion left the aircraft's data or turned over.
    pub departed: usize,
    /// Flights that ended in level flight.
    pub level_flight: usize,
    /// Flights that ended in level flight with level-1 flying qualities ...
    pub level_one: usize,
    /// ... and with level 1 or 2.
    pub recovered: usize,
    /// Flights that the same damage with fixed gains did not end in level flight with level 1 or 2, and this one did.
    pub saved: usize,
    /// Flights that ended so with fixed gains and not with this control.
    pub made_worse: usize,
    /// Time from the damage to new gains, s: half of the flights with new gains were faster; NaN without any.
    pub latency_median_s: f64,
    /// The same for nine flights of ten.
    pub latency_90_percent_s: f64,
    /// Flights with new gains after the damage.
    pub with_new_gains: usize,
    /// Flights whose gains changed before the damage, to those in reserve or to others: without a reason.
    pub without_reason: usize,
    /// Flights that did not depart and whose control knows an estimate at the end ...
    pub with_estimate: usize,
    /// ... and in which it gives the true level of flying qualities ...
    pub level_right: usize,
    /// ... or a better level than the true one.
    pub level_too_good: usize,
    /// Margins of surfaces that are in use in these flights, three each at most ...
    pub margins: usize,
    /// ... whose true trim position lies within two standard errors of the estimated one.
    pub margins_covered: usize,
}

/// The study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoveryStudy {
    /// Name of the scenario that damages were put into.
    pub scenario: String,
    /// Seed of the first damage; damage `i` has this plus `i`.
    pub first_seed: u64,
    /// Number of damages.
    pub damages: usize,
    /// One row per control, all classes together first.
    pub rows: Vec<Row>,
    /// Every flight, in the order of the damages.
    pub flights: Vec<Short>,
}

/// One flight in short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Short {
    /// Seed of the damage.
    pub seed: u64,
    /// What was damaged.
    pub damage: String,
    /// The first class of it.
    pub class: Class,
    /// The control.
    pub control: Control,
    /// The motion left the aircraft's data or turned over.
    pub departed: bool,
    /// It ended in level flight.
    pub level_flight: bool,
    /// Level of flying qualities of the true aircraft with the last gains.
    pub level: Level,
    /// Time from the damage to new gains, s.
    pub latency_s: Option<f64>,
    /// Gains changed before the damage, to those in reserve or to others.
    pub early: bool,
    /// The level of the motion that the last estimate gives, as [`level`](Self::level) is that of the true motion; none without an estimate
    /// or after a departure.
    pub estimated_level: Option<Level>,
    /// Differences of the trim positions of the surfaces in use from the true ones, in standard errors; not a number where the
    /// estimate claims none.
    #[serde(deserialize_with = "with_nulls")]
    pub margin_errors: Vec<f64>,
}

/// JSON has `null` for a number that is none.
fn with_nulls<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    let numbers = Vec::<Option<f64>>::deserialize(deserializer)?;
    Ok(numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
}

impl Short {
    fn is_recovered(&self) -> bool {
        self.level_flight && self.level <= Level::Two
    }
}

/// A scenario with the damage of one number of a study with this first seed in it, so that it can be flown by itself.
///
/// # Errors
/// [`RecoveryError::Flight`]: the scenario cannot be flown.
pub fn damage(base: &Scenario, number: usize, first_seed: u64) -> Result<Scenario, RecoveryError> {
    let (aircraft, trim) = trimmed_aircraft(base)?;
    Ok(numbered(base, aircraft.as_ref(), &trim, number, first_seed.wrapping_add(number as u64)))
}

/// The class of a damage follows from its number, and what it is from its seed.
fn numbered<A: Aircraft>(base: &Scenario, aircraft: &A, trim: &Trim, number: usize, seed: u64) -> Scenario {
    damaged(base, aircraft, trim, &classes(number, seed), seed)
}

/// Flies `damages` random damages ([`classes`]), each with every control. Settings but for the control are those
/// given. `ledger` is told of each damage, from any thread, and may keep the flights with it; it has to know the scenario and the
/// model.
///
/// # Errors
/// [`RecoveryError`]: the base scenario cannot be flown, or the model does not fit it.
pub fn recovery(
    base: &Scenario,
    model: &ModelFile,
    settings: &Settings,
    damages: usize,
    first_seed: u64,
    ledger: &dyn Ledger,
) -> Result<RecoveryStudy, RecoveryError> {
    let (aircraft, trim) = trimmed_aircraft(base)?;
    let one = |run: usize| -> Result<Vec<Short>, RecoveryError> {
        let seed = first_seed.wrapping_add(run as u64);
        let class = classes(run, seed).first().copied().unwrap_or(Class::Stability);
        let scenario = numbered(base, aircraft.as_ref(), &trim, run, seed);
        Control::ALL
            .into_iter()
            .map(|control| {
                let flight = fly(&scenario, &Settings { control, ..*settings }, model)?;
                let gains = || flight.events.iter().filter(|event| event.kind == Kind::NewGains);
                let after = gains().find(|event| event.time_s >= DAMAGE_AT_S);
                Ok(Short {
                    seed,
                    damage: scenario.name.clone(),
                    class,
                    control,
                    departed: flight.outcome.departed,
                    level_flight: flight.outcome.level_flight,
                    level: flight.outcome.level,
                    latency_s: after.map(|event| event.time_s - DAMAGE_AT_S),
                    early: flight.events.iter().any(|event| is_change_of_gains(event) && event.time_s < DAMAGE_AT_S),
                    estimated_level: flight.left.filter(|_| !flight.outcome.departed).and_then(|left| left.motion),
                    margin_errors: margin_errors(&flight),
                })
            })
            .collect()
    };
    let name = |run: usize| format!("damage {run}, seed {}", first_seed.wrapping_add(run as u64));
    let flights = recorded(damages, &format!("recovery: {settings:?}"), name, one, ledger)?;
    let all = std::iter::once(None).chain(Class::ALL.into_iter().map(Some));
    let rows = all.flat_map(|class| {
        let flights = &flights;
        Control::ALL.into_iter().enumerate().map(move |(index, control)| row(flights, class, index, control))
    });
    let rows = rows.collect();
    let flights = flights.into_iter().flatten().collect();
    Ok(RecoveryStudy { scenario: base.name.clone(), first_seed, damages, rows, flights })
}

/// Gains of an estimate, or those in reserve.
fn is_change_of_gains(event: &Event) -> bool {
    matches!(event.kind, Kind::NewGains | Kind::Reserve)
}

fn margin_errors(flight: &RecoveryFlight) -> Vec<f64> {
    let Some(left) = flight.left.filter(|_| !flight.outcome.departed) else { return Vec::new() };
    let pairs = left.margins.iter().zip(&flight.truly_left.margins);
    let errors = pairs.filter(|(margin, _)| margin.is_used);
    errors.map(|(margin, truth)| (margin.trim - truth.trim) / margin.std_error).collect()
}

fn row(flights: &[Vec<Short>], class: Option<Class>, index: usize, control: Control) -> Row {
    // Fixed gains are the first control.
    let of_class = || {
        flights
            .iter()
            .filter_map(|all| Some((all.first()?, all.get(index)?)))
            .filter(|(_, flight)| class.is_none_or(|class| class == flight.class))
    };
    let count = |is: &dyn Fn(&Short, &Short) -> bool| of_class().filter(|(fixed, flight)| is(fixed, flight)).count();
    let latencies: Vec<f64> = of_class().filter_map(|(_, flight)| flight.latency_s).collect();
    Row {
        class,
        control,
        flights: of_class().count(),
        departed: count(&|_, flight| flight.departed),
        level_flight: count(&|_, flight| flight.level_flight),
        level_one: count(&|_, flight| flight.level_flight && flight.level == Level::One),
        recovered: count(&|_, flight| flight.is_recovered()),
        saved: count(&|fixed, flight| !fixed.is_recovered() && flight.is_recovered()),
        made_worse: count(&|fixed, flight| fixed.is_recovered() && !flight.is_recovered()),
        with_new_gains: latencies.len(),
        latency_median_s: quantile(latencies.clone(), 0.5),
        latency_90_percent_s: quantile(latencies, 0.9),
        without_reason: count(&|_, flight| flight.early),
        with_estimate: count(&|_, flight| flight.estimated_level.is_some()),
        level_right: count(&|_, flight| flight.estimated_level == Some(flight.level)),
        level_too_good: count(&|_, flight| flight.estimated_level.is_some_and(|level| level < flight.level)),
        margins: of_class().map(|(_, flight)| flight.margin_errors.len()).sum(),
        margins_covered: of_class()
            .map(|(_, flight)| flight.margin_errors.iter().filter(|error| error.abs() <= 2.0).count())
            .sum(),
    }
}
