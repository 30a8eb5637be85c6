//! What a library keeps of its bundles: folders, a file each, those that were not realised, or none.

use std::path::Path;

use crate::{WAREHOUSE, socrates};

/// Arguments of the batch: six scenarios of one request, whatever they become.
const BATCH: [&str; 6] = ["hall.toml", "--variants", "6", "--repeats", "--require", "any"];
/// The files of a library without bundles.
const INDEX: [&str; 5] = ["index.csv", "library.json", "planners.csv", "report.html", "scenarios.jsonl.zst"];

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|why| panic!("{}: {why}", folder.display()));
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The batch with these options more, in a folder of this name.
fn made(at: &Path, out: &str, more: &[&str]) {
    let args: Vec<&str> = ["run"].into_iter().chain(BATCH).chain(["--out", out]).chain(more.iter().copied()).collect();
    let made = socrates(at, "made", &args);
    assert_eq!(made.code, 0, "{out}: {}", made.err);
}

/// The table of a library with bundles in folders, as it is where they lie elsewhere or nowhere.
fn table(library: &Path, lies: impl Fn(&str) -> String) -> String {
    let bundles = names(library).into_iter().filter(|name| library.join(name).is_dir());
    bundles.fold(read(&library.join("index.csv")), |text, name| {
        let moved = text.replace(&format!("distinct,{name},"), &format!("distinct,{},", lies(&name)));
        moved.replace(&format!("repeat,{name},"), &format!("repeat,{},", lies(&name)))
    })
}

#[test]
fn packed_bundles_are_read_like_folders_and_become_folders_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    made(at, "folders/library", &[]);
    made(at, "packed/library", &["--keep", "packed"]);
    let (folders, packed) = (at.join("folders/library"), at.join("packed/library"));
    let bundles: Vec<String> = names(&folders).into_iter().filter(|name| folders.join(name).is_dir()).collect();
    assert_eq!(bundles.len(), 6);
    let mut files: Vec<String> = bundles.iter().map(|name| format!("{name}.tar.zst")).collect();
    files.extend(["index.csv", "library.json", "planners.csv", "report.html"].map(str::to_owned));
    files.sort();
    assert_eq!(names(&packed), files);
    assert_eq!(read(&packed.join("index.csv")), table(&folders, |name| format!("{name}.tar.zst")));
    assert_eq!(read(&packed.join("planners.csv")), read(&folders.join("planners.csv")));
    let verified = socrates(at, "verify", &["library", "verify", "packed/library"]);
    assert!(verified.code == 0 && verified.out.contains("6 bundles · 0 wrong"), "{}{}", verified.out, verified.err);
    // Verbs that read a bundle read both forms, by either name.
    let name = &bundles[0];
    for (from, figure) in [
        (format!("folders/library/{name}"), "a.svg"),
        (format!("packed/library/{name}"), "b.svg"),
        (format!("packed/library/{name}.tar.zst"), "c.svg"),
    ] {
        let drawn = socrates(at, "figure", &["figure", &from, "--out", figure]);
        assert_eq!(drawn.code, 0, "{from}: {}", drawn.err);
        assert_eq!(read(&at.join(figure)), read(&at.join("a.svg")), "{from}");
        let scored = socrates(at, "score", &["score", &from]);
        assert_eq!(scored.code, 0, "{from}: {}", scored.err);
    }
    let page = socrates(at, "report", &["report", "packed/library"]);
    assert_eq!(page.code, 0, "{}", page.err);
    assert_eq!(read(&packed.join("index.csv")), table(&folders, |name| format!("{name}.tar.zst")));
    let opened = socrates(at, "open", &["open", &format!("packed/library/{name}")]);
    assert!(opened.code == 0 && opened.out.contains("unpacked"), "{}{}", opened.out, opened.err);
    let manifest = |library: &Path| read(&library.join(name).join("details/manifest.json"));
    assert_eq!(manifest(&packed), manifest(&folders));
    assert_eq!(socrates(at, "whole", &["library", "verify", &format!("packed/library/{name}")]).code, 0);
    // A byte of an archive changes: it is named.
    let other = packed.join(format!("{}.tar.zst", bundles[1]));
    let mut bytes = std::fs::read(&other).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x55;
    std::fs::write(&other, bytes).unwrap();
    let damaged = socrates(at, "damaged", &["library", "verify", "packed/library"]);
    assert!(damaged.code == 2 && damaged.out.contains(&bundles[1]), "{}{}", damaged.out, damaged.err);
}

#[test]
fn a_library_without_bundles_is_five_files_in_one_go_as_in_shards() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    made(at, "folders/library", &[]);
    made(at, "whole/library", &["--keep", "index"]);
    let whole = at.join("whole/library");
    assert_eq!(names(&whole), INDEX);
    assert_eq!(read(&whole.join("index.csv")), table(&at.join("folders/library"), |_| String::new()));
    assert_eq!(read(&whole.join("planners.csv")), read(&at.join("folders/library/planners.csv")));
    for shard in ["0/2", "1/2"] {
        made(at, &format!("shards/{}", &shard[..1]), &["--keep", "index", "--shard", shard]);
    }
    let merged = socrates(at, "merge", &["library", "merge", "shards", "--out", "merged/library"]);
    assert_eq!(merged.code, 0, "{}", merged.err);
    assert_eq!(names(&at.join("merged/library")), INDEX);
    let same = |other: &Path| {
        for file in INDEX {
            assert!(std::fs::read(whole.join(file)).unwrap() == std::fs::read(other.join(file)).unwrap(), "{file}");
        }
    };
    same(&at.join("merged/library"));
    // Page and tables are written anew from the one file.
    let page = socrates(at, "report", &["report", "merged/library"]);
    assert_eq!(page.code, 0, "{}", page.err);
    same(&at.join("merged/library"));
    assert_eq!(socrates(at, "verify", &["library", "verify", "merged/library"]).code, 0);
    let sound = socrates(at, "fsck", &["fsck", "merged/library"]);
    assert_eq!(sound.code, 0, "{}{}", sound.out, sound.err);
    let none = socrates(at, "labels", &["labels", "page", "merged/library", "--out", "labels.html"]);
    assert!(none.code == 2 && none.err.contains("keeps no bundles"), "{}", none.err);
    // Half of the file is gone: nothing is told of a library that is not whole.
    let file = at.join("merged/library/scenarios.jsonl.zst");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let damaged = socrates(at, "damaged", &["library", "verify", "merged/library"]);
    assert!(damaged.code == 2 && damaged.err.contains("scenarios.jsonl.zst"), "{}{}", damaged.out, damaged.err);
}

#[test]
fn those_that_were_not_realised_are_kept_where_that_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    made(at, "library", &["--keep", "failed"]);
    let list: serde_json::Value = serde_json::from_str(&read(&at.join("library/library.json"))).unwrap();
    let rows = list["scenarios"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows {
        let name = row["scenario"].as_str().unwrap();
        let wanted = if row["verdict"] == "realised" { String::new() } else { format!("{name}.tar.zst") };
        assert_eq!(row["bundle"], wanted, "{row}");
        assert_eq!(at.join("library").join(format!("{name}.tar.zst")).is_file(), !wanted.is_empty(), "{row}");
    }
    let one = socrates(at, "one", &["run", "hall.toml", "--keep", "index"]);
    assert!(one.code == 2 && one.err.contains("`--keep`") && one.err.contains("--variants"), "{}", one.err);
    let odd = socrates(at, "odd", &["run", "hall.toml", "--variants", "2", "--keep", "all"]);
    assert!(odd.code == 2 && odd.err.contains("folders, packed, failed, index"), "{}", odd.err);
}

#[test]
fn a_scenario_that_could_not_be_made_leaves_what_makes_it_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let args = ["run", "hall.toml", "--variants", "2", "--repeats", "--inject", "gdisc=1", "--out", "library"];
    let made = socrates(at, "made", &args);
    assert_eq!(made.code, 3, "{}", made.err);
    let dead = names(&at.join("library/failed"));
    assert_eq!(dead.len(), 2, "{dead:?}");
    for name in &dead {
        let left = at.join("library/failed").join(name);
        assert_eq!(names(&left), ["details", "request.toml", "why.txt"]);
        let provenance: serde_json::Value = serde_json::from_str(&read(&left.join("details/provenance.json"))).unwrap();
        assert!(provenance["jobs"].as_array().is_some_and(|jobs| !jobs.is_empty()), "{provenance}");
        // The command makes the same scenario, which fails in the same way.
        let why = read(&left.join("why.txt"));
        let command = why.lines().find_map(|line| line.trim().strip_prefix("socrates run ")).unwrap();
        assert!(why.contains("G-DISC"), "{why}");
        let again: Vec<&str> = ["run"].into_iter().chain(command.split(' ')).chain(["--out", "again"]).collect();
        let again = socrates(at, "again", &again);
        assert!(again.code == 3 && again.err.contains("G-DISC"), "{command}: {}", again.err);
        std::fs::remove_dir_all(at.join("again")).unwrap();
    }
    // Shards bring theirs along.
    for shard in ["0/2", "1/2"] {
        let out = format!("shards/{}", &shard[..1]);
        let args = [&args[..7], &["--shard", shard, "--out", out.as_str()]].concat();
        assert_eq!(socrates(at, "shard", &args).code, 3);
    }
    let merged = socrates(at, "merge", &["library", "merge", "shards", "--out", "merged"]);
    assert_eq!(names(&at.join("merged/failed")), dead, "{}", merged.err);
}
