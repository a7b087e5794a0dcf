//! What a stranger on the network, or a single damaged packet, can do to the estimate: nothing, or an alarm says it.

use phugoid_live::arrival::{Arrival, Content};
use phugoid_live::mavlink::frame::{self, Found};
use phugoid_live::mavlink::{Key, MavlinkOptions};
use phugoid_live::receiver::ReceiverOptions;
use serde_json::Value;

use crate::replay::{count, last, published_with};
use crate::telemetry::{self, message, signals};

/// Time between two samples, ns.
const STEP_NS: u64 = 10_000_000;
/// A flight of 6 s.
const SAMPLES: u32 = 600;
/// The sender, and somebody else.
const SENDER: u16 = 0;
const STRANGER: u16 = 1;

fn opened(origin: u16, port: u16) -> Arrival {
    let content = Content::Opened(format!("udp 127.0.0.1:{port}"));
    Arrival { arrival_ns: 1, wall_ns: 0, origin, content }
}

fn datagram(origin: u16, arrival_ns: u64, bytes: impl Into<Vec<u8>>) -> Arrival {
    Arrival { arrival_ns, wall_ns: 0, origin, content: Content::Datagram(bytes.into()) }
}

/// When sample `k` of a flight that begins at `first_ns` arrives.
fn at_ns(first_ns: u64, k: u32) -> u64 {
    first_ns + u64::from(k) * STEP_NS
}

/// A sample of MAVLink: each message a datagram, the time base last. Of another vehicle `shift` moves every value.
fn mavlink(origin: u16, sequence: &mut u8, stamp_s: f64, arrival_ns: u64, t: f64, shift: f64) -> Vec<Arrival> {
    let (ms, us) = (("time_boot_ms", (stamp_s * 1e3).round()), ("time_usec", (stamp_s * 1e6).round()));
    let mut bytes = Vec::new();
    let mut send = |name: &str, numbers: &[(&str, f64)], text: &str| {
        bytes.push(message(name, *sequence, numbers, text));
        *sequence = sequence.wrapping_add(1);
    };
    for (name, value) in signals(t) {
        send("NAMED_VALUE_FLOAT", &[ms, ("value", value + shift)], name);
    }
    send("HIGHRES_IMU", &[us, ("zacc", -9.7 + shift)], "");
    bytes.into_iter().map(|bytes| datagram(origin, arrival_ns, bytes)).collect()
}

/// A flight as MAVLink whose clock shows `from_s` at its beginning.
fn mavlink_flight(from_s: f64, first_ns: u64, samples: std::ops::Range<u32>) -> Vec<Arrival> {
    let mut sequence = 0;
    let sample = |k: u32| {
        let t = f64::from(k) / telemetry::RATE;
        mavlink(SENDER, &mut sequence, from_s + t, at_ns(first_ns, k), t, 0.0)
    };
    samples.flat_map(sample).collect()
}

/// A row of CSV at a time of the sender.
fn row(stamp_s: f64, t: f64, shift: f64) -> String {
    let cells: Vec<String> = signals(t).into_iter().map(|(_, value)| (value + shift).to_string()).collect();
    format!("{stamp_s},{}", cells.join(","))
}

/// A flight as rows of CSV whose clock shows `from_s` at its beginning.
fn text_flight(from_s: f64, first_ns: u64, samples: std::ops::Range<u32>) -> Vec<Arrival> {
    let header = datagram(SENDER, first_ns, telemetry::csv_header());
    let rows = samples.map(|k| {
        let t = f64::from(k) / telemetry::RATE;
        datagram(SENDER, at_ns(first_ns, k), row(from_s + t, t, 0.0))
    });
    std::iter::once(header).chain(rows).collect()
}

/// Both in the order of their arrival; of the same time, those of `flight` first.
fn with(mut flight: Vec<Arrival>, others: Vec<Arrival>) -> Vec<Arrival> {
    flight.extend(others);
    flight.sort_by_key(|arrival| arrival.arrival_ns);
    flight
}

/// Everything that is published of a sender at port 5000 and a stranger at port 6000.
fn run(arrivals: &[Arrival]) -> Vec<String> {
    run_with(&ReceiverOptions::default(), arrivals)
}

fn run_with(options: &ReceiverOptions, arrivals: &[Arrival]) -> Vec<String> {
    let senders = [opened(SENDER, 5000), opened(STRANGER, 6000)];
    let all: Vec<Arrival> = senders.into_iter().chain(arrivals.iter().cloned()).collect();
    published_with(options, &all, None)
}

fn estimates(documents: &[String]) -> Vec<&String> {
    documents.iter().filter(|text| text.contains("\"type\":\"estimate\"")).collect()
}

/// The messages of the events of a kind.
fn events(documents: &[String], kind: &str) -> Vec<String> {
    let events = documents.iter().map(|text| serde_json::from_str::<Value>(text).unwrap());
    let of_kind = events.filter(|event| event["type"] == "event" && event["kind"] == kind);
    of_kind.map(|event| event["message"].as_str().unwrap().to_owned()).collect()
}

/// The estimates of `attacked` are those of `undisturbed`, bit for bit.
fn assert_undisturbed(attacked: &[String], undisturbed: &[String]) {
    let (found, expected) = (estimates(attacked), estimates(undisturbed));
    assert!(expected.len() > 100, "{}", expected.len());
    assert_eq!(found.len(), expected.len(), "{}", attacked.last().unwrap());
    let different = found.iter().zip(&expected).position(|(found, expected)| found != expected);
    assert_eq!(different, None, "{}", attacked.last().unwrap());
}

#[test]
fn a_packet_a_second_with_a_leading_or_an_old_time_changes_nothing() {
    // The packets have the address of the sender itself.
    let leaps = [50.0, -3.0, 3.0, 0.5, 7000.0];
    for (form, flight) in
        [("MAVLink", mavlink_flight(100.0, 1, 0..SAMPLES)), ("text", text_flight(100.0, 1, 0..SAMPLES))]
    {
        let undisturbed = run(&flight);
        let spoofed = (1_u32..).zip(leaps).flat_map(|(second, leap)| {
            let t = f64::from(second);
            let at_ns = at_ns(1, second * 100) + STEP_NS / 2;
            match form {
                "text" => vec![datagram(SENDER, at_ns, row(100.0 + t + leap, t, 0.3))],
                _ => mavlink(SENDER, &mut 77, 100.0 + t + leap, at_ns, t, 0.3),
            }
        });
        let attacked = run(&with(flight, spoofed.collect()));
        let end = last(&attacked);
        assert_eq!(end["restarts"], 0, "{form}: {end}");
        assert!(end["leaps"].as_u64().unwrap() >= leaps.len() as u64, "{form}: {end}");
        assert_undisturbed(&attacked, &undisturbed);
        assert!(!events(&attacked, "leap").is_empty(), "{form}");
    }
}

#[test]
fn a_restarted_sender_keeps_what_is_known() {
    for forms in [
        [mavlink_flight(500.0, 1, 0..SAMPLES), mavlink_flight(0.2, 8_000_000_000, 0..SAMPLES)],
        [text_flight(500.0, 1, 0..SAMPLES), text_flight(0.2, 8_000_000_000, 0..SAMPLES)],
    ] {
        let documents = run(&forms.concat());
        let end = last(&documents);
        assert_eq!((&end["restarts"], count(&documents, "hello")), (&1.into(), 2), "{end}");
        // Only what the jump needs to be believed is lost: a quarter of a second.
        assert!(end["samples"].as_u64().unwrap() >= u64::from(2 * SAMPLES - 30), "{end}");
        let all: Vec<Value> = estimates(&documents).iter().map(|text| serde_json::from_str(text).unwrap()).collect();
        let of = |flight: u64| all.iter().filter(move |estimate| estimate["flight"] == flight);
        let (before, after) = (of(0).next_back().unwrap(), of(1).next().unwrap());
        assert!(after["time_s"].as_f64().unwrap() < 0.5, "{after}");
        // Parameters and their bounds go on where they were.
        assert_eq!(before["parameters"].as_array().unwrap().len(), after["parameters"].as_array().unwrap().len());
        for (before, after) in
            before["parameters"].as_array().unwrap().iter().zip(after["parameters"].as_array().unwrap())
        {
            for number in ["value", "std_error"] {
                assert_eq!(before[number], after[number]);
            }
        }
        assert!(of(1).count() > 500, "{}", of(1).count());
        assert!(events(&documents, "restart")[0].contains("kept"), "{:?}", events(&documents, "restart"));
    }
}

#[test]
fn a_jump_of_the_senders_clock_is_followed_once_it_lasts() {
    // The clock is set from the time since the start to that of the day, in the middle of the flight.
    let (first, second) = (text_flight(0.0, 1, 0..300), text_flight(1.7e9, 1, 300..SAMPLES));
    let documents = run(&[first, second].concat());
    let end = last(&documents);
    assert_eq!(end["restarts"], 1, "{end}");
    assert!(end["samples"].as_u64().unwrap() >= u64::from(SAMPLES - 30), "{end}");

    // Data are missing, and the clock and the arrivals agree about how long: nothing is left out.
    let gap = [text_flight(0.0, 1, 0..300), text_flight(0.0, 1, 5000..5300)].concat();
    let end = last(&run(&gap));
    assert_eq!((&end["restarts"], &end["leaps"], &end["samples"]), (&0.into(), &0.into(), &600.into()), "{end}");

    // From a pipe that does not keep to the clock, a gap of the data is one too, though some samples go by.
    let piped: Vec<Arrival> = gap.into_iter().map(|arrival| Arrival { arrival_ns: 1, ..arrival }).collect();
    let end = last(&run(&piped));
    assert_eq!((&end["restarts"], &end["leaps"], &end["samples"]), (&0.into(), &2.into(), &598.into()), "{end}");
}

#[test]
fn a_second_sender_is_not_merged_and_raises_an_alarm() {
    for (form, flight) in [("MAVLink", mavlink_flight(0.0, 1, 0..SAMPLES)), ("text", text_flight(0.0, 1, 0..SAMPLES))] {
        let undisturbed = run(&flight);
        let mut sequence = 40;
        // The same vehicle by its numbers, at the same times, with other values, from half a second on.
        let mut spoofed = Vec::new();
        if form == "text" {
            spoofed.push(datagram(STRANGER, at_ns(1, 49), telemetry::csv_header()));
        }
        for k in 50..SAMPLES {
            let (t, at_ns) = (f64::from(k) / telemetry::RATE, at_ns(1, k) - STEP_NS / 2);
            match form {
                "text" => spoofed.push(datagram(STRANGER, at_ns, row(t - 0.005, t, 0.3))),
                _ => spoofed.extend(mavlink(STRANGER, &mut sequence, t - 0.005, at_ns, t, 0.3)),
            }
        }
        let datagrams = spoofed.len() as u64;
        let attacked = run(&with(flight, spoofed));
        assert_undisturbed(&attacked, &undisturbed);
        let end = last(&attacked);
        assert_eq!((&end["strangers"], &end["lost"], &end["duplicated"]), (&datagrams.into(), &0.into(), &0.into()));
        let alarms = events(&attacked, "alarm");
        assert!(alarms[0].contains("127.0.0.1:6000") && alarms[0].contains("127.0.0.1:5000"), "{form}: {alarms:?}");
        // At most five at once and one a second, each with the count of those that were left out.
        assert!((5..=12).contains(&alarms.len()), "{form}: {alarms:?}");
        assert!(alarms.last().unwrap().contains("not said"), "{form}: {alarms:?}");
    }
}

#[test]
fn another_vehicle_behind_another_address_is_counted_and_no_alarm() {
    let flight = mavlink_flight(0.0, 1, 0..SAMPLES);
    let undisturbed = run(&flight);
    // A ground station says that it is there.
    let heartbeat = frame::encode(0, 0, 255, 190, &[0; 9]).unwrap();
    let others = (0..6).map(|second| datagram(STRANGER, at_ns(1, 60 + 100 * second), heartbeat.clone())).collect();
    let attacked = run(&with(flight, others));
    assert_undisturbed(&attacked, &undisturbed);
    assert_eq!((events(&attacked, "alarm").len(), last(&attacked)["strangers"].as_u64()), (0, Some(6)));
    assert!(events(&attacked, "stranger")[0].contains("127.0.0.1:6000"), "{:?}", events(&attacked, "stranger"));
}

#[test]
fn a_silent_sender_is_replaced_after_five_seconds_and_not_before() {
    let first = text_flight(0.0, 1, 0..300);
    let silent_ns = first.last().unwrap().arrival_ns;
    let mut second = text_flight(0.0, 1, 300..1500);
    second.iter_mut().for_each(|arrival| arrival.origin = STRANGER);
    second[0].arrival_ns = silent_ns + STEP_NS;
    let documents = run(&[first, second].concat());
    let end = last(&documents);
    // Five seconds of the new sender's rows are not used.
    let unused = 1500 - end["samples"].as_u64().unwrap();
    assert!((499..=501).contains(&unused), "{end}");
    assert_eq!(end["restarts"], 0, "{end}");
    let said = events(&documents, "sender");
    assert!(said.iter().any(|text| text.contains("127.0.0.1:6000") && text.contains("silent")), "{said:?}");
}

/// The same arrivals, each frame signed with a key.
fn signed(arrivals: &[Arrival], key: &Key) -> Vec<Arrival> {
    let sign = |(k, arrival): (usize, &Arrival)| {
        let Content::Datagram(bytes) = &arrival.content else { panic!("a datagram") };
        let Found::Frame(frame, _) = frame::next(bytes) else { panic!("a frame") };
        let (system, component) = (frame.system, frame.component);
        let bytes = frame::encode_signed(
            frame.id,
            frame.sequence,
            system,
            component,
            frame.payload,
            key,
            0,
            1_000_000 + k as u64,
        );
        datagram(arrival.origin, arrival.arrival_ns, bytes.unwrap())
    };
    arrivals.iter().enumerate().map(sign).collect()
}

#[test]
fn with_a_key_only_signed_frames_are_used_and_each_once() {
    let (key, other) = (Key::parse(&[1; 32]).unwrap(), Key::parse(&[2; 32]).unwrap());
    let mavlink = MavlinkOptions { key: Some(key.clone()), ..MavlinkOptions::default() };
    let options = ReceiverOptions { mavlink, ..ReceiverOptions::default() };
    let flight = mavlink_flight(0.0, 1, 0..SAMPLES);
    let undisturbed = run(&flight);
    let genuine = signed(&flight, &key);
    // From the address of the sender itself: unsigned, signed with another key, and recorded a second before.
    let mut forged = Vec::new();
    for k in (150..SAMPLES).step_by(50) {
        let (t, at_ns) = (f64::from(k) / telemetry::RATE, at_ns(1, k) + STEP_NS / 2);
        let wrong = mavlink_sample(&mut 7, t, at_ns);
        forged.extend(signed(&wrong, &other));
        forged.extend(wrong);
        let old = genuine[10 * (k as usize - 100)..][..10].iter().cloned();
        forged.extend(old.map(|arrival| Arrival { arrival_ns: at_ns, ..arrival }));
    }
    let forgeries = forged.len();
    let attacked = run_with(&options, &with(genuine, forged));
    assert_undisturbed(&attacked, &undisturbed);
    let end = last(&attacked);
    assert_eq!((&end["unverified"], &end["duplicated"], &end["lost"]), (&forgeries.into(), &0.into(), &0.into()));
    let alarms = events(&attacked, "alarm");
    assert!(alarms[0].contains("127.0.0.1:5000 is not signed with the key"), "{alarms:?}");
    // Unsigned frames, and text, give no sample at all.
    for flight in [flight, text_flight(0.0, 1, 0..50)] {
        let end = last(&run_with(&options, &flight));
        assert_eq!((&end["samples"], &end["received"]), (&0.into(), &0.into()), "{end}");
    }
}

/// A sample with wrong values.
fn mavlink_sample(sequence: &mut u8, t: f64, at_ns: u64) -> Vec<Arrival> {
    mavlink(SENDER, sequence, t + 0.005, at_ns, t, 0.3)
}

#[test]
fn with_a_named_sender_no_other_one_is_used_even_before_it() {
    let options = ReceiverOptions { sender: Some("127.0.0.1:6000".parse().unwrap()), ..ReceiverOptions::default() };
    let mut flight = text_flight(0.0, 1, 100..SAMPLES);
    let undisturbed = run(&flight);
    flight.iter_mut().for_each(|arrival| arrival.origin = STRANGER);
    // Somebody was there before, and stays.
    let mut others = text_flight(0.0, 1, 0..SAMPLES);
    others.iter_mut().for_each(|arrival| arrival.arrival_ns += STEP_NS / 3);
    let datagrams = others.len();
    let attacked = run_with(&options, &with(flight, others));
    assert_undisturbed(&attacked, &undisturbed);
    assert_eq!(last(&attacked)["strangers"], datagrams);
}
