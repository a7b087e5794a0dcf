//! Any bytes as telemetry (MAVLink, JSON lines, CSV), in pieces of any size, from two peers that come and go: finite samples, in
//! increasing time unless the sender began anew.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_live::arrival::{Arrival, Content};
use phugoid_live::receiver::{Receiver, ReceiverOptions, Reception};

/// Channels that MAVLink can fill, and one that it cannot.
const CHANNELS: &[&str] = &["true_airspeed", "alpha", "theta", "q", "ax", "az", "elevator", "thrust"];

fuzz_target!(|bytes: &[u8]| {
    let channels: Vec<String> = CHANNELS.iter().map(|name| (*name).to_owned()).collect();
    let mut receiver = Receiver::new(&channels, &ReceiverOptions::default()).expect("channels that are known");
    let mut last_s = f64::NEG_INFINITY;
    let mut out = |reception: Reception<'_>| match reception {
        Reception::Sample { time_s, values, .. } => {
            assert!(time_s.is_finite() && time_s > last_s, "{time_s} s after {last_s} s");
            assert!(values.len() == CHANNELS.len() && values.iter().all(|value| !value.is_infinite()));
            last_s = time_s;
        }
        Reception::Restart { .. } => last_s = f64::NEG_INFINITY,
        Reception::Event { message, .. } => assert!(message.len() < 8000, "an event fits on a screen"),
    };
    // The first byte of each piece says how long it is, when it comes, from whom, and how.
    let (mut rest, mut now_ns) = (bytes, 0);
    while let [control, following @ ..] = rest {
        let (piece, left) = following.split_at(following.len().min(usize::from(control & 0x1F) << 3));
        now_ns += 1 + (u64::from(*control) << 20);
        let content = match control >> 5 {
            0 => Content::Opened("a peer".to_owned()),
            1 => Content::Closed("gone".to_owned()),
            2..5 => Content::Datagram(piece.to_vec()),
            _ => Content::Piece(piece.to_vec()),
        };
        receiver.take(&Arrival { arrival_ns: now_ns, wall_ns: 0, origin: u16::from(control & 1), content }, &mut out);
        rest = left;
    }
    receiver.advance(now_ns + 10_000_000_000, &mut out);
    receiver.finish(&mut out);
});
