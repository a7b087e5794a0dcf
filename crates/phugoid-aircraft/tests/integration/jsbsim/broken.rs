//! Files that are wrong: a message with a line, never a panic. And a small one that is right.

use phugoid_aircraft::jsbsim::{Aircraft, Evaluator, FlightCondition, JsbsimError, MAX_FILES};

const GLIDER: &str = include_str!("glider.xml");

/// The line of the glider that a text stands in.
fn line_of(part: &str) -> u32 {
    GLIDER.lines().position(|line| line.contains(part)).unwrap() as u32 + 1
}

fn calm(alpha_rad: f64) -> FlightCondition {
    FlightCondition {
        airspeed_m_s: 40.0,
        alpha_rad,
        beta_rad: 0.0,
        alphadot_rad_s: 0.0,
        betadot_rad_s: 0.0,
        rates_rad_s: [0.0; 3],
        attitude_rad: [0.0; 3],
        height_m: 1000.0,
        height_above_ground_m: 1000.0,
        density_kg_m3: 1.112,
        pressure_pa: 89_875.0,
        temperature_k: 281.65,
        sound_speed_m_s: 336.4,
    }
}

#[test]
fn forces_of_a_small_aircraft_are_those_by_hand() {
    let aircraft = Aircraft::from_text(GLIDER).unwrap();
    assert_eq!(aircraft.name(), "glider");
    let mass = aircraft.mass_properties();
    assert!((mass.mass_kg - 800.0 * 0.453_592_37).abs() < 1e-9);
    assert!((mass.centre_of_gravity_m[0] - 0.0254 * 25.0).abs() < 1e-12);
    // The products of the file are elements of the tensor unless it says that they are not.
    assert!((mass.inertia_kg_m2[0][2] + 20.0 * 1.355_817_948).abs() < 1e-6);
    let mut evaluator = Evaluator::new(&aircraft);
    evaluator.set_flight(&calm(0.1));
    assert!(evaluator.set("fcs/elevator-pos-deg", 0.2_f64.to_degrees()));
    let (lift, drag) = (0.3 + 5.0 * 0.1, 0.04);
    let found = evaluator.coefficients();
    let (s, c) = 0.1_f64.sin_cos();
    let (forward, down) = (lift * s - drag * c, -lift * c - drag * s);
    let chord = 2.5 * 0.3048;
    // The reference point is 15 inches behind the centre of gravity and 2 above it.
    let pitch = -0.2 + (-2.0 * 0.0254 * forward + 15.0 * 0.0254 * down) / chord;
    for (value, expected) in [(found.force[0], forward), (found.force[2], down), (found.moment[1], pitch)] {
        assert!((value - expected).abs() < 1e-6, "{value} instead of {expected}");
    }
    let left_out: Vec<_> = aircraft.omitted().iter().map(ToString::to_string).collect();
    let named = |line: u32, part: &str| {
        left_out.iter().any(|note| note.contains(&format!("line {line}:")) && note.contains(part))
    };
    assert!(named(line_of("<magnetometer"), "magnetometer"), "{left_out:?}");
    assert!(named(line_of("<ground_reactions"), "landing gear"), "{left_out:?}");
    let inputs: Vec<_> = aircraft.inputs().iter().map(|&index| aircraft.properties().nth(index).unwrap()).collect();
    assert_eq!(inputs, ["fcs/elevator-cmd-norm", "fcs/pitch-trim-cmd-norm"]);
}

#[test]
fn forces_and_moments_in_the_axes_that_a_file_names_come_out_in_body_axes() {
    let turned = |frame: &str, alpha: f64, beta: f64| {
        let text = GLIDER
            .replace("<axis name=\"LIFT\">", &format!("<axis name=\"LIFT\" frame=\"{frame}\">"))
            .replace("<axis name=\"DRAG\">", &format!("<axis name=\"DRAG\" frame=\"{frame}\">"))
            .replace("<axis name=\"PITCH\">", &format!("<axis name=\"ROLL\" frame=\"{frame}\">"))
            .replace("<x> 40 </x> <y> 0 </y> <z> 3 </z>", "<x> 25 </x> <y> 0 </y> <z> 1 </z>");
        let aircraft = Aircraft::from_text(&text).unwrap();
        let mut evaluator = Evaluator::new(&aircraft);
        evaluator.set_flight(&FlightCondition { beta_rad: beta, ..calm(alpha) });
        evaluator.set("fcs/elevator-pos-rad", 0.1);
        evaluator.coefficients()
    };
    let (alpha, beta) = (0.1_f64, 0.2_f64);
    let (lift, drag, roll) = (0.3 + 5.0 * alpha, 0.03 + 0.25 * 0.02, -0.1 * 2.5 * 0.3048 / 15.0);
    let ((sa, ca), (sb, cb)) = (alpha.sin_cos(), beta.sin_cos());
    let close = |found: [f64; 3], expected: [f64; 3]| {
        let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-6, "{found:?} instead of {expected:?}");
    };
    let stability = turned("STABILITY", alpha, beta);
    close(stability.force, [lift * sa - drag * ca, 0.0, -lift * ca - drag * sa]);
    close(stability.moment, [roll * ca, 0.0, roll * sa]);
    let wind = turned("WIND", alpha, beta);
    close(wind.force, [lift * sa - drag * ca * cb, -drag * sb, -lift * ca - drag * sa * cb]);
    close(wind.moment, [roll * ca * cb, roll * sb * 15.0 / (2.5 * 0.3048), roll * sa * cb]);
}

#[test]
fn flight_control_moves_the_surfaces_when_it_is_run() {
    let aircraft = Aircraft::from_text(GLIDER).unwrap();
    let mut evaluator = Evaluator::new(&aircraft);
    evaluator.set_flight(&calm(0.0));
    evaluator.set("fcs/elevator-cmd-norm", 0.6);
    evaluator.set("fcs/pitch-trim-cmd-norm", 0.1);
    evaluator.step_channels(0.01);
    assert_eq!(evaluator.get("fcs/elevator-pos-rad"), Some(0.0), "the first step of a filter gives 0");
    assert_eq!(evaluator.get("fcs/fast"), Some(1.0));
    for _ in 0..1000 {
        evaluator.step_channels(0.01);
    }
    assert!((evaluator.get("fcs/elevator-pos-rad").unwrap() - 0.25).abs() < 1e-9);
    assert!((evaluator.get("fcs/elevator-pos-deg").unwrap() - 0.25_f64.to_degrees()).abs() < 1e-7);
    assert!(!evaluator.set("no/such-property", 1.0));
}

/// The message that refuses the glider with one text replaced by another.
fn refusal(from: &str, to: &str) -> String {
    assert!(GLIDER.contains(from), "{from}");
    let text = GLIDER.replacen(from, to, 1);
    let message = Aircraft::from_text(&text).map(|_| ()).unwrap_err().to_string();
    assert!(message.len() < 400, "{message}");
    message
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let slope = "<function name=\"aero/lift-slope\"><value> 5 </value></function>";
    let with = |inside: &str| format!("<function name=\"aero/lift-slope\">{inside}</function>");
    for (from, to, part) in [
        (slope, with("<sinh><value>1</value></sinh>"), "sinh"),
        (slope, with("<random/>"), "random"),
        (slope, with("<quotient><value>1</value></quotient>"), "1 arguments"),
        (slope, with("<value>five</value>"), "five"),
        (slope, with("<value>nan</value>"), "nan"),
        (slope, with("<table><independentVar>aero/alpha-rad</independentVar></table>"), "tableData"),
        (slope, with("<table><tableData> 0 0 </tableData></table>"), "independentVar"),
        (slope, with("<property>aero/lift</property>"), "its own value"),
        (slope, with("<property>aero/lift-slope</property>"), "its own value"),
        (slope, with("<property apply=\"f\">x</property>"), "template"),
        (slope, with("<property></property>"), "names no property"),
        (slope, with(""), "0 arguments"),
        ("0.1   0.03  0.05", "0.1   0.03".into(), "has 2 numbers, not 3"),
        ("0.1   0.03  0.05", "-0.2  0.03  0.05".into(), "do not increase"),
        ("0.1   0.03  0.05", "0.1   0.03  x".into(), "numbers"),
        ("<axis name=\"DRAG\">", "<axis name=\"X\">".into(), "mixes"),
        ("<axis name=\"DRAG\">", "<axis name=\"THRUST\">".into(), "THRUST"),
        ("<axis name=\"DRAG\">", "<axis name=\"DRAG\" frame=\"BODY\">".into(), "frame"),
        ("<axis name=\"DRAG\">", "<axis name=\"DRAG\" frame=\"EARTH\">".into(), "EARTH"),
        ("lookup=\"column\"", "lookup=\"depth\"".into(), "depth"),
        ("unit=\"M2\"", "unit=\"ACRE\"".into(), "ACRE"),
        ("<metrics>", "<metrics file=\"../../../etc/passwd\">".into(), "below the folder"),
        ("<metrics>", "<metrics file=\"/etc/passwd\">".into(), "below the folder"),
    ] {
        let message = refusal(from, &to);
        assert!(message.contains(part), "{message}");
        // What is wrong in a row is named with the table that it stands in.
        let line = if from.starts_with("0.1 ") { line_of("<tableData>") } else { line_of(from) };
        // Of functions that need each other, one is named.
        let line = if to.contains(">aero/lift<") { line_of("name=\"aero/lift\"") } else { line };
        assert!(message.contains(&format!("line {line}:")), "{message}");
    }
    assert!(Aircraft::from_text("<a/>").is_err());
}

#[test]
fn a_torn_file_is_refused_wherever_it_ends() {
    for end in 0..GLIDER.trim_end().len() {
        assert!(Aircraft::from_text(&GLIDER[..end]).is_err(), "{end}");
    }
}

#[test]
fn a_file_without_a_line_is_read_or_refused() {
    let lines: Vec<_> = GLIDER.lines().collect();
    for left_out in 0..lines.len() {
        let text: Vec<_> = lines.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, line)| *line).collect();
        if let Ok(aircraft) = Aircraft::from_text(&text.join("\n")) {
            let mut evaluator = Evaluator::new(&aircraft);
            evaluator.set_flight(&calm(0.2));
            evaluator.step_channels(0.01);
            evaluator.step_channels(0.0);
            evaluator.coefficients();
        }
    }
}

#[test]
fn functions_that_would_take_for_ever_are_refused() {
    let chain = |functions: usize, reads: usize| {
        let mut text = "<function name=\"a/f0\"><v>1</v></function>\n".to_owned();
        for k in 1..functions {
            let read = format!("<p>a/f{}</p>", k - 1).repeat(reads);
            text += &format!("<function name=\"a/f{k}\"><sum>{read}</sum></function>\n");
        }
        GLIDER.replacen("<aerodynamics>", &format!("<aerodynamics>{text}"), 1)
    };
    assert!(Aircraft::from_text(&chain(200, 1)).is_ok());
    for text in [chain(60, 2), chain(100_000, 1)] {
        let message = Aircraft::from_text(&text).map(|_| ()).unwrap_err().to_string();
        assert!(message.contains("too many others"), "{message}");
    }
}

#[test]
fn nesting_and_size_are_bounded() {
    let deep = "<sum>".repeat(20_000_000);
    let text = GLIDER.replacen("<value> 5 </value>", &deep, 1);
    assert!(Aircraft::from_text(&text).is_err());
    let folder = folder("large");
    let file = folder.join("large.xml");
    std::fs::write(&file, &text).unwrap();
    let message = Aircraft::open(&file).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("bytes"), "{message}");
    let nested = format!("<sum>{}<value>1</value>{}</sum>", "<abs>".repeat(200), "</abs>".repeat(200));
    let message = refusal("<value> 5 </value>", &nested);
    assert!(message.contains(&format!("line {}:", line_of("aero/lift-slope"))), "{message}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// A folder of its own.
fn folder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("phugoid-jsbsim-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn files_are_read_only_below_the_folders_of_the_aircraft() {
    let package = folder("package");
    let aircraft = package.join("aircraft/glider");
    std::fs::create_dir_all(aircraft.join("Systems")).unwrap();
    std::fs::create_dir_all(package.join("systems")).unwrap();
    let with = |element: &str| GLIDER.replacen("<ground_reactions/>", element, 1);
    let system = "<system name=\"s\"><property value=\"7\">s/seven</property></system>";
    std::fs::write(aircraft.join("Systems/own.xml"), system).unwrap();
    std::fs::write(package.join("systems/shared.xml"), system.replace("s/seven", "s/shared")).unwrap();
    std::fs::write(package.join("outside.xml"), system).unwrap();
    let open = |text: &str| {
        std::fs::write(aircraft.join("glider.xml"), text).unwrap();
        Aircraft::open(&aircraft)
    };
    let read = open(&with(
        "<system file=\"own\"/><system file=\"shared.xml\"><property value=\"8\">s/shared</property></system>",
    ))
    .unwrap();
    let mut evaluator = Evaluator::new(&read);
    assert_eq!(evaluator.get("s/seven"), Some(7.0));
    assert_eq!(
        evaluator.get("s/shared"),
        Some(8.0),
        "what stands in the aircraft goes before what stands in the system"
    );
    // A letter that is not UTF-8 is read as Latin-1.
    let mut bytes = with("<!-- Andr\u{1} -->").into_bytes();
    bytes.iter_mut().filter(|byte| **byte == 1).for_each(|byte| *byte = 0xe9);
    std::fs::write(aircraft.join("glider.xml"), bytes).unwrap();
    assert!(Aircraft::open(&aircraft).is_ok());
    // A function of another section may be read.
    let read =
        open(&with("<external_reactions><function name=\"a/two\"><value>2</value></function></external_reactions>"))
            .unwrap();
    assert_eq!(Evaluator::new(&read).get("a/two"), Some(2.0));
    // A system that is not there is left out.
    let read = open(&with("<system file=\"missing\"/>")).unwrap();
    assert!(read.omitted().iter().any(|note| note.what.contains("missing")));
    let refused = open(&with("<system file=\"../../outside.xml\"/>"));
    assert!(matches!(refused, Err(JsbsimError::Refused { line, .. }) if line == line_of("<ground_reactions")));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(package.join("outside.xml"), aircraft.join("Systems/link.xml")).unwrap();
        let read = open(&with("<system file=\"link\"/>")).unwrap();
        assert!(read.omitted().iter().any(|note| note.what.contains("link")), "a link does not lead out of the folder");
    }
    let many = open(&with(&"<system file=\"own\"/>\n".repeat(MAX_FILES + 1)));
    assert!(many.map(|_| ()).unwrap_err().to_string().contains("too many files"));
    std::fs::remove_dir_all(package).unwrap();
}

#[test]
fn a_file_with_scrambled_words_is_read_or_refused() {
    // Words of the file itself in places where they do not belong, by a generator that says the same every time.
    scramble(GLIDER, 3000);
    if let Some(package) = std::env::var_os("PHUGOID_JSBSIM_SCRAMBLE").and_then(|_| super::package()) {
        for name in ["c182", "f22", "X15", "T38", "p51d", "B747"] {
            let text = std::fs::read_to_string(package.join(format!("aircraft/{name}/{name}.xml"))).unwrap();
            scramble(&text, 300);
        }
    }
}

fn scramble(text: &str, times: usize) {
    let words: Vec<&str> =
        text.split_inclusive(|letter: char| letter.is_whitespace() || letter == '>' || letter == '<').collect();
    let mut random = 1_u64;
    let mut draw = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let mut read = 0;
    for _ in 0..times {
        let mut changed = words.clone();
        for _ in 0..1 + draw(3) {
            let (at, from) = (draw(words.len()), draw(words.len()));
            changed[at] = [words[from], "-1e308 ", "0 ", "1e308 ", "-", "fcs/elevator-pos-rad "][draw(6)];
        }
        if let Ok(aircraft) = Aircraft::from_text(&changed.concat()) {
            read += 1;
            let mut evaluator = Evaluator::new(&aircraft);
            for alpha in [0.0, -3.0, 0.3, f64::NAN, f64::INFINITY] {
                evaluator.set_flight(&calm(alpha));
                evaluator.step_channels(0.01);
                evaluator.coefficients();
                evaluator.propulsive_force_moment();
                evaluator.mass_properties();
            }
        }
    }
    assert!(read > 0);
}
