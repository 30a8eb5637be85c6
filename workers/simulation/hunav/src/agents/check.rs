//! What only a map can tell about an agents file.

use socrates_maps::DistanceField;
use socrates_model::{Grid, Point};

use super::file::AgentsFile;
use crate::problem::Problem;

/// Starts and goals against a map: in walls, in unknown space, or off the map is an error; closer to a wall than the
/// radius of the body, or two starts on one spot, a warning. `file` is the name of the agents file in messages.
#[must_use]
pub fn check_on_map(agents: &AgentsFile, grid: &Grid, field: &DistanceField, file: &str) -> Vec<Problem> {
    let mut problems = Vec::new();
    for agent in &agents.agents {
        let place = format!("{}.init_pose", agent.name);
        problems.extend(spot(&agent.start_point(), agent.radius_m, grid, field, (file, &place, "the start")));
        let mut seen: Vec<&str> = Vec::new();
        for goal in &agent.goals {
            if seen.contains(&goal.name.as_str()) {
                continue;
            }
            seen.push(&goal.name);
            let place = format!("{}.{}", agent.name, goal.name);
            problems.extend(spot(&goal.at, agent.radius_m, grid, field, (file, &place, "the goal")));
        }
    }
    for (number, agent) in agents.agents.iter().enumerate() {
        for other in agents.agents.iter().take(number) {
            let apart = (agent.start_point() - other.start_point()).norm();
            let touching = agent.radius_m + other.radius_m;
            if apart < touching {
                let message = format!("the start overlaps that of `{}`: {apart:.2} m apart", other.name);
                problems.push(
                    Problem::warning(file, format!("{}.init_pose", agent.name), message)
                        .with_hint(format!("bodies that do not touch are {touching:.2} m apart")),
                );
            }
        }
    }
    problems
}

fn spot(
    point: &Point,
    radius_m: f64,
    grid: &Grid,
    field: &DistanceField,
    (file, place, what): (&str, &str, &str),
) -> Option<Problem> {
    let value = format!("{:.3}, {:.3}", point.x, point.y);
    if !grid.is_free(point) {
        let where_it_is = if grid.cell_of(point).is_some() { "in a wall or in unknown space" } else { "off the map" };
        let hint = match socrates_maps::nearest_free(field, point, radius_m, 5.0) {
            Some(free) => format!("the nearest free spot is {:.2}, {:.2}", free.x, free.y),
            None => "there is no free spot within 5 m; is it the right map?".to_owned(),
        };
        let message = format!("{what} lies {where_it_is}");
        return Some(Problem::error(file, place, message).with_value(value).with_hint(hint));
    }
    let clearance = field.clearance(point);
    (clearance < radius_m).then(|| {
        let message = format!("{what} is {clearance:.2} m from a wall, nearer than the radius of the body");
        Problem::warning(file, place, message).with_value(value).with_hint(format!("the radius is {radius_m:?} m"))
    })
}
