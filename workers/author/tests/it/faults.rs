//! The checks against the fault model, on the offline author's answers to every shipped request.
#![expect(clippy::print_stdout, reason = "the table is there to be read")]

use socrates_author::confusion::{Confusion, answers, confusion};
use socrates_author::offline::Offline;
use socrates_author::{FaultKind, Question};
use socrates_model::Request;

/// Seeds that every request is answered with.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=3;

const FURTHER: &str = r#"
location = "warehouse"
social_context = "An ordinary day"
task = "Bring a box from the loading dock to the packing area"
rough_scenario = "A worker comes towards the robot at a blind corner and steps aside."
"#;

async fn table() -> Confusion {
    let mut all = Vec::new();
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).expect("a shipped location loads");
        let shipped = socrates_maps::shipped::requests(name).into_iter().map(|(_, text)| text.to_owned());
        // A long way to a blind corner leaves room for an encounter elsewhere.
        let further = (*name == "warehouse").then(|| FURTHER.to_owned());
        for text in shipped.chain(further) {
            let request: Request = toml::from_str(&text).expect("the request is read");
            let reading = socrates_offline::read(&request, &location);
            for seed in SEEDS {
                let first = Question::first(request.clone(), reading.clone(), location.clone(), seed);
                all.extend(answers(&Offline, &first).await);
            }
        }
    }
    confusion(&all).await
}

#[tokio::test]
async fn every_hard_class_is_found_and_clean_answers_pass() {
    let table = table().await;
    let mut weak = Vec::new();
    for ((stage, kind), row) in &table.rows {
        println!(
            "{stage:<10} {:<10} put in {:>3}  no place {:>3}  noticed {:>3}  own {:>3}  {:?}",
            kind.word(),
            row.put_in,
            row.no_place,
            row.noticed,
            row.own,
            row.found
        );
        // 95 of 100 at least, by the class's own detector.
        if row.own * 100 < row.put_in * 95 {
            weak.push(format!("{stage} {}: {} of {}", kind.word(), row.own, row.put_in));
        }
    }
    assert!(weak.is_empty(), "found in fewer than 95 %:\n{}", weak.join("\n"));
    for kind in FaultKind::ALL {
        let put_in: usize = table.rows.iter().filter(|((_, of), _)| of == kind).map(|(_, row)| row.put_in).sum();
        assert!(put_in > 0, "{} was put into no answer", kind.word());
    }
    for (stage, alarms) in &table.clean {
        println!("{stage:<10} clean {}  refused {}  {:?}", alarms.answers, alarms.refused, alarms.found);
        assert!(alarms.refused * 100 <= alarms.answers * 2, "{stage}: {alarms:?}");
    }
}
