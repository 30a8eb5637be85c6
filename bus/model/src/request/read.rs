//! The one door of requests: a text or a JSON value in, a request or everything that is wrong with it out.
//!
//! ```text
//! TOML text ─┐
//!            ├─► values with places ─► typed keys ─► checks across keys ─► Request
//! JSON value ┘            └──────────────┴──────────────┴────────────────► Vec<BadRequest>
//! ```
//!
//! Whether a location, a pinned file or an author's server is there is looked at by whoever has them.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::form::Names;
use super::tree::{Kind, Node, TextPlace};
use super::{
    AuthorSpec, BadRequest, Breadth, Duration, Expect, GROUP_SIZES, MAX_HUMANS, MAX_TEXT_CHARS, MAX_VARIANTS, Moment,
    Request, RobotGesture, RobotRequest, RunRequest, Seeds,
};
use crate::fault::FaultCode;
use crate::form::Form;
use crate::planner_name::PlannerName;
use crate::robot::RobotModel;

/// Keys of a request.
const KEYS: [&str; 16] = [
    "location",
    "social_context",
    "task",
    "rough_scenario",
    "location_description",
    "robot",
    "people",
    "run",
    "expect",
    "waive",
    "human",
    "group",
    "order",
    "proposal",
    "paths",
    "behaviors",
];

/// What may be said.
pub(super) const GESTURES: &str = "WAIT, PROCEED, ACKNOWLEDGED, EXCUSE_ME or FOLLOW_ME";

impl Request {
    /// Reads a request as written in its file. Of `planners`, where they are given, every planner must be one.
    ///
    /// # Errors
    /// Everything that is wrong with it at once, in the order of the text.
    pub fn of_toml(text: &str, planners: Option<&[&str]>) -> Result<Self, Vec<BadRequest>> {
        let node = Node::of_toml(text).map_err(|errors| {
            let bad = |error: super::tree::BadText| BadRequest {
                code: FaultCode::JRequest,
                key: String::new(),
                found: error.message,
                hint: "a request is a TOML file".to_owned(),
                at: error.at,
            };
            errors.into_iter().map(bad).collect::<Vec<_>>()
        })?;
        of_node(&node, planners)
    }

    /// Reads a request out of a JSON value.
    ///
    /// # Errors
    /// Everything that is wrong with it at once.
    pub fn of_json(value: &Value, planners: Option<&[&str]>) -> Result<Self, Vec<BadRequest>> {
        of_node(&Node::of_json(value), planners)
    }
}

fn of_node(node: &Node, planners: Option<&[&str]>) -> Result<Request, Vec<BadRequest>> {
    let mut door = Door { problems: Vec::new(), planners, listed: Vec::new() };
    let request = door.request(node);
    let Door { mut problems, .. } = door;
    problems.sort_by_key(|bad| bad.at);
    match request {
        Some(request) if problems.is_empty() => Ok(request),
        _ => Err(problems),
    }
}

/// One table of the request.
pub(super) struct Section<'n> {
    /// Its key with a dot behind it, or nothing.
    path: &'static str,
    at: Option<TextPlace>,
    entries: BTreeMap<&'n str, &'n Node>,
}

impl<'n> Section<'n> {
    fn empty(path: &'static str) -> Self {
        Self { path, at: None, entries: BTreeMap::new() }
    }

    pub(super) fn key(&self, name: &str) -> String {
        format!("{}{name}", self.path)
    }

    pub(super) fn get(&self, name: &str) -> Option<&'n Node> {
        self.entries.get(name).copied()
    }
}

pub(super) struct Door<'p> {
    problems: Vec<BadRequest>,
    planners: Option<&'p [&'p str]>,
    /// Lists of words that a problem has named in full.
    listed: Vec<&'static str>,
}

impl Door<'_> {
    /// Whether a list has been named in full; from now on it has.
    pub(super) fn is_listed(&mut self, what: &'static str) -> bool {
        let known = self.listed.contains(&what);
        if !known {
            self.listed.push(what);
        }
        known
    }

    pub(super) fn bad(
        &mut self,
        key: impl Into<String>,
        at: Option<TextPlace>,
        found: impl Into<String>,
        hint: impl Into<String>,
    ) {
        let (key, found, hint) = (key.into(), found.into(), hint.into());
        self.problems.push(BadRequest { code: FaultCode::JRequest, key, found, hint, at });
    }

    /// The entries of a table; keys that it does not have are named.
    pub(super) fn section<'n>(&mut self, node: &'n Node, path: &'static str, known: &[&str]) -> Section<'n> {
        let name = path.trim_end_matches('.');
        let Kind::Table(entries) = &node.kind else {
            let found = format!("is {}", node.kind.name());
            let hint = if name.is_empty() { "a table".to_owned() } else { format!("a table: [{name}]") };
            self.bad(name, node.at, found, hint);
            return Section::empty(path);
        };
        let mut section = Section { path, at: node.at, entries: BTreeMap::new() };
        for (key, at, value) in entries {
            if known.contains(&key.as_str()) {
                section.entries.insert(key, value);
            } else {
                let shown: String = key.chars().take(80).collect();
                let inside = if name.is_empty() { String::new() } else { format!(" in [{name}]") };
                self.bad(
                    section.key(&shown),
                    *at,
                    "is not a key of a request",
                    format!("keys{inside}: {}", known.join(", ")),
                );
            }
        }
        section
    }

    /// A value that reads itself out of what stands there.
    pub(super) fn typed<T: DeserializeOwned>(&mut self, key: &str, node: &Node, hint: &str) -> Option<T> {
        if let Kind::Odd(name) = node.kind {
            self.bad(key, node.at, format!("is {name}"), hint);
            return None;
        }
        match serde_json::from_value(node.value()) {
            Ok(value) => Some(value),
            Err(why) => {
                self.bad(key, node.at, why.to_string(), hint);
                None
            }
        }
    }

    /// The value of a key that may be left out.
    pub(super) fn maybe<T: DeserializeOwned>(&mut self, section: &Section<'_>, name: &str, hint: &str) -> Option<T> {
        // In JSON a key that is left out may be written as null.
        let node = section.get(name).filter(|node| !matches!(node.kind, Kind::Plain(Value::Null)))?;
        self.typed(&section.key(name), node, hint)
    }

    /// The text of a key, bounded.
    fn text(&mut self, section: &Section<'_>, name: &'static str) -> Option<String> {
        let text: String = self.maybe(section, name, "a text in quotation marks")?;
        let at = section.get(name).and_then(|node| node.at);
        for (found, hint) in text_problems(&text) {
            self.bad(section.key(name), at, found, hint);
        }
        Some(text)
    }

    /// The same of a key that must be there.
    fn needed(&mut self, section: &Section<'_>, name: &'static str, hint: &str) -> Option<String> {
        if section.get(name).is_none() {
            self.bad(name, section.at, "is missing", hint);
            return None;
        }
        self.text(section, name)
    }

    fn request(&mut self, node: &Node) -> Option<Request> {
        let top = self.section(node, "", &KEYS);
        let location = self.needed(&top, "location", "a shipped name or a folder");
        let (form, mut names) = self.form(&top);
        // A form says who is there without a social context.
        let social_context = if top.get("human").is_none() || top.get("social_context").is_some() {
            self.needed(&top, "social_context", "where and among whom the robot works, in a sentence")
        } else {
            Some(String::new())
        };
        let task_hint = "say what the robot has to do, for example \"Deliver coffee to the meeting room\"";
        let task = self.needed(&top, "task", task_hint);
        if task.as_deref().is_some_and(|task| task.trim().is_empty()) {
            self.bad("task", top.get("task").and_then(|node| node.at), "is empty", task_hint);
        }
        let file = "the name of a file beside the request";
        let robot = top.get("robot").map(|node| self.robot(node, &form, &mut names)).unwrap_or_default();
        let expect = top.get("expect").map(|node| self.expect(node)).unwrap_or_default();
        self.names(&form, &names);
        self.against(&form, &expect, &top);
        let people = top.get("people").map(|node| self.people(node, &form, &expect)).unwrap_or_default();
        let rough_scenario = self.text(&top, "rough_scenario");
        let texts = [rough_scenario.as_deref(), task.as_deref(), social_context.as_deref()];
        let waive = top.get("waive").map(|node| self.waive(node, &texts)).unwrap_or_default();
        Some(Request {
            rough_scenario,
            waive,
            location_description: self.text(&top, "location_description"),
            robot,
            people,
            form,
            run: top.get("run").map(|node| self.run(node)).unwrap_or_default(),
            expect,
            proposal: self.maybe(&top, "proposal", file),
            paths: self.maybe(&top, "paths", file),
            behaviors: self.maybe(&top, "behaviors", file),
            location: location?,
            social_context: social_context?,
            task: task?,
        })
    }

    /// Words that are given up: each must stand in one of the texts.
    fn waive(&mut self, node: &Node, texts: &[Option<&str>]) -> Vec<String> {
        const KEY: &str = "waive";
        let Kind::List(nodes) = &node.kind else {
            let hint = "a list of quotes of the texts: [\"and then he sings\"]";
            self.bad(KEY, node.at, format!("is {}", node.kind.name()), hint);
            return Vec::new();
        };
        let mut quotes = Vec::new();
        for node in nodes {
            let Some(quote) = self.typed::<String>(KEY, node, "words of the texts, in quotation marks") else {
                continue;
            };
            let stands = !quote.trim().is_empty() && texts.iter().flatten().any(|text| text.contains(quote.trim()));
            if stands {
                quotes.push(quote.trim().to_owned());
            } else {
                let shown: String = quote.chars().take(80).collect();
                let found = format!("`{shown}` stands in none of the texts");
                self.bad(KEY, node.at, found, "copy the words as they stand in rough_scenario, task or social_context");
            }
        }
        quotes
    }

    fn robot<'n>(&mut self, node: &'n Node, form: &Form, names: &mut Names<'n>) -> RobotRequest {
        let keys =
            ["model", "planners", "waypoints", "gestures", "nav2", "start", "goal", "via", "avoid", "return", "does"];
        let section = self.section(node, "robot.", &keys);
        let nav2 = section.get("nav2").map(|node| self.nav2(node)).unwrap_or_default();
        let unset = RobotRequest::default();
        RobotRequest {
            model: self.maybe(&section, "model", RobotModel::ALLOWED).unwrap_or(unset.model),
            planners: section.get("planners").map_or(unset.planners, |node| self.planners(node, &nav2)),
            nav2,
            waypoints: self.maybe(&section, "waypoints", "\"ends\", \"via\" or \"all\"").unwrap_or(unset.waypoints),
            gestures: section.get("gestures").map_or(unset.gestures, |node| self.gestures(node)),
            start: self.place(&section, "start"),
            goal: self.place(&section, "goal"),
            via: self.place(&section, "via"),
            avoid: self.places(&section, "avoid"),
            returns: self.maybe(&section, "return", "true, or false").unwrap_or(false),
            does: self.robot_steps(&section, form, names),
        }
    }

    /// Planners by name, each with a parameter file of Nav2 or its text.
    fn nav2(&mut self, node: &Node) -> BTreeMap<PlannerName, String> {
        const KEY: &str = "robot.nav2";
        let Kind::Table(_) = &node.kind else {
            self.bad(KEY, node.at, format!("is {}", node.kind.name()), "a table: { mine = \"nav2_params.yaml\" }");
            return BTreeMap::new();
        };
        let Some(found) = self.typed::<BTreeMap<PlannerName, String>>(KEY, node, "{ mine = \"nav2_params.yaml\" }")
        else {
            return BTreeMap::new();
        };
        for name in found.keys() {
            if name.external().is_some() || self.planners.is_some_and(|known| known.contains(&name.as_str())) {
                self.bad(KEY, node.at, format!("`{name}` is a planner already"), "a name of your own");
            }
        }
        found
    }

    fn planners(&mut self, node: &Node, nav2: &BTreeMap<PlannerName, String>) -> Vec<PlannerName> {
        const KEY: &str = "robot.planners";
        let Kind::List(nodes) = &node.kind else {
            self.bad(KEY, node.at, format!("is {}", node.kind.name()), "a list: [\"reference\", \"reactive\"]");
            return Vec::new();
        };
        let mut named = Vec::new();
        for node in nodes {
            let hint = self.planners.map_or_else(|| "the name of a planner".to_owned(), |known| known.join(", "));
            let Some(planner) = self.typed::<PlannerName>(KEY, node, &hint) else { continue };
            if self.planners.is_some_and(|known| {
                planner.external().is_none() && !nav2.contains_key(&planner) && !known.contains(&planner.as_str())
            }) {
                let (found, hint) = (format!("there is no planner `{planner}`"), format!("planners: {hint}"));
                self.problems.push(BadRequest {
                    code: FaultCode::JPlanner,
                    key: KEY.to_owned(),
                    found,
                    hint,
                    at: node.at,
                });
            }
            named.push(planner);
        }
        named
    }

    fn gestures(&mut self, node: &Node) -> Vec<RobotGesture> {
        let form = "{ when = \"blocked 3 s\", say = \"EXCUSE_ME\" }";
        let Kind::List(nodes) = &node.kind else {
            self.bad("robot.gestures", node.at, format!("is {}", node.kind.name()), format!("a list: [{form}]"));
            return Vec::new();
        };
        let mut made = Vec::new();
        for node in nodes {
            let section = self.section(node, "robot.gestures.", &["when", "say"]);
            for name in ["when", "say"] {
                if section.get(name).is_none() && matches!(node.kind, Kind::Table(_)) {
                    self.bad(section.key(name), node.at, "is missing", form);
                }
            }
            let when: Option<Moment> = self.maybe(&section, "when", Moment::ALLOWED);
            let say = self.maybe(&section, "say", GESTURES);
            made.extend(when.zip(say).map(|(when, say)| RobotGesture { when, say }));
        }
        made
    }

    fn run(&mut self, node: &Node) -> RunRequest {
        let section = self.section(node, "run.", &["seeds", "duration", "author", "variants", "breadth"]);
        let unset = RunRequest::default();
        let variants_hint = format!("1 to {MAX_VARIANTS}");
        let variants: Option<u32> = self.maybe(&section, "variants", &variants_hint);
        if let Some(count) = variants.filter(|count| *count == 0 || *count > MAX_VARIANTS) {
            let at = section.get("variants").and_then(|node| node.at);
            self.bad("run.variants", at, format!("{count} is out of range"), variants_hint);
        }
        RunRequest {
            seeds: self.maybe::<Seeds>(&section, "seeds", &format!("a text in quotation marks: {}", Seeds::ALLOWED)),
            duration: self
                .maybe::<Duration>(&section, "duration", "\"auto\" or \"60s\" (1 to 600 s)")
                .unwrap_or(unset.duration),
            author: self.maybe::<AuthorSpec>(&section, "author", AuthorSpec::ALLOWED).unwrap_or(unset.author),
            variants: variants.unwrap_or(unset.variants),
            breadth: self.maybe::<Breadth>(&section, "breadth", "\"usual\" or \"wide\"").unwrap_or(unset.breadth),
        }
    }

    fn expect(&mut self, node: &Node) -> Expect {
        let section = self.section(node, "expect.", &["humans", "place", "groups", "pattern"]);
        let humans_hint = format!("1 to {MAX_HUMANS}; a social scenario needs somebody to meet");
        let humans: Option<u32> = self.maybe(&section, "humans", &humans_hint);
        if let Some(count) = humans.filter(|count| *count == 0 || *count > MAX_HUMANS) {
            let at = section.get("humans").and_then(|node| node.at);
            self.bad("expect.humans", at, format!("{count} humans"), humans_hint);
        }
        let groups: Option<Vec<Vec<u32>>> = self.maybe(&section, "groups", "lists of numbers of humans: [[1, 2]]");
        let groups = groups.unwrap_or_default();
        if let Some(Node { kind: Kind::List(nodes), .. }) = section.get("groups") {
            self.groups(&groups, nodes, humans);
        }
        let place: Option<String> = self.maybe(&section, "place", "a place class");
        let place = place.and_then(|text| match text.parse::<crate::PlaceClass>() {
            Ok(class) => Some(class),
            Err(bad) => {
                let at = section.get("place").and_then(|node| node.at);
                self.bad("expect.place", at, bad.to_string(), bad.allowed);
                None
            }
        });
        Expect { humans, place, groups, pattern: self.maybe(&section, "pattern", "the id of a canonical scenario") }
    }

    /// What is wrong with the groups: members that are nobody, or somebody twice.
    fn groups(&mut self, groups: &[Vec<u32>], nodes: &[Node], humans: Option<u32>) {
        const KEY: &str = "expect.groups";
        let most = humans.unwrap_or(MAX_HUMANS).min(MAX_HUMANS);
        let mut seen: Vec<u32> = Vec::new();
        for (group, node) in groups.iter().zip(nodes) {
            if !GROUP_SIZES.contains(&group.len()) {
                let hint = format!("{} to {} members", GROUP_SIZES.start(), GROUP_SIZES.end());
                self.bad(KEY, node.at, format!("{group:?} has {} members", group.len()), hint);
            }
            for member in group {
                if *member == 0 || *member > most {
                    let hint = format!("numbers of humans, 1 to {most}");
                    self.bad(KEY, node.at, format!("{group:?} names human_{member}"), hint);
                }
                if seen.contains(member) {
                    let found = format!("{group:?} names human_{member} again");
                    self.bad(KEY, node.at, found, "each human is in one group at most");
                }
                seen.push(*member);
            }
        }
    }
}

/// What is wrong with a text, each with a hint.
fn text_problems(text: &str) -> Vec<(String, &'static str)> {
    let mut problems = Vec::new();
    let length = text.chars().count();
    if length > MAX_TEXT_CHARS {
        problems.push((format!("has {length} characters"), "at most 8000; a few sentences are enough"));
    }
    if let Some(control) = text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\r' | '\t')) {
        problems.push((
            format!("holds the control character U+{:04X}", u32::from(control)),
            "remove it; only text, line breaks and tabs are taken",
        ));
    }
    if matches!(text.trim(), "None" | "none" | "NONE" | "null" | "nil") {
        problems.push((format!("is the word `{}`", text.trim()), "leave the key out for an unguided scenario"));
    }
    problems
}
