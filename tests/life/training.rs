//! What authors were asked and answered becomes training data.

use serde_json::Value;

use crate::{WAREHOUSE, make, socrates};

fn lines(folder: &std::path::Path, name: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join("data").join(name)).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn taken_and_refused_answers_become_chats_and_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let inject = ["--author", "offline", "--inject", "gdisc=1,first_only=true", "--set", "author.variants=2"];
    let (finished, json) = make(folder, "kept", WAREHOUSE, &inject);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let done =
        socrates(folder, "export", &["--format", "json", "library", "export", "bundle-kept", "--chat-jsonl", "data"]);
    assert_eq!(done.code, 0, "{}", done.err);
    assert_eq!((&done.json()["answers"], &done.json()["pairs"]), (&3.into(), &1.into()), "{}", done.out);
    let chats = lines(folder, "chat.jsonl");
    for chat in &chats {
        let turns = chat["messages"].as_array().unwrap();
        let roles: Vec<&str> = turns.iter().map(|turn| turn["role"].as_str().unwrap()).collect();
        assert_eq!(roles, ["system", "user", "assistant"]);
        // An answer is what a model should say: one JSON object, of several proposals the one that was taken.
        let answer: Value = serde_json::from_str(turns[2]["content"].as_str().unwrap()).unwrap();
        assert!(answer.is_object() && answer.get("variants").is_none(), "{answer}");
    }
    let pairs = lines(folder, "preferences.jsonl");
    let robot = |side: &str| {
        let answer: Value = serde_json::from_str(pairs[0][side][0]["content"].as_str().unwrap()).unwrap();
        answer["robot"].as_array().unwrap().len()
    };
    assert_eq!(robot("rejected") + 1, robot("chosen"), "the refused path has a hole");
    let index = lines(folder, "index.jsonl");
    let pair = index.iter().find(|row| row["file"] == "preferences.jsonl").unwrap();
    assert_eq!((&pair["stage"], &pair["rejected"]["injected"][0]), (&"paths".into(), &"gdisc".into()));
    assert!(pair["rejected"]["faults"].as_array().unwrap().contains(&"G-DISC".into()), "{pair}");
    // Every proposal of the answer is in the provenance.
    let text = std::fs::read_to_string(folder.join("bundle-kept/details/provenance.json")).unwrap();
    let provenance: Value = serde_json::from_str(&text).unwrap();
    let proposal = provenance["jobs"].as_array().unwrap().iter().find(|job| job["job"]["stage"] == "proposal").unwrap();
    let exchange = proposal["exchanges"].as_array().unwrap().iter().find(|one| one["answer"].is_string()).unwrap();
    let all: Value = serde_json::from_str(exchange["answer"].as_str().unwrap()).unwrap();
    assert_eq!((all["variants"].as_array().unwrap().len(), exchange["chosen"].is_u64()), (2, true));
}

#[test]
fn answers_are_not_kept_where_that_is_wanted_and_nothing_is_exported_of_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (finished, _) = make(folder, "bare", WAREHOUSE, &["--author", "offline", "--set", "author.keep_answers=false"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let text = std::fs::read_to_string(folder.join("bundle-bare/details/provenance.json")).unwrap();
    assert!(text.contains("\"tokens\"") && !text.contains("\"answer\"") && !text.contains("\"messages\""), "{text}");
    let done = socrates(folder, "export", &["library", "export", "bundle-bare", "--chat-jsonl", "data"]);
    assert!(done.code == 0 && done.err.contains("keep_answers"), "{}\n{}", done.out, done.err);
    assert!(lines(folder, "chat.jsonl").is_empty());
    let wrong = socrates(folder, "export", &["library", "export", "nowhere", "--chat-jsonl", "data"]);
    assert!(wrong.code == 2 && wrong.err.contains("`nowhere` is neither a bundle"), "{}", wrong.err);
}
