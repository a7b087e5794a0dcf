//! Time on the wall and on a processor: on a machine that others use too only the second says what a reader costs.

use std::time::Instant;

/// A clock that runs from its start on.
pub(crate) struct Clock {
    start: Instant,
    processor_s: Option<f64>,
}

impl Clock {
    pub(crate) fn start() -> Self {
        Self { start: Instant::now(), processor_s: processor_s() }
    }

    pub(crate) fn wall_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Seconds that this program had a processor since the start; `None` where the system does not tell.
    pub(crate) fn processor_s(&self) -> Option<f64> {
        Some(processor_s()? - self.processor_s?)
    }
}

/// Seconds that this program ran on a processor (Linux).
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}
