//! Where a page is served.

use std::net::SocketAddr;

use clap::Args;

/// Where a page is served.
#[derive(Debug, Args)]
pub(crate) struct Address {
    /// Serve the page at this address; one that other machines reach asks for a token
    #[arg(long, value_name = "[HOST:]PORT", value_parser = address, default_value = "127.0.0.1:8360")]
    pub(crate) listen: SocketAddr,
    /// The token, in place of a random one
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
