//! What a whole estimation is worth, in words for programs: its status and the reasons for it.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What a result as a whole is worth. The order is that of the severity: the status of a result is the severest that
/// one of its reasons asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EstimationStatus {
    /// Nothing that is checked speaks against the result: the parameters that are called converged can be used. It is
    /// also what is read from results of older versions, which did not have the word.
    #[default]
    Sound,
    /// Nothing speaks against the result, but the flight does not settle it: nothing moved, no parameter converged, or
    /// the record ends while a change is suspected.
    Provisional,
    /// Something is implausible. No parameter is called converged before the user has looked at the reasons; where a term is
    /// missing ([`ReasonCode::MissingTerm`]) and nothing else is wrong, none of those that it bends.
    Doubtful,
    /// The numbers are wrong, or nothing shows that they are right: neither they nor their bounds may be used.
    Refused,
}

impl EstimationStatus {
    /// The word that results and programs use, e.g. `refused`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Sound => "sound",
            Self::Provisional => "provisional",
            Self::Doubtful => "doubtful",
            Self::Refused => "refused",
        }
    }
}

impl fmt::Display for EstimationStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// What kind of reason speaks against a result. The words do not change from version to version; later versions may
/// add some.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReasonCode {
    /// Measurements disagree with the model beyond their noise, where the inputs move the aircraft.
    Contradiction,
    /// A fitted output follows the measurement worse than its mean does.
    FitWorseThanMean,
    /// The attitude of the fitted motion runs away from the measured one, or turns over where the aircraft did not.
    AttitudeUpsideDown,
    /// The residuals of a fit are several times the noise that the model file states, or that the record shows of a vane.
    ResidualsAboveNoise,
    /// The prediction of another record diverges.
    UnstablePrediction,
    /// Most samples of a channel were rejected for a long time.
    ChannelRejected,
    /// The estimator diverged.
    Diverged,
    /// A derivative has the sign that no aeroplane has.
    Sign,
    /// The result contradicts what aeroplanes are like: lift slope, drag, inertia, forces.
    Physics,
    /// Sensors disagree with one another by the kinematics of the flight: a scale, a delay or a bias.
    SensorError,
    /// The recorded position of a surface is too noisy for the derivatives by it.
    InputNoise,
    /// The unit or the sign of a channel is implausible.
    Units,
    /// A channel stands still, or at the ends of its range, while the aircraft moves; or it was smoothed before it was recorded.
    Channel,
    /// Nothing moved above the noise.
    NoExcitation,
    /// The noise levels of the outputs were still being learnt.
    NoiseNotLearnt,
    /// No parameter has converged.
    NotConverged,
    /// A parameter lies at one of its limits.
    AtLimit,
    /// The record ends while a sudden change is suspected.
    ChangeInDoubt,
    /// A term of the model is not the same before and after some time of the flight.
    NotConstant,
    /// A method of another kind gives another value: equation error beside a filter, output error or filter error, SMPE beside
    /// equation error.
    MethodsDisagree,
    /// A term is missing: with it the motion no longer contradicts the model, or values of other coefficients than its own move
    /// far beyond their errors. Only the parameters that the reason concerns are in doubt: the others are the same with the term
    /// and without it.
    MissingTerm,
    /// A reason that this version does not know.
    #[serde(other)]
    Other,
}

impl ReasonCode {
    /// The word that results and programs use, e.g. `fit-worse-than-mean`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Contradiction => "contradiction",
            Self::FitWorseThanMean => "fit-worse-than-mean",
            Self::AttitudeUpsideDown => "attitude-upside-down",
            Self::ResidualsAboveNoise => "residuals-above-noise",
            Self::UnstablePrediction => "unstable-prediction",
            Self::ChannelRejected => "channel-rejected",
            Self::Diverged => "diverged",
            Self::Sign => "sign",
            Self::Physics => "physics",
            Self::SensorError => "sensor-error",
            Self::InputNoise => "input-noise",
            Self::Units => "units",
            Self::Channel => "channel",
            Self::NoExcitation => "no-excitation",
            Self::NoiseNotLearnt => "noise-not-learnt",
            Self::NotConverged => "not-converged",
            Self::AtLimit => "at-limit",
            Self::ChangeInDoubt => "change-in-doubt",
            Self::NotConstant => "not-constant",
            Self::MethodsDisagree => "methods-disagree",
            Self::MissingTerm => "missing-term",
            Self::Other => "other",
        }
    }

    /// What the reason says in a few words, as a clause for a headline.
    pub const fn clause(self) -> &'static str {
        match self {
            Self::Contradiction => "the model contradicts this flight",
            Self::FitWorseThanMean => "the fit is worse than a constant",
            Self::AttitudeUpsideDown => "the attitude of the fitted motion runs away",
            Self::ResidualsAboveNoise => "the residuals are several times the noise",
            Self::UnstablePrediction => "the prediction diverges",
            Self::ChannelRejected => "most samples of a channel were rejected",
            Self::Diverged => "the estimator diverged",
            Self::Sign => "a derivative has an impossible sign",
            Self::Physics => "the numbers contradict what aeroplanes are like",
            Self::SensorError => "the sensors disagree with one another",
            Self::InputNoise => "a surface is recorded with much noise",
            Self::Units => "a unit or sign is implausible",
            Self::Channel => "a channel is stuck, saturated, smoothed or slow",
            Self::NoExcitation => "nothing moved",
            Self::NoiseNotLearnt => "the noise levels are not yet known",
            Self::NotConverged => "no parameter has converged",
            Self::AtLimit => "a parameter lies at its limit",
            Self::ChangeInDoubt => "a change is suspected at the end",
            Self::NotConstant => "the aircraft changes during the flight",
            Self::MethodsDisagree => "another method gives another value",
            Self::MissingTerm => "the model lacks a term",
            Self::Other => "see the reasons",
        }
    }
}

impl fmt::Display for ReasonCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// One reason why a result is not sound.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct VerdictReason {
    /// What kind of reason it is.
    pub code: ReasonCode,
    /// The status that it asks for; never [`EstimationStatus::Sound`].
    pub status: EstimationStatus,
    /// The outputs, parameters, channels or keys of the model file that it is about, by name, e.g. `alpha`,
    /// `Cm_elevator` or `[aircraft] mass`; empty where it is about the whole flight.
    pub concerns: Vec<String>,
    /// What was found and what to do, in sentences.
    pub sentence: String,
}

impl VerdictReason {
    /// Whether it is a reason against the result, and not only one to wait: refused or doubtful.
    pub fn is_against(&self) -> bool {
        self.status >= EstimationStatus::Doubtful
    }

    /// Whether it is a reason against a parameter: a missing term is one against those that it concerns, any other that
    /// is one against the result against all.
    pub fn puts_in_doubt(&self, parameter: &str) -> bool {
        let is_of_all = self.code != ReasonCode::MissingTerm;
        self.is_against() && (is_of_all || self.concerns.iter().any(|name| name == parameter))
    }
}

/// The severest status that the reasons ask for; [`EstimationStatus::Sound`] without one.
pub fn status_of(reasons: &[VerdictReason]) -> EstimationStatus {
    reasons.iter().map(|reason| reason.status).max().unwrap_or_default()
}

/// Whether a result is doubtful in part: nothing but a missing term speaks against it, and only the parameters that this concerns are
/// in doubt. Of a refused result, and of one that nothing speaks against, it is false.
///
/// ```
/// use phugoid_identification::estimation::{EstimationStatus, ReasonCode, VerdictReason, is_in_part};
/// let reason = VerdictReason {
///     code: ReasonCode::MissingTerm,
///     status: EstimationStatus::Doubtful,
///     concerns: vec!["CD_0".to_owned()],
///     sentence: "The model lacks elevator in CD.".to_owned(),
/// };
/// assert!(reason.puts_in_doubt("CD_0") && !reason.puts_in_doubt("CL_alpha"));
/// assert!(is_in_part(std::slice::from_ref(&reason)) && !is_in_part(&[]));
/// assert!(!is_in_part(&[VerdictReason { status: EstimationStatus::Refused, ..reason }]));
/// ```
pub fn is_in_part(reasons: &[VerdictReason]) -> bool {
    let is_of_a_term = |reason: &VerdictReason| reason.code == ReasonCode::MissingTerm;
    status_of(reasons) == EstimationStatus::Doubtful && reasons.iter().filter(|r| r.is_against()).all(is_of_a_term)
}

/// The first sentence of the verdict on a refused or doubtful result; `None` for others.
///
/// ```
/// use phugoid_identification::estimation::{EstimationStatus, ReasonCode, VerdictReason, headline};
/// let reason = VerdictReason {
///     code: ReasonCode::Contradiction,
///     status: EstimationStatus::Refused,
///     concerns: vec!["alpha".to_owned()],
///     sentence: "More than six sigmas away are 12 % of alpha.".to_owned(),
/// };
/// let first = headline(&[reason]).ok_or("no headline")?;
/// assert!(first.starts_with("REFUSED: the model contradicts this flight."));
/// assert_eq!(headline(&[]), None);
/// # Ok::<(), &str>(())
/// ```
pub fn headline(reasons: &[VerdictReason]) -> Option<String> {
    let status = status_of(reasons);
    let (word, advice) = match status {
        EstimationStatus::Refused => ("REFUSED", "Use neither these numbers nor their bounds."),
        EstimationStatus::Doubtful if is_in_part(reasons) => {
            ("DOUBTFUL", "Use at most what is called converged, or estimate with the term.")
        }
        EstimationStatus::Doubtful => {
            ("DOUBTFUL", "Settle what is named below before you use these numbers or their bounds.")
        }
        EstimationStatus::Sound | EstimationStatus::Provisional => return None,
    };
    let mut clauses: Vec<&str> = Vec::new();
    for reason in reasons.iter().filter(|reason| reason.status == status) {
        if !clauses.contains(&reason.code.clause()) {
            clauses.push(reason.code.clause());
        }
    }
    Some(format!("{word}: {}. {advice}", clauses.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reason(code: ReasonCode, status: EstimationStatus) -> VerdictReason {
        VerdictReason { code, status, concerns: Vec::new(), sentence: String::new() }
    }

    #[test]
    fn the_severest_reason_decides_and_speaks_first() {
        let doubt = reason(ReasonCode::Sign, EstimationStatus::Doubtful);
        let wait = reason(ReasonCode::NotConverged, EstimationStatus::Provisional);
        let refusal = reason(ReasonCode::Diverged, EstimationStatus::Refused);
        assert_eq!(status_of(&[]), EstimationStatus::Sound);
        assert_eq!(status_of(&[wait.clone(), doubt.clone()]), EstimationStatus::Doubtful);
        assert_eq!(headline(std::slice::from_ref(&wait)), None);
        let first = headline(&[wait, doubt, refusal.clone(), refusal]).unwrap();
        assert_eq!(first, "REFUSED: the estimator diverged. Use neither these numbers nor their bounds.");
    }

    /// The words that results and other programs know: they do not change with the names in the code.
    #[test]
    fn the_words_are_those_of_json() {
        for status in [
            EstimationStatus::Sound,
            EstimationStatus::Provisional,
            EstimationStatus::Doubtful,
            EstimationStatus::Refused,
        ] {
            assert_eq!(serde_json::to_string(&status).unwrap(), format!("\"{status}\""));
        }
        for code in [
            ReasonCode::Contradiction,
            ReasonCode::FitWorseThanMean,
            ReasonCode::AttitudeUpsideDown,
            ReasonCode::ResidualsAboveNoise,
            ReasonCode::UnstablePrediction,
            ReasonCode::ChannelRejected,
            ReasonCode::Diverged,
            ReasonCode::Sign,
            ReasonCode::Physics,
            ReasonCode::Units,
            ReasonCode::Channel,
            ReasonCode::NoExcitation,
            ReasonCode::NotConverged,
            ReasonCode::AtLimit,
            ReasonCode::ChangeInDoubt,
            ReasonCode::NotConstant,
            ReasonCode::MethodsDisagree,
            ReasonCode::MissingTerm,
        ] {
            assert_eq!(serde_json::to_string(&code).unwrap(), format!("\"{code}\""));
        }
        assert_eq!(serde_json::from_str::<ReasonCode>("\"of-a-later-version\"").unwrap(), ReasonCode::Other);
    }
}
