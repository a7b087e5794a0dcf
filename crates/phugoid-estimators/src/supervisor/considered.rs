//! Constants that are considered and not estimated: how far an error of each moves the estimate.
//!
//! A scale of a sensor or the mass, wrong by a few parts in a hundred, is taken up by the parameters and leaves no trace
//! in residuals. It cannot be learnt, but what it does to the estimate follows from the gains that the filter uses
//! anyway. With the errors of state and parameters per unit of the constants `c`,
//!
//! ```text
//! x_true - x = W c + ...,   theta_true - theta = T c + ...                              N x K and P x K
//! predict:   W <- A W + B T + (A + I) g h/2                 g = d(rates)/dc half way
//! row:       zeta = H W + D T + d(output)/dc,   W <- W - K_x zeta,   T <- T - K_theta zeta
//! frame:     T_jk <- T_jk + s_jk (step of parameter j),   T_ik <- T_ik + f_ijk (step of parameter j)
//! ```
//!
//! for each row that moves the estimate in proportion to its residual; one outside of the boundary layer moves it by a
//! step that does not depend on the constants, and a rejected one not at all. Re-opening the parameters changes no error
//! of the estimate, and so neither `W` nor `T`. A state that is read from an output again has its error.
//!
//! The last line is what the constants do to the gains. Where a constant makes the regressor of a parameter larger by the
//! part `s c` ([`Model::regressor_powers`]), the gain is smaller by as much, and so is every step that it makes. Without
//! it a direction that the flight hardly shows, such as a constant beside a term of the airspeed, would take up `H W` at
//! the estimates of the moment, which wander along it, for an effect of the constants. With it an estimate that is
//! proportional to `1/(1 + s c)` has `T = s theta` at any time, however it came there. The same where a constant adds a part
//! `f c` of the regressor of another parameter ([`Model::regressor_shifts`]), as a zero of the vane does to the square of an angle.
//!
//! `T diag(P) T^T` is the part of the errors of the constants in the covariance of the estimate (S. F. Schmidt's
//! *consider* covariance, under the gain that ignores them; docs/uncertainty.md).

use crate::columns::Columns;
use crate::discretization::{IntervalInput, Part};
use crate::innovation::Innovations;
use crate::kernels::add_scaled;
use crate::levels::{Frame, Levels};
use crate::model::{ConstantEffects, Model};
use crate::settings::{EstimatorSettings, SettingsError};
use crate::supervisor::common::Common;
use crate::supervisor::faults::Watch;
use crate::supervisor::learnt::{Collected, Evidence};
use crate::supervisor::slot::{Followed, Follower, Slot, UsedRow};

/// A slot that knows how far an error of each of up to `K` constants of the model
/// ([`Model::constant_effects`]) has moved its estimate. The estimate is that of `S`, bit for bit.
#[derive(Clone, Copy, Debug)]
pub struct Considering<S, const N: usize, const P: usize, const K: usize> {
    slot: S,
    errors: Errors<N, P, K>,
    /// What the residuals say of those that can be learnt.
    collected: Collected<K>,
    /// The outputs that the states were read from, while what that means for their errors is still to be worked out.
    read_from: Option<[Option<usize>; N]>,
    /// Constants in use, at most `K`; none before the first sample.
    count: usize,
}

/// Errors of state and parameters per unit of each constant.
#[derive(Clone, Copy, Debug)]
struct Errors<const N: usize, const P: usize, const K: usize> {
    /// `W`, row = state.
    state: [[f64; K]; N],
    /// `T`, row = column of the estimate, parameter units.
    parameters: [[f64; K]; P],
}

/// Follows a prediction. `R` is only the model's.
struct Interval<'a, M: Model<N, R, P>, const N: usize, const R: usize, const P: usize, const K: usize> {
    errors: &'a mut Errors<N, P, K>,
    model: &'a M,
    theta: [f64; P],
    input: &'a IntervalInput<M::Input>,
    interval_s: f64,
    effects: ConstantEffects<N, R, K>,
}

impl<M: Model<N, R, P>, const N: usize, const R: usize, const P: usize, const K: usize> Follower<N, P>
    for Interval<'_, M, N, R, P, K>
{
    const ACTIVE: bool = true;

    fn part(&mut self, states: [&[f64; N]; 2], part: Part, transition: &[[f64; N]; N], by_parameter: &[[f64; P]; N]) {
        let Self { errors, model, theta, input, interval_s, effects } = self;
        let middle: [f64; N] = core::array::from_fn(|k| 0.5 * (states[0][k] + states[1][k]));
        *effects = ConstantEffects::ZERO;
        model.constant_effects(&middle, theta, &input.at(0.5 * (part.from + part.to)), effects);
        let half_s = 0.5 * *interval_s * (part.to - part.from);
        let own = model.parameter_count().min(P);
        let mut before = errors.state;
        for (row, rate) in before.iter_mut().zip(&effects.rates) {
            add_scaled(row, half_s, rate);
        }
        for k in 0..N {
            let row = &mut errors.state[k];
            row.fill(0.0);
            add_scaled(row, half_s, &effects.rates[k]);
            for (factor, before) in transition[k].iter().zip(&before) {
                add_scaled(row, *factor, before);
            }
            for (factor, of_parameter) in by_parameter[k][..own].iter().zip(&errors.parameters) {
                add_scaled(row, *factor, of_parameter);
            }
        }
    }

    fn row(&mut self, _: &UsedRow<'_, N>) {}
}

/// Follows the rows of a frame.
struct Rows<'a, const N: usize, const R: usize, const P: usize, const K: usize> {
    errors: &'a mut Errors<N, P, K>,
    collected: &'a mut Collected<K>,
    /// The constants that can be learnt.
    learnable: &'a [usize],
    effects: ConstantEffects<N, R, K>,
}

impl<const N: usize, const R: usize, const P: usize, const K: usize> Follower<N, P> for Rows<'_, N, R, P, K> {
    const ACTIVE: bool = true;

    fn part(&mut self, _: [&[f64; N]; 2], _: Part, _: &[[f64; N]; N], _: &[[f64; P]; N]) {}

    #[inline]
    fn row(&mut self, row: &UsedRow<'_, N>) {
        let Errors { state, parameters } = &mut *self.errors;
        let Some(mut zeta) = self.effects.outputs.get(row.output).copied() else { return };
        // Most rows measure one state: the zeros are worth a test.
        for (factor, error) in row.by_state.iter().zip(&*state) {
            if *factor != 0.0 {
                add_scaled(&mut zeta, *factor, error);
            }
        }
        for (factor, error) in row.by_parameter.iter().zip(&*parameters) {
            if *factor != 0.0 {
                add_scaled(&mut zeta, *factor, error);
            }
        }
        if let Some(error) = row.bias.and_then(|column| parameters.get(column)) {
            add_scaled(&mut zeta, 1.0, error);
        }
        self.collected.add(self.learnable, &zeta, row.residual, row.variance);
        for (error, gain) in state.iter_mut().zip(&row.state_gain) {
            add_scaled(error, -gain, &zeta);
        }
        for (error, gain) in parameters.iter_mut().zip(row.parameter_gain) {
            add_scaled(error, -gain, &zeta);
        }
    }
}

impl<S, const N: usize, const P: usize, const K: usize> Considering<S, N, P, K>
where
    S: Followed<N, P>,
{
    /// The effects at the present state. A state that has just been read from an output has the error of that output.
    fn effects<M, const R: usize>(
        &mut self,
        model: &M,
        columns: &Columns<R, P>,
        input: &M::Input,
    ) -> ConstantEffects<N, R, K>
    where
        M: Model<N, R, P>,
    {
        let common = self.slot.common();
        let mut effects = ConstantEffects::ZERO;
        model.constant_effects(&common.x, &common.theta, input, &mut effects);
        let Some(read_from) = self.read_from.take() else { return effects };
        for (error, output) in self.errors.state.iter_mut().zip(read_from) {
            error.fill(0.0);
            if let Some(effect) = output.and_then(|output| effects.outputs.get(output)) {
                add_scaled(error, -1.0, effect);
            }
            if let Some(bias) = columns.bias_of(output).and_then(|column| self.errors.parameters.get(column)) {
                add_scaled(error, -1.0, bias);
            }
        }
        effects
    }
}

impl<S, const N: usize, const P: usize, const K: usize> Slot<N, P> for Considering<S, N, P, K>
where
    S: Followed<N, P>,
{
    fn check<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> Result<(), SettingsError> {
        S::check(settings)
    }

    fn check_constants(count: usize) -> Result<(), SettingsError> {
        if count > K { Err(SettingsError::Constants { needed: count, capacity: K }) } else { Ok(()) }
    }

    fn prior<const R: usize>(settings: &EstimatorSettings<N, R, P>, columns: &Columns<R, P>) -> Self {
        let errors = Errors { state: [[0.0; K]; N], parameters: [[0.0; K]; P] };
        Self { slot: S::prior(settings, columns), errors, collected: Collected::NONE, read_from: None, count: 0 }
    }

    fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        variances: &[f64; N],
        read_from: &[Option<usize>; N],
        columns: &Columns<R, P>,
    ) {
        self.slot.start_state(x, variances, read_from, columns);
        self.read_from = Some(*read_from);
    }

    fn predict<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
        transition: &mut [[f64; N]; N],
    ) -> bool
    where
        M: Model<N, R, P>,
    {
        self.count = model.constant_count().min(K);
        if self.count == 0 {
            return self.slot.predict(model, settings, columns, levels, input, interval_s, transition);
        }
        if self.read_from.is_some() {
            self.effects(model, columns, &input.from);
        }
        let before = self.errors.state;
        let Self { slot, errors, .. } = self;
        let theta = slot.common().theta;
        let mut follower = Interval { errors, model, theta, input, interval_s, effects: ConstantEffects::ZERO };
        let predicted =
            slot.predict_followed(model, settings, columns, levels, input, interval_s, transition, &mut follower);
        if !predicted {
            self.errors.state = before;
        }
        predicted
    }

    fn correct<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        watch: Option<Watch<'_, R, P>>,
        frame: Option<&mut Frame<N, R>>,
    ) -> Innovations<R>
    where
        M: Model<N, R, P>,
    {
        self.count = model.constant_count().min(K);
        if self.count == 0 {
            return self.slot.correct(
                model,
                settings,
                columns,
                levels,
                input,
                measured,
                adapt_noise,
                surface,
                watch,
                frame,
            );
        }
        let effects = self.effects(model, columns, input);
        let Self { slot, errors, collected, .. } = self;
        let before = slot.common().theta;
        let learnable = model.learnable_constants();
        let mut follower = Rows { errors, collected, learnable, effects };
        let innovations = slot.correct_followed(
            model,
            settings,
            columns,
            levels,
            input,
            measured,
            adapt_noise,
            surface,
            watch,
            frame,
            &mut follower,
        );
        let Common { x, theta, .. } = slot.common();
        let steps = theta.iter().zip(&before).map(|(after, before)| after - before);
        for (column, step) in steps.enumerate().take(model.parameter_count()) {
            if let Some(error) = errors.parameters.get_mut(column) {
                let powers: [f64; K] = model.regressor_powers(x, column);
                add_scaled(error, step, &powers);
            }
            for shift in model.regressor_shifts(column) {
                let error = errors.parameters.get_mut(shift.of).and_then(|row| row.get_mut(shift.constant));
                if let Some(error) = error {
                    *error += shift.per_unit * step;
                }
            }
        }
        innovations
    }

    fn gate<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> f64 {
        S::gate(settings)
    }

    fn reopen<const R: usize>(
        &mut self,
        columns: &Columns<R, P>,
        tested: &[usize],
        change_over_prior: &[f64; P],
        state_variance: &[f64; N],
    ) -> bool {
        self.slot.reopen(columns, tested, change_over_prior, state_variance)
    }

    fn common(&self) -> &Common<N, P> {
        self.slot.common()
    }

    fn variances(&self) -> [f64; P] {
        self.slot.variances()
    }

    fn write_covariance(&self, out: &mut [[f64; P]; P]) {
        self.slot.write_covariance(out);
    }

    fn close_colour_block(&mut self) {
        self.slot.close_colour_block();
        self.collected.close_block();
    }

    fn renew_colour(&mut self) {
        self.slot.renew_colour();
    }

    /// Of the estimate alone: errors that are no numbers are no reason to lose it.
    fn is_sound(&self, columns: usize) -> bool {
        self.slot.is_sound(columns)
    }

    fn by_constant(&self, column: usize) -> Option<&[f64]> {
        if self.count == 0 {
            return None;
        }
        self.errors.parameters.get(column).and_then(|row| row.get(..self.count))
    }

    fn evidence<'a>(&'a self, constants: &'a [usize]) -> Option<Evidence<'a>> {
        (self.count > 0).then(|| self.collected.evidence(constants, self.count))
    }
}
