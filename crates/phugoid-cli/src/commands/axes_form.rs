//! The derivatives of an estimation in stability or in body axes: `--axes-form`.

use std::fmt::Write as _;

use phugoid_identification::estimation::Estimation;
use phugoid_identification::form::{Derivatives, Form};
use phugoid_identification::model_file::ModelFile;
use serde::Serialize;

use crate::arguments::AxesForm;
use crate::output::{Table, significant};

/// The derivatives in the axes of `--axes-form`, per rad, with their covariance.
#[derive(Debug, Serialize)]
pub(crate) struct Turned {
    /// `stability` or `body`.
    axes: &'static str,
    /// Reference angle of attack by which the axes are turned, rad.
    alpha_reference_rad: f64,
    derivatives: Vec<TurnedDerivative>,
    /// Covariance matrix; rows and columns in the order of `derivatives`.
    covariance: Vec<Vec<f64>>,
    /// Names of parameters that were not transformed, because they are not derivatives at the reference point.
    left_out: Vec<String>,
}

#[derive(Debug, Serialize)]
struct TurnedDerivative {
    name: String,
    value: f64,
    std_error: f64,
}

impl Turned {
    pub(crate) fn of(estimation: &Estimation, model: &ModelFile, form: AxesForm) -> Self {
        let form = match form {
            AxesForm::Stability => Form::Stability,
            AxesForm::Body => Form::Body,
        };
        let (own, left_out) = Derivatives::of(estimation, model);
        let turned = own.to(form, estimation.alpha_reference);
        let named = turned.values.iter().zip(turned.std_errors()).enumerate();
        Self {
            axes: form.name(),
            alpha_reference_rad: estimation.alpha_reference,
            derivatives: named
                .map(|(i, (value, std_error))| TurnedDerivative { name: turned.name(i), value: *value, std_error })
                .collect(),
            covariance: turned.covariance.clone(),
            left_out,
        }
    }

    pub(crate) fn text(&self) -> String {
        let degrees = significant(self.alpha_reference_rad.to_degrees(), 4);
        let mut text = format!("\nIn {} axes, at an angle of attack of {degrees} deg\n", self.axes);
        let mut table = Table::new(&["derivative", "estimate", "+- 2 sigma"]);
        for d in &self.derivatives {
            table.row([d.name.clone(), significant(d.value, 5), significant(2.0 * d.std_error, 3)]);
        }
        text.push_str(&table.render());
        if !self.left_out.is_empty() {
            let _ = writeln!(text, "  (not turned: {})", self.left_out.join(", "));
        }
        text
    }
}
