//! What becomes of a lease whose holder is gone: of a person, of a supervisor's worker, after a restart.

use socrates_model::fault::{FailureClass, FaultCode};
use socrates_model::job::Stage;
use socrates_model::wire::{Recorded, StatusAsk};

use crate::histories::replay;
use crate::world::{World, fault, spec, success};
use crate::{AttemptEnd, Event, JobState, Policy, State, status};

/// The same orchestrator, started again on what was saved.
fn restarted(mut world: World, alone: bool) -> World {
    world.now += 50;
    world.state = State::restore(replay(&world.rows), world.state.policy.clone(), world.now);
    world.send(|_| Event::Recover { alone });
    world
}

fn looked_at() -> World {
    let mut world = World::new();
    let mut asked = spec("a");
    asked.review = true;
    world.submit(vec![asked]);
    world.pass(Stage::Proposal);
    world
}

#[test]
fn a_persons_job_is_handed_out_again_however_often_it_is_lost() {
    let mut world = looked_at();
    for _ in 0..20 {
        let look = world.grant("person", Stage::Review);
        world.wait(world.state.policy.lease_ms + 1);
        assert_eq!(world.state_of(&look), JobState::Ready);
    }
    let look = world.grant("person", Stage::Review);
    assert_eq!(look.attempt, 21);
    assert_eq!(world.succeed(&look), Recorded::Accepted);
    world.pass(Stage::Paths);
}

#[test]
fn a_person_who_beats_keeps_their_look_for_weeks() {
    let mut world = looked_at();
    let look = world.grant("person", Stage::Review);
    for _ in 0..50 {
        // Half a day each; the beats between are left out, the clock of the lease is not.
        world.now += 43_200_000;
        world.beat("person", &[&look]);
        world.wait(0);
        assert_eq!(world.state_of(&look), JobState::Leased);
    }
    assert_eq!(world.succeed(&look), Recorded::Accepted);
}

#[test]
fn where_no_worker_of_before_lives_nobody_waits_for_a_lease() {
    let mut world = looked_at();
    for round in 1..=9 {
        let look = world.grant("person", Stage::Review);
        assert_eq!(look.attempt, round);
        world = restarted(world, true);
        let job = &world.state.jobs[&look.spec.key];
        assert_eq!((job.state, job.tries.lapses), (JobState::Ready, 0), "at once, and it counts against nobody");
        assert_eq!(job.attempts.last().unwrap().end, Some(AttemptEnd::Lapsed));
    }
    // What a worker had finished before it was killed, and reports now out of its spool, is taken.
    let look = world.grant("person", Stage::Review);
    world = restarted(world, true);
    assert_eq!(world.send_report(success(&look)), Recorded::Accepted);
}

#[test]
fn where_workers_live_on_their_leases_do_too() {
    let mut world = World::new();
    world.submit(vec![spec("a")]);
    let proposal = world.grant("w", Stage::Proposal);
    world = restarted(world, false);
    assert_eq!(world.state_of(&proposal), JobState::Leased);
    assert_eq!(world.succeed(&proposal), Recorded::Accepted);
}

#[test]
fn a_worker_that_only_beats_after_a_restart_is_counted_again() {
    let mut world = World::new();
    world.submit(vec![spec("a")]);
    world = restarted(world, false);
    world.beat("w", &[]);
    world.grants("w", Stage::Scoring);
    let about = StatusAsk::default();
    let reply = status(&world.state, &about, world.now);
    assert_eq!(reply.workers.get("scoring"), Some(&1), "{:?}", reply.workers);
}

#[test]
fn a_question_without_an_answer_is_put_as_often_as_is_configured() {
    let mut world = World::with(Policy::default().asking_again(2));
    world.submit(vec![spec("a")]);
    let mut asked = 0;
    while let Some(grant) = world.grants("w", Stage::Proposal).first() {
        asked += 1;
        world.fail(grant, FailureClass::Transient, vec![fault(FaultCode::TTimeout, "90 s")]);
        world.wait(world.state.policy.backoff_cap_ms);
    }
    assert_eq!(asked, 3, "once, and twice again");
    // Passing trouble of the network is another matter.
    world.submit(vec![spec("b")]);
    let mut tried = 0;
    while let Some(grant) = world.grants("w", Stage::Proposal).first() {
        tried += 1;
        world.fail(grant, FailureClass::Transient, vec![fault(FaultCode::TNet, "no route")]);
        world.wait(world.state.policy.backoff_cap_ms);
    }
    assert_eq!(tried, 9);
}
