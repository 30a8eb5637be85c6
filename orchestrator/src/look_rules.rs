//! What a person's look does: accepting, changing, having stages made again.

use socrates_model::fault::FaultCode;
use socrates_model::job::{Artifact, Look, Stage};
use socrates_model::report::Repair;
use socrates_model::wire::{Grant, Report};
use socrates_model::{Digest, Role};

use crate::pipeline;
use crate::world::{World, fault, spec, success};

fn looked_at(id: &str) -> World {
    let mut world = World::new();
    let mut asked = spec(id);
    asked.review = true;
    world.submit(vec![asked]);
    world
}

fn left(role: Role, bytes: &[u8]) -> Artifact {
    Artifact {
        role,
        digest: Digest::of(bytes),
        len: bytes.len() as u64,
        media: "application/json".to_owned(),
        inline: None,
    }
}

fn made(world: &World, grant: &Grant, role: Role) -> Digest {
    let result = world.state.jobs[&grant.spec.key].result.as_ref().unwrap();
    pipeline::output(&result.artifacts, role).unwrap()
}

fn anew(stage: Stage, message: &str) -> Vec<Repair> {
    vec![Repair { stage, faults: vec![fault(FaultCode::PPerson, message)] }]
}

#[test]
fn what_a_person_says_of_compiled_behaviors_goes_to_the_proposal() {
    let mut world = World::new();
    let mut asked = spec("a");
    asked.review = true;
    asked.settings.insert("behaviors_by".to_owned(), "proposal".to_owned());
    world.submit(vec![asked]);
    world.pass(Stage::Proposal);
    world.pass(Stage::Review);
    for stage in [Stage::Paths, Stage::Behaviors] {
        world.pass(stage);
    }
    let review = world.grant("person", Stage::Review);
    world.send_report(Report { anew: anew(Stage::Behaviors, "kinder"), ..success(&review) });
    assert_eq!(world.grant("w", Stage::Proposal).spec.feedback[0].message, "kinder".into());
}

#[test]
fn a_person_may_send_the_proposal_back_or_change_it() {
    let mut world = looked_at("a");
    world.pass(Stage::Proposal);
    assert!(world.grants("w", Stage::Paths).is_empty(), "nothing goes on before the person has looked");
    let review = world.grant("person", Stage::Review);
    assert_eq!(review.spec.key.item, Look::Proposal.into());
    world.send_report(Report { anew: anew(Stage::Proposal, "no child"), ..success(&review) });
    let again = world.pass(Stage::Proposal);
    assert_eq!(again.spec.feedback[0].message, "no child".into());
    let review = world.grant("person", Stage::Review);
    let (mine, wish) = (left(Role::Proposal, b"mine"), left(Role::Reading, b"wish"));
    world.send_report(Report { artifacts: vec![mine.clone(), wish.clone()], ..success(&review) });
    for stage in [Stage::Paths, Stage::Behaviors] {
        let grant = world.grant("w", stage);
        assert_eq!(grant.spec.inputs[&Role::Proposal], mine.digest, "{stage} takes what the person left");
        assert_eq!(grant.spec.inputs[&Role::Reading], wish.digest, "{stage} is held against what the person wants");
        world.succeed(&grant);
    }
    let review = world.grant("person", Stage::Review);
    assert_eq!(review.spec.key.item, Look::Draft.into());
    world.succeed(&review);
    let simulated = world.pass(Stage::Simulation);
    assert_eq!(simulated.spec.inputs[&Role::Proposal], mine.digest);
    assert_eq!(simulated.spec.inputs[&Role::Reading], wish.digest);
    let scenario = world.scenario("a");
    assert_eq!((scenario.repairs, scenario.reviews), (0, 1));
}

#[test]
fn a_proposal_that_is_made_again_is_told_how_the_request_is_read_after_what_the_person_changed() {
    let mut world = looked_at("a");
    let proposal = world.grant("w", Stage::Proposal);
    let read = left(Role::Reading, b"read by the author");
    let mut report = success(&proposal);
    report.artifacts.push(read.clone());
    world.send_report(report);
    let review = world.grant("person", Stage::Review);
    assert_eq!(review.spec.inputs[&Role::Reading], read.digest);
    let (mine, wish) = (left(Role::Proposal, b"mine"), left(Role::Reading, b"read, with a wish"));
    let anew = anew(Stage::Proposal, "no child");
    world.send_report(Report { artifacts: vec![mine.clone(), wish.clone()], anew, ..success(&review) });
    let again = world.grant("w", Stage::Proposal);
    assert_eq!(again.spec.inputs[&Role::Reading], wish.digest);
    assert_eq!(again.spec.refused, Some(mine.digest), "what the person left is what is made again");
    let mut report = success(&again);
    report.artifacts.push(left(Role::Reading, b"read again"));
    world.send_report(report);
    let review = world.grant("person", Stage::Review);
    world.send_report(Report { anew: self::anew(Stage::Proposal, "slower"), ..success(&review) });
    let again = world.grant("w", Stage::Proposal);
    assert_eq!(again.spec.inputs[&Role::Reading], left(Role::Reading, b"read again").digest);
}

#[test]
fn a_person_may_have_one_stage_made_again_and_keep_the_others() {
    let mut world = looked_at("a");
    world.pass(Stage::Proposal);
    world.pass(Stage::Review);
    let paths = world.pass(Stage::Paths);
    let behaviors = world.pass(Stage::Behaviors);
    let look = world.grant("person", Stage::Review);
    let mine = left(Role::Proposal, b"mine");
    let artifacts = vec![mine.clone()];
    world.send_report(Report { artifacts, anew: anew(Stage::Paths, "longer"), ..success(&look) });
    assert!(world.grants("w", Stage::Simulation).is_empty(), "the old paths are not simulated");
    assert!(world.grants("w", Stage::Behaviors).is_empty(), "the behaviors are kept");
    let again = world.pass(Stage::Paths);
    assert_eq!(again.spec.inputs[&Role::Proposal], mine.digest, "the paths are made for what the person left");
    let look = world.grant("person", Stage::Review);
    assert_eq!(look.spec.inputs[&Role::Behaviors], made(&world, &behaviors, Role::Behaviors));
    assert_eq!(look.spec.inputs[&Role::Paths], made(&world, &again, Role::Paths));
    assert_ne!(made(&world, &again, Role::Paths), made(&world, &paths, Role::Paths));
    // Undone: the paths from before are what the person leaves.
    let before = left(Role::Paths, b"before");
    world.send_report(Report { artifacts: vec![before.clone()], ..success(&look) });
    let simulated = world.pass(Stage::Simulation);
    assert_eq!(simulated.spec.inputs[&Role::Paths], before.digest);
    assert_eq!(simulated.spec.inputs[&Role::Proposal], mine.digest);
    assert_eq!(simulated.spec.inputs[&Role::Behaviors], made(&world, &behaviors, Role::Behaviors));
}

#[test]
fn after_a_new_proposal_nothing_of_the_old_look_is_left() {
    let mut world = looked_at("a");
    world.pass(Stage::Proposal);
    world.pass(Stage::Review);
    world.pass(Stage::Paths);
    world.pass(Stage::Behaviors);
    let look = world.grant("person", Stage::Review);
    let artifacts = vec![left(Role::Proposal, b"mine"), left(Role::Paths, b"mine")];
    world.send_report(Report { artifacts, anew: anew(Stage::Proposal, "somewhere else"), ..success(&look) });
    let proposal = world.pass(Stage::Proposal);
    world.pass(Stage::Review);
    let paths = world.pass(Stage::Paths);
    assert_eq!(paths.spec.inputs[&Role::Proposal], made(&world, &proposal, Role::Proposal));
    world.pass(Stage::Behaviors);
    let look = world.grant("person", Stage::Review);
    assert_eq!(look.spec.inputs[&Role::Paths], made(&world, &paths, Role::Paths));
}
