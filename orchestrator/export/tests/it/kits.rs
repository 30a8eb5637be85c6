//! Kits for HuNavSim, read back by the reader of its agents files and trees, and played by it.

use std::collections::BTreeMap;

use socrates_bt::{Library, Meaning, Options, Tree};
use socrates_export::scenario::{File, Format, Package, Scenario};
use socrates_hunav::{AgentsFile, Dialect, Inputs, Profile, Reaction, RobotSpec, simulate};
use socrates_model::{AgentId, HumanId, Pose};

use crate::whole::whole;

/// Kits with their dialect, their profile and the library of their trees.
const KITS: [(&str, Dialect, Profile, Option<Library>); 4] = [
    ("hunav-1.0", Dialect::V1_0, Profile::Hunav10, None),
    ("hunav-1.1", Dialect::V1_1, Profile::Hunav11, None),
    ("hunav-2.0", Dialect::V2_0, Profile::Hunav20, Some(Library::HunavSim2)),
    ("hunav-fork", Dialect::V1_0, Profile::SocratesFork, Some(Library::SocratesFork)),
];

fn kit(format: &str, scenario: &Scenario) -> Package {
    Format::named(format).unwrap().export(scenario).unwrap_or_else(|why| panic!("{format}: {why}"))
}

fn texts(package: &Package) -> BTreeMap<&str, &str> {
    let mut texts = BTreeMap::new();
    for (name, file) in &package.files {
        match file {
            File::Text(text) => _ = texts.insert(name.as_str(), text.as_str()),
            File::Bytes(_) | File::Database(_) | File::Columns(_) | File::Bag(_) => {}
        }
    }
    texts
}

fn agents(package: &Package) -> AgentsFile {
    let texts = texts(package);
    let (name, text) = texts.iter().find(|(name, _)| name.ends_with("_agents.yaml")).unwrap();
    AgentsFile::read(text, name).unwrap_or_else(|problems| panic!("{problems:?}"))
}

#[test]
fn an_agents_file_is_read_back_in_its_dialect_with_the_people_of_the_scenario() {
    let scenario = whole();
    for (format, dialect, _, library) in KITS {
        let package = kit(format, &scenario);
        let file = agents(&package);
        assert_eq!((file.dialect, file.agents.len()), (dialect, 2), "{format}");
        assert!(file.warnings.is_empty(), "{format}: {:?}", file.warnings);
        let (one, two) = (&file.agents[0], &file.agents[1]);
        assert_eq!((one.name.as_str(), one.id, one.group_id), ("human_1", 1, 1), "{format}");
        // Places of the first tick at which each is there, goals along the way, standing people with their own place.
        assert_eq!((one.start.x, one.start.y, two.start.y), (9.0, 2.5, 3.123_457), "{format}");
        let way = scenario.location.graph.polyline(&scenario.paths.humans[&HumanId::new(1)]);
        assert_eq!(one.goals.len(), way.len() - 1, "{format}");
        let last = one.goals.last().unwrap().at;
        assert!((last - way.last().unwrap()).norm() < 1e-5, "{format}");
        assert_eq!(two.goals.len(), 1, "{format}");
        assert_eq!((one.max_vel_mps, one.radius_m), (1.1, 0.3), "{format}");
        let custom = matches!(one.behavior.reaction, Reaction::Custom(0));
        assert_eq!(custom, library == Some(Library::SocratesFork), "{format}");
    }
}

#[test]
fn the_trees_of_a_kit_load_in_the_library_of_its_version() {
    for (format, _, _, library) in KITS {
        let package = kit(format, &whole());
        let texts = texts(&package);
        let trees: Vec<_> = texts.iter().filter(|(name, _)| name.starts_with("behavior_trees/")).collect();
        let Some(library) = library else {
            assert!(trees.is_empty(), "{format}");
            continue;
        };
        assert_eq!(trees.len(), 3, "{format}: the two of the scenario and the walk");
        for (name, text) in trees {
            let options = Options { library, meaning: Meaning::World, ..Options::default() };
            let tree = Tree::parse_with(text, &options).unwrap_or_else(|faults| panic!("{format} {name}: {faults:?}"));
            assert!(tree.foreign_to(library).is_empty(), "{format} {name}");
            let near = if library == Library::HunavSim2 { "IsRobotClose" } else { "IsRobotNearby" };
            assert!(name.contains("BTRegularNav") || text.contains(near), "{name}: {text}");
        }
    }
}

#[test]
fn a_tree_that_a_version_cannot_load_is_named_and_left_out() {
    let mut scenario = whole();
    let tree = &mut scenario.behaviors.humans.get_mut(&HumanId::new(1)).unwrap().tree;
    *tree = tree.replace("<LookAtRobot agent_id=\"{id}\"/>", "<FollowRobot agent_id=\"{id}\" time_step=\"{dt}\"/>");
    let package = kit("hunav-2.0", &scenario);
    let row = package.losses.rows().iter().find(|row| row.what == "trees that the version cannot load").unwrap();
    assert!(row.count == 1 && row.at[0].contains("human_1") && row.why.contains("no node FollowRobot"), "{row:?}");
    assert!(!texts(&package).values().any(|text| text.contains("FollowRobot")));
    // The fork knows the node, but not more than ten trees.
    assert!(texts(&kit("hunav-fork", &scenario))["behavior_trees/LLMBT_0.xml"].contains("FollowRobot"));
    let human = scenario.behaviors.humans[&HumanId::new(1)].clone();
    scenario.behaviors.humans.insert(HumanId::new(11), human);
    let package = kit("hunav-fork", &scenario);
    assert!(package.losses.rows().iter().any(|row| row.what == "trees beyond the tenth" && row.count == 1));
    // A trigger that holds on is left out, and said.
    let mut scenario = whole();
    for human in scenario.behaviors.humans.values_mut() {
        human.tree = human.tree.replace(
            "<IsRobotNearby agent_id=\"{id}\" distance=\"2.0\"/>",
            "<Latch><IsRobotNearby agent_id=\"{id}\" distance=\"2.0\"/></Latch>",
        );
    }
    for format in ["hunav-fork", "hunav-2.0"] {
        let package = kit(format, &scenario);
        assert!(
            package.losses.rows().iter().any(|row| row.what == "triggers that hold on" && row.count == 2),
            "{format}"
        );
        assert!(!texts(&package).values().any(|text| text.contains("Latch")), "{format}");
    }
}

#[test]
fn the_world_of_a_kit_keeps_the_rules_of_the_plugin() {
    let mut scenario = whole();
    // The first column of cells lies on both sides of x = 0.
    scenario.location.grid.origin = Pose::new(-0.45, -0.05, 0.0);
    let package = kit("hunav-1.1", &scenario);
    let texts = texts(&package);
    let world = texts.iter().find(|(name, _)| name.ends_with(".world")).unwrap().1;
    assert!(!world.contains("<!--") && !world.contains("<actor") && !world.contains("<plugin"));
    let mut walls = 0;
    for model in world.split("<model name=\"wall_").skip(1) {
        let of = |tag: &str| {
            let text = model.split(&format!("<{tag}>")).nth(1).unwrap().split('<').next().unwrap();
            text.split(' ').map(|number| number.parse().unwrap()).collect::<Vec<f64>>()
        };
        let (pose, size) = (of("pose"), of("size"));
        assert!(pose[0] != 0.0 && pose[1] != 0.0 && size[0] <= 1.0 && size[1] <= 1.0, "{pose:?} {size:?}");
        walls += 1;
    }
    assert!(walls > 100, "{walls}");
}

#[test]
fn people_of_a_kit_are_played_to_their_goals() {
    let scenario = whole();
    for (format, _, profile, _) in KITS {
        let package = kit(format, &scenario);
        let texts = texts(&package);
        let mut file = agents(&package);
        // The way of the fixture's run leads nowhere near its path: they begin where the path does.
        let way = scenario.location.graph.polyline(&scenario.paths.humans[&HumanId::new(1)]);
        (file.agents[0].start.x, file.agents[0].start.y) = (way[0].x, way[0].y);
        file.agents.truncate(1);
        let trees = |name: &str| texts.get(format!("behavior_trees/{name}").as_str()).map(|text| (*text).to_owned());
        let mut inputs = Inputs::new(&file, "agents.yaml");
        inputs.profile = profile;
        inputs.duration_s = 12.0;
        inputs.trees = &trees;
        inputs.robot = Some(RobotSpec::standing(Pose::new(-50.0, -50.0, 0.0)));
        let run = simulate(&inputs).unwrap_or_else(|problems| panic!("{format}: {problems:?}"));
        let first_goal = file.agents[0].goals[0].at;
        let track = run.track(AgentId::from_number(1));
        let nearest = track.map(|state| (state.point() - first_goal).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.5, "{format}: {nearest} m from the first goal");
    }
}

#[test]
fn a_scenario_without_people_or_paths_is_refused_with_what_is_missing() {
    let mut scenario = whole();
    scenario.recording = None;
    scenario.paths.humans.clear();
    let told = Format::named("hunav-1.0").unwrap().export(&scenario).unwrap_err();
    assert!(told.to_string().contains("human_1") && told.to_string().contains("begins nowhere"), "{told}");
    scenario.proposal.humans.clear();
    let told = Format::named("hunav-1.0").unwrap().export(&scenario).unwrap_err();
    assert!(told.to_string().contains("0 people"), "{told}");
}
