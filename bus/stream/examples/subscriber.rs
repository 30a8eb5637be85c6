//! A subscriber of one's own: every tick of a run in CSV on standard output.
//!
//! ```text
//! socrates run my.toml --pace 1                      # in one terminal; `cat runs/my-1/.socrates/endpoint` tells the address
//! cargo run --release -p socrates-stream --example subscriber -- tcp/127.0.0.1:PORT run my-1.reference-1
//! ```
#![expect(clippy::print_stdout, reason = "an example prints what it receives")]

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, Mode, ZenohBus, ZenohConfig};
use socrates_model::RunId;
use socrates_stream::{Sight, Watch};

#[tokio::main]
async fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "usage: subscriber ENDPOINT NAMESPACE RUN";
    let (endpoint, namespace, run) = (args.next().ok_or(usage)?, args.next().ok_or(usage)?, args.next().ok_or(usage)?);
    let bus = ZenohBus::open(ZenohConfig::new(Mode::Client, &namespace, "subscriber").connect(&endpoint)).await?;
    let bus: Arc<dyn Bus> = Arc::new(bus);
    let mut watch = Watch::open(Arc::clone(&bus), &RunId::new(run)?, 6_000).await?;
    println!("tick,agent,x,y,yaw");
    while let Some(sight) = watch.next(Duration::from_secs(60)).await? {
        match sight {
            Sight::Tick { states, .. } => print(&states),
            // What was lost on the way is known exactly, and the run still has it.
            Sight::Missing(range) => print(&watch.fetch(range).await?),
            Sight::Header(_) | Sight::Event(_) => {}
            Sight::End { .. } => break,
        }
    }
    bus.close().await;
    Ok(())
}

fn print(states: &[socrates_model::AgentState]) {
    for state in states {
        println!("{},{},{:.3},{:.3},{:.3}", state.tick, state.agent_id(), state.x, state.y, state.yaw);
    }
}
