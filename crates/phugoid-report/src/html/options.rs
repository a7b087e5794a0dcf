//! What a page of an estimation says beyond it.

/// What a page says beyond the estimation itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HtmlOptions {
    /// Heading; `Parameter estimation: SOURCE` where none.
    pub title: Option<String>,
    /// Paragraphs shown under the heading, e.g. what was flown and how to repeat it.
    pub notes: Vec<String>,
    /// Settings of the estimator as name and value, in the order to show them.
    pub settings: Vec<(String, String)>,
}
