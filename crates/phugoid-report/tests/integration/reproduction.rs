//! Figures and pages of made-up reproductions: complete, unambiguous, repeatable, and small.

use crate::markup;

use std::collections::BTreeSet;
use std::sync::Arc;

use markup::assert_balanced;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_report::figure::{Body, Colour, SeriesKind, Stroke};
use phugoid_report::{NotRun, ReproductionOptions, chart_figure, reproduction_html};
use phugoid_thesis::result::{Behaviour, Outcome, ParameterOutcome, Reproduction, Requirement, Role};

fn time() -> Arc<[f64]> {
    (0..4001).map(|k| 0.001 * f64::from(k)).collect()
}

fn curve(label: &str, meaning: Meaning, shape: impl Fn(f64) -> f64) -> Curve {
    let x = time();
    let y = x.iter().map(|t| shape(*t)).collect();
    Curve { label: label.to_owned(), meaning, x, shape: Shape::Line(y) }
}

fn level(label: &str, meaning: Meaning, at: f64) -> Level {
    Level { label: label.to_owned(), at, meaning }
}

/// Truth, bounds, the flagship with its band, a law that is biased and one that runs away.
fn estimates() -> Chart {
    let spread = |sign: f64| time().iter().map(|t| 8.0 + sign * (0.1 + 3.0 * (-3.0 * t).exp())).collect::<Vec<f64>>();
    let band = Curve {
        label: "flagship, ±2σ".to_owned(),
        meaning: Meaning::Flagship,
        x: time(),
        shape: Shape::Band { lower: spread(-1.0), upper: spread(1.0) },
    };
    Chart {
        name: "estimates".to_owned(),
        title: "Estimate of a1".to_owned(),
        caption: "The flagship is there first.".to_owned(),
        x: Axis::new("Time", "s"),
        panels: vec![
            Panel {
                y: Axis::new("a1", "1/s²"),
                content: Content::Curves {
                    curves: vec![
                        band,
                        curve("truth", Meaning::Truth, |_| 8.0),
                        curve("printed law, delayed", Meaning::Method(0), |t| {
                            8.0 - 4.0 * (6.0 * t).exp() * (90.0 * t).sin()
                        }),
                        curve("printed law, implicit", Meaning::Method(1), |t| 7.2 - 3.2 * (-4.0 * t).exp()),
                        curve("flagship", Meaning::Flagship, |t| 8.0 - 4.0 * (-20.0 * t).exp()),
                    ],
                    levels: vec![level("bounds", Meaning::Bound, 2.0), level("bounds", Meaning::Bound, 16.0)],
                    instants: vec![level("published time", Meaning::Truth, 0.5)],
                },
            },
            Panel {
                y: Axis::new("Input u", "–"),
                content: Content::Curves {
                    curves: vec![Curve {
                        label: "command".to_owned(),
                        meaning: Meaning::Command,
                        x: [0.0, 1.0, 1.2, 4.0].into(),
                        shape: Shape::Step(vec![0.0, 1.0, 10.0, 10.0]),
                    }],
                    levels: vec![],
                    instants: vec![level("published time", Meaning::Truth, 0.5)],
                },
            },
        ],
        columns: 1,
    }
}

fn map() -> Chart {
    let lambda: Vec<f64> = (0..13).map(|k| 10f64.powf(-1.0 + 0.25 * f64::from(k))).collect();
    let step: Vec<f64> = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2].to_vec();
    let values = step
        .iter()
        .map(|h| lambda.iter().map(|l| if l * h < 1.0 { 3.0 / l + h } else { f64::NAN }).collect())
        .collect();
    Chart {
        name: "map".to_owned(),
        title: "Convergence over lambda and sample time".to_owned(),
        caption: "Above lambda h = 1 it never converges.".to_owned(),
        x: Axis::new("lambda", "1/s"),
        panels: vec![Panel {
            y: Axis::new("Sample time", "s"),
            content: Content::Map {
                x: lambda,
                y: step,
                value: Axis::new("Time to 5 %", "s"),
                values,
                logarithmic: true,
                absent: "not within 5 %".to_owned(),
                marked: Some([10.0, 0.001]),
            },
        }],
        columns: 1,
    }
}

fn parameter(end: f64, converged_s: Option<f64>) -> ParameterOutcome {
    ParameterOutcome {
        name: "a1".to_owned(),
        truth: 8.0,
        start: 4.0,
        end,
        std_error: Some(0.05),
        published_s: Some(0.5),
        converged_s,
    }
}

fn outcome(method: &str, role: Role, behaviour: Behaviour, end: f64, converged_s: Option<f64>) -> Outcome {
    Outcome {
        method: method.to_owned(),
        role,
        behaviour,
        condition: "lambda h = 0.01 < 2; rests at theta eta/lambda".to_owned(),
        parameters: vec![parameter(end, converged_s)],
    }
}

fn reproduction(id: &str) -> Reproduction {
    Reproduction {
        id: id.to_owned(),
        title: "Step, a1 = 8 & <a2> = 6".to_owned(),
        place: "table 4.3, case 1".to_owned(),
        published: "Converges after 0.5 s.\n\nThe figure shows it.".to_owned(),
        reconstruction: "The step's size is lost; `u = 10`.".to_owned(),
        difference: "None.".to_owned(),
        outcomes: vec![
            outcome("flagship", Role::Flagship, Behaviour::Converges, 8.0000001, Some(0.021)),
            outcome("printed law, delayed", Role::Published, Behaviour::Diverges, f64::NAN, None),
            outcome("printed law, implicit", Role::Published, Behaviour::Biased, 7.2, None),
        ],
        requirements: vec![
            Requirement {
                what: "a1 within 5 % no later than published".to_owned(),
                limit: "0.5 s".to_owned(),
                found: "0.021 s".to_owned(),
                met: true,
            },
            Requirement {
                what: "a2 within 5 % no later than published".to_owned(),
                limit: "0.6 s".to_owned(),
                found: "0.7 s".to_owned(),
                met: false,
            },
        ],
        tables: vec![Table {
            title: "By noise level".to_owned(),
            columns: vec![Column::new("Noise", ""), Column::new("RMSE", "1/s²")],
            rows: vec![vec!["low".into(), Cell::Number(0.012_345)], vec!["high".into(), Cell::Number(f64::NAN)]],
        }],
        charts: vec![estimates(), map()],
        golden: Table::default(),
    }
}

fn all() -> Vec<Reproduction> {
    ["second-order/1", "second-order/2", "laws/reaching", "my-case"].map(reproduction).into()
}

fn series(chart: &Chart, panel: usize) -> Vec<phugoid_report::figure::Series> {
    match chart_figure(chart).panels.swap_remove(panel).body {
        Body::Plot { series, .. } => series,
        _ => Vec::new(),
    }
}

#[test]
fn meanings_decide_colours_and_strokes() {
    let looks: Vec<(Colour, Stroke)> = series(&estimates(), 0).iter().map(|s| (s.colour, s.stroke)).collect();
    assert_eq!(
        looks,
        [
            (Colour::Blue, Stroke::Solid),
            (Colour::Vermillion, Stroke::Solid),
            (Colour::Green, Stroke::Solid),
            (Colour::Blue, Stroke::Solid),
            // Above what it is compared with.
            (Colour::Ink, Stroke::Dashed),
        ]
    );
    // A command of four samples, seconds apart, is one unbroken step.
    let command = &series(&estimates(), 1)[0];
    assert!(command.joined && matches!(command.kind, SeriesKind::Step(_)));
}

#[test]
fn a_law_that_runs_away_does_not_flatten_the_others() {
    let figure = chart_figure(&estimates());
    let [low, high] = figure.panels[0].y.range.unwrap();
    // Bounds 2 to 16 with some room on either side; the law itself goes to some 1e11.
    assert!((-8.0..2.0).contains(&low) && (16.0..26.0).contains(&high), "{low} {high}");
    assert!(figure.caption.ends_with("cut off there."), "{}", figure.caption);
    // An ordinate that was asked for stays, and one that hides nothing says nothing.
    let mut asked = estimates();
    asked.panels[0].y = asked.panels[0].y.clone().with_range(0.0, 20.0);
    assert_eq!(chart_figure(&asked).panels[0].y.range, Some([0.0, 20.0]));
    asked.panels.remove(0);
    assert_eq!(chart_figure(&asked).caption, "The flagship is there first.");
}

#[test]
fn a_map_has_cells_units_colour_bar_and_legend() {
    let svg = chart_figure(&map()).to_svg();
    for words in
        ["lambda (1/s)", "Sample time (s)", "Time to 5 % (s)", "not within 5 %", "settings of the case", ">10⁻⁴<"]
    {
        assert!(svg.contains(words), "{words}");
    }
    // The smallest time is drawn in the darkest colour of Cividis, the largest in the lightest.
    assert!(svg.contains("fill=\"#002051\"") && svg.contains("fill=\"#fde945\""));
    // Cells are coloured alike on any page, and hatched where there is no value.
    assert!(chart_figure(&map()).to_inline_svg().contains("fill=\"var(--grid)\""));
    let mut full = map();
    if let Content::Map { values, marked, .. } = &mut full.panels[0].content {
        values.iter_mut().flatten().filter(|v| v.is_nan()).for_each(|v| *v = 40.0);
        *marked = None;
    }
    let svg = chart_figure(&full).to_svg();
    assert!(!svg.contains("not within 5 %") && !svg.contains("settings of the case"), "a legend of what is not there");
    assert!(chart_figure(&map()).to_png().unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn the_page_is_whole_and_refers_to_nothing_outside() {
    let page = reproduction_html(&all(), &ReproductionOptions::default());
    assert_balanced(&page);
    let rest = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for forbidden in ["http:", "https:", "//", "<script", "<link", "<img", "<iframe", "@import", "url(", "src="] {
        assert!(!rest.contains(forbidden), "{forbidden} in the page");
    }
    for words in [
        "4 of 8 requirements are met; 4 not.",
        "Second-order plant",
        "Cases of your own",
        "What differs, and why",
        "status bad\">diverges",
        "status waiting\">biased",
        "status good\">converges",
        "Step, a1 = 8 &amp; &lt;a2&gt; = 6",
        "<code>u = 10</code>",
        "RMSE<br>(1/s²)",
        "never",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn anchors_are_unique_and_links_resolve() {
    let page = reproduction_html(&all(), &ReproductionOptions::default());
    let values = |attribute: &str| -> Vec<String> {
        page.split(attribute).skip(1).filter_map(|rest| rest.split('"').next()).map(str::to_owned).collect()
    };
    let anchors = values(" id=\"");
    let unique: BTreeSet<&String> = anchors.iter().collect();
    assert_eq!(unique.len(), anchors.len(), "an id twice among {anchors:?}");
    let links = values("href=\"#");
    assert!(links.len() > 12, "{links:?}");
    for link in links {
        assert!(unique.contains(&link), "nothing is called {link}");
    }
    for case in all() {
        assert!(unique.contains(&case.id) && unique.contains(&format!("{}/estimates", case.id)));
    }
}

#[test]
fn what_could_not_be_run_is_told() {
    let failed = NotRun { id: "noise/2".to_owned(), reason: "no <room> left".to_owned() };
    let options = ReproductionOptions { not_run: vec![failed], ..Default::default() };
    let page = reproduction_html(&all(), &options);
    assert!(page.contains("noise/2") && page.contains("no &lt;room&gt; left"));
    assert_balanced(&page);
    // Nothing at all is still a page.
    assert_balanced(&reproduction_html(&[], &options));
}

#[test]
fn two_calls_give_the_same_bytes_and_they_are_few() {
    let options = ReproductionOptions::default();
    let page = reproduction_html(&all(), &options);
    assert_eq!(page, reproduction_html(&all(), &options));
    // Sixty such cases are to stay below 10 MB: 160 kB each, with 20,000 samples drawn.
    assert!(page.len() < 4 * 160_000, "{} bytes for four cases", page.len());
}
