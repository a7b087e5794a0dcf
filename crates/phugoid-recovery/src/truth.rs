//! The aircraft as it truly is: what estimates are compared with.

use phugoid_control::gains::Gains;
use phugoid_control::local::{AXES, LocalModel, SURFACES, VARIABLES};
use phugoid_control::prediction::Steady;
use phugoid_control::target::Targets;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::trim::Trim;
use phugoid_simulation::course::Course;

use crate::history::History;
use crate::known::local_model;

/// The end of a flight that margins are of where no estimate says how much it looks at, s at full size.
pub(crate) const LAST_S: f64 = 3.0;

/// The linear model of the true aircraft without rates at an angle of attack and sideslip (rad), at its own speed and altitude, with the
/// surfaces at these positions. What no longer moves when it is told to has no effect.
pub(crate) fn true_model<A: Aircraft>(
    course: &Course<'_, A>,
    trim: &Trim,
    [alpha, beta]: [f64; 2],
    controls: &Controls,
    gravity: f64,
) -> LocalModel {
    let now = course.state();
    let state = State { speed: now.speed, altitude: now.altitude, power: now.power, alpha, beta, ..trim.state() };
    let linear = course.linear_model(&state, controls);
    let mut model = local_model(&linear, alpha, now.speed, gravity);
    for (j, left) in course.obeys().into_iter().enumerate() {
        if !left {
            model.surfaces.iter_mut().for_each(|row| row[j] = 0.0);
        }
    }
    model
}

/// The true means of `window` seconds (of the aircraft's own time), which ended `lag` seconds ago as those that are measured behind a
/// filter, with the surfaces that hold their angle of attack and
/// sideslip without rates and accelerations: Newton's method on the equations of motion, by the surfaces that the gains use.
pub(crate) fn truly_steady<A: Aircraft>(
    course: &Course<'_, A>,
    history: &History,
    trim: &Trim,
    gains: &Gains,
    [window, lag]: [f64; 2],
    gravity: f64,
) -> Steady {
    // Tables are bent, so that one step does not reach it.
    const STEPS: usize = 5;
    let end = history.time_s.last().copied().unwrap_or(0.0);
    let [first, last] = [end - lag - window, end - lag].map(|at| history.time_s.partition_point(|time| *time <= at));
    let mean = |values: &[f64]| {
        let within = values.get(first..last).filter(|within| !within.is_empty()).unwrap_or(values);
        within.iter().sum::<f64>() / within.len().max(1) as f64
    };
    let mut variables = [0.0; VARIABLES];
    (variables[0], variables[1]) = (mean(&history.alpha), mean(&history.beta));
    let mut surfaces: [f64; SURFACES] = std::array::from_fn(|j| mean(&history.surfaces[j]));
    for _ in 0..STEPS {
        let [elevator, aileron, rudder] = surfaces;
        let controls = Controls { elevator, aileron, rudder, ..trim.controls() };
        let model = true_model(course, trim, [variables[0], variables[1]], &controls, gravity);
        let Some(own) = Gains::place_with(&model, &Targets::default(), gains.free) else { break };
        for (j, position) in surfaces.iter_mut().enumerate() {
            *position -= (0..AXES).map(|i| own.inverse[j][i] * model.constant[i]).sum::<f64>();
        }
    }
    Steady { variables, surfaces, duration: window, ..Steady::default() }
}
