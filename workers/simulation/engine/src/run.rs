//! The engine: one run, tick by tick.

use std::collections::BTreeMap;

use socrates_crowd::Params;
use socrates_model::time::STEP_SECS;
use socrates_model::{
    Action, AgentId, AgentState, Cues, Event, EventKind, Fault, Gesture, HumanId, Observation, Point, Recording,
    RecordingHeader, Relation, RobotDriver, SeenDoor, SeenPerson, SimTime,
};

use crate::contacts::{self, Body};
use crate::doors::{Doors, Passer};
use crate::ending::{Ending, Standing};
use crate::floor::Floor;
use crate::human::{DoorOnWay, Human, leaf_name, leaf_number};
use crate::lidar::{self, Disc};
use crate::motion::{self, Other, Scene, Want};
use crate::recorder::Recorder;
use crate::rendezvous::{self, Moment, Timing};
use crate::robot::Robot;
use crate::script::{Cue, Script};
use crate::setup::{self, Setup};
use crate::view::{RobotSeen, View};
use crate::{start, walk};

/// The name of the planner that means: no robot (the twin run).
pub const NO_ROBOT: &str = "none";

/// One run that is ready to go.
#[derive(Debug)]
pub struct Engine {
    setup: Setup,
    floor: Floor,
    doors: Doors,
    humans: Vec<Human>,
    timings: Vec<Timing>,
    robot: Option<Robot>,
    robot_doors: Vec<DoorOnWay>,
    script: Script,
    params: Params,
    ending: Ending,
    header: RecordingHeader,
}

impl Engine {
    /// Reads the trees, builds the floor and places everybody.
    ///
    /// # Errors
    /// Every fault at once: ids that do not fit each other, unknown nodes, trees that cannot be read.
    pub fn new(setup: Setup) -> Result<Self, Vec<Fault>> {
        let trees = setup::trees(&setup)?;
        let mut floor = Floor::new(&setup.location.grid);
        let doors = Doors::new(&setup.location);
        floor.close(doors.closed());
        let robot = (setup.planner != NO_ROBOT).then(|| start::robot(&setup, &floor));
        let humans = start::humans(&setup, trees, &floor, robot.as_ref());
        let robot_doors = robot.as_ref().map_or_else(Vec::new, |robot| start::doors_on(&setup, &robot.route));
        let timings = timings(&humans, robot.as_ref(), &robot_doors);
        let header = start::header(&setup, &humans, robot.as_ref());
        let script = Script::new(&setup.proposal.robot.script);
        let ending = Ending::new(setup.duration_s);
        Ok(Self {
            setup,
            floor,
            doors,
            humans,
            timings,
            robot,
            robot_doors,
            script,
            params: Params::default(),
            ending,
            header,
        })
    }

    /// What a viewer needs before tick 0.
    #[must_use]
    pub const fn header(&self) -> &RecordingHeader {
        &self.header
    }

    /// The walls of the run, for planners that want the same distance field.
    #[must_use]
    pub const fn floor(&self) -> &Floor {
        &self.floor
    }

    /// Runs to the end. `driver` drives the robot (without one it stands); `sink` gets every tick's states
    /// and events as they come.
    pub fn run(
        mut self,
        mut driver: Option<&mut dyn RobotDriver>,
        sink: &mut dyn FnMut(&[AgentState], &[Event]),
    ) -> Recording {
        let mut recorder = Recorder::new(self.header.clone());
        let mut tick = 0_u64;
        loop {
            let now = SimTime::at_tick(tick);
            recorder.at(now);
            let raised = self.raised();
            let passers = self.passers();
            for (door, open) in self.doors.step(now.secs(), STEP_SECS, &passers, &raised) {
                recorder.tell(EventKind::Door { door, open });
            }
            self.floor.close(self.doors.closed());
            self.think(now, tick == 0, &mut recorder);
            if let Some(driver) = driver.as_deref_mut() {
                self.drive(driver, now, &mut recorder);
            }
            let states = self.states(tick);
            let met = self.watch(&mut recorder);
            let standing = self.standing(now.secs(), met);
            if let Some(reason) = self.ending.step(&standing, &mut recorder) {
                recorder.tell(EventKind::End { reason: reason.to_owned() });
                recorder.frame(&states, sink);
                return recorder.finish();
            }
            self.advance(now.secs(), &mut recorder);
            recorder.frame(&states, sink);
            tick += 1;
        }
    }

    /// Doors that the rendezvous controller opens: somebody is about to go through.
    fn raised(&self) -> Vec<(String, Point)> {
        let mut raised = Vec::new();
        let mut raise = |door: usize| {
            if let Some(live) = self.doors.doors.get(door) {
                raised.push(("encounter".to_owned(), live.door.middle()));
            }
        };
        for human in &self.humans {
            for on_way in human
                .doors
                .iter()
                .filter(|on_way| human.started && on_way.s > human.s - 0.1 && on_way.s - human.s < 1.6)
            {
                raise(on_way.door);
            }
        }
        if let Some(robot) = &self.robot {
            for on_way in self.robot_doors.iter().filter(|on_way| on_way.s > robot.s && on_way.s - robot.s < 2.5) {
                raise(on_way.door);
            }
        }
        raised
    }

    fn passers(&self) -> Vec<Passer> {
        let humans = self.humans.iter().map(|human| {
            // Somebody who waits at a door on its way still means to go through.
            let on_way = human.started && human.action == Action::Navigate && !human.at_goal();
            let velocity = if on_way { human.route.direction(human.s + 0.1) * 0.5 } else { human.velocity };
            Passer { at: human.at, velocity, robot: false }
        });
        let robot = self.robot.iter().map(|robot| Passer { at: robot.at(), velocity: robot.velocity, robot: true });
        humans.chain(robot).collect()
    }

    /// Ticks every tree on the same moment; what is decided shows in this tick's motion, gestures in the next tick's views.
    fn think(&mut self, now: SimTime, first: bool, recorder: &mut Recorder) {
        let robot = self.robot.as_ref().map(|robot| RobotSeen {
            at: robot.at(),
            speed_mps: robot.velocity.norm(),
            gesture: robot.gesture,
        });
        let gestures: BTreeMap<HumanId, Gesture> = self.humans.iter().map(|human| (human.id, human.gesture)).collect();
        for human in &mut self.humans {
            let mut view = View::of(human, &self.floor, now, robot, &gestures);
            human.tree.tick(&mut human.state, &mut view);
            let (act, say, sight) = (view.act.take(), view.say.take(), view.sees_robot(f64::INFINITY));
            if let Some(distance_m) = sight {
                recorder.sight(human.id, distance_m);
            }
            // A tick in which nothing acts is a pause, not a new motion.
            let act = act.unwrap_or(Action::StandStill);
            if act != human.action || first {
                if leaf_name(&act) != leaf_name(&human.action) || first {
                    recorder.tell(EventKind::Leaf { human: human.id, leaf: leaf_name(&act).to_owned() });
                }
                if act == Action::Navigate && !first {
                    walk::resume(human);
                }
                human.errand = crate::human::Errand::default();
                human.action = act;
            }
            if let Some(gesture) = say.filter(|gesture| *gesture != human.gesture) {
                human.gesture = gesture;
                recorder.tell(EventKind::Gesture { agent: human.agent(), gesture });
            }
        }
    }

    /// Asks the planner when it is due, and plays the script's gestures.
    fn drive(&mut self, driver: &mut dyn RobotDriver, now: SimTime, recorder: &mut Recorder) {
        let Some(robot) = &mut self.robot else { return };
        let now_s = now.secs();
        let at = robot.at();
        let seen: Vec<SeenPerson> = self
            .humans
            .iter()
            .filter(|human| (human.at - at).norm() <= robot.model.lidar_range_m && self.floor.sees(&at, &human.at))
            .map(seen)
            .collect();
        let bearing =
            |to: &Point| socrates_model::geometry::wrap_angle(libm::atan2(to.y - at.y, to.x - at.x) - robot.pose.yaw);
        let noticed: Vec<(HumanId, f64, f64, Gesture)> = seen
            .iter()
            .map(|person| (person.id, (person.at - at).norm(), bearing(&person.at), person.gesture))
            .collect();
        let at_encounter: Vec<HumanId> = self
            .humans
            .iter()
            .filter(|human| human.meeting.as_ref().is_some_and(|meeting| (meeting.at - at).norm() < 1.0))
            .map(|human| human.id)
            .collect();
        let mut gesture =
            self.script.step(&Cue { now_s, dt: STEP_SECS, humans: &noticed, at_encounter: &at_encounter });
        #[expect(clippy::cast_precision_loss, reason = "calls of one run")]
        let due_s = robot.calls as f64 / driver.rate_hz().clamp(1.0, 100.0);
        if now_s + 1e-9 >= due_s {
            robot.calls += 1;
            let doors: Vec<SeenDoor> = self
                .doors
                .doors
                .iter()
                .map(|live| SeenDoor {
                    id: live.door.id.clone(),
                    from: live.door.from,
                    to: live.door.to,
                    open: live.open,
                })
                .collect();
            let disc = |human: &Human| Disc { center: human.at, radius_m: human.radius_m };
            let discs: Vec<Disc> = self.humans.iter().map(disc).collect();
            let (floor, pose, range) = (&self.floor, robot.pose, robot.model.lidar_range_m);
            let scan = || lidar::scan(floor, &pose, &discs, range);
            let leavers = self.humans.iter().filter(|human| inside_still(human)).count();
            robot.command = driver.drive(&Observation {
                time: now,
                pose,
                v: robot.v,
                omega: robot.omega,
                people: &seen,
                doors: &doors,
                lidar: &scan,
                cues: Cues { leavers_inside: u32::try_from(leavers).unwrap_or(u32::MAX) },
            });
            gesture = robot.command.gesture.or(gesture);
        }
        if let Some(gesture) = gesture {
            if gesture != robot.gesture {
                recorder.tell(EventKind::Gesture { agent: AgentId::Robot, gesture });
            }
            robot.say(gesture, now_s);
        } else if robot.gesture != Gesture::None && now_s >= robot.gesture_until_s {
            robot.gesture = Gesture::None;
            recorder.tell(EventKind::Gesture { agent: AgentId::Robot, gesture: Gesture::None });
        }
    }

    fn states(&self, tick: u64) -> Vec<AgentState> {
        let robot = self.robot.iter().map(|robot| AgentState {
            tick,
            agent: 0,
            flags: AgentState::flags(Robot::agent(), robot.gesture, 0),
            x: robot.pose.x,
            y: robot.pose.y,
            yaw: robot.pose.yaw,
            vx: robot.velocity.x,
            vy: robot.velocity.y,
            omega: robot.omega,
        });
        let humans = self.humans.iter().map(|human| AgentState {
            tick,
            agent: human.id.number(),
            flags: AgentState::flags(human.agent(), human.gesture, leaf_number(&human.action)),
            x: human.at.x,
            y: human.at.y,
            yaw: human.yaw,
            vx: human.velocity.x,
            vy: human.velocity.y,
            omega: human.omega,
        });
        robot.chain(humans).collect()
    }

    /// Tells what is seen at this tick: nodes reached, encounters. Gives back the humans met so far.
    fn watch(&mut self, recorder: &mut Recorder) -> usize {
        let mut met = 0;
        if let Some(robot) = &mut self.robot {
            let at = robot.at();
            while let Some((node, mark)) = robot.nodes.get(robot.next_node).filter(|(_, mark)| robot.s >= mark - 0.3) {
                if robot.s <= mark + 1.0 || (robot.route.point(*mark) - at).norm() < 1.5 {
                    recorder.tell(EventKind::Node { agent: AgentId::Robot, node: node.clone() });
                }
                robot.next_node += 1;
            }
        }
        for (human, timing) in self.humans.iter_mut().zip(&mut self.timings) {
            while let Some((node, mark)) = human.nodes.get(human.next_node).filter(|(_, mark)| human.s >= mark - 0.3) {
                if (human.route.point(*mark) - human.at).norm() < 1.8 {
                    recorder.tell(EventKind::Node { agent: AgentId::Human(human.id), node: node.clone() });
                }
                human.next_node += 1;
            }
            if let (Some(meeting), Some(robot)) = (&human.meeting, &self.robot) {
                timing.over |=
                    recorder.meet(human.id, (&meeting.node, &meeting.at), &robot.at(), &human.at, human.stays());
                met += usize::from(timing.over);
            }
        }
        met
    }

    fn standing(&mut self, now_s: f64, met: usize) -> Standing {
        let mut arrived = true;
        if let Some(robot) = &mut self.robot {
            let end = robot.route.end().unwrap_or_else(|| robot.at());
            let left = (end - robot.at()).norm();
            let full = self.humans.iter().any(|human| (human.at - end).norm() < 0.9 && human.velocity.norm() < 0.1);
            robot.at_full_goal_s =
                if full && left < 1.4 && robot.velocity.norm() < 0.05 { robot.at_full_goal_s + STEP_SECS } else { 0.0 };
            let near = left < 0.35 && robot.s > robot.route.length_m() - 1.0;
            if robot.arrived_s.is_none() && (near || robot.at_full_goal_s > 2.0) {
                robot.arrived_s = Some(now_s);
            }
            arrived = robot.arrived_s.is_some();
        }
        let done = self.humans.iter().all(|human| {
            human.stays() || human.at_goal() || human.action != Action::Navigate && human.velocity.norm() < 0.05
        });
        Standing {
            now_s,
            robot: self.robot.as_ref().map(|robot| (robot.s, robot.command.waiting, robot.arrived_s)),
            arrived,
            people_done: done,
            met,
            to_meet: self.humans.iter().filter(|human| human.meeting.is_some()).count(),
            walkers: self
                .humans
                .iter()
                .map(|human| {
                    (
                        human.id,
                        human.s,
                        human.action == Action::Navigate
                            && human.started
                            && !human.at_goal()
                            && human.velocity.norm() < 0.3,
                    )
                })
                .collect(),
        }
    }

    /// Moves everybody by one tick.
    fn advance(&mut self, now_s: f64, recorder: &mut Recorder) {
        let others: Vec<Other> = self
            .humans
            .iter()
            .map(|human| Other {
                id: Some(human.id),
                at: human.at,
                velocity: human.velocity,
                radius_m: human.radius_m,
                group: human.group,
            })
            .chain(self.robot.iter().map(|robot| Other {
                id: None,
                at: robot.at(),
                velocity: robot.velocity,
                radius_m: robot.model.radius_m,
                group: None,
            }))
            .collect();
        let led: Vec<HumanId> = self
            .humans
            .iter()
            .filter_map(|human| if let Action::FollowHuman(id) = human.action { Some(id) } else { None })
            .collect();
        let trails = self
            .humans
            .iter()
            .filter(|human| led.contains(&human.id))
            .map(|human| (human.id, (human.at, human.velocity, human.trail.clone())))
            .collect();
        let paces = self.doors_and_paces(now_s);
        let scene = Scene {
            location: &self.setup.location,
            floor: &self.floor,
            now_s,
            robot: self.robot.as_ref(),
            others: &others,
            trails: &trails,
        };
        let mut wants: Vec<Want> = Vec::with_capacity(self.humans.len());
        let mut bodies: Vec<Body> = Vec::with_capacity(others.len());
        for (human, pace) in self.humans.iter_mut().zip(&paces) {
            let want = motion::want(human, &scene, *pace);
            let around: Vec<Other> = others.iter().filter(|other| other.id != Some(human.id)).cloned().collect();
            walk::steer(human, &want, &self.floor, &around, &self.params);
            human.started |= human.action == Action::Navigate && want.target.is_some();
            let yields = if want.target.is_some() { 1.0 } else { 0.02 };
            let at = human.at + human.velocity * STEP_SECS;
            bodies.push(Body { agent: human.agent(), at, velocity: human.velocity, radius_m: human.radius_m, yields });
            wants.push(want);
        }
        if let Some(robot) = &mut self.robot {
            robot.step();
            let yields = if robot.velocity.norm() > 0.02 { 0.5 } else { 0.02 };
            bodies.push(Body {
                agent: AgentId::Robot,
                at: robot.at(),
                velocity: robot.velocity,
                radius_m: robot.model.radius_m,
                yields,
            });
        }
        for touch in contacts::resolve(&mut bodies, &self.floor) {
            recorder.touch(touch);
        }
        for ((human, want), body) in self.humans.iter_mut().zip(&wants).zip(&bodies) {
            walk::settle(human, want, body.at, body.velocity);
            if human.action == Action::Navigate {
                walk::progress(human);
            }
        }
        if let (Some(robot), Some(body)) = (&mut self.robot, bodies.last()) {
            robot.settle(body.at, body.velocity);
        }
    }

    /// Speed of each human on its way: rendezvous, closed doors ahead, and the pace of walking groups.
    fn doors_and_paces(&mut self, now_s: f64) -> Vec<f64> {
        let mut paces = Vec::with_capacity(self.humans.len());
        for (human, timing) in self.humans.iter().zip(&mut self.timings) {
            let door = human.doors.iter().find(|on_way| on_way.s > human.s - 0.1);
            let door = door.and_then(|on_way| Some((on_way.s - human.s, self.doors.doors.get(on_way.door)?.open)));
            let sight = self.robot.as_ref().is_some_and(|robot| self.floor.sees(&human.at, &robot.at()));
            let moment = Moment { now_s, dt: STEP_SECS, sight, door };
            // Other actions have their own speed; the rendezvous waits meanwhile.
            let mut pace = if human.action == Action::Navigate {
                rendezvous::pace(human, timing, self.robot.as_ref(), &moment).speed_mps
            } else {
                human.speed_mps
            };
            if door.is_some_and(|(left, open)| !open && left < 0.75 && human.started) {
                pace = 0.0;
            }
            paces.push(pace);
        }
        self.keep_groups_together(&mut paces);
        paces
    }

    /// Members of a walking group take the pace of its first member, a little faster behind and slower in front.
    fn keep_groups_together(&self, paces: &mut [f64]) {
        for group in self.setup.proposal.groups.iter().filter(|group| !group.standing) {
            let places: Vec<usize> =
                group.members.iter().filter_map(|id| self.humans.iter().position(|human| human.id == *id)).collect();
            let Some(lead) = places.first().and_then(|place| paces.get(*place)).copied() else { continue };
            let left: Vec<f64> = places
                .iter()
                .filter_map(|place| self.humans.get(*place))
                .map(|human| human.route.length_m() - human.s)
                .collect();
            #[expect(clippy::cast_precision_loss, reason = "a few people")]
            let mean = left.iter().sum::<f64>() / left.len().max(1) as f64;
            for (place, left) in places.iter().zip(left) {
                if let Some(pace) = paces.get_mut(*place) {
                    *pace =
                        if lead > 0.0 { (lead * (1.0 + 0.6 * (left - mean).clamp(-0.8, 0.8))).min(1.8) } else { 0.0 };
                }
            }
        }
    }
}

fn seen(human: &Human) -> SeenPerson {
    SeenPerson {
        id: human.id,
        at: human.at,
        velocity: human.velocity,
        yaw: human.yaw,
        radius_m: human.radius_m,
        gesture: human.gesture,
    }
}

/// Whether somebody who leaves is not out yet.
fn inside_still(human: &Human) -> bool {
    human.relation == Relation::Leaving
        && match human.doors.first() {
            Some(door) => human.s < door.s + 0.7,
            None => human.s < 2.0_f64.min(human.route.length_m() - 0.5),
        }
}

/// The controller's memory at the start: who leaves a place that the robot enters, and in which order.
fn timings(humans: &[Human], robot: Option<&Robot>, robot_doors: &[DoorOnWay]) -> Vec<Timing> {
    let enters = |human: &Human| {
        let Some(robot) = robot else { return false };
        let start = human.route.point(0.0);
        match human.doors.first() {
            Some(door) => robot_doors.iter().any(|on_way| on_way.door == door.door),
            None => robot.route.end().is_some_and(|end| (end - start).norm() < 3.0),
        }
    };
    let mut out: Vec<(f64, usize)> = Vec::new();
    for (place, human) in humans.iter().enumerate() {
        if human.relation == Relation::Leaving {
            let way = human.doors.first().map_or_else(|| human.route.length_m(), |door| door.s);
            out.push(((human.route.point(way) - human.at).norm(), place));
        }
    }
    out.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    humans
        .iter()
        .enumerate()
        .map(|(place, human)| {
            let order = out
                .iter()
                .position(|(_, other)| *other == place)
                .and_then(|order| u32::try_from(order).ok())
                .unwrap_or(0);
            Timing { leaving_order: order, robot_enters: enters(human), ..Timing::default() }
        })
        .collect()
}
