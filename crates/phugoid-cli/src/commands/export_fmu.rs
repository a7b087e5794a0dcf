//! `phugoid export-fmu`.

/// A build without the feature is asked for an FMU.
#[cfg(not(feature = "fmu"))]
pub(crate) fn run(arguments: &crate::arguments::ExportFmu) -> Result<(), crate::failure::Failure> {
    Err(crate::failure::Failure::input(format!(
        "--out {}: this build does not write FMUs; build it with cargo install --path crates/phugoid-cli --features fmu, and the \
         library that runs in them with cargo build --release -p phugoid-fmi",
        arguments.out.display()
    )))
}

#[cfg(feature = "fmu")]
pub(crate) use with_archives::run;

#[cfg(feature = "fmu")]
mod with_archives {
    use std::fmt::Write as _;
    use std::path::{Path, PathBuf};

    use phugoid_flight_data::output_file;
    use phugoid_flight_dynamics::trim::Trim;
    use phugoid_fmu::{ExportError, Exported, Library, Source, export};
    use serde::Serialize;

    use super::super::trim::{Described, aircraft, options, tables, title, trimmed};
    use crate::arguments;
    use crate::failure::Failure;
    use crate::output::{Table, fixed, json, print, wrapped};

    /// The environment variable that names the library.
    const VARIABLE: &str = "PHUGOID_FMI_LIBRARY";

    #[derive(Serialize)]
    struct Document<'a> {
        #[serde(flatten)]
        aircraft: &'a Described,
        fmu: &'a Path,
        bytes: usize,
        fmi_version: &'static str,
        interfaces: [&'static str; 2],
        model_identifier: &'a str,
        instantiation_token: &'a str,
        platforms: &'a [String],
        files: &'a [String],
        licence: &'a str,
        trim: &'a Trim,
    }

    pub(crate) fn run(arguments: &arguments::ExportFmu) -> Result<(), Failure> {
        let condition = &arguments.condition;
        let (aircraft, described) = aircraft(&condition.aircraft)?;
        let trim = trimmed(&aircraft, condition)?;
        let libraries = libraries(&arguments.libraries)?;
        let source = Source {
            aircraft: condition.aircraft.aircraft.clone(),
            options: options(&condition.aircraft),
            tables: tables(&condition.aircraft),
            cg: condition.aircraft.cg,
        };
        let exported = export(&aircraft, &source, &trim, &libraries).map_err(failure)?;
        let out = &arguments.out;
        output_file::write(out, &exported.bytes).map_err(|error| Failure::writing(out, error))?;
        let document = Document {
            aircraft: &described,
            fmu: out,
            bytes: exported.bytes.len(),
            fmi_version: "3.0",
            interfaces: ["model_exchange", "co_simulation"],
            model_identifier: &exported.identifier,
            instantiation_token: &exported.token,
            platforms: &exported.platforms,
            files: &exported.files,
            licence: &exported.licence.text,
            trim: &trim,
        };
        if arguments.json { print(&json(&document)?) } else { print(&text(&document, &exported)) }
    }

    /// What cannot be written for want of room is told from what cannot be.
    fn failure(error: ExportError) -> Failure {
        match error {
            ExportError::Writing(_) | ExportError::Packing(_) => Failure::Output(error.to_string()),
            _ => Failure::input(error),
        }
    }

    /// The libraries that are named, or the one that is found.
    fn libraries(named: &[PathBuf]) -> Result<Vec<Library>, Failure> {
        let files = if named.is_empty() { vec![found()?] } else { named.to_vec() };
        files.iter().map(|file| Library::open(file).map_err(Failure::input)).collect()
    }

    /// The library of the environment variable, or beside this program.
    fn found() -> Result<PathBuf, Failure> {
        if let Some(file) = std::env::var_os(VARIABLE).filter(|file| !file.is_empty()) {
            return Ok(file.into());
        }
        let name = Library::file_name();
        let beside = std::env::current_exe().ok().and_then(|program| program.parent().map(|folder| folder.join(&name)));
        if let Some(file) = beside.as_ref().filter(|file| file.is_file()) {
            return Ok(file.clone());
        }
        let looked = beside.map_or_else(String::new, |file| format!(" (not at {})", file.display()));
        Err(Failure::input(format!(
            "there is no library for the FMU{looked}. In a clone of Phugoid, cargo build --release -p phugoid-fmi builds it: put \
             target/release/{name} beside this program, or name it with --library or in the environment variable {VARIABLE}"
        )))
    }

    fn text(document: &Document<'_>, exported: &Exported) -> String {
        let trim = document.trim;
        let mut text = title(document.aircraft, trim);
        let mut table = Table::new(&["input", "at the trim", ""]);
        for (name, value, unit) in [
            ("throttle", fixed(trim.throttle, 5), ""),
            ("elevator", fixed(trim.elevator_rad.to_degrees(), 5), "deg"),
            ("aileron", fixed(trim.aileron_rad.to_degrees(), 5), "deg"),
            ("rudder", fixed(trim.rudder_rad.to_degrees(), 5), "deg"),
        ] {
            table.row([name.to_owned(), value, unit.to_owned()]);
        }
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}{}", table.render(), document.aircraft.notes_text());
        let _ = writeln!(
            text,
            "\nFMU: {} ({:.1} MB), FMI 3.0, model exchange and co-simulation, for {}",
            document.fmu.display(),
            document.bytes as f64 * 1e-6,
            document.platforms.join(", ")
        );
        text.push_str(&wrapped(&format!(
            "Files in it: {}.",
            match exported.files.as_slice() {
                [] => "none of the aircraft, which is built in".to_owned(),
                files => files.join(", "),
            }
        )));
        text.push_str(&wrapped(
            "Its inputs are positions of surfaces: it has no actuators, whatever a note says of their lags and limits.",
        ));
        text.push_str(&wrapped(document.licence));
        text
    }
}
