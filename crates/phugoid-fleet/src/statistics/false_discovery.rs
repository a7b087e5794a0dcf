//! Many questions at once: how many of the findings may be false.

/// For each p-value the smallest false-discovery rate at which it still counts as a finding (Y. Benjamini, Y. Hochberg,
/// *Journal of the Royal Statistical Society B* 57, 1995), in the order of the p-values.
///
/// Whoever takes everything up to a rate of 0.05 for a finding has to expect one false finding in twenty findings, however
/// many questions were asked. NaN, a question without an answer, counts for nothing and stays NaN.
///
/// ```
/// use phugoid_fleet::statistics::false_discovery::rates;
/// assert_eq!(rates(&[0.01, 0.5, 0.02]), [0.03, 0.5, 0.03]);
/// ```
pub fn rates(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).filter(|k| !p_values[*k].is_nan()).collect();
    order.sort_by(|a, b| p_values[*a].total_cmp(&p_values[*b]));
    let (all, mut least) = (order.len() as f64, 1.0_f64);
    let mut rates = vec![f64::NAN; p_values.len()];
    for (place, index) in order.into_iter().enumerate().rev() {
        least = least.min(p_values[index] * all / (place + 1) as f64);
        rates[index] = least;
    }
    rates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_paper() {
        // Benjamini and Hochberg 1995, section 4: four rejections of fifteen at 0.05.
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719, 0.6528,
            0.7590, 1.0,
        ];
        assert_eq!(rates(&p).iter().filter(|rate| **rate <= 0.05).count(), 4);
        let with_gap = rates(&[f64::NAN, 0.01]);
        assert!(with_gap[0].is_nan() && with_gap[1] == 0.01 && rates(&[]).is_empty());
    }
}
