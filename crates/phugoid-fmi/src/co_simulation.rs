//! Functions of co-simulation: the FMU integrates.

use phugoid_fmu::Interface;

use crate::handle::{Problem, call, give, only, warned};
use crate::types::{Boolean, Instance, Reference, Status};

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3DoStep(
    instance: Instance,
    point: f64,
    size: f64,
    _no_set_state_prior: Boolean,
    event_handling_needed: *mut Boolean,
    terminate_simulation: *mut Boolean,
    early_return: *mut Boolean,
    last_successful_time: *mut f64,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3DoStep", |handle| {
            only(handle, Interface::CoSimulation)?;
            give(event_handling_needed, 0, "eventHandlingNeeded")?;
            give(terminate_simulation, 0, "terminateSimulation")?;
            give(early_return, 0, "earlyReturn")?;
            give(last_successful_time, handle.instance.point().time, "lastSuccessfulTime")?;
            handle.instance.do_step(point, size)?;
            give(last_successful_time, handle.instance.point().time, "lastSuccessfulTime")?;
            Ok(warned(handle))
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3EnterStepMode(instance: Instance) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3EnterStepMode", |_| {
            Err(Problem::Other("this FMU has no event mode in co-simulation, and is in step mode already".to_owned()))
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: Instance,
    _references: *const Reference,
    _reference_count: usize,
    _orders: *const i32,
    _values: *mut f64,
    _count: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3GetOutputDerivatives", |_| {
            Err(Problem::Other("this FMU gives no derivatives of outputs (maxOutputDerivativeOrder is 0)".to_owned()))
        })
    }
}
