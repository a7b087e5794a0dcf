//! Made-up estimations for tests and the gallery. Nothing here is measured or estimated: shapes only resemble a flight.

use phugoid_flight_data::quality::{ChannelQuality, Finding, QualityReport, Severity};
use phugoid_identification::estimation::{
    Estimation, EstimationStatus, Event, EventKind, FinalStatus, History, ModelLine, Offer, OfferCriterion,
    OfferedTerm, ParameterHistory, ParameterReadiness, ParameterResult, Phase, Readiness, ResidualLevel, Signal,
    TermEffect,
};
use phugoid_identification::method::Method;

/// What to make up.
pub(crate) struct Case {
    pub(crate) source: &'static str,
    pub(crate) seconds: f64,
    pub(crate) rate_hz: f64,
    /// Name, final value.
    pub(crate) parameters: Vec<(String, f64)>,
    pub(crate) truth_known: bool,
    pub(crate) missing: bool,
}

/// 20 s at 100 Hz, four increments and two biases, truth known.
pub(crate) fn fighter() -> Case {
    let parameters = [
        ("dCm_alpha", -0.2),
        ("dCm_q", -2.0),
        ("dCL_alpha", 0.4),
        ("dCD_alpha", 0.1),
        ("offset_Cm", 0.0011),
        ("bias_alpha", 0.0034),
    ];
    Case {
        source: "f16-short-period",
        seconds: 20.0,
        rate_hz: 100.0,
        parameters: parameters.map(|(n, v)| (n.to_owned(), v)).to_vec(),
        truth_known: true,
        missing: false,
    }
}

/// 60 s at 10 Hz, eleven coefficients, nothing known beforehand, some data missing.
pub(crate) fn jet() -> Case {
    let parameters = [
        ("CD_0", 0.1227),
        ("CD_V", -0.0646),
        ("CD_alpha", 0.3201),
        ("CL_0", -0.0929),
        ("CL_V", 0.1486),
        ("CL_alpha", 4.3286),
        ("Cm_0", 0.1125),
        ("Cm_V", 0.0040),
        ("Cm_alpha", -0.9680),
        ("Cm_q", -34.87),
        ("Cm_elevator", -1.529),
    ];
    Case {
        source: "hfb320.csv",
        seconds: 60.0,
        rate_hz: 10.0,
        parameters: parameters.map(|(n, v)| (n.to_owned(), v)).to_vec(),
        truth_known: false,
        missing: true,
    }
}

/// 20 s at 100 Hz with any number of parameters, truth known.
pub(crate) fn many(count: usize) -> Case {
    let terms = ["0", "alpha", "q", "elevator", "V", "alpha2", "alpha_elevator", "flaps"];
    let parameters = (0..count)
        .map(|k| {
            let coefficient = ["dCm", "dCL", "dCD"][k / terms.len() % 3];
            (format!("{coefficient}_{}", terms[k % terms.len()]), 0.1 + k as f64)
        })
        .collect();
    Case { source: "many", seconds: 20.0, rate_hz: 100.0, parameters, truth_known: true, missing: false }
}

/// Standard normal numbers from a linear congruential generator: the same everywhere and for ever.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

fn input(t: f64) -> f64 {
    // 3-2-1-1 from 1 s on, unit 0.8 s.
    let steps = (t - 1.0) / 0.8;
    let amplitude = 1.5_f64.to_radians();
    match steps {
        s if s < 0.0 => 0.0,
        s if s < 3.0 => amplitude,
        s if s < 5.0 => -amplitude,
        s if s < 6.0 => amplitude,
        s if s < 7.0 => -amplitude,
        _ => 0.0,
    }
}

const OUTPUTS: [(&str, &str, f64); 6] = [
    ("true_airspeed", "m/s", 0.05),
    ("alpha", "rad", 0.0009),
    ("theta", "rad", 0.0005),
    ("q", "rad/s", 0.0012),
    ("ax", "m/s^2", 0.03),
    ("az", "m/s^2", 0.08),
];

/// One term that is missing and one that is not; quotes and an asterisk in the text.
fn offer() -> Offer {
    let term = |term: &str, parameter: &str, partial_f, excess: Option<f64>| OfferedTerm {
        coefficient: "Cm".to_owned(),
        term: term.to_owned(),
        input: None,
        parameter: parameter.to_owned(),
        value: 0.4987,
        std_error: 0.0123,
        partial_f,
        share: Some(0.123),
        excess,
        asked_for: excess.is_some(),
        prior_std: 1.0,
    };
    let effect = |parameter: &str, before: Option<f64>, after: f64| TermEffect {
        parameter: parameter.to_owned(),
        before,
        before_std: before.map(|_| 0.004),
        after,
        after_std: 0.003,
    };
    let line = |section: &str, line: &str| ModelLine { section: section.to_owned(), line: line.to_owned() };
    Offer {
        tried: 37,
        criterion: OfferCriterion { partial_f: 42.1, share: 0.02, excess: 0.1 },
        levels: vec![ResidualLevel { equation: "d(q)/dt".to_owned(), residual_std: 0.031, noise_std: 0.012 }],
        terms: vec![term("alpha^2", "dCm_alpha2", 1644.0, Some(0.83)), term("alpha*q_hat", "dCm_alpha_q", 3.5, None)],
        effects: vec![effect("dCm_alpha", Some(-0.213), -0.198), effect("dCm_alpha2", None, 0.4987)],
        lines: vec![
            line("", "inputs = [\"beta\"]"),
            line("coefficients", "Cm = [\"alpha\", \"alpha^2\"]"),
            line("parameters", "dCm_alpha2 = { prior_std = 1 }"),
        ],
        taken: false,
        reference_speed: 205.0,
    }
}

pub(crate) fn estimation(case: &Case) -> Estimation {
    let mut noise = Noise(20_260_101);
    let step = 1.0 / case.rate_hz;
    let count = (case.seconds * case.rate_hz).round() as usize;
    let time_s: Vec<f64> = (0..count).map(|k| k as f64 * step).collect();
    let (omega, zeta) = (1.6, 0.35);
    let (mut alpha, mut q, mut theta, mut v) = (0.045, 0.0, 0.045, 205.0);
    let mut truth: Vec<[f64; 6]> = Vec::new();
    for t in &time_s {
        truth.push([v, alpha, theta, q, 0.4 + 2.0 * (theta - 0.045), -9.81 - 90.0 * (alpha - 0.045)]);
        let fine = 20;
        for _ in 0..fine {
            let h = step / f64::from(fine);
            let qdot = -omega * omega * (alpha - 0.045) - 2.0 * zeta * omega * q - 6.0 * input(*t);
            alpha += h * (q - 0.6 * (alpha - 0.045));
            theta += h * q;
            v += -h * 9.81 * (theta - 0.045 - (alpha - 0.045));
            q += h * qdot;
        }
    }
    let mut measured: Vec<Signal> = OUTPUTS.map(|(n, u, _)| signal(n, u)).to_vec();
    let mut predicted = measured.clone();
    let mut residuals: Vec<Signal> = OUTPUTS.map(|(n, _, _)| signal(n, "-")).to_vec();
    let mut colour = [0.0; 6];
    let mut phase = Vec::new();
    for (k, row) in truth.iter().enumerate() {
        let t = time_s[k];
        let gap = case.missing && (21.0..23.5).contains(&t);
        let outlier = k % 331 == 200;
        for (i, (_, _, sigma)) in OUTPUTS.iter().enumerate() {
            colour[i] = 0.7 * colour[i] + 0.3 * noise.normal();
            let lone = if case.missing && i == 4 { colour[i] } else { noise.normal() };
            let spike = if outlier && i % 3 == 1 { 15.0 } else { 0.0 };
            let start = 3.0 * (-t / 0.4).exp() * if i == 1 { 1.0 } else { 0.0 };
            let e = lone + spike + start;
            predicted[i].values.push(row[i]);
            measured[i].values.push(if gap { f64::NAN } else { row[i] + sigma * e });
            residuals[i].values.push(if gap { f64::NAN } else { e });
        }
        phase.push(match () {
            () if t < 0.2 => Phase::Starting,
            () if gap => Phase::Predicting,
            () if outlier => Phase::Rejected,
            () if (1.0..1.3).contains(&t) || k % 97 == 5 => Phase::Reaching,
            () => Phase::Sliding,
        });
    }

    let mut parameters = Vec::new();
    let mut histories = Vec::new();
    for (j, (name, value)) in case.parameters.iter().enumerate() {
        let initial = if case.truth_known { 0.0 } else { 0.6 * value };
        let prior = (value - initial).abs().max(1e-3);
        let quality = 0.004 + 0.006 * (j % 4) as f64;
        let learnt = 1.4 + 0.5 * (j % 5) as f64;
        let excited = j != 7;
        let mut wander = 0.0;
        let mut history = ParameterHistory { name: name.clone(), ..ParameterHistory::default() };
        for t in &time_s {
            let share = if *t < 1.0 || !excited { 0.0 } else { 1.0 - (-(t - 1.0) / (0.25 * learnt)).exp() };
            let relative =
                if excited { (quality * (1.0 + 3.0 / (t + 0.05).sqrt())).max(1.0 - share).min(1.0) } else { 0.98 };
            let sigma = prior * relative;
            wander += 0.02 * (noise.normal() * quality * prior - 0.3 * wander);
            let ring = if share > 0.0 { 0.3 * (-(t - 1.0) / 0.8).exp() * (5.0 * (t - 1.0)).sin() } else { 0.0 };
            let now = initial + (value - initial) * (share + ring) + 10.0 * wander * share;
            history.value.push(now);
            history.std_error.push(sigma);
            history.surface.push((value - now) * share + 0.02 * prior * noise.normal() * share);
        }
        let (last, sigma) = (history.value[count - 1], history.std_error[count - 1]);
        parameters.push(ParameterResult {
            name: name.clone(),
            unit: "per rad".to_owned(),
            value: last,
            std_error: 0.8 * sigma,
            corrected_std_error: sigma,
            systematic_std: 0.0,
            systematic_parts: Vec::new(),
            learnt_shift: 0.0,
            correction_std: 0.0,
            lower: last - 2.0 * sigma,
            upper: last + 2.0 * sigma,
            status: if excited { FinalStatus::Converged } else { FinalStatus::NotExcited },
            converged_at_s: excited.then_some(1.0 + learnt),
            observability: if excited { 1.0 - quality * quality } else { 0.04 },
            initial,
            prior_std: prior,
            bounds: case.truth_known.then(|| [-2.5 * value.abs(), 2.5 * value.abs()]),
            truth: case.truth_known.then_some(*value),
            nuisance: name.starts_with("offset_") || name.starts_with("bias_"),
            readiness: Some(ParameterReadiness {
                verdict: if excited { Readiness::Ready } else { Readiness::NotIdentifiable },
                reason: if excited { "its bound is small" } else { "this input does not move its regressor" }
                    .to_owned(),
                advice: (!excited).then(|| "fly an elevator doublet".to_owned()),
                ready_since_s: excited.then_some(3.5),
                bound_over_prior: sigma / prior,
                excitation: 0.5 * sigma / prior,
                variance_inflation: 4.0,
                correlated_with: vec![("Cm_q".to_owned(), -0.82)],
            }),
        });
        histories.push(history);
    }
    let count_p = parameters.len();
    let correlation = (0..count_p)
        .map(|i| {
            (0..count_p)
                .map(|j| match i.abs_diff(j) {
                    0 => 1.0,
                    d => ((i * j + i + j) as f64 * 2.1).sin() * if d == 1 { 0.97 } else { 0.7 / d as f64 },
                })
                .collect()
        })
        .collect();
    let event = |time_s, kind: EventKind, message: &str| Event { time_s, kind, message: message.to_owned() };
    let half = 0.5 * case.seconds;
    Estimation {
        source: case.source.to_owned(),
        model: if case.truth_known { "f16" } else { "hfb320.toml" }.to_owned(),
        method: Method::Smpe,
        parameters,
        learnt: Vec::new(),
        correlation,
        effective: Vec::new(),
        totals: Vec::new(),
        alpha_reference: 0.0,
        offer: case.truth_known.then(offer),
        status: EstimationStatus::Sound,
        reasons: Vec::new(),
        changes: Vec::new(),
        verdict: vec![
            "All increments are known to better than 4 % of their value.".to_owned(),
            "CL_0 and CL_V cannot be told apart well (correlation −0.97): fly at two speeds.".to_owned(),
        ],
        events: vec![
            event(
                half,
                EventKind::InDoubt,
                "A change of the aircraft would explain the last second better (log Bayes factor 26).",
            ),
            event(half + 0.04 * case.seconds, EventKind::DoubtDropped, "The running estimate won again."),
        ],
        quality: QualityReport {
            deletions: Vec::new(),
            start: None,
            clock_at_zero_us: None,
            time_of_day_at_zero_s: None,
            rows_read: count + 3,
            rows_kept: count,
            sample_time_s: step,
            channels: OUTPUTS
                .map(|(name, unit, _)| ChannelQuality {
                    name: name.to_owned(),
                    header: format!("{name}_si"),
                    unit: unit.to_owned(),
                    unit_assumed: name == "q",
                    scale: 1.0,
                    missing: if case.missing { 25 } else { 0 },
                    spikes: 2,
                })
                .to_vec(),
            findings: vec![
                Finding {
                    severity: Severity::Note,
                    place: "alpha".to_owned(),
                    message: "given in degrees (header alpha_deg), converted to radians".to_owned(),
                },
                Finding {
                    severity: Severity::Warning,
                    place: "rows 210 to 234".to_owned(),
                    message: "2.5 s without data; the model is predicted across, nothing is learnt there".to_owned(),
                },
            ],
        },
        noise: OUTPUTS.map(|(n, u, s)| Signal { values: vec![s], ..signal(n, u) }).to_vec(),
        consistency: Vec::new(),
        batch: None,
        second_answer: None,
        third_answer: None,
        by_surfaces: Vec::new(),
        history: History {
            inputs: vec![Signal {
                values: time_s.iter().map(|t| input(*t) - 0.034).collect(),
                ..signal("elevator", "rad")
            }],
            time_s,
            measured,
            predicted,
            residuals,
            parameters: histories,
            phase,
        },
    }
}

fn signal(name: &str, unit: &str) -> Signal {
    Signal { name: name.to_owned(), unit: unit.to_owned(), values: Vec::new() }
}
