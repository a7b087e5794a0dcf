//! Names the machine that is built for as FMI 3.0 does: `x86_64-linux`.

fn main() {
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    let system = match of("CARGO_CFG_TARGET_OS").as_str() {
        "macos" => "darwin".to_owned(),
        other => other.to_owned(),
    };
    println!("cargo::rustc-env=PHUGOID_FMI_PLATFORM={}-{system}", of("CARGO_CFG_TARGET_ARCH"));
    println!("cargo::rerun-if-changed=build.rs");
}
