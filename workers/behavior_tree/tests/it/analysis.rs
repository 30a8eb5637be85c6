//! The tick analysis against random runs: what is seen to happen must be among what can happen.

use crate::common::Room;
use socrates_bt::{Cover, Tree, analyze};
use socrates_model::Gesture;
use socrates_model::seeds::SplitMix64;

/// Throws of a fixed sequence.
struct Dice(SplitMix64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0.below(n)
    }
    fn is(&mut self) -> bool {
        self.below(2) == 0
    }
}

/// A tree whose leaves end in the tick they run in; every node has a name of its own.
fn node(dice: &mut Dice, depth: usize, count: &mut usize) -> String {
    *count += 1;
    let name = format!("name='n{count}'");
    let id = "agent_id='{id}'";
    if depth == 0 || dice.below(4) == 0 {
        return match dice.below(11) {
            0 | 1 => format!("<IsRobotVisible {name} {id} distance='5'/>"),
            2 => format!("<IsRobotNearby {name} {id} distance='3'/>"),
            3 => format!("<RobotMoved {name} {id}/>"),
            4 => format!("<IsAtEncounter {name} {id}/>"),
            5 | 6 => format!(
                "<TimeExpiredCondition {name} seconds='0.{}' ts='{{dt}}' only_once='{}'/>",
                1 + dice.below(5),
                dice.is()
            ),
            7 => format!("<LookAtRobot {name} {id}/>"),
            8 => format!("<FollowRobot {name} {id} time_step='{{dt}}'/>"),
            9 => format!("<MakeGesture {name} {id} message='{}'/>", dice.below(2)),
            _ => format!("<StandStill {name} {id}/>"),
        };
    }
    let mut below = |dice: &mut Dice, n: usize| -> String { (0..n).map(|_| node(dice, depth - 1, count)).collect() };
    match dice.below(9) {
        0..=2 => format!("<Sequence {name}>{}</Sequence>", {
            let n = 2 + dice.below(2);
            below(dice, n)
        }),
        3..=5 => format!("<Fallback {name}>{}</Fallback>", {
            let n = 2 + dice.below(2);
            below(dice, n)
        }),
        6 => format!("<Inverter {name}>{}</Inverter>", below(dice, 1)),
        7 => format!("<Latch {name}>{}</Latch>", below(dice, 1)),
        _ => format!("<WhileDoElse {name}>{}</WhileDoElse>", below(dice, 3)),
    }
}

fn room(dice: &mut Dice, tick: u64) -> Room {
    let distance_m = [1.0, 4.0, 9.0][dice.below(3)];
    Room {
        distance_m: Some(distance_m),
        visible: dice.is(),
        moving: dice.is(),
        at_encounter: dice.is(),
        tick,
        ..Room::default()
    }
}

#[test]
fn whatever_happens_in_a_random_run_was_foretold() {
    let mut dice = Dice(SplitMix64::new(31));
    let (mut exact, mut doubled, mut froze, mut stuck) = (0, 0, 0, 0);
    for _ in 0..400 {
        let body = node(&mut dice, 4, &mut 0);
        let xml = format!("<root main_tree_to_execute='T'><BehaviorTree ID='T'>{body}</BehaviorTree></root>");
        let tree = Tree::parse(&xml).unwrap();
        let analysis = analyze(&tree);
        if matches!(analysis.cover, Cover::Sample { .. }) {
            continue;
        }
        exact += 1;
        let names = tree.node_names();
        let is_dead =
            |name: &str| analysis.dead.iter().any(|fault| fault.at.to_string().ends_with(&format!("`{name}`")));
        let entries = [("id", "1"), ("dt", "0.01")].map(|(key, value)| (key.to_owned(), value.to_owned()));
        let mut state = tree.start_with(&entries.into_iter().collect());
        let mut tick = 0;
        for _ in 0..4 {
            let mut gesture = None;
            for _ in 0..60 {
                let mut room = room(&mut dice, tick);
                room.gesture = gesture;
                let acts = room.tick(&tree, &mut state);
                gesture = room.gesture;
                tick += 1;
                for (name, visited) in names.iter().zip(state.visited()) {
                    assert!(!visited || !is_dead(name), "{name} is said to be dead in {xml}\n{analysis}");
                }
                if acts.len() > 1 {
                    doubled += 1;
                    assert!(!analysis.double_motion.is_empty(), "{acts:?} in {xml}\n{analysis}");
                }
            }
            // The world stays as it is, long enough for timers that wait for timers.
            let held = room(&mut dice, tick);
            let (mut moved, mut spoke) = (false, false);
            for held_ticks in 0..6000 {
                if held_ticks > 150 && moved && spoke {
                    break;
                }
                let mut same = Room { gesture: Some(Gesture::FollowMe), ..same(&held) };
                moved |= !same.tick(&tree, &mut state).is_empty();
                spoke |= same.gesture != Some(Gesture::FollowMe);
                tick += 1;
            }
            if !moved {
                froze += 1;
                assert!(!analysis.frozen.is_empty(), "it froze in {xml}\n{analysis}");
            }
            if gesture.is_some() && !spoke {
                stuck += 1;
                assert!(!analysis.stuck_gestures.is_empty(), "{gesture:?} stuck in {xml}\n{analysis}");
            }
        }
    }
    assert!(exact > 300 && doubled > 100 && froze > 30 && stuck > 5, "{exact} {doubled} {froze} {stuck}");
}

/// The same facts.
fn same(room: &Room) -> Room {
    Room {
        distance_m: room.distance_m,
        visible: room.visible,
        moving: room.moving,
        at_encounter: room.at_encounter,
        ..Room::default()
    }
}
