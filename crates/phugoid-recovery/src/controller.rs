//! When gains change in flight, and which are taken.

use phugoid_control::excitation::{Excitation, Now, Settings as ExcitationSettings};
use phugoid_control::following::{Follower, Following};
use phugoid_control::gains::Gains;
use phugoid_control::interval::{Comparison, Estimate, SAFE, excess};
use phugoid_control::law::{Demand, Law, Measured};
use phugoid_control::local::{AXES, MAIN_AXIS, SURFACES};
use phugoid_control::prediction::{Recent, Steady};
use phugoid_control::qualities::{Category, Level, qualities};
use phugoid_control::target::Targets;

/// Gain of the worst motion that a change of gains has to bring, 1/s.
const WORTH: f64 = 0.1;
/// Time between two decisions, s.
const EVERY: f64 = 0.2;
/// Decisions in a row at which the motion has to be unexplained before the gains in reserve are taken without a suspicion of the estimator: a
/// second. A gust is over by then.
const PATIENCE: u32 = 5;
/// Roll, pitch and yaw acceleration that noise and gusts make, rad/s^2.
const FLOOR: [f64; AXES] = [0.25, 0.1, 0.05];
/// Roll, pitch and yaw, as in "not controllable in pitch".
pub const AXIS_NAMES: [&str; AXES] = ["roll", "pitch", "yaw"];
/// The surfaces in their order.
pub const NAMES: [&str; SURFACES] = ["elevator", "aileron", "rudder"];

/// What the controller decided in one frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// Gains for the present estimate were taken.
    NewGains,
    /// The gains in reserve were taken, because the aircraft does not move as the one that the first are for.
    Reserve,
    /// The present gains were taken without the surface that is lost.
    LeftOut,
    /// A surface no longer does what it is told, or does again ([`Following::Follows`]).
    Surface(usize, Following),
    /// The present gains were taken with a surface that does again what it is told.
    TakenBack,
}

/// A controller that takes its gains from estimates.
pub struct Controller {
    law: Law,
    targets: Targets,
    followers: Option<[Follower; SURFACES]>,
    excitation: Option<Excitation>,
    free: [bool; SURFACES],
    /// Gains for what is not known yet; none once gains of an estimate, or these, were taken.
    reserve: Option<Gains>,
    /// The motion that those in reserve are placed for.
    reserve_targets: Option<Targets>,
    /// Number of the last decisions in a row at which the model behind the present gains did not explain the motion.
    unexplained: u32,
    recent: Recent,
    /// Where surfaces that are not used were when they were given up, rad: what they are told, so that one that moves with an addition to
    /// that can be told from one that does not. If they were told where they are, the command would follow the surface.
    held: [Option<f64>; SURFACES],
    /// What was added to the last commands, rad.
    probe: [f64; SURFACES],
    next_s: f64,
}

/// What a controller is told in one frame.
pub struct Told<'a> {
    /// Time, s.
    pub time_s: f64,
    /// The measurements.
    pub measured: Measured,
    /// The commands of the frame before, rad.
    pub commands: [f64; SURFACES],
    /// The estimate, where there is one that may be used.
    pub estimate: Option<&'a Estimate>,
    /// Whether the estimate is exact: then nothing is asked of its bounds.
    pub is_truth: bool,
    /// Whether a change of the aircraft is suspected.
    pub is_in_doubt: bool,
    /// Whether the estimate is of the aircraft as it is: no change is suspected, and none was a moment ago.
    pub is_settled: bool,
    /// Whether a change of the aircraft was adopted. Until then the estimate gives no gains: it may be of two aircraft, before damage that
    /// nothing has noticed and after it, and those for the aircraft that took off, or for many damages, are the better ones.
    pub has_changed: bool,
}

impl Controller {
    /// A controller with these first gains; with `followers` it watches the surfaces, with `excitation` it moves them to learn.
    pub fn new(
        law: Law,
        targets: Targets,
        followers: Option<[Follower; SURFACES]>,
        excitation: Option<ExcitationSettings>,
    ) -> Self {
        Self {
            law,
            targets,
            followers,
            excitation: excitation.map(Excitation::new),
            free: [true; SURFACES],
            reserve: None,
            reserve_targets: None,
            unexplained: 0,
            recent: Recent::new(),
            held: [None; SURFACES],
            probe: [0.0; SURFACES],
            next_s: 0.0,
        }
    }

    /// The same with gains in reserve that hold for many damages: they are taken as soon as the aircraft does not move as the one that
    /// the first gains are for, and nothing better is known. `targets` is the motion that they are placed for, which may be asked of an
    /// estimate as well.
    pub fn with_reserve(self, reserve: Gains, targets: Targets) -> Self {
        Self { reserve: Some(reserve), reserve_targets: Some(targets), ..self }
    }

    /// The law.
    pub fn law(&mut self) -> &mut Law {
        &mut self.law
    }

    /// The gains in use.
    pub fn gains(&self) -> &Gains {
        self.law.gains()
    }

    /// Whether the next decision is asked for at a time (s): until then no estimate is looked at, but for the excitation.
    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.next_s
    }

    /// Size of the excitation of each surface, 0 to 1.
    pub fn excitation_level(&self) -> [f64; SURFACES] {
        self.excitation.as_ref().map_or([0.0; SURFACES], Excitation::level)
    }

    /// What was flown in the last seconds on average, with what the slopes of an estimate leave of it; none before a second of flight.
    pub fn steady(&self, estimate: &Estimate) -> Option<Steady> {
        self.recent.steady(&estimate.model)
    }

    /// Whether the estimate has explained how the aircraft turned in the last three seconds, and in the last six tenths of one: of damage
    /// that has just happened the longer look still sees the aircraft of before.
    pub fn explains(&self, estimate: &Estimate) -> bool {
        self.recent.has_explained(&estimate.model, FLOOR) && self.recent.explains(&estimate.model, FLOOR)
    }

    /// Looks at the surfaces and the estimate, and changes gains where that is better.
    pub fn decide(&mut self, told: &Told<'_>) -> Vec<Decision> {
        let mut decisions = Vec::new();
        let sample_time = self.law.settings().sample_time;
        self.recent.update(&told.measured.variables, &told.measured.surfaces, sample_time);
        let (mut lost, mut again) = (false, false);
        if let Some(followers) = &mut self.followers {
            for (j, follower) in followers.iter_mut().enumerate() {
                let before = follower.found();
                let (command, position) = (told.commands[j], told.measured.surfaces[j]);
                let found = follower.update(command, self.probe[j], position, sample_time);
                if found != before {
                    decisions.push(Decision::Surface(j, found));
                    lost |= self.free[j] && !found.can_be_used();
                    again |= !self.free[j] && found.can_be_used();
                    self.free[j] = found.can_be_used();
                }
            }
            let limits = self.law.settings().rate_limits;
            let slowed = std::array::from_fn(|j| match followers[j].found() {
                Following::Slow => limits[j].min(followers[j].fastest().max(0.02)),
                _ => limits[j],
            });
            if slowed != limits {
                self.law.set_rate_limits(slowed);
            }
        }
        if !(self.is_due(told.time_s) || lost || again) {
            return decisions;
        }
        self.next_s = told.time_s + EVERY;
        let explained = self.recent.explains(&self.law.gains().modelled(), FLOOR);
        self.unexplained = if explained { 0 } else { self.unexplained.saturating_add(1) };
        if let Some(reserve) = self.reserve
            && (told.is_in_doubt || self.unexplained >= PATIENCE)
            && let Some(reserve) = reserve.with_free(self.free)
            && self.law.change_gains(reserve)
        {
            self.reserve = None;
            decisions.push(Decision::Reserve);
        }
        let now = *self.law.gains();
        if lost || again {
            // The same motion with the surfaces that are left. A surface that stands still changes nothing else of the aircraft, and
            // what the estimate says meanwhile is held to the same rules as before.
            if let Some(new) = now.with_free(self.free)
                && self.law.change_gains(new)
            {
                decisions.push(if lost { Decision::LeftOut } else { Decision::TakenBack });
            }
        } else if let Some(estimate) = told.estimate
            && let Some(new) = self.gains_for(told, estimate)
            && self.law.change_gains(new)
        {
            self.reserve = None;
            decisions.push(Decision::NewGains);
        }
        decisions
    }

    /// Gains for an estimate, where its bounds and the last seconds support them.
    fn gains_for(&self, told: &Told<'_>, estimate: &Estimate) -> Option<Gains> {
        let place = |targets: &Targets| Gains::place_with(&estimate.model, targets, self.free);
        if told.is_truth {
            return place(&self.targets);
        }
        let (now, recent) = (self.law.gains(), &self.recent);
        if !(told.is_settled && told.has_changed && recent.explains(&estimate.model, FLOOR)) {
            return None;
        }
        let supported = || place(&self.targets).filter(|new| is_better(estimate, now, new));
        if recent.prefers(&now.modelled(), &estimate.model)
            && let Some(new) = supported()
        {
            return Some(new);
        }
        // A wing that rolls the aircraft by its lift is nothing that the roots of the motion about straight flight show: those of gains that
        // know nothing of it look well until it banks, and needs more lift. The last seconds show it.
        let allowed =
            |targets: &Targets| place(targets).filter(|new| Comparison::new(estimate, now, new).allows(0.5 * WORTH));
        recent
            .explains_much_better(&now.modelled(), &estimate.model, FLOOR)
            .then(|| [Some(self.targets), self.reserve_targets].iter().flatten().find_map(allowed))
            .flatten()
    }

    /// Commands of the law to elevator, aileron and rudder (rad) for one frame; a surface that is not used is told to stay where it was
    /// given up.
    pub fn command(&mut self, measured: &Measured, demand: &Demand) -> [f64; SURFACES] {
        let mut commands = self.law.update(measured, demand);
        for (j, command) in commands.iter_mut().enumerate() {
            match self.law.gains().free[j] {
                true => self.held[j] = None,
                false => *command = *self.held[j].get_or_insert(*command),
            }
        }
        commands
    }

    /// What is added to the commands so that the estimate becomes better, rad.
    pub fn excite(&mut self, told: &Told<'_>, load_factor: f64) -> [f64; SURFACES] {
        let settings = *self.law.settings();
        let Some(excitation) = &mut self.excitation else { return [0.0; SURFACES] };
        let variables = told.measured.variables;
        let mut width = told.estimate.map_or([f64::NAN; SURFACES], |estimate| widths(estimate, self.free));
        // Whether a surface still answers is told by moving it.
        for (width, follower) in width.iter_mut().zip(self.followers.iter().flatten()) {
            if follower.is_in_doubt() {
                *width = 2.0;
            }
        }
        let now = Now {
            width,
            load_factor: load_factor - 1.0,
            alpha: variables[0] - settings.reference[0],
            beta: variables[1],
        };
        self.probe = excitation.update(&now, settings.sample_time);
        self.probe
    }
}

/// Whether the bounds support new gains: the worst motion gets better, or the flying qualities do and the worst motion stays. Gains that fly the
/// estimated aircraft well are left alone: in the first tenths of a second after a change its bounds are wide, and the worst within them is
/// bad whatever the gains.
fn is_better(estimate: &Estimate, now: &Gains, new: &Gains) -> bool {
    let level = |gains: &Gains| {
        let matrix = estimate.model.closed_loop(&gains.feedback());
        qualities(&matrix, estimate.model.load_factor_per_alpha(), Category::B).level()
    };
    if excess(&estimate.model, now).largest() <= SAFE && level(now) == Level::One {
        return false;
    }
    let comparison = Comparison::new(estimate, now, new);
    comparison.supports(WORTH) || (level(new) < level(now) && comparison.allows(0.5 * WORTH))
}

/// By how much the bounds of what each surface has to tell are too wide: two standard errors of the main effect of the surface
/// against a quarter of it, and of stability and damping of its axis against what the closed loop is to have.
fn widths(estimate: &Estimate, free: [bool; SURFACES]) -> [f64; SURFACES] {
    let (model, error) = (&estimate.model, &estimate.std_error);
    // The feedback variables of the axis of each surface: pitch by alpha and q, roll by p, yaw by beta and r.
    const VARIABLES: [&[usize]; SURFACES] = [&[0, 3], &[2], &[1, 4]];
    // What a change of each of these by one unit of the closed loop is: 1/s^2 for angles, 1/s for rates.
    const UNIT: [f64; 5] = [2.0, 2.0, 1.0, 0.8, 0.8];
    std::array::from_fn(|j| {
        if !free[j] {
            return 0.0;
        }
        let axis = MAIN_AXIS[j];
        let effect = 2.0 * error.surfaces[axis][j] / (0.25 * model.surfaces[axis][j].abs().max(1.0));
        VARIABLES[j].iter().map(|v| 2.0 * error.rates[axis][*v] / UNIT[*v]).fold(effect, f64::max)
    })
}
