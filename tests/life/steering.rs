//! A cluster as somebody meets it who asks why nothing happens: how it stands, why jobs wait, what can be done, and figures.

use std::path::Path;

use socrates_tests::program::{Finished, finish, naming, poll, signal, start};

use crate::{PROGRAM, WAREHOUSE, figures, socrates};

/// An orchestrator without workers that was handed a batch of four scenarios.
struct Site<'a> {
    at: &'a Path,
    endpoint: String,
}

impl Site<'_> {
    fn ask(&self, words: &[&str]) -> Finished {
        socrates(self.at, "asked", words)
    }

    /// A verb of `cluster` about jobs.
    fn steer(&self, words: &[&str]) -> Finished {
        self.ask(&[&["cluster"][..], words, &["--connect", &self.endpoint]].concat())
    }

    fn explain(&self, job: &str) -> String {
        let told = self.ask(&["explain", job, "--connect", &self.endpoint]);
        assert_eq!(told.code, 0, "{}", told.err);
        told.out
    }
}

#[test]
fn a_cluster_says_why_jobs_wait_and_does_what_it_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let endpoint = format!("unixsock-stream/{}", at.join("bus").display());
    let up = ["cluster", "up", "--dir", "jobs", "--listen", &endpoint, "--metrics", "127.0.0.1:0"];
    let up = start(PROGRAM, &up, at, "up").unwrap();
    assert!(poll(|| at.join("bus").exists().then_some(())).is_some());
    let site = Site { at, endpoint: endpoint.clone() };
    let variants = ["hall.toml", "--variants", "4", "--repeats", "--batch", "night"];
    let submitted = site.steer(&[&["submit"][..], &variants[..]].concat());
    assert_eq!(submitted.code, 0, "{}", submitted.err);

    let status = site.ask(&["status", &endpoint, "--batch", "night"]);
    assert!(status.out.contains("idle for") || status.out.contains("going on"), "{}", status.out);
    assert!(status.out.contains("rate       none") && status.out.contains("batch      night"), "{}", status.out);
    let wrong = site.ask(&["status", &endpoint, "--batch", "nigth"]);
    assert!(wrong.code == 2 && wrong.err.contains("`nigth`") && wrong.err.contains("`night`"), "{}", wrong.err);
    let all = site.ask(&["--format", "json", "status", &endpoint, "--all"]).json();
    let names: Vec<String> =
        all["scenarios"].as_array().unwrap().iter().map(|row| row["scenario"].as_str().unwrap().to_owned()).collect();
    assert_eq!(names.len(), 4, "{all}");
    assert!(site.explain(&names[0]).contains("no worker of this stage is there"), "{}", site.explain(&names[0]));
    assert!(site.explain(&format!("{}/scoring", names[0])).contains("needs what"));
    let unknown = site.ask(&["explain", "nobody", "--connect", &endpoint]);
    assert!(unknown.code == 2 && unknown.err.contains(&names[0]), "{}", unknown.err);

    let unpaused = site.steer(&["resume"]);
    assert!(unpaused.code == 0 && unpaused.out.contains("everything: nothing was held back"), "{}", unpaused.out);
    // What is paused stays so, and says so.
    assert!(site.steer(&["pause", "proposal"]).out.contains("paused     stage proposal: 4 jobs of 4 scenarios wait"));
    assert!(site.explain(&format!("{}/proposal", names[0])).contains("stage proposal is paused"));
    let refusals: [(&[&str], &str); 3] = [
        (&["pause", "--batch", "x"], "known: `night`"),
        (&["cancel", "nobody"], "is not known here"),
        (&["requeue", &names[0], "nobody"], "has no dead or failed job; it is going on"),
    ];
    for (words, told) in refusals {
        let refused = site.steer(words);
        assert!(refused.code == 2 && refused.out.contains(told), "{words:?}: {}{}", refused.out, refused.err);
    }
    let canceled = site.steer(&["cancel", &names[3]]);
    assert!(canceled.code == 0 && canceled.out.contains("canceled   1 scenario: 5 jobs given up"), "{}", canceled.out);
    let again = site.steer(&["cancel", &names[3]]);
    assert!(again.code == 0 && again.out.contains("ended before: canceled"), "{}", again.out);
    assert!(site.steer(&["resume", "proposal"]).out.contains("resumed    stage proposal: 3 jobs"));

    let work = ["cluster", "work", "--connect", &endpoint, "--slots", "1", "--dir", "spool"];
    let work = start(PROGRAM, &work, at, "work").unwrap();
    let done = poll(|| (site.ask(&["--format", "json", "status", &endpoint]).json()["done"] == 4).then_some(()));
    assert!(done.is_some(), "not all was made");
    let status = site.ask(&["status", &endpoint]);
    assert!(status.out.contains(" · finished") && status.out.contains("of work"), "{}", status.out);
    assert!(site.explain(&names[0]).contains("succeeded"), "{}", site.explain(&names[0]));
    let top = site.ask(&["top", &endpoint, "--once"]);
    assert!(top.code == 0 && top.out.contains("behaviors") && top.out.contains("heard"), "{}{}", top.out, top.err);
    let table = site.ask(&["--format", "json", "top", &endpoint]).json();
    assert_eq!(table["table"]["workers"].as_array().map(Vec::len), Some(5), "{table}");
    let told = figures(&std::fs::read_to_string(at.join("up.err")).unwrap()).unwrap();
    let wanted = [
        "socrates_jobs{stage=\"scoring\",state=\"canceled\"} 1",
        "socrates_scenarios{state=\"ended\"} 4",
        "socrates_rpc_refusals_total{method=\"submit\",reason=\"refused\"} 0",
        "socrates_circuit{stage=\"paths\",state=\"closed\"} 1",
    ];
    for line in wanted {
        assert!(told.lines().any(|found| found == line), "no `{line}` in {told}");
    }
    // Workers of a cluster take and bring artifacts over the bus.
    let counted = |name: &str| {
        let line =
            told.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_else(|| panic!("no `{name}` in {told}"));
        line.trim().parse::<u64>().unwrap()
    };
    for name in [
        "socrates_blob_bytes_total{op=\"get\"}",
        "socrates_blobs_total{op=\"put\"}",
        "socrates_rpc_duration_seconds_count{method=\"acquire\"}",
        "socrates_rpc_duration_seconds_count{method=\"blob_put\"}",
    ] {
        assert!(counted(name) > 0, "{name}");
    }

    for (child, name) in [(work, "work"), (up, "up")] {
        assert!(signal(child.id(), "TERM").unwrap());
        let ended = finish(child, at, name).unwrap();
        assert_eq!(ended.code, 0, "{name}: {}{}", ended.out, ended.err);
    }
    // The store tells it when nobody serves it any more.
    let past = site.ask(&["explain", &format!("{}/paths", names[0]), "--dir", "jobs"]);
    assert!(
        past.code == 0 && past.out.contains("attempt 1 ") && past.out.contains("ended"),
        "{}{}",
        past.out,
        past.err
    );
    assert!(poll(|| naming(at).is_empty().then_some(())).is_some(), "left running: {:#?}", naming(at));
}
