//! Functions of optional features that this FMU does not have: its model description says so, and calls are refused.

use std::ffi::c_int;

use crate::handle::{Problem, call};
use crate::types::{Boolean, Instance, Reference, Status};

macro_rules! absent {
    ($($name:ident($($kind:ty),*): $why:literal;)*) => {$(
        absent!(@one $name, $why, [$($kind),*], [a b c d e f g h], []);
    )*};
    (@one $name:ident, $why:literal, [], [$($left:ident)*], [$($argument:ident: $kind:ty,)*]) => {
        /// # Safety
        /// What the standard asks of the caller; see the crate.
        #[unsafe(no_mangle)]
        pub(crate) unsafe extern "C" fn $name(instance: Instance, $($argument: $kind),*) -> Status {
            $(let _ = $argument;)*
            // SAFETY: what the standard asks of the caller.
            unsafe { call(instance, stringify!($name), |_| Err(Problem::Other($why.to_owned()))) }
        }
    };
    (@one $name:ident, $why:literal, [$first:ty $(, $rest:ty)*], [$word:ident $($left:ident)*], [$($done:tt)*]) => {
        absent!(@one $name, $why, [$($rest),*], [$($left)*], [$($done)* $word: $first,]);
    };
}

type References = *const Reference;

absent! {
    fmi3GetClock(References, usize, *mut Boolean): "this FMU has no clocks";
    fmi3SetClock(References, usize, *const Boolean): "this FMU has no clocks";
    fmi3GetIntervalDecimal(References, usize, *mut f64, *mut c_int): "this FMU has no clocks";
    fmi3GetIntervalFraction(References, usize, *mut u64, *mut u64, *mut c_int): "this FMU has no clocks";
    fmi3GetShiftDecimal(References, usize, *mut f64): "this FMU has no clocks";
    fmi3GetShiftFraction(References, usize, *mut u64, *mut u64): "this FMU has no clocks";
    fmi3SetIntervalDecimal(References, usize, *const f64): "this FMU has no clocks";
    fmi3SetIntervalFraction(References, usize, *const u64, *const u64): "this FMU has no clocks";
    fmi3SetShiftDecimal(References, usize, *const f64): "this FMU has no clocks";
    fmi3SetShiftFraction(References, usize, *const u64, *const u64): "this FMU has no clocks";
    fmi3ActivateModelPartition(Reference, f64): "this FMU has no clocks";
    fmi3EvaluateDiscreteStates(): "this FMU has no discrete states";
    fmi3EnterConfigurationMode(): "this FMU has no structural parameters";
    fmi3ExitConfigurationMode(): "this FMU has no structural parameters";
    fmi3GetNumberOfVariableDependencies(Reference, *mut usize): "this FMU tells no dependencies of single elements";
    fmi3GetVariableDependencies(Reference, *mut usize, *mut Reference, *mut usize, *mut c_int, usize):
        "this FMU tells no dependencies of single elements";
    fmi3GetDirectionalDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize):
        "this FMU gives no directional derivatives";
    fmi3GetAdjointDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize):
        "this FMU gives no adjoint derivatives";
}
