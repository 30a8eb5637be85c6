//! SocNav3 JSON: map, robot, goal and people at ten samples a second, for learned scores and ratings by people.
//!
//! Rows of the grid come from the top of the map; a cell is 0 free, 1 occupied, -1 unknown. Timestamps rise by less than 0.5 s.

use serde_json::{Value, json};
use socrates_model::{AgentId, AgentState, Cell, Point};

use super::content::Content;
use super::frames::{angle, between, file_name, samples};
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// Ticks from sample to sample: 0.1 s.
const TICKS: u64 = 10;
/// Within this distance of its last place a robot is at its goal, m.
const AT_GOAL_M: f64 = 0.5;

const NO_PLACE: &str = "the format has no place for it";
const STATIC: &str = "walls of the format never change: doors stand open";

pub(super) const FORMAT: Format = Format {
    name: "socnav3",
    stem: "socnav3",
    about: "trajectory JSON of SocNav3: grid, robot with its goal, and people, 10 samples a second",
    foreign: Foreign::Neither,
    checked_by: "no reader in a package index; our test holds the rules of its published schema",
    needs_run: true,
    feature: None,
    lacks: &[
        (Content::Gestures, NO_PLACE),
        (Content::Leaves, NO_PLACE),
        (Content::Events, NO_PLACE),
        (Content::Speeds, NO_PLACE),
        (Content::Roles, NO_PLACE),
        (Content::Groups, NO_PLACE),
        (Content::Doors, STATIC),
        (Content::DoorRules, STATIC),
        (Content::Graph, NO_PLACE),
        (Content::AreaNames, NO_PLACE),
        (Content::Encounters, NO_PLACE),
        (Content::Trees, NO_PLACE),
        (Content::Clauses, NO_PLACE),
    ],
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    let samples = samples(run, TICKS)?;
    between(run, &samples, losses);
    let goal = goal(scenario)?;
    let place_alone = "people of the format have a place and an angle alone";
    scenario.note_people(Content::Radii, "radii of people", place_alone, losses);
    scenario.note_people(Content::Velocities, "velocities of people", place_alone, losses);
    scenario.note_people(Content::Paths, "paths of people", "the format has the robot's goal alone", losses);
    if scenario.paths.robot.len() > 1 {
        losses.note("nodes of the robot's path", "paths.json robot", "the format has the robot's goal alone");
    }
    let mut sequence = Vec::new();
    for sample in &samples {
        let Some(robot) = sample.states.iter().find(|state| state.agent_id() == AgentId::Robot) else {
            let problem = format!("the robot is not there at {:.2} s", sample.time.secs());
            return Err(Unusable::new("recording", problem, "choose a run with a robot; other formats need none"));
        };
        let people = sample.states.iter().filter(|state| state.agent_id() != AgentId::Robot);
        let people: Vec<Value> = people
            .map(|state| json!({"id": state.agent, "x": micro(state.x), "y": micro(state.y), "angle": micro(angle(state.yaw))}))
            .collect();
        sequence.push(json!({
            "timestamp": sample.time.secs(),
            "robot": robot_value(robot, scenario.robot_radius()),
            "goal": goal,
            "people": people,
            "objects": [],
        }));
    }
    let grid = &scenario.location.grid;
    let cell = |cell: &Cell| match cell {
        Cell::Free => 0,
        Cell::Occupied => 1,
        Cell::Unknown => -1,
    };
    let rows: Vec<Vec<i32>> = grid.cells.chunks(grid.width.max(1)).map(|row| row.iter().map(cell).collect()).collect();
    let proposal = &scenario.proposal;
    let told = [&proposal.title, &proposal.description, &proposal.robot.task, &proposal.robot.expected_behavior];
    let behaviors = proposal.humans.iter().map(|human| &human.behavior);
    let words: Vec<&str> =
        told.into_iter().chain(behaviors).map(String::as_str).filter(|text| !text.is_empty()).collect();
    let value = json!({
        "metadata": words.join("\n"),
        "grid": {
            "width": grid.width,
            "height": grid.height,
            "cell_size": grid.resolution_m,
            "x_orig": micro(grid.origin.x),
            "y_orig": micro(grid.origin.y),
            "angle_orig": micro(grid.origin.yaw),
            "data": rows,
        },
        "walls": [],
        "sequence": sequence,
    });
    Ok(Files::from([(format!("{}.json", file_name(&scenario.name, losses)), File::Text(format!("{value}\n")))]))
}

/// The robot's goal: where its path ends.
fn goal(scenario: &Scenario) -> Result<Value, Unusable> {
    let graph = &scenario.location.graph;
    let last = scenario.paths.robot.last().and_then(|id| graph.node(id)).map(|node| node.at);
    let before = scenario.paths.robot.iter().rev().nth(1).and_then(|id| graph.node(id)).map(|node| node.at);
    let Some(at) = last else {
        let problem = "the robot has no path, so it has no goal, which the format wants";
        return Err(Unusable::new("paths.json robot", problem, "choose another format"));
    };
    let along = at - before.unwrap_or_else(|| Point::new(at.x - 1.0, at.y));
    Ok(json!({
        "type": "go-to",
        "human": null,
        "x": micro(at.x),
        "y": micro(at.y),
        "angle": micro(libm::atan2(along.y, along.x)),
        "pos_threshold": AT_GOAL_M,
        "angle_threshold": micro(std::f64::consts::PI),
    }))
}

/// The robot with its shape; speeds are along and across its heading.
fn robot_value(state: &AgentState, radius_m: f64) -> Value {
    let (sin, cos) = (libm::sin(state.yaw), libm::cos(state.yaw));
    json!({
        "shape": {"type": "circle", "width": micro(2.0 * radius_m), "length": micro(2.0 * radius_m)},
        "x": micro(state.x),
        "y": micro(state.y),
        "angle": micro(angle(state.yaw)),
        "speed_x": micro(state.vx * cos + state.vy * sin),
        "speed_y": micro(state.vy * cos - state.vx * sin),
        "speed_a": micro(state.omega),
    })
}
