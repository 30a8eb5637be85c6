//! Trees that the other simulators ship, and trees of our own in their style: each loads and runs in its library, or is refused for
//! the known reason.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::Room;
use socrates_bt::{Format, Library, Meaning, Options, Tree, analyze, convert, decode, draw_svg, draw_text};
use socrates_model::{Fault, FaultCode};
use socrates_tests::skip::shared;

/// Folders, their library, and the trees in them that cannot load there: code of the fault and the words in it.
type Folder = (&'static str, Library, &'static [(&'static str, FaultCode, &'static str)]);

const FOLDERS: &[Folder] = &[
    ("hunav_sim_v1_0", Library::HunavSim1_0, &[]),
    ("hunav_sim_v1_1", Library::HunavSim1_1, &[]),
    (
        "hunav_sim_fork",
        Library::SocratesFork,
        &[
            ("LLMBT_3.xml", FaultCode::BNode, "`HasRobotMoved`"),
            ("LLMBT_4.xml", FaultCode::BPort, "no attribute `t`"),
            ("BTScaredNav.xml", FaultCode::BNode, "`AvoidRobot`"),
            ("BTSurprisedNav.xml", FaultCode::BNode, "`SurprisedNav`"),
            ("BTThreateningNav.xml", FaultCode::BNode, "`ThreateningNav`"),
        ],
    ),
    ("isaac_wrapper_v2", Library::HunavSim2, &[]),
];

/// Our own; `tests/data/simulators/README.md` says why each is as it is.
const OWN: &[Folder] = &[
    ("hunav_1_0", Library::HunavSim1_0, &[]),
    ("hunav_1_1", Library::HunavSim1_1, &[]),
    (
        "fork",
        Library::SocratesFork,
        &[
            ("absent_node.xml", FaultCode::BNode, "`SurprisedNav`"),
            ("absent_port.xml", FaultCode::BPort, "no attribute `t`"),
        ],
    ),
    ("hunav_2", Library::HunavSim2, &[]),
];

/// Trees in which nobody moves in a room where the robot says nothing.
const STILL: [&str; 3] = ["LLMBT_0.xml", "LLMBT_2.xml", "waves.xml"];

fn trees(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ext| ext == "xml"));
    files.sort();
    assert!(!files.is_empty(), "no tree in {}", folder.display());
    files
}

#[track_caller]
fn folder(name: &str) -> Option<Vec<PathBuf>> {
    shared(&format!("socrates_hunav/{name}/behavior_trees")).map(|folder| trees(&folder))
}

fn own(name: &str) -> Vec<PathBuf> {
    trees(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/simulators").join(name))
}

fn read(file: &Path, library: Library, meaning: Meaning) -> Result<Tree, Vec<Fault>> {
    let bytes = fs::read(file).unwrap();
    let find = |name: &str| fs::read_to_string(file.parent()?.join(name)).ok();
    let text = decode(&bytes).map_err(|fault| vec![fault])?;
    Tree::parse_with(text, &Options { includes: Some(&find), library, meaning, ..Options::default() })
}

#[test]
fn every_shipped_tree_runs_in_its_library_or_is_refused_for_the_known_reason() {
    for of in FOLDERS {
        if let Some(files) = folder(of.0) {
            each_runs_or_is_refused(&files, of);
        }
    }
}

#[test]
fn every_tree_of_our_own_runs_in_its_library_or_is_refused_for_the_known_reason() {
    for of in OWN {
        let files = own(of.0);
        assert!(files.len() >= 2, "{files:?}");
        each_runs_or_is_refused(&files, of);
    }
}

/// Reads, ticks, draws and converts each of the trees of a folder.
fn each_runs_or_is_refused(files: &[PathBuf], (name, library, refused): &Folder) {
    let entries: BTreeMap<String, String> = [
        ("id", "1"),
        ("dt", "0.01"),
        ("dist", "3.0"),
        ("duration", "1.0"),
        ("once", "true"),
        ("stopdist", "1.5"),
        ("maxvel", "0.6"),
        ("forcefactor", "20.0"),
        ("frontdist", "1.4"),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value.to_owned()))
    .collect();
    for file in files {
        let file_name = file.file_name().unwrap().to_string_lossy().into_owned();
        let tree = match (read(file, *library, Meaning::World), refused.iter().find(|(bad, ..)| *bad == file_name)) {
            (Ok(tree), None) => tree,
            (Err(faults), Some((_, code, words))) => {
                let told = faults.iter().any(|fault| fault.code == *code && fault.message.to_string().contains(words));
                assert!(told, "{name}/{file_name}: {faults:#?}");
                continue;
            }
            (Ok(_), Some(_)) => panic!("{name}/{file_name} was taken"),
            (Err(faults), None) => panic!("{name}/{file_name}: {faults:#?}"),
        };
        let mut state = tree.start_with(&entries);
        let mut acts = 0;
        for tick in 0..500_u32 {
            let mut room = Room { distance_m: Some(2.0), visible: tick % 100 < 50, ..Room::default() };
            acts += room.tick(&tree, &mut state).len();
        }
        assert_eq!(acts > 0, !STILL.contains(&file_name.as_str()), "{name}/{file_name}");
        assert_eq!(draw_text(&tree).lines().count(), tree.node_names().len() + 1);
        assert!(draw_svg(&tree).contains("</svg>"));
        assert_eq!(analyze(&tree).double_motion, [], "{name}/{file_name}");
        for format in [Format::V3, Format::V4] {
            let (_, notes) = convert(&tree, format, *library);
            assert!(format != tree.format() || notes.is_empty(), "{name}/{file_name}: {notes:#?}");
        }
    }
}

#[test]
fn a_native_run_of_a_tree_with_global_goals_is_refused_by_name() {
    for file in own("hunav_2").into_iter().chain(folder("isaac_wrapper_v2").into_iter().flatten()) {
        let is_patrol = fs::read_to_string(&file).unwrap().contains("<SetGoal ");
        match read(&file, Library::HunavSim2, Meaning::Native) {
            Ok(_) => assert!(!is_patrol, "{} was taken", file.display()),
            Err(faults) => {
                assert!(is_patrol, "{}: {faults:#?}", file.display());
                assert!(faults.iter().all(|fault| fault.message.to_string().contains("`SetGoal`")), "{faults:#?}");
            }
        }
    }
}

#[test]
fn trees_of_version_1_1_are_refused_by_version_1_0_where_they_use_its_new_ports() {
    for file in own("hunav_1_1").into_iter().chain(folder("hunav_sim_v1_1").into_iter().flatten()) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let has_new_ports = ["inquisitive", "Curious", "Scared", "Threatening"].iter().any(|kind| name.contains(kind));
        assert_eq!(read(&file, Library::HunavSim1_0, Meaning::World).is_err(), has_new_ports, "{name}");
    }
}
