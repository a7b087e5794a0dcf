//! The table of the causal methods: how the estimator of each is set up in a room for `P` columns.
//!
//! Everything around an estimator works on `dyn Inspect` and is compiled once per motion and room; only what is listed
//! here is compiled once per method as well. A new causal method is an arm of [`set_up_any`] (or of [`set_up`], if it is
//! for every room) and a name in [`Method`].

use phugoid_estimators::adaptive_model::AdaptiveModel;
use phugoid_estimators::ekf::ConsideringEkf;
use phugoid_estimators::fourier::FourierRegression;
use phugoid_estimators::implicit_sign::ImplicitSign;
use phugoid_estimators::regression::Regression;
use phugoid_estimators::rls::RecursiveLeastSquares;
use phugoid_estimators::settings::{EstimatorSettings, RegressionSettings, SettingsError};
use phugoid_estimators::smpe::ConsideringSmpe;
use phugoid_estimators::super_twisting::SuperTwisting;
use phugoid_estimators::{Input, Inspect};

use crate::core::error::EstimateError;
use crate::core::method::Method;
use crate::core::systematic::{ROOM_FOR_CONSTANTS, ROOM_FOR_CONSTANTS_OF_A_PLANE};
use crate::motion::MotionModel;
use crate::preparation::front_end::KinematicFrontEnd;

/// Half ranges per second that the implicit sign moves a parameter at most.
const REACHING_RATE: f64 = 2.0;

/// An estimator on the heap, whatever its method: with room for 48 columns it is too large for the stack of a thread.
pub(super) type Boxed<I, const R: usize, const P: usize> = Box<dyn Inspect<R, P, Input = I> + Send>;

/// Sets the estimator of a method up: [`set_up`] or [`set_up_any`].
pub(super) type SetUp<M, I, const N: usize, const R: usize, const P: usize> =
    fn(Method, M, &EstimatorSettings<N, R, P>, f64) -> Result<Boxed<I, R, P>, EstimateError>;

/// Whether the method is compiled for the largest room of a motion alone: it is there to be compared and to teach, and
/// the time that unused room costs matters less than the size of the program.
pub(super) fn is_for_largest_room(method: Method) -> bool {
    matches!(method, Method::ModelReference | Method::ImplicitSign | Method::SuperTwisting)
}

/// [`set_up`], and the methods that are compiled for the largest room alone.
///
/// # Errors
/// Those of [`set_up`] and of [`set_up_teaching`].
pub(super) fn set_up_any<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    method: Method,
    model: M,
    settings: &EstimatorSettings<N, R, P>,
    gravity: f64,
) -> Result<Boxed<M::KnownInput, R, P>, EstimateError> {
    if is_for_largest_room(method) {
        return set_up_teaching(method, model, settings, gravity);
    }
    set_up(method, model, settings, gravity)
}

/// The methods that [`is_for_largest_room`] names.
///
/// # Errors
/// [`EstimateError::Settings`] if the settings are refused; [`EstimateError::Model`] if the model lacks what the model-reference
/// law needs, and for another method.
pub(super) fn set_up_teaching<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    method: Method,
    model: M,
    settings: &EstimatorSettings<N, R, P>,
    gravity: f64,
) -> Result<Boxed<M::KnownInput, R, P>, EstimateError> {
    let estimator = match method {
        Method::ModelReference => place(|| AdaptiveModel::new(model, settings)),
        Method::ImplicitSign => place(|| ImplicitSign::new(rows(model, settings, gravity)?, REACHING_RATE)),
        Method::SuperTwisting => place(|| Ok(SuperTwisting::new(rows(model, settings, gravity)?))),
        _ => return Err(EstimateError::Model(format!("{method} is none of the methods that are there to compare"))),
    };
    estimator.map_err(|error| match (method, error) {
        (Method::ModelReference, SettingsError::NoOutput) => EstimateError::Model(
            "model-reference needs a measurement with a noise level for every state of the motion".to_owned(),
        ),
        (_, error) => EstimateError::Settings(error),
    })
}

/// The estimator of a causal method for a model with the settings that all methods share: priors, noise, biases, sample
/// time, process noise. `gravity` (m/s^2) is for the kinematics that smooth the states of the regression methods.
///
/// # Errors
/// [`EstimateError::Settings`] if the settings are refused; [`EstimateError::NotCausal`] for a batch method;
/// [`EstimateError::Model`] for a method that [`is_for_largest_room`], which [`set_up_any`] knows.
pub(super) fn set_up<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    method: Method,
    model: M,
    settings: &EstimatorSettings<N, R, P>,
    gravity: f64,
) -> Result<Boxed<M::KnownInput, R, P>, EstimateError> {
    let estimator = match method {
        Method::Smpe => return set_up_smpe(model, settings),
        Method::Ekf if const { M::CONSTANTS.len() <= ROOM_FOR_CONSTANTS_OF_A_PLANE } => {
            place(|| ConsideringEkf::<M, N, R, P, ROOM_FOR_CONSTANTS_OF_A_PLANE>::new(model, *settings))
        }
        Method::Ekf => place(|| ConsideringEkf::<M, N, R, P, ROOM_FOR_CONSTANTS>::new(model, *settings)),
        Method::Rls => place(|| Ok(RecursiveLeastSquares::new(rows(model, settings, gravity)?))),
        Method::Fourier => place(|| FourierRegression::new(rows(model, settings, gravity)?)),
        Method::ModelReference | Method::ImplicitSign | Method::SuperTwisting => {
            return Err(EstimateError::Model(format!("{method} is compiled for the largest number of columns alone")));
        }
        Method::EquationError
        | Method::EquationErrorFrequency
        | Method::OutputError
        | Method::OutputErrorFrequency
        | Method::FilterError => {
            return Err(EstimateError::NotCausal { method });
        }
    };
    estimator.map_err(EstimateError::Settings)
}

/// SMPE with the constants whose uncertainty is considered.
///
/// # Errors
/// [`EstimateError::Settings`] if the settings are refused.
pub(super) fn set_up_smpe<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    model: M,
    settings: &EstimatorSettings<N, R, P>,
) -> Result<Boxed<M::KnownInput, R, P>, EstimateError> {
    let placed = if const { M::CONSTANTS.len() <= ROOM_FOR_CONSTANTS_OF_A_PLANE } {
        place(|| ConsideringSmpe::<M, N, R, P, ROOM_FOR_CONSTANTS_OF_A_PLANE>::new(model, *settings))
    } else {
        place(|| ConsideringSmpe::<M, N, R, P, ROOM_FOR_CONSTANTS>::new(model, *settings))
    };
    placed.map_err(EstimateError::Settings)
}

type Rows<M, const N: usize, const R: usize, const P: usize> = Regression<M, KinematicFrontEnd<M, N, R>, N, R, P>;

/// The rows of the regression methods, from states that kinematics smooth. Their gate opens again where it locks an output out.
fn rows<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize>(
    model: M,
    settings: &EstimatorSettings<N, R, P>,
    gravity: f64,
) -> Result<Rows<M, N, R, P>, SettingsError> {
    let regression = RegressionSettings { reopens: true, ..settings.regression };
    let settings = EstimatorSettings { regression, ..*settings };
    Regression::new(model, KinematicFrontEnd::<M, N, R>::new(gravity, &settings), settings)
}

/// Stack of the thread in which an estimator is made, bytes. The largest, six axes with room for 48 parameters and their
/// constants, is 600 kB, of which a debug build holds three copies until it is on the heap: more than a thread of 2 MB has left.
const STACK: usize = 16 << 20;

/// Up to this size, bytes, an estimator is made where it is asked for: a thread takes longer to begin than it.
const SMALL: usize = 64 << 10;

/// Makes an estimator and puts it on the heap; a large one in a thread of its own, since whoever asks for it may have a small
/// stack. Where no thread can be had it is made here.
#[inline(never)]
fn place<I: Input, E, const R: usize, const P: usize>(
    make: impl FnOnce() -> Result<E, SettingsError> + Send,
) -> Result<Boxed<I, R, P>, SettingsError>
where
    E: Inspect<R, P, Input = I> + Send + 'static,
{
    if size_of::<E>() <= SMALL {
        return on_the_heap(make);
    }
    let mut make = Some(make);
    let made = std::thread::scope(|scope| {
        let here = &mut make;
        let thread = std::thread::Builder::new().stack_size(STACK);
        let thread = thread.spawn_scoped(scope, move || here.take().map(on_the_heap)).ok()?;
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    // Without an answer no thread was begun, and `make` is still here.
    made.or_else(|| make.take().map(on_the_heap)).unwrap_or(Err(SettingsError::Capacity { needed: P, capacity: 0 }))
}

fn on_the_heap<I: Input, E, const R: usize, const P: usize>(
    make: impl FnOnce() -> Result<E, SettingsError>,
) -> Result<Boxed<I, R, P>, SettingsError>
where
    E: Inspect<R, P, Input = I> + Send + 'static,
{
    make().map(|estimator| -> Boxed<I, R, P> { Box::new(estimator) })
}
