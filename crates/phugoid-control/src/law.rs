//! The control law of each frame: rate commands are followed, constant moments integrated away, surfaces kept within their limits,
//! and gains changed without a step of any surface.

use crate::gains::Gains;
use crate::local::{ALPHA, AXES, BETA, P, Q, R, ROLL, SURFACES, VARIABLES, YAW};

/// What is measured of the aircraft; rad and rad/s. A value that is no number is taken from the frame before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measured {
    /// Angle of attack, sideslip, roll, pitch and yaw rate, as they are (not from the reference).
    pub variables: [f64; VARIABLES],
    /// Positions of elevator, aileron and rudder; the incremental form needs them.
    pub surfaces: [f64; SURFACES],
}

/// What the pilot or an outer loop asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Demand {
    /// Roll rate, rad/s, positive right wing down.
    pub roll_rate: f64,
    /// Pitch rate, rad/s, positive nose up.
    pub pitch_rate: f64,
    /// Yaw rate of the turn, rad/s, positive nose right; that of a steady turn is `g sin(phi) cos(theta) / V`.
    pub yaw_rate: f64,
    /// Sideslip, rad, positive with the air from the right.
    pub sideslip: f64,
}

/// The form of the law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Form {
    /// The wanted less the modelled angular acceleration, over the modelled effect of the surfaces. Uses everything that is
    /// estimated.
    #[default]
    Model,
    /// The wanted less the measured angular acceleration, added to where the surfaces are (incremental nonlinear dynamic inversion,
    /// INDI). Uses the effect of the surfaces alone; stability and damping come from the gyroscopes.
    Incremental,
}

/// The fixed settings of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Settings {
    /// Time between two frames, s.
    pub sample_time: f64,
    /// The feedback variables at the reference, rad and rad/s.
    pub reference: [f64; VARIABLES],
    /// Positions of elevator, aileron and rudder at the reference, rad.
    pub surfaces: [f64; SURFACES],
    /// Lowest and highest command of each surface, rad.
    pub limits: [[f64; 2]; SURFACES],
    /// Largest change of each command, rad/s.
    pub rate_limits: [f64; SURFACES],
    /// How fast constant moments are integrated away, rad/s: roll, pitch, yaw.
    pub integration: [f64; AXES],
    /// Bandwidth of the filter of the measured angular acceleration, rad/s (incremental form).
    pub filter: f64,
    /// The form of the law.
    pub form: Form,
}

impl Settings {
    /// Settings for an aircraft at a reference, with surfaces within `limits` (rad) at up to `rate_limits` (rad/s).
    pub fn new(
        sample_time: f64,
        reference: [f64; VARIABLES],
        surfaces: [f64; SURFACES],
        limits: [[f64; 2]; SURFACES],
        rate_limits: [f64; SURFACES],
    ) -> Self {
        Self {
            sample_time,
            reference,
            surfaces,
            limits,
            rate_limits,
            integration: [0.8, 0.8, 0.4],
            filter: 30.0,
            form: Form::Model,
        }
    }
}

/// Part of a demanded roll rate that is followed where the aircraft is rolled by a sideslip, and of the integration in roll. The rudder
/// first rolls it the other way: with what it does at once (+8 1/s^2 of a fighter) and by the sideslip (-15) no loop in roll
/// can be faster than some 2 rad/s, and the pilot closes one of 1 rad/s.
const SLOWER: f64 = 0.4;
/// Largest sideslip that the aircraft is rolled with, rad.
const LARGEST_SIDESLIP: f64 = 0.17;

/// A roll through sideslip.
#[derive(Clone, Copy, Default)]
struct ThroughSideslip {
    /// Sideslip that is asked for, rad, and the yaw acceleration for that, rad/s^2.
    sideslip: f64,
    yaw: f64,
    /// Sideslip beyond the largest one that the roll would need, rad.
    beyond: f64,
}

/// The law with its memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    settings: Settings,
    gains: Gains,
    /// Angular accelerations that are added for what the model does not know, rad/s^2.
    integral: [f64; AXES],
    /// The change of the angle of attack that follows the commanded pitch rate, rad.
    climb: f64,
    /// The last commands, rad.
    commands: [f64; SURFACES],
    /// The last measured values.
    last: Measured,
    /// The last demand.
    demand: Demand,
    /// Filtered rates and surface positions, and the rates' filtered derivatives.
    rates: [f64; AXES],
    positions: [f64; SURFACES],
    accelerations: [f64; AXES],
    started: bool,
}

impl Law {
    /// A law that begins at its reference.
    pub fn new(settings: Settings, gains: Gains) -> Self {
        let surfaces = settings.surfaces;
        Self {
            settings,
            gains,
            integral: [0.0; AXES],
            climb: 0.0,
            commands: surfaces,
            last: Measured { variables: settings.reference, surfaces },
            demand: Demand::default(),
            rates: [0.0; AXES],
            positions: surfaces,
            accelerations: [0.0; AXES],
            started: false,
        }
    }

    /// The gains in use.
    pub fn gains(&self) -> &Gains {
        &self.gains
    }

    /// The settings in use.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the largest rate of each command, rad/s: for a surface that has become slow.
    pub fn set_rate_limits(&mut self, rate_limits: [f64; SURFACES]) {
        self.settings.rate_limits = rate_limits;
    }

    /// Takes new gains. No command jumps: what the integrators held with the old gains is expressed with the new ones. Gains that
    /// are not finite are refused.
    pub fn change_gains(&mut self, gains: Gains) -> bool {
        if !gains.is_finite() {
            return false;
        }
        let state = self.deviations(&self.last);
        let (was_rolled_by_sideslip, rolled) = (self.gains.roll_by_sideslip.is_some(), self.integral[ROLL]);
        self.gains = gains;
        if self.settings.form == Form::Incremental {
            return true;
        }
        let moved: [f64; SURFACES] = core::array::from_fn(|j| self.commands[j] - self.settings.surfaces[j]);
        let asked = self.asked(&self.demand);
        for i in 0..AXES {
            let made: f64 = (0..SURFACES).map(|j| gains.surfaces[i][j] * moved[j]).sum();
            let by_state: f64 = (0..VARIABLES).map(|j| gains.added[i][j] * state[j]).sum();
            self.integral[i] = made - by_state - asked[i] + gains.constant[i];
        }
        if gains.roll_by_sideslip.is_some() {
            // What ailerons that do not answer were asked for in vain says nothing of a constant moment.
            self.integral[ROLL] = if was_rolled_by_sideslip { rolled } else { 0.0 };
            let needed = self.needed(&state, &asked);
            self.integral[YAW] -= self.roll_through_sideslip(&needed, &state, &moved).yaw;
        }
        true
    }

    /// Commands to elevator, aileron and rudder (rad) for one frame.
    pub fn update(&mut self, measured: &Measured, demand: &Demand) -> [f64; SURFACES] {
        let measured = self.replaced(measured);
        let settings = self.settings;
        let state = self.deviations(&measured);
        self.filter(&measured);
        let gains = &self.gains;
        let asked = self.asked(demand);
        let limits: [[f64; 2]; SURFACES] = core::array::from_fn(|j| {
            let step = settings.rate_limits[j] * settings.sample_time;
            let [lowest, highest] = settings.limits[j];
            [lowest.max(self.commands[j] - step), highest.min(self.commands[j] + step)]
        });
        let from = match settings.form {
            Form::Model => settings.surfaces,
            Form::Incremental => self.positions,
        };
        let mut needed = self.needed(&state, &asked);
        let stand = core::array::from_fn(|j| measured.surfaces[j] - from[j]);
        let rolled = self.roll_through_sideslip(&needed, &state, &stand);
        needed[YAW] += rolled.yaw;
        let ways: [[f64; 2]; SURFACES] = core::array::from_fn(|j| {
            let [lowest, highest] = if gains.free[j] { limits[j] } else { [measured.surfaces[j]; 2] };
            [lowest - from[j], highest - from[j]]
        });
        let deflections = gains.allocate(needed, &ways);
        // A surface that cannot be used is told to stay where it is.
        let commands: [f64; SURFACES] =
            core::array::from_fn(|j| if gains.free[j] { from[j] + deflections[j] } else { measured.surfaces[j] });
        // What the surfaces could not give: integration in that direction would only wind up.
        let mut short: [f64; AXES] = core::array::from_fn(|i| {
            let given: f64 = (0..SURFACES).map(|j| gains.surfaces[i][j] * deflections[j]).sum();
            needed[i] - given
        });
        if let Some(by_sideslip) = gains.roll_by_sideslip {
            // In sideslip, what the rudder could not give is short of the roll.
            short[ROLL] = by_sideslip * (rolled.beyond - short[YAW] / gains.wanted[YAW][BETA]);
        }
        let quickness = self.quickness();
        let errors = [
            -gains.wanted[0][P] * (quickness * demand.roll_rate - state[P]),
            -gains.wanted[1][Q] * (demand.pitch_rate - state[Q]),
            gains.wanted[2][BETA] * (state[BETA] - demand.sideslip - rolled.sideslip),
        ];
        for i in 0..AXES {
            // A tenth of what is asked of the axis: the price of deflection leaves a little behind in any case.
            let winds_up = short[i] * errors[i] > 0.0 && short[i].abs() > 0.1 * needed[i].abs();
            if !winds_up && errors[i].is_finite() {
                let pace = if i == ROLL { quickness } else { 1.0 };
                self.integral[i] += pace * settings.integration[i] * errors[i] * settings.sample_time;
            }
        }
        // alpha' = q + Z_alpha alpha: the wanted motion has the angle of attack that goes with the commanded rate.
        let climbing = demand.pitch_rate + gains.lift * self.climb;
        if climbing.is_finite() {
            self.climb += climbing * settings.sample_time;
        }
        for j in 0..SURFACES {
            if commands[j].is_finite() {
                self.commands[j] = commands[j];
            }
        }
        (self.last, self.demand) = (measured, *demand);
        self.commands
    }

    /// Angular accelerations that the surfaces have to make (model form), or to make beside those that they make (incremental form), rad/s^2.
    fn needed(&self, state: &[f64; VARIABLES], asked: &[f64; AXES]) -> [f64; AXES] {
        let gains = &self.gains;
        core::array::from_fn(|i| {
            let by_state = match self.settings.form {
                Form::Model => (0..VARIABLES).map(|j| gains.added[i][j] * state[j]).sum::<f64>() - gains.constant[i],
                Form::Incremental => {
                    (0..VARIABLES).map(|j| gains.wanted[i][j] * state[j]).sum::<f64>() - self.accelerations[i]
                }
            };
            by_state + asked[i] + self.integral[i]
        })
    }

    /// What the rudder is asked for so that the sideslip makes the roll acceleration that is needed; nothing where the ailerons make it.
    /// `stand` says how far the surfaces are from where `needed` counts from, rad.
    fn roll_through_sideslip(
        &self,
        needed: &[f64; AXES],
        state: &[f64; VARIABLES],
        stand: &[f64; SURFACES],
    ) -> ThroughSideslip {
        let gains = &self.gains;
        let Some(by_sideslip) = gains.roll_by_sideslip else { return ThroughSideslip::default() };
        // What a surface that stands makes need not be made.
        let made: f64 = (0..SURFACES).filter(|j| !gains.free[*j]).map(|j| gains.surfaces[ROLL][j] * stand[j]).sum();
        let roll = needed[ROLL] - made;
        let sideslip = match self.settings.form {
            Form::Model => (roll - gains.added[ROLL][BETA] * state[BETA]) / by_sideslip,
            Form::Incremental => state[BETA] + roll / by_sideslip,
        };
        let held = sideslip.clamp(-LARGEST_SIDESLIP, LARGEST_SIDESLIP);
        ThroughSideslip { sideslip: held, yaw: -gains.wanted[YAW][BETA] * held, beyond: sideslip - held }
    }

    /// Angular accelerations that the demand asks for, rad/s^2.
    fn asked(&self, demand: &Demand) -> [f64; AXES] {
        let wanted = &self.gains.wanted;
        [
            -wanted[0][P] * self.quickness() * demand.roll_rate,
            -wanted[1][Q] * demand.pitch_rate - wanted[1][ALPHA] * self.climb,
            -wanted[2][R] * demand.yaw_rate - wanted[2][BETA] * demand.sideslip,
        ]
    }

    /// The part of a demanded roll rate that is followed.
    fn quickness(&self) -> f64 {
        if self.gains.roll_by_sideslip.is_some() { SLOWER } else { 1.0 }
    }

    fn deviations(&self, measured: &Measured) -> [f64; VARIABLES] {
        core::array::from_fn(|j| measured.variables[j] - self.settings.reference[j])
    }

    /// The measurement with the last good value in the place of each that is no number.
    fn replaced(&self, measured: &Measured) -> Measured {
        let good = |now: f64, before: f64| if now.is_finite() { now } else { before };
        Measured {
            variables: core::array::from_fn(|j| good(measured.variables[j], self.last.variables[j])),
            surfaces: core::array::from_fn(|j| good(measured.surfaces[j], self.last.surfaces[j])),
        }
    }

    /// The same first-order lag for rates and surface positions, so that both are equally late.
    fn filter(&mut self, measured: &Measured) {
        let rates = [measured.variables[P], measured.variables[Q], measured.variables[R]];
        if !self.started {
            (self.rates, self.positions, self.started) = (rates, measured.surfaces, true);
        }
        let share = 1.0 - libm::exp(-self.settings.filter * self.settings.sample_time);
        for i in 0..AXES {
            let step = share * (rates[i] - self.rates[i]);
            self.rates[i] += step;
            self.accelerations[i] = step / self.settings.sample_time;
        }
        for j in 0..SURFACES {
            self.positions[j] += share * (measured.surfaces[j] - self.positions[j]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::tests::fighter;
    use crate::local::{LocalModel, STATES};
    use crate::target::Targets;

    const LIMITS: [[f64; 2]; 3] = [[-0.43, 0.43], [-0.37, 0.37], [-0.52, 0.52]];

    fn settings(form: Form) -> Settings {
        Settings { form, ..Settings::new(0.01, [0.0; 5], [0.0; 3], LIMITS, [1.0, 1.4, 2.0]) }
    }

    /// Flies a linear aircraft with the law; the surfaces follow at once. States `[alpha, beta, phi, p, q, r]`.
    fn fly(model: &LocalModel, law: &mut Law, demand: Demand, seconds: f64) -> [f64; STATES] {
        let mut x = [0.0; STATES];
        fly_on(model, law, |_| demand, |u| u, &mut x, seconds);
        x
    }

    /// The same from a state on, with a pilot who sees it and surfaces that do what `answer` makes of their commands.
    fn fly_on(
        model: &LocalModel,
        law: &mut Law,
        pilot: impl Fn(&[f64; STATES]) -> Demand,
        answer: impl Fn([f64; 3]) -> [f64; 3],
        x: &mut [f64; STATES],
        seconds: f64,
    ) {
        let a = model.closed_loop(&[[0.0; 5]; 3]);
        let mut u = answer([0.0; 3]);
        for _ in 0..(seconds / 0.01) as usize {
            let measured = Measured { variables: [x[0], x[1], x[3], x[4], x[5]], surfaces: u };
            u = answer(law.update(&measured, &pilot(x)));
            for _ in 0..10 {
                let mut rate = [0.0; STATES];
                for i in 0..STATES {
                    rate[i] = (0..STATES).map(|j| a[i][j] * x[j]).sum();
                }
                rate[0] += model.alpha_by_elevator * u[0];
                rate[1] += model.beta_by_rudder * u[2];
                for i in 0..3 {
                    rate[3 + i] += (0..3).map(|j| model.surfaces[i][j] * u[j]).sum::<f64>() + model.constant[i];
                }
                (0..STATES).for_each(|i| x[i] += 0.001 * rate[i]);
            }
        }
    }

    /// Ailerons that stand at 1.5 deg and a bank angle of 20 deg: a pilot who asks for a roll rate of a second's bank angle levels the wings with
    /// the rudder, by a sideslip that makes up for the ailerons, whether they are known to be lost or to have no effect.
    #[test]
    fn without_ailerons_the_rudder_rolls_the_aircraft_by_a_sideslip() {
        const STUCK: f64 = 0.026;
        let model = fighter();
        let lost = [true, false, true];
        for form in [Form::Model, Form::Incremental] {
            let gains = Gains::place(&model, &Targets::default()).and_then(|gains| gains.with_free(lost)).unwrap();
            let by_sideslip = gains.roll_by_sideslip.unwrap();
            assert!((by_sideslip - (-30.0 + 9.0 / 4.5 * 8.0)).abs() < 1e-12);
            let mut law = Law::new(settings(form), gains);
            let mut x = [0.0, 0.0, 0.35, 0.0, 0.0, 0.0];
            let level =
                |x: &[f64; STATES]| Demand { roll_rate: -x[2], yaw_rate: 9.81 / 205.0 * x[2], ..Demand::default() };
            fly_on(&model, &mut law, level, |u| [u[0], STUCK, u[2]], &mut x, 10.0);
            assert!(x[2].abs() < 0.06, "{form:?} {x:?}");
            fly_on(&model, &mut law, level, |u| [u[0], STUCK, u[2]], &mut x, 25.0);
            // The ailerons roll with -45 of a radian and yaw with -2; the sideslip makes up for the roll of both and of the rudder.
            assert!(x[2].abs() < 0.005 && (x[1] - -45.0 * STUCK / 14.0).abs() < 0.03, "{form:?} {x:?}");
        }
        // Where the model knows that they have no effect it does not matter whether they are used.
        let mut dead = model;
        (0..3).for_each(|i| dead.surfaces[i][1] = 0.0);
        let gains = Gains::place(&dead, &Targets::default()).unwrap();
        assert!(gains.roll_by_sideslip.is_some());
        let roots = crate::roots::eigenvalues(&dead.closed_loop(&gains.feedback())).unwrap();
        assert!(roots.iter().all(|root| root.real < 0.05), "{roots:?}");
        // Used again, they roll it again.
        let again = gains.with_free(lost).and_then(|gains| gains.with_free([true; 3])).unwrap();
        assert_eq!(again, gains);
        let whole = Gains::place(&model, &Targets::default()).unwrap();
        assert_eq!(whole.with_free(lost).and_then(|gains| gains.with_free([true; 3])), Some(whole));
        // Without a rudder nothing rolls it.
        let none = whole.with_free([true, false, false]).unwrap();
        assert_eq!(none.roll_by_sideslip, None);
    }

    #[test]
    fn rates_are_followed_and_a_constant_moment_is_integrated_away() {
        for form in [Form::Model, Form::Incremental] {
            let mut model = fighter();
            let gains = Gains::place(&model, &Targets::default()).unwrap();
            let demand = Demand { pitch_rate: 0.05, ..Demand::default() };
            let x = fly(&model, &mut Law::new(settings(form), gains), demand, 6.0);
            assert!((x[4] - 0.05).abs() < 0.004, "{form:?} {x:?}");
            // The gains do not know of the moments.
            model.constant = [0.5, -0.3, 0.1];
            let x = fly(&model, &mut Law::new(settings(form), gains), Demand::default(), 15.0);
            assert!(x[3].abs() < 0.01 && x[4].abs() < 0.005 && x[1].abs() < 0.01, "{form:?} {x:?}");
        }
    }

    #[test]
    fn new_gains_move_no_surface() {
        let model = fighter();
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let mut law = Law::new(settings(Form::Model), gains);
        let demand = Demand { roll_rate: 0.3, pitch_rate: 0.03, ..Demand::default() };
        fly(&model, &mut law, demand, 0.7);
        let mut other = model;
        other.surfaces.iter_mut().flatten().for_each(|b| *b *= 0.6);
        other.rates[1][0] = 5.0;
        let before = law.commands;
        let last = law.last;
        assert!(law.change_gains(Gains::place(&other, &Targets::default()).unwrap()));
        let after = law.update(&last, &demand);
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).abs() < 0.003, "{before} {after}");
        }
        assert!(!law.change_gains(Gains { constant: [f64::NAN; 3], ..gains }));
    }

    #[test]
    fn limits_hold_and_nothing_winds_up() {
        let model = fighter();
        let gains = Gains::place(&model, &Targets::default()).unwrap();
        let mut law = Law::new(settings(Form::Model), gains);
        // More than the ailerons can give, for long: when the demand ends the roll ends too.
        fly(&model, &mut law, Demand { roll_rate: 20.0, ..Demand::default() }, 5.0);
        assert!(law.commands.iter().zip(LIMITS).all(|(u, [low, high])| (low..=high).contains(u)));
        assert!(law.integral.iter().all(|i| i.abs() < 60.0), "{:?}", law.integral);
    }

    #[test]
    fn what_is_no_number_is_taken_from_the_frame_before() {
        let gains = Gains::place(&fighter(), &Targets::default()).unwrap();
        let mut law = Law::new(settings(Form::Model), gains);
        let measured = Measured { variables: [0.01, 0.0, 0.02, 0.03, 0.0], surfaces: [0.0; 3] };
        law.update(&measured, &Demand::default());
        let missing = Measured { variables: [f64::NAN; 5], surfaces: [f64::NAN; 3] };
        assert!(law.update(&missing, &Demand::default()).iter().all(|u| u.is_finite()));
        assert_eq!(law.last, measured);
    }
}
