//! Aircraft of JSBSim whose own flight control moves the surfaces of a scenario: against flights of JSBSim, and against what a
//! damper of a known gain has to do.

use std::path::{Path, PathBuf};

use phugoid_aircraft::flown::{AircraftFile, FlownError, FlownJsbsim, FlownOptions};
use phugoid_aircraft::jsbsim::Aircraft as Files;
use phugoid_flight_dynamics::aircraft::State;
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_simulation::flight::{Flight, fly, fly_aircraft};
use phugoid_simulation::scenario::Scenario;

use crate::jsbsim::package;

const TRAINER: &str = include_str!("jsbsim/trainer.xml");
/// Elevator of the damper for a pitch rate, s.
const GAIN: f64 = 0.1;

/// The trainer with less damping of its own, and this flight control in place of none.
fn trainer(flight_control: &str) -> String {
    TRAINER.replace("<v>-12</v>", "<v>-2</v>").replace(
        "<flight_control name=\"none\"/>",
        &format!("<flight_control name=\"x\">{flight_control}</flight_control>"),
    )
}

/// Stick and pedals that move the surfaces, the elevator with what `also` gives added to it.
fn channels(also: &str) -> String {
    format!(
        r#"
<property value="0">ap/switch</property>
<channel name="all">
 <aerosurface_scale name="fcs/stick"><input>fcs/elevator-cmd-norm</input><range><min>-0.4</min><max>0.3</max></range></aerosurface_scale>
 {also}
 <aerosurface_scale name="fcs/left"><input>fcs/aileron-cmd-norm</input><range><min>-0.35</min><max>0.35</max></range>
  <output>fcs/left-aileron-pos-rad</output></aerosurface_scale>
 <aerosurface_scale name="fcs/pedals"><input>fcs/rudder-cmd-norm</input><range><min>-0.4</min><max>0.4</max></range>
  <output>fcs/rudder-pos-rad</output></aerosurface_scale>
</channel>"#
    )
}

/// A pitch damper.
fn damper() -> String {
    channels(&format!(
        "<pure_gain name=\"fcs/damper\"><input>velocities/q-rad_sec</input><gain>{GAIN}</gain></pure_gain>
         <summer name=\"fcs/sum\"><input>fcs/stick</input><input>fcs/damper</input><output>fcs/elevator-pos-rad</output></summer>"
    ))
}

/// A folder of a test for itself.
fn folder(test: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("phugoid-closed-{}-{test}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

const PULSE: &str = r#"
[[manoeuvre]]
type = "doublet"
surface = "elevator"
amplitude = "1 deg"
start = "1 s"
width = "0.3 s"
"#;

/// A scenario of an aircraft of this text.
fn scenario(test: &str, aircraft: &str, keys: &str, rest: &str) -> Result<Scenario, String> {
    let folder = folder(test);
    std::fs::write(folder.join("aircraft.xml"), aircraft).unwrap();
    let text = format!(
        r#"
name = "{test}"
sample_rate = "200 Hz"
duration = "6 s"
[aircraft]
file = "aircraft.xml"
largest_thrust = "5 kN"
{keys}
[condition]
speed = "60 m/s"
altitude = "1500 m"
{rest}"#
    );
    let file = folder.join("scenario.toml");
    std::fs::write(&file, text).unwrap();
    let read = Scenario::open(&file).map_err(|error| error.to_string());
    std::fs::remove_dir_all(&folder).unwrap();
    read
}

fn flown(test: &str, aircraft: &str, keys: &str, rest: &str) -> Flight {
    fly(&scenario(test, aircraft, keys, rest).unwrap()).unwrap()
}

fn column<'a>(flight: &'a Flight, name: &str) -> &'a [f64] {
    &flight.truth.channel(name).unwrap().values
}

/// The largest magnitude before the manoeuvre.
fn before(flight: &Flight, name: &str) -> f64 {
    let first = column(flight, name)[0];
    column(flight, name)[..199].iter().fold(0.0, |most, value| most.max((value - first).abs()))
}

fn apart(one: &Flight, other: &Flight, name: &str) -> f64 {
    column(one, name).iter().zip(column(other, name)).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

fn largest(flight: &Flight, name: &str) -> f64 {
    column(flight, name).iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Damping ratio of a free oscillation in samples `step_s` apart, from the least squares of `x[k+m] = a x[k] + b x[k-m] + c`.
fn damping_ratio(samples: &[f64], m: usize, step_s: f64) -> f64 {
    let rows: Vec<[f64; 4]> =
        (m..samples.len() - m).map(|k| [samples[k], samples[k - m], 1.0, samples[k + m]]).collect();
    let mut n = [[0.0; 4]; 3];
    for row in &rows {
        for i in 0..3 {
            for j in 0..4 {
                n[i][j] += row[i] * row[j];
            }
        }
    }
    for i in 0..3 {
        for k in 0..3 {
            if k != i {
                let factor = n[k][i] / n[i][i];
                (0..4).for_each(|j| n[k][j] -= factor * n[i][j]);
            }
        }
    }
    let [a, b] = [n[0][3] / n[0][0], n[1][3] / n[1][1]];
    // z^2 = a z + b with z = exp(lambda m step).
    let decay = -0.5 * (-b).ln() / (m as f64 * step_s);
    let turn = (0.5 * a / (-b).sqrt()).acos() / (m as f64 * step_s);
    decay / decay.hypot(turn)
}

/// With the gain of the damper in the column of the pitch rate, the linear model has the eigenvalues that the flight shows.
#[test]
fn a_damper_damps_as_its_gain_says() {
    let closed = flown("damped", &trainer(&damper()), "flight_control = true", PULSE);
    let open = flown("free", &trainer(&damper()), "", PULSE);
    assert!(closed.control_notes.is_empty(), "{:?}", closed.control_notes);
    for flight in [&closed, &open] {
        for (name, least) in [("q", 1e-12), ("alpha", 1e-12), ("p", 1e-12), ("elevator", 1e-12)] {
            assert!(before(flight, name) < least, "{name}: {:e}", before(flight, name));
        }
    }
    let aircraft = FlownJsbsim::new(Files::from_text(&trainer(&damper())).unwrap(), &FlownOptions::default()).unwrap();
    let (state, controls): (State, _) = (open.trim.state(), open.trim.controls());
    let model = linearize(&aircraft, &state, &controls, &Disturbance::default());
    let theory = |gain: f64| {
        let [alpha, q] = [1, 7].map(|row: usize| [model.a[row][1], model.a[row][7] + gain * model.b[row][1]]);
        let (trace, determinant) = (alpha[0] + q[1], alpha[0] * q[1] - alpha[1] * q[0]);
        -0.5 * trace / determinant.sqrt()
    };
    let mut found = [0.0; 2];
    for (k, (flight, gain)) in [(&open, 0.0), (&closed, GAIN)].into_iter().enumerate() {
        // From the end of the doublet on, until the slow oscillation is all that is left.
        found[k] = damping_ratio(&column(flight, "q")[322..560], 10, 0.005);
        println!("damping ratio {:.4}, by the linear model {:.4}", found[k], theory(gain));
        assert!((found[k] - theory(gain)).abs() < 0.012, "{} {}", found[k], theory(gain));
    }
    assert!(found[1] > 1.6 * found[0], "{found:?}");
}

/// The same gain in the aerodynamics in place of a channel: what is left is half a step of the channels, and goes with it.
#[test]
fn a_damper_flies_as_the_same_in_the_aerodynamics() {
    let feedback = format!(
        "<sum><p>fcs/elevator-pos-rad</p><product><v>{GAIN}</v><p>velocities/q-aero-rad_sec</p></product></sum>"
    );
    let inside = trainer("").replace("<p>fcs/elevator-pos-rad</p>", &feedback);
    let flight = |rate: &str, aircraft: &str, keys: &str| {
        let mut read = scenario(&format!("rate-{rate}"), aircraft, keys, PULSE).unwrap();
        read.sample_rate = format!("{rate} Hz").parse().unwrap();
        fly(&read).unwrap()
    };
    let mut left = [0.0; 3];
    for (left, rate) in left.iter_mut().zip(["20", "200", "400"]) {
        let [channel, aerodynamics] =
            [flight(rate, &trainer(&damper()), "flight_control = true"), flight(rate, &inside, "")];
        *left = apart(&channel, &aerodynamics, "q") / largest(&aerodynamics, "q");
        assert!(apart(&channel, &aerodynamics, "theta") < 0.03 * largest(&aerodynamics, "theta"));
    }
    println!("{left:?}");
    // At 20 Hz the channels run five times in a sample.
    assert!(left[0] < 0.05 && left[1] < 0.02 && left[2] < 0.6 * left[1], "{left:?}");
}

/// Everything that has a state comes to rest before the flight begins, and what does not follow from the stick is taken out.
#[test]
fn a_flight_begins_at_rest_whatever_the_channels_remember() {
    let filters = channels(
        r#"<washout_filter name="fcs/washed"><input>velocities/q-rad_sec</input><c1>0.5</c1></washout_filter>
 <lag_filter name="fcs/height"><input>position/h-sl-ft</input><c1>0.4</c1></lag_filter>
 <pure_gain name="fcs/by-height"><input>fcs/height</input><gain>0.00002</gain></pure_gain>
 <summer name="fcs/sum"><input>fcs/stick</input><input>fcs/washed</input><input>fcs/by-height</input><bias>0.02</bias></summer>
 <actuator name="fcs/drive"><input>fcs/sum</input><lag>20</lag><rate_limit>1.5</rate_limit><output>fcs/elevator-pos-rad</output></actuator>"#,
    );
    for keys in ["flight_control = true", "flight_control = true\nactuators = true"] {
        let flight = flown("rest", &trainer(&filters), keys, PULSE);
        assert!(flight.control_notes.is_empty(), "{:?}", flight.control_notes);
        for name in ["q", "alpha", "elevator"] {
            // The lag goes to its end without ever being there.
            assert!(before(&flight, name) < 3e-8, "{name}: {:e}", before(&flight, name));
        }
        assert!((column(&flight, "elevator")[0] - flight.trim.elevator_rad).abs() < 1e-7);
        assert!(largest(&flight, "q") > 0.02);
    }
    let notes = scenario("rest-notes", &trainer(&filters), "flight_control = true", "").unwrap().notes().unwrap();
    let driven =
        "The channels have a drive of the elevator: in place of a lag of 0.05 s it follows them with one of 0.01 s.";
    assert!(notes.iter().any(|note| note == driven), "{notes:#?}");
}

/// Without feedback a surface goes where the manoeuvre says, through scales with two slopes and a table, to its stop and not on.
#[test]
fn a_command_moves_the_surface_by_its_angle() {
    let shaped = channels(
        r#"<scheduled_gain name="fcs/shaped"><input>fcs/stick</input>
  <table><independentVar>fcs/elevator-cmd-norm</independentVar><tableData>
   -1 1
   0 0.5
   1 1.2
  </tableData></table>
  <output>fcs/elevator-pos-rad</output></scheduled_gain>"#,
    );
    let moves: String = [("elevator", "3 deg"), ("aileron", "2 deg"), ("rudder", "-4 deg")]
        .map(|(surface, angle)| PULSE.replace("elevator", surface).replace("1 deg", angle))
        .concat();
    let [closed, open] = ["flight_control = true", ""].map(|keys| flown("angles", &trainer(&shaped), keys, &moves));
    for (name, most) in [("elevator", 1e-4), ("aileron", 1e-12), ("rudder", 1e-12)] {
        assert!(apart(&closed, &open, name) < most, "{name}: {:e}", apart(&closed, &open, name));
    }
    let beyond = PULSE.replace("1 deg", "30 deg").replace("0.3 s", "0.02 s");
    let stopped = flown("stop", &trainer(&shaped), "flight_control = true", &beyond);
    let (low, high) =
        column(&stopped, "elevator").iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    assert!((low + 0.4).abs() < 2e-5 && (high - 0.36).abs() < 2e-5, "{low} {high}");
}

/// A stick that asks for a pitch rate, which an integrator keeps: a command is the share of the travel, and nothing moves before it.
#[test]
fn a_stick_that_asks_for_a_rate_is_moved_by_the_share_of_the_travel() {
    let rate_command = channels(
        r#"<pure_gain name="fcs/asked"><input>fcs/elevator-cmd-norm</input><gain>-0.5</gain></pure_gain>
 <summer name="fcs/off"><input>velocities/q-rad_sec</input><input>-fcs/asked</input></summer>
 <pid name="fcs/control"><input>fcs/off</input><kp>0.5</kp><ki>1.0</ki></pid>
 <aerosurface_scale name="fcs/scaled"><input>fcs/control</input><domain><min>-1</min><max>1</max></domain>
  <range><min>-1</min><max>1</max></range><output>fcs/elevator-pos-rad</output></aerosurface_scale>"#,
    );
    let step = PULSE.replace("0.3 s", "3 s").replace("1 deg", "-5.72957795 deg");
    let flight = flown("rate", &trainer(&rate_command), "flight_control = true", &step);
    assert_eq!(
        flight.control_notes,
        ["The elevator has no angle of rest for each position of the stick: a command is the share of its travel."]
    );
    assert!(before(&flight, "q") < 1e-12 && before(&flight, "elevator") < 1e-12);
    // 0.1 rad up of 1 rad is a tenth of the stick, and of 0.5 rad/s.
    let q = column(&flight, "q");
    assert!((q[600] - 0.05).abs() < 0.01, "{}", q[600]);
}

#[test]
fn failures_and_properties_of_the_channels_reach_the_flight() {
    let jam = "[[failure]]\nsurface = \"elevator\"\nat = \"1.1 s\"\nkind = \"jam\"\n";
    for keys in ["flight_control = true", "flight_control = true\nactuators = true"] {
        let flight = flown("jam", &trainer(&damper()), keys, &format!("{PULSE}{jam}"));
        let elevator = column(&flight, "elevator");
        let after = &elevator[222..];
        assert!(after.iter().all(|angle| (angle - after[0]).abs() < 1e-3), "{keys}");
        assert!((after[after.len() - 1] - after[200]).abs() < 1e-9 && (after[0] - elevator[0]).abs() > 1e-3);
    }
    // A switch in the files, which a scenario turns when the flight begins.
    let switched = channels(
        r#"<switch name="fcs/held"><default value="0"/><test value="fcs/up"> ap/switch == 1 </test></switch>
 <pure_gain name="fcs/up"><input>attitude/theta-rad</input><gain>0</gain></pure_gain>
 <summer name="fcs/sum"><input>fcs/stick</input><input>fcs/held</input><input>-ap/switch</input><output>fcs/sum-off</output></summer>
 <pure_gain name="fcs/elevator"><input>fcs/stick</input><gain>1</gain></pure_gain>
 <summer name="fcs/end"><input>fcs/elevator</input><input>fcs/by-switch</input><output>fcs/elevator-pos-rad</output></summer>
 <pure_gain name="fcs/by-switch"><input>ap/switch</input><gain>-0.01</gain></pure_gain>"#,
    );
    let on = "properties = { \"ap/switch\" = 1 }";
    let flight = flown("switch", &trainer(&switched), &format!("flight_control = true\n{on}"), "");
    let elevator = column(&flight, "elevator");
    assert!((elevator[10] - flight.trim.elevator_rad + 0.01).abs() < 1e-9, "{}", elevator[10]);
    let refused = scenario("switch-open", &trainer(&switched), on, "").unwrap_err();
    assert!(refused.contains("ap/switch") && refused.contains("flight control does not run"), "{refused}");
    let stick = "flight_control = true\nproperties = { \"fcs/elevator-cmd-norm\" = 1 }";
    let refused = scenario("switch-stick", &trainer(&switched), stick, "").unwrap_err();
    assert!(refused.contains("it follows the commands of the flight"), "{refused}");
    let written = "flight_control = true\nproperties = { \"fcs/stick\" = 1 }";
    let refused = scenario("switch-written", &trainer(&switched), written, "").unwrap_err();
    assert!(refused.contains("a channel writes it"), "{refused}");
}

#[test]
fn what_has_no_flight_control_is_refused_with_its_place() {
    let closed = "flight_control = true";
    let none = scenario("none", TRAINER, closed, "").unwrap_err();
    assert!(
        none.contains("scenario.toml")
            && none.contains("no channel of this one writes")
            && none.ends_with("leave it out"),
        "{none}"
    );
    let unfed = channels(
        r#"<pure_gain name="fcs/by-engine"><input>propulsion/engine[0]/n2</input><gain>0.001</gain></pure_gain>
 <summer name="fcs/sum"><input>fcs/stick</input><input>fcs/by-engine</input><output>fcs/elevator-pos-rad</output></summer>"#,
    );
    let message = scenario("unfed", &trainer(&unfed), closed, "").unwrap_err();
    assert!(
        message.contains("propulsion/engine/n2, which JSBSim computes in flight") && message.contains("line "),
        "{message}"
    );
    let given = "flight_control = true\nproperties = { \"propulsion/engine[0]/n2\" = 0 }";
    scenario("fed", &trainer(&unfed), given, "").unwrap();
    let restless = channels(
        r#"<integrator name="fcs/winding"><input>attitude/theta-rad</input><c1>0.01</c1></integrator>
 <summer name="fcs/sum"><input>fcs/stick</input><input>fcs/winding</input><bias>0.01</bias><output>fcs/elevator-pos-rad</output></summer>"#,
    );
    let message = fly(&scenario("restless", &trainer(&restless), closed, "").unwrap()).unwrap_err().to_string();
    assert!(message.contains("does not come to rest") && message.contains("its elevator still moves"), "{message}");

    let f16 = "name = \"f\"\nsample_rate = \"50 Hz\"\nduration = \"1 s\"\n[aircraft]\ntype = \"f16\"\nflight_control = true\n\
               [condition]\nspeed = \"200 m/s\"\naltitude = \"5000 m\"\n";
    let message = Scenario::parse(f16, "f.toml").unwrap_err().to_string();
    assert!(message.contains("`aircraft.flight_control` has a meaning with `file` alone"), "{message}");
    let model = f16.replace("type = \"f16\"", "file = \"hfb320\"");
    let message = fly(&Scenario::parse(&model, "m.toml").unwrap()).unwrap_err().to_string();
    assert!(message.contains("hfb320") && message.contains("this is a model file: leave it out"), "{message}");
    let read = Scenario::parse(&model, "m.toml").unwrap();
    let other = AircraftFile::Jsbsim(Box::new(
        FlownJsbsim::new(Files::from_text(&trainer(&damper())).unwrap(), &FlownOptions::default()).unwrap(),
    ));
    let message = fly_aircraft(&other, &read, &|_| ()).unwrap_err().to_string();
    assert!(message.contains("`aircraft.flight_control` is for the aircraft that the scenario names"), "{message}");
    let options = FlownOptions { flight_control: true, ..FlownOptions::default() };
    let file = folder("daveml").join("x.dml");
    std::fs::write(&file, "<DAVEfunc/>").unwrap();
    let refused = AircraftFile::open_with(&file, &options);
    std::fs::remove_dir_all(file.parent().unwrap()).unwrap();
    assert!(matches!(&refused, Err(FlownError::NoFlightControl { why, .. }) if why.contains("DAVE-ML")), "{refused:?}");
}

/// The flights of `jsbsim/closed_loop`, which JSBSim flew by `scripts/jsbsim/closed_loop.py` in steps of 0.5 ms: dampers, drives, and
/// an autopilot.
#[test]
fn flights_with_flight_control_are_those_of_jsbsim() {
    let Some(package) = package() else { return };
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/integration/jsbsim/closed_loop");
    for name in ["fokker100", "f15", "X15", "c310"] {
        let text = std::fs::read_to_string(place.join(format!("{name}.toml"))).unwrap();
        let text = text.replace("PACKAGE", &package.display().to_string());
        let flight = fly(&Scenario::parse(&text, name).unwrap()).unwrap();
        assert!(flight.control_notes.is_empty(), "{:?}", flight.control_notes);
        let known = std::fs::read_to_string(place.join(format!("{name}.csv"))).unwrap();
        let mut lines = known.lines();
        let headings: Vec<&str> = lines.next().unwrap().split(',').collect();
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
        for (k, heading) in headings.iter().enumerate().skip(1) {
            let ours = column(&flight, heading);
            let theirs: Vec<f64> = rows.iter().map(|row| row[k]).collect();
            let (low, high) = theirs.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
            let mut most = 0.0_f64;
            for row in &rows {
                most = most.max((row[k] - ours[(row[0] * 500.0).round() as usize]).abs());
            }
            println!("{name} {heading}: {most:.1e} of {:.1e}", high - low);
            assert!(most < 0.01 * (high - low) + 1e-6, "{name} {heading}: {most:e} of {:e}", high - low);
        }
    }
}
