//! Which derivatives can be estimated from a segment, by regressions of the coefficients on the measured channels.
//!
//! Up to constants of the aircraft, which cancel in the ratio of a derivative to its bound,
//!
//! ```text
//! q' / V^2                     ~ Cm  = Cm_0 + Cm_alpha alpha + Cm_q q/V + Cm_elevator elevator
//! (ax sin alpha - az cos alpha) / V^2 ~ CL  (the same terms),  -(ax cos alpha + az sin alpha) / V^2 ~ CD
//! p' / V^2 ~ Cl,  r' / V^2 ~ Cn,  ay / V^2 ~ CY      on beta, p/V, r/V, aileron, rudder
//! ```
//!
//! Small couplings (products of rates and inertia, the part of `r'` in `p'`, the change of density and thrust) are left
//! out: the result says how well the derivatives can be estimated, not their values.

use serde::{Deserialize, Serialize};

use super::equation::{Fit, Inflation, Left, Regressor, TermFit, fit};
use super::record::Window;
use crate::core::axes::Group;
use crate::core::term::Coefficient;

/// How well a derivative can be estimated, from worst to best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// It cannot be estimated; the reason says why.
    No,
    /// The bound shows that its effect is small in this segment, less than a tenth of the motion of the coefficient.
    Small,
    /// Two standard errors are between a quarter of the value and the value.
    Roughly,
    /// Two standard errors are at most a quarter of the value.
    Told,
}

/// How well one derivative can be estimated from a segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoefficientSupport {
    /// Name as in a model file: `Cm_alpha`.
    pub name: String,
    /// How well the derivative can be estimated.
    pub support: Support,
    /// Two sigma over the value of the derivative, as a regression of this segment gives them; none where there is
    /// none.
    pub two_sigma_over_value: Option<f64>,
    /// How far its regressor moves with the others.
    pub inflation: Option<Inflation>,
    /// Why it cannot be estimated better, or how large its bound is, in words.
    pub reason: String,
}

/// A verdict with the regression that it is from.
pub(crate) struct Judged {
    pub(crate) coefficient: CoefficientSupport,
    /// The term as it was fitted.
    pub(crate) term: Option<TermFit>,
    /// Mean airspeed of the segment, m/s.
    pub(crate) speed: f64,
}

/// Variance inflation from which a regressor counts as moving with others.
const COLLINEAR: f64 = 20.0;
/// Smallest noise that is assumed for angles (rad) and rates (rad/s): less is rounding.
const ROUNDING: f64 = 1e-5;
/// A derivative counts as small where its bound corresponds to at most this part of the motion of the coefficient.
const SMALL: f64 = 0.1;

/// How well the derivatives of a group of axes can be estimated.
pub(crate) fn support(window: &Window, group: Group) -> Vec<Judged> {
    let coefficients = Coefficient::ALL.into_iter().filter(|c| c.group() == group);
    coefficients.flat_map(|coefficient| judge(window, coefficient)).collect()
}

/// Whether the effect of a surface shows in the moment that it makes; true where that cannot be decided.
pub(crate) fn answers(window: &Window, surface: &str) -> bool {
    let coefficient = match surface {
        "elevator" => Coefficient::PitchingMoment,
        "aileron" => Coefficient::RollingMoment,
        _ => Coefficient::YawingMoment,
    };
    let judged = judge(window, coefficient);
    let own = judged.iter().find_map(|j| j.term.as_ref().filter(|t| t.name == surface));
    own.is_none_or(|term| !term.value.is_finite() || 2.0 * term.std_error <= term.value.abs())
}

/// Channels of the regressors: name of the term, channel, words, and whether it is a rate (over the airspeed).
fn regressors(coefficient: Coefficient) -> &'static [(&'static str, &'static str, &'static str, bool)] {
    match coefficient.group() {
        Group::Longitudinal => &[
            ("alpha", "alpha", "angle of attack", false),
            ("q", "q", "pitch rate", true),
            ("elevator", "elevator", "elevator", false),
        ],
        Group::Lateral => &[
            ("beta", "beta", "sideslip", false),
            ("p", "p", "roll rate", true),
            ("r", "r", "yaw rate", true),
            ("aileron", "aileron", "aileron", false),
            ("rudder", "rudder", "rudder", false),
        ],
    }
}

/// Channels that the left side is made of, in words where they are missing.
fn left_channels(coefficient: Coefficient) -> &'static [(&'static str, &'static str)] {
    match coefficient {
        Coefficient::Lift | Coefficient::Drag => {
            &[("alpha", "no angle of attack"), ("ax", "no acceleration along x"), ("az", "no acceleration along z")]
        }
        Coefficient::PitchingMoment => &[("q", "no pitch rate")],
        Coefficient::SideForce => &[("ay", "no acceleration along y")],
        Coefficient::RollingMoment => &[("p", "no roll rate")],
        Coefficient::YawingMoment => &[("r", "no yaw rate")],
    }
}

fn judge(window: &Window, coefficient: Coefficient) -> Vec<Judged> {
    let terms = regressors(coefficient);
    let speed = window.channel("speed").map_or(f64::NAN, |(values, _)| {
        let present: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        present.iter().sum::<f64>() / present.len().max(1) as f64
    });
    let refused = |reason: &str| -> Vec<Judged> {
        let of = |(name, ..): &(&str, &str, &str, bool)| no(coefficient, name, reason.to_owned());
        terms.iter().map(|t| Judged { coefficient: of(t), term: None, speed }).collect()
    };
    let missing: Vec<&str> = left_channels(coefficient)
        .iter()
        .filter(|(channel, _)| window.channel(channel).is_none())
        .map(|(_, words)| *words)
        .collect();
    if !missing.is_empty() {
        return refused(&format!("{} was recorded", missing.join(", ")));
    }
    let Some(left) = left(window, coefficient) else { return refused("no airspeed was recorded") };
    let mut used: Vec<Regressor> = Vec::new();
    let mut absent: Vec<(&'static str, &'static str)> = Vec::new();
    for &(name, channel, words, rate) in terms {
        match regressor(window, name, channel, words, rate) {
            Some(found) => used.push(found),
            None => absent.push((name, words)),
        }
    }
    let mut judged: Vec<Judged> = match fit(window, &left, &used) {
        Ok(fit) => fit.terms.iter().map(|t| verdict(coefficient, t, &fit, speed)).collect(),
        Err(reason) => used
            .iter()
            .map(|r| Judged { coefficient: no(coefficient, r.name, reason.clone()), term: None, speed })
            .collect(),
    };
    for (name, words) in &absent {
        judged.push(Judged {
            coefficient: no(coefficient, name, format!("no {words} was recorded")),
            term: None,
            speed,
        });
    }
    // A flow angle that was not measured is in everything that it would have explained.
    if let Some((_, words)) = absent.iter().find(|(name, _)| ["alpha", "beta"].contains(name)) {
        for other in judged.iter_mut().filter(|j| j.coefficient.support > Support::No) {
            other.coefficient.support = Support::No;
            other.coefficient.reason = format!("no {words} was recorded, and its effect would be taken for this one");
        }
    }
    if coefficient == Coefficient::PitchingMoment && absent.is_empty() {
        judged.extend(alpha_rate(window, &left, used, speed));
    }
    judged
}

/// How well the derivative with respect to the rate of the angle of attack can be estimated beside that of the pitch
/// rate.
fn alpha_rate(window: &Window, left: &Left, mut used: Vec<Regressor>, speed: f64) -> Option<Judged> {
    let (alpha, noise) = window.channel("alpha")?;
    let (airspeed, _) = window.channel("speed")?;
    let time = &window.time;
    let mut values = vec![f64::NAN; time.len()];
    for k in 1..time.len().saturating_sub(1) {
        values[k] = (alpha[k + 1] - alpha[k - 1]) / (time[k + 1] - time[k - 1]) / airspeed[k];
    }
    let step = (time.last()? - time.first()?) / time.len() as f64;
    let noise = noise / (std::f64::consts::SQRT_2 * step * speed);
    used.push(Regressor { words: "rate of the angle of attack", name: "alpha_dot", values, noise });
    let fit = fit(window, left, &used).ok()?;
    let term = fit.terms.last()?;
    Some(verdict(Coefficient::PitchingMoment, term, &fit, speed))
}

fn regressor(window: &Window, name: &'static str, channel: &str, words: &'static str, rate: bool) -> Option<Regressor> {
    let (values, noise) = window.channel(channel)?;
    let noise = noise.max(ROUNDING);
    let (speed, _) = window.channel("speed")?;
    let values = values.iter().zip(speed).map(|(v, speed)| if rate { v / speed } else { *v }).collect();
    let typical = speed.iter().copied().find(|v| v.is_finite() && *v > 0.0).unwrap_or(1.0);
    Some(Regressor { words, name, values, noise: if rate { noise / typical } else { noise } })
}

/// The coefficient up to a constant. The airspeed changes slowly beside an angular rate, so that `(q / V^2)'` is `q' /
/// V^2`.
fn left(window: &Window, coefficient: Coefficient) -> Option<Left> {
    let (speed, _) = window.channel("speed")?;
    let over = |values: Vec<f64>| values.iter().zip(speed).map(|(v, speed)| v / (speed * speed)).collect::<Vec<f64>>();
    let channel = |name: &str| window.channel(name).map(|(values, _)| values.to_vec());
    let wind = |along: fn(f64, f64, f64) -> f64| {
        let (alpha, ax, az) = (channel("alpha")?, channel("ax")?, channel("az")?);
        Some(over(alpha.iter().zip(&ax).zip(&az).map(|((alpha, ax), az)| along(*alpha, *ax, *az)).collect()))
    };
    Some(match coefficient {
        Coefficient::Lift => Left::Value(wind(|alpha, ax, az| ax * alpha.sin() - az * alpha.cos())?),
        Coefficient::Drag => Left::Value(wind(|alpha, ax, az| -(ax * alpha.cos() + az * alpha.sin()))?),
        Coefficient::SideForce => Left::Value(over(channel("ay")?)),
        Coefficient::PitchingMoment => Left::Integral(over(channel("q")?)),
        Coefficient::RollingMoment => Left::Integral(over(channel("p")?)),
        Coefficient::YawingMoment => Left::Integral(over(channel("r")?)),
    })
}

fn no(coefficient: Coefficient, name: &str, reason: String) -> CoefficientSupport {
    CoefficientSupport {
        name: format!("{}_{name}", coefficient.symbol()),
        support: Support::No,
        two_sigma_over_value: None,
        inflation: None,
        reason,
    }
}

fn verdict(coefficient: Coefficient, term: &TermFit, fit: &Fit, speed: f64) -> Judged {
    let bound = 2.0 * term.std_error;
    let relative = bound / term.value.abs();
    let percent = 100.0 * relative;
    // False if the bound corresponds to more than a tenth of the motion of the coefficient.
    let small = bound * term.spread <= SMALL * fit.spread;
    let inflation = &term.inflation;
    let (support, reason) = if !term.moved {
        (Support::No, format!("the {} did not move above its noise", term.words))
    } else if relative <= 0.25 {
        (Support::Told, format!("2 sigma are {percent:.1} % of its value"))
    } else if relative <= 1.0 {
        (Support::Roughly, format!("2 sigma are {percent:.0} % of its value{}", collinear(term)))
    } else if small {
        (Support::Small, "its effect is too small here to be distinguished from zero".to_owned())
    } else if inflation.variance_inflation > COLLINEAR {
        (Support::No, collinear(term).trim_start_matches(": ").to_owned())
    } else {
        (Support::No, "its effect does not show above the noise of the equation".to_owned())
    };
    let coefficient = CoefficientSupport {
        name: format!("{}_{}", coefficient.symbol(), term.name),
        support,
        two_sigma_over_value: relative.is_finite().then_some(relative),
        inflation: term.moved.then(|| inflation.clone()),
        reason,
    };
    Judged { coefficient, term: Some(term.clone()), speed }
}

/// `: elevator and pitch rate move together (variance inflation 40)`, where they do.
fn collinear(term: &TermFit) -> String {
    let Inflation { variance_inflation, with } = &term.inflation;
    if *variance_inflation <= COLLINEAR {
        return String::new();
    }
    match with {
        Some((other, correlation)) if correlation.abs() > 0.7 => {
            format!(": {} and {other} move together (variance inflation {variance_inflation:.0})", term.words)
        }
        _ => format!(": {} moves with the others together (variance inflation {variance_inflation:.0})", term.words),
    }
}
