use phugoid_estimators::discretization::InputHold;

/// Where the derivative of a measured channel comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceDerivative {
    /// An output holds it, unit of the channel per second.
    Output(usize),
    /// Not measured, and not needed to be: the model's own rate at the measured states, in which the unknown parameter
    /// must not occur (`y'` of the nonlinear first-order plant).
    Known,
    /// Not measured: the surface condition is integrated over the sampling interval.
    Integrated,
}

/// One channel of the energy surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceChannel {
    /// Index of the model's state that is compared, counted from 0.
    pub state: usize,
    /// Index of the output that measures this state directly, counted from 0.
    pub output: usize,
    /// Its typical size: the channel enters divided by this. State units, positive.
    pub scale: f64,
    /// Its derivative. All channels of a surface must be integrated or none.
    pub derivative: SurfaceDerivative,
}

/// The forms of the law: as printed, or with what the project has changed in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThesisForm {
    /// As printed, with the gain `K` from the bounds; needs bounds of one sign.
    Printed,
    /// Without the term `K D`: `theta = (D + lambda E)/eta`.
    Reduced,
    /// Moving from the last estimate; unbiased.
    #[default]
    Damped,
}

/// How the algebraic loop through the estimated model's rate is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Evaluation {
    /// The estimate on the right hand side, in the gain and in the estimated rate, is that of the last sample: what a block
    /// diagram does with a unit delay in the loop. Nothing is limited. When the estimate or the estimated state stops
    /// being a number the law stops for good, with [`Phase::Diverged`](phugoid_estimators::Phase::Diverged) and NaN for the parameter.
    Delayed,
    /// Solved at every sample by a bounded Newton iteration from the last estimate.
    #[default]
    Implicit,
}

/// The sign of the right hand side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LawSign {
    /// Plus, as printed. Right where `z < 0`: always for the linear first-order plant (`z = -x^2`) and for the damping of
    /// the second-order ones (`-x'^2`); only while `sin(y) > 0`, `x x' > 0` or `x' > 0` for the others.
    AsPrinted,
    /// `-sgn(z)`, from `s sdot < 0`.
    #[default]
    FromSlope,
}

/// Settings of the one-parameter law over a surface of `S` channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThesisSettings<const N: usize, const P: usize, const S: usize> {
    /// The unknown parameter's index in the model.
    pub parameter: usize,
    /// All parameters of the model; the unknown one's entry is its start value.
    pub parameters: [f64; P],
    /// Lower bound of the unknown parameter.
    pub lower: f64,
    /// Upper bound of the unknown parameter, in its unit.
    pub upper: f64,
    /// The channels whose energies make up the surface.
    pub channels: [SurfaceChannel; S],
    /// `lambda`, the rate at which the energy difference decays on the surface, 1/s.
    pub lambda: f64,
    /// Largest `lambda h` that is used: beyond 1 the law overshoots, beyond 2 it diverges. May be infinite.
    pub maximum_lambda_h: f64,
    /// `eta > 0`, in units of `z` (scaled energy rate per unit of the parameter).
    pub eta: f64,
    /// The form of the law that is evaluated.
    pub form: ThesisForm,
    /// How the loop is closed.
    pub evaluation: Evaluation,
    /// How the sign of the law's right hand side is chosen.
    pub sign: LawSign,
    /// How far outside its bounds the implicit solution may lie, as a part of their width. May be infinite.
    pub margin: f64,
    /// Start of states that are not measured.
    pub initial_state: [f64; N],
    /// States outside the surface that follow their measurement instead of the estimated model (reconstructed: keeps
    /// an unstable model from drifting away).
    pub follow: [bool; N],
    /// How the input goes from one sample to the next.
    pub input_hold: InputHold,
    /// Longest step with which the estimated model is integrated, s.
    pub maximum_step_s: f64,
    /// Longest interval that is predicted through, s; after a longer one the model starts again from the measurements.
    pub maximum_gap_s: f64,
}

impl<const N: usize, const P: usize, const S: usize> ThesisSettings<N, P, S> {
    /// Damped form with the parameter between its bounds and everything else at its default.
    pub fn new(parameter: usize, parameters: [f64; P], bounds: [f64; 2], channels: [SurfaceChannel; S]) -> Self {
        Self {
            parameter,
            parameters,
            lower: bounds[0],
            upper: bounds[1],
            channels,
            lambda: 10.0,
            maximum_lambda_h: 0.5,
            eta: 1e-3,
            form: ThesisForm::Damped,
            evaluation: Evaluation::Implicit,
            sign: LawSign::FromSlope,
            margin: 0.25,
            initial_state: [0.0; N],
            follow: [false; N],
            input_hold: InputHold::Zero,
            maximum_step_s: 0.02,
            maximum_gap_s: 2.0,
        }
    }

    /// Exactly as printed: that form and that sign, and no limit that the thesis does not have.
    pub fn as_printed(mut self, evaluation: Evaluation) -> Self {
        self.form = ThesisForm::Printed;
        self.evaluation = evaluation;
        self.sign = LawSign::AsPrinted;
        self.maximum_lambda_h = f64::INFINITY;
        self.margin = f64::INFINITY;
        self
    }
}
