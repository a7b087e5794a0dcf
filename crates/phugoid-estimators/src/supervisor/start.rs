//! The median start: an outlier in the very first sample must not become the start of the state.

use crate::model::Sample;
use crate::settings::EstimatorSettings;
use crate::statistics::median;

/// Most frames the start collects.
pub(crate) const START_CAPACITY: usize = 64;

/// Frames collected until the state can be started from their median; they are then replayed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start<I, const R: usize> {
    frames: [Option<Sample<I, R>>; START_CAPACITY],
    count: usize,
}

/// A state started from measurements.
pub(crate) struct StartedState<const N: usize> {
    pub(crate) x: [f64; N],
    pub(crate) variances: [f64; N],
    /// Output that each state was read from.
    pub(crate) read_from: [Option<usize>; N],
}

impl<I: Copy, const R: usize> Start<I, R> {
    pub(crate) fn new() -> Self {
        Self { frames: [None; START_CAPACITY], count: 0 }
    }

    /// Takes a frame. Frames without any measurement before the first useful one are dropped: there is nothing to
    /// predict from. When full, the oldest is dropped.
    pub(crate) fn push(&mut self, sample: &Sample<I, R>) {
        if self.count == 0 && !sample.outputs.iter().any(|y| y.is_finite()) {
            return;
        }
        if self.count >= START_CAPACITY {
            self.frames.rotate_left(1);
            self.count = START_CAPACITY - 1;
        }
        if let Some(place) = self.frames.get_mut(self.count) {
            *place = Some(*sample);
            self.count += 1;
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    pub(crate) fn frame(&self, index: usize) -> Option<Sample<I, R>> {
        self.frames.get(index).copied().flatten()
    }

    /// The median state, once the window is over and every measured state has been read at least once (or the buffer
    /// is full; what has not been read by then starts from the settings).
    ///
    /// Call it with the newest frame already pushed: the window is over when that frame lies beyond it.
    pub(crate) fn state<const N: usize, const P: usize>(
        &self,
        settings: &EstimatorSettings<N, R, P>,
        noise_std: &[f64; R],
        output_of_state: &[Option<usize>; N],
    ) -> Option<StartedState<N>> {
        let first = self.frame(0)?.time_s;
        let newest = self.frame(self.count - 1)?.time_s;
        // A frame that falls on the end of the window but for rounding lies beyond it.
        // The first frame always lies inside: a window of length zero is that frame alone.
        let inside = |time_s: f64| time_s <= first || time_s - first < settings.start_window_s - 1e-9;
        let full = self.count >= START_CAPACITY;
        let over = !inside(newest) || settings.start_window_s == 0.0;
        if !over && !full {
            return None;
        }
        let mut started = StartedState {
            x: settings.initial_state,
            variances: settings.initial_state_std.map(|std| std * std),
            read_from: [None; N],
        };
        for state in 0..N {
            let Some(output) = output_of_state[state].filter(|output| *output < R) else { continue };
            let mut values = [0.0; START_CAPACITY];
            let mut count = 0;
            let mut read = |only_inside: bool| {
                count = 0;
                for frame in self.frames.iter().take(self.count).flatten() {
                    if frame.outputs[output].is_finite()
                        && (!only_inside || inside(frame.time_s))
                        && let Some(value) = values.get_mut(count)
                    {
                        *value = frame.outputs[output];
                        count += 1;
                    }
                }
                count
            };
            // The window alone if it holds a value; else whatever came later.
            let found = if read(true) > 0 { count } else { read(false) };
            if found > 0 {
                let values = &mut values[..found.min(START_CAPACITY)];
                let middle = median(values);
                for value in &mut *values {
                    *value = (*value - middle).abs();
                }
                let scatter = 1.4826 * median(values);
                started.x[state] = middle;
                started.variances[state] = start_variance(noise_std[output], scatter);
                started.read_from[state] = Some(output);
            } else if !full {
                return None;
            }
        }
        Some(started)
    }
}

/// The median belongs to the middle of the window and the estimated model starts at its beginning. On a state at rest
/// only noise lies between the two; on one that moves by more than the noise, up to half the motion does, which is
/// less than twice the scatter about the median.
fn start_variance(noise_std: f64, scatter: f64) -> f64 {
    let std = if scatter > 2.0 * noise_std { 2.0 * scatter } else { noise_std };
    std * std
}
