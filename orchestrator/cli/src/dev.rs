//! `dev`: for developers of SocRATES.

use std::path::Path;
use std::time::Instant;

use serde_json::json;

use crate::args::DevVerb;
use crate::bundle;
use crate::exit::{Code, Complaint};
use crate::talk::Talk;
use crate::traces;

/// Does a `dev` verb.
pub(crate) fn dev(talk: &Talk, verb: &DevVerb) -> Result<(), Complaint> {
    match verb {
        DevVerb::Schema { artifact } => schema(talk, artifact),
        DevVerb::Import { file } => import(talk, file),
        DevVerb::Export { bundle, out } => export(talk, bundle, out),
        DevVerb::SfmTrace { scene, out, forces } => traces::crowd(talk, scene, out, forces.as_deref()),
        DevVerb::BtTrace { tree, script, out, events } => traces::tree(talk, tree, script, out, events),
        DevVerb::Bench { runs } => bench(talk, *runs),
    }
}

fn schema(talk: &Talk, artifact: &str) -> Result<(), Complaint> {
    let schema = socrates_model::schema::of(artifact).ok_or_else(|| {
        Complaint::input(
            format!("there is no artifact `{artifact}`"),
            format!("artifacts: {}", socrates_model::schema::NAMES.join(", ")),
        )
    })?;
    let text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    talk.line(&text);
    talk.result(&schema);
    Ok(())
}

fn import(talk: &Talk, file: &Path) -> Result<(), Complaint> {
    let text = std::fs::read_to_string(file).map_err(|why| {
        Complaint::input(format!("cannot read `{}`: {why}", file.display()), "name a JSON file of the published tool")
    })?;
    let found = socrates_export::socrates_json::read(&text).map_err(|why| {
        Complaint::input(
            format!("`{}`: {why}", file.display()),
            "the forms are scenario, trajectory, trees and combined",
        )
    })?;
    let object = json!({ "proposal": found.proposal, "paths": found.paths, "behaviors": found.behaviors });
    talk.line(&serde_json::to_string_pretty(&object).unwrap_or_default());
    talk.result(&object);
    Ok(())
}

fn export(talk: &Talk, dir: &Path, out: &Path) -> Result<(), Complaint> {
    let bundle = bundle::read(dir)?;
    let cannot = |why: std::io::Error| {
        Complaint::input(format!("cannot write into `{}`: {why}", out.display()), "--out chooses another folder")
    };
    std::fs::create_dir_all(out).map_err(cannot)?;
    let files = [
        ("scenario.json", socrates_export::socrates_json::scenario(&bundle.proposal)),
        ("trajectory.json", socrates_export::socrates_json::trajectory(&bundle.proposal, &bundle.paths)),
        ("bt.json", socrates_export::socrates_json::trees(&bundle.behaviors)),
        (
            "response_traj.json",
            socrates_export::socrates_json::combined(&bundle.proposal, &bundle.paths, &bundle.behaviors),
        ),
    ];
    for (name, value) in &files {
        std::fs::write(out.join(name), serde_json::to_string_pretty(value).unwrap_or_default()).map_err(cannot)?;
    }
    talk.line(&format!("wrote      {} ({})", out.display(), files.map(|(name, _)| name).join(", ")));
    talk.result(&json!({ "out": out.display().to_string() }));
    Ok(())
}

/// The main job on the shipped warehouse, from process start to exit, as a user meets it.
fn bench(talk: &Talk, runs: u32) -> Result<(), Complaint> {
    let ours = |why: String| Complaint::input(why, "").with_code(Code::Ours);
    let program = std::env::current_exe().map_err(|why| ours(why.to_string()))?;
    let folder = std::env::temp_dir().join(format!("socrates-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|why| ours(why.to_string()))?;
    let request = folder.join("bench.toml");
    std::fs::write(&request, include_str!("bench.toml")).map_err(|why| ours(why.to_string()))?;
    let mut times = Vec::new();
    let mut overheads = Vec::new();
    let mut last = String::new();
    for number in 0..runs.max(1) + 1 {
        let started = Instant::now();
        let out = std::process::Command::new(&program)
            .args(["run", "--require", "any", "--format", "json", "--out"])
            .arg(folder.join(number.to_string()))
            .arg(&request)
            .output()
            .map_err(|why| ours(why.to_string()))?;
        let ms = started.elapsed().as_secs_f64() * 1000.0;
        if !out.status.success() {
            return Err(ours(format!("the bench run failed: {}", String::from_utf8_lossy(&out.stderr))));
        }
        last = String::from_utf8_lossy(&out.stdout).lines().last().unwrap_or_default().to_owned();
        // The first run warms the disk cache and is not counted.
        if number > 0 {
            times.push(ms);
            overheads.extend(hand_overs(&folder.join(number.to_string())));
        }
    }
    times.sort_by(f64::total_cmp);
    overheads.sort_by(f64::total_cmp);
    let middle = |sorted: &[f64]| sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN);
    let (median, overhead) = (middle(&times), middle(&overheads));
    let (least, most) = (times.first().copied().unwrap_or(f64::NAN), times.last().copied().unwrap_or(f64::NAN));
    let result: serde_json::Value = serde_json::from_str(&last).unwrap_or_default();
    talk.line(&format!(
        "warm run   {median:.0} ms wall, all processes (least {least:.0}, most {most:.0}, {} runs); target 1000 ms",
        times.len()
    ));
    talk.line(&format!("budget     {:.2} of the target", median / 1000.0));
    talk.line(&format!(
        "hand-over  {overhead:.0} ms median over the bus, from ready to reported without the work (most {:.0}, {} jobs); target 5 ms",
        overheads.last().copied().unwrap_or(f64::NAN),
        overheads.len()
    ));
    for stage in result.get("stages").and_then(|stages| stages.as_array()).into_iter().flatten() {
        talk.line(&format!("  {:<28} {:>5} ms", stage["stage"].as_str().unwrap_or_default(), stage["ms"]));
    }
    talk.result(&json!({ "median_ms": median, "hand_over_ms": overhead, "least_ms": least, "most_ms": most, "runs": times.len() }));
    drop(std::fs::remove_dir_all(&folder));
    Ok(())
}

/// What each job of a bundle took beyond its work, ms: both ways over the bus, and the decisions between. Left out is
/// what waited for something else: the first job, for its worker to start, and runs that stood in line behind another.
fn hand_overs(bundle: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(bundle.join("details/provenance.json")).unwrap_or_default();
    let provenance: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let list = |value: &serde_json::Value, name: &str| value.get(name).and_then(|list| list.as_array()).cloned();
    let jobs = list(&provenance, "jobs").unwrap_or_default();
    let alone = |job: &&serde_json::Value| {
        let part = |path: &str| job.pointer(path).and_then(|text| text.as_str()).unwrap_or_default();
        let stage = part("/job/stage");
        stage != "proposal" && (stage != "simulation" || part("/job/item").starts_with("reference"))
    };
    jobs.iter()
        .filter(alone)
        .flat_map(|job| list(job, "attempts").unwrap_or_default())
        .filter_map(|attempt| Some(attempt.get("span_ms")?.as_f64()? - attempt.get("wall_ms")?.as_f64()?))
        .collect()
}
