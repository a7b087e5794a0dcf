//! The motion that all sensors and the estimated errors give together, with its standard error.

use nalgebra::DMatrix;

use super::filter::{Course, Run, Square, State, run};
use super::kinematics::{Kinematics, OUTPUTS, STATES};
use super::signals::{Flight, OUTPUT_CHANNELS};
use super::solve::Solution;
use crate::batch::OutputFit;

/// A channel of the reconstructed motion at the centre of gravity, without the errors of its sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconstructed {
    /// Canonical name of the channel, e.g. `alpha`.
    pub name: String,
    /// SI unit as printed, e.g. `rad`.
    pub unit: String,
    /// Reconstructed values, one per sample of the record, SI; NaN in gaps.
    pub values: Vec<f64>,
    /// One-sigma error that noise, turbulence and the estimated errors of the sensors leave, by sample.
    pub std_error: Vec<f64>,
}

/// State, covariance and sensitivity of the smoother at one sample.
struct Smoothed {
    state: State,
    covariance: Square,
    /// State by column.
    by: Vec<f64>,
}

/// Runs the smoother (Rauch, Tung and Striebel) backwards over a run of the filter with its course.
fn smoothed(flight: &Flight, run: &Run, columns: usize) -> Vec<Smoothed> {
    let active = &flight.active;
    let n = active.len();
    let mut out: Vec<Smoothed> = Vec::with_capacity(run.steps.len());
    for k in (0..run.steps.len()).rev() {
        let (step, course): (_, &Course) = (&run.steps[k], &run.course[k]);
        let mut now = Smoothed { state: step.filtered, covariance: course.filtered, by: course.filtered_by.clone() };
        if let (Some(next), Some(later)) = (run.steps.get(k + 1).filter(|s| !s.fresh), out.last()) {
            let (after, p) = (&run.course[k + 1], &course.filtered);
            let transition = |i: usize, j: usize| next.transition[i][j];
            // A P, state of the next sample by state of this one.
            let ap = DMatrix::from_fn(n, n, |i, j| {
                (0..n).map(|l| transition(active[i], active[l]) * p[active[l]][active[j]]).sum::<f64>()
            });
            let size = |i: usize| after.predicted[active[i]][active[i]].max(1e-300).sqrt();
            let scaled = DMatrix::from_fn(n, n, |i, j| {
                after.predicted[active[i]][active[j]] / (size(i) * size(j)) + if i == j { 1e-12 } else { 0.0 }
            });
            if let Some(factor) = scaled.cholesky() {
                // G^T = P_predicted^-1 A P
                let right = DMatrix::from_fn(n, n, |i, j| ap[(i, j)] / size(i));
                let gain = factor.solve(&right);
                let gain = |i: usize, l: usize| gain[(l, i)] / size(l);
                for i in 0..n {
                    for l in 0..n {
                        let g = gain(i, l);
                        now.state[active[i]] += g * (later.state[active[l]] - next.predicted[active[l]]);
                        for c in 0..columns {
                            now.by[active[i] * columns + c] +=
                                g * (later.by[active[l] * columns + c] - after.predicted_by[active[l] * columns + c]);
                        }
                    }
                }
                let difference = DMatrix::from_fn(n, n, |i, j| {
                    later.covariance[active[i]][active[j]] - after.predicted[active[i]][active[j]]
                });
                let g = DMatrix::from_fn(n, n, gain);
                let added = &g * difference * g.transpose();
                for i in 0..n {
                    for j in 0..n {
                        now.covariance[active[i]][active[j]] += added[(i, j)];
                    }
                }
            }
        }
        out.push(now);
    }
    out.reverse();
    out
}

/// True airspeed, flow angles, attitude and position of a state, and their derivatives by it.
fn truth(x: &State) -> ([f64; OUTPUTS], [[f64; STATES]; OUTPUTS]) {
    let none = [0.0; super::kinematics::PARAMETERS];
    // Without errors and delays the sensors show the truth, whatever the inertial signals are.
    let shown =
        Kinematics { gravity: 9.80665, curvature: 0.0 }.shown(x, &none, &|_| super::kinematics::Inertial::default());
    (shown.outputs, shown.by_state)
}

/// Reconstructs what the record has channels for, and the angle of attack always; and how the sensors, their errors
/// included, follow it.
pub(super) fn reconstruct(flight: &Flight, index: usize, solution: &Solution) -> (Vec<Reconstructed>, Vec<OutputFit>) {
    let own = solution.columns_of(index);
    let places: Vec<usize> = own.iter().map(|i| solution.columns[*i].place).collect();
    let theta = solution.theta(index);
    let run = run(flight, &theta, &solution.levels[index], &places, true);
    let m = own.len();
    // What flights of the same record say against each other may widen an unknown beyond what is possible for a sensor.
    let possible = |i: usize| (solution.columns[i].prior_std / solution.corrected[(i, i)].sqrt()).min(1.0);
    let covariance =
        DMatrix::from_fn(m, m, |i, j| solution.corrected[(own[i], own[j])] * possible(own[i]) * possible(own[j]));
    let points = smoothed(flight, &run, m);
    let kinematics = Kinematics { gravity: flight.gravity.value, curvature: flight.curvature };
    let mut values: Vec<[f64; OUTPUTS]> = Vec::with_capacity(points.len());
    let mut stds: Vec<[f64; OUTPUTS]> = Vec::with_capacity(points.len());
    let mut modelled: [Vec<f64>; OUTPUTS] = Default::default();
    for (k, point) in points.iter().enumerate() {
        let (outputs, by_state) = truth(&point.state);
        let variance = |h: &[f64; STATES]| {
            let noise: f64 = flight
                .active
                .iter()
                .map(|&i| h[i] * flight.active.iter().map(|&j| point.covariance[i][j] * h[j]).sum::<f64>())
                .sum();
            let by: Vec<f64> =
                (0..m).map(|c| flight.active.iter().map(|&i| h[i] * point.by[i * m + c]).sum()).collect();
            let errors: f64 = (0..m).map(|a| by[a] * (0..m).map(|b| covariance[(a, b)] * by[b]).sum::<f64>()).sum();
            noise.max(0.0) + errors.max(0.0)
        };
        values.push(outputs);
        stds.push(std::array::from_fn(|i| variance(&by_state[i]).sqrt()));
        let shown = kinematics.shown(&point.state, &theta, &|delay| super::filter::before(flight, k, delay));
        for (list, value) in modelled.iter_mut().zip(shown.outputs) {
            list.push(value);
        }
    }
    let fit = (0..OUTPUTS)
        .filter(|i| flight.levels.outputs[*i].is_some())
        .filter_map(|i| {
            let measured: Vec<f64> = flight.outputs.iter().map(|y| y[i]).collect();
            OutputFit::of(OUTPUT_CHANNELS[i], &measured, &modelled[i])
        })
        .collect();
    let shown = [
        ("true_airspeed", "m/s"),
        ("alpha", "rad"),
        ("beta", "rad"),
        ("phi", "rad"),
        ("theta", "rad"),
        ("psi", "rad"),
        ("north", "m"),
        ("east", "m"),
        ("altitude", "m"),
    ];
    let channels = shown
        .into_iter()
        .enumerate()
        .filter(|(i, (name, _))| *name == "alpha" || flight.levels.outputs[*i].is_some())
        .map(|(i, (name, unit))| Reconstructed {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values: at_record(flight, &values.iter().map(|v| v[i]).collect::<Vec<_>>()),
            std_error: at_record(flight, &stds.iter().map(|v| v[i]).collect::<Vec<_>>()),
        })
        .collect();
    (channels, fit)
}

/// Values at the times of the record, on straight lines between those of the filter; NaN in gaps.
fn at_record(flight: &Flight, values: &[f64]) -> Vec<f64> {
    let reach = 0.02_f64.max(1.01 * phugoid_flight_data::statistics::median_step(&flight.time).unwrap_or(0.0));
    flight
        .record_time
        .iter()
        .map(|t| {
            let after = flight.time.partition_point(|s| s < t);
            let before = after.checked_sub(1);
            match (before, flight.time.get(after)) {
                (Some(b), Some(s)) if !flight.fresh[after] => {
                    let part = (t - flight.time[b]) / (s - flight.time[b]);
                    values[b] + part * (values[after] - values[b])
                }
                (_, Some(s)) if s - t <= reach => values[after],
                (Some(b), _) if t - flight.time[b] <= reach => values[b],
                _ => f64::NAN,
            }
        })
        .collect()
}
