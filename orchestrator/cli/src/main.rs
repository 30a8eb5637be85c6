//! SocRATES on the command line: the one program, from `demo` to the processes of a cluster.
//!
//! ```text
//! args ─► config ─► prepare ─► session (supervise: orchestrator + workers) ─► bundle ─► talk
//! ```
//!
//! *Never here:* a rule of authoring, simulation, scoring or retry. Only here: the environment, arguments,
//! printing and exit codes.

mod again;
mod agents;
mod agreement;
mod args;
mod ask;
mod authors;
mod batch;
mod bench;
mod bt;
#[cfg(test)]
mod build_id;
mod bundle;
mod bundler;
#[cfg(test)]
mod case_studies;
mod chat;
mod cite;
mod cluster;
mod config;
mod cost;
mod dev;
mod evaluate;
mod exit;
mod explain;
mod figure;
mod figures;
mod files;
mod folder;
mod fuzz;
mod golden;
mod history;
mod index;
mod labels;
mod library;
mod many;
mod map;
mod mutations;
mod new_request;
mod next;
#[cfg(test)]
mod online;
mod orchestrate;
mod place;
mod play;
mod prepare;
mod process;
mod progress;
mod report;
mod run;
mod scenarios;
mod scribe;
mod session;
mod stages;
mod standing;
mod supervise;
mod talk;
mod tokens;
mod traces;
mod video;
mod watch;

use std::io::IsTerminal as _;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser as _;

use crate::args::{Cli, ClusterVerb, SimulateOptions, Verb};
use crate::config::Config;
use crate::exit::{Code, Complaint};
use crate::standing::Listed;
use crate::talk::Talk;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(why) => {
            drop(why.print());
            return ExitCode::from(if why.use_stderr() { Code::Input as u8 } else { Code::Ok as u8 });
        }
    };
    let talk = Talk::new(cli.format);
    let code = match begin(&talk, &cli) {
        Ok(code) => code,
        // A child tells its supervisor, who tells the person once.
        Err(complaint) if cli.verb.is_tied() => {
            talk.last_word(&complaint.object());
            if complaint.code == Code::Input { Code::Stuck } else { complaint.code }
        }
        Err(complaint) => {
            // Who left on purpose made no error.
            let word = if complaint.code == Code::Waits { "" } else { "error: " };
            talk.warn(&format!("{word}{complaint}"));
            talk.result(&complaint.object());
            complaint.code
        }
    };
    ExitCode::from(code as u8)
}

fn begin(talk: &Talk, cli: &Cli) -> Result<Code, Complaint> {
    let config = Config::load(cli.flags.config.as_deref(), std::env::vars(), &cli.flags.set)?;
    start_log(&config)?;
    let talk = &talk.with_pause(Duration::from_secs(config.number("log.progress_s")));
    let runtime =
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().map_err(|why| {
            Complaint::input(format!("no threads can be started: {why}"), "`socrates doctor`").with_code(Code::Ours)
        })?;
    let code = runtime.block_on(act(talk, cli, &config));
    // A blocked reader of a child's pipe must not hold the exit.
    runtime.shutdown_background();
    code
}

async fn act(talk: &Talk, cli: &Cli, config: &Config) -> Result<Code, Complaint> {
    let done = |outcome: Result<(), Complaint>| outcome.map(|()| Code::Ok);
    match &cli.verb {
        Verb::Demo(options) => run::demo(talk, cli, config, options).await,
        Verb::Run { requests, options } => run::run(talk, cli, config, requests, options).await,
        Verb::New { file, location } => done(new_request::new(talk, file, location).await),
        Verb::Read { request } => {
            let prepared = prepare::prepare(request, None, config)?;
            run::print_reading(talk, &prepared);
            talk.result(&serde_json::json!({ "reading": prepared.reading }));
            Ok(Code::Ok)
        }
        Verb::Open { bundle } => done(explain::open(talk, bundle)),
        Verb::Report { what } => done(report::report(talk, what)),
        Verb::Video(options) => done(video::video(talk, options)),
        Verb::Figure(options) => done(figure::figure(talk, options)),
        Verb::Cost { what, prices } => done(cost::cost(talk, config, what, prices.as_deref())),
        Verb::Cite { bundle } => done(cite::cite(talk, bundle)),
        Verb::Labels { verb } => done(labels::labels(talk, verb)),
        Verb::Simulate(options) if agents::is_agents_file(&options.what) => done(agents::simulate(talk, options)),
        Verb::Simulate(options) => {
            let SimulateOptions { what, planner, seed, out, .. } = options;
            done(again::simulate(talk, what, planner.as_deref(), *seed, out.as_ref()))
        }
        Verb::Bt { verb } => done(bt::bt(talk, verb)),
        Verb::Score(options) => done(again::score(talk, options)),
        Verb::Watch { what, run } => done(watch::watch(talk, what, run.as_deref()).await),
        Verb::Status { what, failed, all } => {
            let listed = match (*all, *failed) {
                (true, _) => Listed::All,
                (false, true) => Listed::Failed,
                (false, false) => Listed::None,
            };
            done(standing::status(talk, what, listed).await)
        }
        Verb::Explain { code } => done(explain::explain(talk, code)),
        Verb::Doctor => done(explain::doctor(talk, config)),
        Verb::Config { part } => done(explain::config(talk, config, part.as_deref())),
        Verb::Map { verb } => done(map::map(talk, verb)),
        Verb::Library { verb } => done(chat::library(talk, verb)),
        Verb::Scenarios { verb } => done(scenarios::scenarios(talk, verb).await),
        Verb::Evaluate { verb } => done(evaluate::evaluate(talk, cli, config, verb).await),
        Verb::Cluster { verb } => match verb {
            ClusterVerb::Up(options) => done(process::orchestrator(talk, config, options).await),
            ClusterVerb::Worker(options) => done(process::worker(config, options).await),
            ClusterVerb::Submit { requests, connect, namespace, seed } => {
                done(cluster::submit(talk, config, requests, connect, namespace, *seed).await)
            }
        },
        Verb::Dev { verb } => done(dev::dev(talk, cli, config, verb).await),
        Verb::Worker(options) => done(process::worker(config, options).await),
        Verb::Orchestrator(options) => done(process::orchestrator(talk, config, options).await),
    }
}

fn start_log(config: &Config) -> Result<(), Complaint> {
    let filter = tracing_subscriber::EnvFilter::try_new(config.text("log.filter")).map_err(|why| {
        Complaint::input(
            format!("`log.filter` is not a filter: {why}"),
            "for example \"warn\" or \"socrates_kit=debug\"",
        )
    })?;
    // Codes of colors are for terminals; in a file or a pipe they are letters that nobody wrote.
    let colored = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|text| text.is_empty());
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(colored)
        .with_writer(std::io::stderr)
        .without_time()
        .compact()
        .init();
    Ok(())
}
