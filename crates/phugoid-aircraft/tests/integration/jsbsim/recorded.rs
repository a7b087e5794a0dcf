//! Steps of JSBSim itself, recorded by scripts/jsbsim/record.py: its forces and its flight control come out again.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use phugoid_aircraft::jsbsim::{Aircraft, EngineKind, Evaluator, FlightCondition};

use super::{is_reserved, package, repository, text_of};

/// Aircraft with gas, whose mass and pressure are left out.
const BUOYANT: [&str; 3] = ["Submarine_Scout", "ZLT-NT", "weather-balloon"];

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
fn recordings(engines: bool) -> Vec<(String, PathBuf)> {
    let folder =
        std::env::var_os("PHUGOID_JSBSIM_RECORDED").map_or_else(|| repository().join("target/jsbsim"), PathBuf::from);
    let mut found: Vec<_> = std::fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().strip_suffix(".csv.gz")?.to_owned();
            Some((name, entry.path()))
        })
        .filter(|(name, _)| name.ends_with(".engines") == engines && !is_reserved(name.trim_end_matches(".engines")))
        .collect();
    found.sort();
    assert!(
        !found.is_empty() || std::env::var_os("PHUGOID_JSBSIM_RECORDED").is_none(),
        "there is nothing in {}",
        folder.display()
    );
    if found.is_empty() {
        eprintln!("skipped: no recordings in {} (scripts/jsbsim/record.py makes them)", folder.display());
    }
    found
}

/// Where the file of an aircraft is: `parts` is one of ours.
fn place(package: &Path, name: &str) -> PathBuf {
    if name == "parts" {
        return Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/integration/jsbsim/parts.xml");
    }
    package.join("aircraft").join(name)
}

/// Whether flight control sees the value of the step before: what JSBSim computes after it in a step.
fn computed_after_control(name: &str) -> bool {
    const AFTER: [&str; 10] = [
        "buoyant_forces/",
        "aero/",
        "accelerations/",
        "forces/",
        "moments/",
        "propulsion/",
        "inertia/",
        "flight-path/",
        "contact/",
        "gear/unit",
    ];
    const AFTER_VELOCITIES: [&str; 14] = [
        "vc-", "ve-", "vt", "mach", "vg-", "p-aero", "q-aero", "r-aero", "u-aero", "v-aero", "w-aero", "phidot",
        "thetadot", "psidot",
    ];
    AFTER.iter().any(|start| name.starts_with(start))
        || name
            .strip_prefix("velocities/")
            .is_some_and(|rest| AFTER_VELOCITIES.iter().any(|start| rest.starts_with(start)))
}

#[test]
fn mass_and_sizes_are_those_of_jsbsim() {
    let Some(package) = package() else { return };
    for (name, path) in recordings(false) {
        let Ok(aircraft) = Aircraft::open(place(&package, &name)) else { continue };
        let recording = Recording::read(&path);
        let mass = aircraft.mass_properties();
        let mut evaluator = Evaluator::new(&aircraft);
        let of = |name: &str| recording.value(name, 0).unwrap();
        if BUOYANT.contains(&name.as_str()) {
            continue;
        }
        let slug = 14.593_902_937;
        let slug_ft2 = slug * 0.3048 * 0.3048;
        let mut differences = Vec::new();
        let mut compare = |what: &str, found: f64, expected: f64, scale: f64| {
            if (found - expected).abs() > 1e-6 * expected.abs().max(scale) {
                differences.push(format!("{what} {found} instead of {expected}"));
            }
        };
        compare("mass", mass.mass_kg / slug, of("inertia/mass-slugs"), 0.0);
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            compare(letter, mass.centre_of_gravity_m[axis] / 0.0254, of(&format!("inertia/cg-{letter}-in")), 1.0);
        }
        let inertia = mass.inertia_kg_m2;
        // JSBSim names the element of the tensor `ixz`, and the products `ixy` and `iyz`.
        for (what, k, j, sign) in [
            ("ixx", 0, 0, 1.0),
            ("iyy", 1, 1, 1.0),
            ("izz", 2, 2, 1.0),
            ("ixy", 0, 1, -1.0),
            ("ixz", 0, 2, 1.0),
            ("iyz", 1, 2, -1.0),
        ] {
            let expected = of(&format!("inertia/{what}-slugs_ft2"));
            compare(what, sign * inertia[k][j] / slug_ft2, expected, inertia[1][1] / slug_ft2);
        }
        let metrics: Vec<String> =
            aircraft.properties().filter(|name| name.starts_with("metrics/")).map(str::to_owned).collect();
        for metric in metrics {
            if let (Some(found), Some(expected)) = (evaluator.get(&metric), recording.value(&metric, 0)) {
                compare(&metric, found, expected, 1e-6);
            }
        }
        assert!(differences.is_empty(), "{name}: {}", differences.join(", "));
    }
}

#[test]
fn a_flight_condition_sets_what_jsbsim_has() {
    let Some(package) = package() else { return };
    for (name, path) in
        recordings(false).into_iter().filter(|(name, _)| ["c182", "T38", "X15", "B747"].contains(&name.as_str()))
    {
        let aircraft = Aircraft::open(package.join("aircraft").join(&name)).unwrap();
        let recording = Recording::read(&path);
        let mut evaluator = Evaluator::new(&aircraft);
        for row in [50, 300, recording.rows.len() - 1] {
            let of = |name: &str| recording.value(name, row).unwrap();
            let psf = 47.880_258_98;
            evaluator.set_flight(&FlightCondition {
                airspeed_m_s: 0.3048 * of("velocities/vt-fps"),
                alpha_rad: of("aero/alpha-rad"),
                beta_rad: of("aero/beta-rad"),
                alphadot_rad_s: of("aero/alphadot-rad_sec"),
                betadot_rad_s: of("aero/betadot-rad_sec"),
                rates_rad_s: ["p", "q", "r"].map(|axis| of(&format!("velocities/{axis}-aero-rad_sec"))),
                attitude_rad: ["phi", "theta", "psi"].map(|angle| of(&format!("attitude/{angle}-rad"))),
                height_m: 0.3048 * of("position/h-sl-ft"),
                height_above_ground_m: 0.3048 * of("position/h-agl-ft"),
                density_kg_m3: 515.378_818_4 * of("atmosphere/rho-slugs_ft3"),
                pressure_pa: psf * of("atmosphere/P-psf"),
                temperature_k: of("atmosphere/T-R") / 1.8,
                sound_speed_m_s: 0.3048 * of("atmosphere/a-fps"),
            });
            let mut differences = Vec::new();
            for index in 0..aircraft.properties().len() {
                let property = aircraft.properties().nth(index).unwrap().to_owned();
                // The rotation of the earth is in JSBSim's rates in inertial axes.
                let set = ["velocities/", "aero/", "atmosphere/", "attitude/", "position/h-", "flight-path/"];
                let skipped = [
                    "velocities/pi-",
                    "velocities/qi-",
                    "velocities/ri-",
                    "aero/cl-squared",
                    "aero/coefficient",
                    "aero/function",
                ];
                if !set.iter().any(|start| property.starts_with(start))
                    || skipped.iter().any(|start| property.starts_with(start))
                {
                    continue;
                }
                let (Some(expected), Some(found)) = (recording.value(&property, row), evaluator.get_index(index))
                else {
                    continue;
                };
                if (found - expected).abs() > 5e-5 * expected.abs().max(1e-4) {
                    differences.push(format!("{property} {found} instead of {expected}"));
                }
            }
            assert!(differences.is_empty(), "{name} {row}: {}", differences.join(", "));
        }
    }
}

#[test]
fn aerodynamic_forces_are_those_of_jsbsim() {
    let Some(package) = package() else { return };
    for (name, path) in recordings(false) {
        let Ok(aircraft) = Aircraft::open(place(&package, &name)) else { continue };
        let recording = Recording::read(&path);
        let mut evaluator = Evaluator::new(&aircraft);
        evaluator.set_stepwise(true);
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
            // The lift of the step before has to be there.
            if row == 1 {
                continue;
            }
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
                worst_moment =
                    worst_moment.max((found.moment_n_m[axis] / 4.448_221_615_260_5 / 0.3048 - expected).abs());
                largest_moment = largest_moment.max(expected.abs());
            }
        }
        let share = |worst: f64, largest: f64| if largest == 0.0 { worst } else { worst / largest };
        let (force, moment) = (share(worst, largest), share(worst_moment, largest_moment));
        eprintln!(
            "{name}: {} steps, largest difference of a force {force:.1e} of the largest (step {at}), of a moment {moment:.1e}",
            recording.rows.len(),
        );
        assert!(BUOYANT.contains(&name.as_str()) || force.max(moment) < 1e-10, "{name}");
    }
}

#[test]
fn flight_control_is_that_of_jsbsim_step_by_step() {
    let Some(package) = package() else { return };
    let (mut compared, mut equal) = (0, 0);
    for (name, path) in recordings(false) {
        let Ok(aircraft) = Aircraft::open(place(&package, &name)) else { continue };
        let recording = Recording::read(&path);
        let mut evaluator = Evaluator::new(&aircraft);
        let names: Vec<String> = aircraft.properties().map(str::to_owned).collect();
        let outputs = aircraft.outputs();
        // What flight control writes is not given, in no unit; nor what follows a command of an engine.
        let surface =
            |index: usize| names[index].replace("mag-", "").rsplit_once("-pos-").map(|(start, _)| start.to_owned());
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
            if row == 0 {
                evaluator.start_channels(1.0 / 120.0);
                evaluator.start_channels(1.0 / 120.0);
            } else {
                evaluator.step_channels(1.0 / 120.0);
            }
            for &index in &outputs {
                let Some(expected) = recording.value(&names[index], row) else { continue };
                let found = evaluator.get_index(index).unwrap();
                let difference =
                    if found == expected { 0.0 } else { (found - expected).abs() / expected.abs().max(1.0) };
                if difference > 1e-9 || difference.is_nan() && !(found.is_nan() && expected.is_nan()) {
                    let worst = differences.entry(&names[index]).or_insert((0.0, row, row));
                    worst.0 = worst.0.max(difference);
                    worst.2 = row;
                }
            }
        }
        // Settings of JSBSim's own integrator, which the files keep as they are, are not known here.
        differences
            .retain(|name, _| !name.starts_with("simulation/") && !name.starts_with("systems/crash-detect/switch"));
        let mut worst: Vec<_> = differences.iter().collect();
        worst.sort_by_key(|(_, (_, row, _))| *row);
        compared += 1;
        equal += usize::from(worst.is_empty());
        eprintln!(
            "{name}: {} steps, {} components write {} properties, {} differ {}",
            recording.rows.len(),
            aircraft.components(),
            outputs.len(),
            worst.len(),
            worst
                .iter()
                .take(30)
                .map(|(name, (d, row, last))| format!("{name} {d:.1e} from {row} to {last}"))
                .collect::<Vec<_>>()
                .join(", ")
        );
        // What is left: accelerometers, which are left out; gas; what JSBSim had before the first recorded step.
        const DIFFERENT: [&str; 7] = ["F450", "L410", "Submarine_Scout", "ZLT-NT", "ah1s", "f22", "weather-balloon"];
        assert!(worst.is_empty() || DIFFERENT.contains(&name.as_str()), "{name}");
    }
    eprintln!("flight control of {equal} of {compared} aircraft is the same within 1e-9 in every step");
}

#[test]
fn engines_give_the_thrust_of_jsbsim() {
    /// Propellers of fixed pitch, whose thrust at a speed is known.
    const FIXED: [&str; 5] = ["Camel", "J3Cub", "Submarine_Scout", "c172r", "wrightFlyer1903"];
    /// Piston engines that run in the recording: their power is not the same, since JSBSim leans the mixture with height.
    const PISTONS: [&str; 6] = ["Camel", "Submarine_Scout", "c172r", "c172x", "c182", "pa28"];
    let Some(package) = package() else { return };
    for (name, path) in recordings(true) {
        let name = name.trim_end_matches(".engines");
        let Ok(aircraft) = Aircraft::open(package.join("aircraft").join(name)) else { continue };
        let recording = Recording::read(&path);
        let turbines = aircraft.engines().iter().all(|engine| engine.kind == EngineKind::Turbine);
        let (fixed, piston) = (FIXED.contains(&name), PISTONS.contains(&name));
        if aircraft.engines().is_empty() || recording.rows.len() < 50 || !(turbines || fixed || piston) {
            continue;
        }
        let mut evaluator = Evaluator::new(&aircraft);
        let names: Vec<String> = aircraft.properties().map(str::to_owned).collect();
        let (mut worst_set, mut worst_free) = (0.0_f64, 0.0_f64);
        for row in 45..recording.rows.len() {
            for (index, name) in names.iter().enumerate() {
                if let Some(value) = recording.value(name, row) {
                    evaluator.set_index(index, value);
                }
            }
            let expected = recording.value("forces/fbx-prop-lbs", row).unwrap();
            for set in [false, true] {
                for engine in 0..aircraft.engines().len() {
                    let rpm = format!("propulsion/engine[{engine}]/propeller-rpm").replace("[0]", "");
                    evaluator.set_propeller_rpm(engine, recording.value(&rpm, row).filter(|_| set));
                }
                let found = evaluator.propulsive_force_moment().force_n[0] / 4.448_221_615_260_5;
                let worst = if set { &mut worst_set } else { &mut worst_free };
                *worst = worst.max((found - expected).abs());
            }
        }
        let largest = (45..recording.rows.len())
            .map(|row| recording.value("forces/fbx-prop-lbs", row).unwrap().abs())
            .fold(0.0, f64::max);
        eprintln!(
            "{name}: of {largest:.0} lb, {worst_free:.1e} at its throttle, {worst_set:.1e} at its speed ({:?})",
            aircraft.engines()[0].kind
        );
        assert!(!turbines || worst_free < 1e-6 * largest, "{name}");
        // The speed that is recorded is that after the step, the thrust that before.
        assert!(!fixed || worst_set < 0.02 * largest, "{name}");
        assert!(!piston || worst_free < 0.35 * largest, "{name}");
    }
}
