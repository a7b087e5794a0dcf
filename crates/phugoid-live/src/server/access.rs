//! Who may read the page and the documents.

use std::io;

use hyper::{Request, StatusCode, header};

/// Who may read. With a token, those who know it; without one, requests to this machine under its own name.
#[derive(Debug)]
pub struct Access {
    token: Option<String>,
}

/// A new token: 128 random bits as 32 hexadecimal digits.
///
/// # Errors
/// What the operating system says if it gives no random numbers.
pub fn random_token() -> io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

impl Access {
    pub(super) fn new(token: Option<String>) -> Self {
        Self { token }
    }

    /// Checks a request. The error is the status and the sentence with which it is refused.
    pub(super) fn check<B>(&self, request: &Request<B>) -> Result<(), (StatusCode, &'static str)> {
        let header = |name| request.headers().get(name).and_then(|value| value.to_str().ok());
        let Some(token) = &self.token else {
            // Protects against DNS rebinding: a web site whose name points to this machine must not read the data
            // through a browser.
            let host = header(header::HOST).map(host_of);
            return match host {
                Some("localhost" | "127.0.0.1" | "[::1]") => Ok(()),
                _ => Err((
                    StatusCode::FORBIDDEN,
                    "without a token, only this machine is served, as localhost or 127.0.0.1\n",
                )),
            };
        };
        let in_header = header(header::AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
        // The EventSource of a browser cannot send a header, so the token may stand in the address.
        let in_address = || {
            let query = request.uri().query()?;
            query.split('&').find_map(|pair| pair.strip_prefix("token="))
        };
        match in_header.or_else(in_address) {
            Some(given) if same(given, token) => Ok(()),
            _ => Err((
                StatusCode::UNAUTHORIZED,
                "a token is needed: add ?token=... to the address, as `phugoid live` prints it\n",
            )),
        }
    }
}

/// The name in a `Host` header, without the port.
fn host_of(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    }
}

/// Compares in a time that depends only on the lengths, so that the time does not reveal a part of the token.
fn same(given: &str, token: &str) -> bool {
    let different = given.bytes().zip(token.bytes()).fold(0, |different, (a, b)| different | (a ^ b));
    // Without this the optimiser could end the loop early.
    std::hint::black_box(different) == 0 && given.len() == token.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(token: Option<&str>, address: &str, headers: &[(&str, &str)]) -> Result<(), StatusCode> {
        let mut request = Request::builder().uri(address);
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let access = Access::new(token.map(str::to_owned));
        access.check(&request.body(()).unwrap()).map_err(|(status, _)| status)
    }

    #[test]
    fn who_may_read() {
        let secret = Some("0123abcd");
        assert_eq!(check(secret, "/events?token=0123abcd", &[]), Ok(()));
        assert_eq!(check(secret, "/events?x=1&token=0123abcd", &[]), Ok(()));
        assert_eq!(check(secret, "/", &[("authorization", "Bearer 0123abcd")]), Ok(()));
        for wrong in ["/", "/?token=", "/?token=0123abce", "/?token=0123abcdd", "/?token=0123abc"] {
            assert_eq!(check(secret, wrong, &[]), Err(StatusCode::UNAUTHORIZED), "{wrong}");
        }
        assert_eq!(check(None, "/", &[("host", "127.0.0.1:8360")]), Ok(()));
        assert_eq!(check(None, "/", &[("host", "localhost")]), Ok(()));
        assert_eq!(check(None, "/", &[("host", "evil.example:8360")]), Err(StatusCode::FORBIDDEN));
        assert_eq!(check(None, "/", &[]), Err(StatusCode::FORBIDDEN));
    }

    #[test]
    fn tokens_differ() {
        let (one, other) = (random_token().unwrap(), random_token().unwrap());
        assert!(one.len() == 32 && one != other);
    }
}
