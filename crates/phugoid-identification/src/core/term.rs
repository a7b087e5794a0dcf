//! Terms of the coefficient build-up: products of powers of the flight variables, of their magnitudes, and of what they
//! exceed a value by.

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

    /// Whether it is that of a moment, which the angular accelerations show.
    pub fn is_moment(self) -> bool {
        matches!(self, Self::PitchingMoment | Self::RollingMoment | Self::YawingMoment)
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

    /// The coefficient with this symbol; `None` if there is none.
    ///
    /// ```
    /// use phugoid_identification::term::Coefficient;
    /// assert_eq!(Coefficient::from_symbol("Cm"), Some(Coefficient::PitchingMoment));
    /// assert_eq!(Coefficient::from_symbol("cm"), None);
    /// ```
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.symbol() == symbol)
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
    /// The variables by which stability and control derivatives are taken, and of which a local linear model is made.
    pub const OF_DERIVATIVES: [Self; 8] = [
        Self::Alpha,
        Self::Beta,
        Self::RollRate,
        Self::PitchRate,
        Self::YawRate,
        Self::Elevator,
        Self::Aileron,
        Self::Rudder,
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

/// A product of powers of flight variables, and of variables that are bent; the empty product is the constant 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Term {
    /// Index of the flight variable in [`factor_names`] and its power (at least 1), each variable at most once.
    factors: Vec<(usize, i32)>,
    bent: Vec<Bent>,
}

/// How a flight variable is bent, so that two straight lines meet.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Bend {
    /// `|x|`.
    Magnitude,
    /// `max(x - from, 0)`: zero up to this value (in the unit of the variable), and straight beyond.
    Above(f64),
}

/// A power of a bent flight variable.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Bent {
    /// Index of the flight variable in [`factor_names`].
    pub variable: usize,
    /// How it is bent.
    pub bend: Bend,
    /// Its power, at least 1.
    pub power: i32,
}

impl Bent {
    /// Its value where the variable has this one.
    #[inline]
    fn value<T: Scalar>(&self, x: T) -> T {
        let bent = match self.bend {
            Bend::Magnitude if x.real() < 0.0 => -x,
            Bend::Magnitude => x,
            // Not `>`: NaN stays one.
            Bend::Above(from) if x.real() <= from => T::from(0.0),
            Bend::Above(from) => x - from,
        };
        (1..self.power).fold(bent, |product, _| product * bent)
    }

    /// Value and slope where the variable has this value; at the bend itself the slope of the left side.
    pub(crate) fn value_and_slope(&self, x: f64) -> [f64; 2] {
        let (bent, slope) = match self.bend {
            Bend::Magnitude => (x.abs(), if x > 0.0 { 1.0 } else { -1.0 }),
            Bend::Above(from) => ((x - from).max(0.0), f64::from(x > from)),
        };
        [bent.powi(self.power), f64::from(self.power) * bent.powi(self.power - 1) * slope]
    }

    /// The factor as a model file writes it, of a variable of this name.
    fn text(&self, name: &str) -> String {
        let base = match self.bend {
            Bend::Magnitude => format!("|{name}|"),
            Bend::Above(from) if from < 0.0 => format!("max({name} + {}, 0)", -from),
            Bend::Above(from) => format!("max({name} - {from}, 0)"),
        };
        if self.power > 1 { format!("{base}^{}", self.power) } else { base }
    }

    /// Its part of the name of a parameter: `abs_elevator`, `alpha_above_0p12`, `alpha_above_m0p05` for -0.05.
    fn short_name(&self, variable: &str) -> String {
        let power = if self.power > 1 { self.power.to_string() } else { String::new() };
        match self.bend {
            Bend::Magnitude => format!("abs_{variable}{power}"),
            Bend::Above(from) => {
                format!("{variable}{power}_above_{}", from.to_string().replace('-', "m").replace('.', "p"))
            }
        }
    }

    /// Reads `|x|` and `max(x - 0.1, 0)`: the name of the variable and the bend; none for other words.
    fn parse(word: &str) -> Option<(&str, Bend)> {
        if let Some(name) = word.strip_prefix('|').and_then(|rest| rest.strip_suffix('|')) {
            return Some((name.trim(), Bend::Magnitude));
        }
        let inside = word.strip_prefix("max(")?.strip_suffix(')')?;
        let (difference, zero) = inside.rsplit_once(',')?;
        if zero.trim().parse::<f64>() != Ok(0.0) {
            return None;
        }
        // The last sign that is none of an exponent parts the variable from the number.
        let place = difference.rfind(" - ").or_else(|| difference.rfind(" + "));
        let place = place.map(|at| at + 1).or_else(|| difference.rfind(['-', '+'])).filter(|at| *at > 0);
        let Some(place) = place else {
            return Some((difference.trim(), Bend::Above(0.0)));
        };
        let (name, number) = difference.split_at(place);
        let from = -number.replace(' ', "").parse::<f64>().ok().filter(|v| v.is_finite())?;
        // No negative zero.
        Some((name.trim(), Bend::Above(from + 0.0)))
    }
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
    /// Parses `1`, `alpha`, `alpha^2`, `alpha*elevator`, `|elevator|`, `max(alpha - 0.12, 0)`, ...
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
        let mut term = Self::default();
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
            let bend = if position(name, extra_inputs).is_some() { None } else { Bent::parse(name) };
            let name = bend.map_or(name, |(inside, _)| inside);
            let Some(variable) = position(name, extra_inputs) else {
                let words = std::iter::once("1").chain(factor_names(extra_inputs));
                return Err(format!("unknown variable `{name}` in term `{text}`{}", did_you_mean(name, words)));
            };
            term.multiply(&match bend {
                Some((_, bend)) => Self { factors: Vec::new(), bent: vec![Bent { variable, bend, power }] },
                None => Self { factors: vec![(variable, power)], bent: Vec::new() },
            });
        }
        Ok(term)
    }

    /// Multiplies by another term.
    fn multiply(&mut self, other: &Self) {
        let mut plain = other.factors.clone();
        for factor in &other.bent {
            match self.bent.iter_mut().find(|b| b.variable == factor.variable && b.bend == factor.bend) {
                Some(own) => own.power += factor.power,
                None => self.bent.push(*factor),
            }
        }
        // The square of a magnitude is that of the variable.
        self.bent.retain_mut(|b| {
            let pairs = b.power / 2 * 2;
            if b.bend == Bend::Magnitude && pairs > 0 {
                plain.push((b.variable, pairs));
                b.power -= pairs;
            }
            b.power > 0
        });
        for (index, power) in plain {
            match self.factors.iter_mut().find(|(i, _)| *i == index) {
                Some((_, p)) => *p += power,
                None => self.factors.push((index, power)),
            }
        }
        self.factors.sort_unstable();
        self.bent.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    }

    /// True for the constant term `1`.
    pub fn is_constant(&self) -> bool {
        self.factors.is_empty() && self.bent.is_empty()
    }

    /// The flight variables (indices into [`factor_names`]) that are not bent, and their powers. A term may have
    /// [bent ones](Self::bent) beside them.
    pub fn factors(&self) -> &[(usize, i32)] {
        &self.factors
    }

    /// The bent flight variables.
    pub fn bent(&self) -> &[Bent] {
        &self.bent
    }

    /// All flight variables with their powers, bent or not; one may come more than once.
    pub fn powers(&self) -> impl Iterator<Item = (usize, i32)> + '_ {
        self.factors.iter().copied().chain(self.bent.iter().map(|b| (b.variable, b.power)))
    }

    /// The flight variable of a term that is this variable itself; `None` for constants, products, powers and bent
    /// ones.
    pub fn single(&self) -> Option<usize> {
        match (self.factors.as_slice(), self.bent.as_slice()) {
            ([(index, 1)], []) => Some(*index),
            _ => None,
        }
    }

    /// The flight variable (by its position) that the term follows in a straight line from a value on, and that value in its unit;
    /// `None` of any other term.
    pub(crate) fn straight_above(&self) -> Option<(usize, f64)> {
        match (self.factors.as_slice(), self.bent.as_slice()) {
            ([], [Bent { variable, bend: Bend::Above(from), power: 1 }]) => Some((*variable, *from)),
            _ => None,
        }
    }

    /// Derivative with respect to one of the flight variables (by its position, [`Variable::index`]), where they have these values, in
    /// their units: rad, and 1 for what is made dimensionless. Zero for a variable that the term does not have.
    pub fn slope(&self, variable: usize, factors: &[f64; FACTORS]) -> f64 {
        let value = |index: usize| factors.get(index).copied().unwrap_or(0.0);
        let plain = self.factors.iter().map(|&(index, power)| {
            let x = value(index);
            (index, [x.powi(power), f64::from(power) * x.powi(power - 1)])
        });
        let bent = self.bent.iter().map(|b| (b.variable, b.value_and_slope(value(b.variable))));
        let (_, slope) = plain.chain(bent).fold((1.0, 0.0), |(product, slope), (index, [value, own])| {
            (product * value, slope * value + if index == variable { product * own } else { 0.0 })
        });
        slope
    }

    /// The name of the parameter that multiplies this term: the coefficient's symbol, preceded by `d` for an increment
    /// to a database, and the flight variables ([`Variable::short_name`]; `0` for the constant).
    pub fn parameter_name(&self, coefficient: Coefficient, increment: bool, extra_inputs: &[String]) -> String {
        let mut name = format!("{}{}", if increment { "d" } else { "" }, coefficient.symbol());
        if self.is_constant() {
            name.push_str("_0");
        }
        let variable = |index: usize| match Variable::ALL.get(index) {
            Some(variable) => variable.short_name(),
            None => extra_inputs.get(index - Variable::ALL.len()).map_or("?", String::as_str),
        };
        for &(index, power) in &self.factors {
            name.push('_');
            name.push_str(variable(index));
            if power > 1 {
                name.push_str(&power.to_string());
            }
        }
        for bent in &self.bent {
            name.push('_');
            name.push_str(&bent.short_name(variable(bent.variable)));
        }
        name
    }

    /// The term as a model file writes it: `alpha^2`, `alpha*elevator`, `|elevator|`, `max(alpha - 0.12, 0)`, `1`.
    pub fn text(&self, extra_inputs: &[String]) -> String {
        let name = |index: usize| factor_names(extra_inputs).nth(index).unwrap_or("?");
        let word = |&(index, power): &(usize, i32)| {
            if power > 1 { format!("{}^{power}", name(index)) } else { name(index).to_owned() }
        };
        let bent = self.bent.iter().map(|b| b.text(name(b.variable)));
        let words: Vec<String> = self.factors.iter().map(word).chain(bent).collect();
        if words.is_empty() { "1".to_owned() } else { words.join("*") }
    }

    /// Unit of the parameter that multiplies it, as printed: `per rad`, `per rad^2`, `-` where no angle is involved.
    /// Rates made dimensionless are angles (radians per time that the air takes along the chord or span), as usual.
    pub fn parameter_unit(&self) -> String {
        let angular = |&(index, _): &(usize, i32)| index < Variable::ALL.len() && index != Variable::Airspeed.index();
        match self.powers().filter(angular).map(|(_, power)| power).sum::<i32>() {
            0 => "-".to_owned(),
            1 => "per rad".to_owned(),
            power => format!("per rad^{power}"),
        }
    }

    /// The term with one power less of a flight variable (by its position, [`Variable::index`]), and what that power was: what
    /// the derivative by the variable is made of. None where the variable is not there, or is bent.
    pub(crate) fn lowered(&self, variable: usize) -> Option<(Self, i32)> {
        if self.bent.iter().any(|bent| bent.variable == variable) {
            return None;
        }
        let mut lowered = self.clone();
        let place = lowered.factors.iter().position(|(index, _)| *index == variable)?;
        let (_, power) = *lowered.factors.get(place)?;
        match power {
            1 => drop(lowered.factors.remove(place)),
            _ => lowered.factors[place].1 -= 1,
        }
        Some((lowered, power))
    }

    /// What multiplies a flight variable in this term; none if it is not there to the first power.
    pub fn without(&self, variable: Variable) -> Option<Self> {
        let place = self.factors.iter().position(|factor| *factor == (variable.index(), 1))?;
        let mut factors = self.factors.clone();
        factors.remove(place);
        Some(Self { factors, bent: self.bent.clone() })
    }

    /// The same term with its flight variables counted otherwise, for a model that needs but few of them. A variable
    /// without a new position gets one beyond every array: it is zero there.
    #[must_use]
    pub fn renumbered(&self, position: impl Fn(usize) -> Option<usize>) -> Self {
        let place = |index: usize| position(index).unwrap_or(usize::MAX);
        let factors = self.factors.iter().map(|(index, power)| (place(*index), *power));
        let bent = self.bent.iter().map(|b| Bent { variable: place(b.variable), ..*b });
        Self { factors: factors.collect(), bent: bent.collect() }
    }

    /// A term that is zero whatever the flight variables are.
    pub(crate) fn zero() -> Self {
        Self { factors: vec![(usize::MAX, 1)], bent: Vec::new() }
    }

    /// The term's value at the given flight variables; one that is not among them is zero.
    #[inline(always)]
    pub fn value<T: Scalar, const K: usize>(&self, factors: &[T; K]) -> T {
        let at = |index: usize| factors.get(index).copied().unwrap_or(T::from(0.0));
        let product = match self.factors.as_slice() {
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
        };
        // A variable that is not there is zero, and so is the term with it, bent or not.
        let bent = |b: &Bent| factors.get(b.variable).map_or(T::from(0.0), |x| b.value(*x));
        self.bent.iter().fold(product, |product, b| product * bent(b))
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
    fn bent_variables_are_read_named_and_evaluated() {
        let extra = vec!["flap".to_owned()];
        for (text, written, name, unit, below, above) in [
            ("|elevator|", "|elevator|", "CD_abs_elevator", "per rad", 0.05, 0.05),
            ("alpha * | elevator |", "alpha*|elevator|", "CD_alpha_abs_elevator", "per rad^2", -0.0025, 0.0025),
            ("|alpha|^2", "alpha^2", "CD_alpha2", "per rad^2", 0.0025, 0.0025),
            ("|alpha|^3", "alpha^2*|alpha|", "CD_alpha2_abs_alpha", "per rad^3", 0.000_125, 0.000_125),
            ("max(alpha-0.02,0)", "max(alpha - 0.02, 0)", "CD_alpha_above_0p02", "per rad", 0.0, 0.03),
            ("max(alpha + 0.02, 0)^2", "max(alpha + 0.02, 0)^2", "CD_alpha2_above_m0p02", "per rad^2", 0.0, 0.0049),
            ("max(flap, 0)", "max(flap - 0, 0)", "CD_flap_above_0", "-", 0.0, 0.3),
            ("|flap|", "|flap|", "CD_abs_flap", "-", 0.3, 0.3),
        ] {
            let term = Term::parse(text, &extra).unwrap();
            assert_eq!(term.text(&extra), written);
            assert_eq!(Term::parse(written, &extra), Ok(term.clone()), "{text}");
            assert_eq!(term.parameter_name(Coefficient::Drag, false, &extra), name);
            assert_eq!(term.parameter_unit(), unit);
            assert!(!term.is_constant() && term.single().is_none());
            for (sign, value) in [(-1.0, below), (1.0, above)] {
                let mut variables = [0.0; FACTORS];
                variables[Variable::Alpha.index()] = sign * 0.05;
                variables[Variable::Elevator.index()] = sign * -0.05;
                variables[Variable::ALL.len()] = sign * 0.3;
                assert!((term.value(&variables) - value).abs() < 1e-15, "{text} {sign}");
                for variable in [Variable::Alpha.index(), Variable::Elevator.index()] {
                    let moved = |by: f64| {
                        let mut moved = variables;
                        moved[variable] += by;
                        term.value(&moved)
                    };
                    let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                    assert!((term.slope(variable, &variables) - slope).abs() < 1e-9, "{text} {sign}");
                }
            }
        }
        for wrong in ["|elevato|", "max(alpha - x, 0)", "max(alpha - 0.1, 1)", "max(alpha, elevator)", "||"] {
            assert!(Term::parse(wrong, &extra).is_err(), "{wrong}");
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
