//! A tick through shared memory: from the simulation's call to the reader's last record, against iceoryx2 alone in the same run.
//!
//! ```text
//! cargo bench -p socrates-stream --features mcap,shm --bench shm
//! ```
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "a bench ends where it cannot measure, and prints what it measured"
)]

use std::time::Instant;

use iceoryx2::prelude::{
    AllocationStrategy, Config, FileName, LogLevel, NodeBuilder, Path, SemanticString as _, ipc_threadsafe,
};
use socrates_model::recording::{AgentState, Recording};
use socrates_model::{Onlooker as _, RunId};
use socrates_stream::{ShmConfig, ShmHost, ShmSink, ShmState, ShmWatch, csv};

/// Ticks of a case, in turns with those of the other.
const TICKS: u64 = 2_000;

fn crowd(agents: u32) -> (Recording, Vec<AgentState>) {
    let mut recording = csv::read_tracks("t,id,x,y\n0,human_1,0,0\n1,human_1,1,0\n").unwrap();
    let (info, state) = (recording.header.agents[0].clone(), recording.frames[0]);
    recording.header.agents = vec![info; agents as usize];
    let states = (0..agents).map(|agent| AgentState { agent, x: f64::from(agent), ..state }).collect();
    (recording, states)
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn case(agents: u32) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let user = {
        use std::os::unix::fs::MetadataExt as _;
        std::fs::metadata(folder.path()).unwrap().uid()
    };
    let prefix = format!("socb{}_", std::process::id());
    let config = |name: &str| ShmConfig { root: folder.path().join(name), prefix: format!("{prefix}{name}_"), user };
    let (recording, mut states) = crowd(agents);
    let run = RunId::new("bench").unwrap();
    let (writes, reads) = (ShmHost::new(config("ours")), ShmHost::new(config("ours")));
    let mut sink = ShmSink::open(&run, &writes).unwrap();
    sink.announce(&recording.header);
    let mut watch = ShmWatch::open(&run, &reads).unwrap();
    iceoryx2::prelude::set_log_level(LogLevel::Fatal);
    let bare = config("bare");
    let mut settings = Config::default();
    settings.global.set_root_path(&Path::new(bare.root.as_os_str().as_encoded_bytes()).unwrap());
    settings.global.prefix = FileName::new(bare.prefix.as_bytes()).unwrap();
    let node = NodeBuilder::new().config(&settings).create::<ipc_threadsafe::Service>().unwrap();
    let name = "bench".try_into().unwrap();
    let service = node.service_builder(&name).publish_subscribe::<[ShmState]>().open_or_create().unwrap();
    let publisher = service
        .publisher_builder()
        .initial_max_slice_len(agents as usize)
        .allocation_strategy(AllocationStrategy::Static)
        .create()
        .unwrap();
    let subscriber = service.subscriber_builder().create().unwrap();
    let (mut ours, mut theirs, mut sum) = (Vec::new(), Vec::new(), 0.0);
    let total = |states: &[ShmState]| states.iter().map(|state| state.x).sum::<f64>();
    for tick in 0..TICKS {
        states.iter_mut().for_each(|state| state.tick = tick);
        let begun = Instant::now();
        sink.tick(&states, &[]);
        sum += watch.look(total).unwrap().unwrap();
        ours.push(begun.elapsed().as_secs_f64());
        let begun = Instant::now();
        let sample = publisher.loan_slice_uninit(states.len()).unwrap();
        let mut left = states.iter();
        let sample = sample.write_from_fn(|_| ShmState::from(left.next().unwrap()));
        sample.send().unwrap();
        sum += total(subscriber.receive().unwrap().unwrap().payload());
        theirs.push(begun.elapsed().as_secs_f64());
    }
    assert!(sum > 0.0 && watch.missing().is_empty());
    (median(&mut ours) * 1e6, median(&mut theirs) * 1e6)
}

fn main() {
    println!("| agents | ours, us | iceoryx2 alone, us | ratio |");
    println!("|---|---|---|---|");
    for agents in [50, 10_000] {
        let (ours, theirs) = case(agents);
        println!("| {agents} | {ours:.2} | {theirs:.2} | {:.2} |", ours / theirs);
    }
}
