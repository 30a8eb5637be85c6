//! Bags of ROS 2 through the program: good ones, and everything that can be wrong with one.

use std::path::Path;

use crate::socrates;
use socrates_tests::root;

/// A bag that rosbags wrote, uncompressed: two seconds of HuNavSim.
fn sample() -> Vec<u8> {
    std::fs::read(root().join("bus/stream/tests/data/hunav.mcap")).unwrap()
}

/// Writes a bag's folder; `lines` come behind the version.
fn bag(folder: &Path, name: &str, lines: &str, files: &[(&str, &[u8])]) {
    let at = folder.join(name);
    std::fs::create_dir_all(&at).unwrap();
    if !lines.is_empty() {
        std::fs::write(at.join("metadata.yaml"), format!("rosbag2_bagfile_information:\n  version: 9\n{lines}"))
            .unwrap();
    }
    for (file, bytes) in files {
        std::fs::write(at.join(file), bytes).unwrap();
    }
}

const MCAP: &str = "  storage_identifier: mcap\n  relative_file_paths: ";

#[test]
fn a_bag_is_scored_by_its_folder_with_a_page_and_its_tracks() {
    let folder = tempfile::tempdir().unwrap();
    bag(folder.path(), "run", &format!("{MCAP}[run_0.mcap]\n"), &[("run_0.mcap", &sample())]);
    let args = ["score", "run", "--goal", "2,7", "--out", "scored"];
    let scored = socrates(folder.path(), "scored", &args);
    assert_eq!(scored.code, 0, "{}", scored.err);
    for what in ["human_distance_min", "robot: `/robot_states`", "people: `/human_states`", "scored/tracks.csv"] {
        assert!(scored.out.contains(what), "{what}: {}", scored.out);
    }
    let page = std::fs::read_to_string(folder.path().join("scored/report.html")).unwrap();
    assert!(page.contains("id=\"play\""));
    let tracks = std::fs::read_to_string(folder.path().join("scored/tracks.csv")).unwrap();
    assert!(tracks.starts_with("t,id,x,y,yaw,group,goal_x,goal_y\n") && tracks.contains(",ann,3.000000,9.000000,"));
    // Flags of tables are none of a bag's, and the other way round.
    let planner = socrates(folder.path(), "planner", &["score", "run", "--planner", "mine"]);
    assert!(planner.code == 2 && planner.err.contains("holds one run"), "{}", planner.err);
    let people = socrates(folder.path(), "people", &["score", "scored/tracks.csv", "--people", "/people"]);
    assert!(people.code == 2 && people.err.contains("no bag of ROS 2"), "{}", people.err);
}

#[test]
fn wrong_bags_are_refused_with_file_value_and_hint() {
    let folder = tempfile::tempdir().unwrap();
    let good = sample();
    let named = format!("{MCAP}[run_0.mcap]\n");
    let mut long = good.clone();
    // The name of the frame of the first transform, whose length stands before it.
    let at = good.windows(15).position(|bytes| bytes == b"base_footprint\0").unwrap() - 4;
    long[at..at + 4].copy_from_slice(&[0xff; 4]);
    bag(folder.path(), "gone", &named, &[]);
    bag(folder.path(), "cut", &named, &[("run_0.mcap", &good[..good.len() / 2])]);
    bag(folder.path(), "empty", &named, &[("run_0.mcap", b"")]);
    bag(folder.path(), "text", &named, &[("run_0.mcap", b"not a recording")]);
    bag(folder.path(), "lite", "  storage_identifier: sqlite3\n  relative_file_paths: [a.db3]\n", &[]);
    bag(folder.path(), "out", &format!("{MCAP}[../../etc/passwd]\n"), &[]);
    bag(folder.path(), "yaml", "- {", &[]);
    bag(folder.path(), "bare", "", &[("run_0.mcap", &good)]);
    std::fs::write(folder.path().join("a.db3"), b"SQLite format 3\0 and more").unwrap();
    std::fs::write(folder.path().join("a.bag"), b"#ROSBAG V2.0\n").unwrap();
    std::fs::write(folder.path().join("a.mcap.zstd"), b"\x28\xb5\x2f\xfd and more").unwrap();
    for (what, words) in [
        ("gone", ["gone/metadata.yaml", "`run_0.mcap`, which is not there", "reindex gone"]),
        ("empty", ["empty/run_0.mcap", "ended in the middle", "mcap recover"]),
        ("text", ["text/run_0.mcap", "no MCAP file", "ros2 bag record -s mcap"]),
        ("lite", ["lite/metadata.yaml", "`sqlite3`", "ros2 bag convert"]),
        ("out", ["out/metadata.yaml", "`../../etc/passwd`", "reindex"]),
        ("yaml", ["yaml/metadata.yaml", "no metadata", "reindex"]),
        ("bare", ["`bare`", "run_0.mcap", "ros2 bag reindex bare"]),
        ("a.db3", ["`a.db3`", "`sqlite3`", "rosbags-convert"]),
        ("a.bag", ["`a.bag`", "ROS 1", "rosbags-convert"]),
        ("a.mcap.zstd", ["`a.mcap.zstd`", "compressed", "zstd -d a.mcap.zstd"]),
    ] {
        let refused = socrates(folder.path(), "refused", &["score", what]);
        assert_eq!(refused.code, 2, "{what}: {}\n{}", refused.err, refused.out);
        for word in words.iter().chain(&["hint:"]) {
            assert!(refused.err.to_lowercase().contains(&word.to_lowercase()), "{what}: `{word}` in\n{}", refused.err);
        }
    }
    let cut = socrates(folder.path(), "cut", &["score", "cut"]);
    assert!(cut.code == 0 && cut.out.contains("`cut/run_0.mcap` is cut off or damaged"), "{}\n{}", cut.err, cut.out);
    // One message that claims a text of four gigabytes is left out, and told.
    std::fs::write(folder.path().join("long.mcap"), long).unwrap();
    let told = socrates(folder.path(), "long", &["score", "long.mcap"]);
    assert!(told.code == 0 && told.out.contains("claims 4294967295 bytes"), "{}\n{}", told.err, told.out);
}
