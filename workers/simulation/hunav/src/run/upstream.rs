//! Motion as the HuNavSim family does it: at once, agent after agent, each seeing those before it moved already.

use socrates_crowd::Goal;
use socrates_model::geometry::wrap_angle;
use socrates_model::{Point, Vector};

use super::agent::Agent;
use super::scene::{Deed, Felt, Scene, Target, bearing};
use crate::profile::{Approach, RobotFelt};

/// Radius of the goal of somebody who blocks, m.
const BLOCK_RADIUS_M: f64 = 0.05;

/// Computes the force on everybody from the state at the start of the tick. It also ends reactions: whoever still
/// reacts says so again in this tick's tree.
pub(crate) fn feel(scene: &mut Scene) {
    for me in 0..scene.agents.len() {
        let Some(agent) = scene.agents.get(me) else { continue };
        let (felt, speed_mps) = (scene.felt(agent), agent.speed_mps());
        let force = scene.forces(me, scene.goal(me), speed_mps, felt).total();
        let resets = scene.rules.robot_felt == RobotFelt::UnlessReacting;
        if let Some(agent) = scene.agents.get_mut(me) {
            agent.force = force;
            agent.state_before = agent.state;
            if resets {
                agent.state = 0;
            }
        }
    }
}

/// Does a deed for one tick.
pub(crate) fn perform(scene: &mut Scene, me: usize, deed: Deed) {
    match deed {
        Deed::Walk => {
            let Some(agent) = scene.agents.get_mut(me) else { return };
            agent.state = 0;
            let (force, speed_mps) = (agent.force, agent.speed_mps());
            walk(scene, me, &force, speed_mps);
        }
        Deed::Stand => {
            if let Some(agent) = scene.agents.get_mut(me) {
                agent.velocity = Vector::zeros();
                agent.omega = 0.0;
            }
        }
        Deed::Look(target) => {
            state(scene, me, 1);
            turn(scene, me, target);
        }
        Deed::Approach { target, stop_m, speed_mps } | Deed::Follow { target, gap_m: stop_m, speed_mps } => {
            approach(scene, me, target, stop_m, speed_mps);
        }
        Deed::Flee { speed_mps, factor } => flee(scene, me, speed_mps, factor),
        Deed::GiveWay => {
            // Upstream sets a goal beside the robot and takes it back at once: this is plain walking.
            state(scene, me, 2);
            let Some(agent) = scene.agents.get(me) else { return };
            let speed_mps = agent.speed_mps();
            let force = scene.forces(me, scene.goal(me), speed_mps, Felt::Nothing).total();
            walk(scene, me, &force, speed_mps);
        }
        Deed::Block { target, ahead_m } => block(scene, me, target, ahead_m),
        Deed::GoTo(at) => {
            let Some(agent) = scene.agents.get(me) else { return };
            let speed_mps = agent.speed_mps();
            step_to(scene, me, Goal { at, radius_m: 0.1 }, speed_mps, None);
        }
    }
}

fn state(scene: &mut Scene, me: usize, state: u8) {
    if let Some(agent) = scene.agents.get_mut(me) {
        agent.state = state;
    }
}

/// Moves an agent under a force; goals within their radius are taken off the list.
fn walk(scene: &mut Scene, me: usize, force: &Vector, speed_mps: f64) {
    let dt = scene.dt;
    let Some(agent) = scene.agents.get_mut(me) else { return };
    integrate(agent, force, speed_mps, dt);
    let there = agent.goals.front().is_some_and(|goal| (goal.at - agent.at).norm() <= agent.goal_radius_m);
    if there {
        let keep = scene.rules.keeps_last_goal;
        scene.take_goal(me, keep);
    }
}

/// Velocity first, cut to the speed, then heading, then position. A force that is not finite (two bodies at exactly
/// touching distance, for somebody scared) leaves everything as it is.
fn integrate(agent: &mut Agent, force: &Vector, speed_mps: f64, dt: f64) {
    let mut velocity = agent.velocity + force * dt;
    let speed = velocity.norm();
    if speed > speed_mps {
        velocity = velocity / speed * speed_mps;
    }
    if !velocity.iter().all(|component| component.is_finite()) {
        return;
    }
    let yaw = libm::atan2(velocity.y, velocity.x);
    agent.omega = wrap_angle(yaw - agent.yaw) / dt;
    agent.yaw = yaw;
    agent.velocity = velocity;
    agent.at += velocity * dt;
}

/// One step with another goal and speed, forces computed anew; the list of goals stays.
fn step_to(scene: &mut Scene, me: usize, goal: Goal, speed_mps: f64, extra: Option<Vector>) {
    let Some(agent) = scene.agents.get(me) else { return };
    let felt = scene.felt(agent);
    let mut force = scene.forces(me, Some(goal), speed_mps, felt).total();
    if let Some(extra) = extra {
        force += extra.map(|component| if component.is_nan() { 0.0 } else { component });
    }
    let dt = scene.dt;
    if let Some(agent) = scene.agents.get_mut(me) {
        integrate(agent, &force, speed_mps, dt);
    }
}

/// Turns an agent on the spot towards a target.
///
/// For a target on the right the limit of the step is negative, so that every step counts as too long: the whole
/// limit is turned although less would do, and the heading goes past the target and comes back.
fn turn(scene: &mut Scene, me: usize, target: Target) {
    let Some(to) = scene.place(target) else { return };
    let (limit, overshoots, dt) = (scene.rules.turn_rad, scene.rules.turn_overshoots, scene.dt);
    let Some(agent) = scene.agents.get_mut(me) else { return };
    let error = bearing(&agent.at, agent.yaw, &to);
    let signed = if error < 0.0 { -limit } else { limit };
    let short = if overshoots { error.abs() <= signed } else { error.abs() <= limit };
    let turn = if short { error } else { signed };
    agent.yaw = wrap_angle(agent.yaw + turn);
    agent.omega = turn / dt;
    agent.velocity = Vector::zeros();
}

/// Faces a target at once.
fn face(scene: &mut Scene, me: usize, to: &Point) {
    let dt = scene.dt;
    let Some(agent) = scene.agents.get_mut(me) else { return };
    let turn = bearing(&agent.at, agent.yaw, to);
    agent.yaw = wrap_angle(agent.yaw + turn);
    agent.omega = turn / dt;
}

fn approach(scene: &mut Scene, me: usize, target: Target, stop_m: f64, speed_mps: f64) {
    state(scene, me, 1);
    let (Some(to), Some(distance)) = (scene.place(target), scene.distance_m(me, target)) else { return };
    if distance <= stop_m {
        face(scene, me, &to);
        if let Some(agent) = scene.agents.get_mut(me) {
            agent.velocity = Vector::zeros();
        }
        return;
    }
    let speed = match scene.rules.approach {
        Approach::Tenth(fixed) => fixed.unwrap_or(speed_mps) * distance / 10.0,
        Approach::Ratio => speed_mps * distance / (distance + stop_m),
    };
    let radius_m = scene.radius_m(target);
    step_to(scene, me, Goal { at: to, radius_m }, speed, None);
}

fn flee(scene: &mut Scene, me: usize, speed_mps: f64, factor: f64) {
    state(scene, me, 1);
    let Some(robot) = scene.place(Target::Robot) else { return };
    let Some(agent) = scene.agents.get(me) else { return };
    let away = agent.at - robot;
    let distance = away.norm();
    // Grows without bound at contact, and pulls inside it.
    let strength = factor * (agent.forces.obstacle_sigma_m / (distance - agent.radius_m));
    let extra = if distance > 0.0 { away / distance * strength } else { Vector::zeros() };
    let felt = scene.felt(agent);
    let mut force = scene.forces(me, scene.goal(me), speed_mps, felt).total();
    force += extra.map(|component| if component.is_nan() { 0.0 } else { component });
    walk(scene, me, &force, speed_mps);
}

fn block(scene: &mut Scene, me: usize, target: Target, ahead_m: f64) {
    state(scene, me, 1);
    let Some(to) = scene.place(target) else { return };
    let threat = scene.rules.threat;
    let yaw = scene.yaw(target);
    let (sin, cos) = libm::sincos(yaw);
    let ahead = if threat.swapped { Vector::new(sin, cos) } else { Vector::new(cos, sin) };
    let goal = Goal { at: to + ahead * ahead_m, radius_m: BLOCK_RADIUS_M };
    step_to(scene, me, goal, threat.speed_mps, None);
    if scene.distance_m(me, target).is_some_and(|distance| distance <= threat.face_within_m) {
        face(scene, me, &to);
    }
}
