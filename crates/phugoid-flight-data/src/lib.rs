//! Flight records: named channels in SI units on one time base, with readers, writers and a quality report.
//!
//! A [`record::Record`] is what every other part of the project takes: strictly increasing time, channels under the
//! canonical names of [`channels::CHANNELS`] in SI units and radians, NaN where a value is missing. [`csv::read`]
//! makes one from a text file and writes everything that it found, converted, mended or left out into the record's
//! [`quality::QualityReport`]. Nothing is interpolated, resampled or invented.
//!
//! ```
//! use phugoid_flight_data::csv::{self, CsvOptions};
//! let file = "time_s,alpha_deg,tas_kt\n0.0,2.5,250\n0.1,2.6,\n0.2,2.7,251\n";
//! let record = csv::read(file.as_bytes(), "example.csv", &CsvOptions::default())?;
//! let alpha = record.channel("alpha").expect("alpha is in the file");
//! assert!((alpha.values[0] - 2.5_f64.to_radians()).abs() < 1e-15);
//! assert!(record.channel("true_airspeed").expect("so is the airspeed").values[1].is_nan());
//! # Ok::<(), csv::ReadError>(())
//! ```
pub mod airspeed;
pub mod align;
#[cfg(feature = "parquet")]
pub mod arrow;
pub mod channels;
pub mod csv;
pub mod format;
pub mod log;
#[cfg(feature = "matlab")]
pub mod matlab;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plausibility;
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
