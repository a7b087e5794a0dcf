//! Smoothed states for the regression methods, from kinematics alone.
//!
//! Rate gyros and accelerometers say how airspeed, flow angles and attitude change, without any aerodynamics:
//!
//! ```text
//! V' = f_V(ax, ay, az),   alpha' = q + f_a(ax, az)/V + ...,   beta' = ...,   phi' = p + ...,   theta' = q cos(phi) - r sin(phi)
//! ```
//!
//! (Stevens & Lewis, table 2.5-1). Each of these states is integrated and drawn towards its own measurement with the
//! gain `max(1/(k+1), 1 - e^{-b h})` at its `k`-th measurement: the mean of all at first, a filter of corner `b` later.
//! The rule for the corner is the stationary Kalman gain of a random walk, `b = sqrt((s_i^2 h + Q)/(s^2 h))`, with `s`
//! the noise of the measurement (one sigma), `s_i` that of the integrated rate, `Q` the process noise of the state
//! (variance per second) and `h` the sample time. There is nothing to tune: 0.3, 1 and 2 rad/s for V, alpha and theta
//! of the F-16 in calm air, and some 30 rad/s in light turbulence, where the vane feels gusts that no accelerometer
//! predicts.
//!
//! Angular rates stay as measured: only the unknown moments could smooth them.

use std::marker::PhantomData;

use phugoid_estimators::Sample;
use phugoid_estimators::regression::{SourceStep, StateSource};
use phugoid_estimators::settings::EstimatorSettings;

use crate::core::output::{CHANNELS, Output};
use crate::motion::Motion;

/// The states that kinematics integrates.
const INTEGRATED: [Output; 5] = [Output::TrueAirspeed, Output::Alpha, Output::Beta, Output::Phi, Output::Theta];

/// The kinematic front end of the motion `M` with `N` states and `R` outputs.
#[derive(Clone, Copy, Debug)]
pub struct KinematicFrontEnd<M, const N: usize, const R: usize> {
    motion: PhantomData<M>,
    gravity: f64,
    /// Row of each channel in the output vector; the states come first.
    rows: [Option<usize>; CHANNELS],
    /// One sigma per channel, SI; infinite where it is not measured.
    noise: [f64; CHANNELS],
    /// Process noise of the integrated states, variance per second.
    process: [f64; 5],
    sample_time_s: f64,
    /// Corner frequencies `b` of the five filters, rad/s.
    corners: [f64; 5],
    /// Measurements taken, per integrated state.
    taken: [f64; 5],
    /// All channels at the last frame.
    last: [f64; CHANNELS],
}

impl<M: Motion<N, R>, const N: usize, const R: usize> KinematicFrontEnd<M, N, R> {
    /// For the noise and process noise of `settings`; `gravity` in m/s^2.
    pub fn new<const P: usize>(gravity: f64, settings: &EstimatorSettings<N, R, P>) -> Self {
        let rows = Output::ALL.map(|output| M::AXES.row(output).filter(|row| *row < R));
        let noise = rows.map(|row| match row.and_then(|row| settings.noise_std.get(row)) {
            Some(std) if std.is_finite() && *std > 0.0 => *std,
            _ => f64::INFINITY,
        });
        let scale = settings.process_noise.initial_scale;
        let process = INTEGRATED.map(|state| {
            let variance = rows[state.index()].and_then(|row| settings.process_noise.variance_per_s.get(row));
            variance.map_or(0.0, |variance| variance * scale)
        });
        Self {
            motion: PhantomData,
            gravity,
            rows,
            noise,
            process,
            sample_time_s: settings.sample_time_s,
            corners: [0.0; 5],
            taken: [0.0; 5],
            last: [0.0; CHANNELS],
        }
    }

    /// `b` of airspeed, alpha, beta, phi and theta, rad/s, as set at the start; infinite where the measurement is taken
    /// as it is, zero where there is none.
    pub fn corner_rates(&self) -> [f64; 5] {
        self.corners
    }

    fn set_corners(&mut self, speed: f64) {
        let noise = |channel: Output| self.noise[channel.index()];
        let square = |std: f64| std * std;
        let per_speed = 1.0 / speed.max(1.0);
        // A rate that is known from elsewhere (an input) has no noise here; a channel that is not known at all has
        // infinite noise.
        let force = |channel: Output| match self.rows[channel.index()] {
            Some(_) => square(noise(channel)),
            None => 0.0,
        };
        let rate = [
            force(Output::Ax),
            force(Output::PitchRate) + force(Output::Az) * per_speed * per_speed,
            force(Output::YawRate) + force(Output::Ay) * per_speed * per_speed,
            force(Output::RollRate),
            force(Output::PitchRate),
        ];
        self.corners = std::array::from_fn(|i| {
            let measured = square(noise(INTEGRATED[i])) * self.sample_time_s;
            if measured.is_finite() {
                ((rate[i] * self.sample_time_s + self.process[i]) / measured).sqrt()
            } else {
                0.0
            }
        });
    }

    /// Rates of the integrated states at a frame, per second.
    fn rates(&self, c: &[f64; CHANNELS]) -> [f64; 5] {
        let at = |channel: Output| c[channel.index()];
        let (speed, [p, q, r]) =
            (at(Output::TrueAirspeed), [Output::RollRate, Output::PitchRate, Output::YawRate].map(at));
        let (sin_alpha, cos_alpha) = at(Output::Alpha).sin_cos();
        let (sin_beta, cos_beta) = at(Output::Beta).sin_cos();
        let (sin_phi, cos_phi) = at(Output::Phi).sin_cos();
        let (sin_theta, cos_theta) = at(Output::Theta).sin_cos();
        let (u, v, w) = (speed * cos_alpha * cos_beta, speed * sin_beta, speed * sin_alpha * cos_beta);
        let g = self.gravity;
        let u_rate = r * v - q * w - g * sin_theta + at(Output::Ax);
        let v_rate = p * w - r * u + g * sin_phi * cos_theta + at(Output::Ay);
        let w_rate = q * u - p * v + g * cos_phi * cos_theta + at(Output::Az);
        let in_plane = cos_alpha * u_rate + sin_alpha * w_rate;
        [
            in_plane * cos_beta + v_rate * sin_beta,
            (cos_alpha * w_rate - sin_alpha * u_rate) / (speed * cos_beta),
            (v_rate * cos_beta - in_plane * sin_beta) / speed,
            p + (q * sin_phi + r * cos_phi) * sin_theta / cos_theta,
            q * cos_phi - r * sin_phi,
        ]
    }
}

impl<M: Motion<N, R>, const N: usize, const R: usize> StateSource<M::KnownInput, N, R> for KinematicFrontEnd<M, N, R> {
    fn start(&mut self, sample: &Sample<M::KnownInput, R>, state: &[f64; N]) {
        self.last = Output::ALL.map(|channel| match self.rows[channel.index()] {
            Some(row) if row < N => state[row],
            Some(row) if sample.outputs[row].is_finite() => sample.outputs[row],
            _ => M::known_channel(&sample.input, channel).unwrap_or(0.0),
        });
        self.taken = [0.0; 5];
        self.set_corners(self.last[Output::TrueAirspeed.index()]);
    }

    fn update(&mut self, step: &SourceStep<'_, M::KnownInput, N, R>) -> [f64; N] {
        let h = step.interval_s;
        let mut now = Output::ALL.map(|channel| match self.rows[channel.index()] {
            Some(row) if step.outputs[row].is_finite() => step.outputs[row],
            Some(row) => step.predicted_outputs[row],
            None => M::known_channel(step.input_after, channel).unwrap_or(0.0),
        });
        // The integrated states at the end, by Heun's rule with the rates measured at both ends.
        let before = self.rates(&self.last);
        let mut ahead = now;
        for (state, rate) in INTEGRATED.iter().zip(&before) {
            if self.rows[state.index()].is_some() {
                ahead[state.index()] = self.last[state.index()] + h * rate;
            }
        }
        let after = self.rates(&ahead);
        for (i, state) in INTEGRATED.iter().enumerate() {
            let Some(row) = self.rows[state.index()] else { continue };
            let integrated = self.last[state.index()] + 0.5 * h * (before[i] + after[i]);
            let measured = step.outputs[row];
            now[state.index()] = integrated;
            if !integrated.is_finite() {
                now[state.index()] = step.predicted_state.get(row).copied().unwrap_or(integrated);
            } else if measured.is_finite() && self.corners[i] > 0.0 {
                self.taken[i] += 1.0;
                let gain = (1.0 / self.taken[i]).max(1.0 - (-self.corners[i] * h).exp());
                now[state.index()] += gain * (measured - integrated);
            }
        }
        self.last = now;
        std::array::from_fn(|row| {
            let channel = Output::ALL.iter().position(|c| self.rows[c.index()] == Some(row));
            channel.map_or(step.predicted_state[row], |channel| now[channel])
        })
    }
}
