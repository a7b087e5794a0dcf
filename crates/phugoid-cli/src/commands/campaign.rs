//! `phugoid campaign`.

use std::collections::HashSet;
use std::sync::atomic::AtomicBool;

use phugoid_fleet::campaign::file::Campaign;
use phugoid_fleet::campaign::layout::Layout;
use phugoid_fleet::campaign::question::CRAMER_RAO;
use phugoid_fleet::campaign::run::run as run_campaign;
use phugoid_fleet::campaign::score::{COLUMNS, Score, Scoring, Unscored};
use phugoid_fleet::run::{Share, Summary};
use phugoid_fleet::store::Store;
use serde::Serialize;

use super::fleet::Bar;
use crate::arguments;
use crate::arguments::fleet::Engine;
use crate::failure::Failure;
use crate::output::{Table, deliver, significant};

/// The result as a document.
#[derive(Serialize)]
struct Document {
    name: String,
    summary: Summary,
    scores: Vec<Score>,
    unscored: Vec<Unscored>,
}

pub(crate) fn run(arguments: &arguments::Campaign) -> Result<(), Failure> {
    let campaign = Campaign::open(&arguments.file).map_err(Failure::input)?;
    let layout = Layout::new(&campaign).map_err(Failure::input)?;
    let blocks = layout.blocks().map_err(Failure::input)?;
    // With every engine: the scores are read here.
    super::fleet::refuse_address(
        &arguments.store,
        "in Python phugoid.campaign(..., store=...), which gives no scores",
    )?;
    let (store, summary) = match &arguments.engine {
        Engine::Local => {
            let store = Store::create(&arguments.store)?;
            let share = Share { workers: arguments.workers.map_or(0, usize::from), shard: arguments.shard };
            let bar = Bar::new("flights");
            let stop = AtomicBool::new(false);
            let summary = run_campaign(&layout, &blocks, &store, share, &|progress| bar.set(progress), &stop)?;
            (store, summary)
        }
        Engine::Ray(address) => {
            let request = serde_json::json!({
                "file": arguments.file,
                "store": arguments.store,
                "engine": "ray",
                "workers": arguments.workers.unwrap_or(0),
                "shard": arguments.shard.to_string(),
                "address": address,
            });
            let summary = super::on_ray::run("campaign", request)?;
            (Store::open(&arguments.store)?, summary)
        }
    };
    // The store may hold other campaigns: only what this one asks for is scored, by whichever shard it was flown.
    let mut scoring = Scoring::default();
    // A flight that is asked for twice, as a design over listed values does, is one.
    let mut seen = HashSet::new();
    for block in blocks.iter().filter(|block| seen.insert(&block.key)) {
        scoring.add(&store.unit_rows("campaign", &block.model_sha256, &block.key, &COLUMNS)?);
    }
    let unscored = scoring.unscored();
    let document = Document { name: campaign.name, summary, scores: scoring.scores(), unscored };
    deliver(&document, arguments.delivery.json, arguments.delivery.out.as_deref(), || text(&document, &store))?;
    let is_empty = |without: &Unscored| without.refused > 0 && without.without_truth == 0;
    match document.scores.is_empty() && !document.unscored.is_empty() && document.unscored.iter().all(is_empty) {
        true => Err(Failure::impossible("no estimation of the campaign has numbers: the table above says why")),
        false => Ok(()),
    }
}

fn text(document: &Document, store: &Store) -> String {
    let s = &document.summary;
    let mut table = Table::with_words(
        &[
            "scenario",
            "model",
            "method",
            "parameter",
            "flights",
            "refused",
            "rmse",
            "error",
            "after",
            "covered",
            "95 %",
        ],
        &[0, 1, 2, 3],
    );
    for score in &document.scores {
        table.row([
            score.scenario.clone(),
            score.model.clone(),
            score.method.clone(),
            score.parameter.clone(),
            score.estimations.to_string(),
            score.refused.to_string(),
            significant(score.rmse, 3),
            percent(score.median_error),
            if score.converged_s.is_finite() {
                format!("{} s", significant(score.converged_s, 3))
            } else {
                "-".to_owned()
            },
            percent(score.coverage),
            match score.coverage.is_finite() {
                true => format!("{} to {}", percent(score.interval[0]), percent(score.interval[1])),
                false => "-".to_owned(),
            },
        ]);
    }
    format!(
        "{}\n{} estimations asked for: {} made ({} of them refused), {} in the store before, {} of other shards, {} asked for twice\n{} rows \
         written to {}\n\n{}Error: median, as a part of the truth. After: median time from which on the estimate stays near \
         its end.\nCovered: truth within two standard errors.\n",
        document.name,
        s.files,
        s.estimated,
        s.refused,
        s.found,
        s.of_others,
        s.copies,
        s.rows,
        store.folder().display(),
        table.render()
    ) + bound_in_words(&document.scores)
        + &without_score(&document.unscored)
}

/// What stands in the table where no method has estimated.
fn bound_in_words(scores: &[Score]) -> &'static str {
    match scores.iter().any(|score| score.method == CRAMER_RAO) {
        true => "Of cramer-rao rmse is the bound: the smallest that an unbiased method can have.\n",
        false => "",
    }
}

/// What the table of scores cannot show.
fn without_score(unscored: &[Unscored]) -> String {
    let line = |without: &Unscored| {
        let Unscored { scenario, model, method, refused, refusal, message, without_truth } = without;
        let mut line = format!("  {scenario}, {model}, {method}:");
        if *refused > 0 {
            line += &format!(" {refused} without numbers ({refusal}: {message})");
        }
        if *without_truth > 0 {
            line += &format!(" {without_truth} estimates of parameters whose truth the scenario does not give");
        }
        line + "\n"
    };
    let lines: String = unscored.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("\nWithout a score:\n{lines}") }
}

fn percent(part: f64) -> String {
    if part.is_finite() { format!("{} %", significant(100.0 * part, 3)) } else { "-".to_owned() }
}
