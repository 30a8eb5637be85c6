//! What a map offers, measured as the search measures it: whoever asks which scenarios fit a map gets the numbers of the solver.

use socrates_maps::Ground;
use socrates_model::{Location, PlaceClass};

use crate::fit;
use crate::graph::Net;

/// Shortest path of the robot that is taken where the map has no longer one, m.
pub(crate) const SHORTEST_M: f64 = socrates_model::paths::ROBOT_WAY_M;

/// Free widths of the floor at the nodes of a class that lie outside of rooms, m, in order of the nodes.
#[must_use]
pub fn widths_m(location: &Location, class: PlaceClass) -> Vec<f64> {
    let (net, ground) = (Net::new(location), Ground::of(&location.grid));
    let nodes =
        (0..net.len()).filter(|node| (class == PlaceClass::Plain || net.is(*node, class)) && !net.inside(*node));
    nodes.map(|node| fit::width_m(ground.field(), &net.at(node))).collect()
}

/// Length of the longest way of a disc of this radius outside of rooms, m, all of whose nodes lie on floor of at least this free
/// width; the first that is at least `enough_m` long ends the search.
#[must_use]
pub fn longest_way_m(location: &Location, radius_m: f64, width_m: f64, enough_m: f64) -> f64 {
    let (net, ground) = (Net::passable(location, radius_m), Ground::of(&location.grid));
    let narrow: Vec<bool> =
        (0..net.len()).map(|node| width_m > 0.0 && fit::width_m(ground.field(), &net.at(node)) < width_m).collect();
    net.longest_past(enough_m, &|node| narrow.get(node).copied().unwrap_or(false)).0
}
