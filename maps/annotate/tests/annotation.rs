//! Annotations of maps whose truth is known, and of maps on which little or nothing can be found.

#[cfg(test)]
mod annotation {
    use socrates_annotate::score::{Score, score};
    use socrates_annotate::{Annotation, Options, RemarkKind, annotate, files};
    use socrates_maps::random::{self, Kind};
    use socrates_maps::{check, parse, shipped};
    use socrates_model::{
        BuildingBrief, BuildingKind, Cell, CorridorForm, DoorKind, FaultCode, Grid, Location, PlaceClass, Point, Pose,
        RoomBrief,
    };

    /// Seeds of each kind in the gate; none was chosen for what it draws.
    const FEW: u64 = 6;

    fn found(grid: &Grid) -> Annotation {
        annotate(grid, &Options::default()).unwrap_or_else(|faults| panic!("{faults:#?}"))
    }

    /// A location with the graph and doors of an annotation of its map.
    fn redrawn(truth: &Location) -> Location {
        let made = found(&truth.grid);
        Location { graph: made.graph, doors: made.doors, warnings: Vec::new(), ..truth.clone() }
    }

    fn scored(truth: &Location) -> Score {
        let redrawn = redrawn(truth);
        let score = score(truth, &redrawn);
        assert_eq!(score.validity.parts, 1, "{}", truth.name);
        assert_eq!(score.validity.in_walls, 0, "{}", truth.name);
        assert_eq!(score.validity.blocked, 0, "{}", truth.name);
        let hard: Vec<_> = check(&redrawn).into_iter().filter(|fault| !fault.is_soft()).collect();
        assert_eq!(hard, [], "{}", truth.name);
        score
    }

    fn kinds_of(made: &Annotation) -> Vec<RemarkKind> {
        made.remarks.iter().map(|remark| remark.kind).collect()
    }

    /// A grid of free cells with walls round them, and what a function makes of each cell.
    fn drawn(width: usize, height: usize, resolution_m: f64, cell: impl Fn(usize, usize) -> Option<Cell>) -> Grid {
        let cells = (0..width * height).map(|place| {
            let (column, row) = (place % width, place / width);
            let rim = column == 0 || row == 0 || column + 1 == width || row + 1 == height;
            cell(column, row).unwrap_or(if rim { Cell::Occupied } else { Cell::Free })
        });
        Grid { width, height, resolution_m, origin: Pose::new(0.0, 0.0, 0.0), cells: cells.collect() }
    }

    /// Two rooms of 6 by 5 m with an opening of so many cells of 0.1 m between them.
    fn two_rooms(opening: usize) -> Grid {
        drawn(123, 52, 0.1, |column, row| {
            let wall = (60..62).contains(&column) && !(20..20 + opening).contains(&row);
            wall.then_some(Cell::Occupied)
        })
    }

    #[test]
    fn doors_and_ways_of_the_shipped_maps_are_found_again() {
        for (name, detour, nodes) in [("hospital", 1.11, 1.5), ("office", 1.10, 1.5), ("warehouse", 1.26, 1.7)] {
            let score = scored(&shipped::load(name).unwrap());
            assert!(score.doors.f1 >= 0.9, "{name}: {:?}", score.doors);
            assert!(score.detours.p95 <= detour, "{name}: {:?}", score.detours);
            assert_eq!(score.detours.unreached, 0, "{name}");
            let (hand, made) = (score.nodes.first as f64, score.nodes.second as f64);
            assert!(made <= nodes * hand, "{name}: {made} nodes, {hand} by hand");
            assert!(score.structural.f1 >= 0.7, "{name}: {:?}", score.structural);
        }
    }

    /// Doors of many worlds together, and what is true of each world.
    fn every_world(kind: Kind, seeds: u64) {
        let (mut truth, mut made, mut both) = (0, 0, 0);
        for seed in 0..seeds {
            let score = scored(&random::location(seed, kind).unwrap());
            (truth, made, both) = (truth + score.doors.first, made + score.doors.second, both + score.doors.matched);
        }
        let f1 = 2.0 * f64::from(u32::try_from(both).unwrap()) / f64::from(u32::try_from(truth + made).unwrap());
        assert!(f1 >= 0.95, "{kind}: {both} doors of {truth} are among {made}: F1 {f1:.3}");
    }

    #[test]
    fn doors_of_random_offices_are_found_again() {
        every_world(Kind::Office, FEW);
    }

    #[test]
    fn doors_of_random_hospitals_are_found_again() {
        every_world(Kind::Hospital, FEW);
    }

    #[test]
    fn doors_of_random_warehouses_are_found_again() {
        every_world(Kind::Warehouse, FEW);
    }

    #[test]
    fn doors_of_random_halls_are_found_again() {
        every_world(Kind::Hall, FEW);
    }

    #[test]
    fn doors_of_random_homes_are_found_again() {
        every_world(Kind::Home, FEW);
    }

    #[test]
    #[ignore = "sweep: 10 worlds of every kind"]
    fn doors_of_random_worlds_are_found_again() {
        for kind in Kind::ALL {
            every_world(kind, 10);
        }
    }

    /// A brief with rooms, elevators and a form of corridors.
    fn brief(number: usize) -> BuildingBrief {
        let kind = BuildingKind::ALL[number % 3];
        let room = |kind: &str, count: u32| RoomBrief {
            kind: kind.to_owned(),
            count,
            name: None,
            area_m2: None,
            beside: None,
            open: None,
            door_m: None,
        };
        let (rooms, elevators) = match kind {
            BuildingKind::Hospital => (vec![room("ward", 2), room("nurse station", 1)], 2),
            BuildingKind::Office => (vec![room("office", 5), room("meeting room", 1)], 1),
            BuildingKind::Home => (vec![room("bedroom", 2), room("kitchen", 1)], 0),
        };
        let form = (kind != BuildingKind::Home).then(|| CorridorForm::ALL[number / 3 % 8]);
        BuildingBrief { kind, form, corridor_m: None, door_m: None, elevators, only: false, rooms }
    }

    #[test]
    fn the_graph_of_a_building_is_found_again_on_its_map() {
        graphs((0..24).step_by(3));
    }

    #[test]
    #[ignore = "sweep: 24 buildings of every kind and form"]
    fn the_graphs_of_buildings_are_found_again_on_their_maps() {
        graphs(0..24);
    }

    /// Checks the graphs that were annotated on the maps of the buildings of these numbers, pooled, against the true ones.
    fn graphs(buildings: impl Iterator<Item = usize>) {
        let (mut sums, mut pairs) = ([(0, 0, 0); 3], (0, 0));
        for number in buildings {
            let built = random::build(&brief(number), 1).unwrap_or_else(|why| panic!("{number}: {why:?}"));
            let score = scored(&built.location);
            for (sum, row) in sums.iter_mut().zip([score.doors, score.nodes, score.edges]) {
                *sum = (sum.0 + row.first, sum.1 + row.second, sum.2 + row.matched);
            }
            pairs = (pairs.0 + score.detours.pairs, pairs.1 + score.detours.unreached);
        }
        let [doors, nodes, edges] = sums.map(|(truth, made, both)| {
            2.0 * f64::from(u32::try_from(both).unwrap()) / f64::from(u32::try_from(truth + made).unwrap())
        });
        assert!(doors >= 0.95, "doors F1 {doors:.3}");
        assert!(nodes >= 0.6 && edges >= 0.5, "nodes F1 {nodes:.3}, edges F1 {edges:.3} of {sums:?}");
        assert!(pairs.1 * 100 <= pairs.0, "{pairs:?}: ways not reached");
    }

    #[test]
    fn the_files_of_an_annotation_are_read_as_a_location_and_are_the_same_each_time() {
        let mut folder = shipped::files("office").unwrap();
        let grid = shipped::load("office").unwrap().grid;
        let made = found(&grid);
        assert_eq!(files(&made, &grid), files(&found(&grid), &grid));
        folder.extend(files(&made, &grid));
        let read = parse(&folder, "office").unwrap_or_else(|faults| panic!("{faults:#?}"));
        assert_eq!(read.warnings, Vec::<String>::new());
        assert_eq!(read.graph.edges().len(), made.graph.edges().len());
        assert_eq!(read.doors.len(), made.doors.len());
        for (node, written) in read.graph.nodes().iter().zip(made.graph.nodes()) {
            assert!(node.id == written.id && (node.at - written.at).norm() < 0.01);
        }
        assert!(made.confidence.iter().all(|sure| (0.0..=1.0).contains(sure)));
        assert_eq!(made.confidence.len(), made.graph.nodes().len());
    }

    #[test]
    fn two_rooms_are_two_rooms_with_a_doorway_between_them() {
        let made = found(&two_rooms(10));
        assert_eq!((made.counts.rooms, made.counts.doors), (2, 1), "{:?}", made.counts);
        let door = made.graph.nodes().iter().find(|node| node.kind == "DOORWAY").unwrap();
        assert!((door.at - Point::new(6.1, 2.7)).norm() < 0.1, "{}", door.at);
        // Nothing says that it has a leaf.
        assert_eq!(made.doors[0].opens, socrates_model::DoorOpens::Always);
        assert_eq!(made.doors[0].kind, DoorKind::Room);
    }

    #[test]
    fn an_opening_of_the_robots_width_is_passed_and_a_narrower_one_is_named() {
        let made = found(&two_rooms(6));
        assert_eq!((made.counts.rooms, made.graph.parts().len()), (2, 1));
        let made = found(&two_rooms(5));
        assert!(
            kinds_of(&made).iter().any(|kind| matches!(kind, RemarkKind::CutOff | RemarkKind::Gap)),
            "{:?}",
            made.remarks
        );
        assert_eq!(made.graph.parts().len(), 1);
    }

    #[test]
    fn a_wall_that_bends_at_its_door_has_a_doorway() {
        // From both jambs of an opening of 1 m the wall goes on at 23° to the opening's line.
        let bent = drawn(123, 52, 0.1, |column, row| {
            let off = if row < 20 { 20 - row } else { row.saturating_sub(29) };
            let middle = 60.0 - 0.42 * f64::from(u32::try_from(off).unwrap());
            let wall = !(20..30).contains(&row) && (f64::from(u32::try_from(column).unwrap()) - middle).abs() < 1.2;
            wall.then_some(Cell::Occupied)
        });
        let made = found(&bent);
        assert_eq!((made.counts.rooms, made.counts.doors), (2, 1), "{:?}", made.counts);
        let door = made.graph.nodes().iter().find(|node| node.kind == "DOORWAY").unwrap();
        assert!((door.at - Point::new(6.0, 2.7)).norm() < 0.25, "{}", door.at);
    }

    #[test]
    fn the_gap_between_two_outlined_crates_is_no_door_and_that_of_a_booth_is_one() {
        // Outlines of one cell of 0.05 m with gaps, as scanners see crates; 1.2 m wide, 1.0 m between them.
        let outline = |column: usize, row: usize, left: usize, top: usize, side: usize| {
            let (dx, dy) = (column.wrapping_sub(left), row.wrapping_sub(top));
            dx < side && dy < side && (dx == 0 || dy == 0 || dx + 1 == side || dy + 1 == side)
        };
        let crates = drawn(300, 200, 0.05, |column, row| {
            let wall =
                (outline(column, row, 80, 80, 24) || outline(column, row, 124, 80, 24)) && (column + row) % 5 != 0;
            wall.then_some(Cell::Occupied)
        });
        let made = found(&crates);
        assert_eq!((made.counts.doors, made.counts.rooms), (0, 0), "{:?}", made.doors);
        // A booth of 2.4 m with an opening of 0.9 m.
        let booth = drawn(300, 200, 0.05, |column, row| {
            let opening = row == 80 && (115..133).contains(&column);
            (outline(column, row, 100, 80, 48) && !opening).then_some(Cell::Occupied)
        });
        assert_eq!(found(&booth).counts.doors, 1);
    }

    #[test]
    fn several_floors_in_one_picture_are_said_and_each_is_found_by_a_point_on_it() {
        let (one, other) = (shipped::load("hospital").unwrap().grid, shipped::load("office").unwrap().grid);
        let width = one.width + other.width;
        let height = one.height.max(other.height);
        let cell = |place: usize| {
            let (column, row) = (place % width, place / width);
            if column < one.width { one.at(column, row) } else { other.at(column - one.width, row) }
        };
        let cells = (0..width * height).map(cell).collect();
        let both = Grid { width, height, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells };
        let made = found(&both);
        let remark = made.remarks.iter().find(|remark| remark.kind == RemarkKind::SeveralFloors).unwrap();
        assert!(remark.text.contains("2 floors") && remark.text.contains("--within"), "{}", remark.text);
        let keep = Options { keep: remark.at, ..Options::default() };
        let second = annotate(&both, &keep).unwrap();
        assert_ne!(second.graph, made.graph);
        for name in ["hospital", "office", "warehouse"] {
            let alone = found(&shipped::load(name).unwrap().grid);
            assert!(!kinds_of(&alone).contains(&RemarkKind::SeveralFloors), "{name}");
        }
    }

    #[test]
    fn rooms_without_doors_are_named_and_one_of_them_is_annotated() {
        let made = found(&two_rooms(0));
        assert!(kinds_of(&made).contains(&RemarkKind::CutOff), "{:?}", made.remarks);
        let keep = Some(Point::new(9.0, 2.5));
        let other = annotate(&two_rooms(0), &Options { keep, ..Options::default() }).unwrap();
        assert!(other.graph.nodes().iter().all(|node| node.at.x > 6.0));
        let outside = annotate(&two_rooms(0), &Options { keep: Some(Point::new(90.0, 2.5)), ..Options::default() });
        let faults = outside.unwrap_err();
        assert_eq!(faults[0].code, FaultCode::MValue);
        assert!(faults[0].to_string().contains("(90, 2.5)"), "{}", faults[0]);
    }

    #[test]
    fn a_polygon_bounds_what_is_looked_at() {
        let corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 5.2), (0.0, 5.2)].map(|(x, y)| Point::new(x, y));
        let made = annotate(&two_rooms(10), &Options { within: corners.to_vec(), ..Options::default() }).unwrap();
        assert!(!made.graph.nodes().is_empty() && made.graph.nodes().iter().all(|node| node.at.x < 6.0));
        for within in [corners[..2].to_vec(), corners.map(|at| at + socrates_model::Vector::new(90.0, 0.0)).to_vec()] {
            let faults = annotate(&two_rooms(10), &Options { within, ..Options::default() }).unwrap_err();
            assert!(faults[0].to_string().contains("polygon"), "{}", faults[0]);
        }
    }

    #[test]
    fn elevators_are_asked_for_and_made_when_they_are_named() {
        let hospital = shipped::load("hospital").unwrap();
        let made = found(&hospital.grid);
        let asked: Vec<Point> = made
            .remarks
            .iter()
            .filter(|remark| remark.kind == RemarkKind::Elevator)
            .filter_map(|remark| remark.at)
            .collect();
        assert_eq!((asked.len(), made.counts.elevators), (2, 0), "{:?}", made.remarks);
        let named = annotate(&hospital.grid, &Options { elevators: asked, ..Options::default() }).unwrap();
        assert_eq!(named.counts.elevators, 2);
        let doors = named.doors.iter().filter(|door| door.kind == DoorKind::Elevator);
        assert!(doors.clone().count() == 2 && doors.clone().all(|door| door.inside.len() >= 2), "{:?}", named.doors);
        let class = |wanted| named.graph.nodes().iter().any(|node| PlaceClass::of_type(&node.kind) == wanted);
        assert!(class(PlaceClass::Elevator) && class(PlaceClass::ElevatorLobby));
        let nowhere = Options { elevators: vec![Point::new(20.0, 29.2)], ..Options::default() };
        assert!(annotate(&two_rooms(0), &nowhere).unwrap_err()[0].to_string().contains("elevator"));
    }

    #[test]
    fn maps_without_floor_end_with_a_named_reason() {
        let unknown = drawn(200, 100, 0.05, |_, _| Some(Cell::Unknown));
        let speck = drawn(20, 20, 0.05, |column, row| (column != 9 || row != 9).then_some(Cell::Occupied));
        let empty = Grid { width: 0, height: 0, cells: Vec::new(), ..speck.clone() };
        let torn = Grid { width: 7, ..speck.clone() };
        for grid in [unknown, speck, empty, torn] {
            let faults = annotate(&grid, &Options::default()).unwrap_err();
            assert_eq!(faults[0].code, FaultCode::MImage, "{faults:?}");
            assert!(faults[0].to_string().contains("cells"), "{}", faults[0]);
        }
    }

    #[test]
    fn one_floor_without_doors_is_called_so() {
        let made = found(&drawn(120, 120, 0.05, |_, _| None));
        assert!(kinds_of(&made).contains(&RemarkKind::OneFloor), "{:?}", made.remarks);
        assert!(!made.graph.nodes().is_empty());
        assert!(!kinds_of(&found(&drawn(300, 120, 0.05, |_, _| None))).contains(&RemarkKind::Small));
        let small = found(&drawn(60, 50, 0.05, |_, _| None));
        assert!(kinds_of(&small).contains(&RemarkKind::Small), "{:?}", small.remarks);
    }

    #[test]
    fn scanner_dust_is_named_and_hides_no_door() {
        let office = shipped::load("office").unwrap();
        let mut noisy = office.clone();
        let mut seed = 11_u32;
        for cell in &mut noisy.grid.cells {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if *cell == Cell::Free && seed >> 22 == 0 {
                *cell = Cell::Occupied;
            }
        }
        let made = found(&noisy.grid);
        assert!(kinds_of(&made).contains(&RemarkKind::Dust), "{:?}", made.remarks);
        let redrawn = Location { graph: made.graph, doors: made.doors, ..noisy };
        let score = score(&office, &redrawn);
        assert!(score.doors.f1 >= 0.9 && score.validity.parts == 1 && score.validity.blocked == 0, "{score:?}");
    }

    #[test]
    fn noise_all_over_is_no_panic() {
        for every in [2, 3, 5, 9, 17] {
            let noise =
                drawn(150, 150, 0.05, |column, row| ((column * 7 + row * 13) % every == 0).then_some(Cell::Occupied));
            match annotate(&noise, &Options::default()) {
                Ok(made) => assert!(made.graph.parts().len() <= 1),
                Err(faults) => assert_eq!(faults[0].code, FaultCode::MImage),
            }
        }
    }

    #[test]
    fn the_turn_of_the_origin_turns_the_graph_and_nothing_else() {
        let grid = shipped::load("office").unwrap().grid;
        let turned = Grid { origin: Pose::new(-40.0, 7.0, 0.7), ..grid.clone() };
        let (one, other) = (found(&grid), found(&turned));
        assert_eq!(one.counts, other.counts);
        for (a, b) in one.graph.nodes().iter().zip(other.graph.nodes()) {
            let (a, b) = (grid.pixel_from_world(&a.at), turned.pixel_from_world(&b.at));
            assert!((a.0 - b.0).hypot(a.1 - b.1) < 1e-6);
        }
    }

    #[test]
    fn cells_of_a_centimeter_show_the_same_doors() {
        let truth = random::location(0, Kind::Home).unwrap();
        let grid = &truth.grid;
        let (width, height) = (grid.width * 10, grid.height * 10);
        let cells = (0..width * height).map(|place| grid.at(place % width / 10, place / width / 10)).collect();
        let fine = Grid { width, height, resolution_m: grid.resolution_m / 10.0, origin: grid.origin, cells };
        let made = found(&fine);
        let score = score(&truth, &Location { grid: fine, graph: made.graph, doors: made.doors, ..truth.clone() });
        assert!(score.doors.f1 >= 0.95 && score.validity.parts == 1, "{score:?}");
    }

    #[test]
    fn coarse_cells_are_named() {
        let made = found(&drawn(60, 40, 0.5, |_, _| None));
        assert!(kinds_of(&made).contains(&RemarkKind::Coarse), "{:?}", made.remarks);
    }

    #[test]
    fn a_corridor_of_20_000_pixels_is_one_way() {
        let made = found(&drawn(20_000, 42, 0.05, |_, _| None));
        assert_eq!(made.graph.parts().len(), 1);
        assert!(made.graph.nodes().len() > 200, "{}", made.graph.nodes().len());
    }

    #[test]
    fn floor_round_a_building_has_no_nodes() {
        // The building stands in free floor up to the rim of the picture, as simulators draw it.
        let building = two_rooms(10);
        let cells = (0..223 * 152).map(|place| {
            let (column, row) = (place % 223, place / 223);
            if (50..173).contains(&column) && (50..102).contains(&row) {
                building.at(column - 50, row - 50)
            } else {
                Cell::Free
            }
        });
        let grid = Grid { width: 223, height: 152, cells: cells.collect(), ..building.clone() };
        let made = found(&grid);
        assert!(kinds_of(&made).contains(&RemarkKind::Outside), "{:?}", made.remarks);
        assert_eq!(made.counts.rooms, 2);
        assert!(made.graph.nodes().iter().all(|node| node.at.x > 5.0 && node.at.x < 17.3));
    }
}
