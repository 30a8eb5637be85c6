//! `G-`: paths that cannot be walked, or do not meet.

use socrates_author::offline::Offline;
use socrates_author::{Written, attempt};
use socrates_checks::check_paths;
use socrates_model::job::Stage;
use socrates_model::{Cell, Family, Point};

use super::{Examples, injected, keep, proposed, question, shipped};

pub(super) async fn examples() -> Examples {
    let mut all = injected(Stage::Paths, |kind| kind.code().family() == Family::Paths).await;
    for (request, location) in shipped() {
        let question = question(&request, &location, Stage::Paths).await;
        let proposal = proposed(&request, &location).await;
        let Ok(Written::Paths(paths)) = attempt(&Offline, &question).await.map(|made| made.written) else { continue };
        // There and back at the start of the robot's path.
        let mut looped = paths.clone();
        if let [first, second, ..] = paths.robot.as_slice() {
            looped.robot.splice(0..0, [first.clone(), second.clone()]);
        }
        keep(&mut all, check_paths(&looped, &proposal, &location));
        // A person who starts as far away as the map allows, and the robot beside the encounter.
        let mut late = paths.clone();
        for encounter in &paths.encounters {
            let graph = &location.graph;
            let ways = graph.nodes().iter().filter_map(|node| graph.shortest(&node.id, &encounter.node));
            let longest = ways.max_by(|a, b| graph.length_m(a).total_cmp(&graph.length_m(b)));
            if let (Some(way), Some(own)) = (longest, late.humans.get_mut(&encounter.human)) {
                *own = way;
            }
        }
        let met = paths.encounters.first().and_then(|first| paths.robot.iter().position(|node| *node == first.node));
        late.robot.drain(..met.unwrap_or(0).saturating_sub(1));
        keep(&mut all, check_paths(&late, &proposal, &location));
        // A wall across the robot's first way.
        let mut walled = location.clone();
        let at = |index: usize| location.graph.node(paths.robot.get(index)?).map(|node| node.at);
        if let (Some(a), Some(b)) = (at(0), at(1)) {
            let middle = Point::new(0.5 * (a.x + b.x), 0.5 * (a.y + b.y));
            if let Some((column, row)) = walled.grid.cell_of(&middle) {
                let place = row * walled.grid.width + column;
                walled.grid.cells[place] = Cell::Occupied;
            }
        }
        keep(&mut all, check_paths(&paths, &proposal, &walled));
    }
    all
}
