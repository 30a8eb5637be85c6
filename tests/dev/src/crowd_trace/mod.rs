//! Scenes in, trajectories out, in the format of the reference recordings: for comparing this crate
//! with the reference library from outside.
//!
//! A scene is a JSON file with a model, constants, wall segments and agents ([`Scene`]). Its trajectory
//! is a CSV table of every agent at every step, its force table names every force; numbers are written
//! with 17 significant digits, as C's `%.17g` does, so that they read back to the same bits.
//!
//! The tests of the crowd take this module in by its path.

mod json;
mod number;
mod scene;

use std::io::{self, Write};

use nalgebra::Vector2;

use socrates_crowd::forces::Forces;
use socrates_crowd::strict::Crowd;

use number::Digits17;
pub(crate) use scene::{Scene, SceneError};

/// First line of a trajectory.
pub(crate) const TRAJECTORY_HEADER: &str = "step,id,x,y,vx,vy,yaw,goals_reached";

/// First line of a force table.
pub(crate) const FORCES_HEADER: &str = "step,id,n_obstacles,desired_x,desired_y,obstacle_x,obstacle_y,social_x,social_y,\
gaze_x,gaze_y,coherence_x,coherence_y,repulsion_x,repulsion_y,global_x,global_y";

/// Up to this step a force table has every step.
const FORCES_EVERY_STEP_UNTIL: u32 = 200;
/// After that it has the multiples of this.
const FORCES_EVERY: u32 = 50;

/// Runs the scene in [`socrates_crowd::strict`] mode and writes the state of every agent at every step, the
/// initial one included: row k is the state after k updates. Agents in list order.
///
/// # Errors
/// What `out` answers.
pub(crate) fn write_trajectory(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
    let mut crowd = scene.crowd();
    writeln!(out, "{TRAJECTORY_HEADER}")?;
    for step in 0..=scene.steps {
        if step > 0 {
            crowd.step(scene.dt_s);
        }
        write_state(&crowd, step, out)?;
    }
    out.flush()
}

/// [`write_trajectory`] as one text.
#[must_use]
pub(crate) fn trajectory(scene: &Scene) -> String {
    text(|out| write_trajectory(scene, out))
}

/// Runs the scene in [`socrates_crowd::strict`] mode and writes the forces computed *from* the state of a step:
/// at each of the first 200 steps, and then at each fiftieth.
///
/// # Errors
/// What `out` answers.
pub(crate) fn write_forces(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
    let mut crowd = scene.crowd();
    writeln!(out, "{FORCES_HEADER}")?;
    for step in 0..=scene.steps {
        let points = crowd.wall_points();
        let forces = crowd.forces(&points);
        if step <= FORCES_EVERY_STEP_UNTIL || step.is_multiple_of(FORCES_EVERY) {
            for ((person, points), forces) in crowd.people().iter().zip(&points).zip(&forces) {
                write!(out, "{step},{},{}", person.id, points.len())?;
                write_forces_of_one(forces, out)?;
            }
        }
        crowd.advance(&forces, scene.dt_s);
    }
    out.flush()
}

/// [`write_forces`] as one text.
#[must_use]
pub(crate) fn forces_table(scene: &Scene) -> String {
    text(|out| write_forces(scene, out))
}

/// What `write` writes; writing to memory never fails, and numbers are ASCII.
fn text(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> String {
    let mut bytes = Vec::new();
    match write(&mut bytes) {
        Ok(()) => String::from_utf8(bytes).unwrap_or_default(),
        Err(_) => String::new(),
    }
}

fn write_state(crowd: &Crowd, step: u32, out: &mut dyn Write) -> io::Result<()> {
    for (person, reached) in crowd.people().iter().zip(crowd.reached()) {
        let (x, y) = (Digits17(person.position.x), Digits17(person.position.y));
        let (vx, vy) = (Digits17(person.velocity.x), Digits17(person.velocity.y));
        writeln!(out, "{step},{},{x},{y},{vx},{vy},{},{reached}", person.id, Digits17(person.yaw))?;
    }
    Ok(())
}

fn write_forces_of_one(forces: &Forces, out: &mut dyn Write) -> io::Result<()> {
    let columns: [Vector2<f64>; 7] = [
        forces.desired,
        forces.obstacle,
        forces.social,
        forces.gaze,
        forces.coherence,
        forces.repulsion,
        forces.total(),
    ];
    for force in columns {
        write!(out, ",{},{}", Digits17(force.x), Digits17(force.y))?;
    }
    writeln!(out)
}
