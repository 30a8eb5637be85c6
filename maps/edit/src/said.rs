//! An edit in a few words, for whoever did it.

use crate::edit::Edit;

impl Edit {
    /// What was done: `added node n3`.
    #[must_use]
    pub fn said(&self) -> String {
        match self {
            Self::AddNode { id, .. } => format!("added node {}", id.as_ref().map_or("", |id| id.as_str())),
            Self::MoveNodes { nodes } => match nodes.as_slice() {
                [(id, _)] => format!("moved node {id}"),
                _ => format!("moved {} nodes", nodes.len()),
            },
            Self::RenameNode { id, to } => format!("renamed node {id} to {to}"),
            Self::Retype { nodes, edges, kind } => match (nodes.as_slice(), edges.as_slice()) {
                ([id], []) => format!("node {id} is {kind}"),
                ([], [(from, to)]) => format!("edge {from} – {to} is {kind}"),
                _ => format!("{} things are {kind}", nodes.len() + edges.len()),
            },
            Self::AddEdge { from, to, .. } => format!("added edge {from} – {to}"),
            Self::SplitEdge { edge: (from, to), id, .. } => {
                format!("split edge {from} – {to} at {}", id.as_ref().map_or("", |id| id.as_str()))
            }
            Self::Delete { nodes, edges, doors, join } => {
                let all = nodes.iter().map(|id| format!("node {id}"));
                let all = all.chain(edges.iter().map(|(from, to)| format!("edge {from} – {to}")));
                let names: Vec<String> = all.chain(doors.iter().map(|id| format!("door {id}"))).collect();
                let what = if names.len() > 3 { format!("{} things", names.len()) } else { names.join(", ") };
                format!("deleted {what}{}", if *join { " and joined the neighbors" } else { "" })
            }
            Self::AddDoor(door) => format!("added door {}", door.id),
            Self::ChangeDoor { id, door } if *id != door.id => format!("renamed door {id} to {}", door.id),
            Self::ChangeDoor { id, .. } => format!("changed door {id}"),
            Self::Call { nodes, name } => {
                let what = nodes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
                let verb = if nodes.len() == 1 { "is" } else { "are" };
                if name.is_empty() {
                    format!("{what} {verb} called nothing")
                } else {
                    format!("{what} {verb} called {name}")
                }
            }
            Self::Describe { .. } => "changed the description".to_owned(),
            Self::Several(edits) => match edits.as_slice() {
                [first, second] => format!("{}, {}", first.said(), second.said()),
                _ => together(edits),
            },
            Self::Replace(sketch) => format!("took over {} nodes and {} edges", sketch.nodes.len(), sketch.edges.len()),
        }
    }
}

/// Many edits at once, counted.
fn together(edits: &[Edit]) -> String {
    let count = |fits: fn(&Edit) -> bool| edits.iter().filter(|edit| fits(edit)).count();
    let added = [
        (count(|edit| matches!(edit, Edit::AddNode { .. })), "nodes"),
        (count(|edit| matches!(edit, Edit::AddEdge { .. })), "edges"),
        (count(|edit| matches!(edit, Edit::AddDoor(_))), "doors"),
    ];
    let words: Vec<String> =
        added.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    if words.is_empty() { format!("did {} things at once", edits.len()) } else { format!("added {}", words.join(", ")) }
}
