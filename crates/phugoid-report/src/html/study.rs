//! A page of tables and charts under headings, for results such as a designed input.

use phugoid_evaluation::chart::Chart;
use phugoid_evaluation::table::Table;

use super::page::{self, Section, prose};
use super::reproduction::plain_table;
use crate::chart::chart_figure;

/// A section of a [`StudyPage`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudySection {
    /// Anchor: a word without blanks, which has to be unique in the page.
    pub anchor: String,
    /// Heading of the section, as plain text.
    pub heading: String,
    /// Paragraphs. Text between backticks is set as code.
    pub paragraphs: Vec<String>,
    /// Tables, which stand below the paragraphs.
    pub tables: Vec<Table>,
    /// Charts, which stand below the tables.
    pub charts: Vec<Chart>,
}

/// A page of tables and charts; [`study_html`] writes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyPage {
    /// Heading of the page, as plain text.
    pub title: String,
    /// Line below the heading, such as `Designed by Phugoid`.
    pub by: String,
    /// Paragraphs under the heading, such as how to repeat the study. Text between backticks is set as code.
    pub notes: Vec<String>,
    /// Short facts that stand side by side, each with name and value. Those with an empty value are left out.
    pub facts: Vec<(String, String)>,
    /// Sections in the order in which they are shown. Those without content are left out.
    pub sections: Vec<StudySection>,
}

/// Tables and charts as one HTML page without scripts and without links to other files. Two calls with the same page
/// give the same bytes.
///
/// ```
/// use phugoid_report::{StudyPage, StudySection, study_html};
/// use phugoid_evaluation::table::{Cell, Column, Table};
///
/// let table = Table {
///     title: "Bounds".to_owned(),
///     columns: vec![Column::new("Parameter", ""), Column::new("Sigma", "1/rad")],
///     rows: vec![vec![Cell::from("Cm_alpha"), Cell::from(0.0203)]],
/// };
/// let section = StudySection { anchor: "bounds".to_owned(), tables: vec![table], ..StudySection::default() };
/// let page = study_html(&StudyPage { title: "A < B".to_owned(), sections: vec![section], ..StudyPage::default() });
/// assert!(page.contains("<h1>A &lt; B</h1>") && page.contains("<td class=\"n\">0.02030</td>"));
/// ```
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
