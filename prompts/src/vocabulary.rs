//! Tables of the prompts, made from the types that the readers take.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};
use socrates_model::form::{Deed, PlaceWord, RobotDeed, RobotMoment, When};
use socrates_model::proposal::Relation;
use socrates_model::reading::FactKind;
use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{
    Action, AgentId, ClauseRole, Gesture, GroupId, HumanId, PlaceClass, Predicate, Proposal, RobotRule, Trigger,
};

use crate::hints::Words;
use crate::terse;

/// Everything a proposal may say, in its short form.
pub(crate) fn proposal_tables() -> String {
    let usual = predicates().into_iter().filter(|test| !matches!(test.shown, Shown::Called(_)));
    let (setup, outcome): (Vec<_>, Vec<_>) = usual.partition(|test| test.role == ClauseRole::Setup);
    let tests = |rows: Vec<Test>| -> String { rows.iter().map(Test::told).collect() };
    format!(
        "# Lines\nA rule: `robot_near:2 + robot_moving -> run_away for=5 gesture=WAIT latched`; after the action only what is needed. \
         `for`: so many seconds in all, while the triggers hold; `latched`: also when they no longer do. A line of the script: `blocked:3 -> say:EXCUSE_ME`. A test: \
         `meets human=human_1 within_m=2.5 source=f1`, pairs as `gap_m=0.5..3.5`. Usual values: `within_m` (at most so far) 2.5, \
         `for_s` (at least so long; half of its rule's `for`) 3, `gap_s` (both there within so many seconds) 4, `by_m` (so much farther) 2, `spread_m` (from the middle of the group) \
         1.5, walking 3.\n\
         Triggers: {}\nActions: {}\nGestures: {}\n## Relations to the robot's way\n{}Script, when: {}\nScript, act: {}\n\
         ## Tests for setup\n{}## Tests for outcome\n{}",
        forms(&triggers()),
        forms(&actions()),
        Gesture::ALL.iter().map(|gesture| told_gesture(*gesture)).collect::<Vec<_>>().join(", "),
        short(&relations()),
        listed(&robot_when()),
        listed(&robot_do()),
        tests(setup),
        tests(outcome),
    )
}

/// Everything that a scenario may say: relations, acts, moments, signs, and the robot's moments and deeds.
pub(crate) fn scenario_tables() -> String {
    let lines = |rows: &[(Value, String)]| -> String {
        let each =
            rows.iter().map(
                |(form, meaning)| {
                    if meaning.is_empty() { format!("{form}\n") } else { format!("{form} {meaning}\n") }
                },
            );
        each.collect()
    };
    let signs: Vec<String> = Gesture::ALL.iter().map(|gesture| told_gesture(*gesture)).collect();
    format!(
        "## relation\n{}## act\n{}## when, until: one or a list, all of which hold; m between centers\n{}## say\n{}\n\
         ## robot.does: when\n{}## robot.does: one of\n{}",
        short(&relations()),
        lines(&deeds()),
        lines(&moments()),
        signs.join(", "),
        lines(&robot_moments()),
        lines(&robot_deeds()),
    )
}

fn deeds() -> Vec<(Value, String)> {
    let nurse = || "human_2".to_owned();
    vec![
        row(&Deed::Navigate, "walks on"),
        row(&Deed::StandStill, ""),
        row(&Deed::LookAtRobot, "stands and turns to it"),
        row(&Deed::LookAt(nurse()), ""),
        row(&Deed::FollowRobot, "at 1 to 2 m"),
        row(&Deed::FollowHuman(nurse()), ""),
        row(&Deed::RunAway, ""),
        row(&Deed::GiveWay, "steps aside"),
        row(&Deed::MakeRoom, "for those who stand: out of the robot's way, and back once it has passed"),
        row(&Deed::Block, "stays in front of it"),
        row(&Deed::Approach, "comes up to it, to 1.2 m; `near_m` 0.7 to 2"),
        row(&Deed::TurnBack, "walks back the way they came, from then on; for those who walk by their relation"),
        row(&Deed::GoTo(PlaceWord::Class(PlaceClass::Corridor)), "leaves the way for such a place, and stays there"),
        row(&Deed::ChangePace, "walks on at the `pace` of the step; for those who walk by their relation"),
    ]
}

fn moments() -> Vec<(Value, String)> {
    let nurse = || "human_2".to_owned();
    vec![
        row(&When::Always, "from the start"),
        row(&When::RobotVisible(5.0), "seen within so many m, 0.3 to 15; never by those who walk ahead of it"),
        row(&When::RobotNear(2.0), "through walls too"),
        row(&When::RobotBlocking(2.0), "near, and stands in their way"),
        row(&When::RobotMoving, ""),
        row(&When::RobotStopped, ""),
        row(&When::StoppedFor(3.0), "s"),
        row(&When::RobotPassed, "was near and goes away again"),
        row(&When::RobotSays(Gesture::ExcuseMe), ""),
        row(&When::HumanSays(nurse(), Gesture::Wait), ""),
        row(&When::Did(nurse(), 1), "the first step of their `does` has ended"),
        row(&When::Done(nurse()), "all their steps have ended; without steps: they are past where they meet the robot"),
        row(&When::AtEncounter, "they are where they meet the robot"),
        row(&When::GoalReached, "they are at the end of their way"),
        row(&When::AfterSecs(10.0), "after the start of the run"),
    ]
}

fn robot_moments() -> Vec<(Value, String)> {
    vec![
        row(&RobotMoment::Start, "unless stated"),
        row(&RobotMoment::Blocked(2.0), "s in which somebody is close ahead"),
        row(&RobotMoment::HumanNear(3.0), "m"),
        row(&RobotMoment::HumanSays(Gesture::Wait), ""),
        row(&RobotMoment::AtEncounter("human_1".to_owned()), ""),
        row(&RobotMoment::AfterSecs(5.0), ""),
    ]
}

fn robot_deeds() -> Vec<(Value, String)> {
    let nurse = || "human_1".to_owned();
    vec![
        row(&RobotDeed::Say(Gesture::ExcuseMe), ""),
        row(&RobotDeed::HoldS(3.0), "stands so many s"),
        row(&RobotDeed::HoldUntil(RobotMoment::HumanSays(Gesture::Proceed)), "stands until then"),
        row(&RobotDeed::WaitForLeavers(true), "enters after those who leave"),
        row(&RobotDeed::Follow(nurse()), ""),
        row(&RobotDeed::Beside(nurse()), ""),
        row(&RobotDeed::Overtake(nurse()), "somebody slower"),
        row(&RobotDeed::LeadM(4.0), "leads; waits for followers farther behind, m"),
    ]
}

/// The tests of a few requests only that the words of one call for, a line each; all of them where nobody can tell.
pub(crate) fn called_for(said: &Words) -> String {
    let wanted = |test: &Test| match test.shown {
        Shown::Called(words) => said.call_for(words),
        Shown::InFull | Shown::ByName => false,
    };
    let (setup, outcome): (Vec<_>, Vec<_>) =
        predicates().into_iter().filter(wanted).partition(|test| test.role == ClauseRole::Setup);
    let told = |head: &str, tests: &[Test]| {
        let rows: String = tests.iter().map(Test::told).collect();
        if rows.is_empty() { rows } else { format!("## More tests for {head}\n{rows}") }
    };
    told("setup", &setup) + &told("outcome", &outcome)
}

/// A gesture, with what people call it where its name does not say so.
fn told_gesture(gesture: Gesture) -> String {
    if gesture == Gesture::Acknowledged { format!("{} (a wave)", gesture.name()) } else { gesture.name().to_owned() }
}

/// How the humans of a proposal go, by their relations to the robot's way: a line for each that there is.
pub(crate) fn ways_of(proposal: &Proposal) -> String {
    let there = |relation: &Relation| proposal.humans.iter().any(|human| human.relation == *relation);
    let rows = WAYS.iter().filter(|(relation, _)| there(relation));
    rows.map(|(relation, way)| format!("`{}`: {way}\n", relation.name())).collect()
}

const WAYS: [(Relation, &str); 9] = [
    (Relation::Frontal, "the robot's edges at the encounter in the other direction."),
    (
        Relation::Crossing,
        "comes to the encounter on one side of the robot's way and leaves it on the other; touching it is not enough.",
    ),
    (Relation::Behind, "the robot's nodes in the same direction, from its start or before it."),
    (Relation::Ahead, "the same direction, starting further on than the robot."),
    (Relation::Abreast, "the same nodes as the robot."),
    (Relation::Static, "one node, the encounter itself; start and goal are the same."),
    (
        Relation::Leaving,
        "starts inside the room or elevator, comes out of its door, meets the robot at a node in front of it, of whatever class, goes on.",
    ),
    (
        Relation::Aside,
        "one node off the robot's path, or on it where there is floor beside it; no encounter of their own.",
    ),
    (Relation::Staying, "one node inside the room or elevator; no encounter, or the robot's last node."),
];

/// Triggers, actions and gestures of rules, in their full form.
pub(crate) fn rule_tables() -> String {
    let all = |values: Vec<String>| values.join(", ");
    format!(
        "Triggers (`when`; all of a rule's must hold): {}\nActions (`act`): {}\nGestures: {}\n",
        all(triggers().iter().map(spelled).collect()),
        all(actions().iter().map(spelled).collect()),
        gestures()
    )
}

/// What a test means, with its values: the text of a clause for people.
pub(crate) fn test_in_words(test: &Value) -> Option<String> {
    let name = |form: &Value| match form {
        Value::Object(members) => members.keys().next().cloned(),
        Value::String(name) => Some(name.clone()),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Array(_) => None,
    };
    let wanted = name(test)?;
    let meaning = predicates().into_iter().find(|row| name(&row.form).as_ref() == Some(&wanted))?.meaning;
    let line = terse::line(test);
    let values = line.split_once(' ').map_or_else(String::new, |(_, values)| format!(" ({values})"));
    Some(format!("{meaning}{values}"))
}

/// The name of a test and of its values; in full where the values have forms of their own.
fn signature(form: &Value) -> String {
    let line = terse::line(form);
    if line.contains(" when=") {
        return line;
    }
    let part = |word: &str| match word.split_once('=') {
        Some((name, value)) if value.contains("..") => format!("{name}=1..3"),
        Some((_, "robot")) => word.to_owned(),
        Some((name, _)) => name.to_owned(),
        None => word.to_owned(),
    };
    line.split(' ').map(part).collect::<Vec<_>>().join(" ")
}

fn forms<T: Serialize>(values: &[T]) -> String {
    values.iter().map(|value| terse::line(&json!(value))).collect::<Vec<_>>().join(", ")
}

/// Codes and names of gestures.
pub(crate) fn gestures() -> String {
    Gesture::table()
}

/// The people that meet the robot more than once by the clauses of a proposal, and how often.
pub(crate) fn meetings(proposal: &Proposal) -> BTreeMap<HumanId, u32> {
    let mut found: BTreeMap<HumanId, u32> = BTreeMap::new();
    for clause in proposal.expected_events.iter().filter(|clause| clause.must) {
        if let Predicate::MeetsAgain { human, nth, .. } = clause.predicate {
            let times = found.entry(human).or_insert(nth);
            *times = nth.max(*times);
        }
    }
    found.retain(|_, times| *times > 1);
    found
}

/// What a fact says, in few words.
pub(crate) fn fact(kind: &FactKind) -> String {
    match kind {
        FactKind::Humans(count) => format!("humans {count}"),
        FactKind::Group { group, members } => {
            let members: Vec<String> = members.iter().map(ToString::to_string).collect();
            format!("group {}: {}", group.0, members.join(", "))
        }
        FactKind::Reacts { human, rule } => format!("{human}: {}", terse::rule_line(rule)),
        FactKind::Relates { human, relation } => format!("{human}: relation {}", terse::line(&json!(relation))),
        FactKind::Side { human, side } => format!("{human}: side {}", side.name()),
        FactKind::Facing { human, facing } => format!("{human}: faces {}", facing.phrase()),
        FactKind::Pace { human, mps } => format!("{human}: walks at {mps} m/s"),
        FactKind::Goal { human, name, .. } => format!("{human}: goes to {name}"),
        FactKind::MeetsTimes { human, times, place } => {
            let place = place.map_or_else(String::new, |class| format!(", at last at {}", class.name()));
            format!("{human}: meets the robot {times} times{place}")
        }
        FactKind::Before { first, then, at_door } => {
            format!("{first} before {then}{}", if *at_door { " through the door" } else { "" })
        }
        FactKind::Gestures { human, gesture } => format!("{human} says {gesture}"),
        FactKind::GesturesTo { human, gesture, to } => format!("{human} says {gesture} to {to}"),
        FactKind::Place(class) => format!("place {}", class.name()),
        FactKind::RobotTask(task) => format!("task: {task}"),
        FactKind::RobotSays(gesture) => format!("the robot says {gesture}"),
        FactKind::RobotDoes(line) => format!("the robot: {}", script_line(line)),
        FactKind::RobotStart(class) => format!("the robot starts at {}", class.name()),
        FactKind::RobotGoal(class) => format!("the robot ends at {}", class.name()),
        FactKind::RobotAt { part, name, .. } => format!("the robot's way {} {name}", part.does()),
        FactKind::Pattern(card) => format!("pattern {card}"),
        FactKind::Asked { of } => of.map_or_else(|| "asked for".to_owned(), |agent| format!("{agent}: asked for")),
    }
}

/// A line of the robot's script.
pub(crate) fn script_line(rule: &RobotRule) -> String {
    format!("{} -> {}", terse::line(&json!(rule.when)), terse::line(&json!(rule.act)))
}

/// Rows in one line, with what their names do not say.
fn listed(rows: &[(Value, String)]) -> String {
    let each = rows.iter().map(|(form, meaning)| {
        let line = terse::line(form);
        if meaning.is_empty() { line } else { format!("{line} ({meaning})") }
    });
    each.collect::<Vec<_>>().join(", ")
}

fn short(rows: &[(Value, String)]) -> String {
    rows.iter().map(|(form, meaning)| format!("{}: {meaning}\n", terse::line(form))).collect()
}

fn spelled<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

fn row<T: Serialize>(value: &T, meaning: &str) -> (Value, String) {
    (json!(value), meaning.to_owned())
}

/// A test of a clause.
struct Test {
    form: Value,
    meaning: &'static str,
    /// What authors are told besides.
    note: Option<&'static str>,
    role: ClauseRole,
    shown: Shown,
}

/// How much of a test a prompt shows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shown {
    /// Its name, its values and what it means.
    InFull,
    /// Name and values, which say all that an author needs.
    ByName,
    /// Only where a request has a word that begins with one of these.
    Called(&'static [&'static str]),
}

impl Test {
    fn by_name(self) -> Self {
        Self { shown: Shown::ByName, ..self }
    }

    fn noted(self, note: &'static str) -> Self {
        Self { note: Some(note), ..self }
    }

    fn called_by(self, words: &'static [&'static str]) -> Self {
        Self { shown: Shown::Called(words), ..self }
    }

    /// Name, values and meaning in a line.
    fn told(&self) -> String {
        let line = signature(&self.form);
        let said = line.split(' ').next().unwrap_or_default().replace('_', " ");
        // Some names say it all.
        if self.shown == Shown::ByName || self.meaning.trim_start_matches("the ").starts_with(&said) {
            line + "\n"
        } else {
            let note = self.note.map_or_else(String::new, |note| format!("; {note}"));
            format!("{line}: {}{note}\n", self.meaning)
        }
    }
}

fn setup(test: &Predicate, meaning: &'static str) -> Test {
    Test { form: json!(test), meaning, note: None, role: ClauseRole::Setup, shown: Shown::InFull }
}

fn outcome(test: &Predicate, meaning: &'static str) -> Test {
    Test { form: json!(test), meaning, note: None, role: ClauseRole::Outcome, shown: Shown::InFull }
}

/// Words of requests with rooms and elevators.
const DOOR: &[&str] = &["inside", "elevator", "lift", "room", "out", "leav", "exit", "door", "enter", "into"];
/// Words of requests with many people.
const CROWD: &[&str] = &["crowd", "many", "busy", "stream", "flow", "dense", "surround", "rush"];

fn other() -> HumanId {
    HumanId::new(2)
}

fn triggers() -> Vec<Trigger> {
    vec![
        Trigger::Always,
        Trigger::RobotVisible(5.0),
        Trigger::RobotNear(2.0),
        Trigger::RobotBlocking(1.5),
        Trigger::RobotMoving,
        Trigger::RobotStopped,
        Trigger::RobotPassed,
        Trigger::RobotSays(Gesture::Proceed),
        Trigger::HumanSays(other(), Gesture::Wait),
        Trigger::GoalReached,
        Trigger::AtEncounter,
        Trigger::AfterSecs(10.0),
    ]
}

fn actions() -> Vec<Action> {
    vec![
        Action::Navigate,
        Action::FollowRobot,
        Action::FollowHuman(other()),
        Action::RunAway,
        Action::GiveWay,
        Action::Block,
        Action::LookAtRobot,
        Action::Approach,
        Action::StandStill,
    ]
}

fn relations() -> Vec<(Value, String)> {
    vec![
        row(&Relation::Frontal, "comes towards the robot"),
        row(&Relation::Behind, "comes from behind; follows or overtakes"),
        row(&Relation::Ahead, "walks ahead of the robot"),
        row(&Relation::Crossing, "crosses the robot's way"),
        row(&Relation::Static, "stands where the robot passes; every member of a standing group"),
        row(&Relation::Leaving, "comes out of the room or elevator, may cross then"),
        row(&Relation::Staying, "stays inside it as the robot enters"),
        row(&Relation::Abreast, "walks beside the robot"),
        row(&Relation::Aside, "stands beside its way, never in it; not met"),
    ]
}

fn robot_when() -> Vec<(Value, String)> {
    vec![
        row(&RobotWhen::Start, ""),
        row(&RobotWhen::Blocked(3.0), "a human in its way so many seconds"),
        row(&RobotWhen::HumanNear(3.0), ""),
        row(&RobotWhen::HumanSays(Gesture::Wait), ""),
        row(&RobotWhen::AtEncounter(HumanId::new(1)), "where it meets this human"),
        row(&RobotWhen::AfterSecs(10.0), ""),
    ]
}

fn robot_do() -> Vec<(Value, String)> {
    vec![
        row(&RobotDo::Say(Gesture::ExcuseMe), ""),
        row(&RobotDo::Hold(3.0), "stands so many seconds"),
        row(&RobotDo::WaitForLeavers, "until all who leave are out; `when` at the door: human_near"),
        row(&RobotDo::Follow(HumanId::new(1)), ""),
        row(&RobotDo::Abreast(HumanId::new(1)), ""),
        row(&RobotDo::Overtake(HumanId::new(1)), "a slower one"),
        row(&RobotDo::Lead(4.0), "waits for followers further behind"),
    ]
}

fn predicates() -> Vec<Test> {
    let human = HumanId::new(1);
    let group = GroupId(1);
    vec![
        setup(&Predicate::Humans { count: 2 }, "so many are there all the time").by_name(),
        setup(&Predicate::Meets { human, within_m: 2.5 }, "so near at their encounter").by_name(),
        setup(&Predicate::MeetsAgain { human, nth: 2, within_m: 3.0 }, "they meet an nth time")
            .called_by(&["again", "twice", "times", "return"]),
        setup(&Predicate::HeadOn { human }, "comes straight at the robot"),
        setup(&Predicate::Crosses { human, gap_s: 3.0 }, "crosses the robot's way"),
        setup(&Predicate::Ahead { human, within_m: 4.0, for_s: 3.0 }, "is ahead of the robot").by_name(),
        setup(&Predicate::Overtakes { human }, "overtakes the robot"),
        setup(&Predicate::RobotPasses { human }, "the robot passes it"),
        setup(
            &Predicate::Follows {
                follower: AgentId::Human(human),
                leader: AgentId::Robot,
                gap_m: [0.5, 3.5],
                for_s: 5.0,
            },
            "goes behind the leader",
        )
        .by_name(),
        setup(&Predicate::Abreast { human, for_s: 5.0 }, "side by side with the robot").by_name(),
        setup(&Predicate::Parallel { human, for_s: 5.0 }, "goes the robot's way near it").called_by(&[
            "parallel",
            "alongside",
            "beside",
            "direction",
        ]),
        setup(
            &Predicate::Flow { count: 4, within_m: 4.0, angle_deg: [0.0, 30.0] },
            "so many walk by at such angles to the robot's heading (0 with it, 180 against it)",
        )
        .called_by(CROWD),
        setup(&Predicate::Density { per_m2: [0.1, 0.6], radius_m: 4.0, for_s: 3.0 }, "people per m² round the robot")
            .called_by(CROWD),
        setup(&Predicate::Surrounds { count: 3, within_m: 1.5, for_s: 3.0 }, "so many so near at once")
            .called_by(CROWD),
        setup(
            &Predicate::Converges { within_m: 2.5, within_s: 4.0 },
            "all come to the encounter within so many seconds",
        )
        .called_by(&["same", "converg", "once"]),
        setup(&Predicate::Blocks { human, for_s: 3.0 }, "is in the robot's way").by_name(),
        setup(&Predicate::Looks { human, for_s: 2.0 }, "stands and looks at it"),
        setup(&Predicate::StandsStill { human, for_s: 5.0 }, "stands still").by_name(),
        setup(&Predicate::RunsAway { human, by_m: 2.0 }, "gets away from the robot").by_name(),
        setup(&Predicate::GivesWay { human }, "leaves the robot's way free").by_name(),
        setup(
            &Predicate::Reacts { human, when: vec![Trigger::RobotNear(3.0)], act: Action::StandStill, within_s: 2.0 },
            "the action follows the triggers",
        )
        .by_name(),
        setup(&Predicate::Gestures { agent: AgentId::Human(human), gesture: Gesture::Wait }, "makes it").by_name(),
        setup(&Predicate::Leaves { human, door: String::new() }, "comes out through the door").called_by(DOOR),
        setup(&Predicate::StaysAside { human }, "stands beside the way, never in it").by_name(),
        setup(&Predicate::StaysInside { human, door: String::new() }, "stays behind the door").called_by(DOOR),
        setup(&Predicate::Enters { human, door: String::new() }, "goes in through the door").called_by(DOOR),
        setup(&Predicate::DoorOpens { door: String::new(), robot_m: [1.0, 4.0] }, "opens while the robot is so near")
            .called_by(&["open"]),
        setup(
            &Predicate::HiddenUntil { human, within_m: 4.0 },
            "no line of sight before they are so near (4 to 6), or a door opens",
        )
        .called_by(&["sudden", "surpris", "appear", "unexpect", "hid", "corner", "emerg", "blind"]),
        setup(&Predicate::Formation { group, spread_m: 1.5 }, "the group stands together").by_name(),
        setup(&Predicate::WalksTogether { group, spread_m: 3.0 }, "the group walks together").by_name(),
        setup(&Predicate::Queues { group, gap_m: [0.5, 1.5] }, "the group stands in a line")
            .called_by(&["queu", "line"]),
        setup(&Predicate::Order { first: "c2".to_owned(), then: "c3".to_owned() }, "one test before another")
            .noted("where the text says what comes first; the tests by their places in `setup` from c1, each at the time it is first seen; a reaction follows its reason without it")
            .called_by(&["first", "then", "further", "later", "next", "final", "after", "before"]),
        setup(
            &Predicate::Before { first: AgentId::Robot, then: human.into(), at_door: true },
            "is first where they meet",
        )
        .noted("crosses in front, or `at_door`: through the door")
        .called_by(&["first", "before", "after", "front", "yield", "let", "priority", "wait"]),
        setup(
            &Predicate::EncounterAt { place: PlaceClass::Intersection, nodes: vec![] },
            "the encounter is at such a place",
        )
        .by_name(),
        setup(
            &Predicate::OnTime { human, gap_s: 4.0 },
            "robot and human come to their encounter within so many seconds",
        )
        .called_by(&["sudden", "time"]),
        setup(&Predicate::Plausible, "everybody moves as people do").by_name(),
        outcome(&Predicate::RobotArrives, "the robot gets to its goal").by_name(),
        outcome(&Predicate::RobotKeeps { min_m: 0.3 }, "the robot keeps this distance"),
        outcome(&Predicate::RobotEntersLast, "the robot enters after all who leave are out").called_by(DOOR),
        outcome(&Predicate::RobotLeavesFirst, "the robot is out before others go in").called_by(DOOR),
        outcome(&Predicate::RobotJoins { group }, "the robot ends at its rim").called_by(&["join"]),
        outcome(&Predicate::RobotLeavesGroup { group }, "the robot begins at it").called_by(&["leav", "part"]),
        outcome(&Predicate::RobotObeys { gesture: Gesture::Wait, within_s: 2.0 }, "the robot stops on the gesture"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_alternative_of_the_types_has_a_row() {
        let schema = serde_json::to_value(schemars::schema_for!(socrates_model::Proposal)).unwrap();
        let text = proposal_tables() + &called_for(&Words::unknown());
        for name in ["Trigger", "Action", "Relation", "RobotWhen", "RobotDo", "Predicate"] {
            let found = crate::schema::alternatives(&schema["$defs"][name]);
            assert!(!found.is_empty(), "{name}");
            // A proposal names kinds of places, so authors are not told of the predicates that name a node; nor of those that
            // are written for them from the facts of the reading.
            let untold = [
                "reaches",
                "starts_at",
                "on_side",
                "faces",
                "robot_way",
                "robot_step",
                "walks",
                "gets_to",
                "step",
                "gestures_to",
                "turns_back",
                "goes_to",
                "changes_pace",
                "stopped_for",
                "did",
                "done",
                "look_at",
                "turn_back",
                "go_to",
                "change_pace",
                "make_room",
                "makes_room",
                "approach_to",
                "hold_until",
            ];
            for alternative in found.into_iter().filter(|name| !untold.contains(&name.as_str())) {
                let starts = ["\n", " "].iter().any(|start| {
                    [" ", ":", ","].iter().any(|end| text.contains(&format!("{start}{alternative}{end}")))
                        || text.contains(&format!("{start}{alternative}\n"))
                });
                let found = starts;
                assert!(found, "{name} `{alternative}` is not in the tables");
            }
        }
    }

    #[test]
    fn every_word_of_a_scenario_has_a_row() {
        let tables = scenario_tables();
        let (_, definitions) = crate::scenario::schema();
        for name in ["Relation", "Deed", "When", "Gesture", "RobotMoment"] {
            let words = crate::schema::alternatives(&definitions[name]);
            assert!(words.len() > 3, "{name}: {words:?}");
            for word in words {
                let there = [format!("\"{word}\""), format!("\n{word}:"), format!("{word},"), format!("{word} (")];
                assert!(there.iter().any(|form| tables.contains(form)) || tables.contains(&word), "{name} `{word}`");
            }
        }
        for key in RobotDeed::KEYS {
            assert!(tables.contains(&format!("{{\"{key}\":")), "{key}");
        }
    }

    #[test]
    fn every_test_of_the_table_is_read_back_as_it_was_meant() {
        for Test { form, .. } in predicates() {
            let mut proposal = json!({"expected_events": [{"test": terse::line(&form)}]});
            terse::expand(&mut proposal, "");
            let read: Predicate = serde_json::from_value(proposal["expected_events"][0]["predicate"].clone()).unwrap();
            let meant: Predicate = serde_json::from_value(form).unwrap();
            assert_eq!(read, meant);
        }
    }
}
