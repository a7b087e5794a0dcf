//! What errors of the declared scales make of a parameter, by powers of the scales: to first order each derivative is
//! proportional to a product of them. For methods that do not follow what each error really does to their estimate.
//!
//! The scales are of the whole derivative. An increment to a database is what is left of it when the database is taken away,
//! and so has the error of database and increment together, however small it is itself.

use super::uncertainty::Uncertainty;
use super::{Base, ModelFile, Parameter, RateSpeed, Role};
use crate::core::scaling::ScalingPowers;
use crate::core::systematic::{ByQuantity, SystematicPart, UncertainQuantity};
use crate::core::term::{Coefficient, Term};

/// Number of quantities.
const COUNT: usize = UncertainQuantity::ALL.len();

/// What the database of a model file has in the place of one parameter, at the reference point of the terms. All zero
/// without a database.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DatabasePart {
    /// Of a term of one variable the derivative of the database by it, of a constant or an offset its coefficient; in the
    /// parameter's unit. Zero for other terms.
    pub value: f64,
    /// Of a constant or an offset: what the database changes between zero and the reference point of the flow angles, as its
    /// slope there gives it.
    pub by_flow_angles: f64,
    /// The same for the reference positions of elevator, aileron and rudder.
    pub by_surfaces: [f64; 3],
}

/// The systematic error of one parameter by the powers of the scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByPowers {
    /// One sigma by quantity, in the order of [`UncertainQuantity::ALL`], as a part of database and parameter together.
    parts: [f64; COUNT],
    /// One sigma by quantity that does not depend on the parameter.
    shifts: [f64; COUNT],
    database: f64,
}

impl ByPowers {
    /// Of nothing that is declared.
    pub(crate) const NONE: Self = Self { parts: [0.0; COUNT], shifts: [0.0; COUNT], database: 0.0 };

    /// What one standard uncertainty of each quantity does, where the parameter has a value: estimate less truth, in the order of
    /// [`UncertainQuantity::ALL`]; then what it does whatever the value is.
    pub(crate) fn effects(&self, value: f64) -> [[f64; COUNT]; 2] {
        // A sensor that shows too much makes the regressor too large, and the derivative too small by as much.
        [self.parts.map(|part| -part * (self.database + value)), self.shifts]
    }

    /// What each quantity does, where the parameter has a value.
    fn by_quantity(&self, value: f64) -> ByQuantity {
        let [effects, shifts] = self.effects(value);
        let mut all = ByQuantity::default();
        for (k, quantity) in UncertainQuantity::ALL.into_iter().enumerate() {
            all.add(quantity, effects[k]);
            all.add(quantity, shifts[k]);
        }
        all
    }

    /// One sigma, in the unit of the parameter, where it has a value.
    pub fn std(&self, value: f64) -> f64 {
        self.by_quantity(value).std()
    }

    /// The quantities that make it, the largest share first. Empty where [`std`](Self::std) is zero.
    pub fn shares(&self, value: f64) -> Vec<SystematicPart> {
        self.by_quantity(value).parts()
    }
}

impl ModelFile {
    /// The systematic error of a parameter by the powers of the scales: of a term, and with a database of a constant and an
    /// offset too. A constant of a model without a database has none, because the flight determines it whatever the scales, and
    /// neither has the bias of a sensor.
    ///
    /// ```text
    /// C(v) = D(v) + dC_0 + dC_v (v - v0)        D: database, v0: reference point
    /// dC_v:  p sigma (dD/dv + dC_v)             p: power of the scale in the term
    /// dC_0:  p sigma (D(v0) + dC_0)             and sigma v0 dD/dv, where v is shown with the scale
    /// ```
    pub fn by_powers(&self, parameter: &Parameter, database: &DatabasePart) -> ByPowers {
        let of_term =
            |coefficient: Coefficient, term: &Term| parts(&self.uncertainty, coefficient, term, self.rate_speed);
        match &parameter.role {
            Role::Term(coefficient, term) if !term.is_constant() => {
                ByPowers { parts: of_term(*coefficient, term), database: database.value, ..ByPowers::NONE }
            }
            // A term without factors is a constant.
            Role::Term(coefficient, _) | Role::Offset(coefficient) if self.base != Base::None => ByPowers {
                parts: of_term(*coefficient, &Term::default()),
                shifts: shifts(&self.uncertainty, database),
                database: database.value,
            },
            _ => ByPowers::NONE,
        }
    }
}

fn parts(declared: &Uncertainty, coefficient: Coefficient, term: &Term, rate_speed: RateSpeed) -> [f64; COUNT] {
    let powers = ScalingPowers::of(coefficient, term, rate_speed == RateSpeed::Actual);
    UncertainQuantity::ALL.map(|quantity| {
        let power = match quantity {
            UncertainQuantity::AirspeedScale => powers.airspeed,
            UncertainQuantity::AirDensity => powers.density,
            UncertainQuantity::FlowAngleScale => powers.alpha + powers.beta,
            UncertainQuantity::SurfaceScale => powers.surfaces.iter().sum(),
            UncertainQuantity::Mass => powers.mass,
            UncertainQuantity::Inertia => powers.inertia,
            UncertainQuantity::Geometry => powers.length,
            UncertainQuantity::AirspeedPerAlpha
            | UncertainQuantity::FlowAngleZero
            | UncertainQuantity::FlowAngleLag
            | UncertainQuantity::FlowAnglePosition
            | UncertainQuantity::SurfaceSkew
            | UncertainQuantity::SurfacePlay
            | UncertainQuantity::AccelerationScale
            | UncertainQuantity::AccelerationPosition
            | UncertainQuantity::CentreOfGravity
            | UncertainQuantity::Thrust
            | UncertainQuantity::BaseTables => 0.0,
        };
        power * declared.of_quantity(quantity)
    })
}

fn shifts(declared: &Uncertainty, database: &DatabasePart) -> [f64; COUNT] {
    UncertainQuantity::ALL.map(|quantity| match quantity {
        UncertainQuantity::FlowAngleScale => declared.flow_angle_scale * database.by_flow_angles.abs(),
        // Each surface by itself.
        UncertainQuantity::SurfaceScale => {
            declared.surface_scale * database.by_surfaces.iter().map(|shift| shift * shift).sum::<f64>().sqrt()
        }
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::{ByPowers, DatabasePart};
    use crate::model_file::ModelFile;

    fn root(parts: &[f64]) -> f64 {
        parts.iter().map(|p| p * p).sum::<f64>().sqrt()
    }

    /// The text of a model in absolute form without its section.
    fn unstated() -> String {
        ModelFile::text("hfb320").unwrap().split("[uncertainty]").next().unwrap().to_owned()
    }

    fn of(file: &ModelFile, name: &str, database: DatabasePart) -> ByPowers {
        file.by_powers(file.parameters.iter().find(|p| p.name == name).unwrap(), &database)
    }

    /// By hand: a pitch damping derivative goes with the inverse of the airspeed squared, over that of the rate, and
    /// with the inertia.
    #[test]
    fn each_derivative_takes_the_scales_that_it_depends_on() {
        let file = ModelFile::parse("mine.toml", &unstated()).unwrap();
        let of = |name: &str| of(&file, name, DatabasePart::default());
        assert!((of("CL_alpha").std(-2.0) - 2.0 * root(&[0.03, 0.03, 0.03, 0.02, 0.01])).abs() < 1e-12);
        // The model makes the pitch rate dimensionless with the reference speed. Density 2 %; lengths 0.5 %, of which lift has two,
        // a moment three and the pitch rate one more.
        assert!((of("Cm_q").std(1.0) - root(&[0.03, 0.06, 0.02, 0.02])).abs() < 1e-12);
        assert!((of("Cm_elevator").std(1.0) - root(&[0.03, 0.03, 0.06, 0.02, 0.015])).abs() < 1e-12);
        assert_eq!(of("Cm_0"), ByPowers::NONE);
        let shares = of("Cm_elevator").shares(1.0);
        let words: Vec<&str> = shares.iter().map(|part| part.quantity.key()).collect();
        assert_eq!(words, ["inertia", "airspeed_scale", "surface_scale", "air_density", "geometry"]);
        // 36, 9, 9, 4 and 2.25 parts of 60.25.
        assert!((shares[0].share - 36.0 / 60.25).abs() < 1e-12 && (shares[2].share - 9.0 / 60.25).abs() < 1e-12);
        // An airspeed that shows 1.5 % too much makes it smaller by the square, an inertia that is 6 % larger than is said by 6 %.
        assert!((shares[0].effect + 0.06).abs() < 1e-12 && (shares[1].effect + 0.03).abs() < 1e-12);
        assert!(of("Cm_0").shares(1.0).is_empty());
    }

    /// A scale is of the whole derivative: an increment of zero to a database of -1.2 has the error of -1.2.
    #[test]
    fn an_increment_has_the_error_of_the_whole_derivative() {
        let text = "axes = [\"longitudinal\"]\nbase = \"f16\"\n[aircraft]\nmass = 9300\niyy = 75000\nwing_area = 27.87\n\
                    mean_chord = 3.45\ncg = 0.3\nthrust = 0\nair_density = 0.65\nreference_speed = 200\n[coefficients]\n\
                    CL = [\"1\"]\nCm = [\"elevator\"]\n[parameters]\ndCL_0 = { bounds = [-1, 1] }\n";
        let file = ModelFile::parse("mine.toml", text).unwrap();
        let slope = DatabasePart { value: -1.2, ..DatabasePart::default() };
        let by_powers = of(&file, "dCm_elevator", slope);
        assert!((by_powers.std(0.0) - 1.2 * root(&[0.03, 0.03, 0.06, 0.02, 0.015])).abs() < 1e-12);
        assert!((by_powers.std(0.2) - root(&[0.03, 0.03, 0.06, 0.02, 0.015])).abs() < 1e-12);
        // Of a constant with the airspeed squared and the mass, and where the scales show the reference point elsewhere.
        let constant = DatabasePart { value: 0.3, by_flow_angles: 0.16, by_surfaces: [-0.01, 0.0, 0.0] };
        let found = of(&file, "dCL_0", constant).std(0.1);
        let by_hand = root(&[0.03 * 0.4, 0.03 * 0.4, 0.02 * 0.4, 0.01 * 0.4, 0.03 * 0.16, 0.03 * 0.01]);
        assert!((found - by_hand).abs() < 1e-12, "{found} {by_hand}");
    }
}
