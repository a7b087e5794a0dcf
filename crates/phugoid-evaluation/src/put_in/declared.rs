//! Errors that leave no trace in residuals, of the sizes that a model file declares under `[uncertainty]`.

use phugoid_flight_data::record::Record;
use phugoid_identification::estimation::UncertainQuantity;
use phugoid_identification::model_file::{AirDensity, Base, ModelFile, Thrust, Uncertainty};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::channels::{add, constant, delay, each, recorded};

/// One error of its own: a quantity, and of which sensor, surface or axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Site {
    /// The quantity, whose declared uncertainty is that of each of its sites.
    pub quantity: UncertainQuantity,
    /// The channel or constant; empty where there is one alone.
    pub of: &'static str,
}

const fn site(quantity: UncertainQuantity, of: &'static str) -> Site {
    Site { quantity, of }
}

/// All sites.
pub const SITES: [Site; 30] = [
    site(UncertainQuantity::AirspeedScale, "true_airspeed"),
    site(UncertainQuantity::AirspeedPerAlpha, "true_airspeed"),
    site(UncertainQuantity::AirDensity, ""),
    site(UncertainQuantity::FlowAngleScale, "alpha"),
    site(UncertainQuantity::FlowAngleScale, "beta"),
    site(UncertainQuantity::FlowAngleZero, "alpha"),
    site(UncertainQuantity::FlowAngleZero, "beta"),
    site(UncertainQuantity::FlowAngleLag, "alpha"),
    site(UncertainQuantity::FlowAngleLag, "beta"),
    site(UncertainQuantity::FlowAnglePosition, "alpha"),
    site(UncertainQuantity::FlowAnglePosition, "beta"),
    site(UncertainQuantity::SurfaceScale, "elevator"),
    site(UncertainQuantity::SurfaceScale, "aileron"),
    site(UncertainQuantity::SurfaceScale, "rudder"),
    site(UncertainQuantity::SurfaceSkew, ""),
    site(UncertainQuantity::SurfacePlay, "elevator"),
    site(UncertainQuantity::SurfacePlay, "aileron"),
    site(UncertainQuantity::SurfacePlay, "rudder"),
    site(UncertainQuantity::AccelerationScale, "ax"),
    site(UncertainQuantity::AccelerationScale, "ay"),
    site(UncertainQuantity::AccelerationScale, "az"),
    site(UncertainQuantity::AccelerationPosition, "ahead"),
    site(UncertainQuantity::AccelerationPosition, "below"),
    site(UncertainQuantity::Mass, ""),
    site(UncertainQuantity::Inertia, "ixx"),
    site(UncertainQuantity::Inertia, "iyy"),
    site(UncertainQuantity::Inertia, "izz"),
    site(UncertainQuantity::CentreOfGravity, ""),
    site(UncertainQuantity::Geometry, ""),
    site(UncertainQuantity::Thrust, ""),
];

impl Site {
    /// Puts an error of size `c` (in the unit of the quantity) into a flight and its model file: a sensor shows `(1 + c)` times what is
    /// true, `c` radians more, or what was true `c` seconds before, or stands `c` metres ahead or below; the aircraft has `(1 + c)` times
    /// what the model file says, its centre of gravity `c` chords behind, or as much play between what is recorded and a surface as `c`
    /// has, whatever its sign. A flight without the channel, and what the model file takes from a channel that the flight lacks, stay as
    /// they are; so does a thrust that is that of the trim. What it does to the truth says [`Site::shift_of_truth`].
    pub fn put_in(self, c: f64, record: &mut Record, model: &mut ModelFile) {
        match self.quantity {
            UncertainQuantity::AirspeedScale
            | UncertainQuantity::FlowAngleScale
            | UncertainQuantity::SurfaceScale
            | UncertainQuantity::AccelerationScale => each(record, self.of, |v| v * (1.0 + c)),
            UncertainQuantity::AirspeedPerAlpha => {
                let mut alpha = recorded(record, "alpha").into_iter();
                each(record, self.of, |v| {
                    let here = alpha.next().filter(|a| a.is_finite()).unwrap_or(0.0);
                    v * (1.0 + c * here)
                });
            }
            UncertainQuantity::AirDensity => {
                each(record, "air_density", |v| v * (1.0 + c));
                match &mut model.aircraft.air_density {
                    AirDensity::Known(source) => constant(source, 1.0 + c),
                    // As much denser as the air is so far below.
                    AirDensity::StandardAtmosphere | AirDensity::BookAtmosphere => {
                        each(record, "altitude", |v| v - c * DENSITY_HEIGHT_M);
                    }
                }
            }
            UncertainQuantity::FlowAngleZero => each(record, self.of, |v| v + c),
            UncertainQuantity::FlowAngleLag => delay(record, self.of, c),
            UncertainQuantity::FlowAnglePosition => {
                let (rate, sign) = if self.of == "alpha" { ("q", -1.0) } else { ("r", 1.0) };
                let speeds = recorded(record, "true_airspeed");
                let moved: Vec<f64> =
                    recorded(record, rate).iter().zip(speeds).map(|(rate, v)| sign * c * rate / v).collect();
                add(record, self.of, &moved);
            }
            UncertainQuantity::AccelerationPosition => {
                let arm = if self.of == "ahead" { [c, 0.0, 0.0] } else { [0.0, 0.0, c] };
                for (name, moved) in ["ax", "ay", "az"].into_iter().zip(felt_at(record, arm)) {
                    add(record, name, &moved);
                }
            }
            UncertainQuantity::SurfacePlay => {
                // What is recorded lies ahead of the surface by half the play, after it has moved that far in one direction.
                let half = 0.5 * c.abs();
                let (mut ahead, mut before) = (0.0_f64, None);
                each(record, self.of, |v| {
                    if v.is_finite() {
                        ahead = (ahead + v - before.replace(v).unwrap_or(v)).clamp(-half, half);
                    }
                    v + ahead
                });
            }
            UncertainQuantity::SurfaceSkew => {
                ["elevator", "aileron", "rudder"].into_iter().for_each(|name| delay(record, name, c));
            }
            UncertainQuantity::Mass => constant(&mut model.aircraft.mass, 1.0 / (1.0 + c)),
            UncertainQuantity::Inertia => {
                let aircraft = &mut model.aircraft;
                let place = match self.of {
                    "ixx" => aircraft.ixx.as_mut(),
                    "izz" => aircraft.izz.as_mut(),
                    _ => Some(&mut aircraft.iyy),
                };
                place.into_iter().for_each(|source| constant(source, 1.0 / (1.0 + c)));
            }
            UncertainQuantity::CentreOfGravity => {
                if let Some(cg) = model.aircraft.cg.as_mut().filter(|_| model.base == Base::F16) {
                    *cg -= c;
                }
            }
            UncertainQuantity::Geometry => {
                let aircraft = &mut model.aircraft;
                aircraft.wing_area /= (1.0 + c).powi(2);
                aircraft.mean_chord /= 1.0 + c;
                aircraft.wing_span = aircraft.wing_span.map(|span| span / (1.0 + c));
            }
            UncertainQuantity::Thrust => {
                each(record, "thrust", |v| v / (1.0 + c));
                if let Thrust::Known(source) = &mut model.aircraft.thrust {
                    constant(source, 1.0 / (1.0 + c));
                }
            }
            // No site is of them.
            UncertainQuantity::BaseTables => {}
        }
    }

    /// How much the true value of a parameter changes by an error of size `c` that [`Site::put_in`] puts in: derivatives of moments are about
    /// the centre of gravity that the model file means, `Cm - c CN` and `Cn - c CY cbar/b`. Zero of increments to the tables of the
    /// F-16, which are about the true one, and of every other error. `truth` gives true values by name.
    pub fn shift_of_truth(self, c: f64, model: &ModelFile, name: &str, truth: impl Fn(&str) -> Option<f64>) -> f64 {
        if self.quantity != UncertainQuantity::CentreOfGravity || model.base != Base::None {
            return 0.0;
        }
        let from = |force: &str, rest: &str| truth(&format!("{force}_{rest}")).unwrap_or(0.0);
        let arm = model.aircraft.wing_span.map_or(0.0, |span| model.aircraft.mean_chord / span);
        match (name.strip_prefix("Cm_"), name.strip_prefix("Cn_")) {
            (Some(rest), _) => -c * from("CL", rest),
            (_, Some(rest)) => -c * arm * from("CY", rest),
            (None, None) => 0.0,
        }
    }
}

/// One error of each site, in the order of [`SITES`] and the units of their quantities; zero of what is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes(pub [f64; SITES.len()]);

impl Sizes {
    /// None at all.
    pub const NONE: Self = Self([0.0; SITES.len()]);

    /// Each drawn from a normal distribution with the standard uncertainty that `declared` has of its quantity, and those of the quantities
    /// that are not `wanted` zero. The numbers come from `seed` alone, and those of a site do not depend on what else is wanted.
    pub fn drawn(declared: &Uncertainty, seed: u64, wanted: impl Fn(UncertainQuantity) -> bool) -> Self {
        // Numbers of their own, apart from those of other studies.
        let mut random = Pcg64Mcg::seed_from_u64(0x6472_6177_6e00_u64.wrapping_add(seed));
        let mut normal = || {
            let (a, b): (f64, f64) = (random.random::<f64>().max(1e-300), random.random());
            (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
        };
        Self(SITES.map(|site| {
            let size = normal() * declared.of_quantity(site.quantity);
            if wanted(site.quantity) { size } else { 0.0 }
        }))
    }

    /// Each of the size that `sizes` has of its quantity, with a sign that comes from `seed` alone.
    pub fn of_either_sign(sizes: &Uncertainty, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(0x7369_676e_0000_u64.wrapping_add(seed));
        Self(SITES.map(|site| sizes.of_quantity(site.quantity) * if random.random() { 1.0 } else { -1.0 }))
    }

    /// One site alone, by its place in [`SITES`].
    pub fn of_one(site: usize, size: f64) -> Self {
        let mut own = Self::NONE;
        own.0[site] = size;
        own
    }

    /// The sites that are wrong, with their sizes.
    pub fn wrong(&self) -> impl Iterator<Item = (Site, f64)> {
        SITES.into_iter().zip(self.0).filter(|(_, size)| *size != 0.0)
    }

    /// Puts all of them into a flight and its model file, in the order of [`SITES`].
    pub fn put_in(&self, record: &mut Record, model: &mut ModelFile) {
        self.wrong().for_each(|(site, size)| site.put_in(size, record, model));
    }

    /// What is then true of a parameter, as far as [`Site::shift_of_truth`] knows; `truth` gives values by name that the flight had before.
    pub fn shift_of_truth(&self, model: &ModelFile, name: &str, truth: impl Fn(&str) -> Option<f64>) -> f64 {
        self.wrong().map(|(site, size)| site.shift_of_truth(size, model, name, &truth)).sum()
    }
}

/// Height over which the density of the troposphere falls by one part in `e`, m: `1/(g/(R T) - L/T)` at 273 K.
const DENSITY_HEIGHT_M: f64 = 9874.0;

/// What accelerometers at `arm` (m, body axes) feel more than at the centre of gravity, by axis: `w' x r + w x (w x r)`, m/s^2. A rate that is
/// not recorded is zero; their derivatives are central differences.
fn felt_at(record: &Record, arm: [f64; 3]) -> [Vec<f64>; 3] {
    let time = &record.time;
    let or_zero = |name: &str| -> Vec<f64> {
        recorded(record, name).into_iter().map(|v| if v.is_finite() { v } else { 0.0 }).collect()
    };
    let rates = ["p", "q", "r"].map(or_zero);
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let felt: Vec<[f64; 3]> = (0..time.len())
        .map(|k| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(time.len() - 1));
            let step_s = time[after] - time[before];
            let accelerations = rates.each_ref().map(|rate| (rate[after] - rate[before]) / step_s);
            let rates = rates.each_ref().map(|rate| rate[k]);
            let (turned, swung) = (cross(accelerations, arm), cross(rates, cross(rates, arm)));
            std::array::from_fn(|i| turned[i] + swung[i])
        })
        .collect();
    std::array::from_fn(|axis| felt.iter().map(|felt| felt[axis]).collect())
}

#[cfg(test)]
mod tests {
    use phugoid_identification::model_file::Source;

    use super::*;

    fn record() -> Record {
        let time: Vec<f64> = (0..5).map(|k| 0.1 * f64::from(k)).collect();
        let ramp: Vec<f64> = (0..5).map(|k| 0.01 * f64::from(k)).collect();
        Record::from_columns("test", [("time_s", time), ("alpha_rad", ramp.clone()), ("elevator_rad", ramp)]).unwrap()
    }

    #[test]
    fn what_is_drawn_of_one_site_does_not_depend_on_what_else_is_wanted() {
        let declared = Uncertainty::FLIGHT_TEST;
        let all = Sizes::drawn(&declared, 7, |_| true);
        assert_eq!(all, Sizes::drawn(&declared, 7, |_| true));
        assert_ne!(all, Sizes::drawn(&declared, 8, |_| true));
        let mass = Sizes::drawn(&declared, 7, |quantity| quantity == UncertainQuantity::Mass);
        let [(site, size)] = mass.wrong().collect::<Vec<_>>()[..] else { panic!("{mass:?}") };
        assert!(site.quantity == UncertainQuantity::Mass && all.wrong().any(|(s, c)| s == site && c == size));
        // Lengths are exact in this class: all other sites are wrong.
        assert_eq!(all.wrong().count(), SITES.len() - 1);
        assert_eq!(Sizes::drawn(&Uncertainty::NONE, 7, |_| true), Sizes::NONE);
    }

    /// The root mean square of 400 draws of each site is that of the declared sigma within four of its standard errors, `1/sqrt(2 n)`.
    #[test]
    fn what_is_drawn_has_the_declared_standard_deviation() {
        let declared = Uncertainty::UNSTATED;
        let squares: f64 = (0..400)
            .flat_map(|seed| Sizes::drawn(&declared, seed, |_| true).wrong().collect::<Vec<_>>())
            .map(|(site, size)| (size / declared.of_quantity(site.quantity)).powi(2))
            .sum();
        let rms = (squares / (400.0 * SITES.len() as f64)).sqrt();
        assert!((rms - 1.0).abs() < 4.0 / (2.0 * 400.0 * SITES.len() as f64).sqrt(), "{rms}");
    }

    #[test]
    fn fixed_sizes_have_either_sign() {
        let sizes: Vec<f64> = (0..40)
            .flat_map(|seed| {
                let own = Sizes::of_either_sign(&Uncertainty { mass: 0.03, ..Uncertainty::NONE }, seed);
                own.wrong().map(|(_, size)| size).collect::<Vec<_>>()
            })
            .collect();
        assert!(sizes.len() == 40 && sizes.iter().all(|size| size.abs() == 0.03));
        assert!((10..=30).contains(&sizes.iter().filter(|size| **size > 0.0).count()));
    }

    #[test]
    fn errors_are_those_that_a_model_file_means() {
        let put = |quantity, of, c| {
            let (mut record, mut model) = (record(), ModelFile::named("hfb320").unwrap());
            Site { quantity, of }.put_in(c, &mut record, &mut model);
            (record, model)
        };
        let (shown, _) = put(UncertainQuantity::FlowAngleScale, "alpha", 0.1);
        assert!((shown.channel("alpha").unwrap().values[4] - 0.044).abs() < 1e-15);
        let (shown, _) = put(UncertainQuantity::FlowAngleLag, "alpha", 0.05);
        assert!((shown.channel("alpha").unwrap().values[4] - 0.035).abs() < 1e-15, "what was true 50 ms before");
        // What is recorded runs ahead of the surface until half the play is taken up.
        let (shown, _) = put(UncertainQuantity::SurfacePlay, "elevator", -0.03);
        let elevator = &shown.channel("elevator").unwrap().values;
        for (found, expected) in elevator.iter().zip([0.0, 0.02, 0.035, 0.045, 0.055]) {
            assert!((found - expected).abs() < 1e-15, "{elevator:?}");
        }
        // The aircraft is heavier by two per cent than what the file says.
        let mass = |model: &ModelFile| match model.aircraft.mass {
            Source::Constant(value) => value,
            Source::Channel(_) => f64::NAN,
        };
        let (_, model) = put(UncertainQuantity::Mass, "", 0.02);
        assert!((mass(&model) * 1.02 / mass(&ModelFile::named("hfb320").unwrap()) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_centre_of_gravity_moves_the_truth_or_the_tables() {
        let site = Site { quantity: UncertainQuantity::CentreOfGravity, of: "" };
        let truth = |name: &str| {
            [("CL_alpha", 5.0), ("Cm_alpha", -0.5), ("CY_beta", -0.8)]
                .into_iter()
                .find_map(|(known, value)| (known == name).then_some(value))
        };
        let model = ModelFile::named("hfb320").unwrap();
        let shift = |model: &ModelFile, name: &str| site.shift_of_truth(0.01, model, name, truth);
        assert_eq!((shift(&model, "Cm_alpha"), shift(&model, "CL_alpha")), (-0.05, 0.0));
        let mut tables = ModelFile::named("f16").unwrap();
        let before = tables.aircraft.cg.unwrap();
        site.put_in(0.01, &mut record(), &mut tables);
        assert!((before - tables.aircraft.cg.unwrap() - 0.01).abs() < 1e-15);
        assert_eq!(shift(&tables, "dCm_alpha"), 0.0);
    }
}
