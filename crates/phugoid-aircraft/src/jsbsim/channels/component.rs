//! What a component of a channel is made of, and what it remembers.

/// A number, or the value of a property times a sign.
#[derive(Debug, Clone, Copy)]
pub(in crate::jsbsim) enum Parameter {
    /// A number.
    Number(f64),
    /// A property and its sign.
    Property(usize, f64),
}

/// One component.
#[derive(Debug, Clone)]
pub(in crate::jsbsim) struct Component {
    /// What it reads, each with its sign.
    pub(super) inputs: Vec<Parameter>,
    /// The properties that it writes.
    pub(in crate::jsbsim) outputs: Vec<usize>,
    pub(super) clip: Option<Clip>,
    pub(super) delay: Option<Delay>,
    pub(super) kind: Kind,
}

/// Limits of an output.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clip {
    pub(super) least: Parameter,
    pub(super) most: Parameter,
    /// Whether what is beyond a limit comes in again at the other one, as an angle does.
    pub(super) cyclic: bool,
}

/// How long an output comes too late.
#[derive(Debug, Clone, Copy)]
pub(super) enum Delay {
    Seconds(f64),
    Steps(f64),
}

/// What a component does.
#[derive(Debug, Clone)]
pub(in crate::jsbsim) enum Kind {
    /// Adds its inputs and a constant.
    Summer { bias: f64 },
    /// Multiplies.
    Gain { gain: Parameter },
    /// Multiplies by a table.
    Scheduled { gain: Parameter, table: usize },
    /// Maps an interval to another: about zero on both sides apart, or from end to end.
    Scale { gain: Parameter, domain: [f64; 2], range: [f64; 2], centred: bool },
    /// Moves through positions in given times.
    Kinematic { positions: Vec<f64>, times: Vec<f64>, scaled: bool },
    /// C1 / (s + C1).
    Lag { c: [Parameter; 6] },
    /// (C1 s + C2) / (C3 s + C4).
    LeadLag { c: [Parameter; 6] },
    /// s / (s + C1).
    Washout { c: [Parameter; 6] },
    /// (C1 s2 + C2 s + C3) / (C4 s2 + C5 s + C6).
    SecondOrder { c: [Parameter; 6] },
    /// Proportional, integrating and differentiating.
    Pid {
        proportional: Parameter,
        integral: Parameter,
        derivative: Parameter,
        rule: Rule,
        standard: bool,
        trigger: Option<Parameter>,
        rate: Option<Parameter>,
    },
    /// The value of the first test that holds, or that by default.
    Switch { default: Parameter, tests: Vec<(Test, Parameter)> },
    /// The value of a function, times the input if there is one.
    Function(usize),
    /// Nothing within a width about zero.
    Deadband { width: Parameter, gain: f64 },
    /// What an instrument makes of its input.
    Sensor { lag: f64, drift: f64, gain: f64, bias: f64, quantised: Option<[f64; 3]> },
    /// What a drive makes of its input.
    Actuator {
        /// A lag of 0 holds the first value for ever, as in JSBSim.
        lag: Option<Parameter>,
        faster: Option<Parameter>,
        slower: Option<Parameter>,
        deadband: f64,
        hysteresis: f64,
        bias: f64,
    },
}

/// How an integral is made of the input's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::jsbsim) enum Rule {
    None,
    Rectangle,
    Trapezoid,
    AdamsBashforth2,
    AdamsBashforth3,
}

/// Something that holds or does not.
#[derive(Debug, Clone)]
pub(in crate::jsbsim) enum Test {
    All(Vec<Test>),
    Any(Vec<Test>),
    Compare(Parameter, Comparison, Parameter),
}

/// How two values are compared.
#[derive(Debug, Clone, Copy)]
#[rustfmt::skip]
pub(in crate::jsbsim) enum Comparison { Equal, Unequal, Less, LessOrEqual, Greater, GreaterOrEqual }

/// What a component remembers from one step to the next.
#[derive(Debug, Clone, Default)]
pub(in crate::jsbsim) struct Memory {
    /// Whether it has run before.
    pub(super) started: bool,
    /// Inputs of the two steps before.
    pub(super) inputs: [f64; 2],
    /// Outputs of the two steps before.
    pub(super) outputs: [f64; 2],
    /// Integral, or drift.
    pub(super) total: f64,
    /// Output of the rate limit of the step before.
    pub(super) limited: f64,
    /// Output of the hysteresis of the step before.
    pub(super) held: f64,
    /// Outputs that are still to come.
    pub(super) waiting: std::collections::VecDeque<f64>,
    /// Output of the step before.
    pub(super) output: f64,
}

impl Component {
    /// Properties that it reads itself.
    pub(super) fn reads(&self) -> Vec<usize> {
        let mut read: Vec<Parameter> = self.inputs.clone();
        read.extend(self.clip.iter().flat_map(|clip| [clip.least, clip.most]));
        match &self.kind {
            Kind::Gain { gain } | Kind::Scheduled { gain, .. } | Kind::Scale { gain, .. } => read.push(*gain),
            Kind::Lag { c } | Kind::LeadLag { c } | Kind::Washout { c } | Kind::SecondOrder { c } => read.extend(c),
            Kind::Pid { proportional, integral, derivative, trigger, rate, .. } => {
                read.extend([*proportional, *integral, *derivative]);
                read.extend(trigger.iter().chain(rate));
            }
            Kind::Switch { default, tests } => {
                read.push(*default);
                for (test, value) in tests {
                    read.push(*value);
                    test.reads(&mut read);
                }
            }
            Kind::Deadband { width, .. } => read.push(*width),
            Kind::Actuator { lag, faster, slower, .. } => {
                read.extend(lag.iter().chain(faster).chain(slower));
            }
            Kind::Summer { .. } | Kind::Kinematic { .. } | Kind::Function(_) | Kind::Sensor { .. } => {}
        }
        let property = |parameter: Parameter| match parameter {
            Parameter::Property(index, _) => Some(index),
            Parameter::Number(_) => None,
        };
        read.into_iter().filter_map(property).collect()
    }
}

impl Test {
    fn reads(&self, read: &mut Vec<Parameter>) {
        match self {
            Self::All(tests) | Self::Any(tests) => tests.iter().for_each(|test| test.reads(read)),
            Self::Compare(a, _, b) => read.extend([*a, *b]),
        }
    }
}
