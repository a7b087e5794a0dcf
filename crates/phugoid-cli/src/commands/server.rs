//! Starts the server of a web page.

use std::io;

use phugoid_live::server::{Server, random_token};

use super::live::say;
use crate::arguments::address::Address;
use crate::failure::Failure;

/// Listens on the given address and prints where the page is.
pub(crate) fn listen(at: &Address) -> Result<Server, Failure> {
    let failed = |error: io::Error| no_page(at, &error);
    let token = match &at.token {
        None if !at.listen.ip().is_loopback() => Some(random_token().map_err(failed)?),
        given => given.clone(),
    };
    let mut server = Server::listen(at.listen, token.clone());
    // Another one runs already: the next free port is as good, for it is said.
    if server.as_ref().is_err_and(|error| error.kind() == io::ErrorKind::AddrInUse) {
        say(&format!("{} is in use; another port is taken", at.listen));
        server = Server::listen((at.listen.ip(), 0).into(), token.clone());
    }
    let server = server.map_err(failed)?;
    let address = server.address().map_err(failed)?;
    let query = token.map(|token| format!("?token={token}")).unwrap_or_default();
    say(&format!("page: http://{address}/{query}"));
    Ok(server)
}

pub(crate) fn no_page(at: &Address, error: &io::Error) -> Failure {
    Failure::input(format!("cannot serve a page at {}: {error}", at.listen))
}
