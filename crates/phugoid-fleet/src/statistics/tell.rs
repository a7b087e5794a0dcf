//! From the rows of a store to what the fleet tells.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use phugoid_evaluation::statistics::clopper_pearson;
use phugoid_flight_data::statistics::median;
use serde::Serialize;

use super::cause::{Together, together, whole_distance};
use super::course::{Change, Combined, Fit, Observation, combine, constant, drift, effects, line, step, two_levels};
use super::distribution::chi_squared_above;
use super::false_discovery::rates;
use super::outlier::{self, Apart};
use super::sharing::{Owner, part_of};
use super::unused::{Unused, judge_unused};
use crate::logs::{LogRow, natural};
use crate::row::{QUANTITIES, Row};
use crate::unit::Segments;

/// How a store is judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Part of the findings that may be false, above 0 and below 1.
    pub false_discoveries: f64,
    /// Words that the rows have to fit, each of them: the name of the model, the first digits of its hash (eight or more), the
    /// method, the version, or the kind of segments (`manoeuvres` or `whole`). Needed where a store has results of several.
    pub only: Vec<String>,
    /// What a course runs over.
    pub over: Over,
}

impl Default for Question {
    fn default() -> Self {
        Self { false_discoveries: 0.05, only: Vec::new(), over: Over::Flights }
    }
}

/// What a course runs over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// The number of the flight: that of the table of flights, or else the place in the order of the names.
    #[default]
    Flights,
    /// The hours that the airframe had flown, which the table of flights has to give.
    Hours,
}

impl Over {
    /// What one step of a course is called: `flight`, `hour`.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Flights => "flight",
            Self::Hours => "hour",
        }
    }
}

/// Why the store tells nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TellError {
    /// The rate is no part.
    #[error("the rate of false discoveries is {rate}: expected a number above 0 and below 1")]
    Rate {
        /// What was given.
        rate: f64,
    },
    /// No estimate of a log fits.
    #[error("the store has no estimates of logs{}", if only.is_empty() { String::new() } else { format!(" that fit {}. Of the hash of a model eight digits or more are needed", only.join(", ")) })]
    Nothing {
        /// The words of the question.
        only: Vec<String>,
    },
    /// Results that must not be mixed.
    #[error("the store has results of several models, methods, versions or kinds of segments, which must not be mixed: {}. Choose by --only", sets.iter().map(Set::to_string).collect::<Vec<_>>().join("; "))]
    Several {
        /// What there is.
        sets: Vec<Set>,
    },
    /// A log has no hours.
    #[error("{log}: no hours are known of this flight. Give them in the table of flights, or ask over flights")]
    NoHours {
        /// Path of the log.
        log: String,
    },
}

/// Results that belong together.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Set {
    /// Name of the model.
    pub model: String,
    /// SHA-256 of its text.
    pub model_sha256: String,
    /// The method.
    pub method: String,
    /// The version of the program.
    pub version: String,
    /// What was estimated of each flight: `manoeuvres` or `whole`.
    pub segments: String,
}

impl std::fmt::Display for Set {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = self.model_sha256.get(..12).unwrap_or(&self.model_sha256);
        write!(f, "{} ({digits}) {} {} {}", self.model, self.method, self.version, self.segments)
    }
}

impl Set {
    fn of(row: &Row) -> Self {
        let [model, model_sha256, method, version, segments] = Self::words(row).map(str::to_owned);
        Self { model, model_sha256, method, version, segments }
    }

    /// What a row says of the fields, in their order.
    fn words(row: &Row) -> [&str; 5] {
        let segments = match row.segment {
            // The whole flight has the number 0; a flight that was refused as a whole says nothing of it.
            Some(0) => Segments::Whole.word(),
            Some(_) => Segments::Manoeuvres.word(),
            None => "",
        };
        [&row.model, &row.model_sha256, &row.method, &row.version, segments]
    }

    /// Whether a row belongs to it: a flight that was refused as a whole belongs to each kind of segments.
    fn has(&self, row: &Row) -> bool {
        let [of_row @ .., segments] = Self::words(row);
        let own: [&str; 4] = [&self.model, &self.model_sha256, &self.method, &self.version];
        own == of_row && (segments.is_empty() || segments == self.segments)
    }

    fn fits(&self, word: &str) -> bool {
        let is_hash = word.len() >= 8 && self.model_sha256.starts_with(word);
        is_hash || [&self.model, &self.method, &self.version, &self.segments].iter().any(|own| *own == word)
    }
}

/// What the fleet tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// The results that were asked.
    pub set: Set,
    /// Part of the findings that may be false.
    pub false_discoveries: f64,
    /// What the courses run over.
    pub over: Over,
    /// Number of logs.
    pub logs: usize,
    /// What the reader should know of how the logs were taken, in sentences.
    pub notes: Vec<String>,
    /// Why logs and segments have no numbers: the word, and how many.
    pub refused: BTreeMap<String, usize>,
    /// The airframes in the order of their names.
    pub airframes: Vec<Airframe>,
    /// Of each parameter, how often a flight lies within two of its claimed standard errors from the others of its airframe.
    pub coverage: Vec<Coverage>,
}

impl Findings {
    /// How many airframes and logs, in words: `1 airframe, 12 logs`.
    pub fn counts(&self) -> String {
        let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        format!("{}, {}", counted(self.airframes.len(), "airframe"), counted(self.logs, "log"))
    }
}

/// One airframe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Airframe {
    /// Its name.
    pub name: String,
    /// Number of its logs.
    pub logs: usize,
    /// The course of each parameter, in the order of their names; none of a parameter without a single estimate that can be used.
    pub courses: Vec<Course>,
    /// Distance of all its parameters together from the others; none with fewer than three airframes.
    pub whole: Option<Whole>,
    /// What its courses do together, and what explains it: a drift or a step, and its distance from the others, where they were found.
    pub together: Vec<Together>,
    /// Its logs of which no estimate can be used, and why.
    pub unused: Unused,
}

/// How far all parameters of an airframe together lie from the others.
///
/// A vane that shows 15 % too much moves each derivative by not more than airspeed, mass and inertia together might; but none of
/// these moves all of them in that way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Whole {
    /// Squared distance over its covariance, by what is declared of the quantities and what the flights scatter.
    pub chi_squared: f64,
    /// Number of parameters.
    pub parameters: usize,
    /// Probability of as large a distance where it belongs to the others. Where these scatter by more than is declared, their scatter
    /// is the measure.
    pub p_value: f64,
    /// Rate of false discoveries at which it would just be a finding.
    pub rate: f64,
    /// Whether it is one.
    pub is_apart: bool,
}

/// What a course does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Nothing speaks against a constant.
    Steady,
    /// It drifts.
    Drift,
    /// It changes at once.
    Step,
    /// Too few flights to say.
    TooFew,
}

/// The course of one parameter of one airframe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Course {
    /// Name of the parameter.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Estimates that are not used: not converged, doubtful or refused.
    pub left_out: usize,
    /// The mean over the flights.
    pub combined: Combined,
    /// What a positive error of one declared standard uncertainty of each quantity does to the mean, in the unit of the parameter and
    /// the order of [`UncertainQuantity::ALL`](phugoid_identification::estimation::UncertainQuantity::ALL).
    pub effects: [f64; QUANTITIES],
    /// The drift, significant or not.
    pub drift: Option<Change>,
    /// The most certain step, significant or not.
    pub step: Option<Change>,
    /// What the course does, at the rate of false discoveries over all courses.
    pub shape: Shape,
    /// Rate of false discoveries at which drift or step would just be a finding.
    pub change_rate: Option<f64>,
    /// Distance of this airframe from the others.
    pub apart: Option<Apart>,
    /// Rate at which it would just be an outlier.
    pub apart_rate: Option<f64>,
    /// Whether it is one.
    pub is_outlier: bool,
    /// The estimates, in the order of the flights.
    pub points: Vec<Point>,
}

impl Course {
    /// The points with what each may differ by from another flight of its airframe, which is all that they are compared by.
    pub(super) fn observations(&self) -> Vec<Observation> {
        let of = |p: &Point| Observation { at: p.at, value: p.value, random_std: p.own_std, budget: [0.0; QUANTITIES] };
        self.points.iter().map(of).collect()
    }
}

/// One estimate of a course.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Hash of the log.
    pub log_sha256: String,
    /// Where the log was found.
    pub path: String,
    /// The segment of it.
    pub segment: i64,
    /// Flight or hours.
    pub at: f64,
    /// The estimate.
    pub value: f64,
    /// One standard error.
    pub std_error: f64,
    /// Its random part.
    pub random_std: f64,
    /// One sigma by which it may differ from another flight of its airframe: the random part, and the loading of the day.
    pub own_std: f64,
    /// Distance from the course of the other flights over its standard error; none with too few flights.
    pub sigmas: Option<f64>,
    /// Whether this flight disagrees with its own airframe.
    pub disagrees: bool,
}

/// How often flights lie where the other flights of their airframe say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// Name of the parameter.
    pub parameter: String,
    /// Estimates within two claimed standard errors.
    pub within: usize,
    /// Estimates that were asked.
    pub of: usize,
    /// 95 % interval of the probability (Clopper and Pearson).
    pub interval: [f64; 2],
}

/// What the rows of logs tell.
///
/// # Errors
/// [`TellError`]: nothing fits the question, or results of several models or methods do.
pub fn tell(rows: &[Row], logs: &[LogRow], question: &Question) -> Result<Findings, TellError> {
    let rate = question.false_discoveries;
    if !(rate > 0.0 && rate < 1.0) {
        return Err(TellError::Rate { rate });
    }
    let set = the_set(rows, &question.only)?;
    let (logs, mut notes) = one_for_each_path(logs);
    let rows = rows_of(rows, &logs, &set);
    let mut refused = BTreeMap::new();
    for word in rows.iter().filter_map(|row| row.refusal.clone()) {
        *refused.entry(word).or_insert(0) += 1;
    }
    let mut airframes = airframes(&rows, &logs, question.over, &mut notes)?;
    let logs = airframes.iter().map(|airframe| airframe.logs).sum();
    judge_unused(&mut airframes.iter_mut().map(|airframe| &mut airframe.unused).collect::<Vec<_>>(), rate);
    judge_changes(&mut airframes, rate);
    judge_outliers(&mut airframes, rate);
    let count = airframes.len();
    judge_wholes(&mut airframes, rate);
    for airframe in &mut airframes {
        airframe.together = together(airframe, count);
    }
    let coverage = judge_flights(&mut airframes, rate);
    let (false_discoveries, over) = (rate, question.over);
    Ok(Findings { set, false_discoveries, over, logs, notes, refused, airframes, coverage })
}

/// The results that the words choose, which have to be of one kind.
fn the_set(rows: &[Row], only: &[String]) -> Result<Set, TellError> {
    let sets: BTreeSet<Set> = rows.iter().filter(|row| row.kind == "log").map(Set::of).collect();
    // What says nothing of the kind of segments belongs to one that does.
    let is_of_another = |set: &Set| {
        set.segments.is_empty()
            && sets
                .iter()
                .any(|other| !other.segments.is_empty() && Set { segments: String::new(), ..other.clone() } == *set)
    };
    let fitting = sets.iter().filter(|set| !is_of_another(set) && only.iter().all(|word| set.fits(word)));
    let mut fitting: Vec<Set> = fitting.cloned().collect();
    if fitting.len() > 1 {
        return Err(TellError::Several { sets: fitting });
    }
    fitting.pop().ok_or_else(|| TellError::Nothing { only: only.to_vec() })
}

/// The rows of these logs that belong to a set, each result once.
pub(crate) fn rows_of<'a>(rows: &'a [Row], logs: &[&LogRow], set: &Set) -> Vec<&'a Row> {
    let known: HashSet<&str> = logs.iter().map(|log| log.log_sha256.as_str()).collect();
    // A store of an earlier version may have one result under two keys.
    let mut taken = HashSet::new();
    rows.iter()
        .filter(|row| row.kind == "log" && set.has(row))
        .filter(|row| row.source_sha256.as_deref().is_none_or(|hash| known.contains(hash)))
        .filter(|row| {
            let Row { source_sha256, segment, parameter, .. } = row;
            source_sha256.is_none() || taken.insert((source_sha256, segment, parameter))
        })
        .collect()
}

/// The logs, of each path one: where a file was estimated, and again after it had grown, the longest holds what the others hold.
pub(crate) fn one_for_each_path(logs: &[LogRow]) -> (Vec<&LogRow>, Vec<String>) {
    let mut longest: HashMap<&str, &LogRow> = HashMap::new();
    for log in logs {
        let kept = longest.entry(&log.path).or_insert(log);
        if log.bytes > kept.bytes {
            *kept = log;
        }
    }
    let kept = |log: &&LogRow| longest.get(log.path.as_str()).is_some_and(|kept| kept.log_sha256 == log.log_sha256);
    let left: Vec<&LogRow> = logs.iter().filter(|log| !kept(log)).collect();
    let notes = left.first().map(|log| {
        format!(
            "{} of the logs in the store have a path that another log has too ({}, ...), as a file that has grown: of each path \
             the longest counts, the others are left out. If they are several flights, because relative paths were given from several \
             folders, or a file was made shorter on purpose, use a new store, with full paths",
            left.len(),
            log.path
        )
    });
    (logs.iter().filter(kept).collect(), notes.into_iter().collect())
}

/// A point with its budget, which is needed for the mean alone.
type WithBudget = (Point, [f64; QUANTITIES]);

fn airframes(rows: &[&Row], logs: &[&LogRow], over: Over, notes: &mut Vec<String>) -> Result<Vec<Airframe>, TellError> {
    let mut by_log: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_log.entry(row.source_sha256.as_deref().unwrap_or_default()).or_default().push(row);
    }
    let mut fleet: BTreeMap<&str, Vec<&LogRow>> = BTreeMap::new();
    for log in logs.iter().filter(|log| by_log.contains_key(log.log_sha256.as_str())) {
        fleet.entry(&log.airframe).or_default().push(*log);
    }
    let mut airframes = Vec::new();
    for (name, mut logs) in fleet {
        logs.sort_by_cached_key(|log| natural(&log.path));
        let numbered = logs.iter().filter(|log| log.flight.is_some()).count();
        let is_numbered = numbered == logs.len();
        if over == Over::Flights && !is_numbered && numbered > 0 {
            let without = logs.iter().find(|log| log.flight.is_none()).map_or("", |log| &log.path);
            notes.push(format!(
                "{name}: {} of {} logs have no `flight` in the table of flights ({without}, ...): its flights are taken in the order \
                 of their names. Give each a number, or drifts and steps may be of the wrong order",
                logs.len() - numbered,
                logs.len()
            ));
        }
        let mut unused = Unused::default();
        let mut courses: BTreeMap<&str, (String, usize, Vec<WithBudget>)> = BTreeMap::new();
        for (place, log) in logs.iter().enumerate() {
            let at = match over {
                Over::Flights => log.flight.filter(|_| is_numbered).unwrap_or((place + 1) as f64),
                Over::Hours => log.hours.ok_or_else(|| TellError::NoHours { log: log.path.clone() })?,
            };
            let of_log = by_log.get(log.log_sha256.as_str()).map_or(&[][..], Vec::as_slice);
            let mut is_used = false;
            for row in of_log {
                let Some(parameter) = row.parameter.as_deref().filter(|_| row.nuisance != Some(true)) else { continue };
                let course = courses.entry(parameter).or_default();
                match point(row, log, at) {
                    Some(point) => {
                        is_used = true;
                        course.0 = row.unit.clone().unwrap_or_default();
                        course.2.push((point, row.budget.map(Option::unwrap_or_default)));
                    }
                    None => course.1 += 1,
                }
            }
            unused.count(of_log, is_used);
        }
        let courses = courses.into_iter().filter_map(|(parameter, (unit, left_out, mut points))| {
            points.sort_by(|(a, _), (b, _)| a.at.total_cmp(&b.at));
            course(parameter, unit, left_out, points)
        });
        airframes.push(Airframe {
            name: name.to_owned(),
            logs: logs.len(),
            courses: courses.collect(),
            whole: None,
            together: Vec::new(),
            unused,
        });
    }
    airframes.sort_by_cached_key(|airframe| natural(&airframe.name));
    Ok(airframes)
}

/// The point of a row whose number can be used; `None` for others.
fn point(row: &Row, log: &LogRow, at: f64) -> Option<Point> {
    let is_usable = matches!(row.status.as_str(), "sound" | "provisional");
    let is_known = row.parameter_status.as_deref() == Some("converged");
    let (value, std_error) = row.value.zip(row.std_error).filter(|_| is_usable && is_known)?;
    let random_std = row.random_std.filter(|std| *std > 0.0)?;
    Some(Point {
        log_sha256: log.log_sha256.clone(),
        path: log.path.clone(),
        segment: row.segment.unwrap_or(0),
        at,
        value,
        std_error,
        random_std,
        own_std: random_std.hypot(part_of(&row.budget.map(Option::unwrap_or_default), &[Owner::Loading])),
        sigmas: None,
        disagrees: false,
    })
}

fn course(parameter: &str, unit: String, left_out: usize, points: Vec<WithBudget>) -> Option<Course> {
    let observations: Vec<Observation> = points
        .iter()
        .map(|(p, budget)| Observation { at: p.at, value: p.value, random_std: p.random_std, budget: *budget })
        .collect();
    let (drift, step) = (drift(&observations), step(&observations));
    Some(Course {
        parameter: parameter.to_owned(),
        unit,
        left_out,
        combined: combine(&observations)?,
        effects: effects(&observations),
        drift,
        step,
        shape: Shape::TooFew,
        change_rate: None,
        apart: None,
        apart_rate: None,
        is_outlier: false,
        points: points.into_iter().map(|(point, _)| point).collect(),
    })
}

/// Drift or step: the probability of the likelier one, twice, since two questions were asked.
fn judge_changes(airframes: &mut [Airframe], rate: f64) {
    let courses = || airframes.iter().flat_map(|airframe| &airframe.courses);
    let p_of = |course: &Course| {
        let least = [&course.drift, &course.step].into_iter().flatten().map(|change| change.p_value).reduce(f64::min);
        least.map_or(f64::NAN, |p| (2.0 * p).min(1.0))
    };
    let all: Vec<f64> = rates(&courses().map(p_of).collect::<Vec<f64>>());
    for (course, found) in airframes.iter_mut().flat_map(|airframe| &mut airframe.courses).zip(all) {
        course.change_rate = crate::row::finite(found);
        // A step may choose its place, which its p-value pays for and its residuals do not.
        let p = |change: &Option<Change>| change.map_or(f64::INFINITY, |change| change.p_value);
        course.shape = match found {
            found if found.is_nan() => Shape::TooFew,
            found if found > rate => Shape::Steady,
            _ if p(&course.drift) <= p(&course.step) => Shape::Drift,
            _ => Shape::Step,
        };
    }
}

fn judge_outliers(airframes: &mut [Airframe], rate: f64) {
    let parameters: BTreeSet<String> =
        airframes.iter().flat_map(|a| &a.courses).map(|course| course.parameter.clone()).collect();
    for parameter in &parameters {
        let mut courses: Vec<&mut Course> =
            airframes.iter_mut().flat_map(|a| &mut a.courses).filter(|c| c.parameter == *parameter).collect();
        let combined: Vec<Combined> = courses.iter().map(|course| course.combined).collect();
        let Some(apart) = outlier::airframes(&combined) else { continue };
        courses.iter_mut().zip(apart).for_each(|(course, apart)| course.apart = Some(apart));
    }
    let p_of = |course: &Course| course.apart.map_or(f64::NAN, |apart| apart.p_value);
    let all = rates(&airframes.iter().flat_map(|a| &a.courses).map(p_of).collect::<Vec<f64>>());
    for (course, found) in airframes.iter_mut().flat_map(|a| &mut a.courses).zip(all) {
        course.apart_rate = crate::row::finite(found);
        course.is_outlier = found <= rate;
    }
}

fn judge_wholes(airframes: &mut [Airframe], rate: f64) {
    let count = airframes.len();
    let distances: Vec<Option<(f64, f64)>> = airframes.iter().map(|a| whole_distance(a, count)).collect();
    let p_of = |own: usize| {
        let (chi_squared, freedom) = distances[own]?;
        let others = distances.iter().enumerate().filter(|(other, _)| *other != own).filter_map(|(_, d)| *d);
        let mut sizes: Vec<f64> =
            others.map(|(chi_squared, freedom)| chi_squared / median_chi_squared(freedom)).collect();
        let scatter = median(&mut sizes).unwrap_or(0.0).max(1.0);
        Some((chi_squared, freedom, chi_squared_above(chi_squared / scatter, freedom)))
    };
    let told: Vec<Option<(f64, f64, f64)>> = (0..count).map(p_of).collect();
    let found = rates(&told.iter().map(|told| told.map_or(f64::NAN, |(.., p)| p)).collect::<Vec<f64>>());
    for (airframe, (told, found)) in airframes.iter_mut().zip(told.into_iter().zip(found)) {
        airframe.whole = told.map(|(chi_squared, freedom, p_value)| Whole {
            chi_squared,
            parameters: freedom as usize,
            p_value,
            rate: found,
            is_apart: found <= rate,
        });
    }
}

/// Half of all numbers with chi squared of these degrees of freedom are below it (Wilson and Hilferty 1931).
fn median_chi_squared(freedom: f64) -> f64 {
    freedom * (1.0 - 2.0 / (9.0 * freedom)).powi(3)
}

/// The fit that the verdict on a course asks for.
fn fit(course: &Course, observations: &[Observation]) -> Fit {
    match (course.shape, course.step) {
        (Shape::Drift, _) => line(observations).map_or_else(|| constant(observations), |(fit, ..)| fit),
        (Shape::Step, Some(step)) => two_levels(observations, step.at),
        _ => constant(observations),
    }
}

fn judge_flights(airframes: &mut [Airframe], rate: f64) -> Vec<Coverage> {
    let mut coverage: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    let mut p_values = Vec::new();
    for course in airframes.iter_mut().flat_map(|airframe| &mut airframe.courses) {
        let observations = course.observations();
        let told = outlier::flights(&observations, &fit(course, &observations));
        let counts = coverage.entry(course.parameter.clone()).or_default();
        match told {
            None => p_values.extend(course.points.iter().map(|_| f64::NAN)),
            Some(told) => {
                for (point, (apart, claimed)) in course.points.iter_mut().zip(told) {
                    point.sigmas = crate::row::finite(apart.sigmas);
                    p_values.push(apart.p_value);
                    counts.0 += usize::from(claimed.abs() <= 2.0);
                    counts.1 += 1;
                }
            }
        }
    }
    let points = airframes.iter_mut().flat_map(|a| &mut a.courses).flat_map(|course| &mut course.points);
    for (point, found) in points.zip(rates(&p_values)) {
        point.disagrees = found <= rate;
    }
    let told = coverage.into_iter().filter(|(_, (_, of))| *of > 0);
    told.map(|(parameter, (within, of))| Coverage { parameter, within, of, interval: clopper_pearson(within, of) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(flight: u8, segment: Option<i64>, method: &str) -> Row {
        Row {
            kind: "log".to_owned(),
            source_sha256: Some(format!("{flight:064}")),
            method: method.to_owned(),
            status: "sound".to_owned(),
            segment,
            parameter: segment.map(|_| "Cm_alpha".to_owned()),
            refusal: segment.is_none().then(|| "not-a-flight".to_owned()),
            parameter_status: Some("converged".to_owned()),
            value: Some(-0.5),
            std_error: Some(0.02),
            random_std: Some(0.01),
            ..Row::default()
        }
    }

    fn log(flight: u8, path: &str, bytes: i64) -> LogRow {
        LogRow {
            log_sha256: format!("{flight:064}"),
            path: path.to_owned(),
            bytes,
            airframe: "N1".to_owned(),
            ..LogRow::default()
        }
    }

    #[test]
    fn manoeuvres_and_whole_flights_are_not_mixed_and_a_refused_flight_belongs_to_both() {
        let rows = [row(1, Some(1), "smpe"), row(1, Some(0), "smpe"), row(2, None, "smpe")];
        let logs = [log(1, "1.csv", 9), log(2, "2.csv", 9)];
        let asked = |only: &[&str]| {
            let only = only.iter().map(|word| (*word).to_owned()).collect();
            tell(&rows, &logs, &Question { only, ..Question::default() })
        };
        assert!(matches!(asked(&[]), Err(TellError::Several { sets }) if sets.len() == 2));
        for kind in ["manoeuvres", "whole"] {
            let found = asked(&[kind]).unwrap();
            let [airframe] = &found.airframes[..] else { panic!("{found:?}") };
            assert!(found.counts().starts_with("1 airframe, "), "{}", found.counts());
            assert_eq!((airframe.courses[0].points.len(), found.refused["not-a-flight"]), (1, 1), "{kind}");
            assert_eq!(
                (airframe.unused.logs, airframe.unused.of, airframe.unused.words().as_str()),
                (1, 2, "not-a-flight 1")
            );
        }
        assert!(matches!(asked(&["ekf"]), Err(TellError::Nothing { .. })));
    }

    #[test]
    fn a_log_that_grew_and_a_result_under_two_keys_count_once() {
        let again = Row { key: "another".to_owned(), ..row(2, Some(1), "smpe") };
        let rows = [row(1, Some(1), "smpe"), row(2, Some(1), "smpe"), again, row(3, Some(1), "smpe")];
        let logs = [log(1, "a.csv", 100), log(2, "a.csv", 400), log(3, "b.csv", 50)];
        let found = tell(&rows, &logs, &Question::default()).unwrap();
        let points = &found.airframes[0].courses[0].points;
        let of: Vec<&str> = points.iter().map(|point| point.log_sha256.as_str()).collect();
        assert_eq!((of, found.logs), (vec![logs[1].log_sha256.as_str(), logs[2].log_sha256.as_str()], 2));
        assert!(found.notes.len() == 1 && found.notes[0].contains("a.csv"), "{:?}", found.notes);
    }

    #[test]
    fn flights_without_a_number_among_others_with_one_are_said() {
        let rows = [row(1, Some(1), "smpe"), row(2, Some(1), "smpe")];
        let numbered = LogRow { flight: Some(7.0), ..log(1, "a.csv", 9) };
        let notes = |logs: &[LogRow]| tell(&rows, logs, &Question::default()).unwrap().notes;
        assert!(notes(&[numbered.clone(), log(2, "b.csv", 9)]).concat().contains("1 of 2 logs have no `flight`"));
        assert!(notes(&[numbered, LogRow { flight: Some(8.0), ..log(2, "b.csv", 9) }]).is_empty());
    }
}
