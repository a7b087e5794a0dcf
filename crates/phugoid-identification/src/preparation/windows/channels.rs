//! The measurements of a flight that the checks share, without wild samples.

use phugoid_flight_data::statistics::{median, median_step};

use crate::model_file::ModelFile;
use crate::motion::Motion;
use crate::preparation::prepared::Prepared;

/// Jumps of this many median steps to both neighbours make a sample an outlier.
const STANDS_OUT: f64 = 8.0;

/// Channels in SI units by sample: those samples that hold them all.
pub(crate) struct Channels {
    pub(crate) time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Channels {
    /// The channels of these names, outputs or known inputs of the flight. None if one of them is not there. Samples
    /// with a missing value, or with one that stands out of both neighbours, are left out.
    pub(crate) fn of<M: Motion<N, R>, const N: usize, const R: usize>(
        prepared: &Prepared<M, N, R>,
        file: &ModelFile,
        names: &[&str],
    ) -> Option<Self> {
        let column = |name: &&str| -> Option<Vec<f64>> {
            let row = M::AXES.outputs().iter().position(|o| o.name() == *name && file.outputs[o.index()]);
            let measured = row.map(|row| prepared.outputs.iter().map(|y| y[row]).collect());
            let known =
                || prepared.known.iter().find(|signal| signal.name == *name).map(|signal| signal.values.clone());
            measured.or_else(known)
        };
        let columns: Vec<Vec<f64>> = names.iter().map(column).collect::<Option<_>>()?;
        Some(Self::without_outliers(&prepared.time, &columns))
    }

    fn without_outliers(time: &[f64], columns: &[Vec<f64>]) -> Self {
        let limit = |values: &Vec<f64>| {
            let mut steps: Vec<f64> =
                values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|d| d.is_finite()).collect();
            STANDS_OUT * median(&mut steps).unwrap_or(0.0)
        };
        let limits: Vec<f64> = columns.iter().map(limit).collect();
        let stands_out = |k: usize| {
            columns.iter().zip(&limits).any(|(values, limit)| {
                let from = |other: usize| values.get(other).map_or(f64::NAN, |value| values[k] - value);
                let (before, after) = (from(k.wrapping_sub(1)), from(k + 1));
                *limit > 0.0 && before.abs() > *limit && after.abs() > *limit && before * after > 0.0
            })
        };
        let kept: Vec<usize> = (0..time.len())
            .filter(|k| columns.iter().all(|values| values[*k].is_finite()) && !stands_out(*k))
            .collect();
        let picked = |values: &[f64]| kept.iter().map(|k| values[*k]).collect::<Vec<f64>>();
        Self { time_s: picked(time), columns: columns.iter().map(|values| picked(values)).collect() }
    }

    /// Channels as they are, for tests of single checks.
    #[cfg(test)]
    pub(crate) fn for_tests(time_s: Vec<f64>, columns: Vec<Vec<f64>>) -> Self {
        Self { time_s, columns }
    }

    /// The values in the order of the names.
    pub(crate) fn values<const C: usize>(&self) -> Option<[&[f64]; C]> {
        let all: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).collect();
        all.try_into().ok()
    }

    /// The median step of the samples, s.
    pub(crate) fn step_s(&self) -> Option<f64> {
        median_step(&self.time_s)
    }
}
