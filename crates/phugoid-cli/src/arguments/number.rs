//! Numbers and quantities of the command line that are whole or above zero.
//!
//! Their options take values that begin with a minus sign, so that the value is refused here with what is wrong with it and not as
//! an option that nobody knows.

use phugoid_simulation::quantity::Quantity;

/// A whole number from 0 up.
pub(super) fn whole<T: TryFrom<u64>>(text: &str) -> Result<T, String> {
    let number = text.parse::<u64>().ok().and_then(|number| T::try_from(number).ok());
    number.ok_or_else(|| "write a whole number, 0 or more, as in 7".to_owned())
}

/// A quantity above zero.
pub(super) fn above_zero<T: Quantity>(text: &str) -> Result<T, String> {
    let quantity: T = text.parse().map_err(|error: T::Err| error.to_string())?;
    is_above_zero(quantity.si())?;
    Ok(quantity)
}

/// A number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("write a positive number, as in 0.5".to_owned()),
    }
}

/// The value, or why it is refused.
pub(super) fn is_above_zero(value: f64) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err("it must be above zero".to_owned()) }
}

/// The number of a manoeuvre.
pub(super) fn manoeuvre(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "write the number of a manoeuvre as `phugoid inspect` lists them, as in 2".to_owned())
}

/// The number of one of several manoeuvres.
pub(super) fn manoeuvres(text: &str) -> Result<usize, String> {
    manoeuvre(text).map_err(|why| format!("{why}; several of them are separated by commas, as in 1,3"))
}
