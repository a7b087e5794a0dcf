//! RK4 steps of the F-16 for an instruction count, and a rough time beside it.
//!
//! ```text
//! cargo build --release -p phugoid-flight-dynamics --example flight_dynamics_instructions
//! valgrind --tool=callgrind --toggle-collect='flight_dynamics_instructions::fly_steps' \
//!     target/release/examples/flight_dynamics_instructions 10000
//! ```
//!
//! The collected instructions divided by the number of steps are the cost of one step; the loading is left out.

use phugoid_flight_dynamics::aircraft::{Controls, State};
use phugoid_flight_dynamics::f16::{F16, F16DataError, F16Options};
use phugoid_flight_dynamics::integrate::rk4_step;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use std::hint::black_box;
use std::time::Instant;

#[inline(never)]
fn fly_steps(aircraft: &F16, start: [f64; 13], controls: &Controls, steps: usize) -> [f64; 13] {
    let still = Disturbance::default();
    let mut x = start;
    for step in 0..steps {
        if step % 1000 == 0 {
            x = black_box(start);
        }
        x = rk4_step(|_, x| motion(aircraft, &State::from_array(*x), controls, &still).rates.to_array(), 0.0, &x, 0.01);
    }
    x
}

fn main() -> Result<(), F16DataError> {
    let steps = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(2_000_000);
    let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
    let start = [205.74, 0.06, 0.02, 0.4, 0.05, 1.0, 0.02, 0.03, 0.04, 100.0, 200.0, 6096.0, 20.0];
    let controls = Controls { throttle: 0.3, elevator: -0.034, aileron: 0.003, rudder: -0.002 };
    // In pieces, the fastest of which a busy machine disturbs least.
    let piece = usize::min(steps, 5_000);
    let (mut fastest, mut speed) = (f64::INFINITY, 0.0);
    for _ in 0..steps / piece {
        let clock = Instant::now();
        speed = fly_steps(&aircraft, start, black_box(&controls), piece)[0];
        fastest = fastest.min(clock.elapsed().as_secs_f64());
    }
    println!("best of {}: {:.0} RK4 steps/s; speed {speed:.4} m/s", steps / piece, piece as f64 / fastest);
    Ok(())
}
