//! Steps of JSBSim itself, recorded by scripts/jsbsim/record.py: its forces and its flight control come out again.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use phugoid_aircraft::jsbsim::{Aircraft, Evaluator};

use super::{RESERVED, package, repository, text_of};

/// What JSBSim had in every property at every step.
struct Recording {
    constants: HashMap<String, f64>,
    columns: HashMap<String, usize>,
    rows: Vec<Vec<f64>>,
}

impl Recording {
    fn read(path: &Path) -> Self {
        let text = text_of(path);
        let mut lines = text.lines();
        let (mut constants, mut columns) = (HashMap::new(), HashMap::new());
        for word in lines.next().unwrap().split(',') {
            let (name, constant) = word.split_once('=').map_or((word, None), |(name, value)| (name, Some(value)));
            let name = name.replace("[0]", "");
            match constant {
                Some(value) => drop(constants.insert(name, value.parse().unwrap())),
                None => drop(columns.insert(name, columns.len())),
            }
        }
        let rows = lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
        Self { constants, columns, rows }
    }

    fn value(&self, name: &str, row: usize) -> Option<f64> {
        match self.columns.get(name) {
            Some(&column) => self.rows[row].get(column).copied(),
            None => self.constants.get(name).copied(),
        }
    }
}

/// Recordings in `target/jsbsim`, or in the folder of `PHUGOID_JSBSIM_RECORDED`.
fn recordings() -> Vec<(String, PathBuf)> {
    let folder = std::env::var_os("PHUGOID_JSBSIM_RECORDED")
        .map_or_else(|| repository().join("target/jsbsim"), PathBuf::from);
    let mut found: Vec<_> = std::fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().strip_suffix(".csv.gz")?.to_owned();
            Some((name, entry.path()))
        })
        .filter(|(name, _)| !RESERVED.contains(&name.as_str()))
        .collect();
    found.sort();
    if found.is_empty() {
        eprintln!("skipped: no recordings in {} (scripts/jsbsim/record.py makes them)", folder.display());
    }
    found
}

/// Whether flight control sees the value of the step before: what JSBSim computes after it in a step.
fn computed_after_control(name: &str) -> bool {
    const AFTER: [&str; 9] =
        ["aero/", "accelerations/", "forces/", "moments/", "propulsion/", "inertia/", "flight-path/", "contact/", "gear/unit"];
    const AFTER_VELOCITIES: [&str; 14] = [
        "vc-", "ve-", "vt", "mach", "vg-", "p-aero", "q-aero", "r-aero", "u-aero", "v-aero", "w-aero", "phidot", "thetadot",
        "psidot",
    ];
    AFTER.iter().any(|start| name.starts_with(start))
        || name.strip_prefix("velocities/").is_some_and(|rest| AFTER_VELOCITIES.iter().any(|start| rest.starts_with(start)))
}

#[test]
fn aerodynamic_forces_are_those_of_jsbsim() {
    let Some(package) = package() else { return };
    for (name, path) in recordings() {
        let Ok(aircraft) = Aircraft::open(package.join("aircraft").join(&name)) else { continue };
        let recording = Recording::read(&path);
        let mut evaluator = Evaluator::new(&aircraft);
        let names: Vec<String> = aircraft.properties().map(str::to_owned).collect();
        let (mut worst, mut largest, mut at) = (0.0_f64, 0.0_f64, 0);
        let (mut worst_moment, mut largest_moment) = (0.0_f64, 0.0_f64);
        for row in 1..recording.rows.len() {
            // The tanks and point masses hold what the centre of gravity was computed from: that of the step before.
            for (index, name) in names.iter().enumerate() {
                let row = if name.ends_with("contents-lbs") { row - 1 } else { row };
                if let Some(value) = recording.value(name, row) {
                    evaluator.set_index(index, value);
                }
            }
            let found = evaluator.aerodynamic_force_moment();
            for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
                let expected = recording.value(&format!("forces/fb{letter}-aero-lbs"), row).unwrap();
                let difference = (found.force_n[axis] / 4.448_221_615_260_5 - expected).abs();
                largest = largest.max(expected.abs());
                if difference > worst {
                    (worst, at) = (difference, row);
                }
            }
            for (axis, letter) in ["l", "m", "n"].iter().enumerate() {
                let expected = recording.value(&format!("moments/{letter}-aero-lbsft"), row).unwrap();
                worst_moment = worst_moment.max((found.moment_n_m[axis] / 4.448_221_615_260_5 / 0.3048 - expected).abs());
                largest_moment = largest_moment.max(expected.abs());
            }
        }
        let share = |worst: f64, largest: f64| if largest == 0.0 { worst } else { worst / largest };
        eprintln!(
            "{name}: {} steps, largest difference of a force {:.1e} of the largest (step {at}), of a moment {:.1e}",
            recording.rows.len(),
            share(worst, largest),
            share(worst_moment, largest_moment),
        );
    }
}

#[test]
fn flight_control_is_that_of_jsbsim_step_by_step() {
    let Some(package) = package() else { return };
    for (name, path) in recordings() {
        let Ok(aircraft) = Aircraft::open(package.join("aircraft").join(&name)) else { continue };
        let recording = Recording::read(&path);
        let mut evaluator = Evaluator::new(&aircraft);
        let names: Vec<String> = aircraft.properties().map(str::to_owned).collect();
        let outputs = aircraft.outputs();
        // What flight control writes is not given, in no unit; nor what follows a command of an engine.
        let surface = |index: usize| names[index].replace("mag-", "").rsplit_once("-pos-").map(|(start, _)| start.to_owned());
        let written: std::collections::HashSet<_> = outputs.iter().filter_map(|&index| surface(index)).collect();
        let is_given = |index: &usize| {
            outputs.binary_search(index).is_err() && surface(*index).is_none_or(|found| !written.contains(&found))
        };
        let given: Vec<usize> = (0..names.len()).filter(is_given).collect();
        let mut differences: HashMap<&str, (f64, usize, usize)> = HashMap::new();
        for row in 0..recording.rows.len() {
            for &index in &given {
                let name = &names[index];
                let row = if computed_after_control(name) { row.saturating_sub(1) } else { row };
                if let Some(value) = recording.value(name, row) {
                    evaluator.set_index(index, value);
                }
            }
            for (name, _) in recording.columns.iter().filter(|(name, _)| name.starts_with("command/")) {
                let value = recording.value(name, row).unwrap();
                evaluator.set(name.trim_start_matches("command/"), value);
            }
            // Flight control has run twice when the initial condition is there.
            for _ in 0..if row == 0 { 2 } else { 1 } {
                evaluator.step_channels(1.0 / 120.0);
            }
            for &index in &outputs {
                let Some(expected) = recording.value(&names[index], row) else { continue };
                let found = evaluator.get_index(index).unwrap();
                let difference = (found - expected).abs() / expected.abs().max(1.0);
                if difference > 1e-9 || difference.is_nan() && !(found.is_nan() && expected.is_nan()) {
                    if std::env::var("SHOW").is_ok_and(|show| show.split(':').any(|part| part == names[index])) && row < 8 {
                        eprintln!("{} {row}: {found} instead of {expected}", names[index]);
                    }
                    let worst = differences.entry(&names[index]).or_insert((0.0, row, row));
                    worst.0 = worst.0.max(difference);
                    worst.2 = row;
                }
            }
        }
        let mut worst: Vec<_> = differences.iter().collect();
        worst.sort_by_key(|(_, (_, row, _))| *row);
        eprintln!(
            "{name}: {} steps, {} components write {} properties, {} differ {}",
            recording.rows.len(),
            aircraft.components(),
            outputs.len(),
            worst.len(),
            worst.iter().take(30).map(|(name, (d, row, last))| format!("{name} {d:.1e} from {row} to {last}")).collect::<Vec<_>>().join(", ")
        );
    }
}
