//! When a run is over, and who is stuck.

use std::collections::BTreeMap;

use socrates_model::{AgentId, EventKind, HumanId, Point};

use crate::recorder::Recorder;
use crate::setup::MAX_AUTO_S;

/// No progress for so long is stuck, s.
const STUCK_S: f64 = 20.0;
/// Progress that counts, m.
const PROGRESS_M: f64 = 0.3;
/// A robot that has come so far from where it was, m, is not stuck either: a planner may go another way than the intended one.
const ELSEWHERE_M: f64 = 3.0;
/// A robot stuck for so long ends the run, s.
const STUCK_END_S: f64 = 45.0;
/// After the robot's arrival the run goes on for at least so long, s.
const AFTER_ARRIVAL_S: f64 = 5.0;
/// After the last encounter the run goes on until everybody is done, at most so long, s; longer only for people on the way to a stated
/// place.
const AFTER_ENCOUNTER_S: f64 = 8.0;
/// After the robot's arrival people who are still under way get at most so long, s.
const PEOPLE_S: f64 = 20.0;

/// How things stand at a tick.
#[derive(Debug, Clone)]
pub(crate) struct Standing {
    pub(crate) now_s: f64,
    /// Progress of the robot along its intended way, whether it waits on purpose, and when it arrived.
    pub(crate) robot: Option<(f64, bool, Option<f64>)>,
    /// Where the robot is.
    pub(crate) robot_at: Option<Point>,
    pub(crate) arrived: bool,
    pub(crate) people_done: bool,
    /// Whether a human is still on the way to a place that is stated for them.
    pub(crate) under_way: bool,
    pub(crate) met: usize,
    pub(crate) to_meet: usize,
    /// Progress of each human and whether it should be moving but hardly does.
    pub(crate) walkers: Vec<(HumanId, f64, bool)>,
}

/// The end rule with its memory.
#[derive(Debug, Clone)]
pub(crate) struct Ending {
    duration_s: Option<f64>,
    arrival_told: bool,
    met: usize,
    last_met_s: f64,
    since: BTreeMap<AgentId, (f64, f64, bool)>,
    robot_mark: Option<Point>,
    done_since_s: Option<f64>,
}

impl Ending {
    pub(crate) const fn new(duration_s: Option<f64>) -> Self {
        Self {
            duration_s,
            arrival_told: false,
            met: 0,
            last_met_s: 0.0,
            since: BTreeMap::new(),
            robot_mark: None,
            done_since_s: None,
        }
    }

    /// The reason why the run ends now, if it does.
    pub(crate) fn step(&mut self, standing: &Standing, recorder: &mut Recorder) -> Option<&'static str> {
        let now = standing.now_s;
        if standing.met > self.met {
            self.met = standing.met;
            self.last_met_s = now;
        }
        let mut stuck_s = 0.0;
        if let Some((s, waiting, arrived)) = standing.robot {
            if arrived.is_some() && !self.arrival_told {
                self.arrival_told = true;
                recorder.tell(EventKind::RobotArrived);
            }
            let excused = waiting || arrived.is_some() || self.is_elsewhere(standing.robot_at);
            stuck_s = self.stuck(AgentId::Robot, s, excused, now, recorder);
        }
        for (human, s, slow) in &standing.walkers {
            self.stuck(AgentId::Human(*human), *s, !*slow, now, recorder);
        }
        if let Some(duration) = self.duration_s {
            return (now + 1e-9 >= duration).then_some("time");
        }
        if now >= MAX_AUTO_S {
            return Some("time");
        }
        if stuck_s >= STUCK_END_S {
            return Some("stuck");
        }
        self.done(standing).then_some("done")
    }

    /// Whether the robot has come away from where it was when this was last so.
    fn is_elsewhere(&mut self, at: Option<Point>) -> bool {
        let elsewhere = at.zip(self.robot_mark).is_none_or(|(at, mark)| (at - mark).norm() > ELSEWHERE_M);
        if elsewhere {
            self.robot_mark = at;
        }
        elsewhere
    }

    fn done(&mut self, standing: &Standing) -> bool {
        let now = standing.now_s;
        if !standing.people_done {
            self.done_since_s = None;
        }
        let done_s = if standing.people_done { now - *self.done_since_s.get_or_insert(now) } else { 0.0 };
        let Some((_, _, arrived)) = standing.robot else {
            return standing.people_done && done_s >= 2.0 && now >= 10.0;
        };
        let Some(arrived_s) = arrived.filter(|_| standing.arrived) else { return false };
        let since = now - arrived_s;
        if since < AFTER_ARRIVAL_S {
            return false;
        }
        let all_met = self.met >= standing.to_meet && now - self.last_met_s >= AFTER_ENCOUNTER_S && !standing.under_way;
        standing.people_done || all_met || since >= PEOPLE_S
    }

    /// Seconds without progress; tells it once per standstill.
    fn stuck(&mut self, agent: AgentId, s: f64, excused: bool, now: f64, recorder: &mut Recorder) -> f64 {
        let (mark, since, told) = self.since.entry(agent).or_insert((s, now, false));
        if excused || (s - *mark).abs() > PROGRESS_M {
            (*mark, *since, *told) = (s, now, false);
        }
        let still = now - *since;
        if still >= STUCK_S && !*told {
            *told = true;
            recorder.tell(EventKind::Stuck { agent });
        }
        still
    }
}
