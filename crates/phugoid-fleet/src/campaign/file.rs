//! The file of a campaign, in TOML, and the flights that it asks for.

use std::path::{Path, PathBuf};

use phugoid_identification::method::Method;
use phugoid_identification::model_file::{ModelError, ModelFile};
use phugoid_simulation::scenario::{BUILT_IN, nearest};
use serde::Deserialize;
use toml::{Table, Value};

use super::design::Design;
use super::unit::Unit;
use super::vary::{Factor, FactorError, Target};

/// A campaign: scenarios, models, methods, seeds, and what is varied.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// What it asks, in a few words.
    pub name: String,
    /// Scenarios: files (relative to this file), or names of built-in ones.
    pub scenarios: Vec<String>,
    /// Models: files (relative to this file), or names of built-in ones.
    pub models: Vec<String>,
    /// Methods by name.
    pub methods: Vec<Method>,
    /// Number of seeds of noise and turbulence, each flown at each point.
    #[serde(default = "one")]
    pub seeds: u32,
    /// Which combinations of the factors are flown.
    #[serde(default)]
    pub design: Design,
    /// Number of points of a design that is no grid.
    #[serde(default)]
    pub points: Option<u32>,
    /// Seed of a random design.
    #[serde(default)]
    pub design_seed: u64,
    /// What is varied.
    #[serde(default)]
    pub vary: Vec<Factor>,
    /// Folder of the file, where relative paths begin.
    #[serde(skip)]
    pub folder: PathBuf,
}

fn one() -> u32 {
    1
}

/// Most flights of a campaign: it is laid out in memory before it begins.
pub const MOST_UNITS: usize = 1_000_000;

/// What is wrong with a campaign.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// It is no TOML, or not that of a campaign.
    #[error("{place}: {source}")]
    Wrong {
        /// The file.
        place: String,
        /// What is wrong, and where.
        source: Box<toml::de::Error>,
    },
    /// A factor.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// A model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// There is no such scenario.
    #[error("there is no scenario `{name}`{}", nearest.map_or_else(String::new, |near| format!(": did you mean `{near}`?")))]
    NoScenario {
        /// What was asked for.
        name: String,
        /// The built-in one with the most similar name.
        nearest: Option<&'static str>,
    },
    /// Something that the campaign has to say.
    #[error("{0}")]
    Incomplete(&'static str),
    /// Too many flights.
    #[error(
        "the campaign asks for {units} estimations: at most {MOST_UNITS} can be laid out at once. Use fewer, or several campaigns with one store"
    )]
    TooMany {
        /// Number that it asks for.
        units: usize,
    },
}

impl Campaign {
    /// Reads the file of a campaign.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn open(file: &Path) -> Result<Self, CampaignError> {
        let text = std::fs::read_to_string(file)
            .map_err(|source| CampaignError::Unreadable { file: file.to_owned(), source })?;
        let folder = file.parent().map(Path::to_owned).unwrap_or_default();
        Self::parse(&text, &file.display().to_string(), &folder)
    }

    /// Parses the text of a campaign. `place` is its name in messages, relative paths begin in `folder`.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn parse(text: &str, place: &str, folder: &Path) -> Result<Self, CampaignError> {
        let wrong = |source| CampaignError::Wrong { place: place.to_owned(), source: Box::new(source) };
        let mut campaign: Self = toml::from_str(text).map_err(wrong)?;
        campaign.folder = folder.to_owned();
        campaign.check()?;
        Ok(campaign)
    }

    fn check(&self) -> Result<(), CampaignError> {
        let need = |ok: bool, what| if ok { Ok(()) } else { Err(CampaignError::Incomplete(what)) };
        need(!self.scenarios.is_empty(), "`scenarios` names no scenario")?;
        need(!self.models.is_empty(), "`models` names no model")?;
        need(!self.methods.is_empty(), "`methods` names no method")?;
        need(self.seeds > 0, "`seeds` has to be one or more")?;
        let is_grid = self.design == Design::Grid;
        need(is_grid || self.points.is_some_and(|points| points > 0), "this design needs `points`, their number")?;
        need(
            !is_grid || self.points.is_none(),
            "a grid has no `points`: its factors have `values`, or a range with `steps`",
        )?;
        need(is_grid || !self.vary.is_empty(), "this design needs something to vary: `[[vary]]`")?;
        need(
            self.vary.len() <= self.design.most_factors(),
            "more factors than the design can have: 21 for Sobol, 100 else",
        )?;
        self.vary.iter().try_for_each(|factor| factor.check(is_grid))?;
        let points = match is_grid {
            true => self.vary.iter().map(|f| f.grid().len()).try_fold(1, usize::checked_mul),
            false => self.points.map(|points| points as usize),
        };
        let counts = [self.scenarios.len(), self.models.len(), self.methods.len(), self.seeds as usize];
        let units = counts.into_iter().try_fold(points.unwrap_or(usize::MAX), usize::checked_mul).unwrap_or(usize::MAX);
        if units > MOST_UNITS { Err(CampaignError::TooMany { units }) } else { Ok(()) }
    }

    /// The values of the factors at each point, in their order.
    pub fn points(&self) -> Vec<Vec<Value>> {
        if self.design != Design::Grid {
            let cube = self.design.points(self.points.unwrap_or(0), self.vary.len(), self.design_seed);
            return cube.iter().map(|at| self.vary.iter().zip(at).map(|(factor, u)| factor.at(*u)).collect()).collect();
        }
        self.vary.iter().fold(vec![Vec::new()], |points, factor| {
            let values = factor.grid();
            points
                .iter()
                .flat_map(|point| values.iter().map(|v| [point.as_slice(), std::slice::from_ref(v)].concat()))
                .collect()
        })
    }

    /// Every estimation that the campaign asks for.
    ///
    /// # Errors
    /// [`CampaignError`]: a scenario or a model that is not there, or a path of a factor that leads nowhere.
    pub fn units(&self) -> Result<Vec<Unit>, CampaignError> {
        let scenarios = self.scenarios.iter().map(|name| self.scenario(name)).collect::<Result<Vec<_>, _>>()?;
        let models = self.models.iter().map(|name| self.model(name)).collect::<Result<Vec<_>, _>>()?;
        let points = self.points();
        let mut units = Vec::new();
        for (name, scenario, folder) in &scenarios {
            for point in &points {
                let flown = self.with(scenario, point, Target::Scenario)?;
                for (model_name, model) in &models {
                    let model = self.with(model, point, Target::Model)?;
                    for (method, seed) in self.methods.iter().flat_map(|m| (1..=self.seeds).map(move |s| (*m, s))) {
                        units.push(Unit {
                            scenario_name: name.clone(),
                            scenario: flown.clone(),
                            folder: folder.clone(),
                            model_name: model_name.clone(),
                            model: model.clone(),
                            method,
                            seed: u64::from(seed),
                            factors: self.factors(point),
                        });
                    }
                }
            }
        }
        Ok(units)
    }

    /// The text of a file with the values of a point in it. Without a factor for it the text stays as it is.
    fn with(&self, text: &str, point: &[Value], target: Target) -> Result<std::sync::Arc<str>, CampaignError> {
        let factors = || self.vary.iter().zip(point).filter(|(factor, _)| factor.target == target);
        if factors().next().is_none() {
            return Ok(text.into());
        }
        let wrong = |source| CampaignError::Wrong { place: self.name.clone(), source: Box::new(source) };
        let mut file: Table = toml::from_str(text).map_err(wrong)?;
        for (factor, value) in factors() {
            factor.put(value.clone(), &mut file)?;
        }
        Ok(file.to_string().into())
    }

    fn factors(&self, point: &[Value]) -> std::sync::Arc<str> {
        let named = self.vary.iter().zip(point).map(|(factor, value)| {
            // With its unit a number is text: the plain number is what tables are made of.
            let plain = match (&factor.unit, value) {
                (Some(unit), Value::String(text)) => text
                    .strip_suffix(unit.as_str())
                    .and_then(|number| number.trim().parse::<f64>().ok())
                    .map_or_else(|| serde_json::json!(text), |number| serde_json::json!(number)),
                (_, value) => serde_json::json!(value),
            };
            (factor.path.clone(), plain)
        });
        serde_json::Value::Object(named.collect()).to_string().into()
    }

    fn scenario(&self, name: &str) -> Result<(String, String, PathBuf), CampaignError> {
        let path = self.folder.join(name);
        if path.is_file() {
            let text = std::fs::read_to_string(&path)
                .map_err(|source| CampaignError::Unreadable { file: path.clone(), source })?;
            return Ok((name.to_owned(), text, path.parent().map(Path::to_owned).unwrap_or_default()));
        }
        match BUILT_IN.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => Ok((name.to_owned(), (*text).to_owned(), PathBuf::new())),
            None => {
                let nearest = nearest(name, BUILT_IN.iter().map(|(known, _)| *known));
                Err(CampaignError::NoScenario { name: name.to_owned(), nearest })
            }
        }
    }

    fn model(&self, name: &str) -> Result<(String, String), CampaignError> {
        let path = self.folder.join(name);
        let found = if path.is_file() { path.display().to_string() } else { name.to_owned() };
        let (_, text) = ModelFile::find_text(&found)?;
        Ok((name.to_owned(), text))
    }
}
