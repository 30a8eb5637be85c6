//! How people walk: by social forces, by avoidance, as they were recorded, or as a driver outside says; mixed in one run.

use std::collections::BTreeMap;

use socrates_bt::compile;
use socrates_crowd::model::{Room, View};
use socrates_crowd::orca::{Orca, OrcaSettings};
use socrates_crowd::tracks::Track;
use socrates_crowd::{Goal, Person, Segment};
use socrates_model::act::ActRow;
use socrates_model::recording::{ABSENT_LEAF, AgentInfo, DRIVEN_LEAF};
use socrates_model::time::STEP_SECS;
use socrates_model::{Fault, FaultCode, HumanId, Point, Vector};

use crate::driven::Driven;
use crate::human::Human;
use crate::near::Other;
use crate::run::Engine;
use crate::start;

/// Leaf name of somebody who walks as recorded.
pub(crate) const TRACK_LEAF: &str = "track";

/// How one human walks.
#[derive(Debug, Clone, Default)]
pub enum HumanModel {
    /// Social forces, the default.
    #[default]
    SocialForces,
    /// Optimal reciprocal collision avoidance: the tree says where to, the model how to get there.
    Orca(OrcaSettings),
    /// As recorded, from the first sample to the last: seen and felt by all, feels nobody, has no tree. Times of
    /// the track are times of the run. Only for people who are not in the proposal.
    Recorded(Track),
    /// As a driver outside says: see [`crate::Drivers::people`]. Their tree moves nothing; it only tells when their steps would be
    /// over, which others may wait for.
    Driven,
}

/// The model of a human at work.
#[derive(Debug, Clone, Default)]
pub(crate) enum Walks {
    #[default]
    Forces,
    Orca(Box<Orca>),
    Track {
        track: Box<Track>,
        present: bool,
    },
    Driven(Box<Driven>),
}

/// Number of the leaf of somebody who is driven: behind all others, so that a header names those as ever.
pub(crate) const DRIVEN_LEAF_NUMBER: u16 = ActRow::AFTER_ALL;

impl Engine {
    /// The same run with other models for some of its people, and with recorded people besides.
    ///
    /// Everybody not named walks by social forces. A recorded person takes an id that the proposal does not have;
    /// it stands last in the frames, with leaf `track` while it is there and `absent` (and standing where it came or
    /// left) while it is not.
    ///
    /// # Errors
    /// Every fault at once: `B-AGENTS` for an id that is not in the proposal (or is, for a recorded person),
    /// `B-RANGE` for settings that cannot be meant.
    pub fn with_models(mut self, models: &BTreeMap<HumanId, HumanModel>) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let known: Vec<HumanId> = self.humans.iter().map(|human| human.id).collect();
        let fault = |code: FaultCode, id: &HumanId, message: String| Fault::new(code, *id, message);
        for (id, model) in models {
            let place = known.iter().position(|known| known == id);
            match (model, place.and_then(|place| self.humans.get_mut(place))) {
                (HumanModel::SocialForces, Some(human)) => human.walks = Walks::Forces,
                (HumanModel::Orca(settings), Some(human)) => match Orca::new(*settings) {
                    Ok(orca) => human.walks = Walks::Orca(Box::new(orca)),
                    Err(why) => faults.push(fault(FaultCode::BRange, id, why.to_string())),
                },
                (HumanModel::Driven, Some(human)) => human.walks = Walks::Driven(Box::default()),
                (HumanModel::Recorded(track), None) => match recorded(*id, track) {
                    Ok(human) => {
                        self.header.agents.push(AgentInfo {
                            agent: human.agent(),
                            radius_m: human.radius_m,
                            speed_mps: human.speed_mps,
                            role: human.role.clone(),
                        });
                        self.humans.push(human);
                        self.timings.push(crate::rendezvous::Timing::default());
                    }
                    Err(found) => faults.extend(found),
                },
                (HumanModel::Recorded(_), Some(_)) => {
                    let message = format!("{id} is in the proposal; a recorded person takes an id that is not");
                    faults.push(fault(FaultCode::BAgents, id, message));
                }
                (HumanModel::SocialForces | HumanModel::Orca(_) | HumanModel::Driven, None) => {
                    let names: Vec<String> = known.iter().map(ToString::to_string).collect();
                    let message = format!("{id} is not in the proposal; it has {}", names.join(", "));
                    faults.push(fault(FaultCode::BAgents, id, message));
                }
            }
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        if self.humans.len() > known.len() {
            self.header.leaves.truncate(ActRow::AFTER_RULES.into());
            self.header.leaves.extend([TRACK_LEAF.to_owned(), ABSENT_LEAF.to_owned()]);
        }
        if self.humans.iter().any(Human::is_driven) {
            self.header.leaves.truncate(ActRow::AFTER_RULES.into());
            let behind = [TRACK_LEAF, ABSENT_LEAF].into_iter().chain(ActRow::leaves(true)).chain([DRIVEN_LEAF]);
            self.header.leaves.extend(behind.map(str::to_owned));
        }
        Ok(self)
    }
}

/// Somebody who walks as recorded.
fn recorded(id: HumanId, track: &Track) -> Result<Human, Vec<Fault>> {
    // It never ticks: a tree is there because everybody has one.
    let tree = socrates_bt::Tree::parse(&compile(id, &[])?)?;
    let at = track.samples().first().map_or_else(Point::origin, |sample| sample.position);
    let mut human = start::bystander(id, tree, at);
    human.walks = Walks::Track { track: Box::new(track.clone()), present: false };
    "recorded".clone_into(&mut human.role);
    human.replay(0.0);
    Ok(human)
}

impl Human {
    /// Whether it is there.
    pub(crate) const fn present(&self) -> bool {
        !matches!(self.walks, Walks::Track { present: false, .. })
    }

    /// Whether it walks as recorded.
    pub(crate) const fn is_recorded(&self) -> bool {
        matches!(self.walks, Walks::Track { .. })
    }

    /// Where somebody recorded is at a time; nothing for others.
    pub(crate) fn replay(&mut self, now_s: f64) {
        let Walks::Track { track, present } = &mut self.walks else { return };
        let me = Person { yaw: self.yaw, radius_m: self.radius_m, ..Person::standing(self.id.number(), self.at) };
        let now = track.at(now_s, &me);
        *present = now.is_some();
        self.velocity = now.as_ref().map_or_else(Vector::zeros, |person| person.velocity);
        if let Some(person) = now {
            let turn = socrates_model::geometry::wrap_angle(person.yaw - self.yaw);
            (self.at, self.yaw, self.omega) = (person.position, person.yaw, turn / STEP_SECS);
        } else {
            self.omega = 0.0;
        }
    }
}

/// The velocity that avoidance takes towards a target.
pub(crate) fn avoid(
    orca: &Orca,
    human: &Human,
    (target, speed_mps): (&Point, f64),
    others: &[Other],
    room: &mut Room,
) -> Vector {
    let person =
        |id: u32, at: Point, velocity: Vector, radius_m: f64| Person { velocity, radius_m, ..Person::standing(id, at) };
    let goal = Some(Goal { at: *target, radius_m: 0.02 });
    let mut people = vec![Person { goal, speed_mps, ..person(0, human.at, human.velocity, human.radius_m) }];
    for (number, other) in (1_u32..).zip(others) {
        let mate = human.group.is_some() && other.group == human.group;
        if !mate && other.seen {
            people.push(person(number, other.at, other.velocity, other.radius_m));
        }
    }
    let point = |at: Point| Segment { from: at, to: at };
    let walls: Vec<Segment> = human.notice.walls.iter().copied().map(point).collect();
    people.first().map_or_else(Vector::zeros, |me| {
        let (place, now_s, dt_s) = (Some(0), 0.0, STEP_SECS);
        let view = View { me, place, people: &people, walls: &walls, now_s, dt_s, index: None };
        orca.velocity(&view, room)
    })
}
