//! `phugoid view`: results as pages.
// What goes wrong in a helper fails the test.
#![allow(clippy::unwrap_used)]

use crate::common;

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
    #[cfg(feature = "live")]
    // Served: the page says where it is, and answers there.
    assert!(served(&folder).contains("dCm_alpha"));
    folder.file("bare.json", &phugoid(&folder.0, &arguments).out);
    let run = phugoid(&folder.0, &["view", "bare.json", "--html", "bare.html"]);
    assert!(run.fails(3).contains("--json --history"), "{}", run.err);
    let run = phugoid(&folder.0, &["view", "flight/measured.csv", "--html", "bare.html"]);
    assert!(run.fails(3).contains("flight/measured.csv"), "{}", run.err);
}

/// The page that `phugoid view` serves.
#[cfg(feature = "live")]
fn served(folder: &Folder) -> String {
    use std::io::{BufRead, BufReader, Read, Write};
    use std::process::{Command, Stdio};

    let mut program = Command::new(env!("CARGO_BIN_EXE_phugoid"))
        .args(["view", "result.json", "--listen", "127.0.0.1:0"])
        .current_dir(&folder.0)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = String::new();
    BufReader::new(program.stderr.take().unwrap()).read_line(&mut said).unwrap();
    let address = said.trim().strip_prefix("page: http://").and_then(|rest| rest.strip_suffix('/')).unwrap().to_owned();
    let mut connection = std::net::TcpStream::connect(&address).unwrap();
    write!(connection, "GET / HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    connection.read_to_string(&mut answer).unwrap();
    program.kill().unwrap();
    program.wait().unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    answer
}
