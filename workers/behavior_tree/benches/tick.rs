//! Ticks of the curious tree of HuNavSim 1.0: 16 nodes with its subtree, half of the agents in each branch.
//!
//! `cargo bench --workspace --bench tick` prints one table; time is CPU time of this process, one thread.
#![expect(
    clippy::print_stdout,
    clippy::expect_used,
    reason = "a bench prints its table and stops where its tree is wrong"
)]

#[path = "../../../tests/machine.rs"]
mod machine;

use std::collections::BTreeMap;

use machine::cpu_s;
use socrates_bt::{Library, Options, Tree, TreeState, World};
use socrates_model::{Action, Gesture, HumanId, SimTime};

const CURIOUS: &str = r#"<root main_tree_to_execute="CuriousNavTree">
  <include path="BTRegularNav.xml"/>
  <BehaviorTree ID="CuriousNavTree">
    <Fallback name="CuriousFallback">
      <Sequence name="CurNav">
        <IsRobotVisible agent_id="{id}" distance="10.0"/>
        <Inverter>
          <TimeExpiredCondition seconds="30.0" ts="{dt}" only_once="false"/>
        </Inverter>
        <CuriousNav agent_id="{id}" time_step="{dt}"/>
      </Sequence>
      <Sequence name="RegNav">
        <SetBlackboard output_key="agentid" value="{id}"/>
        <SetBlackboard output_key="timestep" value="{dt}"/>
        <SubTree ID="RegularNavTree" id="agentid" dt="timestep"/>
      </Sequence>
    </Fallback>
  </BehaviorTree>
</root>"#;

/// Ticks of one measurement.
const TICKS: usize = 2_000_000;
/// Measurements; the median is printed.
const RUNS: usize = 7;

/// A world that answers from fields.
struct Room {
    visible: bool,
    at_goal: bool,
    acts: u64,
}

impl World for Room {
    fn robot_distance_m(&self) -> Option<f64> {
        Some(4.0)
    }
    fn robot_visible(&self, _within_m: f64) -> bool {
        self.visible
    }
    fn robot_blocking(&self, _within_m: f64) -> bool {
        false
    }
    fn robot_moving(&self) -> bool {
        true
    }
    fn robot_gesture(&self) -> Option<Gesture> {
        None
    }
    fn human_gesture(&self, _id: HumanId) -> Option<Gesture> {
        None
    }
    fn goal_reached(&self) -> bool {
        self.at_goal
    }
    fn next_goal(&mut self) {
        self.acts += 1;
    }
    fn at_encounter(&self) -> bool {
        false
    }
    fn now(&self) -> SimTime {
        SimTime::ZERO
    }
    fn step_s(&self) -> f64 {
        0.01
    }
    fn act(&mut self, _action: &Action, leaf: u16) {
        self.acts += u64::from(leaf);
    }
    fn gesture(&mut self, _gesture: Option<Gesture>) {}
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn ns_per_tick(tree: &Tree, agents: usize) -> f64 {
    let entries = BTreeMap::from([("id".to_owned(), "1".to_owned()), ("dt".to_owned(), "0.01".to_owned())]);
    let mut states: Vec<TreeState> = (0..agents).map(|_| tree.start_with(&entries)).collect();
    let rounds = TICKS / agents;
    let mut room = Room { visible: true, at_goal: false, acts: 0 };
    let measured = (0..RUNS)
        .map(|_| {
            let before = cpu_s();
            for _ in 0..rounds {
                for (agent, state) in states.iter_mut().enumerate() {
                    room.visible = agent % 2 == 0;
                    tree.tick(state, &mut room);
                }
            }
            (cpu_s() - before) * 1e9 / (rounds * agents) as f64
        })
        .collect();
    assert!(room.acts > 0, "nobody acted");
    median(measured)
}

fn main() {
    let options = Options { library: Library::HunavSim1_0, ..Options::default() };
    let tree = Tree::parse_with(CURIOUS, &options).expect("the curious tree loads");
    println!("{}", machine::told(&format!("ticks of the curious tree, {} nodes, one thread", tree.node_names().len())));
    println!(
        "{:>8} {:>12} {:>14} {:>14} {:>12}",
        "agents", "ns per tick", "ticks per s", "budget 150 ns", "bytes each"
    );
    for agents in [50, 1000, 10_000] {
        let ns = ns_per_tick(&tree, agents);
        let bytes = tree.start().bytes();
        println!("{agents:>8} {ns:>12.1} {:>14.2e} {:>13.0}% {bytes:>12}", 1e9 / ns, 100.0 * ns / 150.0);
    }
    let started = cpu_s();
    let parses = 2000;
    for _ in 0..parses {
        assert!(Tree::parse_with(CURIOUS, &options).is_ok());
    }
    println!("reading it from XML: {:.1} us", (cpu_s() - started) * 1e6 / f64::from(parses));
}
