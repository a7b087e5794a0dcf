//! Aerodynamic tables and the build-up of the coefficients (appendix A.3 and A.4 of the book).

use crate::aircraft::Controls;
use crate::scalar::Scalar;
use crate::table::{Place, UniformAxis, interpolate, interpolate_2d};

/// Points of the angle-of-attack axis: -10 to 45 deg in steps of 5.
pub const ALPHA_POINTS: usize = 12;
/// Points of the elevator axis: -24 to 24 deg in steps of 12.
const ELEVATOR_POINTS: usize = 5;
/// Points of both sideslip axes: 0 to 30 deg in steps of 5, and -30 to 30 deg in steps of 10.
const SIDESLIP_POINTS: usize = 7;

/// Axis of the angle of attack, rad.
pub type AlphaAxis = UniformAxis<ALPHA_POINTS>;
/// Axis of the sideslip angle or its magnitude, rad.
pub type SideslipAxis = UniformAxis<SIDESLIP_POINTS>;

const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// Deflections that the book divides aileron and rudder by (20 although the aileron's limit is 21.5), rad.
const AILERON_UNIT: f64 = 20.0 * DEGREE;
const RUDDER_UNIT: f64 = 30.0 * DEGREE;

/// The tables, grouped by the axes that they share so that one look-up serves all of a group. Angles in radians,
/// coefficients as published.
#[derive(Clone, Debug, PartialEq)]
pub struct AerodynamicTables {
    /// Angle of attack, the axis of every table.
    pub alpha: AlphaAxis,
    /// Elevator deflections of the table points.
    pub elevator: UniformAxis<ELEVATOR_POINTS>,
    /// Magnitude of the sideslip angle.
    pub sideslip_magnitude: SideslipAxis,
    /// Sideslip angles of the table points.
    pub sideslip: SideslipAxis,
    /// `[CX, Cm]` by elevator and angle of attack.
    pub elevator_group: [[[f64; 2]; ALPHA_POINTS]; ELEVATOR_POINTS],
    /// `[CZ, CXq, CZq, Cmq]` by angle of attack.
    pub pitch_group: [[f64; 4]; ALPHA_POINTS],
    /// `[CYr, CYp, Clr, Clp, Cnr, Cnp]` by angle of attack.
    pub lateral_group: [[f64; 6]; ALPHA_POINTS],
    /// `[Cl, Cn]` by magnitude of sideslip and angle of attack.
    pub sideslip_group: [[[f64; 2]; ALPHA_POINTS]; SIDESLIP_POINTS],
    /// `[Cl per aileron, Cl per rudder, Cn per aileron, Cn per rudder]`, per 20 deg of aileron and 30 deg of rudder, by
    /// sideslip and angle of attack.
    pub control_group: [[[f64; 4]; ALPHA_POINTS]; SIDESLIP_POINTS],
}

/// Coefficients of the plane of symmetry, body axes, moment about the reference point of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Longitudinal<T> {
    /// Axial force coefficient, body x, positive forward.
    pub cx: T,
    /// Normal force coefficient, body z, positive down.
    pub cz: T,
    /// Pitching moment coefficient, positive nose up.
    pub cm: T,
}

/// Coefficients out of the plane of symmetry, body axes, moments about the reference point of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lateral<T> {
    /// Side force coefficient, body y, positive to the right.
    pub cy: T,
    /// Rolling moment coefficient, positive right wing down.
    pub cl: T,
    /// Yawing moment coefficient, positive nose right.
    pub cn: T,
}

impl AerodynamicTables {
    /// Longitudinal coefficients without sideslip from angle of attack (rad), `q cbar / 2V` and elevator (rad).
    #[inline]
    pub fn longitudinal<T: Scalar>(&self, alpha: T, q_hat: T, elevator: T) -> Longitudinal<T> {
        self.longitudinal_at(self.alpha.place(alpha), None, q_hat, elevator)
    }

    #[inline(always)]
    fn longitudinal_at<T: Scalar>(
        &self,
        alpha: Place<T>,
        sideslip: Option<T>,
        q_hat: T,
        elevator: T,
    ) -> Longitudinal<T> {
        let [cx, cm] = interpolate_2d(&self.elevator_group, self.elevator.place(elevator), alpha);
        let [cz, cx_q, cz_q, cm_q] = interpolate(&self.pitch_group, alpha);
        // CZ = CZ0 (1 - (beta/57.3)^2) - 0.19 el/25 + q^ CZq, with 57.3 as the book has it.
        const PER_BOOK_RADIAN: f64 = 1.0 / (57.3 * DEGREE);
        let cz = match sideslip {
            Some(beta) => {
                let beta = beta * PER_BOOK_RADIAN;
                cz - cz * beta * beta
            }
            None => cz,
        };
        Longitudinal {
            cx: cx + q_hat * cx_q,
            cz: cz - elevator * (0.19 / (25.0 * DEGREE)) + q_hat * cz_q,
            cm: cm + q_hat * cm_q,
        }
    }

    /// All coefficients from angle of attack and sideslip (rad), the dimensionless rates `[p b/2V, q cbar/2V, r b/2V]`
    /// and the surface positions.
    #[inline]
    pub fn all<T: Scalar>(
        &self,
        alpha: T,
        beta: T,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> (Longitudinal<T>, Lateral<T>) {
        let [p_hat, q_hat, r_hat] = rates;
        let place = self.alpha.place(alpha);
        let longitudinal = self.longitudinal_at(place, Some(beta), q_hat, controls.elevator);

        let aileron = controls.aileron / AILERON_UNIT;
        let rudder = controls.rudder / RUDDER_UNIT;
        let negative = beta.real() < 0.0;
        let magnitude = if negative { -beta } else { beta };
        let [cl, cn] = interpolate_2d(&self.sideslip_group, self.sideslip_magnitude.place(magnitude), place);
        let (cl, cn) = if negative { (-cl, -cn) } else { (cl, cn) };
        let [cl_aileron, cl_rudder, cn_aileron, cn_rudder] =
            interpolate_2d(&self.control_group, self.sideslip.place(beta), place);
        let [cy_r, cy_p, cl_r, cl_p, cn_r, cn_p] = interpolate(&self.lateral_group, place);
        let lateral = Lateral {
            // CY = -0.02 beta_deg + 0.021 ail/20 + 0.086 rdr/30 + r^ CYr + p^ CYp
            cy: beta * (-0.02 / DEGREE) + aileron * 0.021 + rudder * 0.086 + r_hat * cy_r + p_hat * cy_p,
            cl: cl + cl_aileron * aileron + cl_rudder * rudder + r_hat * cl_r + p_hat * cl_p,
            cn: cn + cn_aileron * aileron + cn_rudder * rudder + r_hat * cn_r + p_hat * cn_p,
        };
        (longitudinal, lateral)
    }
}
