//! What may be done next, as a command that a shell takes as it stands and that was not just run.

use std::path::Path;

use socrates_model::{PlannerName, ScenarioEnd, Verdict};

use crate::bundle::Bundle;
use crate::files::shell;
use crate::layout;
use crate::library_index::Library;
use crate::run_options::RunOptions;

/// What is known after a run.
#[derive(Debug, Clone)]
struct After {
    /// The request that was run, for a shell.
    request: String,
    /// Its bundle, for a shell.
    bundle: String,
    /// Author that was named on the command line, with the flag.
    author: String,
    /// Seed of the run.
    seed: u64,
    /// Planners that were run.
    planners: Vec<PlannerName>,
    /// Simulation seeds that were run.
    seeds: usize,
    /// Verdict of the first run.
    verdict: Verdict,
    /// Code of the fault that the verdict names.
    fault: Option<&'static str>,
    /// Whether something of the request was not understood.
    misread: bool,
    /// Whether a person looked at it while it was made.
    looked_at: bool,
    /// Whether a film lies in the bundle.
    filmed: bool,
    /// The driver that was started with the run, with the flag.
    driver: String,
    /// Code of the first run without a result.
    failed: Option<&'static str>,
}

/// The line after a run; `file` is the request that was run, where it was a file.
pub(crate) fn after_run(options: &RunOptions, bundle: &Bundle, file: Option<&Path>) -> String {
    let report = bundle.runs.first().map(|(_, report)| report);
    let mut seeds: Vec<u64> = bundle.manifest.runs.iter().map(|run| run.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let films = |entry: std::fs::DirEntry| {
        let path = entry.path();
        path.extension().is_some_and(|ending| ["mp4", "webm", "gif"].iter().any(|film| ending == *film))
    };
    command(&After {
        // What a person left is pinned in the bundle's own request.
        request: shell(
            &file.filter(|_| !options.ask).map_or_else(|| bundle.dir.join(layout::REQUEST.path), Path::to_path_buf),
        ),
        bundle: shell(&bundle.dir),
        author: options
            .author
            .as_ref()
            .map_or_else(String::new, |author| format!(" --author {}", shell(Path::new(&author.to_string())))),
        seed: options.seed,
        planners: bundle.manifest.runs.iter().map(|run| run.planner.clone()).collect(),
        seeds: seeds.len(),
        verdict: bundle.manifest.verdict,
        fault: report.and_then(|report| Some(report.repair.as_ref()?.faults.first()?.code.code())),
        misread: !bundle.reading.missing().is_empty(),
        looked_at: options.ask,
        driver: options
            .driver
            .as_ref()
            .map_or_else(String::new, |line| format!(" --driver {}", shell(Path::new(line)))),
        failed: bundle.manifest.failed.first().and_then(|run| Some(run.faults.first()?.code.code())),
        filmed: std::fs::read_dir(&bundle.dir).into_iter().flatten().filter_map(Result::ok).any(films),
    })
}

/// The first of these commands that fits.
fn command(after: &After) -> String {
    let After { request, bundle, author, seed, driver, .. } = after;
    let realised = after.verdict == Verdict::Realised;
    let tested = after.planners.iter().any(|planner| !planner.is_reference() && !planner.is_no_robot());
    let why = after.fault.map_or_else(String::new, |code| format!("   # why: socrates explain {code}"));
    let tries = [
        (
            after.misread && !after.looked_at,
            format!("socrates run {request} --ask{author}   # not everything was understood: say it in other words"),
        ),
        (after.failed.is_some(), format!("socrates explain {}", after.failed.unwrap_or_default())),
        (!realised, format!("socrates run {request} --seed {}{author}{why}", seed.saturating_add(1))),
        (!tested, format!("socrates run {request} --planner reactive --seeds 1..5{author}")),
        (
            after.seeds < 2,
            format!("socrates run {request} --planner {} --seeds 1..5{author}{driver}", robots(&after.planners)),
        ),
        (!after.filmed, format!("socrates video {bundle}")),
    ];
    let fits = tries.into_iter().find(|(fits, _)| *fits).map(|(_, command)| command);
    fits.unwrap_or_else(|| format!("socrates cite {bundle}"))
}

/// The planners under test, as `--planner` takes them.
fn robots(planners: &[PlannerName]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for planner in planners.iter().filter(|planner| !planner.is_reference()).map(PlannerName::as_str) {
        if !names.contains(&planner) {
            names.push(planner);
        }
    }
    names.join(",")
}

/// The line after a batch: why some failed, else what people say of the runs.
pub(crate) fn after_batch(root: &Path, library: &Library) -> String {
    if library.shard.is_some() {
        // Named by hand: where the others are is not known here.
        let beside = root.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        return format!("socrates library merge {} --out library   # once every shard is made", shell(beside));
    }
    let failed = library.scenarios.iter().any(|row| row.verdict == ScenarioEnd::Failed);
    // What judges look at is played from bundles.
    let kept = library.scenarios.iter().any(|row| !row.bundle.is_empty());
    if library.scenarios.is_empty() {
        return "the same command again, once scenarios are done".to_owned();
    }
    match (failed, kept) {
        (true, _) => format!("socrates status --failed {}", shell(root)),
        (false, true) => format!("socrates labels page {}", shell(root)),
        (false, false) => format!("socrates library query {} --where verdict=realised", shell(root)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after() -> After {
        After {
            request: "my.toml".to_owned(),
            bundle: "runs/my-1".to_owned(),
            author: String::new(),
            seed: 1,
            planners: vec![PlannerName::reference()],
            seeds: 1,
            verdict: Verdict::Realised,
            fault: None,
            misread: false,
            looked_at: false,
            filmed: false,
            driver: String::new(),
            failed: None,
        }
    }

    #[test]
    fn what_was_just_run_is_never_proposed() {
        let both = vec![PlannerName::reference(), "reactive".parse().unwrap()];
        let plain = after();
        assert_eq!(command(&plain), "socrates run my.toml --planner reactive --seeds 1..5");
        let one = After { planners: both, ..plain };
        assert_eq!(command(&one), "socrates run my.toml --planner reactive --seeds 1..5", "more seeds");
        let five = After { seeds: 5, ..one };
        assert_eq!(command(&five), "socrates video runs/my-1");
        assert_eq!(command(&After { filmed: true, ..five }), "socrates cite runs/my-1");
        let driver = " --driver 'python3 mine.py'".to_owned();
        let driven = After { planners: vec!["external:mine".parse().unwrap()], driver, ..after() };
        let again = "socrates run my.toml --planner external:mine --seeds 1..5 --driver 'python3 mine.py'";
        assert_eq!(command(&driven), again);
        assert_eq!(command(&After { failed: Some("J-DRIVER"), ..driven }), "socrates explain J-DRIVER");
    }

    #[test]
    fn a_request_that_was_not_understood_leads_to_ask_and_one_looked_at_does_not() {
        let misread = After { misread: true, ..after() };
        assert!(command(&misread).starts_with("socrates run my.toml --ask "), "{}", command(&misread));
        let asked = After { looked_at: true, ..misread };
        assert!(!command(&asked).contains("--ask"));
    }

    #[test]
    fn a_run_that_missed_is_tried_with_another_seed_and_the_reason_stands_beside_it() {
        let missed = After {
            verdict: Verdict::NotTriggered,
            fault: Some("D-NOTRIG"),
            seed: 7,
            author: " --author offline".to_owned(),
            ..after()
        };
        assert_eq!(
            command(&missed),
            "socrates run my.toml --seed 8 --author offline   # why: socrates explain D-NOTRIG"
        );
    }
}
