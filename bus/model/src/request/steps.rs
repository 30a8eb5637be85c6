//! The steps of `does` and `reacts`: each by itself, and what they wait for together.

use super::form::{Names, Naming};
use super::read::{Door, GESTURES, Section};
use super::tree::{Kind, Node, TextPlace};
use super::words::Words;
use crate::act::{ACTS, ActWay};
use crate::form::{Deed, Form, FormHuman, Step, When};
use crate::gesture::Gesture;
use crate::rule::TRIGGERS;

const STEP_KEYS: [&str; 6] = ["when", "act", "for_s", "until", "say", "to"];
/// Steps of `does`, and of `reacts`.
const MOST_STEPS: usize = 12;
/// Longest time of a step, s.
const MOST_S: f64 = 600.0;

fn triggers() -> Words {
    let all = TRIGGERS.iter().map(|row| (row.word, row.toml())).collect();
    Words { what: "trigger", all, more: ", or a list of them" }
}

fn signs() -> Words {
    let all = Gesture::ALL.iter().map(|sign| (sign.name(), sign.name().to_owned())).collect();
    Words { what: "sign", all, more: "" }
}

fn acts() -> Words {
    Words { what: "act", all: ACTS.iter().map(|row| (row.word, row.toml())).collect(), more: "" }
}

impl Door<'_> {
    /// The steps of `does` or `reacts`.
    pub(super) fn steps<'n>(
        &mut self,
        section: &Section<'n>,
        (key, path): (&'static str, &'static str),
        names: &mut Names<'n>,
    ) -> Vec<Step> {
        let Some(node) = section.get(key) else { return Vec::new() };
        let Kind::List(nodes) = &node.kind else {
            let hint = "a list: [{ when = { robot_near = 2.0 }, act = \"give_way\" }]";
            self.bad(section.key(key), node.at, format!("is {}", node.kind.name()), hint);
            return Vec::new();
        };
        if nodes.len() > MOST_STEPS {
            self.bad(section.key(key), node.at, format!("has {} steps", nodes.len()), format!("at most {MOST_STEPS}"));
        }
        let mut steps: Vec<Step> = Vec::new();
        for node in nodes {
            let Some(step) = self.step(node, path, names) else { continue };
            if key == "reacts" && step.when.is_empty() {
                let hint = "when = { robot_near = 2.0 }, or \"always\"";
                self.bad(format!("{path}when"), node.at, "is missing", hint);
            } else if key == "reacts" && !step.until.is_empty() {
                let hint = "a rule is done as long as its `when` holds; what ends at a moment stands in `does`";
                self.bad(format!("{path}until"), node.at, "belongs to steps of `does`", hint);
            } else if key == "does" && steps.last().is_some_and(Step::is_endless) {
                let hint = "give the step before an end: for_s = 5.0, or until = \"robot_passed\"";
                self.bad(path.trim_end_matches('.'), node.at, "a step comes after one that never ends", hint);
            }
            steps.push(step);
        }
        steps
    }

    fn step<'n>(&mut self, node: &'n Node, path: &'static str, names: &mut Names<'n>) -> Option<Step> {
        let section = self.section(node, path, &STEP_KEYS);
        if !matches!(node.kind, Kind::Table(_)) {
            return None;
        }
        let when = self.whens(&section, "when", names);
        let until = self.whens(&section, "until", names);
        let act = section.get("act").and_then(|node| self.word_of::<Deed>(&section.key("act"), node, &acts()));
        if let (Some(act), Some(node)) = (&act, section.get("act")) {
            self.number(&section.key("act"), node, act.number());
            if let Some(name) = act.names() {
                let key = act.row().word;
                names.push(Naming { who: name.clone(), key, node: Some(node), robot: false, several: false });
            }
        }
        let for_s = self.maybe::<f64>(&section, "for_s", "0.1 to 600 (s)");
        if let Some(secs) = for_s.filter(|secs| !(0.1..=MOST_S).contains(secs)) {
            let at = section.get("for_s").and_then(|node| node.at);
            self.bad(section.key("for_s"), at, format!("{secs} s is out of range"), "0.1 to 600 (s)");
        }
        let say = section.get("say").and_then(|node| self.word_of::<Gesture>(&section.key("say"), node, &signs()));
        if section.get("act").is_none() && section.get("say").is_none() {
            self.bad(
                path.trim_end_matches('.'),
                node.at,
                "does nothing",
                format!("act: {}; say: {GESTURES}", Deed::allowed()),
            );
        }
        let to = self.to(&section, say.is_some(), names);
        Some(Step { when, act, for_s, until, say, to })
    }

    /// To whom a sign is made.
    fn to<'n>(&mut self, section: &Section<'n>, says: bool, names: &mut Names<'n>) -> Option<String> {
        let node = section.get("to")?;
        let to = self.maybe::<String>(section, "to", "\"robot\", \"all\" or the name of a person")?;
        if !says {
            self.bad(section.key("to"), node.at, "is said of a step without a sign", format!("say: {GESTURES}"));
        }
        if to != "all" {
            names.push(Naming { who: to.clone(), key: "to", node: Some(node), robot: true, several: false });
        }
        Some(to)
    }

    fn whens<'n>(&mut self, section: &Section<'n>, key: &'static str, names: &mut Names<'n>) -> Vec<When> {
        let Some(node) = section.get(key) else { return Vec::new() };
        let nodes: Vec<&Node> = if let Kind::List(nodes) = &node.kind { nodes.iter().collect() } else { vec![node] };
        let mut found = Vec::new();
        for node in nodes {
            let Some(when) = self.word_of::<When>(&section.key(key), node, &triggers()) else { continue };
            self.number(&section.key(key), node, when.number());
            if let Some(name) = when.names() {
                let several = matches!(when, When::Done(_));
                names.push(Naming { who: name.clone(), key: when.word(), node: Some(node), robot: false, several });
            }
            found.push(when);
        }
        found
    }

    /// Steps that are waited for and never end, or are not there, and steps that wait for each other.
    pub(super) fn waits(&mut self, form: &Form, top: &Section<'_>) {
        let nodes = list(top.get("human"));
        if nodes.len() != form.humans.len() {
            return;
        }
        for (who, (human, node)) in form.humans.iter().zip(nodes).enumerate() {
            let stands = human.relation.stands() && human.goal.is_none();
            for (number, step) in human.does.iter().enumerate() {
                let at = place(node, "does", number);
                if stands && matches!(step.act, Some(Deed::TurnBack | Deed::ChangePace(_))) {
                    let hint = "`frontal`, `crossing`, `leaving` or another relation of somebody who walks";
                    self.bad("human.does.act", at, "walks, but stands by its relation", hint);
                }
                if !stands && step.act == Some(Deed::MakeRoom) {
                    let hint = "relation = \"static\", alone or in a group; whoever walks gives way: give_way";
                    self.bad("human.does.act", at, "makes room, but walks by its relation", hint);
                }
                let own = |name: &&String| meant(form, name).contains(&who) && human.count == 1;
                if step.to.as_ref().filter(own).is_some()
                    || step.act.as_ref().and_then(Deed::names).filter(own).is_some()
                {
                    self.bad("human.does", at, "is done to themselves", "the name of somebody else");
                }
            }
            let for_good = |act: &Deed| act.row().way == ActWay::New || matches!(act, Deed::ChangePace(_));
            for rule in human.reacts.iter().filter(|rule| rule.act.as_ref().is_some_and(for_good)) {
                let at = human
                    .reacts
                    .iter()
                    .position(|other| other == rule)
                    .and_then(|number| place(node, "reacts", number));
                self.bad("human.reacts.act", at, "changes the way or the pace for good", "a step of `does`");
            }
            for (key, steps) in [("does", &human.does), ("reacts", &human.reacts)] {
                for (number, step) in steps.iter().enumerate() {
                    for (part, when) in [("when", &step.when), ("until", &step.until)] {
                        for trigger in when {
                            if let Some((found, hint)) = never_ends(form, trigger) {
                                self.bad(format!("human.{key}.{part}"), place(node, key, number), found, hint);
                            }
                        }
                    }
                }
            }
        }
        let starts: Vec<(usize, usize)> = (0..form.humans.len())
            .flat_map(|who| (0..form.humans.get(who).map_or(0, |human| human.does.len())).map(move |step| (who, step)))
            .collect();
        let mut told: Vec<(usize, usize)> = Vec::new();
        for start in starts {
            let Some(circle) = circle(form, start) else { continue };
            if told.contains(&start) {
                continue;
            }
            let words: Vec<String> =
                circle.iter().map(|(who, step)| format!("step {} of {}", step + 1, name(form, *who))).collect();
            told.extend(&circle);
            let found = format!(
                "{} waits for itself: {}",
                words.first().cloned().unwrap_or_default(),
                words.join(" waits for ")
            );
            let at = nodes.get(start.0).and_then(|node| place(node, "does", start.1));
            self.bad("human.does.when", at, found, "remove one of the triggers `did` and `done`");
        }
    }
}

fn list(node: Option<&Node>) -> &[Node] {
    if let Some(Kind::List(nodes)) = node.map(|node| &node.kind) { nodes } else { &[] }
}

/// Where a step of somebody stands.
fn place(human: &Node, key: &str, number: usize) -> Option<TextPlace> {
    let Kind::Table(entries) = &human.kind else { return human.at };
    let steps = entries.iter().find(|(name, ..)| name == key).map(|(.., steps)| steps);
    list(steps).get(number).and_then(|step| step.at).or(human.at)
}

/// What somebody is called.
fn name(form: &Form, who: usize) -> String {
    let first: u32 = form.humans.iter().take(who).map(|human| human.count).sum();
    let own = form.humans.get(who).and_then(|human| human.id.clone());
    own.unwrap_or_else(|| format!("human_{}", first + 1))
}

/// The places in the form of the people whom a name means.
fn meant(form: &Form, name: &str) -> Vec<usize> {
    let mut found = Vec::new();
    for id in form.named(name) {
        let mut upto = 0;
        let who = form.humans.iter().position(|human| {
            upto += human.count;
            id.number() <= upto
        });
        found.extend(who.filter(|who| !found.contains(who)));
    }
    found
}

/// Faults of waiting for somebody's steps.
pub(super) fn never_ends(form: &Form, trigger: &When) -> Option<(String, String)> {
    let (When::Did(name, _) | When::Done(name)) = trigger else { return None };
    let end = || "give that step an end: for_s = 5.0, or until = \"robot_passed\"".to_owned();
    let wrong = |human: &FormHuman| {
        if let When::Did(_, number) = trigger {
            let place = usize::try_from(*number).ok().and_then(|number| number.checked_sub(1));
            let steps = human.does.len();
            let Some(step) = place.and_then(|place| human.does.get(place)) else {
                let hint = if steps == 0 { "none in `does`".to_owned() } else { format!("1 to {steps}") };
                return Some((format!("`{name}` has no step {number}"), hint));
            };
            return step.is_endless().then(|| (format!("step {number} of `{name}` never ends"), end()));
        }
        if human.does.last().is_some_and(Step::is_endless) {
            return Some((format!("the last step of `{name}` never ends"), end()));
        }
        let hint = "say what they do, as steps of `does`".to_owned();
        never_done(human).then(|| (format!("`{name}` stands and has no steps, and is never done"), hint))
    };
    meant(form, name).into_iter().filter_map(|who| form.humans.get(who)).find_map(wrong)
}

fn never_done(human: &FormHuman) -> bool {
    human.does.is_empty() && human.goal.is_none() && human.relation.stands()
}

/// Steps that have to be over before this one is: each with whoever does it.
fn before(form: &Form, (who, step): (usize, usize)) -> Vec<(usize, usize)> {
    let Some(human) = form.humans.get(who) else { return Vec::new() };
    let Some(own) = human.does.get(step) else { return Vec::new() };
    let mut found: Vec<(usize, usize)> = step.checked_sub(1).map(|step| (who, step)).into_iter().collect();
    for trigger in own.when.iter().chain(&own.until) {
        let (When::Did(name, _) | When::Done(name)) = trigger else { continue };
        for other in meant(form, name) {
            let last = form.humans.get(other).and_then(|human| human.does.len().checked_sub(1));
            let number = if let When::Did(_, number) = trigger {
                usize::try_from(*number).ok().and_then(|number| number.checked_sub(1))
            } else {
                last
            };
            found
                .extend(number.filter(|number| last.is_some_and(|last| *number <= last)).map(|number| (other, number)));
        }
    }
    found
}

/// The way from a step back to itself through what has to be over before it.
fn circle(form: &Form, start: (usize, usize)) -> Option<Vec<(usize, usize)>> {
    let mut ways: Vec<Vec<(usize, usize)>> = vec![vec![start]];
    let mut seen: Vec<(usize, usize)> = Vec::new();
    let mut next = 0;
    while let Some(way) = ways.get(next).cloned() {
        next += 1;
        let Some(last) = way.last().copied() else { continue };
        for step in before(form, last) {
            if step == start {
                return Some(way.into_iter().chain([start]).collect());
            }
            if !seen.contains(&step) {
                seen.push(step);
                ways.push(way.iter().copied().chain([step]).collect());
            }
        }
    }
    None
}
