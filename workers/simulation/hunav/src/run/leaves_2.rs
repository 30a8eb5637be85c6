//! The nodes that HuNavSim 2.0 adds. Their times are simulated ones; upstream's are the wall clock's.

use rand_core::Rng as _;
use socrates_bt::{LeafCall, Library, Status};
use socrates_model::seeds;

use super::mind::{Mind, faces, int, place, real};
use super::scene::{Deed, Target};
use crate::agents::GoalEntry;

/// Bearing error within which the robot faces somebody, rad.
const FACING_RAD: f64 = 0.3;
/// A text is heard for so long after it was said, s.
const HEARD_S: f64 = 1.0;
/// Distance to the place of `GoTo` at which it is reached, m: a goal radius of 0.1 and the 0.1 of every goal.
const GO_TO_M: f64 = 0.2;

/// Ticks a node of HuNavSim 2.0; `None` for a leaf of another library.
pub(crate) fn tick(mind: &mut Mind<'_>, call: &mut LeafCall<'_>) -> Option<Status> {
    if call.sheet().library != Library::HunavSim2 {
        return None;
    }
    condition(mind, call).or_else(|| quiet(mind, call)).or_else(|| lasting(mind, call))
}

/// The agent that a port names.
fn agent(mind: &Mind<'_>, call: &LeafCall<'_>, port: &str) -> Option<usize> {
    int(call, port).and_then(|id| mind.scene.index_of(id))
}

/// The global goal that a port names.
fn goal(mind: &Mind<'_>, call: &LeafCall<'_>) -> Option<GoalEntry> {
    let number = int(call, "goal_id")?;
    let at = mind.scene.goals.get(usize::try_from(number).ok()?.checked_sub(1)?)?;
    Some(GoalEntry { name: number.to_string(), at: *at, heading: 0.0 })
}

fn condition(mind: &mut Mind<'_>, call: &LeafCall<'_>) -> Option<Status> {
    let me = Target::Agent(mind.me);
    let holds = match call.tag() {
        "IsRobotClose" => {
            let within = real(call, "threshold").unwrap_or(1.0);
            mind.scene.distance_m(mind.me, Target::Robot).is_some_and(|m| m <= within)
        }
        "RandomChanceCondition" => {
            let chance = real(call, "probability").unwrap_or(0.3);
            mind.scene.agents.get_mut(mind.me).is_some_and(|agent| seeds::unit(agent.random.next_u64()) < chance)
        }
        "IsRobotFacingAgent" => faces(mind.scene, Target::Robot, me, FACING_RAD),
        "IsAgentVisible" => {
            let half = real(call, "field_of_view").unwrap_or(mind.scene.rules.half_view_rad);
            let within = real(call, "distance").unwrap_or(5.0);
            let seen = agent(mind, call, "agent_id").map(Target::Agent);
            let observer = agent(mind, call, "observer_id");
            observer.zip(seen).is_some_and(|(observer, seen)| mind.scene.sees(observer, seen, within, half).is_some())
        }
        "IsAgentClose" => {
            let within = real(call, "threshold").unwrap_or(1.0);
            let target = agent(mind, call, "target_agent_id").map(Target::Agent);
            agent(mind, call, "observer_id")
                .zip(target)
                .and_then(|(observer, target)| mind.scene.distance_m(observer, target))
                .is_some_and(|m| m <= within)
        }
        "IsAtPosition" => {
            let spot = goal(mind, call)
                .map(|goal| goal.at)
                .or_else(|| Some(socrates_model::Point::new(real(call, "target_x")?, real(call, "target_y")?)));
            let within = real(call, "tolerance").unwrap_or(0.1);
            spot.and_then(|spot| mind.scene.distance_m(mind.me, Target::Spot(spot))).is_some_and(|m| m <= within)
        }
        _ => return None,
    };
    Some(Status::of(holds))
}

/// Actions that change something and are done at once.
fn quiet(mind: &mut Mind<'_>, call: &mut LeafCall<'_>) -> Option<Status> {
    match call.tag() {
        "FindNearestAgent" => {
            let others = (0..mind.scene.agents.len()).filter(|other| *other != mind.me);
            let near = others.filter_map(|other| Some((mind.scene.distance_m(mind.me, Target::Agent(other))?, other)));
            let Some((_, found)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) else { return Some(Status::Failure) };
            let id = mind.scene.agents.get(found).and_then(|agent| u32::try_from(agent.id).ok());
            if let (Some(port), Some(id)) = (place(call, "target_agent_id"), id) {
                call.set(port, id);
            }
        }
        "SetGoal" => {
            let Some(goal) = goal(mind, call) else { return Some(Status::Failure) };
            if let Some(agent) = mind.scene.agents.get_mut(mind.me) {
                agent.goals.push_front(goal);
                agent.errand.way = None;
            }
        }
        "SaySomething" => {
            let now_s = mind.scene.now_s;
            if let Some(agent) = mind.scene.agents.get_mut(mind.me) {
                agent.said_s = Some(now_s);
            }
        }
        "SetGroupId" => {
            let group = int(call, "group_id").and_then(|group| u32::try_from(group).ok());
            if let Some(agent) = mind.scene.agents.get_mut(mind.me) {
                agent.group = group;
            }
        }
        "StopMovement" | "ResumeMovement" => {
            let stopped = call.tag() == "StopMovement";
            if let Some(agent) = mind.scene.agents.get_mut(mind.me) {
                agent.stopped = stopped;
            }
        }
        _ => return None,
    }
    Some(Status::Success)
}

/// Nodes that run over many ticks.
fn lasting(mind: &mut Mind<'_>, call: &mut LeafCall<'_>) -> Option<Status> {
    let tag = call.tag();
    let me = Target::Agent(mind.me);
    let target = || -> Target { Target::Robot };
    let over = |mind: &mut Mind<'_>, call: &LeafCall<'_>, spare: f64| {
        let limit = real(call, "duration").unwrap_or(spare);
        mind.elapsed_s(call) >= limit
    };
    Some(match tag {
        "StopAndWaitTimerAction" => {
            let limit = real(call, "wait_duration").unwrap_or(0.0);
            if mind.elapsed_s(call) >= limit {
                Status::Success
            } else {
                mind.act(tag, Deed::Stand);
                Status::Running
            }
        }
        "GoTo" => {
            let Some(goal) = goal(mind, call) else { return Some(Status::Failure) };
            if mind.scene.distance_m(mind.me, Target::Spot(goal.at)).is_some_and(|m| m <= GO_TO_M) {
                return Some(Status::Success);
            }
            mind.act(tag, Deed::GoTo(goal.at));
            Status::Running
        }
        "ApproachAgent" | "ApproachRobot" => {
            let robot = tag == "ApproachRobot";
            let (stop_spare, vel_spare) = if robot { (1.5, 1.8) } else { (0.5, 1.0) };
            let found = if robot { Some(target()) } else { agent(mind, call, "target_agent_id").map(Target::Agent) };
            let Some(found) = found.filter(|found| mind.scene.place(*found).is_some()) else {
                return Some(Status::Failure);
            };
            if over(mind, call, 5.0) {
                return Some(Status::Success);
            }
            let stop_m = real(call, "closest_dist").unwrap_or(stop_spare);
            let speed_mps = real(call, "max_vel").unwrap_or(vel_spare);
            mind.act(tag, Deed::Approach { target: found, stop_m, speed_mps });
            Status::Running
        }
        "FollowAgent" => {
            let Some(leader) = agent(mind, call, "target_agent_id") else { return Some(Status::Failure) };
            let limit = real(call, "duration").unwrap_or(0.0);
            if mind.elapsed_s(call) >= limit && limit > 0.0 {
                return Some(Status::Success);
            }
            let gap_m = real(call, "closest_dist").unwrap_or(1.5);
            let speed_mps = real(call, "max_vel").unwrap_or(1.5);
            mind.act(tag, Deed::Follow { target: Target::Agent(leader), gap_m, speed_mps });
            Status::Running
        }
        "BlockRobot" | "BlockAgent" => {
            let found = if tag == "BlockRobot" {
                Some(Target::Robot)
            } else {
                agent(mind, call, "target_agent_id").map(Target::Agent)
            };
            let Some(found) = found.filter(|found| mind.scene.place(*found).is_some()) else {
                return Some(Status::Failure);
            };
            if over(mind, call, 5.0) {
                return Some(Status::Success);
            }
            mind.act(tag, Deed::Block { target: found, ahead_m: real(call, "front_dist").unwrap_or(1.0) });
            Status::Running
        }
        "LookAtAgent" | "LookAtRobot" | "LookAtPoint" => {
            let found = match tag {
                "LookAtRobot" => Some(Target::Robot),
                "LookAtAgent" => agent(mind, call, "target_id").map(Target::Agent),
                _ => goal(mind, call).map(|goal| Target::Spot(goal.at)),
            };
            let Some(found) = found.filter(|found| mind.scene.place(*found).is_some()) else {
                return Some(Status::Failure);
            };
            let within = real(call, "yaw_tolerance").unwrap_or(0.01);
            if faces(mind.scene, me, found, within) {
                return Some(Status::Success);
            }
            mind.act(tag, Deed::Look(found));
            Status::Running
        }
        _ => return noticing(mind, call),
    })
}

/// Nodes that wait until somebody speaks or looks.
fn noticing(mind: &mut Mind<'_>, call: &mut LeafCall<'_>) -> Option<Status> {
    let tag = call.tag();
    let me = Target::Agent(mind.me);
    Some(match tag {
        "IsSpeaking" | "IsAnyoneSpeaking" => {
            let within = real(call, "distance_threshold").unwrap_or(5.0);
            let only = if tag == "IsSpeaking" { agent(mind, call, "target_id") } else { None };
            let speaker = listen(mind, within, |other| tag == "IsAnyoneSpeaking" || only == Some(other));
            report(mind, call, "speaker_id", speaker, if tag == "IsSpeaking" { 10.0 } else { 5.0 })
        }
        "IsLookingAtMe" | "IsAnyoneLookingAtMe" => {
            let anyone = tag == "IsAnyoneLookingAtMe";
            let within = real(call, "distance_threshold").unwrap_or(5.0);
            let angle = real(call, "angle_threshold").unwrap_or(0.3);
            let only = if anyone { None } else { agent(mind, call, "target_id") };
            let observer = (0..mind.scene.agents.len()).find(|other| {
                *other != mind.me
                    && (anyone || only == Some(*other))
                    && mind.scene.distance_m(mind.me, Target::Agent(*other)).is_some_and(|m| m <= within)
                    && faces(mind.scene, Target::Agent(*other), me, angle)
            });
            let status = report(mind, call, "observer_id", observer, 5.0);
            if anyone && status == Status::Running {
                // It walks on meanwhile.
                mind.act(tag, Deed::Walk);
            }
            status
        }
        _ => return None,
    })
}

/// Somebody within a distance who spoke just now.
fn listen(mind: &Mind<'_>, within_m: f64, who: impl Fn(usize) -> bool) -> Option<usize> {
    let now_s = mind.scene.now_s;
    (0..mind.scene.agents.len()).find(|other| {
        *other != mind.me
            && who(*other)
            && mind.scene.agents.get(*other).and_then(|agent| agent.said_s).is_some_and(|said| now_s - said <= HEARD_S)
            && mind.scene.distance_m(mind.me, Target::Agent(*other)).is_some_and(|m| m <= within_m)
    })
}

/// The outcome of waiting for somebody: success with its id, running, or failure when the time is over.
fn report(mind: &mut Mind<'_>, call: &mut LeafCall<'_>, port: &str, found: Option<usize>, spare_s: f64) -> Status {
    let elapsed_s = mind.elapsed_s(call);
    if let Some(found) = found {
        let id = mind.scene.agents.get(found).and_then(|agent| u32::try_from(agent.id).ok());
        if let (Some(port), Some(id)) = (place(call, port), id) {
            call.set(port, id);
        }
        return Status::Success;
    }
    if elapsed_s >= real(call, "duration").unwrap_or(spare_s) { Status::Failure } else { Status::Running }
}
