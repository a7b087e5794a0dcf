//! Curves and maps of the studies of the laws, from plain series.

use std::sync::Arc;

use rayon::prelude::*;

use phugoid_evaluation::chart::{Axis, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Column, Table};

/// Most points of a curve: more than a page can show.
const POINTS: usize = 600;

/// The samples that are drawn of a record of this length: regular, with the last.
pub(super) fn drawn(samples: usize) -> Vec<usize> {
    let every = samples.div_ceil(POINTS).max(1);
    let mut indices: Vec<usize> = (0..samples).step_by(every).collect();
    if samples > 0 && indices.last() != Some(&(samples - 1)) {
        indices.push(samples - 1);
    }
    indices
}

/// The drawn samples of a series.
pub(super) fn thin(series: &[f64]) -> Vec<f64> {
    drawn(series.len()).into_iter().map(|k| series[k]).collect()
}

/// Time axis of several curves over one record.
pub(super) struct Record {
    time: Arc<[f64]>,
}

impl Record {
    pub(super) fn new(time_s: &[f64]) -> Self {
        Self { time: thin(time_s).into() }
    }

    /// A curve over the whole record.
    pub(super) fn line(&self, label: impl Into<String>, meaning: Meaning, series: &[f64]) -> Curve {
        Curve { label: label.into(), meaning, x: Arc::clone(&self.time), shape: Shape::Line(thin(series)) }
    }
}

/// A panel of curves with horizontal lines.
pub(super) fn curves(y: Axis, curves: Vec<Curve>, levels: Vec<Level>) -> Panel {
    Panel { y, content: Content::Curves { curves, levels, instants: Vec::new() } }
}

/// Values over a grid, one row per `y`, computed in parallel; `done` is called with the fraction after each.
pub(super) fn over_grid<T: Send>(
    x: &[f64],
    y: &[f64],
    done: &(dyn Fn(f64) + Sync),
    value: impl Fn(f64, f64) -> T + Sync,
) -> Vec<Vec<T>> {
    let cells: Vec<(f64, f64)> = y.iter().flat_map(|&y| x.iter().map(move |&x| (x, y))).collect();
    let finished = std::sync::atomic::AtomicUsize::new(0);
    let flat: Vec<T> = cells
        .par_iter()
        .map(|&(x, y)| {
            let result = value(x, y);
            let count = finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            done(count as f64 / cells.len() as f64);
            result
        })
        .collect();
    let mut flat = flat.into_iter();
    y.iter().map(|_| flat.by_ref().take(x.len()).collect()).collect()
}

/// Adds a named number to what is committed and compared.
pub(super) fn note(golden: &mut Table, name: impl Into<String>, value: f64) {
    if golden.columns.is_empty() {
        golden.columns = vec![Column::new("what", ""), Column::new("value", "")];
    }
    golden.rows.push(vec![name.into().into(), value.into()]);
}
