//! Where a command writes: never over a file that it reads, never twice to one place, and never into a folder whose
//! files are not results of this program. Everything is checked before the command begins, so that nothing is computed
//! in vain.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use phugoid_flight_data::{output_file, printable};
use phugoid_report::is_figure;

use crate::arguments::{Arguments, Command, Further};
use crate::failure::Failure;

/// Everything that a command is asked to read and to write.
#[derive(Default)]
struct Plan {
    /// Files that are read.
    inputs: Vec<PathBuf>,
    /// Folders all of whose files are read.
    input_folders: Vec<PathBuf>,
    /// Files that are written, with the options that name them.
    files: Vec<(&'static str, PathBuf)>,
    /// The file that is only begun here and goes on by hand (`init --out`): it has to be a new one.
    begun: Option<PathBuf>,
    /// Folder of the result (`--out`).
    folder: Option<Folder>,
    /// Folder of `--figures`, in which SVG and PNG files are written.
    figures: Option<PathBuf>,
}

/// The folder of a result and the names of the files that are written there.
struct Folder {
    path: PathBuf,
    names: &'static [&'static str],
    /// Files of other names that end so are written too.
    extension: Option<&'static str>,
}

/// Pages by which a folder of ours is known.
const PAGES: [&str; 4] = ["report.html", "compatibility.html", "design.html", "flight.html"];
/// What stands under the title of every page of ours.
const MARK: &[u8] = b" by Phugoid</p>";
/// A simulated flight has no page; it is known by both of its files.
pub(crate) const FLIGHT: [&str; 2] = ["measured.csv", "truth.csv"];
/// Files that are being written begin so (`phugoid_flight_data::output_file`).
const TEMPORARY: &str = ".phugoid-";

/// Checks the files and folders that the command line names.
///
/// # Errors
/// [`Failure::Input`] if something would be written over a file that is read, or twice to one file;
/// [`Failure::Output`] if a folder of results holds files that are none of ours or is a file, or if a file that goes on by hand
/// exists.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let plan = Plan::of(arguments);
    let targets = plan.targets();
    for (option, target) in &targets {
        if let Some(input) = plan.inputs.iter().find(|input| is_same(input, target)) {
            return Err(over(option, target, input));
        }
        if let Some(folder) = plan.input_folders.iter().find(|folder| target.is_file() && is_inside(target, folder)) {
            return Err(Failure::input(format!(
                "{option} would overwrite `{}` in the folder `{}`, which is read. Name another place",
                target.display(),
                folder.display()
            )));
        }
    }
    for (index, (option, target)) in targets.iter().enumerate() {
        let twin = targets.iter().take(index).find(|(_, other)| place(other) == place(target));
        if let Some((other, _)) = twin.filter(|_| !is_special(target)) {
            return Err(Failure::input(format!(
                "{other} and {option} both name `{}`: one would overwrite the other. Name two files",
                target.display()
            )));
        }
    }
    plan.begun.as_deref().map_or(Ok(()), check_begun)?;
    plan.folder.as_ref().map_or(Ok(()), check_folder)?;
    plan.figures.as_deref().map_or(Ok(()), check_figures)?;
    clean(&plan, &targets);
    Ok(())
}

/// Removes half-written files that killed programs have left where this command writes, and says so.
fn clean(plan: &Plan, targets: &[(&str, PathBuf)]) {
    let parents = targets.iter().filter(|(_, target)| !is_special(target)).filter_map(|(_, target)| target.parent());
    let mut folders: Vec<&Path> = parents.chain(plan.figures.as_deref()).collect();
    folders.sort_unstable();
    folders.dedup();
    for folder in folders {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        for file in output_file::remove_abandoned(folder) {
            let _ = writeln!(
                io::stderr(),
                "removed {}: the beginning of a result that a program was writing when it was killed",
                printable::path(&file)
            );
        }
    }
}

/// Checks a file that a scenario names, which is known only once that has been read, as [`check`] does.
///
/// # Errors
/// [`Failure::Input`] if the folder of `--out` would get a file of this command over it.
pub(crate) fn check_further_input(input: &Path, out: &Path, names: &[&str]) -> Result<(), Failure> {
    let target = names.iter().map(|name| out.join(name)).find(|target| is_same(input, target));
    target.map_or(Ok(()), |target| Err(over("--out", &target, input)))
}

fn over(option: &str, target: &Path, input: &Path) -> Failure {
    Failure::input(format!(
        "{option} would overwrite `{}`: it is the same file as `{}`, which is read. Name another place",
        target.display(),
        input.display()
    ))
}

/// Refuses a file that exists: nobody else has what was changed in it by hand.
fn check_begun(file: &Path) -> Result<(), Failure> {
    if !file.exists() || is_special(file) {
        return Ok(());
    }
    Err(Failure::Output(format!(
        "--out {}: this file exists, and what was written into it by hand would be lost.\nName a new file with --out, or \
         remove this one first.",
        file.display()
    )))
}

/// Why nothing is written into a folder, and which folder to name.
fn refused(option: &str, folder: &Path, why: &str) -> Result<(), Failure> {
    Err(Failure::Output(format!(
        "{option} {}: {why}\nName with {option} a new or an empty folder, or the folder of an earlier result.",
        folder.display()
    )))
}

/// Refuses a file where a folder is needed: it would be known only once everything is computed.
fn check_is_folder(option: &str, folder: &Path) -> Result<(), Failure> {
    match folder.exists() && !folder.is_dir() {
        true => refused(option, folder, "this is a file, and a folder is needed."),
        false => Ok(()),
    }
}

/// Refuses a folder with files that are none of ours. The current folder may hold others, as long as none is replaced.
fn check_folder(folder: &Folder) -> Result<(), Failure> {
    check_is_folder("--out", &folder.path)?;
    // What cannot be listed is refused where it is written to.
    let Ok(entries) = fs::read_dir(&folder.path) else { return Ok(()) };
    let refused = |why: String| refused("--out", &folder.path, &why);
    let foreign_page =
        folder.names.iter().find(|name| name.ends_with(".html") && is_foreign_page(&folder.path.join(name)));
    if let Some(page) = foreign_page {
        return refused(format!("`{page}` in this folder is no page of phugoid, and would be overwritten."));
    }
    let Some(other) = first_file(entries) else { return Ok(()) };
    if holds_a_result(&folder.path) {
        return Ok(());
    }
    let replaced = folder.names.iter().find(|name| folder.path.join(name).exists());
    match (is_current(&folder.path), replaced) {
        (true, None) => Ok(()),
        (true, Some(name)) => refused(format!(
            "`{name}` exists in the current folder, is no result of phugoid, and would be overwritten."
        )),
        (false, _) => refused(nothing_of_ours(&other)),
    }
}

/// The same for the folder of `--figures`. Which figures there will be is known only at the end, so that no picture there may be
/// one of others.
fn check_figures(folder: &Path) -> Result<(), Failure> {
    check_is_folder("--figures", folder)?;
    // What cannot be listed is refused where it is written to.
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    let pictures = existing(folder, &["svg", "png"]);
    // Each figure is written in both forms, and the text of the drawing shows whose it is.
    if let Some(foreign) = pictures.iter().find(|picture| !is_figure(&picture.with_extension("svg"))) {
        let name = foreign.file_name().unwrap_or_default().to_string_lossy();
        let why = format!("`{name}` in this folder is no figure of phugoid, and could be overwritten.");
        return refused("--figures", folder, &why);
    }
    let Some(other) = first_file(entries) else { return Ok(()) };
    match !pictures.is_empty() || holds_a_result(folder) || is_current(folder) {
        true => Ok(()),
        false => refused("--figures", folder, &nothing_of_ours(&other)),
    }
}

fn nothing_of_ours(other: &str) -> String {
    format!("the folder is not empty and holds no result of phugoid, but `{other}`.")
}

/// The name of a file or folder in a folder; none if there is nothing but what is being written.
fn first_file(entries: fs::ReadDir) -> Option<String> {
    let mut names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.find(|name| !name.starts_with(TEMPORARY))
}

/// Whether a folder is that of an earlier result.
fn holds_a_result(folder: &Path) -> bool {
    FLIGHT.iter().all(|name| folder.join(name).is_file())
        || PAGES.iter().any(|page| is_page_of_ours(&folder.join(page)))
}

impl Plan {
    fn of(arguments: &Arguments) -> Self {
        let mut plan = Self::default();
        const REPORT: &[&str] = &["report.html"];
        match &arguments.command {
            None => {
                plan.folder(arguments.demonstration.folder(), REPORT, None);
                plan.figures.clone_from(&arguments.demonstration.figures);
            }
            Some(Command::Trim(a)) => plan.file("--out", a.delivery.out.as_ref()),
            Some(Command::Linearize(a)) => plan.file("--out", a.delivery.out.as_ref()),
            Some(Command::ExportFmu(a)) => {
                let aircraft = &a.condition.aircraft;
                plan.words([&aircraft.aircraft]);
                plan.inputs.extend(aircraft.with.iter().chain(&a.libraries).cloned());
                plan.file("--out", Some(&a.out));
            }
            Some(Command::Check(a)) => {
                plan.inputs.extend(a.models.iter().cloned());
                plan.file("--out", a.delivery.out.as_ref());
            }
            Some(Command::Simulate(a)) => {
                if a.list || a.show {
                    return plan;
                }
                plan.words(&a.scenario);
                plan.folder(&a.out, &FLIGHT, None);
                plan.figures.clone_from(&a.figures);
            }
            Some(Command::Inspect(a)) => {
                plan.inputs.push(a.flight.clone());
                plan.inputs.extend(a.deleting.deletions.clone());
                plan.words(&a.model);
                plan.file("--out", a.delivery.out.as_ref());
                plan.figures.clone_from(&a.figures);
            }
            Some(Command::Init(a)) => {
                plan.inputs.push(a.flight.clone());
                plan.file("--out", a.out.as_ref());
                plan.begun.clone_from(&a.out);
            }
            Some(Command::Estimate(a)) => {
                let truths = a.truth.iter().filter_map(|truth| match truth {
                    crate::arguments::Truth::Scenario(wanted) => Some(wanted),
                    crate::arguments::Truth::Value(..) => None,
                });
                plan.words(truths);
                plan.words(&a.model);
                plan.inputs.extend(a.flight.iter().chain(&a.correct).cloned());
                plan.inputs.extend(a.with.iter().chain(&a.predict).map(|word| Further::of(word).file));
                plan.inputs.extend(a.deleting.deletions.clone());
                if a.flight.is_none() {
                    return plan;
                }
                if !a.no_report {
                    plan.folder(&a.out, REPORT, None);
                }
                plan.figures.clone_from(&a.figures);
                plan.file("--history", a.history.as_ref().and_then(Option::as_ref));
                a.export.iter().for_each(|export| plan.file("--export", Some(&export.file)));
                plan.file("--write-model", a.write_model.as_ref());
            }
            Some(Command::Regress(a)) => {
                plan.inputs.push(a.flight.clone());
                plan.inputs.extend(a.deleting.deletions.clone());
                plan.words([&a.model]);
                plan.file("--out", a.delivery.out.as_ref());
            }
            Some(Command::Monitor(a)) => {
                plan.inputs.push(a.flight.clone());
                plan.inputs.extend(a.expected.iter().chain(&a.deleting.deletions).cloned());
                plan.words([&a.model]);
                if let Some(out) = &a.out {
                    plan.folder(out, &["health.json", "report.html"], None);
                }
            }
            Some(Command::Fly(a)) => {
                plan.words([&a.scenario, &a.model]);
                plan.folder(&a.out, &["flight.html"], None);
            }
            Some(Command::Study(a)) => {
                plan.words(a.scenario.iter().chain(&a.model));
                plan.file("--out", a.delivery.out.as_ref());
            }
            Some(Command::Field(a)) => {
                plan.input_folders.push(a.folder.clone());
                plan.file("--out", a.delivery.out.as_ref());
            }
            #[cfg(feature = "fleet")]
            Some(Command::Fleet(a)) => {
                plan.inputs.extend(a.estimating.logs.iter().map(PathBuf::from).filter(|path| path.is_file()));
                plan.inputs.extend(a.estimating.flights.clone());
                plan.words(&a.estimating.model);
                plan.file("--out", a.estimating.delivery.out.as_ref());
                if let Some(question) = &a.question {
                    question.files().for_each(|(option, file)| plan.file(option, file));
                }
            }
            #[cfg(feature = "fleet")]
            Some(Command::Campaign(a)) => {
                plan.inputs.push(a.file.clone());
                plan.file("--out", a.delivery.out.as_ref());
            }
            Some(Command::Compare(a)) => {
                if !a.list {
                    plan.words(a.scenarios.iter().chain(&a.model));
                    let names = &["report.html", "comparison.json", "comparison.csv", "comparison.parquet"];
                    plan.folder(&a.out, names, None);
                }
            }
            Some(Command::Reproduce(a)) => {
                if !a.list && !a.show {
                    plan.words(&a.cases);
                    plan.folder(&a.out, &["report.html", "reproduction.json"], Some("csv"));
                }
            }
            Some(Command::Tune(a)) => {
                plan.words(a.scenario.iter().chain(&a.hold_out).chain(&a.model));
                plan.file("--out", Some(&a.out));
                plan.file("--state", a.state.as_ref());
            }
            Some(Command::Design(a)) => {
                plan.words([&a.scenario].into_iter().chain(&a.model));
                let names = &["design.html", "input.csv", "scenario.toml", "autopilot.csv", "ardupilot.lua"];
                plan.folder(&a.out, names, None);
                plan.figures.clone_from(&a.figures);
            }
            Some(Command::Compatibility(a)) => {
                plan.inputs.push(a.flight.clone());
                plan.inputs.extend(a.with.iter().map(|word| Further::of(word).file));
                plan.inputs.extend(a.deleting.deletions.clone());
                plan.words(&a.model);
                plan.folder(&a.out, &["compatibility.html", "corrected.csv", "corrections.json"], None);
                plan.figures.clone_from(&a.figures);
            }
            Some(Command::View(a)) => {
                plan.inputs.push(a.result.clone());
                plan.file("--html", a.html.as_ref());
            }
            Some(Command::Live(a)) => {
                plan.inputs.extend(a.replay.iter().chain(&a.mavlink_key).cloned());
                plan.words(&a.model);
                plan.file("--out", a.out.as_ref());
                plan.file("--record", a.record.as_ref());
            }
            // Nothing is read, and the pages look at what they would replace themselves.
            Some(Command::Completions(_) | Command::Man(_)) => {}
        }
        plan
    }

    /// Words that name a file, or else something that is built in.
    fn words<'a>(&mut self, words: impl IntoIterator<Item = &'a String>) {
        self.inputs.extend(words.into_iter().map(PathBuf::from).filter(|path| path.exists()));
    }

    fn file(&mut self, option: &'static str, file: Option<&PathBuf>) {
        self.files.extend(file.map(|file| (option, file.clone())));
    }

    fn folder(&mut self, path: &Path, names: &'static [&'static str], extension: Option<&'static str>) {
        self.folder = Some(Folder { path: path.to_owned(), names, extension });
    }

    /// Every file that is written, as far as its name is known, or exists already.
    fn targets(&self) -> Vec<(&'static str, PathBuf)> {
        let mut targets = self.files.clone();
        if let Some(folder) = &self.folder {
            targets.extend(folder.names.iter().map(|name| ("--out", folder.path.join(name))));
            let others = existing(&folder.path, folder.extension.as_slice());
            targets.extend(others.into_iter().map(|path| ("--out", path)));
        }
        let figures = self.figures.iter().flat_map(|folder| existing(folder, &["svg", "png"]));
        targets.extend(figures.map(|path| ("--figures", path)));
        targets
    }
}

/// The files of a folder whose names have one of these extensions.
fn existing(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let fits = |path: &PathBuf| path.extension().is_some_and(|found| extensions.iter().any(|e| found == *e));
    let paths = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    paths.filter(fits).collect()
}

/// Whether a target is the file that an input names, by another path or by a link.
fn is_same(input: &Path, target: &Path) -> bool {
    if is_special(target) {
        return false;
    }
    match (fs::canonicalize(input), fs::canonicalize(target)) {
        (Ok(input), Ok(target)) => input == target || is_one_file(&input, &target),
        _ => false,
    }
}

/// Whether two paths are hard links of one file.
#[cfg(unix)]
fn is_one_file(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;

    match (fs::metadata(one), fs::metadata(other)) {
        (Ok(one), Ok(other)) => (one.dev(), one.ino()) == (other.dev(), other.ino()),
        _ => false,
    }
}

/// The standard library gives no identity of a file on this system.
#[cfg(not(unix))]
fn is_one_file(_: &Path, _: &Path) -> bool {
    false
}

/// Whether a target is a pipe, a device or the like, which holds nothing that could be overwritten.
fn is_special(target: &Path) -> bool {
    fs::metadata(target).is_ok_and(|target| !target.is_file())
}

fn is_inside(target: &Path, folder: &Path) -> bool {
    let [target, folder] = [target, folder].map(fs::canonicalize);
    target.is_ok_and(|target| folder.is_ok_and(|folder| target.starts_with(folder)))
}

fn is_current(folder: &Path) -> bool {
    matches!((fs::canonicalize(folder), fs::canonicalize(".")), (Ok(folder), Ok(here)) if folder == here)
}

/// A path of a file, whether it exists or not, that is the same for two spellings of it.
fn place(file: &Path) -> PathBuf {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    fs::canonicalize(file).unwrap_or_else(|_| file.file_name().map_or_else(|| folder.clone(), |name| folder.join(name)))
}

fn is_page_of_ours(page: &Path) -> bool {
    fs::read(page).is_ok_and(|page| page.windows(MARK.len()).any(|part| part == MARK))
}

fn is_foreign_page(page: &Path) -> bool {
    page.exists() && !is_page_of_ours(page)
}
