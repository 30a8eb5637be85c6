//! Small programs around crates of others, built once beside the tests.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use socrates_tests::skip;

/// The program of this name and source around one crate of one version; it is built in the second ring, which takes some
/// minutes the first time.
pub(super) fn reader(name: &str, package: (&str, &str), source: &str) -> Result<PathBuf, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    skip::alone(&folder, || built(&folder, name, package, source))
}

fn built(folder: &Path, name: &str, package: (&str, &str), source: &str) -> Result<PathBuf, String> {
    let (package, version) = package;
    let program = folder.join("target/debug").join(name);
    if program.is_file() {
        return Ok(program);
    }
    if !skip::second_ring() {
        return Err(format!("`{package}` is not here; `./gate --foreign` builds it"));
    }
    let write =
        |path: &Path, text: &str| std::fs::write(path, text).map_err(|why| format!("{}: {why}", path.display()));
    let manifest = format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2021\"\n[dependencies]\n{package} = \"={version}\"\n\
         [profile.dev]\ndebug = 0\n[workspace]\n"
    );
    std::fs::create_dir_all(folder.join("src")).map_err(|why| format!("{}: {why}", folder.display()))?;
    write(&folder.join("Cargo.toml"), &manifest)?;
    write(&folder.join("src/main.rs"), source)?;
    let built = Command::new("cargo")
        .args(["build", "--quiet", "--target-dir", "target"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .map_err(|why| format!("cargo: {why}"))?;
    if built.status.success() { Ok(program) } else { Err(String::from_utf8_lossy(&built.stderr).into_owned()) }
}
