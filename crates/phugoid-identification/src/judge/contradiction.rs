//! Whether the residuals say that the model is wrong, judged where the flight teaches something.
//!
//! Seconds in which nothing moves fit any model. They must not outvote the manoeuvre, so residuals are counted over the
//! whole record and over the blocks in which each regressor moves, and one of them is enough.

use crate::core::axes::Group;
use crate::core::estimation::{EstimationStatus, ReasonCode, Signal, VerdictReason};
use crate::core::output::Output;
use crate::judge::equations::{Equations, Explained};

/// Share of an output's samples beyond six sigmas from which, if they also come in runs, the model is said to
/// contradict the flight. Sensors that throw single bad values do not make runs.
const CONTRADICTED: f64 = 0.05;
/// Lag-one correlation of clipped residuals from which they are called coloured.
const COLOURED: f64 = 0.4;
/// Share of an equation's motion that its terms have to explain before the estimates are held against it: below, noise
/// and turbulence decide. On 230 sound flights of eight aircraft the true values then lost less than half of it.
const TELLS: f64 = 0.6;
/// How often chance may let the best values explain as much more than the estimates: one flight of a thousand, as with missing terms.
/// Free values fit noise as well, and where a second or two of motion are left behind a change, two of them explained up to 70 % more of
/// it than values that were right.
const CHANCE: f64 = 0.001;
/// Part of what the terms could explain from which on the estimates are doubtful when they lose it ...
const LOST: f64 = 0.4;
/// ... and from which on they are refused.
const MOST_LOST: f64 = 0.75;
/// A channel counts as rejected where more than half of its samples lie beyond six sigmas for so many seconds in
/// succession.
const REJECTED_S: usize = 3;

/// How the whitened residuals of one output are spread, once there are enough of them.
pub(crate) struct Spread {
    /// Number of samples that have a residual.
    pub(crate) present: usize,
    /// Number of residuals beyond six standard deviations.
    pub(crate) outliers: usize,
    /// Lag-one correlation, outliers clipped to three sigmas.
    colour: f64,
}

impl Spread {
    pub(crate) fn of(signal: &Signal) -> Option<Self> {
        Self::of_values(signal.values.iter().copied())
    }

    fn of_values(values: impl Iterator<Item = f64>) -> Option<Self> {
        let present: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        if present.len() < 20 {
            return None;
        }
        let core: Vec<f64> = present.iter().map(|v| v.clamp(-3.0, 3.0)).collect();
        let power: f64 = core.iter().map(|v| v * v).sum();
        let lagged: f64 = core.windows(2).map(|w| w[0] * w[1]).sum();
        Some(Self {
            present: present.len(),
            outliers: present.iter().filter(|v| v.abs() > 6.0).count(),
            colour: if power > 0.0 { lagged / power } else { 0.0 },
        })
    }

    fn share(&self) -> f64 {
        self.outliers as f64 / self.present as f64
    }

    fn contradicts(&self) -> bool {
        self.share() > CONTRADICTED && self.colour > COLOURED
    }
}

/// The lag-one correlation of an output's whitened residuals, if they are coloured.
pub(crate) fn colour(residuals: impl Iterator<Item = f64>) -> Option<f64> {
    Spread::of_values(residuals).map(|spread| spread.colour).filter(|colour| *colour > COLOURED)
}

/// The equations of motion of a record at the estimates of a run.
pub(crate) struct AtEstimates<'a> {
    pub(crate) equations: &'a Equations,
    /// Works the same out with the noise of the sensors once more ([`Equations::noisier`]).
    pub(crate) noisier: &'a dyn Fn() -> Vec<Equations>,
}

/// What the residuals and the equations say against the model: whitened residuals by output at the times given, the
/// equations if there are any, the stretches that do not count, and the groups of axes of which parameters were estimated.
pub(crate) fn reasons(
    time_s: &[f64],
    residuals: &[Signal],
    at_estimates: Option<&AtEstimates<'_>>,
    unsettled: &Unsettled,
    learnt: &[Group],
) -> Vec<VerdictReason> {
    let equations = at_estimates.map(|at| at.equations);
    let mut found: Vec<VerdictReason> = exceedances(time_s, residuals, equations, unsettled).into_iter().collect();
    if found.is_empty() {
        found.extend(rejected(time_s, residuals, unsettled));
    }
    if let Some(AtEstimates { equations, noisier }) = at_estimates {
        // Where nothing has moved on a group of axes, its motion is noise and its parameters are those given beforehand.
        let is_learnt = |found: &&Explained| learnt.contains(&Group::of(found.output));
        let explained = equations.explained(unsettled.from_s);
        let lost = lost(explained.iter().filter(is_learnt));
        let noisier = if lost.is_empty() { Vec::new() } else { noisier() };
        // Noise in the regressors makes right values look wrong. Where it cannot be told from them, the values are what is judged.
        let is_theirs = |of: &&Explained| {
            let beyond = equations.lost_beyond_noise(of.output, unsettled.from_s, &noisier);
            beyond.is_none_or(|beyond| beyond >= LOST)
        };
        found.extend(unexplained(lost.into_iter().filter(is_theirs)));
    }
    found
}

/// The stretches of a run in which residuals say that something is being learnt, and nothing of the model.
pub(crate) struct Unsettled {
    /// Time from which on the final estimates hold, s.
    from_s: f64,
    /// The stretches in which a change was being found, and the one in which a filter learnt what it did not know, s.
    stretches_s: Vec<[f64; 2]>,
}

/// Time before a doubt in which residuals already show the change, and time after the adoption in which the new estimate
/// is not yet there, s: until a doubt opens evidence has to come together, and a short-period motion takes some seconds.
const AROUND_S: [f64; 2] = [3.0, 3.0];
/// Share of a record in which changes may be found: more of them are no changes of the aircraft but a model that does not
/// fit. One change is not too many if residuals have told before it that the model fits: what it has around it is as long in a record
/// of 20 s as in one of an hour, and 30 % of the shorter one. Of such a change only the time from the doubt to the adoption counts, as
/// a share of the rest of the record. What is found while the filter still learns may be a model that never fitted.
const MOST_FINDING: f64 = 0.3;

/// Time after the first motion in which a filter learns, s: start values may be far from the answer, and the noise levels
/// are looked at again after four seconds.
const LEARNING_S: f64 = 5.0;

impl Unsettled {
    /// `changes` are those that were not taken back: the time at which the doubt opened, and that of the adoption, s, in
    /// a record of the length `length_s`. `learns_s` is the time of the first motion of a method that learns as it goes.
    pub(crate) fn new(changes: &[[f64; 2]], length_s: f64, learns_s: Option<f64>) -> Self {
        let from_s = changes.last().map_or(f64::NEG_INFINITY, |[_, adopted_s]| *adopted_s);
        let around = |[doubted_s, adopted_s]: &[f64; 2]| [doubted_s - AROUND_S[0], adopted_s + AROUND_S[1]];
        let mut stretches_s: Vec<[f64; 2]> = changes.iter().map(around).collect();
        let finding_s = stretches_s.iter().map(|[from_s, to_s]| to_s - from_s).sum::<f64>();
        let learnt_s = learns_s.map_or(f64::NEG_INFINITY, |t| t + LEARNING_S);
        let is_one = changes.len() == 1 && stretches_s.iter().all(|[from_s, _]| *from_s > learnt_s);
        let free_s: f64 = if is_one { AROUND_S.iter().sum() } else { 0.0 };
        if finding_s - free_s > MOST_FINDING * (length_s - free_s) {
            stretches_s.clear();
        }
        stretches_s.extend(learns_s.map(|t| [t, t + LEARNING_S]));
        Self { from_s, stretches_s }
    }

    fn contains(&self, time_s: f64) -> bool {
        self.stretches_s.iter().any(|[from_s, to_s]| (*from_s..=*to_s).contains(&time_s))
    }
}

/// An output with the largest share of exceedances that was found, and the parameter in whose blocks it was.
struct Exceedance<'a> {
    output: &'a str,
    share: f64,
    taught: Option<&'a str>,
}

/// The outputs that disagree with their predictions so often, and in runs, that it is the model that is wrong. The
/// contradicting samples were rejected, so that bounds from the remaining samples alone are too small.
fn exceedances(
    time_s: &[f64],
    residuals: &[Signal],
    equations: Option<&Equations>,
    unsettled: &Unsettled,
) -> Option<VerdictReason> {
    let mut found: Vec<Exceedance<'_>> = Vec::new();
    let mut concerns: Vec<String> = Vec::new();
    for signal in residuals {
        let mut seen: Vec<Exceedance<'_>> = Vec::new();
        let judged = |inside: &dyn Fn(f64) -> bool| -> Option<Spread> {
            let samples = time_s.iter().zip(&signal.values).filter(|(t, _)| inside(**t) && !unsettled.contains(**t));
            Spread::of_values(samples.map(|(_, v)| *v)).filter(Spread::contradicts)
        };
        let whole = judged(&|_| true);
        seen.extend(whole.map(|spread| Exceedance { output: &signal.name, share: spread.share(), taught: None }));
        let group = Output::from_name(&signal.name).map(Group::of);
        for (equations, column) in equations.iter().flat_map(|e| (0..e.columns.len()).map(move |column| (e, column))) {
            let of = &equations.columns[column];
            if of.term.is_constant() || group != Some(of.coefficient.group()) {
                continue;
            }
            let Some(excited) = equations.exciting(column) else { continue };
            let inside = |t: f64| equations.block(t).is_some_and(|block| excited[block]);
            if let Some(spread) = judged(&inside) {
                seen.push(Exceedance { output: &signal.name, share: spread.share(), taught: Some(&of.name) });
                if !concerns.contains(&of.name) {
                    concerns.push(of.name.clone());
                }
            }
        }
        found.extend(seen.into_iter().max_by(|a, b| a.share.total_cmp(&b.share)));
    }
    if found.is_empty() {
        return None;
    }
    let words = |e: &Exceedance<'_>| {
        let place = e.taught.map_or_else(String::new, |name| format!(" where the flight teaches {name}"));
        format!("{:.0} % of {}{place}", 100.0 * e.share, e.output)
    };
    let named: Vec<String> = found.iter().map(words).collect();
    let outputs = found.iter().map(|e| e.output.to_owned());
    Some(VerdictReason {
        code: ReasonCode::Contradiction,
        status: EstimationStatus::Refused,
        concerns: outputs.chain(concerns).collect(),
        sentence: format!(
            "The model contradicts this flight: more than six sigmas away are {}. Look for a wrong unit, sign or time, a \
             delay or an offset of a sensor, a wrong mass or geometry, or noise levels that are too small.",
            named.join(", ")
        ),
    })
}

/// The equations whose motion the terms can explain and the estimates do not.
fn lost<'a>(equations: impl Iterator<Item = &'a Explained>) -> Vec<&'a Explained> {
    let is_lost = |of: &&Explained| of.by_terms >= TELLS && of.lost() >= LOST && of.by_chance < CHANCE;
    equations.filter(is_lost).collect()
}

/// What is said of such equations.
fn unexplained<'a>(lost: impl Iterator<Item = &'a Explained>) -> Option<VerdictReason> {
    let lost: Vec<&Explained> = lost.collect();
    let most = lost.iter().map(|of| of.lost()).max_by(f64::total_cmp)?;
    let words = |of: &&Explained| {
        let explained = 100.0 * of.by_estimates;
        let explained = if explained > 0.0 { format!("{explained:.0} %") } else { "less than nothing".to_owned() };
        let (output, by_terms) = (of.output.name(), 100.0 * of.by_terms);
        format!("{by_terms:.0} % of the motion of {output}, and these estimates {explained} (in {:.0} s)", of.seconds)
    };
    let named: Vec<String> = lost.iter().map(words).collect();
    Some(VerdictReason {
        code: ReasonCode::Contradiction,
        status: if most < MOST_LOST { EstimationStatus::Doubtful } else { EstimationStatus::Refused },
        concerns: lost.iter().map(|of| of.output.name().to_owned()).collect(),
        sentence: format!(
            "In the time in which its regressors move, the terms of the model can explain {}. The method was held at wrong \
             values, by a term that the model lacks, noise levels that are too small, a change that it missed or channels \
             that contradict one another: see whether terms are named below, estimate the manoeuvre alone, and compare with \
             another method.",
            named.join("; ")
        ),
    })
}

/// Channels of which most samples were rejected for seconds on end, but for the stretches in which a change was found.
fn rejected(time_s: &[f64], residuals: &[Signal], unsettled: &Unsettled) -> Option<VerdictReason> {
    let start = *time_s.first()?;
    let mut named = Vec::new();
    let mut concerns = Vec::new();
    for signal in residuals {
        // Seconds with a value alone: those without one neither begin nor end a stretch, and a gap takes no room.
        let mut counts: Vec<(f64, [usize; 2])> = Vec::new();
        let judged = |(t, v): &(&f64, &f64)| v.is_finite() && !unsettled.contains(**t);
        for (t, value) in time_s.iter().zip(&signal.values).filter(judged) {
            let second = (t - start).floor();
            if counts.last().is_none_or(|(last, _)| *last != second) {
                counts.push((second, [0; 2]));
            }
            if let Some((_, [present, beyond])) = counts.last_mut() {
                *present += 1;
                *beyond += usize::from(value.abs() > 6.0);
            }
        }
        let (mut length, mut longest, mut end) = (0, 0, 0.0);
        for (second, [present, beyond]) in &counts {
            length = if 2 * beyond > *present { length + 1 } else { 0 };
            if length > longest {
                (longest, end) = (length, second + 1.0);
            }
        }
        if longest >= REJECTED_S {
            let to = start + end;
            named.push(format!("{} from {:.0} s to {to:.0} s", signal.name, to - longest as f64));
            concerns.push(signal.name.clone());
        }
    }
    (!named.is_empty()).then(|| VerdictReason {
        code: ReasonCode::ChannelRejected,
        status: EstimationStatus::Doubtful,
        concerns,
        sentence: format!(
            "Most samples were rejected of {}. Look at these channels there: a stuck or slipped sensor, a change of the \
             aircraft that was not followed, or a noise level that is too small. Leave the stretch out with --from and --to.",
            named.join(", ")
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(values: Vec<f64>) -> Signal {
        Signal { name: "alpha".to_owned(), unit: "-".to_owned(), values }
    }

    fn time(samples: usize) -> Vec<f64> {
        (0..samples).map(|k| 0.02 * k as f64).collect()
    }

    #[test]
    fn a_channel_that_is_rejected_for_seconds_is_named_with_its_times() {
        let none = Unsettled::new(&[], 20.0, None);
        let mut values = vec![0.5; 1000];
        values[200..420].fill(9.0);
        let found = rejected(&time(1000), &[signal(values.clone())], &none).unwrap();
        assert_eq!((found.code, found.status), (ReasonCode::ChannelRejected, EstimationStatus::Doubtful));
        assert!(found.sentence.contains("alpha from 4 s to 8 s"), "{}", found.sentence);
        // Two seconds are what a change takes to be found, and single outliers are no stretch.
        values[300..420].fill(0.5);
        assert_eq!(rejected(&time(1000), &[signal(values)], &none), None);
        let outliers = (0..1000).map(|k| if k % 3 == 0 { 20.0 } else { 0.0 }).collect();
        assert_eq!(rejected(&time(1000), &[signal(outliers)], &none), None);
    }

    #[test]
    fn what_a_change_leaves_until_it_is_found_is_no_contradiction_of_the_model() {
        let time = time(3000);
        let mut values = vec![0.5; 3000];
        values[1400..1600].fill(9.0);
        let found = |changes: &[[f64; 2]]| {
            let codes = |r: VerdictReason| r.code;
            let changes = Unsettled::new(changes, 60.0, None);
            let reasons = reasons(&time, &[signal(values.clone())], None, &changes, &[]);
            reasons.into_iter().map(codes).collect::<Vec<_>>()
        };
        assert_eq!(found(&[]), [ReasonCode::Contradiction]);
        assert_eq!(found(&[[29.0, 31.0]]), []);
        // Elsewhere it excuses nothing, and a model with a change every few seconds is not excused either.
        assert_eq!(found(&[[40.0, 42.0]]), [ReasonCode::Contradiction]);
        assert_eq!(found(&[[10.0, 12.0], [20.0, 22.0], [29.0, 31.0]]), [ReasonCode::Contradiction]);
    }

    #[test]
    fn a_single_change_is_not_too_many_for_a_short_record() {
        // Twenty seconds of which 1.2 about a change do not fit.
        let time = time(1000);
        let mut values = vec![0.5; 1000];
        values[500..560].fill(9.0);
        let found = |changes: &[[f64; 2]], learns_s| {
            let changes = Unsettled::new(changes, 20.0, Some(learns_s));
            reasons(&time, &[signal(values.clone())], None, &changes, &[]).len()
        };
        assert_eq!(found(&[], 2.0), 1);
        assert_eq!(found(&[[10.6, 10.7]], 2.0), 0);
        // The filter still learnt three seconds before the doubt, and nothing tells that the model fitted until then.
        assert_eq!(found(&[[10.6, 10.7]], 3.0), 1);
        // A second change, or a doubt that lasts for more than 30 % of the rest, is a model that does not fit.
        assert_eq!(found(&[[10.6, 10.7], [17.6, 17.7]], 2.0), 1);
        assert_eq!(found(&[[10.1, 14.5]], 2.0), 1);
    }

    #[test]
    fn what_free_values_gain_by_chance_is_no_contradiction() {
        let explained = |by_estimates: f64, by_chance: f64| Explained {
            output: Output::Ax,
            seconds: 1.0,
            left_side: 1.0,
            left_by_estimates: 1.0 - by_estimates,
            by_estimates,
            by_terms: 0.7,
            by_chance,
        };
        let status = |of: Explained| unexplained(lost([of].iter()).into_iter()).map(|reason| reason.status);
        assert_eq!(status(explained(0.4, 1e-4)), Some(EstimationStatus::Doubtful));
        assert_eq!(status(explained(0.1, 1e-4)), Some(EstimationStatus::Refused));
        assert_eq!(status(explained(0.1, 0.01)), None);
        // What cannot be told from the record is not told.
        assert_eq!(status(explained(0.1, f64::NAN)), None);
        // Little that is lost stays little, however certain it is.
        assert_eq!(status(explained(0.5, 0.0)), None);
    }

    #[test]
    fn single_outliers_do_not_contradict_and_runs_do() {
        let spread = |values: Vec<f64>| Spread::of(&signal(values)).unwrap();
        assert!(!spread((0..1000).map(|k| if k % 10 == 0 { 20.0 } else { 0.1 }).collect()).contradicts());
        assert!(spread((0..1000).map(|k| if k % 100 < 10 { 20.0 } else { 0.1 }).collect()).contradicts());
    }
}
