//! The pitching moment by the rate of the angle of attack, which the equations of motion cannot be asked for.
//!
//! The tail feels the angle of attack that the wing had a little earlier, which makes a moment by `alpha'` (`Cm_alpha_dot`,
//! B. Etkin, L. D. Reid, *Dynamics of Flight*, 3rd ed., section 5.5). A model without the term leaves it to `Cm_q` and the
//! others, and as `alpha' = q - (lift - weight)/(m V)` they can take nearly all of it up, at constant speed. With the speed the
//! part of the weight changes, and nothing takes up that: of slow, heavily damped aircraft `CL_alpha` is then off by several
//! of its random errors, with residuals that look well (docs/field.md). A differentiated angle of attack is too noisy to find it by
//! regression. The filter that follows the motion knows it well, so it is tried in the filter itself.

use super::candidate::{Candidate, with_terms};
use crate::core::axes::Axes;
use crate::core::estimation::{Estimation, OfferedTerm};
use crate::core::method::Method;
use crate::core::term::{Coefficient, Term};
use crate::model_file::{Base, ModelFile};

const TERM: &str = "alpha_dot_hat";
/// One sigma of what is known of the derivative beforehand: of 25 aircraft of JSBSim that have it as one number 20 lie between
/// -12 and -4, and none below -30.
const PRIOR: f64 = 8.0;
/// The largest derivative that is believed; it is negative, for a tail behind the wing.
const LARGEST: f64 = 40.0;
/// Random errors that it has to lie from zero. They do not hold what other missing terms do to it: of fast aircraft it comes out
/// far from zero with the wrong sign, by tens of them, which is why the sign counts as well (docs/methods.md).
pub(super) const FAR: f64 = 6.0;

fn candidate() -> Candidate {
    Candidate { coefficient: Coefficient::PitchingMoment, text: TERM.to_owned(), input: None, rank: 0 }
}

/// The model with the term, to be run once more; none where it cannot have it or has `alpha'` already: only the longitudinal motion
/// alone knows it, a database has its own, and where the pitching moment has no `q_hat` it would stand for that. Only the methods that
/// follow the motion sample by sample are asked.
pub(crate) fn with_rate_of_alpha(file: &ModelFile, method: Method) -> Option<ModelFile> {
    let follows = matches!(method, Method::Smpe | Method::Ekf);
    if !(follows && file.axes == Axes::Longitudinal && file.base == Base::None) {
        return None;
    }
    let has = |coefficient, text| {
        let term = Term::parse(text, &file.extra_inputs);
        file.terms(coefficient).any(|own| term.as_ref().is_ok_and(|term| own == term))
    };
    let is_there = [Coefficient::Lift, Coefficient::PitchingMoment].into_iter().any(|c| has(c, TERM));
    // The term needs no reference speed.
    (has(Coefficient::PitchingMoment, "q_hat") && !is_there)
        .then(|| with_terms(file, &[(&candidate(), PRIOR)], f64::NAN))
        .flatten()
}

/// The term, where the estimation with it finds it: negative, no larger than any aircraft has it, and far from zero.
pub(crate) fn found(with: &ModelFile, after: &Estimation) -> Option<OfferedTerm> {
    let parameter =
        candidate().term(&with.extra_inputs)?.parameter_name(Coefficient::PitchingMoment, false, &with.extra_inputs);
    let found = after.parameter(&parameter)?;
    let random = found.random_std();
    let far = found.value < 0.0 && found.value >= -LARGEST && -found.value >= FAR * random;
    far.then(|| OfferedTerm {
        coefficient: Coefficient::PitchingMoment.symbol().to_owned(),
        term: TERM.to_owned(),
        input: None,
        parameter,
        value: found.value,
        std_error: random,
        partial_f: (found.value / random).powi(2),
        share: None,
        excess: None,
        asked_for: true,
        prior_std: PRIOR,
    })
}
