#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | holds |
//! |---|---|
//! | [`source`] | where bytes come from: UDP, TCP, serial line, standard input, a recording |
//! | [`arrival`] | what a source hands over, with the time at which it came |
//! | [`recording`] | the file of everything that arrived |
//! | [`receiver`] | from bytes to samples on one time base |
//! | [`mavlink`] | frames and messages of MAVLink, and which field is which channel |
//! | [`engine`] | from arrivals to documents: receiver and estimation, without threads |
//! | [`document`] | the documents that are published, as JSON |
//! | [`event`] | kinds of events |
//! | [`link`] | counts of the link and the latency |
//! | [`run`] | a live estimation with its threads |
//! | [`publish`] | documents as lines of text |
//! | [`page`] | the files of the web page |
//! | [`view`] | a finished result, made ready for the page |
//! | [`stop`] | the wish that everything end, shared by all threads |
//! | `server` | the page and the documents over HTTP (feature `server`) |
//! | `tui` | the terminal view (feature `tui`) |
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod airspeed;
pub mod arrival;
mod audience;
mod budget;
pub mod document;
pub mod engine;
pub mod event;
mod json;
pub mod link;
pub mod mavlink;
pub mod page;
pub mod publish;
pub mod receiver;
pub mod recording;
pub mod run;
#[cfg(feature = "server")]
pub mod server;
pub mod source;
pub mod stop;
mod text;
mod timing;
#[cfg(feature = "tui")]
pub mod tui;
pub mod view;
