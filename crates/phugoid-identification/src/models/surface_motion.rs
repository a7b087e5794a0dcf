//! How the control surfaces move from sample to sample: what errors of their timing and play of their linkages add to a position.

/// How elevator, aileron and rudder have come to a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceMotion {
    /// How fast they have moved since the sample before, rad/s, positive as the deflection.
    pub rates: [f64; 3],
    /// Where each surface lies within its play, less the middle, as a part of the whole play: -1/2 to 1/2. A surface follows what is
    /// recorded of it (its actuator, or the lever of its linkage) half the play behind, after it has moved that far in one direction.
    pub play: [f64; 3],
}

/// The motion of the surfaces from one sample to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceMotions {
    /// Play of each surface, rad from one end to the other; without one it is not looked at.
    play: f64,
    /// Time of the sample before, s, and its deflections, rad.
    before: Option<(f64, [f64; 3])>,
    /// Position within the play, rad.
    within: [f64; 3],
}

impl SurfaceMotions {
    /// Of surfaces with this much play, rad from one end to the other. They start in its middle.
    pub(crate) fn new(play: f64) -> Self {
        Self { play, ..Self::default() }
    }

    /// The motion up to the next sample: rates are backward differences, zero at the first sample and where time does not run. A
    /// deflection that is no number moves nothing within the play.
    pub(crate) fn at(&mut self, time_s: f64, deflections: [f64; 3]) -> SurfaceMotion {
        let Some((time_before, before)) = self.before.replace((time_s, deflections)) else {
            return SurfaceMotion::default();
        };
        let moved: [f64; 3] = std::array::from_fn(|i| deflections[i] - before[i]);
        let half = 0.5 * self.play;
        for (within, moved) in self.within.iter_mut().zip(moved) {
            if moved.is_finite() {
                *within = (*within - moved).clamp(-half, half);
            }
        }
        let step_s = time_s - time_before;
        SurfaceMotion {
            rates: if step_s > 0.0 { moved.map(|moved| moved / step_s) } else { [0.0; 3] },
            play: if self.play > 0.0 { self.within.map(|within| within / self.play) } else { [0.0; 3] },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::SurfaceMotions;

    /// A surface lags by half the play behind a motion in one direction, and stands still while the play is crossed.
    #[test]
    fn a_surface_lags_by_half_its_play() {
        let mut motions = SurfaceMotions::new(0.02);
        let recorded = [0.0, 0.005, 0.05, 0.045, 0.03, -0.05];
        let found: Vec<f64> =
            recorded.iter().enumerate().map(|(k, d)| motions.at(k as f64, [*d, 0.0, 0.0]).play[0]).collect();
        for (found, expected) in found.iter().zip([0.0, -0.25, -0.5, -0.25, 0.5, 0.5]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        // What is no number moves nothing, and neither does a surface without play.
        assert!((motions.at(6.0, [f64::NAN, 0.0, 0.0]).play[0] - 0.5).abs() < 1e-12);
        let mut tight = SurfaceMotions::new(0.0);
        tight.at(0.0, [0.0; 3]);
        let motion = tight.at(0.5, [0.1, 0.0, 0.0]);
        assert!((motion.rates[0] - 0.2).abs() < 1e-12 && motion.play == [0.0; 3]);
    }
}
