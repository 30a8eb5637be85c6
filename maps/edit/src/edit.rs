//! What a person does to a sketch, one thing at a time, and what is refused.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use socrates_model::{AreaName, NodeId};

use crate::sketch::{Door, Edge, Node, Sketch, Spot};

/// Nodes of a sketch, at most.
const MOST_NODES: usize = 20_000;
/// Edges, at most.
const MOST_EDGES: usize = 60_000;
/// Doors, at most.
const MOST_DOORS: usize = 5_000;
/// Characters of a type or of the name of a door, at most.
const WORD_CHARS: usize = 100;
/// Characters of the description, at most.
const DESCRIPTION_CHARS: usize = 4_000;
/// A place farther from the image's corner than this is refused, pixels.
const FAR_PX: f64 = 1e6;

/// The two ends of an edge, in either order.
pub type Pair = (NodeId, NodeId);

/// One thing that a person does. It can be undone as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// A new node.
    AddNode {
        /// Its name; none for the next free `n1`, `n2`, ….
        #[serde(default, skip_serializing_if = "Option::is_none")]
        id: Option<NodeId>,
        /// Kind of place.
        kind: String,
        /// Where.
        at: Spot,
    },
    /// Nodes at other places.
    MoveNodes {
        /// Which, and where to.
        nodes: Vec<(NodeId, Spot)>,
    },
    /// Another name for a node; its edges and doors go with it.
    RenameNode {
        /// The node.
        id: NodeId,
        /// Its new name.
        to: NodeId,
    },
    /// Another type for nodes and edges.
    Retype {
        /// Nodes.
        #[serde(default)]
        nodes: Vec<NodeId>,
        /// Edges.
        #[serde(default)]
        edges: Vec<Pair>,
        /// The type.
        kind: String,
    },
    /// A new edge.
    AddEdge {
        /// One end.
        from: NodeId,
        /// The other end.
        to: NodeId,
        /// Kind of way.
        kind: String,
    },
    /// A new node on an edge, which becomes two of its type.
    SplitEdge {
        /// The edge.
        edge: Pair,
        /// Name of the node; none for the next free one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        id: Option<NodeId>,
        /// Type of the node.
        kind: String,
        /// Where.
        at: Spot,
    },
    /// Nodes, with their edges, edges and doors that go.
    Delete {
        /// Nodes.
        #[serde(default)]
        nodes: Vec<NodeId>,
        /// Edges.
        #[serde(default)]
        edges: Vec<Pair>,
        /// Doors.
        #[serde(default)]
        doors: Vec<String>,
        /// Whether the two neighbors of a node that goes are joined, where it has just two.
        #[serde(default)]
        join: bool,
    },
    /// A new door.
    AddDoor(Door),
    /// A door as it is from now on, its name too.
    ChangeDoor {
        /// Its name until now.
        id: String,
        /// The door.
        door: Door,
    },
    /// What people call the area of these nodes: they belong to the area of that name and to no other.
    Call {
        /// The nodes.
        nodes: Vec<NodeId>,
        /// The name, without an article; empty for none.
        name: String,
    },
    /// The sentence about the place.
    Describe {
        /// The text.
        text: String,
    },
    /// Several edits that are one.
    Several(Vec<Edit>),
    /// Everything anew.
    Replace(Sketch),
}

/// Why an edit is not done. The sketch is as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// There is no such node.
    #[error("there is no node `{id}`")]
    NoNode {
        /// The name.
        id: NodeId,
    },
    /// The name of a node is taken.
    #[error("a node is called `{id}` already; choose another name")]
    NodeTaken {
        /// The name.
        id: NodeId,
    },
    /// There is no such edge.
    #[error("there is no edge between `{from}` and `{to}`")]
    NoEdge {
        /// One end.
        from: NodeId,
        /// The other end.
        to: NodeId,
    },
    /// There is an edge already.
    #[error("`{from}` and `{to}` are joined already")]
    EdgeTaken {
        /// One end.
        from: NodeId,
        /// The other end.
        to: NodeId,
    },
    /// An edge from a node to itself.
    #[error("an edge joins two nodes; both ends are `{id}`")]
    Loop {
        /// The node.
        id: NodeId,
    },
    /// There is no such door.
    #[error("there is no door `{id}`")]
    NoDoor {
        /// The name.
        id: String,
    },
    /// The name of a door is taken.
    #[error("a door is called `{id}` already; choose another name")]
    DoorTaken {
        /// The name.
        id: String,
    },
    /// A place that is nowhere near the image.
    #[error("({x}, {y}) is no place on the image; allowed: -{FAR_PX} to {FAR_PX} pixels")]
    Far {
        /// To the right.
        x: f64,
        /// Down.
        y: f64,
    },
    /// A word that cannot stand in a file as it is.
    #[error("the {what} has {found} characters or a line break; allowed: at most {most} in one line")]
    Word {
        /// What it is.
        what: &'static str,
        /// Characters.
        found: usize,
        /// Most characters.
        most: usize,
    },
    /// A name that no area can have.
    #[error("`{name}` is no name of an area; allowed: 1 to 60 letters on one line, no blank at either end")]
    NoName {
        /// The name.
        name: String,
    },
    /// Too much of something.
    #[error("there would be {found} {what}; allowed: {most}")]
    TooMany {
        /// What.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many are allowed.
        most: usize,
    },
    /// An edit that does nothing.
    #[error("nothing is named that could be changed")]
    Nothing,
}

impl Sketch {
    /// Does an edit, and gives it as it was done: with the names that were left to this.
    ///
    /// # Errors
    /// [`EditError`]; the sketch is as it was then.
    pub fn apply(&mut self, edit: Edit) -> Result<Edit, EditError> {
        let mut next = self.clone();
        let done = next.act(edit)?;
        for (what, found, most) in [
            ("nodes", next.nodes.len(), MOST_NODES),
            ("edges", next.edges.len(), MOST_EDGES),
            ("doors", next.doors.len(), MOST_DOORS),
        ] {
            if found > most {
                return Err(EditError::TooMany { what, found, most });
            }
        }
        *self = next;
        Ok(done)
    }

    fn act(&mut self, edit: Edit) -> Result<Edit, EditError> {
        match edit {
            Edit::AddNode { id, kind, at } => {
                let id = self.add_node(id, &kind, at)?;
                Ok(Edit::AddNode { id: Some(id), kind, at })
            }
            Edit::MoveNodes { nodes } => self.move_nodes(nodes),
            Edit::RenameNode { id, to } => self.rename(id, to),
            Edit::Retype { nodes, edges, kind } => self.retype(nodes, edges, kind),
            Edit::AddEdge { from, to, kind } => {
                self.add_edge(&from, &to, &kind)?;
                Ok(Edit::AddEdge { from, to, kind })
            }
            Edit::SplitEdge { edge, id, kind, at } => self.split(edge, id, kind, at),
            Edit::Delete { nodes, edges, doors, join } => self.delete(nodes, edges, doors, join),
            Edit::AddDoor(door) => {
                self.fits(&door, None)?;
                self.doors.push(door.clone());
                Ok(Edit::AddDoor(door))
            }
            Edit::ChangeDoor { id, door } => {
                self.fits(&door, Some(&id))?;
                let slot = self.doors.iter_mut().find(|known| known.id == id);
                *slot.ok_or_else(|| EditError::NoDoor { id: id.clone() })? = door.clone();
                Ok(Edit::ChangeDoor { id, door })
            }
            Edit::Call { nodes, name } => self.call(nodes, name),
            Edit::Describe { text } => {
                text_fits("description", &text, DESCRIPTION_CHARS, true)?;
                self.description.clone_from(&text);
                Ok(Edit::Describe { text })
            }
            Edit::Several(edits) if edits.is_empty() => Err(EditError::Nothing),
            Edit::Several(edits) => {
                let done: Result<Vec<Edit>, EditError> = edits.into_iter().map(|edit| self.act(edit)).collect();
                done.map(Edit::Several)
            }
            Edit::Replace(sketch) => self.replace(sketch),
        }
    }

    /// The next free name of a node.
    #[must_use]
    pub fn free_node(&self) -> Option<NodeId> {
        let taken: BTreeSet<&str> = self.nodes.iter().map(|node| node.id.as_str()).collect();
        let name = (1..).map(|number| format!("n{number}")).find(|name| !taken.contains(name.as_str()))?;
        NodeId::new(name).ok()
    }

    /// The next free name of a door that begins so: `door_1`, `door_2`, ….
    #[must_use]
    pub fn free_door(&self, begins: &str) -> String {
        let taken = |name: &String| self.doors.iter().any(|door| &door.id == name);
        (1..).map(|number| format!("{begins}_{number}")).find(|name| !taken(name)).unwrap_or_default()
    }

    fn has(&self, id: &NodeId) -> Result<(), EditError> {
        self.node(id).map(|_| ()).ok_or_else(|| EditError::NoNode { id: id.clone() })
    }

    fn add_node(&mut self, id: Option<NodeId>, kind: &str, at: Spot) -> Result<NodeId, EditError> {
        is_near(at)?;
        text_fits("type", kind, WORD_CHARS, false)?;
        let id = id.or_else(|| self.free_node()).ok_or(EditError::Nothing)?;
        if self.node(&id).is_some() {
            return Err(EditError::NodeTaken { id });
        }
        self.nodes.push(Node { id: id.clone(), kind: kind.to_owned(), at });
        Ok(id)
    }

    fn move_nodes(&mut self, nodes: Vec<(NodeId, Spot)>) -> Result<Edit, EditError> {
        if nodes.is_empty() {
            return Err(EditError::Nothing);
        }
        for (id, at) in &nodes {
            is_near(*at)?;
            let node = self.nodes.iter_mut().find(|node| &node.id == id);
            node.ok_or_else(|| EditError::NoNode { id: id.clone() })?.at = *at;
        }
        Ok(Edit::MoveNodes { nodes })
    }

    fn rename(&mut self, id: NodeId, to: NodeId) -> Result<Edit, EditError> {
        self.has(&id)?;
        if id == to {
            return Err(EditError::Nothing);
        }
        if self.node(&to).is_some() {
            return Err(EditError::NodeTaken { id: to });
        }
        let ends = self.edges.iter_mut().flat_map(|edge| [&mut edge.from, &mut edge.to]);
        let named = self.nodes.iter_mut().map(|node| &mut node.id).chain(ends);
        for name in named
            .chain(self.doors.iter_mut().flat_map(|door| &mut door.inside))
            .chain(self.names.iter_mut().flat_map(|area| &mut area.nodes))
        {
            if *name == id {
                name.clone_from(&to);
            }
        }
        Ok(Edit::RenameNode { id, to })
    }

    fn call(&mut self, nodes: Vec<NodeId>, name: String) -> Result<Edit, EditError> {
        if nodes.is_empty() {
            return Err(EditError::Nothing);
        }
        nodes.iter().try_for_each(|id| self.has(id))?;
        if !name.is_empty() && !socrates_maps::is_area_name(&name) {
            return Err(EditError::NoName { name });
        }
        // Names differ by more than capitals: the area keeps the name that it has.
        let lower = name.to_lowercase();
        let named = |area: &&mut AreaName| area.name.to_lowercase() == lower;
        self.names.iter_mut().for_each(|area| area.nodes.retain(|id| !nodes.contains(id)));
        match self.names.iter_mut().find(named) {
            Some(area) => area.nodes.extend(nodes.iter().cloned()),
            None if name.is_empty() => {}
            None => self.names.push(AreaName { name: name.clone(), nodes: nodes.clone() }),
        }
        self.names.retain(|area| !area.nodes.is_empty());
        Ok(Edit::Call { nodes, name })
    }

    fn retype(&mut self, nodes: Vec<NodeId>, edges: Vec<Pair>, kind: String) -> Result<Edit, EditError> {
        if nodes.is_empty() && edges.is_empty() {
            return Err(EditError::Nothing);
        }
        text_fits("type", &kind, WORD_CHARS, false)?;
        for id in &nodes {
            let node = self.nodes.iter_mut().find(|node| &node.id == id);
            node.ok_or_else(|| EditError::NoNode { id: id.clone() })?.kind.clone_from(&kind);
        }
        for (a, b) in &edges {
            let edge = self.edges.iter_mut().find(|edge| edge.joins(a, b));
            let none = || EditError::NoEdge { from: a.clone(), to: b.clone() };
            edge.ok_or_else(none)?.kind.clone_from(&kind);
        }
        Ok(Edit::Retype { nodes, edges, kind })
    }

    fn add_edge(&mut self, from: &NodeId, to: &NodeId, kind: &str) -> Result<(), EditError> {
        self.has(from)?;
        self.has(to)?;
        text_fits("type", kind, WORD_CHARS, false)?;
        if from == to {
            return Err(EditError::Loop { id: from.clone() });
        }
        if self.edge(from, to).is_some() {
            return Err(EditError::EdgeTaken { from: from.clone(), to: to.clone() });
        }
        self.edges.push(Edge { from: from.clone(), to: to.clone(), kind: kind.to_owned() });
        Ok(())
    }

    fn split(&mut self, edge: Pair, id: Option<NodeId>, kind: String, at: Spot) -> Result<Edit, EditError> {
        let place = self.edges.iter().position(|known| known.joins(&edge.0, &edge.1));
        let none = || EditError::NoEdge { from: edge.0.clone(), to: edge.1.clone() };
        let place = place.ok_or_else(none)?;
        let id = self.add_node(id, &kind, at)?;
        // Both halves stand where the whole stood.
        let whole = self.edges.remove(place);
        self.edges.insert(place, Edge { from: id.clone(), to: whole.to, kind: whole.kind.clone() });
        self.edges.insert(place, Edge { from: whole.from, to: id.clone(), kind: whole.kind });
        Ok(Edit::SplitEdge { edge, id: Some(id), kind, at })
    }

    fn delete(
        &mut self,
        nodes: Vec<NodeId>,
        edges: Vec<Pair>,
        doors: Vec<String>,
        join: bool,
    ) -> Result<Edit, EditError> {
        if nodes.is_empty() && edges.is_empty() && doors.is_empty() {
            return Err(EditError::Nothing);
        }
        for (a, b) in &edges {
            let before = self.edges.len();
            self.edges.retain(|edge| !edge.joins(a, b));
            if self.edges.len() == before {
                return Err(EditError::NoEdge { from: a.clone(), to: b.clone() });
            }
        }
        for id in &nodes {
            self.has(id)?;
            let meets = |edge: &&Edge| &edge.from == id || &edge.to == id;
            let ways: Vec<Edge> = self.edges.iter().filter(meets).cloned().collect();
            self.edges.retain(|edge| !meets(&edge));
            self.nodes.retain(|node| &node.id != id);
            self.doors.iter_mut().for_each(|door| door.inside.retain(|inner| inner != id));
            self.names.iter_mut().for_each(|area| area.nodes.retain(|inner| inner != id));
            self.names.retain(|area| !area.nodes.is_empty());
            let other = |edge: &Edge| if &edge.from == id { edge.to.clone() } else { edge.from.clone() };
            if let ([first, second], true) = (ways.as_slice(), join) {
                let (a, b) = (other(first), other(second));
                if a != b && self.edge(&a, &b).is_none() {
                    self.edges.push(Edge { from: a, to: b, kind: first.kind.clone() });
                }
            }
        }
        for id in &doors {
            if self.door(id).is_none() {
                return Err(EditError::NoDoor { id: id.clone() });
            }
            self.doors.retain(|door| &door.id != id);
        }
        Ok(Edit::Delete { nodes, edges, doors, join })
    }

    /// Whether a door can stand in the list, in place of the one of a name.
    fn fits(&self, door: &Door, instead: Option<&str>) -> Result<(), EditError> {
        is_near(door.from)?;
        is_near(door.to)?;
        text_fits("name of the door", &door.id, WORD_CHARS, false)?;
        if instead != Some(door.id.as_str()) && self.door(&door.id).is_some() {
            return Err(EditError::DoorTaken { id: door.id.clone() });
        }
        door.inside.iter().try_for_each(|id| self.has(id))
    }

    fn replace(&mut self, sketch: Sketch) -> Result<Edit, EditError> {
        let mut fresh = Self::default();
        text_fits("description", &sketch.description, DESCRIPTION_CHARS, true)?;
        fresh.description.clone_from(&sketch.description);
        for node in &sketch.nodes {
            fresh.add_node(Some(node.id.clone()), &node.kind, node.at)?;
        }
        for edge in &sketch.edges {
            fresh.add_edge(&edge.from, &edge.to, &edge.kind)?;
        }
        for door in &sketch.doors {
            fresh.fits(door, None)?;
            fresh.doors.push(door.clone());
        }
        *self = fresh;
        Ok(Edit::Replace(sketch))
    }
}

fn is_near(at: Spot) -> Result<(), EditError> {
    let near = |value: f64| value.abs() <= FAR_PX;
    if near(at.x) && near(at.y) { Ok(()) } else { Err(EditError::Far { x: at.x, y: at.y }) }
}

fn text_fits(what: &'static str, text: &str, most: usize, lines: bool) -> Result<(), EditError> {
    let found = text.chars().count();
    let breaks = text.chars().any(|c| c.is_control() && !(lines && c == '\n'));
    if found > most || breaks { Err(EditError::Word { what, found, most }) } else { Ok(()) }
}
