//! What the link did: counts, and the time from arrival to estimate.

use serde::Serialize;

/// Counts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Datagrams and pieces of streams.
    pub packets: u64,
    /// Bytes in them.
    pub bytes: u64,
    /// Messages or rows that were understood as such.
    pub received: u64,
    /// Samples handed to the estimation.
    pub samples: u64,
    /// Messages that sequence numbers say were sent and have not come.
    pub lost: u64,
    /// Samples that came after a later one had been used, and were left out.
    pub late: u64,
    /// Messages that had come already.
    pub duplicated: u64,
    /// Messages that came after a later one.
    pub reordered: u64,
    /// Times that the sender's clock began anew.
    pub restarts: u64,
    /// Times that the sender's clock stood still.
    pub stalled: u64,
    /// Frames whose checksum did not hold.
    pub checksum_failures: u64,
    /// Bytes that belong to nothing.
    pub garbage_bytes: u64,
    /// Rows and messages that were left out because of what is in them.
    pub refused: u64,
}

/// Times from arrival to estimate. Buckets are a sixteenth of an octave wide, from a microsecond to over a minute, so that a
/// quantile is told to within 7 %.
#[derive(Clone, Debug)]
pub struct Latency {
    buckets: Vec<u64>,
    count: u64,
    largest_ns: u64,
}

const PER_OCTAVE: usize = 16;
const OCTAVES: usize = 26;

impl Default for Latency {
    fn default() -> Self {
        Self { buckets: vec![0; PER_OCTAVE * OCTAVES], count: 0, largest_ns: 0 }
    }
}

/// Quantiles of the latency, ms; none before the first estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LatencyMs {
    /// Half are faster.
    pub p50: Option<f64>,
    /// 99 of a hundred are faster.
    pub p99: Option<f64>,
    /// 999 of a thousand are faster.
    pub p99_9: Option<f64>,
    /// The slowest.
    pub max: Option<f64>,
}

impl Latency {
    /// Counts one.
    pub fn add(&mut self, latency_ns: u64) {
        let octaves = (latency_ns.max(1_000) as f64 / 1e3).log2();
        let bucket = ((octaves * PER_OCTAVE as f64) as usize).min(self.buckets.len() - 1);
        if let Some(bucket) = self.buckets.get_mut(bucket) {
            *bucket += 1;
        }
        self.count += 1;
        self.largest_ns = self.largest_ns.max(latency_ns);
    }

    /// The upper edge of the bucket in which this quantile lies, ms.
    fn quantile(&self, fraction: f64) -> Option<f64> {
        let wanted = (fraction * self.count as f64).ceil() as u64;
        let mut below = 0;
        let bucket = self.buckets.iter().position(|count| {
            below += count;
            below >= wanted.max(1)
        })?;
        let edge = 1e-3 * ((bucket + 1) as f64 / PER_OCTAVE as f64).exp2();
        Some(edge.min(self.largest_ns as f64 / 1e6))
    }

    /// The quantiles that are told.
    pub fn told(&self) -> LatencyMs {
        let max = (self.count > 0).then_some(self.largest_ns as f64 / 1e6);
        LatencyMs { p50: self.quantile(0.5), p99: self.quantile(0.99), p99_9: self.quantile(0.999), max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_within_a_bucket() {
        let mut latency = Latency::default();
        assert_eq!(latency.told(), LatencyMs::default());
        (1..=1000_u64).for_each(|k| latency.add(k * 10_000));
        let told = latency.told();
        for (found, exact) in [(told.p50, 5.0), (told.p99, 9.9), (told.p99_9, 9.99), (told.max, 10.0)] {
            let found = found.unwrap();
            assert!(found >= exact && found <= exact * 1.07, "{found} {exact}");
        }
    }
}
