//! The engine of a model file in flight: thrust, torque and slipstream.

use phugoid_aircraft::engine::{Along, Schedule};
use phugoid_flight_dynamics::aircraft::{AirData, DataRange, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::scalar::Scalar;

use super::Valued;
use crate::core::term::Coefficient;
use crate::export::Identified;
use crate::model_file::{EngineData, PropelledData};

/// What makes the thrust, of an aircraft whose engine its model file describes.
#[derive(Clone, Debug)]
pub(super) enum Engine {
    Thrust(Schedule),
    Propeller(Box<Propelled>),
}

#[derive(Clone, Debug)]
pub(super) struct Propelled {
    data: PropelledData,
    /// Terms in the slipstream, and their values times the share of it that they feel.
    blown: Vec<Valued>,
    /// Whether the aircraft rolls and yaws: without that, nothing could balance the torque.
    turns: bool,
}

/// Where an engine works.
#[derive(Clone, Copy)]
pub(super) struct At<T> {
    /// Engine state, percent.
    pub(super) power: T,
    /// m.
    pub(super) altitude: T,
    pub(super) mach: T,
}

impl Engine {
    /// The engine of a model whose motion has the lateral axes or not; what is to be known of it goes into `notes`.
    pub(super) fn new(data: &EngineData, identified: &Identified, turns: bool, notes: &mut Vec<String>) -> Self {
        let propelled = match data {
            EngineData::Thrust(schedule) => return Self::Thrust(schedule.clone()),
            EngineData::Propeller(propelled) => propelled,
        };
        if !turns {
            notes.push("The torque of the propeller is left out: nothing rolls or yaws.".into());
        }
        let of = propelled.propeller.data();
        let columns = of.pitch_rad.len().max(1);
        let coarsest = of.thrust_coefficient.last().copied().unwrap_or(0.0);
        if coarsest > 0.0
            && let Some(last) = of.advance_ratio.last()
        {
            notes.push(format!(
                "Beyond the advance ratio {last} the coefficients of the propeller stay as they are there (thrust \
                 {coarsest}{}): it is then not known how it brakes.",
                if columns > 1 { " at the coarsest pitch" } else { "" }
            ));
        }
        let valued = |(coefficient, name, share): (Coefficient, &str, f64)| {
            let found = identified.terms(coefficient).into_iter().find(|valued| valued.name == name)?;
            Some((coefficient, found.term, found.value * share))
        };
        let blown = propelled
            .blown(&identified.model.parameters)
            .filter_map(|(coefficient, parameter, share)| valued((coefficient, &parameter.name, share)))
            .collect();
        Self::Propeller(Box::new(Propelled { data: (**propelled).clone(), blown, turns }))
    }

    /// Force and moment along a thrust line: its direction along body x and z, and the pitching moment per newton, m.
    pub(super) fn propulsion<T: Scalar>(
        &self,
        at: At<T>,
        atmosphere: Atmosphere,
        [along_x, along_z, arm]: [f64; 3],
    ) -> Propulsion<T> {
        let (throttle, air) = (at.power * 0.01, atmosphere.at(at.altitude));
        let speed = at.mach * air.speed_of_sound;
        let zero = T::from(0.0);
        let (thrust, torque) = match self {
            Self::Thrust(schedule) => (schedule.value(throttle, at.mach, speed, at.altitude), zero),
            Self::Propeller(propelled) => {
                let PropelledData { propeller, power, sense, .. } = &propelled.data;
                let work = propeller.work(power.value(throttle, at.mach, speed, at.altitude), speed, air.density);
                // The torque that turns the propeller to one side turns the aircraft to the other.
                (work.thrust_n, if propelled.turns { work.torque_n_m * -sense } else { zero })
            }
        };
        Propulsion {
            force: [thrust * along_x, zero, thrust * along_z],
            moment: [torque * along_x, thrust * arm, torque * along_z],
        }
    }

    /// Power of the engine that turns a propeller, W; none without one.
    pub(super) fn power(&self, at: At<f64>, atmosphere: Atmosphere) -> Option<f64> {
        let Self::Propeller(propelled) = self else { return None };
        let speed = at.mach * atmosphere.at(at.altitude).speed_of_sound;
        Some(propelled.data.power.value(0.01 * at.power, at.mach, speed, at.altitude))
    }

    /// How much larger the dynamic pressure in the fully developed slipstream is than around it, in parts of the latter, and the terms
    /// that feel it; none without a slipstream.
    ///
    /// By the momentum theory of the actuator disc (Rankine and Froude; e.g. B. W. McCormick, *Aerodynamics, Aeronautics and Flight
    /// Mechanics*, 2nd ed., Wiley 1995, ch. 6) the thrust is the disc's area `A` times the rise of the dynamic pressure,
    /// `T = A (q_s - q)`. A propeller that brakes takes at most all of it.
    pub(super) fn slipstream<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        [along_x, along_z, _]: [f64; 3],
    ) -> Option<(T, &[Valued])> {
        let Self::Propeller(propelled) = self else { return None };
        if propelled.blown.is_empty() {
            return None;
        }
        let thrust = propulsion.force[0] * along_x + propulsion.force[2] * along_z;
        let rise = thrust / (air.dynamic_pressure * propelled.data.propeller.disc_area_m2());
        Some((if rise.real() < -1.0 { T::from(-1.0) } else { rise }, &propelled.blown))
    }
}

/// The range that the tables of an engine leave of a range of flight.
pub(super) fn within_tables(data: &EngineData, range: DataRange) -> DataRange {
    let any = DataRange::UNSTATED;
    let of_engine = DataRange {
        alpha: range.alpha,
        speed: data.ends(Along::Speed).unwrap_or(any.speed),
        mach: data.ends(Along::Mach).unwrap_or(any.mach),
        altitude: data.ends(Along::Altitude).unwrap_or(any.altitude),
        ..any
    };
    range.within(&of_engine)
}
