//! What is taken of each type of message: who was seen, when, and where in which frame.

use super::decode::{MessageFault, View};
use super::rigid::Rigid;

/// Largest coordinate that is believed, m: as for tables of tracks.
const REACH_M: f64 = 1e6;
/// Radii that are believed, m.
const RADII_M: std::ops::RangeInclusive<f64> = 0.05..=2.0;
/// Nanoseconds of a second.
const SECOND: f64 = 1e9;
/// Longest name of a person or frame that is kept, characters.
const NAME_CHARS: usize = 100;
/// The number that HuNavSim gives to robots among its agents.
const ROBOT: f64 = 2.0;

/// A type of messages that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// `hunav_msgs/msg/Agent`: the robot of HuNavSim.
    Agent,
    /// `nav_msgs/msg/Odometry`.
    Odometry,
    /// `hunav_msgs/msg/Agents`.
    Agents,
    /// `people_msgs/msg/People`.
    People,
    /// `geometry_msgs/msg/PoseArray`.
    PoseArray,
    /// `geometry_msgs/msg/PoseStamped`.
    PoseStamped,
    /// `tf2_msgs/msg/TFMessage`.
    Transforms,
    /// `rosgraph_msgs/msg/Clock`.
    Clock,
}

impl Kind {
    /// The kind of a type that is read, by its plain name.
    pub(super) fn of(name: &str) -> Option<Self> {
        Some(match name {
            "hunav_msgs/Agent" => Self::Agent,
            "nav_msgs/Odometry" => Self::Odometry,
            "hunav_msgs/Agents" => Self::Agents,
            "people_msgs/People" => Self::People,
            "geometry_msgs/PoseArray" => Self::PoseArray,
            "geometry_msgs/PoseStamped" => Self::PoseStamped,
            "tf2_msgs/TFMessage" => Self::Transforms,
            "rosgraph_msgs/Clock" => Self::Clock,
            _other => return None,
        })
    }
}

/// Somebody at a place, as one message has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sighting {
    /// Their name in the message, or their number in it, from 1.
    pub(super) who: String,
    /// The time stamp of the message, ns; nothing where it has none or it was never set.
    pub(super) stamp: Option<i64>,
    /// The frame of the place; nothing where the message names none.
    pub(super) frame: Option<String>,
    pub(super) place: Rigid,
    /// Whether the turn of the place is their heading.
    pub(super) faces: bool,
    pub(super) radius_m: Option<f64>,
    /// Group of HuNavSim; nothing for those in none.
    pub(super) group: Option<i64>,
    /// The frame that stands at the place.
    pub(super) child: Option<String>,
}

/// A transform, as one message has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Transform {
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) stamp: i64,
    pub(super) place: Rigid,
}

/// What one message holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Seen {
    pub(super) sightings: Vec<Sighting>,
    pub(super) transforms: Vec<Transform>,
    /// Where the agent itself says that it goes.
    pub(super) goals: Vec<Sighting>,
    /// Robots among people, who are left out.
    pub(super) robots: usize,
    /// Places and transforms with numbers that are none, and the first of them in words.
    pub(super) wrong: usize,
    pub(super) first_wrong: Option<String>,
    /// Time of the simulator, ns.
    pub(super) clock: Option<i64>,
}

impl Seen {
    fn wrong(&mut self, what: impl FnOnce() -> String) {
        self.wrong += 1;
        self.first_wrong.get_or_insert_with(what);
    }

    fn sight(&mut self, sighting: Result<Sighting, MessageFault>) -> Result<(), MessageFault> {
        match sighting {
            Ok(sighting) => self.sightings.push(sighting),
            Err(MessageFault::Value { what }) => self.wrong(|| what),
            Err(other) => return Err(other),
        }
        Ok(())
    }
}

/// Reads a message of a kind.
pub(super) fn read(kind: Kind, view: View<'_>) -> Result<Seen, MessageFault> {
    let mut seen = Seen::default();
    match kind {
        Kind::Odometry => {
            let head = Head::of(view)?;
            let child = plain(view.text("child_frame_id")?);
            let sighting = posed("robot", &head, view.part("pose")?.part("pose")?);
            seen.sight(sighting.map(|sighting| Sighting { child, ..sighting }))?;
        }
        Kind::PoseStamped => seen.sight(posed("", &Head::of(view)?, view.part("pose")?))?,
        Kind::PoseArray => {
            let head = Head::of(view)?;
            for (place, pose) in view.list("poses")?.enumerate() {
                seen.sight(posed(&(place + 1).to_string(), &head, pose))?;
            }
        }
        Kind::People => {
            let head = Head::of(view)?;
            for (place, person) in view.list("people")?.enumerate() {
                let who = or_place(person.text("name")?, place);
                let sighting = point(&who, person.part("position")?).map(|place| head.sighting(&who, place, false));
                seen.sight(sighting)?;
            }
        }
        Kind::Agents => {
            let head = Head::of(view)?;
            for (place, agent) in view.list("agents")?.enumerate() {
                if agent.number("type").is_ok_and(|kind| (kind - ROBOT).abs() < 0.5) {
                    seen.robots += 1;
                    continue;
                }
                let number = agent.number("id").map_or_else(|_lacks| String::new(), |id| format!("{id:.0}"));
                let name = agent.text("name").map(str::trim).ok().filter(|name| !name.is_empty());
                seen.sight(hunav(&or_place(name.unwrap_or(&number), place), &head, agent))?;
            }
        }
        Kind::Agent => {
            let head = Head::default();
            seen.sight(hunav("robot", &head, view))?;
            for goal in view.list("goals").into_iter().flatten() {
                seen.goals.extend(posed("goal", &head, goal).ok());
            }
        }
        Kind::Transforms => {
            for transform in view.list("transforms")? {
                transformed(transform, &mut seen)?;
            }
        }
        Kind::Clock => {
            seen.clock = time(view.part("clock")?)?;
        }
    }
    Ok(seen)
}

fn transformed(view: View<'_>, seen: &mut Seen) -> Result<(), MessageFault> {
    let head = Head::of(view)?;
    let child = plain(view.text("child_frame_id")?);
    let inner = view.part("transform")?;
    let place = Rigid::new(vector(inner.part("translation")?)?, quaternion(inner.part("rotation")?)?);
    match (head.frame, child, place) {
        (Some(parent), Some(child), Some(place)) => {
            seen.transforms.push(Transform { parent, child, stamp: head.stamp.unwrap_or(0), place });
        }
        (parent, child, _) => seen.wrong(|| {
            let name = |frame: Option<String>| frame.unwrap_or_default();
            format!("the transform from `{}` to `{}` has no name or no number", name(parent), name(child))
        }),
    }
    Ok(())
}

/// What a message says of itself.
#[derive(Debug, Clone, Default)]
struct Head {
    stamp: Option<i64>,
    frame: Option<String>,
}

impl Head {
    fn of(view: View<'_>) -> Result<Self, MessageFault> {
        let header = view.part("header")?;
        Ok(Self { stamp: time(header.part("stamp")?)?, frame: plain(header.text("frame_id")?) })
    }

    fn sighting(&self, who: &str, place: Rigid, faces: bool) -> Sighting {
        Sighting {
            who: who.to_owned(),
            stamp: self.stamp,
            frame: self.frame.clone(),
            place,
            faces,
            radius_m: None,
            group: None,
            child: None,
        }
    }
}

fn plain(frame: &str) -> Option<String> {
    let frame = super::frames::plain(frame.trim());
    (!frame.is_empty()).then(|| frame.chars().take(NAME_CHARS).collect())
}

fn or_place(name: &str, place: usize) -> String {
    let name = name.trim();
    if name.is_empty() { (place + 1).to_string() } else { name.chars().take(NAME_CHARS).collect() }
}

/// A time, ns; nothing for one that was never set.
fn time(view: View<'_>) -> Result<Option<i64>, MessageFault> {
    let (secs, nanos) = (view.number("sec")?, view.number("nanosec")?);
    let whole = secs * SECOND + nanos;
    #[expect(clippy::cast_possible_truncation, reason = "both parts have 32 bits, so that the sum has fewer than 63")]
    let stamp = secs as i64 * 1_000_000_000 + nanos as i64;
    Ok((whole > 0.0).then_some(stamp))
}

fn vector(view: View<'_>) -> Result<[f64; 3], MessageFault> {
    Ok([view.number("x")?, view.number("y")?, view.number("z")?])
}

fn quaternion(view: View<'_>) -> Result<[f64; 4], MessageFault> {
    Ok([view.number("x")?, view.number("y")?, view.number("z")?, view.number("w")?])
}

/// A position, within bounds.
fn point(who: &str, view: View<'_>) -> Result<Rigid, MessageFault> {
    let at = vector(view)?;
    let is_place = at.iter().all(|value| value.abs() <= REACH_M);
    is_place.then(|| Rigid::shifted(at)).ok_or_else(|| {
        let [x, y, z] = at;
        let name = if who.is_empty() { "the position".to_owned() } else { format!("the position of `{who}`") };
        MessageFault::Value { what: format!("{name} is ({x}, {y}, {z}) m") }
    })
}

/// A pose: where its quaternion was never set, the heading is not known.
fn posed(who: &str, head: &Head, view: View<'_>) -> Result<Sighting, MessageFault> {
    let place = point(who, view.part("position")?)?;
    let turned = Rigid::new(place.shift, quaternion(view.part("orientation")?)?);
    Ok(head.sighting(who, turned.unwrap_or(place), turned.is_some()))
}

/// An agent of HuNavSim. What its versions do not share is taken where it is there.
fn hunav(who: &str, head: &Head, view: View<'_>) -> Result<Sighting, MessageFault> {
    let mut sighting = posed(who, head, view.part("position")?)?;
    if let Some(yaw) = view.number("yaw").ok().filter(|yaw| yaw.is_finite()) {
        (sighting.place, sighting.faces) = (sighting.place.facing(yaw), true);
    }
    sighting.radius_m = view.number("radius").ok().filter(|radius| RADII_M.contains(radius));
    #[expect(clippy::cast_possible_truncation, reason = "eight bits in the message")]
    let group = view.number("group_id").ok().filter(|group| *group >= 0.0).map(|group| group as i64);
    sighting.group = group;
    Ok(sighting)
}
