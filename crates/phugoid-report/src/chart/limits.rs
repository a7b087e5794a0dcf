//! Limits of an ordinate that stay useful if a method diverges.

use phugoid_evaluation::chart::{Chart, Content, Curve, Meaning, Panel, Shape};

/// A method is cut off if it makes the range of the ordinate more than so many times as large as everything else needs.
const CUT_OFF_RATIO: f64 = 6.0;
/// Room around everything else in that case, as a share of its range, so that it is visible where a method leaves.
const ROOM: f64 = 0.4;

/// Limits of the ordinate of a panel: those of the chart, if it has any; limits without the methods, if a method leaves
/// the range of all others by far; else `None`, so that they follow from the data.
pub(super) fn ordinate(chart: &Chart, panel: &Panel) -> Option<[f64; 2]> {
    if panel.y.range.is_some() {
        return panel.y.range;
    }
    let Content::Curves { curves, levels, .. } = &panel.content else { return None };
    let window = chart.x.range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let mut others = Extent::default();
    let mut all = Extent::default();
    for curve in curves {
        for (_, y) in points(curve).filter(|(x, _)| (window[0]..=window[1]).contains(x)) {
            all.add(y);
            if !matches!(curve.meaning, Meaning::Method(_)) {
                others.add(y);
            }
        }
    }
    // Without another curve there is nothing with which the methods could be compared.
    if others.low > others.high {
        return None;
    }
    levels.iter().for_each(|level| {
        others.add(level.at);
        all.add(level.at);
    });
    let span = (others.high - others.low).max(0.2 * others.low.abs().max(others.high.abs()));
    let far = all.high - all.low > CUT_OFF_RATIO * span;
    (span > 0.0 && far).then(|| [(others.low - ROOM * span).max(all.low), (others.high + ROOM * span).min(all.high)])
}

/// Whether a line or a point among the curves lies beyond the limits. Bands do not count.
pub(super) fn leaves(curves: &[Curve], [low, high]: [f64; 2]) -> bool {
    let slack = 1e-9 * (high - low);
    curves
        .iter()
        .filter(|curve| !matches!(curve.shape, Shape::Band { .. }))
        .any(|curve| points(curve).any(|(_, y)| y < low - slack || y > high + slack))
}

/// Whether an abscissa never decreases.
pub(super) fn ascending(x: &[f64]) -> bool {
    x.windows(2).all(|pair| pair[0] <= pair[1])
}

/// Abscissa and ordinate of every finite point, of a band those of both curves.
fn points(curve: &Curve) -> impl Iterator<Item = (f64, f64)> {
    let (first, second): (&[f64], &[f64]) = match &curve.shape {
        Shape::Line(y) | Shape::Step(y) | Shape::Points(y) => (y, &[]),
        Shape::Band { lower, upper } => (lower, upper),
    };
    let with_x = |y| curve.x.iter().copied().zip(<[f64]>::iter(y).copied());
    with_x(first).chain(with_x(second)).filter(|(x, y)| x.is_finite() && y.is_finite())
}

/// The smallest and the largest value so far.
struct Extent {
    low: f64,
    high: f64,
}

impl Default for Extent {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY }
    }
}

impl Extent {
    fn add(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }
}
