//! Pages and figures of made-up estimations: complete, safe, repeatable, and small.

use crate::markup;
use crate::synthetic;

use markup::assert_balanced;
use phugoid_identification::estimate::{Method, Opens};
use phugoid_identification::estimation::{
    AdoptedChange, ChangeOutcome, ChangedParameter, Estimation, Event, EventKind, OtherValue, SecondAnswer, Signal,
};
use phugoid_report::figure::Body;
use phugoid_report::{
    HtmlOptions, ReportError, TimeHistoryPanel, figures, html, is_figure, time_histories, write_figures,
    write_named_figures,
};
use synthetic::{estimation, fighter, jet, many};

fn page(estimation: &Estimation) -> String {
    html(estimation, &HtmlOptions::default())
}

#[test]
fn the_page_refers_to_nothing_outside() {
    for case in [fighter(), jet()] {
        let page = page(&estimation(&case));
        let rest = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for forbidden in
            ["http:", "https:", "//", "<script ", "<link", "<img", "<iframe", "@import", "url(", "src=", "fetch("]
        {
            assert!(!rest.contains(forbidden), "{forbidden} in the page");
        }
        assert_balanced(&page);
        // One script, at the end, and everything before it is there without it.
        assert_eq!(page.matches("<script>").count(), 1);
        let (before, after) = page.split_once("<script>").unwrap();
        assert!(before.contains("</main>") && after.ends_with("</script>\n</body>\n</html>\n"));
    }
}

#[test]
fn the_page_has_every_part_and_stays_small() {
    let estimation = estimation(&fighter());
    let page = page(&estimation);
    for part in [
        "id=\"summary\"",
        "id=\"parameters\"",
        "id=\"correlation\"",
        "id=\"inputs\"",
        "id=\"outputs\"",
        "id=\"parameters-1\"",
        "id=\"nuisance-1\"",
        "id=\"surfaces-1\"",
        "id=\"parameter-planes\"",
        "id=\"residuals\"",
        "id=\"autocorrelation\"",
        "id=\"fit\"",
        "id=\"quality\"",
        "id=\"events\"",
        "id=\"offer\"",
        "Cm = [&quot;alpha&quot;, &quot;alpha^2&quot;]",
        "\ndCm_alpha2 = { prior_std = 1 }",
        "id=\"method\"",
        "Channels read",
        "prefers-color-scheme:dark",
        "@media print",
        "name=\"viewport\"",
    ] {
        assert!(page.contains(part), "{part} is missing");
    }
    for parameter in &estimation.parameters {
        assert!(page.contains(&format!("<th scope=\"row\">{}</th>", parameter.name)));
    }
    for sentence in estimation.verdict.iter().chain(estimation.events.iter().map(|e| &e.message)) {
        assert!(page.contains(sentence.as_str()), "{sentence}");
    }
    // 2000 samples, 6 outputs, 6 parameters: the agreed limit is 2 MB.
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    // Anchors are unique, or links would lead astray.
    let mut ids: Vec<&str> = page.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}

#[test]
fn numbers_are_the_estimation_s() {
    let mut given = estimation(&fighter());
    given.parameters[0].value = -0.201_26;
    given.parameters[0].corrected_std_error = 0.001_237;
    given.parameters[0].lower = -0.203_734;
    given.parameters[0].upper = -0.198_786;
    given.parameters[0].truth = Some(-0.2);
    // A bias in radians is shown in degrees: 0.0034 rad = 0.1948 deg.
    given.parameters[5].truth = Some(0.0034);
    let page = page(&given);
    for text in [
        "<b>−0.2013</b></td><td class=\"n\">0.00124</td><td class=\"n\">0.615</td>",
        "<td class=\"n\">−0.2037 … −0.1988</td><td class=\"n\">−0.2000</td><td class=\"n\">−1.0</td>",
        "<td class=\"n\">0.1948</td>",
    ] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let (one, two) = (estimation(&jet()), estimation(&jet()));
    assert_eq!(page(&one), page(&two));
    for ((name, a), (_, b)) in figures(&one).iter().zip(&figures(&two)).take(3) {
        assert_eq!(a.to_svg(), b.to_svg(), "{name}");
        assert_eq!(a.to_png().unwrap(), b.to_png().unwrap(), "{name}");
    }
}

#[test]
fn before_and_after_of_a_change_and_a_second_method_stand_side_by_side() {
    let mut given = estimation(&jet());
    assert!(!page(&given).contains("Changes adopted in flight") && !page(&given).contains("By other methods"));
    let name = given.parameters[0].name.clone();
    let small = ChangedParameter {
        name: name.clone(),
        before: -0.5,
        before_std: 0.03,
        after: -0.51,
        after_std: 0.04,
        difference_std: 0.05,
        random_std: 0.05,
    };
    let large = ChangedParameter { before: -0.5, after: -1.0, name: given.parameters[1].name.clone(), ..small.clone() };
    given.changes = vec![AdoptedChange {
        time_s: 4.56,
        interval_s: Some([4.2, 4.8]),
        opens: Opens::Everything,
        outcome: ChangeOutcome::FoundAfterwards,
        parameters: vec![small, large],
    }];
    given.second_answer = Some(SecondAnswer {
        method: Method::EquationError,
        values: vec![OtherValue { name: name.clone(), value: 2.0, std_error: 0.5 }],
    });
    let page = page(&given);
    assert_balanced(&page);
    let changes = page.split("<section id=\"changes\">").nth(1).unwrap().split("</section>").next().unwrap();
    assert!(changes.contains("At 4.560 s") && changes.contains("looked at again"), "{changes}");
    assert!(changes.contains("It happened between 4.2 and 4.8 s."), "{changes}");
    // The one that moved most comes first: half over 0.05.
    assert!(changes.find(&given.parameters[1].name) < changes.find(&name), "{changes}");
    assert!(changes.contains("−10.0") && changes.contains("−0.2"), "{changes}");
    let methods = page.split("<section id=\"methods\">").nth(1).unwrap().split("</section>").next().unwrap();
    assert!(methods.contains("equation-error") && methods.contains("2.000") && methods.contains("<svg"), "{methods}");
}

/// What a missing term explains did not happen, and no constant force set in.
#[test]
fn a_change_that_is_none_has_no_time() {
    let mut given = estimation(&jet());
    let name = given.parameters[0].name.clone();
    given.changes = vec![AdoptedChange {
        time_s: 4.56,
        interval_s: Some([4.2, 4.8]),
        opens: Opens::Constants,
        outcome: ChangeOutcome::ExplainedByTerm,
        parameters: vec![ChangedParameter {
            name,
            before: -0.5,
            before_std: 0.03,
            after: -0.9,
            after_std: 0.04,
            difference_std: 0.05,
            random_std: 0.05,
        }],
    }];
    let page = page(&given);
    let changes = page.split("<section id=\"changes\">").nth(1).unwrap().split("</section>").next().unwrap();
    assert!(changes.contains("No change of the aircraft"), "{changes}");
    assert!(!changes.contains("It happened") && !changes.contains("set in"), "{changes}");
}

#[test]
fn a_figure_over_the_time_says_where_its_time_is() {
    let page = page(&estimation(&jet()));
    let first = page.split("<g class=\"plot\" data-frame=\"").nth(1).unwrap();
    let (frame, rest) = first.split_once("\" data-time=\"").unwrap();
    let frame: Vec<f64> = frame.split(' ').map(|number| number.parse().unwrap()).collect();
    let time: Vec<f64> = rest.split('"').next().unwrap().split(' ').map(|number| number.parse().unwrap()).collect();
    assert!(frame.len() == 4 && frame[0] < frame[2] && frame[1] < frame[3], "{frame:?}");
    assert!(time.len() == 2 && time[0] < time[1], "{time:?}");
    // Lines and labels of its ticks can be told from the curves.
    assert!(page.contains("<path class=\"grid\"") && page.contains("<g class=\"labels\">"));
    // A figure of its own has nothing of this.
    let (_, figure) = &figures(&estimation(&jet()))[1];
    assert!(!figure.to_svg().contains("class="));
}

#[test]
fn text_of_users_cannot_become_markup() {
    let attack = "<script>alert('&\"')</script>";
    let mut given = estimation(&fighter());
    for text in [&mut given.source, &mut given.model] {
        *text = attack.to_owned();
    }
    given.verdict.push(attack.to_owned());
    given.parameters[0].name = attack.to_owned();
    given.history.parameters[0].name = attack.to_owned();
    given.history.measured[0].name = attack.to_owned();
    given.history.measured[0].unit = attack.to_owned();
    given.quality.channels[0].name = attack.to_owned();
    given.quality.channels[0].header = attack.to_owned();
    given.quality.channels[0].unit = attack.to_owned();
    given.quality.findings[0].place = attack.to_owned();
    given.quality.findings[0].message = attack.to_owned();
    given.events.push(Event { time_s: 3.0, kind: EventKind::Gap, message: attack.to_owned() });
    let options = HtmlOptions {
        title: Some(attack.to_owned()),
        notes: vec![attack.to_owned()],
        settings: vec![(attack.to_owned(), attack.to_owned())],
    };
    let page = html(&given, &options);
    assert_eq!(page.matches("<script").count(), 1);
    assert!(!page.contains("<script>alert"));
    assert!(page.contains("&lt;script&gt;alert(&#39;&amp;&quot;&#39;)&lt;/script&gt;"));
    assert_balanced(&page);
    for (_, figure) in figures(&given) {
        assert!(!figure.to_svg().contains("<script"));
    }
}

#[test]
fn missing_values_break_curves_and_nothing_else() {
    let mut given = estimation(&jet());
    let nan = f64::NAN;
    for signals in [&mut given.history.measured, &mut given.history.predicted, &mut given.history.residuals] {
        signals[0].values.fill(nan);
        signals[1].values[7] = f64::INFINITY;
    }
    given.history.parameters[0].value.fill(nan);
    given.history.parameters[1].std_error.fill(nan);
    given.parameters[0].value = nan;
    given.parameters[1].corrected_std_error = nan;
    given.parameters[2].corrected_std_error = 0.0;
    given.correlation[1][2] = nan;
    given.events[0].time_s = nan;
    let page = page(&given);
    assert_balanced(&page);
    for figure in figures(&given).iter().map(|(_, f)| f) {
        let svg = figure.to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{}", figure.title);
        assert!(figure.to_png().unwrap().starts_with(b"\x89PNG"));
    }
    // A panel without any value says so; there are three of the emptied output and one or two of the parameter.
    assert!(page.matches(">no data</text>").count() >= 4);
    assert!(!page.contains("NaN") && !page.contains(">inf"));
}

#[test]
fn a_gap_is_not_bridged() {
    let given = estimation(&jet());
    let predicted_with_gap = {
        let mut given = given.clone();
        given.history.predicted[1].values[200..300].fill(f64::NAN);
        given
    };
    let subpaths = |estimation: &Estimation| {
        let (_, figure) = figures(estimation).into_iter().find(|(name, _)| name == "outputs").unwrap();
        let mut figure = figure;
        figure.panels = vec![figure.panels[1].clone()];
        figure.events.clear();
        let svg = figure.to_svg();
        // Curves: the widest paths; the grid and border are thinner.
        svg.lines().filter(|l| l.contains("stroke-width=\"15\"")).map(|l| l.matches('M').count()).sum::<usize>()
    };
    let time_with_gap = {
        let mut given = given.clone();
        for time in &mut given.history.time_s[300..] {
            *time += 2.0;
        }
        given
    };
    assert_eq!(subpaths(&given), 1);
    assert_eq!(subpaths(&predicted_with_gap), 2);
    assert_eq!(subpaths(&time_with_gap), 2);
}

#[test]
fn an_empty_estimation_still_makes_a_page() {
    let empty = Estimation::default();
    assert!(figures(&empty).is_empty());
    let bare = page(&empty);
    assert_balanced(&bare);
    assert!(bare.contains("<h1>Parameter estimation</h1>"));

    // Parameters without histories: a table, no curves.
    let mut given = estimation(&fighter());
    given.history = Default::default();
    assert!(page(&given).contains("dCm_alpha"));
    assert_eq!(figures(&given).iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["correlation"]);

    // Names without values, and histories shorter than the time.
    let mut given = estimation(&fighter());
    for signal in &mut given.history.measured {
        signal.values.clear();
    }
    given.history.residuals[0].values.truncate(2);
    given.history.parameters[0].value.truncate(1);
    given.history.phase.truncate(5);
    assert_balanced(&page(&given));
    for (_, figure) in figures(&given) {
        figure.to_png().unwrap();
    }
}

#[test]
fn one_parameter_and_twenty_four() {
    let one = estimation(&many(1));
    assert!(figures(&one).iter().all(|(name, _)| name != "correlation"));
    assert_balanced(&page(&one));

    let many = estimation(&many(24));
    let drawn = figures(&many);
    let panels: usize =
        drawn.iter().filter(|(name, _)| name.starts_with("parameters-")).map(|(_, figure)| figure.panels.len()).sum();
    assert_eq!(panels, 48);
    let (_, matrix) = drawn.iter().find(|(name, _)| name == "correlation").unwrap();
    assert!(matches!(&matrix.panels[0].body, Body::Matrix { labels, .. } if labels.len() == 24));
    let page = page(&many);
    assert_balanced(&page);
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
}

#[test]
fn a_long_record_stays_small_and_keeps_its_spike() {
    let count = 200_000;
    let time: Vec<f64> = (0..count).map(|k| k as f64 * 0.01).collect();
    let mut values: Vec<f64> = time.iter().map(|t| (0.05 * t).sin()).collect();
    values[123_456] = 7.0;
    let panel = TimeHistoryPanel {
        label: String::new(),
        unit: "m/s".to_owned(),
        signals: vec![Signal { name: "true_airspeed".to_owned(), unit: "m/s".to_owned(), values }],
    };
    let svg = time_histories("Long", "", &time, &[panel]).to_svg();
    assert!(svg.len() < 60_000, "{} bytes", svg.len());
    // The spike reaches up to 6 % of the axis below the top of the panel; the sine stays in the lower quarter.
    let curve = svg.lines().find(|l| l.contains("stroke-width=\"15\"")).unwrap();
    let path = curve.split(" d=\"M").nth(1).unwrap().trim_end_matches("\"/>");
    let numbers: Vec<i64> =
        path.replace('l', " ").replace('-', " -").split_whitespace().map(|n| n.parse().unwrap()).collect();
    let mut y = numbers[1];
    let (mut top, mut bottom) = (y, y);
    for dy in numbers[2..].iter().skip(1).step_by(2) {
        y += dy;
        top = top.min(y);
        bottom = bottom.max(y);
    }
    // 120 px less twice .06/1.12 of it, in tenths.
    assert!(((bottom - top) as f64 - 1200.0 / 1.12).abs() < 5.0, "{}", bottom - top);
}

#[test]
fn simulated_histories_share_a_time_axis_and_a_legend() {
    let time = [0.0, 1.0, 2.0];
    let signal = |name: &str, values: [f64; 3]| Signal { name: name.into(), unit: "rad".into(), values: values.into() };
    let figure = time_histories(
        "Turn",
        "Coordinated turn",
        &time,
        &[
            TimeHistoryPanel {
                label: "Attitude".into(),
                unit: "rad".into(),
                signals: vec![signal("theta", [0.0, 0.1, 0.2]), signal("phi", [0.0, -0.1, 1.0])],
            },
            TimeHistoryPanel {
                label: "altitude".into(),
                unit: "m".into(),
                signals: vec![signal("altitude", [1e3, 1e3, 1e3])],
            },
        ],
    );
    let svg = figure.to_svg();
    for text in [">Turn<", ">Attitude (deg)<", ">Altitude (m)<", ">Pitch attitude θ<", ">Bank angle φ<", ">Time (s)<"]
    {
        assert!(svg.contains(text), "{text}");
    }
    assert_eq!(svg.matches(">Time (s)<").count(), 1);
    assert!(time_histories("Nothing", "", &[], &[]).to_svg().contains("Nothing"));
}

#[test]
fn files_are_written_and_failures_name_the_path() {
    let folder = std::env::temp_dir().join(format!("phugoid-report-{}", std::process::id()));
    let given = estimation(&jet());
    let written = write_figures(&folder.join("new"), &given).unwrap();
    assert_eq!(written.len(), 2 * figures(&given).len());
    for path in &written {
        let bytes = std::fs::read(path).unwrap();
        let svg = path.extension().is_some_and(|e| e == "svg");
        assert!(bytes.starts_with(if svg { b"<svg" } else { b"\x89PNG" }), "{}", path.display());
        // The drawing shows whose it is.
        assert_eq!(is_figure(path), svg, "{}", path.display());
    }
    // A file where the folder should be.
    let file = folder.join("file");
    std::fs::write(&file, "x").unwrap();
    let error = write_named_figures(&file, &[]).unwrap_err();
    assert!(matches!(&error, ReportError::Write { path, .. } if *path == file));
    assert!(error.to_string().contains("file") && error.to_string().contains("folder"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}
