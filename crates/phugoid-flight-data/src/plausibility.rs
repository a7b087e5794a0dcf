//! Units and signs that do not fit together: said, never changed.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::quality::{QualityReport, Short};
use crate::record::{Quantity, Record};

/// Warns of values that are hardly in the unit they claim, and of channels that contradict one another.
pub(crate) fn check(record: &mut Record) {
    let mut report = std::mem::take(&mut record.quality);
    magnitudes(record, &mut report);
    attitude_and_rate(record, "theta", "q", &mut report);
    attitude_and_rate(record, "phi", "p", &mut report);
    vertical_force(record, &mut report);
    pressure_and_speed(record, &mut report);
    record.quality = report;
}

fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|value| !value.is_nan()).fold(0.0, |largest, value| value.abs().max(largest))
}

/// A quantile of the sizes, so that single wild values do not raise an alarm about units.
fn typical_peak(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().filter(|value| !value.is_nan()).map(|value| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let index = (sizes.len() as f64 * 0.95) as usize;
    sizes.get(index.min(sizes.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

fn median(values: &[f64]) -> Option<f64> {
    let mut present: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    present.sort_by(f64::total_cmp);
    present.get(present.len() / 2).copied()
}

fn magnitudes(record: &Record, report: &mut QualityReport) {
    for channel in &record.channels {
        // Beyond these, the 95 % quantile of the sizes is hardly in SI.
        let bound = match (channel.name.as_str(), channel.quantity) {
            ("phi" | "longitude", Quantity::Angle) => 1.02 * PI,
            ("psi", Quantity::Angle) => 2.04 * PI,
            (name, Quantity::Angle) if crate::channels::by_name(name).is_some() => 1.02 * FRAC_PI_2,
            ("p" | "q" | "r", _) => 8.0,
            _ => continue,
        };
        let peak = typical_peak(&channel.values);
        if peak > bound {
            report.warn(
                &channel.name,
                format!(
                    "reaches {} {}, which is {} deg{}: probably degrees taken for radians. If so, write _deg into the \
                     header, or map the column with its unit",
                    Short(peak),
                    channel.quantity.si_unit(),
                    Short(peak.to_degrees()),
                    if channel.quantity == Quantity::Angle { "" } else { "/s" }
                ),
            );
        }
    }
    let in_degrees = report.channels.iter().any(|entry| entry.name == "alpha" && entry.unit == "deg");
    if let Some(alpha) = record.channel("alpha").filter(|_| in_degrees) {
        let peak = typical_peak(&alpha.values).to_degrees();
        if peak > 0.0 && peak < 0.35 {
            report.note(
                "alpha",
                format!(
                    "stays below {} deg: a deviation from trim, or radians taken for degrees. If so, write alpha_rad",
                    Short(peak)
                ),
            );
        }
    }
    if let Some(throttle) = record.channel("throttle")
        && typical_peak(&throttle.values) > 1.5
    {
        report.warn(
            "throttle",
            format!(
                "reaches {}; 0 to 1 is expected. If it is percent, write throttle_pct",
                Short(largest(&throttle.values))
            ),
        );
    }
}

/// Near wings-level flight the attitude changes by the integral of its rate; a ratio of 57 or a turned sign shows.
fn attitude_and_rate(record: &Record, attitude: &str, rate: &str, report: &mut QualityReport) {
    let (Some(angle), Some(rate_channel)) = (record.channel(attitude), record.channel(rate)) else { return };
    let bank = record.channel("phi").map(|phi| phi.values.as_slice());
    let span = record.time.last().zip(record.time.first()).map_or(0.0, |(last, first)| last - first);
    // Differences over a fifth of a second at least: shorter ones are noise.
    let stride = record
        .time
        .iter()
        .position(|time| time - record.time.first().copied().unwrap_or_default() >= 0.2)
        .unwrap_or(record.time.len());
    if span < 1.0 || stride >= record.time.len() {
        return;
    }
    let (mut xx, mut xy, mut yy, mut count) = (0.0, 0.0, 0.0, 0_usize);
    let mut start = 0;
    while start + stride < record.time.len() {
        let end = start + stride;
        let mut integral = 0.0;
        for row in start..end {
            let step = record.time[row + 1] - record.time[row];
            integral += 0.5 * step * (rate_channel.values[row] + rate_channel.values[row + 1]);
        }
        let change = angle.values[end] - angle.values[start];
        let level = bank.is_none_or(|phi| phi[start].abs() < 0.35 && phi[end].abs() < 0.35);
        let (x, y) = (integral, change);
        if x.is_finite() && y.is_finite() && y.abs() < 100.0 && level {
            xx += x * x;
            xy += x * y;
            yy += y * y;
            count += 1;
        }
        start = end;
    }
    if count < 5 || xx == 0.0 || yy == 0.0 {
        return;
    }
    let (slope, correlation) = (xy / xx, xy / (xx * yy).sqrt());
    if correlation.abs() < 0.8 {
        return;
    }
    let size = slope.abs() * PI / 180.0;
    if (0.5..2.0).contains(&size) {
        report.warn(
            format!("{attitude} and {rate}"),
            format!(
                "{attitude} changes {} times as fast as {rate} says: {attitude} is probably in degrees and taken for \
                 radians, or {rate} is in rad/s and taken for deg/s. Correct the unit in the header",
                Short(slope.abs())
            ),
        );
    } else if (0.5..2.0).contains(&(slope.abs() * 180.0 / PI)) {
        report.warn(
            format!("{attitude} and {rate}"),
            format!(
                "{attitude} changes {} times as fast as {rate} says: {rate} is probably in deg/s and taken for rad/s, or \
                 {attitude} is in radians and taken for degrees. Correct the unit in the header",
                Short(slope.abs())
            ),
        );
    } else if slope < 0.0 && (0.5..2.0).contains(&slope.abs()) {
        report.warn(
            format!("{attitude} and {rate}"),
            format!("{attitude} falls where {rate} is positive: one of them has the wrong sign; map it with scale -1"),
        );
    }
}

/// In level flight an accelerometer along body z, down, shows about -9.8 m/s2; a load factor +1.
fn vertical_force(record: &Record, report: &mut QualityReport) {
    if let Some(az) = record.channel("az").and_then(|az| median(&az.values)) {
        if (5.0..20.0).contains(&az) {
            report.warn(
                "az",
                format!(
                    "is {} m/s2 in the middle: az is positive down and about -9.8 m/s2 in level flight. If the column is \
                     positive up, map it with scale -1",
                    Short(az)
                ),
            );
        } else if (0.6..2.0).contains(&az.abs()) {
            report.warn("az", format!("is {} m/s2 in the middle: probably in g. If so, write az_g", Short(az)));
        } else if (-90.0..-25.0).contains(&az) {
            report.warn("az", format!("is {} m/s2 in the middle: probably in ft/s2. If so, write az_ft_s2", Short(az)));
        } else if az.abs() < 0.3 {
            report.note(
                "az",
                format!(
                    "is about zero in the middle ({} m/s2): a deviation from trim, or gravity was taken out. The specific \
                     force of an accelerometer is about -9.8 m/s2 in level flight",
                    Short(az)
                ),
            );
        }
    }
    if let Some(nz) = record.channel("nz").and_then(|nz| median(&nz.values)) {
        if (-2.0..-0.5).contains(&nz) {
            report.warn(
                "nz",
                format!("is {} in the middle: nz is positive up, +1 in level flight; map it with scale -1", Short(nz)),
            );
        } else if nz.abs() > 5.0 {
            report.warn("nz", format!("is {} in the middle: probably m/s2 or ft/s2, not g", Short(nz)));
        }
    }
}

/// Dynamic pressure and airspeed must imply a density that the atmosphere has (below 20 km: 0.08 to 1.5 kg/m3).
fn pressure_and_speed(record: &Record, report: &mut QualityReport) {
    let (Some(pressure), Some(speed)) = (record.channel("dynamic_pressure"), record.channel("true_airspeed")) else {
        return;
    };
    let implied: Vec<f64> = pressure.values.iter().zip(&speed.values).map(|(q, v)| 2.0 * q / (v * v)).collect();
    if let Some(density) = median(&implied)
        && density.is_finite()
        && !(0.08..1.5).contains(&density)
    {
        report.warn(
            "dynamic_pressure and true_airspeed",
            format!(
                "imply an air density of {} kg/m3, outside 0.08 to 1.5: one of the two is probably in another unit than \
                 its header says",
                Short(density)
            ),
        );
    }
}
