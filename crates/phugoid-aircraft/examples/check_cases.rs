//! Flies the check cases and prints how the flights compare with those of NASA's simulators, as the table of
//! `docs/check-cases.md`: `cargo run --release -p phugoid-aircraft --example check_cases -- FOLDER [CASE...]` with the
//! folder of `cases.json` and `trajectories`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a program to be read

use std::io::Read;
use std::path::Path;

use phugoid_aircraft::check_case::CheckCases;
use phugoid_aircraft::check_case::compare::{Recorded, compare};

fn recorded(folder: &Path, id: &str) -> Vec<Recorded> {
    let mut files: Vec<_> = std::fs::read_dir(folder.join("trajectories"))
        .expect("a folder `trajectories`")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.to_string_lossy().contains(&format!("Atmos_{id}_sim_")))
        .collect();
    files.sort();
    files
        .iter()
        .map(|path| {
            let mut text = String::new();
            let file = std::fs::File::open(path).expect("a readable file");
            flate2::read::GzDecoder::new(file).read_to_string(&mut text).expect("compressed text");
            let name = path.to_string_lossy();
            let name = name.rsplit("sim_").next().unwrap_or_default().trim_end_matches(".csv.gz");
            Recorded::parse(name, &text).expect("a trajectory")
        })
        .collect()
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().expect("the folder of `cases.json`");
    let folder = Path::new(&folder);
    let wanted: Vec<String> = arguments.collect();
    let cases = CheckCases::read(&folder.join("cases.json")).expect("definitions");
    println!(
        "| case | quantity | our largest difference | closest simulator | between simulators | last digit | agrees |"
    );
    println!("|---|---|---|---|---|---|---|");
    for id in cases.ids().into_iter().filter(|id| wanted.is_empty() || wanted.contains(id)) {
        let flight = match cases.case(&id).and_then(|case| case.fly()) {
            Ok(flight) => flight,
            Err(error) => {
                println!("{error}");
                continue;
            }
        };
        if let Some(save) = std::env::var_os("SAVE") {
            std::fs::write(Path::new(&save).join(format!("{id}.csv")), flight.to_csv()).expect("a writable folder");
        }
        for c in compare(&flight, &recorded(folder, &id)) {
            println!(
                "| {id} | {} | {:.3e} | {:.3e} | {:.3e} | {:.0e} | {} |",
                c.heading,
                c.largest(),
                c.closest(),
                c.spread,
                c.resolution,
                if c.agrees() {
                    "yes".to_owned()
                } else {
                    format!("no: {:.2} {:?}", c.largest() / c.mark(), c.differences)
                }
            );
        }
    }
}
