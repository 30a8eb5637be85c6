//! Robots and people that programs in another language drive: the examples, a Gymnasium environment, and drivers that fail.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use socrates_tests::program::{poll, signal, start};
use socrates_tests::{root, skip};

use super::python::python;
use crate::{PROGRAM, WAREHOUSE, make, socrates};

const PACKAGES: [&str; 2] = ["eclipse-zenoh==1.10.2", "gymnasium==1.4.0"];

/// A Python that can drive; where there is none, the running test is left out.
#[track_caller]
fn driving() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    skip::installed(PLACE.get_or_init(|| python("drivers", &PACKAGES, "import zenoh, gymnasium")).clone())
}

fn example(name: &str) -> String {
    root().join("deploy/python/examples").join(name).display().to_string()
}

/// A driver of which only what it does with a step is written down.
fn driver(folder: &Path, act: &str) -> String {
    let file = folder.join("driver.py");
    let place = root().join("deploy/python");
    let text = format!(
        "import os, sys\nsys.path.insert(0, {:?})\nfrom socrates_env import Command, Driver\n{act}\nDriver('mine', act).run()\n",
        place.display().to_string()
    );
    std::fs::write(&file, text).unwrap();
    file.display().to_string()
}

#[test]
fn the_example_planner_drives_two_scenarios_and_they_are_played_again_without_it() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    let requests = folder.path().join("requests");
    std::fs::create_dir(&requests).unwrap();
    let office = WAREHOUSE.replace("warehouse", "office").replace("loading dock", "open-plan area");
    std::fs::write(requests.join("one.toml"), WAREHOUSE).unwrap();
    std::fs::write(requests.join("two.toml"), office.replace("packing area", "reception area")).unwrap();
    let drives = format!("{} {}", python.display(), example("planner.py"));
    let args =
        ["run", "requests", "--out", "both", "--require", "any", "--planner", "external:example", "--driver", &drives];
    let run = socrates(folder.path(), "run", &args);
    assert_eq!(run.code, 0, "{} {}", run.out, run.err);
    for name in ["one-1", "two-1"] {
        let bundle = folder.path().join("both").join(name);
        let report = std::fs::read_to_string(bundle.join("details/reports/external.example-1.json")).unwrap();
        let report: Value = serde_json::from_str(&report).unwrap();
        assert!(report["robot_text"].as_str().unwrap().starts_with("arrived"), "{name}: {}", report["robot_text"]);
        let again = socrates(folder.path(), name, &["simulate", &bundle.display().to_string()]);
        assert_eq!(again.code, 0, "{}", again.err);
        assert!(again.out.contains("simulated  external:example seed 1"), "{}", again.out);
        assert_eq!(again.out.matches("same hash as the bundle").count(), 2, "{}", again.out);
    }
}

#[test]
fn a_driver_that_fails_ends_its_own_run_alone() {
    let Some(python) = driving() else { return };
    for (name, act, said) in [
        ("nan", "def act(step, mission):\n    return float('nan'), 0.0", "`v` is NaN"),
        ("raises", "def act(step, mission):\n    return 1 / 0, 0.0", "the driver gives up: ZeroDivisionError"),
        (
            "dies",
            "def act(step, mission):\n    os._exit(3) if step.call == 30 else None\n    return 0.3, 0.0",
            "at 3.00 s: it is gone",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let drives = format!("{} {}", python.display(), driver(folder.path(), act));
        let more = ["--require", "any", "--planner", "external:mine,reactive", "--driver", &drives];
        let (run, json) = make(folder.path(), name, WAREHOUSE, &more);
        // The other runs are there, and the code says that not all are.
        assert_eq!(run.code, 3, "{name}: {} {}", run.out, run.err);
        let runs: Vec<&str> =
            json["runs"].as_array().unwrap().iter().map(|run| run["planner"].as_str().unwrap()).collect();
        assert_eq!(runs, ["reference", "reactive"], "{name}");
        let failed = &json["failed"][0];
        assert_eq!(
            (failed["run"].as_str(), failed["faults"][0]["code"].as_str()),
            (Some("external.mine-1"), Some("J-DRIVER"))
        );
        assert!(failed["faults"][0]["message"].as_str().unwrap().contains(said), "{name}: {failed}");
    }
}

#[test]
fn a_driver_that_dies_in_every_run_is_there_again_for_the_next_and_one_that_never_drives_is_not() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    let act = "def act(step, mission):\n    os._exit(3) if step.call == 5 else None\n    return 0.3, 0.0";
    let drives = format!("{} {}", python.display(), driver(folder.path(), act));
    let more = ["--require", "any", "--seeds", "1..4", "--planner", "external:mine", "--driver", &drives];
    let (run, json) = make(folder.path(), "dies", WAREHOUSE, &more);
    assert_eq!(run.code, 3, "{} {}", run.out, run.err);
    let failed: Vec<&str> = json["failed"].as_array().unwrap().iter().map(|run| run["run"].as_str().unwrap()).collect();
    assert_eq!(failed, ["external.mine-1", "external.mine-2", "external.mine-3", "external.mine-4"]);
    let gone =
        |run: &Value| run["faults"][0]["message"].as_str().is_some_and(|why| why.contains("at 0.50 s: it is gone"));
    assert!(json["failed"].as_array().unwrap().iter().all(gone), "{}", json["failed"]);

    let none = format!("{} nowhere.py", python.display());
    let more = ["--require", "any", "--planner", "external:mine", "--driver", &none];
    let (run, _) = make(folder.path(), "none", WAREHOUSE, &more);
    assert_eq!(run.code, 2, "{} {}", run.out, run.err);
    assert!(run.err.contains("ends by itself (exit status: 2)"), "{}", run.err);
}

/// The person who walks toward the robot, moved by a driver of this name.
fn with_person(driver: &str) -> String {
    format!("{WAREHOUSE}\n[people]\nhuman_1 = \"external:{driver}\"\n")
}

/// Where the first person is in the run of the reference robot, and the leaf that they are in.
fn first_person(bundle: &Path) -> (Vec<(f64, f64)>, Vec<String>) {
    let text = std::fs::read_to_string(bundle.join("agents.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let column = |name: &str| head.iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
    let (planner, id, x, y, leaf) = (column("planner"), column("id"), column("x"), column("y"), column("leaf"));
    let rows: Vec<_> = lines.filter(|row| (row[planner], row[id]) == ("reference", "human_1")).collect();
    let places = rows.iter().map(|row| (row[x].parse().unwrap(), row[y].parse().unwrap())).collect();
    let mut leaves: Vec<String> = rows.iter().map(|row| row[leaf].to_owned()).collect();
    leaves.dedup();
    (places, leaves)
}

#[test]
fn the_example_person_walks_in_every_run_of_a_scenario_and_they_are_played_again_without_it() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    let drives = format!("{} {}", python.display(), example("person.py"));
    let more = ["--require", "any", "--planner", "reactive", "--driver", &drives];
    let (run, json) = make(folder.path(), "person", &with_person("person"), &more);
    assert_eq!(run.code, 0, "{} {}", run.out, run.err);
    assert_eq!(json["runs"].as_array().map(Vec::len), Some(2), "{json}");
    let bundle = folder.path().join("bundle-person");
    let told = |run: &str| {
        let text = std::fs::read_to_string(bundle.join(format!("details/commands/{run}.json"))).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()
    };
    for run in ["reference-1", "reactive-1"] {
        let told = told(run);
        assert_eq!((told.get("rate_hz"), told.get("commands")), (None, None), "{run}: nobody outside drives the robot");
        let people = told["people"].as_object().unwrap();
        let commands = people["human_1"]["commands"].as_array().unwrap();
        assert!(people.len() == 1 && commands.len() > 50, "{run}: {}", commands.len());
        let stood = commands.iter().filter(|command| command["waiting"] == true).count();
        // The other planner may keep farther off.
        let stops = stood > 0 || run != "reference-1";
        assert!(stops && stood < commands.len(), "{run}: they stop for the robot, {stood} of {}", commands.len());
    }
    let (places, leaves) = first_person(&bundle);
    assert_eq!(leaves, ["external"]);
    let (from, to) = (places[0], places[places.len() - 1]);
    assert!((to.0 - from.0).hypot(to.1 - from.1) > 3.0, "{from:?} {to:?}");
    let again = socrates(folder.path(), "again", &["simulate", &bundle.display().to_string()]);
    assert_eq!(again.code, 0, "{} {}", again.out, again.err);
    assert_eq!(again.out.matches("same hash as the bundle").count(), 2, "{}", again.out);
    // Another run cannot be played without it.
    let other = socrates(folder.path(), "other", &["simulate", &bundle.display().to_string(), "--planner", "rpp"]);
    assert_eq!(other.code, 2, "{} {}", other.out, other.err);
    assert!(other.err.contains("a driver outside drives in rpp-1"), "{}", other.err);
}

#[test]
fn one_program_drives_the_robot_and_a_person_of_one_run() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    let act = "sys.path.insert(0, os.environ['EXAMPLES'])\nimport person, planner\n\
               def act(step, mission):\n    return (person if mission.person else planner).act(step, mission)";
    let text = driver(folder.path(), act);
    let drives = format!("env EXAMPLES={} {} {text}", example(""), python.display());
    let more = ["--require", "any", "--planner", "external:mine", "--driver", &drives];
    let (run, json) = make(folder.path(), "both", &with_person("mine"), &more);
    assert_eq!(run.code, 0, "{} {}", run.out, run.err);
    assert_eq!(json["runs"].as_array().map(Vec::len), Some(2), "{json}");
    let bundle = folder.path().join("bundle-both");
    let told = std::fs::read_to_string(bundle.join("details/commands/external.mine-1.json")).unwrap();
    let told: Value = serde_json::from_str(&told).unwrap();
    let count = |commands: &Value| commands.as_array().map_or(0, Vec::len);
    assert!(count(&told["commands"]) > 50, "the robot");
    assert_eq!(count(&told["people"]["human_1"]["commands"]), count(&told["commands"]), "and the person, as often");
    let again = socrates(folder.path(), "again", &["simulate", &bundle.display().to_string()]);
    assert_eq!(again.out.matches("same hash as the bundle").count(), 2, "{} {}", again.out, again.err);
}

#[test]
fn a_driver_of_a_person_that_dies_ends_each_run_with_the_person_and_the_time() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    let act = "def act(step, mission):\n    os._exit(3) if step.call == 30 else None\n    return 0.3, 0.0, 0.0";
    let drives = format!("{} {}", python.display(), driver(folder.path(), act));
    let (run, json) = make(folder.path(), "dies", &with_person("mine"), &["--require", "any", "--driver", &drives]);
    assert_ne!(run.code, 0, "{} {}", run.out, run.err);
    let all = format!("{json} {} {}", run.out, run.err);
    assert!(all.contains("J-DRIVER") && all.contains("driver mine of human_1"), "{all}");
    assert!(all.contains("at 3.00 s: it is gone"), "{all}");
}

#[test]
fn a_driver_is_checked_message_by_message() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    let person = format!("{} {}", python.display(), example("person.py"));
    let checked = socrates(folder.path(), "person", &["drive", "check", "person", "--driver", &person]);
    assert_eq!((checked.code, checked.out.matches("ok  ").count()), (0, 14), "{} {}", checked.out, checked.err);
    let good = format!("{} {}", python.display(), example("planner.py"));
    let checked = socrates(folder.path(), "good", &["drive", "check", "example", "--driver", &good]);
    assert_eq!(checked.code, 0, "{} {}", checked.out, checked.err);
    assert_eq!(
        (checked.out.matches("ok  ").count(), checked.out.matches("FAILED").count()),
        (14, 0),
        "{}",
        checked.out
    );
    // Answers to the step before.
    let act = "def act(step, mission):\n    return Command(v=float('inf'))";
    let bad = format!("{} {}", python.display(), driver(folder.path(), act));
    let checked = socrates(folder.path(), "bad", &["drive", "check", "mine", "--driver", &bad]);
    assert_eq!(checked.code, 2, "{} {}", checked.out, checked.err);
    assert!(checked.out.contains("FAILED     answers a step with 1 person"), "{}", checked.out);
    assert!(checked.err.contains("the driver `mine` fails"), "{}", checked.err);
}

/// Ends what serves when the test ends.
struct Served(Child);

impl Drop for Served {
    fn drop(&mut self) {
        drop(signal(self.0.id(), "TERM"));
        drop(self.0.wait());
    }
}

const EPISODES: &str = r"
import sys, warnings
sys.path[:0] = [sys.argv[1], sys.argv[1] + '/examples']
from gymnasium.utils.env_checker import check_env
from socrates_env import SocratesEnv
from gym_policy import episode, policy

env = SocratesEnv(place=sys.argv[2], lidar=True)
with warnings.catch_warnings():
    # Recommendations about the form of spaces are none of its findings.
    warnings.simplefilter('ignore')
    check_env(env, skip_render_check=True)
env.close()

def trail(seed):
    env = SocratesEnv(place=sys.argv[2])
    seen, info = env.reset(seed=seed)
    places, over = [tuple(seen['robot'])], False
    while not over:
        seen, _, terminated, truncated, info = env.step(policy(seen))
        places.append(tuple(seen['robot']))
        over = terminated or truncated
    env.close()
    return places, info['end']

one, ended = trail(5)
two, _ = trail(5)
assert len(one) > 100 and one == two, (len(one), len(two))
assert ended['arrived'], ended
env = SocratesEnv(place=sys.argv[2])
try:
    env.reset(seed=1, options={'scenario': 'nowhere'})
except ValueError as why:
    assert 'there is no scenario `nowhere`; served: shop' in str(why), why
else:
    raise AssertionError('a scenario that is not served was begun')
env.close()
print('fine')
";

#[test]
fn the_gymnasium_environment_passes_its_checker_and_the_same_seed_gives_the_same_trajectory() {
    let Some(python) = driving() else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("shop.toml"), WAREHOUSE).unwrap();
    let served = start(PROGRAM, &["serve", "shop.toml", "--out", "served"], folder.path(), "serve").unwrap();
    let _served = Served(served);
    let endpoint = folder.path().join("served/.socrates/endpoint");
    poll(|| endpoint.is_file().then_some(())).unwrap();
    let place = folder.path().join("served");
    let out = Command::new(python)
        .args(["-c", EPISODES])
        .arg(root().join("deploy/python"))
        .arg(place)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    assert_eq!(String::from_utf8_lossy(&out.stdout).trim(), "fine");
}
