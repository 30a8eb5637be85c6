//! Of whom a predicate tells.

use super::Predicate;
use crate::ids::{AgentId, GroupId, HumanId};
use crate::rule::Action;

impl Predicate {
    /// The human the clause is about, if it is about one.
    #[must_use]
    pub const fn human(&self) -> Option<HumanId> {
        match self {
            Self::Meets { human, .. }
            | Self::MeetsAgain { human, .. }
            | Self::HeadOn { human }
            | Self::Crosses { human, .. }
            | Self::OnSide { human, .. }
            | Self::Faces { human, .. }
            | Self::Ahead { human, .. }
            | Self::Overtakes { human }
            | Self::RobotPasses { human }
            | Self::Abreast { human, .. }
            | Self::Parallel { human, .. }
            | Self::Blocks { human, .. }
            | Self::Looks { human, .. }
            | Self::StandsStill { human, .. }
            | Self::RunsAway { human, .. }
            | Self::GivesWay { human }
            | Self::Reacts { human, .. }
            | Self::Step { human, .. }
            | Self::GesturesTo { human, .. }
            | Self::TurnsBack { human }
            | Self::GoesTo { human, .. }
            | Self::ChangesPace { human, .. }
            | Self::StaysAside { human }
            | Self::MakesRoom { human }
            | Self::Walks { human, .. }
            | Self::GetsTo { human, .. }
            | Self::Leaves { human, .. }
            | Self::StaysInside { human, .. }
            | Self::Enters { human, .. }
            | Self::OnTime { human, .. }
            | Self::HiddenUntil { human, .. } => Some(*human),
            Self::Follows { follower: AgentId::Human(human), .. }
            | Self::Gestures { agent: AgentId::Human(human), .. }
            | Self::StartsAt { agent: AgentId::Human(human), .. }
            | Self::Reaches { agent: AgentId::Human(human), .. } => Some(*human),
            Self::Follows { leader: AgentId::Human(human), .. } => Some(*human),
            Self::EncounterAt { human, .. } => *human,
            Self::Humans { .. }
            | Self::Flow { .. }
            | Self::Density { .. }
            | Self::Surrounds { .. }
            | Self::Converges { .. }
            | Self::Follows { .. }
            | Self::Gestures { .. }
            | Self::DoorOpens { .. }
            | Self::Formation { .. }
            | Self::WalksTogether { .. }
            | Self::Queues { .. }
            | Self::Order { .. }
            | Self::Before { .. }
            | Self::Reaches { .. }
            | Self::StartsAt { .. }
            | Self::RobotWay { .. }
            | Self::RobotStep { .. }
            | Self::Plausible
            | Self::RobotArrives
            | Self::RobotKeeps { .. }
            | Self::RobotEntersLast
            | Self::RobotLeavesFirst
            | Self::RobotJoins { .. }
            | Self::RobotLeavesGroup { .. }
            | Self::RobotObeys { .. } => None,
        }
    }

    /// The group the clause is about, if it is about one.
    #[must_use]
    pub const fn group(&self) -> Option<GroupId> {
        match self {
            Self::Formation { group, .. }
            | Self::WalksTogether { group, .. }
            | Self::Queues { group, .. }
            | Self::RobotJoins { group }
            | Self::RobotLeavesGroup { group } => Some(*group),
            Self::Humans { .. }
            | Self::Meets { .. }
            | Self::MeetsAgain { .. }
            | Self::HeadOn { .. }
            | Self::Crosses { .. }
            | Self::OnSide { .. }
            | Self::Faces { .. }
            | Self::Ahead { .. }
            | Self::Overtakes { .. }
            | Self::RobotPasses { .. }
            | Self::Follows { .. }
            | Self::Abreast { .. }
            | Self::Parallel { .. }
            | Self::Flow { .. }
            | Self::Density { .. }
            | Self::Surrounds { .. }
            | Self::Converges { .. }
            | Self::Blocks { .. }
            | Self::Looks { .. }
            | Self::StandsStill { .. }
            | Self::RunsAway { .. }
            | Self::GivesWay { .. }
            | Self::Reacts { .. }
            | Self::Step { .. }
            | Self::GesturesTo { .. }
            | Self::TurnsBack { .. }
            | Self::GoesTo { .. }
            | Self::ChangesPace { .. }
            | Self::StaysAside { .. }
            | Self::MakesRoom { .. }
            | Self::Walks { .. }
            | Self::GetsTo { .. }
            | Self::Gestures { .. }
            | Self::Leaves { .. }
            | Self::StaysInside { .. }
            | Self::Enters { .. }
            | Self::DoorOpens { .. }
            | Self::HiddenUntil { .. }
            | Self::Order { .. }
            | Self::Before { .. }
            | Self::EncounterAt { .. }
            | Self::Reaches { .. }
            | Self::StartsAt { .. }
            | Self::RobotWay { .. }
            | Self::RobotStep { .. }
            | Self::OnTime { .. }
            | Self::Plausible
            | Self::RobotArrives
            | Self::RobotKeeps { .. }
            | Self::RobotEntersLast
            | Self::RobotLeavesFirst
            | Self::RobotObeys { .. } => None,
        }
    }

    /// Whether it judges what the robot makes of the scenario, and so can only be an outcome.
    #[must_use]
    pub const fn judges_robot(&self) -> bool {
        matches!(
            self,
            Self::RobotArrives
                | Self::RobotKeeps { .. }
                | Self::RobotEntersLast
                | Self::RobotLeavesFirst
                | Self::RobotJoins { .. }
                | Self::RobotLeavesGroup { .. }
                | Self::RobotObeys { .. }
        )
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
