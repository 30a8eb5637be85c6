//! A recording as one track per agent, checked once.

use socrates_model::geometry::wrap_angle;
use socrates_model::nalgebra::Vector2;
use socrates_model::time::STEP_SECS;
use socrates_model::{AgentId, AgentState, Gesture, HumanId, Point, Recording, Vector};

use crate::series::Series;

/// Why a recording cannot be read as tracks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackFault {
    /// There is no tick, or no agent.
    #[error("the recording holds `{ticks}` ticks of `{agents}` agents; at least 2 ticks of 1 agent are needed")]
    Empty {
        /// Ticks.
        ticks: usize,
        /// Agents.
        agents: usize,
    },
    /// A frame does not hold the agents of the header, in their order.
    #[error("at tick `{tick}` the frame holds agent `{found}` where the header names {wanted}")]
    Mixed {
        /// Tick.
        tick: u64,
        /// Frame number of the agent found.
        found: u32,
        /// Agent of the header.
        wanted: AgentId,
    },
    /// The frames do not fill whole ticks.
    #[error("`{states}` states do not fill ticks of `{agents}` agents")]
    Torn {
        /// States recorded.
        states: usize,
        /// Agents of the header.
        agents: usize,
    },
    /// A state is NaN or infinite.
    #[error("{agent} has the {what} `{value}` at {time_s:.2} s: states must be finite numbers")]
    NotFinite {
        /// Who.
        agent: AgentId,
        /// When, s.
        time_s: f64,
        /// Which part of the state.
        what: &'static str,
        /// Its value: NaN or infinite.
        value: String,
    },
    /// The header names an agent twice.
    #[error("the header names {agent} `{times}` times: each agent has one track")]
    Twice {
        /// Who.
        agent: AgentId,
        /// How often.
        times: usize,
    },
    /// Time does not rise.
    #[error("tick `{after}` follows tick `{before}`: ticks must rise")]
    Backwards {
        /// Earlier tick.
        before: u64,
        /// Tick that follows it.
        after: u64,
    },
}

/// State of one agent at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// Position.
    pub at: Point,
    /// Velocity, m/s; by differences where the recording holds none.
    pub velocity: Vector,
    /// Heading, rad.
    pub yaw: f64,
    /// Gesture being made.
    pub gesture: Option<Gesture>,
    /// Index of the running leaf in the header's list, 0 for none.
    pub leaf: u16,
    /// Whether the agent is there: somebody recorded comes and goes, and its state before and after means nothing.
    pub there: bool,
}

impl Sample {
    /// Speed, m/s.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.velocity.norm()
    }

    /// Unit vector of the heading.
    #[must_use]
    pub fn facing(&self) -> Vector {
        Vector2::new(libm::cos(self.yaw), libm::sin(self.yaw))
    }

    /// Direction of travel: of the velocity when it walks, else the heading.
    #[must_use]
    pub fn course(&self) -> Vector {
        let speed = self.speed();
        if speed > MOVING_MPS { self.velocity / speed } else { self.facing() }
    }

    /// Signed angle from the heading to a point, rad.
    #[must_use]
    pub fn bearing(&self, to: &Point) -> f64 {
        let line = to - self.at;
        wrap_angle(libm::atan2(line.y, line.x) - self.yaw)
    }
}

/// Faster than this is moving, slower is stopped, m/s.
pub const MOVING_MPS: f64 = 0.1;

/// One agent through the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Who.
    pub agent: AgentId,
    /// Radius, m.
    pub radius_m: f64,
    /// Desired speed, m/s.
    pub speed_mps: f64,
    /// Role word.
    pub role: String,
    /// States in time order, the same times for every agent.
    pub samples: Vec<Sample>,
}

/// All agents.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracks {
    /// The robot, if there is one.
    pub robot: Option<Track>,
    /// Humans in order of their id.
    pub humans: Vec<Track>,
}

impl Tracks {
    /// Reads a recording.
    ///
    /// # Errors
    /// The first thing that makes it unreadable, see [`TrackFault`].
    pub fn read(recording: &Recording) -> Result<Self, TrackFault> {
        let agents = &recording.header.agents;
        let ticks = recording.ticks();
        if agents.is_empty() || ticks < 2 {
            return Err(TrackFault::Empty { ticks, agents: agents.len() });
        }
        if recording.frames.len() != ticks * agents.len() {
            return Err(TrackFault::Torn { states: recording.frames.len(), agents: agents.len() });
        }
        for info in agents {
            let times = agents.iter().filter(|other| other.agent == info.agent).count();
            if times > 1 {
                return Err(TrackFault::Twice { agent: info.agent, times });
            }
        }
        let absent = recording.header.absent();
        let step = recording.header.step_s;
        let step = if step.is_finite() && step > 0.0 { step } else { STEP_SECS };
        let mut tracks: Vec<Track> = Vec::with_capacity(agents.len());
        for info in agents {
            tracks.push(Track {
                agent: info.agent,
                radius_m: info.radius_m,
                speed_mps: info.speed_mps,
                role: info.role.clone(),
                samples: Vec::with_capacity(ticks),
            });
        }
        let mut before: Option<u64> = None;
        for frame in recording.frames.chunks_exact(agents.len()) {
            let tick = frame.first().map_or(0, |state| state.tick);
            if let Some(before) = before.filter(|before| *before >= tick) {
                return Err(TrackFault::Backwards { before, after: tick });
            }
            before = Some(tick);
            #[expect(clippy::cast_precision_loss, reason = "2^53 ticks are millions of years")]
            let t = tick as f64 * step;
            for (state, track) in frame.iter().zip(&mut tracks) {
                if state.agent != track.agent.number() {
                    return Err(TrackFault::Mixed { tick, found: state.agent, wanted: track.agent });
                }
                if ![state.x, state.y, state.yaw, state.vx, state.vy].iter().all(|value| value.is_finite()) {
                    return Err(not_finite(track.agent, t, state));
                }
                let leaf = state.leaf();
                track.samples.push(Sample {
                    t,
                    at: state.point(),
                    velocity: Vector2::new(state.vx, state.vy),
                    yaw: state.yaw,
                    gesture: state.gesture(),
                    leaf,
                    there: absent != Some(leaf),
                });
            }
        }
        for track in &mut tracks {
            track.fill_velocity();
        }
        let (robots, mut humans): (Vec<Track>, Vec<Track>) =
            tracks.into_iter().partition(|track| track.agent == AgentId::Robot);
        // Who never comes is not in the run.
        humans.retain(|track| track.samples.iter().any(|sample| sample.there));
        humans.sort_by_key(|track| track.agent);
        Ok(Self { robot: robots.into_iter().next(), humans })
    }

    /// Every agent, the robot first.
    pub fn all(&self) -> impl Iterator<Item = &Track> {
        self.robot.iter().chain(&self.humans)
    }

    /// The track of an agent.
    #[must_use]
    pub fn of(&self, agent: AgentId) -> Option<&Track> {
        self.all().find(|track| track.agent == agent)
    }

    /// The track of a human.
    #[must_use]
    pub fn human(&self, id: HumanId) -> Option<&Track> {
        self.of(AgentId::Human(id))
    }

    /// Last time of the recording, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.all().next().and_then(|track| track.samples.last()).map_or(0.0, |sample| sample.t)
    }

    /// The tracks up to a time.
    #[must_use]
    pub fn until(&self, end_s: f64) -> Self {
        self.map(|track| {
            let end = track.samples.partition_point(|sample| sample.t <= end_s + 1e-9);
            track.samples.get(..end).unwrap_or_default().to_vec()
        })
    }

    /// The tracks with samples at least `step_s` apart: as recorded when that is coarser.
    #[must_use]
    pub fn thinned(&self, step_s: f64) -> Self {
        self.map(|track| {
            let mut next = f64::NEG_INFINITY;
            let mut kept = Vec::new();
            for sample in &track.samples {
                if sample.t >= next - 1e-9 {
                    kept.push(*sample);
                    next = sample.t + step_s;
                }
            }
            kept
        })
    }

    fn map(&self, change: impl Fn(&Track) -> Vec<Sample>) -> Self {
        let one = |track: &Track| track.with(change(track));
        Self { robot: self.robot.as_ref().map(one), humans: self.humans.iter().map(one).collect() }
    }
}

impl Track {
    fn head(&self) -> Self {
        Self {
            agent: self.agent,
            radius_m: self.radius_m,
            speed_mps: self.speed_mps,
            role: self.role.clone(),
            samples: Vec::new(),
        }
    }

    /// The same agent with other samples.
    pub(crate) fn with(&self, samples: Vec<Sample>) -> Self {
        Self { samples, ..self.head() }
    }

    /// The human's id.
    #[must_use]
    pub const fn human(&self) -> Option<HumanId> {
        match self.agent {
            AgentId::Human(id) => Some(id),
            AgentId::Robot => None,
        }
    }

    /// Tracks from other tools often come without velocities: then they are taken from the positions.
    fn fill_velocity(&mut self) {
        if self.samples.iter().any(|sample| sample.velocity != Vector::zeros()) {
            return;
        }
        let moves = self.samples.iter().zip(self.samples.iter().skip(1)).any(|(a, b)| (b.at - a.at).norm() > 1e-6);
        if !moves {
            return;
        }
        let points: Vec<(f64, Point)> = self.samples.iter().map(|sample| (sample.t, sample.at)).collect();
        let last = points.len().saturating_sub(1);
        for (index, sample) in self.samples.iter_mut().enumerate() {
            let (from, to) = (index.saturating_sub(1), (index + 1).min(last));
            if let (Some((t0, p0)), Some((t1, p1))) = (points.get(from), points.get(to))
                && t1 > t0
            {
                sample.velocity = (p1 - p0) / (t1 - t0);
            }
        }
    }

    /// The states in which the agent is there.
    pub fn present(&self) -> impl DoubleEndedIterator<Item = &Sample> + Clone {
        self.samples.iter().filter(|sample| sample.there)
    }

    /// The states of two agents at the same times, while both are there.
    pub fn beside<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (&'a Sample, &'a Sample)> {
        self.samples.iter().zip(&other.samples).filter(|(mine, theirs)| mine.there && theirs.there)
    }

    /// A quantity of two agents over time, with holes while one of them is not there.
    pub fn between(&self, other: &Self, value: impl Fn(&Sample, &Sample) -> f64) -> Series {
        let each = self.samples.iter().zip(&other.samples);
        each.map(|(mine, theirs)| (mine.t, (mine.there && theirs.there).then(|| value(mine, theirs)))).collect()
    }

    /// A quantity of the agent over time, with holes while it is not there.
    pub fn curve(&self, value: impl Fn(&Sample) -> f64) -> Series {
        self.samples.iter().map(|sample| (sample.t, sample.there.then(|| value(sample)))).collect()
    }

    /// State at a time, straight between samples; `None` outside the recording and while the agent is not there.
    #[must_use]
    pub fn at(&self, t: f64) -> Option<Sample> {
        let index = self.samples.partition_point(|sample| sample.t < t);
        let before = index.checked_sub(1).and_then(|index| self.samples.get(index));
        between(before, self.samples.get(index)?, t)
    }

    /// The track on an even grid of times, so that sums over changes do not grow with the recording's rate.
    #[must_use]
    pub fn even(&self, step_s: f64) -> Vec<Sample> {
        let (Some(first), Some(last)) = (self.samples.first(), self.samples.last()) else { return Vec::new() };
        let mut found = Vec::new();
        let mut k = 0_u32;
        loop {
            let t = first.t + f64::from(k) * step_s;
            if t > last.t + 1e-9 || k == u32::MAX {
                return found;
            }
            found.extend(self.at(t.min(last.t)));
            k += 1;
        }
    }
}

/// State at a time after one sample and not after the next, straight between them; at the first sample there is none
/// before. `None` while the agent is not there.
pub(crate) fn between(before: Option<&Sample>, after: &Sample, t: f64) -> Option<Sample> {
    let Some(before) = before.filter(|_| (after.t - t).abs() >= 1e-12) else {
        return ((after.t - t).abs() < 1e-9 && after.there).then_some(*after);
    };
    if !(before.there && after.there) {
        return None;
    }
    let share = (t - before.t) / (after.t - before.t);
    Some(Sample {
        t,
        at: before.at + (after.at - before.at) * share,
        velocity: before.velocity + (after.velocity - before.velocity) * share,
        yaw: wrap_angle(before.yaw + wrap_angle(after.yaw - before.yaw) * share),
        ..*before
    })
}

/// The first part of a state that is not finite.
fn not_finite(agent: AgentId, time_s: f64, state: &AgentState) -> TrackFault {
    let parts = [("x", state.x), ("y", state.y), ("yaw", state.yaw), ("vx", state.vx), ("vy", state.vy)];
    let (what, value) = parts.into_iter().find(|(_, value)| !value.is_finite()).unwrap_or(("state", f64::NAN));
    TrackFault::NotFinite { agent, time_s, what, value: value.to_string() }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::fixture::{Walk, recording};

    #[test]
    fn a_state_that_is_not_finite_is_named_with_its_time() {
        let mut run = recording(&[Walk::robot(0.0, 0.0, 0.5, 0.0)], 2.0, 0.1);
        run.frames[7].x = f64::NAN;
        let fault = Tracks::read(&run).unwrap_err();
        assert!(matches!(&fault, TrackFault::NotFinite { agent: AgentId::Robot, what: "x", .. }));
        assert_eq!(fault.to_string(), "robot has the x `NaN` at 0.70 s: states must be finite numbers");
    }

    #[test]
    fn an_agent_named_twice_is_refused() {
        let run = recording(&[Walk::human(1, 0., 0., 1., 0.), Walk::human(1, 3., 0., 1., 0.)], 1.0, 0.1);
        let fault = Tracks::read(&run).unwrap_err();
        assert_eq!(fault.to_string(), "the header names human_1 `2` times: each agent has one track");
    }

    #[test]
    fn who_is_not_there_has_no_state() {
        let mut run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 3., 0., 1., 0.)], 2.0, 0.1);
        crate::fixture::absent(&mut run, 1, 0.0..0.45);
        let tracks = Tracks::read(&run).unwrap();
        let (robot, human) = (tracks.robot.as_ref().unwrap(), &tracks.humans[0]);
        assert_eq!((human.present().count(), robot.beside(human).count()), (16, 16));
        assert!(human.at(0.3).is_none() && human.at(0.45).is_none() && human.at(0.5).is_some());
        crate::fixture::absent(&mut run, 1, 0.0..3.0);
        assert!(Tracks::read(&run).unwrap().humans.is_empty());
    }

    #[test]
    fn velocities_are_taken_from_positions_where_there_are_none() {
        let mut run = recording(&[Walk::robot(0.0, 0.0, 0.5, 0.0)], 2.0, 0.1);
        for state in &mut run.frames {
            (state.vx, state.vy) = (0.0, 0.0);
        }
        let tracks = Tracks::read(&run).unwrap();
        assert!((tracks.robot.unwrap().samples[5].speed() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn states_between_samples_are_on_the_straight_line() {
        let run = recording(&[Walk::robot(0.0, 0.0, 1.0, 0.0)], 2.0, 0.1);
        let track = Tracks::read(&run).unwrap().robot.unwrap();
        assert!((track.at(0.55).unwrap().at.x - 0.55).abs() < 1e-9);
        assert!(track.at(2.5).is_none());
        assert_eq!(track.even(0.5).len(), 5);
    }

    #[test]
    fn ticks_that_do_not_rise_are_refused() {
        let mut run = recording(&[Walk::robot(0.0, 0.0, 1.0, 0.0)], 1.0, 0.1);
        run.frames[4].tick = 3;
        assert!(matches!(Tracks::read(&run), Err(TrackFault::Backwards { before: 3, after: 3 })));
    }
}
