//! The page that the server shows: files that need nothing from the network.

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

/// The files of the page. They read the documents of `/events` (server-sent events) and show them.
pub const ASSETS: &[Asset] =
    &[Asset { path: "/", content_type: "text/html; charset=utf-8", body: include_bytes!("../assets/plain.html") }];
