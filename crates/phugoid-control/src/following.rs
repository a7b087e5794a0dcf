//! Whether a surface does what it is told: its position against the command behind a model of its actuator.
//!
//! A surface that stands still while its command travels by more than any linkage has play is jammed; if it moves again it is looked at
//! anew. Whether one that moves otherwise still answers is told by a probe, a
//! small known part of the command that nothing else is related to: in closed loop the rest of the command reacts to what the surface
//! does, so that the two move together whether it answers or not. The slope of position with command is estimated with the probe as
//! the instrument.

/// What a surface does with its commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Following {
    /// It follows.
    #[default]
    Follows,
    /// It stands still while it should move.
    Jammed,
    /// It moves, but not with the command: it trails in the air.
    Floating,
    /// It follows, but slowly.
    Slow,
    /// It follows on average and oscillates about the command.
    Oscillating,
    /// It follows with play: it stays where it is until the command has gone through a gap.
    Play,
}

impl Following {
    /// Whether a command still moves it.
    pub fn can_be_used(self) -> bool {
        !matches!(self, Self::Jammed | Self::Floating)
    }
}

/// Time for which the position has to be beyond the tolerance before it counts, s.
const PATIENCE: f64 = 0.2;
/// Time for which a surface has to stand still to count as jammed, s.
const STILL: f64 = 0.5;
/// Play from one side to the other that a linkage may have, rad: 2.5 deg. MIL-A-8870C allows a new aircraft a few tenths of a degree to
/// 1.15 deg; a worn linkage has twice that. A surface that is apart from its command by no more may be in such a gap.
const PLAY: f64 = 2.5 * core::f64::consts::PI / 180.0;
/// Part of its motion that goes towards the command in a surface that obeys, however slowly: one that trails in the air moves as often away
/// from it.
const TOWARDS: f64 = 0.8;
/// Time after which what stays within a play is called that, s: several periods of the probe.
const LONG: f64 = 4.0;
/// Slope of the position with the command that divides what follows from what does not.
const SLOPE: f64 = 0.4;
/// Time for which a look asks for a probe, s: two periods of the slowest part of the excitation (`excitation.rs`). What has not shown by
/// then (a surface that swings within a play) will not show by more of it, and the probe moves the aircraft.
const ENOUGH: f64 = 10.0;
/// Independent looks per second: the product of probe and motion changes with some hertz.
const LOOKS: f64 = 4.0;

/// The watch over one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// Time constant and largest rate of the healthy actuator, s and rad/s.
    lag: f64,
    rate_limit: f64,
    /// Largest difference that sensor and actuator may make, rad.
    tolerance: f64,
    expected: Option<f64>,
    /// How long the position has been beyond the tolerance, s.
    beyond: f64,
    /// For how long the watch has looked at what the surface does, s; zero while it follows.
    looked: f64,
    /// The probe behind the healthy actuator, rad.
    probe: f64,
    /// Number of samples looked at, and sums over them: lagged command, position, probe; the squares of these; products of command
    /// with position, of either with the probe. Command and position count from the first.
    samples: f64,
    sums: [f64; 9],
    first: [f64; 2],
    /// Where it was when it was last seen to move, rad, for how long it has stood there, s, and the least and the largest lagged command
    /// since then, rad.
    rest: f64,
    stood: f64,
    travelled: [f64; 2],
    /// The least and the largest difference of position and lagged command since the look began, rad.
    apart: [f64; 2],
    /// How far it has moved since then, and how far of it towards the command, rad.
    moved: [f64; 2],
    /// Where it was when it was found jammed, rad.
    jammed: f64,
    fastest: f64,
    last: f64,
    found: Following,
}

impl Follower {
    /// A watch over a surface whose healthy actuator has this time constant (s) and largest rate (rad/s); differences up to
    /// `tolerance` (rad) are those of its sensor and model: four standard deviations of the noise and half a degree do.
    pub fn new(lag: f64, rate_limit: f64, tolerance: f64) -> Self {
        Self {
            lag,
            rate_limit,
            tolerance,
            expected: None,
            beyond: 0.0,
            looked: 0.0,
            probe: 0.0,
            samples: 0.0,
            sums: [0.0; 9],
            first: [0.0; 2],
            rest: f64::NAN,
            stood: 0.0,
            travelled: [0.0; 2],
            apart: [0.0; 2],
            moved: [0.0; 2],
            jammed: f64::NAN,
            fastest: 0.0,
            last: f64::NAN,
            found: Following::Follows,
        }
    }

    /// What the surface does. It stays said once it is found, but for a surface that stands or moves again.
    pub fn found(&self) -> Following {
        self.found
    }

    /// Whether it does not follow and it is not known yet what it does instead, or it is jammed and may come free. Moving it a little
    /// would tell. Of one that could be looked at for ten seconds moving it more would tell nothing.
    pub fn is_in_doubt(&self) -> bool {
        self.found == Following::Jammed
            || (self.looked > 0.0 && self.looked < ENOUGH && self.found == Following::Follows)
    }

    /// The largest rate that was seen since it stopped to follow, rad/s.
    pub fn fastest(&self) -> f64 {
        self.fastest
    }

    /// One frame: the command that was in force since the last one, the part of it that is a probe, and the position now (rad). A
    /// position that is no number is left out.
    pub fn update(&mut self, command: f64, probe: f64, position: f64, sample_time: f64) -> Following {
        if !probe.is_finite() || !position.is_finite() || !command.is_finite() {
            return self.found;
        }
        let expected = self.expected.get_or_insert(position);
        // The exact lag over a sample, and the limit of its rate.
        let share = 1.0 - libm::exp(-sample_time / self.lag);
        self.probe += share * (probe - self.probe);
        let lagged = (command - *expected) * share;
        let most = self.rate_limit * sample_time;
        *expected += lagged.max(-most).min(most);
        let expected = *expected;
        let away = (position - expected).abs() > self.tolerance;
        self.beyond = if away { self.beyond + sample_time } else { (self.beyond - sample_time).max(0.0) };
        // A tenth of the tolerance is the noise of its sensor.
        let moved = (position - self.rest).abs() > 0.1 * self.tolerance;
        if moved || self.rest.is_nan() {
            (self.rest, self.stood, self.travelled) = (position, 0.0, [expected; 2]);
        } else {
            self.stood += sample_time;
            self.travelled = wider(self.travelled, expected);
        }
        if self.found.can_be_used() && self.is_stuck() {
            (self.found, self.jammed, self.looked) = (Following::Jammed, position, 0.0);
        } else if self.found == Following::Jammed {
            // What moves again by more than the noise of its sensor is looked at anew.
            if self.looked > 0.0 || (position - self.jammed).abs() > self.tolerance {
                self.look(expected, position, sample_time);
            }
        } else if self.looked > 0.0 || self.beyond >= PATIENCE {
            self.look(expected, position, sample_time);
        }
        self.last = position;
        self.found
    }

    /// Whether it stands, beyond the tolerance, while the command has travelled by more than a play.
    fn is_stuck(&self) -> bool {
        self.beyond >= PATIENCE && self.stood >= STILL && self.travelled[1] - self.travelled[0] > PLAY
    }

    /// Watches how command and position move together until that says what the surface does.
    fn look(&mut self, expected: f64, position: f64, sample_time: f64) {
        if self.looked == 0.0 {
            (self.samples, self.sums, self.first) = (0.0, [0.0; 9], [expected, position]);
            (self.apart, self.moved) = ([position - expected; 2], [0.0; 2]);
        }
        self.looked += sample_time;
        self.apart = wider(self.apart, position - expected);
        let step = position - self.last;
        if step.is_finite() {
            self.moved[0] += step.abs();
            self.moved[1] += if (expected - self.last) * step > 0.0 { step.abs() } else { 0.0 };
        }
        let (c, p, e) = (expected - self.first[0], position - self.first[1], self.probe);
        self.samples += 1.0;
        for (sum, added) in self.sums.iter_mut().zip([c, p, e, c * c, p * p, e * e, c * p, c * e, p * e]) {
            *sum += added;
        }
        let rate = (position - self.last).abs() / sample_time;
        if rate.is_finite() {
            // Of a few samples: the noise of one is none of its motion.
            self.fastest += (sample_time / STILL) * (rate - self.fastest).max(0.0);
        }
        if !matches!(self.found, Following::Follows | Following::Jammed) {
            return;
        }
        if self.beyond == 0.0 && self.found == Following::Follows {
            // What it was is over.
            self.looked = 0.0;
            return;
        }
        if self.stood >= STILL {
            // Whether it answers is told by what moves. One that was jammed and stands again for long is jammed where it stands now.
            if self.found == Following::Jammed && self.stood >= LONG {
                (self.looked, self.jammed) = (0.0, position);
            }
            return;
        }
        // In the gap of a play a small motion of the command moves nothing, which says nothing of a larger one.
        let is_within_play = self.apart[1] - self.apart[0] <= PLAY;
        let obeys = self.moved[1] > TOWARDS * self.moved[0];
        if is_within_play && self.found == Following::Follows {
            if self.looked >= LONG && obeys && self.moved[0] > PLAY {
                self.found = Following::Play;
            }
            return;
        }
        let [mean_c, mean_p, mean_e, cc, pp, ee, cp, ce, pe] = self.sums.map(|sum| sum / self.samples);
        let (variance_c, variance_p, variance_e) = (cc - mean_c * mean_c, pp - mean_p * mean_p, ee - mean_e * mean_e);
        let (with_position, with_command) = (pe - mean_p * mean_e, ce - mean_c * mean_e);
        // Without a probe nothing can be said.
        if with_command <= 0.0 {
            return;
        }
        let slope = with_position / with_command;
        let left = (variance_p - 2.0 * slope * (cp - mean_c * mean_p) + slope * slope * variance_c).max(0.0);
        let error = libm::sqrt(left * variance_e / (LOOKS * self.looked).max(1.0)) / with_command;
        // To give a surface up that still answers is the worse mistake: that takes more evidence.
        if slope + 3.0 * error < SLOPE && self.looked >= 2.0 {
            // What only ever moves towards its command is slow, and does not trail in the air. One that was jammed was not slow.
            let is_slow = obeys && self.found == Following::Follows;
            self.found = if is_slow { Following::Slow } else { Following::Floating };
        } else if self.found == Following::Jammed {
            // It was seen to stand while it should have moved: to be used again takes as much evidence as to be given up.
            if slope - 3.0 * error > SLOPE && self.looked >= 2.0 && obeys {
                (self.found, self.looked, self.beyond) = (Following::Follows, 0.0, 0.0);
            }
        } else if slope - 1.5 * error > SLOPE && self.looked >= 1.0 {
            // About its command on average, it oscillates; behind it, it is slow.
            let difference = (mean_p + self.first[1]) - (mean_c + self.first[0]);
            let swings = variance_p > 1.2 * variance_c && difference.abs() < self.tolerance;
            self.found = if swings { Following::Oscillating } else { Following::Slow };
        }
    }
}

/// The least and the largest value with another one.
fn wider([least, largest]: [f64; 2], value: f64) -> [f64; 2] {
    [least.min(value), largest.max(value)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: f64 = core::f64::consts::PI / 180.0;

    /// A surface that is told a moving command and does `answer(time, command, position)` after two seconds.
    fn watch(answer: impl Fn(f64, f64, f64) -> f64, size: f64) -> (Following, f64) {
        let mut follower = Follower::new(0.05, 1.0, 0.6 * DEGREE);
        let (mut position, mut frozen) = (0.0, 0.0);
        for k in 0..1000 {
            let time = 0.01 * f64::from(k);
            let probe = 0.6 * size * libm::sin(4.3 * time);
            // A controller answers what the surface does with the opposite.
            let command = size * libm::sin(2.0 * time) + probe - 0.5 * position;
            position += (command - position) * (1.0 - libm::exp(-0.01 / 0.05));
            if k == 200 {
                frozen = position;
            }
            if time >= 2.0 {
                position = answer(time, command, frozen);
            }
            if follower.update(command, probe, position, 0.01) != Following::Follows {
                return (follower.found(), time);
            }
        }
        (follower.found(), f64::INFINITY)
    }

    #[test]
    fn what_a_surface_does_is_told_soon() {
        let size = 4.0 * DEGREE;
        let soon = |(found, at): (Following, f64), expected: Following| {
            assert_eq!(found, expected);
            assert!(at < if expected == Following::Oscillating { 6.0 } else { 5.0 }, "{expected:?} {at}");
        };
        soon(watch(|_, _, frozen| frozen, size), Following::Jammed);
        soon(watch(|t, _, _| 2.0 * DEGREE * libm::sin(0.9 * t + 1.0), size), Following::Floating);
        soon(watch(|t, c, _| c + 3.0 * DEGREE * libm::sin(9.0 * t), size), Following::Oscillating);
    }

    /// A command that moves by this (rad) and does not answer, to a surface that moves by `answer(time, command, position)`.
    fn told(follower: &mut Follower, size: f64, from: u32, to: u32, answer: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let mut position = 0.0;
        for k in from..to {
            let time = 0.01 * f64::from(k);
            let probe = 0.6 * size * libm::sin(4.3 * time);
            let command = size * libm::sin(2.0 * time) + probe;
            position = answer(time, command, position);
            follower.update(command, probe, position, 0.01);
        }
        position
    }

    /// With a gap of 1.5 deg, a surface stays where it is for a second and more while a small command moves, and is in use all the
    /// same; with a command that goes farther it follows.
    #[test]
    fn play_is_no_jam() {
        let half = 0.75 * DEGREE;
        let gap = |_: f64, command: f64, position: f64| position.clamp(command - half, command + half);
        for size in [0.7, 1.0, 2.0, 4.0] {
            let mut follower = Follower::new(0.05, 1.0, 0.6 * DEGREE);
            told(&mut follower, size * DEGREE, 0, 3000, gap);
            let found = follower.found();
            assert!(found.can_be_used() && found != Following::Slow, "{size}: {found:?}");
        }
    }

    /// A surface that stands for five seconds is jammed, and is used again once it moves with its command again.
    #[test]
    fn a_surface_that_moves_again_is_used_again() {
        let mut follower = Follower::new(0.05, 1.0, 0.6 * DEGREE);
        told(&mut follower, 3.0 * DEGREE, 0, 500, |_, _, position| position);
        assert_eq!(follower.found(), Following::Jammed);
        assert!(follower.is_in_doubt(), "it may come free");
        let obeys = |_: f64, command: f64, position: f64| position + 0.18 * (command - position);
        told(&mut follower, 3.0 * DEGREE, 500, 1500, obeys);
        assert_eq!(follower.found(), Following::Follows);
        // What trails in the air after it stood is no more used than before.
        let mut follower = Follower::new(0.05, 1.0, 0.6 * DEGREE);
        told(&mut follower, 3.0 * DEGREE, 0, 500, |_, _, position| position);
        told(&mut follower, 3.0 * DEGREE, 500, 3500, |t, _, _| 2.0 * DEGREE * libm::sin(0.9 * t + 1.0));
        assert_eq!(follower.found(), Following::Floating);
    }

    /// At two degrees per second a surface is far behind its command, and still goes where it is told.
    #[test]
    fn a_very_slow_surface_does_not_float() {
        let mut follower = Follower::new(0.05, 1.0, 0.6 * DEGREE);
        let slow =
            |_: f64, command: f64, position: f64| position + (command - position).clamp(-0.02 * DEGREE, 0.02 * DEGREE);
        told(&mut follower, 5.0 * DEGREE, 0, 2000, slow);
        assert_eq!(follower.found(), Following::Slow);
    }

    #[test]
    fn a_surface_that_follows_is_left_alone() {
        let mut follower = Follower::new(0.05, 1.0, 0.6 * DEGREE);
        let mut position = 0.0_f64;
        for k in 0..3000 {
            let command = 0.3 * libm::sin(0.1 * f64::from(k)) * if k % 400 < 200 { 1.0 } else { -1.0 };
            let step = (command - position) * (1.0 - libm::exp(-0.01 / 0.05));
            position += step.clamp(-0.01, 0.01);
            let noise = 0.1 * DEGREE * libm::sin(37.7 * f64::from(k * k));
            assert_eq!(follower.update(command, 0.0, position + noise, 0.01), Following::Follows);
            follower.update(f64::NAN, f64::NAN, f64::NAN, 0.01);
        }
    }
}
