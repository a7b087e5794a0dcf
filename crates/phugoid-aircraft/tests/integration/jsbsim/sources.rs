//! Where the values that aerodynamics and engines read come from: what nothing makes refuses the aircraft, what is left at a value
//! is named, and what is set in vain is refused.

use phugoid_aircraft::flown::{FlownError, FlownJsbsim, FlownOptions};
use phugoid_aircraft::jsbsim::Aircraft;
use phugoid_flight_dynamics::aircraft::Aircraft as _;
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, trim};

const TRAINER: &str = include_str!("trainer.xml");
/// The constant part of the pitching moment, which other terms are put beside.
const PITCH: &str = "<v>0.02</v>";
const FOOT: f64 = 0.3048;
const KNOT: f64 = 1852.0 / 3600.0;

/// The line of the trainer that a text stands in.
fn line_of(part: &str) -> usize {
    TRAINER.lines().position(|line| line.contains(part)).unwrap() + 1
}

/// The trainer with a text in place of another, flown with properties set.
fn flown_with(changes: &[(&str, &str)], properties: &[(&str, f64)]) -> Result<FlownJsbsim, FlownError> {
    let mut text = TRAINER.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    let properties = properties.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    FlownJsbsim::new(Aircraft::from_text(&text)?, &FlownOptions { properties, ..FlownOptions::default() })
}

/// With a term of the pitching moment more.
fn with_term(term: &str) -> Result<FlownJsbsim, FlownError> {
    flown_with(&[(PITCH, &format!("{PITCH}{term}"))], &[])
}

fn level(aircraft: &FlownJsbsim) -> Result<Trim, TrimError> {
    trim(aircraft, &TrimCondition::steady(aircraft, 120.0 * KNOT, 5000.0 * FOOT, 0.0, 0.0))
}

fn elevator_deg(aircraft: &FlownJsbsim) -> f64 {
    level(aircraft).unwrap().elevator_rad.to_degrees()
}

fn noted(aircraft: &FlownJsbsim, part: &str) -> bool {
    aircraft.notes().iter().any(|note| note.contains(part))
}

#[test]
fn a_property_that_nothing_makes_refuses_the_aircraft() {
    for name in
        ["aero/alpha-wing-deg", "my/thing", "fcs/elevater-pos-rad", "propulsion/engine/thrust-lb", "accelerations/nz"]
    {
        let message = with_term(&format!("<product><v>0.2</v><p>{name}</p></product>")).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(&format!("line {}", line_of(PITCH))), "{message}");
    }
    // A channel that feeds the aerodynamics may not read such a one either.
    let channel = "<flight_control name=\"f\"><channel name=\"c\"><summer name=\"aero/k\"><input>aero/alpa-rad</input></summer></channel>\
                   </flight_control>";
    let changes = [("<flight_control name=\"none\"/>", channel), (PITCH, "<v>0.02</v><p>aero/k</p>")];
    let message = flown_with(&changes, &[]).unwrap_err().to_string();
    assert!(message.contains("aero/alpa-rad"), "{message}");
    // What is declared is made.
    let declared = "<flight_control name=\"f\"><property value=\"3\">my/thing</property></flight_control>";
    let changes = [("<flight_control name=\"none\"/>", declared), (PITCH, "<v>0.02</v><p>my/thing</p>")];
    assert!(flown_with(&changes, &[]).is_ok());
}

/// A constant of the aircraft or of the air is there as in JSBSim, and makes the moment that it makes there.
#[test]
fn what_is_known_of_the_state_is_computed() {
    let plain = elevator_deg(&flown_with(&[], &[]).unwrap());
    // The slope of the moment by the elevator is -1.2 for each rad; the lift of the elevator turns that a little.
    let moved = |term: &str| elevator_deg(&with_term(term).unwrap()) - plain;
    let constant = moved("<v>0.01</v>");
    assert!(constant > 0.3, "{constant}");
    for (name, value) in [
        ("inertia/ixx-slugs_ft2", 900.0),
        ("inertia/izz-slugs_ft2", 2000.0),
        ("inertia/mass-slugs", 2400.0 / 32.174_049),
        // From JSBSim 1.3.3.
        ("atmosphere/P-sl-psf", 2116.228),
        ("atmosphere/T-sl-R", 518.67),
        ("atmosphere/a-sl-fps", 1116.45),
        ("accelerations/gravity-ft_sec2", 9.806_65 / FOOT),
        ("velocities/ned-velocity-mag-fps", 120.0 * KNOT / FOOT),
    ] {
        let term = format!("<product><v>{}</v><p>{name}</p></product>", 0.01 / value);
        let difference = moved(&term) - constant;
        assert!(difference.abs() < 1e-5, "{name}: {difference}");
    }
}

/// A component without a memory has the value that it would have if its channel ran.
#[test]
fn components_without_a_memory_are_computed() {
    let with = |component: &str, term: &str| {
        let channel = format!("<flight_control name=\"f\"><channel name=\"c\">{component}</channel></flight_control>");
        flown_with(&[("<flight_control name=\"none\"/>", &channel), (PITCH, &format!("{PITCH}{term}"))], &[]).unwrap()
    };
    let term = "<product><v>0.02</v><p>aero/k</p></product>";
    for (component, equal) in [
        (
            "<fcs_function name=\"aero/k\"><function><product><v>1.3</v><p>velocities/mach</p></product></function></fcs_function>",
            "<product><v>0.02</v><v>1.3</v><p>velocities/mach</p></product>",
        ),
        (
            "<switch name=\"aero/k\"><default value=\"1\"/><test value=\"2\">velocities/mach gt 0.3</test></switch>",
            "<v>0.02</v>",
        ),
        (
            "<switch name=\"aero/k\"><default value=\"1\"/><test logic=\"OR\" value=\"2\">velocities/mach gt 0.3\nvelocities/mach lt 0.2\
             </test></switch>",
            "<v>0.04</v>",
        ),
        (
            "<summer name=\"aero/k\"><input>aero/alpha-deg</input><input>-aero/beta-deg</input><bias>1</bias></summer>",
            "<product><v>0.02</v><sum><v>1</v><p>aero/alpha-deg</p><p>-aero/beta-deg</p></sum></product>",
        ),
        (
            "<summer name=\"aero/a\"><input>aero/alpha-deg</input><clipto><min>0</min><max>0.1</max></clipto></summer>\
             <pure_gain name=\"aero/k\"><input>aero/a</input><gain>3</gain></pure_gain>",
            "<v>0.006</v>",
        ),
    ] {
        let (found, expected) = (with(component, term), with_term(equal).unwrap());
        let difference = elevator_deg(&found) - elevator_deg(&expected);
        assert!(difference.abs() < 1e-9, "{component}: {difference}");
        assert!(noted(&found, "without a memory") && !noted(&found, "aero/k, which"), "{:?}", found.notes());
    }
    // One that follows a command does not follow from the flight.
    let commanded = with("<summer name=\"aero/k\"><input>fcs/elevator-cmd-norm</input><bias>1</bias></summer>", term);
    assert!(
        noted(&commanded, "aero/k, which a channel would write, stays at 0: no channel runs."),
        "{:?}",
        commanded.notes()
    );
}

#[test]
fn what_stays_at_a_value_is_named() {
    // The load factor is 1 in straight flight; in JSBSim 1.3.3 this term gives a moment of 0.0200.
    let load = with_term("<product><v>0.02</v><p>accelerations/Nz</p></product>").unwrap();
    let constant = with_term("<v>0.02</v>").unwrap();
    assert!((elevator_deg(&load) - elevator_deg(&constant)).abs() < 1e-9);
    assert!(noted(&load, "accelerations/Nz, which JSBSim computes in flight, stays at 1."), "{:?}", load.notes());
    let propelled = with_term("<product><v>0.02</v><p>moments/l-prop-lbsft</p></product>").unwrap();
    assert!(
        noted(&propelled, "moments/l-prop-lbsft, which JSBSim computes in flight, stays at 0."),
        "{:?}",
        propelled.notes()
    );
    // A lag has a memory, so that its value in a state is not known.
    let lag = "<flight_control name=\"f\"><channel name=\"c\"><lag_filter name=\"aero/k\"><input>aero/alpha-rad</input><c1>2</c1>\
               </lag_filter></channel></flight_control>";
    let changes = [("<flight_control name=\"none\"/>", lag), (PITCH, "<v>0.02</v><p>aero/k</p>")];
    let late = flown_with(&changes, &[]).unwrap();
    assert!(noted(&late, "aero/k, which a channel would write, stays at 0: no channel runs."), "{:?}", late.notes());
}

#[test]
fn what_is_set_in_vain_is_refused_with_what_can_be_set() {
    for (name, part) in [
        ("aero/force", "its value is computed"),
        ("aero/alpha-rad", "its value is computed"),
        ("aero/qbar-psf", "its value is computed"),
        ("inertia/weight-lbs", "its value is computed"),
        ("fcs/elevator-pos-rad", "it follows the angle of a surface"),
        ("fcs/elevator-pos-deg", "it follows the angle of a surface"),
        ("gear/gear-pos-norm", "neither aerodynamics nor engines nor masses read it"),
    ] {
        let message = flown_with(&[], &[(name, 3.0)]).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(part), "{message}");
        assert!(message.contains("inertia/empty-weight-lbs"), "{message}");
    }
    let unknown = flown_with(&[], &[("aero/pre", 3.0)]).unwrap_err().to_string();
    assert!(
        unknown.contains("no file mentions the property aero/pre") && unknown.contains("metrics/bw-ft"),
        "{unknown}"
    );
    let light = flown_with(&[], &[("inertia/empty-weight-lbs", 1000.0)]).unwrap();
    assert!((light.mass_properties().mass() - 1000.0 * 0.453_592_37).abs() < 1e-9);
}

#[test]
fn what_is_given_twice_is_refused_with_both_lines() {
    let axis =
        "<axis name=\"DRAG\">\n   <function name=\"aero/more\"><v>0</v></function>\n  </axis>\n  <axis name=\"DRAG\">";
    let message = flown_with(&[("<axis name=\"DRAG\">", axis)], &[]).unwrap_err().to_string();
    let line = line_of("<axis name=\"DRAG\">");
    assert!(message.contains("axis DRAG is given twice"), "{message}");
    assert!(
        message.contains(&format!("line {}:", line + 3)) && message.contains(&format!("line {line}:")),
        "{message}"
    );
    let message = flown_with(&[("name=\"aero/drag\"", "name=\"aero/lift\"")], &[]).unwrap_err().to_string();
    assert!(message.contains("another function is called \"aero/lift\""), "{message}");
    assert!(message.contains(&format!("line {}", line_of("name=\"aero/drag\""))), "{message}");
    assert!(message.contains(&format!("line {})", line_of("name=\"aero/lift\""))), "{message}");
}

#[test]
fn a_trim_beyond_the_stop_of_that_side_is_refused() {
    let scale = |low: &str, high: &str| {
        format!(
            "<flight_control name=\"f\"><channel name=\"c\"><aerosurface_scale name=\"e\"><input>fcs/elevator-cmd-norm</input><range>\
             <min>{low}</min><max>{high}</max></range><output>fcs/elevator-pos-rad</output></aerosurface_scale></channel></flight_control>"
        )
    };
    let with = |low: &str, high: &str, moment: &str| {
        flown_with(&[("<flight_control name=\"none\"/>", &scale(low, high)), (PITCH, moment)], &[]).unwrap()
    };
    let free = elevator_deg(&with("-0.5", "0.5", "<v>0.35</v>"));
    assert!(free > 10.0 && free < 28.0, "{free}");
    let refused = level(&with("-0.5", "0.1", "<v>0.35</v>")).unwrap_err();
    assert!(
        matches!(refused, TrimError::SurfaceLimit { surface: "elevator", limit_rad, .. } if limit_rad == 0.1),
        "{refused}"
    );
    assert!(level(&with("-0.1", "0.5", "<v>0.35</v>")).is_ok());
    let refused = level(&with("-0.1", "0.5", "<v>-0.35</v>")).unwrap_err();
    assert!(
        matches!(refused, TrimError::SurfaceLimit { surface: "elevator", limit_rad, .. } if limit_rad == 0.1),
        "{refused}"
    );
}

#[test]
fn sizes_and_surfaces_that_cannot_be_are_named_with_their_place() {
    let message =
        flown_with(&[("<wingarea unit=\"FT2\">174", "<wingarea unit=\"FT2\">0")], &[]).unwrap_err().to_string();
    assert!(message.contains("text: <metrics>") && message.contains("<wingarea>"), "{message}");
    let message =
        flown_with(&[("<emptywt unit=\"LBS\">2400", "<emptywt unit=\"LBS\">-2400")], &[]).unwrap_err().to_string();
    assert!(message.contains("text:") && message.contains("the mass is -1088.6"), "{message}");
    let message =
        flown_with(&[("<p>fcs/rudder-pos-rad</p>", "<p>fcs/rudder-pos-norm</p>")], &[]).unwrap_err().to_string();
    let line = line_of("fcs/rudder-pos-rad");
    assert!(message.contains(&format!("text: line {line}:")) && message.contains("<aerosurface_scale>"), "{message}");
}
