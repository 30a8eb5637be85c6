//! Many rule lists and many broken documents: always an answer, never a panic, never without end.
#![expect(clippy::indexing_slicing, reason = "test code: a wrong tree should stop the test")]

mod common;

use std::collections::BTreeMap;

use common::Room;
use socrates_bt::{CheckContext, Format, Tree, check, compile};
use socrates_model::{Action, FaultCode, Gesture, HumanId, Rule, Trigger};

/// SplitMix64.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }
}

fn trigger(dice: &mut Dice) -> Trigger {
    let m = dice.pick(&[1.0, 2.0, 3.5, 5.0, 8.0]);
    let gesture = dice.pick(&Gesture::ALL);
    let choices = [
        Trigger::Always,
        Trigger::RobotVisible(m),
        Trigger::RobotVisible(m),
        Trigger::RobotNear(m),
        Trigger::RobotBlocking(m),
        Trigger::RobotMoving,
        Trigger::RobotStopped,
        Trigger::RobotSays(gesture),
        Trigger::HumanSays(HumanId::new(2), gesture),
        Trigger::GoalReached,
        Trigger::AtEncounter,
        Trigger::AfterSecs(m * 3.0),
    ];
    dice.pick(&choices)
}

fn rules(dice: &mut Dice) -> Vec<Rule> {
    let actions = [
        Action::Navigate,
        Action::FollowRobot,
        Action::FollowHuman(HumanId::new(2)),
        Action::RunAway,
        Action::GiveWay,
        Action::Block,
        Action::LookAtRobot,
        Action::Approach,
        Action::StandStill,
    ];
    (0..dice.below(5))
        .map(|_| Rule {
            when: (0..dice.below(4)).map(|_| trigger(dice)).collect(),
            act: dice.pick(&actions),
            gesture: dice.pick(&[None, None, Some(Gesture::Wait), Some(Gesture::Proceed), Some(Gesture::None)]),
            for_s: dice.pick(&[None, Some(2.0), Some(7.5)]),
            latched: dice.below(3) == 0,
        })
        .collect()
}

#[test]
fn a_rule_list_compiles_or_has_a_rule_that_cannot_run() {
    let mut dice = Dice(7);
    let mut compiled = 0;
    for _ in 0..1500 {
        let rules = rules(&mut dice);
        match compile(HumanId::new(1), &rules) {
            Ok(xml) => {
                let tree = Tree::parse(&xml).unwrap();
                assert!(rules.iter().all(|rule| tree.actions().contains(&rule.act)));
                compiled += 1;
            }
            Err(faults) => {
                for fault in &faults {
                    assert!(matches!(fault.code, FaultCode::BDead | FaultCode::BContra), "{rules:#?}\n{fault}");
                }
            }
        }
    }
    assert!(compiled > 500, "only {compiled} lists compiled");
}

/// Changes, drops, doubles or swaps a few bytes.
fn broken(text: &str, dice: &mut Dice) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=dice.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = dice.below(bytes.len());
        match dice.below(5) {
            0 => bytes[at] = (dice.next() % 256) as u8,
            1 => bytes.truncate(at),
            2 => {
                let end = (at + dice.below(40)).min(bytes.len());
                bytes.drain(at..end);
            }
            3 => {
                let end = (at + dice.below(80)).min(bytes.len());
                let part: Vec<u8> = bytes[at..end].to_vec();
                let to = dice.below(bytes.len());
                bytes.splice(to..to, part);
            }
            _ => bytes[at] = dice.pick(b"<>/\"'{}&;=0123456789 "),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn no_broken_document_is_taken_without_an_answer() {
    let mut dice = Dice(11);
    let rule = Rule {
        when: vec![Trigger::RobotVisible(5.0), Trigger::RobotStopped],
        act: Action::LookAtRobot,
        gesture: Some(Gesture::Wait),
        for_s: Some(5.0),
        latched: true,
    };
    let rules = [rule];
    let v3 = compile(HumanId::new(1), &rules).unwrap();
    let v4 = Tree::parse(&v3).unwrap().to_xml(Format::V4);
    let scripted = "<root BTCPP_format='4' main_tree_to_execute='T'><BehaviorTree ID='T'><Repeat num_cycles='3'>\
        <Parallel success_count='1' failure_count='1'><Script code='n := 1; m := n + 2'/>\
        <StandStill agent_id='{id}' _skipIf='n &gt; 3'/></Parallel></Repeat></BehaviorTree></root>";
    let humans = BTreeMap::new();
    let ctx = CheckContext { human: HumanId::new(1), humans: 1, robot_says: &[], human_says: &humans, rules: &rules };
    for text in [v3.as_str(), v4.as_str(), scripted] {
        for _ in 0..3000 {
            match Tree::parse(&broken(text, &mut dice)) {
                Ok(tree) => {
                    let mut state = tree.start();
                    Room::default().tick(&tree, &mut state);
                    let found = check(&tree, &ctx);
                    assert!(found.iter().all(|fault| !fault.message.is_empty()));
                    Tree::parse(&tree.to_xml(tree.format())).unwrap_or_else(|faults| panic!("{faults:#?}"));
                }
                Err(faults) => assert!(!faults.is_empty() && faults.iter().all(|fault| !fault.message.is_empty())),
            }
        }
    }
}

#[test]
fn nested_repetitions_come_back() {
    let mut body = "<StandStill agent_id='{id}'/>".to_owned();
    for _ in 0..8 {
        body = format!("<Repeat num_cycles='-1'>{body}</Repeat>");
    }
    let xml = format!("<root main_tree_to_execute='T'><BehaviorTree ID='T'>{body}</BehaviorTree></root>");
    let tree = Tree::parse(&xml).unwrap();
    let mut state = tree.start();
    let mut room = Room::default();
    for _ in 0..3 {
        assert!(!room.tick(&tree, &mut state).is_empty());
    }
}
