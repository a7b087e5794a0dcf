//! The F-16 of the check cases: aerodynamics, engine, inertia and control laws in DAVE-ML.

use std::path::Path;

use phugoid_flight_dynamics::globe::condition::{Condition, InitialRates, Launch, World};
use phugoid_flight_dynamics::globe::loads::{ForcesAndMoments, Loads};
use phugoid_flight_dynamics::globe::planet::Geodetic;
use phugoid_flight_dynamics::globe::steady::{NoTrim, solve, unsteadiness};
use phugoid_flight_dynamics::mass::MassProperties;

use super::CheckCaseError;
use super::definition::Manoeuvre;
use super::trajectory::{FOOT, KNOT};
use crate::daveml::Model;
use crate::vehicle::DavemlVehicle;

/// Inputs of the models that are no quantities of the flight, and what they begin with. The pilot's controls stay there.
const GIVEN: [(&str, f64); 11] = [
    ("pilotControl_throttle", 0.0),
    ("pilotControl_long", 0.0),
    ("pilotControl_lat", 0.0),
    ("pilotControl_yaw", 0.0),
    (AUGMENTATION, 0.0),
    (AUTOPILOT, 0.0),
    (AIRSPEED, 0.0),
    (ALTITUDE, 0.0),
    (THROTTLE, 0.0),
    (STICK, 0.0),
    // Percent of the mean aerodynamic chord.
    ("vrsPositionOfCM", 25.0),
];
const AUGMENTATION: &str = "stabilityAugmentationOn_disc";
const AUTOPILOT: &str = "autopilotOn_disc";
const AIRSPEED: &str = "equivalentAirspeedCommand";
const ALTITUDE: &str = "altitudeMslCommand";
const THROTTLE: &str = "trimmedPilotControl_throttle";
const STICK: &str = "trimmedPilotControl_long";
const COURSE: &str = "trueBaseCourseCommand";
const DEVIATION: &str = "lateralDeviationError";
const CIRCLE: &str = "selectCircumnavigator_disc";
/// Angles from which the control law counts.
const DESIGN: [&str; 2] = ["designAngleOfAttack", "designEulerAngle_Pitch"];

/// What the autopilot is told, in the units of the models.
#[derive(Clone, Copy, Debug, Default)]
struct Commands {
    /// Equivalent airspeed, kt.
    equivalent_airspeed: f64,
    /// Altitude, ft.
    altitude: f64,
    /// Course, deg.
    course: f64,
    /// Distance of the line to be followed to the right of the one through the start, ft.
    sidestep: f64,
}

/// The F-16 with what it is told to do.
pub(super) struct F16 {
    vehicle: DavemlVehicle,
    manoeuvre: Manoeuvre,
    commands: Commands,
    commanded: bool,
    automatic: bool,
    start: Geodetic,
    /// Radii of curvature at the start, along the meridian and across it, plus the altitude, m.
    radii: [f64; 2],
}

impl F16 {
    /// Reads the models of a folder. The centre of gravity is at 25 percent of the mean aerodynamic chord.
    pub(super) fn read(folder: &Path, manoeuvre: &Manoeuvre) -> Result<Self, CheckCaseError> {
        let mut given = GIVEN.to_vec();
        let law = match manoeuvre {
            Manoeuvre::Circle { pole } => {
                given.push((CIRCLE, f64::from(*pole)));
                "F16_gnc.dml"
            }
            _ => {
                given.extend([COURSE, DEVIATION, DESIGN[0], DESIGN[1]].map(|name| (name, 0.0)));
                "F16_control.dml"
            }
        };
        let open = |file: &str| {
            let path = folder.join(file);
            Model::open(&path).map_err(|error| CheckCaseError::Model { path, what: error.to_string() })
        };
        let models = [open(law)?, open("F16_aero.dml")?, open("F16_prop.dml")?, open("F16_inertia.dml")?];
        let vehicle = DavemlVehicle::new(&models, &given)
            .map_err(|error| CheckCaseError::Model { path: folder.to_owned(), what: error.to_string() })?;
        Ok(Self {
            vehicle,
            manoeuvre: *manoeuvre,
            commands: Commands::default(),
            commanded: false,
            automatic: false,
            start: Geodetic::default(),
            radii: [0.0; 2],
        })
    }

    /// Trims with throttle, longitudinal stick and pitch angle, wings level, for constant velocity over the ground, and
    /// gives the start with that pitch angle.
    ///
    /// The autopilot, which [`engage`](Self::engage) turns on, is told to hold what is found: altitude, course, and
    /// equivalent airspeed to the hundredth of a knot that the simulators were told (287.98 and 287.00). Its control law
    /// holds deviations from a design point. Where a command follows straight flight, that is the trimmed flight, as in
    /// simulators 02 and 05, which begin without a transient; in the circles it is that of the file, as in simulators 04
    /// and 05.
    pub(super) fn trim(&mut self, world: &World, launch: Launch) -> Result<Launch, NoTrim> {
        let start = |pitch: f64| {
            let mut start = launch;
            (start.euler.pitch, start.euler.roll, start.rates) = (pitch, 0.0, InitialRates::Local([0.0; 3]));
            start
        };
        let mut vehicle = self.vehicle.clone();
        let [pitch, stick, throttle] = solve(
            |&[pitch, stick, throttle]: &[f64; 3]| {
                vehicle.set(STICK, stick);
                vehicle.set(THROTTLE, throttle);
                let left = unsteadiness(world, &mut vehicle, &start(pitch), []);
                [left.along_right_down[0], left.along_right_down[2], left.angular_acceleration[1]]
            },
            [0.045, 0.13, 0.14],
            [1e-5, 1e-5, 1e-5],
            1e-11,
        )?;
        self.vehicle.set(STICK, stick);
        self.vehicle.set(THROTTLE, throttle);
        let launch = start(pitch);
        let condition = Condition::<0>::of(world, 0.0, &launch.state(&world.planet, 0.0, []));
        self.commands = Commands {
            equivalent_airspeed: (condition.equivalent_airspeed() / KNOT * 100.0).round() / 100.0,
            altitude: launch.place.altitude / FOOT,
            course: launch.velocity[1].atan2(launch.velocity[0]).to_degrees(),
            sidestep: 0.0,
        };
        for name in DESIGN {
            // In a circle the models have no such input: the law keeps that of the file.
            self.vehicle.set(name, pitch.to_degrees());
        }
        self.start = launch.place;
        self.radii = world.planet.curvature_radii(launch.place.latitude).map(|radius| radius + launch.place.altitude);
        Ok(launch)
    }

    /// Turns on the autopilot if there is one in this case.
    pub(super) fn engage(&mut self) {
        self.automatic = self.manoeuvre != Manoeuvre::Free;
        self.vehicle.set(AUGMENTATION, f64::from(self.automatic));
        self.vehicle.set(AUTOPILOT, f64::from(self.automatic));
        self.tell();
    }

    /// Passes the commands on.
    fn tell(&mut self) {
        self.vehicle.set(AIRSPEED, self.commands.equivalent_airspeed);
        self.vehicle.set(ALTITUDE, self.commands.altitude);
        self.vehicle.set(COURSE, self.commands.course);
    }

    /// Distance to the right of the line of constant course through the start, ft.
    fn deviation(&self, place: &Geodetic) -> f64 {
        let north = (place.latitude - self.start.latitude) * self.radii[0];
        let middle = 0.5 * (place.latitude + self.start.latitude);
        let east = (place.longitude - self.start.longitude) * self.radii[1] * middle.cos();
        let (s, c) = self.commands.course.to_radians().sin_cos();
        (east * c - north * s) / FOOT
    }
}

impl Loads for F16 {
    fn mass_properties(&mut self, condition: &Condition) -> MassProperties {
        self.vehicle.mass_properties(condition)
    }

    fn loads(&mut self, condition: &Condition) -> ForcesAndMoments {
        if matches!(self.manoeuvre, Manoeuvre::Command { sidestep: Some(_), .. }) {
            let offset = self.deviation(&condition.place) - self.commands.sidestep;
            self.vehicle.set(DEVIATION, offset);
        }
        self.vehicle.loads(condition)
    }

    fn update(&mut self, c: &Condition) {
        if let Manoeuvre::Command { time, altitude, equivalent_airspeed, course, sidestep } = self.manoeuvre {
            // Steps end at multiples of their length but for rounding.
            if self.automatic && !self.commanded && c.time >= time - 1e-9 {
                self.commanded = true;
                self.commands.altitude += altitude / FOOT;
                self.commands.equivalent_airspeed += equivalent_airspeed / KNOT;
                self.commands.course += course.to_degrees();
                self.commands.sidestep += sidestep.unwrap_or(0.0) / FOOT;
                self.tell();
            }
        }
    }
}
