//! A large table as a logger of flight tests writes it, made by formulas: the same for every run and machine.

use std::fmt::Write as _;

/// Columns of the table: the header, and how many decimals its logger writes.
const COLUMNS: [(&str, usize); 20] = [
    ("time_s", 3),
    ("true_airspeed_m_s", 4),
    ("alpha_deg", 5),
    ("beta_deg", 5),
    ("theta_deg", 5),
    ("phi_deg", 5),
    ("psi_deg", 5),
    ("p_deg_s", 5),
    ("q_deg_s", 5),
    ("r_deg_s", 5),
    ("ax_m_s2", 6),
    ("ay_m_s2", 6),
    ("az_m_s2", 6),
    ("elevator_deg", 4),
    ("aileron_deg", 4),
    ("rudder_deg", 4),
    ("throttle", 4),
    ("altitude_m", 2),
    ("static_pressure_pa", 1),
    ("temperature_degC", 2),
];

/// The text of a table of 20 columns and this many rows at 100 Hz: comma, point, line ends of Unix.
pub(crate) fn csv(rows: usize) -> String {
    let mut text = COLUMNS.map(|(header, _)| header).join(",");
    text.push('\n');
    // A linear congruential generator (Knuth, MMIX): noise whose digits do not repeat, as that of real sensors.
    let mut state = 20_101_010_u64;
    let mut noise = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    for row in 0..rows {
        let t = 0.01 * row as f64;
        let (pitching, rolling) = ((0.9 * t).sin(), (0.4 * t).sin());
        let row = [
            t,
            105.0 + 3.0 * (0.05 * t).sin() + 0.05 * noise(),
            4.0 + pitching + 0.02 * noise(),
            0.5 * rolling + 0.02 * noise(),
            5.0 + 1.5 * pitching + 0.02 * noise(),
            8.0 * rolling + 0.02 * noise(),
            120.0 + 20.0 * (0.01 * t).sin() + 0.02 * noise(),
            3.2 * (0.4 * t).cos() + 0.02 * noise(),
            1.35 * (0.9 * t).cos() + 0.02 * noise(),
            0.3 * rolling + 0.02 * noise(),
            0.8 + 0.2 * pitching + 0.01 * noise(),
            0.3 * rolling + 0.01 * noise(),
            -9.8 - 1.5 * pitching + 0.02 * noise(),
            -1.5 + 0.7 * (0.9 * t + 0.6).sin() + 0.01 * noise(),
            0.4 * (0.4 * t + 0.8).sin() + 0.01 * noise(),
            0.2 * rolling + 0.01 * noise(),
            0.45 + 0.05 * (0.02 * t).sin(),
            4300.0 + 40.0 * (0.03 * t).sin() + 0.5 * noise(),
            59_300.0 - 300.0 * (0.03 * t).sin() + 5.0 * noise(),
            -12.5 + 0.1 * noise(),
        ];
        for (column, (value, (_, decimals))) in row.into_iter().zip(COLUMNS).enumerate() {
            let end = if column + 1 == COLUMNS.len() { '\n' } else { ',' };
            // Writing to a text in memory does not fail.
            let _ = write!(text, "{value:.decimals$}{end}");
        }
    }
    text
}

/// The table as a table calculation of central Europe writes it: decimal commas between semicolons.
pub(crate) fn with_decimal_commas(text: &str) -> String {
    text.replace(',', ";").replace('.', ",")
}

/// The table with every cell in quotes.
pub(crate) fn quoted(text: &str) -> String {
    let quote = |line: &str| line.split(',').map(|cell| format!("\"{cell}\"")).collect::<Vec<_>>().join(",") + "\n";
    text.lines().map(quote).collect()
}

/// The table with dates and times of day in place of seconds.
pub(crate) fn with_clock(text: &str) -> String {
    let mut rows = text.lines();
    let mut clock = rows.next().unwrap_or_default().replace("time_s", "time") + "\n";
    for (row, line) in rows.enumerate() {
        let (seconds, hundredths) = (row / 100, row % 100);
        let rest = line.split_once(',').map_or("", |(_, rest)| rest);
        let (hours, minutes, seconds) = (8 + seconds / 3600, seconds / 60 % 60, seconds % 60);
        // Writing to a text in memory does not fail.
        let _ = writeln!(clock, "26.11.2026 {hours:02}:{minutes:02}:{seconds:02}.{hundredths:02},{rest}");
    }
    clock
}

/// The least that a reader has to do, with the standard library: lines, divided at commas, every cell as a number.
#[inline(never)]
pub(crate) fn plain_pass(text: &str) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); COLUMNS.len()];
    for line in text.lines().skip(1) {
        for (cell, values) in line.split(',').zip(&mut columns) {
            values.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    columns
}
