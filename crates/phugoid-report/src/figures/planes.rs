//! The path of the estimate in the plane of two parameters that are strongly correlated.

use std::sync::Arc;

use super::context::{Context, scaled};
use crate::figure::{At, Axis, Colour, Figure, Panel, Reference, Series, SeriesKind, Stroke};

/// Planes that are drawn at most.
const MOST: usize = 6;
/// Planes that are drawn in any case, if there are so many pairs.
const LEAST: usize = 3;
/// Further planes are drawn only for pairs with at least this correlation.
const NOTABLE: f64 = 0.3;

/// The figure; `None` without a pair that can be drawn.
pub(super) fn figure(context: &Context) -> Option<(String, Figure)> {
    let estimation = context.estimation;
    let parameters = context.parameters(false);
    let index_of = |name: &str| estimation.parameters.iter().position(|p| p.name == name);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, (a, ..)) in parameters.iter().enumerate() {
        for (j, (b, ..)) in parameters.iter().enumerate().skip(i + 1) {
            let entry = index_of(&a.name).zip(index_of(&b.name));
            let r = entry.and_then(|(row, column)| estimation.correlation.get(row)?.get(column).copied());
            if let Some(r) = r.filter(|r| r.is_finite()) {
                pairs.push((r, i, j));
            }
        }
    }
    // The sort is stable, so pairs of equal correlation stay in the order of the model.
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));

    let mut figure = context.figure(
        "Parameter planes",
        "The path of the estimate in the plane of two parameters, since it last came near its end, for the most \
         correlated pairs. The ellipse encloses two standard errors in each direction: along its long axis the record \
         cannot tell the two parameters apart.",
    );
    figure.columns = 3;
    figure.events.clear();
    let notable = pairs.iter().filter(|(r, ..)| r.abs() >= NOTABLE).count();
    for (r, i, j) in pairs.into_iter().take(notable.clamp(LEAST, MOST)) {
        let [first, second] = [&parameters[i], &parameters[j]].map(|(parameter, history, unit)| Direction {
            name: parameter.name.as_str(),
            unit: unit.text.as_str(),
            path: scaled(&history.value, unit),
            value: parameter.value * unit.factor,
            sigma: parameter.corrected_std_error * unit.factor,
            truth: parameter.truth.map(|t| t * unit.factor),
        });
        figure.panels.extend(plane(r, first, second));
    }
    (!figure.panels.is_empty()).then(|| ("parameter-planes".to_owned(), figure))
}

/// One of the two parameters of a plane, in the unit in which it is shown.
struct Direction<'a> {
    name: &'a str,
    unit: &'a str,
    path: Vec<f64>,
    value: f64,
    sigma: f64,
    truth: Option<f64>,
}

impl Direction<'_> {
    /// The axis: four standard errors to both sides of the final value, more if the truth is not far away and needs it;
    /// `None` without a standard error.
    fn axis(&self) -> Option<Axis> {
        let away = self.truth.map_or(0.0, |t| 1.3 * (t - self.value).abs());
        let half = (4.0 * self.sigma).max(if away <= 12.0 * self.sigma { away } else { 0.0 });
        (self.sigma > 0.0 && half.is_finite() && self.value.is_finite())
            .then(|| Axis::new(self.name, self.unit).with_range(self.value - half, self.value + half))
    }
}

/// The panel of two parameters with correlation `r`: path, 2-sigma ellipse and truth.
fn plane(r: f64, x: Direction, y: Direction) -> Option<Panel> {
    let (x_axis, y_axis) = (x.axis()?, y.axis()?);
    // Points of correlated pairs at two standard errors: x = 2 sx cos a, y = 2 sy sin(a + asin r).
    let skew = r.clamp(-1.0, 1.0).asin();
    let angles = (0..=72).map(|k| f64::from(k) * std::f64::consts::TAU / 72.0);
    let ellipse_x: Arc<[f64]> = angles.clone().map(|a| x.value + 2.0 * x.sigma * a.cos()).collect();
    let ellipse_y = angles.map(|a| y.value + 2.0 * y.sigma * (a + skew).sin()).collect();
    // The path is drawn from where it entered the panel for the last time; before, it only crosses the panel.
    let far = |axis: &Axis, v: f64| axis.range.is_some_and(|[low, high]| !(low..=high).contains(&v));
    let came = x.path.iter().zip(&y.path).rposition(|(a, b)| far(&x_axis, *a) || far(&y_axis, *b)).unwrap_or(0);
    let path: Arc<[f64]> = Arc::from(&x.path[came.min(x.path.len())..]);
    let path_y = y.path.get(came..).unwrap_or_default().to_vec();
    let mut series = vec![
        Series::new("path of the estimate; the dot is its end", Colour::Blue, &path, SeriesKind::Trajectory(path_y)),
        Series::new("2σ ellipse", Colour::Orange, &ellipse_x, SeriesKind::Curve(ellipse_y)),
    ];
    if let Some((x, y)) = x.truth.zip(y.truth) {
        series.push(Series::new("truth", Colour::Vermillion, &Arc::from([x]), SeriesKind::Marks(vec![y])));
    }
    let centre =
        |at| Reference { label: String::new(), colour: Colour::Grid, stroke: Stroke::Solid, at, on_top: false };
    let label = format!("{} ({}), r = {}", y.name, y.unit, crate::ticks::fixed(r, 2));
    let heading = Axis { label, unit: String::new(), ..y_axis };
    Some(
        Panel::plot(heading, series)
            .with_x(x_axis)
            .with_height(200.0)
            .with_reference(centre(At::Horizontal(y.value)))
            .with_reference(centre(At::Vertical(x.value))),
    )
}
