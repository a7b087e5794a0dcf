//! Content MathML of a `calculation`, translated into the operations of a [`super::program::Program`].

use std::collections::HashMap;

use super::error::{DavemlError, brief};
use super::functions::{Binary, Unary};
use super::program::Op;
use super::tree::{Element, Lines, content, elements, name};

/// Most operations of one calculation.
const MAX_OPERATIONS: usize = 1_000_000;

/// Functions of one operand by their MathML name.
const UNARY: [(&str, Unary); 34] = [
    ("exp", Unary::Exp),
    ("ln", Unary::Ln),
    ("abs", Unary::Abs),
    ("floor", Unary::Floor),
    ("ceiling", Unary::Ceiling),
    ("factorial", Unary::Factorial),
    ("not", Unary::Not),
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tan", Unary::Tan),
    ("sec", Unary::Sec),
    ("csc", Unary::Csc),
    ("cot", Unary::Cot),
    ("arcsin", Unary::Asin),
    ("arccos", Unary::Acos),
    ("arctan", Unary::Atan),
    ("arcsec", Unary::Asec),
    ("arccsc", Unary::Acsc),
    ("arccot", Unary::Acot),
    ("sinh", Unary::Sinh),
    ("cosh", Unary::Cosh),
    ("tanh", Unary::Tanh),
    ("sech", Unary::Sech),
    ("csch", Unary::Csch),
    ("coth", Unary::Coth),
    ("arcsinh", Unary::Asinh),
    ("arccosh", Unary::Acosh),
    ("arctanh", Unary::Atanh),
    ("arcsech", Unary::Asech),
    ("arccsch", Unary::Acsch),
    ("arccoth", Unary::Acoth),
    ("ident", Unary::Identity),
    ("real", Unary::Identity),
    ("conjugate", Unary::Identity),
];
/// Functions of exactly two operands.
const BINARY: [(&str, Binary); 6] = [
    ("divide", Binary::Divide),
    ("power", Binary::Power),
    ("quotient", Binary::Quotient),
    ("rem", Binary::Remainder),
    ("neq", Binary::NotEqual),
    ("implies", Binary::Implies),
];
/// Functions of one operand or more, taken from the left.
const FOLDED: [(&str, Binary); 7] = [
    ("plus", Binary::Plus),
    ("times", Binary::Times),
    ("min", Binary::Min),
    ("max", Binary::Max),
    ("and", Binary::And),
    ("or", Binary::Or),
    ("xor", Binary::Xor),
];
/// Comparisons of two operands or more: each with the next.
const CHAINED: [(&str, Binary); 5] = [
    ("eq", Binary::Equal),
    ("lt", Binary::Less),
    ("gt", Binary::Greater),
    ("leq", Binary::LessOrEqual),
    ("geq", Binary::GreaterOrEqual),
];

/// Translates calculations; one for a model.
pub(super) struct Translator<'m> {
    pub(super) lines: &'m Lines,
    /// Position of each variable by its identifier.
    pub(super) variables: &'m HashMap<String, usize>,
}

/// Operations of one calculation and what they need.
#[derive(Default)]
pub(super) struct Translated {
    pub(super) ops: Vec<Op>,
    /// Positions of the variables that are read.
    pub(super) needs: Vec<usize>,
    /// Most values on the stack at once.
    pub(super) depth: usize,
    height: usize,
}

impl Translated {
    fn push(&mut self, op: Op) {
        match op {
            Op::Number(_) | Op::Load(_) => self.height += 1,
            Op::Binary(_) | Op::JumpUnless(_) => self.height = self.height.saturating_sub(1),
            Op::Unary(_) | Op::Jump(_) => {}
        }
        self.depth = self.depth.max(self.height);
        self.ops.push(op);
    }

    fn here(&self) -> u32 {
        u32::try_from(self.ops.len()).unwrap_or(u32::MAX)
    }

    /// Makes the jump at `at` lead to here.
    fn land(&mut self, at: usize) {
        let target = self.here();
        if let Some(Op::Jump(to) | Op::JumpUnless(to)) = self.ops.get_mut(at) {
            *to = target;
        }
    }
}

impl Translator<'_> {
    /// The operations of a `calculation` element.
    pub(super) fn calculation(&self, calculation: Element<'_>) -> Result<Translated, DavemlError> {
        let mut children = elements(calculation);
        let math = children.next().ok_or_else(|| self.lines.missing(calculation, "math"))?;
        if name(math) != "math" {
            return Err(self.lines.unknown(math));
        }
        if let Some(second) = children.next() {
            return Err(self.lines.unknown(second));
        }
        let mut into = Translated::default();
        let mut formulas = elements(math);
        let formula = formulas.next().ok_or_else(|| self.lines.missing(math, "apply"))?;
        if let Some(second) = formulas.next() {
            return Err(self.lines.unknown(second));
        }
        self.value(formula, &mut into)?;
        Ok(into)
    }

    /// Operations that leave the value of an element on the stack. The depth of elements is limited by [`crate::xml`].
    fn value(&self, node: Element<'_>, into: &mut Translated) -> Result<(), DavemlError> {
        // A chain of comparisons takes its middle operands twice, and so on inside them.
        if into.ops.len() > MAX_OPERATIONS {
            let (what, line) = ("operations in a calculation", self.lines.line(node));
            return Err(DavemlError::TooMany { what, found: into.ops.len(), limit: MAX_OPERATIONS, line });
        }
        match name(node) {
            "cn" => into.push(Op::Number(self.constant(node)?)),
            "ci" => {
                let text = content(node);
                let id = text.trim();
                let variable = *self
                    .variables
                    .get(id)
                    .ok_or_else(|| DavemlError::UnknownVariable { id: brief(id), line: self.lines.line(node) })?;
                into.needs.push(variable);
                into.push(Op::Load(u32::try_from(variable).unwrap_or(u32::MAX)));
            }
            "apply" => self.apply(node, into)?,
            "piecewise" => self.piecewise(node, into)?,
            // What a formula means is its first child; annotations say it in other languages.
            "semantics" => match elements(node).next() {
                Some(first) => self.value(first, into)?,
                None => return Err(self.lines.missing(node, "apply")),
            },
            "pi" => into.push(Op::Number(core::f64::consts::PI)),
            "exponentiale" => into.push(Op::Number(core::f64::consts::E)),
            "eulergamma" => into.push(Op::Number(0.577_215_664_901_532_9)),
            "true" => into.push(Op::Number(1.0)),
            "false" => into.push(Op::Number(0.0)),
            "infinity" => into.push(Op::Number(f64::INFINITY)),
            "notanumber" => into.push(Op::Number(f64::NAN)),
            _ => return Err(self.lines.unknown(node)),
        }
        Ok(())
    }

    /// A `cn` element.
    fn constant(&self, node: Element<'_>) -> Result<f64, DavemlError> {
        let kind = node.attribute("type").unwrap_or("real").trim();
        let mut separators = elements(node);
        let separated = separators.next();
        for element in separated.into_iter().chain(separators) {
            if name(element) != "sep" || !matches!(kind, "e-notation" | "rational") {
                return Err(self.lines.unknown(element));
            }
        }
        if !matches!(node.attribute("base").map(str::trim), None | Some("10")) {
            return Err(self.lines.unsupported(node, "a number in a base other than ten"));
        }
        let texts: Vec<&str> = node.children().filter(|c| c.is_text()).filter_map(|c| c.text()).collect();
        let pair = || match texts.as_slice() {
            [first, second] => Ok((self.lines.number(node, first, "<cn>")?, self.lines.number(node, second, "<cn>")?)),
            _ => Err(self.lines.missing(node, "sep")),
        };
        let number = match kind {
            "real" | "integer" | "double" => return self.lines.content_number(node),
            "rational" => {
                let (numerator, denominator) = pair()?;
                numerator / denominator
            }
            "e-notation" if separated.is_none() => return self.lines.content_number(node),
            "e-notation" => {
                let (mantissa, exponent) = pair()?;
                mantissa * 10.0_f64.powf(exponent)
            }
            "constant" => match content(node).trim() {
                "pi" | "\u{3c0}" => core::f64::consts::PI,
                "e" => core::f64::consts::E,
                _ => return self.lines.content_number(node),
            },
            other => return Err(self.lines.unsupported(node, format!("a number of type `{}`", brief(other)))),
        };
        self.lines.number(node, &number.to_string(), "<cn>")
    }

    fn apply(&self, node: Element<'_>, into: &mut Translated) -> Result<(), DavemlError> {
        let mut children = elements(node);
        let head = children.next().ok_or_else(|| self.lines.missing(node, "plus"))?;
        let operands: Vec<Element<'_>> = children.collect();
        let function = name(head);
        let wrong =
            |found: usize| DavemlError::Operands { function: function.to_owned(), found, line: self.lines.line(node) };
        if let Some((_, unary)) = UNARY.iter().find(|(known, _)| *known == function) {
            let [operand] = operands.as_slice() else { return Err(wrong(operands.len())) };
            self.value(*operand, into)?;
            into.push(Op::Unary(*unary));
        } else if let Some((_, binary)) = BINARY.iter().find(|(known, _)| *known == function) {
            let [first, second] = operands.as_slice() else { return Err(wrong(operands.len())) };
            self.two(*first, *second, *binary, into)?;
        } else if let Some((_, binary)) = FOLDED.iter().find(|(known, _)| *known == function) {
            let Some((first, rest)) = operands.split_first() else { return Err(wrong(0)) };
            self.value(*first, into)?;
            for operand in rest {
                self.value(*operand, into)?;
                into.push(Op::Binary(*binary));
            }
        } else if let Some((_, binary)) = CHAINED.iter().find(|(known, _)| *known == function) {
            if operands.len() < 2 {
                return Err(wrong(operands.len()));
            }
            for (position, pair) in operands.windows(2).enumerate() {
                self.two(pair[0], pair[1], *binary, into)?;
                if position > 0 {
                    into.push(Op::Binary(Binary::And));
                }
            }
        } else {
            self.special(head, &operands, into, &wrong)?;
        }
        Ok(())
    }

    /// Functions with rules of their own.
    fn special(
        &self,
        head: Element<'_>,
        operands: &[Element<'_>],
        into: &mut Translated,
        wrong: &dyn Fn(usize) -> DavemlError,
    ) -> Result<(), DavemlError> {
        match (name(head), operands) {
            ("minus", [operand]) => {
                self.value(*operand, into)?;
                into.push(Op::Unary(Unary::Negate));
            }
            ("minus", [first, second]) => self.two(*first, *second, Binary::Minus, into)?,
            ("root", [operand]) => {
                self.value(*operand, into)?;
                into.push(Op::Unary(Unary::Sqrt));
            }
            ("root", [degree, operand]) if name(*degree) == "degree" => {
                self.value(*operand, into)?;
                self.qualifier(*degree, into)?;
                into.push(Op::Binary(Binary::Root));
            }
            ("log", [operand]) => {
                self.value(*operand, into)?;
                into.push(Op::Number(10.0));
                into.push(Op::Binary(Binary::Log));
            }
            ("log", [base, operand]) if name(*base) == "logbase" => {
                self.value(*operand, into)?;
                self.qualifier(*base, into)?;
                into.push(Op::Binary(Binary::Log));
            }
            ("csymbol", _) => {
                let definition = head.attribute("definitionURL").unwrap_or_default().trim();
                let text = content(head);
                let function = definition.rsplit_once('#').map_or(text.trim(), |(_, function)| function);
                if function != "atan2" {
                    return Err(self.lines.unsupported(head, format!("the csymbol `{}`", brief(function))));
                }
                let [first, second] = operands else {
                    return Err(DavemlError::Operands {
                        function: "csymbol atan2".to_owned(),
                        found: operands.len(),
                        line: self.lines.line(head),
                    });
                };
                self.two(*first, *second, Binary::Atan2, into)?;
            }
            ("minus" | "root" | "log", _) => return Err(wrong(operands.len())),
            // Many files write an `apply` around a `piecewise`.
            ("piecewise" | "apply" | "ci" | "cn", []) => self.value(head, into)?,
            _ => return Err(self.lines.unknown(head)),
        }
        Ok(())
    }

    fn two(
        &self,
        first: Element<'_>,
        second: Element<'_>,
        binary: Binary,
        into: &mut Translated,
    ) -> Result<(), DavemlError> {
        self.value(first, into)?;
        self.value(second, into)?;
        into.push(Op::Binary(binary));
        Ok(())
    }

    /// The value inside a `degree` or `logbase`.
    fn qualifier(&self, node: Element<'_>, into: &mut Translated) -> Result<(), DavemlError> {
        let mut children = elements(node);
        let first = children.next().ok_or_else(|| self.lines.missing(node, "cn"))?;
        match children.next() {
            Some(second) => Err(self.lines.unknown(second)),
            None => self.value(first, into),
        }
    }

    /// The first piece whose condition holds; without one that does, and without `otherwise`, NaN.
    fn piecewise(&self, node: Element<'_>, into: &mut Translated) -> Result<(), DavemlError> {
        let mut ends = Vec::new();
        let mut otherwise = None;
        let before = into.height;
        for piece in elements(node) {
            let parts: Vec<Element<'_>> = elements(piece).collect();
            let wrong = || DavemlError::Operands {
                function: name(piece).to_owned(),
                found: parts.len(),
                line: self.lines.line(piece),
            };
            match name(piece) {
                "piece" => {
                    let [value, condition] = parts.as_slice() else { return Err(wrong()) };
                    self.value(*condition, into)?;
                    let unless = into.ops.len();
                    into.push(Op::JumpUnless(0));
                    self.value(*value, into)?;
                    ends.push(into.ops.len());
                    into.push(Op::Jump(0));
                    into.land(unless);
                    into.height = before;
                }
                "otherwise" if otherwise.is_none() => {
                    let [value] = parts.as_slice() else { return Err(wrong()) };
                    otherwise = Some(*value);
                }
                _ => return Err(self.lines.unknown(piece)),
            }
        }
        match otherwise {
            Some(value) => self.value(value, into)?,
            None => into.push(Op::Number(f64::NAN)),
        }
        for end in ends {
            into.land(end);
        }
        Ok(())
    }
}
