//! A model whose parameters of a group of axes are estimated only after something has moved on these axes.
//!
//! What `excitation.rs` says of steady flight holds of each axis by itself: while only the elevator moves, sideslip and
//! roll wander by their noise alone, and an estimator of all six coefficients takes that for excitation of the lateral
//! ones. So the sensitivity to increments of an axis is zero until its first visible motion: their estimates and bounds
//! stay those given beforehand.

use phugoid_estimators::{ConstantEffects, Input, LinearizedOutputs, LinearizedRates, Model, RegressorShift};

use crate::core::axes::{Axes, Group};
use crate::core::options::CAPACITY;
use crate::core::output::Output;
use crate::core::systematic::{ROOM_FOR_CONSTANTS, UncertainQuantity};
use crate::model_file::{Base, ModelFile};
use crate::models::longitudinal::Database;
use crate::models::surface_motion::SurfaceMotion;
use crate::motion::{Known, Motion, MotionModel, ReferencePoint, of_constant, terms};
use crate::preparation::excitation::Moved;

/// A known input, and the groups of axes whose parameters are estimated at this sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GatedInput<I> {
    pub(super) input: I,
    pub(super) open: Moved,
    /// How the surfaces have moved since the sample before.
    pub(super) surfaces: SurfaceMotion,
}

impl<I: Input> Input for GatedInput<I> {
    #[inline]
    fn interpolate(&self, other: &Self, s: f64) -> Self {
        // Since the sample before: of the interval it is that of its end.
        Self { input: self.input.interpolate(&other.input, s), open: self.open, surfaces: other.surfaces }
    }
}

/// A model whose sensitivity to the parameters of a closed group is zero.
#[derive(Clone, Debug)]
pub(crate) struct Gated<M> {
    model: M,
    /// The group of axes that the parameter of each column belongs to.
    groups: Vec<Group>,
    /// Whether errors of constants are followed: the model file declares some.
    considers: bool,
    displaced: Option<Box<DisplacedConstant>>,
}

/// A constant of the motion that is off, as a recursive regression is run with it to see what it does.
#[derive(Clone, Debug)]
pub(crate) struct DisplacedConstant {
    /// Its column of [`Motion::effects`].
    pub(super) constant: usize,
    /// By how much, in the unit of its quantity.
    pub(super) size: f64,
    /// The parameters with which it acts on rates and outputs.
    pub(super) theta: [f64; CAPACITY],
}

impl<M> Gated<M> {
    pub(super) fn new(model: M, file: &ModelFile) -> Self {
        let groups = terms(file).0.iter().map(|(coefficient, _)| coefficient.group()).collect();
        Self { model, groups, considers: file.uncertainty.follows(), displaced: None }
    }

    /// With a constant that is off: rates, and the outputs that measure no state, are those of the model and what the constant adds to
    /// them.
    pub(super) fn displaced(self, displaced: &DisplacedConstant) -> Self {
        Self { displaced: Some(Box::new(displaced.clone())), ..self }
    }

    /// Columns of the groups on which nothing has moved. A motion of one group alone does not reach this: it waits as a
    /// whole.
    pub(super) fn closed(&self, moved: Moved) -> impl Iterator<Item = usize> + '_ {
        let closed = move |(j, group): (usize, &Group)| (!moved.has(*group)).then_some(j);
        self.groups.iter().enumerate().filter_map(closed)
    }

    #[inline]
    fn close<const P: usize>(&self, open: Moved, rows: &mut [[f64; P]]) {
        if open == Moved::ALL {
            return;
        }
        for j in self.closed(open).take_while(|j| *j < P) {
            for row in rows.iter_mut() {
                row[j] = 0.0;
            }
        }
    }
}

/// What a displaced constant adds to rates and outputs.
#[cold]
#[inline(never)]
fn added<M: Motion<N, R>, const N: usize, const R: usize>(
    model: &M,
    displaced: &DisplacedConstant,
    x: &[f64; N],
    u: &GatedInput<M::KnownInput>,
) -> ([f64; N], [f64; R]) {
    let mut effects = ConstantEffects::<N, R, ROOM_FOR_CONSTANTS>::ZERO;
    model.effects(x, &displaced.theta, &u.input, &u.surfaces, &mut effects);
    of_constant(&effects, displaced.constant, displaced.size)
}

/// Which groups are open: in absolute form all, since steady flight determines sums of parameters; increments where
/// something has moved, and with one group alone all, since the estimation then starts anew with the first motion.
pub(super) fn open(axes: Axes, base: Base, moved: Moved) -> Moved {
    if axes == Axes::All && base != Base::None { moved } else { Moved::ALL }
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Motion<N, R> for Gated<M> {
    type KnownInput = GatedInput<M::KnownInput>;

    const AXES: Axes = M::AXES;

    const CONSTANTS: &'static [UncertainQuantity] = M::CONSTANTS;

    fn build(file: &ModelFile, database: Database, reference: &ReferencePoint) -> Self {
        Self::new(M::build(file, database, reference), file)
    }

    fn known_input(known: &Known) -> Self::KnownInput {
        GatedInput { input: M::known_input(known), open: Moved::ALL, surfaces: SurfaceMotion::default() }
    }

    fn known_channel(input: &Self::KnownInput, channel: Output) -> Option<f64> {
        M::known_channel(&input.input, channel)
    }
}

impl<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> Model<N, R, P> for Gated<M> {
    type Input = GatedInput<M::KnownInput>;

    fn parameter_count(&self) -> usize {
        self.model.parameter_count()
    }

    fn rates(&self, x: &[f64; N], theta: &[f64; P], u: &Self::Input) -> [f64; N] {
        let mut rates = self.model.rates(x, theta, &u.input);
        if let Some(displaced) = &self.displaced {
            let (more, _) = added(&self.model, displaced, x, u);
            rates.iter_mut().zip(more).for_each(|(rate, more)| *rate += more);
        }
        rates
    }

    #[inline]
    fn linearized_rates(&self, x: &[f64; N], theta: &[f64; P], u: &Self::Input, out: &mut LinearizedRates<N, P>) {
        self.model.linearized_rates(x, theta, &u.input, out);
        self.close(u.open, &mut out.regressors);
        if let Some(displaced) = &self.displaced {
            let (more, _) = added(&self.model, displaced, x, u);
            out.rates.iter_mut().zip(more).for_each(|(rate, more)| *rate += more);
        }
    }

    #[inline]
    fn linearized_outputs(
        &self,
        x: &[f64; N],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedOutputs<N, R, P>,
    ) {
        self.model.linearized_outputs(x, theta, &u.input, out);
        self.close(u.open, &mut out.parameter_jacobian);
        if let Some(displaced) = &self.displaced {
            let (_, mut more) = added(&self.model, displaced, x, u);
            // Of the states the record is without the constant.
            (0..N).filter_map(|state| self.model.measuring_output(state)).for_each(|output| more[output] = 0.0);
            out.outputs.iter_mut().zip(more).for_each(|(output, more)| *output += more);
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        self.model.measuring_output(state)
    }

    fn constant_count(&self) -> usize {
        if self.considers { M::CONSTANTS.len() } else { 0 }
    }

    fn learnable_constants(&self) -> &[usize] {
        if self.considers { M::LEARNABLE } else { &[] }
    }

    fn constant_effects<const K: usize>(
        &self,
        x: &[f64; N],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut ConstantEffects<N, R, K>,
    ) {
        self.model.effects(x, theta, &u.input, &u.surfaces, out);
    }

    fn regressor_powers<const K: usize>(&self, x: &[f64; N], column: usize) -> [f64; K] {
        Motion::regressor_powers(&self.model, x, column)
    }

    fn regressor_shifts(&self, column: usize) -> &[RegressorShift] {
        Motion::regressor_shifts(&self.model, column)
    }
}
