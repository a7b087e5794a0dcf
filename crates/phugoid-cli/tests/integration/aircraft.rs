//! Aircraft from files, in every command that takes one.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid, shared_file};

const LEVEL: [&str; 4] = ["--altitude", "4300m", "--speed", "104.67m/s"];

/// The model of the HFB-320 trims where its coefficients say: lift and thrust carry the weight, no pitching moment.
#[test]
fn a_model_file_trims_where_its_coefficients_say() {
    let folder = Folder::new("aircraft-trim");
    let text = phugoid(&folder.0, &["estimate", "--show-model", "hfb320"]).out;
    std::fs::write(folder.0.join("jet.toml"), &text).unwrap();
    let of = |aircraft: &str| {
        let run = phugoid(&folder.0, &[["trim", "--aircraft", aircraft].as_slice(), &LEVEL, &["--json"]].concat());
        assert_eq!(run.code, Some(0), "{}", run.err);
        run.json()
    };
    let (file, named) = (of("jet.toml"), of("hfb320"));
    assert_eq!(file, named);
    let number = |key: &str| file[key].as_f64().unwrap();
    let (alpha, elevator, thrust) = (number("alpha_rad"), number("elevator_rad"), number("thrust_n"));
    let force = number("dynamic_pressure_pa") * 30.0968;
    let lift = -0.318267 + 0.260317 + 5.37576 * alpha;
    let weight = 7472.0 * 9.80665;
    // Along the thrust line, 0.0524 rad above body x, which is level with the velocity plus alpha.
    assert!((force * lift + thrust * (alpha + 0.0524).sin() - weight).abs() < 1e-6 * weight);
    let drag = 0.00567516 + 0.00772612 + 0.674256 * alpha;
    assert!((force * drag - thrust * (alpha + 0.0524).cos()).abs() < 1e-6 * weight);
    let moment = 0.0498218 + 0.0189182 - 0.498586 * alpha - 0.990687 * elevator;
    assert!((force * 2.43 * moment - 0.641114 * thrust).abs() < 1e-6 * weight);
    let notes = file["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note.as_str().unwrap().contains("half the weight")), "{notes:?}");
    // The file does not say where the centre of gravity is, so nobody does.
    assert!(file.get("cg").is_none(), "{file}");

    // The limits of [simulation] count.
    let weak = format!("{text}\n[simulation]\nlargest_thrust = \"5 kN\"\n");
    std::fs::write(folder.0.join("weak.toml"), weak).unwrap();
    let run = phugoid(&folder.0, &[["trim", "--aircraft", "weak.toml"].as_slice(), &LEVEL].concat());
    assert!(run.code == Some(1) && run.err.contains("5000"), "{}", run.err);

    // A model of the longitudinal axes has no lateral modes to print.
    let run = phugoid(&folder.0, &[["linearize", "--aircraft", "hfb320"].as_slice(), &LEVEL].concat());
    assert!(run.out.contains("short period") && !run.out.contains("Lateral"), "{}", run.out);

    // And nothing that would turn it.
    for command in ["trim", "linearize"] {
        let turning = [&[command, "--aircraft", "hfb320", "--turn-rate", "3deg/s"], &LEVEL[..]].concat();
        let run = phugoid(&folder.0, &turning);
        let message = run.fails(1);
        assert!(
            message.contains("no turn of 3.0000 deg/s") && message.contains("longitudinal axes alone"),
            "{message}"
        );
    }
    let run = phugoid(&folder.0, &["trim", "--turn-rate", "3deg/s", LEVEL[0], LEVEL[1], "--speed", "200m/s"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
}

#[test]
fn a_speed_without_sense_is_refused_with_the_range() {
    let folder = Folder::new("aircraft-speed");
    let run = phugoid(&folder.0, &["trim", "--altitude", "1km", "--speed", "1e300m/s"]);
    assert!(run.fails(1).contains("speed is 1e300, expected above 0 and at most 12000 m/s"), "{}", run.err);
}

#[test]
fn what_is_no_aircraft_is_refused_with_what_to_write() {
    let folder = Folder::new("aircraft-refused");
    let refused = |aircraft: &[&str]| {
        let run = phugoid(&folder.0, &[["trim", "--aircraft"].as_slice(), aircraft, &LEVEL].concat());
        assert_eq!(run.code, Some(3), "{}", run.out);
        run.err
    };
    let message = refused(&["jett.toml"]);
    assert!(message.contains("jett.toml") && message.contains("takes a model file"), "{message}");
    let message = refused(&["hfb230"]);
    assert!(message.contains("did you mean `hfb320`"), "{message}");
    let message = refused(&["hfb320", "--cg", "0.3"]);
    assert!(message.contains("--cg") && message.contains("F-16"), "{message}");
    let message = refused(&["f16", "--property", "fcs/flap-pos-deg=10"]);
    assert!(message.contains("--property") && message.contains("JSBSim"), "{message}");
    let message = refused(&["hfb320", "--largest-thrust", "10kN"]);
    assert!(message.contains("largest_thrust") && message.contains("write it into the model file"), "{message}");
    // A mass that comes from a record, and terms that count from its first sample.
    let text = phugoid(&folder.0, &["estimate", "--show-model", "hfb320"]).out;
    std::fs::write(folder.0.join("mass.toml"), text.replace("\"7472 kg\"", "{ channel = \"mass\" }")).unwrap();
    let message = refused(&["mass.toml"]);
    assert!(message.contains("`mass`") && message.contains("write a value"), "{message}");
    std::fs::write(folder.0.join("first.toml"), format!("{text}\n[reference]\nalpha = \"first_sample\"\n")).unwrap();
    let message = refused(&["first.toml"]);
    assert!(message.contains("first sample"), "{message}");
    // A slip of the pen under [simulation] is said with its line.
    std::fs::write(folder.0.join("slip.toml"), format!("{text}\n[simulation]\nlargest_trust = \"1 kN\"\n")).unwrap();
    let message = refused(&["slip.toml"]);
    assert!(message.contains("slip.toml:") && message.contains("did you mean `largest_thrust`"), "{message}");
    // What is no XML, and XML of another kind.
    std::fs::write(folder.0.join("noise.xml"), "\u{1}\u{2} nothing").unwrap();
    assert!(refused(&["noise.xml"]).contains("noise.xml"));
    std::fs::write(folder.0.join("other.xml"), "<html/>").unwrap();
    assert!(refused(&["other.xml"]).contains("<html>"));
}

/// From an aircraft to its identified model and back: fly, estimate, write the model, fly that.
#[test]
fn an_identified_model_flies_again() {
    let folder = Folder::new("aircraft-round");
    let run = phugoid(&folder.0, &["simulate", "hfb320", "--out", "flight", "--json"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    // What is assumed is said for a flight as for a trim.
    assert!(run.err.contains("half the weight") && run.json()["notes"][0].is_string(), "{}", run.err);
    assert_eq!(run.json()["true_parameters"]["Cm_alpha"], -0.498586);
    let measured = "flight/measured.csv";
    let estimate = ["estimate", measured, "--model", "hfb320", "--truth", "hfb320", "--no-report", "--json"];
    let run = phugoid(&folder.0, &[estimate.as_slice(), &["--write-model", "identified.toml"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    let result = run.json();
    let parameters = result["parameters"].as_array().unwrap();
    let of = |name: &str| parameters.iter().find(|p| p["name"] == name).unwrap();
    assert_eq!(of("Cm_q")["truth"], -25.8439);
    let text = std::fs::read_to_string(folder.0.join("identified.toml")).unwrap();
    assert!(text.starts_with("# Values estimated: flight/measured.csv, model hfb320, estimator smpe"), "{text}");
    assert!(text.contains(&format!("Cm_alpha = {{ start = {}", of("Cm_alpha")["value"])), "{text}");
    // Comments of the original are there as before.
    assert!(text.contains("# both engines"), "{text}");
    let scenario = phugoid(&folder.0, &["simulate", "hfb320", "--show"]).out;
    let scenario = scenario.replace("file = \"hfb320\"", "file = \"identified.toml\"");
    std::fs::write(folder.0.join("again.toml"), scenario).unwrap();
    let run = phugoid(&folder.0, &["simulate", "again.toml", "--out", "again", "--json"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_eq!(run.json()["true_parameters"]["Cm_alpha"], of("Cm_alpha")["value"]);
    // The same model in DAVE-ML passes its own check data, and carries the uncertainties.
    let run = phugoid(&folder.0, &[estimate.as_slice(), &["--export", "daveml=jet.dml"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    let run = phugoid(&folder.0, &["check", "jet.dml", "--json"]);
    assert_eq!(
        (run.code, run.json()["models"][0]["shots_passed"].as_u64()),
        (Some(0), Some(3)),
        "{} {}",
        run.out,
        run.err
    );
    let text = std::fs::read_to_string(folder.0.join("jet.dml")).unwrap();
    assert!(text.contains("Cm_elevator") && text.contains("normalPDF"), "{text}");
    // Never over what is read.
    let run = phugoid(&folder.0, &["estimate", measured, "--model", "identified.toml", "--write-model", measured]);
    assert!(run.code == Some(3) && run.err.contains("--write-model"), "{}", run.err);
}

/// An input for a model file's aircraft, and the scenario that plays it from another folder.
#[test]
fn an_input_is_designed_for_the_aircraft_of_a_model_file() {
    let folder = Folder::new("aircraft-design");
    let text = phugoid(&folder.0, &["estimate", "--show-model", "hfb320"]).out;
    std::fs::write(folder.0.join("jet.toml"), text).unwrap();
    let scenario = phugoid(&folder.0, &["simulate", "hfb320", "--show"]).out;
    std::fs::write(folder.0.join("flight.toml"), scenario.replace("\"hfb320\"", "\"jet.toml\"")).unwrap();
    let design = ["design", "multisine", "--scenario", "flight.toml", "--model", "jet.toml", "--duration", "20s"];
    let run = phugoid(&folder.0, &[design.as_slice(), &["--out", "designed", "--json"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    let document = run.json();
    assert!(document["modes"]["short_period"].as_f64().unwrap() > 1.0 && document["modes"]["dutch_roll"].is_null());
    assert!(document["prediction"]["parameters"].as_array().is_some_and(|p| p.len() == 11), "{document}");
    let run = phugoid(&folder.0, &["simulate", "designed/scenario.toml", "--out", "played", "--json"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    // Nothing that the rudder could move.
    let run = phugoid(&folder.0, &[design.as_slice(), &["--surface", "rudder", "--out", "none"]].concat());
    assert!(run.code == Some(1) && run.err.contains("rudder"), "{} {}", run.out, run.err);
}

/// NASA's transport, whole and damaged, from the start and in mid-flight.
#[test]
fn the_transport_loses_a_stabiliser() {
    let Some(vehicle) = shared_file("gtm/vehicle.json") else { return };
    let gtm = vehicle.parent().unwrap().to_str().unwrap();
    let folder = Folder::new("aircraft-transport");
    let level = ["--altitude", "300m", "--speed", "40m/s", "--json"];
    let of = |damaged: &str| {
        let run =
            phugoid(&folder.0, &[["linearize", "--aircraft", gtm, "--damaged", damaged].as_slice(), &level].concat());
        assert_eq!(run.code, Some(0), "{}", run.err);
        run.json()
    };
    let (whole, damaged) = (of("none"), of("left-stabiliser-off"));
    // Half the stabiliser is gone, and with it half of the pitch stiffness and of the pitch damping.
    let pitch = |document: &serde_json::Value, state: usize| document["longitudinal"]["A"][3][state].as_f64().unwrap();
    assert!(pitch(&whole, 1) < 1.5 * pitch(&damaged, 1) && pitch(&damaged, 1) < 0.0);
    assert!(pitch(&whole, 3) < 1.5 * pitch(&damaged, 3) && pitch(&damaged, 3) < 0.0);

    let scenario = |damage: &str| {
        format!(
            "name = \"transport\"\nduration = \"4 s\"\nsample_rate = \"100 Hz\"\n[aircraft]\nfile = {gtm:?}\n{damage}\n\
             [condition]\naltitude = \"300 m\"\nspeed = \"40 m/s\"\n"
        )
    };
    let flown = |damage: &str| {
        std::fs::write(folder.0.join("flight.toml"), scenario(damage)).unwrap();
        let run = phugoid(&folder.0, &["simulate", "flight.toml", "--out", "flight", "--json"]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        // No increment says what the damage changes, so none is called zero.
        assert_eq!(
            run.json()["true_parameters"].get("dCm_alpha").is_none(),
            damage.contains("damaged_at"),
            "{}",
            run.out
        );
        std::fs::read_to_string(folder.0.join("flight/truth.csv")).unwrap()
    };
    let (steady, damaged) = (flown(""), flown("damaged = \"left-stabiliser-off\"\ndamaged_at = \"2 s\""));
    let line = |text: &str, k: usize| text.lines().nth(1 + k).unwrap().to_owned();
    // The same until the instant, and another motion from then on.
    assert_eq!(line(&steady, 199), line(&damaged, 199));
    assert_ne!(line(&steady, 201), line(&damaged, 201));
    // The data of the damaged aircraft end at -4 deg of angle of attack, which this flight goes below.
    let diving = scenario("damaged = \"left-stabiliser-off\"\ndamaged_at = \"2 s\"");
    let push = "[[manoeuvre]]\ntype = \"doublet\"\nsurface = \"elevator\"\nstart = \"2 s\"\nwidth = \"1 s\"\namplitude = \"6 deg\"\n";
    std::fs::write(folder.0.join("flight.toml"), format!("{diving}{push}")).unwrap();
    let run = phugoid(&folder.0, &["simulate", "flight.toml", "--out", "flight"]);
    assert!(
        run.code == Some(0) && run.out.contains("alpha leaves the aerodynamic tables (-4 to 30 deg)"),
        "{}",
        run.out
    );
    std::fs::write(folder.0.join("flight.toml"), scenario("damaged = \"left-stabilizer-off\"")).unwrap();
    let run = phugoid(&folder.0, &["simulate", "flight.toml", "--out", "flight"]);
    assert!(run.code == Some(3) && run.err.contains("did you mean `left-stabiliser-off`"), "{}", run.err);
}

/// The F-16 of NASA's files in DAVE-ML and of its tables, flown, and estimated as increments to the first.
#[test]
fn aircraft_in_daveml_and_of_tables_are_trimmed_flown_and_estimated() {
    let file = |name: &str| shared_file(&format!("checks/daveml_s119/{name}"));
    let (Some(aero), Some(inertia), Some(engine)) =
        (file("F16_aero.dml"), file("F16_inertia.dml"), file("F16_prop.dml"))
    else {
        return;
    };
    let folder = Folder::new("aircraft-daveml");
    let name = aero.to_str().unwrap();
    let level = ["--altitude", "6096m", "--speed", "205.74m/s"];
    let run = phugoid(&folder.0, &[["trim", "--aircraft", name].as_slice(), &level].concat());
    assert!(
        run.code == Some(3) && run.err.contains("totalMass (kg)") && run.err.contains("--with FILE"),
        "{}",
        run.err
    );
    let with = ["--with", inertia.to_str().unwrap(), "--with", engine.to_str().unwrap()];
    let property = ["--property", "vrsPositionOfCM=30"];
    let all = [["linearize", "--aircraft", name].as_slice(), &with, &property, &level, &["--json"]].concat();
    let run = phugoid(&folder.0, &all);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let alpha = run.json()["trim"]["alpha_rad"].as_f64().unwrap().to_degrees();
    assert!((alpha - 2.39).abs() < 0.02, "{alpha}");

    let scenario = format!(
        "name = \"F-16 in DAVE-ML\"\nduration = \"12 s\"\nsample_rate = \"50 Hz\"\n[aircraft]\nfile = {aero:?}\nwith = [{inertia:?}, \
         {engine:?}]\nproperties = {{ vrsPositionOfCM = 30.0 }}\n[condition]\naltitude = \"6096 m\"\nspeed = \"205.74 \
         m/s\"\n[[manoeuvre]]\ntype = \"3-2-1-1\"\nsurface = \"elevator\"\nstart = \"0.5 s\"\nunit = \"0.5 s\"\namplitude = \"1 \
         deg\"\n[increments]\ndCm_alpha = -0.2\n[sensors]\nq = {{ noise = \"0.1 deg/s\" }}\nalpha = {{ noise = \"0.1 deg\" }}\n"
    );
    std::fs::write(folder.0.join("scenario.toml"), scenario).unwrap();
    let run = phugoid(&folder.0, &["simulate", "scenario.toml", "--out", "flight"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let model = format!(
        "axes = [\"longitudinal\"]\ninput = \"held\"\n[base]\nfile = {aero:?}\nwith = [{inertia:?}, \
         {engine:?}]\n[base.properties]\nvrsPositionOfCM = 30.0\n[aircraft]\nthrust = {{ channel = \"thrust\" }}\nair_density = \
         \"standard_atmosphere\"\nreference_speed = 205.74\n[coefficients]\nCm = [\"alpha\"]\n[reference]\naltitude = \
         6096\n[parameters]\ndCm_alpha = {{ bounds = [-1, 1] }}\n"
    );
    std::fs::write(folder.0.join("model.toml"), model).unwrap();
    let run = phugoid(&folder.0, &["estimate", "flight/measured.csv", "--model", "model.toml", "--json"]);
    assert!(matches!(run.code, Some(0 | 5)), "{}", run.err);
    let found = run.json()["parameters"][0]["value"].as_f64().unwrap();
    assert!((found + 0.2).abs() < 0.01, "{found}");
    // The same where the file says how well its table of the damping in pitch is known.
    let text = std::fs::read_to_string(&aero).unwrap();
    let (before, after) = text.split_once("gtID=\"Cmq_table_def\">").unwrap();
    let (references, after) = after.split_once("<dataTable>").unwrap();
    let said =
        "<uncertainty effect=\"percentage\"><normalPDF numSigmas=\"2\"><bounds>40</bounds></normalPDF></uncertainty>";
    let uncertain = format!("{before}gtID=\"Cmq_table_def\">{references}{said}<dataTable>{after}");
    std::fs::write(folder.0.join("uncertain.dml"), uncertain).unwrap();
    let model = std::fs::read_to_string(folder.0.join("model.toml")).unwrap();
    let model = model.replace(&format!("file = {aero:?}"), "file = \"uncertain.dml\"");
    std::fs::write(folder.0.join("uncertain.toml"), format!("{model}[uncertainty]\nbase = \"elements\"\n")).unwrap();
    let estimate = ["estimate", "flight/measured.csv", "--model", "uncertain.toml"];
    let run = phugoid(&folder.0, &[estimate.as_slice(), &["--json"]].concat());
    assert!(matches!(run.code, Some(0 | 5)), "{}", run.err);
    let document = run.json();
    let parameter = &document["parameters"][0];
    assert_eq!(parameter["value"].as_f64().unwrap(), found);
    let parts = parameter["systematic_parts"].as_array().unwrap();
    let part = parts.iter().find(|part| part["quantity"] == "base").unwrap();
    assert!(part["share"].as_f64().unwrap() == 1.0 && part["effect"].as_f64().unwrap().abs() > 0.002, "{part}");
    let run = phugoid(&folder.0, &[estimate.as_slice(), &["--no-report"]].concat());
    let text = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in ["tables of the base 100 %", "states of its tables and numbers, 1 of them: table of Cmq."] {
        assert!(text.contains(words), "{text}");
    }
    let run = phugoid(&folder.0, &["estimate", "--model", "uncertain.toml", "--show-uncertainty"]);
    assert!(run.out.contains("as stated") && run.out.contains("the uncertainty elements of DAVE-ML"), "{}", run.out);

    let Some(tables) = shared_file("f16/tp1538/tp1538_tables.json") else { return };
    let at = ["--property", "cg=0.30", "--altitude", "15000ft", "--speed", "500ft/s", "--json"];
    let run = phugoid(
        &folder.0,
        &[["trim", "--aircraft", tables.parent().unwrap().to_str().unwrap()].as_slice(), &at].concat(),
    );
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.json()["cg"] == 0.30 && run.json()["aircraft"] == "F-16 of NASA TP-1538", "{}", run.out);
}
