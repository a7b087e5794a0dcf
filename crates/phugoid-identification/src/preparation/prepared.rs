//! What a record gives the estimators: the samples, the model's constants, and what was assumed.

use std::borrow::Cow;

use phugoid_flight_data::statistics::median;

use crate::core::axes::Axes;
use crate::core::estimation::Signal;
use crate::core::output::Output;
use crate::model_file::{ByPowers, DatabasePart, InputHold, ModelFile};
use crate::models::surface_motion::{SurfaceMotion, SurfaceMotions};
use crate::motion::{Motion, ReferencePoint};
use crate::preparation::database_part::Condition;
use crate::preparation::intake::Origin;
use crate::preparation::reaction::delay::SurfaceDelay;
use crate::preparation::slow_surface::SlowSurface;
use crate::preparation::surface::{SurfaceNoise, WildValues};

/// Samples that noise levels are measured from, at least.
pub(crate) const FEWEST_SAMPLES: usize = 40;

/// Everything the estimator needs of one record.
#[derive(Clone, Debug)]
pub struct Prepared<M: Motion<N, R>, const N: usize, const R: usize> {
    /// The model, built with the constants of the file and the reference point.
    pub model: M,
    /// Times of the samples used, s.
    pub time: Vec<f64>,
    /// Known input of the model at each sample.
    pub inputs: Vec<M::KnownInput>,
    /// How the surfaces have come to each sample, with the play that is declared of them.
    pub surface_motion: Vec<SurfaceMotion>,
    /// Measured outputs per sample; NaN where missing.
    pub outputs: Vec<[f64; R]>,
    /// The known inputs by name: [`Axes::known_channels`], then air, mass and inertia, then the extra inputs.
    pub known: Vec<Signal>,
    /// Where they come from, in the same order.
    pub(crate) origins: Vec<Origin>,
    /// How the surfaces and further inputs move between two samples: never `Auto`.
    pub hold: InputHold,
    /// The surfaces that were recorded late (positive) or early and were moved, by name, and by how much, s.
    pub moved_s: Vec<(String, f64)>,
    /// When the surfaces were recorded, after those that were late were moved; where the record had to say how they move
    /// between samples, or none.
    pub(crate) surface_times: Option<Vec<SurfaceDelay>>,
    /// Surfaces that are slower than the record.
    pub(crate) slow_surfaces: Vec<SlowSurface>,
    /// One sigma of the time of the surfaces that the record does not tell, s: of surfaces that are slower than it, where it is not
    /// certain how they moved between their own samples. Zero without any.
    pub(crate) surface_time_std_s: f64,
    /// The noise of the surfaces that have some, by name.
    pub(crate) surface_noise: Vec<(String, SurfaceNoise)>,
    /// Values of the surfaces that may be wild, and count as motion.
    pub(crate) wild_values: Vec<WildValues>,
    /// The reference point: the values at which the terms are zero.
    pub reference: ReferencePoint,
    /// What the database has in the place of each estimated parameter, in the order of the columns.
    pub(crate) database_parts: Vec<DatabasePart>,
    /// Index in the record of the first sample used.
    pub first: usize,
    /// Sentences about what was assumed, held or left out.
    pub notes: Vec<String>,
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Prepared<M, N, R> {
    /// Samples at the start of the record that noise levels are measured from: two seconds, at least 40 samples.
    pub fn noise_samples(&self) -> usize {
        let start = self.time.first().copied().unwrap_or(0.0);
        self.time.iter().take_while(|t| **t - start <= 2.0).count().max(FEWEST_SAMPLES).min(self.time.len())
    }

    /// The model file with what this record leaves open of the time of its surfaces among the declared uncertainties. `file` is
    /// the one that the record was prepared for.
    pub(crate) fn with_time_of_surfaces<'a>(&self, file: &'a ModelFile) -> Cow<'a, ModelFile> {
        if self.surface_time_std_s == 0.0 {
            return Cow::Borrowed(file);
        }
        let mut wider = file.clone();
        wider.uncertainty.surface_skew = wider.uncertainty.surface_skew.hypot(self.surface_time_std_s);
        Cow::Owned(wider)
    }

    /// The systematic error of each estimated parameter by the powers of the scales, in the order of the columns. `file` is
    /// the one that the record was prepared for.
    pub(crate) fn by_powers(&self, file: &ModelFile) -> impl Iterator<Item = ByPowers> {
        file.estimated().zip(&self.database_parts).map(|(parameter, database)| file.by_powers(parameter, database))
    }

    /// The true airspeed by sample, m/s: an output of the motion, or known beside it; NaN where it was not measured, and empty of
    /// a motion that has none.
    pub(crate) fn speeds(&self) -> Vec<f64> {
        speeds::<M, N, R>(&self.outputs, self.known_values(Output::TrueAirspeed.name()))
    }

    /// What a database is asked for coefficients in.
    pub(crate) fn condition(&self, file: &ModelFile) -> Condition {
        Condition::of(file, self.speeds(), self.known_values("air_density"))
    }

    fn known_values(&self, name: &str) -> Option<&[f64]> {
        self.known.iter().find(|signal| signal.name == name).map(|signal| signal.values.as_slice())
    }

    /// Where a state (rad, rad/s) that nothing measures starts in flight that is nearly level and straight, and one sigma of that: two
    /// degrees of path angle and sideslip are what a flight that is called level may have. `None` of the airspeed.
    pub(crate) fn level_start(&self, state: Output) -> Option<[f64; 2]> {
        let first = |output: Output| -> Option<f64> {
            let row = M::AXES.row(output)?;
            let values = self.outputs.iter().map(|y| y[row]).filter(|v| v.is_finite());
            median(&mut values.take(5).collect::<Vec<f64>>())
        };
        let degree = std::f64::consts::PI / 180.0;
        match state {
            Output::TrueAirspeed => None,
            Output::Alpha => Some([first(Output::Theta).unwrap_or(0.0), 2.0 * degree]),
            Output::Theta => Some([first(Output::Alpha).unwrap_or(0.0), 2.0 * degree]),
            Output::Beta | Output::Phi => Some([0.0, 2.0 * degree]),
            _ => Some([0.0, degree]),
        }
    }

    /// Whether every surface is slower than the record, with nothing recorded between its own samples.
    pub(crate) fn has_only_slow_surfaces(&self) -> bool {
        let is_slow = |name: &str| self.slow_surfaces.iter().any(|slow| slow.has_gaps && slow.name == name);
        !self.slow_surfaces.is_empty() && self.surfaces().all(|signal| is_slow(&signal.name))
    }

    /// The positions of the control surfaces, rad, by sample.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = &Signal> {
        self.known.iter().filter(|signal| Axes::SURFACES.contains(&signal.name.as_str()))
    }
}

/// How the surfaces have come to each sample.
pub(super) fn surface_motion<M: Motion<N, R>, const N: usize, const R: usize>(
    time: &[f64],
    inputs: &[M::KnownInput],
    file: &ModelFile,
) -> Vec<SurfaceMotion> {
    let mut motions = SurfaceMotions::new(file.uncertainty.surface_play);
    time.iter().zip(inputs).map(|(time, input)| motions.at(*time, M::deflections(input))).collect()
}

/// The true airspeed among the outputs of a motion, or else as it is known.
pub(super) fn speeds<M: Motion<N, R>, const N: usize, const R: usize>(
    outputs: &[[f64; R]],
    known: Option<&[f64]>,
) -> Vec<f64> {
    match M::AXES.row(Output::TrueAirspeed) {
        Some(row) => outputs.iter().map(|y| y[row]).collect(),
        None => known.unwrap_or_default().to_vec(),
    }
}
