//! `phugoid view`: results as pages.

mod common;

use common::{Folder, phugoid};

#[test]
fn a_result_with_histories_becomes_a_page() {
    let folder = Folder::new("view");
    let simulated = phugoid(&folder.0, &["simulate", "f16-calm", "--out", "flight"]);
    assert_eq!(simulated.code, Some(0), "{}", simulated.err);
    let arguments =
        ["estimate", "flight/measured.csv", "--model", "f16-model", "--truth", "f16-calm", "--no-report", "--json"];
    let mut with_history = arguments.to_vec();
    with_history.push("--history");
    folder.file("result.json", &phugoid(&folder.0, &with_history).out);
    let run = phugoid(&folder.0, &["view", "result.json", "--html", "page.html"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("page.html"), "{}", run.out);
    let page = folder.read("page.html");
    for expected in ["dCm_alpha", "\"unit\":\"per rad\"", "\"truth\":-0.2", "id=\"data\""] {
        assert!(page.contains(expected), "{expected} is missing");
    }
    for outside in ["src=\"http", "href=\"http", "@import", "<script src"] {
        assert!(!page.contains(outside), "{outside}");
    }
    folder.file("bare.json", &phugoid(&folder.0, &arguments).out);
    let run = phugoid(&folder.0, &["view", "bare.json", "--html", "bare.html"]);
    assert!(run.fails(3).contains("--json --history"), "{}", run.err);
    let run = phugoid(&folder.0, &["view", "flight/measured.csv", "--html", "bare.html"]);
    assert!(run.fails(3).contains("flight/measured.csv"), "{}", run.err);
}
