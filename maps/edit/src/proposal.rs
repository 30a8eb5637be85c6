//! What the program finds on the map by itself, taken over whole or in parts.

use std::collections::{BTreeMap, BTreeSet};

use socrates_annotate::{Annotation, Options, annotate};
use socrates_model::{Fault, Grid, Location, NodeId, SceneGraph};

use crate::edit::Edit;
use crate::sketch::{Sketch, Spot};

/// A place of the proposal that is this near to a node that is there is that node, m.
const SAME_M: f64 = 0.5;

/// Nodes, edges and doors that the program found on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// What it would draw.
    pub sketch: Sketch,
    /// What it doubts or asks, with places where there are some.
    pub remarks: Vec<(Option<Spot>, String)>,
}

impl Proposal {
    /// Looks at a map. Takes about 0.2 µs a cell.
    ///
    /// # Errors
    /// Where the map has no floor on which a robot could stand.
    pub fn of(grid: &Grid) -> Result<Self, Vec<Fault>> {
        let Annotation { graph, doors, description, remarks, .. } = annotate(grid, &Options::default())?;
        let mut sketch = Sketch::of(&drawn(grid, graph, doors, description));
        // A hundredth of a pixel, as `map annotate` writes it.
        let tidy = |value: f64| libm::round(value * 100.0) / 100.0;
        for node in &mut sketch.nodes {
            node.at = Spot { x: tidy(node.at.x), y: tidy(node.at.y) };
        }
        let place = |at: Option<socrates_model::Point>| at.map(|point| Spot::of(grid, &point));
        let remarks = remarks.into_iter().map(|remark| (place(remark.at), remark.text)).collect();
        Ok(Self { sketch, remarks })
    }

    /// The edit that takes over the chosen nodes, the edges between them, and the doors before them; all of it where none are chosen.
    /// Places that are drawn already stay as they are, and names that are taken are replaced. None where nothing is new.
    #[must_use]
    pub fn taken_over(&self, sketch: &Sketch, grid: &Grid, chosen: Option<&BTreeSet<NodeId>>) -> Option<Edit> {
        let wanted = |id: &NodeId| chosen.is_none_or(|chosen| chosen.contains(id));
        let mut taken: BTreeSet<String> = sketch.nodes.iter().map(|node| node.id.to_string()).collect();
        let mut called: BTreeMap<&NodeId, NodeId> = BTreeMap::new();
        let mut edits = Vec::new();
        let near_px = SAME_M / grid.resolution_m.max(1e-6);
        for node in self.sketch.nodes.iter().filter(|node| wanted(&node.id)) {
            let apart = |other: Spot| libm::hypot(other.x - node.at.x, other.y - node.at.y);
            if let Some(known) = sketch.nodes.iter().find(|known| apart(known.at) < near_px) {
                called.insert(&node.id, known.id.clone());
                continue;
            }
            let Some(id) = free(&node.id, &taken) else { continue };
            taken.insert(id.to_string());
            called.insert(&node.id, id.clone());
            edits.push(Edit::AddNode { id: Some(id), kind: node.kind.clone(), at: node.at });
        }
        for edge in &self.sketch.edges {
            let ends = called.get(&edge.from).zip(called.get(&edge.to));
            if let Some((from, to)) = ends.filter(|(from, to)| from != to && sketch.edge(from, to).is_none()) {
                edits.push(Edit::AddEdge { from: from.clone(), to: to.clone(), kind: edge.kind.clone() });
            }
        }
        for door in &self.sketch.doors {
            let inside: Vec<NodeId> = door.inside.iter().filter_map(|id| called.get(id)).cloned().collect();
            let middle =
                |door: &crate::Door| (f64::midpoint(door.from.x, door.to.x), f64::midpoint(door.from.y, door.to.y));
            let (x, y) = middle(door);
            let there = |known: &crate::Door| {
                let (known_x, known_y) = middle(known);
                libm::hypot(known_x - x, known_y - y) < near_px
            };
            if inside.is_empty() || sketch.doors.iter().any(there) {
                continue;
            }
            let id = if sketch.door(&door.id).is_some() { sketch.free_door("door") } else { door.id.clone() };
            edits.push(Edit::AddDoor(crate::Door { id, inside, ..door.clone() }));
        }
        if sketch.nodes.is_empty() && chosen.is_none() && !edits.is_empty() {
            edits.push(Edit::Describe { text: self.sketch.description.clone() });
        }
        (!edits.is_empty()).then_some(Edit::Several(edits))
    }
}

fn drawn(grid: &Grid, graph: SceneGraph, doors: Vec<socrates_model::Door>, description: String) -> Location {
    Location {
        format: socrates_model::FORMAT,
        name: String::new(),
        description,
        grid: grid.clone(),
        graph,
        doors,
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

/// A name like this one that is free.
fn free(id: &NodeId, taken: &BTreeSet<String>) -> Option<NodeId> {
    let names = std::iter::once(id.to_string()).chain((2..).map(|number| format!("{id}_{number}")));
    names.into_iter().find(|name| !taken.contains(name)).and_then(|name| NodeId::new(name).ok())
}
