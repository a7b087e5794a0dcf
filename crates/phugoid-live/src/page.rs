//! The page of the dashboard: one file that needs nothing from the network.
//!
//! Its parts are in `assets/dashboard`. `index.html` names them, and each is put in place of its name.

use std::sync::LazyLock;

use serde::Serialize;

use crate::json::shown;

/// A file that the server gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asset {
    /// Path under which the server gives it; `/` is the page itself.
    pub path: &'static str,
    /// MIME type, with the character set where it is text.
    pub content_type: &'static str,
    /// The bytes of the file.
    pub body: &'static [u8],
}

/// The files of the page. The page reads the documents from `events` in the same folder (server-sent events). It sends
/// the query of its own address, in which the token may be, along with that request.
pub static ASSETS: LazyLock<Vec<Asset>> =
    LazyLock::new(|| vec![Asset { path: "/", content_type: "text/html; charset=utf-8", body: PAGE.as_bytes() }]);

const INDEX: &str = include_str!("../assets/dashboard/index.html");

macro_rules! parts {
    ($($name:literal),* $(,)?) => { &[$(($name, include_str!(concat!("../assets/dashboard/", $name)))),*] };
}

/// The files that `index.html` names, with their names.
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

/// The place in the page where the data of a result are put.
const DATA: &str = "<!-- data -->";

/// The page with all its parts in place.
static PAGE: LazyLock<String> = LazyLock::new(|| {
    let mut page = INDEX.to_owned();
    for (name, text) in PARTS {
        page = page
            .replace(&format!("<link rel=\"stylesheet\" href=\"{name}\">"), &format!("<style>\n{text}</style>"))
            .replace(&format!("<script src=\"{name}\"></script>"), &format!("<script>\n{text}</script>"));
    }
    page
});

/// The page with the data of a result inside, to be kept as a file or served. It needs no server.
///
/// ```
/// let page = phugoid_live::page::with_result(&"a </script> in a name")?;
/// assert!(page.contains(r#"id="data">"a \u003c/script> in a name"</script>"#));
/// # Ok::<(), serde_json::Error>(())
/// ```
///
/// # Errors
/// What `serde_json` says if the result cannot be serialised.
pub fn with_result<T: Serialize>(result: &T) -> Result<String, serde_json::Error> {
    // Only `<` could end the script element. In JSON it occurs in strings only, where it may be written as an escape.
    let data = shown(result)?.replace('<', "\\u003c");
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
