//! What a recording may say: beyond these bounds a number is a damaged byte or an error of units.
//!
//! Whoever reads a recording walks along its paths and through its time. A position of 1e265 m would be a walk
//! without an end, so such numbers stop at the door.

use socrates_model::recording::{AgentState, Event, RecordingHeader};

/// Largest coordinate, heading, velocity and turning rate, in m, rad, m/s and rad/s: as for tables of tracks.
const REACH: f64 = 1e6;
/// Longest step, s: recordings have 0.01 s, tables at most 0.1 s.
const LONGEST_STEP_SECS: f64 = 0.1;
/// Largest radius of an agent, m.
const WIDEST_M: f64 = 100.0;
/// Most agents of one recording.
const MOST_AGENTS: usize = 4096;
/// Latest time of an event, s.
const LATEST_SECS: f64 = 1e6;

fn within(value: f64, least: f64, most: f64) -> bool {
    value.is_finite() && value >= least && value <= most
}

/// What is impossible about a header, in words that name the key and its value.
pub(crate) fn header(header: &RecordingHeader) -> Option<String> {
    if !(within(header.step_s, 0.0, LONGEST_STEP_SECS) && header.step_s > 0.0) {
        return Some(format!("`step_s` is {} s: a step has at most {LONGEST_STEP_SECS} s", header.step_s));
    }
    if header.agents.len() > MOST_AGENTS {
        return Some(format!("its header names {} agents: at most {MOST_AGENTS} are read", header.agents.len()));
    }
    header.agents.iter().find_map(|info| {
        if !within(info.radius_m, 0.0, WIDEST_M) {
            return Some(format!("`radius_m` of {} is {} m: at most {WIDEST_M} m is read", info.agent, info.radius_m));
        }
        (!within(info.speed_mps, 0.0, REACH))
            .then(|| format!("`speed_mps` of {} is {} m/s: at most {REACH} m/s is read", info.agent, info.speed_mps))
    })
}

/// What is impossible about a state, in words that name the agent, the tick, the quantity and its value.
pub(crate) fn state(state: &AgentState) -> Option<String> {
    let quantities = [
        ("x", state.x, "m"),
        ("y", state.y, "m"),
        ("yaw", state.yaw, "rad"),
        ("vx", state.vx, "m/s"),
        ("vy", state.vy, "m/s"),
        ("omega", state.omega, "rad/s"),
    ];
    quantities.iter().find(|(_, value, _)| !within(*value, -REACH, REACH)).map(|(name, value, unit)| {
        let (agent, tick) = (state.agent_id(), state.tick);
        format!(
            "{agent} has the {name} `{value:e}` {unit} at tick {tick}: states lie between -{REACH} and {REACH} {unit}"
        )
    })
}

/// What is impossible about an event.
pub(crate) fn event(event: &Event) -> Option<String> {
    let time_s = event.time.secs();
    (!within(time_s, 0.0, LATEST_SECS)).then(|| format!("an event is at {time_s:e} s: runs end before {LATEST_SECS} s"))
}
