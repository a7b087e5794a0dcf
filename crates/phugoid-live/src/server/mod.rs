//! The page and the stream of documents over HTTP, on a thread of their own that never holds up the estimation.

mod access;
mod events;
mod hub;

use std::convert::Infallible;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

use http_body_util::{Either, Full};
use hyper::body::{Bytes, Incoming};
use hyper::header::{self, HeaderValue};
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::sync::Semaphore;

use crate::page::ASSETS;
pub use access::{Access, random_token};
use events::Events;
pub use hub::Hub;

/// Connections at one time; further ones wait.
const CONNECTIONS: usize = 64;
/// A client that has not said what it wants after this long is let go.
const TO_ASK: Duration = Duration::from_secs(10);

/// What is served.
#[derive(Clone)]
enum Content {
    /// A flight: the page, and its documents as they come.
    Flight(Hub),
    /// A page with its data inside.
    Page(Bytes),
}

type Body = Either<Full<Bytes>, Events>;

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    access: Access,
}

impl Server {
    /// Listens at an address. Where it is not this machine's own alone, `token` is asked of everybody.
    ///
    /// # Errors
    /// What the system says; [`io::ErrorKind::PermissionDenied`] for an address that others reach without a token.
    pub fn listen(address: SocketAddr, token: Option<String>) -> io::Result<Self> {
        if token.is_none() && !address.ip().is_loopback() {
            return Err(io::Error::new(
                io::ErrorKind::PermissionDenied,
                format!("{address} can be reached from other machines: a token is needed"),
            ));
        }
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, access: Access::new(token) })
    }

    /// Where it listens; the port is the system's choice if 0 was asked for.
    ///
    /// # Errors
    /// What the system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Serves what the hub holds until the program ends.
    ///
    /// # Errors
    /// The system gives no thread or no way to wait for connections.
    pub fn spawn(self, hub: Hub) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let serve = move || {
            // Said by the estimation where it matters; without a listener there is nobody to tell.
            let _ = runtime.block_on(serve(self, Content::Flight(hub)));
        };
        std::thread::Builder::new().name("server".to_owned()).spawn(serve).map(|_| ())
    }

    /// Serves one page, such as a result with its data inside, on this thread, until the program ends.
    ///
    /// # Errors
    /// The system gives no way to wait for connections.
    pub fn serve_page(self, page: String) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(serve(self, Content::Page(page.into())))
    }
}

async fn serve(server: Server, content: Content) -> io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(server.listener)?;
    let access = Arc::new(server.access);
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let Ok(place) = Arc::clone(&places).acquire_owned().await else { return Ok(()) };
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            Err(_) => {
                // Such as too many open files: the next may go well.
                tokio::time::sleep(Duration::from_millis(100)).await;
                continue;
            }
        };
        let (content, access) = (content.clone(), Arc::clone(&access));
        tokio::spawn(async move {
            let answer = service_fn(move |request| {
                let response = answer(&request, &content, &access);
                async move { Ok::<_, Infallible>(response) }
            });
            let mut http = hyper::server::conn::http1::Builder::new();
            http.timer(TokioTimer::new()).header_read_timeout(TO_ASK);
            // A client that breaks off is nobody's trouble.
            let _ = http.serve_connection(TokioIo::new(stream), answer).await;
            drop(place);
        });
    }
}

fn answer(request: &Request<Incoming>, content: &Content, access: &Access) -> Response<Body> {
    if let Err((status, why)) = access.check(request) {
        return text(status, "text/plain; charset=utf-8", why.into());
    }
    if ![Method::GET, Method::HEAD].contains(request.method()) {
        return text(StatusCode::METHOD_NOT_ALLOWED, "text/plain; charset=utf-8", "only GET and HEAD\n".into());
    }
    const NONE: &str = "there is no such page\n";
    match (content, request.uri().path()) {
        (Content::Flight(hub), "/events") => {
            let mut response = Response::new(Either::Right(Events::new(hub.clone())));
            set(&mut response, "text/event-stream");
            response
        }
        (Content::Flight(hub), "/result.json") => text(StatusCode::OK, "application/json", hub.snapshot().into()),
        (Content::Flight(_), path) => match ASSETS.iter().find(|asset| asset.path == path) {
            Some(asset) => text(StatusCode::OK, asset.content_type, Bytes::from_static(asset.body)),
            None => text(StatusCode::NOT_FOUND, "text/plain; charset=utf-8", NONE.into()),
        },
        (Content::Page(page), "/") => text(StatusCode::OK, "text/html; charset=utf-8", page.clone()),
        (Content::Page(_), _) => text(StatusCode::NOT_FOUND, "text/plain; charset=utf-8", NONE.into()),
    }
}

fn text(status: StatusCode, content_type: &'static str, body: Bytes) -> Response<Body> {
    let mut response = Response::new(Either::Left(Full::new(body)));
    *response.status_mut() = status;
    set(&mut response, content_type);
    response
}

fn set<B>(response: &mut Response<B>, content_type: &'static str) {
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(content_type));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    // The token may stand in the address.
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    // The page is whole in itself; nothing that could get into it may reach anywhere else.
    let policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                  connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
}
