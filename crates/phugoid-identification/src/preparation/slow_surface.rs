//! Surfaces that were recorded more slowly than the record that they are in.
//!
//! Logs of autopilots hold the surfaces at 10 Hz beside rates at 50 Hz. Held until its next sample, such a surface is late by half
//! of its own step, 50 ms, while the aircraft has long reacted: the derivatives by the surface and by the rates are then wrong by
//! several of their bounds. A record shows the next sample, too, so that the surface can run straight to it.

use phugoid_flight_data::statistics::median_step;

use crate::preparation::noise::OwnSamples;
use crate::preparation::resample::at_times;

/// How probable it is that a surface which is seen only at times moves in steps from one of its samples to the next. The programs
/// of autopilots compute their surfaces more often than they log them, and transducers are sampled by one clock: steps of the
/// log itself are rare.
const IN_STEPS: f64 = 0.2;

/// The samples of one surface that is slower than its record.
#[derive(Clone, Debug)]
pub(crate) struct SlowSurface {
    /// Canonical name.
    pub(crate) name: String,
    /// Times of its own samples, s.
    pub(crate) time_s: Vec<f64>,
    /// Its own samples, rad.
    pub(crate) values: Vec<f64>,
    /// Median step of its own samples, s.
    pub(crate) step_s: f64,
    /// True if the rows between its own samples are empty; false if they repeat the last one.
    pub(crate) has_gaps: bool,
}

impl SlowSurface {
    /// The own samples of the surface `name`, of which `values` (rad, NaN where missing) are recorded at `time_s`; `None` if it is
    /// as fast as the record.
    pub(crate) fn of(name: &str, time_s: &[f64], values: &[f64]) -> Option<Self> {
        let own = OwnSamples::of(values)?;
        let rows = own.rows();
        let present = values.iter().filter(|value| value.is_finite()).count();
        let own_s: Vec<f64> = rows.iter().map(|row| time_s[*row]).collect();
        Some(Self {
            name: name.to_owned(),
            values: rows.iter().map(|row| values[*row]).collect(),
            step_s: median_step(&own_s)?,
            time_s: own_s,
            has_gaps: present == rows.len(),
        })
    }

    /// The surface at these times (s), straight from each of its own samples to the next.
    pub(crate) fn straight(&self, time_s: &[f64]) -> Vec<f64> {
        at_times(time_s.iter().copied(), &self.time_s, &self.values)
    }

    /// The surface at these times (s), held from each of its own samples until the next.
    pub(crate) fn held(&self, time_s: &[f64]) -> Vec<f64> {
        let last = |t: f64| self.time_s.partition_point(|own| *own <= t).saturating_sub(1);
        time_s.iter().map(|t| self.values[last(*t)]).collect()
    }

    /// One sigma of the time of the surface, s, where the record does not say how it moved between its own samples and it is taken
    /// to run straight or to be held: half of a step off, if it moved in the other way.
    pub(crate) fn undecided_std_s(&self, is_straight: bool) -> f64 {
        let other_way = if is_straight { IN_STEPS } else { 1.0 - IN_STEPS };
        other_way.sqrt() * 0.5 * self.step_s
    }

    /// The same where it is held because what comes later is not known: late by half of a step in the mean, whatever it did.
    pub(crate) fn held_std_s(&self) -> f64 {
        0.5 * self.step_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A surface that moves evenly, with a sample of its own in every fifth row.
    fn ramp(repeated: bool) -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..200).map(|row| 0.02 * f64::from(row)).collect();
        let last = |row: i32| 0.01 * f64::from(row - row % 5);
        let value = |row: i32| if repeated || row % 5 == 0 { last(row) } else { f64::NAN };
        (time_s, (0..200).map(value).collect())
    }

    #[test]
    fn a_slow_surface_runs_straight_or_is_held_between_its_own_samples() {
        for repeated in [false, true] {
            let (time_s, values) = ramp(repeated);
            let slow = SlowSurface::of("elevator", &time_s, &values).unwrap();
            assert_eq!((slow.has_gaps, slow.values.len()), (!repeated, 40));
            assert!((slow.step_s - 0.1).abs() < 1e-12);
            let straight = slow.straight(&time_s);
            assert!((0..195).all(|row| (straight[row] - 0.01 * row as f64).abs() < 1e-12));
            assert_eq!(slow.held(&time_s)[4], 0.0);
            assert_eq!(slow.held(&time_s)[5], 0.05);
            // What is held is the less probable of the two, and is open the farther.
            let [straight, held] = [true, false].map(|is_straight| slow.undecided_std_s(is_straight));
            assert!((straight.hypot(held) - 0.05).abs() < 1e-12 && straight < held, "{straight} {held}");
        }
    }

    #[test]
    fn a_surface_that_lost_some_samples_is_not_slow() {
        let (time_s, _) = ramp(false);
        let values: Vec<f64> = (0..200).map(|row| if row % 17 == 0 { f64::NAN } else { f64::from(row % 7) }).collect();
        assert!(SlowSurface::of("elevator", &time_s, &values).is_none());
    }
}
