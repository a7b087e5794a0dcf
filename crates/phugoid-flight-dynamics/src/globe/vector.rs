//! Vectors and matrices of three dimensions, and the elementary functions with and without the standard library.

use crate::scalar::Scalar;

/// Three Cartesian components.
pub type Vector = [f64; 3];

/// Three rows of three components. A rotation matrix turns the components of a vector in one set of axes into those in
/// another; the transpose turns them back.
pub type Matrix = [[f64; 3]; 3];

/// Sum of two vectors.
#[inline]
pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Difference `a - b` of two vectors.
#[inline]
pub fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A vector times a number.
#[inline]
pub fn scale(a: Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Scalar product.
#[inline]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product `a x b`.
#[inline]
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length of a vector.
#[inline]
pub fn norm(a: Vector) -> f64 {
    sqrt(dot(a, a))
}

/// Matrix times vector.
#[inline]
pub fn apply(m: &Matrix, a: Vector) -> Vector {
    [dot(m[0], a), dot(m[1], a), dot(m[2], a)]
}

/// Transposed matrix times vector: for a rotation matrix the way back.
#[inline]
pub fn apply_transposed(m: &Matrix, a: Vector) -> Vector {
    core::array::from_fn(|i| m[0][i] * a[0] + m[1][i] * a[1] + m[2][i] * a[2])
}

/// Product of two matrices.
#[inline]
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    core::array::from_fn(|r| core::array::from_fn(|c| (0..3).map(|k| a[r][k] * b[k][c]).sum()))
}

/// Transposed matrix.
#[inline]
pub fn transpose(a: &Matrix) -> Matrix {
    core::array::from_fn(|r| core::array::from_fn(|c| a[c][r]))
}

#[inline]
pub(crate) fn sqrt(x: f64) -> f64 {
    Scalar::sqrt(x)
}

#[inline]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    Scalar::sin_cos(x)
}

#[inline]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    Scalar::atan2(y, x)
}

#[inline]
pub(crate) fn asin(x: f64) -> f64 {
    Scalar::asin(x)
}
