//! The corpora with what was read of them, for the examples beside it.

#![expect(clippy::wildcard_enum_match_arm, reason = "of some facts")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Deserialize;
use socrates_model::{FactKind, Location, Reading, Request};

/// A file of requests.
#[derive(Deserialize)]
pub(crate) struct Corpus {
    pub(crate) request: Vec<Case>,
}

/// A request: its location, its text, and the facts that it has.
#[derive(Deserialize)]
pub(crate) struct Case {
    pub(crate) on: String,
    pub(crate) text: String,
    #[serde(default)]
    pub(crate) facts: Vec<String>,
}

/// Every request of every corpus in the order of the files: its text, the facts that it has, the request with its location, and whether it
/// was kept sealed.
pub(crate) fn each(mut take: impl FnMut(&str, &[String], (&Request, &Location), bool)) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let mut names: Vec<_> =
        std::fs::read_dir(&folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).collect();
    names.sort();
    let mut locations: BTreeMap<String, Location> = BTreeMap::new();
    for path in names.iter().filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
        let Ok(corpus) = toml::from_str::<Corpus>(&std::fs::read_to_string(path).unwrap_or_default()) else { continue };
        let sealed = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("sealed"));
        for case in &corpus.request {
            if !locations.contains_key(&case.on)
                && let Ok(location) = socrates_maps::shipped::load(&case.on)
            {
                locations.insert(case.on.clone(), location);
            }
            let Some(location) = locations.get(&case.on) else { continue };
            let request = asked(&case.on, &case.text);
            request.iter().for_each(|request| take(&case.text, &case.facts, (request, location), sealed));
        }
    }
}

/// A request of nothing but a place and a rough scenario.
pub(crate) fn asked(location: &str, rough: &str) -> Option<Request> {
    let request = serde_json::json!({
        "location": location, "social_context": "", "task": "Deliver mail", "rough_scenario": rough,
    });
    serde_json::from_value(request).ok()
}

/// FNV-1a of a text, 64 bits.
pub(crate) fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn number(value: f64) -> String {
    format!("{value}")
}

/// What was read, a fact a line as the corpora write it.
pub(crate) fn facts(reading: &Reading) -> BTreeSet<String> {
    let mut facts = BTreeSet::new();
    facts.insert(format!("humans {}", reading.humans.len()));
    facts.extend(reading.place.map(|place| format!("place {place}")));
    for fact in &reading.facts {
        match &fact.kind {
            FactKind::RobotSays(sign) => facts.insert(format!("robot says {sign}")),
            FactKind::RobotStart(place) => facts.insert(format!("robot start {place}")),
            FactKind::RobotGoal(place) => facts.insert(format!("robot goal {place}")),
            FactKind::Group { members, .. } => {
                let members: Vec<String> = members.iter().map(|member| member.number().to_string()).collect();
                facts.insert(format!("group {}", members.join(" ")))
            }
            FactKind::Gestures { human, gesture } => facts.insert(format!("{} says {gesture}", human.number())),
            _ => false,
        };
    }
    for human in &reading.humans {
        let n = human.id.number();
        facts.insert(format!("{n} role {}", human.role));
        facts.extend(human.relation.map(|relation| format!("{n} {}", relation.name())));
        let mut before: Option<&socrates_model::Rule> = None;
        for rule in &human.rules {
            facts.extend(rule.gesture.map(|sign| format!("{n} says {sign}")));
            let act = format!("{n}: {}", old_act(&rule.act));
            facts.insert(act.clone());
            facts.extend(rule.for_s.map(|secs| format!("{act} for {}", number(secs))));
            for trigger in &rule.when {
                facts.extend(
                    old_cue(trigger, human.relation == Some(socrates_model::Relation::Ahead))
                        .into_iter()
                        .map(|cue| format!("{act} {cue}")),
                );
            }
            if let Some(secs) = before.filter(|before| before.when == rule.when).and_then(|before| before.for_s) {
                facts.insert(format!("{act} when after"));
                facts.insert(format!("{act} at {}", number(secs)));
            }
            before = Some(rule);
        }
    }
    facts
}

fn old_act(act: &socrates_model::Action) -> String {
    match act {
        socrates_model::Action::FollowHuman(id) => format!("follow_human {}", id.number()),
        other => serde_json::to_value(other)
            .ok()
            .and_then(|value| value.as_str().map(str::to_owned))
            .unwrap_or_else(|| "other".to_owned()),
    }
}

fn old_cue(trigger: &socrates_model::Trigger, ahead: bool) -> Vec<String> {
    use socrates_model::Trigger as T;
    let at = |kind: &str, m: f64| vec![format!("when {kind}"), format!("at {}", number(m))];
    match trigger {
        T::RobotVisible(m) => at("visible", *m),
        T::RobotNear(m) if ahead => [at("near", *m), at("visible", *m)].concat(),
        T::RobotNear(m) => at("near", *m),
        T::RobotBlocking(m) => at("blocking", *m),
        T::RobotMoving => vec!["when moving".to_owned()],
        T::RobotStopped => vec!["when stopped".to_owned()],
        T::RobotPassed => vec!["when passed".to_owned()],
        T::RobotSays(sign) => vec![format!("when robot_says {sign}")],
        T::HumanSays(id, sign) => vec![format!("when human_says {} {sign}", id.number())],
        T::GoalReached => vec!["when goal".to_owned()],
        T::AtEncounter => vec!["when encounter".to_owned()],
        T::AfterSecs(secs) => at("after", *secs),
        T::Always | T::StoppedFor(_) | T::Did(..) | T::Done(_) => Vec::new(),
    }
}
