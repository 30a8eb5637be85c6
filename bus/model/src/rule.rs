//! Rules: what a human does when something happens; what the robot's script says.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::act::{self, Action};
use crate::gesture::Gesture;
use crate::ids::{AgentId, HumanId};

/// What is said of a moment that a person or the robot waits for, whoever waits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentRow {
    /// Its word in a form, and its tag in JSON: `robot_near`.
    pub word: &'static str,
    /// Its argument, as TOML and JSON write one; empty for a trigger without.
    pub argument: &'static str,
    /// What it means, for an author, where the word does not say so.
    pub meaning: &'static str,
}

impl MomentRow {
    /// As a form writes it, in TOML: `{ robot_near = 2.0 }`.
    #[must_use]
    pub fn toml(&self) -> String {
        act::toml(self.word, self.argument)
    }

    /// As an answer writes it, in JSON: `{"robot_near":2.0}`.
    #[must_use]
    pub fn json(&self) -> String {
        act::json(self.word, self.argument)
    }
}

/// Moments: the type, its table, and a row for each: name, arguments, word, an argument as it is written, meaning.
macro_rules! moments {
    (
        $(#[$of_all:meta])* enum $moment:ident, $(#[$of_table:meta])* const $table:ident:
        $($(#[$meta:meta])* $name:ident $(($($argument:ty),*))? = $word:literal $written:literal $meaning:literal;)*
    ) => {
        $(#[$of_all])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case", deny_unknown_fields)]
        pub enum $moment<P = HumanId> {
            $($(#[$meta])* $name $(($($argument),*))?,)*
        }

        $(#[$of_table])*
        pub const $table: &[MomentRow] = &[$(MomentRow { word: $word, argument: $written, meaning: $meaning }),*];

        impl<P> $moment<P> {
            /// Its word in a form.
            #[must_use]
            pub const fn word(&self) -> &'static str {
                match self {
                    $(Self::$name { .. } => $word,)*
                }
            }
        }
    };
}

moments! {
    /// Something a human can notice. Distances are center to center, m. People are those of a run; a form names them in its own words.
    enum Trigger,
    /// Every trigger, in the order in which an author reads them.
    const TRIGGERS:
    /// Always, from the first tick.
    Always = "always" "" "from the start";
    /// The robot is in the field of view, in line of sight and within this distance.
    RobotVisible(f64) = "robot_visible" "5.0" "seen within this distance, m, 0.3 to 15; never by those who walk ahead of it";
    /// The robot is within this distance, seen or not.
    RobotNear(f64) = "robot_near" "2.0" "through walls too";
    /// The robot stands in the human's way within this distance.
    RobotBlocking(f64) = "robot_blocking" "2.0" "near, and stands in their way";
    /// The robot moves.
    RobotMoving = "robot_moving" "" "";
    /// The robot stands still.
    RobotStopped = "robot_stopped" "" "";
    /// The robot has moved before and has stood for so many seconds.
    StoppedFor(f64) = "stopped_for" "3.0" "s";
    /// The robot has been within [`Trigger::PASSED_WITHIN_M`] and is [`Trigger::PASSED_BY_M`] farther away again.
    RobotPassed = "robot_passed" "" "was near and goes away again";
    /// The robot makes this gesture.
    RobotSays(Gesture) = "robot_says" "\"EXCUSE_ME\"" "";
    /// Another human makes this gesture.
    HumanSays(P, Gesture) = "human_says" "[\"human_2\", \"WAIT\"]" "";
    /// The step of this number, from 1, of a human's sequence has ended.
    Did(P, u32) = "did" "[\"human_2\", 1]" "the first step of their `does` has ended";
    /// All steps of a human have ended. Somebody without steps is done at the end of their way, or once where they meet the robot is
    /// [`Trigger::DONE_M`] behind them.
    Done(P) = "done" "\"human_2\"" "all their steps have ended; without steps: they are past where they meet the robot";
    /// The human is at the node where it meets the robot; of several, the first.
    AtEncounter = "at_encounter" "" "they are where they meet the robot";
    /// The human is at the end of its path.
    GoalReached = "goal_reached" "" "they are at the end of their way";
    /// Time since the start of the run, s.
    AfterSecs(f64) = "after_secs" "10.0" "after the start of the run";
}

impl<P> Trigger<P> {
    /// The person for whom it waits.
    #[must_use]
    pub const fn names(&self) -> Option<&P> {
        if let Self::HumanSays(id, _) | Self::Did(id, _) | Self::Done(id) = self { Some(id) } else { None }
    }

    /// The distance from the robot at which it holds, m; `None` for triggers without one.
    #[must_use]
    pub const fn distance_m(&self) -> Option<f64> {
        if let Self::RobotVisible(m) | Self::RobotNear(m) | Self::RobotBlocking(m) = self { Some(*m) } else { None }
    }

    /// Its time, s; `None` for triggers without one.
    #[must_use]
    pub const fn secs(&self) -> Option<f64> {
        if let Self::AfterSecs(s) | Self::StoppedFor(s) = self { Some(*s) } else { None }
    }

    /// The same trigger with other people in the place of one; `people` gives nobody for a name without people, which leaves no trigger.
    pub(crate) fn of_people<Q>(&self, people: impl Fn(&P) -> Vec<Q>) -> Vec<Trigger<Q>> {
        let of = |person: &P, trigger: &dyn Fn(Q) -> Trigger<Q>| people(person).into_iter().map(trigger).collect();
        match self {
            Self::HumanSays(person, gesture) => of(person, &|one| Trigger::HumanSays(one, *gesture)),
            Self::Did(person, step) => of(person, &|one| Trigger::Did(one, *step)),
            Self::Done(person) => of(person, &Trigger::Done),
            Self::Always => vec![Trigger::Always],
            Self::RobotVisible(m) => vec![Trigger::RobotVisible(*m)],
            Self::RobotNear(m) => vec![Trigger::RobotNear(*m)],
            Self::RobotBlocking(m) => vec![Trigger::RobotBlocking(*m)],
            Self::RobotMoving => vec![Trigger::RobotMoving],
            Self::RobotStopped => vec![Trigger::RobotStopped],
            Self::RobotPassed => vec![Trigger::RobotPassed],
            Self::RobotSays(gesture) => vec![Trigger::RobotSays(*gesture)],
            Self::GoalReached => vec![Trigger::GoalReached],
            Self::AtEncounter => vec![Trigger::AtEncounter],
            Self::AfterSecs(s) => vec![Trigger::AfterSecs(*s)],
            Self::StoppedFor(s) => vec![Trigger::StoppedFor(*s)],
        }
    }
}

impl Trigger {
    /// A robot that was never nearer than this has not passed anybody, m.
    pub const PASSED_WITHIN_M: f64 = 4.0;
    /// So much farther away than it was at its nearest, it has passed, m.
    pub const PASSED_BY_M: f64 = 1.0;
    /// So far beyond where they meet the robot somebody without steps is done, m.
    pub const DONE_M: f64 = 1.5;

    /// Whether a robot that is `distance_m` away and was `nearest_m` away at its nearest has passed.
    #[must_use]
    pub const fn is_passed(distance_m: f64, nearest_m: f64) -> bool {
        nearest_m <= Self::PASSED_WITHIN_M && distance_m - nearest_m >= Self::PASSED_BY_M
    }

    /// The agent that has to make a gesture for it, and which; `None` for triggers that wait for no gesture.
    #[must_use]
    pub const fn awaits(&self) -> Option<(AgentId, Gesture)> {
        if let Self::RobotSays(gesture) = self {
            Some((AgentId::Robot, *gesture))
        } else if let Self::HumanSays(id, gesture) = self {
            Some((AgentId::Human(*id), *gesture))
        } else {
            None
        }
    }

    /// The same trigger at another distance from the robot, m; one without a distance stays as it is.
    #[must_use]
    pub const fn at_distance(mut self, distance_m: f64) -> Self {
        if let Self::RobotVisible(m) | Self::RobotNear(m) | Self::RobotBlocking(m) = &mut self {
            *m = distance_m;
        }
        self
    }

    /// Whether the other one holds whenever this one does: `robot_near:2` implies `robot_near:3`.
    #[must_use]
    pub fn implies(&self, other: &Self) -> bool {
        match (self, other) {
            (_, Self::Always) | (Self::StoppedFor(_), Self::RobotStopped) => true,
            (Self::RobotNear(own) | Self::RobotVisible(own) | Self::RobotBlocking(own), Self::RobotNear(m))
            | (Self::RobotVisible(own) | Self::RobotBlocking(own), Self::RobotVisible(m))
            | (Self::RobotBlocking(own), Self::RobotBlocking(m)) => own <= m,
            (Self::AfterSecs(own), Self::AfterSecs(s)) | (Self::StoppedFor(own), Self::StoppedFor(s)) => own >= s,
            (own, other) => own == other,
        }
    }

    /// What holds, as a clause: `the robot is within 2 m`.
    #[must_use]
    pub fn clause(&self) -> String {
        if let Self::AfterSecs(s) = self {
            return format!("{s} s have passed");
        }
        let own = [
            (Self::Always, "at once"),
            (Self::GoalReached, "they are at their goal"),
            (Self::AtEncounter, "they are at the encounter"),
        ];
        let phrase = self.phrase();
        let known = own.iter().find(|(trigger, _)| trigger == self).map(|(_, words)| *words);
        known.or_else(|| phrase.split_once(' ').map(|(_, rest)| rest)).unwrap_or(&phrase).to_owned()
    }

    /// The trigger in words: `when they see the robot within 5 m`.
    #[must_use]
    pub fn phrase(&self) -> String {
        match self {
            Self::Always => "from the start".to_owned(),
            Self::RobotVisible(m) => format!("when they see the robot within {m} m"),
            Self::RobotNear(m) => format!("when the robot is within {m} m"),
            Self::RobotBlocking(m) => format!("when the robot is in their way within {m} m"),
            Self::RobotMoving => "while the robot moves".to_owned(),
            Self::RobotStopped => "while the robot stands".to_owned(),
            Self::RobotPassed => "once the robot has passed".to_owned(),
            Self::RobotSays(gesture) => format!("when the robot says {gesture}"),
            Self::HumanSays(id, gesture) => format!("when {id} says {gesture}"),
            Self::GoalReached => "at their goal".to_owned(),
            Self::AtEncounter => "at the encounter".to_owned(),
            Self::AfterSecs(s) => format!("after {s} s"),
            Self::StoppedFor(s) => format!("when the robot has stood for {s} s"),
            Self::Did(id, step) => format!("once step {step} of {id} is over"),
            Self::Done(id) => format!("once {id} is done"),
        }
    }
}

/// One rule of a human: when all triggers hold, do this. Earlier rules win over later ones;
/// without a rule that holds, a human walks its path (or stands, if the path is one node).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rule {
    /// All of these must hold.
    pub when: Vec<Trigger>,
    /// What is done.
    pub act: Action,
    /// Gesture made as the rule starts; taken back when it ends.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "crate::gesture::or_none::deserialize"
    )]
    pub gesture: Option<Gesture>,
    /// To whom the gesture is made, where that is one: nobody else reacts to it. Without: to whoever notices it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<AgentId>,
    /// Seconds for which it is done, counted while it is done; without: as long as the triggers hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
    /// Once started, goes on even when the triggers no longer hold (until `for_s`, or the end).
    #[serde(default)]
    pub latched: bool,
    /// Its number in the human's sequence of steps, from 1: once it has ended it never begins again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u32>,
    /// A step ends when all of these hold.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub until: Vec<Trigger>,
}

impl Trigger {
    /// Triggers that hold together, in words: `when they see the robot within 3 m and when the robot moves`.
    #[must_use]
    pub fn phrases(when: &[Self]) -> String {
        when.iter().map(Self::phrase).collect::<Vec<_>>().join(" and ")
    }
}

impl Rule {
    /// Whether a later rule of the same human is never played because of this one: whenever that one's triggers hold these do too, and
    /// earlier rules win. A rule that ends by itself (after a time, or as a step) leaves room for what follows.
    #[must_use]
    pub fn hides(&self, later: &Self) -> bool {
        let implied = |own: &Trigger| later.when.iter().any(|other| other.implies(own));
        self.for_s.is_none() && self.step.is_none() && self.until.is_empty() && self.when.iter().all(implied)
    }

    /// The rules that are never played, each after the first that hides it, by their places.
    #[must_use]
    pub fn hidden(rules: &[Self]) -> Vec<(usize, usize)> {
        let by = |(at, later): (usize, &Self)| Some((rules.iter().take(at).position(|rule| rule.hides(later))?, at));
        rules.iter().enumerate().filter_map(by).collect()
    }

    /// Lets every rule have its turn: one that a wider one hides goes before it; the first of two with the same triggers ends after
    /// [`Self::TURN_S`].
    pub fn take_turns(rules: &mut [Self]) {
        // Each round mends a pair for good: a narrower rule stays before a wider one, and what ends hides nothing.
        for _ in 0..rules.len() * rules.len() {
            let Some((hiding, later)) = Self::hidden(rules).first().copied() else { return };
            let same = rules.get(later).zip(rules.get(hiding)).is_some_and(|(later, first)| later.hides(first));
            if same && let Some(first) = rules.get_mut(hiding) {
                first.for_s = Some(Self::TURN_S);
            } else if let Some(between) = rules.get_mut(hiding..=later) {
                between.rotate_right(1);
            }
        }
    }

    /// Time after which a rule ends that would hide another one with the same triggers, s.
    pub const TURN_S: f64 = 3.0;

    /// The rule in words: `when the robot is within 2 m they give way to the robot and say PROCEED`.
    #[must_use]
    pub fn phrase(&self) -> String {
        let to = self.to.map_or_else(String::new, |to| format!(" to {to}"));
        let gesture = self.gesture.map_or_else(String::new, |gesture| format!(" and say {gesture}{to}"));
        format!("{} they {}{gesture}", Trigger::phrases(&self.when), self.act.they())
    }
}

moments! {
    /// When the robot's script acts. People are those of a run; a form names them in its own words.
    enum RobotWhen,
    /// Every moment of the robot, in the order in which an author reads them.
    const ROBOT_MOMENTS:
    /// From the start.
    Start = "start" "" "the first line unless stated; others begin when the line before is over";
    /// A human has been within 1.6 m ahead of it for so many seconds.
    Blocked(f64) = "blocked" "2.0" "s in which somebody is close ahead";
    /// A human is within this distance, m.
    HumanNear(f64) = "human_near" "3.0" "m, whoever comes first";
    /// This human is within this distance, m.
    Near(P, f64) = "near" "[\"human_1\", 3.0]" "this person";
    /// A human makes this gesture.
    HumanSays(Gesture) = "human_says" "\"WAIT\"" "";
    /// It reaches the encounter node of this human, or them while they are there; of several encounters, the first.
    AtEncounter(P) = "at_encounter" "\"human_1\"" "";
    /// The step of this number, from 1, of a human's sequence has ended.
    Did(P, u32) = "did" "[\"human_1\", 1]" "the first step of their `does` has ended";
    /// All steps of a human have ended, as [`Trigger::Done`] says.
    Done(P) = "done" "\"human_1\"" "all their steps have ended; without steps: they are past where they meet the robot";
    /// Time since the start, s.
    AfterSecs(f64) = "after_secs" "5.0" "";
    /// The line of this number, from 1, of the script is over.
    AfterLine(u32) = "after_line" "1" "this line of `robot.does` is over";
}

impl<P> RobotWhen<P> {
    /// The person for whom it waits.
    #[must_use]
    pub const fn names(&self) -> Option<&P> {
        if let Self::Near(id, _) | Self::AtEncounter(id) | Self::Did(id, _) | Self::Done(id) = self {
            Some(id)
        } else {
            None
        }
    }

    /// The same moment of other people; nothing where one of them is not there.
    pub(crate) fn of_person<Q>(&self, person: impl Fn(&P) -> Option<Q>) -> Option<RobotWhen<Q>> {
        Some(match self {
            Self::Start => RobotWhen::Start,
            Self::Blocked(s) => RobotWhen::Blocked(*s),
            Self::HumanNear(m) => RobotWhen::HumanNear(*m),
            Self::Near(id, m) => RobotWhen::Near(person(id)?, *m),
            Self::HumanSays(gesture) => RobotWhen::HumanSays(*gesture),
            Self::AtEncounter(id) => RobotWhen::AtEncounter(person(id)?),
            Self::Did(id, step) => RobotWhen::Did(person(id)?, *step),
            Self::Done(id) => RobotWhen::Done(person(id)?),
            Self::AfterSecs(s) => RobotWhen::AfterSecs(*s),
            Self::AfterLine(number) => RobotWhen::AfterLine(*number),
        })
    }
}

impl RobotWhen {
    /// The moment in words: `when a human is within 2 m`.
    #[must_use]
    pub fn phrase(&self) -> String {
        match self {
            Self::Start => "from the start".to_owned(),
            Self::Blocked(s) => format!("when it was blocked for {s} s"),
            Self::HumanNear(m) => format!("when a human is within {m} m"),
            Self::Near(human, m) => format!("when {human} is within {m} m"),
            Self::HumanSays(gesture) => format!("when a human says {gesture}"),
            Self::AtEncounter(human) => format!("at the encounter with {human}"),
            Self::AfterSecs(s) => format!("after {s} s"),
            Self::Did(human, step) => format!("once step {step} of {human} is over"),
            Self::Done(human) => format!("once {human} is done"),
            Self::AfterLine(number) => format!("once line {number} of its script is over"),
        }
    }

    /// The robot is at an encounter within this distance of its node, m, or of the human while they are at it, m from the node.
    const AT_NODE_M: f64 = 1.0;
    const AT_HUMAN_M: f64 = 1.8;
    const HUMAN_AT_NODE_M: f64 = 1.5;

    /// Margin by which the robot is at an encounter, m; below 0 it is not. Distances: robot to node, robot to human, human to node, m.
    #[must_use]
    pub const fn at_encounter_m(robot_to_node_m: f64, robot_to_human_m: f64, human_to_node_m: f64) -> f64 {
        let beside = (Self::AT_HUMAN_M - robot_to_human_m).min(Self::HUMAN_AT_NODE_M - human_to_node_m);
        (Self::AT_NODE_M - robot_to_node_m).max(beside)
    }

    /// Within this distance ahead of the robot a human blocks it, m: it stops more than a meter before whoever stands in its way.
    pub const BLOCKED_M: f64 = 1.6;
    /// Up to this angle from where it faces a human is ahead of it, rad.
    pub const AHEAD_RAD: f64 = 0.8;

    /// Whether a human at this distance, m, and bearing from the robot, rad, blocks it.
    #[must_use]
    pub const fn is_blocked_by(distance_m: f64, bearing_rad: f64) -> bool {
        distance_m < Self::BLOCKED_M && bearing_rad.abs() < Self::AHEAD_RAD
    }
}

/// What the robot's script does. Played by the `reference` planner; others take gestures only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RobotDo {
    /// Makes a gesture for 2 s.
    Say(Gesture),
    /// Stands still for so many seconds.
    Hold(f64),
    /// Stands still until this comes, for [`RobotDo::HOLD_MOST_S`] at most.
    HoldUntil(RobotWhen),
    /// Waits outside a door until everybody who leaves has left.
    WaitForLeavers,
    /// Follows this human.
    Follow(HumanId),
    /// Goes beside this human.
    Abreast(HumanId),
    /// Passes this human, who walks ahead and slower, where the floor is wide enough.
    Overtake(HumanId),
    /// Waits for its followers when they fall more than this far behind, m.
    Lead(f64),
}

impl RobotDo {
    /// Duration of a sign, s.
    pub const SAYS_S: f64 = 2.0;
    /// Longest time for which the robot waits for something, s.
    pub const HOLD_MOST_S: f64 = 60.0;

    /// Time after which it is over at the latest, s. With 0 it goes on beside what comes next.
    #[must_use]
    pub const fn longest_s(&self) -> f64 {
        match self {
            Self::Say(_) => Self::SAYS_S,
            Self::Hold(secs) => *secs,
            Self::HoldUntil(_) => Self::HOLD_MOST_S,
            Self::WaitForLeavers | Self::Follow(_) | Self::Abreast(_) | Self::Overtake(_) | Self::Lead(_) => 0.0,
        }
    }
}

/// One line of the robot script.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotRule {
    /// When.
    pub when: RobotWhen,
    /// What.
    pub act: RobotDo,
}

impl RobotRule {
    /// The line in words: `when a human is within 2 m: says EXCUSE_ME`.
    #[must_use]
    pub fn phrase(&self) -> String {
        let when = self.when.phrase();
        let act = match &self.act {
            RobotDo::Say(gesture) => format!("says {gesture}"),
            RobotDo::Hold(s) => format!("stands still for {s} s"),
            RobotDo::HoldUntil(until) => format!("stands still until: {}", until.phrase()),
            RobotDo::WaitForLeavers => "waits until everybody who leaves has left".to_owned(),
            RobotDo::Follow(human) => format!("follows {human}"),
            RobotDo::Abreast(human) => format!("goes beside {human}"),
            RobotDo::Overtake(human) => format!("overtakes {human} where there is room"),
            RobotDo::Lead(m) => format!("leads, and waits when a follower is more than {m} m behind"),
        };
        format!("{when} it {act}")
    }
}
