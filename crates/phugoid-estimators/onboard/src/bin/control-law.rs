//! The control law with everything around it: gains, their worst motion within the bounds of an estimate, the watch over the surfaces,
//! the excitation, flying qualities, margins, and the name of what is gone.
#![no_std]
#![no_main]

use core::hint::black_box;

use phugoid_control::excitation::{Excitation, Now, Settings as ExcitationSettings};
use phugoid_control::following::Follower;
use phugoid_control::gains::Gains;
use phugoid_control::interval::{Comparison, Estimate, worst_levels};
use phugoid_control::law::{Demand, Form, Law, Measured, Settings};
use phugoid_control::local::LocalModel;
use phugoid_control::lost::{losses, name};
use phugoid_control::margin::margins;
use phugoid_control::prediction::Recent;
use phugoid_control::qualities::{Category, qualities};
use phugoid_control::target::Targets;
use phugoid_onboard::image;

fn fly<const P: usize>() {
    let number = || black_box(0.0_f64);
    let model = black_box(LocalModel::default());
    let estimate = black_box(Estimate { model, std_error: model });
    let targets = black_box(Targets::default());
    let free = black_box([true; 3]);
    let (Some(now), Some(new)) = (Gains::place(&model, &targets), Gains::place_with(&model, &targets, free)) else {
        return;
    };
    let limits = black_box([[0.0; 2]; 3]);
    let settings = Settings::new(number(), [number(); 5], [number(); 3], limits, [number(); 3]);
    let settings = Settings { form: black_box(Form::Incremental), ..settings };
    let mut law = black_box(Law::new(settings, now));
    let measured = black_box(Measured::default());
    let mut follower = black_box(Follower::new(number(), number(), number()));
    let mut recent = black_box(Recent::new());
    let mut excitation = black_box(Excitation::new(ExcitationSettings::default()));
    recent.update(&measured.variables, &measured.surfaces, number());
    black_box(follower.update(number(), number(), number(), number()));
    black_box((recent.explains(&model, [number(); 3]), recent.prefers(&model, &model)));
    let comparison = Comparison::new(&estimate, &now, &new);
    if comparison.supports(number()) || comparison.allows(number()) {
        black_box(law.change_gains(new));
    }
    let category = black_box(Category::A);
    black_box(qualities(&model.closed_loop(&new.feedback()), model.load_factor_per_alpha(), category).level());
    black_box(worst_levels(&estimate, &new, category));
    if let Some(steady) = recent.steady(&model) {
        black_box(margins(&estimate, &new, &steady, &limits, number(), black_box(Some(&model))));
    }
    black_box(name(&losses(&estimate, &black_box(estimate), number())));
    black_box(excitation.update(&black_box(Now::default()), number()));
    black_box(law.update(&measured, &black_box(Demand::default())));
}

image!(fly);
