//! How large the residuals of the estimator really are, per output, against what its noise levels promise.

/// Residuals are counted as no larger than this many sigmas, so that single outliers do not raise the noise level.
const LARGEST: f64 = 4.0;
/// Samples, and blocks, that the promise of level one is worth at the start.
const PRIOR_SAMPLES: f64 = 50.0;
const PRIOR_BLOCKS: f64 = 10.0;
/// Length of a block, s: as in the estimator's own correction for colour.
const BLOCK_S: f64 = 0.5;
/// Samples and blocks after which the old ones begin to be forgotten.
const MEMORY_SAMPLES: f64 = 6000.0;
const MEMORY_BLOCKS: f64 = 120.0;

/// Running mean square of the residuals of one output, sample by sample and in blocks.
#[derive(Clone, Copy, Debug)]
struct Level {
    square: f64,
    samples: f64,
    block_square: f64,
    blocks: f64,
    running_sum: f64,
    running_samples: f64,
}

/// Noise levels, variance over promised variance, never below one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels<const R: usize> {
    outputs: [Level; R],
    block_since_s: f64,
}

impl<const R: usize> Levels<R> {
    pub(super) const fn new() -> Self {
        let promised = Level {
            square: 1.0,
            samples: PRIOR_SAMPLES,
            block_square: 1.0,
            blocks: PRIOR_BLOCKS,
            running_sum: 0.0,
            running_samples: 0.0,
        };
        Self { outputs: [promised; R], block_since_s: f64::NAN }
    }

    /// Takes the normalised residuals of one frame; NaN where missing.
    pub(super) fn add(&mut self, time_s: f64, normalised: &[f64; R]) {
        if self.block_since_s.is_nan() || time_s - self.block_since_s >= BLOCK_S - 1e-9 {
            self.block_since_s = time_s;
            for level in &mut self.outputs {
                level.close_block();
            }
        }
        for (level, residual) in self.outputs.iter_mut().zip(normalised) {
            if residual.is_finite() {
                let bounded = residual.clamp(-LARGEST, LARGEST);
                level.samples = (level.samples + 1.0).min(MEMORY_SAMPLES);
                level.square += (bounded * bounded - level.square) / level.samples;
                level.running_sum += bounded;
                level.running_samples += 1.0;
            }
        }
    }

    /// Variance of the noise of an output over what was promised, at least one.
    pub(super) fn of(&self, output: usize) -> f64 {
        let level = &self.outputs[output];
        level.square.max(level.block_square).max(1.0)
    }
}

impl Level {
    /// A block of white noise has a mean square sum of its length; colour shorter than the block makes it larger.
    fn close_block(&mut self) {
        if self.running_samples > 0.0 {
            let square = self.running_sum * self.running_sum / self.running_samples;
            let limit = LARGEST * LARGEST * self.square.max(1.0);
            self.blocks = (self.blocks + 1.0).min(MEMORY_BLOCKS);
            self.block_square += (square.min(limit) - self.block_square) / self.blocks;
        }
        self.running_sum = 0.0;
        self.running_samples = 0.0;
    }
}
