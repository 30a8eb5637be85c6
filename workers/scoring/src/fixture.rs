//! Recordings and places for tests, made from straight walks.

use socrates_model::recording::{ABSENT_LEAF, AgentInfo};
use socrates_model::{
    AgentId, AgentState, Cell, Encounter, Event, EventKind, Gesture, GraphEdge, GraphNode, Grid, HumanId, Location,
    NodeId, Paths, PlannerName, Point, Pose, Recording, RecordingHeader, RunId, SceneGraph, SimTime,
};

/// A small generator, so that a property runs over the same cases each time.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    /// From 0 to below 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// One agent that goes through points at given times, straight and even between them.
pub(crate) struct Walk {
    pub(crate) agent: AgentId,
    pub(crate) radius_m: f64,
    pub(crate) stops: Vec<(f64, f64, f64)>,
    /// `(from, to, gesture)`.
    pub(crate) gestures: Vec<(f64, f64, Gesture)>,
    /// `(from, leaf index)`.
    pub(crate) leaves: Vec<(f64, u16)>,
    /// Heading where it stands; else of the walk.
    pub(crate) yaw: Option<f64>,
}

impl Walk {
    pub(crate) fn through(agent: AgentId, stops: &[(f64, f64, f64)]) -> Self {
        let radius_m = if agent == AgentId::Robot { 0.25 } else { 0.28 };
        Self { agent, radius_m, stops: stops.to_vec(), gestures: vec![], leaves: vec![], yaw: None }
    }

    pub(crate) fn robot(x: f64, y: f64, vx: f64, vy: f64) -> Self {
        Self::through(AgentId::Robot, &[(0.0, x, y), (1000.0, x + 1000.0 * vx, y + 1000.0 * vy)])
    }

    /// The robot once round the origin, evenly and counter-clockwise.
    pub(crate) fn circle(radius_m: f64, seconds: f64) -> Self {
        let turn = |share: f64| (share * std::f64::consts::TAU).sin_cos();
        let stop = |(share, (sin, cos)): (f64, (f64, f64))| (share * seconds, radius_m * cos, radius_m * sin);
        let shares = (0..=360).map(|k| f64::from(k) / 360.0);
        let stops: Vec<(f64, f64, f64)> = shares.map(|share| stop((share, turn(share)))).collect();
        Self::through(AgentId::Robot, &stops)
    }

    pub(crate) fn human(number: u32, x: f64, y: f64, vx: f64, vy: f64) -> Self {
        Self::through(AgentId::Human(HumanId::new(number)), &[(0.0, x, y), (1000.0, x + 1000.0 * vx, y + 1000.0 * vy)])
    }

    pub(crate) fn human_through(number: u32, stops: &[(f64, f64, f64)]) -> Self {
        Self::through(AgentId::Human(HumanId::new(number)), stops)
    }

    pub(crate) fn facing(mut self, yaw: f64) -> Self {
        self.yaw = Some(yaw);
        self
    }

    pub(crate) fn says(mut self, from: f64, to: f64, gesture: Gesture) -> Self {
        self.gestures.push((from, to, gesture));
        self
    }

    pub(crate) fn leaf(mut self, from: f64, leaf: u16) -> Self {
        self.leaves.push((from, leaf));
        self
    }

    fn state(&self, tick: u64, t: f64) -> AgentState {
        let last = *self.stops.last().unwrap();
        let pair = self.stops.windows(2).find(|pair| t >= pair[0].0 && t < pair[1].0);
        let (x, y, vx, vy) = match pair {
            Some(pair) => {
                let (a, b) = (pair[0], pair[1]);
                let (vx, vy) = ((b.1 - a.1) / (b.0 - a.0), (b.2 - a.2) / (b.0 - a.0));
                (a.1 + vx * (t - a.0), a.2 + vy * (t - a.0), vx, vy)
            }
            None => (last.1, last.2, 0.0, 0.0),
        };
        let mut course = 0.0;
        for pair in self.stops.windows(2).filter(|pair| t >= pair[0].0) {
            let (dx, dy) = (pair[1].1 - pair[0].1, pair[1].2 - pair[0].2);
            if dx != 0.0 || dy != 0.0 {
                course = dy.atan2(dx);
            }
        }
        let moving = vx != 0.0 || vy != 0.0;
        let yaw = if moving { course } else { self.yaw.unwrap_or(course) };
        let gesture = self.gestures.iter().find(|(from, to, _)| t >= *from && t < *to).map(|found| found.2);
        let leaf = self.leaves.iter().rev().find(|(from, _)| t >= *from).map_or(0, |found| found.1);
        AgentState {
            tick,
            agent: self.agent.number(),
            flags: AgentState::flags(self.agent, gesture, leaf),
            x,
            y,
            yaw,
            vx,
            vy,
            omega: 0.0,
        }
    }
}

/// A recording of the walks over `[0, seconds]`.
pub(crate) fn recording(walks: &[Walk], seconds: f64, step_s: f64) -> Recording {
    let header = RecordingHeader {
        format: 1,
        run: RunId::new("test.reference-1").unwrap(),
        planner: PlannerName::reference(),
        seed: 1,
        profile: "native".into(),
        step_s,
        agents: walks
            .iter()
            .map(|walk| AgentInfo {
                agent: walk.agent,
                radius_m: walk.radius_m,
                speed_mps: if walk.agent == AgentId::Robot { 0.8 } else { 1.2 },
                role: if walk.agent == AgentId::Robot { "robot".into() } else { "person".into() },
            })
            .collect(),
        leaves: [
            "",
            "RegularNav",
            "RunAwayFromRobot",
            "FollowRobot",
            "LookAtRobot",
            "BlockRobot",
            "GiveWaytoRobot",
            "StandStill",
            "WatchHuman",
            "TurnBack",
            "ChangePace",
            "GoToPlace",
            "MakeRoom",
            "ComeBack",
        ]
        .map(String::from)
        .to_vec(),
    };
    let ticks = (seconds / step_s).round() as u64;
    let mut frames = Vec::new();
    for tick in 0..=ticks {
        for walk in walks {
            frames.push(walk.state(tick, tick as f64 * step_s));
        }
    }
    Recording { header, frames, events: vec![] }
}

pub(crate) fn event(run: &mut Recording, t: f64, kind: EventKind) {
    run.events.push(Event { time: SimTime::from_nanos((t * 1e9) as u64), kind });
}

/// Takes a human out of the run for a stretch of time, as the simulation writes those who come and go.
pub(crate) fn absent(run: &mut Recording, number: u32, times: std::ops::Range<f64>) {
    gone(run, AgentId::Human(HumanId::new(number)), times);
}

/// The same for anybody.
pub(crate) fn gone(run: &mut Recording, id: AgentId, times: std::ops::Range<f64>) {
    if run.header.absent().is_none() {
        run.header.leaves.push(ABSENT_LEAF.into());
    }
    let leaf = run.header.absent().unwrap();
    for state in run.frames.iter_mut().filter(|state| state.agent == id.number()) {
        if times.contains(&(state.tick as f64 * run.header.step_s)) {
            state.flags = AgentState::flags(id, None, leaf);
            (state.vx, state.vy) = (0.0, 0.0);
        }
    }
}

/// An open floor of 40 by 20 m at 0.1 m whose lower left corner is (-20, -10), with walls at the rectangles
/// `(x0, y0, x1, y1)`.
pub(crate) fn floor(
    walls: &[(f64, f64, f64, f64)],
    nodes: &[(&str, &str, f64, f64)],
    edges: &[(&str, &str)],
) -> Location {
    let (width, height, resolution_m) = (400, 200, 0.1);
    let mut grid = Grid {
        width,
        height,
        resolution_m,
        origin: Pose::new(-20.0, -10.0, 0.0),
        cells: vec![Cell::Free; width * height],
    };
    for row in 0..height {
        for column in 0..width {
            let p = grid.center_of(column, row);
            if walls.iter().any(|(x0, y0, x1, y1)| p.x >= *x0 && p.x <= *x1 && p.y >= *y0 && p.y <= *y1) {
                grid.cells[row * width + column] = Cell::Occupied;
            }
        }
    }
    Location {
        format: 1,
        name: "floor".into(),
        description: "an open floor".into(),
        grid,
        graph: SceneGraph::new(
            nodes
                .iter()
                .map(|(id, kind, x, y)| GraphNode { id: node(id), kind: (*kind).into(), at: Point::new(*x, *y) })
                .collect(),
            edges
                .iter()
                .map(|(a, b)| GraphEdge { from: node(a), to: node(b), kind: "CORRIDOR".into(), via: vec![] })
                .collect(),
        ),
        doors: vec![],
        names: Vec::new(),
        warnings: vec![],
    }
}

pub(crate) fn node(id: &str) -> NodeId {
    NodeId::new(id).unwrap()
}

/// Paths with one human per list, who meets the robot at the named node (or nowhere for an empty name).
pub(crate) fn paths(robot: &[&str], humans: &[(&[&str], &str)]) -> Paths {
    let mut paths = Paths {
        format: 1,
        robot: robot.iter().map(|id| node(id)).collect(),
        humans: Default::default(),
        encounters: vec![],
        reasoning: String::new(),
        author: "test".into(),
    };
    for (index, (way, meet)) in humans.iter().enumerate() {
        let id = HumanId::new(u32::try_from(index).unwrap() + 1);
        paths.humans.insert(id, way.iter().map(|id| node(id)).collect());
        if !meet.is_empty() {
            paths.encounters.push(Encounter { human: id, node: node(meet) });
        }
    }
    paths
}
