//! What the page and the words say.

use socrates_study::analyze::{Declared, analyze, results_csv};
use socrates_study::design::Design;
use socrates_study::read::{Pseudonyms, own, ratings_of_csv};
use socrates_study::simulate::{Truth, simulate};
use socrates_study::{page, words};

use crate::{STUDY, design};

const NAMES: Pseudonyms = Pseudonyms { key: [7; 32] };

#[test]
fn the_preregistration_holds_what_the_study_declares_and_its_digest() {
    let design = design();
    let text = words::preregistration(&design);
    assert_eq!(words::registered_digest(&text), Some(design.digest.as_str()));
    for part in
        ["60 people per scenario", "psi.AB", "failed 2 or more attention checks", "Pratt", "keep clear of groups"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }

    let other = Design::parse(&format!("{STUDY}\n"), "study.toml").unwrap();
    assert_ne!(other.digest, design.digest);
    assert_eq!(words::registered_digest("no digest here"), None);
}

#[test]
fn people_who_find_everything_excellent_stay_and_people_who_click_one_answer_do_not() {
    let design = design();
    let mut text = "participant,film,item,raw\n".to_owned();
    for film in ["k7f", "q2b", "z9x"] {
        for code in design.codes() {
            let reversed = design.item(code).unwrap().1.reversed;
            text.push_str(&format!("honest,{film},{code},{}\n", if reversed { 1 } else { 5 }));
            text.push_str(&format!("clicks,{film},{code},5\n"));
        }
    }
    let ratings = ratings_of_csv(&text, None, "r.csv", &design).unwrap();
    let results = analyze(&ratings, &design, Declared::Never);
    assert_eq!(results.excluded.keys().collect::<Vec<_>>(), ["clicks"]);
    // With one person left nothing can be tested, and the page says why instead of showing figures.
    let page = page::page(&results, &design);
    assert!(page.contains("at least 2 are needed") && results.findings.is_empty(), "{page}");
    assert!(!results_csv(&results).contains("NaN"));
}

#[test]
fn the_page_and_the_methods_name_what_a_reviewer_asks_for() {
    let mut design = design();
    design.title = "<b>Elevator</b> & aisle".to_owned();
    let truth = Truth {
        people: 18,
        effects: vec![0.0, 0.0, 2.0],
        order: 0.0,
        between: 1.0,
        within: 0.5,
        careless: 2,
        skipped: 0.0,
        seed: 2,
    };
    let ratings = own(&simulate(&design, &truth).own(), "a.jsonl", &design, NAMES).unwrap();
    let results = analyze(&ratings, &design, Declared::Before);
    let page = page::page(&results, &design);
    for part in [
        "&lt;b&gt;Elevator",
        "not validated",
        "odds ratio",
        "Kendall",
        "alpha",
        "exploratory",
        "failed-checks",
        "Barchard",
    ] {
        assert!(page.contains(part) || words::methods(&results, &design).contains(part), "{part}");
    }
    assert!(!page.contains("<b>Elevator") && !page.contains("NaN") && !page.contains("inf"), "{page}");
    let methods = words::methods(&results, &design);
    assert!(
        methods.contains("18 simulated people answered; 2 were excluded") && methods.contains("leaves 16"),
        "{methods}"
    );
}
