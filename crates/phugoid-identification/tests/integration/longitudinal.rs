//! The longitudinal model against its own differences, and against the equations as the HFB-320 example prints them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_identification::longitudinal::{Database, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::prepare::build;
use proptest::prelude::*;

const P: usize = 24;

fn hfb320() -> LongitudinalModel {
    build(&ModelFile::named("hfb320").unwrap(), Database::None, 0.0, 0.0)
}

fn f16() -> LongitudinalModel {
    let aircraft = F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap();
    let file = ModelFile::named("f16").unwrap();
    build(&file, Database::F16(Box::new(aircraft)), 0.0417, -0.0343)
}

/// Products, powers and extra inputs on top of a database, all at once.
fn rich() -> LongitudinalModel {
    let text = include_str!("../../../../data/models/f16.toml")
        .replace("base = \"f16\"", "base = \"f16\"\ninputs = [\"flap\"]")
        .replace("CL = [\"alpha\"]", "CL = [\"alpha\", \"alpha^2\", \"flap*v_hat\"]\noffsets = true")
        .replace("Cm = [", "Cm = [\"alpha*elevator\", \"alpha^3*q_hat\", ")
        .replace(
            "[parameters] ",
            "[parameters]\ndCL_alpha2.prior_std = 1\ndCL_v_hat_flap.prior_std = 1\ndCL_V_flap.prior_std = 1\n\
             dCm_alpha_elevator.prior_std = 1\ndCm_alpha3_q.prior_std = 1\n#",
        )
        .replace("dCL_v_hat_flap.prior_std = 1\n", "");
    let file = ModelFile::parse("rich", &text).unwrap();
    let aircraft = F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap();
    build(&file, Database::F16(Box::new(aircraft)), 0.0417, -0.0343)
}

fn outputs(m: &LongitudinalModel, x: &[f64; STATES], theta: &[f64; P], u: &LongitudinalInput) -> [f64; OUTPUTS] {
    let mut out = LinearizedOutputs::<STATES, OUTPUTS, P>::ZERO;
    m.linearized_outputs(x, theta, u, &mut out);
    out.outputs
}

fn check_jacobians(m: &LongitudinalModel, x: [f64; STATES], theta: [f64; P], u: LongitudinalInput) {
    let mut rates = LinearizedRates::<STATES, P>::ZERO;
    m.linearized_rates(&x, &theta, &u, &mut rates);
    let mut out = LinearizedOutputs::<STATES, OUTPUTS, P>::ZERO;
    m.linearized_outputs(&x, &theta, &u, &mut out);
    let plain = <LongitudinalModel as Model<STATES, OUTPUTS, P>>::rates(m, &x, &theta, &u);
    for i in 0..STATES {
        // A dual number divides by multiplying with the reciprocal: the last bit may differ.
        assert!((plain[i] - rates.rates[i]).abs() <= 1e-14 * (1.0 + plain[i].abs()), "rate {i}");
    }
    let near = |numeric: f64, exact: f64, what: String| {
        assert!((numeric - exact).abs() <= 2e-6 * (1.0 + exact.abs()), "{what}: {numeric} against {exact}");
    };
    for j in 0..STATES {
        let step = 1e-6 * (1.0 + x[j].abs());
        let (mut high, mut low) = (x, x);
        high[j] += step;
        low[j] -= step;
        let (rh, rl) = (
            <LongitudinalModel as Model<STATES, OUTPUTS, P>>::rates(m, &high, &theta, &u),
            <LongitudinalModel as Model<STATES, OUTPUTS, P>>::rates(m, &low, &theta, &u),
        );
        for i in 0..STATES {
            near((rh[i] - rl[i]) / (2.0 * step), rates.state_jacobian[i][j], format!("df{i}/dx{j}"));
        }
        let (yh, yl) = (outputs(m, &high, &theta, &u), outputs(m, &low, &theta, &u));
        for i in 0..OUTPUTS {
            near((yh[i] - yl[i]) / (2.0 * step), out.state_jacobian[i][j], format!("dh{i}/dx{j}"));
        }
    }
    for j in 0..m.columns().len() {
        // Linear in the parameters: any step gives the exact derivative.
        let mut other = theta;
        other[j] += 1.0;
        let r = <LongitudinalModel as Model<STATES, OUTPUTS, P>>::rates(m, &x, &other, &u);
        for i in 0..STATES {
            near(r[i] - rates.rates[i], rates.regressors[i][j], format!("df{i}/dtheta{j}"));
        }
        let y = outputs(m, &x, &other, &u);
        for i in 0..OUTPUTS {
            near(y[i] - out.outputs[i], out.parameter_jacobian[i][j], format!("dh{i}/dtheta{j}"));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn jacobians_agree_with_differences(
        // Away from the table's breakpoints (5 deg, 12 deg elevator), where a one-sided slope and a difference disagree.
        speed in 80.0..250.0_f64, alpha in 0.005..0.08_f64, pitch in -0.2..0.3_f64, q in -0.3..0.3_f64,
        elevator in -0.15..-0.01_f64, flap in 0.0..0.5_f64, thrust in 0.0..2e4_f64, density in 0.3..1.3_f64,
        values in proptest::array::uniform24(-2.0..2.0_f64),
    ) {
        let x = [speed, alpha, pitch, q];
        let u = LongitudinalInput { elevator, air_density: density, thrust, mass: 9300.0, iyy: 75000.0, extra: [flap, 0.0, 0.0], controls_held: false };
        for model in [hfb320(), f16(), rich()] {
            check_jacobians(&model, x, values, u);
        }
    }
}

/// The equations as Jategaonkar prints them (wind axes, thrust line inclined), with the constants as the book uses them.
#[test]
fn hfb320_rates_are_the_books() {
    let m = hfb320();
    let theta_named = [
        0.122688, -0.0644969, 0.320055, -0.0929113, 0.148726, 4.32785, 0.111905, 0.00395154, -0.967854, -34.7098,
        -1.52913,
    ];
    let mut theta = [0.0; P];
    theta[..11].copy_from_slice(&theta_named);
    let [cd0, cdv, cda, cl0, clv, cla, cm0, cmv, cma, cmq, cmde] = theta_named;
    let (v, a, pitch, q, de, thrust): (f64, f64, f64, f64, f64, f64) = (104.0, 0.11, 0.105, 0.02, -0.02, 11500.0);
    let (v0, g, sigma) = (104.67, 9.80665, 0.0524_f64);
    let (s_m, sc_i, lt, half_mac) = (0.004028, 0.00080027, -7.0153e-6, 1.215);
    let qbar = 0.5 * 0.792 * v * v;
    let cd = cd0 + cdv * v / v0 + cda * a;
    let cl = cl0 + clv * v / v0 + cla * a;
    let cm = cm0 + cmv * v / v0 + cma * a + cmq * q * half_mac / v0 + cmde * de;
    let expected = [
        -s_m * qbar * cd + thrust * (a + sigma).cos() / 7472.0 + g * (a - pitch).sin(),
        -s_m * qbar / v * cl - thrust * (a + sigma).sin() / (7472.0 * v) + g * (a - pitch).cos() / v + q,
        q,
        sc_i * qbar * cm + lt * thrust,
    ];
    let u = LongitudinalInput {
        elevator: de,
        air_density: 0.792,
        thrust,
        mass: 7472.0,
        iyy: 91388.0,
        ..LongitudinalInput::default()
    };
    let found = <LongitudinalModel as Model<STATES, OUTPUTS, P>>::rates(&m, &[v, a, pitch, q], &theta, &u);
    for i in 0..STATES {
        // The book rounds S/m and S c/Iyy to four and five digits.
        assert!((found[i] - expected[i]).abs() < 1e-4 * (1.0 + expected[i].abs()), "{i}: {} {}", found[i], expected[i]);
    }
}
