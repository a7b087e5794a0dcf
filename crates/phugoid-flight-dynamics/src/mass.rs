//! Mass, rotational inertia and the momentum of spinning rotors.

use crate::scalar::Scalar;

/// Mass and everything that turns a moment into an angular acceleration.
///
/// The moment equation `J w' + w x (J w + h) = M` (Stevens & Lewis 1.7-5; thesis 2.15) solved for `w'` is linear in the
/// six products of the body rates and in the moment:
///
/// ```text
/// [p', q', r'] = G [pp, qq, rr, pq, pr, qr] + J^-1 (M - w x h),     h = [hx, 0, 0]
/// ```
///
/// `G` and `J^-1` are kept as data. That serves a full inertia tensor with all products of inertia and the rounded
/// constants `c1..c9` printed by Stevens & Lewis alike, and costs no more than either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    mass: f64,
    inverse_mass: f64,
    /// Rows p', q', r'; columns pp, qq, rr, pq, pr, qr; dimensionless.
    gyroscopic: [[f64; 6]; 3],
    /// Inverse of the inertia tensor, 1/(kg m^2).
    inverse_inertia: [[f64; 3]; 3],
    /// Angular momentum of spinning rotors along body x, kg m^2/s, positive clockwise seen from behind.
    rotor_momentum: f64,
}

impl MassProperties {
    /// From the mass (kg), the inertia tensor about the centre of gravity in body axes (kg m^2) and the rotor's angular
    /// momentum along body x (kg m^2/s).
    ///
    /// `inertia` is the tensor itself, symmetric: its off-diagonal elements are the negative products of inertia,
    /// `[[Jxx, -Jxy, -Jxz], [-Jxy, Jyy, -Jyz], [-Jxz, -Jyz, Jzz]]`. A mass or tensor that is not positive definite
    /// gives `None`.
    pub fn from_tensor(mass: f64, inertia: [[f64; 3]; 3], rotor_momentum: f64) -> Option<Self> {
        let j = inertia;
        let cofactor = |r: usize, c: usize| {
            let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            j[r1][c1] * j[r2][c2] - j[r1][c2] * j[r2][c1]
        };
        let determinant = j[0][0] * cofactor(0, 0) + j[0][1] * cofactor(0, 1) + j[0][2] * cofactor(0, 2);
        let scale = j[0][0].abs().max(j[1][1].abs()).max(j[2][2].abs());
        let symmetric =
            (0..3).all(|r| (0..r).all(|c| (j[r][c] - j[c][r]).abs() <= 1e-12 * scale && j[r][c].is_finite()));
        // Sylvester's criterion on the leading minors.
        let positive = j[0][0] > 0.0 && cofactor(2, 2) > 0.0 && determinant > 0.0 && determinant.is_finite();
        if !(symmetric && positive && mass > 0.0 && mass.is_finite() && rotor_momentum.is_finite()) {
            return None;
        }
        let inverse_inertia: [[f64; 3]; 3] =
            core::array::from_fn(|r| core::array::from_fn(|c| cofactor(c, r) / determinant));
        // -w x (J w) as a quadratic form in [pp, qq, rr, pq, pr, qr].
        let quadratic = [
            [0.0, -j[1][2], j[1][2], -j[0][2], j[0][1], j[1][1] - j[2][2]],
            [j[0][2], 0.0, -j[0][2], j[1][2], j[2][2] - j[0][0], -j[0][1]],
            [-j[0][1], j[0][1], 0.0, j[0][0] - j[1][1], -j[1][2], j[0][2]],
        ];
        let gyroscopic = core::array::from_fn(|r| {
            core::array::from_fn(|k| (0..3).map(|i| inverse_inertia[r][i] * quadratic[i][k]).sum())
        });
        Some(Self { mass, inverse_mass: 1.0 / mass, gyroscopic, inverse_inertia, rotor_momentum })
    }

    /// The aircraft with `mass` times its mass and `inertia` times its moments of inertia about body x, y and z; the product of
    /// inertia changes by the geometric mean of its two axes, so that the ellipsoid keeps its tilt. The rotor stays. Factors
    /// that are not positive and finite give `None`.
    pub fn changed(&self, mass: f64, inertia: [f64; 3]) -> Option<Self> {
        if !inertia.iter().all(|factor| *factor > 0.0 && factor.is_finite()) {
            return None;
        }
        let whole = self.inertia_tensor();
        let tensor =
            core::array::from_fn(|r| core::array::from_fn(|c| whole[r][c] * libm::sqrt(inertia[r] * inertia[c])));
        Self::from_tensor(self.mass * mass, tensor, self.rotor_momentum)
    }

    /// The inertia tensor about the centre of gravity in body axes, kg m^2, as [`from_tensor`](Self::from_tensor) takes it: the
    /// inverse of the kept inverse, so that the last digits differ from those it was made of.
    pub fn inertia_tensor(&self) -> [[f64; 3]; 3] {
        let inverse = &self.inverse_inertia;
        let cofactor = |r: usize, c: usize| {
            let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            inverse[r1][c1] * inverse[r2][c2] - inverse[r1][c2] * inverse[r2][c1]
        };
        let determinant = (0..3).map(|c| inverse[0][c] * cofactor(0, c)).sum::<f64>();
        // Rounding must not make a symmetric tensor unsymmetric.
        let element = |r: usize, c: usize| 0.5 * (cofactor(c, r) + cofactor(r, c)) / determinant;
        core::array::from_fn(|r| core::array::from_fn(|c| element(r, c)))
    }

    /// From the mass (kg), the constants `c1..c9` of Stevens & Lewis (1.7-6) for an aircraft with the x-z plane as plane
    /// of symmetry, and the rotor's angular momentum along body x (kg m^2/s).
    ///
    /// `c3`, `c4`, `c7` and `c9` in 1/(kg m^2), the others dimensionless:
    ///
    /// ```text
    /// p' = (c1 r + c2 p) q + c3 L + c4 (N + q hx)
    /// q' = c5 p r - c6 (p^2 - r^2) + c7 (M - r hx)
    /// r' = (c8 p - c2 r) q + c4 L + c9 (N + q hx)
    /// ```
    ///
    /// Their nine printed values need not belong to one tensor: that is why this constructor exists.
    pub fn from_stevens_lewis_constants(mass: f64, c: [f64; 9], rotor_momentum: f64) -> Option<Self> {
        let [c1, c2, c3, c4, c5, c6, c7, c8, c9] = c;
        let positive = c3 > 0.0 && c7 > 0.0 && c9 > 0.0 && c3 * c9 > c4 * c4;
        if !(positive && mass > 0.0 && mass.is_finite() && c.iter().all(|x| x.is_finite())) {
            return None;
        }
        Some(Self {
            mass,
            inverse_mass: 1.0 / mass,
            gyroscopic: [[0.0, 0.0, 0.0, c2, 0.0, c1], [-c6, 0.0, c6, 0.0, c5, 0.0], [0.0, 0.0, 0.0, c8, 0.0, -c2]],
            inverse_inertia: [[c3, 0.0, c4], [0.0, c7, 0.0], [c4, 0.0, c9]],
            rotor_momentum,
        })
    }

    /// The mass of the aircraft, kg.
    #[inline]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Reciprocal of the mass, 1/kg.
    #[inline]
    pub fn inverse_mass(&self) -> f64 {
        self.inverse_mass
    }

    /// Inverse of the inertia tensor in body axes, 1/(kg m^2).
    #[inline]
    pub fn inverse_inertia(&self) -> &[[f64; 3]; 3] {
        &self.inverse_inertia
    }

    /// Pitching moment of inertia that the plane of symmetry sees, kg m^2: the reciprocal of the middle element of the
    /// inverse tensor (`1/c7`); equal to `Jyy` for a symmetric aircraft.
    #[inline]
    pub fn pitch_inertia(&self) -> f64 {
        1.0 / self.inverse_inertia[1][1]
    }

    /// Angular momentum of spinning rotors along body x, kg m^2/s.
    #[inline]
    pub fn rotor_momentum(&self) -> f64 {
        self.rotor_momentum
    }

    /// Angular acceleration `[p', q', r']`, rad/s^2, from the body rates `[p, q, r]` (rad/s) and the moment about the
    /// centre of gravity in body axes (N m).
    #[inline]
    pub fn angular_acceleration<T: Scalar>(&self, rates: [T; 3], moment: [T; 3]) -> [T; 3] {
        let [p, q, r] = rates;
        // M - w x h with h along x.
        let [l, m, n] = [moment[0], moment[1] - r * self.rotor_momentum, moment[2] + q * self.rotor_momentum];
        let products = [p * p, q * q, r * r, p * q, p * r, q * r];
        core::array::from_fn(|i| {
            let g = &self.gyroscopic[i];
            let j = &self.inverse_inertia[i];
            let quadratic = products[0] * g[0]
                + products[1] * g[1]
                + products[2] * g[2]
                + products[3] * g[3]
                + products[4] * g[4]
                + products[5] * g[5];
            quadratic + l * j[0] + m * j[1] + n * j[2]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tensor with products of inertia, changed by factors, against the tensor of the changed numbers.
    #[test]
    fn a_changed_tensor_is_that_of_the_changed_numbers() {
        let tensor = [[9496.0, 0.0, -982.0], [0.0, 55814.0, 0.0], [-982.0, 0.0, 63100.0]];
        let whole = MassProperties::from_tensor(637.0, tensor, 160.0).unwrap();
        let (a, b, c) = (0.8_f64, 1.1_f64, 0.9_f64);
        let product = -982.0 * (a * c).sqrt();
        let expected = [[9496.0 * a, 0.0, product], [0.0, 55814.0 * b, 0.0], [product, 0.0, 63100.0 * c]];
        let expected = MassProperties::from_tensor(637.0 * 0.9, expected, 160.0).unwrap();
        let changed = whole.changed(0.9, [a, b, c]).unwrap();
        let (rates, moment) = ([0.3, -0.2, 0.1], [1000.0, -2000.0, 500.0]);
        let (found, expected) =
            (changed.angular_acceleration(rates, moment), expected.angular_acceleration(rates, moment));
        assert!(found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-12), "{found:?} {expected:?}");
        assert!((changed.mass() - 637.0 * 0.9).abs() < 1e-10);
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(whole.changed(1.0, [1.0, factor, 1.0]).is_none() && whole.changed(factor, [1.0; 3]).is_none());
        }
    }

    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    #[test]
    fn solves_the_moment_equation_with_all_products_of_inertia() {
        let j = [[9.0, -0.7, -1.3], [-0.7, 50.0, 0.4], [-1.3, 0.4, 60.0]];
        let h = 160.0;
        let properties = MassProperties::from_tensor(1.0, j, h).unwrap();
        let (w, m) = ([0.7, -0.8, 0.9], [3.0, -20.0, 11.0]);
        let dw = properties.angular_acceleration(w, m);
        let apply = |x: [f64; 3]| -> [f64; 3] { core::array::from_fn(|r| (0..3).map(|c| j[r][c] * x[c]).sum()) };
        let mut momentum = apply(w);
        momentum[0] += h;
        let (left, gyro) = (apply(dw), cross(w, momentum));
        for i in 0..3 {
            assert!((left[i] + gyro[i] - m[i]).abs() < 1e-12 * 200.0, "axis {i}");
        }
    }

    #[test]
    fn a_free_rigid_body_keeps_its_energy_and_angular_momentum() {
        let j = [[9.0, -0.7, -1.3], [-0.7, 50.0, 0.4], [-1.3, 0.4, 60.0]];
        let properties = MassProperties::from_tensor(1.0, j, 0.0).unwrap();
        let w = [0.3, 1.1, -0.4];
        let dw = properties.angular_acceleration(w, [0.0; 3]);
        let momentum: [f64; 3] = core::array::from_fn(|r| (0..3).map(|c| j[r][c] * w[c]).sum());
        // d/dt (w J w / 2) = w' . J w = 0, and d/dt |J w|^2 / 2 = (J w') . J w = 0.
        let power: f64 = (0..3).map(|i| dw[i] * momentum[i]).sum();
        let rate: f64 = (0..3).map(|r| (0..3).map(|c| j[r][c] * dw[c]).sum::<f64>() * momentum[r]).sum();
        assert!(power.abs() < 1e-12 * 60.0 && rate.abs() < 1e-12 * 60.0 * 60.0, "{power} {rate}");
    }

    #[test]
    fn the_constants_of_an_exact_tensor_give_the_same_motion() {
        let (jx, jy, jz, jxz) = (9496.0, 55814.0, 63100.0, 982.0);
        let gamma = jx * jz - jxz * jxz;
        let c = [
            ((jy - jz) * jz - jxz * jxz) / gamma,
            (jx - jy + jz) * jxz / gamma,
            jz / gamma,
            jxz / gamma,
            (jz - jx) / jy,
            jxz / jy,
            1.0 / jy,
            (jx * (jx - jy) + jxz * jxz) / gamma,
            jx / gamma,
        ];
        let a = MassProperties::from_stevens_lewis_constants(637.0, c, 160.0).unwrap();
        let tensor = [[jx, 0.0, -jxz], [0.0, jy, 0.0], [-jxz, 0.0, jz]];
        let b = MassProperties::from_tensor(637.0, tensor, 160.0).unwrap();
        let (w, m) = ([0.7, -0.8, 0.9], [3e4, -2e5, 1e4]);
        let (da, db) = (a.angular_acceleration(w, m), b.angular_acceleration(w, m));
        for i in 0..3 {
            assert!((da[i] - db[i]).abs() < 1e-13 * (1.0 + da[i].abs()), "axis {i}: {} {}", da[i], db[i]);
        }
        assert!((b.pitch_inertia() - jy).abs() < 1e-9);
    }

    #[test]
    fn impossible_inertia_is_refused() {
        let good = [[9.0, 0.0, 0.0], [0.0, 50.0, 0.0], [0.0, 0.0, 60.0]];
        assert!(MassProperties::from_tensor(1.0, good, 0.0).is_some());
        assert!(MassProperties::from_tensor(0.0, good, 0.0).is_none());
        let mut lopsided = good;
        lopsided[0][1] = 1.0;
        assert!(MassProperties::from_tensor(1.0, lopsided, 0.0).is_none());
        let indefinite = [[9.0, 0.0, 40.0], [0.0, 50.0, 0.0], [40.0, 0.0, 60.0]];
        assert!(MassProperties::from_tensor(1.0, indefinite, 0.0).is_none());
    }
}
