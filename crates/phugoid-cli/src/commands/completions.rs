//! `phugoid completions` and `phugoid man`: what is known of the command line, in the form of a shell and of `man`.

use std::io;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use phugoid_flight_data::{output_file, printable};

use crate::arguments::{Arguments, Completions, EXIT_CODES, Man};
use crate::failure::Failure;
use crate::output::print;

/// How a manual page of ours begins; the title follows.
const TITLE: &str = ".TH phugoid";

/// Prints the script of a shell.
///
/// # Errors
/// [`Failure::Output`] if standard output cannot be written.
pub(crate) fn completions(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "phugoid", &mut script);
    print(&text(script)?)
}

/// Prints one manual page, or writes all of them.
///
/// # Errors
/// [`Failure::Input`] if there is no such command, or a file of somebody else would be overwritten;
/// [`Failure::Output`] if a page cannot be written.
pub(crate) fn man(arguments: &Man) -> Result<(), Failure> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    match &arguments.out {
        Some(folder) => write_all(&program, folder),
        None => print(&page(wanted(&program, &arguments.command)?)?),
    }
}

/// The command with these names, one after the other.
fn wanted<'a>(program: &'a clap::Command, names: &[String]) -> Result<&'a clap::Command, Failure> {
    names.iter().try_fold(program, |command, name| {
        command.find_subcommand(name).ok_or_else(|| {
            let known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
            let known = if known.is_empty() { "it has none".to_owned() } else { known.join(", ") };
            let of = command.get_bin_name().unwrap_or("phugoid");
            Failure::input(format!("`{of}` has no command `{}`; its commands: {known}", printable::one_line(name)))
        })
    })
}

/// Writes the pages of a program and all its commands. Nothing is written if one of them cannot be.
fn write_all(program: &clap::Command, folder: &Path) -> Result<(), Failure> {
    let mut pages: Vec<(PathBuf, String)> = Vec::new();
    let mut commands = vec![program];
    while let Some(command) = commands.pop() {
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        pages.push((folder.join(format!("{name}.1")), page(command)?));
        commands.extend(command.get_subcommands());
    }
    pages.sort_unstable();
    // A folder of manual pages holds those of other programs, so that the files are looked at one by one.
    if let Some((foreign, _)) = pages.iter().find(|(file, _)| is_foreign(file)) {
        return Err(Failure::input(format!(
            "--out would overwrite `{}`, which is no manual page of phugoid. Name another folder",
            printable::path(foreign)
        )));
    }
    std::fs::create_dir_all(folder).map_err(|e| Failure::writing(folder, e))?;
    for (file, page) in &pages {
        output_file::write(file, page).map_err(|e| Failure::writing(file, e))?;
    }
    print(&format!("{} pages in {}\n", pages.len(), printable::path(folder)))
}

/// Whether a file is there and is no manual page of this program.
fn is_foreign(file: &Path) -> bool {
    file.exists() && !std::fs::read_to_string(file).is_ok_and(|text| text.contains(TITLE))
}

/// The manual page of a command. Examples and exit codes have sections of their own, with their lines as they are.
fn page(command: &clap::Command) -> Result<String, Failure> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    // The section `EXTRA` of the library would fill the lines of the examples like a paragraph.
    let command = command.clone().after_help(None::<&str>).version(env!("CARGO_PKG_VERSION"));
    let source = concat!("phugoid ", env!("CARGO_PKG_VERSION"));
    let mut bytes = Vec::new();
    clap_mangen::Man::new(command)
        .title(name)
        .source(source)
        .manual("Phugoid")
        .render(&mut bytes)
        .map_err(Failure::impossible)?;
    let mut page = text(bytes)?;
    let examples = after.replace(EXIT_CODES, "");
    let sections = [("EXAMPLES", examples.trim_start_matches("Examples:\n").trim_end()), ("EXIT STATUS", exit_codes())];
    for (title, lines) in sections.into_iter().filter(|(_, lines)| !lines.is_empty()) {
        page.push_str(&format!(".SH \"{title}\"\n.nf\n"));
        for line in lines.lines() {
            page.push_str(&escaped(line));
            page.push('\n');
        }
        page.push_str(".fi\n");
    }
    Ok(page)
}

/// The lines of the exit codes without their title.
fn exit_codes() -> &'static str {
    EXIT_CODES.split_once('\n').map_or(EXIT_CODES, |(_, lines)| lines)
}

/// A line of text in the language of manual pages: backslashes, hyphens that are minus signs, and first characters that
/// would be a request.
fn escaped(line: &str) -> String {
    let line = line.replace('\\', "\\e").replace('-', "\\-").replace('`', "\\(ga").replace('\'', "\\(aq");
    if line.starts_with('.') { format!("\\&{line}") } else { line }
}

/// What a library has written into memory.
fn text(bytes: Vec<u8>) -> Result<String, Failure> {
    String::from_utf8(bytes).map_err(|e| Failure::impossible(io::Error::other(e)))
}
