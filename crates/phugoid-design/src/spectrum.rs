//! Energy over frequency.

use std::f64::consts::TAU;

/// Energy spectral density `2 |integral u e^(-jwt) dt|^2` of a sampled signal at these frequencies (Hz), unit^2 s/Hz for a
/// signal held between samples `h` (s) apart: its integral over all positive frequencies is the signal's energy.
pub fn spectrum(signal: &[f64], h: f64, frequencies_hz: &[f64]) -> Vec<f64> {
    frequencies_hz
        .iter()
        .map(|f| {
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (k, u) in signal.iter().enumerate() {
                let (s, c) = (TAU * f * h * k as f64).sin_cos();
                cosine += u * c;
                sine += u * s;
            }
            // A value held for h has the spectrum of a pulse.
            let half = std::f64::consts::PI * f * h;
            let hold = if half > 0.0 { half.sin() / half } else { 1.0 };
            2.0 * (h * hold).powi(2) * (cosine * cosine + sine * sine)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::spectrum;

    /// Parseval: the energy of a doublet is its time.
    #[test]
    fn the_spectrum_holds_the_energy() {
        let signal: Vec<f64> = (0..200).map(|k| if k < 100 { 1.0 } else { -1.0 }).collect();
        let df = 0.01;
        let frequencies: Vec<f64> = (0..20_000).map(|k| df * (k as f64 + 0.5)).collect();
        let energy: f64 = spectrum(&signal, 0.01, &frequencies).iter().map(|e| e * df).sum();
        // Beyond 200 Hz a step leaves 2 (2/(2 pi f))^2 each: less than 0.1 %.
        assert!((energy - 2.0).abs() < 2e-3, "{energy}");
    }
}
