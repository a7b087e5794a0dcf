//! Coefficients and thrust of models in DAVE-ML, found by their standard names.

use std::path::Path;

use phugoid_flight_dynamics::aircraft::Geometry;
use phugoid_flight_dynamics::scalar::Scalar;

use super::super::error::FlownError;
use super::wiring::value;
use crate::daveml::{Evaluator, Model};
use crate::vehicle::VehicleError;
use crate::vehicle::named::{ABOUT, ALONG, FORCE, MOMENT, NUMBER, Names, Output, missing};

/// How the force in the plane of symmetry is stated.
#[derive(Clone, Copy, Debug)]
enum InPlane {
    /// Along body x and z.
    Body([Output; 2]),
    /// Lift, and drag against the motion through the air.
    Wind([Output; 2]),
    /// Lift, and drag against the part of that motion in the plane of symmetry, as `phugoid estimate --export daveml` writes.
    Stability([Output; 2]),
}

/// Where the coefficients are.
#[derive(Clone, Debug)]
pub(super) struct Outputs {
    in_plane: InPlane,
    /// Side force, rolling and yawing moment; none of a model of the longitudinal motion alone.
    lateral: Option<[Output; 3]>,
    pitch: Output,
    /// From the centre of gravity to the moment reference point, body axes, m.
    arm_m: [f64; 3],
    all: Vec<Output>,
}

impl Outputs {
    pub(super) fn find(models: &[Model], file: &Path, notes: &mut Vec<String>) -> Result<Self, FlownError> {
        let names = Names { models };
        let inner = || -> Result<(InPlane, [Option<Output>; 3], Output), VehicleError> {
            let find = |name: &str| names.find(name, NUMBER);
            let pair = |a: &str, b: &str| -> Result<Option<[Output; 2]>, VehicleError> {
                Ok(find(a)?.zip(find(b)?).map(|(a, b)| [a, b]))
            };
            let in_plane = if let Some(found) = pair("aeroBodyForceCoefficient_X", "aeroBodyForceCoefficient_Z")? {
                InPlane::Body(found)
            } else if let Some(found) = pair("totalCoefficientOfLift", "totalCoefficientOfDrag")? {
                InPlane::Wind(found)
            } else if let Some(found) =
                pair("coefficient of lift, stability axes", "coefficient of drag, stability axes")?
            {
                InPlane::Stability(found)
            } else {
                let either = "aeroBodyForceCoefficient_X and _Z, or totalCoefficientOfLift and totalCoefficientOfDrag,";
                return Err(missing(either));
            };
            let lateral = [
                find("aeroBodyForceCoefficient_Y")?,
                find("aeroBodyMomentCoefficient_Roll")?,
                find("aeroBodyMomentCoefficient_Yaw")?,
            ];
            Ok((in_plane, lateral, names.need("aeroBodyMomentCoefficient_Pitch", NUMBER)?))
        };
        let vehicle = |source| FlownError::Vehicle { file: file.into(), source };
        let (in_plane, lateral, pitch) = inner().map_err(vehicle)?;
        let lateral = match lateral {
            [Some(y), Some(l), Some(n)] => Some([y, l, n]),
            [None, None, None] => {
                notes.push("The models know no side force, rolling or yawing moment: these are zero.".to_owned());
                None
            }
            _ => {
                let name = "aeroBodyForceCoefficient_Y, aeroBodyMomentCoefficient_Roll and _Yaw (all three or none)";
                return Err(vehicle(missing(name)));
            }
        };
        let (InPlane::Body(pair) | InPlane::Wind(pair) | InPlane::Stability(pair)) = in_plane;
        let all = pair.into_iter().chain(lateral.into_iter().flatten()).chain([pitch]).collect();
        Ok(Self { in_plane, lateral, pitch, arm_m: [0.0; 3], all })
    }

    /// The same with this arm from the centre of gravity to the moment reference point, m.
    pub(super) fn moved_by(self, arm_m: [f64; 3]) -> Self {
        Self { arm_m, ..self }
    }

    pub(super) fn all(&self) -> &[Output] {
        &self.all
    }

    /// Coefficients in body axes about the centre of gravity, after the models were evaluated.
    pub(super) fn coefficients<T: Scalar>(
        &self,
        evaluators: &[Evaluator<T>],
        alpha: T,
        beta: T,
        geometry: &Geometry,
    ) -> [T; 6] {
        let of = |output: Output| value(evaluators, output);
        let zero = T::from(0.0);
        let [side, roll, yaw] = self.lateral.map_or([zero; 3], |outputs| outputs.map(of));
        let turned = |lift: T, drag: T| {
            let (s, c) = alpha.sin_cos();
            [lift * s - drag * c, -(lift * c) - drag * s]
        };
        let (cx, cy, cz) = match self.in_plane {
            InPlane::Body([x, z]) => (of(x), side, of(z)),
            InPlane::Wind([lift, drag]) => {
                let (sideways, ahead) = beta.sin_cos();
                let (lift, drag) = (of(lift), of(drag));
                let [x, z] = turned(lift, drag * ahead);
                (x, side - drag * sideways, z)
            }
            InPlane::Stability([lift, drag]) => {
                let [x, z] = turned(of(lift), of(drag));
                (x, side, z)
            }
        };
        let Geometry { span, mean_chord, .. } = *geometry;
        let [x, y, z] = self.arm_m;
        [
            cx,
            cy,
            cz,
            roll + (cz * y - cy * z) / span,
            of(self.pitch) + (cx * z - cz * x) / mean_chord,
            yaw + (cy * x - cx * y) / span,
        ]
    }
}

/// Where force and moment of the thrust are.
#[derive(Clone, Debug)]
pub(super) struct ThrustOutputs {
    axes: [Option<Output>; 6],
    all: Vec<Output>,
}

impl ThrustOutputs {
    /// None where no model has a force of thrust.
    pub(super) fn find(models: &[Model], file: &Path) -> Result<Option<Self>, FlownError> {
        let names = Names { models };
        let vehicle = |source| FlownError::Vehicle { file: file.into(), source };
        let [x, y, z] = names.axes("thrustBodyForce", ALONG, FORCE).map_err(vehicle)?;
        let [l, m, n] = names.axes("thrustBodyMoment", ABOUT, MOMENT).map_err(vehicle)?;
        let axes = [x, y, z, l, m, n];
        let some = [x, y, z].iter().any(Option::is_some);
        Ok(some.then(|| Self { axes, all: axes.into_iter().flatten().collect() }))
    }

    pub(super) fn all(&self) -> &[Output] {
        &self.all
    }

    /// Force, N, and moment, N m, after the models were evaluated.
    pub(super) fn values<T: Scalar>(&self, evaluators: &[Evaluator<T>]) -> [T; 6] {
        self.axes.map(|axis| axis.map_or(T::from(0.0), |output| value(evaluators, output)))
    }
}
