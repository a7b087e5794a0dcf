//! The plant as an estimator sees it: states, outputs, unknown parameters, with all derivatives.

/// The known input of a plant (surface positions, thrust, altitude, ...), held or interpolated between samples.
pub trait Input: Copy {
    /// The input a fraction `s` in `[0, 1]` of the way from `self` to `other`.
    fn interpolate(&self, other: &Self, s: f64) -> Self;
}

impl<const M: usize> Input for [f64; M] {
    fn interpolate(&self, other: &Self, s: f64) -> Self {
        core::array::from_fn(|i| self[i] + s * (other[i] - self[i]))
    }
}

/// State rates with their derivatives: the plant linearised at one point.
#[derive(Clone, Copy, Debug)]
pub struct LinearizedRates<const N: usize, const P: usize> {
    /// `f(x, u) + Phi(x, u) theta`, state units per second.
    pub rates: [f64; N],
    /// `d(f + Phi theta)/dx`, row = rate, column = state.
    pub state_jacobian: [[f64; N]; N],
    /// `Phi(x, u)`, row = rate, column = parameter. Columns from the parameter count on are never read.
    pub regressors: [[f64; P]; N],
}

impl<const N: usize, const P: usize> LinearizedRates<N, P> {
    /// All rates, derivatives and regressors zero: what a buffer starts with.
    pub const ZERO: Self = Self { rates: [0.0; N], state_jacobian: [[0.0; N]; N], regressors: [[0.0; P]; N] };
}

/// Outputs with their derivatives by the states and the parameters, at one point.
#[derive(Clone, Copy, Debug)]
pub struct LinearizedOutputs<const N: usize, const R: usize, const P: usize> {
    /// `h(x, theta, u)`, output units.
    pub outputs: [f64; R],
    /// `H = dh/dx`, row = output, column = state.
    pub state_jacobian: [[f64; N]; R],
    /// `D = dh/dtheta`, row = output, column = parameter. Columns from the parameter count on are never read.
    pub parameter_jacobian: [[f64; P]; R],
}

impl<const N: usize, const R: usize, const P: usize> LinearizedOutputs<N, R, P> {
    /// All outputs and derivatives zero: what a buffer starts with.
    pub const ZERO: Self = Self { outputs: [0.0; R], state_jacobian: [[0.0; N]; R], parameter_jacobian: [[0.0; P]; R] };
}

/// Derivatives by constants that are considered and not estimated, at one point: room for `K` of them.
#[derive(Clone, Copy, Debug)]
pub struct ConstantEffects<const N: usize, const R: usize, const K: usize> {
    /// `d(rates)/dc`, state units per second and unit of the constant; row = rate, column = constant.
    pub rates: [[f64; K]; N],
    /// `d(outputs)/dc`, output units per unit of the constant; row = output, column = constant.
    pub outputs: [[f64; K]; R],
}

impl<const N: usize, const R: usize, const K: usize> ConstantEffects<N, R, K> {
    /// No constant has any effect: what a buffer starts with.
    pub const ZERO: Self = Self { rates: [[0.0; K]; N], outputs: [[0.0; K]; R] };
}

/// A plant that is linear in its unknown parameters: `x' = f(x, u) + Phi(x, u) theta`, `y = h(x, theta, u)`.
///
/// `N` states, `R` outputs, room for `P` parameters. Implementations must be pure functions of their arguments and
/// finite for finite, physically possible ones; an estimator treats a non-finite value as a lost sample.
/// Analytic or forward-mode Jacobians only: estimators rely on them to rounding.
pub trait Model<const N: usize, const R: usize, const P: usize> {
    /// Type of the known input, an array of numbers for most plants.
    type Input: Input;

    /// Parameters in use, at most `P`.
    fn parameter_count(&self) -> usize;

    /// `f(x, u) + Phi(x, u) theta` alone, state units per second.
    fn rates(&self, x: &[f64; N], theta: &[f64; P], u: &Self::Input) -> [f64; N];

    /// Rates, their state Jacobian and the regressors, written to `out`.
    /// The known part `f` is what this gives with `theta = 0`.
    fn linearized_rates(&self, x: &[f64; N], theta: &[f64; P], u: &Self::Input, out: &mut LinearizedRates<N, P>);

    /// Outputs and their Jacobians, written to `out`.
    fn linearized_outputs(&self, x: &[f64; N], theta: &[f64; P], u: &Self::Input, out: &mut LinearizedOutputs<N, R, P>);

    /// The output channel that measures state `state` directly (`h = x[state]`), if there is one.
    fn measuring_output(&self, state: usize) -> Option<usize>;

    /// Number of constants that are considered and not estimated: scales of sensors, the mass, whatever leaves no trace
    /// in residuals. Zero unless a model says otherwise, and then nothing is paid for them. Only the estimators that say
    /// so ([`Considering`](crate::supervisor::considered::Considering)) look at them.
    fn constant_count(&self) -> usize {
        0
    }

    /// What one unit of each considered constant adds to rates and outputs where all constants are zero, written to
    /// `out`, which holds zeros. The rates and outputs of the other functions are those with all constants zero, which is
    /// what the estimator believes; the plant flies with `c`, of which only the variances are known.
    fn constant_effects<const K: usize>(
        &self,
        _x: &[f64; N],
        _theta: &[f64; P],
        _u: &Self::Input,
        _out: &mut ConstantEffects<N, R, K>,
    ) {
    }

    /// The constants that leave a trace in residuals, by their places among all, at most
    /// [`MOST_LEARNT`](crate::supervisor::learnt::MOST_LEARNT): lags, times, play. Not the factors on states and forces.
    fn learnable_constants(&self) -> &[usize] {
        &[]
    }

    /// By which part the regressor of a column, as the estimator believes it, is larger than the true one, per unit of
    /// each constant: 2 for a coefficient where the airspeed shows `(1 + c)` times the true one and stands squared in the
    /// dynamic pressure. Zero where the error of the regressor is no factor of it. A column that is a parameter then is
    /// found smaller by this part, and its gain is smaller too.
    fn regressor_powers<const K: usize>(&self, _x: &[f64; N], _column: usize) -> [f64; K] {
        [0.0; K]
    }

    /// What the constants add to the regressor of a column of those of other columns: the square of an angle whose sensor
    /// shows `c` more than the true angle has, to first order, `2 c` times the regressor of the angle itself more. Empty
    /// where there are no such columns.
    fn regressor_shifts(&self, _column: usize) -> &[RegressorShift] {
        &[]
    }
}

/// A part of the regressor of one column in that of another one, as the estimator believes it to be, by the error of a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegressorShift {
    /// The constant, by its place in [`Model::constant_effects`].
    pub constant: usize,
    /// The column whose regressor is added.
    pub of: usize,
    /// How often, per unit of the constant.
    pub per_unit: f64,
}

/// What was measured at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<I, const R: usize> {
    /// Time of the measurement, s. Must increase from sample to sample; one that does not is rejected.
    pub time_s: f64,
    /// Known input from this instant on (it is held until the next sample, or interpolated towards it).
    pub input: I,
    /// Measured outputs; a value that is not finite is missing. All missing is a dropped frame: the estimator
    /// predicts through it.
    pub outputs: [f64; R],
}
