//! Tests of numbers, blocks, status, adapters and profiles, by vectors.

#![allow(clippy::unwrap_used)]

mod session;

use crate::{
    ErrorClass, ErrorEntry, Form, Framing, Identity, LINE_LIMIT, LinkAddress, Raw, Reader, Reply,
    ReplyError, StandardEvents, Terminator, number, string,
};
use units::Span;

fn read(bytes: &[u8], form: Form) -> Result<Option<Raw>, ReplyError> {
    let mut reader = Reader::default();
    reader.push(bytes, form)?;
    reader.take(form)
}

#[test]
fn numbers_of_every_form_are_read() {
    let good = [
        ("-5", -5.0),
        ("+0", 0.0),
        ("1.5", 1.5),
        (".5", 0.5),
        ("5.", 5.0),
        ("+1.5E+00", 1.5),
        (" 1.23e-3 ", 0.00123),
        ("9.8E37", 9.8e37),
    ];
    for (text, value) in good {
        assert_eq!(number(text), Ok(value), "{text:?}");
    }
    for text in [
        "", "-", ".", "e5", "1,5", "0x10", "1 2", "1.5.5", "1E", "#15ab", "ON", "1_000",
    ] {
        assert!(
            matches!(number(text), Err(ReplyError::NotNumber { .. })),
            "{text:?}"
        );
    }
}

#[test]
fn signs_of_no_value_are_never_values() {
    for text in [
        "9.9E37",
        "-9.9E+37",
        "9.90000E+37",
        "9.95E37",
        "1E400",
        "INF",
        "-INF",
        "+Infinity",
        "NINF",
    ] {
        assert_eq!(number(text), Err(ReplyError::OverRange), "{text:?}");
    }
    for text in ["9.91E37", "+9.91000E+37", "NAN", "nan"] {
        assert_eq!(number(text), Err(ReplyError::NotANumber), "{text:?}");
    }
    let raw = Raw::Line(b"1.0,9.9E37,2.0".to_vec());
    assert_eq!(Form::Numbers.read(&raw), Err(ReplyError::OverRange));
}

#[test]
fn strings_end_with_their_own_mark() {
    assert_eq!(string("\"a \"\"b\"\" 'c'\""), Ok("a \"b\" 'c'".to_owned()));
    assert_eq!(string("'it''s'"), Ok("it's".to_owned()));
    assert_eq!(string("\"\""), Ok(String::new()));
    for text in ["", "a", "\"a", "a\"", "\"a'", "\"a\"b\"", "\""] {
        assert!(string(text).is_err(), "{text:?}");
    }
}

#[test]
fn blocks_end_by_length_and_lines_by_line_feed() {
    let block = Form::Block(100);
    assert_eq!(
        read(b"#15ab\ncd\n", block),
        Ok(Some(Raw::Block(b"ab\ncd".to_vec())))
    );
    assert_eq!(
        read(b"#15ab\ncd\r\n", block),
        Ok(Some(Raw::Block(b"ab\ncd".to_vec())))
    );
    assert_eq!(
        read(b"1.5\r\nrest", Form::Number),
        Ok(Some(Raw::Line(b"1.5".to_vec())))
    );
    for part in [
        &b""[..],
        b"#",
        b"#3",
        b"#300",
        b"#15",
        b"#15ab\ncd",
        b"#15ab\ncd\r",
    ] {
        assert_eq!(read(part, block), Ok(None), "{part:?}");
    }
    let wrong: [(&[u8], ReplyError); 7] = [
        (b"#0abc\n", ReplyError::BlockHeader),
        (b"1.5\n", ReplyError::BlockHeader),
        (b"#2x5", ReplyError::BlockHeader),
        (b"#10\n", ReplyError::Empty),
        (
            b"#9999999999",
            ReplyError::TooLong {
                length: 999_999_999,
                most: 100,
            },
        ),
        (
            b"#3101",
            ReplyError::TooLong {
                length: 101,
                most: 100,
            },
        ),
        (b"#12abc\n", ReplyError::BlockEnd { byte: b'c' }),
    ];
    for (bytes, error) in wrong {
        assert_eq!(read(bytes, block), Err(error), "{bytes:?}");
    }
}

#[test]
fn a_reply_of_split_bytes_is_the_same() {
    for (bytes, form) in [
        (&b"#15ab\ncd\n"[..], Form::Any),
        (b"#H1F\n", Form::Any),
        (b"+1.5E+00\r\n", Form::Any),
    ] {
        let mut reader = Reader::default();
        let mut found = Vec::new();
        for byte in bytes {
            reader.push(&[*byte], form).unwrap();
            found.extend(reader.take(form).unwrap());
        }
        assert_eq!(found, [read(bytes, form).unwrap().unwrap()]);
        assert_eq!(reader.waiting(), 0);
    }
}

#[test]
fn an_endless_line_is_cut_off() {
    let mut reader = Reader::default();
    let endless = (0..).find_map(|_| reader.push(&[b'1'; 1024], Form::Number).err());
    let length = LINE_LIMIT + 1024;
    assert_eq!(
        endless,
        Some(ReplyError::TooLong {
            length,
            most: LINE_LIMIT
        })
    );
}

#[test]
fn entries_of_the_error_queue_have_classes() {
    let entries = [
        ("0,\"No error\"", 0, ErrorClass::None),
        ("+0,\"No error\"", 0, ErrorClass::None),
        (
            "-113,\"Undefined header;a \"\"b\"\"\"",
            -113,
            ErrorClass::Command,
        ),
        ("-222, Data out of range", -222, ErrorClass::Execution),
        ("-350,\"Queue overflow\"", -350, ErrorClass::Overflow),
        ("-410,\"Query INTERRUPTED\"", -410, ErrorClass::Query),
        (
            "550,\"Command not allowed in local\"",
            550,
            ErrorClass::Local,
        ),
        ("-310,\"System error\"", -310, ErrorClass::Device),
        ("5051,\"Mine\"", 5051, ErrorClass::Device),
    ];
    for (line, code, class) in entries {
        let entry = ErrorEntry::read(line).unwrap();
        assert_eq!((entry.code, entry.class()), (code, class), "{line}");
    }
    for line in ["1.5", "", "a,b", "-113,\"open"] {
        assert!(ErrorEntry::read(line).is_err(), "{line:?}");
    }
    assert!(StandardEvents(0x80).power_on() && !StandardEvents(0x7F).power_on());
    let identity = Identity::read("KEITHLEY INSTRUMENTS, MODEL 2450,04567,1.7.12b");
    assert_eq!(
        (identity.model.as_str(), identity.firmware.as_str()),
        ("MODEL 2450", "1.7.12b")
    );
}

#[test]
fn addresses_of_instruments_are_read_and_shown() {
    for text in [
        "tcp:10.0.0.5:5025",
        "tcp:[::1]:5025",
        "serial:/dev/ttyUSB0:9600",
        "gpib-tcp:box:1234:9",
    ] {
        assert_eq!(text.parse::<LinkAddress>().unwrap().to_string(), text);
    }
    let words = [
        "",
        "tcp",
        "tcp:host",
        "tcp::5025",
        "tcp:h:0",
        "tcp:h:99999",
        "usb:1:2",
        "gpib-tcp:h:1234:31",
    ];
    for text in words
        .into_iter()
        .chain(["gpib-serial:/dev/ttyS0:9600", "serial:/dev/ttyS0:0"])
    {
        let error = text.parse::<LinkAddress>().unwrap_err();
        assert!(
            error.to_string().contains("expected tcp:HOST:PORT"),
            "{text:?}"
        );
    }
}

#[test]
fn an_adapter_gets_its_address_with_every_message() {
    let adapter = Framing::Adapter(9);
    assert_eq!(adapter.send("A+B"), b"++addr 9\nA\x1B+B\n");
    let (bytes, proof) = adapter.proven(adapter.ask("*IDN?", Span::ms(500)));
    assert_eq!(
        bytes,
        b"++addr 9\n*IDN?\n++read_tmo_ms 450\n++read eoi\n++addr\n"
    );
    assert_eq!(proof.as_deref(), Some("9"));
    assert!(
        adapter
            .ask("X?", Span::ms(60_000))
            .ends_with(b"++read_tmo_ms 3000\n++read eoi\n")
    );
    assert_eq!(
        Framing::Direct(Terminator::Crlf).ask("X?", Span::ms(1)),
        b"X?\r\n"
    );
}

#[test]
fn a_form_accepts_no_other_one() {
    let line = |text: &str| Raw::Line(text.as_bytes().to_vec());
    assert_eq!(
        Form::Text.read(&line("\"a\"")),
        Ok(Reply::Text("a".to_owned()))
    );
    assert_eq!(Form::Line.read(&line("")), Err(ReplyError::Empty));
    let strange = Form::Line.read(&Raw::Line(vec![b'a', 7]));
    assert_eq!(strange, Err(ReplyError::NotText { at: 1, byte: 7 }));
    assert_eq!(
        Form::Number.read(&Raw::Block(vec![1])),
        Err(ReplyError::Block)
    );
    assert!(Form::Block(9).read(&line("1")).is_err());
}
