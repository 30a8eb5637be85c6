use super::*;

fn text(text: &str) -> Result<ClientOp, BadMessage> {
    read(Inbound::Text(text))
}

fn control(command: u8, speed: f32, seek: Option<u64>, request: &[u8]) -> Vec<u8> {
    let mut out = vec![3, command];
    out.extend(speed.to_le_bytes());
    out.push(u8::from(seek.is_some()));
    out.extend(seek.unwrap_or(0).to_le_bytes());
    out.extend(u32::try_from(request.len()).unwrap().to_le_bytes());
    out.extend(request);
    out
}

#[test]
fn what_viewers_do_is_read() {
    let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":2},{"id":0,"channelId":99999999999}]}"#;
    assert_eq!(
        text(subscribe),
        Ok(ClientOp::Subscribe(vec![
            Subscription { id: 7, channel_id: 2 },
            Subscription { id: 0, channel_id: 99_999_999_999 }
        ]))
    );
    assert_eq!(text(r#"{"subscriptionIds":[7],"op":"unsubscribe","later":{}}"#), Ok(ClientOp::Unsubscribe(vec![7])));
    // The request that was recorded with the reference server: play from 5 s on, at speed 1, as `r1`.
    let recorded = [
        0x03, 0x00, 0x00, 0x00, 0x80, 0x3f, 0x01, 0x00, 0xf2, 0x05, 0x2a, 0x01, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00,
        0x00, 0x72, 0x31,
    ];
    assert_eq!(recorded, *control(0, 1.0, Some(5_000_000_000), b"r1"));
    let wanted = PlaybackControl { play: true, speed: 1.0, seek: Some(5_000_000_000), request: "r1".to_owned() };
    assert_eq!(read(Inbound::Binary(&recorded)), Ok(ClientOp::Playback(wanted)));
    let pause = PlaybackControl { play: false, speed: 0.5, seek: None, request: String::new() };
    assert_eq!(read(Inbound::Binary(&control(1, 0.5, None, b""))), Ok(ClientOp::Playback(pause)));
}

#[test]
fn everything_else_that_the_protocol_knows_is_read_and_named() {
    let names = || vec!["a".to_owned()];
    let texts = [
        (
            r#"{"op":"advertise","channels":[{"id":1,"topic":"/cmd_vel","encoding":"json","schemaName":"Twist"}]}"#,
            Deed::Advertise { topics: vec!["/cmd_vel".to_owned()] },
        ),
        (r#"{"op":"unadvertise","channelIds":[1]}"#, Deed::Unadvertise { channels: vec![1] }),
        (r#"{"op":"getParameters","parameterNames":["a"],"id":"x"}"#, Deed::GetParameters { names: names() }),
        (r#"{"op":"setParameters","parameters":[{"name":"a","value":[1]}]}"#, Deed::SetParameters { names: names() }),
        (
            r#"{"op":"subscribeParameterUpdates","parameterNames":["a"]}"#,
            Deed::SubscribeParameterUpdates { names: names() },
        ),
        (
            r#"{"op":"unsubscribeParameterUpdates","parameterNames":["a"]}"#,
            Deed::UnsubscribeParameterUpdates { names: names() },
        ),
        (
            r#"{"op":"fetchAsset","uri":"package://x","requestId":3}"#,
            Deed::FetchAsset { uri: "package://x".to_owned(), request: 3 },
        ),
        (r#"{"op":"subscribeConnectionGraph"}"#, Deed::SubscribeConnectionGraph),
        (r#"{"op":"unsubscribeConnectionGraph"}"#, Deed::UnsubscribeConnectionGraph),
    ];
    for (sent, deed) in texts {
        assert!(sent.contains(deed.op()), "{sent}");
        assert_eq!(text(sent), Ok(ClientOp::Other(deed)), "{sent}");
    }
    assert_eq!(read(Inbound::Binary(&[1, 30, 0, 0, 0, 0xff])), Ok(ClientOp::Other(Deed::Publish { channel: 30 })));
    let call = [&[2, 10, 0, 0, 0, 12, 0, 0, 0, 4, 0, 0, 0][..], b"json{}"].concat();
    assert_eq!(read(Inbound::Binary(&call)), Ok(ClientOp::Other(Deed::CallService { service: 10, call: 12 })));
}

#[test]
fn a_damaged_text_is_told_what_is_wrong_with_it() {
    for (sent, told) in [
        ("", "EOF while parsing a value at line 1 column 0"),
        ("{\"op\":", "EOF while parsing a value at line 1 column 6"),
        ("[]", "no message of the protocol"),
        ("{}", "missing field `op`"),
        (r#"{"op":3}"#, "invalid type: integer `3`"),
        (r#"{"op":"nonsense"}"#, "`op` is `nonsense`"),
        (r#"{"op":"subscribe"}"#, "`subscribe` cannot be read: missing field `subscriptions`"),
        (
            r#"{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}"#,
            "invalid value: integer `-1`, expected u32",
        ),
        (r#"{"op":"subscribe","subscriptions":[{"id":1}]}"#, "missing field `channelId`"),
        (r#"{"op":"unsubscribe","subscriptionIds":[4294967296]}"#, "integer `4294967296`, expected u32"),
        (r#"{"op":"fetchAsset","uri":"x"}"#, "missing field `requestId`"),
        (r#"{"op":"setParameters","parameters":{}}"#, r#"it is {"op":"setParameters""#),
    ] {
        let bad = text(sent).unwrap_err().to_string();
        assert!(bad.contains(told), "{sent}: {bad}");
    }
    let long = text(&format!(r#"{{"op":"{}"}}"#, "x".repeat(1_000))).unwrap_err().to_string();
    assert!(long.len() < 200, "{long}");
}

#[test]
fn damaged_bytes_are_told_what_is_wrong_with_them() {
    let not_a_text = control(0, 1.0, None, &[0xff, 0xfe]);
    let cut = control(0, 1.0, Some(5), b"r1");
    let mut more = cut.clone();
    more.push(0);
    let huge_call = [2, 1, 0, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff];
    for (sent, told) in [
        (&[][..], "a binary message is 0 bytes long"),
        (&[9], "begins with 9"),
        (&[1, 0], "a binary message data is 2 bytes long; it takes 5 at least"),
        (&[2, 1, 0, 0, 0], "a binary service call is 5 bytes long"),
        (&huge_call, "13 and the 4294967295 of its encoding"),
        (&[3, 0, 0], "a binary playback control is 3 bytes long; it takes 19 at least"),
        (&cut[..20], "19 and the 2 of its request id"),
        (&more, "19 and the 2 of its request id"),
        (&control(7, 1.0, None, b""), "`command` of a playback control is 7; 0 is to play, 1 to stand"),
        (&control(0, 1.0, None, &[b'x'; 257]), "`request id` of a playback control is 257 bytes long"),
        (&not_a_text, "it is UTF-8"),
    ] {
        let bad = read(Inbound::Binary(sent)).unwrap_err().to_string();
        assert!(bad.contains(told), "{sent:?}: {bad}");
    }
}

#[test]
fn messages_are_bounded_in_length_depth_and_entries() {
    let long = " ".repeat(MESSAGE_BYTES + 1);
    assert_eq!(text(&long), Err(BadMessage::Long { found: MESSAGE_BYTES + 1 }));
    assert_eq!(read(Inbound::Binary(&vec![1; MESSAGE_BYTES + 1])), Err(BadMessage::Long { found: MESSAGE_BYTES + 1 }));
    let nested = |depth: usize| {
        format!(r#"{{"op":"unsubscribeConnectionGraph","x":{}{}}}"#, "[".repeat(depth), "]".repeat(depth))
    };
    assert!(text(&nested(JSON_DEPTH - 1)).is_ok());
    assert!(matches!(text(&nested(JSON_DEPTH)), Err(BadMessage::Deep { .. })));
    assert!(matches!(text(&"[".repeat(60_000)), Err(BadMessage::Deep { at: JSON_DEPTH })));
    // Brackets within quotes are no nesting, and an escaped quote does not end one.
    let quoted = format!(r#"{{"op":"subscribeConnectionGraph","x":"\"{}"}}"#, "[".repeat(100));
    assert!(text(&quoted).is_ok());
    let many = |count: usize| format!(r#"{{"op":"unsubscribe","subscriptionIds":[{}]}}"#, vec!["1"; count].join(","));
    assert!(text(&many(SUBSCRIPTIONS)).is_ok());
    assert_eq!(text(&many(257)), Err(BadMessage::Many { op: "unsubscribe", found: 257 }));
}

#[test]
fn no_damage_to_any_message_makes_the_reader_panic() {
    let whole = control(0, 1.0, Some(5), b"r1");
    for end in 0..whole.len() {
        assert!(read(Inbound::Binary(&whole[..end])).is_err());
    }
    for at in 0..whole.len() {
        for byte in 0..=255 {
            let mut damaged = whole.clone();
            damaged[at] = byte;
            drop(read(Inbound::Binary(&damaged)));
        }
    }
    let sent = r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]}"#;
    for end in 0..sent.len() {
        assert!(text(&sent[..end]).is_err());
    }
}
