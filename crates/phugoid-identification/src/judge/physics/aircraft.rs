//! Checks of the aircraft in the model file: wing, moments of inertia, radii of gyration.

use super::finding::reason;
use crate::core::estimation::VerdictReason;
use crate::methods::Task;
use crate::motion::Motion;
use phugoid_flight_data::statistics::median;

/// The aircraft as a rigid body, SI; medians where the flight recorded them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Body {
    pub(super) mass: f64,
    pub(super) ixx: Option<f64>,
    pub(super) iyy: f64,
    pub(super) izz: Option<f64>,
    pub(super) ixz: Option<f64>,
    pub(super) wing_area: f64,
    pub(super) mean_chord: f64,
    pub(super) wing_span: Option<f64>,
}

impl Body {
    pub(super) fn of<M: Motion<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> Self {
        let aircraft = &task.file.aircraft;
        let known = |name: &str| {
            let signal = task.prepared.known.iter().find(|signal| signal.name == name)?;
            median(&mut signal.values.iter().copied().filter(|v| v.is_finite()).collect::<Vec<f64>>())
        };
        Self {
            mass: known("mass").unwrap_or(f64::NAN),
            ixx: known("ixx"),
            iyy: known("iyy").unwrap_or(f64::NAN),
            izz: known("izz"),
            ixz: known("ixz"),
            wing_area: aircraft.wing_area,
            mean_chord: aircraft.mean_chord,
            wing_span: aircraft.wing_span,
        }
    }

    /// Aspect ratio, where the span is given.
    pub(super) fn aspect_ratio(&self) -> Option<f64> {
        Some(self.wing_span?.powi(2) / self.wing_area).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
    }
}

/// Span times chord over area: 1 for a rectangle, 4/3 for a triangle, a half for a biplane whose area is that of both
/// wings. With the chord of the root or the length of the body as the reference, which deltas and lifting bodies have, it is 2 and
/// more (2.16 for the X-24B). A length in feet makes 3.28 of 1, and an area in square feet a tenth.
pub(crate) const CHORD: [f64; 2] = [0.45, 2.7];
/// Aspect ratios from lifting bodies to record gliders.
pub(crate) const ASPECT_RATIO: [f64; 2] = [0.7, 55.0];

/// Area, chord and span have to belong to one wing: the definition of the mean aerodynamic chord, `integral of c^2 dy /
/// S`, lets `b cbar / S` be between 1 and 4/3 for wings of straight edges (E. Torenbeek, *Synthesis of Subsonic Airplane
/// Design*, Delft 1976, appendix A).
pub(super) fn wing(body: &Body) -> Option<VerdictReason> {
    let within = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
    let of_chord = body.wing_area / body.mean_chord.powi(2);
    if let (Some(span), Some(ratio)) = (body.wing_span, body.aspect_ratio()) {
        let fit = span * body.mean_chord / body.wing_area;
        if within(fit, CHORD) && within(ratio, ASPECT_RATIO) {
            return None;
        }
        return Some(reason(
            false,
            &["[aircraft] wing_area", "[aircraft] mean_chord", "[aircraft] wing_span"],
            format!(
                "Check the wing under [aircraft]: wing_span {span:.4} m, mean_chord {:.4} m and wing_area {:.4} m^2 do not \
                 belong to one wing: span times chord is {fit:.2} times the area (about 1 to 1.3 is expected), the aspect \
                 ratio {ratio:.2}. One of them is probably in feet: give units, `wing_area = \"300 ft^2\"`.",
                body.mean_chord, body.wing_area
            ),
        ));
    }
    (!within(of_chord, ASPECT_RATIO)).then(|| {
        reason(
            false,
            &["[aircraft] wing_area", "[aircraft] mean_chord"],
            format!(
                "Check the wing under [aircraft]: wing_area {:.4} m^2 over the square of mean_chord {:.4} m gives an aspect \
                 ratio of {of_chord:.2}. One of the two is probably in feet: give units, `mean_chord = \"5 ft\"`.",
                body.wing_area, body.mean_chord
            ),
        )
    })
}

/// The same for wings that are no lifting bodies or deltas: 27 of 28 aircraft of another simulator are between 0.75 and 1.2.
const WING: [f64; 2] = [0.65, 1.6];
/// Smallest aspect ratio of those.
const LEAST_ASPECT_RATIO: f64 = 2.5;

/// What to say beside numbers that stand, if area, chord and span belong to no usual wing: moments per an unusual reference length
/// are as good as others, for whoever uses the same one.
pub(in crate::judge) fn remark<M: Motion<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
) -> Option<String> {
    unusual_wing(&Body::of(task))
}

fn unusual_wing(body: &Body) -> Option<String> {
    let fit = body.wing_span? * body.mean_chord / body.wing_area;
    let usual = body.aspect_ratio()? < LEAST_ASPECT_RATIO || (WING[0]..=WING[1]).contains(&fit) || wing(body).is_some();
    (!usual).then(|| {
        format!(
            "Check the wing under [aircraft]: span times chord is {fit:.2} times the area, and 1 to 1.3 is usual (about a half for a \
             biplane with the area of both wings). All coefficients go with one over wing_area, and those of moments with one over \
             mean_chord too: the numbers stand for whoever means these reference values, and are wrong by the same factor otherwise."
        )
    })
}

/// `Izz / (Ixx + Iyy)`: 1 for a flat body; never more, but for the scatter of estimated data.
pub(crate) const FLAT: [f64; 2] = [0.55, 1.1];
/// From here on no body has these moments.
const NO_BODY: f64 = 1.5;

/// Moments of inertia of one body: `Ixx + Iyy - Izz = 2 integral of z^2 dm`, which is positive and small for an
/// aeroplane, flat as it is. Thirty published aircraft lie between 0.71 and 1.03 (R. K. Heffley, W. F. Jewell, *Aircraft
/// Handling Qualities Data*, NASA CR-2144, 1972, and others).
pub(super) fn inertia(body: &Body) -> Option<VerdictReason> {
    let (ixx, izz) = (body.ixx?, body.izz?);
    let ratio = izz / (ixx + body.iyy);
    (ratio.is_finite() && !(FLAT[0]..=FLAT[1]).contains(&ratio)).then(|| {
        reason(
            ratio > NO_BODY,
            &["[aircraft] ixx", "[aircraft] iyy", "[aircraft] izz"],
            format!(
                "Check ixx, iyy and izz under [aircraft]: izz is {ratio:.2} times the sum of the other two, and about 0.7 \
                 to 1 is expected of an aeroplane, at most 1 of any body. One of them is in another unit or has a wrong \
                 digit."
            ),
        )
    })
}

/// Radius of gyration in roll over the span.
const ROLL: [f64; 2] = [0.075, 0.28];
/// Radius of gyration in yaw over the span.
const YAW: [f64; 2] = [0.11, 0.65];
/// Radius of gyration in pitch over the root of span times chord, and over the chord alone where the span is not given.
const PITCH: [f64; 2] = [0.235, 0.95];
const PITCH_BY_CHORD: [f64; 2] = [0.25, 2.6];

/// Radii of gyration of the size of the aircraft. D. P. Raymer (*Aircraft Design: A Conceptual Approach*, AIAA, chapter
/// 16) and J. Roskam (*Airplane Design*, part V, appendix B) give `Rx = 2 kx / b` of 0.2 to 0.38, and `Ry`, `Rz` of 0.25 to
/// 0.54 of lengths that a model file does not hold; so pitch is held against chord and span. The limits leave the
/// thirty aircraft of [`inertia`] (`kx/b` 0.085 to 0.245, `ky/sqrt(b cbar)` 0.27 to 0.85, `kz/b` 0.125 to 0.58) a margin of
/// a tenth; the chord alone says less.
pub(super) fn radii(body: &Body) -> Vec<VerdictReason> {
    let radius = |inertia: f64| (inertia / body.mass).sqrt();
    let pitch = match body.wing_span {
        Some(span) => (radius(body.iyy) / (span * body.mean_chord).sqrt(), PITCH, "the root of span times chord"),
        None => (radius(body.iyy) / body.mean_chord, PITCH_BY_CHORD, "the chord"),
    };
    let roll = body.ixx.zip(body.wing_span).map(|(ixx, span)| ("ixx", (radius(ixx) / span, ROLL, "the span")));
    let yaw = body.izz.zip(body.wing_span).map(|(izz, span)| ("izz", (radius(izz) / span, YAW, "the span")));
    let every = [roll, Some(("iyy", pitch)), yaw].into_iter().flatten();
    let out = every.filter(|(_, (value, [low, high], _))| value.is_finite() && !(low..=high).contains(&value));
    out.map(|(name, (value, [low, high], of))| {
        let key = format!("[aircraft] {name}");
        reason(
            false,
            &[key.as_str(), "[aircraft] mass"],
            format!(
                "Check {name} and mass under [aircraft]: the radius of gyration is {value:.3} times {of}, and {low} to {high} \
                 is what aeroplanes have. One of them is in another unit (kg m^2, kg) or has a wrong digit."
            ),
        )
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::estimation::EstimationStatus;

    /// A light single of the numbers of JSBSim's c182.
    const LIGHT: Body = Body {
        mass: 1034.0,
        ixx: Some(2827.0),
        iyy: 1913.0,
        izz: Some(4169.0),
        ixz: None,
        wing_area: 16.17,
        mean_chord: 1.494,
        wing_span: Some(10.91),
    };

    #[test]
    fn a_sound_aircraft_passes() {
        assert_eq!((wing(&LIGHT), inertia(&LIGHT), radii(&LIGHT)), (None, None, Vec::new()));
        let alone = Body { ixx: None, izz: None, wing_span: None, ..LIGHT };
        assert_eq!((wing(&alone), inertia(&alone), radii(&alone)), (None, None, Vec::new()));
    }

    /// The X-24B as JSBSim describes it: its reference length is that of the body. Moments per this length are as good as others.
    #[test]
    fn a_reference_length_is_no_error_of_units() {
        let lifting_body = Body {
            mass: 4627.0,
            ixx: Some(3593.0),
            iyy: 32146.0,
            izz: Some(32702.0),
            ixz: None,
            wing_area: 30.7,
            mean_chord: 11.43,
            wing_span: Some(5.791),
        };
        assert_eq!(wing(&lifting_body), None);
        let in_feet = Body { mean_chord: 37.5, ..lifting_body };
        assert!(wing(&in_feet).unwrap().sentence.contains("feet"));
    }

    #[test]
    fn an_area_or_a_chord_that_is_twice_too_large_is_remarked() {
        for spoilt in [
            Body { wing_area: 2.0 * LIGHT.wing_area, ..LIGHT },
            Body { wing_area: 0.5 * LIGHT.wing_area, ..LIGHT },
            Body { mean_chord: 2.0 * LIGHT.mean_chord, ..LIGHT },
            Body { mean_chord: 0.5 * LIGHT.mean_chord, ..LIGHT },
        ] {
            assert!(wing(&spoilt).is_none() && unusual_wing(&spoilt).unwrap().contains("span times chord"));
        }
        // In feet it is a reason, which is told in its place; a slender delta, and no span.
        let delta = Body { mean_chord: 27.7, wing_span: Some(25.6), wing_area: 358.0, ..LIGHT };
        let in_feet = Body { mean_chord: 1.494 / 0.3048, ..LIGHT };
        for told in [LIGHT, in_feet, delta, Body { wing_span: None, ..LIGHT }] {
            assert_eq!(unusual_wing(&told), None);
        }
    }

    #[test]
    fn a_wing_in_two_units_is_doubtful() {
        for spoilt in [
            Body { wing_area: 16.17 / 0.3048_f64.powi(2), ..LIGHT },
            Body { mean_chord: 1.494 / 0.3048, ..LIGHT },
            Body { wing_span: Some(10.91 / 0.3048), ..LIGHT },
            Body { wing_area: 16.17 / 0.3048_f64.powi(2), wing_span: None, ..LIGHT },
            Body { mean_chord: 1.494 / 0.3048, wing_span: None, ..LIGHT },
        ] {
            let found = wing(&spoilt).unwrap();
            assert_eq!(found.status, EstimationStatus::Doubtful);
            assert!(found.sentence.contains("feet"), "{}", found.sentence);
        }
    }

    #[test]
    fn inertias_that_are_ten_times_wrong_are_named() {
        let spoilt = |ixx: f64, iyy: f64, izz: f64| Body {
            ixx: Some(ixx * 2827.0),
            iyy: iyy * 1913.0,
            izz: Some(izz * 4169.0),
            ..LIGHT
        };
        assert_eq!(inertia(&spoilt(10.0, 1.0, 1.0)).unwrap().status, EstimationStatus::Doubtful);
        assert_eq!(inertia(&spoilt(1.0, 10.0, 1.0)).unwrap().status, EstimationStatus::Doubtful);
        assert_eq!(inertia(&spoilt(1.0, 1.0, 10.0)).unwrap().status, EstimationStatus::Refused);
        assert_eq!(inertia(&spoilt(1.0, 1.0, 0.1)).unwrap().status, EstimationStatus::Doubtful);
        // Slug square feet read as kg m^2, all three: the mass is then 1.36 times too much; pounds make 2.2.
        assert_eq!(radii(&spoilt(10.0, 10.0, 10.0)).len(), 2);
        assert!(radii(&Body { mass: 10340.0, ..LIGHT })[0].concerns.contains(&"[aircraft] mass".to_owned()));
    }
}
