//! The survey in the formats of other programs, and their answers back.

use socrates_study::analyze::{Declared, analyze};
use socrates_study::design::Design;
use socrates_study::kit::media::Media;
use socrates_study::kit::qsf::qsf;
use socrates_study::rating::Ratings;
use socrates_study::read::{Codebook, Format, Pseudonyms, format_of, jspsych, limesurvey, own, qualtrics};
use socrates_study::simulate::{Truth, simulate};

use crate::{STUDY, design};

const NAMES: Pseudonyms = Pseudonyms { key: [7; 32] };

fn report(ratings: &Ratings, design: &Design) -> String {
    serde_json::to_string(&analyze(ratings, design, Declared::Before)).unwrap()
}

#[test]
fn sixty_people_give_the_same_report_through_every_format() {
    let design = design();
    let truth = Truth {
        people: 60,
        effects: vec![0.0, 0.5, 1.5],
        order: 0.2,
        between: 1.63,
        within: 0.5,
        careless: 4,
        skipped: 0.02,
        seed: 3,
    };
    let all = simulate(&design, &truth);
    let codebook = qsf(&design, &Media::parse("https://films.example.org").unwrap()).unwrap().codebook;
    let book = Codebook::read(&codebook, "codebook-qualtrics.csv").unwrap();
    let texts = [
        (all.own(), Format::Own),
        (all.qualtrics(&design, true), Format::Qualtrics),
        (all.by_codebook(&design, &codebook), Format::Qualtrics),
        (all.jspsych(&design), Format::JsPsych),
        (all.limesurvey(&design), Format::LimeSurvey),
    ];
    let mut first: Option<(Ratings, String)> = None;
    for (number, (text, format)) in texts.iter().enumerate() {
        assert_eq!(format_of(text, "answers").unwrap(), *format);
        let mut found = match format {
            Format::Own => own(text, "answers", &design, NAMES),
            Format::Qualtrics if number == 2 => qualtrics(text, "answers", &design, NAMES, &book),
            Format::Qualtrics => qualtrics(text, "answers", &design, NAMES, &Codebook::default()),
            Format::JsPsych => jspsych(text, "answers", &design, NAMES),
            Format::LimeSurvey => limesurvey(text, "answers", &design, NAMES),
        }
        .unwrap();
        // jsPsych tells no time from start to end, and by itself no order.
        found.participants.iter_mut().for_each(|person| (person.order, person.duration_s) = (None, None));
        assert_eq!(found.participants.len(), 60, "{number}");
        let told = report(&found, &design);
        match &first {
            None => first = Some((found, told)),
            Some((ratings, report)) => {
                assert!(found.rows == ratings.rows, "{number}: other rows");
                assert_eq!(&told, report, "{number}");
            }
        }
    }
}

#[test]
fn what_limesurvey_cannot_have_exported_is_refused() {
    let design = Design::parse(STUDY, "study.toml").unwrap();
    let refused = |text: &str| limesurvey(text, "lime.csv", &design, NAMES).unwrap_err().to_string();
    let good = "PROLIFICPID,k7fpsi[RB1],k7fposition\np1,4,1\n";
    assert_eq!(limesurvey(good, "lime.csv", &design, NAMES).unwrap().rows.len(), 1);
    let out = refused("PROLIFICPID,k7fpsi[RB1]\np1,7\n");
    assert!(out.contains("`lime.csv` line 2, `k7fpsi[RB1]` is `7`"), "{out}");
    let zero = refused("PROLIFICPID,k7fpsi[RB1]\np1,0\n");
    assert!(zero.contains("is `0`") && zero.contains("counts from 0"), "{zero}");
    assert!(refused("PROLIFICPID,xyzpsi[RB1]\np1,4\n").contains("`xyzpsi[RB1]`: unknown column"));
    assert!(refused("PROLIFICPID,k7fpsi[RB9]\np1,4\n").contains("unknown column"));
    assert!(refused("PROLIFICPID,k7fpsi[RB1]\n,4\n").contains("nobody is named"));
    assert!(refused("PROLIFICPID,k7fpsi[RB1]\np1,4\np1,3\n").contains("answered on an earlier line"));
}
