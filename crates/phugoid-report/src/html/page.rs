//! The parts of every page: its frame, sections, figures, tables and text.

use std::fmt::Write as _;

use crate::escape::escape;
use crate::figure::Figure;

const STYLE: &str = include_str!("style.css");

/// A section of a page with its heading.
pub(super) struct Section {
    /// Anchor, which has to be unique in the page.
    pub(super) anchor: String,
    /// Heading as plain text; it is escaped when the page is written.
    pub(super) heading: String,
    /// Content as markup, escaped already.
    pub(super) body: String,
}

impl Section {
    /// A section; anchor and heading are plain text, the body is markup.
    pub(super) fn new(anchor: &str, heading: &str, body: String) -> Self {
        Self { anchor: anchor.to_owned(), heading: heading.to_owned(), body }
    }
}

/// A whole page. `header` is markup between the notes and the links to the sections. Sections with an empty body are
/// left out.
pub(super) fn document(title: &str, by: &str, notes: &[String], header: &str, sections: &[Section]) -> String {
    let sections: Vec<&Section> = sections.iter().filter(|s| !s.body.is_empty()).collect();
    let mut page = String::new();
    // Writing into a String cannot fail, here and below.
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<header>\n<h1>{title}</h1>\n\
         <p class=\"by\">{by}</p>\n",
        title = escape(title),
        by = escape(by)
    );
    for note in notes {
        let _ = writeln!(page, "<p>{}</p>", prose(note));
    }
    page.push_str(header);
    page.push_str("<nav aria-label=\"Sections\">");
    for section in &sections {
        let _ = write!(page, "<a href=\"#{}\">{}</a> ", escape(&section.anchor), escape(&section.heading));
    }
    page.push_str("</nav>\n</header>\n");
    for Section { anchor, heading, body } in sections {
        let (anchor, heading) = (escape(anchor), escape(heading));
        let _ = write!(page, "<section id=\"{anchor}\">\n<h2>{heading}</h2>\n{body}</section>\n");
    }
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

/// The page with a script at its end, after everything that the script looks for. A page without a figure over the time needs
/// none.
pub(super) fn with_script(page: String, script: &str) -> String {
    if !page.contains("<g class=\"plot\"") {
        return page;
    }
    page.replacen("</main>\n</body>", &format!("</main>\n<script>\n{script}</script>\n</body>"), 1)
}

/// Short facts side by side. Those with an empty value are left out.
pub(super) fn facts(facts: &[(&str, String)]) -> String {
    let mut out = String::from("<dl class=\"facts\">\n");
    for (name, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
        let _ = writeln!(out, "<div><dt>{name}</dt><dd>{}</dd></div>", breakable(value));
    }
    out.push_str("</dl>\n");
    out
}

/// A figure with its caption and with its title as a heading of this level.
pub(super) fn figure(anchor: &str, level: u8, figure: &Figure) -> String {
    format!(
        "<figure id=\"{}\">\n<h{level}>{}</h{level}>\n<div class=\"scroll\">{}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
        escape(anchor),
        escape(&figure.title),
        figure.to_inline_svg(),
        escape(&figure.caption)
    )
}

/// The beginning of a table, which [`END_OF_TABLE`] ends. Each head has a class (`n` for a column of numbers) and
/// markup.
pub(super) fn table<T: AsRef<str>>(heads: &[(&str, T)]) -> String {
    format!("<div class=\"scroll\"><table>\n{}<tbody>\n", head(heads))
}

/// The end of a table.
pub(super) const END_OF_TABLE: &str = "</tbody></table></div>\n";

/// The row of the heads of a table.
pub(super) fn head<T: AsRef<str>>(heads: &[(&str, T)]) -> String {
    let cells: String = heads
        .iter()
        .map(|(class, words)| format!("<th scope=\"col\"{}>{}</th>", class_of(class), words.as_ref()))
        .collect();
    format!("<thead><tr>{cells}</tr></thead>\n")
}

fn class_of(class: &str) -> String {
    if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") }
}

/// Escaped text that a browser may break after each slash of a path.
pub(super) fn breakable(text: &str) -> String {
    escape(text).replace('/', "/<wbr>")
}

/// Escaped text in which text between backticks is set as code. With an odd number of backticks they stay as they are. The
/// signs of a terminal, `+-` and `->`, become those of print.
pub(super) fn prose(text: &str) -> String {
    let text = &text.replace(" +- ", " ± ").replace(" -> ", " → ");
    if text.matches('`').count() % 2 == 1 {
        return escape(text);
    }
    text.split('`')
        .enumerate()
        .map(|(k, part)| if k % 2 == 1 { format!("<code>{}</code>", escape(part)) } else { escape(part) })
        .collect()
}

/// A number without trailing zeros, `0.01000` as `0.01`, for numbers that are settings and not results.
pub(super) fn trimmed(number: &str) -> &str {
    if number.contains('.') && !number.contains('·') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}
