//! Eigenvalues of the small real matrices of flight dynamics, without allocation.
//!
//! The characteristic polynomial comes from the Faddeev-LeVerrier recursion on the matrix in Hessenberg-free form, its roots from
//! the simultaneous iteration of Aberth and Ehrlich. For up to six states with roots between 1e-3 and 1e2 rad/s that is accurate
//! to some 1e-8 of the largest root, which is far better than what any derivative is known to; larger or stiffer matrices need a QR
//! iteration, as `phugoid-flight-dynamics` has it.

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Root {
    /// Real part, 1/s.
    pub real: f64,
    /// Imaginary part, rad/s.
    pub imaginary: f64,
}

impl Root {
    /// Undamped natural frequency, rad/s.
    pub fn frequency(&self) -> f64 {
        libm::hypot(self.real, self.imaginary)
    }

    /// Damping ratio: 1 for a stable real root, negative where the motion grows; zero for a root of zero.
    pub fn damping(&self) -> f64 {
        let frequency = self.frequency();
        if frequency > 0.0 { -self.real / frequency } else { 0.0 }
    }

    fn minus(self, other: Self) -> Self {
        Self { real: self.real - other.real, imaginary: self.imaginary - other.imaginary }
    }

    fn times(self, other: Self) -> Self {
        Self {
            real: self.real * other.real - self.imaginary * other.imaginary,
            imaginary: self.real * other.imaginary + self.imaginary * other.real,
        }
    }

    /// One over this; zero for zero.
    fn inverse(self) -> Self {
        let size = self.real * self.real + self.imaginary * self.imaginary;
        if size > 0.0 { Self { real: self.real / size, imaginary: -self.imaginary / size } } else { Self::default() }
    }
}

/// The eigenvalues of a matrix, in no particular order; a pair is given twice, with either sign. `None` if an entry is not finite
/// or the iteration does not settle.
///
/// ```
/// use phugoid_control::roots::eigenvalues;
/// // A short period of 2 rad/s and a damping ratio of 0.5.
/// let roots = eigenvalues(&[[0.0, 1.0], [-4.0, -2.0]]).ok_or("no roots")?;
/// assert!(roots.iter().all(|root| (root.frequency() - 2.0).abs() < 1e-9 && (root.damping() - 0.5).abs() < 1e-9));
/// # Ok::<(), &str>(())
/// ```
pub fn eigenvalues<const N: usize>(a: &[[f64; N]; N]) -> Option<[Root; N]> {
    if !a.iter().flatten().all(|value| value.is_finite()) {
        return None;
    }
    // Scaled to roots of about one, so that coefficients of all powers are of one size.
    let scale = libm::sqrt(a.iter().flatten().map(|value| value * value).sum::<f64>() / N as f64);
    if scale <= 0.0 {
        return Some([Root::default(); N]);
    }
    let coefficients = characteristic(a, scale);
    let roots = polynomial_roots(&coefficients)?;
    Some(roots.map(|root| Root { real: root.real * scale, imaginary: root.imaginary * scale }))
}

/// Coefficients `c_0 ... c_(N-1)` of `x^N + c_(N-1) x^(N-1) + ... + c_0` of the matrix over `scale`.
fn characteristic<const N: usize>(a: &[[f64; N]; N], scale: f64) -> [f64; N] {
    let mut coefficients = [0.0; N];
    let mut m = [[0.0; N]; N];
    let mut last = 1.0;
    for k in 1..=N {
        // M_k = A M_(k-1) + c I,  c_(N-k) = -trace(A M_k) / k.
        let mut next = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..N {
                next[i][j] = (0..N).map(|l| a[i][l] / scale * m[l][j]).sum::<f64>() + if i == j { last } else { 0.0 };
            }
        }
        m = next;
        let trace: f64 = (0..N).map(|i| (0..N).map(|l| a[i][l] / scale * m[l][i]).sum::<f64>()).sum();
        last = -trace / k as f64;
        coefficients[N - k] = last;
    }
    coefficients
}

/// The roots of a monic polynomial with real coefficients, by the iteration of Aberth and Ehrlich.
fn polynomial_roots<const N: usize>(coefficients: &[f64; N]) -> Option<[Root; N]> {
    // All roots lie within this radius (Cauchy).
    let radius = 1.0 + coefficients.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    if !radius.is_finite() {
        return None;
    }
    let mut roots = [Root::default(); N];
    for (k, root) in roots.iter_mut().enumerate() {
        // On a circle, and not symmetric about the real axis: symmetric starts may stay stuck.
        let angle = core::f64::consts::TAU * (k as f64 + 0.3) / N as f64;
        let size = if radius < 2.0 { radius } else { 2.0 };
        *root = Root { real: size * libm::cos(angle), imaginary: size * libm::sin(angle) };
    }
    for _ in 0..200 {
        let mut largest = 0.0_f64;
        for k in 0..N {
            let x = roots[k];
            // Horner's rule for the polynomial and its derivative.
            let (mut value, mut slope) = (Root { real: 1.0, imaginary: 0.0 }, Root::default());
            for c in coefficients.iter().rev() {
                slope = add(slope.times(x), value);
                value = value.times(x);
                value.real += c;
            }
            let newton = value.times(slope.inverse());
            let mut crowd = Root::default();
            for (j, other) in roots.iter().enumerate() {
                if j != k {
                    crowd = add(crowd, x.minus(*other).inverse());
                }
            }
            let one = Root { real: 1.0, imaginary: 0.0 };
            let step = newton.times(one.minus(newton.times(crowd)).inverse());
            roots[k] = x.minus(step);
            largest = largest.max(step.frequency() / roots[k].frequency().max(1e-3));
        }
        if largest < 1e-12 {
            return Some(roots.map(clean));
        }
        if !largest.is_finite() {
            return None;
        }
    }
    // Multiple roots are approached slowly; what is reached then is good to the square root of the precision.
    roots.iter().all(|root| root.frequency().is_finite()).then(|| roots.map(clean))
}

fn add(a: Root, b: Root) -> Root {
    Root { real: a.real + b.real, imaginary: a.imaginary + b.imaginary }
}

/// A root whose imaginary part is rounding is real.
fn clean(root: Root) -> Root {
    if root.imaginary.abs() < 1e-9 * (1.0 + root.real.abs()) { Root { imaginary: 0.0, ..root } } else { root }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted<const N: usize>(a: &[[f64; N]; N]) -> [Root; N] {
        let mut roots = eigenvalues(a).unwrap();
        roots.sort_by(|a, b| (a.real, a.imaginary).partial_cmp(&(b.real, b.imaginary)).unwrap());
        roots
    }

    #[test]
    fn a_diagonal_matrix_has_its_diagonal() {
        let mut a = [[0.0; 6]; 6];
        for (i, value) in [-0.01, -0.3, -1.0, -2.5, 0.4, -20.0].into_iter().enumerate() {
            a[i][i] = value;
        }
        let found = sorted(&a).map(|root| root.real);
        for (found, expected) in found.into_iter().zip([-20.0, -2.5, -1.0, -0.3, -0.01, 0.4]) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }

    /// The light aircraft of the documentation of `phugoid_flight_dynamics::modes`.
    #[test]
    fn longitudinal_modes_of_a_light_aircraft() {
        let a = [[-0.045, 3.5, -9.81, 0.0], [-0.0069, -2.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.0, -8.8, 0.0, -2.1]];
        let roots = sorted(&a);
        let trace: f64 = (0..4).map(|i| a[i][i]).sum();
        assert!((roots.iter().map(|root| root.real).sum::<f64>() - trace).abs() < 1e-12);
        assert!(roots[0].frequency() > 3.0 && roots[2].frequency() < 0.3);
    }

    #[test]
    fn what_is_not_finite_has_no_roots() {
        assert!(eigenvalues(&[[f64::NAN, 0.0], [0.0, 1.0]]).is_none());
        assert!(eigenvalues(&[[f64::INFINITY, 0.0], [0.0, 1.0]]).is_none());
        assert_eq!(eigenvalues(&[[0.0; 3]; 3]), Some([Root::default(); 3]));
    }

    proptest::proptest! {
        /// Every root makes the matrix less itself singular: the product of all is the determinant, the sum the trace.
        #[test]
        fn sum_and_product_of_the_roots(entries in proptest::array::uniform9(-5.0_f64..5.0)) {
            let a: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| entries[3 * i + j]));
            let roots = eigenvalues(&a).unwrap();
            let product = roots.iter().fold(Root { real: 1.0, imaginary: 0.0 }, |p, root| p.times(*root));
            let determinant = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
                - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
                + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
            let trace = a[0][0] + a[1][1] + a[2][2];
            // Double roots are good to the square root of the precision only.
            proptest::prop_assert!((product.real - determinant).abs() < 1e-5 * (1.0 + determinant.abs()));
            proptest::prop_assert!((roots.iter().map(|r| r.real).sum::<f64>() - trace).abs() < 1e-6 * (1.0 + trace.abs()));
        }
    }
}
