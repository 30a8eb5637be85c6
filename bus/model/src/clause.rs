//! Clauses: what must be seen in a recording. A closed vocabulary.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::act::Action;
use crate::gesture::Gesture;
use crate::ids::{AgentId, GroupId, HumanId, NodeId};
use crate::place::PlaceClass;
use crate::proposal::{Facing, Side, WayPart};
use crate::rule::{RobotRule, Rule, Trigger};

mod about;

use about::OfWhom;

/// What a clause judges: the setup, or the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClauseRole {
    /// People, places and timings as proposed, and the robot got its chance: decides the verdict.
    Setup,
    /// What the robot then did: the test result, never the verdict.
    Outcome,
}

/// One thing that must be seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clause {
    /// Unique in the proposal: `c1`, `c2`, …
    pub id: String,
    /// In words, for people.
    pub text: String,
    /// Setup or outcome.
    pub role: ClauseRole,
    /// Whether the verdict needs it (setup) or a good robot needs it (outcome).
    pub must: bool,
    /// Id of the fact of the reading it comes from; empty for a clause of the pattern itself.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
    /// What is tested.
    pub predicate: Predicate,
}

/// What is missing where a predicate does not hold, and so which part of a scenario has to change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shows {
    /// A person and the robot come together.
    Meeting,
    /// A person does one thing, near the robot.
    Deed,
    /// A person acts by a rule or a step.
    Act,
    /// A gesture is made.
    Sign,
    /// A group, or a person beside the way, is where it should be.
    Company,
    /// Bodies keep out of each other and of walls.
    Bodies,
    /// Places, ways and times are as proposed.
    Course,
    /// The robot's result, which is an outcome and never part of the setup.
    Result,
}

/// One row for each predicate: its name, the fields that name its subject, what it shows, its parameters.
macro_rules! predicates {
    ($(
        $(#[$meta:meta])* $name:ident [$($subject:ident),*] $shows:ident $({ $($(#[$key_meta:meta])* $key:ident: $type:ty,)* })?,
    )*) => {
        /// What a clause tests. Distances are center to center in m, times in s.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case", deny_unknown_fields)]
        pub enum Predicate {
            $($(#[$meta])* $name $({ $($(#[$key_meta])* $key: $type,)* })?,)*
        }

        impl Predicate {
            /// What is missing where it does not hold.
            #[must_use]
            pub const fn shows(&self) -> Shows {
                match self {
                    $(Self::$name { .. } => Shows::$shows,)*
                }
            }

            /// Its subjects, in the order of its parameters; none where it tells of the scene or of the robot alone.
            fn subjects(&self) -> Vec<OfWhom> {
                match self {
                    $(Self::$name { $($subject,)* .. } => vec![$(OfWhom::from($subject.clone())),*],)*
                }
            }
        }
    };
}

predicates! {
    /// Exactly so many humans are there from the first to the last tick.
    Humans [] Course {
        /// How many.
        count: u32,
    },
    /// The human and the robot come within `within_m` of each other near its encounter node
    /// (both within 3 m of it), or anywhere where it has none; of several encounters, the first.
    Meets [human] Meeting {
        /// The human.
        human: HumanId,
        /// Largest distance between the two.
        within_m: f64,
    },
    /// The human and the robot meet for the `nth` time: they come within `within_m` of each other near the human's nth
    /// encounter node (both within 3 m of it), after the robot has left the encounter before behind.
    MeetsAgain [human] Meeting {
        /// The human.
        human: HumanId,
        /// Which of its encounters, from 2.
        nth: u32,
        /// Largest distance between the two.
        within_m: f64,
    },
    /// The human moves against the robot's heading, or on its intended way (1.2 m to either side) against that, as they come nearer from
    /// 10 m on: at 135° to 180°, at 0.2 m/s and more, ahead of the robot and closing, for 0.5 s. Somebody who stands as the robot comes is not head on.
    HeadOn [human] Course {
        /// The human.
        human: HumanId,
    },
    /// The human's way crosses the robot's at 45–135° where the paths meet (ways within 1 m of each other, both within 3 m of the
    /// encounter node), both there within `gap_s`. Somebody who stands there has no way that crosses.
    Crosses [human] Course {
        /// The human.
        human: HumanId,
        /// Largest difference of arrival times.
        gap_s: f64,
    },
    /// The human is on this side of the robot's way as it drives, which depends on how they stand to it. Crossing and leaving: they
    /// walk up to its way from there, 0.8 m or more beside it at last; leaving, they start there too. Static: they are 0.3 m or
    /// more beside it as the robot is nearest, within 3.5 m. Frontal, behind, ahead and abreast: they walk, and are 0.2 m or more
    /// beside it for 80 % of the time that both are level within 4 m; ahead, and where they never are, for 80 % of 1 s or more
    /// within 6 m.
    OnSide [human] Course {
        /// The human.
        human: HumanId,
        /// Which side.
        side: Side,
    },
    /// The human stands and faces so, within 45° (60° of straight away from the robot), for 80 % of the time that the robot comes
    /// from 6 m to 3 m in view, and before they react; where that is not seen, from 3 m to 1 m. 0.3 s at least.
    Faces [human] Course {
        /// The human.
        human: HumanId,
        /// Where.
        facing: Facing,
    },
    /// The human walks ahead of the robot on its way (1.2 m to either side), within `within_m` and away from it at 0.1 m/s and
    /// more, for `for_s` without a break. Somebody who stands, or comes towards it, does not.
    Ahead [human] Course {
        /// The human.
        human: HumanId,
        /// Largest distance.
        within_m: f64,
        /// For how long.
        for_s: f64,
    },
    /// The human overtakes the robot: first 0.5 m behind, then 0.5 m ahead, walking the same way (within 45°, at 0.2 m/s and
    /// more), within 3 m.
    Overtakes [human] Course {
        /// The human.
        human: HumanId,
    },
    /// The robot passes the human: first 0.5 m ahead of it, then 0.5 m behind, within 3 m.
    RobotPasses [human] Course {
        /// The human.
        human: HumanId,
    },
    /// The follower goes behind the leader, within 1.2 m of its trail, gap within `gap_m`, for `for_s` in one stretch in which the
    /// two go together: 0.5 m and 0.1 m/s at least, the follower at a third of the leader's pace. To stand behind a leader who
    /// drives off is not to follow.
    Follows [follower, leader] Deed {
        /// The follower.
        follower: AgentId,
        /// The leader.
        leader: AgentId,
        /// Smallest and largest gap along the way, m.
        gap_m: [f64; 2],
        /// For how long.
        for_s: f64,
    },
    /// The two go side by side (±45° of abreast, courses within 90°), 0.5 to 2 m apart, for `for_s` in which they go together: 0.5 m
    /// and 0.1 m/s at least, the human at a third of the robot's pace.
    Abreast [human] Act {
        /// The human.
        human: HumanId,
        /// For how long.
        for_s: f64,
    },
    /// The two go the same way (headings within 30°), within 4 m of each other, for `for_s` without a break: the human at 0.2 m/s,
    /// the robot at 0.1 m/s and more.
    Parallel [human] Course {
        /// The human.
        human: HumanId,
        /// For how long.
        for_s: f64,
    },
    /// At least so many different humans walk near the robot (at 0.2 m/s and more, for 0.5 s) with the angle between their course
    /// and its heading in a band.
    Flow [] Course {
        /// How many at least.
        count: u32,
        /// Largest distance at which one counts, m.
        within_m: f64,
        /// Smallest and largest angle between course and heading, 0 (same way) to 180 (oncoming).
        angle_deg: [f64; 2],
    },
    /// A density of people is in the disc about the robot, for `for_s` without a break.
    Density [] Course {
        /// Smallest and largest density, people per m².
        per_m2: [f64; 2],
        /// Radius of the disc, m.
        radius_m: f64,
        /// For how long.
        for_s: f64,
    },
    /// At least so many humans are within a distance of the robot at one time, for `for_s` without a break.
    Surrounds [] Course {
        /// How many at least.
        count: u32,
        /// Largest distance.
        within_m: f64,
        /// For how long.
        for_s: f64,
    },
    /// All humans of the proposal come from outside to within a distance of their encounter node, at about the same time.
    Converges [] Course {
        /// Radius about the node.
        within_m: f64,
        /// Largest difference between the first and the last arrival.
        within_s: f64,
    },
    /// The human is in the robot's way: within 2.5 m, less than 0.6 m from its line and 1.2 m from its intended way, for `for_s`,
    /// and comes towards it at 0.7 m/s at most. Somebody who walks up to the robot and past it does not block it.
    Blocks [human] Deed {
        /// The human.
        human: HumanId,
        /// For how long.
        for_s: f64,
    },
    /// The human looks at the robot (heading within 20°) while stopped, for `for_s`; it has seen it then. It has walked (0.2 m/s) or
    /// turned by 15° in the 2 s before or meanwhile, by 2° where its tree says that it looks: whoever stands there facing that way
    /// by chance does not look.
    Looks [human] Deed {
        /// The human.
        human: HumanId,
        /// For how long.
        for_s: f64,
    },
    /// The human stands still (below 0.1 m/s) for `for_s`, with the robot within 15 m at some time of it. Where that is done for a
    /// reason: after it, and not by standing there before it without any act.
    StandsStill [human] Act {
        /// The human.
        human: HumanId,
        /// For how long.
        for_s: f64,
    },
    /// The human gets away from the robot: distance grows by `by_m` within 6 s of the trigger, half of it by the human's own way.
    RunsAway [human] Deed {
        /// The human.
        human: HumanId,
        /// By how much.
        by_m: f64,
    },
    /// The human leaves the robot's line free: at least 0.6 m beside it as the robot passes (within 3 m), having gone 0.2 m by
    /// themselves since the reason and come 0.15 m farther from the line. Somebody who stands beside it all the time gives no way.
    GivesWay [human] Deed {
        /// The human.
        human: HumanId,
    },
    /// After the trigger first holds, the action is seen within `within_s`; and not before it. Seen is the motion, and where the
    /// recording tells leaves the leaf too. A motion is the human's own: 0.5 m for who follows, 0.3 m for who comes up to the
    /// robot or gets away from it, 0.2 m for a step to the side of its line.
    Reacts [human] Act {
        /// The human.
        human: HumanId,
        /// All of these must hold.
        when: Vec<Trigger>,
        /// What is done.
        act: Action,
        /// Largest delay.
        within_s: f64,
    },
    /// A step of the human's sequence is done as its rule says: it begins within `within_s` of the time at which all its triggers
    /// first hold, and not before; it is done for at least 60 % of its time; and it is over within 2 s of what ends it.
    Step [human] Act {
        /// The human.
        human: HumanId,
        /// What the step says.
        rule: Rule,
        /// Largest delay.
        within_s: f64,
    },
    /// The robot does a line of its script, for its reason and not before it. What it says is shown, from within `within_s` of the reason. Where
    /// it waits, it comes to a stand within `within_s`, having moved in the 5 s before, stands for 60 % of the time or, on at most
    /// 0.5 m, until the moment comes and goes within 3 s of it, and goes on. Where it waits for those who leave, it enters after
    /// them. It follows, or goes beside somebody, for 3 s, or passes them. Where it leads, somebody follows it for 3 s, and while it moves no
    /// follower is 1.5 m farther behind than it allows for more than 3 s.
    RobotStep [] Course {
        /// The line.
        rule: RobotRule,
        /// Largest delay.
        within_s: f64,
    },
    /// The agent makes the gesture, the robot (or the human it speaks to) within 12 m. What the log tells counts where the states
    /// show it within 0.25 s.
    Gestures [agent] Sign {
        /// The agent.
        agent: AgentId,
        /// Which.
        gesture: Gesture,
    },
    /// The human makes the gesture to a listener: within 12 m of them, and faces them (20°) or walks for 60 % of the time of the gesture;
    /// the robot does not stop by a gesture that is made to somebody else.
    GesturesTo [human] Sign {
        /// The human.
        human: HumanId,
        /// Which.
        gesture: Gesture,
        /// To whom.
        to: AgentId,
    },
    /// The human walks back: for at least 2 m, with the heading turned by 150° or more from that before.
    TurnsBack [human] Act {
        /// The human.
        human: HumanId,
    },
    /// After the reason for it the human comes within 1 m of one of the nodes, from 2 m and more away
    /// as they begin; or is as near as never before when the run ends, by half of that distance.
    GoesTo [human] Act {
        /// The human.
        human: HumanId,
        /// The nodes of the place.
        nodes: Vec<NodeId>,
    },
    /// After the reason for it the human comes within 1 m of where they began, from 2 m and more away as they turn; or is as near as never
    /// before when the run ends, by half of that distance.
    ComesBack [human] Act {
        /// The human.
        human: HumanId,
    },
    /// The human walks at another speed than before: the mean over 3 s of walking differs by 25 % or more, toward the speed asked for.
    ChangesPace [human] Act {
        /// The human.
        human: HumanId,
        /// The speed from then on, m/s.
        mps: f64,
    },
    /// The human stands beside the robot's way all the time: they go 0.5 m at most, unless an act of theirs leads them, the robot
    /// comes within 8 m of them, and is never nearer than 0.9 m.
    StaysAside [human] Company {
        /// The human.
        human: HumanId,
    },
    /// The human makes room and closes up again: gives way as the robot passes, as [`Predicate::GivesWay`] says, and is back within
    /// 0.7 m of where they stood within 10 s after it has passed.
    MakesRoom [human] Deed {
        /// The human.
        human: HumanId,
    },
    /// The human walks at this speed before the first act that changes how they go: the largest mean over 2 s of walking without a
    /// break is within 15 % of it. Of somebody whose acts leave no such time before them, the time between and after them counts, up to
    /// where they change their pace.
    Walks [human] Course {
        /// The human.
        human: HumanId,
        /// The speed, m/s.
        mps: f64,
    },
    /// The human goes to one of the nodes, which their planned way ends at: they start 2.5 m and more away from it, and end within
    /// 1.5 m of it, or in its room or car. Where the run ends first, they are on their way (2 m to either side), get on by 0.2 m in its last 2 s,
    /// and have half of the way behind them that they had before them as the robot was nearest.
    GetsTo [human] Course {
        /// The human.
        human: HumanId,
        /// The nodes of the place.
        nodes: Vec<NodeId>,
    },
    /// The human starts inside the door and crosses its line outward exactly once.
    Leaves [human] Course {
        /// The human.
        human: HumanId,
        /// The door, or empty for the door of the human's first node; where its room has none, the opening.
        #[serde(default)]
        door: String,
    },
    /// The human is behind the door for the whole run.
    StaysInside [human] Course {
        /// The human.
        human: HumanId,
        /// The door, or empty for the door of the human's first node; where its room has none, the opening.
        #[serde(default)]
        door: String,
    },
    /// The human starts outside the door and crosses its line inward exactly once.
    Enters [human] Course {
        /// The human.
        human: HumanId,
        /// The door, or empty for that of the human's last node, the opening of its room, or the nearest door.
        #[serde(default)]
        door: String,
    },
    /// The door opens while the robot is between these distances from it. Dropped with a note where the map has no doors.
    DoorOpens [] Course {
        /// The door, or empty for the one at the encounter.
        #[serde(default)]
        door: String,
        /// Smallest and largest distance of the robot.
        robot_m: [f64; 2],
    },
    /// There is no line of sight of 12 m or less between the human and the robot until they are within `within_m`,
    /// or until the door opens.
    HiddenUntil [human] Course {
        /// The human.
        human: HumanId,
        /// Distance of first sight.
        within_m: f64,
    },
    /// The group stands in formation, spread at most `spread_m`, until the robot is within 3 m: for 95 % of the time, with 80 % of
    /// its members facing its center.
    Formation [group] Company {
        /// The group.
        group: GroupId,
        /// Largest distance of a member from the center.
        spread_m: f64,
    },
    /// The group walks together, spread at most `spread_m` for 80 % of the time before the encounter, and 1 m at least.
    WalksTogether [group] Company {
        /// The group.
        group: GroupId,
        /// Largest distance of a member from the center.
        spread_m: f64,
    },
    /// The group stands in a line, each with its neighbor at a gap in a range, until the robot is within 3 m.
    Queues [group] Company {
        /// The group.
        group: GroupId,
        /// Smallest and largest gap between neighbors.
        gap_m: [f64; 2],
    },
    /// One clause is first seen 0.3 s and more before another: sooner than that is at the same time.
    Order [] Course {
        /// Clause id that must come first.
        first: String,
        /// Clause id that must come after.
        then: String,
    },
    /// One is there 0.3 s and more before the other: two humans, each at its encounter node (within 1.5 m, or nearest to it within
    /// 3 m), or a human and the robot at the human's. At a door whoever comes out goes outward, whoever goes in inward.
    Before [] Course {
        /// The agent that is there first.
        first: AgentId,
        /// The agent that is there later.
        then: AgentId,
        /// Whether at the door of the room or car of whoever leaves it, or of the robot's goal, instead: the first of them gets through it first.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        at_door: bool,
    },
    /// The encounter lies on a place of this class, or on one of the nodes where some are named, and happens there: the human is within
    /// 4 m of the node while the robot is within 6 m of the human.
    EncounterAt [human] Course {
        /// The class.
        place: PlaceClass,
        /// The nodes that count, where one place of the class is meant: `the kitchen`. Empty: every node of the class.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        nodes: Vec<NodeId>,
        /// The human whose encounter it is. Default: any.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        human: Option<HumanId>,
    },
    /// The agent comes within `within_m` of the node.
    Reaches [agent] Course {
        /// The agent.
        agent: AgentId,
        /// Where.
        node: NodeId,
        /// How near.
        within_m: f64,
    },
    /// The agent is within `within_m` of the node when the run begins.
    StartsAt [agent] Course {
        /// The agent.
        agent: AgentId,
        /// Where.
        node: NodeId,
        /// How near.
        within_m: f64,
    },
    /// The robot's way as planned begins at, ends at, leads past or keeps out of these nodes, and the reference robot drives so:
    /// it starts within 1.5 m of one, comes within 1.5 m of one, or never enters their room and stays 1 m away.
    RobotWay [] Course {
        /// Which part of the way.
        part: WayPart,
        /// The nodes that count: one of them is enough; of those to be kept out of, none.
        nodes: Vec<NodeId>,
    },
    /// The human and the robot get to the human's encounter node (within 1.5 m) at most `gap_s` apart.
    OnTime [human] Course {
        /// The human.
        human: HumanId,
        /// Largest difference of arrival times.
        gap_s: f64,
    },
    /// Nobody overlaps a wall or another agent by more than 2 cm, nobody is faster than 2 m/s.
    Plausible [] Bodies,
    /// The robot gets to its goal: it says so within 1.5 m of it (somebody may stand there), or comes within 0.5 m from outside.
    RobotArrives [] Result,
    /// The robot keeps this surface distance from every human.
    RobotKeeps [] Result {
        /// Smallest surface distance, m.
        min_m: f64,
    },
    /// The robot enters only after everybody who leaves is out.
    RobotEntersLast [] Result,
    /// The robot is out of the door before anybody who enters goes in.
    RobotLeavesFirst [] Result,
    /// The robot ends at the rim of the standing group: in its p-space, not in its o-space. Its members stand within 6 m of each
    /// other.
    RobotJoins [group] Result {
        /// The group.
        group: GroupId,
    },
    /// The robot starts in the space about the standing group (its r-space or nearer) and ends outside.
    RobotLeavesGroup [group] Result {
        /// The group.
        group: GroupId,
    },
    /// The robot stops within `within_s` of the gesture, having moved in the 5 s before it; for `PROCEED` and `FOLLOW_ME` it goes.
    /// The states of whoever makes the gesture show it.
    RobotObeys [] Result {
        /// The gesture.
        gesture: Gesture,
        /// Largest delay.
        within_s: f64,
    },
}
