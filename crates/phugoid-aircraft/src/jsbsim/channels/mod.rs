//! Flight control: components that run one after the other, in the order of the file, once per step.

mod component;
mod read;
mod run;
mod steady;

pub(super) use component::{Component, Memory};

use super::model::{Model, State};
use super::scaling::Scaling;
use component::{Kind, Parameter};

/// One channel: components that run together.
#[derive(Debug, Clone)]
struct Channel {
    /// The property that has to be other than 0 for the channel to run.
    execute: Option<usize>,
    /// It runs in one of so many steps.
    rate: u32,
    components: Vec<Component>,
}

/// All channels of an aircraft in the order in which they run: systems, autopilots, flight control.
#[derive(Debug, Clone, Default)]
pub(super) struct Channels {
    channels: Vec<Channel>,
    /// Functions that are computed before the channels run, and after.
    before: Vec<usize>,
    after: Vec<usize>,
    /// Properties of commands, and of the positions that follow them unless a channel says otherwise.
    followed: Vec<(usize, usize)>,
}

/// What the components that write a property go through, by index.
#[derive(Debug, Default)]
pub(super) struct Feeding {
    pub(super) properties: Vec<usize>,
    pub(super) functions: Vec<usize>,
    pub(super) tables: Vec<usize>,
}

/// What the components remember from one step to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Memories {
    components: Vec<Vec<Memory>>,
    /// Steps since each channel ran.
    waited: Vec<u32>,
}

impl Channels {
    /// The memory of channels that never ran.
    pub(super) fn memories(&self) -> Memories {
        Memories {
            components: self.channels.iter().map(|channel| vec![Memory::default(); channel.components.len()]).collect(),
            waited: self.channels.iter().map(|channel| channel.rate).collect(),
        }
    }

    /// Makes throttle, mixture, propeller advance and feather positions of engines follow their commands.
    pub(super) fn follow_engines(&mut self, model: &mut Model, engines: usize) {
        let pairs = [
            ("throttle-cmd-norm", "throttle-pos-norm"),
            ("mixture-cmd-norm", "mixture-pos-norm"),
            ("advance-cmd-norm", "advance-pos-norm"),
            ("feather-cmd-norm", "feather-pos-norm"),
        ];
        for engine in 0..engines {
            for (command, position) in pairs {
                let [command, position] =
                    [command, position].map(|name| model.property(&format!("fcs/{name}[{engine}]")));
                self.followed.push((command, position));
            }
        }
    }

    /// Properties that channels write.
    pub(super) fn outputs(&self) -> impl Iterator<Item = usize> {
        let components = self.channels.iter().flat_map(|channel| &channel.components);
        components.flat_map(|component| component.outputs.iter().copied())
    }

    /// Properties that channels read themselves; those that their functions read are not among them.
    pub(super) fn inputs(&self) -> impl Iterator<Item = usize> {
        let components = self.channels.iter().flat_map(|channel| &channel.components);
        let executing = self.channels.iter().filter_map(|channel| channel.execute);
        components.flat_map(Component::reads).chain(executing)
    }

    /// What the components that write a property read themselves, with whether their channel runs, and the functions and tables
    /// that they go through.
    pub(super) fn feeding(&self, property: usize) -> Feeding {
        let mut feeding = Feeding::default();
        for channel in &self.channels {
            for component in channel.components.iter().filter(|component| component.outputs.contains(&property)) {
                feeding.properties.extend(component.reads().into_iter().chain(channel.execute));
                match component.kind {
                    Kind::Function(function) => feeding.functions.push(function),
                    Kind::Scheduled { table, .. } => feeding.tables.push(table),
                    _ => {}
                }
            }
        }
        feeding
    }

    /// What all channels read themselves, and the functions and tables that they go through.
    pub(super) fn everything(&self) -> Feeding {
        let mut feeding = Feeding { properties: self.inputs().collect(), ..Feeding::default() };
        feeding.functions.extend(self.before.iter().chain(&self.after));
        for component in self.channels.iter().flat_map(|channel| &channel.components) {
            match component.kind {
                Kind::Function(function) => feeding.functions.push(function),
                Kind::Scheduled { table, .. } => feeding.tables.push(table),
                _ => {}
            }
        }
        feeding
    }

    /// Whether a property follows its command through a drive of the files: an actuator, a kinematic or a lag that stands last, or with
    /// nothing but scales, gains and dead bands behind it.
    pub(super) fn has_drive(&self, property: usize) -> bool {
        let mut at = property;
        // A circle of components has no end.
        for _ in 0..16 {
            let mut components = self.channels.iter().flat_map(|channel| &channel.components);
            let Some(writer) = components.rfind(|component| component.outputs.contains(&at)) else { return false };
            match &writer.kind {
                Kind::Actuator { .. } | Kind::Kinematic { .. } | Kind::Lag { .. } => return true,
                Kind::Scale { .. } | Kind::Gain { .. } | Kind::Scheduled { .. } | Kind::Deadband { .. } => {}
                _ => return false,
            }
            let Some(Parameter::Property(input, _)) = writer.inputs.first() else { return false };
            at = *input;
        }
        false
    }

    /// How the values of a property follow from those of another through a scale or a drive; looked for through lags and
    /// actuators.
    pub(super) fn scaling(&self, property: usize) -> Option<Scaling> {
        let mut at = property;
        // A circle of components has no end.
        for _ in 0..16 {
            let mut components = self.channels.iter().flat_map(|channel| &channel.components);
            let writer = components.rfind(|component| component.outputs.contains(&at))?;
            let input = match *writer.inputs.first()? {
                Parameter::Property(index, sign) => (index, sign),
                Parameter::Number(_) => return None,
            };
            match &writer.kind {
                Kind::Scale { gain: Parameter::Number(gain), domain, range, centred } => {
                    let range = range.map(|end| end * gain);
                    return Some(Scaling { input, domain: *domain, range, centred: *centred });
                }
                Kind::Kinematic { positions, scaled, .. } => {
                    let range = [*positions.first()?, *positions.last()?];
                    let domain = if *scaled { [-1.0, 1.0] } else { range };
                    return Some(Scaling { input, domain, range, centred: false });
                }
                Kind::Actuator { .. } | Kind::Lag { .. } => at = input.0,
                _ => return None,
            }
        }
        None
    }

    /// Number of components.
    pub(super) fn len(&self) -> usize {
        self.channels.iter().map(|channel| channel.components.len()).sum()
    }

    /// Runs all channels once. `step_s` is the time between two steps. Unless it is `counted`, those that run in one of several
    /// steps run too, and it is not one of those steps.
    pub(super) fn step(&self, model: &Model, state: &mut State, memories: &mut Memories, step_s: f64, counted: bool) {
        state.hold(model, &self.before, true);
        for &(command, position) in &self.followed {
            let value = state.read(model, command);
            state.write(model, position, value);
        }
        let memory = memories.components.iter_mut().zip(&mut memories.waited);
        for (channel, (memories, waited)) in self.channels.iter().zip(memory) {
            if channel.execute.is_some_and(|property| state.read(model, property) == 0.0) {
                continue;
            }
            if counted {
                if *waited >= channel.rate {
                    *waited = 0;
                }
                *waited += 1;
                if *waited < channel.rate {
                    continue;
                }
            }
            for (component, memory) in channel.components.iter().zip(memories) {
                component.run(model, state, memory, step_s * f64::from(channel.rate));
            }
        }
        state.hold(model, &self.after, true);
    }
}

impl Parameter {
    fn value(self, model: &Model, state: &mut State) -> f64 {
        match self {
            Self::Number(value) => value,
            Self::Property(index, sign) => sign * state.read(model, index),
        }
    }
}
