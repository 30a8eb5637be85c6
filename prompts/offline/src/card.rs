//! Cards: the canonical scenarios of `prompts/catalog`, as data.

use std::sync::LazyLock;

use serde::Deserialize;
use socrates_model::rule::RobotRule;
use socrates_model::{Action, ClauseRole, Gesture, GroupId, HumanId, PlaceClass, Predicate, Relation, Rule, Trigger};

pub use socrates_solver::Ends;

use crate::draw::Draw;

/// A canonical scenario.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Card {
    /// Id, also the name of its file.
    pub id: String,
    /// A few words.
    pub title: String,
    /// What happens, in a sentence.
    pub about: String,
    /// Its letter among the 25 canonical scenarios, `a` to `y` (Francis et al. 2023, figure 7).
    #[serde(default)]
    pub letter: Option<char>,
    /// Its number in our list of further scenarios (`prompts/catalog/README.md`).
    #[serde(default)]
    pub further: Option<u8>,
    /// Principles of social navigation that it probes, `P1` safety to `P8` context (Francis et al. 2023).
    pub principles: Vec<String>,
    /// Place classes of the encounter, the best first.
    pub places: Vec<PlaceClass>,
    /// Place classes that the map must have.
    #[serde(default)]
    pub needs: Vec<PlaceClass>,
    /// Whether the map must have a place inside a room or an elevator.
    #[serde(default)]
    pub inside: bool,
    /// Free width of the floor across the meeting node, least and most, m.
    #[serde(default)]
    pub width_m: Option<[f64; 2]>,
    /// Length of a way outside of rooms that what happens takes, at least, m.
    #[serde(default = "usual_way")]
    pub way_m: f64,
    /// Ways that meet in the meeting node, at least.
    #[serde(default)]
    pub arms: Option<usize>,
    /// Verbs of robot tasks that this card is about (`guide`, `lead`): where nothing else is asked for, it comes first.
    #[serde(default)]
    pub tasks: Vec<String>,
    /// Where the robot starts, if the card says.
    #[serde(default)]
    pub start: Option<PlaceClass>,
    /// Where the robot has to go, if the card says.
    #[serde(default)]
    pub goal: Option<PlaceClass>,
    /// How the robot's way and those who stand go together.
    #[serde(default)]
    pub ends: Ends,
    /// Largest difference of the arrival times of robot and human where their ways cross, s.
    #[serde(default = "usual_gap")]
    pub gap_s: f64,
    /// What a good robot would do.
    pub expected: String,
    /// The people who are there.
    #[serde(rename = "role")]
    pub roles: Vec<Role>,
    /// The robot's script.
    #[serde(default)]
    pub script: Vec<RobotRule>,
    /// What should be seen, beyond what every human's own part demands.
    #[serde(default, rename = "clause")]
    pub clauses: Vec<CardClause>,
}

/// A part to play.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Role {
    /// Name of the part, for the card's clauses.
    pub name: String,
    /// How it stands to the robot's way.
    pub relation: Relation,
    /// Smallest and largest number of people.
    pub count: [u32; 2],
    /// Kinds of people that may play it.
    pub who: Vec<String>,
    /// Range of the desired speed, m/s; by the person's own draw where absent.
    #[serde(default)]
    pub speed: Option<[f64; 2]>,
    /// Whether these people form a group.
    #[serde(default)]
    pub group: bool,
    /// Whether the group stands in a line instead of a circle.
    #[serde(default)]
    pub line: bool,
    /// Where they start.
    #[serde(default)]
    pub start: Option<PlaceClass>,
    /// Where they go.
    #[serde(default)]
    pub goal: Option<PlaceClass>,
    /// Reactions.
    #[serde(default, rename = "rule")]
    pub rules: Vec<RoleRule>,
}

/// A reaction with ranges in place of values.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoleRule {
    /// When.
    pub when: Vec<Trigger>,
    /// Range that replaces the distance of `when`, m.
    #[serde(default)]
    pub within_m: Option<[f64; 2]>,
    /// What.
    pub act: Action,
    /// Gesture.
    #[serde(default)]
    pub gesture: Option<Gesture>,
    /// Range of the duration, s.
    #[serde(default)]
    pub for_s: Option<[f64; 2]>,
    /// Goes on once started.
    #[serde(default)]
    pub latched: bool,
}

/// A clause with holes: `{human}` and `{group}`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CardClause {
    /// Name of the role whose every human gets the clause; none for one clause in all.
    #[serde(default)]
    pub each: Option<String>,
    /// Setup or outcome.
    pub role: ClauseRole,
    /// Whether it must hold. Default true.
    #[serde(default = "yes")]
    pub must: bool,
    /// In words.
    pub text: String,
    /// The predicate, with holes.
    pub predicate: toml::Value,
}

const fn yes() -> bool {
    true
}

/// Two come towards each other, meet and go on.
const fn usual_way() -> f64 {
    4.0
}

const fn usual_gap() -> f64 {
    4.0
}

macro_rules! cards {
    ($($id:literal)*) => { &[$(include_str!(concat!("../../catalog/", $id, ".toml")),)*] };
}

/// Every card file. Adding a card is a file and a line here.
const FILES: &[&str] = cards! {
    "frontal_approach" "pedestrian_obstruction" "human_overtaking" "robot_overtaking" "down_path"
    "intersection_crossing" "intersection_wait" "intersection_proceed" "blind_corner" "narrow_hallway"
    "narrow_doorway" "entering_room" "exiting_room" "entering_elevator" "exiting_elevator" "join_group" "leave_group"
    "robot_following" "leading" "accompanying" "crowd_navigation" "parallel_traffic" "perpendicular_traffic"
    "circular_crossing" "robot_crowding" "startled" "room_exit" "group_blocking_aisle" "corridor_follow_and_block"
    "evacuation_guide" "queue" "staff_blocks" "handover" "distracted_walker" "darting_child" "door_opens"
    "people_waiting" "emergency_team" "cleaning_area" "full_elevator" "group_passing" "group_walking" "follower"
    "curious" "frightened"
};

static CATALOG: LazyLock<Vec<Card>> = LazyLock::new(|| {
    // The files are compiled in and each is loaded by a test.
    FILES.iter().filter_map(|text| toml::from_str(text).ok()).collect()
});

/// Every card, in the order of the catalog.
#[must_use]
pub fn catalog() -> &'static [Card] {
    &CATALOG
}

/// The card of this id.
#[must_use]
pub fn card(id: &str) -> Option<&'static Card> {
    catalog().iter().find(|card| card.id == id)
}

impl RoleRule {
    /// The rule with values drawn from its ranges, in steps of 0.1.
    pub(crate) fn drawn(&self, draw: &mut Draw) -> Rule {
        let distance = self.within_m.map(|range| draw.tenths(range));
        let when = self.when.iter().cloned().map(|trigger| match distance {
            Some(m) => trigger.at_distance(m),
            None => trigger,
        });
        let when = when.collect();
        Rule {
            when,
            act: self.act.clone(),
            gesture: self.gesture,
            for_s: self.for_s.map(|range| draw.tenths(range)),
            latched: self.latched,
            ..Rule::default()
        }
    }
}

impl CardClause {
    /// The predicate and its words for a human or group; `None` where the card is not well-formed.
    pub(crate) fn filled(&self, human: Option<HumanId>, group: Option<GroupId>) -> Option<(String, Predicate)> {
        let name = human.map_or_else(String::new, |id| id.to_string());
        let mut value = serde_json::to_value(&self.predicate).ok()?;
        fill(&mut value, &name, group);
        let predicate = serde_json::from_value(value).ok()?;
        let group = group.map_or_else(String::new, |id| id.to_string());
        Some((self.text.replace("{human}", &name).replace("{group}", &group), predicate))
    }
}

fn fill(value: &mut serde_json::Value, human: &str, group: Option<GroupId>) {
    match value {
        serde_json::Value::String(text) if text == "{human}" => *text = human.to_owned(),
        serde_json::Value::String(text) if text == "{group}" => *value = serde_json::json!(group.map_or(1, |id| id.0)),
        serde_json::Value::Object(members) => members.values_mut().for_each(|member| fill(member, human, group)),
        serde_json::Value::Array(items) => items.iter_mut().for_each(|item| fill(item, human, group)),
        serde_json::Value::Null
        | serde_json::Value::Bool(_)
        | serde_json::Value::Number(_)
        | serde_json::Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::Location;

    use super::*;

    #[test]
    fn every_card_loads_and_every_file_is_listed() {
        for text in FILES {
            if let Err(error) = toml::from_str::<Card>(text) {
                panic!("{error}\n{text}");
            }
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../catalog");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .filter_map(|entry| {
                entry.unwrap().file_name().into_string().unwrap().strip_suffix(".toml").map(str::to_owned)
            })
            .collect();
        let mut ids: Vec<String> = catalog().iter().map(|card| card.id.clone()).collect();
        files.sort();
        ids.sort();
        assert_eq!(files, ids);
    }

    #[test]
    fn the_canonical_scenarios_are_all_there_once_and_most_of_the_further_ones() {
        let mut letters: Vec<char> = catalog().iter().filter_map(|card| card.letter).collect();
        letters.sort_unstable();
        assert_eq!(letters, ('a'..='y').collect::<Vec<char>>());
        let mut further: Vec<u8> = catalog().iter().filter_map(|card| card.further).collect();
        further.sort_unstable();
        assert!(further.windows(2).all(|pair| pair[0] < pair[1]), "{further:?}");
        assert!(further.len() >= 15 && further.iter().all(|number| (1..=20).contains(number)), "{further:?}");
        let table = include_str!("../../catalog/README.md");
        for card in catalog() {
            assert!(table.contains(&format!("`{}`", card.id)), "{} is not in the table of the README", card.id);
        }
    }

    #[test]
    fn every_clause_and_rule_of_every_card_is_sound() {
        let human = HumanId::new(1);
        for card in catalog() {
            let id = &card.id;
            assert!(card.clauses.iter().any(|clause| clause.role == ClauseRole::Outcome), "{id}");
            assert!(!card.places.is_empty() && !card.principles.is_empty() && !card.expected.is_empty(), "{id}");
            for principle in &card.principles {
                let number = principle.strip_prefix('P').and_then(|n| n.parse::<u8>().ok());
                assert!(number.is_some_and(|n| (1..=8).contains(&n)), "{id}: {principle}");
            }
            assert!(card.width_m.is_none_or(|[least, most]| 0.6 <= least && least < most), "{id}");
            assert!((0.5..=15.0).contains(&card.gap_s), "{id}");
            for clause in &card.clauses {
                let each = clause.each.as_ref();
                assert!(each.is_none_or(|name| card.roles.iter().any(|role| role.name == *name)), "{id} {each:?}");
                assert!(clause.filled(Some(human), Some(GroupId(1))).is_some(), "{id}: {:?}", clause.predicate);
            }
            for role in &card.roles {
                let [least, most] = role.count;
                assert!(least >= 1 && least <= most && most <= 8 && !role.who.is_empty(), "{id}");
                assert!(!role.group || least > 1, "{id}: a group of one");
                assert!(role.speed.is_none_or(|[low, high]| 0.2 <= low && low <= high && high <= 1.8), "{id}");
                for rule in &role.rules {
                    assert!(!rule.when.is_empty(), "{id}");
                    assert!(rule.within_m.is_none_or(|[low, high]| 0.5 <= low && low <= high && high <= 12.0), "{id}");
                    assert!(rule.for_s.is_none_or(|[low, high]| 1.0 <= low && low <= high && high <= 60.0), "{id}");
                }
            }
        }
    }

    fn ask(card: &Card, location: &Location, seed: u64) -> socrates_prompts::Question {
        let request: socrates_model::Request = serde_json::from_value(serde_json::json!({
            "location": location.name, "social_context": "", "task": "Deliver mail", "expect": { "pattern": card.id },
        }))
        .unwrap();
        let reading = crate::read(&request, location);
        socrates_prompts::Question::first(request, reading, location.clone(), seed)
    }

    #[test]
    fn every_card_fits_a_shipped_location_and_every_human_has_a_clause_that_decides() {
        for card in catalog() {
            let places: Vec<Location> = socrates_maps::shipped::names()
                .iter()
                .map(|name| socrates_maps::shipped::load(name).unwrap())
                .filter(|location| card.fits(location))
                .collect();
            assert!(!places.is_empty(), "{} fits nowhere", card.id);
            for (location, seed) in places.iter().flat_map(|location| (1..4).map(move |seed| (location, seed))) {
                let proposal = crate::proposal::propose(&ask(card, location, seed));
                assert_eq!(proposal.pattern, card.id);
                let deciding: Vec<&Predicate> = proposal
                    .expected_events
                    .iter()
                    .filter(|clause| clause.role == ClauseRole::Setup && clause.must)
                    .map(|clause| &clause.predicate)
                    .collect();
                for human in &proposal.humans {
                    let own = |predicate: &&&Predicate| {
                        predicate.human() == Some(human.id) || human.group.is_some() && predicate.group() == human.group
                    };
                    assert!(deciding.iter().any(|predicate| own(&predicate)), "{} {}", card.id, human.id);
                }
                // What the card says must be seen decides.
                for clause in card.clauses.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup) {
                    let (_, wanted) = clause.filled(Some(HumanId::new(1)), Some(GroupId(1))).unwrap();
                    let kind = std::mem::discriminant(&wanted);
                    assert!(
                        deciding.iter().any(|found| std::mem::discriminant(*found) == kind),
                        "{}: {wanted:?}",
                        card.id
                    );
                }
            }
        }
    }
}
