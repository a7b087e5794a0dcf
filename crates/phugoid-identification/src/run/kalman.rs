//! Methods that carry state and parameters together.

use phugoid_estimators::ekf::JointEkf;
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::smpe::Smpe;

use super::causal::Causal;
use crate::error::EstimateError;
use crate::model_file::ModelFile;
use crate::motion::MotionModel;

/// SMPE (docs/theory.md).
pub(super) struct SlidingMode;

impl Causal for SlidingMode {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> = Smpe<M, N, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        _file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        Smpe::new(model, *settings).map_err(|e| EstimateError::Model(e.to_string()))
    }
}

/// The joint extended Kalman filter, with the gate of four sigmas.
pub(super) struct ExtendedKalman;

impl Causal for ExtendedKalman {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> = JointEkf<M, N, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        _file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        JointEkf::new(model, *settings).map_err(|e| EstimateError::Model(e.to_string()))
    }
}
