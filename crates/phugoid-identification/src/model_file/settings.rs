//! The settings of a model file for the estimation: process noise, estimator, input between samples.

use crate::core::method::Method;
use crate::core::output::{Output, STATE_CHANNELS};

/// The process noise of the states, which stands for gusts and model error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise {
    /// Spectral densities of the rates of the states, by [`Output::index`](crate::output::Output::index): airspeed
    /// (m^2/s^3), angles (rad^2/s), angular rates (rad^2/s^3). Those that are no states of the axes are not used.
    pub density: [f64; STATE_CHANNELS],
    /// True if a common factor on all densities is estimated from the residuals.
    pub adaptive: bool,
    /// True airspeed, m/s, at which gusts make the densities of the flow angles; at another one they are those of the same
    /// gusts. None: they hold at any speed.
    pub at_speed: Option<f64>,
}

impl ProcessNoise {
    /// The densities in flight at this true airspeed (m/s). A gust of `w` changes a flow angle by `w / V`, so that with
    /// [`ProcessNoise::at_speed`] the densities of alpha and beta go with one over the square of the speed. A speed that
    /// is not known, or not finite and positive, leaves them as they are.
    pub fn in_flight(&self, speed: Option<f64>) -> [f64; STATE_CHANNELS] {
        let speed = speed.filter(|speed| speed.is_finite() && *speed > 0.0);
        let factor = self.at_speed.zip(speed).map_or(1.0, |(at, speed)| (at / speed).powi(2));
        let mut density = self.density;
        for angle in [Output::Alpha, Output::Beta] {
            density[angle.index()] *= factor;
        }
        density
    }
}

/// The table `[estimator]`: settings of the estimator that replace the automatic rule (`docs/tuning.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorTuning {
    /// The method, unless [`EstimateOptions::method`](crate::options::EstimateOptions::method) gives another one.
    pub method: Method,
    /// `kappa`: up to this normalised surface value a row slides; none for the rule, 3.
    pub reaching_limit: Option<f64>,
    /// Factor on the rule for `kappa2`, `max(6, 2 sqrt(p) + 2)`, beyond which a row is rejected; never below `kappa`.
    pub rejection_scale: f64,
    /// Factor on the start priors of the terms; sudden changes and nuisance columns keep theirs.
    pub prior_scale: f64,
    /// Factor on the process noise that the file gives (with adaptive noise: on its start).
    pub process_noise_scale: f64,
    /// Part of the information about the scale of the process noise that is forgotten per sample; none for the rule,
    /// 0.003. Only where it is adaptive.
    pub adaptation_gain: Option<f64>,
    /// Length of the median start, s; none for the rule, 0.2 s.
    pub start_window_s: Option<f64>,
}

impl Default for EstimatorTuning {
    fn default() -> Self {
        Self {
            method: Method::default(),
            reaching_limit: None,
            rejection_scale: 1.0,
            prior_scale: 1.0,
            process_noise_scale: 1.0,
            adaptation_gain: None,
            start_window_s: None,
        }
    }
}

/// How control surfaces and extra inputs move between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputHold {
    /// They keep the value of the earlier sample, as a digital command does.
    Held,
    /// They move on a straight line to the next sample, as a recorded surface does.
    Interpolated,
    /// One of the two, found from when the aircraft of a record reacts to the surfaces, with their delay; held in a live
    /// session, which cannot look ahead.
    Auto,
}

#[cfg(test)]
mod tests {
    use crate::core::output::Output;
    use crate::model_file::ModelFile;

    /// Dryden's vertical gust has 3/2 of the density of that along the flight path, and makes `w / V` of angle of attack.
    #[test]
    fn the_usual_gusts_make_larger_flow_angles_in_slower_flight() {
        let own = "axes = [\"longitudinal\"]\n[aircraft]\nmass = 1000\niyy = 2000\nwing_area = 16\nmean_chord = 1.5\n\
                   thrust = { channel = \"thrust\" }\nair_density = 1.0\n[coefficients]\nCL = [\"1\", \"alpha\"]\n";
        let usual = ModelFile::parse("own.toml", own).unwrap().process_noise;
        let [along, alpha, beta] = [Output::TrueAirspeed, Output::Alpha, Output::Beta].map(Output::index);
        for speed in [30.0, 60.0, 240.0] {
            let density = usual.in_flight(Some(speed));
            assert!((density[alpha] * speed * speed / density[along] - 1.5).abs() < 0.02, "{density:?}");
            assert_eq!(density[alpha], density[beta]);
        }
        for unknown in [None, Some(f64::NAN), Some(0.0)] {
            assert_eq!(usual.in_flight(unknown), usual.density);
        }
        // What a file gives, and the flights that the densities were made for, are as they are.
        let given =
            ModelFile::parse("own.toml", &format!("{own}[process_noise]\nalpha = 1e-5\n")).unwrap().process_noise;
        assert_eq!(given.in_flight(Some(60.0)), given.density);
        let study = ModelFile::named("f16").unwrap().process_noise;
        assert_eq!(study.in_flight(Some(60.0)), study.density);
    }
}
