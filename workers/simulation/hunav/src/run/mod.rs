//! One run: the agents of a file, their trees, a robot if there is one, on a map if there is one.
//!
//! ```text
//! every 0.01 s: forces ─► trees, in list order ─► frame, events ─► robot, motion, contacts
//!               (profiles)  (profiles move here)                      (native moves here)
//! ```

mod agent;
mod leaves;
mod leaves_2;
mod mind;
mod native;
mod obstacle;
mod prepare;
mod robot;
mod scene;
mod upstream;

use std::collections::BTreeMap;

use socrates_bt::{Tree, TreeState};
use socrates_crowd::tracks::{Track, Tracks};
use socrates_engine::{Recorder, Touch};
use socrates_model::recording::AgentInfo;
use socrates_model::time::STEP_SECS;
use socrates_model::{
    AgentId, AgentState, EventKind, Gesture, Grid, Keeper, Onlooker, PlannerName, Recording, RecordingHeader, RunId,
    SimTime,
};

pub use agent::HumanModel;
pub use obstacle::Bounds;
pub use robot::RobotSpec;

use crate::agents::AgentsFile;
use crate::problem::Problem;
use crate::profile::Profile;
use crate::trees::TreeFiles;
use leaves::{ABSENT_LEAF, MOTIONS, TRACK_LEAF};
use mind::Mind;
use scene::{Deed, Scene};

/// Longest run, s.
pub const MAX_DURATION_S: f64 = 86_400.0;

/// Everything a run needs.
#[derive(Clone)]
pub struct Inputs<'a> {
    /// The agents.
    pub agents: &'a AgentsFile,
    /// Name of their file in messages.
    pub file: &'a str,
    /// The map; without one the floor is open.
    pub grid: Option<&'a Grid>,
    /// Whose semantics.
    pub profile: Profile,
    /// Same seed, same recording.
    pub seed: u64,
    /// Length of the run, s. Default 60.
    pub duration_s: f64,
    /// A robot without a planner.
    pub robot: Option<RobotSpec>,
    /// Finds tree files by name: `LLMBT_0.xml`, `<yaml_base_name>__agent_1_bt.xml`, `BTRegularNav.xml` …
    pub trees: TreeFiles<'a>,
    /// Who moves which agent, by its id; everybody else social forces. Native only.
    pub models: BTreeMap<i64, HumanModel>,
    /// Recorded people: those with the id of an agent take its place, others are added. Everybody feels them, they feel
    /// nobody, and they are on the floor from their first sample to their last.
    pub tracks: Option<&'a Tracks>,
    /// Boxes of objects that upstream's one obstacle point is taken from, beside the map.
    pub boxes: Vec<Bounds>,
}

impl<'a> Inputs<'a> {
    /// The agents of a file for 60 s on an open floor, native, seed 1, without a robot.
    #[must_use]
    pub fn new(agents: &'a AgentsFile, file: &'a str) -> Self {
        Self {
            agents,
            file,
            grid: None,
            profile: Profile::Native,
            seed: 1,
            duration_s: 60.0,
            robot: None,
            trees: &|_| None,
            models: BTreeMap::new(),
            tracks: None,
            boxes: Vec::new(),
        }
    }
}

/// Runs the agents and gives back what happened.
///
/// # Errors
/// Every problem that keeps it from running, at once: trees that are missing or cannot be read in the profile, starts
/// and goals in walls (native; elsewhere people walk through walls as upstream), ids that clash with the robot's,
/// models for nobody, numbers out of range.
pub fn simulate(inputs: &Inputs<'_>) -> Result<Recording, Vec<Problem>> {
    let run = Run::new(inputs)?;
    let header = run.header.clone();
    let mut keeper = Keeper::default();
    run.play(&mut keeper);
    Ok(keeper.recording().unwrap_or(Recording { header, frames: Vec::new(), events: Vec::new() }))
}

/// The same; `onlooker` gets everything as it comes, and nothing of it is kept.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_into(inputs: &Inputs<'_>, onlooker: &mut dyn Onlooker) -> Result<(), Vec<Problem>> {
    Run::new(inputs)?.play(onlooker);
    Ok(())
}

/// The problems of a run, errors and warnings, without running it.
#[must_use]
pub fn check(inputs: &Inputs<'_>) -> Vec<Problem> {
    let mut problems = inputs.agents.warnings.clone();
    match Run::new(inputs) {
        Ok(run) => problems.extend(run.warnings),
        Err(errors) => problems.extend(errors),
    }
    problems
}

/// A run that is ready to go.
pub(crate) struct Run {
    scene: Scene,
    minds: Vec<(Tree, TreeState)>,
    /// Recorded ways, one for each agent that has one.
    tracks: Vec<Option<Track>>,
    header: RecordingHeader,
    warnings: Vec<Problem>,
    ticks: u64,
}

impl std::fmt::Debug for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run").field("scene", &self.scene).field("ticks", &self.ticks).finish_non_exhaustive()
    }
}

/// Number of the tick at this time.
pub(crate) fn tick_of(now_s: f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time of a run, never negative")]
    let tick = (now_s / STEP_SECS + 0.5) as u64;
    tick
}

impl Run {
    fn play(mut self, onlooker: &mut dyn Onlooker) {
        onlooker.announce(&self.header);
        let mut recorder = Recorder::new();
        for tick in 0..=self.ticks {
            recorder.at(SimTime::at_tick(tick));
            self.tick(tick, tick == self.ticks, &mut recorder, onlooker);
        }
    }

    fn tick(&mut self, tick: u64, ends: bool, recorder: &mut Recorder, onlooker: &mut dyn Onlooker) {
        self.scene.now_s = SimTime::at_tick(tick).secs();
        self.replay();
        let poses = self.poses(tick);
        // The first call of upstream's manager only takes the agents over.
        let upstream = !self.scene.rules.native;
        if upstream {
            for touch in self.overlaps() {
                recorder.touch(touch);
            }
        }
        let deeds = if ends || upstream && tick == 0 { Vec::new() } else { self.think(recorder) };
        for kind in self.scene.events.drain(..) {
            recorder.tell(kind);
        }
        let states = self.states(poses);
        if ends {
            recorder.tell(EventKind::End { reason: "time".to_owned() });
        }
        recorder.frame(&states, onlooker);
        if ends {
            return;
        }
        if upstream {
            let people: Vec<_> = self.scene.agents.iter().map(|agent| (agent.at, agent.radius_m)).collect();
            let (now_s, dt) = (self.scene.now_s, self.scene.dt);
            if let Some(robot) = &mut self.scene.robot
                && robot.step(now_s, dt, &people)
            {
                self.scene.events.push(EventKind::RobotArrived);
            }
        } else {
            for touch in native::advance(&mut self.scene, &deeds) {
                recorder.touch(touch);
            }
        }
    }

    /// Puts everybody who replays a track where it was at this time; whoever is not there keeps its last place, or its
    /// first before it comes, and is neither felt nor touched.
    fn replay(&mut self) {
        for (agent, track) in self.scene.agents.iter_mut().zip(&self.tracks) {
            let Some(track) = track else { continue };
            let now = track.at(self.scene.now_s, &agent.person());
            agent.present = now.is_some();
            match now {
                Some(person) => {
                    (agent.at, agent.velocity) = (person.position, person.velocity);
                    agent.omega = socrates_model::geometry::wrap_angle(person.yaw - agent.yaw) / STEP_SECS;
                    agent.yaw = person.yaw;
                }
                None => {
                    let end = if self.scene.now_s < track.first_s() {
                        track.samples().first()
                    } else {
                        track.samples().last()
                    };
                    agent.at = end.map_or(agent.at, |sample| sample.position);
                    agent.velocity = socrates_model::Vector::zeros();
                    agent.omega = 0.0;
                }
            }
        }
    }

    /// Ticks every tree in list order; natively all see the same moment and the deeds come back.
    fn think(&mut self, recorder: &mut Recorder) -> Vec<Deed> {
        let native = self.scene.rules.native;
        if !native {
            upstream::feel(&mut self.scene);
        }
        let mut deeds = Vec::with_capacity(self.minds.len());
        for (me, (tree, state)) in self.minds.iter_mut().enumerate() {
            let sight = self.scene.sees_robot(me, f64::INFINITY);
            let mut mind = Mind { scene: &mut self.scene, me, deed: None, leaf: 0, gesture: None };
            if mind.scene.agents.get(me).is_some_and(|agent| agent.present && agent.model != HumanModel::Track) {
                tree.tick(state, &mut mind);
            }
            let (deed, leaf, gesture) = (mind.deed, mind.leaf, mind.gesture);
            deeds.push(deed.unwrap_or(Deed::Stand));
            let Some(agent) = self.scene.agents.get_mut(me) else { continue };
            if !native && leaf == 0 {
                // Nothing moved it: it stays where it is, and so its velocity is none.
                agent.velocity = socrates_model::Vector::zeros();
                agent.omega = 0.0;
            }
            let leaf = match (agent.present, agent.model) {
                (false, _) => ABSENT_LEAF,
                (true, HumanModel::Track) => TRACK_LEAF,
                (true, HumanModel::SocialForces | HumanModel::Orca) => leaf,
            };
            if leaf != agent.leaf {
                agent.leaf = leaf;
                let name = MOTIONS.get(usize::from(leaf)).copied().unwrap_or("");
                recorder.tell(EventKind::Leaf { human: agent.human, leaf: name.to_owned() });
            }
            if let Some(distance_m) = sight {
                recorder.sight(agent.human, distance_m);
            }
            if let Some(code) = gesture {
                agent.gesture = code;
            }
            if !native {
                show(&mut self.scene, me, recorder);
            }
        }
        if native {
            for me in 0..self.minds.len() {
                show(&mut self.scene, me, recorder);
            }
        }
        deeds
    }

    /// Where everybody is at the start of a tick.
    fn poses(&self, tick: u64) -> Vec<AgentState> {
        let mut states = Vec::with_capacity(self.scene.agents.len() + 1);
        if let Some(robot) = &self.scene.robot {
            states.push(AgentState {
                tick,
                agent: 0,
                flags: AgentState::flags(AgentId::Robot, robot.gesture, 0),
                x: robot.pose.x,
                y: robot.pose.y,
                yaw: robot.pose.yaw,
                vx: robot.velocity.x,
                vy: robot.velocity.y,
                omega: robot.omega,
            });
        }
        states.extend(self.scene.agents.iter().map(|agent| AgentState {
            tick,
            agent: agent.human.number(),
            flags: 0,
            x: agent.at.x,
            y: agent.at.y,
            yaw: agent.yaw,
            vx: agent.velocity.x,
            vy: agent.velocity.y,
            omega: agent.omega,
        }));
        states
    }

    /// The same with what they do now.
    fn states(&self, mut states: Vec<AgentState>) -> Vec<AgentState> {
        let robots = usize::from(self.scene.robot.is_some());
        for (state, agent) in states.iter_mut().skip(robots).zip(&self.scene.agents) {
            let gesture = meaning(agent.shown, self.scene.rules.own_gesture_codes);
            state.flags = AgentState::flags(agent.agent(), gesture, agent.leaf);
        }
        states
    }

    /// Who overlaps whom or a wall: told in profiles, where nobody keeps them apart.
    fn overlaps(&self) -> Vec<Touch> {
        let mut bodies: Vec<(AgentId, socrates_model::Point, f64)> =
            self.scene.robot.iter().map(|robot| (AgentId::Robot, robot.at(), robot.spec.radius_m)).collect();
        let present = self.scene.agents.iter().filter(|agent| agent.present);
        bodies.extend(present.map(|agent| (agent.agent(), agent.at, agent.radius_m)));
        let mut touches = Vec::new();
        for (number, (who, at, radius_m)) in bodies.iter().enumerate() {
            for (other, to, other_m) in bodies.iter().skip(number + 1) {
                let depth = radius_m + other_m - (to - at).norm();
                if depth > 0.0 {
                    touches.push(Touch::Agents(*who, *other, depth));
                }
            }
            let depth = radius_m - self.scene.floor.clearance_m(at);
            if depth > 0.0 {
                touches.push(Touch::Wall(*who, depth));
            }
        }
        touches
    }
}

/// Lets others see the gesture of an agent, unless the profile loses it.
fn show(scene: &mut Scene, me: usize, recorder: &mut Recorder) {
    let rules = scene.rules;
    let Some(agent) = scene.agents.get_mut(me) else { return };
    let lost = rules.gestures_get_lost && agent.state != agent.state_before;
    if agent.shown == agent.gesture || lost {
        return;
    }
    agent.shown = agent.gesture;
    let gesture = meaning(agent.shown, rules.own_gesture_codes);
    recorder.tell(EventKind::Gesture { agent: agent.agent(), gesture, to: None });
}

/// The gesture of a code; people of the fork have a table of their own, in which 3 is EXCUSE ME.
fn meaning(code: i64, own_codes: bool) -> Option<Gesture> {
    match (code, own_codes) {
        (3, true) => Some(Gesture::ExcuseMe),
        _ => u8::try_from(code).ok().and_then(|code| Gesture::from_code(code).ok()).flatten(),
    }
}

/// What a reader of the recording needs to know first.
fn header(inputs: &Inputs<'_>, scene: &Scene, run: RunId) -> RecordingHeader {
    let mut agents = Vec::new();
    if let Some(robot) = &scene.robot {
        agents.push(AgentInfo {
            agent: AgentId::Robot,
            radius_m: robot.spec.radius_m,
            speed_mps: robot.spec.speed_mps,
            role: "robot".to_owned(),
        });
    }
    agents.extend(scene.agents.iter().map(|agent| AgentInfo {
        agent: agent.agent(),
        radius_m: agent.radius_m,
        speed_mps: agent.max_vel_mps,
        role: agent.name.clone(),
    }));
    RecordingHeader {
        format: socrates_model::FORMAT,
        run,
        planner: if scene.robot.is_some() { PlannerName::waypoints() } else { PlannerName::no_robot() },
        seed: inputs.seed,
        profile: inputs.profile.name().to_owned(),
        step_s: STEP_SECS,
        agents,
        leaves: MOTIONS.iter().map(|name| (*name).to_owned()).collect(),
    }
}
