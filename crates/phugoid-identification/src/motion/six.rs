//! The whole motion, as the estimation takes it, and what the lateral-directional one has in common with it.

use phugoid_estimators::{ConstantEffects, RegressorShift};
use phugoid_flight_dynamics::aircraft::Aircraft as _;

use super::{Known, Motion, ReferencePoint, terms};
use crate::core::axes::Axes;
use crate::core::output::Output;
use crate::core::systematic::UncertainQuantity;
use crate::model_file::{ModelFile, RateSpeed};
use crate::models::longitudinal::Database;
use crate::models::rigid::{AircraftConstants, MassInput, Surfaces};
use crate::models::six::constants::{BIAS_OF_ALPHA, BIAS_OF_BETA, CONSTANTS};
use crate::models::six::{SIX_OUTPUTS, SIX_STATES, SixInput, SixModel};
use crate::models::surface_motion::SurfaceMotion;

impl Motion<SIX_STATES, SIX_OUTPUTS> for SixModel {
    type KnownInput = SixInput;

    const AXES: Axes = Axes::All;

    fn build(file: &ModelFile, database: Database, reference: &ReferencePoint) -> Self {
        let (columns, known) = terms(file);
        Self::new(AircraftConstants::of(file, &database, reference), database, columns, known)
    }

    fn known_input(known: &Known) -> SixInput {
        SixInput { surfaces: known.into(), air_density: known.air_density, thrust: known.thrust, mass: known.into() }
    }

    fn known_channel(_: &SixInput, _: Output) -> Option<f64> {
        None
    }

    const CONSTANTS: &'static [UncertainQuantity] = &CONSTANTS;

    fn bias_constant(output: Output) -> Option<usize> {
        match output {
            Output::Alpha => Some(BIAS_OF_ALPHA),
            Output::Beta => Some(BIAS_OF_BETA),
            _ => None,
        }
    }

    fn deflections(input: &SixInput) -> [f64; 3] {
        input.surfaces.deflections()
    }

    fn effects<const P: usize, const K: usize>(
        &self,
        x: &[f64; SIX_STATES],
        theta: &[f64; P],
        u: &SixInput,
        surfaces: &SurfaceMotion,
        out: &mut ConstantEffects<SIX_STATES, SIX_OUTPUTS, K>,
    ) {
        self.effects_of_constants(x, theta, u, surfaces, out);
    }

    fn regressor_powers<const K: usize>(&self, x: &[f64; SIX_STATES], column: usize) -> [f64; K] {
        self.powers_of_constants(x, column)
    }

    fn regressor_shifts(&self, column: usize) -> &[RegressorShift] {
        self.shifts_of_constants(column)
    }
}

impl AircraftConstants {
    /// Those of a model file about a reference point. The rotor's momentum is the database's if the file gives none.
    /// The span of a file of lateral axes is there: it is refused without.
    pub(crate) fn of(file: &ModelFile, database: &Database, reference: &ReferencePoint) -> Self {
        let aircraft = &file.aircraft;
        let reference_speed = aircraft.reference_speed.unwrap_or(1.0);
        Self {
            wing_area: aircraft.wing_area,
            mean_chord: aircraft.mean_chord,
            span: aircraft.wing_span.unwrap_or(f64::NAN),
            gravity: aircraft.gravity,
            thrust_inclination: aircraft.thrust_inclination,
            thrust_arm: aircraft.thrust_arm,
            rotor_momentum: match database {
                Database::F16(known) if aircraft.rotor_momentum == 0.0 => known.mass_properties.rotor_momentum(),
                Database::Aircraft(known) if aircraft.rotor_momentum == 0.0 => known.mass_properties().rotor_momentum(),
                _ => aircraft.rotor_momentum,
            },
            reference_speed,
            rate_speed: (file.rate_speed == RateSpeed::Reference).then_some(reference_speed),
            alpha_reference: reference.alpha,
            elevator_reference: reference.elevator,
            aileron_reference: reference.aileron,
            rudder_reference: reference.rudder,
        }
    }
}

impl From<&Known> for Surfaces {
    fn from(known: &Known) -> Self {
        let &Known { elevator, aileron, rudder, extra, controls_held, .. } = known;
        Self { elevator, aileron, rudder, extra, held: controls_held }
    }
}

impl From<&Known> for MassInput {
    fn from(known: &Known) -> Self {
        let &Known { mass, ixx, iyy, izz, ixz, .. } = known;
        Self { mass, ixx, iyy, izz, ixz }
    }
}
