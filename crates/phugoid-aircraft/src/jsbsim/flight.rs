//! What is known of the flight at one moment, and the properties of JSBSim that follow from it.

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
    /// Dynamic pressure, Pa.
    pub fn dynamic_pressure_pa(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.airspeed_m_s * self.airspeed_m_s
    }

    /// Mach number; 0 without a speed of sound.
    pub fn mach(&self) -> f64 {
        if self.sound_speed_m_s > 0.0 { self.airspeed_m_s / self.sound_speed_m_s } else { 0.0 }
    }
}

/// Indices of the properties that a flight condition sets, in the order of [`values`].
#[derive(Debug, Clone)]
pub(super) struct FlightProperties(Vec<usize>);

/// Names of the properties that a flight condition sets.
#[rustfmt::skip]
const NAMES: [&str; 75] = [
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
    "flight-path/gamma-rad", "atmosphere/pressure-altitude",
];

/// Which of the properties that take some computing are wanted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Components of the velocity.
    velocity: bool,
    /// What follows from the attitude.
    path: bool,
    calibrated: bool,
    equivalent: bool,
    reynolds: bool,
    density_altitude: bool,
    pressure_altitude: bool,
    /// Heights above the sea or the ground.
    pub(super) height: bool,
}

impl Wanted {
    /// All of them.
    const ALL: Self = Self {
        velocity: true,
        path: true,
        calibrated: true,
        equivalent: true,
        reynolds: true,
        density_altitude: true,
        pressure_altitude: true,
        height: true,
    };

    /// Adds the property of a name.
    fn add(&mut self, name: &str) {
        match name {
            "velocities/vc-kts" | "velocities/vc-fps" => self.calibrated = true,
            "velocities/ve-kts" | "velocities/ve-fps" => self.equivalent = true,
            "aero/Re" => self.reynolds = true,
            "atmosphere/density-altitude" => self.density_altitude = true,
            "atmosphere/pressure-altitude" => self.pressure_altitude = true,
            "aero/h_b-cg-ft" => self.height = true,
            "aero/h_b-mac-ft" => (self.height, self.path) = (true, true),
            "velocities/machU" | "aero/qbarUW-psf" | "aero/qbarUV-psf" => self.velocity = true,
            _ if name.starts_with("position/") => self.height = true,
            _ if name.starts_with("aero/") => {}
            _ if ["/u-", "/v-fps", "/v-aero-", "/w-"].iter().any(|part| name.contains(part)) => self.velocity = true,
            _ if ["dot-rad_sec", "/v-", "/h-dot", "/vg-", "flight-path/"].iter().any(|part| name.contains(part)) => {
                (self.velocity, self.path) = (true, true);
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

    /// Number of the properties.
    pub(super) const COUNT: usize = NAMES.len();
    /// Place of the dynamic pressure among them, which a test checks.
    pub(super) const QBAR: usize = 42;

    /// Place of a property among them.
    pub(super) fn place(&self, index: usize) -> Option<usize> {
        self.0.iter().position(|&own| own == index)
    }

    /// The properties in the order of [`FlightProperties::values`].
    pub(super) fn indices(&self) -> &[usize] {
        &self.0
    }

    /// What is to be computed for some of them, by their place in this order.
    pub(super) fn wanted(places: impl Iterator<Item = usize>) -> Wanted {
        let mut wanted = Wanted::default();
        places.for_each(|place| wanted.add(NAMES[place]));
        wanted
    }

    /// Values of the properties, of which those that are not wanted mean nothing.
    #[inline]
    pub(super) fn values(
        flight: &FlightCondition,
        metrics: &Metrics,
        centre_in: [f64; 3],
        wanted: &Wanted,
    ) -> [f64; NAMES.len()] {
        values(flight, metrics, centre_in, wanted)
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
        for (&index, value) in self.0.iter().zip(values(flight, metrics, centre_in, &Wanted::ALL)) {
            state.write(model, index, value);
        }
    }
}

/// Values of the properties in the order of [`NAMES`]; those that are not wanted mean nothing.
#[inline]
fn values(flight: &FlightCondition, metrics: &Metrics, centre_in: [f64; 3], wanted: &Wanted) -> [f64; NAMES.len()] {
    let speed = flight.airspeed_m_s / FOOT;
    let sound = flight.sound_speed_m_s / FOOT;
    let rho = flight.density_kg_m3 / SLUG_FT3;
    let pressure = flight.pressure_pa / PSF;
    let (alpha, beta) = (flight.alpha_rad, flight.beta_rad);
    let [u, v, w] = if wanted.velocity {
        let ((sa, ca), (sb, cb)) = (alpha.sin_cos(), beta.sin_cos());
        [speed * ca * cb, speed * sb, speed * sa * cb]
    } else {
        [0.0; 3]
    };
    let [p, q, r] = flight.rates_rad_s;
    let [phi, theta, psi] = flight.attitude_rad;
    let turned = |angle: f64| if wanted.path { angle.sin_cos() } else { (0.0, 1.0) };
    let ((sphi, cphi), (stheta, ctheta), (spsi, cpsi)) = (turned(phi), turned(theta), turned(psi));
    // Velocity against the ground where the air is still.
    let (forward, side) = (u * ctheta + (v * sphi + w * cphi) * stheta, v * cphi - w * sphi);
    let north = forward * cpsi - side * spsi;
    let east = forward * spsi + side * cpsi;
    let down = -u * stheta + (v * sphi + w * cphi) * ctheta;
    let turning = if ctheta == 0.0 { 0.0 } else { (q * sphi + r * cphi) / ctheta };
    let mach = flight.mach();
    let ratio = |above: f64, below: f64| if below == 0.0 { 0.0 } else { above / below };
    let computed = |is_wanted: bool, value: &dyn Fn() -> f64| if is_wanted { value() } else { 0.0 };
    let calibrated = computed(wanted.calibrated, &|| calibrated_m_s(mach, flight.pressure_pa));
    let equivalent = computed(wanted.equivalent, &|| (2.0 * flight.dynamic_pressure_pa() / SEA_DENSITY).sqrt());
    let square = 0.5 * rho;
    let (height, above_ground) = (flight.height_m / FOOT, flight.height_above_ground_m / FOOT);
    let arm = arm_ft(metrics.reference_in, centre_in);
    let reference_down = -arm[0] * stheta + (arm[1] * sphi + arm[2] * cphi) * ctheta;
    let temperature = flight.temperature_k;
    let reynolds = computed(wanted.reynolds, &|| {
        // Sutherland's law.
        let viscosity = 1.458e-6 * temperature.max(0.0).powf(1.5) / (temperature + 110.4);
        ratio(flight.density_kg_m3 * flight.airspeed_m_s * metrics.chord_ft * FOOT, viscosity)
    });
    let pressure_altitude = computed(wanted.pressure_altitude, &|| altitude_of_pressure_m(flight.pressure_pa) / FOOT);
    let density_altitude = computed(wanted.density_altitude, &|| altitude_of_density_m(flight.density_kg_m3) / FOOT);
    let ground_speed = computed(wanted.path, &|| north.hypot(east));
    let climb = computed(wanted.path, &|| (-down).atan2(ground_speed));
    [
        speed,
        mach,
        ratio(u, sound),
        calibrated / KNOT,
        calibrated / FOOT,
        equivalent / KNOT,
        equivalent / FOOT,
        flight.airspeed_m_s / KNOT,
        speed,
        u,
        v,
        w,
        u,
        v,
        w,
        p,
        q,
        r,
        p,
        q,
        r,
        p,
        q,
        r,
        p + turning * stheta,
        q * cphi - r * sphi,
        turning,
        north,
        east,
        down,
        -down,
        ground_speed,
        alpha,
        alpha.to_degrees(),
        beta,
        beta.to_degrees(),
        beta.abs(),
        beta.to_degrees().abs(),
        flight.alphadot_rad_s,
        flight.alphadot_rad_s.to_degrees(),
        flight.betadot_rad_s,
        flight.betadot_rad_s.to_degrees(),
        square * speed * speed,
        square * (u * u + w * w),
        square * (u * u + v * v),
        reynolds,
        alpha + metrics.incidence_rad,
        ratio(metrics.span_ft, 2.0 * speed),
        ratio(metrics.chord_ft, 2.0 * speed),
        square * speed * speed * metrics.area_ft2,
        ratio(above_ground - reference_down, metrics.span_ft),
        ratio(above_ground, metrics.span_ft),
        rho,
        pressure,
        temperature * 1.8,
        sound,
        flight.density_kg_m3 / SEA_DENSITY,
        flight.pressure_pa / SEA_PRESSURE,
        temperature / SEA_TEMPERATURE,
        density_altitude,
        height,
        flight.height_m,
        above_ground,
        0.001 * flight.height_above_ground_m,
        phi,
        theta,
        psi,
        phi,
        theta,
        psi,
        phi.to_degrees(),
        theta.to_degrees(),
        psi.to_degrees(),
        climb,
        pressure_altitude,
    ]
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
