//! What is estimated: `[coefficients]`, `[parameters]`, `[biases]`.

use phugoid_flight_data::quantity::Dimension;

use super::axes::other_axes;
use crate::core::axes::Axes;
use crate::core::output::{CHANNELS as OUTPUT_CHANNELS, Output};
use crate::core::term::{Coefficient, Term, Variable};
use crate::model_file::aircraft::Base;
use crate::model_file::error::ModelFileError;
use crate::model_file::parameter::{Parameter, Role};
use crate::model_file::section::Section;

/// No coefficient and no derivative is larger, in any power of an angle in radians.
const LARGEST_START: f64 = 1e9;
const PARAMETER_KEYS: [&str; 5] = ["start", "prior_std", "bounds", "change_std", "fixed"];

/// Half widths of the ranges of the increments of the F-16 study, per radian (docs/theory.md), used as bounds where the
/// file gives none.
const F16_RANGES: [(&str, f64); 5] =
    [("dCm_alpha", 0.5), ("dCm_q", 6.0), ("dCL_alpha", 1.5), ("dCD_alpha", 0.5), ("dCm_elevator", 0.4)];

/// Prior one sigma of the offsets in the coefficients. Those of the lateral moments are the pitching moment's over the
/// span.
const OFFSET_STD: [(Coefficient, f64); 6] = [
    (Coefficient::Lift, 0.025),
    (Coefficient::Drag, 0.01),
    (Coefficient::PitchingMoment, 0.01),
    (Coefficient::SideForce, 0.01),
    (Coefficient::RollingMoment, 0.004),
    (Coefficient::YawingMoment, 0.004),
];

/// Refuses a flight variable that the motion cannot evaluate.
fn check_variables(term: &Term, axes: Axes) -> Result<(), String> {
    let rate = Variable::AlphaRate;
    let of_rate = |factors: &[(usize, i32)]| factors.iter().any(|(index, power)| *index == rate.index() && *power > 1);
    if of_rate(term.factors()) || term.bent().iter().any(|bent| bent.variable == rate.index()) {
        return Err(format!("`{}` enters to the first power only: the motion depends on it in turn", rate.name()));
    }
    let variables = term.powers().filter_map(|(index, _)| Variable::ALL.get(index));
    let Some(foreign) = variables.into_iter().find(|v| !axes.variables().contains(v)) else { return Ok(()) };
    let name = foreign.name();
    Err(if *foreign == Variable::AlphaRate {
        format!(
            "`{name}` is a variable of the longitudinal motion alone: leave it out. The coefficient of `q_hat` is then the \
             effective derivative, that with respect to q and to the rate of alpha together"
        )
    } else {
        format!(
            "`{name}` is no variable of the {} motion: {}; a recorded channel of this name may stand under inputs",
            axes.name(),
            other_axes(axes)
        )
    })
}

pub(super) fn parameters(
    top: &Section,
    axes: Axes,
    base: Base,
    extra: &[String],
    outputs: &[bool; OUTPUT_CHANNELS],
) -> Result<Vec<Parameter>, ModelFileError> {
    let coefficients =
        top.section("coefficients")?.ok_or_else(|| top.missing("coefficients", "a table [coefficients]"))?;
    coefficients.allow("coefficient", Coefficient::ALL.iter().map(|c| c.symbol()).chain(["offsets"]))?;

    // Name, role, dimension and where it was asked for, in the order of the file.
    let mut wanted = Vec::new();
    for (symbol, _) in coefficients.keys() {
        let Some(coefficient) = Coefficient::from_symbol(symbol) else { continue };
        if !axes.coefficients().contains(&coefficient) {
            let message = format!("`{symbol}` is no coefficient of the {} motion: {}", axes.name(), other_axes(axes));
            return Err(coefficients.error(symbol, message));
        }
        for (text, span) in coefficients.strings(symbol)?.unwrap_or_default() {
            let path = format!("coefficients.{symbol}");
            let term = Term::parse(text, extra).map_err(|message| top.source.error(span.clone(), &path, message))?;
            check_variables(&term, axes).map_err(|message| top.source.error(span.clone(), &path, message))?;
            let name = term.parameter_name(coefficient, base != Base::None, extra);
            if wanted.iter().any(|(n, _)| *n == name) {
                return Err(top.source.error(span, &path, format!("term `{text}` is there twice")));
            }
            wanted.push((name, Role::Term(coefficient, term)));
        }
    }
    if wanted.is_empty() {
        return Err(coefficients.missing("CL", "at least one term, such as Cm = [\"alpha\", \"q_hat\"]"));
    }
    if coefficients.boolean("offsets")?.unwrap_or(false) {
        for coefficient in axes.coefficients().iter().copied() {
            // A coefficient that has a constant term does not get a second one.
            let own = |r: &Role| matches!(r, Role::Term(c, term) if *c == coefficient && term.is_constant());
            if !wanted.iter().any(|(_, role)| own(role)) {
                wanted.push((format!("offset_{}", coefficient.symbol()), Role::Offset(coefficient)));
            }
        }
    }
    let names: Vec<String> = wanted.iter().map(|(name, _)| name.clone()).collect();
    let priors = top.section("parameters")?;
    if let Some(priors) = &priors {
        priors.allow("parameter", names.iter().map(String::as_str))?;
    }
    let mut parameters = Vec::with_capacity(wanted.len() + OUTPUT_CHANNELS);
    for (name, role) in wanted {
        let section = match &priors {
            Some(priors) => priors.section(&name)?,
            None => None,
        };
        parameters.push(parameter(name, role, section, priors.as_ref().unwrap_or(&coefficients), base)?);
    }
    if let Some(biases) = top.section("biases")? {
        let measured: Vec<&str> = Output::ALL.iter().filter(|o| outputs[o.index()]).map(|o| o.name()).collect();
        biases.allow("output", measured.iter().copied())?;
        for output in Output::ALL {
            if let Some(prior_std) = biases.positive(output.name(), output.dimension())? {
                parameters.push(Parameter {
                    name: format!("bias_{}", output.name()),
                    role: Role::Bias(output),
                    start: 0.0,
                    prior_std,
                    bounds: None,
                    change_std: None,
                    fixed: false,
                });
            }
        }
    }
    Ok(parameters)
}

fn parameter(
    name: String,
    role: Role,
    section: Option<Section>,
    parent: &Section,
    base: Base,
) -> Result<Parameter, ModelFileError> {
    let standard_range = F16_RANGES.iter().find(|(n, _)| base == Base::F16 && *n == name).map(|(_, r)| *r);
    let standard_std = match role {
        Role::Offset(c) => OFFSET_STD.iter().find(|(o, _)| *o == c).map(|(_, s)| *s),
        _ => None,
    };
    let (mut start, mut prior_std, mut bounds, mut change_std, mut fixed) = (None, None, None, None, false);
    if let Some(section) = &section {
        section.allow("key", PARAMETER_KEYS.iter().copied())?;
        start = section.number("start", Dimension::NUMBER)?;
        prior_std = section.positive("prior_std", Dimension::NUMBER)?;
        bounds = section.pair("bounds")?;
        change_std = section.positive("change_std", Dimension::NUMBER)?;
        fixed = section.boolean("fixed")?.unwrap_or(false);
    }
    let place = section.as_ref().unwrap_or(parent);
    let bounds = bounds.or(if prior_std.is_none() { standard_range.map(|r| [-r, r]) } else { None });
    // Bounds R wide on either side stand for a prior of R/2.
    let prior_std = prior_std.or(bounds.map(|[low, high]| (high - low) / 4.0)).or(standard_std);
    let start = match (start, base, &role) {
        (Some(start), ..) => start,
        (None, Base::None, Role::Term(..)) => {
            return Err(
                place.missing("start", &format!("the start value of `{name}`, e.g. [parameters.{name}] start = 0"))
            );
        }
        _ => 0.0,
    };
    if start.abs() > LARGEST_START {
        return Err(place
            .error("start", format!("start {start:e} of `{name}` is larger than any coefficient or derivative is")));
    }
    let prior_std = match prior_std {
        Some(std) => std,
        None if fixed => 0.0,
        None => {
            let expected = format!("bounds = [lower, upper] or prior_std of `{name}` under [parameters.{name}]");
            return Err(place.missing("bounds", &expected));
        }
    };
    if let Some([low, high]) = bounds
        && !(low..=high).contains(&start)
    {
        return Err(place.error("start", format!("start {start} of `{name}` is outside its bounds [{low}, {high}]")));
    }
    Ok(Parameter { name, role, start, prior_std, bounds, change_std, fixed })
}
