//! The thesis's law and the model-reference law on case files.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::laws::ThesisForm;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::flight_law;
use super::plant_law;
use super::plant_law::Law;
use super::rule;
use super::rule::Expected;
use crate::aircraft_case::{AircraftCase, ParameterSettings, fly};
use crate::case_file::Case;
use crate::plant_case::{PlantCase, PlantRun, simulate};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::tune::objective::{Score, Trace, score};
use phugoid_evaluation::tune::setting::{Range, Setting};
use phugoid_evaluation::tune::state::fingerprint;
use phugoid_evaluation::tune::{HELD_OUT_RUNS, Part, RunName, Tunable};
use phugoid_simulation::flight::Flight;

/// A case with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCase {
    /// Id of a built-in case, or the path of its file.
    pub name: String,
    /// The case on which the law is tuned.
    pub case: Case,
    /// Fingerprint of the case: it differs if the case has been changed, wherever its file lies.
    pub fingerprint: String,
}

impl NamedCase {
    /// A case under a name.
    pub fn new(name: &str, case: Case) -> Self {
        // Of what it says, wherever the file lies.
        let mut said = case.clone();
        if let Case::Aircraft(case) = &mut said {
            case.scenario.folder = PathBuf::new();
        }
        Self { name: name.to_owned(), fingerprint: fingerprint(&format!("{said:?}")), case }
    }
}

/// The laws of this crate that can be tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseMethod {
    /// The one-parameter sliding law of the thesis, on plants and flights with one unknown.
    ThesisLaw,
    /// The model-reference law, state-error form, on plants.
    ModelReference,
}

/// A law with cases to tune on and cases to judge by.
pub struct CaseTuning {
    method: CaseMethod,
    settings: Vec<Setting>,
    training: Runs,
    held_out: Runs,
}

#[derive(Default)]
struct Runs {
    /// Fingerprints of the cases.
    sources: BTreeMap<String, String>,
    names: Vec<RunName>,
    runs: Vec<Run>,
}

/// A case that has been run, with what the rule is told of it.
struct Run {
    material: Material,
    expected: Expected,
}

enum Material {
    Plant(Box<(PlantCase, PlantRun)>),
    Flight(Box<(AircraftCase, Flight, (&'static str, ParameterSettings))>),
}

/// Forms of the thesis's law in the order of the words of the setting `form`.
const FORMS: [ThesisForm; 3] = [ThesisForm::Damped, ThesisForm::Reduced, ThesisForm::Printed];

impl CaseTuning {
    /// Runs every case `runs` times for each part. The first training run of a case is as its file says; in all others the
    /// truth is drawn within the bounds (of a flight: up to twice or half as large), and the noise, if there is any, is
    /// another. `done` is called after each.
    ///
    /// # Errors
    /// [`StudyError`]: a case cannot be run, or the law cannot carry its parameters.
    pub fn new(
        method: CaseMethod,
        training: &[NamedCase],
        held_out: &[NamedCase],
        runs: usize,
        done: &(dyn Fn() + Sync),
    ) -> Result<Self, StudyError> {
        Ok(Self {
            method,
            settings: settings(method),
            training: run_all(method, training, runs, 0, done)?,
            held_out: run_all(method, held_out, runs, HELD_OUT_RUNS, done)?,
        })
    }

    fn part(&self, part: Part) -> &Runs {
        match part {
            Part::Training => &self.training,
            Part::HeldOut => &self.held_out,
        }
    }

    /// The law that the values of the settings give in one case, by the rule of that case.
    fn law(&self, values: &[f64], expected: &Expected) -> Law {
        let value = |k: usize| values.get(k).copied().unwrap_or(1.0);
        match self.method {
            CaseMethod::ThesisLaw => {
                let [lambda, eta] = rule::thesis_law(expected);
                Law::Thesis { form: FORMS[(value(2) as usize).min(2)], lambda: value(0) * lambda, eta: value(1) * eta }
            }
            CaseMethod::ModelReference => {
                let [gain, decay] = rule::model_reference(expected);
                let normalised = (value(2) >= 1.0).then_some(expected.regressor.powi(2));
                Law::ModelReference { gain: value(0) * gain, decay: value(1) * decay, normalised }
            }
        }
    }

    /// Scores a run with the printed form and the `lambda` and `eta` of the case file: the settings that were published, as
    /// far as they are known. None for the model-reference law, of which nothing was published.
    pub fn score_as_published(&self, part: Part, run: usize) -> Option<Score> {
        let run = self.part(part).runs.get(run)?;
        let (lambda, eta) = match (self.method, &run.material) {
            (CaseMethod::ModelReference, _) => return None,
            (_, Material::Plant(plant)) => (plant.0.unknowns().next()?.1.lambda, plant.0.estimator.eta),
            (_, Material::Flight(flight)) => (flight.2.1.lambda, flight.2.1.scaled_eta),
        };
        Some(run.score(Law::Thesis { form: ThesisForm::Printed, lambda, eta }))
    }
}

fn settings(method: CaseMethod) -> Vec<Setting> {
    let factor = |name, meaning, [lower, upper]: [f64; 2], origin| Setting {
        name,
        unit: "-",
        meaning,
        range: Range::Logarithmic { lower, upper },
        rule: 1.0,
        origin,
    };
    let choice = |name, meaning, words: &[&'static str], origin| Setting {
        name,
        unit: "-",
        meaning,
        range: Range::Choice { words: words.to_vec() },
        rule: 0.0,
        origin,
    };
    match method {
        CaseMethod::ThesisLaw => vec![
            factor(
                "lambda_scale",
                "factor on lambda by rule",
                [1e-3, 1.0],
                "lambda h = 0.5, half of where it overshoots; with noise x'/x, where lambda E is as noisy as D",
            ),
            factor(
                "eta_scale",
                "factor on eta by rule",
                [1e-4, 1e2],
                "noise may leave 1.25 % of the nominal parameter; at least a tenth of the median |z|",
            ),
            choice(
                "form",
                "form of the law",
                &["damped", "reduced", "printed"],
                "the damped form has no bias by eta (docs/theory.md section 10)",
            ),
        ],
        CaseMethod::ModelReference => vec![
            factor(
                "gain_scale",
                "factor on the gain by rule",
                [1e-3, 1e2],
                "critical damping, g = k^2/(4 |Phi R|^2), inside the stability limit g h |Phi R|^2 <= 2 k",
            ),
            factor(
                "decay_scale",
                "factor on the decay k of the state error by rule",
                [1e-2, 4.0],
                "k h = 1, an eighth of the limit; with noise so slow that it leaves 1.25 % of the nominal parameter",
            ),
            choice(
                "normalisation",
                "division by the regressor",
                &["plain", "normalised"],
                "plain: the gain is sized already",
            ),
        ],
    }
}

impl Run {
    fn new(method: CaseMethod, named: &NamedCase, run: u64) -> Result<Self, StudyError> {
        match (&named.case, method) {
            (Case::Plant(case), _) => {
                if method == CaseMethod::ThesisLaw && case.parameters.len() > 1 {
                    return Err(StudyError::Unsuitable(format!(
                        "{}: the thesis's law carries one parameter, this plant has {}",
                        named.name,
                        case.parameters.len()
                    )));
                }
                let expected = plant_law::expected(case)?;
                let (case, samples) = plant_variant(case, run)?;
                Ok(Self { material: Material::Plant(Box::new((case, samples))), expected })
            }
            (Case::Aircraft(case), CaseMethod::ThesisLaw) => {
                let unknown = flight_law::unknown(case, &named.name)?;
                let expected = flight_law::expected(case, unknown)?;
                let case = flight_variant(case, unknown, run);
                let flight = fly(&case)?;
                Ok(Self { material: Material::Flight(Box::new((case, flight, unknown))), expected })
            }
            (Case::Comparison(_), _) => Err(StudyError::Unsuitable(format!(
                "{}: a comparison of methods has settings of its own and is not tuned on",
                named.name
            ))),
            (Case::Aircraft(_), CaseMethod::ModelReference) => Err(StudyError::Unsuitable(format!(
                "{}: the model-reference law is tuned on plants, this is a flight",
                named.name
            ))),
        }
    }

    fn score(&self, law: Law) -> Score {
        let traced = |truth: f64, values: Vec<f64>| Trace { truth, values, std_errors: None };
        match (&self.material, law) {
            (Material::Plant(plant), law) => {
                let (case, run) = plant.as_ref();
                let Some(estimates) = plant_law::run(case, run, law) else { return Score::FAILURE };
                let truths = case.unknowns().map(|(_, parameter)| parameter.truth);
                let traces: Vec<Trace> = truths.zip(estimates).map(|(truth, values)| traced(truth, values)).collect();
                let acts = run.inputs.iter().position(|u| u.iter().any(|v| *v != 0.0)).unwrap_or(0);
                score(&run.time_s, &traces, run.time_s.get(acts).copied().unwrap_or(0.0))
            }
            (Material::Flight(material), Law::Thesis { form, lambda, eta }) => {
                let (case, flight, unknown) = material.as_ref();
                let Some(run) = flight_law::run(case, flight, *unknown, [lambda, eta], form) else {
                    return Score::FAILURE;
                };
                let Some(estimated) = run.parameters.into_iter().next() else { return Score::FAILURE };
                let elevator = flight.truth.channel("elevator").map(|c| c.values.as_slice()).unwrap_or_default();
                let moved = elevator.iter().position(|e| (e - elevator[0]).abs() > 1e-12).unwrap_or(0);
                let from = flight.truth.time.get(moved).copied().unwrap_or(0.0);
                score(&run.time_s, &[traced(case.truth(unknown.0), estimated.values)], from)
            }
            (Material::Flight(_), Law::ModelReference { .. }) => Score::FAILURE,
        }
    }
}

fn run_all(
    method: CaseMethod,
    cases: &[NamedCase],
    runs: usize,
    first: u64,
    done: &(dyn Fn() + Sync),
) -> Result<Runs, StudyError> {
    let names: Vec<RunName> = cases
        .iter()
        .flat_map(|c| (0..runs as u64).map(|run| RunName { scenario: c.name.clone(), run: first + run }))
        .collect();
    let runs = monte_carlo(names.len(), |k| Run::new(method, &cases[k / runs.max(1)], names[k].run), done)?;
    let sources = cases.iter().map(|c| (format!("case {}", c.name), c.fingerprint.clone())).collect();
    Ok(Runs { sources, names, runs })
}

fn random(seed: u64, run: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed ^ run.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// The case of a run: its noise of another seed, and from the second run on another truth, spread evenly over the logarithm
/// of the bounds. A truth with which the plant escapes is drawn again.
fn plant_variant(case: &PlantCase, run: u64) -> Result<(PlantCase, PlantRun), StudyError> {
    /// Draws until a truth is found with which the record is finite.
    const DRAWS: usize = 20;
    if run == 0 {
        return Ok((case.clone(), simulate(case)?));
    }
    let mut random = random(case.seed, run);
    let mut variant = PlantCase { seed: case.seed.wrapping_add(run), ..case.clone() };
    for _ in 0..DRAWS {
        for parameter in variant.parameters.values_mut() {
            parameter.truth = parameter.lower * (parameter.upper / parameter.lower).powf(random.random::<f64>());
        }
        if let Ok(samples) = simulate(&variant) {
            return Ok((variant, samples));
        }
    }
    Err(StudyError::Unsuitable(format!(
        "{}: with {DRAWS} truths drawn within the bounds the plant escaped each time: shorten the record",
        case.title
    )))
}

fn flight_variant(case: &AircraftCase, (name, told): (&str, ParameterSettings), run: u64) -> AircraftCase {
    let mut case = case.clone();
    if run > 0 {
        let factor = (random(case.scenario.seed, run).random::<f64>() * 2.0 - 1.0).exp2();
        let truth = (case.truth(name) * factor).clamp(told.lower, told.upper);
        if let Some(increment) = case.scenario.increments.longitudinal_mut(name) {
            *increment = truth;
        }
        case.scenario.seed = case.scenario.seed.wrapping_add(run);
    }
    case
}

impl Tunable for CaseTuning {
    fn method(&self) -> &'static str {
        match self.method {
            CaseMethod::ThesisLaw => "thesis-law",
            CaseMethod::ModelReference => "model-reference",
        }
    }

    fn settings(&self) -> &[Setting] {
        &self.settings
    }

    fn runs(&self, part: Part) -> &[RunName] {
        &self.part(part).names
    }

    fn score(&self, values: &[f64], part: Part, run: usize) -> Score {
        self.part(part).runs.get(run).map_or(Score::FAILURE, |run| run.score(self.law(values, &run.expected)))
    }

    fn sources(&self, part: Part) -> BTreeMap<String, String> {
        self.part(part).sources.clone()
    }

    fn settings_file(&self, values: &[f64]) -> String {
        let mut text = format!(
            "# Settings written by `phugoid tune {}`: factors on the rules of docs/tuning.md, then what they come to in each\n\
             # case that was tuned on.\n[rule]\n",
            self.method()
        );
        for (setting, value) in self.settings.iter().zip(values) {
            text.push_str(&format!("{} = {}  # {}\n", setting.name, setting.in_toml(*value), setting.meaning));
        }
        for (name, run) in self.training.names.iter().zip(&self.training.runs).filter(|(name, _)| name.run == 0) {
            text.push_str(&format!("\n[[case]]\nname = {:?}\n", name.scenario));
            text.push_str(&match self.law(values, &run.expected) {
                Law::Thesis { lambda, eta, .. } => format!("lambda = {lambda:?}  # 1/s\neta = {eta:?}\n"),
                Law::ModelReference { gain, decay, .. } => format!("gain = {gain:?}\nerror_decay = {decay:?}  # 1/s\n"),
            });
        }
        text
    }
}
