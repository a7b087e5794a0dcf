//! Any text as an aircraft of JSBSim: an aircraft that can be evaluated, or an error that points into the text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use phugoid_aircraft::jsbsim::{Aircraft, Evaluator, FlightCondition, JsbsimError};

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    match Aircraft::from_text(&text) {
        Ok(aircraft) => {
            let mut evaluator = Evaluator::new(&aircraft);
            evaluator.set_flight(&FlightCondition {
                airspeed_m_s: 60.0,
                alpha_rad: 0.1,
                beta_rad: -0.05,
                alphadot_rad_s: 0.1,
                betadot_rad_s: 0.0,
                rates_rad_s: [0.1, 0.2, 0.3],
                attitude_rad: [0.1, 0.2, 3.0],
                height_m: 1000.0,
                height_above_ground_m: 900.0,
                density_kg_m3: 1.1,
                pressure_pa: 90_000.0,
                temperature_k: 280.0,
                sound_speed_m_s: 335.0,
            });
            evaluator.start_channels(0.01);
            evaluator.step_channels(0.01);
            evaluator.step_channels(0.01);
            evaluator.coefficients();
            evaluator.propulsive_force_moment();
            evaluator.mass_properties();
            aircraft.inputs();
        }
        Err(error) => {
            if let JsbsimError::Refused { line, .. } = error {
                assert!(line >= 1 && line as usize <= text.split('\n').count() + 1, "line {line} is in the file");
            }
            assert!(error.to_string().len() < 2000, "the message fits on a screen");
        }
    }
});
