//! The flight as a story: tables and charts, without a word on how they are drawn.

use std::sync::Arc;

use phugoid_control::local::{AILERON, MAIN_AXIS, SURFACES};
use phugoid_control::lost::{Lost, Name};
use phugoid_control::margin::Margin;
use phugoid_control::qualities::Level;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level as Line, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};

use crate::controller::{AXIS_NAMES, NAMES};
use crate::flight::{Kind, RecoveryFlight};
use crate::outcome::{Left, Outcome};
use crate::performance::{Performance, Quantity};

/// A section of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Anchor, unique in the page.
    pub anchor: &'static str,
    /// Heading.
    pub heading: &'static str,
    /// Paragraphs.
    pub paragraphs: Vec<String>,
    /// Tables below the paragraphs.
    pub tables: Vec<Table>,
    /// Charts below the tables.
    pub charts: Vec<Chart>,
}

/// The sections of a flight's page, in order.
pub fn page(flight: &RecoveryFlight) -> Vec<Section> {
    let mut sections = vec![story(flight), motion(flight), surfaces(flight)];
    sections.extend(left(flight));
    sections
}

fn story(flight: &RecoveryFlight) -> Section {
    let rows = flight.events.iter().map(|event| vec![Cell::from(event.time_s), Cell::from(event.text.as_str())]);
    Section {
        anchor: "story",
        heading: "What happened",
        paragraphs: Vec::new(),
        tables: vec![Table {
            title: "Events".to_owned(),
            columns: vec![Column::new("Time", "s"), Column::new("Event", "")],
            rows: rows.collect(),
        }],
        charts: Vec::new(),
    }
}

struct Plot {
    time: Arc<[f64]>,
    instants: Vec<Line>,
}

impl Plot {
    fn of(flight: &RecoveryFlight) -> Self {
        let first = |kind: Kind| flight.events.iter().find(|event| event.kind == kind).map(|event| event.time_s);
        let damage = first(Kind::Damage).map(|at| Line::new("damage", at, Meaning::Truth));
        let after = |at: &f64| first(Kind::Damage).is_none_or(|damage| *at >= damage);
        let gains = flight.events.iter().filter(|event| event.kind == Kind::NewGains).map(|event| event.time_s);
        let gains = gains.filter(after).take(1).map(|at| Line::new("first new gains", at, Meaning::Flagship)).next();
        Self { time: Arc::from(flight.history.time_s.as_slice()), instants: damage.into_iter().chain(gains).collect() }
    }

    fn panel(&self, label: &str, unit: &str, curves: &[(&str, Meaning, &[f64], f64)]) -> Panel {
        let curve = |(name, meaning, values, scale): &(&str, Meaning, &[f64], f64)| Curve {
            label: (*name).to_owned(),
            meaning: *meaning,
            x: Arc::clone(&self.time),
            shape: Shape::Line(values.iter().map(|value| value * scale).collect()),
        };
        Panel {
            y: Axis::new(label, unit),
            content: Content::Curves {
                curves: curves.iter().map(curve).collect(),
                levels: Vec::new(),
                instants: self.instants.clone(),
            },
        }
    }
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

fn motion(flight: &RecoveryFlight) -> Section {
    let (plot, h) = (Plot::of(flight), &flight.history);
    let one = |label: &str, unit: &str, values: &[f64], scale: f64| {
        plot.panel(label, unit, &[("", Meaning::Flagship, values, scale)])
    };
    let panels = vec![
        one("Angle of attack", "deg", &h.alpha, DEGREES),
        one("Sideslip", "deg", &h.beta, DEGREES),
        one("Bank angle", "deg", &h.phi, DEGREES),
        one("Pitch angle", "deg", &h.theta, DEGREES),
        one("Normal load factor", "g", &h.load_factor, 1.0),
        one("Altitude", "m", &h.altitude, 1.0),
    ];
    Section {
        anchor: "motion",
        heading: "How it flew",
        paragraphs: Vec::new(),
        tables: Vec::new(),
        charts: vec![Chart {
            name: "motion".to_owned(),
            title: "True motion".to_owned(),
            caption: String::new(),
            x: Axis::new("Time", "s"),
            panels,
            columns: 2,
        }],
    }
}

fn surfaces(flight: &RecoveryFlight) -> Section {
    let (plot, h) = (Plot::of(flight), &flight.history);
    let mut panels: Vec<Panel> = NAMES
        .iter()
        .enumerate()
        .map(|(j, name)| {
            let label = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
            plot.panel(
                &label,
                "deg",
                &[
                    ("command", Meaning::Command, &h.commands[j], DEGREES),
                    ("position", Meaning::Truth, &h.surfaces[j], DEGREES),
                ],
            )
        })
        .collect();
    panels.push(plot.panel(
        "Size of the added input",
        "\u{2013}",
        &[
            ("elevator", Meaning::Method(0), &h.excitation[0], 1.0),
            ("aileron", Meaning::Method(1), &h.excitation[1], 1.0),
            ("rudder", Meaning::Method(2), &h.excitation[2], 1.0),
        ],
    ));
    Section {
        anchor: "surfaces",
        heading: "What the surfaces did",
        paragraphs: Vec::new(),
        tables: Vec::new(),
        charts: vec![Chart {
            name: "surfaces".to_owned(),
            title: "Surfaces".to_owned(),
            caption: "The added input is what the control moves the surfaces by so that the estimate becomes better: 1 is all \
                      of it, half a degree of elevator and one of aileron and rudder (root mean square)."
                .to_owned(),
            x: Axis::new("Time", "s"),
            panels,
            columns: 2,
        }],
    }
}

/// What is said where the last estimate does not explain how the aircraft moved.
pub const UNEXPLAINED: &str = "The estimate does not explain how the aircraft moved in the last seconds: use neither it nor what \
                               follows from it, below.";

/// A level in words.
pub const fn level_word(level: Level) -> &'static str {
    match level {
        Level::One => "level 1",
        Level::Two => "level 2",
        Level::Three => "level 3",
        Level::Worse => "worse than level 3",
    }
}

/// "not controllable in pitch and yaw", or none where the surfaces still move the aircraft about all axes.
fn uncontrolled_words(controlled: &[bool; SURFACES], rolled_by_sideslip: bool) -> Option<String> {
    let is_rolled = |j: usize| j == AILERON && rolled_by_sideslip;
    let lost = || (0..SURFACES).filter(|j| !controlled[*j]);
    let rolled = lost().any(is_rolled).then_some("rolled only by the rudder, through sideslip");
    let axes: Vec<&str> = lost().filter(|j| !is_rolled(*j)).map(|j| AXIS_NAMES[MAIN_AXIS[j]]).collect();
    let Some((last, others)) = axes.split_last() else { return rolled.map(str::to_owned) };
    let named = if others.is_empty() { (*last).to_owned() } else { format!("{} and {last}", others.join(", ")) };
    let also = rolled.map(|words| format!(", {words}")).unwrap_or_default();
    Some(format!("not controllable in {named}{also}"))
}

/// The level of flying qualities that an estimate gives, with the worst within its bounds and what it does not tell: "level 1 (2 within the
/// bounds)".
pub fn level_words(left: &Left) -> String {
    let untold = match left.told {
        [true, true] => None,
        [false, true] => Some("in pitch"),
        [true, false] => Some("in roll and yaw"),
        [false, false] => Some("on any axis"),
    };
    let untold = untold.map(|axes| {
        format!("nothing is said of them {axes}: the model does not estimate stability, damping and surface there")
    });
    let uncontrolled = uncontrolled_words(&left.controlled, left.rolled_by_sideslip);
    let said = match (left.level, left.level_within_bounds, &uncontrolled) {
        (Some(level), _, Some(why)) => Some(format!("{}: {why}", level_word(level))),
        (None, _, Some(why)) => Some(why.clone()),
        (Some(level), Some(worst), None) if worst > level => {
            let worst = level_word(worst);
            let worst = worst.strip_prefix("level ").unwrap_or(worst);
            Some(format!("{} ({worst} within the bounds)", level_word(level)))
        }
        (Some(level), ..) => Some(level_word(level).to_owned()),
        (None, ..) => None,
    };
    said.into_iter().chain(untold).collect::<Vec<_>>().join("; ")
}

/// How a flight ended and with which true flying qualities, in words: "in level flight, flying qualities level 1".
pub fn ended_words(outcome: &Outcome) -> String {
    let ended = match (outcome.departed, outcome.level_flight) {
        (true, _) => "departed from controlled flight",
        (false, true) => "in level flight",
        (false, false) => "in the air, not in level flight",
    };
    let mut words = ended.to_owned();
    if outcome.level_flight && !outcome.holds_energy {
        let (change, more) = (outcome.speed_change_m_s2.abs(), outcome.speed_change_m_s2 > 0.0);
        let what = if more { "gaining" } else { "losing" };
        words += &format!(" but {what} {change:.1} m/s of speed each second, which it cannot go on with");
    }
    words + ", flying qualities " + &quality_words(outcome)
}

/// The true flying qualities at the end, in words.
pub fn quality_words(outcome: &Outcome) -> String {
    match uncontrolled_words(&outcome.controlled, outcome.rolled_by_sideslip).filter(|_| !outcome.departed) {
        Some(why) => format!("{} by its motion alone, {why}", level_word(outcome.level)),
        None => level_word(outcome.level).to_owned(),
    }
}

/// Which of the measured forces the estimate does not explain, in a sentence; none where it explains both or nothing was measured.
pub fn forces_words(performance: &Performance) -> Option<String> {
    let forces = performance.forces.as_ref()?;
    let one = |name: &str, force: &crate::forces::Force| {
        (!force.explained)
            .then(|| format!("{name} (coefficient {:.4} measured, {:.4} estimated)", force.measured, force.predicted))
    };
    let named: Vec<String> = one("lift", &forces.lift).into_iter().chain(one("drag", &forces.drag)).collect();
    (!named.is_empty()).then(|| {
        format!(
            "The estimate does not explain the measured {}: the aircraft has changed otherwise than the estimate, or its mass is not that of \
             the model file.",
            named.join(" and ")
        )
    })
}

/// What is said of a surface in place of a margin; none where it has one.
pub fn no_margin(margin: &Margin) -> Option<&'static str> {
    match (margin.is_used, margin.has_effect) {
        (false, _) => Some("lost"),
        (true, false) => Some("no effect"),
        (true, true) => None,
    }
}

/// What the changes of the derivatives look like, in a sentence.
pub fn lost_words(name: &Name) -> String {
    let percent = (100.0 * name.fraction).round();
    match (name.has_changed, name.lost, name.or) {
        (false, ..) => "No derivative that the model estimates has changed by more than its bound.".to_owned(),
        (true, None, _) => {
            "The derivatives have changed as by none of these: the loss of elevator, horizontal tail, rudder, vertical tail, ailerons \
             or a part of a wing, or another centre of gravity."
                .to_owned()
        }
        (true, Some(Lost::CentreOfGravity), None) => {
            "The derivatives have changed as by another centre of gravity.".to_owned()
        }
        (true, Some(part), None) => {
            format!("The derivatives have changed as by the loss of {percent} % of the {}.", part.words())
        }
        (true, Some(part), Some(other)) => format!(
            "The derivatives have changed as by the loss of a part of the {}, or of the {}: the flight does not tell which.",
            part.words(),
            other.words()
        ),
    }
}

/// At which angle of attack and sideslip margins are, in a sentence.
pub fn condition_words(left: &Left) -> String {
    let [alpha, beta] = left.flow_angles.map(f64::to_degrees);
    format!(
        "What straight flight takes of each surface at the angle of attack ({alpha:.1} deg) and sideslip ({beta:.1} deg) of the last seconds, \
         and the way from there to the nearer limit as a part of half the range, times the part of its effect that the surface still has."
    )
}

/// A row of what the aircraft can still do: name, value, twice the standard error, unit, note. Where it is not known the note says why.
pub type PerformanceRow = (&'static str, Option<[f64; 2]>, &'static str, String);

/// What the aircraft can still do, in the order of the table.
pub fn performance_rows(performance: &Performance) -> Vec<PerformanceRow> {
    let row = |name: &'static str, quantity: &Quantity, scale: f64, unit: &'static str| {
        let value = quantity.value.zip(quantity.std_error);
        (name, value.map(|(value, error)| [scale * value, 2.0 * scale * error]), unit, quantity.note.clone())
    };
    vec![
        row("Lift coefficient", &performance.lift, 1.0, ""),
        row("Drag coefficient", &performance.drag, 1.0, ""),
        row("Glide ratio", &performance.glide_ratio, 1.0, ""),
        row("Glide range", &performance.glide_range_m, 0.001, "km"),
        row("Best glide ratio", &performance.best_glide_ratio, 1.0, ""),
        row("Slowest known speed", &performance.slowest_known_m_s, 1.0, "m/s"),
        row("Load factor that is known", &performance.load_factor_known, 1.0, "g"),
        row("Lowest speed that the surfaces hold", &performance.control_speed_m_s, 1.0, "m/s"),
        row("Approach speed", &performance.approach_m_s, 1.0, "m/s"),
    ]
}

/// What is said where nothing is known of what the aircraft can still do.
pub const NO_PERFORMANCE: &str =
    "Too little was flown since the last change to say how far it glides and how slow it may fly.";

fn performance_table(performance: &Performance) -> Table {
    let rows = performance_rows(performance).into_iter().map(|(name, value, unit, note)| {
        let number = |place: usize| value.map_or(Cell::from("not known"), |value| Cell::from(value[place]));
        vec![
            Cell::from(name),
            number(0),
            value.map_or(Cell::from(""), |_| number(1)),
            Cell::from(unit),
            Cell::from(note),
        ]
    });
    Table {
        title: "What it can still do, true airspeed at the present air density".to_owned(),
        columns: vec![
            Column::new("Quantity", ""),
            Column::new("Value", ""),
            Column::new("\u{b1} 2 sigma", ""),
            Column::new("Unit", ""),
            Column::new("Of what", ""),
        ],
        rows: rows.collect(),
    }
}

fn left(flight: &RecoveryFlight) -> Option<Section> {
    let left = flight.left.as_ref()?;
    let rows = NAMES.iter().zip(&left.margins).zip(&flight.truly_left.margins).map(|((name, margin), truth)| {
        let used = |value: f64| no_margin(margin).map_or(Cell::from(value), Cell::from);
        vec![
            Cell::from(*name),
            Cell::from(margin.trim * DEGREES),
            Cell::from(2.0 * margin.std_error * DEGREES),
            used(100.0 * margin.left),
            used(100.0 * margin.at_least),
            no_margin(truth).map_or(Cell::from(100.0 * truth.left), Cell::from),
        ]
    });
    let margins = Table {
        title: "Control margins".to_owned(),
        columns: vec![
            Column::new("Surface", ""),
            Column::new("Takes", "deg"),
            Column::new("\u{b1} 2 sigma", "deg"),
            Column::new("Left", "%"),
            Column::new("At least", "%"),
            Column::new("True", "%"),
        ],
        rows: rows.collect(),
    };
    let unknown = flight.performance.is_none().then(|| NO_PERFORMANCE.to_owned());
    Some(Section {
        anchor: "left",
        heading: "What the estimate says is left",
        paragraphs: (flight.explained == Some(false))
            .then(|| UNEXPLAINED.to_owned())
            .into_iter()
            .chain(flight.performance.as_ref().and_then(forces_words))
            .chain(flight.lost.as_ref().map(lost_words))
            .chain([format!("Flying qualities: {}.", level_words(left)), condition_words(left)])
            .chain(unknown)
            .collect(),
        tables: std::iter::once(margins).chain(flight.performance.as_ref().map(performance_table)).collect(),
        charts: Vec::new(),
    })
}
