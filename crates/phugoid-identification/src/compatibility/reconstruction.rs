//! The motion that the inertial sensors and the estimated errors give, with its standard error.

use nalgebra::DMatrix;
use phugoid_estimators::{Input, Model};

use super::kinematics::{Inertial, Kinematics, PARAMETERS, STATES};
use crate::batch::{BatchFit, UnknownKind};

/// A channel of the reconstructed motion at the centre of gravity, without the errors of its sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconstructed {
    /// Canonical name of the channel, e.g. `alpha`.
    pub name: String,
    /// SI unit as printed, e.g. `rad`.
    pub unit: String,
    /// Reconstructed values, one per sample, SI.
    pub values: Vec<f64>,
    /// One-sigma error that the estimated biases and initial states leave, by sample.
    pub std_error: Vec<f64>,
}

type Point = ([f64; STATES], [f64; PARAMETERS]);

/// Reconstructs what the record has channels for, and the angle of attack always.
pub(super) fn reconstruct(
    model: &Kinematics,
    time: &[f64],
    inputs: &[Inertial],
    fit: &BatchFit,
    present: &[String],
) -> Vec<Reconstructed> {
    let mut state = [0.0; STATES];
    let given = fit.manoeuvres.first().map(|m| m.initial_state.as_slice()).unwrap_or_default();
    state.iter_mut().zip(given).for_each(|(s, v)| *s = *v);
    let mut parameters = [0.0; PARAMETERS];
    parameters.iter_mut().zip(&fit.parameters).for_each(|(s, v)| *s = *v);
    let best = simulated(model, time, inputs, &(state, parameters));
    // Covariance with the correction for colour; a factor of it moves the unknowns one by one.
    let count = fit.unknowns.len();
    let widening: Vec<f64> = fit.unknowns.iter().map(|u| (u.corrected_std_error / u.std_error).max(1.0)).collect();
    let covariance = DMatrix::from_fn(count, count, |i, j| fit.covariance[i][j] * widening[i] * widening[j]);
    let mut variance = vec![[0.0; STATES]; time.len()];
    if let Some(factor) = covariance.cholesky().map(|c| c.l()) {
        for j in 0..count {
            let mut moved = (state, parameters);
            for (i, unknown) in fit.unknowns.iter().enumerate() {
                match unknown.kind {
                    UnknownKind::Parameter { index } => moved.1[index] += factor[(i, j)],
                    UnknownKind::InitialState { state, .. } => moved.0[state] += factor[(i, j)],
                    _ => {}
                }
            }
            for ((v, a), b) in variance.iter_mut().zip(simulated(model, time, inputs, &moved)).zip(&best) {
                for i in 0..STATES {
                    v[i] += (a[i] - b[i]).powi(2);
                }
            }
        }
    }
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
    shown
        .into_iter()
        .enumerate()
        .filter(|(_, (name, _))| *name == "alpha" || present.iter().any(|p| p == name))
        .map(|(i, (name, unit))| Reconstructed {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values: best.iter().map(|y| y[i]).collect(),
            std_error: variance.iter().map(|v| v[i].sqrt()).collect(),
        })
        .collect()
}

/// Airspeed, alpha, beta and the other states by sample.
fn simulated(model: &Kinematics, time: &[f64], inputs: &[Inertial], (state, parameters): &Point) -> Vec<[f64; STATES]> {
    let rates = |x: &[f64; STATES], u: &Inertial| model.rates(x, parameters, u);
    let plus =
        |x: &[f64; STATES], h: f64, k: &[f64; STATES]| -> [f64; STATES] { std::array::from_fn(|i| x[i] + h * k[i]) };
    let mut x = *state;
    let mut out = Vec::with_capacity(time.len());
    for k in 0..time.len() {
        let [u, v, w, ..] = x;
        let mut y = x;
        y[0] = (u * u + v * v + w * w).sqrt();
        y[1] = w.atan2(u);
        y[2] = v.atan2((u * u + w * w).sqrt());
        out.push(y);
        if k + 1 < time.len() {
            let h = time[k + 1] - time[k];
            let middle = inputs[k].interpolate(&inputs[k + 1], 0.5);
            let k1 = rates(&x, &inputs[k]);
            let k2 = rates(&plus(&x, 0.5 * h, &k1), &middle);
            let k3 = rates(&plus(&x, 0.5 * h, &k2), &middle);
            let k4 = rates(&plus(&x, h, &k3), &inputs[k + 1]);
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
    }
    out
}
