//! Flies the built-in damage with each control and says what happened.
//!
//! `cargo run --release -p phugoid-recovery --example recovery_flight [SCENARIO.toml | INDEX FIRST-SEED]`: a scenario, or damage
//! number INDEX of the study with that first seed.

use phugoid_identification::model_file::ModelFile;
use phugoid_recovery::draw::{classes, damaged};
use phugoid_recovery::flight::{Control, Settings, fly};
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::Scenario;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let scenario = match arguments.as_slice() {
        [index, seed] => {
            let base = Scenario::named("f16-recovery")?;
            let (aircraft, trim) = trimmed_aircraft(&base)?;
            let (index, seed): (usize, u64) = (index.parse()?, seed.parse()?);
            let seed = seed + index as u64;
            damaged(&base, aircraft.as_ref(), &trim, &classes(index, seed), seed)
        }
        [name] => Scenario::find(name)?,
        _ => Scenario::named("f16-recovery")?,
    };
    println!("{}", scenario.name);
    let model = ModelFile::named("f16-recovery-model")?;
    for control in Control::ALL {
        let flight = fly(&scenario, &Settings { control, ..Settings::default() }, &model)?;
        println!("{}:", control.word());
        for event in &flight.events {
            println!("  {:6.2} s  {}", event.time_s, event.text);
        }
        let o = &flight.outcome;
        println!(
            "  level flight {}, level {:?}, roots {:.2} {:.2} {:.2}, altitude lost {:.0} m, load factor {:.1} to {:.1} g",
            o.level_flight,
            o.level,
            o.excess.pitch,
            o.excess.lateral,
            o.excess.whole,
            o.altitude_lost_m,
            o.load_factor[0],
            o.load_factor[1]
        );
        println!("  {:?}", o.qualities);
        if let Some(e) = &flight.estimate {
            for i in 0..3 {
                println!("  est {:8.3?}  {:8.3?}  {:8.3}", e.model.rates[i], e.model.surfaces[i], e.model.constant[i]);
                println!(
                    "  std {:8.3?}  {:8.3?}  {:8.3}",
                    e.std_error.rates[i], e.std_error.surfaces[i], e.std_error.constant[i]
                );
                println!(
                    "  tru {:8.3?}  {:8.3?}  {:8.3}",
                    flight.truth.model.rates[i], flight.truth.model.surfaces[i], flight.truth.model.constant[i]
                );
            }
        }
    }
    Ok(())
}
