//! `--engine ray`: the Python package has the engine, and is asked to do the work.

use std::io::Write as _;
use std::process::{Command, Stdio};

use phugoid_fleet::run::Summary;
use serde_json::Value;

use crate::failure::Failure;

/// Reads what is asked for from standard input, and prints the summary as its last line.
const PROGRAM: &str = "import json, sys, phugoid
request = json.load(sys.stdin)
print(json.dumps(getattr(phugoid, request.pop('function'))(**request)))";

/// Lets tasks of Ray make the runs of this command, each as one of its shards. They leave them in the store.
pub(super) fn shards(address: Option<&str>) -> Result<(), Failure> {
    let program = std::env::current_exe().map_err(|error| Failure::impossible(format!("--engine ray: {error}")))?;
    let mut words = Vec::new();
    let mut given = std::env::args_os().skip(1);
    while let Some(word) = given.next() {
        // The engine is that of this process, not of its shards.
        match word.to_str() {
            Some("--engine") => drop(given.next()),
            Some(word) if word.starts_with("--engine=") => {}
            Some(word) => words.push(word.to_owned()),
            None => return Err(Failure::input(format!("--engine ray: `{}` is no text", word.display()))),
        }
    }
    let folder = std::env::current_dir().map_err(|error| Failure::impossible(format!("--engine ray: {error}")))?;
    let request = serde_json::json!({ "program": program, "arguments": words, "folder": folder, "address": address });
    ask::<Value>("command_shards", request).map(drop)
}

/// Asks a function of the Python package (`fleet`, `campaign`), which takes what stands in the object `request` by name.
pub(super) fn run(function: &str, request: Value) -> Result<Summary, Failure> {
    ask(function, request)
}

fn ask<T: serde::de::DeserializeOwned>(function: &str, mut request: Value) -> Result<T, Failure> {
    let python = std::env::var_os("PHUGOID_PYTHON").unwrap_or_else(|| "python3".into());
    request["function"] = function.into();
    let failed = |why: String| {
        Failure::impossible(format!(
            "--engine ray: {why}\nIt needs Python with the package: pip install \"phugoid[fleet]\". PHUGOID_PYTHON names another \
             Python than python3."
        ))
    };
    let named = python.display();
    let mut child = Command::new(&python)
        .args(["-c", PROGRAM])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| failed(format!("`{named}` cannot be started: {error}")))?;
    if let Some(mut input) = child.stdin.take() {
        // Python that ended before it had read this says why by itself.
        let _ = input.write_all(request.to_string().as_bytes());
    }
    let output = child.wait_with_output().map_err(|error| failed(format!("`{named}`: {error}")))?;
    if !output.status.success() {
        return Err(failed(format!("`{named}` ended with {}; its message stands above", output.status)));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let last = text.lines().last().unwrap_or_default();
    serde_json::from_str(last).map_err(|error| failed(format!("`{named}` gave no summary: {error}")))
}
