//! How the surfaces moved between the samples of a record, where the model file does not say it.
//!
//! A record holds either the positions of the surfaces, which ran straight to the next sample as far as is known, or the
//! commands of a computer, which were held until the next one; and either may have been stamped late or early. The moment
//! equation shows at what time the aircraft reacted ([`super::reaction`]): in time for positions, half a sample early for
//! held commands, and anything else is a skew, by which the surface is moved. Which of them it was is decided by how
//! probable each is, given the times that were found and their errors.

use crate::model_file::InputHold;
use crate::preparation::reaction::delay::SurfaceDelay;

/// How probable each is before the record is looked at: held commands and recorded positions are equally usual. All surfaces
/// stamped late or early by the same time, as one recorder does it, is less usual, and each by a time of its own is rare:
/// transducers with filters of their own, or an equation that lacks something.
const HELD: f64 = 0.4;
const STRAIGHT: f64 = 0.4;
const SKEWED_ALIKE: f64 = 0.2;
const SKEWED_EACH: f64 = 0.001;
/// A skew is anything up to this, s, either way: beyond it is none that a recorder makes. The record then stays as it is, and
/// the verdict names it.
const LONGEST_S: f64 = 0.3;
/// Probability from which what is the most probable is certain.
const CERTAIN: f64 = 0.95;
/// Standard errors beyond which a time is not that of what is the most probable.
const FITS: f64 = 4.0;
/// What the equation cannot know of the time, beside its standard error: the aircraft's terms are not quite its own (s),
/// and surfaces do not run straight between samples (samples).
const EQUATION_S: f64 = 1e-3;
const EQUATION_SAMPLES: f64 = 0.05;
/// A skew is known if its two sigma are within so much: C_m_q changes by five per cent with 5 ms.
const SKEW_S: f64 = 5e-3;
const SKEW_SAMPLES: f64 = 0.3;

/// What was found of the time of the surfaces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timing {
    /// How they move between samples.
    pub(crate) hold: InputHold,
    /// True if the record tells it.
    pub(crate) is_certain: bool,
    /// Surfaces to be moved, and how late they were recorded, s.
    pub(crate) late_s: Vec<(&'static str, f64)>,
    /// One sigma of the time that stays open, s; zero where the record tells it.
    pub(crate) open_std_s: f64,
    /// What was decided, and on which grounds.
    pub(crate) notes: Vec<String>,
}

/// One sigma of the time of surfaces that are taken as held where nothing tells how they moved, s: half a `step_s` off, if they
/// ran straight.
pub(crate) fn unseen_std_s(step_s: f64) -> f64 {
    (STRAIGHT / (HELD + STRAIGHT)).sqrt() * 0.5 * step_s
}

/// Decides how the surfaces moved, from the times at which each of them was recorded. `step_s` is the sample time of the record, s.
/// What stays open of the time belongs into the bounds of the estimate, and the notes say that it is there.
pub(crate) fn timing(found: &[SurfaceDelay], step_s: f64) -> Timing {
    if found.is_empty() {
        let note = format!(
            "`input`: whether the surfaces were held between samples cannot be seen in this record (too short, no flow angle, \
             or motion that no surface made); they are taken as held, {OPEN}"
        );
        let open_std_s = unseen_std_s(step_s);
        return Timing { hold: InputHold::Held, is_certain: false, late_s: Vec::new(), notes: vec![note], open_std_s };
    }
    let said = |s: &SurfaceDelay| {
        format!("the {} was recorded {:+.1} ± {:.1} ms late", s.name, 1e3 * s.late_s, 2e3 * std_s(s))
    };
    let grounds = found.iter().map(said).collect::<Vec<_>>().join(", ");
    let Probabilities { held, straight, alike, each } = probabilities(found);
    if alike.max(each) >= CERTAIN {
        return skewed(found, alike >= each, &grounds);
    }
    let (hold, word, probability) = if held > straight {
        (InputHold::Held, "were held", held)
    } else {
        (InputHold::Interpolated, "moved straight", straight)
    };
    let fits = found.iter().all(|s| off_s(s, hold).abs() <= FITS * std_s(s));
    let percent = |probability: f64| format!("{:.1} %", 100.0 * probability);
    let grounds = format!(
        "{grounds} against straight lines (two sigma). Probability of straight lines {}, held {}, stamped late or early {}",
        percent(straight),
        percent(held),
        percent(alike + each)
    );
    let is_certain = fits && probability >= CERTAIN;
    let doubt = if is_certain {
        String::new()
    } else {
        format!(". This is not certain: the nearer of straight and held is taken, {OPEN}")
    };
    let other = if hold == InputHold::Held { straight } else { held };
    let open_std_s = if is_certain { 0.0 } else { open_std_s(found, hold, other, alike + each) };
    let note = format!("`input`: the surfaces {word} between samples: {grounds}{doubt}");
    Timing { hold, is_certain, late_s: Vec::new(), notes: vec![note], open_std_s }
}

/// One sigma of the time of surfaces that are taken to move in this way, s: the root of the mean square of how far they are off,
/// half a step if they move in the `other` way, and the time that was found with its error if they were `skewed`, each by its
/// probability.
fn open_std_s(found: &[SurfaceDelay], hold: InputHold, other: f64, skewed: f64) -> f64 {
    let of = |s: &SurfaceDelay| {
        let off_s = off_s(s, hold).hypot(std_s(s));
        // A time beyond all skews has no probability among them.
        (other * (0.5 * s.step_s).powi(2) + if skewed > 0.0 { skewed * off_s.powi(2) } else { 0.0 }).sqrt()
    };
    found.iter().map(of).fold(0.0, f64::max)
}

/// How probable each way of recording is once the times are known.
struct Probabilities {
    held: f64,
    straight: f64,
    /// All surfaces late or early by the same time.
    alike: f64,
    /// Each by a time of its own.
    each: f64,
}

/// By the theorem of Bayes: the times are normally distributed about those of held surfaces, of straight lines, and of skews
/// of which each up to the longest is as probable as any other.
fn probabilities(found: &[SurfaceDelay]) -> Probabilities {
    let against = |off_s: &dyn Fn(&SurfaceDelay) -> f64| -> f64 {
        found.iter().map(|s| 0.5 * (off_s(s) / std_s(s)).powi(2)).sum()
    };
    // The part of the skews that make what was found, by its logarithm.
    let part = |std_s: f64| ((2.0 * std::f64::consts::PI).sqrt() * std_s / (2.0 * LONGEST_S)).ln();
    let held = HELD.ln() - against(&|s| off_s(s, InputHold::Held));
    let straight = STRAIGHT.ln() - against(&|s| off_s(s, InputHold::Interpolated));
    let (mean_s, mean_std_s) = common(found);
    let alike = match mean_s.abs() <= LONGEST_S {
        true => SKEWED_ALIKE.ln() + part(mean_std_s) - against(&|s| s.late_s - mean_s),
        false => f64::NEG_INFINITY,
    };
    let each = match found.len() > 1 && found.iter().all(|s| s.late_s.abs() <= LONGEST_S) {
        true => SKEWED_EACH.ln() + found.iter().map(|s| part(std_s(s))).sum::<f64>(),
        false => f64::NEG_INFINITY,
    };
    let all = [held, straight, alike, each];
    let most = all.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = all.iter().map(|one| (one - most).exp()).sum();
    let [held, straight, alike, each] = all.map(|one| (one - most).exp() / sum);
    Probabilities { held, straight, alike, each }
}

/// What a user should know where nothing was decided.
pub(crate) const OPEN: &str = "and half a sample more or less stays open: a part of the timing of surfaces, as an error that is declared. If you know it, add the line input = \
                    \"held\" (commands) or input = \"interpolated\" (positions) to the model file, above its first [section]";

/// How late a surface was recorded if it moves in this way, s.
fn off_s(surface: &SurfaceDelay, hold: InputHold) -> f64 {
    surface.late_s + if hold == InputHold::Held { 0.5 * surface.step_s } else { 0.0 }
}

/// One sigma of the time of a surface with what the equation cannot know, s.
fn std_s(surface: &SurfaceDelay) -> f64 {
    surface.std_s.hypot(EQUATION_S).hypot(EQUATION_SAMPLES * surface.step_s)
}

/// Takes skews out. Held positions that are moved by half a sample are straight lines, as nearly as the aircraft notices.
/// Where all are `alike`, a surface that says little is moved with the others; otherwise what is near to straight lines stays.
fn skewed(found: &[SurfaceDelay], alike: bool, grounds: &str) -> Timing {
    let (mean_s, mean_std_s) = common(found);
    // How far each is moved, and one sigma of it.
    let move_of = |s: &SurfaceDelay| match alike {
        true => (mean_s, mean_std_s),
        false if s.late_s.abs() > FITS * std_s(s) => (s.late_s, std_s(s)),
        false => (0.0, std_s(s)),
    };
    let moved: Vec<(&'static str, f64)> =
        found.iter().map(|s| (s.name, move_of(s).0)).filter(|(_, late_s)| *late_s != 0.0).collect();
    let by: Vec<String> = moved.iter().map(|(name, late_s)| format!("the {name} by {:+.1} ms", 1e3 * late_s)).collect();
    let is_known = found.iter().all(|s| 2.0 * move_of(s).1 <= SKEW_S.max(SKEW_SAMPLES * s.step_s));
    let doubt = if is_known {
        String::new()
    } else {
        ". By how much is not certain: what it may be off by is a part of the timing of surfaces, as an error that is declared".to_owned()
    };
    let open_std_s = if is_known { 0.0 } else { found.iter().map(|s| move_of(s).1).fold(0.0, f64::max) };
    let note = format!(
        "`input`: {grounds} against straight lines (two sigma), by when the aircraft reacts to it, which is neither in time \
         nor held: what was recorded late was moved earlier, {}. Check time stamps and filters{doubt}",
        by.join(", ")
    );
    Timing { hold: InputHold::Interpolated, is_certain: is_known, notes: vec![note], late_s: moved, open_std_s }
}

/// The mean delay, each by what it says, and one sigma of it, s.
fn common(found: &[SurfaceDelay]) -> (f64, f64) {
    let weight = |s: &SurfaceDelay| std_s(s).powi(-2);
    let all: f64 = found.iter().map(weight).sum();
    (found.iter().map(|s| weight(s) * s.late_s).sum::<f64>() / all, all.powf(-0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.02;

    /// A surface at 50 Hz, by ms.
    fn surface(late: f64, std: f64) -> SurfaceDelay {
        SurfaceDelay { name: "elevator", late_s: 1e-3 * late, std_s: 1e-3 * std, step_s: STEP_S }
    }

    #[test]
    fn held_straight_and_skewed_are_told_apart() {
        let decided = |late, std| {
            let found = timing(&[surface(late, std)], STEP_S);
            (
                found.hold,
                found.late_s.first().map(|moved| (1e3 * moved.1).round()),
                found.notes[0].contains("not certain"),
            )
        };
        assert_eq!(decided(0.5, 1.0), (InputHold::Interpolated, None, false));
        assert_eq!(decided(-9.5, 1.0), (InputHold::Held, None, false));
        // Between the two, and where the record says little.
        assert_eq!(decided(-4.9, 1.0), (InputHold::Interpolated, None, true));
        assert_eq!(decided(0.0, 4.5), (InputHold::Interpolated, None, true));
        assert_eq!(decided(21.0, 2.0), (InputHold::Interpolated, Some(21.0), false));
        // A sample early is half a sample from held, and is told from it, or is not certain.
        assert_eq!(decided(-20.0, 1.5), (InputHold::Interpolated, Some(-20.0), false));
        assert_eq!(decided(-20.0, 3.5), (InputHold::Held, None, true));
        // Late beyond doubt, and nobody knows by how much; neither in time nor late beyond doubt.
        assert_eq!(decided(40.0, 6.0), (InputHold::Interpolated, Some(40.0), true));
        assert_eq!(decided(16.0, 4.0), (InputHold::Interpolated, None, true));
        // No recorder is so late.
        assert_eq!(decided(400.0, 2.0), (InputHold::Interpolated, None, true));
        assert_eq!(timing(&[], STEP_S).hold, InputHold::Held);
    }

    #[test]
    fn what_was_decided_is_said_with_its_error_and_what_to_do() {
        let note = |late, std| timing(&[surface(late, std)], STEP_S).notes.concat();
        assert!(note(0.5, 1.0).contains("the elevator was recorded +0.5 ± 3.5 ms late"), "{}", note(0.5, 1.0));
        assert!(note(0.5, 1.0).contains("Probability of straight lines 99."), "{}", note(0.5, 1.0));
        assert!(!note(0.5, 1.0).contains("add the line"));
        assert!(note(-4.0, 4.0).contains("add the line input = \"held\""), "{}", note(-4.0, 4.0));
        assert!(timing(&[], STEP_S).notes[0].contains("add the line input = \"held\""));
        for late in [-4.9, 40.0] {
            let said = timing(&[surface(late, 6.0)], STEP_S).notes.concat();
            assert!(said.contains("a part of the timing of surfaces"), "{late}");
        }
    }

    /// Held commands and straight lines are half a sample of 20 ms apart.
    #[test]
    fn what_stays_open_of_the_time_has_a_sigma() {
        let open_ms = |late, std| 1e3 * timing(&[surface(late, std)], STEP_S).open_std_s;
        assert_eq!((open_ms(0.5, 1.0), open_ms(-9.5, 1.0), open_ms(21.0, 2.0)), (0.0, 0.0, 0.0));
        // Nothing is known: as often half a sample off as not.
        assert!((1e3 * timing(&[], STEP_S).open_std_s - 10.0 / 2.0_f64.sqrt()).abs() < 1e-9);
        // As near to the one as to the other.
        assert!((6.9..7.5).contains(&open_ms(-5.0, 1.5)), "{}", open_ms(-5.0, 1.5));
        // Late for certain, and by how much only to its error, 6 ms with what the equation cannot know.
        assert!((6.1..6.3).contains(&open_ms(40.0, 6.0)), "{}", open_ms(40.0, 6.0));
        // It may be a skew as large as was found.
        assert!((4.0..16.5).contains(&open_ms(16.0, 4.0)), "{}", open_ms(16.0, 4.0));
        assert!(open_ms(400.0, 2.0).is_finite());
    }

    #[test]
    fn one_recorder_stamps_all_surfaces_alike() {
        let rudder = SurfaceDelay { name: "rudder", ..surface(5.0, 9.0) };
        let found = timing(&[surface(20.0, 1.0), rudder], STEP_S);
        assert_eq!(found.late_s.len(), 2);
        assert!(found.late_s.iter().all(|moved| (1e3 * moved.1 - 20.0).abs() < 0.6), "{found:?}");
        // In time for certain: it is not moved with the other.
        let rudder = SurfaceDelay { name: "rudder", ..surface(0.0, 1.0) };
        assert_eq!(timing(&[surface(20.0, 1.0), rudder], STEP_S).late_s, [("elevator", 0.02)]);
    }
}
