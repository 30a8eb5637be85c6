//! Maps and requests between which there are no ways: said with place, number and hint before anything is simulated.

use std::path::Path;

use serde_json::Value;

use crate::{make, socrates};

/// A corridor of 29 m by 2 m with a loading dock at its one end, a packing area at the other, and a store of 1.2 m by 1.4 m behind a
/// door in the middle. `{…}` are filled in.
const PLAN: &str = r#"
description = "A corridor with a store."
size_m = [30.0, 6.0]
resolution_m = 0.05
floors = [[0.5, 1.0, 29.5, 3.0]{floors}]
openings = [{openings}]
blocks = [{blocks}]
nodes = [
  { id = "dock", type = "LOADING DOCK", at = [1.5, 2.0] },
  { id = "c1", type = "CORRIDOR", at = [5.5, 2.0] },
  { id = "c2", type = "CORRIDOR", at = [9.5, 2.0] },
  { id = "c3", type = "CORRIDOR", at = [13.5, 2.0] },
  { id = "c4", type = "CORRIDOR", at = [17.5, 2.0] },
  { id = "c5", type = "CORRIDOR", at = [21.5, 2.0] },
  { id = "c6", type = "CORRIDOR", at = [25.0, 2.0] },
  { id = "pack", type = "PACKING AREA", at = [28.5, 2.0] },
{nodes}]
edges = [
  { type = "CORRIDOR", along = ["dock", "c1", "c2", "c3", "c4", "c5", "c6", "pack"] },
{edges}]
{doors}
"#;

/// What makes a plan of [`PLAN`].
#[derive(Clone, Copy, Default)]
struct Parts {
    floors: &'static str,
    openings: &'static str,
    blocks: &'static str,
    nodes: &'static str,
    edges: &'static str,
    doors: &'static str,
}

impl Parts {
    fn plan(&self) -> String {
        let fields = [
            ("{floors}", self.floors),
            ("{openings}", self.openings),
            ("{blocks}", self.blocks),
            ("{nodes}", self.nodes),
            ("{edges}", self.edges),
            ("{doors}", self.doors),
        ];
        fields.into_iter().fold(PLAN.to_owned(), |plan, (field, text)| plan.replace(field, text))
    }
}

/// The store of the plan, with a door that opens when somebody is near.
const STORE: Parts = Parts {
    floors: ", [13.0, 3.2, 14.2, 4.6]",
    openings: "[13.1, 3.1, 14.1, 3.1]",
    blocks: "",
    nodes: "  { id = \"in\", type = \"STORAGE ROOM\", at = [13.6, 4.0] },\n",
    edges: "  { type = \"DOORWAY\", along = [\"c3\", \"in\"] },\n",
    doors: "[[doors]]\nid = \"store\"\nkind = \"room\"\nfrom = [13.1, 3.1]\nto = [14.1, 3.1]\nopens = { near = 1.0 }\ninside = [\"in\"]\n",
};

/// The same with a door that never opens.
const SHUT: Parts = Parts {
    doors: "[[doors]]\nid = \"store\"\nkind = \"room\"\nfrom = [13.1, 3.1]\nto = [14.1, 3.1]\nopens = \"never\"\ninside = [\"in\"]\n",
    ..STORE
};

/// A bay in place of the store: as wide as the hall it opens into.
const BAY: Parts = Parts { floors: ", [10.0, 2.9, 17.0, 5.0]", openings: "", doors: "", ..STORE };

/// What becomes of the scene graph.
type Edit = fn(&mut Value);

const fn as_it_is(_: &mut Value) {}

fn links(graph: &mut Value) -> &mut Vec<Value> {
    let list = if graph.get("links").is_some() { "links" } else { "edges" };
    graph[list].as_array_mut().unwrap()
}

/// The corridor falls apart between `c3` and `c4`.
fn parted(graph: &mut Value) {
    links(graph).retain(|link| !(link["source"] == "c3" && link["target"] == "c4"));
}

/// `c4` stands in the wall below the corridor.
fn walled(graph: &mut Value) {
    let nodes = graph["nodes"].as_array_mut().unwrap();
    let height_px = 6.0 / 0.05;
    nodes.iter_mut().find(|node| node["id"] == "c4").unwrap()["pos"][1] = (height_px - 0.9 / 0.05).into();
}

/// One node is left.
fn alone(graph: &mut Value) {
    graph["nodes"].as_array_mut().unwrap().retain(|node| node["id"] == "c1");
    links(graph).clear();
}

/// Makes the location folder `name`.
fn location(folder: &Path, name: &str, plan: &str, edit: Edit) {
    std::fs::write(folder.join(format!("{name}.plan.toml")), plan).unwrap();
    let made = socrates(folder, name, &["map", "generate", &format!("{name}.plan.toml"), "-o", name]);
    assert_eq!(made.code, 0, "{name}: {}", made.err);
    let file = folder.join(name).join("scene_graph.json");
    let mut graph: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    edit(&mut graph);
    std::fs::write(file, graph.to_string()).unwrap();
}

/// A request on a location of the same name.
fn request(name: &str, task: &str, rough: &str, model: &str) -> String {
    format!(
        "location = {name:?}\nsocial_context = \"A store\"\ntask = {task:?}\nrough_scenario = {rough:?}\n\n[robot]\nmodel = {model:?}\n"
    )
}

/// One row of the table.
struct Case {
    name: &'static str,
    parts: Parts,
    edit: Edit,
    task: &'static str,
    rough: &'static str,
    model: &'static str,
    /// Words of the message.
    words: &'static [&'static str],
}

const ACROSS: &str = "Carry a box from the loading dock to the packing area";
const MEETS: &str = "A worker comes towards the robot in the corridor.";
const PLAIN: Case = Case {
    name: "plain",
    parts: Parts { floors: "", openings: "", blocks: "", nodes: "", edges: "", doors: "" },
    edit: as_it_is,
    task: ACROSS,
    rough: MEETS,
    model: "linorobot2",
    words: &[],
};

/// What cannot be, and what the message has to name.
const CASES: &[Case] = &[
    Case {
        name: "one-place",
        task: "Carry a box from the loading dock to the loading dock",
        words: &["E-CANNOT", "start and goal are one place, `dock` at (1.50, 2.00)", "name another goal"],
        ..PLAIN
    },
    Case { name: "islands", edit: parted, words: &["M-PARTS", "2 parts", "c4", "join them"], ..PLAIN },
    Case { name: "wall", edit: walled, words: &["M-WALL", "node `c4`", "in a wall at (17.50, 0.90)"], ..PLAIN },
    Case {
        name: "narrow",
        parts: Parts { blocks: "[15.0, 1.0, 16.0, 1.75], [15.0, 2.25, 16.0, 3.0]", ..PLAIN.parts },
        model: "jackal",
        words: &["E-CANNOT", "needs 0.60 m", "has 0.5", "between `c3` and `c4`", "at (15.", "smaller robot"],
        ..PLAIN
    },
    Case {
        name: "narrow-everywhere",
        parts: Parts {
            blocks: "[3.0, 1.0, 4.0, 1.75], [3.0, 2.25, 4.0, 3.0], [7.0, 1.0, 8.0, 1.75], [7.0, 2.25, 8.0, 3.0], \
                     [11.0, 1.0, 12.0, 1.75], [11.0, 2.25, 12.0, 3.0], [15.0, 1.0, 16.0, 1.75], [15.0, 2.25, 16.0, 3.0], \
                     [19.0, 1.0, 20.0, 1.75], [19.0, 2.25, 20.0, 3.0], [23.0, 1.0, 24.0, 1.75], [23.0, 2.25, 24.0, 3.0]",
            ..PLAIN.parts
        },
        task: "Drive around",
        model: "jackal",
        words: &["E-CANNOT", "needs 0.60 m", "has 0.5", "smaller robot"],
        ..PLAIN
    },
    Case {
        name: "never",
        parts: Parts {
            blocks: "[15.0, 1.0, 15.2, 1.5], [15.0, 2.5, 15.2, 3.0]",
            doors: "[[doors]]\nid = \"gate\"\nkind = \"room\"\nfrom = [15.1, 1.5]\nto = [15.1, 2.5]\nopens = \"never\"\n",
            ..PLAIN.parts
        },
        words: &["E-CANNOT", "door `gate` at (15.10, 2.00)", "from `dock` to `pack`", "never opens"],
        ..PLAIN
    },
    Case {
        name: "locked",
        parts: SHUT,
        rough: "A worker comes out of the storage room.",
        words: &["E-CANNOT", "door `store` at (13.60, 3.10)", "from `in` to `c3`", "never opens"],
        ..PLAIN
    },
    Case {
        name: "locked-goal",
        parts: SHUT,
        task: "Carry a box from the loading dock into the storage room",
        words: &["E-CANNOT", "door `store` at (13.60, 3.10)", "from `dock` to `in`", "never opens"],
        ..PLAIN
    },
    Case {
        name: "bay",
        parts: BAY,
        rough: "A worker comes out of the storage room.",
        words: &["P-PLACE", "place inside", "not inside: `in` at (13.60, 4.00)", "no walls bound"],
        ..PLAIN
    },
    Case {
        name: "closet",
        parts: STORE,
        rough: "Ten workers come out of the storage room.",
        words: &["E-CANNOT", "10 at `in` need 5.0 m²", "there are 1.", "ask for fewer"],
        ..PLAIN
    },
    Case {
        name: "one-node",
        edit: alone,
        task: "Drive around",
        words: &["M-ID", "1 nodes and 0 edges", "an edge between"],
        ..PLAIN
    },
];

#[test]
fn what_has_no_ways_is_refused_with_place_and_number_before_a_process_is_started() {
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for case in CASES {
        location(folder.path(), case.name, &case.parts.plan(), case.edit);
        let text = request(case.name, case.task, case.rough, case.model);
        std::fs::write(folder.path().join(format!("{}.toml", case.name)), text).unwrap();
        let args = ["run", &format!("{}.toml", case.name), "--out", &format!("out-{}", case.name)];
        let finished = socrates(folder.path(), &format!("{}-run", case.name), &args);
        let missing: Vec<&&str> =
            case.words.iter().chain(&["hint:"]).filter(|word| !finished.err.contains(**word)).collect();
        // No work folder: no process was started, of simulation or of anything else.
        let begun = folder.path().join(format!("out-{}", case.name)).exists();
        if finished.code != 2 || !missing.is_empty() || begun || finished.err.contains("panicked") {
            let code = finished.code;
            wrong.push(format!("{}: code {code}, missing {missing:?}, begun {begun}\n{}", case.name, finished.err));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_plain_corridor_and_its_store_are_played() {
    let folder = tempfile::tempdir().unwrap();
    location(folder.path(), "store", &STORE.plan(), as_it_is);
    for (name, rough) in [("meets", MEETS), ("comes-out", "A worker comes out of the storage room.")] {
        let (finished, json) = make(folder.path(), name, &request("store", ACROSS, rough, "linorobot2"), &[]);
        let verdict = json["verdict"].as_str().unwrap_or_default();
        assert!(verdict.starts_with("realised"), "{name}: {}\n{}", finished.err, finished.out);
    }
}

#[test]
fn a_graph_of_two_thousand_nodes_is_played_and_what_it_lacks_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let id = |row: usize, column: usize| format!("n{row}x{column}");
    let nodes: Vec<String> = (0..40)
        .flat_map(|row| (0..50).map(move |column| (row, column)))
        .map(|(row, column)| {
            format!("{{ id = {:?}, type = \"OPEN AREA\", at = [{column}.8, {row}.8] }}", id(row, column))
        })
        .collect();
    let along = |ids: Vec<String>| format!("{{ type = \"PASSAGEWAY\", along = {ids:?} }}");
    let rows = (0..40).map(|row| along((0..50).map(|column| id(row, column)).collect()));
    let columns = (0..50).map(|column| along((0..40).map(|row| id(row, column)).collect()));
    let plan = format!(
        "description = \"A large hall.\"\nsize_m = [51.0, 41.0]\nresolution_m = 0.1\nfloors = [[0.3, 0.3, 50.7, 40.7]]\nnodes = [{}]\nedges = [{}]\n",
        nodes.join(",\n"),
        rows.chain(columns).collect::<Vec<_>>().join(",\n")
    );
    location(folder.path(), "large", &plan, as_it_is);
    let large = |rough: &str| request("large", "Drive around", rough, "linorobot2");
    let played = large("A visitor comes towards the robot in the open area.");
    let (finished, json) = make(folder.path(), "played", &played, &[]);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let (finished, _) = make(folder.path(), "lacks", &large("Two people get out of the elevator."), &[]);
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(finished.err.contains("P-PLACE") && finished.err.contains("elevator"), "{}", finished.err);
}
