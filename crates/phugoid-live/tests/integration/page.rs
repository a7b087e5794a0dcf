//! The page while others misuse its server.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use phugoid_live::document::DocumentKind;
use phugoid_live::server::{Hub, Server};

fn ask(address: SocketAddr, path: &str) -> TcpStream {
    let mut connection = TcpStream::connect(address).unwrap();
    write!(connection, "GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    connection
}

/// Whether a new reader is answered. Before there were places for it, it was for ten seconds not, and behind readers
/// that do not read never.
fn is_served(address: SocketAddr, path: &str) -> bool {
    let mut connection = ask(address, path);
    connection.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let mut start = [0; 15];
    connection.read_exact(&mut start).is_ok() && &start == b"HTTP/1.1 200 OK"
}

#[test]
fn a_new_reader_is_served_whatever_others_do() {
    let hub = Hub::default();
    let document = format!("{{\"type\":\"estimate\",\"text\":\"{}\"}}", "x".repeat(5000));
    let publish = || hub.publish(DocumentKind::Estimate { shown: true, readiness: true }, &document);
    (0..1200).for_each(|_| publish());
    let server = Server::listen("127.0.0.1:0".parse().unwrap(), None).unwrap();
    let address = server.address().unwrap();
    server.spawn(hub.clone()).unwrap();

    let silent: Vec<TcpStream> = (0..64).map(|_| TcpStream::connect(address).unwrap()).collect();
    let never_reading: Vec<TcpStream> = (0..64).map(|_| ask(address, "/events")).collect();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| (0..2000).for_each(|_| drop(TcpStream::connect(address))));
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                publish();
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        for path in ["/", "/result.json", "/events"] {
            assert!(is_served(address, path), "{path}");
        }
        over.store(true, Ordering::Relaxed);
    });
    assert!(is_served(address, "/"));
    drop((silent, never_reading));
}
