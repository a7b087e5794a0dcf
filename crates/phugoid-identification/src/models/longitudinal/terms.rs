//! Terms as they are evaluated in flight: of few variables, and nearly all of one alone.

use crate::core::term::{Coefficient, EXTRA_INPUTS, Term, Variable};

/// A term ready for evaluation: nearly all terms are one flight variable or the constant.
#[derive(Clone, Debug)]
pub(super) struct QuickTerm {
    pub(super) coefficient: usize,
    /// Position in [`Variables`]; [`PRODUCT`] for a product.
    variable: usize,
    term: Term,
}

/// Flight variables of symmetric flight: alpha, q_hat, v_hat, elevator, and the extra inputs. Few, because all of them
/// are evaluated at every step on board.
pub(super) const FACTORS: usize = 4 + EXTRA_INPUTS;

/// A term in the order of these. Variables and coefficients of the lateral motion are zero in symmetric flight.
pub(super) fn short(coefficient: Coefficient, term: &Term) -> (Coefficient, Term) {
    let position = |index: usize| match Variable::ALL.get(index) {
        Some(Variable::Alpha) => Some(0),
        Some(Variable::PitchRate) => Some(1),
        Some(Variable::Airspeed) => Some(2),
        Some(Variable::Elevator) => Some(3),
        Some(_) => None,
        None => Some(4 + index - Variable::ALL.len()),
    };
    match coefficient {
        Coefficient::Lift | Coefficient::Drag | Coefficient::PitchingMoment => (coefficient, term.renumbered(position)),
        _ => (Coefficient::Lift, Term::zero()),
    }
}

/// Position of the constant 1 among the variables.
pub(super) const ONE: usize = FACTORS;
/// Marks a product of variables.
const PRODUCT: usize = usize::MAX;

impl QuickTerm {
    /// Of a term in the [`short`] order.
    pub(super) fn new(coefficient: Coefficient, term: &Term) -> Self {
        let variable = match term.single() {
            None if term.is_constant() => ONE,
            Some(index) if index < FACTORS => index,
            _ => PRODUCT,
        };
        Self { coefficient: coefficient as usize, variable, term: term.clone() }
    }

    #[inline(always)]
    pub(super) fn at(&self, variables: &Variables) -> (f64, [f64; 3]) {
        match variables.value.get(self.variable) {
            Some(value) => (*value, variables.gradient[self.variable]),
            None => self.product(variables),
        }
    }

    #[inline(never)]
    fn product(&self, variables: &Variables) -> (f64, [f64; 3]) {
        let (mut product, mut gradient) = (1.0, [0.0; 3]);
        for &(index, power) in self.term.factors() {
            let (Some(&value), Some(&slope)) = (variables.value.get(index), variables.gradient.get(index)) else {
                return (0.0, [0.0; 3]);
            };
            for _ in 0..power {
                for (g, s) in gradient.iter_mut().zip(slope) {
                    *g = *g * value + product * s;
                }
                product *= value;
            }
        }
        for bent in self.term.bent() {
            let variable = bent.variable;
            let (Some(&x), Some(&slope)) = (variables.value.get(variable), variables.gradient.get(variable)) else {
                return (0.0, [0.0; 3]);
            };
            let [value, along] = bent.value_and_slope(x);
            for (g, s) in gradient.iter_mut().zip(slope) {
                *g = *g * value + product * along * s;
            }
            product *= value;
        }
        (product, gradient)
    }
}

/// Flight variables of the terms (and the constant 1 last), with their derivatives with respect to V, alpha and q.
pub(super) struct Variables {
    pub(super) value: [f64; FACTORS + 1],
    pub(super) gradient: [[f64; 3]; FACTORS + 1],
}
