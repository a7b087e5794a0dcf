//! Terms of the coefficient build-up: products of powers of the flight variables.

use phugoid_flight_dynamics::scalar::Scalar;

use crate::words::did_you_mean;

/// Room for inputs of the model file beyond the elevator (flap, speed brake, ...).
pub const EXTRA_INPUTS: usize = 3;
/// Flight variables a term can be made of.
pub const FACTORS: usize = 4 + EXTRA_INPUTS;

/// A wind-axis coefficient of the longitudinal motion, made dimensional by `qbar S` (and the mean chord for `Cm`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coefficient {
    /// `CL`, positive up, perpendicular to the airspeed.
    Lift,
    /// `CD`, positive aft, along the airspeed.
    Drag,
    /// `Cm` about the centre of gravity, positive nose up.
    PitchingMoment,
}

impl Coefficient {
    /// All, in the order `CL`, `CD`, `Cm`.
    pub const ALL: [Self; 3] = [Self::Lift, Self::Drag, Self::PitchingMoment];

    /// The symbol used in model files and parameter names.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Lift => "CL",
            Self::Drag => "CD",
            Self::PitchingMoment => "Cm",
        }
    }
}

/// A product of powers of flight variables; the empty product is the constant 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Term {
    /// Index of the flight variable in [`factor_names`] and its power (at least 1), each variable at most once.
    factors: Vec<(usize, i32)>,
}

/// Names of the flight variables in the order of a factor array: `alpha` (rad), `q_hat` (`q cbar / 2V`), `v_hat`
/// (`V/V0`), `elevator` (rad), and the extra inputs of the model file.
pub fn factor_names(extra_inputs: &[String]) -> impl Iterator<Item = &str> + Clone {
    ["alpha", "q_hat", "v_hat", "elevator"].into_iter().chain(extra_inputs.iter().map(String::as_str))
}

impl Term {
    /// Parses `1`, `alpha`, `alpha^2`, `alpha*elevator`, ...
    ///
    /// # Errors
    /// A sentence naming the word that is not a flight variable, or the power that is not 1 to 9.
    pub fn parse(text: &str, extra_inputs: &[String]) -> Result<Self, String> {
        let mut factors: Vec<(usize, i32)> = Vec::new();
        for word in text.split('*') {
            let word = word.trim();
            if word == "1" {
                continue;
            }
            let (name, power) = match word.split_once('^') {
                Some((name, power)) => {
                    let whole = power.trim().parse::<i32>().ok().filter(|p| (1..=9).contains(p));
                    (name.trim(), whole.ok_or_else(|| format!("`^{power}` in term `{text}`: expected a power 1 to 9"))?)
                }
                None => (word, 1),
            };
            let Some(index) = factor_names(extra_inputs).position(|n| n == name) else {
                let words = std::iter::once("1").chain(factor_names(extra_inputs));
                return Err(format!("unknown variable `{name}` in term `{text}`{}", did_you_mean(name, words)));
            };
            match factors.iter_mut().find(|(i, _)| *i == index) {
                Some((_, p)) => *p += power,
                None => factors.push((index, power)),
            }
        }
        factors.sort_unstable();
        Ok(Self { factors })
    }

    /// True for the constant term `1`.
    pub fn is_constant(&self) -> bool {
        self.factors.is_empty()
    }

    /// The flight variables (indices into [`factor_names`]) and their powers.
    pub fn factors(&self) -> &[(usize, i32)] {
        &self.factors
    }

    /// The name of the parameter that multiplies this term: the coefficient's symbol, preceded by `d` for an increment
    /// to a database, and the flight variables (`0` for the constant, `q` for `q_hat`, `V` for `v_hat`).
    pub fn parameter_name(&self, coefficient: Coefficient, increment: bool, extra_inputs: &[String]) -> String {
        let mut name = format!("{}{}", if increment { "d" } else { "" }, coefficient.symbol());
        if self.is_constant() {
            name.push_str("_0");
        }
        for &(index, power) in &self.factors {
            let variable = match factor_names(extra_inputs).nth(index) {
                Some("q_hat") => "q",
                Some("v_hat") => "V",
                Some(other) => other,
                None => "?",
            };
            name.push('_');
            name.push_str(variable);
            if power > 1 {
                name.push_str(&power.to_string());
            }
        }
        name
    }

    /// The term's value at the given flight variables.
    #[inline(always)]
    pub fn value<T: Scalar>(&self, factors: &[T; FACTORS]) -> T {
        match self.factors.as_slice() {
            [] => T::from(1.0),
            [(index, 1)] => factors[*index],
            list => {
                let mut product = T::from(1.0);
                for &(index, power) in list {
                    for _ in 0..power {
                        product = product * factors[index];
                    }
                }
                product
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_read_named_and_evaluated() {
        let extra = vec!["flap".to_owned()];
        let variables = [0.1, 0.02, 0.9, -0.05, 0.3, 0.0, 0.0];
        for (text, name, value) in [
            ("1", "Cm_0", 1.0),
            ("alpha", "Cm_alpha", 0.1),
            ("q_hat", "Cm_q", 0.02),
            ("v_hat", "Cm_V", 0.9),
            ("alpha^2", "Cm_alpha2", 0.01),
            ("alpha * elevator", "Cm_alpha_elevator", -0.005),
            ("elevator*alpha*alpha", "Cm_alpha2_elevator", -0.0005),
            ("flap", "Cm_flap", 0.3),
        ] {
            let term = Term::parse(text, &extra).unwrap();
            assert_eq!(term.parameter_name(Coefficient::PitchingMoment, false, &extra), name);
            assert!((term.value(&variables) - value).abs() < 1e-15, "{text}");
        }
    }

    #[test]
    fn a_misspelt_variable_gets_the_nearest_word() {
        let message = Term::parse("alpah*elevator", &[]).unwrap_err();
        assert!(message.contains("`alpah`") && message.contains("did you mean `alpha`"), "{message}");
        assert!(Term::parse("alpha^x", &[]).is_err());
        assert!(Term::parse("", &[]).is_err());
    }
}
