//! What input would make a parameter identifiable: the words that go with a verdict.
//!
//! The advice is that of the flight-test literature (R. V. Jategaonkar, *Flight Vehicle System Identification*, 2nd
//! ed., AIAA 2015, chapter 2; V. Klein, E. A. Morelli, *Aircraft System Identification*, AIAA 2006, chapter 9): each
//! control surface is moved near the frequency of the mode that it excites, and one regressor is moved apart from the
//! others.

use crate::core::term::Variable;
use crate::model_file::Role;

/// What to fly so that a parameter that nothing has excited becomes known. `None` for offsets and sensor biases, which
/// become known together with the other parameters.
pub(crate) fn to_excite(role: &Role, extra_inputs: &[String]) -> Option<String> {
    let Role::Term(_, term) = role else { return None };
    Some(match term.single() {
        None if term.is_constant() => "fly steadily a little longer, at more than one angle of attack".to_owned(),
        None => "fly larger amplitudes: a product of variables needs them far from zero together".to_owned(),
        Some(index) => match Variable::ALL.get(index) {
            Some(Variable::Alpha | Variable::PitchRate) => {
                "fly an elevator 3-2-1-1 or doublet near the short-period frequency".to_owned()
            }
            Some(Variable::Elevator) => {
                "move the elevator sharply (3-2-1-1, doublet): its own effect shows before the aircraft has turned"
                    .to_owned()
            }
            Some(Variable::Airspeed) => {
                "change the speed slowly and far (a phugoid, a pull-up and push-over at constant power)".to_owned()
            }
            Some(Variable::Beta | Variable::YawRate | Variable::Rudder) => {
                "fly a rudder doublet near the Dutch-roll frequency".to_owned()
            }
            Some(Variable::RollRate | Variable::Aileron) => {
                "fly an aileron doublet, or roll from bank to bank".to_owned()
            }
            Some(Variable::AlphaRate) => ALPHA_RATE.to_owned(),
            None => format!("move `{}`", extra(index, extra_inputs)),
        },
    })
}

/// What to fly so that two parameters with strongly correlated errors can be estimated separately.
pub(crate) fn to_separate(a: &Role, b: &Role) -> String {
    // The variable of a term that is no product; extra inputs count as controls.
    let variable = |role: &Role| match role {
        Role::Term(_, term) => term.single(),
        Role::Offset(_) | Role::Bias(_) => None,
    };
    let is_product =
        |role: &Role| matches!(role, Role::Term(_, term) if !term.is_constant() && term.single().is_none());
    let is_control = |variable: Option<usize>| {
        variable.is_some_and(|index| {
            matches!(Variable::ALL.get(index), None | Some(Variable::Elevator | Variable::Aileron | Variable::Rudder))
        })
    };
    let alpha_rate = Some(Variable::AlphaRate.index());
    let (va, vb) = (variable(a), variable(b));
    if va == alpha_rate || vb == alpha_rate {
        ALPHA_RATE.to_owned()
    } else if is_control(va) && is_control(vb) && va != vb {
        "move the controls one after the other, or at frequencies of their own (multisines)".to_owned()
    } else if is_control(va) != is_control(vb) && va.is_some() && vb.is_some() {
        "the control follows the motion (a pilot or a controller in the loop): add an input of its own to it, such as a \
         multisine"
            .to_owned()
    } else if a.is_constant() && b.is_constant() {
        "fix one of the two: a sensor's bias and a constant of the model act alike".to_owned()
    } else if a.is_constant() || b.is_constant() {
        "fly at several angles of attack and speeds, or fix one of the two".to_owned()
    } else if is_product(a) || is_product(b) {
        "fly small and large amplitudes: only those tell a curve from a straight line".to_owned()
    } else {
        "fly an input with more frequencies (3-2-1-1, sweep, multisine), or fix one of the two".to_owned()
    }
}

const ALPHA_RATE: &str = "the rate of the angle of attack and the pitch rate go together in ordinary flight: estimate the \
                          sum of both derivatives, or fly steady turns and heaving beside pitching";

fn extra(index: usize, extra_inputs: &[String]) -> &str {
    extra_inputs.get(index - Variable::ALL.len()).map_or("the input", String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::output::Output;
    use crate::core::term::{Coefficient, Term};

    fn term(text: &str) -> Role {
        Role::Term(Coefficient::PitchingMoment, Term::parse(text, &["flap".to_owned()]).unwrap())
    }

    #[test]
    fn every_kind_of_parameter_gets_its_input() {
        let flap = ["flap".to_owned()];
        for (text, word) in [
            ("alpha", "3-2-1-1"),
            ("elevator", "sharply"),
            ("v_hat", "phugoid"),
            ("beta", "rudder doublet"),
            ("p_hat", "bank to bank"),
            ("alpha^2", "larger amplitudes"),
            ("1", "steadily"),
            ("flap", "move `flap`"),
        ] {
            let advice = to_excite(&term(text), &flap).unwrap();
            assert!(advice.contains(word), "{text}: {advice}");
        }
        assert_eq!(to_excite(&Role::Bias(Output::Alpha), &flap), None);
    }

    #[test]
    fn every_kind_of_pair_gets_its_input() {
        for (a, b, word) in [
            (term("alpha_dot_hat"), term("q_hat"), "sum of both"),
            (term("aileron"), term("rudder"), "one after the other"),
            (term("elevator"), term("flap"), "one after the other"),
            (term("elevator"), term("q_hat"), "in the loop"),
            (term("1"), Role::Bias(Output::Alpha), "fix one"),
            (term("1"), term("alpha"), "several angles"),
            (term("alpha"), term("alpha^2"), "small and large"),
            (term("alpha"), term("v_hat"), "more frequencies"),
        ] {
            for (a, b) in [(&a, &b), (&b, &a)] {
                let advice = to_separate(a, b);
                assert!(advice.contains(word), "{a:?} {b:?}: {advice}");
            }
        }
    }
}
