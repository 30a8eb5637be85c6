//! Every agents file and every tree of the reference data, and of our own in its style, runs to the end in its profile, or is refused
//! for the reason that its notes give.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::common::{Walker, data, own, read, shown};
use socrates_hunav::{AgentsFile, Dialect, Inputs, Profile, Reaction, RobotSpec, simulate};
use socrates_model::{Cell, Grid, Point, Pose, Recording};

/// All files of a folder by name.
fn files(folder: &Path, extension: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|it| it == extension) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            found.insert(name, fs::read_to_string(&path).unwrap());
        }
    }
    found
}

/// A robot that drives through the goals of the first agents.
fn robot(file: &AgentsFile) -> RobotSpec {
    let goals: Vec<Point> = file.agents.iter().map(|agent| agent.goals[0].at).collect();
    let start = goals[0] + socrates_model::Vector::new(1.0, 1.0);
    RobotSpec { goals, cyclic: true, ..RobotSpec::standing(Pose::new(start.x, start.y, 0.0)) }
}

fn run(file: &AgentsFile, profile: Profile, trees: &BTreeMap<String, String>, grid: Option<&Grid>) -> Recording {
    let find = |name: &str| trees.get(name).cloned();
    let inputs = Inputs { profile, trees: &find, robot: Some(robot(file)), grid, ..Inputs::new(file, "agents.yaml") };
    simulate(&inputs).unwrap_or_else(|problems| panic!("{profile}: {}", shown(&problems)))
}

fn ended(recording: &Recording) {
    assert_eq!(recording.ticks(), 6001);
    assert!(recording.frames.iter().all(|state| state.x.is_finite() && state.y.is_finite() && state.yaw.is_finite()));
    let start: Vec<_> = recording.tick(0).iter().map(socrates_model::AgentState::point).collect();
    let end: Vec<_> = recording.tick(6000).iter().map(socrates_model::AgentState::point).collect();
    assert!(start.iter().zip(&end).any(|(a, b)| (a - b).norm() > 0.5), "nobody moved");
}

#[test]
fn our_agents_files_of_every_dialect_run_in_their_profile_and_natively() {
    for (name, dialect, profile) in [
        ("v1_0", Dialect::V1_0, Profile::Hunav10),
        ("v1_1", Dialect::V1_1, Profile::Hunav11),
        ("v2_0", Dialect::V2_0, Profile::Hunav20),
    ] {
        let folder = own(name);
        let file = read(&fs::read_to_string(folder.join("agents.yaml")).unwrap());
        assert_eq!(file.dialect, dialect, "{name}");
        assert!(file.warnings.is_empty(), "{name}: {}", shown(&file.warnings));
        let who: Vec<(i64, Reaction, usize)> =
            file.agents.iter().map(|agent| (agent.id, agent.behavior.reaction, agent.goals.len())).collect();
        assert_eq!(who, [(1, Reaction::Regular, 2), (2, Reaction::Surprised, 2), (3, Reaction::Curious, 2)], "{name}");
        let trees = files(&folder, "xml");
        assert!(trees.len() >= 2, "{name}");
        ended(&run(&file, profile, &trees, None));
        ended(&run(&file, Profile::Native, &trees, None));
        ended(&run(&file, Profile::Native, &BTreeMap::new(), None));
    }
}

#[test]
fn agents_of_1_0_run_in_their_profile_and_natively() {
    let Some(folder) = data("hunav_sim_v1_0") else { return };
    let trees = files(&folder.join("behavior_trees"), "xml");
    let text = fs::read_to_string(folder.join("config/agents.yaml")).unwrap();
    let file = read(&text);
    assert_eq!(file.dialect, Dialect::V1_0);
    for given in [&trees, &BTreeMap::new()] {
        ended(&run(&file, Profile::Hunav10, given, None));
        ended(&run(&file, Profile::Native, given, None));
    }
}

#[test]
fn agents_of_1_1_run_in_their_profile_and_natively() {
    let Some(folder) = data("hunav_sim_v1_1") else { return };
    let trees = files(&folder.join("behavior_trees"), "xml");
    for (name, text) in files(&folder.join("config"), "yaml") {
        if !name.starts_with("agents") {
            continue;
        }
        let file = read(&text);
        assert_eq!(file.dialect, Dialect::V1_1, "{name}");
        for given in [&trees, &BTreeMap::new()] {
            ended(&run(&file, Profile::Hunav11, given, None));
            ended(&run(&file, Profile::Native, given, None));
        }
    }
}

#[test]
fn agents_of_2_0_run_with_their_own_trees() {
    let Some(folder) = data("isaac_wrapper_v2") else { return };
    let trees = files(&folder.join("behavior_trees"), "xml");
    for (name, text) in files(&folder.join("scenarios"), "yaml") {
        let file = read(&text);
        assert_eq!(file.dialect, Dialect::V2_0, "{name}");
        for agent in &file.agents {
            assert!(trees.contains_key(&file.tree_file(agent).unwrap()), "{name}");
        }
        ended(&run(&file, Profile::Hunav20, &trees, None));
        ended(&run(&file, Profile::Native, &trees, None));
        ended(&run(&file, Profile::Native, &BTreeMap::new(), None));
    }
}

#[test]
fn custom_agents_of_the_fork_run_with_its_trees() {
    let Some(folder) = data("hunav_sim_fork") else { return };
    let trees = files(&folder.join("behavior_trees"), "xml");
    let file = read(&fs::read_to_string(folder.join("config/custom_agents.yaml")).unwrap());
    let names: Vec<String> = file.agents.iter().filter_map(|agent| file.tree_file(agent)).collect();
    assert_eq!(names, ["LLMBT_0.xml", "LLMBT_1.xml"]);
    ended(&run(&file, Profile::SocratesFork, &trees, None));
    ended(&run(&file, Profile::Native, &trees, None));
}

#[test]
fn default_agents_of_the_fork_are_refused_for_the_nodes_it_lost() {
    let Some(folder) = data("hunav_sim_fork") else { return };
    let trees = files(&folder.join("behavior_trees"), "xml");
    let file = read(&fs::read_to_string(folder.join("config/default_agents.yaml")).unwrap());
    let find = |name: &str| trees.get(name).cloned();
    let inputs = Inputs { profile: Profile::SocratesFork, trees: &find, ..Inputs::new(&file, "default_agents.yaml") };
    let told = shown(&simulate(&inputs).unwrap_err());
    assert!(told.contains("AvoidRobot") && told.contains("ThreateningNav"), "{told}");
    let without = Inputs { profile: Profile::SocratesFork, ..Inputs::new(&file, "default_agents.yaml") };
    let told = shown(&simulate(&without).unwrap_err());
    assert!(told.contains("nodes that it does not have"), "{told}");
}

/// Runs one tree of a folder as the tree of the behavior with this code.
fn tree(code: &str, name: &str, folder: &Path, profile: Profile, dialect_2: bool) -> Result<Recording, String> {
    let trees = files(folder, "xml");
    let walker = Walker::new(1, code, (0.0, 0.0, 0.0), &[(6.0, 0.0), (0.0, 4.0)]);
    let mut file = read(&crate::common::file(&[walker]));
    if dialect_2 {
        file = file.converted(Dialect::V2_0).0;
    }
    let wanted = match file.tree_file(&file.agents[0]) {
        Some(wanted) => wanted,
        None => socrates_hunav::default_tree_file(file.agents[0].behavior.reaction),
    };
    let find = |asked: &str| if asked == wanted { trees.get(name).cloned() } else { trees.get(asked).cloned() };
    let mut robot = RobotSpec::standing(Pose::new(4.0, 1.0, 3.0));
    robot.goals = vec![Point::new(-4.0, 0.5)];
    let inputs = Inputs { profile, trees: &find, robot: Some(robot), ..Inputs::new(&file, "agents.yaml") };
    simulate(&inputs).map_err(|problems| shown(&problems))
}

#[test]
fn every_tree_of_1_0_and_1_1_runs_in_its_profile() {
    for (folder, profile) in [("hunav_sim_v1_0", Profile::Hunav10), ("hunav_sim_v1_1", Profile::Hunav11)] {
        let Some(folder) = data(folder) else { return };
        let folder = folder.join("behavior_trees");
        let names = [("Regular", 1), ("Surprised", 3), ("Scared", 4), ("Curious", 5), ("Threatening", 6)];
        assert_eq!(files(&folder, "xml").len(), names.len());
        for (name, code) in names {
            let behavior =
                if profile == Profile::Hunav10 { format!(" {code}") } else { crate::common::section(code, 0) };
            let name = format!("BT{name}Nav.xml");
            let recording = tree(&behavior, &name, &folder, profile, false).unwrap_or_else(|told| panic!("{told}"));
            ended(&recording);
        }
    }
}

#[test]
fn every_tree_of_2_0_runs_in_its_profile() {
    let Some(folder) = data("isaac_wrapper_v2") else { return };
    let folder = folder.join("behavior_trees");
    let all = files(&folder, "xml");
    assert_eq!(all.len(), 19);
    for name in all.keys().filter(|name| name.starts_with("BT")) {
        let code = match name.as_str() {
            "BTSurprisedNav.xml" => 3,
            "BTScaredNav.xml" => 4,
            "BTCuriousNav.xml" => 5,
            "BTThreateningNav.xml" => 6,
            _ => 1,
        };
        let recording = tree(&format!(" {code}"), name, &folder, Profile::Hunav20, true);
        ended(&recording.unwrap_or_else(|told| panic!("{name}: {told}")));
    }
}

#[test]
fn every_tree_of_the_fork_runs_or_is_refused_by_the_node_it_lacks() {
    let Some(folder) = data("hunav_sim_fork") else { return };
    let folder = folder.join("behavior_trees");
    let refused = [
        ("LLMBT_3.xml", "HasRobotMoved"),
        ("LLMBT_4.xml", "HasRobotMoved"),
        ("BTScaredNav.xml", "AvoidRobot"),
        ("BTSurprisedNav.xml", "SurprisedNav"),
        ("BTThreateningNav.xml", "ThreateningNav"),
    ];
    for name in files(&folder, "xml").keys() {
        let told = tree(" 7", name, &folder, Profile::SocratesFork, false);
        match refused.iter().find(|(other, _)| other == name) {
            Some((_, node)) => {
                let told = told.expect_err(name);
                assert!(told.contains(node), "{name}: {told}");
                assert!(name.starts_with("BT") || told.contains("`t`"), "{name}: {told}");
            }
            None => {
                let recording = told.unwrap_or_else(|told| panic!("{name}: {told}"));
                assert_eq!(recording.ticks(), 6001, "{name}");
            }
        }
    }
}

/// The grid of a map of the data: a binary PGM in which 254 is free, with the numbers of its `map.yaml`.
fn map(folder: &Path, name: &str) -> Grid {
    let yaml = fs::read_to_string(folder.join(format!("{name}.yaml"))).unwrap();
    let line = |key: &str| yaml.lines().find_map(|line| line.strip_prefix(key)).unwrap().trim().to_owned();
    let origin = line("origin:");
    let origin: Vec<f64> =
        origin.trim_matches(['[', ']']).split(',').map(|number| number.trim().parse().unwrap()).collect();
    let bytes = fs::read(folder.join(line("image:"))).unwrap();
    let mut words: Vec<usize> = Vec::new();
    let mut at = 2;
    while words.len() < 3 {
        let end = at + bytes[at..].iter().position(|byte| *byte == b'\n').unwrap();
        let text = String::from_utf8_lossy(&bytes[at..end]).into_owned();
        if !text.trim_start().starts_with('#') {
            words.extend(text.split_whitespace().map(|word| word.parse::<usize>().unwrap()));
        }
        at = end + 1;
    }
    let cells = bytes[at..].iter().map(|pixel| if *pixel >= 210 { Cell::Free } else { Cell::Occupied }).collect();
    let resolution_m = line("resolution:").parse().unwrap();
    Grid { width: words[0], height: words[1], resolution_m, origin: Pose::new(origin[0], origin[1], 0.0), cells }
}

#[test]
fn agents_of_1_1_run_on_their_maps() {
    let Some(folder) = data("hunav_sim_v1_1") else { return };
    let trees = files(&folder.join("behavior_trees"), "xml");
    let find = |name: &str| trees.get(name).cloned();
    for (agents, name) in [("agents_warehouse", "small_warehouse"), ("agents_house", "small_house")] {
        let grid = map(&folder.join("maps"), name);
        let file = read(&fs::read_to_string(folder.join(format!("config/{agents}.yaml"))).unwrap());
        for profile in [Profile::Hunav11, Profile::Native] {
            let inputs = Inputs { profile, trees: &find, grid: Some(&grid), ..Inputs::new(&file, agents) };
            let recording =
                simulate(&inputs).unwrap_or_else(|problems| panic!("{agents} {profile}: {}", shown(&problems)));
            ended(&recording);
        }
    }
}
