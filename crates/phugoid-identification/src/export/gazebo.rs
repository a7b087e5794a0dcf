//! Parameters of Gazebo's `AdvancedLiftDrag` system, which PX4's simulations of aeroplanes use.
//!
//! Names, units and equations are those of the plugin's source (gz-sim, `AdvancedLiftDrag.cc`): coefficients of first
//! order about zero angle of attack, rates made dimensionless by `b/2V` and `mac/2V`, control derivatives **per
//! degree**, and the drag
//!
//! ```text
//! CD = CD0 + CL^2 / (pi AR eff)
//! ```
//!
//! in place of terms in the angle of attack: `CD0` and `eff` are made to give value and slope of the identified drag at
//! the angle of attack and the elevator of the flight. Moments are about body axes, lift and drag along and across the
//! velocity in the plane of symmetry, the side force along body y: as here. What differs is said in the notes, and in
//! docs/inspect.md.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::Write as _;

use super::identified::{ExportError, Exported, Identified, in_comment};
use crate::core::term::{Coefficient, Variable};
use crate::model_file::{RateSpeed, ReferenceValue};

/// Names of the coefficients in the plugin.
const fn symbol(coefficient: Coefficient) -> &'static str {
    match coefficient {
        Coefficient::Lift => "CL",
        Coefficient::Drag => "CD",
        Coefficient::PitchingMoment => "Cem",
        Coefficient::SideForce => "CY",
        Coefficient::RollingMoment => "Cell",
        Coefficient::YawingMoment => "Cen",
    }
}

/// Oswald's efficiency where the identified drag does not determine one.
const USUAL_EFFICIENCY: f64 = 0.8;
/// Angle of attack of the stall where none was identified, rad.
const STALL: f64 = 0.35;
const SURFACES: [(Variable, &str); 3] =
    [(Variable::Elevator, "elevator"), (Variable::Aileron, "aileron"), (Variable::Rudder, "rudder")];

/// A coefficient as a polynomial of first order: at zero angle of attack and deflections, and slopes.
#[derive(Default)]
struct Linear {
    constant: f64,
    slopes: BTreeMap<Variable, f64>,
}

impl Linear {
    fn slope(&self, variable: Variable) -> f64 {
        self.slopes.get(&variable).copied().unwrap_or(0.0)
    }
}

/// Writes the plugin's element for a model's SDF.
///
/// # Errors
/// [`ExportError`]: increments to a database, no span, a reference that is not in the result.
pub fn gazebo(identified: &Identified<'_>) -> Result<Exported, ExportError> {
    identified.absolute("the advanced lift-drag plugin")?;
    let aircraft = &identified.model.aircraft;
    let mut notes = Vec::new();
    let span = aircraft.wing_span.unwrap_or_else(|| {
        let span = aircraft.wing_area / aircraft.mean_chord;
        notes.push(format!(
            "the model file has no wing span: {span:.3} m, area over mean chord, stands for it in AR. Only induced drag and the \
             lateral motion feel it"
        ));
        span
    });
    let aspect_ratio = span * span / aircraft.wing_area;
    let mut linear: BTreeMap<Coefficient, Linear> = BTreeMap::new();
    for coefficient in Coefficient::ALL {
        linear.insert(coefficient, linearised(identified, coefficient, &mut notes)?);
    }
    let of = |coefficient: Coefficient| linear.get(&coefficient);
    let slope = |c: Coefficient, v: Variable| of(c).map_or(0.0, |l| l.slope(v));
    let constant = |c: Coefficient| of(c).map_or(0.0, |l| l.constant);
    let (drag_constant, efficiency) = drag(identified, aspect_ratio, &linear, &mut notes);
    let mut elements = Elements::default();
    elements.add("CL0", constant(Coefficient::Lift));
    elements.add("CD0", drag_constant);
    elements.add("Cem0", constant(Coefficient::PitchingMoment));
    for c in Coefficient::ALL {
        let name = symbol(c);
        if c != Coefficient::Drag {
            elements.add(&format!("{name}a"), slope(c, Variable::Alpha));
            elements.add(&format!("{name}b"), slope(c, Variable::Beta));
        }
        for (variable, letter) in [(Variable::RollRate, "p"), (Variable::PitchRate, "q"), (Variable::YawRate, "r")] {
            elements.add(&format!("{name}{letter}"), slope(c, variable));
        }
    }
    elements.add("AR", aspect_ratio);
    elements.add("mac", aircraft.mean_chord);
    elements.add("eff", efficiency);
    elements.add("area", aircraft.wing_area);
    for c in [Coefficient::SideForce, Coefficient::RollingMoment, Coefficient::YawingMoment] {
        if constant(c) != 0.0 {
            notes.push(format!("{}_0 = {}: the plugin has no such constant", c.symbol(), constant(c)));
        }
    }
    if slope(Coefficient::Drag, Variable::Beta) != 0.0 {
        notes.push("CD_beta: the plugin has no such term".to_owned());
    }
    let surfaces = surfaces(&linear);
    notes.push(format!(
        "num_ctrl_surfaces is {}: the names are those of joints; put in your model's. direction is 1 where a positive joint angle is \
         trailing edge down (of the right aileron; of a rudder: left), else -1. One element stands for both ailerons: of two \
         joints each has half of it, the left one with the other sign",
        surfaces.1
    ));
    if identified.model.rate_speed == RateSpeed::Reference {
        notes.push(
            "rates are made dimensionless by the reference speed in the model file and by the airspeed in the plugin: \
                    equal at the reference speed"
                .to_owned(),
        );
    }
    let lift = constant(Coefficient::Lift) + slope(Coefficient::Lift, Variable::Alpha) * identified.alpha_typical;
    notes.push(format!(
        "no stall was identified: alpha_stall is set to {STALL} rad, Cema_stall to zero; put in your aircraft's. The plugin blends its \
         stalled wing in long before: at {:.4} rad it changes CL by {:+.1} %",
        identified.alpha_typical,
        100.0 * (blended(lift, identified.alpha_typical) / lift - 1.0)
    ));
    notes.push(
        "some versions of the plugin assign the term Cemb times beta in place of adding it, and lose Cem0 and Cema: \
                look at `Cem =` in AdvancedLiftDrag.cc of yours"
            .to_owned(),
    );
    let lines: String = notes.iter().map(|note| format!("     {}\n", in_comment(note))).collect();
    let mut text = format!(
        "<!-- {}, identified by Phugoid: {}\n{lines}-->\n<plugin filename=\"gz-sim-advanced-lift-drag-system\" \
         name=\"gz::sim::systems::AdvancedLiftDrag\">\n",
        in_comment(&identified.model.name),
        in_comment(&identified.origin)
    );
    text.push_str(&elements.0);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "  <alpha_stall>{STALL}</alpha_stall>");
    text.push_str(
        "  <Cema_stall>0</Cema_stall>\n  <air_density>1.2041</air_density>\n  \
         <forward>1 0 0</forward>\n  <upward>0 0 1</upward>\n  <link_name>base_link</link_name>\n  <cp>0 0 0</cp>\n",
    );
    let _ = writeln!(text, "  <num_ctrl_surfaces>{}</num_ctrl_surfaces>", surfaces.1);
    text.push_str(&surfaces.0);
    text.push_str("</plugin>\n");
    Ok(Exported { text, notes })
}

/// The plugin's lift coefficient before its surfaces: a flat plate, `2 sgn(alpha) sin^2 alpha cos alpha`, is blended in
/// by a sigmoid of steepness 15 per radian about the stall.
fn blended(lift: f64, alpha: f64) -> f64 {
    const STEEPNESS: f64 = 15.0;
    let (below, above) = ((-STEEPNESS * (alpha - STALL)).exp(), (STEEPNESS * (alpha + STALL)).exp());
    let share = (1.0 + below + above) / ((1.0 + below) * (1.0 + above));
    (1.0 - share) * lift + share * 2.0 * alpha.signum() * alpha.sin().powi(2) * alpha.cos()
}

#[derive(Default)]
struct Elements(String);

impl Elements {
    fn add(&mut self, name: &str, value: f64) {
        let _ = writeln!(self.0, "  <{name}>{value}</{name}>");
    }
}

/// The coefficient to first order about zero angle of attack, at the reference airspeed. What is left out or
/// approximated goes into the notes.
fn linearised(
    identified: &Identified<'_>,
    coefficient: Coefficient,
    notes: &mut Vec<String>,
) -> Result<Linear, ExportError> {
    let mut linear = Linear::default();
    let reference = &identified.model.reference;
    for valued in identified.terms(coefficient) {
        let factors: Vec<(usize, i32)> =
            valued.term.factors().iter().copied().filter(|(i, _)| *i != Variable::Airspeed.index()).collect();
        if factors.len() < valued.term.factors().len() {
            notes.push(format!("{}: the plugin has no airspeed term; taken at the reference speed", valued.name));
        }
        if !valued.term.bent().is_empty() {
            notes.push(format!("{} = {}: the plugin has no such term; left out", valued.name, valued.value));
            continue;
        }
        let surface = |name: &str, value: ReferenceValue| identified.surface_reference(name, value);
        match factors.as_slice() {
            [] => linear.constant += valued.value,
            [(index, 1)] if Variable::ALL.get(*index).is_some_and(|v| *v != Variable::AlphaRate) => {
                let Some(&variable) = Variable::ALL.get(*index) else { continue };
                *linear.slopes.entry(variable).or_default() += valued.value;
                let zero = match variable {
                    Variable::Alpha => identified.alpha_reference,
                    Variable::Elevator => surface("elevator", reference.elevator)?,
                    Variable::Aileron => surface("aileron", reference.aileron)?,
                    Variable::Rudder => surface("rudder", reference.rudder)?,
                    _ => 0.0,
                };
                linear.constant -= valued.value * zero;
            }
            [(index, power)] if *index == Variable::Alpha.index() => {
                // The tangent at the angle of attack of the flight.
                let departure = identified.alpha_typical - identified.alpha_reference;
                let slope = valued.value * f64::from(*power) * departure.powi(power - 1);
                *linear.slopes.entry(Variable::Alpha).or_default() += slope;
                linear.constant += valued.value * departure.powi(*power) - slope * identified.alpha_typical;
                notes.push(format!(
                    "{}: the plugin is linear in the angle of attack; its tangent at {:.4} rad stands for it",
                    valued.name, identified.alpha_typical
                ));
            }
            _ => notes.push(format!("{} = {}: the plugin has no such term; left out", valued.name, valued.value)),
        }
    }
    Ok(linear)
}

/// `CD0` and `eff` that give value and slope of the drag at the angle of attack of the flight.
fn drag(
    identified: &Identified<'_>,
    aspect_ratio: f64,
    linear: &BTreeMap<Coefficient, Linear>,
    notes: &mut Vec<String>,
) -> (f64, f64) {
    let at = |c: Coefficient| {
        let Some(l) = linear.get(&c) else { return (0.0, 0.0) };
        let slope = l.slope(Variable::Alpha);
        let value =
            l.constant + slope * identified.alpha_typical + l.slope(Variable::Elevator) * identified.elevator_typical;
        (value, slope)
    };
    // The plugin adds the drag of the elevator itself.
    let own = linear.get(&Coefficient::Drag).map_or(0.0, |l| l.slope(Variable::Elevator)) * identified.elevator_typical;
    let ((lift, lift_slope), (drag, drag_slope)) = (at(Coefficient::Lift), at(Coefficient::Drag));
    let induced = drag_slope / (2.0 * lift * lift_slope);
    let alpha = identified.alpha_typical;
    if induced.is_finite() && induced > 0.0 {
        notes.push(format!(
            "the drag's term in the angle of attack became induced drag, CL^2/(pi AR eff): equal in value and slope at {alpha:.4} rad"
        ));
        return (drag - own - induced * lift * lift, 1.0 / (PI * aspect_ratio * induced));
    }
    let induced = 1.0 / (PI * aspect_ratio * USUAL_EFFICIENCY);
    notes.push(format!(
        "the identified drag does not determine an efficiency: eff is {USUAL_EFFICIENCY}, and CD0 such that the drag at {alpha:.4} rad is \
         the identified one"
    ));
    (drag - own - induced * lift * lift, USUAL_EFFICIENCY)
}

/// The elements of the surfaces that have an effect, and their number.
fn surfaces(linear: &BTreeMap<Coefficient, Linear>) -> (String, usize) {
    let (mut text, mut count) = (String::new(), 0);
    for (variable, name) in SURFACES {
        let slopes: Vec<(Coefficient, f64)> = linear.iter().map(|(c, l)| (*c, l.slope(variable))).collect();
        if slopes.iter().all(|(_, slope)| *slope == 0.0) {
            continue;
        }
        let _ = writeln!(text, "  <control_surface>\n    <name>{name}_joint</name>\n    <index>{count}</index>");
        text.push_str("    <direction>1</direction>\n");
        for (c, slope) in slopes {
            let _ = writeln!(text, "    <{0}_ctrl>{1}</{0}_ctrl>", symbol(c), slope.to_radians());
        }
        text.push_str("  </control_surface>\n");
        count += 1;
    }
    (text, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::ModelFile;

    #[test]
    fn value_and_slope_of_the_drag_are_those_identified() {
        let model = ModelFile::named("hfb320").unwrap();
        let mut identified = Identified::start(&model);
        identified.alpha_typical = 0.11;
        let exported = gazebo(&identified).unwrap();
        let value = |name: &str| -> f64 {
            let from = exported.text.find(&format!("<{name}>")).unwrap() + name.len() + 2;
            let to = exported.text[from..].find('<').unwrap() + from;
            exported.text[from..to].parse().unwrap()
        };
        let drag = |alpha: f64| {
            let lift = value("CL0") + value("CLa") * alpha;
            value("CD0") + lift * lift / (PI * value("AR") * value("eff"))
        };
        // At the reference speed, where v_hat is one.
        let wanted = 0.00567516 + 0.00772612 + 0.674256 * 0.11;
        assert!((drag(0.11) - wanted).abs() < 1e-12, "{}", drag(0.11));
        assert!(((drag(0.111) - drag(0.109)) / 0.002 - 0.674256).abs() < 1e-9);
        // Per degree.
        assert!((value("Cem_ctrl") - -0.990687_f64.to_radians()).abs() < 1e-15);
        assert_eq!((value("Cemq"), value("Cema")), (-25.8439, -0.498586));
        assert!(exported.notes.iter().any(|n| n.contains("CL_V")), "{:?}", exported.notes);
    }
}
