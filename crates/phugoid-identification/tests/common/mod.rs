//! What several tests need: the shared data, or one line saying that it is not there.
#![allow(dead_code)] // each test binary uses its own part

use std::path::PathBuf;

/// A file of the shared data. Without it, says so and gives nothing; where CI runs, that is a failure.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let root = std::env::var_os("PHUGOID_SHARED_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")), PathBuf::from);
    let file = root.join(path);
    if file.exists() {
        return Some(file);
    }
    println!("skipped: {} is not there (set PHUGOID_SHARED_DATA)", file.display());
    assert!(std::env::var_os("CI").is_none(), "{} is not there", file.display());
    None
}

/// A table of plain numbers with one header line.
pub(crate) struct Table {
    pub(crate) headers: Vec<String>,
    pub(crate) rows: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn read(path: &std::path::Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let headers = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let number = |cell: &str| if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
        Self { headers, rows: lines.map(|line| line.split(',').map(number).collect()).collect() }
    }

    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let index = self.headers.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[index]).collect()
    }
}

/// Reproducible normal numbers (a 64-bit linear congruential generator and Box-Muller).
pub(crate) struct Normal {
    state: u64,
}

impl Normal {
    pub(crate) fn new(seed: u64) -> Self {
        let mut this = Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) };
        for _ in 0..8 {
            this.uniform();
        }
        this
    }

    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub(crate) fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
