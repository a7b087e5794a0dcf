//! What became of an estimate: a rule with numbers.

use crate::result::Behaviour;
use phugoid_evaluation::settling::settled_at;

/// Tolerance of convergence, and the swing that still counts as rest, as a fraction of the truth.
pub const TOLERANCE: f64 = 0.05;
/// The last part of the record that is judged.
pub const JUDGED: f64 = 0.2;
/// An estimate must have stayed within the tolerance for this part of the record at its end.
pub const STAYED: f64 = 0.1;
/// Half widths of the bounds, from their middle, beyond which an estimate has left every bound.
pub const AWAY: f64 = 10.0;
/// An estimate that travels this many times its own swing goes up and down: it chatters.
pub const TRAVEL: f64 = 4.0;

/// Judges the estimates of one parameter. All series are of one length; `bounds` are lower and upper.
///
/// In this order, over the last fifth ([`JUDGED`]) of the record:
/// 1. *diverges*: a value is not a number, or lies more than ten ([`AWAY`]) half widths of the bounds from their middle;
/// 2. *converges*: within 5 % ([`TOLERANCE`]) of the truth for at least the last tenth ([`STAYED`]) of the record;
/// 3. *chatters*: it swings (peak to peak) by more than 5 % of the truth, and travels (sum of all steps) more than four
///    ([`TRAVEL`]) times its swing; or it is right at most samples, but jumps off and back;
/// 4. *unfinished*: its drift, continued for one more record, would bring it within 5 %;
/// 5. *biased*: anything else: at rest, or moving slowly, and wrong.
pub fn behaviour(time: &[f64], values: &[f64], truth: f64, bounds: [f64; 2]) -> Behaviour {
    let (Some(&start), Some(&end)) = (time.first(), time.last()) else { return Behaviour::Diverges };
    let from = time.partition_point(|&t| t < end - JUDGED * (end - start)).min(values.len().saturating_sub(1));
    let last = &values[from..];
    let (middle, half) = (0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[1] - bounds[0]).abs());
    if !last.iter().all(|v| v.is_finite() && (v - middle).abs() <= AWAY * half) {
        return Behaviour::Diverges;
    }
    if settled_at(time, values, truth, TOLERANCE).is_some_and(|t| t <= end - STAYED * (end - start)) {
        return Behaviour::Converges;
    }
    let (lowest, highest) = last.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let swing = highest - lowest;
    let travel: f64 = last.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    let (first, final_value) = (last[0], last[last.len() - 1]);
    let drift = final_value - first;
    // One more record is 1 / JUDGED of these windows.
    let nearer = (final_value - truth).abs() < (first - truth).abs();
    let arrives = nearer && (final_value - truth).abs() - drift.abs() / JUDGED <= TOLERANCE * truth.abs();
    let right = last.iter().filter(|v| (**v - truth).abs() <= TOLERANCE * truth.abs()).count();
    let up_and_down = swing > TOLERANCE * truth.abs() && travel > TRAVEL * swing;
    if up_and_down || 2 * right > last.len() {
        Behaviour::Chatters
    } else if arrives {
        Behaviour::Unfinished
    } else {
        Behaviour::Biased
    }
}

/// The worst of several: diverges, chatters, biased, unfinished, converges.
pub fn worst(behaviours: impl IntoIterator<Item = Behaviour>) -> Behaviour {
    let rank = |b: &Behaviour| match b {
        Behaviour::Converges => 0,
        Behaviour::Unfinished => 1,
        Behaviour::Biased => 2,
        Behaviour::Chatters => 3,
        Behaviour::Diverges => 4,
    };
    behaviours.into_iter().max_by_key(rank).unwrap_or(Behaviour::Converges)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(signal: impl Fn(f64) -> f64) -> Behaviour {
        let time: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 0.01).collect();
        let values: Vec<f64> = time.iter().map(|&t| signal(t)).collect();
        behaviour(&time, &values, 4.0, [1.0, 9.0])
    }

    #[test]
    fn synthetic_signals_are_called_by_their_names() {
        assert_eq!(judge(|t| 4.0 + 3.0 * (-t).exp()), Behaviour::Converges);
        assert_eq!(judge(|t| 3.5 + 3.0 * (-t).exp()), Behaviour::Biased);
        // Slow: 24 % off at the end, and one more record would bring it to 3 %.
        assert_eq!(judge(|t| 4.0 + 3.0 * (-0.11 * t).exp()), Behaviour::Unfinished);
        assert_eq!(judge(|t| 4.0 + (40.0 * t).sin()), Behaviour::Chatters);
        // A slow wave with the input is an error, not chatter.
        assert_eq!(judge(|t| 4.6 + 0.4 * (2.0 * t).sin()), Behaviour::Biased);
        assert_eq!(judge(|t| 4.0 + t.exp()), Behaviour::Diverges);
        assert_eq!(judge(|t| if t > 9.0 { f64::NAN } else { 4.0 }), Behaviour::Diverges);
        // A wild beginning is forgiven, an arrival in the last instant is not believed.
        assert_eq!(judge(|t| if t < 1.0 { 1e6 } else { 4.1 }), Behaviour::Converges);
        assert_eq!(judge(|t| if t < 9.5 { 4.5 } else { 4.0 }), Behaviour::Unfinished);
        assert_eq!(judge(|_| 4.21), Behaviour::Biased);
        // Right but for a single jump near the end: that is no bias.
        assert_eq!(judge(|t| if (9.2..9.3).contains(&t) { 6.0 } else { 4.0 }), Behaviour::Chatters);
        assert_eq!(judge(|_| 4.19), Behaviour::Converges);
    }

    #[test]
    fn the_worst_parameter_counts() {
        use Behaviour::*;
        assert_eq!(worst([Converges, Biased, Unfinished]), Biased);
        assert_eq!(worst([Chatters, Diverges]), Diverges);
        assert_eq!(worst([]), Converges);
    }
}
