//! Colours and strokes by meaning.

use phugoid_evaluation::chart::Meaning;

use crate::figure::{Colour, Stroke};

/// Colours of methods beside the flagship, in their order.
const METHOD_COLOURS: [Colour; 5] = [Colour::Vermillion, Colour::Green, Colour::Purple, Colour::Orange, Colour::Sky];

/// Strokes in the order in which they are given to entries that would otherwise look the same.
const STROKES: [Stroke; 4] = [Stroke::Solid, Stroke::Dashed, Stroke::DashDotted, Stroke::Dotted];

/// What shows a legend entry: two entries of different forms are told apart by it alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A curve.
    Line,
    /// A horizontal line; a curve and a level of one meaning and one label are one entry.
    Level,
    /// A vertical line.
    Instant,
    /// Dots.
    Points,
    /// An area.
    Band,
}

impl Form {
    /// Curves and levels have the same sample in the legend.
    fn sample(self) -> Self {
        if self == Self::Level { Self::Line } else { self }
    }
}

/// The entries of one chart with their looks.
#[derive(Default)]
pub(super) struct Looks {
    given: Vec<Given>,
}

struct Given {
    label: String,
    meaning: Meaning,
    sample: Form,
    look: (Colour, Stroke),
}

impl Looks {
    /// The look of an entry: that of its meaning, or the nearest one that no other entry of the chart has.
    pub(super) fn of(&mut self, label: &str, meaning: Meaning, form: Form) -> (Colour, Stroke) {
        let sample = form.sample();
        let known = self.given.iter().find(|g| g.label == label && g.meaning == meaning && g.sample == sample);
        if let Some(known) = known {
            return known.look;
        }
        let (colour, first) = usual(meaning, form);
        // What is not in the legend cannot be taken for another entry.
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
        let taken = |look: &(Colour, Stroke)| self.given.iter().any(|g| g.sample == sample && g.look == *look);
        let look = candidates.into_iter().find(|look| !taken(look)).unwrap_or((colour, first));
        self.given.push(Given { label: label.to_owned(), meaning, sample, look });
        look
    }
}

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
        // A level is no curve, and must not be taken for one that happens to be constant.
        Form::Level | Form::Instant if stroke == Stroke::Solid => (colour, Stroke::Dotted),
        _ => (colour, stroke),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_meanings_have_equal_colours_and_different_entries_different_looks() {
        let mut first = Looks::default();
        let mut second = Looks::default();
        // The order of appearance does not matter.
        let a = first.of("printed law, delayed", Meaning::Method(0), Form::Line);
        first.of("printed law, implicit", Meaning::Method(1), Form::Line);
        second.of("printed law, implicit", Meaning::Method(1), Form::Line);
        assert_eq!(second.of("printed law, delayed", Meaning::Method(0), Form::Line), a);
        // Thirty entries of one meaning are thirty looks as far as there are so many: 6 colours by 4 strokes.
        let mut looks = Looks::default();
        let mut seen = Vec::new();
        for k in 0..20 {
            let look = looks.of(&format!("run {k}"), Meaning::Flagship, Form::Line);
            assert!(!seen.contains(&look), "{look:?} twice");
            seen.push(look);
        }
        assert_eq!(looks.of("run 3", Meaning::Flagship, Form::Line), seen[3]);
    }

    #[test]
    fn every_meaning_looks_different() {
        let meanings = [Meaning::Truth, Meaning::Measured, Meaning::Command, Meaning::Bound, Meaning::Flagship];
        let all = meanings.into_iter().chain((0..20).map(Meaning::Method));
        let mut seen = Vec::new();
        for meaning in all {
            let look = usual(meaning, Form::Line);
            assert!(!seen.contains(&look), "{meaning:?}");
            seen.push(look);
        }
    }

    #[test]
    fn a_level_is_not_taken_for_a_curve_but_shares_the_entry_of_the_same_name() {
        let mut looks = Looks::default();
        let curve = looks.of("flagship", Meaning::Flagship, Form::Line);
        assert_ne!(looks.of("rests at", Meaning::Flagship, Form::Level), curve);
        assert_eq!(looks.of("flagship", Meaning::Flagship, Form::Level), curve);
    }
}
