//! One file per command: each reads its input, calls the library and prints the result.

mod axes_form;
#[cfg(feature = "fleet")]
pub(crate) mod campaign;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod compatibility;
pub(crate) mod completions;
mod deleting;
pub(crate) mod demonstrate;
pub(crate) mod design;
mod detection;
pub(crate) mod estimate;
mod export;
pub(crate) mod export_fmu;
pub(crate) mod field;
#[cfg(feature = "fleet")]
pub(crate) mod fleet;
#[cfg(feature = "fleet")]
mod fleet_analyses;
#[cfg(feature = "fleet")]
mod fleet_tell;
#[cfg(feature = "fleet")]
mod fleet_view;
mod flight;
pub(crate) mod fly;
mod further;
pub(crate) mod init;
pub(crate) mod inspect;
pub(crate) mod linearize;
pub(crate) mod live;
pub(crate) mod monitor;
mod offer;
#[cfg(feature = "fleet")]
mod on_ray;
mod recovery;
pub(crate) mod regress;
pub(crate) mod reproduce;
pub(crate) mod result;
mod runs;
mod screen;
#[cfg(feature = "live")]
mod server;
pub(crate) mod simulate;
pub(crate) mod study;
pub(crate) mod trim;
pub(crate) mod tune;
pub(crate) mod view;
