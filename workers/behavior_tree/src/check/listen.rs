//! Who is waited for, and who is spoken of.

use socrates_model::{Action, AgentId, Fault, FaultCode, Gesture, HumanId};

use crate::blackboard::Ports;
use crate::check::{CheckContext, place};
use crate::sheet::{NodeSheet, PortKind, Role};
use crate::tree::{Node, Tree};

/// `B-HEAR` for gestures that nobody makes, `B-RANGE` for humans that are not there, `B-PORT` for
/// entries that nothing sets.
pub(super) fn check(tree: &Tree, ctx: &CheckContext<'_>) -> Vec<Fault> {
    let mut faults = Vec::new();
    for node in tree.nodes.iter() {
        let ports = tree.ports(node);
        match node.sheet.role {
            Role::Asks(means) => {
                if let Some(silence) = awaits_silence(node.sheet, &ports) {
                    faults.push(Fault::new(FaultCode::BHear, place(ctx, node), silence));
                    continue;
                }
                let Some((who, gesture)) = means(&ports).and_then(|trigger| trigger.awaits()) else { continue };
                let made = match who {
                    AgentId::Robot => Some(ctx.robot_says),
                    AgentId::Human(id) => target(id, node, ctx, &mut faults)
                        .then(|| ctx.human_says.get(&id).map_or(&[][..], Vec::as_slice)),
                };
                if let Some(made) = made {
                    hear(who, gesture, made, node, ctx, &mut faults);
                }
            }
            Role::Moves(means) => {
                if let Some(Action::FollowHuman(id) | Action::LookAt(id)) = means(&ports) {
                    target(id, node, ctx, &mut faults);
                }
            }
            Role::Flow | Role::Timer | Role::Says | Role::Quiet | Role::World | Role::Foreign => {}
        }
    }
    faults.sort();
    faults.dedup();
    faults
}

/// What is wrong with a condition on a gesture whose code is 0: no gesture is no message.
fn awaits_silence(sheet: &NodeSheet, ports: &Ports<'_>) -> Option<String> {
    let port = sheet.ports.iter().position(|port| port.kind == PortKind::Gesture)?;
    let name = sheet.ports.get(port).map(|port| port.name)?;
    ports.said(port)?.is_none().then(|| format!("waits for no gesture: {name}=`0`; allowed: {}", Gesture::messages()))
}

fn hear(
    who: AgentId,
    gesture: Gesture,
    made: &[Gesture],
    node: &Node,
    ctx: &CheckContext<'_>,
    faults: &mut Vec<Fault>,
) {
    if made.contains(&gesture) {
        return;
    }
    let made: Vec<&str> = made.iter().map(|gesture| gesture.name()).collect();
    let made = if made.is_empty() { "no gesture".to_owned() } else { made.join(", ") };
    let message = format!("waits for {gesture} of {who}, which never makes it; {who} makes: {made}");
    faults.push(Fault::new(FaultCode::BHear, place(ctx, node), message));
}

/// Whether the human exists and is somebody else.
fn target(id: HumanId, node: &Node, ctx: &CheckContext<'_>, faults: &mut Vec<Fault>) -> bool {
    if id != ctx.human && id.number() <= ctx.humans {
        return true;
    }
    let others: Vec<String> = (1..=ctx.humans.min(64))
        .filter(|number| *number != ctx.human.number())
        .map(|number| number.to_string())
        .collect();
    let others = if others.is_empty() { "nobody, there is no other human".to_owned() } else { others.join(", ") };
    let message = format!("target_id=`{}` is not another human; allowed: {others}", id.number());
    faults.push(Fault::new(FaultCode::BRange, place(ctx, node), message));
    false
}
