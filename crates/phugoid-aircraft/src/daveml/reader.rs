//! A DAVE-ML text as a whole: header, variables, and in which order everything is computed.

use std::cell::Cell;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use roxmltree::Document;

use super::document::{Bound, Distribution, Header, Role, Uncertainty, Variable};
use super::error::{DavemlError, brief};
use super::mathml::{Translated, Translator};
use super::model::Model;
use super::program::{Limits, Program, Source, Step, Table, order};
use super::repair::repaired;
use super::shots;
use super::tables::{Definitions, TableReader, description};
use super::tree::{Element, Lines, PASSED_OVER, child, elements, label, name, words};
use super::uncertainty::uncertainty;
use crate::xml;

/// Most variables that a circle is told with.
const NAMED_IN_CIRCLE: usize = 20;

/// Reads a model. A text that is no XML is read with the markup in its descriptions as text, if that makes it XML.
pub(super) fn read(text: &str) -> Result<Model, DavemlError> {
    let error = match xml::parse(text) {
        Ok(document) => return read_document(text, &document),
        Err(error) => error,
    };
    if let Some((text, lines)) = repaired(text)
        && let Ok(document) = xml::parse(&text)
    {
        let mut model = read_document(&text, &document)?;
        model.set_repaired(lines);
        return Ok(model);
    }
    Err(error.into())
}

fn read_document<'t>(text: &str, document: &'t Document<'t>) -> Result<Model, DavemlError> {
    let lines = Lines::of(text);
    let root = document.root_element();
    if name(root) != "DAVEfunc" {
        return Err(DavemlError::NotDaveml { element: brief(name(root)), line: lines.line(root) });
    }
    let mut header = Header::default();
    let mut variables: Vec<Variable> = Vec::new();
    let mut calculations = Vec::new();
    let mut shots = Vec::new();
    // Definitions first: the standard has them in this order, but nothing is lost by reading them in any.
    for element in elements(root) {
        match name(element) {
            "fileHeader" => header = read_header(element),
            "variableDef" => read_variable(&lines, element, &mut variables, &mut calculations)?,
            "breakpointDef" | "griddedTableDef" | "ungriddedTableDef" | "function" => {
                bound_variables(&lines, element, &mut variables, &mut calculations)?;
            }
            "checkData" => shots.push(element),
            passed if PASSED_OVER.contains(&passed) => {}
            _ => return Err(lines.unknown(element)),
        }
    }
    let ids: Vec<String> = variables.iter().map(|variable| variable.id.clone()).collect();
    let mut index = HashMap::with_capacity(ids.len());
    for (position, variable) in variables.iter().enumerate() {
        if index.insert(variable.id.clone(), position).is_some() {
            return Err(DavemlError::Repeated { kind: "variable", id: brief(&variable.id), line: variable.line });
        }
    }
    let mut builder = Builder::new(variables.len());
    let translator = Translator { lines: &lines, variables: &index };
    for (variable, calculation) in calculations {
        let translated = translator.calculation(calculation)?;
        builder.calculation(variable, translated, &ids, lines.line(calculation))?;
    }
    let reader = TableReader { lines: &lines, variables: &index, ids: &ids, spline: Cell::new(0) };
    let mut definitions = Definitions::default();
    for element in elements(root).filter(|element| name(*element) == "breakpointDef") {
        reader.breakpoints(element, &mut definitions)?;
    }
    for element in elements(root).filter(|element| name(*element).ends_with("griddedTableDef")) {
        reader.table(element, &mut definitions)?;
    }
    let mut functions = Vec::new();
    for element in elements(root).filter(|element| name(*element) == "function") {
        let (function, table, dependent) = reader.function(element, &mut definitions)?;
        builder.table(dependent, table, &ids, function.line)?;
        functions.push(function);
    }
    let doubts = variables.iter().map(|variable| (&variable.uncertainty, variable.line));
    for (doubt, line) in doubts.chain(functions.iter().map(|function| (&function.uncertainty, function.line))) {
        if let Some(id) = doubt.as_ref().and_then(|doubt| unknown_reference(doubt, &index, &definitions)) {
            return Err(DavemlError::UnknownVariable { id: brief(id), line });
        }
    }
    let (program, used) = builder.finish(&variables)?;
    for (position, variable) in variables.iter_mut().enumerate() {
        let marked = variable.is_input || variable.is_control || variable.is_disturbance;
        variable.role = if program.computed[position] {
            Role::Computed
        } else if marked || variable.initial.is_none() {
            Role::Input
        } else {
            Role::Constant
        };
    }
    let mut model = Model::new(header, variables, functions, index, Arc::new(program), &used);
    let mut read = Vec::new();
    for element in shots {
        shots::read(&lines, element, &model, &mut read)?;
    }
    model.set_shots(read);
    Ok(model)
}

fn read_header(node: Element<'_>) -> Header {
    let authors = elements(node).filter(|element| name(*element) == "author");
    let created = elements(node).find(|element| matches!(name(*element), "creationDate" | "fileCreationDate"));
    Header {
        name: label(node, "name"),
        authors: authors.map(|author| (label(author, "name"), label(author, "org"))).collect(),
        created: created.map_or_else(String::new, |created| label(created, "date")),
        version: words(child(node, "fileVersion")),
        description: words(description(node)),
    }
}

/// Variables that are defined inside the bounds of an uncertainty of a table.
fn bound_variables<'t>(
    lines: &Lines,
    node: Element<'t>,
    variables: &mut Vec<Variable>,
    calculations: &mut Vec<(usize, Element<'t>)>,
) -> Result<(), DavemlError> {
    for element in node.descendants().filter(|element| element.is_element() && name(*element) == "variableDef") {
        if element.ancestors().filter(|above| above.is_element() && name(*above) == "variableDef").count() == 1 {
            read_variable(lines, element, variables, calculations)?;
        }
    }
    Ok(())
}

fn read_variable<'t>(
    lines: &Lines,
    node: Element<'t>,
    variables: &mut Vec<Variable>,
    calculations: &mut Vec<(usize, Element<'t>)>,
) -> Result<(), DavemlError> {
    let mut variable = Variable {
        id: lines.attribute(node, "varID")?.to_owned(),
        name: label(node, "name"),
        units: label(node, "units"),
        description: words(description(node)),
        symbol: label(node, "symbol"),
        axis_system: label(node, "axisSystem"),
        sign: label(node, "sign"),
        initial: lines.optional_number(node, "initialValue")?,
        minimum: lines.optional_number(node, "minValue")?,
        maximum: lines.optional_number(node, "maxValue")?,
        role: Role::Input,
        is_input: false,
        is_control: false,
        is_disturbance: false,
        is_output: false,
        is_state: false,
        is_state_derivative: false,
        is_standard: false,
        uncertainty: None,
        line: lines.line(node),
    };
    if variable.name.is_empty() {
        variable.name = variable.id.clone();
    }
    if let (Some(lower), Some(upper)) = (variable.minimum, variable.maximum)
        && lower > upper
    {
        return Err(DavemlError::Limits { lower, upper, line: variable.line });
    }
    let position = variables.len();
    let mut inside = Vec::new();
    for element in elements(node) {
        match name(element) {
            "calculation" => match calculations.last() {
                Some((last, _)) if *last == position => {
                    return Err(DavemlError::ComputedTwice { id: brief(&variable.id), line: lines.line(element) });
                }
                _ => calculations.push((position, element)),
            },
            "isInput" => variable.is_input = true,
            "isControl" => variable.is_control = true,
            "isDisturbance" => variable.is_disturbance = true,
            "isOutput" => variable.is_output = true,
            "isState" => variable.is_state = true,
            "isStateDeriv" => variable.is_state_derivative = true,
            "isStdAIAA" => variable.is_standard = true,
            "uncertainty" => {
                variable.uncertainty = Some(uncertainty(lines, element)?);
                inside.push(element);
            }
            passed if PASSED_OVER.contains(&passed) => {}
            _ => return Err(lines.unknown(element)),
        }
    }
    variables.push(variable);
    for element in inside {
        let bounds = element.descendants().filter(|bound| bound.is_element() && name(*bound) == "variableDef");
        // Those further inside are read with the one around them.
        for bound in bounds {
            let nearest = bound.ancestors().skip(1).find(|above| above.is_element() && name(*above) == "variableDef");
            if nearest == Some(node) {
                read_variable(lines, bound, variables, calculations)?;
            }
        }
    }
    Ok(())
}

/// What an uncertainty refers to and is not there. A correlation may be with a table.
fn unknown_reference<'u>(
    doubt: &'u Uncertainty,
    variables: &HashMap<String, usize>,
    definitions: &Definitions,
) -> Option<&'u str> {
    let bounds = doubt.bounds().iter().filter_map(|bound| match bound {
        Bound::Variable(id) => Some(id.as_str()),
        Bound::Value(_) | Bound::Table(_) => None,
    });
    let correlated: Vec<&str> = match &doubt.distribution {
        Distribution::Normal { correlates_with, correlations, .. } => {
            let with = correlations.iter().map(|(id, _)| id.as_str());
            correlates_with.iter().map(String::as_str).chain(with).collect()
        }
        Distribution::Uniform { .. } => Vec::new(),
    };
    let missing = |id: &&str| !variables.contains_key(*id);
    bounds.filter(missing).chain(correlated.into_iter().filter(|id| missing(id) && !definitions.has_table(id))).next()
}

impl Model {
    /// Reads a file.
    ///
    /// # Errors
    /// [`DavemlError`]; the message names the file.
    pub fn open(file: impl AsRef<Path>) -> Result<Self, DavemlError> {
        let file = file.as_ref();
        let text = xml::text_of(file)?;
        Self::parse(&text).map_err(|source| DavemlError::InFile { file: file.into(), source: Box::new(source) })
    }

    /// Reads a text. Nothing else is read: a document type on the network is not fetched.
    ///
    /// # Errors
    /// [`DavemlError`], with the line.
    pub fn parse(text: &str) -> Result<Self, DavemlError> {
        read(text)
    }
}

/// A program while it is put together.
struct Builder {
    program: Program,
    sources: Vec<Option<Source>>,
    needs: Vec<Vec<usize>>,
}

impl Builder {
    fn new(count: usize) -> Self {
        Self { program: Program::default(), sources: vec![None; count], needs: vec![Vec::new(); count] }
    }

    fn add(&mut self, variable: usize, source: Source, ids: &[String], line: u32) -> Result<(), DavemlError> {
        match self.sources[variable].replace(source) {
            Some(_) => Err(DavemlError::ComputedTwice { id: brief(&ids[variable]), line }),
            None => Ok(()),
        }
    }

    fn calculation(
        &mut self,
        variable: usize,
        translated: Translated,
        ids: &[String],
        line: u32,
    ) -> Result<(), DavemlError> {
        let ops = &mut self.program.ops;
        let begin = ops.len() as u32;
        ops.extend(translated.ops);
        let end = ops.len() as u32;
        self.program.stack = self.program.stack.max(translated.depth);
        self.needs[variable] = translated.needs;
        self.add(variable, Source::Calculation { begin, end }, ids, line)
    }

    fn table(&mut self, variable: usize, table: Table, ids: &[String], line: u32) -> Result<(), DavemlError> {
        let hints = self.program.hints as u32;
        let needs = match &table {
            Table::Gridded(gridded) => {
                self.program.places = self.program.places.max(gridded.axes.len());
                self.program.hints += gridded.axes.len();
                gridded.axes.iter().map(|axis| axis.independent.variable).collect()
            }
            Table::Scattered(scattered) => {
                self.program.hints += 1;
                scattered.independents.iter().map(|independent| independent.variable).collect()
            }
        };
        let place = self.program.tables.len() as u32;
        self.program.tables.push(table);
        self.add(variable, Source::Table { table: place, hints }, ids, line)?;
        self.needs[variable] = needs;
        Ok(())
    }

    /// The program, and for each variable whether another needs it.
    fn finish(self, variables: &[Variable]) -> Result<(Program, Vec<bool>), DavemlError> {
        let Self { mut program, sources, needs } = self;
        let sorted = order(&needs).map_err(|circle| {
            let named = circle.iter().take(NAMED_IN_CIRCLE).map(|position| brief(&variables[*position].id));
            let line = circle.first().map_or(0, |position| variables[*position].line);
            DavemlError::Cycle { variables: named.collect(), line }
        })?;
        let mut used = vec![false; variables.len()];
        for needed in needs.iter().flatten() {
            used[*needed] = true;
        }
        program.computed = sources.iter().map(Option::is_some).collect();
        program.free = (0..sources.len()).filter(|k| sources[*k].is_none()).map(|k| k as u32).collect();
        let step = |variable: usize| sources[variable].map(|source| Step { variable: variable as u32, source });
        program.steps = sorted.into_iter().filter_map(step).collect();
        program.initial = variables.iter().map(|variable| variable.initial.unwrap_or(f64::NAN)).collect();
        let limits = variables.iter().map(|variable| Limits {
            lower: variable.minimum.unwrap_or(f64::NEG_INFINITY),
            upper: variable.maximum.unwrap_or(f64::INFINITY),
        });
        program.limits = limits.collect();
        Ok((program, used))
    }
}
