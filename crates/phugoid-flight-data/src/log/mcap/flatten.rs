//! Finds the numbers in a JSON document and names them by their paths.

use serde_json::Value;

/// Largest number of values kept of one message. An image or a laser scan has more, and is no signal.
const MAX_NUMBERS: usize = 4096;

/// Writes the names and values of all numbers and truth values in a document, in its order. A null is a missing number
/// (NaN).
pub(super) fn flatten(document: &Value, names: &mut Vec<String>, values: &mut Vec<f64>) {
    names.clear();
    values.clear();
    walk(&mut String::new(), document, names, values);
}

fn walk(path: &mut String, value: &Value, names: &mut Vec<String>, values: &mut Vec<f64>) {
    if values.len() >= MAX_NUMBERS {
        return;
    }
    let length = path.len();
    match value {
        Value::Object(members) => {
            for (name, member) in members {
                if length > 0 {
                    path.push('.');
                }
                path.push_str(name);
                walk(path, member, names, values);
                path.truncate(length);
            }
        }
        Value::Array(elements) => {
            for (index, element) in elements.iter().enumerate().take(MAX_NUMBERS) {
                path.push_str(&format!("[{index}]"));
                walk(path, element, names, values);
                path.truncate(length);
            }
        }
        Value::Number(number) => push(path, number.as_f64().unwrap_or(f64::NAN), names, values),
        Value::Bool(truth) => push(path, f64::from(u8::from(*truth)), names, values),
        Value::Null => push(path, f64::NAN, names, values),
        Value::String(_) => {}
    }
}

fn push(path: &str, value: f64, names: &mut Vec<String>, values: &mut Vec<f64>) {
    names.push(if path.is_empty() { "value".to_owned() } else { path.to_owned() });
    values.push(value);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_numbers() {
        let text = r#"{"pose": {"x": 1.5, "q": [0, 0.5]}, "ok": true, "name": "n", "gone": null, "n": -3}"#;
        let (mut names, mut values) = (Vec::new(), Vec::new());
        flatten(&serde_json::from_str(text).unwrap(), &mut names, &mut values);
        let mut found: Vec<(&str, f64)> = names.iter().map(String::as_str).zip(values.iter().copied()).collect();
        found.sort_by(|a, b| a.0.cmp(b.0));
        assert_eq!(found.len(), 6);
        assert!(found[0].0 == "gone" && found[0].1.is_nan());
        assert_eq!(found[1..], [("n", -3.0), ("ok", 1.0), ("pose.q[0]", 0.0), ("pose.q[1]", 0.5), ("pose.x", 1.5)]);
        flatten(&Value::from(2.0), &mut names, &mut values);
        assert_eq!(names, ["value"]);
    }
}
