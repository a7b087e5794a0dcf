//! `phugoid fleet analyses`.

use phugoid_fleet::analysis::documents;
use phugoid_flight_data::output_file;

use crate::arguments::fleet::Analyses;
use crate::failure::Failure;
use crate::output::{json, print};

/// Writes a document for each log.
pub(super) fn run(arguments: &Analyses) -> Result<(), Failure> {
    let (rows, logs, findings) = super::fleet_tell::told(&arguments.store, &arguments.asking)?;
    let documents = documents(&rows, &logs, &findings);
    std::fs::create_dir_all(&arguments.dir).map_err(|e| Failure::writing_of("--dir", &arguments.dir, e))?;
    for document in &documents {
        let file = arguments.dir.join(format!("{}.json", document.log.log_sha256));
        output_file::write(&file, json(document)?).map_err(|e| Failure::writing_of("--dir", &file, e))?;
    }
    print(&format!("Documents: {} in {}\n", documents.len(), arguments.dir.display()))
}
