//! Whether the sensors agree with one another, whatever the aerodynamics.
//!
//! Kinematics ties the angle of attack to the rate gyro and the accelerometers:
//!
//! ```text
//! alpha' = q + (az cos alpha - ax sin alpha + g cos(theta - alpha))/V
//! ```
//!
//! Over windows of two seconds, from which an offset and a drift of each side are taken out (biases), the measured alpha
//! is fitted by the integral of the rate `q`, by the integral of the rest, and by its own rate: the factors are one if
//! the scales agree, and the last one is minus the delay of the vane. The mean of the accelerations along the vertical
//! has to agree with the change of the vertical speed. (R. V. Jategaonkar, *Flight Vehicle System Identification*, ch.
//! 10, on data compatibility; here as a test of single sensors, by linear regression, and not as their calibration,
//! which `phugoid compatibility` is for.)

use nalgebra::{Matrix3, Vector3};
use phugoid_flight_data::statistics::{median, median_step};

use crate::core::axes::Axes;
use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::core::output::Output;

/// Length of a window, s: an offset and a drift over it hold biases, and a short-period motion is neither.
const WINDOW_S: f64 = 2.0;
/// Standard errors from which a departure counts. The errors are those between windows, which turbulence and model
/// error widen too.
const SIGNIFICANT: f64 = 5.0;
/// Smallest departure of a scale that is reported: calibrations are rarely better.
const SCALE: f64 = 0.04;
/// Smallest delay that is reported, samples.
const DELAY_SAMPLES: f64 = 1.0;
/// Smallest mean acceleration that is reported, m/s^2: biases of 10 mg are usual.
const ACCELERATION: f64 = 0.25;
/// Share of the motion of alpha that may be left unexplained: more of it is gusts, which the aircraft follows, so that
/// the factors are no longer those of the sensors.
const GUSTS: f64 = 0.1;
/// Windows that a scale has to rest on.
const LEAST_WINDOWS: usize = 5;

/// The longitudinal measurements of a flight, by sample.
struct Channels {
    time_s: Vec<f64>,
    alpha: Vec<f64>,
    theta: Vec<f64>,
    q: Vec<f64>,
    ax: Vec<f64>,
    az: Vec<f64>,
    speed: Vec<f64>,
}

impl Channels {
    /// The samples that hold them all. Single values that stand out of both neighbours are taken for outliers and left
    /// out with their sample.
    fn of<const R: usize>(axes: Axes, time: &[f64], outputs: &[[f64; R]]) -> Option<Self> {
        let rows = [Output::Alpha, Output::Theta, Output::PitchRate, Output::Ax, Output::Az, Output::TrueAirspeed]
            .map(|output| axes.row(output));
        let [Some(alpha), Some(theta), Some(q), Some(ax), Some(az), Some(speed)] = rows else { return None };
        let columns = [alpha, theta, q, ax, az, speed];
        let limits = columns.map(|row| {
            let mut steps: Vec<f64> =
                outputs.windows(2).map(|pair| (pair[1][row] - pair[0][row]).abs()).filter(|d| d.is_finite()).collect();
            8.0 * median(&mut steps).unwrap_or(0.0)
        });
        let stands_out = |k: usize| {
            columns.iter().zip(limits).any(|(row, limit)| {
                let near = |other: usize| outputs.get(other).map_or(f64::NAN, |y| outputs[k][*row] - y[*row]);
                let (before, after) = (near(k.wrapping_sub(1)), near(k + 1));
                limit > 0.0 && before.abs() > limit && after.abs() > limit && before * after > 0.0
            })
        };
        let kept: Vec<usize> = (0..outputs.len())
            .filter(|k| columns.iter().all(|row| outputs[*k][*row].is_finite()) && !stands_out(*k))
            .collect();
        let column = |row: usize| kept.iter().map(|k| outputs[*k][row]).collect::<Vec<f64>>();
        Some(Self {
            time_s: kept.iter().map(|k| time[*k]).collect(),
            alpha: column(alpha),
            theta: column(theta),
            q: column(q),
            ax: column(ax),
            az: column(az),
            speed: column(speed),
        })
    }

    /// The part of the rate of alpha that the accelerometers and gravity make, rad/s.
    fn path_rate(&self, k: usize, gravity: f64) -> f64 {
        let (sine, cosine) = self.alpha[k].sin_cos();
        (self.az[k] * cosine - self.ax[k] * sine + gravity * (self.theta[k] - self.alpha[k]).cos()) / self.speed[k]
    }
}

/// Factors on the integral of the pitch rate and on that of the rest, and the delay of alpha (s), with standard errors.
struct Factors {
    value: Vector3<f64>,
    std: Vector3<f64>,
}

/// Takes a straight line out of values over the times.
fn without_line(time: &[f64], values: &mut [f64]) {
    let n = values.len() as f64;
    let mean_t = time.iter().sum::<f64>() / n;
    let mean = values.iter().sum::<f64>() / n;
    let (mut tt, mut tv) = (0.0, 0.0);
    for (t, v) in time.iter().zip(values.iter()) {
        tt += (t - mean_t).powi(2);
        tv += (t - mean_t) * (v - mean);
    }
    let slope = if tt > 0.0 { tv / tt } else { 0.0 };
    for (t, v) in time.iter().zip(values.iter_mut()) {
        *v -= mean + slope * (t - mean_t);
    }
}

fn factors(channels: &Channels, gravity: f64) -> Option<Factors> {
    let time = &channels.time_s;
    let step = median_step(time)?;
    let mut windows: Vec<(Matrix3<f64>, Vector3<f64>)> = Vec::new();
    let mut motion = 0.0;
    let mut begin = 0;
    while begin < time.len() {
        let mut end = begin + 1;
        while end < time.len() && time[end] - time[begin] < WINDOW_S && time[end] - time[end - 1] < 3.5 * step {
            end += 1;
        }
        let length = end - begin;
        if length >= 10 && time[end - 1] - time[begin] > 0.7 * WINDOW_S {
            let t = &time[begin..end];
            let rate: Vec<f64> = (begin..end).map(|k| channels.path_rate(k, gravity)).collect();
            let integral = |values: &[f64]| -> Vec<f64> {
                let mut sum = 0.0;
                let mut out = vec![0.0];
                for k in 1..values.len() {
                    sum += 0.5 * (values[k] + values[k - 1]) * (t[k] - t[k - 1]);
                    out.push(sum);
                }
                out
            };
            let q = &channels.q[begin..end];
            let mut columns = [integral(q), integral(&rate), q.iter().zip(&rate).map(|(q, r)| -(q + r)).collect()];
            let mut alpha = channels.alpha[begin..end].to_vec();
            columns.iter_mut().for_each(|column| without_line(t, column));
            without_line(t, &mut alpha);
            let mut normal = Matrix3::zeros();
            let mut right = Vector3::zeros();
            for k in 0..length {
                let row = Vector3::new(columns[0][k], columns[1][k], columns[2][k]);
                normal += row * row.transpose();
                right += row * alpha[k];
                motion += alpha[k] * alpha[k];
            }
            windows.push((normal, right));
        }
        begin = end;
    }
    let all = |skip: Option<usize>| -> Option<Vector3<f64>> {
        let kept = windows.iter().enumerate().filter(|(i, _)| Some(*i) != skip).map(|(_, window)| window);
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (n, r) in kept {
            normal += n;
            right += r;
        }
        Some(normal.cholesky()?.solve(&right))
    };
    if windows.len() < LEAST_WINDOWS {
        return None;
    }
    let value = all(None)?;
    let explained: f64 = windows.iter().map(|(n, r)| 2.0 * value.dot(r) - value.dot(&(n * value))).sum();
    if motion - explained > GUSTS * motion {
        return None;
    }
    // Jackknife over the windows: what rests on one of them alone has a large error.
    let n = windows.len() as f64;
    let mut sum = Vector3::zeros();
    for i in 0..windows.len() {
        let difference = all(Some(i))? - value;
        sum += difference.component_mul(&difference);
    }
    Some(Factors { value, std: (sum * ((n - 1.0) / n)).map(f64::sqrt) })
}

/// Mean acceleration along the vertical that the accelerometers claim beyond what the change of the vertical speed
/// shows, m/s^2 up, and one sigma of it.
fn vertical_excess(channels: &Channels, gravity: f64) -> Option<(f64, f64)> {
    let n = channels.time_s.len();
    if n < 20 {
        return None;
    }
    let duration = channels.time_s[n - 1] - channels.time_s[0];
    let claimed: f64 = (1..n)
        .map(|k| {
            let up = |k: usize| {
                channels.ax[k] * channels.theta[k].sin() - channels.az[k] * channels.theta[k].cos() - gravity
            };
            0.5 * (up(k) + up(k - 1)) * (channels.time_s[k] - channels.time_s[k - 1])
        })
        .sum();
    let climb = |range: std::ops::Range<usize>| {
        let mut values: Vec<f64> =
            range.map(|k| channels.speed[k] * (channels.theta[k] - channels.alpha[k]).sin()).collect();
        median(&mut values)
    };
    let ends = 10.min(n / 2);
    let shown = climb(n - ends..n)? - climb(0..ends)?;
    // Vertical gusts and the noise of the flow angle at both ends.
    let mut climbs: Vec<f64> =
        (0..n).map(|k| channels.speed[k] * (channels.theta[k] - channels.alpha[k]).sin()).collect();
    let middle = median(&mut climbs)?;
    let mut sizes: Vec<f64> = climbs.iter().map(|c| (c - middle).abs()).collect();
    let spread = 1.4826 * median(&mut sizes)?;
    Some(((claimed - shown) / duration, spread.max(0.5) / duration))
}

/// Names the sensors that disagree. `time` (s) and `outputs` (SI, rows of the axes) are the measurements used;
/// `gravity` in m/s^2.
pub(super) fn reason<const R: usize>(
    axes: Axes,
    time: &[f64],
    outputs: &[[f64; R]],
    gravity: f64,
) -> Option<VerdictReason> {
    if axes != Axes::Longitudinal {
        // With a bank angle the equations have further terms.
        return None;
    }
    let channels = Channels::of(axes, time, outputs)?;
    let step = median_step(&channels.time_s)?;
    let mut found: Vec<(&str, String)> = Vec::new();
    if let Some(Factors { value, std }) = factors(&channels, gravity) {
        let off = |i: usize| (value[i] - 1.0).abs() > (SIGNIFICANT * std[i]).max(SCALE);
        let text = |i: usize| format!("{:.3} ± {:.3}", value[i], 2.0 * std[i]);
        if off(0) || off(1) {
            let (name, what) = if off(0) && off(1) && (value[0] - value[1]).abs() < 0.5 * (value[0] - 1.0).abs() {
                ("alpha", "scale of alpha (vane, upwash, unit)")
            } else if off(0) {
                ("q", "scale of q, or of alpha")
            } else {
                ("az", "scale of az, or of the airspeed")
            };
            found.push((
                name,
                format!(
                    "alpha follows what the pitch rate makes of it by a factor of {}, and what az makes of it by a factor \
                     of {} (two sigma), where both are one: check the {what}",
                    text(0),
                    text(1)
                ),
            ));
        }
        if value[2].abs() > (SIGNIFICANT * std[2]).max(DELAY_SAMPLES * step) {
            let late = if value[2] > 0.0 { "late" } else { "early" };
            found.push((
                "alpha",
                format!(
                    "alpha comes {:.0} ± {:.0} ms {late} against the gyro and the accelerometers: check its delay and \
                     filter",
                    1e3 * value[2].abs(),
                    2e3 * std[2]
                ),
            ));
        }
    }
    if let Some((excess, std)) = vertical_excess(&channels, gravity)
        && excess.abs() > (SIGNIFICANT * std).max(ACCELERATION)
    {
        found.push((
            "az",
            format!(
                "the accelerometers claim a mean vertical acceleration of {excess:+.2} m/s^2 that the flight path does \
                 not show: check scale, bias and mounting of az"
            ),
        ));
    }
    if found.is_empty() {
        return None;
    }
    let mut concerns: Vec<String> = found.iter().map(|(name, _)| (*name).to_owned()).collect();
    concerns.dedup();
    let sentences: Vec<String> = found.into_iter().map(|(_, sentence)| sentence).collect();
    Some(VerdictReason {
        code: ReasonCode::SensorError,
        status: EstimationStatus::Doubtful,
        concerns,
        sentence: format!(
            "The sensors disagree with one another: {}. `phugoid compatibility` estimates such errors, and --correct \
             takes them out.",
            sentences.join("; ")
        ),
    })
}
