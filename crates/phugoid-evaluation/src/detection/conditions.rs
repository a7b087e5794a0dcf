//! The conditions in which changes are looked for.

use serde::Serialize;

/// What moves the elevator in a flight of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stick {
    /// A pilot who moves the stick at random all the time.
    Pilot,
    /// A 3-2-1-1 every ten seconds, the first one half a second after the start; rest between them.
    #[serde(rename = "3-2-1-1")]
    ThreeTwoOneOne,
}

/// What disturbs a flight of the study beside the damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Air {
    /// Calm air: nothing but the noise of the sensors.
    Calm,
    /// Turbulence of up to 4 ft/s, 3 % outliers, 2 % of the frames lost, constant errors of the sensors.
    Everything,
}
