//! The estimates as a table.

use std::fmt::Write as _;

use crate::estimation::Estimation;

/// One row per parameter: value, one-sigma error of the covariance, the same corrected for the colour of the residuals, bounds of two of these,
/// status, whether it is a nuisance, and the truth where it is known. Derivatives per radian, all else SI; empty where there is none.
///
/// ```text
/// name,value,std_error,corrected_std_error,lower,upper,status,nuisance,truth
/// Cm_alpha,-0.99762,0.0101,0.0203,-1.0382,-0.957,converged,false,
/// ```
pub fn csv(estimation: &Estimation) -> String {
    let mut text = "name,value,std_error,corrected_std_error,lower,upper,status,nuisance,truth\n".to_owned();
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    for p in &estimation.parameters {
        // Writing to a string cannot fail. Names of parameters are words.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{}",
            p.name,
            number(p.value),
            number(p.std_error),
            number(p.corrected_std_error),
            number(p.lower),
            number(p.upper),
            p.status,
            p.nuisance,
            p.truth.map_or_else(String::new, number)
        );
    }
    text
}
