//! Stands for the crate of this name in the proofs: each function may answer anything, but the same for the same number. What is
//! proved with it holds whatever the real functions answer.
#![no_std]

use core::hint::black_box;

macro_rules! functions {
    ($($name:ident $symbol:ident),*) => {$(
        /// Known to the script by its name.
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $symbol(x: f64) -> f64 {
            black_box(x)
        }

        /// As that of the crate that this one stands for.
        #[inline(always)]
        pub fn $name(x: f64) -> f64 {
            $symbol(x)
        }
    )*};
}

functions!(ceil library_ceil, exp library_exp, log library_log, round library_round, sqrt library_sqrt);
