//! Help texts, scripts of shells and manual pages.

use std::collections::BTreeSet;
use std::process::Command;

use crate::common;

use common::{Folder, phugoid};

/// Names of all commands, from the help text of the program.
fn commands(folder: &Folder) -> Vec<String> {
    let help = phugoid(&folder.0, &["-h"]).out;
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").map(str::to_owned).collect()
}

/// The options of a command, from its help text.
fn options(help: &str) -> BTreeSet<String> {
    let lines = help.lines().map(str::trim_start).filter(|line| line.starts_with('-'));
    let words = lines.flat_map(|line| line.split([' ', ',']).take(3)).filter(|word| word.starts_with("--"));
    words.map(str::to_owned).collect()
}

#[test]
fn no_help_text_is_wider_than_a_hundred_columns_or_wrapped_in_the_middle_of_an_example() {
    let folder = Folder::new("help-width");
    let names = commands(&folder);
    assert!(names.len() > 15 && names.contains(&"estimate".to_owned()), "{names:?}");
    for name in [""].into_iter().chain(names.iter().map(String::as_str)) {
        let words: Vec<&str> = [name, "--help"].into_iter().filter(|word| !word.is_empty()).collect();
        let help = phugoid(&folder.0, &words).out;
        for line in help.lines() {
            assert!(line.chars().count() <= 100, "{name}: {line}");
        }
        // An example or an exit code that is too long goes on at the left margin.
        let (_, below) = help.split_once("Examples:\n").unwrap_or_else(|| panic!("{name} has no examples"));
        let (examples, codes) = below.split_once("Exit codes:\n").unwrap();
        let examples = examples.split("\n\n").next().unwrap();
        assert!(examples.lines().all(|line| line.starts_with("  ")), "{name}: {examples}");
        assert!(codes.lines().all(|line| line.starts_with(' ')), "{name}: {codes}");
    }
}

#[test]
fn help_lists_the_methods_that_a_command_takes() {
    let folder = Folder::new("help-methods");
    let help = |name| phugoid(&folder.0, &[name, "--help"]).out;
    assert!(help("estimate").contains("- output-error:") && help("estimate").contains("- smpe:"));
    for name in ["live", "fly"] {
        assert!(help(name).contains("- smpe:") && help(name).contains("- fourier:"), "{name}");
        assert!(!help(name).contains("- output-error") && !help(name).contains("- filter-error"), "{name}");
    }
    // What is not listed is refused with its reason, and not as a word that nobody knows.
    let batch = phugoid(&folder.0, &["fly", "f16-recovery", "--method", "output-error"]);
    assert!(batch.fails(3).contains("looks at a record as a whole"), "{}", batch.err);
}

#[test]
fn a_flight_is_said_to_be_any_format_that_is_read() {
    let folder = Folder::new("help-formats");
    for name in ["estimate", "inspect", "init", "regress", "monitor", "compatibility"] {
        let help = phugoid(&folder.0, &[name, "--help"]).out;
        assert!(help.contains("ULog") && !help.contains("a CSV file with") && !help.contains("<FLIGHT.csv>"), "{name}");
    }
}

#[test]
fn sheets_are_offered_with_what_they_need() {
    let folder = Folder::new("sheets");
    let help = phugoid(&folder.0, &["inspect", "--help"]).out;
    assert_eq!(help.contains("--sheet"), cfg!(feature = "excel"), "{help}");
    assert_eq!(help.contains("--features excel"), cfg!(not(feature = "excel")), "{help}");
}

#[test]
fn every_shell_completes_every_command_and_option() {
    let folder = Folder::new("completions");
    let names = commands(&folder);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = phugoid(&folder.0, &["completions", shell]);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{shell}");
        for name in &names {
            assert!(run.out.contains(name), "{shell}: {name}");
        }
        for option in ["show-model", "max-memory", "false-alarms-per-hour"] {
            assert!(run.out.contains(option), "{shell}: {option}");
        }
    }
    assert_eq!(phugoid(&folder.0, &["completions", "cmd"]).code, Some(2));
}

#[test]
#[cfg(unix)]
fn bash_completes() {
    let folder = Folder::new("completions-bash");
    folder.file("phugoid.bash", &phugoid(&folder.0, &["completions", "bash"]).out);
    // What bash calls when the key is pressed after `phugoid estimate --show-m`.
    let script = "source ./phugoid.bash; COMP_WORDS=(phugoid estimate --show-m); COMP_CWORD=2; \
                  _phugoid phugoid --show-m estimate; echo \"${COMPREPLY[*]}\"";
    let Ok(run) = Command::new("bash").args(["-c", script]).current_dir(&folder.0).output() else {
        return; // No bash on this system.
    };
    assert_eq!(String::from_utf8_lossy(&run.stdout).trim(), "--show-model", "{}", String::from_utf8_lossy(&run.stderr));
}

#[test]
fn every_command_has_a_manual_page_with_all_its_options() {
    let folder = Folder::new("man");
    let run = phugoid(&folder.0, &["man", "--out", "pages"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for name in commands(&folder) {
        let page = folder.read(&format!("pages/phugoid-{name}.1"));
        assert!(page.contains(&format!(".TH phugoid-{name} 1 ")), "{name}: {}", page.lines().nth(2).unwrap());
        let plain = page.replace("\\-", "-");
        for option in options(&phugoid(&folder.0, &[&name, "--help"]).out) {
            assert!(plain.contains(&option), "{name}: {option}");
        }
        for section in [".SH SYNOPSIS", ".SH \"EXAMPLES\"", ".SH \"EXIT STATUS\""] {
            assert!(page.contains(section), "{name}: {section}");
        }
        // Nothing of the text is taken for a request of the language.
        let requests = page.lines().filter(|line| line.starts_with('.')).map(|line| line.split(' ').next().unwrap());
        let known = [".ie", ".el", ".TH", ".SH", ".TP", ".br", ".RS", ".RE", ".IP", ".nf", ".fi", ".PP", ".sp"];
        for request in requests {
            assert!(known.contains(&request), "{name}: {request}");
        }
    }
    let whole = folder.read("pages/phugoid.1");
    assert!(whole.contains("phugoid\\-estimate(1)") && whole.contains("6  the search"), "{whole}");
    // One page by itself is the same, and a second run replaces what the first has written.
    assert_eq!(phugoid(&folder.0, &["man"]).out, whole);
    assert_eq!(phugoid(&folder.0, &["man", "estimate"]).out, folder.read("pages/phugoid-estimate.1"));
    assert_eq!(phugoid(&folder.0, &["man", "--out", "pages"]).code, Some(0));
}

#[test]
fn manual_pages_replace_no_file_of_somebody_else() {
    let folder = Folder::new("man-foreign");
    std::fs::create_dir(folder.0.join("man1")).unwrap();
    folder.file("man1/ls.1", "another program's");
    folder.file("man1/phugoid-trim.1", "my notes");
    let run = phugoid(&folder.0, &["man", "--out", "man1"]);
    assert!(run.fails(3).contains("would overwrite `man1/phugoid-trim.1`"), "{}", run.err);
    assert!(!folder.0.join("man1/phugoid.1").exists(), "something was written");
    std::fs::remove_file(folder.0.join("man1/phugoid-trim.1")).unwrap();
    assert_eq!(phugoid(&folder.0, &["man", "--out", "man1"]).code, Some(0));
    assert_eq!(folder.read("man1/ls.1"), "another program's");
    let unknown = phugoid(&folder.0, &["man", "estimat"]);
    assert!(unknown.fails(3).contains("`phugoid` has no command `estimat`; its commands: trim, "), "{}", unknown.err);
}
