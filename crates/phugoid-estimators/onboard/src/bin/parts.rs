//! What the methods are made of, as far as it is public: the integration, the covariance, the noise, the collinearity.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, simulate, step};
use phugoid_estimators::noise::{NoiseMonitor, third_difference_std};
use phugoid_estimators::ud::Ud;
use phugoid_estimators::verdict::Collinearity;
use phugoid_onboard::{OUTPUTS, Plant, STATES, any_sample, image};

fn fly<const P: usize>() {
    let (x, theta) = (black_box([0.0; STATES]), black_box([0.0; P]));
    let input = black_box(IntervalInput { from: [0.0; 2], to: [0.0; 2], hold: InputHold::Zero });
    let part = black_box(Part { from: 0.0, to: 1.0 });
    let (mut sensitivity, mut transition) = (black_box([[0.0; P]; STATES]), black_box([[0.0; STATES]; STATES]));
    black_box(step::<_, STATES, OUTPUTS, P>(
        &Plant,
        &x,
        &theta,
        &input,
        black_box(0.01),
        part,
        black_box(P),
        &mut sensitivity,
        &mut transition,
    ));
    black_box((&sensitivity, &transition));
    black_box(simulate::<_, STATES, OUTPUTS, P>(&Plant, &x, &theta, &input, black_box(0.01), black_box(0.01)));

    let mut covariance = Ud::<P>::from_variances(&black_box([1.0; P])[..black_box(P).min(P)]);
    let covariance = black_box(&mut covariance);
    let projection = black_box(covariance.project(&theta, black_box(1.0)));
    black_box((covariance.cross_covariance(&projection), covariance.update(&projection, black_box(1.0))));
    covariance.scale(black_box(2.0));
    covariance.add_rank_one(black_box(1.0), &theta);
    let mut dense = black_box([[0.0; P]; P]);
    covariance.predict(&dense, &theta);
    covariance.write_dense(&mut dense);
    let mut solved = theta;
    covariance.solve(&mut solved);
    black_box((&dense, &solved, covariance.variances(), covariance.column(black_box(P)), covariance.is_sound()));
    black_box((covariance.len(), covariance.is_empty(), Ud::<P>::from_lower_triangle(&dense, black_box(P))));

    let collinearity = black_box(Collinearity::<P>::of(&dense, black_box(P)));
    black_box(collinearity.partners(black_box(P), black_box(0.7)));

    let mut monitor = black_box(NoiseMonitor::<OUTPUTS, P>::new());
    monitor.push(&any_sample().outputs);
    black_box(monitor.std());
    let (values, mut scratch) = ([0.0; 100], [0.0; 100]);
    // Slices of any length.
    let (values, scratch): (&[f64], &mut [f64]) = (black_box(&values), black_box(&mut scratch));
    black_box(third_difference_std(values, scratch));
}

image!(fly);
