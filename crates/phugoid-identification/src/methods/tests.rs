//! The numbers do not depend on the room that the estimator was compiled with.

use super::causal::run_causal;
use super::gate::{Gated, GatedInput};
use super::room::{LARGE_ROOM, MIDDLE_ROOM, SMALL_ROOM, in_room};
use super::settings::shared_settings;
use super::table::{Boxed, SetUp, set_up_smpe, set_up_teaching};
use super::{ColumnRun, Run, Task};
use crate::core::error::EstimateError;
use crate::core::method::Method;
use crate::core::options::EstimateOptions;
use crate::model_file::ModelFile;
use crate::models::longitudinal::{LongitudinalModel, OUTPUTS, STATES};
use crate::motion::{Motion, MotionModel};
use crate::preparation::noise::NoiseLevel;
use crate::preparation::prepare::prepare;
use crate::preparation::prepared::Prepared;
use phugoid_estimators::settings::{EstimatorSettings, NoiseAdaptation};

#[path = "../../tests/common/mod.rs"]
mod common;

use common::f16::{NOISE, TRIM, fly, unbiased};
use phugoid_flight_data::record::Record;

/// Two flights one after the other, the recorder of the elevator changed in between (for the estimator a change of
/// every derivative with respect to it), with outliers and missing values: whatever the estimator can do, it has to do.
fn eventful() -> Record {
    let (mut record, later) = (fly(10.0, 0.026, 31), fly(10.0, 0.026, 32));
    record.time.extend(later.time.iter().map(|t| t + 10.0));
    for (channel, more) in record.channels.iter_mut().zip(&later.channels) {
        channel.values.extend(&more.values);
    }
    let elevator = &mut record.channels.iter_mut().find(|c| c.name == "elevator").unwrap().values;
    elevator[500..].iter_mut().for_each(|e| *e = TRIM[1] + 2.0 * (*e - TRIM[1]));
    let q = &mut record.channels.iter_mut().find(|c| c.name == "q").unwrap().values;
    q.iter_mut().skip(11).step_by(37).for_each(|v| *v = f64::NAN);
    q.iter_mut().skip(19).step_by(41).for_each(|v| *v += 0.5);
    record
}

type Flown = Prepared<LongitudinalModel, STATES, OUTPUTS>;

type SetUpFlown<const P: usize> = SetUp<
    Gated<LongitudinalModel>,
    GatedInput<<LongitudinalModel as Motion<STATES, OUTPUTS>>::KnownInput>,
    STATES,
    OUTPUTS,
    P,
>;

type Room<const P: usize> =
    Result<Boxed<GatedInput<<LongitudinalModel as Motion<STATES, OUTPUTS>>::KnownInput>, OUTPUTS, P>, EstimateError>;

/// SMPE by itself, and not the table of all methods: every method of every room that a test reaches is compiled once more for it.
fn smpe<const P: usize>(
    _: Method,
    model: Gated<LongitudinalModel>,
    settings: &EstimatorSettings<STATES, OUTPUTS, P>,
    _: f64,
) -> Room<P>
where
    LongitudinalModel: MotionModel<STATES, OUTPUTS, P>,
{
    set_up_smpe(model, settings)
}

fn run_in_room<const P: usize>(
    prepared: &Flown,
    file: &ModelFile,
    noise: &[NoiseLevel; OUTPUTS],
    method: Method,
    set_up: SetUpFlown<P>,
) -> Result<Run<OUTPUTS>, EstimateError> {
    let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
    let task = Task::new(prepared, file, &options, noise);
    run_causal(&mut *in_room::<_, _, _, P>(&task, set_up)?, &task, &mut |_| {})
}

fn assert_same_bits(a: &[f64], b: &[f64], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert_eq!(a.to_bits(), b.to_bits(), "{what}, {k}: {a:e} {b:e}");
    }
}

fn assert_same(a: &Run<OUTPUTS>, b: &Run<OUTPUTS>) {
    assert_eq!(a.columns.len(), b.columns.len());
    let end = |c: &ColumnRun| [c.value, c.std_error, c.corrected_std_error, c.observability, c.change_sensitivity];
    for (a, b) in a.columns.iter().zip(&b.columns) {
        assert_same_bits(&a.values, &b.values, "values");
        assert_same_bits(&a.std_errors, &b.std_errors, "standard errors");
        assert_same_bits(&a.surfaces, &b.surfaces, "surfaces");
        assert_same_bits(&end(a), &end(b), "at the end");
        assert_eq!(a.status, b.status);
    }
    for (a, b) in [(&a.predicted, &b.predicted), (&a.residuals, &b.residuals)] {
        assert_same_bits(a.as_flattened(), b.as_flattened(), "outputs");
    }
    assert_same_bits(&a.covariance.concat(), &b.covariance.concat(), "covariance");
    assert_eq!((&a.phases, &a.events, a.status, a.excited), (&b.phases, &b.events, b.status, b.excited));
    assert_eq!(a.detector, b.detector);
}

#[test]
fn the_room_does_not_change_a_bit() {
    let record = eventful();
    let noise = NOISE.map(NoiseLevel::given);
    // Five parameters, which fill the small room, and eight, which do not fill the middle one.
    for (biases, columns) in [("", 5), ("\n[biases]\nalpha = \"0.3 deg\"\nq = \"0.1 deg/s\"\naz = \"0.02 g\"\n", 8)] {
        let file = ModelFile::parse("f16", &format!("{}{biases}", unbiased())).unwrap();
        let prepared: Flown = prepare(&record, &file).unwrap();
        let large = run_in_room::<LARGE_ROOM>(&prepared, &file, &noise, Method::Smpe, smpe).unwrap();
        let smaller = if columns == SMALL_ROOM {
            run_in_room::<SMALL_ROOM>(&prepared, &file, &noise, Method::Smpe, smpe).unwrap()
        } else {
            run_in_room::<MIDDLE_ROOM>(&prepared, &file, &noise, Method::Smpe, smpe).unwrap()
        };
        assert_eq!(smaller.columns.len(), columns);
        let kinds: Vec<&str> = smaller.events.iter().map(|e| e.kind.word()).collect();
        println!("{columns} columns: {kinds:?}, {:?}", smaller.status);
        assert!(kinds.contains(&"in_doubt"), "nothing happened on this flight: {kinds:?}");
        assert_same(&smaller, &large);
    }
}

/// What lets the command line compile them for one room of each motion.
#[test]
fn nor_does_it_of_the_methods_that_teach() {
    let record = eventful();
    let noise = NOISE.map(NoiseLevel::given);
    let file = ModelFile::parse("f16", unbiased()).unwrap();
    let prepared: Flown = prepare(&record, &file).unwrap();
    for method in [Method::ModelReference, Method::ImplicitSign, Method::SuperTwisting] {
        let large = run_in_room::<LARGE_ROOM>(&prepared, &file, &noise, method, set_up_teaching).unwrap();
        let full = run_in_room::<SMALL_ROOM>(&prepared, &file, &noise, method, set_up_teaching).unwrap();
        assert_same(&full, &large);
    }
}

#[test]
fn a_model_beyond_the_small_room_is_refused_by_it() {
    let file = ModelFile::named("hfb320").unwrap();
    assert!(file.estimated().count() > SMALL_ROOM);
    let noise = [NoiseLevel::given(0.1); OUTPUTS];
    let f16 = ModelFile::parse("f16", unbiased()).unwrap();
    let prepared: Flown = prepare(&fly(2.0, 0.026, 33), &f16).unwrap();
    let error = run_in_room::<SMALL_ROOM>(&prepared, &file, &noise, Method::Smpe, smpe);
    assert!(error.unwrap_err().to_string().contains('5'));
}

#[test]
fn what_the_model_file_says_of_the_estimator_reaches_it() {
    let record = fly(2.0, 0.026, 31);
    let noise = NOISE.map(NoiseLevel::given);
    let options = EstimateOptions::default();
    let settings = |own: &str| {
        let text = format!("{}\n{own}", include_str!("../../../../data/models/f16.toml"));
        let file = ModelFile::parse("f16", &text).unwrap();
        let prepared: Flown = prepare(&record, &file).unwrap();
        shared_settings::<LongitudinalModel, _, _, LARGE_ROOM>(&prepared, &file, &options, &noise).unwrap()
    };
    let rule = settings("");
    assert_eq!(settings("[estimator]"), rule);
    let own = settings(
        "[estimator]\nreaching_limit = 9\nprior_scale = 2\nprocess_noise_scale = 0.1\nadaptation_gain = 0.02\n\
         start_window = 0.1",
    );
    // A reaching limit above the rule's rejection limit takes that along.
    assert_eq!((own.reaching_limit, own.rejection_limit, rule.reaching_limit), (9.0, 9.0, 3.0));
    assert_eq!((own.start_window_s, own.process_noise.adaptation), (0.1, NoiseAdaptation::Score { forgetting: 0.02 }));
    for (own, rule) in own.priors.iter().zip(&rule.priors) {
        assert_eq!(own.std, 2.0 * rule.std);
        assert_eq!(own.change_std, rule.change_std, "how large a sudden change may be is another question");
    }
    assert_eq!(own.process_noise.variance_per_s, rule.process_noise.variance_per_s.map(|q| 0.1 * q));
    assert_eq!(settings("[estimator]\nrejection_scale = 2").rejection_limit, 2.0 * rule.rejection_limit);
}
