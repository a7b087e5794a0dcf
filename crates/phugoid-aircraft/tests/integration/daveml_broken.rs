//! Files that are wrong: every one is refused with what is wrong and its line, and none makes the reader panic.

use phugoid_aircraft::daveml::{DavemlError, Model};

use crate::daveml_standard::{formula, whole};
use crate::shared_data::shared_file;

const VARIABLES: &str = "<variableDef name=\"x\" varID=\"x\" units=\"\"/>\n<variableDef name=\"z\" varID=\"z\" units=\"\"/>\n\
                         <breakpointDef bpID=\"B\"><bpVals>1 2 3</bpVals></breakpointDef>\n";

fn function(defn: &str) -> String {
    whole(&format!(
        "{VARIABLES}<function name=\"f\"><independentVarRef varID=\"x\"/><dependentVarRef varID=\"z\"/>\n\
         <functionDefn>{defn}</functionDefn></function>"
    ))
}

fn table(breakpoints: &str, values: &str) -> String {
    function(&format!(
        "<griddedTableDef gtID=\"T\"><breakpointRefs>{breakpoints}</breakpointRefs>\n<dataTable>{values}</dataTable>\
         </griddedTableDef>"
    ))
}

#[test]
fn every_mistake_is_named_with_its_line() {
    let one = "<bpRef bpID=\"B\"/>";
    let cases: Vec<(String, &str)> = vec![
        ("<nothing/>".to_owned(), "line 1: the outermost element is <nothing>"),
        (whole("<engine/>"), "line 3: the element <engine> is not known inside <DAVEfunc>"),
        (
            whole("<variableDef varID=\"x\"><colour/></variableDef>"),
            "line 3: the element <colour> is not known inside <variableDef>",
        ),
        (whole("<variableDef name=\"x\"/>"), "line 3: <variableDef> has no attribute `varID`"),
        (
            whole("<variableDef varID=\"x\" initialValue=\"NaN\"/>"),
            "line 3: `NaN` in the attribute `initialValue` is not a finite number",
        ),
        (whole("<variableDef varID=\"x\" minValue=\"2\" maxValue=\"1\"/>"), "line 3: the lower limit 2 lies above"),
        (
            whole("<variableDef varID=\"x\"/>\n<variableDef varID=\"x\"/>"),
            "line 4: the variable `x` is defined a second time",
        ),
        (formula("<apply><gamma/><ci>x</ci></apply>"), "line 5: the element <gamma> is not known inside <apply>"),
        (formula("<apply><bessel/></apply>"), "line 5: the element <bessel>"),
        (formula("<apply><sin/><ci>x</ci><ci>x</ci></apply>"), "line 5: <sin> cannot have 2 operands"),
        (formula("<apply><divide/><ci>x</ci></apply>"), "line 5: <divide> cannot have 1 operands"),
        (formula("<apply><plus/></apply>"), "line 5: <plus> cannot have 0 operands"),
        (formula("<apply/>"), "line 5: <apply> has no"),
        (formula(""), "line 5: <math> has no"),
        (formula("<ci>q</ci>"), "line 5: there is no variable `q`"),
        (formula("<cn>1e999</cn>"), "line 5: `1e999` in <cn> is not a finite number"),
        (formula("<cn>one</cn>"), "line 5: `one` in <cn>"),
        (formula("<cn base=\"2\">1</cn>"), "line 5: a number in a base other than ten is not supported"),
        (
            formula("<cn type=\"complex-cartesian\">1</cn>"),
            "line 5: a number of type `complex-cartesian` is not supported",
        ),
        (
            formula("<apply><csymbol definitionURL=\"x#hypot\"/><ci>x</ci></apply>"),
            "line 5: the csymbol `hypot` is not supported",
        ),
        (formula("<piecewise><piece><ci>x</ci></piece></piecewise>"), "line 5: <piece> cannot have 1 operands"),
        (formula("<ci>z</ci>"), "line 5: variables depend on each other in a circle: z needs z"),
        (
            whole(
                "<variableDef varID=\"a\"><calculation><math><ci>b</ci></math></calculation></variableDef>\n\
                 <variableDef varID=\"b\"><calculation><math><ci>a</ci></math></calculation></variableDef>",
            ),
            "line 3: variables depend on each other in a circle: a needs b needs a",
        ),
        (function("<griddedTableRef gtID=\"missing\"/>"), "line 7: there is no table `missing`"),
        (function("<lookup/>"), "line 7: the element <lookup> is not known inside <functionDefn>"),
        (function(""), "line 7: <functionDefn> has no <griddedTableRef>"),
        (table("<bpRef bpID=\"C\"/>", "1"), "line 7: there are no breakpoints `C`"),
        (table(one, "1 2"), "line 7: the table has 2 values; its breakpoints ask for 3"),
        (table(one, "1 2 3 4"), "line 7: the table has 4 values; its breakpoints ask for 3"),
        (table(one, "1 nan 3"), "line 8: `nan` in <dataTable> is not a finite number"),
        (
            table(&one.repeat(2), "1 2 3 4 5 6 7 8 9"),
            "line 6: a function of 1 variables refers to a table of 2 dimensions",
        ),
        (table(&one.repeat(50), "1"), "line 7: 25 dimensions of a table; at most 24 are read"),
        (
            whole("<breakpointDef bpID=\"B\"><bpVals>1 3\n2</bpVals></breakpointDef>"),
            "line 3: the values 3 and 2 follow each other",
        ),
        (whole("<breakpointDef bpID=\"B\"><bpVals> </bpVals></breakpointDef>"), "line 3: the table has 0 values"),
        (
            whole(&format!("{VARIABLES}<breakpointDef bpID=\"B\"><bpVals>1</bpVals></breakpointDef>")),
            "line 6: the breakpoints `B` is defined a second time",
        ),
        (
            whole(&format!(
                "{VARIABLES}<function name=\"f\"><independentVarPts varID=\"x\">1 2</independentVarPts>\
                 <dependentVarPts varID=\"z\">1 2</dependentVarPts></function>\n<function name=\"g\">\
                 <independentVarPts varID=\"x\">1 2</independentVarPts><dependentVarPts varID=\"z\">1 2</dependentVarPts>\
                 </function>"
            )),
            "line 7: the variable `z` is computed a second time",
        ),
        (
            function("<ungriddedTable><dataPoint>1 2</dataPoint>\n<dataPoint>1 2 3</dataPoint></ungriddedTable>"),
            "line 8: the table has 3 values; its breakpoints ask for 2",
        ),
        (
            function("<ungriddedTable><dataPoint>1 2</dataPoint><dataPoint>1 3</dataPoint></ungriddedTable>"),
            "line 7: the values 1 and 1 follow each other",
        ),
        (
            whole(
                "<variableDef varID=\"x\"/>\n<checkData><staticShot name=\"s\"><checkInputs><signal><varID>q</varID>\
                   <signalValue>1</signalValue></signal></checkInputs></staticShot></checkData>",
            ),
            "line 4: there is no variable with the name or varID `q`",
        ),
        (
            whole(
                "<variableDef varID=\"x\"><calculation><math><cn>1</cn></math></calculation></variableDef>\n<checkData>\
                   <staticShot name=\"s\"><checkInputs><signal><varID>x</varID><signalValue>1</signalValue></signal>\
                   </checkInputs></staticShot></checkData>",
            ),
            "line 4: the variable `x` is computed and cannot be set",
        ),
        (
            "<DAVEfunc>\n<fileHeader>\n</DAVEfunc>".to_owned(),
            "it is no XML: expected 'fileHeader' tag, not 'DAVEfunc' at 3:1",
        ),
    ];
    for (text, message) in cases {
        let error = Model::parse(&text).map(|_| ()).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}\nexpected {message}\n{text}");
    }
}

/// A function of two or three variables over these points.
fn scattered(dimensions: usize, points: &[&str]) -> String {
    let names = ["x", "y", "w"];
    let variables = names.map(|name| format!("<variableDef varID=\"{name}\"/>")).concat();
    let references: String =
        names[..dimensions].iter().map(|x| format!("<independentVarRef varID=\"{x}\"/>")).collect();
    let points: String = points.iter().map(|point| format!("<dataPoint>{point}</dataPoint>")).collect();
    whole(&format!(
        "{variables}<variableDef varID=\"z\"/>\n<ungriddedTableDef utID=\"U\">{points}</ungriddedTableDef>\n<function \
         name=\"f\">{references}<dependentVarRef varID=\"z\"/><functionDefn><ungriddedTableRef utID=\"U\"/>\
         </functionDefn></function>"
    ))
}

#[test]
fn scattered_points_that_span_nothing() {
    for points in [
        &["0 0 1"][..],
        &["0 0 1", "1 1 2"],
        &["0 0 1", "1 1 2", "2 2 3"],
        &["0 0 1", "1 0 2", "0 1 3", "1 0 4"],
        &["0 0 1", "1e-320 0 2", "0 1e-320 3"],
    ] {
        let error = Model::parse(&scattered(2, points)).unwrap_err();
        assert!(matches!(error, DavemlError::Scattered { line: 4, .. }), "{error}");
    }
    // Whatever comes of coordinates whose products overflow, it is no panic.
    for points in [
        &["0 0 1", "1e200 0 2", "0 1e200 3", "1e200 1e200 4", "2e200 5e199 6"][..],
        &["0 0 1", "1e-200 0 2", "0 1e-200 3", "1e-200 1e-200 4", "1e-100 1e-200 4"],
        &["1e308 -1e308 1", "-1e308 1e308 2", "0 0 1", "1e308 1e308 1", "-1e308 -1e308 7"],
    ] {
        if let Ok(model) = Model::parse(&scattered(2, points)) {
            let mut evaluator = model.evaluator();
            for position in model.input_positions() {
                evaluator.set(*position, 1e150);
            }
            evaluator.run();
        }
    }
    let error = Model::parse(&scattered(3, &["0 0 0 1", "1 0 0 2", "0 1 0 3", "0 0 1 4"])).unwrap_err();
    assert_eq!(error.to_string(), "line 4: an ungridded table of 3 dimensions is not supported");
}

#[test]
fn large_nonsense_is_refused_quickly() {
    // A hundred megabytes of nesting.
    let deep = "<apply>".repeat(100_000_000 / 7);
    assert!(Model::parse(&format!("<DAVEfunc>{deep}")).is_err());
    let deep = format!("{}<ci>x</ci>{}", "<apply><abs/>".repeat(50_000), "</apply>".repeat(50_000));
    assert!(Model::parse(&formula(&deep)).unwrap_err().to_string().contains("nested more than"));
    // A chain of comparisons inside a chain of comparisons, and so on, doubles with each.
    let mut chain = "<ci>x</ci>".to_owned();
    for _ in 0..90 {
        chain = format!("<apply><eq/><cn>0</cn>{chain}<cn>1</cn></apply>");
    }
    let error = Model::parse(&formula(&chain)).unwrap_err();
    assert!(matches!(error, DavemlError::TooMany { line: 5, .. }), "{error}");
    // A chain of variables as long as a text has room for.
    let mut long = "<variableDef varID=\"v0\" initialValue=\"1\"/>".to_owned();
    for k in 1..20_000 {
        let calculation = format!("<calculation><math><ci>v{}</ci></math></calculation>", k - 1);
        long.insert_str(0, &format!("<variableDef varID=\"v{k}\">{calculation}</variableDef>"));
    }
    let model = Model::parse(&whole(&long)).unwrap();
    let mut evaluator = model.evaluator();
    evaluator.run();
    assert_eq!(evaluator.get(0), 1.0);
}

#[test]
fn torn_and_changed_files_are_no_reason_to_panic() {
    for name in ["daveml/twoD_ungridded.dml", "daveml/switch_logic.dml", "checks/daveml_s119/F16_prop.dml"] {
        let Some(file) = shared_file(name) else { return };
        let text = std::fs::read_to_string(file).unwrap();
        let mut state = 1_u64;
        let mut random = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for cut in (0..text.len()).step_by(37).filter(|cut| text.is_char_boundary(*cut)) {
            assert!(Model::parse(&text[..cut]).is_err(), "{name} cut at {cut}");
        }
        for _ in 0..400 {
            let mut bytes = text.clone().into_bytes();
            for _ in 0..=random(3) {
                let at = random(bytes.len());
                match random(3) {
                    0 => bytes[at] = b"0123456789.-e<>\"/ "[random(18)],
                    1 => drop(bytes.drain(at..(at + random(30)).min(bytes.len()))),
                    _ => {
                        let from = random(bytes.len());
                        let copied = bytes[from..(from + random(200)).min(bytes.len())].to_vec();
                        bytes.splice(at..at, copied);
                    }
                }
            }
            if let Ok(model) = Model::parse(&String::from_utf8_lossy(&bytes)) {
                let _ = model.check();
            }
        }
    }
}

#[test]
fn a_file_is_named_in_its_error() {
    let error = Model::open("nowhere.dml").unwrap_err().to_string();
    assert!(error.contains("nowhere.dml"), "{error}");
}
