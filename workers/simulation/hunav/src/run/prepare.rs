//! From inputs to a run that is ready to go, with every problem named at once.

use std::collections::VecDeque;

use socrates_crowd::Near;
use socrates_crowd::orca::{Orca, OrcaSettings};
use socrates_engine::Floor;
use socrates_model::ids::BadId;
use socrates_model::time::STEP_SECS;
use socrates_model::{Cell, Grid, Point, Pose, RunId};

use super::agent::Agent;
use super::robot::Robot;
use super::scene::Scene;
use super::{HumanModel, Inputs, MAX_DURATION_S, Run, header, tick_of};
use crate::agents::{AgentEntry, AgentsFile, BehaviorEntry, InitPose, check_on_map};
use crate::configure::configure;
use crate::problem::Problem;
use crate::profile::Profile;
use crate::trees::tree_of;

/// Most states of a recording, agents times ticks: 3 GB of memory.
const MAX_STATES: f64 = 50e6;
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
        let mut tracks = Vec::new();
        let recorded = recorded(inputs);
        for (number, entry) in (1_u32..).zip(inputs.agents.agents.iter().chain(&recorded)) {
            let track = u32::try_from(entry.id).ok().and_then(|id| inputs.tracks?.get(id)).cloned();
            // HuNavSim 1.0 and the fork have no parameters of behaviors.
            let plain = matches!(inputs.profile, Profile::Hunav10 | Profile::SocratesFork);
            let read = if plain { without_parameters(entry) } else { entry.clone() };
            let parameters = configure(&read, inputs.agents.dialect, inputs.seed, rules.mends_draws);
            match tree_of(inputs.agents, inputs.file, entry, inputs.profile, &parameters, inputs.trees) {
                Ok(own) => {
                    let mut agent = Agent::new(entry, number, parameters, rules.native, inputs.seed);
                    agent.model = match track {
                        Some(_) => HumanModel::Track,
                        None => inputs.models.get(&entry.id).copied().unwrap_or_default(),
                    };
                    tracks.push(track);
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
        let orca = Orca::new(OrcaSettings::default());
        if let Err(bad) = &orca {
            problems.push(Problem::error("--model", "orca", bad.to_string()));
        }
        if let Err(bad) = &run {
            problems.push(Problem::error(inputs.file, "", bad.to_string()));
        }
        let (errors, warnings): (Vec<Problem>, Vec<Problem>) = problems.into_iter().partition(Problem::is_error);
        let (Ok(run), Ok(orca), true) = (run, orca, errors.is_empty()) else { return Err(errors) };
        let scene = Scene {
            rules,
            agents,
            robot: inputs.robot.as_ref().map(Robot::new),
            floor,
            near: Near::default(),
            orca,
            boxes: inputs.boxes.clone(),
            goals: inputs.agents.global_goals.clone(),
            now_s: 0.0,
            dt: STEP_SECS,
            events: Vec::new(),
        };
        Ok(Self {
            header: header(inputs, &scene, run),
            scene,
            minds,
            tracks,
            warnings,
            ticks: tick_of(inputs.duration_s),
        })
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
    #[expect(clippy::cast_precision_loss, reason = "at most some ten thousand agents")]
    let states = inputs.duration_s / STEP_SECS * inputs.agents.agents.len() as f64;
    if states > MAX_STATES {
        let message = format!("would make a recording of {states:.0} states");
        let hint = format!("allowed: at most {MAX_STATES:.0}; run it for a shorter time");
        problems.push(Problem::error("--duration", "", message).with_value(inputs.duration_s).with_hint(hint));
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
    if let Some(id) = inputs.robot.as_ref().and_then(|robot| u32::try_from(robot.id?).ok())
        && inputs.tracks.is_some_and(|tracks| tracks.get(id).is_some())
    {
        problems.push(Problem::error("--tracks", "id", "is the robot's id too").with_value(id));
    }
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
        let has_track = u32::try_from(*id).is_ok_and(|id| inputs.tracks.is_some_and(|tracks| tracks.get(id).is_some()));
        if *model == HumanModel::Track && !has_track {
            problems.push(
                Problem::error("--model", "", "has no recorded track")
                    .with_value(id)
                    .with_hint("give one with --tracks"),
            );
        }
        if inputs.profile != Profile::Native && *model == HumanModel::Orca {
            let message = format!("{} has social forces only", inputs.profile);
            problems.push(
                Problem::error("--model", "", message).with_value(model.name()).with_hint("use the profile native"),
            );
        }
    }
    problems
}

/// Radius of somebody who is known from a track alone, m.
const RECORDED_RADIUS_M: f64 = 0.28;

/// Recorded people who are not in the agents file.
fn recorded(inputs: &Inputs<'_>) -> Vec<AgentEntry> {
    let Some(tracks) = inputs.tracks else { return Vec::new() };
    let is_robot = |id: u32| id == 0 && inputs.robot.as_ref().is_some_and(|robot| robot.track.is_some());
    let is_listed = |id: u32| inputs.agents.agents.iter().any(|agent| agent.id == i64::from(id));
    let strangers = tracks.iter().filter(|(id, _)| !is_listed(*id) && !is_robot(*id));
    strangers
        .map(|(id, track)| {
            let start = track.samples().first().map_or_else(Point::origin, |sample| sample.position);
            AgentEntry {
                name: format!("track_{id}"),
                id: i64::from(id),
                skin: -1,
                group_id: -1,
                max_vel_mps: 1.5,
                radius_m: RECORDED_RADIUS_M,
                start: InitPose { x: start.x, y: start.y, z: 0.0, h: 0.0 },
                goal_radius_m: 0.0,
                cyclic_goals: false,
                behavior: BehaviorEntry::default(),
                goals: Vec::new(),
            }
        })
        .collect()
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
    for (_, track) in inputs.tracks.iter().flat_map(|tracks| tracks.iter()) {
        track.samples().iter().for_each(|sample| cover(&sample.position));
    }
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
