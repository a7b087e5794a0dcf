//! The thrust of an aircraft of JSBSim.

use phugoid_flight_dynamics::atmosphere::Atmosphere;

use crate::flown::options::Thrust;
use crate::flown::pool::Pool;
use crate::jsbsim::{
    Aircraft, CompiledPropulsion, Engine, EngineKind, Evaluator, FlightCondition, PropulsiveWorkspace,
};

/// Time constant of the engines behind the throttle, s.
pub(super) const ENGINE_LAG_S: f64 = 1.0;

/// The thrust as it is made.
#[derive(Clone, Debug)]
pub(super) enum Drive {
    /// By the engines of the files.
    Engines(Box<Engines>),
    /// Along body x, N at full power.
    Force(f64),
}

/// The engines of the files, each at the same share of its throttle.
#[derive(Clone, Debug)]
pub(super) struct Engines {
    compiled: CompiledPropulsion,
    /// The most of the throttle of each.
    most: Vec<f64>,
    pool: Pool<PropulsiveWorkspace>,
}

/// The throttles of the engines with the most of each, where thrust is that of the engines of the files and all of them have a model.
pub(super) fn engines_flown(aircraft: &Aircraft, thrust: Thrust) -> Option<(Vec<usize>, Vec<f64>)> {
    let engines = aircraft.engines();
    let (throttles, most): (Vec<_>, Vec<_>) = engines
        .iter()
        .enumerate()
        .filter(|(_, engine)| matches!(engine.kind, EngineKind::Turbine | EngineKind::Propeller))
        .filter_map(|(number, engine)| {
            let throttle = aircraft.property(&format!("fcs/throttle-pos-norm[{number}]"))?;
            Some((throttle, Engine::dry_throttle(engine)))
        })
        .unzip();
    (thrust == Thrust::Engines && !engines.is_empty() && throttles.len() == engines.len()).then_some((throttles, most))
}

impl Drive {
    /// The thrust that is asked for, at what an evaluator of the aircraft holds of everything but the throttles.
    pub(super) fn new(
        aircraft: &Aircraft,
        evaluator: &Evaluator<'_>,
        thrust: Thrust,
        weight_n: f64,
        notes: &mut Vec<String>,
    ) -> Self {
        if let Thrust::AlongBodyX { largest_n } = thrust {
            notes.push(format!(
                "Thrust is a force along body x through the centre of gravity, {largest_n:.0} N at full throttle."
            ));
            return Self::Force(largest_n);
        }
        if let Some((throttles, most)) = engines_flown(aircraft, thrust) {
            for (number, engine) in aircraft.engines().iter().enumerate().filter(|(_, engine)| engine.has_p_factor()) {
                notes.push(format!(
                    "engine {number} ({}): p_factor is left out: the engines push as in axial flow, without the yawing and pitching \
                     moment of a propeller that the air meets at an angle.",
                    engine.file
                ));
            }
            notes.push(format!("The engines follow the throttle with a lag of {ENGINE_LAG_S} s, without afterburner."));
            let compiled = aircraft.compile_propulsion(evaluator, &throttles);
            return Self::Engines(Box::new(Engines { compiled, most, pool: Pool::default() }));
        }
        let largest = 0.5 * weight_n;
        notes.push(format!(
            "Not all engines have a model here, or there is none: thrust is a force along body x through the centre of \
             gravity, {largest:.0} N (half the weight) at full throttle."
        ));
        Self::Force(largest)
    }
}

impl Engines {
    /// Force (N) and moment (N m) at power (percent), altitude (m) and Mach number, in axial flow.
    pub(super) fn push(&self, aircraft: &Aircraft, [power, altitude, mach]: [f64; 3]) -> [f64; 6] {
        let air = Atmosphere::Standard.at(altitude);
        let flight = FlightCondition::axial(mach * air.speed_of_sound, altitude, &air);
        let share = 0.01 * power.clamp(0.0, 100.0);
        let throttles = self.most.iter().map(|most| share * most);
        let sum = self
            .pool
            .lend(|| self.compiled.workspace(), |workspace| self.compiled.run(aircraft, workspace, &flight, throttles));
        let ([x, y, z], [l, m, n]) = (sum.force_n, sum.moment_n_m);
        [x, y, z, l, m, n]
    }
}
