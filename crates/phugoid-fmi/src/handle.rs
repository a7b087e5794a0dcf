//! What an `fmi3Instance` points to, and the way of every call to it.

use std::ffi::{CString, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

use phugoid_fmu::{Instance, InstanceError, Interface};

use crate::types::{DISCARD, ERROR, Environment, LogMessage, OK, Reference, Status, Text, WARNING};

/// An instance, and how to tell its importing program something.
pub(crate) struct Handle {
    pub(crate) instance: Instance,
    pub(crate) logger: Logger,
}

/// Where messages go.
pub(crate) struct Logger {
    pub(crate) environment: Environment,
    pub(crate) callback: LogMessage,
}

impl Logger {
    /// Tells the importing program. Without a callback there is nobody to tell.
    pub(crate) fn log(&self, status: Status, message: &str) {
        let Some(callback) = self.callback else { return };
        let category = if status == WARNING { c"logStatusWarning" } else { c"logStatusError" };
        // A text of C ends at its first zero.
        let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
        // SAFETY: the importing program has given this function for such calls; both texts outlive the call.
        unsafe { callback(self.environment, status, category.as_ptr(), message.as_ptr()) };
    }
}

/// Why a call is refused.
#[derive(Debug)]
pub(crate) enum Problem {
    /// By the instance.
    Instance(InstanceError),
    /// A pointer that is null, or an array that no memory can hold.
    Pointer(&'static str),
    /// Anything else, in a sentence.
    Other(String),
}

impl From<InstanceError> for Problem {
    fn from(error: InstanceError) -> Self {
        Self::Instance(error)
    }
}

impl Problem {
    pub(crate) fn status(&self) -> Status {
        match self {
            Self::Instance(error) if error.is_of_this_point() => DISCARD,
            _ => ERROR,
        }
    }

    pub(crate) fn message(&self, function: &str) -> String {
        match self {
            Self::Instance(error) => format!("{function}: {error}"),
            Self::Pointer(what) => {
                format!("{function}: the pointer to {what} is null, or the number of its values impossible")
            }
            Self::Other(text) => format!("{function}: {text}"),
        }
    }
}

/// What a panic says.
pub(crate) fn panic_message(function: &str, panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a message");
    format!("{function}: a defect of Phugoid, please report it: {text}")
}

/// Calls with the instance that a pointer leads to, and tells its importing program what is wrong.
///
/// # Safety
/// `instance` is null, or a pointer that instantiating gave and that was not freed; nothing else uses it during the call.
pub(crate) unsafe fn call(
    instance: *mut c_void,
    function: &'static str,
    body: impl FnOnce(&mut Handle) -> Result<Status, Problem>,
) -> Status {
    if instance.is_null() || !instance.cast::<Handle>().is_aligned() {
        return ERROR;
    }
    // SAFETY: it is not null and aligned; the rest is what the caller promises.
    let handle = unsafe { &mut *instance.cast::<Handle>() };
    match catch_unwind(AssertUnwindSafe(|| body(handle))) {
        Ok(Ok(status)) => status,
        Ok(Err(problem)) => {
            let status = problem.status();
            handle.logger.log(status, &problem.message(function));
            status
        }
        Err(panic) => {
            handle.logger.log(ERROR, &panic_message(function, panic.as_ref()));
            ERROR
        }
    }
}

/// Tells what is outside the data of the aircraft; the status is then a warning.
pub(crate) fn warned(handle: &mut Handle) -> Status {
    let warnings = handle.instance.warnings();
    for warning in &warnings {
        handle.logger.log(WARNING, warning);
    }
    if warnings.is_empty() { OK } else { WARNING }
}

/// Refuses a function of the other interface.
pub(crate) fn only(handle: &Handle, interface: Interface) -> Result<(), Problem> {
    if handle.instance.interface() == interface {
        return Ok(());
    }
    let of = match interface {
        Interface::ModelExchange => "model exchange",
        Interface::CoSimulation => "co-simulation",
    };
    Err(Problem::Other(format!("the function is for {of} alone, and the FMU was instantiated for the other interface")))
}

/// The values that a pointer of C leads to.
///
/// # Safety
/// `pointer` is null or leads to `count` values that nothing changes while they are used.
pub(crate) unsafe fn values<'a, T>(pointer: *const T, count: usize, what: &'static str) -> Result<&'a [T], Problem> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() || !pointer.is_aligned() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Problem::Pointer(what));
    }
    // SAFETY: it is not null, aligned, and no longer than memory; the rest is what the caller promises.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// The room that a pointer of C leads to.
///
/// # Safety
/// `pointer` is null or leads to room for `count` initialised values that nothing else uses.
pub(crate) unsafe fn room<'a, T>(pointer: *mut T, count: usize, what: &'static str) -> Result<&'a mut [T], Problem> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() || !pointer.is_aligned() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Problem::Pointer(what));
    }
    // SAFETY: it is not null, aligned, and no longer than memory; the rest is what the caller promises.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// Writes one value, if there is room for it.
///
/// # Safety
/// `pointer` is null or leads to room for one value.
pub(crate) unsafe fn give<T>(pointer: *mut T, value: T, what: &'static str) -> Result<(), Problem> {
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(Problem::Pointer(what));
    }
    // SAFETY: it is not null and aligned; the rest is what the caller promises.
    unsafe { pointer.write(value) };
    Ok(())
}

/// The bytes of a text of C.
///
/// # Safety
/// `text` is null or leads to a text that ends with a zero and that nothing changes while it is used.
pub(crate) unsafe fn bytes<'a>(text: Text, what: &'static str) -> Result<&'a [u8], Problem> {
    if text.is_null() {
        return Err(Problem::Pointer(what));
    }
    // SAFETY: it is not null; the rest is what the caller promises.
    Ok(unsafe { std::ffi::CStr::from_ptr(text) }.to_bytes())
}

/// Refuses arrays of references and values of different lengths: every variable has one value.
pub(crate) fn pairs(references: &[Reference], values: usize) -> Result<(), Problem> {
    if references.len() == values {
        return Ok(());
    }
    Err(Problem::Other(format!("{} value references and {values} values: every variable has one", references.len())))
}
