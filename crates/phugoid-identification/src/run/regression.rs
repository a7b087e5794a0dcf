//! Methods on a regression without derivatives, and the gradient law. Their states come from the kinematic front end.

use phugoid_estimators::adaptive_model::AdaptiveModel;
use phugoid_estimators::fourier::FourierRegression;
use phugoid_estimators::implicit_sign::ImplicitSign;
use phugoid_estimators::regression::Regression;
use phugoid_estimators::rls::RecursiveLeastSquares;
use phugoid_estimators::settings::{EstimatorSettings, SettingsError};
use phugoid_estimators::super_twisting::SuperTwisting;

use super::causal::Causal;
use crate::error::EstimateError;
use crate::front_end::KinematicFrontEnd;
use crate::model_file::ModelFile;
use crate::motion::MotionModel;

/// Half ranges per second that the implicit sign moves a parameter at most.
const REACHING_RATE: f64 = 2.0;

fn refused(error: SettingsError) -> EstimateError {
    EstimateError::Model(error.to_string())
}

/// The regression of a motion, with states from the kinematic front end.
type Rows<M, const N: usize, const R: usize, const P: usize> = Regression<M, KinematicFrontEnd<M, N, R>, N, R, P>;

fn rows<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    model: M,
    settings: &EstimatorSettings<N, R, P>,
    file: &ModelFile,
) -> Result<Rows<M, N, R, P>, EstimateError> {
    let states = KinematicFrontEnd::<M, N, R>::new(file.aircraft.gravity, settings);
    Regression::new(model, states, *settings).map_err(refused)
}

/// Recursive least squares.
pub(super) struct LeastSquares;

impl Causal for LeastSquares {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> =
        RecursiveLeastSquares<Rows<M, N, R, P>, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        Ok(RecursiveLeastSquares::new(rows(model, settings, file)?))
    }
}

/// Recursive Fourier-transform regression.
pub(super) struct Fourier;

impl Causal for Fourier {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> =
        FourierRegression<M, KinematicFrontEnd<M, N, R>, N, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        FourierRegression::new(rows(model, settings, file)?).map_err(refused)
    }
}

/// Model reference by rule.
pub(super) struct ByModelReference;

impl Causal for ByModelReference {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> = AdaptiveModel<M, N, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        _file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        AdaptiveModel::new(model, settings).map_err(|error| match error {
            SettingsError::NoOutput => EstimateError::Model(
                "model-reference needs a measurement with a noise level for every state of the motion".to_owned(),
            ),
            other => refused(other),
        })
    }
}

/// Implicit sign on the least-squares surface.
pub(super) struct BySign;

impl Causal for BySign {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> =
        ImplicitSign<Rows<M, N, R, P>, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        ImplicitSign::new(rows(model, settings, file)?, REACHING_RATE).map_err(refused)
    }
}

/// Super-twisting on mixed regressors.
pub(super) struct BySuperTwisting;

impl Causal for BySuperTwisting {
    type Estimator<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> =
        SuperTwisting<Rows<M, N, R, P>, R, P>;

    fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
        model: M,
        settings: &EstimatorSettings<N, R, P>,
        file: &ModelFile,
    ) -> Result<Self::Estimator<M, N, R, P>, EstimateError> {
        Ok(SuperTwisting::new(rows(model, settings, file)?))
    }
}
