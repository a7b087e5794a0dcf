#![doc = include_str!("../README.md")]
//!
//! # How it works
//!
//! A [`Shape`] has a peak of one. [`fit::fitted`] flies it in a scenario and scales each surface until the strictest of the
//! [`fit::Limits`] is met; [`predict::predict`] gives the Cramer-Rao bound of a model's parameters before anyone flies it;
//! [`files`] writes it for `phugoid simulate` and for autopilots.
//!
//! Sources: V. Klein, E. A. Morelli, *Aircraft System Identification*, 2nd ed., 2016, chapter 9; R. V. Jategaonkar, *Flight
//! Vehicle System Identification*, 2nd ed., AIAA 2015, chapter 2; E. A. Morelli, "Multiple Input Design for Real-Time
//! Parameter Estimation in the Frequency Domain", IFAC SYSID 2003, and "Flight Test Maneuvers for Efficient Aerodynamic
//! Modeling", *Journal of Aircraft* 49(6), 2012.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod error;
pub mod files;
pub mod fit;
pub mod modes;
pub mod multisine;
pub mod page;
pub mod predict;
mod pulses;
mod spectrum;
mod sweep;

use serde::Serialize;

pub use error::DesignError;
pub use spectrum::spectrum;

use modes::ModeFrequencies;
use multisine::Harmonic;
use phugoid_simulation::manoeuvre::Surface;

/// The families of inputs that can be designed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Kind {
    /// Up and down, the pulse at the peak of whose spectrum the mode lies.
    #[serde(rename = "doublet")]
    Doublet,
    /// 3-2-1-1, the mode in the middle of its spectrum.
    #[serde(rename = "3-2-1-1")]
    ThreeTwoOneOne,
    /// Frequency sweep with faded ends.
    #[serde(rename = "sweep")]
    Sweep,
    /// Orthogonal phase-optimised multisines, all surfaces at once.
    #[serde(rename = "multisine")]
    Multisine,
}

impl Kind {
    /// All families, in the order in which they are compared.
    pub const ALL: [Self; 4] = [Self::Doublet, Self::ThreeTwoOneOne, Self::Sweep, Self::Multisine];

    /// Name as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Doublet => "doublet",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::Sweep => "sweep",
            Self::Multisine => "multisine",
        }
    }
}

/// What the input is designed for: surfaces, duration, sampling and frequency band.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Surfaces to move, each once.
    pub surfaces: Vec<Surface>,
    /// Length of the record, quiet beginning included, s.
    pub duration_s: f64,
    /// Quiet time before the input, s.
    pub lead_s: f64,
    /// Samples per second of the deflections.
    pub sample_rate_hz: f64,
    /// Band of sweeps and multisines, Hz; from the modes where none: 0.4 times the slowest to 2.5 times the fastest.
    pub band_hz: Option<[f64; 2]>,
    /// Whether a sweep's frequency runs linearly instead of with equal time per octave.
    pub linear_sweep: bool,
}

/// The input of one surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceInput {
    /// The surface that is moved.
    pub surface: Surface,
    /// Deflection from trim at each sample, rad (of a shape: peak of one).
    #[serde(skip)]
    pub deflection: Vec<f64>,
    /// Frequency of the mode that it is meant for, rad/s.
    pub mode_rad_s: f64,
    /// Half width of the doublet or unit of the 3-2-1-1, s.
    pub pulse_width_s: Option<f64>,
    /// `(max - min)/(2 sqrt(2) rms)` while the input is on: 1 for one sine (Morelli 2003).
    pub relative_peak_factor: f64,
    /// The components of a multisine; empty for the other families.
    pub harmonics: Vec<Harmonic>,
}

impl SurfaceInput {
    /// Largest deflection from trim, rad.
    pub fn peak(&self) -> f64 {
        self.deflection.iter().fold(0.0, |peak, d| d.abs().max(peak))
    }

    /// Largest rate between two samples `h` apart, rad/s.
    pub fn peak_rate(&self, h: f64) -> f64 {
        self.deflection.windows(2).map(|w| (w[1] - w[0]).abs() / h).fold(0.0, f64::max)
    }
}

/// An input: deflections of one or more surfaces on one time base.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Design {
    /// The family that the input belongs to.
    pub kind: Kind,
    /// Times of the samples from the start of the record, s.
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// Samples per second of the deflections.
    pub sample_rate_hz: f64,
    /// The inputs, one for each surface of the request.
    pub inputs: Vec<SurfaceInput>,
    /// Period of a multisine, s.
    pub period_s: Option<f64>,
    /// Band of a sweep or multisine, Hz.
    pub band_hz: Option<[f64; 2]>,
}

/// A [`Design`] whose deflections have a peak of one.
pub type Shape = Design;

/// Most samples of a design: 1000 s at 100 Hz. The flight is simulated some ten times, and the phases of a multisine are searched.
const MAX_SAMPLES: f64 = 100_000.0;

/// The shape of an input of this kind, peak one, for an aircraft with these modes.
///
/// Doublets, 3-2-1-1 and sweeps move one surface after another and fill the time; multisines move all surfaces at once.
///
/// # Errors
/// [`DesignError::Unsuitable`]: no surface, a surface twice, no room for the input in the time, too long a time, an impossible band.
pub fn shape(kind: Kind, request: &Request, modes: &ModeFrequencies) -> Result<Shape, DesignError> {
    let unsuitable = |message: String| Err(DesignError::Unsuitable(message));
    let Request { surfaces, duration_s, lead_s, sample_rate_hz, .. } = request;
    if surfaces.is_empty() {
        return unsuitable("an input needs a surface: elevator, aileron or rudder".to_owned());
    }
    if let Some(twice) = surfaces.iter().enumerate().find(|(k, s)| surfaces[..*k].contains(s)) {
        return unsuitable(format!("the {} is named twice", twice.1.name()));
    }
    if let Some(dead) = surfaces.iter().find(|surface| modes.of(**surface).is_nan()) {
        return unsuitable(format!(
            "the aircraft has no motion that the {} excites: a model of the longitudinal axes alone knows the elevator only",
            dead.name()
        ));
    }
    let active = duration_s - lead_s;
    if !(*sample_rate_hz > 0.0 && *lead_s >= 0.0 && active * sample_rate_hz >= 20.0 && duration_s.is_finite()) {
        return unsuitable(format!(
            "{duration_s} s at {sample_rate_hz} Hz after {lead_s} s of rest leave no room for an input: lengthen the duration"
        ));
    }
    if duration_s * sample_rate_hz > MAX_SAMPLES {
        return unsuitable(format!(
            "{duration_s} s at {sample_rate_hz} Hz are more than {MAX_SAMPLES} samples: shorten the duration, or join several inputs"
        ));
    }
    let samples = (duration_s * sample_rate_hz + 1e-9) as usize + 1;
    let time_s: Vec<f64> = (0..samples).map(|k| k as f64 / sample_rate_hz).collect();
    let band = match request.band_hz {
        Some(band) => band,
        None => modes.band_hz(surfaces),
    };
    let [low, high] = band;
    if !(low > 0.0 && high > low && high <= 0.25 * sample_rate_hz) && matches!(kind, Kind::Sweep | Kind::Multisine) {
        return unsuitable(format!(
            "the band {low:.3} to {high:.3} Hz is impossible at {sample_rate_hz} samples per second: it has to increase, from \
             above zero to at most a quarter of the sample rate"
        ));
    }
    let mut design =
        Design { kind, time_s, sample_rate_hz: *sample_rate_hz, inputs: Vec::new(), period_s: None, band_hz: None };
    match kind {
        Kind::Doublet => design.inputs = pulses::trains(&design.time_s, request, modes, &pulses::DOUBLET)?,
        Kind::ThreeTwoOneOne => {
            design.inputs = pulses::trains(&design.time_s, request, modes, &pulses::THREE_TWO_ONE_ONE)?;
        }
        Kind::Sweep => {
            design.inputs = sweep::sweeps(&design.time_s, request, modes, band)?;
            design.band_hz = Some(band);
        }
        Kind::Multisine => {
            let set = multisine::design(surfaces, band, active, *sample_rate_hz)?;
            design.inputs = set
                .inputs
                .into_iter()
                .map(|input| SurfaceInput {
                    surface: input.surface,
                    deflection: design.time_s.iter().map(|t| input.at(t - lead_s, set.period_s)).collect(),
                    mode_rad_s: modes.of(input.surface),
                    pulse_width_s: None,
                    relative_peak_factor: input.relative_peak_factor,
                    harmonics: input.harmonics,
                })
                .collect();
            design.period_s = Some(set.period_s);
            design.band_hz = Some(band);
        }
    }
    Ok(design)
}

/// `(max - min)/(2 sqrt(2) rms)` of the samples that are on, from the first to the last that is not zero; 1 for a sine.
pub fn relative_peak_factor(signal: &[f64]) -> f64 {
    let first = signal.iter().position(|v| *v != 0.0).unwrap_or(0);
    let last = signal.iter().rposition(|v| *v != 0.0).map_or(0, |k| k + 1);
    let on = signal.get(first..last).unwrap_or_default();
    let (low, high) = on.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
    let rms = (on.iter().map(|v| v * v).sum::<f64>() / on.len().max(1) as f64).sqrt();
    (high - low) / (2.0 * std::f64::consts::SQRT_2 * rms)
}
