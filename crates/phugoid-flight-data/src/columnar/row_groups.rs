//! Reads Parquet: groups of rows, each on its own, in batches.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use ::parquet::arrow::ProjectionMask;
use ::parquet::arrow::arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder};
use ::parquet::basic::Compression;
use ::parquet::file::metadata::ParquetMetaData;
use ::parquet::file::reader::ChunkReader;

use super::{AddError, Columns, ReadError, pages};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::TableOptions;

/// Number of rows per batch: a few thousand need little memory and few calls.
const BATCH: usize = 8192;
/// Number of damaged groups that are reported one by one.
const MAX_FINDINGS: usize = 10;

/// Reads every group of rows; of a damaged one the rows before the damage are kept. `open` opens the file, once for
/// each group.
pub(crate) fn read<R: ChunkReader + 'static>(
    open: impl Fn() -> io::Result<R>,
    source: &str,
    options: &TableOptions,
) -> Result<Record, ReadError> {
    let io = |error| ReadError::Io { source_name: source.to_owned(), error };
    let damaged = |place: &str, problem: String| ReadError::Damaged {
        source_name: source.to_owned(),
        place: place.into(),
        problem,
    };
    let file = open().map_err(io)?;
    let metadata = catching_panics(|| ArrowReaderMetadata::load(&file, ArrowReaderOptions::new()))
        .map_err(|problem| damaged("footer", problem))?;
    let mut columns = Columns::of(metadata.schema());
    let mut report = QualityReport::default();
    let mask = ProjectionMask::roots(metadata.parquet_schema(), columns.chosen.iter().copied());
    let groups = metadata.metadata().num_row_groups();
    let mut lost = 0;
    let mut first = None;
    for group in 0..groups {
        let problem = match check(&file, metadata.metadata(), group, &mask, options, source)? {
            Some(problem) => Some(problem),
            None => one_group(open().map_err(io)?, &metadata, group, &mask, &mut columns, source, options)?,
        };
        let Some(problem) = problem else { continue };
        lost += 1;
        let place = format!("row group {} of {groups}", group + 1);
        if lost <= MAX_FINDINGS {
            report.warn(&place, format!("damaged ({problem}); the rows of it that could not be read are left out"));
        }
        first.get_or_insert((place, problem));
    }
    match first {
        Some((place, problem)) if columns.rows() == 0 => Err(damaged(&place, problem)),
        _ => columns.record(source, options, report),
    }
}

/// What is wrong with a group of rows, found before anything of it is unpacked; `None` if nothing is.
fn check(
    file: &impl ChunkReader,
    metadata: &Arc<ParquetMetaData>,
    group: usize,
    mask: &ProjectionMask,
    options: &TableOptions,
    source: &str,
) -> Result<Option<String>, ReadError> {
    let group = metadata.row_group(group);
    // A page may hold a whole column, and another page its dictionary.
    let most_values = options.max_values as u64;
    let most_bytes = 8 * most_values + (1 << 16);
    for (leaf, column) in group.columns().iter().enumerate() {
        if !mask.leaf_included(leaf) {
            continue;
        }
        // The library unpacks all other compressions without a bound on memory, or not at all.
        let known = [Compression::UNCOMPRESSED, Compression::SNAPPY, Compression::LZ4_RAW];
        if !known.contains(&column.compression()) && !matches!(column.compression(), Compression::ZSTD(_)) {
            return Err(ReadError::NotRead {
                source_name: source.to_owned(),
                found: format!("a Parquet file compressed by {}, which is not read", column.compression()),
                advice: "Write it with compression 'zstd', 'snappy' or none",
            });
        }
        let first = column.dictionary_page_offset().unwrap_or_else(|| column.data_page_offset());
        let from = u64::try_from(first.min(column.data_page_offset()));
        let (Ok(from), Ok(length)) = (from, u64::try_from(column.compressed_size())) else {
            let (first, size) = (first, column.compressed_size());
            return Ok(Some(format!("column '{}' of {size} bytes at byte {first}", column.column_path())));
        };
        if let Err(problem) = pages::check(file, from, length, most_bytes, most_values) {
            return Ok(Some(format!("column '{}', {problem}", column.column_path())));
        }
    }
    Ok(None)
}

/// Adds the rows of a group to the columns. Returns what is wrong with it, or `None`.
fn one_group<R: ChunkReader + 'static>(
    file: R,
    metadata: &ArrowReaderMetadata,
    group: usize,
    mask: &ProjectionMask,
    columns: &mut Columns,
    source: &str,
    options: &TableOptions,
) -> Result<Option<String>, ReadError> {
    let reader = catching_panics(|| {
        ParquetRecordBatchReaderBuilder::new_with_metadata(file, metadata.clone())
            .with_row_groups(vec![group])
            .with_projection(mask.clone())
            .with_batch_size(BATCH)
            .build()
    });
    let mut reader = match reader {
        Ok(reader) => reader,
        Err(problem) => return Ok(Some(problem)),
    };
    loop {
        let batch = match catching_panics(|| reader.next().transpose()) {
            Ok(Some(batch)) => batch,
            Ok(None) => return Ok(None),
            Err(problem) => return Ok(Some(problem)),
        };
        match columns.add(&batch, source, options) {
            Ok(()) => {}
            Err(AddError::Damaged(problem)) => return Ok(Some(problem)),
            Err(AddError::Table(error)) => return Err(error.into()),
        }
    }
}

/// Runs a call of the library and turns a panic into an error. It panics on some damaged pages, such as one that refers
/// to a dictionary that does not exist.
fn catching_panics<T, E: ToString>(read: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    match catch_unwind(AssertUnwindSafe(read)) {
        Ok(result) => result.map_err(|error| error.to_string()),
        Err(cause) => {
            let cause = cause.downcast_ref::<&str>().map(|text| (*text).to_owned());
            Err(cause.unwrap_or_else(|| "the library that reads Parquet gave up".to_owned()))
        }
    }
}
