//! Counts the damaged parts of a log that were skipped, and reports them.

use crate::quality::QualityReport;
use crate::wording::plural;

/// Number of places that are reported one by one.
const MAX_SHOWN: usize = 10;

/// The skipped parts of a file.
#[derive(Debug, Default)]
pub(super) struct Skipped {
    places: Vec<(u64, u64)>,
    count: usize,
    bytes: u64,
    last_end: u64,
}

impl Skipped {
    /// Adds a skipped part of `bytes` from `offset` on; adjoining parts are counted as one.
    pub(super) fn add(&mut self, offset: u64, bytes: u64) {
        if bytes == 0 {
            return;
        }
        self.bytes += bytes;
        if self.count > 0 && self.last_end == offset {
            if let Some(last) = self.places.last_mut().filter(|last| last.0 + last.1 == offset) {
                last.1 += bytes;
            }
        } else {
            self.count += 1;
            if self.places.len() < MAX_SHOWN {
                self.places.push((offset, bytes));
            }
        }
        self.last_end = offset + bytes;
    }

    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    pub(super) fn report(&self, quality: &mut QualityReport) {
        for (offset, bytes) in &self.places {
            quality.warn(
                format!("byte {offset}"),
                format!(
                    "{bytes} bytes skipped up to byte {}: they are no messages of the format; the log is damaged there. What \
                     comes after is read",
                    offset + bytes
                ),
            );
        }
        if self.count > MAX_SHOWN {
            quality.warn(
                "",
                format!(
                    "{} skipped in {}; the first {MAX_SHOWN} are listed",
                    plural(self.bytes as usize, "byte"),
                    plural(self.count, "place")
                ),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_that_touch_are_one_and_many_are_counted() {
        let mut skipped = Skipped::default();
        skipped.add(100, 5);
        skipped.add(105, 7);
        (0..20).for_each(|i| skipped.add(1000 + 10 * i, 1));
        let mut quality = QualityReport::default();
        skipped.report(&mut quality);
        assert_eq!(quality.findings[0].place, "byte 100");
        assert!(quality.findings[0].message.contains("12 bytes skipped up to byte 112"), "{quality}");
        assert_eq!(quality.findings.len(), MAX_SHOWN + 1);
        assert!(quality.findings[MAX_SHOWN].message.contains("32 bytes skipped in 21 places"), "{quality}");
    }
}
