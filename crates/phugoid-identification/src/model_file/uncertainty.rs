//! What is not known exactly about the constants of the aircraft and the scales of its sensors, and leaves no trace in
//! residuals: standard uncertainties of type B (JCGM 100:2008, GUM, 4.3).
//!
//! A scale that is wrong by one part in a hundred is taken up by the derivatives, and the residuals stay as small as
//! before. So its uncertainty has to be declared, and goes into the bounds: to first order each derivative is
//! proportional to a product of powers of these scales.

use super::error::ModelFileError;
use super::section::Section;
use super::{Base, Parameter, Role, Source};
use crate::core::systematic::{SystematicPart, UncertainQuantity};
use crate::core::term::{Coefficient, Term, Variable};
use phugoid_flight_data::quantity::Dimension;

/// Relative standard uncertainties, one sigma as a part of the quantity itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Scale of the true airspeed.
    pub airspeed_scale: f64,
    /// Scale of the angles of attack and sideslip: the vane and the flow about the fuselage (upwash).
    pub flow_angle_scale: f64,
    /// Scale of the positions of the control surfaces.
    pub surface_scale: f64,
    /// Mass of the aircraft.
    pub mass: f64,
    /// Moments of inertia.
    pub inertia: f64,
    /// True if the model file says nothing of them and these are the usual ones.
    pub by_default: bool,
}

/// Lighter aircraft carry nobody, kg: very light aeroplanes with a pilot weigh twice as much.
const UNMANNED_BELOW: f64 = 100.0;

impl Uncertainty {
    /// Nothing is uncertain: for flights of a simulator.
    pub const NONE: Self = Self {
        airspeed_scale: 0.0,
        flow_angle_scale: 0.0,
        surface_scale: 0.0,
        mass: 0.0,
        inertia: 0.0,
        by_default: false,
    };

    /// Of an aircraft that was prepared for a flight test: airspeed 1.5 % (14 CFR 25.1323 allows an installation error
    /// of 3 %), flow angles 2 % (position and upwash of a boom), mass 2 % (fuel), and by judgement surface positions 2 %
    /// and moments of inertia 3 %.
    pub const FLIGHT_TEST: Self = Self {
        airspeed_scale: 0.015,
        flow_angle_scale: 0.02,
        surface_scale: 0.02,
        mass: 0.02,
        inertia: 0.03,
        by_default: false,
    };

    /// Of an aircraft with people in it about which nothing is said, by judgement: nobody says that the vane was
    /// calibrated in flight (3 %), the surfaces under load (3 %), the aircraft weighed with its fuel (3 %) or swung (6 %).
    pub const UNSTATED: Self =
        Self { flow_angle_scale: 0.03, surface_scale: 0.03, mass: 0.03, inertia: 0.06, ..Self::FLIGHT_TEST };

    /// Of an unmanned aircraft with a vane: moments of inertia 10 % (entrained air changes swing tests of small aircraft by
    /// up to 25 %: J. Lehmkuehler, K. C. Wong, D. Verstraete, *Aeronautical Journal* 120, 2016), and by judgement airspeed
    /// 3 %, flow angles 5 %, surface positions 3 % and mass 1 % (it is weighed).
    pub const UNMANNED: Self = Self {
        airspeed_scale: 0.03,
        flow_angle_scale: 0.05,
        surface_scale: 0.03,
        mass: 0.01,
        inertia: 0.1,
        by_default: false,
    };

    /// Those of an aircraft about which the model file says nothing: by its mass, the light ones are unmanned.
    fn usual(mass: &Source) -> Self {
        let light = matches!(mass, Source::Constant(mass) if *mass < UNMANNED_BELOW);
        Self { by_default: true, ..if light { Self::UNMANNED } else { Self::UNSTATED } }
    }

    /// The section `[uncertainty]`; without it the usual ones, and none for increments on a database, whose own errors
    /// are what is estimated.
    pub(super) fn parse(top: &Section, base: Base, mass: &Source) -> Result<Self, ModelFileError> {
        let Some(section) = top.section("uncertainty")? else {
            return Ok(if base == Base::None { Self::usual(mass) } else { Self::NONE });
        };
        section.allow("key", std::iter::once("class").chain(UncertainQuantity::ALL.map(UncertainQuantity::key)))?;
        let class = match section.word("class", &["flight-test", "unmanned"])? {
            Some("unmanned") => Self::UNMANNED,
            Some(_) => Self::FLIGHT_TEST,
            None => Self::NONE,
        };
        let part = |quantity: UncertainQuantity| -> Result<f64, ModelFileError> {
            let (key, of_class) = (quantity.key(), class.scale_of(quantity));
            let value = section.number(key, Dimension::NUMBER)?.unwrap_or(of_class);
            if (0.0..=0.5).contains(&value) {
                Ok(value)
            } else {
                Err(section.error(key, format!("`{key}` is {value}: expected one sigma as a part of one, 0 to 0.5")))
            }
        };
        Ok(Self {
            airspeed_scale: part(UncertainQuantity::AirspeedScale)?,
            flow_angle_scale: part(UncertainQuantity::FlowAngleScale)?,
            surface_scale: part(UncertainQuantity::SurfaceScale)?,
            mass: part(UncertainQuantity::Mass)?,
            inertia: part(UncertainQuantity::Inertia)?,
            by_default: false,
        })
    }

    /// One sigma of the scale of a quantity, as a part of one.
    pub fn scale_of(&self, quantity: UncertainQuantity) -> f64 {
        match quantity {
            UncertainQuantity::AirspeedScale => self.airspeed_scale,
            UncertainQuantity::FlowAngleScale => self.flow_angle_scale,
            UncertainQuantity::SurfaceScale => self.surface_scale,
            UncertainQuantity::Mass => self.mass,
            UncertainQuantity::Inertia => self.inertia,
        }
    }

    /// Where the value of a quantity comes from: the model file, or the default with its source.
    pub fn origin_of(&self, quantity: UncertainQuantity) -> &'static str {
        let unmanned = self.by_default && self.inertia == Self::UNMANNED.inertia;
        match (self.by_default, unmanned, quantity) {
            (false, ..) if self.scale_of(quantity) == 0.0 => {
                "none declared in the model file, or increments on a database"
            }
            (false, ..) => "the model file",
            (_, false, UncertainQuantity::AirspeedScale) => {
                "default; 14 CFR 25.1323 allows an installation error of 3 %"
            }
            (_, true, UncertainQuantity::Inertia) => {
                "default for less than 100 kg; Lehmkuehler, Wong and Verstraete 2016"
            }
            (_, true, UncertainQuantity::Mass) => "default for less than 100 kg, judgement: it is weighed",
            (_, true, _) => "default for less than 100 kg, judgement",
            (_, false, UncertainQuantity::FlowAngleScale) => "default, judgement: vane not calibrated in flight",
            (_, false, UncertainQuantity::SurfaceScale) => "default, judgement: not calibrated under load",
            (_, false, UncertainQuantity::Mass) => "default, judgement: not weighed with its fuel",
            (_, false, UncertainQuantity::Inertia) => "default, judgement: not measured",
        }
    }

    /// One sigma of a parameter as a part of its value: zero for offsets and biases, and for constants, which the
    /// flight determines whatever the scales.
    pub fn of(&self, parameter: &Parameter) -> f64 {
        self.parts_of(parameter).iter().map(|part| part * part).sum::<f64>().sqrt()
    }

    /// The quantities that make the systematic error of a parameter, the largest share first. Empty where
    /// [`of`](Self::of) is zero.
    pub fn shares_of(&self, parameter: &Parameter) -> Vec<SystematicPart> {
        let parts = self.parts_of(parameter);
        let whole: f64 = parts.iter().map(|part| part * part).sum();
        let mut shares: Vec<SystematicPart> = UncertainQuantity::ALL
            .into_iter()
            .zip(parts)
            .filter(|(_, part)| *part != 0.0)
            .map(|(quantity, part)| SystematicPart { quantity, share: part * part / whole })
            .collect();
        shares.sort_by(|a, b| b.share.total_cmp(&a.share));
        shares
    }

    /// What each quantity contributes to one sigma of a parameter, as a part of its value, in the order of
    /// [`UncertainQuantity::ALL`].
    fn parts_of(&self, parameter: &Parameter) -> [f64; 5] {
        match &parameter.role {
            Role::Term(coefficient, term) if !term.is_constant() => self.parts_of_term(*coefficient, term),
            _ => [0.0; 5],
        }
    }

    fn parts_of_term(&self, coefficient: Coefficient, term: &Term) -> [f64; 5] {
        // By dynamic pressure.
        let mut airspeed = 2.0;
        let (mut flow_angle, mut surface) = (0.0, 0.0);
        for (factor, power) in term.powers() {
            let power = f64::from(power);
            match Variable::ALL.get(factor) {
                Some(Variable::Alpha | Variable::Beta) => flow_angle += power,
                Some(Variable::AlphaRate) => {
                    flow_angle += power;
                    airspeed -= power;
                }
                // Rates are divided by the airspeed.
                Some(Variable::RollRate | Variable::PitchRate | Variable::YawRate) => airspeed -= power,
                Some(Variable::Airspeed) => airspeed += power,
                Some(Variable::Elevator | Variable::Aileron | Variable::Rudder) => surface += power,
                None => {}
            }
        }
        let (mass, inertia) = match coefficient {
            Coefficient::Lift | Coefficient::Drag | Coefficient::SideForce => (self.mass, 0.0),
            Coefficient::PitchingMoment | Coefficient::RollingMoment | Coefficient::YawingMoment => (0.0, self.inertia),
        };
        [
            airspeed * self.airspeed_scale,
            flow_angle * self.flow_angle_scale,
            surface * self.surface_scale,
            mass,
            inertia,
        ]
    }

    /// A sentence for the user; `None` where nothing is uncertain.
    pub(crate) fn sentence(&self) -> Option<String> {
        let list: Vec<String> = UncertainQuantity::ALL
            .into_iter()
            .map(|quantity| (quantity.name(), self.scale_of(quantity)))
            .filter(|(_, value)| *value > 0.0)
            .map(|(name, value)| format!("{name} {:.1} %", 100.0 * value))
            .collect();
        (!list.is_empty()).then(|| {
            format!(
                "The bounds contain systematic errors that leave no trace in residuals, one sigma, {}: {}.",
                if self.by_default {
                    "declared by default ([uncertainty] in the model file replaces them)"
                } else {
                    "as the model file declares them"
                },
                list.join(", ")
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Uncertainty;
    use crate::model_file::ModelFile;

    /// The text of a model in absolute form without its section.
    fn unstated() -> String {
        ModelFile::text("hfb320").unwrap().split("[uncertainty]").next().unwrap().to_owned()
    }

    /// By hand: a pitch damping derivative goes with the inverse of the airspeed squared, over that of the rate, and
    /// with the inertia.
    #[test]
    fn each_derivative_takes_the_scales_that_it_depends_on() {
        let file = ModelFile::parse("mine.toml", &unstated()).unwrap();
        assert_eq!(file.uncertainty, Uncertainty { by_default: true, ..Uncertainty::UNSTATED });
        let of = |name: &str| {
            let parameter = file.parameters.iter().find(|p| p.name == name).unwrap();
            file.uncertainty.of(parameter)
        };
        let root = |parts: &[f64]| parts.iter().map(|p| p * p).sum::<f64>().sqrt();
        assert!((of("CL_alpha") - root(&[0.03, 0.03, 0.03])).abs() < 1e-12);
        assert!((of("Cm_q") - root(&[0.015, 0.06])).abs() < 1e-12);
        assert!((of("Cm_elevator") - root(&[0.03, 0.03, 0.06])).abs() < 1e-12);
        assert_eq!(of("Cm_0"), 0.0);
        let parameter = |name: &str| file.parameters.iter().find(|p| p.name == name).unwrap();
        let shares = file.uncertainty.shares_of(parameter("Cm_elevator"));
        let words: Vec<&str> = shares.iter().map(|part| part.quantity.key()).collect();
        assert_eq!(words, ["inertia", "airspeed_scale", "surface_scale"]);
        // 36, 9 and 9 parts of 54.
        assert!((shares[0].share - 36.0 / 54.0).abs() < 1e-12 && (shares[2].share - 9.0 / 54.0).abs() < 1e-12);
        assert!(file.uncertainty.shares_of(parameter("Cm_0")).is_empty());
        assert_eq!(ModelFile::named("hfb320").unwrap().uncertainty, Uncertainty::FLIGHT_TEST);
        assert_eq!(ModelFile::named("f16").unwrap().uncertainty, Uncertainty::NONE);
    }

    #[test]
    fn a_class_gives_what_the_section_leaves_out() {
        let with = |section: &str| {
            ModelFile::parse("mine.toml", &format!("{}\n{section}\n", unstated())).map(|file| file.uncertainty)
        };
        let own = with("[uncertainty]\nclass = \"unmanned\"\nmass = 0.002").unwrap();
        assert_eq!(own, Uncertainty { mass: 0.002, ..Uncertainty::UNMANNED });
        assert_eq!(with("[uncertainty]\nmass = 0.002").unwrap(), Uncertainty { mass: 0.002, ..Uncertainty::NONE });
        assert!(with("[uncertainty]\nclass = \"glider\"").is_err() && with("[uncertainty]\nmass = 2").is_err());
        let light = unstated().replace("mass = ", "mass = \"12 kg\" #");
        let light = ModelFile::parse("mine.toml", &light).unwrap().uncertainty;
        assert_eq!(light, Uncertainty { by_default: true, ..Uncertainty::UNMANNED });
    }
}
