//! Power of a piston engine that runs steadily, from the pressure that its throttle leaves it and from its mixture.

use roxmltree::Node;

use super::super::error::JsbsimError;
use super::super::source::{Source, children, tag};

/// Foot pounds per second in a horsepower.
const HORSEPOWER: f64 = 550.0;
/// Pascals in an inch of mercury.
const INCH_OF_MERCURY: f64 = 3386.38;
/// Pascals in a pound per square inch, as JSBSim rounds it.
const PSI: f64 = 6895.0;
/// Pressure at the sea, Pa.
const SEA_PRESSURE: f64 = 101_320.73;
/// Gas constant of air, J/(kg K).
const GAS: f64 = 287.3;
/// Ratio of specific heats of the charge.
const GAMMA: f64 = 1.3;
/// Fuel for each mass of air at the sea with the mixture lever at 1: 1.3 times what the air can burn. In thinner air the same lever
/// gives as much fuel for less air.
const FUEL_AIR: f64 = 1.3 / 14.7;
/// Pressure that the mixture refers to, Pa.
const MIXTURE_PRESSURE: f64 = 101_325.0;
/// Share of the fuel's power that comes out at a ratio of fuel to air, as JSBSim 1.3.3 has it: measured with its c182 at mixture levers
/// from 0.57 to 1.43, from power, flow of fuel and ratio of air to fuel.
const BURNT: [[f64; 2]; 15] = [
    [0.05, 0.0],
    [0.05137, 0.00862],
    [0.05179, 0.21552],
    [0.0543, 0.48276],
    [0.05842, 0.7069],
    [0.06312, 0.83621],
    [0.06942, 0.93103],
    [0.07786, 1.0],
    [0.08845, 1.0],
    [0.0927, 0.98276],
    [0.1012, 0.93103],
    [0.11455, 0.72414],
    [0.12158, 0.4569],
    [0.12435, 0.23276],
    [0.125, 0.00862],
];

/// [`BURNT`] between its points, constant beyond them.
fn burnt(fuel_air: f64) -> f64 {
    let [first, .., last] = BURNT;
    if fuel_air <= first[0] {
        return first[1];
    }
    let inside = BURNT.windows(2).find(|pair| fuel_air <= pair[1][0]);
    inside.map_or(last[1], |pair| {
        let share = (fuel_air - pair[0][0]) / (pair[1][0] - pair[0][0]);
        pair[0][1] + share * (pair[1][1] - pair[0][1])
    })
}

/// The air that an engine breathes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Air {
    /// Pressure, Pa.
    pub(super) pressure_pa: f64,
    /// Temperature, K.
    pub(super) temperature_k: f64,
    /// Pressure of the air that the flight presses into the intake, above the pressure around, Pa.
    pub(super) ram_pa: f64,
}

/// One speed of a supercharger.
#[derive(Debug, Clone, Copy)]
struct Boost {
    /// What it multiplies the pressure by.
    times: f64,
    /// The pressure that it is held to, Pa.
    most_pa: f64,
}

/// A piston engine.
#[derive(Debug, Clone)]
pub(super) struct Piston {
    displacement_m3: f64,
    stroke_in: f64,
    cycles: f64,
    compression: f64,
    efficiency: f64,
    peak_speed_ft_s: f64,
    airbox: f64,
    throttle: f64,
    friction_hp: f64,
    friction_pa: [f64; 2],
    /// Pounds of fuel an hour for each horsepower.
    consumption: f64,
    ram: f64,
    boosts: Vec<Boost>,
    max_rpm: f64,
}

impl Piston {
    /// Reads a `<piston_engine>`; what it does not say is as JSBSim takes it.
    pub(super) fn read(source: &Source, root: Node<'_, '_>) -> Result<Self, JsbsimError> {
        let find = |name: &str| children(root).find(|part| tag(*part).eq_ignore_ascii_case(name));
        let number = |name: &str, otherwise: f64| -> Result<f64, JsbsimError> {
            find(name).map_or(Ok(otherwise), |found| source.number(found))
        };
        let displacement_in3 = number("displacement", 360.0)?;
        let displacement_m3 = displacement_in3 * 1.638_706_4e-5;
        let (max_hp, max_rpm) = (number("maxhp", 200.0)?, number("maxrpm", 2800.0)?);
        let (idle_rpm, stroke_in) = (number("idlerpm", 600.0)?, number("stroke", 4.375)?);
        let cycles = number("cycles", 4.0)?;
        let efficiency = number("volumetric-efficiency", 0.85)?;
        let friction_hp = number("static-friction", 1.5)?;
        let friction_pa = [number("dynamic-fmep", 18_400.0)?, number("static-fmep", 46_500.0)?];
        let peak_speed_ft_s = number("peak-piston-speed", 100.0)?;
        let (least_inhg, most_inhg) = (number("minmp", 6.5)?, number("maxmp", 28.5)?);
        let sizes = [
            displacement_in3,
            max_hp,
            max_rpm,
            idle_rpm,
            stroke_in,
            cycles,
            efficiency,
            peak_speed_ft_s,
            least_inhg,
            most_inhg,
        ];
        if sizes.iter().any(|&size| size <= 0.0) {
            return Err(source.refuse(root, "a size of the engine is not above 0"));
        }
        let rated_speed = max_rpm * stroke_in / 360.0;
        let consumption = match find("bsfc") {
            Some(found) => source.number(found)?,
            None => {
                let pumping = (29.92 - most_inhg) * INCH_OF_MERCURY * efficiency;
                let friction = friction_pa[0] * rated_speed * 0.3048 + friction_pa[1];
                let lost_hp = (pumping + friction) * displacement_m3 * max_rpm / (cycles * 22_371.0);
                1.1 * displacement_in3 * max_rpm * efficiency * (most_inhg / 29.92)
                    / (9411.0 * (max_hp + lost_hp - friction_hp))
            }
        };
        let most_pa = most_inhg.min(29.9) * INCH_OF_MERCURY;
        let rated = peak_speed_ft_s / rated_speed;
        let airbox = number("air-intake-impedance-factor", SEA_PRESSURE * rated / most_pa - rated)?;
        let idle = peak_speed_ft_s / (idle_rpm * stroke_in / 360.0);
        let throttle = idle * (SEA_PRESSURE / (least_inhg * INCH_OF_MERCURY) - 1.0) - airbox;
        let mut boosts = Vec::new();
        for speed in 1..=number("numboostspeeds", 0.0)?.clamp(0.0, 3.0) as usize {
            let most_pa = 101_320.73 + PSI * number(&format!("ratedboost{speed}"), 0.0)?;
            let height_m = 0.3048 * number(&format!("ratedaltitude{speed}"), 0.0)?;
            let around = SEA_PRESSURE * (1.0 - 2.255_77e-5 * height_m).max(0.1).powf(5.255_88);
            boosts.push(Boost { times: most_pa / around, most_pa });
        }
        Ok(Self {
            displacement_m3,
            stroke_in,
            cycles,
            compression: number("compression-ratio", 8.5)?.max(1.01),
            efficiency,
            peak_speed_ft_s,
            airbox,
            throttle,
            friction_hp,
            friction_pa,
            consumption,
            ram: number("ram-air-factor", 1.0)?,
            boosts,
            max_rpm,
        })
    }

    /// Speed above which it is not asked to run, turns per minute.
    pub(super) fn most_rpm(&self) -> f64 {
        1.5 * self.max_rpm
    }

    /// Friction, foot pounds per second, that is the same at every speed: with it added, the power at a throttle over the speed
    /// nowhere rises with the speed, because the pressure in the manifold falls. None where sizes of the file do not say so.
    pub(super) fn constant_loss(&self, throttle: f64) -> Option<f64> {
        let closed = 1.0 - throttle.clamp(0.0, 1.0);
        let falls = self.airbox + closed * closed * self.throttle >= 0.0
            && self.friction_hp >= 0.0
            && self.friction_pa[0] >= 0.0
            && self.consumption > 0.0
            && self.boosts.iter().all(|boost| boost.times >= 0.0);
        falls.then_some(self.friction_hp * HORSEPOWER)
    }

    /// It at a throttle from 0 to 1 and a mixture lever from 0 to 1 in some air.
    pub(super) fn running(&self, throttle: f64, mixture: f64, air: &Air) -> RunningPiston<'_> {
        let closed = 1.0 - throttle.clamp(0.0, 1.0);
        let swept_m3 = self.displacement_m3 / 60.0 / 2.0;
        let air_kg_s = swept_m3 * self.efficiency / (GAS * air.temperature_k.max(1.0));
        let fuel_air = FUEL_AIR * mixture * (MIXTURE_PRESSURE / air.pressure_pa.max(1.0));
        let fuel_lb_h = air_kg_s * fuel_air * burnt(fuel_air) * 3600.0 / 0.453_592_37;
        RunningPiston {
            piston: self,
            pressure_pa: air.pressure_pa,
            total_pa: air.pressure_pa + air.ram_pa * self.ram,
            resistance: self.airbox + closed * closed * self.throttle,
            speed_by_rpm: self.stroke_in / 360.0,
            power_by_charge: fuel_lb_h / self.consumption * HORSEPOWER,
            loss_by_pressure: self.displacement_m3 / (self.cycles * 22_371.0) * HORSEPOWER,
            filling: [(GAMMA - 1.0) / GAMMA, 1.0 / (GAMMA * (self.compression - 1.0))],
        }
    }
}

/// A piston engine at a throttle in some air.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunningPiston<'a> {
    piston: &'a Piston,
    pressure_pa: f64,
    total_pa: f64,
    resistance: f64,
    speed_by_rpm: f64,
    /// Foot pounds per second for each pascal in the manifold and turn per minute, were the cylinders filled.
    power_by_charge: f64,
    /// Foot pounds per second for each pascal and turn per minute.
    loss_by_pressure: f64,
    filling: [f64; 2],
}

impl RunningPiston<'_> {
    /// Power at a speed, foot pounds per second. Friction may take more than there is.
    #[inline]
    pub(super) fn power(&self, rpm: f64) -> f64 {
        let piston = self.piston;
        let speed_ft_s = (rpm * self.speed_by_rpm).max(1e-3);
        let drawn_pa =
            self.total_pa * (piston.peak_speed_ft_s / (piston.peak_speed_ft_s + speed_ft_s * self.resistance));
        let boosted = piston.boosts.iter().map(|boost| (drawn_pa * boost.times).min(boost.most_pa));
        let manifold_pa = boosted.fold(drawn_pa, f64::max);
        let exhaust = (self.pressure_pa / manifold_pa.max(1.0)).min(piston.compression);
        let filling = self.filling[0] + (piston.compression - exhaust) * self.filling[1];
        let burnt = filling * manifold_pa * self.power_by_charge;
        let friction_pa = piston.friction_pa[0] * speed_ft_s * 0.3048 + piston.friction_pa[1];
        let pumping_pa = (drawn_pa - self.pressure_pa) * piston.efficiency;
        (burnt + (pumping_pa - friction_pa) * self.loss_by_pressure) * rpm - piston.friction_hp * HORSEPOWER
    }
}
