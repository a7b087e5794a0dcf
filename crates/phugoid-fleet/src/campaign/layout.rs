//! The estimations that a campaign asks for, in one order. Each is made when it is asked for, so that a million of them takes no
//! memory, and consecutive ones are blocks, which are one file of the store each.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use phugoid_identification::model_file::ModelFile;
use serde_json::json;
use toml::{Table, Value};

use super::design::{Cube, Design};
use super::file::{Campaign, CampaignError};
use super::question::Question;
use super::unit::Unit;
use super::vary::{Factor, Target};
use crate::content::{NamedFiles, base_hashes, model_sha256, source_sha256};
use crate::key::{Hasher, hash};

/// A file that is varied: as the campaign names it, its text, and its keys with their values.
struct Base {
    name: String,
    text: Arc<str>,
    sha256: String,
    /// Hashes of the files of the `base` of a model, as the file stands.
    base: Vec<String>,
    table: Table,
    /// Whether a factor changes it.
    is_varied: bool,
    folder: PathBuf,
}

impl Base {
    /// Where the file is.
    fn place(&self) -> String {
        self.folder.join(&self.name).display().to_string()
    }
}

/// The values of the factors, point by point.
enum Points {
    /// Every combination of these values of each factor; those of the last factor follow one another.
    Grid(Vec<Vec<Value>>),
    Design(Cube),
}

/// Everything that a campaign asks for: scenario by scenario, in each model by model, point by point, seed by seed and method by
/// method. What estimates one flight follows one another, so that it is flown once.
pub struct Layout {
    vary: Vec<Factor>,
    methods: Vec<Question>,
    seeds: usize,
    scenarios: Vec<Base>,
    models: Vec<Base>,
    points: Points,
    count_of_points: usize,
    block: usize,
}

/// Consecutive estimations that are one file of the store.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// The key under which the file stands. It follows from all that decides on the rows.
    pub key: String,
    /// SHA-256 of the model by which the file is filed: the one that the block has, or where it is varied within the block the
    /// one that the campaign names.
    pub model_sha256: String,
    /// The text of that model.
    pub model: Arc<str>,
    /// Numbers of the estimations.
    pub units: Range<usize>,
}

impl Layout {
    /// Reads the files that the campaign names.
    ///
    /// # Errors
    /// [`CampaignError`]: a scenario or a model that is not there, or a path of a factor that leads nowhere.
    pub fn new(campaign: &Campaign) -> Result<Self, CampaignError> {
        let base = |name: &str, text: String, folder: PathBuf, target| -> Result<Base, CampaignError> {
            let is_varied = campaign.vary.iter().any(|factor| factor.target == target);
            let wrong = |source| CampaignError::Wrong { place: name.to_owned(), source: Box::new(source) };
            // A file that is not varied is read by what reads it anyway, whose messages are better.
            let table = if is_varied { toml::from_str(&text).map_err(wrong)? } else { Table::new() };
            let sha256 = hash(text.as_bytes());
            Ok(Base { name: name.to_owned(), text: text.into(), sha256, base: Vec::new(), table, is_varied, folder })
        };
        let scenario = |name: &String| {
            let (text, folder) = campaign.scenario(name)?;
            base(name, text, folder, Target::Scenario)
        };
        let model = |name: &String| -> Result<Base, CampaignError> {
            let (text, folder) = campaign.model(name)?;
            let mut model = base(name, text, folder, Target::Model)?;
            // One that cannot be read is refused when it is used.
            if let Ok(read) = ModelFile::parse(&model.place(), &model.text) {
                model.base = base_hashes(&read);
                model.sha256 = model_sha256(&model.text, &model.base);
            }
            Ok(model)
        };
        let points = match campaign.design {
            Design::Grid => Points::Grid(campaign.vary.iter().map(Factor::grid).collect()),
            design => {
                let points = campaign.points.unwrap_or(0);
                Points::Design(design.cube(points, campaign.vary.len(), campaign.design_seed))
            }
        };
        let layout = Self {
            vary: campaign.vary.clone(),
            methods: campaign.methods.clone(),
            seeds: campaign.seeds as usize,
            scenarios: campaign.scenarios.iter().map(scenario).collect::<Result<_, _>>()?,
            models: campaign.models.iter().map(model).collect::<Result<_, _>>()?,
            points,
            count_of_points: campaign.count_of_points()?,
            block: campaign.block as usize,
        };
        // A path that leads nowhere is told before anything is flown.
        for group in 0..layout.scenarios.len() * layout.models.len() {
            layout.unit(group * layout.of_a_group(), &mut NamedFiles::default())?;
        }
        Ok(layout)
    }

    /// Number of estimations.
    pub fn units(&self) -> usize {
        self.scenarios.len() * self.models.len() * self.of_a_group()
    }

    /// Number of estimations of one scenario with one model.
    fn of_a_group(&self) -> usize {
        self.count_of_points * self.of_a_point()
    }

    /// Number of estimations of one point with one scenario and one model.
    fn of_a_point(&self) -> usize {
        self.seeds * self.methods.len()
    }

    /// The values of the factors at a point.
    fn point(&self, number: usize) -> Vec<Value> {
        match &self.points {
            Points::Grid(factors) => {
                let mut rest = number;
                let backwards = factors.iter().rev().filter_map(|values| {
                    let value = values.get(rest % values.len());
                    rest /= values.len();
                    value.cloned()
                });
                let mut point: Vec<Value> = backwards.collect();
                point.reverse();
                point
            }
            Points::Design(cube) => {
                let at = cube.point(u32::try_from(number).unwrap_or(u32::MAX));
                self.vary.iter().zip(at).map(|(factor, u)| factor.at(u)).collect()
            }
        }
    }

    /// Scenario, model, point, seed and method of an estimation.
    fn parts(&self, number: usize) -> (&Base, &Base, usize, u64, Question) {
        let (group, within) = (number / self.of_a_group(), number % self.of_a_group());
        let (point, within) = (within / self.of_a_point(), within % self.of_a_point());
        let (seed, method) = (within / self.methods.len(), within % self.methods.len());
        let scenario = &self.scenarios[(group / self.models.len()).min(self.scenarios.len() - 1)];
        (scenario, &self.models[group % self.models.len()], point, seed as u64 + 1, self.methods[method])
    }

    /// The estimation of this number, from 0. `files` keeps the hashes of the files that scenarios name.
    ///
    /// # Errors
    /// [`CampaignError`]: a path of a factor that leads nowhere.
    pub fn unit(&self, number: usize, files: &mut NamedFiles) -> Result<Unit, CampaignError> {
        let (scenario, model, point, seed, method) = self.parts(number);
        let values = self.point(point);
        let flown = self.with(scenario, &values, Target::Scenario)?;
        let model_text = self.with(model, &values, Target::Model)?;
        Ok(Unit {
            source_sha256: source_sha256(&flown, seed, &scenario.folder, files),
            model_sha256: self.model_sha256(model, &model_text),
            scenario_name: scenario.name.clone(),
            scenario: flown,
            folder: scenario.folder.clone(),
            model_name: model.name.clone(),
            model_folder: model.folder.clone(),
            model: model_text,
            method,
            seed,
            factors: self.factors(&values),
        })
    }

    /// SHA-256 of a model with the values of a point in its text. Unless its `base` is varied, the files of that are those of the file as
    /// it stands.
    fn model_sha256(&self, model: &Base, text: &str) -> String {
        if !model.is_varied {
            return model.sha256.clone();
        }
        let is_base = |factor: &Factor| factor.target == Target::Model && factor.path.split('.').next() == Some("base");
        match self.vary.iter().any(is_base).then(|| ModelFile::parse(&model.place(), text)) {
            Some(Ok(read)) => model_sha256(text, &base_hashes(&read)),
            // One that cannot be read is refused when it is used.
            Some(Err(_)) => model_sha256(text, &[]),
            None => model_sha256(text, &model.base),
        }
    }

    /// The text of a file with the values of a point in it. Without a factor for it the text stays as it is.
    fn with(&self, base: &Base, point: &[Value], target: Target) -> Result<Arc<str>, CampaignError> {
        if !base.is_varied {
            return Ok(Arc::clone(&base.text));
        }
        let mut file = base.table.clone();
        for (factor, value) in self.vary.iter().zip(point).filter(|(factor, _)| factor.target == target) {
            factor.put(value.clone(), &mut file)?;
        }
        Ok(file.to_string().into())
    }

    fn factors(&self, point: &[Value]) -> Arc<str> {
        let named = self.vary.iter().zip(point).map(|(factor, value)| {
            // With its unit a number is text: the plain number is what tables are made of.
            let plain = match (&factor.unit, value) {
                (Some(unit), Value::String(text)) => text
                    .strip_suffix(unit.as_str())
                    .and_then(|number| number.trim().parse::<f64>().ok())
                    .map_or_else(|| json!(text), |number| json!(number)),
                (_, value) => json!(value),
            };
            (factor.path.clone(), plain)
        });
        serde_json::Value::Object(named.collect()).to_string().into()
    }

    /// The blocks, in the order of their estimations.
    ///
    /// # Errors
    /// As [`unit`](Self::unit).
    pub fn blocks(&self) -> Result<Vec<Block>, CampaignError> {
        let mut files = NamedFiles::default();
        let firsts = (0..self.units()).step_by(self.block.max(1));
        firsts.map(|first| self.block_from(first..first + self.block, &mut files)).collect()
    }

    fn block_from(&self, units: Range<usize>, files: &mut NamedFiles) -> Result<Block, CampaignError> {
        if units.len() == 1 {
            let unit = self.unit(units.start, files)?;
            return Ok(Block { key: unit.key(), model_sha256: unit.model_sha256, model: unit.model, units });
        }
        let (scenario, model, ..) = self.parts(units.start);
        let (model_sha256, text) = (model.sha256.clone(), Arc::clone(&model.text));
        let mut hasher = Hasher::new();
        hasher.part("block of", &units.len().to_string());
        hasher.part("scenario", &scenario.name);
        hasher.part("flight", &source_sha256(&scenario.text, 0, &scenario.folder, files));
        hasher.part("model name", &model.name);
        hasher.part("model", &model_sha256);
        for factor in &self.vary {
            hasher.part("factor", &json!([factor.target, factor.path]).to_string());
        }
        let mut last = None;
        for number in units.clone() {
            let (_, _, point, seed, method) = self.parts(number);
            if last.replace(point) != Some(point) {
                let values = self.point(point);
                let mut named = Vec::new();
                for (factor, value) in self.vary.iter().zip(&values) {
                    let key = factor.path.rsplit('.').next().unwrap_or_default();
                    files.named_in(key, value, &scenario.folder, &mut named);
                }
                named.iter().for_each(|hash| hasher.part("file", hash));
                hasher.part("point", &json!(values).to_string());
            }
            hasher.part("seed", &seed.to_string());
            hasher.part("method", method.name());
        }
        Ok(Block { key: hasher.digits(), model_sha256, model: text, units })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::campaign::kept::Kept;

    const CAMPAIGN: &str = r#"
name = "blocks"
scenarios = ["short.toml"]
models = ["hfb320"]
methods = ["smpe", "rls"]
seeds = 2
design = "sobol"
points = 6
block = 8
[[vary]]
in = "scenario"
path = "sensors.alpha.noise"
from = 0.02
to = 0.2
unit = "deg"
[[vary]]
in = "model"
path = "parameters.Cm_q.prior_std"
from = 25.8
to = 258.0
"#;

    const SHORT: &str = r#"
name = "short"
duration = "4 s"
sample_rate = "25 Hz"
[aircraft]
file = "hfb320"
[condition]
altitude = "4300 m"
speed = "104.67 m/s"
[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "0.5 s"
unit = "0.3 s"
amplitude = "0.8 deg"
[sensors]
alpha = { noise = "0.057 deg" }
q = { noise = "0.033 deg/s" }
qdot = { noise = "0.32 deg/s^2" }
"#;

    /// A folder with the scenario, which is removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("phugoid-layout-{name}-{}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join("short.toml"), SHORT).unwrap();
            Self(folder)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            std::fs::remove_dir_all(&self.0).unwrap();
        }
    }

    fn campaign(text: &str, folder: &Path) -> Campaign {
        Campaign::parse(text, "c.toml", folder).unwrap()
    }

    fn keys(text: &str, folder: &Folder) -> Vec<String> {
        let layout = Layout::new(&campaign(text, &folder.0)).unwrap();
        layout.blocks().unwrap().into_iter().map(|block| block.key).collect()
    }

    #[test]
    fn keys_of_blocks_follow_from_what_decides_on_their_rows() {
        let folder = Folder::new("keys");
        let (whole, again) = (keys(CAMPAIGN, &folder), keys(CAMPAIGN, &folder));
        assert_eq!((whole.len(), &whole), (3, &again));
        // A campaign that grows keeps the blocks that it has.
        let grown = keys(&CAMPAIGN.replace("points = 6", "points = 12"), &folder);
        assert_eq!((grown.len(), &grown[..3]), (6, whole.as_slice()));
        // The name of the campaign decides on nothing; everything else changes every block.
        assert_eq!(keys(&CAMPAIGN.replace("name = \"blocks\"", "name = \"other\""), &folder), whole);
        for (from, to) in [
            ("seeds = 2", "seeds = 4"),
            ("\"rls\"", "\"ekf\""),
            ("to = 0.2", "to = 0.21"),
            ("unit = \"deg\"", "unit = \"rad\""),
            ("block = 8", "block = 4"),
            ("sensors.alpha.noise", "sensors.q.noise"),
            ("\"hfb320\"", "\"f16\""),
        ] {
            let other = keys(&CAMPAIGN.replacen(from, to, 1), &folder);
            assert!(other.iter().all(|key| !whole.contains(key)), "{to}");
        }
        std::fs::write(folder.0.join("short.toml"), SHORT.replace("4 s", "5 s")).unwrap();
        assert!(keys(CAMPAIGN, &folder).iter().all(|key| !whole.contains(key)));
    }

    #[test]
    fn the_content_of_a_file_that_a_factor_names_counts() {
        let folder = Folder::new("files");
        let text = "name = 'files'\nscenarios = ['short.toml']\nmodels = ['hfb320']\nmethods = ['smpe']\nseeds = 2\nblock = 2\n\
                    [[vary]]\nin = 'scenario'\npath = 'manoeuvre.0.file'\nvalues = ['one.csv', 'two.csv']\n";
        let write = |name: &str, content: &str| std::fs::write(folder.0.join(name), content).unwrap();
        write("one.csv", "a");
        write("two.csv", "b");
        let before = keys(text, &folder);
        write("two.csv", "c");
        let after = keys(text, &folder);
        assert_eq!(before[0], after[0]);
        assert_ne!(before[1], after[1]);
    }

    /// What consecutive units share is kept from one to the next; each by itself gives the same rows.
    #[test]
    fn a_unit_gives_the_same_rows_with_what_was_kept_and_without() {
        let folder = Folder::new("kept");
        let layout = Layout::new(&campaign(CAMPAIGN, &folder.0)).unwrap();
        let mut kept = Kept::default();
        let mut rows = 0;
        for number in 0..layout.units() {
            let unit = layout.unit(number, &mut NamedFiles::default()).unwrap();
            let alone = unit.rows("key", &mut Kept::default());
            assert_eq!(unit.rows("key", &mut kept), alone, "{number}");
            assert!(alone.iter().all(|row| row.refusal.is_none()), "{:?}", alone[0].message);
            rows += alone.len();
        }
        assert_eq!(rows, 24 * 11);
    }

    #[test]
    fn a_grid_counts_through_its_values_and_points_are_in_no_need_of_one_another() {
        let folder = Folder::new("grid");
        let grid = CAMPAIGN
            .replace("design = \"sobol\"\npoints = 6\nblock = 8", "block = 4")
            .replace("from = 0.02\nto = 0.2\n", "from = 0.25\nto = 0.75\nsteps = 3\n")
            .replace("to = 258.0\n", "to = 258.0\nsteps = 2\n");
        let layout = Layout::new(&campaign(&grid, &folder.0)).unwrap();
        assert_eq!(layout.units(), 3 * 2 * 4);
        let factors = |number| -> serde_json::Value {
            serde_json::from_str(&layout.unit(number, &mut NamedFiles::default()).unwrap().factors).unwrap()
        };
        // The values of the last factor follow one another.
        let expected = json!({"sensors.alpha.noise": 0.25, "parameters.Cm_q.prior_std": 258.0});
        assert_eq!((factors(4), factors(7)), (expected.clone(), expected));
        assert_eq!(factors(8), json!({"sensors.alpha.noise": 0.5, "parameters.Cm_q.prior_std": 25.8}));
        assert_eq!(layout.units(), layout.blocks().unwrap().iter().map(|block| block.units.len()).sum::<usize>());
    }

    #[test]
    fn a_million_estimations_are_a_thousand_blocks() {
        let folder = Folder::new("million");
        let text = CAMPAIGN.replace("points = 6\nblock = 8", "points = 250_000\nblock = 1000");
        let layout = Layout::new(&campaign(&text, &folder.0)).unwrap();
        assert_eq!((layout.units(), layout.blocks().unwrap().len()), (1_000_000, 1000));
    }

    #[test]
    fn blocks_that_cannot_be_are_refused_with_what_can_be_done() {
        let folder = Folder::new("refused");
        let refused = |from: &str, to: &str| {
            Campaign::parse(&CAMPAIGN.replace(from, to), "c.toml", &folder.0).unwrap_err().to_string()
        };
        assert!(refused("block = 8", "block = 7").contains("`block = 6` does"));
        assert!(refused("block = 8", "block = 100").contains("`block = 24` does"));
        assert!(refused("block = 8", "block = 0").contains("one or more"));
        assert!(refused("points = 6\nblock = 8", "points = 1_000_000").contains("`block = 1000`"));
        let cube = "design = \"latin-hypercube\"\npoints = 100_000_000\nblock = 1000";
        assert!(refused("design = \"sobol\"\npoints = 6\nblock = 8", cube).contains("memory"));
    }
}
