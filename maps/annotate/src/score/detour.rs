//! How much longer the ways of one annotation are on another.

use serde::Serialize;
use socrates_maps::Ground;
use socrates_model::geometry::nearest_on_segment;
use socrates_model::{GraphNode, Location, NodeId, Point};

/// A graph is entered this near to a place at most, m.
const ENTER_M: f64 = 8.0;
/// Ways shorter than this are not compared, m: their ends are as far apart as places match.
const LEAST_M: f64 = 4.0;

/// Lengths of ways between all pairs of places of the first annotation, walked on the second, over their lengths on the first.
///
/// A place enters the second graph at the nearest point of an edge that it sees; what it walks there counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Detours {
    /// Pairs that were compared: those at least 4 m apart on the first.
    pub pairs: usize,
    /// Pairs that the second does not join.
    pub unreached: usize,
    /// Median of the ratio.
    pub p50: f64,
    /// 95th percentile of the ratio.
    pub p95: f64,
}

/// Where a place enters a graph: how far it is to there, and from there to nodes.
struct Entry {
    off_m: f64,
    edge: usize,
    along_m: f64,
    ends: [(usize, f64); 2],
}

pub(super) fn detours(first: &Location, second: &Location) -> Detours {
    let (on_first, on_second) = (lengths(first), lengths(second));
    let entries: Vec<Option<Entry>> = first.graph.nodes().iter().map(|node| entry(second, &node.at)).collect();
    let (mut ratios, mut unreached) = (Vec::new(), 0);
    for a in 0..first.graph.nodes().len() {
        for b in 0..a {
            let Some(length) = on_first.get(a).and_then(|row| row.get(b)).copied() else { continue };
            if !length.is_finite() || length < LEAST_M {
                continue;
            }
            let both = entries.get(a).and_then(Option::as_ref).zip(entries.get(b).and_then(Option::as_ref));
            match both.map(|(a, b)| walked(a, b, &on_second)).filter(|way| way.is_finite()) {
                Some(way) => ratios.push(way / length),
                None => unreached += 1,
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a list"
    )]
    let at = |share: f64| ratios.get((share * ratios.len().saturating_sub(1) as f64).round() as usize).copied();
    Detours { pairs: ratios.len() + unreached, unreached, p50: at(0.5).unwrap_or(0.0), p95: at(0.95).unwrap_or(0.0) }
}

fn walked(a: &Entry, b: &Entry, lengths: &[Vec<f64>]) -> f64 {
    let direct = if a.edge == b.edge { (a.along_m - b.along_m).abs() } else { f64::INFINITY };
    let over = a.ends.iter().flat_map(|(from, out)| {
        let row = lengths.get(*from);
        b.ends
            .iter()
            .map(move |(to, into)| out + into + row.and_then(|row| row.get(*to)).copied().unwrap_or(f64::INFINITY))
    });
    a.off_m + b.off_m + over.fold(direct, f64::min)
}

fn entry(location: &Location, at: &Point) -> Option<Entry> {
    let graph = &location.graph;
    let ground = Ground::of(&location.grid);
    let mut near: Vec<(f64, usize, f64, f64, Point)> = Vec::new();
    for (number, edge) in graph.edges().iter().enumerate() {
        let points = graph.edge_points(&edge.from, &edge.to).unwrap_or_default();
        let total: f64 = points.windows(2).map(|pair| if let [a, b] = pair { (b - a).norm() } else { 0.0 }).sum();
        let mut gone = 0.0;
        for pair in points.windows(2) {
            let [a, b] = pair else { continue };
            let (off, nearest) = nearest_on_segment(at, a, b);
            if off <= ENTER_M {
                near.push((off, number, gone + (nearest - a).norm(), total, nearest));
            }
            gone += (b - a).norm();
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let seen = near.into_iter().find(|(off, .., nearest)| *off < 1e-6 || ground.sight().clear(at, nearest))?;
    let (off_m, edge, along_m, total, _) = seen;
    let known = graph.edges().get(edge)?;
    let (from, to) = (graph.position(&known.from)?, graph.position(&known.to)?);
    Some(Entry { off_m, edge, along_m, ends: [(from, along_m), (to, (total - along_m).max(0.0))] })
}

/// Lengths of the shortest ways between all nodes, m.
fn lengths(location: &Location) -> Vec<Vec<f64>> {
    let graph = &location.graph;
    let edge_m = |pair: &[NodeId]| if let [a, b] = pair { graph.edge_length_m(a, b) } else { None };
    let away = |from: &GraphNode, to: &GraphNode| {
        let way = graph.shortest(&from.id, &to.id)?;
        way.windows(2).map(edge_m).sum::<Option<f64>>()
    };
    let row = |from| graph.nodes().iter().map(|to| away(from, to).unwrap_or(f64::INFINITY)).collect();
    graph.nodes().iter().map(row).collect()
}
