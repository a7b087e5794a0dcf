//! Numbers in the sentences in which the definitions state winds and commands.

/// All numbers of a text that a unit follows, in order: `numbers_before("+70 ft/s at 30 000 ft", "ft/s")` is `[70]`.
///
/// A sign belongs to a number that it touches, and a space between digits separates thousands.
pub(super) fn numbers_before(text: &str, unit: &str) -> Vec<f64> {
    let mut found = Vec::new();
    for (place, _) in text.match_indices(unit) {
        let after = text[place + unit.len()..].chars().next();
        // `ft` is no unit in front of `/s`, nor `s` in front of more letters.
        if after.is_some_and(|c| c.is_alphanumeric() || c == '/') {
            continue;
        }
        let before = text[..place].trim_end();
        let begin = before
            .char_indices()
            .rev()
            .take_while(|(_, c)| c.is_ascii_digit() || matches!(c, ' ' | '.' | '+' | '-'))
            .last()
            .map_or(before.len(), |(i, _)| i);
        let number: String = before[begin..].chars().filter(|c| *c != ' ').collect();
        if let Ok(value) = number.parse() {
            found.push(value);
        }
    }
    found
}

/// A number or a fraction in a text, such as `1/298.25`.
pub(super) fn fraction(text: &str) -> Option<f64> {
    match text.split_once('/') {
        None => text.trim().parse().ok(),
        Some((above, below)) => {
            let value = above.trim().parse::<f64>().ok()? / below.trim().parse::<f64>().ok()?;
            value.is_finite().then_some(value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_numbers_by_their_units() {
        let shear = "towards east, linear in altitude: +70 ft/s at 30 000 ft, -20 ft/s at 0 ft";
        assert_eq!(numbers_before(shear, "ft/s"), [70.0, -20.0]);
        assert_eq!(numbers_before(shear, "ft"), [30_000.0, 0.0]);
        let command = "F-16 with autopilot: +100 ft altitude command at 5 s";
        assert_eq!((numbers_before(command, "ft"), numbers_before(command, "s")), (vec![100.0], vec![5.0]));
        assert_eq!(numbers_before("-5 kt equivalent airspeed command at 5 s", "kt"), [-5.0]);
        assert!(numbers_before("no number of s", "s").is_empty());
        assert_eq!(fraction("1/4"), Some(0.25));
        assert_eq!((fraction("7"), fraction("1/0"), fraction("a")), (Some(7.0), None, None));
    }
}
