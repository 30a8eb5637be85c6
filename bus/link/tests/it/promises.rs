//! What every bus promises; run on the one in memory and on zenoh through a router on loopback.

use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, LinkError, MemoryBus, Overflow, Qos, call, keys};
use socrates_model::job::{MESSAGE_BYTES, Stage};
use socrates_model::wire::{StatusAsk, StatusReply};

/// No wait of a test is longer; it is there to fail instead of hang.
const WATCHDOG: Duration = Duration::from_secs(60);
pub(crate) const SOON: Duration = Duration::from_secs(10);

pub(crate) async fn guarded<T>(what: impl Future<Output = T>) -> T {
    tokio::time::timeout(WATCHDOG, what).await.expect("a promise is kept within the watchdog's time")
}

/// Two participants and whatever must stay alive for them.
struct Pair {
    a: Arc<dyn Bus>,
    b: Arc<dyn Bus>,
    router: Option<Arc<dyn Bus>>,
}

fn memory() -> Pair {
    let bus = MemoryBus::new();
    Pair { a: Arc::new(bus.named("a")), b: Arc::new(bus.named("b")), router: None }
}

async fn end(pair: Pair) {
    pair.a.close().await;
    pair.b.close().await;
    if let Some(router) = pair.router {
        router.close().await;
    }
}

/// Asks until somebody serves the key: declarations travel for a moment.
pub(crate) async fn ask_until_served(bus: &dyn Bus, key: &str, body: &[u8]) -> Vec<u8> {
    loop {
        match bus.query(key, body.to_vec(), SOON).await {
            Ok(reply) => return reply,
            Err(error) if error.is_transient() => tokio::time::sleep(Duration::from_millis(10)).await,
            Err(error) => panic!("{error}"),
        }
    }
}

async fn a_query_is_answered(pair: &Pair) {
    let mut serving = pair.a.serve("rpc/echo").await.unwrap();
    let server = tokio::spawn(async move {
        while let Some(ask) = serving.next().await {
            let mut body = ask.body().to_vec();
            body.push(b'!');
            ask.reply(body).await.unwrap();
        }
    });
    assert_eq!(ask_until_served(&*pair.b, "rpc/echo", b"hello").await, b"hello!");
    // One who serves is asked in its own process too.
    assert_eq!(ask_until_served(&*pair.a, "rpc/echo", b"own").await, b"own!");
    server.abort();
}

async fn nobody_serving_is_no_reply_and_transient(pair: &Pair) {
    let error = pair.b.query("rpc/nobody", vec![], SOON).await.unwrap_err();
    assert!(matches!(error, LinkError::NoReply { .. }), "{error}");
    assert!(error.is_transient());
}

async fn a_dropped_ask_is_no_reply(pair: &Pair) {
    let mut serving = pair.a.serve("rpc/drops").await.unwrap();
    let server = tokio::spawn(async move {
        // The first ask is answered so that the asker knows that the key is served.
        serving.next().await.unwrap().reply(vec![1]).await.unwrap();
        drop(serving.next().await.unwrap());
        serving
    });
    ask_until_served(&*pair.b, "rpc/drops", &[]).await;
    let error = pair.b.query("rpc/drops", vec![], SOON).await.unwrap_err();
    assert!(matches!(error, LinkError::NoReply { .. }), "{error}");
    drop(server.await.unwrap());
}

async fn a_silent_server_is_a_timeout(pair: &Pair) {
    let mut serving = pair.a.serve("rpc/silent").await.unwrap();
    let server = tokio::spawn(async move {
        serving.next().await.unwrap().reply(vec![1]).await.unwrap();
        (serving.next().await, serving)
    });
    ask_until_served(&*pair.b, "rpc/silent", &[]).await;
    let error = pair.b.query("rpc/silent", vec![], Duration::from_millis(300)).await.unwrap_err();
    assert!(matches!(error, LinkError::Timeout { .. }), "{error}");
    drop(server.await.unwrap());
}

async fn a_publication_reaches_who_listens_in_order(pair: &Pair) {
    let mut inbox = pair.b.subscribe("hint/*", 4096, Overflow::Block).await.unwrap();
    let key = keys::hint(Stage::Paths);
    // A first message is repeated until the subscription is known on the other side.
    loop {
        pair.a.publish(&key, vec![], Qos::Control).await.unwrap();
        if tokio::time::timeout(Duration::from_millis(50), inbox.next()).await.is_ok() {
            break;
        }
    }
    for n in 0..500_u16 {
        pair.a.publish(&key, n.to_le_bytes().to_vec(), Qos::Control).await.unwrap();
    }
    let mut next = 0_u16;
    while next < 500 {
        let (from, body) = inbox.next().await.unwrap();
        assert_eq!(from, key);
        if body.is_empty() {
            continue;
        }
        assert_eq!(body, next.to_le_bytes());
        next += 1;
    }
    assert_eq!(inbox.lost(), 0);
}

async fn a_publisher_knows_whether_anybody_listens(pair: &Pair) {
    let publisher = pair.a.publisher("live/heard/agents", Qos::Stream).await.unwrap();
    assert!(!publisher.is_heard(), "nobody listens yet");
    let mut inbox = pair.b.subscribe("live/*/agents", 16, Overflow::Block).await.unwrap();
    until(|| publisher.is_heard()).await;
    publisher.put(vec![1]).await.unwrap();
    assert_eq!(inbox.next().await.unwrap().1, [1]);
    let late = pair.a.publisher("live/late/agents", Qos::Stream).await.unwrap();
    until(|| late.is_heard()).await;
    drop(inbox);
    until(|| !publisher.is_heard() && !late.is_heard()).await;
    let error = late.put(vec![0; MESSAGE_BYTES + 1]).await.unwrap_err();
    assert!(matches!(error, LinkError::TooLarge { .. }), "{error}");
}

/// Looks again and again; declarations travel for a moment.
pub(crate) async fn until(mut holds: impl FnMut() -> bool) {
    while !holds() {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

async fn a_full_subscription_loses_its_oldest_and_counts_them(pair: &Pair) {
    let mut inbox = pair.b.subscribe("ev/x", 3, Overflow::DropOldest).await.unwrap();
    let mut fence = pair.b.subscribe("ev/fence", 1, Overflow::DropOldest).await.unwrap();
    loop {
        pair.a.publish("ev/fence", vec![], Qos::Control).await.unwrap();
        if tokio::time::timeout(Duration::from_millis(50), fence.next()).await.is_ok() {
            break;
        }
    }
    for n in 0..10_u8 {
        pair.a.publish("ev/x", vec![n], Qos::Control).await.unwrap();
    }
    pair.a.publish("ev/fence", vec![9], Qos::Control).await.unwrap();
    while fence.next().await.unwrap().1 != [9] {}
    let mut kept = Vec::new();
    while let Some((_, body)) = inbox.try_next() {
        kept.extend(body);
    }
    assert_eq!(kept, [7, 8, 9]);
    assert_eq!(inbox.lost(), 7);
}

async fn too_large_a_message_is_refused_at_the_sender(pair: &Pair) {
    let error = pair.a.publish("ev/big", vec![0; MESSAGE_BYTES + 1], Qos::Stream).await.unwrap_err();
    assert!(matches!(error, LinkError::TooLarge { .. }) && !error.is_transient());
    let error = pair.a.query("rpc/big", vec![0; MESSAGE_BYTES + 1], SOON).await.unwrap_err();
    assert!(matches!(error, LinkError::TooLarge { .. }));
    let error = pair.a.publish("ev//x", vec![], Qos::Hint).await.unwrap_err();
    assert!(matches!(error, LinkError::BadKey { .. }));
}

async fn presence_is_told_at_once_and_taken_back(pair: &Pair) {
    let early = pair.a.declare_alive("live/orch/early").await.unwrap();
    let mut presence = pair.b.watch_alive(keys::ORCHESTRATORS_ALIVE).await.unwrap();
    assert_eq!(presence.next().await.unwrap(), ("live/orch/early".to_owned(), true));
    let late = pair.a.declare_alive("live/orch/late").await.unwrap();
    assert_eq!(presence.next().await.unwrap(), ("live/orch/late".to_owned(), true));
    drop(late);
    assert_eq!(presence.next().await.unwrap(), ("live/orch/late".to_owned(), false));
    drop(early);
    assert_eq!(presence.next().await.unwrap(), ("live/orch/early".to_owned(), false));
}

async fn a_typed_call_comes_back_and_a_refusal_is_permanent(pair: &Pair) {
    let mut serving = pair.a.serve(keys::STATUS).await.unwrap();
    let server = tokio::spawn(async move {
        while let Some(ask) = serving.next().await {
            match ask.read::<StatusAsk>("status") {
                Ok(asked) if asked.body.batch == "known" => {
                    let reply = StatusReply { total: 3, ..StatusReply::default() };
                    ask.answer("status", "a", 5, &reply).await.unwrap();
                }
                Ok(_unknown) => ask.refuse("a", 5, "no such batch").await.unwrap(),
                Err(why) => ask.refuse("a", 5, &why.to_string()).await.unwrap(),
            }
        }
    });
    ask_until_served(&*pair.b, keys::STATUS, &[]).await;
    let ask = |batch: &str| StatusAsk { batch: batch.into(), ..StatusAsk::default() };
    let reply: StatusReply = call(&*pair.b, keys::STATUS, "status", &ask("known"), SOON).await.unwrap();
    assert_eq!(reply.total, 3);
    let refused = call::<_, StatusReply>(&*pair.b, keys::STATUS, "status", &ask("x"), SOON).await.unwrap_err();
    assert!(matches!(&refused, LinkError::Refused { why, .. } if why == "no such batch"), "{refused}");
    server.abort();
}

async fn everybody_under_an_expression_is_asked_and_one_serves_all_its_keys(pair: &Pair) {
    assert!(pair.a.query_all("live/*/meta", vec![], 8, SOON).await.unwrap().is_empty(), "nobody is no error");
    let mut servers = Vec::new();
    for (bus, name) in [(&pair.a, "r1"), (&pair.b, "r2")] {
        let mut serving = bus.serve(&format!("live/{name}/*")).await.unwrap();
        servers.push(tokio::spawn(async move {
            while let Some(ask) = serving.next().await {
                let told = format!("{name} {}", ask.key().rsplit('/').next().unwrap());
                ask.reply(told.into_bytes()).await.unwrap();
            }
        }));
    }
    ask_until_served(&*pair.a, "live/r2/map", &[]).await;
    ask_until_served(&*pair.b, "live/r1/map", &[]).await;
    let mut all = pair.a.query_all("live/*/meta", vec![], 8, SOON).await.unwrap();
    all.sort();
    assert_eq!(all, [b"r1 meta".to_vec(), b"r2 meta".to_vec()]);
    assert_eq!(pair.b.query_all("live/*/meta", vec![], 1, SOON).await.unwrap().len(), 1, "at most so many");
    assert_eq!(pair.b.query("live/r1/doors", vec![], SOON).await.unwrap(), b"r1 doors");
    servers.iter().for_each(tokio::task::JoinHandle::abort);
}

async fn every_promise(pair: &Pair) {
    everybody_under_an_expression_is_asked_and_one_serves_all_its_keys(pair).await;
    a_query_is_answered(pair).await;
    nobody_serving_is_no_reply_and_transient(pair).await;
    a_dropped_ask_is_no_reply(pair).await;
    a_silent_server_is_a_timeout(pair).await;
    a_publication_reaches_who_listens_in_order(pair).await;
    a_publisher_knows_whether_anybody_listens(pair).await;
    a_full_subscription_loses_its_oldest_and_counts_them(pair).await;
    too_large_a_message_is_refused_at_the_sender(pair).await;
    presence_is_told_at_once_and_taken_back(pair).await;
    a_typed_call_comes_back_and_a_refusal_is_permanent(pair).await;
}

async fn closing_ends_what_was_handed_out(pair: Pair) {
    let mut inbox = pair.b.subscribe("ev/**", 4, Overflow::Block).await.unwrap();
    let mut serving = pair.b.serve("rpc/end").await.unwrap();
    let Pair { a, b, router } = pair;
    b.close().await;
    assert!(inbox.next().await.is_none());
    assert!(serving.next().await.is_none());
    assert_eq!(b.publish("ev/x", vec![], Qos::Hint).await.unwrap_err(), LinkError::Closed);
    end(Pair { a, b, router }).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn memory_keeps_every_promise() {
    guarded(async {
        let pair = memory();
        every_promise(&pair).await;
        closing_ends_what_was_handed_out(pair).await;
    })
    .await;
}

/// The same over zenoh, and what only a bus between processes can break.
#[cfg(feature = "zenoh")]
pub(crate) mod over_zenoh {
    use std::net::{TcpListener, UdpSocket};

    use socrates_link::{Mode, ZenohBus, ZenohConfig};

    use super::*;

    pub(crate) fn free_udp_port() -> u16 {
        UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
    }

    pub(crate) fn free_port() -> u16 {
        TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
    }

    async fn zenoh() -> Pair {
        let endpoint = format!("tcp/127.0.0.1:{}", free_port());
        let router = ZenohBus::open(ZenohConfig::new(Mode::Router, "t", "router").listen(&endpoint)).await.unwrap();
        let a = ZenohBus::open(ZenohConfig::new(Mode::Client, "t", "a").connect(&endpoint)).await.unwrap();
        let b = ZenohBus::open(ZenohConfig::new(Mode::Client, "t", "b").connect(&endpoint)).await.unwrap();
        Pair { a: Arc::new(a), b: Arc::new(b), router: Some(Arc::new(router)) }
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn zenoh_keeps_every_promise() {
        guarded(async {
            let pair = zenoh().await;
            every_promise(&pair).await;
            closing_ends_what_was_handed_out(pair).await;
        })
        .await;
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn a_client_outlives_a_restart_of_its_router() {
        guarded(async {
            let endpoint = format!("tcp/127.0.0.1:{}", free_port());
            let open_router = || ZenohBus::open(ZenohConfig::new(Mode::Router, "t", "router").listen(&endpoint));
            let router = open_router().await.unwrap();
            let client = ZenohBus::open(ZenohConfig::new(Mode::Client, "t", "c").connect(&endpoint)).await.unwrap();
            let mut first = router.serve("rpc/x").await.unwrap();
            let one = tokio::spawn(async move { first.next().await.unwrap().reply(vec![1]).await.unwrap() });
            assert_eq!(ask_until_served(&client, "rpc/x", &[]).await, [1]);
            one.await.unwrap();
            router.close().await;
            drop(router);
            assert!(client.query("rpc/x", vec![], SOON).await.unwrap_err().is_transient());
            let router = open_router().await.unwrap();
            let mut second = router.serve("rpc/x").await.unwrap();
            let two = tokio::spawn(async move { second.next().await.unwrap().reply(vec![2]).await.unwrap() });
            assert_eq!(ask_until_served(&client, "rpc/x", &[]).await, [2]);
            two.await.unwrap();
            client.close().await;
            router.close().await;
        })
        .await;
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn other_namespaces_hear_nothing() {
        guarded(async {
            let endpoint = format!("tcp/127.0.0.1:{}", free_port());
            let router =
                ZenohBus::open(ZenohConfig::new(Mode::Router, "one", "router").listen(&endpoint)).await.unwrap();
            let other = ZenohBus::open(ZenohConfig::new(Mode::Client, "two", "c").connect(&endpoint)).await.unwrap();
            let mut serving = router.serve("rpc/x").await.unwrap();
            let server = tokio::spawn(async move { serving.next().await.unwrap().reply(vec![1]).await });
            let error = other.query("rpc/x", vec![], SOON).await.unwrap_err();
            assert!(matches!(error, LinkError::NoReply { .. }), "{error}");
            server.abort();
            other.close().await;
            router.close().await;
        })
        .await;
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn an_unreachable_router_is_an_error_that_names_it() {
        guarded(async {
            let endpoint = format!("tcp/127.0.0.1:{}", free_port());
            let mut config = ZenohConfig::new(Mode::Client, "t", "c").connect(&endpoint);
            config.patience = Duration::from_millis(300);
            let error = ZenohBus::open(config).await.err().expect("nobody listens there").to_string();
            assert!(error.contains(&endpoint), "{error}");
        })
        .await;
    }
}
