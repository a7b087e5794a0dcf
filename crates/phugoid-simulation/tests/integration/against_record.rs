//! An identified aircraft, flown with what its pilot did, against the record that it was identified from.

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::simulate::{CommandHold, Instant, Stepper};
use phugoid_identification::aircraft::ModelAircraft;
use phugoid_identification::batch::OutputFit;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::export::Identified;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::options::FlowAngles;
use phugoid_simulation::signals::signal;

use crate::shared_data::shared_file;

/// Integration steps in a sample of 0.1 s.
const STEPS: usize = 20;

/// The HFB-320, identified by output error from a 3-2-1-1 and a pulse of the elevator, as an aircraft: from the fitted initial state
/// on, it gets the recorded elevator and the recorded thrust, and nothing else of the record. It flies with the equations of
/// `phugoid simulate`, not with those of the estimation, through the standard atmosphere, and has to end up with the same motion.
#[test]
fn the_identified_hfb320_flies_as_its_record() {
    let Some(path) = shared_file("flight/hfb320.csv") else { return };
    let record = csv::read_path(&path, &CsvOptions::default()).unwrap();
    let model = ModelFile::named("hfb320").unwrap();
    // A motion that is flown anew knows no measured air data.
    let options = EstimateOptions {
        method: Some(Method::OutputError),
        flow_angles: FlowAngles::Simulated,
        ..EstimateOptions::default()
    };
    let estimation = estimate(&record, &model, &options, &mut |_| ()).unwrap();
    let identified = Identified::new(&model, &estimation);
    let aircraft = ModelAircraft::identified(&identified).unwrap();
    let fitted = |name: &str| &estimation.history.predicted.iter().find(|s| s.name == name).unwrap().values;
    let recorded = |name: &str| &record.channel(name).unwrap().values;

    // Where the standard atmosphere has the density of the model file.
    let density = |altitude: f64| aircraft.atmosphere().at(altitude).density;
    let (mut low, mut high) = (0.0, 10_000.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if density(middle) > 0.792 { &mut low } else { &mut high }) = middle;
    }
    let full = aircraft.propulsion(100.0, low, 0.3).thrust();
    let between = |values: &[f64], time: f64| {
        let k = record.time.partition_point(|t| *t <= time).clamp(1, record.time.len() - 1);
        let (before, after) = (record.time[k - 1], record.time[k]);
        values[k - 1] + (time - before) / (after - before) * (values[k] - values[k - 1])
    };
    let (elevator, thrust) = (recorded("elevator"), recorded("thrust"));
    let commands = |time: f64| Controls {
        throttle: between(thrust, time) / full,
        elevator: between(elevator, time),
        ..Controls::default()
    };
    let initial = State {
        speed: fitted("true_airspeed")[0],
        alpha: fitted("alpha")[0],
        theta: fitted("theta")[0],
        q: fitted("q")[0],
        altitude: low,
        ..State::from_array([0.0; 13])
    };
    let (sample_time, start) = (record.time[1] - record.time[0], record.time[0]);
    let half_step = 0.5 * sample_time / STEPS as f64;
    // With the density of the model file throughout, or through the standard atmosphere as it climbs and sinks.
    let flown = |held: bool| {
        let mut flight =
            Stepper::new(initial, Controls::default(), sample_time, STEPS, CommandHold::Step).with_actuators(false);
        let mut samples = Vec::with_capacity(record.time.len());
        for (k, &time) in record.time.iter().enumerate() {
            // The thrust is the recorded one: the engine of the aircraft is told so.
            let altitude = if held { low } else { flight.state().altitude };
            flight.set_state(&State { power: 100.0 * thrust[k] / full, altitude, ..flight.state() });
            samples.push(flight.sample(&aircraft, &Instant { commands: commands(time), ..Instant::default() }));
            let again = |t: f64, _: &State| commands(start + t + half_step);
            flight
                .advance(&aircraft, commands(time + half_step), again, |_| Default::default(), |_| Default::default())
                .unwrap();
        }
        samples
    };
    let (held, free) = (flown(true), flown(false));

    println!(
        "channel             rms   Theil   bias variance covariance | estimation: rms, Theil | flown apart from it: rms"
    );
    for name in ["true_airspeed", "alpha", "theta", "q", "ax", "az", "qdot"] {
        let of = signal(name).unwrap();
        let [held, free]: [Vec<f64>; 2] = [&held, &free].map(|samples| samples.iter().map(of).collect());
        let own = OutputFit::of(name, recorded(name), fitted(name)).unwrap();
        for (air, flown) in [("model's", &held), ("standard", &free)] {
            let fit = OutputFit::of(name, recorded(name), flown).unwrap();
            let apart = OutputFit::of(name, fitted(name), flown).unwrap();
            println!(
                "{name:13} {air:8} {:8.5} {:7.4} {:6.3} {:8.3} {:10.3} | {:8.5} {:7.4} | {:.6}",
                fit.rms,
                fit.theil,
                fit.theil_bias,
                fit.theil_variance,
                fit.theil_covariance,
                own.rms,
                own.theil,
                apart.rms
            );
            // Jategaonkar, ch. 11: below 0.3 counts as good.
            assert!(fit.theil < 0.3, "{name}: {}", fit.theil);
            // In the same air the aircraft and the model of the estimation are the same.
            if air == "model's" {
                assert!(apart.rms < 0.1 * own.rms, "{name}: apart {} with residuals of {}", apart.rms, own.rms);
            }
        }
    }
    let altitudes = free.iter().map(|sample| sample.state.altitude);
    let [lowest, highest] = [altitudes.clone().fold(f64::INFINITY, f64::min), altitudes.fold(0.0, f64::max)];
    println!("begun at {low:.0} m, between {lowest:.0} and {highest:.0} m");
}
