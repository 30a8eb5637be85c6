//! Plans over small maps, maps of posts, and free floor.

use socrates_model::{Cell, Point, Pose};

use super::*;
use crate::costmap::fixture::{Chance, floor, sensed};
use crate::costmap::{CostmapParams, FREE, InflationParams, LayerParams, LayeredCostmap, StaticParams};

/// A map of 0.1 m cells drawn as text, the top row first: `#` an obstacle, `+` dear, `?` unknown.
fn drawn(rows: &[&str]) -> Costmap {
    let mut map = Costmap::new(rows[0].len(), rows.len(), 0.1, Point::new(0.0, 0.0), FREE);
    for (row, cells) in rows.iter().rev().enumerate() {
        for (column, cell) in cells.chars().enumerate() {
            let cost = match cell {
                '#' => 254,
                '+' => 200,
                '?' => 255,
                _ => 0,
            };
            map.set(column, row, cost);
        }
    }
    map
}

fn at(column: usize, row: usize) -> Pose {
    Pose::new(0.1 * column as f64, 0.1 * row as f64, 0.0)
}

fn length_m(path: &[Pose]) -> f64 {
    path.windows(2).map(|pair| (pair[1].point() - pair[0].point()).norm()).sum()
}

/// Places on a path whose cell is an obstacle.
fn hits(map: &Costmap, path: &[Pose]) -> Vec<Point> {
    let places = path.iter().map(Pose::point);
    places.filter(|place| cell_of(map, place).is_none_or(|(x, y)| map.cost(x, y) == LETHAL)).collect()
}

/// Posts of 0.1 m on a square floor of 0.05 m cells, inflated to 0.8 m.
pub(crate) fn posts(cells: usize, per_m2: f64, seed: u64) -> Costmap {
    let mut chance = Chance::new(seed);
    let mut grid = floor(cells, cells);
    grid.resolution_m = 0.05;
    let area = (cells as f64 * 0.05).powi(2);
    for _ in 0..(area * per_m2) as usize {
        let (column, row) = (chance.below(cells as u64 - 1) as usize, chance.below(cells as u64 - 1) as usize);
        for place in [0, 1, cells, cells + 1] {
            grid.cells[row * cells + column + place] = Cell::Occupied;
        }
    }
    let inflation = InflationParams { inflation_radius: 0.8, cost_scaling_factor: 3.0, inflate_unknown: false };
    let layers = vec![LayerParams::Static(StaticParams::default()), LayerParams::Inflation(inflation)];
    let params = CostmapParams { layers, ..CostmapParams::default() };
    let mut layered = LayeredCostmap::new(&params, &grid, 0.22);
    layered.update(&sensed(Pose::new(0.0, 0.0, 0.0), None, &[]));
    layered.map().clone()
}

#[test]
fn on_free_floor_potentials_are_those_of_the_straight_way() {
    let map = Costmap::new(420, 420, 0.05, Point::new(-3.0, 2.0), FREE);
    let mut navfn = NavFn::new(&NavFnParams::default());
    let place = |cell: f64| Pose::new(-3.0 + cell * 0.05, 2.0 + cell * 0.05, 0.0);
    navfn.plan(&map, &place(210.0), &place(418.0)).unwrap();
    // Near the source the wave is made of few cells, so it is off by more along the diagonals.
    let (mut far, mut near) = (0.0_f64, 0.0_f64);
    for row in 0..420_usize {
        for column in 0..420_usize {
            let away = ((column as f64 - 210.0).powi(2) + (row as f64 - 210.0).powi(2)).sqrt();
            if !(20.0..205.0).contains(&away) {
                continue;
            }
            let potential = f64::from(navfn.potential(column, row).unwrap());
            let off = (potential / (50.0 * away) - 1.0).abs();
            if away < 100.0 { near = near.max(off) } else { far = far.max(off) }
        }
    }
    assert!(far < 0.035 && near < 0.05, "{far} off beyond 100 cells, {near} from 20 on");
}

#[test]
fn potentials_are_hardly_above_those_of_sweeping_until_nothing_sinks() {
    let map = posts(90, 0.3, 4);
    let mut navfn = NavFn::new(&NavFnParams::default());
    let place = |cell: f64| Pose::new(cell * 0.05, cell * 0.05, 0.0);
    navfn.plan(&map, &place(20.0), &place(80.0)).unwrap();
    // Sweeps over the whole map until nothing sinks, with the update written anew.
    let cost = |x: usize, y: usize| match map.cost(x, y) {
        _ if x == 0 || y == 0 || x == 89 || y == 89 => f64::INFINITY,
        cost @ 0..=252 => (50.0 + 0.8 * f64::from(cost)).min(253.0).trunc(),
        _ => f64::INFINITY,
    };
    let mut potentials = vec![vec![1e10_f64; 90]; 90];
    potentials[20][20] = 0.0;
    loop {
        let mut sank = false;
        for (y, x) in (1..89).flat_map(|y| (1..89).map(move |x| (y, x))) {
            let across = potentials[y][x - 1].min(potentials[y][x + 1]);
            let up = potentials[y - 1][x].min(potentials[y + 1][x]);
            let (least, apart, h) = (across.min(up), (across - up).abs(), cost(x, y));
            let q = apart / h;
            let new = if apart >= h { least + h } else { least + h * (-0.2301 * q * q + 0.5307 * q + 0.7040) };
            if new < potentials[y][x] - 1e-9 {
                potentials[y][x] = new;
                sank = true;
            }
        }
        if !sank {
            break;
        }
    }
    let end = f64::from(navfn.potential(80, 80).unwrap());
    let mut compared = 0;
    for (y, x) in (0..90).flat_map(|y| (0..90).map(move |x| (y, x))).filter(|(y, x)| potentials[*y][*x] < end - 300.0) {
        let share = f64::from(navfn.potential(x, y).unwrap()) / potentials[y][x].max(1e-9);
        assert!((x, y) == (20, 20) || (0.999..1.04).contains(&share), "{x}, {y}: {share}");
        compared += 1;
    }
    assert!(compared > 2000, "{compared} cells");
}

#[test]
fn plans_over_small_maps_touch_no_obstacle_and_end_at_the_goal() {
    let open = [".........."; 10];
    let bounded = {
        let mut rows = ["#........#"; 10];
        (rows[0], rows[9]) = ("##########", "##########");
        rows
    };
    let (mut top, mut bottom) = (open, open);
    top[3..6].fill("..###.....");
    bottom[6..8].fill("..####....");
    let maze_1 = [
        "..........",
        "........#.",
        ".######.#.",
        ".#....#...",
        ".#.##.##..",
        ".#.#......",
        "...#.####.",
        ".###......",
        ".......#..",
        "..........",
    ];
    let maze_2 = [
        "..........",
        "....#.....",
        "..#.#.##..",
        "...#..#...",
        ".#...##.#.",
        ".####...#.",
        ".....#.##.",
        ".###.#....",
        "....#.....",
        "..........",
    ];
    let maps = [open, bounded, top, bottom, maze_1, maze_2];
    for (place, rows) in maps.iter().enumerate() {
        // Each sign is ten cells wide: the wave may have few rounds on a tiny map, too few for a winding way.
        let tenfold = |row: &&str| vec![row.chars().flat_map(|cell| [cell; 10]).collect::<String>(); 10];
        let rows: Vec<String> = rows.iter().flat_map(tenfold).collect();
        let map = drawn(&rows.iter().map(String::as_str).collect::<Vec<&str>>());
        for use_astar in [false, true] {
            let mut navfn = NavFn::new(&NavFnParams { use_astar, tolerance: 0.0, ..NavFnParams::default() });
            let path = navfn.plan(&map, &at(85, 15), &at(15, 85));
            let path = path.unwrap_or_else(|error| panic!("map {place}, A* {use_astar}: {error}"));
            assert_eq!(hits(&map, &path), vec![], "map {place}, A* {use_astar}");
            assert!((path.last().unwrap().point() - at(15, 85).point()).norm() < 1e-9);
            assert!((path[0].point() - at(85, 15).point()).norm() < 0.1);
            assert!(path.windows(2).all(|pair| (pair[1].point() - pair[0].point()).norm() < 0.25));
        }
    }
}

/// Whether a way of free cells, four neighbors each, leads from one cell to another inside the border.
fn connected(map: &Costmap, from: (usize, usize), to: (usize, usize)) -> bool {
    let (width, height) = (map.width(), map.height());
    let mut seen = vec![false; width * height];
    let mut open = vec![from];
    while let Some((x, y)) = open.pop() {
        if (x, y) == to {
            return true;
        }
        for (x, y) in [(x + 1, y), (x.wrapping_sub(1), y), (x, y + 1), (x, y.wrapping_sub(1))] {
            let inside = (1..width - 1).contains(&x) && (1..height - 1).contains(&y);
            if inside && map.cost(x, y) < 253 && !std::mem::replace(&mut seen[y * width + x], true) {
                open.push((x, y));
            }
        }
    }
    false
}

#[test]
fn among_posts_a_plan_fails_only_where_no_way_leads_and_a_star_is_hardly_longer() {
    let mut failed = 0;
    let mut longer = vec![];
    for seed in 0..5 {
        let map = posts(200, 0.4, seed);
        let mut chance = Chance::new(100 + seed);
        let mut navfn = NavFn::new(&NavFnParams::default());
        let mut astar = NavFn::new(&NavFnParams { use_astar: true, ..NavFnParams::default() });
        for _ in 0..20 {
            let mut cell = || (1 + chance.below(198) as usize, 1 + chance.below(198) as usize);
            let (from, to) = (cell(), cell());
            let pose = |(x, y): (usize, usize)| Pose::new(0.05 * x as f64, 0.05 * y as f64, 0.0);
            match (navfn.plan(&map, &pose(from), &pose(to)), astar.plan(&map, &pose(from), &pose(to))) {
                (Ok(path), Ok(star)) => {
                    // The first pose is the robot's own cell, which is freed.
                    assert_eq!(hits(&map, &path[1..]), vec![], "{from:?} to {to:?}");
                    assert_eq!(hits(&map, &star[1..]), vec![], "{from:?} to {to:?}");
                    if length_m(&path) > 2.0 {
                        longer.push(length_m(&star) / length_m(&path) - 1.0);
                    }
                }
                (dijkstra, star) => {
                    assert_eq!(
                        (dijkstra.err(), star.err()),
                        (Some(PlanError::NoValidPath), Some(PlanError::NoValidPath))
                    );
                    assert!(!connected(&map, from, to), "{from:?} to {to:?}, seed {seed}");
                    failed += 1;
                }
            }
        }
    }
    assert!(failed <= 10, "{failed} of 100 failed");
    let mean = longer.iter().sum::<f64>() / longer.len() as f64;
    let most = longer.iter().copied().fold(0.0, f64::max);
    assert!(mean.abs() < 0.02 && most < 0.15, "A* is longer by {mean}, at most by {most}");
}

#[test]
fn the_dearest_way_that_still_leads_through_is_taken_and_an_obstacle_never() {
    let open = drawn(&[".........", ".........", "####+####", ".........", "........."]);
    let path = NavFn::new(&NavFnParams::default()).plan(&open, &at(2, 1), &at(6, 3)).unwrap();
    assert_eq!(hits(&open, &path), vec![]);
    let shut = drawn(&[".........", ".........", "#########", ".........", "........."]);
    let mut navfn = NavFn::new(&NavFnParams { tolerance: 0.0, ..NavFnParams::default() });
    assert_eq!(navfn.plan(&shut, &at(2, 1), &at(6, 3)), Err(PlanError::NoValidPath));
}

#[test]
fn unknown_floor_is_a_way_only_where_that_is_allowed() {
    let map = drawn(&[".........", ".........", "####?####", ".........", "........."]);
    let plan = |allow_unknown| {
        let params = NavFnParams { allow_unknown, tolerance: 0.0, ..NavFnParams::default() };
        NavFn::new(&params).plan(&map, &at(2, 1), &at(6, 3)).map(|path| path.len() > 4)
    };
    assert_eq!((plan(true), plan(false)), (Ok(true), Err(PlanError::NoValidPath)));
}

#[test]
fn where_the_goal_is_an_obstacle_the_nearest_place_within_the_tolerance_is_taken() {
    let mut map = Costmap::new(60, 40, 0.1, Point::new(0.0, 0.0), FREE);
    (30..34).for_each(|column| (18..23).for_each(|row| map.set(column, row, LETHAL)));
    let goal = Pose::new(3.1, 2.0, 1.0);
    let mut navfn = NavFn::new(&NavFnParams::default());
    let path = navfn.plan(&map, &at(5, 20), &goal).unwrap();
    let end = path.last().unwrap();
    // The nearest free cell is two columns to the left.
    assert!((end.point() - Point::new(2.9, 2.0)).norm() < 1e-6, "{end:?}");
    assert!((end.yaw - 1.0).abs() < 1e-12);
    let mut exact = NavFn::new(&NavFnParams { tolerance: 0.0, ..NavFnParams::default() });
    assert_eq!(exact.plan(&map, &at(5, 20), &goal), Err(PlanError::GoalOccupied));
    let mut near = NavFn::new(&NavFnParams { tolerance: 0.1, ..NavFnParams::default() });
    assert_eq!(near.plan(&map, &at(5, 20), &goal), Err(PlanError::NoValidPath));
}

#[test]
fn errors_have_the_numbers_of_nav2() {
    let map = Costmap::new(60, 40, 0.1, Point::new(0.0, 0.0), FREE);
    let mut navfn = NavFn::new(&NavFnParams::default());
    let outside = Pose::new(-3.0, 2.0, 0.0);
    assert_eq!(navfn.plan(&map, &outside, &at(3, 3)), Err(PlanError::StartOutsideMap));
    assert_eq!(navfn.plan(&map, &at(3, 3), &outside), Err(PlanError::GoalOutsideMap));
    assert_eq!(navfn.plan(&map, &at(3, 3), &Pose::new(f64::NAN, 0.0, 0.0)), Err(PlanError::GoalOutsideMap));
    let all = [
        PlanError::StartOutsideMap,
        PlanError::GoalOutsideMap,
        PlanError::StartOccupied,
        PlanError::GoalOccupied,
        PlanError::Timeout,
        PlanError::NoValidPath,
    ];
    assert_eq!(all.map(PlanError::code), [203, 204, 205, 206, 207, 208]);
}

#[test]
fn a_robot_at_its_goal_has_a_plan_of_one_pose() {
    let map = Costmap::new(60, 40, 0.1, Point::new(0.0, 0.0), FREE);
    let goal = Pose::new(2.0, 2.0, 1.5);
    let path = NavFn::new(&NavFnParams::default()).plan(&map, &Pose::new(2.0, 2.0, 0.3), &goal).unwrap();
    assert_eq!(path, vec![goal]);
    let params = NavFnParams { use_final_approach_orientation: true, ..NavFnParams::default() };
    let path = NavFn::new(&params).plan(&map, &Pose::new(2.0, 2.0, 0.3), &goal).unwrap();
    assert_eq!(path, vec![Pose::new(2.0, 2.0, 0.3)]);
}

#[test]
fn a_robot_inside_an_obstacle_still_finds_its_way_out() {
    let map = drawn(&[".........", ".........", "...#.....", ".........", "........."]);
    let path = NavFn::new(&NavFnParams::default()).plan(&map, &at(3, 2), &at(7, 3)).unwrap();
    assert_eq!(hits(&map, &path[1..]), vec![]);
}

#[test]
fn a_plan_ends_at_the_goal_with_its_heading_and_steps_are_half_a_cell() {
    let map = Costmap::new(100, 60, 0.05, Point::new(0.0, 0.0), FREE);
    let mut navfn = NavFn::new(&NavFnParams::default());
    let goal = Pose::new(4.013, 1.522, 2.0);
    let path = navfn.plan(&map, &Pose::new(0.5, 1.0, 0.0), &goal).unwrap();
    assert_eq!(path.last(), Some(&goal));
    assert!(path.iter().rev().skip(1).all(|pose| pose.yaw == 0.0));
    let straight = (goal.point() - path[0].point()).norm();
    assert!(length_m(&path) < 1.03 * straight, "{} m for {straight} m", length_m(&path));
    let steps = (path.len() as f64 - 1.0) * 0.025;
    assert!((steps / length_m(&path) - 1.0).abs() < 0.1, "{} poses", path.len());
    let params = NavFnParams { use_final_approach_orientation: true, ..NavFnParams::default() };
    let facing = NavFn::new(&params).plan(&map, &Pose::new(0.5, 1.0, 0.0), &goal).unwrap();
    let [.., before, last] = facing.as_slice() else { panic!("a path of one pose") };
    assert!((last.yaw - (last.y - before.y).atan2(last.x - before.x)).abs() < 1e-12);
}

#[test]
fn a_planner_used_again_plans_as_a_new_one_does() {
    let mut used = NavFn::new(&NavFnParams::default());
    for seed in 0..4 {
        let map = posts(120 + 20 * (seed as usize % 2), 0.3, seed);
        let (from, to) = (Pose::new(0.5, 0.5, 0.0), Pose::new(5.4, 5.2, 0.0));
        let mut new = NavFn::new(&NavFnParams::default());
        assert_eq!(used.plan(&map, &from, &to), new.plan(&map, &from, &to));
    }
}

#[test]
fn the_border_of_a_map_is_an_obstacle() {
    let mut navfn = NavFn::new(&NavFnParams::default());
    let map = Costmap::new(30, 20, 0.1, Point::new(0.0, 0.0), FREE);
    navfn.plan(&map, &at(5, 5), &at(25, 15)).unwrap();
    for place in (0..30).chain((0..20).map(|row| row * 30)).chain((0..20).map(|row| row * 30 + 29)) {
        assert!(navfn.wave.at(place) >= wave::UNREACHED);
    }
}
