//! Properties that an evaluator writes as it computes: what functions and channels of the next step read.

use super::mass::Masses;
use super::model::{Model, State};
use super::units::{FOOT, SLUG, SLUG_WEIGHT};

/// Indices of the properties.
#[derive(Debug, Clone)]
pub(super) struct Fed {
    weight: usize,
    mass: usize,
    /// Moments and products of inertia, where the files name one of them.
    inertia: Option<[usize; 6]>,
    centre: [usize; 3],
    aerodynamic_force: [usize; 3],
    aerodynamic_moment: [usize; 3],
    propulsive_force: [usize; 3],
    propulsive_moment: [usize; 3],
    /// Thrust of each engine, and the speed of its propeller.
    engines: Vec<[usize; 2]>,
    step: usize,
    time: usize,
    /// Written by the aerodynamics.
    others: [usize; 4],
}

impl Fed {
    /// Makes the properties.
    pub(super) fn new(model: &mut Model, engines: usize) -> Self {
        const INERTIA: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
        let inertia = INERTIA.map(|element| format!("inertia/{element}-slugs_ft2"));
        let inertia = inertia
            .iter()
            .any(|name| model.find(name).is_some())
            .then(|| inertia.each_ref().map(|name| model.property(name)));
        let mut three =
            |start: &str, axes: [&str; 3], end: &str| axes.map(|axis| model.property(&format!("{start}{axis}{end}")));
        let centre = three("inertia/cg-", ["x", "y", "z"], "-in");
        let aerodynamic_force = three("forces/fb", ["x", "y", "z"], "-aero-lbs");
        let propulsive_force = three("forces/fb", ["x", "y", "z"], "-prop-lbs");
        let aerodynamic_moment = three("moments/", ["l", "m", "n"], "-aero-lbsft");
        let propulsive_moment = three("moments/", ["l", "m", "n"], "-prop-lbsft");
        let engine =
            |number: usize| ["thrust-lbs", "propeller-rpm"].map(|what| format!("propulsion/engine[{number}]/{what}"));
        Self {
            centre,
            aerodynamic_force,
            aerodynamic_moment,
            propulsive_force,
            propulsive_moment,
            inertia,
            weight: model.property("inertia/weight-lbs"),
            mass: model.property("inertia/mass-slugs"),
            engines: (0..engines).map(|number| engine(number).map(|name| model.property(&name))).collect(),
            step: model.property("simulation/dt"),
            time: model.property("simulation/sim-time-sec"),
            others: ["aero/cl-squared", "forces/lod-norm", "aero/stall-hyst-norm", "systems/stall-warn-norm"]
                .map(|name| model.property(name)),
        }
    }

    /// Whether a property is among them.
    pub(super) fn contain(&self, index: usize) -> bool {
        let three = [self.aerodynamic_force, self.aerodynamic_moment, self.propulsive_force, self.propulsive_moment];
        self.is_steady(index)
            || [self.step, self.time].contains(&index)
            || three.iter().any(|axes| axes.contains(&index))
            || self.engines.iter().any(|engine| engine.contains(&index))
    }

    /// Whether a property is among them and has its value before a step: mass and inertia, and what the aerodynamics write for
    /// themselves.
    pub(super) fn is_steady(&self, index: usize) -> bool {
        [self.weight, self.mass].contains(&index)
            || self.centre.contains(&index)
            || self.inertia.is_some_and(|inertia| inertia.contains(&index))
            || self.others.contains(&index)
    }

    /// Weight, pounds, and its centre, inches in the structural frame, and the inertia where the files read it.
    pub(super) fn weight(&self, model: &Model, state: &mut State, masses: &Masses) -> (f64, [f64; 3]) {
        let (weight, centre) = masses.weight_and_centre(model, state);
        if let Some(properties) = self.inertia {
            let inertia = masses.properties(model, state).inertia_kg_m2;
            // JSBSim calls the element of the tensor `ixz`, and the products themselves `ixy` and `iyz`.
            let places = [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (0, 1, -1.0), (0, 2, 1.0), (1, 2, -1.0)];
            for (property, (row, column, sign)) in properties.into_iter().zip(places) {
                state.write(model, property, sign * inertia[row][column] / (SLUG * FOOT * FOOT));
            }
        }
        state.write(model, self.weight, weight);
        state.write(model, self.mass, weight / SLUG_WEIGHT);
        write_three(model, state, self.centre, centre);
        (weight, centre)
    }

    /// Aerodynamic force, pounds, and moment, foot pounds, in body axes.
    pub(super) fn aerodynamics(&self, model: &Model, state: &mut State, force: [f64; 3], moment: [f64; 3]) {
        write_three(model, state, self.aerodynamic_force, force);
        write_three(model, state, self.aerodynamic_moment, moment);
    }

    /// Force, pounds, and moment, foot pounds, of all engines in body axes.
    pub(super) fn propulsion(&self, model: &Model, state: &mut State, force: [f64; 3], moment: [f64; 3]) {
        write_three(model, state, self.propulsive_force, force);
        write_three(model, state, self.propulsive_moment, moment);
    }

    /// Thrust of one engine, pounds, and the speed of its propeller, turns per minute.
    pub(super) fn engine(&self, model: &Model, state: &mut State, number: usize, thrust: f64, rpm: f64) {
        if let Some(&[thrust_property, rpm_property]) = self.engines.get(number) {
            state.write(model, thrust_property, thrust);
            state.write(model, rpm_property, rpm);
        }
    }

    /// Length of a step, s, before it.
    pub(super) fn begin_step(&self, model: &Model, state: &mut State, step_s: f64) {
        state.write(model, self.step, step_s);
    }

    /// The time, s, after a step.
    pub(super) fn end_step(&self, model: &Model, state: &mut State, step_s: f64) {
        let time = state.read(model, self.time);
        state.write(model, self.time, time + step_s);
    }
}

fn write_three(model: &Model, state: &mut State, properties: [usize; 3], values: [f64; 3]) {
    for (property, value) in properties.into_iter().zip(values) {
        state.write(model, property, value);
    }
}
