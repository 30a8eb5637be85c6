//! Which topics are the robot, the people and the goal, where several could be.

use super::bag::{Bag, Topic};
use super::fault::BagFault;
use super::frames;
use super::sight::Kind;

/// What frames of a robot are called, the preferred first (REP 105, REP 120).
const BASES: [&str; 2] = ["base_footprint", "base_link"];
/// What names of topics of people hold; any pose could be anybody's.
const PEOPLE: [&str; 5] = ["people", "person", "pedestrian", "human", "actor"];
/// How names of topics of goals end.
const GOALS: [&str; 3] = ["goal_pose", "/goal", "/move_base_simple/goal"];

/// What the user says of a bag.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Choice {
    /// Topic or frame of the robot.
    pub robot: Option<String>,
    /// Topic of the people.
    pub people: Option<String>,
}

/// Where the robot's places are from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Robot<'a> {
    Topic(&'a Topic),
    /// A frame of the tree.
    Frame(&'a str),
}

impl Robot<'_> {
    /// Its name in a sentence.
    pub(super) fn shown(&self) -> String {
        match self {
            Self::Topic(topic) => topic.shown(),
            Self::Frame(frame) => format!("the frame `{frame}` of /tf"),
        }
    }
}

/// What is taken, and what could have been.
#[derive(Debug, Clone)]
pub(super) struct Picked<T> {
    pub(super) taken: T,
    pub(super) others: Vec<String>,
}

/// Whether a topic holds places.
fn holds(topic: &Topic) -> bool {
    !topic.sightings.is_empty()
}

/// Why topics of these kinds hold no place, where they should.
fn unread(topics: &[&Topic], kinds: &[Kind]) -> Option<BagFault> {
    let is = |topic: &&&Topic| topic.kind.is_some_and(|kind| kinds.contains(&kind)) && !holds(topic);
    topics.iter().filter(is).find_map(|topic| readable(topic).err())
}

/// Refuses a topic of which most messages, or most places, cannot be read.
pub(super) fn readable(topic: &Topic) -> Result<(), BagFault> {
    let (topic_name, kind) = (topic.name.clone(), topic.kind_name.clone());
    if topic.bad.saturating_mul(2) > topic.messages {
        let why = topic.why.clone().unwrap_or_default();
        return Err(BagFault::Messages { topic: topic_name, kind, bad: topic.bad, count: topic.messages, why });
    }
    if topic.wrong > topic.sightings.len() {
        let why = topic.first_wrong.clone().unwrap_or_default();
        let count = topic.wrong + topic.sightings.len();
        return Err(BagFault::Places { topic: topic_name, kind, bad: topic.wrong, count, why });
    }
    Ok(())
}

/// How well a topic's name fits odometry: `/odom` before `/robot/odom` before `/odometry/filtered` before others.
fn odometry_rank(name: &str) -> usize {
    let fits = [name == "/odom", name.ends_with("odom"), name.contains("odom"), true];
    fits.iter().position(|fits| *fits).unwrap_or(fits.len())
}

/// Where the robot was: what the user names, else HuNavSim's own agent, else odometry, else a frame.
pub(super) fn robot<'a>(bag: &'a Bag, wanted: Option<&str>) -> Result<Picked<Robot<'a>>, BagFault> {
    let topics = bag.in_order();
    let of = |kind: Kind| topics.iter().copied().filter(move |topic| topic.kind == Some(kind) && holds(topic));
    let mut odometry: Vec<&Topic> = of(Kind::Odometry).collect();
    odometry.sort_by_key(|topic| odometry_rank(&topic.name));
    let agents = of(Kind::Agent).chain(odometry).map(Robot::Topic);
    let bases = bag.tree.named(&BASES).into_iter().map(Robot::Frame);
    let mut candidates: Vec<Robot<'a>> = agents.chain(bases).collect();
    if let Some(wanted) = wanted {
        let plain = frames::plain(wanted);
        let topic = |name: &str| frames::plain(name) == plain;
        let of_topic = candidates.iter().position(|candidate| match candidate {
            Robot::Topic(candidate) => topic(&candidate.name),
            Robot::Frame(_) => false,
        });
        let posed = || of(Kind::PoseStamped).find(|candidate| topic(&candidate.name)).map(Robot::Topic);
        let framed = || bag.tree.frame(plain).map(Robot::Frame);
        let found = of_topic.and_then(|at| candidates.get(at).copied()).or_else(posed).or_else(framed);
        let Some(taken) = found else {
            let mut have: Vec<String> = candidates.iter().map(Robot::shown).collect();
            have.extend(of(Kind::PoseStamped).map(Topic::shown));
            let have = if have.is_empty() { "there is nothing to take".to_owned() } else { have.join(", ") };
            let have = format!("to take are {have}");
            return Err(BagFault::NotThere { option: "--robot", wanted: wanted.to_owned(), have });
        };
        return Ok(Picked { taken, others: Vec::new() });
    }
    if candidates.is_empty() {
        let fault = unread(&topics, &[Kind::Agent, Kind::Odometry, Kind::Transforms]);
        return Err(fault.unwrap_or_else(|| BagFault::NoRobot { topics: bag.listed(|_| true) }));
    }
    let taken = candidates.remove(0);
    // A robot has several frames, of which those beside each other are one robot's.
    let space = |frame: &str| frame.rsplit_once('/').map(|(space, _)| space.to_owned());
    let others = candidates.iter().filter(|other| match (&taken, other) {
        (_, Robot::Topic(_)) => true,
        (Robot::Frame(taken), Robot::Frame(other)) => space(taken) != space(other),
        (Robot::Topic(_), Robot::Frame(_)) => false,
    });
    Ok(Picked { taken, others: others.map(Robot::shown).collect() })
}

/// Whether a topic is called as topics of people are.
pub(super) fn is_called_people(name: &str) -> bool {
    let name = name.to_lowercase();
    PEOPLE.iter().any(|word| name.contains(word))
}

/// Whether a topic is called as topics of goals are.
pub(super) fn is_called_goal(name: &str) -> bool {
    GOALS.iter().any(|ending| name.ends_with(ending))
}

/// The people: what the user names, else HuNavSim's agents, else people, else lists of poses, else all single poses that are
/// called so, one person each.
pub(super) fn people<'a>(
    bag: &'a Bag,
    robot: &Robot<'a>,
    wanted: Option<&str>,
) -> Result<Picked<Vec<&'a Topic>>, BagFault> {
    let topics = bag.in_order();
    let is_robot = |topic: &Topic| matches!(robot, Robot::Topic(robot) if std::ptr::eq(*robot, topic));
    let kinds = [Kind::Agents, Kind::People, Kind::PoseArray, Kind::PoseStamped];
    let free: Vec<&Topic> = topics
        .iter()
        .copied()
        .filter(|topic| topic.kind.is_some_and(|kind| kinds.contains(&kind)) && holds(topic) && !is_robot(topic))
        .collect();
    if let Some(wanted) = wanted {
        let found = free.iter().find(|topic| frames::plain(&topic.name) == frames::plain(wanted));
        let have = || format!("to take are {}", free.iter().map(|topic| topic.shown()).collect::<Vec<_>>().join(", "));
        return found.map(|topic| Picked { taken: vec![*topic], others: Vec::new() }).ok_or_else(|| {
            BagFault::NotThere {
                option: "--people",
                wanted: wanted.to_owned(),
                have: if free.is_empty() { "no topic holds people or poses".to_owned() } else { have() },
            }
        });
    }
    let is_typed = |topic: &&Topic| matches!(topic.kind, Some(Kind::Agents | Kind::People));
    let is_posed = |topic: &&Topic| is_called_people(&topic.name) && !is_called_goal(&topic.name);
    let mut candidates: Vec<&Topic> = free.iter().copied().filter(|topic| is_typed(topic) || is_posed(topic)).collect();
    candidates.sort_by_key(|topic| kinds.iter().position(|kind| topic.kind == Some(*kind)));
    let Some(first) = candidates.first().copied() else {
        return match unread(&topics, &[Kind::Agents, Kind::People]) {
            Some(fault) => Err(fault),
            None => Ok(Picked { taken: Vec::new(), others: Vec::new() }),
        };
    };
    let alone = first.kind != Some(Kind::PoseStamped);
    let (taken, others): (Vec<&Topic>, Vec<&Topic>) =
        candidates.into_iter().partition(|topic| std::ptr::eq(*topic, first) || !alone);
    Ok(Picked { taken, others: others.into_iter().map(Topic::shown).collect() })
}
