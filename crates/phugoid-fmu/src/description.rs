//! `modelDescription.xml`: what an importing program learns of an FMU before it runs it (FMI 3.0, section 2.4).

use std::fmt::Write as _;

use phugoid_aircraft::xml::escaped;

use crate::point::Point;
use crate::variables::{Direction, NOMINALS, Role, TIME, Unit, Variability, Variable, variables};

/// What of a model description differs from one FMU to the next.
pub(crate) struct Model<'a> {
    pub(crate) name: &'a str,
    pub(crate) identifier: &'a str,
    pub(crate) token: &'a str,
    pub(crate) description: &'a str,
    pub(crate) licence: &'a str,
    pub(crate) start: &'a Point,
}

/// Time between communication points, s, and length of a first simulation, s, that are proposed.
const STEP_S: f64 = 0.01;
const STOP_S: f64 = 10.0;

/// The text of the file.
pub(crate) fn text(model: &Model<'_>) -> String {
    let Model { name, identifier, token, description, licence, start } = model;
    let version = env!("CARGO_PKG_VERSION");
    let [name, token, description, licence] = [name, token, description, licence].map(|text| escaped(text));
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"3.0\" modelName=\"{name}\" instantiationToken=\"{token}\"\n  \
         description=\"{description}\"\n  license=\"{licence}\"\n  \
         generationTool=\"Phugoid {version}\" variableNamingConvention=\"structured\">\n  \
         <ModelExchange modelIdentifier=\"{identifier}\" needsCompletedIntegratorStep=\"true\"\n    \
         canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n  \
         <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\"\n    \
         canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n"
    );
    text.push_str("  <UnitDefinitions>\n");
    for unit in UNITS {
        text.push_str(&unit_definition(unit));
    }
    text.push_str("  </UnitDefinitions>\n  <LogCategories>\n");
    for (category, what) in [
        ("logStatusWarning", "The flight has left what the aircraft has data for; refused calls of optional functions"),
        ("logStatusError", "What is wrong with a call, and what to do"),
    ] {
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(text, "    <Category name=\"{category}\" description=\"{what}\"/>");
    }
    let _ = write!(
        text,
        "  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{STOP_S}\" stepSize=\"{STEP_S}\"/>\n  \
         <ModelVariables>\n"
    );
    for variable in variables() {
        text.push_str(&element(variable, start));
    }
    text.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    for (kind, outputs, rates) in
        [("Output", true, false), ("ContinuousStateDerivative", false, true), ("InitialUnknown", true, true)]
    {
        let belongs = |variable: &&Variable| outputs && is_output(variable) || rates && is_rate(variable);
        for variable in variables().iter().filter(belongs) {
            let _ = writeln!(text, "    <{kind} valueReference=\"{}\"/>", variable.reference);
        }
    }
    text.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    text
}

fn is_output(variable: &Variable) -> bool {
    variable.direction() == Direction::Output
}

fn is_rate(variable: &Variable) -> bool {
    matches!(variable.role, Role::Rate(_))
}

/// The element of a variable. Numbers are written so that they are read back to the last bit.
fn element(variable: &Variable, start: &Point) -> String {
    let mut attributes = format!(
        "name=\"{}\" valueReference=\"{}\" causality=\"{}\"",
        escaped(&variable.name),
        variable.reference,
        match variable.direction() {
            Direction::Independent => "independent",
            Direction::Input => "input",
            Direction::Parameter => "parameter",
            Direction::Local => "local",
            Direction::Output => "output",
        }
    );
    let variability = match variable.variability() {
        Variability::Continuous => "continuous",
        Variability::Tunable => "tunable",
        Variability::Fixed => "fixed",
    };
    let mut add = |name: &str, value: &str| {
        let _ = write!(attributes, " {name}=\"{value}\"");
    };
    add("variability", variability);
    match variable.role {
        Role::State(_) => add("initial", "exact"),
        Role::Rate(_) | Role::Output(_) => add("initial", "calculated"),
        _ => {}
    }
    if let Some(name) = unit_name(variable.unit) {
        add("unit", name);
        if let Some((display, _)) = display(variable.unit) {
            add("displayUnit", display);
        }
    }
    match variable.role {
        Role::State(i) => add("nominal", &NOMINALS[i].to_string()),
        Role::Rate(i) => add("derivative", &reference_of_state(i).to_string()),
        Role::Control(0) => {
            add("min", "0");
            add("max", "1");
        }
        _ => {}
    }
    if variable.reference != TIME
        && let Some(value) = start.value(&variable.role)
    {
        add("start", &value.to_string());
    }
    add("description", &escaped(&variable.description));
    format!("    <Float64 {attributes}/>\n")
}

/// The reference of a state.
fn reference_of_state(place: usize) -> u32 {
    let is_it = |variable: &&Variable| matches!(variable.role, Role::State(i) if i == place);
    variables().iter().find(is_it).map_or(TIME, |variable| variable.reference)
}

const UNITS: [Unit; 13] = [
    Unit::Second,
    Unit::Metre,
    Unit::MetrePerSecond,
    Unit::MetrePerSecondSquared,
    Unit::Radian,
    Unit::RadianPerSecond,
    Unit::RadianPerSecondSquared,
    Unit::PerRadian,
    Unit::Percent,
    Unit::PercentPerSecond,
    Unit::Newton,
    Unit::Pascal,
    Unit::KilogramPerCubicMetre,
];

fn unit_name(unit: Unit) -> Option<&'static str> {
    Some(match unit {
        Unit::None => return None,
        Unit::Second => "s",
        Unit::Metre => "m",
        Unit::MetrePerSecond => "m/s",
        Unit::MetrePerSecondSquared => "m/s2",
        Unit::Radian => "rad",
        Unit::RadianPerSecond => "rad/s",
        Unit::RadianPerSecondSquared => "rad/s2",
        Unit::PerRadian => "1/rad",
        Unit::Percent => "%",
        Unit::PercentPerSecond => "%/s",
        Unit::Newton => "N",
        Unit::Pascal => "Pa",
        Unit::KilogramPerCubicMetre => "kg/m3",
    })
}

/// The exponents of SI base units and the factor to them.
fn base_unit(unit: Unit) -> &'static str {
    match unit {
        Unit::None => "",
        Unit::Second => "s=\"1\"",
        Unit::Metre => "m=\"1\"",
        Unit::MetrePerSecond => "m=\"1\" s=\"-1\"",
        Unit::MetrePerSecondSquared => "m=\"1\" s=\"-2\"",
        Unit::Radian => "rad=\"1\"",
        Unit::RadianPerSecond => "rad=\"1\" s=\"-1\"",
        Unit::RadianPerSecondSquared => "rad=\"1\" s=\"-2\"",
        Unit::PerRadian => "rad=\"-1\"",
        Unit::Percent => "factor=\"0.01\"",
        Unit::PercentPerSecond => "s=\"-1\" factor=\"0.01\"",
        Unit::Newton => "kg=\"1\" m=\"1\" s=\"-2\"",
        Unit::Pascal => "kg=\"1\" m=\"-1\" s=\"-2\"",
        Unit::KilogramPerCubicMetre => "kg=\"1\" m=\"-3\"",
    }
}

/// The unit in which people read it, and its number of one SI unit.
fn display(unit: Unit) -> Option<(&'static str, f64)> {
    match unit {
        Unit::Radian => Some(("deg", 1_f64.to_degrees())),
        Unit::RadianPerSecond => Some(("deg/s", 1_f64.to_degrees())),
        Unit::RadianPerSecondSquared => Some(("deg/s2", 1_f64.to_degrees())),
        Unit::PerRadian => Some(("1/deg", 1_f64.to_radians())),
        _ => None,
    }
}

fn unit_definition(unit: Unit) -> String {
    let name = unit_name(unit).unwrap_or_default();
    let base = base_unit(unit);
    match display(unit) {
        Some((display, factor)) => format!(
            "    <Unit name=\"{name}\">\n      <BaseUnit {base}/>\n      \
             <DisplayUnit name=\"{display}\" factor=\"{factor}\"/>\n    </Unit>\n"
        ),
        None => format!("    <Unit name=\"{name}\">\n      <BaseUnit {base}/>\n    </Unit>\n"),
    }
}
