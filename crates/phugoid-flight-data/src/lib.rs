#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! | module | what it is for |
//! |---|---|
//! | [`record`] | the [`Record`](record::Record): time and channels, which every other module makes or takes |
//! | [`reader`] | opens a file of any format; options, mappings, survey of what is in a log |
//! | [`csv`] | reads and writes CSV, whole files or row by row |
//! | [`log`] | logs of autopilots as they were written: topics with times and units of their own |
//! | `matlab`, `parquet`, `arrow` | these formats, under the features of the table above |
//! | [`table`] | makes a record of columns in memory; mappings of columns to channels |
//! | [`profile`] | which fields of a log are which channels |
//! | [`mavlink`] | frames and messages of MAVLink |
//! | [`align`] | puts signals of different rates on one time base, causally, for logs and live streams |
//! | [`quality`] | the report on what a reader found |
//! | [`deletion`] | deletion of values that are known to be bad, each with its reason |
//! | [`plausibility`] | checks of units and signs by physics |
//! | [`channels`] | the table of known channels: name, quantity, sign, synonyms |
//! | [`units`], [`quantity`] | conversion of units; numbers with units in text (`"20000 ft"`) |
//! | [`airspeed`] | true airspeed from equivalent airspeed and air density |
//! | [`memory`] | the bound on the memory that reading may take |
//! | [`statistics`] | median and quantile |
//! | [`format`](mod@format) | the format of a file by its first bytes |
pub mod airspeed;
pub mod align;
#[cfg(feature = "parquet")]
pub mod arrow;
pub mod calendar;
pub mod channels;
pub mod csv;
pub mod deletion;
#[cfg(feature = "excel")]
pub mod excel;
pub mod format;
pub mod log;
#[cfg(feature = "matlab")]
pub mod matlab;
pub mod mavlink;
pub mod memory;
pub mod output_file;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plausibility;
pub mod printable;
pub mod profile;
pub mod quality;
pub mod quantity;
pub mod reader;
pub mod record;
pub mod statistics;
pub mod table;
pub mod units;

#[cfg(feature = "parquet")]
mod columnar;
mod wording;
