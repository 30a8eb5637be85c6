//! A subscriber of one's own on the same machine: every tick of a run from shared memory, in CSV on standard output.
//!
//! ```text
//! socrates run my.toml --pace 1        # in one terminal; line 3 of `runs/my-1/.socrates/endpoint` is the root of its shared memory
//! cargo run --release -p socrates-stream --features shm --example shared_memory -- ROOT my-1.reference-1
//! ```
//!
//! It ends when nothing came for ten seconds.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints what it receives")]

use std::error::Error;
use std::os::unix::fs::MetadataExt as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use socrates_model::RunId;
use socrates_stream::{ShmConfig, ShmHost, ShmWatch};

/// How long nothing may come.
const SILENCE: Duration = Duration::from_secs(10);

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "usage: shared_memory ROOT RUN";
    let (root, run) = (PathBuf::from(args.next().ok_or(usage)?), RunId::new(args.next().ok_or(usage)?)?);
    let user = std::fs::metadata(&root)?.uid();
    let host = ShmHost::new(ShmConfig { root, prefix: format!("socrates_{user}_"), user });
    let mut heard = Instant::now();
    // The run makes its corner when it begins.
    let mut watch = loop {
        match ShmWatch::open(&run, &host) {
            Ok(watch) => break watch,
            Err(why) if heard.elapsed() > SILENCE => return Err(why.into()),
            Err(_) => std::thread::yield_now(),
        }
    };
    println!("tick,agent,x,y,yaw");
    while heard.elapsed() < SILENCE {
        let Some(states) = watch.poll()? else {
            std::thread::yield_now();
            continue;
        };
        heard = Instant::now();
        for state in states {
            println!("{},{},{:.3},{:.3},{:.3}", state.tick, state.agent_id(), state.x, state.y, state.yaw);
        }
    }
    let lost: u64 = watch.missing().iter().map(|range| range.len()).sum();
    eprintln!("{lost} ticks were overwritten before they were read");
    Ok(())
}
