//! The whole: a driver of the robot as Nav2 drives it.

use socrates_model::{Command, Observation, Pose, RobotDriver};

use super::error::{ErrorLog, NavError};
use super::goal::GoalChecker;
use super::params::StackParams;
use super::path::PathHandler;
use super::progress::ProgressChecker;
use super::recovery::{Going, Recovery, Running};
use super::smoother::VelocitySmoother;
use super::waypoints::WaypointFollower;
use crate::controller::{Controller, Following, NoControl, Twist};
use crate::costmap::{Costmap, LayeredCostmap, Scan, Sensed};
use crate::mission::Mission;
use crate::navfn::NavFn;

/// Calls come at whole ticks: what is due within this is due, s.
const SLACK_S: f64 = 1e-6;

/// When something that is done so often is due.
#[derive(Debug, Clone, Copy)]
struct Every {
    period_s: f64,
    next_s: f64,
}

impl Every {
    fn hz(rate: f64) -> Self {
        Self { period_s: 1.0 / rate, next_s: f64::NEG_INFINITY }
    }

    fn is_due(&mut self, now_s: f64) -> bool {
        if now_s + SLACK_S < self.next_s {
            return false;
        }
        // Kept in step, unless it was not asked for long.
        let next_s = self.next_s + self.period_s;
        self.next_s = if next_s > now_s { next_s } else { now_s + self.period_s };
        true
    }
}

/// What was tried for the present waypoint.
#[derive(Debug, Clone, Copy, Default)]
struct Tries {
    recoveries: u32,
    /// Place in the round of recoveries.
    turn: usize,
    /// Recoveries in a row that failed.
    failed: usize,
    /// A costmap was already cleared because of the planner, because of the controller.
    planner: bool,
    controller: bool,
}

/// Nav2's navigation: costmaps, planner, controller, recoveries, waypoints.
#[derive(Debug)]
pub struct Stack {
    params: StackParams,
    lidar_range_m: f64,
    global: LayeredCostmap,
    local: LayeredCostmap,
    navfn: NavFn,
    path: PathHandler,
    controller: Box<dyn Controller>,
    goal: GoalChecker,
    /// Measured speeds below these read as 0.
    least_speeds: [f64; 3],
    progress: ProgressChecker,
    waypoints: WaypointFollower,
    smoother: VelocitySmoother,
    errors: ErrorLog,
    scan: Option<Scan>,
    scans: Every,
    globals: Every,
    locals: Every,
    plans: Every,
    /// No path yet for the present waypoint, or one that must be made anew.
    unplanned: bool,
    /// When the controller last had a command, s.
    commanded_s: Option<f64>,
    recovery: Option<Running>,
    tries: Tries,
}

impl Stack {
    /// A stack for a mission.
    #[must_use]
    pub fn new(params: StackParams, mission: &Mission, controller: Box<dyn Controller>) -> Self {
        let costmap = |of| LayeredCostmap::new(of, &mission.grid, params.robot_radius);
        Self {
            lidar_range_m: mission.robot.lidar_range_m,
            global: costmap(&params.global_costmap),
            local: costmap(&params.local_costmap),
            navfn: NavFn::new(&params.navfn),
            path: PathHandler::new(&params.path),
            controller,
            goal: GoalChecker::new(&params.goal),
            least_speeds: params.least_speeds,
            progress: ProgressChecker::new(&params.progress),
            waypoints: WaypointFollower::new(&params.waypoints, &mission.waypoints),
            smoother: VelocitySmoother::new(&params.smoother),
            errors: ErrorLog::default(),
            scan: None,
            scans: Every::hz(params.scan_frequency),
            globals: Every::hz(params.global_costmap.update_frequency_hz),
            locals: Every::hz(params.local_costmap.update_frequency_hz),
            plans: Every::hz(params.planner_frequency),
            unplanned: true,
            commanded_s: None,
            recovery: None,
            tries: Tries::default(),
            params,
        }
    }

    /// Errors so far.
    #[must_use]
    pub const fn errors(&self) -> &ErrorLog {
        &self.errors
    }

    /// The waypoints and which of them were missed.
    #[must_use]
    pub const fn waypoints(&self) -> &WaypointFollower {
        &self.waypoints
    }

    /// The map that plans are made on.
    #[must_use]
    pub const fn global_costmap(&self) -> &Costmap {
        self.global.map()
    }

    /// The map that the controller sees.
    #[must_use]
    pub const fn local_costmap(&self) -> &Costmap {
        self.local.map()
    }

    /// What is left of the path.
    #[must_use]
    pub fn path(&self) -> &[Pose] {
        self.path.left()
    }

    /// The recovery under way.
    #[must_use]
    pub fn recovery(&self) -> Option<Recovery> {
        self.recovery.map(|running| running.kind)
    }

    /// Takes a scan and updates the costmaps, each when it is due.
    fn look(&mut self, seen: &Observation<'_>, now_s: f64) {
        if self.scans.is_due(now_s) {
            let ranges_m = (seen.lidar)();
            self.scan = Some(Scan { from: seen.pose, ranges_m, range_max_m: self.lidar_range_m });
        }
        let (global, local) = (self.globals.is_due(now_s), self.locals.is_due(now_s));
        self.update(seen, now_s, global, local);
    }

    fn update(&mut self, seen: &Observation<'_>, now_s: f64, global: bool, local: bool) {
        let sensed = Sensed {
            now_s,
            pose: seen.pose,
            radius_m: self.params.robot_radius,
            footprint: &self.params.footprint,
            scan: self.scan.as_ref(),
            people: seen.people,
        };
        if global {
            self.global.update(&sensed);
        }
        if local {
            self.local.update(&sensed);
        }
    }

    /// Plans when it is due; after a failure once more on a cleared map. False where it has to recover.
    fn plan(&mut self, seen: &Observation<'_>, goal: &Pose, now_s: f64) -> bool {
        if !self.plans.is_due(now_s) && !self.unplanned {
            return true;
        }
        loop {
            let mut path = self.path.set(Vec::new());
            match self.navfn.plan_into(self.global.map(), &seen.pose, goal, &mut path) {
                Ok(()) => {
                    self.path.set(path);
                    self.unplanned = false;
                    self.tries.planner = false;
                    return true;
                }
                Err(error) => self.errors.add(error.into()),
            }
            self.unplanned = true;
            if self.tries.planner {
                return false;
            }
            self.tries.planner = true;
            self.global.clear();
            self.update(seen, now_s, true, false);
        }
    }

    /// The robot's speed as the odometry of Nav2 tells it: what is slower than its noise is 0.
    fn measured(&self, seen: &Observation<'_>) -> Twist {
        let read = |speed: f64, least: f64| if speed.abs() < least { 0.0 } else { speed };
        let [x, y, turning] = self.least_speeds;
        Twist { vx: read(seen.v, x), vy: read(seen.vy, y), omega: read(seen.omega, turning) }
    }

    /// The controller's command. `None` where it has to recover.
    fn control(&mut self, seen: &Observation<'_>, goal: &Pose, now_s: f64) -> Option<Twist> {
        let speed = self.measured(seen);
        let error = if self.progress.gets_on(&seen.pose, now_s) {
            let map = self.local.map();
            let plan = self.path.ahead(&seen.pose.point(), map);
            let command = if plan.is_empty() {
                Err(NoControl::NoPlan)
            } else {
                self.controller.command(&Following {
                    pose: seen.pose,
                    speed,
                    plan,
                    goal: *goal,
                    costmap: map,
                    footprint: &self.params.footprint,
                    speed_share: 1.0,
                })
            };
            match command {
                Ok(twist) => {
                    self.commanded_s = Some(now_s);
                    return Some(twist);
                }
                Err(reason) => {
                    let since_s = *self.commanded_s.get_or_insert(now_s);
                    if now_s - since_s <= self.params.failure_tolerance {
                        return Some(Twist::default());
                    }
                    reason.into()
                }
            }
        } else {
            NavError::FailedToMakeProgress
        };
        self.errors.add(error);
        self.restart();
        if self.tries.controller {
            return None;
        }
        self.tries.controller = true;
        self.local.clear();
        self.update(seen, now_s, false, true);
        Some(Twist::default())
    }

    /// The controller begins anew.
    fn restart(&mut self) {
        self.controller.reset();
        self.progress.reset();
        self.commanded_s = None;
    }

    /// The next waypoint begins.
    fn next_goal(&mut self) {
        self.restart();
        self.goal.reset();
        self.path.clear();
        self.unplanned = true;
        self.recovery = None;
        self.tries = Tries::default();
    }

    /// Begins the next recovery, or gives the waypoint up.
    fn recover(&mut self, seen: &Observation<'_>, now_s: f64) {
        let kind = Recovery::ROUND.get(self.tries.turn % Recovery::ROUND.len()).copied();
        let all_failed = self.tries.failed >= Recovery::ROUND.len();
        let Some(kind) = kind.filter(|_| self.tries.recoveries < self.params.recovery.number_of_retries && !all_failed)
        else {
            self.errors.add(NavError::GivenUp);
            self.waypoints.failed();
            self.next_goal();
            return;
        };
        self.tries.turn += 1;
        self.path.clear();
        if kind == Recovery::ClearCostmaps {
            self.global.clear();
            self.local.clear();
            self.update(seen, now_s, true, true);
        }
        self.recovery = Some(Running::new(kind, &seen.pose, now_s));
    }

    /// The next command of the recovery under way.
    fn recovering(&mut self, mut running: Running, seen: &Observation<'_>, now_s: f64) -> Twist {
        let around = (self.local.map(), self.params.footprint.as_slice());
        match running.step(&self.params.recovery, &seen.pose, now_s, around) {
            Going::On(twist) => {
                self.recovery = Some(running);
                return twist;
            }
            Going::Done => {
                self.recovery = None;
                self.tries = Tries {
                    recoveries: self.tries.recoveries + 1,
                    turn: self.tries.turn,
                    failed: 0,
                    planner: false,
                    controller: false,
                };
                self.restart();
                self.unplanned = true;
            }
            Going::Failed => {
                self.tries.failed += 1;
                self.recover(seen, now_s);
            }
        }
        Twist::default()
    }

    /// The wanted speed, and whether the robot stands on purpose.
    fn want(&mut self, seen: &Observation<'_>, now_s: f64) -> (Twist, bool) {
        let stand = Twist::default();
        if self.waypoints.pauses(now_s) {
            return (stand, true);
        }
        let Some(goal) = self.waypoints.goal() else { return (stand, self.waypoints.missed().is_empty()) };
        if self.goal.reached(&seen.pose, &self.measured(seen), &goal, self.path.left_m()) {
            self.waypoints.reached(now_s);
            self.next_goal();
            return (stand, true);
        }
        if let Some(running) = self.recovery {
            return (self.recovering(running, seen, now_s), false);
        }
        let twist = if self.plan(seen, &goal, now_s) { self.control(seen, &goal, now_s) } else { None };
        if twist.is_none() {
            self.recover(seen, now_s);
        }
        (twist.unwrap_or(stand), false)
    }
}

impl RobotDriver for Stack {
    fn rate_hz(&self) -> f64 {
        self.params.controller_frequency
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let now_s = seen.time.secs();
        self.look(seen, now_s);
        let (wanted, waiting) = self.want(seen, now_s);
        let twist = self.smoother.smooth(Some(wanted), now_s, 1.0 / self.params.controller_frequency);
        Command { v: twist.vx, vy: twist.vy, omega: twist.omega, gesture: None, waiting }
    }
}
