//! Sample by sample, as on board: `cargo run -p phugoid --example live_session`.
//!
//! The samples of a recorded flight are given to a session one after the other. The estimate after the last one is, bit for bit,
//! that of an estimation over the whole record.

#![allow(clippy::expect_used, clippy::panic)] // an example may stop

use phugoid::{Error, EstimateOptions, Model, Record, Session, Step, estimate};

fn main() -> Result<(), Error> {
    let record = Record::open(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/flight.csv"))?;
    let model = Model::named("f16-model")?;
    let options = EstimateOptions::default();

    let mut session = Session::new(&model, &options)?;
    // The session says which values it takes, in which order, in SI units.
    let channels: Vec<&[f64]> = session
        .channels()
        .iter()
        .map(|name| record.require(name).map(|channel| channel.values.as_slice()).expect("the flight has it"))
        .collect();

    println!("{:>6} {:>10} {:>10}  phase", "time s", "dCm_alpha", "bound");
    let (mut waiting, mut shown_s) = (0, 0.0);
    for (k, time_s) in record.time.iter().enumerate() {
        // A value that is missing would be NaN here.
        let sample: Vec<f64> = channels.iter().map(|values| values[k]).collect();
        match session.update(*time_s, &sample)? {
            // The first two seconds are collected: the noise levels and the start come from them.
            Step::Waiting { .. } => waiting += 1,
            Step::Refused(reason) => panic!("{time_s} s: {reason}"),
            Step::Estimated => {
                let snapshot = session.snapshot().expect("there is an estimate");
                if time_s - shown_s >= 1.0 {
                    shown_s = *time_s;
                    let cm_alpha = &snapshot.parameters[0];
                    let bound = 2.0 * cm_alpha.std_error;
                    println!("{time_s:>6.2} {:>10.5} {bound:>10.5}  {}", cm_alpha.value, snapshot.phase);
                }
            }
        }
    }

    let whole = estimate(&record, &model, &options)?;
    let last = session.snapshot().expect("there is an estimate");
    for (live, recorded) in last.parameters.iter().zip(&whole.parameters) {
        assert_eq!(live.value.to_bits(), recorded.value.to_bits(), "{}", recorded.name);
    }
    assert_eq!(waiting, 100, "two seconds at 50 Hz");
    assert!((last.parameters[0].value + 0.2).abs() < 0.001);
    Ok(())
}
