//! Units of JSBSim's files, and the factors to SI of what is handed out.
//!
//! JSBSim computes in feet, pounds and slugs. Its own factors are used inside, so that its results come out.

/// Metres in a foot.
pub(super) const FOOT: f64 = 0.3048;
/// Metres in an inch.
pub(super) const INCH: f64 = 0.0254;
/// Kilograms in a pound.
pub(super) const POUND_MASS: f64 = 0.453_592_37;
/// Pounds of weight of a slug.
pub(super) const SLUG_WEIGHT: f64 = 32.174_049;
/// Newtons in a pound of force.
pub(super) const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// Kilograms in a slug: a pound of force over a foot per second squared.
pub(super) const SLUG: f64 = POUND_FORCE / FOOT;
/// Pascals in a pound of force per square foot.
pub(super) const PSF: f64 = POUND_FORCE / (FOOT * FOOT);
/// Kilograms per cubic metre in a slug per cubic foot.
pub(super) const SLUG_FT3: f64 = SLUG / (FOOT * FOOT * FOOT);
/// Metres per second in a knot.
pub(super) const KNOT: f64 = 1852.0 / 3600.0;

/// A unit that a reader wants a quantity in.
#[derive(Debug, Clone, Copy)]
pub(super) enum Unit {
    /// Feet.
    Foot,
    /// Inches.
    Inch,
    /// Square feet.
    SquareFoot,
    /// Pounds of weight, or of mass.
    Pound,
    /// Slugs times feet squared.
    SlugFoot2,
    /// Radians.
    Radian,
}

impl Unit {
    /// What a number in another unit is multiplied by to be in this one, `None` where it is not known.
    pub(super) fn factor_from(self, unit: &str) -> Option<f64> {
        let unit = unit.to_ascii_uppercase();
        // JSBSim's own factor, which is 1 part in 10 million off.
        let metre = 3.280_839_9;
        let length = |unit: &str| match unit {
            "FT" => Some(1.0),
            "IN" => Some(1.0 / 12.0),
            "M" => Some(metre),
            "CM" => Some(0.01 * metre),
            "MM" => Some(0.001 * metre),
            "KM" => Some(1000.0 * metre),
            _ => None,
        };
        match self {
            Self::Foot => length(&unit),
            Self::Inch => length(&unit).map(|feet| 12.0 * feet),
            Self::SquareFoot => unit.strip_suffix('2').and_then(length).map(|feet| feet * feet),
            Self::Pound => match unit.as_str() {
                "LBS" | "LB" => Some(1.0),
                "KG" => Some(1.0 / POUND_MASS),
                "SLUG" | "SLUGS" => Some(SLUG_WEIGHT),
                "N" => Some(0.224_82),
                _ => None,
            },
            Self::SlugFoot2 => match unit.as_str() {
                "SLUG*FT2" => Some(1.0),
                "KG*M2" => Some(1.0 / 1.355_94),
                _ => None,
            },
            Self::Radian => match unit.as_str() {
                "RAD" => Some(1.0),
                "DEG" => Some(std::f64::consts::PI / 180.0),
                _ => None,
            },
        }
    }
}
