//! Divides a formula into numbers, names and marks.

use super::{ExpressionError, MOST_CHARACTERS};

/// A piece of a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// One of `+ - * / ^ ( )`.
    Mark(char),
}

/// The pieces of a formula, with the number of the character at which each begins, from 1.
pub(super) fn tokens(text: &str) -> Result<Vec<(usize, Token<'_>)>, ExpressionError> {
    let wrong = |character, message: String| Err(ExpressionError { character, message });
    let length = text.chars().count();
    if length > MOST_CHARACTERS {
        return wrong(
            MOST_CHARACTERS + 1,
            format!("the formula has {length} characters, and at most {MOST_CHARACTERS} are read"),
        );
    }
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        // What was read is ASCII from the first character that is not on, so that bytes are characters in what is named.
        let character = length - rest.chars().count() + 1;
        let taken = match first {
            c if c.is_whitespace() => c.len_utf8(),
            // `**` is how some languages write `^`.
            '*' if rest.starts_with("**") => {
                found.push((character, Token::Mark('^')));
                2
            }
            '+' | '-' | '*' | '/' | '^' | '(' | ')' => {
                found.push((character, Token::Mark(first)));
                1
            }
            c if c.is_ascii_digit() || c == '.' => {
                let end = number_length(rest.as_bytes());
                let text = rest.get(..end).unwrap_or_default();
                match text.parse::<f64>() {
                    Ok(value) if value.is_finite() => found.push((character, Token::Number(value))),
                    _ => return wrong(character, format!("`{text}` is no number")),
                }
                end
            }
            c if c.is_ascii_alphabetic() || c == '_' => {
                let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let end = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
                found.push((character, Token::Name(rest.get(..end).unwrap_or_default())));
                end
            }
            other => {
                let message = format!(
                    "`{}` has no meaning in a formula; it is made of numbers, names, + - * / ^ and parentheses",
                    other.escape_debug()
                );
                return wrong(character, message);
            }
        };
        rest = rest.get(taken..).unwrap_or_default();
    }
    Ok(found)
}

/// Length of the number at the beginning: digits, a point, and an exponent only where digits follow it.
fn number_length(text: &[u8]) -> usize {
    let digits = |from: usize| text.iter().skip(from).take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = digits(0);
    if text.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(text.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}
