//! Decides by the airspeed whether the aircraft was flying during a segment.

use phugoid_flight_data::statistics::{Rank, quantile};

use super::record::Signals;

/// Airspeeds above this part of the highest of the record count as flight: the ratio of stall speed to top speed is
/// larger.
const PART_OF_FASTEST: f64 = 0.3;

/// # Errors
/// A sentence that says why the segment is no flight, or why that is not known.
pub(crate) fn check(signals: &Signals<'_>, from_s: f64, to_s: f64, slowest_m_s: f64) -> Result<(), String> {
    let Some((_, speed)) = signals.speed() else {
        return Err(
            "no airspeed: whether the aircraft flew and which derivatives can be estimated is not known".to_owned()
        );
    };
    let mut here = speed.between(from_s, to_s).to_vec();
    // The slowest and the fastest values may be outliers: the tenth from below and the twentieth from above stand for
    // them.
    let Some(slow) = quantile(&mut here, 0.1, Rank::Lower) else {
        return Err("no airspeed was recorded in it".to_owned());
    };
    let fast = quantile(&mut speed.values.clone(), 0.95, Rank::Lower).unwrap_or(f64::NAN);
    let wanted = slowest_m_s.max(PART_OF_FASTEST * fast);
    if slow < wanted {
        return Err(format!("not in flight: the airspeed is {slow:.1} m/s, and flight begins at {wanted:.1} m/s"));
    }
    Ok(())
}
