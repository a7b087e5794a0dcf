//! A model in which something is moved that its file calls uncertain.

use std::sync::Arc;

use super::deviation::{Move, Size, deviation};
use super::document::{Bound, Distribution, Uncertainty};
use super::model::Model;
use super::program::Table;

/// What an [`UncertainElement`] is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UncertainPart {
    /// The variable at this position of [`Model::variables`].
    Variable(usize),
    /// The table of the functions at these positions of [`Model::functions`], which may share one.
    Table(Vec<usize>),
}

/// A variable or a table of which the file says how well it is known: an `uncertainty` element.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainElement {
    /// What it is of.
    pub part: UncertainPart,
    /// Its name in a sentence: `variable cmq`, or `table of cm0_table`.
    pub name: String,
    /// What the file says.
    pub uncertainty: Uncertainty,
}

/// How many standard deviations the bound of a normal distribution stands for.
fn sigmas_of(uncertainty: &Uncertainty) -> Option<f64> {
    match uncertainty.distribution {
        Distribution::Normal { sigmas, .. } => Some(sigmas),
        Distribution::Uniform { .. } => None,
    }
}

impl Model {
    /// Everything that the file calls uncertain: the variables in their order, then the tables, each once.
    pub fn uncertain_elements(&self) -> Vec<UncertainElement> {
        let variables = self.variables().iter().enumerate().filter_map(|(position, variable)| {
            Some(UncertainElement {
                part: UncertainPart::Variable(position),
                name: format!("variable {}", variable.id),
                uncertainty: variable.uncertainty.clone()?,
            })
        });
        let mut all: Vec<UncertainElement> = variables.collect();
        let first_table = all.len();
        for (position, function) in self.functions().iter().enumerate() {
            let Some(uncertainty) = function.uncertainty.clone() else { continue };
            let shares = |element: &&mut UncertainElement| match &element.part {
                UncertainPart::Table(others) => others.first().is_some_and(|first| self.share_table(*first, position)),
                UncertainPart::Variable(_) => false,
            };
            if let Some(UncertainElement { part: UncertainPart::Table(users), .. }) =
                all.iter_mut().skip(first_table).find(shares)
            {
                users.push(position);
                continue;
            }
            let name = if function.name.trim().is_empty() { &function.dependent } else { &function.name };
            let name = format!("table of {}", name.trim());
            all.push(UncertainElement { part: UncertainPart::Table(vec![position]), name, uncertainty });
        }
        all
    }

    fn share_table(&self, one: usize, other: usize) -> bool {
        match (self.table(one), self.table(other)) {
            (Some(Table::Gridded(a)), Some(Table::Gridded(b))) => Arc::ptr_eq(&a.values, &b.values),
            (Some(Table::Scattered(a)), Some(Table::Scattered(b))) => Arc::ptr_eq(&a.surface, &b.surface),
            _ => false,
        }
    }

    /// Correlation of two elements, -1 to 1: the coefficient that either of them gives for the other; 1 where one says that it
    /// correlates with the other, and neither gives a coefficient (`correlatesWith`); else 0. A table is known by the variables that it
    /// gives.
    pub fn correlation(&self, one: &UncertainElement, other: &UncertainElement) -> f64 {
        if one.part == other.part {
            return 1.0;
        }
        let names = |element: &UncertainElement, id: &str| match &element.part {
            UncertainPart::Variable(position) => self.variables()[*position].id == id,
            // An identifier that is of a variable with an uncertainty of its own means that one.
            UncertainPart::Table(users) => {
                let is_own = self.variable(id).is_some_and(|variable| variable.uncertainty.is_some());
                !is_own && users.iter().any(|function| self.functions()[*function].dependent == id)
            }
        };
        let said = |from: &UncertainElement, to: &UncertainElement| {
            let Distribution::Normal { correlates_with, correlations, .. } = &from.uncertainty.distribution else {
                return (None, false);
            };
            let coefficient = correlations.iter().find(|(id, _)| names(to, id)).map(|(_, coefficient)| *coefficient);
            (coefficient, correlates_with.iter().any(|id| names(to, id)))
        };
        let (first, second) = (said(one, other), said(other, one));
        let whole = if first.1 || second.1 { 1.0 } else { 0.0 };
        first.0.or(second.0).unwrap_or(whole).clamp(-1.0, 1.0)
    }

    /// The model with one element moved by so many standard uncertainties; `by` is 1 for one in the positive direction. A value `v`
    /// with the size `s` of one standard uncertainty becomes
    ///
    /// ```text
    /// additive        v + by s
    /// multiplicative  v (1 + by s)
    /// percentage      v (1 + by s/100)
    /// absolute        v + by |bound - v| ...    the bound is a value itself
    /// s: the bound over its number of sigmas (normal), over the root of three (uniform, one bound), and of two bounds of a uniform
    ///    distribution at -l and u from the value the root of (l^2 - l u + u^2)/3, the mean square about the value as written
    /// ```
    ///
    /// before its limits apply. A bound that is a variable has the value that it has where nothing is moved; a bound that is a table
    /// moves each value of its table by its own size. `None` where a bound is a table and does not belong to one of the same
    /// number of values.
    pub fn moved(&self, element: &UncertainElement, by: f64) -> Option<Self> {
        let Uncertainty { effect, .. } = element.uncertainty;
        let sigmas = sigmas_of(&element.uncertainty);
        let bounds = element.uncertainty.bounds();
        if bounds.iter().any(|bound| matches!(bound, Bound::Table(_))) {
            let UncertainPart::Table(users) = &element.part else { return None };
            return self.with_tables(users, |values| {
                let bound = |bound: &Bound, k: usize| match bound {
                    Bound::Table(sizes) => (sizes.len() == values.len()).then(|| sizes[k]),
                    Bound::Value(size) => Some(*size),
                    Bound::Variable(_) => None,
                };
                let moved = values.iter().enumerate().map(|(k, value)| {
                    let bounds = bounds.iter().map(|own| bound(own, k)).collect::<Option<Vec<f64>>>()?;
                    Some(value + by * deviation(effect, sigmas, *value, &bounds))
                });
                moved.collect()
            });
        }
        let size = |bound: &Bound| match bound {
            Bound::Value(value) => Some(Size::Number(*value)),
            Bound::Variable(id) => Some(Size::Variable(self.position_of_id(id)? as u32)),
            Bound::Table(_) => None,
        };
        let sizes: Vec<Size> = bounds.iter().map(size).collect::<Option<_>>()?;
        // A table whose values all move in the same way moves what is looked up in it.
        let variables: Vec<usize> = match &element.part {
            UncertainPart::Variable(position) => vec![*position],
            UncertainPart::Table(users) => {
                users.iter().filter_map(|user| self.position_of_id(&self.functions()[*user].dependent)).collect()
            }
        };
        let one = |variable: usize| Move { variable: variable as u32, effect, sigmas, bounds: sizes.clone(), by };
        Some(self.with_moves(variables.into_iter().map(one).collect()))
    }
}
