//! NASA's check cases for flight simulators, flown by Phugoid.
//!
//! The NASA Engineering and Safety Center had up to seven simulators fly the same seventeen manoeuvres (NASA/TM-2015-218675,
//! volumes I and II): falling and thrown spheres, a tumbling brick, and an F-16 in DAVE-ML with and without its
//! autopilot. A file `cases.json` states them. [`CheckCases`] reads it, [`CheckCase::fly`] flies one, and
//! [`compare`](compare::compare) sets the flight beside those of the simulators.
//!
//! ```no_run
//! use phugoid_aircraft::check_case::CheckCases;
//!
//! let cases = CheckCases::read("nesc/cases.json".as_ref())?;
//! let flight = cases.case("09")?.fly()?;
//! std::fs::write("Atmos_09_sim_phugoid.csv", flight.to_csv())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod compare;
mod definition;
mod f16;
mod sentence;
pub mod trajectory;

use std::path::PathBuf;

use phugoid_flight_dynamics::globe::condition::Launch;
use phugoid_flight_dynamics::globe::flight::{FlightError, Integration, fly_by, motion};
use phugoid_flight_dynamics::globe::loads::{BluntBody, Loads};
use phugoid_flight_dynamics::globe::steady::NoTrim;

pub use definition::{CheckCase, CheckCases, CheckVehicle, Manoeuvre};
pub use trajectory::Trajectory;

/// Step of the integration, s.
const STEP: f64 = 0.01;

/// Why a check case could not be read or flown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckCaseError {
    /// A file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file of definitions is no JSON.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and where.
        source: serde_json::Error,
    },
    /// There is no case of this name.
    #[error("there is no check case {id}; there are {known}")]
    Unknown {
        /// The name that was asked for.
        id: String,
        /// All names.
        known: String,
    },
    /// A part of a definition is missing or has a meaning that this program does not know.
    #[error("check case {id}: {what}")]
    Definition {
        /// The case.
        id: String,
        /// What is missing or not understood.
        what: String,
    },
    /// A model in DAVE-ML could not be read or evaluated.
    #[error("{}: {what}", path.display())]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The vehicle could not be trimmed.
    #[error("check case {id}: {source}")]
    Trim {
        /// The case.
        id: String,
        /// What is left of the accelerations.
        source: NoTrim,
    },
    /// The flight ended early.
    #[error("check case {id}: {source}")]
    Flight {
        /// The case.
        id: String,
        /// Why.
        source: FlightError,
    },
}

impl CheckCase {
    /// How the case is integrated: by Runge-Kutta, where the smallest error counts, and after a step command to the autopilot by
    /// Adams and Bashforth, as the simulators were. How much of such a step counts in the hundredth of a second in which it comes
    /// is in no definition: it is the simulators' integration that decides it.
    pub fn integration(&self) -> Integration {
        match self.vehicle {
            CheckVehicle::F16 { manoeuvre: Manoeuvre::Command { .. }, .. } => Integration::AdamsBashforth2,
            _ => Integration::RungeKutta4,
        }
    }

    /// Flies the case by [its integration](Self::integration) and gives its trajectory at the instants of the simulators' outputs.
    ///
    /// Steps of 0.01 s. The F-16 is trimmed first, wings level and at constant velocity over the ground.
    ///
    /// # Errors
    ///
    /// [`CheckCaseError`] if a model is missing, or no trim is found, or the motion is no longer finite.
    pub fn fly(&self) -> Result<Trajectory, CheckCaseError> {
        self.fly_by(self.integration())
    }

    /// As [`fly`](Self::fly), by another integration.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn fly_by(&self, integration: Integration) -> Result<Trajectory, CheckCaseError> {
        match &self.vehicle {
            CheckVehicle::Blunt(body) => self.flown(integration, &mut BluntBody::clone(body), self.launch),
            CheckVehicle::F16 { folder, manoeuvre } => {
                let mut aircraft = f16::F16::read(folder, manoeuvre)?;
                let launch = aircraft
                    .trim(&self.world, self.launch)
                    .map_err(|source| CheckCaseError::Trim { id: self.id.clone(), source })?;
                // The first row is the trimmed flight before the autopilot acts, as most simulators wrote it.
                let start = launch.state(&self.world.planet, 0.0, []);
                let trimmed = motion(&self.world, &mut aircraft, 0.0, &start);
                aircraft.engage();
                let mut flight = self.flown(integration, &mut aircraft, launch)?;
                flight.replace_first(&trimmed);
                Ok(flight)
            }
        }
    }

    fn flown(
        &self,
        integration: Integration,
        vehicle: &mut dyn Loads,
        launch: Launch,
    ) -> Result<Trajectory, CheckCaseError> {
        let mut trajectory = Trajectory::default();
        let every = (self.output_interval / STEP).round().max(1.0) as usize;
        let step = self.output_interval / every as f64;
        let mut count = 0;
        let start = launch.state(&self.world.planet, 0.0, []);
        fly_by(integration, &self.world, vehicle, start, [0.0, self.duration, step], |motion| {
            if count % every == 0 {
                trajectory.push(motion);
            }
            count += 1;
        })
        .map_err(|source| CheckCaseError::Flight { id: self.id.clone(), source })?;
        Ok(trajectory)
    }
}
