//! Stages of USD as text: walls, doors and what was never seen as cubes, robot and people as bodies that replay the run, intended paths as curves.
//!
//! The stage is in meters with z up; a time code is a tick. Headings are in degrees. Bodies of people are drawn, and touch nothing.

use std::fmt::Write as _;

use socrates_model::{AgentId, Cell, DoorOpens};

use super::boxes::Block;
use super::content::{Content, WORDS};
use super::frames::{file_name, number, plain_name, real};
use super::sdf::{DOOR_M, LEAF_M, WALL_M, boxes, script, walls};
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Time codes a second.
const CODES: f64 = 100.0;
/// Height of a person, m.
const PERSON_M: f64 = 1.7;
/// Height of the robot, m.
const ROBOT_M: f64 = 0.5;
/// Radius of bodies where no run tells it, m.
const RADIUS_M: f64 = 0.3;
/// Thickness of the floor, m.
const FLOOR_M: f64 = 0.1;
/// Width of the lines of paths, m.
const LINE_M: f64 = 0.05;
/// Height of the slabs over cells that were never seen, m.
const UNKNOWN_M: f64 = 0.02;

const STATES: &str = "a stage replays places and headings alone";

pub(super) const FORMAT: Format = Format {
    name: "usda-1.0",
    stem: "usda",
    about: "stage of USD: walls, doors, lights, robot and people who replay the run (a time code is a tick), paths as curves",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `usd-core` 26.11: its validators, the sizes of the walls, and the places of everybody",
    needs_run: false,
    feature: None,
    lacks: &[
        (Content::Velocities, STATES),
        (Content::Gestures, STATES),
        (Content::Leaves, STATES),
        (Content::Events, STATES),
        (Content::Speeds, STATES),
        (Content::Roles, WORDS),
        (Content::Groups, WORDS),
        (Content::Graph, WORDS),
        (Content::AreaNames, WORDS),
        (Content::Encounters, WORDS),
        (Content::Trees, WORDS),
        (Content::Clauses, WORDS),
        (Content::Texts, WORDS),
    ],
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    Ok(Files::from([(format!("{name}.usda"), File::Text(stage(scenario, true, losses)?))]))
}

/// The text of a stage, with or without robot and people.
pub(super) fn stage(scenario: &Scenario, with_agents: bool, losses: &mut Losses) -> Result<String, Unusable> {
    for place in Content::DoorRules.places(scenario) {
        let why = "a stage has no rules: doors that are not always open stand closed";
        losses.note("times of doors", place, why);
    }
    let mut stage = Stage::default();
    let run = scenario.recording.as_ref().filter(|_| with_agents);
    let first = run.and_then(|run| run.frames.first()).map_or(0, |state| state.tick);
    let last = run.and_then(|run| run.frames.last()).map_or(0, |state| state.tick);
    stage.add(format_args!(
        "#usda 1.0\n(\n    defaultPrim = \"World\"\n    endTimeCode = {}\n    framesPerSecond = {CODES}\n    metersPerUnit = 1\n    \
         startTimeCode = 0\n    timeCodesPerSecond = {CODES}\n    upAxis = \"Z\"\n)\n\ndef Xform \"World\"\n{{\n    \
         def PhysicsScene \"physics\"\n    {{\n        vector3f physics:gravityDirection = (0, 0, -1)\n        \
         float physics:gravityMagnitude = 9.81\n    }}\n    def DistantLight \"sun\"\n    {{\n        float inputs:intensity = 1000\n    }}\n",
        last.saturating_sub(first)
    ));
    stage.floor(scenario);
    let turn = scenario.location.grid.origin.yaw;
    stage.text.push_str("    def Xform \"walls\"\n    {\n");
    for (count, block) in walls(scenario, f64::INFINITY)?.iter().enumerate() {
        stage.cube(&format!("wall_{count}"), &Cube::of(block, turn));
    }
    stage.text.push_str("    }\n    def Xform \"unknown\"\n    {\n");
    for (count, block) in boxes(scenario, Cell::Unknown, f64::INFINITY)?.iter().enumerate() {
        let middle = [block.middle.x, block.middle.y, UNKNOWN_M / 2.0];
        let size = [block.along_m, block.across_m, UNKNOWN_M];
        stage.cube(&format!("unknown_{count}"), &Cube { middle, yaw: turn, size });
    }
    stage.text.push_str("    }\n    def Xform \"doors\"\n    {\n");
    for door in &scenario.location.doors {
        let line = door.to - door.from;
        // A door that is always open has slid into the wall behind its end.
        let slid = if door.opens == DoorOpens::Always { line } else { line * 0.0 };
        let middle = door.middle() + slid;
        let cube = Cube {
            middle: [middle.x, middle.y, DOOR_M / 2.0],
            yaw: libm::atan2(line.y, line.x),
            size: [line.norm(), LEAF_M, DOOR_M],
        };
        stage.cube(&format!("door_{}", plain_name(&door.id)), &cube);
    }
    stage.text.push_str("    }\n    def Xform \"paths\"\n    {\n");
    if with_agents {
        stage.paths(scenario);
    }
    stage.text.push_str("    }\n    def Xform \"agents\"\n    {\n");
    if let Some(run) = run {
        for info in &run.header.agents {
            let radius_m = if info.radius_m > 0.0 { info.radius_m } else { RADIUS_M };
            stage.agent(scenario, info.agent, radius_m);
        }
    }
    stage.text.push_str("    }\n}\n");
    Ok(stage.text)
}

/// A cube, turned around the vertical.
struct Cube {
    middle: [f64; 3],
    yaw: f64,
    size: [f64; 3],
}

impl Cube {
    fn of(block: &Block, turn: f64) -> Self {
        let middle = [block.middle.x, block.middle.y, WALL_M / 2.0];
        Self { middle, yaw: turn, size: [block.along_m, block.across_m, WALL_M] }
    }
}

/// The text of a stage as it grows.
#[derive(Debug, Default)]
struct Stage {
    text: String,
}

impl Stage {
    /// Adds lines; writing to a String cannot fail.
    fn add(&mut self, text: std::fmt::Arguments<'_>) {
        let (Ok(()) | Err(std::fmt::Error)) = self.text.write_fmt(text);
    }

    /// The floor under the whole map; its top is at 0.
    fn floor(&mut self, scenario: &Scenario) {
        let grid = &scenario.location.grid;
        #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
        let (width, height) = (grid.width as f64, grid.height as f64);
        let middle = grid.world_from_pixel(width * 0.5, height * 0.5);
        let size = [width * grid.resolution_m, height * grid.resolution_m, FLOOR_M];
        self.cube("floor", &Cube { middle: [middle.x, middle.y, -FLOOR_M / 2.0], yaw: grid.origin.yaw, size });
    }

    fn cube(&mut self, name: &str, cube: &Cube) {
        let triple = |values: &[f64; 3]| values.map(real).join(", ");
        self.add(format_args!(
            r#"        def Cube "{name}" (
            prepend apiSchemas = ["PhysicsCollisionAPI"]
        )
        {{
            float3[] extent = [(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)]
            double size = 1
            double3 xformOp:translate = ({})
            double xformOp:rotateZ = {}
            double3 xformOp:scale = ({})
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ", "xformOp:scale"]
        }}
"#,
            triple(&cube.middle),
            real(cube.yaw.to_degrees()),
            triple(&cube.size)
        ));
    }

    /// Intended paths as lines on the floor.
    fn paths(&mut self, scenario: &Scenario) {
        let (graph, paths) = (&scenario.location.graph, &scenario.paths);
        let robot = std::iter::once((AgentId::Robot, &paths.robot));
        let all = robot.chain(paths.humans.iter().map(|(id, nodes)| (AgentId::Human(*id), nodes)));
        for (agent, nodes) in all.filter(|(_, nodes)| nodes.len() > 1) {
            let points: Vec<_> = nodes.iter().filter_map(|id| graph.node(id)).map(|node| node.at).collect();
            let text: Vec<String> = points.iter().map(|at| format!("({}, {}, 0)", real(at.x), real(at.y))).collect();
            let half = LINE_M / 2.0;
            let low = |axis: usize| real(points.iter().map(|at| at[axis]).fold(f64::INFINITY, f64::min) - half);
            let high = |axis: usize| real(points.iter().map(|at| at[axis]).fold(f64::NEG_INFINITY, f64::max) + half);
            let (thin, wide) = (real(half), real(LINE_M));
            self.add(format_args!(
                "        def BasisCurves \"path_{agent}\"\n        {{\n            int[] curveVertexCounts = [{}]\n            \
                 float3[] extent = [({}, {}, -{thin}), ({}, {}, {thin})]\n            point3f[] points = [{}]\n            \
                 uniform token purpose = \"guide\"\n            uniform token type = \"linear\"\n            \
                 float[] widths = [{wide}] (\n                interpolation = \"constant\"\n            )\n        }}\n",
                points.len(),
                low(0),
                low(1),
                high(0),
                high(1),
                text.join(", ")
            ));
        }
    }

    /// A body that replays the run, seen while its agent is there.
    fn agent(&mut self, scenario: &Scenario, agent: AgentId, radius_m: f64) {
        let Some(run) = &scenario.recording else { return };
        let poses = script::script(run, agent);
        if poses.is_empty() {
            return;
        }
        let code = |time_s: f64| real(time_s * CODES);
        let rows = |value: &dyn Fn(&script::Waypoint) -> String| {
            let rows = poses.iter().map(|pose| format!("                {}: {},\n", code(pose.time_s), value(pose)));
            rows.collect::<String>()
        };
        let places = rows(&|pose| format!("({}, {}, 0)", real(pose.x), real(pose.y)));
        let turns = rows(&|pose| real(pose.yaw.to_degrees()));
        let id = number(agent);
        self.add(format_args!(
            "        def Xform \"{agent}\"\n        {{\n            custom int socrates:id = {id}\n            \
             token visibility.timeSamples = {{\n{}            }}\n            \
             double3 xformOp:translate.timeSamples = {{\n{places}            }}\n            \
             double xformOp:rotateZ.timeSamples = {{\n{turns}            }}\n            \
             uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateZ\"]\n{}        }}\n",
            seen(scenario, agent),
            body(agent, radius_m)
        ));
    }
}

/// When an agent comes and goes, as values of `visibility`.
fn seen(scenario: &Scenario, agent: AgentId) -> String {
    let Some(run) = &scenario.recording else { return String::new() };
    let absent = run.header.absent();
    let first = run.frames.first().map_or(0, |state| state.tick);
    let mut rows = String::new();
    let mut before = None;
    for state in run.track(agent) {
        let now = state.is_there(absent);
        if before != Some(now) {
            let word = if now { "inherited" } else { "invisible" };
            rows.push_str(&format!("                {}: \"{word}\",\n", state.tick.saturating_sub(first)));
            before = Some(now);
        }
    }
    rows
}

/// The shape of an agent: a capsule for a person, a cylinder for the robot, with a pointer along its heading.
fn body(agent: AgentId, radius_m: f64) -> String {
    let (kind, height_m, inner_m) = match agent {
        AgentId::Robot => ("Cylinder", ROBOT_M, ROBOT_M),
        AgentId::Human(_) => ("Capsule", PERSON_M, (PERSON_M - 2.0 * radius_m).max(0.0)),
    };
    let (radius, half, inner) = (real(radius_m), real(height_m / 2.0), real(inner_m));
    let tall = real((inner_m / 2.0) + if agent == AgentId::Robot { 0.0 } else { radius_m });
    let long = real(radius_m * 1.5);
    format!(
        r#"            def {kind} "body"
            {{
                uniform token axis = "Z"
                float3[] extent = [(-{radius}, -{radius}, -{tall}), ({radius}, {radius}, {tall})]
                double height = {inner}
                double radius = {radius}
                double3 xformOp:translate = (0, 0, {half})
                uniform token[] xformOpOrder = ["xformOp:translate"]
            }}
            def Cube "front"
            {{
                float3[] extent = [(-0.05, -0.05, -0.05), (0.05, 0.05, 0.05)]
                double size = 0.1
                double3 xformOp:translate = ({long}, 0, {half})
                uniform token[] xformOpOrder = ["xformOp:translate"]
            }}
"#
    )
}
