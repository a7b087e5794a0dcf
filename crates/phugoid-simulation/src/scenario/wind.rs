//! The steady wind of a scenario.

use phugoid_flight_dynamics::wind::{WindError, WindLevel, WindProfile};
use serde::Deserialize;

use crate::quantity::{Angle, Length, Speed};

/// Steady, level wind: the same at all altitudes (`from` and `speed`), or by altitude (`aloft`).
///
/// ```
/// use phugoid_simulation::scenario::parse_toml;
/// use phugoid_simulation::scenario::Wind;
///
/// let west: Wind = parse_toml("from = \"270 deg\"\nspeed = \"20 m/s\"", "wind")?;
/// let [north, east] = west.profile()?.at(3000.0).velocity;
/// assert!(north.abs() < 1e-12 && (east - 20.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Direction that the wind comes from, clockwise from true north, 0 to 360 deg.
    pub from: Option<Angle>,
    /// Speed of the air over the ground, not negative.
    pub speed: Option<Speed>,
    /// The wind at altitudes, from the lowest to the highest. North and east components are linear between them; below the
    /// lowest and above the highest they stay.
    pub aloft: Option<Vec<Aloft>>,
}

/// The wind at one altitude.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aloft {
    /// Altitude above sea level.
    pub altitude: Length,
    /// Direction that the wind comes from, clockwise from true north, 0 to 360 deg.
    pub from: Angle,
    /// Speed of the air over the ground, not negative.
    pub speed: Speed,
}

impl Wind {
    /// The wind as the simulation takes it: velocities towards north and east, m/s.
    ///
    /// # Errors
    /// A sentence that names the entry that is wrong and what is expected of it.
    pub fn profile(&self) -> Result<WindProfile, String> {
        let levels = match (self.from, self.speed, &self.aloft) {
            (Some(from), Some(speed), None) => {
                vec![WindLevel { altitude: 0.0, velocity: velocity(from, speed, "wind.")? }]
            }
            (None, None, Some(aloft)) if aloft.is_empty() => {
                return Err("`wind.aloft` has no altitude: name one at least, or leave `[wind]` out".to_owned());
            }
            (None, None, Some(aloft)) => {
                let level = |(k, at): (usize, &Aloft)| {
                    let velocity = velocity(at.from, at.speed, &format!("entry {} of `wind.aloft`: ", k + 1))?;
                    Ok(WindLevel { altitude: at.altitude.si(), velocity })
                };
                aloft.iter().enumerate().map(level).collect::<Result<_, String>>()?
            }
            (Some(_), None, None) => {
                return Err("`wind.speed` is missing: how fast is the wind? (\"20 kt\")".to_owned());
            }
            (None, Some(_), None) => {
                return Err(
                    "`wind.from` is missing: where does the wind come from? (\"270 deg\": from the west)".to_owned()
                );
            }
            _ => {
                return Err(
                    "`[wind]` takes either `from` and `speed`, the same at all altitudes, or `aloft`, a list of \
                            altitudes with `from` and `speed` each"
                        .to_owned(),
                );
            }
        };
        WindProfile::new(levels).map_err(|error| match error {
            WindError::NotFinite { level } => {
                format!("entry {level} of `wind.aloft` has a number that is not finite")
            }
            WindError::Order { level, altitude, before } => format!(
                "entry {level} of `wind.aloft` is at {altitude} m, not above the entry before it at {before} m: name the \
                 altitudes from the lowest to the highest, each once"
            ),
        })
    }
}

/// Towards north and east, m/s. `place` stands before the key in messages, with its own opening quote for a dotted one.
fn velocity(from: Angle, speed: Speed, place: &str) -> Result<[f64; 2], String> {
    /// 360 deg that is written in radians may be rounded up.
    const TURN: f64 = std::f64::consts::TAU * (1.0 + 1e-9);
    let key = |key: &str| if place.ends_with('.') { format!("`{place}{key}`") } else { format!("{place}`{key}`") };
    let (from, speed) = (from.si(), speed.si());
    if !(0.0..=TURN).contains(&from) {
        let degrees = short(from.to_degrees());
        return Err(format!(
            "{} is {degrees} deg: write the direction that the wind comes from, clockwise from north, 0 to 360 deg",
            key("from")
        ));
    }
    if !(speed >= 0.0 && speed.is_finite()) {
        return Err(format!(
            "{} is {} m/s: a speed is not negative; turn `from` by 180 deg for the opposite wind",
            key("speed"),
            short(speed)
        ));
    }
    let (sin, cos) = from.sin_cos();
    Ok([-speed * cos, -speed * sin])
}

/// Without the digits that a conversion of units leaves at the end.
fn short(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
