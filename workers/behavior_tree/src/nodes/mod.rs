//! The catalog: one file per kind of node. A new kind is a new file and a line in [`CATALOG`].

mod again;
mod always;
mod at_encounter;
mod end_step;
mod follow_human;
mod force;
mod foreign;
mod goal_reached;
mod has_arrived;
mod has_ended;
mod has_time_passed;
mod human_says;
mod hunav;
mod if_then_else;
mod in_order;
mod inverter;
mod keep_running;
mod latch;
mod make_gesture;
mod make_gesture_to;
mod memory_sequence;
mod motion;
mod parallel;
mod path_done;
mod reactive;
mod robot_blocking;
mod robot_moved;
mod robot_nearby;
mod robot_passed;
mod robot_says;
mod robot_stood;
mod robot_stopped;
mod robot_visible;
mod run_once;
mod script;
mod scripted;
mod set_blackboard;
mod step_acts;
mod subtree;
mod switch;
mod time_delay;
mod time_expired;
mod timing;
mod update_goal;
mod while_do_else;
mod world_only;

pub(crate) use foreign::{FOREIGN_ACTION, FOREIGN_CONDITION};
pub use hunav::DIALECTS;

use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// Every kind of node, control flow first, in the order of prompts and docs.
pub const CATALOG: &[&NodeSheet] = &[
    &in_order::SEQUENCE,
    &in_order::FALLBACK,
    &inverter::SHEET,
    &reactive::SEQUENCE,
    &reactive::FALLBACK,
    &memory_sequence::SHEET,
    &parallel::SHEET,
    &if_then_else::SHEET,
    &while_do_else::SHEET,
    &switch::SWITCH_2,
    &switch::SWITCH_3,
    &switch::SWITCH_4,
    &switch::SWITCH_5,
    &switch::SWITCH_6,
    &force::SUCCESS,
    &force::FAILURE,
    &again::REPEAT,
    &again::RETRY,
    &keep_running::SHEET,
    &run_once::SHEET,
    &latch::SHEET,
    &subtree::SHEET,
    &subtree::PLUS,
    &set_blackboard::SHEET,
    &script::SHEET,
    &always::SUCCESS,
    &always::FAILURE,
    &robot_visible::SHEET,
    &robot_nearby::SHEET,
    &robot_blocking::SHEET,
    &robot_moved::SHEET,
    &robot_stopped::SHEET,
    &robot_passed::SHEET,
    &robot_passed::SINCE,
    &robot_says::SHEET,
    &human_says::SHEET,
    &time_expired::SHEET,
    &has_time_passed::SHEET,
    &goal_reached::SHEET,
    &path_done::SHEET,
    &at_encounter::SHEET,
    &make_gesture::SHEET,
    &update_goal::SHEET,
    &motion::REGULAR_NAV,
    &motion::LOOK_AT_ROBOT,
    &motion::FOLLOW_ROBOT,
    &follow_human::SHEET,
    &motion::RUN_AWAY,
    &motion::GIVE_WAY,
    &motion::BLOCK,
    &motion::APPROACH,
    &motion::STAND_STILL,
];

/// Nodes by which the steps of a form are played; offered to nobody.
pub const STEPS: &[&NodeSheet] = &[
    &end_step::SHEET,
    &has_ended::STEP,
    &has_ended::ALL,
    &has_arrived::SHEET,
    &robot_stood::SHEET,
    &make_gesture_to::SHEET,
    &step_acts::WATCH_HUMAN,
    &step_acts::TURN_BACK,
    &step_acts::GO_TO,
    &step_acts::CHANGE_PACE,
    &step_acts::MAKE_ROOM,
    &step_acts::COME_CLOSE,
    &step_acts::TURN_AWAY,
    &step_acts::COME_BACK,
];

/// Nodes of BehaviorTree.CPP that are read and ticked, but offered to nobody.
pub const RARE: &[&NodeSheet] = &[
    &in_order::ASYNC_SEQUENCE,
    &in_order::ASYNC_FALLBACK,
    &scripted::PRECONDITION,
    &timing::DELAY,
    &timing::TIMEOUT,
    &timing::SLEEP,
    &scripted::CONDITION,
    &scripted::UNSET,
];

/// The sheet of a tag as a library declares it.
#[must_use]
pub fn sheet_in(tag: &str, library: Library) -> Option<&'static NodeSheet> {
    sheets_of(library).find(|sheet| sheet.is_called(tag))
}

/// The sheet of a tag: ours, else that of the newest library that has one.
#[must_use]
pub fn sheet_of(tag: &str) -> Option<&'static NodeSheet> {
    CATALOG
        .iter()
        .chain(STEPS)
        .chain(RARE)
        .copied()
        .chain(DIALECTS.iter().rev().flat_map(|(_, sheets)| sheets))
        .find(|sheet| sheet.is_called(tag))
}

/// Motions that are the same by other names: ours or the fork's, then that of HuNavSim.
const ALIASES: &[(&str, &str)] = &[
    ("LookAtRobot", "SurprisedNav"),
    ("ApproachRobot", "CuriousNav"),
    ("RunAwayFromRobot", "ScaredNav"),
    ("BlockRobot", "ThreateningNav"),
];

/// The name a library has for a node that it does not know by this tag.
pub(crate) fn alias(tag: &str, library: Library) -> Option<&'static str> {
    if is_known_to(tag, library) {
        return None;
    }
    let other = |(ours, theirs): &(&'static str, &'static str)| match tag {
        _ if tag == *ours => Some(*theirs),
        _ if tag == *theirs => Some(*ours),
        _ => None,
    };
    ALIASES.iter().filter_map(other).find(|other| is_known_to(other, library))
}

/// Whether a simulator with this library knows the tag. We know all of the fork, which dropped the four
/// reactions of HuNavSim 1.x.
#[must_use]
pub fn is_known_to(tag: &str, library: Library) -> bool {
    sheet_in(tag, library).is_some()
}

/// The sheets a library has, in catalog order.
fn sheets_of(library: Library) -> impl Iterator<Item = &'static NodeSheet> {
    let ours = CATALOG.iter().copied().filter(move |sheet| match library {
        Library::Native => true,
        Library::SocratesFork => sheet.library != Library::Native,
        Library::BuiltIn | Library::HunavSim1_0 | Library::HunavSim1_1 | Library::HunavSim2 => {
            sheet.library == Library::BuiltIn
        }
    });
    let theirs = DIALECTS.iter().filter(move |(of, _)| *of == library).flat_map(|(_, sheets)| sheets);
    let steps = STEPS.iter().copied().filter(move |_| library == Library::Native);
    ours.chain(steps).chain(RARE.iter().copied()).chain(theirs)
}

/// Sheets a library knows, in catalog order: what a prompt may offer.
#[must_use]
pub fn known_to(library: Library) -> Vec<&'static NodeSheet> {
    sheets_of(library).collect()
}

/// What leaves of other libraries have in common; the rest stands in each sheet.
const LEAF: NodeSheet = NodeSheet {
    tag: "",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::Native,
    arity: Arity::NONE,
    ports: &[],
    about: "",
    role: Role::Quiet,
    tick: motion::tick,
    halt: halt_leaf,
};

/// Halting a leaf of ours changes nothing: none is ever left running by its own meaning, and the world was
/// told of those that run by its meaning.
fn halt_leaf(_ticker: &mut Ticker<'_>, _node: usize) {}

/// Halting most nodes: children are put back, then the node.
fn halt_children(ticker: &mut Ticker<'_>, node: usize) {
    ticker.reset_children(node);
    ticker.set(node, Status::Idle);
}

/// Halting a node with a place: that too starts anew.
fn halt_placed(ticker: &mut Ticker<'_>, node: usize) {
    ticker.set_place(node, 0);
    halt_children(ticker, node);
}

/// Halting a sequence or fallback: its place, and in version 4 the count of children left out, start anew.
fn halt_counting_skips(ticker: &mut Ticker<'_>, node: usize) {
    if ticker.is_v4() {
        ticker.set_word(node, 0, 0);
    }
    halt_placed(ticker, node);
}

/// Halting a node that counts in word 0.
fn halt_counting(ticker: &mut Ticker<'_>, node: usize) {
    ticker.set_word(node, 0, 0);
    halt_children(ticker, node);
}

/// A remembered outcome as a word.
pub(crate) const fn memory(outcome: Status) -> u64 {
    match outcome {
        Status::Success => 1,
        Status::Failure => 2,
        Status::Idle | Status::Running | Status::Skipped => 0,
    }
}

/// The outcome that a word remembers.
pub(crate) const fn remembered(word: u64) -> Option<Status> {
    match word {
        1 => Some(Status::Success),
        2 => Some(Status::Failure),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tag_is_listed_once_in_a_library_and_says_what_it_does() {
        for library in Library::ALL {
            let sheets = known_to(library);
            for (place, sheet) in sheets.iter().enumerate() {
                assert!(sheet.about.len() > 10, "{}", sheet.tag);
                assert!(sheets[..place].iter().all(|other| !other.is_called(sheet.tag)), "{library:?} {}", sheet.tag);
                assert!(sheet.line().contains(sheet.tag));
                for (at, port) in sheet.ports.iter().enumerate() {
                    assert!(
                        sheet.ports[..at].iter().all(|other| other.name != port.name),
                        "{} {}",
                        sheet.tag,
                        port.name
                    );
                }
            }
        }
    }

    #[test]
    fn the_fork_lost_the_old_reactions() {
        assert!(!is_known_to("SurprisedNav", Library::SocratesFork));
        assert!(is_known_to("SurprisedNav", Library::HunavSim1_0));
        assert!(is_known_to("SurprisedNav", Library::HunavSim2));
        assert!(is_known_to("RegularNav", Library::SocratesFork));
        assert!(!is_known_to("Latch", Library::SocratesFork));
    }

    #[test]
    fn ports_differ_by_library() {
        let ports = |library| sheet_in("CuriousNav", library).map(|sheet| sheet.ports.len());
        assert_eq!(ports(Library::HunavSim1_0), Some(2));
        assert_eq!(ports(Library::HunavSim1_1), Some(4));
        assert_eq!(ports(Library::HunavSim2), Some(6));
        assert_eq!(sheet_in("SetGoal", Library::HunavSim2).map(NodeSheet::is_native), Some(false));
        assert_eq!(sheet_in("IsRobotClose", Library::HunavSim2).map(NodeSheet::is_native), Some(true));
    }
}
