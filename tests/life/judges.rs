//! Blind judgments: the page, the stills and the texts for judges, and what their answers are worth.

use std::collections::BTreeMap;
use std::path::Path;

use crate::{WAREHOUSE, make, socrates};

/// A seed that stands nowhere by chance.
const SEED: &str = "90417";
const FORM: &str = r#"
location = "hospital"
social_context = ""
task = "Take the elevator to another floor"

[[human]]
count = 2
role = "visitor"
relation = "leaving"
place = "elevator"
"#;

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&text(path)).unwrap()
}

/// The lines of the key by name: bundle, run, recording, control.
fn key(path: &Path) -> BTreeMap<String, Vec<String>> {
    let rows = text(path)
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>())
        .collect::<Vec<_>>();
    rows.into_iter().map(|row| (row[0].clone(), row[1..].to_vec())).collect()
}

/// Two bundles to be judged, one of texts and one of a form, and a folder with one to be mixed in.
fn bundles(folder: &Path) {
    for (name, request, more) in [
        ("texts", WAREHOUSE, vec!["--planner", "reference,reactive"]),
        ("form", FORM, vec![]),
        ("spoiled", &WAREHOUSE.replace("follows", "crosses before"), vec![]),
    ] {
        let args: Vec<&str> = ["--require", "any", "--seed", SEED].into_iter().chain(more).collect();
        let (finished, _) = make(folder, name, request, &args);
        assert_eq!(finished.code, 0, "{}", finished.err);
    }
}

fn page(folder: &Path, out: &str, more: &[&str]) -> serde_json::Value {
    let args = [
        "--format",
        "json",
        "labels",
        "page",
        "bundle-texts",
        "bundle-form",
        "--films",
        "--mixed-in",
        "bundle-spoiled",
    ];
    let args: Vec<&str> = args.into_iter().chain(["--stills", "4", "--out", out]).chain(more.iter().copied()).collect();
    let finished = socrates(folder, "page", &args);
    assert_eq!(finished.code, 0, "{}", finished.err);
    finished.json()
}

/// What a judge is given must not tell where a run is from: these words stand in none of it.
fn hidden(folder: &Path) -> Vec<String> {
    let verdicts = ["realised", "not_triggered", "contradicted", "robot_prevented"];
    let mut words: Vec<String> = verdicts.map(str::to_owned).to_vec();
    words.extend(["reference-", "reactive", SEED, "bundle-", "texts-", "spoiled", "clause"].map(str::to_owned));
    for name in ["texts", "form", "spoiled"] {
        let bundle = folder.join(format!("bundle-{name}"));
        words.push(json(&bundle.join("details/proposal.json"))["title"].as_str().unwrap().to_owned());
        words.push(json(&bundle.join("details/manifest.json"))["scenario"].as_str().unwrap().to_owned());
    }
    words
}

#[test]
fn judges_see_requests_and_runs_and_nothing_that_tells_where_they_are_from() {
    let folder = tempfile::tempdir().unwrap();
    bundles(folder.path());
    let said = page(folder.path(), "judged/labels.html", &["--seed", "7"]);
    assert_eq!(said["runs"], serde_json::json!(["r01", "r02", "r03", "r04"]));
    let at = |path: &str| folder.path().join("judged").join(path);
    let key = key(&at("key.csv"));
    assert_eq!(key.len(), 4);
    assert_eq!(key.values().filter(|row| row[3] == "yes").count(), 1, "{key:?}");

    let html = text(&at("labels.html"));
    // The look of all pages is the same.
    let (head, rest) = html.split_once("<style>").unwrap();
    let html = format!("{head}{}", rest.split_once("</style>").unwrap().1);
    let (texts, protocol) = (text(&at("texts.csv")), text(&at("PROTOCOL.md")));
    let mut given: Vec<(String, Vec<u8>)> = vec![
        ("page".into(), html.into_bytes()),
        ("texts".into(), texts.clone().into_bytes()),
        ("protocol".into(), protocol.clone().into_bytes()),
    ];
    for name in key.keys() {
        let png = std::fs::read(at("stills").join(format!("{name}.png"))).unwrap();
        assert!(png.starts_with(&[0x89, b'P', b'N', b'G']));
        assert!(
            !png.windows(4).any(|chunk| [b"tEXt", b"iTXt", b"zTXt"].iter().any(|text| chunk == *text)),
            "words in {name}.png"
        );
        given.push((format!("{name}.png"), png));
    }
    for word in hidden(folder.path()) {
        for (what, bytes) in &given {
            assert!(!bytes.windows(word.len()).any(|found| found == word.as_bytes()), "`{word}` stands in {what}");
        }
    }
    for words in [
        "One person walks towards the robot.",
        "Social context: A busy warehouse",
        "[[human]]\ncount = 2",
        "relation = \"\"leaving\"\"",
    ] {
        assert!(texts.contains(words), "`{words}` is not in {texts}");
    }
    assert!(protocol.contains("control set") && protocol.contains("judged by a language model, n = 4"), "{protocol}");
    assert!(given[0].1.windows(9).any(|found| found == b"[[human]]"), "the page shows the form");

    // The same seed numbers the runs alike, another one differently.
    page(folder.path(), "again/labels.html", &["--seed", "7"]);
    for file in ["labels.html", "texts.csv", "key.csv", "stills/r01.png"] {
        assert_eq!(
            std::fs::read(at(file)).unwrap(),
            std::fs::read(folder.path().join("again").join(file)).unwrap(),
            "{file}"
        );
    }
    let orders: Vec<String> = ["1", "2", "3"]
        .map(|seed| {
            let out = format!("other-{seed}/labels.html");
            page(folder.path(), &out, &["--seed", seed]);
            text(&folder.path().join(format!("other-{seed}/key.csv")))
        })
        .to_vec();
    assert!(orders.iter().any(|order| *order != orders[0]), "{orders:?}");

    let refused = |args: &[&str], words: &str| {
        let finished = socrates(folder.path(), "refused", &[&["labels", "page", "bundle-texts"], args].concat());
        assert_eq!(finished.code, 2, "{}", finished.err);
        assert!(finished.err.contains(words), "{words}: {}", finished.err);
    };
    refused(&["--films", "--stills", "1"], "`--stills` is `1`");
    refused(&["--films", "--mixed-in", "bundle-texts"], "named as a bundle and with --mixed-in");
    refused(&["--stills", "4"], "--films");
    refused(&["--films", "--first", "--out", "judged/labels.html"], "r02.png` is none of these runs");
}

#[test]
fn answers_of_judges_are_compared_with_verdicts_each_other_and_the_controls() {
    let folder = tempfile::tempdir().unwrap();
    bundles(folder.path());
    page(folder.path(), "judged/labels.html", &[]);
    let key = key(&folder.path().join("judged/key.csv"));
    let verdict = |row: &[String]| {
        let manifest = json(&Path::new(&row[0]).join("details/manifest.json"));
        let runs = manifest["runs"].as_array().unwrap();
        let run = runs.iter().find(|run| run["recording_hash"] == *row[2]).unwrap();
        run["verdict"].as_str().unwrap().starts_with("realised")
    };
    let realised = key.values().filter(|row| row[3] == "no" && verdict(row)).count();
    let table = |rater: &str, answer: &str, sentence: &str| {
        let rows: String = key.keys().map(|run| format!("{run},{rater},{answer},{sentence}\n")).collect();
        std::fs::write(folder.path().join(format!("{rater}.csv")), format!("run,rater,as_asked,sentence\n{rows}"))
            .unwrap();
    };
    table("ann", "as_asked", "");
    table("bob", "not", "\"One person follows, they say\"");
    let compare = |labels: &[&str]| {
        let args = [
            &["--format", "json", "labels", "compare"],
            labels,
            &["--key", "judged/key.csv", "--bundles", "bundle-texts", "bundle-form"],
        ]
        .concat();
        socrates(folder.path(), "compare", &args)
    };
    let compared = compare(&["ann.csv", "bob.csv"]);
    assert_eq!(compared.code, 0, "{}", compared.err);
    let said = compared.json();
    let counts = |table: &serde_json::Value, what: &str| {
        (table[what]["count"].as_u64().unwrap(), table[what]["of"].as_u64().unwrap())
    };
    let (realised, others) = (u64::try_from(realised).unwrap(), 3 - u64::try_from(realised).unwrap());
    let (ann, bob) = (&said["judges"][0], &said["judges"][1]);
    assert_eq!(counts(&ann["verdicts"], "false_realised"), (0, realised), "{said}");
    assert_eq!(counts(&ann["verdicts"], "false_refusals"), (others, others), "{said}");
    assert_eq!(counts(&bob["verdicts"], "false_realised"), (realised, realised), "{said}");
    assert_eq!(counts(&said["any"], "false_realised"), (realised, realised), "{said}");
    assert_eq!(counts(&said["all"], "false_realised"), (0, realised), "{said}");
    assert_eq!((counts(ann, "controls_passed"), &ann["replace"]), ((1, 1), &true.into()), "{said}");
    assert_eq!((counts(bob, "controls_passed"), &bob["replace"]), ((0, 1), &false.into()), "{said}");
    assert_eq!(
        (said["agreement"]["pairs"][0]["same"]["count"].as_u64(), said["agreement"]["pairs"][0]["kappa"].as_f64()),
        (Some(0), Some(0.0))
    );
    assert_eq!(
        (said["sentences"][0]["times"].as_u64(), said["sentences"].as_array().unwrap().len()),
        (Some(3), 1),
        "{said}"
    );
    let spoken = socrates(
        folder.path(),
        "spoken",
        &["labels", "compare", "ann.csv", "--key", "judged/key.csv", "--bundles", "."],
    );
    assert!(spoken.out.contains("ann passed 1 of 1 as as_asked: to be replaced"), "{}{}", spoken.out, spoken.err);

    // Everything that is wrong is told at once, with file, line, value and what is allowed.
    std::fs::write(
        folder.path().join("bad.csv"),
        "run,rater,as_asked,sentence\nr01,eve,maybe,\nr99,eve,not,x\nr02,eve,partly,\n",
    )
    .unwrap();
    let refused = compare(&["ann.csv", "bad.csv"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    let causes = refused.json()["causes"].to_string();
    for words in [
        "bad.csv:2: `as_asked` is `maybe`; allowed: as_asked, partly, not",
        "bad.csv:3: the run `r99`",
        "bad.csv:4: `sentence` is empty",
        "bad.csv: `eve` has no answer for 2 of 4 runs: r03, r04",
    ] {
        assert!(causes.contains(words), "{words}: {causes}");
    }
    let elsewhere = socrates(
        folder.path(),
        "elsewhere",
        &["labels", "compare", "ann.csv", "--key", "judged/key.csv", "--bundles", "bundle-form"],
    );
    assert_eq!(elsewhere.code, 2);
    assert!(elsewhere.err.contains("no bundle that was named holds the run"), "{}", elsewhere.err);
}
