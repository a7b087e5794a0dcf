//! What the channels of an aircraft need to run, the same for all flights.

use super::sensed::{STICKS, Written, is_sensed};
use crate::flown::error::FlownError;
use crate::flown::jsbsim::drive::engines_flown;
use crate::flown::jsbsim::start::Values;
use crate::flown::options::FlownOptions;
use crate::flown::surface::{DRIVEN_LAG_S, LAG_S, NAMES, SIGNS, Surface};
use crate::jsbsim::{Aircraft, Evaluator, Follower};

/// Most names in a message.
const MOST_NAMED: usize = 24;

/// What the channels of an aircraft need to run, the same for all flights.
#[derive(Clone, Debug)]
pub(crate) struct Control {
    /// As the files say: nothing that channels compute is computed elsewhere.
    pub(super) aircraft: Aircraft,
    /// The properties by which channels move each surface; none where they do not.
    moved: [Vec<Follower>; 3],
    sticks: [Option<usize>; 3],
    /// Lowest and highest deflection in the signs of the equations of motion, rad.
    stops: [[f64; 2]; 3],
    /// Everything that channels write.
    pub(super) outputs: Vec<usize>,
    /// What channels write and aerodynamics and engines read, beside the surfaces, with the values that it has for these.
    apart: Values,
    /// Properties with the values that they have from the start, before channels ran.
    pub(super) begun: Values,
    /// Properties that are set when channels take over.
    pub(super) engaged: Values,
    pub(super) written: Written,
}

/// What channels write and aerodynamics and engines read, beside the surfaces and the throttles, with the values that these have.
fn apart(
    aircraft: &Aircraft,
    beginning: &mut Evaluator<'_>,
    surfaces: &[Surface; 3],
    options: &FlownOptions,
) -> Values {
    let flown = beginning.aircraft();
    let mut read = flown.aerodynamics_read();
    let engines = engines_flown(flown, options.thrust);
    if engines.is_some() {
        read.extend(flown.engines_read());
    }
    let throttles = engines.unwrap_or_default().0;
    let apart = read.into_iter().filter_map(|name| flown.property(name)).filter(|&index| {
        // What is held is computed.
        aircraft.is_written(index)
            && !aircraft.is_computed(index)
            && !flown.is_computed(index)
            && !throttles.contains(&index)
            && !surfaces.iter().any(|surface| surface.sets(index))
    });
    let mut apart: Vec<usize> = apart.collect();
    apart.sort_unstable();
    apart.dedup();
    apart.into_iter().map(|index| (index, beginning.get_index(index).unwrap_or(f64::NAN))).collect()
}

impl Control {
    /// From the aircraft as its files say, and the same as it begins, where `engaged` is for the channels alone.
    ///
    /// # Errors
    /// [`FlownError`]: channels that move no surface, or by something that nothing gives.
    pub(crate) fn new(
        mut aircraft: Aircraft,
        beginning: &mut Evaluator<'_>,
        surfaces: &[Surface; 3],
        options: &FlownOptions,
        engaged: Values,
        notes: &mut Vec<String>,
    ) -> Result<Self, FlownError> {
        let moved = surfaces.each_ref().map(|surface| {
            let followers = surface.followers().iter();
            followers.filter(|follower| aircraft.is_written(follower.property)).copied().collect::<Vec<_>>()
        });
        if moved.iter().all(Vec::is_empty) {
            let why = "no channel of this one writes the position of elevator, aileron or rudder".to_owned();
            return Err(FlownError::NoFlightControl { file: aircraft.own_file(), why });
        }
        let mut begun = Values::new();
        let gear = beginning.get("gear/gear-pos-norm").unwrap_or(0.0);
        let mut begin = |name: &str, value: f64| begun.extend(aircraft.property(name).map(|index| (index, value)));
        begin("gear/gear-cmd-norm", gear);
        begin("accelerations/gravity-ft_sec2", beginning.get("accelerations/gravity-ft_sec2").unwrap_or(0.0));
        for engine in 0..aircraft.engines().len() {
            for name in ["mixture-cmd-norm", "advance-cmd-norm"] {
                begin(&format!("fcs/{name}[{engine}]"), 1.0);
            }
        }
        // What the aerodynamics were told of gear and flaps holds for the channels too.
        let mut held = vec!["gear/gear-pos-norm".to_owned()];
        held.extend((0..aircraft.engines().len()).map(|engine| format!("fcs/advance-pos-norm[{engine}]")));
        held.extend(options.properties.iter().map(|(name, _)| name.clone()));
        for name in held {
            let Some(index) = aircraft.property(&name) else { continue };
            if engaged.iter().any(|(other, _)| *other == index) {
                continue;
            }
            let value = beginning.get_index(index).unwrap_or(f64::NAN);
            if aircraft.is_written(index) {
                aircraft.hold(index, value);
            } else {
                begun.push((index, value));
            }
        }
        let apart = apart(&aircraft, beginning, surfaces, options);
        let (throttles, most) = engines_flown(&aircraft, options.thrust).unwrap_or_default();
        let written = Written::new(&aircraft, options.gravity, throttles, most);
        let control = Self {
            moved,
            sticks: STICKS.map(|name| aircraft.property(name)),
            stops: surfaces.each_ref().map(|surface| surface.stops),
            outputs: aircraft.outputs(),
            apart,
            begun,
            engaged,
            written,
            aircraft,
        };
        control.check_inputs(notes)?;
        control.note_surfaces(notes);
        Ok(control)
    }

    /// Lag of each surface behind the channels, s.
    pub(crate) fn lags_s(&self) -> [f64; 3] {
        self.moved.each_ref().map(|by| if self.is_driven(by) { DRIVEN_LAG_S } else { LAG_S })
    }

    fn is_driven(&self, by: &[Follower]) -> bool {
        by.iter().any(|follower| self.aircraft.has_drive(follower.property))
    }

    /// Refuses what moves the surfaces and nobody gives, and notes what else channels read and nobody gives.
    fn check_inputs(&self, notes: &mut Vec<String>) -> Result<(), FlownError> {
        let aircraft = &self.aircraft;
        let read = aircraft.channels_read();
        let properties: Vec<usize> = self.moved.iter().flatten().map(|follower| follower.property).collect();
        let decisive = aircraft.decide_on(&properties);
        let names: Vec<&str> = aircraft.properties().collect();
        let given = |index: usize| {
            let name = names[index];
            // Commands are those of the flight or stay where they are put, and the wheels never touch the ground.
            is_sensed(name)
                || name.split('[').next().is_some_and(|name| name.ends_with("-cmd-norm"))
                || name.starts_with("gear/")
                || self.begun.iter().chain(&self.engaged).any(|(other, _)| *other == index)
        };
        let mut open = Vec::new();
        for index in aircraft.inputs().into_iter().filter(|&index| read[index] && !given(index)) {
            if decisive[index] && aircraft.is_of_jsbsim(index) {
                let (file, line) = aircraft.mentioned(names[index]).unwrap_or_default();
                return Err(FlownError::Unfed { file, line, property: names[index].to_owned() });
            }
            open.push(names[index]);
        }
        if !open.is_empty() {
            let more = open.len().saturating_sub(MOST_NAMED);
            let mut text = open.into_iter().take(MOST_NAMED).collect::<Vec<_>>().join(", ");
            if more > 0 {
                text.push_str(&format!(" and {more} more"));
            }
            notes.push(format!(
                "What channels read and nothing gives stays as it begins, at 0 where the files do not say: {text}."
            ));
        }
        Ok(())
    }

    fn note_surfaces(&self, notes: &mut Vec<String>) {
        notes.push(
            "Flight control can run: in a flight with it the channels of the files move the surfaces, and the commands of the \
             flight move the stick."
                .into(),
        );
        for (name, by) in NAMES.iter().zip(&self.moved) {
            notes.push(match (by.is_empty(), self.is_driven(by)) {
                (true, _) => format!("No channel moves the {name}: it follows its command, with a lag of {LAG_S} s."),
                (false, true) => format!(
                    "The channels have a drive of the {name}: in place of a lag of {LAG_S} s it follows them with one of \
                     {DRIVEN_LAG_S} s."
                ),
                (false, false) => format!("The {name} follows the channels with a lag of {LAG_S} s and no limit of rate."),
            });
        }
    }

    /// The angles of the surfaces that channels move, rad, in the signs of the equations of motion, where two sides of one differ
    /// their mean; NaN for one that they do not move.
    pub(super) fn positions(&self, evaluator: &mut Evaluator<'_>) -> [f64; 3] {
        self.moved.each_ref().map(|by| {
            let angle =
                |follower: &Follower| follower.angle(evaluator.get_index(follower.property).unwrap_or(f64::NAN));
            by.iter().map(angle).sum::<f64>() / by.len() as f64
        })
    }

    /// Notes what channels that rest put elsewhere than the aerodynamics have it.
    pub(super) fn note_apart(&self, evaluator: &mut Evaluator<'_>, notes: &mut Vec<String>) {
        for &(index, felt) in &self.apart {
            let put = evaluator.get_index(index).unwrap_or(f64::NAN);
            // The angle of a surface in its other units is that of the surface.
            let name = self.aircraft.properties().nth(index).unwrap_or_default();
            let angle = ["elevator-pos-", "aileron-pos-", "rudder-pos-"].iter().any(|word| name.contains(word));
            if !angle && (put - felt).abs() > 1e-6 * felt.abs().max(1.0) {
                notes.push(format!(
                    "In the trim the channels put {name} at {put:.4}, and aerodynamics and engines have it at {felt:.4} all the time: \
                     give it a value under `properties`, which holds for both."
                ));
            }
        }
    }

    /// Moves the stick and the pedals.
    pub(super) fn put_sticks(&self, evaluator: &mut Evaluator<'_>, at: [f64; 3]) {
        for (property, value) in self.sticks.iter().zip(at) {
            if let Some(index) = *property {
                evaluator.set_index(index, value);
            }
        }
    }

    /// The share of its travel that an angle of a surface away from where it was is, in the signs of the stick.
    pub(super) fn share(&self, surface: usize, angle_rad: f64) -> f64 {
        let [low, high] = self.stops[surface];
        let share = if angle_rad < 0.0 { -angle_rad / low } else { angle_rad / high };
        SIGNS[surface] * share
    }
}
