//! A page of tables and charts under headings, for results that are neither an estimation nor a reproduction.

use phugoid_evaluation::chart::Chart;
use phugoid_evaluation::table::Table;

use super::page::{self, Section, prose};
use super::reproduction::plain_table;
use crate::chart::chart_figure;

/// A section of a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudySection {
    /// Anchor, unique in the page: a word without blanks.
    pub anchor: String,
    /// Heading.
    pub heading: String,
    /// Paragraphs; `code` between backticks.
    pub paragraphs: Vec<String>,
    /// Tables, below the paragraphs.
    pub tables: Vec<Table>,
    /// Charts, below the tables.
    pub charts: Vec<Chart>,
}

/// A page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyPage {
    /// Heading.
    pub title: String,
    /// Line below it, e.g. `Designed by Phugoid`.
    pub by: String,
    /// Paragraphs under the heading, e.g. how to repeat it.
    pub notes: Vec<String>,
    /// Short facts side by side: name and value.
    pub facts: Vec<(String, String)>,
    /// Sections in the order to be shown.
    pub sections: Vec<StudySection>,
}

/// Tables and charts as one self-contained HTML page: no scripts, no links to anywhere else, figures inline. Two calls with the
/// same page give the same bytes.
pub fn study_html(page: &StudyPage) -> String {
    let facts: Vec<(&str, String)> = page.facts.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
    let sections: Vec<Section> = page
        .sections
        .iter()
        .map(|section| {
            let mut body: String = section.paragraphs.iter().map(|text| format!("<p>{}</p>\n", prose(text))).collect();
            body.extend(section.tables.iter().map(plain_table));
            for chart in &section.charts {
                let anchor = format!("{}/{}", section.anchor, chart.name);
                body.push_str(&page::figure(&anchor, 3, &chart_figure(chart)));
            }
            Section::new(&section.anchor, &section.heading, body)
        })
        .collect();
    page::document(&page.title, &page.by, &page.notes, &page::facts(&facts), &sections)
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_evaluation::table::{Cell, Column};

    #[test]
    fn a_page_holds_what_it_was_given_and_escapes_it() {
        let table = Table {
            title: "Bounds <1>".to_owned(),
            columns: vec![Column::new("Name", ""), Column::new("Sigma", "1/s")],
            rows: vec![vec![Cell::from("a & b"), Cell::from(0.25)]],
        };
        let section = StudySection {
            anchor: "one".to_owned(),
            heading: "One".to_owned(),
            paragraphs: vec!["run `phugoid`".to_owned()],
            tables: vec![table],
            charts: Vec::new(),
        };
        let page = StudyPage { title: "T".to_owned(), sections: vec![section], ..StudyPage::default() };
        let html = study_html(&page);
        for words in ["Bounds &lt;1&gt;", "a &amp; b", "0.2500", "<code>phugoid</code>", "id=\"one\""] {
            assert!(html.contains(words), "{words}: {html}");
        }
    }
}
