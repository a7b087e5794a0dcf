//! A sink that surveys a whole log and keeps the tables of a selection, in one pass.

use super::decode::Scale;
use super::sink::{Full, Head, Sink, Stop, Stream, Tables};
use super::survey::{Counts, Survey};
use super::{Log, LogError, Selection};
use crate::memory::Account;

/// Counts everything, and keeps what is selected until it exceeds the bound on memory.
#[derive(Debug)]
pub(super) struct SurveyAndTables<'s> {
    counts: Counts,
    tables: Tables<'s>,
    full: Option<Full>,
    /// The selected values of one sample.
    row: Vec<f64>,
}

impl<'s> SurveyAndTables<'s> {
    pub(super) fn new(selection: &'s Selection, account: &Account) -> Self {
        let (counts, tables) = (Counts::new(account), Tables::new(selection, account));
        Self { counts, tables, full: None, row: Vec::new() }
    }

    pub(super) fn finish(self, head: Head, source: &str, account: &Account) -> (Survey, Result<Log, LogError>) {
        let log = match self.full {
            Some(full) => Err(Stop::Full(full).into_error(source, account)),
            None => Ok(self.tables.finish(head.clone())),
        };
        (self.counts.finish(head), log)
    }
}

impl Sink for SurveyAndTables<'_> {
    fn open(&mut self, topic: &str, instance: u16, fields: &[String]) -> Option<Stream> {
        let counted = self.counts.open(topic, instance, fields)?;
        let selected = self.tables.open(topic, instance, fields);
        Some(counted.with_selected(selected))
    }

    fn row(&mut self, stream: &Stream, time_us: f64, values: &[f64]) -> Result<(), Full> {
        self.counts.row(stream, time_us, values)?;
        if let (Some((selected, places)), None) = (stream.selected(), self.full) {
            self.row.clear();
            self.row.extend(places.iter().map(|&place| values.get(place).copied().unwrap_or(f64::NAN)));
            if let Err(full) = self.tables.row(selected, time_us, &self.row) {
                self.full = Some(full);
                // The tables cannot be used any more: free their memory. The survey goes on.
                self.tables.clear();
            }
        }
        Ok(())
    }

    fn describe(&mut self, stream: &Stream, kept: usize, unit: Option<&str>, factor: Scale) {
        self.counts.describe(stream, kept, unit, factor);
        if let Some((selected, places)) = stream.selected()
            && let Some(own) = places.iter().position(|&place| place == kept)
        {
            self.tables.describe(selected, own, unit, factor);
        }
    }

    fn forget(&mut self, stream: &Stream) -> usize {
        if let Some((selected, _)) = stream.selected() {
            self.tables.forget(selected);
        }
        self.counts.forget(stream)
    }
}
