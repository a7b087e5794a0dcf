//! Are the units and signs of the channels possible? Degrees read as radians and their like are noticed here.
//!
//! The checks use only physics that every aircraft shares: the pitch angle is the integral of the pitch rate, an
//! accelerometer at rest shows one g upwards, the path angle times the speed is the climb rate.

use crate::noise::median;

/// How sure a check is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// No flight can look like this: the estimation is refused.
    Certain,
    /// Unusual: said in the verdict.
    Doubtful,
}

/// A channel whose unit or sign looks wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitDoubt {
    /// Channel.
    pub channel: String,
    /// How sure.
    pub certainty: Certainty,
    /// What was found, what was expected, what to do.
    pub message: String,
}

/// Channels that are looked at, SI; an empty slice where a channel is not there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Signals<'a> {
    /// Time, s.
    pub time: &'a [f64],
    /// True airspeed, m/s.
    pub true_airspeed: &'a [f64],
    /// Angle of attack, rad.
    pub alpha: &'a [f64],
    /// Pitch angle, rad.
    pub theta: &'a [f64],
    /// Pitch rate, rad/s.
    pub q: &'a [f64],
    /// Specific force along body z, m/s^2.
    pub az: &'a [f64],
    /// Specific force along body x, m/s^2.
    pub ax: &'a [f64],
    /// Elevator, rad.
    pub elevator: &'a [f64],
    /// Altitude, m.
    pub altitude: &'a [f64],
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Standard gravity, m/s^2; flight is nowhere off it by more than a hundredth.
const GRAVITY: f64 = 9.80665;

/// All checks.
pub fn check_units(signals: &Signals) -> Vec<UnitDoubt> {
    let mut doubts = Vec::new();
    angle_sizes(signals, &mut doubts);
    pitch_rate(signals, &mut doubts);
    alpha_scale(signals, &mut doubts);
    normal_acceleration(signals, &mut doubts);
    climb(signals, &mut doubts);
    airspeed(signals, &mut doubts);
    doubts
}

fn doubt(doubts: &mut Vec<UnitDoubt>, channel: &str, certainty: Certainty, message: String) {
    // The first finding about a channel is the plainest one, unless a later one is surer.
    let new = UnitDoubt { channel: channel.to_owned(), certainty, message };
    match doubts.iter_mut().find(|d| d.channel == channel) {
        Some(old) if old.certainty == Certainty::Doubtful && certainty == Certainty::Certain => *old = new,
        Some(_) => {}
        None => doubts.push(new),
    }
}

/// Median of the absolute values of what is there.
fn typical_size(values: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = values.iter().filter(|v| v.is_finite()).map(|v| v.abs()).collect();
    median(&mut sizes)
}

/// The 5 and 95 % quantiles: the span a signal really uses, outliers aside.
fn span(values: &[f64]) -> Option<(f64, f64)> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if sorted.len() < 8 {
        return None;
    }
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| sorted[((sorted.len() - 1) as f64 * part) as usize];
    Some((at(0.05), at(0.95)))
}

fn say_degrees(channel: &str, found: String) -> String {
    format!(
        "channel `{channel}` looks like degrees read as radians: {found}. If it is in degrees, name the column \
         `{channel}_deg`, or give its unit in the model file: [channels] {channel} = {{ header = \"...\", unit = \"deg\" }}"
    )
}

/// Angles larger than an aeroplane flies with.
fn angle_sizes(s: &Signals, doubts: &mut Vec<UnitDoubt>) {
    // Largest ordinary value of 95 % of the samples, and the value beyond which no flight is possible, rad.
    for (name, values, unusual, impossible) in
        [("alpha", s.alpha, 0.6, 1.2), ("theta", s.theta, 1.2, 1.65), ("elevator", s.elevator, 0.7, 1.05)]
    {
        let Some((low, high)) = span(values) else { continue };
        let size = low.abs().max(high.abs());
        if size > unusual {
            let certainty = if size > impossible { Certainty::Certain } else { Certainty::Doubtful };
            let found = format!(
                "it runs from {low:.3} to {high:.3} rad, i.e. {:.0} to {:.0} deg",
                low * DEGREES,
                high * DEGREES
            );
            doubt(doubts, name, certainty, say_degrees(name, found));
        }
    }
    let Some((low, high)) = span(s.q) else { return };
    let size = low.abs().max(high.abs());
    if size > 1.5 {
        let certainty = if size > 4.0 { Certainty::Certain } else { Certainty::Doubtful };
        let found = format!("it runs from {low:.3} to {high:.3} rad/s");
        doubt(doubts, "q", certainty, say_degrees("q", found));
    }
}

/// Slope of the windowed changes of `signal` on those of `cause`, and their correlation.
fn slope(signal: &[f64], cause: &[f64]) -> Option<(f64, f64)> {
    let pairs: Vec<(f64, f64)> =
        signal.iter().zip(cause).map(|(a, b)| (*a, *b)).filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
    if pairs.len() < 10 {
        return None;
    }
    let n = pairs.len() as f64;
    let (mean_a, mean_b) = pairs.iter().fold((0.0, 0.0), |(a, b), p| (a + p.0 / n, b + p.1 / n));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        aa += (a - mean_a) * (a - mean_a);
        bb += (b - mean_b) * (b - mean_b);
        ab += (a - mean_a) * (b - mean_b);
    }
    (aa > 0.0 && bb > 0.0).then(|| (ab / bb, ab / (aa * bb).sqrt()))
}

/// Changes over windows of about `width` seconds, and the integral of `rate` over the same windows.
fn windows(time: &[f64], signal: &[f64], rate: impl Fn(usize) -> f64, width: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut changes, mut integrals) = (Vec::new(), Vec::new());
    let mut start = 0;
    while start + 1 < time.len() {
        let mut end = start;
        let mut integral = 0.0;
        while end + 1 < time.len() && time[end] - time[start] < width - 1e-9 {
            integral += 0.5 * (rate(end) + rate(end + 1)) * (time[end + 1] - time[end]);
            end += 1;
        }
        // Windows across a gap say nothing.
        if time[end] - time[start] < 1.5 * width {
            changes.push(signal[end] - signal[start]);
            integrals.push(integral);
        }
        start = end.max(start + 1);
    }
    (changes, integrals)
}

/// `theta' = q` with the wings level: a ratio near 57.3 or its reciprocal is a unit, not a manoeuvre.
fn pitch_rate(s: &Signals, doubts: &mut Vec<UnitDoubt>) {
    if s.theta.is_empty() || s.q.is_empty() {
        return;
    }
    let (change, integral) = windows(s.time, s.theta, |k| s.q[k], 0.5);
    let Some((ratio, correlation)) = slope(&change, &integral) else { return };
    let near = |value: f64, target: f64| value > 0.6 * target && value < 1.6 * target;
    let found = |other: &str| format!("the pitch angle changes {ratio:.3} times as fast as {other} says");
    if correlation > 0.8 && near(ratio, DEGREES) {
        doubt(doubts, "theta", Certainty::Certain, say_degrees("theta", found("q")));
    } else if correlation > 0.8 && near(ratio, 1.0 / DEGREES) {
        doubt(doubts, "q", Certainty::Certain, say_degrees("q", found("q")));
    } else if correlation < -0.8 {
        let message =
            "`theta` and the integral of `q` have opposite signs: expected both positive nose up. Change the \
                       sign of one of them"
                .to_owned();
        doubt(doubts, "q", Certainty::Certain, message);
    } else if correlation > 0.9 && !near(ratio, 1.0) {
        let message =
            format!("{}: expected about 1 with the wings level. Check the units of `q` and `theta`", found("`q`"));
        doubt(doubts, "q", Certainty::Doubtful, message);
    }
}

/// A quick pitch motion changes alpha by at most about as much as the pitch angle.
fn alpha_scale(s: &Signals, doubts: &mut Vec<UnitDoubt>) {
    if s.alpha.is_empty() || s.q.is_empty() || doubts.iter().any(|d| d.channel == "q") {
        return;
    }
    let (change, integral) = windows(s.time, s.alpha, |k| s.q[k], 0.5);
    let Some((ratio, correlation)) = slope(&change, &integral) else { return };
    if correlation > 0.5 && ratio > 8.0 {
        let found = format!("it changes {ratio:.1} times as fast as the pitch rate turns the nose");
        doubt(doubts, "alpha", Certainty::Certain, say_degrees("alpha", found));
    } else if correlation > 0.5 && ratio < 1.0 / 30.0 {
        let message = format!(
            "`alpha` changes only {ratio:.4} times as fast as the pitch rate turns the nose: expected 0.2 to 1.5 in a \
             quick pitch motion. Check its unit"
        );
        doubt(doubts, "alpha", Certainty::Doubtful, message);
    } else if correlation < -0.7 {
        let message =
            "`alpha` falls when the nose rises: expected positive with the wind from below. Check its sign".to_owned();
        doubt(doubts, "alpha", Certainty::Doubtful, message);
    }
}

/// In steady flight an accelerometer along body z (down) shows -9.8 m/s^2; in a manoeuvre what turns the path.
fn normal_acceleration(s: &Signals, doubts: &mut Vec<UnitDoubt>) {
    let mut finite: Vec<f64> = s.az.iter().copied().filter(|v| v.is_finite()).collect();
    let Some(az) = median(&mut finite) else { return };
    // A short record may be all manoeuvre.
    if (-20.0..=-5.0).contains(&az) || is_manoeuvre(s) {
        return;
    }
    let expected = "expected about -9.8 m/s^2, the specific force along body z (down) in steady flight";
    let (certainty, advice) = match az {
        a if (5.0..=20.0).contains(&a) => (Certainty::Certain, "its sign is that of an upward axis: change the sign"),
        a if (-1.6..=-0.5).contains(&a) => (Certainty::Certain, "it looks like g: name the column `az_g`"),
        a if (0.5..=1.6).contains(&a) => (
            Certainty::Certain,
            "it looks like load factor in g, positive up: name the column `nz_g` or change the sign",
        ),
        a if (-50.0..=-24.0).contains(&a) => (Certainty::Certain, "it looks like ft/s^2: name the column `az_ft_s2`"),
        a if (24.0..=50.0).contains(&a) => {
            (Certainty::Certain, "it looks like ft/s^2, positive up: name the column `az_ft_s2` and change the sign")
        }
        a if a.abs() < 0.5 => (
            Certainty::Certain,
            "gravity seems to have been removed: give what an accelerometer measures, with gravity's share",
        ),
        // Between one unit and the next: a manoeuvre sooner than an error.
        a if a.abs() < 50.0 => return,
        _ => (Certainty::Doubtful, "check its unit and sign"),
    };
    doubt(doubts, "az", certainty, format!("channel `az` has the median {az:.3}: {expected}; {advice}"));
}

/// True if the path turns as `az` says, `V (alpha' - q) = az cos a - ax sin a + g cos(theta - a)`, in means over a second.
fn is_manoeuvre(s: &Signals) -> bool {
    if [s.true_airspeed, s.alpha, s.theta, s.q].iter().any(|c| c.is_empty()) {
        return false;
    }
    let rest = |k: usize| {
        let ax = s.ax.get(k).copied().unwrap_or(0.0);
        (ax * s.alpha[k].sin() - GRAVITY * (s.theta[k] - s.alpha[k]).cos()) / s.alpha[k].cos()
    };
    let (change, pitch) = windows(s.time, s.alpha, |k| s.q[k], 1.0);
    let (_, rest) = windows(s.time, s.alpha, rest, 1.0);
    let (_, measured) = windows(s.time, s.alpha, |k| s.az[k], 1.0);
    let (_, duration) = windows(s.time, s.alpha, |_| 1.0, 1.0);
    let speed = typical_size(s.true_airspeed).unwrap_or(f64::NAN);
    let (mut missing, mut predicted): (Vec<f64>, Vec<f64>) = (0..duration.len())
        .filter(|&i| duration[i] > 0.3)
        .map(|i| ((speed * (change[i] - pitch[i]) + rest[i]) / duration[i], measured[i] / duration[i]))
        .filter(|(predicted, measured)| predicted.is_finite() && measured.is_finite())
        .map(|(predicted, measured)| ((measured - predicted).abs(), predicted.abs()))
        .unzip();
    // Noise of alpha, and a sensor off the centre of gravity, cost one or two m/s^2; another unit or sign costs nine.
    matches!((median(&mut missing), median(&mut predicted)), (Some(m), Some(p)) if m < 2.0_f64.max(0.25 * p))
}

/// `h' = V sin(theta - alpha)` with the wings level.
fn climb(s: &Signals, doubts: &mut Vec<UnitDoubt>) {
    if s.altitude.is_empty() {
        return;
    }
    if let Some(size) = typical_size(s.altitude)
        && size > 25_000.0
    {
        let message = format!(
            "channel `altitude` is about {size:.0} m: if it is in feet, name the column `altitude_ft` or give its unit \
             in the model file"
        );
        doubt(doubts, "altitude", Certainty::Doubtful, message);
    }
    if s.true_airspeed.is_empty() || s.theta.is_empty() || s.alpha.is_empty() || !doubts.is_empty() {
        return;
    }
    let rate = |k: usize| s.true_airspeed[k] * (s.theta[k] - s.alpha[k]).sin();
    let (change, integral) = windows(s.time, s.altitude, rate, 2.0);
    let Some((ratio, correlation)) = slope(&change, &integral) else { return };
    if correlation > 0.95 && (2.6..4.2).contains(&ratio) {
        let message = format!(
            "the altitude changes {ratio:.2} times as fast as airspeed and path angle say: `altitude` may be in feet \
             (or the airspeed too small). Name the column `altitude_ft` or give its unit in the model file"
        );
        doubt(doubts, "altitude", Certainty::Doubtful, message);
    }
}

/// `V (alpha' - q) = az cos a - ax sin a + g cos(theta - a)`: the accelerometer turns the path, the speed says how fast.
fn airspeed(s: &Signals, doubts: &mut Vec<UnitDoubt>) {
    if let Some(size) = typical_size(s.true_airspeed)
        && !(5.0..=1200.0).contains(&size)
    {
        let message = format!("channel `true_airspeed` is about {size:.2} m/s: check its unit");
        doubt(doubts, "true_airspeed", Certainty::Doubtful, message);
    }
    let complete = [s.true_airspeed, s.alpha, s.theta, s.q, s.az, s.ax].iter().all(|c| !c.is_empty());
    if !complete || !doubts.is_empty() {
        return;
    }
    let turn = |k: usize| {
        let (sin, cos) = s.alpha[k].sin_cos();
        s.az[k] * cos - s.ax[k] * sin + GRAVITY * (s.theta[k] - s.alpha[k]).cos()
    };
    let (forces, path): (Vec<f64>, Vec<f64>) = {
        let (alpha, force) = windows(s.time, s.alpha, turn, 1.0);
        let (_, pitch) = windows(s.time, s.alpha, |k| s.q[k], 1.0);
        let speed = typical_size(s.true_airspeed).unwrap_or(f64::NAN);
        (force, alpha.iter().zip(&pitch).map(|(a, p)| speed * (a - p)).collect())
    };
    let Some((ratio, correlation)) = slope(&forces, &path) else { return };
    if correlation > 0.9 && !(0.62..=1.6).contains(&ratio) {
        let message = format!(
            "the accelerations turn the path {ratio:.2} times as fast as `true_airspeed` allows: a speed in ft/s read \
             as m/s gives 0.30, one in knots 0.51. Check the units of `true_airspeed`, `alpha` and `az`"
        );
        doubt(doubts, "true_airspeed", Certainty::Doubtful, message);
    }
}
