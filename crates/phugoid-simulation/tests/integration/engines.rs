//! Engines, fuel and linkages of model files: against hand computations and against JSBSim's propellers.

use std::path::Path;

use phugoid_aircraft::jsbsim::{Aircraft as Jsbsim, Evaluator, FlightCondition};
use phugoid_flight_data::record::Record;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::trim::{TrimCondition, TrimError, trim};
use phugoid_identification::aircraft::ModelAircraft;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::Scenario;

use crate::known_base::package;

const JET: &str = r#"
name = "jet"
axes = ["longitudinal"]
[aircraft]
mass = "8000 kg"
iyy = "90000 kg*m^2"
wing_area = "30 m^2"
mean_chord = "2.4 m"
cg = 0.25
thrust = 0
air_density = "standard_atmosphere"
[coefficients]
CL = ["1", "alpha"]
CD = ["1", "alpha^2"]
Cm = ["1", "alpha", "q_hat", "elevator"]
[parameters]
CL_0 = { start = 0.2, prior_std = 0.3 }
CL_alpha = { start = 5, prior_std = 2 }
CD_0 = { start = 0.03, prior_std = 0.02 }
CD_alpha2 = { start = 1.2, prior_std = 2 }
Cm_0 = { start = 0.05, prior_std = 0.1 }
Cm_alpha = { start = -0.9, prior_std = 1 }
Cm_q = { start = -25, prior_std = 15 }
Cm_elevator = { start = -1.4, prior_std = 1 }
"#;

const TABLE: &str = r#"
[simulation.thrust]
throttle = [0, 0.5, 1]
mach = [0, 0.8]
altitude = ["0 m", "10 km"]
values = [
    [["400 N", "200 N"], ["-400 N", "-200 N"]],
    [["9 kN", "4 kN"], ["7 kN", "3 kN"]],
    [["24 kN", "11 kN"], ["18 kN", "9 kN"]],
]
"#;

fn model(text: &str) -> Result<ModelAircraft, String> {
    let file = ModelFile::parse("mine.toml", text).map_err(|e| e.to_string())?;
    ModelAircraft::new(&file).map_err(|e| e.to_string())
}

/// A flight of an aircraft of this text.
fn flown(name: &str, text: &str, rest: &str) -> Flight {
    let folder = std::env::temp_dir().join(format!("phugoid-engines-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("mine.toml"), text).unwrap();
    let scenario = format!("name = \"engines\"\n{rest}\n");
    std::fs::write(folder.join("scenario.toml"), scenario).unwrap();
    let flight = fly(&Scenario::find(folder.join("scenario.toml").to_str().unwrap()).unwrap()).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    flight
}

fn channel<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    &record.channel(name).unwrap_or_else(|| panic!("no channel {name}")).values
}

/// The throttle of a trim is the one at which the table, interpolated by hand, has the thrust that drag and weight ask for.
#[test]
fn a_table_of_thrust_trims_as_interpolated_by_hand() {
    let jet = model(&format!("{JET}{TABLE}")).unwrap();
    let (speed, altitude) = (160.0, 5000.0);
    let found = trim(&jet, &TrimCondition::steady(&jet, speed, altitude, 0.0, 0.0)).unwrap();
    let mach = speed / Atmosphere::Standard.at(altitude).speed_of_sound;
    // Half way up, and mach/0.8 of the way along.
    let of = |low: [f64; 2], high: [f64; 2]| {
        let [low, high] = [low, high].map(|[sea, up]| 0.5 * (sea + up));
        low + mach / 0.8 * (high - low)
    };
    let (idle, half, full) =
        (of([400.0, 200.0], [-400.0, -200.0]), of([9e3, 4e3], [7e3, 3e3]), of([24e3, 11e3], [18e3, 9e3]));
    let thrust = if found.throttle < 0.5 {
        idle + found.throttle / 0.5 * (half - idle)
    } else {
        half + (found.throttle - 0.5) / 0.5 * (full - half)
    };
    assert!((found.thrust_n - thrust).abs() < 1e-6, "{} {thrust}", found.thrust_n);
    let air = Atmosphere::Standard.at(altitude);
    let qs = 0.5 * air.density * speed * speed * 30.0;
    let drag = (0.03 + 1.2 * found.alpha_rad.powi(2)) * qs;
    assert!((thrust * found.alpha_rad.cos() - drag).abs() < 1e-4, "{thrust} {drag}");
    // The speed changes the thrust: with a falling thrust the linear model has more drag by the speed than without a table.
    let linear = |jet: &ModelAircraft| {
        let found = trim(jet, &TrimCondition::steady(jet, speed, altitude, 0.0, 0.0)).unwrap();
        let model = linearize(jet, &found.state(), &found.controls(), &Disturbance::default());
        (model.a[0][0], model.a[0][12], found)
    };
    let (table, power, found) = linear(&jet);
    let (constant, ..) = linear(&model(&format!("{JET}[simulation]\nlargest_thrust = \"20 kN\"\n")).unwrap());
    let slope = if found.throttle < 0.5 { 2.0 * (half - idle) } else { 2.0 * (full - half) };
    assert!((power - 0.01 * slope * found.alpha_rad.cos() / 8000.0).abs() < 1e-9, "{power}");
    let by_mach = |ends: [[f64; 2]; 2]| (ends[1][0] + ends[1][1] - ends[0][0] - ends[0][1]) / 2.0 / 0.8;
    let [low, high] = if found.throttle < 0.5 {
        [by_mach([[400.0, 200.0], [-400.0, -200.0]]), by_mach([[9e3, 4e3], [7e3, 3e3]])]
    } else {
        [by_mach([[9e3, 4e3], [7e3, 3e3]]), by_mach([[24e3, 11e3], [18e3, 9e3]])]
    };
    let share = (found.throttle % 0.5) / 0.5;
    let expected = (low + share * (high - low)) / air.speed_of_sound * found.alpha_rad.cos() / 8000.0;
    assert!((table - constant - expected).abs() < 1e-9, "{table} {constant} {expected}");
}

#[test]
fn beyond_the_table_no_trim_is_claimed() {
    let jet = model(&format!("{JET}{TABLE}")).unwrap();
    let refused =
        |speed: f64, altitude: f64| trim(&jet, &TrimCondition::steady(&jet, speed, altitude, 0.0, 0.0)).unwrap_err();
    let error = refused(160.0, 10_500.0);
    assert!(matches!(error, TrimError::OutsideTables { .. }), "{error}");
    assert!(error.to_string().contains("altitude in m 10500") && error.to_string().contains("from 0 to 10000"));
    assert!(refused(290.0, 5000.0).to_string().contains("Mach number 0.9"));
    // More than it has is refused as before.
    assert!(matches!(refused(255.0, 2000.0), TrimError::NotEnoughThrust { .. }));
}

/// A flight of the table keeps its trim, and loses no thrust to the code that records it.
#[test]
fn a_scenario_flies_on_a_table_of_thrust() {
    let rest = "duration = \"5 s\"\nsample_rate = \"50 Hz\"\nseed = 1\n[aircraft]\nfile = \"mine.toml\"\n\
                [condition]\naltitude = \"5 km\"\nspeed = \"160 m/s\"\n";
    let flight = flown("table", &format!("{JET}{TABLE}"), rest);
    let thrust = channel(&flight.truth, "thrust");
    assert!(thrust.iter().all(|t| (t - flight.trim.thrust_n).abs() < 1e-3));
    assert!(channel(&flight.truth, "q").iter().all(|q| q.abs() < 1e-9));
    assert!(flight.truth.channel("mass").is_none() && flight.out_of_fuel_s.is_none());
}

/// Delay and play of the elevator: the surface begins to move later, and stays behind by half of the play.
#[test]
fn delay_and_play_are_flown() {
    let rest = "duration = \"3 s\"\nsample_rate = \"100 Hz\"\nseed = 1\n[aircraft]\nfile = \"mine.toml\"\nactuators = true\n\
                [condition]\naltitude = \"5 km\"\nspeed = \"160 m/s\"\n\
                [[manoeuvre]]\ntype = \"doublet\"\nsurface = \"elevator\"\nstart = \"0.5 s\"\nwidth = \"1 s\"\namplitude = \"2 deg\"\n";
    let surface = |linkage: &str, rest: &str| {
        let text =
            format!("{JET}{TABLE}[simulation.elevator]\nlag = \"0.05 s\"\nrate_limit = \"1000 deg/s\"\n{linkage}");
        let flight = flown("linkage", &text, rest);
        let trim = flight.trim.elevator_rad;
        channel(&flight.truth, "elevator").iter().map(|at| (at - trim).to_degrees()).collect::<Vec<f64>>()
    };
    let (whole, late) = (surface("", rest), surface("delay = \"0.1 s\"", rest));
    let loose = surface("play = \"0.4 deg\"", rest);
    for k in 0..whole.len() - 10 {
        // 0.1 s are ten samples.
        assert!((late[k + 10] - whole[k]).abs() < 1e-9, "{k} {} {}", late[k + 10], whole[k]);
    }
    // A first-order lag to 2 deg, of which the play takes 0.2 deg; before, the surface waits.
    let sign = whole[145].signum();
    assert!(
        (whole[145].abs() - 2.0).abs() < 1e-6 && (sign * loose[145] - 1.8).abs() < 1e-6,
        "{} {}",
        whole[145],
        loose[145]
    );
    assert!((sign * loose[245] + 1.8).abs() < 1e-6, "{}", loose[245]);
    for k in 50..60 {
        let actuator = 2.0 * (1.0 - (-(k as f64 * 0.01 - 0.5) / 0.05).exp());
        assert!((sign * loose[k] - (actuator - 0.2).max(0.0)).abs() < 2e-3, "{k} {} {actuator}", loose[k]);
    }
    // The same as a failure of the scenario, from the beginning.
    let failed = |kind: &str| {
        let failure = format!("{rest}[[failure]]\nsurface = \"elevator\"\nat = \"0 s\"\n{kind}\n");
        surface("", &failure)
    };
    assert_eq!(failed("kind = \"delay\"\ndelay = \"0.1 s\""), late);
    assert_eq!(failed("kind = \"play\"\nplay = \"0.4 deg\""), loose);
}

/// Fuel: what is burnt, what it does to mass, centre of gravity and inertia, and what happens without it.
#[test]
fn fuel_is_burnt() {
    let fuel =
        "[simulation.fuel]\nmass = \"800 kg\"\nflow_by_thrust = \"2e-3 kg/N/s\"\ncg = 0.5\niyy = \"2000 kg*m^2\"\n";
    let rest = "duration = \"100 s\"\nsample_rate = \"20 Hz\"\nseed = 1\n[aircraft]\nfile = \"mine.toml\"\nthrust = \"constant\"\n\
                [condition]\naltitude = \"5 km\"\nspeed = \"160 m/s\"\n";
    let text = format!("{JET}[simulation]\nlargest_thrust = \"20 kN\"\n{fuel}");
    let flight = flown("fuel", &text, rest);
    let (mass, flow) = (channel(&flight.truth, "mass"), 2e-3 * flight.trim.thrust_n);
    let empty = 800.0 / flow;
    assert!(empty > 20.0 && empty < 90.0, "{empty}");
    for (time, mass) in flight.truth.time.iter().zip(mass) {
        let expected = 8000.0 - (flow * time).min(800.0);
        assert!((mass - expected).abs() < 0.1 * flow, "{time} {mass} {expected}");
    }
    let out = flight.out_of_fuel_s.unwrap();
    assert!((out - empty).abs() < 0.11, "{out} {empty}");
    assert_eq!(channel(&flight.measured, "mass"), mass);
    // At the trim nothing is burnt; half of it later the centre of gravity is ahead by b d/(m - b).
    let jet = model(&text).unwrap();
    let burnt = jet.after_burning(400.0).unwrap();
    let d = 0.25 * 2.4;
    let shift = 400.0 * d / 7600.0;
    assert!((burnt.shift + shift / 2.4).abs() < 1e-12 && (burnt.mass.mass() - 7600.0).abs() < 1e-9);
    let iyy = 90_000.0 - 1000.0 - 400.0 * d * d - 7600.0 * shift * shift;
    assert!((burnt.mass.pitch_inertia() - iyy).abs() < 1e-6, "{} {iyy}", burnt.mass.pitch_inertia());
    // The forward centre of gravity lets the nose fall: the elevator no longer holds it.
    let alpha = channel(&flight.truth, "alpha");
    let k = (0.9 * empty * 20.0) as usize;
    assert!(alpha[k] < alpha[0] - 1e-3, "{} {}", alpha[k], alpha[0]);
}

/// The propeller of JSBSim's c182, once there with its piston engine, once in a model file with the power that the piston engine
/// gives: thrust and torque are the same, with a governor and without.
#[test]
fn a_propeller_of_jsbsim_is_the_same_in_a_model_file() {
    let Some(package) = package() else { return };
    let text = std::fs::read_to_string(package.join("engine/prop_81in2v.xml")).unwrap();
    let [thrust, power] = ["C_THRUST", "C_POWER"].map(|name| Table::read(&text, name));
    // The coefficients of the model file have one list of advance ratios and end at the coarsest pitch.
    let mut advance: Vec<f64> = thrust.rows.iter().chain(&power.rows).copied().collect();
    advance.sort_by(f64::total_cmp);
    advance.dedup();
    let pitch = [17.0, 21.0, 26.0, 31.8];
    let rows = |table: &Table| {
        let row = |j: &f64| format!("{:?}", pitch.map(|pitch| table.at(*j, pitch)));
        advance.iter().map(row).collect::<Vec<_>>().join(",\n")
    };
    let aircraft = Jsbsim::open(package.join("aircraft/c182")).unwrap();
    let mut evaluator = Evaluator::new(&aircraft);
    evaluator.set("fcs/advance-pos-norm", 1.0);
    let mut governed = 0;
    for (altitude, speed, throttle) in [
        (0.0, 30.0, 0.3),
        (0.0, 60.0, 1.0),
        (1500.0, 62.0, 0.7),
        (3000.0, 70.0, 0.9),
        (3000.0, 20.0, 1.0),
        (500.0, 45.0, 0.4),
    ] {
        let air = Atmosphere::Standard.at(altitude);
        evaluator.set("fcs/throttle-pos-norm", throttle);
        // Leaned as the air thins: at the lever of the sea the charge would be too rich to burn at 3000 m.
        evaluator.set("fcs/mixture-pos-norm", air.pressure / 101_325.0);
        evaluator.set_flight(&FlightCondition::axial(speed, altitude, &air));
        let expected = evaluator.propulsive_force_moment();
        let rpm = evaluator.get("propulsion/engine/propeller-rpm").unwrap();
        let torque = -expected.moment_n_m[0];
        let watts = torque * std::f64::consts::TAU * rpm / 60.0;
        let propeller = format!(
            "[simulation.propeller]\ndiameter = \"81 in\"\nmost_speed = \"2400 rpm\"\nrotation = \"right\"\n\
             power = \"{watts:?} W\"\nadvance_ratio = {advance:?}\npitch = {:?}\nthrust_coefficient = [{}]\n\
             power_coefficient = [{}]\n",
            pitch.map(|pitch| format!("{pitch} deg")),
            rows(&thrust),
            rows(&power)
        );
        let four_seater = include_str!("../../../../scenarios/propeller-model.toml");
        let (before, _) = four_seater.split_once("[simulation.propeller]").unwrap();
        let ours = model(&format!("{before}{propeller}")).unwrap();
        let found = ours.propulsion(100.0, altitude, speed / air.speed_of_sound);
        let [thrust_off, torque_off] =
            [(found.force[0], expected.force_n[0]), (-found.moment[0], torque)].map(|(a, b)| a / b - 1.0);
        println!(
            "{altitude} m, {speed} m/s, throttle {throttle}: {rpm:.1} rpm, {watts:.0} W, thrust {:.1} N ({thrust_off:.1e}), \
             torque {torque:.1} N m ({torque_off:.1e})",
            expected.force_n[0]
        );
        assert!(thrust_off.abs() < 1e-6 && torque_off.abs() < 1e-6, "{thrust_off} {torque_off}");
        governed += usize::from((rpm - 2400.0).abs() < 1e-6);
    }
    assert!(governed > 0 && governed < 6, "both with and without a governor: {governed}");
}

/// A table of JSBSim's files over advance ratio and pitch.
struct Table {
    rows: Vec<f64>,
    columns: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Table {
    fn read(text: &str, name: &str) -> Self {
        let (_, rest) = text.split_once(&format!("<table name=\"{name}\"")).unwrap();
        let (_, rest) = rest.split_once("<tableData>").unwrap();
        let (data, _) = rest.split_once("</tableData>").unwrap();
        let mut lines = data
            .lines()
            .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect::<Vec<f64>>())
            .filter(|line| !line.is_empty());
        let columns = lines.next().unwrap();
        let (rows, values) = lines.map(|line| (line[0], line[1..].to_vec())).unzip();
        Self { rows, columns, values }
    }

    fn at(&self, row: f64, column: f64) -> f64 {
        let between = |keys: &[f64], value: f64| {
            let value = value.clamp(keys[0], *keys.last().unwrap());
            let k = keys.partition_point(|key| *key <= value).clamp(1, keys.len() - 1);
            (k, (value - keys[k - 1]) / (keys[k] - keys[k - 1]))
        };
        let ((i, a), (j, b)) = (between(&self.rows, row), between(&self.columns, column));
        let along = |i: usize| self.values[i][j - 1] + b * (self.values[i][j] - self.values[i][j - 1]);
        along(i - 1) + a * (along(i) - along(i - 1))
    }
}

/// Torque, direction of rotation and slipstream of the example, by hand.
#[test]
fn a_propeller_turns_and_blows_as_computed_by_hand() {
    let text = include_str!("../../../../scenarios/propeller-model.toml");
    let right = model(text).unwrap();
    let left = model(&text.replace("rotation = \"right\"", "rotation = \"left\"")).unwrap();
    let still = {
        let (before, rest) = text.split_once("[simulation.propeller.slipstream]").unwrap();
        let (_, fuel) = rest.split_once("[simulation.fuel]").unwrap();
        model(&format!("{before}[simulation.fuel]{fuel}")).unwrap()
    };
    let condition = TrimCondition::steady(&right, 55.0, 1000.0, 0.0, 0.0);
    let found = trim(&right, &condition).unwrap();
    let air = Atmosphere::Standard.at(1000.0);
    let mach = 55.0 / air.speed_of_sound;
    let work = right.propulsion(found.power_percent, 1000.0, mach);
    // The power that the table has at 1000 m, and the speed at which the propeller takes it: CP(J) = P/(rho n^3 D^5).
    let hp = 550.0 * 0.3048 * 4.448_221_615_260_5;
    let watts = 0.01 * found.power_percent * (205.0 - (205.0 - 174.0) / 1.5) * hp;
    let turns = watts / (work.moment[0].abs() * std::f64::consts::TAU);
    let diameter: f64 = 84.0 * 0.0254;
    let j = 55.0 / (turns * diameter);
    let k = (j / 0.2) as usize;
    let of = |table: [f64; 7]| table[k] + (j / 0.2 - k as f64) * (table[k + 1] - table[k]);
    let ct = of([0.105, 0.100, 0.085, 0.063, 0.034, 0.0, -0.04]);
    let cp = of([0.060, 0.060, 0.056, 0.047, 0.030, 0.008, -0.02]);
    assert!((watts / (air.density * turns.powi(3) * diameter.powi(5)) / cp - 1.0).abs() < 1e-9, "J {j}");
    assert!((work.force[0] / (ct * air.density * turns * turns * diameter.powi(4)) - 1.0).abs() < 1e-9);
    // Turning to the right it rolls the aircraft to the left, and the aileron that rolls to the right (negative) holds it.
    assert!(work.moment[0] < 0.0 && found.aileron_rad < 0.0);
    let other = left.propulsion(found.power_percent, 1000.0, mach);
    assert_eq!((other.force, other.moment[0]), (work.force, -work.moment[0]));
    let mirrored = trim(&left, &condition).unwrap();
    assert!(
        (mirrored.aileron_rad + found.aileron_rad).abs() < 1e-9
            && (mirrored.rudder_rad + found.rudder_rad).abs() < 1e-9
    );
    // The elevator has 1 + 0.6 T/(A q) of its effect.
    let pressure = 0.5 * air.density * 55.0 * 55.0;
    let rise = work.force[0] / (std::f64::consts::FRAC_PI_4 * diameter * diameter * pressure);
    let pitch = |aircraft: &ModelAircraft, elevator: f64| {
        let controls = Controls { elevator, ..found.controls() };
        motion(aircraft, &found.state(), &controls, &Disturbance::default()).coefficients.cm
    };
    let effect = |aircraft: &ModelAircraft| (pitch(aircraft, 0.02) - pitch(aircraft, 0.0)) / 0.02;
    assert!((effect(&still) + 0.923).abs() < 1e-9, "{}", effect(&still));
    assert!((effect(&right) / effect(&still) - 1.0 - 0.6 * rise).abs() < 1e-9, "{rise}");
    assert!(rise > 0.1 && rise < 1.0, "{rise}");
    // The derivatives of the linear model are those of the motion, by the speed among others.
    let model = linearize(&right, &found.state(), &found.controls(), &Disturbance::default());
    let step = 1e-4;
    let rate = |speed: f64| {
        let state = State { speed: 55.0 + speed, ..found.state() };
        motion(&right, &state, &found.controls(), &Disturbance::default()).rates.speed
    };
    let slope = (rate(step) - rate(-step)) / (2.0 * step);
    assert!((model.a[0][0] - slope).abs() < 1e-6, "{} {slope}", model.a[0][0]);
}

/// The example flies from end to end, and an engine that falls behind does not lie about its fuel.
#[test]
fn the_example_with_a_propeller_flies() {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/propeller.toml");
    let flight = fly(&Scenario::find(scenario.to_str().unwrap()).unwrap()).unwrap();
    let mass = channel(&flight.truth, "mass");
    let (first, last) = (mass[0], mass[mass.len() - 1]);
    let hp = 550.0 * 0.3048 * 4.448_221_615_260_5;
    let watts = 0.01 * flight.trim.power_percent * (205.0 - (205.0 - 174.0) / 1.5) * hp;
    let flow = 0.45 * 0.453_592_37 / hp / 3600.0 * watts;
    // The altitude changes by some metres, and the power with it.
    assert!(((first - last) / (30.0 * flow) - 1.0).abs() < 0.01, "{} {}", first - last, 30.0 * flow);
    assert!(channel(&flight.truth, "phi").iter().all(|phi| phi.abs() < 0.6));
}

#[test]
fn engines_that_cannot_be_are_refused_with_their_place() {
    let refused = |simulation: &str| model(&format!("{JET}{simulation}")).unwrap_err();
    let table = |from: &str, to: &str| {
        assert!(TABLE.contains(from), "{from}");
        refused(&TABLE.replace(from, to))
    };
    let propeller = |from: &str, to: &str| {
        let text = include_str!("../../../../scenarios/propeller-model.toml");
        assert!(text.contains(from), "{from}");
        model(&text.replace(from, to)).unwrap_err()
    };
    for (message, expected) in [
        (table("[0, 0.8]", "[0.8, 0]"), "the axis `mach` does not increase: 0.8 is followed by 0"),
        (
            table("[0, 0.5, 1]", "[0, 0.5]"),
            "`values` has a list of 3 where it needs a list of 2, one for each of `throttle`",
        ),
        (table("[0, 0.5, 1]", "[0, 0.5, 2]"), "it has to go from 0 (idle) to 1 (full)"),
        (table("\"24 kN\"", "\"24 kW\""), "not a unit of a force"),
        (table("\"24 kN\"", "nan"), "not finite"),
        (table("\"24 kN\"", "\"300 N\""), "not more than idle"),
        (table("mach =", "match ="), "unknown key `match` in [simulation.thrust]: did you mean `mach`?"),
        (table("values =", "speed = [0, 1]\nvalues ="), "`mach` and `speed` say the same"),
        (table("[[\"400 N\"", "[3, [\"400 N\""), "needs a list of 2"),
        (refused("[simulation]\nthrust = { values = 3 }\n"), "one or more axes"),
        (refused("[simulation]\nthrust = { mach = [0, 1] }\n"), "key `values` is missing"),
        (refused("[simulation]\nthrust = \"-3 N\"\n"), "expected more than zero"),
        (refused("[simulation]\nthrust = 3\nlargest_thrust = 4\n"), "both say what makes the thrust"),
        (refused("[simulation]\nelevator = { play = \"-1 deg\" }\n"), "expected zero or more"),
        (refused("[simulation]\nelevator = { delay = \"1 deg\" }\n"), "not a unit of a time"),
        (refused("[simulation]\nelevator = { deley = 1 }\n"), "did you mean `delay`?"),
        (refused("[simulation]\nelevator = { delay = 20 }\n"), "`delay` is 20 s: expected 1 s at most"),
        (refused("[simulation.fuel]\nmass = \"-5 kg\"\n"), "expected more than zero"),
        (refused("[simulation.fuel]\nmass = \"9 t\"\nflow_by_thrust = 1e-5\n"), "it has to be less"),
        (refused("[simulation.fuel]\nmass = 5\n"), "flow_by_power with a propeller"),
        (refused("[simulation.fuel]\nmass = 5\nflow_by_power = 1e-7\n"), "give `flow_by_thrust`"),
        (refused("[simulation.fuel]\nmass = 5\nflow_by_thrust = 1e-5\nizz = 1e9\niyy = 1e9\n"), "that no body has"),
        (propeller("\"84 in\"", "0"), "expected more than zero"),
        (propeller("rotation = \"right\"", "rotation = \"rihgt\""), "did you mean `right`?"),
        (propeller("rotation = \"right\"", ""), "key `rotation` is missing"),
        (propeller("0.8, 1.0, 1.2]", "0.8, 1.0, 1.0]"), "needs two or more numbers that increase"),
        (propeller("0.034, 0.0, -0.04]", "0.034, 0.0]"), "one for each of `advance_ratio`"),
        (propeller("[0.060, 0.060", "[0.0, 0.060"), "nothing holds the propeller"),
        (propeller("Cm_q = 0.6", "Cm_p = 0.6"), "unknown term `Cm_p`"),
        (propeller("Cm_q = 0.6", "Cm_q = 1.6"), "0 to 1"),
        (propeller("\"98 hp\"", "\"0 hp\""), "not more than idle"),
        (propeller("cg = 0.295\n", ""), "give `cg` in [aircraft] too"),
    ] {
        assert!(message.contains(expected), "{message}\n{expected}");
    }
    let with_base = |simulation: &str| {
        let text = ModelFile::text("f16").unwrap();
        ModelFile::parse("mine.toml", &format!("{text}\n[simulation]\n{simulation}\n")).unwrap_err().to_string()
    };
    assert!(with_base("elevator = { limit = \"5 deg\" }").contains("those of the base"));
    assert!(with_base("engine_lag = 2").contains("that of the base"));
}
