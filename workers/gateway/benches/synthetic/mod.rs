//! A synthetic run that is told to viewers, and its server as a process of its own.

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use async_trait::async_trait;
use serde_json::Value;
use socrates_gateway::Gateway;
use socrates_gateway::guard::Rules;
use socrates_gateway::http::Policy;
use socrates_gateway::hub::Shelf;
use socrates_gateway::run::{Run, Ticks};
use socrates_gateway::scene::Scene;
use socrates_model::recording::{AgentInfo, RecordingHeader};
use socrates_model::{
    AgentId, AgentState, Cell, FORMAT, Grid, HumanId, Location, PlannerName, Pose, RunId, SceneGraph,
};
use tokio::net::TcpListener;

/// Name of the run.
pub(crate) const RUN: &str = "bench.none-1";
/// Time from one frame to the next.
pub(crate) const EVERY: Duration = Duration::from_millis(50);

pub(crate) fn states(tick: u64, agents: u32) -> Vec<AgentState> {
    let along = (tick % 10_000) as f64 * 0.001;
    (1..=agents)
        .map(|agent| AgentState {
            tick,
            agent,
            flags: 1,
            x: f64::from(agent % 100) * 0.3 + along,
            y: f64::from(agent / 100) * 0.3,
            yaw: along,
            vx: 1.0,
            vy: 0.0,
            omega: 0.0,
        })
        .collect()
}

fn scene(agents: u32) -> Scene {
    let info = |number| AgentInfo {
        agent: AgentId::Human(HumanId::new(number)),
        radius_m: 0.3,
        speed_mps: 1.2,
        role: "visitor".into(),
    };
    let grid = Grid {
        width: 400,
        height: 400,
        resolution_m: 0.1,
        origin: Pose::new(0.0, 0.0, 0.0),
        cells: vec![Cell::Free; 160_000],
    };
    Scene {
        header: RecordingHeader {
            format: FORMAT,
            run: RunId::new(RUN).unwrap(),
            planner: PlannerName::no_robot(),
            seed: 1,
            profile: "native".into(),
            step_s: 0.01,
            agents: (1..=agents).map(info).collect(),
            leaves: vec![String::new()],
        },
        title: "bench".into(),
        location: Location {
            format: FORMAT,
            name: "hall".into(),
            description: String::new(),
            grid,
            graph: SceneGraph::default(),
            doors: Vec::new(),
            names: Vec::new(),
            warnings: Vec::new(),
        },
        doors: Vec::new(),
        robot: None,
        goal: None,
        way: Vec::new(),
        pace: Some(1.0),
    }
}

struct NoPast;

#[async_trait]
impl Ticks for NoPast {
    async fn ticks(&self, _from: u64, _to: u64, _every: u64) -> Vec<Vec<AgentState>> {
        Vec::new()
    }
}

/// One synthetic run.
struct One(u32);

#[async_trait]
impl Shelf for One {
    async fn list(&self) -> Vec<(RunId, Value)> {
        Vec::new()
    }

    async fn open(&self, _run: &RunId) -> Result<Option<Run>, String> {
        Ok(Some(Run::live(scene(self.0), Box::new(NoPast))))
    }

    async fn begin(&self, run: &Arc<Run>) {
        let (run, agents) = (Arc::clone(run), self.0);
        tokio::spawn(async move {
            let mut step = tokio::time::interval(EVERY);
            for tick in (0..).step_by(5) {
                step.tick().await;
                run.frame(tick, states(tick, agents));
            }
        });
    }
}

/// The gateway, told of a run of this many agents.
pub(crate) async fn gateway(listener: TcpListener, agents: u32) {
    let rules = Rules { most: 1_000, ..Rules::default() };
    Gateway { rules, policy: Policy::letting(&[]).unwrap(), tls: None }
        .serve(listener, vec![Box::new(One(agents))])
        .await;
}

/// A server in a process of its own.
pub(crate) struct Server {
    child: Child,
    /// Where it listens.
    pub(crate) at: String,
}

impl Server {
    /// This program, as a server of this kind.
    pub(crate) fn start(kind: &str, agents: u32) -> Self {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--serve", kind, &agents.to_string()])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut at = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut at).unwrap();
        Self { child, at: at.trim().to_owned() }
    }

    /// CPU time so far, s.
    pub(crate) fn cpu_s(&self) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
        let ticks = |place: usize| fields[place].parse::<f64>().unwrap();
        (ticks(11) + ticks(12)) / 100.0
    }

    /// Largest resident memory so far, MB.
    pub(crate) fn peak_mb(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() / 1_000.0
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}
