//! Steps of a form: what somebody does, when it begins and what ends it; and the rules that they make.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Form, FormHuman, Pace, PaceWord, PlaceWord};
use crate::gesture::Gesture;
use crate::ids::{AgentId, HumanId};
use crate::rule::{Action, Rule, Trigger};

/// One step of `does`, or one rule of `reacts`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// All of these must hold for it to begin; empty in `does`: as soon as the step before has ended.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub when: Vec<When>,
    /// What is done. Default `stand_still` where something is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub act: Option<Deed>,
    /// For how long, s; without: as long as it takes, or to the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
    /// It ends when all of these hold.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub until: Vec<When>,
    /// Gesture made with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub say: Option<Gesture>,
    /// To whom: a person, `robot`, or `all`. Default: whoever notices it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
    /// How fast they walk from then on, for `change_pace`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
    /// How near they come, m, for `approach`: 0.7 to 2. Default 1.2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_m: Option<f64>,
}

/// A trigger of a form: as [`Trigger`], with people by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum When {
    /// From the start.
    Always,
    /// The robot is seen within so many m.
    RobotVisible(f64),
    /// The robot is within so many m.
    RobotNear(f64),
    /// The robot stands in their way within so many m.
    RobotBlocking(f64),
    /// The robot moves.
    RobotMoving,
    /// The robot stands.
    RobotStopped,
    /// The robot has passed.
    RobotPassed,
    /// The robot makes this gesture.
    RobotSays(Gesture),
    /// Somebody else makes this gesture.
    HumanSays(String, Gesture),
    /// They are at the end of their way.
    GoalReached,
    /// They are where they meet the robot.
    AtEncounter,
    /// Time after the start, s.
    AfterSecs(f64),
    /// The robot has stood for so many s.
    StoppedFor(f64),
    /// Somebody's step of this number, from 1, has ended.
    Did(String, u32),
    /// All steps of somebody have ended; of several, of all.
    Done(String),
}

impl When {
    /// The triggers with how each is written, for messages.
    pub(crate) const WORDS: &[(&str, &str)] = &[
        ("always", "\"always\""),
        ("robot_visible", "{ robot_visible = 5.0 }"),
        ("robot_near", "{ robot_near = 2.0 }"),
        ("robot_blocking", "{ robot_blocking = 2.0 }"),
        ("robot_moving", "\"robot_moving\""),
        ("robot_stopped", "\"robot_stopped\""),
        ("robot_passed", "\"robot_passed\""),
        ("stopped_for", "{ stopped_for = 3.0 }"),
        ("robot_says", "{ robot_says = \"EXCUSE_ME\" }"),
        ("human_says", "{ human_says = [\"nurse\", \"WAIT\"] }"),
        ("did", "{ did = [\"nurse\", 1] }"),
        ("done", "{ done = \"nurse\" }"),
        ("goal_reached", "\"goal_reached\""),
        ("at_encounter", "\"at_encounter\""),
        ("after_secs", "{ after_secs = 5.0 }"),
    ];

    /// Its number, with what it counts and what it may be.
    pub(crate) const fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        match self {
            Self::RobotVisible(m) | Self::RobotNear(m) | Self::RobotBlocking(m) => Some((*m, [0.3, 15.0], "m")),
            Self::AfterSecs(s) | Self::StoppedFor(s) => Some((*s, [0.1, 600.0], "s")),
            Self::Always
            | Self::RobotMoving
            | Self::RobotStopped
            | Self::RobotPassed
            | Self::RobotSays(_)
            | Self::HumanSays(..)
            | Self::Did(..)
            | Self::Done(_)
            | Self::GoalReached
            | Self::AtEncounter => None,
        }
    }

    /// The person whom it names, with the key by which it does.
    pub(crate) const fn names(&self) -> Option<(&String, &'static str)> {
        match self {
            Self::HumanSays(id, _) => Some((id, "human_says")),
            Self::Did(id, _) => Some((id, "did")),
            Self::Done(id) => Some((id, "done")),
            Self::Always
            | Self::RobotVisible(_)
            | Self::RobotNear(_)
            | Self::RobotBlocking(_)
            | Self::RobotMoving
            | Self::RobotStopped
            | Self::RobotPassed
            | Self::RobotSays(_)
            | Self::GoalReached
            | Self::AtEncounter
            | Self::AfterSecs(_)
            | Self::StoppedFor(_) => None,
        }
    }
}

/// What somebody does: as [`Action`], with people by name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Deed {
    /// Walks on along their way.
    Navigate,
    /// Stands still.
    StandStill,
    /// Stops and turns to the robot.
    LookAtRobot,
    /// Follows the robot.
    FollowRobot,
    /// Follows somebody else.
    FollowHuman(String),
    /// Hurries away from the robot.
    RunAway,
    /// Steps out of the robot's way.
    GiveWay,
    /// Stays in front of the robot.
    Block,
    /// Goes up to the robot.
    Approach,
    /// Stops and turns to somebody else.
    LookAt(String),
    /// Turns and walks back the way they came.
    TurnBack,
    /// Leaves their way and goes to a place.
    GoTo(PlaceWord),
    /// Walks on, from then on at another pace.
    ChangePace,
    /// Steps out of the robot's way, and comes back once it has passed.
    MakeRoom,
}

impl Deed {
    /// The acts with how each is written, for messages.
    pub(crate) const WORDS: &[(&str, &str)] = &[
        ("navigate", "\"navigate\""),
        ("stand_still", "\"stand_still\""),
        ("look_at_robot", "\"look_at_robot\""),
        ("follow_robot", "\"follow_robot\""),
        ("follow_human", "{ follow_human = \"nurse\" }"),
        ("run_away", "\"run_away\""),
        ("give_way", "\"give_way\""),
        ("make_room", "\"make_room\""),
        ("block", "\"block\""),
        ("approach", "\"approach\""),
        ("look_at", "{ look_at = \"nurse\" }"),
        ("turn_back", "\"turn_back\""),
        ("go_to", "{ go_to = \"corridor\" }"),
        ("change_pace", "\"change_pace\""),
    ];

    /// The acts, for messages.
    pub(crate) fn allowed() -> String {
        let words: Vec<&str> = Self::WORDS.iter().map(|(_, example)| *example).collect();
        words.join(", ")
    }

    /// The person whom it names, with the key by which it does.
    pub(crate) const fn names(&self) -> Option<(&String, &'static str)> {
        match self {
            Self::FollowHuman(id) => Some((id, "follow_human")),
            Self::LookAt(id) => Some((id, "look_at")),
            Self::Navigate
            | Self::StandStill
            | Self::LookAtRobot
            | Self::FollowRobot
            | Self::RunAway
            | Self::GiveWay
            | Self::MakeRoom
            | Self::Block
            | Self::Approach
            | Self::TurnBack
            | Self::GoTo(_)
            | Self::ChangePace => None,
        }
    }

    /// What ends it where nothing is said of that.
    const fn ends(&self) -> Option<Trigger> {
        match self {
            Self::Navigate | Self::TurnBack | Self::GoTo(_) => Some(Trigger::GoalReached),
            Self::GiveWay | Self::MakeRoom => Some(Trigger::RobotPassed),
            Self::StandStill
            | Self::LookAtRobot
            | Self::FollowRobot
            | Self::FollowHuman(_)
            | Self::RunAway
            | Self::Block
            | Self::Approach
            | Self::LookAt(_)
            | Self::ChangePace => None,
        }
    }
}

impl Step {
    /// A sign without an act lasts so long, s.
    pub const SIGN_S: f64 = 2.0;
    /// Another pace is taken up in so much time, s; it stays.
    pub const PACE_S: f64 = 1.0;
    /// Usual walking speed, m/s: what `normal` means for a pace that changes.
    const NORMAL_MPS: f64 = 1.2;

    /// For how long it lasts at most, s: as stated; a sign for a moment where nothing else is said.
    fn lasts_s(&self) -> Option<f64> {
        let sign = self.act.is_none() && self.say.is_some() && self.until.is_empty();
        let pace = self.act == Some(Deed::ChangePace) && self.until.is_empty();
        self.for_s.or_else(|| sign.then_some(Self::SIGN_S)).or_else(|| pace.then_some(Self::PACE_S))
    }

    /// What ends it by itself.
    fn by_itself(&self) -> Option<Trigger> {
        let open = self.lasts_s().is_none() && self.until.is_empty();
        self.act.as_ref().filter(|_| open).and_then(Deed::ends)
    }

    /// Whether nothing ends it but the end of the run.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.lasts_s().is_none() && self.until.is_empty() && self.by_itself().is_none()
    }
}

impl Form {
    /// `does` and `reacts` as rules. A step of `does` begins when the one before it has ended and its own triggers hold, and goes on
    /// to its end.
    pub(super) fn rules(&self, id: HumanId, human: &FormHuman) -> Vec<Rule> {
        let mut rules: Vec<Rule> = human.reacts.iter().filter_map(|step| self.rule(step)).collect();
        for (number, step) in (1..).zip(&human.does) {
            let Some(mut rule) = self.rule(step) else { continue };
            if number > 1 {
                rule.when.retain(|trigger| *trigger != Trigger::Always);
                rule.when.insert(0, Trigger::Did(id, number - 1));
            }
            (rule.latched, rule.step) = (true, Some(number));
            rule.until = self.triggers(&step.until).unwrap_or_default();
            rule.until.extend(step.by_itself());
            rules.push(rule);
        }
        rules
    }

    fn rule(&self, step: &Step) -> Option<Rule> {
        let when = self.triggers(&step.when)?;
        let when = if when.is_empty() { vec![Trigger::Always] } else { when };
        let to = step.to.as_deref().filter(|_| step.say.is_some()).and_then(|name| self.agents(name).first().copied());
        let act = match (&step.act, to) {
            (Some(Deed::ChangePace), _) => {
                let normal = step.pace.is_some_and(|pace| pace == Pace::Word(PaceWord::Normal));
                Action::ChangePace(step.pace?.mps().or_else(|| normal.then_some(Step::NORMAL_MPS))?)
            }
            // A sign is made facing whomever it is made to.
            (Some(Deed::Approach), _) if step.near_m.is_some() => Action::ApproachTo(step.near_m?),
            (None | Some(Deed::StandStill), Some(AgentId::Human(id))) => Action::LookAt(id),
            (None | Some(Deed::StandStill), Some(AgentId::Robot)) => Action::LookAtRobot,
            (None, None) => Action::StandStill,
            (Some(deed), _) => self.action(deed)?,
        };
        Some(Rule { when, act, gesture: step.say, to, for_s: step.lasts_s(), ..Rule::default() })
    }

    fn triggers(&self, when: &[When]) -> Option<Vec<Trigger>> {
        let all: Option<Vec<Vec<Trigger>>> = when.iter().map(|when| self.trigger(when)).collect();
        all.map(|all| all.concat())
    }

    fn trigger(&self, when: &When) -> Option<Vec<Trigger>> {
        Some(vec![match when {
            When::Always => Trigger::Always,
            When::RobotVisible(m) => Trigger::RobotVisible(*m),
            When::RobotNear(m) => Trigger::RobotNear(*m),
            When::RobotBlocking(m) => Trigger::RobotBlocking(*m),
            When::RobotMoving => Trigger::RobotMoving,
            When::RobotStopped => Trigger::RobotStopped,
            When::RobotPassed => Trigger::RobotPassed,
            When::RobotSays(gesture) => Trigger::RobotSays(*gesture),
            When::HumanSays(name, gesture) => Trigger::HumanSays(self.one(name)?, *gesture),
            When::GoalReached => Trigger::GoalReached,
            When::AtEncounter => Trigger::AtEncounter,
            When::AfterSecs(s) => Trigger::AfterSecs(*s),
            When::StoppedFor(s) => Trigger::StoppedFor(*s),
            When::Did(name, step) => Trigger::Did(self.one(name)?, *step),
            When::Done(name) => return Some(self.named(name).into_iter().map(Trigger::Done).collect()),
        }])
    }

    fn action(&self, deed: &Deed) -> Option<Action> {
        Some(match deed {
            Deed::Navigate => Action::Navigate,
            Deed::StandStill => Action::StandStill,
            Deed::LookAtRobot => Action::LookAtRobot,
            Deed::FollowRobot => Action::FollowRobot,
            Deed::FollowHuman(name) => Action::FollowHuman(self.one(name)?),
            Deed::RunAway => Action::RunAway,
            Deed::GiveWay => Action::GiveWay,
            Deed::MakeRoom => Action::MakeRoom,
            Deed::Block => Action::Block,
            Deed::Approach => Action::Approach,
            Deed::LookAt(name) => Action::LookAt(self.one(name)?),
            Deed::TurnBack => Action::TurnBack,
            // Its nodes are those of a map.
            Deed::GoTo(place) => Action::GoTo { place: place.to_string().replace('_', " "), nodes: Vec::new() },
            // With its pace: see `rule`.
            Deed::ChangePace => return None,
        })
    }
}
