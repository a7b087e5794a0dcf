//! Whether what a batch method found is a fit at all: a minimum of its cost may lie where the aircraft tumbles.

use crate::batch::OutputFit;
use crate::core::estimation::{BatchReport, EstimationStatus, History, Prediction, ReasonCode, Signal, VerdictReason};
use crate::core::method::Method;
use crate::core::output::Output;
use crate::model_file::ModelFile;

/// Attitudes of which the difference to the measured ones is looked at modulo a turn.
const ATTITUDES: [&str; 2] = ["theta", "phi"];
/// A fitted attitude further than this from the measured one has run away, rad: an aircraft that flies at 30 deg of
/// bank where the record says level is another flight.
const RUN_AWAY: f64 = std::f64::consts::FRAC_PI_6;
/// Below this coefficient of determination a fit is refused: its error is larger than the motion.
const WORSE_THAN_MOTION: f64 = -1.0;
/// A residual this many times the stated noise is not noise.
const ABOVE_NOISE: f64 = 3.0;
/// Below this coefficient of determination a prediction diverges: its error is ten times the motion.
const DIVERGES: f64 = -100.0;

/// What speaks against the fit of a batch method, and against its prediction of another record. `vanes` is the noise that the
/// record itself shows of each output that is a flow angle (one sigma, rad); none for the others.
pub(crate) fn reasons(
    method: Method,
    file: &ModelFile,
    history: &History,
    report: &BatchReport,
    vanes: &[Option<f64>],
) -> Vec<VerdictReason> {
    let mut found = Vec::new();
    let run_away = run_away(&history.measured, &history.predicted);
    if let Some((name, angle)) = run_away {
        found.push(VerdictReason {
            code: ReasonCode::AttitudeUpsideDown,
            status: EstimationStatus::Refused,
            concerns: vec![name.to_owned()],
            sentence: format!(
                "The fitted {name} runs {:.0} deg away from the measured one: the minimum that was found is not this \
                 flight. Start from values nearer to the answer (equation-error gives some), fit one manoeuvre, or take \
                 filter-error.",
                angle.to_degrees()
            ),
        });
    }
    found.extend(worse_than_mean(report, &history.measured, &history.predicted));
    if matches!(method, Method::OutputError | Method::OutputErrorFrequency) {
        found.extend(above_noise(file, report, vanes));
    }
    found.extend(report.prediction.as_ref().and_then(unstable));
    found
}

/// The smallest difference of two angles, rad.
fn turned(measured: f64, fitted: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    (fitted - measured + 0.5 * turn).rem_euclid(turn) - 0.5 * turn
}

fn pairs<'a>(measured: &'a [Signal], fitted: &'a [Signal]) -> impl Iterator<Item = (&'a Signal, &'a Signal)> {
    measured.iter().filter_map(|m| Some((m, fitted.iter().find(|f| f.name == m.name)?)))
}

/// The attitude that differs most from the measured one, and by how much (rad), if that is too much.
fn run_away<'a>(measured: &'a [Signal], fitted: &'a [Signal]) -> Option<(&'a str, f64)> {
    let most = |(m, f): (&'a Signal, &'a Signal)| {
        let distance = m.values.iter().zip(&f.values).map(|(m, f)| turned(*m, *f).abs());
        (m.name.as_str(), distance.filter(|d| d.is_finite()).fold(0.0, f64::max))
    };
    let attitudes = pairs(measured, fitted).filter(|(m, _)| ATTITUDES.contains(&m.name.as_str()));
    attitudes.map(most).filter(|(_, most)| *most > RUN_AWAY).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The fits that are worse than a constant. Of airspeed and forward acceleration, which wind and engine move as well as
/// the manoeuvre, only those whose error is larger than their motion.
fn worse_than_mean(report: &BatchReport, measured: &[Signal], fitted: &[Signal]) -> Option<VerdictReason> {
    // Attitudes of the record itself are compared modulo a turn; of further records only the fit is known.
    // What a simulation does below the band is not what a method in the band fits.
    let own = if report.band.is_some() { &[] } else { measured };
    let own = pairs(own, fitted).filter(|(m, _)| ATTITUDES.contains(&m.name.as_str())).filter_map(|(m, f)| {
        let near: Vec<f64> = m.values.iter().zip(&f.values).map(|(m, f)| m + turned(*m, *f)).collect();
        OutputFit::of(&m.name, &m.values, &near)
    });
    let attitudes: Vec<(String, f64)> = own.map(|fit| (fit.name, fit.r_squared)).collect();
    let others = report
        .manoeuvres
        .iter()
        .flat_map(|(_, fits)| fits)
        .filter(|f| report.band.is_some() || !ATTITUDES.contains(&f.name.as_str()));
    let every = others.map(|fit| (fit.name.clone(), fit.r_squared)).chain(attitudes);
    let drifts = |name: &str| [Output::TrueAirspeed, Output::Ax].iter().any(|output| output.name() == name);
    let poor: Vec<(String, f64)> =
        every.filter(|(name, r2)| *r2 < if drifts(name) { WORSE_THAN_MOTION } else { 0.0 }).collect();
    let worst = poor.iter().map(|(_, r2)| *r2).fold(0.0, f64::min);
    (!poor.is_empty()).then(|| VerdictReason {
        code: ReasonCode::FitWorseThanMean,
        status: if worst < WORSE_THAN_MOTION { EstimationStatus::Refused } else { EstimationStatus::Doubtful },
        concerns: poor.iter().map(|(name, _)| name.clone()).collect(),
        sentence: format!(
            "A constant would fit better than the model: R^2 is {}. Look for a wrong unit, sign or time, a term that is \
             missing, or a minimum far from the flight: begin with equation-error and one manoeuvre.",
            poor.iter().map(|(name, r2)| format!("{r2:.2} for {name}")).collect::<Vec<_>>().join(", ")
        ),
    })
}

/// Outputs whose residuals are several times the noise that the model file states, or, of a vane without any, that the record shows.
fn above_noise(file: &ModelFile, report: &BatchReport, vanes: &[Option<f64>]) -> Option<VerdictReason> {
    let ratio = |(row, output): (usize, &Output)| {
        let noise = file.noise[output.index()].or(vanes.get(row).copied().flatten())?;
        let ratio = report.noise_std.get(row)? / noise;
        (ratio >= ABOVE_NOISE).then(|| (output.name(), ratio))
    };
    let found: Vec<(&str, f64)> = file.axes.outputs().iter().enumerate().filter_map(ratio).collect();
    (!found.is_empty()).then(|| VerdictReason {
        code: ReasonCode::ResidualsAboveNoise,
        status: EstimationStatus::Doubtful,
        concerns: found.iter().map(|(name, _)| (*name).to_owned()).collect(),
        sentence: format!(
            "The residuals are above the noise that [noise] states or the record shows: {}. The rest is turbulence or model \
             error, which output error does not allow for: take filter-error, add the missing terms, or correct [noise].",
            found.iter().map(|(name, ratio)| format!("{name} {ratio:.1} times")).collect::<Vec<_>>().join(", ")
        ),
    })
}

/// A prediction that leaves the flight.
fn unstable(prediction: &Prediction) -> Option<VerdictReason> {
    let run_away = run_away(&prediction.measured, &prediction.predicted).map(|(name, _)| name.to_owned());
    let far = prediction.fit.iter().filter(|f| !ATTITUDES.contains(&f.name.as_str()));
    let far = far.filter(|f| f.r_squared < DIVERGES).map(|f| f.name.clone());
    let lost = prediction.predicted.iter().filter(|s| s.values.iter().any(|v| !v.is_finite())).map(|s| s.name.clone());
    let mut concerns: Vec<String> = Vec::new();
    for name in run_away.into_iter().chain(far).chain(lost) {
        if !concerns.contains(&name) {
            concerns.push(name);
        }
    }
    (!concerns.is_empty()).then(|| VerdictReason {
        code: ReasonCode::UnstablePrediction,
        status: EstimationStatus::Doubtful,
        sentence: format!(
            "The prediction of {} diverges in {}: with these numbers the model leaves the flight. Compare the conditions of \
             the two records (speed, mass, centre of gravity), and look at the derivatives that decide on stability.",
            prediction.source,
            concerns.join(", ")
        ),
        concerns,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 200;

    fn wave(amplitude: f64) -> Vec<f64> {
        (0..SAMPLES).map(|k| amplitude * (0.1 * k as f64).sin()).collect()
    }

    fn signal(name: &str, values: Vec<f64>) -> Signal {
        Signal { name: name.to_owned(), unit: "rad".to_owned(), values }
    }

    fn report(fits: Vec<OutputFit>) -> BatchReport {
        BatchReport {
            iterations: 3,
            cost: 0.0,
            noise_std: vec![1e-3; 7],
            unknowns: Vec::new(),
            manoeuvres: vec![("the record".to_owned(), fits)],
            equations: Vec::new(),
            band: None,
            measured_angles: false,
            prediction: None,
            notes: Vec::new(),
        }
    }

    fn judged(method: Method, name: &str, fitted: Vec<f64>) -> Vec<VerdictReason> {
        let (measured, fitted) = (signal(name, wave(0.1)), signal(name, fitted));
        let fits = OutputFit::of(name, &measured.values, &fitted.values).into_iter().collect();
        let history = History { measured: vec![measured], predicted: vec![fitted], ..History::default() };
        reasons(method, &ModelFile::named("hfb320").unwrap(), &history, &report(fits), &[])
    }

    #[test]
    fn an_attitude_that_runs_away_is_refused_and_a_whole_turn_is_none() {
        let drift = wave(0.1).iter().enumerate().map(|(k, v)| v + 0.02 * k as f64).collect();
        let found = judged(Method::FilterError, "theta", drift);
        assert_eq!((found[0].code, found[0].status), (ReasonCode::AttitudeUpsideDown, EstimationStatus::Refused));
        assert_eq!(found[0].concerns, ["theta"]);
        let turn = wave(0.1).iter().map(|v| v - std::f64::consts::TAU).collect();
        assert_eq!(judged(Method::FilterError, "theta", turn), []);
    }

    #[test]
    fn a_fit_worse_than_its_mean_is_doubtful_and_one_worse_than_its_motion_refused() {
        assert_eq!(judged(Method::FilterError, "q", wave(0.05)), []);
        // R^2 = 1 - 1.44 with the sign reversed and a fifth of the amplitude, 1 - 4 with all of it.
        let found = judged(Method::FilterError, "q", wave(-0.02));
        assert_eq!((found[0].code, found[0].status), (ReasonCode::FitWorseThanMean, EstimationStatus::Doubtful));
        let found = judged(Method::FilterError, "q", wave(-0.1));
        assert_eq!((found[0].code, found[0].status), (ReasonCode::FitWorseThanMean, EstimationStatus::Refused));
        // Wind moves the airspeed as well.
        assert_eq!(judged(Method::FilterError, "true_airspeed", wave(-0.02)), []);
        assert_eq!(judged(Method::FilterError, "true_airspeed", wave(-0.1))[0].status, EstimationStatus::Refused);
    }

    #[test]
    fn residuals_are_held_against_stated_noise_and_those_of_a_vane_against_its_own() {
        let mut file = ModelFile::named("hfb320").unwrap();
        file.noise = [None; crate::core::output::CHANNELS];
        let empty = History::default();
        assert_eq!(reasons(Method::OutputError, &file, &empty, &report(Vec::new()), &[]), []);
        file.noise[Output::PitchRate.index()] = Some(0.4e-3);
        assert_eq!(reasons(Method::OutputError, &file, &empty, &report(Vec::new()), &[]), []);
        file.noise[Output::Alpha.index()] = Some(0.25e-3);
        let found = reasons(Method::OutputError, &file, &empty, &report(Vec::new()), &[]);
        assert_eq!((found[0].code, found[0].status), (ReasonCode::ResidualsAboveNoise, EstimationStatus::Doubtful));
        assert!(found[0].sentence.contains("alpha 4.0 times"), "{}", found[0].sentence);
        // What a vane shows by itself serves where nothing is stated, and what is stated goes before it.
        file.noise[Output::Alpha.index()] = None;
        let vanes = |noise: f64| [None, Some(noise), None, None, None, None];
        let of_vane =
            |file: &ModelFile, noise| reasons(Method::OutputError, file, &empty, &report(Vec::new()), &vanes(noise));
        assert_eq!(of_vane(&file, 0.4e-3), []);
        assert!(of_vane(&file, 0.2e-3)[0].sentence.contains("alpha 5.0 times"));
        file.noise[Output::Alpha.index()] = Some(0.4e-3);
        assert_eq!(of_vane(&file, 0.2e-3), []);
        file.noise[Output::Alpha.index()] = Some(0.25e-3);
        // Filter error has the process noise for that.
        assert_eq!(reasons(Method::FilterError, &file, &empty, &report(Vec::new()), &[]), []);
    }

    #[test]
    fn a_prediction_that_tumbles_or_leaves_the_numbers_is_unstable() {
        let predicted = |values: Vec<f64>| {
            let measured = wave(0.1);
            let fit = OutputFit::of("q", &measured, &values).into_iter().collect();
            let prediction = Prediction {
                source: "another.csv".to_owned(),
                fit,
                time_s: Vec::new(),
                measured: vec![signal("q", measured)],
                predicted: vec![signal("q", values)],
                intervals: Vec::new(),
            };
            unstable(&prediction)
        };
        assert_eq!(predicted(wave(0.12)), None);
        assert_eq!(predicted(wave(3.0)).unwrap().code, ReasonCode::UnstablePrediction);
        let mut lost = wave(0.1);
        lost[SAMPLES - 1] = f64::NAN;
        assert!(predicted(lost).unwrap().sentence.contains("another.csv"));
    }
}
