//! `phugoid live` as a user runs it: every kind of source, a kill, the token of the page, MAVLink sent on. Whatever is waited for is
//! a document, never a time.
// What goes wrong in a helper fails the test.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::common;
use crate::live_program as live;
use crate::telemetry;

use std::io::Write;
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use common::{Folder, phugoid};
use live::{Live, estimates, json, time_s};
use phugoid_live::mavlink::definitions;
use phugoid_live::mavlink::frame::{self, Found};
use serde_json::Value;
use telemetry::{csv_header, csv_rows, json_lines, message, signals};

/// Two seconds from which noise and reference are taken, and one of estimates.
const SAMPLES: u32 = 300;
const LAST_S: f64 = 2.99;

/// Estimates of the whole flight as CSV from a pipe.
fn from_standard_input(folder: &Path, text: &str) -> Vec<String> {
    let mut live = Live::start(folder, &["-", "--no-page"]);
    live.input(text.as_bytes());
    live.end_input();
    let documents = live.rest();
    let end = json(documents.last().unwrap());
    assert_eq!((&end["type"], &end["samples"]), (&"end".into(), &SAMPLES.into()), "{end}");
    assert!(end["reason"].as_str().unwrap().contains("source has ended"), "{end}");
    estimates(&documents)
}

fn whole_csv() -> String {
    csv_header() + &csv_rows(0..SAMPLES)
}

#[test]
fn text_gives_the_same_estimates_from_every_source() {
    let folder = Folder::new("live-text");
    let expected = from_standard_input(&folder.0, &whole_csv());
    assert!(expected.len() > 90, "{}", expected.len());
    assert!(from_standard_input(&folder.0, &json_lines(0..SAMPLES)) == expected, "JSON lines");

    // Datagrams of whole lines: CSV, and JSON.
    for lines in [whole_csv(), json_lines(0..SAMPLES)] {
        let mut live = Live::start(&folder.0, &["udp://127.0.0.1:0", "--no-page"]);
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let lines: Vec<&str> = lines.split_inclusive('\n').collect();
        let address = live.address();
        for datagram in lines.chunks(10) {
            socket.send_to(datagram.concat().as_bytes(), &address).unwrap();
        }
        assert!(estimates(&live.until(LAST_S)) == expected, "UDP");
        live.interrupt();
        let end = json(live.rest().last().unwrap());
        assert_eq!(end["packets"], lines.chunks(10).count(), "{end}");
        assert!(end["reason"].as_str().unwrap().contains("Ctrl-C"), "{end}");
    }

    // TCP, in pieces that end anywhere: a sender that connects, and one that is connected to.
    let mut live = Live::start(&folder.0, &["tcp-listen://127.0.0.1:0", "--no-page"]);
    let connection = TcpStream::connect(live.address()).unwrap();
    assert!(over_tcp(live, connection) == expected, "TCP, listening");
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let live = Live::start(&folder.0, &[&format!("tcp://{}", listener.local_addr().unwrap()), "--no-page"]);
    let (connection, _) = listener.accept().unwrap();
    assert!(over_tcp(live, connection) == expected, "TCP, connecting");
}

/// The file of the recording cannot grow for a while, as on a full disk: that is said, what comes waits, and is written
/// once it can.
#[cfg(target_os = "linux")]
#[test]
fn a_recording_that_cannot_grow_for_a_while_loses_nothing() {
    let folder = Folder::new("live-full");
    let arguments = ["udp://127.0.0.1:0", "--no-page", "--record", "r.phugoid-live"];
    let mut live = Live::start_with_limited_files(&folder.0, &arguments);
    let (address, sender) = (live.address(), UdpSocket::bind("127.0.0.1:0").unwrap());
    let lines: Vec<String> = whole_csv().split_inclusive('\n').map(str::to_owned).collect();
    let send = |lines: &[String]| {
        for datagram in lines.chunks(10) {
            sender.send_to(datagram.concat().as_bytes(), &address).unwrap();
        }
    };
    send(&lines[..251]);
    let mut documents = live.until(2.49);
    let recording = folder.0.join("r.phugoid-live");
    // In the middle of a block.
    live.limit_files(&(std::fs::metadata(&recording).unwrap().len() + 1000).to_string());
    send(&lines[251..281]);
    documents.extend(live.until_said("the recording cannot be written"));
    live.limit_files("unlimited");
    documents.extend(live.until_said("the recording goes on after"));
    assert!(documents.last().unwrap().contains("nothing was lost"), "{:?}", documents.last());
    send(&lines[281..]);
    documents.extend(live.until(LAST_S));
    live.interrupt();
    documents.extend(live.rest());
    assert!(estimates(&documents) == from_standard_input(&folder.0, &whole_csv()));
    assert!(replayed(&folder, "r.phugoid-live") == estimates(&documents));
}

/// Ninety others send to the same port while the flight is received: each of its rows is used nevertheless.
#[test]
fn stray_datagrams_cost_the_sender_nothing() {
    let folder = Folder::new("live-strays");
    let expected = from_standard_input(&folder.0, &whole_csv());
    for more in [&[][..], &["--sender", "127.0.0.1"]] {
        let arguments = [&["udp://127.0.0.1:0", "--no-page", "--no-record"], more].concat();
        let mut live = Live::start(&folder.0, &arguments);
        let address = live.address();
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        let strays: Vec<UdpSocket> = (0..90).map(|_| UdpSocket::bind("127.0.0.1:0").unwrap()).collect();
        for (k, line) in whole_csv().split_inclusive('\n').enumerate() {
            sender.send_to(line.as_bytes(), &address).unwrap();
            if k > 10 {
                strays[k % strays.len()].send_to(b"who is there?", &address).unwrap();
            }
            // Neither is to be lost for want of room.
            std::thread::sleep(Duration::from_micros(200));
        }
        assert!(estimates(&live.until(LAST_S)) == expected, "{more:?}");
        live.interrupt();
        let end = json(live.rest().last().unwrap());
        assert_eq!((&end["samples"], &end["strangers"]), (&SAMPLES.into(), &290.into()), "{end}");
    }
}

/// A sender that is not the one that was named.
#[test]
fn only_the_named_sender_is_used() {
    let folder = Folder::new("live-named");
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let named = sender.local_addr().unwrap().to_string();
    let mut live = Live::start(&folder.0, &["udp://127.0.0.1:0", "--no-page", "--no-record", "--sender", &named]);
    let address = live.address();
    let other = UdpSocket::bind("127.0.0.1:0").unwrap();
    for line in whole_csv().split_inclusive('\n') {
        other.send_to(line.replace("205.", "105.").as_bytes(), &address).unwrap();
        sender.send_to(line.as_bytes(), &address).unwrap();
        std::thread::sleep(Duration::from_micros(200));
    }
    assert!(estimates(&live.until(LAST_S)) == from_standard_input(&folder.0, &whole_csv()));
    live.interrupt();
    let end = json(live.rest().last().unwrap());
    assert_eq!((&end["samples"], &end["strangers"]), (&SAMPLES.into(), &301.into()), "{end}");
    let run = phugoid(&folder.0, &["live", "udp://0", "--model", "f16", "--sender", "10.0.0.1:port"]);
    assert!(run.code == Some(2) && run.err.contains("HOST:PORT"), "{:?} {}", run.code, run.err);
    folder.file("short.key", "secret");
    let run = phugoid(&folder.0, &["live", "udp://0", "--model", "f16", "--mavlink-key", "short.key"]);
    assert!(run.code == Some(3) && run.err.contains("32 bytes"), "{:?} {}", run.code, run.err);
}

fn over_tcp(mut live: Live, mut connection: TcpStream) -> Vec<String> {
    for piece in whole_csv().as_bytes().chunks(777) {
        connection.write_all(piece).unwrap();
    }
    let documents = live.until(LAST_S);
    drop(connection);
    live.interrupt();
    let rest = live.rest();
    let gone = rest.iter().any(|text| text.contains("\"kind\":\"origin\"") && text.contains("tcp"));
    assert!(gone || json(rest.last().unwrap())["type"] == "end", "{rest:?}");
    estimates(&documents)
}

/// A pseudo terminal in place of a radio.
#[cfg(target_os = "linux")]
#[test]
fn a_serial_line_gives_the_same_estimates() {
    use rustix::pty;

    let folder = Folder::new("live-serial");
    let expected = from_standard_input(&folder.0, &whole_csv());
    // No program that is started here may keep it open.
    let radio = pty::openpt(pty::OpenptFlags::RDWR | pty::OpenptFlags::NOCTTY | pty::OpenptFlags::CLOEXEC).unwrap();
    pty::grantpt(&radio).unwrap();
    pty::unlockpt(&radio).unwrap();
    let device = pty::ptsname(&radio, Vec::new()).unwrap().into_string().unwrap();
    let mut live = Live::start(&folder.0, &[&format!("serial:{device}:921600"), "--no-page"]);
    // The line is set up before the first document: from then on nothing is translated or echoed.
    assert!(live.source().starts_with("serial:"), "{}", live.source());
    std::fs::File::from(radio.try_clone().unwrap()).write_all(whole_csv().as_bytes()).unwrap();
    assert!(estimates(&live.until(LAST_S)) == expected);
    // The radio is pulled out.
    drop(radio);
    let end = json(live.rest().last().unwrap());
    assert_eq!(end["type"], "end", "{end}");
}

/// The flight as an autopilot sends it: each sample's messages, the time base last.
fn mavlink(sequence: &mut u8, sample: u32) -> Vec<u8> {
    let t = f64::from(sample) / telemetry::RATE;
    let of = |wanted: &str| signals(t).into_iter().find(|(name, _)| *name == wanted).unwrap().1;
    let (ms, us) = (("time_boot_ms", (t * 1e3).round()), ("time_usec", (t * 1e6).round()));
    let named = ["tas", "elevator", "thrust"];
    let mut frames: Vec<Vec<u8>> = Vec::new();
    let mut send = |name: &str, numbers: &[(&str, f64)], text: &str| {
        frames.push(message(name, *sequence, numbers, text));
        *sequence = sequence.wrapping_add(1);
    };
    for name in named {
        send("NAMED_VALUE_FLOAT", &[ms, ("value", of(name))], name);
    }
    send("ATTITUDE", &[ms, ("pitch", of("theta")), ("pitchspeed", 9.0)], "");
    send("AOA_SSA", &[us, ("AOA", of("alpha").to_degrees())], "");
    send("GLOBAL_POSITION_INT", &[ms, ("alt", of("altitude") * 1e3)], "");
    send("HIGHRES_IMU", &[us, ("xacc", of("ax")), ("zacc", of("az")), ("ygyro", of("q"))], "");
    frames.concat()
}

#[test]
fn mavlink_gives_si_values_and_is_replayed_to_the_same_bits() {
    let folder = Folder::new("live-mavlink");
    let mut live = Live::start(&folder.0, &["udp://127.0.0.1:0", "--no-page", "--record", "flight.phugoid-live"]);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = live.address();
    let mut sequence = 0;
    for first in (0..SAMPLES).step_by(10) {
        let datagram: Vec<u8> = (first..first + 10).flat_map(|sample| mavlink(&mut sequence, sample)).collect();
        // At most 65507 bytes: ten samples of seven messages have some 2500.
        socket.send_to(&datagram, &address).unwrap();
    }
    let documents = live.until(LAST_S);
    live.interrupt();
    let end = json(live.rest().last().unwrap());
    assert_eq!((&end["samples"], &end["lost"], &end["checksum_failures"]), (&SAMPLES.into(), &0.into(), &0.into()));
    let told = estimates(&documents);
    assert!(told.len() > 90);

    // What was sent in degrees, millimetres and by name is there in SI.
    let layout = json(&documents[0])["layout"].clone();
    for text in &told {
        let estimate = json(text);
        let t = estimate["time_s"].as_f64().unwrap();
        for part in ["outputs", "inputs"] {
            for (place, signal) in layout[part].as_array().unwrap().iter().enumerate() {
                let Some((_, sent)) = signals(t)
                    .into_iter()
                    .find(|(name, _)| signal["name"] == *name || (signal["name"] == "true_airspeed" && *name == "tas"))
                else {
                    continue;
                };
                let value = estimate[part][place].as_f64().unwrap();
                // Single precision has 24 bits.
                assert!(
                    (value - sent).abs() <= 1e-6 * sent.abs().max(1.0),
                    "{} at {t}: {value}, sent {sent}",
                    signal["name"]
                );
            }
        }
    }
    assert!(replayed(&folder, "flight.phugoid-live") == told);

    // The recording as a page is that of the documents.
    folder.file("published.jsonl", &documents.join("\n"));
    let [recorded, published] = ["flight.phugoid-live", "published.jsonl"].map(|file| page_of(&folder, file));
    assert_eq!(recorded["history"]["time_s"].as_array().unwrap().len(), told.len());
    for part in ["history", "parameters"] {
        assert!(recorded[part] == published[part], "{part}");
    }
    assert!(recorded["parameters"][0]["readiness"]["reason"].is_string(), "{}", recorded["parameters"]);
}

/// The data inside a page of `phugoid view`.
fn page_of(folder: &Folder, file: &str) -> Value {
    let run = phugoid(&folder.0, &["view", file, "--html", "page.html"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let page = folder.read("page.html");
    let (_, data) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

fn replayed(folder: &Folder, recording: &str) -> Vec<String> {
    let run = phugoid(&folder.0, &["live", "--replay", recording, "--speed", "max", "--all", "--no-page"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    estimates(&run.out.lines().map(str::to_owned).collect::<Vec<_>>())
}

/// The stream has the stamps of the clock by which it is sent: what was shown before the kill and is missing in the recording is
/// measured by them, s.
fn lost_by_a_kill(attempt: u32) -> f64 {
    const BURST: u32 = 250;
    let folder = Folder::new(&format!("live-kill-{attempt}"));
    let mut live = Live::start(&folder.0, &["udp://127.0.0.1:0", "--no-page", "--record", "flight.phugoid-live"]);
    let address = live.address();
    let stop = AtomicBool::new(false);
    let documents = std::thread::scope(|scope| {
        scope.spawn(|| {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            let mut sequence = 0;
            let start = Instant::now();
            // At first as fast as can be, then a hundred samples a second.
            for sample in 0.. {
                let due = Duration::from_millis(10) * u32::saturating_sub(sample, BURST);
                std::thread::sleep(due.saturating_sub(start.elapsed()));
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                socket.send_to(&mavlink(&mut sequence, sample), &address).unwrap();
            }
        });
        let mut documents = live.until(2.9);
        documents.extend(live.kill());
        stop.store(true, Ordering::Relaxed);
        documents
    });
    let shown = estimates(&documents);
    let kept = replayed(&folder, "flight.phugoid-live");
    assert!(kept.iter().zip(&shown).all(|(kept, shown)| kept == shown), "{} {}", kept.len(), shown.len());
    time_s(shown.last().unwrap()) - kept.last().map_or(0.0, |estimate| time_s(estimate))
}

#[test]
fn a_kill_loses_at_most_the_last_100_ms() {
    // A machine that is busy with other things may keep the recorder from running for so long once; not three times.
    assert!((0..3).any(|attempt| lost_by_a_kill(attempt) <= 0.1));
}

#[cfg(feature = "live")]
#[test]
fn others_need_the_token() {
    use live::status;

    let folder = Folder::new("live-token");
    let mut live = Live::start(&folder.0, &["-", "--listen", "0.0.0.0:0", "--no-record"]);
    let (address, token) = live.page();
    let port = address.rsplit_once(':').unwrap().1;
    let here = format!("127.0.0.1:{port}");
    let token = token.unwrap();
    assert_eq!(token.len(), 32);
    for path in ["/", "/events", "/result.json", "/?token=00000000000000000000000000000000"] {
        assert_eq!(status(&here, path, &[]), 401, "{path}");
    }
    for path in ["/", "/events", "/result.json"] {
        assert_eq!(status(&here, &format!("{path}?token={token}"), &[]), 200, "{path}");
        assert_eq!(status(&here, path, &[("Authorization", &format!("Bearer {token}"))]), 200, "{path}");
    }
    live.end_input();
    live.rest();

    // This machine alone is served without one, and no site under another name.
    let mut live = Live::start(&folder.0, &["-", "--listen", "127.0.0.1:0", "--no-record"]);
    let (address, token) = live.page();
    assert_eq!(token, None);
    assert_eq!((status(&address, "/", &[]), status(&address, "/nothing", &[])), (200, 404));
    assert_eq!(status(&address, "/", &[("Host", "elsewhere.example")]), 403);
    live.end_input();
    live.rest();
}

#[test]
fn estimates_go_on_as_mavlink() {
    let folder = Folder::new("live-out");
    let station = UdpSocket::bind("127.0.0.1:0").unwrap();
    // Only where nothing comes at all is it waited for so long.
    station.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let to = format!("udp://{}", station.local_addr().unwrap());
    let mut live = Live::start(&folder.0, &["-", "--no-page", "--no-record", "--mavlink-out", &to]);
    live.input(whole_csv().as_bytes());
    live.end_input();
    let documents = live.rest();
    let names: Vec<Value> = json(&documents[0])["layout"]["parameters"].as_array().unwrap().clone();
    let names: Vec<&str> = names.iter().map(|parameter| parameter["name"].as_str().unwrap()).collect();

    let mut buffer = [0; 1000];
    let mut receive = |expected: &str| {
        let read = station.recv(&mut buffer).unwrap();
        let Found::Frame(frame, length) = frame::next(&buffer[..read]) else { panic!("no frame") };
        let message = definitions::by_name(expected).unwrap();
        assert_eq!((frame.id, length), (message.id, read), "{expected}");
        let number = |field: &str, at| message.field(field).unwrap().value(frame.payload, at).unwrap();
        let name = message.field("name").unwrap().text(frame.payload).unwrap();
        let numbers = |field: &str, count| (0..count).map(|at| number(field, at)).collect::<Vec<f64>>();
        match expected {
            "DEBUG_FLOAT_ARRAY" => (name, number("time_usec", 0) * 1e-6, numbers("data", 2 * names.len())),
            _ => (name, number("time_boot_ms", 0) * 1e-3, numbers("value", 1)),
        }
    };
    let singles: Vec<_> = names.iter().map(|_| receive("NAMED_VALUE_FLOAT")).collect();
    let (title, time_s, pairs) = receive("DEBUG_FLOAT_ARRAY");
    assert_eq!(title, "phugoid");
    // They are those of an estimate that was told as a document.
    let told = estimates(&documents)
        .iter()
        .map(|text| json(text))
        .find(|estimate| (estimate["time_s"].as_f64().unwrap() - time_s).abs() < 1e-6);
    let told = told.unwrap();
    for (place, ((name, single), wanted)) in
        names.iter().zip(&singles).zip(told["parameters"].as_array().unwrap()).enumerate()
    {
        let value = wanted["value"].as_f64().unwrap() as f32;
        assert_eq!(single.0, name[..name.len().min(10)]);
        assert_eq!((single.2[0] as f32, pairs[2 * place] as f32), (value, value), "{name}");
        assert_eq!(pairs[2 * place + 1] as f32, wanted["std_error"].as_f64().unwrap() as f32, "{name}");
    }
}
