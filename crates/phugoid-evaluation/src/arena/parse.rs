//! Arena files: a scenario and a model in one, told as what differs from another one.

use phugoid_identification::model_file::ModelFile;
use serde::Deserialize;
use toml::{Table, Value};

use super::entry::{BUILT_IN, Entry};
use phugoid_simulation::quantity::Time;
use phugoid_simulation::scenario::{Scenario, ScenarioError, nearest, parse_toml};

/// What stands beside the scenario and the model.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    title: String,
    shows: String,
    cycle: Time,
    scenario: Table,
    model: Table,
}

/// Most files that may build on one another.
const LONGEST_CHAIN: usize = 8;

/// The entry that a text describes.
pub(super) fn parse(text: &str, id: &str) -> Result<Entry, ScenarioError> {
    let refused = |message: String| ScenarioError::OutOfRange { place: id.to_owned(), message };
    let whole = complete(text, id)?;
    let mut head: Head =
        Value::Table(whole).try_into().map_err(|e: toml::de::Error| refused(e.message().to_owned()))?;
    for table in [&mut head.scenario, &mut head.model] {
        table.entry("name").or_insert_with(|| Value::String(head.title.clone()));
    }
    let written = |table: &Table, what: &str| {
        toml::to_string(table).map_err(|e| refused(format!("[{what}] cannot be put together: {e}")))
    };
    // Both are read from text, so that a mistake is shown with its line and the nearest valid word.
    let scenario = Scenario::parse(&written(&head.scenario, "scenario")?, &format!("{id} [scenario]"))?;
    let model = ModelFile::parse(&format!("{id} [model]"), &written(&head.model, "model")?)
        .map_err(|error| refused(error.to_string()))?;
    let cycle_s = head.cycle.si();
    if cycle_s <= 0.0 {
        return Err(refused("`cycle` is the period in which times are counted: positive".to_owned()));
    }
    Ok(Entry { id: id.to_owned(), title: head.title, shows: head.shows, scenario, model, cycle_s })
}

/// The text as a table, put upon those that it extends.
fn complete(text: &str, id: &str) -> Result<Table, ScenarioError> {
    let mut own: Table = parse_toml(text, id)?;
    let mut below = base_of(&mut own, id)?;
    let mut whole = own;
    for _ in 0..LONGEST_CHAIN {
        let Some((name, text)) = below else { return Ok(whole) };
        let mut base: Table = parse_toml(text, name)?;
        below = base_of(&mut base, name)?;
        merge(&mut base, whole);
        whole = base;
    }
    Err(ScenarioError::OutOfRange {
        place: id.to_owned(),
        message: format!("more than {LONGEST_CHAIN} files extend one another: do they go round in a circle?"),
    })
}

/// Takes `extends` out of a table and gives the name and text of what it names.
fn base_of(table: &mut Table, id: &str) -> Result<Option<(&'static str, &'static str)>, ScenarioError> {
    let refused = |message: String| ScenarioError::OutOfRange { place: id.to_owned(), message };
    let name = match table.remove("extends") {
        None => return Ok(None),
        Some(Value::String(name)) => name,
        Some(other) => return Err(refused(format!("`extends` names a built-in entry of the arena, not {other}"))),
    };
    let found = BUILT_IN.iter().find(|(known, _)| *known == name).copied();
    found.map(Some).ok_or_else(|| {
        let near = nearest(&name, BUILT_IN.iter().map(|(known, _)| *known));
        refused(match near {
            Some(near) => format!("no entry of the arena is called `{name}`: did you mean `{near}`?"),
            None => format!("no entry of the arena is called `{name}`: see `phugoid compare --list`"),
        })
    })
}

/// Puts `over` upon `base`: tables key by key, everything else as a whole. The word "none" in place of a table or a list
/// takes it away.
fn merge(base: &mut Table, over: Table) {
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            (Some(Value::Table(_) | Value::Array(_)), Value::String(word)) if word == "none" => {
                base.remove(&key);
            }
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_entry_reads_and_says_what_differs() {
        for (id, text) in BUILT_IN {
            let entry = parse(text, id).unwrap_or_else(|e| panic!("{e}"));
            assert!(!entry.title.is_empty() && entry.title.chars().count() <= 24, "{id}: {}", entry.title);
            assert!(entry.shows.ends_with(['.', '?']), "{id}");
            assert_eq!(entry.scenario.seed, 1000);
        }
    }

    #[test]
    fn what_is_not_named_stays_as_below() {
        let of = |id: &str| parse(BUILT_IN.iter().find(|(known, _)| *known == id).unwrap().1, id).unwrap();
        let (calm, late, rough) = (of("calm"), of("delay"), of("turbulence-moderate"));
        assert_eq!(late.scenario.sensors.alpha.noise, calm.scenario.sensors.alpha.noise);
        assert_eq!(late.scenario.sensors.alpha.delay.si(), 0.02);
        assert_eq!(late.model.noise, calm.model.noise);
        assert_eq!(rough.model.process_noise, of("turbulence-light").model.process_noise);
        assert_ne!(rough.model.process_noise, calm.model.process_noise);
        assert!(of("no-excitation").scenario.manoeuvre.is_empty());
        assert_eq!(of("biases-untold").model.parameters, calm.model.parameters);
    }

    #[test]
    fn mistakes_are_told() {
        let message = parse("extends = \"clam\"", "mine").unwrap_err().to_string();
        assert!(message.contains("did you mean `calm`"), "{message}");
        let message = parse("extends = \"calm\"\n[scenario.sensors]\nalfa = {}", "mine").unwrap_err().to_string();
        assert!(message.contains("did you mean `alpha`"), "{message}");
        let message = parse("extends = \"calm\"\n[model.noise]\nalpha = \"0.1 kg\"", "mine").unwrap_err().to_string();
        assert!(message.contains("mine [model]") && message.contains("kg"), "{message}");
        let message = parse("title = \"x\"", "mine").unwrap_err().to_string();
        assert!(message.contains("missing field"), "{message}");
    }
}
