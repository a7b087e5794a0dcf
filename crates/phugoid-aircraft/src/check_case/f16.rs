//! The F-16 of the check cases: aerodynamics, engine, inertia and control laws in DAVE-ML.

use std::path::Path;

use phugoid_flight_dynamics::globe::condition::{Condition, InitialRates, Launch, World};
use phugoid_flight_dynamics::globe::loads::{ForcesAndMoments, Loads};
use phugoid_flight_dynamics::globe::planet::Geodetic;
use phugoid_flight_dynamics::globe::steady::{NoTrim, solve, unsteadiness};
use phugoid_flight_dynamics::globe::vector::{Vector, cross};
use phugoid_flight_dynamics::mass::MassProperties;

use super::CheckCaseError;
use super::definition::Manoeuvre;
use super::trajectory::{FOOT, KNOT, POUND, SLUG};
use crate::daveml::{Evaluator, Model};

/// A model with the positions of what goes in and what comes out.
struct Part<const I: usize, const O: usize> {
    evaluator: Evaluator,
    inputs: [usize; I],
    outputs: [usize; O],
}

impl<const I: usize, const O: usize> Part<I, O> {
    fn open(folder: &Path, file: &str, inputs: [&str; I], outputs: [&str; O]) -> Result<Self, CheckCaseError> {
        let path = folder.join(file);
        let read = || {
            let model = Model::open(&path)?;
            let (mut from, mut to) = ([0; I], [0; O]);
            for (position, name) in from.iter_mut().zip(inputs) {
                *position = model.input_position(name)?;
            }
            for (position, name) in to.iter_mut().zip(outputs) {
                *position = model.position(name)?;
            }
            Ok(Self { evaluator: model.evaluator(), inputs: from, outputs: to })
        };
        read().map_err(|error: crate::daveml::DavemlError| CheckCaseError::Model { path, what: error.to_string() })
    }

    /// What comes out, in the units of the file.
    fn of(&mut self, values: [f64; I]) -> [f64; O] {
        for (position, value) in self.inputs.into_iter().zip(values) {
            self.evaluator.set(position, value);
        }
        self.evaluator.run();
        self.outputs.map(|position| self.evaluator.get(position))
    }
}

/// Signals that both control laws take.
const LAW: [&str; 19] = [
    "throttle",
    "longStk",
    "latStk",
    "pedal",
    "sasOn",
    "apOn",
    "keasCmd",
    "altCmd",
    "altMsl",
    "Vequiv",
    "alpha",
    "beta",
    "phi",
    "theta",
    "psi",
    "pb",
    "qb",
    "rb",
    "throttleTrim",
];
/// Elevator, aileron and rudder (deg), and lever (percent).
const DEFLECTIONS: [&str; 4] = ["el", "ail", "rdr", "PWR"];
/// Number of signals of a law with its own three.
const SIGNALS: usize = LAW.len() + 4;
const _: () = assert!(SIGNALS == 23);

/// What the autopilot is told.
#[derive(Clone, Copy, Debug, Default)]
struct Commands {
    /// Equivalent airspeed, kt.
    equivalent_airspeed: f64,
    /// Altitude, ft.
    altitude: f64,
    /// Course, deg.
    course: f64,
    /// Line to be followed: its distance to the right of the line through the start, m.
    sidestep: f64,
}

/// The F-16 with what it is told to do.
pub(super) struct F16 {
    aerodynamics: Part<9, 6>,
    engine: Part<3, 6>,
    law: Law,
    mass: MassProperties,
    /// Wing area (m^2), span and chord (m).
    reference: Vector,
    /// From the centre of gravity to the moment reference point, body axes, m.
    arm: Vector,
    manoeuvre: Manoeuvre,
    commands: Commands,
    commanded: bool,
    /// Trimmed throttle and longitudinal stick.
    trimmed: [f64; 2],
    /// Trimmed pitch angle, which is the angle of attack too, rad.
    trimmed_pitch: f64,
    start: Geodetic,
    /// Curvature radii at the start plus altitude, m.
    radii: [f64; 2],
    automatic: bool,
}

enum Law {
    /// `F16_control.dml`.
    Course(Box<Part<{ SIGNALS + 1 }, 4>>),
    /// `F16_gnc.dml`, which steers round a point.
    Circle(Box<Part<SIGNALS, 4>>),
}

impl F16 {
    /// Reads the models of a folder. The centre of gravity is at 25 percent of the mean aerodynamic chord.
    pub(super) fn read(folder: &Path, manoeuvre: &Manoeuvre) -> Result<Self, CheckCaseError> {
        let aerodynamics = Part::open(
            folder,
            "F16_aero.dml",
            ["vt", "alpha", "beta", "p", "q", "r", "el", "ail", "rdr"],
            ["cx", "cy", "cz", "cl", "cm", "cn"],
        )?;

        let [area, span, chord] = Part::open(folder, "F16_aero.dml", [], ["sref", "bspan", "cbar"])?.of([]);
        let engine =
            Part::open(folder, "F16_prop.dml", ["PWR", "ALT", "RMACH"], ["FEX", "FEY", "FEZ", "TEL", "TEM", "TEN"])?;
        let [mass, xx, yy, zz, zx, xy, yz, x, y, z] = Part::open(
            folder,
            "F16_inertia.dml",
            ["CG_PCT_MAC"],
            ["XMASS", "XIXX", "XIYY", "XIZZ", "XIZX", "XIXY", "XIYZ", "DXCG", "DYCG", "DZCG"],
        )?
        .of([25.0]);
        let tensor = [[xx, -xy, -zx], [-xy, yy, -yz], [-zx, -yz, zz]].map(|row| row.map(|j| j * SLUG * FOOT * FOOT));
        let mass = MassProperties::from_tensor(mass * SLUG, tensor, 0.0).ok_or_else(|| CheckCaseError::Model {
            path: folder.join("F16_inertia.dml"),
            what: "mass or inertia are impossible".to_owned(),
        })?;
        let with = |own: &[&'static str]| -> Vec<&'static str> { [&LAW[..], &["longStkTrim"], own].concat() };
        let law = match manoeuvre {
            Manoeuvre::Circle { .. } => {
                let mut names = [""; SIGNALS];
                names.copy_from_slice(&with(&["circlePoleSW", "ownshipN_deg", "ownshipE_deg"]));
                Law::Circle(Box::new(Part::open(folder, "F16_gnc.dml", names, DEFLECTIONS)?))
            }
            _ => {
                let mut names = [""; SIGNALS + 1];
                names.copy_from_slice(&with(&["latOffset", "baseChiCmd", "trimmedAlpha", "trimmedTheta"]));
                Law::Course(Box::new(Part::open(folder, "F16_control.dml", names, DEFLECTIONS)?))
            }
        };
        Ok(Self {
            aerodynamics,
            engine,
            law,
            mass,
            reference: [area * FOOT * FOOT, span * FOOT, chord * FOOT],
            arm: [-x * FOOT, -y * FOOT, -z * FOOT],
            manoeuvre: *manoeuvre,
            commands: Commands::default(),
            commanded: false,
            trimmed: [0.0; 2],
            trimmed_pitch: 0.0,
            start: Geodetic::default(),
            radii: [0.0; 2],
            automatic: false,
        })
    }

    /// Trims with throttle, longitudinal stick and pitch angle, wings level, for constant velocity over the ground, and
    /// gives the start with that pitch angle.
    ///
    /// The autopilot, which [`engage`](Self::engage) turns on, is told to hold what is found: altitude, course, and
    /// equivalent airspeed to the hundredth of a knot that the simulators were told (287.98 and 287.00).
    pub(super) fn trim(&mut self, world: &World, launch: Launch) -> Result<Launch, NoTrim> {
        let start = |pitch: f64| {
            let mut start = launch;
            (start.euler.pitch, start.euler.roll, start.rates) = (pitch, 0.0, InitialRates::Local([0.0; 3]));
            start
        };
        self.automatic = false;
        let [pitch, stick, throttle] = solve(
            |&[pitch, stick, throttle]: &[f64; 3]| {
                self.trimmed = [throttle, stick];
                let left = unsteadiness(world, self, &start(pitch), []);
                [left.along_right_down[0], left.along_right_down[2], left.angular_acceleration[1]]
            },
            [0.045, 0.13, 0.14],
            [1e-5, 1e-5, 1e-5],
            1e-11,
        )?;
        self.trimmed = [throttle, stick];
        self.trimmed_pitch = pitch;
        let launch = start(pitch);
        let condition = Condition::<0>::of(world, 0.0, &launch.state(&world.planet, 0.0, []));
        self.commands = Commands {
            equivalent_airspeed: (condition.equivalent_airspeed() / KNOT * 100.0).round() / 100.0,
            altitude: launch.place.altitude / FOOT,
            course: launch.velocity[1].atan2(launch.velocity[0]).to_degrees(),
            sidestep: 0.0,
        };
        self.start = launch.place;
        self.radii = world.planet.curvature_radii(launch.place.latitude).map(|radius| radius + launch.place.altitude);
        Ok(launch)
    }

    /// Turns on the autopilot if there is one in this case.
    ///
    /// Its control law holds deviations from a design point. Where a command follows straight flight, that is the trimmed
    /// flight, as in simulators 02 and 05, which begin without a transient; in the circles it is that of the file, as in
    /// simulators 04 and 05.
    pub(super) fn engage(&mut self) {
        self.automatic = self.manoeuvre != Manoeuvre::Free;
    }

    /// Distance to the right of the line of constant course through the start, m.
    fn deviation(&self, place: &Geodetic) -> f64 {
        let north = (place.latitude - self.start.latitude) * self.radii[0];
        let middle = 0.5 * (place.latitude + self.start.latitude);
        let east = (place.longitude - self.start.longitude) * self.radii[1] * middle.cos();
        let (s, c) = self.commands.course.to_radians().sin_cos();
        east * c - north * s
    }

    /// Elevator, aileron and rudder (deg), and lever (percent).
    fn deflections(&mut self, c: &Condition) -> [f64; 4] {
        let on = f64::from(self.automatic);
        let [p, q, r] = c.rates_to_earth;
        let common = [
            0.0,
            0.0,
            0.0,
            0.0,
            on,
            on,
            self.commands.equivalent_airspeed,
            self.commands.altitude,
            c.place.altitude / FOOT,
            c.equivalent_airspeed() / KNOT,
            c.air.alpha.to_degrees(),
            c.air.beta.to_degrees(),
            c.euler.roll.to_degrees(),
            c.euler.pitch.to_degrees(),
            c.euler.yaw.to_degrees(),
            p,
            q,
            r,
            self.trimmed[0],
            self.trimmed[1],
        ];
        let follows = matches!(self.manoeuvre, Manoeuvre::Command { sidestep: Some(_), .. });
        let offset = if follows { self.deviation(&c.place) - self.commands.sidestep } else { 0.0 };
        match &mut self.law {
            Law::Course(law) => {
                let mut all = [0.0; SIGNALS + 1];
                all[..common.len()].copy_from_slice(&common);
                let trimmed = self.trimmed_pitch.to_degrees();
                all[common.len()..].copy_from_slice(&[offset / FOOT, self.commands.course, trimmed, trimmed]);
                law.of(all)
            }
            Law::Circle(law) => {
                let pole = self.manoeuvre == Manoeuvre::Circle { pole: true };
                let place = [c.place.latitude.to_degrees(), c.place.longitude.to_degrees()];
                let mut all = [0.0; SIGNALS];
                all[..common.len()].copy_from_slice(&common);
                all[common.len()..].copy_from_slice(&[f64::from(pole), place[0], place[1]]);
                law.of(all)
            }
        }
    }
}

impl Loads for F16 {
    fn mass_properties(&mut self, _: &Condition) -> MassProperties {
        self.mass
    }

    fn loads(&mut self, c: &Condition) -> ForcesAndMoments {
        let [elevator, aileron, rudder, lever] = self.deflections(c);
        let [p, q, r] = c.rates_to_earth;
        let (alpha, beta) = (c.air.alpha.to_degrees(), c.air.beta.to_degrees());
        let [cx, cy, cz, cl, cm, cn] =
            self.aerodynamics.of([c.air.speed / FOOT, alpha, beta, p, q, r, elevator, aileron, rudder]);
        let [area, span, chord] = self.reference;
        let scale = c.air.dynamic_pressure * area;
        let force = [cx * scale, cy * scale, cz * scale];
        let about_reference = [cl * scale * span, cm * scale * chord, cn * scale * span];
        let lever_arm = cross(self.arm, force);
        let [fx, fy, fz, l, m, n] = self.engine.of([lever, c.place.altitude / FOOT, c.air.mach]);
        ForcesAndMoments {
            aerodynamic_force: force,
            aerodynamic_moment: std::array::from_fn(|i| about_reference[i] + lever_arm[i]),
            other_force: [fx * POUND, fy * POUND, fz * POUND],
            other_moment: [l, m, n].map(|moment| moment * POUND * FOOT),
        }
    }

    fn update(&mut self, c: &Condition) {
        if let Manoeuvre::Command { time, altitude, equivalent_airspeed, course, sidestep } = self.manoeuvre {
            // Steps end at multiples of their length but for rounding.
            if self.automatic && !self.commanded && c.time >= time - 1e-9 {
                self.commanded = true;
                self.commands.altitude += altitude / FOOT;
                self.commands.equivalent_airspeed += equivalent_airspeed / KNOT;
                self.commands.course += course.to_degrees();
                self.commands.sidestep += sidestep.unwrap_or(0.0);
            }
        }
    }
}
