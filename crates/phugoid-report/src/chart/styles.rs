//! Colours and strokes of the legend entries of a chart, by their meaning.

use phugoid_evaluation::chart::Meaning;

use crate::figure::{Colour, Stroke};

/// Colours of the methods that are compared with the flagship, by their number.
const METHOD_COLOURS: [Colour; 5] = [Colour::Vermillion, Colour::Green, Colour::Purple, Colour::Orange, Colour::Sky];

/// Strokes in the order in which entries of the same meaning get them.
const STROKES: [Stroke; 4] = [Stroke::Solid, Stroke::Dashed, Stroke::DashDotted, Stroke::Dotted];

/// The form in which a legend entry is drawn. Two entries of different forms can be distinguished by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A curve through samples.
    Line,
    /// A horizontal line. A curve and a level with equal meaning and label are one entry.
    Level,
    /// A vertical line at an instant.
    Instant,
    /// Dots without a line.
    Points,
    /// An area between two curves.
    Band,
}

impl Form {
    /// The form of the sample in the legend, which is the same for curves and levels.
    fn sample(self) -> Self {
        if self == Self::Level { Self::Line } else { self }
    }
}

/// The legend entries of one chart with their styles so far.
#[derive(Default)]
pub(super) struct Styles {
    assigned: Vec<Assigned>,
}

struct Assigned {
    label: String,
    meaning: Meaning,
    sample: Form,
    style: (Colour, Stroke),
}

impl Styles {
    /// Colour and stroke of an entry: the usual ones of its meaning, or the next ones that no other entry of the chart
    /// has.
    pub(super) fn of(&mut self, label: &str, meaning: Meaning, form: Form) -> (Colour, Stroke) {
        let sample = form.sample();
        let known = self.assigned.iter().find(|g| g.label == label && g.meaning == meaning && g.sample == sample);
        if let Some(known) = known {
            return known.style;
        }
        let (colour, first) = usual(meaning, form);
        // An entry without a label is not in the legend and cannot be confused with another.
        if label.is_empty() {
            return (colour, first);
        }
        let start = STROKES.iter().position(|s| *s == first).unwrap_or(0);
        let strokes = match form {
            Form::Points | Form::Band => 1,
            _ => STROKES.len(),
        };
        let colours = std::iter::once(colour).chain(METHOD_COLOURS.into_iter().rev());
        let candidates =
            colours.flat_map(|colour| (0..strokes).map(move |k| (colour, STROKES[(start + k) % STROKES.len()])));
        let taken = |style: &(Colour, Stroke)| self.assigned.iter().any(|g| g.sample == sample && g.style == *style);
        let style = candidates.into_iter().find(|style| !taken(style)).unwrap_or((colour, first));
        self.assigned.push(Assigned { label: label.to_owned(), meaning, sample, style });
        style
    }
}

/// The usual colour and stroke of a meaning.
fn usual(meaning: Meaning, form: Form) -> (Colour, Stroke) {
    let (colour, stroke) = match meaning {
        Meaning::Truth => (Colour::Ink, Stroke::Dashed),
        Meaning::Measured => (Colour::Muted, Stroke::Solid),
        Meaning::Command => (Colour::Ink, Stroke::Solid),
        Meaning::Bound => (Colour::Muted, Stroke::Dashed),
        Meaning::Flagship => (Colour::Blue, Stroke::Solid),
        Meaning::Method(number) => {
            let round = number / METHOD_COLOURS.len();
            (METHOD_COLOURS[number % METHOD_COLOURS.len()], STROKES[round % STROKES.len()])
        }
    };
    match form {
        Form::Points | Form::Band => (colour, Stroke::Solid),
        // A level must not look like a curve that happens to be constant.
        Form::Level | Form::Instant if stroke == Stroke::Solid => (colour, Stroke::Dotted),
        _ => (colour, stroke),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_meanings_have_equal_colours_and_different_entries_different_styles() {
        let mut first = Styles::default();
        let mut second = Styles::default();
        // The order of appearance does not matter.
        let a = first.of("printed law, delayed", Meaning::Method(0), Form::Line);
        first.of("printed law, implicit", Meaning::Method(1), Form::Line);
        second.of("printed law, implicit", Meaning::Method(1), Form::Line);
        assert_eq!(second.of("printed law, delayed", Meaning::Method(0), Form::Line), a);
        // Thirty entries of one meaning have different styles, as far as there are so many: 6 colours by 4 strokes.
        let mut styles = Styles::default();
        let mut seen = Vec::new();
        for k in 0..20 {
            let style = styles.of(&format!("run {k}"), Meaning::Flagship, Form::Line);
            assert!(!seen.contains(&style), "{style:?} twice");
            seen.push(style);
        }
        assert_eq!(styles.of("run 3", Meaning::Flagship, Form::Line), seen[3]);
    }

    #[test]
    fn every_meaning_has_another_style() {
        let meanings = [Meaning::Truth, Meaning::Measured, Meaning::Command, Meaning::Bound, Meaning::Flagship];
        let all = meanings.into_iter().chain((0..20).map(Meaning::Method));
        let mut seen = Vec::new();
        for meaning in all {
            let style = usual(meaning, Form::Line);
            assert!(!seen.contains(&style), "{meaning:?}");
            seen.push(style);
        }
    }

    #[test]
    fn a_level_is_not_taken_for_a_curve_but_shares_the_entry_of_the_same_name() {
        let mut styles = Styles::default();
        let curve = styles.of("flagship", Meaning::Flagship, Form::Line);
        assert_ne!(styles.of("rests at", Meaning::Flagship, Form::Level), curve);
        assert_eq!(styles.of("flagship", Meaning::Flagship, Form::Level), curve);
    }
}
