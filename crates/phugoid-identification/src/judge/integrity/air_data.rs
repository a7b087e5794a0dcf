//! The airspeed against the dynamic pressure and the density of the air: `V = sqrt(2 qbar / rho)`.

use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;
use phugoid_flight_dynamics::atmosphere::Atmosphere;

use super::{Finding, What};

/// Smallest departure that is reported where the density was recorded: 2.5 % are twice what installation errors of the
/// pitot system may be together with a thermometer's (14 CFR 25.1323).
const WITH_DENSITY: f64 = 0.025;
/// The same with the standard atmosphere at the altitude: a day of 15 degrees more or less changes the speed by 2.6 %.
const WITH_ALTITUDE: f64 = 0.05;

/// What disagrees.
pub(super) fn findings(record: &Record) -> Option<Vec<Finding>> {
    let [pressure, speed] = ["dynamic_pressure", "true_airspeed"].map(|name| record.channel(name));
    let (pressure, speed) = (&pressure?.values, &speed?.values);
    let recorded = record.channel("air_density").map(|channel| channel.values.as_slice());
    let altitude = record.channel("altitude").map(|channel| channel.values.as_slice());
    let (limit, source) = match (recorded, altitude) {
        (Some(_), _) => (WITH_DENSITY, "the recorded air density"),
        (None, Some(_)) => (WITH_ALTITUDE, "the density of the standard atmosphere at the altitude"),
        (None, None) => return None,
    };
    // NaN where a channel has no value for this sample.
    let at = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(f64::NAN);
    let air = |k: usize| Atmosphere::Standard.at(altitude.map_or(0.0, |h| at(h, k)).clamp(0.0, 20_000.0));
    let ratio = |k: usize, impact: bool| {
        let air = air(k);
        let density = recorded.map_or(air.density, |values| at(values, k));
        let mach = speed[k] / air.speed_of_sound;
        // Impact pressure over dynamic pressure: the isentropic series to the second term.
        let over = if impact { 1.0 + 0.25 * mach * mach + 0.025 * mach.powi(4) } else { 1.0 };
        speed[k] / (2.0 * pressure[k] / (over * density)).sqrt()
    };
    let samples = speed.len().min(pressure.len());
    let middle = |impact: bool| {
        median(&mut (0..samples).map(|k| ratio(k, impact)).filter(|r| r.is_finite()).collect::<Vec<f64>>())
    };
    // A channel of this name may hold the impact pressure, which a pitot tube measures.
    let found =
        [middle(false)?, middle(true)?].into_iter().min_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))?;
    let is_wrong = (found - 1.0).abs() > limit;
    Some(Vec::from_iter(is_wrong.then(|| Finding {
        what: What::Other,
        channel: "true_airspeed",
        sentence: format!(
            "the airspeed is {found:.3} times what the dynamic pressure and {source} give: check its calibration, and \
             whether it is true, equivalent or indicated airspeed"
        ),
    })))
}
