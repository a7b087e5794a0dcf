//! The course of a parameter in a line of characters.

use std::collections::VecDeque;

/// Points kept: one per [`STEP_S`], for the widest terminal.
const MOST: usize = 240;
/// Time between two points, s.
const STEP_S: f64 = 0.5;

/// Values of a parameter at regular times.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    values: VecDeque<f64>,
    next_s: f64,
}

impl Course {
    pub(super) fn push(&mut self, time_s: f64, value: f64) {
        if self.values.is_empty() || time_s >= self.next_s {
            self.next_s = time_s + STEP_S;
            self.values.push_back(value);
            if self.values.len() > MOST {
                self.values.pop_front();
            }
        }
    }

    /// The last values, from the least of them to the greatest in eight heights.
    pub(super) fn line(&self, width: usize) -> String {
        const HEIGHTS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
        let shown = self.values.iter().skip(self.values.len().saturating_sub(width));
        let finite = shown.clone().copied().filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let height = |value: f64| {
            if !value.is_finite() {
                return ' ';
            }
            // A constant is drawn at half height.
            let part = if high > low { (value - low) / (high - low) } else { 0.5 };
            HEIGHTS.get((part * 7.0).round() as usize).copied().unwrap_or(' ')
        };
        shown.copied().map(height).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_bounded_and_drawn_between_its_extremes() {
        let mut course = Course::default();
        for k in 0..100_000 {
            course.push(f64::from(k) * 0.01, f64::from(k));
        }
        assert_eq!(course.values.len(), MOST);
        assert_eq!(course.line(8), "▁▂▃▄▅▆▇█");
        assert_eq!(course.line(1), "▅");
        assert_eq!(Course::default().line(10), "");
    }
}
