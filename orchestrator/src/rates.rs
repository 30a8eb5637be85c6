//! Rules of the servers' rates: who is held back, and until when.

use socrates_model::fault::{FailureClass, FaultCode};
use socrates_model::job::Stage;
use socrates_model::wire::{Acquired, NoWork, Outcome, Rate, Rates, Report, ScenarioSpec};

use crate::world::{World, fault, report, spec, success};
use crate::{Effect, JobState, Policy};

fn by(author: &str, id: &str) -> ScenarioSpec {
    let mut spec = spec(id);
    spec.settings.insert("author".to_owned(), author.to_owned());
    // Scenarios of their own: the same work would be done once.
    spec.seed = u64::from(id.bytes().map(u32::from).sum::<u32>());
    spec
}

/// Why there is no proposal to be made now; nothing where there is one.
fn held_back(world: &mut World) -> Option<NoWork> {
    match world.ask("w", &[Stage::Proposal], 1) {
        Acquired::None { reason, .. } => Some(reason),
        Acquired::Grants(_) => None,
    }
}

#[test]
fn a_configured_rate_holds_questions_back_until_there_is_room() {
    let mut world = World::with(Policy { requests_per_minute: 2, lease_ms: 600_000, ..Policy::default() });
    world.submit(vec![by("openai:m", "a"), by("openai:m", "b"), by("openai:m", "c"), by("offline", "d")]);
    // Two of the model and the one without a server; of the model no more.
    let given = world.grants("w", Stage::Proposal);
    let names: Vec<String> = given.iter().map(|grant| grant.spec.key.scenario.to_string()).collect();
    assert_eq!(names, ["a", "b", "d"]);
    assert_eq!(held_back(&mut world), Some(NoWork::Throttled));
    world.wait(29_000);
    assert_eq!(held_back(&mut world), Some(NoWork::Throttled));
    // When there is room again the workers are told so.
    world.wait(1_100);
    assert!(world.effects.iter().any(|effect| matches!(effect, Effect::Hint(Stage::Proposal))), "{:?}", world.effects);
    assert_eq!(held_back(&mut world), None);
}

#[test]
fn what_a_server_says_is_left_holds_for_every_worker() {
    let mut world = World::new();
    world.submit(vec![by("openai:m", "a"), by("openai:m", "b"), by("openai:other", "c")]);
    let first = world.grant("w", Stage::Proposal);
    let tokens = Some(Rate { limit: 10_000, left: 10, whole_in_ms: Some(60_000) });
    world.send_report(Report { rates: Some(Rates { tokens, requests: None }), tokens: (900, 100), ..success(&first) });
    // Another model has rates of its own.
    let second = world.grant("another", Stage::Proposal);
    assert_eq!(second.spec.settings["author"], "openai:other");
    assert_eq!(held_back(&mut world), Some(NoWork::Throttled));
    // A question took 1 000 tokens; 9 990 come back in a minute.
    world.wait(6_100);
    assert_eq!(world.grant("w", Stage::Proposal).spec.key.scenario.to_string(), "b");
}

#[test]
fn a_pause_that_a_server_wants_is_its_own() {
    let mut world = World::new();
    world.submit(vec![by("openai:m", "a"), by("openai:m", "b"), by("vllm:x", "c")]);
    let first = world.grant("w", Stage::Proposal);
    let faults = vec![fault(FaultCode::T429, "slow down")];
    let outcome = Outcome::Failed { class: FailureClass::Overload, faults, retry_after_ms: Some(20_000) };
    world.send_report(report(&first, outcome));
    assert_eq!(world.state_of(&first), JobState::Delayed);
    assert_eq!(world.grant("w", Stage::Proposal).spec.settings["author"], "vllm:x");
    assert_eq!(held_back(&mut world), Some(NoWork::Throttled));
    world.wait(20_000);
    assert_eq!(held_back(&mut world), None);
}

#[test]
fn an_answer_that_is_cut_twice_in_a_row_is_given_up() {
    let mut world = World::new();
    world.submit(vec![spec("a")]);
    world.pass(Stage::Proposal);
    let cut = |world: &mut World| {
        let grant = world.grant("w", Stage::Paths);
        world.fail(&grant, FailureClass::Unparsable, vec![fault(FaultCode::ETrunc, "was cut")]);
        grant
    };
    let first = cut(&mut world);
    assert_eq!(world.state_of(&first), JobState::Ready);
    let second = cut(&mut world);
    assert_eq!(second.spec.feedback[0].code, FaultCode::ETrunc);
    assert_eq!(world.state_of(&second), JobState::Dead);
    // With something else in between it is asked once more.
    let mut world = World::new();
    world.submit(vec![spec("a")]);
    world.pass(Stage::Proposal);
    cut(&mut world);
    let between = world.grant("w", Stage::Paths);
    world.fail(&between, FailureClass::Unparsable, vec![fault(FaultCode::EJson, "no JSON")]);
    assert_eq!(world.state_of(&between), JobState::Ready);
}

#[test]
fn a_scenario_whose_tokens_are_spent_is_asked_about_no_more() {
    let mut world = World::with(Policy { tokens_per_scenario: 1_000, ..Policy::default() });
    world.submit(vec![spec("a")]);
    let cost = |grant: &socrates_model::wire::Grant, tokens: u64| Report { tokens: (tokens, 0), ..success(grant) };
    let first = world.grant("w", Stage::Proposal);
    world.send_report(cost(&first, 400));
    let wrong = |grant: &socrates_model::wire::Grant| {
        let faults = vec![fault(FaultCode::GDisc, "jumps")];
        let outcome = Outcome::Failed { class: FailureClass::Semantic, faults, retry_after_ms: None };
        Report { tokens: (300, 10), ..report(grant, outcome) }
    };
    let paths = world.grant("w", Stage::Paths);
    world.send_report(wrong(&paths));
    assert_eq!(world.state_of(&paths), JobState::Ready, "710 of 1 000");
    let again = world.grant("w", Stage::Paths);
    world.send_report(wrong(&again));
    assert_eq!(world.state_of(&again), JobState::Failed, "1 020 of 1 000");
    let told = world.state.jobs[&again.spec.key].attempts.last().unwrap().faults.clone();
    assert!(
        told.iter().any(|fault| fault.code == FaultCode::JBudget && fault.message.to_string().contains("1020 tokens")),
        "{told:?}"
    );
}

#[test]
fn a_scenario_whose_money_is_spent_is_asked_about_no_more() {
    // 2 and 10 a million tokens: 100 000 in and 20 000 out cost 40 cents.
    let prices = std::collections::BTreeMap::from([("gpt-x".to_owned(), (2_000_000, 10_000_000))]);
    for (author, cents, state) in [
        ("openai:gpt-x", 50, JobState::Ready),
        ("openai:gpt-x", 40, JobState::Failed),
        ("record:tape=openai:gpt-x", 40, JobState::Failed),
        ("offline", 1, JobState::Ready),
    ] {
        let policy = Policy { prices: prices.clone(), money_per_scenario: cents * 10_000, ..Policy::default() };
        let mut world = World::with(policy);
        let mut asked = spec("a");
        asked.settings.insert("author".to_owned(), author.to_owned());
        world.submit(vec![asked]);
        let grant = world.grant("w", Stage::Proposal);
        let outcome = Outcome::Failed {
            class: FailureClass::Semantic,
            faults: vec![fault(FaultCode::PCount, "two of three")],
            retry_after_ms: None,
        };
        world.send_report(Report { tokens: (100_000, 20_000), ..report(&grant, outcome) });
        assert_eq!(world.state_of(&grant), state, "{author} {cents}");
    }
}

#[test]
fn a_spent_budget_does_not_take_back_what_is_there() {
    let mut world = World::with(Policy { author_ms_per_scenario: 1, ..Policy::default() });
    world.submit(vec![spec("a")]);
    // Every answer is right at once: nobody is asked again, so the budget matters to nobody.
    let scoring = world.reach_scoring();
    let repair =
        socrates_model::report::Repair { stage: Stage::Paths, faults: vec![fault(FaultCode::DNoMeet, "never")] };
    world.score(&scoring, socrates_model::Verdict::NotTriggered, Some(repair));
    assert!(world.scenario("a").end.is_some(), "the repair would have asked an author");
    assert_eq!(world.scenario("a").revision, 0);
}
