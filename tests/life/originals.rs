//! Agents files and trees from outside, through the program.

use crate::socrates;

/// Two people on an open floor, one of them curious.
const AGENTS: &str = "hunav_loader:
  ros__parameters:
    map: hall
    publish_people: true
    agents:
      - walker
      - visitor
    walker:
      id: 1
      skin: 0
      behavior: 1
      group_id: -1
      max_vel: 1.5
      radius: 0.4
      init_pose: {x: 0.0, y: 0.0, z: 1.25, h: 0.0}
      goal_radius: 0.3
      cyclic_goals: true
      goals: [there, here]
      there: {x: 8.0, y: 0.0, h: 0.0}
      here: {x: 0.0, y: 0.0, h: 0.0}
    visitor:
      id: 2
      skin: 1
      behavior: 5
      group_id: -1
      max_vel: 1.2
      radius: 0.4
      init_pose: {x: 4.0, y: 5.0, z: 1.25, h: -1.57}
      goal_radius: 0.3
      cyclic_goals: false
      goals: [over]
      over: {x: 4.0, y: -5.0, h: 0.0}
";

#[test]
fn an_agents_file_is_run_and_its_slips_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("hall.yaml"), AGENTS).unwrap();
    let run = |name: &str, more: &[&str]| {
        let out = format!("out-{name}");
        let mut args = vec!["--format", "json", "simulate", "hall.yaml", "--duration", "20", "--out", &out];
        args.extend(more);
        let finished = socrates(folder.path(), name, &args);
        assert_eq!(finished.code, 0, "{}", finished.err);
        finished.json()
    };
    let (first, again) = (run("first", &["--robot", "2,1,0;6,1"]), run("again", &["--robot", "2,1,0;6,1"]));
    assert_eq!(first["recording_hash"], again["recording_hash"]);
    assert_eq!(first["contacts"], 0);
    assert!(folder.path().join("out-first/recording.mcap").is_file());
    let upstream = run("upstream", &["--profile", "hunav-1.0", "--robot", "2,1,0;6,1"]);
    assert_ne!(first["recording_hash"], upstream["recording_hash"]);
    let mixed = run("mixed", &["--model", "1=orca"]);
    assert_ne!(first["recording_hash"], mixed["recording_hash"]);
    let scored = socrates(folder.path(), "score", &["score", "out-first/recording.mcap"]);
    assert_eq!(scored.code, 0, "{}", scored.err);

    for version in ["1.0", "1.1", "2.0"] {
        let out = format!("as-{version}.yaml");
        let written = socrates(folder.path(), version, &["dev", "agents", "hall.yaml", "--to", version, "--out", &out]);
        assert_eq!(written.code, 0, "{version}: {}", written.err);
        let read = socrates(folder.path(), "again", &["dev", "agents", &out]);
        assert!(read.code == 0 && read.out.contains(version), "{version}: {}{}", read.out, read.err);
    }

    let wrong = AGENTS
        .replace("radius: 0.4\n      init_pose: {x: 0.0", "radius: -1.0\n      init_pose: {x: 0")
        .replace("id: 2", "id: 1");
    std::fs::write(folder.path().join("wrong.yaml"), wrong).unwrap();
    let finished = socrates(folder.path(), "wrong", &["simulate", "wrong.yaml"]);
    assert_eq!(finished.code, 2, "{}", finished.out);
    for word in ["wrong.yaml", "walker.radius", "-1", "walker.init_pose.x", "id", "hint:"] {
        assert!(finished.err.contains(word), "`{word}` is missing in\n{}", finished.err);
    }
    for (name, args) in [
        ("profile", ["--profile", "hunav-9"]),
        ("model", ["--model", "1=telepathy"]),
        ("robot", ["--robot", "here"]),
        ("map", ["--map", "nowhere.yaml"]),
    ] {
        let finished = socrates(folder.path(), name, &["simulate", "hall.yaml", args[0], args[1]]);
        assert_eq!(finished.code, 2, "{name}: {}", finished.err);
        assert!(finished.err.contains(args[1]) || finished.err.contains("hint:"), "{name}: {}", finished.err);
    }
}

#[test]
fn a_tree_is_checked_drawn_and_converted() {
    let folder = tempfile::tempdir().unwrap();
    let tree = r#"<root main_tree_to_execute="Main"><BehaviorTree ID="Main"><Fallback name="either">
  <Sequence name="meet"><IsRobotVisible agent_id="{id}" distance="4"/><LookAtRobot agent_id="{id}"/></Sequence>
  <RegularNav agent_id="{id}" time_step="{dt}"/>
</Fallback></BehaviorTree></root>"#;
    std::fs::write(folder.path().join("good.xml"), tree).unwrap();
    let good = socrates(folder.path(), "good", &["bt", "check", "good.xml"]);
    assert_eq!(good.code, 0, "{}\n{}", good.out, good.err);
    let shown = socrates(folder.path(), "show", &["bt", "show", "good.xml"]);
    assert!(shown.out.contains("IsRobotVisible") && shown.out.contains("└─"), "{}", shown.out);
    let drawn = socrates(folder.path(), "draw", &["bt", "show", "good.xml", "-o", "good.png"]);
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    assert!(std::fs::read(folder.path().join("good.png")).unwrap().starts_with(&[0x89, b'P', b'N', b'G']));
    let converted = socrates(folder.path(), "convert", &["bt", "convert", "good.xml", "--to", "v4", "-o", "v4.xml"]);
    assert_eq!(converted.code, 0, "{}", converted.err);
    assert!(std::fs::read_to_string(folder.path().join("v4.xml")).unwrap().contains("BTCPP_format=\"4\""));
    assert_eq!(socrates(folder.path(), "v4", &["bt", "check", "v4.xml"]).code, 0);

    std::fs::write(
        folder.path().join("bad.xml"),
        tree.replace("LookAtRobot", "LookAtRobt").replace("\"4\"", "\"far\""),
    )
    .unwrap();
    let bad = socrates(folder.path(), "bad", &["bt", "check", "bad.xml"]);
    assert_eq!(bad.code, 2);
    for word in ["bad.xml", "2:", "LookAtRobt", "LookAtRobot", "far", "hint:"] {
        assert!(bad.err.contains(word), "`{word}` is missing in\n{}", bad.err);
    }
}
