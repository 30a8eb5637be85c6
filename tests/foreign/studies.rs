//! Statistics of studies against R (`ordinal`, `psych`, `BradleyTerry2`) and Python (`scipy`, `krippendorff`), by the scripts that a
//! report carries.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use socrates_tests::skip;

use super::python::python;
use crate::life::studies::{STUDY, does};

/// R with the packages that the script needs.
fn r() -> Result<PathBuf, String> {
    let r = skip::program("Rscript").ok_or("there is no `Rscript`; `./gate --foreign` installs r-base-core")?;
    let mut asked = Command::new(&r);
    asked.args(["-e", "library(ordinal); library(psych); library(BradleyTerry2)"]);
    let asked = asked.stdout(Stdio::null()).stderr(Stdio::null()).status();
    let has = asked.is_ok_and(|status| status.success());
    if has { Ok(r) } else { Err("R lacks ordinal, psych or BradleyTerry2 (Debian: r-cran-*)".to_owned()) }
}

/// A report of simulated answers.
fn report(at: &Path) {
    std::fs::write(at.join("study.toml"), STUDY).unwrap();
    does(
        at,
        "simulate",
        &["simulate", "--effects", "0,0.4,0.9", "--careless", "3", "--skipped", "0.03", "--seed", "5"],
    );
    does(at, "read", &["read", "simulated/answers.jsonl"]);
    does(at, "analyze", &["analyze", "tables"]);
}

/// Runs a script of the report, and gives how many figures it compared.
fn compared(program: &Path, script: &str, at: &Path) -> usize {
    let mut run = Command::new(program);
    run.args([script, "results"]).current_dir(at).stdin(Stdio::null());
    let out = run.output().unwrap();
    let told = String::from_utf8_lossy(&out.stdout);
    assert!(out.status.success(), "{told}{}", String::from_utf8_lossy(&out.stderr));
    let last = told.lines().last().unwrap();
    last.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn r_finds_the_same_figures() {
    let Some(r) = skip::installed(r()) else { return };
    let folder = tempfile::tempdir().unwrap();
    report(folder.path());
    let count = compared(&r, "results/analysis.R", folder.path());
    assert!(count >= 100, "{count} figures");
    // A script that finds nothing wrong in wrong figures would be worth nothing.
    let file = folder.path().join("results/results.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    let line = text.lines().find(|line| line.contains("kendall_w")).unwrap();
    let columns: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let from_the_end = columns.len() - columns.iter().position(|column| *column == "value").unwrap();
    // A scenario's name may hold a comma; nothing from the value on does.
    let value = line.rsplitn(from_the_end + 1, ',').nth(from_the_end - 1).unwrap();
    let changed = line.replace(&format!(",{value}"), ",0.9");
    assert_ne!(changed, line);
    std::fs::write(&file, text.replace(line, &changed)).unwrap();
    let mut run = Command::new(&r);
    let out = run.args(["results/analysis.R", "results"]).current_dir(folder.path()).output().unwrap();
    assert!(!out.status.success() && String::from_utf8_lossy(&out.stdout).contains("DIFFERS"));
}

#[test]
fn scipy_and_krippendorff_find_the_same_figures() {
    let packages = ["numpy==2.3.5", "scipy==1.17.1", "krippendorff==0.9.0"];
    let Some(python) = skip::installed(python("study-statistics", &packages, "import scipy, krippendorff")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    report(folder.path());
    assert!(compared(&python, "results/analysis.py", folder.path()) >= 50);
}
