//! The studies of the printed laws: what they claim is what they compute.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use phugoid_evaluation::chart::{Content, Shape};
use phugoid_evaluation::table::Cell;
use phugoid_thesis::{Reproduction, entries};

/// Runs an entry, prints it and checks what holds of every study: requirements met, series of one length, golden numbers
/// finite.
fn study(id: &str) -> Reproduction {
    let entry = entries().into_iter().find(|entry| entry.id == id).expect("registered");
    let start = std::time::Instant::now();
    let result = (entry.run)(id, &|_| {}).unwrap();
    println!("== {id}: {} ({:.2?})", result.title, start.elapsed());
    for outcome in &result.outcomes {
        println!("{}: {} ({})", outcome.method, outcome.behaviour.word(), outcome.condition);
        for p in &outcome.parameters {
            println!("    {} = {:.5} (true {}), 5 % at {:?}", p.name, p.end, p.truth, p.converged_s);
        }
    }
    for table in &result.tables {
        println!("{}", table.title);
        println!(
            "  {}",
            table.columns.iter().map(|c| format!("{} {}", c.name, c.unit)).collect::<Vec<_>>().join(" | ")
        );
        for row in &table.rows {
            assert_eq!(row.len(), table.columns.len());
            let cells: Vec<String> = row
                .iter()
                .map(|cell| match cell {
                    Cell::Number(value) => format!("{value:.4}"),
                    Cell::Text(text) => text.clone(),
                })
                .collect();
            println!("  {}", cells.join(" | "));
        }
    }
    for chart in &result.charts {
        println!("chart {}", chart.name);
        for panel in &chart.panels {
            match &panel.content {
                Content::Map { x, y, values, value, marked, .. } => {
                    assert!(values.len() == y.len() && values.iter().all(|row| row.len() == x.len()));
                    assert!(marked.is_none_or(|[mx, my]| x.contains(&mx) && y.contains(&my)), "marked is on the grid");
                    println!("  {} ({}) over {x:?}", value.label, panel.y.label);
                    for (y, row) in y.iter().zip(values) {
                        println!("    {y}: {}", row.iter().map(|v| format!("{v:.3}")).collect::<Vec<_>>().join(" "));
                    }
                }
                Content::Curves { curves, .. } => {
                    for curve in curves {
                        let (length, last) = match &curve.shape {
                            Shape::Line(y) | Shape::Step(y) | Shape::Points(y) => (y.len(), y.last().copied()),
                            Shape::Band { lower, upper } => {
                                assert_eq!(lower.len(), upper.len());
                                (lower.len(), lower.last().copied())
                            }
                        };
                        assert_eq!(length, curve.x.len());
                        println!("  {} / {}: {length} points, last {last:?}", panel.y.label, curve.label);
                    }
                }
            }
        }
    }
    for row in &result.golden.rows {
        println!("golden {row:?}");
        assert!(row.iter().all(|cell| !matches!(cell, Cell::Number(value) if !value.is_finite())), "{row:?}");
    }
    for requirement in &result.requirements {
        println!("{}: {} (limit {})", requirement.what, requirement.found, requirement.limit);
        assert!(requirement.met, "{requirement:?}");
    }
    assert!(!result.golden.rows.is_empty() && result.golden.rows.len() <= 60);
    assert!([&result.title, &result.place, &result.published, &result.difference].iter().all(|text| !text.is_empty()));
    result
}

#[test]
fn reaching() {
    study("laws/reaching");
}

#[test]
fn lambda_and_eta() {
    study("laws/lambda-eta");
}

#[test]
fn sample_time() {
    study("laws/sample-time");
}

#[test]
fn bounds_and_start() {
    study("laws/bounds-and-start");
}

#[test]
fn rank() {
    study("laws/rank");
}

#[test]
fn lyapunov() {
    study("laws/lyapunov");
}
