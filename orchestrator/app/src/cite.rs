//! `cite`: what a paper says about how a bundle was made.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::json;
use socrates_model::report::Standing;
use socrates_model::{AgentId, Clause, ClauseRole, PlannerName, Verdict};
use socrates_orchestrator::pipeline;

use crate::bundle::{self, Bundle};
use crate::exit::Diagnostic;
use crate::output::Printer;
use crate::report::past;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Prints the methods paragraph and the entries of a bibliography.
pub fn cite(talk: &Printer, dir: &Path) -> Result<(), Diagnostic> {
    let bundle = bundle::read(dir)?;
    let (stages, _) = past(dir);
    let asked: u32 =
        stages.iter().filter(|row| row.stage.is_some_and(pipeline::is_authored)).map(|row| row.attempts).sum();
    let program = program(dir);
    let methods = paragraph(&bundle, asked, program.as_deref());
    let hashes = hashes(&bundle);
    let bibtex = bibtex(&bundle);
    talk.line(&methods);
    talk.line("");
    for (name, hash) in &hashes {
        talk.line(&format!("{name:<24} {hash}"));
    }
    talk.line("");
    talk.line(bibtex.trim_end());
    let planners: BTreeSet<&str> = bundle.manifest.runs.iter().map(|run| run.planner.as_str()).collect();
    let seeds: BTreeSet<u64> = bundle.manifest.runs.iter().map(|run| run.seed).collect();
    talk.result(&json!({
        "methods": methods, "bibtex": bibtex, "version": VERSION, "program": program, "author": bundle.proposal.author,
        "location": bundle.location.name, "base_seed": bundle.manifest.seed, "seeds": seeds, "planners": planners,
        "hashes": hashes.into_iter().collect::<BTreeMap<_, _>>(),
    }));
    Ok(())
}

/// The build id of the program that made the bundle, as its provenance tells it.
fn program(dir: &Path) -> Option<String> {
    let text = bundle::file(dir, crate::layout::PROVENANCE.path).ok()?;
    let provenance: serde_json::Value = serde_json::from_slice(&text).ok()?;
    provenance.get("program")?.as_str().map(str::to_owned)
}

fn paragraph(bundle: &Bundle, asked: u32, program: Option<&str>) -> String {
    let (manifest, proposal) = (&bundle.manifest, &bundle.proposal);
    let build = program.map_or_else(String::new, |id| format!(" (build {})", id.chars().take(12).collect::<String>()));
    let mut out = format!(
        "The scenario \"{}\" was generated with SocRATES {VERSION}{build} from the social context \"{}\" and the robot task \"{}\"",
        proposal.title,
        sentence(&bundle.request.social_context),
        sentence(&bundle.request.task)
    );
    match &bundle.request.rough_scenario {
        Some(rough) => out.push_str(&format!(", guided by the rough scenario \"{}\".", sentence(rough))),
        None => out.push_str(", without a rough scenario (unguided)."),
    }
    let author = if proposal.author.is_rules() {
        format!("the rule-based offline author ({})", proposal.author)
    } else {
        format!("`{}`", proposal.author)
    };
    let tries = if asked > 0 { format!(" in {}", count(asked as usize, "attempt")) } else { String::new() };
    out.push_str(&format!(
        " Proposal, paths and behaviors were written by {author}{tries}, base seed {}. It takes place in the location `{}` ({:.0} m by {:.0} m at {} m per cell, {} nodes) with {}{}.",
        manifest.seed,
        bundle.location.name,
        meters(bundle.location.grid.width, bundle.location.grid.resolution_m),
        meters(bundle.location.grid.height, bundle.location.grid.resolution_m),
        bundle.location.grid.resolution_m,
        bundle.location.graph.nodes().len(),
        count(proposal.humans.len(), "human"),
        groups(bundle)
    ));
    out.push_str(&simulated(bundle));
    out.push_str(&judged(bundle));
    out.push_str(
        " Recordings are named by their BLAKE3 hash over decoded frames and events; `socrates simulate` on the bundle repeats them bit by bit and compares the hashes.",
    );
    out
}

fn groups(bundle: &Bundle) -> String {
    match bundle.proposal.groups.len() {
        0 => String::new(),
        n => format!(" in {}", count(n, "group")),
    }
}

fn simulated(bundle: &Bundle) -> String {
    let request = &bundle.request;
    let mut seeds: BTreeMap<&PlannerName, Vec<String>> = BTreeMap::new();
    for run in &bundle.manifest.runs {
        seeds.entry(&run.planner).or_default().push(run.seed.to_string());
    }
    let planners: Vec<String> = seeds
        .iter()
        .map(|(planner, seeds)| {
            let what = if planner.is_reference() {
                " (plays the robot script along the intended path)"
            } else if planner.is_no_robot() {
                " (the same people without a robot)"
            } else {
                ""
            };
            let word = if seeds.len() == 1 { "seed" } else { "seeds" };
            format!("`{planner}`{what} with {word} {}", seeds.join(", "))
        })
        .collect();
    let lengths: Vec<f64> = bundle.runs.iter().map(|(_, report)| report.simulated_s).collect();
    let least = lengths.iter().copied().fold(f64::MAX, f64::min);
    let most = lengths.iter().copied().fold(0.0, f64::max);
    let span = if most - least < 0.05 { format!("{most:.1} s") } else { format!("{least:.1} s to {most:.1} s") };
    let header = bundle.runs.first().map(|(recording, _)| &recording.header);
    let (step, profile) = header.map_or((0.01, "native"), |header| (header.step_s, header.profile.as_str()));
    let body = |robot: bool| {
        let agents = header.into_iter().flat_map(|header| &header.agents);
        agents.into_iter().find(|info| (info.agent == AgentId::Robot) == robot).map(|info| info.radius_m)
    };
    let speeds = |robot: bool| -> Vec<f64> {
        let agents = header.into_iter().flat_map(|header| &header.agents);
        agents.into_iter().filter(|info| (info.agent == AgentId::Robot) == robot).map(|info| info.speed_mps).collect()
    };
    let fastest = speeds(true).first().map_or_else(String::new, |mps| format!(", at most {mps:.2} m/s"));
    let radius = |robot: bool| body(robot).map_or(String::new(), |m| format!(" (radius {m:.2} m{fastest})"));
    format!(
        " It was simulated {} ({span} each) at a fixed step of {step} s with the semantics `{profile}`, people of radius {:.2} m{} and the robot model `{}`{}, way points `{}`, planners: {}.",
        times(bundle.runs.len()),
        body(false).unwrap_or(0.28),
        desired(&speeds(false)),
        request.robot.model.name,
        radius(true),
        serde_json::to_value(request.robot.waypoints)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default(),
        planners.join("; ")
    )
}

/// ` and desired speeds of 0.90 to 1.30 m/s`
fn desired(mps: &[f64]) -> String {
    let least = mps.iter().copied().fold(f64::INFINITY, f64::min);
    let most = mps.iter().copied().fold(0.0, f64::max);
    match mps.len() {
        0 => String::new(),
        _ if most - least < 0.005 => format!(", desired speed {most:.2} m/s,"),
        _ => format!(", desired speeds {least:.2} to {most:.2} m/s,"),
    }
}

/// The numbers of the clauses that had to hold, each once: `meets within_m 2.5`.
fn limits(clauses: &[Clause]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for clause in clauses.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup) {
        let Some(members) = json!(clause.predicate).as_object().cloned() else { continue };
        for (name, value) in &members {
            let numbers = value.as_object().into_iter().flatten().filter(|(_, value)| is_limit(value));
            let numbers: Vec<String> = numbers.map(|(key, value)| format!("{key} {value}")).collect();
            let line = format!("{name} {}", numbers.join(" "));
            if !numbers.is_empty() && !found.contains(&line) {
                found.push(line);
            }
        }
    }
    found
}

/// A number with a fraction, or a range of two: distances and times, no counts.
fn is_limit(value: &serde_json::Value) -> bool {
    value.is_f64() || value.as_array().is_some_and(|both| both.len() == 2 && both.iter().all(serde_json::Value::is_f64))
}

fn judged(bundle: &Bundle) -> String {
    let Some((_, report)) = bundle.runs.first() else { return String::new() };
    let setup = report.clauses.iter().filter(|clause| clause.role == ClauseRole::Setup);
    let needed = setup.clone().filter(|clause| clause.must && clause.standing != Standing::NotApplicable).count();
    let outcome = report.clauses.iter().filter(|clause| clause.role == ClauseRole::Outcome).count();
    let robots: Vec<_> = bundle.runs.iter().filter(|(_, report)| !report.planner.is_no_robot()).collect();
    let realised = robots.iter().filter(|(_, report)| report.verdict == Verdict::Realised).count();
    let succeeded = robots.iter().filter(|(_, report)| report.success).count();
    let limits = limits(&bundle.proposal.expected_events);
    let limits = if limits.is_empty() { String::new() } else { format!(" with the limits {}", limits.join("; ")) };
    let values = report.metrics.iter().filter(|metric| metric.value.is_some()).count();
    format!(
        " Whether it happened as proposed was judged by {} that had to hold{limits} ({} of {} runs realised; verdict of the reference run: {}); apart from that, the robot was judged by {} and {} (it reached its goal without a collision in {} of {} runs), thresholds `{}`; nobody may overlap by more than 2 cm or be faster than 2 m/s.",
        count(needed, "setup clause"),
        realised,
        robots.len(),
        report.verdict.name().replace('_', " "),
        count(outcome, "outcome clause"),
        count(values, "metric"),
        succeeded,
        robots.len(),
        report.thresholds
    )
}

/// Names and hashes that a reader can check.
fn hashes(bundle: &Bundle) -> Vec<(String, String)> {
    let manifest = &bundle.manifest;
    let file = |name: &str, path: &str| Some((name.to_owned(), manifest.files.get(path)?.to_string()));
    let mut rows = vec![("wish".to_owned(), manifest.wish.to_string())];
    rows.extend(
        [
            file("request", crate::layout::REQUEST.path),
            file("location", crate::layout::LOCATION.path),
            file("proposal", crate::layout::PROPOSAL.path),
            file("paths", crate::layout::PATHS.path),
            file("behaviors", crate::layout::BEHAVIORS.path),
        ]
        .into_iter()
        .flatten(),
    );
    rows.extend(manifest.runs.iter().map(|run| (format!("recording {}", run.run()), run.recording_hash.to_string())));
    rows
}

fn bibtex(bundle: &Bundle) -> String {
    format!(
        "@misc{{marpally2024socrates,\n  title         = {{{{SocRATES}}: Towards Automated Scenario-based Testing of Social Navigation Algorithms}},\n  author        = {{Marpally, Shashank Rao and Goyal, Pranav and Soh, Harold}},\n  year          = {{2024}},\n  eprint        = {{2412.19595}},\n  archivePrefix = {{arXiv}}\n}}\n\n@software{{socrates_software,\n  title   = {{{{SocRATES}}: social-navigation scenarios from a few sentences and a map}},\n  version = {{{VERSION}}},\n  note    = {{Scenario {}, wish {}}}\n}}\n",
        bundle.manifest.scenario,
        bundle.manifest.wish.short()
    )
}

fn meters(cells: usize, resolution_m: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let cells = cells as f64;
    cells * resolution_m
}

/// A text of the user as part of a sentence: on one line, without a final period, in single quotes inside.
fn sentence(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.trim_end_matches('.').replace('"', "'")
}

fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

fn times(n: usize) -> String {
    if n == 1 { "once".to_owned() } else { format!("{n} times") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::{HumanId, Predicate};

    #[test]
    fn the_limits_of_the_judge_and_the_speeds_are_named() {
        let clause = |must: bool, predicate: Predicate| Clause {
            id: "c1".into(),
            text: String::new(),
            role: ClauseRole::Setup,
            must,
            source: String::new(),
            predicate,
        };
        let human = HumanId::new(1);
        let clauses = [
            clause(true, Predicate::Meets { human, within_m: 2.5 }),
            clause(true, Predicate::Meets { human: HumanId::new(2), within_m: 2.5 }),
            clause(true, Predicate::Humans { count: 2 }),
            clause(false, Predicate::OnTime { human, gap_s: 4.0 }),
            clause(true, Predicate::DoorOpens { door: "d".into(), robot_m: [1.0, 4.5] }),
        ];
        assert_eq!(limits(&clauses), ["meets within_m 2.5", "door_opens robot_m [1.0,4.5]"]);
        assert_eq!(desired(&[0.9, 1.3]), ", desired speeds 0.90 to 1.30 m/s,");
        assert_eq!(desired(&[]), "");
    }

    #[test]
    fn words_of_a_request_become_part_of_a_sentence() {
        assert_eq!(sentence("  He says \"stop\".\nThen goes. "), "He says 'stop'. Then goes");
        assert_eq!((count(1, "run"), count(0, "run")), ("1 run".to_owned(), "0 runs".to_owned()));
        assert_eq!((times(1), times(4)), ("once".to_owned(), "4 times".to_owned()));
    }
}
