//! What a viewer needs to know of a run before its first frame, and what it sees besides the states: sight and lidar.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use socrates_draw::live_floor::LiveFloor;
use socrates_engine::{Disc, Floor, in_field_of_view, scan};
use socrates_model::live::{LiveDoor, LiveScene};
use socrates_model::{AgentState, Event, EventKind, Location, Point, RecordingHeader, Vector};

use crate::frame::Sights;

/// More agents than this are shown without sight and lidar: a crowd hides both.
const CROWD: usize = 200;

/// A run, its place and its robot.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Header of the recording.
    pub header: RecordingHeader,
    /// Name of the scenario.
    pub title: String,
    /// The place; a scene graph is drawn where there is one.
    pub location: Location,
    /// Doors as they stand at first.
    pub doors: Vec<LiveDoor>,
    /// Name, radius, m, and range of the lidar, m, of the robot; none in a run without one.
    pub robot: Option<(String, f64, f64)>,
    /// Where the robot is to go.
    pub goal: Option<Point>,
    /// The robot's way.
    pub way: Vec<Point>,
    /// Simulated seconds per second; none: as fast as it goes.
    pub pace: Option<f64>,
}

impl Scene {
    /// The scene that a run tells, of this title in this place.
    #[must_use]
    pub fn of(header: RecordingHeader, title: String, location: Location, told: &LiveScene) -> Self {
        let at = |[x, y]: &[f64; 2]| Point::new(*x, *y);
        Self {
            header,
            title,
            location,
            doors: told.doors.clone(),
            robot: told.robot.as_ref().map(|robot| (robot.name.clone(), robot.radius_m, robot.lidar_range_m)),
            goal: told.goal.as_ref().map(at),
            way: told.way.iter().map(at).collect(),
            pace: told.pace,
        }
    }

    /// What the page is told of it that never changes, with the drawing of its floor.
    #[must_use]
    pub fn json(&self, floor: &LiveFloor) -> Value {
        let header = &self.header;
        let at = |point: &Point| [point.x, point.y];
        let agents: Vec<Value> = header
            .agents
            .iter()
            .map(|info| {
                json!({ "id": info.agent, "number": info.agent.number(), "role": info.role, "radius_m": info.radius_m })
            })
            .collect();
        let doors: Vec<Value> = self
            .doors
            .iter()
            .map(|told| json!({ "id": told.door.id, "from": told.door.from, "to": told.door.to, "open": told.open }))
            .collect();
        let robot = self
            .robot
            .as_ref()
            .map(|(name, radius_m, range_m)| json!({ "name": name, "radius_m": radius_m, "lidar_range_m": range_m }));
        json!({
            "version": 1, "run": header.run, "planner": header.planner, "seed": header.seed, "step_s": header.step_s,
            "pace": self.pace, "title": self.title, "location": self.location.name,
            "place": { "box": floor.area, "px_per_m": floor.px_per_m, "origin": floor.origin, "yaw": floor.yaw },
            "robot": robot, "goal": self.goal.as_ref().map(at), "way": self.way.iter().map(at).collect::<Vec<_>>(),
            "agents": agents, "leaves": header.leaves, "absent_leaf": header.absent(), "doors": doors,
            "first_tick": 0,
        })
    }
}

/// Looks at a run from the robot's and everybody's eyes, as the engine does.
#[derive(Clone)]
pub struct Eyes {
    floor: Floor,
    doors: BTreeMap<String, (Point, Point, bool)>,
    radius_m: Vec<f64>,
    absent: Option<u16>,
    range_m: Option<f64>,
}

impl Eyes {
    /// The eyes of a run's agents.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let line = |told: &LiveDoor| {
            let ([fx, fy], [tx, ty]) = (told.door.from, told.door.to);
            (told.door.id.clone(), (Point::new(fx, fy), Point::new(tx, ty), told.open))
        };
        let mut eyes = Self {
            floor: Floor::new(&scene.location.grid),
            doors: scene.doors.iter().map(line).collect(),
            radius_m: scene.header.agents.iter().map(|info| info.radius_m).collect(),
            absent: scene.header.absent(),
            range_m: scene.robot.as_ref().map(|(_, _, range_m)| *range_m),
        };
        eyes.shut();
        eyes
    }

    fn shut(&mut self) {
        let shut = self.doors.values().filter(|(_, _, open)| !open);
        self.floor.close(shut.map(|(from, to, _)| (*from, *to)).collect());
    }

    /// Takes an event: a door that opens or shuts is seen so.
    pub fn happened(&mut self, event: &Event) {
        let EventKind::Door { door, open } = &event.kind else { return };
        if let Some(door) = self.doors.get_mut(door)
            && door.2 != *open
        {
            door.2 = *open;
            self.shut();
        }
    }

    /// What is seen at a tick.
    #[must_use]
    pub fn look(&self, states: &[AgentState]) -> Sights {
        let robot = states.iter().find(|state| state.agent == 0 && state.is_there(self.absent));
        let (Some(robot), Some(range_m)) = (robot, self.range_m) else { return Sights::default() };
        if states.len() > CROWD {
            return Sights::default();
        }
        let at = robot.point();
        let sees = |state: &AgentState| {
            let heading = Vector::new(libm::cos(state.yaw), libm::sin(state.yaw));
            state.agent != 0
                && state.is_there(self.absent)
                && in_field_of_view(&heading, &(at - state.point()))
                && self.floor.sees(&state.point(), &at)
        };
        let disc = |(state, radius_m): (&AgentState, &f64)| Disc { center: state.point(), radius_m: *radius_m };
        let others = states.iter().zip(&self.radius_m).filter(|(state, _)| state.agent != 0);
        let discs: Vec<Disc> = others.filter(|(state, _)| state.is_there(self.absent)).map(disc).collect();
        let pose = socrates_model::Pose::new(robot.x, robot.y, robot.yaw);
        Sights { sees: states.iter().map(sees).collect(), scan: scan(&self.floor, &pose, &discs, range_m), range_m }
    }
}
