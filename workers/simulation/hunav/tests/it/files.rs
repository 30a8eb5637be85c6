//! Agents files: what is read, what is refused and how, and that every dialect goes out as it came in.

use crate::common::{Walker, data, file, own, read, section, shown};
use socrates_hunav::{AgentsFile, Dialect, Inputs, Problem, Profile, Reaction, check_on_map, simulate};

fn two() -> String {
    file(&[
        Walker::new(1, " 4", (0.0, 0.0, 0.0), &[(5.0, 0.0), (0.0, 3.0)]),
        Walker::new(2, " 1", (2.0, 2.0, 1.0), &[(-5.0, 0.5)]),
    ])
}

fn two_0() -> String {
    let numbered = read(&two()).converted(Dialect::V2_0).0;
    numbered.to_yaml()
}

fn problems(text: &str) -> Vec<Problem> {
    AgentsFile::read(text, "agents.yaml").expect_err("it was read")
}

/// The one problem of a text with one change, which must name the changed line and say all of these.
fn told(base: &str, (old, new): (&str, &str), words: &[&str]) {
    let text = base.replacen(old, new, 1);
    let line = 1 + base.lines().zip(text.lines()).position(|(a, b)| a != b).unwrap();
    let found = problems(&text);
    assert_eq!(found.len(), 1, "{}", shown(&found));
    let said = found[0].to_string();
    assert_eq!(found[0].line, Some(line), "{said}");
    for word in words {
        assert!(said.contains(word), "`{word}` is not in: {said}");
    }
}

#[test]
fn a_file_of_1_0_is_read_whole() {
    let read = read(&two());
    assert_eq!((read.dialect, read.map.as_str(), read.publish_people), (Dialect::V1_0, "hall", true));
    let agent = &read.agents[0];
    assert_eq!((agent.id, agent.skin, agent.group_id, agent.behavior.reaction), (1, 0, -1, Reaction::Scared));
    assert_eq!(agent.goals.iter().map(|goal| goal.name.as_str()).collect::<Vec<_>>(), ["g0", "g1"]);
    assert!((agent.goals[1].at.y - 3.0).abs() < 1e-12 && (agent.start.z - 1.25).abs() < 1e-12);
    assert!(read.warnings.is_empty(), "{}", shown(&read.warnings));
}

#[test]
fn missing_keys_take_upstreams_defaults_with_a_warning() {
    let text = "hunav_loader:\n  ros__parameters:\n    agents: [a]\n    a:\n      id: 3\n      goals: [g]\n      g: {x: 1.0, y: 2.0}\n";
    let read = read(text);
    let agent = &read.agents[0];
    assert!((agent.max_vel_mps - 1.0).abs() < 1e-12 && (agent.radius_m - 0.35).abs() < 1e-12);
    assert!(agent.cyclic_goals && agent.skin == -1 && agent.group_id == -1 && agent.goal_radius_m.abs() < 1e-12);
    assert_eq!((read.map.as_str(), agent.behavior.reaction), ("map.yaml", Reaction::Regular));
    let warned = shown(&read.warnings);
    assert!(warned.contains("a.init_pose") && warned.contains("a.behavior"), "{warned}");
}

#[test]
fn integers_and_doubles_are_told_apart_as_ros_does() {
    told(&two(), ("max_vel: 1.5", "max_vel: 1"), &["agent1.max_vel", "`1`", "double", "1.0"]);
    told(&two(), ("id: 1", "id: 1.0"), &["agent1.id", "`1.0`", "integer", "write 1"]);
    told(&two(), ("radius: 0.4", "radius: '0.4'"), &["agent1.radius", "no number"]);
    told(&two(), ("x: 5.0", "x: 5"), &["agent1.g0.x", "`5`", "5.0"]);
}

#[test]
fn values_that_cannot_be_meant_are_named_with_what_can() {
    told(&two(), ("radius: 0.4", "radius: -0.4"), &["agent1.radius", "-0.4", "0.05 to 2.0 m"]);
    told(&two(), ("x: 0.0", "x: .nan"), &["agent1.init_pose.x", "NaN", "out of range"]);
    told(&two(), ("x: 0.0", "x: .inf"), &["agent1.init_pose.x", "inf"]);
    told(&two(), ("behavior: 4", "behavior: 17"), &["agent1.behavior", "17", "1 regular", "LLMBT_9"]);
    told(&two(), ("behavior: 4", "behavior: 0"), &["agent1.behavior", "`0`"]);
    told(&two(), ("skin: 0", "skin: 12"), &["agent1.skin", "-1 to 9"]);
    told(&two(), ("cyclic_goals: true", "cyclic_goals: maybe"), &["cyclic_goals", "maybe", "true, false"]);
    told(&two(), ("id: 1", "id: 99999999999999999999"), &["agent1.id", "99999999999999999999"]);
}

#[test]
fn names_and_keys_that_do_not_exist_are_named_with_the_nearest() {
    told(&two(), ("radius: 0.4", "raduis: 0.4"), &["raduis", "did you mean `radius`"]);
    told(&two(), ("- agent1", "- agnet1"), &["agnet1", "did you mean `agent1`"]);
    told(&two(), ("- g0", "- g7"), &["g7", "no section", "x"]);
    let other = two().replacen("hunav_loader", "hunav_laoder", 1);
    let found = problems(&other);
    assert!(shown(&found).contains("did you mean `hunav_loader`"), "{}", shown(&found));
    told(&two(), ("publish_people", "publish_peple"), &["publish_peple", "publish_people"]);
}

#[test]
fn ids_are_given_once() {
    told(&two(), ("id: 2", "id: 1"), &["agent2.id", "`1`", "agent1", "such as 2"]);
    told(&two(), ("- agent2", "- agent1"), &["agents[1]", "listed twice"]);
}

#[test]
fn a_key_given_twice_is_named() {
    told(&two(), ("      id: 1\n", "      id: 1\n      id: 1\n"), &["agent1.id", "given twice"]);
}

#[test]
fn nobody_to_simulate_is_refused() {
    for (text, words) in [
        ("hunav_loader:\n  ros__parameters:\n    agents: []\n", "nobody"),
        ("hunav_loader:\n  ros__parameters:\n    map: x\n", "`agents` is missing"),
        ("hunav_loader:\n  ros__parameters: {}\n", "`agents` is missing"),
        ("hunav_loader: 3\n", "must be a section"),
        ("[]\n", "is a section"),
        ("", "is a section"),
        ("a: [\n", "no YAML"),
    ] {
        assert!(shown(&problems(text)).contains(words), "{text}: {}", shown(&problems(text)));
    }
}

#[test]
fn every_problem_of_a_file_is_told_at_once() {
    let text = two()
        .replacen("radius: 0.4", "radius: -1.0", 1)
        .replacen("id: 2", "id: 1", 1)
        .replacen("behavior: 1", "behavior: 99", 1)
        .replacen("y: 0.5", "yy: 0.5", 1);
    let found = problems(&text);
    let said = shown(&found);
    for word in ["agent1.radius", "agent2.id", "agent2.behavior", "agent2.g0.y` is missing", "agent2.g0.yy"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(found.iter().all(|problem| problem.line.is_some()), "{said}");
}

#[test]
fn the_dialect_is_detected() {
    assert_eq!(read(&two()).dialect, Dialect::V1_0);
    let walkers = [Walker::new(1, &section(5, 1), (0.0, 0.0, 0.0), &[(5.0, 0.0)])];
    assert_eq!(read(&file(&walkers)).dialect, Dialect::V1_1);
    assert_eq!(read(&two_0()).dialect, Dialect::V2_0);
}

#[test]
fn a_file_of_1_1_has_sections_and_says_what_is_cut() {
    let text = file(&[Walker::new(1, &section(5, 1), (0.0, 0.0, 0.0), &[(5.0, 0.0)])]);
    assert!(read(&text).warnings.is_empty());
    let cut =
        read(&text.replacen("vel: 0.6", "vel: 2.6", 1).replacen("goal_force_factor: 2.0", "goal_force_factor: 9.0", 1));
    let warned = shown(&cut.warnings);
    assert!(warned.contains("`2.6`") && warned.contains("1.8 is taken") && warned.contains("8.0 is taken"), "{warned}");
    told(&text, ("type: 5", "type: 7"), &["behavior.type", "`7`", "1 regular"]);
    told(&text, ("configuration: 1", "configuration: 4"), &["configuration", "0 to 3"]);
    told(&text, ("duration: 40.0", "duration: 40"), &["duration", "40.0"]);
    let both = file(&[
        Walker::new(1, &section(5, 1), (0.0, 0.0, 0.0), &[(5.0, 0.0)]),
        Walker::new(2, " 4", (3.0, 3.0, 0.0), &[(5.0, 0.0)]),
    ]);
    assert!(shown(&problems(&both)).contains("agent2.behavior"), "{}", shown(&problems(&both)));
}

#[test]
fn a_file_of_2_0_names_gaps_unknown_goals_and_words() {
    let text = two_0();
    let gap = text.replacen("      2:\n", "      5:\n", 1);
    let said = shown(&problems(&gap));
    assert!(said.contains("goal 2 is missing") && said.contains("global_goals"), "{said}");
    let said = shown(&problems(&text.replacen("        - 3", "        - 33", 1)));
    assert!(said.contains("`33`") && said.contains("1 to 3"), "{said}");
    let said = shown(&problems(&text.replacen("type: Regular", "type: Regullar", 1)));
    assert!(said.contains("did you mean `Regular`"), "{said}");
    let said = shown(&problems(&text.replacen("        - 1", "        - g1", 1)));
    assert!(said.contains("no number of a goal"), "{said}");
}

#[test]
fn every_dialect_goes_out_as_it_came_in() {
    let texts = [
        two(),
        two_0(),
        file(&[
            Walker::new(1, &section(5, 1), (0.1, -1e-7, 0.0), &[(5.0, 0.0), (100_000.5, 0.5)]),
            Walker::new(7, &section(2, 3), (0.1, 2.0, 0.0), &[(-5.0, 0.0)]),
        ]),
    ];
    for text in texts {
        let first = read(&text);
        let again = read(&first.to_yaml());
        assert_eq!(first, again, "{}", first.to_yaml());
        for dialect in Dialect::ALL {
            let (converted, _) = first.converted(dialect);
            let written = converted.to_yaml();
            let back = read(&written);
            assert_eq!(back.dialect, dialect, "{written}");
            assert_eq!(back, converted, "{written}");
        }
    }
}

/// Writes a file that was read and reads it again.
fn goes_out_as_it_came_in(file: &std::path::Path) {
    let mut first = read(&std::fs::read_to_string(file).unwrap());
    let again = read(&first.to_yaml());
    first.warnings.clear();
    assert_eq!(AgentsFile { warnings: Vec::new(), ..again }, first, "{}", file.display());
}

#[test]
fn our_files_of_every_dialect_go_out_as_they_came_in() {
    for folder in ["v1_0", "v1_1", "v2_0"] {
        goes_out_as_it_came_in(&own(folder).join("agents.yaml"));
    }
}

#[test]
fn shipped_files_go_out_as_they_came_in() {
    let names = [
        ("hunav_sim_v1_0", "config/agents.yaml"),
        ("hunav_sim_v1_1", "config/agents.yaml"),
        ("hunav_sim_v1_1", "config/agents_house.yaml"),
        ("hunav_sim_v1_1", "config/agents_warehouse.yaml"),
        ("hunav_sim_fork", "config/custom_agents.yaml"),
        ("hunav_sim_fork", "config/default_agents.yaml"),
        ("isaac_wrapper_v2", "scenarios/hospital_agents.yaml"),
        ("isaac_wrapper_v2", "scenarios/warehouse_agents.yaml"),
    ];
    for (folder, name) in names {
        let Some(folder) = data(folder) else { return };
        goes_out_as_it_came_in(&folder.join(name));
    }
}

#[test]
fn a_conversion_says_what_is_lost() {
    let custom = read(&two().replacen("behavior: 4", "behavior: 9", 1));
    let (_, notes) = custom.converted(Dialect::V1_1);
    assert!(notes.iter().any(|note| note.contains("LLMBT_2")), "{notes:?}");
    let (_, notes) = read(&two_0()).converted(Dialect::V1_0);
    assert!(notes.iter().any(|note| note.contains("yaml_base_name")), "{notes:?}");
}

#[test]
fn goals_in_walls_and_off_the_map_are_named_with_a_free_spot() {
    let grid = crate::common::hall_with_wall(5.0, -3.0, 3.0);
    let floor = socrates_engine::Floor::new(&grid);
    let agents = read(&two().replacen("x: -5.0", "x: -95.0", 1));
    let found = check_on_map(&agents, &grid, floor.field(), "agents.yaml");
    let said = shown(&found);
    assert!(said.contains("agent1.g0") && said.contains("in a wall") && said.contains("nearest free spot"), "{said}");
    assert!(said.contains("agent2.g0") && said.contains("off the map"), "{said}");
    assert_eq!(found.len(), 2, "{said}");
}

#[test]
fn hostile_files_are_refused_in_linear_time() {
    let bomb = "hunav_loader: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: [*c, *c]\n";
    assert!(shown(&problems(bomb)).contains("anchor"));
    assert!(shown(&problems(&"a: [[".repeat(200_000))).contains("nested"));
    let big = format!("hunav_loader:\n  ros__parameters:\n    agents: [a]\n#{}", "x".repeat(10 << 20));
    assert!(shown(&problems(&big)).contains("bytes"));
    let many: String = (0..200_000).map(|n| format!("      - a{n}\n")).collect();
    let text = format!("hunav_loader:\n  ros__parameters:\n    agents:\n{many}");
    let found = problems(&text);
    assert!(found.len() < 300 && shown(&found).contains("at most 10000"), "{}", found.len());
}

/// What is put into a file where it does not belong.
const ODD: [&str; 28] = [
    "-",
    "- ",
    ":",
    "{",
    "}",
    "[",
    "]",
    "&a",
    "*a",
    "!x ",
    "'",
    "\"",
    "#",
    "\t",
    "\n",
    ".nan",
    "1e999",
    "~",
    "\u{0}",
    "é",
    "|",
    ">",
    "? ",
    "<<: ",
    "-1",
    "0",
    "9999999999",
    "true",
];

#[test]
fn mutations_of_a_file_never_panic_and_what_is_read_goes_out_and_in() {
    // A fixed sequence, so that the corpus never changes.
    let mut random = socrates_model::seeds::SplitMix64::new(7);
    let mut draw = move |n: usize| random.below(n.max(1));
    let walkers = [Walker::new(1, &section(5, 2), (0.0, 0.0, 0.0), &[(5.0, 0.0)])];
    let bases = [two(), two_0(), file(&walkers)];
    let grid = crate::common::hall();
    let mut read_again = 0;
    for round in 0..4000 {
        let mut text = bases[round % bases.len()].clone();
        for _ in 0..=draw(3) {
            let lines: Vec<&str> = text.lines().collect();
            let at = draw(lines.len());
            let changed: String = match draw(5) {
                0 => lines
                    .iter()
                    .enumerate()
                    .filter(|(line, _)| *line != at)
                    .map(|(_, line)| format!("{line}\n"))
                    .collect(),
                1 => lines
                    .iter()
                    .enumerate()
                    .map(|(n, line)| if n == at { format!("{line}\n{line}\n") } else { format!("{line}\n") })
                    .collect(),
                2 => {
                    let mut chars: Vec<char> = text.chars().collect();
                    let place = draw(chars.len());
                    chars.splice(place..place, ODD[draw(ODD.len())].chars());
                    chars.into_iter().collect()
                }
                3 => {
                    let mut chars: Vec<char> = text.chars().collect();
                    chars.truncate(draw(chars.len()));
                    chars.into_iter().collect()
                }
                _ => {
                    let other = draw(lines.len());
                    lines
                        .iter()
                        .enumerate()
                        .map(|(n, line)| format!("{}\n", if n == at { lines[other] } else { line }))
                        .collect()
                }
            };
            text = changed;
        }
        match AgentsFile::read(&text, "agents.yaml") {
            Ok(mut file) => {
                file.warnings.clear();
                let again = AgentsFile::read(&file.to_yaml(), "agents.yaml");
                let again = again.unwrap_or_else(|problems| panic!("{}\n{}", file.to_yaml(), shown(&problems)));
                assert_eq!(AgentsFile { warnings: Vec::new(), ..again }, file);
                read_again += 1;
                // Whatever can be read can be run, or is refused: it never breaks.
                let profile = Profile::ALL[read_again % Profile::ALL.len()];
                if read_again % 25 == 0 {
                    let inputs = Inputs { grid: Some(&grid), profile, duration_s: 0.3, ..Inputs::new(&file, "a.yaml") };
                    match simulate(&inputs) {
                        Ok(recording) => assert_eq!(recording.ticks(), 31),
                        Err(found) => assert!(found.iter().all(Problem::is_error)),
                    }
                }
            }
            Err(found) => assert!(!found.is_empty() && found.iter().all(Problem::is_error)),
        }
    }
    assert!(read_again > 200, "{read_again}");
}
