//! Where results may be written: never over what is read, never among files of others, and never in part.

use crate::common;

use common::{Folder, phugoid};

/// A folder with a flight, a model file, a scenario and a recording, and the text of each.
fn inputs(name: &str) -> (Folder, Vec<(&'static str, Vec<u8>)>) {
    let folder = Folder::new(name);
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "flight"]).code, Some(0));
    folder.file("flight.csv", &folder.read("flight/measured.csv"));
    folder.file("model.toml", &phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out);
    folder.file("scenario.toml", &phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out);
    let recorded = [
        "live",
        "--replay",
        "flight.csv",
        "--speed",
        "max",
        "--model",
        "model.toml",
        "--no-page",
        "--record",
        "r.live",
    ];
    assert_eq!(phugoid(&folder.0, &recorded).code, Some(0));
    let names = ["flight.csv", "model.toml", "scenario.toml", "r.live"];
    let texts = names.map(|name| (name, std::fs::read(folder.0.join(name)).unwrap()));
    (folder, texts.into())
}

#[test]
fn no_option_writes_over_an_input() {
    let (folder, texts) = inputs("over-input");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("flight.csv", folder.0.join("soft.csv")).unwrap();
        std::fs::hard_link(folder.0.join("flight.csv"), folder.0.join("hard.csv")).unwrap();
    }
    let estimate = ["estimate", "flight.csv", "--model", "model.toml", "--no-report"];
    let with = |more: &[&'static str]| [&estimate[..], more].concat();
    let live = ["live", "--replay", "r.live", "--speed", "max", "--no-page"];
    let study = ["study", "accuracy", "--scenario", "scenario.toml", "--model", "model.toml", "--runs", "2"];
    let mut wrong = vec![
        with(&["--export", "csv=flight.csv"]),
        with(&["--export", "json=./flight.csv"]),
        with(&["--export", "jsbsim=model.toml"]),
        with(&["--export", "csv=a.csv", "--history", "flight.csv"]),
        with(&["--history", "flight/../model.toml"]),
        with(&["--truth", "scenario.toml", "--history", "scenario.toml"]),
        with(&["--with", "flight/measured.csv", "--method", "output-error", "--export", "csv=flight/measured.csv"]),
        vec!["inspect", "flight.csv", "--out", "flight.csv"],
        vec!["inspect", "flight.csv", "--model", "model.toml", "--out", "model.toml"],
        vec!["view", "r.live", "--html", "r.live"],
        [&live[..], &["--out", "r.live"]].concat(),
        [&live[..], &["--record", "r.live"]].concat(),
        [&live[..], &["--model", "model.toml", "--out", "model.toml"]].concat(),
        vec!["tune", "smpe", "--scenario", "scenario.toml", "--model", "model.toml", "--out", "model.toml"],
        vec!["tune", "smpe", "--scenario", "scenario.toml", "--state", "scenario.toml"],
        vec!["field", "flight", "--out", "flight/truth.csv"],
        [&study[..], &["--out", "scenario.toml"]].concat(),
    ];
    if cfg!(unix) {
        wrong.push(with(&["--export", "csv=soft.csv"]));
        wrong.push(with(&["--export", "csv=hard.csv"]));
        wrong.push(vec!["estimate", "soft.csv", "--model", "model.toml", "--no-report", "--history", "hard.csv"]);
    }
    for command in wrong {
        let run = phugoid(&folder.0, &command);
        let message = run.fails(3);
        assert!(message.contains("would overwrite"), "{command:?}: {message}");
        for (name, text) in &texts {
            assert!(std::fs::read(folder.0.join(name)).unwrap() == *text, "{command:?} has changed {name}");
        }
    }
    // Both are named.
    let linked = phugoid(&folder.0, &with(&["--export", "csv=flight/../flight.csv"]));
    assert!(linked.err.contains("`flight/../flight.csv`") && linked.err.contains("`flight.csv`"), "{}", linked.err);
    // Nor twice to one file.
    let twice = phugoid(&folder.0, &with(&["--export", "csv=a.csv", "--history", "./a.csv"]));
    assert!(twice.fails(3).contains("both name"), "{}", twice.err);
    // What only has the name of another folder's file is no input.
    assert_eq!(phugoid(&folder.0, &with(&["--export", "csv=flight/flight.csv"])).code, Some(0));
}

#[test]
fn files_of_a_folder_that_are_inputs_stay() {
    let (folder, _) = inputs("over-folder-input");
    let input = "time_s,elevator_deg\n0,0\n1,-1\n2,1\n30,0\n";
    std::fs::create_dir(folder.0.join("here")).unwrap();
    folder.file("here/measured.csv", input);
    let scenario = folder.read("scenario.toml");
    let (before, after) = (scenario.find("[[manoeuvre]]").unwrap(), scenario.find("[increments]").unwrap());
    let manoeuvre = "[[manoeuvre]]\ntype = \"csv\"\nsurface = \"elevator\"\nfile = \"measured.csv\"\n\n";
    folder.file("here/s.toml", &format!("{}{manoeuvre}{}", &scenario[..before], &scenario[after..]));
    // An earlier flight lies here, so that the folder is one of ours.
    folder.file("here/truth.csv", "");
    let run = phugoid(&folder.0.join("here"), &["simulate", "s.toml", "--out", "."]);
    assert!(run.fails(3).contains("would overwrite"), "{}", run.err);
    assert_eq!(folder.read("here/measured.csv"), input);
    // In another folder it flies.
    assert_eq!(phugoid(&folder.0.join("here"), &["simulate", "s.toml", "--out", "../there"]).code, Some(0));
}

#[test]
fn a_folder_of_others_is_refused_and_one_of_ours_written_again() {
    let (folder, _) = inputs("folders");
    std::fs::create_dir(folder.0.join("photos")).unwrap();
    folder.file("photos/wedding.jpg", "a picture");
    let estimate = |out: &str| phugoid(&folder.0, &["estimate", "flight.csv", "--model", "model.toml", "--out", out]);
    for run in [
        estimate("photos"),
        phugoid(&folder.0, &["--out", "photos"]),
        phugoid(&folder.0, &["simulate", "f16-calm", "--out", "photos"]),
        phugoid(&folder.0, &["reproduce", "first-order/1", "--out", "photos"]),
        phugoid(&folder.0, &["monitor", "flight.csv", "--model", "model.toml", "--out", "photos"]),
    ] {
        let message = run.fails(4);
        assert!(message.contains("wedding.jpg") && message.contains("new or an empty folder"), "{message}");
    }
    assert_eq!(std::fs::read_dir(folder.0.join("photos")).unwrap().count(), 1);
    // New, empty, and then ours.
    std::fs::create_dir(folder.0.join("empty")).unwrap();
    for out in ["empty", "empty", "new", "new", "flight"] {
        assert_eq!(estimate(out).code, Some(0), "{out}");
    }
    // A page of somebody else under the name of ours, in the current folder too.
    folder.file("report.html", "<p>mine</p>");
    let own = estimate(".");
    assert!(own.fails(4).contains("`report.html`"), "{}", own.err);
    assert_eq!(folder.read("report.html"), "<p>mine</p>");
    // In the current folder other files may lie, if none is replaced.
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    std::fs::remove_file(folder.0.join("truth.csv")).unwrap();
    assert!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).fails(4).contains("`measured.csv`"));
}

/// Which figures there will be is known only at the end: a folder with pictures of others is refused before anything is computed.
#[test]
fn figures_are_not_written_among_those_of_others() {
    let (folder, _) = inputs("figures");
    let estimate = ["estimate", "flight.csv", "--model", "model.toml", "--no-report", "--figures"];
    let figures = |place: &str| phugoid(&folder.0, &[&estimate[..], &[place]].concat());
    for (name, file) in [("mine", "inputs.png"), ("drawings", "inputs.svg"), ("letters", "letter.txt")] {
        std::fs::create_dir(folder.0.join(name)).unwrap();
        folder.file(&format!("{name}/{file}"), "my own");
        let run = figures(name);
        let message = run.fails(4);
        assert!(message.contains(&format!("--figures {name}")) && message.contains(file), "{message}");
        assert_eq!(folder.read(&format!("{name}/{file}")), "my own");
        assert_eq!(std::fs::read_dir(folder.0.join(name)).unwrap().count(), 1);
    }
    // New, then ours; in the folder of a result, and in the current one.
    for place in ["new", "new", "flight", "flight", ".", "."] {
        assert_eq!(figures(place).code, Some(0), "{place}");
    }
    // What is put among ours later is not ours.
    folder.file("new/photo.png", "my own");
    assert!(figures("new").fails(4).contains("`photo.png`"));
}

#[test]
fn a_file_in_the_place_of_a_folder_is_told_before_anything_is_computed() {
    let (folder, _) = inputs("no-folder");
    let estimate = ["estimate", "flight.csv", "--model", "model.toml", "--no-report"];
    for command in [
        vec!["estimate", "flight.csv", "--model", "model.toml", "--out", "r.live"],
        [&estimate[..], &["--figures", "r.live"]].concat(),
        vec!["simulate", "f16-calm", "--out", "model.toml"],
    ] {
        let run = phugoid(&folder.0, &command);
        let message = run.fails(4);
        assert!(message.contains("this is a file, and a folder is needed"), "{command:?}: {message}");
    }
}

/// A result that cannot be written to its end leaves the earlier one, and nothing beside it.
#[cfg(target_os = "linux")]
#[test]
fn a_result_that_fails_half_way_leaves_the_earlier_one() {
    let (folder, _) = inputs("half");
    folder.file("history.csv", "the earlier one\n");
    let command = "ulimit -f 40; trap '' XFSZ; \
                   exec \"$0\" estimate flight.csv --model model.toml --no-report --history history.csv";
    let run = std::process::Command::new("bash")
        .args(["-c", command, env!("CARGO_BIN_EXE_phugoid")])
        .current_dir(&folder.0)
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(4), "{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(folder.read("history.csv"), "the earlier one\n");
    let left = std::fs::read_dir(&folder.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(left.filter(|name| name.starts_with('.')).collect::<Vec<_>>(), Vec::<String>::new());
}

/// What a kill has left of a result is removed by the next command that writes there, which says so; files that are
/// being written, or are none of ours, stay.
#[test]
fn what_a_kill_has_left_is_removed_and_said() {
    let (folder, texts) = inputs("abandoned");
    std::fs::create_dir(folder.0.join("out")).unwrap();
    let an_hour_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(3600);
    let left = |name: &str, changed: std::time::SystemTime| {
        let path = folder.file(name, "half");
        std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_modified(changed).unwrap();
        path
    };
    let abandoned = [left(".phugoid-77-0.part", an_hour_ago), left("out/.phugoid-78-3.part", an_hour_ago)];
    let others = [left(".phugoid-79-0.part", std::time::SystemTime::now()), left("flight.part", an_hour_ago)];
    // A command that writes nothing there removes nothing there.
    assert_eq!(phugoid(&folder.0, &["inspect", "flight.csv"]).code, Some(0));
    assert!(abandoned.iter().all(|path| path.exists()));
    let command = ["estimate", "flight.csv", "--model", "model.toml", "--out", "out", "--export", "csv=e.csv"];
    let run = phugoid(&folder.0, &command);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for (path, shown) in abandoned.iter().zip(["./.phugoid-77-0.part", "out/.phugoid-78-3.part"]) {
        assert!(!path.exists() && run.err.contains(&format!("removed {shown}: ")), "{}", run.err);
    }
    assert!(others.iter().all(|path| path.exists()));
    for (name, text) in texts {
        assert!(std::fs::read(folder.0.join(name)).unwrap() == text, "{name}");
    }
}

/// Standard output and pipes are written as they are, and not replaced.
#[cfg(unix)]
#[test]
fn standard_output_and_pipes_are_written_directly() {
    let (folder, _) = inputs("direct");
    let command =
        ["estimate", "flight.csv", "--model", "model.toml", "--no-report", "--json", "--export", "csv=/dev/stdout"];
    let run = phugoid(&folder.0, &command);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("dCm_alpha,"), "{}", run.out);
    let pipe = folder.0.join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    let to_pipe = ["estimate", "flight.csv", "--model", "model.toml", "--no-report", "--export", "csv=pipe"];
    assert_eq!(phugoid(&folder.0, &to_pipe).code, Some(0));
    assert!(reader.join().unwrap().contains("dCm_alpha,"));
}
