//! Every format gives the same table, and bad input is told by file, line, column, value and a hint.

use socrates_study::rating::Ratings;
use socrates_study::read::{
    Codebook, Pseudonyms, jspsych, own, participants_csv, prolific, qualtrics, ratings_csv, ratings_of_csv,
};
use socrates_study::simulate::{Simulated, Truth, simulate};

use crate::design;

const NAMES: Pseudonyms = Pseudonyms { key: [7; 32] };

fn simulated() -> Simulated {
    let effects = vec![0.0, 0.5, 1.0];
    let truth =
        Truth { people: 12, effects, order: 0.0, between: 1.0, within: 0.5, careless: 2, skipped: 0.05, seed: 4 };
    simulate(&design(), &truth)
}

/// Without what a format cannot hold.
fn plain(mut all: Ratings) -> Ratings {
    for person in &mut all.participants {
        (person.order, person.duration_s) = (None, None);
    }
    all
}

#[test]
fn answers_in_every_format_become_the_same_table() {
    let (design, simulated) = (design(), simulated());
    let first = own(&simulated.own(), "answers.jsonl", &design, NAMES).unwrap();
    assert_eq!((first.participants.len(), first.rows.len()), (12, 12 * 3 * 17));
    assert!(first.rows.iter().any(|row| row.rating.points().is_none()), "some are skipped");
    for words in [false, true] {
        let text = simulated.qualtrics(&design, words);
        assert!(text.contains("192.0.2.7") && words == text.contains("somewhat agree"));
        let read = qualtrics(&text, "export.csv", &design, NAMES, &Codebook::default()).unwrap();
        assert_eq!(read, first, "words: {words}");
        let tables = ratings_csv(&read, &design, &|_| Vec::new()) + &participants_csv(&read);
        assert!(!tables.contains("192.0.2") && !tables.contains("51.5") && !tables.contains("sim0"), "no place, no id");
    }
    let read = jspsych(&simulated.jspsych(&design), "data.csv", &design, NAMES).unwrap();
    assert_eq!(plain(read), plain(first.clone()));
    let tables = (ratings_csv(&first, &design, &|_| Vec::new()), participants_csv(&first));
    let again = ratings_of_csv(&tables.0, Some((&tables.1, "participants.csv")), "ratings.csv", &design).unwrap();
    assert_eq!(again, first, "the tidy tables hold everything");
}

#[test]
fn missing_is_an_empty_cell_and_comes_back_as_missing() {
    let (design, mut lines) = (design(), "participant,film,item,raw\n".to_owned());
    lines.push_str("a,k7f,RB1,3\na,k7f,RB2,\nb,k7f,RB1,1\n");
    let read = ratings_of_csv(&lines, None, "ratings.csv", &design).unwrap();
    let points: Vec<Option<f64>> = read.rows.iter().map(|row| row.rating.points()).collect();
    assert_eq!(points, [Some(3.0), None, Some(1.0)]);
    let text = ratings_csv(&read, &design, &|_| Vec::new());
    assert!(text.lines().any(|line| line.starts_with("a,elevator,mppi,1,k7f,,,psi,psi.RB,RB2,0,,,")), "{text}");
}

#[test]
fn a_codebook_names_columns_by_their_import_id() {
    let design = design();
    let text = "Q7,Q7,who\nhow,how,who\n\"{\"\"ImportId\"\":\"\"QID7_1\"\"}\",\"{\"\"ImportId\"\":\"\"QID7_2\"\"}\",\"{\"\"ImportId\"\":\"\"pid\"\"}\"\n4,Strongly Agree,p1\n";
    let book = "column,role,film,item\nQID7_1,item,k7f,RB1\nQID7_2,item,k7f,RB2\npid,participant,,\n";
    let book = Codebook::read(book, "codebook.csv").unwrap();
    let read = qualtrics(text, "export.csv", &design, NAMES, &book).unwrap();
    let points: Vec<f64> = read.rows.iter().filter_map(|row| row.rating.points()).collect();
    assert_eq!(points, [4.0, 5.0]);
    let unknown = qualtrics(text, "export.csv", &design, NAMES, &Codebook::default()).unwrap_err().to_string();
    assert!(unknown.contains("unknown column") && unknown.contains("QID7_1,ignored"), "{unknown}");
}

#[test]
fn bad_answers_are_told_by_file_line_column_value_and_hint() {
    let design = design();
    let tidy = |lines: &str| {
        ratings_of_csv(&format!("participant,film,item,raw\n{lines}"), None, "r.csv", &design).unwrap_err().to_string()
    };
    let told = |why: &str, parts: &[&str]| parts.iter().for_each(|part| assert!(why.contains(part), "{part}: {why}"));
    told(
        &tidy("a,k7f,RB1,3\na,k7f,RB1,3\n"),
        &["`r.csv` line 3, `raw` is `3`", "has answered `RB1`", "line 2", "hint"],
    );
    told(&tidy("a,nope,RB1,3\n"), &["line 2, `film` is `nope`", "films are k7f, q2b, z9x"]);
    told(&tidy("a,k7f,RB9,3\n"), &["`item` is `RB9`", "did you mean `RB1`"]);
    told(&tidy("a,k7f,RB1,0\n"), &["`raw` is `0`", "counts from 0"]);
    told(&tidy("a,k7f,RB1,7\n"), &["`raw` is `7`", "go from 1 to 5"]);
    told(&tidy("a,k7f,RB1,often\n"), &["`raw` is `often`", "strongly agree"]);
    let unknown = ratings_of_csv("participant,film,item,raw,ip\n", None, "r.csv", &design).unwrap_err().to_string();
    told(&unknown, &["`r.csv` line 1, `ip`", "unknown column"]);
    told(
        &ratings_of_csv("participant,film,item,raw\n", None, "r.csv", &design).unwrap_err().to_string(),
        &["holds no answer"],
    );
    // A film of another scenario and a planner that no film shows.
    let by =
        |line: &str| ratings_of_csv(&format!("participant,scenario,planner,item,raw\n{line}"), None, "r.csv", &design);
    told(&by("a,hall,can,RB1,3\n").unwrap_err().to_string(), &["hall, can", "no film of the study"]);
    assert_eq!(by("a,elevator,can,RB1,3\n").unwrap().rows[0].film, "z9x");
}

#[test]
fn likert_from_zero_and_from_one_are_not_mixed() {
    let design = design();
    let file = |responses: &[&str]| {
        let films = ["k7f", "q2b", "z9x"];
        let mut text = "trial_type,PROLIFIC_PID,film,response\n".to_owned();
        for (response, film) in responses.iter().zip(films) {
            text.push_str(&format!("survey-likert,p1,{film},\"{{\"\"RB1\"\":{response}}}\"\n"));
        }
        jspsych(&text, "data.csv", &design, NAMES)
    };
    let points: Vec<f64> = file(&["0", "4", "2"]).unwrap().rows.iter().filter_map(|row| row.rating.points()).collect();
    assert_eq!(points, [1.0, 5.0, 3.0]);
    let mixed = file(&["0", "5", "2"]).unwrap_err().to_string();
    assert!(mixed.contains("`data.csv` line 3, `RB1` is `5`") && mixed.contains("line 2 counts from 0"), "{mixed}");
    let from_one = file(&["1", "5", "2"]).unwrap_err().to_string();
    assert!(from_one.contains("count from 1") && from_one.contains("subtract 1"), "{from_one}");
    assert!(file(&["6"]).unwrap_err().to_string().contains("`RB1` is `6`"));
}

#[test]
fn lines_of_json_and_exports_that_are_damaged_are_refused() {
    let design = design();
    let line = |text: &str| own(text, "a.jsonl", &design, NAMES).unwrap_err().to_string();
    assert!(line("{}").contains("`a.jsonl` line 1"));
    let twice = "{\"kind\":\"film\",\"participant\":\"p\",\"film\":\"k7f\",\"answers\":{\"RB1\":3}}\n".repeat(2);
    assert!(line(&twice).contains("line 2, `RB1` is `3`: this person has answered"), "{}", line(&twice));
    let check = "{\"kind\":\"person\",\"participant\":\"p\",\"checks\":{\"other\":3}}";
    assert!(line(check).contains("declares no such check"));
    let simulated = simulated();
    let text = simulated.qualtrics(&design, false);
    let refused = |text: &str| qualtrics(text, "e.csv", &design, NAMES, &Codebook::default()).unwrap_err().to_string();
    let headless: String =
        text.lines().filter(|line| !line.contains("ImportId")).map(|line| format!("{line}\n")).collect();
    assert!(refused(&headless).contains("line 3: the third line holds no ImportIds"));
    let double = format!("{text}{}\n", text.lines().nth(3).unwrap());
    assert!(refused(&double).contains("answered on an earlier line"), "{}", refused(&double));
    let person = prolific("Participant id,Status\np,GONE\n", "p.csv", NAMES).unwrap_err().to_string();
    assert!(person.contains("`p.csv` line 2, `Status` is `GONE`") && person.contains("APPROVED"), "{person}");
}
