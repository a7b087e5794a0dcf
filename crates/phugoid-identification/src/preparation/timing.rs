//! How the surfaces moved between the samples of a record, where the model file does not say it.
//!
//! A record holds either the positions of the surfaces, which ran straight to the next sample as far as is known, or the
//! commands of a computer, which were held until the next one; and either may have been stamped late or early. The moment
//! equation shows at what time the aircraft reacted ([`super::windows::delay`]): in time for positions, half a sample
//! early for held commands, and anything else is a skew, by which the surface is moved.

use crate::model_file::{InputHold, ModelFile};
use crate::motion::Motion;
use crate::preparation::prepared::Prepared;
use crate::preparation::windows::SIGNIFICANT;
use crate::preparation::windows::delay::{Delay, SurfaceDelay, surfaces};

/// Standard errors, of delays by regressions over windows, within which a surface counts as recorded in time, ...
const NEAR: f64 = 3.0;
/// ... or so many samples: held and interpolated are half a sample apart.
const NEAR_SAMPLES: f64 = 0.25;
/// A skew explains at least this part of what the moment equation leaves without it: the terms that the equation lacks make
/// delays that are as significant, and explain less.
const EXPLAINS: f64 = 0.25;
/// A skew beyond this is none that a recorder makes, s: the record stays as it is, and the verdict names it.
const LONGEST_S: f64 = 0.3;

/// What was found of the time of the surfaces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timing {
    /// How they move between samples.
    pub(crate) hold: InputHold,
    /// Surfaces to be moved, and how late they were recorded, s.
    pub(crate) late_s: Vec<(&'static str, f64)>,
    /// What was decided, and on which grounds.
    pub(crate) notes: Vec<String>,
}

/// Decides how the surfaces of a prepared record moved.
pub(crate) fn timing<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    file: &ModelFile,
) -> Timing {
    decide(&surfaces(prepared, file))
}

fn decide(found: &[SurfaceDelay]) -> Timing {
    if found.is_empty() {
        let note = "`input`: whether the surfaces were held between samples cannot be seen in this record (too short, no flow \
                    angle, or motion that no surface made); they are taken as held, and half a sample more or less is not \
                    in the bounds";
        return Timing { hold: InputHold::Held, late_s: Vec::new(), notes: vec![note.to_owned()] };
    }
    let said = |s: &SurfaceDelay| {
        format!("the {} was recorded {:+.1} ± {:.1} ms late", s.name, 1e3 * s.delay.late_s, 2e3 * s.delay.std_s)
    };
    let grounds = found.iter().map(said).collect::<Vec<_>>().join(", ");
    let fits = |hold: InputHold| found.iter().all(|s| is_near(off(s, hold), s));
    let (held, interpolated) = (fits(InputHold::Held), fits(InputHold::Interpolated));
    if !(held || interpolated) && found.iter().any(is_skewed) {
        return skewed(found, &grounds);
    }
    let nearer_held = distance(found, InputHold::Held) < distance(found, InputHold::Interpolated);
    let hold = if held && (nearer_held || !interpolated) || !interpolated && nearer_held {
        InputHold::Held
    } else {
        InputHold::Interpolated
    };
    let word = if hold == InputHold::Held { "were held" } else { "moved straight" };
    let sure = if held == interpolated {
        ". This is not certain, and half a sample more or less is not in the bounds"
    } else {
        ""
    };
    let note =
        format!("`input`: the surfaces {word} between samples: {grounds} against straight lines (two sigma){sure}");
    Timing { hold, late_s: Vec::new(), notes: vec![note] }
}

/// How far the delays are from those of surfaces that move in this way: the sum of the squares in standard errors.
fn distance(found: &[SurfaceDelay], hold: InputHold) -> f64 {
    found.iter().map(|s| (off(s, hold) / s.delay.std_s.max(0.01 * s.step_s)).powi(2)).sum()
}

/// How late a surface was recorded if it moves in this way, s.
fn off(surface: &SurfaceDelay, hold: InputHold) -> f64 {
    surface.delay.late_s + if hold == InputHold::Held { 0.5 * surface.step_s } else { 0.0 }
}

/// Whether a delay (s) is none, as far as that surface says.
fn is_near(late_s: f64, surface: &SurfaceDelay) -> bool {
    late_s.abs() <= (NEAR * surface.delay.std_s).max(NEAR_SAMPLES * surface.step_s)
}

/// Whether the delay of a surface is a skew beyond doubt.
fn is_skewed(surface: &SurfaceDelay) -> bool {
    let Delay { late_s, std_s, explains } = surface.delay;
    let significant = late_s.abs() > (SIGNIFICANT * std_s).max(NEAR_SAMPLES * surface.step_s);
    significant && explains >= EXPLAINS && late_s.abs() <= LONGEST_S
}

/// Takes skews out. Held positions that are moved by half a sample are straight lines, as nearly as the aircraft notices.
/// One recorder stamps all surfaces alike, so that a surface that says little is moved with the others.
fn skewed(found: &[SurfaceDelay], grounds: &str) -> Timing {
    let common = common(found).filter(|late_s| found.iter().all(|s| is_near(s.delay.late_s - late_s, s)));
    let late_s = |s: &SurfaceDelay| common.unwrap_or(if is_skewed(s) { s.delay.late_s } else { 0.0 });
    let moved: Vec<(&'static str, f64)> =
        found.iter().map(|s| (s.name, late_s(s))).filter(|(_, late_s)| *late_s != 0.0).collect();
    let by: Vec<String> = moved.iter().map(|(name, late_s)| format!("the {name} by {:+.1} ms", 1e3 * late_s)).collect();
    let note = format!(
        "`input`: {grounds} against straight lines (two sigma), by when the aircraft reacts to it, which is neither in time \
         nor held: what was recorded late was moved earlier, {}. Check time stamps and filters",
        by.join(", ")
    );
    Timing { hold: InputHold::Interpolated, notes: vec![note], late_s: moved }
}

/// The mean delay, s, each by what it says; `None` if none says anything.
fn common(found: &[SurfaceDelay]) -> Option<f64> {
    let weight = |s: &SurfaceDelay| s.delay.std_s.max(0.01 * s.step_s).powi(-2);
    let (all, sum) = found.iter().fold((0.0, 0.0), |(all, sum), s| (all + weight(s), sum + weight(s) * s.delay.late_s));
    Some(sum / all).filter(|mean| mean.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A surface at 50 Hz, by ms.
    fn surface(late: f64, std: f64, explains: f64) -> SurfaceDelay {
        let delay = Delay { late_s: 1e-3 * late, std_s: 1e-3 * std, explains };
        SurfaceDelay { name: "elevator", delay, step_s: 0.02 }
    }

    #[test]
    fn held_straight_and_skewed_are_told_apart() {
        let decided = |late, std, explains| {
            let found = decide(&[surface(late, std, explains)]);
            (found.hold, found.late_s.first().map(|moved| 1e3 * moved.1), found.notes[0].contains("not certain"))
        };
        assert_eq!(decided(0.5, 1.0, 0.0), (InputHold::Interpolated, None, false));
        assert_eq!(decided(-9.5, 1.0, 0.3), (InputHold::Held, None, false));
        assert_eq!(decided(-4.0, 4.0, 0.0), (InputHold::Interpolated, None, true));
        assert_eq!(decided(21.0, 2.0, 0.8), (InputHold::Interpolated, Some(21.0), false));
        // As significant, and it explains little: a term that the equation lacks.
        assert_eq!(decided(21.0, 2.0, 0.1), (InputHold::Interpolated, None, true));
        // No recorder is so late.
        assert_eq!(decided(400.0, 2.0, 0.9), (InputHold::Interpolated, None, true));
        assert_eq!(decide(&[]).hold, InputHold::Held);
    }

    #[test]
    fn one_recorder_stamps_all_surfaces_alike() {
        let rudder = SurfaceDelay { name: "rudder", ..surface(5.0, 9.0, 0.0) };
        let found = decide(&[surface(20.0, 1.0, 0.8), rudder]);
        assert_eq!(found.late_s.len(), 2);
        assert!(found.late_s.iter().all(|moved| (1e3 * moved.1 - 20.0).abs() < 0.5), "{found:?}");
        // In time for certain: it is not moved with the other.
        let rudder = SurfaceDelay { name: "rudder", ..surface(0.0, 1.0, 0.0) };
        assert_eq!(decide(&[surface(20.0, 1.0, 0.8), rudder]).late_s, [("elevator", 0.02)]);
    }
}
