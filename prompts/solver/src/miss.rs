//! Why there are no paths: what does not fit, where, and by how much.

use std::fmt;

use socrates_model::PlaceClass;

use crate::candidates::SHORTEST_M;
use crate::graph::Net;
use crate::{Problem, inside, search};

/// Why a map has no paths for a problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Miss(String);

impl fmt::Display for Miss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Miss {}

/// The reason why a map has no paths for a problem, found by leaving parts of it out.
pub(crate) fn of(problem: &Problem<'_>, net: &Net<'_>) -> Miss {
    Miss(reason(problem, net))
}

fn reason(problem: &Problem<'_>, net: &Net<'_>) -> String {
    let proposal = problem.proposal;
    if let Some(short) = too_short(net) {
        return short;
    }
    let alone = |id| {
        let mut one = proposal.clone();
        one.humans.retain(|human| human.id == id);
        one.groups.clear();
        search::found(&Problem { proposal: &one, ..problem.clone() }, net).is_some()
    };
    let stuck: Vec<String> = proposal
        .humans
        .iter()
        .filter(|human| !alone(human.id))
        .map(|human| {
            let from = human.start.map_or_else(String::new, |class| format!(" from {}", inside::an(class)));
            format!("{} (`{}`{from})", human.id, human.relation.name())
        })
        .collect();
    let at = inside::an(proposal.place);
    if stuck.is_empty() {
        return format!(
            "this map has no paths on which all {} humans meet the robot at {at}, though each of them alone could; ask for fewer, \
             or for another place",
            proposal.humans.len()
        );
    }
    format!(
        "this map has no path of the robot on which it meets {} at {at}; ask for another place or another part, or add nodes to the map",
        stuck.join(" and ")
    )
}

/// The longest path of the robot, where it is too short for any scenario.
fn too_short(net: &Net<'_>) -> Option<String> {
    let open = |node: &usize| !net.inside(*node) && net.kind(*node) != PlaceClass::Doorway;
    let nodes: Vec<usize> = (0..net.len()).filter(open).collect();
    let mut longest: Option<(f64, usize, usize)> = None;
    for from in &nodes {
        let tree = net.tree(*from, &|_| false);
        for to in &nodes {
            let length_m = tree.length_m(*to);
            if length_m.is_finite() && longest.is_none_or(|(most, ..)| length_m > most) {
                longest = Some((length_m, *from, *to));
            }
        }
    }
    match longest.map(|(length_m, from, to)| (length_m, net.id(from), net.id(to))) {
        Some((length_m, Some(from), Some(to))) if length_m < SHORTEST_M => Some(format!(
            "the longest path of the robot on this map, from `{from}` to `{to}`, is {length_m:.1} m; at least {SHORTEST_M} m are needed"
        )),
        Some(_) => None,
        None => Some("this map has no node outside of rooms, where the robot could drive".to_owned()),
    }
}
