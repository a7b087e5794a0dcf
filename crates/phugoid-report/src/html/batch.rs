//! The tables of a batch method beside the parameters: fit, prediction, equations.

use std::fmt::Write as _;

use phugoid_identification::batch::{Equation, OutputFit};
use phugoid_identification::estimation::{BatchReport, Estimation, PredictionInterval};

use super::page::{END_OF_TABLE, table};
use super::tables::number_cells;
use crate::escape::escape;
use crate::ticks::{fixed, significant};

/// The tables of a batch method; empty for a causal method.
pub(super) fn batch(estimation: &Estimation) -> String {
    let Some(report) = &estimation.batch else { return String::new() };
    let mut out = format!(
        "<p>{} iterations; negative log-likelihood {} (without constants).</p>\n",
        report.iterations,
        significant(report.cost, 7)
    );
    for (name, fits) in &report.manoeuvres {
        let _ = writeln!(out, "<h3>Fit of {}</h3>", escape(name));
        out.push_str(&fit(fits));
    }
    if let Some(prediction) = &report.prediction {
        let _ = writeln!(out, "<h3>Prediction of {}</h3>", escape(&prediction.source));
        out.push_str(
            "<p>Simulated with the parameters held; only the initial state and the sensor biases are fitted.</p>\n",
        );
        out.push_str(&fit(&prediction.fit));
        out.push_str(&intervals(&prediction.intervals));
    }
    out.push_str(
        "<p class=\"note\">R² is the share of the output's squares about its mean that the model explains. Theil's \
         inequality coefficient runs from 0 (perfect) to 1; below 0.3 counts as good agreement. Its parts say what the \
         error is: a constant (bias), a wrong amplitude (variance), or the rest (covariance), which is all that a good \
         model leaves. RMS is in SI units.</p>\n",
    );
    out.push_str(&report.equations.iter().map(equation).collect::<String>());
    out + &unknowns(report)
}

/// The table of the fit of each output.
fn fit(fits: &[OutputFit]) -> String {
    let heads = [
        ("", "Output"),
        ("n", "Samples"),
        ("n", "RMS"),
        ("n", "R²"),
        ("n", "Theil"),
        ("n", "bias"),
        ("n", "variance"),
        ("n", "covariance"),
        ("n", "Lag-one<br>correlation"),
        ("", "White"),
    ];
    let row = |f: &OutputFit| {
        let cells = [
            f.samples.to_string(),
            significant(f.rms, 3),
            fixed(f.r_squared, 4),
            fixed(f.theil, 4),
            fixed(f.theil_bias, 2),
            fixed(f.theil_variance, 2),
            fixed(f.theil_covariance, 2),
            fixed(f.lag_one, 2),
        ];
        let white = if f.white { "yes" } else { "no" };
        format!("<tr><th scope=\"row\">{}</th>{}<td>{white}</td></tr>\n", escape(&f.name), number_cells(&cells))
    };
    rows(&heads, fits.iter().map(row).collect())
}

/// The table of the prediction intervals; empty where the method gives none.
fn intervals(intervals: &[PredictionInterval]) -> String {
    if intervals.is_empty() {
        return String::new();
    }
    let heads = [("", "Prediction interval of"), ("n", "Median σ (SI)"), ("n", "Measured within ±2σ (%)")];
    let row = |i: &PredictionInterval| {
        let cells = [significant(i.median_std(), 3), fixed(100.0 * i.within, 1)];
        format!("<tr><th scope=\"row\">{}</th>{}</tr>\n", escape(&i.name), number_cells(&cells))
    };
    rows(&heads, intervals.iter().map(row).collect())
}

/// The terms of a regression equation.
fn equation(equation: &Equation) -> String {
    let heads = [
        ("", "Term, as it enters"),
        ("n", "Value"),
        ("n", "Std. error"),
        ("n", "Partial F"),
        ("n", "F when entered"),
        ("n", "R² then"),
        ("", "Needed"),
    ];
    let body = equation.terms.iter().map(|t| {
        let cells = [
            significant(t.value, 4),
            significant(t.corrected_std_error, 3),
            significant(t.partial_f, 3),
            significant(t.f_when_entered, 3),
            fixed(t.r_squared, 4),
        ];
        let needed = if t.needed { "yes" } else { "no" };
        format!("<tr><th scope=\"row\">{}</th>{}<td>{needed}</td></tr>\n", escape(&t.name), number_cells(&cells))
    });
    format!(
        "<h3>Equation of {}</h3>\n<p>{} samples, R² {}.</p>\n{}",
        escape(&equation.left_sides.join(" and ")),
        equation.samples,
        fixed(equation.r_squared, 4),
        rows(&heads, body.collect())
    )
}

/// Initial states and noise that were estimated beside the parameters.
fn unknowns(report: &BatchReport) -> String {
    if report.unknowns.is_empty() {
        return String::new();
    }
    let heads = [("", "Estimated beside (SI)"), ("n", "Value"), ("n", "Std. error")];
    let body = report.unknowns.iter().map(|u| {
        let cells = [significant(u.value, 5), significant(u.corrected_std_error, 3)];
        format!("<tr><th scope=\"row\">{}</th>{}</tr>\n", escape(&u.name), number_cells(&cells))
    });
    format!("<h3>Initial state and noise</h3>\n{}", rows(&heads, body.collect()))
}

/// A table with these heads and rows.
fn rows(heads: &[(&str, &str)], body: Vec<String>) -> String {
    format!("{}{}{END_OF_TABLE}", table(heads), body.concat())
}
