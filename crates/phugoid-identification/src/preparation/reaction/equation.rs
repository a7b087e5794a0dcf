//! The equation of an angular rate, with the time of the surface among its parameters.
//!
//! ```text
//! x' = m x + sum_i c_i u_i(t) + d delta(t + tau) + offset + drift t,   rate = x + noise
//! ```
//!
//! `u_i` are the other causes of the moment as they were recorded (flow angle, the other rate), `delta` is the surface, and
//! `tau` the time by which its record is late. The damping `m` acts on the rate `x` of the *equation*, not on the recorded one:
//! the noise of a recorded rate makes its factor too small, and a delay that is none takes its place (errors in variables;
//! W. A. Fuller, *Measurement Error Models*, 1987, ch. 1; output error: R. V. Jategaonkar, *Flight Vehicle System
//! Identification*, 2006, ch. 4). What is left of the rate has a memory, which is taken out of the equation ([`whitening`]),
//! so that the least squares is the most likely value. `m` and `tau` are found by the method of Gauss and Newton; all else
//! is linear. Offset, drift and initial rate are those of each stretch of the record.

use nalgebra::{DMatrix, DVector};

use super::samples::{largest, moves, rate, stretches};
use super::whitening::{autoregression, whitened};
use crate::preparation::resample::at_times;
use crate::preparation::windows::regression::inverse_by_unit_size;

/// Damping from which it is looked for, and the range in which it can be, 1/s: a moment that drives its own rate is none.
const FIRST_DAMPING: f64 = -2.0;
const DAMPINGS: std::ops::RangeInclusive<f64> = -60.0..=0.0;
/// Largest change of a time in one iteration, s: the equation is linear in it only while it is short against the motion.
const MOST_CHANGE_S: f64 = 0.06;
/// Times that are tried, in these steps, s, up to so many either way.
const TRIED_STEP_S: f64 = 0.06;
const TRIED: i32 = 6;
/// Memory of the residuals, s, and as many samples at least and at most.
const MEMORY_S: f64 = 0.2;
const MEMORY: [usize; 2] = [4, 24];
/// Iterations of Gauss and Newton at most.
const MOST_ITERATIONS: usize = 12;
/// Changes from which on none is worth it: of the time (s), and of the damping as a part of itself.
const SETTLED_S: f64 = 1e-4;
const SETTLED_DAMPING: f64 = 0.01;
/// Residuals further apart than this are taken as independent of each other, s.
const BLOCK_S: f64 = 1.0;
/// Shortest record, s: what little a shorter one says is not worth the time.
const SHORTEST_S: f64 = 8.0;
/// Samples for each unknown, at least.
const FEWEST_PER_UNKNOWN: usize = 10;

/// A rate and its causes, by sample of a record.
pub(super) struct Equation<'a> {
    pub(super) time_s: &'a [f64],
    /// Median step, s.
    pub(super) step_s: f64,
    pub(super) rate: &'a [f64],
    pub(super) causes: Vec<Vec<f64>>,
    pub(super) surface: &'a [f64],
}

/// By how much the surface was recorded late, and one sigma of it, s. None if the record is too short, or does not determine it.
///
/// A cause that stands still has no factor, and is left out: with it nothing would be determined.
pub(super) fn late(mut equation: Equation<'_>) -> Option<(f64, f64)> {
    let stretches = stretches(equation.time_s, equation.step_s, equation.surface);
    let stands_still = |channel: &[f64]| {
        let size = largest(channel);
        !stretches.iter().any(|times| moves(&at(&equation, times, channel, 0.0), size))
    };
    if stands_still(equation.surface) {
        return None;
    }
    let still: Vec<bool> = equation.causes.iter().map(|cause| stands_still(cause)).collect();
    let mut still = still.into_iter();
    equation.causes.retain(|_| !still.next().unwrap_or(false));
    let search = Search {
        rates: stretches.iter().map(|times| at(&equation, times, equation.rate, 0.0)).collect(),
        causes: stretches
            .iter()
            .map(|times| equation.causes.iter().map(|cause| at(&equation, times, cause, 0.0)).collect())
            .collect(),
        surface_rate: rate(equation.time_s, equation.surface),
        stretches,
        equation: &equation,
    };
    search.most_likely()
}

/// A channel at these times, recorded so late (s).
fn at(equation: &Equation<'_>, times: &[f64], channel: &[f64], late_s: f64) -> Vec<f64> {
    at_times(times.iter().map(|t| t + late_s), equation.time_s, channel)
}

/// What is not linear in the equation.
#[derive(Clone, Copy)]
struct Point {
    damping: f64,
    late_s: f64,
}

/// A signal of one stretch, as it is and without its memory. Both undergo the same operations.
struct Signal {
    raw: Vec<f64>,
    white: Vec<f64>,
}

impl Signal {
    fn new(raw: Vec<f64>, filter: &[f64]) -> Self {
        let white = whitened(&raw, filter);
        Self { raw, white }
    }

    fn less(&mut self, factor: f64, other: &Self) {
        for (own, other) in [(&mut self.raw, &other.raw), (&mut self.white, &other.white)] {
            own.iter_mut().zip(other).for_each(|(own, other)| *own -= factor * other);
        }
    }

    /// Takes out what is along signals that are orthogonal to each other and of unit size.
    fn without(mut self, others: &[Self]) -> Self {
        for other in others {
            self.less(dot(&self.white, &other.white), other);
        }
        self
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four sums side by side: a processor adds them at once.
    let (of_a, of_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = of_a.remainder().iter().zip(of_b.remainder()).map(|(a, b)| a * b).sum();
    let sums = of_a.zip(of_b).fold([0.0; 4], |sums, (a, b)| std::array::from_fn(|i| sums[i] + a[i] * b[i]));
    sums.iter().sum::<f64>() + rest
}

/// The part of the equation that is linear, solved at one point.
struct Solved {
    point: Point,
    /// Factors of the causes, then of the surface.
    factors: DVector<f64>,
    /// By stretch: what its own offset, drift and initial rate span, the signals of the factors, and the residual.
    own: Vec<Vec<Signal>>,
    signals: Vec<Vec<Signal>>,
    residuals: Vec<Signal>,
    /// Sum of the squares of the residuals without memory.
    squares: f64,
}

struct Search<'a> {
    equation: &'a Equation<'a>,
    stretches: Vec<Vec<f64>>,
    rates: Vec<Vec<f64>>,
    /// By stretch, then by cause.
    causes: Vec<Vec<Vec<f64>>>,
    surface_rate: Vec<f64>,
}

impl Search<'_> {
    fn most_likely(&self) -> Option<(f64, f64)> {
        let order = ((MEMORY_S / self.equation.step_s).round() as usize).clamp(MEMORY[0], MEMORY[1]);
        let samples: usize = self.stretches.iter().map(|times| times.len().saturating_sub(order)).sum();
        let unknowns = 3 * self.stretches.len() + self.equation.causes.len() + 3;
        if samples < FEWEST_PER_UNKNOWN * unknowns || samples as f64 * self.equation.step_s < SHORTEST_S {
            return None;
        }
        let as_it_is = [1.0];
        let start = self.solved(Point { damping: FIRST_DAMPING, late_s: 0.0 }, &as_it_is)?;
        let mut found = self.settled(start, &as_it_is)?;
        for step in (-TRIED..=TRIED).filter(|step| *step != 0) {
            let tried = Point { late_s: f64::from(step) * TRIED_STEP_S, ..found.point };
            found = self.solved(tried, &as_it_is).filter(|tried| tried.squares < found.squares).unwrap_or(found);
        }
        found = self.settled(found, &as_it_is)?;
        // Once: with the memory taken out, offsets and drifts are hardly determined, and residuals about them have another one.
        let residuals: Vec<Vec<f64>> = found.residuals.iter().map(|residual| residual.raw.clone()).collect();
        let filter = autoregression(&residuals, order);
        found = self.settled(self.solved(found.point, &filter)?, &filter)?;
        let std_s = self.std_s(&found, &filter, samples - unknowns)?;
        Some((found.point.late_s, std_s))
    }

    /// From a point to the one nearby that leaves the least.
    fn settled(&self, mut found: Solved, filter: &[f64]) -> Option<Solved> {
        for _ in 0..MOST_ITERATIONS {
            let change = self.change(&found, filter)?;
            let step = |part: f64| {
                let Point { damping, late_s } = found.point;
                let damping = (damping + part * change.damping).clamp(*DAMPINGS.start(), *DAMPINGS.end());
                let late_s = late_s + (part * change.late_s).clamp(-MOST_CHANGE_S, MOST_CHANGE_S);
                self.solved(Point { damping, late_s }, filter).filter(|next| next.squares < found.squares)
            };
            let Some(next) = [1.0, 0.5, 0.25, 0.1].into_iter().find_map(step) else { break };
            let moved_s = (next.point.late_s - found.point.late_s).abs();
            let damped = (next.point.damping - found.point.damping).abs();
            found = next;
            if moved_s < SETTLED_S && damped < SETTLED_DAMPING * found.point.damping.abs().max(1.0) {
                break;
            }
        }
        Some(found)
    }

    fn solved(&self, point: Point, filter: &[f64]) -> Option<Solved> {
        let respond = |values: &[f64]| response(point.damping, self.equation.step_s, values);
        let (mut own, mut signals, mut rates) = (Vec::new(), Vec::new(), Vec::new());
        for ((times, rate), causes) in self.stretches.iter().zip(&self.rates).zip(&self.causes) {
            let spanned = self.own(times, point.damping, filter);
            let surface = at(self.equation, times, self.equation.surface, point.late_s);
            let all = causes.iter().map(|cause| respond(cause)).chain([respond(&surface)]);
            signals.push(all.map(|values| Signal::new(values, filter).without(&spanned)).collect::<Vec<_>>());
            rates.push(Signal::new(rate.clone(), filter).without(&spanned));
            own.push(spanned);
        }
        let count = self.equation.causes.len() + 1;
        let right = DVector::from_fn(count, |i, _| {
            signals.iter().zip(&rates).map(|(s, rate)| dot(&s[i].white, &rate.white)).sum()
        });
        let factors = inverse(&normal(&signals, &[], count))? * right;
        let mut residuals = rates;
        for (residual, signals) in residuals.iter_mut().zip(&signals) {
            for (signal, factor) in signals.iter().zip(factors.iter()) {
                residual.less(*factor, signal);
            }
        }
        let squares: f64 = residuals.iter().map(|residual| dot(&residual.white, &residual.white)).sum();
        squares.is_finite().then_some(Solved { point, factors, own, signals, residuals, squares })
    }

    /// What each stretch has of its own, orthogonal and of unit size: the response to an offset and to a drift of the
    /// moment, and the decay of the rate that it began with.
    fn own(&self, times: &[f64], damping: f64, filter: &[f64]) -> Vec<Signal> {
        let from = times.first().copied().unwrap_or(0.0);
        let since: Vec<f64> = times.iter().map(|t| t - from).collect();
        let respond = |values: &[f64]| response(damping, self.equation.step_s, values);
        let decay = since.iter().map(|t| (damping * t).exp()).collect();
        let mut spanned: Vec<Signal> = Vec::new();
        for raw in [decay, respond(&vec![1.0; times.len()]), respond(&since)] {
            let all = Signal::new(raw, filter);
            let before = dot(&all.white, &all.white);
            // Twice: the first time leaves what rounding makes of nearly equal signals.
            let mut left = all.without(&spanned).without(&spanned);
            let size = dot(&left.white, &left.white);
            if size > 1e-12 * before {
                let unit = 1.0 / size.sqrt();
                left.raw.iter_mut().chain(&mut left.white).for_each(|value| *value *= unit);
                spanned.push(left);
            }
        }
        spanned
    }

    /// By stretch, how the rate changes with the damping and with the time of the surface.
    fn slopes(&self, found: &Solved, filter: &[f64]) -> Vec<Vec<Signal>> {
        let Point { damping, late_s } = found.point;
        let by_surface = found.factors[self.equation.causes.len()];
        let respond = |values: &[f64]| response(damping, self.equation.step_s, values);
        let of = |i: usize| {
            let rate: Vec<f64> =
                self.rates[i].iter().zip(&found.residuals[i].raw).map(|(rate, left)| rate - left).collect();
            let mut later = respond(&at(self.equation, &self.stretches[i], &self.surface_rate, late_s));
            later.iter_mut().for_each(|value| *value *= by_surface);
            [respond(&rate), later].map(|raw| Signal::new(raw, filter).without(&found.own[i])).into()
        };
        (0..self.stretches.len()).map(of).collect()
    }

    /// By how much the damping and the time have to change.
    fn change(&self, found: &Solved, filter: &[f64]) -> Option<Point> {
        let slopes = self.slopes(found, filter);
        let count = self.equation.causes.len() + 3;
        let along =
            |c: usize, i: usize| dot(&column(&found.signals[i], &slopes[i], c).white, &found.residuals[i].white);
        let right = DVector::from_fn(count, |c, _| (0..slopes.len()).map(|i| along(c, i)).sum());
        let change = inverse(&normal(&found.signals, &slopes, count))? * right;
        let change = Point { damping: change[count - 2], late_s: change[count - 1] };
        (change.damping.is_finite() && change.late_s.is_finite()).then_some(change)
    }

    /// One sigma of the time, s, the larger of two: by the size of the residuals, and by what blocks of them do to the time.
    /// The second is larger if a term is missing, which shows where the surface moves.
    fn std_s(&self, found: &Solved, filter: &[f64], freedom: usize) -> Option<f64> {
        let slopes = self.slopes(found, filter);
        let count = self.equation.causes.len() + 3;
        let inverse = inverse(&normal(&found.signals, &slopes, count))?;
        let by_size = (found.squares / freedom.max(1) as f64 * inverse[(count - 1, count - 1)]).max(0.0).sqrt();
        let block = ((BLOCK_S / self.equation.step_s).round() as usize).max(1);
        let mut by_blocks = 0.0;
        for (i, residual) in found.residuals.iter().enumerate() {
            let influence = |k: usize| -> f64 {
                let part = |c: usize| column(&found.signals[i], &slopes[i], c).white[k] * inverse[(c, count - 1)];
                (0..count).map(part).sum::<f64>() * residual.white[k]
            };
            let all: Vec<f64> = (0..residual.white.len()).map(influence).collect();
            by_blocks += all.chunks(block).map(|chunk| chunk.iter().sum::<f64>().powi(2)).sum::<f64>();
        }
        Some(by_size.max(by_blocks.sqrt())).filter(|std_s| std_s.is_finite())
    }
}

/// The signal of a factor of one stretch: those of the linear part, then the slopes.
fn column<'a>(signals: &'a [Signal], slopes: &'a [Signal], c: usize) -> &'a Signal {
    if c < signals.len() { &signals[c] } else { &slopes[c - signals.len()] }
}

/// The normal matrix of the signals of all stretches.
fn normal(signals: &[Vec<Signal>], slopes: &[Vec<Signal>], count: usize) -> DMatrix<f64> {
    let mut normal = DMatrix::zeros(count, count);
    for (i, signals) in signals.iter().enumerate() {
        let slopes = slopes.get(i).map_or(&[][..], Vec::as_slice);
        for a in 0..count {
            for b in 0..=a {
                let entry = dot(&column(signals, slopes, a).white, &column(signals, slopes, b).white);
                normal[(a, b)] += entry;
                if a != b {
                    normal[(b, a)] += entry;
                }
            }
        }
    }
    normal
}

/// The inverse of a normal matrix, by columns of unit size. None if a column is zero: nothing is known of its factor.
fn inverse(normal: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if normal.diagonal().iter().any(|squares| *squares <= 0.0) {
        return None;
    }
    let (unit, inverse) = inverse_by_unit_size(normal.nrows(), |a, b| normal[(a, b)])?;
    let inverse = DMatrix::from_fn(normal.nrows(), normal.ncols(), |a, b| unit[a] * inverse[(a, b)] * unit[b]);
    Some(inverse).filter(|inverse| inverse.iter().all(|v| v.is_finite()))
}

/// `x' = damping x + cause` from `x = 0`, exact for a cause that is straight between its samples.
fn response(damping: f64, step_s: f64, cause: &[f64]) -> Vec<f64> {
    let z = damping * step_s;
    let decay = z.exp();
    // The parts of the cause at the beginning and at the end of a step, of which small ones cancel.
    let (begin, end) = if z.abs() < 1e-3 {
        (step_s * (0.5 + z / 3.0), step_s * (0.5 + z / 6.0))
    } else {
        let end = step_s * (decay - 1.0 - z) / (z * z);
        (step_s * (decay - 1.0) / z - end, end)
    };
    let mut x = 0.0;
    let mut out = Vec::with_capacity(cause.len());
    out.extend(cause.first().map(|_| 0.0));
    for pair in cause.windows(2) {
        x = decay * x + begin * pair[0] + end * pair[1];
        out.push(x);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.02;
    const FINE: usize = 20;

    /// Uniform numbers of variance one, from a congruential generator.
    fn random(mut seed: u64) -> impl FnMut() -> f64 {
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12_f64.sqrt()
        }
    }

    /// A well-damped short period (per s: Z_alpha = -2, M_alpha = -25, M_q = -10, M_elevator = -60) of half a minute behind
    /// an actuator of 20 rad/s: time, alpha and q with noise, and the elevator recorded so late.
    fn flight(late_s: f64, noise: f64, seed: u64) -> [Vec<f64>; 4] {
        let dt = STEP_S / FINE as f64;
        let (mut alpha, mut q, mut elevator) = (0.0, 0.0, 0.0);
        let mut fine = Vec::new();
        for k in 0..1500 * FINE {
            let command = match (k as f64 * dt % 12.0) as i32 {
                2..=4 => 0.03,
                5 | 6 | 8 => -0.03,
                7 => 0.03,
                _ => 0.0,
            };
            fine.push([alpha, q, elevator]);
            elevator += dt * 20.0 * (command - elevator);
            alpha += dt * (q - 2.0 * alpha - 0.2 * elevator);
            q += dt * (-25.0 * alpha - 10.0 * q - 60.0 * elevator);
        }
        let mut random = random(seed);
        let mut noisy = |i: usize| (0..1500).map(|k| fine[k * FINE][i] + noise * random()).collect::<Vec<f64>>();
        let late = (late_s / dt).round() as isize;
        let recorded = |k: usize| fine[((k * FINE) as isize - late).clamp(0, fine.len() as isize - 1) as usize][2];
        let time = (0..1500).map(|k| STEP_S * k as f64).collect();
        [time, noisy(0), noisy(1), (0..1500).map(recorded).collect()]
    }

    fn found([time_s, alpha, q, elevator]: &[Vec<f64>; 4]) -> Option<(f64, f64)> {
        late(Equation { time_s, step_s: STEP_S, rate: q, causes: vec![alpha.clone()], surface: elevator })
    }

    #[test]
    fn the_time_is_found_whatever_the_noise_of_the_rate() {
        for (late_s, noise) in [0.0, 0.02, -0.02, -0.01, 0.2].into_iter().flat_map(|late| [(late, 1e-5), (late, 4e-3)])
        {
            let (late, std) = found(&flight(late_s, noise, 3)).unwrap();
            // A millisecond: straight lines between samples of an actuator's motion are that far off.
            assert!((late - late_s).abs() < 3.0 * std + 1.5e-3, "{late_s} {noise}: {late} ± {std}");
            assert!(std < 4e-3, "{late_s} {noise}: {late} ± {std}");
        }
    }

    #[test]
    fn the_standard_error_is_that_of_the_times() {
        // Sixty flights of the same motion with other noise.
        let all: Vec<(f64, f64)> = (0..60).map(|seed| found(&flight(0.02, 2e-3, seed)).unwrap()).collect();
        let mean = |values: &dyn Fn(&(f64, f64)) -> f64| all.iter().map(values).sum::<f64>() / all.len() as f64;
        let late = mean(&|one| one.0);
        let (scatter, claimed) = (mean(&|one| (one.0 - late).powi(2)).sqrt(), mean(&|one| one.1));
        assert!((0.6..1.4).contains(&(scatter / claimed)), "{scatter} {claimed}");
        assert!((late - 0.02).abs() < 2e-3, "{late}");
    }

    #[test]
    fn what_says_nothing_gives_nothing() {
        let mut flight = flight(0.0, 1e-3, 3);
        let short = flight.clone().map(|channel| channel[..300].to_vec());
        assert_eq!(found(&short), None);
        flight[3].fill(0.01);
        assert_eq!(found(&flight), None, "the surface stands still");
    }

    #[test]
    fn the_response_to_a_straight_cause_is_exact() {
        let cause: Vec<f64> = (0..50).map(|k| 2.0 * f64::from(k) * 0.1).collect();
        for damping in [-1e-4, -0.5, -20.0] {
            let x = response(damping, 0.1, &cause);
            let t = 4.9;
            // x' = m x + 2 t
            let exact = 2.0 * ((damping * t).exp() - 1.0 - damping * t) / (damping * damping);
            assert!((x[49] / exact - 1.0).abs() < 1e-6, "{damping}: {} {exact}", x[49]);
        }
    }
}
