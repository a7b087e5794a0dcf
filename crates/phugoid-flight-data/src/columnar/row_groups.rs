//! Reads Parquet: groups of rows, each on its own, in batches.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use ::parquet::arrow::arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder};
use ::parquet::arrow::{ARROW_SCHEMA_META_KEY, ProjectionMask};
use ::parquet::basic::Compression;
use ::parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use ::parquet::file::reader::ChunkReader;

use super::{AddError, Columns, ReadError, pages, schema};
use crate::memory::{Account, Excess};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::table::{self, BYTES_PER_ROW, TableError, TableOptions};

/// Number of rows per batch: a few thousand need little memory and few calls.
const BATCH: usize = 8192;
/// Number of values per batch of a table of many columns.
const BATCH_VALUES: usize = 1 << 19;
/// Number of damaged groups that are reported one by one.
const MAX_FINDINGS: usize = 10;

/// Reads every group of rows; of a damaged one the rows before the damage are kept. `open` opens the file, once for
/// each group.
pub(crate) fn read<R: ChunkReader + 'static>(
    open: impl Fn() -> io::Result<R>,
    source: &str,
    options: &TableOptions,
) -> Result<Record, ReadError> {
    let account = &Account::new(options.max_memory);
    let (columns, report) = columns(open, source, account, |_| true)?;
    columns.record(source, options, report, account)
}

/// The columns of numbers, and what was found damaged. `choose` is called with those that there are, before any row is read, and
/// may leave some out; where it says false, none is read.
pub(crate) fn columns<R: ChunkReader + 'static>(
    open: impl Fn() -> io::Result<R>,
    source: &str,
    account: &Account,
    choose: impl FnOnce(&mut Columns) -> bool,
) -> Result<(Columns, QualityReport), ReadError> {
    let over = |excess, place: &str| ReadError::from(TableError::from(account.over(excess, source, place)));
    let io = |error| ReadError::Io { source_name: source.to_owned(), error };
    let damaged = |place: &str, problem: String| ReadError::Damaged {
        source_name: source.to_owned(),
        place: place.into(),
        problem,
    };
    let file = open().map_err(io)?;
    let in_footer = |problem| damaged("footer", problem);
    if let Some(needed) = pages::footer(&file).map_err(in_footer)? {
        account.take(needed).map_err(|excess| over(excess, "footer"))?;
    }
    let metadata = catching_panics(|| ParquetMetaDataReader::new().parse_and_finish(&file)).map_err(in_footer)?;
    let described = metadata.file_metadata();
    table::columns::check_count(source, None, described.schema_descr().root_schema().get_fields().len())?;
    for entry in described.key_value_metadata().into_iter().flatten().filter(|entry| entry.key == ARROW_SCHEMA_META_KEY)
    {
        let text = entry.value.as_deref().unwrap_or_default();
        schema::check_text(text, account).map_err(|excess| over(excess, "footer"))?;
    }
    let metadata = catching_panics(|| ArrowReaderMetadata::try_new(Arc::new(metadata), ArrowReaderOptions::new()))
        .map_err(in_footer)?;
    let mut columns = Columns::of(metadata.schema(), source)?;
    let mut report = QualityReport::default();
    if !choose(&mut columns) {
        return Ok((columns, report));
    }
    let mask = ProjectionMask::roots(metadata.parquet_schema(), columns.chosen.iter().copied());
    let groups = metadata.metadata().num_row_groups();
    let mut lost = 0;
    let mut first = None;
    for group in 0..groups {
        let place = format!("row group {} of {groups}", group + 1);
        let problem = match check(&file, metadata.metadata(), group, &mask, source)? {
            Err(problem) => Some(problem),
            Ok(needed) => {
                let _held = account.hold(needed).map_err(|excess| over(excess, &place))?;
                match one_group(open().map_err(io)?, &metadata, group, &mask, &mut columns, account) {
                    Ok(()) => None,
                    Err(AddError::Damaged(problem)) => Some(problem),
                    Err(AddError::OverBudget(Excess(reached))) => {
                        // The file says how many rows there are.
                        let rows: i64 = metadata.metadata().row_groups().iter().map(|group| group.num_rows()).sum();
                        let each = BYTES_PER_ROW + 8 * columns.chosen.len();
                        let all = u64::try_from(rows).unwrap_or(0).saturating_mul(each as u64);
                        return Err(over(Excess(reached.max(all)), &place));
                    }
                }
            }
        };
        let Some(problem) = problem else { continue };
        lost += 1;
        if lost <= MAX_FINDINGS {
            report.warn(&place, format!("damaged ({problem}); the rows of it that could not be read are left out"));
        }
        first.get_or_insert((place, problem));
    }
    match first {
        Some((place, problem)) if columns.rows() == 0 => Err(damaged(&place, problem)),
        _ => Ok((columns, report)),
    }
}

/// What the library needs to read a group of rows, bytes; or what is wrong with the group, found before anything of it
/// is unpacked.
fn check(
    file: &impl ChunkReader,
    metadata: &Arc<ParquetMetaData>,
    group: usize,
    mask: &ProjectionMask,
    source: &str,
) -> Result<Result<u64, String>, ReadError> {
    let group = metadata.row_group(group);
    let mut needed = 0_u64;
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
        let sizes = [column.compressed_size(), column.uncompressed_size()].map(u64::try_from);
        let (Ok(from), [Ok(length), Ok(unpacked)]) = (from, sizes) else {
            let (first, size) = (first, column.compressed_size());
            return Ok(Err(format!("column '{}' of {size} bytes at byte {first}", column.column_path())));
        };
        // The pages of all columns are open at the same time.
        match pages::check(file, from, length, unpacked) {
            Ok(bytes) => needed = needed.saturating_add(bytes),
            Err(problem) => return Ok(Err(format!("column '{}', {problem}", column.column_path()))),
        }
    }
    Ok(Ok(needed))
}

/// Adds the rows of a group to the columns. The error says what is wrong with it, or that there is no room.
fn one_group<R: ChunkReader + 'static>(
    file: R,
    metadata: &ArrowReaderMetadata,
    group: usize,
    mask: &ProjectionMask,
    columns: &mut Columns,
    account: &Account,
) -> Result<(), AddError> {
    let batch = (BATCH_VALUES / columns.chosen.len().max(1)).clamp(16, BATCH);
    let reader = catching_panics(|| {
        ParquetRecordBatchReaderBuilder::new_with_metadata(file, metadata.clone())
            .with_row_groups(vec![group])
            .with_projection(mask.clone())
            .with_batch_size(batch)
            .build()
    });
    let mut reader = reader.map_err(AddError::Damaged)?;
    while let Some(batch) = catching_panics(|| reader.next().transpose()).map_err(AddError::Damaged)? {
        columns.add(&batch, account)?;
    }
    Ok(())
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
