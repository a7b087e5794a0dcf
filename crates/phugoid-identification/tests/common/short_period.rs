//! The unstable aircraft of R. V. Jategaonkar (Flight Vehicle System Identification, 2nd ed.): short-period motion, linear,
//! all six derivatives unknown. For tests: its parameters have dimensions, which no model file has.

use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};

use super::{Table, shared_file};

/// Trim speed, m/s.
pub(crate) const SPEED: f64 = 44.5695;
/// `Zw, Zq, Zde, Mw, Mq, Mde` as published.
pub(crate) const TRUTH: [f64; 6] = [-1.4249, -1.4768, -6.2632, 0.21635, -3.7125, -12.769];
pub(crate) const NAMES: [&str; 6] = ["Zw", "Zq", "Zde", "Mw", "Mq", "Mde"];

/// States w (m/s), q (rad/s); outputs w, q, az (m/s^2); input elevator (rad).
///
/// `w' = Zw w + (U0 + Zq) q + Zde de`, `q' = Mw w + Mq q + Mde de`, `az = Zw w + Zq q + Zde de`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShortPeriod;

/// In any room for at least six columns.
impl<const P: usize> Model<2, 3, P> for ShortPeriod {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        6
    }

    fn rates(&self, x: &[f64; 2], t: &[f64; P], u: &[f64; 1]) -> [f64; 2] {
        let z = t[0] * x[0] + t[1] * x[1] + t[2] * u[0];
        [z + SPEED * x[1], t[3] * x[0] + t[4] * x[1] + t[5] * u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 2], t: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<2, P>) {
        *out = LinearizedRates::ZERO;
        out.rates = self.rates(x, t, u);
        out.state_jacobian = [[t[0], SPEED + t[1]], [t[3], t[4]]];
        out.regressors[0][..3].copy_from_slice(&[x[0], x[1], u[0]]);
        out.regressors[1][3..6].copy_from_slice(&[x[0], x[1], u[0]]);
    }

    fn linearized_outputs(&self, x: &[f64; 2], t: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<2, 3, P>) {
        *out = LinearizedOutputs::ZERO;
        out.outputs = [x[0], x[1], t[0] * x[0] + t[1] * x[1] + t[2] * u[0]];
        out.state_jacobian = [[1.0, 0.0], [0.0, 1.0], [t[0], t[1]]];
        out.parameter_jacobian[2][..3].copy_from_slice(&[x[0], x[1], u[0]]);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }
}

/// Samples of a flight.
pub(crate) struct Flight {
    pub(crate) time: Vec<f64>,
    pub(crate) inputs: Vec<[f64; 1]>,
    pub(crate) outputs: Vec<[f64; 3]>,
}

/// The published simulated flight.
pub(crate) fn flight() -> Option<Flight> {
    let table = Table::read(&shared_file("flight/unstable_short_period.csv")?);
    let column = |name: &str| table.column(name);
    let (w, q, az) = (column("w_m_s"), column("q_rad_s"), column("az_m_s2"));
    let outputs = (0..w.len()).map(|k| [w[k], q[k], az[k]]).collect();
    let inputs = column("elevator_rad").into_iter().map(|e| [e]).collect();
    Some(Flight { time: column("time_s"), inputs, outputs })
}
