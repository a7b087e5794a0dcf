//! At what time a control surface or a flow angle was recorded, by when the aircraft reacts to it.
//!
//! A moment makes an angular acceleration at once, and the flow angle makes a force at once. So the moment equation,
//! integrated once over the time,
//!
//! ```text
//! q(t) = integral of qbar (a alpha + b q c/(2V) + d delta(t + tau)),   delta(t + tau) = delta + tau delta'
//!      = a integral(qbar alpha) + b integral(qbar q/V) + d integral(qbar delta) + d tau qbar delta
//! ```
//!
//! and the force equation with the flow angle in the place of the surface have the delay tau of what was recorded as the
//! ratio of two factors (the dynamic pressure changes slowly). No aerodynamic coefficient has to be known. The integrals
//! are those of straight lines between the samples, so that a position that the surface held from its sample on shows as
//! recorded half a sample early.

use phugoid_flight_data::statistics::median;

use super::channels::Channels;
use super::regression::{Factors, factors, integral};
use super::{GUSTS, SIGNIFICANT};
use crate::model_file::ModelFile;
use crate::motion::Motion;
use crate::preparation::prepared::Prepared;
use crate::preparation::resample::at_times;

/// Channels of the moments that the surfaces make.
const PITCH: [&str; 4] = ["true_airspeed", "alpha", "q", "elevator"];
const ROLL_AND_YAW: [&str; 6] = ["true_airspeed", "beta", "p", "r", "aileron", "rudder"];

/// A delay is linear only while it is short against the motion. Where more than this share is left, longer ones are tried
/// first, ...
const TRY_LONGER: f64 = 0.02;
/// ... in these steps, s, up to this many of them either way, ...
const TRIED_STEP_S: f64 = 0.05;
const TRIED: i32 = 8;
/// ... and are taken if they leave at most this part of what was left. In still air the whole is rather flat, and the
/// lowest point of what is flat says nothing.
const LEAVES: f64 = 0.5;

/// Most refinements of a delay about the one found so far.
const MOST_REFINEMENTS: usize = 4;

/// How late a channel was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Delay {
    /// s; negative: early.
    pub(crate) late_s: f64,
    /// One sigma of it, s.
    pub(crate) std_s: f64,
    /// Part of what the equation leaves without a delay that the delay explains, 0 to 1.
    pub(crate) explains: f64,
}

/// A channel as it would be if it had been recorded so much earlier, s; straight between samples, held at the ends.
pub(crate) fn earlier(time: &[f64], values: &[f64], by_s: f64) -> Vec<f64> {
    at_times(time.iter().map(|t| t + by_s), time, values)
}

/// The causes of one equation; the column of the factor that is the delay times that of `RATE` comes last.
pub(crate) struct Causes<'a, const C: usize> {
    pub(crate) time_s: &'a [f64],
    pub(crate) step_s: f64,
    /// What the equation gives, without the constants and drifts of windows.
    pub(crate) signal: &'a [f64],
    /// The other causes; `RATE` and the last one are replaced.
    pub(crate) others: [Vec<f64>; C],
    /// Place of the cause that is late.
    pub(crate) late: usize,
    /// That cause before it is integrated, and the dynamic pressure.
    pub(crate) cause: &'a [f64],
    pub(crate) pressure: &'a [f64],
}

impl<const C: usize> Causes<'_, C> {
    fn factors(&mut self, tried_s: f64) -> Option<Factors<C>> {
        let moved = if tried_s == 0.0 { self.cause.to_vec() } else { earlier(self.time_s, self.cause, tried_s) };
        let by_pressure: Vec<f64> = moved.iter().zip(self.pressure).map(|(v, pressure)| v * pressure).collect();
        self.others[self.late] = integral(self.time_s, &by_pressure);
        self.others[C - 1] = by_pressure;
        factors(self.time_s, self.signal, &self.others, self.step_s)
    }

    /// The delay, if the equation explains the motion. `tries` longer ones too.
    pub(crate) fn delay(mut self, tries: bool) -> Option<Delay> {
        let mut best = (0.0, self.factors(0.0)?);
        let without = best.1.unexplained_without_last;
        if tries && best.1.unexplained > TRY_LONGER {
            let most = LEAVES * best.1.unexplained;
            for step in (-TRIED..=TRIED).filter(|step| *step != 0) {
                let tried_s = f64::from(step) * TRIED_STEP_S;
                let Some(found) = self.factors(tried_s) else { continue };
                if found.unexplained < best.1.unexplained.min(most) {
                    best = (tried_s, found);
                }
            }
        }
        let (mut tried_s, mut found) = best;
        let (mut more, mut std) = found.ratio(C - 1, self.late)?;
        // Steps of a surface are sharp: what is left of the delay is found about the delay found so far.
        for _ in 0..if tries { MOST_REFINEMENTS } else { 0 } {
            if more.abs() <= (SIGNIFICANT * std).max(self.step_s) {
                break;
            }
            let Some(next) = self.factors(tried_s + more).filter(|next| next.unexplained < found.unexplained) else {
                break;
            };
            (tried_s, found) = (tried_s + more, next);
            (more, std) = found.ratio(C - 1, self.late)?;
        }
        (found.unexplained <= GUSTS).then(|| Delay {
            late_s: tried_s + more,
            std_s: std,
            explains: if without > 0.0 { 1.0 - found.unexplained / without } else { 0.0 },
        })
    }
}

/// Dynamic pressure over its median, and the true airspeed over its median.
pub(crate) fn scales(speed: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let usual = median(&mut speed.to_vec()).filter(|usual| *usual > 0.0)?;
    let relative: Vec<f64> = speed.iter().map(|v| v / usual).collect();
    Some((relative.iter().map(|v| v * v).collect(), relative))
}

pub(crate) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// When one surface was recorded.
pub(crate) struct SurfaceDelay {
    /// Canonical name of the surface.
    pub(crate) name: &'static str,
    pub(crate) delay: Delay,
    /// Median step of the samples, s.
    pub(crate) step_s: f64,
}

/// When the surfaces of a flight were recorded; those of which the flight says it.
pub(crate) fn surfaces<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
) -> Vec<SurfaceDelay> {
    let mut found = Vec::new();
    if M::AXES.has_longitudinal() {
        found.extend(Channels::of(prepared, file, &PITCH).and_then(|channels| elevator(&channels)));
    }
    if M::AXES.has_lateral() {
        found.extend(Channels::of(prepared, file, &ROLL_AND_YAW).iter().filter_map(aileron_and_rudder).flatten());
    }
    found
}

/// The elevator's, by the pitching moment.
pub(crate) fn elevator(channels: &Channels) -> Option<SurfaceDelay> {
    let [speed, alpha, q, elevator] = channels.values::<4>()?;
    let (time_s, step_s) = (channels.time_s.as_slice(), channels.step_s()?);
    let (pressure, relative) = scales(speed)?;
    let by_pressure = |values: &[f64]| integral(time_s, &product(&pressure, values));
    // By the airspeed times the dynamic pressure over its square.
    // The moment by the rate of the flow angle (downwash that arrives late) would be taken for a delay.
    let rate = product(&pressure, alpha);
    let others =
        [by_pressure(alpha), integral(time_s, &product(&relative, q)), by_pressure(elevator), rate, Vec::new()];
    let moment = Causes { time_s, step_s, signal: q, others, late: 2, cause: elevator, pressure: &pressure };
    Some(SurfaceDelay { name: "elevator", delay: moment.delay(true)?, step_s })
}

/// The aileron's by the rolling moment, and the rudder's by the yawing moment.
fn aileron_and_rudder(channels: &Channels) -> Option<Vec<SurfaceDelay>> {
    let [speed, beta, p, r, aileron, rudder] = channels.values::<6>()?;
    let (time_s, step_s) = (channels.time_s.as_slice(), channels.step_s()?);
    let (pressure, relative) = scales(speed)?;
    let by_pressure = |values: &[f64]| integral(time_s, &product(&pressure, values));
    let by_speed = |values: &[f64]| integral(time_s, &product(&relative, values));
    let of = |name, signal, late, cause| {
        let others =
            [by_pressure(beta), by_speed(p), by_speed(r), by_pressure(aileron), by_pressure(rudder), Vec::new()];
        let causes = Causes { time_s, step_s, signal, others, late, cause, pressure: &pressure };
        Some(SurfaceDelay { name, delay: causes.delay(true)?, step_s })
    };
    Some([of("aileron", p, 3, aileron), of("rudder", r, 4, rudder)].into_iter().flatten().collect())
}
