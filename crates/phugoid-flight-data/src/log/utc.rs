//! Dates: GPS time to UTC, and UTC as text.

use crate::calendar;

/// The beginning of GPS time, 1980-01-06T00:00:00 UTC, in seconds from 1970.
const GPS_EPOCH_S: f64 = 315_964_800.0;

/// Leap seconds since 2006 (IERS Bulletin C): from this UTC second from 1970 on, GPS time is ahead of UTC by this many
/// seconds.
const LEAP_SECONDS: [(f64, f64); 5] = [
    (1_483_228_800.0, 18.0), // 2017-01-01
    (1_435_708_800.0, 17.0), // 2015-07-01
    (1_341_100_800.0, 16.0), // 2012-07-01
    (1_230_768_000.0, 15.0), // 2009-01-01
    (f64::NEG_INFINITY, 14.0),
];

/// Seconds from 1970-01-01T00:00:00 UTC, of a GPS week (counted from 1980, without rollover) and a time of week, s.
pub(super) fn from_gps(week: f64, time_of_week_s: f64) -> f64 {
    let gps = GPS_EPOCH_S + week * 604_800.0 + time_of_week_s;
    let leap = LEAP_SECONDS.iter().find(|(from, leap)| gps - leap >= *from).map_or(14.0, |(_, leap)| *leap);
    gps - leap
}

/// Writes seconds from 1970-01-01T00:00:00 UTC as a date, `2024-05-01T12:34:56.789Z` (ISO 8601). `None` outside the
/// years 1980 to 2200, where a log has no clock, and for NaN.
///
/// ```
/// use phugoid_flight_data::log::utc::text;
/// assert_eq!(text(1_714_566_896.789).as_deref(), Some("2024-05-01T12:34:56.789Z"));
/// assert_eq!(text(0.0), None);
/// ```
pub fn text(unix_s: f64) -> Option<String> {
    if !(GPS_EPOCH_S..7_258_118_400.0).contains(&unix_s) {
        return None;
    }
    let milliseconds = (unix_s * 1e3).round() as i64;
    let (days, of_day) = (milliseconds.div_euclid(86_400_000), milliseconds.rem_euclid(86_400_000));
    let (year, month, day) = calendar::date(days);
    let (hour, minute) = (of_day / 3_600_000, of_day / 60_000 % 60);
    let (second, millisecond) = (of_day / 1000 % 60, of_day % 1000);
    Some(format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{millisecond:03}Z"))
}

/// The entries for the information of a log that say when its time zero was, as a date and in seconds from 1970.
pub(super) fn information(unix_s_at_zero: f64) -> Vec<(String, String)> {
    let Some(words) = text(unix_s_at_zero) else { return Vec::new() };
    vec![("utc_at_start".into(), words), ("unix_s_at_start".into(), format!("{unix_s_at_zero:.3}"))]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `date -u -d @...` says so.
    #[test]
    fn dates() {
        assert_eq!(text(1_714_566_896.789).as_deref(), Some("2024-05-01T12:34:56.789Z"));
        assert_eq!(text(1_709_164_800.0).as_deref(), Some("2024-02-29T00:00:00.000Z"));
        assert_eq!(text(951_868_799.999_9).as_deref(), Some("2000-03-01T00:00:00.000Z"));
        assert_eq!(text(f64::NAN), None);
        assert_eq!(text(0.0), None);
    }

    /// Week 2000 began on 2018-05-06 at 00:00:00 GPS, 18 s before that in UTC.
    #[test]
    fn gps_weeks() {
        assert_eq!(text(from_gps(2000.0, 18.0)).as_deref(), Some("2018-05-06T00:00:00.000Z"));
        assert_eq!(text(from_gps(1800.0, 16.0)).as_deref(), Some("2014-07-06T00:00:00.000Z"));
    }
}
