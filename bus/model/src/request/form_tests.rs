//! What the door says of forms: everything at once, with line, key, value and what is allowed.

use crate::act::Destination;
use crate::form::{Deed, Form, PlaceWord, When};
use crate::proposal::Relation;
use crate::{Action, AgentId, GroupId, HumanId, PlaceClass, Request, Trigger};

const PLAIN: &str = "location = \"office\"\ntask = \"Deliver mail\"\n";

fn read(more: &str) -> Result<Request, Vec<String>> {
    let told = |bad: crate::BadRequest| bad.told("my.toml");
    Request::of_toml(&format!("{PLAIN}{more}"), None).map_err(|problems| problems.into_iter().map(told).collect())
}

#[track_caller]
fn form(more: &str) -> Form {
    read(more).unwrap_or_else(|problems| panic!("{problems:#?}")).form
}

#[test]
fn a_form_is_read_into_people_who_are_counted_out() {
    let form = form(
        "[[human]]\nid = \"visitor\"\ncount = 2\nrelation = \"leaving\"\nplace = \"elevator\"\ngroup = \"pair\"\n\
         [[human]]\nrelation = \"static\"\nplace = \"packing area\"\n\
         reacts = [{ when = { human_says = [\"visitor_2\", \"WAIT\"] }, act = { follow_human = \"visitor_1\" } }]\n\
         does = [{ when = { robot_near = 2 }, say = \"PROCEED\" }, { act = \"give_way\" }]\n\
         [[order]]\nfirst = \"visitor\"\nthen = \"robot\"\n",
    );
    let people = form.people();
    assert_eq!(people.len(), 3);
    assert_eq!(people[0].group, Some(GroupId(1)));
    assert_eq!(form.named("visitor"), [HumanId::new(1), HumanId::new(2)]);
    assert_eq!(form.one("visitor_2"), Some(HumanId::new(2)));
    assert_eq!(form.one("human_3"), Some(HumanId::new(3)));
    assert_eq!(form.agents("robot"), [AgentId::Robot]);
    assert_eq!(people[0].human.place, Some(PlaceWord::Class(PlaceClass::Elevator)));
    assert_eq!(people[2].human.place, Some(PlaceWord::Name("packing area".to_owned())));
    // Reactions come first, and win; a step of a sequence waits for the one before it.
    let rules = &people[2].rules;
    assert_eq!(rules[0].act, Action::FollowHuman(HumanId::new(1)));
    assert_eq!((&rules[1].act, rules[1].for_s), (&Action::StandStill, Some(2.0)));
    assert_eq!(rules[1].when, [Trigger::RobotNear(2.0)]);
    assert_eq!(rules[2].when, [Trigger::Did(HumanId::new(3), 1)]);
    assert_eq!(rules[2].until, [Trigger::RobotPassed]);
    assert!(rules[2].latched && !rules[0].latched);
    assert_eq!([rules[0].step, rules[1].step, rules[2].step], [None, Some(1), Some(2)]);
}

#[test]
fn a_request_with_a_form_is_written_and_read_again() {
    let text = "[[human]]\nid = \"nurse\"\nrelation = \"crossing\"\npace = 0.8\ndoes = [{ when = \"at_encounter\", act = \"stand_still\", for_s = 3.0 }]\n\
                [robot]\ngoal = \"ward 2\"\ndoes = [{ when = { at_encounter = \"nurse\" }, say = \"EXCUSE_ME\" }]\n";
    let request = read(text).unwrap();
    let again = Request::of_toml(&toml::to_string(&request).unwrap(), None).unwrap();
    assert_eq!(again, request);
    assert_eq!(Request::of_json(&serde_json::to_value(&request).unwrap(), None).unwrap(), request);
    assert_eq!(request.form.humans[0].does[0].when, [When::AtEncounter]);
    assert_eq!(request.form.humans[0].does[0].act, Some(Deed::StandStill));
}

#[test]
fn everything_that_is_wrong_with_a_form_is_said_at_once() {
    let human = "[[human]]\nrelation = \"static\"\n";
    for (more, wanted) in [
        ("[[human]]\nrelation = \"static\"\nside = \"north\"\n", "my.toml:5:8 `human.side`"),
        (
            "[[human]]\nrelation = \"frontal\"\nfacing = \"away\"\n",
            "my.toml:5:10 `human.facing`: `away` of somebody who is `frontal`",
        ),
        (
            "[[human]]\nid = \"a\"\ncount = 2\nrelation = \"static\"\n[[human]]\nrelation = \"static\"\nfacing = \"a\"\n",
            "`human.facing`: `a` is 2 people",
        ),
        ("[[human]]\nid = \"a\"\nrelation = \"static\"\nfacing = \"a\"\n", "`human.facing`: `a` faces themselves"),
        ("[[human]]\nrelation = \"staying\"\nside = \"left\"\n", "`human.side`: `left` of somebody who stays inside"),
        (
            "[[human]]\nrelation = \"behind\"\nside = \"left\"\nreacts = [{ when = \"always\", act = \"follow_robot\" }]\n",
            "`human.side`: `left` of somebody who follows",
        ),
        ("[[human]]\nrole = \"nurse\"\n", "my.toml:3:1 `human.relation`: is missing"),
        ("[[human]]\nrelation = \"sideways\"\n", "my.toml:4:12 `human.relation`: unknown variant `sideways`"),
        ("[[human]]\nrelation = \"static\"\ncolor = \"red\"\n", "my.toml:5:1 `human.color`: is not a key"),
        ("[[human]]\nrelation = \"static\"\ncount = 0\n", "`human.count`: 0 people (1 to 30)"),
        ("[[human]]\nrelation = \"static\"\ncount = 1000\n", "`human.count`: 1000 people altogether (at most 40)"),
        ("[[human]]\nrelation = \"static\"\nid = \"robot\"\n", "`human.id`: `robot` is no name of a person"),
        ("[[human]]\nrelation = \"static\"\npace = 9\n", "`human.pace`: 9 m/s is out of range"),
        ("[[human]]\nrelation = \"static\"\ngroup = \"g\"\n", "`human.group`: `g` has 1 people (2 to 8"),
        (
            "[[human]]\nid = \"a\"\nrelation = \"static\"\n[[human]]\nid = \"a\"\nrelation = \"ahead\"\n",
            "`a` is somebody already",
        ),
        (&format!("{human}reacts = [{{ act = \"block\" }}]\n"), "`human.reacts.when`: is missing"),
        (
            &format!("{human}does = [{{ act = \"block\" }}, {{ act = \"navigate\" }}]\n"),
            "a step comes after one that never ends",
        ),
        (
            &format!("{human}does = [{{ when = {{ robot_neer = 2 }}, act = \"block\" }}]\n"),
            "`robot_neer` is no trigger (nearest: { robot_near = 2.0 }; triggers: \"always\", { robot_visible = 5.0 }",
        ),
        (
            &format!("{human}does = [{{ when = \"robot_near\", act = \"block\" }}]\n"),
            "`robot_near` is not written as \"robot_near\" (write { robot_near = 2.0 })",
        ),
        (
            &format!("{human}does = [{{ act = \"bloc\" }}]\n"),
            "`bloc` is no act (nearest: \"block\"; acts: \"navigate\"",
        ),
        (
            &format!("{human}[robot]\ndoes = [{{ when = \"robot_near\", say = \"WAIT\" }}]\n"),
            "`robot_near` is no moment (nearest: { human_near = 3.0 }",
        ),
        (
            &format!("{human}reacts = [{{ when = \"always\", act = \"block\", until = \"robot_passed\" }}]\n"),
            "`human.reacts.until`: belongs to steps of `does`",
        ),
    ] {
        let problems = read(more).err().unwrap_or_else(|| panic!("{more} is taken"));
        assert!(problems.iter().any(|problem| problem.contains(wanted)), "{wanted}\n{problems:#?}");
    }
    let all = read("[[human]]\nrelation = \"sideways\"\ncount = 0\n[expect]\nhumans = 0\n").unwrap_err();
    assert_eq!(all.len(), 3, "{all:#?}");
}

#[test]
fn what_else_is_wrong_with_a_form_is_said_too() {
    let human = "[[human]]\nrelation = \"static\"\n";
    for (more, wanted) in [
        ("human = 3\n", "`human`: is a number (a table for each: [[human]])"),
        (
            &format!("{human}does = [{{ when = {{ did = [\"human_1\", 3] }}, act = \"block\" }}]\n"),
            "`human_1` has no step 3 (1 to 1)",
        ),
        (
            &format!(
                "{human}[[human]]\nrelation = \"frontal\"\ndoes = [{{ when = {{ done = \"human_1\" }}, act = \"block\" }}]\n"
            ),
            "my.toml:7:9 `human.does.when`: `human_1` stands and has no steps, and is never done",
        ),
        (
            "[[human]]\nid = \"a\"\nrelation = \"static\"\ndoes = [{ act = \"block\" }]\n\
             [[human]]\nrelation = \"frontal\"\nreacts = [{ when = { did = [\"a\", 1] }, act = \"block\" }]\n",
            "step 1 of `a` never ends",
        ),
        (
            "[[human]]\nid = \"a\"\nrelation = \"static\"\ndoes = [{ when = { done = \"b\" }, say = \"WAIT\" }]\n\
             [[human]]\nid = \"b\"\nrelation = \"frontal\"\ndoes = [{ act = \"stand_still\", until = { did = [\"a\", 1] } }]\n",
            "step 1 of a waits for itself: step 1 of a waits for step 1 of b waits for step 1 of a",
        ),
        (&format!("{human}does = [{{ for_s = 2 }}]\n"), "`human.does`: does nothing"),
        (&format!("{human}does = [{{ act = \"block\", for_s = -1 }}]\n"), "-1 s is out of range (0.1 to 600 (s))"),
        (
            &format!("{human}does = [{{ when = {{ robot_near = 99 }}, act = \"block\" }}]\n"),
            "99 m is out of range (0.3 to 15 (m))",
        ),
        (
            &format!("{human}does = [{{ act = {{ follow_human = \"bob\" }} }}]\n"),
            "`follow_human`: `bob` is nobody (human_1)",
        ),
        (
            &format!(
                "{human}[[order]]\nfirst = \"robot\"\nthen = \"human_1\"\n[[order]]\nfirst = \"human_1\"\nthen = \"robot\"\n"
            ),
            "closes a circle",
        ),
        (
            &format!("{human}[[order]]\nfirst = \"robot\"\nthen = \"human_1\"\nat = \"corridor\"\n"),
            "`order.at`: `corridor` has no door",
        ),
        (&format!("{human}[[group]]\nid = \"g\"\nformation = \"circle\"\n"), "nobody is in `g`"),
        (&format!("{human}[expect]\nhumans = 3\n"), "`expect.humans`: 3 humans, but [[human]] states 1"),
        (&format!("proposal = \"p.json\"\n{human}"), "`proposal`: stands beside [[human]]"),
        (&format!("{human}[robot]\ndoes = [{{ hold_s = 100 }}]\n"), "`robot.does.hold_s`: 100 s is out of range"),
        (&format!("{human}[robot]\ndoes = [{{ say = \"WAIT\", hold_s = 1 }}]\n"), "does several things at once"),
        (&format!("{human}[robot]\ndoes = [{{ follow = \"ghost\" }}]\n"), "`ghost` is nobody"),
        ("[[human]]\nrelation = \"static\"\ndoes = 3\n", "`human.does`: is a number"),
    ] {
        let problems = read(more).err().unwrap_or_else(|| panic!("{more} is taken"));
        assert!(problems.iter().any(|problem| problem.contains(wanted)), "{wanted}\n{problems:#?}");
    }
}

#[test]
fn without_a_form_the_social_context_has_to_be_there() {
    let problems = read("").unwrap_err();
    assert!(problems[0].contains("`social_context`: is missing"), "{problems:?}");
    assert_eq!(form("[[human]]\nrelation = \"static\"\n").headcount(), 1);
}

#[test]
fn a_step_has_a_reason_and_an_end_of_its_own() {
    let form = form(
        "[[human]]\nid = \"guard\"\nrelation = \"static\"\n\
         does = [{ when = { robot_near = 4.0 }, say = \"WAIT\" }, { when = { done = \"visitor\" }, say = \"PROCEED\" },\n\
         { act = \"stand_still\", until = [{ stopped_for = 3.0 }, \"robot_stopped\"] }]\n\
         [[human]]\nid = \"visitor\"\ncount = 2\nrelation = \"crossing\"\n",
    );
    let rules = &form.people()[0].rules;
    let (me, one, other) = (HumanId::new(1), HumanId::new(2), HumanId::new(3));
    assert_eq!(rules[1].when, [Trigger::Did(me, 1), Trigger::Done(one), Trigger::Done(other)]);
    assert_eq!(rules[2].when, [Trigger::Did(me, 2)]);
    assert_eq!(rules[2].until, [Trigger::StoppedFor(3.0), Trigger::RobotStopped]);
    assert_eq!((rules[0].for_s, rules[2].for_s), (Some(2.0), None));
}

#[test]
fn a_list_of_words_is_named_in_full_once() {
    let problems = read(
        "[[human]]\nrelation = \"static\"\ndoes = [{ when = \"robot_neer\", act = \"block\", for_s = 1 }, { when = \"robot_farr\", act = \"block\" }]\n",
    )
    .unwrap_err();
    assert_eq!(problems.iter().filter(|problem| problem.contains("{ after_secs = 10.0 }")).count(), 1, "{problems:#?}");
    assert!(problems.iter().all(|problem| !problem.contains("variant")), "{problems:#?}");
}

#[test]
fn a_sign_is_made_to_somebody_and_an_act_changes_the_way() {
    let form = form(
        "[[human]]\nid = \"guard\"\nrelation = \"static\"\ndoes = [{ when = { robot_near = 4 }, say = \"WAIT\", to = \"visitor\" }]\n\
         [[human]]\nid = \"visitor\"\nrelation = \"frontal\"\ndoes = [{ act = { change_pace = \"slow\" } },\n\
         { when = { human_says = [\"guard\", \"WAIT\"] }, act = { look_at = \"guard\" }, for_s = 2 }, { act = \"turn_back\" },\n\
         { act = { go_to = \"ward 2\" } }]\n",
    );
    let (guard, visitor) = (HumanId::new(1), HumanId::new(2));
    let people = form.people();
    assert_eq!(
        (people[0].rules[0].to, &people[0].rules[0].act),
        (Some(AgentId::Human(visitor)), &Action::LookAt(visitor))
    );
    let acts: Vec<&Action> = people[1].rules.iter().map(|rule| &rule.act).collect();
    let place = Action::GoTo(Destination { place: "ward 2".into(), nodes: Vec::new() });
    assert_eq!(acts, [&Action::ChangePace(0.6), &Action::LookAt(guard), &Action::TurnBack, &place]);
    assert_eq!((people[1].rules[0].for_s, &people[1].rules[2].until[..]), (Some(1.0), &[Trigger::GoalReached][..]));
}

#[test]
fn a_bystander_a_group_that_opens_and_how_near_somebody_comes_are_stated() {
    let form = form(
        "[[human]]\nrelation = \"aside\"\nside = \"left\"\nfacing = \"robot\"\n\
         [[human]]\nrelation = \"static\"\ndoes = [{ when = { robot_says = \"EXCUSE_ME\" }, act = \"make_room\" }]\n\
         [[human]]\nrelation = \"frontal\"\ndoes = [{ when = { robot_near = 4 }, act = { approach_to = 0.8 }, for_s = 3 }]\n",
    );
    let people = form.people();
    assert_eq!(people[0].human.relation, Relation::Aside);
    let room = &people[1].rules[0];
    assert_eq!((&room.act, &room.until[..]), (&Action::MakeRoom, &[Trigger::RobotPassed][..]));
    assert_eq!(people[2].rules[0].act, Action::ApproachTo(0.8));
}

#[test]
fn a_sign_to_nobody_and_an_act_that_cannot_be_are_errors_with_their_line() {
    let human = "[[human]]\nid = \"a\"\nrelation = \"static\"\n";
    for (more, wanted) in [
        ("does = [{ say = \"WAIT\", to = \"bob\" }]\n", "my.toml:6:30 `to`: `bob` is nobody (a)"),
        ("does = [{ act = \"block\", to = \"all\" }]\n", "`human.does.to`: is said of a step without a sign"),
        ("does = [{ say = \"WAIT\", to = \"a\" }]\n", "`human.does`: is done to themselves"),
        ("does = [{ say = \"WAITT\" }]\n", "`WAITT` is no sign (nearest: WAIT; signs: WAIT, PROCEED"),
        ("does = [{ act = \"turn_back\" }]\n", "`human.does.act`: walks, but stands by its relation"),
        ("does = [{ act = \"change_pace\" }]\n", "write { change_pace = \"slow\" }"),
        ("does = [{ act = { approach_to = 0.2 } }]\n", "`human.does.act`: 0.2 m is out of range"),
        ("does = [{ act = { change_pace = 3.0 } }]\n", "`human.does.act`: 3 m/s is out of range"),
        (
            "[[human]]\nrelation = \"frontal\"\ndoes = [{ act = \"make_room\" }]\n",
            "`human.does.act`: makes room, but walks by its relation",
        ),
        ("reacts = [{ when = \"always\", act = { go_to = \"room\" } }]\n", "changes the way or the pace for good"),
        (
            "[robot]\ndoes = [{ hold_until = \"human_says\" }]\n",
            "`human_says` is not written as \"human_says\" (write { human_says = \"WAIT\" })",
        ),
        ("[robot]\ndoes = [{ hold_until = { did = [\"human_1\", 4] } }]\n", "`human_1` has no step 4"),
        ("[robot]\ndoes = [{ when = { done = \"ghost\" }, hold_s = 2 }]\n", "`robot.does.when`: `ghost`"),
        (
            "[robot]\ndoes = [{ when = { after_line = 1 }, say = \"WAIT\" }]\n",
            "line 1 does not stand before it (the number of a line before it)",
        ),
    ] {
        let problems = read(&format!("{human}{more}")).err().unwrap_or_else(|| panic!("{more} is taken"));
        assert!(problems.iter().any(|problem| problem.contains(wanted)), "{wanted}\n{problems:#?}");
    }
}
