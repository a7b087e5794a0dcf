//! The search: differential evolution over the unit cube, one generation at a time.
//!
//! R. Storn, K. Price, *Differential Evolution*, J. Global Optimization 11 (1997), in the form current-to-pbest/1 with
//! binomial crossover (J. Zhang, A. Sanderson, *JADE*, IEEE Trans. Evol. Comp. 13 (2009)), without its adaptation.
//!
//! It suits the task: two to seven settings, some of them words, an objective with steps in it (a run converges or does
//! not) that costs a tenth of a second and can be had many times at once. What a generation asks depends on nothing but
//! the state and the seed, so that a search that was stopped and continued is the search that was not.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// Crossover probability: the settings of one method act together.
const CROSSOVER: f64 = 0.9;
/// The scale of differences is drawn from this interval for each trial.
const SCALE: [f64; 2] = [0.4, 0.9];
/// Trials are drawn towards one of the best of this part of the population.
const BEST_PART: f64 = 0.25;
/// One standard deviation of the first generation's near half about the rule, in unit cube lengths.
const NEAR: f64 = 0.1;

/// A point of the unit cube that has been evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Coordinates in the unit cube, one per setting, each from 0 (lower limit) to 1 (upper limit).
    pub point: Vec<f64>,
    /// Its score; lower is better.
    pub score: f64,
}

/// A search between two generations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Search {
    /// Seed of the search's random numbers; the same seed gives the same search.
    pub seed: u64,
    /// Number of generations that have been evaluated so far.
    pub generation: u64,
    /// Number of points that have been evaluated so far, over all generations.
    pub evaluations: usize,
    /// Best score after each generation.
    pub best_scores: Vec<f64>,
    /// Where it starts: what the rule says.
    pub start: Vec<f64>,
    /// The population, empty before the first generation.
    pub population: Vec<Member>,
}

impl Search {
    /// A search that starts from a point, which the first generation evaluates before all others.
    pub fn new(start: Vec<f64>, seed: u64) -> Self {
        Self { seed, generation: 0, evaluations: 0, best_scores: Vec::new(), start, population: Vec::new() }
    }

    /// Points per generation for this many settings.
    pub fn population_size(settings: usize) -> usize {
        (3 * settings).max(12)
    }

    /// The points that the next generation evaluates.
    pub fn ask(&self) -> Vec<Vec<f64>> {
        if self.population.is_empty() {
            return self.first();
        }
        // Best first; equal scores in the order of the population.
        let mut order: Vec<usize> = (0..self.population.len()).collect();
        order.sort_by(|a, b| self.population[*a].score.total_cmp(&self.population[*b].score));
        let best = ((BEST_PART * order.len() as f64).ceil() as usize).max(1);
        (0..self.population.len()).map(|i| self.trial(i, &order[..best])).collect()
    }

    /// Takes the scores of the points that [`Search::ask`] gave, in their order.
    pub fn tell(&mut self, points: Vec<Vec<f64>>, scores: &[f64]) {
        self.evaluations += points.len();
        let trials = points.into_iter().zip(scores).map(|(point, score)| Member { point, score: *score });
        if self.population.is_empty() {
            self.population = trials.collect();
        } else {
            for (member, trial) in self.population.iter_mut().zip(trials) {
                // Equal is taken: it lets the population cross plateaus.
                if trial.score <= member.score {
                    *member = trial;
                }
            }
        }
        self.generation += 1;
        self.best_scores.push(self.best().map_or(f64::INFINITY, |member| member.score));
    }

    /// The best member; none before the first generation.
    pub fn best(&self) -> Option<&Member> {
        self.population.iter().min_by(|a, b| a.score.total_cmp(&b.score))
    }

    /// Whether this can have come about by [`Search::ask`] and [`Search::tell`]: of a search that was read from a file.
    ///
    /// # Errors
    /// What contradicts what, in words.
    pub fn consistent(&self) -> Result<(), String> {
        let points = std::iter::once(&self.start).chain(self.population.iter().map(|member| &member.point));
        if !points.flatten().all(|x| (0.0..=1.0).contains(x)) {
            return Err("one of its points lies outside 0 to 1".to_owned());
        }
        let evaluations = (self.generation as usize).checked_mul(Self::population_size(self.start.len()));
        if evaluations != Some(self.evaluations) || self.best_scores.len() as u64 != self.generation {
            return Err(format!(
                "its {} generations, {} evaluations and {} best scores do not belong together",
                self.generation,
                self.evaluations,
                self.best_scores.len()
            ));
        }
        if self.best_scores.last().copied() != self.best().map(|member| member.score) {
            return Err("its best score is not that of its population".to_owned());
        }
        Ok(())
    }

    fn random(&self, member: usize) -> Pcg64Mcg {
        // A stream of its own for every trial of every generation.
        let mix = (self.generation << 20) ^ member as u64;
        Pcg64Mcg::seed_from_u64(self.seed ^ mix.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// The rule, half of the others near it, the rest spread over the cube as a Latin hypercube.
    fn first(&self) -> Vec<Vec<f64>> {
        let count = Self::population_size(self.start.len());
        let mut random = self.random(count);
        let near = count / 2;
        let spread = count - 1 - near;
        let mut points = vec![self.start.clone()];
        for _ in 0..near {
            // The sum of three uniform numbers is normal enough.
            let mut step = || NEAR * 2.0 * (0..3).map(|_| random.random::<f64>() - 0.5).sum::<f64>();
            points.push(self.start.iter().map(|x| (x + step()).clamp(0.0, 1.0)).collect());
        }
        let mut far = vec![vec![0.0; self.start.len()]; spread];
        for dimension in 0..self.start.len() {
            let mut strata: Vec<usize> = (0..spread).collect();
            for i in (1..spread).rev() {
                strata.swap(i, random.random_range(0..=i));
            }
            for (point, stratum) in far.iter_mut().zip(strata) {
                point[dimension] = (stratum as f64 + random.random::<f64>()) / spread as f64;
            }
        }
        points.extend(far);
        points
    }

    fn trial(&self, i: usize, best: &[usize]) -> Vec<f64> {
        let mut random = self.random(i);
        let count = self.population.len();
        let leader = &self.population[best[random.random_range(0..best.len())]].point;
        let mut other = |not: usize| loop {
            let j = random.random_range(0..count);
            if j != i && j != not {
                break j;
            }
        };
        let first = other(i);
        let second = other(first);
        let (a, b) = (&self.population[first].point, &self.population[second].point);
        let own = &self.population[i].point;
        let scale = SCALE[0] + (SCALE[1] - SCALE[0]) * random.random::<f64>();
        let certain = random.random_range(0..own.len());
        (0..own.len())
            .map(|d| {
                let crossed = random.random::<f64>() < CROSSOVER || d == certain;
                if !crossed {
                    return own[d];
                }
                let moved = own[d] + scale * (leader[d] - own[d]) + scale * (a[d] - b[d]);
                // Back inside: half way from where it was to the wall that it would have passed.
                if moved < 0.0 {
                    0.5 * own[d]
                } else if moved > 1.0 {
                    0.5 * (own[d] + 1.0)
                } else {
                    moved
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(search: &mut Search, generations: usize, score: impl Fn(&[f64]) -> f64) {
        for _ in 0..generations {
            let points = search.ask();
            let scores: Vec<f64> = points.iter().map(|p| score(p)).collect();
            search.tell(points, &scores);
        }
    }

    /// A narrow valley, a hundred times as steep across as along.
    fn valley(x: &[f64]) -> f64 {
        x.windows(2).map(|w| 100.0 * (w[1] - 0.7 * w[0]).powi(2) + (w[0] - 0.7).powi(2)).sum()
    }

    #[test]
    fn it_finds_the_floor_of_a_valley_and_never_gets_worse() {
        // With y = 0.7 x, z = 0.7 y: (x - 0.7)^2 + (0.7 x - 0.7)^2 is least at x = 1.19/1.49, where it is 0.0296; leaving the
        // bottom of the valley a little makes that 0.0294.
        let mut found = 0;
        for seed in 0..10 {
            let mut search = Search::new(vec![0.1, 0.9, 0.5], seed);
            run(&mut search, 80, valley);
            let scores = &search.best_scores;
            assert!(scores.windows(2).all(|w| w[1] <= w[0]));
            assert!(scores[0] <= valley(&[0.1, 0.9, 0.5]), "the start itself is evaluated");
            let best = search.best().unwrap();
            assert!(best.score > 0.0293 && best.score < 0.3, "seed {seed}: {best:?}");
            found += usize::from(best.score < 0.03);
        }
        // A population of twelve now and then crowds together too early: one search in ten.
        assert!(found >= 8, "{found} of 10");
    }

    #[test]
    fn steps_and_failed_runs_do_not_stop_it() {
        // A plateau with a small hole, and a region that fails.
        let score = |x: &[f64]| {
            if x[0] > 0.9 {
                12.0
            } else {
                let distance = x.iter().map(|v| (v - 0.3).powi(2)).sum::<f64>().sqrt();
                (10.0 * distance).floor()
            }
        };
        let mut search = Search::new(vec![0.95, 0.95], 3);
        run(&mut search, 25, score);
        assert_eq!(search.best().unwrap().score, 0.0);
    }

    #[test]
    fn the_next_generation_depends_on_the_state_alone() {
        let mut search = Search::new(vec![0.5; 4], 9);
        run(&mut search, 3, valley);
        let copy: Search = toml::from_str(&toml::to_string(&search).unwrap()).unwrap();
        assert_eq!(copy, search);
        assert_eq!(copy.ask(), search.ask());
        assert!(search.ask().iter().flatten().all(|v| (0.0..=1.0).contains(v)));
        let other = Search { seed: 10, ..search.clone() };
        assert_ne!(other.ask(), search.ask());
    }
}
