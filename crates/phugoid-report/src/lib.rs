//! Figures and self-contained HTML reports of an estimation.
//!
//! An [`Estimation`](phugoid_identification::estimation::Estimation) is plain data; [`figures()`] turns it into
//! [`Figure`]s that know what is shown but not how, `layout` places them, and one writer each makes SVG and PNG of the
//! same shapes. [`html()`] puts the figures and tables into one page without any reference to the network.
//!
//! Nothing is estimated here. The only numbers computed are descriptions of residuals, in [`statistics`].

mod arena;
mod chart;
mod clip;
mod curves;
mod decimate;
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
mod matrix;
mod names;
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
pub use figures::{TimeHistoryPanel, figures, time_histories};
pub use html::{
    HtmlOptions, NotRun, ReproductionOptions, StudyPage, StudySection, arena_html, html, reproduction_html, study_html,
};
pub use ticks::significant;
pub use write::{write_figures, write_named_figures};
