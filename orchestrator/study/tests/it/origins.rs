//! Simulated answers are marked in everything that is made of them, and answers by people in nothing.

use socrates_study::analyze::{Declared, Results, analyze, results_csv};
use socrates_study::design::Design;
use socrates_study::kit::media::Media;
use socrates_study::kit::qsf::qsf;
use socrates_study::rating::{Origin, Ratings};
use socrates_study::read::{
    Codebook, Pseudonyms, jspsych, limesurvey, own, participants_csv, qualtrics, ratings_csv, ratings_of_csv,
};
use socrates_study::simulate::{Simulated, Truth, simulate};
use socrates_study::{page, words};

use crate::design;

const NAMES: Pseudonyms = Pseudonyms { key: [7; 32] };

fn simulated(design: &Design) -> Simulated {
    let effects = vec![0.0, 0.5, 1.0];
    let truth =
        Truth { people: 12, effects, order: 0.0, between: 1.0, within: 0.5, careless: 0, skipped: 0.0, seed: 4 };
    simulate(design, &truth)
}

/// The same answers as people would have given them: without the mark of each line, under other ids.
fn by_people(simulated: &Simulated) -> String {
    let text = simulated.own();
    assert!(text.lines().all(|line| line.contains("\"simulated\":true")), "{text}");
    text.replace(",\"simulated\":true", "").replace("\"sim0", "\"person0")
}

/// Every table, text and page of the results, by name.
fn written(ratings: &Ratings, design: &Design) -> Vec<(&'static str, String)> {
    let results: Results = analyze(ratings, design, Declared::Never);
    vec![
        ("ratings.csv", ratings_csv(ratings, design, &|_| Vec::new())),
        ("participants.csv", participants_csv(ratings)),
        ("results.csv", results_csv(&results)),
        ("results.json", serde_json::to_string(&results).unwrap()),
        ("methods.txt", words::methods(&results, design)),
        ("report.html", page::page(&results, design)),
    ]
}

#[test]
fn every_format_of_simulated_answers_says_so_and_every_result_of_them() {
    let design = design();
    let all = simulated(&design);
    let codebook = qsf(&design, &Media::parse("https://films.example.org").unwrap()).unwrap().codebook;
    let book = Codebook::read(&codebook, "codebook.csv").unwrap();
    let plain = Codebook::default();
    let read = [
        own(&all.own(), "a", &design, NAMES),
        qualtrics(&all.qualtrics(&design, true), "a", &design, NAMES, &plain),
        qualtrics(&all.by_codebook(&design, &codebook), "a", &design, NAMES, &book),
        jspsych(&all.jspsych(&design), "a", &design, NAMES),
        limesurvey(&all.limesurvey(&design), "a", &design, NAMES),
    ];
    for (number, ratings) in read.into_iter().enumerate() {
        assert_eq!(ratings.unwrap().origin, Origin::Simulated, "{number}");
    }
    assert!(all.prolific().lines().all(|line| line.ends_with(",simulated") || line.ends_with(",1")));

    let ratings = own(&all.own(), "a", &design, NAMES).unwrap();
    for (file, text) in written(&ratings, &design) {
        match file {
            "results.json" => assert!(text.contains("\"simulated\":true"), "{file}: {text}"),
            "methods.txt" => assert!(text.starts_with(Origin::MARK) && text.contains("12 simulated people answered")),
            "report.html" => assert!(text.contains(&format!("<p class=mark role=note>{}", Origin::MARK)), "{file}"),
            _table => {
                let mut lines = text.lines();
                assert!(lines.next().is_some_and(|head| head.ends_with(",simulated")), "{file}: {text}");
                assert!(lines.all(|line| line.ends_with(",1")), "{file}: {text}");
            }
        }
    }
}

#[test]
fn answers_by_people_carry_no_mark() {
    let design = design();
    let ratings = own(&by_people(&simulated(&design)), "a", &design, NAMES).unwrap();
    assert_eq!(ratings.origin, Origin::People);
    for (file, text) in written(&ratings, &design) {
        let text = text.replace("one simulated run", "");
        assert!(!text.to_lowercase().contains("simulated"), "{file}: {text}");
    }
}

#[test]
fn the_mark_survives_the_tables_even_where_one_of_them_is_lost() {
    let design = design();
    let ratings = own(&simulated(&design).own(), "a", &design, NAMES).unwrap();
    let (table, people) = (ratings_csv(&ratings, &design, &|_| Vec::new()), participants_csv(&ratings));
    for people in [None, Some((people.as_str(), "participants.csv"))] {
        let again = ratings_of_csv(&table, people, "ratings.csv", &design).unwrap();
        assert_eq!(again.origin, Origin::Simulated);
    }
}

#[test]
fn a_mixture_of_simulated_answers_and_answers_by_people_is_refused() {
    let design = design();
    let all = simulated(&design);
    let real = by_people(&all);
    let one = own(&format!("{}{}", all.own(), real), "a.jsonl", &design, NAMES).unwrap_err().to_string();
    assert!(one.contains("`a.jsonl` line 49, `simulated` is `false`: line 1 holds simulated answers"), "{one}");
    assert!(one.contains("read simulated answers apart"), "{one}");

    let read = |text: &str| own(text, "a.jsonl", &design, NAMES).unwrap();
    let (made, given) = (read(&all.own()), read(&real));
    let parts = vec![("given.jsonl".to_owned(), given.clone()), ("made.jsonl".to_owned(), made.clone())];
    let two = Ratings::join(parts).unwrap_err().to_string();
    assert!(two.contains("`made.jsonl`") && two.contains("`given.jsonl` answers by people"), "{two}");

    let bare = "participant,film,item,raw,simulated\na,k7f,RB1,3,1\nb,k7f,RB1,3,\n";
    let table = ratings_of_csv(bare, None, "r.csv", &design).unwrap_err().to_string();
    assert!(table.contains("`r.csv` line 3, `simulated` is `false`"), "{table}");
    let odd = ratings_of_csv("participant,film,item,raw,simulated\na,k7f,RB1,3,maybe\n", None, "r.csv", &design);
    let odd = odd.unwrap_err().to_string();
    assert!(odd.contains("`simulated` is `maybe`: no such mark"), "{odd}");

    // The table of people of the one beside the ratings of the other.
    let ratings = ratings_csv(&made, &design, &|_| Vec::new());
    let unmarked = participants_csv(&Ratings { origin: Origin::People, ..made });
    let crossed = ratings_of_csv(&ratings, Some((&unmarked, "p.csv")), "r.csv", &design).unwrap_err().to_string();
    assert!(crossed.contains("`p.csv` line 2") && crossed.contains("one `study read`"), "{crossed}");
}
