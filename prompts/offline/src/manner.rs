//! How an act is played of which a text says no more: what it is, when it begins, and how long it lasts.

use socrates_model::{Action, Gesture, HumanId, Relation, Rule, Trigger};
use socrates_reader::Act;

/// An act with the moment and the duration that are taken where the text gives none.
pub(crate) struct Manner {
    pub(crate) act: Action,
    pub(crate) when: Trigger,
    /// How long it lasts, s; for good where that is none.
    pub(crate) for_s: Option<f64>,
}

/// How long somebody who is startled stares, s.
pub(crate) const STARTLED_S: f64 = 8.0;
/// How long somebody follows who walks on then, s.
pub(crate) const FOLLOWS_S: f64 = 8.0;
/// How long somebody stands before they look, who stops and looks, s.
pub(crate) const HALT_S: f64 = 2.0;
/// From where on somebody walks on of whom no moment is said, m.
pub(crate) const WALKS_ON_M: f64 = 5.0;

/// The manner of an act; none for walking on and for a sign, which have no moment of their own.
pub(crate) fn of(act: Act) -> Option<Manner> {
    let (act, visible_m, for_s) = match act {
        Act::RunAway => (Action::RunAway, 3.0, Some(6.0)),
        Act::GiveWay => (Action::GiveWay, 3.5, Some(6.0)),
        // The blockade ends by itself, so that the robot can get on.
        Act::Block => (Action::Block, 4.0, Some(8.0)),
        Act::Look => (Action::LookAtRobot, 4.0, Some(5.0)),
        Act::Startle => (Action::LookAtRobot, 4.0, Some(STARTLED_S)),
        Act::Approach => (Action::Approach, 5.0, Some(8.0)),
        Act::Follow => (Action::FollowRobot, 8.0, None),
        Act::StandStill => (Action::StandStill, 3.0, Some(5.0)),
        Act::TurnBack => (Action::TurnBack, 4.0, None),
        Act::Navigate | Act::Sign => return None,
    };
    Some(Manner { act, when: Trigger::RobotVisible(visible_m), for_s })
}

/// What somebody does who makes a sign, from how far they make it (m), and for how long (s).
pub(crate) const fn sign(gesture: Gesture) -> (Action, f64, f64) {
    match gesture {
        // Whoever lets the robot go first stands still for it; whoever stops it walks on.
        Gesture::Proceed => (Action::StandStill, 5.0, 6.0),
        Gesture::Wait | Gesture::ExcuseMe | Gesture::FollowMe => (Action::Navigate, 5.0, 4.0),
        // Whoever acknowledges the robot looks at it.
        Gesture::Acknowledged => (Action::LookAtRobot, 5.0, 4.0),
    }
}

/// The actions by which an act is played: those that somebody no longer does of whom it is denied.
pub(crate) fn actions(act: Act) -> Vec<Action> {
    let also = (act == Act::Follow).then_some(Action::FollowHuman(HumanId::new(1)));
    of(act).map(|manner| manner.act).into_iter().chain(also).collect()
}

/// Words of an act, for the reading line.
pub(crate) fn words(act: Act, whom: Option<HumanId>, sign: Option<Gesture>) -> String {
    match (act, whom) {
        (Act::RunAway, _) => "runs away".to_owned(),
        (Act::GiveWay, _) => "gives way".to_owned(),
        (Act::Block, _) => "blocks the robot".to_owned(),
        (Act::Look, _) => "looks at the robot".to_owned(),
        (Act::Startle, _) => "startled".to_owned(),
        (Act::Approach, _) => "comes up to the robot".to_owned(),
        (Act::Follow, Some(whom)) => format!("follows {whom}"),
        (Act::Follow, None) => "follows the robot".to_owned(),
        (Act::StandStill, _) => "stops".to_owned(),
        (Act::TurnBack, _) => "turns back".to_owned(),
        (Act::Navigate, _) => "walks on".to_owned(),
        (Act::Sign, _) => sign.map_or_else(String::new, |sign| format!("gestures {sign}")),
    }
}

/// Fastest pace of somebody whom a robot of 0.8 m/s catches up with, and slowest of somebody who overtakes it, m/s.
pub(crate) const AHEAD_MPS: f64 = 0.75;
pub(crate) const OVERTAKES_MPS: f64 = 1.2;

/// Whether somebody who stands to the robot's way like this, and does this, overtakes it.
pub(crate) fn overtakes(relation: Relation, rules: &[Rule]) -> bool {
    relation == Relation::Behind && !rules.iter().any(|rule| rule.act == Action::FollowRobot)
}
