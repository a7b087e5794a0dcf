//! The sender that alone is used, as it is written on the command line.

use std::fmt;
use std::net::{IpAddr, SocketAddr, ToSocketAddrs};
use std::str::FromStr;

/// A sender as it is written on the command line: `HOST` or `HOST:PORT`. A host may have several addresses; written out
/// they stand one after another with commas between them.
///
/// ```
/// use phugoid_live::source::SenderSpec;
///
/// let sender: SenderSpec = "10.0.0.7".parse()?;
/// assert!(sender.is("10.0.0.7:14550".parse()?) && !sender.is("10.0.0.8:14550".parse()?));
/// let sender: SenderSpec = "[::1]:14550".parse()?;
/// assert!(sender.is("[::1]:14550".parse()?) && !sender.is("[::1]:14551".parse()?));
/// assert_eq!(sender.to_string(), "[::1]:14550");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SenderSpec {
    hosts: Vec<IpAddr>,
    /// `None` for any port of the host.
    port: Option<u16>,
}

/// A sender that cannot be understood, or whose name has no address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{found}` is no sender: {problem}. Write HOST or HOST:PORT, as in 10.0.0.7 or 10.0.0.7:14550")]
pub struct SenderError {
    found: String,
    problem: String,
}

impl SenderSpec {
    /// Whether datagrams or connections from this address are of this sender.
    pub fn is(&self, address: SocketAddr) -> bool {
        // A socket for both versions of the protocol shows addresses of the older one in the form of the newer.
        let same = |host: &IpAddr| host.to_canonical() == address.ip().to_canonical();
        self.hosts.iter().any(same) && self.port.is_none_or(|port| port == address.port())
    }

    /// The same for the name of a peer, such as `udp 10.0.0.7:14550`; false for a name without an address.
    pub(crate) fn is_peer(&self, name: &str) -> bool {
        name.split_once(' ').and_then(|(_, address)| address.parse().ok()).is_some_and(|address| self.is(address))
    }
}

impl FromStr for SenderSpec {
    type Err = SenderError;

    fn from_str(text: &str) -> Result<Self, SenderError> {
        let wrong = |problem: String| SenderError { found: text.to_owned(), problem };
        let (mut hosts, mut ports) = (Vec::new(), Vec::new());
        for part in text.split(',') {
            if let Ok(address) = part.parse::<IpAddr>() {
                hosts.push(address);
                ports.push(None);
                continue;
            }
            if let Ok(address) = part.parse::<SocketAddr>() {
                hosts.push(address.ip());
                ports.push(Some(address.port()));
                continue;
            }
            let (name, port) = match part.rsplit_once(':') {
                Some((name, port)) => {
                    (name, Some(port.parse::<u16>().map_err(|_| wrong(format!("`{port}` is no port")))?))
                }
                None => (part, None),
            };
            if name.is_empty() {
                return Err(wrong("there is no host in it".to_owned()));
            }
            let found = (name, port.unwrap_or_default()).to_socket_addrs().map_err(|error| wrong(error.to_string()))?;
            hosts.extend(found.map(|address| address.ip()));
            ports.push(port);
        }
        hosts.dedup();
        ports.dedup();
        match (hosts.is_empty(), ports.as_slice()) {
            (false, [port]) => Ok(Self { hosts, port: *port }),
            (true, _) => Err(wrong("it has no address".to_owned())),
            _ => Err(wrong("its addresses have different ports".to_owned())),
        }
    }
}

impl fmt::Display for SenderSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, host) in self.hosts.iter().enumerate() {
            f.write_str(if index > 0 { "," } else { "" })?;
            match self.port {
                Some(port) => write!(f, "{}", SocketAddr::new(*host, port))?,
                None => write!(f, "{host}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_understood() {
        let of = |text: &str| text.parse::<SenderSpec>();
        for text in ["10.0.0.7", "10.0.0.7:5", "::1", "[::1]:5", "10.0.0.7:5,[::1]:5"] {
            assert_eq!(of(text).unwrap().to_string(), text);
        }
        assert!(of("localhost:77").unwrap().is("127.0.0.1:77".parse().unwrap()));
        assert!(of("127.0.0.1").unwrap().is_peer("udp 127.0.0.1:9") && of("::1").unwrap().is_peer("udp [::1]:9"));
        assert!(of("127.0.0.1").unwrap().is_peer("udp [::ffff:127.0.0.1]:9"));
        assert!(!of("127.0.0.1").unwrap().is_peer("standard input"));
        for wrong in ["", ":5", "10.0.0.7:x", "10.0.0.7:70000", "10.0.0.7:5,10.0.0.8:6"] {
            assert!(of(wrong).unwrap_err().to_string().contains("HOST:PORT"), "{wrong}");
        }
    }
}
