//! Entry points into the estimators' own code, compiled as it is for a flight computer. `scripts/check-proofs.py` executes them
//! with symbols in place of numbers and proves what holds whatever the symbols stand for.
//!
//! The sources are those of the library, taken by their paths: most of what is of interest is private to it. The names of
//! the modules are the library's, so that their paths to each other are right here too.
#![no_std]
#![no_main]
#![allow(dead_code, unused_imports, missing_docs, unreachable_pub)]

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering};

#[path = "../../src/bounded.rs"]
mod bounded;
#[path = "../../src/change_detection/mod.rs"]
mod change_detection;
#[path = "../../src/columns.rs"]
mod columns;
#[path = "../../src/dense.rs"]
mod dense;
#[path = "../../src/discretization.rs"]
mod discretization;
#[path = "../../src/innovation.rs"]
mod innovation;
#[path = "../../src/kernels.rs"]
mod kernels;
#[path = "../../src/levels/mod.rs"]
mod levels;
#[path = "../../src/model.rs"]
mod model;
#[path = "../../src/settings/mod.rs"]
mod settings;
#[path = "../../src/statistics.rs"]
mod statistics;
#[path = "../../src/ud.rs"]
mod ud;

/// Those of the supervisor's modules that are of interest, with the entry points into what only the supervisor sees.
mod supervisor {
    #[path = "../../../src/supervisor/faults.rs"]
    pub(crate) mod faults;
    #[path = "../../../src/supervisor/history.rs"]
    mod history;
    #[path = "../../../src/supervisor/probation.rs"]
    mod probation;

    pub(crate) mod entries;
}

mod entries;

static PANICS: AtomicU32 = AtomicU32::new(0);

/// Every panic ends here; the script takes arriving here for a violation.
#[panic_handler]
#[inline(never)]
fn stop(reason: &core::panic::PanicInfo<'_>) -> ! {
    black_box(reason);
    PANICS.store(1, Ordering::Relaxed);
    loop {
        core::hint::spin_loop();
    }
}

/// The linker keeps what is reached from here.
#[unsafe(no_mangle)]
pub extern "C" fn _start() {
    entries::keep();
    supervisor::entries::keep();
}
