//! The longitudinal motion, as the estimation takes it.

use phugoid_estimators::{ConstantEffects, RegressorShift};
use phugoid_flight_dynamics::atmosphere::Atmosphere;

use super::{Known, Motion, ReferencePoint, terms};
use crate::core::axes::Axes;
use crate::core::output::Output;
use crate::core::systematic::UncertainQuantity;
use crate::core::term::{Coefficient, Term, Variable};
use crate::model_file::{AirDensity, ModelFile, RateSpeed, Source};
use crate::models::longitudinal::constants::{BIAS_OF_ALPHA, CONSTANTS, LEARNABLE, LEARNABLE_OF};
use crate::models::longitudinal::{
    Database, LongitudinalConstants, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES,
};
use crate::models::surface_motion::SurfaceMotion;

impl Motion<STATES, OUTPUTS> for LongitudinalModel {
    type KnownInput = LongitudinalInput;

    const AXES: Axes = Axes::Longitudinal;

    fn build(file: &ModelFile, database: Database, reference: &ReferencePoint) -> Self {
        let aircraft = &file.aircraft;
        let reference_speed = aircraft.reference_speed.unwrap_or(1.0);
        let constants = LongitudinalConstants {
            wing_area: aircraft.wing_area,
            mean_chord: aircraft.mean_chord,
            gravity: aircraft.gravity,
            thrust_inclination: aircraft.thrust_inclination,
            thrust_arm: aircraft.thrust_arm,
            reference_speed,
            rate_speed: (file.rate_speed == RateSpeed::Reference).then_some(reference_speed),
            alpha_reference: reference.alpha,
            elevator_reference: reference.elevator,
        };
        let (columns, mut known) = terms(file);
        known.extend(alpha_rate_terms(file, &database, reference));
        Self::new(constants, database, columns, known)
    }

    fn known_input(known: &Known) -> LongitudinalInput {
        LongitudinalInput {
            elevator: known.elevator,
            air_density: known.air_density,
            thrust: known.thrust,
            mass: known.mass,
            iyy: known.iyy,
            extra: known.extra,
            controls_held: known.controls_held,
        }
    }

    fn known_channel(_: &LongitudinalInput, _: Output) -> Option<f64> {
        None
    }

    const CONSTANTS: &'static [UncertainQuantity] = &CONSTANTS;

    const LEARNABLE: &'static [usize] = &LEARNABLE;

    const LEARNABLE_OF: &'static [&'static str] = &LEARNABLE_OF;

    fn bias_constant(output: Output) -> Option<usize> {
        (output == Output::Alpha).then_some(BIAS_OF_ALPHA)
    }

    fn deflections(input: &LongitudinalInput) -> [f64; 3] {
        [input.elevator, 0.0, 0.0]
    }

    fn effects<const P: usize, const K: usize>(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
        surfaces: &SurfaceMotion,
        out: &mut ConstantEffects<STATES, OUTPUTS, K>,
    ) {
        self.effects_of_constants(x, theta, u, surfaces, out);
    }
    fn regressor_powers<const K: usize>(&self, x: &[f64; STATES], column: usize) -> [f64; K] {
        self.powers_of_constants(x, column)
    }

    fn regressor_shifts(&self, column: usize) -> &[RegressorShift] {
        self.shifts_of_constants(column)
    }
}

/// What a database has by the rate of the angle of attack, as known terms: its slopes at the reference point.
fn alpha_rate_terms(
    file: &ModelFile,
    database: &Database,
    reference: &ReferencePoint,
) -> Vec<(Coefficient, Term, f64)> {
    let aircraft = &file.aircraft;
    // Slopes with this rate hardly follow the density, which matters for the Mach number alone.
    let density = match (&aircraft.air_density, file.reference.altitude) {
        (AirDensity::Known(Source::Constant(density)), _) => *density,
        (_, altitude) => Atmosphere::Standard.at(altitude.unwrap_or(0.0)).density,
    };
    let speed = aircraft.reference_speed.unwrap_or(100.0);
    let slopes = database.by_alpha_rate(speed, density, reference.alpha, reference.elevator);
    let Ok(term) = Term::parse(Variable::AlphaRate.name(), &[]) else { return Vec::new() };
    let coefficients = [Coefficient::Lift, Coefficient::Drag, Coefficient::PitchingMoment];
    slopes.map_or(Vec::new(), |slopes| {
        coefficients.into_iter().zip(slopes).map(|(coefficient, slope)| (coefficient, term.clone(), slope)).collect()
    })
}
