//! The Gregorian calendar: days from 1970-01-01 and dates.
//!
//! Counted in years that begin in March, so that a leap day is the last of its year.

/// Days from 0000-03-01 to 1970-01-01.
const TO_1970: i64 = 719_468;

/// Days from 1970-01-01 to a date; months and days count from 1.
pub(crate) fn days(year: i64, month: u32, day: u32) -> i64 {
    let (year, month) = (year - i64::from(month <= 2), i64::from((month + 9) % 12));
    365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + i64::from(day)
        - 1
        - TO_1970
}

/// Year, month (1 to 12) and day of the month (from 1) of a number of days from 1970-01-01.
///
/// ```
/// assert_eq!(phugoid_flight_data::calendar::date(19_844), (2024, 5, 1));
/// ```
pub fn date(days: i64) -> (i64, i64, i64) {
    // Within eras of 400 years, which have 146,097 days each.
    let days = days + TO_1970;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (era * 400 + year + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_come_back_from_their_days() {
        assert_eq!(days(1970, 1, 1), 0);
        // `date -u -d 2024-05-01 +%s` over 86,400.
        assert_eq!(days(2024, 5, 1), 19_844);
        for day in -800_000..800_000 {
            let (year, month, of_month) = date(day);
            assert_eq!(days(year, month as u32, of_month as u32), day);
        }
    }
}
