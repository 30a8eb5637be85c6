//! What is taken away from each clause, and what has no meaning for it and why: a row per predicate.

use socrates_model::Predicate;
use socrates_model::proposal::WayPart;
use socrates_model::rule::RobotDo;

use super::{Edit, Entry, Row, Whose};

use Edit::{
    AfterRobot, AheadInstead, AlreadyDone, Aside, AtTheSameTime, Backwards, BesideInstead, DoorAtEnd, DoorAtStart,
    DoorShut, FarAway, Gone, GoneHalfway, HalfPace, IntoRobot, Later, LogAlone, LogStands, LogWalks, OnRobotsWay,
    OutOfTime, SeenAhead, SetsOffSooner, SignLater, SignSooner, SkipsAhead, Sooner, StandsFromEvidence,
    StandsFromStart, StandsSooner, StandsThere, Swapped, SwappedMidway, SwappedPair, TowardsInstead, TurnedAbout,
    TurnedAway, WalksOff, WalksToRobot,
};
use Entry::{AsFirst, Exempt, Spoil};
use Whose::{Everybody, LastMember, Leavers, Members, Person, Robot};

const NAMES_NOBODY: Entry = Exempt("it names nobody: anybody who does it counts");
const ROBOT_ALONE: Entry = Exempt("the robot is the only one whom it judges");
const EITHER_WAY: Entry = Exempt(
    "a way reflected in the robot's keeps its distance from it, and one walked backwards leads through the same place",
);
const STANDING: Entry = Exempt("to stand is the thing itself");
const ALL_THE_TIME: Entry = Exempt("it lasts for the whole run: later or sooner it is the same");
const NO_ACT: Entry = Exempt("it tells where people are, and needs no act of a tree");

const PERSON_ABSENT: Entry = Spoil(&[(Person, Gone), (Person, FarAway)]);
const PERSON_STANDS: Entry = Spoil(&[(Person, StandsFromStart)]);
const PERSON_STOPS: Entry = Spoil(&[(Person, StandsFromStart), (Person, StandsFromEvidence), (Person, StandsThere)]);
const PERSON_BACKWARDS: Entry = Spoil(&[(Person, Backwards)]);
const PERSON_TOO_LATE: Entry = Spoil(&[(Person, OutOfTime)]);
const PERSON_OFF_TIME: Entry = Spoil(&[(Person, Later), (Person, Sooner)]);
const PERSON_SWAPPED: Entry = Spoil(&[(Person, Swapped)]);
const PERSON_LOG_STANDS: Entry = Spoil(&[(Person, LogStands)]);
const PERSON_LOG_WALKS: Entry = Spoil(&[(Person, LogWalks)]);
const ALL_ABSENT: Entry = Spoil(&[(Everybody, Gone), (Everybody, FarAway)]);
const ALL_STAND: Entry = Spoil(&[(Everybody, StandsFromStart)]);
const ALL_TOO_LATE: Entry = Spoil(&[(Everybody, OutOfTime)]);
const ALL_LOG_STANDS: Entry = Spoil(&[(Everybody, LogStands)]);
const MEMBER_ABSENT: Entry = Spoil(&[(LastMember, Gone), (LastMember, FarAway)]);
const MEMBER_SWAPPED: Entry = Spoil(&[(LastMember, Swapped)]);
const LEAVERS_STAND: Entry = Spoil(&[(Robot, StandsFromStart), (Leavers, StandsFromStart)]);
const LEAVERS_ABSENT: Entry = Spoil(&[(Leavers, Gone), (Leavers, FarAway)]);
const LEAVERS_TOO_LATE: Entry = Spoil(&[(Robot, OutOfTime), (Leavers, OutOfTime)]);
const ROBOT_ABSENT: Entry = Spoil(&[(Robot, Gone), (Robot, FarAway)]);
const ROBOT_STANDS: Entry = Spoil(&[(Robot, StandsFromStart)]);
const ROBOT_TOO_LATE: Entry = Spoil(&[(Robot, OutOfTime)]);
const ROBOT_LOG_STANDS: Entry = Spoil(&[(Robot, LogStands)]);

/// A row of entries: frozen, absent, mirrored, delayed, exchanged, without effect.
macro_rules! rows {
    ($($row:ident $name:literal $frozen:expr, $absent:expr, $mirrored:expr, $delayed:expr, $exchanged:expr, $idle:expr;)*) => {
        $(const $row: Row = Row { name: $name, entries: [$frozen, $absent, $mirrored, $delayed, $exchanged, $idle] };)*
        /// Every row, in the order of the model.
        pub const ROWS: &[Row] = &[$($row),*];
    };
}

rows! {
    HUMANS "humans" Exempt("a person who stands is there as well"),
        Spoil(&[(Person, Gone), (Person, GoneHalfway)]),
        Exempt("somebody who walks backwards is there as well"),
        Exempt("somebody who sets off later is there all the same"), NAMES_NOBODY, NO_ACT;
    MEETS "meets" PERSON_STANDS, PERSON_ABSENT, EITHER_WAY, Spoil(&[(Person, AfterRobot)]), PERSON_SWAPPED, PERSON_LOG_STANDS;
    MEETS_AGAIN "meets_again" PERSON_STANDS, PERSON_ABSENT, EITHER_WAY, Spoil(&[(Person, AfterRobot)]), PERSON_SWAPPED,
        PERSON_LOG_STANDS;
    HEAD_ON "head_on" PERSON_STOPS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    CROSSES "crosses" Spoil(&[(Person, StandsFromStart), (Person, StandsThere)]), PERSON_ABSENT,
        Exempt("a way that crosses another crosses it as well when it is reflected or walked backwards"),
        PERSON_OFF_TIME, PERSON_SWAPPED, PERSON_LOG_STANDS;
    ON_SIDE "on_side" PERSON_STANDS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    FACES "faces" STANDING, PERSON_ABSENT, Spoil(&[(Person, TurnedAbout)]), ALL_THE_TIME, PERSON_SWAPPED, NO_ACT;
    AHEAD "ahead" PERSON_STOPS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    OVERTAKES "overtakes" PERSON_STOPS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    ROBOT_PASSES "robot_passes" Spoil(&[(Robot, StandsFromStart), (Robot, StandsFromEvidence)]), PERSON_ABSENT,
        Exempt("somebody is passed on either side, and whichever way they walk"),
        ROBOT_TOO_LATE, PERSON_SWAPPED, ROBOT_LOG_STANDS;
    FOLLOWS "follows" PERSON_STOPS, PERSON_ABSENT, Spoil(&[(Person, AheadInstead), (Person, BesideInstead)]),
        PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    ABREAST "abreast" PERSON_STOPS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    PARALLEL "parallel" PERSON_STOPS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    FLOW "flow" ALL_STAND, ALL_ABSENT, Exempt("of two opposite streams each is the other one walked backwards"), ALL_TOO_LATE, NAMES_NOBODY, ALL_LOG_STANDS;
    DENSITY "density" ALL_STAND, ALL_ABSENT, Exempt("as many people are as dense whichever way they walk"), ALL_TOO_LATE,
        NAMES_NOBODY, ALL_LOG_STANDS;
    SURROUNDS "surrounds" ALL_STAND, ALL_ABSENT, Exempt("people round the robot may face and walk either way"), ALL_TOO_LATE,
        NAMES_NOBODY, ALL_LOG_STANDS;
    CONVERGES "converges" PERSON_STANDS, PERSON_ABSENT,
        Exempt("people come together as well when each comes from where they would have gone"),
        Spoil(&[(Person, Later)]), NAMES_NOBODY, PERSON_LOG_STANDS;
    BLOCKS "blocks" PERSON_STANDS, PERSON_ABSENT, Spoil(&[(Person, Aside)]), PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_WALKS;
    LOOKS "looks" PERSON_STANDS, PERSON_ABSENT, Spoil(&[(Person, TurnedAway)]), PERSON_TOO_LATE, PERSON_SWAPPED,
        Spoil(&[(Person, LogWalks), (Person, LogStands)]);
    STANDS_STILL "stands_still" PERSON_STANDS, PERSON_ABSENT, Exempt("to stand has no direction"), PERSON_TOO_LATE,
        PERSON_SWAPPED, PERSON_LOG_WALKS;
    RUNS_AWAY "runs_away" PERSON_STOPS, PERSON_ABSENT, Spoil(&[(Person, TowardsInstead)]), PERSON_TOO_LATE, PERSON_SWAPPED,
        Spoil(&[(Person, LogStands), (Person, LogWalks)]);
    GIVES_WAY "gives_way" PERSON_STOPS, PERSON_ABSENT, Exempt("aside to the other side leaves the line as free"),
        PERSON_TOO_LATE, PERSON_SWAPPED, Spoil(&[(Person, LogStands), (Person, LogWalks)]);
    STAYS_ASIDE "stays_aside" STANDING, PERSON_ABSENT, Spoil(&[(Person, OnRobotsWay)]), ALL_THE_TIME, PERSON_SWAPPED,
        Spoil(&[(Person, WalksToRobot)]);
    MAKES_ROOM "makes_room" ALL_STAND, PERSON_ABSENT, Exempt("aside to the other side leaves the line as free"), ALL_TOO_LATE,
        PERSON_SWAPPED, ALL_LOG_STANDS;
    REACTS "reacts" PERSON_STANDS, PERSON_ABSENT, Spoil(&[(Person, TurnedAway), (Person, TowardsInstead)]), PERSON_TOO_LATE,
        PERSON_SWAPPED, Spoil(&[(Person, LogStands), (Person, LogWalks)]);
    STEP "step" Exempt("many steps are done standing"), PERSON_ABSENT, Exempt("a step may go either way"), PERSON_TOO_LATE,
        PERSON_SWAPPED, Exempt("the motion of a step is asked for by the clause of its act");
    GESTURES_TO "gestures_to" PERSON_STANDS, PERSON_ABSENT, Spoil(&[(Person, TurnedAbout)]), PERSON_TOO_LATE, PERSON_SWAPPED,
        Exempt("a sign that only the log tells of is refused by `gestures`");
    TURNS_BACK "turns_back" PERSON_STANDS, PERSON_ABSENT, Exempt("a way there and back is the same walked backwards"),
        PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    COMES_BACK "comes_back" PERSON_STANDS, PERSON_ABSENT, Exempt("a way there and back is the same walked backwards"),
        PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    GOES_TO "goes_to" PERSON_STANDS, PERSON_ABSENT, EITHER_WAY, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    CHANGES_PACE "changes_pace" PERSON_STANDS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    WALKS "walks" PERSON_STANDS, PERSON_ABSENT, Exempt("a pace is the same whichever way somebody walks"),
        Spoil(&[(Person, OutOfTime), (Person, HalfPace)]), PERSON_SWAPPED, PERSON_LOG_STANDS;
    GETS_TO "gets_to" PERSON_STANDS, PERSON_ABSENT, PERSON_BACKWARDS, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    ROBOT_WAY "robot_way" ROBOT_STANDS, Spoil(&[(Robot, FarAway)]), EITHER_WAY, ROBOT_TOO_LATE, ROBOT_ALONE, ROBOT_LOG_STANDS;
    ROBOT_STARTS "robot_starts" Exempt("a robot that stands at its start starts there"), Spoil(&[(Robot, FarAway)]),
        Spoil(&[(Robot, Backwards)]), Exempt("it starts there whenever it sets off"), ROBOT_ALONE, NO_ACT;
    ROBOT_AVOIDS "robot_avoids" Exempt("a robot that stands enters nothing"), Exempt("a robot that is far away enters nothing"), EITHER_WAY,
        Exempt("it tells what the robot does at no time"), ROBOT_ALONE, Exempt("it tells what the robot does not do");
    ROBOT_SAYS "robot_step_says" ROBOT_STANDS, ROBOT_ABSENT, Exempt("a sign is the same to either side"),
        Spoil(&[(Robot, OutOfTime), (Robot, SignSooner), (Robot, SignLater)]), ROBOT_ALONE, Spoil(&[(Robot, LogAlone)]);
    ROBOT_WAITS "robot_step_waits" Spoil(&[(Robot, StandsFromStart), (Robot, StandsFromEvidence)]), ROBOT_ABSENT,
        Exempt("to stand has no direction"), Spoil(&[(Robot, OutOfTime), (Robot, StandsSooner)]), ROBOT_ALONE,
        Spoil(&[(Robot, LogWalks), (Robot, SetsOffSooner)]);
    ROBOT_LETS_OUT "robot_step_lets_out" LEAVERS_STAND, LEAVERS_ABSENT, Spoil(&[(Robot, Backwards)]), LEAVERS_TOO_LATE,
        NAMES_NOBODY, Spoil(&[(Robot, LogStands), (Leavers, LogStands)]);
    ROBOT_GOES_WITH "robot_step_goes_with" ROBOT_STANDS, ROBOT_ABSENT,
        Exempt("somebody is followed, led and passed whichever way the two go"), ROBOT_TOO_LATE, PERSON_SWAPPED,
        ROBOT_LOG_STANDS;
    GESTURES "gestures" PERSON_STANDS, PERSON_ABSENT, Exempt("a sign is the same to either side"), PERSON_TOO_LATE,
        PERSON_SWAPPED, Spoil(&[(Person, LogAlone)]);
    LEAVES "leaves" PERSON_STANDS, PERSON_ABSENT, PERSON_BACKWARDS, Spoil(&[(Person, OutOfTime), (Person, AlreadyDone)]),
        PERSON_SWAPPED, PERSON_LOG_STANDS;
    STAYS_INSIDE "stays_inside" STANDING, PERSON_ABSENT, Exempt("inside is inside whichever way somebody faces"), ALL_THE_TIME, PERSON_SWAPPED,
        Spoil(&[(Person, WalksToRobot)]);
    ENTERS "enters" PERSON_STANDS, PERSON_ABSENT, PERSON_BACKWARDS, Spoil(&[(Person, OutOfTime), (Person, AlreadyDone)]),
        PERSON_SWAPPED, PERSON_LOG_STANDS;
    DOOR_OPENS "door_opens" ROBOT_STANDS, Spoil(&[(Robot, DoorShut)]), Exempt("a distance is the same to either side"),
        Spoil(&[(Robot, DoorAtStart), (Robot, DoorAtEnd)]), NAMES_NOBODY, Exempt("a door has no tree");
    HIDDEN_UNTIL "hidden_until" PERSON_STANDS, PERSON_ABSENT, Exempt("a line of sight has no direction"),
        Spoil(&[(Person, SeenAhead)]), PERSON_SWAPPED, PERSON_LOG_STANDS;
    FORMATION "formation" STANDING, MEMBER_ABSENT, Spoil(&[(Members, TurnedAbout)]), ALL_THE_TIME, MEMBER_SWAPPED,
        Spoil(&[(Members, WalksOff)]);
    WALKS_TOGETHER "walks_together" Spoil(&[(Members, StandsFromStart), (LastMember, StandsFromStart)]), MEMBER_ABSENT,
        Spoil(&[(LastMember, Backwards)]), Spoil(&[(LastMember, OutOfTime)]), MEMBER_SWAPPED, Spoil(&[(Members, LogStands)]);
    QUEUES "queues" STANDING, MEMBER_ABSENT, Exempt("a line reflected is a line"), ALL_THE_TIME, MEMBER_SWAPPED,
        Spoil(&[(Members, WalksOff)]);
    ORDER "order" AsFirst, AsFirst, Exempt("an order of times has no direction"),
        Spoil(&[(Person, Later), (Person, AtTheSameTime)]), AsFirst, AsFirst;
    BEFORE "before" PERSON_STANDS, PERSON_ABSENT, EITHER_WAY, Spoil(&[(Person, Later), (Person, AtTheSameTime)]),
        Spoil(&[(Person, SwappedPair)]), PERSON_LOG_STANDS;
    BEFORE_AT_DOOR "before_at_door" PERSON_STANDS, PERSON_ABSENT, PERSON_BACKWARDS,
        Spoil(&[(Person, Later), (Person, AtTheSameTime)]), Spoil(&[(Person, SwappedPair)]), PERSON_LOG_STANDS;
    ENCOUNTER_AT "encounter_at" ALL_STAND, ALL_ABSENT, EITHER_WAY, ALL_TOO_LATE, NAMES_NOBODY, ALL_LOG_STANDS;
    REACHES "reaches" PERSON_STANDS, PERSON_ABSENT, EITHER_WAY, PERSON_TOO_LATE, PERSON_SWAPPED, PERSON_LOG_STANDS;
    STARTS_AT "starts_at" Exempt("somebody who stands at the start starts there"), PERSON_ABSENT, PERSON_BACKWARDS,
        Spoil(&[(Person, AlreadyDone)]), PERSON_SWAPPED, NO_ACT;
    ON_TIME "on_time" PERSON_STANDS, PERSON_ABSENT, EITHER_WAY, PERSON_OFF_TIME, PERSON_SWAPPED, PERSON_LOG_STANDS;
    PLAUSIBLE "plausible" Spoil(&[(Person, OnRobotsWay)]), Exempt("nobody touches those who are not there"),
        Spoil(&[(Person, IntoRobot)]), Spoil(&[(Person, SkipsAhead)]), Spoil(&[(Person, SwappedMidway)]), NO_ACT;
    ROBOT_ARRIVES "robot_arrives" ROBOT_STANDS, Spoil(&[(Robot, FarAway)]), Spoil(&[(Robot, Backwards)]), ROBOT_TOO_LATE,
        ROBOT_ALONE, ROBOT_LOG_STANDS;
    ROBOT_KEEPS "robot_keeps" Spoil(&[(Person, OnRobotsWay)]), Exempt("a distance is kept from those who are far away"),
        Spoil(&[(Person, IntoRobot)]), Exempt("a meeting that is missed keeps its distance"), NAMES_NOBODY,
        Exempt("it tells what the robot does not do");
    ROBOT_ENTERS_LAST "robot_enters_last" LEAVERS_STAND, LEAVERS_ABSENT, Spoil(&[(Robot, Backwards)]), LEAVERS_TOO_LATE,
        NAMES_NOBODY, Spoil(&[(Robot, LogStands), (Leavers, LogStands)]);
    ROBOT_LEAVES_FIRST "robot_leaves_first" ROBOT_STANDS, Spoil(&[(Everybody, Gone), (Everybody, FarAway)]),
        Spoil(&[(Robot, Backwards)]), ROBOT_TOO_LATE, NAMES_NOBODY, ROBOT_LOG_STANDS;
    ROBOT_JOINS "robot_joins" ROBOT_STANDS, Spoil(&[(Members, Gone), (Members, FarAway)]), Spoil(&[(Robot, Backwards)]),
        ROBOT_TOO_LATE, MEMBER_SWAPPED, Spoil(&[(Members, WalksOff)]);
    ROBOT_LEAVES_GROUP "robot_leaves_group" ROBOT_STANDS, Spoil(&[(Members, Gone), (Members, FarAway)]),
        Spoil(&[(Robot, Backwards)]), ROBOT_TOO_LATE, MEMBER_SWAPPED, ROBOT_LOG_STANDS;
    ROBOT_OBEYS "robot_obeys" ROBOT_STANDS, Spoil(&[(Everybody, Gone)]), Exempt("to go and to stand have no side"),
        ROBOT_TOO_LATE, NAMES_NOBODY, Spoil(&[(Robot, LogWalks), (Everybody, LogAlone)]);
}

/// The row of a predicate. A predicate without a row does not compile.
#[must_use]
pub const fn row(predicate: &Predicate) -> &'static Row {
    match predicate {
        Predicate::Humans { .. } => &HUMANS,
        Predicate::Meets { .. } => &MEETS,
        Predicate::MeetsAgain { .. } => &MEETS_AGAIN,
        Predicate::HeadOn { .. } => &HEAD_ON,
        Predicate::Crosses { .. } => &CROSSES,
        Predicate::OnSide { .. } => &ON_SIDE,
        Predicate::Faces { .. } => &FACES,
        Predicate::Step { .. } => &STEP,
        Predicate::GesturesTo { .. } => &GESTURES_TO,
        Predicate::TurnsBack { .. } => &TURNS_BACK,
        Predicate::ComesBack { .. } => &COMES_BACK,
        Predicate::GoesTo { .. } => &GOES_TO,
        Predicate::ChangesPace { .. } => &CHANGES_PACE,
        Predicate::Walks { .. } => &WALKS,
        Predicate::GetsTo { .. } => &GETS_TO,
        Predicate::RobotWay { part: WayPart::Start, .. } => &ROBOT_STARTS,
        Predicate::RobotWay { part: WayPart::Avoid, .. } => &ROBOT_AVOIDS,
        Predicate::RobotWay { .. } => &ROBOT_WAY,
        Predicate::RobotStep { rule, .. } => of_robot(&rule.act),
        Predicate::Ahead { .. } => &AHEAD,
        Predicate::Overtakes { .. } => &OVERTAKES,
        Predicate::RobotPasses { .. } => &ROBOT_PASSES,
        Predicate::Follows { .. } => &FOLLOWS,
        Predicate::Abreast { .. } => &ABREAST,
        Predicate::Parallel { .. } => &PARALLEL,
        Predicate::Flow { .. } => &FLOW,
        Predicate::Density { .. } => &DENSITY,
        Predicate::Surrounds { .. } => &SURROUNDS,
        Predicate::Converges { .. } => &CONVERGES,
        Predicate::Blocks { .. } => &BLOCKS,
        Predicate::Looks { .. } => &LOOKS,
        Predicate::StandsStill { .. } => &STANDS_STILL,
        Predicate::RunsAway { .. } => &RUNS_AWAY,
        Predicate::GivesWay { .. } => &GIVES_WAY,
        Predicate::StaysAside { .. } => &STAYS_ASIDE,
        Predicate::MakesRoom { .. } => &MAKES_ROOM,
        Predicate::Reacts { .. } => &REACTS,
        Predicate::Gestures { .. } => &GESTURES,
        Predicate::Leaves { .. } => &LEAVES,
        Predicate::StaysInside { .. } => &STAYS_INSIDE,
        Predicate::Enters { .. } => &ENTERS,
        Predicate::DoorOpens { .. } => &DOOR_OPENS,
        Predicate::HiddenUntil { .. } => &HIDDEN_UNTIL,
        Predicate::Formation { .. } => &FORMATION,
        Predicate::WalksTogether { .. } => &WALKS_TOGETHER,
        Predicate::Queues { .. } => &QUEUES,
        Predicate::Order { .. } => &ORDER,
        Predicate::Before { at_door: false, .. } => &BEFORE,
        Predicate::Before { at_door: true, .. } => &BEFORE_AT_DOOR,
        Predicate::EncounterAt { .. } => &ENCOUNTER_AT,
        Predicate::Reaches { .. } => &REACHES,
        Predicate::StartsAt { .. } => &STARTS_AT,
        Predicate::OnTime { .. } => &ON_TIME,
        Predicate::Plausible => &PLAUSIBLE,
        Predicate::RobotArrives => &ROBOT_ARRIVES,
        Predicate::RobotKeeps { .. } => &ROBOT_KEEPS,
        Predicate::RobotEntersLast => &ROBOT_ENTERS_LAST,
        Predicate::RobotLeavesFirst => &ROBOT_LEAVES_FIRST,
        Predicate::RobotJoins { .. } => &ROBOT_JOINS,
        Predicate::RobotLeavesGroup { .. } => &ROBOT_LEAVES_GROUP,
        Predicate::RobotObeys { .. } => &ROBOT_OBEYS,
    }
}

/// The row of a line of the robot's script.
const fn of_robot(act: &RobotDo) -> &'static Row {
    match act {
        RobotDo::Say(_) => &ROBOT_SAYS,
        RobotDo::Hold(_) | RobotDo::HoldUntil(_) => &ROBOT_WAITS,
        RobotDo::WaitForLeavers => &ROBOT_LETS_OUT,
        RobotDo::Follow(_) | RobotDo::Abreast(_) | RobotDo::Overtake(_) | RobotDo::Lead(_) => &ROBOT_GOES_WITH,
    }
}
