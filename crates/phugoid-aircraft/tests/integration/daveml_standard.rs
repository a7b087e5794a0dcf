//! What the standard asks for, in models written for it: MathML, interpolation, extrapolation, limits, check data.

use phugoid_aircraft::daveml::{Bound, DavemlError, Distribution, Effect, Model, Role};
use phugoid_flight_dynamics::scalar::Dual;

/// A model of these elements.
pub(crate) fn whole(elements: &str) -> String {
    format!(
        "<DAVEfunc>\n<fileHeader><author name=\"A\" org=\"B\"/><creationDate date=\"2026-01-01\"/></fileHeader>\n\
         {elements}\n</DAVEfunc>"
    )
}

/// A model with inputs `x` and `y` and an output `z` that is computed by this MathML.
pub(crate) fn formula(mathml: &str) -> String {
    whole(&format!(
        "<variableDef name=\"x\" varID=\"x\" units=\"nd\"/>\n<variableDef name=\"y\" varID=\"y\" units=\"nd\"/>\n\
         <variableDef name=\"z\" varID=\"z\" units=\"nd\"><calculation><math>{mathml}</math></calculation>\
         <isOutput/></variableDef>"
    ))
}

/// The value of the variable `z` with these values of `x` and `y`.
fn evaluate(text: &str, x: f64, y: f64) -> f64 {
    let model = Model::parse(text).unwrap_or_else(|error| panic!("{error}"));
    let mut evaluator = model.evaluator();
    for (name, value) in [("x", x), ("y", y)] {
        if let Ok(position) = model.input_position(name) {
            assert!(evaluator.set(position, value));
        }
    }
    evaluator.run();
    evaluator.get(model.position("z").unwrap())
}

#[test]
fn mathml_functions() {
    let (x, y) = (0.7_f64, 2.5_f64);
    let two = |function: &str| format!("<apply><{function}/><ci>x</ci><ci> y </ci></apply>");
    let one = |function: &str| format!("<apply><{function}/><ci>x</ci></apply>");
    for (mathml, expected) in [
        ("<cn>2.5</cn>".to_owned(), 2.5),
        ("<cn type=\"integer\">-3</cn>".to_owned(), -3.0),
        ("<cn type=\"e-notation\">1.5<sep/>2</cn>".to_owned(), 150.0),
        ("<cn type=\"rational\">3<sep/>4</cn>".to_owned(), 0.75),
        ("<cn type=\"constant\">pi</cn>".to_owned(), core::f64::consts::PI),
        ("<pi/>".to_owned(), core::f64::consts::PI),
        ("<exponentiale/>".to_owned(), core::f64::consts::E),
        ("<true/>".to_owned(), 1.0),
        ("<false/>".to_owned(), 0.0),
        ("<infinity/>".to_owned(), f64::INFINITY),
        (two("plus"), x + y),
        (two("minus"), x - y),
        (two("times"), x * y),
        (two("divide"), x / y),
        (two("power"), x.powf(y)),
        (two("min"), x),
        (two("max"), y),
        (two("quotient"), 0.0),
        (two("rem"), x),
        (two("and"), 1.0),
        (two("or"), 1.0),
        (two("xor"), 0.0),
        (two("implies"), 1.0),
        (two("eq"), 0.0),
        (two("neq"), 1.0),
        (two("lt"), 1.0),
        (two("gt"), 0.0),
        (two("leq"), 1.0),
        (two("geq"), 0.0),
        (two("csymbol definitionURL=\"http://daveml.org/function_spaces.html#atan2\" encoding=\"text\""), x.atan2(y)),
        ("<apply><csymbol>atan2</csymbol><ci>x</ci><ci>y</ci></apply>".to_owned(), x.atan2(y)),
        (one("minus"), -x),
        (one("plus"), x),
        (one("root"), x.sqrt()),
        (one("exp"), x.exp()),
        (one("ln"), x.ln()),
        (one("log"), x.log10()),
        (one("abs"), x),
        (one("floor"), 0.0),
        (one("ceiling"), 1.0),
        (one("not"), 0.0),
        (one("sin"), x.sin()),
        (one("cos"), x.cos()),
        (one("tan"), x.tan()),
        (one("sec"), 1.0 / x.cos()),
        (one("csc"), 1.0 / x.sin()),
        (one("cot"), 1.0 / x.tan()),
        (one("arcsin"), x.asin()),
        (one("arccos"), x.acos()),
        (one("arctan"), x.atan()),
        (one("sinh"), x.sinh()),
        (one("cosh"), x.cosh()),
        (one("tanh"), x.tanh()),
        (one("arcsinh"), x.asinh()),
        (one("arctanh"), x.atanh()),
        ("<apply><arccosh/><ci>y</ci></apply>".to_owned(), y.acosh()),
        ("<apply><factorial/><cn>5</cn></apply>".to_owned(), 120.0),
        ("<apply><root/><degree><cn>3</cn></degree><ci>y</ci></apply>".to_owned(), y.cbrt()),
        ("<apply><log/><logbase><cn>2</cn></logbase><ci>y</ci></apply>".to_owned(), y.log2()),
        ("<apply><plus/><ci>x</ci><ci>x</ci><ci>x</ci><ci>y</ci></apply>".to_owned(), 3.0 * x + y),
        ("<apply><lt/><cn>0</cn><ci>x</ci><ci>y</ci><cn>3</cn></apply>".to_owned(), 1.0),
        ("<apply><lt/><cn>0</cn><ci>y</ci><ci>x</ci></apply>".to_owned(), 0.0),
        ("<semantics><ci>x</ci><annotation>ex</annotation></semantics>".to_owned(), x),
    ] {
        let found = evaluate(&formula(&mathml), x, y);
        assert!(found == expected || (found - expected).abs() <= 1e-15 * expected.abs().max(1.0), "{mathml}: {found}");
    }
    assert!(evaluate(&formula("<notanumber/>"), x, y).is_nan());
}

#[test]
fn pieces_are_taken_in_their_order() {
    let text = formula(
        "<apply><piecewise>\
         <piece><cn>1</cn><apply><lt/><ci>x</ci><cn>0</cn></apply></piece>\
         <piece><apply><divide/><ci>y</ci><ci>x</ci></apply><apply><gt/><ci>x</ci><cn>2</cn></apply></piece>\
         <otherwise><apply><piecewise><piece><cn>3</cn><apply><eq/><ci>x</ci><cn>1</cn></apply></piece></piecewise>\
         </apply></otherwise></piecewise></apply>",
    );
    assert_eq!(evaluate(&text, -1.0, 8.0), 1.0);
    assert_eq!(evaluate(&text, 4.0, 8.0), 2.0);
    assert_eq!(evaluate(&text, 1.0, 8.0), 3.0);
    assert!(evaluate(&text, 1.5, 8.0).is_nan(), "no piece holds");
}

/// A function of `x` with these attributes over 1, 3, 4, 6, 7.5 and 2, 6, 5, 7, 1.5, as the figures of the reference
/// manual have it.
fn function(attributes: &str) -> String {
    whole(&format!(
        "<variableDef name=\"x\" varID=\"x\" units=\"nd\"/><variableDef name=\"z\" varID=\"z\" units=\"nd\"/>\
         <breakpointDef bpID=\"B\"><bpVals>1, 3, 4,<!-- and --> 6, 7.5</bpVals></breakpointDef>\
         <function name=\"f\"><independentVarRef varID=\"x\" {attributes}/><dependentVarRef varID=\"z\"/>\
         <functionDefn><griddedTable><breakpointRefs><bpRef bpID=\"B\"/></breakpointRefs>\
         <dataTable>2 6 <!-- peak --> 5 7 1.5</dataTable></griddedTable></functionDefn></function>"
    ))
}

#[test]
fn interpolation_and_extrapolation() {
    for (attributes, values) in [
        ("", [(0.0, 2.0), (2.0, 4.0), (6.75, 4.25), (9.0, 1.5)]),
        ("extrapolate=\"min\"", [(0.0, 0.0), (2.0, 4.0), (6.75, 4.25), (9.0, 1.5)]),
        ("extrapolate=\"max\"", [(0.0, 2.0), (2.0, 4.0), (6.75, 4.25), (9.0, -4.0)]),
        ("extrapolate=\"both\" min=\"2\" max=\"7\"", [(0.0, 0.0), (1.0, 2.0), (7.5, 1.5), (9.0, -4.0)]),
        ("extrapolate=\"neither\" min=\"2\" max=\"3.5\"", [(0.0, 4.0), (1.0, 4.0), (7.5, 5.5), (9.0, 5.5)]),
        ("min=\"2\" extrapolate=\"max\" max=\"3.5\"", [(0.0, 4.0), (1.0, 4.0), (7.5, 1.5), (9.0, -4.0)]),
        ("interpolate=\"discrete\"", [(0.0, 2.0), (2.0, 6.0), (3.4, 6.0), (9.0, 1.5)]),
        ("interpolate=\"floor\"", [(1.0, 2.0), (2.9, 2.0), (3.0, 6.0), (9.0, 1.5)]),
        ("interpolate=\"ceiling\"", [(1.0, 2.0), (1.1, 6.0), (3.0, 6.0), (3.1, 5.0)]),
        ("interpolate=\"floor\" extrapolate=\"both\"", [(0.0, 2.0), (2.9, 2.0), (7.4, 7.0), (9.0, 1.5)]),
        ("interpolate=\"cubicSpline\"", [(0.0, 2.0), (3.0, 6.0), (6.0, 7.0), (9.0, 1.5)]),
        ("interpolate=\"cubicSpline\" extrapolate=\"both\"", [(0.0, 0.0), (3.0, 6.0), (6.0, 7.0), (9.0, -4.0)]),
    ] {
        for (x, expected) in values {
            let found = evaluate(&function(attributes), x, 0.0);
            assert!((found - expected).abs() < 1e-12, "{attributes}, {x}: {found}, expected {expected}");
        }
        assert!(evaluate(&function(attributes), f64::NAN, 0.0).is_nan(), "{attributes}");
    }
    let refused = Model::parse(&function("interpolate=\"quadraticSpline\"")).unwrap_err();
    assert!(matches!(refused, DavemlError::Unsupported { line: 3, .. }), "{refused}");
}

/// In three dimensions, the last variable varies fastest; a plane is reproduced, and its slopes.
#[test]
fn grids_of_several_dimensions() {
    let (a, b, c) = ([0.0, 1.0, 3.0], [10.0, 20.0], [-1.0, 0.0, 0.5, 2.0]);
    let value = |x: f64, y: f64, w: f64| 1.0 + 2.0 * x - 0.3 * y + 5.0 * w + 0.1 * x * y * w;
    let mut values = String::new();
    for x in a {
        for y in b {
            values.extend(c.map(|w| format!("{}, ", value(x, y, w))));
        }
    }
    let points = |id: &str, points: &[f64]| {
        let points: Vec<String> = points.iter().map(ToString::to_string).collect();
        format!("<independentVarPts varID=\"{id}\">{}</independentVarPts>", points.join(" "))
    };
    let text = whole(&format!(
        "<variableDef name=\"x\" varID=\"x\" units=\"nd\"/><variableDef name=\"y\" varID=\"y\" units=\"nd\"/>\
         <variableDef name=\"w\" varID=\"w\" units=\"nd\"/><variableDef name=\"z\" varID=\"z\" units=\"nd\"/>\
         <function name=\"f\">{}{}{}<dependentVarPts varID=\"z\">{values}</dependentVarPts></function>",
        points("x", &a),
        points("y", &b),
        points("w", &c)
    ));
    let model = Model::parse(&text).unwrap();
    let mut evaluator = model.evaluator_of::<Dual<3>>();
    let positions = ["x", "y", "w"].map(|name| model.input_position(name).unwrap());
    for at in [[0.0, 10.0, -1.0], [0.3, 12.0, 0.2], [2.9, 19.0, 1.9], [3.0, 20.0, 2.0], [1.0, 15.0, 0.5]] {
        for k in 0..3 {
            assert!(evaluator.set(positions[k], Dual::variable(at[k], k)));
        }
        evaluator.run();
        let found = evaluator.get(model.position("z").unwrap());
        let [x, y, w] = at;
        assert!((found.value - value(x, y, w)).abs() < 1e-12, "{at:?}");
        let slopes = [2.0 + 0.1 * y * w, -0.3 + 0.1 * x * w, 5.0 + 0.1 * x * y];
        for k in 0..3 {
            assert!((found.derivatives[k] - slopes[k]).abs() < 1e-12, "{at:?}, {k}");
        }
    }
}

#[test]
fn ungridded_tables_of_one_dimension_in_any_order() {
    let text = whole(
        "<variableDef name=\"x\" varID=\"x\" units=\"nd\"/><variableDef name=\"z\" varID=\"z\" units=\"nd\"/>\
         <ungriddedTableDef utID=\"U\"><dataPoint>3 6</dataPoint><dataPoint modID=\"A\">1, 2<!-- first --></dataPoint>\
         <dataPoint> 4 5 </dataPoint></ungriddedTableDef>\
         <function name=\"f\"><independentVarRef varID=\"x\" extrapolate=\"both\"/><dependentVarRef varID=\"z\"/>\
         <functionDefn><ungriddedTableRef utID=\" U\"/></functionDefn></function>",
    );
    for (x, z) in [(0.0, 0.0), (2.0, 4.0), (3.5, 5.5), (5.0, 4.0)] {
        assert!((evaluate(&text, x, 0.0) - z).abs() < 1e-12);
    }
}

#[test]
fn limits_hold_downstream_of_everything() {
    let text = whole(
        "<variableDef name=\"x\" varID=\"x\" units=\"nd\" minValue=\"-1\" maxValue=\"1\"><isInput/></variableDef>\
         <variableDef name=\"z\" varID=\"z\" units=\"nd\" maxValue=\"1.5\"><calculation><math>\
         <apply><times/><cn>2</cn><ci>x</ci></apply></math></calculation></variableDef>",
    );
    for (x, z) in [(-5.0, -2.0), (0.5, 1.0), (1.0, 1.5)] {
        assert_eq!(evaluate(&text, x, 0.0), z);
    }
    assert!(evaluate(&text, f64::NAN, 0.0).is_nan());
}

/// Names of a shot are those of variables or their identifiers, units may differ, and what is not listed is as in the
/// file.
#[test]
fn check_data_in_every_form() {
    let text = whole(
        "<variableDef name=\"angle\" varID=\"a\" units=\"deg\"><isInput/></variableDef>\
         <variableDef name=\"offset\" varID=\"o\" units=\"deg\" initialValue=\"10\"><isInput/></variableDef>\
         <variableDef name=\"sum\" varID=\"s\" units=\"deg\"><calculation><math><apply><plus/><ci>a</ci><ci>o</ci>\
         </apply></math></calculation><isOutput/></variableDef>\
         <checkData><provenance/><staticShot name=\"by name\"><checkInputs><signal><signalName>angle</signalName>\
         <signalUnits>rad</signalUnits><signalValue>0.1</signalValue></signal></checkInputs>\
         <checkOutputs><signal><signalName>sum</signalName><signalUnits>deg</signalUnits>\
         <signalValue>15.72957795</signalValue><signalValue></signalValue><tol>1e-7</tol></signal></checkOutputs>\
         </staticShot><staticShot name=\"by identifier\"><checkInputs><signal><varID>a</varID>\
         <signalValue>1</signalValue></signal><signal><signalID>o</signalID><signalValue>2</signalValue></signal>\
         </checkInputs><internalValues><signal><varID>s</varID><signalValue>9</signalValue></signal></internalValues>\
         <checkOutputs><signal><varID>s</varID><signalValue>3</signalValue></signal></checkOutputs></staticShot>\
         <staticShot name=\"nothing set\"><checkOutputs><signal><varID>s</varID><signalValue>3</signalValue>\
         </signal></checkOutputs></staticShot></checkData>",
    );
    let model = Model::parse(&text).unwrap();
    let report = model.check();
    let passed: Vec<bool> = report.shots.iter().map(|shot| shot.passed()).collect();
    assert_eq!(passed, [true, true, false], "{report:?}");
    assert!(!report.passed() && report.shots_passed() == 2 && !report.shots[1].internals_passed());
    assert!(report.shots[2].signals[0].found.is_nan());
    assert_eq!(report.failures().count(), 2);
}

#[test]
fn inputs_and_outputs_without_marks() {
    let text = whole(
        "<variableDef name=\"alpha\" varID=\"alpdeg\" units=\"deg\"/><variableDef name=\"CL\" varID=\"cl\" units=\"\"/>\
         <variableDef name=\"gain\" varID=\"k\" units=\"\" initialValue=\"2\"/>\
         <function name=\"CL\"><independentVarPts varID=\"alpdeg\">-4.0, 0., 4.0, 8.0</independentVarPts>\
         <dependentVarPts varID=\"cl\">0.0, 0.2, 0.4, 0.8</dependentVarPts></function>",
    );
    let model = Model::parse(&text).unwrap();
    assert_eq!(model.inputs().map(|variable| variable.id.as_str()).collect::<Vec<_>>(), ["alpdeg"]);
    assert_eq!(model.outputs().map(|variable| variable.id.as_str()).collect::<Vec<_>>(), ["cl"]);
    assert_eq!(model.variable("gain").unwrap().role, Role::Constant);
    assert!(model.input_position("gain").is_ok(), "a constant can be set");
}

#[test]
fn uncertainties_are_read() {
    let text = whole(
        "<variableDef name=\"a\" varID=\"a\" units=\"\" initialValue=\"-4\"><uncertainty effect=\"percentage\">\
         <normalPDF numSigmas=\"3\"><bounds>30</bounds><correlatesWith varID=\"b\"/></normalPDF></uncertainty>\
         </variableDef><variableDef name=\"b\" varID=\"b\" units=\"\" initialValue=\"1\"><uncertainty effect=\"additive\">\
         <uniformPDF><bounds>0.50</bounds><bounds>0.10</bounds></uniformPDF></uncertainty></variableDef>\
         <breakpointDef bpID=\"B\"><bpVals>0 1</bpVals></breakpointDef>\
         <variableDef name=\"x\" varID=\"x\" units=\"\"/><variableDef name=\"z\" varID=\"z\" units=\"\"/>\
         <function name=\"f\"><independentVarRef varID=\"x\"/><dependentVarRef varID=\"z\"/><functionDefn>\
         <griddedTableDef><breakpointRefs><bpRef bpID=\"B\"/></breakpointRefs><uncertainty effect=\"multiplicative\">\
         <normalPDF numSigmas=\"2\"><bounds><dataTable>0.1 0.2</dataTable></bounds></normalPDF></uncertainty>\
         <dataTable>5 6</dataTable></griddedTableDef></functionDefn></function>",
    );
    let model = Model::parse(&text).unwrap();
    let doubt = model.variable("a").unwrap().uncertainty.clone().unwrap();
    assert_eq!(doubt.effect, Effect::Percentage);
    assert!((doubt.standard_deviation(-4.0).unwrap() - 0.4).abs() < 1e-15);
    let doubt = model.variable("b").unwrap().uncertainty.clone().unwrap();
    assert!((doubt.standard_deviation(1.0).unwrap() - 0.6 / 12.0_f64.sqrt()).abs() < 1e-15);
    let doubt = model.functions()[0].uncertainty.clone().unwrap();
    assert!(doubt.standard_deviation(1.0).is_none());
    let Distribution::Normal { sigmas, bound: Bound::Table(bound), .. } = doubt.distribution else { panic!() };
    assert_eq!((sigmas, &*bound), (2.0, &[0.1, 0.2][..]));
}

#[test]
fn every_namespace_is_read() {
    for root in [
        "<DAVEfunc xmlns=\"http://daveml.org/2010/DAVEML\">",
        "<DAVEfunc>",
        "<!DOCTYPE DAVEfunc SYSTEM \"http://nowhere.invalid/DAVEfunc.dtd\"><DAVEfunc xmlns=\"http://example.com/draft\">",
    ] {
        let text = format!(
            "<?xml version=\"1.0\"?>{root}<fileHeader/><variableDef name=\"z\" varID=\"z\" units=\"\"><calculation>\
             <m:math xmlns:m=\"http://www.w3.org/1998/Math/MathML\"><m:cn>3</m:cn></m:math></calculation>\
             </variableDef></DAVEfunc>"
        );
        assert_eq!(evaluate(&text, 0.0, 0.0), 3.0);
    }
}
