//! Reads systems, autopilots and flight control.

use roxmltree::Node;

use super::super::error::{JsbsimError, Omission};
use super::super::function::{self, named_property};
use super::super::model::Model;
use super::super::source::{Source, child, children, parse, shortened, tag, text};
use super::component::{Clip, Comparison, Component, Delay, Kind, Parameter, Rule, Test};
use super::{Channel, Channels};

/// What reading needs in every place.
struct Reader<'a> {
    model: &'a mut Model,
    source: &'a Source,
    omitted: &'a mut Vec<Omission>,
}

impl Channels {
    /// Reads the properties that a `<system>`, `<autopilot>` or `<flight_control>` declares.
    pub(in crate::jsbsim) fn read_properties(
        model: &mut Model,
        source: &Source,
        node: Node<'_, '_>,
    ) -> Result<(), JsbsimError> {
        for part in children(node).filter(|part| tag(*part) == "property") {
            super::super::declare(model, source, part)?;
        }
        Ok(())
    }

    /// Reads the channels and functions of a `<system>`, `<autopilot>` or `<flight_control>`.
    pub(in crate::jsbsim) fn read(
        &mut self,
        model: &mut Model,
        source: &Source,
        node: Node<'_, '_>,
        omitted: &mut Vec<Omission>,
    ) -> Result<(), JsbsimError> {
        let mut reader = Reader { model, source, omitted };
        for part in children(node) {
            match tag(part) {
                "channel" => {
                    let channel = reader.channel(part)?;
                    self.channels.push(channel);
                }
                "function" => match function::read(reader.model, source, part) {
                    Ok(made) if part.attribute("type") == Some("post") => self.after.push(made),
                    Ok(made) => self.before.push(made),
                    Err(error) => reader.leave_out(part, error),
                },
                "property" | "description" | "documentation" | "limitation" | "note" => {}
                other => reader.omitted.push(source.omit(part, format!("<{}> is left out", shortened(other)))),
            }
        }
        Ok(())
    }
}

impl Reader<'_> {
    /// Notes that a function or a component is left out because it is not understood.
    fn leave_out(&mut self, node: Node<'_, '_>, error: JsbsimError) {
        let why = match error {
            JsbsimError::Refused { what, line, .. } if line == self.source.line(node) => what,
            JsbsimError::Refused { what, line, .. } => format!("line {line}: {what}"),
            other => other.to_string(),
        };
        let name = node.attribute("name").unwrap_or_default();
        let what = format!(
            "<{} name=\"{}\"> is left out, and what it would write keeps its value: {why}",
            tag(node),
            shortened(name)
        );
        self.omitted.push(self.source.omit(node, what));
        // A name that cannot be one makes no property in JSBSim either.
        let outputs = match tag(node) {
            "function" if function::is_property_name(name) => vec![self.model.property(name)],
            "function" => Vec::new(),
            _ => self.outputs(node).unwrap_or_default(),
        };
        for output in outputs {
            self.model.properties[output].left_out = true;
        }
    }

    fn channel(&mut self, node: Node<'_, '_>) -> Result<Channel, JsbsimError> {
        let execute = match node.attribute("execute").map(str::trim) {
            None | Some("") => None,
            Some(name) => Some(named_property(self.model, self.source, node, name)?.0),
        };
        let rate = match node.attribute("execrate") {
            None => 1.0,
            Some(rate) => {
                let good = parse(rate).filter(|rate| (1.0..=1e6).contains(rate));
                good.ok_or_else(|| self.source.refuse(node, "execrate is not a number of steps from 1 on"))?
            }
        };
        let mut channel = Channel { execute, rate: rate as u32, components: Vec::new() };
        for part in children(node) {
            if matches!(tag(part), "description" | "documentation" | "note") {
                continue;
            }
            match self.component(part) {
                Ok(component) => channel.components.push(component),
                Err(error) => self.leave_out(part, error),
            }
        }
        Ok(channel)
    }

    /// The number or property in a text.
    fn parameter(&mut self, node: Node<'_, '_>, text: &str) -> Result<Parameter, JsbsimError> {
        if let Some(number) = parse(text) {
            return Ok(Parameter::Number(number));
        }
        let (index, sign) = named_property(self.model, self.source, node, text)?;
        Ok(Parameter::Property(index, sign))
    }

    fn child_parameter(&mut self, node: Node<'_, '_>, name: &str) -> Result<Option<Parameter>, JsbsimError> {
        child(node, name).map(|found| self.parameter(found, &text(found))).transpose()
    }

    fn parameter_or(&mut self, node: Node<'_, '_>, name: &str, otherwise: f64) -> Result<Parameter, JsbsimError> {
        Ok(self.child_parameter(node, name)?.unwrap_or(Parameter::Number(otherwise)))
    }

    fn component(&mut self, node: Node<'_, '_>) -> Result<Component, JsbsimError> {
        let mut inputs = Vec::new();
        for input in children(node).filter(|part| tag(*part) == "input") {
            inputs.push(self.parameter(input, &text(input))?);
        }
        let kind = self.kind(node)?;
        let needs_input = !matches!(kind, Kind::Summer { .. } | Kind::Switch { .. } | Kind::Function(_));
        if needs_input && inputs.is_empty() {
            return Err(self.source.refuse(node, format!("<{}> has no <input>", tag(node))));
        }
        let clip = match child(node, "clipto") {
            None => None,
            Some(found) => {
                let limits = (self.child_parameter(found, "min")?, self.child_parameter(found, "max")?);
                let (Some(least), Some(most)) = limits else {
                    return Err(self.source.refuse(found, "<clipto> has no <min> and <max>"));
                };
                Some(Clip { least, most, cyclic: found.attribute("type") == Some("cyclic") })
            }
        };
        let delay = match child(node, "delay") {
            None => None,
            Some(found) => {
                let time = self.source.number(found)?;
                Some(if found.attribute("type") == Some("frames") { Delay::Steps(time) } else { Delay::Seconds(time) })
            }
        };
        // What is written is made last, as JSBSim does: a name counts as there from here on.
        let outputs = self.outputs(node)?;
        for &output in &outputs {
            self.model.properties[output].declared = true;
        }
        Ok(Component { inputs, outputs, clip, delay, kind })
    }

    /// The properties that a component writes: those of its `<output>` and that of its name.
    fn outputs(&mut self, node: Node<'_, '_>) -> Result<Vec<usize>, JsbsimError> {
        let mut outputs = Vec::new();
        for output in children(node).filter(|part| tag(*part) == "output") {
            outputs.push(named_property(self.model, self.source, output, &text(output))?.0);
        }
        let name = node.attribute("name").unwrap_or_default().trim();
        if !name.is_empty() {
            let own = if name.contains('/') {
                name.to_owned()
            } else {
                format!("fcs/{}", name.to_lowercase().replace(char::is_whitespace, "-"))
            };
            outputs.push(named_property(self.model, self.source, node, &own)?.0);
        }
        Ok(outputs)
    }

    fn kind(&mut self, node: Node<'_, '_>) -> Result<Kind, JsbsimError> {
        let source = self.source;
        let number = |name: &str| source.child_number(node, name).map(|found| found.unwrap_or(0.0));
        Ok(match tag(node) {
            "summer" => Kind::Summer { bias: number("bias")? },
            "pure_gain" => Kind::Gain { gain: self.parameter_or(node, "gain", 1.0)? },
            "scheduled_gain" => {
                let table = child(node, "table").ok_or_else(|| source.refuse(node, "the gain has no <table>"))?;
                let table = function::read_table(self.model, source, table)?;
                Kind::Scheduled { gain: self.parameter_or(node, "gain", 1.0)?, table }
            }
            "aerosurface_scale" => {
                let ends = |name: &str| -> Result<Option<[f64; 2]>, JsbsimError> {
                    let Some(found) = child(node, name) else { return Ok(None) };
                    let ends = (source.child_number(found, "min")?, source.child_number(found, "max")?);
                    Ok(if let (Some(least), Some(most)) = ends { Some([least, most]) } else { None })
                };
                let domain = ends("domain")?.unwrap_or([-1.0, 1.0]);
                let range = ends("range")?.ok_or_else(|| source.refuse(node, "the scale has no <range>"))?;
                let centred = child(node, "zero_centered").map(text);
                let centred = !matches!(centred.as_deref(), Some("0" | "false"));
                Kind::Scale { gain: self.parameter_or(node, "gain", 1.0)?, domain, range, centred }
            }
            "kinematic" => {
                let (mut positions, mut times) = (Vec::new(), Vec::new());
                let through = child(node, "traverse").ok_or_else(|| source.refuse(node, "there is no <traverse>"))?;
                for setting in children(through).filter(|part| tag(*part) == "setting") {
                    let place = source.child_number(setting, "position")?.unwrap_or(0.0);
                    if positions.last().is_some_and(|&last| last >= place) {
                        return Err(source.refuse(setting, "the positions do not increase"));
                    }
                    positions.push(place);
                    times.push(source.child_number(setting, "time")?.unwrap_or(0.0));
                }
                if positions.len() < 2 {
                    return Err(source.refuse(node, "there are fewer than two positions"));
                }
                Kind::Kinematic { positions, times, scaled: child(node, "noscale").is_none() }
            }
            "lag_filter" => Kind::Lag { c: self.coefficients(node)? },
            "lead_lag_filter" => Kind::LeadLag { c: self.coefficients(node)? },
            "washout_filter" => Kind::Washout { c: self.coefficients(node)? },
            "second_order_filter" => Kind::SecondOrder { c: self.coefficients(node)? },
            "integrator" => {
                let c1 = child(node, "c1").ok_or_else(|| source.refuse(node, "the integrator has no <c1>"))?;
                let rule = rule(c1.attribute("type").unwrap_or("trap"));
                let integral = self.parameter(c1, &text(c1))?;
                self.pid(node, integral, rule)?
            }
            "pid" => {
                let (integral, rule) = match child(node, "ki") {
                    None => (Parameter::Number(0.0), Rule::None),
                    Some(ki) => (self.parameter(ki, &text(ki))?, rule(ki.attribute("type").unwrap_or_default())),
                };
                self.pid(node, integral, rule)?
            }
            "switch" => self.switch(node)?,
            "fcs_function" => {
                let inside = child(node, "function").ok_or_else(|| source.refuse(node, "there is no <function>"))?;
                Kind::Function(function::read(self.model, source, inside)?)
            }
            "deadband" => {
                let gain = source.child_number(node, "gain")?.unwrap_or(1.0);
                Kind::Deadband { width: self.parameter_or(node, "width", 0.0)?, gain }
            }
            "sensor" => self.sensor(node)?,
            "actuator" => {
                let (mut faster, mut slower) = (None, None);
                for limit in children(node).filter(|part| tag(*part) == "rate_limit") {
                    let value = Some(self.parameter(limit, &text(limit))?);
                    match limit.attribute("sense").unwrap_or_default() {
                        sense if sense.starts_with("inc") => faster = value,
                        sense if sense.starts_with("dec") => slower = value,
                        _ => (faster, slower) = (value, value),
                    }
                }
                if let Some(lag) = child(node, "lag")
                    && parse(&text(lag)) == Some(0.0)
                {
                    let what = "the lag of the actuator is 0: as in JSBSim, it keeps its first value for ever";
                    self.omitted.push(source.omit(lag, what));
                }
                Kind::Actuator {
                    lag: self.child_parameter(node, "lag")?,
                    faster,
                    slower,
                    deadband: number("deadband_width")?,
                    hysteresis: number("hysteresis_width")?,
                    bias: number("bias")?,
                }
            }
            other => {
                return Err(source.refuse(node, format!("the component <{}> is not supported", shortened(other))));
            }
        })
    }

    fn coefficients(&mut self, node: Node<'_, '_>) -> Result<[Parameter; 6], JsbsimError> {
        let mut c = [Parameter::Number(0.0); 6];
        for (value, name) in c.iter_mut().zip(["c1", "c2", "c3", "c4", "c5", "c6"]) {
            *value = self.parameter_or(node, name, 0.0)?;
        }
        Ok(c)
    }

    fn pid(&mut self, node: Node<'_, '_>, integral: Parameter, rule: Rule) -> Result<Kind, JsbsimError> {
        Ok(Kind::Pid {
            proportional: self.parameter_or(node, "kp", 0.0)?,
            integral,
            derivative: self.parameter_or(node, "kd", 0.0)?,
            rule,
            standard: node.attribute("type") == Some("standard"),
            trigger: self.child_parameter(node, "trigger")?,
            rate: self.child_parameter(node, "pvdot")?,
        })
    }

    fn switch(&mut self, node: Node<'_, '_>) -> Result<Kind, JsbsimError> {
        let mut default = Parameter::Number(0.0);
        let mut tests = Vec::new();
        for part in children(node) {
            let name = tag(part);
            if name != "default" && name != "test" {
                continue;
            }
            let value = part.attribute("value").unwrap_or_default().trim();
            let value = self.parameter(part, value)?;
            if name == "default" {
                default = value;
            } else {
                tests.push((self.test(part)?, value));
            }
        }
        Ok(Kind::Switch { default, tests })
    }

    fn test(&mut self, node: Node<'_, '_>) -> Result<Test, JsbsimError> {
        let mut parts = Vec::new();
        for line in text(node).lines().map(str::trim).filter(|line| !line.is_empty()) {
            let words: Vec<_> = line.split_whitespace().collect();
            let [left, comparison, right] = words.as_slice() else {
                return Err(self.source.refuse(node, format!("\"{}\" is no comparison", shortened(line))));
            };
            let comparison = match *comparison {
                "==" | "EQ" | "eq" => Comparison::Equal,
                "!=" | "NE" | "ne" => Comparison::Unequal,
                "<" | "LT" | "lt" => Comparison::Less,
                "<=" | "LE" | "le" => Comparison::LessOrEqual,
                ">" | "GT" | "gt" => Comparison::Greater,
                ">=" | "GE" | "ge" => Comparison::GreaterOrEqual,
                other => {
                    return Err(self
                        .source
                        .refuse(node, format!("the comparison \"{}\" is not known", shortened(other))));
                }
            };
            let (left, right) = (self.parameter(node, left)?, self.parameter(node, right)?);
            parts.push(Test::Compare(left, comparison, right));
        }
        for inside in children(node).filter(|part| tag(*part) == "test") {
            parts.push(self.test(inside)?);
        }
        if parts.is_empty() {
            return Err(self.source.refuse(node, "the test compares nothing"));
        }
        match node.attribute("logic").map(str::trim) {
            None | Some("" | "AND") => Ok(Test::All(parts)),
            Some("OR") => Ok(Test::Any(parts)),
            Some(other) => Err(self.source.refuse(node, format!("logic=\"{}\" is not known", shortened(other)))),
        }
    }

    fn sensor(&mut self, node: Node<'_, '_>) -> Result<Kind, JsbsimError> {
        let source = self.source;
        let number = |name: &str| source.child_number(node, name).map(|found| found.unwrap_or(0.0));
        let mut quantised = None;
        if let Some(part) = child(node, "quantization") {
            let of = |name: &str| source.child_number(part, name).map(|found| found.unwrap_or(0.0));
            let (bits, least, most) = (of("bits")?, of("min")?, of("max")?);
            if !((1.0..=30.0).contains(&bits) && least < most) {
                return Err(source.refuse(part, "the quantization has no bits from 1 to 30, or no span"));
            }
            quantised = Some([least, most, (most - least) / bits.trunc().exp2()]);
        }
        if let Some(noise) = child(node, "noise")
            && source.number(noise)? != 0.0
        {
            self.omitted.push(source.omit(noise, "<noise> is left out: the sensor is free of noise"));
        }
        Ok(Kind::Sensor {
            lag: number("lag")?,
            drift: number("drift_rate")?,
            gain: number("gain")?,
            bias: number("bias")?,
            quantised,
        })
    }
}

fn rule(name: &str) -> Rule {
    match name.trim() {
        "rect" => Rule::Rectangle,
        "trap" => Rule::Trapezoid,
        "ab3" => Rule::AdamsBashforth3,
        _ => Rule::AdamsBashforth2,
    }
}
