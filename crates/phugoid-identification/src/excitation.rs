//! Has the aircraft been moved at all?
//!
//! Increments to a database are learnt from departures from the reference point. Before there is any, the estimated
//! angle of attack still wanders about it by its own noise wherever process noise is allowed for, and an estimator that
//! linearises about its estimate takes that wander for excitation: on a simulated F-16 in steady flight it "learnt"
//! dCL_alpha to 0.3 where the prior is 0.75, and was seven of these sigmas wrong. So the estimates of increments start
//! with the first motion that is visible above the noise, not before. In absolute form steady flight does tell something,
//! but of sums of terms: there the estimator runs from the first sample, and its estimates are shown from the first motion
//! on.

use crate::longitudinal::{OUTPUTS, row};

/// A departure this many sigmas from the first window counts as motion.
const SIGMAS: f64 = 6.0;
/// Length of the windows that are averaged, s.
const WINDOW_S: f64 = 0.25;
/// Smallest elevator motion that counts, rad: rounding is not an input.
const SMALLEST_ELEVATOR: f64 = 1e-5;

/// Watches elevator, angle of attack and pitch rate for the first motion; causal.
#[derive(Clone, Debug)]
pub(crate) struct Excitation {
    noise: [f64; 2],
    elevator_noise: f64,
    elevator_start: f64,
    start: [Option<f64>; 2],
    window_start_s: f64,
    sums: [f64; 2],
    counts: [u32; 2],
    seen: bool,
}

impl Excitation {
    /// With the noise of the outputs and of the elevator (one sigma, SI) and the elevator's first value (rad).
    pub(crate) fn new(noise: [f64; OUTPUTS], elevator_noise: f64, elevator_start: f64) -> Self {
        Self {
            noise: [noise[row::ALPHA], noise[row::PITCH_RATE]],
            elevator_noise,
            elevator_start,
            start: [None; 2],
            window_start_s: f64::NAN,
            sums: [0.0; 2],
            counts: [0; 2],
            seen: false,
        }
    }

    /// Takes a sample; true from the first visible motion on.
    pub(crate) fn update(&mut self, time_s: f64, elevator: f64, outputs: &[f64; OUTPUTS]) -> bool {
        let threshold = SMALLEST_ELEVATOR.max(SIGMAS * self.elevator_noise);
        if (elevator - self.elevator_start).abs() > threshold {
            self.seen = true;
        }
        if self.window_start_s.is_nan() {
            self.window_start_s = time_s;
        }
        if time_s - self.window_start_s >= WINDOW_S - 1e-9 {
            self.close_window();
            self.window_start_s = time_s;
        }
        for (i, output) in [row::ALPHA, row::PITCH_RATE].into_iter().enumerate() {
            let value = outputs[output];
            if value.is_finite() {
                self.sums[i] += value;
                self.counts[i] += 1;
            }
        }
        self.seen
    }

    fn close_window(&mut self) {
        for i in 0..2 {
            if self.counts[i] > 0 {
                let n = f64::from(self.counts[i]);
                let mean = self.sums[i] / n;
                match self.start[i] {
                    None => self.start[i] = Some(mean),
                    // Both means are uncertain by sigma over the root of n; an outlier moves one by twenty sigmas over n.
                    Some(start) => {
                        let limit = SIGMAS * self.noise[i] * (2.0 / n).sqrt() + 20.0 * self.noise[i] / n;
                        self.seen |= (mean - start).abs() > limit;
                    }
                }
            }
            self.sums[i] = 0.0;
            self.counts[i] = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first_motion(elevator: impl Fn(f64) -> f64, alpha: impl Fn(f64) -> f64) -> Option<f64> {
        let mut noise = [0.0; OUTPUTS];
        noise[row::ALPHA] = 1.7e-3;
        noise[row::PITCH_RATE] = 1.7e-3;
        let mut watch = Excitation::new(noise, 0.0, elevator(0.0));
        (0..1000).map(|k| 0.02 * f64::from(k)).find(|t| {
            let mut outputs = [0.0; OUTPUTS];
            // A triangle wave of one sigma stands for the noise.
            outputs[1] = alpha(*t) + 1.7e-3 * (((t / 0.02) as i32 % 5 - 2) as f64) / 1.4;
            watch.update(*t, elevator(*t), &outputs)
        })
    }

    #[test]
    fn motion_is_seen_and_noise_is_not() {
        assert_eq!(first_motion(|_| -0.03, |_| 0.04), None);
        // A doublet of 0.05 deg, as in the thesis.
        let doublet = |t: f64| if t >= 5.0 { 8.7e-4 } else { 0.0 };
        assert!((first_motion(doublet, |_| 0.04).unwrap() - 5.0).abs() < 0.021);
        // A gust that moves alpha by one degree.
        let seen = first_motion(|_| 0.0, |t| if t > 8.0 { 0.057 } else { 0.04 }).unwrap();
        assert!((8.0..8.6).contains(&seen), "{seen}");
    }
}
