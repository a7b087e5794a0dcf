//! A propeller: what it makes of the power of its engine.

use phugoid_flight_dynamics::scalar::Scalar;

use crate::expansion::expanded;
use crate::jsbsim::{GivenPropeller, GivenTables};

/// Steps of the central differences: those of power and density are shares of them, that of the speed is in m/s. The balance is
/// found to some 1e-14, so that derivatives between the kinks of the tables are good to 1e-8.
const STEPS: [f64; 3] = [1e-5, 1e-3, 1e-5];
/// The least step of the power, W.
const LEAST_POWER_STEP: f64 = 0.1;

/// What describes a [`Propeller`].
#[derive(Clone, Debug, PartialEq)]
pub struct PropellerData {
    /// Diameter `D`, m.
    pub diameter_m: f64,
    /// The most turns per second `n` that it makes: a governor holds them by the pitch of the blades where that changes, and else
    /// the engine is throttled there.
    pub most_turns_s: f64,
    /// Advance ratios `V/(n D)` of the rows of the coefficients, increasing.
    pub advance_ratio: Vec<f64>,
    /// Pitch of the blades of the columns of the coefficients, rad, increasing; empty for blades that cannot be turned.
    pub pitch_rad: Vec<f64>,
    /// Thrust coefficients `T/(rho n^2 D^4)`, row by row.
    pub thrust_coefficient: Vec<f64>,
    /// Power coefficients `P/(rho n^3 D^5)`, row by row.
    pub power_coefficient: Vec<f64>,
}

/// Why numbers make no [`Propeller`]. The field is the one of [`PropellerData`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PropellerError {
    /// A size that has to be positive and finite.
    #[error("`{field}` is {value}: it has to be positive and finite")]
    Size {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// Keys of the tables that do not increase.
    #[error("`{field}` needs two or more numbers that increase")]
    Keys {
        /// The field.
        field: &'static str,
    },
    /// A table with another number of values than its keys ask for, or with one that is not finite.
    #[error("`{field}` has {found} values: {rows} rows (advance ratios) of {columns} (pitches) are needed, all finite")]
    Values {
        /// The field.
        field: &'static str,
        /// Values that there are.
        found: usize,
        /// Advance ratios.
        rows: usize,
        /// Pitches, 1 without them.
        columns: usize,
    },
    /// At rest a propeller takes power; without that it would turn ever faster.
    #[error(
        "`power_coefficient` is {0} at the lowest advance ratio: it has to be above 0, or nothing holds the propeller"
    )]
    TakesNothing(f64),
}

/// What a propeller does, about its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PropellerWork<T = f64> {
    /// Thrust, N, forward positive; negative where the air drives the propeller.
    pub thrust_n: T,
    /// Torque that it takes from its engine, N m; negative where the air drives it. Its reaction turns the aircraft the other way.
    pub torque_n_m: T,
    /// Turns per second.
    pub turns_s: T,
}

/// A propeller that turns at once as fast as the power of its engine turns it: the power that it takes, `CP(J) rho n^3 D^5`, is the
/// power that the engine gives. With a pitch that changes a governor holds `most_turns_s` where the power suffices. Coefficients are
/// interpolated linearly, and beyond the ends of their tables they are those of the ends.
///
/// Its axis is along the flow. What it does across its axis (the blade that goes down meets more air), and the momentum of its
/// turning, is not in it.
///
/// ```
/// use phugoid_aircraft::engine::{Propeller, PropellerData};
///
/// let propeller = Propeller::new(PropellerData {
///     diameter_m: 2.0,
///     most_turns_s: 45.0,
///     advance_ratio: vec![0.0, 1.0],
///     pitch_rad: Vec::new(),
///     thrust_coefficient: vec![0.1, 0.0],
///     power_coefficient: vec![0.05, 0.05],
/// })?;
/// // At rest: n = (P / (CP rho D^5))^(1/3) = (80 kW / (0.05 1.225 32))^(1/3), T = CT rho n^2 D^4.
/// let work = propeller.work(80_000.0, 0.0, 1.225);
/// let turns = (80_000.0_f64 / (0.05 * 1.225 * 32.0)).cbrt();
/// assert!((work.turns_s / turns - 1.0).abs() < 1e-9);
/// assert!((work.thrust_n / (0.1 * 1.225 * turns * turns * 16.0) - 1.0).abs() < 1e-9);
/// // The torque takes the power of the engine.
/// assert!((work.torque_n_m * std::f64::consts::TAU * turns / 80_000.0 - 1.0).abs() < 1e-9);
/// # Ok::<(), phugoid_aircraft::engine::PropellerError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Propeller {
    data: PropellerData,
    given: GivenPropeller,
}

impl PartialEq for Propeller {
    fn eq(&self, other: &Self) -> bool {
        self.data == other.data
    }
}

impl Propeller {
    /// A propeller of numbers.
    ///
    /// # Errors
    /// [`PropellerError`]: sizes, keys or values that make none.
    pub fn new(data: PropellerData) -> Result<Self, PropellerError> {
        for (field, value) in [("diameter_m", data.diameter_m), ("most_turns_s", data.most_turns_s)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(PropellerError::Size { field, value });
            }
        }
        let increases =
            |keys: &[f64]| keys.iter().all(|key| key.is_finite()) && keys.windows(2).all(|pair| pair[0] < pair[1]);
        let (rows, columns) = (data.advance_ratio.len(), data.pitch_rad.len().max(1));
        if rows < 2 || !increases(&data.advance_ratio) {
            return Err(PropellerError::Keys { field: "advance_ratio" });
        }
        if data.pitch_rad.len() == 1 || !increases(&data.pitch_rad) {
            return Err(PropellerError::Keys { field: "pitch_rad" });
        }
        for (field, values) in
            [("thrust_coefficient", &data.thrust_coefficient), ("power_coefficient", &data.power_coefficient)]
        {
            let found = values.len();
            if Some(found) != rows.checked_mul(columns) || values.iter().any(|value| !value.is_finite()) {
                return Err(PropellerError::Values { field, found, rows, columns });
            }
        }
        if let Some(nothing) = data.power_coefficient.iter().take(columns).find(|value| **value <= 0.0) {
            return Err(PropellerError::TakesNothing(*nothing));
        }
        let pitch_deg: Vec<f64> = data.pitch_rad.iter().map(|pitch| pitch.to_degrees()).collect();
        let tables = GivenTables {
            advance: &data.advance_ratio,
            pitch_deg: &pitch_deg,
            thrust: &data.thrust_coefficient,
            power: &data.power_coefficient,
        };
        let given = GivenPropeller::new(data.diameter_m, data.most_turns_s, &tables);
        Ok(Self { data, given })
    }

    /// What describes it.
    pub fn data(&self) -> &PropellerData {
        &self.data
    }

    /// Area of its disc, m^2.
    pub fn disc_area_m2(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 * self.data.diameter_m * self.data.diameter_m
    }

    /// What it does where the engine gives a power (W, below 0 taken as 0) in air of a density (kg/m^3) that comes along its axis at
    /// a speed (m/s). Not a number where one of them is not. Derivatives (of dual numbers) are central differences.
    pub fn work<T: Scalar>(&self, power_w: T, speed_m_s: T, density: T) -> PropellerWork<T> {
        let between = |i: usize, value: f64| match i {
            // There is no power below none.
            0 => {
                let step = (STEPS[0] * value).max(LEAST_POWER_STEP);
                [(value - step).max(0.0), value.max(0.0) + step]
            }
            1 => [value - STEPS[1], value + STEPS[1]],
            _ => [value * (1.0 - STEPS[2]), value * (1.0 + STEPS[2])],
        };
        let [thrust_n, torque_n_m, turns_s] = expanded(
            [power_w, speed_m_s, density],
            |&[power, speed, density]| self.given.work(power, speed, density),
            between,
        );
        PropellerWork { thrust_n, torque_n_m, turns_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data() -> PropellerData {
        PropellerData {
            diameter_m: 1.9,
            most_turns_s: 40.0,
            advance_ratio: vec![0.0, 0.4, 0.8, 1.2],
            pitch_rad: [10.0_f64, 20.0, 30.0].map(f64::to_radians).to_vec(),
            thrust_coefficient: vec![0.10, 0.13, 0.15, 0.06, 0.10, 0.13, -0.02, 0.05, 0.10, -0.1, 0.0, 0.05],
            power_coefficient: vec![0.04, 0.08, 0.14, 0.03, 0.07, 0.13, -0.01, 0.05, 0.12, -0.1, 0.0, 0.08],
        }
    }

    /// A governor holds the speed where the power suffices, and the torque then takes all of the power.
    #[test]
    fn a_governor_holds_the_speed() {
        let propeller = Propeller::new(data()).unwrap();
        let work = propeller.work(100_000.0, 50.0, 1.1);
        assert!((work.turns_s - 40.0).abs() < 1e-9, "{work:?}");
        assert!((work.torque_n_m * std::f64::consts::TAU * 40.0 / 100_000.0 - 1.0).abs() < 1e-9, "{work:?}");
        assert!(work.thrust_n > 500.0 && work.thrust_n * 50.0 < 100_000.0, "{work:?}");
        // Too little power: the blades are at their finest, and it turns slower.
        let slow = propeller.work(10_000.0, 10.0, 1.1);
        assert!(slow.turns_s < 40.0 && slow.turns_s > 5.0, "{slow:?}");
        // Without power the air turns it, and it brakes.
        let windmill = propeller.work(0.0, 50.0, 1.1);
        assert!(windmill.thrust_n < 0.0 && windmill.torque_n_m.abs() < 1e-6, "{windmill:?}");
        assert!(propeller.work(f64::NAN, 50.0, 1.1).thrust_n.is_nan());
        assert!(propeller.work(1e4, 50.0, f64::INFINITY).thrust_n.is_nan());
    }

    #[test]
    fn numbers_that_make_no_propeller_are_refused() {
        let refused = |change: &dyn Fn(&mut PropellerData)| {
            let mut data = data();
            change(&mut data);
            Propeller::new(data).unwrap_err().to_string()
        };
        assert!(refused(&|d| d.diameter_m = -1.0).contains("`diameter_m` is -1"));
        assert!(refused(&|d| d.most_turns_s = f64::NAN).contains("most_turns_s"));
        assert!(refused(&|d| d.advance_ratio[1] = 0.0).contains("advance_ratio"));
        assert!(refused(&|d| d.pitch_rad.truncate(1)).contains("pitch_rad"));
        assert!(refused(&|d| d.thrust_coefficient.truncate(5)).contains("5 values: 4 rows"));
        assert!(refused(&|d| d.power_coefficient[3] = f64::NAN).contains("all finite"));
        assert!(refused(&|d| d.power_coefficient[0] = 0.0).contains("nothing holds"));
    }
}
