//! One step of a component, discretised as JSBSim does it: filters by the bilinear rule.

use super::super::model::{Model, State};
use super::component::{Clip, Comparison, Component, Delay, Kind, Memory, Parameter, Rule, Test};

/// Most values that a delay keeps.
const MAX_WAITING: f64 = 1e5;

impl Component {
    /// Runs once; `dt` is the time since it ran last, s.
    pub(in crate::jsbsim) fn run(&self, model: &Model, state: &mut State, memory: &mut Memory, dt: f64) {
        let input = self.inputs.first().map_or(0.0, |input| input.value(model, state));
        let mut output = match &self.kind {
            Kind::Summer { bias } => {
                let mut sum = 0.0;
                for input in &self.inputs {
                    sum += input.value(model, state);
                }
                sum + bias
            }
            Kind::Gain { gain } => gain.value(model, state) * input,
            Kind::Scheduled { gain, table } => {
                let scheduled = state.look_up(model, *table);
                gain.value(model, state) * scheduled * input
            }
            Kind::Scale { gain, domain, range, centred } => {
                let scaled = match (centred, input) {
                    (false, _) => range[0] + (input - domain[0]) / (domain[1] - domain[0]) * (range[1] - range[0]),
                    (true, 0.0) => 0.0,
                    (true, input) if input > 0.0 => input / domain[1] * range[1],
                    (true, input) => input / domain[0] * range[0],
                };
                gain.value(model, state) * scaled
            }
            Kind::Kinematic { positions, times, scaled } => {
                let last = positions.last().copied().unwrap_or(0.0);
                let wanted = if *scaled { input * last } else { input };
                let from = self.outputs.first().map_or(memory.output, |&output| state.read(model, output));
                travel(positions, times, from, wanted, dt)
            }
            Kind::Lag { c } | Kind::LeadLag { c } | Kind::Washout { c } | Kind::SecondOrder { c } => {
                let c = c.map(|parameter| parameter.value(model, state));
                filter(&self.kind, c, memory, input, dt)
            }
            Kind::Pid { .. } => self.pid(model, state, memory, input, dt),
            Kind::Switch { default, tests } => {
                let mut value = *default;
                for (test, then) in tests {
                    if test.holds(model, state) {
                        value = *then;
                        break;
                    }
                }
                value.value(model, state)
            }
            Kind::Function(function) => {
                let value = state.call(model, *function);
                if self.inputs.is_empty() { value } else { value * input }
            }
            Kind::Deadband { width, gain } => deadband(input, width.value(model, state)) * gain,
            Kind::Sensor { .. } => self.sense(memory, input, dt),
            Kind::Actuator { .. } => self.act(model, state, memory, input, dt),
        };
        if !matches!(self.kind, Kind::Sensor { .. } | Kind::Actuator { .. }) {
            output = self.late(memory, output, dt);
        }
        if let Kind::Sensor { quantised: Some([least, most, step]), .. } = self.kind {
            output = output.max(least).min(most);
            output = least + ((output - least) / step).trunc() * step;
        }
        if let Some(clip) = self.clip {
            output = clip.apply(model, state, output);
        }
        memory.started = true;
        memory.output = output;
        for &written in &self.outputs {
            state.write(model, written, output);
        }
    }

    /// The output that is due now.
    fn late(&self, memory: &mut Memory, output: f64, dt: f64) -> f64 {
        let steps = match self.delay {
            None => return output,
            Some(Delay::Seconds(seconds)) => (seconds / dt).trunc(),
            Some(Delay::Steps(steps)) => steps.trunc(),
        };
        if steps.is_nan() || steps < 1.0 {
            return output;
        }
        // JSBSim's ring of n values gives back the one of n - 1 steps before.
        let kept = steps.min(MAX_WAITING) as usize;
        memory.waiting.push_back(output);
        if memory.waiting.len() < kept {
            return 0.0;
        }
        memory.waiting.pop_front().unwrap_or(output)
    }

    fn pid(&self, model: &Model, state: &mut State, memory: &mut Memory, input: f64, dt: f64) -> f64 {
        let Kind::Pid { proportional, integral, derivative, rule, standard, trigger, rate } = &self.kind else {
            return input;
        };
        let [before, before2] = memory.inputs;
        let slope = match rate {
            Some(rate) => rate.value(model, state),
            None => (input - before) / dt,
        };
        let test = trigger.map_or(0.0, |trigger| trigger.value(model, state));
        let mut added = 0.0;
        if test.abs() < 1e-6 {
            added = match rule {
                Rule::None => 0.0,
                Rule::Rectangle => input,
                Rule::Trapezoid => 0.5 * (input + before),
                Rule::AdamsBashforth2 => 1.5 * input - 0.5 * before,
                Rule::AdamsBashforth3 => (23.0 * input - 16.0 * before + 5.0 * before2) / 12.0,
            };
        }
        if test < 0.0 {
            memory.total = 0.0;
        }
        memory.total += integral.value(model, state) * dt * added;
        memory.inputs = [input, if test < 0.0 { 0.0 } else { before }];
        let (p, d) = (proportional.value(model, state), derivative.value(model, state));
        if *standard { p * (input + memory.total + d * slope) } else { p * input + memory.total + d * slope }
    }

    fn sense(&self, memory: &mut Memory, input: f64, dt: f64) -> f64 {
        let Kind::Sensor { lag, drift, gain, bias, .. } = self.kind else { return input };
        let mut output = input;
        if lag != 0.0 {
            let below = 2.0 + dt * lag;
            output = dt * lag / below * (input + memory.inputs[0]) + (2.0 - dt * lag) / below * memory.outputs[0];
            memory.inputs[0] = input;
            memory.outputs[0] = output;
        }
        if drift != 0.0 {
            memory.total += drift * dt;
            output += memory.total;
        }
        if gain != 0.0 {
            output *= gain;
        }
        self.late(memory, output + bias, dt)
    }

    fn act(&self, model: &Model, state: &mut State, memory: &mut Memory, input: f64, dt: f64) -> f64 {
        let Kind::Actuator { lag, faster, slower, deadband: width, hysteresis, bias } = self.kind else {
            return input;
        };
        let mut output = input;
        if let Some(lag) = lag {
            let lag = lag.value(model, state);
            if memory.started {
                let below = 2.0 + dt * lag;
                output = dt * lag / below * (input + memory.inputs[0]) + (2.0 - dt * lag) / below * memory.outputs[0];
            }
            memory.inputs[0] = input;
            memory.outputs[0] = output;
        }
        if faster.is_some() || slower.is_some() {
            if memory.started {
                let change = output - memory.limited;
                if let Some(most) = faster.map(|limit| dt * limit.value(model, state))
                    && change > most
                {
                    output = memory.limited + most;
                }
                if let Some(least) = slower.map(|limit| -dt * limit.value(model, state))
                    && change < least
                {
                    output = memory.limited + least;
                }
            }
            memory.limited = output;
        }
        if width != 0.0 {
            output = deadband(output, width);
        }
        if hysteresis != 0.0 {
            if memory.started {
                if output > memory.held {
                    output = memory.held.max(output - 0.5 * hysteresis);
                } else if output < memory.held {
                    output = memory.held.min(output + 0.5 * hysteresis);
                }
            }
            memory.held = output;
        }
        self.late(memory, output + bias, dt)
    }
}

fn deadband(input: f64, width: f64) -> f64 {
    let half = 0.5 * width;
    if input < -half {
        input + half
    } else if input > half {
        input - half
    } else {
        0.0
    }
}

/// A filter by the bilinear rule. Its first step gives 0, whatever its input is, as in JSBSim.
fn filter(kind: &Kind, c: [f64; 6], memory: &mut Memory, input: f64, dt: f64) -> f64 {
    if !memory.started {
        return 0.0;
    }
    let ([x1, x2], [y1, y2]) = (memory.inputs, memory.outputs);
    let [c1, c2, c3, c4, c5, c6] = c;
    let output = match kind {
        Kind::Lag { .. } => {
            let below = 2.0 + dt * c1;
            (input + x1) * (dt * c1 / below) + y1 * ((2.0 - dt * c1) / below)
        }
        Kind::LeadLag { .. } => {
            let below = 2.0 * c3 + dt * c4;
            (input * (2.0 * c1 + dt * c2) + x1 * (dt * c2 - 2.0 * c1) + y1 * (2.0 * c3 - dt * c4)) / below
        }
        Kind::Washout { .. } => {
            let below = 2.0 + dt * c1;
            ((input - x1) * 2.0 + y1 * (2.0 - dt * c1)) / below
        }
        _ => {
            let dt2 = dt * dt;
            let below = 4.0 * c4 + 2.0 * c5 * dt + c6 * dt2;
            let above = input * (4.0 * c1 + 2.0 * c2 * dt + c3 * dt2)
                + x1 * (2.0 * c3 * dt2 - 8.0 * c1)
                + x2 * (4.0 * c1 - 2.0 * c2 * dt + c3 * dt2);
            (above - y1 * (2.0 * c6 * dt2 - 8.0 * c4) - y2 * (4.0 * c4 - 2.0 * c5 * dt + c6 * dt2)) / below
        }
    };
    memory.inputs = [input, x1];
    memory.outputs = [output, y1];
    output
}

/// Moves from a position towards another for a time, through positions with a time between each and the one before.
fn travel(positions: &[f64], times: &[f64], from: f64, wanted: f64, time: f64) -> f64 {
    let (Some(&first), Some(&last)) = (positions.first(), positions.last()) else { return wanted };
    let wanted = wanted.max(first).min(last);
    let (mut at, mut left) = (from, time);
    // At most one interval is left behind in each round.
    for _ in 0..=positions.len() {
        if left <= 0.0 || (wanted - at).abs() <= 2.0 * f64::EPSILON * wanted.abs().max(at.abs()) {
            break;
        }
        let falling = wanted < at;
        let next = (1..positions.len()).find(|&k| if falling { positions[k] >= at } else { positions[k] > at });
        let Some(next) = next else { break };
        if times[next] <= 0.0 {
            return wanted;
        }
        let (low, high) = (positions[next - 1], positions[next]);
        let rate = (high - low) / times[next];
        let target = wanted.max(low).min(high);
        let needed = ((target - at) / rate).abs();
        if left < needed {
            at += if at < wanted { left * rate } else { -left * rate };
            break;
        }
        at = target;
        left -= needed;
    }
    at
}

impl Clip {
    fn apply(&self, model: &Model, state: &mut State, value: f64) -> f64 {
        let (least, most) = (self.least.value(model, state), self.most.value(model, state));
        let range = most - least;
        if self.cyclic && range > 0.0 {
            let turned = (value - least) % range + least;
            return if turned < least { turned + range } else { turned };
        }
        // In this order, so that crossed limits give the lower one and never panic.
        if value < least {
            least
        } else if value > most {
            most
        } else {
            value
        }
    }
}

impl Test {
    fn holds(&self, model: &Model, state: &mut State) -> bool {
        match self {
            Self::All(tests) => tests.iter().all(|test| test.holds(model, state)),
            Self::Any(tests) => tests.iter().any(|test| test.holds(model, state)),
            Self::Compare(a, comparison, b) => {
                let (a, b) = (Parameter::value(*a, model, state), Parameter::value(*b, model, state));
                match comparison {
                    Comparison::Equal => a == b,
                    Comparison::Unequal => a != b,
                    Comparison::Less => a < b,
                    Comparison::LessOrEqual => a <= b,
                    Comparison::Greater => a > b,
                    Comparison::GreaterOrEqual => a >= b,
                }
            }
        }
    }
}
