//! Commands of control surfaces. An autopilot logs the command of a servo, not the angle of the surface. The user has
//! to give the angle at full command; none is assumed here.

use super::signals::{self, Signal, label, rising, topic};
use crate::align::Hold;
use crate::log::{Log, Topic, Wanted};
use crate::profile::{Mixture, SurfaceRule};
use crate::quality::QualityReport;

/// Largest age at which the last command is used, s.
pub(super) const STALE_AFTER_S: f64 = 0.5;

/// Controllers of PX4 before 1.13, and what the vehicle says of itself.
const CONTROLS: &str = "actuator_controls_0";
const STATUS: &str = "vehicle_status";
/// The fields of the latter.
const KIND: &str = "vehicle_type";
const IS_VTOL: &str = "is_vtol";
/// `VEHICLE_TYPE_FIXED_WING` of PX4's message vehicle_status.
const FIXED_WING: f64 = 2.0;

/// The parts of a log that tell the commands of surfaces.
pub(super) fn wanted(rule: SurfaceRule) -> Vec<Wanted> {
    let whole = |topic: &&str| Wanted { topic: (*topic).to_owned(), instance: None, fields: None };
    let mut wanted: Vec<Wanted> = topics(rule).iter().map(whole).collect();
    if rule == SurfaceRule::Px4 {
        let fields =
            |topic: &str, fields: Vec<String>| Wanted { topic: topic.to_owned(), instance: None, fields: Some(fields) };
        wanted.push(fields(CONTROLS, (0..3).map(|k| format!("control[{k}]")).collect()));
        wanted.push(fields(STATUS, [KIND, IS_VTOL].map(str::to_owned).into()));
    }
    wanted
}

/// The topics that hold the commands of servos.
fn topics(rule: SurfaceRule) -> &'static [&'static str] {
    match rule {
        SurfaceRule::Px4 => &["actuator_servos"],
        SurfaceRule::Ardupilot => &["RCOU"],
        SurfaceRule::Telemetry => &["SERVO_OUTPUT_RAW"],
    }
}

/// A servo and the surface that it moves.
struct Servo {
    /// The surface, such as `elevator` or `left_elevon`.
    surface: &'static str,
    /// The field of the topic that holds its command.
    field: String,
    /// The parameter of the log that assigns the surface, for the quality report.
    reason: String,
    pulse: Option<Pulse>,
}

/// Range of the pulse width of a servo, microseconds.
#[derive(Clone, Copy)]
struct Pulse {
    min: f64,
    trim: f64,
    max: f64,
    reversed: bool,
}

impl Pulse {
    /// The command from -1 to 1 of a pulse width; NaN if the width is not positive, which means no pulse.
    fn normalised(self, width: f64) -> f64 {
        if width <= 0.0 {
            return f64::NAN;
        }
        let span = if width >= self.trim { self.max - self.trim } else { self.trim - self.min };
        let command = if span > 0.0 { (width - self.trim) / span } else { f64::NAN };
        if self.reversed { -command } else { command }
    }
}

/// The commands of all known surfaces, -1 to 1, named `elevator_command`, `aileron_command` and so on, and those that
/// the profile mixes of several surfaces.
pub(super) fn commands(log: &Log, rule: SurfaceRule, mixed: &[Mixture]) -> Vec<Signal> {
    let servos = match rule {
        SurfaceRule::Px4 => px4(log),
        SurfaceRule::Ardupilot => ardupilot(log, |number| format!("C{number}")),
        SurfaceRule::Telemetry => ardupilot(log, |number| format!("servo{number}_raw")),
    };
    let mut signals: Vec<Signal> = Vec::new();
    let of_servos = topics(rule).iter().find_map(|name| topic(log, name, None));
    let (servos, source) = match of_servos {
        None if rule == SurfaceRule::Px4 && is_fixed_wing(log) => (controllers(), topic(log, CONTROLS, None)),
        found => (servos, found),
    };
    for servo in servos {
        let channel = format!("{}_command", servo.surface);
        if signals.iter().any(|signal| signal.channel == channel) {
            continue;
        }
        let Some(topic) = source else { continue };
        let Some(field) = topic.field(&servo.field) else { continue };
        let kept = rising(&topic.time_s);
        let value = |&sample: &usize| {
            let raw = field.values.get(sample).copied().unwrap_or(f64::NAN);
            servo.pulse.map_or(raw, |pulse| pulse.normalised(raw))
        };
        let header = format!("{}.{}", label(log, topic), servo.field);
        signals.push(Signal {
            channel,
            header: if servo.pulse.is_some() { format!("{header} from -1 to 1") } else { header },
            unit: Some("-".into()),
            scale: 1.0,
            hold: Hold::Held { stale_after_s: STALE_AFTER_S },
            topic: label(log, topic),
            time_s: kept.iter().filter_map(|&sample| topic.time_s.get(sample).copied()).collect(),
            values: kept.iter().map(value).collect(),
            note: Some(servo.reason),
            out_of_order: topic.time_s.len() - kept.len(),
        });
    }
    for Mixture { command, of } in mixed {
        let known = |name: &str| signals.iter().find(|signal| signal.channel == name);
        let parts: Option<Vec<(&Signal, f64)>> =
            of.iter().map(|(name, factor)| Some((known(name)?, *factor))).collect();
        // A surface with a servo of its own comes before a mixture.
        if let (None, Some(sum)) = (known(command), parts.and_then(|parts| signals::sum(&parts, STALE_AFTER_S))) {
            signals.push(Signal { channel: command.clone(), ..sum });
        }
    }
    signals
}

/// Tells the user, for every surface of which the log has only the command, what to write into the model file.
pub(super) fn report(
    log: &Log,
    commands: &[Signal],
    mapped: &[String],
    rule: SurfaceRule,
    mixed: &[Mixture],
    quality: &mut QualityReport,
) {
    for surface in ["elevator", "aileron", "rudder"] {
        if mapped.iter().any(|channel| channel == surface) {
            continue;
        }
        let command = format!("{surface}_command");
        if !commands.iter().any(|signal| signal.channel == command) {
            quality.note(surface, unknown(log, surface, rule));
        }
        if let Some(signal) = commands.iter().find(|signal| signal.channel == command) {
            let sign = match rule {
                SurfaceRule::Px4 => "positive commands of PX4 raise the trailing edge (of a rudder: move it right)",
                SurfaceRule::Ardupilot | SurfaceRule::Telemetry => "find out which way a positive command moves it",
            };
            quality.warn(
                surface,
                format!(
                    "the log has its command ({}, {}), but not its angle, and none is invented. Measure the deflection at full \
                     command and write into the model file\n    [channels]\n    {surface} = {{ header = \"{command}\", scale = \
                     DEFLECTION, unit = \"deg\" }}\nwith the degrees at command 1 for DEFLECTION, negative where that moves the \
                     {} ({sign})",
                    signal.header,
                    signal.note.as_deref().unwrap_or_default(),
                    if surface == "rudder" { "trailing edge right" } else { "(right) trailing edge up" },
                ),
            );
        }
    }
    let in_a_pair = |name: &str| ["elevon", "tail", "flaperon"].iter().any(|kind| name.contains(kind));
    let used: Vec<&str> = mixed
        .iter()
        .filter(|mixture| mixture.of.iter().all(|(name, _)| commands.iter().any(|signal| &signal.channel == name)))
        .flat_map(|mixture| mixture.of.iter().map(|(name, _)| name.as_str()))
        .collect();
    let names = commands.iter().map(|signal| signal.channel.as_str());
    let alone: Vec<&str> = names.filter(|name| in_a_pair(name) && !used.contains(name)).collect();
    let said = mapped.iter().any(|channel| ["elevator", "aileron", "rudder"].contains(&channel.as_str()));
    if let Some(first) = alone.first().filter(|_| !said) {
        let example: Vec<String> = alone.iter().map(|name| format!("{name} = FACTOR")).collect();
        quality.warn(
            first.trim_end_matches("_command"),
            format!(
                "{}: what is elevator, aileron or rudder of that is not worked out. Say it in the model file, for each surface \
                 that they make\n    [channels]\n    aileron = {{ sum = {{ {} }}, unit = \"deg\" }}\nwith their shares of \
                 the degrees at command 1 for FACTOR, and their signs",
                alone.join(", "),
                example.join(", ")
            ),
        );
    }
}

/// Why there is not even a command of this surface, as a clause.
fn unknown(log: &Log, surface: &str, rule: SurfaceRule) -> String {
    let has = |name: &str| log.others.iter().any(|other| other == name) || topic(log, name, None).is_some();
    match rule {
        SurfaceRule::Px4 if !has("actuator_servos") && has("actuator_controls_0") => {
            let control = match surface {
                "aileron" => 0,
                "elevator" => 1,
                _ => 2,
            };
            format!(
                "not in the log: this version of PX4 logs commands of its controllers, not which servo moves what. If one servo \
                 follows actuator_controls_0.control[{control}] (of a VTOL aircraft in forward flight actuator_controls_1), map it: \
                 [channels] {surface} = {{ header = \"actuator_controls_0.control[{control}]\", scale = DEFLECTION, unit = \"deg\" }}"
            )
        }
        SurfaceRule::Px4 => format!(
            "not in the log: no parameter CA_SV_CSi_TYPE says that a servo moves the {surface}, or actuator_servos is not logged. \
             If you know the field, map it: [channels] {surface} = {{ header = \"topic.field\", scale = DEFLECTION, unit = \"deg\" }}"
        ),
        SurfaceRule::Ardupilot => format!(
            "not in the log: no parameter SERVOn_FUNCTION says that a servo moves the {surface}, or RCOU is not logged"
        ),
        SurfaceRule::Telemetry => format!(
            "not in the log: no parameter SERVOn_FUNCTION came (ground stations ask for them at the start) that says that a servo \
             moves the {surface}, or SERVO_OUTPUT_RAW did not come. If you know the servo, map it: [channels] {surface} = \
             {{ header = \"SERVO_OUTPUT_RAW.servo1_raw\", scale = RADIANS_PER_MICROSECOND }}, which counts from 1500 us"
        ),
    }
}

fn parameter(log: &Log, name: &str) -> Option<f64> {
    log.parameters.iter().find(|(other, _)| other == name).map(|(_, value)| *value)
}

/// Control surfaces of PX4's control allocation (parameter `CA_SV_CSi_TYPE`, PX4 1.13 and later).
fn px4(log: &Log) -> Vec<Servo> {
    let servo = |index: usize| {
        let name = format!("CA_SV_CS{index}_TYPE");
        let surface = match parameter(log, &name)? as i64 {
            1 => "left_aileron",
            // The sign of the channel is that of the right aileron, which so stands for both.
            2 => "aileron",
            3 => "elevator",
            4 => "rudder",
            5 => "left_elevon",
            6 => "right_elevon",
            7 => "left_v_tail",
            8 => "right_v_tail",
            9 => "left_flap",
            10 => "right_flap",
            11 => "airbrake",
            13 => "left_a_tail",
            14 => "right_a_tail",
            15 => "aileron",
            _ => return None,
        };
        let reason = format!("by {name} = {}", parameter(log, &name)?);
        Some(Servo { surface, field: format!("control[{index}]"), reason, pulse: None })
    };
    (0..8).filter_map(servo).collect()
}

/// Whether the log is of an aeroplane all the time, and of none that also hovers: the controllers of a multirotor turn it by its
/// rotors.
fn is_fixed_wing(log: &Log) -> bool {
    let Some(status) = topic(log, STATUS, None) else { return false };
    let always = |topic: &Topic, name: &str, value: f64| {
        topic.field(name).is_some_and(|field| !field.values.is_empty() && field.values.iter().all(|v| *v == value))
    };
    always(status, KIND, FIXED_WING) && always(status, IS_VTOL, 0.0)
}

/// The controllers of an aeroplane before PX4 1.13: what they ask for goes to the servos through a mixer that the log does not have.
fn controllers() -> Vec<Servo> {
    let reason =
        "what the controller of a fixed-wing aircraft asks for; the mixer that makes servos of it is not in the log";
    let control = |(surface, index): (&'static str, usize)| Servo {
        surface,
        field: format!("control[{index}]"),
        reason: reason.to_owned(),
        pulse: None,
    };
    [("aileron", 0), ("elevator", 1), ("rudder", 2)].map(control).into()
}

/// Servos of ArduPilot (parameters `SERVOn_FUNCTION` and so on; ArduPlane, "Servo Functions").
/// `field` names the field of a servo's pulse width.
fn ardupilot(log: &Log, field: impl Fn(usize) -> String) -> Vec<Servo> {
    let servo = |number: usize| {
        let function = format!("SERVO{number}_FUNCTION");
        let surface = match parameter(log, &function)? as i64 {
            2 | 3 => "flaps",
            4 => "aileron",
            16 | 17 => return None,
            19 => "elevator",
            21 => "rudder",
            24 => "left_flaperon",
            25 => "right_flaperon",
            77 => "left_elevon",
            78 => "right_elevon",
            79 => "left_v_tail",
            80 => "right_v_tail",
            _ => return None,
        };
        let of = |what: &str, otherwise: f64| parameter(log, &format!("SERVO{number}_{what}")).unwrap_or(otherwise);
        // Where the log has no such parameter, the defaults of ArduPilot.
        let pulse = Pulse {
            min: of("MIN", 1100.0),
            trim: of("TRIM", 1500.0),
            max: of("MAX", 1900.0),
            reversed: of("REVERSED", 0.0) != 0.0,
        };
        let reason = format!("by {function} = {}", parameter(log, &function)?);
        Some(Servo { surface, field: field(number), reason, pulse: Some(pulse) })
    };
    (1..=16).filter_map(servo).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_are_normalised_on_both_sides_of_the_trim() {
        let pulse = Pulse { min: 1000.0, trim: 1400.0, max: 2000.0, reversed: false };
        assert_eq!(pulse.normalised(2000.0), 1.0);
        assert_eq!(pulse.normalised(1700.0), 0.5);
        assert_eq!(pulse.normalised(1200.0), -0.5);
        assert!(pulse.normalised(0.0).is_nan());
        assert_eq!(Pulse { reversed: true, ..pulse }.normalised(2000.0), -1.0);
    }
}
