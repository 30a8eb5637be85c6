//! Gives the program its build id, so that a run need not read the whole program to tell which one made it.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

#[path = "src/build_id.rs"]
mod build_id;

/// What of the surroundings decides about the program besides its sources.
const SETTINGS: [&str; 6] =
    ["TARGET", "PROFILE", "OPT_LEVEL", "DEBUG", "CARGO_ENCODED_RUSTFLAGS", "CARGO_CFG_TARGET_FEATURE"];

fn main() -> std::io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let mut settings: Vec<String> =
        SETTINGS.iter().map(|name| format!("{name}={}", std::env::var(name).unwrap_or_default())).collect();
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    settings.push(String::from_utf8_lossy(&Command::new(compiler).arg("-vV").output()?.stdout).into_owned());
    let files = build_id::files(&root)?;
    let id = build_id::of(&root, &files, &settings)?;
    println!("cargo::rustc-env=SOCRATES_BUILD_ID={id}");
    // A new file changes its folder, a changed one itself.
    for file in &files {
        println!("cargo::rerun-if-changed={}", root.join(file).display());
    }
    let folders: BTreeSet<&Path> = files.iter().filter_map(|file| file.parent()).collect();
    for folder in folders.into_iter().filter(|folder| !folder.as_os_str().is_empty()) {
        println!("cargo::rerun-if-changed={}", root.join(folder).display());
    }
    Ok(())
}
