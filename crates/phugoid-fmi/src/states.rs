//! The state of an FMU, kept and written down.

use std::ffi::c_void;

use phugoid_fmu::Instance as Flown;

use crate::handle::{Problem, call, give, room, values};
use crate::types::{FmuState, Instance, OK, Status};

/// What an `fmi3FMUState` points to.
struct Kept(Vec<u8>);

/// # Safety
/// `state` is null or a pointer of [`fmi3GetFMUState`] that was not freed.
unsafe fn kept<'a>(state: FmuState) -> Result<&'a Kept, Problem> {
    if state.is_null() || !state.cast::<Kept>().is_aligned() {
        return Err(Problem::Pointer("the state of the FMU"));
    }
    // SAFETY: it is not null and aligned; the rest is what the caller promises.
    Ok(unsafe { &*state.cast::<Kept>() })
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetFMUState(instance: Instance, state: *mut FmuState) -> Status {
    // SAFETY: what the standard asks of the caller. A state that is there already is from this function.
    unsafe {
        call(instance, "fmi3GetFMUState", |handle| {
            let [place] = room(state, 1, "the state of the FMU")? else {
                return Err(Problem::Pointer("the state of the FMU"));
            };
            let now = Kept(handle.instance.written());
            if place.is_null() {
                *place = Box::into_raw(Box::new(now)).cast::<c_void>();
            } else if place.cast::<Kept>().is_aligned() {
                *place.cast::<Kept>() = now;
            } else {
                return Err(Problem::Pointer("the state of the FMU"));
            }
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SetFMUState(instance: Instance, state: FmuState) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3SetFMUState", |handle| {
            handle.instance.restore(&kept(state)?.0)?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3FreeFMUState(instance: Instance, state: *mut FmuState) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3FreeFMUState", |_| {
            // The standard ignores what is not there.
            if state.is_null() || !state.is_aligned() || (*state).is_null() {
                return Ok(OK);
            }
            kept(*state)?;
            drop(Box::from_raw((*state).cast::<Kept>()));
            *state = std::ptr::null_mut();
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: Instance,
    state: FmuState,
    size: *mut usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3SerializedFMUStateSize", |_| {
            give(size, kept(state)?.0.len(), "the size")?;
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SerializeFMUState(
    instance: Instance,
    state: FmuState,
    out: *mut u8,
    size: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3SerializeFMUState", |_| {
            let bytes = &kept(state)?.0;
            if size < bytes.len() {
                return Err(Problem::Other(format!("room for {size} bytes, and the state has {}", bytes.len())));
            }
            room(out, bytes.len(), "the bytes")?.copy_from_slice(bytes);
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: Instance,
    given: *const u8,
    size: usize,
    state: *mut FmuState,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3DeserializeFMUState", |_| {
            // What is no state is refused before memory is asked for.
            let bytes = values(given, size.min(Flown::WRITTEN + 1), "the bytes")?;
            Flown::check_written(bytes)?;
            give(state, Box::into_raw(Box::new(Kept(bytes.to_vec()))).cast::<c_void>(), "the state of the FMU")?;
            Ok(OK)
        })
    }
}
