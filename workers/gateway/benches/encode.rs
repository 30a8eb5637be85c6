//! Frames for Foxglove and Lichtblick: bytes and time of each topic, for 50, 1 000 and 10 000 agents.
//!
//! `cargo bench -p socrates-gateway --bench encode` prints one table; time is CPU time of this process, one thread. A frame is
//! encoded once, however many viewers there are; the last column is what each viewer costs besides.
#![expect(clippy::print_stdout, reason = "a bench prints its table")]

#[path = "../../../tests/machine.rs"]
mod machine;

use std::hint::black_box;

use machine::cpu_s;
use socrates_gateway::fox::{Facts, Frame, Inbound, Message, Session, Stage, Topic, Topics};
use socrates_model::recording::{AgentInfo, AgentState};
use socrates_model::{AgentId, SimTime};

/// States of one measurement, from which the number of frames follows.
const STATES: u64 = 2_000_000;
/// Measurements; the median is printed.
const RUNS: usize = 7;
/// Viewers, of whom each is given every frame.
const VIEWERS: usize = 40;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn everybody(agents: u32) -> (Vec<AgentInfo>, Vec<AgentState>) {
    let info = |number| AgentInfo {
        agent: AgentId::from_number(number),
        radius_m: 0.3,
        speed_mps: 1.2,
        role: "visitor".to_owned(),
    };
    let state = |agent| {
        let turn = f64::from(agent) * 0.61;
        AgentState {
            tick: 0,
            agent,
            flags: AgentState::flags(AgentId::from_number(agent), None, 1),
            x: f64::from(agent % 100) + libm::cos(turn),
            y: f64::from(agent / 100) + libm::sin(turn),
            yaw: turn,
            vx: 0.8 * libm::cos(turn),
            vy: 0.8 * libm::sin(turn),
            omega: 0.1,
        }
    };
    ((0..agents).map(info).collect(), (0..agents).map(state).collect())
}

/// How many frames of this size are measured at once: the clock of the process may go in steps of 4 ms.
const fn frames(agents: usize) -> u64 {
    match STATES / agents as u64 {
        few if few < 400 => 400,
        many => many,
    }
}

/// Bytes and microseconds of a frame with these topics.
fn frame(stage: &mut Stage, states: &[AgentState], scan: &[f32], wanted: Topics) -> (usize, f64) {
    let mut bytes = 0;
    let measured = (0..RUNS)
        .map(|_| {
            let before = cpu_s();
            for tick in 0..frames(states.len()) {
                let frame = Frame { time: SimTime::at_tick(5 * tick), states, scan: Some(scan) };
                bytes = black_box(stage.frame(&frame, wanted)).iter().map(|message| message.payload.len()).sum();
            }
            (cpu_s() - before) * 1e6 / frames(states.len()) as f64
        })
        .collect();
    (bytes, median(measured))
}

/// Microseconds that one more viewer of these messages costs: its heads, and the copy into a frame in one piece.
fn viewers(stage: &Stage, messages: &[Message], rounds: u64) -> f64 {
    let mut viewer = Session::new("bench", None, "bench", stage.offers());
    let list: Vec<String> =
        messages.iter().map(|message| format!(r#"{{"id":{0},"channelId":{0}}}"#, message.topic.id())).collect();
    viewer.hear(Inbound::Text(&format!(r#"{{"op":"subscribe","subscriptions":[{}]}}"#, list.join(","))), stage);
    let all = vec![viewer; VIEWERS];
    let measured = (0..RUNS)
        .map(|_| {
            let before = cpu_s();
            for _ in 0..rounds {
                for viewer in &all {
                    for out in messages.iter().filter_map(|message| viewer.give(message)) {
                        black_box(out.into_bytes());
                    }
                }
            }
            (cpu_s() - before) * 1e6 / (rounds * VIEWERS as u64) as f64
        })
        .collect();
    median(measured)
}

fn main() {
    println!("{}", machine::told("frames for Foxglove and Lichtblick, one thread"));
    println!("{:>8} {:<18} {:>10} {:>12} {:>16}", "agents", "topics", "bytes", "us a frame", "us for a viewer");
    let scan = [4.0_f32; 360];
    for agents in [50, 1_000, 10_000] {
        let (infos, states) = everybody(agents);
        let facts = Facts { agents: &infos, way: &[[0.0, 0.0], [9.0, 9.0]], scans: true, ..Facts::default() };
        let mut stage = Stage::new(&facts).with_records();
        let usual: Topics = stage.offers().without(Topic::Agents);
        let rows = [Topic::Frames, Topic::Crowd, Topic::Scan, Topic::Odometry, Topic::Agents]
            .map(|topic| (topic.sheet().name, Topics::NONE.with(topic)));
        for (name, wanted) in rows.into_iter().chain([("all a viewer shows", usual), ("nothing", Topics::NONE)]) {
            if !name.starts_with('/') || !(wanted & stage.offers()).is_empty() {
                let (bytes, us) = frame(&mut stage, &states, &scan, wanted);
                let now = Frame { time: SimTime::ZERO, states: &states, scan: Some(&scan) };
                let each = viewers(&stage, &stage.clone().frame(&now, wanted), frames(states.len()) / 4);
                println!("{agents:>8} {name:<18} {bytes:>10} {us:>12.1} {each:>16.2}");
            }
        }
        let started = cpu_s();
        let rounds: u16 = 4_000;
        let whole = (0..rounds)
            .map(|_| stage.latched(Topic::Scene))
            .fold(0, |_, sent| sent.iter().map(|message| message.payload.len()).sum::<usize>());
        let us = (cpu_s() - started) * 1e6 / f64::from(rounds);
        println!("{agents:>8} {:<18} {whole:>10} {us:>12.1} {:>16}", "the whole scene", "once");
    }
}
