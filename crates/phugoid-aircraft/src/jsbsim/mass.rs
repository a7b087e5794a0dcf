//! Masses of an aircraft: the empty one, point masses and tanks, with their centre and their inertia.
//!
//! Inside, positions are inches in JSBSim's structural frame (x aft, y right, z up) and weights pounds.

use roxmltree::Node;

use super::error::JsbsimError;
use super::model::{Model, State};
use super::source::{Source, child, children, tag};
use super::units::{FOOT, INCH, POUND_MASS, SLUG, SLUG_WEIGHT, Unit};

/// Mass, its centre and its inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Mass with what is in the tanks, kg.
    pub mass_kg: f64,
    /// Centre of gravity in the structural frame of the file (x aft, y right, z up, from its origin), m.
    pub centre_of_gravity_m: [f64; 3],
    /// Inertia about the centre of gravity in body axes (x forward, y right, z down), kg m2. Off the diagonal stand the
    /// elements of the tensor, which are the products of inertia with the opposite sign: `[0][2]` is `-Ixz` with `Ixz` the
    /// integral of x z over the mass.
    pub inertia_kg_m2: [[f64; 3]; 3],
}

/// Sizes that coefficients refer to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Area of the wing, m2.
    pub wing_area_m2: f64,
    /// Span of the wing, m.
    pub wing_span_m: f64,
    /// Mean chord of the wing, m.
    pub chord_m: f64,
    /// Point about which the file gives moments, in the structural frame (x aft, y right, z up), m.
    pub reference_point_m: [f64; 3],
}

/// Sizes in feet and inches.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Metrics {
    pub(super) area_ft2: f64,
    pub(super) span_ft: f64,
    pub(super) chord_ft: f64,
    pub(super) incidence_rad: f64,
    pub(super) reference_in: [f64; 3],
}

impl Metrics {
    /// Reads `<metrics>` and fills `metrics/...`.
    pub(super) fn read(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<Self, JsbsimError> {
        let size = |name: &str, unit: Unit| source.child_quantity(node, name, unit).map(|found| found.unwrap_or(0.0));
        let mut metrics = Self {
            area_ft2: size("wingarea", Unit::SquareFoot)?,
            span_ft: size("wingspan", Unit::Foot)?,
            chord_ft: size("chord", Unit::Foot)?,
            incidence_rad: size("wing_incidence", Unit::Radian)?,
            reference_in: [0.0; 3],
        };
        let tails = [
            ("Sh-sqft", size("htailarea", Unit::SquareFoot)?),
            ("lh-ft", size("htailarm", Unit::Foot)?),
            ("Sv-sqft", size("vtailarea", Unit::SquareFoot)?),
            ("lv-ft", size("vtailarm", Unit::Foot)?),
        ];
        let ratio = |above: f64, below: f64| if below == 0.0 { 0.0 } else { above / below };
        let (tail_arm, fin_arm) = (tails[1].1, tails[3].1);
        let derived = [
            ("Sw-sqft", metrics.area_ft2),
            ("bw-ft", metrics.span_ft),
            ("cbarw-ft", metrics.chord_ft),
            ("iw-rad", metrics.incidence_rad),
            ("iw-deg", metrics.incidence_rad.to_degrees()),
            ("lh-norm", ratio(tail_arm, metrics.chord_ft)),
            ("lv-norm", ratio(fin_arm, metrics.chord_ft)),
            ("vbarh-norm", ratio(tail_arm * tails[0].1, metrics.chord_ft * metrics.area_ft2)),
            ("vbarv-norm", ratio(fin_arm * tails[2].1, metrics.span_ft * metrics.area_ft2)),
        ];
        for (name, value) in tails.into_iter().chain(derived) {
            give(model, &format!("metrics/{name}"), value);
        }
        let points = [("AERORP", "aero-rp"), ("EYEPOINT", "eyepoint"), ("VRP", "visualrefpoint")];
        for location in children(node).filter(|part| tag(*part) == "location") {
            let name = location.attribute("name").unwrap_or_default().trim().to_owned();
            let Some((_, property)) = points.iter().find(|(known, _)| *known == name) else { continue };
            let place = source.triplet(location, Unit::Inch)?;
            for (axis, value) in ["x", "y", "z"].iter().zip(place) {
                give(model, &format!("metrics/{property}-{axis}-in"), value);
            }
            if name == "AERORP" {
                metrics.reference_in = place;
            }
        }
        Ok(metrics)
    }

    /// The same in SI.
    pub(super) fn geometry(&self) -> Geometry {
        Geometry {
            wing_area_m2: self.area_ft2 * FOOT * FOOT,
            wing_span_m: self.span_ft * FOOT,
            chord_m: self.chord_ft * FOOT,
            reference_point_m: self.reference_in.map(|inch| inch * INCH),
        }
    }
}

/// Makes a property with a value.
pub(super) fn give(model: &mut Model, name: &str, value: f64) {
    let index = model.property(name);
    model.properties[index].declared = true;
    model.begin(index, value);
}

/// A mass at a place: a property holds its weight, which may change in flight.
#[derive(Debug, Clone)]
struct Mass {
    /// Property with its weight, pounds.
    weight: usize,
    location_in: [f64; 3],
    /// Properties with its place, for a point mass.
    moving: Option<[usize; 3]>,
    /// Inertia about its own centre in body axes, slug ft2 for each pound of weight.
    own_by_weight: [f64; 3],
    /// Inertia about its own centre in body axes, slug ft2, whatever it weighs.
    own: [[f64; 3]; 3],
}

/// All masses of an aircraft.
#[derive(Debug, Clone, Default)]
pub(super) struct Masses {
    /// Property with the empty weight, pounds.
    empty_weight: usize,
    empty_in: [f64; 3],
    empty_inertia: [[f64; 3]; 3],
    others: Vec<Mass>,
    points: usize,
    tanks: usize,
}

impl Masses {
    /// Reads `<mass_balance>`.
    pub(super) fn read_balance(
        &mut self,
        model: &mut Model,
        source: &Source,
        node: Node<'_, '_>,
    ) -> Result<(), JsbsimError> {
        self.empty_inertia = inertia(source, node)?;
        let empty_lb = source.child_quantity(node, "emptywt", Unit::Pound)?.unwrap_or(0.0);
        for part in children(node) {
            match tag(part) {
                "location" if part.attribute("name").is_some_and(|name| name.trim() == "CG") => {
                    self.empty_in = source.triplet(part, Unit::Inch)?;
                }
                "pointmass" => self.read_point(model, source, part)?,
                _ => {}
            }
        }
        let name = "inertia/empty-weight-lbs";
        give(model, name, empty_lb);
        self.empty_weight = model.property(name);
        Ok(())
    }

    fn read_point(&mut self, model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<(), JsbsimError> {
        let place = child(node, "location").ok_or_else(|| source.refuse(node, "the point mass has no <location>"))?;
        let location_in = source.triplet(place, Unit::Inch)?;
        let weight_lb = source.child_quantity(node, "weight", Unit::Pound)?.unwrap_or(0.0);
        let mut own_by_weight = [0.0; 3];
        if let Some(form) = child(node, "form") {
            let radius = source.child_quantity(form, "radius", Unit::Foot)?.unwrap_or(0.0);
            let length = source.child_quantity(form, "length", Unit::Foot)?.unwrap_or(0.0);
            let (r2, l2) = (radius * radius, length * length);
            let (along, across) = match form.attribute("shape").map(str::trim) {
                Some("tube") => (r2, (6.0 * r2 + l2) / 12.0),
                Some("cylinder") => (r2 / 2.0, (3.0 * r2 + l2) / 12.0),
                Some("sphere") => (r2 * 2.0 / 3.0, r2 * 2.0 / 3.0),
                Some("ball") => (r2 * 2.0 / 5.0, r2 * 2.0 / 5.0),
                _ => (0.0, 0.0),
            };
            own_by_weight = [along, across, across].map(|value| value / SLUG_WEIGHT);
        }
        let own = inertia(source, node)?;
        let index = self.points;
        self.points += 1;
        let name = format!("inertia/pointmass-weight-lbs[{index}]");
        give(model, &name, weight_lb);
        let moving = ["X", "Y", "Z"].map(|axis| format!("inertia/pointmass-location-{axis}-inches[{index}]"));
        for (name, value) in moving.iter().zip(location_in) {
            give(model, name, value);
        }
        let moving = moving.map(|name| model.property(&name));
        self.others.push(Mass { weight: model.property(&name), location_in, moving: Some(moving), own_by_weight, own });
        Ok(())
    }

    /// Reads a `<tank>`.
    pub(super) fn read_tank(
        &mut self,
        model: &mut Model,
        source: &Source,
        node: Node<'_, '_>,
    ) -> Result<(), JsbsimError> {
        let place = child(node, "location").ok_or_else(|| source.refuse(node, "the tank has no <location>"))?;
        let location_in = source.triplet(place, Unit::Inch)?;
        let capacity = source.child_quantity(node, "capacity", Unit::Pound)?.unwrap_or(0.0);
        let contents = source.child_quantity(node, "contents", Unit::Pound)?.unwrap_or(0.0);
        let radius_ft = source.child_quantity(node, "radius", Unit::Foot)?.unwrap_or(0.0);
        let mut own_by_weight = [0.0; 3];
        if let Some(grain) = child(node, "grain_config") {
            // A solid propellant: a cylinder with a bore.
            let bore = source.child_quantity(grain, "bore_diameter", Unit::Foot)?.unwrap_or(0.0) / 2.0;
            let length = source.child_quantity(grain, "length", Unit::Foot)?.unwrap_or(0.0);
            let radii = radius_ft * radius_ft + bore * bore;
            own_by_weight = match grain.attribute("type").map(str::trim) {
                Some("CYLINDRICAL") => {
                    let across = (3.0 * radii + length * length) / 12.0;
                    [radii / 2.0, across, across].map(|value| value / SLUG_WEIGHT)
                }
                _ => [0.0; 3],
            };
        } else if child(node, "radius").is_some() {
            own_by_weight = [0.4 * radius_ft * radius_ft / SLUG_WEIGHT; 3];
        }
        let index = self.tanks;
        self.tanks += 1;
        let held = if capacity > 0.0 { contents.min(capacity) } else { contents };
        let name = format!("propulsion/tank[{index}]/contents-lbs");
        give(model, &name, held);
        let own = [[0.0; 3]; 3];
        self.others.push(Mass { weight: model.property(&name), location_in, moving: None, own_by_weight, own });
        Ok(())
    }

    /// The properties that mass, centre and inertia follow.
    pub(super) fn properties_read(&self) -> impl Iterator<Item = usize> {
        let others = self.others.iter().flat_map(|mass| mass.moving.into_iter().flatten().chain([mass.weight]));
        others.chain([self.empty_weight])
    }

    /// Weight in pounds, centre in inches in the structural frame.
    pub(super) fn weight_and_centre(&self, model: &Model, state: &mut State) -> (f64, [f64; 3]) {
        let mut weight = state.read(model, self.empty_weight);
        let mut moment = self.empty_in.map(|inch| inch * weight);
        for mass in &self.others {
            let pounds = state.read(model, mass.weight);
            let place = mass.place(model, state);
            weight += pounds;
            for (sum, inch) in moment.iter_mut().zip(place) {
                *sum += pounds * inch;
            }
        }
        if weight == 0.0 { (weight, self.empty_in) } else { (weight, moment.map(|sum| sum / weight)) }
    }

    /// All of it, in SI.
    pub(super) fn properties(&self, model: &Model, state: &mut State) -> MassProperties {
        let (weight, centre) = self.weight_and_centre(model, state);
        let mut inertia = self.empty_inertia;
        add_at(&mut inertia, state.read(model, self.empty_weight), self.empty_in, centre);
        for mass in &self.others {
            let pounds = state.read(model, mass.weight);
            let place = mass.place(model, state);
            add_at(&mut inertia, pounds, place, centre);
            for k in 0..3 {
                inertia[k][k] += pounds * mass.own_by_weight[k];
                for j in 0..3 {
                    inertia[k][j] += mass.own[k][j];
                }
            }
        }
        let to_si = SLUG * FOOT * FOOT;
        MassProperties {
            mass_kg: weight * POUND_MASS,
            centre_of_gravity_m: centre.map(|inch| inch * INCH),
            inertia_kg_m2: inertia.map(|row| row.map(|value| value * to_si)),
        }
    }
}

impl Mass {
    fn place(&self, model: &Model, state: &mut State) -> [f64; 3] {
        self.moving.map_or(self.location_in, |properties| properties.map(|property| state.read(model, property)))
    }
}

/// Adds a point at a place to an inertia about a centre, slug ft2.
fn add_at(inertia: &mut [[f64; 3]; 3], pounds: f64, place: [f64; 3], centre: [f64; 3]) {
    let slugs = pounds / SLUG_WEIGHT;
    let arm = arm_ft(place, centre);
    let square: f64 = arm.iter().map(|value| value * value).sum();
    for k in 0..3 {
        for j in 0..3 {
            let whole = if k == j { square } else { 0.0 };
            inertia[k][j] += slugs * (whole - arm[k] * arm[j]);
        }
    }
}

/// From the centre to a place, both in inches in the structural frame, in body axes, ft.
pub(super) fn arm_ft(place_in: [f64; 3], centre_in: [f64; 3]) -> [f64; 3] {
    [(centre_in[0] - place_in[0]) / 12.0, (place_in[1] - centre_in[1]) / 12.0, (centre_in[2] - place_in[2]) / 12.0]
}

/// The inertia that an element gives, as a tensor in body axes, slug ft2. What it calls products is, by default, the elements
/// of the tensor in the structural frame, and with `negated_crossproduct_inertia="false"` the products themselves.
fn inertia(source: &Source, node: Node<'_, '_>) -> Result<[[f64; 3]; 3], JsbsimError> {
    let value = |name: &str| source.child_quantity(node, name, Unit::SlugFoot2).map(|found| found.unwrap_or(0.0));
    let (xx, yy, zz) = (value("ixx")?, value("iyy")?, value("izz")?);
    let sign = if node.attribute("negated_crossproduct_inertia").map(str::trim) == Some("false") { -1.0 } else { 1.0 };
    let (xy, xz, yz) = (-sign * value("ixy")?, sign * value("ixz")?, -sign * value("iyz")?);
    Ok([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
}
