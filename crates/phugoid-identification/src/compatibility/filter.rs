//! An extended Kalman filter over the kinematics, with the derivatives of its innovations by the unknowns.
//!
//! The states are the motion and three gusts. The noise of the inertial sensors drives the motion, and white noise the
//! gusts (Gauss-Markov), so that nothing is integrated freely. The unknowns are constants of the filter and no states:
//! its innovations `e` are linear in small changes of them, `e(c + d) = e(c) - psi d`, with `psi = H U + D` and the
//! sensitivity `U = dx/dc`, which follows `U <- A U + B` in a prediction and `U <- U - K psi` in a correction. The
//! maximum of the likelihood of the innovations is then a problem of least squares (`super::solve`), and since `psi`
//! depends on the past alone, its residuals are white where the noise levels are right.

use super::kinematics::place::GUST_BY_FORCE;
use super::kinematics::{BANK, BODY, GUST_LAG, Inertial, Kinematics, OUTPUTS, PARAMETERS, SENSORS, STATES};
use super::signals::Flight;

/// Innovations beyond this many of their sigmas count with this alone (Huber).
pub(super) const HUBER: f64 = 3.0;

/// Length over which gusts change, m (MIL-F-8785C above 2000 ft).
pub(super) const GUST_LENGTH_M: f64 = 533.0;

/// Time over which a bank that nobody recorded changes, s.
const BANK_S: f64 = 15.0;

/// Samples of this many seconds make a block, whose innovations are added up for the sandwich and for the samples that
/// are held out.
pub(super) const BLOCK_S: f64 = 1.0;

pub(super) type State = [f64; STATES];
pub(super) type Square = [[f64; STATES]; STATES];

/// Noise levels, one sigma each.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Levels {
    /// Of the outputs; none for one that is not used.
    pub(super) outputs: [Option<f64>; OUTPUTS],
    /// Of the gusts along body x, y and z, m/s.
    pub(super) gusts: [f64; 3],
    /// By what the noise of the accelerometers and of the gyroscopes, measured in their own signals, is multiplied.
    pub(super) inertial: [f64; 2],
    /// Scale length of the gusts, m.
    pub(super) length: f64,
    /// Of `1 - cos phi` where the bank was not recorded.
    pub(super) bank: f64,
}

impl Levels {
    pub(super) const fn start(outputs: [Option<f64>; OUTPUTS]) -> Self {
        Self { outputs, gusts: [1.5; 3], inertial: [1.0; 2], length: GUST_LENGTH_M, bank: 0.005 }
    }
}

/// What the filter met at a sample, for another run along the same line with other noise levels.
pub(super) struct Step {
    pub(super) fresh: bool,
    /// From the sample before, s.
    pub(super) interval: f64,
    /// From the sample before; the air is not in it, since it depends on the levels.
    pub(super) transition: Square,
    /// What noise of the inertial sensors over the interval does to the motion.
    pub(super) shake: [[f64; SENSORS]; BODY],
    /// The filtered state of the sample before.
    pub(super) from: State,
    pub(super) predicted: State,
    pub(super) filtered: State,
    pub(super) error: [f64; OUTPUTS],
    pub(super) by_state: [[f64; STATES]; OUTPUTS],
}

/// Information of the innovations of a block about the unknowns.
#[derive(Clone)]
pub(super) struct Block {
    /// `sum psi^T psi / s`, by pairs of columns.
    pub(super) information: Vec<f64>,
    /// `sum psi^T e / s`.
    pub(super) score: Vec<f64>,
}

/// One run of the filter over a flight.
pub(super) struct Run {
    /// `sum 2 rho(xi) + ln s`: twice the negative logarithm of the likelihood.
    pub(super) cost: f64,
    pub(super) steps: Vec<Step>,
    pub(super) blocks: Vec<Block>,
    /// What the smoother needs; empty if it was not asked for.
    pub(super) course: Vec<Course>,
}

/// Covariance and sensitivity at a sample, before and after its measurements.
pub(super) struct Course {
    pub(super) predicted: Square,
    pub(super) filtered: Square,
    /// State by column.
    pub(super) predicted_by: Vec<f64>,
    pub(super) filtered_by: Vec<f64>,
}

/// `2 rho(xi)` of Huber's function.
fn twice_rho(xi: f64) -> f64 {
    let size = xi.abs();
    if size <= HUBER { xi * xi } else { 2.0 * HUBER * size - HUBER * HUBER }
}

fn weight(xi: f64) -> f64 {
    // Far outliers count even less: a wild value must not pull on.
    let size = xi.abs();
    if size <= HUBER {
        1.0
    } else if size <= 4.0 * HUBER {
        HUBER / size
    } else {
        4.0 * HUBER * HUBER / (size * size)
    }
}

/// The variances at a beginning.
fn beginning(flight: &Flight, levels: &Levels) -> Square {
    let across = 0.1 * flight.speed;
    let [u, v, w] = levels.gusts;
    let std = [across, across, across, 0.2, 0.2, 0.2, 100.0, 100.0, 100.0, u, v, w, 0.5 * v, 0.5 * w, levels.bank];
    let mut p = [[0.0; STATES]; STATES];
    for i in &flight.active {
        p[*i][*i] = std[*i] * std[*i];
    }
    // Of the gust and its second state: (sqrt(3) + 1 - sqrt(3))/4.
    for (gust, lag, sigma) in [(BODY + 1, GUST_LAG, v), (BODY + 2, GUST_LAG + 1, w)] {
        if p[gust][gust] > 0.0 {
            p[gust][lag] = 0.25 * sigma * sigma;
            p[lag][gust] = p[gust][lag];
        }
    }
    p
}

/// What the air and an unrecorded bank do over an interval `h`, s.
///
/// Gusts have the spectra of Dryden (MIL-F-8785C): along body x a lag of the first order; along y and z
/// `(1 + sqrt(3) T s)/(1 + T s)^2`, here with the gust `g` and the second lag `l` as states:
/// `g' = -(2 - 1/sqrt(3)) (g - b l)/T - b l/T + noise`, `l' = ((g - b l)/sqrt(3) - l)/T`, `b = 1 - sqrt(3)`.
fn air(flight: &Flight, levels: &Levels, h: f64, transition: &mut Square) -> State {
    let part = h * flight.speed / levels.length;
    let fading = (-part).exp();
    let a = 3.0_f64.sqrt();
    let b = 1.0 - a;
    let mut noise = [0.0; STATES];
    transition[BODY][BODY] = fading;
    noise[BODY] = levels.gusts[0].powi(2) * (1.0 - fading * fading);
    // d/dt of (g, l), in units of T, and its exponential to the second order.
    let m = [[(b - a) / a, -(b - a) / a * b - b], [1.0 / a, -b / a - 1.0]];
    let square = |i: usize, j: usize| m[i][0] * m[0][j] + m[i][1] * m[1][j];
    for (gust, lag, sigma) in [(BODY + 1, GUST_LAG, levels.gusts[1]), (BODY + 2, GUST_LAG + 1, levels.gusts[2])] {
        let places = [gust, lag];
        for (i, row) in places.into_iter().enumerate() {
            for (j, column) in places.into_iter().enumerate() {
                let own = if i == j { 1.0 } else { 0.0 };
                transition[row][column] = own + part * (m[i][j] + 0.5 * part * square(i, j));
            }
        }
        noise[gust] = 3.0 * sigma * sigma * part;
    }
    let fading = (-h / BANK_S).exp();
    transition[BANK][BANK] = fading;
    noise[BANK] = levels.bank.powi(2) * (1.0 - fading * fading);
    noise
}

/// `A P A^T` and the noise of an interval.
fn predicted(flight: &Flight, levels: &Levels, step: &Step, transition: &Square, noise: &State, p: &Square) -> Square {
    let active = &flight.active;
    let mut ap = [[0.0; STATES]; STATES];
    for &i in active {
        for &k in active {
            let a = transition[i][k];
            if a != 0.0 {
                for &j in active {
                    ap[i][j] += a * p[k][j];
                }
            }
        }
    }
    let variance: [f64; SENSORS] = std::array::from_fn(|s| (flight.inertial_noise[s] * levels.inertial[s / 3]).powi(2));
    let mut next = [[0.0; STATES]; STATES];
    for (n, &i) in active.iter().enumerate() {
        for &j in &active[..=n] {
            let mut sum = if i == j { noise[i] } else { 0.0 };
            for &k in active {
                sum += ap[i][k] * transition[j][k];
            }
            if i < BODY {
                for s in 0..SENSORS {
                    sum += step.shake[i][s] * step.shake[j][s] * variance[s];
                }
            }
            next[i][j] = sum;
            next[j][i] = sum;
        }
    }
    next
}

/// The gain of one output: variance of its innovation, and `P H^T` over it.
fn gain(active: &[usize], p: &Square, h: &State, noise: f64) -> (f64, State) {
    let mut k = [0.0; STATES];
    let mut s = noise * noise;
    for &i in active {
        k[i] = active.iter().map(|&j| p[i][j] * h[j]).sum();
        s += h[i] * k[i];
    }
    for &i in active {
        k[i] /= s;
    }
    (s, k)
}

fn take(active: &[usize], p: &mut Square, k: &State, s: f64) {
    for (n, &i) in active.iter().enumerate() {
        for &j in &active[..=n] {
            let value = p[i][j] - k[i] * k[j] * s;
            p[i][j] = value;
            p[j][i] = value;
        }
    }
}

/// Inertial signals a time before sample `k`, s, on straight lines between samples; at the ends those of the end.
pub(super) fn before(flight: &Flight, k: usize, delay: f64) -> Inertial {
    let wanted = flight.time[k] - delay;
    let mut at = k;
    while at > 0 && !flight.fresh[at] && flight.time[at] > wanted {
        at -= 1;
    }
    while at + 1 < flight.time.len() && !flight.fresh[at + 1] && flight.time[at + 1] <= wanted {
        at += 1;
    }
    match flight.time.get(at + 1) {
        Some(next) if !flight.fresh[at + 1] && wanted > flight.time[at] => {
            let part = (wanted - flight.time[at]) / (next - flight.time[at]);
            flight.inputs[at].between(&flight.inputs[at + 1], part.min(1.0))
        }
        _ => flight.inputs[at],
    }
}

/// Runs the filter over a flight. `columns`: the places of the unknowns whose derivatives are wanted.
pub(super) fn run(
    flight: &Flight,
    theta: &[f64; PARAMETERS],
    levels: &Levels,
    columns: &[usize],
    with_course: bool,
) -> Run {
    let kinematics = Kinematics { gravity: flight.gravity.value, curvature: flight.curvature };
    let (m, active) = (columns.len(), &flight.active);
    let mut result =
        Run { cost: 0.0, steps: Vec::with_capacity(flight.time.len()), blocks: Vec::new(), course: Vec::new() };
    let mut x = [0.0; STATES];
    let mut p = [[0.0; STATES]; STATES];
    let mut by = vec![0.0; STATES * m];
    let mut scratch = vec![0.0; STATES * m];
    let mut psi = vec![0.0; m];
    let mut block_end = f64::NEG_INFINITY;
    for (k, &time) in flight.time.iter().enumerate() {
        let mut step = Step {
            fresh: flight.fresh[k],
            interval: 0.0,
            transition: [[0.0; STATES]; STATES],
            shake: [[0.0; SENSORS]; BODY],
            from: x,
            predicted: x,
            filtered: x,
            error: [f64::NAN; OUTPUTS],
            by_state: [[0.0; STATES]; OUTPUTS],
        };
        if step.fresh {
            x = flight.beginning(k);
            p = beginning(flight, levels);
            by.fill(0.0);
        } else {
            let h = time - flight.time[k - 1];
            let moved = kinematics.step(&x, theta, &flight.inputs[k - 1], &flight.inputs[k], h);
            step.interval = h;
            for i in 0..BODY {
                step.transition[i] = moved.transition[i];
                // A bias of the sensor over the interval acts as the noise of one sample does until the next.
                step.shake[i].copy_from_slice(&moved.by_parameter[i][..SENSORS]);
            }
            let noise = air(flight, levels, h, &mut step.transition);
            p = predicted(flight, levels, &step, &step.transition, &noise, &p);
            let from = x;
            for &i in active {
                let row = &mut scratch[i * m..(i + 1) * m];
                if i < BODY {
                    x[i] = moved.state[i];
                    for (value, c) in row.iter_mut().zip(columns) {
                        *value = moved.by_parameter[i][*c];
                    }
                } else {
                    x[i] = active.iter().map(|&j| step.transition[i][j] * from[j]).sum();
                    row.fill(0.0);
                    // A gust shows in the forces at once: they are no input that knows nothing of it.
                    if i < BODY + 3 {
                        let axis = i - BODY;
                        let change = flight.inputs[k].force[axis] - flight.inputs[k - 1].force[axis];
                        x[i] += theta[GUST_BY_FORCE + axis] * change;
                        if let Some(c) = columns.iter().position(|c| *c == GUST_BY_FORCE + axis) {
                            row[c] = change;
                        }
                    }
                }
                for &j in active {
                    let a = step.transition[i][j];
                    if a != 0.0 {
                        for (value, u) in row.iter_mut().zip(&by[j * m..(j + 1) * m]) {
                            *value += a * u;
                        }
                    }
                }
            }
            for &i in active {
                by[i * m..(i + 1) * m].copy_from_slice(&scratch[i * m..(i + 1) * m]);
            }
        }
        step.predicted = x;
        let mut course = with_course.then(|| Course {
            predicted: p,
            filtered: p,
            predicted_by: by.clone(),
            filtered_by: Vec::new(),
        });
        if time >= block_end {
            block_end = time + BLOCK_S;
            result.blocks.push(Block { information: vec![0.0; m * m], score: vec![0.0; m] });
        }
        let shown = kinematics.shown(&x, theta, &|delay| before(flight, k, delay));
        let reference = x;
        for i in 0..OUTPUTS {
            let (Some(noise), true) = (levels.outputs[i], flight.outputs[k][i].is_finite()) else { continue };
            let h = &shown.by_state[i];
            step.by_state[i] = *h;
            let error = flight.outputs[k][i] - shown.outputs[i];
            step.error[i] = error;
            let moved: f64 = active.iter().map(|&j| h[j] * (x[j] - reference[j])).sum();
            let e = error - moved;
            let (s, gain) = gain(active, &p, h, noise);
            let xi = e / s.sqrt();
            let w = weight(xi);
            result.cost += twice_rho(xi) + s.ln();
            for (value, c) in psi.iter_mut().zip(columns) {
                *value = shown.by_parameter[i][*c];
            }
            for &j in active {
                if h[j] != 0.0 {
                    for (value, u) in psi.iter_mut().zip(&by[j * m..(j + 1) * m]) {
                        *value += h[j] * u;
                    }
                }
            }
            if let Some(block) = result.blocks.last_mut() {
                for a in 0..m {
                    let scaled = w * psi[a] / s;
                    block.score[a] += scaled * e;
                    for (value, b) in block.information[a * m..(a + 1) * m].iter_mut().zip(&psi) {
                        *value += scaled * b;
                    }
                }
            }
            for &j in active {
                let g = w * gain[j];
                x[j] += g * e;
                for (u, value) in by[j * m..(j + 1) * m].iter_mut().zip(&psi) {
                    *u -= g * value;
                }
            }
            take(active, &mut p, &gain, w * s);
        }
        step.filtered = x;
        if let Some(mut course) = course.take() {
            course.filtered = p;
            course.filtered_by.clone_from(&by);
            result.course.push(course);
        }
        result.steps.push(step);
    }
    result
}

/// Cost, innovations and their variances of a run along the same line with other noise levels.
pub(super) struct Replay {
    pub(super) cost: f64,
    /// Innovation and its variance, by sample and output in this order.
    pub(super) innovations: Vec<(f64, f64)>,
}

/// Repeats a run with other noise levels, linear about the states that it met.
pub(super) fn replay(flight: &Flight, steps: &[Step], levels: &Levels) -> Replay {
    let active = &flight.active;
    let mut result = Replay { cost: 0.0, innovations: Vec::with_capacity(steps.len() * OUTPUTS) };
    // Distance from the states of the run.
    let mut x = [0.0; STATES];
    let mut p = [[0.0; STATES]; STATES];
    for step in steps {
        if step.fresh {
            x = [0.0; STATES];
            p = beginning(flight, levels);
        } else {
            let from = x;
            let mut transition = step.transition;
            let noise = air(flight, levels, step.interval, &mut transition);
            // The reference of the air is the state of the run, which faded with the levels of that run.
            for &i in active {
                x[i] = active.iter().map(|&j| transition[i][j] * from[j]).sum();
            }
            for &i in active.iter().filter(|i| **i >= BODY) {
                let last = &step.from;
                x[i] += active.iter().map(|&j| (transition[i][j] - step.transition[i][j]) * last[j]).sum::<f64>();
            }
            p = predicted(flight, levels, step, &transition, &noise, &p);
        }
        for i in 0..OUTPUTS {
            let (Some(noise), true) = (levels.outputs[i], step.error[i].is_finite()) else { continue };
            let h = &step.by_state[i];
            let e = step.error[i] - active.iter().map(|&j| h[j] * x[j]).sum::<f64>();
            let (s, gain) = gain(active, &p, h, noise);
            let xi = e / s.sqrt();
            let w = weight(xi);
            result.cost += twice_rho(xi) + s.ln();
            result.innovations.push((e, s));
            for &j in active {
                x[j] += w * gain[j] * e;
            }
            take(active, &mut p, &gain, w * s);
        }
        // From here on the distance counts from the filtered state of the run.
        for &i in active {
            x[i] -= step.filtered[i] - step.predicted[i];
        }
    }
    result
}
