//! Cutting lines off at the border of a panel.

/// A rectangle, px; y points down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Frame {
    /// Whether a point lies inside or on the border.
    pub(crate) fn contains(&self, p: &[f64; 2]) -> bool {
        (self.left..=self.right).contains(&p[0]) && (self.top..=self.bottom).contains(&p[1])
    }

    /// The point of the rectangle that is nearest.
    pub(crate) fn clamp(&self, p: [f64; 2]) -> [f64; 2] {
        [p[0].clamp(self.left, self.right), p[1].clamp(self.top, self.bottom)]
    }

    /// The parts of a line that lie inside, in their order.
    pub(crate) fn clip(&self, line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        if line.iter().all(|p| self.contains(p)) {
            return if line.is_empty() { Vec::new() } else { vec![line.to_vec()] };
        }
        let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
        let mut part: Vec<[f64; 2]> = Vec::new();
        for pair in line.windows(2) {
            let Some((a, b)) = self.segment(pair[0], pair[1]) else {
                if !part.is_empty() {
                    parts.push(std::mem::take(&mut part));
                }
                continue;
            };
            if part.is_empty() {
                part.push(a);
            }
            part.push(b);
            if b != pair[1] {
                parts.push(std::mem::take(&mut part));
            }
        }
        if !part.is_empty() {
            parts.push(part);
        }
        parts
    }

    /// The part of a segment that lies inside, after Liang and Barsky (1984); `None` if there is none.
    fn segment(&self, a: [f64; 2], b: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let d = [b[0] - a[0], b[1] - a[1]];
        for (slope, room) in
            [(-d[0], a[0] - self.left), (d[0], self.right - a[0]), (-d[1], a[1] - self.top), (d[1], self.bottom - a[1])]
        {
            if slope == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if slope < 0.0 {
                enter = enter.max(room / slope);
            } else {
                leave = leave.min(room / slope);
            }
        }
        if enter > leave {
            return None;
        }
        let at = |s: f64| [a[0] + s * d[0], a[1] + s * d[1]];
        Some((if enter > 0.0 { at(enter) } else { a }, if leave < 1.0 { at(leave) } else { b }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

    #[test]
    fn a_spike_leaves_and_comes_back() {
        let parts = FRAME.clip(&[[0.0, 5.0], [4.0, 5.0], [5.0, -5.0], [6.0, 5.0], [10.0, 5.0]]);
        assert_eq!(parts, vec![vec![[0.0, 5.0], [4.0, 5.0], [4.5, 0.0]], vec![[5.5, 0.0], [6.0, 5.0], [10.0, 5.0]],]);
    }

    #[test]
    fn a_line_outside_vanishes_and_one_across_stays() {
        assert!(FRAME.clip(&[[0.0, -1.0], [10.0, -1.0]]).is_empty());
        assert_eq!(FRAME.clip(&[[-10.0, -10.0], [20.0, 20.0]]), vec![vec![[0.0, 0.0], [10.0, 10.0]]]);
    }
}
