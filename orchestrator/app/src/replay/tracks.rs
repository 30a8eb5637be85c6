//! One recording from a file, ours or anybody's, scored with what is said of it on the command line.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use socrates_model::{AgentId, HumanId, Location, Point, Recording, Report};
use socrates_scoring::Evidence;
use socrates_stream::csv::{HUMAN_RADIUS_M, Named, ROBOT_RADIUS_M, ROBOT_SPEED_MPS, RunChoice, Table};
use socrates_stream::ros::{Bag, Choice};
use socrates_stream::{StreamError, mcap};

use super::bags;
use super::lines::{self, FoundBy};
use crate::bundle;
use crate::exit::Diagnostic;

/// Radii that are believed, m.
const RADII_M: std::ops::RangeInclusive<f64> = 0.05..=2.0;

/// What is known of a recording beside its tracks.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Where it is.
    pub location: Option<Location>,
    /// Where the robot wants to go.
    pub goal: Option<Point>,
    /// Radius of the robot, m.
    pub radius_m: Option<f64>,
    /// Preferred speed of the robot, m/s.
    pub speed_mps: Option<f64>,
    /// People who belong together.
    pub groups: Vec<Group>,
    /// The id of the robot in the file, where it is neither `robot` nor 0; in a bag its topic or frame.
    pub robot: Option<String>,
    /// The topic of the people in a bag.
    pub people: Option<String>,
    /// Which run of a table of several.
    pub run: RunChoice,
}

/// A recording with its report.
#[derive(Debug)]
pub struct Scored {
    pub(crate) recording: Recording,
    /// The report.
    pub report: Report,
    /// Where the robot wants to go, as far as it is known.
    pub(crate) goal: Option<Point>,
    /// What looks wrong, what was mended, and what was assumed, in sentences.
    pub(crate) told: Vec<String>,
    /// The table that a bag became.
    pub(crate) table: Option<Table>,
}

/// What a table has.
const TABLES: &str = "CSV has the columns t,id,x,y[,yaw,gesture] in seconds, meters and radians; --robot ID says who is the robot where no id is `robot`";

/// Ids that are told with their new names, at most.
const RENAMED: usize = 6;

/// A file as it was read.
struct Read {
    recording: Recording,
    goal: Option<Point>,
    groups: Vec<Vec<HumanId>>,
    named: Named,
    /// Agents whose radius the file names; nothing for a recording of ours, which names everybody's.
    measured: Option<BTreeSet<AgentId>>,
    table: Option<Table>,
}

/// Reads and scores what a path names: a file, or a bag of ROS 2. Nothing for a bundle, and for a folder that is no bag.
///
/// # Errors
/// What cannot be read, with what would be.
pub fn at(path: &Path, known: &Known) -> Result<Option<Scored>, Diagnostic> {
    let name = path.display().to_string();
    if bundle::is_bundle(path) {
        return Ok(None);
    }
    match bags::at(path)? {
        Some(bag) => score_bag(&name, bag, known).map(Some),
        None if path.is_dir() => Ok(None),
        None => score(&name, &bags::bytes(path)?, known).map(Some),
    }
}

/// Reads and scores the bytes of a file.
///
/// # Errors
/// What cannot be read, with what would be.
pub fn score(name: &str, bytes: &[u8], known: &Known) -> Result<Scored, Diagnostic> {
    let mut told = Vec::new();
    let is_mcap = mcap::begins(bytes) || (bytes.is_empty() && name.ends_with(".mcap"));
    if Bag::begins(bytes) {
        return score_bag(name, bags::of_bytes(name, bytes)?, known);
    }
    let read = match (is_mcap, bags::other(bytes)) {
        (true, _) => match ours(name, bytes, known, &mut told)? {
            Some(read) => read,
            None => return score_bag(name, bags::of_bytes(name, bytes)?, known),
        },
        (false, Some(other)) => return Err(other.refused(name)),
        (false, None) => table(name, bytes, known, &mut told)?,
    };
    judged(name, read, known, told)
}

/// Scores a bag of ROS 2.
///
/// # Errors
/// What is missing in it, with what mends it.
fn score_bag(name: &str, bag: Bag, known: &Known) -> Result<Scored, Diagnostic> {
    if known.run != RunChoice::default() {
        return Err(Diagnostic::input(format!("`{name}` holds one run"), "--planner and --seed are for tables"));
    }
    let choice = Choice { robot: known.robot.clone(), people: known.people.clone() };
    let found = bag.tracks(&choice).map_err(|why| bags::refused(name, &why))?;
    let mut told = found.told;
    let mut read = tabled(name, found.table, FoundBy::Time, None, &mut told)?;
    let named = &read.named;
    let mut measured = BTreeSet::new();
    for info in &mut read.recording.header.agents {
        let id = named.names.get(&info.agent).cloned().unwrap_or_else(|| info.agent.to_string());
        let number = info.agent.number().to_string();
        if let Some(radius) = found.radii_m.get(&id).or_else(|| found.radii_m.get(&number)) {
            info.radius_m = *radius;
            measured.insert(info.agent);
        }
    }
    read.measured = Some(measured);
    judged(name, read, known, told)
}

fn judged(name: &str, read: Read, known: &Known, mut told: Vec<String>) -> Result<Scored, Diagnostic> {
    let Read { mut recording, goal, groups, named, measured, table } = read;
    let goal = known.goal.or(goal);
    let groups = if known.groups.is_empty() { groups } else { members(&known.groups, &recording, &named, &mut told) };
    if let Some(radius) = known.radius_m.filter(|radius| !RADII_M.contains(radius)) {
        return Err(Diagnostic::input(
            format!("the robot's radius cannot be {radius} m"),
            format!("--radius takes meters from {} to {}", RADII_M.start(), RADII_M.end()),
        ));
    }
    for info in recording.header.agents.iter_mut().filter(|info| info.agent == AgentId::Robot) {
        info.radius_m = known.radius_m.unwrap_or(info.radius_m);
        info.speed_mps = known.speed_mps.unwrap_or(info.speed_mps);
    }
    told.extend(socrates_scoring::doubts(&recording, known.location.as_ref()));
    let tracks = socrates_scoring::Tracks::read(&recording).map_err(|why| {
        Diagnostic::input(
            format!("`{name}`: {why}"),
            "a recording has at least two moments, finite numbers, rising times and one track for each agent",
        )
    })?;
    if let (Some(measured), Some(_)) = (&measured, &tracks.robot) {
        told.extend(assumed(known, &recording, measured));
    }
    told.extend(renamed(&named));
    if tracks.robot.is_none() {
        let ids: Vec<String> = named.agents.keys().take(RENAMED).map(|id| format!("`{id}`")).collect();
        let ids = if ids.is_empty() { String::new() } else { format!(" among {}", ids.join(", ")) };
        told.push(format!("there is no robot{ids}: --robot ID says who it is; figures of a robot have no value"));
    }
    let evidence = Evidence { location: known.location.as_ref(), goal, groups: &groups, ..Evidence::of(&recording) };
    let report = socrates_scoring::score(&evidence);
    let arrives = report.metric("arrived").is_some_and(|metric| metric.value.is_some());
    if tracks.robot.is_some() && !arrives {
        told.push(
            "the robot's goal is not known: success, SPL and whatever asks for it have no value, and standing at the end is not counted as freezing; --goal X,Y tells it"
                .to_owned(),
        );
    }
    Ok(Scored { recording, report, goal, told, table })
}

/// Agents that the file calls otherwise than the figures do.
fn renamed(named: &Named) -> Option<String> {
    let all = || named.names.iter().map(|(agent, id)| format!("`{id}` is {agent}"));
    let more = named.names.len().saturating_sub(RENAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    (!named.names.is_empty()).then(|| format!("names: {}{more}", all().take(RENAMED).collect::<Vec<_>>().join(", ")))
}

/// The people of the groups that the user names.
fn members(groups: &[Group], recording: &Recording, named: &Named, told: &mut Vec<String>) -> Vec<Vec<HumanId>> {
    let there = |agent: AgentId| recording.header.agents.iter().any(|info| info.agent == agent);
    let mut found = Vec::new();
    for Group(ids) in groups {
        let mut group = Vec::new();
        for id in ids {
            match named.agent(id).or_else(|| agent(id).filter(|agent| there(*agent))) {
                Some(AgentId::Human(id)) => group.push(id),
                Some(AgentId::Robot) => told.push(format!("--groups names `{id}`, which is the robot")),
                None => told.push(format!("--groups names `{id}`, who is not in the recording")),
            }
        }
        // A person that is left alone is no group.
        if group.len() > 1 {
            found.push(group);
        }
    }
    found
}

/// What is taken where nothing is said.
fn assumed(known: &Known, recording: &Recording, measured: &BTreeSet<AgentId>) -> Option<String> {
    let mut parts = Vec::new();
    let is_guessed = |agent: AgentId| !measured.contains(&agent);
    if recording.header.agents.iter().any(|info| info.agent != AgentId::Robot && is_guessed(info.agent)) {
        parts.push(format!("radius of people {HUMAN_RADIUS_M} m"));
    }
    if known.radius_m.is_none() && is_guessed(AgentId::Robot) {
        parts.push(format!("radius of the robot {ROBOT_RADIUS_M} m (--radius)"));
    }
    if known.speed_mps.is_none() {
        parts.push(format!("nominal speed of the robot {ROBOT_SPEED_MPS} m/s (--speed)"));
    }
    (!parts.is_empty()).then(|| format!("assumed: {}", parts.join(", ")))
}

/// A recording of ours; nothing for one of others in which there may be messages of ROS 2.
fn ours(name: &str, bytes: &[u8], known: &Known, told: &mut Vec<String>) -> Result<Option<Read>, Diagnostic> {
    let rest = match mcap::read_rest(bytes) {
        // A program that writes MCAP may leave out the profile of ROS 2.
        Err(StreamError::Foreign { .. }) if bags::of_bytes(name, bytes).is_ok_and(|bag| bag.is_ros()) => {
            return Ok(None);
        }
        rest => rest,
    };
    if known.robot.is_some() || known.people.is_some() || known.run != RunChoice::default() {
        return Err(Diagnostic::input(
            format!("`{name}` holds one run and names its robot"),
            "--robot is for tables and bags, --people for bags, --planner and --seed for tables",
        ));
    }
    let rest = rest.map_err(|why| {
        let hint = match &why {
            StreamError::Foreign { .. } => {
                "MCAP files of `socrates run` and `socrates simulate` are read, and bags of ROS 2; of others, write a CSV with the columns t,id,x,y[,yaw,gesture]"
            }
            StreamError::Link { .. }
            | StreamError::Shm { .. }
            | StreamError::Write { .. }
            | StreamError::Read { .. }
            | StreamError::NotWhole { .. }
            | StreamError::Csv { .. } => {
                "the MCAP file is damaged or was cut off: copy it again, or make the run again with `socrates simulate BUNDLE --out FOLDER`"
            }
        };
        Diagnostic::input(format!("`{name}`: {why}"), hint)
    })?;
    if let Some(why) = rest.cut {
        let last =
            rest.recording.frames.last().map_or(0.0, |state| socrates_model::SimTime::at_tick(state.tick).secs());
        told.push(format!("{why}: scored up to {last:.2} s"));
    }
    let recording = rest.recording;
    let (groups, named) = (Vec::new(), Named::default());
    Ok(Some(Read { recording, goal: None, groups, named, measured: None, table: None }))
}

fn table(name: &str, bytes: &[u8], known: &Known, told: &mut Vec<String>) -> Result<Read, Diagnostic> {
    let bad = |why: String| Diagnostic::input(format!("`{name}`: {why}"), TABLES);
    if known.people.is_some() {
        return Err(Diagnostic::input(format!("`{name}` is no bag of ROS 2"), "--people is for bags"));
    }
    let text = std::str::from_utf8(bytes).map_err(|why| bad(format!("not UTF-8 text: {why}")))?;
    let mut table = Table::read(text).map_err(|why| bad(why.to_string()))?;
    told.extend(socrates_stream::csv::plain(&mut table, &known.run).map_err(|why| bad(why.to_string()))?);
    let read = tabled(name, table, FoundBy::Number, known.robot.as_deref(), told);
    Ok(Read { table: None, ..read? })
}

/// What a table becomes, whoever made it.
fn tabled(
    name: &str,
    mut table: Table,
    by: FoundBy,
    robot: Option<&str>,
    told: &mut Vec<String>,
) -> Result<Read, Diagnostic> {
    let bad = |why: StreamError| Diagnostic::input(format!("`{name}`: {why}"), TABLES);
    // What looks wrong is reported with the ids of the file.
    let of_file = table.clone();
    let named = socrates_stream::csv::named(&mut table, robot).map_err(bad)?;
    let mut recording = socrates_stream::csv::read_table(&table).map_err(bad)?;
    let with_name = |why: Diagnostic| Diagnostic { what: format!("`{name}`: {}", why.what), ..why };
    told.extend(lines::doubts(&of_file, by).map_err(with_name)?);
    for info in &mut recording.header.agents {
        if let Some(id) = named.names.get(&info.agent) {
            info.role.clone_from(id);
        }
    }
    let Columns { goal, groups } = Columns::read(&table);
    Ok(Read { recording, goal, groups, named, measured: Some(BTreeSet::new()), table: Some(of_file) })
}

/// What columns beside the tracks tell: `goal_x` and `goal_y` of the robot, `group` of people.
#[derive(Debug, Default, PartialEq)]
struct Columns {
    goal: Option<Point>,
    groups: Vec<Vec<HumanId>>,
}

impl Columns {
    fn read(table: &Table) -> Self {
        let column = |wanted: &str| table.column(wanted);
        let Some(id) = column("id") else { return Self::default() };
        let goal = column("goal_x").zip(column("goal_y"));
        let group = column("group");
        let mut found = Self::default();
        let mut groups: BTreeMap<String, BTreeSet<HumanId>> = BTreeMap::new();
        if goal.is_none() && group.is_none() {
            return found;
        }
        for row in &table.rows {
            let Some(agent) = row.cell(id).and_then(agent) else { continue };
            match agent {
                // The last goal is the one that counts: a recording may have several trips' worth of via points.
                AgentId::Robot => {
                    let at = goal.and_then(|(x, y)| Some(Point::new(row.number(x)?, row.number(y)?)));
                    found.goal = at.or(found.goal);
                }
                AgentId::Human(id) => {
                    let name = group.and_then(|at| row.cell(at)).filter(|name| !name.is_empty());
                    name.into_iter().for_each(|name| {
                        groups.entry(name.to_owned()).or_default().insert(id);
                    });
                }
            }
        }
        found.groups =
            groups.into_values().filter(|group| group.len() > 1).map(|group| group.into_iter().collect()).collect();
        found
    }
}

fn agent(id: &str) -> Option<AgentId> {
    id.parse::<u32>().map(AgentId::from_number).ok().or_else(|| id.parse().ok())
}

/// `X,Y` as a point.
///
/// # Errors
/// What is no such point.
pub fn point(text: &str) -> Result<Point, String> {
    let wrong = || format!("`{text}` is no point; it is X,Y in meters on the map, such as 31.5,-2");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    Ok(Point::new(number(x).ok_or_else(wrong)?, number(y).ok_or_else(wrong)?))
}

/// `1+2` or `ped1+ped2` as the people of one group.
///
/// # Errors
/// What is no such group.
pub fn group(text: &str) -> Result<Group, String> {
    let members: Vec<String> = text.split('+').map(|id| id.trim().to_owned()).collect();
    if members.len() < 2 || members.iter().any(String::is_empty) {
        return Err(format!("`{text}` is no group; groups are ids of people, such as 1+2,ped3+ped4"));
    }
    Ok(Group(members))
}

/// Ids of people who belong together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group(pub Vec<String>);

#[cfg(test)]
mod tests;
