//! Changes that a person who watches the run would not call another scenario.

use socrates_model::{AgentId, AgentState, Recording};

use super::Mutant;
use super::edit::{delayed, humans, time_of};

/// Sway that tracking of real people has, m.
const SWAY_M: f64 = 0.01;

/// Every harmless change of a recording: coarser, swaying, without velocities, a fifth of a second late.
#[must_use]
pub fn harmless(run: &Recording) -> Vec<Mutant> {
    let mut found = vec![
        Mutant { kind: "sampled at 10 Hz", about: "every tenth tick".to_owned(), recording: thinned(run, 10) },
        Mutant { kind: "sway of 1 cm", about: "everybody".to_owned(), recording: swaying(run) },
        Mutant { kind: "no velocities", about: "positions and headings alone".to_owned(), recording: placed(run) },
    ];
    for id in humans(run) {
        let recording = delayed(run, AgentId::Human(id), 0.2);
        found.push(Mutant { kind: "0.2 s later", about: id.to_string(), recording });
    }
    found
}

/// Every so many ticks, and the events as they were.
fn thinned(run: &Recording, every: usize) -> Recording {
    let agents = run.header.agents.len().max(1);
    let frames = run.frames.chunks(agents).step_by(every).flatten().copied().collect();
    Recording { frames, ..run.clone() }
}

fn swaying(run: &Recording) -> Recording {
    let mut found = run.clone();
    for state in &mut found.frames {
        let t = time_of(run, state);
        let phase = f64::from(state.agent);
        // Slow enough that it is a sway and not a shake.
        state.x += SWAY_M * libm::sin(1.3 * t + phase);
        state.y += SWAY_M * libm::cos(1.7 * t + 2.0 * phase);
    }
    found
}

fn placed(run: &Recording) -> Recording {
    let frames = run.frames.iter().map(|state| AgentState { vx: 0.0, vy: 0.0, omega: 0.0, ..*state }).collect();
    Recording { frames, ..run.clone() }
}
