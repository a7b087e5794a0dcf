//! The candidate terms that a model may lack.

use phugoid_flight_data::record::Record;

use crate::core::axes::Group;
use crate::core::term::{Coefficient, EXTRA_INPUTS, Term, Variable};
use crate::model_file::{Base, ModelFile, Parameter, Role};

/// A term that the model does not have.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) coefficient: Coefficient,
    /// As a model file writes it, where `input` stands under `inputs`.
    pub(super) text: String,
    /// A channel that the term needs as a further input.
    pub(super) input: Option<String>,
    /// Of two terms that explain a flight equally well the one with the smaller number is offered.
    pub(super) rank: u8,
}

/// First-order terms of the axes.
const FIRST: u8 = 0;
/// Squares and products.
const PRODUCT: u8 = 1;
/// Terms that are bent.
const BENT: u8 = 2;
/// Terms of the other axes.
const CROSS: u8 = 3;

/// Where in the range of the angle of attack a bend is tried, as parts of the range.
const BENDS: [f64; 3] = [0.25, 0.5, 0.75];
/// Part of the samples to each side that does not count in the range: outliers.
const BEYOND: f64 = 0.01;

impl Candidate {
    /// The term in a model with these further inputs; none where there is no place for another input.
    pub(super) fn term(&self, extra_inputs: &[String]) -> Option<Term> {
        Term::parse(&self.text, extra_inputs).ok()
    }
}

/// The terms that the coefficients of the model do not have, and whose channels the record has.
///
/// `alpha` has the angle of attack about the reference point, rad, in no order.
pub(super) fn candidates(file: &ModelFile, record: &Record, alpha: &[f64]) -> Vec<Candidate> {
    let mut list = Vec::new();
    for coefficient in Coefficient::ALL {
        if !file.axes.coefficients().contains(&coefficient) || file.terms(coefficient).next().is_none() {
            continue;
        }
        let mut library = Library { file, record, coefficient, list: Vec::new() };
        match coefficient.group() {
            Group::Longitudinal => library.longitudinal(alpha),
            Group::Lateral => library.lateral(),
        }
        list.append(&mut library.list);
    }
    list
}

struct Library<'a> {
    file: &'a ModelFile,
    record: &'a Record,
    coefficient: Coefficient,
    list: Vec<Candidate>,
}

impl Library<'_> {
    /// Lift, drag and pitching moment.
    fn longitudinal(&mut self, alpha: &[f64]) {
        for name in ["alpha", "q_hat", "v_hat", "elevator"] {
            self.own(FIRST, name);
        }
        self.further();
        for product in
            ["alpha^2", "alpha*q_hat", "alpha*v_hat", "alpha*elevator", "elevator^2", "v_hat*q_hat", "v_hat*elevator"]
        {
            self.own(PRODUCT, product);
        }
        self.own(BENT, "|elevator|");
        for at in bends(alpha) {
            let sign = if at < 0.0 { '+' } else { '-' };
            self.own(BENT, &format!("max(alpha {sign} {}, 0)", at.abs()));
        }
        for (name, channel) in
            [("beta", "beta"), ("p_hat", "p"), ("r_hat", "r"), ("aileron", "aileron"), ("rudder", "rudder")]
        {
            self.cross(name, channel, |x| x.to_owned());
        }
        self.cross("beta", "beta", |x| format!("{x}^2"));
        for (name, channel) in [("beta", "beta"), ("aileron", "aileron"), ("rudder", "rudder")] {
            self.cross(name, channel, |x| format!("|{x}|"));
        }
    }

    /// Side force, rolling and yawing moment.
    fn lateral(&mut self) {
        const OWN: [&str; 5] = ["beta", "p_hat", "r_hat", "aileron", "rudder"];
        for name in OWN {
            self.own(FIRST, name);
        }
        self.further();
        for by in ["alpha", "v_hat"] {
            for name in OWN {
                self.own(PRODUCT, &format!("{by}*{name}"));
            }
        }
        for text in ["beta*|beta|", "aileron*|aileron|", "rudder*|rudder|"] {
            self.own(BENT, text);
        }
        for text in ["alpha", "q_hat", "v_hat", "beta^2", "|beta|"] {
            self.own(CROSS, text);
        }
        self.cross("elevator", "elevator", |x| x.to_owned());
    }

    /// The first-order terms of the model's own further inputs.
    fn further(&mut self) {
        for name in &self.file.extra_inputs {
            let text = Term::parse(name, &self.file.extra_inputs).map(|t| t.text(&self.file.extra_inputs));
            if let Ok(text) = text {
                self.own(FIRST, &text);
            }
        }
    }

    /// A term of the variables that the motion knows.
    fn own(&mut self, rank: u8, text: &str) {
        let Ok(term) = Term::parse(text, &self.file.extra_inputs) else { return };
        let known = |(index, _): (usize, i32)| {
            Variable::ALL.get(index).is_none_or(|variable| self.file.axes.variables().contains(variable))
        };
        if term.powers().all(known) {
            self.add(rank, text.to_owned(), None);
        }
    }

    /// A term of a variable of the other axes, by the recorded channel where the motion does not know the variable.
    fn cross(&mut self, name: &'static str, channel: &'static str, text: impl Fn(&str) -> String) {
        let variable = Variable::ALL.into_iter().find(|v| v.name() == name);
        if variable.is_some_and(|v| self.file.axes.variables().contains(&v)) {
            self.add(CROSS, text(name), None);
        } else if self.file.extra_inputs.iter().any(|n| n == channel) {
            self.add(CROSS, text(channel), None);
        } else if self.file.extra_inputs.len() < EXTRA_INPUTS
            && self.record.channel(channel).is_some_and(|c| c.values.iter().any(|v| v.is_finite()))
        {
            self.add(CROSS, text(channel), Some(channel));
        }
    }

    fn add(&mut self, rank: u8, text: String, input: Option<&str>) {
        let inputs = with_input(&self.file.extra_inputs, input);
        let Ok(term) = Term::parse(&text, &inputs) else { return };
        let is_there = self.file.terms(self.coefficient).any(|t| *t == term);
        if !is_there {
            self.list.push(Candidate { coefficient: self.coefficient, text, input: input.map(str::to_owned), rank });
        }
    }
}

/// Angles of attack at which a bend is tried, in thousandths of a radian, each once.
fn bends(alpha: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = alpha.iter().copied().filter(|a| a.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let beyond = (BEYOND * sorted.len() as f64) as usize;
    let mut found: Vec<f64> = Vec::new();
    if let (Some(low), Some(high)) = (sorted.get(beyond), sorted.iter().rev().nth(beyond)) {
        for part in BENDS {
            let at = ((low + part * (high - low)) * 1e3).round() / 1e3;
            if !found.contains(&at) {
                found.push(at);
            }
        }
    }
    found
}

/// The inputs with one more, if it is not among them.
pub(super) fn with_input(inputs: &[String], more: Option<&str>) -> Vec<String> {
    let more = more.filter(|name| !inputs.iter().any(|n| n == name));
    inputs.iter().cloned().chain(more.map(str::to_owned)).collect()
}

/// The model with further terms, each last of its coefficient's, and what they need. `None` where they need more inputs
/// than there is place for. `speed` (m/s) becomes the reference speed where a term needs one and the file has none.
pub(super) fn with_terms(file: &ModelFile, terms: &[(&Candidate, f64)], speed: f64) -> Option<ModelFile> {
    let mut with = file.clone();
    for (candidate, prior_std) in terms {
        with.extra_inputs = with_input(&with.extra_inputs, candidate.input.as_deref());
        if with.extra_inputs.len() > EXTRA_INPUTS {
            return None;
        }
        let coefficient = candidate.coefficient;
        let term = candidate.term(&with.extra_inputs)?;
        if term.powers().any(|(index, _)| index == Variable::Airspeed.index()) {
            with.aircraft.reference_speed.get_or_insert(speed);
        }
        let of_same = |p: &Parameter| matches!(&p.role, Role::Term(c, _) if *c == coefficient);
        let place = with.parameters.iter().rposition(of_same).map_or(0, |last| last + 1);
        let name = term.parameter_name(coefficient, file.base != Base::None, &with.extra_inputs);
        let parameter = Parameter {
            name,
            role: Role::Term(coefficient, term),
            start: 0.0,
            prior_std: *prior_std,
            bounds: None,
            change_std: None,
            fixed: false,
        };
        with.parameters.insert(place, parameter);
    }
    Some(with)
}

/// The next of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten: a number for a model file. `None` for a value that is
/// not positive and finite.
pub(crate) fn round_up(value: f64) -> Option<f64> {
    if !(value.is_finite() && value > 0.0) {
        return None;
    }
    // Written as decimals, so that the line in the model file is the number that was used.
    let exponent = value.log10().floor() as i32;
    let written = |digits: &f64| format!("{digits}e{exponent}").parse::<f64>().ok();
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].iter().filter_map(written).find(|rounded| *rounded >= value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn priors_are_round_and_no_smaller() {
        for (value, rounded) in [(3.3, 4.0), (0.0101, 0.015), (1.0, 1.0), (9.5, 10.0), (173.0, 200.0)] {
            assert_eq!(round_up(value), Some(rounded));
        }
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(round_up), [None; 3]);
    }

    #[test]
    fn bends_lie_inside_the_range_and_are_no_two_the_same() {
        let alpha: Vec<f64> = (0..1000).map(|k| 0.0001 * f64::from(k)).collect();
        // The outermost samples do not count: the range is 0.001 to 0.0989.
        assert_eq!(bends(&alpha), [0.025, 0.05, 0.074]);
        assert_eq!(bends(&[0.0301; 50]), [0.03]);
        assert_eq!(bends(&[f64::NAN]), [0.0; 0]);
    }
}
