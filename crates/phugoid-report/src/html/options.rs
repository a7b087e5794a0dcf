//! What a page of an estimation shows beside the estimation.

/// What the page of [`html`](crate::html()) shows beside the estimation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HtmlOptions {
    /// Heading; `None` gives `Parameter estimation:` and the name of the record.
    pub title: Option<String>,
    /// Paragraphs under the heading, such as what was flown and how to repeat it. Text between backticks is set as
    /// code.
    pub notes: Vec<String>,
    /// Settings of the estimator as name and value, in the order in which they are shown.
    pub settings: Vec<(String, String)>,
}
