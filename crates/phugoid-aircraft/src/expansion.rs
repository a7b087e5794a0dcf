//! Derivatives of functions that are known by their values.

use phugoid_flight_dynamics::scalar::Scalar;

/// The values of a function with their derivatives, from values at the real parts and, unless the scalar is a plain number,
/// from central differences between the ends `between` of each variable.
pub(crate) fn expanded<T: Scalar, const N: usize, const M: usize>(
    x: [T; N],
    function: impl Fn(&[f64; N]) -> [f64; M],
    between: impl Fn(usize, f64) -> [f64; 2],
) -> [T; M] {
    let real = x.map(Scalar::real);
    let mut values = function(&real).map(T::from);
    if T::IS_REAL {
        return values;
    }
    for i in 0..N {
        let ends = between(i, real[i]);
        let [below, above] = ends.map(|end| {
            let mut moved = real;
            moved[i] = end;
            function(&moved)
        });
        let step = x[i] - real[i];
        for (k, value) in values.iter_mut().enumerate() {
            *value = *value + step * ((above[k] - below[k]) / (ends[1] - ends[0]));
        }
    }
    values
}
