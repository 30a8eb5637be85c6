//! Which revision of a scenario counts, one test for each rule.

use socrates_model::fault::FaultCode;
use socrates_model::job::Stage;
use socrates_model::report::{Repair, Verdict};

use crate::ScenarioEnd;
use crate::world::{World, fault, spec};

fn begun() -> World {
    let mut world = World::new();
    world.submit(vec![spec("a")]);
    world
}

#[test]
fn the_best_revision_counts_when_the_budget_ends() {
    let mut world = begun();
    let mut scoring = world.reach_scoring();
    let verdicts = [Verdict::Contradicted, Verdict::NotTriggered, Verdict::Contradicted, Verdict::Invalid];
    for (n, verdict) in verdicts.into_iter().enumerate() {
        let faults = vec![fault(FaultCode::DNoMeet, &n.to_string())];
        world.score(&scoring, verdict, Some(Repair { stage: Stage::Paths, faults }));
        if n < 3 {
            world.pass(Stage::Paths);
            world.pass(Stage::Simulation);
            scoring = world.grant("w", Stage::Scoring);
        }
    }
    let scenario = world.scenario("a");
    assert_eq!((scenario.repairs, scenario.settled), (3, Some(1)));
    assert_eq!(scenario.end, Some(ScenarioEnd::Judged(Verdict::NotTriggered)));
}

#[test]
fn a_revision_with_nothing_to_mend_counts_although_a_part_of_the_request_is_not_played() {
    let mut world = begun();
    let scoring = world.reach_scoring();
    let faults = vec![fault(FaultCode::DNoMeet, "they never met")];
    world.score(&scoring, Verdict::NotTriggered, Some(Repair { stage: Stage::Paths, faults }));
    world.pass(Stage::Paths);
    world.pass(Stage::Simulation);
    let scoring = world.grant("w", Stage::Scoring);
    world.score(&scoring, Verdict::Invalid, None);
    assert_eq!(world.scenario("a").settled, Some(1));
    assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Judged(Verdict::Invalid)));
}

#[test]
fn what_came_late_is_tried_again_and_stands_where_nothing_better_comes() {
    for (then, settled) in [(Verdict::Realised, 1), (Verdict::Contradicted, 0)] {
        let mut world = begun();
        let scoring = world.reach_scoring();
        let faults = vec![fault(FaultCode::DNoMeet, "2 s late")];
        world.score(&scoring, Verdict::RealisedLate, Some(Repair { stage: Stage::Paths, faults }));
        world.pass(Stage::Paths);
        world.pass(Stage::Simulation);
        let scoring = world.grant("w", Stage::Scoring);
        world.score(&scoring, then, None);
        let best = if settled == 1 { then } else { Verdict::RealisedLate };
        assert_eq!(world.scenario("a").settled, Some(settled));
        assert_eq!(world.scenario("a").end, Some(ScenarioEnd::Judged(best)));
    }
}
