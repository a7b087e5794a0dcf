use super::measure::measure;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};

/// First order in the unknown with a second, known state,
///
/// ```text
/// x' = -a sin(y) x + B u
/// y' = C y x + sin(w t)
/// ```
///
/// Parameter `a`, 1/s; input `u` and the value of `sin(w t)`; outputs `x`, `y`, `x'`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrderNonlinear {
    /// `B`, the gain of the input `u` on `x'`, 1/s.
    pub input_gain: f64,
    /// `C`, the factor of the product `y x` in `y'`, 1/s.
    pub coupling: f64,
}

impl Default for FirstOrderNonlinear {
    /// The thesis's constants, `B = 1.4` and `|C| = 4`. The sign of `C` is reconstructed: with `C = +4` the plant escapes
    /// within three seconds, with `C = -4` it stays finite for as long as the published cases last.
    fn default() -> Self {
        Self { input_gain: 1.4, coupling: -4.0 }
    }
}

impl<const P: usize> Model<2, 3, P> for FirstOrderNonlinear {
    type Input = [f64; 2];

    fn parameter_count(&self) -> usize {
        1
    }

    fn rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 2]) -> [f64; 2] {
        const { assert!(P >= 1, "the plant has one parameter") };
        let [x, y] = *x;
        let [u, forcing] = *u;
        [-theta[0] * libm::sin(y) * x + self.input_gain * u, self.coupling * y * x + forcing]
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 2], out: &mut LinearizedRates<2, P>) {
        out.rates = Model::<2, 3, P>::rates(self, x, theta, u);
        let [x, y] = *x;
        let (sin, cos) = (libm::sin(y), libm::cos(y));
        out.state_jacobian = [[-theta[0] * sin, -theta[0] * cos * x], [self.coupling * y, self.coupling * x]];
        out.regressors = [[0.0; P]; 2];
        out.regressors[0][0] = -sin * x;
    }

    fn linearized_outputs(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 2], out: &mut LinearizedOutputs<2, 3, P>) {
        let mut lin = LinearizedRates::ZERO;
        Model::<2, 3, P>::linearized_rates(self, x, theta, u, &mut lin);
        measure(x, &lin, 0, &mut out.outputs, &mut out.state_jacobian, &mut out.parameter_jacobian);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < 2).then_some(state)
    }
}
