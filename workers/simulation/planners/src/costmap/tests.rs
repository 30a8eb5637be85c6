//! Walls, lidar and inflation against what each says, cell by cell.

use socrates_model::{Cell, Point, Pose, SeenPerson};

use super::fixture::{Chance, floor, person, scan_of, sensed};
use super::*;

fn costmap(layers: Vec<LayerParams>) -> CostmapParams {
    CostmapParams { layers, ..CostmapParams::default() }
}

/// An obstacle layer that clears whatever beams pass, up to the range of the lidar.
fn seeing() -> ObstacleParams {
    ObstacleParams { inf_is_valid: true, ..ObstacleParams::default() }
}

#[test]
fn inflation_gives_each_cell_the_cost_of_its_distance_to_the_nearest_obstacle() {
    let mut chance = Chance::new(1);
    for round in 0..60 {
        let (width, height) = (5 + chance.below(40) as usize, 5 + chance.below(40) as usize);
        let mut grid = floor(width, height);
        let share = [0.01, 0.1, 0.6][round % 3];
        for cell in &mut grid.cells {
            let drawn = chance.share();
            *cell = if drawn < share {
                Cell::Occupied
            } else if drawn < share + 0.1 {
                Cell::Unknown
            } else {
                Cell::Free
            };
        }
        let inflation = InflationParams {
            inflation_radius: 0.05 + 1.2 * chance.share(),
            cost_scaling_factor: 1.0 + 9.0 * chance.share(),
            inflate_unknown: round % 2 == 0,
        };
        let radius_m = 0.4 * chance.share();
        let layers = vec![LayerParams::Static(StaticParams::default()), LayerParams::Inflation(inflation)];
        let params = CostmapParams { track_unknown_space: true, ..costmap(layers) };
        let mut layered = LayeredCostmap::new(&params, &grid, radius_m);
        layered.update(&sensed(Pose::new(0.0, 0.0, 0.0), None, &[]));
        let cells = || (0..width).flat_map(|x| (0..height).map(move |y| (x, y)));
        let occupied: Vec<_> = cells().filter(|(x, y)| grid.at(*x, height - 1 - *y) == Cell::Occupied).collect();
        for (x, y) in cells() {
            let away = |other: &(usize, usize)| {
                0.1 * ((x as f64 - other.0 as f64).powi(2) + (y as f64 - other.1 as f64).powi(2)).sqrt()
            };
            let near = occupied.iter().map(away).fold(f64::INFINITY, f64::min);
            let cost = if near == 0.0 {
                254
            } else if near > inflation.inflation_radius + 1e-9 {
                0
            } else if near <= radius_m + 1e-9 {
                253
            } else {
                (252.0 * (-inflation.cost_scaling_factor * (near - radius_m)).exp()) as u8
            };
            let unknown = grid.at(x, height - 1 - y) == Cell::Unknown;
            let least = if inflation.inflate_unknown { 1 } else { 253 };
            let expected = if unknown && cost < least { UNKNOWN } else { cost };
            assert_eq!(layered.map().cost(x, y), expected, "round {round}: cell {x}, {y}, {near} m away");
        }
    }
}

/// Random people among whom a robot walks about.
fn crowd(chance: &mut Chance) -> (Pose, Vec<SeenPerson>) {
    let mut at = |size: f64| size * chance.share();
    let pose = Pose::new(at(6.0), at(4.0), 0.0);
    let people = (1..5).map(|id| {
        let (place, way) = ((at(6.0), at(4.0)), (at(2.0) - 1.0, at(2.0) - 1.0));
        person(id, place, if id % 2 == 0 { (0.0, 0.0) } else { way }, at(6.0))
    });
    (pose, people.collect())
}

#[test]
fn an_update_of_what_changed_gives_the_map_that_writing_every_cell_gives() {
    let mut grid = floor(140, 100);
    let mut chance = Chance::new(7);
    grid.cells.iter_mut().filter(|_| chance.below(40) == 0).for_each(|cell| *cell = Cell::Occupied);
    let given = GroupSource::Given((1..3).map(|id| (socrates_model::HumanId::new(id), 1)).collect());
    let layers = vec![
        LayerParams::Static(StaticParams::default()),
        LayerParams::OraclePeople(OraclePeopleParams::default()),
        LayerParams::Inflation(InflationParams { inflation_radius: 0.4, ..InflationParams::default() }),
        LayerParams::Proxemic(ProxemicParams { keep_time: 0.0, ..ProxemicParams::default() }),
        LayerParams::UpoSocial(UpoSocialParams { keep_time: 0.0, ..UpoSocialParams::example() }),
        LayerParams::Nav2Can(Nav2CanParams { half_size: 1.0, ..Nav2CanParams::default() }),
        LayerParams::Groups(GroupsParams { source: given, keeptime: 0.0, ..GroupsParams::default() }),
    ];
    for rolling_window in [false, true] {
        let params = CostmapParams { rolling_window, width_m: 3.0, height_m: 2.0, ..costmap(layers.clone()) };
        let mut layered = LayeredCostmap::new(&params, &grid, 0.22);
        let mut poses = Vec::new();
        let mut partial = 0;
        for round in 0..60 {
            let (mut pose, people) = crowd(&mut chance);
            if let Some(last) = poses.last().filter(|_| round % 3 != 0) {
                pose = *last;
            }
            poses.push(pose);
            let seen = if round % 4 == 3 { &people[..1] } else { &people[..] };
            let sensed = Sensed { now_s: f64::from(round), ..sensed(pose, None, seen) };
            layered.update(&sensed);
            partial += usize::from(*layered.changed() != layered.map().whole());
            let mut anew = LayeredCostmap::new(&params, &grid, 0.22);
            if rolling_window {
                poses.iter().for_each(|pose| anew.follow(pose));
            }
            anew.update(&sensed);
            assert!(layered.map() == anew.map(), "rolling {rolling_window}, round {round}");
        }
        assert!(rolling_window || partial > 20, "{partial} updates wrote a part of the map");
    }
}

#[test]
fn costs_merge_as_the_rule_says() {
    for map in 0..=255_u8 {
        for layer in 0..=255_u8 {
            let kept = layer == UNKNOWN;
            assert_eq!(Merge::Overwrite.merged(map, layer), if kept { map } else { layer });
            let larger = if map == UNKNOWN { layer } else { map.max(layer) };
            assert_eq!(Merge::Max.merged(map, layer), if kept { map } else { larger });
            let larger = if map == UNKNOWN { UNKNOWN } else { map.max(layer) };
            assert_eq!(Merge::MaxWithoutUnknown.merged(map, layer), if kept { map } else { larger });
        }
    }
}

#[test]
fn a_map_turned_in_the_world_has_its_walls_where_they_are() {
    let mut grid = floor(30, 20);
    grid.origin = Pose::new(3.0, -2.0, 0.7);
    let mut chance = Chance::new(3);
    grid.cells.iter_mut().filter(|_| chance.below(8) == 0).for_each(|cell| *cell = Cell::Occupied);
    let params = costmap(vec![LayerParams::Static(StaticParams::default())]);
    let mut layered = LayeredCostmap::new(&params, &grid, 0.2);
    layered.update(&sensed(Pose::new(0.0, 0.0, 0.0), None, &[]));
    let map = layered.map();
    let mut walls = 0;
    for row in 0..map.height() {
        for column in 0..map.width() {
            let wall = grid.cell_of(&map.center(column, row)).is_some_and(|(x, y)| grid.at(x, y) == Cell::Occupied);
            assert_eq!(map.cost(column, row) == LETHAL, wall);
            walls += usize::from(wall);
        }
    }
    assert!(walls > 40, "{walls} cells of walls");
}

/// A layered map with an obstacle layer alone, 6 m x 4 m of 0.1 m, seen once.
fn after(params: ObstacleParams, scans: &[Scan]) -> LayeredCostmap {
    let mut layered = LayeredCostmap::new(&costmap(vec![LayerParams::Obstacle(params)]), &floor(60, 40), 0.22);
    for scan in scans {
        layered.update(&sensed(scan.from, Some(scan), &[]));
    }
    layered
}

#[test]
fn hits_are_marked_within_their_range_only() {
    let from = Pose::new(1.05, 2.05, 0.3);
    let discs = [(Point::new(3.05, 2.05), 0.1), (Point::new(1.05, 0.9), 0.1), (Point::new(4.5, 3.0), 0.1)];
    let scan = scan_of(from, &discs, 12.0);
    let layered = after(ObstacleParams::default(), std::slice::from_ref(&scan));
    let mut marked = vec![];
    for (beam, range) in (0_u32..).zip(&scan.ranges_m).filter(|(_, range)| **range <= 2.5) {
        let angle = from.yaw + f64::from(beam).to_radians();
        let hit = Point::new(from.x + range * angle.cos(), from.y + range * angle.sin());
        assert_eq!(layered.map().cost_at(&hit), LETHAL, "beam {beam} of {range} m");
        marked.extend(layered.map().cell(&hit));
    }
    marked.sort_unstable();
    marked.dedup();
    let all = layered.map().costs().iter().filter(|cost| **cost == LETHAL).count();
    assert_eq!(all, marked.len());
    let far = ObstacleParams { obstacle_min_range: 1.5, ..ObstacleParams::default() };
    let near = after(far, &[scan]).map().cost_at(&Point::new(1.05, 1.0));
    assert_eq!(near, FREE, "nearer than the least range");
}

#[test]
fn a_beam_clears_what_it_passes_and_a_beam_without_a_return_nothing() {
    let from = Pose::new(1.05, 2.05, 0.0);
    let body = Point::new(2.95, 2.05);
    let behind = [(Point::new(5.0, 2.05), 1.0)];
    let seen = scan_of(from, &[(body, 0.2)], 12.0);
    let ghosts = |params: ObstacleParams, later: &Scan| {
        let layered = after(params, &[seen.clone(), later.clone()]);
        layered.map().costs().iter().filter(|cost| **cost == LETHAL).count()
    };
    assert!(ghosts(ObstacleParams::default(), &seen) >= 3);
    // A wall behind returns the beams that pass where the person was.
    assert_eq!(ghosts(ObstacleParams::default(), &scan_of(from, &behind, 12.0)), 0);
    let nothing = scan_of(from, &[], 12.0);
    assert!(ghosts(ObstacleParams::default(), &nothing) >= 3, "a ghost stays where beams meet nothing");
    assert_eq!(ghosts(seeing(), &nothing), 0);
    // What is out of the range of clearing stays too.
    let short = ObstacleParams { raytrace_max_range: 1.0, ..seeing() };
    assert!(ghosts(short, &nothing) >= 3);
}

#[test]
fn the_floor_under_the_robot_is_free_and_stays_so() {
    let seen = scan_of(Pose::new(1.0, 2.0, 0.0), &[(Point::new(2.4, 2.0), 0.3)], 12.0);
    let blind = Scan { ranges_m: vec![12.0; 360], from: Pose::new(2.15, 2.0, 0.0), ..seen.clone() };
    let away = Scan { from: Pose::new(0.5, 3.5, 0.0), ..blind.clone() };
    let lethal = |layered: &LayeredCostmap| {
        let map = layered.map();
        let cells = (0..60).flat_map(|x| (0..40).map(move |y| (x, y)));
        let marked = cells.filter(|(x, y)| map.cost(*x, *y) == LETHAL);
        marked.map(|(x, y)| (map.center(x, y) - Point::new(2.15, 2.0)).norm()).collect::<Vec<f64>>()
    };
    let before = lethal(&after(ObstacleParams::default(), std::slice::from_ref(&seen)));
    assert!(before.iter().any(|away| *away < 0.22));
    let later = lethal(&after(ObstacleParams::default(), &[seen.clone(), blind.clone(), away.clone()]));
    assert!(later.iter().all(|away| *away > 0.22), "{later:?}");
    let off = ObstacleParams { footprint_clearing_enabled: false, ..ObstacleParams::default() };
    assert_eq!(lethal(&after(off, &[seen, blind, away])), before);
}

#[test]
fn an_outline_frees_the_cells_that_it_covers() {
    let footprint: Vec<Point> =
        [(0.4, 0.2), (-0.4, 0.2), (-0.4, -0.2), (0.4, -0.2)].iter().map(|(x, y)| Point::new(*x, *y)).collect();
    let params = costmap(vec![LayerParams::Obstacle(ObstacleParams::default())]);
    let mut layered = LayeredCostmap::new(&params, &floor(60, 40), 0.2);
    let discs: Vec<(Point, f64)> = (0..30).map(|n| (Point::new(1.5 + 0.1 * f64::from(n), 2.05), 0.05)).collect();
    for disc in discs {
        let scan = scan_of(Pose::new(disc.0.x, 1.0, 0.0), &[disc], 12.0);
        layered.update(&sensed(scan.from, Some(&scan), &[]));
    }
    let upright = Pose::new(3.0, 2.0, std::f64::consts::FRAC_PI_2);
    layered.update(&Sensed { footprint: &footprint, ..sensed(upright, None, &[]) });
    for column in 20..40 {
        let x = layered.map().center(column, 20).x;
        let expected = if (x - 3.0).abs() < 0.2 { FREE } else { LETHAL };
        assert_eq!(layered.map().cost(column, 20), expected, "at x = {x}");
    }
}

#[test]
fn a_rolling_window_keeps_what_was_seen_until_it_leaves_the_window() {
    let layers = vec![LayerParams::Obstacle(ObstacleParams::default())];
    let params = CostmapParams { rolling_window: true, width_m: 4.0, height_m: 4.0, ..costmap(layers) };
    let mut layered = LayeredCostmap::new(&params, &floor(200, 60), 0.22);
    let body = Point::new(3.05, 3.05);
    let scan = scan_of(Pose::new(2.0, 3.05, 0.0), &[(body, 0.2)], 12.0);
    layered.update(&sensed(scan.from, Some(&scan), &[]));
    let marked = |layered: &LayeredCostmap| layered.map().costs().iter().filter(|cost| **cost == LETHAL).count();
    let before = marked(&layered);
    assert!(before >= 3);
    for (x, kept) in [(2.5, before), (3.9, before), (5.5, 0)] {
        layered.update(&sensed(Pose::new(x, 3.9, 0.0), None, &[]));
        assert_eq!(marked(&layered), kept, "robot at x = {x}");
        let map = layered.map();
        let middle = map.center(map.width() / 2, map.height() / 2);
        assert!((middle.x - x).abs() < 0.16 && (middle.y - 3.9).abs() < 0.16, "the robot is in the middle");
        if kept > 0 {
            assert_eq!(map.cost_at(&(body - socrates_model::Vector::new(0.2, 0.0))), LETHAL, "at the same place");
        }
    }
}

#[test]
fn clearing_forgets_what_was_seen_and_keeps_the_walls() {
    let mut grid = floor(60, 40);
    grid.cells[0] = Cell::Occupied;
    let layers = vec![LayerParams::Static(StaticParams::default()), LayerParams::Obstacle(ObstacleParams::default())];
    let mut layered = LayeredCostmap::new(&costmap(layers), &grid, 0.22);
    let scan = scan_of(Pose::new(2.0, 3.0, 0.0), &[(Point::new(3.0, 3.0), 0.2)], 12.0);
    layered.update(&sensed(scan.from, Some(&scan), &[]));
    let marked = |layered: &LayeredCostmap| layered.map().costs().iter().filter(|cost| **cost == LETHAL).count();
    assert!(marked(&layered) > 3);
    layered.clear();
    layered.update(&sensed(scan.from, None, &[]));
    assert_eq!((marked(&layered), layered.map().cost(0, 39)), (1, LETHAL));
}
