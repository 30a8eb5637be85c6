//! Both readers over the same requests, as the layers above see them: facts of the corpora, shipped requests, texts of cards.
//!
//! `cargo run -p socrates-offline --example readers -- [--list] [--kinds] [--aside]`: `--list` prints every shipped request and card that is
//! read otherwise, `--kinds` what each reader gets right of every kind of fact. A quarter of the open corpora, and the sets kept aside, count
//! in one line, and only with `--aside`.

#![expect(clippy::print_stdout, clippy::wildcard_enum_match_arm, reason = "a report for people, of some facts")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Deserialize;
use socrates_model::{Action, FactKind, Location, ReadBy, Reading, Request, Trigger};

#[derive(Deserialize)]
struct Corpus {
    request: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    on: String,
    text: String,
    facts: Vec<String>,
}

/// Right facts of the grammar and of the small reader.
#[derive(Default, Clone, Copy)]
struct Count {
    facts: usize,
    grammar: usize,
    small: usize,
}

impl Count {
    fn add(&mut self, (grammar, small): (bool, bool)) {
        self.facts += 1;
        self.grammar += usize::from(grammar);
        self.small += usize::from(small);
    }

    fn line(&self, name: &str) -> String {
        let share = |part: usize| 100.0 * part as f64 / self.facts.max(1) as f64;
        let (old, new) = (share(self.grammar), share(self.small));
        format!("{name:<28} {:>6} facts  grammar {old:>5.1} %  small {new:>5.1} %", self.facts)
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let flag = |flag: &str| words.iter().any(|word| word == flag);
    corpora(flag("--kinds"), flag("--aside"));
    let mut shipped = Vec::new();
    for location in ["hospital", "office", "warehouse"] {
        for (name, text) in socrates_maps::shipped::requests(location) {
            let Ok(request) = Request::of_toml(text, None) else { continue };
            shipped.push((format!("{location}/{name}"), request));
        }
    }
    told("shipped requests", &shipped, flag("--list"));
    let mut cards = Vec::new();
    for card in socrates_offline::catalog() {
        for location in ["hospital", "office", "warehouse"] {
            let request = serde_json::json!({
                "location": location, "social_context": "", "task": "Deliver mail", "rough_scenario": card.about,
            });
            let Ok(request) = serde_json::from_value::<Request>(request) else { continue };
            cards.push((format!("{} on {location}", card.id), request));
        }
    }
    told("texts of cards", &cards, flag("--list"));
}

/// How many requests are read the same, and what differs.
fn told(what: &str, requests: &[(String, Request)], list: bool) {
    let (mut same, mut pieces, mut pattern) = (0, 0, 0);
    for (name, request) in requests {
        let Ok(location) = socrates_maps::shipped::load(&request.location) else { continue };
        let [old, new] = [ReadBy::Grammar, ReadBy::Small].map(|by| socrates_offline::read_by(request, &location, by));
        let (before, after) = (facts(&old), facts(&new));
        let told = |reading: &Reading| reading.missing().join(" | ");
        pieces += usize::from(told(&old) == told(&new));
        pattern += usize::from(old.pattern == new.pattern);
        same += usize::from(before == after);
        if list && (before != after || told(&old) != told(&new)) {
            println!("\n{name}: {}", request.rough_scenario.as_deref().unwrap_or_default().trim());
            println!("   grammar {:?}, small {:?}", old.pattern, new.pattern);
            before.difference(&after).for_each(|fact| println!("   - {fact}"));
            after.difference(&before).for_each(|fact| println!("   + {fact}"));
            println!("   missing by the grammar: {}\n   missing by the small reader: {}", told(&old), told(&new));
        }
    }
    let all = requests.len();
    println!(
        "{what}: {same} of {all} have the same facts, {pattern} the same pattern, {pieces} the same words that are missing"
    );
}

fn corpora(kinds: bool, aside: bool) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let mut names: Vec<_> =
        std::fs::read_dir(&folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).collect();
    names.sort();
    let mut locations: BTreeMap<String, Location> = BTreeMap::new();
    let (mut open, mut held) = (Count::default(), Count::default());
    let mut by_kind: BTreeMap<String, Count> = BTreeMap::new();
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
            let request = serde_json::from_value::<Request>(serde_json::json!({
                "location": case.on, "social_context": "", "task": "Deliver mail", "rough_scenario": case.text,
            }));
            let Ok(request) = request else { continue };
            let [old, new] =
                [ReadBy::Grammar, ReadBy::Small].map(|by| facts(&socrates_offline::understood(&request, location, by)));
            let is_aside = sealed || hash(&case.text).is_multiple_of(4);
            for fact in case.facts.iter().filter(|fact| !fact.starts_with("problem") && !fact.starts_with("ignored")) {
                let right = (holds(fact, &old), holds(fact, &new));
                if is_aside {
                    held.add(right);
                } else {
                    open.add(right);
                    by_kind.entry(kind(fact)).or_default().add(right);
                }
            }
        }
    }
    println!("{}", open.line("corpora, worked on"));
    if aside {
        println!("{}", held.line("held out and kept aside"));
    }
    let mut lines: Vec<(&String, &Count)> = by_kind.iter().filter(|_| kinds).collect();
    lines.sort_by_key(|(_, count)| std::cmp::Reverse(count.grammar.saturating_sub(count.small)));
    for (kind, count) in lines {
        println!("  {kind:<26} {:>5} facts  grammar {:>5}  small {:>5}", count.facts, count.grammar, count.small);
    }
}

fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn holds(fact: &str, facts: &BTreeSet<String>) -> bool {
    fact.strip_prefix("not ").map_or_else(|| facts.contains(fact), |rest| !holds(rest, facts))
}

/// The kind of construct of which a fact is: its words without numbers and names.
fn kind(fact: &str) -> String {
    let is_name =
        |word: &&str| word.trim_end_matches(':').parse::<f64>().is_err() && !word.chars().any(char::is_uppercase);
    let words: Vec<&str> = fact.split_whitespace().filter(is_name).collect();
    let first = words.first().copied().unwrap_or_default();
    match words[..] {
        ["role" | "place", ..] => first.to_owned(),
        ["not", "role" | "place", ..] => words.iter().take(2).copied().collect::<Vec<_>>().join(" "),
        ["robot", part, ..] => format!("robot {part}"),
        _ => words.join(" "),
    }
}
fn number(value: f64) -> String {
    format!("{value}")
}

fn facts(reading: &Reading) -> BTreeSet<String> {
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

fn old_act(act: &Action) -> String {
    match act {
        Action::FollowHuman(id) => format!("follow_human {}", id.number()),
        other => serde_json::to_value(other)
            .ok()
            .and_then(|value| value.as_str().map(str::to_owned))
            .unwrap_or_else(|| "other".to_owned()),
    }
}

fn old_cue(trigger: &socrates_model::Trigger, ahead: bool) -> Vec<String> {
    use Trigger as T;
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
