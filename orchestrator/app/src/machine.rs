//! What a figure was measured with: build, processor, load; and what processes use, as the kernel counts it.

use std::collections::{BTreeMap, BTreeSet};

/// The lines before every table of figures.
#[must_use]
pub fn told(build: &str) -> Vec<String> {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let info = read("/proc/cpuinfo");
    let value =
        |name: &str| info.lines().find_map(|line| line.strip_prefix(name)?.split_once(": ").map(|(_, text)| text));
    let seen: BTreeSet<&str> = value("flags").unwrap_or_default().split_whitespace().collect();
    let wide: Vec<&str> = ["sse4_2", "avx2", "avx512f"].into_iter().filter(|name| seen.contains(name)).collect();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let load = read("/proc/loadavg").split_whitespace().next().unwrap_or("unknown").to_owned();
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    vec![
        format!("build      {} {} · {profile}", env!("CARGO_PKG_VERSION"), build),
        format!(
            "machine    {} · {cores} cores · {} · load {load} before",
            value("model name").unwrap_or(std::env::consts::ARCH),
            wide.join(" ")
        ),
    ]
}

/// What one process has used so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Used {
    /// Its name: what it was started as.
    pub name: String,
    /// Processor time of its own, s.
    pub cpu_s: f64,
    /// Largest resident memory, MB.
    pub peak_mb: f64,
}

/// What a process and the processes that it started use, by id; empty where the system does not tell.
#[must_use]
pub fn family(of: u32) -> BTreeMap<u32, Used> {
    let mut parents: BTreeMap<u32, Stat> = BTreeMap::new();
    for entry in std::fs::read_dir("/proc").into_iter().flatten().filter_map(Result::ok) {
        let Some(id) = entry.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
        parents.extend(stat(id).map(|stat| (id, stat)));
    }
    let mut family = BTreeSet::from([of]);
    // Children are found in as many rounds as there are generations.
    while {
        let before = family.len();
        family.extend(
            parents.iter().filter(|(_, stat)| family.contains(&stat.parent)).map(|(id, _)| *id).collect::<Vec<_>>(),
        );
        family.len() > before
    } {}
    let used = |id: u32| {
        let stat = parents.get(&id)?;
        Some((id, Used { name: name(id), cpu_s: stat.cpu_s, peak_mb: peak_mb(id) }))
    };
    family.into_iter().filter_map(used).collect()
}

/// Processor time of a process so far, s; not a number where the system does not tell.
#[must_use]
pub fn cpu_s(id: u32) -> f64 {
    stat(id).map_or(f64::NAN, |stat| stat.cpu_s)
}

/// Memory of a process that is in use now, MB; not a number where the system does not tell.
#[must_use]
pub fn resident_mb(id: u32) -> f64 {
    memory_mb(id, "VmRSS:")
}

/// Processor time of all children of this process that have ended, s.
#[must_use]
pub fn ended_children_s() -> f64 {
    stat(std::process::id()).map_or(f64::NAN, |stat| stat.children_s)
}

struct Stat {
    parent: u32,
    cpu_s: f64,
    children_s: f64,
}

/// Fields 4 and 14 to 17 of `/proc/PID/stat` (proc(5)): parent, user and system time of it and of its children.
fn stat(id: u32) -> Option<Stat> {
    let text = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The name before may hold anything but ends with the last bracket.
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    #[expect(clippy::cast_precision_loss, reason = "ticks of a process are far below 2^52")]
    let seconds = |place: usize| Some(fields.get(place)?.parse::<u64>().ok()? as f64 / ticks_per_s());
    Some(Stat {
        parent: fields.get(1)?.parse().ok()?,
        cpu_s: seconds(11)? + seconds(12)?,
        children_s: seconds(13)? + seconds(14)?,
    })
}

#[expect(clippy::cast_precision_loss, reason = "a few hundred")]
fn ticks_per_s() -> f64 {
    rustix::param::clock_ticks_per_second() as f64
}

/// The words after the program's name, without those of paths: `worker simulation`.
fn name(id: u32) -> String {
    let line = std::fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
    let words: Vec<String> =
        line.split(|byte| *byte == 0).map(|word| String::from_utf8_lossy(word).into_owned()).collect();
    let told = words.iter().skip(1).take_while(|word| !word.starts_with('-') && !word.contains('/')).take(2);
    told.cloned().collect::<Vec<_>>().join(" ").trim().to_owned()
}

fn peak_mb(id: u32) -> f64 {
    memory_mb(id, "VmHWM:")
}

/// A line of `/proc/PID/status` (proc(5)).
fn memory_mb(id: u32, which: &str) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix(which));
    let kb = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kb.map_or(f64::NAN, |kb| kb / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_and_its_child_are_counted() {
        let mut child = std::process::Command::new("sh")
            .args(["-c", "read line"])
            .stdin(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let family = family(std::process::id());
        let own = family.get(&std::process::id()).unwrap();
        assert!(own.peak_mb > 1.0 && own.cpu_s >= 0.0);
        assert!(family.contains_key(&child.id()), "{family:?}");
        drop(child.stdin.take());
        child.wait().unwrap();
    }

    #[test]
    fn build_and_machine_are_told() {
        let told = told("a build").join("\n");
        assert!(told.contains("a build") && told.contains("cores"), "{told}");
    }
}
