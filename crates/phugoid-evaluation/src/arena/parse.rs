//! Arena files: a scenario and a model in one, told as what differs from another one.

use phugoid_identification::model_file::{Base, ModelFile, Source, Thrust};
use serde::Deserialize;
use toml::{Table, Value};

use super::entry::{BUILT_IN, Entry, SilentErrors};
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
    errors: Option<Table>,
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
    let errors = match head.errors {
        None => None,
        Some(table) => Some(errors(table, &head.model, &model, id)?),
    };
    let cycle_s = head.cycle.si();
    if cycle_s <= 0.0 {
        return Err(refused("`cycle` is the period in which times are counted: positive".to_owned()));
    }
    Ok(Entry { id: id.to_owned(), title: head.title, shows: head.shows, scenario, errors, model, cycle_s })
}

/// The section `[errors]` beside a model: the keys of `[uncertainty]`, and whether the errors are `drawn`.
fn errors(mut table: Table, beside: &Table, model: &ModelFile, id: &str) -> Result<SilentErrors, ScenarioError> {
    let refused = |message: String| ScenarioError::OutOfRange { place: format!("{id} [errors]"), message };
    let drawn = match table.remove("drawn") {
        None => false,
        Some(Value::Boolean(drawn)) => drawn,
        Some(other) => return Err(refused(format!("`drawn` is true or false, not {other}"))),
    };
    if let Some(key) = ["base", "learn", "propagation"].into_iter().find(|key| table.contains_key(*key)) {
        return Err(refused(format!("`{key}` is nothing that can be put into a flight")));
    }
    // The reader of model files knows keys and units.
    let mut with = beside.clone();
    with.insert("uncertainty".to_owned(), Value::Table(table));
    let text = toml::to_string(&with).map_err(|e| refused(e.to_string()))?;
    let sizes = ModelFile::parse(&format!("{id} [errors]"), &text).map_err(|e| refused(e.to_string()))?.uncertainty;
    if sizes.thrust > 0.0 && model.aircraft.thrust == Thrust::Trim {
        return Err(refused(
            "an error of the thrust needs a thrust that is known: `thrust` under [model.aircraft] is \"trim\""
                .to_owned(),
        ));
    }
    let aircraft = &model.aircraft;
    for (key, size, source) in [("mass", sizes.mass, &aircraft.mass), ("inertia", sizes.inertia, &aircraft.iyy)] {
        if let (true, Source::Channel(channel)) = (size > 0.0, source) {
            return Err(refused(format!(
                "an error of the {key} needs a number under [model.aircraft], which here is the channel `{channel}`"
            )));
        }
    }
    if sizes.centre_of_gravity > 0.0
        && (model.base == Base::Aircraft || (model.base == Base::F16 && model.aircraft.cg.is_none()))
    {
        return Err(refused(
            "an error of the centre of gravity needs a model without `base`, or the base \"f16\" with `cg` under [model.aircraft]"
                .to_owned(),
        ));
    }
    Ok(SilentErrors { sizes, drawn })
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
    use phugoid_identification::estimation::UncertainQuantity;

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
    fn each_error_has_an_entry_and_is_as_large_as_it_says() {
        let of = |id: &str| parse(BUILT_IN.iter().find(|(known, _)| *known == id).unwrap().1, id).unwrap();
        let single: Vec<Entry> =
            BUILT_IN.iter().filter(|(id, _)| id.starts_with("silent-")).map(|(id, _)| of(id)).collect();
        for quantity in UncertainQuantity::ALL.into_iter().filter(|q| *q != UncertainQuantity::BaseTables) {
            let alone = single.iter().filter(|entry| {
                let Some(errors) = entry.errors else { return false };
                let wrong = |q: &UncertainQuantity| errors.sizes.of_quantity(*q) > 0.0;
                wrong(&quantity) && UncertainQuantity::ALL.iter().filter(|q| wrong(q)).count() == 1
            });
            let [entry] = alone.collect::<Vec<_>>()[..] else { panic!("{quantity:?}") };
            let declared = entry.model.uncertainty.of_quantity(quantity);
            let ratio = entry.errors.unwrap().sizes.of_quantity(quantity) / declared;
            let expected = if quantity == UncertainQuantity::Geometry { 1.0 } else { 1.5 };
            assert!((ratio - expected).abs() < 0.002, "{}: {ratio} of what is declared", entry.id);
        }
        let drawn = of("silent-drawn");
        let errors = drawn.errors.unwrap();
        assert!(errors.drawn && errors.of_flight(1000) != errors.of_flight(1001));
        assert_eq!(errors.sizes.mass, drawn.model.uncertainty.mass);
        assert!(of("silent-none").errors.is_none() && of("calm").errors.is_none());
    }

    #[test]
    fn mistakes_are_told() {
        let message = parse("extends = \"clam\"", "mine").unwrap_err().to_string();
        assert!(message.contains("did you mean `calm`"), "{message}");
        let message = parse("extends = \"calm\"\n[scenario.sensors]\nalfa = {}", "mine").unwrap_err().to_string();
        assert!(message.contains("did you mean `alpha`"), "{message}");
        let message = parse("extends = \"calm\"\n[model.noise]\nalpha = \"0.1 kg\"", "mine").unwrap_err().to_string();
        assert!(message.contains("mine [model]") && message.contains("kg"), "{message}");
        let errors = |text: &str, base: &str| {
            parse(&format!("extends = \"{base}\"\n[errors]\n{text}"), "mine").unwrap_err().to_string()
        };
        let message = errors("thrust = 0.05", "calm");
        assert!(message.contains("mine [errors]") && message.contains("\"trim\""), "{message}");
        let message = errors("mass = 0.05\n[model.aircraft]\nmass = { channel = \"mass\" }", "silent-none");
        assert!(message.contains("an error of the mass needs a number"), "{message}");
        assert!(errors("mas = 0.05", "silent-none").contains("did you mean `mass`"));
        assert!(errors("drawn = 1", "silent-none").contains("true or false"));
        assert!(errors("learn = true", "silent-none").contains("`learn`"));
        assert!(errors("flow_angle_lag = \"2 kg\"", "silent-none").contains("kg"));
        let message = parse("title = \"x\"", "mine").unwrap_err().to_string();
        assert!(message.contains("missing field"), "{message}");
    }
}
