//! Was the aircraft flying?

use phugoid_flight_data::statistics::{Rank, quantile};

use super::record::Signals;

/// A speed this part of the fastest of the record is still flight: stall speed over top speed is more.
const PART_OF_FASTEST: f64 = 0.3;

/// # Errors
/// A sentence that says why the segment is no flight, or why that is not known.
pub(crate) fn check(signals: &Signals<'_>, from_s: f64, to_s: f64, slowest_m_s: f64) -> Result<(), String> {
    let Some((_, speed)) = signals.speed() else {
        return Err("no airspeed: neither flight nor coefficients can be told".to_owned());
    };
    let mut here = speed.between(from_s, to_s).to_vec();
    // The slowest and the fastest values may be outliers: the tenth from below and the twentieth from above stand for them.
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
