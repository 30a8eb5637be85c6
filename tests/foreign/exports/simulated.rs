//! A simulator of others runs an exported scenario: everybody begins, waits and ends where the scenario says.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use socrates_tests::skip;

use super::{export, requests};
use crate::foreign::python::python;
use crate::make;

/// The simulator.
pub(super) const SIMULATORS: [&str; 1] = ["jupedsim-scenarios==0.7.4"];
/// Formats that it runs.
pub(super) const FORMATS: [&str; 1] = ["jupedsim-scenarios-0.7"];

/// The program of a package: its exit code and what it says.
fn run(python: &Path, folder: &Path) -> (i32, Value) {
    let out = Command::new(python).arg("run.py").current_dir(folder).stdin(Stdio::null()).output().unwrap();
    let said = serde_json::from_slice(&out.stdout)
        .unwrap_or_else(|why| panic!("{why}: {}", String::from_utf8_lossy(&out.stderr)));
    (out.status.code().unwrap(), said)
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn everybody_begins_waits_and_ends_in_the_simulator_where_the_scenario_says() {
    let python = skip::installed(python("scenario-runner", &SIMULATORS, "import jupedsim_scenarios"));
    let Some(python) = python else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut waits = 0;
    for (name, request) in requests() {
        let (made, _) = make(at, name, &request, &[]);
        assert!(matches!(made.code, 0 | 3), "{name}: {}", made.err);
        for format in FORMATS {
            export(at, &format!("bundle-{name}"), format);
            let package = at.join("out").join(format);
            let (code, said) = run(&python, &package);
            assert_eq!(code, 0, "{name}: {said:#}");
            let proposal = json(&at.join(format!("bundle-{name}/details/proposal.json")));
            let people = proposal["humans"].as_array().unwrap().len();
            assert_eq!(
                (said["people"].as_u64(), said["wanted"].as_u64()),
                (Some(people as u64 + 1), said["people"].as_u64())
            );
            let ends = ends(at, name);
            for person in said["tracks"].as_array().unwrap() {
                let who = person["name"].as_str().unwrap();
                let place = |key: &str, axis: usize| person[key][axis].as_f64().unwrap();
                let off = ends[who].iter().map(|end| (place("ended", 1) - end[0]).hypot(place("ended", 2) - end[1]));
                let off = off.fold(f64::INFINITY, f64::min);
                assert!(off <= 1.0, "{name}: {who} ends {off} m from the end of their path and of their run");
                for wait in person["waits"].as_array().unwrap() {
                    assert!(
                        wait["stayed_s"].as_f64().unwrap() >= wait["wanted_s"].as_f64().unwrap() - 0.1,
                        "{name}: {wait}"
                    );
                    waits += 1;
                }
            }
        }
    }
    assert!(waits > 0, "nobody of these scenarios waits, so no wait was looked at");
}

/// Where everybody may end: at the last node of their path, or where they were last in the run.
fn ends(at: &Path, name: &str) -> BTreeMap<String, Vec<[f64; 2]>> {
    let bundle = at.join(format!("bundle-{name}"));
    let (paths, location) = (json(&bundle.join("details/paths.json")), json(&bundle.join("details/location.json")));
    let node = |id: &Value| {
        let nodes = location["graph"]["nodes"].as_array().unwrap();
        let found = nodes.iter().find(|node| node["id"] == *id).unwrap();
        [found["at"][0].as_f64().unwrap(), found["at"][1].as_f64().unwrap()]
    };
    let mut ends = BTreeMap::new();
    let humans = paths["humans"].as_object().unwrap().iter().map(|(who, nodes)| (who.as_str(), nodes));
    for (who, nodes) in humans.chain([("robot", &paths["robot"])]) {
        ends.insert(who.to_owned(), nodes.as_array().unwrap().last().map(node).into_iter().collect::<Vec<_>>());
    }
    let table = std::fs::read_to_string(bundle.join("agents.csv")).unwrap();
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let column = |name: &str| head.iter().position(|other| *other == name).unwrap();
    let (id, x, y, leaf) = (column("id"), column("x"), column("y"), column("leaf"));
    let mut last = BTreeMap::new();
    for row in rows.filter(|row| row[leaf] != "absent") {
        last.insert(row[id].to_owned(), [row[x].parse().unwrap(), row[y].parse().unwrap()]);
    }
    for (who, at) in last {
        ends.entry(who).or_default().push(at);
    }
    ends
}

/// The reader passes over what it does not know in silence: the program of the package must not.
#[test]
fn a_scenario_whose_ways_or_starts_are_lost_ends_with_a_fault() {
    let python = skip::installed(python("scenario-runner", &SIMULATORS, "import jupedsim_scenarios"));
    let Some(python) = python else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (name, request) = requests().swap_remove(0);
    let (made, _) = make(at, name, &request, &[]);
    assert!(matches!(made.code, 0 | 3), "{}", made.err);
    for format in FORMATS {
        export(at, &format!("bundle-{name}"), format);
        let package = at.join("out").join(format);
        let path = package.join("scenario/config.json");
        let good = json(&path);
        let damaged = |change: &dyn Fn(&mut Value)| {
            let mut config = good.clone();
            change(&mut config);
            std::fs::write(&path, config.to_string()).unwrap();
            run(&python, &package)
        };
        let (code, said) = damaged(&|_| {});
        assert_eq!(code, 0, "{said:#}");
        // Nobody comes to their end in a second.
        let (code, said) = damaged(&|config| {
            config["config"]["simulation_settings"]["simulationParams"]["max_simulation_time"] = 1.0.into();
        });
        assert_eq!(code, 1, "{said:#}");
        let (code, said) = damaged(&|config| {
            let far = serde_json::json!([[900.0, 900.0], [901.0, 900.0], [901.0, 901.0], [900.0, 900.0]]);
            config["distributions"]["jps-distributions_1"]["coordinates"] = far;
        });
        assert_eq!(code, 1, "somebody without a start is not missed: {said:#}");
    }
}
