//! Effective derivatives: the sums of the derivatives with respect to `q` and to the rate of the angle of attack, which
//! a flight determines better than the parts.
//!
//! `alpha' = q - (qbar S CL / m + ...) / V + g cos(theta - alpha) / V`: in one manoeuvre of the short period the
//! regressor `alpha_dot_hat` is very nearly `q_hat` plus a multiple of `alpha`. The flight then determines `Cm_q +
//! Cm_alpha_dot` (and `Cm_alpha` less the lift slope's share) but not its parts (Klein & Morelli, Aircraft System
//! Identification, section 3.3). A part is given by itself only where the flight determines it; otherwise the sum is
//! given, with its own, much smaller standard error.

use crate::core::estimation::{EffectiveDerivative, FinalStatus, ParameterResult};
use crate::core::term::{Coefficient, Variable};
use crate::model_file::{ModelFile, Role};

/// From this correlation of the errors on the two parts are not separable; the same limit as in the verdict.
const INDISTINGUISHABLE: f64 = 0.99;
/// Share of the prior variance that the flight must have removed from a part before it is given by itself.
const DETERMINED: f64 = 0.9;

/// The effective derivatives of an estimation: one for each coefficient with both a `q_hat` and an `alpha_dot_hat`
/// term. A part that is not separable is not called converged.
pub(crate) fn effective(
    parameters: &mut [ParameterResult],
    correlation: &[Vec<f64>],
    file: &ModelFile,
) -> Vec<EffectiveDerivative> {
    let place = |coefficient: Coefficient, variable: Variable, parameters: &[ParameterResult]| {
        let name = file.estimated().find(|p| {
            matches!(&p.role, Role::Term(c, term)
                if *c == coefficient && term.single() == Some(variable.index()))
        })?;
        parameters.iter().position(|p| p.name == name.name)
    };
    let mut found = Vec::new();
    for coefficient in Coefficient::ALL {
        let pair = place(coefficient, Variable::PitchRate, parameters).zip(place(
            coefficient,
            Variable::AlphaRate,
            parameters,
        ));
        let Some((q, rate)) = pair else { continue };
        let r = correlation.get(q).and_then(|row| row.get(rate)).copied().unwrap_or(0.0);
        let (a, b) = (&parameters[q], &parameters[rate]);
        let (sa, sb) = (a.corrected_std_error, b.corrected_std_error);
        let separable = r.abs() < INDISTINGUISHABLE && b.observability >= DETERMINED && a.observability >= DETERMINED;
        found.push(EffectiveDerivative {
            name: format!("{} + {}", a.name, b.name),
            value: a.value + b.value,
            std_error: (sa * sa + sb * sb + 2.0 * r * sa * sb).max(0.0).sqrt(),
            parts: [a.name.clone(), b.name.clone()],
            correlation: r,
            separable,
        });
        if !separable {
            for part in [q, rate] {
                if parameters[part].status == FinalStatus::Converged {
                    parameters[part].status = FinalStatus::Improving;
                }
            }
        }
    }
    found
}

/// The sentence of the verdict about the sum.
pub(crate) fn sentence(effective: &EffectiveDerivative) -> String {
    let EffectiveDerivative { name, value, std_error, parts: [q, rate], correlation, separable } = effective;
    let sum = format!("{name} = {value:.4} +- {std_error:.4} (one sigma)");
    if *separable {
        format!("{q} and {rate} were told apart (correlation {correlation:.3}); {sum}.")
    } else {
        format!(
            "{q} and {rate} cannot be told apart in this flight (correlation {correlation:.4}): believe their sum, the \
             effective derivative {sum}, which a model without {rate} calls {q}. To tell them apart fly a manoeuvre that \
             turns the flight path while alpha stays: a steep turn, a pull-up from a dive, several phugoid cycles."
        )
    }
}
