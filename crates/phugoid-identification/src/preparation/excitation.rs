//! Decides whether the aircraft has been moved at all.
//!
//! Increments to a database are learnt from departures from the reference point. Before there is any, the estimated
//! angle of attack still wanders about it by its own noise wherever process noise is allowed for, and an estimator that
//! linearises about its estimate takes that wander for excitation: on a simulated F-16 in steady flight it "learnt"
//! dCL_alpha to 0.3 where the prior is 0.75, and was seven of these sigmas wrong. So the estimates of increments start
//! with the first motion that is visible above the noise, not before. In absolute form steady flight does tell
//! something, but of sums of terms: there the estimator runs from the first sample, and its estimates are shown from
//! the first motion on.

use crate::core::axes::{Axes, Group};
use crate::core::output::Output;
use crate::motion::Motion;
use crate::preparation::noise::{NoiseLevel, measure_noise};
use crate::preparation::prepared::Prepared;

/// A departure this many sigmas from the first window counts as motion.
const SIGMAS: f64 = 6.0;
/// Length of the windows that are averaged, s.
const WINDOW_S: f64 = 0.25;
/// Smallest motion of a surface that counts, rad: rounding is not an input.
const SMALLEST_DEFLECTION: f64 = 1e-5;

/// On which groups of axes something has moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Moved {
    longitudinal: bool,
    lateral: bool,
}

impl Moved {
    /// Something has moved on both groups of axes.
    pub(crate) const ALL: Self = Self { longitudinal: true, lateral: true };

    /// Whether something has moved on this group.
    pub(crate) fn has(self, group: Group) -> bool {
        match group {
            Group::Longitudinal => self.longitudinal,
            Group::Lateral => self.lateral,
        }
    }

    /// Whether anything has moved at all.
    pub(crate) fn any(self) -> bool {
        self.longitudinal || self.lateral
    }

    fn set(&mut self, group: Group) {
        match group {
            Group::Longitudinal => self.longitudinal = true,
            Group::Lateral => self.lateral = true,
        }
    }
}

/// Watches the surfaces, the angles to the air and the angular rates of the axes for the first motion; causal.
#[derive(Clone, Debug)]
pub(crate) struct Excitation {
    surfaces: Vec<Surface>,
    responses: Vec<Response>,
    window_start_s: f64,
    seen: Moved,
}

/// A control surface: where it started, and by how much it has to move.
#[derive(Clone, Copy, Debug)]
struct Surface {
    group: Group,
    start: f64,
    threshold: f64,
}

/// An output: group, row, one sigma of its noise, its mean in the first window, and the window that is being filled.
#[derive(Clone, Copy, Debug)]
struct Response {
    group: Group,
    row: usize,
    noise: f64,
    start: Option<f64>,
    sum: f64,
    count: u32,
}

impl Excitation {
    /// For a record: the noise of surfaces is that at its start.
    pub(crate) fn of<M: Motion<N, R>, const N: usize, const R: usize>(
        prepared: &Prepared<M, N, R>,
        noise: &[NoiseLevel; R],
    ) -> Self {
        let length = prepared.noise_samples();
        let surfaces = prepared.surfaces().map(|signal| {
            let start = &signal.values[..length.min(signal.values.len())];
            let own = measure_noise(start).filter(|n| !n.quantised).map_or(0.0, |n| n.std);
            (Group::of_surface(&signal.name), signal.values.first().copied().unwrap_or(0.0), own)
        });
        Self::new(M::AXES, &noise.map(|n| n.std), surfaces)
    }

    /// With the noise of the outputs (one sigma, SI), and the group, the first value and the noise of each surface
    /// (rad).
    fn new(axes: Axes, noise: &[f64], surfaces: impl Iterator<Item = (Group, f64, f64)>) -> Self {
        let response = |output: &Output| {
            let row = axes.row(*output)?;
            let noise = *noise.get(row)?;
            Some(Response { group: Group::of(*output), row, noise, start: None, sum: 0.0, count: 0 })
        };
        Self {
            surfaces: surfaces
                .map(|(group, start, noise)| Surface {
                    group,
                    start,
                    threshold: SMALLEST_DEFLECTION.max(SIGMAS * noise),
                })
                .collect(),
            responses: axes.responses().iter().filter_map(response).collect(),
            window_start_s: f64::NAN,
            seen: Moved::default(),
        }
    }

    /// Takes a sample, the surfaces in the order in which they were given; what it gives is set from the first visible
    /// motion of a group on.
    pub(crate) fn update(&mut self, time_s: f64, surfaces: impl Iterator<Item = f64>, outputs: &[f64]) -> Moved {
        for (surface, position) in self.surfaces.iter().zip(surfaces) {
            if (position - surface.start).abs() > surface.threshold {
                self.seen.set(surface.group);
            }
        }
        if self.window_start_s.is_nan() {
            self.window_start_s = time_s;
        }
        if time_s - self.window_start_s >= WINDOW_S - 1e-9 {
            for response in &mut self.responses {
                if response.close_window() {
                    self.seen.set(response.group);
                }
            }
            self.window_start_s = time_s;
        }
        for response in &mut self.responses {
            let value = outputs.get(response.row).copied().unwrap_or(f64::NAN);
            if value.is_finite() {
                response.sum += value;
                response.count += 1;
            }
        }
        self.seen
    }
}

impl Response {
    /// True if the mean of the window has departed from that of the first one.
    fn close_window(&mut self) -> bool {
        let mut departed = false;
        if self.count > 0 {
            let n = f64::from(self.count);
            let mean = self.sum / n;
            match self.start {
                None => self.start = Some(mean),
                // Both means are uncertain by sigma over the root of n; an outlier moves one by twenty sigmas over n.
                Some(start) => {
                    let limit = SIGMAS * self.noise * (2.0 / n).sqrt() + 20.0 * self.noise / n;
                    departed = (mean - start).abs() > limit;
                }
            }
        }
        self.sum = 0.0;
        self.count = 0;
        departed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first_motion(axes: Axes, surface: impl Fn(f64) -> f64, angle: impl Fn(f64) -> f64) -> Option<f64> {
        let row = axes.row(axes.responses()[0]).unwrap();
        let group = Group::of(axes.responses()[0]);
        let noise = [1.7e-3; 14];
        let mut watch = Excitation::new(axes, &noise, [(group, surface(0.0), 0.0)].into_iter());
        (0..1000).map(|k| 0.02 * f64::from(k)).find(|t| {
            let mut outputs = [0.0; 14];
            // A triangle wave of one sigma stands for the noise.
            outputs[row] = angle(*t) + 1.7e-3 * (((t / 0.02) as i32 % 5 - 2) as f64) / 1.4;
            watch.update(*t, [surface(*t)].into_iter(), &outputs).has(group)
        })
    }

    #[test]
    fn motion_is_seen_and_noise_is_not() {
        for axes in [Axes::Longitudinal, Axes::LateralDirectional, Axes::All] {
            assert_eq!(first_motion(axes, |_| -0.03, |_| 0.04), None);
            // A doublet of 0.05 deg, as in the thesis.
            let doublet = |t: f64| if t >= 5.0 { 8.7e-4 } else { 0.0 };
            assert!((first_motion(axes, doublet, |_| 0.04).unwrap() - 5.0).abs() < 0.021);
            // A gust that moves the angle by one degree.
            let seen = first_motion(axes, |_| 0.0, |t| if t > 8.0 { 0.057 } else { 0.04 }).unwrap();
            assert!((8.0..8.6).contains(&seen), "{seen}");
        }
    }

    #[test]
    fn each_axis_is_seen_by_itself() {
        let surfaces = [(Group::Longitudinal, 0.0, 0.0), (Group::Lateral, 0.0, 0.0)];
        let mut watch = Excitation::new(Axes::All, &[1e-3; 14], surfaces.into_iter());
        assert!(!watch.update(0.0, [0.0, 0.0].into_iter(), &[0.0; 14]).any());
        let elevator = watch.update(0.02, [0.01, 0.0].into_iter(), &[0.0; 14]);
        assert!(elevator.has(Group::Longitudinal) && !elevator.has(Group::Lateral));
        assert_eq!(watch.update(0.04, [0.0, -0.01].into_iter(), &[0.0; 14]), Moved::ALL);
    }
}
