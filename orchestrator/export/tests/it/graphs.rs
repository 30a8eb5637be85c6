//! Graphs of locations in formats of others: there and back again, and what is left behind on the way.

use std::collections::BTreeSet;

use socrates_export::{Graph, Losses, nav2_route, node_link, rmf};
use socrates_maps::{random, shipped};
use socrates_model::{AreaName, DoorOpens, GraphEdge, Location, NodeId, Point};
use socrates_tests::skip;

/// Locations of every kind: the shipped ones and one random world of each kind.
fn locations() -> Vec<Location> {
    let ours = shipped::names().iter().map(|name| shipped::load(name).unwrap());
    ours.chain(random::Kind::ALL.map(|kind| random::location(11, kind).unwrap())).collect()
}

fn whats(losses: &Losses) -> BTreeSet<&str> {
    losses.rows().iter().map(|row| row.what.as_str()).collect()
}

/// Says where a graph that came back differs from that of the location.
fn same(location: &Location, graph: &Graph, off_m: f64) {
    let name = &location.name;
    let near = |a: &Point, b: &Point| (a - b).norm() <= off_m;
    assert_eq!(graph.nodes.len(), location.graph.nodes().len(), "{name}");
    for (ours, back) in location.graph.nodes().iter().zip(&graph.nodes) {
        assert_eq!((&ours.id, &ours.kind), (&back.id, &back.kind), "{name}");
        assert!(near(&ours.at, &back.at), "{name}: {} moved from {} to {}", ours.id, ours.at, back.at);
    }
    let ends = |edge: &GraphEdge| (edge.from.clone(), edge.to.clone(), edge.kind.clone(), edge.via.len());
    let (ours, back): (Vec<_>, Vec<_>) =
        (location.graph.edges().iter().map(ends).collect(), graph.edges.iter().map(ends).collect());
    assert_eq!(ours, back, "{name}");
}

/// A location with everything: bends, names with blanks and umlauts, doors with rules.
fn whole() -> Location {
    let mut location = shipped::load("hospital").unwrap();
    location.name = "Krankenhaus Süd".to_owned();
    let node = |at: usize| location.graph.nodes()[at].id.clone();
    location.names = vec![
        AreaName { name: "Süßes Café".to_owned(), nodes: vec![node(0), node(1)] },
        AreaName { name: "pharmacy".to_owned(), nodes: vec![node(1)] },
    ];
    let middle = |edge: &GraphEdge| {
        let points = location.graph.edge_points(&edge.from, &edge.to).unwrap();
        center(&points[0], &points[1])
    };
    let bends: Vec<Point> = location.graph.edges().iter().take(2).map(middle).collect();
    location.graph = location.graph.edited(|nodes, edges| {
        nodes[0].kind = "WARTEBEREICH \"Süd\"".to_owned();
        edges[0].via = vec![bends[0]];
        edges[1].via = vec![bends[1], bends[1]];
    });
    location
}

fn center(a: &Point, b: &Point) -> Point {
    Point::new((a.x + b.x) * 0.5, (a.y + b.y) * 0.5)
}

#[test]
fn a_route_graph_of_nav2_comes_back_as_it_went() {
    for location in locations().into_iter().chain([whole()]) {
        let (text, losses) = nav2_route::write(&location);
        assert_eq!((&text, &losses), (&nav2_route::write(&location).0, &nav2_route::write(&location).1));
        let (graph, read) = nav2_route::read(&text).unwrap();
        assert_eq!(read.rows(), [], "{}", location.name);
        same(&location, &graph, 1e-6);
        assert_eq!(names(&graph.names), names(&location.names));
        let kept =
            location.doors.len() - losses.rows().iter().find(|row| row.what == "doors").map_or(0, |row| row.count);
        assert_eq!(graph.doors.len(), kept, "{}", location.name);
    }
}

/// Names with their nodes, in no order.
fn names(names: &[AreaName]) -> BTreeSet<(String, BTreeSet<NodeId>)> {
    names.iter().map(|area| (area.name.clone(), area.nodes.iter().cloned().collect())).collect()
}

#[test]
fn a_scene_graph_comes_back_as_it_went() {
    for location in locations().into_iter().chain([whole()]) {
        let (text, losses) = node_link::write(&location);
        let (graph, read) = node_link::read(&text, &location.grid).unwrap();
        assert_eq!(read.rows(), [], "{}", location.name);
        assert_eq!(whats(&losses).contains("doors"), !location.doors.is_empty());
        let straight = Location {
            graph: location.graph.edited(|_, edges| edges.iter_mut().for_each(|edge| edge.via.clear())),
            ..location.clone()
        };
        same(&straight, &graph, 1e-6);
    }
}

#[test]
fn a_building_of_rmf_comes_back_with_its_graph_doors_and_walls() {
    for location in locations().into_iter().chain([whole()]) {
        let name = &location.name;
        let (text, _) = rmf::write(&location);
        assert_eq!(text, rmf::write(&location).0);
        let building = rmf::Building::read(&text).unwrap();
        assert_eq!((building.name.as_str(), building.levels()), (name.as_str(), vec!["L1"]));
        let (floor, read) = building.level("L1").unwrap();
        assert_eq!(read.rows(), [], "{name}");
        same(&location, &floor.graph, 1e-6);
        assert_eq!(names(&floor.graph.names), names(&location.names));
        let ids =
            |doors: &[socrates_model::Door]| doors.iter().map(|door| (door.id.clone(), door.kind)).collect::<Vec<_>>();
        assert_eq!(ids(&floor.graph.doors), ids(&location.doors), "{name}");
        // Walls are drawn 0.1 m thick round the outlines: what was free is free but for 0.1 m at walls, and nothing else is.
        let (mut free, mut kept, mut more) = (0.0, 0.0, 0.0);
        for row in 0..floor.grid.height {
            for column in 0..floor.grid.width {
                let at = floor.grid.center_of(column, row);
                let (was, is) = (location.grid.is_free(&at), floor.grid.is_free(&at));
                free += f64::from(u8::from(was));
                kept += f64::from(u8::from(was && is));
                more += f64::from(u8::from(!was && is));
            }
        }
        assert!(kept / free > 0.9 && more / free < 0.002, "{name}: {:.3} kept, {:.4} more", kept / free, more / free);
    }
}

#[test]
fn each_kind_of_content_that_is_taken_away_leaves_the_list() {
    type Take = fn(&mut Location);
    let description: (&str, Take) = ("description", |location| location.description.clear());
    let rules: (&str, Take) =
        ("door rules", |location| location.doors.iter_mut().for_each(|door| door.opens = DoorOpens::Always));
    let sides: (&str, Take) =
        ("sides of doors", |location| location.doors.iter_mut().for_each(|door| door.inside.clear()));
    let lifts: (&str, Take) = ("lifts", |location| {
        location.doors.iter_mut().for_each(|door| door.kind = socrates_model::DoorKind::Room);
    });
    let doors: (&str, Take) = ("doors", |location| location.doors.clear());
    let named: (&str, Take) = ("names", |location| location.names.clear());
    let bends: (&str, Take) = ("bends of ways", |location| {
        location.graph = location.graph.edited(|_, edges| edges.iter_mut().for_each(|edge| edge.via.clear()));
    });
    type Write = fn(&Location) -> (String, Losses);
    type Row = (&'static str, Write, Vec<(&'static str, Take)>);
    let formats: [Row; 3] = [
        ("nav2-route", nav2_route::write, vec![description, rules, sides]),
        ("rmf", rmf::write, vec![description, rules, sides, lifts]),
        ("node-link", node_link::write, vec![description, doors, named, bends]),
    ];
    for (format, write, kinds) in formats {
        let mut location = whole();
        let mut left: BTreeSet<&str> = kinds.iter().map(|(what, _)| *what).collect();
        for (what, take) in kinds {
            let losses = write(&location).1;
            let found: BTreeSet<&str> = whats(&losses).into_iter().filter(|what| *what != "map").collect();
            assert_eq!(found, left, "{format}");
            take(&mut location);
            left.remove(what);
        }
        let rest = write(&location).1;
        assert_eq!(whats(&rest), BTreeSet::from(["map"]), "{format}");
        assert!(rest.json(format).contains("\"what\": \"map\""), "{}", rest.json(format));
    }
}

#[test]
fn what_the_loader_of_nav2_refuses_is_refused_with_its_place() {
    let (text, _) = nav2_route::write(&whole());
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        nav2_route::read(&text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let class = "\"class\": \"CORRIDOR\"";
    for (from, to, at, part) in [
        ("\"id\": 1,", "\"id\": 0,", "features[1].properties.id", "taken"),
        ("\"id\": 1,", "\"id\": -1,", "features[1].properties.id", "`-1`"),
        ("\"id\": 1,", "\"id\": 1.0,", "features[1].properties.id", "`1.0`"),
        (class, "\"class\": \"CORRIDOR\", \"speed_limit\": 60", "metadata.speed_limit", "integer `60`"),
        (class, "\"class\": \"CORRIDOR\", \"penalty\": null", "metadata.penalty", "null"),
        (class, "\"class\": \"CORRIDOR\", \"x\": [[1]]", "metadata.x", "array"),
        ("\"startid\": 0,", "\"startid\": 9999,", "properties.startid", "9999"),
        ("\"features\": [", "\"feature\": [", "features", "missing"),
    ] {
        let told = with(from, to);
        assert!(told.contains(at) && told.contains(part), "{told}");
    }
    let good = text.replacen(class, "\"class\": \"CORRIDOR\", \"speed_limit\": 60.0", 1);
    let losses = nav2_route::read(&good).unwrap().1;
    assert_eq!(
        losses.rows().iter().map(|row| (row.what.as_str(), row.count)).collect::<Vec<_>>(),
        [("metadata of nodes", 1)]
    );
    assert!(nav2_route::read("{").unwrap_err().to_string().starts_with("line 1"));
}

#[test]
fn what_cannot_be_a_building_is_refused_with_its_place() {
    let (text, _) = rmf::write(&whole());
    let refused = |text: &str| match rmf::Building::read(text) {
        Ok(building) => building.level("L1").unwrap_err().to_string(),
        Err(why) => why.to_string(),
    };
    assert!(refused("levels: [").starts_with("line "), "{}", refused("levels: ["));
    assert!(refused("name: x").starts_with("levels: "), "{}", refused("name: x"));
    assert!(refused(&text.replace("cartesian_meters", "wgs84")).contains("`wgs84`"));
    assert!(refused(&text.replace("L1:", "L2:")).contains("there is no `L1`"));
    let mut damaged: serde_json::Value = serde_json::to_value(yaml(&text)).unwrap();
    damaged["levels"]["L1"]["lanes"][3][0] = 100_000.into();
    assert!(
        refused(&damaged.to_string()).contains("levels.L1.lanes[3]: `100000` is no vertex"),
        "{}",
        refused(&damaged.to_string())
    );
    damaged["levels"]["L1"]["vertices"][2][1] = "a".into();
    assert!(refused(&damaged.to_string()).contains("levels.L1.vertices[2]"));
}

fn yaml(text: &str) -> serde_json::Value {
    yaml_serde::from_str(text).unwrap()
}

/// A file of others, where it is here.
#[track_caller]
fn foreign(name: &str) -> Option<String> {
    skip::shared(&format!("formats/{name}")).map(|path| std::fs::read_to_string(path).unwrap())
}

#[test]
fn nodes_of_others_get_ids_and_names_that_people_use() {
    let building = "name: b\ncoordinate_system: cartesian_meters\nlevels:\n  L1:\n    vertices: [[0, 0, 0, ''], [8, 0, 0, ''], [8, 4, 0, ''], [0, 4, 0, ''], [1, 2, 0, 'Lounge Süd'], [7, 2, 0, 'Lounge Süd', {is_charger: [4, true]}], [4, 0, 0, ''], [4, 4, 0, '']]\n    floors: [{vertices: [0, 1, 2, 3]}]\n    walls: [[0, 1, {}], [1, 2, {}], [2, 3, {}], [3, 0, {}]]\n    doors: [[6, 7, {name: [1, gate]}]]\n    lanes: [[4, 5, {bidirectional: [4, false], speed_limit: [3, 0.5]}]]\n";
    let (floor, losses) = rmf::Building::read(building).unwrap().level("L1").unwrap();
    let graph = floor.graph;
    let ids: Vec<(&str, &str)> = graph.nodes.iter().map(|node| (node.id.as_str(), node.kind.as_str())).collect();
    assert_eq!(ids, [("Lounge_Süd", "SIMPLE NODE"), ("Lounge_Süd_2", "CHARGING AREA")]);
    assert_eq!((graph.names[0].name.as_str(), graph.names[0].nodes.len()), ("Lounge Süd", 2));
    assert_eq!((graph.edges[0].kind.as_str(), graph.doors[0].id.as_str()), ("DOORWAY", "gate"));
    assert_eq!(whats(&losses), BTreeSet::from(["one-way lanes", "parameters of lanes"]));
    assert!(floor.grid.is_free(&Point::new(2.0, 1.0)) && !floor.grid.is_free(&Point::new(0.0, 1.0)));
}

#[test]
fn graphs_that_others_drew_are_read() {
    for (name, nodes, edges) in [
        ("nav2_route/aws_graph.geojson", 4, 3),
        ("nav2_route/sample_graph.geojson", 4, 3),
        ("nav2_route/turtlebot3_graph.geojson", 20, 32),
        ("nav2_route/depot_graph.geojson", 4, 3),
    ] {
        let Some(text) = foreign(name) else { return };
        let (graph, _) = nav2_route::read(&text).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert!(graph.nodes.len() >= nodes && graph.edges.len() >= edges, "{name}");
    }
    for (name, level) in
        [("rmf/office.building.yaml", "L1"), ("rmf/clinic.building.yaml", "L1"), ("rmf/clinic.building.yaml", "L2")]
    {
        let Some(text) = foreign(name) else { return };
        let (floor, _) = rmf::Building::read(&text).unwrap().level(level).unwrap_or_else(|why| panic!("{name}: {why}"));
        let graph = &floor.graph;
        assert!(graph.nodes.len() > 10 && graph.edges.len() > 9, "{name}");
        assert!(
            graph.nodes.iter().filter(|node| floor.grid.is_free(&node.at)).count() * 10 > graph.nodes.len() * 9,
            "{name} {level}"
        );
    }
}
