//! Geometry, mass, engines and the changes by damage out of `vehicle.json`, in SI.

use std::path::Path;

use phugoid_flight_dynamics::aircraft::Geometry;

use super::axis::Axis;
use super::damage::Damage;
use super::error::TransportError;
use super::read::{Document, Node};
use super::tables::CASES;

/// m per ft and per inch.
const FOOT: f64 = 0.3048;
const INCH: f64 = 0.0254;
/// kg per pound, N per pound-force.
const POUND: f64 = 0.453_592_37;
const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// kg m^2 per slug ft^2, which is per lbf s^2 ft.
const SLUG_FT2: f64 = POUND_FORCE * FOOT;

/// Mass in kg, centre of gravity in structural axes (x forward, y right, z down; m), and inertia about it, kg m^2, in the order
/// Ixx, Iyy, Izz, Ixz, Iyz, Ixy with products that are positive integrals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mass {
    pub(super) mass: f64,
    pub(super) centre: [f64; 3],
    pub(super) inertia: [f64; 6],
}

/// A tank: mass of its fuel when full, and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tank {
    pub(super) mass: f64,
    pub(super) position: [f64; 3],
}

/// Surfaces that a damage takes away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gone {
    pub(super) upper_rudder: bool,
    pub(super) lower_rudder: bool,
    pub(super) left_outboard_flap: bool,
    pub(super) left_aileron: bool,
    pub(super) left_outboard_elevator: bool,
    pub(super) left_inboard_elevator: bool,
    pub(super) stabiliser_setting: bool,
}

/// What damage changes: mass, centre of gravity and inertia to be added, and surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DamageChange {
    pub(super) mass: Mass,
    pub(super) gone: Gone,
}

/// An engine: its place in structural axes and the direction of its thrust in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EnginePlace {
    pub(super) position: [f64; 3],
    pub(super) direction: [f64; 3],
}

/// `vehicle.json`.
#[derive(Debug)]
pub(super) struct VehicleData {
    /// With the moment reference point as centre of gravity.
    pub(super) geometry: Geometry,
    /// Leading edge of the mean aerodynamic chord behind the datum, m.
    pub(super) leading_edge: f64,
    pub(super) reference: [f64; 3],
    pub(super) mass: Mass,
    /// To be added with the gear down.
    pub(super) gear_down: Mass,
    pub(super) tanks: [Tank; 2],
    /// Left, right.
    pub(super) engines: [EnginePlace; 2],
    /// Lever in percent.
    pub(super) handle: Axis,
    /// Thrust of one engine at these positions of the lever, N.
    pub(super) thrust: Vec<[f64; 1]>,
    /// Drag of the air that an engine takes in, as a coefficient of the wing area.
    pub(super) ram_drag: f64,
    pub(super) damage: [DamageChange; CASES],
}

impl VehicleData {
    /// Reads the file of a folder.
    pub(super) fn read(folder: &Path) -> Result<Self, TransportError> {
        let document = Document::open(folder.join("vehicle.json"))?;
        let root = document.root();
        let mean_chord = root.get("cbar_ft")?.positive()? * FOOT;
        let leading_edge = root.get("le_mac_ft")?.positive()? * FOOT;
        let reference = lengths(&root.get("reference_cg_ft")?, FOOT)?;
        let fraction = (-reference[0] - leading_edge) / mean_chord;
        let geometry = Geometry {
            wing_area: root.get("S_ft2")?.positive()? * FOOT * FOOT,
            span: root.get("b_ft")?.positive()? * FOOT,
            mean_chord,
            cg: fraction,
            cg_reference: fraction,
        };
        let mass = Mass {
            mass: root.get("weight_lb")?.positive()? * POUND,
            centre: lengths(&root.get("cg_ft")?, FOOT)?,
            inertia: named_inertia(&root.get("inertia_slug_ft2")?)?,
        };
        let gear_inertia: [f64; 6] = root.get("inertia_shift_gear_down_slug_ft2")?.vector()?;
        let gear_down = Mass {
            mass: 0.0,
            centre: lengths(&root.get("cg_shift_gear_down_ft")?, FOOT)?,
            inertia: gear_inertia.map(|x| x * SLUG_FT2),
        };
        let fuel = root.get("fuel")?;
        let tank = |mass: &str, position: &str| -> Result<Tank, TransportError> {
            let node = fuel.get(mass)?;
            let pounds = node.number()?;
            if pounds < 0.0 {
                return Err(node.error(format!("is {pounds}, expected 0 or more")));
            }
            Ok(Tank { mass: pounds * POUND, position: lengths(&fuel.get(position)?, INCH)? })
        };
        let tanks = [tank("forward_lb", "forward_position_in")?, tank("aft_lb", "aft_position_in")?];
        if tanks[0].mass + tanks[1].mass >= mass.mass {
            return Err(fuel.error("heavier than the aircraft"));
        }
        let engines = root.get("engines")?;
        let engine = |position: &str, angles: &str| -> Result<EnginePlace, TransportError> {
            let position = lengths(&engines.get(position)?, INCH)?;
            let angles: [f64; 3] = engines.get(angles)?.vector()?;
            let [_, (sin_pitch, cos_pitch), (sin_yaw, cos_yaw)] = angles.map(|x| x.to_radians().sin_cos());
            Ok(EnginePlace { position, direction: [cos_pitch * cos_yaw, sin_yaw, -sin_pitch * cos_yaw] })
        };
        let (handle, thrust) = thrust(&engines.get("thrust_table")?)?;
        Ok(Self {
            geometry,
            leading_edge,
            reference,
            mass,
            gear_down,
            tanks,
            engines: [engine("left_position_in", "left_angles_deg")?, engine("right_position_in", "right_angles_deg")?],
            handle,
            thrust,
            ram_drag: engines.get("ram_drag_coefficient")?.number()?,
            damage: damage(&root.get("damage")?)?,
        })
    }
}

fn lengths(node: &Node<'_>, unit: f64) -> Result<[f64; 3], TransportError> {
    Ok(node.vector::<3>()?.map(|x| x * unit))
}

/// Inertia with its names, kg m^2.
fn named_inertia(node: &Node<'_>) -> Result<[f64; 6], TransportError> {
    let mut inertia = [0.0; 6];
    for (value, name) in inertia.iter_mut().zip(["Ixx", "Iyy", "Izz", "Ixz", "Iyz", "Ixy"]) {
        *value = node.get(name)?.number()? * SLUG_FT2;
    }
    Ok(inertia)
}

/// Lever in percent and thrust of one engine, N.
fn thrust(node: &Node<'_>) -> Result<(Axis, Vec<[f64; 1]>), TransportError> {
    let (levers, forces) = (node.get("handle_percent")?, node.get("thrust_lb")?);
    let (handle, thrust) = (levers.numbers()?, forces.numbers()?);
    if thrust.len() != handle.len() {
        return Err(forces.error(format!("has {} numbers, handle_percent has {}", thrust.len(), handle.len())));
    }
    let problem = "expected at least two numbers, each larger than the one before it";
    let handle = Axis::new(handle).ok_or_else(|| levers.error(problem))?;
    Ok((handle, thrust.iter().map(|x| [x * POUND_FORCE]).collect()))
}

fn damage(node: &Node<'_>) -> Result<[DamageChange; CASES], TransportError> {
    let items = node.items()?;
    let found = items.len();
    let changes: Vec<DamageChange> = items
        .iter()
        .zip(Damage::ALL.iter().skip(1))
        .map(|(item, case)| change(item, *case))
        .collect::<Result<_, _>>()?;
    let problem = |_| node.error(format!("has {found} cases, expected {CASES}"));
    if found > CASES {
        return Err(problem(changes));
    }
    changes.try_into().map_err(problem)
}

fn change(node: &Node<'_>, damage: Damage) -> Result<DamageChange, TransportError> {
    let case = node.get("case")?;
    if case.number()? != damage.case() as f64 {
        return Err(case.error(format!("expected {} ({damage})", damage.case())));
    }
    let mass = Mass {
        mass: node.get("d_weight_lb")?.number()? * POUND,
        centre: lengths(&node.get("d_cg_in")?, INCH)?,
        inertia: named_inertia(&node.get("d_inertia_slug_ft2")?)?,
    };
    let mut gone = Gone::default();
    for surface in node.get("surfaces_gone")?.items()? {
        let missing = match surface.text()? {
            "upper rudder" => &mut gone.upper_rudder,
            "lower rudder" => &mut gone.lower_rudder,
            "left outboard flap" => &mut gone.left_outboard_flap,
            "left aileron" => &mut gone.left_aileron,
            "left outboard elevator" => &mut gone.left_outboard_elevator,
            "left inboard elevator" => &mut gone.left_inboard_elevator,
            "stabiliser gain 0" => &mut gone.stabiliser_setting,
            _ => return Err(surface.error("a surface that is not known")),
        };
        *missing = true;
    }
    Ok(DamageChange { mass, gone })
}

impl Mass {
    /// This without fuel that was in tanks, each a point: a share of it, 0 to 1, is left.
    pub(super) fn with_fuel(self, tanks: &[Tank; 2], left: f64) -> Self {
        let burnt = tanks.map(|tank| Tank { mass: tank.mass * (1.0 - left), ..tank });
        let mass = self.mass - burnt[0].mass - burnt[1].mass;
        let centre: [f64; 3] = std::array::from_fn(|i| {
            (self.mass * self.centre[i] - burnt.iter().map(|tank| tank.mass * tank.position[i]).sum::<f64>()) / mass
        });
        // About the old centre without the fuel, then about the new one.
        let mut inertia = self.inertia;
        let from_old = |point: [f64; 3]| std::array::from_fn(|i| point[i] - self.centre[i]);
        for tank in burnt {
            inertia = less_point(inertia, tank.mass, from_old(tank.position));
        }
        Self { mass, centre, inertia: less_point(inertia, mass, from_old(centre)) }
    }

    /// The sum of each.
    pub(super) fn plus(self, change: &Self) -> Self {
        Self {
            mass: self.mass + change.mass,
            centre: std::array::from_fn(|i| self.centre[i] + change.centre[i]),
            inertia: std::array::from_fn(|i| self.inertia[i] + change.inertia[i]),
        }
    }

    /// The inertia tensor, its products negative.
    pub(super) fn tensor(&self) -> [[f64; 3]; 3] {
        let [xx, yy, zz, xz, yz, xy] = self.inertia;
        [[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]]
    }
}

/// Inertia less that of a point mass at a distance.
fn less_point(inertia: [f64; 6], mass: f64, [x, y, z]: [f64; 3]) -> [f64; 6] {
    let point = [y * y + z * z, x * x + z * z, x * x + y * y, x * z, y * z, x * y];
    std::array::from_fn(|i| inertia[i] - mass * point[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points that are burnt from a body of three leave the third.
    #[test]
    fn burning_points_leaves_the_rest() {
        let points = [(2.0, [1.0, 0.0, 0.5]), (3.0, [-1.0, 0.2, 0.0]), (5.0, [0.3, -0.4, 1.0])];
        let mass: f64 = points.iter().map(|(m, _)| m).sum();
        let centre: [f64; 3] = std::array::from_fn(|i| points.iter().map(|(m, r)| m * r[i]).sum::<f64>() / mass);
        let whole = points.iter().fold([0.0; 6], |sum, (m, r)| {
            let arm = std::array::from_fn(|i| r[i] - centre[i]);
            less_point(sum, -m, arm)
        });
        let whole = Mass { mass, centre, inertia: whole };
        let tanks = [0, 1].map(|i: usize| Tank { mass: points[i].0, position: points[i].1 });
        let rest = whole.with_fuel(&tanks, 0.0);
        assert!((rest.mass - 5.0).abs() < 1e-12);
        for i in 0..3 {
            assert!((rest.centre[i] - points[2].1[i]).abs() < 1e-12);
        }
        assert!(rest.inertia.iter().all(|x| x.abs() < 1e-12), "{:?}", rest.inertia);
        assert_eq!(whole.with_fuel(&tanks, 1.0).mass, whole.mass);
    }
}
