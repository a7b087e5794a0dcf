//! The course of a parameter over time in one line of characters.

use std::collections::VecDeque;

/// Points that are kept; enough for the widest terminal.
const MOST_POINTS: usize = 240;
/// Least time between two points, s.
const STEP_S: f64 = 0.5;

/// The values of a parameter at regular times.
#[derive(Clone, Debug, Default)]
pub(super) struct Sparkline {
    values: VecDeque<f64>,
    next_s: f64,
}

impl Sparkline {
    /// Adds a value, SI, if half a second has passed since the last one.
    pub(super) fn push(&mut self, time_s: f64, value: f64) {
        if self.values.is_empty() || time_s >= self.next_s {
            self.next_s = time_s + STEP_S;
            self.values.push_back(value);
            if self.values.len() > MOST_POINTS {
                self.values.pop_front();
            }
        }
    }

    /// The last values as characters of eight heights, from the least of them to the greatest. What is not finite is a
    /// blank, a constant is drawn at half height.
    pub(super) fn line(&self, width: usize) -> String {
        const HEIGHTS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
        let shown = self.values.iter().skip(self.values.len().saturating_sub(width));
        let finite = shown.clone().copied().filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let height = |value: f64| {
            if !value.is_finite() {
                return ' ';
            }
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
    fn it_is_bounded_and_drawn_between_its_extremes() {
        let mut sparkline = Sparkline::default();
        for k in 0..100_000 {
            sparkline.push(f64::from(k) * 0.01, f64::from(k));
        }
        assert_eq!(sparkline.values.len(), MOST_POINTS);
        assert_eq!(sparkline.line(8), "▁▂▃▄▅▆▇█");
        assert_eq!(sparkline.line(1), "▅");
        assert_eq!(Sparkline::default().line(10), "");
    }
}
