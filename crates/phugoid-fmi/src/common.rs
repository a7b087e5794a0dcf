//! Functions of both interfaces: version, instances, initialisation, end.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use phugoid_fmu::{Instance as Flown, Interface, Resources};

use crate::handle::{Handle, Logger, Problem, bytes, call, give, panic_message, values, warned};
use crate::types::{Boolean, ERROR, Environment, Instance, LogMessage, OK, Reference, Status, Text, Unused};

#[unsafe(no_mangle)]
pub(crate) extern "C" fn fmi3GetVersion() -> Text {
    c"3.0".as_ptr()
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SetDebugLogging(
    instance: Instance,
    _logging_on: Boolean,
    count: usize,
    categories: *const Text,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3SetDebugLogging", |_| {
            // There are no messages for debugging: those that there are, say what is wrong, and are always given.
            for category in values(categories, count, "the categories")? {
                let category = bytes(*category, "a category")?;
                if !matches!(category, b"logStatusWarning" | b"logStatusError") {
                    let category = String::from_utf8_lossy(category);
                    return Err(Problem::Other(format!("there is no category of messages `{category}`")));
                }
            }
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: Text,
    token: Text,
    resources: Text,
    _visible: Boolean,
    _logging_on: Boolean,
    environment: Environment,
    callback: LogMessage,
) -> Instance {
    let logger = Logger { environment, callback };
    // SAFETY: what the standard asks of the caller.
    unsafe { instantiated("fmi3InstantiateModelExchange", token, resources, logger, Interface::ModelExchange) }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: Text,
    token: Text,
    resources: Text,
    _visible: Boolean,
    _logging_on: Boolean,
    event_mode_used: Boolean,
    _early_return_allowed: Boolean,
    _required_intermediate_variables: *const Reference,
    _count: usize,
    environment: Environment,
    callback: LogMessage,
    _intermediate_update: Unused,
) -> Instance {
    const FUNCTION: &str = "fmi3InstantiateCoSimulation";
    let logger = Logger { environment, callback };
    if event_mode_used != 0 {
        logger.log(ERROR, &format!("{FUNCTION}: this FMU has no event mode: set eventModeUsed to fmi3False"));
        return std::ptr::null_mut();
    }
    // SAFETY: what the standard asks of the caller.
    unsafe { instantiated(FUNCTION, token, resources, logger, Interface::CoSimulation) }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: Boolean,
    _logging_on: Boolean,
    environment: Environment,
    callback: LogMessage,
    _clock_update: Unused,
    _lock: Unused,
    _unlock: Unused,
) -> Instance {
    Logger { environment, callback }.log(
        ERROR,
        "fmi3InstantiateScheduledExecution: this FMU is for model exchange and co-simulation, and has no clocks to schedule",
    );
    std::ptr::null_mut()
}

/// A new instance; null, and a message, where there can be none.
///
/// # Safety
/// The texts are null or end with a zero.
unsafe fn instantiated(
    function: &'static str,
    token: Text,
    resources: Text,
    logger: Logger,
    interface: Interface,
) -> Instance {
    let opened = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: what the caller promises.
        let token = unsafe { bytes(token, "the instantiation token")? };
        // SAFETY: what the caller promises.
        let folder = unsafe { bytes(resources, "the path of the resources")? };
        let opened = Resources::open(&path(folder)?).map_err(|error| Problem::Other(error.to_string()))?;
        if opened.token.as_bytes() != token {
            let token = String::from_utf8_lossy(token);
            return Err(Problem::Other(format!(
                "the instantiation token is `{token}`, and the resources are those of `{}`: model description and resources \
                 are of two FMUs",
                opened.token
            )));
        }
        Ok(Flown::new(opened, interface))
    }));
    let message = match opened {
        Ok(Ok(instance)) => return Box::into_raw(Box::new(Handle { instance, logger })).cast::<c_void>(),
        Ok(Err(problem)) => problem.message(function),
        Err(panic) => panic_message(function, panic.as_ref()),
    };
    logger.log(ERROR, &message);
    std::ptr::null_mut()
}

/// The folder that a text of C names.
#[cfg(unix)]
fn path(text: &[u8]) -> Result<PathBuf, Problem> {
    use std::os::unix::ffi::OsStrExt as _;
    Ok(PathBuf::from(std::ffi::OsStr::from_bytes(text)))
}

/// The folder that a text of C names.
#[cfg(not(unix))]
fn path(text: &[u8]) -> Result<PathBuf, Problem> {
    let text = std::str::from_utf8(text);
    text.map(PathBuf::from).map_err(|_| Problem::Other("the path of the resources is not UTF-8".to_owned()))
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3FreeInstance(instance: Instance) {
    if instance.is_null() || !instance.cast::<Handle>().is_aligned() {
        return;
    }
    // SAFETY: a pointer that was instantiated here and not freed.
    let handle = unsafe { Box::from_raw(instance.cast::<Handle>()) };
    // There is nobody to tell.
    let _ = catch_unwind(AssertUnwindSafe(|| drop(handle)));
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: Instance,
    _tolerance_defined: Boolean,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: Boolean,
    _stop_time: f64,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3EnterInitializationMode", |handle| {
            handle.instance.enter_initialization(start_time)?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3ExitInitializationMode(instance: Instance) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3ExitInitializationMode", |handle| {
            handle.instance.exit_initialization()?;
            Ok(warned(handle))
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3EnterEventMode(instance: Instance) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3EnterEventMode", |handle| {
            handle.instance.enter_event_mode()?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: Instance,
    discrete_states_need_update: *mut Boolean,
    terminate_simulation: *mut Boolean,
    nominals_changed: *mut Boolean,
    values_changed: *mut Boolean,
    next_event_time_defined: *mut Boolean,
    next_event_time: *mut f64,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3UpdateDiscreteStates", |handle| {
            handle.instance.update_discrete_states()?;
            give(discrete_states_need_update, 0, "discreteStatesNeedUpdate")?;
            give(terminate_simulation, 0, "terminateSimulation")?;
            give(nominals_changed, 0, "nominalsOfContinuousStatesChanged")?;
            give(values_changed, 0, "valuesOfContinuousStatesChanged")?;
            give(next_event_time_defined, 0, "nextEventTimeDefined")?;
            give(next_event_time, 0.0, "nextEventTime")?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3Terminate(instance: Instance) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3Terminate", |handle| {
            handle.instance.terminate()?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3Reset(instance: Instance) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3Reset", |handle| {
            handle.instance.reset();
            Ok(OK)
        })
    }
}
