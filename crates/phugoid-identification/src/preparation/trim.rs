//! Level trim of a database: the reference point of increments.

use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use crate::models::longitudinal::Database;

/// Angle of attack, elevator and thrust of steady level flight with the wings level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelTrim {
    /// Angle of attack, rad; also the pitch angle.
    pub alpha: f64,
    /// Elevator deflection, rad, positive trailing edge down.
    pub elevator: f64,
    /// Thrust along the thrust line, N.
    pub thrust: f64,
}

/// The flight condition and the aircraft of a level trim, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimCondition {
    /// True airspeed, m/s.
    pub speed: f64,
    /// Density of the air, kg/m^3.
    pub density: f64,
    /// Mass of the aircraft, kg.
    pub mass: f64,
    /// Acceleration of gravity, m/s^2, positive.
    pub gravity: f64,
    /// Wing reference area, m^2.
    pub wing_area: f64,
    /// Mean aerodynamic chord, m.
    pub mean_chord: f64,
    /// Angle of the thrust line above body x, rad.
    pub thrust_inclination: f64,
    /// Pitching moment about the centre of gravity per newton of thrust, m, positive nose up.
    pub thrust_arm: f64,
}

/// Finds alpha, elevator and thrust at which neither speed nor path nor pitch rate change, by Newton's method with
/// exact derivatives and halved steps. Thrust and deflections are not limited: compare them with what the aircraft has.
///
/// ```
/// use phugoid_flight_dynamics::atmosphere::Atmosphere;
/// use phugoid_identification::model_file::ModelFile;
/// use phugoid_identification::prepare::database;
/// use phugoid_identification::trim::{TrimCondition, level_trim};
/// let f16 = database(&ModelFile::named("f16")?)?;
/// let mut condition = TrimCondition {
///     speed: 205.74,
///     density: Atmosphere::Book.at(6096.0).density,
///     mass: 9299.8,
///     gravity: 9.8054,
///     wing_area: 27.87,
///     mean_chord: 3.45,
///     thrust_inclination: 0.0,
///     thrust_arm: 0.0,
/// };
/// assert!((level_trim(&f16, &condition)?.alpha.to_degrees() - 2.39).abs() < 0.01);
/// condition.density = 0.0; // no air, no lift
/// assert!(level_trim(&f16, &condition).unwrap_err().contains("no level trim at 205.74 m/s"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A sentence with the remaining imbalance if no level flight was found at this condition, which includes every NaN
/// argument.
pub fn level_trim(database: &Database, c: &TrimCondition) -> Result<LevelTrim, String> {
    let qbar_s = 0.5 * c.density * c.speed * c.speed * c.wing_area;
    let weight = c.mass * c.gravity;
    // Balance of drag, lift and pitching moment in units of the weight (moment over the mean chord).
    let balance = |z: [f64; 3]| -> [Dual<3>; 3] {
        let [alpha, elevator, thrust] = std::array::from_fn(|i| Dual::variable(z[i], i));
        let [cl, cd, cm] = database.coefficients(Dual::from(c.speed), c.density, alpha, Dual::from(0.0), elevator);
        let (sin, cos) = (alpha + c.thrust_inclination).sin_cos();
        let thrust = thrust * weight;
        [
            (thrust * cos - cd * qbar_s) / weight,
            (thrust * sin + cl * qbar_s) / weight - 1.0,
            (cm * qbar_s * c.mean_chord + thrust * c.thrust_arm) / (weight * c.mean_chord),
        ]
    };
    let size = |r: &[Dual<3>; 3]| r.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
    let mut z = [0.05, 0.0, 0.1];
    let mut residual = balance(z);
    for _ in 0..100 {
        if size(&residual) < 1e-14 {
            break;
        }
        let Some(step) = solve(&residual) else { break };
        let mut factor = 1.0;
        let better = loop {
            let trial: [f64; 3] = std::array::from_fn(|i| z[i] - factor * step[i].clamp(-0.5, 0.5));
            let next = balance(trial);
            if size(&next) < size(&residual) {
                break Some((trial, next));
            }
            factor *= 0.5;
            if factor < 1e-6 {
                break None;
            }
        };
        let Some((trial, next)) = better else { break };
        (z, residual) = (trial, next);
    }
    // Steps stop at rounding; 1e-9 g is far below what any sensor shows.
    if size(&residual) < 1e-9 {
        Ok(LevelTrim { alpha: z[0], elevator: z[1], thrust: z[2] * weight })
    } else {
        Err(format!(
            "no level trim at {:.2} m/s and {:.4} kg/m^3: drag, lift and moment remain unbalanced by {:.2e}, {:.2e}, \
             {:.2e} of the weight. Check reference_speed, altitude and mass",
            c.speed, c.density, residual[0].value, residual[1].value, residual[2].value
        ))
    }
}

/// `J^-1 r` by Cramer's rule; nothing if the Jacobian is singular.
fn solve(r: &[Dual<3>; 3]) -> Option<[f64; 3]> {
    let j = r.map(|row| row.derivatives);
    let det = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = det(&j);
    if whole.abs() < 1e-14 || !whole.is_finite() {
        return None;
    }
    Some(std::array::from_fn(|column| {
        let mut replaced = j;
        for (row, value) in replaced.iter_mut().zip(r) {
            row[column] = value.value;
        }
        det(&replaced) / whole
    }))
}
