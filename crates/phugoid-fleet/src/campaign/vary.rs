//! Factors of a campaign: where in a file a value is put, and which values.

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// Which file a factor changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// The scenario that is flown.
    Scenario,
    /// The model file that estimates.
    Model,
}

/// One factor, a table `[[vary]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Factor {
    /// The file that is changed.
    #[serde(rename = "in")]
    pub target: Target,
    /// Keys with dots between them, places in lists as numbers from 0: `sensors.alpha.noise`, `manoeuvre.0.amplitude`.
    pub path: String,
    /// Unit that is written behind each number; none for plain numbers.
    #[serde(default)]
    pub unit: Option<String>,
    /// Listed values, numbers or text.
    #[serde(default)]
    pub values: Option<Vec<Value>>,
    /// Range: from here ...
    #[serde(default)]
    pub from: Option<f64>,
    /// ... to here.
    #[serde(default)]
    pub to: Option<f64>,
    /// Equal ratios instead of equal differences over the range.
    #[serde(default)]
    pub log: bool,
    /// In a grid: number of values of the range, both ends included.
    #[serde(default)]
    pub steps: Option<u32>,
    /// Normal distribution: mean ...
    #[serde(default)]
    pub mean: Option<f64>,
    /// ... and standard deviation.
    #[serde(default)]
    pub std: Option<f64>,
}

/// What is wrong with a factor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// Not exactly one kind of values.
    #[error("`{path}`: give either `values`, or `from` and `to`, or `mean` and `std`")]
    Kind {
        /// Path of the factor.
        path: String,
    },
    /// A range or a distribution that is none.
    #[error("`{path}`: {problem}")]
    Range {
        /// Path of the factor.
        path: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A path that leads nowhere.
    #[error("`{path}`: `{part}` is no table or list")]
    Path {
        /// Path of the factor.
        path: String,
        /// The part of it at which it ends.
        part: String,
    },
}

/// Most values of a range in a grid, which are kept in memory.
const MOST_STEPS: u32 = 1_000_000;

impl Factor {
    /// Checks what the types do not say.
    ///
    /// # Errors
    /// [`FactorError`].
    pub fn check(&self, is_grid: bool) -> Result<(), FactorError> {
        let Self { values, from, to, mean, std, .. } = self;
        let wrong = |problem| Err(FactorError::Range { path: self.path.clone(), problem });
        // What would be left aside without a word.
        match (self.target, self.path.as_str()) {
            (Target::Scenario, "seed") => {
                return wrong("the seeds are those of the campaign: `seeds = 10`, not a factor");
            }
            (Target::Model, "estimator.method") => {
                return wrong("the methods are those of the campaign: `methods = [\"smpe\", \"ekf\"]`, not a factor");
            }
            _ => {}
        }
        if self.log && (values.is_some() || mean.is_some()) {
            return wrong("equal ratios (`log`) are for a range, `from` and `to`");
        }
        if self.steps.is_some() && (!is_grid || values.is_some() || mean.is_some()) {
            return wrong("`steps` is for a range in a grid: other designs take their number from `points`");
        }
        if self.unit.is_some() && values.iter().flatten().any(Value::is_str) {
            return wrong("`unit` is for numbers: write it into the text itself");
        }
        match (values, from.zip(*to), mean.zip(*std)) {
            (Some(values), None, None) if from.is_none() && to.is_none() && mean.is_none() && std.is_none() => {
                let copies = values.iter().enumerate().any(|(place, value)| values[..place].contains(value));
                match (values.is_empty(), copies) {
                    (true, _) => wrong("`values` is empty"),
                    (_, true) => wrong("`values` has one value twice, whose flights would count twice"),
                    _ => Ok(()),
                }
            }
            (None, Some((from, to)), None) if mean.is_none() && std.is_none() => {
                if !(from.is_finite() && to.is_finite() && from < to) {
                    return wrong("`from` has to be below `to`, both finite");
                }
                if self.log && from <= 0.0 {
                    return wrong("equal ratios (`log`) need a range above zero");
                }
                match self.steps {
                    None if is_grid => wrong("a grid needs `steps`, the number of values of the range"),
                    Some(steps) if steps < 2 => wrong("`steps` has to be two or more"),
                    Some(steps) if steps > MOST_STEPS => wrong("`steps` has to be at most 1,000,000"),
                    _ => Ok(()),
                }
            }
            (None, None, Some((mean, std))) if from.is_none() && to.is_none() => {
                if !(mean.is_finite() && std.is_finite() && std > 0.0) {
                    return wrong("`mean` has to be finite and `std` above zero");
                }
                if is_grid { wrong("a grid has no distributions: give `values` or a range") } else { Ok(()) }
            }
            _ => Err(FactorError::Kind { path: self.path.clone() }),
        }
    }

    /// The values of a grid.
    pub fn grid(&self) -> Vec<Value> {
        if let Some(values) = &self.values {
            return values.iter().map(|value| self.with_unit(value.clone())).collect();
        }
        let steps = self.steps.unwrap_or(2).max(2);
        (0..steps).map(|k| self.within(f64::from(k) / f64::from(steps - 1))).collect()
    }

    /// Number of the values of a grid.
    pub fn grid_length(&self) -> usize {
        self.values.as_ref().map_or(self.steps.unwrap_or(2).max(2) as usize, Vec::len)
    }

    /// The value at a coordinate of the unit cube, 0 to 1.
    pub fn at(&self, coordinate: f64) -> Value {
        match (&self.values, self.mean.zip(self.std)) {
            (Some(values), _) => {
                let place = (coordinate * values.len() as f64) as usize;
                values.get(place).or(values.last()).map_or(Value::Integer(0), |value| self.with_unit(value.clone()))
            }
            (None, Some((mean, std))) => self.with_unit(Value::Float(mean + std * normal_quantile(coordinate))),
            (None, None) => self.within(coordinate),
        }
    }

    fn within(&self, part: f64) -> Value {
        let (from, to) = (self.from.unwrap_or(0.0), self.to.unwrap_or(1.0));
        let value = match self.log {
            true => from * libm::pow(to / from, part),
            false => from + part * (to - from),
        };
        self.with_unit(Value::Float(value))
    }

    fn with_unit(&self, value: Value) -> Value {
        match (&self.unit, value) {
            (Some(unit), Value::Float(value)) => Value::String(format!("{value} {unit}")),
            (Some(unit), Value::Integer(value)) => Value::String(format!("{value} {unit}")),
            (_, value) => value,
        }
    }

    /// Puts a value into a file. Tables that are missing on the way are made; whether the key means anything is for the reader
    /// of the file to say.
    ///
    /// # Errors
    /// [`FactorError::Path`].
    pub fn put(&self, value: Value, file: &mut Table) -> Result<(), FactorError> {
        let lost = |part: &str| FactorError::Path { path: self.path.clone(), part: part.to_owned() };
        let (folder, last) = self.path.rsplit_once('.').unwrap_or(("", &self.path));
        let mut whole = Value::Table(std::mem::take(file));
        let mut at = &mut whole;
        for part in folder.split('.').filter(|part| !part.is_empty()) {
            at = match at {
                Value::Table(table) => table.entry(part).or_insert_with(|| Value::Table(Table::new())),
                Value::Array(list) => {
                    part.parse::<usize>().ok().and_then(|k| list.get_mut(k)).ok_or_else(|| lost(part))?
                }
                _ => return Err(lost(part)),
            };
        }
        match at {
            Value::Table(table) => _ = table.insert(last.to_owned(), value),
            Value::Array(list) => {
                *last.parse::<usize>().ok().and_then(|k| list.get_mut(k)).ok_or_else(|| lost(last))? = value;
            }
            _ => return Err(lost(last)),
        }
        if let Value::Table(table) = whole {
            *file = table;
        }
        Ok(())
    }
}

/// The number that a standard normal one is below with this probability, by halving; 0 gives about -38.
fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (-38.0, 38.0);
    for _ in 0..80 {
        let middle: f64 = 0.5 * (low + high);
        let below = 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2);
        if below < probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(text: &str) -> Factor {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn values_land_where_the_path_says() {
        let mut file: Table = toml::from_str("a = 1\n[[m]]\nx = 1\n[[m]]\nx = 2\n").unwrap();
        let into = |path: &str, file: &mut Table| {
            factor(&format!("in = \"model\"\npath = \"{path}\"\nvalues = [1]")).put(Value::Integer(9), file)
        };
        for path in ["a", "m.1.x", "new.table.key"] {
            into(path, &mut file).unwrap();
        }
        assert_eq!((file["a"].as_integer(), file["m"][1]["x"].as_integer()), (Some(9), Some(9)));
        assert_eq!((file["m"][0]["x"].as_integer(), file["new"]["table"]["key"].as_integer()), (Some(1), Some(9)));
        for path in ["a.b", "m.7.x", "m.first.x", "a.b.c"] {
            assert!(matches!(into(path, &mut file.clone()), Err(FactorError::Path { .. })), "{path}");
        }
    }

    #[test]
    fn ranges_distributions_and_lists_give_their_values() {
        let range = factor("in = 'scenario'\npath = 'x'\nfrom = 1\nto = 100\nlog = true\nsteps = 3\nunit = 'm'");
        assert_eq!(range.grid(), ["1 m", "10 m", "100 m"].map(|text| Value::String(text.to_owned())));
        let normal = factor("in = 'scenario'\npath = 'x'\nmean = 5.0\nstd = 2.0");
        let at = |coordinate| normal.at(coordinate).as_float().unwrap();
        assert!((at(0.5) - 5.0).abs() < 1e-12 && (at(0.975) - 5.0 - 2.0 * 1.959_963_984_540).abs() < 1e-9);
        let list = factor("in = 'scenario'\npath = 'x'\nvalues = ['book', 'morelli']");
        assert_eq!(list.at(0.49).as_str(), Some("book"));
        assert_eq!(list.at(0.999).as_str(), Some("morelli"));
    }

    #[test]
    fn factors_that_say_too_much_or_too_little_are_refused() {
        let check = |text: &str, grid| factor(&format!("in = 'model'\npath = 'x'\n{text}")).check(grid);
        assert!(check("values = [1, 2]", true).is_ok() && check("from = 0\nto = 1\nsteps = 2", true).is_ok());
        assert!(check("mean = 0.0\nstd = 1.0", false).is_ok());
        for (text, grid) in [("", false), ("from = 1", false), ("values = [1]\nfrom = 0\nto = 1", false)] {
            assert!(matches!(check(text, grid), Err(FactorError::Kind { .. })), "{text}");
        }
        let ranges = [
            ("values = []", false),
            ("from = 1\nto = 0", false),
            ("from = 0\nto = 1", true),
            ("from = 0\nto = 1\nlog = true", false),
            ("mean = 0.0\nstd = 1.0", true),
            ("mean = 0.0\nstd = nan", false),
        ];
        for (text, grid) in ranges {
            assert!(matches!(check(text, grid), Err(FactorError::Range { .. })), "{text}");
        }
    }
}
