//! What can be wrong with a DAVE-ML model, with the line where it is.

use std::path::PathBuf;

use crate::xml::XmlError;

/// Why a DAVE-ML text is no model that can be evaluated. Lines count from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DavemlError {
    /// The file could not be read, or its text is not XML within the limits of [`crate::xml`].
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// The text of a file is no model; the source says why.
    #[error("{}: {source}", file.display())]
    InFile {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        source: Box<DavemlError>,
    },
    /// The outermost element is not `DAVEfunc`.
    #[error("line {line}: the outermost element is <{element}>, not <DAVEfunc>: it is no DAVE-ML")]
    NotDaveml {
        /// Name of the outermost element.
        element: String,
        /// Its line.
        line: u32,
    },
    /// An element that DAVE-ML does not have at this place, or a MathML function that is not known.
    #[error("line {line}: the element <{element}> is not known inside <{parent}>")]
    UnknownElement {
        /// The element.
        element: String,
        /// The element around it.
        parent: String,
        /// Its line.
        line: u32,
    },
    /// Something that the standard has and this reader refuses.
    #[error("line {line}: {what} is not supported")]
    Unsupported {
        /// What is refused.
        what: String,
        /// Its line.
        line: u32,
    },
    /// An element that has to be there is missing.
    #[error("line {line}: <{parent}> has no <{element}>")]
    MissingElement {
        /// The element that is missing.
        element: &'static str,
        /// The element that should contain it.
        parent: String,
        /// Line of the containing element.
        line: u32,
    },
    /// An attribute that has to be there is missing or empty.
    #[error("line {line}: <{element}> has no attribute `{attribute}`")]
    MissingAttribute {
        /// The attribute.
        attribute: &'static str,
        /// The element that should have it.
        element: String,
        /// Line of the element.
        line: u32,
    },
    /// A text stands where a finite number should be; NaN and infinity are refused too.
    #[error("line {line}: `{text}` in {place} is not a finite number")]
    Number {
        /// What stands there.
        text: String,
        /// The element or attribute.
        place: String,
        /// Its line.
        line: u32,
    },
    /// An attribute has a value that the standard does not list.
    #[error("line {line}: {attribute}=\"{value}\" is not one of {allowed}")]
    Choice {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
        /// What the standard lists.
        allowed: &'static str,
        /// Its line.
        line: u32,
    },
    /// A MathML function has fewer or more operands than it can have.
    #[error("line {line}: <{function}> cannot have {found} operands")]
    Operands {
        /// The function.
        function: String,
        /// How many it has.
        found: usize,
        /// Its line.
        line: u32,
    },
    /// A `varID` that no `variableDef` defines.
    #[error("line {line}: there is no variable `{id}`")]
    UnknownVariable {
        /// The identifier.
        id: String,
        /// Where it is used.
        line: u32,
    },
    /// A `gtID` or `utID` that no table has.
    #[error("line {line}: there is no table `{id}`")]
    UnknownTable {
        /// The identifier.
        id: String,
        /// Where it is used.
        line: u32,
    },
    /// A `bpID` that no `breakpointDef` has.
    #[error("line {line}: there are no breakpoints `{id}`")]
    UnknownBreakpoints {
        /// The identifier.
        id: String,
        /// Where it is used.
        line: u32,
    },
    /// An identifier is given twice.
    #[error("line {line}: the {kind} `{id}` is defined a second time")]
    Repeated {
        /// What is repeated: variable, table or breakpoints.
        kind: &'static str,
        /// The identifier.
        id: String,
        /// Line of the second definition.
        line: u32,
    },
    /// A table has not as many values as its breakpoints ask for.
    #[error("line {line}: the table has {found} values; its breakpoints ask for {expected}")]
    TableSize {
        /// Product of the numbers of breakpoints; the largest number where the product has no place in it.
        expected: usize,
        /// How many values stand there.
        found: usize,
        /// Line of the table.
        line: u32,
    },
    /// A function has not as many independent variables as its table has dimensions.
    #[error("line {line}: a function of {variables} variables refers to a table of {dimensions} dimensions")]
    Dimensions {
        /// Number of independent variables of the function.
        variables: usize,
        /// Number of dimensions of the table.
        dimensions: usize,
        /// Line of the function.
        line: u32,
    },
    /// Breakpoints, or the abscissas of a one-dimensional ungridded table, do not increase strictly.
    #[error("line {line}: the values {before} and {after} follow each other; breakpoints have to increase")]
    NotIncreasing {
        /// A value.
        before: f64,
        /// The value after it, which is not larger.
        after: f64,
        /// Line of the breakpoints.
        line: u32,
    },
    /// A lower limit lies above an upper limit.
    #[error("line {line}: the lower limit {lower} lies above the upper limit {upper}")]
    Limits {
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
        /// Line of the element that states them.
        line: u32,
    },
    /// A variable is computed by more than one calculation or function.
    #[error("line {line}: the variable `{id}` is computed a second time")]
    ComputedTwice {
        /// The variable.
        id: String,
        /// Line of the second calculation or function.
        line: u32,
    },
    /// Variables depend on each other in a circle, so none can be computed first.
    #[error("line {line}: variables depend on each other in a circle: {}", variables.join(" needs "))]
    Cycle {
        /// The circle; its first and last variable are the same, and at most twenty are named.
        variables: Vec<String>,
        /// Line of the first of them.
        line: u32,
    },
    /// The points of an ungridded table span no triangle, or repeat each other.
    #[error("line {line}: the ungridded table {problem}")]
    Scattered {
        /// What is wrong.
        problem: String,
        /// Line of the table.
        line: u32,
    },
    /// More of something than this reader takes.
    #[error("line {line}: {found} {what}; at most {limit} are read")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are read.
        limit: usize,
        /// Its line.
        line: u32,
    },
    /// A name, asked for or used in check data, that no variable has as its `varID` or its name.
    #[error("{}there is no variable with the name or varID `{name}`", at_line(*line))]
    UnknownSignal {
        /// The name.
        name: String,
        /// Line in the check data; none where a program asked.
        line: Option<u32>,
    },
    /// A variable that is computed cannot be set.
    #[error("{}the variable `{id}` is computed and cannot be set", at_line(*line))]
    NotAnInput {
        /// The variable.
        id: String,
        /// Line in the check data; none where a program asked.
        line: Option<u32>,
    },
}

/// The beginning of a message that may have a line.
fn at_line(line: Option<u32>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}

/// The beginning of a text from a file, which could be of any length.
pub(super) fn brief(text: &str) -> String {
    text.trim().chars().take(80).collect()
}
