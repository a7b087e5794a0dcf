//! Every causal method on the synthetic plant, by name: for the benchmark and the instruction count.
#![allow(dead_code, unreachable_pub)]

use phugoid_estimators::Estimator;
use phugoid_estimators::ekf::{ConsideringEkf, JointEkf};
use phugoid_estimators::fourier::FourierRegression;
use phugoid_estimators::implicit_sign::ImplicitSign;
use phugoid_estimators::regression::{MeasuredStates, Regression};
use phugoid_estimators::rls::RecursiveLeastSquares;
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::smpe::{ConsideringSmpe, Smpe};
use phugoid_estimators::super_twisting::SuperTwisting;

use crate::synthetic::Synthetic;

pub const METHODS: [&str; 8] =
    ["smpe", "ekf", "considering-smpe", "considering-ekf", "rls", "fourier", "implicit-sign", "super-twisting"];
/// Room for the constants that the considering methods follow: that of the lateral-directional motion, which has most.
const CONSTANTS: usize = 21;

/// What is done with an estimator.
pub trait Run<const R: usize, const P: usize> {
    fn run(&mut self, estimator: impl Estimator<R, P, Input = [f64; 1]>);
}

/// Sets the method up with the settings that all share, and hands it over.
pub fn with_method<const R: usize, const P: usize>(
    name: &str,
    model: Synthetic<P>,
    settings: EstimatorSettings<4, R, P>,
    mut what: impl Run<R, P>,
) {
    let states = MeasuredStates::<4>::new::<_, R, P>(&model);
    let refused = match name {
        "smpe" => Smpe::<_, 4, R, P>::new(model, settings).map(|e| what.run(e)).err(),
        "ekf" => JointEkf::<_, 4, R, P>::new(model, settings).map(|e| what.run(e)).err(),
        "considering-smpe" => ConsideringSmpe::<_, 4, R, P, CONSTANTS>::new(model, settings).map(|e| what.run(e)).err(),
        "considering-ekf" => ConsideringEkf::<_, 4, R, P, CONSTANTS>::new(model, settings).map(|e| what.run(e)).err(),
        _ => Regression::new(model, states, settings)
            .and_then(|rows| {
                match name {
                    "rls" => what.run(RecursiveLeastSquares::new(rows)),
                    "fourier" => what.run(FourierRegression::new(rows)?),
                    "implicit-sign" => what.run(ImplicitSign::new(rows, 2.0)?),
                    _ => what.run(SuperTwisting::new(rows)),
                }
                Ok(())
            })
            .err(),
    };
    if let Some(error) = refused {
        eprintln!("{name}: {error}");
    }
}
