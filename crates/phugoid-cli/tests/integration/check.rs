//! `phugoid check`: models in DAVE-ML against the check data in them.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};

/// A model of one line, whose check data say twice the input.
fn model(factor: &str) -> String {
    format!(
        r#"<?xml version="1.0"?>
<DAVEfunc xmlns="http://daveml.org/2010/DAVEML">
  <fileHeader name="twice"><author name="A" org="B"/><creationDate date="2026-01-01"/></fileHeader>
  <variableDef name="x" varID="x" units="nd"/>
  <variableDef name="y" varID="y" units="nd">
    <calculation><math xmlns="http://www.w3.org/1998/Math/MathML"><apply><times/><cn>{factor}</cn><ci>x</ci></apply></math></calculation>
    <isOutput/>
  </variableDef>
  <checkData>
    <staticShot name="one">
      <checkInputs><signal><varID>x</varID><signalValue>1.5</signalValue></signal></checkInputs>
      <checkOutputs><signal><varID>y</varID><signalValue>3</signalValue><tol>1e-9</tol></signal></checkOutputs>
    </staticShot>
  </checkData>
</DAVEfunc>
"#
    )
}

#[test]
fn a_model_is_held_against_its_own_check_data() {
    let folder = Folder::new("check");
    std::fs::write(folder.0.join("good.dml"), model("2")).unwrap();
    std::fs::write(folder.0.join("bad.dml"), model("2.5")).unwrap();
    let run = phugoid(&folder.0, &["check", "good.dml", "--json"]);
    assert_eq!((run.code, run.json()["models"][0]["shots_passed"].as_u64()), (Some(0), Some(1)), "{}", run.err);
    let run = phugoid(&folder.0, &["check", "good.dml", "bad.dml"]);
    assert_eq!(run.code, Some(1));
    assert!(run.out.contains("Not within the tolerance: bad.dml") && run.out.contains("3.75"), "{}", run.out);
    std::fs::write(folder.0.join("torn.dml"), &model("2")[..400]).unwrap();
    let run = phugoid(&folder.0, &["check", "torn.dml"]);
    assert!(run.code == Some(3) && run.err.contains("torn.dml"), "{}", run.err);
    // Never over the model.
    let run = phugoid(&folder.0, &["check", "good.dml", "--out", "good.dml"]);
    assert_eq!(run.code, Some(3), "{}", run.err);
}
