//! Trim at the condition of table 2.2: where every aircraft case of the thesis starts.

use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::f16::{F16, F16Options, F16Tables};
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::modes::{Mode, ModeName};
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimStart, TrimStep, approach, trim};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::entry::Entry;
use crate::result::Reproduction;
use crate::result::Requirement;
use crate::units::FOOT;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_simulation::flight::FlightError;

/// Entries of this file.
pub(crate) const ENTRIES: &[Entry] =
    &[Entry { id: "trim/table-2.2", title: "Trim at 20,000 ft and 675 ft/s, straight and level", run }];

const POUND_FORCE: f64 = 4.448_221_615_260_5;
const ALTITUDE_FT: f64 = 20_000.0;
const SPEED_FT_S: f64 = 675.0;
/// Centre of gravity of the cases, fraction of the mean chord.
const CG: f64 = 0.30;
/// Angle of attack (deg), elevator (deg) and thrust (lbf) of this condition by an independent program with the same tables.
const CROSS_CHECK: [f64; 3] = [2.38934, -1.96254, 2227.74];
/// Short period of the same program's linear model, s: one cycle, wherever a time in cycles is asked for.
pub(super) const SHORT_PERIOD_S: f64 = 4.17;
/// Random starts, and how many of them are drawn.
const STARTS: u64 = 200;
const STARTS_DRAWN: usize = 8;
/// Below this largest residual the solver has arrived.
const ARRIVED: f64 = 1e-11;

struct Found {
    trim: Trim,
    modes: Vec<Mode>,
}

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let aircraft = |tables| F16::new(F16Options { tables, cg: CG, ..F16Options::default() }).map_err(FlightError::from);
    let (book, morelli) = (aircraft(F16Tables::Book)?, aircraft(F16Tables::Morelli)?);
    let condition = TrimCondition::steady(&book, SPEED_FT_S * FOOT, ALTITUDE_FT * FOOT, 0.0, 0.0);
    let (of_book, of_morelli) = (found(&book, &condition)?, found(&morelli, &condition)?);
    let ways = ways(&book, &condition, progress)?;
    Ok(Reproduction {
        id: id.to_owned(),
        title: ENTRIES[0].title.to_owned(),
        place: "equation 2.31 and table 2.2".to_owned(),
        published: "Every aircraft case starts in trim at 20,000 ft and 675 ft/s, straight, level, wings level, found by making \
                    the index J = V'^2 + alpha'^2 + beta'^2 + p'^2 + q'^2 + r'^2 small; table 2.2 lists the result."
            .to_owned(),
        reconstruction: "The numbers of table 2.2 are lost in the text at hand. Centre of gravity at 0.30 of the mean chord, \
                         thrust along body x. The cross-check is an independent program with the same tables."
            .to_owned(),
        difference: "The eight equations of steady flight are solved as a root-finding problem with exact derivatives, so J \
                     ends at rounding instead of at a small number that a minimiser was content with. J is given with V' in \
                     m/s²; with V' in ft/s², as in the thesis, its first term is 10.76 times as large."
            .to_owned(),
        requirements: requirements(&of_book, &ways),
        tables: vec![quantities(&of_book.trim, &of_morelli.trim), modes(&of_book, &of_morelli), starts(&ways)],
        charts: vec![chart(&ways)],
        golden: golden(&of_book, &of_morelli),
        ..Reproduction::default()
    })
}

fn found(aircraft: &F16, condition: &TrimCondition) -> Result<Found, StudyError> {
    let trim = trim(aircraft, condition).map_err(FlightError::from)?;
    let model = linearize(aircraft, &trim.state(), &trim.controls(), &Disturbance::default());
    let mut modes = model.longitudinal().map_err(StudyError::unsuitable)?.modes;
    modes.extend(model.lateral().map_err(StudyError::unsuitable)?.modes);
    Ok(Found { trim, modes })
}

/// The solver's way from random starts, each drawn from its number alone.
fn ways(
    aircraft: &F16,
    condition: &TrimCondition,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<Vec<TrimStep>>, StudyError> {
    let limits = aircraft.actuators();
    (0..STARTS)
        .map(|run| {
            let mut random = Pcg64Mcg::seed_from_u64(run);
            let mut within = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
            let start = TrimStart {
                alpha: within(-5.0, 15.0).to_radians(),
                beta: within(-5.0, 5.0).to_radians(),
                phi: within(-20.0, 20.0).to_radians(),
                theta: within(-10.0, 20.0).to_radians(),
                throttle: within(0.0, 1.0),
                elevator: within(-limits.elevator.limit, limits.elevator.limit),
                aileron: within(-limits.aileron.limit, limits.aileron.limit),
                rudder: within(-limits.rudder.limit, limits.rudder.limit),
            };
            progress((run + 1) as f64 / STARTS as f64);
            Ok(approach(aircraft, condition, &start).map_err(FlightError::from)?)
        })
        .collect()
}

fn arrived<'a>(ways: &'a [Vec<TrimStep>]) -> impl Iterator<Item = (usize, &'a TrimStep)> {
    let last = |way: &'a Vec<TrimStep>| way.last().map(|step| (way.len() - 1, step));
    ways.iter().filter_map(last).filter(|(_, step)| step.largest_residual < ARRIVED)
}

fn short_period(found: &Found) -> f64 {
    found.modes.iter().find(|m| m.name == ModeName::ShortPeriod).and_then(|m| m.period_s).unwrap_or(f64::NAN)
}

fn requirements(book: &Found, ways: &[Vec<TrimStep>]) -> Vec<Requirement> {
    let trim = &book.trim;
    let ours = [trim.alpha_rad.to_degrees(), trim.elevator_rad.to_degrees(), trim.thrust_n / POUND_FORCE];
    let off = |k: usize| (ours[k] - CROSS_CHECK[k]).abs();
    let reached = arrived(ways).filter(|(_, step)| (step.alpha_rad - trim.alpha_rad).abs() < 1e-9).count();
    let period = short_period(book);
    vec![
        Requirement {
            what: "angle of attack, elevator and thrust are those of the cross-check".into(),
            limit: "0.00001 deg, 0.00001 deg, 0.01 lbf".into(),
            found: format!("{:.1e} deg, {:.1e} deg, {:.4} lbf away", off(0), off(1), off(2)),
            met: off(0) < 1e-5 && off(1) < 1e-5 && off(2) < 1e-2,
        },
        Requirement {
            what: "trim index at the trim".into(),
            limit: "1e-20".into(),
            found: format!("{:.0e}", trim.trim_index),
            met: trim.trim_index < 1e-20,
        },
        Requirement {
            what: "the same trim from random starts".into(),
            limit: format!("{STARTS} of {STARTS}"),
            found: format!("{reached} of {STARTS}"),
            met: reached as u64 == STARTS,
        },
        Requirement {
            what: "period of the short period".into(),
            limit: format!("{SHORT_PERIOD_S} s, to 0.01 s"),
            found: format!("{period:.3} s"),
            met: (period - SHORT_PERIOD_S).abs() < 0.01,
        },
    ]
}

/// Quantity, unit, value.
fn listed(trim: &Trim) -> Vec<(&'static str, &'static str, f64)> {
    /// What is zero by symmetry comes out of the solver as rounding.
    const ROUNDING: f64 = 1e-12;
    [
        ("angle of attack", "deg", trim.alpha_rad.to_degrees()),
        ("sideslip angle", "deg", trim.beta_rad.to_degrees()),
        ("bank angle", "deg", trim.phi_rad.to_degrees()),
        ("pitch angle", "deg", trim.theta_rad.to_degrees()),
        ("elevator", "deg", trim.elevator_rad.to_degrees()),
        ("aileron", "deg", trim.aileron_rad.to_degrees()),
        ("rudder", "deg", trim.rudder_rad.to_degrees()),
        ("thrust", "lbf", trim.thrust_n / POUND_FORCE),
        ("throttle", "–", trim.throttle),
        ("engine power", "%", trim.power_percent),
        ("dynamic pressure", "Pa", trim.dynamic_pressure_pa),
        ("Mach number", "–", trim.mach),
        ("load factor", "–", trim.load_factor),
    ]
    .map(|(name, unit, value)| (name, unit, if value.abs() < ROUNDING { 0.0 } else { value }))
    .to_vec()
}

fn quantities(book: &Trim, morelli: &Trim) -> Table {
    let columns = ["quantity", "unit", "book tables", "Morelli's tables", "cross-check", "table 2.2"];
    let mut rows: Vec<Vec<Cell>> = listed(book)
        .into_iter()
        .zip(listed(morelli))
        .map(|((name, unit, of_book), (_, _, of_morelli))| {
            let known = match name {
                "angle of attack" => CROSS_CHECK[0],
                "elevator" => CROSS_CHECK[1],
                "thrust" => CROSS_CHECK[2],
                _ => f64::NAN,
            };
            vec![name.into(), unit.into(), of_book.into(), of_morelli.into(), known.into(), "lost".into()]
        })
        .collect();
    rows.push(vec![
        "trim index J".into(),
        "mixed".into(),
        book.trim_index.into(),
        morelli.trim_index.into(),
        f64::NAN.into(),
        "lost".into(),
    ]);
    Table { title: "The trim".into(), columns: columns.map(|name| Column::new(name, "")).to_vec(), rows }
}

fn modes(book: &Found, morelli: &Found) -> Table {
    let rows = [("book", book), ("Morelli's", morelli)].into_iter().flat_map(|(tables, found)| {
        found.modes.iter().map(move |mode| {
            vec![
                tables.into(),
                mode.name.to_string().into(),
                mode.eigenvalue_real.into(),
                mode.eigenvalue_imaginary.into(),
                mode.period_s.into(),
                mode.damping_ratio.into(),
            ]
        })
    });
    Table {
        title: "Modes of the aircraft about the trim".into(),
        columns: vec![
            Column::new("tables", ""),
            Column::new("mode", ""),
            Column::new("real part", "1/s"),
            Column::new("imaginary part", "rad/s"),
            Column::new("period", "s"),
            Column::new("damping ratio", "–"),
        ],
        rows: rows.collect(),
    }
}

/// How far the solver has come after each iteration, over all starts.
fn starts(ways: &[Vec<TrimStep>]) -> Table {
    let longest = arrived(ways).map(|(iterations, _)| iterations).max().unwrap_or(0);
    let rows = (0..=longest).map(|iteration| {
        let mut indices: Vec<f64> =
            ways.iter().filter_map(|way| Some(way.get(iteration).or(way.last())?.trim_index)).collect();
        indices.sort_by(f64::total_cmp);
        let there = arrived(ways).filter(|(iterations, _)| *iterations <= iteration).count();
        let at = |fraction: f64| indices.get((fraction * (indices.len() - 1) as f64) as usize).copied();
        vec![(iteration as f64).into(), at(0.5).into(), at(1.0).into(), (there as f64).into()]
    });
    Table {
        title: format!("Trim index over the iterations from {STARTS} random starts, book tables"),
        columns: vec![
            Column::new("iteration", "–"),
            Column::new("median J", "mixed"),
            Column::new("largest J", "mixed"),
            Column::new("starts arrived", "–"),
        ],
        rows: rows.collect(),
    }
}

fn chart(ways: &[Vec<TrimStep>]) -> Chart {
    let curves = ways.iter().take(STARTS_DRAWN).enumerate().map(|(run, way)| Curve {
        label: format!("start {}", run + 1),
        meaning: Meaning::Method(run),
        x: (0..way.len()).map(|k| k as f64).collect(),
        // An index of exactly zero has no logarithm: it is drawn where rounding ends.
        shape: Shape::Line(way.iter().map(|step| step.trim_index.max(1e-34).log10()).collect()),
    });
    Chart {
        name: "index".into(),
        title: "Trim index from random starts".into(),
        caption: format!(
            "The first {STARTS_DRAWN} of {STARTS} starts, with random attitude, throttle and surfaces. Far from the trim the steps \
             are damped; near it the error squares with every iteration, down to rounding."
        ),
        x: Axis::new("Iteration", "–"),
        panels: vec![Panel {
            y: Axis::new("log₁₀ of the trim index J", "–").with_range(-35.0, 10.0),
            content: Content::Curves {
                curves: curves.collect(),
                levels: vec![Level::new("required", -20.0, Meaning::Bound)],
                instants: Vec::new(),
            },
        }],
        columns: 1,
    }
}

/// One row per set of tables, one column per quantity that is not zero by symmetry: that would be rounding, and differ from
/// machine to machine.
fn golden(book: &Found, morelli: &Found) -> Table {
    const BY_SYMMETRY: [&str; 4] = ["sideslip angle", "bank angle", "aileron", "rudder"];
    let quantities = |found: &Found| {
        let modes = [ModeName::ShortPeriod, ModeName::Phugoid, ModeName::DutchRoll].into_iter().flat_map(|name| {
            let mode = found.modes.iter().find(|mode| mode.name == name);
            let part = |of: fn(&Mode) -> f64| mode.map_or(f64::NAN, of);
            [
                (format!("{name}, real part"), "1/s", part(|m| m.eigenvalue_real)),
                (format!("{name}, imaginary part"), "rad/s", part(|m| m.eigenvalue_imaginary)),
            ]
        });
        let listed = listed(&found.trim).into_iter().filter(|(name, ..)| !BY_SYMMETRY.contains(name));
        listed.map(|(name, unit, value)| (name.to_owned(), unit, value)).chain(modes).collect::<Vec<_>>()
    };
    let row = |tables: &str, found: &Found| -> Vec<Cell> {
        let values = quantities(found).into_iter().map(|(_, _, value)| value.into());
        std::iter::once(tables.into()).chain(values).collect()
    };
    let columns = quantities(book).into_iter().map(|(name, unit, _)| Column::new(name, unit));
    Table {
        title: "trim".into(),
        columns: std::iter::once(Column::new("tables", "")).chain(columns).collect(),
        rows: vec![row("book", book), row("morelli", morelli)],
    }
}
