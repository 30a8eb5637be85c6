//! Motions of HuNavSim 1.x, of the SocRATES fork and of our own, as deeds.

use socrates_bt::LeafCall;

use super::mind::{int, real};
use super::scene::{Deed, Scene, Target};

/// Names of everything that moves somebody, by the number that frames carry; 0 is none.
pub(crate) const MOTIONS: [&str; 27] = [
    "",
    "RegularNav",
    "SurprisedNav",
    "CuriousNav",
    "ScaredNav",
    "ThreateningNav",
    "LookAtRobot",
    "FollowRobot",
    "FollowHuman",
    "RunAwayFromRobot",
    "GiveWaytoRobot",
    "BlockRobot",
    "ApproachRobot",
    "StandStill",
    "StopAndWaitTimerAction",
    "GoTo",
    "ApproachAgent",
    "BlockAgent",
    "FollowAgent",
    "LookAtAgent",
    "LookAtPoint",
    "IsAnyoneLookingAtMe",
    "SetGroupWalk",
    "ConversationFormation",
    "track",
    socrates_model::recording::ABSENT_LEAF,
    "StopMovement",
];

/// Number of the entry for somebody who replays a track.
pub(crate) const TRACK_LEAF: u16 = 24;
/// Number of the entry for somebody who is not on the floor.
pub(crate) const ABSENT_LEAF: u16 = 25;

/// Where somebody curious stops in 1.0 and the fork, m.
const CURIOUS_STOP_M: f64 = 1.5;
/// Speed of the approach in 1.0 and the fork, m/s.
const CURIOUS_MPS: f64 = 1.8;
/// Speed of somebody scared in 1.0 and the fork, m/s.
const SCARED_MPS: f64 = 0.6;
/// Factor of the extra force on somebody scared in 1.0 and the fork.
const SCARED_FACTOR: f64 = 20.0;
/// Speed of our own who run away, m/s.
const RUN_MPS: f64 = 1.6;

/// The deed of a motion leaf that succeeds in the tick it is done in; `None` for every other leaf.
pub(crate) fn motion(scene: &Scene, me: usize, call: &LeafCall<'_>) -> Option<Deed> {
    let native = scene.rules.native;
    let robot = Target::Robot;
    Some(match call.tag() {
        "RegularNav" => Deed::Walk,
        "StandStill" => Deed::Stand,
        "SurprisedNav" | "LookAtRobot" => Deed::Look(robot),
        "CuriousNav" => Deed::Approach {
            target: robot,
            stop_m: real(call, "stop_distance").unwrap_or(CURIOUS_STOP_M),
            speed_mps: real(call, "agent_vel").unwrap_or(CURIOUS_MPS),
        },
        "ApproachRobot" if native => Deed::Approach { target: robot, stop_m: 1.2, speed_mps: CURIOUS_MPS },
        "FollowRobot" => follow(native, robot),
        "FollowHuman" => {
            let target = int(call, "target_id")?;
            let index = usize::try_from(target - scene.rules.first_human).ok()?;
            follow(native, Target::Agent(index))
        }
        "ScaredNav" => Deed::Flee {
            speed_mps: real(call, "runaway_vel").unwrap_or(SCARED_MPS),
            factor: real(call, "scary_force_factor").unwrap_or(SCARED_FACTOR),
        },
        "RunAwayFromRobot" => {
            Deed::Flee { speed_mps: if native { RUN_MPS } else { SCARED_MPS }, factor: SCARED_FACTOR }
        }
        "GiveWaytoRobot" => Deed::GiveWay,
        "ThreateningNav" | "BlockRobot" => Deed::Block {
            target: robot,
            ahead_m: real(call, "goal_dist").unwrap_or_else(|| {
                let own = scene.agents.get(me).map_or(0.0, |agent| agent.parameters.dist_m);
                if native && own > 0.0 { own } else { scene.rules.threat.ahead_m }
            }),
        },
        _ => return None,
    })
}

/// The fork follows by going up; we keep a gap.
fn follow(native: bool, target: Target) -> Deed {
    if native {
        Deed::Follow { target, gap_m: CURIOUS_STOP_M, speed_mps: CURIOUS_MPS }
    } else {
        Deed::Approach { target, stop_m: CURIOUS_STOP_M, speed_mps: CURIOUS_MPS }
    }
}
