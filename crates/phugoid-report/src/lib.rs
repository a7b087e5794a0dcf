#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | holds |
//! |---|---|
//! | [`figure`] | what a figure shows: panels, axes, curves, colours, as plain data |
//! | [`statistics`] | the fit of each output and the autocorrelation of residuals |
//!
//! Everything else is private; its functions are re-exported here. A [`Figure`] knows what is shown; the private module
//! `layout` decides where it stands, and one writer each makes SVG and PNG of the same shapes.

mod arena;
mod chart;
mod clip;
mod curves;
mod decimate;
mod draw;
mod error;
mod escape;
pub mod figure;
mod figures;
mod font;
mod grid;
mod heat_map;
mod html;
mod layout;
mod legend;
mod lettering;
mod matrix;
mod names;
mod plot_area;
mod png;
mod scene;
mod sheet;
pub mod statistics;
mod svg;
mod ticks;
mod write;

pub use arena::arena_figures;
pub use chart::chart_figure;
pub use error::ReportError;
pub use figure::Figure;
pub use figures::{TimeHistoryPanel, coherence_figures, figures, time_histories};
pub use html::{
    HtmlOptions, NotRun, ReproductionOptions, StudyPage, StudySection, arena_html, html, reproduction_html, study_html,
};
pub use ticks::significant;
pub use write::{is_figure, write_figures, write_named_figures};
