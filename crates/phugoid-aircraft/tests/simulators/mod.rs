//! Trajectories that NASA's simulators wrote for the check cases.

use std::io::Read;
use std::path::Path;

use phugoid_aircraft::check_case::compare::Recorded;

/// Those of one case, from the folder `trajectories` beside `cases.json`, in the order of the simulators' numbers.
pub(crate) fn simulators(folder: &Path, id: &str) -> Vec<Recorded> {
    let mut files: Vec<_> = std::fs::read_dir(folder.join("trajectories"))
        .expect("a folder `trajectories`")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.to_string_lossy().contains(&format!("Atmos_{id}_sim_")))
        .collect();
    files.sort();
    let read = |path: &std::path::PathBuf| {
        let mut text = String::new();
        let file = std::fs::File::open(path).expect("a readable file");
        flate2::read::GzDecoder::new(file).read_to_string(&mut text).expect("compressed text");
        let name = path.to_string_lossy();
        let name = name.rsplit("sim_").next().unwrap_or_default().trim_end_matches(".csv.gz");
        Recorded::parse(name, &text).expect("a trajectory")
    };
    files.iter().map(read).collect()
}
