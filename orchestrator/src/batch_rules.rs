//! What a batch may take, and series: rules told as short stories.

use socrates_model::FailureClass;
use socrates_model::job::{Item, Stage};
use socrates_model::report::Verdict;
use socrates_model::standing::ScenarioEnd;
use socrates_model::wire::{
    Acquired, BatchStatus, Chosen, Control, Limits, Outcome, Priority, Report, Seeds, Series, StatusAsk, Steer, Submit,
    Submitted,
};

use crate::histories::{ALL, replay};
use crate::series::AHEAD;
use crate::world::{World, report, spec, success};
use crate::{Answer, Event, JobState, Policy, Row, State, status};

fn series(first: &str, count: u32) -> Series {
    Series { first: spec(first), seeds: Seeds::Next(count) }
}

fn of_series(series: Vec<Series>) -> Submit {
    Submit { series, ..Submit::new("b", Priority::Normal, Vec::new()) }
}

fn submit(world: &mut World, submit: Submit) -> Submitted {
    match world.send(|to| Event::Submit { submit, to }) {
        Some(Answer::Submitted(answer)) => answer,
        other => panic!("{other:?}"),
    }
}

fn batch(world: &World) -> BatchStatus {
    status(&world.state, &StatusAsk::default(), world.now).batches.remove(0)
}

/// Does everything that there is to do until nothing is handed out.
fn work(world: &mut World) {
    for _ in 0..5_000 {
        let Acquired::Grants(grants) = world.ask("w", &ALL, 16) else { return };
        for grant in grants {
            let verdict = (grant.spec.key.stage == Stage::Scoring).then_some(Verdict::Realised);
            world.send_report(Report { verdict, ..success(&grant) });
        }
    }
    panic!("there is always more to do");
}

#[test]
fn a_million_scenarios_are_one_row_and_those_that_are_begun_soon() {
    let mut world = World::new();
    let million = of_series(vec![series("lab-7-0000001", 1_000_000)]);
    assert_eq!(submit(&mut world, million.clone()), Submitted::Accepted { new: 1_000_000, held: 1_000_000 });
    let rows = |world: &World, wanted: fn(&Row) -> bool| world.rows.iter().filter(|row| wanted(row)).count();
    assert_eq!(rows(&world, |row| matches!(row, Row::Queue(_))), 1);
    assert_eq!(rows(&world, |row| matches!(row, Row::Scenario(_))), usize::try_from(AHEAD).unwrap());
    assert_eq!(world.state.counts(), (1_000_000, 0));
    let told = batch(&world);
    assert_eq!((told.total, told.unmade), (1_000_000, 1_000_000 - AHEAD));
    // The same wish again is the same wish.
    assert_eq!(submit(&mut world, million), Submitted::Accepted { new: 0, held: 1_000_000 });
    // For each that is begun another one is made, in order and with its own seed.
    let grant = world.grant("w", Stage::Proposal);
    assert_eq!(grant.spec.key.scenario.as_str(), "lab-7-0000001");
    let next = world.scenario("lab-7-0000017");
    assert_eq!((next.order, next.spec.seed), (16, 7 + 16));
    assert_eq!(batch(&world).unmade, 1_000_000 - AHEAD - 1);
}

#[test]
fn a_series_comes_to_its_end_also_over_restarts_and_where_every_scenario_ends_at_once() {
    let mut world = World::new();
    // Seeds that are all alike are the same work, which is done once and taken over by all others in one step.
    let alike = Series { first: spec("a-01"), seeds: Seeds::Listed(vec![7; 700]) };
    let other = series("c-1", 40);
    let answer = submit(&mut world, of_series(vec![alike, other]));
    assert_eq!(answer, Submitted::Accepted { new: 740, held: 740 });
    for _ in 0..20 {
        world.wait(0);
        let Acquired::Grants(grants) = world.ask("w", &ALL, 16) else { break };
        for grant in grants {
            let verdict = (grant.spec.key.stage == Stage::Scoring).then_some(Verdict::Realised);
            world.send_report(Report { verdict, ..success(&grant) });
        }
        world.state = State::restore(replay(&world.rows), world.state.policy.clone(), world.now);
        world.send(|_| Event::Recover { alone: true });
    }
    while world.state.next_due() == Some(0) {
        world.wait(0);
    }
    work(&mut world);
    assert!(world.state.is_done(), "{:?}", world.state.counts());
    assert_eq!(world.state.counts(), (740, 740));
    assert_eq!(world.scenario("a-700").end, Some(ScenarioEnd::Judged(Verdict::Realised)));
    // Places are those of the submission, whichever series was begun first.
    assert_eq!(
        (world.scenario("a-01").order, world.scenario("c-1").order, world.scenario("c-40").order),
        (0, 700, 739)
    );
    let told = batch(&world);
    assert_eq!((told.total, told.done, told.unmade), (740, 740, 0));
}

#[test]
fn series_take_turns_with_other_batches_and_wait_while_theirs_is_paused() {
    let mut world = World::new();
    submit(&mut world, of_series(vec![series("a-1", 1_000)]));
    let mut begun = String::new();
    let mut begin = |world: &mut World, times: usize| {
        begun.clear();
        for _ in 0..times {
            let grant = world.grant("w", Stage::Proposal);
            begun.extend(grant.spec.key.scenario.as_str().chars().next());
            world.fail(&grant, FailureClass::Permanent, Vec::new());
        }
        begun.clone()
    };
    assert_eq!(begin(&mut world, 30), "a".repeat(30));
    let others = (0..20).map(|n| socrates_model::wire::ScenarioSpec { seed: 900 + n, ..spec(&format!("z{n}")) });
    world.submit_as("z", Priority::Normal, others.collect());
    let order = begin(&mut world, 24);
    assert!((8..=16).contains(&order.matches('z').count()), "{order}");
    world.control(Control::Pause("b".to_owned()));
    assert_eq!(begin(&mut world, 4), "zzzz");
}

#[test]
fn what_is_given_up_of_a_series_is_never_made_and_counted() {
    let mut world = World::new();
    submit(&mut world, of_series(vec![series("a-1", 100)]));
    let begun = world.grant("w", Stage::Proposal);
    let control = Control::Steer(Steer::Cancel(Chosen::Batch("b".to_owned())));
    let Some(Answer::Steered(steered)) = world.send(|to| Event::Control { control, to }) else { panic!("no answer") };
    assert_eq!(steered.scenarios, 100);
    world.succeed(&begun);
    assert!(world.state.is_done());
    assert_eq!(world.state.scenarios.len(), usize::try_from(AHEAD).unwrap() + 1);
    let told = batch(&world);
    assert_eq!((told.total, told.done, told.canceled, told.unmade), (100, 100, 100, 0));
    // It stays so.
    world.state = State::restore(replay(&world.rows), world.state.policy.clone(), world.now);
    world.send(|_| Event::Recover { alone: true });
    assert_eq!(world.state.counts(), (100, 100));
    assert!(matches!(world.ask("w", &ALL, 16), Acquired::None { .. }));
}

#[test]
fn a_series_whose_names_are_taken_or_cannot_be_counted_is_refused() {
    let mut world = World::new();
    world.submit(vec![spec("a-7")]);
    submit(&mut world, of_series(vec![series("c-001", 50)]));
    for (bad, words) in [
        (vec![series("a-1", 10)], "as `a-7`"),
        (vec![series("c-050", 2)], "as `c-001`"),
        (vec![series("c-000", 100)], "as `c-001`"),
        (vec![series("plain", 3)], "cannot be numbered"),
        (vec![series("n-1", 0)], "cannot be numbered"),
        (vec![Series { first: spec("n-1"), seeds: Seeds::Listed(vec![8]) }], "cannot be numbered"),
        (vec![series("m-1", 5), series("m-3", 9)], "names in common"),
    ] {
        match submit(&mut world, of_series(bad)) {
            Submitted::Refused { why } => assert!(why.contains(words), "{why}"),
            other @ (Submitted::Accepted { .. } | Submitted::Busy { .. }) => panic!("{words}: {other:?}"),
        }
    }
    // A scenario of a series under its own name is known; with other inputs it is not taken.
    let own = series("c-001", 50).scenario(40).unwrap();
    assert_eq!((own.id.as_str(), world.submit(vec![own.clone()])), ("c-041", Submitted::Accepted { new: 0, held: 0 }));
    assert!(matches!(world.submit(vec![spec("c-041")]), Submitted::Refused { .. }));
    assert_eq!(world.state.counts().0, 51, "a refused submission leaves nothing");
}

fn limited(limits: Limits) -> Submit {
    Submit { limits, ..of_series(vec![series("a-1", 100)]) }
}

#[test]
fn a_batch_ends_at_its_deadline_with_what_there_is() {
    let mut world = World::new();
    submit(&mut world, limited(Limits { deadline_ms: 3_600_000, ..Limits::default() }));
    let ready = world.reach_scoring();
    world.score(&ready, Verdict::Realised, None);
    // The clock of a batch goes on over a restart, up to what was saved last.
    for _ in 0..59 {
        world.wait(60_000);
    }
    let held = world.grant("w", Stage::Proposal);
    world.state = State::restore(replay(&world.rows), world.state.policy.clone(), world.now);
    world.send(|_| Event::Recover { alone: false });
    assert_eq!(world.state_of(&held), JobState::Leased);
    for _ in 0..3 {
        world.wait(59_000);
        world.beat("w", &[&held]);
    }
    assert!(world.state.is_done());
    let told = batch(&world);
    assert_eq!((told.total, told.done, told.failed), (100, 100, 99));
    assert!(
        told.over.contains("the batch `b` ran for") && told.over.contains("its deadline is 60 min"),
        "{}",
        told.over
    );
    assert_eq!(world.scenario("a-1").end, Some(ScenarioEnd::Judged(Verdict::Realised)));
    assert!(
        world.state.jobs[&held.spec.key].reason.contains("J-DEADLINE"),
        "{}",
        world.state.jobs[&held.spec.key].reason
    );
    // Every job that failed has its dead letter.
    let dead = world.rows.iter().filter(|row| matches!(row, Row::Dead(..))).count();
    assert_eq!(dead, world.state.jobs.values().filter(|job| job.state == JobState::Failed).count());
    // What is tried once more has the whole time again.
    world.control(Control::Requeue(held.spec.key.scenario.clone()));
    assert!(batch(&world).over.is_empty());
    work(&mut world);
    assert!(world.state.is_done());
    assert_eq!(batch(&world).failed, 98);
}

#[test]
fn a_job_that_only_waits_ends_with_its_batch_also_where_no_limit_was_set() {
    let mut world = World::with(Policy { batch_deadline_ms: 600_000, ..Policy::default() });
    world.submit(vec![spec("a")]);
    for _ in 0..10 {
        assert!(!world.state.is_done());
        world.wait(60_000);
    }
    assert!(world.state.is_done());
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Failed));
    assert_eq!(world.state.next_due(), None, "nothing is left to wait for");
}

#[test]
fn a_batch_that_has_spent_its_tokens_finishes_what_was_begun() {
    let mut world = World::new();
    submit(&mut world, limited(Limits { tokens: 5_000, ..Limits::default() }));
    let (first, second) = (world.grant("w", Stage::Proposal), world.grant("w", Stage::Proposal));
    world.send_report(Report { tokens: (1_000, 500), ..success(&first) });
    assert!(batch(&world).over.is_empty());
    // A restart forgets nothing that was spent.
    world.state = State::restore(replay(&world.rows), world.state.policy.clone(), world.now);
    world.send(|_| Event::Recover { alone: false });
    // The answer that spends the rest is refused: it is not asked again.
    let outcome = Outcome::Failed { class: FailureClass::Semantic, faults: Vec::new(), retry_after_ms: None };
    world.send_report(Report { tokens: (3_000, 600), ..report(&second, outcome) });
    assert_eq!(batch(&world).taken.tokens, 5_100);
    assert!(batch(&world).over.contains("spent 5100 tokens, 5000 are allowed"), "{}", batch(&world).over);
    assert_eq!(world.state_of(&second), JobState::Failed);
    assert_eq!(world.state.counts(), (100, 99));
    work(&mut world);
    assert_eq!(world.scenario("a-1").end, Some(ScenarioEnd::Judged(Verdict::Realised)));
    assert_eq!(batch(&world).failed, 99);
    // A new submission with more to spend lets it go on.
    let more = Submit { limits: Limits { tokens: 9_000, ..Limits::default() }, ..of_series(vec![series("z-1", 2)]) };
    submit(&mut world, more);
    work(&mut world);
    let told = batch(&world);
    assert_eq!((told.total, told.done, told.failed, told.over.as_str()), (102, 102, 99, ""));
}

#[test]
fn money_is_counted_by_the_price_of_the_author() {
    let prices = [("m".to_owned(), (1_000_000, 2_000_000))].into();
    let mut world = World::with(Policy { prices, ..Policy::default() });
    let mut first = spec("a-1");
    first.settings.insert("author".to_owned(), "openai:m".to_owned());
    let limits = Limits { money: 3_000_000, ..Limits::default() };
    let paid = Series { first, seeds: Seeds::Next(9) };
    submit(&mut world, Submit { limits, ..of_series(vec![paid]) });
    let grant = world.grant("w", Stage::Proposal);
    world.send_report(Report { tokens: (1_000_000, 1_000_000), ..success(&grant) });
    let told = batch(&world);
    assert_eq!(told.taken.money, 3_000_000);
    assert!(told.over.contains("cost 300 cents, 300 are allowed"), "{}", told.over);
    let never = world.job("a-2", Stage::Proposal, Item::Whole, 0);
    assert_eq!(never.state, JobState::Failed);
}
