//! Estimates as MAVLink debug messages, for ground stations that show them.

use std::io;
use std::net::{ToSocketAddrs, UdpSocket};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{definitions, frame};
use crate::audience::Audience;
use crate::document::DocumentKind;

/// Time between two estimates that are sent.
const INTERVAL: Duration = Duration::from_millis(200);
/// System and component of the sender: system 254, which no vehicle has, and MAV_COMP_ID_ONBOARD_COMPUTER.
const SENDER: (u8, u8) = (254, 191);

/// Sends the newest estimate five times a second over UDP: one `NAMED_VALUE_FLOAT` per parameter (its name cut to ten
/// characters), and one `DEBUG_FLOAT_ARRAY` named `phugoid` with value and standard error in turn, of the first 29
/// parameters. Units are those of the model (derivatives per radian); what does not exist is NaN.
pub struct DebugMessages {
    socket: UdpSocket,
    names: Vec<String>,
    sequence: u8,
    /// When the last estimate was sent.
    sent: Option<Instant>,
}

impl DebugMessages {
    /// A sender to `udp://host:port`.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] for an address of another form or an unknown host; else what the system says
    /// about the socket.
    pub fn to(address: &str) -> io::Result<Self> {
        let wrong = |problem: &str| {
            let message =
                format!("--mavlink-out {address}: {problem}; write udp://host:port, as in udp://127.0.0.1:14551");
            io::Error::new(io::ErrorKind::InvalidInput, message)
        };
        let target = address.strip_prefix("udp://").ok_or_else(|| wrong("only UDP is sent"))?;
        let mut found = target.to_socket_addrs().map_err(|error| wrong(&error.to_string()))?;
        let target = found.next().ok_or_else(|| wrong("there is no such host"))?;
        let socket = UdpSocket::bind(if target.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" })?;
        socket.connect(target)?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket, names: Vec::new(), sequence: 0, sent: None })
    }

    /// Sends one message. `fill` gives the bytes of an element of a field; elements without bytes are zero.
    fn send(&mut self, name: &str, fill: impl Fn(&str, usize) -> Option<Vec<u8>>) {
        let Some(message) = definitions::by_name(name) else { return };
        let mut payload = vec![0; message.length()];
        for field in &message.fields {
            for element in 0..field.count.max(1) {
                let start = field.offset + element * field.kind.size();
                if let (Some(bytes), Some(place)) =
                    (fill(field.name, element), payload.get_mut(start..start + field.kind.size()))
                {
                    place.iter_mut().zip(bytes).for_each(|(to, from)| *to = from);
                }
            }
        }
        if let Some(bytes) = frame::encode(message.id, self.sequence, SENDER.0, SENDER.1, &payload) {
            // The estimation goes on if no ground station receives.
            let _ = self.socket.send(&bytes);
            self.sequence = self.sequence.wrapping_add(1);
        }
    }

    fn estimate(&mut self, document: &Value) {
        let time_s = document["time_s"].as_f64().unwrap_or_default();
        let (time_ms, time_us) = ((time_s * 1e3) as u32, (time_s * 1e6) as u64);
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN) as f32;
        let parameters: Vec<[f32; 2]> = document["parameters"]
            .as_array()
            .map(|all| all.iter().map(|one| [number(&one["value"]), number(&one["std_error"])]).collect())
            .unwrap_or_default();
        let letter = |text: &str, at: usize| text.as_bytes().get(at).map(|byte| vec![*byte]);
        for (name, [value, _]) in std::mem::take(&mut self.names).into_iter().zip(&parameters) {
            self.send("NAMED_VALUE_FLOAT", |field, at| match field {
                "time_boot_ms" => Some(time_ms.to_le_bytes().to_vec()),
                "value" => Some(value.to_le_bytes().to_vec()),
                "name" => letter(&name, at),
                _ => None,
            });
            self.names.push(name);
        }
        let flat: Vec<f32> = parameters.into_iter().flatten().collect();
        self.send("DEBUG_FLOAT_ARRAY", |field, at| match field {
            "time_usec" => Some(time_us.to_le_bytes().to_vec()),
            "name" => letter("phugoid", at),
            "data" => flat.get(at).map(|value| value.to_le_bytes().to_vec()),
            _ => None,
        });
    }
}

impl Audience for DebugMessages {
    fn hear(&mut self, kind: DocumentKind, document: &str) {
        let due = self.sent.is_none_or(|sent| sent.elapsed() >= INTERVAL);
        let wanted = match kind {
            DocumentKind::Hello => true,
            DocumentKind::Estimate { .. } => due,
            DocumentKind::Event | DocumentKind::Link | DocumentKind::End => false,
        };
        if !wanted {
            return;
        }
        let Ok(document) = serde_json::from_str::<Value>(document) else { return };
        if kind == DocumentKind::Hello {
            let names = document["layout"]["parameters"].as_array().into_iter().flatten();
            self.names = names.filter_map(|parameter| parameter["name"].as_str().map(str::to_owned)).collect();
        } else {
            self.sent = Some(Instant::now());
            self.estimate(&document);
        }
    }
}
