//! What a term that the model lacks means for the result without it: which values it bends, and which hold.
//!
//! The method has run with the term too, so that both results can be laid side by side. Where nothing speaks against the
//! result with the term, what the motion had against the result without it is explained: then only those values are in doubt
//! that are not the same in both, and those of the coefficient that lacks the term.

use super::{DIGITS, coefficient, missing_in_words, moved_parameters};
use crate::core::estimation::{
    Estimation, EstimationStatus, FinalStatus, Offer, ReasonCode, TermEffect, VerdictReason,
};
use crate::core::number::significant;
use crate::model_file::ModelFile;

/// Claimed standard errors by which a value of another coefficient than that of a missing term has to move with it before
/// a result that nothing else speaks against is doubtful.
const BENT: f64 = 4.0;
/// Claimed standard errors up to which a value is the same with and without the term: the error that is then left in it is no
/// larger than the one that its bound states.
const SAME: f64 = 1.0;
/// What the motion says against a result, and a missing term may cause. Units, sensors and the data of the aircraft are no
/// matter of terms, and what is not the same throughout a flight may have changed.
const OF_THE_MOTION: [ReasonCode; 6] = [
    ReasonCode::Contradiction,
    ReasonCode::ChannelRejected,
    ReasonCode::FitWorseThanMean,
    ReasonCode::ResidualsAboveNoise,
    ReasonCode::MethodsDisagree,
    ReasonCode::Sign,
];

/// The place in the verdict for the sentence of the missing terms: beside the reasons against the result, of which a missing term
/// is the most probable cause, and before those of the motion where it moves other values, so that nobody looks for a wrong unit
/// first.
pub(crate) fn place(estimation: &Estimation, offer: &Offer) -> usize {
    let Estimation { verdict, reasons, .. } = estimation;
    let of_reason = |said: &String| reasons.iter().any(|reason| reason.sentence == *said);
    let of_motion =
        |said: &String| reasons.iter().any(|reason| OF_THE_MOTION.contains(&reason.code) && reason.sentence == *said);
    let moves = moved_parameters(offer).next().is_some();
    let first = verdict.iter().position(of_motion).filter(|_| moves);
    first.or_else(|| verdict.iter().rposition(of_reason).map(|last| last + 1)).unwrap_or(verdict.len())
}

/// A missing term as a reason against the result without it.
pub(crate) struct Missing {
    /// The reason. Only the parameters that it concerns are in doubt for it.
    pub(crate) reason: VerdictReason,
    /// The reasons that it takes the place of, because they are gone with the term.
    pub(crate) explains: Vec<ReasonCode>,
    /// The times of adopted changes that are no changes of the aircraft, because there are none with the term, s.
    pub(crate) explains_changes: Vec<f64>,
}

/// What a method has found in a record.
#[derive(Clone, Copy)]
pub(crate) struct Found<'a> {
    pub(crate) estimation: &'a Estimation,
    /// What it has predicted of the record, sample by sample before it saw it, nats; zero of a batch method.
    pub(crate) evidence: f64,
}

/// What the missing terms of an offer say of the `first` result, which is without them; `None` if nothing has to be said. `with` is the
/// result with them.
pub(crate) fn missing(offer: &Offer, first: Found<'_>, with: Option<Found<'_>>, file: &ModelFile) -> Option<Missing> {
    let without = first.estimation;
    let against = || without.reasons.iter().filter(|reason| reason.is_against());
    let is_of_the_motion = against().all(|reason| OF_THE_MOTION.contains(&reason.code));
    let settled = with.filter(|with| is_of_the_motion && with.estimation.status == EstimationStatus::Sound);
    let explains: Vec<ReasonCode> = settled.iter().flat_map(|_| against()).map(|reason| reason.code).collect();
    let better = settled.filter(|with| with.evidence > first.evidence);
    let explains_changes = better.map_or_else(Vec::new, |with| changes_without(without, with.estimation));
    let is_bent = |m: &Moved| m.errors > BENT && !is_own(offer, file, m.name) && is_claimed(without, m.name);
    let bent: Vec<Moved> = moved(offer).filter(is_bent).collect();
    if explains.is_empty() && bent.is_empty() && explains_changes.is_empty() {
        return None;
    }
    let holds = |name: &str| {
        let is_same = moved(offer).any(|m| m.name == name && m.errors <= SAME);
        settled.is_some() && is_same && !is_own(offer, file, name)
    };
    // A term that mends the fit and makes of the others what no aeroplane has is not what is missing.
    let is_impossible = |reason: &&VerdictReason| {
        reason.is_against()
            && [ReasonCode::Physics, ReasonCode::Sign].contains(&reason.code)
            && without.reasons.iter().all(|known| known.code != reason.code)
    };
    let impossible = with.and_then(|with| with.estimation.reasons.iter().find(is_impossible));
    let impossible = impossible.map(|reason| reason.sentence.as_str());
    let names = without.parameters.iter().filter(|p| p.status != FinalStatus::Fixed).map(|p| p.name.clone());
    let (holding, concerns): (Vec<String>, Vec<String>) = names.partition(|name| holds(name));
    // Where nothing holds, what was refused stays refused.
    let status = if holding.is_empty() { without.status } else { EstimationStatus::Doubtful };
    let reason = VerdictReason {
        code: ReasonCode::MissingTerm,
        status: status.max(EstimationStatus::Doubtful),
        concerns,
        sentence: in_words(offer, !explains.is_empty(), &explains_changes, &bent, &holding, impossible),
    };
    Some(Missing { reason, explains, explains_changes })
}

/// The sentences of the reason. `explains`: with the terms nothing speaks against the result any more. `impossible`: what of the
/// result with them no aeroplane has.
fn in_words(
    offer: &Offer,
    explains: bool,
    changes_s: &[f64],
    bent: &[Moved<'_>],
    holding: &[String],
    impossible: Option<&str>,
) -> String {
    let term = if offer.missing().count() == 1 { "the term" } else { "these terms" };
    let mut words = format!("The model lacks {}", missing_in_words(offer));
    words.push_str(&if explains {
        format!(". That is what speaks against this result: with {term} nothing does.")
    } else if bent.is_empty() {
        ".".to_owned()
    } else {
        ", and what that makes of the motion is put down to other coefficients.".to_owned()
    });
    if !changes_s.is_empty() {
        let times: Vec<String> = changes_s.iter().map(|time_s| format!("{time_s:.1} s")).collect();
        words.push_str(&format!(
            " The change of the aircraft that was adopted at {} is none: with {term} it is not found, and the flight is \
             predicted better.",
            times.join(" and at ")
        ));
    }
    if !bent.is_empty() {
        let list: Vec<String> = bent.iter().map(Moved::words).collect();
        words.push_str(&format!(" With {term} values of other coefficients move: {}.", list.join(", ")));
    }
    if !holding.is_empty() {
        words.push_str(&format!(
            " The same with and without {term}, within the error that is claimed, and not in doubt for it: {}.",
            holding.join(", ")
        ));
    }
    words.push_str(&match impossible {
        None => format!(" Estimate with {term} (--structure auto, or the lines for the model file below)."),
        Some(why) => format!(
            " With {term} the result is no better, so that something else is missing or wrong, or this flight does not tell it: \
             {why}"
        ),
    });
    words
}

/// Time that two runs may differ by in dating the same change, s.
const SAME_CHANGE_S: f64 = 3.0;

/// The times of the changes that stand in a result and have no counterpart in another, s.
fn changes_without(result: &Estimation, other: &Estimation) -> Vec<f64> {
    let standing = |of: &Estimation| -> Vec<(f64, [f64; 2])> {
        let stands = of.changes.iter().filter(|change| change.outcome.stands());
        stands.map(|change| (change.time_s, change.interval_s.unwrap_or([change.time_s; 2]))).collect()
    };
    let others = standing(other);
    let is_there = |[from_s, to_s]: [f64; 2]| {
        let overlaps = |other: &[f64; 2]| from_s <= other[1] + SAME_CHANGE_S && other[0] <= to_s + SAME_CHANGE_S;
        others.iter().any(|(_, other)| overlaps(other))
    };
    standing(result).into_iter().filter(|(_, interval_s)| !is_there(*interval_s)).map(|(time_s, _)| time_s).collect()
}

/// A value that the method found without the term and with it.
struct Moved<'a> {
    name: &'a str,
    before: f64,
    after: f64,
    /// The distance, in claimed standard errors of the value without the term.
    errors: f64,
}

impl Moved<'_> {
    fn words(&self) -> String {
        let [before, after] = [self.before, self.after].map(|v| significant(v, DIGITS));
        format!("{} {before} -> {after} ({:.1} of its errors)", self.name, self.errors)
    }
}

/// The values of an offer. Of a method that claims no errors nothing is the same, and nothing another.
fn moved(offer: &Offer) -> impl Iterator<Item = Moved<'_>> {
    offer.effects.iter().filter_map(|TermEffect { parameter, before, before_std, after, .. }| {
        let (before, std) = before.zip(before_std.filter(|std| std.is_finite()))?;
        Some(Moved { name: parameter, before, after: *after, errors: (after - before).abs() / std })
    })
}

/// Whether a parameter is of the coefficient that lacks a term: what moves there is no error, because without the term its
/// derivatives mean something else.
fn is_own(offer: &Offer, file: &ModelFile, name: &str) -> bool {
    let of = file.parameters.iter().find(|p| p.name == name).and_then(coefficient);
    of.is_none_or(|of| offer.missing().any(|term| term.coefficient == of.symbol()))
}

/// Whether a result has a value of a parameter that no other reason has taken back.
fn is_claimed(without: &Estimation, name: &str) -> bool {
    let claimed = [FinalStatus::Converged, FinalStatus::Improving];
    without.parameter(name).is_some_and(|p| claimed.contains(&p.status))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::estimation::{AdoptedChange, ChangeOutcome, OfferCriterion, OfferedTerm, ParameterResult};
    use crate::core::options::Opens;

    const OF_LIFT: &str = "CL_alpha";
    const OF_DRAG: &str = "CD_0";
    const OF_PITCH: &str = "Cm_alpha";

    /// An offer of elevator in CD, with which the values move from 1.0 +- 0.1 to those given.
    fn offer(after: &[(&str, f64)]) -> Offer {
        let effect = |(parameter, after): &(&str, f64)| TermEffect {
            parameter: (*parameter).to_owned(),
            before: Some(1.0),
            before_std: Some(0.1),
            after: *after,
            after_std: 0.1,
        };
        let term = OfferedTerm {
            coefficient: "CD".to_owned(),
            term: "elevator".to_owned(),
            input: None,
            parameter: "CD_elevator".to_owned(),
            value: 0.1,
            std_error: 0.01,
            partial_f: 100.0,
            share: Some(0.1),
            excess: None,
            asked_for: true,
            prior_std: 1.0,
        };
        Offer {
            tried: 1,
            criterion: OfferCriterion { partial_f: 42.0, share: 0.04, excess: 0.1 },
            levels: Vec::new(),
            terms: vec![term],
            effects: after.iter().map(effect).collect(),
            lines: Vec::new(),
            taken: false,
            reference_speed: 100.0,
        }
    }

    fn result(status: FinalStatus, reasons: &[(ReasonCode, EstimationStatus)]) -> Estimation {
        let parameter = |name: &str| ParameterResult { status, ..ParameterResult::for_tests(name) };
        let reason = |(code, status): &(ReasonCode, EstimationStatus)| VerdictReason {
            code: *code,
            status: *status,
            concerns: Vec::new(),
            sentence: String::new(),
        };
        let reasons: Vec<VerdictReason> = reasons.iter().map(reason).collect();
        Estimation {
            parameters: [OF_LIFT, OF_DRAG, OF_PITCH].map(parameter).to_vec(),
            status: reasons.iter().map(|r| r.status).max().unwrap_or_default(),
            reasons,
            ..Estimation::default()
        }
    }

    fn of(estimation: &Estimation, evidence: f64) -> Found<'_> {
        Found { estimation, evidence }
    }

    #[test]
    fn a_term_that_moves_values_stands_before_what_the_motion_says_and_another_behind() {
        let reasons =
            [(ReasonCode::Contradiction, EstimationStatus::Refused), (ReasonCode::Physics, EstimationStatus::Doubtful)];
        let mut refused = result(FinalStatus::InDoubt, &reasons);
        for (reason, sentence) in refused.reasons.iter_mut().zip(["Look for a wrong unit.", "Check the inertia."]) {
            reason.sentence = sentence.to_owned();
        }
        let verdict = ["REFUSED.", "Look for a wrong unit.", "Check the inertia.", "0 of 3 have converged."];
        refused.verdict = verdict.map(str::to_owned).to_vec();
        assert_eq!(place(&refused, &offer(&[(OF_LIFT, 1.5)])), 1);
        assert_eq!(place(&refused, &offer(&[(OF_LIFT, 1.1)])), 3);
        assert_eq!(place(&Estimation { reasons: Vec::new(), ..refused }, &offer(&[(OF_LIFT, 1.5)])), 4);
    }

    #[test]
    fn values_of_other_coefficients_that_move_far_are_in_doubt_and_those_that_stay_are_not() {
        let file = ModelFile::named("hfb320").unwrap();
        assert!([OF_LIFT, OF_DRAG, OF_PITCH].iter().all(|name| file.parameters.iter().any(|p| p.name == *name)));
        let offer = |lift: f64| offer(&[(OF_LIFT, lift), (OF_DRAG, 3.0), (OF_PITCH, 1.05)]);
        let sound = result(FinalStatus::Converged, &[]);
        let found = missing(&offer(1.5), of(&sound, 0.0), Some(of(&sound, 0.0)), &file).unwrap();
        assert_eq!((found.reason.code, found.explains.len()), (ReasonCode::MissingTerm, 0));
        assert_eq!(found.reason.concerns, [OF_LIFT, OF_DRAG]);
        let sentence = &found.reason.sentence;
        assert!(sentence.contains("lacks elevator in CD") && sentence.contains("CL_alpha 1.000 -> 1.500 (5.0 of"));
        assert!(sentence.contains("not in doubt for it: Cm_alpha."), "{sentence}");
        assert!(missing(&offer(1.3), of(&sound, 0.0), Some(of(&sound, 0.0)), &file).is_none());
        // Something speaks against the result with the term too: it shows nothing of the others.
        let doubtful = result(FinalStatus::InDoubt, &[(ReasonCode::Units, EstimationStatus::Doubtful)]);
        let found = missing(&offer(1.5), of(&sound, 0.0), Some(of(&doubtful, 0.0)), &file).unwrap();
        assert_eq!(found.reason.concerns, [OF_LIFT, OF_DRAG, OF_PITCH]);
        assert!(missing(&offer(1.5), of(&result(FinalStatus::NotExcited, &[]), 0.0), None, &file).is_none());
    }

    #[test]
    fn what_the_motion_says_against_a_result_is_explained_by_a_term_with_which_it_says_nothing() {
        let file = ModelFile::named("hfb320").unwrap();
        let offer = offer(&[(OF_LIFT, 1.05), (OF_DRAG, 1.0), (OF_PITCH, 1.2)]);
        let refused = (ReasonCode::Contradiction, EstimationStatus::Refused);
        let first = result(FinalStatus::InDoubt, &[refused]);
        let sound = result(FinalStatus::Converged, &[]);
        let found = missing(&offer, of(&first, 0.0), Some(of(&sound, 0.0)), &file).unwrap();
        assert_eq!(found.explains, [ReasonCode::Contradiction]);
        assert_eq!(found.reason.status, EstimationStatus::Doubtful);
        assert_eq!(found.reason.concerns, [OF_DRAG, OF_PITCH]);
        // Where every value moves the result stays refused.
        let all = self::offer(&[(OF_LIFT, 1.5), (OF_DRAG, 1.0), (OF_PITCH, 1.2)]);
        let found = missing(&all, of(&first, 0.0), Some(of(&sound, 0.0)), &file).unwrap();
        assert_eq!((found.reason.status, found.reason.concerns.len()), (EstimationStatus::Refused, 3));
        // A method without bounds claims no error within which its values would be the same.
        let mut unbounded = self::offer(&[(OF_LIFT, 1.0), (OF_DRAG, 1.0), (OF_PITCH, 1.0)]);
        unbounded.effects.iter_mut().for_each(|effect| effect.before_std = Some(f64::INFINITY));
        let found = missing(&unbounded, of(&first, 0.0), Some(of(&sound, 0.0)), &file).unwrap();
        assert_eq!((found.reason.status, found.reason.concerns.len()), (EstimationStatus::Refused, 3));
        // Neither where the term does not settle it, nor where a sensor is in question.
        assert!(missing(&offer, of(&first, 0.0), Some(of(&first, 0.0)), &file).is_none());
        let sensor = (ReasonCode::SensorError, EstimationStatus::Doubtful);
        let both = result(FinalStatus::InDoubt, &[refused, sensor]);
        assert!(missing(&offer, of(&both, 0.0), Some(of(&sound, 0.0)), &file).is_none());
    }

    #[test]
    fn a_change_is_none_where_there_is_none_with_the_term_and_the_record_is_predicted_better() {
        let file = ModelFile::named("hfb320").unwrap();
        let offer = offer(&[(OF_LIFT, 1.05), (OF_DRAG, 1.0), (OF_PITCH, 1.2)]);
        let sound = result(FinalStatus::Converged, &[]);
        let change = AdoptedChange {
            time_s: 9.0,
            interval_s: None,
            opens: Opens::Everything,
            outcome: ChangeOutcome::Confirmed,
            parameters: Vec::new(),
        };
        let changed = Estimation { changes: vec![change.clone()], ..sound.clone() };
        let found = missing(&offer, of(&changed, 100.0), Some(of(&sound, 150.0)), &file).unwrap();
        assert_eq!(found.explains_changes, [9.0]);
        assert!(found.reason.sentence.contains("adopted at 9.0 s is none"), "{}", found.reason.sentence);
        assert_eq!(found.reason.concerns, [OF_DRAG, OF_PITCH]);
        assert!(missing(&offer, of(&changed, 160.0), Some(of(&sound, 150.0)), &file).is_none());
        assert!(missing(&offer, of(&changed, 100.0), Some(of(&changed, 150.0)), &file).is_none());
        // Two runs do not date a change alike; another one is another one.
        let at = |time_s: f64, interval_s: Option<[f64; 2]>| AdoptedChange { time_s, interval_s, ..change.clone() };
        let with = |changes: Vec<AdoptedChange>| Estimation { changes, ..sound.clone() };
        let both = with(vec![at(9.0, None), at(30.0, Some([26.0, 31.0]))]);
        let one = with(vec![at(23.5, None)]);
        let found = missing(&offer, of(&both, 100.0), Some(of(&one, 150.0)), &file).unwrap();
        assert_eq!(found.explains_changes, [9.0]);
    }
}
