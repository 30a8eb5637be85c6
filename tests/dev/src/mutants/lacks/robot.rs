//! What takes a line of the robot's script away: signs at another time, stands at another place or cut short.

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Action, AgentId, AgentState, Gesture, HumanId, Predicate, Proposal, Recording};
use socrates_scoring::MOVING_MPS;

use super::Edit;
use super::edits::Scene;
use crate::mutants::edit::{Stood, gestures_from, reacts_first, states, straight_on, ticks_of, time_of};

/// A sign comes so much sooner and later than its reason, s.
const SOONER_SECS: f64 = 4.0;
const LATER_SECS: f64 = 10.0;
/// After a sign that comes too late so much is left of the run, s.
const LEFT_SECS: f64 = 3.0;
/// A shorter stand is no test, s; one that is cut short ends after this share of it.
const STAND_SECS: f64 = 2.0;
const CUT: f64 = 0.25;

/// The line that a clause tells of.
pub(super) fn line<'s>(scene: &Scene<'s>) -> Option<&'s RobotRule> {
    if let Predicate::RobotStep { rule, .. } = scene.predicate { Some(rule) } else { None }
}

/// The sign that the line makes.
pub(super) fn sign(scene: &Scene<'_>) -> Option<Gesture> {
    if let RobotDo::Say(gesture) = line(scene)?.act { Some(gesture) } else { None }
}

fn followers(proposal: &Proposal) -> impl Iterator<Item = HumanId> {
    let follows = |rules: &[socrates_model::Rule]| rules.iter().any(|rule| rule.act == Action::FollowRobot);
    proposal.humans.iter().filter(move |human| follows(&human.rules)).map(|human| human.id)
}

/// The human with whom the robot goes by the line.
pub(super) fn companion(scene: &Scene<'_>) -> Option<AgentId> {
    match &line(scene)?.act {
        RobotDo::Follow(human) | RobotDo::Abreast(human) | RobotDo::Overtake(human) => Some((*human).into()),
        RobotDo::Lead(_) => followers(scene.evidence.proposal?).next().map(AgentId::Human),
        RobotDo::Say(_) | RobotDo::Hold(_) | RobotDo::HoldUntil(_) | RobotDo::WaitForLeavers => None,
    }
}

/// Whether an edit takes a line of the script away in the run at hand.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
pub(super) fn bites(scene: &Scene<'_>, rule: &RobotRule, edit: Edit) -> bool {
    // What is done at a time is done wherever the robot is.
    let anywhere = matches!(rule.when, RobotWhen::Start | RobotWhen::AfterSecs(_));
    let alone = matches!(rule.act, RobotDo::Say(_) | RobotDo::Hold(_) | RobotDo::HoldUntil(_));
    let long = || stand(scene).is_some_and(|stood| stood.leaf_s.1 - stood.leaf_s.0 >= STAND_SECS);
    match edit {
        Edit::FarAway => !(anywhere && alone),
        Edit::SignSooner => scene.from_s > SOONER_SECS + 0.5,
        Edit::SignLater => last_s(scene) + LATER_SECS + LEFT_SECS < scene.end_s(),
        Edit::StandsSooner => rule.when != RobotWhen::Start && scene.from_s > SOONER_SECS && long(),
        Edit::SetsOffSooner => long(),
        Edit::Swapped => {
            let one = scene.evidence.proposal.is_some_and(|proposal| followers(proposal).count() == 1);
            one || !matches!(rule.act, RobotDo::Lead(_))
        }
        Edit::LogWalks => alone && !matches!(rule.act, RobotDo::Say(_)),
        _ => true,
    }
}

fn last_s(scene: &Scene<'_>) -> f64 {
    scene.seen.times_s.iter().copied().fold(0.0, f64::max)
}

/// The stand that was seen.
fn stand(scene: &Scene<'_>) -> Option<Stood> {
    let run = scene.run();
    let all = states(run, AgentId::Robot);
    let from = ticks_of(run, *scene.seen.times_s.first()?);
    let moves = |state: &AgentState| state.speed() > MOVING_MPS;
    let to = all.iter().enumerate().skip(from + 1).find(|(_, state)| moves(state)).map(|(k, _)| k)?;
    let t = |k: usize| all.get(k).map_or(0.0, |state| time_of(run, state));
    Some(Stood { samples: (from, to), leaf_s: (t(from), t(to)) })
}

/// The run after an edit of the robot's line.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
pub(super) fn edited(scene: &Scene<'_>, edit: Edit) -> Option<Recording> {
    let (run, robot) = (scene.run(), AgentId::Robot);
    match edit {
        Edit::SignSooner => Some(gestures_from(run, robot, sign(scene)?, ticks_of(run, scene.from_s - SOONER_SECS))),
        Edit::SignLater => Some(gestures_from(run, robot, sign(scene)?, ticks_of(run, last_s(scene) + LATER_SECS))),
        Edit::StandsSooner => Some(reacts_first(run, robot, &stand(scene)?)),
        Edit::SetsOffSooner => {
            let (from, to) = stand(scene)?.leaf_s;
            Some(straight_on(run, robot, from + CUT * (to - from)))
        }
        _ => None,
    }
}
