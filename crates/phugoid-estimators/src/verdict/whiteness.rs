//! Whether the residuals of an output are as the model promises: white, and seldom rejected.

use crate::innovation::RowPhase;

/// Memory of the statistics, s: time constant of their exponential forgetting.
pub const MEMORY_S: f64 = 5.0;
/// Share of rejected rows from which the model is said to contradict the flight. Single bad values of a sensor stay
/// below.
pub const CONTRADICTED: f64 = 0.25;
/// Rows that are needed before the share of rejected ones is used: a quarter of them is five.
const ENOUGH: f64 = 20.0;

/// The residuals of one output over the last seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Whiteness {
    /// Lag-one correlation of the normalised innovations (clipped at three); zero for a right model, NaN before there
    /// are any.
    pub correlation: f64,
    /// What chance allows for white residuals, `3/sqrt(n)`: three sigma at first, 4.2 when the memory is full.
    pub allowed: f64,
    /// Mean square of the clipped innovations: one for right noise levels (0.97 with the clipping).
    pub power: f64,
    /// Share of rows that were rejected.
    pub rejected: f64,
    /// Number of rows in the memory, faded with their age.
    pub rows: f64,
}

impl Whiteness {
    /// True if the correlation is larger than chance allows.
    pub fn is_coloured(&self) -> bool {
        self.correlation.abs() > self.allowed
    }

    /// True if so many rows were rejected that the estimate rests on a selection of the data.
    pub fn contradicts(&self) -> bool {
        self.rows >= ENOUGH && self.rejected > CONTRADICTED
    }
}

/// Sums over the rows of one output, which fade with the time constant [`MEMORY_S`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowMemory {
    squares: f64,
    products: f64,
    /// Number of innovations behind `squares` and of pairs behind `products`.
    used: f64,
    pairs: f64,
    rejected: f64,
    seen: f64,
    last: f64,
}

impl RowMemory {
    pub(crate) const NEW: Self =
        Self { squares: 0.0, products: 0.0, used: 0.0, pairs: 0.0, rejected: 0.0, seen: 0.0, last: f64::NAN };

    /// One frame, `interval_s` after the last.
    pub(crate) fn add(&mut self, interval_s: f64, normalised: f64, phase: RowPhase) {
        if interval_s > 0.0 {
            let keep = libm::exp(-interval_s / MEMORY_S);
            for sum in [
                &mut self.squares,
                &mut self.products,
                &mut self.used,
                &mut self.pairs,
                &mut self.rejected,
                &mut self.seen,
            ] {
                *sum *= keep;
            }
        }
        if phase == RowPhase::Missing || !normalised.is_finite() {
            self.last = f64::NAN;
            return;
        }
        self.seen += 1.0;
        if phase == RowPhase::Rejected {
            self.rejected += 1.0;
            self.last = f64::NAN;
            return;
        }
        let clipped = normalised.clamp(-3.0, 3.0);
        self.squares += clipped * clipped;
        self.used += 1.0;
        if self.last.is_finite() {
            self.products += clipped * self.last;
            self.pairs += 1.0;
        }
        self.last = clipped;
    }

    pub(crate) fn whiteness(&self) -> Whiteness {
        let power = self.squares / self.used;
        Whiteness {
            correlation: self.products / self.pairs / power,
            // Of an even sum; with the weights of a full memory it is 4.2 sigma.
            allowed: 3.0 * libm::sqrt(1.0 / self.pairs),
            power,
            rejected: if self.seen > 0.0 { self.rejected / self.seen } else { 0.0 },
            rows: self.seen,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// A first-order autoregression of unit variance with the given lag-one correlation, from sums of uniforms.
    fn sequence(rho: f64, seed: u64) -> Whiteness {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut memory = RowMemory::NEW;
        let mut x = 0.0;
        for _ in 0..4000 {
            let normal = (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
            x = rho * x + libm::sqrt(1.0 - rho * rho) * normal;
            memory.add(0.01, x, RowPhase::Sliding);
        }
        memory.whiteness()
    }

    /// 20 seeds: white sequences are not called coloured (three sigma), a correlation of 0.4 always is.
    #[test]
    fn colour_is_told_from_white() {
        let mut largest: f64 = 0.0;
        for seed in 0..20 {
            let white = sequence(0.0, seed);
            largest = largest.max(white.correlation.abs());
            assert!(!white.is_coloured(), "{white:?}");
            assert!((0.8..1.2).contains(&white.power));
            let coloured = sequence(0.4, seed);
            assert!(coloured.is_coloured() && (0.25..0.55).contains(&coloured.correlation), "{coloured:?}");
        }
        // It has been near the limit, or the limit would be too wide to say anything.
        assert!(largest > 0.04, "{largest}");
    }

    #[test]
    fn rejected_rows_contradict_only_when_there_are_enough() {
        let mut memory = RowMemory::NEW;
        for _ in 0..5 {
            memory.add(0.01, 8.0, RowPhase::Rejected);
        }
        assert!(!memory.whiteness().contradicts());
        for k in 0..100 {
            memory.add(0.01, 1.0, if k % 3 == 0 { RowPhase::Rejected } else { RowPhase::Sliding });
        }
        assert!(memory.whiteness().contradicts());
        // Five seconds of good rows and it is forgotten.
        for _ in 0..700 {
            memory.add(0.01, 0.5, RowPhase::Sliding);
        }
        assert!(!memory.whiteness().contradicts());
        // A gap in the rows makes no pair.
        let pairs = memory.pairs;
        memory.add(0.0, f64::NAN, RowPhase::Missing);
        memory.add(0.0, 1.0, RowPhase::Sliding);
        assert_eq!(memory.pairs, pairs);
    }
}
