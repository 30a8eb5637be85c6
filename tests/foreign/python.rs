//! A Python with packages of others, made once in the folder of the tests.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use socrates_tests::skip;

/// The Python in `folder` that has these packages and can run `import`; in the second ring of the gate they are installed.
pub(crate) fn python(folder: &str, packages: &[&str], import: &str) -> Result<PathBuf, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(folder);
    skip::alone(&folder, || installed(&folder, packages, import))
}

fn installed(folder: &Path, packages: &[&str], import: &str) -> Result<PathBuf, String> {
    let python = folder.join("bin/python3");
    let has = || {
        let asked = Command::new(&python).args(["-c", import]).stderr(Stdio::null()).status();
        asked.is_ok_and(|status| status.success())
    };
    if has() {
        return Ok(python);
    }
    if !skip::second_ring() {
        return Err(format!("`{}` is not here; `./gate --foreign` installs it", packages.join(", ")));
    }
    run(Path::new("python3"), &["-m", "venv", &folder.display().to_string()])?;
    run(&python, &[&["-m", "pip", "install", "-q"], packages].concat())?;
    if has() { Ok(python) } else { Err(format!("`{import}` fails with {} installed", packages.join(", "))) }
}

fn run(program: &Path, args: &[&str]) -> Result<(), String> {
    let out = Command::new(program).args(args).stdin(Stdio::null()).output();
    let out = out.map_err(|why| format!("{}: {why}", program.display()))?;
    if out.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&out.stderr).into_owned()) }
}
