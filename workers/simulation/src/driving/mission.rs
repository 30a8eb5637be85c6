//! The mission as it is told to a driver.

use socrates_model::driver::{MissionDoor, MissionMap, MissionMessage};
use socrates_model::lockstep::VERSION;
use socrates_model::robot::RobotFile;
use socrates_model::{PlannerName, Point};
use socrates_planners::Mission;

use super::{Mode, Wanted};

/// A point as it is told.
fn at(point: &Point) -> [f64; 2] {
    [point.x, point.y]
}

/// The message for this run, with its plan and the cells of its map.
///
/// # Errors
/// `J-DRIVER` for a name that no driver can have.
pub(super) fn message(
    wanted: &Wanted<'_>,
    session: u64,
    mode: Mode,
    plan: &[Point],
    told_cells: &[u8],
) -> Result<MissionMessage, socrates_model::Fault> {
    let Mission { robot, grid, doors, waypoints, .. } = wanted.mission;
    let planner = PlannerName::new(format!("external:{}", wanted.driver));
    let points = |points: &[Point]| points.iter().map(at).collect::<Vec<_>>();
    Ok(MissionMessage {
        socrates: "mission".to_owned(),
        version: VERSION,
        session,
        run: wanted.run.clone(),
        planner: planner.map_err(|bad| wanted.fault(bad.to_string()))?,
        seed: wanted.seed,
        mode: mode.word().to_owned(),
        robot: RobotFile::from(robot),
        person: wanted.person.cloned(),
        goal: waypoints.last().map(at).unwrap_or_default(),
        waypoints: points(waypoints),
        plan: points(plan),
        doors: doors
            .iter()
            .map(|door| MissionDoor { id: door.id.clone(), from: at(&door.from), to: at(&door.to) })
            .collect(),
        people: wanted.people.to_vec(),
        map: MissionMap::of(grid, told_cells),
    })
}
