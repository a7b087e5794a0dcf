//! `phugoid init`.

use std::io::{self, BufRead as _, IsTerminal as _, Write as _};

use clap::ValueEnum as _;
use phugoid_flight_data::{output_file, printable, reader};
use phugoid_identification::draft::{AircraftClass, Answers, DraftError, Question, check, draft, questions};

use crate::arguments::{self, ClassName, init};
use crate::failure::Failure;
use crate::output::{print, wrapped};

pub(crate) fn run(arguments: &arguments::Init) -> Result<(), Failure> {
    let record =
        reader::read_path(&arguments.flight, &arguments.reading.options(&arguments.flight)?).map_err(Failure::input)?;
    // Questions are answered by a person who sees them: not by the flight that comes through standard input.
    let asked = io::stdin().is_terminal() && io::stderr().is_terminal();
    // Nobody answers questions about a flight of which no answer makes a model. The class has no part in that.
    let mut answers = arguments.aircraft.answers(AircraftClass::LightSingle);
    check(&record, &answers).map_err(refused)?;
    match arguments.aircraft.class {
        Some(class) => answers.class = class.class(),
        None if asked => answers.class = ask_class()?.class(),
        None => {
            let open: Vec<Question> = [CLASS].into_iter().chain(questions(&record, &answers)).collect();
            return Err(Failure::input(unanswered(&open)));
        }
    }
    let open = questions(&record, &answers);
    match (open.is_empty(), asked) {
        (true, _) => {}
        (false, true) => open.iter().try_for_each(|question| ask(question, &mut answers))?,
        (false, false) => return Err(Failure::input(unanswered(&open))),
    }
    let drafted = draft(&record, &answers).map_err(refused)?;
    match &arguments.out {
        Some(file) => {
            output_file::write(file, &drafted.text).map_err(|error| Failure::writing(file, error))?;
        }
        None => print(&drafted.text)?,
    }
    let mut told = String::new();
    for (title, lines) in [
        ("Assumed, because nobody said it", &drafted.assumed),
        ("Said and recorded", &drafted.said_twice),
        ("Does not belong together", &drafted.doubts),
        ("Doubtful in the record", &drafted.record_doubts),
    ] {
        if !lines.is_empty() {
            told.push_str(title);
            told.push('\n');
            lines.iter().for_each(|line| told.push_str(&wrapped(&printable::one_line(line))));
        }
    }
    if let Some(file) = &arguments.out {
        let (flight, file) = (printable::path(&arguments.flight), printable::path(file));
        let parts: String = drafted.manoeuvres.iter().map(|number| format!(" --segment {number}")).collect();
        told.push_str(&format!("Next: phugoid estimate {flight} --model {file}{parts}\n"));
        if !parts.is_empty() {
            told.push_str(&wrapped(
                "The model is of the axes that these manoeuvres move; in the rest of the flight the other axes move too, which it \
                 cannot explain.",
            ));
        }
    }
    // Nobody is left to tell when standard error is closed.
    let _ = io::stderr().write_all(told.as_bytes());
    Ok(())
}

/// What the flight cannot give, told apart from what is wrong with the answers and with the file.
fn refused(error: DraftError) -> Failure {
    match error {
        DraftError::Channels { .. } | DraftError::NoCommand { .. } | DraftError::Unreadable(_) => {
            Failure::impossible(error)
        }
        error => Failure::input(error),
    }
}

const CLASS: Question = Question {
    key: "class",
    text: "what kind of aircraft it is (light-single, transport, glider, drone, fighter)",
    why: "what is typical stands in for what nobody knows",
};

/// The options that answer what is open, in one message.
fn unanswered(open: &[Question]) -> String {
    let mut text = "something has to be known that no flight tells; say it by options:".to_owned();
    for Question { key, text: question, why } in open {
        text.push_str(&format!("\n  --{}: {question} ({why})", key.replace('_', "-")));
    }
    text
}

fn ask_class() -> Result<ClassName, Failure> {
    loop {
        let answer = line("Kind of aircraft (light-single, transport, glider, drone, fighter): ")?;
        match ClassName::from_str(answer.trim(), true) {
            Ok(class) => return Ok(class),
            Err(_) => eprintln!("  one of the five words, please"),
        }
    }
}

/// Reads an answer as a number in SI units.
type Parse = fn(&str) -> Result<f64, String>;

/// Asks until the answer is a quantity with its unit.
fn ask(question: &Question, answers: &mut Answers) -> Result<(), Failure> {
    let (parse, slot, example): (Parse, _, _) = match question.key {
        "mass" => (init::mass, &mut answers.mass_kg, "1034 kg"),
        "wing_area" => (init::area, &mut answers.wing_area_m2, "16.2 m^2"),
        "wing_span" => (init::size, &mut answers.wing_span_m, "10.9 m"),
        "elevator_travel" => (init::angle, &mut answers.elevator_travel_rad, "-20 deg"),
        "aileron_travel" => (init::angle, &mut answers.aileron_travel_rad, "20 deg"),
        "rudder_travel" => (init::angle, &mut answers.rudder_travel_rad, "25 deg"),
        _ => (init::length, &mut answers.altitude_m, "5000 ft"),
    };
    loop {
        let answer = line(&format!("{} ({}), such as {example}: ", question.text, question.why))?;
        match parse(answer.trim()) {
            Ok(value) => {
                *slot = Some(value);
                return Ok(());
            }
            Err(error) => eprintln!("  {error}"),
        }
    }
}

/// A line from the person at the terminal.
fn line(prompt: &str) -> Result<String, Failure> {
    eprint!("{prompt}");
    let _ = io::stderr().flush();
    let mut answer = String::new();
    match io::stdin().lock().read_line(&mut answer) {
        Ok(0) => Err(Failure::input("no answer was given")),
        Ok(_) => Ok(answer),
        Err(error) => Err(Failure::input(format!("standard input cannot be read: {error}"))),
    }
}
