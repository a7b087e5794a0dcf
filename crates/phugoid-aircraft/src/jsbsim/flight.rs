//! What is known of the flight at one moment, and the properties of JSBSim that follow from it.

use phugoid_flight_dynamics::atmosphere::Air;
use phugoid_flight_dynamics::scalar::Scalar;

use super::mass::{Metrics, arm_ft};
use super::model::{Model, State};
use super::units::{FOOT, KNOT, PSF, SLUG_FT3};

/// Motion through the air, and the air itself. Body axes: x forward, y right, z down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightCondition {
    /// True airspeed, m/s.
    pub airspeed_m_s: f64,
    /// Angle of attack, rad.
    pub alpha_rad: f64,
    /// Angle of sideslip, rad; positive with the wind from the right.
    pub beta_rad: f64,
    /// Rate of the angle of attack, rad/s.
    pub alphadot_rad_s: f64,
    /// Rate of the angle of sideslip, rad/s.
    pub betadot_rad_s: f64,
    /// Roll, pitch and yaw rate against the air in body axes, rad/s.
    pub rates_rad_s: [f64; 3],
    /// Bank, pitch and heading angle, rad.
    pub attitude_rad: [f64; 3],
    /// Height above the sea, m.
    pub height_m: f64,
    /// Height above the ground, m.
    pub height_above_ground_m: f64,
    /// Density of the air, kg/m3.
    pub density_kg_m3: f64,
    /// Pressure of the air, Pa.
    pub pressure_pa: f64,
    /// Temperature of the air, K.
    pub temperature_k: f64,
    /// Speed of sound, m/s.
    pub sound_speed_m_s: f64,
}

impl FlightCondition {
    /// Flow along body x at a true airspeed (m/s), level and without rotation, at a height above the sea (m), over ground at its
    /// level, in this air.
    pub fn axial(airspeed_m_s: f64, height_m: f64, air: &Air) -> Self {
        Self {
            airspeed_m_s,
            alpha_rad: 0.0,
            beta_rad: 0.0,
            alphadot_rad_s: 0.0,
            betadot_rad_s: 0.0,
            rates_rad_s: [0.0; 3],
            attitude_rad: [0.0; 3],
            height_m,
            height_above_ground_m: height_m,
            density_kg_m3: air.density,
            pressure_pa: air.pressure,
            temperature_k: air.temperature,
            sound_speed_m_s: air.speed_of_sound,
        }
    }

    /// Dynamic pressure, Pa.
    pub fn dynamic_pressure_pa(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.airspeed_m_s * self.airspeed_m_s
    }

    /// Mach number; 0 without a speed of sound.
    pub fn mach(&self) -> f64 {
        if self.sound_speed_m_s > 0.0 { self.airspeed_m_s / self.sound_speed_m_s } else { 0.0 }
    }
}

/// Indices of the properties that a flight condition sets, in the order of [`NAMES`].
#[derive(Debug, Clone)]
pub(super) struct FlightProperties(Vec<usize>);

/// Names of the properties that a flight condition sets.
#[rustfmt::skip]
const NAMES: [&str; 81] = [
    "velocities/vt-fps", "velocities/mach", "velocities/machU", "velocities/vc-kts", "velocities/vc-fps",
    "velocities/ve-kts", "velocities/ve-fps", "velocities/vtrue-kts", "velocities/vtrue-fps",
    "velocities/u-fps", "velocities/v-fps", "velocities/w-fps",
    "velocities/u-aero-fps", "velocities/v-aero-fps", "velocities/w-aero-fps",
    "velocities/p-aero-rad_sec", "velocities/q-aero-rad_sec", "velocities/r-aero-rad_sec",
    "velocities/p-rad_sec", "velocities/q-rad_sec", "velocities/r-rad_sec",
    "velocities/pi-rad_sec", "velocities/qi-rad_sec", "velocities/ri-rad_sec",
    "velocities/phidot-rad_sec", "velocities/thetadot-rad_sec", "velocities/psidot-rad_sec",
    "velocities/v-north-fps", "velocities/v-east-fps", "velocities/v-down-fps", "velocities/h-dot-fps",
    "velocities/vg-fps",
    "aero/alpha-rad", "aero/alpha-deg", "aero/beta-rad", "aero/beta-deg", "aero/mag-beta-rad", "aero/mag-beta-deg",
    "aero/alphadot-rad_sec", "aero/alphadot-deg_sec", "aero/betadot-rad_sec", "aero/betadot-deg_sec",
    "aero/qbar-psf", "aero/qbarUW-psf", "aero/qbarUV-psf", "aero/Re", "aero/alpha-wing-rad",
    "aero/bi2vel", "aero/ci2vel", "aero/qbar-area", "aero/h_b-mac-ft", "aero/h_b-cg-ft",
    "atmosphere/rho-slugs_ft3", "atmosphere/P-psf", "atmosphere/T-R", "atmosphere/a-fps",
    "atmosphere/sigma", "atmosphere/delta", "atmosphere/theta", "atmosphere/density-altitude",
    "position/h-sl-ft", "position/h-sl-meters", "position/h-agl-ft", "position/h-agl-km",
    "attitude/phi-rad", "attitude/theta-rad", "attitude/psi-rad", "attitude/roll-rad", "attitude/pitch-rad",
    "attitude/heading-true-rad", "attitude/phi-deg", "attitude/theta-deg", "attitude/psi-deg",
    "flight-path/gamma-rad", "atmosphere/pressure-altitude", "atmosphere/a-ratio", "flight-path/gamma-deg",
    "velocities/ned-velocity-mag-fps", "propulsion/tat-r", "propulsion/tat-c", "propulsion/pt-lbs_sqft",
];

/// What some of the properties follow from and takes some computing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Components of the velocity.
    velocity: bool,
    /// Sine and cosine of the attitude.
    attitude: bool,
    /// Heights above the sea or the ground.
    pub(super) height: bool,
}

impl Wanted {
    /// All of it.
    const ALL: Self = Self { velocity: true, attitude: true, height: true };

    /// Adds that of the property of a name.
    fn add(&mut self, name: &str) {
        match name {
            "aero/h_b-cg-ft" => self.height = true,
            "aero/h_b-mac-ft" => (self.height, self.attitude) = (true, true),
            "velocities/machU" | "aero/qbarUW-psf" | "aero/qbarUV-psf" => self.velocity = true,
            _ if name.starts_with("position/") => self.height = true,
            _ if name.starts_with("aero/") => {}
            _ if ["/u-", "/v-fps", "/v-aero-", "/w-"].iter().any(|part| name.contains(part)) => self.velocity = true,
            _ if ["dot-rad_sec", "/v-", "/h-dot", "/vg-", "flight-path/"].iter().any(|part| name.contains(part)) => {
                (self.velocity, self.attitude) = (true, true);
            }
            _ => {}
        }
    }
}

impl FlightProperties {
    /// Makes the properties.
    pub(super) fn new(model: &mut Model) -> Self {
        let made = NAMES.iter().map(|name| {
            let index = model.property(name);
            model.properties[index].declared = true;
            index
        });
        Self(made.collect())
    }

    /// Whether a property is set by a flight condition.
    pub(super) fn contain(&self, index: usize) -> bool {
        self.0.contains(&index)
    }

    /// Place of a property among them.
    pub(super) fn place(&self, index: usize) -> Option<usize> {
        self.0.iter().position(|&own| own == index)
    }

    /// The properties in the order of [`NAMES`].
    pub(super) fn indices(&self) -> &[usize] {
        &self.0
    }

    /// What is to be computed for some of them, by their place in this order.
    pub(super) fn wanted(places: impl Iterator<Item = usize>) -> Wanted {
        let mut wanted = Wanted { velocity: false, attitude: false, height: false };
        places.for_each(|place| wanted.add(NAMES[place]));
        wanted
    }

    /// Sets the properties.
    pub(super) fn set(
        &self,
        model: &Model,
        state: &mut State,
        flight: &FlightCondition,
        metrics: &Metrics,
        centre_in: [f64; 3],
    ) {
        let known = Known::new(flight, metrics, centre_in, &Wanted::ALL);
        for (place, &index) in self.0.iter().enumerate() {
            state.write(model, index, known.value(place));
        }
    }
}

/// What is known of a flight condition, in feet and slugs.
#[derive(Debug)]
pub(super) struct Known<'a> {
    flight: &'a FlightCondition,
    metrics: &'a Metrics,
    centre_in: [f64; 3],
    speed: f64,
    sound: f64,
    square: f64,
    /// Velocity in body axes.
    velocity: [f64; 3],
    /// Sine and cosine of bank, pitch and heading angle.
    attitude: [(f64, f64); 3],
}

impl<'a> Known<'a> {
    /// Where something is not wanted, the properties that follow from it mean nothing.
    #[inline]
    pub(super) fn new(flight: &'a FlightCondition, metrics: &'a Metrics, centre_in: [f64; 3], wanted: &Wanted) -> Self {
        let speed = flight.airspeed_m_s / FOOT;
        let velocity = if wanted.velocity {
            let ((sa, ca), (sb, cb)) = (Scalar::sin_cos(flight.alpha_rad), Scalar::sin_cos(flight.beta_rad));
            [speed * ca * cb, speed * sb, speed * sa * cb]
        } else {
            [0.0; 3]
        };
        let attitude = if wanted.attitude { flight.attitude_rad.map(Scalar::sin_cos) } else { [(0.0, 1.0); 3] };
        let sound = flight.sound_speed_m_s / FOOT;
        let square = 0.5 * (flight.density_kg_m3 / SLUG_FT3);
        Self { flight, metrics, centre_in, speed, sound, square, velocity, attitude }
    }

    /// Dynamic pressure, pounds per square foot.
    #[inline]
    pub(super) fn qbar(&self) -> f64 {
        self.square * self.speed * self.speed
    }

    /// Velocity over the ground where the air is still: north, east and down.
    fn over_ground(&self) -> [f64; 3] {
        let [u, v, w] = self.velocity;
        let [(sphi, cphi), (stheta, ctheta), (spsi, cpsi)] = self.attitude;
        let (forward, side) = (u * ctheta + (v * sphi + w * cphi) * stheta, v * cphi - w * sphi);
        let down = -u * stheta + (v * sphi + w * cphi) * ctheta;
        [forward * cpsi - side * spsi, forward * spsi + side * cpsi, down]
    }

    /// Rate of the heading angle.
    fn turning(&self) -> f64 {
        let [_, q, r] = self.flight.rates_rad_s;
        let [(sphi, cphi), (_, ctheta), _] = self.attitude;
        if ctheta == 0.0 { 0.0 } else { (q * sphi + r * cphi) / ctheta }
    }

    /// The value of the property at a place of [`NAMES`]. Kept out of loops, in which all values would be computed each time.
    #[inline(never)]
    pub(super) fn value(&self, place: usize) -> f64 {
        let Self { flight, metrics, .. } = self;
        match place {
            0 | 8 => self.speed,
            1 => flight.mach(),
            2 => ratio(self.velocity[0], self.sound),
            7 => flight.airspeed_m_s / KNOT,
            9 | 12 => self.velocity[0],
            10 | 13 => self.velocity[1],
            11 | 14 => self.velocity[2],
            15 | 18 | 21 => flight.rates_rad_s[0],
            16 | 19 | 22 => flight.rates_rad_s[1],
            17 | 20 | 23 => flight.rates_rad_s[2],
            32 => flight.alpha_rad,
            33 => flight.alpha_rad.to_degrees(),
            34 => flight.beta_rad,
            35 => flight.beta_rad.to_degrees(),
            36 => flight.beta_rad.abs(),
            37 => flight.beta_rad.to_degrees().abs(),
            38 => flight.alphadot_rad_s,
            39 => flight.alphadot_rad_s.to_degrees(),
            40 => flight.betadot_rad_s,
            41 => flight.betadot_rad_s.to_degrees(),
            42 => self.qbar(),
            46 => flight.alpha_rad + metrics.incidence_rad,
            47 => ratio(metrics.span_ft, 2.0 * self.speed),
            48 => ratio(metrics.chord_ft, 2.0 * self.speed),
            49 => self.qbar() * metrics.area_ft2,
            51 => ratio(self.above_ground(), metrics.span_ft),
            52 => flight.density_kg_m3 / SLUG_FT3,
            53 => flight.pressure_pa / PSF,
            54 => flight.temperature_k * 1.8,
            55 => self.sound,
            56 => flight.density_kg_m3 / SEA_DENSITY,
            57 => flight.pressure_pa / SEA_PRESSURE,
            58 => flight.temperature_k / SEA_TEMPERATURE,
            60 => flight.height_m / FOOT,
            61 => flight.height_m,
            62 => self.above_ground(),
            63 => 0.001 * flight.height_above_ground_m,
            64 | 67 => flight.attitude_rad[0],
            65 | 68 => flight.attitude_rad[1],
            66 | 69 => flight.attitude_rad[2],
            70 => flight.attitude_rad[0].to_degrees(),
            71 => flight.attitude_rad[1].to_degrees(),
            72 => flight.attitude_rad[2].to_degrees(),
            _ => self.other(place),
        }
    }

    /// The values that take more.
    #[inline(never)]
    fn other(&self, place: usize) -> f64 {
        let Self { flight, metrics, .. } = self;
        match place {
            3 => calibrated_m_s(flight.mach(), flight.pressure_pa) / KNOT,
            4 => calibrated_m_s(flight.mach(), flight.pressure_pa) / FOOT,
            5 => (2.0 * flight.dynamic_pressure_pa() / SEA_DENSITY).sqrt() / KNOT,
            6 => (2.0 * flight.dynamic_pressure_pa() / SEA_DENSITY).sqrt() / FOOT,
            24 => flight.rates_rad_s[0] + self.turning() * self.attitude[1].0,
            25 => flight.rates_rad_s[1] * self.attitude[0].1 - flight.rates_rad_s[2] * self.attitude[0].0,
            26 => self.turning(),
            27 => self.over_ground()[0],
            28 => self.over_ground()[1],
            29 => self.over_ground()[2],
            30 => -self.over_ground()[2],
            31 => {
                let [north, east, _] = self.over_ground();
                north.hypot(east)
            }
            43 => self.square * (self.velocity[0] * self.velocity[0] + self.velocity[2] * self.velocity[2]),
            44 => self.square * (self.velocity[0] * self.velocity[0] + self.velocity[1] * self.velocity[1]),
            45 => {
                // Sutherland's law.
                let temperature = flight.temperature_k;
                let viscosity = 1.458e-6 * temperature.max(0.0).powf(1.5) / (temperature + 110.4);
                ratio(flight.density_kg_m3 * flight.airspeed_m_s * metrics.chord_ft * FOOT, viscosity)
            }
            50 => {
                let arm = arm_ft(metrics.reference_in, self.centre_in);
                let reference_down = -arm[0] * self.attitude[1].0
                    + (arm[1] * self.attitude[0].0 + arm[2] * self.attitude[0].1) * self.attitude[1].1;
                ratio(self.above_ground() - reference_down, metrics.span_ft)
            }
            59 => altitude_of_density_m(flight.density_kg_m3) / FOOT,
            73 => self.climb_angle(),
            74 => altitude_of_pressure_m(flight.pressure_pa) / FOOT,
            75 => flight.sound_speed_m_s / SEA_SOUND,
            76 => self.climb_angle().to_degrees(),
            77 => self.speed,
            78 => self.total_temperature_k() * 1.8,
            79 => self.total_temperature_k() - 273.15,
            80 => (impact_ratio(flight.mach()) + 1.0) * flight.pressure_pa / PSF,
            _ => f64::NAN,
        }
    }

    /// Angle of the path over the ground above the horizon, rad.
    fn climb_angle(&self) -> f64 {
        let [north, east, down] = self.over_ground();
        (-down).atan2(north.hypot(east))
    }

    /// Temperature of air brought to rest, K.
    fn total_temperature_k(&self) -> f64 {
        let mach = self.flight.mach();
        self.flight.temperature_k * (1.0 + 0.2 * mach * mach)
    }

    fn above_ground(&self) -> f64 {
        self.flight.height_above_ground_m / FOOT
    }
}

/// A quotient; 0 where its denominator is.
fn ratio(above: f64, below: f64) -> f64 {
    if below == 0.0 { 0.0 } else { above / below }
}

/// Density at the sea in the standard atmosphere of 1976, kg/m3.
const SEA_DENSITY: f64 = 1.225;
/// Pressure there, Pa.
const SEA_PRESSURE: f64 = 101_325.0;
/// Temperature there, K.
const SEA_TEMPERATURE: f64 = 288.15;
/// Speed of sound there, m/s.
const SEA_SOUND: f64 = 340.294;

/// Pressure of air brought to rest, less that around it, over the latter.
fn impact_ratio(mach: f64) -> f64 {
    let m2 = mach * mach;
    if mach <= 1.0 {
        (1.0 + 0.2 * m2).powf(3.5) - 1.0
    } else {
        // Behind a normal shock.
        166.921_580 * mach.powi(7) / (7.0 * m2 - 1.0).powf(2.5) - 1.0
    }
}

/// Calibrated airspeed: the one at which air at the sea would show the same impact pressure, m/s.
fn calibrated_m_s(mach: f64, pressure_pa: f64) -> f64 {
    let wanted = impact_ratio(mach.max(0.0)) * pressure_pa / SEA_PRESSURE;
    if !wanted.is_finite() || wanted <= 0.0 {
        return 0.0;
    }
    let subsonic = (5.0 * ((wanted + 1.0).powf(1.0 / 3.5) - 1.0)).sqrt();
    if subsonic <= 1.0 {
        return subsonic * SEA_SOUND;
    }
    let (mut low, mut high) = (1.0, 100.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if impact_ratio(middle) < wanted { &mut low } else { &mut high }) = middle;
    }
    low * SEA_SOUND
}

/// Geometric height from the geopotential one, m.
fn geometric_m(geopotential: f64) -> f64 {
    const EARTH: f64 = 6_356_766.0;
    EARTH * geopotential / (EARTH - geopotential)
}

/// Height at which the standard atmosphere has a density, m; 0 without density.
pub(crate) fn altitude_of_density_m(density: f64) -> f64 {
    standard_height_m(density / SEA_DENSITY, 4.255_879_8, 0.297_075_8)
}

/// Height at which the standard atmosphere has a pressure, m; 0 without pressure.
fn altitude_of_pressure_m(pressure: f64) -> f64 {
    standard_height_m(pressure / SEA_PRESSURE, 5.255_879_8, 0.223_361_1)
}

/// Height for a ratio of density or pressure to that at the sea: its power of temperature, and its value at 11 km.
fn standard_height_m(ratio: f64, power: f64, at_11_km: f64) -> f64 {
    if !(ratio > 0.0 && ratio.is_finite()) {
        return 0.0;
    }
    if ratio >= at_11_km {
        return geometric_m(SEA_TEMPERATURE / 0.0065 * (1.0 - ratio.powf(1.0 / power)));
    }
    geometric_m(11_000.0 - 6_341.62 * (ratio / at_11_km).ln())
}
