//! A bag as a table of tracks, in one frame and by one clock.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::AgentId;

use super::bag::{Bag, Logged, Topic};
use super::clock::Clock;
use super::fault::BagFault;
use super::frames::{Between, Tree, Way};
use super::pick::{self, Choice, Picked, Robot};
use super::rigid::Rigid;
use super::sight::Kind;
use crate::csv::{Row, Table};

/// Frames in which everybody is placed where they are known, the preferred first (REP 105).
const GROUNDS: [&str; 2] = ["map", "world"];
/// Times of one topic that go back farther, or forth farther, are of a clock that was set, ns.
const BACK_NANOS: i64 = 1_000_000_000;
const FORTH_NANOS: i64 = 100_000_000_000_000;
/// Robot and people farther apart than this in time are by two clocks, ns: an hour.
const CLOCKS_NANOS: i64 = 3_600_000_000_000;
/// Fixes nearer than this in time are one too many, ns: tracks have a step of 0.01 s.
const THIN_NANOS: i64 = 9_500_000;
/// Two places of somebody at one time that are farther apart are two people, m.
const APART_M: f64 = 0.5;
/// Most people of a bag: as many as a recording of ours has.
const MOST_PEOPLE: usize = 4096;
/// Columns of the table, in order.
const COLUMNS: [&str; 8] = ["t", "id", "x", "y", "yaw", "group", "goal_x", "goal_y"];
/// Nanoseconds of a second.
const SECOND: f64 = 1e9;

/// Tracks of a bag.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracks {
    /// Columns `t` (s from the first fix on), `id`, `x`, `y` (m), `yaw` (rad, empty where it is not known), `group`, and `goal_x`
    /// and `goal_y` (m) in the last line of the robot. The robot is `robot`.
    pub table: Table,
    /// Radii that the bag names, m, by the id of the table.
    pub radii_m: BTreeMap<String, f64>,
    /// What was taken, what was assumed and what was not read, in sentences.
    pub told: Vec<String>,
}

/// Somebody at a place on the ground.
#[derive(Debug, Clone, Copy)]
struct Fix {
    time: i64,
    x: f64,
    y: f64,
    yaw: Option<f64>,
}

/// Somebody over time.
#[derive(Debug, Clone, Default)]
struct Track {
    fixes: Vec<Fix>,
    group: Option<i64>,
}

impl Bag {
    /// The tracks of the robot and of the people around it. The places are in `map` where a chain of transforms leads there, else
    /// in the robot's own frame; times are those of the messages' stamps.
    ///
    /// # Errors
    /// [`BagFault`] where there is no robot, most messages cannot be read, or frames or clocks do not fit together.
    pub fn tracks(mut self, choice: &Choice) -> Result<Tracks, BagFault> {
        self.bridge();
        let mut told = std::mem::take(&mut self.told);
        told.extend(self.tree.settle());
        self.holds_messages()?;
        let robot = pick::robot(&self, choice.robot.as_deref())?;
        let people = pick::people(&self, &robot.taken, choice.people.as_deref())?;
        let mut topics = people.taken.clone();
        topics.extend(match robot.taken {
            Robot::Topic(topic) => Some(topic),
            Robot::Frame(_) => None,
        });
        for topic in &topics {
            pick::readable(topic)?;
        }
        let frames = self.in_order().into_iter().filter(|topic| topic.kind == Some(Kind::Transforms));
        told.extend(frames.flat_map(left_out));
        let target = target(&self.tree, &robot.taken, &people.taken, &mut told);
        let maker = Maker { bag: &self, clock: Clock::of(&self, &topics), target: target.to_owned() };
        let mut tracks: BTreeMap<String, Track> = BTreeMap::new();
        let own = maker.robot(&robot, &mut told)?;
        tracks.insert("robot".to_owned(), own);
        let mut radii_m = maker.people(&people, &mut tracks, &mut told)?;
        if let Robot::Topic(topic) = robot.taken {
            radii_m.extend(last_radius(topic).map(|radius| ("robot".to_owned(), radius)));
        }
        let goal = maker.goal(&robot.taken, &people.taken, &mut told);
        told.extend(maker.not_read(&robot, &people));
        let table = table(&mut tracks, goal, &mut told);
        Ok(Tracks { table, radii_m, told })
    }

    /// Takes odometry as a transform where nothing else says where its frame stands.
    fn bridge(&mut self) {
        let mut found = Vec::new();
        let mut children = BTreeSet::new();
        for topic in self.in_order().into_iter().filter(|topic| topic.kind == Some(Kind::Odometry)) {
            let first = topic.sightings.first().and_then(|logged| logged.sighting.child.clone());
            let Some(child) = first.filter(|child| !self.tree.holds(child) && children.insert(child.clone())) else {
                continue;
            };
            for Logged { log, sighting } in &topic.sightings {
                if let (Some(frame), true) =
                    (&sighting.frame, sighting.faces && sighting.child.as_ref() == Some(&child))
                {
                    found.push((frame.clone(), child.clone(), sighting.stamp.unwrap_or(*log), sighting.place));
                }
            }
        }
        for (frame, child, time, place) in found {
            self.tree.add(&frame, &child, time, false, place);
        }
    }
}

/// The frame of the first message of a topic that names one.
fn first_frame(topic: &Topic) -> Option<&str> {
    topic.sightings.iter().find_map(|logged| logged.sighting.frame.as_deref())
}

fn last_radius(topic: &Topic) -> Option<f64> {
    topic.sightings.iter().rev().find_map(|logged| logged.sighting.radius_m)
}

/// The frame in which everybody is placed.
fn target<'a>(tree: &'a Tree, robot: &Robot<'a>, people: &[&'a Topic], told: &mut Vec<String>) -> &'a str {
    let own = match robot {
        Robot::Frame(frame) => frame,
        Robot::Topic(topic) => match first_frame(topic) {
            Some(frame) => frame,
            None => {
                let frame = people.iter().find_map(|topic| first_frame(topic)).unwrap_or("map");
                told.push(format!("{} names no frame: taken to be in `{frame}`", topic.shown()));
                frame
            }
        },
    };
    let ancestors = tree.ancestors(own);
    let last = |frame: &str| frame.rsplit('/').next().unwrap_or_default().to_owned();
    let ground = GROUNDS.iter().find_map(|ground| ancestors.iter().find(|frame| last(frame) == *ground).copied());
    // Of a robot that is a frame the outermost one that it stands in.
    let outermost = match robot {
        Robot::Frame(_) => ancestors.last().copied(),
        Robot::Topic(_) => None,
    };
    let found = ground.or(outermost).unwrap_or(own);
    if ground.is_none() {
        told.push(format!(
            "no transform leads from `{own}` to `map`: places are in `{found}`, where the robot's own drift moves people and goals"
        ));
    }
    found
}

/// What is needed to place anybody.
struct Maker<'a> {
    bag: &'a Bag,
    clock: Clock,
    target: String,
}

/// How the places of a topic came into the frame of all.
#[derive(Debug, Default)]
struct Placing {
    /// Frames that the topic's places are in.
    frames: BTreeSet<String>,
    /// Places of times without a transform.
    not_then: usize,
    frameless: usize,
    stampless: usize,
}

impl<'a> Maker<'a> {
    fn way(&self, topic: &Topic, frame: &str) -> Result<Way<'a>, BagFault> {
        self.bag.tree.way(frame, &self.target).ok_or_else(|| {
            let chain = |of: &str| self.bag.tree.ancestors(of).join("` in `");
            BagFault::Apart {
                topic: topic.name.clone(),
                frame: frame.to_owned(),
                target: self.target.clone(),
                near: format!(": there are `{}`, and `{}`", chain(frame), chain(&self.target)),
            }
        })
    }

    /// The places of a topic on the ground, by who is there, in the order of the messages.
    fn placed(&self, topic: &'a Topic, told: &mut Vec<String>) -> Result<Vec<(&'a Logged, Fix)>, BagFault> {
        let mut placing = Placing::default();
        let mut ways: BTreeMap<&str, Way<'a>> = BTreeMap::new();
        let mut found = Vec::with_capacity(topic.sightings.len());
        // Detectors of people often leave the turn out.
        let unturned = matches!(topic.kind, Some(Kind::PoseArray | Kind::PoseStamped))
            && topic.sightings.iter().all(|logged| logged.sighting.place.is_unturned());
        for logged in &topic.sightings {
            let sighting = &logged.sighting;
            let time = self.clock.time(logged);
            placing.stampless += usize::from(sighting.stamp.is_none());
            let between = match sighting.frame.as_deref() {
                None => {
                    placing.frameless += 1;
                    Between::Known(Rigid::HERE)
                }
                Some(frame) => {
                    if !ways.contains_key(frame) {
                        ways.insert(frame, self.way(topic, frame)?);
                        placing.frames.insert(frame.to_owned());
                    }
                    ways.get(frame).map_or(Between::NotThen, |way| way.at(time))
                }
            };
            let Between::Known(between) = between else {
                placing.not_then += 1;
                continue;
            };
            let place = between.then(&sighting.place);
            let [x, y, _up] = place.shift;
            let yaw = (sighting.faces && !unturned).then(|| place.yaw());
            found.push((logged, Fix { time, x, y, yaw }));
        }
        self.tell(topic, &placing, told)?;
        told.extend(in_order(topic, &found)?);
        Ok(found)
    }

    fn tell(&self, topic: &Topic, placing: &Placing, told: &mut Vec<String>) -> Result<(), BagFault> {
        let (name, target, all) = (&topic.name, &self.target, topic.sightings.len());
        if placing.not_then == all {
            let frame = placing.frames.iter().next().cloned().unwrap_or_default();
            return Err(BagFault::Never { topic: name.clone(), frame, target: target.clone() });
        }
        if placing.not_then > 0 {
            let frames: Vec<&str> = placing.frames.iter().map(String::as_str).collect();
            let frames = frames.join("`, `");
            told.push(format!(
                "{} of {all} places of `{name}` are left out: no transform from `{frames}` to `{target}` is within 1 s of them",
                placing.not_then
            ));
        }
        // Of HuNavSim's robot it is told where its frame is sought.
        if placing.frameless > 0 && topic.kind != Some(Kind::Agent) {
            told.push(format!(
                "{} of {all} places of `{name}` name no frame: taken to be in `{target}`",
                placing.frameless
            ));
        }
        if placing.stampless > 0 {
            told.push(format!(
                "{} of {all} places of `{name}` have no time stamp: the recorder's time is taken, by the clock of the others",
                placing.stampless
            ));
        }
        told.extend(left_out(topic));
        if topic.robots > 0 {
            told.push(format!("`{name}` holds robots among its agents: they are left out"));
        }
        Ok(())
    }

    fn robot(&self, picked: &Picked<Robot<'a>>, told: &mut Vec<String>) -> Result<Track, BagFault> {
        let more = if picked.others.is_empty() {
            String::new()
        } else {
            format!("; --robot chooses another of {}", picked.others.join(", "))
        };
        told.push(format!("robot: {}, placed in `{}`{more}", picked.taken.shown(), self.target));
        let fixes = match picked.taken {
            Robot::Topic(topic) => self.placed(topic, told)?.into_iter().map(|(_, fix)| fix).collect(),
            Robot::Frame(frame) => self.framed(frame)?,
        };
        Ok(Track { fixes, group: None })
    }

    /// Where a frame was.
    fn framed(&self, frame: &str) -> Result<Vec<Fix>, BagFault> {
        let never =
            || BagFault::Never { topic: "/tf".to_owned(), frame: frame.to_owned(), target: self.target.clone() };
        let way = self.bag.tree.way(frame, &self.target).ok_or_else(never)?;
        let fixes: Vec<Fix> = way
            .times()
            .into_iter()
            .filter_map(|time| match way.at(time) {
                Between::Known(place) => {
                    let [x, y, _up] = place.shift;
                    Some(Fix { time, x, y, yaw: Some(place.yaw()) })
                }
                Between::NotThen => None,
            })
            .collect();
        if fixes.is_empty() { Err(never()) } else { Ok(fixes) }
    }

    /// Adds the people; gives the radii that are named.
    fn people(
        &self,
        picked: &Picked<Vec<&'a Topic>>,
        tracks: &mut BTreeMap<String, Track>,
        told: &mut Vec<String>,
    ) -> Result<BTreeMap<String, f64>, BagFault> {
        let names: Vec<String> = picked.taken.iter().map(|topic| topic.shown()).collect();
        let more = if picked.others.is_empty() {
            String::new()
        } else {
            format!("; --people chooses another of {}", picked.others.join(", "))
        };
        if names.is_empty() {
            told.push("people: no topic of people is there; --people TOPIC takes a topic of poses".to_owned());
        } else {
            told.push(format!("people: {}{more}", names.join(", ")));
        }
        let begins = |track: &Track| track.fixes.iter().map(|fix| fix.time).min();
        let robot = tracks.get("robot").and_then(begins);
        let mut radii_m = BTreeMap::new();
        for topic in &picked.taken {
            let placed = self.placed(topic, told)?;
            if let (Some(robot), Some(first)) = (robot, placed.iter().map(|(_, fix)| fix.time).min()) {
                same_clock(robot, topic, first)?;
            }
            // People in no group may have the number 0 as well as -1.
            let grouped = topic.sightings.iter().any(|logged| logged.sighting.group.is_some_and(|group| group > 0));
            for (logged, fix) in placed {
                let id = person(topic, &picked.taken, &logged.sighting.who);
                radii_m.extend(logged.sighting.radius_m.map(|radius| (id.clone(), radius)));
                if tracks.len() > MOST_PEOPLE && !tracks.contains_key(&id) {
                    return Err(BagFault::Crowd { most: MOST_PEOPLE });
                }
                let track = tracks.entry(id).or_default();
                track.group = logged.sighting.group.filter(|_| grouped);
                track.fixes.push(fix);
            }
            if topic.kind == Some(Kind::PoseArray) {
                told.push(format!("people of `{}` are told apart by their place in the message alone", topic.name));
            }
        }
        Ok(radii_m)
    }

    /// The last goal of the robot, in the frame of all.
    fn goal(&self, robot: &Robot<'a>, people: &[&Topic], told: &mut Vec<String>) -> Option<(f64, f64)> {
        let is_taken = |topic: &Topic| {
            people.iter().any(|taken| std::ptr::eq(*taken, topic))
                || matches!(robot, Robot::Topic(taken) if std::ptr::eq(*taken, topic))
        };
        let topics = self.bag.in_order();
        let goals = |topic: &&&Topic| topic.kind == Some(Kind::PoseStamped) && pick::is_called_goal(&topic.name);
        let sent = topics.iter().filter(goals).find(|topic| !topic.sightings.is_empty() && !is_taken(topic));
        let (topic, logged, which) = match (sent, robot) {
            (Some(topic), _) => {
                let which = match topic.sightings.len() {
                    1 => String::new(),
                    more => format!("the last of {more} of "),
                };
                (*topic, topic.sightings.last()?, which)
            }
            // Several goals of an agent are a tour, of which none is known to be the end.
            (None, Robot::Topic(topic)) if topic.goals.len() == 1 => (*topic, topic.goals.last()?, String::new()),
            (None, Robot::Topic(_) | Robot::Frame(_)) => return None,
        };
        let frame = logged.sighting.frame.as_deref().unwrap_or(&self.target);
        let way = self.bag.tree.way(frame, &self.target).map(|way| way.at(self.clock.time(logged)));
        let Some(Between::Known(between)) = way else {
            told.push(format!(
                "the goal of `{}` is in `{frame}`, from which no transform leads to `{}`: it is not taken; --goal X,Y tells it",
                topic.name, self.target
            ));
            return None;
        };
        let [x, y, _up] = between.then(&logged.sighting.place).shift;
        told.push(format!("goal: {which}`{}`, ({x:.2}, {y:.2}) in `{}`", topic.name, self.target));
        Some((x, y))
    }

    /// Topics of which nothing was taken.
    fn not_read(&self, robot: &Picked<Robot<'a>>, people: &Picked<Vec<&'a Topic>>) -> Option<String> {
        let is_used = |topic: &Topic| {
            matches!(topic.kind, Some(Kind::Transforms | Kind::Clock))
                || matches!(robot.taken, Robot::Topic(taken) if std::ptr::eq(taken, topic))
                || people.taken.iter().any(|taken| std::ptr::eq(*taken, topic))
                || robot.others.iter().chain(&people.others).any(|other| *other == topic.shown())
                || pick::is_called_goal(&topic.name)
                || topic.messages == 0
        };
        let is_all = self.bag.topics.iter().all(is_used);
        (!is_all).then(|| format!("not read: {}", self.bag.listed(|topic| !is_used(topic))))
    }
}

/// What of a topic's messages is not taken.
fn left_out(topic: &Topic) -> Vec<String> {
    let name = &topic.name;
    let mut told = Vec::new();
    if topic.bad > 0 {
        let why = topic.why.as_deref().unwrap_or_default();
        told.push(format!("{} of {} messages of `{name}` are left out: {why}", topic.bad, topic.messages));
    }
    if topic.wrong > 0 {
        let why = topic.first_wrong.as_deref().unwrap_or_default();
        told.push(format!("{} places of `{name}` are taken as gaps: {why}", topic.wrong));
    }
    told
}

/// Refuses messages whose times jump; tells of times that go back a little.
fn in_order(topic: &Topic, placed: &[(&Logged, Fix)]) -> Result<Option<String>, BagFault> {
    let mut back = 0_usize;
    let mut latest: Option<i64> = None;
    for (_, fix) in placed {
        if let Some(before) = latest {
            let step = fix.time.saturating_sub(before);
            if !(-BACK_NANOS..=FORTH_NANOS).contains(&step) {
                let topic = topic.name.clone();
                return Err(BagFault::Jumps { topic, from_s: secs(before), to_s: secs(fix.time) });
            }
            back += usize::from(step < 0);
        }
        latest = latest.max(Some(fix.time));
    }
    let times = if back == 1 { "once".to_owned() } else { format!("{back} times") };
    Ok((back > 0).then(|| format!("the times of `{}` go back {times}: its messages are put in order", topic.name)))
}

/// Refuses people whose times are of another clock than the robot's.
fn same_clock(robot: i64, topic: &Topic, first: i64) -> Result<(), BagFault> {
    if robot.saturating_sub(first).saturating_abs() <= CLOCKS_NANOS {
        return Ok(());
    }
    let (own, other) = (("the robot".to_owned(), secs(robot)), (topic.name.clone(), secs(first)));
    let ((early, early_s), (late, late_s)) = if robot < first { (own, other) } else { (other, own) };
    Err(BagFault::Clocks { early, early_s, late, late_s })
}

#[expect(clippy::cast_precision_loss, reason = "shown to a person")]
fn secs(nanos: i64) -> f64 {
    nanos as f64 / SECOND
}

/// The id of a person: never that of the robot.
fn person(topic: &Topic, all: &[&Topic], who: &str) -> String {
    let name = if topic.kind == Some(Kind::PoseStamped) { of_topic(topic, all) } else { who.to_owned() };
    let number = name.strip_suffix(".0").unwrap_or(&name);
    let is_robot = name.parse::<AgentId>().is_ok_and(|agent| agent == AgentId::Robot) || number.parse() == Ok(0_u32);
    if is_robot { format!("person_{name}") } else { name }
}

/// A topic of one person by the part of its name in which they are named, or by all of it.
fn of_topic(topic: &Topic, all: &[&Topic]) -> String {
    fn part(topic: &Topic) -> Option<&str> {
        topic.name.split('/').find(|part| pick::is_called_people(part))
    }
    let own = part(topic);
    let alone = own.filter(|_| all.iter().filter(|other| part(other) == own).count() == 1);
    alone.unwrap_or(&topic.name).trim_start_matches('/').to_owned()
}

/// The lines of all tracks. Everybody's are in order, and none is nearer to the one before than a step.
fn table(tracks: &mut BTreeMap<String, Track>, goal: Option<(f64, f64)>, told: &mut Vec<String>) -> Table {
    let begin = tracks.values().flat_map(|track| &track.fixes).map(|fix| fix.time).min().unwrap_or(0);
    let mut rows = Vec::new();
    let mut twice = 0_usize;
    for (id, track) in tracks {
        track.fixes.sort_by_key(|fix| fix.time);
        let before = track.fixes.len();
        let apart = |a: &Fix, b: &Fix| libm::hypot(a.x - b.x, a.y - b.y) > APART_M;
        track.fixes.dedup_by(|later, kept| later.time == kept.time && !apart(later, kept));
        twice += before - track.fixes.len();
        let last = track.fixes.last().map_or(0, |fix| fix.time);
        track.fixes.dedup_by(|later, kept| {
            let near = later.time - kept.time < THIN_NANOS && later.time > kept.time;
            near && later.time < last && !apart(later, kept)
        });
        let group = track.group.map_or_else(String::new, |group| group.to_string());
        let from = rows.len();
        for fix in &track.fixes {
            let yaw = fix.yaw.map_or_else(String::new, |yaw| format!("{yaw:.6}"));
            let number = |value: f64| format!("{value:.6}");
            let t = number(secs(fix.time.saturating_sub(begin)));
            let cells =
                vec![t, id.clone(), number(fix.x), number(fix.y), yaw, group.clone(), String::new(), String::new()];
            rows.push(Row { line: rows.len() + 2, cells });
        }
        if let (Some((x, y)), "robot", Some(row)) =
            (goal, id.as_str(), rows.get_mut(from..).and_then(<[Row]>::last_mut))
        {
            row.cells.truncate(COLUMNS.len() - 2);
            row.cells.extend([x, y].map(|value| format!("{value:.6}")));
        }
    }
    if twice > 0 {
        told.push(format!("{twice} places have the time of the one before them: the first counts"));
    }
    let head = Row { line: 1, cells: COLUMNS.map(str::to_owned).to_vec() };
    Table { separator: ',', head, rows }
}
