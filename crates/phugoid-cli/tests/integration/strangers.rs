//! Names and texts of strangers: a header or a file name that is made to command a terminal, a browser or a table
//! calculation is shown, and commands nothing.

use crate::common;

use common::{Folder, Run, phugoid};

/// Clears the screen, sets the title of the terminal, C1's control sequence, reverses the direction, and ends a line.
const COMMANDS: &str = "\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}\u{2067}";

fn is_command(character: char) -> bool {
    phugoid_flight_data::printable::is_command(character) && character != '\n'
}

fn assert_shown(what: &str, text: &str) {
    let found = text.char_indices().find(|(_, character)| is_command(*character));
    assert!(found.is_none(), "{what}: {found:?} in {:?}", &text[found.map_or(0, |f| f.0)..].chars().take(80));
}

fn shown(what: &str, run: &Run) {
    assert_shown(what, &run.out);
    assert_shown(what, &run.err);
}

/// The calm flight with further columns under headers that are made to do harm, alpha under one with a line end.
fn flight(folder: &Folder) -> String {
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let text = folder.read("measured.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let header = header.replace("alpha_rad", "\"alpha\n[rad]\"");
    let header =
        format!("{header},evil{COMMANDS},\"=cmd|' /C calc'!A0\",+sum,-difference,@name,<script>alert(1)</script>");
    let rows: String = rows.lines().map(|row| format!("{row},1,2,3,4,5,6\n")).collect();
    let name = format!("evil{COMMANDS}.csv");
    folder.file(&name, &format!("{header}\n{rows}"));
    name
}

#[test]
fn nothing_of_a_header_or_a_file_name_commands_a_terminal_or_a_page() {
    let folder = Folder::new("strangers");
    let name = flight(&folder);
    let inspect = phugoid(&folder.0, &["inspect", &name]);
    assert_eq!(inspect.code, Some(0), "{}", inspect.err);
    // They are there to be seen all the same.
    assert!(inspect.out.contains("evil\u{fffd}[2J") && inspect.out.contains("cmd|"), "{}", inspect.out);
    shown("inspect", &inspect);
    let inspect = phugoid(&folder.0, &["inspect", &name, "--json"]);
    shown("inspect --json", &inspect);
    assert!(inspect.json().to_string().contains("cmd|"));

    let estimate = ["estimate", &name, "--model", "f16-model", "--figures", "figures"];
    let run = phugoid(&folder.0, &estimate);
    assert_eq!(run.code, Some(0), "{}", run.err);
    shown("estimate", &run);
    let page = folder.read("phugoid-report/report.html");
    assert_shown("report.html", &page);
    assert!(!page.contains("<script>alert(1)"));
    for entry in std::fs::read_dir(folder.0.join("figures")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "svg") {
            assert_shown(&path.display().to_string(), &std::fs::read_to_string(&path).unwrap());
        }
    }
    let json = phugoid(&folder.0, &["estimate", &name, "--model", "f16-model", "--no-report", "--json", "--history"]);
    shown("estimate --json", &json);
    folder.file("result.json", &json.out);
    let view = phugoid(&folder.0, &["view", "result.json", "--html", "view.html"]);
    assert_eq!(view.code, Some(0), "{}", view.err);
    let page = folder.read("view.html");
    let data = page.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0;
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_shown("the source on the page", data["hello"]["source"].as_str().unwrap());

    // The line end in the header of alpha is a blank: it is the channel that it names.
    let same =
        phugoid(&folder.0, &["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--json"]).json();
    assert_eq!(json.json()["parameters"], same["parameters"]);

    let live = phugoid(
        &folder.0,
        &["live", "--replay", &name, "--model", "f16-model", "--speed", "max", "--no-page", "--record", "r.live"],
    );
    assert_eq!(live.code, Some(0), "{}", live.err);
    shown("live", &live);
    for line in live.out.lines() {
        let document: serde_json::Value = serde_json::from_str(line).unwrap();
        for text in [&document["source"], &document["message"]] {
            assert_shown(line, text.as_str().unwrap_or_default());
        }
    }
    shown("a file that is not there", &phugoid(&folder.0, &["inspect", &format!("none{COMMANDS}.csv")]));
    shown("no such model", &phugoid(&folder.0, &["estimate", &name, "--model", &format!("none{COMMANDS}")]));
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    let model = model.replacen("name = \"", &format!("name = \"{}", "\\u001b[2J\\u202e"), 1);
    folder.file("evil.toml", &format!("{model}\n[channels]\nalpha = \"none\\u001b\"\n"));
    shown("a mapping", &phugoid(&folder.0, &["estimate", &name, "--model", "evil.toml", "--no-report"]));
    folder.file("evil.toml", &model);
    shown("a model", &phugoid(&folder.0, &["estimate", &name, "--model", "evil.toml", "--no-report"]));
    folder.file("wrong.toml", &format!("{model}\nevil{COMMANDS} = 1\n"));
    shown("a wrong model", &phugoid(&folder.0, &["estimate", &name, "--model", "wrong.toml", "--no-report"]));
}

#[test]
fn a_header_that_looks_like_a_formula_is_written_as_text() {
    let folder = Folder::new("formula");
    let name = flight(&folder);
    let run = phugoid(&folder.0, &["compatibility", &name, "--model", "f16-model"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    shown("compatibility", &run);
    let text = folder.read("phugoid-compatibility/corrected.csv");
    // None of the names has a comma.
    let mut rows = text.lines().map(|row| row.split(',').map(|cell| cell.trim_matches('"')).collect::<Vec<_>>());
    let header = rows.next().unwrap();
    assert!(header.iter().any(|cell| cell.starts_with("'=cmd|")), "{header:?}");
    for cell in header {
        assert!(!cell.starts_with(['=', '+', '-', '@']), "{cell}");
        assert_shown("header", cell);
    }
    // Numbers stay numbers, negative ones too.
    let numbers: Vec<f64> =
        rows.next().unwrap().iter().filter(|cell| !cell.is_empty()).map(|cell| cell.parse().unwrap()).collect();
    assert!(numbers.iter().any(|number| *number < 0.0), "{numbers:?}");
    // What was written is read again under the same names.
    let again = phugoid(&folder.0, &["inspect", "phugoid-compatibility/corrected.csv", "--json"]).json();
    assert!(again.to_string().contains("'=cmd|"), "{again}");
}

/// Names of a user's own inputs become names of parameters, of headers, and lines of TOML to be copied.
#[test]
fn an_input_of_a_model_has_a_name_that_can_be_written_everywhere() {
    let folder = Folder::new("input-names");
    folder.file("flight.csv", "time_s,alpha_deg\n0,1\n1,2\n");
    let model = phugoid(&folder.0, &["estimate", "--show-model", "hfb320"]).out;
    for name in ["a\\u001b[2J", "a\\nb", "a\\\"b", "a,b", " a", ""] {
        folder.file("m.toml", &format!("inputs = [\"{name}\"]\n{model}"));
        let run = phugoid(&folder.0, &["estimate", "flight.csv", "--model", "m.toml", "--no-report"]);
        assert!(run.fails(3).contains("is no name"), "{name}: {}", run.err);
        shown(name, &run);
    }
}
