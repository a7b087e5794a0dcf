//! The types of `fmi3PlatformTypes.h` and `fmi3FunctionTypes.h`.

use std::ffi::{c_char, c_int, c_void};

/// `fmi3Instance`.
pub(crate) type Instance = *mut c_void;
/// `fmi3InstanceEnvironment`: the importing program's own.
pub(crate) type Environment = *mut c_void;
/// `fmi3FMUState`.
pub(crate) type FmuState = *mut c_void;
/// `fmi3String`.
pub(crate) type Text = *const c_char;
/// `fmi3Boolean`, a `bool` of C: as a byte, because a Rust `bool` that is neither 0 nor 1 is undefined behaviour.
pub(crate) type Boolean = u8;
/// `fmi3ValueReference`.
pub(crate) type Reference = u32;
/// `fmi3LogMessageCallback`.
pub(crate) type LogMessage = Option<unsafe extern "C" fn(Environment, Status, Text, Text)>;
/// A callback that is never called.
pub(crate) type Unused = Option<unsafe extern "C" fn()>;

/// `fmi3Status`.
pub(crate) type Status = c_int;
/// `fmi3OK`.
pub(crate) const OK: Status = 0;
/// `fmi3Warning`: all went well, and a message says what to know.
pub(crate) const WARNING: Status = 1;
/// `fmi3Discard`: not possible at this point; a smaller step may be.
pub(crate) const DISCARD: Status = 2;
/// `fmi3Error`.
pub(crate) const ERROR: Status = 3;
