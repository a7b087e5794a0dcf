//! Values of variables. All are `fmi3Float64`.

use crate::handle::{Problem, call, pairs, room, values};
use crate::types::{Boolean, Instance, OK, Reference, Status, Text};

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3GetFloat64(
    instance: Instance,
    references: *const Reference,
    reference_count: usize,
    out: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3GetFloat64", |handle| {
            let references = values(references, reference_count, "the value references")?;
            pairs(references, count)?;
            for (reference, value) in references.iter().zip(room(out, count, "the values")?) {
                *value = handle.instance.get(*reference)?;
            }
            Ok(OK)
        })
    }
}

/// # Safety
/// What the standard asks of the caller; see the crate.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fmi3SetFloat64(
    instance: Instance,
    references: *const Reference,
    reference_count: usize,
    given: *const f64,
    count: usize,
) -> Status {
    // SAFETY: what the standard asks of the caller.
    unsafe {
        call(instance, "fmi3SetFloat64", |handle| {
            let references = values(references, reference_count, "the value references")?;
            pairs(references, count)?;
            let given = values(given, count, "the values")?;
            // All or none.
            for (reference, value) in references.iter().zip(given) {
                handle.instance.check(*reference, *value)?;
            }
            for (reference, value) in references.iter().zip(given) {
                handle.instance.set(*reference, *value)?;
            }
            Ok(OK)
        })
    }
}

/// Functions for variables of a type that no variable has: fine for no variable, refused for any.
macro_rules! no_variables {
    ($($name:ident($value:ty $(, $more:ident: $kind:ty)*);)*) => {$(
        /// # Safety
        /// What the standard asks of the caller; see the crate.
        #[unsafe(no_mangle)]
        pub(crate) unsafe extern "C" fn $name(
            instance: Instance,
            _references: *const Reference,
            reference_count: usize,
            $($more: $kind,)*
            _values: $value,
            _count: usize,
        ) -> Status {
            $(let _ = $more;)*
            // SAFETY: what the standard asks of the caller.
            unsafe { call(instance, stringify!($name), |_| none_of_type(reference_count)) }
        }
    )*};
}

pub(crate) fn none_of_type(count: usize) -> Result<Status, Problem> {
    if count == 0 {
        return Ok(OK);
    }
    Err(Problem::Other("all variables of this FMU are of the type Float64".to_owned()))
}

no_variables! {
    fmi3GetFloat32(*mut f32);
    fmi3GetInt8(*mut i8);
    fmi3GetUInt8(*mut u8);
    fmi3GetInt16(*mut i16);
    fmi3GetUInt16(*mut u16);
    fmi3GetInt32(*mut i32);
    fmi3GetUInt32(*mut u32);
    fmi3GetInt64(*mut i64);
    fmi3GetUInt64(*mut u64);
    fmi3GetBoolean(*mut Boolean);
    fmi3GetString(*mut Text);
    fmi3GetBinary(*mut *const u8, _sizes: *mut usize);
    fmi3SetFloat32(*const f32);
    fmi3SetInt8(*const i8);
    fmi3SetUInt8(*const u8);
    fmi3SetInt16(*const i16);
    fmi3SetUInt16(*const u16);
    fmi3SetInt32(*const i32);
    fmi3SetUInt32(*const u32);
    fmi3SetInt64(*const i64);
    fmi3SetUInt64(*const u64);
    fmi3SetBoolean(*const Boolean);
    fmi3SetString(*const Text);
    fmi3SetBinary(*const *const u8, _sizes: *const usize);
}
