//! Functions of model exchange: the importing program integrates.

use phugoid_fmu::{Interface, NOMINALS, STATES};

use crate::handle::{Handle, Problem, call, give, only, room, values, warned};
use crate::types::{Boolean, Instance, OK, Status};

/// A call of model exchange.
///
/// # Safety
/// As of [`call`].
unsafe fn exchange(
    instance: Instance,
    function: &'static str,
    body: impl FnOnce(&mut Handle) -> Result<Status, Problem>,
) -> Status {
    // SAFETY: what the caller promises.
    unsafe {
        call(instance, function, |handle| {
            only(handle, Interface::ModelExchange)?;
            body(handle)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: Instance) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3EnterContinuousTimeMode", |handle| {
            handle.instance.enter_continuous_time_mode()?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: Instance,
    _no_set_state_prior: Boolean,
    enter_event_mode: *mut Boolean,
    terminate_simulation: *mut Boolean,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3CompletedIntegratorStep", |handle| {
            give(enter_event_mode, 0, "enterEventMode")?;
            give(terminate_simulation, 0, "terminateSimulation")?;
            Ok(warned(handle))
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SetTime(instance: Instance, time: f64) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3SetTime", |handle| {
            handle.instance.set_time(time)?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SetContinuousStates(
    instance: Instance,
    states: *const f64,
    count: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3SetContinuousStates", |handle| {
            handle.instance.set_states(values(states, count, "the states")?)?;
            Ok(OK)
        })
    }
}

/// Gives one number for each state.
///
/// # Safety
/// `out` is null or leads to room for `count` numbers.
unsafe fn give_states(numbers: [f64; STATES], out: *mut f64, count: usize) -> Result<Status, Problem> {
    if count != STATES {
        return Err(Problem::Other(format!("room for {count} values, and there are {STATES} continuous states")));
    }
    // SAFETY: what the caller promises.
    unsafe { room(out, count, "the values")? }.copy_from_slice(&numbers);
    Ok(OK)
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    instance: Instance,
    out: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3GetContinuousStateDerivatives", |handle| {
            give_states(handle.instance.derivatives()?, out, count)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetContinuousStates(instance: Instance, out: *mut f64, count: usize) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe { exchange(instance, "fmi3GetContinuousStates", |handle| give_states(handle.instance.states(), out, count)) }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    instance: Instance,
    out: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe { exchange(instance, "fmi3GetNominalsOfContinuousStates", |_| give_states(NOMINALS, out, count)) }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: Instance, out: *mut usize) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3GetNumberOfContinuousStates", |_| {
            give(out, STATES, "the number")?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetNumberOfEventIndicators(instance: Instance, out: *mut usize) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3GetNumberOfEventIndicators", |_| {
            give(out, 0, "the number")?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetEventIndicators(instance: Instance, _out: *mut f64, count: usize) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        exchange(instance, "fmi3GetEventIndicators", |_| match count {
            0 => Ok(OK),
            _ => Err(Problem::Other("this FMU has no event indicators".to_owned())),
        })
    }
}
