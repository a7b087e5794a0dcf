//! A dynamically scaled model flies as the aircraft that it stands for, only faster.
//!
//! Where lengths are `n` times those of the aircraft and accelerations the same (Froude scaling), times are `sqrt(n)` times, rates
//! `1/sqrt(n)`, speeds `sqrt(n)` and altitudes `n` times those of the aircraft; angles and load factors are equal (C. H. Wolowicz,
//! J. S. Bowman, W. P. Gilbert, *Similitude Requirements and Scaling Relationships as Applied to Model Testing*, NASA TP-1435, 1979).
//! Pilot, control law, wanted motion and flying qualities know the full size alone; here is the way there.

use phugoid_control::interval::Estimate;
use phugoid_control::local::{ALPHA, AXES, BETA, LocalModel, VARIABLES};
use phugoid_simulation::scenario::Scenario;

/// The scale of a model: times of the model over times of the full size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    time: f64,
}

impl Scale {
    /// That of the aircraft of a scenario.
    pub(crate) fn of(scenario: &Scenario) -> Self {
        Self::of_lengths(scenario.aircraft.scale.unwrap_or(1.0))
    }

    /// From the length of the model over that of the aircraft that it stands for: 1 for an aircraft that stands for itself.
    pub(crate) fn of_lengths(lengths: f64) -> Self {
        Self { time: lengths.sqrt() }
    }

    /// A time at full size, s.
    pub(crate) fn time(self, model: f64) -> f64 {
        model / self.time
    }

    /// A time of the model, s, from one at full size.
    pub(crate) fn model_time(self, full: f64) -> f64 {
        full * self.time
    }

    /// A rate at full size, 1/s.
    pub(crate) fn rate(self, model: f64) -> f64 {
        model * self.time
    }

    /// An angular acceleration at full size, 1/s^2.
    pub(crate) fn acceleration(self, model: f64) -> f64 {
        model * self.time * self.time
    }

    /// A speed at full size, m/s.
    pub(crate) fn speed(self, model: f64) -> f64 {
        model / self.time
    }

    /// A length at full size, m.
    pub(crate) fn length(self, model: f64) -> f64 {
        model / (self.time * self.time)
    }

    /// A channel of the motion at full size, by its canonical name: angles and accelerations stay.
    pub(crate) fn channel(self, name: &str, model: f64) -> f64 {
        match name {
            "p" | "q" | "r" => self.rate(model),
            "true_airspeed" => self.speed(model),
            "altitude" => self.length(model),
            _ => model,
        }
    }

    /// A local model at full size.
    pub(crate) fn model(self, model: &LocalModel) -> LocalModel {
        let (once, twice) = (self.time, self.time * self.time);
        LocalModel {
            rates: by_variables(&model.rates, once),
            surfaces: model.surfaces.map(|row| row.map(|effect| effect * twice)),
            constant: model.constant.map(|acceleration| acceleration * twice),
            alpha_by_alpha: model.alpha_by_alpha * once,
            alpha_by_elevator: model.alpha_by_elevator * once,
            beta_by_beta: model.beta_by_beta * once,
            beta_by_rudder: model.beta_by_rudder * once,
            beta_by_aileron: model.beta_by_aileron * once,
            alpha: model.alpha,
            speed: self.speed(model.speed),
            gravity: model.gravity,
        }
    }

    /// An estimate at full size.
    pub(crate) fn estimate(self, estimate: &Estimate) -> Estimate {
        Estimate { model: self.model(&estimate.model), std_error: self.model(&estimate.std_error) }
    }

    /// Deflections by the feedback variables that gains for the full size ask of the model: per rad and per rad/s.
    #[cfg(test)]
    fn feedback(self, gains: &phugoid_control::gains::Gains) -> [[f64; VARIABLES]; phugoid_control::local::SURFACES] {
        let feedback = gains.feedback();
        std::array::from_fn(|i| {
            std::array::from_fn(|j| if j == ALPHA || j == BETA { feedback[i][j] } else { self.rate(feedback[i][j]) })
        })
    }
}

/// Angular accelerations by angles and rates at full size.
fn by_variables(rates: &[[f64; VARIABLES]; AXES], once: f64) -> [[f64; VARIABLES]; AXES] {
    rates.map(|row| std::array::from_fn(|j| if j == ALPHA || j == BETA { row[j] * once * once } else { row[j] * once }))
}

#[cfg(test)]
mod tests {
    use phugoid_control::gains::Gains;
    use phugoid_control::roots::eigenvalues;
    use phugoid_control::target::Targets;

    use super::*;

    /// The roots of the model with the gains of the full size are those of the full size, faster by the scale of time.
    #[test]
    fn a_model_moves_as_the_full_size_only_faster() {
        let model = LocalModel {
            rates: [[0.0, -60.0, -6.0, 0.0, 1.4], [-40.0, 0.0, 0.0, -4.0, 0.0], [0.0, 36.0, 0.0, 0.0, -1.0]],
            surfaces: [[0.0, -90.0, 16.0], [-44.0, 0.0, 0.0], [0.0, -4.0, -18.0]],
            alpha_by_alpha: -2.5,
            alpha_by_elevator: -0.3,
            beta_by_beta: -0.6,
            beta_by_rudder: 0.1,
            alpha: 0.09,
            speed: 40.0,
            gravity: 9.81,
            ..LocalModel::default()
        };
        let scale = Scale::of_lengths(0.055);
        let full = scale.model(&model);
        assert!((full.load_factor_per_alpha() - model.load_factor_per_alpha()).abs() < 1e-9);
        let gains = Gains::place(&full, &Targets::default()).unwrap();
        let of = |matrix| {
            let mut roots = eigenvalues(&matrix).unwrap().map(|root| [root.real, root.imaginary]);
            roots.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            roots
        };
        let (slow, fast) = (of(full.closed_loop(&gains.feedback())), of(model.closed_loop(&scale.feedback(&gains))));
        for (slow, fast) in slow.iter().zip(fast) {
            for (slow, fast) in slow.iter().zip(fast) {
                assert!((slow - scale.rate(fast)).abs() < 1e-6 * (1.0 + slow.abs()), "{slow} {fast}");
            }
        }
        let whole = Scale::of_lengths(1.0);
        assert_eq!((whole.model(&model), whole.time(3.0), whole.length(2.0)), (model, 3.0, 2.0));
    }
}
