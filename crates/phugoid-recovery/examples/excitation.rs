//! How soon damage is known, against how much the added input loads the aircraft: the same damages in calm air with a stick that moves
//! by 0.15 deg, with the excitation at several limits. The first row is the stick alone.
//!
//! ```sh
//! cargo run --release -p phugoid-recovery --example excitation -- 1000 8
//! ```
//!
//! Arguments: first seed, damages per class. Size and limit of the excitation go together: half a g has the default size.

use phugoid_control::excitation::Settings as Excitation;
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::statistics::quantile;
use phugoid_identification::model_file::ModelFile;
use phugoid_recovery::draw::{Class, DAMAGE_AT_S, damaged};
use phugoid_recovery::flight::{Control, Kind, RecoveryFlight, Settings, fly};
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::Scenario;

const TEXT: &str = include_str!("../../../scenarios/f16-recovery.toml");
/// Largest added load factor, g; zero is the stick alone.
const LIMITS: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0];
const CLASSES: [Class; 5] = [Class::Stability, Class::Elevator, Class::Ailerons, Class::Rudder, Class::VerticalTail];

/// Times from the damage to the adoption of a change, and to new gains, s; largest difference of the load factor from one after the
/// damage, g; largest size of the added input, 0 to 1.
struct Told {
    adopted_s: Option<f64>,
    gains_s: Option<f64>,
    peak: f64,
    excited: f64,
    recovered: bool,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [first, flights] = arguments.as_slice() else { return Err("arguments: FIRST-SEED DAMAGES-PER-CLASS".into()) };
    let (first, flights): (u64, usize) = (first.parse()?, flights.parse()?);
    let base = Scenario::parse(&TEXT.replace("rms = \"0.8 deg\"", "rms = \"0.15 deg\""), "scenario.toml")?;
    let model = ModelFile::named("f16-recovery-model")?;
    let (aircraft, trim) = trimmed_aircraft(&base)?;
    let one = |run: usize| -> Result<Vec<Told>, String> {
        let class = CLASSES[run % CLASSES.len()];
        let seed = first + run as u64;
        let mut scenario = damaged(&base, aircraft.as_ref(), &trim, &[class], seed);
        scenario.turbulence = None;
        let mut told = Vec::new();
        for limit in LIMITS {
            let default = Excitation::default();
            let part = limit / default.load_factor;
            let excitation = (limit > 0.0).then(|| Excitation {
                size: default.size.map(|size| part * size),
                load_factor: limit,
                ..default
            });
            let settings = Settings { control: Control::Adaptive, excitation, ..Settings::default() };
            let flight = fly(&scenario, &settings, &model).map_err(|e| e.to_string())?;
            let after = |flight: &RecoveryFlight, kind: Kind| {
                let event = flight.events.iter().find(|e| e.kind == kind && e.time_s >= DAMAGE_AT_S);
                event.map(|event| event.time_s - DAMAGE_AT_S)
            };
            let from = flight.history.time_s.partition_point(|time| *time < DAMAGE_AT_S);
            let after_damage = flight.history.load_factor.iter().skip(from);
            let level = (0..3).flat_map(|j| flight.history.excitation[j].iter().copied());
            told.push(Told {
                adopted_s: after(&flight, Kind::Adopted),
                gains_s: after(&flight, Kind::NewGains),
                peak: after_damage.map(|load_factor| (load_factor - 1.0).abs()).fold(0.0, f64::max),
                excited: level.fold(0.0, f64::max),
                recovered: flight.outcome.is_recovered(),
            });
        }
        Ok(told)
    };
    let told = monte_carlo(flights * CLASSES.len(), one, || ())?;
    println!(
        "limit, g  damages  peak load, g: median 90 %  excited  adopted  median 90 %, s  new gains  median 90 %, s  recovered"
    );
    for (k, limit) in LIMITS.iter().enumerate() {
        let of =
            |pick: &dyn Fn(&Told) -> Option<f64>| -> Vec<f64> { told.iter().filter_map(|t| pick(&t[k])).collect() };
        let excited = told.iter().filter(|t| t[k].excited > 0.1).count();
        let (peaks, adopted, gains) = (of(&|t| Some(t.peak)), of(&|t| t.adopted_s), of(&|t| t.gains_s));
        let pair = |values: &[f64]| [0.5, 0.9].map(|part| quantile(values.to_vec(), part));
        let ([p5, p9], [a5, a9], [g5, g9]) = (pair(&peaks), pair(&adopted), pair(&gains));
        println!(
            "{limit:8.2}  {:7}  {p5:19.3} {p9:6.3}  {excited:7}  {:7}  {a5:6.2} {a9:7.2}  {:9}  {g5:6.2} {g9:7.2}  {:9}",
            told.len(),
            adopted.len(),
            gains.len(),
            told.iter().filter(|t| t[k].recovered).count(),
        );
    }
    Ok(())
}
