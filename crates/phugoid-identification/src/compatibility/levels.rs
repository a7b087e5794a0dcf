//! The noise levels of a flight, from the innovations of the filter: turbulence, sensors, and inertial sensors.

use nalgebra::{DMatrix, DVector};

use super::filter::{GUST_LENGTH_M, HUBER, Levels, Replay, Step, replay};
use super::kinematics::{BANK, BODY, OUTPUTS};
use super::signals::{Flight, LEAST_NOISE};

/// One level, of which the logarithm is estimated.
#[derive(Clone, Copy)]
enum Level {
    Output(usize),
    Gust(usize),
    Inertial(usize),
    Length,
    Bank,
}

/// Prior of a logarithm of a level, and the least value that it may have.
struct Prior {
    middle: f64,
    std: f64,
    least: f64,
}

impl Level {
    fn all(flight: &Flight) -> Vec<Self> {
        let outputs = (0..OUTPUTS).filter(|i| flight.levels.outputs[*i].is_some()).map(Self::Output);
        let gusts = (0..3).filter(|i| flight.active.contains(&(BODY + i))).map(Self::Gust);
        let bank = flight.active.contains(&BANK).then_some(Self::Bank);
        outputs.chain(gusts).chain((0..2).map(Self::Inertial)).chain([Self::Length]).chain(bank).collect()
    }

    fn of(self, levels: &Levels) -> f64 {
        match self {
            Self::Output(i) => levels.outputs[i].unwrap_or(1.0),
            Self::Gust(i) => levels.gusts[i],
            Self::Inertial(i) => levels.inertial[i],
            Self::Length => levels.length,
            Self::Bank => levels.bank,
        }
        .ln()
    }

    fn set(self, levels: &mut Levels, logarithm: f64) {
        let value = logarithm.exp();
        match self {
            Self::Output(i) => levels.outputs[i] = Some(value),
            Self::Gust(i) => levels.gusts[i] = value,
            Self::Inertial(i) => levels.inertial[i] = value,
            Self::Length => levels.length = value,
            Self::Bank => levels.bank = value,
        }
    }

    fn prior(self, flight: &Flight) -> Prior {
        match self {
            // The residuals of real records are 5 to 50 times the noise of their third differences: no obstacle.
            // Much below it they are not: else a gust would be taken for known without noise.
            Self::Output(i) => {
                let measured = self.of(&flight.levels);
                Prior { middle: measured, std: 1.0, least: LEAST_NOISE[i].ln().max(measured + 0.6_f64.ln()) }
            }
            // From calm (1 cm/s) to severe turbulence (several m/s).
            Self::Gust(_) => Prior { middle: 0.2_f64.ln(), std: 2.0, least: 0.01_f64.ln() },
            // Third differences measure white noise well, and slower noise is more: less than measured it is not.
            Self::Inertial(_) => Prior { middle: 0.0, std: 0.5, least: -0.1 },
            Self::Length => Prior { middle: GUST_LENGTH_M.ln(), std: 0.5, least: 3.0 },
            // Nine degrees are 0.012.
            Self::Bank => Prior { middle: 0.003_f64.ln(), std: 1.5, least: 1e-5_f64.ln() },
        }
    }
}

/// What the prior adds to the cost.
pub(super) fn prior_cost(flight: &Flight, levels: &Levels) -> f64 {
    let of = |level: Level| {
        let prior = level.prior(flight);
        ((level.of(levels) - prior.middle) / prior.std).powi(2)
    };
    Level::all(flight).into_iter().map(of).sum()
}

/// One step of the method of scoring towards the most likely levels for the innovations of a run; the largest change of
/// a logarithm comes with them.
///
/// At the beginning the errors of the sensors are not known yet and must not pass for noise of the inertial ones, whose
/// levels were measured, nor a constant error of a gyroscope for a bank: these are left alone until then.
pub(super) fn improved(flight: &Flight, steps: &[Step], levels: &Levels, beginning: bool) -> (Levels, f64) {
    const CHANGE: f64 = 0.05;
    const NOTHING: f64 = 0.3;
    let mut all = Level::all(flight);
    all.retain(|level| !(beginning && matches!(level, Level::Inertial(_) | Level::Length | Level::Bank)));
    let base = replay(flight, steps, levels);
    let cost = base.cost + prior_cost(flight, levels);
    let varied: Vec<Replay> = all
        .iter()
        .map(|level| {
            let mut more = levels.clone();
            level.set(&mut more, level.of(levels) + CHANGE);
            replay(flight, steps, &more)
        })
        .collect();
    let count = all.len();
    let mut information = DMatrix::<f64>::zeros(count, count);
    let mut slope = DVector::<f64>::zeros(count);
    let mut relative = vec![0.0; count];
    let mut moved = vec![0.0; count];
    for (k, (e, s)) in base.innovations.iter().enumerate() {
        let xi = e / s.sqrt();
        let clipped = xi.clamp(-HUBER, HUBER);
        for (i, other) in varied.iter().enumerate() {
            let (e2, s2) = other.innovations[k];
            relative[i] = (s2 - s) / (CHANGE * s);
            moved[i] = (e2 - e) / (CHANGE * s.sqrt());
            slope[i] += 0.5 * relative[i] * (1.0 - clipped * xi) + clipped * moved[i];
        }
        for i in 0..count {
            for j in 0..=i {
                information[(i, j)] += 0.5 * relative[i] * relative[j] + moved[i] * moved[j];
            }
        }
    }
    for (i, level) in all.iter().enumerate() {
        let prior = level.prior(flight);
        information[(i, i)] += prior.std.powi(-2);
        slope[i] += (level.of(levels) - prior.middle) / prior.std.powi(2);
        for j in 0..i {
            information[(j, i)] = information[(i, j)];
        }
    }
    let Some(step) = information.cholesky().map(|c| c.solve(&slope)) else { return (levels.clone(), 0.0) };
    let mut part = 1.0;
    for _ in 0..5 {
        let mut next = levels.clone();
        let mut largest: f64 = 0.0;
        for (i, level) in all.iter().enumerate() {
            let now = level.of(levels);
            let wanted = (now - part * step[i].clamp(-1.5, 1.5)).max(level.prior(flight).least);
            largest = largest.max((wanted - now).abs());
            level.set(&mut next, wanted);
        }
        let reached = replay(flight, steps, &next).cost + prior_cost(flight, &next);
        if reached <= cost {
            // What changes the likelihood by next to nothing is no change.
            return (next, if cost - reached < NOTHING { 0.0 } else { largest });
        }
        part *= 0.4;
    }
    (levels.clone(), 0.0)
}
