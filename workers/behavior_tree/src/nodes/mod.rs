//! The catalogue: one file per kind of node. A new kind is a new file and a line in [`CATALOG`].

mod always;
mod at_encounter;
mod fallback;
mod follow_human;
mod force;
mod foreign;
mod goal_reached;
mod has_time_passed;
mod human_says;
mod if_then_else;
mod inverter;
mod keep_running;
mod latch;
mod make_gesture;
mod memory_sequence;
mod motion;
mod parallel;
mod path_done;
mod reaction_nav;
mod reactive_fallback;
mod reactive_sequence;
mod repeat;
mod retry;
mod robot_blocking;
mod robot_moved;
mod robot_nearby;
mod robot_says;
mod robot_stopped;
mod robot_visible;
mod run_once;
mod script;
mod sequence;
mod set_blackboard;
mod subtree;
mod switch;
mod time_expired;
mod update_goal;
mod while_do_else;

pub(crate) use foreign::{FOREIGN_ACTION, FOREIGN_CONDITION};

use crate::sheet::{Library, NodeSheet};
use crate::status::Status;
use crate::tick::Ticker;

/// Every kind of node, control flow first, in the order of prompts and docs.
pub const CATALOG: &[&NodeSheet] = &[
    &sequence::SHEET,
    &fallback::SHEET,
    &inverter::SHEET,
    &reactive_sequence::SHEET,
    &reactive_fallback::SHEET,
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
    &repeat::SHEET,
    &retry::SHEET,
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
    &reaction_nav::SURPRISED,
    &reaction_nav::CURIOUS,
    &reaction_nav::SCARED,
    &reaction_nav::THREATENING,
];

/// The sheet of a tag, whatever its library.
#[must_use]
pub fn sheet_of(tag: &str) -> Option<&'static NodeSheet> {
    CATALOG.iter().copied().find(|sheet| sheet.is_called(tag))
}

/// Whether a simulator with this library knows the tag. The fork dropped the four reactions of
/// HuNavSim 1.x and kept the rest; we know all of the fork.
#[must_use]
pub fn is_known_to(tag: &str, library: Library) -> bool {
    let Some(sheet) = sheet_of(tag) else { return false };
    let dropped = matches!(sheet.tag, "SurprisedNav" | "CuriousNav" | "ScaredNav" | "ThreateningNav");
    match sheet.library {
        Library::BuiltIn => true,
        Library::HunavSim1 => library == Library::HunavSim1 || (library != Library::BuiltIn && !dropped),
        Library::SocratesFork => matches!(library, Library::SocratesFork | Library::Native),
        Library::Native => library == Library::Native,
    }
}

/// Sheets a library knows, in catalogue order: what a prompt may offer.
#[must_use]
pub fn known_to(library: Library) -> Vec<&'static NodeSheet> {
    CATALOG.iter().copied().filter(|sheet| is_known_to(sheet.tag, library)).collect()
}

/// Halting a leaf of ours changes nothing: none is ever left running.
fn halt_leaf(_ticker: &mut Ticker<'_>, _node: usize) {}

/// Halting most nodes: children are put back, then the node.
fn halt_children(ticker: &mut Ticker<'_>, node: usize) {
    ticker.reset_children(node);
    ticker.set(node, Status::Idle);
}

/// Halting a node with a place or counter: that too starts anew.
fn halt_counting(ticker: &mut Ticker<'_>, node: usize) {
    let cell = ticker.cell(node);
    cell.index = 0;
    cell.count = 0;
    cell.tally = 0;
    halt_children(ticker, node);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tag_is_listed_once_and_says_what_it_does() {
        for (place, sheet) in CATALOG.iter().enumerate() {
            assert!(sheet.about.len() > 10, "{}", sheet.tag);
            assert!(CATALOG[..place].iter().all(|other| !other.is_called(sheet.tag)), "{}", sheet.tag);
            assert!(sheet.line().contains(sheet.tag));
        }
    }

    #[test]
    fn the_fork_lost_the_old_reactions() {
        assert!(!is_known_to("SurprisedNav", Library::SocratesFork));
        assert!(is_known_to("SurprisedNav", Library::HunavSim1));
        assert!(is_known_to("RegularNav", Library::SocratesFork));
        assert!(!is_known_to("Latch", Library::SocratesFork));
    }
}
