//! Methods that carry state and parameters together.

use phugoid_estimators::Inspect;
use phugoid_estimators::ekf::{EkfSettings, JointEkf};
use phugoid_estimators::smpe::{Smpe, SmpeSettings};

use super::causal::Causal;
use crate::error::EstimateError;
use crate::model_file::ModelFile;
use crate::motion::MotionModel;

/// SMPE (docs/theory.md).
pub(super) struct SlidingMode;

impl Causal for SlidingMode {
    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &SmpeSettings<N, R, P>,
        _file: &ModelFile,
    ) -> Result<impl Inspect<R, P, Input = M::KnownInput>, EstimateError> {
        Smpe::new(model, *settings).map_err(|e| EstimateError::Model(e.to_string()))
    }
}

/// The joint extended Kalman filter, with the gate of four sigmas.
pub(super) struct ExtendedKalman;

impl Causal for ExtendedKalman {
    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &SmpeSettings<N, R, P>,
        _file: &ModelFile,
    ) -> Result<impl Inspect<R, P, Input = M::KnownInput>, EstimateError> {
        JointEkf::new(model, EkfSettings::new(*settings)).map_err(|e| EstimateError::Model(e.to_string()))
    }
}
