//! The tables of NASA TP-1538 and the coefficients that they make.

use std::path::PathBuf;

use phugoid_flight_dynamics::scalar::Scalar;

use crate::transport::TransportError;
use crate::transport::axis::{Axis, Place, blend_1, blend_2, blend_3};
use crate::transport::read::{Document, Node};

/// What the coefficients are asked at; angles in deg.
pub(super) struct Flow<T> {
    pub(super) alpha: T,
    pub(super) beta: T,
    pub(super) elevator: T,
    /// Share by which the leading-edge flap is up: 0 at 25 deg, 1 at 0.
    pub(super) flap: T,
    /// Deflections over those of the tables.
    pub(super) aileron: T,
    pub(super) rudder: T,
    /// `p b/2V`, `q cbar/2V`, `r b/2V`.
    pub(super) rates: [T; 3],
}

/// The tables, per deg and rad as published. Increments for the flap and the surfaces are made when they are read.
#[derive(Debug)]
pub(super) struct Tables {
    /// Angle of attack of the basic tables, and of those with the flap up.
    alpha: Axis,
    alpha_short: Axis,
    beta: Axis,
    elevator: Axis,
    elevator_short: Axis,
    /// (alpha, beta, elevator) CX, CZ, Cm with the flap at 25 deg.
    longitudinal: Vec<[f64; 3]>,
    /// (alpha, beta, elevator of three points) Cn, Cl with the flap at 25 deg.
    lateral: Vec<[f64; 2]>,
    /// (alpha, beta) CY with the flap at 25 deg, and the change of CY, Cn, Cl by 30 deg of rudder.
    side: Vec<[f64; 4]>,
    /// (short alpha, beta) change by the flap from 25 deg to 0: CX, CZ, Cm, CY, Cn, Cl.
    flap: Vec<[f64; 6]>,
    /// (short alpha, beta) change of CY, Cn, Cl by 20 deg of aileron, and of that change by the flap.
    aileron: Vec<[f64; 6]>,
    /// (alpha) CXq, CZq, Cmq, CYp, CYr, Cnr, Cnp, Clp, Clr, then dCm, dCn_beta, dCl_beta.
    damping: Vec<[f64; 12]>,
    /// (short alpha) the change of the first nine by the flap.
    damping_flap: Vec<[f64; 9]>,
    /// (elevator) factor of its pitching moment.
    effectiveness: Vec<[f64; 1]>,
}

const DAMPING: [&str; 12] =
    ["CXq", "CZq", "CMq", "CYp", "CYr", "CNr", "CNp", "CLp", "CLr", "delta_Cm", "delta_CNbeta", "delta_CLbeta"];

impl Tables {
    pub(super) fn read(file: PathBuf) -> Result<Self, TransportError> {
        let document = Document::open(file)?;
        let root = document.root();
        let (axes, tables) = (root.get("axes")?, root.get("tables")?);
        let axis = |name: &str| -> Result<Axis, TransportError> {
            let node = axes.get(name)?;
            Axis::new(node.numbers()?).ok_or_else(|| node.error("is no list of at least two numbers that rise"))
        };
        let (alpha, alpha_short, beta) = (axis("ALPHA1")?, axis("ALPHA2")?, axis("BETA1")?);
        let (elevator, elevator_short) = (axis("DH1")?, axis("DH2")?);
        let (long, short, sides) = (alpha.len(), alpha_short.len(), beta.len());
        let starts_alike = short <= long && (0..short).all(|i| alpha.point(i) == alpha_short.point(i));
        if !starts_alike {
            return Err(axes.get("ALPHA2")?.error("is not the beginning of ALPHA1"));
        }
        let zero = |axis: &Axis, name: &str| {
            let found = (0..axis.len()).find(|&k| axis.point(k) == 0.0);
            found.map_or_else(|| Err(axes.get(name)?.error("has no point at 0")), Ok)
        };
        let (level, level_short) = (zero(&elevator, "DH1")?, zero(&elevator_short, "DH2")?);
        let read = |name: &str, shape: &[usize]| -> Result<Vec<f64>, TransportError> {
            let node = tables.get(name)?.get("values")?;
            let mut values = Vec::new();
            flatten(&node, shape, &mut values)?;
            Ok(values)
        };
        let cube = |name: &str, points: &Axis| read(name, &[long, sides, points.len()]);
        let square = |name: &str, rows: usize| read(name, &[rows, sides]);

        let [x, z, m] = [cube("Cx", &elevator)?, cube("Cz", &elevator)?, cube("Cm", &elevator)?];
        let [n, l] = [cube("Cn", &elevator_short)?, cube("Cl", &elevator_short)?];
        let y = square("Cy", long)?;
        // With the elevator at zero.
        let at_zero = |cube: &[f64], points: &Axis, zero: usize| -> Vec<f64> {
            cube.chunks(points.len()).map(|row| row[zero]).collect()
        };
        let [x0, z0, m0] = [&x, &z, &m].map(|table| at_zero(table, &elevator, level));
        let [n0, l0] = [&n, &l].map(|table| at_zero(table, &elevator_short, level_short));
        let less = |name: &str, rows: usize, base: &[f64]| -> Result<Vec<f64>, TransportError> {
            Ok(square(name, rows)?.iter().zip(base).map(|(value, base)| value - base).collect())
        };
        let rudder = [less("Cy_r30", long, &y)?, less("Cn_r30", long, &n0)?, less("Cl_r30", long, &l0)?];
        let flap = [
            less("Cx_lef", short, &x0)?,
            less("Cz_lef", short, &z0)?,
            less("Cm_lef", short, &m0)?,
            less("Cy_lef", short, &y)?,
            less("Cn_lef", short, &n0)?,
            less("Cl_lef", short, &l0)?,
        ];
        let down = [less("Cy_a20", long, &y)?, less("Cn_a20", long, &n0)?, less("Cl_a20", long, &l0)?];
        let up = [
            less("Cy_a20_lef", short, &square("Cy_lef", short)?)?,
            less("Cn_a20_lef", short, &square("Cn_lef", short)?)?,
            less("Cl_a20_lef", short, &square("Cl_lef", short)?)?,
        ];
        let mut damping = Vec::new();
        for name in DAMPING {
            damping.push(read(name, &[long])?);
        }
        let mut damping_flap = Vec::new();
        for name in &DAMPING[..9] {
            damping_flap.push(read(&format!("delta_{name}_lef"), &[short])?);
        }
        let effectiveness = read("eta_el", &[elevator.len()])?;
        Ok(Self {
            longitudinal: (0..x.len()).map(|k| [x[k], z[k], m[k]]).collect(),
            lateral: (0..n.len()).map(|k| [n[k], l[k]]).collect(),
            side: (0..y.len()).map(|k| [y[k], rudder[0][k], rudder[1][k], rudder[2][k]]).collect(),
            flap: (0..short * sides).map(|k| std::array::from_fn(|i| flap[i][k])).collect(),
            aileron: (0..short * sides)
                .map(|k| std::array::from_fn(|i| if i < 3 { down[i][k] } else { up[i - 3][k] - down[i - 3][k] }))
                .collect(),
            damping: (0..long).map(|k| std::array::from_fn(|i| damping[i][k])).collect(),
            damping_flap: (0..short).map(|k| std::array::from_fn(|i| damping_flap[i][k])).collect(),
            effectiveness: effectiveness.into_iter().map(|value| [value]).collect(),
            alpha,
            alpha_short,
            beta,
            elevator,
            elevator_short,
        })
    }

    /// Lowest and highest angle of attack at which there is every table, sideslip and elevator, deg.
    pub(super) fn range(&self) -> [[f64; 2]; 3] {
        [self.alpha_short.ends(), self.beta.ends(), self.elevator.ends()]
    }

    /// CX, CY, CZ, Cl, Cm, Cn about the reference point of the data.
    pub(super) fn coefficients<T: Scalar>(&self, flow: &Flow<T>) -> [T; 6] {
        let a = self.alpha.place_within(flow.alpha);
        let a_short = self.alpha_short.place_within(flow.alpha);
        let b = self.beta.place_within(flow.beta);
        let e: Place<T> = self.elevator.place_within(flow.elevator);
        let e_short = self.elevator_short.place_within(flow.elevator);
        let columns = self.beta.len();
        let [x, z, m] = blend_3(&self.longitudinal, [columns, self.elevator.len()], &a, &b, &e);
        let [n, l] = blend_3(&self.lateral, [columns, self.elevator_short.len()], &a, &b, &e_short);
        let [y, rudder_y, rudder_n, rudder_l] = blend_2(&self.side, columns, &a, &b);
        let [flap_x, flap_z, flap_m, flap_y, flap_n, flap_l] = blend_2(&self.flap, columns, &a_short, &b);
        let aileron = blend_2(&self.aileron, columns, &a_short, &b);
        let damping = blend_1(&self.damping, &a);
        let damping_flap = blend_1(&self.damping_flap, &a_short);
        let [eta] = blend_1(&self.effectiveness, &e);
        let up = flow.flap;
        let by = |i: usize| damping[i] + damping_flap[i] * up;
        let of_aileron = |i: usize| (aileron[i] + aileron[i + 3] * up) * flow.aileron;
        let [p, q, r] = flow.rates;
        [
            x + flap_x * up + by(0) * q,
            y + flap_y * up + of_aileron(0) + rudder_y * flow.rudder + by(4) * r + by(3) * p,
            z + flap_z * up + by(1) * q,
            l + flap_l * up + of_aileron(2) + rudder_l * flow.rudder + by(8) * r + by(7) * p + damping[11] * flow.beta,
            m * eta + flap_m * up + by(2) * q + damping[9],
            n + flap_n * up + of_aileron(1) + rudder_n * flow.rudder + by(5) * r + by(6) * p + damping[10] * flow.beta,
        ]
    }
}

/// The numbers of nested lists of these lengths, the last of which varies fastest. A list of one number stands for that number.
fn flatten(node: &Node<'_>, shape: &[usize], values: &mut Vec<f64>) -> Result<(), TransportError> {
    let Some((length, rest)) = shape.split_first() else {
        values.push(node.number()?);
        return Ok(());
    };
    let items = node.items()?;
    if items.len() != *length {
        return Err(node.error(format!("has {} entries, and the axis {length}", items.len())));
    }
    items.iter().try_for_each(|item| flatten(item, rest, values))
}
