//! A model file that has been read, and questions about it.

use std::collections::BTreeMap;

use phugoid_flight_data::table::ColumnMapping;

use super::aircraft::{AirDensity, AircraftData, Base, RateSpeed, Reference, Source, Thrust};
use super::known::KnownAircraft;
use super::parameter::{Expectation, Parameter, Role};
use super::settings::{EstimatorTuning, InputHold, ProcessNoise};
use super::simulation::SimulationData;
use super::uncertainty::Uncertainty;
use crate::core::axes::Axes;
use crate::core::output::{CHANNELS, Output};
use crate::core::term::{Coefficient, Term};

/// A model file that has been read and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// Path of the file as it was given, or the name of the built-in model.
    pub source: String,
    /// Name of the aircraft, for reports.
    pub name: String,
    /// The motion that is estimated, and with it the states and the possible outputs.
    pub axes: Axes,
    /// Database that the estimated terms are added to, if there is one.
    pub base: Base,
    /// The aircraft of [`Base::Aircraft`]; none with any other base.
    pub known: Option<KnownAircraft>,
    /// The airspeed that makes the angular rates dimensionless: the actual one or the reference speed.
    pub rate_speed: RateSpeed,
    /// Mass, inertia, sizes, thrust and air of the aircraft.
    pub aircraft: AircraftData,
    /// Names of the extra input channels that terms may use.
    pub extra_inputs: Vec<String>,
    /// Headers of the user's file, by canonical channel name.
    pub channels: BTreeMap<String, ColumnMapping>,
    /// Which outputs are measured, by [`Output::index`]; only outputs of the axes are.
    pub outputs: [bool; CHANNELS],
    /// Measurement noise by [`Output::index`], one sigma, SI; none: measured from the record.
    pub noise: [Option<f64>; CHANNELS],
    /// Whether the causal filters learn the level of each output's residuals, and the size of an adaptive process noise,
    /// in flight; what the file gives is where they start.
    pub noise_learning: bool,
    /// Parameters: terms in the order of the file, then offsets, then biases. Fixed ones included.
    pub parameters: Vec<Parameter>,
    /// Where the terms count from: the values of alpha and of the surfaces at which they are zero.
    pub reference: Reference,
    /// Uncertainties of constants and scales, which go into the bounds.
    pub uncertainty: Uncertainty,
    /// Process noise of the states, for gusts and model error.
    pub process_noise: ProcessNoise,
    /// Settings of the estimator beside the automatic rule.
    pub estimator: EstimatorTuning,
    /// What a simulation of the aircraft needs beside what an estimation needs.
    pub simulation: SimulationData,
    /// How the input runs between samples.
    pub input: InputHold,
    /// True if a change of the parameters in flight is looked for.
    pub change_detection: bool,
    /// What the reader of the file should know: former spellings that were read as today's. Sentences without a full
    /// stop.
    pub notes: Vec<String>,
    /// The table `[expected]`, if there is one.
    pub expected: Option<Vec<Expectation>>,
}

impl ModelFile {
    /// The terms of a coefficient, estimated or known, in the order of the file; offsets are none.
    pub fn terms(&self, coefficient: Coefficient) -> impl Iterator<Item = &Term> {
        self.parameters.iter().filter_map(move |p| match &p.role {
            Role::Term(of, term) if *of == coefficient => Some(term),
            _ => None,
        })
    }

    /// Canonical names of the channels that the estimation reads.
    pub fn channels_used(&self) -> Vec<&str> {
        let mut used: Vec<&str> = self.axes.known_channels().to_vec();
        used.extend(self.measured().map(|o| -> &str { o.name() }));
        used.extend(self.extra_inputs.iter().map(String::as_str));
        let aircraft = &self.aircraft;
        let mut sources = vec![&aircraft.mass, &aircraft.iyy];
        sources.extend([&aircraft.ixx, &aircraft.izz, &aircraft.ixz].into_iter().flatten());
        match &aircraft.air_density {
            AirDensity::Known(source) => sources.push(source),
            AirDensity::StandardAtmosphere | AirDensity::BookAtmosphere => used.push("altitude"),
        }
        if let Thrust::Known(source) = &aircraft.thrust {
            sources.push(source);
        }
        used.extend(sources.into_iter().filter_map(|source| match source {
            Source::Channel(name) => Some(name.as_str()),
            Source::Constant(_) => None,
        }));
        used
    }

    /// The columns of a record that the file maps to channels by hand.
    pub fn columns(&self) -> Vec<ColumnMapping> {
        self.channels.values().cloned().collect()
    }

    /// Outputs that are measured, in the order of the motion's output vector.
    pub fn measured(&self) -> impl Iterator<Item = Output> {
        self.axes.outputs().iter().copied().filter(|o| self.outputs[o.index()])
    }

    /// The parameters that are not fixed, in the order of the file: one column of the estimator for each.
    pub fn estimated(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|p| !p.fixed)
    }
}
