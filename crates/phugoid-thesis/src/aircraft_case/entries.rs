//! The published cases with the F-16, embedded.

use super::case::AircraftCase;
use crate::embedded::published_cases;

published_cases! {
    AircraftCase;
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
