//! The lateral-directional motion, as the estimation takes it.

use phugoid_estimators::{ConstantEffects, RegressorShift};

use super::{Known, Motion, ReferencePoint, terms};
use crate::core::axes::Axes;
use crate::core::output::Output;
use crate::core::systematic::UncertainQuantity;
use crate::model_file::ModelFile;
use crate::models::lateral::constants::{BIAS_OF_BETA, CONSTANTS, LEARNABLE, LEARNABLE_OF};
use crate::models::lateral::{LATERAL_OUTPUTS, LATERAL_STATES, LateralInput, LateralModel};
use crate::models::longitudinal::Database;
use crate::models::rigid::AircraftConstants;
use crate::models::surface_motion::SurfaceMotion;

impl Motion<LATERAL_STATES, LATERAL_OUTPUTS> for LateralModel {
    type KnownInput = LateralInput;

    const AXES: Axes = Axes::LateralDirectional;

    fn build(file: &ModelFile, database: Database, reference: &ReferencePoint) -> Self {
        let (columns, known) = terms(file);
        Self::new(AircraftConstants::of(file, &database, reference), database, columns, known)
    }

    fn known_input(known: &Known) -> LateralInput {
        LateralInput {
            surfaces: known.into(),
            air_density: known.air_density,
            mass: known.into(),
            speed: known.true_airspeed,
            alpha: known.alpha,
            theta: known.theta,
            q: known.q,
            ax: known.ax,
            az: known.az,
        }
    }

    fn known_channel(input: &LateralInput, channel: Output) -> Option<f64> {
        match channel {
            Output::TrueAirspeed => Some(input.speed),
            Output::Alpha => Some(input.alpha),
            Output::Theta => Some(input.theta),
            Output::PitchRate => Some(input.q),
            Output::Ax => Some(input.ax),
            Output::Az => Some(input.az),
            _ => None,
        }
    }

    const CONSTANTS: &'static [UncertainQuantity] = &CONSTANTS;

    const LEARNABLE: &'static [usize] = &LEARNABLE;

    const LEARNABLE_OF: &'static [&'static str] = &LEARNABLE_OF;

    fn bias_constant(output: Output) -> Option<usize> {
        (output == Output::Beta).then_some(BIAS_OF_BETA)
    }

    fn deflections(input: &LateralInput) -> [f64; 3] {
        input.surfaces.deflections()
    }

    fn effects<const P: usize, const K: usize>(
        &self,
        x: &[f64; LATERAL_STATES],
        theta: &[f64; P],
        u: &LateralInput,
        surfaces: &SurfaceMotion,
        out: &mut ConstantEffects<LATERAL_STATES, LATERAL_OUTPUTS, K>,
    ) {
        self.effects_of_constants(x, theta, u, surfaces, out);
    }
    fn regressor_powers<const K: usize>(&self, _: &[f64; LATERAL_STATES], column: usize) -> [f64; K] {
        self.powers_of_constants(column)
    }

    fn regressor_shifts(&self, column: usize) -> &[RegressorShift] {
        self.shifts_of_constants(column)
    }
}
