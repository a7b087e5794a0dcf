//! Whether the control surfaces and the flow angles are recorded at the time at which the aircraft reacts to them.
//!
//! The moment equation shows the delay of a surface ([`crate::preparation::reaction`]) and the force equation that of a
//! flow angle ([`crate::preparation::windows::delay`]). The kinematics of the other checks says nothing of a surface, and nothing of
//! a flow angle in gusts; here the gusts help, because in still air the flow angle is so tied to the pitch rate and the
//! surface that its delay cannot be told from other coefficients, and its standard error is large.

use phugoid_flight_data::statistics::median;

use super::{Finding, LONG_S, What};
use crate::model_file::InputHold;
use crate::preparation::reaction::delay::SurfaceDelay;
use crate::preparation::windows::SIGNIFICANT;
use crate::preparation::windows::channels::Channels;
use crate::preparation::windows::delay::{Causes, Delay, product, scales};
use crate::preparation::windows::regression::integral;

/// Channels of the symmetric motion in the order in which they are used.
pub(super) const LONGITUDINAL: [&str; 5] = ["true_airspeed", "alpha", "q", "elevator", "az"];
/// Channels of the motion out of the plane of symmetry.
pub(super) const LATERAL: [&str; 7] = ["true_airspeed", "beta", "p", "r", "aileron", "rudder", "ay"];

/// Smallest delay of a surface that is reported, samples.
const SURFACE_SAMPLES: f64 = 1.5;
/// A surface that is recorded earlier or later than this, s, is none that a recorder makes: where an autopilot holds the aircraft in
/// gusts the surface follows the motion, and the moment equation finds 0.26 to 0.5 s; a gyro that stood still for seconds makes one.
const EARLIEST_S: f64 = 0.2;
const LATEST_S: f64 = 0.6;
/// Smallest delay of a flow angle that is reported, samples.
const FLOW_SAMPLES: f64 = 1.0;
/// Chords that a flow angle may be ahead of the force: a boom meets a gust before the wing does, and lift takes some chords
/// to build up (H. Wagner 1925).
const CHORDS_AHEAD: f64 = 2.0;

/// What is wrong with the time of a surface, given how the model moves it between samples.
pub(super) fn surface(found: &SurfaceDelay, hold: InputHold) -> Option<Finding> {
    let SurfaceDelay { name, late_s, std_s, step_s } = *found;
    // Straight lines between the samples of a held input are half a sample early.
    let late_s = if hold == InputHold::Held { late_s + 0.5 * step_s } else { late_s };
    let is_credible = (-EARLIEST_S..LATEST_S).contains(&late_s);
    (is_credible && late_s.abs() > (SIGNIFICANT * std_s).max(SURFACE_SAMPLES * step_s)).then(|| Finding {
        channel: name,
        what: What::Late { late_s, std_s },
        sentence: format!(
            "the {name} was recorded {:.0} ± {:.0} ms {} (two sigma), by when the aircraft reacts to it: check its time \
             stamps and filter{}",
            1e3 * late_s.abs(),
            2e3 * std_s,
            if late_s > 0.0 { "late" } else { "early" },
            if late_s > 0.0 { "" } else { ", whether the command was recorded in the place of the position, and whether the rate gyro is late" }
        ),
    })
}

fn flow_angle(name: &'static str, delay: Delay, step_s: f64, ahead_s: f64) -> Option<Finding> {
    let Delay { late_s: late, std_s: std } = delay;
    let least = if late > 0.0 { FLOW_SAMPLES * step_s } else { ahead_s.max(FLOW_SAMPLES * step_s) };
    (late.abs() > (SIGNIFICANT * std).max(least)).then(|| Finding {
        channel: name,
        what: What::Late { late_s: late, std_s: std },
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

/// What the force that a flow angle makes says of the time at which it was recorded.
pub(super) struct Vane {
    name: &'static str,
    /// The delay by the straight line, where the equation explains the motion.
    delay: Option<Delay>,
    /// What is wrong with the time of the flow angle.
    pub(super) finding: Option<Finding>,
}

/// Part of a long delay that has to lie outside of five standard errors of what the force shows.
const FAR: f64 = 0.5;

impl Vane {
    fn of<const C: usize>(name: &'static str, force: &Causes<'_, C>, ahead_s: f64, surfaces: &[SurfaceDelay]) -> Self {
        let delay = force.delay();
        Self { name, delay, finding: named(name, force, delay, ahead_s, surfaces) }
    }

    /// Whether a finding is that the flow angle is late by far more than the force allows that it makes in gusts: the kinematics of
    /// the other checks knows no gusts, and an aircraft that follows them slowly seems to have a late vane.
    pub(super) fn contradicts(&self, finding: &Finding) -> bool {
        let What::Late { late_s, .. } = finding.what else { return false };
        let is_in_time = self.finding.is_none()
            && self.delay.is_some_and(|Delay { late_s: by_force_s, std_s }| {
                by_force_s.abs() + SIGNIFICANT * std_s < FAR * late_s
            });
        finding.channel == self.name && late_s >= LONG_S && is_in_time
    }
}

/// What is wrong with the time of a flow angle, by the force that it makes. `short` is the delay by the straight line.
fn named<const C: usize>(
    name: &'static str,
    force: &Causes<'_, C>,
    short: Option<Delay>,
    ahead_s: f64,
    surfaces: &[SurfaceDelay],
) -> Option<Finding> {
    let found = short.and_then(|delay| flow_angle(name, delay, force.step_s, ahead_s));
    // A force that comes before a surface which was recorded late looks like one that comes before the flow angle.
    let in_time = surfaces.iter().all(|delay| delay.late_s <= 0.0 || surface(delay, InputHold::Interpolated).is_none());
    let long_s = in_time.then(|| force.long_delay()).flatten();
    // The straight line makes too little of a delay that is long against the gusts.
    let Some(late_s) =
        long_s.filter(|long| found.is_none() || short.is_none_or(|short| *long > short.late_s + force.step_s))
    else {
        return found;
    };
    let std_s = short.map_or(force.step_s, |short| short.std_s);
    Some(Finding {
        channel: name,
        what: What::Late { late_s, std_s },
        sentence: format!(
            "{name} was recorded about {:.0} ms late, by the force that it makes in gusts: check its delay and filter",
            1e3 * late_s
        ),
    })
}

/// The vane of the angle of attack. `chord` in m.
pub(super) fn longitudinal(channels: &Channels, chord: f64, surfaces: &[SurfaceDelay]) -> Option<Vane> {
    let [speed, alpha, q, elevator, az] = channels.values::<5>()?;
    let (time_s, step_s) = (channels.time_s.as_slice(), channels.step_s()?);
    let (pressure, relative) = scales(speed)?;
    let by_pressure = |values: &[f64]| integral(time_s, &product(&pressure, values));
    let others = [by_pressure(alpha), integral(time_s, &product(&relative, q)), by_pressure(elevator), Vec::new()];
    let lift = integral(time_s, az);
    let force = Causes { time_s, step_s, signal: &lift, others, late: 0, cause: alpha, pressure: &pressure };
    let ahead_s = CHORDS_AHEAD * chord / median(&mut speed.to_vec())?;
    Some(Vane::of("alpha", &force, ahead_s, surfaces))
}

/// The vane of the angle of sideslip. `chord` in m.
pub(super) fn lateral(channels: &Channels, chord: f64, surfaces: &[SurfaceDelay]) -> Option<Vane> {
    let [speed, beta, p, r, aileron, rudder, ay] = channels.values::<7>()?;
    let (time_s, step_s) = (channels.time_s.as_slice(), channels.step_s()?);
    let (pressure, relative) = scales(speed)?;
    let by_pressure = |values: &[f64]| integral(time_s, &product(&pressure, values));
    let by_speed = |values: &[f64]| integral(time_s, &product(&relative, values));
    let others = [by_pressure(beta), by_speed(p), by_speed(r), by_pressure(aileron), by_pressure(rudder), Vec::new()];
    let side = integral(time_s, ay);
    let force = Causes { time_s, step_s, signal: &side, others, late: 0, cause: beta, pressure: &pressure };
    let ahead_s = CHORDS_AHEAD * chord / median(&mut speed.to_vec())?;
    Some(Vane::of("beta", &force, ahead_s, surfaces))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preparation::reaction::elevator;

    const STEP_S: f64 = 0.02;

    /// A short period of 1 Hz and damping 0.6 (per s: Z_alpha = -1.5, M_alpha = -20, M_q = -3, M_elevator = -15) under
    /// 3-2-1-1s, in still air or in gusts that alpha shows at once. The elevator and alpha are recorded late by so many
    /// samples; all with a deterministic scatter of sensors: airspeed, alpha, q, elevator and az.
    fn flight(elevator_late: usize, alpha_late: usize, gusts: f64) -> [Vec<f64>; 5] {
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
        [speed, of(0, alpha_late, 5e-4), of(1, 0, 5e-4), of(2, elevator_late, 1e-4), az]
    }

    fn found(columns: &[Vec<f64>; 5]) -> Vec<(&'static str, String)> {
        let time_s: Vec<f64> = (0..columns[0].len()).map(|k| k as f64 * STEP_S).collect();
        let of = |count: usize| Channels::for_tests(time_s.clone(), columns[..count].to_vec());
        let times: Vec<SurfaceDelay> = elevator(&of(4)).into_iter().collect();
        let vane = longitudinal(&of(5), 1.5, &times).unwrap().finding;
        let surfaces = times.iter().filter_map(|found| surface(found, InputHold::Held));
        surfaces.chain(vane).map(|finding| (finding.channel, finding.sentence)).collect()
    }

    #[test]
    fn what_is_recorded_in_time_is_not_named() {
        assert_eq!(found(&flight(0, 0, 0.0)), []);
        assert_eq!(found(&flight(0, 0, 0.02)), []);
    }

    #[test]
    fn a_late_elevator_is_named_with_its_delay() {
        // The elevator is held between samples.
        for (samples, delays) in [(3, 57..=63), (12, 235..=245)] {
            for gusts in [0.0, 0.02] {
                let found = found(&flight(samples, 0, gusts));
                let [("elevator", sentence)] = found.as_slice() else { panic!("{samples} {gusts}: {found:?}") };
                let shown: i32 = sentence.split(' ').find_map(|word| word.parse().ok()).unwrap();
                assert!(delays.contains(&shown) && sentence.contains("late"), "{sentence}");
            }
        }
    }

    #[test]
    fn a_vane_that_is_much_too_late_is_named_in_gusts() {
        for late in [5, 8, 15] {
            let found = found(&flight(0, late, 0.05));
            let alpha = found.iter().find(|(name, _)| *name == "alpha");
            let (_, sentence) = alpha.unwrap_or_else(|| panic!("{late}: {found:?}"));
            let shown: usize = sentence.split(' ').find_map(|word| word.parse().ok()).unwrap();
            assert!(shown.abs_diff(20 * late) <= 20 && sentence.contains("late"), "{sentence}");
        }
    }

    #[test]
    fn a_late_vane_is_named_in_gusts() {
        let found = found(&flight(0, 3, 0.05));
        assert!(found.iter().any(|(name, sentence)| *name == "alpha" && sentence.contains("late")), "{found:?}");
    }

    #[test]
    fn gusts_show_that_a_vane_is_in_time_where_kinematics_calls_it_late() {
        let late = |late_s: f64| Finding {
            channel: "alpha",
            what: What::Late { late_s, std_s: 0.02 },
            sentence: String::new(),
        };
        let vane = |samples: usize, gusts: f64| {
            let columns = flight(0, samples, gusts);
            let time_s = (0..columns[0].len()).map(|k| k as f64 * STEP_S).collect();
            longitudinal(&Channels::for_tests(time_s, columns.to_vec()), 1.5, &[]).unwrap()
        };
        assert!(vane(0, 0.05).contradicts(&late(0.28)) && !vane(0, 0.05).contradicts(&late(0.06)));
        // A vane that is late is late by the force as well.
        assert!(!vane(15, 0.05).contradicts(&late(0.28)));
    }
}
