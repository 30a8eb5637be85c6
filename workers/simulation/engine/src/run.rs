//! The engine: one run, tick by tick.

use socrates_crowd::Params;
use socrates_maps::openings::Enclosures;
use socrates_model::act::ActRow;
use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::request::Waypoints;
use socrates_model::time::STEP_SECS;
use socrates_model::{
    Action, AgentId, AgentState, Event, EventKind, Fault, HumanId, Onlooker, Point, Recording, RecordingHeader,
    RobotDriver, SimTime,
};

use crate::advance::Desk;
use crate::doors::{self, Doors, Passer, Raised};
use crate::drive::Drivers;
use crate::ending::{Ending, Standing};
use crate::floor::Floor;
use crate::human::{DoorOnWay, Human};
use crate::models::DRIVEN_LEAF_NUMBER;
use crate::near::Near;
use crate::recorder::Recorder;
use crate::rendezvous::{self, Timing};
use crate::robot::Robot;
use crate::script::Script;
use crate::setup::{self, Setup};
use crate::view::{RobotSeen, Shown, View};
use crate::{meetings, start, turning, walk};

/// Nearer than this to the end of its way the robot is at its goal, m.
const AT_GOAL_M: f64 = 0.35;
/// Where somebody stands at its goal the robot has arrived this near to it, m.
const AROUND_GOAL_M: f64 = 1.4;

/// Keeps a run and hands it on.
struct Kept<'a> {
    recording: Recording,
    sink: &'a mut dyn FnMut(&[AgentState], &[Event]),
}

impl Onlooker for Kept<'_> {
    fn announce(&mut self, _header: &RecordingHeader) {}

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        (self.sink)(states, events);
        self.recording.frames.extend_from_slice(states);
        self.recording.events.extend_from_slice(events);
    }
}

/// One run that is ready to go.
#[derive(Debug)]
pub struct Engine {
    pub(crate) setup: Setup,
    pub(crate) floor: Floor,
    pub(crate) doors: Doors,
    pub(crate) humans: Vec<Human>,
    pub(crate) timings: Vec<Timing>,
    pub(crate) robot: Option<Robot>,
    pub(crate) robot_doors: Vec<DoorOnWay>,
    pub(crate) script: Script,
    pub(crate) params: Params,
    pub(crate) near: Near,
    pub(crate) desk: Desk,
    ending: Ending,
    pub(crate) header: RecordingHeader,
}

impl Engine {
    /// Reads the trees, builds the floor and places everybody.
    ///
    /// # Errors
    /// Every fault at once: ids that do not fit each other, unknown nodes, trees that cannot be read.
    pub fn new(mut setup: Setup) -> Result<Self, Vec<Fault>> {
        let trees = setup::trees(&setup)?;
        // An opening without a door is a door that always stands open.
        let enclosures = Enclosures::of(&setup.location);
        setup.location.doors = enclosures.doors(&setup.location);
        let mut floor = Floor::new(&setup.location.grid);
        let doors = Doors::new(&setup.location);
        floor.close(doors.closed());
        let robot = (!setup.planner.is_no_robot()).then(|| start::robot(&setup, &floor));
        let mut humans = start::humans((&setup, &enclosures), trees, &floor, robot.as_ref())?;
        let robot_doors = robot.as_ref().map_or_else(Vec::new, |robot| start::doors_on(&setup, &robot.route));
        rendezvous::let_out(&mut humans, &robot_doors);
        let by_nearness = |door: usize| {
            setup.location.doors.get(door).is_some_and(|door| matches!(door.opens, socrates_model::DoorOpens::Near(_)))
        };
        let before = |one: HumanId, other: HumanId| {
            meetings::orders(&setup).any(|(first, then)| first == one.into() && then == other.into())
        };
        let timings = rendezvous::timings(&humans, robot.as_ref(), &robot_doors, &by_nearness, &before);
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
            near: Near::default(),
            desk: Desk::default(),
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

    /// Runs to the end and gives back all of it. `driver` drives the robot (without one it stands); `sink` gets every
    /// tick's states and events as they come.
    pub fn run(self, driver: Option<&mut dyn RobotDriver>, sink: &mut dyn FnMut(&[AgentState], &[Event])) -> Recording {
        let recording = Recording { header: self.header.clone(), frames: Vec::new(), events: Vec::new() };
        let mut kept = Kept { recording, sink };
        self.play(driver, &mut kept);
        kept.recording
    }

    /// Runs to the end; `onlooker` gets everything as it comes, and nothing of it is kept.
    pub fn play<'d>(mut self, drivers: impl Into<Drivers<'d>>, onlooker: &mut dyn Onlooker) {
        let mut drivers = drivers.into();
        onlooker.announce(&self.header);
        let mut recorder = Recorder::new();
        let mut tick = 0_u64;
        loop {
            let now = SimTime::at_tick(tick);
            recorder.at(now);
            let mut doors_moved = false;
            if !self.doors.doors.is_empty() {
                let raised = self.raised(&recorder);
                let changed = self.doors.step(now.secs(), STEP_SECS, &self.passers(), &raised);
                if !changed.is_empty() {
                    self.floor.close(self.doors.closed());
                    doors_moved = true;
                }
                for (door, open) in changed {
                    recorder.tell(EventKind::Door { door, open });
                }
            }
            self.think(now, tick == 0, &mut recorder);
            if self.ask_drivers(&mut drivers, now, &mut recorder) {
                recorder.tell(EventKind::End { reason: "driver".to_owned() });
                recorder.frame(&self.states(tick), onlooker);
                return;
            }
            let states = self.states(tick);
            let met = self.watch(&mut recorder);
            let standing = self.standing(now.secs(), met);
            if let Some(reason) = self.ending.step(&standing, &mut recorder) {
                recorder.tell(EventKind::End { reason: reason.to_owned() });
                recorder.frame(&states, onlooker);
                return;
            }
            self.advance(now, doors_moved, &mut recorder);
            recorder.frame(&states, onlooker);
            tick += 1;
        }
    }

    /// What may open a door: somebody is about to go through, or something was told in the tick before.
    fn raised(&self, recorder: &Recorder) -> Vec<Raised> {
        let mut raised = Vec::new();
        if self.doors.listening {
            let place = |agent: AgentId| match agent {
                AgentId::Robot => self.robot.as_ref().map(Robot::at),
                AgentId::Human(id) => self.humans.iter().find(|human| human.id == id).map(|human| human.at),
            };
            raised.extend(recorder.last_tick().iter().filter_map(|event| Raised::by(event, &place)));
        }
        let mut raise = |door: usize, calls: bool| {
            if let Some(live) = self.doors.doors.get(door) {
                raised.push(Raised { name: doors::ENCOUNTER.to_owned(), at: Some(live.door.middle()), calls });
            }
        };
        for human in &self.humans {
            for on_way in human
                .doors
                .iter()
                .filter(|on_way| human.started && on_way.s > human.s - 0.1 && on_way.s - human.s < 1.6)
            {
                // Those who have changed their way to go in open it themselves.
                raise(on_way.door, human.diverted);
            }
        }
        if let Some(robot) = &self.robot {
            for on_way in self.robot_doors.iter().filter(|on_way| on_way.s > robot.s && on_way.s - robot.s < 2.5) {
                raise(on_way.door, false);
            }
        }
        raised
    }

    fn passers(&self) -> Vec<Passer> {
        let humans = self.humans.iter().filter(|human| human.present()).map(|human| {
            // Somebody who waits at a door on its way still means to go through.
            let on_way = human.started && human.gets_on() && !human.at_goal();
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
            has_moved: robot.has_moved,
            stood_s: robot.stood_s,
            gesture: robot.gesture,
        });
        let show = |human: &Human| Shown {
            id: human.id,
            gesture: human.gesture,
            steps_ended: human.steps_ended,
            done: human.is_done(),
        };
        let shown: Vec<Shown> = self.humans.iter().map(show).collect();
        // Acts change ways only once all have decided.
        let mut begin: Vec<usize> = Vec::new();
        for (place, human) in self.humans.iter_mut().enumerate().filter(|(_, human)| !human.is_recorded()) {
            if let Some(robot) = robot.filter(|_| human.present()) {
                human.nearest_robot_m = human.nearest_robot_m.min((robot.at - human.at).norm());
            }
            // Out of the human while its tree looks at it.
            let mut state = std::mem::take(&mut human.state);
            let mut view = View::of(human, &self.floor, now, robot, &shown);
            human.tree.tick(&mut state, &mut view);
            let (act, say, sight) = (view.act.take(), view.say.take(), view.sees_robot(f64::INFINITY));
            let to = view.say_to;
            let ended = view.steps_ended;
            human.notice.robot_seen = view.looked();
            human.state = state;
            for step in human.steps_ended + 1..=ended {
                recorder.tell(EventKind::StepEnded { human: human.id, step });
            }
            human.steps_ended = ended;
            if let Some(distance_m) = sight {
                recorder.sight(human.id, distance_m);
            }
            if human.is_driven() {
                // What their tree would have them do is for their driver to do, or not.
                if first {
                    recorder.tell(EventKind::Leaf { human: human.id, leaf: DRIVEN_LEAF.to_owned() });
                }
                continue;
            }
            // A tick in which nothing acts is a pause, not a new motion.
            let act = act.unwrap_or(Action::StandStill);
            if act != human.action || first {
                if act.row() != human.action.row() || first {
                    recorder.tell(EventKind::Leaf { human: human.id, leaf: act.row().leaf.to_owned() });
                }
                if act == Action::Navigate && !first {
                    walk::resume(human);
                }
                human.errand = crate::human::Errand::default();
                human.notice.stale = true;
                human.action = act;
                begin.push(place);
            }
            if let Some(gesture) = say.filter(|gesture| (*gesture, to) != (human.gesture, human.gesture_to)) {
                (human.gesture, human.gesture_to) = (gesture, to);
                recorder.tell(EventKind::Gesture { agent: human.agent(), gesture, to });
            }
        }
        for place in begin {
            let others = self.humans.iter().enumerate().filter(|(other, _)| *other != place);
            let ends: Vec<Point> = others.filter_map(|(_, human)| human.route.end()).collect();
            let there = turning::OthersAround { robot: robot.map(|robot| robot.at), ends: &ends };
            if let Some(human) = self.humans.get_mut(place) {
                turning::begin(human, &self.setup, &self.floor, &there);
            }
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
            flags: AgentState::flags(human.agent(), human.gesture, leaf(human)),
            x: human.at.x,
            y: human.at.y,
            yaw: human.yaw,
            vx: human.velocity.x,
            vy: human.velocity.y,
            omega: human.omega,
        });
        robot.chain(humans).collect()
    }

    /// Tells what is seen at this tick: nodes reached, encounters. Gives back how many encounters happened so far.
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
            if let Some(robot) = &self.robot {
                met += meetings::watch(human, timing, robot, recorder);
            }
        }
        met
    }

    fn standing(&mut self, now_s: f64, met: usize) -> Standing {
        let mut arrived = true;
        if let Some(robot) = &mut self.robot {
            let end = robot.route.end().unwrap_or_else(|| robot.at());
            let left = (end - robot.at()).norm();
            let mut there = self.humans.iter().filter(|human| human.present());
            let full = there.any(|human| (human.at - end).norm() < 0.9 && human.velocity.norm() < 0.25);
            // It may have come there by another way than the intended one; then it says so by resting there.
            let rests = left < AT_GOAL_M && robot.command.waiting && robot.has_moved;
            let stands = (rests || full && left < AROUND_GOAL_M) && robot.velocity.norm() < 0.05;
            // A way that passes its own end has led there only once its last fold is behind a robot that is to keep to it.
            let kept = self.setup.waypoints != Waypoints::Ends;
            let stands = stands && !(kept && robot.route.folds_m(robot.s, f64::INFINITY).next().is_some());
            robot.at_full_goal_s = if stands { robot.at_full_goal_s + STEP_SECS } else { 0.0 };
            let near = left < AT_GOAL_M && robot.s > robot.route.length_m() - 1.0;
            if robot.arrived_s.is_none() && (near || robot.at_full_goal_s > 2.0) {
                robot.arrived_s = Some(now_s);
            }
            arrived = robot.arrived_s.is_some();
        }
        let (mut done, mut under_way) = (true, false);
        let mut walkers = Vec::with_capacity(self.humans.len());
        for human in &self.humans {
            let (there, speed_mps) = (human.at_goal(), human.velocity.norm());
            let walks = human.gets_on() && !human.waits();
            done &= human.stays() || there || !walks && speed_mps < 0.05;
            under_way |= !there && walks && (human.bound || matches!(human.action, Action::GoTo(_)));
            walkers.push((human.id, human.s, walks && human.started && !there && speed_mps < 0.3));
        }
        Standing {
            now_s,
            robot: self.robot.as_ref().map(|robot| (robot.s, robot.command.waiting, robot.arrived_s)),
            robot_at: self.robot.as_ref().map(Robot::at),
            arrived,
            people_done: done,
            under_way,
            met,
            to_meet: self.humans.iter().map(|human| human.meetings.len()).sum(),
            walkers,
        }
    }
}

/// Number of the leaf that a frame tells: of the action, or what somebody recorded does.
fn leaf(human: &Human) -> u16 {
    if human.is_driven() {
        return DRIVEN_LEAF_NUMBER;
    }
    match (human.is_recorded(), human.present()) {
        (false, _) => human.action.row().leaf_number,
        (true, true) => ActRow::AFTER_RULES,
        (true, false) => ActRow::AFTER_RULES + 1,
    }
}
