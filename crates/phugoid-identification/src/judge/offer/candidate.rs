//! The candidate terms that are tried, and the priors of their parameters.

use phugoid_flight_data::printable::toml_string;

use super::amplitude::Amplitudes;
use crate::core::estimation::ParameterResult;
use crate::core::term::{Coefficient, Term, Variable};
use crate::model_file::{Base, ModelFile, Parameter, Role};

/// In absolute form a plausible change is this part of the parameter, as for the change detector.
const PLAUSIBLE_CHANGE: f64 = 0.5;

/// A term that the model does not have.
pub(super) struct Candidate {
    pub(super) coefficient: Coefficient,
    pub(super) term: Term,
    /// Its parameter: start zero, bounds from the amplitudes of the flight.
    pub(super) parameter: Parameter,
}

impl Candidate {
    /// The model with the term, its parameter last of its coefficient's.
    pub(super) fn model(&self, file: &ModelFile) -> ModelFile {
        let mut with = file.clone();
        let of_same = |p: &Parameter| matches!(&p.role, Role::Term(c, _) if *c == self.coefficient);
        let place = with.parameters.iter().rposition(of_same).map_or(0, |last| last + 1);
        with.parameters.insert(place, self.parameter.clone());
        with
    }

    /// The line that a user puts under `[coefficients]` to add the term.
    pub(super) fn coefficient_line(&self, file: &ModelFile) -> String {
        let there = terms_of(file, self.coefficient).map(|(_, term)| term);
        let words: Vec<String> =
            there.chain([&self.term]).map(|term| toml_string(&term.text(&file.extra_inputs))).collect();
        format!("{} = [{}]", self.coefficient.symbol(), words.join(", "))
    }

    /// The line that a user puts under `[parameters]` to give the term its prior.
    pub(super) fn parameter_line(&self, file: &ModelFile) -> String {
        let [lower, upper] = self.parameter.bounds.unwrap_or_default();
        let start = if file.base == Base::None { "start = 0, " } else { "" };
        let name = &self.parameter.name;
        let is_bare = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
        let key = if is_bare { name.clone() } else { toml_string(name) };
        format!("{key} = {{ {start}bounds = [{lower}, {upper}] }}")
    }
}

/// The products of the angle of attack with each variable that a coefficient has a first-order term in (`alpha^2`,
/// `alpha*q_hat`, `alpha*elevator`, `alpha*beta`, ...) and that the model does not have yet.
pub(super) fn candidates(file: &ModelFile, found: &[ParameterResult], amplitudes: &Amplitudes) -> Vec<Candidate> {
    let mut candidates: Vec<Candidate> = Vec::new();
    if !file.axes.variables().contains(&Variable::Alpha) {
        return candidates;
    }
    for coefficient in Coefficient::ALL {
        let largest = terms_of(file, coefficient)
            .map(|(parameter, term)| plausible_change(parameter, file, found) * amplitudes.spread(term))
            .fold(0.0, f64::max);
        for (_, first_order) in terms_of(file, coefficient) {
            let [(variable, 1)] = first_order.factors() else { continue };
            if *variable == Variable::AlphaRate.index() {
                continue;
            }
            let term = Term::parse(Variable::Alpha.name(), &[]).unwrap_or_default().times(first_order);
            let half_width = round_up(2.0 * largest / amplitudes.spread(&term));
            let is_there = terms_of(file, coefficient).any(|(_, t)| *t == term);
            if let (false, Some(half_width)) = (is_there, half_width) {
                let name = term.parameter_name(coefficient, file.base != Base::None, &file.extra_inputs);
                let parameter = Parameter {
                    name,
                    role: Role::Term(coefficient, term.clone()),
                    start: 0.0,
                    // The prior that a model file with these bounds would give.
                    prior_std: 0.5 * half_width,
                    bounds: Some([-half_width, half_width]),
                    change_std: None,
                    fixed: false,
                };
                candidates.push(Candidate { coefficient, term, parameter });
            }
        }
    }
    candidates
}

fn terms_of(file: &ModelFile, coefficient: Coefficient) -> impl Iterator<Item = (&Parameter, &Term)> {
    file.parameters.iter().filter_map(move |p| match &p.role {
        Role::Term(c, term) if *c == coefficient => Some((p, term)),
        _ => None,
    })
}

/// One sigma of a plausible change of a term's parameter; zero for one that is known and for the constant term.
fn plausible_change(parameter: &Parameter, file: &ModelFile, found: &[ParameterResult]) -> f64 {
    let own_size = || {
        let value = found.iter().find(|f| f.name == parameter.name).map_or(0.0, |f| f.value.abs());
        let quarter = parameter.bounds.map_or(f64::INFINITY, |[lower, upper]| 0.25 * (upper - lower));
        (PLAUSIBLE_CHANGE * value).min(quarter)
    };
    match (parameter.fixed, parameter.change_std, file.base) {
        (true, ..) => 0.0,
        (_, Some(change_std), _) => change_std,
        (_, None, Base::F16) => parameter.prior_std,
        (_, None, Base::None) => own_size(),
    }
}

/// The next of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten: a number for a model file. `None` for a value that is
/// not positive and finite.
fn round_up(value: f64) -> Option<f64> {
    if !(value.is_finite() && value > 0.0) {
        return None;
    }
    // Written as decimals, so that the line in the model file is the number that was tried.
    let exponent = value.log10().floor() as i32;
    let written = |digits: &f64| format!("{digits}e{exponent}").parse::<f64>().ok();
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].iter().filter_map(written).find(|rounded| *rounded >= value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_round_and_no_smaller() {
        for (value, rounded) in [(3.3, 4.0), (0.0101, 0.015), (1.0, 1.0), (9.5, 10.0), (173.0, 200.0)] {
            assert_eq!(round_up(value), Some(rounded));
        }
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(round_up), [None; 3]);
    }
}
