//! The rules by which jobs change state and failures are treated, one test each.

use socrates_model::Role;
use socrates_model::fault::{FailureClass, Fault, FaultCode};
use socrates_model::job::{Item, Stage};
use socrates_model::report::{Repair, Verdict};
use socrates_model::wire::{
    Acquired, BeatVerdict, Control, Grant, NoWork, Outcome, Recorded, Release, Report, StatusAsk, Submitted,
};

use crate::world::{World, fault, report, spec, success};
use crate::{AttemptEnd, Effect, Event, JobState, Policy, Row, ScenarioEnd, status};

fn begun() -> World {
    let mut world = World::new();
    assert_eq!(world.submit(vec![spec("a")]), Submitted::Accepted { new: 1, held: 0 });
    world
}

#[test]
fn a_scenario_goes_through_all_stages_and_ends_once() {
    let mut world = begun();
    let scoring = world.reach_scoring();
    assert_eq!(world.scenario("a").end, None);
    let roles: Vec<&str> = scoring.spec.inputs.keys().map(|role| role.name()).collect();
    assert_eq!(roles, ["behaviors", "location", "paths", "proposal", "reading", "recording", "request"]);
    world.score(&scoring, Verdict::Realised, None);
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Judged(Verdict::Realised)));
    let ended = world.effects.iter().filter(|effect| matches!(effect, Effect::ScenarioDone { .. })).count();
    assert_eq!(ended, 1);
}

#[test]
fn rows_come_before_replies_and_replies_before_hints() {
    let mut world = begun();
    let rank = |effect: &Effect| match effect {
        Effect::Save(_) => 0,
        Effect::Reply { .. } => 1,
        Effect::Notice { .. } => 2,
        Effect::Hint(_) => 3,
        Effect::ScenarioDone { .. } => 4,
    };
    let grant = world.grant("w", Stage::Proposal);
    world.succeed(&grant);
    assert!(world.effects.is_sorted_by_key(rank));
    assert!(world.effects.contains(&Effect::Hint(Stage::Paths)));
}

#[test]
fn the_same_question_gets_the_same_grants() {
    let mut world = begun();
    let first = world.ask_as("w", &[Stage::Proposal], 1, "q");
    assert!(matches!(&first, Acquired::Grants(grants) if grants.len() == 1));
    assert_eq!(world.ask_as("w", &[Stage::Proposal], 1, "q"), first);
    assert!(matches!(world.ask_as("w", &[Stage::Proposal], 1, "r"), Acquired::None { .. }));
}

#[test]
fn the_same_wish_twice_is_one_scenario_and_another_under_its_name_is_refused() {
    let mut world = begun();
    assert_eq!(world.submit(vec![spec("a"), spec("b")]), Submitted::Accepted { new: 1, held: 0 });
    let mut other = spec("a");
    other.seed = 8;
    assert!(matches!(world.submit(vec![spec("c"), other]), Submitted::Refused { .. }));
    assert_eq!(world.state.counts().0, 2, "a refused submission leaves nothing");
}

#[test]
fn beats_keep_a_lease_and_silence_ends_it() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    for _ in 0..5 {
        world.wait(10_000);
        assert_eq!(world.beat("w", &[&grant]).verdicts[0].2, BeatVerdict::Ok);
    }
    world.wait(15_000);
    assert_eq!(world.state_of(&grant), JobState::Ready);
    assert_eq!(world.beat("w", &[&grant]).verdicts[0].2, BeatVerdict::Lost);
    assert_eq!(world.grant("v", Stage::Proposal).attempt, 2);
}

#[test]
fn a_vanished_worker_has_its_grace_and_no_more() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    world.send(|_| Event::Gone { instance: "w".to_owned() });
    world.wait(1_999);
    assert_eq!(world.state_of(&grant), JobState::Leased);
    world.wait(1);
    assert_eq!(world.state_of(&grant), JobState::Ready);

    let grant = world.grant("w", Stage::Proposal);
    world.send(|_| Event::Gone { instance: "w".to_owned() });
    world.beat("w", &[&grant]);
    world.wait(3_000);
    assert_eq!(world.state_of(&grant), JobState::Leased, "a beat within the grace restores the lease");
}

#[test]
fn a_job_that_loses_three_workers_is_dead() {
    let mut world = begun();
    for n in 0..3 {
        let grant = world.grant(&format!("w{n}"), Stage::Proposal);
        world.wait(15_000);
        let left = if n < 2 { JobState::Ready } else { JobState::Dead };
        assert_eq!(world.state_of(&grant), left);
    }
    assert_eq!(world.job("a", Stage::Paths, Item::Whole, 0).state, JobState::Failed, "what needs it fails with it");
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Failed));
}

#[test]
fn a_late_result_wins_while_nobody_else_has_one() {
    let mut world = begun();
    let late = world.grant("w", Stage::Proposal);
    world.wait(15_000);
    let newer = world.grant("v", Stage::Proposal);
    assert_eq!(world.succeed(&late), Recorded::Accepted);
    assert_eq!(world.state_of(&late), JobState::Succeeded);
    assert_eq!(world.beat("v", &[&newer]).verdicts[0].2, BeatVerdict::Cancel);
    assert_eq!(world.succeed(&newer), Recorded::Late);
    assert_eq!(world.succeed(&late), Recorded::Duplicate);
    let results = world.rows.iter().filter(|row| matches!(row, Row::Result(..))).count();
    assert_eq!(results, 1);
}

#[test]
fn a_late_answer_to_an_older_question_does_not_count() {
    let mut world = begun();
    let late = world.grant("w", Stage::Proposal);
    world.wait(15_000);
    let newer = world.grant("v", Stage::Proposal);
    world.fail(&newer, FailureClass::Semantic, vec![fault(FaultCode::PPlace, "no such place")]);
    assert_eq!(world.succeed(&late), Recorded::Late);
    assert_eq!(world.state_of(&late), JobState::Ready);
}

#[test]
fn a_wrong_fence_changes_nothing() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    let forged = Report { fence: grant.fence + 1, ..success(&grant) };
    assert_eq!(world.send_report(forged), Recorded::Late);
    assert_eq!(world.state_of(&grant), JobState::Leased);
}

#[test]
fn a_worker_cannot_report_or_hand_back_what_another_was_granted() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    let forged = Report { instance: "thief".to_owned(), ..success(&grant) };
    assert_eq!(world.send_as_it_is(forged), Recorded::Late);
    let key = grant.spec.key.clone();
    let release = Release { instance: "thief".to_owned(), key, attempt: grant.attempt, fence: grant.fence };
    assert_eq!(world.send_release(release), Recorded::Late);
    assert_eq!(world.state_of(&grant), JobState::Leased);
    assert_eq!(world.succeed(&grant), Recorded::Accepted);
}

#[test]
fn a_released_job_goes_to_another_worker_and_costs_nothing() {
    let mut world = begun();
    for _ in 0..20 {
        let grant = world.grant("w", Stage::Proposal);
        assert_eq!(world.release(&grant), Recorded::Accepted);
        assert_eq!(world.release(&grant), Recorded::Duplicate);
        assert_eq!(world.state_of(&grant), JobState::Ready);
    }
}

#[test]
fn transient_failures_wait_longer_and_longer_until_the_budget_is_spent() {
    let mut world = begun();
    for n in 1..=9 {
        world.wait(60_000);
        let grant = world.grant("w", Stage::Proposal);
        world.fail(&grant, FailureClass::Transient, vec![fault(FaultCode::TNet, "down")]);
        let dead = world.state_of(&grant) == JobState::Dead;
        assert_eq!(dead, n == 9, "after failure {n}");
    }
}

#[test]
fn a_stated_wait_is_kept() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    let outcome = Outcome::Failed { class: FailureClass::Overload, faults: vec![], retry_after_ms: Some(7_000) };
    world.send_report(report(&grant, outcome));
    world.wait(6_900);
    assert_eq!(world.state_of(&grant), JobState::Delayed);
    world.wait(60_000);
    assert_eq!(world.state_of(&grant), JobState::Ready);
}

#[test]
fn an_attempt_that_takes_too_long_is_taken_away() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    for _ in 0..12 {
        world.wait(10_000);
        world.beat("w", &[&grant]);
    }
    let job = world.job("a", Stage::Proposal, Item::Whole, 0);
    assert_eq!(job.attempts[0].end, Some(AttemptEnd::TimedOut));
    assert_eq!(job.attempts[0].faults[0].code, FaultCode::JDeadline);
}

#[test]
fn the_ladder_is_feedback_feedback_another_seed_another_proposal_dead() {
    let mut world = begun();
    world.pass(Stage::Proposal);
    let mut seeds = Vec::new();
    let mut climb = |world: &mut World, rung: &str| {
        let grant = world.grant("w", Stage::Paths);
        seeds.push(grant.spec.seed);
        world.fail(&grant, FailureClass::Semantic, vec![fault(FaultCode::GDisc, rung)]);
        grant
    };
    let first = climb(&mut world, "one");
    assert!(first.spec.feedback.is_empty());
    let second = climb(&mut world, "two");
    assert_eq!(second.spec.feedback[0].message, "one".into());
    assert_ne!(first.idem_key, second.idem_key, "another question has another key");
    let third = climb(&mut world, "three");
    assert_eq!(third.spec.feedback[0].message, "two".into());
    let fourth = climb(&mut world, "four");
    assert_eq!(fourth.spec.feedback[0].message, "three".into());
    assert_eq!(world.state_of(&fourth), JobState::Superseded);
    assert_eq!(fourth.attempt, 4);

    let anew = world.pass(Stage::Proposal);
    assert_eq!((anew.spec.key.revision, anew.spec.feedback[0].message.to_string()), (1, "four".to_owned()));
    for rung in ["1", "2", "3", "4"] {
        climb(&mut world, rung);
    }
    assert_eq!(world.job("a", Stage::Paths, Item::Whole, 1).state, JobState::Dead);
    let [a, b, c, d, ..] = seeds[..] else { panic!() };
    assert!(a == b && b == c && c != d, "only the third refusal changes the seed: {seeds:?}");
}

#[test]
fn the_same_reasons_twice_change_the_seed_at_once() {
    let mut world = begun();
    // The same code at the same place; what the messages say decides nothing.
    let same = |words: &str| vec![Fault::new(FaultCode::PPlace, "place", words)];
    let first = world.grant("w", Stage::Proposal);
    world.fail(&first, FailureClass::Semantic, same("no kitchen"));
    let second = world.grant("w", Stage::Proposal);
    world.fail(&second, FailureClass::Semantic, same("no such place"));
    let third = world.grant("w", Stage::Proposal);
    assert!(first.spec.seed == second.spec.seed && second.spec.seed != third.spec.seed);
}

#[test]
fn poison_and_permanent_failures_are_not_tried_again() {
    for (class, end) in [(FailureClass::Poison, JobState::Dead), (FailureClass::Permanent, JobState::Failed)] {
        let mut world = begun();
        let grant = world.grant("w", Stage::Proposal);
        world.fail(&grant, class, vec![]);
        assert_eq!(world.state_of(&grant), end);
        assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Failed));
    }
}

#[test]
fn a_success_without_its_output_is_none() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    world.send_report(report(&grant, Outcome::Ok));
    assert_eq!(world.state_of(&grant), JobState::Dead);
}

#[test]
fn a_repair_makes_new_rows_for_its_stage_and_those_after_it() {
    let mut world = begun();
    let scoring = world.reach_scoring();
    let repair = Repair { stage: Stage::Behaviors, faults: vec![fault(FaultCode::DNoTrig, "1.9 m, needs 1.5 m")] };
    world.score(&scoring, Verdict::NotTriggered, Some(repair));
    assert_eq!(world.scenario("a").revision, 1);
    assert!(world.grants("w", Stage::Paths).is_empty(), "nothing changed for the paths");
    let behaviors = world.pass(Stage::Behaviors);
    assert_eq!(behaviors.spec.feedback[0].code, FaultCode::DNoTrig);
    assert!(behaviors.spec.refused.is_some());
    let simulation = world.pass(Stage::Simulation);
    let paths = &world.job("a", Stage::Paths, Item::Whole, 0).result.as_ref().unwrap().artifacts[0];
    assert_eq!(simulation.spec.inputs[&Role::Paths], paths.digest);
    let scoring = world.grant("w", Stage::Scoring);
    world.score(&scoring, Verdict::Realised, None);
    assert_eq!(world.scenario("a").settled, Some(1));
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Judged(Verdict::Realised)));
}

#[test]
fn what_is_wrong_with_compiled_behaviors_goes_to_the_proposal() {
    let mut world = World::new();
    let mut compiled = spec("a");
    compiled.settings.insert("behaviors_by".to_owned(), "proposal".to_owned());
    world.submit(vec![compiled]);
    let scoring = world.reach_scoring();
    let repair = Repair { stage: Stage::Behaviors, faults: vec![fault(FaultCode::DNoTrig, "1.9 m, needs 1.5 m")] };
    world.score(&scoring, Verdict::NotTriggered, Some(repair));
    let proposal = world.pass(Stage::Proposal);
    assert_eq!((proposal.spec.key.revision, proposal.spec.feedback[0].code), (1, FaultCode::DNoTrig));
    world.pass(Stage::Paths);
    // Refused as it is compiled, it goes there at once: the same rules are wrong in the same way again.
    let behaviors = world.grant("w", Stage::Behaviors);
    world.fail(&behaviors, FailureClass::Semantic, vec![fault(FaultCode::BDead, "never reached")]);
    assert_eq!(world.pass(Stage::Proposal).spec.key.revision, 2);
}

#[test]
fn a_reason_that_was_given_once_and_came_again_goes_one_stage_up() {
    let mut world = begun();
    let mut scoring = world.reach_scoring();
    for (revision, stage) in [(1, Stage::Paths), (2, Stage::Proposal)] {
        let faults = vec![fault(FaultCode::DNoMeet, "human_1")];
        world.score(&scoring, Verdict::NotTriggered, Some(Repair { stage: Stage::Paths, faults }));
        assert_eq!(world.pass(stage).spec.key.revision, revision);
        if stage == Stage::Paths {
            world.pass(Stage::Simulation);
            scoring = world.grant("w", Stage::Scoring);
        }
    }
}

#[test]
fn an_older_verdict_stands_when_the_repair_comes_to_nothing() {
    let mut world = begun();
    let scoring = world.reach_scoring();
    let faults = vec![fault(FaultCode::DNoMeet, "9 m")];
    world.score(&scoring, Verdict::NotTriggered, Some(Repair { stage: Stage::Paths, faults }));
    let paths = world.grant("w", Stage::Paths);
    world.fail(&paths, FailureClass::Permanent, vec![]);
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Judged(Verdict::NotTriggered)));
    assert_eq!(world.scenario("a").settled, Some(0));
}

#[test]
fn a_simulation_that_refuses_its_inputs_sends_them_back() {
    let mut world = begun();
    for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
        world.pass(stage);
    }
    let simulation = world.grant("w", Stage::Simulation);
    world.fail(&simulation, FailureClass::Semantic, vec![fault(FaultCode::GGrp, "apart")]);
    assert_eq!(world.state_of(&simulation), JobState::Superseded);
    assert_eq!(world.grant("w", Stage::Paths).spec.feedback[0].code, FaultCode::GGrp);
}

#[test]
fn other_runs_follow_the_settled_lead_with_its_recording() {
    let mut world = World::new();
    let mut spec = spec("a");
    spec.planners = vec!["mppi".parse().unwrap()];
    spec.run_seeds = vec![1, 2];
    world.submit(vec![spec]);
    let lead = world.reach_scoring();
    assert!(world.grants("w", Stage::Simulation).is_empty());
    world.score(&lead, Verdict::Realised, None);
    let runs = world.grants("w", Stage::Simulation);
    let items: Vec<String> = runs.iter().map(|grant| grant.spec.key.item.to_string()).collect();
    assert_eq!(items, ["reference-2", "mppi-1", "mppi-2"]);
    world.succeed(&runs[1]);
    let scoring = world.grant("w", Stage::Scoring);
    assert_eq!(scoring.spec.inputs[&Role::Reference], lead.spec.inputs[&Role::Recording]);
    world.score(&scoring, Verdict::RobotPrevented, None);
    // The reference run of seed 2 dies: the planner's run with that seed is judged without it.
    world.fail(&runs[0], FailureClass::Poison, vec![]);
    world.succeed(&runs[2]);
    let scoring = world.grant("w", Stage::Scoring);
    assert!(!scoring.spec.inputs.contains_key(&Role::Reference));
    world.score(&scoring, Verdict::Contradicted, None);
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Judged(Verdict::Realised)));
}

#[test]
fn a_run_is_judged_beside_its_twin_without_a_robot_where_there_is_one() {
    let mut world = World::new();
    let mut spec = spec("a");
    spec.planners = vec!["none".parse().unwrap(), "mppi".parse().unwrap()];
    world.submit(vec![spec]);
    let lead = world.reach_scoring();
    assert!(!lead.spec.inputs.contains_key(&Role::Twin), "the leading run is judged before any other begins");
    world.score(&lead, Verdict::Realised, None);
    let runs = world.grants("w", Stage::Simulation);
    let by = |grant: &Grant, planner: &str| grant.spec.run().unwrap().planner.as_str() == planner;
    let of = |planner: &str| runs.iter().find(|grant| by(grant, planner)).unwrap();
    world.succeed(of("mppi"));
    assert!(world.grants("w", Stage::Scoring).is_empty(), "the twin is waited for");
    world.succeed(of("none"));
    let scorings = world.grants("w", Stage::Scoring);
    let inputs = |planner: &str| &scorings.iter().find(|grant| by(grant, planner)).unwrap().spec.inputs;
    assert_eq!(inputs("mppi")[&Role::Twin], inputs("none")[&Role::Recording]);
    assert!(!inputs("none").contains_key(&Role::Twin), "a twin has none");
}

#[test]
fn the_same_work_is_done_once() {
    let mut world = World::new();
    let (mut a, mut b) = (spec("a"), spec("b"));
    a.request = socrates_model::Digest::of(b"same");
    b.request = a.request;
    world.submit(vec![a, b]);
    let grants = world.grants("w", Stage::Proposal);
    assert_eq!(grants.len(), 1, "single flight");
    world.succeed(&grants[0]);
    assert_eq!(world.job("b", Stage::Proposal, Item::Whole, 0).state, JobState::Succeeded);
    for stage in [Stage::Paths, Stage::Behaviors, Stage::Simulation] {
        world.pass(stage);
    }
    let scoring = world.grant("w", Stage::Scoring);
    world.score(&scoring, Verdict::Realised, None);
    assert!(world.state.is_done());
    let mut c = spec("c");
    c.request = socrates_model::Digest::of(b"same");
    world.submit(vec![c]);
    assert_eq!(world.scenario("c").end, Some(ScenarioEnd::Judged(Verdict::Realised)), "all of it is known");
}

#[test]
fn an_experiment_without_cache_does_everything_itself() {
    let mut world = World::new();
    let specs = ["a", "b"].map(|id| {
        let mut spec = spec(id);
        spec.request = socrates_model::Digest::of(b"same");
        spec.settings.insert("cache".to_owned(), "off".to_owned());
        spec
    });
    world.submit(specs.to_vec());
    assert_eq!(world.grants("w", Stage::Proposal).len(), 2);
}

#[test]
fn a_canceled_batch_ends_when_its_workers_have_stopped() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    world.control(Control::Cancel("b".to_owned()));
    assert_eq!(world.state_of(&grant), JobState::Canceling);
    assert_eq!(world.beat("w", &[&grant]).verdicts[0].2, BeatVerdict::Cancel);
    assert_eq!(world.scenario("a").end, None);
    world.beat("w", &[]);
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Canceled));

    let mut world = begun();
    world.grant("w", Stage::Proposal);
    world.control(Control::Cancel("b".to_owned()));
    world.wait(30_000);
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Canceled), "a silent worker is not waited for");
}

#[test]
fn a_paused_batch_is_not_handed_out() {
    let mut world = begun();
    world.control(Control::Pause("b".to_owned()));
    let answer = world.ask("w", &[Stage::Proposal], 1);
    assert!(matches!(answer, Acquired::None { reason: NoWork::Paused, .. }));
    world.control(Control::Resume("b".to_owned()));
    world.pass(Stage::Proposal);
}

#[test]
fn a_failed_scenario_can_be_requeued() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    world.fail(&grant, FailureClass::Permanent, vec![]);
    assert!(world.state.is_done());
    world.control(Control::Requeue(spec("a").id));
    assert!(!world.state.is_done());
    let scoring = world.reach_scoring();
    world.score(&scoring, Verdict::Realised, None);
    assert!(world.state.is_done());
    assert_eq!(world.job("a", Stage::Proposal, Item::Whole, 0).attempts.len(), 2, "old attempts are kept");
}

#[test]
fn a_lost_grant_is_told_again_by_the_beat() {
    let mut world = begun();
    let grant = world.grant("w", Stage::Proposal);
    assert!(world.beat("w", &[]).missing.is_empty(), "a beat may cross with the grant");
    world.wait(2_000);
    assert_eq!(world.beat("w", &[]).missing, [grant]);
}

#[test]
fn started_scenarios_are_finished_before_new_ones_begin() {
    let mut world = World::with(Policy { open_per_worker: 1, ..Policy::default() });
    world.submit((0..30).map(|n| spec(&format!("s{n:02}"))).collect());
    let begun = world.grants("w", Stage::Proposal);
    assert_eq!(begun.len(), 8);
    world.succeed(&begun[0]);
    assert!(world.grants("w", Stage::Proposal).is_empty());
    let Acquired::Grants(next) = world.ask("w", &Stage::WORKERS, 1) else { panic!() };
    assert_ne!(next[0].spec.key.stage, Stage::Proposal);
}

#[test]
fn status_pages_fit_a_message_and_cover_everything() {
    let mut world = World::new();
    world.submit((0..500).map(|n| spec(&format!("s{n:03}"))).collect());
    let mut from = 0;
    let mut seen = 0;
    while from < 500 {
        let reply = status(&world.state, &StatusAsk { from, ..StatusAsk::default() }, world.now);
        assert!(serde_json::to_vec(&reply).unwrap().len() < 64 * 1024);
        assert_eq!((reply.total, reply.done), (500, 0));
        assert!(!reply.scenarios.is_empty());
        seen += reply.scenarios.len();
        from += u32::try_from(reply.scenarios.len()).unwrap();
    }
    assert_eq!(seen, 500);
}

#[test]
fn status_counts_what_runs_and_how_the_others_ended() {
    let mut world = World::new();
    world.submit(vec![spec("a"), spec("b"), spec("c")]);
    let ask = StatusAsk::default();
    let reply = status(&world.state, &ask, world.now);
    assert_eq!((reply.total, reply.done, reply.running, reply.results.len()), (3, 0, 0, 0));
    let lead = world.reach_scoring();
    let reply = status(&world.state, &ask, world.now);
    assert_eq!(reply.running, 1, "one scoring job is held: {reply:?}");
    world.score(&lead, Verdict::Contradicted, None);
    let reply = status(&world.state, &ask, world.now);
    assert_eq!((reply.done, reply.running), (1, 0), "{reply:?}");
    assert_eq!(reply.results.get(&ScenarioEnd::Judged(Verdict::Contradicted)), Some(&1), "{:?}", reply.results);
}

#[test]
fn a_scenario_with_many_runs_takes_several_lines() {
    let mut world = World::new();
    let mut spec = spec("a");
    spec.run_seeds = (1..=40).collect();
    world.submit(vec![spec]);
    let lead = world.reach_scoring();
    world.score(&lead, Verdict::Realised, None);
    let mut jobs = Vec::new();
    let mut from = 0;
    loop {
        let reply = status(&world.state, &StatusAsk { batch: "b".to_owned(), from, ..StatusAsk::default() }, world.now);
        if reply.scenarios.is_empty() {
            break;
        }
        from += u32::try_from(reply.scenarios.len()).unwrap();
        jobs.extend(reply.scenarios.into_iter().flat_map(|line| line.jobs).map(|job| job.key));
    }
    jobs.sort();
    jobs.dedup();
    assert_eq!(jobs.len(), 3 + 80);
}

#[test]
fn a_submission_beyond_the_limit_is_told_to_come_back() {
    let mut world = World::with(Policy { max_open_jobs: 10, ..Policy::default() });
    assert_eq!(world.submit(vec![spec("a")]), Submitted::Accepted { new: 1, held: 0 });
    assert!(matches!(world.submit(vec![spec("b")]), Submitted::Busy { .. }));
}
