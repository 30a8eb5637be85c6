//! What clients have done about jobs and hear of it, and why jobs stand where they do.

use socrates_model::fault::{FailureClass, FaultCode};
use socrates_model::job::Stage;
use socrates_model::wire::{
    Acquired, Beat, Chosen, Control, Hello, JobAsk, NoWork, Pace, Part, Priority, StatusAsk, Steer, Steered, Submit,
    Wait, Welcome,
};

use crate::histories::replay;
use crate::world::{World, fault, spec};
use crate::{Answer, Event, JobState, Policy, ScenarioEnd, State, status, whys_of_rows};

fn steer(world: &mut World, steer: Steer) -> Steered {
    match world.send(|to| Event::Control { control: Control::Steer(steer), to }) {
        Some(Answer::Steered(steered)) => steered,
        other => panic!("{other:?}"),
    }
}

/// Two batches: `b` with `a1` and `a2`, `c` with `c1`.
fn two_batches() -> World {
    let mut world = World::new();
    world.submit(vec![spec("a1"), spec("a2")]);
    let submit = Submit::new("c", Priority::Normal, vec![spec("c1")]);
    world.send(|to| Event::Submit { submit, to });
    world
}

fn left(steered: &Steered) -> Vec<String> {
    steered.left.iter().map(|left| format!("{} {}: {}", left.count, left.some.join(" "), left.why)).collect()
}

/// What keeps the jobs of a stage.
fn why(world: &World, job: &str) -> Vec<Wait> {
    let ask = StatusAsk { job: Some(job.parse().unwrap()), ..StatusAsk::default() };
    let reply = status(&world.state, &ask, world.now);
    assert!(reply.scenarios.is_empty() && reply.batches.is_empty(), "only what was asked for");
    reply.whys.unwrap().into_iter().flat_map(|why| why.why).collect()
}

#[test]
fn a_stage_is_held_back_alone_and_over_a_restart() {
    let mut world = two_batches();
    world.pass(Stage::Proposal);
    let steered = steer(&mut world, Steer::Pause(Part::Stage(Stage::Proposal)));
    assert_eq!((steered.scenarios, steered.jobs, steered.held, left(&steered).len()), (2, 2, 0, 0), "{steered:?}");
    let refused = world.ask("w", &[Stage::Proposal], 1);
    assert!(matches!(refused, Acquired::None { reason: NoWork::Paused, .. }), "{refused:?}");
    assert!(why(&world, "a2/proposal").contains(&Wait::Paused(Part::Stage(Stage::Proposal))));
    world.pass(Stage::Paths);
    world.state = State::restore(replay(&world.rows), Policy::default(), world.now);
    world.send(|_| Event::Recover { alone: false });
    assert!(matches!(world.ask("w", &[Stage::Proposal], 1), Acquired::None { reason: NoWork::Paused, .. }));
    let again = steer(&mut world, Steer::Pause(Part::Stage(Stage::Proposal)));
    assert_eq!(left(&again), ["1 proposal: was held back already"]);
    steer(&mut world, Steer::Resume(Part::Stage(Stage::Proposal)));
    world.pass(Stage::Proposal);
}

#[test]
fn a_batch_that_is_not_there_is_named_with_those_that_are() {
    let mut world = two_batches();
    let part = || Part::Batch("x".to_owned());
    let chosen = || Chosen::Batch("x".to_owned());
    for wish in [Steer::Pause(part()), Steer::Resume(part()), Steer::Cancel(chosen()), Steer::Requeue(chosen())] {
        let steered = steer(&mut world, wish);
        assert_eq!(left(&steered), ["1 x: there is no batch of this name; known: `b`, `c`"]);
        assert_eq!((steered.scenarios, steered.jobs, steered.held), (0, 0, 0));
    }
    assert!(world.state.paused.is_empty(), "nothing is held back by a slip of the pen");
}

#[test]
fn resuming_a_batch_while_everything_is_held_back_says_what_helps() {
    let mut world = two_batches();
    steer(&mut world, Steer::Pause(Part::All));
    steer(&mut world, Steer::Pause(Part::Batch("c".to_owned())));
    let steered = steer(&mut world, Steer::Resume(Part::Batch("c".to_owned())));
    assert_eq!(left(&steered), ["1 c: everything is held back; resuming everything lets it go on"]);
    assert!(steer(&mut world, Steer::Resume(Part::All)).left.is_empty());
    world.pass(Stage::Proposal);
}

#[test]
fn scenarios_are_given_up_by_name_and_the_others_go_on() {
    let mut world = two_batches();
    let held = world.grant("w", Stage::Proposal);
    let names = ["a1", "a2", "nobody"].map(|name| name.parse().unwrap()).to_vec();
    let steered = steer(&mut world, Steer::Cancel(Chosen::Scenarios(names.clone())));
    // A chain has five jobs; the first of one scenario is in a worker's hand.
    assert_eq!((steered.scenarios, steered.jobs, steered.held), (2, 9, 1), "{steered:?}");
    assert_eq!(left(&steered), ["1 nobody: is not known here"]);
    assert_eq!(world.state_of(&held), JobState::Canceling);
    assert_eq!(world.scenario("a2").end, Some(ScenarioEnd::Canceled));
    let again = steer(&mut world, Steer::Cancel(Chosen::Scenarios(names)));
    assert_eq!((again.scenarios, again.left.len()), (0, 3), "{again:?}");
    assert_eq!(world.pass(Stage::Proposal).spec.key.scenario.as_str(), "c1");
}

#[test]
fn what_died_is_tried_once_more_and_the_rest_is_named_by_reason() {
    let mut world = two_batches();
    let grant = world.grant("w", Stage::Proposal);
    world.fail(&grant, FailureClass::Permanent, vec![fault(FaultCode::TAuth, "no key")]);
    assert_eq!(why(&world, "a1/proposal"), [Wait::Ended("T-AUTH".to_owned())]);
    steer(&mut world, Steer::Cancel(Chosen::Batch("c".to_owned())));
    let steered = steer(&mut world, Steer::Requeue(Chosen::All));
    assert_eq!((steered.scenarios, steered.jobs), (1, 5), "{steered:?}");
    let told = left(&steered);
    assert_eq!(
        told,
        ["1 a2: has no dead or failed job; it is going on", "1 c1: was given up; submit it under another name"]
    );
    assert_eq!(world.grant("w", Stage::Proposal).attempt, 2);
}

#[test]
fn it_is_said_what_a_job_waits_for() {
    let mut world = two_batches();
    assert_eq!(why(&world, "a1/proposal"), [Wait::NoWorker]);
    let parent = why(&world, "a1/paths");
    assert!(matches!(&parent[..], [Wait::Parent { key, state: JobState::Ready }] if key.stage == Stage::Proposal));
    let grant = world.grant("w", Stage::Proposal);
    // Batches take turns: the first of the other one is before the second of this one.
    assert_eq!(why(&world, "c1/proposal"), [Wait::Line { before: 0, workers: 1, busy: 1 }]);
    assert_eq!(why(&world, "a2/proposal"), [Wait::Line { before: 1, workers: 1, busy: 1 }]);
    world.now += 3_000;
    let held = why(&world, "a1/proposal");
    let [Wait::Held { instance, attempt: 1, for_ms: 3_000, beat_ms: 3_000, deadline_ms: 117_000, .. }] = &held[..]
    else {
        panic!("{held:?}")
    };
    assert_eq!(instance, "w");
    world.fail(&grant, FailureClass::Transient, vec![fault(FaultCode::TNet, "no route")]);
    let waits = why(&world, "a1/proposal");
    assert!(matches!(&waits[..], [Wait::Backoff { in_ms: 1.., after }] if after == "T-NET"), "{waits:?}");
    // The same rows, read where nobody serves them.
    let ask: JobAsk = "a1".parse().unwrap();
    let told = whys_of_rows(replay(&world.rows), &ask);
    assert_eq!(told[0].why[0], Wait::Unserved);
    assert!(matches!(told[0].why[1], Wait::Backoff { .. }), "{told:?}");
    assert!(whys_of_rows(replay(&world.rows), &JobAsk::of("nobody".parse().unwrap())).is_empty());
}

#[test]
fn a_worker_of_another_version_is_told_apart_from_none() {
    let mut world = World::with(Policy { code_version: "2".to_owned(), ..Policy::default() });
    world.submit(vec![spec("a")]);
    let hello = Hello {
        instance: "old".to_owned(),
        stages: vec![Stage::Proposal],
        code_version: "1".to_owned(),
        pid: 1,
        host: String::new(),
    };
    let welcome = world.send(|to| Event::Hello { hello, to });
    assert!(matches!(welcome, Some(Answer::Welcome(Welcome::Incompatible { .. }))), "{welcome:?}");
    let wait = Wait::Version { wanted: "2".to_owned(), found: "1".to_owned() };
    assert_eq!(why(&world, "a/proposal"), std::slice::from_ref(&wait));
    // One that asks without a word before is no worker of the stage either.
    assert!(matches!(world.ask("other", &[Stage::Proposal], 1), Acquired::None { reason: NoWork::Version, .. }));
    assert_eq!(why(&world, "a/proposal"), [wait]);
}

#[test]
fn the_rate_of_a_server_and_the_limit_of_begun_scenarios_are_named() {
    let mut world = World::with(Policy { requests_per_minute: 1, open_per_worker: 1, ..Policy::default() });
    let mut specs: Vec<_> = (0..9).map(|n| spec(&format!("s{n}"))).collect();
    specs[8].settings.insert("author".to_owned(), "openai:m".to_owned());
    world.submit(specs);
    assert_eq!(world.grants("w", Stage::Proposal).len(), 8);
    assert!(why(&world, "s8/proposal").contains(&Wait::Begun { most: 8 }));
    let mut world = World::with(Policy { requests_per_minute: 1, ..Policy::default() });
    let asks = ["x", "y"].map(|name| {
        let mut spec = spec(name);
        spec.settings.insert("author".to_owned(), "openai:m".to_owned());
        spec
    });
    world.submit(asks.to_vec());
    assert_eq!(world.grants("w", Stage::Proposal).len(), 1);
    let waits = why(&world, "y/proposal");
    assert!(waits.contains(&Wait::Rate { server: "openai:m".to_owned(), in_ms: 60_000 }), "{waits:?}");
}

#[test]
fn batches_are_listed_with_their_pace_and_an_idle_night_does_not_count() {
    let mut world = two_batches();
    world.state.clock_ms = 1_000_000;
    let grant = world.grant("w", Stage::Proposal);
    world.now += 10_000;
    world.fail(&grant, FailureClass::Permanent, Vec::new());
    world.now += 3_600_000;
    let reply = status(&world.state, &StatusAsk::default(), world.now);
    let told: Vec<_> = reply.batches.iter().map(|b| (b.name.as_str(), b.total, b.done, b.failed)).collect();
    assert_eq!((told, reply.batches_left), (vec![("b", 2, 1, 1), ("c", 1, 0, 0)], 0));
    let pace = Pace { ended: 1, work_ms: 10_000, idle_ms: Some(3_600_000) };
    assert_eq!((reply.pace, reply.batches[0].pace), (Some(pace), pace));
    assert_eq!(reply.batches[1].pace.ended, 0);
    let one = status(&world.state, &StatusAsk { batch: "c".to_owned(), ..StatusAsk::default() }, world.now);
    assert_eq!((one.total, one.done, one.scenarios.len(), one.running), (1, 0, 1, 0));
    // Since when a batch is there is known from the shell's clock.
    let submit = Submit::new("d", Priority::Normal, vec![spec("d1")]);
    world.send(|to| Event::Submit { submit, to });
    let reply = status(&world.state, &StatusAsk::default(), world.now);
    assert_eq!(reply.batches[2].since_ms, 1_000_000 + world.now);
}

#[test]
fn a_batch_that_is_done_took_its_time_and_keeps_its_priority_over_a_restart() {
    let mut world = World::new();
    world.state.clock_ms = 1_000_000;
    let submit = Submit::new("night", Priority::Bulk, vec![spec("n1")]);
    world.send(|to| Event::Submit { submit, to });
    let told = |world: &World| {
        let batch = status(&world.state, &StatusAsk::default(), world.now).batches.remove(0);
        (batch.priority, batch.since_ms, batch.ended_ms)
    };
    let began = 1_000_000 + world.now;
    assert_eq!(told(&world), (Priority::Bulk, began, 0), "what is open has not ended");
    let grant = world.grant("w", Stage::Proposal);
    world.now += 10_000;
    world.fail(&grant, FailureClass::Permanent, Vec::new());
    let ended = 1_000_000 + world.now;
    world.now += 3_600_000;
    assert_eq!(told(&world), (Priority::Bulk, began, ended));
    world.state = State::restore(replay(&world.rows), Policy::default(), world.now);
    assert_eq!(told(&world), (Priority::Bulk, began, ended));
}

#[test]
fn resuming_where_nothing_is_held_back_says_so_and_touches_no_job() {
    let mut world = two_batches();
    let steered = steer(&mut world, Steer::Resume(Part::All));
    assert_eq!(left(&steered), ["1 everything: nothing was held back"]);
    assert_eq!((steered.scenarios, steered.jobs, steered.held), (0, 0, 0));
    steer(&mut world, Steer::Pause(Part::Stage(Stage::Paths)));
    let steered = steer(&mut world, Steer::Resume(Part::All));
    assert!(steered.left.is_empty() && steered.jobs > 0, "{steered:?}");
}

#[test]
fn every_attempt_says_its_trace_and_says_the_same_after_a_restart() {
    let mut world = two_batches();
    let first = world.grant("w", Stage::Proposal);
    let trace = world.state.scenarios[&first.spec.key.scenario].trace();
    assert_eq!(first.traceparent, Some(trace.of_attempt(&first.spec.key, 1)));
    world.fail(&first, FailureClass::Semantic, vec![fault(FaultCode::PCount, "one too many")]);
    world.state = State::restore(replay(&world.rows), Policy::default(), world.now);
    world.send(|_| Event::Recover { alone: false });
    world.now += 60_000;
    world.send(|_| Event::Tick);
    let again = world.grants("w", Stage::Proposal);
    let again = again.iter().find(|grant| grant.spec.key == first.spec.key).unwrap();
    assert_eq!((again.attempt, again.traceparent), (2, Some(trace.of_attempt(&first.spec.key, 2))));
}

#[test]
fn a_worker_that_did_not_say_who_it_is_since_a_restart_is_not_listed() {
    let mut world = two_batches();
    let beat = Beat { instance: "ghost".to_owned(), held: Vec::new(), draining: false };
    world.send(|to| Event::Beat { beat, to });
    let table = |world: &World| {
        let ask = StatusAsk { table: true, ..StatusAsk::default() };
        status(&world.state, &ask, world.now)
    };
    let reply = table(&world);
    assert_eq!(reply.table.as_ref().unwrap().workers.len(), 0, "{reply:?}");
    assert_eq!(reply.batches.len(), 2, "the table comes with the batches");
    world.grant("ghost", Stage::Proposal);
    assert_eq!(table(&world).table.unwrap().workers.len(), 1);
}

#[test]
fn the_table_tells_of_stages_workers_and_failures() {
    let mut world = two_batches();
    let grant = world.grant("w", Stage::Proposal);
    world.now += 400;
    world.fail(&grant, FailureClass::Semantic, vec![fault(FaultCode::PCount, "one too many")]);
    world.pass(Stage::Proposal);
    let table = status(&world.state, &StatusAsk { table: true, ..StatusAsk::default() }, world.now).table.unwrap();
    let proposal = table.stages.iter().find(|row| row.stage == Stage::Proposal).unwrap();
    assert_eq!(proposal.states.get(&JobState::Succeeded), Some(&1), "{proposal:?}");
    assert_eq!(proposal.p50_ms, Some(400));
    assert_eq!((table.workers.len(), table.workers[0].instance.as_str(), table.workers[0].holds), (1, "w", 0));
    let [failure] = &table.failures[..] else { panic!("{:?}", table.failures) };
    assert_eq!(
        (failure.class, failure.fault.as_ref().unwrap().code),
        (Some(FailureClass::Semantic), FaultCode::PCount)
    );
}

#[test]
fn a_table_of_many_workers_and_a_list_of_many_batches_fit_a_message() {
    let mut world = World::new();
    for number in 0..300 {
        let batch = format!("batch-{number:03}-{}", "x".repeat(80));
        let submit = Submit::new(batch, Priority::Normal, vec![spec(&format!("s{number:03}"))]);
        world.send(|to| Event::Submit { submit, to });
        let hello = Hello {
            instance: format!("{number:036}"),
            stages: Stage::WORKERS.to_vec(),
            code_version: String::new(),
            pid: 4_000_000,
            host: "h".repeat(200),
        };
        world.send(|to| Event::Hello { hello, to });
    }
    let fits = |reply: &socrates_model::wire::StatusReply| serde_json::to_vec(reply).unwrap().len() < 60 * 1024;
    let reply = status(&world.state, &StatusAsk::default(), world.now);
    assert!(fits(&reply) && !reply.scenarios.is_empty());
    assert!(reply.batches.len() > 20 && reply.batches_left == 300 - u32::try_from(reply.batches.len()).unwrap());
    assert_eq!(reply.batches.last().unwrap().total, 1);
    assert!(reply.batches.last().unwrap().name.starts_with("batch-299"), "the newest are listed");
    let shares = crate::overview::shares(&world.state, world.now);
    let named = shares.iter().filter(|share| !share.name.is_empty());
    assert!(named.clone().count() == 32 && named.clone().any(|share| share.name.starts_with("batch-299")));
    assert_eq!((shares.len(), shares.iter().map(|share| share.open).sum::<u32>()), (33, 300), "none is left out");
    let reply = status(&world.state, &StatusAsk { table: true, ..StatusAsk::default() }, world.now);
    let table = reply.table.as_ref().unwrap();
    assert!(fits(&reply) && u32::try_from(table.workers.len()).unwrap() + table.workers_left == 300, "{table:?}");
}
