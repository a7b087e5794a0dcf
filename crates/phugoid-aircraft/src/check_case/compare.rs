//! A flight beside those of the simulators.
//!
//! The mark is how well the simulators agree with one another: a simulator that is as close to each of them as the two
//! that differ most are to each other is as good as they are. Where they agree better than they write digits, the last
//! digit written is the mark.

use super::trajectory::{COLUMNS, Trajectory};

/// A trajectory that a simulator wrote.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Name of the simulator.
    pub name: String,
    /// Headings; of equal ones the first counts.
    pub headings: Vec<String>,
    /// One row per instant.
    pub rows: Vec<Vec<f64>>,
    /// Unit of the last digit that is written, for each column: the smallest of its numbers other than zero; zero if
    /// there is none.
    pub resolution: Vec<f64>,
}

/// A recorded trajectory that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}: {what}")]
pub struct UnusableRecord {
    /// Name of the simulator.
    pub name: String,
    /// What is wrong.
    pub what: String,
}

impl Recorded {
    /// Reads comma-separated text with one line of headings. Fields that are empty become NaN.
    ///
    /// # Errors
    ///
    /// [`UnusableRecord`] without a column `time`, or where a line has too few fields or one that is no number.
    pub fn parse(name: &str, text: &str) -> Result<Self, UnusableRecord> {
        let fault = |what: String| UnusableRecord { name: name.to_owned(), what };
        let mut lines = text.lines().filter(|line| !line.trim().is_empty());
        let headings: Vec<String> =
            lines.next().unwrap_or_default().split(',').map(|field| field.trim().to_owned()).collect();
        if !headings.iter().any(|heading| heading == "time") {
            return Err(fault("there is no column `time`".to_owned()));
        }
        let mut resolution = vec![0.0; headings.len()];
        let mut rows = Vec::new();
        for (number, line) in lines.enumerate() {
            let mut row = Vec::with_capacity(headings.len());
            for (column, field) in line.split(',').map(str::trim).enumerate().take(headings.len()) {
                let value: f64 = match field {
                    "" => f64::NAN,
                    _ => field.parse().map_err(|_| fault(format!("line {}: `{field}` is no number", number + 2)))?,
                };
                if value != 0.0 && value.is_finite() {
                    let unit = last_digit(field);
                    let known = &mut resolution[column];
                    *known = if *known == 0.0 { unit } else { unit.min(*known) };
                }
                row.push(value);
            }
            if row.len() < headings.len() {
                return Err(fault(format!("line {} has {} fields, not {}", number + 2, row.len(), headings.len())));
            }
            rows.push(row);
        }
        Ok(Self { name: name.to_owned(), headings, rows, resolution })
    }

    fn column(&self, heading: &str) -> Option<usize> {
        self.headings.iter().position(|name| name == heading)
    }

    /// Times and values of a column; none if it is not there or, as some simulators do for a quantity that they do not
    /// have, zero throughout.
    fn series(&self, heading: &str) -> Option<Vec<[f64; 2]>> {
        let (time, column) = (self.column("time")?, self.column(heading)?);
        let series: Vec<_> = self.rows.iter().map(|row| [row[time], row[column]]).collect();
        series.iter().any(|[_, value]| *value != 0.0).then_some(series)
    }

    fn is_written(&self, heading: &str) -> bool {
        self.column(heading).is_some()
    }
}

/// Unit of the last digit of a written number.
fn last_digit(field: &str) -> f64 {
    let (mantissa, exponent) = field.split_once(['e', 'E']).unwrap_or((field, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
    10.0_f64.powi(exponent.parse::<i32>().unwrap_or(0) - decimals)
}

/// Whether a heading is that of an angle that is the same after a full turn.
fn turns(heading: &str) -> bool {
    heading == "longitude_deg" || heading == "eulerAngle_deg_Yaw" || heading == "eulerAngle_deg_Roll"
}

/// Largest difference between two series at times that are the same to 1 ms; none without such times.
fn largest_difference(a: &[[f64; 2]], b: &[[f64; 2]], turns: bool) -> Option<f64> {
    let mut largest = None;
    let mut at = 0;
    for [time, value] in a {
        while at < b.len() && b[at][0] < time - 1e-3 {
            at += 1;
        }
        let Some([other_time, other]) = b.get(at) else { break };
        if (other_time - time).abs() > 1e-3 || value.is_nan() || other.is_nan() {
            continue;
        }
        let mut difference = value - other;
        if turns {
            difference -= 360.0 * (difference / 360.0).round();
        }
        largest = Some(largest.map_or(difference.abs(), |most: f64| most.max(difference.abs())));
    }
    largest
}

/// How one quantity of a flight compares with the simulators.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Heading of the column.
    pub heading: &'static str,
    /// Largest difference from each simulator that has the quantity, by its name.
    pub differences: Vec<(String, f64)>,
    /// Largest difference between two simulators at common times.
    pub spread: f64,
    /// Largest unit of the last digit among the simulators.
    pub resolution: f64,
    /// Largest absolute value that a simulator wrote.
    pub size: f64,
}

/// How much larger than the spread a difference may be, as a share of it. A flight that is a little beyond the simulator
/// at the edge, to which it may be very close, is a little further from the one at the other edge than those two are from
/// each other.
pub const MARGIN: f64 = 0.02;

impl Comparison {
    /// Largest difference from any simulator.
    pub fn largest(&self) -> f64 {
        self.differences.iter().map(|(_, difference)| *difference).fold(0.0, f64::max)
    }

    /// Smallest of the largest differences: how far the closest simulator is.
    pub fn closest(&self) -> f64 {
        self.differences.iter().map(|(_, difference)| *difference).fold(f64::INFINITY, f64::min)
    }

    /// Largest difference that counts as agreement: the spread and [`MARGIN`] of it, and no less than the last digit
    /// written (at most a millionth of the largest value) or the rounding of the computation (1e-12 of the largest value
    /// or of one unit).
    pub fn mark(&self) -> f64 {
        let rounding = 1e-12 * self.size.max(1.0);
        (self.spread * (1.0 + MARGIN)).max(self.resolution.min(1e-6 * self.size)).max(rounding)
    }

    /// Whether the flight agrees with every simulator as well as they agree with one another.
    pub fn agrees(&self) -> bool {
        self.largest() <= self.mark()
    }
}

/// Compares a flight with those of the simulators, for every quantity that at least two of them wrote.
///
/// A quantity that a simulator wrote as zero throughout, while others did not, counts as not written by it.
pub fn compare(flight: &Trajectory, simulators: &[Recorded]) -> Vec<Comparison> {
    let mut comparisons = Vec::new();
    for (column, heading) in COLUMNS.iter().enumerate().skip(1) {
        let written: Vec<&Recorded> = simulators.iter().filter(|s| s.is_written(heading)).collect();
        let all: Vec<(&Recorded, Vec<[f64; 2]>)> =
            written.iter().filter_map(|s| Some((*s, s.series(heading)?))).collect();
        // If every simulator wrote zeros, zero is the answer.
        let all = if all.is_empty() {
            written
                .iter()
                .filter_map(|s| {
                    let time = s.column("time")?;
                    Some((*s, s.rows.iter().map(|row| [row[time], 0.0]).collect()))
                })
                .collect()
        } else {
            all
        };
        if all.len() < 2 {
            continue;
        }
        let ours: Vec<[f64; 2]> = flight.rows.iter().map(|row| [row[0], row[column]]).collect();
        let round = turns(heading);
        let differences = all
            .iter()
            .filter_map(|(s, series)| Some((s.name.clone(), largest_difference(&ours, series, round)?)))
            .collect();
        let mut spread = 0.0_f64;
        for (i, (_, a)) in all.iter().enumerate() {
            for (_, b) in &all[..i] {
                spread = spread.max(largest_difference(a, b, round).unwrap_or(0.0));
            }
        }
        let resolution = all.iter().filter_map(|(s, _)| Some(s.resolution[s.column(heading)?])).fold(0.0, f64::max);
        let values = all.iter().flat_map(|(_, series)| series.iter().map(|[_, value]| value.abs()));
        let size = values.fold(0.0, f64::max);
        comparisons.push(Comparison { heading, differences, spread, resolution, size });
    }
    comparisons
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_simulators_write() {
        let text = "time,a,b,a\n0.0,2.50E1,0.0,\n0.1,1.25,0.0,7\n";
        let record = Recorded::parse("x", text).unwrap();
        assert_eq!(record.rows[1], [0.1, 1.25, 0.0, 7.0]);
        assert!(record.rows[0][3].is_nan());
        assert!((record.resolution[1] - 0.01).abs() < 1e-15 && record.resolution[2] == 0.0);
        assert_eq!((record.series("b"), record.series("c")), (None, None));
        for bad in ["", "a,b\n1,2\n", "time,a\n1\n", "time,a\n1,x\n"] {
            assert!(Recorded::parse("x", bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn angles_are_compared_round_the_circle_and_times_to_a_millisecond() {
        let a = [[0.0, 359.0], [0.1, 10.0], [0.2, 0.0]];
        let b = [[0.0, -2.0], [0.100_4, 731.0], [0.23, 90.0]];
        assert_eq!(largest_difference(&a, &b, true), Some(1.0));
        assert_eq!(largest_difference(&a, &b, false), Some(721.0));
        assert_eq!(largest_difference(&a, &[], false), None);
    }
}
