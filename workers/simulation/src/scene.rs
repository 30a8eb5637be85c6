//! What viewers of a run are told before its first tick.

#[cfg(feature = "mcap")]
use socrates_engine::Setup;
use socrates_model::driver::{MissionDoor, MissionMap, map_cells};
#[cfg(feature = "mcap")]
use socrates_model::job::JobSpec;
use socrates_model::live::{LiveDoor, LivePlace, LiveScene, WAY_POINTS};
use socrates_model::robot::{RobotFile, RobotModel};
use socrates_model::{Door, DoorOpens, Location, Paths, Point};

#[cfg(feature = "mcap")]
use crate::pace::Pace;
use socrates_model::request::Waypoints;

use crate::ways::waypoints;

/// The scene of a run that this job begins now, with or without a robot, and the cells of its map.
#[cfg(feature = "mcap")]
pub(crate) fn scene(setup: &Setup, has_robot: bool, job: &JobSpec, pace: Pace) -> (LiveScene, Vec<u8>) {
    let cells = map_cells(&setup.location.grid);
    let scene = LiveScene {
        pace: match pace {
            Pace::Max => None,
            Pace::Times(times) => Some(times),
        },
        started_ms: socrates_link::wall_ms(),
        inputs: job.inputs.clone(),
        ..live_scene(&setup.location, &cells, &setup.paths, has_robot.then_some(&setup.robot), setup.waypoints)
    };
    (scene, cells)
}

/// What viewers are told of a place with a map of these cells, of a robot where there is one, and of its way.
#[must_use]
pub fn live_scene(
    location: &Location,
    cells: &[u8],
    paths: &Paths,
    robot: Option<&RobotModel>,
    which: Waypoints,
) -> LiveScene {
    let at = |point: &Point| [point.x, point.y];
    let way = location.graph.polyline(&paths.robot);
    let points = waypoints(&location.graph, &paths.robot, which);
    let goal = points.last().or_else(|| way.last());
    let door = |door: &Door| LiveDoor {
        door: MissionDoor { id: door.id.clone(), from: at(&door.from), to: at(&door.to) },
        open: door.opens == DoorOpens::Always,
    };
    let map = MissionMap::of(&location.grid, cells);
    LiveScene {
        location: Some(LivePlace { name: location.name.clone(), map }),
        doors: location.doors.iter().map(door).collect(),
        robot: robot.map(RobotFile::from),
        goal: goal.filter(|_| robot.is_some()).map(at),
        way: way.iter().take(WAY_POINTS).map(at).filter(|_| robot.is_some()).collect(),
        ..LiveScene::default()
    }
}
