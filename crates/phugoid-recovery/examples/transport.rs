//! NASA's transport with six cases of measured damage, identified in flight and flown on: which are found, how they are called, whether
//! the derivatives after them lie within their bounds, and how the flights end with each control.
//!
//! ```sh
//! cargo run --release -p phugoid-recovery --example transport -- ../shared/data/gtm 10 1000
//! ```
//!
//! Arguments: the folder of the tables (docs/transport.md), flights per damage, first seed. Every third flight is in light turbulence,
//! the others in calm air.

use phugoid_control::local::{ALPHA, BETA, LocalModel};
use phugoid_control::lost::Lost;
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_identification::model_file::ModelFile;
use phugoid_recovery::flight::{Control, Kind, RecoveryFlight, Settings, fly};
use phugoid_recovery::known::local_model;
use phugoid_simulation::flight::{later_aircraft, trimmed_aircraft};
use phugoid_simulation::scenario::Scenario;

const DAMAGE_AT_S: f64 = 15.0;
/// Length of the model over that of the aircraft that it stands for, as in the scenario.
const SCALE: f64 = 0.055;
/// The derivatives that are asked for: axis and feedback variable of Cn_beta, Cm_alpha and Cl_alpha.
const ASKED: [[usize; 2]; 3] = [[2, BETA], [1, ALPHA], [0, ALPHA]];
/// The words of the damages, and what each is called rightly.
const DAMAGES: [(&str, Lost); 6] = [
    ("rudder-off", Lost::Rudder),
    ("vertical-tail-off", Lost::VerticalTail),
    ("left-outboard-flap-off", Lost::LeftWing),
    ("left-wing-tip-off", Lost::LeftWing),
    ("left-elevator-off", Lost::Elevator),
    ("left-stabiliser-off", Lost::HorizontalTail),
];
const SCENARIO: &str = include_str!("transport/scenario.toml");
const MODEL: &str = include_str!("transport/model.toml");

/// What a flight with adaptive control tells, and how the others end.
struct Told {
    detected_s: Option<f64>,
    early: bool,
    named: Option<(Option<Lost>, Option<Lost>, bool)>,
    explained: bool,
    /// Margins of surfaces that are beyond four standard errors.
    margins_wrong: bool,
    /// Estimate less truth over the standard error, of the derivatives that are [`ASKED`] for. The truth is the slope at the trim in the
    /// first, and the mean of the slopes over what was flown after the damage in the second.
    errors: [[f64; 3]; 2],
    departed_at_s: Option<f64>,
    recovered: [bool; 4],
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(flights), Some(first)) = (arguments.next(), arguments.next(), arguments.next()) else {
        return Err("arguments: FOLDER-OF-TABLES FLIGHTS-PER-DAMAGE FIRST-SEED".into());
    };
    let (flights, first): (usize, u64) = (flights.parse()?, first.parse()?);
    let folder = std::fs::canonicalize(folder)?;
    let model = ModelFile::parse("model.toml", MODEL)?;
    println!(
        "damage                 flights  doubt  adopted after, s  named  wrongly  none of  covered, mean slopes of what was flown: Cn_beta Cm_alpha Cl_alpha  slopes at the trim: Cn_beta Cm_alpha Cl_alpha  level 1 or 2: fixed robust adaptive oracle  unexplained  margins wrong  silently"
    );
    for (word, part) in DAMAGES {
        let one = |run: usize| -> Result<Told, String> {
            let mut text = SCENARIO.replace("FOLDER", &folder.display().to_string()).replace("DAMAGE", word);
            if run % 3 == 2 {
                text.push_str("\n[turbulence]\nintensity = \"light\"\n");
            }
            let mut scenario = Scenario::parse(&text, "scenario.toml").map_err(|e| e.to_string())?;
            scenario.seed = first + run as u64;
            told(&scenario, &model)
        };
        let told = monte_carlo(flights, one, || ())?;
        print_row(word, part, &told);
    }
    Ok(())
}

fn told(scenario: &Scenario, model: &ModelFile) -> Result<Told, String> {
    let mut recovered = [false; 4];
    let mut adaptive: Option<RecoveryFlight> = None;
    for (control, recovered) in Control::ALL.into_iter().zip(&mut recovered) {
        let flight = fly(scenario, &Settings { control, ..Settings::default() }, model).map_err(|e| e.to_string())?;
        *recovered = flight.outcome.is_recovered();
        if control == Control::Adaptive {
            adaptive = Some(flight);
        }
    }
    let flight = adaptive.ok_or("no flight with adaptive control")?;
    let adopted = |from: f64| flight.events.iter().find(|e| e.kind == Kind::Adopted && e.time_s >= from);
    let flown = flown_slopes(scenario, &flight)?;
    let found = flight.estimate.as_ref();
    let error = |[axis, variable]: [usize; 2], truth: f64| {
        found.map_or(f64::NAN, |f| (f.model.rates[axis][variable] - truth) / f.std_error.rates[axis][variable])
    };
    let at_trim = ASKED.map(|[axis, variable]| flight.truth.model.rates[axis][variable]);
    let departed = flight.events.iter().find(|e| e.kind == Kind::Departed);
    Ok(Told {
        detected_s: adopted(DAMAGE_AT_S).map(|e| e.time_s - DAMAGE_AT_S),
        early: adopted(0.0).is_some_and(|e| e.time_s < DAMAGE_AT_S),
        named: flight.lost.map(|name| (name.lost, name.or, name.has_changed)),
        explained: flight.explained == Some(true),
        margins_wrong: flight.left.is_some_and(|left| {
            let pairs = left.margins.iter().zip(&flight.truly_left.margins);
            pairs.filter(|(m, _)| m.is_used).any(|(m, truth)| (m.trim - truth.trim).abs() > 4.0 * m.std_error)
        }),
        errors: [at_trim, flown].map(|truth| std::array::from_fn(|k| error(ASKED[k], truth[k]))),
        departed_at_s: departed.map(|e| e.time_s),
        recovered,
    })
}

/// Mean of the true slopes that are asked for over what was flown after the damage, at full size and at the speed at the end. The tables are
/// straight lines between their points; in a flight that goes to and fro over a point the slope at the trim is that of one side.
fn flown_slopes(scenario: &Scenario, flight: &RecoveryFlight) -> Result<[f64; 3], String> {
    // The slopes of a tenth of a second are alike, and the state of the damaged aircraft begins with the sample after the damage.
    const EVERY: usize = 10;
    let (aircraft, trim) = trimmed_aircraft(scenario).map_err(|e| e.to_string())?;
    let later = later_aircraft(scenario, &aircraft).map_err(|e| e.to_string())?.ok_or("no damage")?;
    let damaged = later.change().aircraft;
    let h = &flight.history;
    let end = h.speed.last().copied().unwrap_or(f64::NAN);
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for k in (0..h.time_s.len()).filter(|k| h.time_s[*k] > DAMAGE_AT_S).step_by(EVERY) {
        let state = State {
            speed: h.speed[k],
            altitude: h.altitude[k],
            alpha: h.alpha[k],
            beta: h.beta[k],
            phi: h.phi[k],
            theta: h.theta[k],
            p: h.rates[0][k],
            q: h.rates[1][k],
            r: h.rates[2][k],
            ..trim.state()
        };
        let [elevator, aileron, rudder] = std::array::from_fn(|j| h.surfaces[j][k]);
        let controls = Controls { elevator, aileron, rudder, ..trim.controls() };
        let linear = linearize(damaged, &state, &controls, &Disturbance::default());
        let model: LocalModel = local_model(&linear, state.alpha, state.speed, damaged.gravity());
        // Moments go with the square of the speed; at full size they turn the aircraft more slowly.
        let scaled = SCALE * (end / state.speed).powi(2);
        for (sum, [axis, variable]) in sum.iter_mut().zip(ASKED) {
            *sum += scaled * model.rates[axis][variable];
        }
        count += 1.0;
    }
    Ok(sum.map(|sum| sum / count))
}

fn print_row(word: &str, part: Lost, told: &[Told]) {
    let count = |is: &dyn Fn(&Told) -> bool| told.iter().filter(|t| is(t)).count();
    let mut latencies: Vec<f64> = told.iter().filter_map(|t| t.detected_s).collect();
    latencies.sort_by(f64::total_cmp);
    let median = latencies.get(latencies.len() / 2).copied().unwrap_or(f64::NAN);
    let right = |t: &Told| matches!(t.named, Some((found, or, _)) if found == Some(part) || (found.is_some() && or == Some(part)));
    let wrong = |t: &Told| matches!(t.named, Some((Some(_), ..))) && !right(t);
    let none = |t: &Told| matches!(t.named, Some((None, ..)));
    let flown: Vec<&Told> = told.iter().filter(|t| t.departed_at_s.is_none()).collect();
    let covered = |of: usize, k: usize| flown.iter().filter(|t| t.errors[of][k].abs() <= 2.0).count();
    println!(
        "{word:22} {:7}  {:5}  {median:16.2}  {:5}  {:7}  {:7}  {:>46} {:8} {:8} of {:<3} {:>25} {:8} {:8} of {:<3} {:>20} {:6} {:8} {:6} {:12} {:14} {:9}",
        told.len(),
        count(&|t| t.early),
        count(&right),
        count(&wrong),
        count(&none),
        covered(1, 0),
        covered(1, 1),
        covered(1, 2),
        flown.len(),
        covered(0, 0),
        covered(0, 1),
        covered(0, 2),
        flown.len(),
        count(&|t| t.recovered[0]),
        count(&|t| t.recovered[1]),
        count(&|t| t.recovered[2]),
        count(&|t| t.recovered[3]),
        flown.iter().filter(|t| !t.explained).count(),
        flown.iter().filter(|t| t.margins_wrong).count(),
        flown.iter().filter(|t| t.margins_wrong && t.explained).count(),
    );
}
