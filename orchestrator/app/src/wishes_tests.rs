//! A wish that is not in a run keeps it from being realised, in every shipped request, until it is given up.

use socrates_model::{Request, Verdict};

use crate::in_process::play;

/// What nobody can play.
const SONG: &str = "And then somebody sings.";

/// The shipped requests that have a text, with their names.
fn told() -> Vec<(String, Request)> {
    let mut found = Vec::new();
    for place in socrates_maps::shipped::names() {
        for (name, text) in socrates_maps::shipped::requests(place) {
            let request = Request::of_toml(text, None).unwrap();
            if request.rough_scenario.is_some() {
                found.push((format!("{place}-{name}"), request));
            }
        }
    }
    found
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_song_in_a_shipped_request_is_quoted_and_can_be_waived() {
    let all = told();
    assert!(all.len() >= 10, "{}", all.len());
    for (name, request) in all {
        let location = socrates_maps::shipped::load(&request.location).unwrap();
        let verdict = async |request: &Request, seed: u64| {
            let report = play(request, &location, seed).await.unwrap().report;
            (report.verdict, report.verdict_text)
        };
        // The first answer of the author, without the checks that would ask again.
        let mut seed = 1;
        while verdict(&request, seed).await.0 != Verdict::Realised {
            seed += 1;
            assert!(seed < 10, "{name}: {}", verdict(&request, 1).await.1);
        }

        let rough = request.rough_scenario.clone().unwrap_or_default();
        let mut sung = Request { rough_scenario: Some(format!("{} {SONG}", rough.trim())), ..request };
        let (found, text) = verdict(&sung, seed).await;
        assert_eq!(found, Verdict::Invalid, "{name}: {text}");
        assert!(text.starts_with("1 wish is not in this run: ") && text.contains("sings"), "{name}: {text}");

        sung.waive = vec!["And then somebody sings".to_owned()];
        let (found, text) = verdict(&sung, seed).await;
        assert_eq!(found, Verdict::Realised, "{name}: {text}");
        assert!(text.contains("waived: ") && text.contains("sings"), "{name}: {text}");
    }
}
