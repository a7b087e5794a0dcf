//! Which of two models has predicted the last seconds better.
//!
//! Bounds say how well an estimate is known if its model is right. Whether it is right, the aircraft says: its angular accelerations
//! over the last seconds against those that a model gives for the same feedback variables and surfaces, all through the same filter.
//! Compared are changes over three tenths of a second: what is out of trim, and a step of it, belongs to the integrators of the law.

use crate::local::{AXES, LocalModel, P, Q, R, SURFACES, VARIABLES};

/// Samples that are kept.
const LENGTH: usize = 60;
/// Time between two of them, s.
const EVERY: f64 = 0.05;
/// Time constant of the filter of everything, s: beyond it gyroscopes say more about their noise than about the aircraft. What is said
/// of now was so long ago.
pub const LAG: f64 = 0.08;
/// Samples of the short look: six tenths of a second.
const SHORT: usize = 12;
/// Samples between the two of a change.
const APART: usize = 6;
/// Samples without which nothing is said: a second of flight.
const FEWEST: usize = 20;
/// Parts of the last seconds whose means count as independent.
const BLOCKS: usize = 6;
/// So few say little of their own scatter: 95 % of a mean of six lie within 2.571 standard errors (Student, five degrees of freedom), and
/// within 1.960 of one that is known. With this factor a bound of two standard errors means the same everywhere.
const STUDENT: f64 = 2.571 / 1.960;

/// What was flown in the last seconds, on average.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Steady {
    /// The feedback variables, rad and rad/s.
    pub variables: [f64; VARIABLES],
    /// Positions of elevator, aileron and rudder, rad.
    pub surfaces: [f64; SURFACES],
    /// Roll, pitch and yaw acceleration, rad/s^2.
    pub accelerations: [f64; AXES],
    /// One standard error of the mean of what a model leaves of the accelerations, rad/s^2: gusts, noise, terms that it does not have.
    pub noise: [f64; AXES],
    /// How long, s.
    pub duration: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    variables: [f64; VARIABLES],
    surfaces: [f64; SURFACES],
    accelerations: [f64; AXES],
    /// Since the row before, s.
    duration: f64,
}

impl Row {
    const ZERO: Self =
        Self { variables: [0.0; VARIABLES], surfaces: [0.0; SURFACES], accelerations: [0.0; AXES], duration: 0.0 };
}

/// The last three seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recent {
    rows: [Row; LENGTH],
    /// Number of rows ever taken.
    taken: usize,
    variables: [f64; VARIABLES],
    surfaces: [f64; SURFACES],
    /// Means of the filtered accelerations since the last row.
    accelerations: [f64; AXES],
    since: f64,
    started: bool,
}

impl Default for Recent {
    fn default() -> Self {
        Self {
            rows: [Row::ZERO; LENGTH],
            taken: 0,
            variables: [0.0; VARIABLES],
            surfaces: [0.0; SURFACES],
            accelerations: [0.0; AXES],
            since: 0.0,
            started: false,
        }
    }
}

impl Recent {
    /// Nothing was seen yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes a frame: feedback variables (rad, rad/s) and surface positions (rad). A frame with a value that is no number is left
    /// out.
    pub fn update(&mut self, variables: &[f64; VARIABLES], surfaces: &[f64; SURFACES], sample_time: f64) {
        if !variables.iter().chain(surfaces).all(|value| value.is_finite()) {
            return;
        }
        if !self.started {
            (self.variables, self.surfaces, self.started) = (*variables, *surfaces, true);
        }
        let share = 1.0 - libm::exp(-sample_time / LAG);
        for (j, axis) in [P, Q, R].into_iter().enumerate() {
            self.accelerations[j] = share * (variables[axis] - self.variables[axis]) / sample_time;
        }
        for j in 0..VARIABLES {
            self.variables[j] += share * (variables[j] - self.variables[j]);
        }
        for j in 0..SURFACES {
            self.surfaces[j] += share * (surfaces[j] - self.surfaces[j]);
        }
        self.since += sample_time;
        if self.since < EVERY {
            return;
        }
        let row = Row {
            variables: self.variables,
            surfaces: self.surfaces,
            accelerations: self.accelerations,
            duration: self.since,
        };
        self.since = 0.0;
        if let Some(place) = self.rows.get_mut(self.taken % LENGTH) {
            *place = row;
        }
        self.taken = self.taken.saturating_add(1);
    }

    /// Root mean square of what a model leaves unexplained of the changes of roll, pitch and yaw acceleration, rad/s^2, and the root
    /// mean square of these themselves; `None` before a second of flight.
    pub fn unexplained(&self, model: &LocalModel) -> Option<([f64; AXES], [f64; AXES])> {
        self.unexplained_of(model, LENGTH)
    }

    /// The same of the last rows, so many at most.
    fn unexplained_of(&self, model: &LocalModel, most: usize) -> Option<([f64; AXES], [f64; AXES])> {
        if self.taken < FEWEST {
            return None;
        }
        let count = self.taken.min(LENGTH).saturating_sub(APART).min(most);
        let (mut squares, mut moved) = ([0.0; AXES], [0.0; AXES]);
        for back in 1..=count {
            let place = |back: usize| self.rows.get(self.taken.wrapping_sub(back) % LENGTH);
            let Some((now, before)) = place(back).zip(place(back + APART)) else { continue };
            for i in 0..AXES {
                let modelled: f64 = (0..VARIABLES)
                    .map(|j| model.rates[i][j] * (now.variables[j] - before.variables[j]))
                    .sum::<f64>()
                    + (0..SURFACES).map(|j| model.surfaces[i][j] * (now.surfaces[j] - before.surfaces[j])).sum::<f64>();
                let change = now.accelerations[i] - before.accelerations[i];
                squares[i] += (change - modelled) * (change - modelled);
                moved[i] += change * change;
            }
        }
        let n = count.max(1) as f64;
        Some((squares.map(|square| libm::sqrt(square / n)), moved.map(|square| libm::sqrt(square / n))))
    }

    /// Whether a model explains the last six tenths of a second much better than another: about some axis the other leaves more than half of
    /// `floor` (rad/s^2: what noise and gusts make) unexplained, and this one less than half of that. False before a second of flight.
    pub fn explains_much_better(&self, other: &LocalModel, model: &LocalModel, floor: [f64; AXES]) -> bool {
        let left = |of: &LocalModel| Some(self.unexplained_of(of, SHORT)?.0);
        let Some((other, this)) = left(other).zip(left(model)) else { return false };
        (0..AXES).any(|i| other[i] > 0.5 * floor[i] && this[i] < 0.5 * other[i])
    }

    /// What was flown in the last three seconds, on average, and how well a model's slopes say what was left of the angular
    /// accelerations beside rates and surfaces. `None` before a second of flight.
    pub fn steady(&self, model: &LocalModel) -> Option<Steady> {
        if self.taken < FEWEST {
            return None;
        }
        let count = self.taken.min(LENGTH);
        // The oldest row first.
        let row = |k: usize| self.rows.get((self.taken - count + k) % LENGTH);
        let mut steady = Steady::default();
        for row in (0..count).filter_map(row) {
            steady.duration += row.duration;
            (0..VARIABLES).for_each(|j| steady.variables[j] += row.variables[j] / count as f64);
            (0..SURFACES).for_each(|j| steady.surfaces[j] += row.surfaces[j] / count as f64);
            (0..AXES).for_each(|i| steady.accelerations[i] += row.accelerations[i] / count as f64);
        }
        // What gusts and bent tables leave is of one sign for some tenths of a second: means of blocks are independent, single rows
        // are not.
        let of_block = count / BLOCKS;
        let mut squares = [0.0; AXES];
        for block in 0..BLOCKS {
            let mut sums = [0.0; AXES];
            for row in (block * of_block..(block + 1) * of_block).filter_map(row) {
                for (i, sum) in sums.iter_mut().enumerate() {
                    let modelled = (0..VARIABLES)
                        .map(|j| model.rates[i][j] * (row.variables[j] - steady.variables[j]))
                        .sum::<f64>()
                        + (0..SURFACES)
                            .map(|j| model.surfaces[i][j] * (row.surfaces[j] - steady.surfaces[j]))
                            .sum::<f64>();
                    *sum += row.accelerations[i] - steady.accelerations[i] - modelled;
                }
            }
            (0..AXES).for_each(|i| squares[i] += (sums[i] / of_block as f64) * (sums[i] / of_block as f64));
        }
        steady.noise = squares.map(|square| STUDENT * libm::sqrt(square / ((BLOCKS - 1) * BLOCKS) as f64));
        Some(steady)
    }

    /// Whether a model has explained the last three seconds, in the sense of [`explains`](Self::explains). An estimate that has not
    /// says nothing of the aircraft, whatever its bounds are.
    pub fn has_explained(&self, model: &LocalModel, floor: [f64; AXES]) -> bool {
        self.is_explained(model, LENGTH, floor)
    }

    /// Whether a model explains the last six tenths of a second: of the changes of angular acceleration of each axis half at least, or all but
    /// the given `floor` (rad/s^2), which is what noise and gusts make. Just after damage no model does, and an estimate in transit is
    /// none to act on. Before a second of flight everything is explained.
    pub fn explains(&self, model: &LocalModel, floor: [f64; AXES]) -> bool {
        self.is_explained(model, SHORT, floor)
    }

    fn is_explained(&self, model: &LocalModel, most: usize, floor: [f64; AXES]) -> bool {
        match self.unexplained_of(model, most) {
            None => true,
            Some((left, moved)) => (0..AXES).all(|i| left[i] <= (0.5 * moved[i]).max(floor[i])),
        }
    }

    /// Whether `new` has predicted the last seconds at least as well as `now`: on no axis a fifth worse (three seconds tell two
    /// models apart no better than that). Before a second of flight nothing speaks against it.
    pub fn prefers(&self, now: &LocalModel, new: &LocalModel) -> bool {
        let Some(((before, _), (after, _))) = self.unexplained(now).zip(self.unexplained(new)) else { return true };
        before.iter().zip(after).all(|(before, after)| after.is_finite() && after <= 1.2 * before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::tests::fighter;

    /// Flies a linear aircraft with moving surfaces and looks which model explains it.
    #[test]
    fn the_model_that_flew_is_preferred() {
        let truth = fighter();
        let mut wrong = truth;
        wrong.rates[0][4] = -6.0;
        wrong.surfaces[1][0] = -5.0;
        let mut recent = Recent::new();
        assert!(recent.prefers(&truth, &wrong), "nothing was flown yet");
        let a = truth.closed_loop(&[[0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 5], [0.0; 5]]);
        let mut x = [0.0; 6];
        for k in 0..400 {
            let t = 0.01 * f64::from(k);
            let u =
                [0.02 * libm::sin(2.0 * t) + 6.0 / 11.0 * x[0], 0.02 * libm::sin(3.1 * t), 0.03 * libm::sin(1.7 * t)];
            recent.update(&[x[0], x[1], x[3], x[4], x[5]], &u, 0.01);
            for _ in 0..10 {
                let mut rate = [0.0; 6];
                for i in 0..6 {
                    rate[i] = (0..6).map(|j| a[i][j] * x[j]).sum();
                }
                for i in 0..3 {
                    rate[3 + i] += (0..3).map(|j| truth.surfaces[i][j] * u[j]).sum::<f64>();
                }
                (0..6).for_each(|i| x[i] += 0.001 * rate[i]);
            }
        }
        let (left, moved) = recent.unexplained(&truth).unwrap();
        assert!(left.iter().zip(moved).all(|(left, moved)| *left < 0.1 * moved), "{left:?} {moved:?}");
        assert!(recent.has_explained(&truth, [0.0; 3]) && !recent.has_explained(&wrong, [0.0; 3]));
        assert!(recent.prefers(&wrong, &truth) && !recent.prefers(&truth, &wrong));
        let better =
            |other: &LocalModel, model: &LocalModel, floor| recent.explains_much_better(other, model, [floor; 3]);
        assert!(better(&wrong, &truth, 0.01) && !better(&truth, &wrong, 0.0) && !better(&wrong, &truth, 10.0));
        // With the slopes of the truth nothing but the filter's edges is left, with wrong ones more.
        let noise = recent.steady(&truth).unwrap().noise;
        assert!(noise.iter().zip(moved).all(|(noise, moved)| *noise < 0.05 * moved), "{noise:?} {moved:?}");
        assert!(recent.steady(&wrong).unwrap().noise[1] > 3.0 * noise[1]);
        assert!(!recent.prefers(&truth, &LocalModel { rates: [[f64::NAN; 5]; 3], ..truth }));
    }
}
