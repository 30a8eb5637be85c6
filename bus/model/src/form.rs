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
use crate::rule::{RobotDo, RobotRule, RobotWhen, Rule};

mod step;

pub use step::{Deed, Step, When};

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

/// How a group stands or walks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormGroup {
    /// Its name, as people say it in `group`.
    pub id: String,
    /// Its shape. Default: a circle where they stand, side by side where they walk.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formation: Option<Formation>,
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
    /// When. Default: from the start, or once the line before is over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub when: Option<RobotMoment>,
    /// What.
    #[serde(flatten)]
    pub act: RobotDeed,
}

/// When the robot acts: a moment with people by name.
pub type RobotMoment = RobotWhen<String>;

impl RobotMoment {
    pub(crate) const fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        if let Self::HumanNear(m) | Self::Near(_, m) = self {
            Some((*m, [0.3, 15.0], "m"))
        } else if let Self::Blocked(s) = self {
            Some((*s, [0.1, 60.0], "s"))
        } else if let Self::AfterSecs(s) = self {
            Some((*s, [0.1, 600.0], "s"))
        } else {
            None
        }
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
    /// Stands until this comes, for 60 s at most.
    HoldUntil(RobotMoment),
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
    /// Whether the robot stands for it.
    const fn stands(&self) -> bool {
        matches!(self, Self::HoldS(_) | Self::HoldUntil(_))
    }

    /// Keys of the deeds.
    pub const KEYS: [&str; 8] =
        ["say", "hold_s", "hold_until", "wait_for_leavers", "follow", "beside", "overtake", "lead_m"];
    /// The deeds with how each is written, for messages.
    pub(crate) const WORDS: &[(&str, &str)] = &[
        ("say", "say = \"WAIT\""),
        ("hold_s", "hold_s = 3.0"),
        ("hold_until", "hold_until = { human_says = \"PROCEED\" }"),
        ("wait_for_leavers", "wait_for_leavers = true"),
        ("follow", "follow = \"nurse\""),
        ("beside", "beside = \"nurse\""),
        ("overtake", "overtake = \"nurse\""),
        ("lead_m", "lead_m = 4.0"),
    ];
    /// The deeds, for messages.
    pub const ALLOWED: &str = "one of say = \"WAIT\", hold_s = 3.0, hold_until = { human_says = \"PROCEED\" }, wait_for_leavers = true, follow = \"nurse\", beside = \"nurse\", overtake = \"nurse\", lead_m = 4.0";

    pub(crate) const fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        match self {
            Self::HoldS(s) => Some((*s, [0.1, 60.0], "s")),
            Self::LeadM(m) => Some((*m, [1.0, 15.0], "m")),
            Self::HoldUntil(moment) => moment.number(),
            Self::Say(_) | Self::WaitForLeavers(_) | Self::Follow(_) | Self::Beside(_) | Self::Overtake(_) => None,
        }
    }

    pub(crate) const fn names(&self) -> Option<&String> {
        match self {
            Self::Follow(id) | Self::Beside(id) | Self::Overtake(id) => Some(id),
            Self::HoldUntil(moment) => moment.names(),
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
            rules: self.rules(HumanId::new(number), human),
            group: group(human),
        };
        self.numbered()
            .flat_map(|(first, human)| (first..first + human.count).map(move |number| (number, human)))
            .map(|(number, human)| person(number, human))
            .collect()
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
        let when = |moment: &RobotMoment| moment.of_person(|name| self.one(name));
        let act = |deed: &RobotDeed| {
            Some(match deed {
                RobotDeed::Say(gesture) => RobotDo::Say(*gesture),
                RobotDeed::HoldS(s) => RobotDo::Hold(*s),
                RobotDeed::HoldUntil(moment) => RobotDo::HoldUntil(when(moment)?),
                RobotDeed::WaitForLeavers(_) => RobotDo::WaitForLeavers,
                RobotDeed::Follow(name) => RobotDo::Follow(self.one(name)?),
                RobotDeed::Beside(name) => RobotDo::Abreast(self.one(name)?),
                RobotDeed::Overtake(name) => RobotDo::Overtake(self.one(name)?),
                RobotDeed::LeadM(m) => RobotDo::Lead(*m),
            })
        };
        // Without a moment of its own, or with that of a stand before it, a line follows the one before it.
        let line = |(place, step): (usize, &RobotStep)| {
            let before = place.checked_sub(1).and_then(|before| steps.get(before));
            let own = |before: &RobotStep| before.when == step.when && before.act.stands();
            let when = if before.is_some_and(|before| step.when.is_none() || own(before)) {
                RobotWhen::AfterLine(u32::try_from(place).ok()?)
            } else {
                step.when.as_ref().map_or(Some(RobotWhen::Start), when)?
            };
            Some(RobotRule { when, act: act(&step.act)? })
        };
        steps.iter().enumerate().filter_map(line).collect()
    }
}
