//! Tests: ports that are missing, taken or lost, and a real terminal.

use super::*;

#[test]
fn a_closed_stream_takes_the_time_of_a_silent_module() {
    let (got, pace) = in_virtual_time(async {
        let pace = Pace::virtual_time();
        let (ours, theirs) = duplex(64);
        drop(theirs);
        let (ask, to_line) = mpsc::channel(4);
        let (from_line, mut answers) = mpsc::channel(4);
        for ticket in 0..3 {
            ask.send(Request {
                ticket,
                command: count(),
                tries: 3,
            })
            .await
            .unwrap();
        }
        drop(ask);
        run(ours, settings(), pace, to_line, from_line).await;
        let mut got = Vec::new();
        while let Some(answer) = answers.recv().await {
            got.push(answer);
        }
        (got, pace.now())
    });
    assert!(
        got.iter().all(|answer| matches!(
            answer.outcome,
            Err(LineError {
                failure: Failure::PortLost(_),
                ..
            })
        )),
        "{got:?}"
    );
    assert_eq!(pace, RigTime(2 * settings().time_out(&count()).0));
}

/// Returns an opener whose port is missing at first, then ends after one reply, then is missing again, and so on.
fn flaky(pace: Pace) -> OpenPort {
    let mut opened = 0u32;
    Box::new(move || {
        opened += 1;
        if !opened.is_multiple_of(2) {
            return Err(PortError::Missing {
                path: "/dev/none".to_owned(),
            });
        }
        let (ours, mut theirs) = duplex(64);
        tokio::spawn(async move {
            next_request(&mut theirs).await;
            pace.sleep_until(pace.now() + Span(2_000)).await;
            let _ = theirs.write_all(THIRTY).await;
            // After the next request the port closes.
            next_request(&mut theirs).await;
        });
        Ok(Box::new(ours))
    })
}

#[test]
fn a_lost_port_is_opened_again_after_its_back_off() {
    let outcomes = in_virtual_time(async {
        let pace = Pace::virtual_time();
        let (ask, to_line) = mpsc::channel(1);
        let (from_line, mut answers) = mpsc::channel(1);
        tokio::spawn(run_reopening(
            flaky(pace),
            settings(),
            pace,
            to_line,
            from_line,
        ));
        let mut outcomes = Vec::new();
        for ticket in 0..40 {
            ask.send(Request {
                ticket,
                command: count(),
                tries: 1,
            })
            .await
            .unwrap();
            outcomes.push(answers.recv().await.unwrap().outcome);
        }
        outcomes
    });
    let missing = PortError::Missing {
        path: "/dev/none".to_owned(),
    };
    assert!(
        matches!(&outcomes[0], Err(LineError { failure: Failure::PortLost(reason), .. }) if *reason == missing)
    );
    assert!(
        outcomes
            .iter()
            .filter(|outcome| **outcome == Ok(Reply::Count(30)))
            .count()
            >= 3,
        "{outcomes:?}"
    );
    assert!(outcomes.iter().any(|o| matches!(
        o,
        Err(LineError {
            failure: Failure::PortLost(PortError::Broken { .. }),
            ..
        })
    )));
}

#[tokio::test]
async fn the_error_of_a_missing_port_names_its_path() {
    let error = open_serial("/dev/there-is-none", 115_200).unwrap_err();
    assert_eq!(
        error.to_string(),
        "serial port /dev/there-is-none does not exist"
    );
    assert!(matches!(
        open_serial("/dev/null", 115_200),
        Err(PortError::Unusable { .. })
    ));
}

#[tokio::test]
async fn a_line_holds_its_terminal_exclusively_at_real_pace() {
    let (mut device, slave) = tokio_serial::SerialStream::pair().unwrap();
    let path = tokio_serial::SerialPort::name(&slave).unwrap();
    drop(slave);
    let port = open_serial(&path, 115_200).unwrap();
    assert_eq!(
        open_serial(&path, 115_200).unwrap_err(),
        PortError::Taken { path }
    );

    let (ask, to_line) = mpsc::channel(1);
    let (from_line, mut answers) = mpsc::channel(1);
    // Time does not matter in this test, and on a busy machine the device may be late.
    let patient = LineSettings {
        digital_allowance_ms: 5000,
        ..settings()
    };
    tokio::spawn(run(port, patient, Pace::real(), to_line, from_line));
    for ticket in 0..3 {
        let request = Request {
            ticket,
            command: count(),
            tries: 1,
        };
        ask.send(request).await.unwrap();
        let mut heard = [0; 7];
        device.read_exact(&mut heard).await.unwrap();
        assert_eq!(&heard, b"#030B6\r");
        device.write_all(THIRTY).await.unwrap();
        let answer = answers.recv().await.unwrap();
        assert_eq!(
            (answer.ticket, answer.outcome),
            (ticket, Ok(Reply::Count(30)))
        );
    }
    drop(device);
    ask.send(Request {
        ticket: 9,
        command: count(),
        tries: 1,
    })
    .await
    .unwrap();
    let lost = answers.recv().await.unwrap().outcome;
    assert!(
        matches!(
            lost,
            Err(LineError {
                failure: Failure::PortLost(_),
                ..
            })
        ),
        "{lost:?}"
    );
}
