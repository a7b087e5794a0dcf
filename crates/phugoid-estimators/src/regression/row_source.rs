//! Where the rows of a regression come from, and what is known beside them.

use super::rows::Row;
use crate::columns::Columns;
use crate::model::{Input, Sample};
use crate::settings::{ParameterPrior, RegressionSettings};

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It was refused, because its time did not increase.
    Refused,
    /// It was collected for the start of the states.
    Collected,
    /// It is the first one of a stretch: nothing before it is remembered.
    First,
    /// It ended an interval, of which the rows are there now.
    Next,
}

/// What a method knows of the regression beside its rows.
#[derive(Clone, Copy, Debug)]
pub struct Frame<const R: usize, const P: usize> {
    pub(crate) columns: Columns<R, P>,
    pub(crate) priors: [ParameterPrior; P],
    pub(crate) settings: RegressionSettings,
    /// Length of the blocks of the colour correction, s.
    pub(crate) colour_block_s: f64,
    /// Time of the last sample, s.
    pub(crate) last_s: f64,
    /// Length of the last interval, s.
    pub(crate) interval_s: f64,
    /// The model's outputs at its end before this frame was looked at.
    pub(crate) predicted: [f64; R],
    /// Outputs at its end that are no outliers; NaN for the others.
    pub(crate) believed: [f64; R],
    /// Whether a state moves by more than its noise.
    pub(crate) excited: bool,
    /// How often the states were started again.
    pub(crate) restarts: u32,
}

/// Rows `z = w theta + n`, sample by sample. The methods that use them need not know how many states there are.
pub trait RowSource<const R: usize, const P: usize> {
    /// Type of the known input of the model.
    type Input: Input;

    /// What is known beside the rows.
    fn frame(&self) -> &Frame<R, P>;

    /// Takes a sample. `theta`: the present estimate; `spread(row)`: the variance of `row theta`. After
    /// [`Taken::Collected`] and [`Taken::First`] the filters of the rows are empty.
    fn take(&mut self, sample: &Sample<Self::Input, R>, theta: &[f64; P], spread: impl Fn(&[f64; P]) -> f64) -> Taken;

    /// Gives the rows of the last frame to `use_row`, the algebraic ones first. Call it after [`Taken::Next`] only.
    fn rows(&self, use_row: impl FnMut(&Row<P>));
}
