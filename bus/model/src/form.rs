//! The form: people, groups and order stated exactly in the request, and what the robot does. What it states wins over the text.
//!
//! A form is read where the request is read ([`crate::Request::of_toml`]), into types that cannot be wrong: every name in it is
//! somebody's, every number is in its range. [`Form::people`] counts everybody out as `human_1` to `human_n`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::gesture::Gesture;
use crate::ids::{AgentId, GroupId, HumanId};
use crate::place::PlaceClass;
use crate::proposal::{Relation, Side};
use crate::rule::{Action, RobotDo, RobotRule, RobotWhen, Rule, Trigger};

mod words;

pub use words::{FacingWord, Pace, PaceWord, PlaceWord};

/// Everything that a request states exactly about people.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct Form {
    /// People, those who are alike together: `[[human]]`.
    #[serde(rename = "human", skip_serializing_if = "Vec::is_empty")]
    pub humans: Vec<FormHuman>,
    /// How groups stand or walk: `[[group]]`.
    #[serde(rename = "group", skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<FormGroup>,
    /// Which of two is there first: `[[order]]`.
    #[serde(rename = "order", skip_serializing_if = "Vec::is_empty")]
    pub orders: Vec<FormOrder>,
}

/// One `[[human]]`: somebody, or several who are alike.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormHuman {
    /// Name by which triggers and orders speak of them; without one `human_1`, `human_2`, … by their place in the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// How many are alike, 1 to 30. Default 1.
    #[serde(skip_serializing_if = "is_one")]
    pub count: u32,
    /// Role word. Default `person`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub role: Option<String>,
    /// How they stand to the robot's way.
    pub relation: Relation,
    /// Side of the robot's way that they come from, stand on or walk on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// Where they face at first, who stand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facing: Option<FacingWord>,
    /// Where they meet the robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<PlaceWord>,
    /// The room or car that they are in, or come out of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<PlaceWord>,
    /// Where they go.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<PlaceWord>,
    /// How fast they walk.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
    /// Their group.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// What they do, one after the other.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub does: Vec<Step>,
    /// What they do whenever something holds; earlier ones win, over `does` too.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reacts: Vec<Step>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde calls")]
const fn is_one(count: &u32) -> bool {
    *count == 1
}

/// One step of `does`, or one rule of `reacts`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
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
    /// Gesture made with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub say: Option<Gesture>,
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
}

impl When {
    /// The triggers, for messages.
    pub const ALLOWED: &str = "\"always\", { robot_visible = 5.0 }, { robot_near = 2.0 }, { robot_blocking = 2.0 }, \"robot_moving\", \
        \"robot_stopped\", \"robot_passed\", { robot_says = \"EXCUSE_ME\" }, { human_says = [\"nurse\", \"WAIT\"] }, \"goal_reached\", \
        \"at_encounter\", { after_secs = 5.0 }, or a list of them";

    /// Its number, with what it counts and what it may be.
    pub(crate) const fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        match self {
            Self::RobotVisible(m) | Self::RobotNear(m) | Self::RobotBlocking(m) => Some((*m, [0.3, 15.0], "m")),
            Self::AfterSecs(s) => Some((*s, [0.1, 600.0], "s")),
            Self::Always
            | Self::RobotMoving
            | Self::RobotStopped
            | Self::RobotPassed
            | Self::RobotSays(_)
            | Self::HumanSays(..)
            | Self::GoalReached
            | Self::AtEncounter => None,
        }
    }

    /// The person whom it names.
    pub(crate) const fn names(&self) -> Option<&String> {
        if let Self::HumanSays(id, _) = self { Some(id) } else { None }
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
}

impl Deed {
    /// The acts, for messages.
    pub const ALLOWED: &str = "navigate, stand_still, look_at_robot, follow_robot, { follow_human = \"nurse\" }, run_away, give_way, block, approach";

    /// The person whom it names.
    pub(crate) const fn names(&self) -> Option<&String> {
        if let Self::FollowHuman(id) = self { Some(id) } else { None }
    }
}

/// How a group stands or walks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormGroup {
    /// Its name, as people say it in `group`.
    pub id: String,
    /// Its shape. Default: a circle where they stand, side by side where they walk.
    pub formation: Formation,
}

/// Shape of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Formation {
    /// They stand in a circle.
    Circle,
    /// They stand one behind the other.
    Queue,
    /// They walk side by side.
    SideBySide,
}

/// One is there before the other, where they meet the robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormOrder {
    /// Name of whoever is there first, or `robot`.
    pub first: String,
    /// Name of whoever comes then, or `robot`.
    pub then: String,
    /// The door where: of a `doorway`, `room` or `elevator`. Without it: where they meet the robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<PlaceClass>,
}

/// One line of the robot's part: exactly one of its deeds.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotStep {
    /// When. Default: from the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub when: Option<RobotMoment>,
    /// What.
    #[serde(flatten)]
    pub act: RobotDeed,
}

/// When the robot acts: as [`RobotWhen`], with people by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RobotMoment {
    /// From the start.
    Start,
    /// Somebody has been close ahead of it for so many s.
    Blocked(f64),
    /// Somebody is within so many m.
    HumanNear(f64),
    /// Somebody makes this gesture.
    HumanSays(Gesture),
    /// It is where it meets this person.
    AtEncounter(String),
    /// Time after the start, s.
    AfterSecs(f64),
}

impl RobotMoment {
    /// The moments, for messages.
    pub const ALLOWED: &str = "\"start\", { blocked = 2.0 }, { human_near = 3.0 }, { human_says = \"WAIT\" }, { at_encounter = \"nurse\" }, \
        { after_secs = 5.0 }";

    pub(crate) const fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        match self {
            Self::Blocked(s) => Some((*s, [0.1, 60.0], "s")),
            Self::HumanNear(m) => Some((*m, [0.3, 15.0], "m")),
            Self::AfterSecs(s) => Some((*s, [0.1, 600.0], "s")),
            Self::Start | Self::HumanSays(_) | Self::AtEncounter(_) => None,
        }
    }

    pub(crate) const fn names(&self) -> Option<&String> {
        if let Self::AtEncounter(id) = self { Some(id) } else { None }
    }
}

/// What the robot does: as [`RobotDo`], with people by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RobotDeed {
    /// Makes a gesture.
    Say(Gesture),
    /// Stands for so many s, 0.1 to 60.
    HoldS(f64),
    /// Waits until everybody who leaves has left.
    WaitForLeavers(bool),
    /// Follows somebody.
    Follow(String),
    /// Goes beside somebody.
    Beside(String),
    /// Overtakes somebody.
    Overtake(String),
    /// Leads, and waits for followers farther behind than so many m, 1 to 15.
    LeadM(f64),
}

impl RobotDeed {
    /// Keys of the deeds.
    pub const KEYS: [&str; 7] = ["say", "hold_s", "wait_for_leavers", "follow", "beside", "overtake", "lead_m"];
    /// The deeds, for messages.
    pub const ALLOWED: &str = "one of say = \"WAIT\", hold_s = 3.0, wait_for_leavers = true, follow = \"nurse\", beside = \"nurse\", overtake = \"nurse\", lead_m = 4.0";

    pub(crate) const fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        match self {
            Self::HoldS(s) => Some((*s, [0.1, 60.0], "s")),
            Self::LeadM(m) => Some((*m, [1.0, 15.0], "m")),
            Self::Say(_) | Self::WaitForLeavers(_) | Self::Follow(_) | Self::Beside(_) | Self::Overtake(_) => None,
        }
    }

    pub(crate) const fn names(&self) -> Option<&String> {
        match self {
            Self::Follow(id) | Self::Beside(id) | Self::Overtake(id) => Some(id),
            Self::Say(_) | Self::HoldS(_) | Self::WaitForLeavers(_) | Self::LeadM(_) => None,
        }
    }
}

/// Somebody of a form, counted out.
#[derive(Debug, Clone, PartialEq)]
pub struct FormPerson<'a> {
    /// `human_1`, `human_2`, … in the order of the request.
    pub id: HumanId,
    /// What the form says of them.
    pub human: &'a FormHuman,
    /// `does` and `reacts` as rules: reactions first, which win.
    pub rules: Vec<Rule>,
    /// Their group.
    pub group: Option<GroupId>,
}

impl Form {
    /// Whether nothing is stated.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.humans.is_empty() && self.groups.is_empty() && self.orders.is_empty()
    }

    /// How many people there are.
    #[must_use]
    pub fn headcount(&self) -> u32 {
        self.humans.iter().map(|human| human.count).sum()
    }

    /// Every `[[human]]` with the first number of its people.
    fn numbered(&self) -> impl Iterator<Item = (u32, &FormHuman)> {
        self.humans.iter().scan(1, |next, human| {
            let first = *next;
            *next += human.count;
            Some((first, human))
        })
    }

    /// The people whom a name means: one for `human_3` and for the name of somebody alone, several for the name of several, the
    /// second of them for `visitor_2`; nobody where nobody is called so.
    #[must_use]
    pub fn named(&self, name: &str) -> Vec<HumanId> {
        let all = |first: u32, human: &FormHuman| (first..first + human.count).map(HumanId::new).collect::<Vec<_>>();
        let by_id = self.numbered().find(|(_, human)| human.id.as_deref() == Some(name));
        if let Some((first, human)) = by_id {
            return all(first, human);
        }
        let of_several = self.numbered().find_map(|(first, human)| {
            let rest = name.strip_prefix(human.id.as_deref()?)?.strip_prefix('_')?;
            let number: u32 = rest.parse().ok().filter(|number| (1..=human.count).contains(number))?;
            Some(HumanId::new(first + number - 1))
        });
        let by_number = || {
            let id: HumanId = name.parse().ok()?;
            (id.number() <= self.headcount()).then_some(id)
        };
        of_several.or_else(by_number).into_iter().collect()
    }

    /// The one person whom a name means.
    #[must_use]
    pub fn one(&self, name: &str) -> Option<HumanId> {
        match self.named(name)[..] {
            [id] => Some(id),
            _ => None,
        }
    }

    /// Names of groups in the order in which people name them: the first is `group_1`.
    #[must_use]
    pub fn group_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.humans.iter().filter_map(|human| human.group.as_deref()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Everybody, counted out.
    #[must_use]
    pub fn people(&self) -> Vec<FormPerson<'_>> {
        let groups = self.group_names();
        let group = |human: &FormHuman| {
            let at = groups.iter().position(|name| human.group.as_deref() == Some(name))?;
            u32::try_from(at + 1).ok().map(GroupId)
        };
        let person = |number: u32, human| FormPerson {
            id: HumanId::new(number),
            human,
            rules: self.rules(human),
            group: group(human),
        };
        self.numbered()
            .flat_map(|(first, human)| (first..first + human.count).map(move |number| (number, human)))
            .map(|(number, human)| person(number, human))
            .collect()
    }

    /// `does` and `reacts` as rules. A step of `does` goes on once it has begun; the next has the same triggers, and its turn comes
    /// when the time of the one before is over.
    fn rules(&self, human: &FormHuman) -> Vec<Rule> {
        let mut rules: Vec<Rule> = human.reacts.iter().filter_map(|step| self.rule(step, &step.when, false)).collect();
        let begins = human.does.first().map(|step| step.when.clone()).unwrap_or_default();
        rules.extend(human.does.iter().filter_map(|step| self.rule(step, &begins, true)));
        rules
    }

    fn rule(&self, step: &Step, when: &[When], latched: bool) -> Option<Rule> {
        let when: Option<Vec<Trigger>> = when.iter().map(|when| self.trigger(when)).collect();
        let when = when.map(|when| if when.is_empty() { vec![Trigger::Always] } else { when })?;
        let act = step.act.as_ref().map_or(Some(Action::StandStill), |deed| self.action(deed))?;
        // A sign lasts a moment where nothing else is said.
        let for_s = step.for_s.or_else(|| (step.act.is_none() && step.say.is_some()).then_some(Step::SIGN_S));
        Some(Rule { when, act, gesture: step.say, for_s, latched })
    }

    fn trigger(&self, when: &When) -> Option<Trigger> {
        Some(match when {
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
        })
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
            Deed::Block => Action::Block,
            Deed::Approach => Action::Approach,
        })
    }

    /// The agents whom a name of an order means.
    #[must_use]
    pub fn agents(&self, name: &str) -> Vec<AgentId> {
        if name == "robot" {
            return vec![AgentId::Robot];
        }
        self.named(name).into_iter().map(AgentId::Human).collect()
    }

    /// The lines of the robot's script.
    #[must_use]
    pub fn script(&self, steps: &[RobotStep]) -> Vec<RobotRule> {
        let when = |moment: &RobotMoment| {
            Some(match moment {
                RobotMoment::Start => RobotWhen::Start,
                RobotMoment::Blocked(s) => RobotWhen::Blocked(*s),
                RobotMoment::HumanNear(m) => RobotWhen::HumanNear(*m),
                RobotMoment::HumanSays(gesture) => RobotWhen::HumanSays(*gesture),
                RobotMoment::AtEncounter(name) => RobotWhen::AtEncounter(self.one(name)?),
                RobotMoment::AfterSecs(s) => RobotWhen::AfterSecs(*s),
            })
        };
        let act = |deed: &RobotDeed| {
            Some(match deed {
                RobotDeed::Say(gesture) => RobotDo::Say(*gesture),
                RobotDeed::HoldS(s) => RobotDo::Hold(*s),
                RobotDeed::WaitForLeavers(_) => RobotDo::WaitForLeavers,
                RobotDeed::Follow(name) => RobotDo::Follow(self.one(name)?),
                RobotDeed::Beside(name) => RobotDo::Abreast(self.one(name)?),
                RobotDeed::Overtake(name) => RobotDo::Overtake(self.one(name)?),
                RobotDeed::LeadM(m) => RobotDo::Lead(*m),
            })
        };
        let line = |step: &RobotStep| {
            let when = step.when.as_ref().map_or(Some(RobotWhen::Start), when)?;
            Some(RobotRule { when, act: act(&step.act)? })
        };
        steps.iter().filter_map(line).collect()
    }
}

impl Step {
    /// A sign without an act lasts so long, s.
    pub const SIGN_S: f64 = 2.0;
}
