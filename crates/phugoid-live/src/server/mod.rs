//! The page and the stream of documents over HTTP, on a thread of its own, so that the estimation never waits for a
//! client.

mod access;
mod connections;
mod events;
mod hub;
mod patient;

use std::convert::Infallible;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::{Duration, Instant};

use http_body_util::{Either, Full};
use hyper::body::{Bytes, Incoming};
use hyper::header::{self, HeaderValue};
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};

use crate::page::ASSETS;
pub use access::{Access, random_token};
use connections::{Connections, Place, Stage};
use events::Events;
pub use hub::Hub;
use patient::Patient;

/// A connection whose request has not come after this time is closed.
const REQUEST_WITHIN: Duration = Duration::from_secs(10);
/// A connection that takes nothing of what is sent to it for this long is closed.
const STUCK: Duration = Duration::from_secs(10);
/// Bytes of a request, and of an answer that wait for the operating system, per connection.
const WAITING_BYTES: usize = 32 << 10;
/// Connections that wait to be accepted; the operating system may allow fewer.
#[cfg(unix)]
const BACKLOG: i32 = 4096;
/// Bytes that the operating system is asked to hold for a slow reader, per connection.
#[cfg(unix)]
const SYSTEM_BYTES: usize = 128 << 10;

/// What the server gives.
#[derive(Clone)]
enum Content {
    /// A flight: the page and its documents as they are published.
    Flight(Hub),
    /// A page with its data inside.
    Page(Bytes),
}

type Body = Either<Full<Bytes>, Events>;

/// A server that listens on an address and has not begun to serve.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    access: Access,
}

impl Server {
    /// Listens on an address. With a token every request has to give it, as `?token=...` or as `Authorization: Bearer
    /// ...`. Without one only loopback addresses are allowed.
    ///
    /// ```
    /// use phugoid_live::server::{Server, random_token};
    ///
    /// let server = Server::listen("127.0.0.1:0".parse()?, None)?;
    /// assert_ne!(server.address()?.port(), 0);
    /// let refused = Server::listen("0.0.0.0:0".parse()?, None);
    /// assert!(refused.is_err_and(|error| error.kind() == std::io::ErrorKind::PermissionDenied));
    /// assert_eq!(random_token()?.len(), 32);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`io::ErrorKind::PermissionDenied`] for an address that other machines can reach, without a token;
    /// [`io::ErrorKind::AddrInUse`] if the port is in use; else what the operating system says.
    pub fn listen(address: SocketAddr, token: Option<String>) -> io::Result<Self> {
        if token.is_none() && !address.ip().is_loopback() {
            return Err(io::Error::new(
                io::ErrorKind::PermissionDenied,
                format!("{address} can be reached from other machines: a token is needed"),
            ));
        }
        let listener = TcpListener::bind(address)?;
        // With the usual 128 a burst of short connections makes the system turn new readers away for a second and more.
        #[cfg(unix)]
        rustix::net::listen(&listener, BACKLOG)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, access: Access::new(token) })
    }

    /// The address on which it listens. If port 0 was asked for, it has the port that the operating system chose.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Serves the page and the documents of the hub on a thread of its own, until the program ends: `/`, `/events`
    /// (server-sent events) and `/result.json`.
    ///
    /// # Errors
    /// What the operating system says if it gives no thread or no way to wait for connections.
    pub fn spawn(self, hub: Hub) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let serve = move || {
            // It returns only if the listener cannot be used; there is no client then who could be told.
            let _ = runtime.block_on(serve(self, Content::Flight(hub)));
        };
        std::thread::Builder::new().name("server".to_owned()).spawn(serve).map(|_| ())
    }

    /// Serves one page at `/`, such as a result with its data inside, on the calling thread, until the program ends.
    ///
    /// # Errors
    /// What the operating system says if it gives no way to wait for connections.
    pub fn serve_page(self, page: String) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(serve(self, Content::Page(page.into())))
    }
}

async fn serve(server: Server, content: Content) -> io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(server.listener)?;
    let access = Arc::new(server.access);
    let connections = Connections::default();
    loop {
        let (stream, from) = match listener.accept().await {
            Ok(accepted) => accepted,
            Err(_) => {
                // For example too many open files. Later connections may succeed.
                tokio::time::sleep(Duration::from_millis(100)).await;
                continue;
            }
        };
        // Without it the system may hold megabytes for a reader that does not read.
        #[cfg(unix)]
        let _ = rustix::net::sockopt::set_socket_send_buffer_size(&stream, SYSTEM_BYTES);
        let (content, access) = (content.clone(), Arc::clone(&access));
        let place = Arc::new(connections.place(from.ip().to_canonical(), Instant::now()));
        let number = place.number();
        let task = tokio::spawn(async move {
            let (asking, writing) = (Arc::clone(&place), Arc::clone(&place));
            let answer = service_fn(move |request| {
                asking.reaches(Stage::Answered);
                let response = answer(&request, &content, &access);
                async move { Ok::<_, Infallible>(response) }
            });
            let mut http = hyper::server::conn::http1::Builder::new();
            // One request each: a connection that has been answered holds no place.
            http.timer(TokioTimer::new()).header_read_timeout(REQUEST_WITHIN).keep_alive(false);
            http.max_buf_size(WAITING_BYTES);
            let stuck = move |stuck| writing.reaches(if stuck { Stage::Stuck } else { Stage::Answered });
            let stream = Patient::new(stream, STUCK, stuck);
            // The error of a client that broke off needs no action.
            let _ = http.serve_connection(TokioIo::new(stream), answer).await;
            drop(place);
        });
        Place::is_served_by(&connections, number, task.abort_handle());
        // The requests of those that were accepted are read before the next one is.
        tokio::task::yield_now().await;
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
    // The token may stand in the address, which must not be sent to other sites.
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    // The page needs nothing from elsewhere, so whatever might get into it must not reach anything else.
    let policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                  connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
}
