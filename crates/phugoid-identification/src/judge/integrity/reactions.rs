//! Whether the control surfaces and the flow angles are recorded at the time at which the aircraft reacts to them.
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
//! ratio of two factors (the dynamic pressure changes slowly). No aerodynamic coefficient has to be known. The kinematics
//! of the other checks says nothing of a surface, and nothing of a flow angle in gusts; here the gusts help, because in
//! still air the flow angle is so tied to the pitch rate and the surface that its delay cannot be told from other
//! coefficients, and its standard error is large.

use phugoid_flight_data::statistics::median;

use super::channels::Channels;
use super::windows::{Factors, factors, integral};
use super::{Finding, GUSTS, SIGNIFICANT};

/// Channels of the symmetric motion in the order in which they are used.
pub(super) const LONGITUDINAL: [&str; 5] = ["true_airspeed", "alpha", "q", "elevator", "az"];
/// Channels of the motion out of the plane of symmetry.
pub(super) const LATERAL: [&str; 7] = ["true_airspeed", "beta", "p", "r", "aileron", "rudder", "ay"];

/// Smallest delay of a surface that is reported, samples: straight lines between the samples of a held input are half a
/// sample early by themselves.
const SURFACE_SAMPLES: f64 = 1.5;
/// Smallest delay of a flow angle that is reported, samples.
const FLOW_SAMPLES: f64 = 1.0;
/// Chords that a flow angle may be ahead of the force: a boom meets a gust before the wing does, and lift takes some chords
/// to build up (H. Wagner 1925).
const CHORDS_AHEAD: f64 = 2.0;
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

/// Delay in s and one sigma of it: how late the channel was recorded.
type Delay = (f64, f64);

/// A channel as it would be if it had been recorded so much earlier, s; straight between samples, held at the ends.
fn earlier(time: &[f64], values: &[f64], by_s: f64) -> Vec<f64> {
    let at = |t: f64| {
        let after = time.partition_point(|known| *known < t).clamp(1, time.len() - 1);
        let part = ((t - time[after - 1]) / (time[after] - time[after - 1])).clamp(0.0, 1.0);
        values[after - 1] + part * (values[after] - values[after - 1])
    };
    time.iter().map(|t| at(t + by_s)).collect()
}

/// The causes of one equation; the column of the factor that is the delay times that of `RATE` comes last.
struct Causes<'a, const C: usize> {
    time_s: &'a [f64],
    step_s: f64,
    /// What the equation gives, without the constants and drifts of windows.
    signal: &'a [f64],
    /// The other causes; `RATE` and the last one are replaced.
    others: [Vec<f64>; C],
    /// Place of the cause that is late.
    late: usize,
    /// That cause before it is integrated, and the dynamic pressure.
    cause: &'a [f64],
    pressure: &'a [f64],
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
    fn delay(mut self, tries: bool) -> Option<Delay> {
        let mut best = (0.0, self.factors(0.0)?);
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
        (found.unexplained <= GUSTS).then_some((tried_s + more, std))
    }
}

/// Dynamic pressure over its median, and the true airspeed over its median.
fn scales(speed: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let usual = median(&mut speed.to_vec()).filter(|usual| *usual > 0.0)?;
    let relative: Vec<f64> = speed.iter().map(|v| v / usual).collect();
    Some((relative.iter().map(|v| v * v).collect(), relative))
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

fn surface(name: &'static str, (late, std): Delay, step_s: f64) -> Option<Finding> {
    (late.abs() > (SIGNIFICANT * std).max(SURFACE_SAMPLES * step_s)).then(|| Finding {
        channel: name,
        sentence: format!(
            "the {name} was recorded {:.0} ± {:.0} ms {} (two sigma), by when the aircraft reacts to it: check its time \
             stamps and filter{}",
            1e3 * late.abs(),
            2e3 * std,
            if late > 0.0 { "late" } else { "early" },
            if late > 0.0 { "" } else { ", and whether the command was recorded in the place of the position" }
        ),
    })
}

fn flow_angle(name: &'static str, (late, std): Delay, step_s: f64, ahead_s: f64) -> Option<Finding> {
    let least = if late > 0.0 { FLOW_SAMPLES * step_s } else { ahead_s.max(FLOW_SAMPLES * step_s) };
    (late.abs() > (SIGNIFICANT * std).max(least)).then(|| Finding {
        channel: name,
        sentence: format!(
            "{name} was recorded {:.0} ± {:.0} ms {} (two sigma), by the force that it makes in gusts: check its delay and \
             filter{}",
            1e3 * late.abs(),
            2e3 * std,
            if late > 0.0 { "late" } else { "early" },
            if late > 0.0 { "" } else { ", and how far the vane is ahead of the wing" }
        ),
    })
}

/// What is late in the symmetric motion. `chord` in m.
pub(super) fn longitudinal(channels: &Channels, chord: f64) -> Option<Vec<Finding>> {
    let [speed, alpha, q, elevator, az] = channels.values::<5>()?;
    let time_s: &[f64] = &channels.time_s;
    let step_s = channels.step_s()?;
    let (pressure, relative) = scales(speed)?;
    let pressure: &[f64] = &pressure;
    let by_pressure = |values: &[f64]| integral(time_s, &product(pressure, values));
    // By the airspeed times the dynamic pressure over its square.
    let others = || [by_pressure(alpha), integral(time_s, &product(&relative, q)), by_pressure(elevator), Vec::new()];
    let moment = Causes { time_s, step_s, signal: q, others: others(), late: 2, cause: elevator, pressure };
    let lift = integral(time_s, az);
    let force = Causes { time_s, step_s, signal: &lift, others: others(), late: 0, cause: alpha, pressure };
    let ahead_s = CHORDS_AHEAD * chord / median(&mut speed.to_vec())?;
    let found = [
        moment.delay(true).and_then(|delay| surface("elevator", delay, step_s)),
        force.delay(false).and_then(|delay| flow_angle("alpha", delay, step_s, ahead_s)),
    ];
    Some(found.into_iter().flatten().collect())
}

/// What is late in the motion out of the plane of symmetry. `chord` in m.
pub(super) fn lateral(channels: &Channels, chord: f64) -> Option<Vec<Finding>> {
    let [speed, beta, p, r, aileron, rudder, ay] = channels.values::<7>()?;
    let time_s: &[f64] = &channels.time_s;
    let step_s = channels.step_s()?;
    let (pressure, relative) = scales(speed)?;
    let pressure: &[f64] = &pressure;
    let by_pressure = |values: &[f64]| integral(time_s, &product(pressure, values));
    let by_speed = |values: &[f64]| integral(time_s, &product(&relative, values));
    let others =
        || [by_pressure(beta), by_speed(p), by_speed(r), by_pressure(aileron), by_pressure(rudder), Vec::new()];
    let side = integral(time_s, ay);
    let of = |signal, late, cause| Causes { time_s, step_s, signal, others: others(), late, cause, pressure };
    let ahead_s = CHORDS_AHEAD * chord / median(&mut speed.to_vec())?;
    let found = [
        of(p, 3, aileron).delay(true).and_then(|delay| surface("aileron", delay, step_s)),
        of(r, 4, rudder).delay(true).and_then(|delay| surface("rudder", delay, step_s)),
        of(&side, 0, beta).delay(false).and_then(|delay| flow_angle("beta", delay, step_s, ahead_s)),
    ];
    Some(found.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.02;

    /// A short period of 1 Hz and damping 0.6 (per s: Z_alpha = -1.5, M_alpha = -20, M_q = -3, M_elevator = -15) under
    /// 3-2-1-1s, in still air or in gusts that alpha shows at once. The elevator and alpha are recorded late by so many
    /// samples; all with a deterministic scatter of sensors.
    fn flight(elevator_late: usize, alpha_late: usize, gusts: f64) -> Channels {
        let count = 1500;
        let fine = 10;
        let dt = STEP_S / fine as f64;
        let (mut along, mut q, mut gust) = (0.0, 0.0, 0.0);
        let mut random = 1_u64;
        let mut rows: Vec<[f64; 4]> = Vec::new();
        for k in 0..count * fine {
            let t = k as f64 * dt;
            let elevator = match (t % 10.0) as i32 {
                1..=3 => 0.03,
                4 | 5 => -0.03,
                6 => 0.03,
                7 => -0.03,
                _ => 0.0,
            };
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let white = (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            gust += dt * (-2.0 * gust) + gusts * dt.sqrt() * white;
            let alpha = along + gust;
            let force = -1.5 * alpha - 0.2 * elevator;
            if k % fine == 0 {
                rows.push([alpha, q, elevator, force]);
            }
            along += dt * (q + force);
            q += dt * (-20.0 * alpha - 3.0 * q - 15.0 * elevator);
        }
        let late = |k: usize, by: usize, i: usize| rows[k.saturating_sub(by)][i];
        let scatter = |k: usize, i: usize| (12.9898 * k as f64 + 78.233 * i as f64).sin();
        let of = |i: usize, by: usize, noise: f64| {
            (0..count).map(|k| late(k, by, i) + noise * scatter(k, i)).collect::<Vec<f64>>()
        };
        let speed = vec![60.0; count];
        let az = of(3, 0, 1e-4).into_iter().map(|v| 60.0 * v - 9.8).collect();
        let columns = vec![speed, of(0, alpha_late, 5e-4), of(1, 0, 5e-4), of(2, elevator_late, 1e-4), az];
        Channels::for_tests((0..count).map(|k| k as f64 * STEP_S).collect(), columns)
    }

    fn named(channels: &Channels) -> Vec<(&'static str, String)> {
        longitudinal(channels, 1.5).unwrap().into_iter().map(|finding| (finding.channel, finding.sentence)).collect()
    }

    #[test]
    fn what_is_recorded_in_time_is_not_named() {
        assert_eq!(named(&flight(0, 0, 0.0)), []);
        assert_eq!(named(&flight(0, 0, 0.02)), []);
    }

    #[test]
    fn a_late_elevator_is_named_with_its_delay() {
        // Half a sample less than the delay: the elevator is held between samples.
        for (samples, delays) in [(3, 47..=53), (12, 225..=235)] {
            for gusts in [0.0, 0.02] {
                let found = named(&flight(samples, 0, gusts));
                let [("elevator", sentence)] = found.as_slice() else { panic!("{samples} {gusts}: {found:?}") };
                let shown: i32 = sentence.split(' ').find_map(|word| word.parse().ok()).unwrap();
                assert!(delays.contains(&shown) && sentence.contains("late"), "{sentence}");
            }
        }
    }

    #[test]
    fn a_late_vane_is_named_in_gusts() {
        let found = named(&flight(0, 3, 0.05));
        assert!(found.iter().any(|(name, sentence)| *name == "alpha" && sentence.contains("late")), "{found:?}");
    }
}
