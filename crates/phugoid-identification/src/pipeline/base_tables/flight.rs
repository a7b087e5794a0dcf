//! A database over what was flown: how much a moved one differs from it, and what it has itself in the place of a parameter.

use nalgebra::{DMatrix, DVector};
use phugoid_flight_data::statistics::median;

use crate::core::axes::Axes;
use crate::core::output::Output;
use crate::core::term::{Coefficient, FACTORS, Term, Variable};
use crate::judge::total::Secant;
use crate::model_file::{ModelFile, Parameter, RateSpeed, Role};
use crate::models::database::{Database, InAir};
use crate::motion::{Motion, ReferencePoint};
use crate::preparation::database_part::Condition;
use crate::preparation::prepared::Prepared;

/// Samples of the flight at which a database is looked at, at most.
const MOST_SAMPLES: usize = 400;
/// Part of the largest singular value below which a direction counts as not flown.
const FLOWN: f64 = 1e-9;

/// What was flown, as a database and the terms of the model file have it.
pub(super) struct Flight<'a> {
    file: &'a ModelFile,
    reference: ReferencePoint,
    condition: Condition,
    /// The variables of the terms by sample, at the reference zero (of the airspeed that of the condition). Further inputs, which no
    /// database reads, and the rate of the angle of attack stay zero.
    variables: Vec<[f64; FACTORS]>,
    /// The variables at the reference.
    at_reference: [f64; FACTORS],
    /// What a dimensionless rate of the terms is multiplied by, so that it is one with the speed of the condition.
    actual: f64,
    samples: Vec<InAir<f64>>,
}

impl<'a> Flight<'a> {
    pub(super) fn of<M: Motion<N, R>, const N: usize, const R: usize>(
        prepared: &Prepared<M, N, R>,
        file: &'a ModelFile,
    ) -> Self {
        let condition = prepared.condition(file);
        let reference = prepared.reference;
        let signal = |name: &str| -> Option<Vec<f64>> {
            if let Some(known) = prepared.known.iter().find(|signal| signal.name == name) {
                return Some(known.values.clone());
            }
            let row = M::AXES.outputs().iter().position(|output| output.name() == name)?;
            Some(prepared.outputs.iter().map(|y| y[row]).collect())
        };
        // The motion of a plane knows nothing of what leads out of it.
        let is_plane = M::AXES == Axes::Longitudinal;
        let in_flight = |output: Output, otherwise: f64| {
            let leads_out = matches!(output, Output::Beta | Output::RollRate | Output::YawRate);
            let values = if is_plane && leads_out { None } else { signal(output.name()) };
            move |k: usize| {
                values.as_ref().and_then(|values| values.get(k)).copied().filter(|v| v.is_finite()).unwrap_or(otherwise)
            }
        };
        let speed = in_flight(Output::TrueAirspeed, condition.speed);
        let [alpha, beta] = [(Output::Alpha, reference.alpha), (Output::Beta, 0.0)].map(|(o, v)| in_flight(o, v));
        let rates = [Output::RollRate, Output::PitchRate, Output::YawRate].map(|output| in_flight(output, 0.0));
        let densities = signal("air_density");
        let step = prepared.time.len().div_ceil(MOST_SAMPLES).max(1);
        let deflections = |k: usize| {
            let [elevator, aileron, rudder] = M::deflections(&prepared.inputs[k]);
            if is_plane { [elevator, 0.0, 0.0] } else { [elevator, aileron, rudder] }
        };
        let at = |k: usize| InAir {
            speed: speed(k),
            flow: [alpha(k), beta(k)],
            density: densities.as_ref().map_or(condition.density, |values| values[k]),
            mach: None,
            rates: [rates[0](k), rates[1](k), rates[2](k)],
            deflections: deflections(k),
        };
        let samples: Vec<InAir<f64>> = (0..prepared.time.len()).step_by(step).map(at).collect();
        let middle = median(&mut samples.iter().map(|sample| sample.speed).collect::<Vec<f64>>());
        let middle = middle.unwrap_or(condition.speed);
        let reference_speed = file.aircraft.reference_speed.unwrap_or(condition.speed);
        let rate_speed = |speed: f64| match file.rate_speed {
            RateSpeed::Actual => speed,
            RateSpeed::Reference => reference_speed,
        };
        let lengths = lengths(file);
        let variables = samples.iter().map(|sample| {
            let mut values = [0.0; FACTORS];
            values[Variable::Alpha.index()] = sample.flow[0] - reference.alpha;
            values[Variable::Beta.index()] = sample.flow[1];
            for ((variable, length), rate) in RATES.into_iter().zip(lengths).zip(sample.rates) {
                values[variable.index()] = 0.5 * rate * length / rate_speed(sample.speed);
            }
            values[Variable::Airspeed.index()] = sample.speed / reference_speed;
            let [elevator, aileron, rudder] = sample.deflections;
            values[Variable::Elevator.index()] = elevator - reference.elevator;
            values[Variable::Aileron.index()] = aileron - reference.aileron;
            values[Variable::Rudder.index()] = rudder - reference.rudder;
            values
        });
        let mut at_reference = [0.0; FACTORS];
        at_reference[Variable::Airspeed.index()] = condition.speed / reference_speed;
        Self {
            file,
            reference,
            condition,
            variables: variables.collect(),
            at_reference,
            actual: rate_speed(middle) / middle,
            samples,
        }
    }

    /// The six coefficients of a database at the reference point.
    pub(super) fn at_reference(&self, database: &Database) -> [f64; 6] {
        database.all(&self.in_air(&self.at_reference))
    }

    /// The flight condition in which the variables of the terms have these values.
    fn in_air(&self, variables: &[f64; FACTORS]) -> InAir<f64> {
        let of = |variable: Variable| variables[variable.index()];
        let ReferencePoint { alpha, elevator, aileron, rudder } = self.reference;
        let Condition { speed, density } = self.condition;
        let reference_speed = self.file.aircraft.reference_speed.unwrap_or(speed);
        let lengths = lengths(self.file);
        InAir {
            speed: of(Variable::Airspeed) * reference_speed,
            flow: [alpha + of(Variable::Alpha), of(Variable::Beta)],
            density,
            mach: None,
            rates: std::array::from_fn(|axis| {
                let hat = of(RATES[axis]) * self.actual;
                // Without a span there are no terms of the rates that need it.
                if hat == 0.0 { 0.0 } else { hat * 2.0 * speed / lengths[axis] }
            }),
            deflections: [
                elevator + of(Variable::Elevator),
                aileron + of(Variable::Aileron),
                rudder + of(Variable::Rudder),
            ],
        }
    }

    /// How much a moved database differs from the one as written, of the coefficients of the motion: the root mean square over the flight
    /// of the difference, as a part of what that coefficient changes in flight; the largest of them. Zero if it differs nowhere, NaN where
    /// it has no number.
    pub(super) fn difference(&self, written: &Database, moved: &Database) -> f64 {
        let reference = self.in_air(&self.at_reference);
        let points = || self.samples.iter().chain([&reference]);
        // Where the file itself has no number there is nothing to compare with.
        let has_numbers = |[written, _]: &[[f64; 6]; 2]| written.iter().all(|value| value.is_finite());
        let values: Vec<[[f64; 6]; 2]> =
            points().map(|at| [written.all(at), moved.all(at)]).filter(has_numbers).collect();
        let count = values.len() as f64;
        let mut largest = 0.0;
        for coefficient in self.file.axes.coefficients() {
            let place = *coefficient as usize;
            let mean = values.iter().map(|[written, _]| written[place]).sum::<f64>() / count;
            let rms = |of: &dyn Fn(&[[f64; 6]; 2]) -> f64| {
                (values.iter().map(|pair| of(pair).powi(2)).sum::<f64>() / count).sqrt()
            };
            let difference = rms(&|[written, moved]| moved[place] - written[place]);
            let size = rms(&|[written, _]| written[place]);
            // What is left by rounding is no difference.
            if difference <= 1e-12 * size {
                continue;
            }
            let part = difference / (rms(&|[written, _]| written[place] - mean) + 1e-3 * size).max(f64::MIN_POSITIVE);
            if part.is_nan() {
                return f64::NAN;
            }
            largest = f64::max(largest, part);
        }
        largest
    }

    /// What a database has itself in the place of each estimated parameter, in the order of the columns: of a constant its coefficient at
    /// the reference point, of a term of one variable its slope over what was flown ([`Secant`]), and of other terms their part in the
    /// least-squares fit to the database by the terms of the coefficient, where the variables of the term alone are those of the
    /// flight, and all others at the reference. Zero of a bias.
    pub(super) fn own(&self, database: &Database) -> Vec<f64> {
        self.file.estimated().map(|parameter| self.own_of(database, parameter)).collect()
    }

    fn own_of(&self, database: &Database, parameter: &Parameter) -> f64 {
        let (coefficient, term) = match &parameter.role {
            Role::Bias(_) => return 0.0,
            Role::Offset(coefficient) => (*coefficient, &Term::default()),
            Role::Term(coefficient, term) => (*coefficient, term),
        };
        let place = coefficient as usize;
        if term.is_constant() {
            return self.at_reference(database)[place];
        }
        if term.powers().any(|(index, _)| index >= Variable::ALL.len()) {
            return 0.0;
        }
        let is_alone = !self
            .terms(coefficient)
            .any(|other| other != term && other.powers().any(|(index, _)| term.powers().any(|(own, _)| own == index)));
        match term.single() {
            Some(index) if index == Variable::AlphaRate.index() => {
                let (Condition { speed, density }, ReferencePoint { alpha, elevator, .. }) =
                    (self.condition, self.reference);
                let slopes = database.by_alpha_rate(speed, density, alpha, elevator);
                slopes.and_then(|slopes| slopes.get(place).copied()).unwrap_or(0.0)
            }
            Some(index) if is_alone => {
                let flown: Vec<f64> = self.variables.iter().map(|values| values[index]).collect();
                let at = |value: f64| {
                    let mut variables = self.at_reference;
                    variables[index] = value;
                    database.all(&self.in_air(&variables))[place]
                };
                Secant::over(&flown, self.at_reference[index], at).map_or(f64::NAN, |secant| secant.slope())
            }
            _ => self.fitted(database, coefficient, term),
        }
    }

    fn terms(&self, coefficient: Coefficient) -> impl Iterator<Item = &Term> {
        self.file.parameters.iter().filter_map(move |parameter| match &parameter.role {
            Role::Term(of, term) if *of == coefficient => Some(term),
            _ => None,
        })
    }

    /// The part of a term in the fit to the database over the variables of the term.
    fn fitted(&self, database: &Database, coefficient: Coefficient, term: &Term) -> f64 {
        let own: Vec<usize> = term.powers().map(|(index, _)| index).collect();
        let is_of_them = |other: &&Term| !other.is_constant() && other.powers().all(|(index, _)| own.contains(&index));
        let terms: Vec<&Term> = self.terms(coefficient).filter(is_of_them).collect();
        let Some(column) = terms.iter().position(|other| *other == term) else { return 0.0 };
        let cut = |values: &[f64; FACTORS]| {
            let mut variables = self.at_reference;
            own.iter().for_each(|index| variables[*index] = values[*index]);
            variables
        };
        let points: Vec<[f64; FACTORS]> = self.variables.iter().map(cut).collect();
        // The last column is a constant.
        let regressor = |row: usize, column: usize| terms.get(column).map_or(1.0, |term| term.value(&points[row]));
        let matrix = DMatrix::from_fn(points.len(), terms.len() + 1, regressor);
        let values = DVector::from_iterator(
            points.len(),
            points.iter().map(|point| database.all(&self.in_air(point))[coefficient as usize]),
        );
        let decomposed = matrix.svd(true, true);
        let least = FLOWN * decomposed.singular_values.max();
        decomposed.solve(&values, least).map_or(f64::NAN, |solution| solution[column])
    }
}

/// The rates, in the order of the body axes.
const RATES: [Variable; 3] = [Variable::RollRate, Variable::PitchRate, Variable::YawRate];

/// What makes each rate dimensionless, m: span, chord and span. A span that nobody gives is that of terms that there are not.
fn lengths(file: &ModelFile) -> [f64; 3] {
    let span = file.aircraft.wing_span.unwrap_or(file.aircraft.mean_chord);
    [span, file.aircraft.mean_chord, span]
}
