//! Smoothed states for the regression methods, from kinematics alone.
//!
//! Rate gyros and accelerometers say how airspeed, flow angles and attitude change, without any aerodynamics
//! (`preparation::kinematics`; Stevens & Lewis, table 2.5-1). Each of these states is integrated and drawn towards its own measurement with the
//! gain `max(1/(k+1), 1 - e^{-b h})` at its `k`-th measurement: the mean of all at first, a filter of corner `b` later.
//!
//! **The corner.** With sensors alone it is the stationary Kalman gain of a random walk, `b = sqrt((s_i^2 h + Q)/(s^2 h))`,
//! with `s` the noise of the measurement (one sigma), `s_i` that of the integrated rate, `Q` the process noise of the
//! state (variance per second) and `h` the sample time: 0.3, 1 and 2 rad/s for V, alpha and theta of the F-16 in calm
//! air, and some 30 rad/s in light turbulence, where the vane feels gusts that no accelerometer predicts.
//!
//! Where the process noise is fixed, that rule holds. Where it may adapt, nobody has said how rough the air is, and up to
//! eight filters of corners a factor of three apart, from that of calm air upwards, run beside each other. One counts by
//! how well it predicts the next measurement: with `m` the mean square of its prediction errors over the last 20 s, its
//! weight is `m^(-n/2)`, the likelihood of `n` independent errors of unknown size. The state is the weighted mean. A corner
//! that is too low follows gusts too late; one that is too high hands on the noise of the vane, and noise in regressors makes
//! derivatives too small.
//!
//! Angular rates stay as measured: only the unknown moments could smooth them.

use std::marker::PhantomData;

use phugoid_estimators::Sample;
use phugoid_estimators::regression::{SourceStep, StateError, StateSource};
use phugoid_estimators::settings::{EstimatorSettings, NoiseAdaptation};

use crate::core::output::{CHANNELS, Output};
use crate::motion::Motion;
use crate::preparation::kinematics::{INTEGRATED, rates};

/// Number of filters that run beside each other for a state where the process noise may adapt.
const CANDIDATES: usize = 8;
/// Ratio of the corners of two of them.
const RATIO: f64 = 3.0;
/// Gain of the fastest that is of use: the measurement as it is, but for single wild values.
const HIGHEST_GAIN: f64 = 0.95;
/// Memory of the mean squares of the prediction errors, s: some manoeuvres long, so that the weather may change.
const MEMORY_S: f64 = 20.0;
/// An error counts in a mean square as at most this many times it: outliers that passed the gate decide nothing.
const LARGEST_SQUARE: f64 = 9.0;

/// One integrated state in its filters.
#[derive(Clone, Copy, Debug)]
struct Filters {
    /// Corner of each filter, rad/s.
    corners: [f64; CANDIDATES],
    /// How many of them there are.
    count: usize,
    /// Gain of each over an interval of `interval_s`.
    gains: [f64; CANDIDATES],
    interval_s: f64,
    /// The state according to each, state unit.
    states: [f64; CANDIDATES],
    /// Mean square of the prediction errors of each, state unit squared.
    squares: [f64; CANDIDATES],
    /// Likelihood of the prediction errors of each, as a part of the sum of all.
    weights: [f64; CANDIDATES],
    /// Measurements since the start of the states.
    taken: f64,
    /// Measurements since the first start, as the memory counts them.
    remembered: f64,
}

impl Filters {
    const NONE: Self = Self {
        corners: [0.0; CANDIDATES],
        count: 1,
        gains: [0.0; CANDIDATES],
        interval_s: 0.0,
        states: [0.0; CANDIDATES],
        squares: [0.0; CANDIDATES],
        weights: [1.0; CANDIDATES],
        taken: 0.0,
        remembered: 0.0,
    };

    /// One filter of a corner, rad/s, or from that corner up to the fastest that is of use at the sample time `h`, s.
    fn set(&mut self, corner: f64, adapts: bool, h: f64) {
        self.corners = std::array::from_fn(|i| corner * RATIO.powi(i as i32));
        self.set_gains(h);
        let of_use = self.gains.iter().filter(|gain| **gain < HIGHEST_GAIN).count().max(1);
        self.count = if adapts && corner > 0.0 { of_use } else { 1 };
        self.weigh();
    }

    fn set_gains(&mut self, h: f64) {
        self.gains = self.corners.map(|corner| 1.0 - (-corner * h).exp());
        self.interval_s = h;
    }

    fn start(&mut self, state: f64) {
        (self.states, self.taken) = ([state; CANDIDATES], 0.0);
    }

    /// Moves all by what was integrated over `h` s, and draws them towards a measurement, if there is one; gives their
    /// weighted mean.
    fn advance(&mut self, integrated: f64, measured: f64, h: f64) -> f64 {
        self.states.iter_mut().for_each(|state| *state += integrated);
        if measured.is_finite() && self.corners[0] > 0.0 {
            // Sampling times carry rounding.
            if (h - self.interval_s).abs() > 1e-9 * h {
                self.set_gains(h);
            }
            self.taken += 1.0;
            self.remembered = (self.remembered + 1.0).min(MEMORY_S / h);
            for i in 0..self.count {
                let (error, square) = (measured - self.states[i], &mut self.squares[i]);
                // The first error is that of the start, and the same for all.
                if self.taken > 1.0 {
                    let largest = if *square > 0.0 { LARGEST_SQUARE * *square } else { f64::INFINITY };
                    *square += ((error * error).min(largest) - *square) / self.remembered;
                }
                self.states[i] += self.gain(i) * error;
            }
            self.weigh();
        }
        self.weighted(|i| self.states[i])
    }

    /// Gain of a filter at its last measurement: the mean of all at first.
    fn gain(&self, i: usize) -> f64 {
        (1.0 / self.taken.max(1.0)).max(self.gains[i])
    }

    /// How wrong the state may be: the variance `K R` of a filter with the gain `K` for a measurement of the noise variance `R`;
    /// forgotten as fast as the filter does. `R` is `noise`, or `1 - K` of the mean square, `K` that of the stationary filter,
    /// where that is learnt; until there is a mean square it is `noise` too.
    fn error(&self, noise: f64) -> StateError {
        let is_learnt = |i: usize| self.count > 1 && self.squares[i] > 0.0;
        let of_measurement = |i: usize| if is_learnt(i) { (1.0 - self.gains[i]) * self.squares[i] } else { noise };
        StateError {
            variance: self.weighted(|i| self.gain(i) * of_measurement(i)),
            rate_per_s: self.weighted(|i| self.gain(i)) / self.interval_s,
        }
    }

    /// Weighs the filters by the likelihood of their prediction errors.
    fn weigh(&mut self) {
        if self.count == 1 {
            return;
        }
        let (squares, weights) = (&self.squares[..self.count], &mut self.weights[..self.count]);
        for (weight, square) in weights.iter_mut().zip(squares) {
            *weight = -0.5 * self.remembered * square.max(f64::MIN_POSITIVE).ln();
        }
        let most = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        weights.iter_mut().for_each(|weight| *weight = (*weight - most).exp());
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
    }

    /// The mean of a value of each filter by their weights.
    fn weighted(&self, value: impl Fn(usize) -> f64) -> f64 {
        if self.count == 1 { value(0) } else { (0..self.count).map(|i| self.weights[i] * value(i)).sum() }
    }
}

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
    /// Whether the process noise may adapt.
    adapts: bool,
    /// The filters of the five integrated states.
    filters: [Filters; 5],
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
            adapts: settings.process_noise.adaptation != NoiseAdaptation::Off,
            filters: [Filters::NONE; 5],
            last: [0.0; CHANNELS],
        }
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
        for (i, filters) in self.filters.iter_mut().enumerate() {
            let measured = square(self.noise[INTEGRATED[i].index()]) * self.sample_time_s;
            // What may adapt begins with calm air.
            let process = if self.adapts { 0.0 } else { self.process[i] };
            let corner = ((rate[i] * self.sample_time_s + process) / measured).sqrt();
            filters.set(if measured.is_finite() { corner } else { 0.0 }, self.adapts, self.sample_time_s);
        }
    }
}

impl<M: Motion<N, R>, const N: usize, const R: usize> StateSource<M::KnownInput, N, R> for KinematicFrontEnd<M, N, R> {
    fn start(&mut self, sample: &Sample<M::KnownInput, R>, state: &[f64; N]) {
        self.last = Output::ALL.map(|channel| match self.rows[channel.index()] {
            Some(row) if row < N => state[row],
            Some(row) if sample.outputs[row].is_finite() => sample.outputs[row],
            _ => M::known_channel(&sample.input, channel).unwrap_or(0.0),
        });
        self.set_corners(self.last[Output::TrueAirspeed.index()]);
        for (filters, state) in self.filters.iter_mut().zip(&INTEGRATED) {
            filters.start(self.last[state.index()]);
        }
    }

    fn update(&mut self, step: &SourceStep<'_, M::KnownInput, N, R>) -> [f64; N] {
        let h = step.interval_s;
        let mut now = Output::ALL.map(|channel| match self.rows[channel.index()] {
            Some(row) if step.outputs[row].is_finite() => step.outputs[row],
            Some(row) => step.predicted_outputs[row],
            None => M::known_channel(step.input_after, channel).unwrap_or(0.0),
        });
        // The integrated states at the end, by Heun's rule with the rates measured at both ends.
        let before = rates(&self.last, self.gravity);
        let mut ahead = now;
        for (state, rate) in INTEGRATED.iter().zip(&before) {
            if self.rows[state.index()].is_some() {
                ahead[state.index()] = self.last[state.index()] + h * rate;
            }
        }
        let after = rates(&ahead, self.gravity);
        for (i, state) in INTEGRATED.iter().enumerate() {
            let Some(row) = self.rows[state.index()] else { continue };
            let integrated = self.last[state.index()] + 0.5 * h * (before[i] + after[i]);
            if integrated.is_finite() {
                now[state.index()] =
                    self.filters[i].advance(integrated - self.last[state.index()], step.outputs[row], h);
            } else {
                now[state.index()] = step.predicted_state.get(row).copied().unwrap_or(integrated);
                self.filters[i].start(now[state.index()]);
            }
        }
        self.last = now;
        std::array::from_fn(|row| {
            let channel = Output::ALL.iter().position(|c| self.rows[c.index()] == Some(row));
            channel.map_or(step.predicted_state[row], |channel| now[channel])
        })
    }

    fn errors(&self) -> [StateError; N] {
        let h = self.sample_time_s;
        std::array::from_fn(|row| {
            let Some(channel) = Output::ALL.iter().find(|c| self.rows[c.index()] == Some(row)) else {
                return StateError::NONE;
            };
            let noise = self.noise[channel.index()].powi(2);
            match INTEGRATED.iter().position(|state| state == channel) {
                Some(i) if self.filters[i].corners[0] > 0.0 => self.filters[i].error(noise),
                None if noise.is_finite() => StateError { variance: noise, rate_per_s: 2.0 / h },
                _ => StateError::NONE,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::random::Normal;

    /// Sample time, s, and one sigma of the measurement.
    const H: f64 = 0.02;
    const NOISE: f64 = 0.0035;

    /// Root mean square of the errors of the state and of what is claimed of it, where the state is a random walk of `walk`
    /// per second beside what is integrated; the last 40 s of 60.
    fn errors(adapts: bool, corner: f64, walk: f64) -> [f64; 2] {
        let mut filters = Filters::NONE;
        filters.set(corner, adapts, H);
        filters.start(0.0);
        let (mut random, mut state, mut sums) = (Normal(5), 0.0, [0.0; 2]);
        for k in 0..3000 {
            let integrated = 0.1 * H * (f64::from(k) * H).cos();
            state += integrated + walk * H.sqrt() * random.next();
            let found = filters.advance(integrated, state + NOISE * random.next(), H);
            if k >= 1000 {
                sums[0] += (found - state).powi(2) / 2000.0;
                sums[1] += filters.error(NOISE * NOISE).variance / 2000.0;
            }
        }
        sums.map(f64::sqrt)
    }

    #[test]
    fn the_corner_is_that_of_the_air() {
        // Calm: the error of a filter of 0.8 rad/s, 0.44e-3; 1.5 of a sample's noise in each interval: nearly the measurement.
        for (walk, corner_rad_s) in [(0.0028, 0.8), (1.5 * NOISE / H.sqrt(), 75.0)] {
            let best = errors(false, corner_rad_s, walk)[0];
            let [error, claimed] = errors(true, 0.8, walk);
            println!("walk {walk}: {error:.2e} in place of {best:.2e}, claimed {claimed:.2e}");
            assert!(error < 1.1 * best, "{error} {best}");
            assert!((0.85..1.15).contains(&(claimed / error)), "{claimed} {error}");
        }
        // The corner of calm air alone follows such gusts too late, and says nothing of it.
        let [error, claimed] = errors(false, 0.8, 1.5 * NOISE / H.sqrt());
        assert!(error > 5.0 * claimed, "{error} {claimed}");
    }

    /// At the start the state is one measurement, and after a gap it is again, whatever has been learnt of the filters.
    #[test]
    fn a_state_that_rests_on_one_measurement_is_as_wrong_as_that() {
        let (mut filters, mut random) = (Filters::NONE, Normal(7));
        filters.set(0.8, true, H);
        for _ in 0..2 {
            filters.start(0.0);
            for k in 0..500 {
                filters.advance(0.0, NOISE * random.next(), H);
                let claimed = filters.error(NOISE * NOISE).variance.sqrt() / NOISE;
                assert!(k > 0 || (0.8..1.2).contains(&claimed), "{claimed}");
                assert!(k < 400 || (0.05..0.2).contains(&claimed), "{claimed}");
            }
        }
    }

    #[test]
    fn a_measurement_that_is_missing_moves_nothing() {
        let mut filters = Filters::NONE;
        filters.set(0.8, true, H);
        filters.start(1.0);
        assert_eq!(filters.advance(0.25, f64::NAN, H), 1.25);
        filters.set(0.0, true, H);
        assert_eq!(filters.advance(0.25, 9.0, H), 1.5);
    }
}
