//! Counts of the link, and the time from the arrival of data to their estimate.

use serde::Serialize;

/// Counts since the start of the reception.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Datagrams and pieces of streams that arrived.
    pub packets: u64,
    /// Number of bytes in the packets.
    pub bytes: u64,
    /// MAVLink frames and rows of text that were recognised as such.
    pub received: u64,
    /// Samples handed to the estimation.
    pub samples: u64,
    /// MAVLink messages that are missing by their sequence numbers.
    pub lost: u64,
    /// Samples that came after one with a later time had been used; they were left out.
    pub late: u64,
    /// Messages and samples that had come before.
    pub duplicated: u64,
    /// Messages that came after one that was sent later.
    pub reordered: u64,
    /// Samples and messages that were left out because their time had leapt against their arrival.
    pub leaps: u64,
    /// Datagrams, and pieces of streams, of others than the sender whose samples are used; none was merged.
    pub strangers: u64,
    /// Number of times that the sender's clock started again.
    pub restarts: u64,
    /// Number of times that the sender's clock stood still for more than a second while samples arrived.
    pub stalled: u64,
    /// Frames of known messages whose checksum is wrong.
    pub checksum_failures: u64,
    /// Frames, and rows of text, that were left out because they are not signed with the key that was given.
    pub unverified: u64,
    /// Bytes that belong to no frame and no line.
    pub garbage_bytes: u64,
    /// Rows and messages that were left out because of their content.
    pub refused: u64,
}

/// Histogram of the times from arrival to estimate, in bounded memory. Its buckets are a sixteenth of an octave wide
/// and reach from 1 us to more than a minute, so a quantile is at most 4.5 % (one bucket) above the exact one.
///
/// ```
/// use phugoid_live::link::Latency;
///
/// let mut latency = Latency::default();
/// assert_eq!(latency.quantiles().p50, None);
/// for microseconds in 1..=1000_u64 {
///     latency.add(microseconds * 1_000);
/// }
/// let found = latency.quantiles();
/// let median_ms = found.p50.unwrap_or(f64::NAN);
/// assert!(median_ms >= 0.5 && median_ms < 0.5 * 1.045, "{median_ms} ms");
/// assert_eq!(found.max, Some(1.0));
/// ```
#[derive(Clone, Debug)]
pub struct Latency {
    buckets: Vec<u64>,
    count: u64,
    largest_ns: u64,
}

const BUCKETS_PER_OCTAVE: usize = 16;
const OCTAVES: usize = 26;

impl Default for Latency {
    fn default() -> Self {
        Self { buckets: vec![0; BUCKETS_PER_OCTAVE * OCTAVES], count: 0, largest_ns: 0 }
    }
}

/// Quantiles of the latency, ms; all `None` before the first estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LatencyMs {
    /// Median: half of the latencies are below it.
    pub p50: Option<f64>,
    /// 99 % of the latencies are below it.
    pub p99: Option<f64>,
    /// 99.9 % of the latencies are below it.
    pub p99_9: Option<f64>,
    /// The largest latency; unlike the quantiles it is exact.
    pub max: Option<f64>,
}

impl Latency {
    /// Adds one latency, ns. What is shorter than 1 us counts as 1 us, what is longer than the last bucket goes into
    /// the last bucket.
    pub fn add(&mut self, latency_ns: u64) {
        let octaves = (latency_ns.max(1_000) as f64 / 1e3).log2();
        let bucket = ((octaves * BUCKETS_PER_OCTAVE as f64) as usize).min(self.buckets.len() - 1);
        if let Some(bucket) = self.buckets.get_mut(bucket) {
            *bucket += 1;
        }
        self.count += 1;
        self.largest_ns = self.largest_ns.max(latency_ns);
    }

    /// The upper edge of the bucket in which this quantile lies, ms, at most the largest latency; `None` without data.
    fn quantile(&self, fraction: f64) -> Option<f64> {
        let wanted = (fraction * self.count as f64).ceil() as u64;
        let mut below = 0;
        let bucket = self.buckets.iter().position(|count| {
            below += count;
            below >= wanted.max(1)
        })?;
        let edge = 1e-3 * ((bucket + 1) as f64 / BUCKETS_PER_OCTAVE as f64).exp2();
        Some(edge.min(self.largest_ns as f64 / 1e6))
    }

    /// The quantiles that are published, ms.
    pub fn quantiles(&self) -> LatencyMs {
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
        assert_eq!(latency.quantiles(), LatencyMs::default());
        (1..=1000_u64).for_each(|k| latency.add(k * 10_000));
        let found = latency.quantiles();
        for (found, exact) in [(found.p50, 5.0), (found.p99, 9.9), (found.p99_9, 9.99), (found.max, 10.0)] {
            let found = found.unwrap();
            assert!(found >= exact && found <= exact * 1.045, "{found} {exact}");
        }
    }
}
