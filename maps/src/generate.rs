//! From a floor plan to the files of a location folder.

use std::collections::BTreeMap;

use socrates_model::geometry::nearest_on_segment;
use socrates_model::{Cell, Fault, FaultCode, Grid, Location, Point, Pose, Where};

use crate::image::gray_png;
use crate::plan::{PLAN, Plan};
use crate::read::{EXTRA, GRAPH, MAP, parse};
use crate::written;

/// Name of the image.
const IMAGE: &str = "map.png";
/// Shades as map tools write them; 205 lies between the two thresholds below.
const SHADES: [(Cell, u8); 3] = [(Cell::Free, 254), (Cell::Occupied, 0), (Cell::Unknown, 205)];

/// Makes the files of a location folder from the text of its `plan.toml`: `map.yaml`, `map.png`,
/// `scene_graph.json` and `location.toml`.
///
/// The same text gives the same bytes. The form of the plan is in `maps/README.md`.
///
/// # Errors
/// Every problem of the plan with its line, or, where the plan is well formed, every problem of the
/// location it makes (a node in a wall, a graph in two parts …).
pub fn generate(plan_toml: &str) -> Result<BTreeMap<String, Vec<u8>>, Vec<Fault>> {
    made(plan_toml).map(|(files, _)| files)
}

/// Files by name, and the location that they hold.
type Made = (BTreeMap<String, Vec<u8>>, Location);

/// The files of [`generate`] and the location that they hold.
pub(crate) fn made(plan_toml: &str) -> Result<Made, Vec<Fault>> {
    let plan = Plan::read(plan_toml)?;
    let grid = painted(&plan);
    let faults: Vec<Fault> = plan
        .nodes
        .iter()
        .filter(|node| !grid.is_free(&Point::from(rounded(&grid, node.get_ref().at))))
        .map(|node| {
            let message = format!("node `{}` at {:?} is not on free floor", node.get_ref().id, node.get_ref().at);
            Fault::new(FaultCode::MWall, Plan::line(plan_toml, node), message)
        })
        .collect();
    if !faults.is_empty() {
        return Err(faults);
    }
    let shades: Vec<u8> = grid.cells.iter().map(shade).collect();
    let image = gray_png(grid.width, grid.height, &shades).map_err(|why| {
        vec![Fault::new(FaultCode::MImage, Where::file(PLAN), format!("the image cannot be written: {why}"))]
    })?;
    let files = BTreeMap::from([
        (MAP.to_owned(), map_yaml(&grid).into_bytes()),
        (IMAGE.to_owned(), image),
        (GRAPH.to_owned(), graph_json(&plan, &grid).into_bytes()),
        (EXTRA.to_owned(), extra_toml(&plan).into_bytes()),
    ]);
    match parse(&files, "plan") {
        Ok(location) => Ok((files, location)),
        Err(faults) => {
            let moved = |fault: Fault| Fault { at: fault.at.made_from(PLAN), ..fault };
            Err(faults.into_iter().map(moved).collect())
        }
    }
}

fn shade(cell: &Cell) -> u8 {
    SHADES.iter().find(|(known, _)| known == cell).map_or(205, |(_, shade)| *shade)
}

/// Paints in a fixed order: floors with walls round them, walls, openings, blocks.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the plan's size and resolution are checked"
)]
fn painted(plan: &Plan) -> Grid {
    let resolution_m = *plan.resolution_m.get_ref();
    let cells_of = |side: f64| libm::round(side / resolution_m) as usize;
    let [wide, high] = *plan.size_m.get_ref();
    let (width, height) = (cells_of(wide), cells_of(high));
    let mut grid = Grid {
        width,
        height,
        resolution_m,
        origin: Pose::new(0.0, 0.0, 0.0),
        cells: vec![Cell::Unknown; width.saturating_mul(height)],
    };
    // Asks for every cell near a rectangle or line, by its middle and present state, whether it changes.
    let paint = |grid: &mut Grid, quad: &[f64; 4], more: f64, change: &dyn Fn(&Point, Cell) -> Option<Cell>| {
        let [x0, y0, x1, y1] = *quad;
        // One cell more on each side, so that rounding leaves none out.
        let cells = |a: f64, b: f64, most: usize| {
            let from = libm::floor((a.min(b) - more) / resolution_m) - 1.0;
            let to = libm::ceil((a.max(b) + more) / resolution_m) + 1.0;
            (from.max(0.0) as usize).min(most)..(to.max(0.0) as usize).min(most)
        };
        for up in cells(y0, y1, height) {
            let row = height - 1 - up;
            for column in cells(x0, x1, width) {
                let middle = grid.center_of(column, row);
                if let Some(cell) = grid.cells.get_mut(row * width + column)
                    && let Some(new) = change(&middle, *cell)
                {
                    *cell = new;
                }
            }
        }
    };
    let thick = plan.wall_thickness_m;
    let within = |quad: &[f64; 4], more: f64, p: &Point| {
        let [x0, y0, x1, y1] = *quad;
        p.x > x0 - more && p.x < x1 + more && p.y > y0 - more && p.y < y1 + more
    };
    for (more, cell) in [(thick, Cell::Occupied), (0.0, Cell::Free)] {
        for floor in &plan.floors {
            paint(&mut grid, floor.get_ref(), more, &|p, _| within(floor.get_ref(), more, p).then_some(cell));
        }
    }
    for wall in &plan.walls {
        let [x0, y0, x1, y1] = *wall.get_ref();
        let (from, to) = (Point::new(x0, y0), Point::new(x1, y1));
        paint(&mut grid, wall.get_ref(), thick, &|p, _| {
            (nearest_on_segment(p, &from, &to).0 <= thick * 0.5 + 1e-9).then_some(Cell::Occupied)
        });
    }
    for opening in &plan.openings {
        let [x0, y0, x1, y1] = *opening.get_ref();
        let (from, to) = (Point::new(x0, y0), Point::new(x1, y1));
        let along = to - from;
        let length = along.norm();
        paint(&mut grid, opening.get_ref(), 2.0 * thick, &|p, now| {
            let share = (p - from).dot(&along) / (length * length);
            let aside = (along.perp(&(p - from)) / length).abs();
            let cut = now == Cell::Occupied && (0.0..=1.0).contains(&share) && aside <= thick + 1e-9;
            cut.then_some(Cell::Free)
        });
    }
    for block in &plan.blocks {
        paint(&mut grid, block.get_ref(), 0.0, &|p, _| within(block.get_ref(), 0.0, p).then_some(Cell::Occupied));
    }
    grid
}

/// Whole pixels of a position, from the top left.
fn pixel(grid: &Grid, at: [f64; 2]) -> (f64, f64) {
    let (px, py) = grid.pixel_from_world(&Point::from(at));
    (libm::round(px), libm::round(py))
}

/// The position that the scene graph file can hold.
fn rounded(grid: &Grid, at: [f64; 2]) -> [f64; 2] {
    let (px, py) = pixel(grid, at);
    let point = grid.world_from_pixel(px, py);
    [point.x, point.y]
}

fn map_yaml(grid: &Grid) -> String {
    format!(
        "image: {IMAGE}\nmode: trinary\nresolution: {:?}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        grid.resolution_m
    )
}

fn graph_json(plan: &Plan, grid: &Grid) -> String {
    let nodes = plan.nodes.iter().map(toml::Spanned::get_ref);
    let nodes = nodes.map(|node| (node.id.as_str(), node.kind.as_str(), pixel(grid, node.at)));
    let links = plan.edges.iter().map(toml::Spanned::get_ref).flat_map(|edges| {
        edges.along.windows(2).filter_map(|pair| {
            let [from, to] = pair else { return None };
            Some((edges.kind.as_str(), from.as_str(), to.as_str()))
        })
    });
    written::graph_json(nodes, links, 0)
}

fn extra_toml(plan: &Plan) -> String {
    written::location_toml(&plan.description, &plan.doors, |at| format!("[{:?}, {:?}]", at.x, at.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::{DoorOpens, NodeId};

    const PLAN_TEXT: &str = r#"description = "Two \"rooms\"."
size_m = [8.0, 5.0]
resolution_m = 0.1
floors = [[0.5, 0.5, 7.5, 4.5]]
walls = [[4.0, 0.5, 4.0, 4.5]]
openings = [[4.0, 2.0, 4.0, 3.0]]
blocks = [[5.0, 3.6, 7.0, 4.2]]
nodes = [
  { id = "a", type = "ROOM", at = [2.0, 2.5] },
  { id = "b", type = "ROOM", at = [6.0, 2.5] },
]
edges = [{ type = "DOORWAY", along = ["a", "b"] }]
[[doors]]
id = "d"
kind = "room"
from = [4.0, 2.0]
to = [4.0, 3.0]
opens = { on_event = "encounter" }
hold_s = 8.0
inside = ["b"]
"#;

    #[test]
    fn a_plan_becomes_a_location_with_its_walls_doors_and_nodes() {
        let files = generate(PLAN_TEXT).unwrap();
        assert_eq!(files, generate(PLAN_TEXT).unwrap());
        let location = parse(&files, "two").unwrap();
        assert_eq!(location.description, "Two \"rooms\".");
        assert_eq!(location.warnings, Vec::<String>::new());
        let free = |x: f64, y: f64| location.grid.is_free(&Point::new(x, y));
        assert!(free(4.0, 2.5) && !free(4.0, 1.5) && !free(6.0, 4.0) && !free(0.45, 2.0) && !free(0.1, 0.1));
        let node = location.graph.node(&NodeId::new("b").unwrap()).unwrap();
        assert!((node.at - Point::new(6.0, 2.5)).norm() < 1e-9);
        assert_eq!(location.doors[0].opens, DoorOpens::OnEvent("encounter".into()));
    }

    #[test]
    fn problems_of_a_plan_are_named_with_their_line() {
        let bad = PLAN_TEXT
            .replace("at = [6.0, 2.5]", "at = [60.0, 2.5]")
            .replace("[\"a\", \"b\"]", "[\"a\", \"c\"]")
            .replace("[5.0, 3.6, 7.0, 4.2]", "[7.0, 3.6, 5.0, 4.2]");
        let faults: String = generate(&bad).unwrap_err().iter().map(|fault| format!("{fault}\n")).collect();
        for part in ["M-VALUE plan.toml:7", "M-VALUE plan.toml:10", "M-ID plan.toml:12"] {
            assert!(faults.contains(part), "{part} not in\n{faults}");
        }
        let in_wall = generate(&PLAN_TEXT.replace("at = [6.0, 2.5]", "at = [4.0, 1.0]")).unwrap_err();
        assert_eq!((in_wall[0].code, in_wall[0].at.to_string()), (FaultCode::MWall, "plan.toml:10".to_owned()));
        let closed = generate(&PLAN_TEXT.replace("openings = [[4.0, 2.0, 4.0, 3.0]]", "")).unwrap_err();
        assert!(closed.iter().any(|fault| fault.code == FaultCode::GFree), "{closed:?}");
        let huge =
            PLAN_TEXT.replace("[8.0, 5.0]", "[400.0, 400.0]").replace("resolution_m = 0.1", "resolution_m = 0.02");
        assert!(generate(&huge).unwrap_err()[0].message.to_string().contains("pixels"));
        assert!(generate("size_m = 3").unwrap_err()[0].at.to_string().starts_with("plan.toml:1"));
    }
}
