//! Models with something moved that their file calls uncertain, and aircraft of such models.

use phugoid_aircraft::daveml::Model;
use phugoid_aircraft::flown::{AircraftFile, FlownOptions};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Controls};
use phugoid_flight_dynamics::scalar::Dual;

use crate::shared_data::shared_file;

fn whole(parts: &str) -> String {
    format!(
        "<DAVEfunc><fileHeader name=\"m\"><author name=\"A\" org=\"B\"/><creationDate date=\"2026-01-01\"/></fileHeader>{parts}</DAVEfunc>"
    )
}

/// A constant of 4 with this uncertainty, and a variable that is three times as large.
fn constant(effect: &str, distribution: &str) -> Model {
    Model::parse(&whole(&format!(
        "<variableDef name=\"k\" varID=\"k\" units=\"nd\" initialValue=\"-4\" maxValue=\"6\"><uncertainty effect=\"{effect}\">{distribution}\
         </uncertainty></variableDef>\
         <variableDef name=\"s\" varID=\"s\" units=\"nd\" initialValue=\"0.6\"/>\
         <variableDef name=\"twice\" varID=\"twice\" units=\"nd\"><calculation><math><apply><times/><ci>k</ci><cn>3</cn></apply></math>\
         </calculation></variableDef>"
    )))
    .unwrap()
}

/// The value that comes out when the only element of a model is moved.
fn moved(model: &Model, by: f64, of: &str) -> f64 {
    let [element] = &model.uncertain_elements()[..] else { panic!() };
    let moved = model.moved(element, by).unwrap();
    // The same with derivatives, and the model itself stays as it is.
    let mut sloped = moved.evaluator_of::<Dual<1>>();
    sloped.run();
    let position = moved.position(of).unwrap();
    let value = moved.evaluate(&[]).unwrap().get(position);
    assert!((sloped.get(position).value - value).abs() < 1e-14);
    let none = model.moved(element, 0.0).unwrap().evaluate(&[]).unwrap().get(position);
    assert_eq!(none, model.evaluate(&[]).unwrap().get(position));
    value
}

#[test]
fn one_standard_uncertainty_is_that_of_the_effect_and_the_distribution() {
    let normal =
        |sigmas: f64, bound: &str| format!("<normalPDF numSigmas=\"{sigmas}\"><bounds>{bound}</bounds></normalPDF>");
    let uniform = |bounds: &[f64]| {
        let bounds: String = bounds.iter().map(|bound| format!("<bounds>{bound}</bounds>")).collect();
        format!("<uniformPDF>{bounds}</uniformPDF>")
    };
    let root = |x: f64| x.sqrt();
    for (effect, distribution, expected) in [
        ("additive", normal(3.0, "1.5"), -4.0 + 0.5),
        ("multiplicative", normal(2.0, "0.1"), -4.0 * 1.05),
        ("percentage", normal(3.0, "30"), -4.0 * 1.1),
        // The bound is a value itself, three sigma from the one that is written.
        ("absolute", normal(3.0, "-2.5"), -4.0 + 0.5),
        ("absolute", normal(3.0, "-5.5"), -4.0 + 0.5),
        ("additive", uniform(&[0.6]), -4.0 + 0.6 / root(3.0)),
        ("multiplicative", uniform(&[0.1]), -4.0 * (1.0 + 0.1 / root(3.0))),
        ("percentage", uniform(&[12.0]), -4.0 * (1.0 + 0.12 / root(3.0))),
        ("absolute", uniform(&[-3.4]), -4.0 + 0.6 / root(3.0)),
        // Evenly to both sides it is half of the width over the root of three.
        ("additive", uniform(&[-0.6, 0.6]), -4.0 + 0.6 / root(3.0)),
        // From -0.5 to 0.1: a variance of 0.6^2/12, and a mean that is 0.2 off.
        ("additive", uniform(&[-0.5, 0.1]), -4.0 + root(0.03 + 0.04)),
        ("additive", uniform(&[0.5, 0.1]), -4.0 + root(0.03 + 0.04)),
        ("multiplicative", uniform(&[0.5, 0.1]), -4.0 * (1.0 + root(0.07))),
        ("absolute", uniform(&[-4.5, -3.9]), -4.0 + root(0.03 + 0.04)),
        ("absolute", uniform(&[-4.3, -3.7]), -4.0 + 0.3 / root(3.0)),
        ("additive", normal(2.0, "<variableRef varID=\"s\"/>"), -4.0 + 0.3),
        ("percentage", uniform(&[0.0, 0.0]), -4.0),
    ] {
        let model = constant(effect, &distribution);
        for (by, factor) in [(1.0, 1.0), (-2.0, -2.0)] {
            let expected = -4.0 + factor * (expected + 4.0);
            assert!((moved(&model, by, "k") - expected).abs() < 1e-14, "{effect} {distribution}");
            assert!((moved(&model, by, "twice") - 3.0 * expected).abs() < 1e-14, "{effect} {distribution}");
        }
    }
    // Limits hold for what is moved.
    assert_eq!(moved(&constant("additive", &normal(1.0, "20")), 1.0, "k"), 6.0);
}

/// Two functions with one table, of which bounds are given, and a third with its own.
fn tables(bounds: &str) -> Model {
    let function = |name: &str, table: &str| {
        format!(
            "<variableDef name=\"{name}\" varID=\"{name}\" units=\"nd\"/><function name=\"{name}\"><independentVarRef varID=\"x\"/>\
             <dependentVarRef varID=\"{name}\"/><functionDefn>{table}</functionDefn></function>"
        )
    };
    Model::parse(&whole(&format!(
        "<variableDef name=\"x\" varID=\"x\" units=\"nd\" initialValue=\"0.25\"/>\
         <breakpointDef bpID=\"B\"><bpVals>0 1</bpVals></breakpointDef>\
         <griddedTableDef gtID=\"T\"><breakpointRefs><bpRef bpID=\"B\"/></breakpointRefs><uncertainty effect=\"multiplicative\">{bounds}\
         </uncertainty><dataTable>5 9</dataTable></griddedTableDef>{}{}{}",
        function("f", "<griddedTableRef gtID=\"T\"/>"),
        function("g", "<griddedTableRef gtID=\"T\"/>"),
        function("h", "<ungriddedTableDef utID=\"U\"><uncertainty effect=\"additive\"><normalPDF numSigmas=\"1\"><bounds><dataTable>0.2 0.1\
            </dataTable></bounds><correlation varID=\"f\" corrCoef=\"-0.5\"/></normalPDF></uncertainty><dataPoint>1 2</dataPoint>\
            <dataPoint>0 1</dataPoint></ungriddedTableDef>"),
    )))
    .unwrap()
}

#[test]
fn a_table_is_moved_in_all_functions_that_share_it_and_its_values_by_sizes_of_their_own() {
    for (bounds, expected) in [
        ("<normalPDF numSigmas=\"2\"><bounds>0.2</bounds></normalPDF>", 6.0 * 1.1),
        (
            "<normalPDF numSigmas=\"2\"><bounds><dataTable>0.2 0.4</dataTable></bounds></normalPDF>",
            0.75 * 5.5 + 0.25 * 10.8,
        ),
        ("<normalPDF numSigmas=\"2\"><bounds><variableRef varID=\"x\"/></bounds></normalPDF>", 6.0 * 1.125),
    ] {
        let model = tables(bounds);
        let elements = model.uncertain_elements();
        assert_eq!(
            elements.iter().map(|element| element.name.as_str()).collect::<Vec<_>>(),
            ["table of f", "table of h"]
        );
        let moved = model.moved(&elements[0], 1.0).unwrap().evaluate(&[]).unwrap();
        let value = |name: &str| moved.get(model.position(name).unwrap());
        assert!(
            (value("f") - expected).abs() < 1e-14 && (value("g") - expected).abs() < 1e-14,
            "{bounds}: {}",
            value("f")
        );
        assert_eq!(value("h"), 1.25);
        // The points of an ungridded table stand in any order, and its bounds with them.
        let moved = model.moved(&elements[1], 1.0).unwrap().evaluate(&[]).unwrap();
        assert!((moved.get(model.position("h").unwrap()) - (0.75 * 1.1 + 0.25 * 2.2)).abs() < 1e-14);
        assert_eq!(moved.get(model.position("f").unwrap()), 6.0);
        assert_eq!(
            (model.correlation(&elements[0], &elements[1]), model.correlation(&elements[1], &elements[1])),
            (-0.5, 1.0)
        );
    }
}

#[test]
fn correlations_are_those_of_either_element_and_whole_where_no_coefficient_is_given() {
    let one = |id: &str, more: &str| {
        format!(
            "<variableDef name=\"{id}\" varID=\"{id}\" units=\"nd\" initialValue=\"1\"><uncertainty effect=\"additive\">\
             <normalPDF numSigmas=\"1\"><bounds>1</bounds>{more}</normalPDF></uncertainty></variableDef>"
        )
    };
    let model = Model::parse(&whole(&format!(
        "{}{}{}",
        one("a", "<correlatesWith varID=\"b\"/><correlatesWith varID=\"c\"/>"),
        one("b", "<correlation varID=\"a\" corrCoef=\"0.25\"/>"),
        one("c", "")
    )))
    .unwrap();
    let [a, b, c] = &model.uncertain_elements()[..] else { panic!() };
    assert_eq!((model.correlation(a, b), model.correlation(b, a)), (0.25, 0.25));
    assert_eq!((model.correlation(a, c), model.correlation(c, a), model.correlation(b, c)), (1.0, 1.0, 0.0));
}

/// The F-16 of NASA with an uncertainty in one of its tables, and one of the moment reference point.
#[test]
fn an_aircraft_is_moved_with_its_tables_and_keeps_its_mass() {
    let file = |name: &str| shared_file(&format!("checks/daveml_s119/{name}"));
    let (Some(aero), Some(inertia)) = (file("F16_aero.dml"), file("F16_inertia.dml")) else { return };
    let text = std::fs::read_to_string(aero).unwrap();
    let (before, after) = text.split_once("<dataTable>").unwrap();
    let said = "<uncertainty effect=\"percentage\"><normalPDF numSigmas=\"2\"><bounds>20</bounds></normalPDF></uncertainty><dataTable>";
    let own = std::env::temp_dir().join(format!("phugoid-{}-uncertain-f16.dml", std::process::id()));
    std::fs::write(&own, format!("{before}{said}{after}")).unwrap();
    let properties = vec![("vrsPositionOfCM".to_owned(), 30.0)];
    let options = FlownOptions { with: vec![inertia], properties, ..FlownOptions::default() };
    let written = AircraftFile::open_with(&own, &options).unwrap();
    std::fs::remove_file(&own).unwrap();
    assert_eq!(written.uncertain().len(), 1);
    assert_eq!(written.correlations(), [[1.0]]);
    let moved = written.moved(0, 1.0).unwrap();
    assert!(written.moved(1, 1.0).is_none());
    let at = |aircraft: &AircraftFile| {
        let air =
            AirData { speed: 150.0, alpha: 0.1, beta: 0.02, density: 1.0, dynamic_pressure: 11_250.0, mach: 0.45 };
        let controls = Controls { throttle: 0.2, elevator: -0.05, aileron: 0.02, rudder: 0.01 };
        let c = aircraft.coefficients(&air, [0.1, 0.05, 0.02], &controls);
        [c.cx, c.cy, c.cz, c.cl, c.cm, c.cn]
    };
    let (before, after) = (at(&written), at(&moved));
    assert!(before.iter().zip(after).any(|(a, b)| (a - b).abs() > 1e-5), "{before:?} {after:?}");
    let back = at(&moved.moved(0, -1.0).unwrap());
    let twice = at(&written.moved(0, 2.0).unwrap());
    for k in 0..6 {
        assert!((twice[k] - 2.0 * after[k] + before[k]).abs() < 1e-12, "linear in its size");
        // Moved back from there it is a tenth of what it was made.
        assert!((back[k] - after[k] + 1.1 * (after[k] - before[k])).abs() < 1e-12);
    }
    assert_eq!(written.mass_properties().mass(), moved.mass_properties().mass());
    // A part of all that changes from a point.
    let scaled = AircraftFile::scaled(std::sync::Arc::new(written), [0.1, 0.1, 0.1, 0.1, 0.1, 0.1], [0.0; 6]);
    for (a, b) in at(&scaled).into_iter().zip(before) {
        assert!((a - 1.1 * b).abs() < 1e-15);
    }
}
