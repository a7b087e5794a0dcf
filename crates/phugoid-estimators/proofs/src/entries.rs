//! Entry points into the kernels, the lists of places, the factored covariance and the Cholesky factor.
//!
//! Numbers come by reference, because a function of C would get them in registers of the floating-point unit.

use crate::bounded::{Places, at};
use crate::dense::Cholesky;
use crate::kernels::{add_scaled, dot, rotate};
use crate::ud::Ud;

/// Longest slices that the kernels are tried with: the largest room on board.
pub(crate) const LONG: usize = 24;
/// Room of the covariance: the larger one that is compiled a second time for the case that it is full.
pub(crate) const ROOM: usize = 11;
/// Room of the lists of places.
pub(crate) const PLACES: usize = 24;
/// Room of the Cholesky factor.
pub(crate) const DENSE: usize = 6;

#[unsafe(no_mangle)]
pub extern "C" fn kernel_add_scaled(y: &mut [f64; LONG], n: usize, x: &[f64; LONG], m: usize, a: &f64) {
    add_scaled(&mut y[..n.min(LONG)], *a, &x[..m.min(LONG)]);
}

#[unsafe(no_mangle)]
pub extern "C" fn kernel_dot(x: &[f64; LONG], n: usize, y: &[f64; LONG], m: usize, out: &mut f64) {
    *out = dot(&x[..n.min(LONG)], &y[..m.min(LONG)]);
}

#[unsafe(no_mangle)]
pub extern "C" fn kernel_rotate(u: &mut [f64; LONG], n: usize, b: &mut [f64; LONG], m: usize, by: &[f64; 2]) {
    rotate(&mut u[..n.min(LONG)], &mut b[..m.min(LONG)], by[0], by[1]);
}

#[unsafe(no_mangle)]
pub extern "C" fn bounded_at(values: &[f64; PLACES], length: usize, place: usize, out: &mut f64) {
    *out = at(&values[..length.min(PLACES)], place);
}

#[unsafe(no_mangle)]
pub extern "C" fn places_none(places: &mut Places<PLACES>) {
    *places = Places::NONE;
}

#[unsafe(no_mangle)]
pub extern "C" fn places_push(places: &mut Places<PLACES>, column: usize) {
    places.push(column);
}

#[unsafe(no_mangle)]
pub extern "C" fn places_column(places: &Places<PLACES>, place: usize) -> usize {
    places.column(place)
}

#[unsafe(no_mangle)]
pub extern "C" fn places_len(places: &Places<PLACES>) -> usize {
    places.as_slice().len()
}

#[unsafe(no_mangle)]
pub extern "C" fn ud_from_variances(ud: &mut Ud<ROOM>, variances: &[f64; ROOM], n: usize) {
    *ud = Ud::from_variances(&variances[..n.min(ROOM)]);
}

/// A measurement, as the estimators take it: seen through the factors, then used.
#[unsafe(no_mangle)]
pub extern "C" fn ud_measure(ud: &mut Ud<ROOM>, a: &[f64; ROOM], r: &f64, variance: &mut f64, out: &mut [f64; ROOM]) {
    let projection = ud.project(a, *r);
    *variance = projection.variance;
    *out = ud.update(&projection, *r);
}

#[unsafe(no_mangle)]
pub extern "C" fn ud_predict(ud: &mut Ud<ROOM>, a: &[[f64; ROOM]; ROOM], q: &[f64; ROOM]) {
    ud.predict(a, q);
}

#[unsafe(no_mangle)]
pub extern "C" fn ud_add_rank_one(ud: &mut Ud<ROOM>, c: &f64, a: &[f64; ROOM]) {
    ud.add_rank_one(*c, a);
}

/// Factors in place and solves for one right side. One if the matrix was positive definite.
#[unsafe(no_mangle)]
pub extern "C" fn cholesky_solve(a: &mut [[f64; DENSE]; DENSE], n: usize, b: &mut [f64; DENSE]) -> usize {
    match Cholesky::new(a, n) {
        Some(factor) => {
            factor.solve(b);
            1
        }
        None => 0,
    }
}

/// Tells the linker that all of them are in use.
pub(crate) fn keep() {
    core::hint::black_box(kernel_add_scaled as *const ());
    core::hint::black_box(kernel_dot as *const ());
    core::hint::black_box(kernel_rotate as *const ());
    core::hint::black_box(bounded_at as *const ());
    core::hint::black_box(places_none as *const ());
    core::hint::black_box(places_push as *const ());
    core::hint::black_box(places_column as *const ());
    core::hint::black_box(places_len as *const ());
    core::hint::black_box(ud_from_variances as *const ());
    core::hint::black_box(ud_measure as *const ());
    core::hint::black_box(ud_predict as *const ());
    core::hint::black_box(ud_add_rank_one as *const ());
    core::hint::black_box(cholesky_solve as *const ());
}
