//! The published cases with the F-16, embedded.

use super::AircraftCase;
use crate::accuracy::StudyError;
use crate::reproduction::Reproduction;
use crate::reproduction::embedded::{case, cases};

cases! {
    "dcm-alpha"/1: "dCm_alpha, case 1: doublet",
    "dcm-alpha"/2: "dCm_alpha, case 2: doublet, start above the truth",
    "dcm-alpha"/3: "dCm_alpha, case 3: doublet, start far away",
    "dcm-alpha"/4: "dCm_alpha, case 4: 1 Hz sine",
    "dcm-q"/1: "dCm_q, case 1: 1 Hz sine",
    "dcm-q"/2: "dCm_q, case 2: 1 Hz sine, narrower bounds",
    "dcm-q"/3: "dCm_q, case 3: doublet, smaller eta",
    "dcl-alpha"/1: "dCL_alpha, case 1: 1 Hz sine",
    "dcl-alpha"/2: "dCL_alpha, case 2: 1 Hz sine, start far above",
    "dcl-alpha"/3: "dCL_alpha, case 3: 1 Hz sine of 0.3 deg",
    "dcd-alpha"/1: "dCD_alpha, case 1: 1 Hz sine",
    "dcd-alpha"/2: "dCD_alpha, case 2: doublet",
    "combined"/1: "All four at once from one elevator input",
}

/// A published case by id, e.g. `dcm-q/2`.
///
/// # Errors
/// [`StudyError::Unsuitable`]: there is none of that id.
pub fn published_case(id: &str) -> Result<AircraftCase, StudyError> {
    case(FILES, id, AircraftCase::parse)
}

/// Ids of the published cases with the F-16.
pub fn published_ids() -> impl Iterator<Item = &'static str> + Clone {
    FILES.iter().map(|(id, _)| *id)
}

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let result = published_case(id)?.run(id);
    progress(1.0);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_reads_and_bears_the_title_of_its_entry() {
        for entry in ENTRIES {
            let case = published_case(entry.id).unwrap();
            assert_eq!(case.title, entry.title, "{}", entry.id);
        }
        assert!(published_case("dcm-alpha/9").unwrap_err().to_string().contains("dcm-alpha/9"));
    }
}
