//! From YAML to [`AgentsFile`], with every problem named at once.

use std::collections::BTreeMap;

use socrates_model::Point;

use super::file::{AgentEntry, AgentsFile, BehaviorEntry, Configuration, Dialect, GoalEntry, InitPose, Reaction};
use super::lines::Lines;
use super::node::{Node, parse};
use super::section::{Found, Range, Section};
use crate::configure::{Limits, limits};
use crate::problem::{Problem, nearest, shortened};

/// Most agents of a file.
pub const MAX_AGENTS: usize = 10_000;
/// Outermost keys of a file.
const ROOT: [&str; 2] = ["hunav_loader", "ros__parameters"];
const METERS: Range = Range { least: -1e6, most: 1e6, unit: "m" };
const ANGLE: Range = Range { least: -1e3, most: 1e3, unit: "rad" };
const RADIUS: Range = Range { least: 0.05, most: 2.0, unit: "m" };
const SPEED: Range = Range { least: 0.0, most: 10.0, unit: "m/s" };
const NEAR: Range = Range { least: 0.0, most: 100.0, unit: "m" };
const SPAN: Range = Range { least: 0.0, most: 86_400.0, unit: "s" };
const FACTOR: Range = Range { least: -1e6, most: 1e6, unit: "" };

impl AgentsFile {
    /// Reads an agents file of any dialect; `file` is its name in messages.
    ///
    /// # Errors
    /// Every problem at once, with line, section, key, value and what would be taken: YAML that cannot be read, missing
    /// and unknown keys, integers written as doubles and the other way round, values out of range, ids given twice,
    /// goals that do not exist, gaps in `global_goals`, no agents.
    pub fn read(text: &str, file: &str) -> Result<Self, Vec<Problem>> {
        let root = parse(text, file)?;
        let mut found = Found { file: file.to_owned(), problems: Vec::new() };
        let read = document(&root, &mut found);
        let mut problems = found.problems;
        if !problems.is_empty() {
            let lines = Lines::of(text).inside(&ROOT.join("."));
            for problem in &mut problems {
                if !problem.place.is_empty() {
                    problem.line = lines.line(&problem.place);
                }
            }
        }
        match read {
            Some(mut read) if !problems.iter().any(Problem::is_error) => {
                read.warnings = problems;
                Ok(read)
            }
            Some(_) | None => {
                problems.retain(Problem::is_error);
                Err(problems)
            }
        }
    }
}

/// The parameters below the two outermost keys.
fn document(root: &Node, found: &mut Found) -> Option<AgentsFile> {
    let Node::Map(entries) = root else {
        let hint = "it starts with `hunav_loader:` and `  ros__parameters:`";
        found.error("", &root.shown(), "an agents file is a section", hint);
        return None;
    };
    let mut node = root;
    let mut place = String::new();
    let mut level = entries;
    for key in ROOT {
        let known = level.iter().find(|(name, _)| name == key);
        for (name, _) in level.iter().filter(|(name, _)| name != key) {
            let meant = nearest(name, [key]).map_or_else(String::new, |key| format!("did you mean `{key}`? "));
            if known.is_none() {
                found.error("", &shortened(name), format!("there is no `{key}`"), format!("{meant}it must be there"));
            } else {
                found.warning("", &shortened(name), "is a section of another node", "it is not read");
            }
        }
        let Some((_, next)) = known else {
            if level.is_empty() {
                found.error(&place, "", format!("there is no `{key}`"), "it must be there");
            }
            return None;
        };
        place = if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
        node = next;
        let Node::Map(inner) = next else {
            found.error(&place, &next.shown(), "must be a section with keys", "indent its keys below it");
            return None;
        };
        level = inner;
    }
    let section = Section::of(node, "", found)?;
    Some(parameters(section, found))
}

fn parameters(mut section: Section<'_>, found: &mut Found) -> AgentsFile {
    let names = agent_names(&mut section, found);
    let dialect = detect(&section, &names);
    let map = section.text("map", found).unwrap_or_else(|| "map.yaml".to_owned());
    let publish_people = section.flag("publish_people", true, found);
    let (mut yaml_base_name, mut simulator, mut global_goals) = (None, None, Vec::new());
    if dialect == Dialect::V2_0 {
        yaml_base_name = section.text("yaml_base_name", found);
        simulator = section.text("simulator", found);
        global_goals = read_global_goals(&mut section, found);
    }
    let mut agents: Vec<AgentEntry> = Vec::new();
    let mut listed = Vec::new();
    for (place, name) in &names {
        if listed.contains(&name.as_str()) && agents.len() < MAX_AGENTS {
            found.error(place, name, "is listed twice", "each agent once");
            continue;
        }
        listed.push(name.as_str());
        let Some(node) = section.find(name) else {
            let sections = section.entries().iter().filter(|(_, node)| matches!(node, Node::Map(_)));
            let meant = nearest(name, sections.map(|(key, _)| key.as_str()))
                .map_or_else(String::new, |key| format!("did you mean `{key}`? "));
            found.error(place, name, "has no section of its own", format!("{meant}add `{name}:` with its keys"));
            continue;
        };
        if let Some(inner) = Section::of(node, name, found) {
            agents.push(agent(inner, name, dialect, &global_goals, found));
        }
    }
    close(&section, &listed, found);
    unique_ids(&agents, found);
    AgentsFile { dialect, map, publish_people, yaml_base_name, simulator, global_goals, agents, warnings: Vec::new() }
}

/// Keys of the root that are neither known nor a listed agent.
fn close(section: &Section<'_>, listed: &[&str], found: &mut Found) {
    let listed: std::collections::BTreeSet<&str> = listed.iter().copied().collect();
    section.close(found, |key, node, found| {
        if listed.contains(key) {
            return true;
        }
        let looks_like_an_agent =
            matches!(node, Node::Map(inner) if inner.iter().any(|(key, _)| key == "init_pose" || key == "id"));
        if looks_like_an_agent {
            found.warning(key, "", "is not listed in `agents`", "it takes no part");
        }
        looks_like_an_agent
    });
}

/// The list `agents`, each name with its place.
fn agent_names(section: &mut Section<'_>, found: &mut Found) -> Vec<(String, String)> {
    const HINT: &str = "list the names of the agents' sections, one a line, each after `- `";
    let Some(node) = section.node("agents") else {
        found.error("agents", "", "is missing", HINT);
        return Vec::new();
    };
    let Node::List(list) = node else {
        found.error("agents", &node.shown(), "is no list", HINT);
        return Vec::new();
    };
    if list.is_empty() {
        found.error("agents", "", "is empty: there is nobody to simulate", HINT);
    }
    if list.len() > MAX_AGENTS {
        found.error("agents", &node.shown(), "is too long", format!("allowed: at most {MAX_AGENTS} agents"));
    }
    let mut names = Vec::new();
    for (number, item) in list.iter().take(MAX_AGENTS).enumerate() {
        let place = format!("agents[{number}]");
        if let Node::Text(name) = item
            && !name.is_empty()
        {
            names.push((place, name.clone()));
        } else {
            found.error(&place, &item.shown(), "is no name", HINT);
        }
    }
    names
}

/// Which dialect a file is written in: the newest that one of its agents, or its root, shows.
fn detect(section: &Section<'_>, names: &[(String, String)]) -> Dialect {
    let newer = ["global_goals", "yaml_base_name", "simulator"];
    if newer.iter().any(|key| section.find(key).is_some()) {
        return Dialect::V2_0;
    }
    let mut dialect = Dialect::V1_0;
    for (_, name) in names {
        let Some(Node::Map(agent)) = section.find(name) else { continue };
        for (key, node) in agent {
            match (key.as_str(), node) {
                ("behavior", Node::Map(inner)) => {
                    let word = inner.iter().any(|(key, node)| key == "type" && matches!(node, Node::Text(_)));
                    dialect = dialect.max(if word { Dialect::V2_0 } else { Dialect::V1_1 });
                }
                ("goals", Node::List(goals)) if goals.iter().any(|goal| matches!(goal, Node::Whole(_))) => {
                    dialect = Dialect::V2_0;
                }
                _ => {}
            }
        }
    }
    dialect
}

/// `global_goals` in order of their numbers, which run from 1 without a gap.
fn read_global_goals(section: &mut Section<'_>, found: &mut Found) -> Vec<Point> {
    let Some(node) = section.node("global_goals") else {
        found.error("global_goals", "", "is missing", "give `1:`, `2:` … each with `x` and `y`");
        return Vec::new();
    };
    let Some(goals) = Section::of(node, "global_goals", found) else { return Vec::new() };
    let mut numbered: BTreeMap<i64, Point> = BTreeMap::new();
    for (key, node) in goals.entries() {
        let place = goals.at(key);
        let Some(number) = key.parse::<i64>().ok().filter(|number| *number >= 1) else {
            found.error(&place, key, "is no number of a goal", "goals are numbered 1, 2, 3 …");
            continue;
        };
        let Some(mut goal) = Section::of(node, &place, found) else { continue };
        let x = goal.real("x", None, METERS, found);
        let y = goal.real("y", None, METERS, found);
        // Some tools write a heading; nothing reads it.
        goal.real("h", Some(0.0), ANGLE, found);
        goal.close(found, |_, _, _| false);
        numbered.insert(number, Point::new(x, y));
    }
    let mut points = Vec::new();
    for (expected, (number, point)) in (1_i64..).zip(&numbered) {
        if *number != expected {
            let value = numbered.len().to_string();
            let message = format!("goal {expected} is missing, and HuNavSim ends the list there");
            found.error("global_goals", &format!("{value} goals up to {number}"), message, "number them 1, 2, 3 …");
            // The rest is kept under its own number, so that goals of agents are not called unknown too.
            points.clear();
            let last = numbered.keys().last().copied().unwrap_or(0).min(100_000);
            points.extend((1..=last).map(|k| numbered.get(&k).copied().unwrap_or_else(Point::origin)));
            break;
        }
        points.push(*point);
    }
    points
}

fn agent(mut s: Section<'_>, name: &str, dialect: Dialect, global: &[Point], found: &mut Found) -> AgentEntry {
    let id = s.whole("id", None, 0..=i64::from(i32::MAX), found);
    let skin = s.whole("skin", Some(-1), -1..=9, found);
    let group_id = s.whole("group_id", Some(-1), -1..=127, found);
    let max_vel_mps = s.real("max_vel", Some(1.0), SPEED, found);
    let radius_m = s.real("radius", Some(0.35), RADIUS, found);
    let goal_radius_m = s.real("goal_radius", Some(0.0), NEAR, found);
    let cyclic_goals = s.flag("cyclic_goals", true, found);
    let start = init_pose(&mut s, found);
    let behavior = behavior(&mut s, dialect, found);
    let goals = match dialect {
        Dialect::V1_0 | Dialect::V1_1 => named_goals(&mut s, found),
        Dialect::V2_0 => numbered_goals(&mut s, global, found),
    };
    s.close(found, |key, node, found| {
        let used = goals.iter().any(|goal| goal.name == key);
        let unused_goal = !used
            && dialect != Dialect::V2_0
            && matches!(node, Node::Map(inner) if inner.iter().any(|(key, _)| key == "x"));
        if unused_goal {
            found.warning(&format!("{name}.{key}"), "", "is a goal that `goals` does not list", "it is not walked to");
        }
        used || unused_goal
    });
    AgentEntry {
        name: name.to_owned(),
        id,
        skin,
        group_id,
        max_vel_mps,
        radius_m,
        start,
        goal_radius_m,
        cyclic_goals,
        behavior,
        goals,
    }
}

fn init_pose(s: &mut Section<'_>, found: &mut Found) -> InitPose {
    let place = s.at("init_pose");
    let Some(node) = s.node("init_pose") else {
        found.warning(&place, "", "is missing", "the agent starts at x 0, y 0");
        return InitPose::default();
    };
    let Some(mut pose) = Section::of(node, &place, found) else { return InitPose::default() };
    let out = InitPose {
        x: pose.real("x", Some(0.0), METERS, found),
        y: pose.real("y", Some(0.0), METERS, found),
        z: pose.real("z", Some(0.0), METERS, found),
        h: pose.real("h", Some(0.0), ANGLE, found),
    };
    pose.close(found, |_, _, _| false);
    out
}

const CODES: &str = "allowed: 1 regular, 2 impassive, 3 surprised, 4 scared, 5 curious, 6 threatening";

fn behavior(s: &mut Section<'_>, dialect: Dialect, found: &mut Found) -> BehaviorEntry {
    let place = s.at("behavior");
    let Some(node) = s.node("behavior") else {
        found.warning(&place, "", "is missing", "the agent is regular");
        return BehaviorEntry::default();
    };
    if dialect == Dialect::V1_0 {
        let reaction = if let Node::Whole(code) = node {
            reaction(*code, -1, &place, found)
        } else {
            let hint = format!("{CODES}, 7 to 16 the trees LLMBT_0 to LLMBT_9");
            found.error(&place, &node.shown(), "is no whole number", hint);
            Reaction::Regular
        };
        return BehaviorEntry { reaction, ..BehaviorEntry::default() };
    }
    if !matches!(node, Node::Map(_)) {
        let hint = format!("{dialect} has a section here with `type`, `configuration` and the force factors");
        found.error(&place, &node.shown(), "must be a section", hint);
        return BehaviorEntry::default();
    }
    let Some(mut b) = Section::of(node, &place, found) else { return BehaviorEntry::default() };
    let at_type = b.at("type");
    let reaction = match b.node("type") {
        None => {
            found.warning(&at_type, "", "is missing", "the agent is regular");
            Reaction::Regular
        }
        Some(Node::Whole(code)) => reaction(*code, 0, &at_type, found),
        Some(Node::Text(word)) if dialect == Dialect::V2_0 => Reaction::from_word(word).unwrap_or_else(|| {
            let meant =
                Reaction::nearest_word(word).map_or_else(String::new, |near| format!("did you mean `{near}`? "));
            let hint = format!("{meant}allowed: Regular, Impassive, Surprised, Scared, Curious, Threatening");
            found.error(&at_type, &shortened(word), "is no behavior", hint);
            Reaction::Regular
        }),
        Some(other) => {
            found.error(&at_type, &other.shown(), "is no code of a behavior", CODES);
            Reaction::Regular
        }
    };
    let code = b.whole("configuration", Some(0), 0..=3, found);
    let configuration = Configuration::from_code(code).unwrap_or_default();
    let entry = BehaviorEntry {
        reaction,
        configuration,
        duration_s: b.real("duration", Some(40.0), SPAN, found),
        once: b.flag("once", true, found),
        vel_mps: b.real("vel", Some(1.0), FACTOR, found),
        dist_m: b.real("dist", Some(0.0), NEAR, found),
        goal_force_factor: b.real("goal_force_factor", Some(2.0), FACTOR, found),
        obstacle_force_factor: b.real("obstacle_force_factor", Some(10.0), FACTOR, found),
        social_force_factor: b.real("social_force_factor", Some(5.0), FACTOR, found),
        other_force_factor: b.real("other_force_factor", Some(20.0), FACTOR, found),
    };
    b.close(found, |_, _, _| false);
    if configuration == Configuration::Custom {
        cuts(&entry, &limits(dialect), &place, found);
    }
    entry
}

fn reaction(code: i64, unset: i64, place: &str, found: &mut Found) -> Reaction {
    if code == unset {
        found.warning(place, &code.to_string(), "means that none was chosen", "the agent is regular");
        return Reaction::Regular;
    }
    Reaction::from_code(code).filter(|reaction| unset == -1 || !matches!(reaction, Reaction::Custom(_))).unwrap_or_else(
        || {
            let custom = if unset == -1 { ", 7 to 16 the trees LLMBT_0 to LLMBT_9" } else { "" };
            found.error(place, &code.to_string(), "is no code of a behavior", format!("{CODES}{custom}"));
            Reaction::Regular
        },
    )
}

/// Names the values that the simulator will cut.
fn cuts(entry: &BehaviorEntry, limits: &Limits, place: &str, found: &mut Found) {
    let cut = [
        ("vel", entry.vel_mps, limits.vel_mps),
        ("goal_force_factor", entry.goal_force_factor, limits.goal),
        ("obstacle_force_factor", entry.obstacle_force_factor, limits.obstacle),
        ("social_force_factor", entry.social_force_factor, limits.social),
        ("other_force_factor", entry.other_force_factor, limits.other),
    ];
    for (key, value, (least, most)) in cut {
        let inside = value.clamp(least, most);
        if (inside - value).abs() > 0.0 {
            let message = format!("is outside {least:?} to {most:?}");
            found.warning(&format!("{place}.{key}"), &format!("{value:?}"), message, format!("{inside:?} is taken"));
        }
    }
}

/// The list `goals`.
fn goal_list<'a>(s: &mut Section<'a>, found: &mut Found) -> &'a [Node] {
    const HINT: &str = "list at least one goal; somebody who stands has the start as goal";
    let place = s.at("goals");
    match s.node("goals") {
        None => found.error(&place, "", "is missing", HINT),
        Some(Node::List(list)) if list.is_empty() => found.error(&place, "", "is empty", HINT),
        Some(Node::List(list)) => return list,
        Some(other) => found.error(&place, &other.shown(), "is no list", HINT),
    }
    &[]
}

fn named_goals(s: &mut Section<'_>, found: &mut Found) -> Vec<GoalEntry> {
    let mut goals: Vec<GoalEntry> = Vec::new();
    for (number, item) in goal_list(s, found).iter().enumerate() {
        let place = format!("{}[{number}]", s.at("goals"));
        let Node::Text(name) = item else {
            found.error(&place, &item.shown(), "is no name of a goal", "goals are named, such as g1");
            continue;
        };
        if let Some(known) = goals.iter().find(|goal| goal.name == *name) {
            // The same place may be walked to more than once.
            let again = known.clone();
            goals.push(again);
            continue;
        }
        let Some(node) = s.find(name) else {
            let sections = s.entries().iter().filter(|(_, node)| matches!(node, Node::Map(_)));
            let meant = nearest(name, sections.map(|(key, _)| key.as_str()))
                .map_or_else(String::new, |key| format!("did you mean `{key}`? "));
            let hint = format!("{meant}add `{name}:` with `x`, `y` and `h`");
            found.error(&place, name, "has no section of its own", hint);
            continue;
        };
        let Some(mut goal) = Section::of(node, &s.at(name), found) else { continue };
        let x = goal.real("x", None, METERS, found);
        let y = goal.real("y", None, METERS, found);
        let heading = goal.real("h", Some(0.0), ANGLE, found);
        goal.close(found, |_, _, _| false);
        goals.push(GoalEntry { name: name.clone(), at: Point::new(x, y), heading });
    }
    goals
}

fn numbered_goals(s: &mut Section<'_>, global: &[Point], found: &mut Found) -> Vec<GoalEntry> {
    let mut goals = Vec::new();
    for (number, item) in goal_list(s, found).iter().enumerate() {
        let place = format!("{}[{number}]", s.at("goals"));
        let Node::Whole(goal) = item else {
            let hint = format!("allowed: 1 to {}, numbers of `global_goals`", global.len());
            found.error(&place, &item.shown(), "is no number of a goal", hint);
            continue;
        };
        let at = usize::try_from(*goal).ok().and_then(|goal| goal.checked_sub(1)).and_then(|goal| global.get(goal));
        match at {
            Some(at) => goals.push(GoalEntry { name: goal.to_string(), at: *at, heading: 0.0 }),
            None => {
                let hint = format!("allowed: 1 to {}", global.len());
                found.error(&place, &goal.to_string(), "is not in `global_goals`", hint);
            }
        }
    }
    goals
}

fn unique_ids(agents: &[AgentEntry], found: &mut Found) {
    let mut known: BTreeMap<i64, &str> = BTreeMap::new();
    for agent in agents {
        match known.get(&agent.id) {
            Some(first) => {
                let free = agents.iter().map(|agent| agent.id).max().unwrap_or(0).saturating_add(1);
                let message = format!("is the id of `{first}` too");
                let place = format!("{}.id", agent.name);
                found.error(&place, &agent.id.to_string(), message, format!("each id once, such as {free}"));
            }
            None => {
                known.insert(agent.id, &agent.name);
            }
        }
    }
}
