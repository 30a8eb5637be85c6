//! What a leaf of a behavior tree does, by its name: one table for the judge, the story and the page.
//!
//! Recordings hold the names that trees gave their leaves, in whatever dialect they were written; here they are read.

use crate::Action;

impl Action {
    /// Whether a leaf of this name does the action.
    ///
    /// Names are compared by their letters alone, so that the dialects of trees (`RunAwayFromRobot`, `run_away`) mean the same.
    /// A leaf whose name begins with `is` asks and does nothing. Whom a leaf follows is not in its name.
    #[must_use]
    pub fn is_leaf(&self, name: &str) -> bool {
        let letters: String = name.chars().filter(char::is_ascii_alphabetic).map(|c| c.to_ascii_lowercase()).collect();
        !letters.starts_with("is") && self.leaf_words().iter().any(|word| letters.contains(word))
    }

    /// Letters of which the name of a leaf holds at least one, where it does the action.
    const fn leaf_words(&self) -> &'static [&'static str] {
        match self {
            Self::Navigate => &["regularnav", "navigate", "gotogoal", "updategoal"],
            Self::FollowRobot => &["followrobot", "followingrobot"],
            Self::FollowHuman(_) => &["followhuman", "followagent"],
            Self::RunAway => &["runaway", "scared", "flee"],
            Self::GiveWay => &["giveway"],
            Self::Block => &["blockrobot", "block"],
            Self::LookAtRobot => &["lookatrobot", "lookat", "surprised"],
            Self::Approach => &["approach", "curious"],
            Self::StandStill => &["standstill", "stand", "stop", "wait"],
            Self::LookAt(_) => &["watchhuman"],
            Self::TurnBack => &["turnback"],
            Self::GoTo { .. } => &["gotoplace"],
            Self::ChangePace(_) => &["changepace"],
            Self::MakeRoom => &["makeroom"],
            Self::ApproachTo(_) => &["comeclose"],
        }
    }

    /// The action of a leaf with a published tag, spelled exactly so; `None` for other tags and where the tag does not say whom.
    #[must_use]
    pub fn of_tag(tag: &str) -> Option<Self> {
        Some(match tag {
            "RegularNav" => Self::Navigate,
            "FollowRobot" => Self::FollowRobot,
            "RunAwayFromRobot" => Self::RunAway,
            "GiveWaytoRobot" => Self::GiveWay,
            "BlockRobot" => Self::Block,
            "LookAtRobot" => Self::LookAtRobot,
            "ApproachRobot" => Self::Approach,
            "StandStill" => Self::StandStill,
            "TurnBack" => Self::TurnBack,
            "MakeRoom" => Self::MakeRoom,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaf_names_of_several_dialects_mean_the_same_action() {
        assert!(Action::RunAway.is_leaf("RunAwayFromRobot"));
        assert!(Action::RunAway.is_leaf("run_away"));
        assert!(Action::GiveWay.is_leaf("GiveWaytoRobot"));
        assert!(!Action::Block.is_leaf("IsRobotBlocking"));
        assert!(!Action::Navigate.is_leaf("FollowRobot"));
    }

    #[test]
    fn a_published_tag_is_a_leaf_of_its_action() {
        for tag in ["RegularNav", "FollowRobot", "RunAwayFromRobot", "GiveWaytoRobot", "BlockRobot", "LookAtRobot"] {
            assert!(Action::of_tag(tag).is_some_and(|action| action.is_leaf(tag)), "{tag}");
        }
        assert_eq!(Action::of_tag("FollowHuman"), None);
    }
}
