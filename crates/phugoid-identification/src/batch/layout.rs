//! The order of the unknowns in the vector that the search moves.

use super::followed::Followed;
use super::problem::{Bias, Manoeuvre, Structure};
use super::result::UnknownKind;
use super::start::Stretch;
use crate::core::options::CAPACITY;

/// One free unknown: one entry of the vector that the search moves.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) kind: UnknownKind,
    pub(crate) name: String,
    pub(crate) start: f64,
    /// Standard deviation of what is known beforehand, about `start`; infinite where nothing is known.
    pub(crate) prior_std: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

/// The free unknowns in order, and the values of the others.
#[derive(Clone, Debug)]
pub(crate) struct Layout<const N: usize> {
    pub(crate) places: Vec<Place>,
    /// Parameters where they are fixed or start.
    parameters: [f64; CAPACITY],
    /// What is integrated, with the initial states where they are held or start, by manoeuvre.
    stretches: Vec<Vec<Stretch<N>>>,
    /// What states follow in place of being integrated, by manoeuvre; empty where all are integrated.
    followed: Vec<Followed<N>>,
}

impl<const N: usize> Layout<N> {
    /// Free parameters, then shared biases, then by manoeuvre its free initial states, stretch by stretch, and biases.
    pub(crate) fn new<const R: usize>(
        structure: &Structure<N, R>,
        manoeuvres: &[Manoeuvre<'_, N, R>],
        stretches: Vec<Vec<Stretch<N>>>,
    ) -> Self {
        let mut parameters = [0.0; CAPACITY];
        let mut places = Vec::new();
        for (j, p) in structure.parameters.iter().enumerate().take(CAPACITY) {
            parameters[j] = p.start;
            if !p.fixed {
                let prior_std = p.prior_std.unwrap_or(f64::INFINITY);
                let (name, kind) = (p.name.clone(), UnknownKind::Parameter { index: j });
                places.push(Place { kind, name, start: p.start, prior_std, lower: p.lower, upper: p.upper });
            }
        }
        let unbounded = |kind, name, start, prior_std| Place {
            kind,
            name,
            start,
            prior_std,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
        };
        let used = Structure::used(manoeuvres);
        for (i, channel) in structure.outputs.iter().enumerate().filter(|(i, _)| used[*i]) {
            if let Bias::Shared(std) = channel.bias {
                let kind = UnknownKind::Bias { output: i, manoeuvre: None };
                places.push(unbounded(kind, format!("bias of {}", channel.name), 0.0, std));
            }
        }
        for (m, manoeuvre) in manoeuvres.iter().enumerate() {
            let of = if manoeuvres.len() > 1 { format!(" in {}", manoeuvre.name) } else { String::new() };
            for (n, stretch) in stretches[m].iter().enumerate() {
                let at = match stretch.from {
                    0 => String::new(),
                    from => format!(" after the gap to {:.2} s", manoeuvre.time_s[from]),
                };
                for (i, state) in structure.states.iter().enumerate().filter(|(_, s)| s.free) {
                    let kind = UnknownKind::InitialState { state: i, manoeuvre: m, stretch: n };
                    let name = format!("initial {}{at}{of}", state.name);
                    places.push(unbounded(kind, name, stretch.state[i], f64::INFINITY));
                }
            }
            for (i, channel) in structure.outputs.iter().enumerate() {
                if let Bias::PerManoeuvre(std) = channel.bias
                    && manoeuvre.outputs.iter().any(|y| y[i].is_finite())
                {
                    let kind = UnknownKind::Bias { output: i, manoeuvre: Some(m) };
                    places.push(unbounded(kind, format!("bias of {}{of}", channel.name), 0.0, std));
                }
            }
        }
        Self { places, parameters, stretches, followed: Vec::new() }
    }

    /// The same with states that follow what was measured, one entry per manoeuvre.
    pub(crate) fn following(self, followed: Vec<Followed<N>>) -> Self {
        Self { followed, ..self }
    }

    /// What states of a manoeuvre follow in place of being integrated; none where all are integrated.
    pub(crate) fn followed(&self, manoeuvre: usize) -> Option<&Followed<N>> {
        self.followed.get(manoeuvre)
    }

    pub(crate) fn start(&self) -> Vec<f64> {
        self.places.iter().map(|p| p.start).collect()
    }

    /// All parameters of the model.
    pub(crate) fn parameters(&self, unknowns: &[f64]) -> [f64; CAPACITY] {
        let mut parameters = self.parameters;
        for (place, value) in self.places.iter().zip(unknowns) {
            if let UnknownKind::Parameter { index } = place.kind {
                parameters[index] = *value;
            }
        }
        parameters
    }

    /// What is integrated of a manoeuvre, with its initial states; in order of time, at least one.
    pub(crate) fn stretches(&self, manoeuvre: usize, unknowns: &[f64]) -> Vec<Stretch<N>> {
        let mut stretches = self.stretches[manoeuvre].clone();
        for (place, value) in self.places.iter().zip(unknowns) {
            match place.kind {
                UnknownKind::InitialState { state, manoeuvre: m, stretch } if m == manoeuvre => {
                    stretches[stretch].state[state] = *value;
                }
                _ => {}
            }
        }
        stretches
    }

    /// The constant errors of the outputs in a manoeuvre.
    pub(crate) fn biases<const R: usize>(&self, manoeuvre: usize, unknowns: &[f64]) -> [f64; R] {
        let mut biases = [0.0; R];
        for (place, value) in self.places.iter().zip(unknowns) {
            match place.kind {
                UnknownKind::Bias { output, manoeuvre: m } if m.is_none_or(|m| m == manoeuvre) => {
                    biases[output] = *value;
                }
                _ => {}
            }
        }
        biases
    }

    /// Positions of the unknowns that a manoeuvre depends on.
    pub(crate) fn columns(&self, manoeuvre: usize) -> Vec<usize> {
        let concerns = |kind: UnknownKind| match kind {
            UnknownKind::InitialState { manoeuvre: m, .. } => m == manoeuvre,
            UnknownKind::Bias { manoeuvre: m, .. } => m.is_none_or(|m| m == manoeuvre),
            _ => true,
        };
        (0..self.places.len()).filter(|&j| concerns(self.places[j].kind)).collect()
    }
}
