//! An aircraft in DAVE-ML over a flat earth.

mod air;
mod basics;
mod feed;
mod forces;
mod notes;
mod wiring;

use std::path::{Path, PathBuf};

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{
    AirData, Aircraft as Flown, Coefficients, Controls, DataRange, Geometry, Propulsion,
};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use self::air::{VARIABLES, flow, flow_of_thrust};
use self::feed::{Feed, Flow};
use self::forces::{Outputs, ThrustOutputs};
use self::wiring::Wiring;
use super::error::FlownError;
use super::options::{FlownOptions, Thrust, check};
use super::pool::Pool;
use crate::daveml::{Evaluator, Model, UncertainElement};

/// Time constant of the thrust behind the throttle, s: an assumption, the same for every aircraft.
const ENGINE_LAG_S: f64 = 1.0;
/// Number with derivatives by all variables of the flight.
type Slopes = Dual<VARIABLES>;

/// An aircraft of one or more models in DAVE-ML that trim, linear models and simulation fly over a flat earth.
///
/// Variables are known by the standard names of ANSI/AIAA S-119, without regard to capitals, and converted by the units of the
/// files:
///
/// | what | names |
/// |---|---|
/// | flight | `trueAirspeed`, `equivalentAirspeed`, `mach`, `dynamicPressure`, `angleOfAttack`, `angleOfSideslip`, `angleOfAttackRate`, `bodyAngularRate_Roll`, `_Pitch`, `_Yaw`, `eulerAngle_Pitch`, `altitudeMsl`, `geometricAltitude`, `airDensity`, `ambientPressure`, `ambientTemperature`, `speedOfSound` |
/// | controls | `elevatorDeflection`, `aileronDeflection`, `rudderDeflection` (also `elevator`, `aileron`, `rudder`), `powerLeverAngle` (also `throttlePosition`, `pilotControl_throttle`) |
/// | coefficients | `aeroBodyForceCoefficient_X`, `_Y`, `_Z`, or `totalCoefficientOfLift` and `totalCoefficientOfDrag`, and `aeroBodyMomentCoefficient_Roll`, `_Pitch`, `_Yaw`, about the moment reference point |
/// | thrust | `thrustBodyForce_X`, `_Y`, `_Z`, `thrustBodyMoment_Roll`, `_Pitch`, `_Yaw`, about the centre of gravity |
/// | sizes, masses | `referenceWingArea`, `referenceWingSpan`, `referenceWingChord`, `totalMass`, `bodyMomentOfInertia_Roll`, `_Pitch`, `_Yaw`, `bodyProductOfInertia_XY`, `_YZ`, `_ZX`, `bodyPositionOfCmWrtMrc_X`, `_Y`, `_Z` |
///
/// An input is a number that was given ([`FlownOptions::properties`]), a control, a variable of another of the models with the
/// same name, a quantity of the flight, or what the file says, in this order. Sizes and masses that no model has can be given
/// in SI. Models may be named in any order.
///
/// Derivatives (of dual numbers) are exact, but for the attitude, the height and the rate of the angle of attack: the models
/// see the attitude of straight flight in the plane of symmetry (pitch angle equal to the angle of attack) and the height that
/// the density has in the standard atmosphere, and what depends on the rate of the angle of attack is taken to be linear in it
/// and to change with the speed alone, as `1/V`. What is not finite in gives what is not finite out.
///
/// Mass and inertia stay those of the beginning. Thrust follows the throttle with a lag of 1 s and sees axial flow; surfaces
/// follow their commands with a lag of 0.05 s, as far as the limits of their variables or tables go. It is `Send` and `Sync`:
/// threads evaluate side by side.
#[derive(Clone, Debug)]
pub struct FlownDaveml {
    file: PathBuf,
    wiring: Wiring,
    /// Sizes and masses that were given in SI.
    own: Vec<(String, f64)>,
    outputs: Outputs,
    thrust: Drive,
    geometry: Geometry,
    mass: MassProperties,
    gravity: f64,
    thrust_scale: f64,
    actuators: Actuators,
    surface_stops: [[f64; 2]; 3],
    data_range: DataRange,
    reads_alpha_rate: bool,
    name: String,
    notes: Vec<String>,
    plain: Pool<Vec<Evaluator>>,
    sloped: Pool<Vec<Evaluator<Slopes>>>,
}

/// The thrust as it is made.
#[derive(Clone, Debug)]
enum Drive {
    /// By the models.
    Models(Box<ThrustOutputs>),
    /// Along body x, N at full throttle.
    Force(f64),
}

impl FlownDaveml {
    /// Opens the aircraft of a file and of those that [`FlownOptions::with`] names.
    ///
    /// # Errors
    /// [`FlownError`]: a file that cannot be read, a variable without which there is no flight, an option that makes no sense.
    pub fn open_with(path: impl AsRef<Path>, options: &FlownOptions) -> Result<Self, FlownError> {
        let path = path.as_ref();
        let files: Vec<PathBuf> = std::iter::once(path.to_owned()).chain(options.with.iter().cloned()).collect();
        let models = files.iter().map(Model::open).collect::<Result<Vec<_>, _>>()?;
        let name = models.first().map(|model| model.header().name.trim().to_owned()).filter(|name| !name.is_empty());
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        Self::new(models, options, path, name.or(stem).unwrap_or_default())
    }

    fn new(models: Vec<Model>, options: &FlownOptions, file: &Path, name: String) -> Result<Self, FlownError> {
        check(options)?;
        let mut notes = Vec::new();
        let own = basics::given_in_si(&models, &options.properties)?;
        let wiring = Wiring::new(models, &options.properties, file, &mut notes)?;
        let outputs = Outputs::find(wiring.models(), file, &mut notes)?;
        let thrust_outputs = ThrustOutputs::find(wiring.models(), file)?;
        let basics = basics::Basics::find(&wiring, &own, file)?;
        let geometry = basics.geometry();
        let mass = MassProperties::from_tensor(basics.mass_kg, basics.tensor(), 0.0).ok_or_else(|| {
            let [[xx, ..], [_, yy, _], [.., zz]] = basics.tensor();
            let file = file.to_path_buf();
            FlownError::Mass { file, mass_kg: basics.mass_kg, inertia_kg_m2: [xx, yy, zz] }
        })?;
        let thrust = match (options.thrust, thrust_outputs) {
            (Thrust::Engines, Some(found)) => Drive::Models(Box::new(found)),
            (Thrust::AlongBodyX { largest_n }, _) => Drive::Force(largest_n),
            (Thrust::Engines, None) => Drive::Force(0.5 * mass.mass() * options.gravity),
        };
        notes::note_thrust(&thrust, options.thrust, &mut notes);
        let (actuators, surface_stops, data_range) = notes::surfaces(&wiring, &mut notes);
        let mut aircraft = Self {
            file: file.into(),
            own,
            outputs: outputs.moved_by(basics.arm_m),
            thrust,
            geometry,
            mass,
            gravity: options.gravity,
            thrust_scale: options.thrust_scale,
            actuators,
            surface_stops,
            data_range,
            reads_alpha_rate: false,
            name,
            notes,
            plain: Pool::default(),
            sloped: Pool::default(),
            wiring,
        };
        let (reads_alpha_rate, more) = notes::dependence(&aircraft);
        aircraft.reads_alpha_rate = reads_alpha_rate;
        aircraft.notes.extend(more);
        Ok(aircraft)
    }

    /// The name that the first file gives, or that of the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the files ask for and is left out, and what is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Everything that the files call uncertain (`uncertainty`), model by model in the order in which they are evaluated, with the
    /// place of the model.
    fn uncertain_elements(&self) -> Vec<(usize, UncertainElement)> {
        let models = self.wiring.models().iter().enumerate();
        models.flat_map(|(part, model)| model.uncertain_elements().into_iter().map(move |own| (part, own))).collect()
    }

    /// The names of all that the files call uncertain: variables and tables.
    pub fn uncertain(&self) -> Vec<String> {
        self.uncertain_elements().into_iter().map(|(_, element)| element.name).collect()
    }

    /// Correlation of each of [`uncertain`](Self::uncertain) with each ([`Model::correlation`]); those of different files have none.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        let all = self.uncertain_elements();
        let of = |(part, one): &(usize, UncertainElement), (other_part, other): &(usize, UncertainElement)| {
            if part == other_part { self.wiring.models()[*part].correlation(one, other) } else { 0.0 }
        };
        all.iter().map(|one| all.iter().map(|other| of(one, other)).collect()).collect()
    }

    /// The aircraft with one of [`uncertain`](Self::uncertain) moved by so many standard uncertainties ([`Model::moved`]); sizes,
    /// masses and inertia stay as they are written, because coefficients belong to sizes and mass is known by itself. The moment
    /// reference point moves where it is what is uncertain. `None` for a place beyond the last, where a bound does not belong to
    /// its table, and where the point is no number any more.
    pub fn moved(&self, uncertain: usize, by: f64) -> Option<Self> {
        let (part, element) = self.uncertain_elements().into_iter().nth(uncertain)?;
        let model = self.wiring.models()[part].moved(&element, by)?;
        let wiring = self.wiring.clone().with_model(part, model);
        let basics = basics::Basics::find(&wiring, &self.own, &self.file).ok()?;
        let outputs = self.outputs.clone().moved_by(basics.arm_m);
        let (plain, sloped) = (Pool::default(), Pool::default());
        Some(Self { wiring, outputs, plain, sloped, ..self.clone() })
    }

    /// Coefficients at plain variables, in the order of [`air::variables`].
    fn plain(&self, x: &[f64; VARIABLES]) -> [f64; 6] {
        self.plain_of(&flow(x, self.wiring.reads(Feed::Altitude)), x)
    }

    /// The same at quantities of a flight that need not belong together.
    fn plain_of(&self, flow: &Flow<f64>, x: &[f64; VARIABLES]) -> [f64; 6] {
        self.plain.lend(
            || self.wiring.evaluators(),
            |evaluators| {
                self.wiring.run(evaluators, flow, self.wiring.parts_of(self.outputs.all()));
                self.outputs.coefficients(evaluators, x[1], x[2], &self.geometry)
            },
        )
    }

    fn sloped(&self, x: &[f64; VARIABLES]) -> [Slopes; 6] {
        let x: [Slopes; VARIABLES] = std::array::from_fn(|i| Slopes::variable(x[i], i));
        let flow = flow(&x, self.wiring.reads(Feed::Altitude));
        self.sloped.lend(
            || self.wiring.evaluators(),
            |evaluators| {
                self.wiring.run(evaluators, &flow, self.wiring.parts_of(self.outputs.all()));
                self.outputs.coefficients(evaluators, x[1], x[2], &self.geometry)
            },
        )
    }
}

/// Values with derivatives by the variables, at variables that have derivatives of their own.
fn chained<T: Scalar>(values: [Slopes; 6], x: &[T]) -> [T; 6] {
    values.map(|value| {
        x.iter().zip(value.derivatives).fold(T::from(value.value), |sum, (x, slope)| {
            // A variable that does not enter must not bring its NaN or infinity with it.
            if slope == 0.0 { sum } else { sum + (*x - x.real()) * slope }
        })
    })
}

fn coefficients_of<T>([cx, cy, cz, cl, cm, cn]: [T; 6]) -> Coefficients<T> {
    Coefficients { cx, cy, cz, cl, cm, cn }
}

impl Flown for FlownDaveml {
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }

    fn gravity(&self) -> f64 {
        self.gravity
    }

    fn atmosphere(&self) -> Atmosphere {
        Atmosphere::Standard
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let x = air::variables(air, rates, controls);
        let real = x.map(Scalar::real);
        coefficients_of(if T::IS_REAL { self.plain(&real).map(T::from) } else { chained(self.sloped(&real), &x) })
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        if !self.reads_alpha_rate {
            return None;
        }
        let x = air::variables(air, rates, controls).map(Scalar::real);
        let slopes = self.sloped(&x).map(|value| value.derivatives[air::ALPHA_RATE]);
        let per_speed = T::from(air.speed.real()) / air.speed;
        Some(coefficients_of(slopes.map(|slope| per_speed * slope)))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let outputs = match &self.thrust {
            Drive::Models(outputs) => outputs,
            Drive::Force(largest) => {
                let zero = T::from(0.0);
                let force = power * (0.01 * largest * self.thrust_scale);
                return Propulsion { force: [force, zero, zero], moment: [zero; 3] };
            }
        };
        let parts = self.wiring.parts_of(outputs.all());
        let x = [power, altitude, mach];
        let values = if T::IS_REAL {
            let flow = flow_of_thrust(x.map(Scalar::real));
            let make = || self.wiring.evaluators();
            self.plain
                .lend(make, |evaluators| {
                    self.wiring.run(evaluators, &flow, parts);
                    outputs.values(evaluators)
                })
                .map(T::from)
        } else {
            let flow = flow_of_thrust(std::array::from_fn(|i| Slopes::variable(x[i].real(), i)));
            let make = || self.wiring.evaluators();
            let values = self.sloped.lend(make, |evaluators| {
                self.wiring.run(evaluators, &flow, parts);
                outputs.values(evaluators)
            });
            chained(values, &x)
        };
        let [fx, fy, fz, l, m, n] = values.map(|value| value * self.thrust_scale);
        Propulsion { force: [fx, fy, fz], moment: [l, m, n] }
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        (throttle * 100.0 - power) / ENGINE_LAG_S
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        throttle * 100.0
    }

    fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    fn surface_stops(&self) -> [[f64; 2]; 3] {
        self.surface_stops
    }

    fn data_range(&self) -> DataRange {
        self.data_range
    }
}
