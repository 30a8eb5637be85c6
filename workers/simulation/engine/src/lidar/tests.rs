//! Scans over shapes, and over floors against the walk over cells.

use socrates_model::{Cell, Grid};

use super::*;
use crate::fixture;

/// Distance along a ray (unit heading) to a disc, m.
fn ray_disc(from: &Point, heading: &Vector, center: &Point, radius_m: f64) -> Option<f64> {
    let to = center - from;
    let along = to.dot(heading);
    let aside2 = to.norm_squared() - along * along;
    let inside = radius_m * radius_m - aside2;
    (inside >= 0.0 && along > 0.0).then(|| (along - inside.sqrt()).max(0.0))
}

#[test]
fn the_rough_bearing_is_within_its_slack() {
    for step in 0..3600_u32 {
        let angle = -PI + f64::from(step) * TAU / 3600.0 + 1e-6;
        let found = bearing(&Vector::new(libm::cos(angle), libm::sin(angle)));
        assert!((found - angle).abs() < 0.005, "{angle}: {found}");
    }
}

#[test]
fn a_person_ahead_shortens_the_beams_that_meet_it() {
    let discs = [Disc { center: Point::new(5.0, 1.0), radius_m: 0.5 }];
    let ranges = scan_shapes(&Pose::new(1.0, 1.0, 0.0), &discs, &[], 12.0).unwrap();
    assert!((ranges[0] - 3.5).abs() < 1e-12);
    // asin(0.5 / 4) is 7.18 degrees.
    assert_eq!(ranges.iter().filter(|range| **range < 12.0).count(), 15);
    assert!(ranges[7] < 12.0 && ranges[353] < 12.0 && (ranges[8] - 12.0).abs() < 1e-12);
}

#[test]
fn the_floor_and_its_closed_doors_and_people_are_one_scan() {
    let mut floor = Floor::new(&fixture::hall(20.0, 10.0));
    let from = Pose::new(5.0, 5.0, std::f64::consts::FRAC_PI_2);
    let open = scan(&floor, &from, &[], 12.0);
    assert!((open[0] - 4.9).abs() < 1e-9 && (open[270] - 12.0).abs() < 1e-9 && (open[90] - 4.9).abs() < 1e-9);
    floor.close(vec![(Point::new(8.0, 4.0), Point::new(8.0, 6.0))]);
    let people = [
        Disc { center: Point::new(5.0, 7.0), radius_m: 0.3 },
        Disc { center: Point::new(f64::NAN, 7.0), radius_m: 0.3 },
    ];
    let shut = scan(&floor, &from, &people, 12.0);
    assert!((shut[270] - 3.0).abs() < 1e-9 && (shut[0] - 1.7).abs() < 1e-9 && (shut[90] - 4.9).abs() < 1e-9);
    // Beam by beam the same as one ray at a time.
    for (beam, range) in shut.iter().enumerate() {
        let angle = from.yaw + (beam as f64).to_radians();
        let wall = floor.ray_m(&from.point(), angle, 12.0);
        let heading = Vector::new(libm::cos(angle), libm::sin(angle));
        let body = ray_disc(&from.point(), &heading, &people[0].center, 0.3);
        assert!((range - body.unwrap_or(12.0).min(wall)).abs() < 1e-9, "beam {beam}: {range}");
    }
}

#[test]
fn a_scene_with_a_number_that_is_none_is_refused_with_its_place() {
    let (here, nan) = (Pose::new(0.0, 0.0, 0.0), f64::NAN);
    let disc = |x: f64, radius_m: f64| Disc { center: Point::new(x, 0.0), radius_m };
    let line = (Point::new(1.0, 0.0), Point::new(nan, 0.0));
    let refused = [
        (scan_shapes(&Pose::new(nan, 0.0, 0.0), &[], &[], 12.0), "scanner stands at `NaN"),
        (scan_shapes(&here, &[], &[], nan), "range is `NaN` m"),
        (scan_shapes(&here, &[], &[], -1.0), "range is `-1` m"),
        (scan_shapes(&here, &[disc(1.0, 0.3), disc(nan, 0.3)], &[], 12.0), "disc 1 is at `NaN"),
        (scan_shapes(&here, &[disc(1.0, -0.3)], &[], 12.0), "radius `-0.3` m"),
        (scan_shapes(&here, &[], &[line], 12.0), "segment 0 goes"),
    ];
    for (found, wanted) in refused {
        let message = found.unwrap_err().to_string();
        assert!(message.contains(wanted), "{message}");
    }
}

/// What every beam reads when it walks over the cells by itself.
fn walked(floor: &Floor, frame: &Frame, max_m: f64) -> [f64; BEAMS] {
    let (at, steps) = (floor.cells().position(&frame.origin), frame.steps(floor.cells()));
    std::array::from_fn(|beam| floor.cells().ray(at, (steps.right[beam], steps.down[beam]), max_m))
}

/// Compares both for the same scanner, to the last bit; whether the edges were asked.
fn compare(floor: &Floor, from: &Pose, max_m: f64) -> bool {
    let frame = Frame::new(from);
    let (edges, walk) = (wall_ranges(floor, &frame, max_m), walked(floor, &frame, max_m));
    for (beam, (edge, walk)) in edges.iter().zip(&walk).enumerate() {
        assert_eq!(edge.to_bits(), walk.to_bits(), "beam {beam} from {from:?}: {edge} but {walk}");
    }
    let ahead = floor.cells().direction(&Vector::new(frame.cos, frame.sin));
    let reach = max_m * libm::hypot(ahead.0, ahead.1);
    floor.walls().serves(&Eye { at: floor.cells().position(&frame.origin), turn: ahead, reach })
}

/// Chances from 0 to 1.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, most: usize) -> usize {
        ((self.roll() * most as f64) as usize).min(most - 1)
    }
}

/// A map of single cells, blocks, thin walls and diagonals; some reach the border of the map, some cells are unknown.
fn random_map(dice: &mut Dice, density: f64) -> Grid {
    let (width, height) = (60 + dice.below(240), 40 + dice.below(200));
    let mut grid = Grid {
        width,
        height,
        resolution_m: [0.05, 0.1, 0.037][dice.below(3)],
        origin: Pose::new(-2.0, 3.0, if dice.below(3) == 0 { 0.0 } else { dice.roll() * 6.0 }),
        cells: vec![Cell::Free; width * height],
    };
    let mut block = |column: usize, row: usize, cell: Cell| {
        if column < width && row < height {
            grid.cells[row * width + column] = cell;
        }
    };
    for _ in 0..(width as f64 * height as f64 * density) as usize {
        block(dice.below(width), dice.below(height), Cell::Occupied);
    }
    for _ in 0..12 {
        let (column, row, across, down) =
            (dice.below(width), dice.below(height), 1 + dice.below(30), 1 + dice.below(30));
        match dice.below(4) {
            0 => (0..across).for_each(|step| block(column + step, row, Cell::Occupied)),
            1 => (0..down).for_each(|step| block(column, row + step, Cell::Unknown)),
            2 => (0..across).for_each(|step| block(column + step, row + step, Cell::Occupied)),
            _ => (0..across * down).for_each(|k| block(column + k % across, row + k / across, Cell::Occupied)),
        }
    }
    grid
}

#[test]
fn edges_say_what_the_walk_over_cells_says_on_random_maps() {
    let mut dice = Dice(7);
    let mut by_edges = 0;
    for density in [0.0, 0.0, 0.001, 0.004, 0.02, 0.15] {
        for _ in 0..6 {
            let grid = random_map(&mut dice, density);
            let floor = Floor::new(&grid);
            for _ in 0..40 {
                // Some of them in walls, some beyond the border.
                let place = |size: usize, share: f64| size as f64 * (1.1 * share - 0.05);
                let at = grid.world_from_pixel(place(grid.width, dice.roll()), place(grid.height, dice.roll()));
                let from = Pose::new(at.x, at.y, dice.roll() * 7.0 - 3.5);
                by_edges += usize::from(compare(&floor, &from, [12.0, 3.0, 0.4, 60.0][dice.below(4)]));
            }
        }
    }
    assert!(by_edges > 900, "{by_edges}");
}

#[test]
fn edges_say_what_the_walk_says_on_lines_and_corners_of_cells_and_along_the_axes() {
    let mut dice = Dice(11);
    for turn in [0.0, std::f64::consts::FRAC_PI_2, 0.6] {
        let mut grid = random_map(&mut dice, 0.002);
        grid.origin = Pose::new(0.0, 0.0, turn);
        grid.resolution_m = 0.125;
        let floor = Floor::new(&grid);
        let whole = |dice: &mut Dice, size: usize| dice.below(size + 1) as f64;
        for _ in 0..60 {
            let (column, row) = (whole(&mut dice, grid.width), whole(&mut dice, grid.height));
            let hair = [0.0, 1e-15, -1e-12, 1e-9, -1e-7, 1e-6, -1e-5, 1e-3][dice.below(8)];
            // On a corner, on a line, in the middle, a hair beside each.
            for (x, y) in [(0.0, 0.0), (0.0, 0.31), (0.27, 0.0), (0.5, 0.5), (1.0, 0.5)] {
                let at = grid.world_from_pixel(column + x + hair, row + y - hair);
                for yaw in [turn, turn + std::f64::consts::FRAC_PI_4, turn + 0.3] {
                    compare(&floor, &Pose::new(at.x, at.y, yaw), 12.0);
                }
            }
        }
        for bad in [f64::NAN, f64::INFINITY] {
            compare(&floor, &Pose::new(bad, 1.0, 0.0), 12.0);
            compare(&floor, &Pose::new(1.0, 1.3, bad), 12.0);
            compare(&floor, &Pose::new(2.03, 1.3, 0.2), bad);
        }
        for range in [0.0, -1.0, 1e-9, 1e9] {
            compare(&floor, &Pose::new(2.03, 1.3, 0.2), range);
        }
    }
}

#[test]
fn scans_of_the_shipped_maps_with_doors_and_people_are_those_of_single_beams() {
    let mut dice = Dice(3);
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).unwrap();
        let mut floor = Floor::new(&location.grid);
        floor.close(location.doors.iter().map(|door| (door.from, door.to)).collect());
        let nodes: Vec<Point> = location.graph.nodes().iter().map(|node| node.at).collect();
        let people: Vec<Disc> = nodes.iter().map(|at| Disc { center: *at, radius_m: 0.28 }).collect();
        let mut by_edges = 0;
        for call in 0..300 {
            let at = nodes[call % nodes.len()];
            let (x, y) = (at.x + 3.0 * dice.roll() - 1.5, at.y + 3.0 * dice.roll() - 1.5);
            let from = Pose::new(x, y, 7.0 * dice.roll());
            by_edges += usize::from(compare(&floor, &from, 12.0));
            let walls = walked(&floor, &Frame::new(&from), 12.0);
            let shapes = scan_shapes(&from, &people, floor.closed(), 12.0).unwrap();
            for (beam, range) in scan(&floor, &from, &people, 12.0).iter().enumerate() {
                assert_eq!(
                    range.to_bits(),
                    walls[beam].min(shapes[beam]).to_bits(),
                    "{name} beam {beam} from {from:?}"
                );
            }
        }
        assert!(by_edges > 290, "{name}: {by_edges}");
    }
}
