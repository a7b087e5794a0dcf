//! Data compatibility: do the measurements of a flight agree with the kinematics of a rigid body, and with which errors
//! of the sensors do they?
//!
//! The kinematic equations, driven by accelerometers and rate gyroscopes, give airspeed, flow angles and attitude
//! without any aerodynamics (Klein & Morelli, chapter 10; Jategaonkar, chapter 10). An extended Kalman filter follows
//! them: the noise of the inertial sensors moves the states, gusts move the air, and what remains is the work of biases,
//! scale factors, delays and positions, which are the maximum of the likelihood of its innovations. The levels of noise
//! and turbulence are found with them. Each unknown has a wide prior; an error that the data do not determine stays at
//! its prior, and the result says so.

mod choice;
mod corrected;
mod correction;
mod filter;
mod gravity;
mod kinematics;
mod levels;
mod offer;
mod reconstruction;
mod signals;
mod skew;
mod solve;
mod unknowns;

use serde::{Deserialize, Deserializer, Serialize};

use phugoid_flight_data::record::Record;

use crate::batch::OutputFit;
use crate::core::error::EstimateError;
use crate::preparation::checks::doubts_of;
use choice::Choice;
pub use choice::{HeldError, unknown_names};
pub use corrected::estimate_corrected;
pub use correction::{ChannelCorrection, CorrectionUncertainty, Corrections};
use filter::Levels;
use kinematics::{PARAMETERS, place};
pub use reconstruction::Reconstructed;
use signals::Flight;
pub(crate) use signals::differentiated;
pub use skew::{InputSkew, input_skew};
use solve::{Column, Solution, impossible, solve};
pub use unknowns::Group;
use unknowns::{Spec, UNKNOWNS};

/// Which errors of the sensors a compatibility check estimates, and what is known of the installation.
#[derive(Clone, Debug, PartialEq)]
pub struct CompatibilityOptions {
    /// Groups of errors that are estimated in addition to the biases, which always are.
    pub groups: Vec<Group>,
    /// Names of the only unknowns that are estimated, in place of the biases and the groups; `None` goes by the groups. What
    /// is not named is taken for zero. Valid names are those of [`unknown_names`].
    pub unknowns: Option<Vec<String>>,
    /// Names of unknowns that are not estimated although their group is; they are taken for zero.
    pub without: Vec<String>,
    /// Errors that are known, and held at their values instead of being estimated. They become part of the corrections, and
    /// are taken for exact.
    pub held: Vec<HeldError>,
    /// Known distance of the vanes of alpha and beta ahead of the centre of gravity, m.
    pub vanes_x: [f64; 2],
    /// Acceleration of gravity at the place of the flight, m/s^2, positive, where it is known to 0.001 m/s^2. `None`:
    /// from the latitude and altitude of the record, as far as it has them, and uncertain for what is not known.
    pub gravity: Option<f64>,
    /// Whether the flight comes from a simulator over a flat Earth that does not turn. Over the round one an aircraft that
    /// flies straight on turns with the horizon, by `V/R`: 0.0018 degrees per second at 200 m/s.
    pub flat_earth: bool,
    /// Further records of the same installation: the errors of the sensors are the same in all, while gravity, wind and
    /// the levels of noise and turbulence belong to each.
    pub further: Vec<Record>,
}

impl Default for CompatibilityOptions {
    /// Biases, scale factors of the air data and the attitude, and delays; vanes at the centre of gravity; gravity from
    /// the record; no further records.
    fn default() -> Self {
        Self {
            groups: vec![Group::AirDataScales, Group::AttitudeScales, Group::Delays],
            unknowns: None,
            without: Vec::new(),
            held: Vec::new(),
            vanes_x: [0.0; 2],
            gravity: None,
            flat_earth: false,
            further: Vec::new(),
        }
    }
}

/// The estimate of one error of the sensors, with its standard error and a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensorError {
    /// Name of the unknown, e.g. `bias_alpha`, `scale_true_airspeed` or `delay_attitude`.
    pub name: String,
    /// SI unit, `-` for a pure number.
    pub unit: String,
    /// Estimate, in `unit`; NaN (null in JSON) where it is refused.
    #[serde(deserialize_with = "number_or_null")]
    pub value: f64,
    /// One-sigma error, corrected for the colour of the innovations; NaN where the estimate is refused.
    #[serde(deserialize_with = "number_or_null")]
    pub std_error: f64,
    /// One sigma of what was expected beforehand.
    pub prior_std: f64,
    /// How many standard errors the estimate is away from zero: `|value| / std_error`; NaN where it is refused.
    #[serde(deserialize_with = "number_or_null")]
    pub significance: f64,
    /// Whether the data show this error.
    pub verdict: SensorVerdict,
    /// By how much this error makes samples more likely to which it was not fitted, in natural logarithms of the
    /// likelihood (nats): positive where it helps. NaN where it is refused, or the flight is shorter than six seconds.
    #[serde(default = "nan", deserialize_with = "number_or_null")]
    pub held_out_gain: f64,
    /// True if the error is among the corrections that are offered.
    #[serde(default)]
    pub offered: bool,
    /// Why it is refused, or why no correction is offered for an error that is significant.
    #[serde(default)]
    pub reason: Option<String>,
}

fn nan() -> f64 {
    f64::NAN
}

fn number_or_null<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// What an estimated error of a sensor means for the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorVerdict {
    /// More than two standard errors from zero.
    Significant,
    /// The data determine it, and it is not different from zero: nothing has to be corrected.
    None,
    /// The manoeuvre says little beyond what was expected beforehand: the error is still above 0.7 of the prior's.
    NotIdentifiable,
    /// No sensor has such an error: something else is wrong with the channel, and there is no estimate.
    Refused,
}

impl SensorVerdict {
    /// The verdict in words, as reports show it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Significant => "significant",
            Self::None => "none found",
            Self::NotIdentifiable => "not identifiable from this manoeuvre",
            Self::Refused => "refused",
        }
    }
}

/// The result of a compatibility check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compatibility {
    /// Source of the record, e.g. its file name.
    pub source: String,
    /// The unknowns that were estimated, in the order of the parameters of the kinematic model.
    pub errors: Vec<SensorError>,
    /// The errors that were held at known values, as [`CompatibilityOptions::held`] gives them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<HeldError>,
    /// The corrections that are offered: apply them with [`Corrections::apply`].
    pub corrections: Corrections,
    /// How the reconstructed outputs, errors of the sensors included, follow the measured ones.
    pub fit: Vec<OutputFit>,
    /// Acceleration of gravity that the first record asks for, m/s^2, and its one-sigma error.
    pub gravity: [f64; 2],
    /// One sigma of the gusts along body x, y and z in the first record, m/s; zero where nothing shows them.
    pub gusts: [f64; 3],
    /// Times of the samples in [`reconstructed`](Self::reconstructed), s.
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// The motion at the centre of gravity in the first record that follows from all sensors and their estimated errors.
    #[serde(skip)]
    pub reconstructed: Vec<Reconstructed>,
    /// Warnings about the result in sentences; read them before you use the numbers.
    pub notes: Vec<String>,
}

impl Compatibility {
    /// The estimated error with this name; `None` if it was not estimated.
    pub fn error(&self, name: &str) -> Option<&SensorError> {
        self.errors.iter().find(|e| e.name == name)
    }

    /// The reconstructed channel of this name: what was true, without the errors of its sensor.
    pub fn channel(&self, name: &str) -> Option<&Reconstructed> {
        self.reconstructed.iter().find(|c| c.name == name)
    }
}

/// A correction is offered from this many standard errors on: of the fifteen and more unknowns of a flight, one is
/// beyond two by chance.
const OFFERED: f64 = 3.0;

/// What the turning Earth alone can add to a gyroscope, rad/s: no error of the sensor.
const EARTH_RATE: f64 = 7.3e-5;

/// Checks the kinematic consistency of a record and estimates the errors of its sensors.
///
/// Needs the channels `true_airspeed`, `theta`, `q`, `ax` and `az`; `alpha` and all lateral ones are used where they
/// are there. Without `alpha` the angle of attack is reconstructed from the rest. After gaps of the inertial sensors the
/// motion begins anew; outliers count little.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::compatibility::{CompatibilityOptions, SensorVerdict, compatibility};
/// let mut flight = Record::open("examples/flight.csv")?;
/// for channel in flight.channels.iter_mut().filter(|channel| channel.name == "q") {
///     channel.values.iter_mut().for_each(|q| *q += 0.01); // a rate gyroscope with a constant error, rad/s
/// }
/// // Only constant errors are looked for: no scale factors and no delays.
/// let options = CompatibilityOptions { groups: Vec::new(), ..CompatibilityOptions::default() };
/// let result = compatibility(&flight, &options)?;
/// let bias = result.error("bias_q").ok_or("not estimated")?;
/// assert_eq!(bias.verdict, SensorVerdict::Significant);
/// assert!((bias.value - 0.01).abs() < 0.001, "{bias:?}");
/// let corrected = result.corrections.apply(&flight);
/// assert!((flight.require("q")?.values[0] - corrected.require("q")?.values[0] - bias.value).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EstimateError`]: a missing channel, too few samples, or no minimum; an unknown that is named wrongly or that no record
/// can show.
pub fn compatibility(record: &Record, options: &CompatibilityOptions) -> Result<Compatibility, EstimateError> {
    let records = std::iter::once(record).chain(&options.further);
    // A sign or a unit is no error of a sensor, and a bias that takes its place would hide it.
    let is_used = |name: &str| UNKNOWNS.iter().any(|unknown| unknown.channel == name);
    let mut doubtful = Vec::new();
    for record in records.clone() {
        let doubts = doubts_of(record, &is_used)?;
        doubtful.extend(doubts.iter().map(|doubt| format!("{}: {doubt}", record.source)));
    }
    let mut flights = records
        .map(|record| Flight::of(record, options.gravity, options.flat_earth))
        .collect::<Result<Vec<Flight>, EstimateError>>()?;
    let mut notes = std::mem::take(&mut flights[0].notes);
    for (flight, record) in flights.iter_mut().zip(std::iter::once(record).chain(&options.further)).skip(1) {
        notes.extend(flight.notes.drain(..).map(|note| format!("{}: {note}", record.source)));
    }
    for record in std::iter::once(record).chain(&options.further) {
        let deleted = record.quality.deletions.iter().flat_map(|deleted| deleted.sentences());
        notes.extend(deleted.map(|words| format!("{}: {words}", record.source)));
    }
    notes.extend(doubtful);
    let choice = Choice::of(options, &flights)?;
    notes.extend(choice.notes.iter().cloned());
    let (solution, refused) = possible_solution(&flights, columns(&flights, &choice), choice.fixed)?;
    let errors = errors(&solution, &refused, is_gusty(&flights, &solution));
    notes.extend(confused(&solution));
    let (reconstructed, fit) = reconstruction::reconstruct(&flights[0], 0, &solution);
    let first = &flights[0];
    let own = solution.columns.iter().position(|c| c.place == place::GRAVITY && c.flight == Some(0));
    let gravity = own.map_or([first.gravity.value, first.gravity.std], |i| {
        [first.gravity.value + solution.values[i], solution.corrected[(i, i)].sqrt()]
    });
    let gusts = std::array::from_fn(|i| {
        if first.active.contains(&(kinematics::BODY + i)) { solution.levels[0].gusts[i] } else { 0.0 }
    });
    let held: Vec<(&str, f64)> = choice.held.iter().map(|held| (held.name.as_str(), held.value)).collect();
    Ok(Compatibility {
        source: record.source.clone(),
        corrections: Corrections::of(&errors, &solution, &held),
        errors,
        held: choice.held,
        fit,
        gravity,
        gusts,
        time_s: record.time.clone(),
        reconstructed,
        notes,
    })
}

/// The unknowns of the flights together: those of the sensors are the same in all.
fn columns(flights: &[Flight], choice: &Choice) -> Vec<Column> {
    let mut columns = Vec::new();
    for (place, spec) in UNKNOWNS.iter().enumerate() {
        let shown = |flight: &Flight| moves(spec, flight) && flight.has(spec.channel);
        if !choice.estimated[place] || !flights.iter().any(shown) {
            continue;
        }
        if spec.group.is_none_or(|group| group == Group::Wind) {
            for (f, flight) in flights.iter().enumerate().filter(|(_, flight)| shown(flight)) {
                let prior_std = if place == self::place::GRAVITY { flight.gravity.std } else { spec.prior_std };
                if prior_std > 0.0 {
                    let considered = (self::place::GUST_BY_FORCE..PARAMETERS).contains(&place);
                    columns.push(Column { place, flight: Some(f), prior_std, considered });
                }
            }
        } else {
            columns.push(Column { place, flight: None, prior_std: spec.prior_std, considered: false });
        }
    }
    columns
}

/// Whether a flight has the motion that an unknown needs. What is measured along or about an axis in which the motion is
/// not followed says nothing.
fn moves(spec: &Spec, flight: &Flight) -> bool {
    match spec.name {
        "bias_p" | "bias_r" | "scale_p" | "scale_r" | "bias_phi" | "scale_phi" => flight.active.contains(&3),
        "bias_ay" | "scale_ay" | "bias_beta" | "scale_beta" | "delay_beta" | "vane_beta_x" => {
            flight.active.contains(&1)
        }
        "gust_by_ay" => flight.active.contains(&10),
        "gust_by_az" => flight.active.contains(&11),
        "bias_psi" => flight.active.contains(&5),
        "wind_north" | "wind_east" | "wind_down" => flight.active.contains(&6) && flight.active.contains(&8),
        _ => true,
    }
}

/// By how much twice the negative logarithm of a likelihood may lie above that of another minimum: searches end within
/// that of theirs.
const WORSE: f64 = 1.0;

/// An unknown without an estimate, and why.
struct Refused {
    place: usize,
    reason: String,
}

/// The solution in which every unknown is possible: the others are taken out one by one, the wildest first.
fn possible_solution(
    flights: &[Flight],
    mut columns: Vec<Column>,
    fixed: [f64; PARAMETERS],
) -> Result<(Solution, Vec<Refused>), EstimateError> {
    let mut refused = Vec::new();
    // Scales and delays of the air data and gusts explain each other, and with both to be found at once a search may end
    // where a scale of a fifth and gusts that are not there make up for one another: all else comes first.
    let late = |column: &Column| goes_with_gusts(column.place);
    let early: Vec<Column> = columns.iter().filter(|column| !late(column)).cloned().collect();
    let mut plain = None;
    let mut from = None;
    if early.len() < columns.len() {
        let solution = solve(flights, early, fixed, None)?;
        from = Some(beginning(&columns, &solution));
        plain = Some(solution);
    }
    loop {
        let mut solution = solve(flights, columns.clone(), fixed, from.take())?;
        if let Some(plain) = plain.as_ref().filter(|plain: &&Solution| solution.cost > plain.cost + WORSE) {
            // The search has gone past the better minimum, in which the scale that is furthest off is zero.
            let far = |i: &usize| (solution.values[*i] / solution.columns[*i].prior_std).abs();
            let scales = (0..solution.columns.len()).filter(|i| late(&solution.columns[*i]));
            if let Some(worst) = scales.max_by(|a, b| far(a).total_cmp(&far(b))) {
                let place = solution.columns[worst].place;
                refused.push(Refused {
                    place,
                    reason: format!(
                        "the search for it ends at {:.3}, where the flight is less likely than with none: gusts pass for \
                         an error of `{}`",
                        solution.values[worst], UNKNOWNS[place].channel
                    ),
                });
                columns.remove(worst);
                from = Some(beginning(&columns, plain));
                continue;
            }
        }
        let excess = |i: &usize| {
            let [least, most] = UNKNOWNS[solution.columns[*i].place].possible;
            let value = solution.values[*i];
            (value - most).max(least - value) / (most - least)
        };
        let Some(worst) = impossible(&solution).into_iter().max_by(|a, b| excess(a).total_cmp(&excess(b))) else {
            let Some((worst, length)) = solution.open else {
                if let Some(plain) = &plain {
                    by_likelihood(&mut solution, plain.cost);
                }
                return Ok((solution, refused));
            };
            let spec = &UNKNOWNS[solution.columns[worst].place];
            if spec.group.is_none() {
                return Err(EstimateError::Model(format!(
                    "data compatibility: the search does not end (the next step of {} is {length:.1} standard errors)",
                    spec.name
                )));
            }
            refused.push(Refused {
                place: solution.columns[worst].place,
                reason: format!(
                    "the search for it does not end: its next step would be {length:.1} standard errors. The flight \
                     moves `{}` too little, or in turbulence only",
                    spec.channel
                ),
            });
            columns.remove(worst);
            from = Some((without(&solution.values, worst), solution.levels));
            continue;
        };
        let spec = &UNKNOWNS[solution.columns[worst].place];
        let [least, most] = spec.possible;
        let unit = if spec.unit == "-" { String::new() } else { format!(" {}", spec.unit) };
        let (value, channel) = (solution.values[worst], spec.channel);
        let is_early = spec.unit == "s" && value < least;
        refused.push(Refused {
            place: solution.columns[worst].place,
            reason: if is_early {
                format!(
                    "the flight asks for {value:.3} s, and nothing is recorded before it happens: `{channel}` is held against the rate \
                     gyros and the accelerometers, and these are probably late. Look at their clock and filters"
                )
            } else {
                format!(
                    "the flight asks for {value:.3}{unit}, and no sensor has less than {least}{unit} or more than {most}{unit}: \
                     look at `{channel}` itself, its unit, its clock and its filters"
                )
            },
        });
        columns.remove(worst);
        from = Some((without(&solution.values, worst), solution.levels));
    }
}

/// Scales and delays of the air data: what a gust does to the forces on the aircraft resembles what these errors do.
fn goes_with_gusts(place: usize) -> bool {
    UNKNOWNS[place].group == Some(Group::AirDataScales) || (place::DELAY_SPEED..place::DELAY_ATTITUDE).contains(&place)
}

/// Whether the gusts of a flight are larger than the noise of a sensor that sees them.
fn is_gusty(flights: &[Flight], solution: &Solution) -> bool {
    flights.iter().zip(&solution.levels).any(|(flight, levels)| {
        // Airspeed sees the gusts along x, alpha those along z, beta those along y.
        [(0, 0, 1.0), (1, 2, flight.speed), (2, 1, flight.speed)].into_iter().any(|(output, axis, speed)| {
            let seen = flight.active.contains(&(kinematics::BODY + axis));
            seen && levels.outputs[output].is_some_and(|noise| levels.gusts[axis] > noise * speed)
        })
    })
}

/// The values and levels of a solution without some of the columns, with zero for those.
fn beginning(columns: &[Column], plain: &Solution) -> (Vec<f64>, Vec<Levels>) {
    let value = |c: &Column| {
        plain.columns.iter().position(|p| (p.place, p.flight) == (c.place, c.flight)).map_or(0.0, |i| plain.values[i])
    };
    (columns.iter().map(value).collect(), plain.levels.clone())
}

/// Widens the bounds of the columns that a solution with the cost `without` lacks, where their values say more than the
/// likelihood: an unknown that is `z` standard errors from zero makes the flight more likely by `exp(z^2/2)`, together
/// with the others at least. Where it does not, the parabola that its bound is made of is not the likelihood.
fn by_likelihood(solution: &mut Solution, without: f64) {
    let gained = (without - solution.cost).max(1.0);
    for i in 0..solution.columns.len() {
        if !goes_with_gusts(solution.columns[i].place) {
            continue;
        }
        let squared = solution.values[i].powi(2) / solution.corrected[(i, i)];
        if squared > gained {
            // What goes with it is as uncertain in that direction.
            let with = solution.corrected.column(i).into_owned();
            let more = (squared / gained - 1.0) / with[i];
            solution.corrected += &with * with.transpose() * more;
        }
    }
}

fn without(values: &[f64], index: usize) -> Vec<f64> {
    values.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, value)| *value).collect()
}

/// The estimates with their verdicts, in the order of the parameters; those of gravity are none of a sensor.
fn errors(solution: &Solution, refused: &[Refused], is_gusty: bool) -> Vec<SensorError> {
    let gains = offer::held_out_gains(solution);
    let mut errors: Vec<(usize, SensorError)> = Vec::new();
    for (i, column) in solution.columns.iter().enumerate() {
        let spec = &UNKNOWNS[column.place];
        if spec.group.is_none() || column.flight.is_some_and(|f| f > 0) {
            continue;
        }
        let value = solution.values[i];
        let std_error = solution.corrected[(i, i)].sqrt().min(spec.prior_std);
        let significance = value.abs() / std_error;
        let of_the_earth = spec.unit == "rad/s" && value.abs() < EARTH_RATE;
        let verdict = match significance {
            _ if std_error > 0.7 * spec.prior_std => SensorVerdict::NotIdentifiable,
            s if s > 2.0 && !of_the_earth => SensorVerdict::Significant,
            _ => SensorVerdict::None,
        };
        let gain = gains[i];
        // Wind is no error of a sensor either, but it is shown.
        let correctable = spec.group != Some(Group::Wind);
        let reason = match verdict {
            SensorVerdict::Significant if !correctable => None,
            SensorVerdict::Significant if significance < OFFERED => {
                Some(format!("no correction is offered below {OFFERED} standard errors"))
            }
            // Where the speed hardly changes its bias is its scale.
            SensorVerdict::Significant
                if is_gusty && (goes_with_gusts(column.place) || column.place == place::BIAS_SPEED) =>
            {
                Some(
                    "no correction is offered: the gusts of this flight are larger than the noise of the sensors, and \
                     what they do to the forces resembles an error of the air data. Fly in calm air"
                        .to_owned(),
                )
            }
            SensorVerdict::Significant if refused.iter().any(|r| UNKNOWNS[r.place].channel == spec.channel) => {
                Some(format!(
                    "no correction is offered: another error of `{}` was refused, whose effect this one takes over",
                    spec.channel
                ))
            }
            SensorVerdict::Significant if gain.is_nan() => {
                Some("no correction is offered: the flight is too short to hold a part of it out".to_owned())
            }
            SensorVerdict::Significant if gain <= 0.0 => Some(format!(
                "no correction is offered: samples that it was not fitted to become less likely with it, by {:.1} nats",
                -gain
            )),
            _ => None,
        };
        let offered = verdict == SensorVerdict::Significant && correctable && reason.is_none();
        errors.push((
            column.place,
            SensorError {
                name: spec.name.to_owned(),
                unit: spec.unit.to_owned(),
                value,
                std_error,
                prior_std: spec.prior_std,
                significance,
                verdict,
                held_out_gain: gain,
                offered,
                reason,
            },
        ));
    }
    for Refused { place, reason } in refused {
        let spec = &UNKNOWNS[*place];
        errors.push((
            *place,
            SensorError {
                name: spec.name.to_owned(),
                unit: spec.unit.to_owned(),
                value: f64::NAN,
                std_error: f64::NAN,
                prior_std: spec.prior_std,
                significance: f64::NAN,
                verdict: SensorVerdict::Refused,
                held_out_gain: f64::NAN,
                offered: false,
                reason: Some(reason.clone()),
            },
        ));
    }
    errors.sort_by_key(|(place, _)| *place);
    errors.into_iter().map(|(_, error)| error).collect()
}

/// Pairs of unknowns that the manoeuvre does not tell apart.
fn confused(solution: &Solution) -> Vec<String> {
    let (columns, c) = (&solution.columns, &solution.covariance);
    let mut found = Vec::new();
    let shown = |column: &Column| UNKNOWNS[column.place].group.is_some() && column.flight.is_none_or(|f| f == 0);
    for (i, first) in columns.iter().enumerate().filter(|(_, c)| shown(c)) {
        for (j, second) in columns.iter().enumerate().take(i).filter(|(_, c)| shown(c)) {
            let correlation = c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt();
            if correlation.abs() > 0.95 {
                found.push(format!(
                    "{} and {} are hardly told apart (correlation {correlation:.3}): trust their combination, not each \
                     alone",
                    UNKNOWNS[second.place].name, UNKNOWNS[first.place].name
                ));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A refused unknown is null in JSON, and comes back as it was.
    #[test]
    fn a_refused_unknown_has_no_number_in_json() {
        let refused = SensorError {
            name: "delay_alpha".to_owned(),
            unit: "s".to_owned(),
            value: f64::NAN,
            std_error: f64::NAN,
            prior_std: 0.1,
            significance: f64::NAN,
            verdict: SensorVerdict::Refused,
            held_out_gain: f64::NAN,
            offered: false,
            reason: Some("too late".to_owned()),
        };
        let text = serde_json::to_string(&refused).unwrap();
        assert!(text.contains("\"value\":null"), "{text}");
        let back: SensorError = serde_json::from_str(&text).unwrap();
        assert!(back.value.is_nan() && back.held_out_gain.is_nan() && back.reason == refused.reason, "{back:?}");
    }
}
