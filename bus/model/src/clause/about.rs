//! Of whom a predicate tells.

use super::{Predicate, Shows};
use crate::act::Action;
use crate::ids::{AgentId, GroupId, HumanId};

/// A subject of a predicate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OfWhom {
    /// Everybody, or the robot.
    Other,
    /// A person.
    Human(HumanId),
    /// A group.
    Group(GroupId),
}

impl From<HumanId> for OfWhom {
    fn from(human: HumanId) -> Self {
        Self::Human(human)
    }
}

impl From<Option<HumanId>> for OfWhom {
    fn from(human: Option<HumanId>) -> Self {
        human.map_or(Self::Other, Self::Human)
    }
}

impl From<AgentId> for OfWhom {
    fn from(agent: AgentId) -> Self {
        if let AgentId::Human(human) = agent { Self::Human(human) } else { Self::Other }
    }
}

impl From<GroupId> for OfWhom {
    fn from(group: GroupId) -> Self {
        Self::Group(group)
    }
}

impl Predicate {
    /// The human the clause is about, if it is about one; of somebody who follows another, the follower.
    #[must_use]
    pub fn human(&self) -> Option<HumanId> {
        let human = |subject| if let OfWhom::Human(human) = subject { Some(human) } else { None };
        self.subjects().into_iter().find_map(human)
    }

    /// The group the clause is about, if it is about one.
    #[must_use]
    pub fn group(&self) -> Option<GroupId> {
        let group = |subject| if let OfWhom::Group(group) = subject { Some(group) } else { None };
        self.subjects().into_iter().find_map(group)
    }

    /// Whether it judges what the robot makes of the scenario, and so can only be an outcome.
    #[must_use]
    pub fn judges_robot(&self) -> bool {
        self.shows() == Shows::Result
    }

    /// Whether somebody who does this has what the clause tests; only of tests that are of one kind of action.
    #[must_use]
    pub const fn is_deed(&self, act: &Action) -> bool {
        matches!(
            (self, act),
            (Self::Blocks { .. }, Action::Block)
                | (Self::Looks { .. }, Action::LookAtRobot | Action::LookAt(_))
                | (Self::RunsAway { .. }, Action::RunAway)
                | (Self::GivesWay { .. }, Action::GiveWay)
                | (Self::MakesRoom { .. }, Action::MakeRoom)
                | (Self::Follows { .. }, Action::FollowRobot | Action::FollowHuman(_))
        )
    }

    /// Whether the clause tells of every human when there are `humans` of them: it names nobody, and none of them
    /// can be missing from what it counts.
    #[must_use]
    pub const fn takes_in_all(&self, humans: u32) -> bool {
        if let Self::Flow { count, .. } | Self::Surrounds { count, .. } = self {
            *count >= humans
        } else {
            matches!(self, Self::Converges { .. })
        }
    }
}
