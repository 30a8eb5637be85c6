//! Faults that are handed back: what the author changes for each of them.

use socrates_model::job::Stage;
use socrates_model::rule::RobotDo;
use socrates_model::{Action, AgentId, Fault, FaultCode, Gesture, HumanId, Paths, Proposal, Rule, Trigger, Where};
use socrates_offline::Offline;
use socrates_prompts::Question;

/// The question with its proposal.
fn proposed(on: &str, text: &str) -> (Question, Proposal) {
    let mut ask = crate::common::question(on, text);
    let proposal = socrates_prompts::parse_proposal(&Offline::answer(&ask)).unwrap();
    ask.proposal = Some(proposal.clone());
    (ask, proposal)
}

/// The agent of `human_1 19:9 Inverter`, at the rest of it.
fn place(at: &str) -> Where {
    let (who, rest) = at.split_once(' ').unwrap_or((at, ""));
    let agent = Where::agent(who.parse::<AgentId>().unwrap());
    if rest.is_empty() { agent } else { agent.at_key(rest) }
}

fn told(ask: &Question, stage: Stage, faults: &[(FaultCode, &str)]) -> String {
    let feedback = faults.iter().map(|(code, at)| Fault::new(*code, place(at), "as the checks say it")).collect();
    Offline::answer(&Question { stage, feedback, ..ask.clone() })
}

fn paths(ask: &Question, faults: &[(FaultCode, &str)]) -> Paths {
    socrates_prompts::parse_paths(&told(ask, Stage::Paths, faults), ask).unwrap()
}

/// The rules of a human, as they are answered.
fn rules(ask: &Question, human: u32, faults: &[(FaultCode, &str)]) -> Vec<Rule> {
    let answer: serde_json::Value = serde_json::from_str(&told(ask, Stage::Behaviors, faults)).unwrap();
    serde_json::from_value(answer["humans"][HumanId::new(human).to_string()]["rules"].clone()).unwrap()
}

const FRONTAL: &str =
    "A person comes towards the robot in the corridor and looks at it. A visitor crosses the robot's way.";

#[test]
fn a_slip_of_the_pen_is_written_again_and_a_wrong_place_is_left() {
    let (ask, _) = proposed("office", FRONTAL);
    let first = paths(&ask, &[]);
    for code in [FaultCode::GDisc, FaultCode::GUnknown, FaultCode::GEmpty, FaultCode::GAgents, FaultCode::EJson] {
        assert_eq!(paths(&ask, &[(code, "robot step 3")]), first, "{code}");
    }
    for code in [
        FaultCode::GMeet,
        FaultCode::GMeetEnd,
        FaultCode::GType,
        FaultCode::GRel,
        FaultCode::GColl,
        FaultCode::DNoMeet,
        FaultCode::DStuck,
        FaultCode::DPen,
        FaultCode::DSetup,
    ] {
        assert_ne!(paths(&ask, &[(code, "human_1")]).encounters, first.encounters, "{code}");
    }
}

#[test]
fn a_short_way_gets_longer_and_only_that_of_whom_it_is_said() {
    let (ask, _) = proposed("hospital", "A nurse comes towards the robot in the corridor.");
    let length = |paths: &Paths, nodes: &[socrates_model::NodeId]| {
        assert!(!paths.robot.is_empty());
        ask.location.graph.length_m(nodes)
    };
    let first = paths(&ask, &[]);
    let robot = paths(&ask, &[(FaultCode::GShort, "robot"), (FaultCode::GShort, "robot")]);
    assert!(length(&robot, &robot.robot) > length(&first, &first.robot));
    let id = HumanId::new(1);
    let human = paths(&ask, &[(FaultCode::GShort, "human_1")]);
    assert!(length(&human, &human.humans[&id]) > length(&first, &first.humans[&id]));
    assert_eq!((&human.robot, &human.encounters), (&first.robot, &first.encounters));
}

#[test]
fn a_reaction_that_came_never_or_too_early_gets_another_reach() {
    let (ask, proposal) = proposed("office", FRONTAL);
    let reach = |rules: &[Rule]| {
        if let Trigger::RobotVisible(m) | Trigger::RobotNear(m) = rules[0].when[0] { m } else { panic!("{rules:?}") }
    };
    let usual = reach(&proposal.humans[0].rules);
    assert_eq!(rules(&ask, 1, &[]), proposal.humans[0].rules);
    for code in [FaultCode::DNoTrig, FaultCode::DNoGest] {
        assert!(reach(&rules(&ask, 1, &[(code, "human_1")])) > usual, "{code}");
    }
    assert!(reach(&rules(&ask, 1, &[(FaultCode::DEarly, "human_1")])) < usual);
    // A fault of somebody else, or of a longer number, is not its own.
    for at in ["human_2", "human_12", "robot"] {
        assert_eq!(rules(&ask, 1, &[(FaultCode::DNoTrig, at)]), proposal.humans[0].rules, "{at}");
    }
}

fn with_rules(ask: &Question, rules: Vec<Rule>) -> Question {
    let mut proposal = ask.proposal.clone().unwrap();
    proposal.humans[0].rules = rules;
    Question { proposal: Some(proposal), ..ask.clone() }
}

fn rule(when: Trigger, act: Action, for_s: Option<f64>) -> Rule {
    Rule { when: vec![when], act, gesture: None, for_s, latched: true, ..Rule::default() }
}

#[test]
fn who_waits_for_a_word_that_nobody_says_waits_for_the_robot() {
    let (ask, _) = proposed("office", FRONTAL);
    let deaf = vec![
        rule(Trigger::RobotSays(Gesture::ExcuseMe), Action::GiveWay, Some(6.0)),
        rule(Trigger::HumanSays(HumanId::new(2), Gesture::Wait), Action::StandStill, Some(5.0)),
    ];
    let mut ask = with_rules(&ask, deaf.clone());
    assert_eq!(rules(&ask, 1, &[]), deaf);
    let near = rules(&ask, 1, &[(FaultCode::BHear, "human_1")]);
    assert!(near.iter().all(|rule| rule.when == [Trigger::RobotNear(3.0)]), "{near:?}");
    // What the robot does say is still waited for.
    let line = socrates_model::rule::RobotRule {
        when: socrates_model::rule::RobotWhen::HumanNear(4.0),
        act: RobotDo::Say(Gesture::ExcuseMe),
    };
    ask.proposal.as_mut().unwrap().robot.script.push(line);
    assert_eq!(rules(&ask, 1, &[(FaultCode::BHear, "human_1")])[0], deaf[0]);
}

#[test]
fn rules_that_cannot_run_or_never_end_are_put_right() {
    let (ask, _) = proposed("office", FRONTAL);
    let endless = rule(Trigger::RobotVisible(8.0), Action::FollowRobot, None);
    let look = rule(Trigger::RobotVisible(4.0), Action::LookAtRobot, Some(5.0));
    let dead = with_rules(&ask, vec![endless.clone(), look.clone()]);
    assert_eq!(rules(&dead, 1, &[(FaultCode::BDead, "human_1 19:9 Inverter")]), [look.clone(), endless]);
    let flee = rule(Trigger::RobotVisible(4.0), Action::RunAway, Some(6.0));
    let torn = with_rules(&ask, vec![look.clone(), flee]);
    for code in [FaultCode::BContra, FaultCode::BMove2] {
        assert_eq!(rules(&torn, 1, &[(code, "human_1")]), std::slice::from_ref(&look), "{code}");
    }
    let waves = Rule { gesture: Some(Gesture::Wait), for_s: None, ..look.clone() };
    assert_eq!(rules(&with_rules(&ask, vec![waves]), 1, &[(FaultCode::BLatch, "human_1")])[0].for_s, Some(4.0));
    let stands = rule(Trigger::Always, Action::StandStill, None);
    assert_eq!(rules(&with_rules(&ask, vec![stands]), 1, &[(FaultCode::BStill, "human_1")])[0].for_s, Some(8.0));
    let far = rule(Trigger::RobotVisible(40.0), Action::LookAtRobot, Some(0.0));
    let mended = rules(&with_rules(&ask, vec![far]), 1, &[(FaultCode::BRange, "human_1")]);
    assert_eq!((&mended[0].when[..], mended[0].for_s), (&[Trigger::RobotVisible(12.0)][..], Some(1.0)));
}

#[test]
fn a_proposal_that_repeats_another_is_drawn_anew() {
    let first = crate::common::question("office", None);
    let patterns: std::collections::BTreeSet<String> = (0..6)
        .map(|times| {
            let feedback = vec![Fault::new(FaultCode::PDup, "pattern", "as an earlier one"); times];
            let ask = Question { feedback, ..first.clone() };
            socrates_prompts::parse_proposal(&Offline::answer(&ask)).unwrap().pattern
        })
        .collect();
    assert!(patterns.len() >= 3, "{patterns:?}");
}
