//! An aircraft that is not quite what its tables say: what the error of a model does to an estimator.

use std::collections::BTreeMap;

use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::modified::Modified;
use phugoid_flight_dynamics::scalar::Scalar;
use phugoid_flight_dynamics::trim::Trim;

use crate::equivalent::equivalent_increments;
use crate::scenario::{ModelError, TableFactors};

/// An aircraft whose coefficients differ from those of `aircraft` as a [`ModelError`] says.
#[derive(Clone, Copy, Debug)]
pub struct Misjudged<'a, A> {
    aircraft: &'a A,
    factors: TableFactors,
    alpha_squared: f64,
    alpha_reference: f64,
}

impl<'a, A: Aircraft> Misjudged<'a, A> {
    /// The aircraft that flies when `aircraft` is what is known of it. The quadratic term is about the angle of attack
    /// `alpha_reference` (rad), where it vanishes with its slope.
    pub fn new(aircraft: &'a A, error: &ModelError, alpha_reference: f64) -> Self {
        Self { aircraft, factors: error.tables, alpha_squared: error.Cm_alpha_squared, alpha_reference }
    }

    /// The increments to the known aircraft that the error amounts to at a trim, of the derivatives alone. What an estimator
    /// that is told the tables alone should find beside the scenario's own increments, if it flies close to the trim.
    pub fn equivalent_increments(&self, trim: &Trim) -> BTreeMap<String, f64> {
        let mut found = equivalent_increments(self.aircraft, self, trim, &Increments::NONE, |c| c);
        let derivatives = Increments::NONE.named();
        found.retain(|name, _| derivatives.iter().any(|(known, _)| known == name));
        found
    }
}

impl<A: Aircraft> Modified for Misjudged<'_, A> {
    type Unmodified = A;

    fn unmodified(&self) -> &A {
        self.aircraft
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let c = self.aircraft.coefficients(air, rates, controls);
        let f = &self.factors;
        let from_trim = air.alpha - self.alpha_reference;
        Coefficients {
            cx: c.cx * f.CX,
            cy: c.cy * f.CY,
            cz: c.cz * f.CZ,
            cl: c.cl * f.Cl,
            cm: c.cm * f.Cm + from_trim * from_trim * self.alpha_squared,
            cn: c.cn * f.Cn,
        }
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let c = self.aircraft.alpha_rate_coefficients(air, rates, controls)?;
        let f = &self.factors;
        Some(Coefficients {
            cx: c.cx * f.CX,
            cy: c.cy * f.CY,
            cz: c.cz * f.CZ,
            cl: c.cl * f.Cl,
            cm: c.cm * f.Cm,
            cn: c.cn * f.Cn,
        })
    }
}
