//! Terms of the coefficient build-up: products of powers of the flight variables.

use phugoid_flight_dynamics::scalar::Scalar;

use crate::core::axes::Group;
use crate::core::words::did_you_mean;

/// Room for inputs of the model file beyond the control surfaces (flap, speed brake, ...).
pub const EXTRA_INPUTS: usize = 3;
/// Flight variables a term can be made of: [`Variable`], then the extra inputs.
pub const FACTORS: usize = Variable::ALL.len() + EXTRA_INPUTS;

/// A coefficient, made dimensional by `qbar S` and for the moments a length: the mean chord for `Cm`, the span for `Cl`
/// and `Cn`. Lift and drag are along the air-relative velocity in the plane of symmetry (stability axes), all else is
/// in body axes, moments about the centre of gravity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(usize)]
pub enum Coefficient {
    /// `CL`, positive up, perpendicular to the airspeed.
    Lift,
    /// `CD`, positive aft, along the airspeed.
    Drag,
    /// `Cm`, about body y, positive nose up.
    PitchingMoment,
    /// `CY`, along body y, positive to the right.
    SideForce,
    /// `Cl`, about body x, positive right wing down.
    RollingMoment,
    /// `Cn`, about body z, positive nose right.
    YawingMoment,
}

impl Coefficient {
    /// All, in order: those of symmetric flight first.
    pub const ALL: [Self; 6] =
        [Self::Lift, Self::Drag, Self::PitchingMoment, Self::SideForce, Self::RollingMoment, Self::YawingMoment];

    /// The group of axes whose motion determines the derivatives of this coefficient.
    pub fn group(self) -> Group {
        match self {
            Self::Lift | Self::Drag | Self::PitchingMoment => Group::Longitudinal,
            Self::SideForce | Self::RollingMoment | Self::YawingMoment => Group::Lateral,
        }
    }

    /// The symbol used in model files and parameter names.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Lift => "CL",
            Self::Drag => "CD",
            Self::PitchingMoment => "Cm",
            Self::SideForce => "CY",
            Self::RollingMoment => "Cl",
            Self::YawingMoment => "Cn",
        }
    }
}

/// A flight variable of the terms; its number is its position in a factor array, before the extra inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(usize)]
pub enum Variable {
    /// `alpha`, rad, from the reference point.
    Alpha,
    /// `beta`, the angle of sideslip, rad, from zero.
    Beta,
    /// `p_hat`, `p b / 2V`, b the span.
    RollRate,
    /// `q_hat`, `q cbar / 2V`, cbar the mean chord.
    PitchRate,
    /// `r_hat`, the yaw rate made dimensionless, `r b / 2V`, b the span.
    YawRate,
    /// `v_hat`, the airspeed over the reference speed of the model file, `V / V0`.
    Airspeed,
    /// `elevator`, rad, from the reference point.
    Elevator,
    /// `aileron`, rad, from the reference point.
    Aileron,
    /// `rudder`, rad, from the reference point.
    Rudder,
    /// `alpha_dot_hat`, the rate of alpha made dimensionless, `alpha' cbar / 2V`, cbar the mean chord.
    AlphaRate,
}

impl Variable {
    /// All variables, in the order of a factor array.
    pub const ALL: [Self; 10] = [
        Self::Alpha,
        Self::Beta,
        Self::RollRate,
        Self::PitchRate,
        Self::YawRate,
        Self::Airspeed,
        Self::Elevator,
        Self::Aileron,
        Self::Rudder,
        Self::AlphaRate,
    ];
    const NAMES: [&'static str; Self::ALL.len()] =
        ["alpha", "beta", "p_hat", "q_hat", "r_hat", "v_hat", "elevator", "aileron", "rudder", "alpha_dot_hat"];

    /// Position in a factor array, from 0: the order of [`Variable::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Name in a term, e.g. `q_hat`.
    pub fn name(self) -> &'static str {
        Self::NAMES[self.index()]
    }

    /// Name in the name of a parameter: `q` for `q_hat`, `V` for `v_hat`, `alpha_dot` for `alpha_dot_hat`.
    pub fn short_name(self) -> &'static str {
        match self {
            Self::Airspeed => "V",
            other => other.name().trim_end_matches("_hat"),
        }
    }
}

/// A product of powers of flight variables; the empty product is the constant 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Term {
    /// Index of the flight variable in [`factor_names`] and its power (at least 1), each variable at most once.
    factors: Vec<(usize, i32)>,
}

/// Names of the flight variables in the order of a factor array: [`Variable`], then the extra inputs of the model file.
pub fn factor_names(extra_inputs: &[String]) -> impl Iterator<Item = &str> + Clone {
    Variable::NAMES.into_iter().chain(extra_inputs.iter().map(String::as_str))
}

/// Position in a factor array. An extra input goes before a variable of its name, which is then one that the motion of
/// the model file does not know.
fn position(name: &str, extra_inputs: &[String]) -> Option<usize> {
    let extra = extra_inputs.iter().position(|n| n == name).map(|i| Variable::ALL.len() + i);
    extra.or_else(|| Variable::NAMES.iter().position(|n| *n == name))
}

impl Term {
    /// Parses `1`, `alpha`, `alpha^2`, `alpha*elevator`, ...
    ///
    /// ```
    /// use phugoid_identification::term::{Coefficient, Term};
    /// let term = Term::parse("alpha * elevator^2", &[])?;
    /// assert_eq!(term.parameter_name(Coefficient::PitchingMoment, false, &[]), "Cm_alpha_elevator2");
    /// assert_eq!(term.parameter_unit(), "per rad^3");
    /// assert!(Term::parse("alhpa", &[]).unwrap_err().contains("did you mean `alpha`?"));
    /// # Ok::<(), String>(())
    /// ```
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
            let Some(index) = position(name, extra_inputs) else {
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
    /// to a database, and the flight variables ([`Variable::short_name`]; `0` for the constant).
    pub fn parameter_name(&self, coefficient: Coefficient, increment: bool, extra_inputs: &[String]) -> String {
        let mut name = format!("{}{}", if increment { "d" } else { "" }, coefficient.symbol());
        if self.is_constant() {
            name.push_str("_0");
        }
        for &(index, power) in &self.factors {
            let variable = match Variable::ALL.get(index) {
                Some(variable) => variable.short_name(),
                None => extra_inputs.get(index - Variable::ALL.len()).map_or("?", String::as_str),
            };
            name.push('_');
            name.push_str(variable);
            if power > 1 {
                name.push_str(&power.to_string());
            }
        }
        name
    }

    /// The term as a model file writes it: `alpha^2`, `alpha*elevator`, `1`.
    pub fn text(&self, extra_inputs: &[String]) -> String {
        let word = |&(index, power): &(usize, i32)| {
            let name = factor_names(extra_inputs).nth(index).unwrap_or("?");
            if power > 1 { format!("{name}^{power}") } else { name.to_owned() }
        };
        let words: Vec<String> = self.factors.iter().map(word).collect();
        if words.is_empty() { "1".to_owned() } else { words.join("*") }
    }

    /// The product of this term and another.
    #[must_use]
    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut factors = self.factors.clone();
        for &(index, power) in &other.factors {
            match factors.iter_mut().find(|(i, _)| *i == index) {
                Some((_, p)) => *p += power,
                None => factors.push((index, power)),
            }
        }
        factors.sort_unstable();
        Self { factors }
    }

    /// Unit of the parameter that multiplies it, as printed: `per rad`, `per rad^2`, `-` where no angle is involved.
    /// Rates made dimensionless are angles (radians per time that the air takes along the chord or span), as usual.
    pub fn parameter_unit(&self) -> String {
        let angular = |&&(index, _): &&(usize, i32)| index < Variable::ALL.len() && index != Variable::Airspeed.index();
        match self.factors.iter().filter(angular).map(|(_, power)| power).sum::<i32>() {
            0 => "-".to_owned(),
            1 => "per rad".to_owned(),
            power => format!("per rad^{power}"),
        }
    }

    /// What multiplies a flight variable in this term; none if it is not there to the first power.
    pub fn without(&self, variable: Variable) -> Option<Self> {
        let place = self.factors.iter().position(|factor| *factor == (variable.index(), 1))?;
        let mut factors = self.factors.clone();
        factors.remove(place);
        Some(Self { factors })
    }

    /// The same term with its flight variables counted otherwise, for a model that needs but few of them. A variable
    /// without a new position gets one beyond every array: it is zero there.
    #[must_use]
    pub fn renumbered(&self, position: impl Fn(usize) -> Option<usize>) -> Self {
        let factors = self.factors.iter().map(|(index, power)| (position(*index).unwrap_or(usize::MAX), *power));
        Self { factors: factors.collect() }
    }

    /// A term that is zero whatever the flight variables are.
    pub(crate) fn zero() -> Self {
        Self { factors: vec![(usize::MAX, 1)] }
    }

    /// The term's value at the given flight variables; one that is not among them is zero.
    #[inline(always)]
    pub fn value<T: Scalar, const K: usize>(&self, factors: &[T; K]) -> T {
        let at = |index: usize| factors.get(index).copied().unwrap_or(T::from(0.0));
        match self.factors.as_slice() {
            [] => T::from(1.0),
            [(index, 1)] => at(*index),
            list => {
                let mut product = T::from(1.0);
                for &(index, power) in list {
                    for _ in 0..power {
                        product = product * at(index);
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
        let mut variables = [0.0; FACTORS];
        let values = [
            (Variable::Alpha, 0.1),
            (Variable::Beta, 0.04),
            (Variable::RollRate, 0.03),
            (Variable::PitchRate, 0.02),
            (Variable::Airspeed, 0.9),
            (Variable::Elevator, -0.05),
            (Variable::AlphaRate, 0.01),
        ];
        for (variable, value) in values {
            variables[variable.index()] = value;
        }
        variables[Variable::ALL.len()] = 0.3;
        for (text, name, value) in [
            ("1", "Cm_0", 1.0),
            ("alpha", "Cm_alpha", 0.1),
            ("q_hat", "Cm_q", 0.02),
            ("v_hat", "Cm_V", 0.9),
            ("alpha^2", "Cm_alpha2", 0.01),
            ("alpha * elevator", "Cm_alpha_elevator", -0.005),
            ("elevator*alpha*alpha", "Cm_alpha2_elevator", -0.0005),
            ("flap", "Cm_flap", 0.3),
            ("beta", "Cm_beta", 0.04),
            ("p_hat*beta", "Cm_beta_p", 0.0012),
            ("alpha_dot_hat", "Cm_alpha_dot", 0.01),
        ] {
            let term = Term::parse(text, &extra).unwrap();
            assert_eq!(term.parameter_name(Coefficient::PitchingMoment, false, &extra), name);
            assert!((term.value(&variables) - value).abs() < 1e-15, "{text}");
            assert_eq!(Term::parse(&term.text(&extra), &extra), Ok(term), "{text}");
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
