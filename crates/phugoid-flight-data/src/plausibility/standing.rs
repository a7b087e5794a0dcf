//! Records of aircraft that stand for most of the time, as autopilots log from their start on.

use super::doubt::Doubts;
use super::robust::median_of_finite;
use super::sizes::SLOWEST;

/// Part of the usual airspeed in flight from which on an aircraft is taken to fly.
const FLYING: f64 = 0.5;
/// A lull of the airspeed that does not end a flight, s.
const LULL_S: f64 = 3.0;
/// The shortest flight, s: less may be a few wrong values of the sensor.
const SHORTEST_S: f64 = 3.0;
/// The fewest values of the airspeed in it.
const FEWEST: usize = 4;

/// One flight: from and to, s, and the number of values of the airspeed in it.
#[derive(Clone, Copy)]
struct Flight {
    from_s: f64,
    to_s: f64,
    values: usize,
}

/// What to say of a record whose usual airspeed is below all flight; `None` if no part of it is a flight.
pub(super) fn message(doubts: &Doubts) -> Option<String> {
    let speeds = doubts.values("true_airspeed")?;
    let samples: Vec<(f64, f64)> =
        doubts.time().iter().copied().zip(speeds.iter().copied()).filter(|(_, speed)| speed.is_finite()).collect();
    let usual = median_of_finite(samples.iter().map(|(_, speed)| *speed).filter(|speed| *speed >= SLOWEST))?;
    let least = SLOWEST.max(FLYING * usual);
    let mut flights: Vec<Flight> = Vec::new();
    for &(time, _) in samples.iter().filter(|(_, speed)| *speed >= least) {
        match flights.last_mut().filter(|flight| time - flight.to_s <= LULL_S) {
            Some(flight) => (flight.to_s, flight.values) = (time, flight.values + 1),
            None => flights.push(Flight { from_s: time, to_s: time, values: 1 }),
        }
    }
    let (first, last) = (*doubts.time().first()?, *doubts.time().last()?);
    // A record that ends in flight ends behind the last value of a slow airspeed.
    if let Some(flight) = flights.last_mut().filter(|flight| last - flight.to_s <= LULL_S) {
        flight.to_s = last;
    }
    flights.retain(|flight| flight.to_s - flight.from_s >= SHORTEST_S && flight.values >= FEWEST);
    let longest = flights.iter().copied().max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)))?;
    let flown: f64 = flights.iter().map(|flight| flight.to_s - flight.from_s).sum();
    let standing = median_of_finite(samples.iter().map(|(_, speed)| *speed).filter(|speed| *speed < least))?;
    let end = if longest.to_s < last { format!(" --to {}s", tenths(longest.to_s)) } else { String::new() };
    let which = if flights.len() > 1 { "the longest flight in it" } else { "the flight in it" };
    Some(format!(
        "the aircraft stands for {} s of the {} s of the record (airspeed about {standing:.1} m/s there). Estimate from {which} alone, at {least:.1} m/s \
         and more: --from {}s{end}",
        tenths(last - first - flown),
        tenths(last - first),
        tenths(longest.from_s),
    ))
}

/// Seconds to a tenth.
fn tenths(seconds: f64) -> f64 {
    (10.0 * seconds).round() / 10.0
}
