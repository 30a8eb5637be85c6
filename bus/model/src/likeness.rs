//! What makes two scenarios different ones: the one definition by which repeats are named, counted and avoided.
//!
//! Two scenarios differ where the place of a meeting, the robot's start or its goal lies more than [`ELSEWHERE_M`] elsewhere;
//! where side, relation, number, roles or the order of what is done are others; or where something is triggered more than
//! [`LATER_S`] earlier or later. Pace, names, words and seeds make no difference.
//!
//! A distance at which somebody notices the robot makes a difference only as far as it is seen: behind a corner, and farther than
//! the two ever are from each other, all distances are one (module `approach`).

mod approach;

use serde::{Deserialize, Serialize};

use crate::geometry::{Point, Vector};
use crate::ids::{AgentId, HumanId, NodeId};
use crate::location::Location;
use crate::paths::{Paths, Visit};
use crate::proposal::{HumanProposal, Proposal, Relation};
use approach::Approach;

use crate::act::Action;
use crate::rule::{RobotDo, RobotWhen, Rule, Trigger};

/// Places no farther apart than this are the same place, m.
pub const ELSEWHERE_M: f64 = 3.0;
/// Times no farther apart than this are the same time, s.
pub const LATER_S: f64 = 2.0;
/// How fast robot and people come nearer to each other, m/s: a robot of 0.8 m/s, and a person of 1.2 m/s who comes towards it.
/// What is triggered by a distance is triggered at a time by it; not by the pace of this very scenario, which makes no difference.
const ROBOT_MPS: f64 = 0.8;
const TOWARDS_MPS: f64 = 2.0;
/// Sine of the angle between two ways from which on one comes from the side of the other.
const ASIDE: f64 = 0.5;
/// A difference of place or time counts for no more than so many of the smallest that makes a difference.
const MOST: f64 = 5.0;

/// The side of the robot's way that a person comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
enum Side {
    /// Along the way, or nowhere: they stand.
    Along,
    Left,
    Right,
}

/// A person's part: what of them makes a difference, without numbers.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
struct Part {
    relation: Relation,
    role: String,
    side: Side,
    /// People of their group; 0 for somebody alone.
    together: usize,
    /// How often they meet the robot.
    meets: usize,
    /// What they do and when, earlier rules first.
    acts: Vec<String>,
}

/// The kind of a scenario: all that makes a difference without a number. Scenarios of two kinds differ.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Kind {
    location: String,
    parts: Vec<Part>,
    script: Vec<String>,
    /// The people that the robot meets, one after the other.
    order: Vec<(Relation, String)>,
}

/// What of a scenario is compared: taken once, however many it is compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Likeness {
    /// Its kind.
    pub kind: Kind,
    /// The robot's start and goal, then each place of a meeting, in their order.
    places: Vec<Point>,
    /// When something is triggered, as the parts have it.
    times: Vec<Time>,
}

/// When something is triggered, s, by what is said of it alone and by how the two come near to each other on their ways. A
/// difference is one by both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Time {
    said_s: f64,
    seen_s: f64,
}

impl Time {
    /// A time that does not depend on the ways.
    const fn told(said_s: f64) -> Self {
        Self { said_s, seen_s: said_s }
    }

    /// How much earlier or later another is, s.
    fn later_s(self, other: Self) -> f64 {
        (self.said_s - other.said_s).abs().min((self.seen_s - other.seen_s).abs())
    }
}

impl Likeness {
    /// The likeness of a scenario.
    #[must_use]
    pub fn of(proposal: &Proposal, paths: &Paths, location: &Location) -> Self {
        let at = |node: &NodeId| location.graph.node(node).map(|node| node.at);
        let mut parts: Vec<(Part, Vec<Time>)> =
            proposal.humans.iter().map(|human| part(human, proposal, paths, location)).collect();
        parts.sort_by(|(a, x), (b, y)| a.cmp(b).then_with(|| compared(x, y)));
        let (parts, times): (Vec<Part>, Vec<Vec<Time>>) = parts.into_iter().unzip();
        let (script, mut script_s): (Vec<String>, Vec<Option<f64>>) =
            proposal.robot.script.iter().map(|line| scripted(&line.when, &line.act)).unzip();
        let mut times: Vec<Time> = times.into_iter().flatten().collect();
        times.extend(script_s.drain(..).flatten().map(Time::told));
        let ends = [paths.robot.first(), paths.robot.last()];
        let mut places: Vec<Point> = ends.into_iter().flatten().filter_map(at).collect();
        let mut order: Vec<(Relation, String)> = Vec::new();
        // People who are met at one node are met at one time.
        for here in paths.encounters.chunk_by(|a, b| a.node == b.node) {
            let mut met: Vec<(Relation, String)> = here
                .iter()
                .filter_map(|encounter| proposal.human(encounter.human))
                .map(|human| (human.relation, human.role.clone()))
                .collect();
            met.sort_unstable();
            order.extend(met);
            places.extend(here.iter().filter_map(|encounter| at(&encounter.node)));
        }
        let kind = Kind { location: location.name.clone(), parts, script, order };
        Self { kind, places, times }
    }

    /// Whether nothing makes a difference between the two.
    #[must_use]
    pub fn repeats(&self, other: &Self) -> bool {
        self.kind == other.kind
            && self.places.len() == other.places.len()
            && self.places.iter().zip(&other.places).all(|(a, b)| (b - a).norm() <= ELSEWHERE_M)
            && self.times.len() == other.times.len()
            && self.times.iter().zip(&other.times).all(|(a, b)| a.later_s(*b) <= LATER_S)
    }

    /// How far two scenarios are from each other, in units of the smallest difference: 0 where nothing differs, and every
    /// difference adds to it.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let (mine, theirs) = (&self.kind, &other.kind);
        let unlike = |differs: bool, weight: f64| if differs { weight } else { 0.0 };
        let relations = |kind: &Kind| kind.parts.iter().map(|part| part.relation).collect::<Vec<_>>();
        let sorted = |mut all: Vec<String>| {
            all.sort_unstable();
            all
        };
        let roles = |kind: &Kind| sorted(kind.parts.iter().map(|part| part.role.clone()).collect());
        let sides = |kind: &Kind| kind.parts.iter().map(|part| part.side).collect::<Vec<_>>();
        let acts = |kind: &Kind| sorted(kind.parts.iter().flat_map(|part| part.acts.clone()).collect());
        let said = unlike(mine.location != theirs.location, MOST)
            + unlike(mine.parts.len() != theirs.parts.len(), 2.0)
            + unlike(relations(mine) != relations(theirs), 2.0)
            + unlike(sides(mine) != sides(theirs), 2.0)
            + unlike(roles(mine) != roles(theirs), 1.0)
            + unlike(acts(mine) != acts(theirs), 1.0)
            + unlike(mine.order != theirs.order || mine.script != theirs.script, 1.0);
        let said = if said > 0.0 { said } else { unlike(mine != theirs, 1.0) };
        let far = |(a, b): (&Point, &Point)| ((b - a).norm() / ELSEWHERE_M).min(MOST);
        let ends: f64 = self.places.iter().zip(&other.places).take(2).map(far).sum();
        let met = self.places.iter().zip(&other.places).skip(2).map(far).fold(0.0, f64::max);
        let later = |(a, b): (&Time, &Time)| (a.later_s(*b) / LATER_S).min(MOST);
        said + ends + met + self.times.iter().zip(&other.times).map(later).fold(0.0, f64::max)
    }
}

/// Times one after the other.
fn compared(a: &[Time], b: &[Time]) -> std::cmp::Ordering {
    let pairs = a.iter().zip(b).map(|(x, y)| x.said_s.total_cmp(&y.said_s).then(x.seen_s.total_cmp(&y.seen_s)));
    let first = pairs.into_iter().find(|order| order.is_ne());
    first.unwrap_or_else(|| a.len().cmp(&b.len()))
}

/// A person's part and when what they do is triggered.
fn part(human: &HumanProposal, proposal: &Proposal, paths: &Paths, location: &Location) -> (Part, Vec<Time>) {
    let group = proposal.groups.iter().find(|group| group.members.contains(&human.id));
    let nearing_mps = if human.relation == Relation::Frontal { TOWARDS_MPS } else { ROBOT_MPS };
    let approach = Approach::of(human, paths, location);
    // The nearer, the later.
    let near = |trigger: &Trigger, m: f64| {
        let said_s = -m / nearing_mps;
        let seen_s = approach.as_ref().map_or(said_s, |approach| approach.since_meeting_s(trigger, m));
        Time { said_s, seen_s }
    };
    let (acts, times): (Vec<String>, Vec<Vec<Time>>) = human.rules.iter().map(|rule| act(rule, &near)).unzip();
    let part = Part {
        relation: human.relation,
        role: human.role.clone(),
        side: side(human.id, paths, location),
        together: group.map_or(0, |group| group.members.len()),
        meets: paths.encounters_of(human.id).count(),
        acts,
    };
    (part, times.into_iter().flatten().collect())
}

/// The side that a person comes from at their first meeting: by the last legs of both ways before it.
fn side(human: HumanId, paths: &Paths, location: &Location) -> Side {
    let leg = |nodes: &[NodeId], step: Option<usize>| -> Option<Vector> {
        let step = step?;
        let at = |step: usize| location.graph.node(nodes.get(step)?).map(|node| node.at);
        (at(step)? - at(step.checked_sub(1)?)?).try_normalize(1e-9)
    };
    let visits = paths.visits(human);
    let Some(Visit { robot_step, human_step, .. }) = visits.first() else { return Side::Along };
    let own = paths.of(AgentId::Human(human)).unwrap_or_default();
    let Some((robot, person)) = leg(&paths.robot, *robot_step).zip(leg(own, *human_step)) else { return Side::Along };
    // A person that walks to the left of the robot's direction comes from its right.
    match robot.perp(&person) {
        sine if sine > ASIDE => Side::Right,
        sine if sine < -ASIDE => Side::Left,
        _ => Side::Along,
    }
}

/// What is done and when, without numbers and ids, and the times of it; `near` is when the robot is that near.
fn act(rule: &Rule, near: &dyn Fn(&Trigger, f64) -> Time) -> (String, Vec<Time>) {
    let mut words: Vec<String> = Vec::new();
    let mut times: Vec<Time> = Vec::new();
    for trigger in &rule.when {
        match trigger {
            Trigger::AfterSecs(s) => {
                words.push("after".to_owned());
                times.push(Time::told(*s));
            }
            // Ids are numbers: who it is, the gesture says.
            Trigger::HumanSays(_, gesture) => words.push(format!("a human says {gesture}")),
            // The order of the rules says whose step it is, and which.
            Trigger::Did(..) => words.push("once a step is over".to_owned()),
            Trigger::Done(_) => words.push("once somebody is done".to_owned()),
            Trigger::StoppedFor(s) => {
                words.push("the robot has stood".to_owned());
                times.push(Time::told(*s));
            }
            Trigger::Always
            | Trigger::RobotVisible(_)
            | Trigger::RobotNear(_)
            | Trigger::RobotBlocking(_)
            | Trigger::RobotMoving
            | Trigger::RobotStopped
            | Trigger::RobotPassed
            | Trigger::RobotSays(_)
            | Trigger::GoalReached
            | Trigger::AtEncounter => {
                words.push(trigger.clone().at_distance(0.0).phrase());
                times.extend(trigger.distance_m().map(|m| near(trigger, m)));
            }
        }
    }
    let done = if matches!(rule.act, Action::FollowHuman(_)) {
        "follow a human".to_owned()
    } else if matches!(rule.act, Action::LookAt(_)) {
        "look at a human".to_owned()
    } else {
        rule.act.they()
    };
    let gesture = rule.gesture.map_or_else(String::new, |gesture| format!(" and say {gesture}"));
    (format!("{}: {done}{gesture}", words.join(" and ")), times)
}

/// The same of a line of the robot's script.
fn scripted(when: &RobotWhen, act: &RobotDo) -> (String, Option<f64>) {
    let (word, time_s) = match when {
        RobotWhen::Start => ("start".to_owned(), None),
        RobotWhen::Blocked(s) => ("blocked".to_owned(), Some(*s)),
        RobotWhen::HumanNear(m) | RobotWhen::Near(_, m) => ("near".to_owned(), Some(-m / ROBOT_MPS)),
        RobotWhen::HumanSays(gesture) => (format!("hears {gesture}"), None),
        RobotWhen::AtEncounter(_) => ("meets".to_owned(), None),
        RobotWhen::AfterSecs(s) => ("after".to_owned(), Some(*s)),
        RobotWhen::Did(..) | RobotWhen::Done(_) => ("after a human".to_owned(), None),
        RobotWhen::AfterLine(_) => ("then".to_owned(), None),
    };
    let done = match act {
        RobotDo::Say(gesture) => format!("says {gesture}"),
        RobotDo::Hold(_) | RobotDo::HoldUntil(_) => "holds".to_owned(),
        RobotDo::WaitForLeavers => "waits for leavers".to_owned(),
        RobotDo::Follow(_) => "follows".to_owned(),
        RobotDo::Abreast(_) => "goes beside".to_owned(),
        RobotDo::Overtake(_) => "overtakes".to_owned(),
        RobotDo::Lead(_) => "leads".to_owned(),
    };
    (format!("{word}: {done}"), time_s)
}

#[cfg(test)]
mod tests;
