//! Real processes under a watchdog.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time any process of a test may take; a guard against hanging, never a measure.
const WATCHDOG: Duration = Duration::from_secs(540);

/// What a finished process left.
#[derive(Debug, Clone)]
pub struct Finished {
    /// Exit code; -1 for a signal.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Finished {
    /// The object on the last line of standard output.
    #[must_use]
    pub fn json(&self) -> serde_json::Value {
        self.out.lines().last().and_then(|line| serde_json::from_str(line).ok()).unwrap_or_default()
    }
}

/// Starts the program in a folder. Its output goes to files there, so that no pipe can fill up.
///
/// # Errors
/// When the process or its files cannot be made.
pub fn start(program: &str, args: &[&str], folder: &Path, name: &str) -> std::io::Result<Child> {
    start_typed(program, args, folder, name, "", &[])
}

/// The same with lines that a person types, and variables of the environment.
///
/// # Errors
/// As [`start`].
pub fn start_typed(
    program: &str,
    args: &[&str],
    folder: &Path,
    name: &str,
    typed: &str,
    variables: &[(&str, &str)],
) -> std::io::Result<Child> {
    let path = |ending: &str| folder.join(format!("{name}.{ending}"));
    std::fs::write(path("in"), typed)?;
    Command::new(program)
        .args(args)
        .current_dir(folder)
        // A user's own settings must not reach the tests.
        .env_remove("OPENAI_API_KEY")
        .env("SOCRATES_AUTHOR__KIND", "offline")
        .envs(variables.iter().copied())
        .stdin(std::fs::File::open(path("in"))?)
        .stdout(std::fs::File::create(path("out"))?)
        .stderr(std::fs::File::create(path("err"))?)
        .spawn()
}

/// Waits for a started process; ends it when the watchdog barks.
///
/// # Errors
/// When it cannot be waited for, or did not end by itself.
pub fn finish(mut child: Child, folder: &Path, name: &str) -> std::io::Result<Finished> {
    let status = poll(|| child.try_wait().ok().flatten());
    if status.is_none() {
        child.kill()?;
        child.wait()?;
    }
    let text = |ending: &str| -> std::io::Result<String> {
        let mut bytes = Vec::new();
        std::fs::File::open(folder.join(format!("{name}.{ending}")))?.read_to_end(&mut bytes)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    };
    let (out, err) = (text("out")?, text("err")?);
    match status {
        Some(status) => Ok(Finished { code: status.code().unwrap_or(-1), out, err }),
        None => Err(std::io::Error::other(format!("`{name}` did not end by itself\n{out}\n{err}"))),
    }
}

/// Runs the program to its end.
///
/// # Errors
/// As [`start`] and [`finish`].
pub fn run(program: &str, args: &[&str], folder: &Path, name: &str) -> std::io::Result<Finished> {
    finish(start(program, args, folder, name)?, folder, name)
}

/// Asks again and again until there is an answer or the watchdog barks.
pub fn poll<T>(mut ask: impl FnMut() -> Option<T>) -> Option<T> {
    let started = Instant::now();
    let (_keep, never) = std::sync::mpsc::sync_channel::<()>(1);
    while started.elapsed() < WATCHDOG {
        if let Some(answer) = ask() {
            return Some(answer);
        }
        // Nobody ever sends: this gives the processor away for a moment.
        if never.recv_timeout(Duration::from_millis(5)).is_ok() {
            break;
        }
    }
    None
}

/// Processes whose parent is this one: process id and command line.
#[must_use]
pub fn children(parent: u32) -> Vec<(u32, String)> {
    processes().into_iter().filter(|(_, of, _)| *of == parent).map(|(pid, _, line)| (pid, line)).collect()
}

/// Processes whose command line names this path.
#[must_use]
pub fn naming(path: &Path) -> Vec<(u32, String)> {
    let wanted = path.display().to_string();
    processes().into_iter().filter(|(_, _, line)| line.contains(&wanted)).map(|(pid, _, line)| (pid, line)).collect()
}

/// Every process: id, parent, command line.
fn processes() -> Vec<(u32, u32, String)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir("/proc").into_iter().flatten().filter_map(Result::ok) {
        let Ok(pid) = entry.file_name().to_string_lossy().parse::<u32>() else { continue };
        let base = PathBuf::from("/proc").join(pid.to_string());
        let Ok(stat) = std::fs::read_to_string(base.join("stat")) else { continue };
        // The name in brackets may hold blanks, so fields are counted after it.
        let Some((_, rest)) = stat.rsplit_once(") ") else { continue };
        let mut fields = rest.split(' ');
        let state = fields.next().unwrap_or_default().to_owned();
        let parent = fields.next().and_then(|field| field.parse().ok()).unwrap_or(0);
        let line = std::fs::read(base.join("cmdline")).unwrap_or_default();
        let line = String::from_utf8_lossy(&line).replace('\0', " ");
        if state != "Z" {
            found.push((pid, parent, line));
        }
    }
    found.sort_unstable();
    found
}

/// Sends a signal to one process.
///
/// # Errors
/// When there is no `kill` program.
pub fn signal(pid: u32, name: &str) -> std::io::Result<bool> {
    Command::new("kill")
        .arg(format!("-{name}"))
        .arg(pid.to_string())
        .stderr(Stdio::null())
        .status()
        .map(|status| status.success())
}
