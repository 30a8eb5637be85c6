//! Much in both directions of one link with keys at once: what crashed processes where a link read and wrote one stream from two threads.

use std::sync::Arc;

use socrates_link::rules::Role;
use socrates_link::{Bus as _, keys};
use socrates_model::job::MESSAGE_BYTES;

use crate::deployment::Deployment;
use crate::promises::{SOON, ask_until_served, guarded};

/// Questions that are on their way at once, and how often.
const AT_ONCE: usize = 32;
const ROUNDS: usize = 20;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn many_large_messages_cross_a_link_with_keys_in_both_directions() {
    guarded(async {
        let deployment = Deployment::new();
        let (router, endpoint) = deployment.router().await;
        let driver = deployment.guest(Role::Driver, &endpoint).await;
        let worker = Arc::new(deployment.guest(Role::Worker, &endpoint).await);
        // A worker may ask what a driver may serve.
        let key = keys::drive_step("robot");
        let mut serving = driver.serve(&key).await.unwrap();
        // Each answer is its question, reversed.
        let echo = tokio::spawn(async move {
            while let Some(ask) = serving.next().await {
                let back = ask.body().iter().rev().copied().collect();
                ask.reply(back).await.unwrap();
            }
        });
        assert_eq!(ask_until_served(&*worker, &key, &[1, 2]).await, [2, 1]);
        for round in 0..ROUNDS {
            let mut asked = tokio::task::JoinSet::new();
            for number in 0..AT_ONCE {
                let (worker, key) = (Arc::clone(&worker), key.clone());
                drop(asked.spawn(async move {
                    let seed = u8::try_from((round * AT_ONCE + number) % 251).unwrap();
                    let body: Vec<u8> =
                        (0..MESSAGE_BYTES / 2).map(|at| seed ^ u8::try_from(at % 253).unwrap()).collect();
                    let back = worker.query(&key, body.clone(), SOON).await.unwrap();
                    assert!(
                        back.iter().rev().eq(body.iter()),
                        "message `{number}` of round `{round}` came back changed"
                    );
                }));
            }
            assert_eq!(asked.join_all().await.len(), AT_ONCE);
        }
        worker.close().await;
        driver.close().await;
        router.close().await;
        echo.await.unwrap();
    })
    .await;
}
