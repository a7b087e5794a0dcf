//! A plant of a user's own, given by formulas.

use std::collections::BTreeMap;
use std::sync::Arc;

use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_flight_dynamics::scalar::Dual;
use phugoid_simulation::scenario::nearest;
use serde::Deserialize;

use crate::expression::{Function, Meaning, Node, parse};

/// The most states of a plant of one's own.
pub const MOST_STATES: usize = 4;
/// The most unknown parameters: what the printed laws can carry.
pub const MOST_PARAMETERS: usize = 2;
/// The most constants.
const MOST_CONSTANTS: usize = 50;
/// The longest name, characters.
const LONGEST_NAME: usize = 40;
/// Derivatives of formulas: by the states and the parameters.
const DERIVATIVES: usize = MOST_STATES + MOST_PARAMETERS;

/// A plant of one's own, `x' = f(x, u, t) + Phi(x, u, t) theta`, whose rates are formulas. Times are seconds; states, input,
/// parameters and constants are in units of the user's choice. Measured are all states, or what `outputs` says, and as the last
/// output the rate of the last state whose rate contains an unknown parameter.
///
/// In the file of a case:
///
/// ```toml
/// [plant]
/// type = "own"
/// states = ["x", "v"]                        # one to four
/// parameters = ["k"]                         # one or two, the unknown ones
/// constants = { m = 2.0, c = 0.3 }
/// rates.x = "v"                              # the input of `[input]` is `u`, the time is `t`
/// rates.v = "(u - k*x - c*v*abs(v)) / m"
/// start = { x = 0.1 }                        # zero, where it is not given
/// outputs.position = "x"                     # what is measured, at most one per state; all states if left out
/// ```
///
/// Formulas are made of numbers, names, `+ - * / ^`, parentheses, `pi` and the functions sin, cos, tan, asin, acos, atan, sinh,
/// cosh, tanh, exp, ln, sqrt and abs. The parameters have to stand in them linearly. Input and time are held from one sample to
/// the next.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "File")]
pub struct OwnPlant {
    file: Arc<File>,
    /// One per state.
    rates: Arc<[Node]>,
    /// What is measured beside the rate: the states, or what the file says.
    outputs: Arc<[Node]>,
    /// States whose rates contain an unknown parameter, in order; never empty.
    carriers: Vec<usize>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    states: Vec<String>,
    parameters: Vec<String>,
    #[serde(default)]
    constants: BTreeMap<String, f64>,
    rates: BTreeMap<String, String>,
    #[serde(default)]
    start: BTreeMap<String, f64>,
    #[serde(default)]
    outputs: BTreeMap<String, String>,
}

/// Where the variables of the formulas stand: states, parameters, input, time.
const INPUT: usize = DERIVATIVES;
const TIME: usize = DERIVATIVES + 1;

fn parameter_place(index: usize) -> usize {
    MOST_STATES + index
}

fn is_parameter(place: usize) -> bool {
    (MOST_STATES..DERIVATIVES).contains(&place)
}

impl TryFrom<File> for OwnPlant {
    type Error = String;

    fn try_from(file: File) -> Result<Self, String> {
        check_names(&file)?;
        let mut names = vec![
            ("u", Meaning::Variable(INPUT)),
            ("t", Meaning::Variable(TIME)),
            ("pi", Meaning::Constant(std::f64::consts::PI)),
        ];
        names.extend(file.states.iter().enumerate().map(|(i, name)| (name.as_str(), Meaning::Variable(i))));
        let parameters = file.parameters.iter().enumerate();
        names.extend(parameters.map(|(j, name)| (name.as_str(), Meaning::Variable(parameter_place(j)))));
        names.extend(file.constants.iter().map(|(name, value)| (name.as_str(), Meaning::Constant(*value))));
        let read = |place: String, text: &str| {
            let node = parse(text, &names).map_err(|error| format!("`{place}`, {error}"))?;
            match node.is_linear_in(&is_parameter) {
                true => Ok(node),
                false => Err(format!(
                    "`{place}` is not linear in the unknown parameters ({}), as f + Phi theta has to be: they may stand in sums and \
                     be multiplied by what contains none of them. Give a product or function of them a name of its own and make \
                     that the unknown",
                    file.parameters.join(", ")
                )),
            }
        };
        let mut rates = Vec::new();
        for state in &file.states {
            let text = file.rates.get(state).ok_or_else(|| {
                format!("`plant.rates.{state}` is missing: every state needs the formula of its rate")
            })?;
            rates.push(read(format!("plant.rates.{state}"), text)?);
        }
        let outputs: Vec<Node> = match file.outputs.is_empty() {
            true => (0..file.states.len()).map(Node::Variable).collect(),
            false => file
                .outputs
                .iter()
                .map(|(name, text)| read(format!("plant.outputs.{name}"), text))
                .collect::<Result<_, String>>()?,
        };
        if outputs.len() > file.states.len() {
            return Err(format!(
                "`plant.outputs` has {} formulas, and at most as many are read as there are states, {}",
                outputs.len(),
                file.states.len()
            ));
        }
        for (j, name) in file.parameters.iter().enumerate() {
            if !rates.iter().any(|rate| rate.contains(&|place| place == parameter_place(j))) {
                return Err(format!("the parameter `{name}` stands in no rate, so that nothing can be learnt of it"));
            }
        }
        let carries = |(i, rate): (usize, &Node)| rate.contains(&is_parameter).then_some(i);
        let carriers = rates.iter().enumerate().filter_map(carries).collect();
        Ok(Self { file: Arc::new(file), rates: rates.into(), outputs: outputs.into(), carriers })
    }
}

/// Checks how many names there are, that each is one, and that no two things have the same.
fn check_names(file: &File) -> Result<(), String> {
    let count = |what: &str, found: usize, most: usize| match found {
        1.. if found <= most => Ok(()),
        _ => Err(format!("`plant.{what}` has {found} names, and one to {most} can be read")),
    };
    count("states", file.states.len(), MOST_STATES)?;
    count("parameters", file.parameters.len(), MOST_PARAMETERS)?;
    if file.constants.len() > MOST_CONSTANTS {
        return Err(format!(
            "`plant.constants` has {} names, and at most {MOST_CONSTANTS} can be read",
            file.constants.len()
        ));
    }
    let mut seen: Vec<&str> = Vec::new();
    let named = file.states.iter().chain(&file.parameters).chain(file.constants.keys());
    for (name, is_variable) in named.map(|name| (name, true)).chain(file.outputs.keys().map(|name| (name, false))) {
        let begins = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let goes_on = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && name.len() <= LONGEST_NAME;
        if !(begins && goes_on) {
            return Err(format!(
                "`{}` is no name: letters without accents, digits and `_`, a letter first, at most {LONGEST_NAME}",
                name.chars().take(LONGEST_NAME).collect::<String>().escape_debug()
            ));
        }
        if !is_variable {
            continue;
        }
        if ["u", "t", "pi"].contains(&name.as_str()) || Function::named(name).is_some() {
            return Err(format!(
                "`{name}` cannot be the name of anything else: u is the input, t the time, pi and functions are taken"
            ));
        }
        if seen.contains(&name.as_str()) {
            return Err(format!("`{name}` names two things: states, parameters and constants need different names"));
        }
        seen.push(name);
    }
    if let Some((name, value)) = file.constants.iter().find(|(_, value)| !value.is_finite()) {
        return Err(format!("`plant.constants.{name}` must be finite, found {value}"));
    }
    for (table, keys) in [("rates", file.rates.keys().collect::<Vec<_>>()), ("start", file.start.keys().collect())] {
        if let Some(unknown) = keys.into_iter().find(|key| !file.states.contains(key)) {
            let near = nearest(unknown, file.states.iter().map(String::as_str));
            let hint = near.map_or_else(
                || format!("the states are {}", file.states.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            return Err(format!("`plant.{table}.{unknown}`: the plant has no state `{unknown}`: {hint}"));
        }
    }
    if let Some((name, value)) = file.start.iter().find(|(_, value)| !value.is_finite()) {
        return Err(format!("`plant.start.{name}` must be finite, found {value}"));
    }
    Ok(())
}

impl OwnPlant {
    /// Names of the states, in the order of the file.
    pub fn states(&self) -> Vec<&str> {
        self.file.states.iter().map(String::as_str).collect()
    }

    /// Names of the unknown parameters, in the order of the file.
    pub fn parameters(&self) -> Vec<&str> {
        self.file.parameters.iter().map(String::as_str).collect()
    }

    /// States at the beginning of the record, in the order of [`OwnPlant::states`].
    pub fn start(&self) -> Vec<f64> {
        self.file.states.iter().map(|name| self.file.start.get(name).copied().unwrap_or(0.0)).collect()
    }

    /// Its equations as they are written in the file: `x' = v, v' = (u - k*x)/m`.
    pub fn equation(&self) -> String {
        let equations =
            self.file.states.iter().filter_map(|name| Some(format!("{name}' = {}", self.file.rates.get(name)?)));
        equations.collect::<Vec<_>>().join(", ")
    }

    /// The output that is a state and nothing else; `None` for a state that is not measured by itself.
    pub fn measured(&self, state: usize) -> Option<usize> {
        self.outputs.iter().position(|output| *output == Node::Variable(state))
    }

    /// Number of outputs before the rate.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The last state whose rate contains an unknown parameter.
    pub fn carrier(&self) -> usize {
        self.carriers.last().copied().unwrap_or_default()
    }

    /// Whether every state is measured by itself, as the laws need it.
    pub fn measures_all(&self) -> bool {
        (0..self.states().len()).all(|state| self.measured(state) == Some(state))
    }

    /// Why the printed laws cannot be run on it, as a sentence; `None` where they can.
    pub fn without_laws(&self) -> Option<String> {
        let unmeasured = self.states().into_iter().enumerate().find(|(i, _)| self.measured(*i) != Some(*i));
        if let Some((_, state)) = unmeasured {
            return Some(format!(
                "The printed laws and the extended law are not run: they need every state measured, and `outputs` does not give \
                 {state} by itself, in the order of the states."
            ));
        }
        let names: Vec<&str> = self.carriers.iter().filter_map(|i| Some(self.file.states.get(*i)?.as_str())).collect();
        match (self.parameters().len(), names.as_slice()) {
            (_, several) if several.len() > 1 => Some(format!(
                "The printed laws are not run: they are given the rate of one state, and here the rates of {} contain unknown \
                 parameters.",
                several.join(" and ")
            )),
            (2, _) if !self.is_second_order() => Some(
                "The printed laws for two parameters are not run: they are those of x'' = f + Phi theta. Two states are needed, \
                 the rate of the first being the second (rates.x = \"v\"), and the parameters in the rate of the second."
                    .to_owned(),
            ),
            _ => None,
        }
    }

    /// Whether it is `x' = v`, `v' = f + Phi theta`.
    fn is_second_order(&self) -> bool {
        self.rates.len() == 2 && self.rates.first() == Some(&Node::Variable(1)) && self.carriers == [1]
    }

    /// The plant as a model of `N` states; `N` is the number of its states.
    pub(crate) fn model(&self) -> OwnModel<'_> {
        let (rates, outputs, parameters) = (&self.rates, &self.outputs, self.file.parameters.len());
        OwnModel { rates, outputs, parameters, carrier: self.carrier() }
    }
}

/// An [`OwnPlant`] as the estimators take it. Input: `u` and the time, s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OwnModel<'a> {
    rates: &'a [Node],
    outputs: &'a [Node],
    parameters: usize,
    carrier: usize,
}

/// The variables of the formulas, with derivatives by states and parameters if `D` has room for them.
fn variables<const D: usize>(x: &[f64], theta: &[f64], u: &[f64; 2]) -> [Dual<D>; DERIVATIVES + 2] {
    let mut variables = [Dual::<D>::from(0.0); DERIVATIVES + 2];
    for (place, value) in x.iter().enumerate().take(MOST_STATES) {
        variables[place] = Dual::variable(*value, place);
    }
    for (j, value) in theta.iter().enumerate().take(MOST_PARAMETERS) {
        variables[parameter_place(j)] = Dual::variable(*value, parameter_place(j));
    }
    (variables[INPUT], variables[TIME]) = (Dual::from(u[0]), Dual::from(u[1]));
    variables
}

impl<const N: usize, const R: usize, const P: usize> Model<N, R, P> for OwnModel<'_> {
    type Input = [f64; 2];

    fn parameter_count(&self) -> usize {
        self.parameters
    }

    fn rates(&self, x: &[f64; N], theta: &[f64; P], u: &[f64; 2]) -> [f64; N] {
        let variables = variables::<0>(x, theta, u);
        std::array::from_fn(|i| self.rates.get(i).map_or(f64::NAN, |rate| rate.at(&variables).value))
    }

    fn linearized_rates(&self, x: &[f64; N], theta: &[f64; P], u: &[f64; 2], out: &mut LinearizedRates<N, P>) {
        const { assert!(N <= MOST_STATES && P >= MOST_PARAMETERS && R == N + 1, "states, a rate, and room for parameters") };
        let variables = variables::<DERIVATIVES>(x, theta, u);
        for (i, rate) in self.rates.iter().enumerate().take(N) {
            let rate = rate.at(&variables);
            out.rates[i] = rate.value;
            out.state_jacobian[i].copy_from_slice(&rate.derivatives[..N]);
            out.regressors[i] = [0.0; P];
            out.regressors[i][..MOST_PARAMETERS].copy_from_slice(&rate.derivatives[MOST_STATES..]);
        }
    }

    fn linearized_outputs(&self, x: &[f64; N], theta: &[f64; P], u: &[f64; 2], out: &mut LinearizedOutputs<N, R, P>) {
        let variables = variables::<DERIVATIVES>(x, theta, u);
        *out = LinearizedOutputs::ZERO;
        // Fewer outputs than states: those between them and the rate are never measured.
        out.outputs = [f64::NAN; R];
        let formulas =
            self.outputs.iter().take(N).enumerate().chain(self.rates.get(self.carrier).map(|rate| (N, rate)));
        for (r, formula) in formulas {
            let output = formula.at(&variables);
            out.outputs[r] = output.value;
            out.state_jacobian[r].copy_from_slice(&output.derivatives[..N]);
            out.parameter_jacobian[r][..MOST_PARAMETERS].copy_from_slice(&output.derivatives[MOST_STATES..]);
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        self.outputs.iter().position(|output| *output == Node::Variable(state))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::{FirstOrderNonlinear, SecondOrderNonlinear};

    fn plant(text: &str) -> Result<OwnPlant, String> {
        toml::from_str(text).map_err(|error| error.message().to_owned())
    }

    /// The thesis's plants, written as formulas, are its plants: rates and all derivatives.
    #[test]
    fn formulas_of_the_thesis_are_its_plants() {
        let first = plant(
            "states = ['x', 'y']\nparameters = ['a']\nconstants = { B = 1.4, C = -4.0, w = 0.7 }\n\
             rates.x = '-a*sin(y)*x + B*u'\nrates.y = 'C*y*x + sin(w*t)'",
        );
        let second =
            plant("states = ['x', 'v']\nparameters = ['a1', 'a2']\nrates.x = 'v'\nrates.v = '-a2*v - a1*x^2 + u'");
        let (first, second) = (first.unwrap(), second.unwrap());
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14 * b.abs().max(1.0), "{a} {b}");
        for k in 0..50 {
            let (x, theta, t) =
                ([(0.7 * f64::from(k)).sin(), (1.3 * f64::from(k)).cos()], [3.0, -1.5], 0.1 * f64::from(k));
            let (mut ours, mut theirs) = (LinearizedOutputs::<2, 3, 2>::ZERO, LinearizedOutputs::<2, 3, 2>::ZERO);
            for built_in in [true, false] {
                if built_in {
                    let forcing = libm::sin(0.7 * t);
                    FirstOrderNonlinear::default().linearized_outputs(&x, &theta, &[0.4, forcing], &mut theirs);
                    first.model().linearized_outputs(&x, &theta, &[0.4, t], &mut ours);
                } else {
                    // The measured rate is that of the second state here.
                    SecondOrderNonlinear.linearized_outputs(&x, &theta, &[0.4], &mut theirs);
                    second.model().linearized_outputs(&x, &theta, &[0.4, t], &mut ours);
                }
                for r in 0..3 {
                    close(ours.outputs[r], theirs.outputs[r]);
                    for i in 0..2 {
                        close(ours.state_jacobian[r][i], theirs.state_jacobian[r][i]);
                        close(ours.parameter_jacobian[r][i], theirs.parameter_jacobian[r][i]);
                    }
                }
            }
            let rates = Model::<2, 3, 2>::rates(&second.model(), &x, &theta, &[0.4, t]);
            assert_eq!(rates[1].to_bits(), ours.outputs[2].to_bits());
        }
        assert!(first.without_laws().is_none() && second.without_laws().is_none());
        assert_eq!((first.carrier(), second.carrier()), (0, 1));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let good = "states = ['x']\nparameters = ['a']\nrates.x = '-a*x + u'\n";
        assert!(plant(good).is_ok());
        for (from, to, words) in [
            ("-a*x + u", "-a*X1 + u", "`plant.rates.x`, character 4: unknown name `X1`: did you mean `x`?"),
            ("-a*x + u", "-sqr(a)*x", "unknown function `sqr`: did you mean `sqrt`?"),
            ("-a*x + u", "-a^2*x + u", "is not linear in the unknown parameters (a)"),
            ("-a*x + u", "-x + u", "the parameter `a` stands in no rate"),
            ("rates.x", "rates.y", "`plant.rates.y`: the plant has no state `y`"),
            ("['x']", "['x', 'v']", "`plant.rates.v` is missing"),
            ("['x']", "['x', 'x']", "`x` names two things"),
            ("['a']", "['x']", "`x` names two things"),
            ("['a']", "['sin']", "`sin` cannot be the name"),
            ("['a']", "['t']", "`t` cannot be the name"),
            ("['a']", "['1a']", "`1a` is no name"),
            ("['a']", "[]", "`plant.parameters` has 0 names, and one to 2"),
            ("['a']", "['a', 'b', 'c']", "`plant.parameters` has 3 names"),
            ("['x']", "['a1','a2','a3','a4','a5']", "`plant.states` has 5 names, and one to 4"),
            ("rates.x", "start.x = nan\nrates.x", "`plant.start.x` must be finite"),
            ("rates.x", "constants.k = inf\nrates.x", "`plant.constants.k` must be finite"),
            ("rates.x", "rate.x", "unknown field `rate`"),
            ("rates.x", "outputs.y = 'x*a*a'\nrates.x", "`plant.outputs.y` is not linear"),
            ("rates.x", "outputs.y = 'z'\nrates.x", "`plant.outputs.y`, character 1: unknown name `z`"),
            ("rates.x", "outputs = { y = 'x', z = 'x^2' }\nrates.x", "has 2 formulas, and at most"),
        ] {
            let error = plant(&good.replace(from, to)).unwrap_err();
            assert!(error.contains(words), "{to}: {error}");
        }
    }

    #[test]
    fn plants_that_the_printed_laws_do_not_fit_say_why() {
        let both = plant("states = ['x', 'y']\nparameters = ['a']\nrates.x = '-a*x + u'\nrates.y = 'a*x - y'").unwrap();
        assert!(both.without_laws().unwrap().contains("the rates of x and y contain"));
        let two = plant("states = ['x']\nparameters = ['a', 'b']\nrates.x = '-a*x - b*x^3 + u'").unwrap();
        assert!(two.without_laws().unwrap().contains("x'' = f + Phi theta"));
        let position = "states = ['x', 'v']\nparameters = ['k']\nrates.x = 'v'\nrates.v = '-k*x + u'\noutputs.p = 'x'";
        let position = plant(position).unwrap();
        assert!(position.without_laws().unwrap().contains("every state measured, and `outputs` does not give v"));
        assert_eq!((position.measured(0), position.measured(1), position.outputs()), (Some(0), None, 1));
    }
}
