//! What a page of reproductions shows beside them.

/// What the page of [`reproduction_html`](crate::reproduction_html) shows beside the cases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReproductionOptions {
    /// Heading; `None` gives `The thesis, case by case`.
    pub title: Option<String>,
    /// Paragraphs under the heading, such as how to repeat the cases. Text between backticks is set as code.
    pub notes: Vec<String>,
    /// Cases and studies that ended without a result.
    pub not_run: Vec<NotRun>,
}

/// A case or study without a result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NotRun {
    /// Id of the case, such as `noise/2`.
    pub id: String,
    /// Why there is no result, for people.
    pub reason: String,
}
