//! Probabilities of the normal distribution, of Student's t and of chi squared.

/// Probability that a standard normal number is further from zero than `z`; NaN stays NaN.
///
/// ```
/// use phugoid_fleet::statistics::distribution::normal_two_sided;
/// assert!((normal_two_sided(1.959_963_985) - 0.05).abs() < 1e-9);
/// ```
pub fn normal_two_sided(z: f64) -> f64 {
    libm::erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Probability that a number with Student's t distribution of these degrees of freedom is further from zero than `t`; one
/// where there are no degrees of freedom, since nothing is then known of the scatter. NaN stays NaN.
///
/// ```
/// use phugoid_fleet::statistics::distribution::student_two_sided;
/// // Tables: 2.228 for 10 degrees of freedom and 5 %.
/// assert!((student_two_sided(2.228_138_852, 10.0) - 0.05).abs() < 1e-8);
/// ```
pub fn student_two_sided(t: f64, freedom: f64) -> f64 {
    match freedom > 0.0 {
        true => incomplete_beta(freedom / (freedom + t * t), 0.5 * freedom, 0.5),
        false => 1.0,
    }
}

/// Probability that chi squared of these degrees of freedom is larger than `chi_squared`; one where there are none, or where it is
/// not positive; zero where it is infinite. NaN stays NaN.
///
/// ```
/// use phugoid_fleet::statistics::distribution::chi_squared_above;
/// // Tables: 18.307 for 10 degrees of freedom and 5 %, 6.635 for one and 1 %.
/// assert!((chi_squared_above(18.307_038, 10.0) - 0.05).abs() < 1e-7);
/// assert!((chi_squared_above(6.634_897, 1.0) - 0.01).abs() < 1e-7);
/// assert_eq!(chi_squared_above(f64::INFINITY, 1.0), 0.0);
/// ```
pub fn chi_squared_above(chi_squared: f64, freedom: f64) -> f64 {
    if chi_squared.is_nan() {
        return f64::NAN;
    }
    if freedom <= 0.0 || chi_squared <= 0.0 {
        return 1.0;
    }
    if chi_squared.is_infinite() {
        return 0.0;
    }
    let (a, x) = (0.5 * freedom, 0.5 * chi_squared);
    let front = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    match x < a + 1.0 {
        true => 1.0 - front * gamma_series(a, x),
        false => front * gamma_fraction(a, x),
    }
}

/// Lower incomplete gamma function without its front, by its series, and the upper one by its continued fraction (W. H. Press et
/// al., *Numerical Recipes*, section 6.2).
fn gamma_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for step in 1..1000 {
        term *= x / (a + f64::from(step));
        sum += term;
        if term < sum * 1e-16 {
            break;
        }
    }
    sum
}

fn gamma_fraction(a: f64, x: f64) -> f64 {
    const LEAST: f64 = 1e-300;
    let away = |value: f64| if value.abs() < LEAST { LEAST } else { value };
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1.0 / LEAST, 1.0 / away(b));
    let mut result = d;
    for step in 1..1000 {
        let m = f64::from(step);
        let factor = m * (a - m);
        b += 2.0;
        d = 1.0 / away(factor * d + b);
        c = away(b + factor / c);
        result *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    result
}

/// Regularised incomplete beta function, by its continued fraction (W. H. Press et al., *Numerical Recipes*, section 6.4).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x.is_nan() {
        return f64::NAN;
    }
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    let front =
        libm::exp(libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log1p(-x));
    match x < (a + 1.0) / (a + b + 2.0) {
        true => front * fraction(x, a, b) / a,
        false => 1.0 - front * fraction(1.0 - x, b, a) / b,
    }
}

fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const LEAST: f64 = 1e-300;
    let away = |value: f64| if value.abs() < LEAST { LEAST } else { value };
    let (mut c, mut d) = (1.0, 1.0 / away(1.0 - (a + b) * x / (a + 1.0)));
    let mut result = d;
    for step in 1..1000 {
        let m = f64::from(step);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut last = 1.0;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            last = c * d;
            result *= last;
        }
        if (last - 1.0).abs() < 1e-15 {
            break;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_tables() {
        for (t, freedom, expected) in
            [(12.706_204_736, 1.0, 0.05), (4.032_142_984, 5.0, 0.01), (1.0, 1.0, 0.5), (0.0, 7.0, 1.0)]
        {
            let found = student_two_sided(t, freedom);
            assert!((found - expected).abs() < 1e-8, "{t} {freedom}: {found}");
        }
        // With many degrees of freedom it is the normal distribution.
        for z in [0.5, 2.0, 5.0] {
            let (t, n) = (student_two_sided(z, 1e7), normal_two_sided(z));
            assert!((t / n - 1.0).abs() < 1e-4, "{t} {n}");
        }
        assert!(student_two_sided(f64::NAN, 3.0).is_nan() && normal_two_sided(f64::NAN).is_nan());
        assert_eq!(student_two_sided(9.0, 0.0), 1.0);
        assert_eq!(student_two_sided(f64::INFINITY, 3.0), 0.0);
    }
}
