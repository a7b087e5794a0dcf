//! Functions of JSBSim, compiled from their elements to operations on a stack.

use roxmltree::Node;

use super::error::JsbsimError;
use super::model::{Function, Lookup, Model};
use super::source::{Source, children, shortened, tag, text};
use super::table::Table;

/// One operation of a function.
#[derive(Debug, Clone, Copy)]
pub(super) enum Op {
    /// Puts a number on the stack.
    Constant(f64),
    /// Puts the value of a property on the stack, times a sign.
    Property(usize, f64),
    /// Puts the value of a table on the stack.
    Table(usize),
    /// Replaces as many numbers from the top of the stack by one.
    Apply(Action, usize),
}

/// What replaces some numbers by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[rustfmt::skip]
pub(crate) enum Action {
    Sum, Difference, Product, Quotient, Pow, Sqrt, Exp, Log2, Ln, Log10, Abs, Sign, Fmod, Mod, Sin, Cos, Tan, Asin, Acos,
    Atan, Atan2, Min, Max, Avg, Fraction, Integer, Floor, Ceil, RoundMultiple, ToRadians, ToDegrees, Lt, Le, Gt, Ge, Eq,
    Nq, And, Or, Not, IfThen, Switch, Interpolate,
}

/// The action of an element, with the fewest and the most arguments that it takes.
fn action(name: &str) -> Option<(Action, usize, usize)> {
    use Action as A;
    const MANY: usize = usize::MAX;
    Some(match name {
        "sum" => (A::Sum, 1, MANY),
        "difference" => (A::Difference, 1, MANY),
        "product" => (A::Product, 1, MANY),
        "quotient" => (A::Quotient, 2, 2),
        "pow" => (A::Pow, 2, 2),
        "sqrt" => (A::Sqrt, 1, 1),
        "exp" => (A::Exp, 1, 1),
        "log2" => (A::Log2, 1, 1),
        "ln" => (A::Ln, 1, 1),
        "log10" => (A::Log10, 1, 1),
        "abs" => (A::Abs, 1, 1),
        "sign" => (A::Sign, 1, 1),
        "fmod" => (A::Fmod, 2, 2),
        "mod" => (A::Mod, 2, 2),
        "sin" => (A::Sin, 1, 1),
        "cos" => (A::Cos, 1, 1),
        "tan" => (A::Tan, 1, 1),
        "asin" => (A::Asin, 1, 1),
        "acos" => (A::Acos, 1, 1),
        "atan" => (A::Atan, 1, 1),
        "atan2" => (A::Atan2, 2, 2),
        "min" => (A::Min, 1, MANY),
        "max" => (A::Max, 1, MANY),
        "avg" => (A::Avg, 1, MANY),
        "fraction" => (A::Fraction, 1, 1),
        "integer" => (A::Integer, 1, 1),
        "floor" => (A::Floor, 1, 1),
        "ceil" => (A::Ceil, 1, 1),
        "roundmultiple" => (A::RoundMultiple, 1, 2),
        "toradians" => (A::ToRadians, 1, 1),
        "todegrees" => (A::ToDegrees, 1, 1),
        "lt" => (A::Lt, 2, 2),
        "le" => (A::Le, 2, 2),
        "gt" => (A::Gt, 2, 2),
        "ge" => (A::Ge, 2, 2),
        "eq" => (A::Eq, 2, 2),
        "nq" => (A::Nq, 2, 2),
        "and" => (A::And, 2, MANY),
        "or" => (A::Or, 2, MANY),
        "not" => (A::Not, 1, 1),
        "ifthen" => (A::IfThen, 3, 3),
        "switch" => (A::Switch, 2, MANY),
        "interpolate1d" => (A::Interpolate, 5, MANY),
        _ => return None,
    })
}

/// The result of an action on its arguments, as JSBSim computes it: a division by 0 gives the largest number there is.
pub(super) fn apply(action: Action, arguments: &[f64]) -> f64 {
    use Action as A;
    let Some((&x, rest)) = arguments.split_first() else { return f64::NAN };
    let y = rest.first().copied().unwrap_or(f64::NAN);
    let truth = |holds: bool| if holds { 1.0 } else { 0.0 };
    let is_true = |value: f64| value.abs() >= 1e-9;
    match action {
        A::Sum => rest.iter().fold(x, |sum, value| sum + value),
        A::Difference => rest.iter().fold(x, |difference, value| difference - value),
        A::Product => rest.iter().fold(x, |product, value| product * value),
        A::Quotient => {
            if y == 0.0 {
                f64::INFINITY
            } else {
                x / y
            }
        }
        A::Pow => x.powf(y),
        A::Sqrt => {
            if x >= 0.0 {
                x.sqrt()
            } else {
                f64::NEG_INFINITY
            }
        }
        A::Exp => x.exp(),
        A::Log2 | A::Ln | A::Log10 if x <= 0.0 => f64::NEG_INFINITY,
        A::Log2 => x.log2(),
        A::Ln => x.ln(),
        A::Log10 => x.log10(),
        A::Abs => x.abs(),
        A::Sign => {
            if x < 0.0 {
                -1.0
            } else {
                1.0
            }
        }
        A::Fmod if y == 0.0 => f64::INFINITY,
        A::Fmod => x % y,
        A::Mod if y.trunc() == 0.0 => f64::INFINITY,
        A::Mod => x.trunc() % y.trunc(),
        A::Sin => x.sin(),
        A::Cos => x.cos(),
        A::Tan => x.tan(),
        A::Asin => x.asin(),
        A::Acos => x.acos(),
        A::Atan => x.atan(),
        A::Atan2 => x.atan2(y),
        A::Min => rest.iter().fold(x, |least, &value| if value < least { value } else { least }),
        A::Max => rest.iter().fold(x, |most, &value| if value > most { value } else { most }),
        A::Avg => rest.iter().fold(x, |sum, value| sum + value) / (arguments.len() as f64),
        A::Fraction => x.fract(),
        A::Integer => x.trunc(),
        A::Floor => x.floor(),
        A::Ceil => x.ceil(),
        A::RoundMultiple => {
            let multiple = if rest.is_empty() { 1.0 } else { y };
            (x / multiple).round() * multiple
        }
        A::ToRadians => x.to_radians(),
        A::ToDegrees => x.to_degrees(),
        A::Lt => truth(x < y),
        A::Le => truth(x <= y),
        A::Gt => truth(x > y),
        A::Ge => truth(x >= y),
        A::Eq => truth(x == y),
        A::Nq => truth(x != y),
        A::And => truth(arguments.iter().all(|&value| is_true(value))),
        A::Or => truth(arguments.iter().any(|&value| is_true(value))),
        A::Not => truth(!is_true(x)),
        A::IfThen => rest.get(usize::from(!is_true(x))).copied().unwrap_or(f64::NAN),
        A::Switch => {
            // A negative choice, and one beyond the last, has no value.
            let choice = x.round();
            if choice >= 0.0 { rest.get(choice as usize).copied().unwrap_or(f64::NAN) } else { f64::NAN }
        }
        A::Interpolate => interpolate(x, rest),
    }
}

/// Linear interpolation in pairs of increasing positions and values, constant beyond the ends.
fn interpolate(x: f64, pairs: &[f64]) -> f64 {
    let mut before: Option<(f64, f64)> = None;
    for pair in pairs.chunks_exact(2) {
        let (at, value) = (pair[0], pair[1]);
        if x <= at {
            return before.map_or(value, |(at0, value0)| value0 + (x - at0) / (at - at0) * (value - value0));
        }
        before = Some((at, value));
    }
    before.map_or(f64::NAN, |(_, value)| value)
}

/// The property that a text names, with -1 for a leading minus sign and 1 without it.
pub(super) fn signed_property(model: &mut Model, name: &str) -> (usize, f64) {
    match name.trim().strip_prefix('-') {
        Some(rest) => (model.property(rest), -1.0),
        None => (model.property(name), 1.0),
    }
}

/// Whether a text can be the name of a property.
pub(super) fn is_property_name(name: &str) -> bool {
    let name = name.trim();
    let name = name.strip_prefix('-').unwrap_or(name);
    !name.is_empty() && name.len() < 300 && !name.chars().any(|letter| letter.is_whitespace() || letter.is_control())
}

/// The name of a property in a text, refused where it can be none.
pub(super) fn named_property(
    model: &mut Model,
    source: &Source,
    node: Node<'_, '_>,
    name: &str,
) -> Result<(usize, f64), JsbsimError> {
    if !is_property_name(name) {
        return Err(source.refuse(node, format!("<{}>: \"{}\" names no property", tag(node), shortened(name))));
    }
    let (index, sign) = signed_property(model, name);
    model.properties[index].mentioned.get_or_insert_with(|| (source.file.clone(), source.line(node)));
    Ok((index, sign))
}

/// Reads a `<function>` and gives its index. Its name, if it has one, becomes a property with its value.
pub(super) fn read(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<usize, JsbsimError> {
    let ops = operations(model, source, node)?;
    let name = node.attribute("name");
    // A property with a value of its own may have the name: then the function writes it. That of another function may not.
    if let Some(other) = name
        .and_then(|name| model.find(&property_of(name)))
        .and_then(|index| model.properties[index].function)
        .map(|function| &model.functions[function])
    {
        let what = format!(
            "another function is called \"{}\" too ({}: line {})",
            shortened(name.unwrap_or_default().trim()),
            other.file.display(),
            other.line
        );
        return Err(source.refuse(node, what));
    }
    Ok(define(model, source, node, ops, name))
}

/// The name of the property that a function of a name makes.
fn property_of(name: &str) -> String {
    name.trim().replace(char::is_whitespace, "-")
}

/// Reads a `<function>` whose name makes no property, and gives its index.
pub(super) fn read_without_name(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<usize, JsbsimError> {
    let ops = operations(model, source, node)?;
    Ok(define(model, source, node, ops, None))
}

/// The operations of a `<function>`.
fn operations(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<Vec<Op>, JsbsimError> {
    if node.attribute("type") == Some("template") {
        return Err(source.refuse(node, "functions of type template are not supported"));
    }
    let mut ops = Vec::new();
    let arguments: Vec<_> = children(node).filter(|part| !is_remark(*part)).collect();
    let [argument] = arguments.as_slice() else {
        let count = arguments.len();
        return Err(source.refuse(node, format!("the function has {count} arguments, not one")));
    };
    compile(model, source, *argument, &mut ops)?;
    Ok(ops)
}

/// Makes a function of operations, and a property of its name.
pub(super) fn define(
    model: &mut Model,
    source: &Source,
    node: Node<'_, '_>,
    ops: Vec<Op>,
    name: Option<&str>,
) -> usize {
    let made = model.functions.len();
    model.functions.push(Function { ops, copy: None, file: source.file.clone(), line: source.line(node) });
    let name = name.map(str::trim).filter(|name| !name.is_empty());
    if let Some(name) = name {
        let property = model.property(&property_of(name));
        let known = &mut model.properties[property];
        if known.declared {
            model.functions[made].copy = Some(property);
        } else {
            known.declared = true;
            known.function = Some(made);
        }
    }
    made
}

/// Whether an element only explains.
fn is_remark(node: Node<'_, '_>) -> bool {
    matches!(tag(node), "description" | "documentation" | "note")
}

/// Appends the operations of an argument.
fn compile(model: &mut Model, source: &Source, node: Node<'_, '_>, ops: &mut Vec<Op>) -> Result<(), JsbsimError> {
    match tag(node) {
        "value" | "v" => ops.push(Op::Constant(source.number(node)?)),
        "property" | "p" => {
            if node.attribute("apply").is_some() {
                return Err(source.refuse(node, "functions of type template are not supported"));
            }
            let (index, sign) = named_property(model, source, node, &text(node))?;
            ops.push(Op::Property(index, sign));
        }
        "table" | "t" => {
            let table = read_table(model, source, node)?;
            ops.push(Op::Table(table));
        }
        "pi" => ops.push(Op::Constant(std::f64::consts::PI)),
        "random" | "urandom" => {
            return Err(source.refuse(node, format!("<{}> draws random numbers, which is not supported", tag(node))));
        }
        name => {
            let Some((action, least, most)) = action(name) else {
                return Err(source.refuse(node, format!("the function <{}> is not known", shortened(name))));
            };
            let mut count = 0;
            for argument in children(node).filter(|part| !is_remark(*part)) {
                compile(model, source, argument, ops)?;
                count += 1;
            }
            if count < least || count > most || (action == Action::Interpolate && count % 2 == 0) {
                return Err(source.refuse(node, format!("<{name}> has {count} arguments, which is a wrong number")));
            }
            ops.push(Op::Apply(action, count));
        }
    }
    Ok(())
}

/// Reads a `<table>` with its properties and gives its index.
pub(super) fn read_table(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<usize, JsbsimError> {
    let variables: Vec<_> = children(node).filter(|part| tag(*part) == "independentVar").collect();
    if variables.is_empty() {
        return Err(source.refuse(node, "the table names no <independentVar>"));
    }
    let mut places = [None; 3];
    for &variable in &variables {
        let place = match variable.attribute("lookup").map(str::trim) {
            None | Some("" | "row") => 0,
            Some("column") => 1,
            Some("table") => 2,
            Some(other) => {
                return Err(source.refuse(variable, format!("lookup=\"{}\" is not supported", shortened(other))));
            }
        };
        if places[place].is_some() {
            return Err(source.refuse(variable, "two variables of the table have the same place"));
        }
        places[place] = Some(named_property(model, source, variable, &text(variable))?);
    }
    let dimensions = variables.len();
    if places[..dimensions].iter().any(Option::is_none) {
        return Err(source.refuse(node, "the variables of the table are not row, column and table in this order"));
    }
    let table = Table::read(source, node, dimensions)?;
    let made = model.tables.len();
    model.tables.push(Lookup { table, variables: places });
    if let Some(name) = node.attribute("name").filter(|name| !name.trim().is_empty()) {
        define(model, source, node, vec![Op::Table(made)], Some(name));
    }
    Ok(made)
}

/// Most evaluations that one function may take, with all that it refers to.
const MAX_WORK: f64 = 1e6;
/// Longest chain of functions that refer to each other.
const MAX_CHAIN: usize = 300;

/// Refuses functions that need their own value, and those that would take for ever.
pub(super) fn check_circles(model: &Model) -> Result<(), JsbsimError> {
    #[derive(Clone, Copy)]
    enum Seen {
        No,
        Open,
        Done { work: f64, chain: usize },
    }
    let referred: Vec<Vec<usize>> = model.functions.iter().map(|function| references(model, function)).collect();
    let mut seen = vec![Seen::No; model.functions.len()];
    for root in 0..model.functions.len() {
        // (function, how many of its references are done), without calling itself.
        let mut path = vec![(root, 0)];
        while let Some(&(at, done)) = path.last() {
            if matches!(seen[at], Seen::Done { .. }) {
                path.pop();
                continue;
            }
            seen[at] = Seen::Open;
            let refuse = |what: &str| {
                let function = &model.functions[at];
                Err(JsbsimError::Refused { file: function.file.clone(), line: function.line, what: what.into() })
            };
            if let Some(&next) = referred[at].get(done) {
                if let Some(last) = path.last_mut() {
                    last.1 += 1;
                }
                match seen[next] {
                    Seen::No => path.push((next, 0)),
                    Seen::Open => return refuse("the function needs its own value"),
                    Seen::Done { .. } => {}
                }
                continue;
            }
            let (mut work, mut chain) = (model.functions[at].ops.len() as f64, 1);
            for &other in &referred[at] {
                if let Seen::Done { work: more, chain: longer } = seen[other] {
                    work += more;
                    chain = chain.max(longer + 1);
                }
            }
            if work > MAX_WORK || chain > MAX_CHAIN {
                return refuse("the function refers to too many others");
            }
            seen[at] = Seen::Done { work, chain };
            path.pop();
        }
    }
    Ok(())
}

/// The functions whose values a function reads, as often as it reads them.
fn references(model: &Model, function: &Function) -> Vec<usize> {
    let mut found = Vec::new();
    for op in &function.ops {
        match *op {
            Op::Property(index, _) => found.extend(model.properties[index].function),
            Op::Table(table) => {
                let variables = model.tables[table].variables.iter().flatten();
                found.extend(variables.filter_map(|&(index, _)| model.properties[index].function));
            }
            Op::Constant(_) | Op::Apply(..) => {}
        }
    }
    found
}
