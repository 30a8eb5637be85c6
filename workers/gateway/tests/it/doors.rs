//! Bad input and strangers at the door.

use socrates_gateway::guard::Rules;
use socrates_gateway::page::PROTOCOL;
use socrates_link::MemoryBus;
use tokio::io::AsyncWriteExt as _;
use tokio::net::TcpStream;

use crate::stage::{Doors, Playing, guarded, recording};

/// The headers of a socket's question.
fn upgrade(protocol: &str) -> Vec<(&str, &str)> {
    vec![
        ("Connection", "Upgrade"),
        ("Upgrade", "websocket"),
        ("Sec-WebSocket-Version", "13"),
        ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
        ("Sec-WebSocket-Protocol", protocol),
    ]
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn strangers_are_told_why_they_are_not_let_in() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(2, 100)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(10);
        doors.json("/run/hall.reference-1/scene").await;
        let told = |answer: &(u16, String, Vec<u8>)| String::from_utf8_lossy(&answer.2).into_owned();
        for path in ["/", "/runs", "/run/hall.reference-1/scene", "/run/hall.reference-1/ws", "/layout.json"] {
            let foreign = doors.ask(&format!("GET {path}"), &[("Host", "evil.example")]).await;
            assert_eq!(foreign.0, 403, "{path}");
            assert!(told(&foreign).contains("evil.example"), "{}", told(&foreign));
            let page = doors.ask(&format!("GET {path}"), &[("Origin", "https://evil.example")]).await;
            assert_eq!(page.0, 403, "{path}");
            assert!(told(&page).contains("--allow-origin"), "{}", told(&page));
        }
        let mut headers = upgrade("foxglove.sdk.v1");
        headers.push(("Origin", "https://evil.example"));
        assert_eq!(doors.ask("GET /", &headers).await.0, 403, "a socket of a stranger's page");
        for (path, protocol) in
            [("/", "foxglove.sdk.v9"), ("/", ""), ("/run/hall.reference-1/ws", "foxglove.sdk.v1"), ("/", PROTOCOL)]
        {
            let answer = doors.ask(&format!("GET {path}"), &upgrade(protocol)).await;
            assert_eq!(answer.0, 400, "{path} {protocol}: {}", told(&answer));
            assert!(told(&answer).contains("hint"), "{}", told(&answer));
        }
        for path in ["/run/../../etc/passwd/scene", "/run/%2e%2e%2fetc/scene", "/run/a%2fb/scene", "/assets/../lib.rs"]
        {
            let answer = doors.ask(&format!("GET {path}"), &[]).await;
            assert!(matches!(answer.0, 400 | 404), "{path}: {}", answer.0);
        }
        for method in ["POST", "PUT", "DELETE", "PATCH"] {
            assert_eq!(doors.ask(&format!("{method} /runs"), &[]).await.0, 405, "{method}");
        }
        assert_eq!(doors.ask("GET /run/hall.reference-1/frames?from=x", &[]).await.0, 400);
        let none = doors.ask("GET /run/other.reference-1/scene", &[]).await;
        assert!(none.0 == 404 && told(&none).contains("or not yet"), "{}", told(&none));
        let page = doors.ask("GET /", &[]).await;
        assert_eq!(page.0, 200);
        let policy = "content-security-policy: default-src 'self'";
        assert!(page.1.contains(policy) && page.1.contains("nosniff"), "{}", page.1);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn with_a_token_only_those_who_bring_it_see_data() {
    guarded(async {
        let token = "0123456789abcdef0123456789abcdef";
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(2, 100)).await;
        let doors = Doors::open(&bus, Rules { token: Some(token.to_owned()), ..Rules::default() }).await;
        run.play(10);
        let bearer = format!("Bearer {token}");
        for path in ["/runs", "/run/hall.reference-1/scene", "/run/hall.reference-1/frames", "/run/hall.reference-1/ws"]
        {
            assert_eq!(doors.ask(&format!("GET {path}"), &[]).await.0, 401, "{path}");
            let query = doors.ask(&format!("GET {path}?token={token}"), &[]).await;
            assert_eq!(query.0, 401, "{path}: a query is written into logs");
        }
        assert_eq!(doors.ask("GET /runs", &[("Authorization", &bearer)]).await.0, 200);
        let socket = upgrade("foxglove.sdk.v1");
        assert_eq!(doors.ask("GET /run/hall.reference-1", &socket).await.0, 401);
        // The page itself tells nothing, and is how a browser comes by its cookie.
        assert_eq!(doors.ask("GET /", &[]).await.0, 200);
        assert_eq!(doors.ask("POST /enter", &[("Authorization", "Bearer wrong")]).await.0, 401);
        let entered = doors.ask("POST /enter", &[("Authorization", &bearer)]).await;
        assert_eq!(entered.0, 204);
        let cookie = format!("soc_token={token}");
        assert!(entered.1.contains("HttpOnly") && entered.1.contains("SameSite=Strict"), "{}", entered.1);
        assert_eq!(doors.ask("GET /runs", &[("Cookie", &cookie)]).await.0, 200);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_flood_keeps_others_out_for_good() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(2, 100)).await;
        let doors = Doors::open(&bus, Rules { most: 20, ..Rules::default() }).await;
        run.play(10);
        doors.json("/run/hall.reference-1/scene").await;
        // Halves of heads, garbage, a head without an end.
        for bytes in [&b"GET /ru"[..], b"\x16\x03\x01\x02\x00", b"\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", &[0; 4096]] {
            let mut stream = TcpStream::connect(doors.at).await.unwrap();
            stream.write_all(bytes).await.unwrap();
        }
        let long = format!("GET / HTTP/1.1\r\nHost: localhost\r\nX: {}\r\n\r\n", "y".repeat(64 * 1024));
        let answer = doors.raw(long.as_bytes()).await;
        assert!(answer.is_empty() || answer.starts_with(b"HTTP/1.1 4"), "{}", String::from_utf8_lossy(&answer));
        // Many that say nothing: the rest are closed at once, and when they leave there is room again.
        let mut idle = Vec::new();
        for _ in 0..200 {
            idle.push(TcpStream::connect(doors.at).await.unwrap());
        }
        drop(idle);
        loop {
            let (mut stream, head) =
                (TcpStream::connect(doors.at).await.unwrap(), b"GET /runs HTTP/1.0\r\nHost: localhost\r\n\r\n");
            stream.write_all(head).await.unwrap();
            let mut answer = Vec::new();
            drop(tokio::io::AsyncReadExt::read_to_end(&mut stream, &mut answer).await);
            if answer.starts_with(b"HTTP/1.") {
                break;
            }
        }
        run.end();
    })
    .await;
}
