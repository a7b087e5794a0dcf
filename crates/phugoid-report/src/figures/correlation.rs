//! The correlation matrix of the parameters.

use super::context::Context;
use crate::figure::{Axis, Body, Figure, Panel};

/// Name of the figure among [`super::figures`].
pub(crate) const NAME: &str = "correlation";

/// The figure; `None` for fewer than two parameters or without correlations.
pub(super) fn figure(context: &Context) -> Option<(String, Figure)> {
    let estimation = context.estimation;
    if estimation.parameters.len() < 2 || estimation.correlation.is_empty() {
        return None;
    }
    let mut figure = context.figure(
        "Correlation of the parameters",
        "Blue: positive, orange: negative; the stronger the colour, the less the record can tell the two parameters \
         apart. Beyond ±0.9 (bold) only a combination of the two is well known.",
    );
    figure.events.clear();
    let labels = estimation.parameters.iter().map(|p| p.name.clone()).collect();
    let body = Body::Matrix { labels, values: estimation.correlation.clone() };
    figure.panels.push(Panel { y: Axis::default(), x: None, height: 0.0, body });
    Some((NAME.to_owned(), figure))
}
