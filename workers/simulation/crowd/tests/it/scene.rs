//! Scene files that cannot be meant.

use std::fmt::Write as _;

use crate::trace::{Scene, SceneError, trajectory, write_forces};
use socrates_crowd::cross::SplitMix64;
use socrates_crowd::strict::Model;

const AGENT: &str = r#"{"id":1,"x":0,"y":0.5,"vx":0,"vy":0,"yaw":0,"radius":0.35,"desired_velocity":1.2,"group_id":-1,
 "cyclic_goals":true,"teleoperated":false,"linear_velocity":0,"angular_velocity":0,"goals":[[4,0,0.3],[0,0,0.3]]}"#;

fn scene_of(mode: &str, segments: &str, agents: &str) -> String {
    format!(
        r#"{{"name":"small","mode":"{mode}","dt":0.01,"steps":3,"obstacle_range":3,
"params":{{"force_factor_desired":2,"force_factor_obstacle":10,"force_sigma_obstacle":0.2,"force_factor_social":5,
"force_factor_group_gaze":3,"force_factor_group_coherence":2,"force_factor_group_repulsion":1,"lambda":2,"gamma":0.35,
"n":2,"n_prime":3,"epsilon":0,"relaxation_time":0.5}},
"segments":{segments},"agents":{agents}}}"#
    )
}

fn good() -> String {
    scene_of("hunav", "[[0,2,5,2],[1,1,1,1]]", &format!("[{AGENT}]"))
}

/// The fields of all problems, and their text.
fn problems(text: &str) -> (Vec<String>, String) {
    match Scene::read(text) {
        Err(SceneError::Wrong { problems }) => {
            let message = SceneError::Wrong { problems: problems.clone() }.to_string();
            (problems.into_iter().map(|problem| problem.field).collect(), message)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_good_scene_runs() {
    let scene = Scene::read(&good()).unwrap();
    assert_eq!((scene.model, scene.steps, scene.walkers.len(), scene.walls.len()), (Model::Hunav, 3, 1, 2));
    assert_eq!(trajectory(&scene).lines().count(), 5);
}

#[test]
fn every_wrong_value_is_named_with_its_field_and_what_is_allowed() {
    let cases = [
        ("\"dt\":0.01", "\"dt\":-1", "dt", "`-1`; allowed: a finite number above 0"),
        ("\"steps\":3", "\"steps\":3.5", "steps", "a whole number from 0"),
        ("\"steps\":3", "\"steps\":1e999", "", ""),
        ("\"mode\":\"hunav\"", "\"mode\":\"orca\"", "mode", "\"hunav\" or \"batch\""),
        ("\"gamma\":0.35", "\"gamma\":0", "params.gamma", "above 0"),
        ("\"gamma\":0.35,", "", "params.gamma", "missing"),
        ("\"name\":\"small\"", "\"name\":7", "name", "a text"),
        ("\"name\":\"small\"", "\"name\":\"small\",\"speed\":1", "speed", "not known"),
        ("\"name\":\"small\"", "\"name\":\"small\",\"name\":\"b\"", "name", "there twice"),
        ("[1,1,1,1]", "[1,1,1]", "segments[1]", "[x1, y1, x2, y2]"),
        ("[1,1,1,1]", "[1,1,null,1]", "segments[1][2]", "`null`"),
        ("\"radius\":0.35", "\"radius\":-0.1", "agents[0].radius", "`-0.1`; allowed: a finite number of at least 0"),
        ("\"x\":0,", "\"x\":\"left\",", "agents[0].x", "a finite number"),
        ("\"id\":1", "\"id\":-1", "agents[0].id", "from 0 to 4294967295"),
        ("\"teleoperated\":false", "\"teleoperated\":true", "agents[0].teleoperated", "only the mode `batch`"),
        ("[4,0,0.3]", "[4,0,-1]", "agents[0].goals[0][2]", "at least 0"),
        ("\"cyclic_goals\":true", "\"cyclic_goals\":\"yes\"", "agents[0].cyclic_goals", "true or false"),
    ];
    for (from, to, field, wanted) in cases {
        let text = good().replace(from, to);
        assert_ne!(text, good());
        if field.is_empty() {
            assert!(matches!(Scene::read(&text), Err(SceneError::NotJson { line: 1, .. })));
            continue;
        }
        let (fields, message) = problems(&text);
        assert_eq!(fields, [field], "{message}");
        assert!(message.contains(wanted), "{message}");
    }
}

#[test]
fn all_wrong_values_are_told_at_once() {
    let text =
        good().replace("\"dt\":0.01", "\"dt\":0").replace("\"radius\":0.35", "\"radius\":-1").replace("5,2]", "5]");
    assert_eq!(problems(&text).0, ["dt", "segments[0]", "agents[0].radius"]);
}

#[test]
fn a_scene_needs_agents_with_ids_of_their_own() {
    let (fields, message) = problems(&scene_of("hunav", "[]", "[]"));
    assert_eq!(fields, ["agents"]);
    assert!(message.contains("at least one agent"), "{message}");
    let (fields, _) = problems(&scene_of("batch", "[]", &format!("[{AGENT},{AGENT}]")));
    assert_eq!(fields, ["agents[1].id"]);
    for (agents, field) in [("[null]", "agents[0]"), ("null", "agents"), ("{}", "agents"), ("[7]", "agents[0]")] {
        assert_eq!(problems(&scene_of("batch", "[]", agents)).0, [field], "{agents}");
    }
}

#[test]
fn what_is_not_json_is_told_with_its_place() {
    for text in ["", "{", "NaN", "{\"dt\": NaN}", "[1,]", &"[".repeat(100_000)] {
        assert!(matches!(Scene::read(text), Err(SceneError::NotJson { .. })));
    }
    for text in ["null", "7", "[]", "\"x\""] {
        assert_eq!(problems(text).0, ["scene"], "{text}");
    }
}

#[test]
fn negative_group_numbers_are_groups_only_where_the_reference_takes_them_so() {
    let second = AGENT.replace("\"id\":1", "\"id\":2").replace("\"x\":0", "\"x\":1");
    let agents = format!("[{AGENT},{second}]").replace("\"group_id\":-1", "\"group_id\":-7");
    for (mode, together) in [("hunav", true), ("batch", false)] {
        let scene = Scene::read(&scene_of(mode, "[]", &agents)).unwrap();
        assert_eq!(scene.walkers[0].person.group.is_some(), together);
        assert_eq!(scene.walkers[0].person.group, scene.walkers[1].person.group);
    }
}

#[test]
fn spoiled_scenes_never_panic() {
    let mut random = SplitMix64::new(78);
    let (mut read, mut text) = (0, String::new());
    for _ in 0..20_000 {
        let mut signs: Vec<char> = good().chars().collect();
        for _ in 0..=random.next_u64() % 3 {
            let at = (random.next_u64() % signs.len() as u64) as usize;
            let others: Vec<char> = "0123456789.,-+eE[]{}:\"ntf\\ \u{e9}\u{0}".chars().collect();
            let sign = others[(random.next_u64() % others.len() as u64) as usize];
            match random.next_u64() % 3 {
                0 => signs[at] = sign,
                1 => signs.insert(at, sign),
                _ => drop(signs.remove(at)),
            }
        }
        match Scene::read(&signs.iter().collect::<String>()) {
            Ok(scene) if scene.steps < 100 => {
                read += 1;
                assert_eq!(trajectory(&scene).lines().count(), 2 + scene.steps as usize);
            }
            Ok(_) => read += 1,
            Err(error) => write!(text, "{error}").unwrap(),
        }
    }
    assert!(read > 100 && !text.is_empty(), "{read}");
}

#[test]
fn a_full_disk_is_the_caller_s_to_tell() {
    let scene = Scene::read(&good()).unwrap();
    let mut full: &mut [u8] = &mut [0; 40];
    assert!(write_forces(&scene, &mut full).is_err());
}
