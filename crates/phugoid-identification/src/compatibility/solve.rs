//! The errors of the sensors that make the innovations of all flights most likely.

use nalgebra::{DMatrix, DVector};

use super::filter::{Block, Levels, Run, run};
use super::kinematics::{PARAMETERS, place};
use super::levels::{improved, prior_cost};
use super::signals::Flight;
use super::unknowns::UNKNOWNS;
use crate::core::error::EstimateError;

/// One unknown: an error of a sensor, the same in all flights, or what belongs to the place and the air of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    /// Its place among the unknowns of the kinematics.
    pub(super) place: usize,
    /// The flight that it belongs to; none where it is the same in all.
    pub(super) flight: Option<usize>,
    pub(super) prior_std: f64,
    /// True for what is not estimated, but whose possible size belongs to the errors of the others.
    pub(super) considered: bool,
}

/// The most likely unknowns, with what the innovations say of them.
pub(super) struct Solution {
    pub(super) columns: Vec<Column>,
    pub(super) values: Vec<f64>,
    pub(super) levels: Vec<Levels>,
    /// Covariance of the values, with their priors.
    pub(super) covariance: DMatrix<f64>,
    /// The same, enlarged where the innovations of neighbouring samples go together.
    pub(super) corrected: DMatrix<f64>,
    /// Information and score of each block of time, in the order of the columns.
    pub(super) blocks: Vec<(DMatrix<f64>, DVector<f64>)>,
    /// Twice the negative logarithm of the likelihood, with the priors.
    pub(super) cost: f64,
    /// The unknown that is furthest from where the next step would put it, and by how many of its claimed errors, if
    /// the search for it did not end.
    pub(super) open: Option<(usize, f64)>,
    /// Fixed unknowns that are not columns.
    pub(super) fixed: [f64; PARAMETERS],
}

/// Steps below this many standard errors end the iteration.
const ENOUGH: f64 = 0.05;
/// So do changes of the logarithms of the noise levels below this.
const ENOUGH_LEVELS: f64 = 0.05;
const ITERATIONS: usize = 30;

impl Solution {
    /// All unknowns of one flight.
    pub(super) fn theta(&self, flight: usize) -> [f64; PARAMETERS] {
        theta(&self.columns, &self.values, &self.fixed, flight)
    }

    /// The columns that act on a flight.
    pub(super) fn columns_of(&self, flight: usize) -> Vec<usize> {
        columns_of(&self.columns, flight)
    }
}

fn columns_of(columns: &[Column], flight: usize) -> Vec<usize> {
    (0..columns.len()).filter(|i| columns[*i].flight.is_none_or(|f| f == flight)).collect()
}

fn theta(columns: &[Column], values: &[f64], fixed: &[f64; PARAMETERS], flight: usize) -> [f64; PARAMETERS] {
    let mut theta = *fixed;
    for i in columns_of(columns, flight) {
        theta[columns[i].place] = values[i];
    }
    // What an iteration passes through has to stay where the motion can be followed.
    for delay in &mut theta[place::DELAY_SPEED..=place::DELAY_ATTITUDE] {
        *delay = delay.clamp(-0.2, 1.0);
    }
    theta
}

/// All flights at one point.
struct Point {
    values: Vec<f64>,
    levels: Vec<Levels>,
    cost: f64,
    runs: Vec<Run>,
}

struct Problem<'a> {
    flights: &'a [Flight],
    columns: Vec<Column>,
    fixed: [f64; PARAMETERS],
}

impl Problem<'_> {
    fn at(&self, values: Vec<f64>, levels: Vec<Levels>) -> Point {
        let mut cost: f64 = values.iter().zip(&self.columns).map(|(v, c)| (v / c.prior_std).powi(2)).sum();
        let runs: Vec<Run> = self
            .flights
            .iter()
            .zip(&levels)
            .enumerate()
            .map(|(f, (flight, levels))| {
                let places: Vec<usize> = columns_of(&self.columns, f).iter().map(|i| self.columns[*i].place).collect();
                let run = run(flight, &theta(&self.columns, &values, &self.fixed, f), levels, &places, false);
                cost += run.cost + prior_cost(flight, levels);
                run
            })
            .collect();
        Point { values, levels, cost, runs }
    }

    /// The blocks of all flights, by all columns.
    fn blocks(&self, runs: &[Run]) -> Vec<(DMatrix<f64>, DVector<f64>)> {
        let count = self.columns.len();
        let mut all = Vec::new();
        for (f, run) in runs.iter().enumerate() {
            let own = columns_of(&self.columns, f);
            for Block { information, score } in &run.blocks {
                let (mut m, mut g) = (DMatrix::zeros(count, count), DVector::zeros(count));
                for (a, &i) in own.iter().enumerate() {
                    g[i] = score[a];
                    for (b, &j) in own.iter().enumerate() {
                        m[(i, j)] = information[a * own.len() + b];
                    }
                }
                all.push((m, g));
            }
        }
        all
    }

    /// The step of Gauss and Newton, the covariance, and the length of the step in standard errors.
    fn step(&self, point: &Point) -> Option<(DVector<f64>, DMatrix<f64>, f64)> {
        let count = self.columns.len();
        let (mut m, mut g) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
        for (information, score) in self.blocks(&point.runs) {
            m += information;
            g += score;
        }
        for i in (0..count).filter(|i| self.columns[*i].considered) {
            g[i] = 0.0;
        }
        for (i, (column, value)) in self.columns.iter().zip(&point.values).enumerate() {
            g[i] -= value / column.prior_std.powi(2);
        }
        let covariance = with_priors(&self.columns, &m)?;
        let step = &covariance * g;
        let length = (0..count).map(|i| step[i].abs() / covariance[(i, i)].sqrt()).fold(0.0, f64::max);
        length.is_finite().then_some((step, covariance, length))
    }
}

/// `(M + P0^-1)^-1`, scaled by the priors, so that it always exists.
pub(super) fn with_priors(columns: &[Column], information: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = columns.len();
    let scaled = DMatrix::from_fn(count, count, |i, j| {
        let own = if i == j { 1.0 } else { 0.0 };
        if columns[i].considered || columns[j].considered {
            return own;
        }
        own + columns[i].prior_std * 0.5 * (information[(i, j)] + information[(j, i)]) * columns[j].prior_std
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(count, count, |i, j| columns[i].prior_std * inverse[(i, j)] * columns[j].prior_std))
}

/// Finds the most likely unknowns and noise levels, from zero on.
///
/// # Errors
/// [`EstimateError::Model`] if the filter cannot follow the motion.
pub(super) fn solve(
    flights: &[Flight],
    columns: Vec<Column>,
    fixed: [f64; PARAMETERS],
    from: Option<(Vec<f64>, Vec<Levels>)>,
) -> Result<Solution, EstimateError> {
    let failed = |why: &str| Err(EstimateError::Model(format!("data compatibility: {why}")));
    let problem = Problem { flights, columns, fixed };
    let (values, levels) =
        from.unwrap_or_else(|| (vec![0.0; problem.columns.len()], flights.iter().map(|f| f.levels.clone()).collect()));
    let mut point = problem.at(values, levels);
    if !point.cost.is_finite() {
        return failed("the kinematics cannot be followed: look for wrong units or signs with `phugoid inspect`");
    }
    let mut last_step = f64::INFINITY;
    // Part of a step that is taken, and the step before.
    let mut settled = false;
    let (mut part, mut before) = (1.0_f64, DVector::<f64>::zeros(problem.columns.len()));
    for iteration in 0..ITERATIONS {
        let Some((step, covariance, length)) = problem.step(&point) else {
            return failed("the equations of the unknowns cannot be solved: a channel has values beyond all measure");
        };
        let mut change: f64 = 0.0;
        let beginning = iteration < 3;
        let levels: Vec<Levels> = flights
            .iter()
            .zip(&point.runs)
            .zip(&point.levels)
            .map(|((flight, run), now)| {
                if settled {
                    return now.clone();
                }
                let (next, largest) = improved(flight, &run.steps, now, beginning);
                change = change.max(largest);
                next
            })
            .collect();
        // Levels within a few per cent are good enough: they are not looked for again.
        settled = settled || !beginning && change < ENOUGH_LEVELS;
        last_step = length;
        if length < ENOUGH && settled {
            break;
        }
        // The derivatives leave out that the gain of the filter depends on the unknowns: a step may be too long, and then
        // the next one turns back.
        let scale = |i: usize| covariance[(i, i)].sqrt().recip();
        let along: f64 = (0..step.len()).map(|i| step[i] * before[i] * scale(i).powi(2)).sum();
        part = if along < 0.0 { (0.5 * part).max(0.05) } else { (1.3 * part).min(1.0) };
        // Far steps of a scale or a delay lead to where the channel means nothing any more.
        let reach = |i: usize| match UNKNOWNS[problem.columns[i].place].unit {
            "-" => 0.1 / step[i].abs(),
            "s" => 0.04 / step[i].abs(),
            _ => f64::INFINITY,
        };
        let mut taken = (0..step.len()).map(reach).fold(part, f64::min);
        let mut best: Option<Point> = None;
        for _ in 0..5 {
            let values = point.values.iter().zip(step.iter()).map(|(v, s)| v + taken * s).collect();
            let next = problem.at(values, levels.clone());
            let better = best.as_ref().is_none_or(|b| next.cost < b.cost);
            // Near the end the equations alone count, whose root is not quite the minimum of the cost: they leave out
            // that the gain depends on the unknowns, and need no such term to be right on average.
            let allowed = if length < 5.0 { 100.0 } else { 0.05 };
            let good = next.cost.is_finite() && next.cost <= point.cost + allowed;
            if next.cost.is_finite() && better {
                best = Some(next);
            }
            if good {
                break;
            }
            taken *= 0.4;
        }
        let Some(next) = best else {
            return failed("the filter over the kinematics diverges");
        };
        point = next;
        before = step;
    }
    let Some((step, covariance, _)) = problem.step(&point) else {
        return failed("the equations of the unknowns cannot be solved");
    };
    let blocks = problem.blocks(&point.runs);
    let mut corrected = for_colour(&problem.columns, &covariance, &blocks);
    corrected += of_considered(&problem, &point, &covariance, &blocks);
    // Where turbulence leaves an unknown open, the way to the minimum is long and flat: what counts are the errors that
    // are claimed.
    let open = (0..step.len())
        .map(|i| (i, step[i].abs() / corrected[(i, i)].sqrt()))
        .filter(|(_, length)| last_step >= ENOUGH && *length > 10.0 * ENOUGH)
        .max_by(|a, b| a.1.total_cmp(&b.1));
    Ok(Solution {
        columns: problem.columns,
        values: point.values,
        levels: point.levels,
        covariance,
        corrected,
        blocks,
        cost: point.cost,
        open,
        fixed,
    })
}

/// The covariance with the scatter that the scores of blocks of time really have: `C (P0^-1 + S) C`,
/// `S = sum g g^T` about the mean, where that is larger.
fn for_colour(columns: &[Column], covariance: &DMatrix<f64>, blocks: &[(DMatrix<f64>, DVector<f64>)]) -> DMatrix<f64> {
    let count = columns.len();
    let mut scatter = DMatrix::<f64>::zeros(count, count);
    for (i, column) in columns.iter().enumerate() {
        scatter[(i, i)] = column.prior_std.powi(-2);
    }
    for (_, g) in blocks {
        scatter += g * g.transpose();
    }
    let sandwich = covariance * scatter * covariance;
    // What is considered only has no place here: `of_considered` gives it one.
    let widening = |i: usize| match columns[i].considered {
        true => 0.0,
        false => (sandwich[(i, i)] / covariance[(i, i)]).max(1.0).sqrt(),
    };
    let widening: Vec<f64> = (0..count).map(widening).collect();
    DMatrix::from_fn(count, count, |i, j| covariance[(i, j)] * widening[i] * widening[j])
}

/// What the considered columns add: `C M_c s^2 M_c^T C`, with the sigma `s` of each; and `s^2` in their own places in
/// place of their priors, with the correlation that this gives with the others.
///
/// A gust changes the forces on the aircraft at once, so that the accelerometers are no input that knows nothing of the
/// gust: what they showed since the vane last told the gust goes with the gust, and the scale and the delay of a vane
/// in turbulence are biased by it. That needs the aerodynamics, which are not known here. But a gust cannot go with the
/// force by more than `|dg/df| <= rms(dg)/rms(df)` from sample to sample (Cauchy and Schwarz).
fn of_considered(
    problem: &Problem,
    point: &Point,
    covariance: &DMatrix<f64>,
    blocks: &[(DMatrix<f64>, DVector<f64>)],
) -> DMatrix<f64> {
    let count = problem.columns.len();
    let mut information = DMatrix::<f64>::zeros(count, count);
    for (m, _) in blocks {
        information += m;
    }
    let mut added = DMatrix::<f64>::zeros(count, count);
    for (i, column) in problem.columns.iter().enumerate().filter(|(_, c)| c.considered) {
        let Some(f) = column.flight else { continue };
        let (flight, levels) = (&problem.flights[f], &point.levels[f]);
        let axis = column.place - place::GUST_BY_FORCE;
        let sigma = levels.gusts[axis] * flight.gust_over_force(axis, levels.length);
        let mut direct = information.column(i).into_owned();
        for j in (0..count).filter(|j| problem.columns[*j].considered) {
            direct[j] = 0.0;
        }
        let mut effect = covariance * direct * sigma;
        // The unknowns move so as to explain what the considered one, held at zero, does not.
        effect[i] = -sigma;
        added += &effect * effect.transpose();
    }
    added
}

/// The unknowns whose estimates no sensor can have.
pub(super) fn impossible(solution: &Solution) -> Vec<usize> {
    let columns = solution.columns.iter().zip(&solution.values);
    let outside = |(column, value): (&Column, &f64)| {
        let [least, most] = UNKNOWNS[column.place].possible;
        !(least..=most).contains(value)
    };
    columns.enumerate().filter(|(_, pair)| outside(*pair)).map(|(i, _)| i).collect()
}
