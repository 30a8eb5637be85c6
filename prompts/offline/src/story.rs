//! The people of a scenario and what they do, as a text or a form says it: what the layers above make a reading of.

use socrates_model::proposal::Facing;
use socrates_model::reading::ReadHuman;
use socrates_model::{Action, AgentId, Fault, Gesture, GroupId, HumanId, PlaceClass, Relation, Rule, Side, Trigger};
use socrates_reader::Act;

/// A rule with where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReadRule {
    pub(crate) rule: Rule,
    /// The words it was read from.
    pub(crate) quote: String,
    /// Whether the text says when.
    pub(crate) stated: bool,
    /// Whether the text says how near.
    pub(crate) exact: bool,
    /// Whether the text says how long.
    pub(crate) lasts: bool,
    /// Whether it follows the one before: `and then`.
    pub(crate) then: bool,
}

impl ReadRule {
    /// Whether it waits for somebody's word.
    pub(crate) fn waits_for_word(&self) -> bool {
        self.rule.when.iter().any(|trigger| matches!(trigger, Trigger::RobotSays(_) | Trigger::HumanSays(..)))
    }
}

/// One human.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Person {
    /// Role word; empty where the text says no more than that somebody is there.
    pub(crate) role: String,
    /// `participant`, `bystander`: the word that says no more than that.
    pub(crate) called: Option<String>,
    /// How they stand to the robot's way, with the words.
    pub(crate) relation: Option<(Relation, String)>,
    /// Words by which whoever comes out crosses the robot's way then.
    pub(crate) crosses: Option<String>,
    /// Side of the robot's way, with the words.
    pub(crate) side: Option<(Side, String)>,
    /// Where they face at first, with the words.
    pub(crate) facing: Option<(Facing, String)>,
    /// What they do, earlier ones first.
    pub(crate) rules: Vec<ReadRule>,
    /// Their group.
    pub(crate) group: Option<GroupId>,
    /// How fast they walk, m/s.
    pub(crate) speed_mps: Option<f64>,
    /// The kind of place that they come from, or are in.
    pub(crate) start: Option<PlaceClass>,
    /// The kind of place that they go into.
    pub(crate) goal: Option<PlaceClass>,
    /// What they do, for the reading line, in order.
    pub(crate) doings: Vec<String>,
    /// Whether they walk, without more being said of how.
    pub(crate) walks: bool,
    /// Whether they are startled by the robot.
    pub(crate) startled: bool,
    /// Words by which they meet the robot twice; where the second time, if said.
    pub(crate) twice: Option<(Option<PlaceClass>, String)>,
    /// What they do not do, with the words.
    pub(crate) never: Vec<(Act, String)>,
}

impl Person {
    /// Whether they stand so to the robot's way.
    pub(crate) fn is(&self, relation: Relation) -> bool {
        self.relation.as_ref().is_some_and(|(own, _)| *own == relation)
    }

    /// Whether they do it at some time.
    pub(crate) fn does(&self, act: &Action) -> bool {
        self.rules.iter().any(|read| read.rule.act == *act)
    }

    /// Adds what they do to the reading line, once.
    pub(crate) fn tell(&mut self, doing: String) {
        if !doing.is_empty() && !self.doings.contains(&doing) {
            self.doings.push(doing);
        }
    }
}

/// What is known of one human beyond the reading.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Extra {
    pub(crate) speed_mps: Option<f64>,
    pub(crate) start: Option<PlaceClass>,
    pub(crate) goal: Option<PlaceClass>,
    /// Per rule: whether the text says when.
    pub(crate) stated: Vec<bool>,
    /// Per rule: whether the text leaves open how near the robot is then; empty for the rules of a card, which draws its own.
    pub(crate) open: Vec<bool>,
}

/// People who belong together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Group {
    pub(crate) id: GroupId,
    /// Numbers of its people, from 0.
    pub(crate) members: Vec<usize>,
    /// Whether they stand one behind the other.
    pub(crate) queue: bool,
    /// The words that say so.
    pub(crate) quote: String,
}

/// Two of whom one meets the robot, or goes through a door, before the other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Before {
    pub(crate) first: AgentId,
    pub(crate) then: AgentId,
    pub(crate) at_door: bool,
    pub(crate) quote: String,
}

/// Something that was understood, and is not played as it was said.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unplayed {
    /// Words of the text.
    pub(crate) quote: String,
    /// Why, and what is played instead.
    pub(crate) why: String,
}

/// A kind of place with the words that say it.
pub(crate) type Place = (PlaceClass, String);

/// Everything that is said of a scenario.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Story {
    pub(crate) people: Vec<Person>,
    pub(crate) groups: Vec<Group>,
    /// Where people meet the robot.
    pub(crate) place: Option<Place>,
    /// Where the robot's way begins, and where it ends.
    pub(crate) robot_leaves: Option<Place>,
    pub(crate) robot_enters: Option<Place>,
    /// Signs of the robot, with the words.
    pub(crate) robot_says: Vec<(Gesture, String)>,
    pub(crate) order: Vec<Before>,
    /// Whether the text says that nobody is there.
    pub(crate) nobody: bool,
    /// Words that said how many there are.
    pub(crate) count_quote: Option<String>,
    /// What cannot be, or is not played.
    pub(crate) problems: Vec<Fault>,
    /// What was assumed.
    pub(crate) notes: Vec<String>,
    pub(crate) unplayed: Vec<Unplayed>,
}

impl Story {
    /// How somebody stands to the robot's way: as said, or as follows from their group and from what they do.
    pub(crate) fn relation_of(&self, who: usize) -> Option<Relation> {
        let person = self.people.get(who)?;
        if let Some((relation, _)) = &person.relation {
            return Some(*relation);
        }
        if let Some(group) = person.group.and_then(|id| self.groups.iter().find(|group| group.id == id)) {
            return Some(self.relation_in(group));
        }
        if person.does(&Action::FollowRobot) {
            return Some(if follows_later(person) { Relation::Frontal } else { Relation::Behind });
        }
        if let Some(leader) = person.rules.iter().find_map(|read| leader(&read.rule.act)) {
            let known = leader.checked_sub(1).filter(|leader| *leader < who);
            return known.and_then(|leader| self.relation_of(leader)).or(Some(Relation::Frontal));
        }
        let place = self.place.as_ref().map(|(class, _)| *class);
        // In a doorway or an aisle there is only one way, and two meet on it.
        let one_way = matches!(place, Some(PlaceClass::Doorway | PlaceClass::NarrowPassage));
        let signals = |read: &ReadRule| matches!(read.rule.gesture, Some(Gesture::Wait | Gesture::Proceed));
        if person.rules.iter().any(signals) {
            return Some(if one_way { Relation::Frontal } else { Relation::Crossing });
        }
        // Whoever is followed stands to the robot as those behind do.
        let follows = |other: &&Person| other.does(&Action::FollowHuman(human_id(who)));
        let behind = self.people.iter().filter(follows).find_map(|other| other.relation.as_ref());
        if let Some((relation, _)) = behind {
            return Some(*relation);
        }
        Some(if place == Some(PlaceClass::Intersection) { Relation::Crossing } else { Relation::Frontal })
    }

    /// How those of a group stand to the robot's way of whom nothing is said of it.
    fn relation_in(&self, group: &Group) -> Relation {
        let members: Vec<&Person> = group.members.iter().filter_map(|who| self.people.get(*who)).collect();
        if let Some((relation, _)) = members.iter().find_map(|person| person.relation.as_ref()) {
            return *relation;
        }
        let any = |act: &Action| members.iter().any(|person| person.does(act));
        // Those who follow and those who flee at the sight of the robot have to see it come: they stand where it passes.
        match (any(&Action::FollowRobot), any(&Action::RunAway)) {
            (true, true) => Relation::Static,
            (true, false) => Relation::Behind,
            (false, _) if members.iter().any(|person| person.walks || !person.rules.is_empty()) => Relation::Frontal,
            (false, _) => Relation::Static,
        }
    }
}

/// Whether a place has walls and a door: a room, or the car of an elevator.
pub(crate) const fn is_closed(class: PlaceClass) -> bool {
    matches!(class, PlaceClass::Room | PlaceClass::Elevator)
}

/// Whether somebody who follows the robot is met by it first: at its word, or after it has passed.
fn follows_later(person: &Person) -> bool {
    let hears = |read: &ReadRule| read.rule.when.iter().any(|when| matches!(when, Trigger::RobotSays(_)));
    let other = |read: &ReadRule| !matches!(read.rule.act, Action::FollowRobot | Action::Navigate);
    let passed = |read: &ReadRule| read.rule.act == Action::FollowRobot && read.rule.when == [Trigger::RobotPassed];
    person.rules.first().is_some_and(|first| hears(first) && other(first)) || person.rules.iter().any(passed)
}

/// The number of whoever is followed.
fn leader(act: &Action) -> Option<usize> {
    let Action::FollowHuman(leader) = act else { return None };
    usize::try_from(leader.number()).ok()
}

/// The human at this place of a story, from 0.
pub(crate) fn human_id(at: usize) -> HumanId {
    HumanId::new(u32::try_from(at + 1).unwrap_or(u32::MAX))
}

/// The same as an agent.
pub(crate) fn agent(at: usize) -> AgentId {
    AgentId::Human(human_id(at))
}

/// How somebody stands to the robot's way, for the reading line.
pub(crate) fn stands(relation: Relation, start: Option<PlaceClass>) -> String {
    let from = || crate::place::words(start.unwrap_or(PlaceClass::Room));
    match relation {
        Relation::Frontal => "comes towards the robot".to_owned(),
        Relation::Behind => "comes from behind".to_owned(),
        Relation::Ahead => "walks ahead of the robot".to_owned(),
        Relation::Crossing => "crosses".to_owned(),
        Relation::Abreast => "walks beside the robot".to_owned(),
        Relation::Aside => "stands beside the robot's way".to_owned(),
        Relation::Static => "stands".to_owned(),
        Relation::Leaving if start == Some(PlaceClass::Elevator) => "leaves the elevator".to_owned(),
        Relation::Leaving => format!("comes out of the {}", from()),
        Relation::Staying => format!("stays in the {}", from()),
    }
}

impl Before {
    /// Tells in the line of the later of two whom they come after.
    pub(crate) fn tell(&self, humans: &mut [ReadHuman]) {
        let who = |agent: &AgentId| if *agent == AgentId::Robot { "the robot".to_owned() } else { agent.to_string() };
        let (told, words) = match (&self.first, &self.then) {
            (_, AgentId::Human(then)) => (then, format!("after {}", who(&self.first))),
            (AgentId::Human(first), AgentId::Robot) => (first, "before the robot".to_owned()),
            (AgentId::Robot, AgentId::Robot) => return,
        };
        if let Some(human) = humans.iter_mut().find(|human| human.id == *told) {
            let joint = if human.summary.is_empty() { "" } else { ", " };
            human.summary.push_str(&format!("{joint}{words}"));
        }
    }
}
