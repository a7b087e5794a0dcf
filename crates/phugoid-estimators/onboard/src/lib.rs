//! What the images share: a plant that may answer anything, settings of which nothing is known, and a panic handler
//! that cannot be optimised away.
//!
//! An image holds all that a user can call of one method, and is linked with optimisation across all crates. What is
//! left in it of the code that panics is what the compiler could not prove to be out of reach, whatever the plant
//! answers, whatever the settings are, and whatever the samples contain.
#![no_std]

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering};

use phugoid_estimators::regression::{MeasuredStates, Regression};
use phugoid_estimators::settings::{EstimatorSettings, NoiseLearning, ParameterPrior, SettingsError};
use phugoid_estimators::{
    ConstantEffects, Estimate, Estimator, Innovations, Inspect, LinearizedOutputs, LinearizedRates, Model,
    ParameterStatus, RowPhase, Sample, Status,
};

/// States and outputs of the images: those of the longitudinal motion.
pub const STATES: usize = 4;
/// Outputs.
pub const OUTPUTS: usize = 6;
/// Room for considered constants.
pub const CONSTANTS: usize = 12;
/// The smaller room: its arithmetic is unrolled where all columns are in use.
pub const SMALL: usize = 11;
/// The larger room: its arithmetic has a run-time length.
pub const LARGE: usize = 24;

static PANICS: AtomicU32 = AtomicU32::new(0);

/// Every panic ends here. It has a side effect, so that it is left out of an image only where nothing can reach it.
#[panic_handler]
#[inline(never)]
fn stop(reason: &core::panic::PanicInfo<'_>) -> ! {
    black_box(reason);
    PANICS.store(1, Ordering::Relaxed);
    loop {
        core::hint::spin_loop();
    }
}

/// A plant of which the compiler knows nothing: it may even answer something else each time.
#[derive(Clone, Copy)]
pub struct Plant;

impl<const P: usize> Model<STATES, OUTPUTS, P> for Plant {
    type Input = [f64; 2];

    fn parameter_count(&self) -> usize {
        black_box(P)
    }

    #[inline(never)]
    fn rates(&self, x: &[f64; STATES], theta: &[f64; P], u: &[f64; 2]) -> [f64; STATES] {
        black_box((theta, u));
        *black_box(x)
    }

    #[inline(never)]
    fn linearized_rates(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &[f64; 2],
        out: &mut LinearizedRates<STATES, P>,
    ) {
        black_box((x, theta, u, out));
    }

    #[inline(never)]
    fn linearized_outputs(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &[f64; 2],
        out: &mut LinearizedOutputs<STATES, OUTPUTS, P>,
    ) {
        black_box((x, theta, u, out));
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        black_box(Some(state))
    }

    fn constant_count(&self) -> usize {
        black_box(CONSTANTS)
    }

    #[inline(never)]
    fn constant_effects<const K: usize>(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &[f64; 2],
        out: &mut ConstantEffects<STATES, OUTPUTS, K>,
    ) {
        black_box((x, theta, u, out));
    }

    #[inline(never)]
    fn regressor_powers<const K: usize>(&self, x: &[f64; STATES], column: usize) -> [f64; K] {
        black_box((x, column));
        black_box([0.0; K])
    }
}

/// Settings by rule, then every field hidden from the compiler: the path through each option stays in the image.
pub fn settings<const P: usize>() -> Option<EstimatorSettings<STATES, OUTPUTS, P>> {
    let priors = black_box([ParameterPrior::bounded(0.0, -1.0, 1.0); P]);
    let count = black_box(P).min(P);
    let mut settings = EstimatorSettings::automatic(priors.get(..count)?, black_box([0.01; OUTPUTS]), 0.01).ok()?;
    settings.noise_learning = Some(NoiseLearning::from_white([0.01; OUTPUTS]));
    Some(black_box(settings))
}

/// Everything that a user can call of an estimator.
#[inline(always)]
pub fn run<const P: usize>(mut estimator: impl Inspect<OUTPUTS, P, Input = [f64; 2]>) {
    let estimator: &mut dyn Inspect<OUTPUTS, P, Input = [f64; 2]> = &mut estimator;
    // All methods of the trait are in the table that this hides.
    let estimator = black_box(estimator);
    black_box(estimator.update(&any_sample()));
}

/// The same of what is made from the settings: an estimator, or the reason why not.
#[inline(always)]
pub fn run_new<const P: usize, E, F>(new: impl FnOnce(EstimatorSettings<STATES, OUTPUTS, P>) -> Result<E, F>)
where
    E: Inspect<OUTPUTS, P, Input = [f64; 2]>,
{
    if let Some(Ok(estimator)) = settings().map(new) {
        run(estimator);
    }
}

/// The rows of a regression on the measured states.
pub fn rows<const P: usize>(
    settings: EstimatorSettings<STATES, OUTPUTS, P>,
) -> Result<Regression<Plant, MeasuredStates<STATES>, STATES, OUTPUTS, P>, SettingsError> {
    Regression::new(Plant, MeasuredStates::new::<_, OUTPUTS, P>(&Plant), settings)
}

/// A sample with any time and values.
pub fn any_sample() -> Sample<[f64; 2], OUTPUTS> {
    black_box(Sample { time_s: 0.0, input: [0.0; 2], outputs: [0.0; OUTPUTS] })
}

/// What any estimator may answer.
pub struct AnyEstimator<const P: usize> {
    innovations: Innovations<OUTPUTS>,
    prior_std: [f64; P],
}

impl<const P: usize> AnyEstimator<P> {
    /// An estimator of which nothing is known.
    pub fn hidden() -> Self {
        let nan = [f64::NAN; OUTPUTS];
        let phase = [RowPhase::Missing; OUTPUTS];
        let innovations = Innovations { predicted: nan, normalised: nan, whitened: nan, variance: nan, phase };
        black_box(Self { innovations, prior_std: [1.0; P] })
    }
}

impl<const P: usize> Estimator<OUTPUTS, P> for AnyEstimator<P> {
    type Input = [f64; 2];

    fn update(&mut self, sample: &Sample<[f64; 2], OUTPUTS>) -> Estimate<P> {
        black_box(Estimate {
            time_s: sample.time_s,
            parameters: [0.0; P],
            std_error: [0.0; P],
            corrected_std_error: [0.0; P],
            observability: [0.0; P],
            parameter_status: [ParameterStatus::NotExcited; P],
            status: Status::default(),
        })
    }

    fn covariance(&self, out: &mut [[f64; P]; P]) {
        black_box(out);
    }
}

impl<const P: usize> Inspect<OUTPUTS, P> for AnyEstimator<P> {
    fn column_count(&self) -> usize {
        black_box(P)
    }

    fn prior_std(&self) -> &[f64; P] {
        black_box(&self.prior_std)
    }

    fn innovations(&self) -> &Innovations<OUTPUTS> {
        black_box(&self.innovations)
    }
}

/// The entry point of an image: both rooms of a function that is generic over the room.
#[macro_export]
macro_rules! image {
    ($body:ident) => {
        /// Where the linker begins. The name has to be this one, which Rust calls unsafe.
        #[unsafe(no_mangle)]
        pub extern "C" fn _start() {
            $body::<{ $crate::SMALL }>();
            $body::<{ $crate::LARGE }>();
        }
    };
}
