//! How near one annotation of a map comes to another: places, ways, types, doors, detours, and whether it can be walked.
//!
//! Measures after the project's own definition: one-to-one matching of structural places within 1.0 m (doors within 0.5 m), F1 of
//! ways after plain places with two ways are left out, types of matched places, lengths of ways between all places of the first
//! annotation, and edges that a robot of 0.3 m radius can pass.

mod assign;
mod detour;

use std::collections::BTreeSet;

use serde::Serialize;
use socrates_maps::Ground;
use socrates_model::{Location, PlaceClass, Point};

pub use detour::Detours;

/// Places match within this distance, m.
const PLACE_M: f64 = 1.0;
/// Doors match within this distance, m.
const DOOR_M: f64 = 0.5;
/// Radius of the robot that has to get along every edge, m, less what half a cell makes of it.
const ROBOT_M: f64 = 0.3;

/// How many of two sets belong together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    /// How many the first has.
    pub first: usize,
    /// How many the second has.
    pub second: usize,
    /// Pairs.
    pub matched: usize,
    /// Share of the second that is in the first, 0 to 1; 1 where both are empty.
    pub precision: f64,
    /// Share of the first that is in the second, 0 to 1; 1 where both are empty.
    pub recall: f64,
    /// Harmonic mean of both.
    pub f1: f64,
}

impl Agreement {
    #[expect(clippy::cast_precision_loss, reason = "a graph has far fewer than 2^53 nodes")]
    fn of(first: usize, second: usize, matched: usize) -> Self {
        let share =
            |of: usize| if of == 0 { f64::from(u8::from(first + second == 0)) } else { matched as f64 / of as f64 };
        let (precision, recall) = (share(second), share(first));
        let both = precision + recall;
        Self {
            first,
            second,
            matched,
            precision,
            recall,
            f1: if both > 0.0 { 2.0 * precision * recall / both } else { 0.0 },
        }
    }
}

/// Whether the second annotation can be walked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Validity {
    /// Its edges.
    pub edges: usize,
    /// Edges on which a robot of 0.3 m radius does not fit somewhere.
    pub blocked: usize,
    /// Parts that do not hang together; 1 in a good one.
    pub parts: usize,
    /// Nodes that are not on free floor.
    pub in_walls: usize,
}

/// How near the second annotation comes to the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Score {
    /// All nodes within 1.0 m.
    pub nodes: Agreement,
    /// Intersections, corners, doorways and ends within 1.0 m.
    pub structural: Agreement,
    /// Doorways and declared doors within 0.5 m.
    pub doors: Agreement,
    /// Edges between matched places, plain places with two ways left out.
    pub edges: Agreement,
    /// Share of matched nodes with the same place class, 0 to 1.
    pub types: f64,
    /// Ways between places of the first, walked on the second.
    pub detours: Detours,
    /// Whether the second can be walked.
    pub validity: Validity,
}

/// Compares the second annotation with the first; both in the same map frame. The walls are those of the second.
#[must_use]
pub fn score(first: &Location, second: &Location) -> Score {
    let (all, all_second) = (points(first, |_| true), points(second, |_| true));
    let pairs = assign::matched(&spots(&all), &spots(&all_second), PLACE_M);
    let same = pairs.iter().filter(|(a, b)| {
        let class = |location: &Location, list: &[(usize, Point)], at: usize| {
            list.get(at).map(|(node, _)| class(location, *node))
        };
        class(first, &all, *a) == class(second, &all_second, *b)
    });
    #[expect(clippy::cast_precision_loss, reason = "a graph has far fewer than 2^53 nodes")]
    let types = if pairs.is_empty() { 0.0 } else { same.count() as f64 / pairs.len() as f64 };
    let structural = |class: PlaceClass| {
        matches!(class, PlaceClass::Intersection | PlaceClass::BlindCorner | PlaceClass::Doorway | PlaceClass::Exit)
    };
    Score {
        nodes: Agreement::of(all.len(), all_second.len(), pairs.len()),
        structural: agreement(&spots(&points(first, structural)), &spots(&points(second, structural)), PLACE_M),
        doors: agreement(&doors(first), &doors(second), DOOR_M),
        edges: edges(first, second),
        types,
        detours: detour::detours(first, second),
        validity: validity(second),
    }
}

fn agreement(first: &[Point], second: &[Point], within_m: f64) -> Agreement {
    Agreement::of(first.len(), second.len(), assign::matched(first, second, within_m).len())
}

fn spots(points: &[(usize, Point)]) -> Vec<Point> {
    points.iter().map(|(_, at)| *at).collect()
}

/// The class of a node: of its type; an intersection where three or more ways meet on a corridor.
fn class(location: &Location, node: usize) -> PlaceClass {
    let own = location.graph.kind_at(node);
    let on_way = matches!(own, PlaceClass::Corridor | PlaceClass::NarrowPassage | PlaceClass::Plain);
    if on_way && location.graph.is_at(node, PlaceClass::Intersection) { PlaceClass::Intersection } else { own }
}

fn points(location: &Location, wanted: impl Fn(PlaceClass) -> bool) -> Vec<(usize, Point)> {
    let nodes = location.graph.nodes().iter().enumerate();
    nodes.filter(|(at, _)| wanted(class(location, *at))).map(|(at, node)| (at, node.at)).collect()
}

/// Where doors are: doorway nodes, and declared doors without one.
#[must_use]
pub fn doors(location: &Location) -> Vec<Point> {
    let mut found = spots(&points(location, |class| class == PlaceClass::Doorway));
    for door in &location.doors {
        let middle = door.middle();
        if found.iter().all(|known| (known - middle).norm() > DOOR_M) {
            found.push(middle);
        }
    }
    found
}

/// Edges between places that are not plain points on a way, as pairs of nodes.
fn contracted(location: &Location) -> (Vec<usize>, BTreeSet<[usize; 2]>) {
    let graph = &location.graph;
    let plain = |node: usize| {
        let on_way = matches!(
            class(location, node),
            PlaceClass::Corridor | PlaceClass::NarrowPassage | PlaceClass::OpenArea | PlaceClass::Plain
        );
        let ways = graph.nodes().get(node).map_or(0, |node| graph.degree(&node.id));
        on_way && ways == 2
    };
    let next = |node: usize| -> Vec<usize> {
        let ids = graph.nodes().get(node).map_or(&[][..], |node| graph.neighbors(&node.id));
        ids.iter().filter_map(|id| graph.position(id)).collect()
    };
    let kept: Vec<usize> = (0..graph.nodes().len()).filter(|node| !plain(*node)).collect();
    let mut edges = BTreeSet::new();
    for start in &kept {
        for second in next(*start) {
            let (mut before, mut here) = (*start, second);
            // A ring of plain places alone has no kept one, so this ends.
            for _ in 0..graph.nodes().len() {
                if !plain(here) {
                    break;
                }
                let Some(on) = next(here).into_iter().find(|node| *node != before) else { break };
                (before, here) = (here, on);
            }
            if here != *start {
                edges.insert([here.min(*start), here.max(*start)]);
            }
        }
    }
    (kept, edges)
}

fn edges(first: &Location, second: &Location) -> Agreement {
    let ((kept, edges), (kept_second, edges_second)) = (contracted(first), contracted(second));
    let at = |location: &Location, kept: &[usize]| -> Vec<Point> {
        kept.iter().filter_map(|node| location.graph.nodes().get(*node)).map(|node| node.at).collect()
    };
    let pairs = assign::matched(&at(first, &kept), &at(second, &kept_second), PLACE_M);
    let partner = |node: usize| {
        let place = kept.iter().position(|other| *other == node)?;
        let (_, other) = pairs.iter().find(|(one, _)| *one == place)?;
        kept_second.get(*other).copied()
    };
    let found = edges.iter().filter(|[a, b]| {
        partner(*a).zip(partner(*b)).is_some_and(|(a, b)| edges_second.contains(&[a.min(b), a.max(b)]))
    });
    Agreement::of(edges.len(), edges_second.len(), found.count())
}

fn validity(location: &Location) -> Validity {
    let ground = Ground::of(&location.grid);
    let field = ground.field();
    // In an opening of an even number of cells the middle lies between cells.
    let least_m = ROBOT_M - 0.02;
    let blocked = location.graph.edges().iter().filter(|edge| {
        let points = location.graph.edge_points(&edge.from, &edge.to).unwrap_or_default();
        points.windows(2).any(|pair| {
            let [a, b] = pair else { return false };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an edge is a few meters long")]
            let steps = ((b - a).norm() / 0.05).ceil().clamp(1.0, 1e5) as u32;
            (0..=steps).any(|step| field.clearance(&(a + (b - a) * (f64::from(step) / f64::from(steps)))) < least_m)
        })
    });
    Validity {
        edges: location.graph.edges().len(),
        blocked: blocked.count(),
        parts: location.graph.parts().len(),
        in_walls: location.graph.nodes().iter().filter(|node| !location.grid.is_free(&node.at)).count(),
    }
}
