//! How many aircraft of the package can be read, and why the others not.

use phugoid_aircraft::jsbsim::Aircraft;

use super::{is_reserved, package};

#[test]
fn most_aircraft_of_the_package_load() {
    let Some(package) = package() else { return };
    let mut folders: Vec<_> =
        std::fs::read_dir(package.join("aircraft")).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.sort();
    let (mut loaded, mut refused) = (0, Vec::new());
    for folder in folders.iter().filter(|folder| folder.is_dir()) {
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        if is_reserved(&name) {
            continue;
        }
        match Aircraft::open(folder) {
            Ok(aircraft) => {
                loaded += 1;
                let mass = aircraft.mass_properties();
                eprintln!(
                    "{name}: \"{}\", {:.0} kg, {} components, {} left out",
                    aircraft.name(),
                    mass.mass_kg,
                    aircraft.components(),
                    aircraft.omitted().len()
                );
                if std::env::var_os("PHUGOID_JSBSIM_NOTES").is_some() {
                    for note in aircraft.omitted() {
                        eprintln!("    {note}");
                    }
                    let inputs: Vec<_> =
                        aircraft.inputs().iter().map(|&index| aircraft.properties().nth(index).unwrap()).collect();
                    eprintln!("    from outside: {}", inputs.join(" "));
                }
            }
            Err(error) => {
                let message = error.to_string();
                assert!(message.contains("line "), "{message}");
                refused.push(message);
            }
        }
    }
    eprintln!("{loaded} load, {} are refused:\n{}", refused.len(), refused.join("\n"));
    assert!(loaded >= 45, "only {loaded} aircraft load");
}
