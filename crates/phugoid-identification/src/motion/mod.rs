//! The interface between a motion model and the estimation: how it is built from a model file, and how its inputs are
//! made from the channels of a record.

mod lateral;
mod longitudinal;
mod six;

use std::fmt::Debug;

use phugoid_estimators::{ConstantEffects, Input, Model, RegressorShift};

use crate::core::axes::Axes;
use crate::core::output::Output;
use crate::core::systematic::UncertainQuantity;
use crate::core::term::{Coefficient, EXTRA_INPUTS, Term};
use crate::model_file::{InputHold, ModelFile, Role};
use crate::models::longitudinal::Database;
pub use crate::models::surface_motion::SurfaceMotion;

/// A motion of the aircraft that parameters can be estimated from: `N` states, `R` outputs, those of its axes.
///
/// Everything from the record to the verdict is written once against this and
/// [`Model`]; a new motion is an implementation of both, and an arm in `estimate.rs`.
pub trait Motion<const N: usize, const R: usize>: Clone + Debug + Send + 'static {
    /// The known input of the model at one sample.
    type KnownInput: Input + Debug + Send;

    /// The axes of the motion; their states and outputs are those of the model, in the same order.
    const AXES: Axes;

    /// The model of a file about a reference point: estimated terms become columns, fixed ones known terms ([`terms`]).
    fn build(file: &ModelFile, database: Database, reference: &ReferencePoint) -> Self;

    /// The model's input at one sample.
    fn known_input(known: &Known) -> Self::KnownInput;

    /// A channel of the motion, SI, that the input holds instead of the outputs ([`Axes::known_channels`]); none if it
    /// does not. The kinematic equations need the airspeed also where it is not a state. There is no usual answer: a motion
    /// that forgets its channels would be integrated at an airspeed of zero.
    fn known_channel(input: &Self::KnownInput, channel: Output) -> Option<f64>;

    /// The constants whose errors can be followed through an estimation, by column of [`Motion::effects`]; a quantity may
    /// have several columns, whose errors have nothing to do with each other. None for a motion without.
    const CONSTANTS: &'static [UncertainQuantity] = &[];

    /// The constants that leave a trace in residuals ([`Model::learnable_constants`]), by column of [`Motion::effects`].
    const LEARNABLE: &'static [usize] = &[];

    /// What each of them is about, in words: the surface, the sensor.
    const LEARNABLE_OF: &'static [&'static str] = &[];

    /// The constant that is the bias of an output, by column of [`Motion::effects`]; none if there is no such constant.
    fn bias_constant(_output: Output) -> Option<usize> {
        None
    }

    /// Elevator, aileron and rudder of an input, rad; zero for one that the motion does not have.
    fn deflections(_input: &Self::KnownInput) -> [f64; 3] {
        [0.0; 3]
    }

    /// What one unit of each constant adds to rates and outputs ([`Model::constant_effects`]), written to `out`, which
    /// holds zeros and has room for all of them. `surfaces`: how the deflections have moved.
    fn effects<const P: usize, const K: usize>(
        &self,
        _x: &[f64; N],
        _theta: &[f64; P],
        _u: &Self::KnownInput,
        _surfaces: &SurfaceMotion,
        _out: &mut ConstantEffects<N, R, K>,
    ) {
    }

    /// By which part the regressor of a column is larger than the true one, per unit of each constant
    /// ([`Model::regressor_powers`]).
    fn regressor_powers<const K: usize>(&self, _x: &[f64; N], _column: usize) -> [f64; K] {
        [0.0; K]
    }

    /// What the constants add to the regressor of a column of those of other columns ([`Model::regressor_shifts`]).
    fn regressor_shifts(&self, _column: usize) -> &[RegressorShift] {
        &[]
    }
}

/// A motion that is a [`Model`] with room for `P` parameters.
pub trait MotionModel<const N: usize, const R: usize, const P: usize>:
    Motion<N, R> + Model<N, R, P, Input = <Self as Motion<N, R>>::KnownInput>
{
}

impl<M, const N: usize, const R: usize, const P: usize> MotionModel<N, R, P> for M where
    M: Motion<N, R> + Model<N, R, P, Input = <M as Motion<N, R>>::KnownInput>
{
}

/// Standard uncertainty of each of [`Motion::CONSTANTS`], in the unit of its quantity: what the model file declares. Zero for the
/// bias of an output that the file has estimated (`[biases]`): its uncertainty is in the bounds as that of a parameter.
pub(crate) fn declared<M: Motion<N, R>, const N: usize, const R: usize>(file: &ModelFile) -> Vec<f64> {
    let mut declared: Vec<f64> = M::CONSTANTS.iter().map(|quantity| file.uncertainty.of_quantity(*quantity)).collect();
    for parameter in file.estimated() {
        if let Role::Bias(output) = parameter.role
            && let Some(place) = M::bias_constant(output)
        {
            declared[place] = 0.0;
        }
    }
    declared
}

/// What a constant that is off by a size adds to rates and outputs; nothing for a constant that there is not.
pub(crate) fn of_constant<const N: usize, const R: usize, const K: usize>(
    effects: &ConstantEffects<N, R, K>,
    constant: usize,
    size: f64,
) -> ([f64; N], [f64; R]) {
    let of = |row: &[f64; K]| size * row.get(constant).copied().unwrap_or(0.0);
    (effects.rates.each_ref().map(of), effects.outputs.each_ref().map(of))
}

/// The reference point: the angle of attack and the deflections at which the terms of the build-up are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferencePoint {
    /// Angle of attack at which `alpha` counts as zero, rad.
    pub alpha: f64,
    /// Elevator deflection at which `elevator` counts as zero, rad.
    pub elevator: f64,
    /// Aileron deflection at which `aileron` counts as zero, rad.
    pub aileron: f64,
    /// Rudder deflection at which `rudder` counts as zero, rad.
    pub rudder: f64,
}

/// What is known of the flight at one sample, SI. What the axes do not take ([`Axes::known_channels`]) is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Known {
    /// Elevator, rad, positive trailing edge down.
    pub elevator: f64,
    /// Aileron, rad, positive right aileron trailing edge down.
    pub aileron: f64,
    /// Rudder, rad, positive trailing edge left.
    pub rudder: f64,
    /// Measured true airspeed, m/s.
    pub true_airspeed: f64,
    /// Measured angle of attack, rad.
    pub alpha: f64,
    /// Measured pitch angle, rad, positive nose up.
    pub theta: f64,
    /// Measured pitch rate about body y, rad/s, positive nose up.
    pub q: f64,
    /// Measured specific force along body x, m/s^2.
    pub ax: f64,
    /// Measured specific force along body z, m/s^2.
    pub az: f64,
    /// Density of the air, kg/m^3.
    pub air_density: f64,
    /// Thrust along the thrust line, N.
    pub thrust: f64,
    /// Mass of the aircraft, kg.
    pub mass: f64,
    /// Moment of inertia about body x, kg m^2.
    pub ixx: f64,
    /// Moment of inertia about body y, kg m^2.
    pub iyy: f64,
    /// Moment of inertia about body z, kg m^2.
    pub izz: f64,
    /// Product of inertia, integral of x z dm, kg m^2.
    pub ixz: f64,
    /// The model file's extra inputs, in its order.
    pub extra: [f64; EXTRA_INPUTS],
    /// True if surfaces and extra inputs are held until the next sample; false if they run straight to it.
    pub controls_held: bool,
}

impl Known {
    pub(crate) fn new(hold: InputHold) -> Self {
        Self { controls_held: hold == InputHold::Held, ..Self::default() }
    }

    /// The place of a channel of this name; none if there is none.
    pub(crate) fn slot(&mut self, name: &str) -> Option<&mut f64> {
        Some(match name {
            "elevator" => &mut self.elevator,
            "aileron" => &mut self.aileron,
            "rudder" => &mut self.rudder,
            "true_airspeed" => &mut self.true_airspeed,
            "alpha" => &mut self.alpha,
            "theta" => &mut self.theta,
            "q" => &mut self.q,
            "ax" => &mut self.ax,
            "az" => &mut self.az,
            "air_density" => &mut self.air_density,
            "thrust" => &mut self.thrust,
            "mass" => &mut self.mass,
            "ixx" => &mut self.ixx,
            "iyy" => &mut self.iyy,
            "izz" => &mut self.izz,
            "ixz" => &mut self.ixz,
            _ => return None,
        })
    }
}

/// Estimated terms in the order of the parameter vector.
pub type Columns = Vec<(Coefficient, Term)>;
/// Known terms with their values.
pub type KnownTerms = Vec<(Coefficient, Term, f64)>;

/// The terms of a model file: estimated ones, and fixed ones with their values. Sensor biases are left out: the
/// estimator adds their columns itself.
pub fn terms(file: &ModelFile) -> (Columns, KnownTerms) {
    let (mut columns, mut known) = (Vec::new(), Vec::new());
    for parameter in &file.parameters {
        let (coefficient, term) = match &parameter.role {
            Role::Term(coefficient, term) => (*coefficient, term.clone()),
            Role::Offset(coefficient) => (*coefficient, Term::default()),
            Role::Bias(_) => continue,
        };
        if parameter.fixed {
            known.push((coefficient, term, parameter.start));
        } else {
            columns.push((coefficient, term));
        }
    }
    (columns, known)
}
