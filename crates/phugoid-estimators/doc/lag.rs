// The plant of the documentation examples: `x' = -a x + b u`, `y = x`, with `a` and `b` unknown.

use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model, Sample};

#[derive(Clone, Copy)]
pub struct Lag;

impl Model<1, 1, 2> for Lag {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        2
    }

    fn rates(&self, x: &[f64; 1], theta: &[f64; 2], u: &[f64; 1]) -> [f64; 1] {
        [-theta[0] * x[0] + theta[1] * u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; 2], u: &[f64; 1], out: &mut LinearizedRates<1, 2>) {
        out.rates = self.rates(x, theta, u);
        out.state_jacobian = [[-theta[0]]];
        out.regressors = [[-x[0], u[0]]];
    }

    fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 2], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, 2>) {
        out.outputs = *x;
        out.state_jacobian = [[1.0]];
        out.parameter_jacobian = [[0.0; 2]];
    }

    fn measuring_output(&self, _state: usize) -> Option<usize> {
        Some(0)
    }
}

/// One sigma of the measurement noise of [`flight`].
#[allow(dead_code)]
pub const NOISE: f64 = 0.01;

/// `seconds` of flight at 100 Hz with a square wave as input. `a(t)` gives the true `a`; the true `b` is 2.
#[allow(dead_code)]
pub fn flight(seconds: f64, a: impl Fn(f64) -> f64) -> Vec<Sample<[f64; 1], 1>> {
    let (h, mut x, mut state) = (0.01, 0.0, 1_u64);
    let mut uniform = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..(seconds / h).round() as u32)
        .map(|k| {
            let time_s = h * f64::from(k);
            let u = if ((time_s / 1.5) as u32).is_multiple_of(2) { 1.0 } else { -1.0 };
            let noise = NOISE * (0..12).map(|_| uniform()).sum::<f64>();
            let sample = Sample { time_s, input: [u], outputs: [x + noise] };
            let decay = (-a(time_s) * h).exp();
            x = x * decay + 2.0 / a(time_s) * (1.0 - decay) * u;
            sample
        })
        .collect()
}
