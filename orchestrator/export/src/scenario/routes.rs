//! Ways of robot and people as start, way points and waits, for simulators that move them anew.
//!
//! Way points are those of the intended path. Waits are those of the run: whoever stays within [`STILL_M`] for [`LEAST_WAIT_S`] or
//! longer waits there, in their place between the way points.

use socrates_model::{AgentId, AgentState, Point, Pose, time::STEP_SECS};

use super::Scenario;
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// Within this distance somebody who waits moves, m.
const STILL_M: f64 = 0.15;
/// Shortest time of standing that is a wait, s.
const LEAST_WAIT_S: f64 = 1.0;
/// Within this distance of a way point somebody has passed it, m.
const NEAR_M: f64 = 0.75;
/// Radius of people where no run tells it, m.
const RADIUS_M: f64 = 0.3;
/// Pace where neither run nor proposal tells it, m/s.
const PACE_MPS: f64 = 1.2;

/// Why the tracks of people are not in such a format.
pub(crate) const SIMULATED: &str =
    "people are simulated anew; the format has where they begin, their ways and their waits";

/// A part of a way: a place, and how long to stay there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    /// Where it ends.
    pub(crate) at: Point,
    /// Wait at its end, s.
    pub(crate) wait_s: f64,
}

/// Somebody with their way.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Walker {
    /// The robot or a human.
    pub(crate) agent: AgentId,
    /// Radius of the body, m.
    pub(crate) radius_m: f64,
    /// Pace at which they want to walk, m/s.
    pub(crate) speed_mps: f64,
    /// Where they begin, and where they look.
    pub(crate) start: Pose,
    /// When they begin, from the first tick of the run, s.
    pub(crate) from_s: f64,
    /// Where they go; at least one, the last of which is their end.
    pub(crate) legs: Vec<Leg>,
}

impl Walker {
    /// Where the way ends.
    pub(crate) fn end(&self) -> Point {
        self.legs.last().map_or_else(|| self.start.point(), |leg| leg.at)
    }

    /// Where what a format leaves behind of them stood.
    pub(crate) fn place(&self) -> String {
        format!("paths.json {}", self.agent)
    }

    /// Notes the waits of somebody who has some, for a format without.
    pub(crate) fn note_waits(&self, why: &str, losses: &mut Losses) {
        if self.legs.iter().any(|leg| leg.wait_s > 0.0) {
            losses.note("waits of people", self.place(), why);
        }
    }

    /// Notes somebody who comes later, for a format in which everybody is there from the first tick.
    pub(crate) fn note_absence(&self, losses: &mut Losses) {
        if self.from_s > 0.0 {
            losses.note("absence of people", self.place(), "everybody is there from the beginning");
        }
    }
}

/// Length of the run, s; 0 without one.
pub(crate) fn length_s(scenario: &Scenario) -> f64 {
    let frames = scenario.recording.as_ref().map(|run| &run.frames);
    let ends = frames.and_then(|frames| Some((frames.first()?.tick, frames.last()?.tick)));
    ends.map_or(0.0, |(first, last)| secs(last.saturating_sub(first)))
}

/// The robot, if it has a way or a track, and all people.
///
/// # Errors
/// Somebody with neither a way nor a track.
pub(crate) fn walkers(scenario: &Scenario) -> Result<Vec<Walker>, Unusable> {
    let robot = walker(scenario, AgentId::Robot, &scenario.paths.robot, None);
    let mut walkers: Vec<Walker> = robot.into_iter().collect();
    for human in &scenario.proposal.humans {
        let nodes = scenario.paths.humans.get(&human.id).map_or(&[][..], Vec::as_slice);
        let Some(walker) = walker(scenario, human.id.into(), nodes, human.speed_mps) else {
            let problem = format!("{} has neither a path nor a track, so it begins nowhere", human.id);
            return Err(Unusable::new("paths.json humans", problem, "export a bundle with paths"));
        };
        walkers.push(walker);
    }
    Ok(walkers)
}

fn walker(
    scenario: &Scenario,
    agent: AgentId,
    nodes: &[socrates_model::NodeId],
    wished_mps: Option<f64>,
) -> Option<Walker> {
    let way = scenario.location.graph.polyline(nodes);
    let run = scenario.recording.as_ref();
    let absent = run.and_then(|run| run.header.absent());
    // The robot is whoever is tested: it begins where its path does, not where one of them was.
    let tracked = run.filter(|_| agent != AgentId::Robot || way.is_empty());
    let track: Vec<&AgentState> =
        tracked.map_or_else(Vec::new, |run| run.track(agent).filter(|state| state.is_there(absent)).collect());
    let first_tick = run.and_then(|run| run.frames.first()).map_or(0, |state| state.tick);
    let info = run.and_then(|run| run.header.agents.iter().find(|info| info.agent == agent));
    let start = match (track.first(), way.as_slice()) {
        (Some(state), _) => Pose::new(state.x, state.y, super::frames::angle(state.yaw)),
        (None, [only]) => Pose::new(only.x, only.y, 0.0),
        (None, [here, next, ..]) => Pose::new(here.x, here.y, libm::atan2(next.y - here.y, next.x - here.x)),
        (None, []) => return None,
    };
    let waits = if agent == AgentId::Robot { Vec::new() } else { waits(&track) };
    let mut legs = legs(&way, &track, &waits, &start.point());
    if legs.is_empty() {
        legs.push(Leg { at: way.last().copied().unwrap_or_else(|| start.point()), wait_s: 0.0 });
    }
    let radius_m = info.map(|info| info.radius_m).filter(|radius| *radius > 0.0);
    let fallback_m = if agent == AgentId::Robot { scenario.robot_radius_m } else { RADIUS_M };
    let speed_mps = info.map(|info| info.speed_mps).filter(|speed| *speed > 0.0).or(wished_mps);
    Some(Walker {
        agent,
        radius_m: micro(radius_m.unwrap_or(fallback_m)),
        speed_mps: micro(speed_mps.unwrap_or(PACE_MPS)),
        start: Pose::new(micro(start.x), micro(start.y), micro(start.yaw)),
        from_s: track.first().map_or(0.0, |state| micro(secs(state.tick.saturating_sub(first_tick)))),
        legs,
    })
}

/// Standing of somebody in their track.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wait {
    /// Place in the track at which it begins.
    from: usize,
    /// Where.
    at: Point,
    /// How long, s.
    secs: f64,
}

fn waits(track: &[&AgentState]) -> Vec<Wait> {
    let mut waits = Vec::new();
    let mut place = 0;
    while let Some(here) = track.get(place) {
        let stays = |state: &&&AgentState| (state.point() - here.point()).norm() <= STILL_M;
        let count = track.iter().skip(place).take_while(stays).count();
        let last = track.get(place + count.saturating_sub(1)).unwrap_or(here);
        let stood_s = secs(last.tick.saturating_sub(here.tick));
        if stood_s >= LEAST_WAIT_S {
            waits.push(Wait { from: place, at: last.point(), secs: stood_s });
            place += count;
        } else {
            place += 1;
        }
    }
    waits
}

/// Way points and waits in the order of the run; what the run did not come to follows at the end.
fn legs(way: &[Point], track: &[&AgentState], waits: &[Wait], start: &Point) -> Vec<Leg> {
    let passed = passed(way, track);
    let mut points = way.iter().zip(&passed).peekable();
    // Nobody walks to where they stand.
    while way.len() > 1 && points.next_if(|(at, _)| (*at - start).norm() <= NEAR_M).is_some() {}
    let mut legs: Vec<Leg> = Vec::new();
    let place = |at: &Point, wait_s: f64| Leg { at: Point::new(micro(at.x), micro(at.y)), wait_s: micro(wait_s) };
    for wait in waits {
        while let Some((at, _)) = points.next_if(|(_, when)| when.is_some_and(|when| when <= wait.from)) {
            legs.push(place(at, 0.0));
        }
        // A way point at which somebody waits is the wait.
        while legs.last().is_some_and(|leg| leg.wait_s <= 0.0 && (leg.at - wait.at).norm() <= NEAR_M) {
            legs.pop();
        }
        while points.next_if(|(at, _)| (*at - wait.at).norm() <= NEAR_M).is_some() {}
        legs.push(place(&wait.at, wait.secs));
    }
    legs.extend(points.map(|(at, _)| place(at, 0.0)));
    legs
}

/// At which place of the track each way point was passed, in order; nothing for those after the last one that was.
fn passed(way: &[Point], track: &[&AgentState]) -> Vec<Option<usize>> {
    let mut from = 0;
    let mut passed: Vec<Option<usize>> = Vec::with_capacity(way.len());
    for at in way {
        let near = track.iter().skip(from).position(|state| (state.point() - at).norm() <= NEAR_M);
        from += near.unwrap_or_default();
        passed.push(near.map(|_| from));
    }
    // Whoever cut a corner passed it with the next one.
    let mut next = None;
    for when in passed.iter_mut().rev() {
        next = when.or(next);
        *when = next;
    }
    passed
}

/// Seconds of ticks.
fn secs(ticks: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a run has far fewer than 2^53 ticks")]
    let ticks = ticks as f64;
    ticks * STEP_SECS
}

#[cfg(test)]
mod tests {
    use socrates_model::HumanId;

    use super::*;

    fn track(places: &[(u64, f64, f64)]) -> Vec<AgentState> {
        let agent = AgentId::Human(HumanId::new(1));
        let state = |&(tick, x, y): &(u64, f64, f64)| AgentState {
            tick,
            agent: 1,
            flags: AgentState::flags(agent, None, 0),
            x,
            y,
            yaw: 0.0,
            vx: 0.0,
            vy: 0.0,
            omega: 0.0,
        };
        places.iter().map(state).collect()
    }

    /// One meter a second to x = 3, 4 s there, then on to x = 6.
    fn walk() -> Vec<AgentState> {
        let x = |tick: u64| match tick {
            0..300 => tick as f64 * 0.01,
            300..700 => 3.0,
            _ => 3.0 + (tick - 700) as f64 * 0.01,
        };
        track(&(0..=1000).map(|tick| (tick, x(tick), 0.0)).collect::<Vec<_>>())
    }

    #[test]
    fn a_wait_of_the_run_stands_between_the_way_points_around_it() {
        let states = walk();
        let track: Vec<&AgentState> = states.iter().collect();
        let waits = waits(&track);
        assert_eq!(waits.len(), 1, "{waits:?}");
        // They come and go within the distance that counts as standing.
        assert!((4.0..=4.4).contains(&waits[0].secs) && (waits[0].at.x - 3.0).abs() < 0.16, "{waits:?}");
        let way = [0.0, 1.6, 3.1, 5.0, 9.0].map(|x| Point::new(x, 0.0));
        let legs = legs(&way, &track, &waits, &way[0]);
        let told: Vec<(i32, bool)> = legs.iter().map(|leg| (leg.at.x.round() as i32, leg.wait_s > 0.0)).collect();
        assert_eq!(told, [(2, false), (3, true), (5, false), (9, false)]);
    }

    #[test]
    fn a_corner_that_was_cut_is_passed_with_the_next_one() {
        let states = walk();
        let track: Vec<&AgentState> = states.iter().collect();
        let way = [(0.0, 0.0), (1.0, 2.0), (2.0, 0.0), (9.0, 0.0)].map(|(x, y)| Point::new(x, y));
        let passed = passed(&way, &track);
        assert_eq!((passed[1], passed[3]), (passed[2], None));
        assert!(passed[2].is_some_and(|when| (125..=200).contains(&when)), "{passed:?}");
    }
}
