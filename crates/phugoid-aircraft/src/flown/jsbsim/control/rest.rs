//! Channels that come to rest while the flight stands still.

use super::description::Control;
use crate::flown::surface::NAMES;
use crate::jsbsim::Evaluator;

/// Time over which a surface that rests does not move, s.
const WINDOW_S: f64 = 0.5;
/// Movement of a surface over that time that counts as none, rad.
const STILL: f64 = 1e-8;
/// Change of any other output of the channels over that time that counts as none, as a share of it, or of 1 where it is smaller.
const STEADY: f64 = 1e-8;
/// How long outputs other than the surfaces are waited for, s: an integrator that nothing is connected to never rests.
const LONGEST_INSIDE_S: f64 = 30.0;

/// What moved when it was to be at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Restless {
    pub(super) surface: &'static str,
    pub(super) rate_rad_s: f64,
}

/// Runs channels at what an evaluator holds until the surfaces rest, for at most `most_s`; gives their angles, rad. With `inside`, all
/// other outputs of the channels are waited for too, as long as makes sense: an autopilot that is still off has its state there.
pub(super) fn come_to_rest(
    control: &Control,
    evaluator: &mut Evaluator<'_>,
    step_s: f64,
    most_s: f64,
    inside: bool,
) -> Result<[f64; 3], Restless> {
    let window = (WINDOW_S / step_s).ceil().max(2.0) as usize;
    let windows = |time_s: f64| (time_s / (window as f64 * step_s)).ceil().max(1.0) as usize;
    let mut moved = [0.0; 3];
    let mut before: Vec<f64> = Vec::new();
    for number in 1..=windows(most_s) {
        let mut at = control.positions(evaluator);
        let mut ends = at.map(|angle| [angle; 2]);
        for _ in 0..window {
            evaluator.step_channels(step_s);
            at = control.positions(evaluator);
            for (end, angle) in ends.iter_mut().zip(at) {
                *end = [end[0].min(angle), end[1].max(angle)];
            }
        }
        moved = ends.map(|[low, high]| high - low);
        // A surface that channels do not move has no angle here.
        if !moved.iter().all(|moved| moved.is_nan() || *moved < STILL) {
            continue;
        }
        if !inside || number >= windows(LONGEST_INSIDE_S) {
            return Ok(at);
        }
        let now: Vec<f64> =
            control.outputs.iter().map(|&index| evaluator.get_index(index).unwrap_or(f64::NAN)).collect();
        let steady = |(now, before): (&f64, &f64)| (now - before).abs() <= STEADY * now.abs().max(1.0);
        if now.len() == before.len() && now.iter().zip(&before).all(steady) {
            return Ok(at);
        }
        before = now;
    }
    let most = if moved[1] > moved[0] { 1 } else { 0 };
    let most = if moved[2] > moved[most] || moved[most].is_nan() { 2 } else { most };
    Err(Restless { surface: NAMES[most], rate_rad_s: moved[most] / (window as f64 * step_s) })
}
