//! How a source is written on the command line.

use std::fmt;
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::PathBuf;
use std::str::FromStr;

/// A source as it is written on the command line.
///
/// ```
/// use phugoid_live::source::SourceSpec;
///
/// let source: SourceSpec = "udp://14550".parse()?;
/// assert_eq!(source, SourceSpec::Udp(([127, 0, 0, 1], 14550).into()));
/// let source: SourceSpec = "serial:/dev/ttyUSB0".parse()?;
/// assert_eq!(source.to_string(), "serial:/dev/ttyUSB0:57600");
/// assert!("http://localhost".parse::<SourceSpec>().is_err());
/// # Ok::<(), phugoid_live::source::SpecError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceSpec {
    /// `udp://[host:]port`: receives datagrams that are sent to this address. Without a host only those from this
    /// machine.
    Udp(SocketAddr),
    /// `tcp://host:port`: connects to this address, and connects again when the connection is lost.
    Tcp(String),
    /// `tcp-listen://[host:]port`: waits for connections of senders.
    TcpListen(SocketAddr),
    /// `serial:device[:baud]`: a serial line, on Linux and macOS.
    Serial {
        /// Path of the device, such as `/dev/ttyUSB0`.
        device: PathBuf,
        /// Speed, bits per second; 57,600 where none is written.
        baud: u32,
    },
    /// `-`: text or MAVLink from standard input.
    StandardInput,
}

/// A source that cannot be understood. The message says which forms there are.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{found}` is no source: {problem}. Write udp://14550 (all that is sent to this port of this machine; udp://0.0.0.0:14550 from \
     other machines too), tcp://host:port, tcp-listen://port, serial:/dev/ttyUSB0:57600, or - for standard input"
)]
pub struct SpecError {
    found: String,
    problem: String,
}

/// Speed where none is written, bits per second: the usual one of telemetry radios.
const BAUD: u32 = 57_600;

impl FromStr for SourceSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let wrong = |problem: String| SpecError { found: text.to_owned(), problem };
        if text == "-" {
            return Ok(Self::StandardInput);
        }
        if let Some(device) = text.strip_prefix("serial:") {
            let (device, baud) = match device.rsplit_once(':') {
                Some((device, baud)) => {
                    (device, baud.parse().map_err(|_| wrong(format!("`{baud}` is no number of bits per second")))?)
                }
                None => (device, BAUD),
            };
            if device.is_empty() {
                return Err(wrong("there is no device in it".to_owned()));
            }
            return Ok(Self::Serial { device: PathBuf::from(device), baud });
        }
        let Some((kind, address)) = text.split_once("://") else {
            return Err(wrong("there is no kind in front of it".to_owned()));
        };
        match kind {
            "udp" => listening(address).map(Self::Udp).map_err(wrong),
            "tcp-listen" => listening(address).map(Self::TcpListen).map_err(wrong),
            "tcp" => match address.rsplit_once(':') {
                Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => {
                    Ok(Self::Tcp(address.to_owned()))
                }
                _ => Err(wrong("a host and a port are needed".to_owned())),
            },
            other => Err(wrong(format!("`{other}` is not known"))),
        }
    }
}

/// The address of `port`, `host:port` or `[v6]:port`; without a host that of this machine.
fn listening(address: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = address.parse::<u16>() {
        return Ok(SocketAddr::from(([127, 0, 0, 1], port)));
    }
    let mut found = address.to_socket_addrs().map_err(|error| format!("`{address}` is no address ({error})"))?;
    found.next().ok_or_else(|| format!("`{address}` is no address"))
}

impl fmt::Display for SourceSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Udp(address) => write!(f, "udp://{address}"),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::TcpListen(address) => write!(f, "tcp-listen://{address}"),
            Self::Serial { device, baud } => write!(f, "serial:{}:{baud}", device.display()),
            Self::StandardInput => f.write_str("standard input"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_understood() {
        let of = |text: &str| text.parse::<SourceSpec>().map(|spec| spec.to_string());
        assert_eq!(of("udp://14550").unwrap(), "udp://127.0.0.1:14550");
        assert_eq!(of("udp://0.0.0.0:14550").unwrap(), "udp://0.0.0.0:14550");
        assert_eq!(of("tcp-listen://5760").unwrap(), "tcp-listen://127.0.0.1:5760");
        assert_eq!(of("tcp://localhost:5760").unwrap(), "tcp://localhost:5760");
        assert_eq!(of("serial:/dev/ttyUSB0:921600").unwrap(), "serial:/dev/ttyUSB0:921600");
        assert_eq!(of("serial:/dev/ttyACM0").unwrap(), "serial:/dev/ttyACM0:57600");
        assert_eq!(of("-").unwrap(), "standard input");
        for wrong in
            ["", "14550", "udp:14550", "http://x:1", "tcp://5760", "udp://x y:1", "serial:", "serial:/dev/tty:fast"]
        {
            assert!(of(wrong).unwrap_err().to_string().contains("udp://14550"), "{wrong}");
        }
    }
}
