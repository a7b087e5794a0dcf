//! What does not belong to the others: airframes among airframes, and flights among the flights of their airframe.

use phugoid_flight_data::statistics::median;

use super::course::{Combined, Fit, Observation};
use super::distribution::{chi_squared_above, normal_two_sided, student_two_sided};

/// How far one lies from the others.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Apart {
    /// Its distance from what the others say, in the unit of the parameter.
    pub distance: f64,
    /// The same over its standard error.
    pub sigmas: f64,
    /// Probability of as large a distance where it belongs to the others.
    pub p_value: f64,
}

/// How far each airframe lies from the weighted mean of the others; `None` with fewer than three, where nobody could say
/// which one is the other.
///
/// Each is known to its random part and to what belongs to the airframe; what all share cancels. Where the others scatter about
/// their own mean by more than that, at a probability below 5 %, airframes of this type differ: the distance is then measured by
/// the scatter of the middle half of them, and by Student's distribution, since so few tell it. The airframe that is asked about has
/// no part in it: it would hide itself.
pub fn airframes(combined: &[Combined]) -> Option<Vec<Apart>> {
    if combined.len() < 3 {
        return None;
    }
    let variance = |c: &Combined| c.random_std.powi(2) + c.airframe_std.powi(2);
    let weight = |c: &Combined| 1.0 / variance(c);
    let (all, sum): (f64, f64) =
        combined.iter().fold((0.0, 0.0), |(all, sum), c| (all + weight(c), sum + weight(c) * c.value));
    let freedom = (combined.len() - 2) as f64;
    let mut sizes = Vec::with_capacity(combined.len());
    let mut of_one = |own: usize, c: &Combined| {
        let others = all - weight(c);
        let mean = (sum - weight(c) * c.value) / others;
        let each = || combined.iter().enumerate().filter(|(other, _)| *other != own).map(|(_, other)| other);
        let chi_squared: f64 = each().map(|other| weight(other) * (other.value - mean).powi(2)).sum();
        let distance = c.value - mean;
        let claimed = distance / (variance(c) + 1.0 / others).sqrt();
        if chi_squared_above(chi_squared, freedom) >= 0.05 {
            return Apart { distance, sigmas: claimed, p_value: normal_two_sided(claimed) };
        }
        sizes.clear();
        // A mean lies near to each of those that it is made of.
        sizes.extend(each().map(|o| (o.value - mean).abs() / (variance(o) - 1.0 / others).max(0.0).sqrt()));
        // Half of all standard normal numbers are within 0.6745.
        let sigmas = claimed / (median(&mut sizes).unwrap_or(0.0) / 0.6745).max(1.0);
        Apart { distance, sigmas, p_value: student_two_sided(sigmas, freedom) }
    };
    Some(combined.iter().enumerate().map(|(own, c)| of_one(own, c)).collect())
}

/// How far each flight lies from the course that the other flights of its airframe make; `None` where too few are left.
///
/// `claimed` are the same distances over what the flights claim; `p_value` widens that by the scatter of the others.
pub fn flights(observations: &[Observation], fit: &Fit) -> Option<Vec<(Apart, f64)>> {
    let freedom = observations.len().checked_sub(fit.unknowns + 1).filter(|freedom| *freedom >= 1)? as f64;
    let told = observations.iter().zip(fit.fitted.iter().zip(&fit.leverage)).map(|(o, (fitted, leverage))| {
        // The fit without this observation, by its leverage.
        let left = 1.0 - leverage;
        let residual = o.value - fitted;
        let variance =
            o.random_std.powi(2) + super::sharing::part_of(&o.budget, &[super::sharing::Owner::Loading]).powi(2);
        let claimed = residual / (variance * left).sqrt();
        let of_others = ((fit.chi_squared - claimed * claimed).max(0.0) / freedom).sqrt().max(1.0);
        let sigmas = claimed / of_others;
        (Apart { distance: residual / left, sigmas, p_value: student_two_sided(sigmas, freedom) }, claimed)
    });
    Some(told.collect())
}

#[cfg(test)]
mod tests {
    use super::super::course::{combine, constant};
    use super::super::false_discovery::rates;
    use super::*;
    use crate::row::QUANTITIES;
    use crate::simulated::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    fn mean(value: f64) -> Combined {
        let (std_error, random_std, airframe_std, fleet_std) = (1.0, 0.1, 0.5, 0.8);
        Combined { value, std_error, random_std, airframe_std, fleet_std, dispersion: 1.0 }
    }

    #[test]
    fn an_airframe_apart_is_found_and_the_others_are_not() {
        let mut generator = Pcg64Mcg::seed_from_u64(6);
        let (mut found, mut falsely, mut none) = (0, 0, 0);
        for trial in 0..300 {
            let mut fleet: Vec<Combined> = (0..12).map(|_| mean(0.51 * normal(&mut generator))).collect();
            if trial % 2 == 0 {
                fleet[3].value += 4.0;
            }
            let p: Vec<f64> = airframes(&fleet).unwrap().iter().map(|a| a.p_value).collect();
            for (airframe, rate) in rates(&p).into_iter().enumerate().filter(|(_, rate)| *rate <= 0.05) {
                assert!(rate <= 0.05);
                match (airframe, trial % 2) {
                    (3, 0) => found += 1,
                    (_, 0) => falsely += 1,
                    _ => none += 1,
                }
            }
        }
        assert!(found > 140 && falsely < 20 && none < 20, "{found} {falsely} {none}");
        assert!(airframes(&[mean(0.0), mean(9.0)]).is_none());
    }

    /// With five airframes, the one that reads wrong is as far from the mean of all as its own share of the scatter lets it be.
    #[test]
    fn an_airframe_apart_does_not_hide_itself_in_a_small_fleet() {
        let mut generator = Pcg64Mcg::seed_from_u64(9);
        let mut found = 0;
        for _ in 0..200 {
            let mut fleet: Vec<Combined> = (0..5).map(|_| mean(0.51 * normal(&mut generator))).collect();
            fleet[1].value += 5.0;
            let p: Vec<f64> = airframes(&fleet).unwrap().iter().map(|a| a.p_value).collect();
            let told: Vec<usize> = rates(&p).iter().enumerate().filter(|(_, r)| **r <= 0.05).map(|(k, _)| k).collect();
            found += usize::from(told == [1]);
        }
        assert!(found > 150, "{found}");
    }

    #[test]
    fn airframes_that_differ_by_nature_are_no_outliers() {
        let mut generator = Pcg64Mcg::seed_from_u64(7);
        let fleet: Vec<Combined> = (0..30).map(|_| mean(5.0 * normal(&mut generator))).collect();
        let p: Vec<f64> = airframes(&fleet).unwrap().iter().map(|a| a.p_value).collect();
        assert!(rates(&p).iter().all(|rate| *rate > 0.05));
    }

    #[test]
    fn a_flight_apart_is_found_and_does_not_hide_itself() {
        let mut generator = Pcg64Mcg::seed_from_u64(8);
        let budget = [0.0; QUANTITIES];
        let mut course: Vec<Observation> = (0..20)
            .map(|k| Observation { at: f64::from(k), value: normal(&mut generator), random_std: 1.0, budget })
            .collect();
        course[7].value = 9.0;
        assert!(combine(&course).unwrap().dispersion > 1.5);
        let told = flights(&course, &constant(&course)).unwrap();
        let p: Vec<f64> = told.iter().map(|(apart, _)| apart.p_value).collect();
        let found: Vec<usize> =
            rates(&p).iter().enumerate().filter(|(_, rate)| **rate <= 0.01).map(|(k, _)| k).collect();
        assert_eq!(found, [7]);
        // The distance is that from the mean of the others.
        let others: f64 = course.iter().enumerate().filter(|(k, _)| *k != 7).map(|(_, o)| o.value).sum::<f64>() / 19.0;
        assert!((told[7].0.distance - (9.0 - others)).abs() < 1e-9);
    }
}
