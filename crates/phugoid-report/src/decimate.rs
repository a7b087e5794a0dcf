//! Long records thinned out for drawing. In one pixel column only the first, lowest, highest and last sample are needed
//! for the same picture with all spikes (method M4 of Jugel et al. 2014, Proceedings of the VLDB Endowment 7(10)).
//! Points are in px.

/// Lines are thinned out if there are more samples per pixel column than this; with fewer it would save nothing.
const SAMPLES_PER_COLUMN: f64 = 4.0;

/// Uninterrupted lines through the points. A point that is not finite interrupts the line. If samples are so dense that
/// several share a pixel column, only a column without any finite sample does.
pub(crate) fn lines(points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Vec::new();
    let mut line: Vec<[f64; 2]> = Vec::new();
    if !dense(points) {
        for point in points {
            if finite(point) {
                line.push(*point);
            } else if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
        }
    } else {
        for column in columns(points) {
            let mut kept = extremes(column);
            if kept.is_empty() {
                if !line.is_empty() {
                    lines.push(std::mem::take(&mut line));
                }
            } else {
                line.append(&mut kept);
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// The finite points, thinned out in the same way.
pub(crate) fn points(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if dense(points) {
        columns(points).flat_map(extremes).collect()
    } else {
        points.iter().filter(|p| finite(p)).copied().collect()
    }
}

/// Areas between two curves (`[x, lower, upper]`, px) as closed outlines. Of each pixel column the widest extent is
/// kept.
pub(crate) fn areas(samples: &[[f64; 3]]) -> Vec<Vec<[f64; 2]>> {
    let mut spans: Vec<[f64; 3]> = Vec::new();
    let mut outlines = Vec::new();
    let mut column = f64::NAN;
    let dense = samples.len() as f64 > 2.0 * extent(samples.iter().map(|s| s[0]));
    for sample in samples {
        if !sample.iter().all(|v| v.is_finite()) {
            close(&mut spans, &mut outlines);
            column = f64::NAN;
            continue;
        }
        // y points down: the lower curve has the larger ordinate.
        let [x, lower, upper] = [sample[0], sample[1].max(sample[2]), sample[1].min(sample[2])];
        match spans.last_mut() {
            Some(last) if dense && x.floor() == column => {
                last[1] = last[1].max(lower);
                last[2] = last[2].min(upper);
            }
            _ => spans.push([x, lower, upper]),
        }
        column = x.floor();
    }
    close(&mut spans, &mut outlines);
    outlines
}

fn close(spans: &mut Vec<[f64; 3]>, outlines: &mut Vec<Vec<[f64; 2]>>) {
    // A single sample is widened by half a pixel to both sides, because an area of no width would not be visible.
    if let [only] = spans.as_slice() {
        let only = *only;
        *spans = vec![[only[0] - 0.5, only[1], only[2]], [only[0] + 0.5, only[1], only[2]]];
    }
    if !spans.is_empty() {
        let upper = spans.iter().map(|s| [s[0], s[2]]);
        let lower = spans.iter().rev().map(|s| [s[0], s[1]]);
        outlines.push(upper.chain(lower).collect());
        spans.clear();
    }
}

/// The points of a curve in any order of abscissa, without those that are less than half a pixel from the one before.
/// The last one stays.
pub(crate) fn trajectory(points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Vec::new();
    let mut line: Vec<[f64; 2]> = Vec::new();
    let mut skipped = None;
    for point in points {
        if !finite(point) {
            line.extend(skipped.take());
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            continue;
        }
        let near = line.last().is_some_and(|last| (point[0] - last[0]).hypot(point[1] - last[1]) < 0.5);
        if near {
            skipped = Some(*point);
        } else {
            skipped = None;
            line.push(*point);
        }
    }
    line.extend(skipped);
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// The line without the points that lie within a tenth of a pixel of the straight line between those that are kept. A
/// smooth curve needs only a few. The method is that of Williams (1978, The Computer Journal 21(4)): it keeps the cone
/// of the directions that meet all points since the last one kept.
pub(crate) fn straightened(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const TOLERANCE: f64 = 0.1;
    let Some((first, rest)) = line.split_first() else { return Vec::new() };
    let mut kept = vec![*first];
    let mut anchor = *first;
    let mut cone: Option<[f64; 2]> = None;
    let mut last = *first;
    for point in rest {
        let (mut dx, mut dy) = (point[0] - anchor[0], point[1] - anchor[1]);
        // The cone is one of slopes, so a line that turns back or is vertical ends it.
        let inside =
            dx > TOLERANCE && point[0] >= last[0] && cone.is_none_or(|[low, high]| (low..=high).contains(&(dy / dx)));
        if !inside && last != anchor {
            kept.push(last);
            anchor = last;
            cone = None;
            (dx, dy) = (point[0] - anchor[0], point[1] - anchor[1]);
        }
        if dx > TOLERANCE {
            let [low, high] = cone.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            cone = Some([low.max((dy - TOLERANCE) / dx), high.min((dy + TOLERANCE) / dx)]);
        } else {
            // A vertical step has no slope and is kept as it is.
            cone = Some([f64::INFINITY, f64::NEG_INFINITY]);
        }
        last = *point;
    }
    if last != anchor || kept.len() < line.len().min(2) {
        kept.push(last);
    }
    kept
}

fn finite(point: &[f64; 2]) -> bool {
    point[0].is_finite() && point[1].is_finite()
}

/// Whether there are so many points per pixel column that they are thinned out.
fn dense(points: &[[f64; 2]]) -> bool {
    points.len() as f64 > SAMPLES_PER_COLUMN * extent(points.iter().map(|p| p[0]))
}

/// Width of the points in pixel columns.
fn extent(abscissas: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = abscissas
        .filter(|x| x.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    // At least one column, also without points.
    (high - low).max(1.0)
}

/// Runs of points in the same pixel column. A point whose abscissa is not finite belongs to the column of the one
/// before.
fn columns(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    points.chunk_by(|a, b| !b[0].is_finite() || !a[0].is_finite() || a[0].floor() == b[0].floor())
}

/// The first, lowest, highest and last finite point in their order, each only once.
fn extremes(column: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let finite: Vec<usize> = (0..column.len()).filter(|i| finite(&column[*i])).collect();
    let (Some(first), Some(last)) = (finite.first(), finite.last()) else { return Vec::new() };
    let by = |a: &&usize, b: &&usize| column[**a][1].total_cmp(&column[**b][1]);
    let low = finite.iter().min_by(by).unwrap_or(first);
    let high = finite.iter().max_by(by).unwrap_or(first);
    let mut kept = [*first, *low, *high, *last];
    kept.sort_unstable();
    let mut out: Vec<[f64; 2]> = Vec::with_capacity(4);
    let mut before = None;
    for index in kept {
        if before != Some(index) {
            out.push(column[index]);
        }
        before = Some(index);
    }
    out
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn missing_samples_break_sparse_lines() {
        let nan = f64::NAN;
        let given = [[0.0, 1.0], [10.0, 2.0], [20.0, nan], [30.0, 3.0], [40.0, nan], [50.0, 4.0], [60.0, 5.0]];
        let found = lines(&given);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1, 2]);
        assert!(lines(&[[0.0, nan], [nan, 1.0]]).is_empty());
        assert!(lines(&[]).is_empty());
    }

    #[test]
    fn a_dense_line_breaks_only_where_a_whole_pixel_is_missing() {
        let mut given: Vec<[f64; 2]> = (0..10_000).map(|i| [f64::from(i) / 100.0, f64::from(i % 7)]).collect();
        given[1234][1] = f64::NAN;
        assert_eq!(lines(&given).len(), 1);
        for point in &mut given[5000..5200] {
            point[1] = f64::NAN;
        }
        assert_eq!(lines(&given).len(), 2);
    }

    #[test]
    fn an_area_keeps_its_extremes_and_breaks() {
        let given: Vec<[f64; 3]> = (0..1000)
            .map(|i| {
                let x = f64::from(i) / 50.0;
                if i == 400 { [x, 9.0, -90.0] } else { [x, 1.0, -1.0] }
            })
            .collect();
        let found = areas(&given);
        assert_eq!(found.len(), 1);
        assert!(found[0].len() < 100);
        assert!(found[0].iter().any(|p| p[1] == -90.0) && found[0].iter().any(|p| p[1] == 9.0));
        let broken = [[0.0, 0.0, 1.0], [1.0, f64::NAN, 1.0], [2.0, 0.0, 1.0], [3.0, 0.0, 1.0]];
        assert_eq!(areas(&broken).len(), 2);
    }

    #[test]
    fn a_smooth_line_needs_few_points() {
        let given: Vec<[f64; 2]> =
            (0..4000).map(|k| 0.2 * f64::from(k)).map(|x| [x, 60.0 + 50.0 * (x / 100.0).sin()]).collect();
        let kept = straightened(&given);
        assert!(kept.len() < 120, "{} points", kept.len());
        assert_eq!(straightened(&[[1.0, 2.0]]), [[1.0, 2.0]]);
        // An upright step stays.
        let step = [[0.0, 0.0], [5.0, 0.0], [5.0, 9.0], [20.0, 9.0]];
        assert_eq!(straightened(&step), step);
    }

    proptest! {
        #[test]
        fn no_point_moves_by_more_than_a_tenth_of_a_pixel(
            steps in prop::collection::vec((0.0..2.0f64, -3.0..3.0f64), 1..300), smooth in 0.0..1.0f64,
        ) {
            let mut at = [0.0, 0.0];
            let given: Vec<[f64; 2]> = steps
                .iter()
                .map(|(dx, dy)| {
                    at = [at[0] + dx, at[1] + smooth * smooth * dy];
                    at
                })
                .collect();
            let kept = straightened(&given);
            prop_assert_eq!((kept[0], kept[kept.len() - 1]), (given[0], given[given.len() - 1]));
            for p in &given {
                let near = kept.windows(2).any(|w| {
                    let d = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
                    let size = d[0] * d[0] + d[1] * d[1];
                    let share = if size > 0.0 {
                        (((p[0] - w[0][0]) * d[0] + (p[1] - w[0][1]) * d[1]) / size).clamp(0.0, 1.0)
                    } else {
                        0.0
                    };
                    (p[0] - w[0][0] - share * d[0]).hypot(p[1] - w[0][1] - share * d[1]) <= 0.1001
                });
                prop_assert!(near || kept.len() < 2, "{:?} is lost", p);
            }
        }

        #[test]
        fn extremes_ends_and_order_survive(
            values in prop::collection::vec(-100.0..100.0f64, 2..4000), width in 1.0..50.0f64,
        ) {
            let n = values.len() as f64;
            let given: Vec<[f64; 2]> =
                values.iter().enumerate().map(|(i, v)| [i as f64 / n * width, *v]).collect();
            let kept: Vec<[f64; 2]> = lines(&given).concat();
            let lowest = |p: &[[f64; 2]]| p.iter().map(|q| q[1]).fold(f64::INFINITY, f64::min);
            let highest = |p: &[[f64; 2]]| p.iter().map(|q| q[1]).fold(f64::NEG_INFINITY, f64::max);
            prop_assert_eq!(lowest(&given), lowest(&kept));
            prop_assert_eq!(highest(&given), highest(&kept));
            prop_assert_eq!(given[0], kept[0]);
            prop_assert_eq!(given[given.len() - 1], kept[kept.len() - 1]);
            prop_assert!(kept.windows(2).all(|w| w[1][0] > w[0][0]));
            prop_assert!(kept.len() as f64 <= 4.0 * (width + 2.0));
        }
    }
}
