//! `reference`: an actor rather than a test subject. It keeps to the intended way, plays the script, steps
//! round people who stand or come towards it, waits for those who cross, and asks after 3 s of waiting; before somebody who
//! does not let it pass it stops dodging.

use socrates_model::{
    Command, Door, Gesture, HumanId, Observation, Point, Polyline, RobotDriver, RobotModel, SeenPerson,
};

use crate::detour;
use crate::ground::{Ground, STANDING_MPS, closed_door_ahead, obstacles, waits_at_door};
use crate::mission::Mission;
use crate::overtaking::{self, Overtaking};
use crate::patience::Patience;
use crate::pursuit::{beside_people, face, left_m, safe_share, somebody_ahead, steer};
use crate::script::{Script, Wish};
use crate::waiting::{WaitingSpot, spot};

/// Calls per second.
const RATE_HZ: f64 = 20.0;
/// A plan round people is made anew after so long, s.
const REPLAN_S: f64 = 0.25;
/// A plan is wanted where somebody is nearer to the way than this (surface to surface), m.
const WANTED_GAP_M: f64 = 0.45;
/// People farther away than this are not planned for, m.
const PEOPLE_M: f64 = 5.5;
/// A way round people may be so many times as long as the way, and so much more, m: a longer one is a detour, and it waits.
const FARTHEST: f64 = 1.35;
const FARTHEST_M: f64 = 0.8;
/// A way round stays as long as it leads on so far, m, comes at most so much nearer to people than a new one, m, and is at most
/// so much longer, m; gaps are taken at steps of this length, m.
const KEPT_M: f64 = 1.5;
const KEPT_GAP_M: f64 = 0.05;
const KEPT_MORE_M: f64 = 0.3;
const GAP_STEP_M: f64 = 0.2;
/// Least overlap of a person with the way that blocks it, m.
const BLOCKS_M: f64 = 0.1;
/// Length of the way that is looked at for people, m.
const LOOK_M: f64 = 4.0;
/// A plan leads back to the way at most so far on, m, and so far before a door that is shut, m.
const WINDOW_M: f64 = 4.4;
const SHUT_M: f64 = 0.4;
/// After so long behind somebody it asks to be let through, s.
const ASK_AFTER_S: f64 = 3.0;
/// It asks again after so long, s.
const ASK_AGAIN_S: f64 = 8.0;
/// It waits at most so long for those who leave, s.
const LEAVERS_S: f64 = 45.0;
/// Gap it keeps to whom it follows, m.
const FOLLOW_GAP_M: f64 = 1.5;

/// The planner.
#[derive(Debug)]
pub(crate) struct Reference {
    robot: RobotModel,
    ground: Ground,
    doors: Vec<Door>,
    route: Polyline,
    s: f64,
    script: Script,
    plan: Option<(Polyline, f64)>,
    planned_s: f64,
    overtaking: Overtaking,
    waiting: Option<WaitingSpot>,
    waiting_since_s: Option<f64>,
    out_since_s: Option<f64>,
    patience: Patience,
    behind_s: f64,
    asked_s: f64,
    alone_s: f64,
}

impl Reference {
    pub(crate) fn new(mission: &Mission) -> Self {
        Self {
            robot: mission.robot,
            ground: Ground::new(mission),
            doors: mission.doors.clone(),
            route: Polyline::new(&mission.route),
            s: 0.0,
            script: Script::new(&mission.script, &mission.encounters),
            plan: None,
            planned_s: f64::NEG_INFINITY,
            overtaking: Overtaking::default(),
            waiting: None,
            waiting_since_s: None,
            out_since_s: None,
            patience: Patience::default(),
            behind_s: 0.0,
            asked_s: f64::NEG_INFINITY,
            alone_s: 0.0,
        }
    }

    /// Goes along the route, round people where that is free.
    fn go(&mut self, seen: &Observation<'_>, limit: f64) -> Command {
        let at = seen.pose.point();
        let now = seen.time.secs();
        if now - self.planned_s >= REPLAN_S {
            self.planned_s = now;
            let comes_up = self.comes_up(seen);
            let new = if comes_up { None } else { self.detour(seen) };
            self.plan = match (self.plan.take().filter(|_| !comes_up), new) {
                (Some((old, s)), Some(new)) if self.keeps(seen, (&old, s), &new) => Some((old, s)),
                (_, new) => new.map(|way| (way, 0.0)),
            };
        }
        if limit > 0.1
            && let Some(blocker) = self.patience.faces(seen, self.s, &self.route.direction(self.s + 0.3))
        {
            let command = face(seen, &blocker, 2.4, self.robot.omega_max_radps);
            return self.asking(seen, command, 0.0);
        }
        let limit = limit.min(beside_people(seen, &self.robot) * self.robot.v_max_mps);
        let (command, share) = if let Some((plan, s)) = &mut self.plan {
            *s = plan.project_within(&at, *s, *s + 1.0).0;
            let share = safe_share(seen, plan, *s, &self.robot, 0.06);
            (steer(seen, plan, *s, share * limit, &self.robot), share)
        } else {
            let share = safe_share(seen, &self.route, self.s, &self.robot, 0.36);
            (steer(seen, &self.route, self.s, share * limit, &self.robot), share)
        };
        self.asking(seen, command, share)
    }

    /// Past somebody slower, in a lane beside the way, as fast as it can: beside them for as short a time as may be.
    fn pass(&mut self, seen: &Observation<'_>, whom: HumanId) -> Option<Command> {
        let lane = self.overtaking.lane(seen, whom, (&self.route, self.s), &self.ground, &self.robot)?;
        if overtaking::is_taken(seen, whom, &lane, &self.robot) {
            return None;
        }
        self.plan = None;
        Some(steer(seen, &lane, 0.0, self.robot.v_max_mps, &self.robot))
    }

    /// Whether it drives up to whoever stands in the middle of its way instead of round them: it is to be blocked by somebody first.
    /// Among walking people it does not: they would shut it in.
    fn comes_up(&self, seen: &Observation<'_>) -> bool {
        let near = || seen.people.iter().filter(|person| (person.at - seen.pose.point()).norm() < PEOPLE_M);
        let stands = |person: &SeenPerson| person.velocity.norm() < STANDING_MPS;
        let in_way = |person: &SeenPerson| {
            let (s, aside) = self.route.project_within(&person.at, self.s, self.s + PEOPLE_M);
            s > self.s && aside < self.robot.radius_m + person.radius_m - BLOCKS_M
        };
        self.script.is_to_be_blocked() && near().all(stands) && near().any(in_way)
    }

    /// A way round, where the route ahead is not free of people or the robot is off it.
    fn detour(&self, seen: &Observation<'_>) -> Option<Polyline> {
        let at = seen.pose.point();
        let ahead = self.route.direction(self.s + 0.3);
        let people = obstacles(seen, &ahead, PEOPLE_M);
        let reach = self.robot.radius_m + WANTED_GAP_M;
        let off = (at - self.route.point(self.s)).norm() > 0.35;
        let near = |s: f64| {
            let point = self.route.point(s);
            people.iter().any(|person| person.gap_m(&point) < reach)
        };
        let crowded = (0..20).any(|step| near(self.s + LOOK_M / 20.0 * f64::from(step)));
        if !crowded && !off {
            return None;
        }
        // Back on the route behind the last person ahead, or as far as the window goes.
        // Behind a shut door there is nothing to plan for yet.
        let door_m = closed_door_ahead(seen, &self.route, self.s, WINDOW_M);
        let window_m = door_m.map_or(WINDOW_M, |left| (left - self.robot.radius_m - SHUT_M).max(SHUT_M));
        let farthest = (self.s + window_m).min(self.route.length_m());
        let mut goals: Vec<f64> =
            (0..8).map(|step| farthest - 0.4 * f64::from(step)).filter(|s| *s > self.s + 0.3).collect();
        goals.sort_by(|a, b| near(*a).cmp(&near(*b)).then(b.total_cmp(a)));
        if goals.is_empty() {
            goals.push(farthest);
        }
        goals.iter().take(4).find_map(|s| {
            let way = detour::round(&self.ground, &people, &self.route, &at, &self.route.point(*s))?;
            // A far longer way is none: it waits before whoever stands there, and asks.
            (off || way.length_m() <= (s - self.s) * FARTHEST + FARTHEST_M).then_some(way)
        })
    }

    /// Whether a way round that is being gone is kept: it leads on for a while, is about as free of people as a new one, and
    /// hardly longer. Planned anew at every look it would change sides before whoever stands in the middle.
    fn keeps(&self, seen: &Observation<'_>, (old, s): (&Polyline, f64), new: &Polyline) -> bool {
        let people = obstacles(seen, &self.route.direction(self.s + 0.3), PEOPLE_M);
        let gap_m = |way: &Polyline, from: f64| {
            let steps =
                (0..64_u32).map(|step| from + GAP_STEP_M * f64::from(step)).take_while(|s| *s <= way.length_m());
            let gaps = steps.flat_map(|s| {
                let at = way.point(s);
                people.iter().filter(|person| person.hard).map(move |person| person.gap_m(&at))
            });
            gaps.fold(self.robot.radius_m + WANTED_GAP_M, f64::min)
        };
        // How much longer a way is than the stretch of the route that it replaces.
        let more_m = |way: &Polyline, from: f64| {
            let back = way.end().map_or(0.0, |end| self.route.project_within(&end, self.s, self.s + 2.0 * WINDOW_M).0);
            way.length_m() - from - back
        };
        old.length_m() - s > KEPT_M
            && gap_m(old, s) > gap_m(new, 0.0) - KEPT_GAP_M
            && more_m(old, s) < more_m(new, 0.0) + KEPT_MORE_M
    }

    /// Counts the time behind somebody and asks to be let through.
    fn asking(&mut self, seen: &Observation<'_>, mut command: Command, share: f64) -> Command {
        let now = seen.time.secs();
        let behind = share <= 0.25 && seen.v.abs() < 0.12 && somebody_ahead(seen, 1.6);
        self.behind_s = if behind { self.behind_s + 1.0 / RATE_HZ } else { 0.0 };
        if self.behind_s >= ASK_AFTER_S && now - self.asked_s >= ASK_AGAIN_S {
            self.asked_s = now;
            command.gesture = Some(Gesture::ExcuseMe);
        }
        command
    }

    /// Waits beside the door until everybody who leaves is out; `None` when there is nothing to wait for (any more).
    fn wait(&mut self, seen: &Observation<'_>) -> Option<Command> {
        let now = seen.time.secs();
        if self.waiting.is_none() {
            self.waiting = spot(&self.ground, &self.route, &self.doors);
        }
        let spot = self.waiting.clone()?;
        let out = seen.cues.leavers_inside == 0;
        let since = if out { *self.out_since_s.get_or_insert(now) } else { now };
        let tired = self.waiting_since_s.is_some_and(|since| now - since > LEAVERS_S);
        if (out && now - since >= 1.2) || tired {
            self.script.leavers_are_out();
            self.plan = None;
            return None;
        }
        if self.s < spot.leave_s {
            return None;
        }
        let at = seen.pose.point();
        if (spot.at - at).norm() < 0.15 {
            self.waiting_since_s.get_or_insert(now);
            return Some(self.face_door(seen));
        }
        Some(self.go_to(seen, &spot.at))
    }

    fn face_door(&self, seen: &Observation<'_>) -> Command {
        let end = self.route.end().unwrap_or_else(|| seen.pose.point());
        Command { waiting: true, ..face(seen, &end, 1.5, 0.8) }
    }

    fn go_to(&mut self, seen: &Observation<'_>, to: &Point) -> Command {
        let at = seen.pose.point();
        let now = seen.time.secs();
        if now - self.planned_s >= REPLAN_S || self.plan.is_none() {
            self.planned_s = now;
            let people = obstacles(seen, &(to - at), PEOPLE_M);
            let straight = Polyline::new(&[at, *to]);
            let way = if people.is_empty() && self.ground.straight(&at, to, 0.04) {
                Some(straight)
            } else {
                detour::round(&self.ground, &people, &straight, &at, to).or_else(|| self.ground.way(&at, to))
            };
            self.plan = way.map(|way| (way, 0.0));
        }
        let Some((plan, s)) = &mut self.plan else { return Command { waiting: true, ..Command::default() } };
        *s = plan.project_within(&at, *s, *s + 1.0).0;
        let share = safe_share(seen, plan, *s, &self.robot, 0.2);
        Command { waiting: true, ..steer(seen, plan, *s, share * self.robot.v_max_mps, &self.robot) }
    }

    /// Speed limit from the script: behind somebody, level with somebody, or waiting for followers.
    fn limit(&mut self, seen: &Observation<'_>, wish: &Wish) -> (f64, bool) {
        let at = seen.pose.point();
        let ahead = self.route.direction(self.s + 0.3);
        let full = self.robot.v_max_mps;
        let find = |id| seen.people.iter().find(|person| Some(person.id) == id);
        if let Some(person) = find(wish.follow) {
            let (s, aside) = self.route.project_within(&person.at, self.s - 2.0, self.s + 12.0);
            if aside < 2.0 && s > self.s {
                let gap = (s - self.s).max((person.at - at).norm());
                let limit = (person.velocity.norm() + 0.9 * (gap - FOLLOW_GAP_M)).clamp(0.0, full);
                return (limit, limit < 0.05);
            }
        }
        if let Some(person) = find(wish.abreast) {
            let level = (person.at - at).dot(&ahead);
            return ((person.velocity.dot(&ahead).max(0.0) + 0.8 * level).clamp(0.15, full), false);
        }
        if let Some(reach) = wish.lead_m {
            let behind = seen
                .people
                .iter()
                .filter(|person| (person.at - at).dot(&ahead) < 0.3)
                .map(|person| (person.at - at).norm());
            let nearest = behind.fold(f64::INFINITY, f64::min);
            let far = nearest > reach;
            // Nobody is waited for longer than 12 s at a stretch: followers may have given up.
            self.alone_s = if far { self.alone_s + 1.0 / RATE_HZ } else { 0.0 };
            if far && seen.time.secs() > 2.0 && self.alone_s < 12.0 {
                return (0.0, true);
            }
        }
        (full, false)
    }
}

impl RobotDriver for Reference {
    fn rate_hz(&self) -> f64 {
        RATE_HZ
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let at = seen.pose.point();
        self.ground.look(seen);
        let (s, aside) = self.route.progress(&at, self.s, (0.0, 2.5));
        if aside < 2.5 {
            self.s = s.max(self.s);
        }
        let wish = self.script.step(seen, 1.0 / RATE_HZ);
        let rest = Command { waiting: true, ..Command::default() };
        if wish.hold || left_m(&self.route, &at, self.s) < 0.12 {
            return rest;
        }
        if wish.wait_for_leavers
            && let Some(command) = self.wait(seen)
        {
            return command;
        }
        // A closed door on the way: stops before it and waits for it to open.
        if waits_at_door(seen, &self.route, self.s, self.robot.radius_m) {
            return rest;
        }
        if let Some(command) = wish.overtake.and_then(|whom| self.pass(seen, whom)) {
            return command;
        }
        let (limit, waiting) = self.limit(seen, &wish);
        let command = self.go(seen, limit);
        Command { waiting: waiting || command.waiting, ..command }
    }
}
