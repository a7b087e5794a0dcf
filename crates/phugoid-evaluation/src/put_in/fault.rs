//! Physical errors of sensors, of the clock and of what is known of the aircraft, put into a healthy flight.

use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::{Rank, quantile};
use phugoid_identification::axes::Axes;
use phugoid_identification::model_file::{ModelFile, Thrust};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::channels::{constant, delay, each, values};

/// Kinds of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// The vane shows a multiple of the angle of attack (lateral flights: of the sideslip). Size: factor.
    VaneScale,
    /// The vane is off by a constant. Size: rad.
    VaneBias,
    /// The vane is late. Size: s.
    VaneDelay,
    /// The vane has coarse steps. Size: step, rad.
    VaneResolution,
    /// The vane reaches its stops. Size: part of its range that it can show.
    VaneSaturation,
    /// The vane sticks for a part of the flight. Size: that part.
    VaneSticks,
    /// The vane counts the other way. Size: -1.
    VaneSign,
    /// The vane is read in the wrong unit, degrees for radians. Size: factor.
    VaneUnit,
    /// The accelerometer along z (lateral: y) shows a multiple. Size: factor.
    AccelerationScale,
    /// It is off by a constant. Size: m/s^2.
    AccelerationBias,
    /// It counts the other way. Size: -1.
    AccelerationSign,
    /// It is read in the wrong unit, g for m/s^2. Size: factor.
    AccelerationUnit,
    /// The gyro of q (lateral: p) shows a multiple. Size: factor.
    RateScale,
    /// It counts the other way. Size: -1.
    RateSign,
    /// The airspeed is a multiple. Size: factor.
    AirspeedScale,
    /// The airspeed is late. Size: s.
    AirspeedDelay,
    /// The airspeed is read in the wrong unit, knots for m/s. Size: factor.
    AirspeedUnit,
    /// The elevator (lateral: aileron) is late. Size: s.
    SurfaceDelay,
    /// It shows a multiple. Size: factor.
    SurfaceScale,
    /// It counts the other way. Size: -1.
    SurfaceSign,
    /// It is read in the wrong unit, degrees for radians. Size: factor.
    SurfaceUnit,
    /// It sticks for a part of the flight. Size: that part.
    SurfaceSticks,
    /// The clock of the recorder runs fast or slow. Size: factor on the times.
    Clock,
    /// The model file's mass is wrong. Size: factor.
    Mass,
    /// The model file's moments of inertia are wrong. Size: factor.
    Inertia,
    /// The thrust is wrong, as from pounds for newtons. Size: factor.
    Thrust,
}

impl Fault {
    /// All kinds.
    pub const ALL: [Self; 26] = [
        Self::VaneScale,
        Self::VaneBias,
        Self::VaneDelay,
        Self::VaneResolution,
        Self::VaneSaturation,
        Self::VaneSticks,
        Self::VaneSign,
        Self::VaneUnit,
        Self::AccelerationScale,
        Self::AccelerationBias,
        Self::AccelerationSign,
        Self::AccelerationUnit,
        Self::RateScale,
        Self::RateSign,
        Self::AirspeedScale,
        Self::AirspeedDelay,
        Self::AirspeedUnit,
        Self::SurfaceDelay,
        Self::SurfaceScale,
        Self::SurfaceSign,
        Self::SurfaceUnit,
        Self::SurfaceSticks,
        Self::Clock,
        Self::Mass,
        Self::Inertia,
        Self::Thrust,
    ];

    /// The words of tables.
    pub const fn words(self) -> &'static str {
        match self {
            Self::VaneScale => "vane scale",
            Self::VaneBias => "vane bias",
            Self::VaneDelay => "vane delay",
            Self::VaneResolution => "vane resolution",
            Self::VaneSaturation => "vane saturation",
            Self::VaneSticks => "vane sticks",
            Self::VaneSign => "vane sign",
            Self::VaneUnit => "vane unit",
            Self::AccelerationScale => "acceleration scale",
            Self::AccelerationBias => "acceleration bias",
            Self::AccelerationSign => "acceleration sign",
            Self::AccelerationUnit => "acceleration unit",
            Self::RateScale => "rate scale",
            Self::RateSign => "rate sign",
            Self::AirspeedScale => "airspeed scale",
            Self::AirspeedDelay => "airspeed delay",
            Self::AirspeedUnit => "airspeed unit",
            Self::SurfaceDelay => "surface delay",
            Self::SurfaceScale => "surface scale",
            Self::SurfaceSign => "surface sign",
            Self::SurfaceUnit => "surface unit",
            Self::SurfaceSticks => "surface sticks",
            Self::Clock => "clock",
            Self::Mass => "mass",
            Self::Inertia => "inertia",
            Self::Thrust => "thrust",
        }
    }

    /// A size of this kind of error, as flight tests have met it, from a random source.
    fn size(self, random: &mut Pcg64Mcg) -> f64 {
        let mut uniform = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        // A factor between the two, by its logarithm, or its inverse.
        let mut factor = |low: f64, high: f64| {
            let value = uniform(low.ln(), high.ln()).exp();
            if uniform(-1.0, 1.0) < 0.0 { 1.0 / value } else { value }
        };
        match self {
            Self::VaneScale | Self::AccelerationScale | Self::RateScale | Self::SurfaceScale => factor(1.03, 1.3),
            Self::AirspeedScale => factor(1.02, 1.15),
            Self::Mass => factor(1.03, 2.3),
            Self::Inertia => factor(1.1, 10.0),
            Self::Clock => factor(1.01, 1.1),
            Self::Thrust => factor(1.1, 4.5),
            Self::VaneUnit | Self::SurfaceUnit => {
                if uniform(-1.0, 1.0) < 0.0 {
                    1.0_f64.to_radians()
                } else {
                    1.0_f64.to_degrees()
                }
            }
            Self::AccelerationUnit => 1.0 / 9.806_65,
            Self::AirspeedUnit => 3600.0 / 1852.0,
            Self::VaneSign | Self::AccelerationSign | Self::RateSign | Self::SurfaceSign => -1.0,
            Self::VaneBias => uniform(0.3, 3.0).to_radians() * uniform(-1.0, 1.0).signum(),
            Self::AccelerationBias => uniform(0.1, 2.0) * uniform(-1.0, 1.0).signum(),
            Self::VaneDelay | Self::SurfaceDelay => uniform(0.02, 0.3),
            Self::AirspeedDelay => uniform(0.1, 1.0),
            Self::VaneResolution => uniform(0.2, 2.0).to_radians(),
            Self::VaneSaturation => uniform(0.4, 0.9),
            Self::VaneSticks | Self::SurfaceSticks => uniform(0.2, 0.8),
        }
    }
}

/// One error of one size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Corruption {
    /// What is wrong.
    pub fault: Fault,
    /// How much, as [`Fault`] says.
    pub size: f64,
}

impl Corruption {
    /// The error of number `index`: the kinds in turn, with sizes from the number.
    pub fn draw(index: usize) -> Self {
        // Numbers of their own, apart from those of other studies.
        let mut random = Pcg64Mcg::seed_from_u64(0x6669_656c_6400 + index as u64);
        let fault = Fault::ALL[index % Fault::ALL.len()];
        Self { fault, size: fault.size(&mut random) }
    }

    /// Puts the error into a flight and its model file. A flight without the channel stays as it is.
    pub fn apply(&self, record: &mut Record, model: &mut ModelFile) {
        let lateral = model.axes == Axes::LateralDirectional;
        let (vane, acceleration, rate, surface) =
            if lateral { ("beta", "ay", "p", "aileron") } else { ("alpha", "az", "q", "elevator") };
        let size = self.size;
        match self.fault {
            Fault::VaneScale | Fault::VaneSign | Fault::VaneUnit => scale(record, vane, size),
            Fault::VaneBias => shift(record, vane, size),
            Fault::VaneDelay => delay(record, vane, size),
            Fault::VaneResolution => each(record, vane, |v| (v / size).round() * size),
            Fault::VaneSaturation => saturate(record, vane, size),
            Fault::VaneSticks => stick(record, vane, size),
            Fault::AccelerationScale | Fault::AccelerationSign | Fault::AccelerationUnit => {
                scale(record, acceleration, size);
            }
            Fault::AccelerationBias => shift(record, acceleration, size),
            Fault::RateScale | Fault::RateSign => scale(record, rate, size),
            Fault::AirspeedScale | Fault::AirspeedUnit => scale(record, "true_airspeed", size),
            Fault::AirspeedDelay => delay(record, "true_airspeed", size),
            Fault::SurfaceDelay => delay(record, surface, size),
            Fault::SurfaceScale | Fault::SurfaceSign | Fault::SurfaceUnit => scale(record, surface, size),
            Fault::SurfaceSticks => stick(record, surface, size),
            Fault::Clock => {
                let first = record.time.first().copied().unwrap_or_default();
                record.time.iter_mut().for_each(|t| *t = first + (*t - first) * size);
            }
            Fault::Mass => constant(&mut model.aircraft.mass, size),
            Fault::Inertia => {
                let aircraft = &mut model.aircraft;
                constant(&mut aircraft.iyy, size);
                [&mut aircraft.ixx, &mut aircraft.izz, &mut aircraft.ixz]
                    .into_iter()
                    .flatten()
                    .for_each(|i| constant(i, size));
            }
            Fault::Thrust => {
                scale(record, "thrust", size);
                if let Thrust::Known(source) = &mut model.aircraft.thrust {
                    constant(source, size);
                }
            }
        }
    }
}

/// A number below `count`, for the flight that the error of number `index` goes into.
pub(crate) fn draw_below(index: usize, count: usize) -> usize {
    Pcg64Mcg::seed_from_u64(0x666c_6967_6874 + index as u64).random_range(0..count)
}

fn scale(record: &mut Record, name: &str, factor: f64) {
    each(record, name, |v| v * factor);
}

fn shift(record: &mut Record, name: &str, by: f64) {
    each(record, name, |v| v + by);
}

/// Shows only the middle `part` of the range between the first and the last percentile.
fn saturate(record: &mut Record, name: &str, part: f64) {
    let mut finite: Vec<f64> = values(record, name).iter().copied().filter(|v| v.is_finite()).collect();
    let ends = [0.01, 0.99].map(|q| quantile(&mut finite, q, Rank::InverseDistribution));
    if let [Some(low), Some(high)] = ends {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * part);
        each(record, name, |v| v.clamp(middle - half, middle + half));
    }
}

/// Holds the value from the middle of the record less half of `part` of its samples on, for that part.
fn stick(record: &mut Record, name: &str, part: f64) {
    let values = values(record, name);
    let count = (values.len() as f64 * part) as usize;
    let from = (values.len() - count) / 2;
    if let Some(held) = values.get(from).copied() {
        values[from..from + count].iter_mut().filter(|v| v.is_finite()).for_each(|v| *v = held);
    }
}

#[cfg(test)]
mod tests {
    use phugoid_identification::model_file::Source;

    use super::*;

    fn record(values: Vec<f64>) -> Record {
        let time: Vec<f64> = (0..values.len()).map(|k| 0.1 * k as f64).collect();
        Record::from_columns("test", [("time_s", time), ("alpha_rad", values.clone()), ("elevator_rad", values)])
            .unwrap()
    }

    fn model() -> ModelFile {
        ModelFile::named("hfb320").unwrap()
    }

    fn corrupted(fault: Fault, size: f64, values: Vec<f64>) -> Vec<f64> {
        let (mut record, mut model) = (record(values), model());
        Corruption { fault, size }.apply(&mut record, &mut model);
        record.channel("alpha").unwrap().values.clone()
    }

    #[test]
    fn a_late_vane_shows_what_was_true_before() {
        let ramp: Vec<f64> = (0..6).map(f64::from).collect();
        let late = corrupted(Fault::VaneDelay, 0.15, ramp);
        for (found, expected) in late.iter().zip([0.0, 0.0, 0.5, 1.5, 2.5, 3.5]) {
            assert!((found - expected).abs() < 1e-9, "{late:?}");
        }
    }

    #[test]
    fn missing_values_stay_missing() {
        let late = corrupted(Fault::VaneDelay, 0.1, vec![0.0, 1.0, f64::NAN, 3.0, 4.0]);
        assert!(late[2].is_nan() && (late[3] - 2.0).abs() < 1e-9, "{late:?}");
        let stuck = corrupted(Fault::VaneSticks, 0.6, vec![0.0, 1.0, f64::NAN, 3.0, 4.0]);
        assert!(stuck[1] == 1.0 && stuck[2].is_nan() && stuck[3] == 1.0 && stuck[4] == 4.0, "{stuck:?}");
    }

    #[test]
    fn stops_and_steps_are_those_of_the_size() {
        let ramp: Vec<f64> = (0..=100).map(f64::from).collect();
        let clipped = corrupted(Fault::VaneSaturation, 0.5, ramp.clone());
        let (low, high) = clipped.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!((high - low - 49.0).abs() < 1.1, "{low} {high}");
        assert!(corrupted(Fault::VaneResolution, 2.0, ramp).iter().all(|v| v % 2.0 == 0.0));
    }

    #[test]
    fn the_clock_keeps_its_start_and_the_model_its_other_numbers() {
        let (mut shown, mut changed) = (record(vec![0.0; 5]), model());
        shown.time.iter_mut().for_each(|t| *t += 100.0);
        Corruption { fault: Fault::Clock, size: 1.1 }.apply(&mut shown, &mut changed);
        assert!((shown.time[0] - 100.0).abs() < 1e-12 && (shown.time[4] - 100.44).abs() < 1e-9);
        assert_eq!(changed, model());
        Corruption { fault: Fault::Mass, size: 2.0 }.apply(&mut shown, &mut changed);
        let mass = |file: &ModelFile| match file.aircraft.mass {
            Source::Constant(value) => value,
            Source::Channel(_) => f64::NAN,
        };
        assert_eq!(mass(&changed), 2.0 * mass(&model()));
        assert_eq!(changed.aircraft.iyy, model().aircraft.iyy);
    }

    #[test]
    fn every_kind_meets_every_flight() {
        let kinds = Fault::ALL.len();
        for flights in [3, 7, kinds] {
            let mut met: Vec<(usize, usize)> = (0..2000 * kinds).map(|k| (k % kinds, draw_below(k, flights))).collect();
            met.sort_unstable();
            met.dedup();
            assert_eq!(met.len(), kinds * flights);
        }
    }

    #[test]
    fn draws_are_the_same_every_time_and_go_through_all_kinds() {
        let drawn: Vec<Corruption> = (0..Fault::ALL.len()).map(Corruption::draw).collect();
        assert!(drawn.iter().zip(Fault::ALL).all(|(c, fault)| c.fault == fault && c.size.is_finite()));
        assert_eq!(Corruption::draw(40), Corruption::draw(40));
        assert_ne!(Corruption::draw(0).size, Corruption::draw(Fault::ALL.len()).size);
        // No draw leaves the flight as it is.
        assert!((0..520).map(Corruption::draw).all(|c| c.size != 1.0 && c.size != 0.0));
    }
}
