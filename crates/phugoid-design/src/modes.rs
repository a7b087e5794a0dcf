//! The frequencies that an input has to excite.

use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::modes::{Mode, ModeName};
use phugoid_flight_dynamics::motion::Disturbance;
use serde::Serialize;

use super::error::DesignError;
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::manoeuvre::Surface;
use phugoid_simulation::scenario::Scenario;

/// Natural frequencies, rad/s, of the modes that the three surfaces move most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeFrequencies {
    /// Short period, or what stands for it where stability is relaxed: the third oscillatory mode, else the fastest root.
    pub short_period: f64,
    /// Dutch roll, else the fastest lateral root but roll; not a number for an aircraft without lateral motion.
    pub dutch_roll: f64,
    /// Roll mode: the inverse of its time constant; not a number for an aircraft without lateral motion.
    pub roll: f64,
}

impl ModeFrequencies {
    /// From the linear model about the trim of a scenario, as `phugoid linearize` gives it: that of the aircraft by itself, also where
    /// the scenario lets the flight control system of its files run.
    ///
    /// ```
    /// use phugoid_design::modes::ModeFrequencies;
    /// use phugoid_simulation::manoeuvre::Surface;
    /// use phugoid_simulation::scenario::Scenario;
    ///
    /// let modes = ModeFrequencies::of_scenario(&Scenario::named("f16-calm")?)?;
    /// assert!((1.5..1.9).contains(&modes.short_period)); // rad/s
    /// let [lowest, highest] = modes.band_hz(&[Surface::Elevator]);
    /// assert!(lowest < modes.short_period / 6.28 && modes.short_period / 6.28 < highest);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`DesignError`]: the aircraft has no trim in the scenario's condition, or the modes cannot be computed.
    pub fn of_scenario(scenario: &Scenario) -> Result<Self, DesignError> {
        let (aircraft, trim) = trimmed_aircraft(scenario)?;
        let model = linearize(aircraft.as_ref(), &trim.state(), &trim.controls(), &Disturbance::default());
        let no_modes = |e: phugoid_flight_dynamics::modes::ModesError| DesignError::Unsuitable(e.to_string());
        let longitudinal = model.longitudinal().map_err(no_modes)?.modes;
        let lateral = model.lateral().map_err(no_modes)?.modes;
        let of = |modes: &[Mode], names: &[ModeName]| {
            let named = names.iter().find_map(|name| modes.iter().find(|m| m.name == *name));
            named.or(modes.first()).map(|m| m.natural_frequency_rad_s).filter(|w| *w > 0.0).unwrap_or(f64::NAN)
        };
        let frequencies = Self {
            short_period: of(&longitudinal, &[ModeName::ShortPeriod, ModeName::ThirdOscillatory]),
            dutch_roll: of(&lateral, &[ModeName::DutchRoll, ModeName::YawSubsidence, ModeName::YawDivergence]),
            roll: of(&lateral, &[ModeName::Roll, ModeName::LateralPhugoid]),
        };
        if [Surface::Elevator, Surface::Aileron, Surface::Rudder].iter().all(|s| frequencies.of(*s).is_nan()) {
            return Err(DesignError::Unsuitable(format!(
                "{}: the aircraft has no modes to excite in this condition",
                scenario.name
            )));
        }
        Ok(frequencies)
    }

    /// Natural frequency of the mode that this surface moves most, rad/s.
    pub fn of(&self, surface: Surface) -> f64 {
        match surface {
            Surface::Elevator => self.short_period,
            Surface::Aileron => self.roll,
            Surface::Rudder => self.dutch_roll,
        }
    }

    /// 0.4 times the slowest to 2.5 times the fastest mode of these surfaces, Hz: the moment derivatives need the mode
    /// itself, the static ones what is slower, the damping and control derivatives what is faster.
    pub fn band_hz(&self, surfaces: &[Surface]) -> [f64; 2] {
        let all = || surfaces.iter().map(|s| self.of(*s) / std::f64::consts::TAU);
        [0.4 * all().fold(f64::INFINITY, f64::min), 2.5 * all().fold(0.0, f64::max)]
    }
}
