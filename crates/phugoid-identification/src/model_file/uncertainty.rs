//! What is not known exactly about the constants of the aircraft and of its sensors, and leaves no trace in residuals:
//! standard uncertainties of type B (JCGM 100:2008, GUM, 4.3).
//!
//! A scale that is wrong by one part in a hundred is taken up by the derivatives, and the residuals stay as small as
//! before. So its uncertainty has to be declared, and goes into the bounds: to first order each derivative is
//! proportional to a product of powers of the scales. SMPE, the joint filter and the batch methods, and the recursive regressions over a
//! whole record, follow what each error really does to their estimate instead, and know of lags, of the centre of gravity and of others
//! that have no powers as well (docs/uncertainty.md).

use super::error::ModelFileError;
use super::section::Section;
use super::{ModelFile, Source};
use crate::core::systematic::{UncertainQuantity, UncertaintyUnit};
use phugoid_flight_data::quantity::Dimension;
use toml::Spanned;
use toml::de::DeValue;

/// Standard uncertainties, one sigma; of scales as a part of the quantity itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Scale of the true airspeed.
    pub airspeed_scale: f64,
    /// Error of the airspeed that grows with the angle of attack, as a part of it per radian.
    pub airspeed_per_alpha: f64,
    /// Density of the air, as a part of it.
    pub air_density: f64,
    /// Scale of the angles of attack and sideslip: the vane and the flow about the fuselage (upwash).
    pub flow_angle_scale: f64,
    /// Zero of the angles of attack and sideslip, rad. Where the model file estimates the bias of the sensor, that is used
    /// instead.
    pub flow_angle_zero: f64,
    /// Lag of the angles of attack and sideslip, s.
    pub flow_angle_lag: f64,
    /// Position of the vanes along body x, m.
    pub flow_angle_position: f64,
    /// Scale of the positions of the control surfaces.
    pub surface_scale: f64,
    /// Time by which the record of the surfaces is late, s.
    pub surface_skew: f64,
    /// Play between what is recorded and each surface, rad from one end to the other.
    pub surface_play: f64,
    /// Scale of each accelerometer.
    pub acceleration_scale: f64,
    /// Position of the accelerometers along body x, and along body z, m.
    pub acceleration_position: f64,
    /// Mass of the aircraft.
    pub mass: f64,
    /// Moments of inertia.
    pub inertia: f64,
    /// Position of the centre of gravity, mean aerodynamic chords.
    pub centre_of_gravity: f64,
    /// Chord and span, as a part of each; the wing area by twice as much.
    pub geometry: f64,
    /// Thrust.
    pub thrust: f64,
    /// Tables and numbers of the aircraft that increments are estimated to.
    pub base: BaseUncertainty,
    /// True if the model file says nothing of them and these are the usual ones.
    pub by_default: bool,
    /// How the errors are carried into those of the parameters.
    pub propagation: Propagation,
    /// Whether values and bounds of SMPE and the joint filter contain what the flight itself says of lags, times and play; it is told in
    /// any case.
    pub learns: bool,
}

/// How well the aircraft of a file is known that increments are estimated to (`base`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BaseUncertainty {
    /// Nothing is carried into the bounds, whatever its file says.
    #[default]
    None,
    /// As its file says: the `uncertainty` elements of DAVE-ML. Nothing of a file that has none.
    Elements,
    /// Each coefficient by itself by this part of its change from the reference condition, one sigma; in the place of what the file says.
    Part(f64),
}

impl BaseUncertainty {
    /// What stands for the number of [`Elements`](Self::Elements), which are many.
    pub const IN_WORDS: &str = "as stated";
}

/// How declared errors are carried into those of the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Propagation {
    /// Each derivative is proportional to a product of powers of the scales, and knows nothing of the other quantities.
    Powers,
    /// SMPE, the joint filter and the batch methods follow what each error does to their estimate, and the recursive regressions do over
    /// a whole record; other methods, and the regressions in flight, as [`Propagation::Powers`].
    #[default]
    Recursion,
}

/// Lighter aircraft carry nobody, kg: very light aeroplanes with a pilot weigh twice as much.
const UNMANNED_BELOW: f64 = 100.0;

/// The word of the key `base` for what the file says.
const ELEMENTS: &str = "elements";

/// 0.15 % of the airspeed per degree of the angle of attack, per radian.
const PER_ALPHA: f64 = 0.0015 / DEGREE;

/// One degree, rad.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

impl Uncertainty {
    /// Nothing is uncertain: for flights of a simulator.
    pub const NONE: Self = Self {
        airspeed_scale: 0.0,
        airspeed_per_alpha: 0.0,
        air_density: 0.0,
        flow_angle_scale: 0.0,
        flow_angle_zero: 0.0,
        flow_angle_lag: 0.0,
        flow_angle_position: 0.0,
        surface_scale: 0.0,
        surface_skew: 0.0,
        surface_play: 0.0,
        acceleration_scale: 0.0,
        acceleration_position: 0.0,
        mass: 0.0,
        inertia: 0.0,
        centre_of_gravity: 0.0,
        geometry: 0.0,
        thrust: 0.0,
        base: BaseUncertainty::None,
        by_default: false,
        propagation: Propagation::Recursion,
        learns: false,
    };

    /// Of an aircraft that was prepared for a flight test: airspeed 1.5 % (14 CFR 25.1323 allows an installation error
    /// of 3 %), flow angles 2 % (position and upwash of a boom), mass 2 % (fuel), and by judgement all else: 0.15 % of the
    /// airspeed per degree of the angle of attack, density of the air 0.5 % (static pressure and temperature are measured), a zero of the
    /// vane of 0.2 deg, a lag of the vane of 10 ms, its position 5 cm, surface positions 2 % and 5 ms with play of 0.1 deg,
    /// accelerometers 0.5 % and 2 cm, moments of inertia 3 %, centre of gravity 0.5 % of the chord, thrust 3 %; wing area, chord and span are
    /// exact, because coefficients are referred to those of the drawing.
    pub const FLIGHT_TEST: Self = Self {
        airspeed_scale: 0.015,
        airspeed_per_alpha: PER_ALPHA,
        air_density: 0.005,
        flow_angle_scale: 0.02,
        flow_angle_zero: 0.2 * DEGREE,
        flow_angle_lag: 0.01,
        flow_angle_position: 0.05,
        surface_scale: 0.02,
        surface_skew: 0.005,
        surface_play: 0.1 * DEGREE,
        acceleration_scale: 0.005,
        acceleration_position: 0.02,
        mass: 0.02,
        inertia: 0.03,
        centre_of_gravity: 0.005,
        thrust: 0.03,
        base: BaseUncertainty::Elements,
        ..Self::NONE
    };

    /// Of an aircraft with people in it about which nothing is said, by judgement: nobody says that the vane was
    /// calibrated in flight (3 %, 0.5 deg, 20 ms, 0.1 m), the surfaces under load (3 %, 10 ms, play of 0.1 deg), the aircraft weighed with its
    /// fuel (3 %, 1 % of the chord) or swung (6 %), the accelerometers (1 %, 5 cm), the thrust (5 %), the wing (lengths 0.5 %) and the
    /// temperature (density of the air 2 %) measured.
    pub const UNSTATED: Self = Self {
        air_density: 0.02,
        flow_angle_scale: 0.03,
        flow_angle_zero: 0.5 * DEGREE,
        flow_angle_lag: 0.02,
        flow_angle_position: 0.1,
        surface_scale: 0.03,
        surface_skew: 0.01,
        surface_play: 0.1 * DEGREE,
        acceleration_scale: 0.01,
        acceleration_position: 0.05,
        mass: 0.03,
        inertia: 0.06,
        centre_of_gravity: 0.01,
        geometry: 0.005,
        thrust: 0.05,
        ..Self::FLIGHT_TEST
    };

    /// Of an unmanned aircraft with a vane: moments of inertia 10 % (entrained air changes swing tests of small aircraft by
    /// up to 25 %: J. Lehmkuehler, K. C. Wong, D. Verstraete, *Aeronautical Journal* 120, 2016), and by judgement airspeed
    /// 3 % and 0.3 % per degree, density of the air 2 %, flow angles 5 %, 1 deg, 30 ms and 2 cm, surface positions 3 % and 15 ms with play of
    /// 0.3 deg, accelerometers 1 % and 2 cm, mass 1 % (it is weighed), centre of gravity 1 % of the chord, lengths 0.5 %, thrust 10 %.
    pub const UNMANNED: Self = Self {
        airspeed_scale: 0.03,
        airspeed_per_alpha: 2.0 * PER_ALPHA,
        air_density: 0.02,
        flow_angle_scale: 0.05,
        flow_angle_zero: DEGREE,
        flow_angle_lag: 0.03,
        flow_angle_position: 0.02,
        surface_scale: 0.03,
        surface_skew: 0.015,
        surface_play: 0.3 * DEGREE,
        acceleration_scale: 0.01,
        acceleration_position: 0.02,
        mass: 0.01,
        inertia: 0.1,
        centre_of_gravity: 0.01,
        geometry: 0.005,
        thrust: 0.1,
        base: BaseUncertainty::Elements,
        ..Self::NONE
    };

    /// Of an unmanned aircraft whose flow angles come from its attitude and path and not from a vane: by judgement a scale
    /// of 10 % (what still air and the mean wind leave of them) and no lag of a vane; else as [`Uncertainty::UNMANNED`].
    pub const UNMANNED_WITHOUT_VANE: Self =
        Self { flow_angle_scale: 0.1, flow_angle_lag: 0.0, flow_angle_position: 0.0, ..Self::UNMANNED };

    /// Those of an aircraft about which the model file says nothing: by its mass, the light ones are unmanned.
    fn usual(mass: &Source) -> Self {
        let light = matches!(mass, Source::Constant(mass) if *mass < UNMANNED_BELOW);
        Self { by_default: true, ..if light { Self::UNMANNED } else { Self::UNSTATED } }
    }

    /// The section `[uncertainty]`; without it the usual ones.
    pub(super) fn parse(top: &Section, mass: &Source, has_known: bool) -> Result<Self, ModelFileError> {
        let Some(section) = top.section("uncertainty")? else { return Ok(Self::usual(mass)) };
        let keys =
            ["class", "propagation", "learn"].into_iter().chain(UncertainQuantity::ALL.map(UncertainQuantity::key));
        section.allow("key", keys)?;
        let classes = ["flight-test", "unstated", "unmanned", "unmanned-without-vane", "none"];
        let mut own = match section.word("class", &classes)? {
            Some("flight-test") => Self::FLIGHT_TEST,
            Some("unstated") => Self::UNSTATED,
            Some("unmanned") => Self::UNMANNED,
            Some("unmanned-without-vane") => Self::UNMANNED_WITHOUT_VANE,
            _ => Self::NONE,
        };
        if section.word("propagation", &["recursion", "powers"])? == Some("powers") {
            own.propagation = Propagation::Powers;
        }
        if let Some(learns) = section.boolean("learn")? {
            own.learns = learns;
        }
        for quantity in UncertainQuantity::ALL {
            let key = quantity.key();
            if quantity == UncertainQuantity::BaseTables {
                if let Some(base) = Self::of_base(&section, has_known)? {
                    own.base = base;
                }
                continue;
            }
            let (dimension, most, expected) = match quantity.unit() {
                UncertaintyUnit::Part => (Dimension::NUMBER, 0.5, "a part of one, 0 to 0.5"),
                UncertaintyUnit::PerAngle => (Dimension::NUMBER, 5.0, "a part of one per radian, 0 to 5"),
                UncertaintyUnit::Angle => (Dimension::ANGLE, 10.0 * DEGREE, "an angle, 0 to 10 deg"),
                UncertaintyUnit::Time => (Dimension::TIME, 1.0, "a time, 0 to 1 s"),
                UncertaintyUnit::Length => (Dimension::LENGTH, 10.0, "a length, 0 to 10 m"),
                UncertaintyUnit::Chord => (Dimension::NUMBER, 0.5, "a part of the mean chord, 0 to 0.5"),
            };
            let Some(value) = section.number(key, dimension)? else { continue };
            if !(0.0..=most).contains(&value) {
                return Err(section.error(key, format!("`{key}` is {value}: expected one sigma as {expected}")));
            }
            if let Some(place) = own.place(quantity) {
                *place = value;
            }
        }
        Ok(own)
    }

    /// The key `base`: a part of each coefficient, or a word for what the file of the base says. `None` without the key.
    fn of_base(section: &Section, has_known: bool) -> Result<Option<BaseUncertainty>, ModelFileError> {
        let key = UncertainQuantity::BaseTables.key();
        let Some(given) = section.get(key).map(Spanned::get_ref) else { return Ok(None) };
        if !has_known {
            let message = "`base` under [uncertainty] is of increments to the aircraft of a file, and this model file names none: its own `base` \
                           is no path";
            return Err(section.error(key, message));
        }
        if matches!(given, DeValue::String(word) if word == ELEMENTS) {
            return Ok(Some(BaseUncertainty::Elements));
        }
        match section.number(key, Dimension::NUMBER)? {
            Some(part) if (0.0..=0.5).contains(&part) => Ok(Some(BaseUncertainty::Part(part))),
            _ => Err(section.error(
                key,
                format!("`{key}` is one sigma as a part of each coefficient, 0 to 0.5, or \"{ELEMENTS}\" for what the file of the base says"),
            )),
        }
    }

    /// The number of a quantity; none of that which is no number alone.
    fn place(&mut self, quantity: UncertainQuantity) -> Option<&mut f64> {
        Some(match quantity {
            UncertainQuantity::AirspeedScale => &mut self.airspeed_scale,
            UncertainQuantity::AirspeedPerAlpha => &mut self.airspeed_per_alpha,
            UncertainQuantity::AirDensity => &mut self.air_density,
            UncertainQuantity::FlowAngleScale => &mut self.flow_angle_scale,
            UncertainQuantity::FlowAngleZero => &mut self.flow_angle_zero,
            UncertainQuantity::FlowAngleLag => &mut self.flow_angle_lag,
            UncertainQuantity::FlowAnglePosition => &mut self.flow_angle_position,
            UncertainQuantity::SurfaceScale => &mut self.surface_scale,
            UncertainQuantity::SurfaceSkew => &mut self.surface_skew,
            UncertainQuantity::SurfacePlay => &mut self.surface_play,
            UncertainQuantity::AccelerationScale => &mut self.acceleration_scale,
            UncertainQuantity::AccelerationPosition => &mut self.acceleration_position,
            UncertainQuantity::Mass => &mut self.mass,
            UncertainQuantity::Inertia => &mut self.inertia,
            UncertainQuantity::CentreOfGravity => &mut self.centre_of_gravity,
            UncertainQuantity::Geometry => &mut self.geometry,
            UncertainQuantity::Thrust => &mut self.thrust,
            UncertainQuantity::BaseTables => return None,
        })
    }

    /// One sigma of a quantity, in the unit that [`UncertainQuantity::unit`] gives; of the tables of a base zero where its file says
    /// it ([`BaseUncertainty::Elements`]).
    pub fn of_quantity(&self, quantity: UncertainQuantity) -> f64 {
        let mut own = *self;
        match (own.place(quantity), self.base) {
            (Some(place), _) => *place,
            (None, BaseUncertainty::Part(part)) => part,
            (None, BaseUncertainty::None | BaseUncertainty::Elements) => 0.0,
        }
    }

    /// One sigma of the quantities that a method may follow, or carry by powers: all but the tables of a base.
    fn of_constants(&self) -> impl Iterator<Item = (UncertainQuantity, f64)> {
        let all = UncertainQuantity::ALL.into_iter().filter(|quantity| *quantity != UncertainQuantity::BaseTables);
        all.map(|quantity| (quantity, self.of_quantity(quantity)))
    }

    /// Whether the methods that can follow the errors: that is asked for, and some are declared.
    pub fn follows(&self) -> bool {
        self.propagation == Propagation::Recursion && self.of_constants().any(|(_, value)| value > 0.0)
    }

    /// Where the value of a quantity comes from: the model file, or the default with its source.
    pub fn origin_of(&self, quantity: UncertainQuantity) -> &'static str {
        let unmanned = self.by_default && self.inertia == Self::UNMANNED.inertia;
        match (self.by_default, unmanned, quantity) {
            (.., UncertainQuantity::BaseTables) => match self.base {
                BaseUncertainty::None => "none declared in the model file",
                BaseUncertainty::Elements => "as the file of `base` says: the uncertainty elements of DAVE-ML",
                BaseUncertainty::Part(_) => "the model file",
            },
            (false, ..) if self.of_quantity(quantity) == 0.0 => "none declared in the model file",
            _ if self.propagation == Propagation::Powers && !Self::has_power(quantity) => {
                "not in use: it has no power, and `propagation = \"powers\"` is asked for"
            }
            (false, ..) => "the model file, or its class",
            (_, false, UncertainQuantity::AirspeedScale) => {
                "default; 14 CFR 25.1323 allows an installation error of 3 %"
            }
            (_, true, UncertainQuantity::Inertia) => {
                "default for less than 100 kg; Lehmkuehler, Wong and Verstraete 2016"
            }
            (_, true, UncertainQuantity::Mass) => "default for less than 100 kg, judgement: it is weighed",
            (_, true, _) => "default for less than 100 kg, judgement",
            (_, false, UncertainQuantity::AirspeedPerAlpha) => "default, judgement: not calibrated over alpha",
            (_, false, UncertainQuantity::AirDensity) => "default, judgement: temperature not measured",
            (_, false, UncertainQuantity::FlowAngleScale) => "default, judgement: vane not calibrated in flight",
            (_, false, UncertainQuantity::FlowAngleZero) => "default, judgement: vane not aligned with the body axes",
            (_, false, UncertainQuantity::FlowAngleLag) => "default, judgement: lag of the vane not measured",
            (_, false, UncertainQuantity::FlowAnglePosition) => "default, judgement: position of the vane not stated",
            (_, false, UncertainQuantity::SurfaceScale) => "default, judgement: not calibrated under load",
            (_, false, UncertainQuantity::SurfaceSkew) => "default, judgement: no common clock stated",
            (_, false, UncertainQuantity::SurfacePlay) => "default, judgement: play not measured",
            (_, false, UncertainQuantity::AccelerationScale) => "default, judgement: no calibration stated",
            (_, false, UncertainQuantity::AccelerationPosition) => "default, judgement: position not stated",
            (_, false, UncertainQuantity::Mass) => "default, judgement: not weighed with its fuel",
            (_, false, UncertainQuantity::Inertia) => "default, judgement: not measured",
            (_, false, UncertainQuantity::CentreOfGravity) => "default, judgement: not weighed with its fuel",
            (_, false, UncertainQuantity::Geometry) => "default, judgement: not measured",
            (_, false, UncertainQuantity::Thrust) => "default, judgement: not measured",
        }
    }

    /// Whether the powers of the scales know of a quantity.
    fn has_power(quantity: UncertainQuantity) -> bool {
        matches!(
            quantity,
            UncertainQuantity::AirspeedScale
                | UncertainQuantity::AirDensity
                | UncertainQuantity::FlowAngleScale
                | UncertainQuantity::SurfaceScale
                | UncertainQuantity::Mass
                | UncertainQuantity::Inertia
                | UncertainQuantity::Geometry
        )
    }

    /// A sentence for the user about what is in the bounds, or that nothing is declared. `followed`: the method has followed
    /// the errors, and every quantity is in its bounds; else those that have powers.
    pub(crate) fn sentence(&self, followed: bool) -> String {
        let (inside, outside): (Vec<_>, Vec<_>) = self
            .of_constants()
            .filter(|(_, value)| *value > 0.0)
            .partition(|(quantity, _)| followed || Self::has_power(*quantity));
        let words = |list: &[(UncertainQuantity, f64)]| -> Vec<String> {
            list.iter().map(|(q, value)| format!("{} {}", q.name(), q.unit().in_words(*value))).collect()
        };
        let not_inside = match outside.as_slice() {
            [] => String::new(),
            outside => format!(
                " They do not contain {}: smpe and ekf follow such errors in flight, the batch methods and the recursive \
                 regressions over a whole record, and no method with propagation = \"powers\" under [uncertainty].",
                words(outside).join(", ")
            ),
        };
        let list = words(&inside);
        if list.is_empty() {
            return "The bounds contain no systematic errors: the model file declares none of airspeed, air density, flow angles, \
                    surfaces, accelerometers, mass, inertia, centre of gravity, geometry and thrust under [uncertainty]."
                .to_owned()
                + &not_inside;
        }
        format!(
            "The bounds contain systematic errors that leave no trace in residuals, one sigma, {}: {}.{not_inside}",
            if self.by_default {
                "declared by default ([uncertainty] in the model file replaces them)"
            } else {
                "as the model file declares them"
            },
            list.join(", ")
        )
    }
}

impl ModelFile {
    /// What is declared uncertain of the aircraft that increments are estimated to, and is not in the bounds where the estimate is not made
    /// again: in a live session. `None` where nothing is declared. An estimation of a whole record works it out and says so in its
    /// verdict.
    pub fn declared_and_not_in_bounds_of_base(&self) -> Option<String> {
        let known = self.known.as_ref()?;
        let name = known.name();
        let what = match self.uncertainty.base {
            BaseUncertainty::Part(part) if part > 0.0 => {
                format!(
                    "errors of the base {name}, of which {:.1} % are declared (`base` under [uncertainty])",
                    100.0 * part
                )
            }
            BaseUncertainty::Elements => match known.aircraft().uncertain().len() {
                0 => return None,
                count => format!("the uncertainty that {name} states of its tables and numbers ({count} in all)"),
            },
            BaseUncertainty::None | BaseUncertainty::Part(_) => return None,
        };
        Some(format!(
            "The bounds do not contain {what}: that is worked out by estimating again, which is done of a whole record and not in flight."
        ))
    }

    /// What is not in the bounds of errors of the aircraft that increments are estimated to, where nothing was worked out: that something
    /// is declared, or that nothing is. `None` without the aircraft of a file.
    pub(crate) fn not_in_bounds_of_base(&self) -> Option<String> {
        let known = self.known.as_ref()?;
        self.declared_and_not_in_bounds_of_base().or_else(|| {
            let name = known.name();
            Some(match known.aircraft().uncertain().len() {
                0 => format!(
                    "The bounds contain no errors of the tables of the base {name}: it states none, and none are declared (`base` under \
                     [uncertainty])."
                ),
                count => format!(
                    "The bounds contain no errors of the tables of the base {name}: it states the uncertainty of its tables and numbers \
                     ({count} in all), and [uncertainty] leaves that out (base = \"{ELEMENTS}\" takes it in)."
                ),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Propagation, Uncertainty};
    use crate::model_file::ModelFile;

    /// The text of a model in absolute form without its section.
    fn unstated() -> String {
        ModelFile::text("hfb320").unwrap().split("[uncertainty]").next().unwrap().to_owned()
    }

    /// Without the section the usual ones hold, of increments to a database as of whole coefficients: a scale is of the whole
    /// derivative. The built-in models of simulated flights say that they declare none.
    #[test]
    fn without_the_section_the_usual_ones_hold_with_and_without_a_base() {
        let usual = Uncertainty { by_default: true, ..Uncertainty::UNSTATED };
        assert_eq!(ModelFile::parse("mine.toml", &unstated()).unwrap().uncertainty, usual);
        let f16 = ModelFile::text("f16").unwrap();
        let (before, section) = f16.split_once("[uncertainty]").unwrap();
        let (_, after) = section.split_once("class = \"none\"").unwrap();
        assert_eq!(ModelFile::parse("mine.toml", &format!("{before}{after}")).unwrap().uncertainty, usual);
        assert_eq!(ModelFile::named("f16").unwrap().uncertainty, Uncertainty::NONE);
        let told = Uncertainty::NONE.sentence(true);
        assert!(
            told.contains("declares none of airspeed, air density, flow angles, surfaces, accelerometers, mass"),
            "{told}"
        );
        assert_eq!(ModelFile::named("hfb320").unwrap().uncertainty, Uncertainty::FLIGHT_TEST);
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
        let own = with("[uncertainty]\nflow_angle_lag = \"25 ms\"\ncentre_of_gravity = \"1 %\"").unwrap();
        assert_eq!(own, Uncertainty { flow_angle_lag: 0.025, centre_of_gravity: 0.01, ..Uncertainty::NONE });
        assert!(own.follows() && !own.learns);
        let learning = with("[uncertainty]\nclass = \"unmanned\"\nlearn = true\nsurface_play = \"0.2 deg\"").unwrap();
        let surface_play = 0.2_f64.to_radians();
        assert_eq!(learning, Uncertainty { learns: true, surface_play, ..Uncertainty::UNMANNED });
        let message = with("[uncertainty]\nlearn = 1").unwrap_err().to_string();
        assert!(message.contains("`learn` is an integer: expected true or false"), "{message}");
        let message = with("[uncertainty]\nacceleration_position = \"20 m\"").unwrap_err().to_string();
        assert!(message.contains("acceleration_position") && message.contains("a length, 0 to 10 m"), "{message}");
        let none = with("[uncertainty]\nclass = \"none\"\npropagation = \"recursion\"").unwrap();
        assert_eq!(none, Uncertainty::NONE);
        assert!(!none.follows());
        let powers = with("[uncertainty]\nclass = \"unmanned-without-vane\"\npropagation = \"powers\"").unwrap();
        let expected = Uncertainty { propagation: Propagation::Powers, ..Uncertainty::UNMANNED_WITHOUT_VANE };
        assert_eq!(powers, expected);
        assert!(!powers.follows());
        let message = with("[uncertainty]\nsurface_skew = 3").unwrap_err().to_string();
        assert!(message.contains("surface_skew") && message.contains("a time, 0 to 1 s"), "{message}");
        let message = with("[uncertainty]\nbase = 0.05").unwrap_err().to_string();
        assert!(message.contains("names none"), "{message}");
        let light = unstated().replace("mass = ", "mass = \"12 kg\" #");
        let light = ModelFile::parse("mine.toml", &light).unwrap().uncertainty;
        assert_eq!(light, Uncertainty { by_default: true, ..Uncertainty::UNMANNED });
    }
}
