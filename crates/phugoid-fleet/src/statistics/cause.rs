//! What explains that several parameters of an airframe change at once: one of them alone, or a sensor.
//!
//! A vane that is exchanged for another one, with another scale, moves every derivative by the angle of attack at the same flight,
//! each as far as an error of the vane moves it. A damaged tail moves the derivatives that the tail makes. The changes `s` of all
//! parameters at one flight (or their slopes) are therefore held against each explanation `X`,
//!
//! ```text
//! s = X c + e,   cov(e) = V = S R S        S: standard errors of the changes, R: correlation of the flights' residuals
//! c = (X^T V^-1 X)^-1 X^T V^-1 s           generalised least squares
//! chi^2 = (s - X c)^T V^-1 (s - X c)       with as many degrees of freedom as parameters less unknowns
//! ```
//!
//! where `X` is 1 for one parameter and 0 for the others, or what one declared standard uncertainty of a quantity does to the mean of
//! each parameter, or that of the flow angles with what an error of their zero does to the constants beside.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use phugoid_identification::estimation::UncertainQuantity;
use serde::Serialize;

use super::course::{Change, Fit, Observation, drift, level_change, line, two_levels};
use super::distribution::chi_squared_above;
use super::tell::{Airframe, Course, Shape};
use crate::row::QUANTITIES;

/// What may have changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind", content = "name")]
pub enum Cause {
    /// The aircraft: one parameter, and no other.
    Parameter(String),
    /// What is declared of a quantity, as the scale of the airspeed: a sensor, the mass, the thrust.
    Quantity(UncertainQuantity),
    /// Scale and zero of the flow angles, as those of another vane.
    Vane,
}

/// A cause that explains the changes of all parameters of an airframe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// The cause.
    pub cause: Cause,
    /// How large it is. Of a parameter in its unit; of a quantity in its declared standard uncertainties, positive where the sensor
    /// shows more or later than before, and where mass, inertia or thrust are larger. Of a drift that per flight, or per hour.
    pub size: f64,
    /// One sigma of it.
    pub std_error: f64,
    /// Of a vane: by how much more its zero shows than before, rad, or rad per flight or hour of a drift.
    pub zero_rad: Option<f64>,
    /// One sigma of that, rad.
    pub zero_std_rad: Option<f64>,
    /// Squared distance of the changes from what the cause makes of them.
    pub chi_squared: f64,
    /// Probability of as large a distance where the cause is the right one.
    pub p_value: f64,
}

/// What an airframe's courses do together, and what explains it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Together {
    /// Drift or step: that of the most certain course.
    pub shape: Shape,
    /// First flight (or hours) after a step.
    pub at: Option<f64>,
    /// Number of parameters whose courses were asked.
    pub parameters: usize,
    /// The causes that explain all of them, the likeliest first; empty where none does.
    pub explanations: Vec<Explanation>,
}

/// A cause is no explanation where as large a distance has a smaller probability, or where another cause leaves so much less: three
/// sigma.
const LEAST_P: f64 = 0.01;
const MOST_BEHIND: f64 = 9.0;
/// What the zero of a vane has to explain besides its scale: two sigma.
const GAIN_OF_A_ZERO: f64 = 4.0;
/// With fewer parameters every cause explains what they do.
const FEWEST_PARAMETERS: usize = 3;
/// Effects of an error are known to first order, and as means over flights: by this part of them a change may be another one.
const FIRST_ORDER: f64 = 0.1;

/// What explains the drift or the step that has been found in an airframe's courses; `None` where none has, or where fewer than three
/// parameters can be asked. Takes the verdicts on the courses ([`Course::shape`]) as they are.
pub(super) fn together(airframe: &Airframe) -> Option<Together> {
    let found = |course: &&Course| matches!(course.shape, Shape::Drift | Shape::Step);
    let p = |course: &Course| course.change_rate.unwrap_or(1.0);
    // Of several that are as certain, the one that is surer of its place.
    let surest = airframe.courses.iter().filter(found).min_by(|a, b| {
        let p_of = |course: &Course| change(course).map_or(1.0, |change| change.p_value);
        p(a).total_cmp(&p(b)).then(p_of(a).total_cmp(&p_of(b)))
    })?;
    let at = (surest.shape == Shape::Step).then_some(surest.step?.at);
    let asked: Vec<Asked> = airframe.courses.iter().filter_map(|course| Asked::of(course, at)).collect();
    if asked.len() < FEWEST_PARAMETERS {
        return None;
    }
    let correlation = correlation(&asked);
    let mut explanations: Vec<Explanation> =
        causes(&asked).into_iter().filter_map(|(cause, x)| explained(&asked, &correlation, cause, &x)).collect();
    explanations.retain(|explanation| explanation.p_value >= LEAST_P);
    explanations.sort_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared));
    let least = explanations.first().map_or(0.0, |first| first.chi_squared);
    explanations.retain(|explanation| explanation.chi_squared <= least + MOST_BEHIND);
    // A zero that is not needed is not told.
    let scale = Cause::Quantity(UncertainQuantity::FlowAngleScale);
    if let Some(scale) = explanations.iter().find(|e| e.cause == scale).map(|e| e.chi_squared) {
        explanations.retain(|e| e.cause != Cause::Vane || e.chi_squared + GAIN_OF_A_ZERO < scale);
    }
    Some(Together { shape: surest.shape, at, parameters: asked.len(), explanations })
}

/// The change that the verdict on a course is about.
fn change(course: &Course) -> Option<Change> {
    if course.shape == Shape::Step { course.step } else { course.drift }
}

/// A course with its change at the place of the airframe's.
struct Asked<'a> {
    course: &'a Course,
    change: Change,
    fit: Fit,
}

impl<'a> Asked<'a> {
    fn of(course: &'a Course, at: Option<f64>) -> Option<Self> {
        let observations: Vec<Observation> = course
            .points
            .iter()
            .map(|p| Observation { at: p.at, value: p.value, random_std: p.own_std, budget: [0.0; QUANTITIES] })
            .collect();
        let (change, fit) = match at {
            Some(at) => (level_change(&observations, at)?, two_levels(&observations, at)),
            None => (drift(&observations)?, line(&observations)?.0),
        };
        (change.std_error > 0.0 && change.std_error.is_finite() && change.size.is_finite()).then_some(Self {
            course,
            change,
            fit,
        })
    }

    /// Standard error of the change, with what Student's distribution of it is wider than the normal one.
    fn std_error(&self) -> f64 {
        let freedom = self.course.points.len().saturating_sub(2) as f64;
        self.change.std_error * (freedom / (freedom - 2.0).max(1.0)).sqrt()
    }
}

/// Correlation of the residuals of the flights that all courses have; less of it where there are few such flights.
fn correlation(asked: &[Asked]) -> DMatrix<f64> {
    let count = asked.len();
    let mut by_flight: BTreeMap<(&str, i64), Vec<f64>> = BTreeMap::new();
    for one in asked {
        for (point, fitted) in one.course.points.iter().zip(&one.fit.fitted) {
            by_flight
                .entry((&point.log_sha256, point.segment))
                .or_default()
                .push((point.value - fitted) / point.own_std);
        }
    }
    let common: Vec<Vec<f64>> = by_flight.into_values().filter(|residuals| residuals.len() == count).collect();
    let product = |i: usize, j: usize| common.iter().map(|r| r[i] * r[j]).sum::<f64>();
    // As many flights as parameters tell nothing of a matrix.
    let trusted = 1.0 - (count as f64 / common.len().max(1) as f64).min(1.0);
    DMatrix::from_fn(count, count, |i, j| {
        let whole = (product(i, i) * product(j, j)).sqrt();
        if i == j {
            1.0
        } else if whole > 0.0 {
            trusted * product(i, j) / whole
        } else {
            0.0
        }
    })
}

/// Every cause, with what a unit of each of its unknowns does to each parameter.
fn causes(asked: &[Asked]) -> Vec<(Cause, DMatrix<f64>)> {
    let count = asked.len();
    let column = |of: &dyn Fn(&Course) -> f64| DVector::from_iterator(count, asked.iter().map(|one| of(one.course)));
    let mut causes: Vec<(Cause, DMatrix<f64>)> = (0..count)
        .map(|own| {
            let x = DMatrix::from_fn(count, 1, |j, _| if j == own { 1.0 } else { 0.0 });
            (Cause::Parameter(asked[own].course.parameter.clone()), x)
        })
        .collect();
    let zero = column(&|course| of_zero(asked, &course.parameter));
    for (place, quantity) in UncertainQuantity::ALL.into_iter().enumerate() {
        let effects = column(&|course| course.effects[place]);
        if effects.iter().all(|effect| *effect == 0.0) {
            continue;
        }
        if quantity == UncertainQuantity::FlowAngleScale && zero.iter().any(|effect| *effect != 0.0) {
            causes.push((Cause::Vane, DMatrix::from_columns(&[effects.clone(), zero.clone()])));
        }
        causes.push((Cause::Quantity(quantity), DMatrix::from_columns(&[effects])));
    }
    causes
}

/// What a vane whose zero shows one radian too much does to a parameter, to first order. The constant of a coefficient becomes smaller
/// by its slope; and lift and drag are taken apart at the wrong angle, so that drag gets of lift, and lift loses of drag.
fn of_zero(asked: &[Asked], parameter: &str) -> f64 {
    let value = |name: String| {
        asked.iter().find(|one| one.course.parameter == name).map_or(0.0, |one| one.course.combined.value)
    };
    let Some((coefficient, variable)) = parameter.split_once('_') else { return 0.0 };
    let shifted = if variable == "0" { -value(format!("{coefficient}_alpha")) } else { 0.0 };
    let turned = match coefficient {
        "CD" => value(format!("CL_{variable}")),
        "CL" => -value(format!("CD_{variable}")),
        _ => 0.0,
    };
    shifted + turned
}

/// The cause with its size, fitted to all changes; `None` where the numbers do not allow it.
fn explained(asked: &[Asked], correlation: &DMatrix<f64>, cause: Cause, x: &DMatrix<f64>) -> Option<Explanation> {
    let (count, unknowns) = (asked.len(), x.ncols());
    let sizes = DVector::from_iterator(count, asked.iter().map(|one| one.change.size));
    let errors = DVector::from_iterator(count, asked.iter().map(Asked::std_error));
    let solve = |more: &DVector<f64>| {
        let covariance = DMatrix::from_fn(count, count, |i, j| {
            correlation[(i, j)] * errors[i] * errors[j] + if i == j { more[i] } else { 0.0 }
        });
        let inverse = covariance.cholesky()?.inverse();
        let information = (x.transpose() * &inverse * x).cholesky()?.inverse();
        let fitted = &information * x.transpose() * &inverse * &sizes;
        let left = &sizes - x * &fitted;
        let chi_squared = left.dot(&(inverse * &left));
        Some((fitted, information, chi_squared))
    };
    let (first, ..) = solve(&DVector::zeros(count))?;
    let is_of_a_parameter = matches!(cause, Cause::Parameter(_));
    let vague = (x * &first).map(|effect| if is_of_a_parameter { 0.0 } else { (FIRST_ORDER * effect).powi(2) });
    let (fitted, information, chi_squared) = solve(&vague)?;
    let p_value = chi_squared_above(chi_squared, (count - unknowns) as f64);
    let std = |place: usize| information[(place, place)].sqrt();
    let (zero_rad, zero_std_rad) = (fitted.get(1).copied(), (unknowns > 1).then(|| std(1)));
    Some(Explanation { cause, size: fitted[0], std_error: std(0), zero_rad, zero_std_rad, chi_squared, p_value })
}

impl Explanation {
    /// Cause and size, with two sigma: `flow angles: +1.7 +- 0.2 declared standard uncertainties`.
    pub fn words(&self) -> String {
        let size = |unit: &str| format!("{:+.2} +- {:.2} {unit}", self.size, 2.0 * self.std_error);
        match &self.cause {
            Cause::Parameter(name) => format!("{name} alone, {:+.2e} +- {:.0e}", self.size, 2.0 * self.std_error),
            Cause::Quantity(quantity) => format!("{}: {}", quantity.name(), size("declared standard uncertainties")),
            Cause::Vane => format!(
                "flow angles: scale {}, zero {:+.2} +- {:.2} deg",
                size("declared standard uncertainties"),
                self.zero_rad.unwrap_or(f64::NAN).to_degrees(),
                2.0 * self.zero_std_rad.unwrap_or(f64::NAN).to_degrees()
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logs::LogRow;
    use crate::row::Row;
    use crate::simulated::normal;
    use crate::statistics::tell::{Question, tell};
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    /// Name, value, random part of a flight, and what one sigma of the scale of the flow angles (3 %), of the airspeed (1.5 %) and of
    /// the inertia (6 %) does: by the powers of each in a derivative.
    const PARAMETERS: [(&str, f64, f64, [f64; 3]); 6] = [
        ("CL_0", 0.2, 0.004, [0.0, -0.006, 0.0]),
        ("CL_alpha", 5.0, 0.06, [-0.15, -0.15, 0.0]),
        ("Cm_0", 0.05, 0.001, [0.0, 0.0, 0.0]),
        ("Cm_alpha", -0.6, 0.006, [0.018, 0.018, -0.036]),
        ("Cm_q", -14.0, 0.5, [0.0, 0.42, -0.84]),
        ("Cm_elevator", -1.4, 0.015, [0.0, 0.042, -0.084]),
    ];

    /// What the flights of one airframe tell when their parameters get this from flight 31 of 60 on.
    fn told(generator: &mut Pcg64Mcg, change: impl Fn(usize) -> f64) -> Option<Together> {
        let places = [UncertainQuantity::FlowAngleScale, UncertainQuantity::AirspeedScale, UncertainQuantity::Inertia];
        let (mut rows, mut logs) = (Vec::new(), Vec::new());
        for flight in 1..=60 {
            let hash = format!("{flight:064}");
            // Errors of slopes and constants of one flight belong together.
            let common = normal(generator);
            for (place, (name, value, std, effects)) in PARAMETERS.into_iter().enumerate() {
                let error = std * (0.6 * common + 0.8 * normal(generator));
                let mut row = Row {
                    kind: "log".to_owned(),
                    source_sha256: Some(hash.clone()),
                    status: "sound".to_owned(),
                    segment: Some(1),
                    parameter: Some(name.to_owned()),
                    parameter_status: Some("converged".to_owned()),
                    value: Some(value + error + if flight > 30 { change(place) } else { 0.0 }),
                    std_error: Some(3.0 * std),
                    random_std: Some(std),
                    ..Row::default()
                };
                places.iter().zip(effects).for_each(|(quantity, effect)| row.budget[*quantity as usize] = Some(effect));
                rows.push(row);
            }
            logs.push(LogRow {
                log_sha256: hash,
                path: format!("{flight:03}.csv"),
                airframe: "N1".to_owned(),
                ..LogRow::default()
            });
        }
        tell(&rows, &logs, &Question::default()).unwrap().airframes[0].together.clone()
    }

    /// The likeliest cause, if one stands.
    fn first(together: &Option<Together>) -> Option<&Explanation> {
        together.as_ref()?.explanations.first()
    }

    /// Twenty trials of each, of which each has to be named rightly in nineteen.
    #[test]
    fn another_vane_a_damaged_tail_and_a_wrong_airspeed_are_told_apart() {
        let mut generator = Pcg64Mcg::seed_from_u64(31);
        let mut right = [0; 4];
        for _ in 0..20 {
            // Another vane shows 4 % less and has the same zero.
            let vane = told(&mut generator, |k| -4.0 / 3.0 * PARAMETERS[k].3[0]);
            let is_it = |e: &Explanation| {
                let of_the_vane = matches!(e.cause, Cause::Vane | Cause::Quantity(UncertainQuantity::FlowAngleScale));
                of_the_vane && (e.size + 4.0 / 3.0).abs() < 3.0 * e.std_error
            };
            let is_there = vane.as_ref().and_then(|vane| vane.at).is_some_and(|at| (at - 31.0).abs() <= 3.0);
            right[0] += usize::from(is_there && first(&vane).is_some_and(is_it));
            // The same with a zero of 0.3 deg.
            let zero = 0.3_f64.to_radians();
            let with_zero = told(&mut generator, |k| {
                let of_zero = match PARAMETERS[k].0 {
                    "CL_0" => -5.0 * zero,
                    "Cm_0" => 0.6 * zero,
                    _ => 0.0,
                };
                of_zero - 4.0 / 3.0 * PARAMETERS[k].3[0]
            });
            let is_it = |e: &Explanation| e.zero_rad.is_some_and(|found| (found - zero).abs() < 0.2 * zero);
            right[1] += usize::from(first(&with_zero).is_some_and(is_it));
            // A tail that gives five percent less pitching moment by the elevator alone.
            let tail = told(&mut generator, |k| if PARAMETERS[k].0 == "Cm_elevator" { 0.07 } else { 0.0 });
            let cause = Cause::Parameter("Cm_elevator".to_owned());
            right[2] += usize::from(first(&tail).is_some_and(|e| e.cause == cause));
            // Airspeed and inertia move the same parameters and not in the same proportions.
            let airspeed = told(&mut generator, |k| 1.5 * PARAMETERS[k].3[1]);
            let cause = Cause::Quantity(UncertainQuantity::AirspeedScale);
            right[3] += usize::from(first(&airspeed).is_some_and(|e| e.cause == cause));
        }
        assert!(right.iter().all(|count| *count >= 19), "{right:?} of 20");
    }

    #[test]
    fn what_no_single_cause_makes_is_said_so_and_steady_courses_have_none() {
        let mut generator = Pcg64Mcg::seed_from_u64(32);
        let several = told(&mut generator, |k| [0.03, -0.3, 0.0, -0.05, 0.0, 0.1][k]).unwrap();
        assert_eq!((several.parameters, several.explanations.len()), (6, 0), "{several:?}");
        assert_eq!(told(&mut generator, |_| 0.0), None);
    }
}
