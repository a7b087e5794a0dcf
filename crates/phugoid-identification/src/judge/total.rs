//! Total derivatives: what an increment and the database that it is added to make together.
//!
//! An increment by itself says how far the aircraft is from its database and nothing of how stable it is. With the slope of the
//! database at the reference condition it is the derivative that a build-up without a database has:
//!
//! ```text
//! C_v = (C(hi) - C(lo)) / (hi - lo) + dC_v         all variables but v at the reference
//! ```
//!
//! The slope is the secant over the range of `v` that was flown, from its 2 % to its 98 % point, because the increment is the one
//! that fits over this range. A table that bends there has no single slope: how far its local slopes lie from the secant, as a
//! root mean square over the flight, stands in the bound of the increment, since another range would have given another increment.
//! The total is of the same range, and its bound is that of the increment: it holds where the table has the right shape, and is off
//! by an increment. What is wrong with the shape itself nothing here knows.

use phugoid_flight_data::statistics::{Rank, median, quantile};

use crate::core::axes::Axes;
use crate::core::estimation::{FinalStatus, ParameterResult, TotalDerivative};
use crate::core::output::Output;
use crate::core::term::{Coefficient, Term, Variable};
use crate::model_file::{Base, ModelFile, Parameter, RateSpeed, Role};
use crate::motion::Motion;
use crate::preparation::database_part::Condition;
use crate::preparation::prepare::database;
use crate::preparation::prepared::Prepared;

/// The part of the flight's values below the range, and above it.
const TAIL: f64 = 0.02;
/// The secant is taken over no less than this, rad (or dimensionless): where nothing moved there is only the local slope.
const LEAST_RANGE: f64 = 1e-3;
/// Local slopes are differences over this part of the range.
const LOCAL: f64 = 0.02;
/// Samples at which local slopes are taken, at most.
const MOST_SAMPLES: usize = 500;

/// The longitudinal variables that a database has a slope by.
const VARIABLES: [Variable; 3] = [Variable::Alpha, Variable::PitchRate, Variable::Elevator];
/// The coefficients that it gives, in its order.
const COEFFICIENTS: [Coefficient; 3] = [Coefficient::Lift, Coefficient::Drag, Coefficient::PitchingMoment];

/// The total derivatives of a longitudinal estimation of increments to a database; none of any other.
pub(crate) fn totals<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
    parameters: &[ParameterResult],
) -> Vec<TotalDerivative> {
    if file.base == Base::None || file.axes != Axes::Longitudinal {
        return Vec::new();
    }
    // The record was prepared with it, so that it is there.
    let Ok(database) = database(file) else { return Vec::new() };
    let flown = VARIABLES.map(|variable| in_flight::<M, N, R>(prepared, file, variable));
    let reference = [prepared.reference.alpha, 0.0, prepared.reference.elevator];
    // An aircraft of a file asks for the air as well.
    let Condition { speed, density } = prepared.condition(file);
    let of = |result: &ParameterResult| {
        let parameter = file.parameters.iter().find(|p| p.name == result.name)?;
        let Role::Term(coefficient, term) = &parameter.role else { return None };
        let place = VARIABLES.iter().position(|v| term.single() == Some(v.index()))?;
        let bends = |other: &Parameter| match &other.role {
            Role::Term(of, with) => of == coefficient && with != term && involves(with, VARIABLES[place]),
            _ => false,
        };
        // With a square or a product beside it the increment is no derivative over the range.
        if file.parameters.iter().any(bends) {
            return None;
        }
        let row = COEFFICIENTS.iter().position(|known| known == coefficient)?;
        let at = |value: f64| {
            let mut at = reference;
            at[place] = value * flown[place].actual;
            let [alpha, q_hat, elevator] = at;
            database.coefficients(speed, density, alpha, q_hat, elevator)[row]
        };
        let table = Secant::over(&flown[place].values, reference[place], at)?;
        let name = format!("{}_{}", coefficient.symbol(), VARIABLES[place].short_name());
        let estimated = result.status != FinalStatus::Fixed;
        let std_error = if estimated { result.corrected_std_error } else { 0.0 };
        Some(TotalDerivative {
            name,
            unit: result.unit.clone(),
            value: table.slope + result.value,
            std_error,
            status: result.status,
            increment: result.name.clone(),
            database: table.slope,
            database_std: table.spread,
            increment_std_error: std_error.hypot(table.spread),
            variable: VARIABLES[place].name().to_owned(),
            range: table.range,
            reference_alpha: prepared.reference.alpha,
            reference_elevator: prepared.reference.elevator,
        })
    };
    parameters.iter().filter(|p| !p.nuisance).filter_map(of).collect()
}

/// Whether a term changes with a variable.
fn involves(term: &Term, variable: Variable) -> bool {
    term.powers().any(|(index, _)| index == variable.index())
}

/// The values that a variable had.
struct InFlight {
    /// As the terms have them; those that are not known are left out.
    values: Vec<f64>,
    /// What they are multiplied by for the database, which makes rates dimensionless with the actual airspeed.
    actual: f64,
}

fn in_flight<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
    variable: Variable,
) -> InFlight {
    let output = |output: Output| -> Vec<f64> {
        let row = M::AXES.row(output);
        let values = row.map_or(Vec::new(), |row| prepared.outputs.iter().map(|y| y[row]).collect());
        values.into_iter().filter(|value: &f64| value.is_finite()).collect()
    };
    match variable {
        Variable::PitchRate => {
            let actual = median(&mut output(Output::TrueAirspeed)).unwrap_or(f64::NAN);
            let speed = match file.rate_speed {
                RateSpeed::Actual => actual,
                RateSpeed::Reference => file.aircraft.reference_speed.unwrap_or(f64::NAN),
            };
            let hat = 0.5 * file.aircraft.mean_chord / speed;
            InFlight {
                values: output(Output::PitchRate).into_iter().map(|q| q * hat).collect(),
                actual: speed / actual,
            }
        }
        Variable::Alpha => InFlight { values: output(Output::Alpha), actual: 1.0 },
        _ => InFlight { values: prepared.inputs.iter().map(|input| M::deflections(input)[0]).collect(), actual: 1.0 },
    }
}

/// The slope of a database over what was flown.
pub(crate) struct Secant {
    slope: f64,
    /// Root mean square of the local slopes about it.
    spread: f64,
    range: [f64; 2],
}

impl Secant {
    pub(crate) const fn slope(&self) -> f64 {
        self.slope
    }

    /// None where nothing is known of the variable, or the database has no value.
    pub(crate) fn over(flown: &[f64], reference: f64, at: impl Fn(f64) -> f64) -> Option<Self> {
        let mut values = flown.to_vec();
        let mut low = quantile(&mut values, TAIL, Rank::Nearest)?;
        let mut high = quantile(&mut values, 1.0 - TAIL, Rank::Nearest)?;
        if high - low < LEAST_RANGE {
            (low, high) = (reference - 0.5 * LEAST_RANGE, reference + 0.5 * LEAST_RANGE);
        }
        let slope = (at(high) - at(low)) / (high - low);
        let half = 0.5 * LOCAL * (high - low);
        let inside: Vec<f64> = flown.iter().copied().filter(|v| (low..=high).contains(v)).collect();
        let step = inside.len().div_ceil(MOST_SAMPLES).max(1);
        let squares: Vec<f64> = inside
            .iter()
            .step_by(step)
            .map(|v| ((at(v + half) - at(v - half)) / (2.0 * half) - slope).powi(2))
            .collect();
        let spread = if squares.is_empty() { 0.0 } else { (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() };
        (slope.is_finite() && spread.is_finite()).then_some(Self { slope, spread, range: [low, high] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_table_has_its_slope_and_a_bent_one_the_secant_and_a_spread() {
        let flown: Vec<f64> = (0..=100).map(|k| 0.001 * f64::from(k)).collect();
        let straight = Secant::over(&flown, 0.05, |v| 3.0 * v + 1.0).unwrap();
        assert!(
            (straight.slope - 3.0).abs() < 1e-12 && straight.spread < 1e-9,
            "{} {}",
            straight.slope,
            straight.spread
        );
        assert_eq!(straight.range, [0.002, 0.098]);
        // The slope of v^2 runs from 0.004 to 0.196: uniform, with a standard deviation of its width over root twelve.
        let bent = Secant::over(&flown, 0.05, |v| v * v).unwrap();
        assert!((bent.slope - 0.1).abs() < 1e-12, "{}", bent.slope);
        assert!((bent.spread - 0.192 / 12_f64.sqrt()).abs() < 0.02 * bent.spread, "{}", bent.spread);
        // Nothing moved: the slope at the reference.
        let still = Secant::over(&[0.02; 50], 0.03, |v| v * v).unwrap();
        assert!((still.slope - 0.06).abs() < 1e-9, "{}", still.slope);
        assert!(Secant::over(&[], 0.0, |v| v).is_none() && Secant::over(&flown, 0.0, |_| f64::NAN).is_none());
    }
}
