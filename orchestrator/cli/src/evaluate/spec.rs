//! What is to be evaluated: requests, repeats, arms.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::config::Config;
use crate::exit::Complaint;
use crate::prepare::{Prepared, prepare, prepare_text};

/// The specification that is shipped, by its name.
const SHIPPED: (&str, &str) = ("paper", include_str!("paper.toml"));
const HINT: &str =
    "`socrates evaluate author paper` runs the shipped one; orchestrator/cli/src/evaluate/paper.toml shows its form";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default = "four")]
    attempts: u32,
    #[serde(default = "yes")]
    simulate: bool,
    requests: Vec<Wanted>,
    arms: Vec<Arm>,
}

const fn one() -> u64 {
    1
}
const fn four() -> u32 {
    4
}
const fn yes() -> bool {
    true
}
const fn once() -> usize {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    shipped: Option<String>,
    file: Option<PathBuf>,
    location: Option<String>,
    social_context: Option<String>,
    task: Option<String>,
    rough_scenario: Option<String>,
    #[serde(default = "once")]
    repeats: usize,
}

/// What an author is told of the faults of its answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Feedback {
    /// Every fault, with where and what is allowed.
    #[default]
    Named,
    /// That something is wrong.
    Vague,
    /// Nothing: the same question again.
    None,
}

/// One way to author.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Arm {
    pub(super) name: String,
    pub(super) author: String,
    #[serde(default)]
    pub(super) feedback: Feedback,
    /// Asks per stage, where they differ from the plan's.
    pub(super) attempts: Option<u32>,
    /// `prompt.…` and `fault.…`.
    #[serde(default)]
    pub(super) settings: BTreeMap<String, String>,
}

impl Arm {
    /// Whether faults are put into its answers.
    pub(super) fn is_injected(&self) -> bool {
        self.settings.keys().any(|key| key.starts_with("fault."))
    }

    /// Settings of its jobs.
    pub(super) fn job_settings(&self) -> BTreeMap<String, String> {
        let mut settings = self.settings.clone();
        settings.insert("author".to_owned(), self.author.clone());
        settings
    }
}

/// One request with its repeats.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) guided: bool,
    pub(super) prepared: Prepared,
    pub(super) repeats: usize,
}

/// Everything to be done.
pub(super) struct Plan {
    pub(super) title: String,
    pub(super) seed: u64,
    pub(super) attempts: u32,
    pub(super) simulate: bool,
    pub(super) cases: Vec<Case>,
    pub(super) arms: Vec<Arm>,
}

/// Reads and checks a specification.
pub(super) fn read(file: &Path, config: &Config) -> Result<Plan, Complaint> {
    let shown = file.display().to_string();
    let text = if shown == SHIPPED.0 {
        SHIPPED.1.to_owned()
    } else {
        std::fs::read_to_string(file)
            .map_err(|why| Complaint::input(format!("cannot read the specification `{shown}`: {why}"), HINT))?
    };
    let wrong = |why: String| Complaint::input(format!("the specification `{shown}`: {why}"), HINT);
    let read: File = toml::from_str(&text).map_err(|why| wrong(why.to_string()))?;
    if read.arms.is_empty() || read.requests.is_empty() {
        return Err(wrong("it needs at least one of `[[requests]]` and one of `[[arms]]`".to_owned()));
    }
    if !(1..=20).contains(&read.attempts) {
        return Err(wrong(format!("`attempts` is {}; allowed: 1 to 20", read.attempts)));
    }
    for arm in &read.arms {
        let style = socrates_prompts::Style::from_settings(&arm.settings).map(drop).map_err(|fault| fault.to_string());
        let rates = socrates_author::FaultRates::from_settings(&arm.settings).map(drop).map_err(|why| why.to_string());
        style.and(rates).map_err(|why| wrong(format!("arm `{}`: {why}", arm.name)))?;
        if let Some(key) = arm.settings.keys().find(|key| !key.starts_with("prompt.") && !key.starts_with("fault.")) {
            return Err(wrong(format!(
                "arm `{}`: `{key}` is no setting; they begin with `prompt.` or `fault.`",
                arm.name
            )));
        }
    }
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let cases = read.requests.iter().map(|wanted| case(wanted, folder, config, &wrong)).collect::<Result<_, _>>()?;
    Ok(Plan {
        title: read.title,
        seed: read.seed,
        attempts: read.attempts,
        simulate: read.simulate,
        cases,
        arms: read.arms,
    })
}

fn case(
    wanted: &Wanted,
    folder: &Path,
    config: &Config,
    wrong: &dyn Fn(String) -> Complaint,
) -> Result<Case, Complaint> {
    let made = |name: String, prepared: Prepared| {
        let guided = prepared.request.rough_scenario.is_some();
        Case { name, guided, prepared, repeats: wanted.repeats }
    };
    match (&wanted.shipped, &wanted.file, &wanted.location) {
        (Some(shipped), None, None) => {
            let found = shipped.split_once('/').and_then(|(location, name)| {
                let all = socrates_maps::shipped::requests(location);
                all.into_iter().find(|(file, _)| file.trim_end_matches(".toml") == name).map(|(_, text)| text)
            });
            let text = found.ok_or_else(|| wrong(format!("there is no shipped request `{shipped}`")))?;
            Ok(made(shipped.clone(), prepare_text(shipped, text, shipped, folder, None, config, false)?))
        }
        (None, Some(file), None) => {
            let path = folder.join(file);
            Ok(made(file.display().to_string(), prepare(&path, None, config, false)?))
        }
        (None, None, Some(location)) => {
            let mut request = toml::Table::new();
            let parts = [
                ("location", Some(location)),
                ("social_context", wanted.social_context.as_ref()),
                ("task", wanted.task.as_ref()),
                ("rough_scenario", wanted.rough_scenario.as_ref()),
            ];
            for (key, text) in parts {
                if let Some(text) = text {
                    request.insert(key.to_owned(), toml::Value::String(text.clone()));
                }
            }
            let name = format!("{location}: {}", wanted.task.as_deref().unwrap_or_default());
            let prepared = prepare_text(location, &request.to_string(), &name, folder, None, config, false)?;
            Ok(made(name, prepared))
        }
        _ => Err(wrong("each of `[[requests]]` has one of `shipped`, `file` and `location`".to_owned())),
    }
}
