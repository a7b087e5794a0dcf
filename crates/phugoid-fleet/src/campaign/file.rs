//! The file of a campaign, in TOML, and what is wrong with one.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use phugoid_identification::model_file::{ModelError, ModelFile};
use phugoid_simulation::scenario::{BUILT_IN, nearest};
use serde::Deserialize;

use super::design::Design;
use super::question::Question;
use super::vary::{Factor, FactorError};

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
    /// Methods by name, and `cramer-rao`.
    pub methods: Vec<Question>,
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
    /// Number of consecutive estimations that are one file of the store: more than one where there are very many.
    #[serde(default = "one")]
    pub block: u32,
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

/// Whether nothing stands twice in a list.
fn is_without_copies(words: &[String]) -> bool {
    words.iter().collect::<BTreeSet<_>>().len() == words.len()
}

/// Most estimations of a campaign, so that their numbers and those of their rows stay far from what can be counted.
pub const MOST_UNITS: usize = 1_000_000_000;

/// Most files that a campaign makes: a folder with more is slow to list, copy and remove.
pub const MOST_FILES: usize = 100_000;

/// Most coordinates of a Latin hypercube, which is kept in memory: 8 bytes each.
pub const MOST_NUMBERS: usize = 20_000_000;

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
        "the campaign asks for {units} estimations: at most {MOST_UNITS}. Use fewer, or several campaigns with one store"
    )]
    TooMany {
        /// Number that it asks for.
        units: usize,
    },
    /// Too many files.
    #[error(
        "the campaign asks for {units} estimations in files of {block}: at most {MOST_FILES} files. Let `block`, the number of \
         estimations in a file, be larger: `block = 1000`"
    )]
    TooManyFiles {
        /// Number of estimations that it asks for.
        units: usize,
        /// Number of estimations in a file.
        block: usize,
    },
    /// Blocks that are not all whole.
    #[error(
        "`block = {block}` does not divide the {of_a_group} estimations of each scenario and model (points times seeds times \
         methods): `block = {fitting}` does"
    )]
    Block {
        /// Number of estimations in a file.
        block: usize,
        /// Number of estimations of one scenario with one model.
        of_a_group: usize,
        /// The largest number up to the block that divides it.
        fitting: usize,
    },
    /// A Latin hypercube that takes too much memory.
    #[error(
        "a Latin hypercube of {numbers} numbers (points times factors) does not fit into memory: at most {MOST_NUMBERS}. \
         `design = \"sobol\"` fills the space as well and needs none"
    )]
    TooLarge {
        /// Its numbers.
        numbers: usize,
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
        // A flight that is asked for twice would count as two.
        need(is_without_copies(&self.scenarios), "`scenarios` names one twice")?;
        need(is_without_copies(&self.models), "`models` names one twice")?;
        let methods: Vec<String> = self.methods.iter().map(|method| method.name().to_owned()).collect();
        need(is_without_copies(&methods), "`methods` names one twice")?;
        let paths: Vec<String> = self.vary.iter().map(|f| format!("{:?} {}", f.target, f.path)).collect();
        need(is_without_copies(&paths), "`[[vary]]` has one `path` twice: only one of them would be flown")?;
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
        need(
            matches!(self.design, Design::LatinHypercube | Design::Random) || self.design_seed == 0,
            "a grid and Sobol points have nothing random: `design_seed` belongs to \"latin-hypercube\" and \"random\"",
        )?;
        self.vary.iter().try_for_each(|factor| factor.check(is_grid))?;
        // With values from lists alone there are only so many points, and a design that asks for more has some of them twice.
        let mut listed = self.vary.iter().map(|factor| factor.values.as_ref().map(Vec::len));
        let combinations = listed.try_fold(1_usize, |all, length| Some(all.saturating_mul(length?)));
        need(
            is_grid || combinations.is_none_or(|all| self.points.unwrap_or(0) as usize <= all),
            "`points` asks for more points than the values of the factors have combinations, so that flights would count twice: \
             `design = \"grid\"` without `points` flies each once",
        )?;
        let limit = |ok: bool, error: CampaignError| if ok { Ok(()) } else { Err(error) };
        let numbers = (self.points.unwrap_or(0) as usize).saturating_mul(self.vary.len());
        let is_laid_out = self.design == Design::LatinHypercube;
        limit(!is_laid_out || numbers <= MOST_NUMBERS, CampaignError::TooLarge { numbers })?;
        let of_a_group = [self.count_of_points()?, self.seeds as usize, self.methods.len()];
        let of_a_group = of_a_group.into_iter().try_fold(1, usize::checked_mul).unwrap_or(usize::MAX);
        let groups = self.scenarios.len().saturating_mul(self.models.len());
        let (units, block) = (of_a_group.saturating_mul(groups), self.block as usize);
        limit(units <= MOST_UNITS, CampaignError::TooMany { units })?;
        need(block > 0, "`block` has to be one or more")?;
        // Blocks that are all whole stay what they are when the campaign grows.
        let fitting = (1..=block.min(of_a_group)).rev().find(|n| of_a_group.is_multiple_of(*n)).unwrap_or(1);
        limit(fitting == block, CampaignError::Block { block, of_a_group, fitting })?;
        limit(units / block <= MOST_FILES, CampaignError::TooManyFiles { units, block })
    }

    /// Number of points of the design.
    ///
    /// # Errors
    /// [`CampaignError::TooMany`]: more than can be counted.
    pub(super) fn count_of_points(&self) -> Result<usize, CampaignError> {
        match self.design {
            Design::Grid => {
                let lengths = self.vary.iter().map(Factor::grid_length);
                lengths.into_iter().try_fold(1, usize::checked_mul).ok_or(CampaignError::TooMany { units: usize::MAX })
            }
            _ => Ok(self.points.unwrap_or(0) as usize),
        }
    }

    /// Text of a scenario, and the folder in which its paths begin.
    pub(super) fn scenario(&self, name: &str) -> Result<(String, PathBuf), CampaignError> {
        let path = self.folder.join(name);
        if path.is_file() {
            let text = std::fs::read_to_string(&path)
                .map_err(|source| CampaignError::Unreadable { file: path.clone(), source })?;
            return Ok((text, path.parent().map(Path::to_owned).unwrap_or_default()));
        }
        match BUILT_IN.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => Ok(((*text).to_owned(), PathBuf::new())),
            None => {
                let nearest = nearest(name, BUILT_IN.iter().map(|(known, _)| *known));
                Err(CampaignError::NoScenario { name: name.to_owned(), nearest })
            }
        }
    }

    /// Text of a model, and the folder in which its name begins: that of the campaign, or none for a built-in one.
    pub(super) fn model(&self, name: &str) -> Result<(String, PathBuf), CampaignError> {
        let path = self.folder.join(name);
        let (found, folder) = match path.is_file() {
            true => (path.display().to_string(), self.folder.clone()),
            false => (name.to_owned(), PathBuf::new()),
        };
        Ok((ModelFile::find_text(&found)?.1, folder))
    }
}
