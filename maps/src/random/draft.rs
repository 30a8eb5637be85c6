//! A floor plan while it is made, and its text.

use std::collections::BTreeMap;

use super::chance::Chance;
use super::shape::{Area, Spot};

/// Unknown floor round the outer walls, tenths.
const MARGIN: i32 = 5;
/// Thickness of every wall, tenths.
pub(super) const WALL: i32 = 2;

/// A node by its place in the draft.
pub(super) type NodeAt = usize;

#[derive(Debug)]
struct DraftNode {
    id: String,
    kind: String,
    at: Spot,
    /// Whether a corridor bends here.
    bend: bool,
}

/// What opens a door of a random world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Opens {
    /// A door of a room: anybody this near, tenths.
    Near(i32),
    /// A landing door of an elevator.
    Elevator,
}

#[derive(Debug)]
struct DraftDoor {
    id: String,
    line: (Spot, Spot),
    opens: Opens,
    inside: Vec<NodeAt>,
}

/// A room that was made.
#[derive(Debug, Clone)]
pub(super) struct MadeRoom {
    pub(super) kind: String,
    pub(super) area: Area,
    pub(super) nodes: Vec<NodeAt>,
}

/// The plan as far as it is made.
#[derive(Debug, Default)]
pub(super) struct Draft {
    pub(super) description: String,
    /// Whether a room that every building of the kind has is not there.
    pub(super) lacks: bool,
    floors: Vec<Area>,
    walls: Vec<(Spot, Spot)>,
    openings: Vec<(Spot, Spot)>,
    blocks: Vec<Area>,
    nodes: Vec<DraftNode>,
    edges: Vec<(String, Vec<NodeAt>)>,
    doors: Vec<DraftDoor>,
    names: BTreeMap<String, usize>,
    pub(super) rooms: Vec<MadeRoom>,
    /// Names that people use, with the nodes of their areas.
    pub(super) called: Vec<(String, Vec<NodeAt>)>,
}

impl Draft {
    pub(super) fn made(&mut self, kind: &str, area: Area, nodes: &[NodeAt]) {
        self.rooms.push(MadeRoom { kind: kind.to_owned(), area, nodes: nodes.to_vec() });
    }

    pub(super) fn floor(&mut self, area: Area) {
        self.floors.push(area);
    }

    pub(super) fn wall(&mut self, from: Spot, to: Spot) {
        self.walls.push((from, to));
    }

    pub(super) fn opening(&mut self, from: Spot, to: Spot) {
        self.openings.push((from, to));
    }

    pub(super) fn block(&mut self, area: Area) {
        self.blocks.push(area);
    }

    /// The next name of a kind of thing: `c1`, `c2` …
    pub(super) fn name(&mut self, stem: &str) -> String {
        let count = self.names.entry(stem.to_owned()).or_insert(0);
        *count += 1;
        format!("{stem}{count}")
    }

    pub(super) fn node(&mut self, id: String, kind: &str, at: Spot) -> NodeAt {
        self.nodes.push(DraftNode { id, kind: kind.to_owned(), at, bend: false });
        self.nodes.len() - 1
    }

    /// A node where a corridor bends: a corner, or a junction where a third way leads from it, such as through a doorway.
    pub(super) fn bend(&mut self, id: String, at: Spot) -> NodeAt {
        self.nodes.push(DraftNode { id, kind: "BLIND CORNER".to_owned(), at, bend: true });
        self.nodes.len() - 1
    }

    /// Gives a node another type.
    pub(super) fn retype(&mut self, node: NodeAt, kind: &str) {
        if let Some(node) = self.nodes.get_mut(node) {
            kind.clone_into(&mut node.kind);
        }
    }

    /// Gives a plain node of a corridor, where a wide opening leads off, the type of a junction.
    pub(super) fn retype_corridor(&mut self, node: NodeAt) {
        let plain = ["CORRIDOR", "NARROW CORRIDOR", "PASSAGEWAY", "WIDE PASSAGEWAY"];
        if self.nodes.get(node).is_some_and(|node| plain.contains(&node.kind.as_str())) {
            self.retype(node, "INTERSECTION");
        }
    }

    pub(super) fn is_of(&self, node: NodeAt, kind: &str) -> bool {
        self.nodes.get(node).is_some_and(|node| node.kind == kind)
    }

    pub(super) fn id(&self, node: NodeAt) -> &str {
        self.nodes.get(node).map_or("", |node| node.id.as_str())
    }

    pub(super) fn at(&self, node: NodeAt) -> Option<Spot> {
        self.nodes.get(node).map(|node| node.at)
    }

    pub(super) fn edge(&mut self, kind: &str, along: &[NodeAt]) {
        if along.len() >= 2 {
            self.edges.push((kind.to_owned(), along.to_vec()));
        }
    }

    pub(super) fn door(&mut self, id: String, line: (Spot, Spot), opens: Opens, inside: Vec<NodeAt>) {
        self.doors.push(DraftDoor { id, line, opens, inside });
    }

    /// How many ways lead from a node.
    fn ways(&self, at: NodeAt) -> usize {
        let pairs = self.edges.iter().flat_map(|(_, along)| along.windows(2));
        pairs.filter(|pair| pair.contains(&at)).count()
    }

    /// Whether no door or opening leads from a node, asked before the ways along its corridor are there.
    pub(super) fn leads_nowhere(&self, at: NodeAt) -> bool {
        self.ways(at) == 0
    }

    /// The type of a node once all ways are there.
    fn settled<'a>(&self, (at, node): (NodeAt, &'a DraftNode)) -> &'a str {
        if node.bend && self.ways(at) > 2 { "INTERSECTION" } else { &node.kind }
    }

    /// The text of `plan.toml`, turned by quarter turns and mirrored as drawn.
    pub(super) fn text(&self, seed: u64, kind: &str, chance: &mut Chance) -> String {
        self.text_under(&format!("# Random {kind} of seed {seed}; form: maps/README.md. Lengths in m.\n"), chance)
    }

    /// The same under a first line of its own.
    pub(super) fn text_under(&self, title: &str, chance: &mut Chance) -> String {
        let turn = Turn::of(&self.floors, chance);
        let quad = |a: Spot, b: Spot| {
            let (a, b) = (turn.spot(a), turn.spot(b));
            format!("[{}, {}, {}, {}]", meters(a.x), meters(a.y), meters(b.x), meters(b.y))
        };
        let corners = |area: &Area| {
            let turned =
                Area::between(turn.spot(Spot { x: area.x0, y: area.y0 }), turn.spot(Spot { x: area.x1, y: area.y1 }));
            quad_of(&turned)
        };
        let mut out = title.to_owned();
        let (wide, high) = (meters(turn.size.0), meters(turn.size.1));
        out.push_str(&format!(
            "description = \"{}\"\nsize_m = [{wide}, {high}]\nresolution_m = 0.1\nwall_thickness_m = 0.2\n\n",
            self.description
        ));
        let mut list = |name: &str, rows: Vec<String>| {
            let rows: String = rows.iter().map(|row| format!("  {row},\n")).collect();
            out.push_str(&format!("{name} = [\n{rows}]\n"));
        };
        list("floors", self.floors.iter().map(corners).collect());
        list("walls", self.walls.iter().map(|(a, b)| quad(*a, *b)).collect());
        list("openings", self.openings.iter().map(|(a, b)| quad(*a, *b)).collect());
        list("blocks", self.blocks.iter().map(corners).collect());
        let node = |(place, node): (NodeAt, &DraftNode)| {
            let at = turn.spot(node.at);
            let (x, y) = (meters(at.x), meters(at.y));
            format!("{{ id = \"{}\", type = \"{}\", at = [{x}, {y}] }}", node.id, self.settled((place, node)))
        };
        list("nodes", self.nodes.iter().enumerate().map(node).collect());
        let edges =
            |(kind, along): &(String, Vec<NodeAt>)| format!("{{ type = \"{kind}\", along = [{}] }}", self.ids(along));
        list("edges", self.edges.iter().map(edges).collect());
        for door in &self.doors {
            let (from, to) = (turn.spot(door.line.0), turn.spot(door.line.1));
            let (kind, opens, hold) = match door.opens {
                Opens::Near(reach) => ("room", format!("{{ near = {} }}", meters(reach)), "8.0"),
                Opens::Elevator => ("elevator", "{ robot_near = 3.0 }".to_owned(), "15.0"),
            };
            out.push_str(&format!(
                "\n[[doors]]\nid = \"{}\"\nkind = \"{kind}\"\nfrom = [{}, {}]\nto = [{}, {}]\nopens = {opens}\nhold_s = {hold}\ninside = [{}]\n",
                door.id,
                meters(from.x),
                meters(from.y),
                meters(to.x),
                meters(to.y),
                self.ids(&door.inside)
            ));
        }
        for (name, nodes) in &self.called {
            out.push_str(&format!(
                "\n[[names]]\nname = {}\nnodes = [{}]\n",
                toml::Value::from(name.as_str()),
                self.ids(nodes)
            ));
        }
        out
    }

    fn ids(&self, nodes: &[NodeAt]) -> String {
        let ids: Vec<String> =
            nodes.iter().filter_map(|at| self.nodes.get(*at)).map(|node| format!("\"{}\"", node.id)).collect();
        ids.join(", ")
    }
}

fn quad_of(area: &Area) -> String {
    format!("[{}, {}, {}, {}]", meters(area.x0), meters(area.y0), meters(area.x1), meters(area.y1))
}

/// Tenths as meters.
fn meters(tenths: i32) -> String {
    let sign = if tenths < 0 { "-" } else { "" };
    format!("{sign}{}.{}", tenths.abs() / 10, tenths.abs() % 10)
}

/// One of the eight ways to lay a plan on its sheet.
struct Turn {
    from: Spot,
    span: (i32, i32),
    mirrored: bool,
    quarters: i32,
    size: (i32, i32),
}

impl Turn {
    fn of(floors: &[Area], chance: &mut Chance) -> Self {
        let least = |value: fn(&Area) -> i32| floors.iter().map(value).min().unwrap_or(0) - WALL - MARGIN;
        let most = |value: fn(&Area) -> i32| floors.iter().map(value).max().unwrap_or(0) + WALL + MARGIN;
        let from = Spot { x: least(|area| area.x0), y: least(|area| area.y0) };
        let span = (most(|area| area.x1) - from.x, most(|area| area.y1) - from.y);
        let (mirrored, quarters) = (chance.happens(50), chance.between((0, 3)));
        let size = if quarters % 2 == 0 { span } else { (span.1, span.0) };
        Self { from, span, mirrored, quarters, size }
    }

    fn spot(&self, at: Spot) -> Spot {
        let (wide, high) = self.span;
        let (x, y) = (at.x - self.from.x, at.y - self.from.y);
        let x = if self.mirrored { wide - x } else { x };
        match self.quarters {
            0 => Spot { x, y },
            1 => Spot { x: high - y, y: x },
            2 => Spot { x: wide - x, y: high - y },
            _ => Spot { x: y, y: wide - x },
        }
    }
}
