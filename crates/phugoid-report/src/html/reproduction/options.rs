//! What a page of reproductions says beyond them.

/// What a page of reproductions says beyond them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReproductionOptions {
    /// Heading; `The thesis, case by case` where none.
    pub title: Option<String>,
    /// Paragraphs shown under the heading, e.g. how to repeat it.
    pub notes: Vec<String>,
    /// Cases and studies that ended without a result.
    pub not_run: Vec<NotRun>,
}

/// A case or study without a result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NotRun {
    /// Id.
    pub id: String,
    /// Why.
    pub reason: String,
}
