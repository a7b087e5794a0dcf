//! Breakpoints, tables and functions of a DAVE-ML text, read into the tables of a [`super::program::Program`].

use std::cell::{Cell, OnceCell};
use std::collections::HashMap;
use std::sync::Arc;

use super::axis::{Axis, Independent, Interpolation};
use super::document::{Bound, Function, Uncertainty};
use super::error::{DavemlError, brief};
use super::gridded::Gridded;
use super::program::Table;
use super::scattered::{Scattered, Surface};
use super::tree::{Element, Lines, PASSED_OVER, child, elements, label, name};
use super::uncertainty::uncertainty;

/// A table definition, read and not yet used by a function.
pub(super) struct TableDefinition {
    content: TableContent,
    uncertainty: Option<Uncertainty>,
    line: u32,
}

enum TableContent {
    Gridded {
        axes: Vec<Arc<[f64]>>,
        values: Arc<[f64]>,
    },
    /// Points with their value last, and the triangles between them once a function needs them.
    Ungridded {
        rows: Vec<Vec<f64>>,
        surface: OnceCell<Option<Arc<Surface>>>,
    },
}

/// What functions refer to.
#[derive(Default)]
pub(super) struct Definitions {
    breakpoints: HashMap<String, Arc<[f64]>>,
    tables: HashMap<String, TableDefinition>,
}

impl Definitions {
    pub(super) fn has_table(&self, id: &str) -> bool {
        self.tables.contains_key(id)
    }
}

/// Reads functions; one for a model.
pub(super) struct TableReader<'m> {
    pub(super) lines: &'m Lines,
    pub(super) variables: &'m HashMap<String, usize>,
    pub(super) ids: &'m [String],
    /// Places in the matrices of splines so far.
    pub(super) spline: Cell<usize>,
}

impl TableReader<'_> {
    /// Takes a `breakpointDef` in.
    pub(super) fn breakpoints(&self, node: Element<'_>, into: &mut Definitions) -> Result<(), DavemlError> {
        let id = self.lines.attribute(node, "bpID")?;
        let mut values = None;
        for element in elements(node) {
            match name(element) {
                "bpVals" if values.is_none() => values = Some(self.increasing(element)?),
                passed if PASSED_OVER.contains(&passed) => {}
                _ => return Err(self.lines.unknown(element)),
            }
        }
        let values = values.ok_or_else(|| self.lines.missing(node, "bpVals"))?;
        if into.breakpoints.insert(id.to_owned(), values).is_some() {
            return Err(DavemlError::Repeated { kind: "breakpoints", id: brief(id), line: self.lines.line(node) });
        }
        Ok(())
    }

    /// Numbers of an element, at least one, each larger than the one before.
    fn increasing(&self, node: Element<'_>) -> Result<Arc<[f64]>, DavemlError> {
        let values = self.lines.numbers(node)?;
        if values.is_empty() {
            return Err(DavemlError::TableSize { expected: 1, found: 0, line: self.lines.line(node) });
        }
        match values.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => {
                Err(DavemlError::NotIncreasing { before: pair[0], after: pair[1], line: self.lines.line(node) })
            }
            None => Ok(values.into()),
        }
    }

    /// Takes a `griddedTableDef` or `ungriddedTableDef` in, if it has an identifier.
    pub(super) fn table(&self, node: Element<'_>, into: &mut Definitions) -> Result<(), DavemlError> {
        let attribute = if name(node).starts_with("ungridded") { "utID" } else { "gtID" };
        let id = self.lines.attribute(node, attribute)?;
        let table = self.definition(node, into)?;
        self.insert(id, table, into)
    }

    fn insert(&self, id: &str, table: TableDefinition, into: &mut Definitions) -> Result<(), DavemlError> {
        let line = table.line;
        match into.tables.insert(id.to_owned(), table) {
            Some(_) => Err(DavemlError::Repeated { kind: "table", id: brief(id), line }),
            None => Ok(()),
        }
    }

    fn definition(&self, node: Element<'_>, known: &Definitions) -> Result<TableDefinition, DavemlError> {
        if name(node).starts_with("ungridded") { self.ungridded(node) } else { self.gridded(node, known) }
    }

    fn gridded(&self, node: Element<'_>, known: &Definitions) -> Result<TableDefinition, DavemlError> {
        let line = self.lines.line(node);
        let (mut axes, mut values, mut doubt) = (None, None, None);
        for element in elements(node) {
            match name(element) {
                "breakpointRefs" if axes.is_none() => axes = Some(self.references(element, known)?),
                "dataTable" if values.is_none() => values = Some(self.lines.numbers(element)?),
                "uncertainty" if doubt.is_none() => doubt = Some(uncertainty(self.lines, element)?),
                passed if PASSED_OVER.contains(&passed) => {}
                _ => return Err(self.lines.unknown(element)),
            }
        }
        let axes = axes.ok_or_else(|| self.lines.missing(node, "breakpointRefs"))?;
        let values = values.ok_or_else(|| self.lines.missing(node, "dataTable"))?;
        check_size(&axes, values.len(), line)?;
        for bound in doubt.iter().flat_map(Uncertainty::bounds) {
            if let Bound::Table(bound) = bound {
                check_size(&axes, bound.len(), line)?;
            }
        }
        let values = values.into();
        Ok(TableDefinition { content: TableContent::Gridded { axes, values }, uncertainty: doubt, line })
    }

    fn references(&self, node: Element<'_>, known: &Definitions) -> Result<Vec<Arc<[f64]>>, DavemlError> {
        let mut axes = Vec::new();
        for element in elements(node) {
            if name(element) != "bpRef" {
                return Err(self.lines.unknown(element));
            }
            let (id, line) = (self.lines.attribute(element, "bpID")?, self.lines.line(element));
            let unknown = || DavemlError::UnknownBreakpoints { id: brief(id), line };
            axes.push(known.breakpoints.get(id).ok_or_else(unknown)?.clone());
            check_dimensions(axes.len(), line)?;
        }
        if axes.is_empty() {
            return Err(self.lines.missing(node, "bpRef"));
        }
        Ok(axes)
    }

    fn ungridded(&self, node: Element<'_>) -> Result<TableDefinition, DavemlError> {
        let line = self.lines.line(node);
        let (mut rows, mut doubt): (Vec<Vec<f64>>, _) = (Vec::new(), None);
        for element in elements(node) {
            match name(element) {
                "dataPoint" => {
                    let row = self.lines.numbers(element)?;
                    let expected = rows.first().map_or(row.len().max(2), Vec::len);
                    if row.len() != expected {
                        let line = self.lines.line(element);
                        return Err(DavemlError::TableSize { expected, found: row.len(), line });
                    }
                    rows.push(row);
                }
                "uncertainty" if doubt.is_none() => doubt = Some(uncertainty(self.lines, element)?),
                passed if PASSED_OVER.contains(&passed) => {}
                _ => return Err(self.lines.unknown(element)),
            }
        }
        if rows.is_empty() {
            return Err(self.lines.missing(node, "dataPoint"));
        }
        let content = match rows[0].len() {
            2 => sorted(rows, &mut doubt, line)?,
            _ => TableContent::Ungridded { rows, surface: OnceCell::new() },
        };
        Ok(TableDefinition { content, uncertainty: doubt, line })
    }

    /// A `function` with its table, and the position of the variable that it computes.
    pub(super) fn function(
        &self,
        node: Element<'_>,
        known: &mut Definitions,
    ) -> Result<(Function, Table, usize), DavemlError> {
        let line = self.lines.line(node);
        let mut independents = Vec::new();
        let mut points = Vec::new();
        let (mut dependent, mut values, mut table): (_, _, Option<String>) = (None, None, None);
        for element in elements(node) {
            match name(element) {
                "independentVarRef" => independents.push(self.independent(element)?),
                "independentVarPts" => {
                    independents.push(self.independent(element)?);
                    points.push(self.increasing(element)?);
                }
                "dependentVarRef" if dependent.is_none() => dependent = Some(self.variable(element)?),
                "dependentVarPts" if dependent.is_none() => {
                    dependent = Some(self.variable(element)?);
                    values = Some(self.lines.numbers(element)?);
                }
                "functionDefn" if table.is_none() => table = Some(self.function_table(element, known)?),
                passed if PASSED_OVER.contains(&passed) => {}
                _ => return Err(self.lines.unknown(element)),
            }
            check_dimensions(independents.len(), self.lines.line(element))?;
        }
        let dependent = dependent.ok_or_else(|| self.lines.missing(node, "dependentVarRef"))?;
        if independents.is_empty() {
            return Err(self.lines.missing(node, "independentVarRef"));
        }
        let used = independents.iter().map(|independent| self.ids[independent.variable].clone()).collect();
        let (table, uncertainty) = match (table, values) {
            (Some(id), None) if points.is_empty() => {
                let found = known.tables.get(&id).ok_or(DavemlError::UnknownTable { id, line })?;
                (self.used(node, found, independents)?, found.uncertainty.clone())
            }
            (None, Some(values)) if points.len() == independents.len() => {
                check_size(&points, values.len(), line)?;
                (self.grid(node, points, values.into(), independents)?, None)
            }
            (None, None) => return Err(self.lines.missing(node, "functionDefn")),
            _ => return Err(self.lines.unsupported(node, "a mixture of both ways to write a function")),
        };
        let id = self.ids[dependent].clone();
        let function = Function { name: label(node, "name"), independents: used, dependent: id, uncertainty, line };
        Ok((function, table, dependent))
    }

    /// Identifier of the table in a `functionDefn`; one without an identifier gets one that no file can have.
    fn function_table(&self, node: Element<'_>, known: &mut Definitions) -> Result<String, DavemlError> {
        let mut children = elements(node);
        let table = children.next().ok_or_else(|| self.lines.missing(node, "griddedTableRef"))?;
        if let Some(second) = children.next() {
            return Err(self.lines.unknown(second));
        }
        let attribute = if name(table).starts_with("ungridded") { "utID" } else { "gtID" };
        match name(table) {
            // Some files refer to an ungridded table as to a gridded one.
            "griddedTableRef" | "ungriddedTableRef" => {
                let id = self.lines.attribute(table, attribute)?.to_owned();
                match known.tables.contains_key(&id) {
                    true => Ok(id),
                    false => Err(DavemlError::UnknownTable { id: brief(&id), line: self.lines.line(table) }),
                }
            }
            "griddedTableDef" | "griddedTable" | "ungriddedTableDef" | "ungriddedTable" => {
                let definition = self.definition(table, known)?;
                let id = match table.attribute(attribute).map(str::trim).filter(|id| !id.is_empty()) {
                    Some(id) => id.to_owned(),
                    None => format!("\n{}", table.range().start),
                };
                self.insert(&id, definition, known)?;
                Ok(id)
            }
            _ => Err(self.lines.unknown(table)),
        }
    }

    fn variable(&self, node: Element<'_>) -> Result<usize, DavemlError> {
        let id = self.lines.attribute(node, "varID")?;
        let unknown = || DavemlError::UnknownVariable { id: brief(id), line: self.lines.line(node) };
        self.variables.get(id).copied().ok_or_else(unknown)
    }

    fn independent(&self, node: Element<'_>) -> Result<Independent, DavemlError> {
        let variable = self.variable(node)?;
        let kinds = [
            ("linear", Some(Interpolation::Linear)),
            ("discrete", Some(Interpolation::Discrete)),
            ("floor", Some(Interpolation::Floor)),
            ("ceiling", Some(Interpolation::Ceiling)),
            ("cubicSpline", Some(Interpolation::CubicSpline)),
            ("quadraticSpline", None),
        ];
        let allowed = "discrete, floor, ceiling, linear, quadraticSpline, cubicSpline";
        let kind = self.lines.choice(node, "interpolate", &kinds, kinds[0].1, allowed)?;
        let interpolation =
            kind.ok_or_else(|| self.lines.unsupported(node, "interpolate=\"quadraticSpline\", which is not unique,"))?;
        let sides = [("neither", [false; 2]), ("min", [true, false]), ("max", [false, true]), ("both", [true; 2])];
        let allowed = "neither, min, max, both";
        let extrapolates = self.lines.choice(node, "extrapolate", &sides, [false; 2], allowed)?;
        let limit = |attribute, none| self.lines.optional_number(node, attribute).map(|limit| limit.unwrap_or(none));
        let (lower, upper) = (limit("min", f64::NEG_INFINITY)?, limit("max", f64::INFINITY)?);
        if lower > upper {
            return Err(DavemlError::Limits { lower, upper, line: self.lines.line(node) });
        }
        let lower = if extrapolates[0] { f64::NEG_INFINITY } else { lower };
        let upper = if extrapolates[1] { f64::INFINITY } else { upper };
        Ok(Independent { variable, interpolation, lower, upper, extrapolates })
    }

    /// A defined table as a function of these variables uses it.
    fn used(
        &self,
        node: Element<'_>,
        table: &TableDefinition,
        independents: Vec<Independent>,
    ) -> Result<Table, DavemlError> {
        let variables = independents.len();
        let dimensions = match &table.content {
            TableContent::Gridded { axes, .. } => axes.len(),
            TableContent::Ungridded { rows, .. } => rows.first().map_or(0, |row| row.len() - 1),
        };
        if dimensions != variables {
            return Err(DavemlError::Dimensions { variables, dimensions, line: self.lines.line(node) });
        }
        match &table.content {
            TableContent::Gridded { axes, values } => self.grid(node, axes.clone(), values.clone(), independents),
            TableContent::Ungridded { rows, surface } => self.scattered(node, rows, surface, independents, table.line),
        }
    }

    fn grid(
        &self,
        node: Element<'_>,
        axes: Vec<Arc<[f64]>>,
        values: Arc<[f64]>,
        independents: Vec<Independent>,
    ) -> Result<Table, DavemlError> {
        let mut stride = values.len();
        let mut built = Vec::with_capacity(axes.len());
        for (points, independent) in axes.into_iter().zip(independents) {
            if independent.interpolation == Interpolation::CubicSpline {
                let (found, limit) = (points.len(), Axis::MAX_SPLINE);
                self.spline.set(self.spline.get() + found.saturating_mul(found));
                if found > limit || self.spline.get() > limit * limit {
                    let (what, line) = ("breakpoints of splines in all", self.lines.line(node));
                    return Err(DavemlError::TooMany { what, found, limit, line });
                }
            }
            stride /= points.len();
            built.push(Axis::new(points, stride, independent));
        }
        Ok(Table::Gridded(Gridded { axes: built, values }))
    }

    fn scattered(
        &self,
        node: Element<'_>,
        rows: &[Vec<f64>],
        surface: &OnceCell<Option<Arc<Surface>>>,
        independents: Vec<Independent>,
        line: u32,
    ) -> Result<Table, DavemlError> {
        let dimensions = independents.len();
        let Ok(independents) = <[Independent; 2]>::try_from(independents) else {
            let what = format!("an ungridded table of {dimensions} dimensions");
            return Err(DavemlError::Unsupported { what, line });
        };
        if independents.iter().any(|independent| independent.interpolation != Interpolation::Linear) {
            return Err(self.lines.unsupported(node, "other than linear interpolation in an ungridded table"));
        }
        let (found, limit) = (rows.len(), Surface::MAX_POINTS);
        if found > limit {
            return Err(DavemlError::TooMany { what: "points of an ungridded table", found, limit, line });
        }
        let points = || rows.iter().map(|row| [row[0], row[1]]).collect();
        let values = || rows.iter().map(|row| row[2]).collect();
        let surface = surface.get_or_init(|| Surface::new(points(), values()).map(Arc::new)).clone();
        let surface = surface.ok_or_else(|| {
            let problem = "has points that repeat each other, or lie on one line".to_owned();
            DavemlError::Scattered { problem, line }
        })?;
        Ok(Table::Scattered(Box::new(Scattered { independents, surface })))
    }
}

/// An ungridded table of one dimension, as a gridded one. Bounds that are tables are brought into its order.
fn sorted(rows: Vec<Vec<f64>>, doubt: &mut Option<Uncertainty>, line: u32) -> Result<TableContent, DavemlError> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|a, b| rows[*a][0].total_cmp(&rows[*b][0]));
    for bound in doubt.iter_mut().flat_map(Uncertainty::bounds_mut) {
        if let Bound::Table(sizes) = bound
            && sizes.len() == order.len()
        {
            *sizes = order.iter().map(|k| sizes[*k]).collect();
        }
    }
    let rows: Vec<&Vec<f64>> = order.iter().map(|k| &rows[*k]).collect();
    if let Some(pair) = rows.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
        return Err(DavemlError::NotIncreasing { before: pair[0][0], after: pair[1][0], line });
    }
    let points: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let values = rows.iter().map(|row| row[1]).collect();
    Ok(TableContent::Gridded { axes: vec![points.into()], values })
}

fn check_dimensions(found: usize, line: u32) -> Result<(), DavemlError> {
    let (what, limit) = ("dimensions of a table", Gridded::MAX_DIMENSIONS);
    if found > limit { Err(DavemlError::TooMany { what, found, limit, line }) } else { Ok(()) }
}

/// Compares the number of values with that of combinations of breakpoints.
fn check_size(axes: &[Arc<[f64]>], found: usize, line: u32) -> Result<(), DavemlError> {
    let product = axes.iter().try_fold(1_usize, |product, axis| product.checked_mul(axis.len()));
    match product {
        Some(expected) if expected == found => Ok(()),
        _ => Err(DavemlError::TableSize { expected: product.unwrap_or(usize::MAX), found, line }),
    }
}

/// The description inside an element, for those that have one.
pub(super) fn description<'t>(node: Element<'t>) -> Option<Element<'t>> {
    child(node, "description")
}
