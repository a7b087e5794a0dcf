//! Code that Parquet and Arrow files share: which columns are signals, their units, and their values as `f64`.

mod error;
mod numbers;

pub(crate) mod ipc;
pub(crate) mod pages;
pub(crate) mod row_groups;
mod schema;
pub(crate) mod write;

pub use error::ReadError;

use arrow_array::RecordBatch;
use arrow_schema::{Field, Schema};

use crate::memory::{Account, Excess, many};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::{self, Column, LeftOut, TableError, TableOptions, columns};

/// The columns of numbers of a schema, and their values so far.
pub(crate) struct Columns {
    /// Indices of the columns in the schema.
    pub(crate) chosen: Vec<usize>,
    columns: Vec<Column>,
    left_out: Vec<LeftOut>,
}

impl Columns {
    /// The columns of a schema; an error if there are more than are read.
    pub(crate) fn of(schema: &Schema, source: &str) -> Result<Self, TableError> {
        columns::check_count(source, None, schema.fields().len())?;
        let mut columns = Self { chosen: Vec::new(), columns: Vec::new(), left_out: Vec::new() };
        for (index, field) in schema.fields().iter().enumerate() {
            match numbers::kind(field.data_type()) {
                Ok(kind) => {
                    let unit = kind.unit().map(str::to_owned).or_else(|| unit_of(field));
                    let header = field.name().clone();
                    columns.columns.push(Column { header, unit, values: Vec::new(), is_time: kind.is_time() });
                    columns.chosen.push(index);
                }
                Err(why) => columns.left_out.push(LeftOut { header: field.name().clone(), why }),
            }
        }
        Ok(columns)
    }

    /// Names of the columns of numbers, in the order of the file.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.header.as_str())
    }

    /// Leaves out the columns whose place among [`names`](Self::names) is not `wanted`, before any row is read.
    pub(crate) fn retain(&mut self, wanted: impl Fn(usize) -> bool) {
        let mut place = 0..;
        self.chosen.retain(|_| place.next().is_some_and(&wanted));
        let mut place = 0..;
        self.columns.retain(|_| place.next().is_some_and(&wanted));
    }

    /// The columns with their values.
    pub(crate) fn into_columns(self) -> Vec<Column> {
        self.columns
    }

    /// Number of rows so far.
    pub(crate) fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Appends a batch that holds only the chosen columns. On an error the rows before it are kept.
    pub(crate) fn add(&mut self, batch: &RecordBatch, account: &Account) -> Result<(), AddError> {
        if batch.num_columns() != self.columns.len() {
            let (found, expected) = (batch.num_columns(), self.columns.len());
            return Err(AddError::Damaged(format!("a batch of {found} columns, where {expected} are expected")));
        }
        let before = self.rows();
        account.take(many(batch.num_rows(), 8 * self.columns.len())).map_err(AddError::OverBudget)?;
        for (column, array) in self.columns.iter_mut().zip(batch.columns()) {
            numbers::append(array, &mut column.values);
        }
        let whole = before + batch.num_rows();
        match self.columns.iter().find(|column| column.values.len() != whole).map(|column| column.header.clone()) {
            Some(header) => {
                self.columns.iter_mut().for_each(|column| column.values.truncate(before));
                Err(AddError::Damaged(format!("column '{header}' is of another type than the schema says")))
            }
            None => Ok(()),
        }
    }

    pub(crate) fn record(
        self,
        source: &str,
        options: &TableOptions,
        report: QualityReport,
        account: &Account,
    ) -> Result<Record, ReadError> {
        Ok(table::from_counted_columns(source, self.columns, &self.left_out, options, report, account)?)
    }
}

/// Why a batch could not be added.
pub(crate) enum AddError {
    Damaged(String),
    OverBudget(Excess),
}

/// The unit in the metadata of a field, where this crate and other programs write it.
fn unit_of(field: &Field) -> Option<String> {
    let metadata = field.metadata();
    let unit = ["unit", "units", "Unit", "Units"].iter().find_map(|&key| metadata.get(key));
    unit.map(|unit| unit.trim().to_owned()).filter(|unit| !unit.is_empty() && unit.len() <= 40)
}
