//! Fixed gains for everything that may happen: chosen among many for the best worst motion over a set of damages.

use phugoid_control::gains::Gains;
use phugoid_control::interval::{excess, most_robust};
use phugoid_control::local::{AXES, LocalModel, STATES, SURFACES, VARIABLES};
use phugoid_control::roots::{Root, eigenvalues};
use phugoid_control::target::Targets;
use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::trim::Trim;

use crate::error::RecoveryError;
use crate::known::{Declared, estimate};
use crate::scale::Scale;

/// What is left of the effect of a surface, of stability and of damping, over the set of damages.
const SURFACE: [f64; 3] = [1.0, 0.7, 0.45];
const STABILITY: [f64; 3] = [1.0, 0.5, -0.5];
const DAMPING: [f64; 2] = [1.0, 0.5];

/// The most robust gains for an aircraft, with the motion that they are placed for: candidates are the placements for each damaged model with
/// several targets.
pub(crate) fn robust_gains<A: Aircraft>(
    aircraft: &A,
    trim: &Trim,
    targets: &Targets,
    scale: Scale,
) -> Result<(Gains, Targets), RecoveryError> {
    let known = estimate(aircraft, trim, &[], &Declared::UNSTATED, trim.speed_m_s, trim.altitude_m);
    let healthy = scale.model(&known.model);
    let mut models = Vec::new();
    for surface in SURFACE {
        for stability in STABILITY {
            for damping in DAMPING {
                models.push(damaged(&healthy, surface, stability, damping));
            }
        }
    }
    let mut candidates = Vec::new();
    for model in &models {
        for faster in [0.7, 1.0, 1.4] {
            for damping in [0.8, 1.2] {
                let wanted = Targets {
                    short_period_range: targets.short_period_range.map(|f| f * faster),
                    control_anticipation: targets.control_anticipation * faster * faster,
                    short_period_damping: damping,
                    dutch_roll_frequency: targets.dutch_roll_frequency * faster,
                    dutch_roll_damping: 0.6 * damping,
                    ..*targets
                };
                candidates.extend(Gains::place(model, &wanted).map(|gains| (gains, wanted)));
            }
        }
    }
    // High gains look robust to a model whose surfaces move at once. A delay counts as so much more lag.
    let lags = aircraft.actuators().each().map(|actuator| scale.time(actuator.lag + actuator.delay));
    candidates.retain(|(gains, _)| stays_damped(&healthy, gains, lags));
    // Only what gains of its own would hold can be asked of fixed ones.
    let feasible: Vec<LocalModel> = models
        .into_iter()
        .filter(|model| Gains::place(model, targets).is_some_and(|own| excess(model, &own).largest() < 0.0))
        .collect();
    let best = most_robust(feasible.iter(), candidates.iter().map(|(gains, _)| *gains));
    best.and_then(|best| candidates.into_iter().find(|(gains, _)| *gains == best)).ok_or(RecoveryError::NoGains)
}

/// Damping ratio that oscillations faster than a phugoid keep with the lags of the actuators.
const LAGGED_DAMPING: f64 = 0.5;

/// Whether the whole aircraft with these gains is damped although its surfaces lag behind their commands (s, first order).
fn stays_damped(model: &LocalModel, gains: &Gains, lags: [f64; SURFACES]) -> bool {
    const WHOLE: usize = STATES + SURFACES;
    // Without feedback, and by how much more a unit of each surface moves.
    let none = model.closed_loop(&[[0.0; VARIABLES]; SURFACES]);
    let feedback = gains.feedback();
    // Places of the feedback variables among the states of the local motion.
    const PLACE: [usize; VARIABLES] = [0, 1, 3, 4, 5];
    let mut whole = [[0.0; WHOLE]; WHOLE];
    for (row, from) in whole.iter_mut().zip(none) {
        row[..STATES].copy_from_slice(&from);
    }
    for j in 0..SURFACES {
        if lags[j] <= 0.0 {
            return true;
        }
        let column = STATES + j;
        for i in 0..AXES {
            whole[3 + i][column] = model.surfaces[i][j];
        }
        for (variable, place) in PLACE.iter().enumerate() {
            whole[column][*place] = feedback[j][variable] / lags[j];
        }
        whole[column][column] = -1.0 / lags[j];
    }
    whole[0][STATES] = model.alpha_by_elevator;
    whole[1][STATES + 1] = model.beta_by_aileron;
    whole[1][STATES + 2] = model.beta_by_rudder;
    let slow = |root: &Root| root.real.hypot(root.imaginary) < 0.3;
    eigenvalues(&whole).is_some_and(|roots| {
        roots.iter().filter(|root| !slow(root)).all(|root| root.real < -LAGGED_DAMPING * root.imaginary.abs())
    })
}

fn damaged(healthy: &LocalModel, surface: f64, stability: f64, damping: f64) -> LocalModel {
    let mut model = *healthy;
    model.surfaces.iter_mut().flatten().for_each(|b| *b *= surface);
    // Where the aircraft is unstable already, it loses as much as the lift makes in a second squared.
    let pitch = healthy.rates[1][0];
    model.rates[1][0] = if pitch < 0.0 { pitch * stability } else { pitch + 4.0 * (1.0 - stability) };
    model.rates[2][1] *= stability.max(0.2);
    model.rates[1][3] *= damping;
    model.rates[2][4] *= damping;
    model.rates[0][2] *= damping;
    model
}
