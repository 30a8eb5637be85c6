//! From inputs to a run that is ready to go, with every problem named at once.

use std::collections::VecDeque;

use socrates_engine::Floor;
use socrates_model::ids::BadId;
use socrates_model::time::STEP_SECS;
use socrates_model::{Cell, Grid, Point, Pose, RunId};

use super::agent::Agent;
use super::robot::Robot;
use super::scene::Scene;
use super::{HumanModel, Inputs, MAX_DURATION_S, Run, header, tick_of};
use crate::agents::{AgentEntry, AgentsFile, BehaviorEntry, check_on_map};
use crate::configure::configure;
use crate::problem::Problem;
use crate::profile::Profile;
use crate::trees::tree_of;

/// Floor around everybody where there is no map, m.
const MARGIN_M: f64 = 40.0;
/// Most cells along a side of an open floor.
const OPEN_CELLS: f64 = 1500.0;

impl Run {
    pub(super) fn new(inputs: &Inputs<'_>) -> Result<Self, Vec<Problem>> {
        let mut problems = numbers(inputs);
        problems.extend(clashes(inputs));
        problems.extend(models(inputs));
        let open;
        let grid = match inputs.grid {
            Some(grid) => grid,
            None => {
                open = open_floor(inputs);
                &open
            }
        };
        let floor = Floor::new(grid);
        let rules = inputs.profile.rules();
        if inputs.grid.is_some() {
            let found = check_on_map(inputs.agents, grid, floor.field(), inputs.file);
            // Upstream knows no map: there a goal in a wall is walked to through the wall.
            problems.extend(found.into_iter().map(|problem| if rules.native { problem } else { softened(problem) }));
        }
        let mut agents = Vec::new();
        let mut minds = Vec::new();
        for (number, entry) in (1_u32..).zip(&inputs.agents.agents) {
            // HuNavSim 1.0 and the fork have no parameters of behaviors.
            let plain = matches!(inputs.profile, Profile::Hunav10 | Profile::SocratesFork);
            let read = if plain { without_parameters(entry) } else { entry.clone() };
            let parameters = configure(&read, inputs.agents.dialect, inputs.seed, rules.mends_draws);
            match tree_of(inputs.agents, inputs.file, entry, inputs.profile, &parameters, inputs.trees) {
                Ok(own) => {
                    let mut agent = Agent::new(entry, number, parameters, rules.native, inputs.seed);
                    agent.model = inputs.models.get(&entry.id).copied().unwrap_or_default();
                    if own.sets_goals {
                        agent.goals = VecDeque::new();
                    }
                    agents.push(agent);
                    let state = own.tree.start_with(&own.entries);
                    minds.push((own.tree, state));
                }
                Err(found) => problems.extend(found),
            }
        }
        let run = run_id(inputs);
        if let Err(bad) = &run {
            problems.push(Problem::error(inputs.file, "", bad.to_string()));
        }
        let (errors, warnings): (Vec<Problem>, Vec<Problem>) = problems.into_iter().partition(Problem::is_error);
        let (Ok(run), true) = (run, errors.is_empty()) else { return Err(errors) };
        let scene = Scene {
            rules,
            agents,
            robot: inputs.robot.as_ref().map(Robot::new),
            floor,
            boxes: inputs.boxes.clone(),
            goals: inputs.agents.global_goals.clone(),
            now_s: 0.0,
            dt: STEP_SECS,
            events: Vec::new(),
        };
        Ok(Self { header: header(inputs, &scene, run), scene, minds, warnings, ticks: tick_of(inputs.duration_s) })
    }
}

fn softened(problem: Problem) -> Problem {
    Problem { severity: crate::problem::Severity::Warning, ..problem }
}

fn without_parameters(entry: &AgentEntry) -> AgentEntry {
    let behavior = BehaviorEntry { reaction: entry.behavior.reaction, ..BehaviorEntry::default() };
    AgentEntry { behavior, ..entry.clone() }
}

fn numbers(inputs: &Inputs<'_>) -> Vec<Problem> {
    let mut problems = Vec::new();
    if inputs.agents.agents.is_empty() {
        problems.push(Problem::error(inputs.file, "agents", "is empty: there is nobody to simulate"));
    }
    if !(inputs.duration_s.is_finite() && (STEP_SECS..=MAX_DURATION_S).contains(&inputs.duration_s)) {
        problems.push(
            Problem::error("--duration", "", "is out of range")
                .with_value(inputs.duration_s)
                .with_hint(format!("allowed: {STEP_SECS} to {MAX_DURATION_S} s")),
        );
    }
    let Some(robot) = &inputs.robot else { return problems };
    let mut wrong = |what: &str, value: f64, allowed: &str| {
        let hint = format!("allowed: {allowed}");
        problems.push(Problem::error("--robot", what, "is out of range").with_value(value).with_hint(hint));
    };
    let places = robot.goals.iter().flat_map(|goal| [goal.x, goal.y]);
    for value in [robot.start.x, robot.start.y, robot.start.yaw].into_iter().chain(places) {
        if !value.is_finite() || value.abs() > 1e6 {
            wrong("position", value, "finite coordinates within 1000 km");
        }
    }
    if !(0.05..=2.0).contains(&robot.radius_m) {
        wrong("radius", robot.radius_m, "0.05 to 2 m");
    }
    if !(0.0..=5.0).contains(&robot.speed_mps) {
        wrong("speed", robot.speed_mps, "0 to 5 m/s");
    }
    problems
}

/// Ids that somebody has twice, the robot included.
fn clashes(inputs: &Inputs<'_>) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (number, agent) in inputs.agents.agents.iter().enumerate() {
        let place = format!("{}.id", agent.name);
        if inputs.robot.as_ref().is_some_and(|robot| robot.id == Some(agent.id)) {
            problems.push(
                Problem::error(inputs.file, &place, "is the robot's id too")
                    .with_value(agent.id)
                    .with_hint("give the robot or the agent another one"),
            );
        }
        if let Some(first) = inputs.agents.agents.iter().take(number).find(|first| first.id == agent.id) {
            let message = format!("is the id of `{}` too", first.name);
            problems.push(Problem::error(inputs.file, &place, message).with_value(agent.id));
        }
    }
    problems
}

fn models(inputs: &Inputs<'_>) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (id, model) in &inputs.models {
        let ids: Vec<String> = inputs.agents.agents.iter().map(|agent| agent.id.to_string()).collect();
        if !inputs.agents.agents.iter().any(|agent| agent.id == *id) {
            problems.push(
                Problem::error("--model", "", "is the id of nobody")
                    .with_value(id)
                    .with_hint(format!("ids here: {}", ids.join(", "))),
            );
        }
        if inputs.profile != Profile::Native && *model != HumanModel::SocialForces {
            let message = format!("{} has social forces only", inputs.profile);
            problems.push(
                Problem::error("--model", "", message).with_value(model.name()).with_hint("use the profile native"),
            );
        }
    }
    problems
}

/// Free floor around everybody.
fn open_floor(inputs: &Inputs<'_>) -> Grid {
    let (mut low, mut high) = (Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN));
    let mut cover = |point: &Point| {
        if point.x.is_finite() && point.y.is_finite() {
            low = Point::new(low.x.min(point.x), low.y.min(point.y));
            high = Point::new(high.x.max(point.x), high.y.max(point.y));
        }
    };
    let file: &AgentsFile = inputs.agents;
    for agent in &file.agents {
        cover(&agent.start_point());
        agent.goals.iter().for_each(|goal| cover(&goal.at));
    }
    file.global_goals.iter().for_each(&mut cover);
    if let Some(robot) = &inputs.robot {
        cover(&robot.start.point());
        robot.goals.iter().for_each(&mut cover);
    }
    if low.x > high.x {
        (low, high) = (Point::origin(), Point::origin());
    }
    let (width_m, height_m) = (high.x - low.x + 2.0 * MARGIN_M, high.y - low.y + 2.0 * MARGIN_M);
    let resolution_m = (width_m.max(height_m) / OPEN_CELLS).max(0.25);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to OPEN_CELLS by construction")]
    let cells = |length_m: f64| ((length_m / resolution_m) as usize).max(1);
    let (width, height) = (cells(width_m), cells(height_m));
    Grid {
        width,
        height,
        resolution_m,
        origin: Pose::new(low.x - MARGIN_M, low.y - MARGIN_M, 0.0),
        cells: vec![Cell::Free; width.saturating_mul(height)],
    }
}

/// A name of the run that tells its file, profile and seed.
fn run_id(inputs: &Inputs<'_>) -> Result<RunId, BadId> {
    let stem = inputs.file.rsplit(['/', '\\']).next().unwrap_or(inputs.file);
    let stem = stem.split('.').next().unwrap_or(stem);
    let clean: String = stem.chars().filter(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-')).take(80).collect();
    let name = format!("{clean}.{}.{}", inputs.profile, inputs.seed);
    RunId::new(name)
}
