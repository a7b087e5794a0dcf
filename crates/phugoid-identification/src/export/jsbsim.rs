//! The `<aerodynamics>` section of a JSBSim aircraft (JSBSim Reference Manual, section 3.1.10; `FGAerodynamics`).
//!
//! JSBSim works in slug, foot and pound. Its LIFT, DRAG and SIDE axes are wind axes: drag along the velocity, positive
//! aft, whatever the sideslip. Lift and drag of a model file lie in the plane of symmetry and its side force along body
//! y; with sideslip
//!
//! ```text
//! DRAG = qbar S (CD cos beta - CY sin beta)      SIDE = qbar S (CD sin beta + CY cos beta)      LIFT = qbar S CL
//! ```
//!
//! give the same force. Moments are about the aerodynamic reference point: `AERORP` has to be the centre of gravity
//! that the estimates refer to, otherwise JSBSim adds the forces' arms.

use std::fmt::Write as _;

use super::identified::{ExportError, Exported, Identified, Valued, in_comment};
use crate::core::term::{Bend, Coefficient, Variable};
use crate::model_file::RateSpeed;

/// Metres in a foot, exactly.
const FOOT: f64 = 0.3048;

/// Properties that extra inputs of a model file have in JSBSim.
const EXTRA: [(&str, &str); 3] =
    [("flaps", "fcs/flap-pos-rad"), ("speed_brake", "fcs/speedbrake-pos-rad"), ("throttle", "fcs/throttle-pos-norm")];

/// Writes the section; numbers with all their digits.
///
/// ```
/// use phugoid_identification::export::{ExportError, Identified, jsbsim};
/// use phugoid_identification::model_file::ModelFile;
/// let whole = ModelFile::named("hfb320")?; // Identified::new takes the values of an estimation instead
/// assert!(jsbsim(&Identified::start(&whole))?.text.contains("<axis name=\"PITCH\">"));
/// let increments = ModelFile::named("f16")?;
/// assert!(matches!(jsbsim(&Identified::start(&increments)), Err(ExportError::Increments(..))));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ExportError`]: increments to a database, an extra input that JSBSim has no property for, a reference that is not
/// in the result.
pub fn jsbsim(identified: &Identified<'_>) -> Result<Exported, ExportError> {
    identified.absolute("JSBSim's <aerodynamics>")?;
    let mut functions = String::new();
    let mut present = Vec::new();
    for coefficient in Coefficient::ALL {
        let terms = identified.terms(coefficient);
        if terms.is_empty() {
            continue;
        }
        present.push(coefficient);
        let symbol = coefficient.symbol();
        // Writing to a string cannot fail.
        let _ = writeln!(functions, "    <function name=\"aero/coefficient/{symbol}\">\n      <sum>");
        functions.push_str("        <value>0</value>\n");
        for term in &terms {
            functions.push_str(&product(identified, term)?);
        }
        functions.push_str("      </sum>\n    </function>\n");
    }
    let has = |coefficient: Coefficient| present.contains(&coefficient);
    let notes = notes(identified, &present);
    let mut text = head(identified, &notes);
    text.push_str(&functions);
    let property = |coefficient: Coefficient| format!("<property>aero/coefficient/{}</property>", coefficient.symbol());
    if has(Coefficient::Lift) {
        text.push_str(&axis("LIFT", &[&property(Coefficient::Lift)], None));
    }
    if has(Coefficient::SideForce) {
        let (side, drag) = (property(Coefficient::SideForce), property(Coefficient::Drag));
        let turned = |own: &str, other: Option<&str>, operation: &str| {
            let own = format!("<product>{own}<cos><property>aero/beta-rad</property></cos></product>");
            let other = other.map_or_else(
                || "<value>0</value>".to_owned(),
                |other| format!("<product>{other}<sin><property>aero/beta-rad</property></sin></product>"),
            );
            format!("<{operation}>{own}{other}</{operation}>")
        };
        let known = has(Coefficient::Drag);
        let zero = "<value>0</value>".to_owned();
        let own_drag = if known { drag.clone() } else { zero };
        text.push_str(&axis("DRAG", &[&turned(&own_drag, Some(&side), "difference")], None));
        text.push_str(&axis("SIDE", &[&turned(&side, known.then_some(drag.as_str()), "sum")], None));
    } else if has(Coefficient::Drag) {
        text.push_str(&axis("DRAG", &[&property(Coefficient::Drag)], None));
    }
    for (name, coefficient, length) in [
        ("ROLL", Coefficient::RollingMoment, "metrics/bw-ft"),
        ("PITCH", Coefficient::PitchingMoment, "metrics/cbarw-ft"),
        ("YAW", Coefficient::YawingMoment, "metrics/bw-ft"),
    ] {
        if has(coefficient) {
            text.push_str(&axis(name, &[&property(coefficient)], Some(length)));
        }
    }
    text.push_str("  </aerodynamics>\n");
    Ok(Exported { text, notes })
}

fn axis(name: &str, factors: &[&str], length: Option<&str>) -> String {
    let mut text = format!(
        "    <axis name=\"{name}\">\n      <function name=\"aero/{}/{name}\">\n        <product>\n          \
         <property>aero/qbar-psf</property>\n          <property>metrics/Sw-sqft</property>\n",
        if length.is_some() { "moment" } else { "force" }
    );
    if let Some(length) = length {
        let _ = writeln!(text, "          <property>{length}</property>");
    }
    for factor in factors {
        let _ = writeln!(text, "          {factor}");
    }
    text.push_str("        </product>\n      </function>\n    </axis>\n");
    text
}

/// A term as a product of properties.
fn product(identified: &Identified<'_>, valued: &Valued) -> Result<String, ExportError> {
    if valued.term.is_constant() {
        // JSBSim warns of products with one factor.
        return Ok(format!("        <!-- {} -->\n        <value>{}</value>\n", valued.name, valued.value));
    }
    let mut text =
        format!("        <!-- {} -->\n        <product>\n          <value>{}</value>\n", valued.name, valued.value);
    for &(index, power) in valued.term.factors() {
        let factors = factor(identified, index)?;
        for _ in 0..power {
            for factor in &factors {
                let _ = writeln!(text, "          {factor}");
            }
        }
    }
    for bent in valued.term.bent() {
        let factors = factor(identified, bent.variable)?;
        let inside = match factors.as_slice() {
            [one] => one.clone(),
            several => format!("<product>{}</product>", several.concat()),
        };
        let bend = match bent.bend {
            Bend::Magnitude => format!("<abs>{inside}</abs>"),
            Bend::Above(from) => {
                format!("<max><difference>{inside}<value>{from}</value></difference><value>0</value></max>")
            }
        };
        for _ in 0..bent.power {
            let _ = writeln!(text, "          {bend}");
        }
    }
    text.push_str("        </product>\n");
    Ok(text)
}

/// A flight variable as factors.
fn factor(identified: &Identified<'_>, index: usize) -> Result<Vec<String>, ExportError> {
    let model = identified.model;
    let property = |name: &str| format!("<property>{name}</property>");
    let from = |name: &str, reference: f64| {
        if reference == 0.0 {
            property(name)
        } else {
            format!("<difference>{}<value>{reference}</value></difference>", property(name))
        }
    };
    let reference_speed = || {
        model
            .aircraft
            .reference_speed
            .ok_or_else(|| ExportError::NoPlace("the model file has no reference speed".to_owned()))
    };
    // A time: half a length over the speed that the model file names.
    let half_time = |length: f64, actual: &str| match model.rate_speed {
        RateSpeed::Actual => Ok(property(actual)),
        RateSpeed::Reference => reference_speed().map(|speed| format!("<value>{}</value>", 0.5 * length / speed)),
    };
    let chord_time = || half_time(model.aircraft.mean_chord, "aero/ci2vel");
    let span_time = || match model.aircraft.wing_span {
        Some(span) => half_time(span, "aero/bi2vel"),
        None => Err(ExportError::NoPlace("the model file has no wing span".to_owned())),
    };
    let Some(variable) = Variable::ALL.get(index) else {
        let name = model.extra_inputs.get(index - Variable::ALL.len()).map_or("?", String::as_str);
        let known = EXTRA.iter().find(|(extra, _)| *extra == name);
        return known.map(|(_, p)| vec![property(p)]).ok_or_else(|| {
            ExportError::NoPlace(format!(
                "JSBSim has no property for the extra input `{name}`; it has {}",
                EXTRA.map(|(extra, _)| extra).join(", ")
            ))
        });
    };
    let surface = |name: &str, value| identified.surface_reference(name, value);
    let reference = &model.reference;
    Ok(match variable {
        Variable::Alpha => vec![from("aero/alpha-rad", identified.alpha_reference)],
        Variable::Beta => vec![property("aero/beta-rad")],
        Variable::RollRate => vec![property("velocities/p-aero-rad_sec"), span_time()?],
        Variable::PitchRate => vec![property("velocities/q-aero-rad_sec"), chord_time()?],
        Variable::YawRate => vec![property("velocities/r-aero-rad_sec"), span_time()?],
        Variable::Airspeed => {
            vec![property("velocities/vt-fps"), format!("<value>{}</value>", FOOT / reference_speed()?)]
        }
        Variable::Elevator => vec![from("fcs/elevator-pos-rad", surface("elevator", reference.elevator)?)],
        Variable::Aileron => vec![from("fcs/right-aileron-pos-rad", surface("aileron", reference.aileron)?)],
        Variable::Rudder => vec![from("fcs/rudder-pos-rad", surface("rudder", reference.rudder)?)],
        Variable::AlphaRate => vec![property("aero/alphadot-rad_sec"), chord_time()?],
    })
}

fn notes(identified: &Identified<'_>, present: &[Coefficient]) -> Vec<String> {
    let aircraft = &identified.model.aircraft;
    let span = aircraft.wing_span.map_or_else(String::new, |b| format!(", wingspan {} FT", b / FOOT));
    let mut notes = vec![
        format!(
            "the <metrics> of the aircraft must have wingarea {} FT2, chord {} FT{span}",
            aircraft.wing_area / (FOOT * FOOT),
            aircraft.mean_chord / FOOT
        ),
        "the location AERORP must be the centre of gravity that the estimates refer to".to_owned(),
        "surfaces count as in the model file: fcs/elevator-pos-rad positive trailing edge down, \
         fcs/right-aileron-pos-rad positive trailing edge down, fcs/rudder-pos-rad positive trailing edge left"
            .to_owned(),
    ];
    let absent: Vec<&str> = Coefficient::ALL.iter().filter(|c| !present.contains(c)).map(|c| c.symbol()).collect();
    if !absent.is_empty() {
        notes.push(format!("not in the model, and therefore zero: {}", absent.join(", ")));
    }
    notes
}

fn head(identified: &Identified<'_>, notes: &[String]) -> String {
    let mut text = format!(
        "  <!-- {}, identified by Phugoid: {}\n       Derivatives per radian; their numbers have no unit.\n",
        in_comment(&identified.model.name),
        in_comment(&identified.origin)
    );
    for note in notes {
        let _ = writeln!(text, "       {}", in_comment(note));
    }
    text.push_str("  -->\n  <aerodynamics>\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::ModelFile;

    #[test]
    fn increments_are_refused_and_say_what_would_do() {
        let model = ModelFile::named("f16").unwrap();
        let message = jsbsim(&Identified::start(&model)).unwrap_err().to_string();
        assert!(message.contains("increments") && message.contains("without `base`"), "{message}");
    }

    #[test]
    fn every_term_is_there_with_all_its_digits() {
        let model = ModelFile::named("hfb320").unwrap();
        let exported = jsbsim(&Identified::start(&model)).unwrap();
        for p in model.estimated().filter(|p| !p.is_nuisance()) {
            let (_, after) = exported.text.split_once(&format!("<!-- {} -->", p.name)).unwrap();
            let (_, value) = after.split_once("<value>").unwrap();
            assert!(value.starts_with(&format!("{}</value>", p.start)), "{}", p.name);
        }
        for axis in ["LIFT", "DRAG", "PITCH"] {
            assert!(exported.text.contains(&format!("<axis name=\"{axis}\">")), "{axis}");
        }
        // q cbar / (2 V0), with the reference speed of the file.
        assert!(exported.text.contains(&format!("<value>{}</value>", 0.5 * 2.43 / 104.67)), "{}", exported.text);
        assert!(exported.notes.iter().any(|n| n.contains("CY, Cl, Cn")), "{:?}", exported.notes);
    }
}
