//! What every bench prints before its figures, and its clock. Benches of all rooms take it in by its path, so that a room's bench
//! needs nothing that the room does not.

use std::fs::read_to_string;
use std::sync::LazyLock;
use std::time::Instant;

/// Two lines: what is run and how it was built; the processor, the vector instructions seen on it, cores and load before.
pub(crate) fn told(what: &str) -> String {
    let info = read_to_string("/proc/cpuinfo").unwrap_or_default();
    let value = |name: &str| info.lines().find_map(|line| Some(line.strip_prefix(name)?.split_once(": ")?.1));
    let flags: Vec<&str> = value("flags").unwrap_or_default().split_whitespace().collect();
    let seen: Vec<&str> = ["sse4_2", "avx2", "avx512f"].into_iter().filter(|name| flags.contains(name)).collect();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let load = read_to_string("/proc/loadavg").unwrap_or_default();
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    let built = match (cfg!(target_feature = "avx512f"), cfg!(target_feature = "avx2")) {
        (true, _) => "avx512f",
        (_, true) => "avx2",
        _ => "baseline",
    };
    format!(
        "{what} · version {} · {profile} build for {} {built}\n{} · seen {} · {cores} cores · load {} before",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::ARCH,
        value("model name").unwrap_or("unknown processor"),
        seen.join(" "),
        load.split_whitespace().next().unwrap_or("unknown")
    )
}

/// CPU time of this thread's process so far, s; wall time where the system does not tell.
pub(crate) fn cpu_s() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = read_to_string("/proc/self/schedstat").ok();
    let nanos = told.as_ref().and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanos.map_or_else(|| START.elapsed().as_secs_f64(), |nanos| nanos * 1e-9)
}
