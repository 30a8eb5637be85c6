//! Planted facts: what another run of the library states and this run does not hold, by which a judge who agrees to everything is found out.

use std::collections::BTreeSet;

use socrates_model::{Action, AgentId, Event, EventKind, Fact, FactKind, Gesture, Reading, Recording, Relation};

use super::super::blind::shuffle;
use super::facts::Asked;

/// One planted fact for so many true ones, rounded, and one at least: one in five.
const TRUE_ONES: usize = 4;
/// Nobody who comes no farther than this from where they are first walks, m.
const STAYS_M: f64 = 0.5;
/// Somebody who comes as far as this from where they are first walks, m.
const WALKS_M: f64 = 3.0;
/// Below this somebody stands, m/s.
const STANDS_MPS: f64 = 0.15;
/// Standing for less than this is no standing, s.
const STANDS_S: f64 = 2.0;

/// An act that pictures tell from others, unless people of the run stand to the robot's way in a manner that looks like it.
struct Telling {
    act: Action,
    alike: &'static [Relation],
}

/// The acts by which a planted fact is known to be false. Acts that are seen in any run (walking on, standing still, stepping aside) are
/// none of them.
const TELLING: [Telling; 6] = [
    Telling { act: Action::FollowRobot, alike: &[Relation::Behind, Relation::Abreast] },
    Telling { act: Action::RunAway, alike: &[Relation::Ahead, Relation::Leaving] },
    Telling { act: Action::Block, alike: &[Relation::Static, Relation::Frontal, Relation::Ahead, Relation::Staying] },
    Telling { act: Action::Approach, alike: &[Relation::Frontal, Relation::Static, Relation::Behind] },
    Telling { act: Action::LookAtRobot, alike: &[Relation::Static, Relation::Staying, Relation::Aside] },
    Telling { act: Action::TurnBack, alike: &[] },
];
/// How somebody who walks stands to the robot's way.
const WALKING: [Relation; 6] =
    [Relation::Frontal, Relation::Behind, Relation::Ahead, Relation::Crossing, Relation::Leaving, Relation::Abreast];
/// How somebody who stands does.
const STANDING: [Relation; 3] = [Relation::Static, Relation::Staying, Relation::Aside];

/// What another run of the library states.
#[derive(Debug, Clone)]
pub(super) struct Stated {
    /// How many people its request has.
    pub(super) people: u32,
    pub(super) fact: Asked,
}

/// How many facts are planted among so many.
pub(super) fn wanted(facts: usize) -> usize {
    ((facts + TRUE_ONES / 2) / TRUE_ONES).max(1)
}

/// Facts that this run does not hold, as many as are [`wanted`] or as there are, drawn by the seed: of requests with as many people, and
/// none that this request states itself.
pub(super) fn planted(
    stated: &[Stated],
    own: &[Asked],
    people: u32,
    reading: &Reading,
    recording: &Recording,
    seed: u64,
) -> Vec<String> {
    let held = Held::of(reading, recording);
    let plain = |words: &str| words.trim_end_matches(['.', '!']).to_lowercase();
    let mut known: BTreeSet<String> = own.iter().map(|one| plain(&one.words)).collect();
    let mut left: Vec<&str> = Vec::new();
    for one in stated.iter().filter(|one| one.people == people) {
        let words = one.fact.words.as_str();
        if one.fact.kinds.iter().any(|kind| held.lacks(kind)) && known.insert(plain(words)) {
            left.push(words);
        }
    }
    // The order of bundles on the command line makes no difference.
    left.sort_unstable();
    shuffle(&mut left, seed);
    left.into_iter().take(wanted(own.len())).map(str::to_owned).collect()
}

/// What a run holds, as far as a planted fact must not say it.
struct Held<'a> {
    recording: &'a Recording,
    relations: BTreeSet<Relation>,
    gestures: BTreeSet<Gesture>,
    /// Whether any person walks, and whether any stands for a while.
    walks: bool,
    stands: bool,
}

impl<'a> Held<'a> {
    fn of(reading: &Reading, recording: &'a Recording) -> Self {
        let stated =
            |fact: &Fact| if let FactKind::Relates { relation, .. } = fact.kind { Some(relation) } else { None };
        let relations = reading.facts.iter().filter_map(stated);
        let made = |event: &Event| if let EventKind::Gesture { gesture, .. } = event.kind { gesture } else { None };
        let gestures = recording.events.iter().filter_map(made);
        let humans = || recording.header.agents.iter().map(|info| info.agent).filter(|agent| agent.number() != 0);
        Self {
            recording,
            relations: relations.chain(reading.humans.iter().filter_map(|human| human.relation)).collect(),
            gestures: gestures.collect(),
            walks: humans().any(|agent| reach_m(recording, agent) > STAYS_M),
            stands: humans()
                .any(|agent| reach_m(recording, agent) < WALKS_M || standing_s(recording, agent) >= STANDS_S),
        }
    }

    /// Whether the run is known not to hold what a fact says.
    fn lacks(&self, kind: &FactKind) -> bool {
        match kind {
            FactKind::Gestures { gesture, .. }
            | FactKind::GesturesTo { gesture, .. }
            | FactKind::RobotSays(gesture) => !self.gestures.contains(gesture),
            FactKind::Reacts { rule, .. } => {
                rule.gesture.is_some_and(|gesture| !self.gestures.contains(&gesture)) || self.lacks_act(&rule.act)
            }
            FactKind::Relates { relation, .. } => {
                (WALKING.contains(relation) && !self.walks) || (STANDING.contains(relation) && !self.stands)
            }
            FactKind::Humans(_)
            | FactKind::Group { .. }
            | FactKind::Side { .. }
            | FactKind::Facing { .. }
            | FactKind::Pace { .. }
            | FactKind::Goal { .. }
            | FactKind::MeetsAt { .. }
            | FactKind::MeetsTimes { .. }
            | FactKind::Before { .. }
            | FactKind::Place(_)
            | FactKind::RobotTask(_)
            | FactKind::RobotStart(_)
            | FactKind::RobotGoal(_)
            | FactKind::RobotAt { .. }
            | FactKind::RobotDoes(_)
            | FactKind::Asked { .. }
            | FactKind::Pattern(_) => false,
        }
    }

    fn lacks_act(&self, act: &Action) -> bool {
        let Some(telling) = TELLING.iter().find(|telling| telling.act == *act) else { return false };
        let runs = |kind: &EventKind| matches!(kind, EventKind::Leaf { leaf, .. } if act.is_leaf(leaf));
        !telling.alike.iter().any(|relation| self.relations.contains(relation))
            && !self.recording.events.iter().any(|event| runs(&event.kind))
    }
}

/// How far somebody comes from where they are first, m.
fn reach_m(recording: &Recording, agent: AgentId) -> f64 {
    let absent = recording.header.absent();
    let mut track = recording.track(agent).filter(|state| state.is_there(absent));
    let Some(first) = track.next() else { return 0.0 };
    track.map(|state| (state.x - first.x).hypot(state.y - first.y)).fold(0.0, f64::max)
}

/// How long somebody stands in all, s.
fn standing_s(recording: &Recording, agent: AgentId) -> f64 {
    let absent = recording.header.absent();
    let slow = recording.track(agent).filter(|state| state.is_there(absent) && state.speed() < STANDS_MPS).count();
    #[expect(clippy::cast_precision_loss, reason = "a run has fewer than 2^53 ticks")]
    let ticks = slow as f64;
    ticks * recording.header.step_s
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};
    use socrates_model::{AgentState, SimTime};

    use super::*;

    /// A robot and one person who goes along x at this speed for 10 s.
    fn recording(mps: f64, events: &[EventKind]) -> Recording {
        let header = json!({"format": 1, "run": "x-1.reference-1", "planner": "reference", "seed": 1, "profile": "native",
            "step_s": 0.01, "leaves": ["", "RegularNav"], "agents": [
                {"agent": "robot", "radius_m": 0.3, "speed_mps": 0.8, "role": "robot"},
                {"agent": "human_1", "radius_m": 0.28, "speed_mps": 1.2, "role": "clerk"}]});
        let state = |tick: u32, agent: u32| {
            let (speed, x) =
                if agent == 0 { (0.5, f64::from(tick) * 0.005) } else { (mps, f64::from(tick) * 0.01 * mps) };
            let flags = AgentState::flags(AgentId::from_number(agent), None, 1);
            let y = f64::from(agent);
            AgentState { tick: u64::from(tick), agent, flags, x, y, yaw: 0.0, vx: speed, vy: 0.0, omega: 0.0 }
        };
        Recording {
            header: serde_json::from_value(header).unwrap(),
            frames: (0..1000).flat_map(|tick| [state(tick, 0), state(tick, 1)]).collect(),
            events: events.iter().map(|kind| Event { time: SimTime::from_nanos(0), kind: kind.clone() }).collect(),
        }
    }

    fn reading(relation: &str) -> Reading {
        let fact = json!({"id": "f1", "quote": "", "kind": {"relates": {"human": "human_1", "relation": relation}}});
        let value = json!({"format": 1, "humans": [], "task": "", "facts": [fact], "notes": [], "problems": []});
        serde_json::from_value(value).unwrap()
    }

    fn lacks(held: &Recording, relation: &str, kind: Value) -> bool {
        Held::of(&reading(relation), held).lacks(&serde_json::from_value(kind).unwrap())
    }

    fn reacts(act: &str, gesture: Option<&str>) -> Value {
        json!({"reacts": {"human": "human_1", "rule": {"when": [{"robot_visible": 5.0}], "act": act, "gesture": gesture.unwrap_or("NONE")}}})
    }

    #[test]
    fn an_act_is_lacked_where_no_leaf_does_it_and_nobody_looks_like_it() {
        let walk = recording(1.0, &[]);
        assert!(lacks(&walk, "frontal", reacts("run_away", None)));
        assert!(!lacks(&walk, "ahead", reacts("run_away", None)), "who walks ahead of the robot goes away from it");
        assert!(!lacks(&walk, "behind", reacts("follow_robot", None)));
        let AgentId::Human(human) = AgentId::from_number(1) else { panic!("1 is a person") };
        let fled = recording(1.0, &[EventKind::Leaf { human, leaf: "RunAwayFromRobot".to_owned() }]);
        assert!(!lacks(&fled, "frontal", reacts("run_away", None)), "it happened");
        // What is seen in any run is never known to be false.
        for act in ["navigate", "stand_still", "give_way"] {
            assert!(!lacks(&walk, "frontal", reacts(act, None)), "{act}");
        }
    }

    #[test]
    fn a_gesture_is_lacked_where_nobody_makes_it() {
        let agent = AgentId::from_number(1);
        let said = recording(1.0, &[EventKind::Gesture { agent, gesture: Some(Gesture::Wait), to: None }]);
        let gesture = |word: &str| json!({"gestures": {"human": "human_1", "gesture": word}});
        assert!(!lacks(&said, "frontal", gesture("WAIT")) && lacks(&said, "frontal", gesture("PROCEED")));
        assert!(lacks(&said, "static", reacts("look_at_robot", Some("PROCEED"))));
        assert!(!lacks(&said, "static", reacts("look_at_robot", Some("WAIT"))));
    }

    #[test]
    fn walking_is_lacked_where_all_stand_and_standing_where_all_walk() {
        let relates = |relation: &str| json!({"relates": {"human": "human_1", "relation": relation}});
        let (stand, walk) = (recording(0.0, &[]), recording(1.0, &[]));
        assert!(lacks(&stand, "static", relates("crossing")) && !lacks(&stand, "static", relates("aside")));
        assert!(lacks(&walk, "frontal", relates("static")) && !lacks(&walk, "frontal", relates("crossing")));
        assert!(!lacks(&walk, "frontal", json!({"humans": 7})));
    }

    #[test]
    fn what_is_planted_is_false_here_of_as_many_people_and_the_same_for_a_seed() {
        let stated = |words: &str, people: u32, kind: Value| Stated {
            people,
            fact: Asked {
                words: words.to_owned(),
                quote: String::new(),
                kinds: vec![serde_json::from_value(kind).unwrap()],
                program: None,
            },
        };
        let own = [stated("They wave STOP.", 1, reacts("turn_back", None)).fact];
        let all = [
            stated("They turn back.", 1, reacts("turn_back", None)),
            stated("They turn back!", 1, reacts("turn_back", None)),
            stated("They run away.", 1, reacts("run_away", None)),
            stated("Both run away.", 2, reacts("run_away", None)),
            stated("They walk on.", 1, reacts("navigate", None)),
            stated("they wave stop", 1, reacts("turn_back", None)),
        ];
        let run = recording(1.0, &[]);
        let planted = |seed: u64, all: &[Stated]| planted(all, &own, 1, &reading("frontal"), &run, seed);
        let drawn: BTreeSet<String> = (0..20).flat_map(|seed| planted(seed, &all)).collect();
        assert_eq!(drawn, ["They run away.", "They turn back."].map(str::to_owned).into());
        let mut other = all.to_vec();
        other.reverse();
        other.retain(|one| one.fact.words != "They turn back!");
        assert_eq!(planted(3, &all), planted(3, &other), "the order of the library makes no difference");
        assert_eq!([1, 4, 6, 8, 12].map(wanted), [1, 1, 2, 2, 3]);
    }
}
