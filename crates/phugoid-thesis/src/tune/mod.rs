//! Tuning of the published laws on the cases of the thesis: the rules that set them, and what a search
//! ([`phugoid_evaluation::tune`]) is made on.

pub mod cases;
mod flight_law;
pub mod material;
mod plant_law;
pub mod rule;
