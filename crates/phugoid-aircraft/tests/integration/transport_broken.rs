//! Files of the Generic Transport Model that are wrong: each is refused with its name and the key.

use std::path::{Path, PathBuf};

use phugoid_aircraft::transport::{Transport, TransportError};
use serde_json::{Value, json};

use crate::jsbsim::text_of;
use crate::transport::folder;

/// A copy of the data that a test may spoil, removed at the end.
struct Copy(PathBuf);

impl Copy {
    fn of(folder: &Path) -> Self {
        let copy = std::env::temp_dir().join(format!("phugoid-transport-{}", std::process::id()));
        std::fs::create_dir_all(copy.join("tables")).unwrap();
        for entry in std::fs::read_dir(folder.join("tables")).unwrap() {
            let entry = entry.unwrap();
            std::fs::write(copy.join("tables").join(entry.file_name()), std::fs::read(entry.path()).unwrap()).unwrap();
        }
        std::fs::write(copy.join("vehicle.json"), std::fs::read(folder.join("vehicle.json")).unwrap()).unwrap();
        Self(copy)
    }

    /// The message with another text in a file, which is put back.
    fn message(&self, file: &str, text: &[u8]) -> String {
        let file = self.0.join(file);
        let whole = std::fs::read(&file).unwrap();
        std::fs::write(&file, text).unwrap();
        let message = Transport::open(&self.0).map(|_| ()).expect_err("a file that is wrong").to_string();
        std::fs::write(&file, whole).unwrap();
        message
    }
}

impl Drop for Copy {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn every_mistake_is_named_with_file_and_key() {
    let Some(folder) = folder() else { return };
    let copy = Copy::of(&folder);
    let check = |file: &str, text: &[u8], expected: &str| {
        let message = copy.message(file, text);
        println!("{message}");
        let name = Path::new(file).file_name().unwrap().to_str().unwrap();
        assert!(message.contains(name) && message.contains(expected), "{file}: {message}\nexpected {expected}");
    };
    let texts = |file: &str| text_of(&folder.join(file));

    // What is no JSON: cut off, a number beyond the range, what is no number, deep nesting, nothing.
    let basic = texts("tables/basic.json");
    check("tables/basic.json", &basic.as_bytes()[..basic.len() / 2], "line 1 column");
    check("tables/basic.json", basic.replacen("0.016539841", "1e999", 1).as_bytes(), "number out of range");
    check("tables/basic.json", basic.replacen("0.016539841", "NaN", 1).as_bytes(), "line 1 column");
    check("tables/basic.json", "[".repeat(100_000).as_bytes(), "recursion limit");
    check("tables/basic.json", b"", "line 1 column 0");
    check("tables/basic.json", &vec![b' '; 5 << 20], "larger than");
    check("tables/basic.json", b"[1]", "components: missing");

    // Values that do not belong together.
    type Spoil = fn(&mut Value);
    let cases: [(&str, Spoil, &str); 22] = [
        ("tables/basic.json", |v| v["data"].as_array_mut().unwrap().truncate(7), "data: has 7 numbers, the axes need"),
        ("tables/basic.json", |v| v["data"][3] = json!("one"), "data[3]: expected a finite number"),
        ("tables/basic.json", |v| v["data"][3] = Value::Null, "data[3]: expected a finite number"),
        ("tables/basic.json", |v| v["shape"][1] = json!(28), "shape: is"),
        ("tables/basic.json", |v| v["axes"][0]["values"][2] = json!(0.0), "axes[0].values: expected at least two"),
        ("tables/basic.json", |v| v["axes"][1]["name"] = json!("gamma"), "axes[1].name: is \"gamma\""),
        ("tables/basic.json", |v| v["axes"].as_array_mut().unwrap().truncate(1), "axes: 1 axes, expected 2"),
        ("tables/basic.json", |v| v["components"][4] = json!("CM"), "components[4]: is \"CM\", expected \"Cm\""),
        ("tables/aileron_right.json", |v| v["axes"][0]["values"][1] = json!(0.5), "axes: angle of attack and sideslip"),
        ("tables/rotary_balance.json", |v| drop(v.as_object_mut().unwrap().remove("data")), "data: missing"),
        (
            "tables/damage_static_increment.json",
            |v| v["axes"][2]["values"].as_array_mut().unwrap().swap(0, 1),
            "axes[2].values[0]: is \"Vertical Tail Off\", expected \"Rudder Off\"",
        ),
        ("tables/flaps.json", |v| v["left_inboard"] = json!([1, 2]), "left_inboard: has 2 numbers, expected 6"),
        ("vehicle.json", |v| drop(v.as_object_mut().unwrap().remove("weight_lb")), "weight_lb: missing"),
        ("vehicle.json", |v| v["S_ft2"] = json!(-1.0), "S_ft2: is -1, expected a positive number"),
        ("vehicle.json", |v| v["cg_ft"] = json!([1.0, 2.0]), "cg_ft: has 2 numbers, expected 3"),
        ("vehicle.json", |v| v["inertia_slug_ft2"]["Ixz"] = json!(true), "inertia_slug_ft2.Ixz: expected a finite"),
        ("vehicle.json", |v| v["fuel"]["aft_lb"] = json!(90), "fuel: heavier than the aircraft"),
        ("vehicle.json", |v| v["damage"].as_array_mut().unwrap().truncate(5), "damage: has 5 cases, expected 6"),
        ("vehicle.json", |v| v["damage"][1]["case"] = json!(3), "damage[1].case: expected 2 (vertical-tail-off)"),
        (
            "vehicle.json",
            |v| v["damage"][3]["surfaces_gone"][0] = json!("wing"),
            "damage[3].surfaces_gone[0]: a surface",
        ),
        (
            "vehicle.json",
            |v| v["engines"]["thrust_table"]["handle_percent"][1] = json!(-1.0),
            "engines.thrust_table.handle_percent: expected at least two",
        ),
        (
            "vehicle.json",
            |v| v["engines"]["thrust_table"]["thrust_lb"] = json!([1.0]),
            "engines.thrust_table.thrust_lb: has 1 numbers",
        ),
    ];
    for (file, spoil, expected) in cases {
        let mut value: Value = serde_json::from_str(&texts(file)).unwrap();
        spoil(&mut value);
        check(file, value.to_string().as_bytes(), expected);
    }

    // An aircraft without inertia is refused by its damage, a file that is not there by its name.
    let mut value: Value = serde_json::from_str(&texts("vehicle.json")).unwrap();
    value["inertia_slug_ft2"]["Ixx"] = json!(0.0);
    assert!(copy.message("vehicle.json", value.to_string().as_bytes()).contains("positive definite"));
    std::fs::remove_file(copy.0.join("tables/rudder_negative.json")).unwrap();
    let error = Transport::open(&copy.0).expect_err("a file is missing");
    assert!(
        matches!(&error, TransportError::Read { file, .. } if file.ends_with("tables/rudder_negative.json")),
        "{error}"
    );
}
