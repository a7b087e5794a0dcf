//! Small inputs on top of the pilot's, as long as a bound that matters is too wide.
//!
//! Three multisines, one per surface, of different harmonics of one period: within a period they are orthogonal, so that the three
//! surfaces can be told apart although a controller moves them together (Morelli 2003). Their size follows from how much too wide the
//! bounds are, and falls to zero at once where the aircraft comes near a limit.

use crate::local::SURFACES;

/// Harmonics of each surface. Their phases spread the power evenly over the period (Schroeder).
const HARMONICS: [[u32; 4]; SURFACES] = [[2, 5, 8, 11], [3, 6, 9, 12], [4, 7, 10, 13]];
/// Time in which the size grows from nothing to all, s.
const RISE: f64 = 0.5;

/// The fixed settings of an excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Settings {
    /// Root mean square of each surface at full size, rad.
    pub size: [f64; SURFACES],
    /// Period of the slowest harmonic, s; those in use are 2 to 13 times as fast.
    pub period: f64,
    /// Largest difference of the normal load factor from 1 at which it goes on, g.
    pub load_factor: f64,
    /// Largest difference of the angle of attack from the reference, rad.
    pub alpha: f64,
    /// Largest sideslip, rad.
    pub beta: f64,
}

impl Default for Settings {
    /// Half a degree of elevator and one of aileron and rudder over ten seconds; within half a g, 4 deg of angle of attack and of
    /// sideslip.
    fn default() -> Self {
        const DEGREE: f64 = core::f64::consts::PI / 180.0;
        Self {
            size: [0.5 * DEGREE, DEGREE, DEGREE],
            period: 10.0,
            load_factor: 0.5,
            alpha: 4.0 * DEGREE,
            beta: 4.0 * DEGREE,
        }
    }
}

/// What an excitation looks at each frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Now {
    /// By how much the bounds of what each surface has to tell are too wide: 1 is wide enough, 2 twice too wide. What is no number
    /// asks for nothing.
    pub width: [f64; SURFACES],
    /// Normal load factor less 1, g.
    pub load_factor: f64,
    /// Angle of attack from the reference, rad.
    pub alpha: f64,
    /// Sideslip, rad.
    pub beta: f64,
}

/// An excitation with its memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    settings: Settings,
    /// Size of each surface now, 0 to 1.
    level: [f64; SURFACES],
    time: f64,
}

impl Excitation {
    /// An excitation that is at rest.
    pub fn new(settings: Settings) -> Self {
        Self { settings, level: [0.0; SURFACES], time: 0.0 }
    }

    /// Size of each surface's part now, 0 to 1.
    pub fn level(&self) -> [f64; SURFACES] {
        self.level
    }

    /// What is to be added to elevator, aileron and rudder (rad) in this frame of `sample_time` (s).
    pub fn update(&mut self, now: &Now, sample_time: f64) -> [f64; SURFACES] {
        let s = &self.settings;
        let near = |value: f64, limit: f64| value.is_nan() || value.abs() >= limit;
        let stop = near(now.load_factor, s.load_factor) || near(now.alpha, s.alpha) || near(now.beta, s.beta);
        for j in 0..SURFACES {
            // Half too wide asks for half of it; twice too wide for all.
            let wanted = if stop || now.width[j].is_nan() { 0.0 } else { (now.width[j] - 1.0).clamp(0.0, 1.0) };
            let step = sample_time / RISE;
            // Down as fast as up, four times as fast at a limit.
            let down = if stop { 4.0 * step } else { step };
            self.level[j] += (wanted - self.level[j]).max(-down).min(step);
        }
        if self.level == [0.0; SURFACES] {
            self.time = 0.0;
            return [0.0; SURFACES];
        }
        self.time += sample_time;
        core::array::from_fn(|j| self.level[j] * s.size[j] * self.wave(j))
    }

    /// A multisine with a root mean square of one.
    fn wave(&self, surface: usize) -> f64 {
        let count = HARMONICS[surface].len() as f64;
        let sum: f64 = HARMONICS[surface]
            .iter()
            .enumerate()
            .map(|(k, harmonic)| {
                let phase = -core::f64::consts::PI * (k * (k + 1)) as f64 / count;
                libm::sin(core::f64::consts::TAU * f64::from(*harmonic) * self.time / self.settings.period + phase)
            })
            .sum();
        sum * libm::sqrt(2.0 / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(width: [f64; 3], seconds: f64) -> [[f64; 1000]; 3] {
        let mut excitation = Excitation::new(Settings::default());
        let now = Now { width, ..Now::default() };
        for _ in 0..(seconds / 0.01) as usize {
            excitation.update(&now, 0.01);
        }
        let mut signals = [[0.0; 1000]; 3];
        for k in 0..1000 {
            let u = excitation.update(&now, 0.01);
            (0..3).for_each(|j| signals[j][k] = u[j]);
        }
        signals
    }

    #[test]
    fn over_a_period_the_surfaces_are_orthogonal_and_of_the_stated_size() {
        let signals = run([3.0; 3], 1.0);
        let dot = |a: usize, b: usize| (0..1000).map(|k| signals[a][k] * signals[b][k]).sum::<f64>() / 1000.0;
        for a in 0..3 {
            assert!((dot(a, a).sqrt() / Settings::default().size[a] - 1.0).abs() < 1e-6);
            for b in 0..a {
                assert!(dot(a, b).abs() < 1e-9 * dot(a, a));
            }
        }
    }

    #[test]
    fn it_stops_when_bounds_are_small_enough_or_a_limit_is_near() {
        assert!(run([0.9; 3], 1.0).iter().flatten().all(|u| *u == 0.0));
        assert!(run([f64::NAN; 3], 1.0).iter().flatten().all(|u| *u == 0.0));
        let mut excitation = Excitation::new(Settings::default());
        let wide = Now { width: [5.0; 3], ..Now::default() };
        (0..100).for_each(|_| {
            excitation.update(&wide, 0.01);
        });
        assert_eq!(excitation.level(), [1.0; 3]);
        let near = Now { beta: f64::NAN, ..wide };
        (0..13).for_each(|_| {
            excitation.update(&near, 0.01);
        });
        assert_eq!(excitation.level(), [0.0; 3]);
    }
}
