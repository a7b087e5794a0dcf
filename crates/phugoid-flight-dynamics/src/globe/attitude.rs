//! Attitude of a body: unit quaternions and Euler angles.

use super::vector::{Matrix, Vector, asin, atan2, sin_cos, sqrt};

/// Yaw, pitch and roll angle: the body is turned from the reference axes first about z by yaw, then about the new y by
/// pitch, then about the new x by roll.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EulerAngles {
    /// Yaw angle, rad, positive clockwise seen from above; against north it is the heading.
    pub yaw: f64,
    /// Pitch angle, rad, positive nose up, -pi/2 to pi/2.
    pub pitch: f64,
    /// Roll angle, rad, positive right wing down.
    pub roll: f64,
}

impl EulerAngles {
    /// Matrix that turns components along the reference axes into body components (Stevens, Lewis and Johnson 1.3-20).
    pub fn matrix(&self) -> Matrix {
        let (sy, cy) = sin_cos(self.yaw);
        let (sp, cp) = sin_cos(self.pitch);
        let (sr, cr) = sin_cos(self.roll);
        [
            [cp * cy, cp * sy, -sp],
            [sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp],
            [cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp],
        ]
    }

    /// The angles of a rotation matrix from reference to body components. Yaw and roll lie in -pi to pi; at exactly 90
    /// degrees of pitch, where only their difference or sum has a meaning, all of it is given to the yaw.
    pub fn of_matrix(m: &Matrix) -> Self {
        let pitch = asin((-m[0][2]).clamp(-1.0, 1.0));
        if m[0][0] == 0.0 && m[0][1] == 0.0 {
            return Self { yaw: atan2(-m[1][0], m[1][1]), pitch, roll: 0.0 };
        }
        // Near 90 degrees the arc sine loses half its digits; the arc tangent does not.
        let pitch =
            if pitch.abs() < 1.0 { pitch } else { atan2(-m[0][2], sqrt(m[0][0] * m[0][0] + m[0][1] * m[0][1])) };
        Self { yaw: atan2(m[0][1], m[0][0]), pitch, roll: atan2(m[1][2], m[2][2]) }
    }
}

/// A unit quaternion `w + x i + y j + z k` that turns reference components into body components: half the angle's cosine,
/// and half the angle's sine times the axis about which the body is turned from the reference axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion {
    /// Scalar part and the three components of the vector part, dimensionless.
    pub parts: [f64; 4],
}

impl Default for Quaternion {
    /// No rotation.
    fn default() -> Self {
        Self { parts: [1.0, 0.0, 0.0, 0.0] }
    }
}

impl Quaternion {
    /// Matrix that turns reference components into body components; a rotation if the quaternion has length one.
    #[inline]
    pub fn matrix(&self) -> Matrix {
        let [w, x, y, z] = self.parts;
        [
            [w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
            [2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x)],
            [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z],
        ]
    }

    /// The quaternion of a rotation matrix, with the largest part positive (S. W. Shepperd, J. Guidance 1 (1978) 223).
    pub fn of_matrix(m: &Matrix) -> Self {
        let trace = m[0][0] + m[1][1] + m[2][2];
        let squares = [trace, m[0][0], m[1][1], m[2][2]];
        let mut largest = 0;
        for i in 1..4 {
            if squares[i] > squares[largest] {
                largest = i;
            }
        }
        let (a, b, c) = (m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
        let (d, e, f) = (m[0][1] + m[1][0], m[0][2] + m[2][0], m[1][2] + m[2][1]);
        let double = sqrt((1.0 + 2.0 * squares[largest] - trace).max(0.0));
        let parts = match largest {
            0 => {
                let double = sqrt((1.0 + trace).max(0.0));
                return Self { parts: [0.5 * double, 0.5 * a / double, 0.5 * b / double, 0.5 * c / double] };
            }
            1 => [0.5 * a / double, 0.5 * double, 0.5 * d / double, 0.5 * e / double],
            2 => [0.5 * b / double, 0.5 * d / double, 0.5 * double, 0.5 * f / double],
            _ => [0.5 * c / double, 0.5 * e / double, 0.5 * f / double, 0.5 * double],
        };
        Self { parts }
    }

    /// Rate of change, 1/s, of a body that turns with these rates (rad/s, body axes) relative to the reference axes
    /// (Stevens, Lewis and Johnson 1.8-15).
    #[inline]
    pub fn rate(&self, [p, q, r]: Vector) -> [f64; 4] {
        let [w, x, y, z] = self.parts;
        [
            -0.5 * (x * p + y * q + z * r),
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
        ]
    }

    /// The same rotation with length one. A quaternion of length zero gives NaN.
    #[inline]
    pub fn normalised(&self) -> Self {
        let [w, x, y, z] = self.parts;
        let inverse = 1.0 / sqrt(w * w + x * x + y * y + z * z);
        Self { parts: [w * inverse, x * inverse, y * inverse, z * inverse] }
    }
}
