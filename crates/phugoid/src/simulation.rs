//! Simulated flights.

use crate::Error;
use crate::studies::{Flight, Scenario, fly_with_progress};

/// Flies a scenario: aircraft, condition, manoeuvre, gusts, damage and sensors.
///
/// [`Flight::measured`] is what the sensors recorded, [`Flight::truth`] what was true, and [`Flight::true_parameters`]
/// what an estimator has to find. The same scenario with the same `seed` gives the same flight on every machine.
///
/// ```
/// use phugoid::{Scenario, simulate};
/// let calm = Scenario::named("f16-calm")?;
/// let flight = simulate(&Scenario { duration: "2 s".parse().expect("a time"), seed: 7, ..calm })?;
/// assert_eq!(flight.measured.len(), 201);
/// assert_eq!(flight.true_parameters["dCm_alpha"], -0.2);
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Flight`]: no trim in this condition, a recorded input that cannot be read, a motion that diverges.
pub fn simulate(scenario: &Scenario) -> Result<Flight, Error> {
    simulate_with_progress(scenario, &|_| ())
}

/// As [`simulate`]; `progress` is called with the fraction flown, from 0 to 1.
///
/// ```
/// use phugoid::{Scenario, simulate_with_progress};
/// let called = std::cell::Cell::new(0);
/// simulate_with_progress(&Scenario::named("f16-calm")?, &|_| called.set(called.get() + 1))?;
/// assert!(called.get() > 0);
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// As [`simulate`].
pub fn simulate_with_progress(scenario: &Scenario, progress: &dyn Fn(f64)) -> Result<Flight, Error> {
    Ok(fly_with_progress(scenario, progress)?)
}
