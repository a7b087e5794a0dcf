//! What several tests need: the shared data, or one line saying that it is not there.
#![allow(dead_code, unused_imports)] // each test binary uses its own part

#[path = "../../../../tests/shared_data.rs"]
mod shared_data;

pub(crate) use shared_data::shared_file;
pub(crate) mod short_period;

use std::path::PathBuf;

/// A table of plain numbers with one header line.
pub(crate) struct Table {
    pub(crate) headers: Vec<String>,
    pub(crate) rows: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn read(path: &std::path::Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let headers = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let number = |cell: &str| if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
        Self { headers, rows: lines.map(|line| line.split(',').map(number).collect()).collect() }
    }

    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let index = self.headers.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[index]).collect()
    }
}

/// Reproducible normal numbers (a 64-bit linear congruential generator and Box-Muller).
pub(crate) struct Normal {
    state: u64,
}

impl Normal {
    pub(crate) fn new(seed: u64) -> Self {
        let mut this = Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) };
        for _ in 0..8 {
            this.uniform();
        }
        this
    }

    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub(crate) fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A simulated flight of the built-in F-16 model: 3-2-1-1 elevator from 0.5 s, sensor noise of the F-16 study.
pub(crate) mod f16 {
    use phugoid_estimators::discretization::{self, InputHold, IntervalInput, Part};
    use phugoid_estimators::{LinearizedOutputs, Model};
    use phugoid_flight_data::record::{Channel, Quantity, Record};
    use phugoid_identification::longitudinal::{LongitudinalInput, LongitudinalModel, OUTPUTS, STATES};
    use phugoid_identification::model_file::ModelFile;
    use phugoid_identification::prepare::prepare;

    use super::Normal;

    /// Names and true values of the increments, in the order of the built-in model file.
    pub(crate) const TRUTH: [(&str, f64); 5] =
        [("dCL_alpha", 0.4), ("dCD_alpha", 0.1), ("dCm_alpha", -0.2), ("dCm_q", -2.0), ("dCm_elevator", 0.15)];
    pub(crate) const NOISE: [f64; OUTPUTS] = [0.3048, 0.001745, 0.000873, 0.001745, 0.098, 0.098, 0.0];
    /// 20,000 ft, 675 ft/s, cg 0.30: trim angle of attack and elevator, rad.
    pub(crate) const TRIM: [f64; 2] = [0.041_701_849_9, -0.034_252_805_2];

    pub(crate) fn model() -> ModelFile {
        ModelFile::parse("f16", unbiased()).unwrap()
    }

    /// The text of the built-in model without its sensor biases: five parameters.
    pub(crate) fn unbiased() -> &'static str {
        include_str!("../../../../data/models/f16.toml").split("\n[biases]").next().unwrap()
    }

    pub(crate) fn channel(name: &str, quantity: Quantity, values: Vec<f64>) -> Channel {
        Channel { name: name.to_owned(), quantity, values }
    }

    /// Elevator deflection from trim, rad: steps of 3, 2, 1, 1 half seconds, up, down, up, down.
    pub(crate) fn three_two_one_one(time: f64, amplitude: f64) -> f64 {
        match time - 0.5 {
            t if t < 0.0 => 0.0,
            t if t < 1.5 => amplitude,
            t if t < 2.5 => -amplitude,
            t if t < 3.0 => amplitude,
            t if t < 3.5 => -amplitude,
            _ => 0.0,
        }
    }

    /// Record of a flight at 50 Hz with the elevator `trim + amplitude * 3-2-1-1`.
    pub(crate) fn fly(seconds: f64, amplitude: f64, seed: u64) -> Record {
        let samples = (50.0 * seconds) as usize;
        let time: Vec<f64> = (0..samples).map(|k| 0.02 * k as f64).collect();
        let elevator: Vec<f64> = time.iter().map(|t| TRIM[1] + three_two_one_one(*t, amplitude)).collect();
        let blank = || vec![0.0; samples];
        let mut record = Record {
            source: "simulated".to_owned(),
            time: time.clone(),
            channels: vec![
                channel("elevator", Quantity::Angle, elevator),
                channel("altitude", Quantity::Length, vec![6096.0; samples]),
                channel("true_airspeed", Quantity::Speed, blank()),
                channel("alpha", Quantity::Angle, blank()),
                channel("theta", Quantity::Angle, blank()),
                channel("q", Quantity::AngularRate, blank()),
                channel("ax", Quantity::Acceleration, blank()),
                channel("az", Quantity::Acceleration, blank()),
            ],
            ..Record::default()
        };
        let prepared = prepare::<LongitudinalModel, _, _>(&record, &model()).unwrap();
        let mut theta = [0.0; 5];
        for (slot, (_, value)) in theta.iter_mut().zip(TRUTH) {
            *slot = value;
        }
        let mut normal = Normal::new(seed);
        let mut x = [205.74, TRIM[0], TRIM[0], 0.0];
        for k in 0..samples {
            let input: LongitudinalInput = prepared.inputs[k];
            let mut out = LinearizedOutputs::<STATES, OUTPUTS, 5>::ZERO;
            prepared.model.linearized_outputs(&x, &theta, &input, &mut out);
            for i in 0..6 {
                record.channels[2 + i].values[k] = out.outputs[i] + NOISE[i] * normal.next();
            }
            let interval = IntervalInput { from: input, to: input, hold: InputHold::Zero };
            let (mut sensitivity, mut transition) = ([[0.0; 5]; STATES], [[0.0; STATES]; STATES]);
            let part = Part { from: 0.0, to: 1.0 };
            x = discretization::step::<_, STATES, OUTPUTS, 5>(
                &prepared.model,
                &x,
                &theta,
                &interval,
                0.02,
                part,
                0,
                &mut sensitivity,
                &mut transition,
            );
        }
        record
    }
}
