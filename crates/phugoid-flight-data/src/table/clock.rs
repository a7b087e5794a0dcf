//! Times of day and dates written as text, in the forms that recorders and spreadsheets write.

use std::ops::Range;

use crate::calendar;
use crate::quality::Start;

/// A clock time as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading {
    /// Seconds from midnight, from the full hour ([`Cycle::Hour`]) or from the first of January ([`Cycle::Year`]).
    seconds: f64,
    cycle: Cycle,
    date: Option<Date>,
    /// How far the local time is ahead of UTC, s; `None` where nothing is written.
    ahead: Option<f64>,
}

/// After which time a clock without a date shows the same again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cycle {
    /// `34:56.7`: minutes and seconds.
    Hour,
    /// `12:34:56.7`.
    Day,
    /// `123:12:34:56.7`: the day of the year before it, as IRIG time codes have it.
    Year,
}

impl Cycle {
    fn seconds(self) -> f64 {
        match self {
            Self::Hour => 3600.0,
            Self::Day => DAY,
            // A flight at New Year is put right within a day; no record lasts a year.
            Self::Year => 365.0 * DAY,
        }
    }
}

/// The numbers of a date in the order of year, month, day, or, where only the file can tell, of its two first numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Date {
    /// Year, month, day.
    Known(i64, u32, u32),
    /// `05/01/2024`: the 5th of January or the 1st of May. First number, second number, year.
    DayOrMonthFirst(u32, u32, i64),
}

/// Seconds of a day.
pub(crate) const DAY: f64 = 86_400.0;
/// Seconds of an hour, by which clocks are changed in spring and autumn.
const HOUR: f64 = 3600.0;
/// Rows stand within this of the change of the clock, s: times may be written to the second, one row a second.
const AT_CHANGE: f64 = 2.0;

/// Reads the clock times of one column from row to row: counts on where a clock without a date starts again at midnight, and
/// learns whether day or month comes first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clock {
    last: Option<f64>,
    turns: f64,
    month_first: Option<bool>,
    /// The numbers of the last date whose order is not written.
    numbers: Option<(u32, u32, i64)>,
    /// Days by which dates are moved, because the rows before were read in the other order.
    shift: f64,
    dated: bool,
    /// How far ahead of UTC the first time is; `None` before it was read. The inner one is that of [`Reading`].
    ahead: Option<Option<f64>>,
    /// Not all times show a time of day ahead of UTC by as much.
    changing: bool,
    /// A time without a zone was read: nobody knows that these are UTC.
    local: bool,
    /// How far the clock was put back in all, s: an hour where summer time ended during the record, minus an hour where it began.
    put_back: f64,
    /// How often the clock was changed to or from summer time.
    changes: usize,
}

impl Clock {
    /// True if the text is a clock time in one of the forms that are read.
    pub(crate) fn is_one(text: &str) -> bool {
        read(text).is_some()
    }

    /// Seconds from 1970 (UTC where an offset or `Z` says so) of a time with a date, else from midnight, from the full hour or
    /// from the first of January, counted on over the end of each; `None` for other texts.
    pub(crate) fn seconds(&mut self, text: &str) -> Option<f64> {
        let reading = read(text)?;
        self.local |= reading.ahead.is_none();
        self.changing |= reading.cycle == Cycle::Hour || *self.ahead.get_or_insert(reading.ahead) != reading.ahead;
        let seconds = match reading.date {
            Some(date) => {
                self.dated = true;
                self.days(date)? * DAY + reading.seconds - reading.ahead.unwrap_or(0.0)
            }
            None => {
                let cycle = reading.cycle.seconds();
                let counted = reading.seconds + self.turns * cycle;
                if self.last.is_some_and(|last| counted < last - 0.5 * cycle) {
                    self.turns += 1.0;
                    counted + cycle
                } else {
                    counted
                }
            }
        };
        if let Some(last) = self.last.filter(|_| reading.ahead.is_none() && reading.cycle != Cycle::Hour)
            && let Some(put_back) = summer_time_change(last, seconds)
        {
            self.put_back += put_back;
            self.changes += 1;
        }
        self.last = Some(seconds);
        Some(seconds + self.put_back)
    }

    /// How often the clock was changed to or from summer time between two rows.
    pub(crate) fn changes(&self) -> usize {
        self.changes
    }

    /// How often a clock without a date began again.
    pub(crate) fn turns(&self) -> f64 {
        self.turns
    }

    /// When a time that this clock gave was; `None` for clocks without a date.
    pub(crate) fn start(&self, seconds: f64) -> Option<Start> {
        // Two orders of day and month are two dates, and only a file of several days tells which it is.
        let sure = self.month_first.is_some() || self.numbers.is_none();
        let unix_s = seconds - self.shift * DAY;
        (self.dated && sure && unix_s.is_finite()).then_some(Start { unix_s, is_utc: !self.local })
    }

    /// The time of day, s, that the file writes where this clock gave a time; `None` where the clock shows no hours, or changes.
    pub(crate) fn time_of_day(&self, seconds: f64) -> Option<f64> {
        let ahead = self.ahead.filter(|_| !self.changing && self.changes == 0)?;
        Some((seconds + ahead.unwrap_or(0.0)).rem_euclid(DAY))
    }

    /// The seconds from midnight of a time of day that is written alone; `None` for other texts.
    pub(crate) fn written_time_of_day(text: &str) -> Option<f64> {
        let reading = read(text).filter(|reading| reading.cycle == Cycle::Day && reading.date.is_none())?;
        reading.ahead.is_none().then_some(reading.seconds)
    }

    /// A time that this clock gave, as date and time of day.
    pub(crate) fn written(&self, seconds: f64) -> String {
        written(seconds, self.dated)
    }

    /// Days from 1970-01-01.
    fn days(&mut self, date: Date) -> Option<f64> {
        let (first, second, year) = match date {
            Date::Known(year, month, day) => return Some(calendar::days(year, month, day) as f64),
            Date::DayOrMonthFirst(first, second, year) => (first, second, year),
        };
        let before = self.numbers.replace((first, second, year)).filter(|before| *before != (first, second, year));
        if self.month_first.is_none() {
            self.month_first = match before {
                _ if first > 12 || second > 12 => Some(second > 12),
                // From one row to the next the day changes, and the month hardly ever.
                Some((first_before, second_before, _)) if first_before == first || second_before == second => {
                    Some(first_before == first)
                }
                _ => None,
            };
            if let (Some(true), Some((first, second, year))) = (self.month_first, before) {
                // Up to here the day was taken to be first. The rows behind go on from there: only steps in time count.
                self.shift = in_order(first, second, year, false)? - in_order(first, second, year, true)?;
            }
        }
        Some(in_order(first, second, year, self.month_first == Some(true))? + self.shift)
    }
}

/// By how much a local clock was put back between two rows, s: an hour at the end of summer time, minus an hour at its begin;
/// `None` where it ran on. Both happen on the full hour.
fn summer_time_change(last: f64, next: f64) -> Option<f64> {
    let on_the_hour = next.rem_euclid(HOUR) <= AT_CHANGE && HOUR - last.rem_euclid(HOUR) <= AT_CHANGE;
    let by = |put_back: f64| on_the_hour && (0.0..=AT_CHANGE).contains(&(next + put_back - last));
    [HOUR, -HOUR].into_iter().find(|put_back| by(*put_back))
}

/// Days from 1970-01-01 to a date in one of the two orders; `None` where there is no such date.
fn in_order(first: u32, second: u32, year: i64, month_first: bool) -> Option<f64> {
    let (month, day) = if month_first { (first, second) } else { (second, first) };
    Some(calendar::days(year, in_range(month, 1..13)?, in_range(day, 1..32)?) as f64)
}

fn in_range(number: u32, range: Range<u32>) -> Option<u32> {
    range.contains(&number).then_some(number)
}

/// Seconds as `2024-05-01 12:34:56.500000`, counted from 1970, or, without a date, as the time of day, counted from midnight;
/// rounded to microseconds.
pub(crate) fn written(seconds: f64, dated: bool) -> String {
    const MICROSECONDS_PER_DAY: i128 = 86_400_000_000;
    let all = (seconds * 1e6).round() as i128;
    let (days, of_day) = (all.div_euclid(MICROSECONDS_PER_DAY), all.rem_euclid(MICROSECONDS_PER_DAY));
    let (of_day, microseconds) = (of_day / 1_000_000, of_day % 1_000_000);
    let (hours, minutes, seconds) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    let time = format!("{hours:02}:{minutes:02}:{seconds:02}.{microseconds:06}");
    if !dated {
        return time;
    }
    let (year, month, day) = calendar::date(days as i64);
    format!("{year:04}-{month:02}-{day:02} {time}")
}

fn read(text: &str) -> Option<Reading> {
    let text = text.trim();
    // Nothing that is read is longer, and most cells are numbers.
    if text.len() > 48 || !text.as_bytes().first()?.is_ascii_digit() || !text.contains([':', 'T', 't', '_']) {
        return None;
    }
    let (text, ahead) = offset(text)?;
    let (date, time) = match split_date(text) {
        Some((date, time)) => (Some(read_date(date)?), time),
        None => (None, text),
    };
    let (seconds, cycle) = time_of_day(time.trim(), date.is_some())?;
    (date.is_none() || cycle == Cycle::Day).then_some(Reading { seconds, cycle, date, ahead })
}

/// Takes `Z`, `UTC`, `GMT` and offsets such as `+02:00` from the end, and gives the offset, s; none where nothing
/// of the kind is written.
fn offset(text: &str) -> Option<(&str, Option<f64>)> {
    let lower = text.to_ascii_lowercase();
    let kept = |end: &str| text.get(..text.len() - end.len()).map(str::trim_end);
    for end in ["utc", "gmt", "z"] {
        if lower.ends_with(end) {
            return Some((kept(end)?, Some(0.0)));
        }
    }
    // The sign of an offset stands behind the colons of the time; those of a date stand before.
    let Some(sign) = text.rfind(['+', '-']).filter(|sign| text.get(..*sign).is_some_and(|time| time.contains(':')))
    else {
        return Some((text, None));
    };
    let digits: String = text.get(sign + 1..)?.chars().filter(|c| *c != ':').collect();
    let number: f64 = digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok()).flatten()?;
    let seconds = match digits.len() {
        1 | 2 => number * 3600.0,
        4 => (number / 100.0).floor() * 3600.0 + number % 100.0 * 60.0,
        _ => return None,
    };
    let negative = text.as_bytes().get(sign) == Some(&b'-');
    let rest = text.get(..sign)?.trim_end();
    let rest = rest.strip_suffix("UTC").or_else(|| rest.strip_suffix("GMT")).unwrap_or(rest).trim_end();
    Some((rest, Some(if negative { -seconds } else { seconds })))
}

/// Splits a date from the time behind it; `None` where there is no date.
fn split_date(text: &str) -> Option<(&str, &str)> {
    let (date, time) = text.split_once(['T', 't', ' ', '_'])?;
    // `12:34:56 PM` has its first blank behind the time.
    (!date.contains(':')).then(|| (date.trim_end_matches(','), time.trim().trim_start_matches("- ")))
}

fn read_date(text: &str) -> Option<Date> {
    let number = |part: &str, most: usize| digits(part, most);
    if let Some(compact) = (text.len() == 8 && text.bytes().all(|b| b.is_ascii_digit())).then_some(text) {
        let part = |range: Range<usize>| compact.get(range).and_then(|part| number(part, 4));
        return known(part(0..4)?.into(), part(4..6)?, part(6..8)?);
    }
    let mark = text.chars().find(|c| ['-', '/', '.'].contains(c))?;
    let parts: Vec<&str> = text.split(mark).collect();
    let [first, second, third] = parts.as_slice() else { return None };
    let year = |part: &str| -> Option<i64> {
        let number = i64::from(number(part, 4)?);
        match part.len() {
            4 => Some(number),
            2 => Some(number + if number < 70 { 2000 } else { 1900 }),
            _ => None,
        }
    };
    if first.len() == 4 {
        return known(year(first)?, month(second)?, number(third, 2)?);
    }
    if second.bytes().all(|b| b.is_ascii_alphabetic()) {
        return known(year(third)?, month(second)?, number(first, 2)?);
    }
    let (a, b, year) = (number(first, 2)?, number(second, 2)?, year(third)?);
    // Dates with points have the day first everywhere.
    if mark == '.' { known(year, b, a) } else { Some(Date::DayOrMonthFirst(a, b, year)) }
}

fn known(year: i64, month: u32, day: u32) -> Option<Date> {
    Some(Date::Known(year, in_range(month, 1..13)?, in_range(day, 1..32)?))
}

fn month(text: &str) -> Option<u32> {
    const NAMES: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    if let Some(number) = digits(text, 2) {
        return Some(number);
    }
    let short = text.get(..3)?.to_ascii_lowercase();
    (1..).zip(NAMES).find(|(_, name)| *name == short).map(|(number, _)| number)
}

/// Seconds of the time and the cycle of the clock that shows it. `dated` allows times without colons (`123456.7`).
fn time_of_day(text: &str, dated: bool) -> Option<(f64, Cycle)> {
    let lower = text.to_ascii_lowercase();
    let half = [("am", 0), ("a.m.", 0), ("pm", 12), ("p.m.", 12)]
        .into_iter()
        .find_map(|(end, hours)| Some((lower.strip_suffix(end)?.trim_end().len(), hours)));
    let time = half.map_or(Some(text), |(length, _)| text.get(..length))?;
    let parts: Vec<&str> = time.split(':').collect();
    match *parts.as_slice() {
        [hours, minutes, seconds] => {
            let mut hours = in_range(digits(hours, 2)?, 0..24)?;
            if let Some((_, add)) = half {
                hours = in_range(hours, 1..13)? % 12 + add;
            }
            Some((f64::from(hours * 3600 + sixty(minutes)? * 60) + fraction(seconds)?, Cycle::Day))
        }
        // `12:34` could be hours and minutes; a fraction tells that the second number is seconds.
        [minutes, seconds] if half.is_none() && seconds.contains(['.', ',']) => {
            Some((f64::from(sixty(minutes)? * 60) + fraction(seconds)?, Cycle::Hour))
        }
        [first, second, third, fourth] if half.is_none() => {
            let of_day = |hours: &str, minutes: &str, seconds: f64| {
                Some(f64::from(in_range(digits(hours, 2)?, 0..24)? * 3600 + sixty(minutes)? * 60) + seconds)
            };
            if first.len() == 3 {
                let day = in_range(digits(first, 3)?, 1..367)?;
                let seconds = of_day(second, third, fraction(fourth)?)?;
                return Some((f64::from(day - 1) * DAY + seconds, Cycle::Year));
            }
            // `12:34:56:789`: thousandths behind a colon.
            let thousandths = (fourth.len() == 3).then(|| digits(fourth, 3)).flatten()?;
            let seconds = f64::from(sixty(third)?) + f64::from(thousandths) / 1000.0;
            Some((of_day(first, second, seconds)?, Cycle::Day))
        }
        [compact] if dated && half.is_none() => {
            let part = |range: Range<usize>| compact.get(range).and_then(|part| digits(part, 2));
            let hours = in_range(part(0..2)?, 0..24)?;
            let minutes = in_range(part(2..4)?, 0..60)?;
            Some((f64::from(hours * 3600 + minutes * 60) + fraction(compact.get(4..)?)?, Cycle::Day))
        }
        _ => None,
    }
}

fn sixty(text: &str) -> Option<u32> {
    in_range(digits(text, 2)?, 0..60)
}

/// Seconds with a point or a comma before the fraction; 60 stands for a leap second.
fn fraction(text: &str) -> Option<f64> {
    let plain =
        text.bytes().next()?.is_ascii_digit() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.' || b == b',');
    let seconds: f64 = plain.then(|| text.replacen(',', ".", 1).parse().ok()).flatten()?;
    (0.0..61.0).contains(&seconds).then_some(seconds)
}

fn digits(part: &str, most: usize) -> Option<u32> {
    let good = !part.is_empty() && part.len() <= most && part.bytes().all(|b| b.is_ascii_digit());
    good.then(|| part.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(text: &str) -> Option<f64> {
        Clock::default().seconds(text)
    }

    #[test]
    fn times_of_day() {
        for (text, expected) in [
            ("00:01:02.5", 62.5),
            ("0:01:02,5", 62.5),
            ("12:34:56", 45_296.0),
            ("12:34:56 PM", 45_296.0),
            ("12:00:01.5 am", 1.5),
            ("1:00:00 p.m.", 46_800.0),
            ("12:34:56:789", 45_296.789),
            ("34:56.7", 2096.7),
            ("002:00:00:01.25", 86_401.25),
            ("12:34:56Z", 45_296.0),
        ] {
            assert_eq!(seconds(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn dates() {
        // `date -u -d 2024-05-01T12:34:56Z +%s`
        let may = 1_714_566_896.0;
        for text in [
            "2024-05-01T12:34:56Z",
            "2024-05-01 12:34:56",
            "2024/05/01 12:34:56",
            "20240501T123456Z",
            "20240501_123456.0",
            "2024-05-01T14:34:56+02:00",
            "2024-05-01T14:34:56+0200",
            "2024-05-01 10:04:56 UTC-02:30",
            "01.05.2024 12:34:56",
            "1.5.24 12:34:56",
            "01-May-2024 12:34:56",
            "1-may-24 12:34:56",
            "13/05/2024 12:34:56",
            "05/13/2024 12:34:56 PM",
        ] {
            let expected = if text.contains("13/") { may + 12.0 * DAY } else { may };
            assert_eq!(seconds(text), Some(expected), "{text}");
        }
        assert_eq!(seconds("1970-01-01T00:00:00Z"), Some(0.0));
        assert_eq!(seconds("2024-02-29 00:00:00"), Some(1_709_164_800.0));
    }

    #[test]
    fn the_start_is_known_where_a_date_is_written() {
        let start = |texts: &[&str]| {
            let mut clock = Clock::default();
            let times: Vec<f64> = texts.iter().filter_map(|text| clock.seconds(text)).collect();
            clock.start(times[0]).map(|start| (start.unix_s, start.is_utc))
        };
        let may = 1_714_566_896.0;
        assert_eq!(start(&["2024-05-01T12:34:56Z"]), Some((may, true)));
        assert_eq!(start(&["2024-05-01T14:34:56+02:00"]), Some((may, true)));
        assert_eq!(start(&["2024-05-01 12:34:56"]), Some((may, false)));
        // One row without a zone makes all of them local.
        assert_eq!(start(&["2024-05-01T12:34:56Z", "2024-05-01T12:34:57"]), Some((may, false)));
        assert_eq!(start(&["12:34:56Z"]), None);
        assert_eq!(start(&["123:12:34:56"]), None);
        // The fifth of January or the first of May: only the next day tells.
        assert_eq!(start(&["05/01/2024 12:34:56"]), None);
        assert_eq!(start(&["05/01/2024 12:34:56", "05/02/2024 12:34:56"]), Some((may, false)));
        assert_eq!(start(&["01/05/2024 12:34:56", "02/05/2024 12:34:56"]), Some((may, false)));
    }

    #[test]
    fn the_time_of_day_is_the_written_one() {
        let first = |texts: &[&str]| {
            let mut clock = Clock::default();
            let times: Vec<f64> = texts.iter().filter_map(|text| clock.seconds(text)).collect();
            clock.time_of_day(times[0])
        };
        let noon = 12.0 * HOUR;
        for text in ["12:00:00", "12:00:00.0Z", "2024-05-01T12:00:00Z", "2024-05-01T12:00:00+02:00", "123:12:00:00.0"] {
            assert_eq!(first(&[text]), Some(noon), "{text}");
        }
        assert_eq!(first(&["12:00.5"]), None, "minutes and seconds");
        assert_eq!(first(&["2024-05-01T12:00:00+02:00", "2024-05-01T11:00:01+01:00"]), None);
        assert_eq!(first(&["01:59:59.5", "03:00:00.5"]), None, "summer time begins");
    }

    #[test]
    fn a_local_clock_is_changed_to_and_from_summer_time() {
        let steps = |texts: &[&str]| {
            let mut clock = Clock::default();
            let times: Vec<f64> = texts.iter().filter_map(|text| clock.seconds(text)).collect();
            (
                times.windows(2).map(|pair| ((pair[1] - pair[0]) * 1e3).round() / 1e3).collect::<Vec<_>>(),
                clock.changes(),
            )
        };
        let autumn = ["27.10.2024 02:59:59,98", "27.10.2024 02:00:00,00", "27.10.2024 02:00:00,02"];
        assert_eq!(steps(&autumn), (vec![0.02, 0.02], 1));
        assert_eq!(steps(&["2:59:59", "2:00:00", "2:00:01"]), (vec![1.0, 1.0], 1));
        assert_eq!(
            steps(&["31.03.2024 01:59:59.9", "31.03.2024 03:00:00", "31.03.2024 03:00:00.1"]),
            (vec![0.1, 0.1], 1)
        );
        // Over midnight, as in Brazil until 2019.
        assert_eq!(steps(&["17.02.2018 23:59:59.5", "17.02.2018 23:00:00"]), (vec![0.5], 1));
        // With a zone nothing is changed, and not on the full hour it is another fault or a gap.
        let zoned = ["2024-10-27T02:59:59+02:00", "2024-10-27T02:00:00+01:00"];
        assert_eq!(steps(&zoned), (vec![1.0], 0));
        assert_eq!(steps(&["2:40:00", "1:40:01"]), (vec![-3599.0], 0));
        assert_eq!(steps(&["2:59:50", "2:00:00"]), (vec![-3590.0], 0));
        assert_eq!(steps(&["23:59:59.9", "00:00:00.1"]), (vec![0.2], 0));
    }

    #[test]
    fn other_texts_are_no_clock() {
        for text in [
            "",
            "1.5",
            "12:34",
            "25:00:00",
            "12:60:00",
            "12:00:99",
            "a:b:c",
            "2024-13-01T00:00:00",
            "1:2:3:4",
            "T",
            "1T",
            "13:00:00 PM",
            "12:34:56.7.8",
            "2024-05-01",
            "1:2",
            "00:00:00:00",
            "12:3é:00",
            "1T2",
            "12:00:00+",
            "é:00:00",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }

    #[test]
    fn a_clock_without_a_date_counts_on() {
        let mut clock = Clock::default();
        let times = ["23:59:59.5", "00:00:00.0", "00:00:00.5"].map(|text| clock.seconds(text).unwrap());
        assert_eq!(times, [86_399.5, 86_400.0, 86_400.5]);
        assert_eq!(clock.turns(), 1.0);
        let mut clock = Clock::default();
        let times = ["59:59.9", "00:00.0"].map(|text| clock.seconds(text).unwrap());
        assert!((times[1] - times[0] - 0.1).abs() < 1e-9);
    }

    #[test]
    fn a_time_is_written_as_it_was_read() {
        for text in [
            "2024-02-29 23:59:59.125000",
            "1970-01-01 00:00:00.000000",
            "1999-12-31 12:00:00.500000",
            "12:34:56.500001",
        ] {
            let mut clock = Clock::default();
            let seconds = clock.seconds(text).unwrap();
            assert_eq!(clock.written(seconds), text);
        }
    }

    #[test]
    fn a_month_before_the_day_is_found_at_midnight() {
        for (last, first) in [
            ("05/01/2024 23:59:59", "05/02/2024 00:00:00"),
            ("01/05/2024 23:59:59", "02/05/2024 00:00:00"),
            ("05/13/2024 23:59:59", "05/14/2024 00:00:00"),
            ("05/12/2024 23:59:59", "05/13/2024 00:00:00"),
        ] {
            let mut clock = Clock::default();
            let before = clock.seconds(last).unwrap();
            assert_eq!(clock.seconds(first).unwrap() - before, 1.0, "{last}");
        }
    }
}
