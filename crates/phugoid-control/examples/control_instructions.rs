//! Frames of the control law with everything around it, for callgrind: the difference of two runs is what their frames cost.
//!
//! ```text
//! cargo build --release -p phugoid-control --example control_instructions
//! valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/examples/control_instructions frames 1000
//! ```
//!
//! `frames N`: the law, the watch over three surfaces, the excitation and the record of the last seconds. `decisions N`: whether
//! the bounds support new gains, which is asked five times a second.

use std::hint::black_box;

use phugoid_control::excitation::{Excitation, Now, Settings as ExcitationSettings};
use phugoid_control::following::Follower;
use phugoid_control::gains::Gains;
use phugoid_control::interval::{Comparison, Estimate};
use phugoid_control::law::{Demand, Law, Measured, Settings};
use phugoid_control::local::LocalModel;
use phugoid_control::prediction::Recent;
use phugoid_control::target::Targets;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, count] = arguments.as_slice() else { return Err("frames N, or decisions N".into()) };
    let count: u32 = count.parse()?;
    let model = LocalModel {
        rates: [[0.1, -30.0, -3.0, 0.0, 0.7], [1.5, 0.1, 0.0, -1.0, 0.0], [0.1, 9.0, -0.03, 0.0, -0.5]],
        surfaces: [[0.0, -45.0, 8.0], [-11.0, 0.0, 0.0], [0.0, -2.0, -4.5]],
        alpha_by_alpha: -0.9,
        alpha_by_elevator: -0.12,
        beta_by_beta: -0.25,
        beta_by_rudder: 0.04,
        alpha: 0.04,
        speed: 205.0,
        gravity: 9.81,
        ..LocalModel::default()
    };
    let std_error = LocalModel { rates: [[0.1; 5]; 3], surfaces: [[0.1; 3]; 3], ..LocalModel::default() };
    let gains = Gains::place(&model, &Targets::default()).ok_or("not finite")?;
    let mut law = Law::new(Settings::new(0.01, [0.0; 5], [0.0; 3], [[-0.4, 0.4]; 3], [1.0; 3]), gains);
    let mut followers = [Follower::new(0.05, 1.0, 0.01); 3];
    let (mut recent, mut excitation) = (Recent::new(), Excitation::new(ExcitationSettings::default()));
    for k in 0..count {
        if what == "decisions" {
            let mut damaged = model;
            damaged.surfaces[1][0] = -6.0 + 1e-6 * f64::from(k);
            let new = Gains::place(&damaged, &Targets::default()).ok_or("not finite")?;
            black_box(Comparison::new(&Estimate { model: damaged, std_error }, &gains, &new).supports(0.1));
            black_box((recent.explains(&damaged, [0.3, 0.1, 0.05]), recent.prefers(&model, &damaged)));
            continue;
        }
        let wave = 0.01 * f64::from(k % 100);
        let measured = Measured { variables: [wave, 0.1 * wave, wave, 0.5 * wave, 0.0], surfaces: [wave; 3] };
        recent.update(&measured.variables, &measured.surfaces, 0.01);
        let added = excitation.update(&Now { width: [2.0; 3], ..Now::default() }, 0.01);
        let commands = law.update(&measured, &Demand { pitch_rate: 0.01, ..Demand::default() });
        for j in 0..3 {
            black_box(followers[j].update(commands[j], added[j], measured.surfaces[j], 0.01));
        }
    }
    Ok(())
}
