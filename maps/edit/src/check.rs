//! What is wrong with what is drawn, and where: all that reading the folder says, and what a person would want to be told besides.

use serde::Serialize;
use socrates_maps::{About, Finding, Ground, whole};
use socrates_model::{Location, NodeId, Point};

use crate::sketch::{Sketch, Spot};

/// A robot that fits everywhere in the shipped locations, m; the annotation of a map reckons with the same.
const ROBOT_M: f64 = 0.3;
/// Nodes nearer to each other than this are most likely one, m.
const NEAR_M: f64 = 0.3;
/// Clearance along an edge is asked for at places so far apart, m.
const STEP_M: f64 = 0.05;
/// Places of one edge that are looked at, at most.
const STEPS: u32 = 4_000;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// The folder would be refused.
    Refused,
    /// The folder is read with a warning.
    Warned,
    /// Nothing is said when the folder is read.
    Advised,
}

/// What of the sketch it is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// The whole of it.
    Whole,
    /// A node.
    Node(NodeId),
    /// An edge, by its ends.
    Edge(NodeId, NodeId),
    /// A door.
    Door(String),
}

/// Something to be told, beside what it is about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remark {
    /// How bad it is.
    pub level: Level,
    /// The code of the fault, which `socrates explain` has a page for; none for advice.
    pub code: Option<&'static str>,
    /// A sentence for a person.
    pub text: String,
    /// What it is about.
    pub subject: Subject,
    /// Where on the image; none where it is about the whole.
    pub at: Option<Spot>,
}

/// Says everything about a sketch: what refuses the folder first, in the order of the files. `location` holds the map, and afterwards the
/// sketch as the program reads it: its edges led round walls.
pub fn check(sketch: &Sketch, location: &mut Location) -> Vec<Remark> {
    sketch.put_into(location);
    if sketch.nodes.len() < 2 || sketch.edges.is_empty() {
        return vec![too_small(sketch)];
    }
    let found = whole(location);
    let mut remarks: Vec<Remark> = found.into_iter().map(|finding| of_finding(finding, location)).collect();
    remarks.extend(advice(sketch, location));
    remarks.sort_by_key(|remark| remark.level);
    remarks
}

/// What is said of a sketch on which nobody could walk: there is nothing else to be looked at.
fn too_small(sketch: &Sketch) -> Remark {
    let (nodes, edges) = (sketch.nodes.len(), sketch.edges.len());
    let text = format!(
        "there are {nodes} nodes and {edges} edges; a location needs at least two nodes, and an edge between them"
    );
    Remark { level: Level::Refused, code: Some("M-ID"), text, subject: Subject::Whole, at: None }
}

fn of_finding(finding: Finding, location: &Location) -> Remark {
    let Finding { about, at, fault } = finding;
    let subject = match about {
        // A name is told by its text: the page leads to its first node.
        About::Name(place) => {
            let node = location.names.get(place).and_then(|area| area.nodes.first());
            node.map_or(Subject::Whole, |id| Subject::Node(id.clone()))
        }
        About::Whole => Subject::Whole,
        About::Node(id) => Subject::Node(id),
        About::Edge(from, to) => Subject::Edge(from, to),
        About::Door(place) => location.doors.get(place).map_or(Subject::Whole, |door| Subject::Door(door.id.clone())),
    };
    Remark {
        level: if fault.is_soft() { Level::Warned } else { Level::Refused },
        code: Some(fault.code.code()),
        text: fault.message.to_string(),
        subject,
        at: at.map(|point| Spot::of(&location.grid, &point)),
    }
}

/// What no reader of the folder says.
fn advice(sketch: &Sketch, location: &Location) -> Vec<Remark> {
    let ground = Ground::of(&location.grid);
    let mut told = narrow_edges(sketch, location, &ground);
    told.extend(near_nodes(sketch, location));
    for door in sketch.doors.iter().filter(|door| door.inside.is_empty()) {
        let text = "no node is named as lying behind this door, so that nobody comes out of it or goes in; choose the nodes inside".to_owned();
        let at = Spot { x: f64::midpoint(door.from.x, door.to.x), y: f64::midpoint(door.from.y, door.to.y) };
        told.push(advised(text, Subject::Door(door.id.clone()), at));
    }
    told
}

fn advised(text: String, subject: Subject, at: Spot) -> Remark {
    Remark { level: Level::Advised, code: None, text, subject, at: Some(at) }
}

/// Edges on which a robot does not fit, with the tightest place.
fn narrow_edges(sketch: &Sketch, location: &Location, ground: &Ground) -> Vec<Remark> {
    let mut told = Vec::new();
    for edge in &sketch.edges {
        let Some(points) = location.graph.edge_points(&edge.from, &edge.to) else { continue };
        // An edge through a wall is refused already.
        let crosses = points.windows(2).any(|pair| matches!(pair, [a, b] if !ground.sight().clear(a, b)));
        let Some((least_m, at)) = tightest(ground, &points).filter(|(least_m, _)| *least_m < ROBOT_M && !crosses)
        else {
            continue;
        };
        let text = format!(
            "{least_m:.2} m to the nearest wall; a robot of {ROBOT_M} m radius does not fit through between `{}` and `{}`",
            edge.from, edge.to
        );
        told.push(advised(text, Subject::Edge(edge.from.clone(), edge.to.clone()), Spot::of(&location.grid, &at)));
    }
    told
}

/// The place of a way that is nearest to a wall, and how near, m.
pub(crate) fn tightest(ground: &Ground, points: &[Point]) -> Option<(f64, Point)> {
    let mut least: Option<(f64, Point)> = None;
    for pair in points.windows(2) {
        let [a, b] = pair else { continue };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most STEPS")]
        let steps = ((b - a).norm() / STEP_M).clamp(1.0, f64::from(STEPS)) as u32;
        for step in 0..=steps {
            let at = a + (b - a) * (f64::from(step) / f64::from(steps));
            let clear_m = ground.field().clearance(&at);
            if least.is_none_or(|(known, _)| clear_m < known) {
                least = Some((clear_m, at));
            }
        }
    }
    least
}

/// Nodes that lie almost on each other: sorted by column, so that only neighbors are looked at.
fn near_nodes(sketch: &Sketch, location: &Location) -> Vec<Remark> {
    let near_px = NEAR_M / location.grid.resolution_m.max(1e-6);
    let mut by_column: Vec<_> = sketch.nodes.iter().collect();
    by_column.sort_by(|a, b| a.at.x.total_cmp(&b.at.x));
    let mut told = Vec::new();
    for (place, node) in by_column.iter().enumerate() {
        for other in by_column.iter().skip(place + 1).take_while(|other| other.at.x - node.at.x < near_px) {
            let apart_px = libm::hypot(other.at.x - node.at.x, other.at.y - node.at.y);
            if apart_px < near_px {
                let apart_m = apart_px * location.grid.resolution_m;
                let text = format!(
                    "`{}` and `{}` are {apart_m:.2} m apart; most likely they are one place",
                    node.id, other.id
                );
                told.push(advised(text, Subject::Node(other.id.clone()), other.at));
            }
        }
    }
    told
}
