//! A moment at which a record asks for other parameters, though none of them shows that the aircraft changed.
//!
//! The second look at a record (`pipeline::look_back`) believes a change where a derivative or a constant is another one before and
//! after. What is not believed may still be one: of two foreign flights in which a constant moment set in, and for which that
//! asked for a little more than they had, `Cm_alpha` came out at a quarter of its value, and nothing was said against it.

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::core::number::significant;
use crate::methods::{ColumnRun, Disputed, Run};
use crate::model_file::{ModelFile, Parameter};

/// Claimed standard errors of the result by which a derivative has to be another one with the parameters opened ...
const FAR: f64 = 4.0;
/// ... and of its value then.
const KNOWN: f64 = 3.0;
/// Significant digits of a value in the sentence.
const DIGITS: i32 = 3;

/// The doubt about a result of which derivatives are others when the parameters are opened at the disputed moment; none if all are
/// the same. Values that the flight does not settle with them opened say nothing.
pub(super) fn reason<const R: usize>(file: &ModelFile, run: &Run<R>) -> Option<VerdictReason> {
    let of = |(parameter, column): (&Parameter, &ColumnRun)| {
        (!parameter.role.is_constant()).then(|| (parameter.name.clone(), [column.value, column.corrected_std_error]))
    };
    let result: Vec<Option<(String, [f64; 2])>> = file.estimated().zip(&run.columns).map(of).collect();
    said(run.disputed.as_ref()?, &result)
}

/// The same from the values and claimed standard errors of the derivatives by column; none for a constant.
fn said(Disputed { time_s, gain, opened }: &Disputed, result: &[Option<(String, [f64; 2])>]) -> Option<VerdictReason> {
    let mut names: Vec<String> = Vec::new();
    let mut list: Vec<String> = Vec::new();
    for ((name, [whole, whole_std]), [value, std]) in result.iter().zip(opened).filter_map(|(a, b)| a.as_ref().zip(*b))
    {
        let distance = (value - whole).abs();
        if distance > FAR * whole_std && distance > KNOWN * std {
            let [whole, value] = [*whole, value].map(|v| significant(v, DIGITS));
            list.push(format!("{name} {whole} for the whole and {value} from there on"));
            names.push(name.clone());
        }
    }
    (!names.is_empty()).then(|| VerdictReason {
        code: ReasonCode::NotConstant,
        status: EstimationStatus::Doubtful,
        concerns: names,
        sentence: format!(
            "The record is predicted much better ({gain:.0} nats) with the parameters opened at {time_s:.1} s, and they are \
             others then: {}. Nothing shows what changed there: a trim shift or a damage that the flight does not settle, a \
             sensor, gusts that turn the air, or a term that the model lacks. Estimate the parts by themselves (--to {time_s:.0}s, --from {time_s:.0}s).",
            list.join("; ")
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_is_in_doubt_where_its_values_are_others_from_a_disputed_moment_on() {
        let result = [Some(("Cm_alpha".to_owned(), [-0.138, 0.062])), None, Some(("Cm_q".to_owned(), [-10.9, 3.8]))];
        let with = |opened: [Option<[f64; 2]>; 3]| {
            said(&Disputed { time_s: 27.97, gain: 2618.0, opened: opened.to_vec() }, &result)
        };
        let found = with([Some([-0.6, 0.1]), Some([0.1, 1e-3]), Some([-18.0, 2.0])]).unwrap();
        assert_eq!((found.code, found.status), (ReasonCode::NotConstant, EstimationStatus::Doubtful));
        assert_eq!(found.concerns, ["Cm_alpha"]);
        assert!(found.sentence.contains("(2618 nats) with the parameters opened at 28.0 s"), "{}", found.sentence);
        assert!(
            found.sentence.contains("Cm_alpha -0.138 for the whole and -0.600 from there on"),
            "{}",
            found.sentence
        );
        // Hardly known with them opened, not settled, or the same.
        assert_eq!(with([Some([-0.6, 0.2]), None, None]), None);
        assert_eq!(with([None, None, None]), None);
        assert_eq!(with([Some([-0.3, 0.01]), None, None]), None);
    }
}
