//! From values to positions on the sheet.

use crate::clip::Frame;

/// The area of a panel in which values are drawn: the limits of abscissa and ordinate, and the rectangle, px.
pub(crate) struct PlotArea {
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
    pub(crate) frame: Frame,
}

impl PlotArea {
    /// Position of a point, px. A value far outside the limits is moved to 1000 times the size of the area, so that
    /// coordinates stay finite.
    pub(crate) fn at(&self, point: [f64; 2]) -> [f64; 2] {
        let share = |v: f64, [low, high]: [f64; 2]| ((v - low) / (high - low)).clamp(-1e3, 1e3);
        let frame = &self.frame;
        [
            frame.left + share(point[0], self.x) * (frame.right - frame.left),
            frame.bottom - share(point[1], self.y) * (frame.bottom - frame.top),
        ]
    }
}
