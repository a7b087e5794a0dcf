//! Network address and access token of a web page that a command serves.

use std::net::SocketAddr;

use clap::Args;

/// Network address and access token of the web page.
#[derive(Debug, Args)]
pub(crate) struct Address {
    /// Serve the page at this address and port. If other machines can reach the address, the page asks for a token
    #[arg(long, value_name = "[HOST:]PORT", value_parser = address, default_value = "127.0.0.1:8360")]
    pub(crate) listen: SocketAddr,
    /// Use this token instead of a random one: at least eight letters, digits or -_.~
    #[arg(long, value_name = "TOKEN", value_parser = token)]
    pub(crate) token: Option<String>,
}

fn address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.parse::<u16>() {
        return Ok(([127, 0, 0, 1], port).into());
    }
    text.parse().map_err(|_| "write an address and a port, as in 127.0.0.1:8360 or 0.0.0.0:8360".to_owned())
}

fn token(text: &str) -> Result<String, String> {
    let plain = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte));
    match plain && text.len() >= 8 {
        true => Ok(text.to_owned()),
        false => Err("a token has at least eight letters, digits or -_.~".to_owned()),
    }
}
