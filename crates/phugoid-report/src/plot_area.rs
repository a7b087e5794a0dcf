//! Where a value stands on paper.

use crate::clip::Frame;

/// From values to px.
pub(crate) struct PlotArea {
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
    pub(crate) frame: Frame,
}

impl PlotArea {
    /// Position of a point; far outside values are held near the sheet so that they stay drawable.
    pub(crate) fn at(&self, point: [f64; 2]) -> [f64; 2] {
        let share = |v: f64, [low, high]: [f64; 2]| ((v - low) / (high - low)).clamp(-1e3, 1e3);
        let frame = &self.frame;
        [
            frame.left + share(point[0], self.x) * (frame.right - frame.left),
            frame.bottom - share(point[1], self.y) * (frame.bottom - frame.top),
        ]
    }
}
