//! The page that the server shows: one file that needs nothing from the network.
//!
//! `assets/dashboard` holds it in parts; `index.html` names them, in the order in which they are put into it.

use std::sync::LazyLock;

use serde::Serialize;

/// One file of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asset {
    /// Path under which the server gives it; `/` is the page itself.
    pub path: &'static str,
    /// MIME type, with the character set where it is text.
    pub content_type: &'static str,
    /// Content.
    pub body: &'static [u8],
}

/// The files of the page. They read the documents of `events` beside it (server-sent events) and show them; what the page's address
/// has after `?` goes along.
pub static ASSETS: LazyLock<Vec<Asset>> =
    LazyLock::new(|| vec![Asset { path: "/", content_type: "text/html; charset=utf-8", body: PAGE.as_bytes() }]);

const INDEX: &str = include_str!("../assets/dashboard/index.html");

macro_rules! parts {
    ($($name:literal),* $(,)?) => { &[$(($name, include_str!(concat!("../assets/dashboard/", $name)))),*] };
}

/// What `index.html` names, by name.
const PARTS: &[(&str, &str)] = parts![
    "style.css",
    "format.js",
    "axis.js",
    "store.js",
    "window.js",
    "chart.js",
    "flight.js",
    "panels.js",
    "link.js",
    "stream.js",
    "status.js",
    "controls.js",
    "main.js",
];

/// Where a result stands in a page that has its data inside.
const DATA: &str = "<!-- data -->";

/// The page with all its parts inside.
static PAGE: LazyLock<String> = LazyLock::new(|| {
    let mut page = INDEX.to_owned();
    for (name, text) in PARTS {
        page = page
            .replace(&format!("<link rel=\"stylesheet\" href=\"{name}\">"), &format!("<style>\n{text}</style>"))
            .replace(&format!("<script src=\"{name}\"></script>"), &format!("<script>\n{text}</script>"));
    }
    page
});

/// The page with a result inside, to be kept as a file or served: it asks nothing of a server.
///
/// # Errors
/// Those of serialisation.
pub fn with_result<T: Serialize>(result: &T) -> Result<String, serde_json::Error> {
    // Within a script element only `<` could end it; JSON has it in strings alone, where it may be written so.
    let data = serde_json::to_string(result)?.replace('<', "\\u003c");
    Ok(PAGE.replacen(DATA, &format!("<script type=\"application/json\" id=\"data\">{data}</script>"), 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_every_part_and_refers_to_nothing() {
        for (name, text) in PARTS {
            assert!(PAGE.contains(text), "{name} is not named by index.html");
            assert!(!text.contains("</script") && !text.contains("</style"), "{name} would end its element");
        }
        for reference in ["<script src", "rel=\"stylesheet\"", "http://", "https://", "@import", "url("] {
            assert!(!PAGE.contains(reference), "the page refers to something else: {reference}");
        }
        assert_eq!(PAGE.matches(DATA).count(), 1);
        assert!(ASSETS.iter().any(|asset| asset.path == "/" && asset.body == PAGE.as_bytes()));
    }

    #[test]
    fn a_result_cannot_end_its_element() {
        let page = with_result(&"a </script><b>").unwrap();
        assert!(page.contains(r#"id="data">"a \u003c/script>\u003cb>"</script>"#), "{page}");
    }
}
