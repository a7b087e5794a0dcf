//! What an error of a constant adds to the regressor of one term of that of another one.

use phugoid_estimators::RegressorShift;

use super::term::{Coefficient, Term, Variable};

/// A constant that makes a flight variable larger by the same amount everywhere, `per_unit` of the variable per unit of the
/// constant.
pub(crate) struct Moved {
    /// The constant, by its column.
    pub constant: usize,
    /// The variable.
    pub variable: Variable,
    /// By how much.
    pub per_unit: f64,
}

/// A constant that turns lift and drag, which the accelerometers see along the axes of the body: `per_unit` rad per unit of the
/// constant more angle of attack than there is.
pub(crate) struct Turned {
    /// The constant, by its column.
    pub constant: usize,
    /// By how much.
    pub per_unit: f64,
}

/// The shifts of each of some columns:
///
/// ```text
/// (v + c)^n = v^n + n c v^(n-1) + ...                                   the column with one power less of v
/// lift seen at alpha + c:  (sin, -cos)(alpha) + c (cos, sin)(alpha)     less c times the drag column of the same term
/// drag seen at alpha + c:  (-cos, -sin)(alpha) + c (sin, -cos)(alpha)   c times the lift column of the same term more
/// ```
pub(crate) fn shifts(columns: &[(Coefficient, Term)], moved: &[Moved], turned: &[Turned]) -> Vec<Vec<RegressorShift>> {
    let place =
        |coefficient: Coefficient, term: &Term| columns.iter().position(|(c, t)| *c == coefficient && t == term);
    let of_column = |(coefficient, term): &(Coefficient, Term)| {
        let mut shifts = Vec::new();
        for Moved { constant, variable, per_unit } in moved {
            let Some((lowered, power)) = term.lowered(variable.index()) else { continue };
            if let Some(of) = place(*coefficient, &lowered) {
                shifts.push(RegressorShift { constant: *constant, of, per_unit: f64::from(power) * per_unit });
            }
        }
        let other = match coefficient {
            Coefficient::Lift => Some((Coefficient::Drag, -1.0)),
            Coefficient::Drag => Some((Coefficient::Lift, 1.0)),
            _ => None,
        };
        if let Some((of, sign)) = other.and_then(|(other, sign)| Some((place(other, term)?, sign))) {
            let all = turned.iter();
            shifts.extend(all.map(|t| RegressorShift { constant: t.constant, of, per_unit: sign * t.per_unit }));
        }
        shifts.retain(|shift| shift.per_unit != 0.0);
        shifts
    };
    columns.iter().map(of_column).collect()
}
