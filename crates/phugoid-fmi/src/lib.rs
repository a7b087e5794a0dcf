//! The shared library in an FMU of Phugoid: the C functions of FMI 3.0 over [`phugoid_fmu::Instance`], which says what each does.
//!
//! Every pointer is looked at before it is followed; a null pointer, like all else that is wrong, is answered with `fmi3Error` and
//! a message to the logger of the importing program. A panic, which would be a defect, ends at the boundary and is answered in the
//! same way. What C has to promise is what the standard says: pointers lead to as many values as is said, an instance is one that
//! was instantiated here and not freed, and no two threads call with the same instance at once.
//!
//! Functions of optional features (clocks, event indicators, variables of other types, derivatives of outputs) are there, because
//! importing programs look for them, and are refused.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
#![allow(non_snake_case)] // the names of the standard

mod absent;
mod co_simulation;
mod common;
mod handle;
mod model_exchange;
mod states;
mod types;
mod values;

/// Which library this is, for the program that packs it: format of the resources, version, platform.
const MARK: &str = concat!(
    "phugoid-fmi;format=1;version=",
    env!("CARGO_PKG_VERSION"),
    ";platform=",
    env!("PHUGOID_FMI_PLATFORM"),
    ";\n"
);

// The mark says the format as text.
const _: () = assert!(phugoid_fmu::FORMAT == 1);

/// The mark in the library's file: as an exported symbol no linker leaves it out.
#[unsafe(no_mangle)]
pub static PHUGOID_FMI: [u8; MARK.len()] = {
    let mut bytes = [0; MARK.len()];
    let mut i = 0;
    while i < MARK.len() {
        bytes[i] = MARK.as_bytes()[i];
        i += 1;
    }
    bytes
};
