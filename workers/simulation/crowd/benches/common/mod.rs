//! What every bench of this crate prints first, and how it measures: process CPU time of one thread.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// CPU time of the process, s; the wall clock where the system does not tell.
pub(crate) fn cpu_s(start: &Instant) -> f64 {
    // Fields 14 and 15 of the process line, in hundredths of a second, are too coarse; the scheduler's
    // own count is in nanoseconds.
    std::fs::read_to_string("/proc/self/schedstat")
        .ok()
        .and_then(|line| line.split_whitespace().next().and_then(|field| field.parse::<f64>().ok()))
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// The processor, the vector instructions seen on it, the build, and the date.
pub(crate) fn header() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find(|line| line.starts_with("model name")).and_then(|line| line.split_once(": "));
    let has = |flag: &str| info.lines().find(|line| line.starts_with("flags")).is_some_and(|line| line.contains(flag));
    let vectors = [" avx2", " avx512f"].into_iter().filter(|flag| has(flag)).collect::<String>();
    let profile = if cfg!(debug_assertions) { "debug" } else { "optimized" };
    let built = match (cfg!(target_feature = "avx512f"), cfg!(target_feature = "avx2")) {
        (true, _) => "avx512f",
        (_, true) => "avx2",
        _ => "baseline, wider chosen at run time",
    };
    format!(
        "{} ({} seen:{vectors}), {profile} build for {built}, {}",
        name.map_or("unknown processor", |(_, name)| name),
        std::env::consts::ARCH,
        date()
    )
}

/// The date, by the days-to-civil rule for the Gregorian calendar.
fn date() -> String {
    let days = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs() / 86_400) + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let (day, month) = (day_of_year - (153 * shifted + 2) / 5 + 1, (shifted + 2) % 12 + 1);
    format!("{:04}-{month:02}-{day:02}", year_of_era + era * 400 + u64::from(month <= 2))
}

/// The middle of several numbers.
pub(crate) fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}
