//! Tracks as few timed poses: straight parts between two poses stay within a tolerance of every tick.

use socrates_model::{AgentId, Recording, SimTime, time::STEP_NANOS};

/// Largest distance of a tick from the line between two poses, m.
const OFF_M: f64 = 0.001;
/// Largest difference of a tick's heading from the line between two poses, rad.
const OFF_RAD: f64 = 0.02;

/// A pose of a script.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Waypoint {
    /// When, from the first tick of the run, s.
    pub(crate) time_s: f64,
    /// x, m.
    pub(crate) x: f64,
    /// y, m.
    pub(crate) y: f64,
    /// Heading without jumps by full turns, rad.
    pub(crate) yaw: f64,
}

/// The poses of an agent while it is there; empty where it never is.
pub(crate) fn script(run: &Recording, agent: AgentId) -> Vec<Waypoint> {
    let absent = run.header.absent();
    let first = run.frames.first().map_or(0, |state| state.tick);
    let mut all: Vec<Waypoint> = Vec::new();
    for state in run.track(agent).filter(|state| state.is_there(absent)) {
        let time = SimTime::from_nanos(state.tick.saturating_sub(first).saturating_mul(STEP_NANOS));
        // Between two poses the shorter way round is meant.
        let before = all.last().map_or(state.yaw, |last| last.yaw);
        let yaw = before + super::super::frames::angle(state.yaw - before);
        all.push(Waypoint { time_s: time.secs(), x: state.x, y: state.y, yaw });
    }
    thinned(&all)
}

/// The ends, and of what lies between them as little as keeps every pose within the tolerance (Douglas and Peucker, over time).
fn thinned(all: &[Waypoint]) -> Vec<Waypoint> {
    let Some(last) = all.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; all.len()];
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        for end in [from, to] {
            if let Some(slot) = kept.get_mut(end) {
                *slot = true;
            }
        }
        let (Some(a), Some(b)) = (all.get(from), all.get(to)) else { continue };
        let inner = all.iter().enumerate().take(to).skip(from + 1);
        let worst = inner.map(|(place, one)| (place, off(a, b, one))).max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((place, _)) = worst.filter(|(_, off)| *off > 1.0) {
            open.push((from, place));
            open.push((place, to));
        }
    }
    all.iter().zip(kept).filter(|(_, kept)| *kept).map(|(one, _)| *one).collect()
}

/// How far a pose lies from the line between two others at its time, as a share of the tolerance.
fn off(a: &Waypoint, b: &Waypoint, one: &Waypoint) -> f64 {
    let long_s = b.time_s - a.time_s;
    let share = if long_s > 0.0 { (one.time_s - a.time_s) / long_s } else { 0.0 };
    let between = |from: f64, to: f64| from + (to - from) * share;
    let distance_m = (one.x - between(a.x, b.x)).hypot(one.y - between(a.y, b.y));
    let turn = (one.yaw - between(a.yaw, b.yaw)).abs();
    (distance_m / OFF_M).max(turn / OFF_RAD)
}
