//! A wish that is not in a run keeps it from being realised, in every shipped request, until it is given up.

use socrates_app::config::Config;
use socrates_app::prepare::Prepared;
use socrates_model::{Request, Verdict};

use crate::mutations::realised;

/// What nobody can play.
const SONG: &str = "And then somebody sings.";

/// The shipped requests that have a text.
fn told() -> Vec<Prepared> {
    let all = crate::mutations::shipped(&Config::load(None, std::iter::empty(), &[]).unwrap()).unwrap();
    all.into_iter().filter(|prepared| prepared.request.rough_scenario.is_some()).collect()
}

/// What is said of a request, asked again as often as the program does.
async fn verdict(prepared: &Prepared, request: &Request, seed: u64) -> (Verdict, String) {
    let reading = socrates_offline::read(request, &prepared.location);
    let mut asked = prepared.clone();
    (asked.request, asked.reading) = (request.clone(), reading);
    let report = realised(asked, seed).await.unwrap().report;
    (report.verdict, report.verdict_text)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_song_in_a_shipped_request_is_quoted_and_can_be_waived() {
    let all = told();
    assert!(all.len() >= 10, "{}", all.len());
    for prepared in all {
        let (name, request) = (prepared.name.as_str(), prepared.request.clone());
        let verdict = async |request: &Request, seed: u64| verdict(&prepared, request, seed).await;
        let mut seed = 1;
        while verdict(&request, seed).await.0 != Verdict::Realised {
            seed += 1;
            assert!(seed < 10, "{name}: {}", verdict(&request, 1).await.1);
        }

        let rough = request.rough_scenario.clone().unwrap_or_default();
        let mut sung = Request { rough_scenario: Some(format!("{} {SONG}", rough.trim())), ..request };
        let (found, text) = verdict(&sung, seed).await;
        assert_eq!(found, Verdict::Invalid, "{name}: {text}");
        assert!(text.contains("not in this run: ") && text.contains("sings"), "{name}: {text}");

        sung.waive = vec!["And then somebody sings".to_owned()];
        let (found, text) = verdict(&sung, seed).await;
        assert_eq!(found, Verdict::Realised, "{name}: {text}");
        assert!(text.contains("waived: ") && text.contains("sings"), "{name}: {text}");
    }
}
