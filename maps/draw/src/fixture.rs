//! Small recordings and papers for tests.

use serde_json::json;
use socrates_model::recording::AgentInfo;
use socrates_model::{
    AgentId, AgentState, Location, Paths, PlannerName, Proposal, Reading, Recording, RecordingHeader, Report, Request,
    RunId,
};

/// Text that would become markup, script or a place of a template where it is not made safe.
pub(crate) const EVIL: &str = "</script><script>alert(1)</script>{{data}}<!--\"'<img src=x onerror=alert(1)>\u{1}";

/// A state of an agent.
pub(crate) fn state(agent: u32, x: f64, y: f64, vx: f64, vy: f64) -> AgentState {
    let flags = AgentState::flags(AgentId::from_number(agent), None, 0);
    AgentState { tick: 0, agent, flags, x, y, yaw: vy.atan2(vx), vx, vy, omega: 0.0 }
}

/// The robot.
pub(crate) fn robot(x: f64, y: f64, vx: f64, vy: f64) -> AgentState {
    state(0, x, y, vx, vy)
}

/// A human.
pub(crate) fn human(number: u32, x: f64, y: f64, vx: f64, vy: f64) -> AgentState {
    state(number, x, y, vx, vy)
}

/// A recording of these ticks, 0.01 s apart; everybody has a radius of 0.3 m.
pub(crate) fn recording(ticks: &[&[AgentState]]) -> Recording {
    let agents = ticks.first().map_or(&[] as &[AgentState], |tick| *tick);
    let header = RecordingHeader {
        format: 1,
        run: RunId::new("test.reference-1").unwrap(),
        planner: PlannerName::reference(),
        seed: 1,
        profile: "native".to_owned(),
        step_s: 0.01,
        agents: agents
            .iter()
            .map(|state| {
                let agent = AgentId::from_number(state.agent);
                AgentInfo { agent, radius_m: 0.3, speed_mps: 1.2, role: agent.to_string() }
            })
            .collect(),
        leaves: vec!["none".to_owned()],
    };
    let frames = ticks
        .iter()
        .enumerate()
        .flat_map(|(tick, states)| states.iter().map(move |state| AgentState { tick: tick as u64, ..*state }))
        .collect();
    Recording { header, frames, events: Vec::new() }
}

/// The recording with a human who is not there for some of its ticks, as the simulation writes it.
pub(crate) fn away(mut run: Recording, number: u32, ticks: std::ops::Range<u64>) -> Recording {
    run.header.leaves = vec!["none".to_owned(), "track".to_owned(), "absent".to_owned()];
    for state in run.frames.iter_mut().filter(|state| state.agent == number) {
        let leaf = if ticks.contains(&state.tick) { 2 } else { 1 };
        state.flags = AgentState::flags(AgentId::from_number(number), None, leaf);
    }
    run
}

/// The robot goes 6 m along x in 6 s; so many humans come towards it, each on its own line.
pub(crate) fn walk(humans: u32) -> Recording {
    let ticks: Vec<Vec<AgentState>> = (0..=600)
        .map(|tick| {
            let t = f64::from(tick) / 100.0;
            let people = (1..=humans).map(|n| human(n, 7.0 - t, 1.0 + f64::from(n) * 0.01, -1.0, 0.0));
            std::iter::once(robot(1.0 + t, 1.0, 1.0, 0.0)).chain(people).collect()
        })
        .collect();
    recording(&ticks.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

fn read<T: serde::de::DeserializeOwned>(value: serde_json::Value) -> T {
    serde_json::from_value(value).unwrap()
}

/// A hall of 8 m by 3 m with walls around it.
pub(crate) fn hall(name: &str) -> Location {
    read(json!({
        "format": 1, "name": name, "description": name, "graph": { "nodes": [], "edges": [] },
        "grid": { "width": 80, "height": 30, "resolution_m": 0.1, "origin": { "x": 0.0, "y": 0.0, "yaw": 0.0 },
                  "cells": format!("81o{}79o", "78f2o".repeat(28)) },
    }))
}

/// A report on a recording, with words of this text wherever words can be.
pub(crate) fn report(recording: &Recording, text: &str) -> Report {
    let clause = |id: &str, role: &str, standing: &str, source: &str| {
        json!({ "id": id, "text": text, "role": role, "must": true, "source": source, "standing": standing,
                "margin": 1.0, "times_s": [2.5, 3.25], "evidence": text })
    };
    read(json!({
        "format": 1, "run": recording.header.run, "planner": recording.header.planner, "seed": 1,
        "recording": recording.hash(), "verdict": "realised", "verdict_text": text, "score": 0.9,
        "clauses": [clause("c1", "setup", "holds", "f1"), clause("c2", "setup", "fails", ""), clause("c3", "outcome", "not_applicable", "")],
        "metrics": [{ "id": "time_to_goal", "unit": "s", "value": 6.0, "direction": -1 },
                    { "id": "ttc_min", "unit": "s", "value": null, "direction": 1, "note": text }],
        "robot_text": text, "success": true, "story": [format!("2.5 s  {text}")],
        "encounter_gaps_s": { "human_1": 0.4 }, "simulated_s": 6.0,
    }))
}

/// A request, a reading, a proposal and paths made of this text, behind the door that would refuse some of it.
pub(crate) fn papers(text: &str) -> (Request, Reading, Proposal, Paths) {
    let plain: Request = read(json!({ "location": "office", "social_context": "", "task": "Go" }));
    let request = Request {
        location: text.to_owned(),
        social_context: text.to_owned(),
        task: text.to_owned(),
        rough_scenario: Some(text.to_owned()),
        ..plain
    };
    let reading = read(json!({
        "format": 1, "humans": [], "task": text, "notes": [text], "problems": [],
        "facts": [{ "id": "f1", "quote": text, "kind": { "humans": 1 } }, { "id": "f2", "quote": "", "kind": { "robot_task": text } }],
    }));
    let proposal = read(json!({
        "format": 1, "title": text, "description": text, "pattern": text, "place": "corridor",
        "humans": [{"id": "human_1", "role": text, "behavior": text, "relation": "frontal", "rules": [], "speed_mps": 1.0}],
        "robot": {"task": text, "script": [], "expected_behavior": text}, "expected_events": [], "author": text,
    }));
    let paths = read(json!({ "format": 1, "robot": [], "humans": {}, "encounters": [], "author": text }));
    (request, reading, proposal, paths)
}
