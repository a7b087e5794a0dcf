//! The two-parameter law of the second-order plants.
//!
//! With `x'' = known + Phi_1 a_1 + Phi_2 a_2`, `v = x'` and
//!
//! ```text
//! D = v v' - vm vm',   F = x v - xm vm
//! s_i = (v^2 - vm^2)/2 + lambda_i (x^2 - xm^2)/2,   sdot_i = D + lambda_i F
//! a_i = (D + lambda_i F) / (k_i F + eta)                                        printed law
//! k_i = |a_i (1/alpha_i - 1) z_i| - eta,   z_i = dD/da_i = v Phi_i              reconstructed from the one-parameter law
//! ```
//!
//! The denominator holds `F`, not `D`, as printed. `sdot_1 - sdot_2 = (lambda_1 - lambda_2) F` contains no parameter: both
//! surfaces ask for a point on one of two parallel lines `z_1 a_1 + z_2 a_2 = const`, at every instant. What makes the law
//! give two numbers all the same is `eta` and the gains in the denominators, not the data. [`TwoParameterDiagnostics`]
//! shows it; [`ExtendedLaw`](super::ExtendedLaw) mends it.
//!
//! For the aircraft the thesis prints one expression for `Cm_alpha` and `Cm_q` both, over one surface: two equal numbers. It
//! is a law for one of them while the other is known, which [`ThesisLaw`](super::ThesisLaw) is.

use super::claim::{verdict, without_covariance};
use super::error::ThesisError;
use super::gain::{gain, spread};
use super::parallel::{measured, parts};
use super::settings::{Evaluation, LawSign, ThesisForm};
use phugoid_estimators::discretization::{self, InputHold, IntervalInput};
use phugoid_estimators::{Estimate, Estimator, Phase};
use phugoid_estimators::{LinearizedRates, Model, Sample};

/// Most Newton steps per sample.
const MAXIMUM_ITERATIONS: usize = 25;

/// States of a plant of second order: `x` and `x'`.
const STATES: usize = 2;
/// What is measured of it: both states and `x''`.
const OUTPUTS: usize = 3;

/// Settings of the two-parameter law. Parameters 0 and 1 of the model are the unknown ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoParameterSettings<const P: usize> {
    /// All parameters of the model; the unknown ones' entries are their start values.
    pub parameters: [f64; P],
    /// Lower and upper bound of each unknown.
    pub bounds: [[f64; 2]; 2],
    /// State and output that hold `x`.
    pub position: usize,
    /// State and output that hold `v = x'`.
    pub velocity: usize,
    /// Index of the output that holds `v'`.
    pub acceleration: usize,
    /// `lambda` of each surface, 1/s.
    pub lambda: [f64; 2],
    /// `eta > 0`, in units of `z`.
    pub eta: f64,
    /// Form of the law. The other forms have `eta` alone in the denominator, as with one parameter.
    pub form: ThesisForm,
    /// How the loop is closed.
    pub evaluation: Evaluation,
    /// How the sign of the law's right hand side is chosen.
    pub sign: LawSign,
    /// How far outside their bounds the implicit solutions may lie, as a part of their width. May be infinite.
    pub margin: f64,
    /// How the input goes from one sample to the next.
    pub input_hold: InputHold,
    /// Longest step with which the estimated model is integrated, s.
    pub maximum_step_s: f64,
    /// Longest interval that is predicted through, s; after a longer one the model starts again from the measurements.
    pub maximum_gap_s: f64,
}

impl<const P: usize> TwoParameterSettings<P> {
    /// Exactly as printed, for a plant with states and outputs `x, x'` and a third output `x''`.
    pub fn as_printed(
        parameters: [f64; P],
        bounds: [[f64; 2]; 2],
        lambda: [f64; 2],
        eta: f64,
        evaluation: Evaluation,
    ) -> Self {
        Self {
            parameters,
            bounds,
            position: 0,
            velocity: 1,
            acceleration: 2,
            lambda,
            eta,
            form: ThesisForm::Printed,
            evaluation,
            sign: LawSign::AsPrinted,
            margin: f64::INFINITY,
            input_hold: InputHold::Zero,
            maximum_step_s: 0.02,
            maximum_gap_s: 2.0,
        }
    }

    /// The damped form: moving from the last estimates, with the sign of the slope, solved, near the bounds.
    pub fn damped(mut self) -> Self {
        self.form = ThesisForm::Damped;
        self.evaluation = Evaluation::Implicit;
        self.sign = LawSign::FromSlope;
        self.margin = 0.25;
        self
    }

    fn check(&self, parameters: usize) -> Result<(), ThesisError> {
        if parameters < 2 {
            return Err(ThesisError::Parameter { index: 1, count: parameters });
        }
        for [lower, upper] in self.bounds {
            let finite = lower.is_finite() && upper.is_finite() && lower < upper;
            if !finite || (self.form == ThesisForm::Printed && lower * upper <= 0.0) {
                return Err(ThesisError::Bounds { lower, upper });
            }
        }
        if self.position >= STATES || self.velocity >= STATES || self.acceleration >= OUTPUTS {
            return Err(ThesisError::Channel { index: 0 });
        }
        if self.margin.is_nan() || self.margin < 0.0 {
            return Err(ThesisError::Setting { name: "margin", value: self.margin });
        }
        for (name, value) in [
            ("lambda", self.lambda[0]),
            ("lambda", self.lambda[1]),
            ("eta", self.eta),
            ("maximum_step_s", self.maximum_step_s),
            ("maximum_gap_s", self.maximum_gap_s),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ThesisError::Setting { name, value });
            }
        }
        Ok(())
    }
}

/// What the two-parameter law looks like from inside after one sample. Arrays: one entry per surface or parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoParameterDiagnostics {
    /// The surfaces `s_i`; both are zero when the law has reached them.
    pub surface: [f64; 2],
    /// `sdot_i = D + lambda_i F` with the estimates that hold from this sample on, 1/s.
    pub surface_rate: [f64; 2],
    /// `s_i sdot_i + eta |s_i|`: the reaching condition holds where this is not positive.
    pub reaching: [f64; 2],
    /// The gains `k_i` that follow from the bounds of the parameters.
    pub gain: [f64; 2],
    /// `k_i F + eta`, denominators of the printed law.
    pub denominator: [f64; 2],
    /// The slopes `z_i = dD/da_i` by which the parameters act on both surfaces.
    pub slope: [f64; 2],
    /// `sdot_i` vanishes on the line `z_1 a_1 + z_2 a_2 = level_i`.
    pub level: [f64; 2],
    /// Singular values, larger first, of `d(sdot_1, sdot_2)/d(a_1, a_2)`: what the data say. The smaller is zero.
    pub information: [f64; 2],
    /// Singular values, larger first, of the Jacobian of the whole algebraic loop, with `eta` and the gains in it.
    pub loop_singular_values: [f64; 2],
    /// Determinant of the Jacobian of the whole loop; near zero the loop has no clear solution.
    pub loop_determinant: f64,
}

/// The thesis's law for two parameters over two surfaces, for a plant of second order: its states are `x` and `x'`, its outputs
/// both of them and `x''`.
pub struct TwoParameterLaw<M, const P: usize>
where
    M: Model<STATES, OUTPUTS, P>,
{
    model: M,
    settings: TwoParameterSettings<P>,
    running: bool,
    theta: [f64; P],
    x: [f64; STATES],
    last_s: f64,
    last_input: Option<M::Input>,
    diagnostics: TwoParameterDiagnostics,
    phase: Phase,
}

/// The surfaces' rates at one sample: `D` at `reference`, linear in the parameters from there.
#[derive(Clone, Copy)]
struct Rates {
    reference: [f64; 2],
    /// `D` at the reference.
    d: f64,
    f: f64,
    z: [f64; 2],
}

impl Rates {
    fn at(&self, a: [f64; 2], lambda: [f64; 2]) -> [f64; 2] {
        let d = self.d + self.z[0] * (a[0] - self.reference[0]) + self.z[1] * (a[1] - self.reference[1]);
        [d + lambda[0] * self.f, d + lambda[1] * self.f]
    }
}

impl<M, const P: usize> TwoParameterLaw<M, P>
where
    M: Model<STATES, OUTPUTS, P>,
{
    /// Sets the law up; the first frame that measures both states starts it.
    pub fn new(model: M, settings: TwoParameterSettings<P>) -> Result<Self, ThesisError> {
        settings.check(model.parameter_count().min(P))?;
        Ok(Self {
            model,
            settings,
            running: false,
            theta: settings.parameters,
            x: [0.0; STATES],
            last_s: f64::NEG_INFINITY,
            last_input: None,
            diagnostics: TwoParameterDiagnostics::default(),
            phase: Phase::Starting,
        })
    }

    /// State of the estimated model.
    pub fn state(&self) -> &[f64; STATES] {
        &self.x
    }

    /// Surfaces, reaching condition, gains and rank after the last sample that had the surfaces.
    pub fn diagnostics(&self) -> &TwoParameterDiagnostics {
        &self.diagnostics
    }

    fn start(&mut self, sample: &Sample<M::Input, OUTPUTS>) {
        self.phase = Phase::Starting;
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        self.running = false;
        for state in 0..STATES {
            if let Some(value) = measured(self.model.measuring_output(state), sample) {
                self.x[state] = value;
            } else if state == self.settings.position || state == self.settings.velocity {
                return;
            }
        }
        self.running = true;
    }

    fn stop(&mut self) {
        self.phase = Phase::Diverged;
        self.theta[..2].fill(f64::NAN);
        self.diagnostics = TwoParameterDiagnostics::default();
    }

    fn estimates(&self) -> [f64; 2] {
        [self.theta[0], self.theta[1]]
    }

    fn sign(&self, z: f64) -> f64 {
        match self.settings.sign {
            LawSign::FromSlope if z > 0.0 => -1.0,
            LawSign::FromSlope | LawSign::AsPrinted => 1.0,
        }
    }

    fn gain(&self, i: usize, value: f64, z: f64) -> (f64, f64) {
        let [lower, upper] = self.settings.bounds[i];
        gain(value, spread(lower, upper), z, self.settings.eta)
    }

    /// The law with the last estimates on the right hand side.
    fn delayed(&self, rates: &Rates) -> [f64; 2] {
        let (before, eta) = (self.estimates(), self.settings.eta);
        let sdot = rates.at(before, self.settings.lambda);
        core::array::from_fn(|i| {
            let n = self.sign(rates.z[i]) * sdot[i];
            match self.settings.form {
                ThesisForm::Reduced => n / eta,
                ThesisForm::Damped => before[i] + n / eta,
                ThesisForm::Printed => n / (self.gain(i, before[i], rates.z[i]).0 * rates.f + eta),
            }
        })
    }

    /// Residual of the loop and its Jacobian.
    fn loop_at(&self, a: [f64; 2], before: [f64; 2], rates: &Rates) -> ([f64; 2], [[f64; 2]; 2]) {
        let eta = self.settings.eta;
        let sdot = rates.at(a, self.settings.lambda);
        let (mut value, mut jacobian) = ([0.0; 2], [[0.0; 2]; 2]);
        for i in 0..2 {
            let sign = self.sign(rates.z[i]);
            let (left, slope) = match self.settings.form {
                ThesisForm::Reduced => (eta * a[i], eta),
                ThesisForm::Damped => (eta * (a[i] - before[i]), eta),
                ThesisForm::Printed => {
                    let (k, dk) = self.gain(i, a[i], rates.z[i]);
                    (a[i] * (k * rates.f + eta), k * rates.f + eta + a[i] * dk * rates.f)
                }
            };
            value[i] = left - sign * sdot[i];
            for j in 0..2 {
                jacobian[i][j] = -sign * rates.z[j];
            }
            jacobian[i][i] += slope;
        }
        (value, jacobian)
    }

    /// Solves the loop by Newton from the last estimates. `None` if it does not settle.
    fn solve(&self, rates: &Rates) -> Option<[f64; 2]> {
        let before = self.estimates();
        let mut a = before;
        for _ in 0..MAXIMUM_ITERATIONS {
            let (value, j) = self.loop_at(a, before, rates);
            let determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
            let step = [
                (j[1][1] * value[0] - j[0][1] * value[1]) / determinant,
                (j[0][0] * value[1] - j[1][0] * value[0]) / determinant,
            ];
            let mut moved: f64 = 0.0;
            for i in 0..2 {
                if !step[i].is_finite() {
                    return None;
                }
                let [lower, upper] = self.settings.bounds[i];
                let span = upper - lower;
                let next =
                    (a[i] - step[i]).clamp(lower - self.settings.margin * span, upper + self.settings.margin * span);
                moved = moved.max((next - a[i]).abs() / span);
                a[i] = next;
            }
            if moved <= 1e-12 {
                return Some(a);
            }
        }
        None
    }

    fn advance(&mut self, sample: &Sample<M::Input, OUTPUTS>) {
        let settings = self.settings;
        let interval_s = sample.time_s - self.last_s;
        let Some(from) = self.last_input else { return self.start(sample) };
        if interval_s > settings.maximum_gap_s {
            return self.start(sample);
        }
        let input = IntervalInput { from, to: sample.input, hold: settings.input_hold };
        self.last_s = sample.time_s;
        self.last_input = Some(sample.input);
        let x = self.integrate(&input, interval_s);
        if !x.iter().sum::<f64>().is_finite() {
            return match settings.evaluation {
                Evaluation::Delayed => self.stop(),
                Evaluation::Implicit => self.start(sample),
            };
        }
        self.x = x;
        let seen = [settings.position, settings.velocity, settings.acceleration].map(|i| sample.outputs[i]);
        if !seen.iter().all(|y| y.is_finite()) {
            self.phase = Phase::Predicting;
            return;
        }
        let rates = self.rates_at_sample(seen, &sample.input);
        let solved = match settings.evaluation {
            Evaluation::Implicit => self.solve(&rates),
            Evaluation::Delayed => Some(self.delayed(&rates)),
        };
        if let Some(a) = solved {
            if !(a[0] + a[1]).is_finite() {
                return self.stop();
            }
            self.theta[..2].copy_from_slice(&a);
        }
        self.diagnose(&rates, seen);
        self.phase = if solved.is_some() { Phase::Sliding } else { Phase::Rejected };
    }

    /// State of the estimated model after one interval; its derivatives by the parameters are not needed.
    fn integrate(&self, input: &IntervalInput<M::Input>, interval_s: f64) -> [f64; STATES] {
        let (mut sensitivity, mut transition) = ([[0.0; P]; STATES], [[0.0; STATES]; STATES]);
        parts(interval_s, self.settings.maximum_step_s).fold(self.x, |x, part| {
            let (theta, into, by_state) = (&self.theta, &mut sensitivity, &mut transition);
            discretization::step(&self.model, &x, theta, input, interval_s, part, 0, into, by_state)
        })
    }

    fn rates_at_sample(&self, [xm, vm, am]: [f64; 3], input: &M::Input) -> Rates {
        let mut lin = LinearizedRates::<STATES, P>::ZERO;
        self.model.linearized_rates(&self.x, &self.theta, input, &mut lin);
        let (x, v) = (self.x[self.settings.position], self.x[self.settings.velocity]);
        let phi = &lin.regressors[self.settings.velocity];
        Rates {
            reference: self.estimates(),
            d: v * lin.rates[self.settings.velocity] - vm * am,
            f: x * v - xm * vm,
            z: [v * phi[0], v * phi[1]],
        }
    }

    fn diagnose(&mut self, rates: &Rates, [xm, vm, _]: [f64; 3]) {
        let Self { settings, .. } = *self;
        let a = self.estimates();
        let (x, v) = (self.x[settings.position], self.x[settings.velocity]);
        let surface = settings.lambda.map(|l| 0.5 * (v * v - vm * vm) + 0.5 * l * (x * x - xm * xm));
        let surface_rate = rates.at(a, settings.lambda);
        let gain: [f64; 2] = core::array::from_fn(|i| self.gain(i, a[i], rates.z[i]).0);
        let carried = rates.z[0] * a[0] + rates.z[1] * a[1];
        let (_, jacobian) = self.loop_at(a, a, rates);
        self.diagnostics = TwoParameterDiagnostics {
            surface,
            surface_rate,
            reaching: core::array::from_fn(|i| surface[i] * surface_rate[i] + settings.eta * surface[i].abs()),
            gain,
            denominator: gain.map(|k| k * rates.f + settings.eta),
            slope: rates.z,
            level: surface_rate.map(|rate| carried - rate),
            information: singular_values([rates.z, rates.z]),
            loop_singular_values: singular_values(jacobian),
            loop_determinant: determinant(jacobian),
        };
    }

    fn estimate(&self) -> Estimate<P> {
        let excited = |i: usize| self.diagnostics.slope[i].abs() > self.settings.eta;
        let verdicts = [0, 1].map(|i| (i, verdict(self.theta[i], self.settings.bounds[i], excited(i))));
        without_covariance(self.last_s, &self.theta, self.model.parameter_count(), self.phase, verdicts)
    }
}

fn determinant([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    a * d - b * c
}

/// Singular values of a 2x2 matrix, larger first.
fn singular_values(matrix: [[f64; 2]; 2]) -> [f64; 2] {
    let squares: f64 = matrix.iter().flatten().map(|x| x * x).sum();
    let product = determinant(matrix).abs();
    let larger = libm::sqrt(0.5 * (squares + libm::sqrt((squares * squares - 4.0 * product * product).max(0.0))));
    [larger, if larger > 0.0 { product / larger } else { 0.0 }]
}

impl<M, const P: usize> Estimator<OUTPUTS, P> for TwoParameterLaw<M, P>
where
    M: Model<STATES, OUTPUTS, P>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, OUTPUTS>) -> Estimate<P> {
        if self.phase == Phase::Diverged {
            self.last_s = self.last_s.max(sample.time_s);
        } else if !sample.time_s.is_finite() || sample.time_s <= self.last_s {
            self.phase = Phase::Rejected;
        } else if self.running {
            self.advance(sample);
        } else {
            self.start(sample);
        }
        self.estimate()
    }

    /// Infinite for the unknown parameters: the law knows no covariance.
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        for i in 0..2 {
            out[i][i] = f64::INFINITY;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::singular_values;

    #[test]
    fn singular_values_of_known_matrices() {
        assert_eq!(singular_values([[3.0, 0.0], [0.0, -2.0]]), [3.0, 2.0]);
        // Rank one: sqrt(2) |z| and zero.
        let [larger, smaller] = singular_values([[3.0, 4.0], [3.0, 4.0]]);
        assert!((larger - 50.0_f64.sqrt()).abs() < 1e-14 && smaller == 0.0);
        assert_eq!(singular_values([[0.0; 2]; 2]), [0.0; 2]);
    }
}
