//! Increments to a database whose file says how well its tables are known: the bounds hold where a table really is off.

use std::path::PathBuf;

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, KnownChange, Method, Opens, StructureSearch, estimate};
use phugoid_identification::estimation::{Estimation, ParameterResult, UncertainQuantity};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

use crate::shared_data::shared_file;

/// What is uncertain of the aircraft, in its standard uncertainties: the table of lift (10 % of it), the damping in pitch (4 of -12) and the
/// elevator (10 % of it).
#[derive(Clone, Copy, Default)]
struct Off {
    lift: f64,
    damping: f64,
    elevator: f64,
}

/// Which of these the file says, and how damping and elevator are correlated.
#[derive(Clone, Copy)]
struct Said {
    lift: bool,
    damping: bool,
    elevator: bool,
    correlation: f64,
}

const ALL: Said = Said { lift: true, damping: true, elevator: true, correlation: 0.0 };
const NOTHING: Said = Said { lift: false, damping: false, elevator: false, correlation: 0.0 };

const LIFT: f64 = 0.1;
const DAMPING: [f64; 2] = [-12.0, 4.0];
const ELEVATOR: [f64; 2] = [-1.2, 0.1];

/// A light aircraft in DAVE-ML.
fn aircraft(off: Off, said: Said) -> String {
    let lift = |value: f64| value * (1.0 + LIFT * off.lift);
    let normal = |is_said: bool, effect: &str, sigmas: f64, bound: f64, more: &str| {
        let text = format!(
            "<uncertainty effect=\"{effect}\"><normalPDF numSigmas=\"{sigmas}\"><bounds>{bound}</bounds>{more}</normalPDF></uncertainty>"
        );
        if is_said { text } else { String::new() }
    };
    let with_damping = format!("<correlation varID=\"cmq\" corrCoef=\"{}\"/>", said.correlation);
    let with_damping = if said.correlation == 0.0 { "" } else { &with_damping };
    let constant = |id: &str, value: f64, doubt: &str| {
        format!("<variableDef name=\"{id}\" varID=\"{id}\" units=\"nd\" initialValue=\"{value}\">{doubt}</variableDef>")
    };
    let sized = |name: &str, units: &str, value: f64| {
        format!("<variableDef name=\"{name}\" varID=\"{name}\" units=\"{units}\" initialValue=\"{value}\"/>")
    };
    let input = |name: &str, id: &str, units: &str| {
        format!("<variableDef name=\"{name}\" varID=\"{id}\" units=\"{units}\"><isInput/></variableDef>")
    };
    let product = |a: &str, b: &str| format!("<apply><times/><ci>{a}</ci><ci>{b}</ci></apply>");
    let output = |name: &str, id: &str, sum: &[String]| {
        format!(
            "<variableDef name=\"{name}\" varID=\"{id}\" units=\"nd\"><calculation><math><apply><plus/>{}</apply></math></calculation>\
             <isOutput/></variableDef>",
            sum.concat()
        )
    };
    let table = |id: &str, values: [f64; 3], doubt: &str| {
        format!(
            "<function name=\"{id}\"><independentVarRef varID=\"alpha\" extrapolate=\"both\"/><dependentVarRef varID=\"{id}\"/>\
             <functionDefn><griddedTableDef><breakpointRefs><bpRef bpID=\"A\"/></breakpointRefs>{doubt}<dataTable>{} {} {}</dataTable>\
             </griddedTableDef></functionDefn></function>",
            values[0], values[1], values[2]
        )
    };
    let parts = [
        "<DAVEfunc><fileHeader name=\"small\"><author name=\"A\" org=\"B\"/><creationDate date=\"2026-01-01\"/></fileHeader>".to_owned(),
        input("trueAirspeed", "v", "m_s"),
        input("angleOfAttack", "alpha", "rad"),
        input("bodyAngularRate_Pitch", "q", "rad_s"),
        input("elevatorDeflection", "de", "rad"),
        sized("referenceWingArea", "m2", 16.0),
        sized("referenceWingSpan", "m", 11.0),
        sized("referenceWingChord", "m", 1.5),
        sized("totalMass", "kg", 1000.0),
        sized("bodyMomentOfInertia_Roll", "kgm2", 1300.0),
        sized("bodyMomentOfInertia_Pitch", "kgm2", 1800.0),
        sized("bodyMomentOfInertia_Yaw", "kgm2", 2700.0),
        constant("cmq", DAMPING[0] + DAMPING[1] * off.damping, &normal(said.damping, "additive", 2.0, 2.0 * DAMPING[1], "")),
        constant("cmde", ELEVATOR[0] * (1.0 + ELEVATOR[1] * off.elevator), &normal(said.elevator, "percentage", 3.0, 300.0 * ELEVATOR[1], with_damping)),
        constant("clde", 0.4, ""),
        "<variableDef name=\"qhat\" varID=\"qhat\" units=\"nd\"><calculation><math><apply><divide/><apply><times/><ci>q</ci><cn>0.75</cn>\
         </apply><ci>v</ci></apply></math></calculation></variableDef>"
            .to_owned(),
        "<variableDef name=\"cl0\" varID=\"cl0\" units=\"nd\"/><variableDef name=\"cd0\" varID=\"cd0\" units=\"nd\"/>\
         <variableDef name=\"cm0\" varID=\"cm0\" units=\"nd\"/>"
            .to_owned(),
        output("totalCoefficientOfLift", "cl", &["<ci>cl0</ci>".to_owned(), product("clde", "de")]),
        output("totalCoefficientOfDrag", "cd", &["<ci>cd0</ci>".to_owned(), "<cn>0.01</cn>".to_owned()]),
        output(
            "aeroBodyMomentCoefficient_Pitch",
            "cm",
            &["<ci>cm0</ci>".to_owned(), product("cmq", "qhat"), product("cmde", "de")],
        ),
        "<breakpointDef bpID=\"A\"><bpVals>-0.2 0 0.3</bpVals></breakpointDef>".to_owned(),
        table("cl0", [-0.7, 0.3, 1.8].map(lift), &normal(said.lift, "multiplicative", 1.0, LIFT, "")),
        table("cd0", [0.06, 0.02, 0.08], ""),
        table("cm0", [0.2, 0.05, -0.175], ""),
        "</DAVEfunc>".to_owned(),
    ];
    parts.concat()
}

fn written(name: &str, text: &str) -> PathBuf {
    let file = std::env::temp_dir().join(format!("phugoid-{}-{name}.dml", std::process::id()));
    std::fs::write(&file, text).unwrap();
    file
}

/// A model file of increments to the aircraft of a file.
fn model(base: &str, pitch: &str, uncertainty: &str) -> ModelFile {
    let text = format!(
        r#"
axes = ["longitudinal"]
input = "held"
{base}
[aircraft]
thrust = {{ channel = "thrust" }}
air_density = "standard_atmosphere"
reference_speed = 60
[coefficients]
CL = ["1", "alpha"]
CD = ["1", "alpha"]
Cm = [{pitch}]
[reference]
altitude = 1000
[parameters]
dCL_0 = {{ prior_std = 0.5 }}
dCL_alpha = {{ prior_std = 3 }}
dCD_0 = {{ prior_std = 0.1 }}
dCD_alpha = {{ prior_std = 1 }}
dCm_0 = {{ prior_std = 0.1 }}
dCm_alpha = {{ prior_std = 1 }}
{more}
[uncertainty]
{uncertainty}
"#,
        more = if pitch.contains("q_hat") { "dCm_q = { prior_std = 20 }" } else { "" }
    );
    ModelFile::parse("increments.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

fn flown(aircraft: &PathBuf, seed: u64) -> Scenario {
    let text = format!(
        r#"
name = "small"
duration = "10 s"
sample_rate = "50 Hz"
[aircraft]
file = {aircraft:?}
[condition]
altitude = "1000 m"
speed = "60 m/s"
[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "0.5 s"
unit = "0.5 s"
amplitude = "3 deg"
[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "5.5 s"
unit = "0.35 s"
amplitude = "-3 deg"
[sensors]
true_airspeed = {{ noise = "1 ft/s" }}
alpha = {{ noise = "0.1 deg" }}
theta = {{ noise = "0.05 deg" }}
q = {{ noise = "0.1 deg/s" }}
ax = {{ noise = "0.01 g" }}
az = {{ noise = "0.01 g" }}
"#
    );
    Scenario { seed, ..Scenario::parse(&text, "small").unwrap_or_else(|error| panic!("{error}")) }
}

/// True increment to the tables as they are written, at the reference point of the estimate.
fn truth(off: Off, found: &Estimation, name: &str) -> f64 {
    let (alpha, elevator) = (found.alpha_reference, found.totals[0].reference_elevator);
    match name {
        "dCL_alpha" => 5.0 * LIFT * off.lift,
        "dCL_0" => (0.3 + 5.0 * alpha) * LIFT * off.lift,
        "dCm_0" => ELEVATOR[0] * ELEVATOR[1] * off.elevator * elevator,
        "dCm_q" => DAMPING[1] * off.damping,
        _ => 0.0,
    }
}

fn part(p: &ParameterResult) -> f64 {
    let parts = p.systematic_parts.iter().filter(|part| part.quantity == UncertainQuantity::BaseTables);
    parts.map(|part| part.effect).sum()
}

/// Normal numbers that are spread evenly: the quantiles, in an order that goes with nothing else.
fn spread(count: usize, stride: usize) -> Vec<f64> {
    // Quantiles of a normal distribution, by bisection of its integral as a series would need more code than this.
    let below = |x: f64| {
        let steps = 2000;
        let h = x / f64::from(steps);
        let density = |t: f64| (-0.5 * t * t).exp() / (2.0 * std::f64::consts::PI).sqrt();
        0.5 + (0..steps).map(|k| h * density((f64::from(k) + 0.5) * h)).sum::<f64>()
    };
    let quantile = |p: f64| {
        let (mut low, mut high) = (-5.0, 5.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if below(middle) < p { low = middle } else { high = middle }
        }
        low
    };
    (0..count).map(|k| quantile(((k * stride % count) as f64 + 0.5) / count as f64)).collect()
}

/// A flight of an aircraft that is off.
fn recorded(off: Off, seed: u64) -> Record {
    let truly = written(&format!("truly-{seed}"), &aircraft(off, NOTHING));
    let flight = fly(&flown(&truly, seed)).unwrap_or_else(|error| panic!("{error}"));
    std::fs::remove_file(&truly).unwrap();
    flight.measured
}

fn estimated(record: &Record, model: &ModelFile, options: &EstimateOptions) -> Estimation {
    estimate(record, model, options, &mut |_| ()).unwrap()
}

fn by(method: Method) -> EstimateOptions {
    EstimateOptions { method: Some(method), structure: StructureSearch::Never, ..EstimateOptions::default() }
}

/// A model file of increments to the aircraft as written.
fn to_written(name: &str, said: Said, pitch: &str, uncertainty: &str) -> ModelFile {
    let file = written(name, &aircraft(Off::default(), said));
    let model = model(&format!("base = {file:?}"), pitch, uncertainty);
    std::fs::remove_file(&file).unwrap();
    model
}

const PITCH: &str = "\"1\", \"alpha\"";

#[test]
fn where_tables_are_off_the_truth_lies_within_the_bounds_if_that_is_declared() {
    const FLIGHTS: usize = 25;
    let model = to_written("declared", ALL, PITCH, "base = \"elements\"");
    let [lift, damping, elevator] = [1, 7, 12].map(|stride| spread(FLIGHTS, stride));
    let (mut with, mut without, mut of_moment) = (0, 0, [0, 0]);
    for k in 0..FLIGHTS {
        let off = Off { lift: lift[k], damping: damping[k], elevator: elevator[k] };
        let found = estimated(&recorded(off, 100 + k as u64), &model, &by(Method::Smpe));
        for p in found.parameters.iter().filter(|p| !p.nuisance) {
            let error = (p.value - truth(off, &found, &p.name)).abs();
            // The part of the tables is all that is declared.
            let [declared, silent] = [p.corrected_std_error, p.random_std()].map(|std| usize::from(error <= 2.0 * std));
            with += declared;
            without += silent;
            if p.name.starts_with("dCm") {
                of_moment = [of_moment[0] + declared, of_moment[1] + silent];
            }
        }
    }
    let of = 6 * FLIGHTS;
    println!(
        "within 2 sigma of {of}: {with}, without the declared part {without}; of the moment of {}: {of_moment:?}",
        of / 3
    );
    // 95 % are 142 and 47.
    assert!(with >= 132 && without <= 105, "{with} {without} of {of}");
    assert!(of_moment[0] >= 44 && of_moment[1] <= 32, "{of_moment:?}");
}

/// What is claimed of one sigma of each is what the same error does when it really is there, the same flight with the same noise.
#[test]
fn the_part_of_each_table_is_what_its_error_does() {
    let damping = Said { damping: true, ..NOTHING };
    let elevator = Said { elevator: true, ..NOTHING };
    let sure = to_written("sure", NOTHING, PITCH, "class = \"none\"");
    let plain = recorded(Off::default(), 7);
    let cases =
        [(damping, Off { damping: 1.0, ..Off::default() }), (elevator, Off { elevator: 1.0, ..Off::default() })]
            .map(|(said, off)| (said, off, recorded(off, 7), to_written("one", said, PITCH, "base = \"elements\"")));
    for method in [Method::Smpe, Method::OutputError, Method::EquationError] {
        let nominal = estimated(&plain, &sure, &by(method));
        for (said, off, record, model) in &cases {
            let found = estimated(record, model, &by(method));
            for (p, without) in
                found.parameters.iter().zip(&nominal.parameters).filter(|(p, _)| p.name.starts_with("dCm"))
            {
                let (claimed, random) = (part(p), p.random_std());
                let really = p.value - truth(*off, &found, &p.name) - without.value;
                println!("{method} {}: {really:.5}, claimed {claimed:.5}, random {random:.5}", p.name);
                assert!(
                    (really - claimed).abs() < 0.15 * really.abs() + 0.3 * random,
                    "{method} {}: {really} {claimed}",
                    p.name
                );
            }
            let alpha = found.parameter("dCm_alpha").unwrap();
            assert!(said.elevator || part(alpha).abs() > alpha.random_std(), "{method}: the damping bends it");
        }
    }
}

#[test]
fn an_increment_that_takes_the_error_up_has_no_part_of_it() {
    let record = recorded(Off::default(), 3);
    let lift = Said { lift: true, ..NOTHING };
    let found = estimated(&record, &to_written("lift", lift, PITCH, "base = \"elements\""), &by(Method::Smpe));
    for (name, would_be) in [("dCL_alpha", 5.0 * LIFT), ("dCL_0", 0.3 * LIFT)] {
        let p = found.parameter(name).unwrap();
        println!("{name}: {} of {would_be}, random {}", part(p), p.random_std());
        assert!(part(p).abs() < 0.02 * would_be, "{name}: {}", part(p));
    }
    let damping = Said { damping: true, ..NOTHING };
    let free = "\"1\", \"alpha\", \"q_hat\"";
    let found = estimated(&record, &to_written("free", damping, free, "base = \"elements\""), &by(Method::Smpe));
    for name in ["dCm_q", "dCm_alpha"] {
        let p = found.parameter(name).unwrap();
        println!("{name}: {}, random {}", part(p), p.random_std());
        assert!(part(p).abs() < 0.05 * p.random_std(), "{name}: {} of {}", part(p), p.random_std());
    }
}

#[test]
fn correlations_enter_and_what_is_not_asked_for_changes_nothing() {
    let record = recorded(Off::default(), 5);
    let of = |said: Said, uncertainty: &str| {
        estimated(&record, &to_written("correlated", said, PITCH, uncertainty), &by(Method::Smpe))
    };
    let elements = "base = \"elements\"";
    let [damping, elevator] =
        [Said { damping: true, ..NOTHING }, Said { elevator: true, ..NOTHING }].map(|said| of(said, elements));
    let both = Said { damping: true, elevator: true, ..NOTHING };
    for correlation in [1.0, -1.0, 0.5, 0.0] {
        let found = of(Said { correlation, ..both }, elements);
        for p in &found.parameters {
            let [a, b] = [&damping, &elevator].map(|found| part(found.parameter(&p.name).unwrap()));
            let expected = (a * a + b * b + 2.0 * correlation * a * b).max(0.0).sqrt();
            assert!(
                (p.systematic_std - expected).abs() < 1e-9 + 1e-6 * (a.abs() + b.abs()),
                "{}: {} {expected}",
                p.name,
                p.systematic_std
            );
        }
    }
    // Nothing is asked for: the file's words change nothing, to the last bit, and the verdict says that they are left out.
    let (silent, plain) = (of(ALL, "class = \"none\""), of(NOTHING, "class = \"none\""));
    assert_eq!(silent.parameters, plain.parameters);
    let says = |found: &Estimation, words: &str| found.verdict.iter().any(|sentence| sentence.contains(words));
    assert!(says(&silent, "leaves that out (base = \"elements\" takes it in)"), "{:?}", silent.verdict);
    assert!(says(&plain, "it states none, and none are declared"), "{:?}", plain.verdict);
    assert!(says(&of(NOTHING, elements), "it states none"));
    let declared = of(ALL, elements);
    assert!(
        says(&declared, "states of its tables and numbers, 3 of them: variable cmq, variable cmde, table of cl0."),
        "{:?}",
        declared.verdict
    );
    assert!(
        says(&declared, "a better database (a wind tunnel, or increments for its other terms)"),
        "{:?}",
        declared.verdict
    );
    for (p, q) in declared.parameters.iter().zip(&plain.parameters) {
        assert_eq!((p.value, p.std_error), (q.value, q.std_error));
    }
    let last =
        |found: &Estimation| found.history.parameters.iter().map(|p| *p.std_error.last().unwrap()).collect::<Vec<_>>();
    for (std, p) in last(&declared).iter().zip(&declared.parameters) {
        assert!((std / p.corrected_std_error - 1.0).abs() < 1e-9, "{}", p.name);
    }
    // A live session cannot estimate again.
    let told = |said: Said, uncertainty: &str| {
        to_written("told", said, PITCH, uncertainty).declared_and_not_in_bounds_of_base()
    };
    assert!(told(ALL, elements).unwrap().contains("states of its tables and numbers (3 in all)"));
    assert!(told(NOTHING, "base = 0.05").unwrap().contains("of which 5.0 % are declared"));
    assert_eq!([told(NOTHING, elements), told(ALL, "class = \"none\"")], [None, None]);
    let causal = EstimateOptions { causal_only: true, ..by(Method::Smpe) };
    let found = estimated(&record, &to_written("causal", ALL, PITCH, elements), &causal);
    assert_eq!(found.parameters, plain.parameters);
    assert!(says(&found, "that is worked out by estimating again"), "{:?}", found.verdict);
}

/// Without a word in the file each coefficient may be declared uncertain by a part of what it changes.
#[test]
fn a_part_of_each_coefficient_can_be_declared() {
    let record = recorded(Off::default(), 9);
    let model = to_written("part", NOTHING, PITCH, "base = 0.1");
    let found = estimated(&record, &model, &by(Method::Smpe));
    let alpha = found.parameter("dCm_alpha").unwrap();
    // A tenth of damping and elevator bends it; that of the slope it takes up.
    let [damping, elevator] = [Said { damping: true, ..NOTHING }, Said { elevator: true, ..NOTHING }].map(|said| {
        let found = estimated(&record, &to_written("single", said, PITCH, "base = \"elements\""), &by(Method::Smpe));
        part(found.parameter("dCm_alpha").unwrap())
    });
    let expected = damping * (0.1 * DAMPING[0] / DAMPING[1]) + elevator;
    println!("dCm_alpha: {} {expected}", part(alpha));
    assert!((part(alpha).abs() - expected.abs()).abs() < 0.1 * expected.abs() + 0.1 * alpha.random_std());
    assert!(
        found.verdict.iter().any(|sentence| sentence.contains("10.0 % of what each coefficient changes")),
        "{:?}",
        found.verdict
    );
}

/// Around a known change the tables are as wrong before as after it: what that does to both drops out of the difference.
#[test]
fn a_change_has_the_part_of_the_tables_in_both_values_and_little_in_the_difference() {
    let record = recorded(Off::default(), 11);
    let known_changes = vec![KnownChange { time_s: 5.0, opens: Opens::Everything }];
    let options = EstimateOptions { known_changes, ..by(Method::Smpe) };
    let [declared, silent] = [("base = \"elements\"", ALL), ("class = \"none\"", ALL)]
        .map(|(uncertainty, said)| estimated(&record, &to_written("change", said, PITCH, uncertainty), &options));
    let of = |found: &Estimation| found.changes[0].parameters.iter().find(|p| p.name == "dCm_alpha").unwrap().clone();
    let (with, without) = (of(&declared), of(&silent));
    println!("{with:?} {without:?}");
    assert_eq!((with.before, with.after, with.random_std), (without.before, without.after, without.random_std));
    assert!(with.before_std > 1.2 * without.before_std && with.after_std > 1.2 * without.after_std);
    assert!(with.difference_std >= without.difference_std);
    assert!(with.difference_std < with.before_std.hypot(with.after_std));
}

/// The F-16 of NASA's file, with its table of the damping in roll made larger and with an uncertainty of a tenth in it.
fn f16(text: &str, larger: f64, is_declared: bool) -> String {
    let (before, after) = text.split_once("gtID=\"Clp_table_def\">").unwrap();
    let (references, after) = after.split_once("<dataTable>").unwrap();
    let (values, after) = after.split_once("</dataTable>").unwrap();
    let numbers = values.split(|c: char| c == ',' || c.is_whitespace()).filter_map(|word| word.parse::<f64>().ok());
    let numbers: Vec<String> = numbers.map(|value| (value * larger).to_string()).collect();
    let said =
        "<uncertainty effect=\"percentage\"><normalPDF numSigmas=\"1\"><bounds>10</bounds></normalPDF></uncertainty>";
    let said = if is_declared { said } else { "" };
    format!("{before}gtID=\"Clp_table_def\">{references}{said}<dataTable>{}</dataTable>{after}", numbers.join(", "))
}

/// The same of the lateral-directional motion, and of all axes together.
#[test]
fn the_part_of_a_table_of_the_f16_is_what_its_error_does() {
    let file = |name: &str| shared_file(&format!("checks/daveml_s119/{name}"));
    let (Some(aero), Some(inertia)) = (file("F16_aero.dml"), file("F16_inertia.dml")) else { return };
    let text = std::fs::read_to_string(aero).unwrap();
    let fly = |larger: f64| {
        let aircraft = written("f16", &f16(&text, larger, false));
        let scenario = format!(
            r#"
name = "f16"
duration = "8 s"
sample_rate = "50 Hz"
[aircraft]
file = {aircraft:?}
with = [{inertia:?}]
properties = {{ vrsPositionOfCM = 30.0 }}
[condition]
altitude = "6096 m"
speed = "205.74 m/s"
[[manoeuvre]]
type = "doublet"
surface = "aileron"
start = "0.5 s"
width = "0.5 s"
amplitude = "1.5 deg"
[[manoeuvre]]
type = "doublet"
surface = "rudder"
start = "3 s"
width = "0.6 s"
amplitude = "2 deg"
[[manoeuvre]]
type = "doublet"
surface = "elevator"
start = "5.5 s"
width = "0.4 s"
amplitude = "1 deg"
[sensors]
p = {{ noise = "0.1 deg/s" }}
beta = {{ noise = "0.1 deg" }}
"#
        );
        let flight = fly(&Scenario::parse(&scenario, "f16").unwrap()).unwrap_or_else(|error| panic!("{error}"));
        std::fs::remove_file(&aircraft).unwrap();
        flight.measured
    };
    let model = |axes: &str, more: &str, uncertainty: &str| {
        let aircraft = written("f16-base", &f16(&text, 1.0, true));
        let text = format!(
            r#"
axes = [{axes}]
input = "held"
[base]
file = {aircraft:?}
with = [{inertia:?}]
[base.properties]
vrsPositionOfCM = 30.0
[aircraft]
thrust = {{ channel = "thrust" }}
air_density = "standard_atmosphere"
reference_speed = 205.74
[coefficients]
{more}
CY = ["beta"]
Cl = ["beta", "aileron"]
Cn = ["beta", "rudder"]
[reference]
altitude = 6096
[parameters]
dCY_beta = {{ prior_std = 1 }}
dCl_beta = {{ prior_std = 0.2 }}
dCl_aileron = {{ prior_std = 0.2 }}
dCn_beta = {{ prior_std = 0.2 }}
dCn_rudder = {{ prior_std = 0.2 }}
[uncertainty]
{uncertainty}
"#
        );
        let model = ModelFile::parse("increments.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        std::fs::remove_file(&aircraft).unwrap();
        model
    };
    let (as_written, off) = (fly(1.0), fly(1.1));
    let [lateral, both] = ["\"lateral\"", "\"longitudinal\", \"lateral\""];
    for axes in [lateral, both] {
        let nominal = estimated(&as_written, &model(axes, "", "class = \"none\""), &by(Method::Smpe));
        let found = estimated(&off, &model(axes, "", "base = \"elements\""), &by(Method::Smpe));
        for (p, without) in found.parameters.iter().zip(&nominal.parameters) {
            let (really, claimed, random) = (p.value - without.value, part(p), p.random_std());
            println!("{axes} {}: {really:.6}, claimed {claimed:.6}, random {random:.6}", p.name);
            assert!(
                (really - claimed).abs() < 0.2 * really.abs() + 0.3 * random,
                "{axes} {}: {really} {claimed}",
                p.name
            );
        }
        let beta = found.parameter("dCl_beta").unwrap();
        assert!(part(beta).abs() > beta.random_std(), "the damping bends it");
    }
}
