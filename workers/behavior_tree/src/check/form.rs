//! What can be seen from the shape of a tree alone.

use socrates_model::{Fault, FaultCode};

use crate::blackboard::Input;
use crate::check::{CheckContext, below, place};
use crate::sheet::{PortKind, Role};
use crate::tree::{Format, Tree};
use crate::xml::Element;

/// `B-ORDER` and `B-TIMER` for parts in the wrong order, `B-NAV` for a damaged block, `B-PORT` for entries
/// that nothing sets.
pub(super) fn check(tree: &Tree, ctx: &CheckContext<'_>) -> Vec<Fault> {
    let mut faults = Vec::new();
    for node in tree.nodes.iter() {
        if matches!(node.sheet.tag, "Sequence" | "SequenceWithMemory" | "ReactiveSequence") {
            order(tree, ctx, &node.children, &mut faults);
        }
        unset(tree, ctx, node, &mut faults);
    }
    if tree.format == Format::V3 {
        for def in &tree.document.trees {
            block(&def.root, ctx, &mut faults);
        }
    }
    faults.sort();
    faults.dedup();
    faults
}

/// What a child of a sequence is made of.
#[derive(Default)]
struct Parts {
    moves: bool,
    says: bool,
    timer: bool,
    only_asks: bool,
}

fn parts(tree: &Tree, child: usize) -> Parts {
    let mut parts = Parts { only_asks: true, ..Parts::default() };
    for node in below(tree, child).into_iter().filter_map(|place| tree.nodes.get(place)) {
        match node.sheet.role {
            Role::Flow | Role::Asks(_) => {}
            Role::Timer => parts.timer = true,
            Role::Moves(_) => {
                parts.moves = true;
                parts.only_asks = false;
            }
            Role::Says => {
                parts.says = true;
                parts.only_asks = false;
            }
            Role::Quiet | Role::World | Role::Foreign => parts.only_asks = false,
        }
    }
    parts
}

/// Conditions and timers must come before what they guard.
fn order(tree: &Tree, ctx: &CheckContext<'_>, children: &[usize], faults: &mut Vec<Fault>) {
    let mut done: Option<(usize, bool)> = None;
    for child in children {
        let parts = parts(tree, *child);
        if let (Some((actor, moves)), true) = (done, parts.only_asks)
            && let (Some(guard), Some(actor)) = (tree.nodes.get(*child), tree.nodes.get(actor))
        {
            if parts.timer && moves {
                let message = format!(
                    "the timer comes after the action `{}` that it should limit; put Inverter with the timer before it",
                    actor.name
                );
                faults.push(Fault::new(FaultCode::BTimer, place(ctx, guard), message));
            } else if !parts.timer {
                let message = format!(
                    "the condition `{}` comes after the action `{}`, which is then done although the condition fails; put it before",
                    guard.name, actor.name
                );
                faults.push(Fault::new(FaultCode::BOrder, place(ctx, guard), message));
            }
        }
        if done.is_none_or(|(_, moves)| !moves) && (parts.moves || parts.says) {
            done = Some((*child, parts.moves));
        }
    }
}

/// Entries read in a place that needs a value, and set by nothing.
fn unset(tree: &Tree, ctx: &CheckContext<'_>, node: &crate::tree::Node, faults: &mut Vec<Fault>) {
    for (port, input) in node.sheet.ports.iter().zip(&node.inputs) {
        let Input::Slot(slot) = input else { continue };
        let needs = matches!(
            port.kind,
            PortKind::Meters | PortKind::Seconds | PortKind::Gesture | PortKind::Human | PortKind::Flag
        );
        let set = tree.board.get(*slot).is_some_and(Option::is_some)
            || tree.nodes.iter().any(|other| {
                other.script.is_some()
                    || (other.sheet.tag == "SetBlackboard" && other.inputs.first() == Some(&Input::Slot(*slot)))
            });
        if needs && !set {
            let message = format!("`{}` reads an entry that nothing sets; allowed: {}", port.name, port.kind.allowed());
            faults.push(Fault::new(FaultCode::BPort, place(ctx, node), message));
        }
    }
}

/// Version 3 hands entries to a subtree by their bare names.
fn block(it: &Element, ctx: &CheckContext<'_>, faults: &mut Vec<Fault>) {
    if it.tag == "SubTree" && it.attr("ID") == Some("RegularNavTree") {
        let whole = it.attr("id") == Some("agentid") && it.attr("dt") == Some("timestep");
        if !whole {
            let message = "the block of regular navigation is damaged; use: \
                <SetBlackboard output_key='agentid' value='{id}'/> \
                <SetBlackboard output_key='timestep' value='{dt}'/> \
                <SubTree ID='RegularNavTree' id='agentid' dt='timestep'/>";
            faults.push(Fault::new(FaultCode::BNav, it.at().of(ctx.human), message));
        }
    }
    for child in &it.children {
        block(child, ctx, faults);
    }
}
