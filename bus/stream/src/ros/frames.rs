//! The tree of frames of a bag (`/tf`, `/tf_static`), and the way from one frame to another at any time.

use std::collections::BTreeMap;

use super::rigid::Rigid;

/// So long before its first and after its last transform a frame is taken to stand still, ns: publishers start one after
/// another, and localization is slower than odometry.
const HOLD_NANOS: i64 = 1_000_000_000;
/// Most frames one above the other.
const DEEPEST: usize = 64;

/// The name of a frame as tf2 has it.
pub(super) fn plain(name: &str) -> &str {
    name.trim_start_matches('/')
}

/// One frame in another, over time.
#[derive(Debug, Clone, Default)]
struct Edge {
    /// Whether `/tf_static` has it, where one transform holds all the time.
    fixed: bool,
    samples: Vec<(i64, Rigid)>,
}

/// What is between two frames at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Between {
    Known(Rigid),
    /// The frame whose transform is not there at that time.
    NotThen,
}

impl Edge {
    fn at(&self, time: i64) -> Between {
        let after = self.samples.partition_point(|(stamp, _)| *stamp < time);
        let (before, next) = (after.checked_sub(1).and_then(|at| self.samples.get(at)), self.samples.get(after));
        let (first, last) = (before.or(next), next.or(before));
        let (Some((t0, a)), Some((t1, b))) = (first, last) else { return Between::NotThen };
        if t1 > t0 {
            #[expect(clippy::cast_precision_loss, reason = "a share of a span")]
            let share = time.saturating_sub(*t0) as f64 / t1.saturating_sub(*t0) as f64;
            return Between::Known(a.towards(b, share));
        }
        let held = self.fixed || self.samples.len() == 1 || time.saturating_sub(*t0).saturating_abs() <= HOLD_NANOS;
        if held { Between::Known(*a) } else { Between::NotThen }
    }
}

/// All frames. Add transforms, then [`Tree::settle`], then ask.
#[derive(Debug, Clone, Default)]
pub(super) struct Tree {
    /// By child, then by parent: two programs may name different parents.
    edges: BTreeMap<String, BTreeMap<String, Edge>>,
}

/// The way from a frame to another: children up to the frame that both stand in, and down again.
#[derive(Debug, Clone)]
pub(super) struct Way<'a> {
    up: Vec<&'a Edge>,
    down: Vec<&'a Edge>,
}

impl Way<'_> {
    /// What stands in the first frame, in the second one.
    pub(super) fn at(&self, time: i64) -> Between {
        let mut whole = Rigid::HERE;
        for edge in &self.up {
            let Between::Known(step) = edge.at(time) else { return Between::NotThen };
            whole = step.then(&whole);
        }
        let mut other = Rigid::HERE;
        for edge in &self.down {
            let Between::Known(step) = edge.at(time) else { return Between::NotThen };
            other = step.then(&other);
        }
        Between::Known(other.inverse().then(&whole))
    }

    /// Times at which something moves on this way: of the transform that comes most often.
    pub(super) fn times(&self) -> Vec<i64> {
        let moving = self.up.iter().chain(&self.down).filter(|edge| !edge.fixed);
        let most = moving.max_by_key(|edge| edge.samples.len());
        most.map_or_else(Vec::new, |edge| edge.samples.iter().map(|(time, _)| *time).collect())
    }
}

impl Tree {
    /// Takes a transform: where `child` stands in `parent`.
    pub(super) fn add(&mut self, parent: &str, child: &str, time: i64, fixed: bool, place: Rigid) {
        let edge = self.edges.entry(child.to_owned()).or_default().entry(parent.to_owned()).or_default();
        edge.fixed |= fixed;
        edge.samples.push((time, place));
    }

    /// Whether a frame stands in another.
    pub(super) fn holds(&self, child: &str) -> bool {
        self.edges.contains_key(child)
    }

    /// Puts transforms in order of their times, of several at one time the first, of several parents the one that is named
    /// most often. Gives what is to be told of it.
    pub(super) fn settle(&mut self) -> Vec<String> {
        let mut told = Vec::new();
        for (child, parents) in &mut self.edges {
            let most = parents.iter().max_by(|a, b| a.1.samples.len().cmp(&b.1.samples.len()).then(b.0.cmp(a.0)));
            let Some(kept) = most.map(|(parent, _)| parent.clone()) else { continue };
            if parents.len() > 1 {
                let names: Vec<String> = parents.keys().map(|name| format!("`{name}`")).collect();
                told.push(format!(
                    "the frame `{child}` stands in {}: `{kept}`, the most frequent, counts",
                    names.join(" and in ")
                ));
            }
            parents.retain(|parent, _| *parent == kept);
            for (parent, edge) in parents {
                edge.samples.sort_by_key(|(time, _)| *time);
                edge.samples.dedup_by_key(|(time, _)| *time);
                if edge.fixed {
                    // The newest holds, as for a latched topic.
                    edge.samples.drain(..edge.samples.len().saturating_sub(1));
                } else if edge.samples.len() == 1 {
                    told.push(format!("`{child}` in `{parent}` was sent once: taken to hold all the time"));
                }
            }
        }
        told
    }

    fn above(&self, child: &str) -> Option<(&str, &Edge)> {
        self.edges.get(child)?.iter().next().map(|(parent, edge)| (parent.as_str(), edge))
    }

    /// The frame itself and those that it stands in, the outermost last.
    pub(super) fn ancestors<'a>(&'a self, frame: &'a str) -> Vec<&'a str> {
        let mut found = vec![frame];
        let mut now = frame;
        while let Some((parent, _)) = self.above(now)
            && found.len() < DEEPEST
            && !found.contains(&parent)
        {
            found.push(parent);
            now = parent;
        }
        found
    }

    fn edges_up(&self, chain: &[&str], to: &str) -> Vec<&Edge> {
        chain.iter().take_while(|frame| **frame != to).filter_map(|frame| Some(self.above(frame)?.1)).collect()
    }

    /// The way from a frame to another; nothing where nothing connects them.
    pub(super) fn way(&self, from: &str, to: &str) -> Option<Way<'_>> {
        let (ours, theirs) = (self.ancestors(from), self.ancestors(to));
        let common = ours.iter().find(|frame| theirs.contains(frame))?;
        Some(Way { up: self.edges_up(&ours, common), down: self.edges_up(&theirs, common) })
    }

    /// A frame of this name that stands in another.
    pub(super) fn frame(&self, name: &str) -> Option<&str> {
        self.edges.get_key_value(name).map(|(frame, _)| frame.as_str())
    }

    /// Frames that stand in others and end with one of these names.
    pub(super) fn named(&self, endings: &[&str]) -> Vec<&str> {
        let last = |name: &str| name.rsplit('/').next().unwrap_or_default().to_owned();
        let mut found: Vec<(usize, &str)> = Vec::new();
        for frame in self.edges.keys() {
            if let Some(rank) = endings.iter().position(|ending| *ending == last(frame)) {
                found.push((rank, frame));
            }
        }
        found.sort_unstable();
        found.into_iter().map(|(_, frame)| frame).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: i64 = 1_000_000_000;

    fn at(x: f64, y: f64) -> Rigid {
        Rigid::shifted([x, y, 0.0])
    }

    fn tree() -> Tree {
        let mut tree = Tree::default();
        for k in 0..=10 {
            tree.add("odom", "base", k * SECOND, false, at(k as f64, 0.0));
        }
        tree.add("map", "odom", 0, true, at(10.0, 5.0));
        tree.add("base", "camera", 0, true, at(0.5, 0.0));
        tree
    }

    fn x(between: Between) -> String {
        match between {
            Between::Known(place) => format!("{:.2}", place.shift[0]),
            Between::NotThen => "not then".to_owned(),
        }
    }

    #[test]
    fn a_chain_is_followed_up_and_down_and_between_times() {
        let mut tree = tree();
        assert!(tree.settle().is_empty());
        assert_eq!(tree.ancestors("camera"), ["camera", "base", "odom", "map"]);
        assert_eq!(x(tree.way("camera", "map").unwrap().at(5 * SECOND / 2)), "13.00");
        assert_eq!(x(tree.way("map", "camera").unwrap().at(SECOND)), "-11.50");
        assert_eq!(x(tree.way("map", "map").unwrap().at(0)), "0.00");
        assert!(tree.way("camera", "world").is_none());
        assert_eq!(tree.way("camera", "map").unwrap().times().len(), 11);
        assert_eq!(tree.named(&["base_link", "base"]), ["base"]);
    }

    #[test]
    fn outside_of_its_times_a_transform_holds_for_a_second() {
        let mut tree = tree();
        tree.settle();
        let way = tree.way("base", "odom").unwrap();
        assert_eq!((x(way.at(-SECOND)), x(way.at(11 * SECOND))), ("0.00".to_owned(), "10.00".to_owned()));
        assert_eq!((x(way.at(-SECOND - 1)), x(way.at(12 * SECOND))), ("not then".to_owned(), "not then".to_owned()));
        assert_eq!(x(tree.way("camera", "base").unwrap().at(99 * SECOND)), "0.50");
    }

    #[test]
    fn what_was_sent_once_holds_and_is_told_and_so_is_a_second_parent() {
        let mut tree = tree();
        tree.add("base", "arm", 3, false, at(1.0, 0.0));
        tree.add("world", "base", 3, false, at(1.0, 0.0));
        let told = tree.settle().join("; ");
        assert!(told.contains("`arm` in `base` was sent once"), "{told}");
        assert!(told.contains("`base` stands in `odom` and in `world`: `odom`"), "{told}");
        assert_eq!(x(tree.way("arm", "base").unwrap().at(99 * SECOND)), "1.00");
    }

    #[test]
    fn frames_around_a_ring_end() {
        let mut tree = Tree::default();
        tree.add("a", "b", 0, true, at(1.0, 0.0));
        tree.add("b", "a", 0, true, at(1.0, 0.0));
        tree.settle();
        assert_eq!(tree.ancestors("a"), ["a", "b"]);
        assert!(tree.way("a", "b").is_some() && tree.way("a", "c").is_none());
    }
}
