//! Integration tests: one program, see docs/architecture.md.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod flight;
mod resources;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A folder of a test, gone at its end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("phugoid-fmu-test-{}-{number}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// A folder with this description.
    fn with(text: &str) -> Self {
        let folder = Self::new();
        std::fs::write(folder.0.join(phugoid_fmu::FILE), text).unwrap();
        folder
    }

    fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The description of the F-16 of a scenario at its trim.
fn description(trim: &phugoid_flight_dynamics::trim::Trim, cg: f64) -> String {
    let (s, c) = (trim.state(), trim.controls());
    format!(
        "format = 1\ninstantiation_token = \"{{token}}\"\n[aircraft]\ntype = \"f16\"\ncg = {cg:?}\n\
         [state]\nspeed = {:?}\nalpha = {:?}\nbeta = {:?}\nphi = {:?}\ntheta = {:?}\npsi = {:?}\np = {:?}\nq = {:?}\nr = {:?}\n\
         north = {:?}\neast = {:?}\naltitude = {:?}\npower = {:?}\n\
         [controls]\nthrottle = {:?}\nelevator = {:?}\naileron = {:?}\nrudder = {:?}\n",
        s.speed,
        s.alpha,
        s.beta,
        s.phi,
        s.theta,
        s.psi,
        s.p,
        s.q,
        s.r,
        s.north,
        s.east,
        s.altitude,
        s.power,
        c.throttle,
        c.elevator,
        c.aileron,
        c.rudder
    )
}
