//! Reads formulas.

use super::function::Function;
use super::node::Node;
use super::token::{Token, tokens};
use super::{DEEPEST, ExpressionError};
use phugoid_simulation::scenario::nearest;

/// What a name in a formula stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// A number that does not change.
    Constant(f64),
    /// A variable, by its place among those that [`Node::at`] is given.
    Variable(usize),
}

/// Reads a formula in which these names have a meaning.
///
/// # Errors
/// [`ExpressionError`]: a mark that does not fit, an unknown name (answered with the nearest one), or more than the bounds allow.
pub(crate) fn parse(text: &str, names: &[(&str, Meaning)]) -> Result<Node, ExpressionError> {
    let end = text.chars().count() + 1;
    let mut parser = Parser { tokens: tokens(text)?, at: 0, names, depth: 0, end };
    if parser.tokens.is_empty() {
        return Err(parser.wrong("a formula is expected here, found nothing"));
    }
    let (node, _) = parser.sum()?;
    match parser.peek() {
        None => Ok(node),
        Some(Token::Mark(')')) => Err(parser.wrong("this parenthesis closes none that was opened")),
        Some(Token::Mark(mark)) => Err(parser.wrong(&format!("`{mark}` is out of place here"))),
        Some(Token::Name(_) | Token::Number(_)) => {
            Err(parser.wrong("an operator is missing before this: write `*` between two factors"))
        }
    }
}

struct Parser<'a> {
    tokens: Vec<(usize, Token<'a>)>,
    at: usize,
    names: &'a [(&'a str, Meaning)],
    /// How deep the parser is in parentheses, functions, powers and signs.
    depth: usize,
    /// Number of the character behind the last one.
    end: usize,
}

/// A part of a formula and the most steps from it to a number or name.
type Part = (Node, usize);

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).map(|(_, token)| *token)
    }

    /// Goes on if the next piece is this mark.
    fn take(&mut self, mark: char) -> bool {
        let is_next = self.peek() == Some(Token::Mark(mark));
        self.at += usize::from(is_next);
        is_next
    }

    /// An error at the next piece, or at the end.
    fn wrong(&self, message: &str) -> ExpressionError {
        let character = self.tokens.get(self.at).map_or(self.end, |(character, _)| *character);
        ExpressionError { character, message: message.to_owned() }
    }

    fn too_deep(&self) -> ExpressionError {
        self.wrong(&format!(
            "the formula is nested deeper than {DEEPEST} steps: divide it, or name a part of it a constant"
        ))
    }

    fn join(
        &self,
        of: fn(Box<Node>, Box<Node>) -> Node,
        (a, left): Part,
        (b, right): Part,
    ) -> Result<Part, ExpressionError> {
        let depth = left.max(right) + 1;
        if depth > DEEPEST { Err(self.too_deep()) } else { Ok((of(Box::new(a), Box::new(b)), depth)) }
    }

    fn sum(&mut self) -> Result<Part, ExpressionError> {
        let mut sum = self.product()?;
        loop {
            let of = match self.peek() {
                Some(Token::Mark('+')) => Node::Sum,
                Some(Token::Mark('-')) => Node::Difference,
                _ => return Ok(sum),
            };
            self.at += 1;
            let term = self.product()?;
            sum = self.join(of, sum, term)?;
        }
    }

    fn product(&mut self) -> Result<Part, ExpressionError> {
        let mut product = self.signed()?;
        loop {
            let of = match self.peek() {
                Some(Token::Mark('*')) => Node::Product,
                Some(Token::Mark('/')) => Node::Quotient,
                _ => return Ok(product),
            };
            self.at += 1;
            let factor = self.signed()?;
            product = self.join(of, product, factor)?;
        }
    }

    /// A power with any number of signs before it. All that nests passes through here.
    fn signed(&mut self) -> Result<Part, ExpressionError> {
        if self.depth >= DEEPEST {
            return Err(self.too_deep());
        }
        self.depth += 1;
        let part = if self.take('-') {
            let (node, depth) = self.signed()?;
            (Node::Negative(Box::new(node)), depth + 1)
        } else if self.take('+') {
            self.signed()?
        } else {
            self.power()?
        };
        self.depth -= 1;
        if part.1 > DEEPEST { Err(self.too_deep()) } else { Ok(part) }
    }

    fn power(&mut self) -> Result<Part, ExpressionError> {
        let base = self.atom()?;
        if !self.take('^') {
            return Ok(base);
        }
        let exponent = self.signed()?;
        self.join(Node::Power, base, exponent)
    }

    fn atom(&mut self) -> Result<Part, ExpressionError> {
        match self.peek() {
            Some(Token::Number(value)) => {
                self.at += 1;
                Ok((Node::Number(value), 0))
            }
            Some(Token::Name(name)) => self.named(name),
            Some(Token::Mark('(')) => {
                self.at += 1;
                self.closed()
            }
            Some(Token::Mark(mark)) => {
                Err(self.wrong(&format!("a number, a name or `(` is expected here, found `{mark}`")))
            }
            None => Err(self.wrong("the formula ends where a number, a name or `(` is expected")),
        }
    }

    /// What stands in parentheses of which the first is read.
    fn closed(&mut self) -> Result<Part, ExpressionError> {
        let part = self.sum()?;
        match self.take(')') {
            true => Ok(part),
            false if self.peek().is_none() => Err(self.wrong("a parenthesis is not closed")),
            false => Err(self.wrong("an operator or `)` is expected here")),
        }
    }

    fn named(&mut self, name: &str) -> Result<Part, ExpressionError> {
        let called = matches!(self.tokens.get(self.at + 1), Some((_, Token::Mark('('))));
        let meaning = self.names.iter().find(|(known, _)| *known == name).map(|(_, meaning)| *meaning);
        match (meaning, Function::named(name)) {
            (Some(_), _) if called => {
                Err(self.wrong(&format!("`{name}` is no function: write `{name}*(...)` for a product")))
            }
            (Some(Meaning::Constant(value)), _) => {
                self.at += 1;
                Ok((Node::Number(value), 0))
            }
            (Some(Meaning::Variable(place)), _) => {
                self.at += 1;
                Ok((Node::Variable(place), 0))
            }
            (None, Some(function)) if called => {
                self.at += 2;
                let (argument, depth) = self.closed()?;
                Ok((Node::Call(function, Box::new(argument)), depth + 1))
            }
            (None, Some(_)) => Err(self.wrong(&format!("`{name}` is a function: write `{name}(...)`"))),
            (None, None) => Err(self.unknown(name, called)),
        }
    }

    fn unknown(&self, name: &str, called: bool) -> ExpressionError {
        let functions = || Function::ALL.iter().map(|(name, _)| *name);
        let names = || self.names.iter().map(|(name, _)| *name);
        let near = if called { nearest(name, functions()) } else { nearest(name, names().chain(functions())) };
        let what = if called { "function" } else { "name" };
        match near {
            Some(near) => self.wrong(&format!("unknown {what} `{name}`: did you mean `{near}`?")),
            None => {
                let known: Vec<&str> = if called { functions().collect() } else { names().collect() };
                self.wrong(&format!("unknown {what} `{name}`: there are {}", known.join(", ")))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_dynamics::scalar::Dual;

    const NAMES: [(&str, Meaning); 4] = [
        ("x", Meaning::Variable(0)),
        ("speed", Meaning::Variable(1)),
        ("B", Meaning::Constant(1.5)),
        ("pi", Meaning::Constant(std::f64::consts::PI)),
    ];

    fn at(text: &str, x: f64, speed: f64) -> Dual<2> {
        let node = parse(text, &NAMES).unwrap_or_else(|error| panic!("{text}: {error}"));
        node.at(&[Dual::variable(x, 0), Dual::variable(speed, 1)])
    }

    #[test]
    fn formulas_mean_what_they_mean_on_paper() {
        let (x, v) = (0.7_f64, 3.0_f64);
        for (text, expected) in [
            ("-x^2", -(x * x)),
            ("(-x)^2", x * x),
            ("2^3^2", 512.0),
            ("x**-1", 1.0 / x),
            ("6/2*3", 9.0),
            ("1 - 2 - 3", -4.0),
            ("-x*-speed", x * v),
            ("B*sin(pi/2)", 1.5),
            (" 1.5e-3 * .5 + 2. ", 2.00075),
            ("sqrt(speed) + ln(exp(x))", v.sqrt() + x),
            ("+x", x),
        ] {
            let found = at(text, x, v).value;
            assert!((found - expected).abs() < 1e-15 * expected.abs().max(1.0), "{text}: {found} {expected}");
        }
    }

    /// Against central differences, whose error is the third derivative times `h^2/6`, below 1e-8 of the values here.
    #[test]
    fn derivatives_are_those_of_the_formula() {
        let mut formulas: Vec<String> = Function::ALL.iter().map(|(name, _)| format!("{name}(x)*speed")).collect();
        formulas.extend(
            ["x^3", "(x - 1)^3", "x^speed", "2^x", "x/(speed + x)", "-x*x - -speed*x", "x^0"].map(String::from),
        );
        for text in &formulas {
            let (x, v, h) = (0.6, 1.7, 1e-5);
            let found = at(text, x, v);
            let by = [
                (at(text, x + h, v).value - at(text, x - h, v).value) / (2.0 * h),
                (at(text, x, v + h).value - at(text, x, v - h).value) / (2.0 * h),
            ];
            for (exact, difference) in found.derivatives.iter().zip(by) {
                assert!((exact - difference).abs() < 1e-8 * exact.abs().max(1.0), "{text}: {exact} {difference}");
            }
        }
        // A square of a negative number has a slope.
        assert_eq!(at("x^2", -2.0, 0.0).derivatives, [-4.0, 0.0]);
        assert_eq!(at("abs(x)", 0.0, 0.0).derivatives, [0.0, 0.0]);
    }

    #[test]
    fn what_is_no_formula_is_refused_at_its_place() {
        for (text, character, words) in [
            ("", 1, "found nothing"),
            ("x + spede", 5, "did you mean `speed`?"),
            ("x + qqq", 5, "there are x, speed, B, pi"),
            ("sqr(x)", 1, "did you mean `sqrt`?"),
            ("2 x", 3, "an operator is missing"),
            ("2exp(x)", 2, "an operator is missing"),
            ("x(2)", 1, "`x` is no function"),
            ("sin x", 1, "`sin` is a function"),
            ("(x + 1", 7, "not closed"),
            ("x + 1)", 6, "closes none"),
            ("x +", 4, "ends where"),
            ("x + * 2", 5, "found `*`"),
            ("1.2.3", 4, "an operator is missing"),
            ("1e999", 1, "is no number"),
            (".", 1, "is no number"),
            ("\u{e4} + 1", 1, "no meaning"),
            ("x = 2", 3, "no meaning"),
            ("x; y", 2, "no meaning"),
        ] {
            let error = parse(text, &NAMES).unwrap_err();
            assert_eq!(error.character, character, "{text}: {error}");
            assert!(error.message.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn size_and_nesting_are_bounded() {
        let nested = |depth: usize| "(".repeat(depth) + "x" + &")".repeat(depth);
        assert!(parse(&nested(DEEPEST - 1), &NAMES).is_ok());
        let sum = |terms: usize| vec!["x"; terms].join("+");
        assert!(parse(&sum(DEEPEST + 1), &NAMES).is_ok());
        for text in [
            nested(DEEPEST + 1),
            nested(499),
            "-".repeat(900) + "x",
            "sin(".repeat(190) + "x" + &")".repeat(190),
            vec!["x"; 400].join("^"),
            sum(DEEPEST + 2),
        ] {
            let error = parse(&text, &NAMES).unwrap_err();
            assert!(error.message.contains("nested deeper than 100"), "{error}");
        }
        let error = parse(&"(".repeat(1_000_000), &NAMES).unwrap_err();
        assert!(error.message.contains("1000000 characters"), "{error}");
    }

    #[test]
    fn what_is_linear_in_the_parameters_is_told() {
        // `x` is the parameter here.
        for (text, linear) in [
            ("-x*speed + B", true),
            ("x*(speed + 2)^2/sin(speed)", true),
            ("-(x - speed)*3", true),
            ("x*x", false),
            ("x^2", false),
            ("sin(x)", false),
            ("speed/x", false),
            ("speed*(1 + x*(2 + x))", false),
            ("2^x", false),
        ] {
            assert_eq!(parse(text, &NAMES).unwrap().is_linear_in(&|place| place == 0), linear, "{text}");
        }
    }
}
