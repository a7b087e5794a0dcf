//! The clock of the vehicle, by its own stamps.

/// Stamps from here on, us, count from 1970 and not from the start of the vehicle: three years.
pub(super) const EPOCH_US: f64 = 1e14;
/// A stamp that is further behind the newest one, us, stands against the order of time.
const LATE_US: f64 = 1e6;
/// A stamp that is so much further ahead than the clock of the ground station has moved, us, is not believed either.
const AHEAD_US: f64 = 10e6;
/// So many such stamps in a row are believed: the clock has begun again, or has leapt.
const IN_A_ROW: u32 = 5;

/// The newest time of the vehicle.
#[derive(Debug, Default)]
pub(super) struct Clock {
    /// Newest time and its arrival by the clock of the ground station, us.
    newest: Option<(f64, f64)>,
    /// What is added to the stamps since the clock has begun again, us.
    offset_us: f64,
    contrary: u32,
    /// Number of times that the clock has begun again.
    pub(super) restarts: u64,
    /// Stamps that were not believed.
    pub(super) left_out: u64,
}

impl Clock {
    /// The newest time, us; `None` before the first.
    pub(super) fn newest_us(&self) -> Option<f64> {
        self.newest.map(|(time, _)| time)
    }

    /// The time that a stamp means, us, of a message that came at `arrival_us`; `None` if the stamp is not believed.
    pub(super) fn take(&mut self, stamp_us: f64, arrival_us: f64) -> Option<f64> {
        let time = stamp_us + self.offset_us;
        let Some((newest, came)) = self.newest else {
            self.newest = Some((time, arrival_us));
            return Some(time);
        };
        let since = (arrival_us - came).max(0.0);
        let (late, ahead) = (time < newest - LATE_US, time > newest + since + AHEAD_US);
        if !late && !ahead {
            self.contrary = 0;
            if time >= newest {
                self.newest = Some((time, arrival_us));
            }
            return Some(time);
        }
        self.contrary += 1;
        if self.contrary < IN_A_ROW {
            self.left_out += 1;
            return None;
        }
        self.contrary = 0;
        let time = if late {
            self.restarts += 1;
            // A millisecond at least, so that no time comes twice.
            let now = newest + since.max(1000.0);
            self.offset_us += now - time;
            now
        } else {
            time
        };
        self.newest = Some((time, arrival_us));
        Some(time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_begins_again_goes_on_and_one_wrong_stamp_is_left_out() {
        let mut clock = Clock::default();
        let at = |k: u32| 1.7e15 + 20_000.0 * f64::from(k);
        for k in 0..100 {
            assert_eq!(clock.take(5e6 + 20_000.0 * f64::from(k), at(k)), Some(5e6 + 20_000.0 * f64::from(k)));
        }
        assert_eq!(clock.take(4e12, at(100)), None);
        assert_eq!(clock.take(0.0, at(100)), None);
        assert_eq!(clock.take(7e6, at(100)), Some(7e6));
        assert_eq!((clock.restarts, clock.left_out), (0, 2));
        // Five stamps from the new start are needed; the time then is that of the ground station, 100 ms later.
        let again: Vec<_> = (1..=6).map(|k| clock.take(20_000.0 * f64::from(k), at(100 + k))).collect();
        assert_eq!(again, [None, None, None, None, Some(7.1e6), Some(7.12e6)]);
        assert_eq!(clock.restarts, 1);
    }
}
